"""What a search for a front knows at any time: what is asked, designs found, what is proven, and what is left open."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.branching import BranchingStatistics
from synth.order.feasibility import SLACK, slack_for
from synth.question.instance import Instance
from synth.question.settings import Progress, SearchSettings
from synth.search.archive import Candidate, rows_of
from synth.search.budget import Clock
from synth.search.counters import SearchCounters
from synth.search.formulation import Formulation
from synth.search.goals import goals_of
from synth.search.joint.joint_optima import SharedBounds
from synth.search.joint.levels import Cutoffs, LevelProof
from synth.search.nearest_ideal import ScoredFront
from synth.search.proven_gap import Bound, Level, LevelBound
from synth.search.pruning import EpsilonCover, NonImprovement
from synth.search.resolution import ranges
from synth.search.settings import TUNING, TreeLimits, Tuning
from synth.search.shown_designs import ShownDesigns
from synth.search.stage_progress import StageProgress
from synth.search.starting_front import StartingFront
from synth.search.turns import TurnBudget
from synth.search.warm_start import WarmStart


@dataclass(frozen=True, kw_only=True)
class FrontTask:
    """What one search is to find and how; it does not change while the search goes on.

    Parameters
    ----------
    instance : Instance
    chosen : mapping
        The objectives that are traded off, with their sense.
    settings : SearchSettings
    tuning : Tuning
    node_limit : int, optional
        Boxes that each tree may look into; what stays open is not solved then. None: as many as are worth it, and then
        all that can be done about the rest.
    warm : WarmStart
        What is known of similar questions.
    """

    instance: Instance
    chosen: Mapping[str, str]
    settings: SearchSettings
    tuning: Tuning = TUNING
    node_limit: int | None = None
    warm: WarmStart = field(default_factory=WarmStart)

    @property
    def m(self) -> int:
        """How many objectives are traded off."""
        return len(self.chosen)

    @property
    def limits(self) -> TreeLimits:
        """How far trees go."""
        return self.tuning.tree

    @property
    def thorough(self) -> bool:
        """Whether all is done that can be done about what stays open."""
        return self.node_limit is None

    @property
    def oversampled(self) -> int:
        """Oversampled number of points: duplicates and dominated designs are dropped later."""
        return self.settings.points + self.settings.points // 3 + 5

    def boxes_per_tree(self) -> int:
        """Number of boxes that a tree may look into; with many unknowns they hardly close.

        Combinations that are few are solved one by one instead; where boxes for one best design over few combinations
        do not close soon, limits leave a sliver that they hardly ever close on.
        """
        if self.node_limit is not None:
            return self.node_limit
        instance, limits = self.instance, self.limits
        few = instance.combinations.count <= limits.few_combinations
        if int(np.sum(instance.ranges.lower < instance.ranges.upper)) < limits.many_variables:
            return limits.boxes_of_many if self.m == 1 and few else limits.boxes
        return limits.boxes_of_few_parts if few else limits.boxes_of_many

    def formulation(
        self,
        infeasibility: bool,
        counters: SearchCounters | None = None,
        slack: float = SLACK,
        sizes: Mapping[str, float] = MappingProxyType({}),
    ) -> Formulation:
        """Return the question ready to be searched.

        Parameters
        ----------
        infeasibility : bool
            Whether it is for proving that limits exclude each other.
        counters : SearchCounters, optional
            Those of an earlier formulation, which go on.
        slack : float
            By which limits are loosened that something continuous moves.
        sizes : mapping
            Objective -> its size in SI near the front, where that is known.
        """
        goals = goals_of(self.instance, self.chosen)
        workers = self.settings.workers
        return Formulation(self.instance, goals, self.m, infeasibility, workers, self.tuning, counters, slack, sizes)


@dataclass
class FrontCounters:
    """The work of a search beside that of its formulation.

    Parameters
    ----------
    scalar_problems : int
        Best designs in one objective that were searched.
    sampled_parts : int
        Combinations that were drawn by part sampling.
    nodes : int
        Boxes that were looked into.
    solves_to_find : int, optional
        Continuous problems that were solved for the designs listed: settling ties and prices come after.
    """

    scalar_problems: int = 0
    sampled_parts: int = 0
    nodes: int = 0
    solves_to_find: int | None = None


@dataclass
class FrontProof:
    """What is proven so far, and what is left open.

    Parameters
    ----------
    open_combinations : float
        That may still hold a feasible design.
    closed : bool
        Whether no tree has left anything open.
    exhausted : bool
        Whether all combinations that were left open have been solved one by one.
    complete : bool
        Whether all designs that none dominates are listed.
    unresolved : int
        Boxes that were left open.
    bounds : list of Bound
        What is proven of all designs, each on its own.
    levels : list of Level
        What is proven of designs within cutoffs.
    finest_cover : EpsilonCover, optional
        The finest cover that is finished.
    designs : set of bytes
        phi of designs that need no proof any more.
    tolerance_under_way : array (objectives,), optional
        Of the tree that is under way, if it speaks of all designs.
    staircase : NonImprovement, optional
        The proof of designs that is under way.
    """

    open_combinations: float
    closed: bool = True
    exhausted: bool = True
    complete: bool = False
    unresolved: int = 0
    bounds: list[Bound | LevelBound] = field(default_factory=list)
    levels: list[Level] = field(default_factory=list)
    finest_cover: EpsilonCover | None = None
    designs: set[bytes] = field(default_factory=set)
    tolerance_under_way: np.ndarray | None = None
    staircase: NonImprovement | None = None

    def note_cover(self, rule: EpsilonCover) -> None:
        """Note that everything is covered as a rule asks."""
        if self.finest_cover is None or np.any(rule.tolerance < self.finest_cover.tolerance):
            self.finest_cover = rule
        self.note_covered_within(rule.tolerance)

    def note_covered_within(self, tolerance: np.ndarray) -> None:
        """Note that known designs cover all others within a tolerance."""
        self.bounds.append(Bound(tolerance, np.empty((0, len(tolerance)))))

    def measured_by(self, factor: np.ndarray) -> None:
        """Keep what is proven where phi of all objectives is multiplied by a factor."""
        self.bounds = [b.times(factor) for b in self.bounds if isinstance(b, Bound)]
        self.finest_cover, self.designs, self.levels = None, set(), []
        self.closed, self.exhausted, self.unresolved = True, True, 0  # what comes is proven anew

    def give_up(self) -> None:
        """Note that the search ends before its proof does."""
        self.closed = self.exhausted = self.complete = False


@dataclass
class OpenBoxBudget:
    """Budget for boxes that a first search has left unresolved.

    Parameters
    ----------
    seconds : float
        That are left; infinite where a time limit of the whole search takes the place of a budget.
    spent : bool
        Whether it was the budget that ended the work on open boxes.
    boxes : float
        That alternating trees of a front may process.
    """

    seconds: float
    spent: bool = False
    boxes: float = 0.0

    def take(self, budget: TurnBudget) -> None:
        """Reduce the budget to the rest of that of alternating trees."""
        self.boxes = max(self.boxes - budget.looked, 0.0)
        self.seconds, self.spent = budget.effort.seconds, self.spent or budget.spent


class FrontState:
    """What a search for a front knows; its stages read it and write what they find.

    Parameters
    ----------
    task : FrontTask
    progress : callable, optional
        Told how far the search is.
    """

    def __init__(self, task: FrontTask, progress: Progress | None = None) -> None:
        instance, settings, learned = task.instance, task.settings, task.warm.branching
        self.task, self.node_limit = task, task.boxes_per_tree()
        shown = ShownDesigns(list(task.chosen), task.tuning.progress)
        self.progress = StageProgress(
            progress,
            instance.combinations.count,
            lambda: len(self.form.archive),
            lambda: shown.of(self.form),
            task.tuning.progress,
        )
        self.form, self.infeasibility_mode, self.slack = task.formulation(infeasibility=False), False, SLACK
        limit = settings.time_limit
        end = math.inf if limit is None else self.progress.started + limit
        self.clock = Clock(end, self.progress.working)
        self.budget = OpenBoxBudget(task.limits.further.seconds if limit is None else math.inf)
        self.budget.boxes = task.limits.boxes if task.thorough else self.node_limit
        self.sizes: Mapping[str, float] = {}  # of objectives near the front, where they were measured there
        self.rng = np.random.default_rng(settings.seed)
        self.counters = FrontCounters()
        self.proof = FrontProof(open_combinations=float(instance.combinations.count))
        self.pool: Boxes = self.form.boxes.nothing()  # the boxes that may hold a feasible design
        self.rule = self.cover_at_gap(None)
        self.spans = np.zeros(task.m)  # of phi from one end of the front to the other, once these are known
        self.front: list[Candidate] = []
        self.scored: ScoredFront | None = None  # how its designs are ranked, once that is known
        self.spare: list[Candidate] = []  # designs that stand as well, but are more than were asked for
        self.start = StartingFront.nothing(task.m)
        self.by_levels = False  # whether a front at once has turned out to cost too much
        self.learned_at_levels: BranchingStatistics | None = None  # where boxes of levels are worth splitting
        self.looked_harder = False  # whether a few combinations were searched to the bottom
        self._shared: SharedBounds | None = None
        self.sampled = False  # whether parts were drawn for what several levels leave open
        self.may_find_more = True  # unless a try was given up
        self.open_at_ties: Boxes | None = None  # boxes left by a cover for all designs; None before it
        self.reporting = False  # whether the designs stand, and are only told
        self.taught = learned is not None and self.form.bounding.branching.adopt(learned)

    # -- rules and designs ----------------------------------------------------------------------

    def cover_at_gap(self, sizes: np.ndarray | None) -> EpsilonCover:
        """Return the cover that the gap asks for.

        Parameters
        ----------
        sizes : array (objectives,), optional
            In phi: what the gap of objectives that may be zero is a share of.
        """
        form, m = self.form, self.task.m
        tolerance = form.objectives.tolerance(self.task.settings.gap, sizes)[:m]
        return EpsilonCover(range(m), tolerance, np.full(len(form.goals), np.inf), form.archive)

    def cover_within(self, tolerance: np.ndarray) -> EpsilonCover:
        """Return the cover of everything within a tolerance."""
        return EpsilonCover(self.rule.columns, tolerance, self.rule.fixed_cutoffs, self.form.archive)

    def fine_cover(self) -> EpsilonCover:
        """Return the cover that is as fine as the points asked for need, at most as the gap."""
        return self._cover_apart(self.task.limits.fine, self.task.settings.points)

    def rough_cover(self) -> EpsilonCover:
        """Return a cover that shows a front of three objectives or more, never finer than :meth:`fine_cover`.

        Such a front has a dimension less than there are objectives, and points divide its span by the root of their
        number, not by their number as along a line.
        """
        limits, points = self.task.limits, self.task.settings.points
        root = points ** (1 / (self.task.m - 1))
        return (
            self._cover_apart(limits.rough, root) if limits.rough / root > limits.fine / points else self.fine_cover()
        )

    def _cover_apart(self, times: float, parts: float) -> EpsilonCover:
        """Return the cover within so many times a part of the span of the designs known, at most as fine as the gap.

        With three objectives or more a cover that is hardly coarser than the gap is made at the gap at once: it then
        proves what is chosen, while a coarser one and a proof of the designs chosen go over the same ground twice.
        """
        phi = self.form.archive.phi[:, : self.task.m]
        span = np.ptp(phi, axis=0) if len(phi) else np.zeros(self.task.m)
        tolerance = np.maximum(times * span / parts, self.rule.tolerance)
        if self.task.m > 2:
            # So many times the designs cover a front of that dimension within the gap.
            designs = float(np.prod(tolerance / self.rule.tolerance)) ** (1 - 1 / self.task.m)
            tolerance = self.rule.tolerance if designs <= self.task.limits.at_gap else tolerance
        return self.cover_within(tolerance)

    def phi_listed(self) -> np.ndarray:
        """Return phi of the designs listed (designs, objectives)."""
        return np.array([c.phi[: self.task.m] for c in self.front])

    def take(self, design: Candidate) -> None:
        """Put a feasible design into the archive."""
        self.form.archive.add(*rows_of([design]))

    def levels_within(self, cutoffs: Cutoffs) -> LevelProof:
        """Return the search for the best in the second objective within cutoffs of the first."""
        if self._shared is None:
            self._shared = SharedBounds([self.task], (), slack=self.slack, sizes=self.sizes)
        proof = LevelProof(self.task, self._shared, self.clock, cutoffs)
        proof.begin_with(self.form.archive, self.learned_at_levels)
        return proof

    def hopeless(self, looked: int, waiting: int) -> bool:
        """True if a front of two objectives will hardly close at once, by its boxes."""
        limits = self.task.limits.by_levels
        return self.task.m == 2 and looked >= limits.soon and waiting > limits.stays_open * looked

    def turn_budget(self) -> TurnBudget:
        """Budget of alternating trees."""
        seconds = self.budget.seconds if self.task.thorough else 0.0
        return TurnBudget(self.budget.boxes, replace(self.task.limits.further, seconds=seconds))

    # -- boxes ---------------------------------------------------------------------------------

    def set_pool(self) -> None:
        """Start from the root box; its lower bounds are the first proven bounds."""
        self.pool, self.open_at_ties = self.form.boxes.root(), None
        corners = self.form.objectives.phi_of(self.pool.bounds)[:, : self.task.m]
        self.proof.bounds.append(Bound(np.zeros(self.task.m), corners))

    def begin_again(self, infeasibility: bool) -> None:
        """Begin again with boxes that also carry what limits share, or no longer do, and keep what is known."""
        known, self.infeasibility_mode = self.form, infeasibility
        self.form = self.formulation(infeasibility, known)
        if infeasibility:
            self.form.bounding.branching.adopt(known.bounding.branching.statistics())
        phi = self.form.objectives.again(known.archive.phi, known.objectives)
        self.form.archive.add(known.archive.combination, known.archive.variables, phi)
        self.rule = self.cover_at_gap(None)
        self.set_pool()

    def formulation(self, infeasibility: bool, known: Formulation) -> Formulation:
        """The question prepared anew as it is searched by now; what an earlier formulation counted goes on."""
        return self.task.formulation(infeasibility, known.counters, self.slack, self.sizes)

    def measure_near(self, values: np.ndarray) -> bool:
        """Measure objectives that may be zero by their size near the front; True where that is finer than before.

        A resolution that is a share of the usual size over all that may be designed says nothing where the front lies
        far below that.

        Parameters
        ----------
        values : array (designs, objectives)
            SI, of the best designs known.
        """
        objectives, m = self.form.objectives, self.task.m
        near = ranges(values[:, :m])
        coarse = ~objectives.log[:m] & ~objectives.declared[:m] & (near > 0)
        coarse &= objectives.finest[:m] * objectives.scales[:m] > self.task.settings.gap * near
        if not coarse.any():
            return False
        names = list(self.task.chosen)
        self.sizes = {**self.sizes, **{names[k]: float(near[k]) for k in np.flatnonzero(coarse)}}
        before = self.form.objectives
        self.begin_again(self.infeasibility_mode)
        factor = np.where(before.log, 1.0, before.scales / self.form.objectives.scales)[:m]
        everything = self.proof.bounds.pop()  # of the new box of everything, measured anew already
        self.proof.measured_by(factor)
        self.proof.bounds.append(everything)
        self.start = replace(self.start, phi=self.start.phi * factor)
        return True

    def loosen_less(self) -> None:
        """Begin again with limits that are loosened by far less than the gap, now that designs are known.

        That nothing is feasible is proven with the whole slack: some design may need all of the tolerance.
        """
        slack = slack_for(self.task.settings.gap)
        if slack < self.slack and len(self.form.archive):
            self.slack = slack
            self.begin_again(self.infeasibility_mode)

    def go_on_with(self, form: Formulation) -> None:
        """Switch to an earlier formulation, and keep the known designs."""
        known, self.form, self.infeasibility_mode = self.form.archive, form, form.infeasibility
        form.archive.add(known.combination, known.variables, known.phi)
        self.rule, self.pool, self.open_at_ties = self.cover_at_gap(None), form.boxes.root(), None

    def begin_tree(self, tolerance: np.ndarray | None) -> None:
        """Remember what a tree is to prove; if time runs out, the boxes that are open then tell what it has proven."""
        self.proof.tolerance_under_way = tolerance
        self.clock.open = []

    def end_tree(self) -> None:
        """Note that no tree is under way: one that was stopped by an exception stays."""
        self.proof.tolerance_under_way = None
