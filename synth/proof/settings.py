"""How far a saved claim is proven again: the numbers of verification, none of which the search knows."""

from __future__ import annotations

import math
from dataclasses import dataclass

from synth.order.feasibility import TOLERANCE


@dataclass(frozen=True, kw_only=True)
class ProofLimits:
    """How far the tree of a proof goes, and what it takes for rounding.

    Parameters
    ----------
    most_nodes : int
        Boxes in all, after which a proof is given up.
    most_open : int
        Boxes that may wait at a time: what memory allows.
    most_stuck : int
        Boxes that are open but too small to be split, after which it is given up: it would only find more of them.
    chunk : int
        Boxes that are looked into at a time: enough for arrays to pay.
    first : int
        Boxes to begin with.
    few : int
        Below this many boxes are split more than once at a time: a smaller batch costs as much as a larger one.
    sweeps : int
        In which the ranges of all inputs are cut to what the limits leave, before anything is split.
    few_guided : int
        The same of a guided tree, which is split well from the first: it needs few boxes, and most by far are its own.
    at_once : int
        Boxes that a proof of all regions at once looks into before guided trees go on beside it.
    at_once_each : int
        So many more for each region: fronts of many designs, whose boxes close, take about as many.
    turn : int
        Boxes of each tree in its first turn; every turn has twice as many as the one before.
    behind : float
        What the proof of all regions at once gets of a turn of a guided tree.
    around : float
        How far from a design limits and objectives are taken as straight to see which of them hold it in its place:
        by logarithm, or as a share of a range.
    faint : float
        By how much the other ones count when a box is split, beside the one that counts most.
    tries : int
        Designs in the middle of boxes that are looked at in each round, those that most likely refute the claim.
    row_tolerance : float
        Relative. By which a design may miss a limit and still refute a claim: a little more than feasibility allows.
    cut_tolerance : float
        Relative. By which limits cut ranges more loosely than that.
    per_gap : float
        Both are so many times less than the gap that is proven, for limits that something continuous moves.
    guard_tolerance : float
        The same of a guard, which has no tolerance: for rounding alone.
    pad : float
        Relative. By which ends are moved outward that limits have moved inward; rounding is far below.
    snap : float
        Relative. How far a makeable value or a row may lie outside and still count as inside.
    thin : float
        Relative width below which a variable is not split any more.
    same : float
        Relative. What is saved and agrees so far with what is computed again is the same.
    nearly : float
        Relative. How much worse than the best a design may be in an objective to tell what the others must cost then.
    costly : float
        On the scale of a ranking. An end of a front beyond it is told to cost much for little.
    least_ratio : float
        Of the smaller end of a scale to the larger. Below it an objective is not ranked by ratios.
    noise : float
        In SI. The same of numbers that are zero but for rounding.
    rounding : float
        Relative. The same of numbers that are what is left of larger ones.
    widest_gap : float
        The largest gap that is looked for where the one claimed cannot be proven.
    narrowings : int
        Of the gap that is found instead.
    """

    most_nodes: int = 50_000_000
    most_open: int = 2_000_000
    most_stuck: int = 64
    chunk: int = 4096
    first: int = 1024
    few: int = 2048
    sweeps: int = 6
    few_guided: int = 256
    at_once: int = 40_000
    at_once_each: int = 1_000
    turn: int = 20_000
    behind: float = 0.25
    around: float = 1e-2
    faint: float = 1e-12
    tries: int = 4
    row_tolerance: float = 1.01 * TOLERANCE
    cut_tolerance: float = 2e-6
    per_gap: float = 500.0
    guard_tolerance: float = 1e-12
    pad: float = 1e-10
    snap: float = 1e-9
    thin: float = 1e-9
    same: float = 1e-9
    nearly: float = 0.005
    costly: float = 1.1
    least_ratio: float = 1e-9
    noise: float = 1e-15
    rounding: float = 1e-13
    widest_gap: float = 0.5
    narrowings: int = 3

    def share_for(self, gap: float | None) -> float:
        """Share of the tolerances of limits with which a proof to a gap works; all of them where nothing is listed."""
        return 1.0 if gap is None else min(1.0, gap / (self.per_gap * self.cut_tolerance))

    def agree(self, a: float | None, b: float, scale: float = 0.0) -> bool:
        """True if two numbers are the same as far as numbers can tell; not-a-number is the same as itself.

        Parameters
        ----------
        a, b : float
            None is not-a-number.
        scale : float
            Size of what they are the difference of, where terms cancel: a share of that is rounding.
        """
        if a is None:
            return math.isnan(b)
        rounding = max(self.noise, self.rounding * scale)
        return (math.isnan(a) and math.isnan(b)) or math.isclose(a, b, rel_tol=self.same, abs_tol=rounding)

    def close(self, a: float, b: float) -> bool:
        """True if two relative differences are the same."""
        return (math.isnan(a) and math.isnan(b)) or abs(a - b) <= self.same


PROOF = ProofLimits()
