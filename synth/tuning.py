"""The numbers that steer a search: how much it tries, when it gives up, and what it takes for equal.

None of them is part of an answer: with other numbers a search takes longer, or leaves more open and says so. They are
handed down from where a question is posed (``synth.search.question.pose``, ``Formulation``), so that whoever wants
others makes a record of them with ``dataclasses.replace`` and passes it in. ``TUNING`` are those that everybody gets.

Counts of boxes and of problems decide wherever they can, never seconds, so that the same question goes the same way on
every machine. What verification takes is not here: it shares nothing with the search, see ``synth.proof.settings``.
"""

from __future__ import annotations

from dataclasses import dataclass, field


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
    """What is done about boxes that a first effort has left open.

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
        Of two ways of bounding that have turns, the share of the effort of that which closes more slowly.
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
class TogetherLimits:
    """How boxes are bounded by all limits together, for which each takes a linear program of some milliseconds.

    Parameters
    ----------
    after : int
        Boxes that are bounded limit by limit before.
    boxes : int
        That a tree may look into.
    soon : int
        Boxes before it is judged whether the tree will close.
    stays_open : float
        Share of the boxes looked into: if more are open, it will not.
    at_once : int
        Boxes of one batch.
    sweeps : int
        Over the nodes of a box, to know their ranges.
    tangents : tuple of float
        Where sums are bounded from below, as places over the interval of the ratio of their terms.
    yield_cost : float
        What it costs in a linear program if all limits give way, as the objective per unit, both in logarithm.
    others : float
        Beside what blurs linear bounds most, how much it counts for splitting what blurs limits one by one.
    """

    after: int = 1_000_000
    boxes: int = 10_000
    soon: int = 250
    stays_open: float = 0.4
    at_once: int = 128
    sweeps: int = 3
    tangents: tuple[float, ...] = (0.1, 0.5, 0.9)
    yield_cost: float = 1e3
    others: float = 3e-3


@dataclass(frozen=True, kw_only=True)
class TreeLimits:
    """How far branch and bound goes, in boxes that are looked into unless another unit is told.

    Parameters
    ----------
    whole_front : int
        For a front of two objectives at once; what needs more is easier level by level.
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
        Of its score, by which a design must come nearer to the ideal to be looked for.
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

    whole_front: int = 1_000_000
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
    first_share: float = 1e-3
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
    turns : int
        Objectives in turn.
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

    turns: int = 40
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
    """

    tries: int = 400
    rounds: int = 4
    parents: int = 3
    starts: int = 16
    never: float = 10.0


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
    turns : tuple of (int, int, int)
        Boxes per question, by turns: with plain boxes; with boxes that carry what limits share; and the same where no
        design is known, as there may be none to be found.
    least_boxes : int
        Plain boxes of a turn at least, however few the questions: one alone takes tens of thousands.
    nearly_closed : float
        Share of the boxes looked into: if fewer are open, as much again is worth it.
    given_parts : int
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

    turns: tuple[tuple[int, int, int], ...] = (
        (5_000, 5_000, 5_000),
        (5_000, 20_000, 10_000),
        (5_000, 250_000, 20_000),
    )
    least_boxes: int = 60_000
    nearly_closed: float = 0.1
    given_parts: int = 20_000
    most_boxes: int = 12_000_000
    tie: int = 200
    front_points: int = 8
    places: int = 8
    levels: int = 12
    numbers: int = 2**61
    side_by_side: int = 4


@dataclass(frozen=True, kw_only=True)
class AscentSettings:
    """How the worst point of a limit is searched from the worst samples. Nothing is proven by it.

    Parameters
    ----------
    rounds : int
        At most so many.
    starts : int
        Samples from which it begins.
    candidates : int
        The worst samples among which these are chosen.
    apart : float
        Least distance of two starts, as a share of the range.
    first_step, last_step : float
        Shares of the range.
    grow, shrink : float
        Of the step after success and after failure.
    strides : tuple of float
        Steps along the slope, in units of the step along the axes.
    """

    rounds: int = 60
    starts: int = 6
    candidates: int = 512
    apart: float = 0.15
    first_step: float = 0.25
    last_step: float = 1e-9
    grow: float = 2.0
    shrink: float = 0.4
    strides: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)


@dataclass(frozen=True, kw_only=True)
class RobustLimits:
    """How designs are rated over a range, and how often others are asked for that keep their limits over all of it.

    Parameters
    ----------
    searches : int
        At most so many, each with more points at which limits are posed.
    scenarios : int
        New points per limit.
    parts : int
        Boxes that a range is cut into, to prove a limit that is not monotone.
    batch : int
        Boxes that are bounded at a time.
    narrowest : float
        Width of the least box, as a share of the range: where one that small is not decided, none is.
    steep : float
        Relative: a derivative as small as this may have the wrong sign by rounding.
    pad : float
        Relative: a bound this close to a limit may lie on the wrong side of it by rounding.
    points : int
        That are evaluated at a time. The result is the same for any number.
    ascent : AscentSettings
        Of limits that are not monotone.
    """

    searches: int = 5
    scenarios: int = 4
    parts: int = 2**14
    batch: int = 2**8
    narrowest: float = 1e-12
    steep: float = 1e-12
    pad: float = 1e-10
    points: int = 2**15
    ascent: AscentSettings = field(default_factory=AscentSettings)


@dataclass(frozen=True, kw_only=True)
class BranchingSettings:
    """Along what boxes are split. It steers the search and never excludes anything.

    Parameters
    ----------
    samples : int
        Random points at which is measured what limits and objectives depend on.
    step : float
        Relative: how far an input is moved for that.
    largest_influence : float
        A limit that is steeper counts as this steep, as a slope between logarithms.
    least : float
        Influence and weight of what seems to matter to nothing: it must be split some day as well.
    least_if_infeasible : float
        The same where nothing feasible is known: limits that nearly agree are told apart in very small boxes.
    most_bits : int
        Objectives that are told apart when weights are learned.
    some : float
        Share of the multipliers of all objectives from which one counts as asked for.
    enough : int
        Problems solved before their own weights are believed.
    parts_first : float
        How much more it counts to tell parts apart: until then the columns of a cluster are bounded as if they belonged
        to no row.
    questions_first : float
        The same for questions that are answered together: each has a best value of its own.
    late : float
        The same for what the family declares to be split last.
    anywhere : float
        What influences anywhere count beside those at the designs known.
    auxiliary_of : int
        Variables that a node depends on to be worth carrying along with boxes as an auxiliary variable.
    most_auxiliary : int
        Auxiliary variables that boxes carry.
    """

    samples: int = 256
    step: float = 1e-4
    largest_influence: float = 50.0
    least: float = 1e-3
    least_if_infeasible: float = 1e-6
    most_bits: int = 3
    some: float = 1e-3
    enough: int = 8
    parts_first: float = 3.0
    questions_first: float = 6.0
    late: float = 0.01
    anywhere: float = 0.1
    auxiliary_of: int = 2
    most_auxiliary: int = 1


@dataclass(frozen=True, kw_only=True)
class KernelSizes:
    """How much a kernel does at a time.

    Parameters
    ----------
    part : int
        Boxes that a thread tightens at a time.
    tree_part : int
        Boxes whose generations are grown at a time.
    tree_room, tree_beside : int
        Boxes that may come back of them: so many for each, and beside. Where there is no room a box stays as it is.
    """

    part: int = 512
    tree_part: int = 512
    tree_room: int = 4
    tree_beside: int = 4096


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
class InteriorPointSettings:
    """The numbers of the interior-point method, over arrays and in the kernel.

    Parameters
    ----------
    max_evaluations : int
        Of one problem, after which it is given up.
    max_late, late_barrier : int, float
        The same with a barrier below ``late_barrier``: along a flat and bent valley the last steps are tiny, and what
        they could still gain is not worth them.
    dual_tolerance, gap_tolerance, row_tolerance : float
        What an optimum must keep: of the gradient, of products of multipliers and slacks, and by which rows are broken.
    multiplier_share : float
        Gradients count relative to this share of the largest multiplier, where that is above 1: they are sums of so
        large terms.
    first_barrier, least_barrier : float
        Where the barrier begins, and the least it becomes.
    barrier_error, barrier_factor : float
        The barrier goes down where the errors are below ``barrier_error`` times itself: by the factor, or to the power
        3/2.
    barrier_cuts : int
        How often in one step, at most.
    first_penalty, last_penalty, penalty_factor : float
        Price of rows that are broken, how far it is raised, and by which factor at a time.
    pressed_share : float
        Of its price: a row with a larger multiplier presses against the penalty.
    unmet_ratio : float
        Rows that are broken by more than this many times the barrier will not be met by lowering it.
    penalty_barrier : float
        Rows that press against the penalty with a barrier below it are met on their own, without the objective, before
        the penalty is raised.
    met : float
        By how much rows may be broken to count as met then.
    hopeless_barrier, hopeless_dual, hopeless_ratio : float
        Without an objective, rows that are broken by far more than the barrier explains will not be met near here.
    armijo, rounding : float
        Share of the forecast that a step must gain, and what merits may miss each other by rounding.
    backtracking : float
        By which a step that was refused becomes shorter.
    to_boundary : float
        Share of the way to where something becomes zero that a step may go.
    max_rejected, stuck_factor, stuck_barrier : int, float, float
        After so many refusals the barrier is lowered instead, by the factor, down to ``stuck_barrier``.
    multiplier_spread : float
        Multipliers stay within this factor of those that the point itself implies.
    inside : float
        Share of the width that a start keeps from its bounds.
    first_room : float
        That t leaves at a start.
    pinned_width : float
        A variable whose bounds (or their logarithms) are closer does not move.
    least_pivot : float
        Pivots below this share of their diagonal call for a shift of the diagonal.
    first_shift, shift_growth, largest_shift : float
    unknown_shift : float
        The first shift where second derivatives do not exist, so that none are used.
    largest_row : float
        Rows beyond it do not exist.
    """

    max_evaluations: int = 100
    max_late: int = 15
    late_barrier: float = 1e-8
    dual_tolerance: float = 1e-8
    gap_tolerance: float = 1e-9
    row_tolerance: float = 1e-9
    multiplier_share: float = 0.1
    first_barrier: float = 1.0
    least_barrier: float = 1e-10
    barrier_error: float = 10.0
    barrier_factor: float = 0.2
    barrier_cuts: int = 3
    first_penalty: float = 5.0
    last_penalty: float = 1e6
    penalty_factor: float = 20.0
    pressed_share: float = 0.5
    unmet_ratio: float = 10.0
    penalty_barrier: float = 1e-2
    met: float = 1e-7
    hopeless_barrier: float = 1e-3
    hopeless_dual: float = 1e-4
    hopeless_ratio: float = 100.0
    armijo: float = 1e-4
    rounding: float = 1e-12
    backtracking: float = 0.5
    to_boundary: float = 0.99
    max_rejected: int = 10
    stuck_factor: float = 0.01
    stuck_barrier: float = 1e-9
    multiplier_spread: float = 1e4
    inside: float = 1e-2
    first_room: float = 0.1
    pinned_width: float = 1e-10
    least_pivot: float = 1e-13
    first_shift: float = 1e-6
    shift_growth: float = 100.0
    largest_shift: float = 1e30
    unknown_shift: float = 1.0
    largest_row: float = 1e8


@dataclass(frozen=True, kw_only=True)
class PieceSettings:
    """How the pieces of a problem are gone through.

    Parameters
    ----------
    tie : float
        Both sides of a decision count as equal if they differ by less than this share of their size.
    press : float
        Multipliers below it, in the units of the solver, say nothing.
    gain : float
        What is better by less is not, in the units of the solver.
    margin : float
        By which a comparison holds: on its border, the formulas of the other side may be the true ones.
    jump : float
        Rows that differ by more between two pieces where they meet do not meet.
    turns : int
        How often pieces are exchanged, at most.
    """

    tie: float = 1e-6
    press: float = 1e-5
    gain: float = 1e-10
    margin: float = 1e-9
    jump: float = 1e-6
    turns: int = 12


@dataclass(frozen=True, kw_only=True)
class NlpSettings:
    """How continuous problems are solved, many at a time.

    Parameters
    ----------
    method : InteriorPointSettings
    pieces : PieceSettings
        Of formulas that have kinks.
    missed : float
        Rows that are broken by more, in the units of the solver, count as missed: the problem is tried again from
        another start.
    other_starts : tuple of float
        Shares of the way between the bounds.
    edge : float
        Share of max and min by which their edge is rounded off for a first solve: at an optimum on the edge a solver
        finds no way, while a rounded one leads near to it.
    at_once, kernel_at_once : int
        Problems, over arrays and by the kernel. The result is the same for any number.
    lanes : int
        Problems over arrays that take steps together: so many keep arrays in the cache and calls rare.
    refill : float
        Share of the lanes below which new problems come in.
    """

    method: InteriorPointSettings = field(default_factory=InteriorPointSettings)
    pieces: PieceSettings = field(default_factory=PieceSettings)
    missed: float = 1e-7
    other_starts: tuple[float, ...] = (0.75, 0.25)
    edge: float = 1e-3
    at_once: int = 6000
    kernel_at_once: int = 128
    lanes: int = 2048
    refill: float = 0.75


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
