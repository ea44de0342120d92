"""Many small continuous problems at once: one set of rows, a combination of parts and a task each.

The problem of one combination is

    minimise  weights . phi + t_weight t
    over y, t such that  limits(y) - elastic t <= 0,  phi_k(y) - slope_k t <= cutoff_k,

solved for whole arrays of data by an interior-point method of our own. ``min``, ``max`` and ``where`` are
differentiated piecewise as they stand, which leads to optima beside their kinks; for those on kinks see
:mod:`synth.nlp.pieces`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property, partial
from typing import Any

import numpy as np

from synth.kernels.threads import side_by_side
from synth.model.program import InputValue, Program
from synth.nlp.interior_point import CONVERGED, INFEASIBLE, Ends, Problems, SparsityPattern
from synth.nlp.interior_point_numpy import InteriorPoint
from synth.nlp.kernel_solver import KernelSolver, kernel_solver
from synth.nlp.row_functions import RowFunctions
from synth.nlp.rows import GUARD_MARGIN, Rows
from synth.nlp.settings import NLP, NlpSettings
from synth.order.feasibility import SMALLEST, size_of_miss
from synth.system import deadline


@dataclass(frozen=True)
class Tasks:
    """Scalar problems, one per row of each array.

    Parameters
    ----------
    weights, slopes, cutoffs : array (problems, objectives)
        A cutoff of infinity is none.
    goal_scales : array (objectives,)
        Size of objectives that do not enter by logarithm.
    t_weight : float
        0: t is held at 0.
    elastic : float
        How much one unit of t loosens every limit but the guards.
    moved : array (problems, limits), optional
        By how much the row of each limit may be exceeded: the limit itself is another one.
    """

    weights: np.ndarray
    slopes: np.ndarray
    cutoffs: np.ndarray
    goal_scales: np.ndarray
    t_weight: float = 1.0
    elastic: float = 0.0
    moved: np.ndarray | None = None

    def take(self, rows: np.ndarray | slice) -> Tasks:
        """Problems at the given positions."""
        moved = None if self.moved is None else self.moved[rows]
        arrays = self.weights[rows], self.slopes[rows], self.cutoffs[rows]
        return Tasks(*arrays, self.goal_scales, self.t_weight, self.elastic, moved)


@dataclass(frozen=True)
class ProblemInputs:
    """Numbers of a batch of problems of one program.

    Parameters
    ----------
    data : list of numbers or arrays (problems,)
        Data inputs of the program; NaN where a column has no value.
    low, high : array (problems, variables)
        SI; equal bounds pin a variable.
    bounds : list of float
        Constant right sides, in the order of the constraints.
    void : array of bool (problems, constraints)
        Limits that do not count.
    """

    data: Sequence[InputValue]
    low: np.ndarray
    high: np.ndarray
    bounds: Sequence[float]
    void: np.ndarray

    def take(self, rows: np.ndarray | slice) -> ProblemInputs:
        """Numbers of the problems at the given positions."""
        data = [x if np.ndim(x) == 0 else np.asarray(x)[rows] for x in self.data]
        return ProblemInputs(data, self.low[rows], self.high[rows], self.bounds, self.void[rows])

    def clean(self) -> list[np.ndarray]:
        """Data inputs with one in place of a missing value."""
        columns = (np.asarray(x, dtype=float) for x in self.data)
        return [np.where(np.isnan(x), 1.0, x) for x in columns]


@dataclass(frozen=True)
class Solutions:
    """Where the solver ended, one row per problem; nothing in it is trusted before it is re-evaluated.

    Parameters
    ----------
    variables : array (problems, variables)
        SI, within their bounds.
    phi : array (problems, objectives)
    t : array (problems,)
    violation : array (problems,)
        Largest violation of a row at the point; 0 where all hold, infinite where one does not exist.
    constraint_multipliers : array (problems, constraints)
    goal_multipliers : array (problems, objectives)
    converged : array of bool (problems,)
        Whether the point met the tolerances of an optimum.
    """

    variables: np.ndarray
    phi: np.ndarray
    t: np.ndarray
    violation: np.ndarray
    constraint_multipliers: np.ndarray
    goal_multipliers: np.ndarray
    converged: np.ndarray

    def take(self, rows: np.ndarray) -> Solutions:
        """Solutions of a mask or of positions."""
        return Solutions(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})

    def put(self, rows: np.ndarray, other: Solutions) -> None:
        """Replace the solutions at the given positions."""
        for field in fields(self):
            getattr(self, field.name)[rows] = getattr(other, field.name)


class BatchNlp:
    """The solver of one program and set of rows; derivatives and code are made once.

    Parameters
    ----------
    program : Program
    n_variables : int
    rows : Rows
    edge : float
        By which share the edge of max and min is rounded off; 0: not at all.
    conditions : int
        How many of the last limits never give way: they say where formulas are the right ones.
    settings : NlpSettings
    """

    def __init__(
        self,
        program: Program,
        n_variables: int,
        rows: Rows,
        edge: float = 0.0,
        conditions: int = 0,
        settings: NlpSettings = NLP,
    ) -> None:
        self.rows, self.settings = rows, settings
        self.functions = RowFunctions(program, n_variables, rows, edge)
        self.log_variables = np.array(rows.log_variables, dtype=bool)
        self.equal = np.array([c.sense == "equal" for c in rows.constraints], dtype=bool)
        self.guard = np.array([c.guard for c in rows.constraints], dtype=bool)
        self.rigid = self.guard | (np.arange(len(rows.constraints)) >= len(rows.constraints) - conditions)
        made = kernel_solver(self.functions, settings.method)
        self.solver: InteriorPoint | KernelSolver = made or InteriorPoint(self.functions, settings)
        self.compiled = made is not None
        self._stored = self.functions.compile_stored()
        self._sides = self._compile_sides(program)

    def _compile_sides(self, program: Program) -> Any:
        """Function of both sides and the terms of the rows that enter by a scaled difference."""
        plain = [c for c, log in zip(self.rows.constraints, self.rows.log_constraints, strict=True) if not log]
        sides = [k for c in plain for k in c.nodes]
        return program.compile(sides) if sides else None

    def solve(self, tasks: Tasks, inputs: ProblemInputs, start: np.ndarray, workers: int = 1) -> Solutions:
        """Solve all problems, each from its start, and again from other starts where that fails.

        Parameters
        ----------
        tasks : Tasks
        inputs : ProblemInputs
        start : array (problems, variables)
            SI.
        workers : int
            Threads that may solve at the same time, where the kernel computes.

        Returns
        -------
        Solutions
        """
        count = len(tasks.weights)
        chunk = self.settings.kernel_at_once if self.compiled else self.settings.at_once

        def solved(first: int) -> Solutions:
            deadline.check()  # threads beside know of no end
            rows = slice(first, min(first + chunk, count))
            return self._solve_part(tasks.take(rows), inputs.take(rows), start[rows])

        work = [partial(solved, first) for first in range(0, max(count, 1), chunk)]
        parts = side_by_side(work, workers if self.compiled else 1)
        return Solutions(
            **{field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Solutions)}
        )

    # -- one chunk -----------------------------------------------------------------------------

    def _solve_part(self, tasks: Tasks, inputs: ProblemInputs, start: np.ndarray) -> Solutions:
        low, high, bounds = inputs.low, inputs.high, inputs.bounds
        with np.errstate(all="ignore"):
            clean = inputs.clean()
            scales = self._scales(low, high)
            first = np.clip(start, low, high)
            sizes = self._inverse_sizes(tasks, [*first.T, *clean], bounds)
            worth = worth_of(tasks)
            problems = Problems(
                stored=self._stored(self._fixed_inputs(clean, bounds, sizes, scales)),
                start=self._to_search(first, scales),
                low=self._to_search(low, scales),
                high=self._to_search(high, scales),
                counts=np.concatenate([~inputs.void, np.isfinite(tasks.cutoffs)], axis=1).T,
                slopes=self._slopes(tasks),
                rights=self._rights(tasks),
                weights=(tasks.weights * worth[:, None]).T,
                t_weight=tasks.t_weight * worth,
            )
            ends = self.solver.solve(problems)
            result = self._finished(problems, ends, scales, low, high, worth)
            status = ends.status
            for share in self.settings.other_starts:
                # Where the rows cannot be met near where a solver ended, another start has hardly ever met them.
                missed = ~(result.violation <= self.settings.missed)
                again = np.flatnonzero((status != CONVERGED) & (status != INFEASIBLE) & missed)
                if not len(again):
                    break
                retried = problems.moved(again, share)
                ends = self.solver.solve(retried)
                status[again] = ends.status
                other = self._finished(retried, ends, scales[:, again], low[again], high[again], worth[again])
                _keep_better(result, other, again)
        return result

    def slopes(
        self,
        tasks: Tasks,
        data: Sequence[np.ndarray],
        start: np.ndarray,
        points: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: Sequence[float],
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return values (rows, points) and nonzero derivatives of all rows, in the units that starts give them."""
        with np.errstate(all="ignore"):
            scales = self._scales(low, high)
            sizes = self._inverse_sizes(tasks, [*np.clip(start, low, high).T, *data], bounds)
            stored = self._stored(self._fixed_inputs(data, bounds, sizes, scales))
            first_order = self._first_order(list(self._to_search(points, scales)), [], stored)
            values = np.empty((len(first_order), len(points)))
            for k, value in enumerate(first_order):
                values[k] = value  # many are the same at all points
        rows = self.functions.n_rows
        return values[:rows], values[rows:]

    @cached_property
    def layout(self) -> SparsityPattern:
        """Where the nonzero derivatives stand."""
        return SparsityPattern(self.functions)

    @cached_property
    def _first_order(self) -> Any:
        return self.functions.compile_point(curved=False)

    def _scales(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return the unit of each variable (variables, problems); 1 where the logarithm is the variable."""
        size = np.maximum(np.abs(low), np.abs(high)).T
        plain = ~self.log_variables[:, None] & (size > 0) & np.isfinite(size)
        return np.where(plain, size, 1.0)

    def _to_search(self, values: np.ndarray, scales: np.ndarray) -> np.ndarray:
        logs = self.log_variables[:, None]
        return np.where(logs, np.log(np.where(logs, values.T, 1.0)), values.T / scales)

    def _inverse_sizes(self, tasks: Tasks, inputs: Sequence[Any], bounds: Sequence[float]) -> list[Any]:
        """Return one over what one unit of a scaled difference is, per row."""
        result: list[Any] = []
        sides = iter([] if self._sides is None else self._sides(inputs))
        for j, constraint in enumerate(self.rows.constraints):
            if self.rows.log_constraints[j]:
                result.append(1.0)
                continue
            value = next(sides)
            limit = bounds[j] if constraint.limit is None else next(sides)
            size = size_of_miss(value, limit, constraint.scale if constraint.terms is None else next(sides))
            result.append(1.0 / np.where(np.isfinite(size) & (size > SMALLEST), size, 1.0))
        return [*result, *(1.0 / tasks.goal_scales)]

    def _fixed_inputs(
        self, data: Sequence[Any], bounds: Sequence[float], sizes: Sequence[Any], scales: np.ndarray
    ) -> list[Any]:
        nothing = [0.0] * self.functions.n
        return [
            *nothing,
            *data,
            *bounds,
            *sizes,
            *(1.0 if log else s for log, s in zip(self.log_variables, scales, strict=True)),
        ]

    def _slopes(self, tasks: Tasks) -> np.ndarray:
        give = np.where(self.rigid, 0.0, tasks.elastic)
        return np.concatenate([np.broadcast_to(give, (len(tasks.cutoffs), len(give))), tasks.slopes], axis=1).T

    def _rights(self, tasks: Tasks) -> np.ndarray:
        margin = np.where(self.guard, -GUARD_MARGIN, 0.0)
        cutoffs = np.where(np.isfinite(tasks.cutoffs), tasks.cutoffs, 0.0)
        allowed = np.broadcast_to(margin, (len(cutoffs), len(margin))) + (0.0 if tasks.moved is None else tasks.moved)
        return np.concatenate([allowed, cutoffs], axis=1).T

    def _finished(
        self, problems: Problems, ends: Ends, scales: np.ndarray, low: np.ndarray, high: np.ndarray, worth: np.ndarray
    ) -> Solutions:
        constraints = self.functions.n_constraints
        logs = self.log_variables[:, None]
        variables = np.where(logs, np.exp(np.where(logs, ends.y, 0.0)), ends.y * scales)
        t = self._least_t(problems, ends)
        excess = ends.rows - problems.slopes * t - problems.rights
        excess[:constraints] = np.where(self.equal[:, None], np.abs(excess[:constraints]), excess[:constraints])
        excess = np.where(problems.counts, np.where(np.isnan(excess), np.inf, excess), 0.0)
        return Solutions(
            variables=np.clip(variables.T, low, high),
            phi=ends.rows[constraints:].T,
            t=t,
            violation=excess.max(axis=0, initial=0.0),
            constraint_multipliers=(ends.multipliers[:constraints] / worth).T,
            goal_multipliers=(ends.multipliers[constraints:] / worth).T,
            converged=ends.status == CONVERGED,
        )

    def _least_t(self, problems: Problems, ends: Ends) -> np.ndarray:
        """Return the least t that all rows allow at the point, where only upper limits speak of it."""
        speaks = problems.counts & (problems.slopes != 0)
        soft = speaks & (problems.slopes > 0)
        soft[: len(self.equal)] &= ~self.equal[:, None]
        needed = np.where(soft, (ends.rows - problems.rights) / np.where(soft, problems.slopes, 1.0), -np.inf)
        least = needed.max(axis=0, initial=-np.inf)
        exact = (problems.t_weight > 0) & np.isfinite(least) & np.all(soft == speaks, axis=0)
        return np.where(exact, least, ends.t)


def worth_of(tasks: Tasks) -> np.ndarray:
    """Return factors for the objective that make multipliers a matter of ones, one per problem."""
    slopes = np.where(np.isfinite(tasks.cutoffs), tasks.slopes, 0.0)
    slope = np.maximum(np.max(slopes, axis=1, initial=0.0), tasks.elastic)
    by_t = np.where(slope > 0, tasks.t_weight / np.where(slope > 0, slope, 1.0), 0.0)
    size = np.maximum(np.max(np.abs(tasks.weights), axis=1, initial=0.0), by_t)
    return np.where(size > 0, 1.0 / np.where(size > 0, size, 1.0), 1.0)


def _keep_better(result: Solutions, other: Solutions, places: np.ndarray) -> None:
    """Put those of other solutions into their places that break their rows less."""
    better = other.violation < result.violation[places]
    result.put(places[better], other.take(better))
