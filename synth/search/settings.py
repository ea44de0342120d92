"""The numbers that steer a search: how much it tries, when it gives up, and what it takes for equal.

None of them is part of an answer: with other numbers a search takes longer, or leaves more open and says so. They are
handed down from where a question is posed (``synth.search.question.pose``, ``Formulation``), so that whoever wants
others makes a record of them with ``dataclasses.replace`` and passes it in. ``TUNING`` are those that everybody gets.

Counts of boxes and of problems decide wherever they can, never seconds, so that the same question goes the same way on
every machine. What verification takes is not here: it shares nothing with the search, see ``synth.proof.settings``.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from synth.bounds.settings import BranchingSettings, KernelSizes, TogetherLimits
from synth.nlp.settings import NlpSettings
from synth.robust.settings import RobustLimits


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """What the search takes for equal.

    By how much a limit may be missed is no tolerance of the search but a promise of ``docs/results.md``, the same for
    everything that evaluates, searches and verifies: ``synth.order.feasibility.TOLERANCE``. These lie inside it. Users
    meet two of them, ``limit`` and ``snap``, which ``docs/search.md`` names under what is exact: they move with it.

    Parameters
    ----------
    limit : float
        Relative. By how much the search lets designs miss a limit that a variable moves: less than what is allowed, so
        that it does not live off the tolerance.
    edge_worth : float
        In phi. As how much worse a design counts that keeps its limits by the full tolerance alone: more than it may
        gain by using that up, so that it takes the place of no design that does without.
    snap : float
        Relative. How far a makeable value may lie outside a box and still count as inside: more than rounding costs.
    pinned : float
        Relative, and in SI beside ``snap``. As ``snap`` where a range is one value.
    tie : float
        In phi. Objectives that differ by less are the same; cutoffs are looser by as much.
    rounded : float
        Relative, of phi. By how much designs of one front may miss each other and still beat each other: what settling
        ties twice may give away.
    point : float
        Relative. A box as narrow as this in every variable is a single point, settled by its evaluation.
    point_share : float
        Of a range. As how wide a box counts that is a point, where extents of boxes are summed up.
    multiplier_noise : float
        A multiplier as small as this, as an elasticity, is none: what solvers leave of limits that do not bind.
    tight : float
        Relative. A limit that no variable can move is active if it is met this closely.
    """

    limit: float = 1e-8
    edge_worth: float = 1e-5
    snap: float = 1e-9
    pinned: float = 1e-12
    tie: float = 1e-9
    rounded: float = 2e-9
    point: float = 1e-12
    point_share: float = 1e-8
    multiplier_noise: float = 1e-6
    tight: float = 1e-5

    @property
    def margins(self) -> tuple[float, float]:
        """By how much a value may miss the grid: relative, and absolute in SI."""
        return self.snap, self.pinned


@dataclass(frozen=True, kw_only=True)
class SearchEffort:
    """Effort for boxes that a first search has left unresolved.

    Counts of boxes decide wherever they can, so that the same question goes the same way on every machine; the budget
    of time is the last net.

    Parameters
    ----------
    seconds : float
        The budget: so long the search goes on with what a first effort has left open. A time limit takes its place.
    spell : int
        Boxes between two looks at whether boxes keep closing.
    patience : int
        Spells in which neither fewer boxes wait, nor the gap of those that wait is smaller, nor what they hold together
        is, after which it ends.
    closing : float
        The share of what open boxes hold together by which it must fall to count.
    most_waiting : int
        Boxes that may wait; when there are more, those that nearly close come first, so that they become fewer.
    most_stuck : int
        Boxes that are open but too small to be split, after which it ends: limits leave a sliver that never closes.
    behind : float
        Of two alternating ways of bounding, the share of the effort of that which closes more slowly.
    """

    seconds: float = 60.0
    spell: int = 1_000_000
    patience: int = 10
    closing: float = 0.05
    most_waiting: int = 1_000_000
    most_stuck: int = 20_000
    behind: float = 0.25


@dataclass(frozen=True, kw_only=True)
class LevelLimits:
    """How a front of two objectives is searched level by level, in boxes unless another unit is told.

    Parameters
    ----------
    soon : int
        For a whole front at once, before it is judged whether that will close.
    stays_open : float
        Share of the boxes looked into: if more are open, it will not close soon. Trees that close stay below.
    first : int
        For each level that is open, in the first turn of a way of bounding; each turn that closes something doubles it.
    first_of_one : int
        The same for the best in one objective.
    before_looking_at_one : int
        For the best in one objective, before a few combinations near to the designs known are searched to the bottom
        where these are few.
    before_looking : int
        For all levels at which designs are to be looked for, before combinations are solved at them: a looking round
        takes as long as some millions.
    picture : int
        Levels of a rough picture of the front, beside so many as designs are asked for.
    rounds : int
        Of exchanging designs for better ones, and of looking for more beside one for each that is asked for.
    """

    soon: int = 40_000
    stays_open: float = 0.5
    first: int = 5_000
    first_of_one: int = 5_000
    before_looking_at_one: int = 40_000
    before_looking: int = 150_000
    picture: int = 8
    rounds: int = 8


@dataclass(frozen=True, kw_only=True)
class TreeLimits:
    """Limits of branch and bound, in processed boxes unless another unit is named.

    Parameters
    ----------
    cover_front : int
        For covering a front of two objectives at once; what needs more is easier level by level.
    scarce_front : int
        The same where few designs are known although they were looked for.
    first_try : int
        For one best design, before limits are taken for the reason that boxes do not close.
    boxes : int
        For any tree of a question with few unknowns: they hardly ever need so many.
    many_variables : int
        Variables that move from which on boxes hardly close.
    boxes_of_many : int
        For a tree with many variables; and for one best design over few combinations.
    boxes_of_few_parts : int
        The same over combinations that can be solved one by one instead.
    few_combinations : int
        Combinations that are few enough to be solved one by one, each from several starts.
    further : SearchEffort
        For what all this leaves open.
    by_levels : LevelLimits
        For fronts of two objectives that do not close soon.
    together : TogetherLimits
        For one best design, where limits one by one leave much open.
    coarse : float
        The gap with which first designs are looked for.
    coarse_boxes : int
        For looking for first designs.
    first_boxes : int
        The same for one objective: one design is enough to begin with.
    fine : float
        Every design is covered within so many times the mean distance of the points asked for.
    rough : float
        Of three objectives or more: the same of a first cover, which is the last one if enough designs are known then.
        There the mean distance falls as the root of the number of points.
    at_gap : float
        With three objectives or more, everything is covered within the gap at once if that takes at most so many times
        the designs that a coarser cover would do with.
    fill : int
        To find all designs where fewer are chosen than were asked for, beside what was looked into before.
    first_nodes : int
        For the design that comes first, and for each of the ends that it is measured by.
    end_nodes : int
        Boxes for the best in the other objectives among designs that are as good as an end in its own: what such a
        sliver of everything holds is harder to find.
    first_share : float
        Of its score, by which a design must come nearer to the ideal to be looked for: a score is flat where it is
        least, and objectives move by the root of twice so much.
    first_gap : float
        Within which the ends are found that it is measured by: much less than what ends may give away.
    tie : int
        To settle the next objective over all parts, where one objective leaves parts open.
    choices : int
        Rounds of choosing designs and looking for more.
    polishings : int
        Rounds of making the designs chosen as good as their parts allow.
    margin : float
        A gap that must shrink becomes this share of what is needed: a range that shrinks by next to nothing again shall
        not need another proof.
    batch : int
        That are tightened at a time: enough for arrays to pay.
    sweeps : int
        Forward and backward over the formulas, by which a box is tightened: where many sizes are open, two take 1.2
        to 2.6 times the boxes of four, and six hardly any fewer.
    generation : int
        That are sorted by what they promise at a time; the rest waits.
    small_batch : int
        Below which a batch is split twice at once: it costs as much as a larger one.
    generations : int
        That the kernel grows at once where no designs are to be looked for in between.
    levels_per_doubling : int
        Levels of how much better than needed a box could be, in a search by levels.
    levels : int
        Of them in all.
    level_batches : int
        Batches of a level that are kept apart before they are joined.
    focus : int
        Designs known at which it is measured what boxes are split along.
    """

    cover_front: int = 1_000_000
    scarce_front: int = 50_000
    first_try: int = 150_000
    boxes: int = 20_000_000
    many_variables: int = 7
    boxes_of_many: int = 2_000_000
    boxes_of_few_parts: int = 200_000
    few_combinations: int = 3000
    further: SearchEffort = field(default_factory=SearchEffort)
    by_levels: LevelLimits = field(default_factory=LevelLimits)
    together: TogetherLimits = field(default_factory=TogetherLimits)
    coarse: float = 0.1
    coarse_boxes: int = 20_000
    first_boxes: int = 1_000
    fine: float = 2.0
    rough: float = 0.5
    at_gap: float = 2.0
    fill: int = 100_000
    first_nodes: int = 100_000
    end_nodes: int = 200_000
    first_share: float = 1e-7
    first_gap: float = 1e-4
    tie: int = 2_000
    choices: int = 4
    polishings: int = 3
    margin: float = 0.99
    batch: int = 8192
    sweeps: int = 4
    generation: int = 65_536
    small_batch: int = 1024
    generations: int = 3
    levels_per_doubling: int = 2
    levels: int = 64
    level_batches: int = 64
    focus: int = 64


@dataclass(frozen=True, kw_only=True)
class PrimalHeuristicLimits:
    """How long designs are looked for in open boxes and beside designs that are known.

    Parameters
    ----------
    probes : int
        Boxes of which points are evaluated in a round.
    most_problems, least_problems : int
        Continuous problems of boxes that are solved in a round: more while they find designs, fewer while not.
    patience : int
        Rounds without success after which only now and then is looked again.
    inside : float
        Share of a box from its lower ends at which a point is tried: limits are loosened a little when boxes are
        tightened, not when points are evaluated.
    reach : int
        Makeable values on either side of a continuous optimum that are tried.
    most_roundings : int
        Of one design; with more gridded variables only the nearest values are tried.
    tie_weight : float
        Of the other objectives in a problem that seeks one, so that they do not go anywhere.
    parents : int
        Known designs whose parts are exchanged in one round.
    rounds : int
        Of looking beside known designs.
    targets : int
        Places along the front at which each known combination is tried.
    families : int
        Known combinations that are tried at all places.
    solved, solved_over_arrays : int
        Continuous problems of a round: some tens of milliseconds, with kernels and without.
    rounded_off : int
        Continuous optima of a round around which makeable points are tried.
    solved_again : int
        Of these points, per optimum, those at which what is not gridded is solved for.
    elastic : int
        Boxes of a round for which is solved by how much all limits would have to give way.
    long_proof : int
        Rounds of a proof after which boxes are worth a solver again.
    scarce : int
        Designs of a front below which it is worth looking harder.
    learned : int
        Solved problems that tell what is worth splitting, before points of boxes are evaluated alone.
    near : float
        Relative: limits that miss each other by less count as much as those that do by this.
    thin : float
        Relative: a box that is narrower has no choice left in a variable.
    """

    probes: int = 256
    most_problems: int = 128
    least_problems: int = 8
    patience: int = 3
    inside: float = 0.02
    reach: int = 2
    most_roundings: int = 1024
    tie_weight: float = 1e-6
    parents: int = 16
    rounds: int = 12
    targets: int = 24
    families: int = 48
    solved: int = 4096
    solved_over_arrays: int = 512
    rounded_off: int = 48
    solved_again: int = 4
    elastic: int = 64
    long_proof: int = 10
    scarce: int = 16
    learned: int = 100
    near: float = 1e-4
    thin: float = 1e-5


@dataclass(frozen=True, kw_only=True)
class NeighbourhoodLimits:
    """How long a few promising combinations are searched to the bottom, where hardly any designs are known.

    Parameters
    ----------
    rounds : int
        Over the objectives.
    patience : int
        Turns without success, per objective, after which it ends.
    solved : int
        Continuous problems of a turn, two parts away from designs that are known.
    promising : int
        Combinations of a turn.
    boxes : int
        Boxes of the tree of a turn.
    tie_weight : float
        As for :class:`PrimalHeuristicLimits`.
    """

    rounds: int = 40
    patience: int = 2
    solved: int = 4096
    promising: int = 12
    boxes: int = 30_000
    tie_weight: float = 1e-6


@dataclass(frozen=True, kw_only=True)
class PolishingLimits:
    """How long ties are broken and combinations solved one by one.

    Parameters
    ----------
    starts : int
        From which each combination is solved.
    batch : int
        Combinations that are solved at a time.
    ties : int
        Designs that are as good as one, at most.
    moves : int
        Changes of each makeable value and of parts.
    tried_at_once, evaluated_at_once : int
        Points: of the former a screen tells which may be good, so few that arrays stay in the cache; of the latter
        everything is computed. The result is the same for any number.
    """

    starts: int = 6
    batch: int = 2048
    ties: int = 50
    moves: int = 8
    tried_at_once: int = 16_384
    evaluated_at_once: int = 65_536


@dataclass(frozen=True, kw_only=True)
class PartSampling:
    """How parts are drawn where neither bounds nor plain enumeration reach.

    Parameters
    ----------
    trials : int
        Combinations in all.
    batch : int
        Of them, that are drawn and solved at a time.
    directions : int
        In which objectives are traded off against each other.
    worst : float
        In phi: what a trial without a feasible design is worth, worse than any, and finite as samplers want it.
    """

    trials: int = 576
    batch: int = 48
    directions: int = 5
    worst: float = 1e3


@dataclass(frozen=True, kw_only=True)
class LeastInfeasibleLimits:
    """How long the design is looked for that misses the limits by least, where none is feasible.

    Parameters
    ----------
    tries : int
        Combinations, and starts of all of them, of a round.
    rounds : int
        Of exchanging one part of the nearest designs.
    parents : int
        Nearest designs of a round.
    starts : int
        From which each combination is solved where there are few.
    never : float
        Relative: more than any limit can be missed by, which is twice the larger side.
    at_bound : float
        Relative. How near to its bound a size counts as lying there: solvers end inside.
    """

    tries: int = 400
    rounds: int = 4
    parents: int = 3
    starts: int = 16
    never: float = 10.0
    at_bound: float = 1e-5


@dataclass(frozen=True, kw_only=True)
class JointHeuristicLimits:
    """How long designs are looked for of questions that are asked together.

    Parameters
    ----------
    first_boxes : tuple of int
        Boxes, one effort after the other, until a first design is known.
    settling_boxes : int
        Boxes per combination that may hold a better design than is made of it.
    rounds : int
        Of looking beside the best of each question and with what is good in any other.
    anywhere : int
        Combinations at random, where nothing is known.
    known : int
        Combinations that are tried for every question in a round.
    places, far_places : int
        Among the questions, at which one part is exchanged, or two at a time.
    solved : int
        Continuous problems of a round.
    drawn : int
        Combinations, of which those are chosen that are two parts away.
    rounded_off : int
        Continuous optima, per question, around which makeable points are tried.
    """

    first_boxes: tuple[int, ...] = (1_000, 20_000)
    settling_boxes: int = 100
    rounds: int = 6
    anywhere: int = 512
    known: int = 32
    places: int = 8
    far_places: int = 4
    solved: int = 16_384
    drawn: int = 1_000_000
    rounded_off: int = 10


@dataclass(frozen=True, kw_only=True)
class HeuristicLimits:
    """How long designs are looked for, which proves nothing: the better they are, the fewer boxes a proof takes.

    Parameters
    ----------
    primal : PrimalHeuristicLimits
        In boxes, and beside designs that are known.
    neighbourhood : NeighbourhoodLimits
        In a few combinations to the bottom.
    polishing : PolishingLimits
        Among designs that tie.
    parts : PartSampling
        By drawing parts.
    least_infeasible : LeastInfeasibleLimits
        Where nothing is feasible.
    joint : JointHeuristicLimits
        Of joint searches.
    """

    primal: PrimalHeuristicLimits = field(default_factory=PrimalHeuristicLimits)
    neighbourhood: NeighbourhoodLimits = field(default_factory=NeighbourhoodLimits)
    polishing: PolishingLimits = field(default_factory=PolishingLimits)
    parts: PartSampling = field(default_factory=PartSampling)
    least_infeasible: LeastInfeasibleLimits = field(default_factory=LeastInfeasibleLimits)
    joint: JointHeuristicLimits = field(default_factory=JointHeuristicLimits)


@dataclass(frozen=True, kw_only=True)
class JointLimits:
    """How far one search for several questions goes; what needs more is easier alone.

    Parameters
    ----------
    schedule : tuple of (int, int, int)
        Boxes per question and round: with plain boxes; with boxes that carry what limits share; and the same where no
        design is known, as there may be none to be found.
    least_boxes : int
        Plain boxes of a turn at least, however few the questions: one alone takes tens of thousands.
    nearly_closed : float
        Share of the boxes looked into: if fewer are open, as much again is worth it.
    boxes_per_combination : int
        Boxes per question whose parts are given.
    most_boxes : int
        Boxes of all questions: a quarter of them may have to be kept at a time.
    tie : int
        Boxes per question, to settle the next objective.
    front_points : int
        Designs of a front that are sought together; where there are more, questions are answered sooner one by one.
    places : int
        Questions of which a rough picture of the front is made.
    levels : int
        Caps of that picture.
    numbers : int
        Combinations of all questions together, as their numbers must fit 64 bits.
    side_by_side : int
        Levels that begin as one box where each searches a range of its own: alone each box is repeated for every
        level, and all in one they are told apart late.
    """

    schedule: tuple[tuple[int, int, int], ...] = (
        (5_000, 5_000, 5_000),
        (5_000, 20_000, 10_000),
        (5_000, 250_000, 20_000),
    )
    least_boxes: int = 60_000
    nearly_closed: float = 0.1
    boxes_per_combination: int = 20_000
    most_boxes: int = 12_000_000
    tie: int = 200
    front_points: int = 8
    places: int = 8
    levels: int = 12
    numbers: int = 2**61
    side_by_side: int = 4


@dataclass(frozen=True, kw_only=True)
class DominanceSettings:
    """How designs are sorted to tell which of them cover boxes. The result is the same for any number.

    Parameters
    ----------
    block : float
        Of three objectives: designs of a block, as a multiple of the square root of their number.
    rows : int
        Of more objectives: sets of designs that are kept for each order.
    boxes : int
        That are compared over arrays at a time: so few that arrays stay in the cache.
    """

    block: float = 0.35
    rows: int = 512
    boxes: int = 1024


@dataclass(frozen=True, kw_only=True)
class ArraySizes:
    """How much arrays over boxes or points hold at a time. The result is the same for any number.

    Parameters
    ----------
    boxes : int
        That are tightened over arrays at a time, and points that are evaluated.
    compared : int
        Designs that are compared with all others at a time.
    pairs : int
        Of rows of two slots with a refusal between them, for which is known of all clusters which go together; beyond
        that the ends of the clusters tell less, and single combinations the rest.
    """

    boxes: int = 4096
    compared: int = 256
    pairs: int = 4_000_000


@dataclass(frozen=True, kw_only=True)
class ProgressLimits:
    """How much a search tells of the designs it knows while it is at work.

    Parameters
    ----------
    points : int
        Designs that are told at a time: as many as a drawing can show apart.
    pause : float
        Seconds at least from one time to the next; eyes ask for no more, and whoever writes it down pays for each.
    digits : int
        Of each number: these are drawn, not computed with.
    """

    points: int = 200
    pause: float = 0.5
    digits: int = 6


@dataclass(frozen=True, kw_only=True)
class Tuning:
    """All numbers that steer a search.

    Parameters
    ----------
    tolerances : Tolerances
    tree : TreeLimits
    joint : JointLimits
    heuristics : HeuristicLimits
    robust : RobustLimits
    branching : BranchingSettings
    nlp : NlpSettings
    kernels : KernelSizes
    arrays : ArraySizes
    dominance : DominanceSettings
    progress : ProgressLimits
    """

    tolerances: Tolerances = field(default_factory=Tolerances)
    tree: TreeLimits = field(default_factory=TreeLimits)
    joint: JointLimits = field(default_factory=JointLimits)
    heuristics: HeuristicLimits = field(default_factory=HeuristicLimits)
    robust: RobustLimits = field(default_factory=RobustLimits)
    branching: BranchingSettings = field(default_factory=BranchingSettings)
    nlp: NlpSettings = field(default_factory=NlpSettings)
    kernels: KernelSizes = field(default_factory=KernelSizes)
    arrays: ArraySizes = field(default_factory=ArraySizes)
    dominance: DominanceSettings = field(default_factory=DominanceSettings)
    progress: ProgressLimits = field(default_factory=ProgressLimits)


TUNING = Tuning()
