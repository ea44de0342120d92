"""The gap that is proven where bounds have not closed everything: what the open boxes still allow."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from synth.order.pareto import non_dominated
from synth.search.settings import TUNING


@dataclass(frozen=True)
class Bound:
    """What is proven of all designs: each lies in an open box, or a known design covers it within a tolerance.

    Parameters
    ----------
    tolerance : array (objectives,)
        In phi.
    corners : array (boxes, objectives)
        Lower bounds of phi of the open boxes.
    """

    tolerance: np.ndarray
    corners: np.ndarray

    def times(self, factor: np.ndarray) -> Bound:
        """The same where phi of all objectives is multiplied by a factor."""
        return Bound(self.tolerance * factor, self.corners * factor)

    def gaps(
        self, phi: np.ndarray, logs: np.ndarray, sizes: np.ndarray, at_once: int = TUNING.arrays.boxes
    ) -> np.ndarray:
        """Return, per design listed, by how much at most another one improves it in every objective.

        Parameters
        ----------
        phi : array (designs, objectives)
        logs : array of bool (objectives,)
            Whether phi is a logarithm.
        sizes : array (objectives,)
            In phi, of what a share is meant where it is none.
        at_once : int, optional
            Boxes. The result is the same for any number.
        """

        def share(better: np.ndarray) -> np.ndarray:
            with np.errstate(all="ignore"):
                # Of nothing there is no share: what is exactly zero is improved by nothing or by all.
                shares = np.where(sizes > 0, better / sizes, np.where(better > 0, np.inf, 0.0))
                result: np.ndarray = np.where(logs, -np.expm1(-better), shares)
            return result

        worst = np.full(len(phi), share(self.tolerance).max())
        for first in range(0, len(self.corners), at_once):
            corners = self.corners[first : first + at_once]
            improved = share(phi[:, None, :] - corners[None, :, :]).min(axis=2)
            worst = np.maximum(worst, improved.max(axis=1))
        return worst


@dataclass(frozen=True)
class Level:
    """What is proven of the designs within some cutoffs: none is better in one objective, unless in an open box.

    Parameters
    ----------
    within : array (objectives,)
        Cutoffs of phi; infinite where there is none.
    sought : int
        The objective.
    least : float
        phi of it: nothing within the cutoffs is better by more than its tolerance, but for what is open.
    tolerance : array (objectives,)
        In phi; of the objective that is sought.
    corners : array (boxes, objectives)
        Lower bounds of phi of the open boxes.
    """

    within: np.ndarray
    sought: int
    least: float
    tolerance: np.ndarray
    corners: np.ndarray

    def speaks_of(self, phi: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
        """Tell of which designs (designs, objectives) it says what can improve them by more than a tolerance.

        What does so lies within the cutoffs, and what is proven there is no worse than the design.
        """
        inside: np.ndarray = np.all(phi - tolerance <= self.within, axis=1) & (phi[:, self.sought] <= self.least)
        return inside

    def proves(self, phi: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
        """Tell of which designs it proves that nothing improves them by more than a tolerance in every objective."""
        fine = not len(self.corners) and bool(self.tolerance[self.sought] <= tolerance[self.sought])
        return self.speaks_of(phi, tolerance) & fine


@dataclass(frozen=True)
class LevelBound:
    """Bounds of designs one by one, each within its cutoffs.

    Parameters
    ----------
    tolerance : array (objectives,)
        In phi.
    levels : list of Level
    """

    tolerance: np.ndarray
    levels: Sequence[Level]

    def gaps(self, phi: np.ndarray, logs: np.ndarray, sizes: np.ndarray) -> np.ndarray:
        """Largest possible improvement of each listed design; as :meth:`Bound.gaps`."""
        best = np.full(len(phi), np.inf)
        for level in self.levels:
            rows = np.flatnonzero(level.speaks_of(phi, self.tolerance))
            bound = Bound(np.maximum(self.tolerance, level.tolerance), level.corners)
            if len(rows):
                best[rows] = np.minimum(best[rows], bound.gaps(phi[rows], logs, sizes))
        return best


def lowest(corners: np.ndarray) -> np.ndarray:
    """Lower bounds (boxes, objectives) below which no other one lies: they imply the others."""
    known = np.nan_to_num(corners, nan=-np.inf)
    # Of those that are equal to nine digits one stays.
    result: np.ndarray = known[non_dominated(known)] - TUNING.tolerances.tie
    return result


def least_gap(
    bounds: Iterable[Bound | LevelBound], phi: np.ndarray, logs: np.ndarray, sizes: np.ndarray
) -> float | None:
    """Return the smallest g of which some bound proves that nothing improves a design by more in every objective.

    Parameters
    ----------
    bounds : iterable of Bound or LevelBound
    phi, logs, sizes
        As for :meth:`Bound.gaps`.

    Returns
    -------
    float, optional
        None where nothing is bounded.

    Examples
    --------
    >>> whole = Bound(np.zeros(1), np.log([[5.0]]))
    >>> round(least_gap([whole], np.log([[10.0]]), np.array([True]), np.ones(1)), 9)
    0.5
    """
    gaps = [float(b.gaps(phi, logs, sizes).max()) for b in bounds]
    least = min((g for g in gaps if not math.isnan(g)), default=math.inf)
    # An objective that is a logarithm improves by less than all of itself: more than that is no bound.
    bounded = math.isfinite(least) and not (logs.all() and least >= 1.0)
    return least if bounded else None
