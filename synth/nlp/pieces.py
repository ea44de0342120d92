"""Problems whose formulas have kinks, one piece at a time.

Where ``min``, ``max``, ``abs`` or ``where`` decides between two formulas, both of which move, derivatives jump, and a
method of Newton's finds no way once an optimum lies on the jump. Here each decision is an input of the problem, so
that the formulas are smooth, and the condition under which a piece is the right one is a row of its own. An optimum
on such a condition is one of the whole problem if the other piece has nothing better to offer from there on; its
multipliers tell. If not, the piece is exchanged and the problem is solved again.

With the condition c <= 0 and its multiplier mu >= 0, the gradient of the Lagrangian of the other rows is -mu grad c
there. In the other piece it is (kappa - mu) grad c, where kappa is known from the gradients of both pieces, and the
condition is -c <= 0. The other piece leads further down where mu > kappa. At the edge of a ``max`` that must be
small kappa is the weight of the edge, and the point is optimal for 0 <= mu <= kappa; at one that must be large kappa
is negative.

References
----------
J. Nocedal, S. J. Wright, Numerical Optimization, 2nd ed. (2006), chapters 16 and 17.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from synth.model.constraint import NodeConstraint
from synth.model.program import OP_SELECT, Program
from synth.nlp.batch import BatchNlp, ProblemInputs, Solutions, Tasks, worth_of
from synth.nlp.rows import Rows
from synth.nlp.settings import NLP, NlpSettings

DECISIONS = (ca.OP_LT, ca.OP_LE, ca.OP_FMIN, ca.OP_FMAX, ca.OP_FABS)


def decisions(program: Program, n_variables: int, rows: Rows) -> list[int]:
    """Return the nodes of the rows that choose between formulas by what the variables are."""
    moving = program.dependence(range(n_variables))
    return [k for k in program.needed(rows.nodes) if moving[k] and program.nodes[k].op in DECISIONS]


def sides(program: Program, k: int) -> tuple[int, int | None]:
    """Return the nodes between which a decision is made; None is zero."""
    node = program.nodes[k]
    if len(node.args) == 2:
        return node.args[0], node.args[1]
    inner = program.nodes[node.args[0]]
    return inner.args if inner.op == ca.OP_SUB else (node.args[0], None)  # type: ignore[return-value]


class Pieces:
    """The decisions of a set of rows: which way they go at a point, and the rows of each way to decide.

    A decision is true where the first side is less than the second, and of an absolute value where it is not.

    Parameters
    ----------
    program : Program
    n_variables : int
    rows : Rows
    open_decisions : list of int
        Nodes of the decisions that may go either way.
    positive : callable
        Tells of a node whether it is surely positive.
    """

    def __init__(
        self,
        program: Program,
        n_variables: int,
        rows: Rows,
        open_decisions: Sequence[int],
        positive: Callable[[int], bool] = lambda _: False,
    ) -> None:
        self.program, self.n, self.rows = program, n_variables, rows
        self.decisions = list(open_decisions)
        self._sides = [sides(program, k) for k in self.decisions]
        self.log = [b is not None and positive(a) and positive(b) for a, b in self._sides]
        ops = [program.nodes[k].op for k in self.decisions]
        self.absolute = np.array([op == ca.OP_FABS for op in ops], dtype=bool)
        self.compares = np.array([op in (ca.OP_LT, ca.OP_LE) for op in ops], dtype=bool)
        self._inclusive = np.array([op == ca.OP_LE for op in ops], dtype=bool)
        self._terms = [self._terms_of([k for k in pair if k is not None]) for pair in self._sides]
        flat = [k for a, b in self._sides for k in (a, b) if k is not None]
        flat += [k for terms in self._terms for k in terms]
        self._evaluate = program.compile(flat)
        self._needed = program.needed(rows.nodes)

    def __len__(self) -> int:
        return len(self.decisions)

    def _terms_of(self, nodes: Sequence[int]) -> list[int]:
        """Terms of the sums behind some nodes."""
        result: list[int] = []
        stack = list(nodes)
        while stack:
            k = stack.pop()
            node = self.program.nodes[k]
            if node.op in (ca.OP_ADD, ca.OP_SUB, ca.OP_NEG, ca.OP_TWICE):
                stack += node.args
            else:
                result.append(k)
        return sorted(set(result))

    def written(self) -> tuple[Program, Rows]:
        """Return the program with its decisions and the sizes of their conditions as further inputs, and its rows."""
        program, rows, count = self.program, self.rows, len(self.decisions)
        inputs = [ca.SX.sym(f"x{k}") for k in range(program.n_inputs)]
        ways = [ca.SX.sym(f"way{k}") for k in range(count)]
        inverse_sizes = [ca.SX.sym(f"inverse_size{k}") for k in range(count)]
        number = {k: position for position, k in enumerate(self.decisions)}
        values: dict[int, Any] = {}
        terms = [c.terms for c in rows.constraints if c.terms is not None]
        decided = [a for pair in self._sides for a in pair if a is not None]
        for k in program.needed([*rows.nodes, *terms, *decided]):
            node = program.nodes[k]
            if node.op == ca.OP_CONST:
                values[k] = ca.SX(node.constant)
            elif node.op == ca.OP_INPUT:
                values[k] = inputs[int(node.constant)]
            elif k in number:
                values[k] = _piece(node.op, ways[number[k]], [values[a] for a in node.args])
            else:
                values[k] = program.apply(node, [values[a] for a in node.args])
        conditions = self._conditions(values, ways, inverse_sizes)
        outputs = [*(values[k] for k in rows.nodes), *conditions, *(values[k] for k in terms)]
        made = Program([*inputs, *ways, *inverse_sizes], outputs)
        place, sized = iter(made.outputs), iter(made.outputs[len(outputs) - len(terms) :])
        constraints = [
            replace(
                c,
                value=next(place),
                limit=None if c.limit is None else next(place),
                terms=None if c.terms is None else next(sized),
            )
            for c in rows.constraints
        ]
        goals = tuple(replace(g, node=next(place)) for g in rows.goals)
        constraints += [NodeConstraint("at_most", next(place), next(place) if log else None, 1.0) for log in self.log]
        return made, Rows(
            tuple(constraints), goals, (*rows.log_constraints, *self.log), rows.log_goals, rows.log_variables
        )

    def _conditions(self, values: Mapping[int, Any], ways: Sequence[Any], inverse_sizes: Sequence[Any]) -> list[Any]:
        """Conditions under which the decisions go as they do: which side is less, or by how much of the size."""
        conditions: list[Any] = []
        for position, (a, b) in enumerate(self._sides):
            first, second = values[a], values[b] if b is not None else ca.SX(0.0)
            if self.absolute[position]:
                first, second = second, first
            less, more = ca.if_else(ways[position], first, second), ca.if_else(ways[position], second, first)
            conditions += [less, more] if self.log[position] else [(less - more) * inverse_sizes[position]]
        return conditions

    def at(self, inputs: Sequence[Any], reach: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return, at some points, which way each decision goes, how far its sides are apart, and their size.

        Parameters
        ----------
        inputs : list of numbers or arrays (points,)
        reach : array (points, variables), optional
            How large variables can be: where one is near zero, its size is not.

        Returns
        -------
        ways : array of bool (points, decisions)
        apart : array (points, decisions)
            As a share of the size; not negative.
        size : array (points, decisions)
        """
        evaluated = self._evaluate(inputs)
        sizes = [np.size(x) for x in inputs]
        count = max(sizes) if min(sizes) else 0  # no point at all, beside numbers that are the same for all points
        values = iter(np.broadcast_to(np.asarray(x, dtype=float), count) for x in evaluated)
        ways = np.empty((count, len(self)), dtype=bool)
        apart, size = np.empty(ways.shape), np.zeros(ways.shape)
        for position, (_, b) in enumerate(self._sides):
            first, second = next(values), next(values) if b is not None else np.zeros(count)
            if self.absolute[position]:
                ways[:, position] = first >= second
            else:
                ways[:, position] = first <= second if self._inclusive[position] else first < second
            apart[:, position] = np.abs(first - second)
        for position, terms in enumerate(self._terms):
            for k in terms:
                value, node = np.abs(next(values)), self.program.nodes[k]
                if reach is not None and node.op == ca.OP_INPUT and node.constant < self.n:
                    value = np.maximum(value, reach[:, int(node.constant)])
                size[:, position] = np.fmax(size[:, position], np.where(np.isfinite(value), value, 0.0))
        size = np.where(size > 0, size, 1.0)
        return ways, np.nan_to_num(apart / size, nan=np.inf), size

    def live(self, ways: np.ndarray) -> np.ndarray:
        """Relevant decisions where they all go these ways: those outside branches that are not selected."""
        program, count = self.program, len(ways)
        number = {k: position for position, k in enumerate(self.decisions)}
        nothing, everything = np.zeros(count, dtype=bool), np.ones(count, dtype=bool)
        read: dict[int, np.ndarray] = dict.fromkeys(self.rows.nodes, everything)
        truths: dict[int, np.ndarray | None] = {}

        def truth(k: int) -> np.ndarray | None:
            if k not in truths:
                node = program.nodes[k]
                logical = node.op in (ca.OP_NOT, ca.OP_AND, ca.OP_OR)
                inner = [x for x in (truth(a) for a in node.args if logical) if x is not None]
                if k in number:
                    truths[k] = ways[:, number[k]]
                elif not logical or len(inner) < len(node.args):
                    truths[k] = None
                elif node.op == ca.OP_NOT:
                    truths[k] = ~inner[0]
                else:
                    truths[k] = inner[0] & inner[1] if node.op == ca.OP_AND else inner[0] | inner[1]
            return truths[k]

        for k in reversed(self._needed):
            live_at, node = read.get(k, nothing), program.nodes[k]
            shares = [live_at] * len(node.args)
            if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO) and (chosen := truth(node.args[0])) is not None:
                shares = [live_at, live_at & chosen, live_at & ~chosen][: len(node.args)]
            for a, share in zip(node.args, shares, strict=True):
                known = read.get(a)
                if known is None or share is everything:
                    read[a] = share
                elif known is not everything and known is not share:
                    read[a] = known | share
        return np.stack([read.get(k, nothing) for k in self.decisions], axis=1)


