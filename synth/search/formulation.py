"""One question prepared for the search: its limits and objectives as rows, and all that is done with it."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from synth.bounds.bounding import Bounding
from synth.bounds.question_bounds import QuestionBounds
from synth.model.constraint import Goal, NodeConstraint
from synth.order.feasibility import SLACK
from synth.question.requirement_values import RequirementValues
from synth.question.search_space import SearchSpace
from synth.search.archive import Archive
from synth.search.box_operations import BoxOperations
from synth.search.continuous_problems import ContinuousProblems, open_kinks, rows_of_question
from synth.search.counters import SearchCounters
from synth.search.log_objectives import LogObjectives
from synth.search.makeable_values import MakeableValues
from synth.search.point_evaluation import PointEvaluation
from synth.search.resolution import declared_resolution
from synth.search.settings import TUNING, Tuning


class Formulation:
    """A question, ready to be searched.

    It holds what the question is and what is known of it: ``objectives`` (log-objectives), ``makeable`` (values on
    grids), ``archive`` (designs found), ``counters`` (what was done). ``boxes``, ``points`` and ``continuous`` do
    the work.

    Parameters
    ----------
    instance : SearchSpace
    objectives : mapping
        All objectives of interest with their sense: those to trade off first, then those that settle ties.
    traded : int
        How many, from the first, are traded off against each other.
    infeasibility : bool
        Whether to prepare for proving that limits exclude each other.
    execution : Execution
    tuning : Tuning
        What the search in it goes by, its heuristics too.
    counters : SearchCounters, optional
        Those of an earlier formulation of the question, which go on.
    slack : float
        Share of their size by which limits are loosened that something continuous moves.
    sizes : mapping
        Objective -> its size in SI near the front, where that is known; the median over the question elsewhere.
    """

    def __init__(
        self,
        instance: SearchSpace,
        objectives: Mapping[str, str],
        traded: int,
        infeasibility: bool = False,
        workers: int = 1,
        tuning: Tuning = TUNING,
        counters: SearchCounters | None = None,
        slack: float = SLACK,
        sizes: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        self.instance, self.tuning, self.workers = instance, tuning, workers
        self.model = model = instance.model
        self.n, self.names, self.traded = len(model.variables), list(objectives), traded
        self.goals = [
            Goal(model.quantity_node[name], 1 if sense == "min" else -1) for name, sense in objectives.items()
        ]
        self.constraints = instance.constraints
        # All that the search knows of limits is made of these rows, one of each constraint.
        self.lower, self.upper = instance.ranges.lower, instance.ranges.upper
        self.makeable = MakeableValues(instance.ranges.grids(), tuning.tolerances.margins)
        self.gridded = self.makeable.gridded
        self._immovable = self.unmoved(gridded=False)
        slacks = np.where(self._immovable, SLACK, slack).tolist()
        self.node_constraints = [NodeConstraint.of(*x) for x in zip(self.constraints, slacks, strict=True)]
        self.bounds = [constraint.bound for constraint in self.node_constraints]
        # A single objective needs bounds of the next one as well, which settles ties.
        self.bounded = min(max(traded, 2), len(self.goals)) if traded else 0
        self.infeasibility = infeasibility
        moved = [model.program.dependence([k]) for k in range(self.n)]
        self.seen_by_goal = np.array([[m[g.node] for m in moved] for g in self.goals], dtype=bool)
        question = QuestionBounds(
            instance, self.node_constraints, self.goals, self.bounded, infeasibility, tuning.branching
        )
        self.bounding = Bounding(question, workers, tuning.branching, tuning.kernels, tuning.tolerances.margins)
        self.objectives = self._log_objectives(sizes)
        self._rows = rows_of_question(question, self.objectives.log.tolist())
        self._kinks = open_kinks(question, self._rows)
        self._begin(SearchCounters() if counters is None else counters)

    def among(self, instance: SearchSpace, workers: int = 1) -> Formulation | None:
        """Formulation of a subset of its questions, whose data lie within those of this one.

        Parameters
        ----------
        instance : SearchSpace
            As for :meth:`QuestionBounds.among`.
        workers : int
            Threads.

        Returns
        -------
        Formulation, optional
            That knows no design yet; None as for :meth:`QuestionBounds.among`.
        """
        bounding = self.bounding.among(instance, workers)
        if bounding is None:
            return None
        new = copy.copy(self)
        new.instance, new.bounding, new.workers = instance, bounding, workers
        new._begin(SearchCounters())
        return new

    def _begin(self, counters: SearchCounters) -> None:
        """Know no design yet, and count from here."""
        self.counters = counters
        self.archive = self.new_archive(range(self.traded))
        self.followers: dict[RequirementValues, dict[str, dict[str, float]]] = {}  # of each question
        # By combination and makeable values, where the full tolerance was needed: whether something does without it.
        self.kept_closely: dict[tuple[int, bytes], bool] = {}
        self.boxes = BoxOperations(self.bounding, self.makeable, self.objectives, self.bounded, counters, self.tuning)
        self.points = PointEvaluation(
            self.instance, self.constraints, self.goals, self.objectives, self._immovable, self.tuning
        )
        question, branching = self.bounding.question, self.bounding.branching
        self.continuous = ContinuousProblems(
            question, branching, self.constraints, self._rows, self._kinks, counters, self.workers, self.tuning
        )

    def _log_objectives(self, near: Mapping[str, float]) -> LogObjectives:
        positive = [g.sign > 0 and self.bounding.question.surely_positive(g.node) for g in self.goals]
        declared = [declared_resolution(self.model.declaration, name) for name in self.names]
        usual = zip(self.names, self.bounding.goal_sizes.tolist(), strict=True)
        return LogObjectives.of(positive, np.array([near.get(name, size) for name, size in usual]), declared)

    def unmoved(self, gridded: bool) -> np.ndarray:
        """Limits that no variable moves: of those that may move at all, or only the continuous ones of them.

        That is a matter of the question, its ranges, pins and grids; how narrow a box has become does not count.

        Parameters
        ----------
        gridded : bool
            Whether makeable values count as moving, as if they were continuous.
        """
        free = self.lower < self.upper if gridded else (self.lower < self.upper) & ~self.gridded
        moving = self.model.program.dependence(np.flatnonzero(free).tolist())
        return np.array([not any(moving[k] for k in x.nodes) for x in self.constraints], dtype=bool)

    def new_archive(self, columns: Sequence[int]) -> Archive:
        """Return an archive without designs, in which objectives of these numbers count."""
        return Archive(columns, self.n, len(self.goals), self.tuning)
