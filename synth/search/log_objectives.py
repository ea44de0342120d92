"""Log-objectives, ``phi``: the scale on which a search compares objectives of different kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.search.resolution import gap_tolerance, goal_scales


@dataclass(frozen=True)
class LogObjectives:
    """Objectives as the search compares them: smaller is better.

    An objective that is surely positive and to be made small is measured by its logarithm, so that differences are
    ratios; any other is its signed value over a scale.

    Parameters
    ----------
    log : array of bool (objectives,)
        Which are measured by logarithm.
    scales : array (objectives,)
        Units of those that are not, in SI; 1 elsewhere.
    finest : array (objectives,)
        Resolutions in phi, which no gap goes below; 0 by logarithm.
    declared : array of bool (objectives,)
        Whose resolution the declaration tells.
    """

    log: np.ndarray
    scales: np.ndarray
    finest: np.ndarray
    declared: np.ndarray

    @staticmethod
    def of(log: Sequence[bool], sizes: np.ndarray, declared: Sequence[float | None]) -> LogObjectives:
        """Return the scale of some objectives.

        Parameters
        ----------
        log : list of bool
            Which are surely positive and to be made small.
        sizes : array (objectives,)
            Usual sizes in SI.
        declared : list
            Resolutions in SI, None where the declaration leaves it to the usual size.
        """
        by_logarithm = np.array(log, dtype=bool)
        declared_so = np.array([x is not None for x in declared], dtype=bool)
        return LogObjectives(by_logarithm, *goal_scales(by_logarithm, sizes, declared), declared_so)

    def again(self, phi: np.ndarray, before: LogObjectives) -> np.ndarray:
        """Phi (batch, objectives) for phi on another scale of the same objectives."""
        if np.array_equal(self.scales, before.scales):
            return phi
        return phi * np.where(self.log, 1.0, before.scales / self.scales)

    def phi_of(self, values: np.ndarray) -> np.ndarray:
        """Return phi for signed objective values (batch, objectives), all or the first ones."""
        phi = np.empty(values.shape)
        with np.errstate(all="ignore"):
            for k in range(values.shape[1]):
                if self.log[k]:
                    np.log(np.maximum(values[:, k], 1e-300), out=phi[:, k])
                else:
                    np.divide(values[:, k], self.scales[k], out=phi[:, k])
        return phi

    def values_of(self, phi: np.ndarray) -> np.ndarray:
        """Return signed objective values for phi (..., objectives), all or the first ones."""
        values = np.empty(phi.shape)
        for k in range(phi.shape[-1]):
            values[..., k] = self.signed(k, phi[..., k])
        return values

    def signed(self, k: int, phi: np.ndarray) -> np.ndarray:
        """Return signed values of the objective numbered ``k`` for its phi."""
        with np.errstate(all="ignore"):
            values: np.ndarray = np.exp(phi) if self.log[k] else phi * self.scales[k]
        return values

    def tolerance(self, gap: float, sizes: np.ndarray | None = None) -> np.ndarray:
        """Return a gap as a distance in phi, per objective; ``sizes`` in phi where it is no share of the value."""
        return gap_tolerance(gap, self.log, self.finest, np.ones(len(self.log)) if sizes is None else sizes)
