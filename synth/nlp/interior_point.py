"""An interior-point method for many small problems at once, over arrays.

All problems share their formulas and differ in numbers. One lane is one problem on its way; all lanes take a
step together, each with its own barrier parameter, penalty and step length. Lanes that are done make room for the
next problems.

The method: rows may be broken at a price (an exact l1 penalty), so that every problem has a solution in the interior,
and what remains for the line search is one smooth function. With row value c, penalty R and barrier mu the
row contributes

    psi(c) = min over s, p > 0 with c = p - s of  R p - mu log s - mu log p,

known in closed form; the slope of psi is mu/s. Newton steps use primal-dual multipliers: 1/(s/lam + p/(R - lam)) for
the curvature of psi. With slopes of psi on the right side every step is one of descent. Equalities are the same with
multipliers between -R and R.

Where formulas do not exist (behind a guard, or not a number), a first phase looks only at the rows that exist,
without the objective, until all do. Where rows press against the penalty they are met on their own, again without
the objective; only then is the penalty raised. A full step that is refused is corrected once for the curvature of
the rows before it is halved.

References
----------
J. Nocedal, S. J. Wright, Numerical Optimization, 2nd ed. (2006), chapter 19.
N. I. M. Gould, D. Orban, P. L. Toint, An interior-point l1-penalty method for nonlinear optimization (2015).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.nlp.row_functions import RowFunctions
from synth.nlp.settings import InteriorPointSettings

CONVERGED, INFEASIBLE, STUCK, STOPPED = 1, 2, 3, 4


@dataclass(frozen=True)
class Problems:
    """Problems as the solver sees them; one column per problem.

    Parameters
    ----------
    stored : list
        Numbers, or arrays (problems,), for the stored nodes of the row functions.
    start, low, high : array (variables, problems)
    counts : array of bool (rows, problems)
        Which rows there are.
    slopes, rights : array (rows, problems)
        A row reads ``F - slope t <= right``.
    weights : array (goals, problems)
    t_weight : array (problems,)
        0: t is held at 0.
    """

    stored: Sequence[Any]
    start: np.ndarray
    low: np.ndarray
    high: np.ndarray
    counts: np.ndarray
    slopes: np.ndarray
    rights: np.ndarray
    weights: np.ndarray
    t_weight: np.ndarray

    def __len__(self) -> int:
        return len(self.t_weight)

    def moved(self, number: np.ndarray, share: float) -> Problems:
        """Return some of the problems, started at a share of the way from their lower to their upper bounds."""
        low, high = self.low[:, number], self.high[:, number]
        return Problems(
            [x if np.ndim(x) == 0 else x[number] for x in self.stored],
            low + share * (high - low),
            low,
            high,
            self.counts[:, number],
            self.slopes[:, number],
            self.rights[:, number],
            self.weights[:, number],
            self.t_weight[number],
        )


@dataclass(frozen=True)
class Ends:
    """Where each problem ended; one column per problem. ``rows`` is NaN where a formula does not exist."""

    y: np.ndarray
    t: np.ndarray
    rows: np.ndarray
    multipliers: np.ndarray
    status: np.ndarray
    evaluations: np.ndarray

    @classmethod
    def empty(cls, n: int, rows: int, count: int) -> Ends:
        """Arrays for so many problems, to be written into."""
        return cls(
            y=np.empty((n, count)),
            t=np.empty(count),
            rows=np.empty((rows, count)),
            multipliers=np.empty((rows, count)),
            status=np.empty(count, dtype=np.int64),
            evaluations=np.empty(count, dtype=np.int64),
        )


class SparsityPattern:
    """Where the nonzero derivatives stand, prepared for sums over rows and columns."""

    def __init__(self, functions: RowFunctions) -> None:
        self.n, self.rows, self.goals = functions.n, functions.n_rows, functions.n_goals
        self.constraints = functions.n_constraints
        self.row, self.column = functions.row, functions.column
        self.hessian = functions.hessian
        self.columns = [np.flatnonzero(self.column == a) for a in range(self.n)]
        self.pairs: list[tuple[int, int, np.ndarray, np.ndarray]] = []
        for a in range(self.n):
            for b in range(a + 1):
                shared = np.intersect1d(self.row[self.columns[a]], self.row[self.columns[b]])
                first = [int(k) for r in shared for k in self.columns[a] if self.row[k] == r]
                second = [int(k) for r in shared for k in self.columns[b] if self.row[k] == r]
                self.pairs.append((a, b, np.array(first, dtype=np.int64), np.array(second, dtype=np.int64)))
        constraints = functions.rows.constraints
        self.equal = np.array([c.sense == "equal" for c in constraints] + [False] * self.goals, dtype=bool)[:, None]
        self.guard = np.array([c.guard for c in constraints] + [False] * self.goals, dtype=bool)
        self.is_goal = (np.arange(self.rows) >= self.constraints)[:, None]
        self.has_equal, self.has_guard = bool(self.equal.any()), bool(self.guard.any())

    def transposed(self, jacobian: np.ndarray, vector: np.ndarray) -> np.ndarray:
        """Return the gradient of the rows weighted by a vector."""
        product = jacobian * vector[self.row]
        result = np.empty((self.n, vector.shape[1]))
        for a, places in enumerate(self.columns):
            result[a] = product[places].sum(axis=0)
        return result

    def times(self, jacobian: np.ndarray, slopes: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Return the change of all rows along a direction of variables and t."""
        result: np.ndarray = -slopes * direction[self.n]
        for a, places in enumerate(self.columns):
            result[self.row[places]] += jacobian[places] * direction[a]
        return result

    def gram(self, jacobian: np.ndarray, slopes: np.ndarray, vector: np.ndarray) -> list[list[np.ndarray]]:
        """Return the lower triangle of the sum of outer products of the rows' gradients weighted by a vector."""
        weighted = jacobian * vector[self.row]
        matrix: list[list[np.ndarray]] = [[] for _ in range(self.n + 1)]
        for a, _, first, second in self.pairs:
            matrix[a].append(np.einsum("kl,kl->l", weighted[first], jacobian[second]))
        for places in self.columns:
            matrix[self.n].append(-np.einsum("kl,kl->l", weighted[places], slopes[self.row[places]]))
        matrix[self.n].append(np.einsum("kl,kl,kl->l", vector, slopes, slopes))
        return matrix


