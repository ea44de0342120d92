"""Settings of bounds over boxes: branching, relaxations, sizes of kernels."""

from __future__ import annotations

from dataclasses import dataclass


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
    active_share : float
        Share of the multipliers of all objectives from which one counts as active.
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
    active_share: float = 1e-3
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
    capacity_per_box, extra_capacity : int
        Boxes that may come back: so many per box of a part, and more per part. Beyond, a box stays unsplit.
    """

    part: int = 512
    tree_part: int = 512
    capacity_per_box: int = 4
    extra_capacity: int = 4096
