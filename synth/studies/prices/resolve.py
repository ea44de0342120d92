"""Questions solved again with one requirement or limit moved a little, thousands of continuous problems at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.errors import InputError
from synth.model.constraint import Constraint
from synth.model.program import InputValue
from synth.nlp.batch import Solutions
from synth.order.feasibility import holds, residual
from synth.question.instance import Instance
from synth.question.refusals import allowed_rows, refuse_requirements
from synth.question.requirement_values import RequirementValues
from synth.results import ParetoFront
from synth.search.formulation import Formulation
from synth.search.goals import goals_of
from synth.search.refused_cells import not_refused
from synth.search.sensitivity import held, requirement_positions, sides
from synth.studies.settings import PRICES, PriceLimits


@dataclass(frozen=True)
class Move:
    """One requirement, limit or range of a size, multiplied by a factor; ``refused``: why that is not admissible."""

    kind: str
    name: str
    position: int  # among the requirements in force, the limits, or the ranges
    factor: float
    values: RequirementValues
    refused: str = ""


class Resolver:
    """One question, to be solved again with one requirement or limit moved.

    Parameters
    ----------
    instance : Instance
    front : ParetoFront
        Its objectives, and its designs as parts to try.
    step : float
        Share by which each requirement and limit is moved.
    limits : PriceLimits
    """

    def __init__(self, instance: Instance, front: ParetoFront, step: float, limits: PriceLimits = PRICES) -> None:
        self.instance, self.step, self.limits = instance, step, limits
        chosen = dict(front.frame.objectives)
        self.m = len(chosen)
        self.form = Formulation(instance, goals_of(instance, chosen), self.m)
        self.logs = np.array(self.form.continuous.rows.log_constraints, dtype=bool)
        self.fixed = self.form.unmoved(gridded=True)
        self.directions = np.array([-1.0 if c.sense == "at_least" else 1.0 for c in self.form.node_constraints])
        self.limit_names = [x.name for x in instance.constraints]
        self.ranges = self._ranges()
        self.positions = requirement_positions(self.form)
        self.known = np.unique([instance.combinations.number(d) for d in front.designs])
        # All that is moved by the step, then all by a fine step.
        self.moves = [*self._moves(step), *self._moves(limits.fine * step)]
        self.count = len(self.moves) // 2
        names = list(self.positions)
        self.requirements = np.array([[m.values.requirements[n] for n in names] for m in self.moves])
        self.factors = np.array([m.factor for m in self.moves])
        self.limit_of = np.array([m.position if m.kind == "limit" else -1 for m in self.moves])
        self.range_of = np.array([m.position if m.kind == "range" else -1 for m in self.moves])

    def _ranges(self) -> list[tuple[int, Constraint]]:
        """Return the limits that the user put on sizes, each with the number of the variable."""
        among = {v.name: k for k, v in enumerate(self.instance.model.variables)}
        return [(among[x.quantity], x) for x in self.instance.limits.bounding if x.quantity in among]

    def holds_range(self, number: int) -> tuple[bool, bool]:
        """True if a limit on a size is the lower, and the upper, end of its range."""
        k, x = self.ranges[number]
        return (
            x.sense != "at_most" and bool(x.bound >= self.form.lower[k]),
            x.sense != "at_least" and bool(x.bound <= self.form.upper[k]),
        )

    def _ends(self, moves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the range of every variable, problem by problem."""
        form, variables = self.form, self.instance.model.variables
        low, high = (np.tile(ends, (len(moves), 1)) for ends in (form.lower, form.upper))
        for number, (k, x) in enumerate(self.ranges):
            rows = np.flatnonzero((moves >= 0) & (self.range_of[moves] == number))
            others = [y for n, (j, y) in enumerate(self.ranges) if j == k and n != number]
            moved = x.bound * self.factors[moves[rows]]
            if x.sense != "at_most":
                least = max([variables[k].lower, *(y.bound for y in others if y.sense != "at_most")])
                low[rows, k] = np.maximum(moved, least)
            if x.sense != "at_least":
                most = min([variables[k].upper, *(y.bound for y in others if y.sense != "at_least")])
                high[rows, k] = np.minimum(moved, most)
        return low, high

    def _moves(self, step: float) -> list[Move]:
        """Return all that is moved by a step: upwards, downwards, in turn."""
        moves, values, model = [], self.instance.values, self.instance.model
        for k, name in enumerate(self.positions):
            for factor in (1.0 + step, 1.0 - step):
                moved_values, why = values, ""
                try:
                    moved = values.moved(model, name, values.requirements[name] * factor)
                    refuse_requirements(model, moved)
                    moved_values = moved
                except InputError as error:
                    why = f"cannot be asked ({error})"
                moves.append(Move("requirement", name, k, factor, moved_values, why))
        for j, name in enumerate(self.limit_names):
            moves += [Move("limit", name, j, f, values) for f in (1.0 + step, 1.0 - step)]
        for r, (_, x) in enumerate(self.ranges):
            moves += [Move("range", x.name, r, f, values) for f in (1.0 + step, 1.0 - step)]
        return moves

    def others(self, combination: int) -> np.ndarray:
        """Combinations that are tried in addition to that of a design."""
        total = self.instance.combinations.count
        if total <= self.limits.all:
            tried = np.arange(total, dtype=np.int64)
        else:
            tried = np.concatenate([self.instance.combinations.neighbours(combination), self.known])
        return self._offered(tried, np.array([combination]))

    def around(self, combinations: np.ndarray, known: np.ndarray) -> np.ndarray:
        """Return the combinations that differ in one part from some, but for those known."""
        near = [self.instance.combinations.neighbours(int(c)) for c in combinations]
        return self._offered(np.concatenate([np.empty(0, dtype=np.int64), *near]), known)

    def _offered(self, combinations: np.ndarray, known: np.ndarray) -> np.ndarray:
        new = np.setdiff1d(combinations, known)
        kept: np.ndarray = new[not_refused(self.form.instance, new)]
        return kept

    # -- solving -------------------------------------------------------------------------------

    def solved(
        self, combinations: np.ndarray, start: np.ndarray, moves: np.ndarray, phi: np.ndarray, k: int
    ) -> tuple[Solutions, np.ndarray, np.ndarray]:
        """Solve many problems, each with one thing moved (-1: nothing); the other objectives are held at phi.

        Returns
        -------
        tuple
            The solutions, which of them keep all limits, and the number of a limit that no size moves and that is
            broken (-1: none).
        """
        form, count = self.form, len(combinations)
        data = list(self.instance.data(combinations))
        for q, position in enumerate(self.positions.values()):
            column = np.where(moves >= 0, self.requirements[moves, q], float(data[position]))
            if np.any(column != data[position]):
                data[position] = column
        shifts = self._shifts(moves, start, data)
        tasks = held(form, np.tile(phi, (count, 1)), self.m, k, shifts)
        possible, missed = np.ones(count, dtype=bool), form.tuning.nlp.missed
        if form.n:
            low, high = self._ends(moves)
            possible = np.all(low <= high, axis=1)
            solved = form.continuous.solve_batch(
                tasks, combinations, start, np.minimum(low, high), high, self.fixed, data
            )
        else:
            nothing = np.zeros((count, 0))
            values = form.model.evaluate(nothing, data).values
            signed = np.stack([g.sign * values[n] for g, n in zip(form.goals, form.names, strict=True)], axis=1)
            reached = form.objectives.phi_of(signed)
            over = np.max(np.where(np.isfinite(tasks.cutoffs), reached - tasks.cutoffs, 0.0), axis=1, initial=0.0)
            none = np.zeros((count, len(form.node_constraints)))
            solved = Solutions(nothing, reached, np.zeros(count), over, none, np.zeros(reached.shape), over <= missed)
        broken = self._broken(solved.variables, moves, data)
        kept = (solved.violation <= missed) & np.isfinite(solved.phi[:, k]) & (broken < 0) & possible
        kept[kept] &= self._allowed(combinations[kept], moves[kept])
        return solved, kept, broken

    def _shifts(self, moves: np.ndarray, start: np.ndarray, data: Sequence[InputValue]) -> np.ndarray:
        """Return by how much the rows of limits give way."""
        shifts = np.zeros((len(moves), len(self.form.node_constraints)))
        rows = np.flatnonzero((moves >= 0) & (self.limit_of[moves] >= 0))
        if len(rows):
            limits, factors = self.limit_of[moves[rows]], self.factors[moves[rows]]
            shift = np.log(factors)
            plain = ~self.logs[limits]
            if plain.any():
                sizes, bounds = sides(self.form, np.clip(start, self.form.lower, self.form.upper), data)
                with np.errstate(all="ignore"):
                    shift = np.where(plain, (factors - 1.0) * bounds[rows, limits] / sizes[rows, limits], shift)
            shifts[rows, limits] = self.directions[limits] * np.nan_to_num(shift)
        return shifts

    def _broken(self, points: np.ndarray, moves: np.ndarray, data: Sequence[InputValue]) -> np.ndarray:
        """Return a limit that no size moves and that a point breaks; -1 where there is none."""
        broken = np.full(len(moves), -1)
        if not self.fixed.any():
            return broken
        form = self.form
        result = form.instance.evaluate(points, data)
        for j in np.flatnonzero(self.fixed):
            x = form.constraints[j]
            value, limit = result.limits[x.name]
            factor = np.where((moves >= 0) & (self.limit_of[moves] == j), self.factors[moves], 1.0)
            with np.errstate(all="ignore"):
                kept = (
                    holds(residual(value, limit * factor, x.sense, result.scales[x.name]), x.guard)
                    | result.void[x.name]
                )
            broken[~kept & (broken < 0)] = j
        return broken

    def _allowed(self, combinations: np.ndarray, moves: np.ndarray) -> np.ndarray:
        """Tell which combinations are not refused where a requirement is moved."""
        allowed, model = np.ones(len(combinations), dtype=bool), self.instance.model
        # Rows that are refused by themselves were left out for the requirements as they are, not as they are moved.
        every = [r for r, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True) if kinds]
        for number in np.unique(moves[moves >= 0]):
            move, rows = self.moves[number], moves == number
            if move.kind == "requirement":
                data = self.instance.data(combinations[rows], move.values)
                allowed[rows] = not move.refused and allowed_rows(model, every, data, int(rows.sum()))
        return allowed

    def difference(self, reference: int, other: int) -> str:
        """Differences of another combination from the reference, in words."""
        changes = self.instance.combinations.differences(reference, other)
        return ", ".join(f"{name} {mine} -> {its}" for name, mine, its in changes)
