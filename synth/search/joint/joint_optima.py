"""A joint search: many questions as one tree. Of each it proves what a separate search would prove."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np

from synth.bounds.boxes import Boxes
from synth.order.feasibility import SLACK
from synth.question.instance import Instance
from synth.question.settings import SearchSettings
from synth.search.archive import Candidate, rows_of
from synth.search.best_first import best_first
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.goals import goals_of
from synth.search.joint.joint_heuristics import JointHeuristics
from synth.search.joint.joint_question import BestPerScenario, IncumbentPerScenario, JointInstance
from synth.search.log_objectives import LogObjectives
from synth.search.resolution import gap_tolerance
from synth.search.settings import SearchEffort, Tuning


class QuestionLike(Protocol):
    """Interface of a question: its instance, objectives and search settings."""

    @property
    def instance(self) -> Instance:
        """Instance of the model."""

    @property
    def chosen(self) -> Mapping[str, str]:
        """The objectives with their sense."""

    @property
    def settings(self) -> SearchSettings:
        """How it is searched."""

    @property
    def tuning(self) -> Tuning:
        """What its search goes by."""


class SharedBounds:
    """Bounds that hold for many questions, computed once for all searches of subsets.

    Parameters
    ----------
    questions : list of Question
        Alike.
    moving : collection of str
        As for :class:`JointInstance`.
    first : str, optional
        Of several chosen objectives that which comes first; the others settle ties.
    slack : float
        By which limits are loosened that something continuous moves.
    sizes : mapping
        Objective -> its size in SI near the front, where that is known.
    """

    def __init__(
        self,
        questions: Sequence[QuestionLike],
        moving: Collection[str],
        first: str | None = None,
        slack: float = SLACK,
        sizes: Mapping[str, float] = MappingProxyType({}),
    ) -> None:
        self.slack, self.sizes = slack, sizes
        self.moving, self._tuning = moving, questions[0].tuning
        self._instance = JointInstance([q.instance for q in questions], moving)
        chosen = dict(questions[0].chosen)
        in_order = {first: chosen[first], **chosen} if first is not None else chosen
        self.goals = goals_of(self._instance, in_order)
        self._forms: dict[bool, Formulation] = {}

    def among(self, instance: JointInstance, infeasibility: bool, workers: int = 1) -> Formulation | None:
        """Return questions prepared for a search; None where their numbers are not among those of these."""
        return self._form(infeasibility).among(instance, workers)

    @property
    def objectives(self) -> LogObjectives:
        """How objectives are compared."""
        return self._form(False).objectives

    def _form(self, infeasibility: bool) -> Formulation:
        if infeasibility not in self._forms:
            self._forms[infeasibility] = Formulation(
                self._instance, self.goals, 1, infeasibility, tuning=self._tuning, slack=self.slack, sizes=self.sizes
            )
        return self._forms[infeasibility]


@dataclass(frozen=True, kw_only=True)
class Needs:
    """What designs must beat to be of use, where that is not the best one known.

    Parameters
    ----------
    to_beat : array (questions,)
        phi of the objective that is sought.
    tolerance : float
        In phi, by which it and the best known must be beaten.
    """

    to_beat: np.ndarray
    tolerance: float


class JointTree:
    """One tree over the questions, by one way of bounding them, which goes on where it stopped."""

    def __init__(self, search: JointOptima, form: Formulation, known: IncumbentPerScenario, boxes: Boxes) -> None:
        self.search, self.form, self.known, self.unresolved = search, form, known, boxes
        self.under_way = False  # also where it was stopped by an exception: the clock holds its boxes then

    def open_questions(self, requested: np.ndarray, node_limit: float) -> np.ndarray:
        """Continue for ``node_limit`` boxes; mask of the requested questions whose optimum is not proven."""
        search, form, limits = self.search, self.form, self.search.limits
        if not requested.any():
            return requested

        def go_on(rule: BestPerScenario) -> None:
            for _ in range(2):
                self.unresolved = branch_and_bound(
                    form, self.unresolved, rule, search.clock, search.rng, min(node_limit, limits.most_boxes)
                ).open
                if not 0 < len(self.unresolved) < limits.nearly_closed * node_limit:
                    break

        return self._open_after(requested, go_on)

    def finish(self, requested: np.ndarray, effort: SearchEffort) -> tuple[np.ndarray, bool]:
        """Continue best first; mask of the questions whose optimum is not proven, and True if time ran out."""
        search, spent = self.search, [False]

        def go_on(rule: BestPerScenario) -> None:
            outcome = best_first(self.form, self.unresolved, rule, search.clock, search.rng, effort)
            self.unresolved, spent[0] = outcome.open, outcome.spent

        return self._open_after(requested, go_on), spent[0]

    def _open_after(self, requested: np.ndarray, go_on: Callable[[BestPerScenario], None]) -> np.ndarray:
        """Continue the tree with the known designs; mask of the questions whose optimum is not proven."""
        search, form = self.search, self.form
        if self.known is not search.known:
            # Designs of other questions must not count as optima of these.
            rows = requested[search.known.questions()]
            self.known.add(search.known.combination[rows], search.known.variables[rows], search.known.phi[rows])
        before = form.counters.contracted, form.counters.nlp_solves
        rule = search.rule(requested, form, self.known)
        self.under_way = True
        go_on(rule)
        self.under_way = False
        if self.known is not search.known:
            search.known.add(self.known.combination, self.known.variables, self.known.phi)
            search.form.counters.contracted += form.counters.contracted - before[0]
            search.form.counters.nlp_solves += form.counters.nlp_solves - before[1]
        return rule.open_questions(self.unresolved)


class JointOptima:
    """Optimum of each of several questions, searched and proven as one tree.

    Parameters
    ----------
    questions : list of QuestionLike
        Alike; threads as the first asks.
    clock : Clock
        ``Stopped`` is raised when its time is over.
    shared : SharedBounds, optional
        Of questions that these are among.
    sought : int
        Number of the objective that is sought.
    cutoffs, floors : mapping, optional
        As for :class:`JointInstance`.
    needs : Needs, optional
        What designs must beat; otherwise the best known by more than the gap.
    """

    def __init__(
        self,
        questions: Sequence[QuestionLike],
        clock: Clock,
        shared: SharedBounds | None = None,
        sought: int = 0,
        cutoffs: Mapping[int, np.ndarray] | None = None,
        needs: Needs | None = None,
        floors: Mapping[int, np.ndarray] | None = None,
    ) -> None:
        self.questions, self.clock = list(questions), clock
        first = questions[0]
        self.tuning, self.limits = first.tuning, first.tuning.joint
        self.shared, self.workers, self.sought = shared, first.settings.workers, sought
        moving = () if shared is None else shared.moving
        self.instance = JointInstance([q.instance for q in questions], moving, cutoffs, floors)
        self.gap, self.needs = first.settings.gap, needs
        self.goals = goals_of(self.instance, dict(first.chosen)) if shared is None else shared.goals
        self.form = self._prepared()
        self.fixed_cutoffs = np.full((len(self.questions), len(self.form.goals)), np.inf)
        for k, values in (cutoffs or {}).items():
            self.fixed_cutoffs[:, k] = self.form.objectives.phi_of(np.tile(values[:, None], k + 1))[:, k]
        self.known = self.none_known()
        self.form.archive = self.known
        self.rng = np.random.default_rng(first.settings.seed)
        self.pool = self.form.boxes.nothing()
        # What is capped is as narrow as what boxes cannot settle soon: good designs are worth a longer look.
        self.heuristics = JointHeuristics(
            self.instance, self.clock, self.rng, bool(cutoffs), self.tuning.heuristics.joint
        )

    def optima(self, requested: np.ndarray) -> list[Candidate]:
        """Proven optima of the requested questions; the next objective settles ties.

        Parameters
        ----------
        requested : array of bool (questions,)
        """
        return self.ties_settled(self.prove(requested, False))

    def ties_settled(self, proven: np.ndarray) -> list[Candidate]:
        """Return the best designs of questions of which they are proven; the next objective settles ties.

        Parameters
        ----------
        proven : array of bool (questions,)
        """
        return self._second([c for c, q in zip(self.known, self.known.questions(), strict=True) if proven[q]])

    def glimpse(self) -> list[Candidate]:
        """Good designs of the questions, without proof."""
        self.pool, self.heuristics.thorough = self.form.boxes.root(), False
        if len(self.pool):
            rule = self.rule(self.distinct())
            self.heuristics.warm_start(rule)
            self.heuristics.improve(rule)
        return list(self.known)

    def prove(self, requested: np.ndarray, excluded: bool) -> np.ndarray:
        """Find the optimum of each requested question; mask of those proven.

        ``excluded``: also where no question has a design that is easily found; then it is proven that there is none.
        """
        self.pool = self.form.boxes.root()
        if not len(self.pool) or not requested.any():
            return requested
        self.heuristics.first(self.rule(requested), self.pool)
        solved = np.isfinite(self.known.best())
        if not solved.any() and not excluded:
            return np.zeros_like(requested)
        if excluded and solved.any():
            proven = self._prove_in_rounds(requested & solved)
            proven[self._apart(np.flatnonzero(requested & ~solved))] = True
            return proven
        return self._prove_in_rounds(requested)

    def _prove_in_rounds(self, requested: np.ndarray) -> np.ndarray:
        """Prove the optima of the requested questions by both ways of bounding in rounds; mask of those proven."""
        known, unproven = np.isfinite(self.known.best()), requested.copy()
        by_objectives = JointTree(self, self.form, self.known, self.pool)
        by_limits: JointTree | None = None
        # What one way of bounding can hardly tell the other often can: each has its turn before one goes on for long.
        for boxes, sure_boxes, unsure_boxes in self.limits.schedule:
            now = unproven & known
            unproven &= ~known | by_objectives.open_questions(now, max(boxes * int(now.sum()), self.limits.least_boxes))
            if not unproven.any():
                break
            self.heuristics.thorough = True
            self.heuristics.improve(self.rule(unproven))
            by_limits = self.in_infeasibility_mode() if by_limits is None else by_limits
            sure = int((unproven & np.isfinite(self.known.best())).sum())
            node_limit = sure_boxes * sure + unsure_boxes * (int(unproven.sum()) - sure)
            unproven &= by_limits.open_questions(unproven, node_limit)
        proven: np.ndarray = requested & ~unproven
        return proven

    def _apart(self, positions: np.ndarray) -> np.ndarray:
        """Prove the optima of a subset of the questions, or that they have no design, in a separate search.

        Beside questions that have designs, boxes that hold nothing for these are kept until they speak of no other.

        Parameters
        ----------
        positions : array of int
            Of the questions.

        Returns
        -------
        array of int
            The positions of those of which it is proven.
        """
        if not len(positions):
            return positions
        shared = self.shared or SharedBounds(self.questions, tuple(self.instance.moving))
        cutoffs = {k: values[positions] for k, values in self.instance.cutoffs.items()}
        floors = {k: values[positions] for k, values in self.instance.floors.items()}
        questions = [self.questions[q] for q in positions]
        separate = JointOptima(questions, self.clock, shared, self.sought, cutoffs, floors=floors)
        proven = separate.prove(separate.distinct(), True)
        known, codec = separate.known, separate.instance.combinations
        numbers = self.instance.combinations.joined(positions[known.questions()], codec.own(known.combination))
        self.known.add(numbers, known.variables, known.phi)
        self.count(separate, positions)
        settled: np.ndarray = positions[proven]
        return settled

    def count(self, other: JointOptima, positions: np.ndarray) -> None:
        """Add the counters of another search.

        Parameters
        ----------
        other : JointOptima
        positions : array of int
            Which of the questions here each of its questions is.
        """
        more, codec = other.form.counters, other.instance.combinations
        solved = np.array(list(more.solved_combinations), dtype=np.int64)
        numbers = self.instance.combinations.joined(positions[codec.question(solved)], codec.own(solved))
        self.form.counters.add(more, numbers.tolist())

    def best_among(self, combinations: np.ndarray, points: np.ndarray) -> tuple[IncumbentPerScenario, np.ndarray]:
        """Best designs among given combinations, and mask of the questions for which that is proven.

        Parameters
        ----------
        combinations : array
            At most one of each question.
        points : array (combinations, variables)
            Where to look first.
        """
        form, codec, known = self.form, self.instance.combinations, self.none_known()
        requested = self.distinct()
        requested &= np.isin(np.arange(len(requested)), codec.question(combinations))
        form.archive = known
        rule = self.rule(requested, form, known)
        self.heuristics.tried(rule, combinations, points)
        node_limit = self.limits.boxes_per_combination * len(combinations)
        boxes = form.boxes.leaves(combinations)
        outcome = branch_and_bound(form, boxes, rule, self.clock, self.rng, node_limit)
        form.archive = self.known
        return known, requested & ~rule.open_questions(outcome.open)

    def rule(
        self, requested: np.ndarray, form: Formulation | None = None, known: IncumbentPerScenario | None = None
    ) -> BestPerScenario:
        """Pruning rules for boxes of the requested questions; by default with the designs known here."""
        form, known = form or self.form, self.known if known is None else known
        if self.needs is None:
            return BestPerScenario(form, known, self.tolerance_of(self.sought), requested)
        tolerance = self.needs.tolerance
        return BestPerScenario(form, known, lambda phi: np.full(len(phi), tolerance), requested, self.needs.to_beat)

    def in_infeasibility_mode(self) -> JointTree:
        """Search with boxes that carry the resources limits share, which helps where limits are tight."""
        form = self._prepared(infeasibility=True)
        form.counters.solved_combinations = self.form.counters.solved_combinations
        form.bounding.branching.adopt(self.form.bounding.branching.statistics())
        form.archive = known = self.none_known()
        return JointTree(self, form, known, self.everything(form))

    def everything(self, form: Formulation) -> Boxes:
        """Return the boxes to begin with: one of all questions, or of few where they share little."""
        return form.boxes.roots(self.limits.side_by_side) if self.instance.floors else form.boxes.root()

    def none_known(self) -> IncumbentPerScenario:
        """Table for the best design of each question."""
        return IncumbentPerScenario(
            self.instance, self.sought, self.form.n, len(self.form.goals), self.fixed_cutoffs, self.tuning
        )

    def _prepared(self, infeasibility: bool = False) -> Formulation:
        form = None if self.shared is None else self.shared.among(self.instance, infeasibility, self.workers)
        if form is None:
            shared: dict[str, Any] = (
                {} if self.shared is None else dict(slack=self.shared.slack, sizes=self.shared.sizes)
            )
            form = Formulation(self.instance, self.goals, 1, infeasibility, self.workers, self.tuning, **shared)
        return form

    def distinct(self) -> np.ndarray:
        """Mask of distinct questions: one of each set that are equal in all relevant data."""
        apart: np.ndarray = self.representatives() == np.arange(len(self.questions))
        return apart

    def representatives(self) -> np.ndarray:
        """Representative of each question among those equal in all relevant data."""
        tree = self.form.boxes.cells.trees[0]
        first: np.ndarray = tree.first[tree.leaf_of_row]
        return first

    def tolerance_of(self, k: int) -> Callable[[np.ndarray], np.ndarray]:
        """The gap as a distance in phi of an objective, per design."""
        form = self.form
        scale = (form.objectives.log[k], form.objectives.finest[k])
        return lambda phi: gap_tolerance(self.gap, *scale, np.abs(phi))

    def _second(self, chosen: Sequence[Candidate]) -> list[Candidate]:
        """Designs that are as good in the objective and better in the next one, over all parts."""
        form, sought = self.form, self.sought
        if len(form.goals) < 2 or not chosen:
            return list(chosen)
        following = 1 if sought == 0 else 0
        questions = self.instance.combinations.question(np.array([c.combination for c in chosen]))
        cutoffs = self.fixed_cutoffs.copy()
        cutoffs[questions, sought] = np.array([c.phi[sought] for c in chosen]) + form.tuning.tolerances.tie
        known = IncumbentPerScenario(self.instance, following, form.n, len(form.goals), cutoffs, self.tuning)
        requested = np.zeros(len(self.questions), dtype=bool)
        requested[questions] = True
        known.add(*rows_of(chosen))
        rule = BestPerScenario(form, known, self.tolerance_of(following), requested)
        self.heuristics.improve(rule)
        branch_and_bound(form, self.pool, rule, self.clock, self.rng, self.limits.tie * len(chosen))
        better = dict(zip(known.questions().tolist(), known, strict=True))
        return [better.get(int(q), c) for q, c in zip(questions, chosen, strict=True)]