def _piece(op: int, way: ca.SX, args: Sequence[Any]) -> Any:
    """Value of a decision, as an expression of which way it goes."""
    if op in (ca.OP_LT, ca.OP_LE):
        return way
    if op == ca.OP_FABS:
        return ca.if_else(way, args[0], -args[0])
    return ca.if_else(way, *args) if op == ca.OP_FMIN else ca.if_else(way, *args[::-1])


@dataclass
class _State:
    """Best solution of each problem, with its ways of the decisions and its start."""

    best: Solutions
    prices: np.ndarray  # multipliers of the conditions
    ways: np.ndarray
    start: np.ndarray
    size: np.ndarray

    def put(self, rows: np.ndarray, other: _State, chosen: np.ndarray) -> None:
        """Put the chosen ones of other answers into the places of some problems."""
        self.best.put(rows, other.best.take(chosen))
        for name in ("prices", "ways", "start", "size"):
            getattr(self, name)[rows] = getattr(other, name)[chosen]


class _Tried:
    """The ways that one problem was solved with: from where it stands, and from anywhere."""

    def __init__(self, ways: np.ndarray) -> None:
        self.here, self.ever = {ways.tobytes()}, {ways.tobytes()}

    def add(self, ways: np.ndarray) -> None:
        """Note what is tried from here."""
        self.here.add(ways.tobytes())
        self.ever.add(ways.tobytes())

    def from_here(self, ways: np.ndarray) -> None:
        """Begin at another place: what led nowhere before may lead on from there."""
        self.here = {ways.tobytes()}


