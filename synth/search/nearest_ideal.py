"""The design that comes first: what it is measured by, and the rule that looks for what comes nearer to the ideal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from synth.bounds.kernel_subtrees import CutoffTables
from synth.order.pareto import Scale
from synth.search.archive import Archive, Candidate
from synth.search.formulation import Formulation
from synth.search.log_objectives import LogObjectives


@dataclass(frozen=True)
class ScoredFront:
    """How designs of a front are ranked.

    Parameters
    ----------
    scale : Scale
        Of the front, as far as it is known.
    weights : array (objectives,)
    objectives : LogObjectives
    """

    scale: Scale
    weights: np.ndarray
    objectives: LogObjectives

    def scores(self, phi: np.ndarray) -> np.ndarray:
        """Return the scores of designs by phi (designs, objectives)."""
        return self.scale.scores(self.objectives.values_of(phi), self.weights)

    def best(self, phi: np.ndarray) -> int:
        """Return the position of the design that comes first."""
        return int(np.argmin(self.scores(phi)))


class NearestIdeal:
    """Seeks the design that comes first: no other one may have a score that is smaller by more than a tolerance.

    Parameters
    ----------
    scored : ScoredFront
    share : float
        Of the score: the tolerance.
    known : Archive
        Designs known, one at least.
    least : float
        The smallest score of designs that are known elsewhere.
    """

    proves = False

    def __init__(self, scored: ScoredFront, share: float, known: Archive, least: float = np.inf) -> None:
        m = len(scored.weights)
        self.scored, self.columns = scored, list(range(m))
        self.fixed_cutoffs = np.full(known.phi.shape[1], np.inf)
        phi = known.phi[:, :m]
        first = scored.best(phi)
        self._share, self._least = share, min(float(scored.scores(phi)[first]), least)
        # A step along each objective takes the same part of the score.
        farther = scored.scale.distances(scored.objectives.values_of(phi[first][None, :])) + share * self._least
        self.tolerance = (scored.objectives.phi_of(scored.scale.at(farther)) - phi[first])[0]

    @property
    def least(self) -> float:
        """The smallest score that is known."""
        return self._least

    @property
    def enough(self) -> float:
        """The score that a design must stay below to come before the first one known."""
        return self._least * (1.0 - self._share)

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to come before the first one."""
        scale, objectives = self.scored.scale, self.scored.objectives
        share = self.scored.weights / self.scored.weights.sum()
        counts = (share > 0) & (scale.has_ratios | (scale.nadir > scale.ideal))
        values = np.nan_to_num(objectives.values_of(lower[:, self.columns]), nan=-np.inf)
        with np.errstate(all="ignore"):
            parts = share * scale.distances(values) ** 2
            slack = self.enough**2 - (parts.sum(axis=1, keepdims=True) - parts)
            ends = objectives.phi_of(scale.at(np.sqrt(slack / share)))
        cutoffs = np.full(lower.shape, np.inf)
        cutoffs[:, self.columns] = np.where(slack <= 0, -np.inf, np.where(counts, ends, np.inf))
        return cutoffs

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible distance of a box below what it must keep."""
        with np.errstate(all="ignore"):
            distance = (self.cutoffs(lower) - lower)[:, self.columns]
        gain: np.ndarray = np.maximum(np.where(np.isnan(distance), np.inf, distance).min(axis=1, initial=np.inf), 0.0)
        return gain

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many come before the first one known."""
        scores = self.scored.scores(phi[:, self.columns])
        nearer = scores < self.enough
        self._least = float(min(self._least, scores.min(initial=np.inf)))
        return int(nearer.sum())

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return nothing: what is best in several objectives at once is not polished in one of them."""
        return []

    def tables(self, form: Formulation) -> CutoffTables | None:
        """Return nothing: the cutoffs of a sum of squares are no steps."""
        return None
