"""Settings of the nonlinear solvers: steps, tolerances, sizes of batches."""

from __future__ import annotations

from dataclasses import dataclass, field


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
    first_slack : float
        Slack that t leaves in the worst row at a start.
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
    first_slack: float = 0.1
    pinned_width: float = 1e-10
    least_pivot: float = 1e-13
    first_shift: float = 1e-6
    shift_growth: float = 100.0
    largest_shift: float = 1e30
    unknown_shift: float = 1.0
    largest_row: float = 1e8


@dataclass(frozen=True, kw_only=True)
class PieceSettings:
    """How the search among the pieces of a problem proceeds.

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
    exchanges : int
        Exchanges of pieces, at most.
    """

    tie: float = 1e-6
    press: float = 1e-5
    gain: float = 1e-10
    margin: float = 1e-9
    jump: float = 1e-6
    exchanges: int = 12


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


NLP = NlpSettings()