class PiecedNlp:
    """The solver of a set of rows with kinks.

    Parameters
    ----------
    pieces : Pieces
    settings : NlpSettings
    """

    def __init__(self, pieces: Pieces, settings: NlpSettings = NLP) -> None:
        self.pieces, self.settings, self.nlp_settings = pieces, settings.pieces, settings

    @cached_property
    def nlp(self) -> BatchNlp:
        """The solver of the pieces; made when the first problem needs it."""
        program, rows = self.pieces.written()
        return BatchNlp(program, self.pieces.n, rows, conditions=len(self.pieces), settings=self.nlp_settings)

    def doubtful(self, solutions: Solutions, inputs: ProblemInputs) -> np.ndarray:
        """Solutions of the unsplit formulas that may be no optima: on a kink, or not converged."""
        with np.errstate(all="ignore"):
            points = [*solutions.variables.T, *inputs.clean()]
            ways, apart, _ = self.pieces.at(points, _reach(inputs.low, inputs.high))
        tied = np.any(self.pieces.live(ways) & (apart <= self.settings.tie), axis=1)
        doubtful: np.ndarray = ~solutions.converged | tied
        return doubtful

    def solve(self, tasks: Tasks, inputs: ProblemInputs, start: np.ndarray, workers: int = 1) -> Solutions:
        """Solve all problems, each from its start and the pieces there; parameters as of ``BatchNlp.solve``."""
        question, low, high = _Question(self, tasks, inputs, workers), inputs.low, inputs.high
        with np.errstate(all="ignore"):
            start = np.clip(start, low, high)
            ways, _, size = self.pieces.at([*start.T, *question.clean_data], _reach(low, high))
            everything = np.arange(len(start))
            state = question.solved(everything, ways, start, size)
            tried = [_Tried(w) for w in ways]
            waiting = question.alternatives(everything, state, tried)
            for _ in range(self.settings.exchanges):
                rows = np.array([k for k in sorted(waiting) if waiting[k]], dtype=np.int64)
                if not len(rows):
                    break
                turned = np.array([waiting[k].pop(0) for k in rows])
                for k, piece in zip(rows, turned, strict=True):
                    tried[k].add(piece)
                begin = state.best.variables[rows]
                _, _, size = self.pieces.at([*begin.T, *question.inputs(rows)], _reach(low[rows], high[rows]))
                other = question.solved(rows, turned, begin, size)
                better = question.better(rows, other.best, state.best)
                won = rows[better]
                state.put(won, other, better)
                for k in won:
                    tried[k].from_here(state.ways[k])
                waiting.update(question.alternatives(won, state, tried))
        return state.best


