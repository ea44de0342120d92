"""Which standard variants to make: the fewest that serve all, or a given number at the least cost.

The choice of exactly K columns of a cost matrix is the p-median problem. Its model has a cost per row, bounded below by
cuts that are exact wherever they were made: with the columns of a row in order of cost c(1) <= c(2) <= ..., and y = 1
for a column that is chosen,

    cost of the row >= c(k) - sum over l < k of (c(k) - c(l)) y(l)        for every k.

Cuts hold for every K. A Lagrangean bound comes first, from prices of the rows (array arithmetic only); it mostly proves
the choice that exchanges of columns have found, and it settles most columns: those that no choice better than the
best known can have, or be without. What is left goes to HiGHS: the linear relaxation with the cuts that it breaks, then
the mixed-integer program; what that proposes is priced exactly and cut again, until its bound meets the best choice.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from synth.variants.variant_settings import VARIANTS, MedianSettings

if TYPE_CHECKING:
    import cvxpy

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Medians:
    """Some columns, what they cost, and what no choice of as many can be below."""

    columns: tuple[int, ...]
    cost: float
    bound: float
    rounding: float = VARIANTS.medians.rounding

    @property
    def gap(self) -> float:
        """How far from proven the cost is, as a share of it."""
        open_share = (self.cost - self.bound) / self.cost if self.cost > 0 else 0.0
        return open_share if open_share > self.rounding else 0.0


class Chooser:
    """Chooses columns of a cost matrix, every row being served by the cheapest column that is chosen.

    Parameters
    ----------
    costs : array (rows, columns)
        Not negative; infinite where the column cannot serve the row. Every row has a finite one.
    weights : array (rows,)
        How often each row counts.
    gap : float
        Share of the cost that need not be proven.
    settings : MedianSettings, optional
    """

    def __init__(
        self, costs: FloatArray, weights: FloatArray, gap: float, settings: MedianSettings = VARIANTS.medians
    ) -> None:
        self.gap, self.settings = gap, settings
        self._prices: FloatArray | None = None  # of the last number: a good beginning for the next
        merged, inverse = np.unique(costs, axis=0, return_inverse=True)
        self.weights: FloatArray = np.bincount(inverse.ravel(), weights=weights, minlength=len(merged)).astype(
            np.float64
        )
        self.kept = _not_dominated(merged)
        self.costs = merged[:, self.kept]
        self.serves = np.isfinite(self.costs)
        self.order = np.argsort(self.costs, axis=1, kind="stable")
        self.sorted = np.take_along_axis(self.costs, self.order, axis=1)
        finite = self.costs[self.serves]
        self.scale = max(float(finite.max()), 1e-12) if finite.size else 1.0
        self._cuts = _Cuts(self.costs.shape[1])
        self.rows, self.columns = self.costs.shape

    # -- exact costs ---------------------------------------------------------------------------

    def cost(self, columns: Iterable[int]) -> float:
        """Cost of a choice; infinite where it leaves a row unserved."""
        chosen = list(columns)
        if not chosen:
            return np.inf if self.rows else 0.0
        return float(self.weights @ self.costs[:, chosen].min(axis=1))

    def fewest(self, deadline: float) -> tuple[list[int], int]:
        """Smallest set of columns found that serves every row, and a lower bound of its size."""
        import cvxpy as cp  # costly to import

        if not self.rows:
            return [], 0
        greedy = self._cover()
        y = cp.Variable(self.columns, boolean=True)
        rows = np.unique(self.serves, axis=0).astype(float)
        problem = cp.Problem(cp.Minimize(cp.sum(y)), [rows @ y >= 1])
        bound = _solve(cp, problem, 0.0, deadline)
        smallest = greedy if y.value is None else [int(k) for k in np.flatnonzero(np.asarray(y.value) > 0.5)]
        if not np.isfinite(self.cost(smallest)) or len(greedy) < len(smallest):
            smallest = greedy
        return smallest, int(np.ceil(bound - 1e-6)) if np.isfinite(bound) else 1

    def _cover(self) -> list[int]:
        """Greedy cover: columns that serve every row, each the one that serves most of the unserved weight."""
        unserved, chosen = np.ones(self.rows, dtype=bool), list[int]()
        while unserved.any():
            best = int(np.argmax(self.weights[unserved] @ self.serves[unserved]))
            chosen.append(best)
            unserved &= ~self.serves[:, best]
        return chosen

    # -- the best choice of a number -----------------------------------------------------------

    def best(self, number: int, deadline: float, start: Iterable[int] = (), exact: bool = True) -> Medians:
        """Cheapest choice of a number of columns.

        Parameters
        ----------
        number : int
            At least as many as are needed to serve every row.
        deadline : float
            On ``time.monotonic``; afterwards the best so far is returned, with the bound that is proven.
        start : iterable of int
            Columns of a choice that is known to be good.
        exact : bool
            Whether to go on where the linear relaxation leaves a gap.
        """
        number = min(number, self.columns)
        chosen = self._improved(self._filled(list(start), number))
        priced = self._priced(number, chosen, deadline)
        chosen, cost, bound = priced.chosen, self.cost(priced.chosen), priced.bound
        if exact and not self._proven(cost, bound):
            free = self._settle(priced, number, cost)
            self._cut_near(priced.prices)
            bound = max(bound, self._relaxed(number, free, deadline))
            while not self._proven(cost, bound) and time.monotonic() < deadline:
                candidate, lower = self._integer(number, free, deadline)
                bound = max(bound, min(lower, cost))
                if candidate is None:
                    break
                if self.cost(candidate) < cost:
                    chosen = self._improved(candidate)
                    cost = self.cost(chosen)
                binary = np.zeros(self.columns)
                binary[candidate] = 1.0
                if not self._cut(binary, np.full(self.rows, -np.inf)):
                    break
        return Medians(tuple(sorted(int(self.kept[k]) for k in chosen)), cost, min(bound, cost), self.settings.rounding)

    def _proven(self, cost: float, bound: float) -> bool:
        return cost - bound <= self.gap * cost + self.settings.broken * self.scale

    def inner(self, columns: Iterable[int]) -> list[int]:
        """Columns of the matrix as this object counts them, without dominated ones."""
        place = {int(k): i for i, k in enumerate(self.kept)}
        return [place[int(k)] for k in columns if int(k) in place]

    def _filled(self, columns: list[int], number: int) -> list[int]:
        """Return a choice of the number asked for that serves all rows, where it can be had without search."""
        chosen = list(dict.fromkeys(columns))
        if not np.isfinite(self.cost(chosen)):
            chosen = list(dict.fromkeys([*self._cover(), *chosen]))
        while len(chosen) > number:
            first, second, of = self._two_best(chosen)
            loss = np.bincount(of, weights=self.weights * (second - first), minlength=len(chosen))
            chosen.pop(int(np.argmin(loss)))
        while len(chosen) < number:
            served = self.costs[:, chosen].min(axis=1) if chosen else np.full(self.rows, self.scale)
            gain = self.weights @ np.minimum(self.costs, served[:, None])
            gain[chosen] = np.inf
            chosen.append(int(np.argmin(gain)))
        return chosen

    def _two_best(self, chosen: list[int]) -> tuple[FloatArray, FloatArray, NDArray[np.int_]]:
        """Return, per row, the cost of the best and of the second best chosen column, and which is the best."""
        costs = self.costs[:, chosen]
        of = np.argmin(costs, axis=1)
        first = costs[np.arange(self.rows), of].copy()
        costs[np.arange(self.rows), of] = np.inf
        return first, costs.min(axis=1), of

    def _improved(self, chosen: list[int]) -> list[int]:
        """Exchange columns, always the two that save most, as long as that makes the choice cheaper."""
        chosen = list(chosen)
        for _ in range(self.settings.swaps):
            first, second, of = self._two_best(chosen)
            near = np.minimum(self.costs, first[:, None])
            gain = self.weights @ (near - first[:, None])
            # What it costs more that the rows of a column that goes change to the one that comes, or to their second.
            more = self.weights[:, None] * (np.minimum(self.costs, second[:, None]) - near)
            order = np.argsort(of, kind="stable")
            starts = np.searchsorted(of[order], np.arange(len(chosen)))
            totals = np.zeros((len(chosen), self.columns))
            present = np.flatnonzero(np.bincount(of, minlength=len(chosen)))
            totals[present] = np.add.reduceat(more[order], starts[present], axis=0)
            totals += gain
            totals[:, chosen] = np.inf
            out, into = np.unravel_index(int(np.argmin(totals)), totals.shape)
            if not totals[out, into] < -self.settings.saving * self.scale:
                break
            chosen[int(out)] = int(into)
        return chosen

    # -- bounds --------------------------------------------------------------------------------

    def _priced(self, number: int, chosen: list[int], deadline: float) -> _Priced:
        """Best Lagrangean bound: rows pay a price each, and the columns that earn most are chosen."""
        cost = self.cost(chosen)
        prices = self._prices
        if prices is None:
            prices = np.asarray(np.minimum(self._two_best(chosen)[1], self.scale), dtype=np.float64)
        best = _Priced(-np.inf, prices, np.zeros(self.columns), chosen)
        step, since = self.settings.first_step, 0
        tried: set[frozenset[int]] = set()
        for _ in range(self.settings.pricings):
            earned = self.weights @ np.minimum(self.costs - prices[:, None], 0.0)
            selected = np.argpartition(earned, number - 1)[:number]
            bound = float(self.weights @ prices + earned[selected].sum())
            if bound > best.bound + self.settings.rise * self.scale:
                best, since = _Priced(bound, prices.copy(), earned, best.chosen), 0
                if frozenset(selected.tolist()) not in tried and len(tried) < self.settings.swaps:
                    tried.add(frozenset(selected.tolist()))
                    other = self._filled([int(k) for k in selected], number)
                    if self.cost(other) < self.settings.promising * cost:
                        other = self._improved(other)
                    if self.cost(other) < cost:
                        best.chosen, cost = other, self.cost(other)
            else:
                since += 1
                if since >= self.settings.patience:
                    step, since, prices = step / 2, 0, best.prices.copy()
            if self._proven(cost, best.bound) or step < self.settings.least_step or time.monotonic() > deadline:
                break
            slope = 1.0 - np.count_nonzero(self.costs[:, selected] < prices[:, None], axis=1).astype(float)
            length = float(self.weights @ slope**2)
            if length == 0.0:
                break  # the choice serves every row once: it is the best one
            prices = np.maximum(prices + step * (self.settings.target * cost - bound) / length * slope, 0.0)
        self._prices = best.prices
        return best

    def _settle(self, priced: _Priced, number: int, cost: float) -> NDArray[np.int_]:
        """Return the columns that a choice better than the best known may have, by their reduced costs."""
        earned = np.sort(priced.earned)
        may = priced.bound + priced.earned - earned[number - 1] <= cost + self.settings.broken * self.scale
        may[np.argsort(priced.earned, kind="stable")[:number]] = True
        may[priced.chosen] = True
        return np.flatnonzero(may)

    def _cut_near(self, prices: FloatArray) -> None:
        """Begin with the cuts at the levels next to the prices: most of those that matter."""
        first = (self.sorted < prices[:, None]).sum(axis=1)
        for offset in (-1, 0, 1, 2):
            self._cut_at(np.clip(first + offset, 0, self.columns - 1), np.full(self.rows, -np.inf), None)

    def _relaxed(self, number: int, free: NDArray[np.int_], deadline: float) -> float:
        """Return the bound of the linear relaxation over some columns."""
        bound = 0.0
        for _ in range(self.settings.rounds):
            value, y, theta = self._master(number, free, False, deadline)
            if y is None or theta is None:
                break
            bound = max(bound, value)
            if not self._cut(y, theta) or time.monotonic() > deadline:
                break
        return bound

    def _integer(self, number: int, free: NDArray[np.int_], deadline: float) -> tuple[list[int] | None, float]:
        """Proposal of the mixed-integer program with the cuts so far, and its bound."""
        value, y, _ = self._master(number, free, True, deadline)
        if y is None:
            return None, value
        return [int(k) for k in np.argsort(-y, kind="stable")[:number]], value

    def _cut(self, y: FloatArray, theta: FloatArray) -> bool:
        """Add the cuts that a point of the master breaks; tell whether there are any."""
        ahead = np.cumsum(y[self.order], axis=1)
        # Where the columns ahead of k add up to one, the cut of k is the deepest.
        return self._cut_at(np.argmax(ahead >= 1.0 - 1e-9, axis=1), theta, y)

    def _cut_at(self, k: NDArray[np.int_], theta: FloatArray, y: FloatArray | None) -> bool:
        level = self.sorted[np.arange(self.rows), k]
        level = np.where(np.isfinite(level), level, 0.0)
        saved = np.maximum(level[:, None] - self.costs, 0.0)
        met = level if y is None else level - saved @ y
        broken = np.flatnonzero((level > 0) & (theta < met - self.settings.broken * self.scale))
        return self._cuts.add(broken, saved[broken], level[broken])

    def _master(
        self, number: int, free: NDArray[np.int_], integer: bool, deadline: float
    ) -> tuple[float, FloatArray | None, FloatArray | None]:
        """Solve the program of the cuts so far over some columns; return its bound, the columns, the costs of rows."""
        import cvxpy as cp
        from scipy import sparse

        y = cp.Variable(len(free), boolean=integer, bounds=None if integer else [0, 1])
        theta = cp.Variable(self.rows, nonneg=True)
        serves = sparse.csr_matrix(np.unique(self.serves[:, free], axis=0).astype(float))
        rules = [cp.sum(y) == number, serves @ y >= 1]
        if len(self._cuts):
            saved, rows, level = self._cuts.matrices(self.rows)
            rules.append(rows @ theta + saved[:, free] @ y >= level)
        problem = cp.Problem(cp.Minimize(self.weights @ theta), rules)
        bound = _solve(cp, problem, 0.1 * self.gap if integer else None, deadline)
        if y.value is None or theta.value is None:
            return bound if integer and np.isfinite(bound) else 0.0, None, None
        expanded = np.zeros(self.columns)
        expanded[free] = np.asarray(y.value, dtype=float)
        return bound, expanded, np.asarray(theta.value, dtype=float)


@dataclass
class _Priced:
    """Prices of the rows, what the columns earn by them, the bound that they prove, and the best choice met."""

    bound: float
    prices: Any
    earned: FloatArray
    chosen: list[int]


class _Cuts:
    """The cuts so far, each once."""

    def __init__(self, columns: int) -> None:
        self._columns = columns
        self._known: set[tuple[int, float]] = set()
        self._rows: list[int] = []
        self._saved: list[Any] = []
        self._level: list[float] = []

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, rows: NDArray[np.int_], saved: FloatArray, level: FloatArray) -> bool:
        from scipy import sparse

        new = [i for i, row in enumerate(rows) if (int(row), float(level[i])) not in self._known]
        for i in new:
            self._known.add((int(rows[i]), float(level[i])))
            self._rows.append(int(rows[i]))
            self._level.append(float(level[i]))
        if new:
            self._saved.append(sparse.csr_matrix(saved[new]))
        return bool(new)

    def matrices(self, rows: int) -> tuple[Any, Any, FloatArray]:
        from scipy import sparse

        count = len(self._rows)
        of_rows = sparse.csr_matrix((np.ones(count), (np.arange(count), self._rows)), shape=(count, rows))
        return sparse.vstack(self._saved, format="csr"), of_rows, np.array(self._level)


def _solve(cp: ModuleType, problem: cvxpy.Problem, gap: float | None, deadline: float) -> float:
    """Solve a program with HiGHS; return a bound below its optimum (minus infinity where there is none)."""
    remaining = max(deadline - time.monotonic(), 0.1)
    options: dict[str, Any] = {"time_limit": remaining}
    if gap is not None:
        options["mip_rel_gap"] = gap
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a time limit; its bound holds all the same
            problem.solve(solver=cp.HIGHS, **options)
    except cp.error.SolverError:
        return -np.inf  # stopped before it found anything
    if gap is not None:
        return float(problem.solver_stats.extra_stats.mip_dual_bound)
    return float(problem.value) if problem.status == "optimal" else -np.inf


def _not_dominated(costs: FloatArray) -> NDArray[np.int_]:
    """Return the columns that no other one replaces at the same or less cost in every row."""
    keep: NDArray[np.bool_] = np.asarray(np.isfinite(costs).any(axis=0))
    for j in range(costs.shape[1]):
        if keep[j]:
            better = np.asarray(np.all(costs <= costs[:, [j]], axis=0)) & keep
            better[j] = False
            same = better & np.all(costs == costs[:, [j]], axis=0)
            better &= ~same | (np.arange(len(better)) < j)
            keep[j] = not better.any()
    return np.flatnonzero(keep)
