"""All limits taken together: a linear program in logarithms bounds an objective over a box, or shows that it is empty.

Propagation looks at limits one by one, so that a box survives where each limit alone can hold. Here all limits and all
formulas between them are linear inequalities between logarithms (:mod:`synth.bounds.log_forms`): products of powers
and limits between them exactly so, and sums within bounds
that are off by the square of the width of the box.

*Sums.* Of positive numbers with c = a + b, log c = log a + f(d) with d = log b - log a and f(d) = log(1 + exp d). f is
convex: each tangent lies below it, and over an interval of d the secant lies above it. Both are linear in the three
logarithms. With s = 1/(1 + exp -t) the tangent at t is log c >= (1 - s) log a + s log b + f(t) - s t. Differences are
the same read the other way round.

*Largest.* log max(a, b) = log a + max(0, d): at least either, and at most the secant over the interval of d. *Least*
likewise.

*Special functions.* With elasticities between e and E in each argument, on the way from the corner of the lower ends
log f rises by at least e and at most E times the distance, argument by argument; likewise from the corner of the
upper ends.

*Bound.* Let x be the columns above their lower ends, 0 <= x <= w, and let rows A x <= b hold for every feasible design.
Then any y <= 0 gives c.x = (c - A'y).x + y.(A x) >= sum min(0, (c - A'y)_j w_j) + y.b (weak duality; Neumaier and
Shcherbina 2004). So a program that was solved inexactly, or not to its end, costs nothing but tightness: y is what the
solver says, clipped to its sign, and the right side is computed here, with its rounding taken off. What is
left of an upper end C of the objective above the bound B limits each column by the same sum: r_j x_j <= C - B where
r_j = (c - A'y)_j > 0, and |r_j| (w_j - x_j) <= C - B where it is negative.

A box in which the rows contradict each other is no special case: the program lets all rows give way by the same amount,
at a cost. No design makes use of it, so that the bound holds; where nothing is feasible it lies above all that the
objective can be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.intervals import ROUNDING
from synth.bounds.log_forms import ELASTIC, LARGEST, SUM, LogForms, Relation, log_forms
from synth.bounds.propagated_nodes import CONSTANT
from synth.bounds.propagation import Propagation
from synth.bounds.root_propagation import Leaves, propagated_boxes
from synth.bounds.settings import TogetherLimits
from synth.model.constraint import NodeConstraint
from synth.model.program import Program
from synth.order.margins import Numbers, above, below
from synth.special import SpecialFunction

ROUNDED = 1e-11  # in logarithm: more than the rounding of any formula, and of the coefficients here
SUMMED = 1e-13  # of the terms of a sum: more than the rounding of adding them up
NOISE = 1e-9  # of the terms of a sum: what is smaller may be rounding
LEAST_NUMBER, LARGEST_NUMBER = 5e-324, float(np.finfo(float).max)

Ends = list[Any]  # of each node: a number, or one per box
Side = Sequence[tuple[int, Any]]  # nodes with their coefficients: numbers, or one per box


@dataclass(frozen=True)
class RelaxedPoints:
    """Where the linear programs of some boxes with the same signs ended: it steers and proves nothing.

    Parameters
    ----------
    forms : LogForms
    rows : array (boxes,)
        Which boxes these are.
    logs : array (boxes, nodes)
        Logarithms of the sizes of the nodes that have a form.
    low, high : array (boxes, nodes)
        Their ends.
    """

    forms: LogForms
    rows: np.ndarray
    logs: np.ndarray
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class BoundedTogether:
    """What is known of boxes by all limits together.

    Parameters
    ----------
    boxes : Boxes
        Tightened, with lower bounds of the objective.
    alive : array (boxes,)
        Whether anything of use may be left.
    points : list of RelaxedPoints
        Of groups of them.
    """

    boxes: Boxes
    alive: np.ndarray
    points: list[RelaxedPoints]


class LogRelaxation:
    """Bounds over boxes of one question by all its limits together.

    Parameters
    ----------
    propagation : Propagation
    settings : TogetherLimits
    """

    def __init__(self, propagation: Propagation, settings: TogetherLimits) -> None:
        self.propagation, self.question, self.settings = propagation, propagation.question, settings
        self.nodes = self.question.contractors[False].nodes
        self._values = dict(zip(self.nodes.constants, self.question.constants[False], strict=True))
        self._forms: dict[bytes, LogForms] = {}

    def run(self, boxes: Boxes, cutoffs: np.ndarray, target: int) -> BoundedTogether:
        """Tighten boxes.

        Parameters
        ----------
        boxes : Boxes
        cutoffs : array (boxes, objectives)
            Upper bounds of objectives, with their sign; infinite where there is none.
        target : int
            The objective to bound.
        """
        low, high, dead = self._ends(boxes, cutoffs)
        signs = np.stack([self._sign(k, low[k], high[k], len(boxes)) for k in range(len(low))], axis=1)
        tight = replace(boxes, low=boxes.low.copy(), high=boxes.high.copy(), bounds=boxes.bounds.copy())
        alive, points = ~dead, list[RelaxedPoints]()
        for pattern in np.unique(signs[alive], axis=0):
            group = np.flatnonzero(alive & np.all(signs == pattern, axis=1))
            forms = self._forms_of(pattern)
            program = _Programs(forms, [_select(x, group) for x in low], [_select(x, group) for x in high], len(group))
            program.relate(self.nodes.program, self.settings.tangents)
            for constraint, right_side in zip(self.nodes.constraints, self.question.right_sides, strict=True):
                program.limit(constraint, right_side)
            for j, goal in enumerate(self.nodes.goals):
                if j != target:
                    program.cap(goal.node, goal.sign, cutoffs[group, j])
            goal = self.nodes.goals[target]
            solved = program.solve(goal.node, goal.sign, self.settings.yield_cost)
            alive[group] = solved.alive
            if goal.node in forms.place:
                side = goal.sign * int(pattern[goal.node])
                size = np.exp(np.clip(side * solved.bound, -700.0, 700.0))
                tight.bounds[group, target] = np.fmax(tight.bounds[group, target], below(side * size, ROUNDED))
            self._tighten(tight, group, forms, solved)
            points.append(RelaxedPoints(forms, group, solved.logs, program.low, program.high))
        alive &= ~np.any(tight.low > above(tight.high, ROUNDING), axis=1)
        np.maximum(tight.high, tight.low, out=tight.high)
        return BoundedTogether(tight, alive, points)

    def _ends(self, boxes: Boxes, cutoffs: np.ndarray) -> tuple[Ends, Ends, np.ndarray]:
        """Ranges of every node in each box, and which boxes are empty."""
        tables = self.propagation.tables[False]
        ends = [np.array([x.take(boxes.cell[:, f]) for f, *both in tables for x in (both[side],)]) for side in (0, 1)]
        question = self.question
        leaves = Leaves(boxes.low.T, boxes.high.T, (ends[0], ends[1]), question.constants[False], question.right_sides)
        return propagated_boxes(self.nodes, leaves, list(cutoffs.T), self.settings.sweeps)

    def _sign(self, k: int, low: Numbers, high: Numbers, count: int) -> np.ndarray:
        """Return the sign of a node per box; 0 where it is not known, or where nothing may be concluded of it."""
        usable = self.nodes.kind[k] == CONSTANT or self.nodes.narrows[k]
        sign = (np.asarray(low) > 0).astype(np.int8) - (np.asarray(high) < 0).astype(np.int8)
        return np.broadcast_to(sign if usable else np.int8(0), (count,))

    def _forms_of(self, pattern: np.ndarray) -> LogForms:
        key = pattern.tobytes()
        if key not in self._forms:
            self._forms[key] = log_forms(self.nodes, pattern, self._values)
        return self._forms[key]

    def _tighten(self, boxes: Boxes, group: np.ndarray, forms: LogForms, solved: Solved) -> None:
        """Cut the ends of variables by those of their columns, in place."""
        for column, k in enumerate(forms.columns):
            if k in self.nodes.variables and forms.signs[k] > 0:
                i = self.nodes.position(k)
                least, most = (np.exp(x[:, column]) for x in (solved.least, solved.most))
                boxes.low[group, i] = np.fmax(boxes.low[group, i], below(least, ROUNDED))
                boxes.high[group, i] = np.fmin(boxes.high[group, i], above(most, ROUNDED))


@dataclass(frozen=True)
class Solved:
    """Solutions of the linear programs of boxes.

    Parameters
    ----------
    alive : array (boxes,)
    bound : array (boxes,)
        Lower bound of the objective: of the logarithm of its size, with the sign of the objective.
    least, most : array (boxes, columns)
        Contracted ends of the columns.
    logs : array (boxes, nodes)
        Of the nodes that have a form: where the program ended.
    """

    alive: np.ndarray
    bound: np.ndarray
    least: np.ndarray
    most: np.ndarray
    logs: np.ndarray


class _Programs:
    """The linear programs of some boxes with the same signs: rows of nodes that are at most a right side.

    Parameters
    ----------
    forms : LogForms
    low, high : list
        Ends of all nodes.
    count : int
        Boxes.
    """

    def __init__(self, forms: LogForms, low: Ends, high: Ends, count: int) -> None:
        self.forms, self.count = forms, count
        self.low, self.high = np.empty((count, len(forms.place))), np.empty((count, len(forms.place)))
        for k, place in forms.place.items():
            ends = (low[k], high[k]) if forms.signs[k] > 0 else (-np.asarray(high[k]), -np.asarray(low[k]))
            self.low[:, place] = np.log(np.maximum(ends[0], LEAST_NUMBER))
            self.high[:, place] = np.log(np.minimum(ends[1], LARGEST_NUMBER))
        self.low -= ROUNDED
        self.high += ROUNDED
        columns = [forms.place[k] for k in forms.columns]
        self.start = self.low[:, columns]
        self.width = np.maximum(self.high[:, columns] - self.start, 0.0)
        self.rows: list[tuple[Side, Any]] = []

    # -- rows ----------------------------------------------------------------------------------

    def limit(self, constraint: NodeConstraint, right_side: float) -> None:
        """Add a limit, loosened as everywhere, where both sides have the same sign."""
        place, v, w, terms = self.forms.place, constraint.value, constraint.limit, constraint.terms
        if any(k not in place for k in constraint.nodes):
            return
        sign = self.forms.signs[v]
        if sign != (np.sign(right_side) if w is None else self.forms.signs[w]):
            return
        with np.errstate(all="ignore"):
            least = abs(right_side) if w is None else np.exp(self.low[:, place[w]])
            size = constraint.scale if terms is None else np.exp(self.high[:, place[terms]])
            loose = -np.log1p(-np.minimum(constraint.slack * np.maximum(1.0, size / least), 1.0))
        offset = np.log(abs(right_side)) if w is None else 0.0
        for sense, direction in (("at_most", 1.0), ("at_least", -1.0)):
            if constraint.sense in (sense, "equal"):
                side = direction * float(sign)
                other = [] if w is None else [(w, -side)]
                self.rows.append(([(v, side), *other], side * offset + loose))

    def cap(self, goal: int, sense: int, cutoffs: np.ndarray) -> None:
        """Add an upper bound of an objective with its sense, where there is one and the objective has a sign."""
        if goal in self.forms.place:
            side = float(sense * self.forms.signs[goal])
            with np.errstate(all="ignore"):
                # A cutoff on the other side of zero says nothing that ranges do not say.
                right = np.where(side * cutoffs > 0, side * np.log(np.abs(cutoffs)), np.inf)
            self.rows.append(([(goal, side)], right))

    def relate(self, program: Program, tangents: Sequence[float]) -> None:
        """Add what holds between nodes."""
        for relation in self.forms.relations:
            if relation.kind == SUM:
                self._sum(relation, tangents)
            elif relation.kind == ELASTIC:
                self._elastic(relation, program.specials[int(program.nodes[relation.nodes[0]].constant)])
            elif relation.kind == LARGEST:
                self._extreme(relation, 1.0)
            else:
                self._extreme(relation, -1.0)

    def _sum(self, relation: Relation, tangents: Sequence[float]) -> None:
        """Bound log c = log a + f(d) by tangents and a secant."""
        c, a, b = relation.nodes
        low, high = self._apart(a, b)
        for share in tangents:
            at = low + share * (high - low)
            s = np.exp(-np.logaddexp(0.0, -at))
            self.rows.append(([(a, 1.0 - s), (b, s), (c, -1.0)], s * at - np.logaddexp(0.0, at)))
        first, last = np.logaddexp(0.0, low), np.logaddexp(0.0, high)
        s = (last - first) / (high - low)
        self.rows.append(([(c, 1.0), (a, s - 1.0), (b, -s)], first - s * low))

    def _extreme(self, relation: Relation, side: float) -> None:
        """Bound side log c = side log a + max(0, side d), with d = log b - log a."""
        c, a, b = relation.nodes
        self.rows += [([(x, side), (c, -side)], 0.0) for x in (a, b)]
        low, high = self._apart(a, b)
        first, last = (low, high) if side > 0 else (-high, -low)
        s = (np.maximum(last, 0.0) - np.maximum(first, 0.0)) / (last - first)
        right = np.maximum(first, 0.0) - s * first
        self.rows.append(([(c, side), (a, side * (s - 1.0)), (b, -side * s)], right))

    def _apart(self, a: int, b: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the interval of log b - log a: by their ends, and by their forms, in which something may cancel."""
        forms, i, j = self.forms, self.forms.place[a], self.forms.place[b]
        form = forms.matrix[j] - forms.matrix[i]
        start = self.start @ form + (forms.constants[j] - forms.constants[i])
        low = np.maximum(self.low[:, j] - self.high[:, i], start + self.width @ np.minimum(form, 0.0) - ROUNDED)
        high = np.minimum(self.high[:, j] - self.low[:, i], start + self.width @ np.maximum(form, 0.0) + ROUNDED)
        return np.minimum(low, high) - ROUNDED, np.maximum(low, high) + ROUNDED

    def _elastic(self, relation: Relation, function: SpecialFunction) -> None:
        """Bound the logarithm of a special function by its elasticities, from two corners."""
        c, *args = relation.nodes
        places = [self.forms.place[a] for a in args]
        low, high = self.low[:, places], self.high[:, places]
        with np.errstate(all="ignore"):
            known = function.exists([(np.exp(low[:, j]), np.exp(high[:, j])) for j in range(len(args))])
            corners = [np.log(function.formula(*np.exp(ends).T)) for ends in (low, high)]
        for side in (1.0, -1.0):
            # Up from the lower ends: at most by the largest elasticities, at least by the least; down alike.
            for ends, value, up in zip((low, high), corners, (1.0, -1.0), strict=True):
                rate = np.array([pair[1 if side * up > 0 else 0] for pair in function.elasticity])
                if np.all(np.isfinite(rate)):
                    right = side * (value - ends @ rate)
                    right = np.where(known & np.isfinite(right), right, np.inf)
                    self.rows.append(([(c, side), *((a, -side * r) for a, r in zip(args, rate, strict=True))], right))

    # -- solving -------------------------------------------------------------------------------

    def solve(self, goal: int, sense: int, yield_cost: float) -> Solved:
        """Bound an objective over each box; one without a sign gets no bound, but empty boxes are still detected."""
        forms, matrix, right = self.forms, *self._assembled()
        cost, base, most = np.zeros(len(forms.columns)), np.zeros(self.count), np.zeros(self.count)
        if goal in forms.place:
            place, side = forms.place[goal], float(sense * forms.signs[goal])
            cost = side * forms.matrix[place]
            base = self.start @ cost + side * forms.constants[place]
            most = self.high[:, place] if side > 0 else -self.low[:, place]
        alive, bound = np.ones(self.count, dtype=bool), np.empty(self.count)
        least, greatest = self.start.copy(), self.start + self.width
        logs = np.empty((self.count, len(forms.place)))
        for i in range(self.count):
            point, multipliers = _solved(cost, matrix[i], right[i], self.width[i], yield_cost)
            bound[i], residual = _bound(cost, matrix[i], right[i], self.width[i], multipliers)
            bound[i] += base[i] - ROUNDED - SUMMED * abs(base[i])
            alive[i] = bound[i] <= most[i]
            slack = max(most[i] - bound[i], 0.0)
            # A coefficient that is rounding error alone bounds nothing.
            residual = np.where(
                np.abs(residual) > NOISE * (np.abs(cost) + np.abs(multipliers) @ np.abs(matrix[i])), residual, 0.0
            )
            with np.errstate(all="ignore"):
                reach = above(np.minimum(slack / np.abs(residual), self.width[i]), SUMMED, ROUNDED)
            greatest[i] = np.where(residual > 0, least[i] + reach, greatest[i])
            least[i] = np.where(residual < 0, self.start[i] + self.width[i] - reach, least[i])
            logs[i] = forms.matrix @ (self.start[i] + point) + forms.constants
        return Solved(alive, bound, least, greatest, logs)

    def _assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows in columns above their lower ends; those without a finite coefficient or right side are zeros."""
        forms, place = self.forms, self.forms.place
        matrix = np.zeros((self.count, len(self.rows), len(place)))
        right = np.empty((self.count, len(self.rows)))
        for j, (side, limit) in enumerate(self.rows):
            for k, coefficient in side:
                matrix[:, j, place[k]] += coefficient
            right[:, j] = limit
        columns = matrix @ forms.matrix
        right = right - matrix @ forms.constants - (columns @ self.start[:, :, None])[:, :, 0]
        void = ~(np.isfinite(right) & np.all(np.isfinite(columns), axis=2))
        columns[void], right[void] = 0.0, 0.0
        return columns, right


def _solved(
    cost: np.ndarray, matrix: np.ndarray, right: np.ndarray, width: np.ndarray, yield_cost: float
) -> tuple[np.ndarray, np.ndarray]:
    """Point and multipliers of a linear program whose rows may all be violated by the same amount."""
    from scipy.optimize import linprog  # costly to import; few questions need it

    rows, columns = matrix.shape
    solution = linprog(
        np.append(cost, yield_cost),
        A_ub=np.hstack([matrix, -np.ones((rows, 1))]),
        b_ub=right,
        bounds=np.column_stack([np.zeros(columns + 1), np.append(width, np.inf)]),
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    if solution.x is None:
        return 0.5 * width, np.zeros(rows)
    return np.clip(solution.x[:columns], 0.0, width), np.minimum(solution.ineqlin.marginals, 0.0)


def _bound(
    cost: np.ndarray, matrix: np.ndarray, right: np.ndarray, width: np.ndarray, multipliers: np.ndarray
) -> tuple[float, np.ndarray]:
    """Bound proven by any multipliers, none of them positive (see the head of the module), and the remainder of c."""
    residual = cost - multipliers @ matrix
    sizes = np.abs(cost) + np.abs(multipliers) @ np.abs(matrix)
    rounding = SUMMED * float(sizes @ width + np.abs(multipliers) @ np.abs(right))
    loose = ROUNDED * float(np.abs(multipliers).sum())
    return float(np.minimum(residual, 0.0) @ width + multipliers @ right) - rounding - loose, residual


def _select(values: Numbers, rows: np.ndarray) -> Any:
    """Values of a node in the given boxes; a scalar holds in all of them."""
    return values[rows] if isinstance(values, np.ndarray) and values.ndim else values