@dataclass(frozen=True)
class _Question:
    """Problems to be solved piece by piece, with their data, ranges and bounds."""

    solver: PiecedNlp
    tasks: Tasks
    numbers: ProblemInputs
    workers: int

    def inputs(self, rows: np.ndarray) -> list[np.ndarray]:
        """Return the data of some problems."""
        return [x if x.ndim == 0 else x[rows] for x in self.clean_data]

    @cached_property
    def clean_data(self) -> list[np.ndarray]:
        """Data of all problems, without gaps."""
        return self.numbers.clean()

    def _tasks_of(self, rows: np.ndarray, ways: np.ndarray, size: np.ndarray) -> tuple[Tasks, list[Any]]:
        """Tasks restricted to the given pieces, and their data."""
        tasks, settings, pieces = self.tasks.take(rows), self.solver.settings, self.solver.pieces
        moved = np.zeros(self.numbers.void[rows].shape) if tasks.moved is None else tasks.moved
        margin = np.broadcast_to(np.where(pieces.compares, -settings.margin, 0.0), ways.shape)
        tasks = replace(tasks, moved=np.concatenate([moved, margin], axis=1))
        return tasks, [*self.inputs(rows), *ways.T.astype(float), *(1.0 / size).T]

    def solved(self, rows: np.ndarray, ways: np.ndarray, start: np.ndarray, size: np.ndarray) -> _State:
        """Solve problems with given pieces."""
        tasks, data = self._tasks_of(rows, ways, size)
        pieces, numbers = self.solver.pieces, self.numbers.take(rows)
        live, low, high = pieces.live(ways), numbers.low, numbers.high
        void = np.concatenate([numbers.void, ~live], axis=1)
        inputs = ProblemInputs(data, low, high, self._right_sides(), void)
        ended = self.solver.nlp.solve(tasks, inputs, start, self.workers)
        # In a branch that is not taken decisions go the way they would if it were: an exchange may lead there.
        there, _, _ = pieces.at([*ended.variables.T, *self.inputs(rows)], _reach(low, high))
        ways = np.where(live, ways, there)
        constraints = numbers.void.shape[1]
        of_task = replace(ended, constraint_multipliers=ended.constraint_multipliers[:, :constraints])
        return _State(of_task, ended.constraint_multipliers[:, constraints:], ways, start, size)

    def _right_sides(self) -> list[float]:
        return [*self.numbers.bounds, *([0.0] * len(self.solver.pieces))]

    def better(self, rows: np.ndarray, new: Solutions, old: Solutions) -> np.ndarray:
        """Tell which answers are better than the old ones of these problems."""
        tasks = self.tasks.take(rows)
        least = self.solver.settings.gain / worth_of(tasks)
        cost, known = _cost(tasks, new), _cost(tasks, old.take(rows))
        violation, before, missed = new.violation, old.violation[rows], self.solver.nlp_settings.missed
        holds, held = violation <= missed, before <= missed
        better: np.ndarray = np.where(
            holds & held, cost < known - least, holds | (~held & (violation < before - self.solver.settings.gain))
        )
        return better

    def alternatives(self, rows: np.ndarray, state: _State, tried: Sequence[_Tried]) -> dict[int, list[np.ndarray]]:
        """Other pieces of each problem that promise a better solution, the most promising first."""
        pressed, apart = self._promises(rows, state)
        ways = state.ways[rows]
        result: dict[int, list[np.ndarray]] = {}
        for place in np.flatnonzero(np.any((pressed > 0) | apart, axis=1)):
            promises, k = pressed[place], int(rows[place])
            order = np.argsort(-promises, kind="stable")[: int(np.sum(promises > 0))]
            flips = [order] if len(order) > 1 else []
            turned = [_turned(ways[place], flip) for flip in [*flips, *order[:, None]]]
            others = [_turned(ways[place], i) for i in np.flatnonzero(apart[place] & ~(promises > 0))]
            result[k] = [w for w in turned if w.tobytes() not in tried[k].here]
            result[k] += [w for w in others if w.tobytes() not in tried[k].ever]
        return result

    def _promises(self, rows: np.ndarray, state: _State) -> tuple[np.ndarray, np.ndarray]:
        """Reasons to take the other piece of each decision of some problems.

        Returns
        -------
        pressed : array (problems, decisions)
            By how much the condition holds back an answer that the other piece would let go further; 0: not at all.
        apart : array of bool (problems, decisions)
            Whether the other piece is worse here, so that it has optima of its own. (Where it is better, as beside
            the edge of a max that must be small, it is not the right one here.)
        """
        solver, settings, nlp = self.solver, self.solver.settings, self.solver.nlp
        count, constraints, best = len(solver.pieces), self.numbers.void.shape[1], state.best.take(rows)
        pressed, apart = np.zeros((len(rows), count)), np.zeros((len(rows), count), dtype=bool)
        if not len(rows):
            return pressed, apart
        weight = np.zeros((nlp.functions.n_rows, len(rows)))
        weight[:constraints] = best.constraint_multipliers.T
        weight[nlp.functions.n_constraints :] = (best.goal_multipliers + self.tasks.weights[rows]).T
        least = settings.press / worth_of(self.tasks.take(rows))
        live, ways = solver.pieces.live(state.ways[rows]), state.ways[rows]
        values, first = self._slopes(rows, state, ways)
        for k in range(count):
            others, second = self._slopes(rows, state, _turned(ways, k))
            picked = np.zeros_like(weight)
            picked[constraints + k] = 1.0
            normal = nlp.layout.transposed(first, picked)
            length = np.sum(normal * normal, axis=0)
            change = nlp.layout.transposed(np.nan_to_num(second - first), weight)
            kappa = np.sum(change * normal, axis=0) / np.where(length > 0, length, 1.0)
            step = np.where(weight != 0, others - values, 0.0)
            jumps = (state.prices[rows, k] > least) & (np.max(np.abs(step), axis=0) > settings.jump)
            excess = state.prices[rows, k] - np.where(jumps, 0.0, kappa)
            goes = live[:, k] & (length > 0)
            pressed[:, k] = np.where(goes & (state.prices[rows, k] > least) & (excess > least), excess, 0.0)
            effect = np.sum(weight * step, axis=0)
            apart[:, k] = goes & ((effect > least) | (solver.pieces.compares[k] & (np.abs(effect) > least)))
        return pressed, apart

    def _slopes(self, rows: np.ndarray, state: _State, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values and derivatives of all rows at the solutions of problems, with the given pieces."""
        tasks, data = self._tasks_of(rows, ways, state.size[rows])
        points, ends = state.best.variables[rows], (self.numbers.low[rows], self.numbers.high[rows])
        return self.solver.nlp.slopes(tasks, data, state.start[rows], points, *ends, self._right_sides())


def _turned(ways: np.ndarray, which: int | np.integer[Any] | np.ndarray) -> np.ndarray:
    result = ways.copy()
    result[..., which] = ~result[..., which]
    return result


def _reach(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    reach: np.ndarray = np.maximum(np.abs(low), np.abs(high))
    return reach


def _cost(tasks: Tasks, solutions: Solutions) -> np.ndarray:
    # An objective that does not count may be infinite; zero times that is no number.
    counted = np.multiply(tasks.weights, solutions.phi, where=tasks.weights != 0, out=np.zeros(solutions.phi.shape))
    cost: np.ndarray = counted.sum(axis=1) + tasks.t_weight * solutions.t
    return cost


class KinkedNlp:
    """The solver of a set of rows with kinks: first all at once, then piece by piece where that leaves doubts.

    Parameters
    ----------
    first : BatchNlp
        Of the formulas as they stand or, where edges are rounded off, near to them.
    pieced : PiecedNlp
    """

    def __init__(self, first: BatchNlp, pieced: PiecedNlp) -> None:
        self.first, self.pieced = first, pieced
        self.rounded = first.functions.edge > 0

    @property
    def compiled(self) -> bool:
        """True if the kernel solves the problems."""
        return self.first.compiled

    def solve(
        self, tasks: Tasks, inputs: ProblemInputs, start: np.ndarray, workers: int = 1, rough: bool = False
    ) -> Solutions:
        """Solve all problems, each from its start; parameters as of ``BatchNlp.solve``.

        ``rough``: answers may be near optima.
        """
        solutions = self.first.solve(tasks, inputs, start, workers)
        if rough:
            return solutions
        if self.rounded:
            doubtful = np.arange(len(start))
        else:
            doubtful = np.flatnonzero(self.pieced.doubtful(solutions, inputs))
        if not len(doubtful):
            return solutions
        again = tasks.take(doubtful)
        sharp = self.pieced.solve(again, inputs.take(doubtful), solutions.variables[doubtful], workers)
        # An answer to other formulas is none, but may be a design; one to the same formulas may be better.
        known, missed = solutions.take(doubtful), self.pieced.nlp_settings.missed
        lost = (known.violation <= missed) & (sharp.violation > missed)
        if self.rounded:
            solutions.converged[doubtful] = False
        else:
            cost, before = _cost(again, sharp), _cost(again, known)
            least = self.pieced.settings.gain / worth_of(again)
            held = (known.violation <= missed) & known.converged
            lost |= held & (before < cost - least)
        solutions.put(doubtful[~lost], sharp.take(~lost))
        return solutions
