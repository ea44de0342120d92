"""The continuous problems of a question: the variables of a combination under all limits, many solved at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from synth.bounds.branching import BranchingWeights
from synth.bounds.question_bounds import QuestionBounds
from synth.kernels.loading import native_enabled
from synth.model.constraint import Constraint, NodeConstraint, void_limits
from synth.model.program import InputValue
from synth.nlp.batch import BatchNlp, ProblemInputs, Solutions, Tasks
from synth.nlp.pieces import KinkedNlp, PiecedNlp, Pieces, decisions, sides
from synth.nlp.rows import Rows
from synth.search.counters import SearchCounters
from synth.search.settings import TUNING, Tuning


def rows_of_question(question: QuestionBounds, log_goals: Sequence[bool]) -> Rows:
    """Limits and objectives of a question as a solver needs them.

    Parameters
    ----------
    question : QuestionBounds
        Tells which quantities are surely positive.
    log_goals : list of bool
        Which objectives are measured by logarithm.
    """

    def both_positive(constraint: NodeConstraint) -> bool:
        positive = question.surely_positive
        # Where nothing is feasible nothing proves a sign, and logarithms would not exist.
        right = constraint.bound > 0 if constraint.limit is None else positive(constraint.limit)
        return not question.root.empty and positive(constraint.value) and right

    constraints = question.constraints
    return Rows(
        constraints=tuple(replace(c, bound=0.0) for c in constraints),
        goals=tuple(question.goals),
        log_constraints=tuple(c.sense != "equal" and both_positive(c) for c in constraints),
        log_goals=tuple(bool(x) for x in log_goals),
        log_variables=tuple(bool(x > 0) for x in question.instance.ranges.lower),
    )


def open_kinks(question: QuestionBounds, rows: Rows) -> tuple[int, ...]:
    """Return the decisions of formulas (nodes) that may go either way somewhere in a question."""
    program = question.instance.model.program
    every = decisions(program, len(rows.log_variables), rows)
    if question.root.empty:
        return tuple(every)

    def settled(k: int) -> bool:
        a, b = (question.range_of(x) if x is not None else (0.0, 0.0) for x in sides(program, k))
        return a[1] < b[0] or b[1] < a[0]

    return tuple(k for k in every if not settled(k))


class ContinuousProblems:
    """Solves the continuous problems of a question.

    Parameters
    ----------
    question : QuestionBounds
    branching : BranchingWeights
        Learns from what is solved where to split boxes.
    constraints : list of Constraint
    rows : Rows
    kinks : tuple of int
        Decisions of formulas that may go either way.
    counters : SearchCounters
        Counts what is solved.
    workers : int
        Threads that may solve at the same time, where kernels compute.
    tuning : Tuning
    """

    def __init__(
        self,
        question: QuestionBounds,
        branching: BranchingWeights,
        constraints: Sequence[Constraint],
        rows: Rows,
        kinks: tuple[int, ...],
        counters: SearchCounters,
        workers: int,
        tuning: Tuning = TUNING,
    ) -> None:
        self.question, self.branching = question, branching
        self.instance, self.constraints = question.instance, constraints
        self.rows, self.kinks, self.counters = rows, kinks, counters
        self.workers, self.tuning = workers, tuning
        self.model, self.n = self.instance.model, len(self.instance.model.variables)

    @property
    def has_edges(self) -> bool:
        """True if limits or objectives read the larger or smaller of two things that move."""
        moving, nodes = self.model.program.dependence(range(self.n)), self.model.program.nodes
        return any(
            nodes[k].op in (ca.OP_FMAX, ca.OP_FMIN) and all(moving[a] for a in nodes[k].args) for k in self.kinks
        )

    def batch_nlp(self) -> BatchNlp | KinkedNlp:
        """Return the NLP of this question for many designs at once; built once per model and set of rows."""
        model, rows, kinks, nlp = self.model, self.rows, self.kinks, self.tuning.nlp
        # At an optimum on the edge a solver finds no way; a rounded edge leads there, and near to it.
        edge = nlp.edge if self.has_edges else 0.0
        first: BatchNlp = model.function(
            ("batch", rows, edge, nlp, native_enabled()),
            lambda: BatchNlp(model.program, self.n, rows, edge, settings=nlp),
        )
        if not kinks:
            return first
        positive = tuple(dict.fromkeys(k for d in kinks for k in sides(model.program, d) if self._positive(k)))

        def made() -> KinkedNlp:
            pieces = Pieces(model.program, self.n, rows, kinks, positive.__contains__)
            return KinkedNlp(first, PiecedNlp(pieces, nlp))

        kinked: KinkedNlp = model.function(("kinked", rows, edge, kinks, positive, nlp, native_enabled()), made)
        return kinked

    def solve_batch(
        self,
        tasks: Tasks,
        combinations: np.ndarray,
        start: np.ndarray,
        low: np.ndarray | None = None,
        high: np.ndarray | None = None,
        skipped: np.ndarray | None = None,
        data: Sequence[InputValue] | None = None,
        rough: bool = False,
    ) -> Solutions:
        """Solve the continuous problems of many combinations at once, over the whole range unless ends are given.

        Parameters
        ----------
        tasks : Tasks
            What is to be made small, a row per problem.
        combinations : array (problems,)
        start : array (problems, variables)
        low, high : array (problems, variables), optional
        skipped : array of bool (limits,) or (problems, limits), optional
            Limits that are left out.
        data : list, optional
            Inputs of the model in place of those of the question.
        rough : bool
            Answers may be near optima, where formulas have edges.
        """
        count = len(combinations)
        data = self.instance.data(combinations) if data is None else data
        self.counters.solved_combinations.update(np.unique(combinations).tolist())
        self.counters.nlp_solves += count
        low = np.broadcast_to(self.instance.ranges.lower, (count, self.n)) if low is None else low
        high = np.broadcast_to(self.instance.ranges.upper, (count, self.n)) if high is None else high
        void = void_limits(self.constraints, data, count)
        void = void if skipped is None else void | skipped
        inputs, start = ProblemInputs(data, low, high, self.question.right_sides, void), np.clip(start, low, high)
        nlp = self.batch_nlp()
        if isinstance(nlp, KinkedNlp):
            return nlp.solve(tasks, inputs, start, self.workers, rough)
        return nlp.solve(tasks, inputs, start, self.workers)

    def learn(self, tasks: Tasks, solutions: Solutions, importance: np.ndarray) -> None:
        """Update the branching weights by the multipliers of solved problems; ``importance`` per problem."""
        prices = np.concatenate([solutions.constraint_multipliers, solutions.goal_multipliers + tasks.weights], axis=1)
        self.branching.learn(prices[solutions.converged], importance[solutions.converged])

    def _positive(self, node: int | None) -> bool:
        return node is not None and not self.question.root.empty and self.question.surely_positive(node)
