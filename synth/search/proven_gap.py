"""The gap that is proven where bounds have not closed everything: what the open boxes still allow."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from synth.tuning import TUNING


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
                result: np.ndarray = np.where(logs, -np.expm1(-better), better / sizes)
            return result

        worst = np.full(len(phi), share(self.tolerance).max())
        for first in range(0, len(self.corners), at_once):
            corners = self.corners[first : first + at_once]
            improved = share(phi[:, None, :] - corners[None, :, :]).min(axis=2)
            worst = np.maximum(worst, improved.max(axis=1))
        return worst


def least_gap(bounds: Iterable[Bound], phi: np.ndarray, logs: np.ndarray, sizes: np.ndarray) -> float | None:
    """Return the smallest g of which some bound proves that nothing improves a design by more in every objective.

    Parameters
    ----------
    bounds : iterable of Bound
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
    found = [float(b.gaps(phi, logs, sizes).max()) for b in bounds]
    least = min((g for g in found if not math.isnan(g)), default=math.inf)
    # An objective that is a logarithm improves by less than all of itself: more than that is no bound.
    bounded = math.isfinite(least) and not (logs.all() and least >= 1.0)
    return least if bounded else None