def split(values: np.ndarray, barrier: np.ndarray, prices: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return slack s and excess p of rows, those that minimise psi, and the slope of psi, mu/s = R p/(s + p)."""
    least = 2 * barrier / prices
    total = least + np.sqrt(values * values + least * least)
    large = 0.5 * (np.abs(values) + total)
    small = 0.5 * least * total / large
    held = values <= 0
    excess = np.where(held, small, large)
    return np.where(held, large, small), excess, prices * excess / total


def solve_shifted(
    matrix: Sequence[Sequence[np.ndarray]],
    right: np.ndarray,
    shift: np.ndarray,
    active: np.ndarray,
    method: InteriorPointSettings,
) -> np.ndarray:
    """Solve symmetric systems (lower triangles), with the diagonal shifted until they are positive definite."""
    n = len(right)
    factor, pivots, good = factorised(matrix, shift, method.least_pivot)
    good |= ~active
    while not good.all():
        again = np.flatnonzero(~good)
        grown = np.where(shift[again] > 0, method.shift_growth * shift[again], method.first_shift)
        shift = shift.copy()
        shift[again] = grown
        part = [[entry[again] for entry in line] for line in matrix]
        new_factor, new_pivots, new_good = factorised(part, grown, method.least_pivot)
        for a in range(n):
            pivots[a][again] = new_pivots[a]
            for b in range(a):
                factor[a][b][again] = new_factor[a][b]
        good[again] = new_good | (grown > method.largest_shift)
    result = np.empty_like(right)
    for a in range(n):
        result[a] = right[a]
        for b in range(a):
            result[a] -= factor[a][b] * result[b]
    for a in range(n - 1, -1, -1):
        result[a] /= pivots[a]
        for b in range(a + 1, n):
            result[a] -= factor[b][a] * result[b]
    return result


def factorised(
    matrix: Sequence[Sequence[np.ndarray]], shift: np.ndarray, least_pivot: float
) -> tuple[list[list[np.ndarray]], list[np.ndarray], np.ndarray]:
    """Return the factors L and D of shifted matrices, and which of them are positive definite."""
    n = len(matrix)
    factor: list[list[np.ndarray]] = [[] for _ in range(n)]
    pivots: list[np.ndarray] = []
    good = np.ones(len(shift), dtype=bool)
    for a in range(n):
        scaled: list[np.ndarray] = []  # entries of L times their pivot
        for b in range(a):
            entry = matrix[a][b]
            for c in range(b):
                entry = entry - scaled[c] * factor[b][c]
            scaled.append(entry)
            factor[a].append(entry / pivots[b])
        pivot = matrix[a][a] + shift
        least = least_pivot * np.abs(pivot)
        for b in range(a):
            pivot = pivot - scaled[b] * factor[a][b]
        good &= pivot > least
        pivots.append(pivot)
    return factor, pivots, good
