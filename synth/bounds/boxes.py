"""Boxes of a search tree: cells of combinations with ranges of variables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Boxes:
    """A batch of boxes.

    Parameters
    ----------
    cell : array (boxes, factors)
        A cluster of rows per factor.
    low, high : array (boxes, variables)
        Ends of the variables and, where boxes carry them, of the auxiliary variables.
    bounds : array (boxes, objectives)
        Lower bounds, with the sign of the objective: of all objectives, or of the first ones where the others do not
        matter.
    scores : array (boxes, variables + factors)
        How much each variable and factor still blurs limits and objectives: where to split.
    tag : array (boxes,)
        Which of several questions a box belongs to, when they share a batch.
    """

    cell: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounds: np.ndarray
    scores: np.ndarray
    tag: np.ndarray

    def __len__(self) -> int:
        return len(self.cell)

    def take(self, rows: np.ndarray | slice) -> Boxes:
        """Boxes of a mask or of positions; the same arrays where a mask keeps all of them."""
        columns = (self.cell, self.low, self.high, self.bounds, self.scores, self.tag)
        if isinstance(rows, slice):
            return Boxes(*(a[rows] for a in columns))
        if rows.dtype == bool:
            kept = np.flatnonzero(rows)
            if len(kept) == len(rows):
                return self
            rows = kept
        # Four times as fast as indexing: rows are copied whole.
        return Boxes(*(a.take(rows, axis=0) for a in columns))

    @staticmethod
    def joined(batches: Sequence[Boxes]) -> Boxes:
        """Return several batches as one."""
        if len(batches) == 1:
            return batches[0]
        return Boxes(
            np.concatenate([b.cell for b in batches]),
            np.concatenate([b.low for b in batches]),
            np.concatenate([b.high for b in batches]),
            np.concatenate([b.bounds for b in batches]),
            np.concatenate([b.scores for b in batches]),
            np.concatenate([b.tag for b in batches]),
        )


@dataclass(frozen=True)
class Subtrees:
    """What some generations of boxes leave.

    Parameters
    ----------
    halves : Boxes
        To go on with.
    small : Boxes
        Too small to be split.
    looked : int
        How many boxes were tightened.
    """

    halves: Boxes
    small: Boxes
    looked: int
