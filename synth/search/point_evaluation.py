"""Single designs, many at a time: whether they are feasible, and what their objectives are.

What the search finds feasible keeps limits more closely than feasibility asks for, so that designs do not live off the
tolerance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from synth.model.constraint import Constraint, Goal, NodeConstraint, void_limits
from synth.model.model import Evaluation
from synth.order.feasibility import TOLERANCE, holds, residual
from synth.order.margins import below
from synth.question.search_space import SearchSpace
from synth.search.archive import Candidate, rows_of
from synth.search.log_objectives import LogObjectives
from synth.search.refused_cells import not_refused
from synth.search.settings import TUNING, Tuning


class PointEvaluation:
    """Evaluates designs of a question: combinations with values of the variables.

    Parameters
    ----------
    instance : SearchSpace
    constraints : list of Constraint
    goals : list of Goal
    objectives : LogObjectives
    immovable : array of bool (limits,)
        Limits that no continuous variable moves: they need no more than the full tolerance, as nothing near to a
        design keeps them more closely.
    tuning : Tuning
    """

    def __init__(
        self,
        instance: SearchSpace,
        constraints: Sequence[Constraint],
        goals: Sequence[Goal],
        objectives: LogObjectives,
        immovable: np.ndarray,
        tuning: Tuning = TUNING,
    ) -> None:
        self.instance, self.constraints, self.objectives = instance, constraints, objectives
        self.margins = tuning.tolerances
        self.n = len(instance.model.variables)
        self._node_constraints = node_constraints = [NodeConstraint.of(x) for x in constraints]
        self._senses = np.array([float(g.sign) for g in goals])
        kinds = [(c.sense, c.guard) for c in node_constraints]
        self._of_kind = {kind: np.flatnonzero([k == kind for k in kinds]) for kind in dict.fromkeys(kinds)}
        self._scales = np.array([c.scale for c in node_constraints], dtype=float)
        self._most_terms = np.array([c.most_terms for c in constraints], dtype=float)
        self._tolerances = np.where(immovable, TOLERANCE, tuning.tolerances.limit)
        values = [c.value for c in node_constraints]
        bounds = [c.value if c.limit is None else c.limit for c in node_constraints]
        # A limit without terms of its own reads its value in their place, which changes no size.
        terms = [c.value if c.terms is None else c.terms for c in node_constraints]
        nodes, model = (*values, *bounds, *terms, *(g.node for g in goals)), instance.model
        self._sides = model.function(("screen", nodes), lambda: model.program.compile(nodes))
        self._constant = {len(node_constraints) + k: c.bound for k, c in enumerate(node_constraints) if c.limit is None}

    def evaluate(self, variables: np.ndarray, combinations: np.ndarray) -> Evaluation:
        """Evaluate all that is declared for designs (designs, variables), (designs,)."""
        return self.instance.evaluate(variables, self.instance.data(np.asarray(combinations)))

    def feasible_rows(self, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of the feasible points, and phi of all points.

        Parameters
        ----------
        variables : array (points, variables)
        combinations : array (points,)

        Returns
        -------
        tuple of array (feasible,), array (points, objectives)
        """
        phi, closely = self._judged(variables, combinations, self._tolerances)
        return np.flatnonzero(closely), phi

    def edge_rows(self, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of the points that are feasible by the full tolerance alone, and phi of all points.

        Where something that moves continuously enters a limit such a point is of use only if nothing near to it keeps
        the limit more closely: ``PrimalHeuristics.on_edge``.
        """
        phi, held = self._judged(variables, combinations, np.full(len(self._node_constraints), TOLERANCE))
        rows = np.flatnonzero(held)
        closely = np.isin(rows, rows[self.feasible_rows(variables[rows], combinations[rows])[0]])
        return rows[~closely], phi

    def as_they_are(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        """Designs with phi of their values: those on the edge count as worse while they are compared."""
        if not candidates:
            return []
        combinations, variables, _ = rows_of(candidates)
        _, phi = self.feasible_rows(variables.reshape(len(candidates), self.n), combinations)
        return [replace(c, phi=values) for c, values in zip(candidates, phi, strict=True)]

    def promising(self, variables: Sequence[np.ndarray], combinations: np.ndarray, cutoffs: np.ndarray) -> np.ndarray:
        """Mask of points that may be feasible and below cutoffs of phi; ``feasible_rows`` decides.

        What many points have in common is computed once for them, so this costs much less than to look at each.

        Parameters
        ----------
        variables, combinations : array per variable, array
            That broadcast to (designs, points of each).
        cutoffs : array (designs, objectives)
            Of the first objectives.
        """
        data = self.instance.data(combinations)
        keep = np.ones(np.broadcast_shapes(combinations.shape, *(x.shape for x in variables)), dtype=bool)
        most = self.objectives.values_of(cutoffs + 2 * self.margins.tie * np.maximum(np.abs(cutoffs), 1.0))
        limits = len(self._node_constraints)
        with np.errstate(all="ignore"):
            sides = self._screen([*variables, *data])
            for k, sign in enumerate(self._senses[: cutoffs.shape[1]]):
                keep &= sign * sides[3 * limits + k] <= most[:, k, None]
            for j, constraint in enumerate(self._node_constraints):
                value, limit, terms = (sides[first + j] for first in (0, limits, 2 * limits))
                # Where a limit holds within the tolerance, it does within twice that of its own size, and little more.
                least = constraint.scale if constraint.terms is None else terms
                margin = 4 * TOLERANCE * np.maximum(np.abs(limit), least)
                kept = np.True_ if constraint.sense == "at_least" else value <= limit + margin
                kept = kept if constraint.sense == "at_most" else kept & (value >= limit - margin)
                for k in self.constraints[j].void_without:
                    kept = kept | np.isnan(np.asarray(data[k], dtype=float))
                keep &= kept
        return keep

    def _judged(
        self, variables: np.ndarray, combinations: np.ndarray, tolerances: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return phi of points, and which of them are feasible with these tolerances of the limits."""
        count = len(combinations)
        if not count:
            return np.empty((0, len(self._senses))), np.empty(0, dtype=bool)
        data = self.instance.data(np.asarray(combinations))
        with np.errstate(all="ignore"):
            raw = self._screen([variables[:, k] for k in range(self.n)] + list(data))
            sides = np.empty((len(raw), count))
            for row, x in zip(sides, raw, strict=True):
                row[:] = x
            limits = len(self._node_constraints)
            phi = self.objectives.phi_of((sides[3 * limits :] * self._senses[:, None]).T)
            held = void_limits(self.constraints, data, count).T
            for (sense, guard), rows in self._of_kind.items():
                terms = np.fmin(np.abs(sides[2 * limits + rows]), self._most_terms[rows, None])
                least = np.fmax(terms, self._scales[rows, None])
                r = residual(sides[rows], sides[limits + rows], sense, least)
                held[rows] |= holds(r, guard, tolerances[rows, None])
        feasible = held.all(axis=0) & np.all(np.isfinite(phi), axis=1) & not_refused(self.instance, combinations)
        feasible &= np.all(variables >= below(self.instance.ranges.lower, self.margins.pinned), axis=1)
        return phi, feasible

    def _screen(self, inputs: Sequence[Any]) -> list[Any]:
        """Return both sides of all limits and the objectives: all that tells whether a point is feasible."""
        return [self._constant.get(k, x) for k, x in enumerate(self._sides(inputs))]
