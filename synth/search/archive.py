"""Designs known so far: candidates, and those of them that none dominates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from synth.order.pareto import non_dominated
from synth.search.dominance import SortedPoints, sorted_points
from synth.search.dominance_code import dominance_code
from synth.search.settings import TUNING, Tuning


@dataclass(frozen=True)
class Candidate:
    """A feasible design the search has found: its combination, SI variables and objectives as phi."""

    combination: int
    variables: np.ndarray
    phi: np.ndarray


def rows_of(candidates: Sequence[Candidate]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return combinations, variables and phi of some designs as arrays."""
    return (
        np.array([c.combination for c in candidates], dtype=np.int64),
        np.array([c.variables for c in candidates]),
        np.array([c.phi for c in candidates]),
    )


class Archive:
    """The feasible designs found so far that no other one dominates in the traded objectives.

    Parameters
    ----------
    columns : list of int
        The objectives that count for dominance.
    variables, objectives : int
        Width of the stored rows.
    tuning : Tuning
        Tells what counts as equal.
    """

    def __init__(self, columns: Sequence[int], variables: int, objectives: int, tuning: Tuning = TUNING) -> None:
        self.columns = list(columns)
        self.tuning = tuning
        self.combination = np.empty(0, dtype=np.int64)
        self.variables = np.empty((0, variables))
        self.phi = np.empty((0, objectives))
        self._sorted: tuple[np.ndarray, bytes, SortedPoints] | None = None  # phi, tolerance, and what was made of them

    def __len__(self) -> int:
        return len(self.combination)

    def __getitem__(self, k: int) -> Candidate:
        return Candidate(int(self.combination[k]), self.variables[k], self.phi[k])

    def __iter__(self) -> Iterator[Candidate]:
        return (self[k] for k in range(len(self)))

    def add(self, combination: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> None:
        """Take new designs and keep what is not dominated."""
        if not len(combination) or combination is self.combination:
            return
        combination = np.concatenate([self.combination, combination])
        variables = np.concatenate([self.variables, variables])
        phi = np.concatenate([self.phi, phi])
        keep = non_dominated(phi[:, self.columns])
        if not keep[len(self) :].any():
            return
        self.combination, self.variables, self.phi = combination[keep], variables[keep], phi[keep]

    def cutoffs(self, lower: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
        """Return, per box with lower bounds ``lower`` (boxes, columns), what a design must keep to be of use.

        A known design covers what is not better by more than ``tolerance`` in any objective. Cutoff k is the least
        value of objective k, less its tolerance, among the known designs that cover the box in all other objectives.
        """
        m = len(self.columns)
        result = np.full(lower.shape, np.inf)
        known = self.phi[:, self.columns] - tolerance
        if not len(known):
            return result
        if m == 1:
            result[:, 0] = known[:, 0].min()
        elif m == 2:
            for k, (at, least) in enumerate(self.covering(tolerance)):
                place = np.searchsorted(at, lower[:, 1 - k], side="right")
                result[:, k] = np.where(place > 0, least[place - 1], np.inf)
        else:
            result = self._sorted_known(known, tolerance).least(lower, dominance_code())
        return result

    def _sorted_known(self, known: np.ndarray, tolerance: np.ndarray) -> SortedPoints:
        """Return the known designs, less a tolerance, sorted once for all boxes until there are others."""
        kept = self._sorted
        if kept is None or kept[0] is not self.phi or kept[1] != tolerance.tobytes():
            kept = self.phi, tolerance.tobytes(), sorted_points(known, self.tuning.dominance)
            self._sorted = kept
        return kept[2]

    def covering(self, tolerance: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return, for each of two objectives, values of the other in order and the least that is covered from there."""
        known = self.phi[:, self.columns] - tolerance
        orders = [np.argsort(known[:, 1 - k], kind="stable") for k in (0, 1)]
        return [(known[o, 1 - k], np.minimum.accumulate(known[o, k])) for k, o in enumerate(orders)]


def distinct(
    candidates: Sequence[Candidate], m: int, tuning: Tuning, equal: np.ndarray | float = 0.0
) -> list[Candidate]:
    """Return the designs that no other one equals or beats in the first objectives, but for rounding.

    ``equal``: what else in phi counts as equal, per objective.
    """
    phi = np.array([c.phi[:m] for c in candidates]).reshape(len(candidates), m)
    at_once = tuning.arrays.compared
    worse = phi + np.maximum(tuning.tolerances.rounded * np.maximum(np.abs(phi), 1.0), equal)
    gone = np.zeros(len(phi), dtype=bool)
    for first in range(0, len(phi), at_once):
        part = slice(first, first + at_once)
        # Column by column: few rows beat each other, and only those are looked at closely.
        dominated = np.ones((len(phi), len(phi[part])), dtype=bool)
        for k in range(m):
            dominated &= phi[:, None, k] <= worse[None, part, k]
        by, which = np.nonzero(dominated)
        which += first
        beats = np.all(phi[which] <= worse[by], axis=1)
        # Of those that beat each other by rounding alone the first stays.
        gone[which[~beats | (by < which)]] = True
    return [c for c, dropped in zip(candidates, gone, strict=True) if not dropped]
