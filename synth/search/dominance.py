"""Which known designs cover boxes, for three objectives and more: the same answers as comparing all with all, sooner.

Of points and boxes with lower bounds is asked, per objective, the least value among the points that lie at or below the
box in all other objectives. The points are sorted once; the kernel and arrays read what was made of them alike.
"""

from __future__ import annotations

from itertools import permutations
from typing import Literal, Protocol

import numpy as np

from synth.search.dominance_code import DominanceCode
from synth.search.settings import DominanceSettings

WORD = 64  # bits
SHIFT = 3  # of the shortest block, which is a power of two: the C source takes eight points at a time
PAIRS = ((1, 2), (2, 0), (0, 1))  # of three objectives: the other two of each


class SortedPoints(Protocol):
    """Points of which is asked again and again which of them cover boxes."""

    def least(self, lower: np.ndarray, code: DominanceCode | None = None) -> np.ndarray:
        """Return, per box, the least value of each objective among the points that cover it in all other objectives.

        Parameters
        ----------
        lower : array (boxes, objectives)
            Lower bounds. What is not a number is covered by no point.
        code : DominanceCode, optional
            Arrays are gone through without it; the answer is the same.

        Returns
        -------
        array (boxes, objectives)
            Infinite where no point covers a box.
        """


def sorted_points(points: np.ndarray, settings: DominanceSettings, strict: bool = False) -> SortedPoints:
    """Return points in an order in which it is soon known which of them cover a box.

    Parameters
    ----------
    points : array (points, objectives)
        At least one, of three objectives or more; all numbers, or infinite.
    settings : DominanceSettings
    strict : bool
        Whether a point must lie below a box to cover it: as good is not enough.
    """
    return (CornerTable if points.shape[1] == 3 else CoverSets)(points, settings, strict)


class _Order:
    """Points in the order of each objective.

    Parameters
    ----------
    points, strict
        As for :func:`sorted_points`.

    Attributes
    ----------
    ordered : array (objectives, points)
        Values of each objective in order.
    place : array of int32 (objectives, objectives, points)
        For the points in order of the first objective, their places in the order of the second.
    """

    def __init__(self, points: np.ndarray, strict: bool) -> None:
        m, columns = points.shape[1], np.ascontiguousarray(points.T)
        order = np.argsort(columns, axis=1)
        place = np.empty(order.shape, dtype=np.int32)
        np.put_along_axis(place, order, np.arange(len(points), dtype=np.int32)[None, :], axis=1)
        self._side: Literal["left", "right"] = "left" if strict else "right"
        self.ordered = np.take_along_axis(columns, order, axis=1)
        self.place = np.empty((m, *order.shape), dtype=np.int32)
        for k in range(m):
            np.take(place, order[k], axis=1, out=self.place[k])

    def before(self, lower: np.ndarray) -> np.ndarray:
        """Number of points that cover each box in each objective alone (objectives, boxes): the first in its order."""
        pairs = zip(self.ordered, lower.T, strict=True)
        result = np.stack([np.searchsorted(x, ends, self._side) for x, ends in pairs])
        result[np.isnan(lower.T)] = 0
        return result


class CornerTable:
    """Points of three objectives: a table of what is least below corners, and the order of each objective.

    What covers a box in two objectives stands before some place in the order of both. The orders are cut into blocks;
    what is least among all blocks before two of them is in the table, so that only the points in two blocks are left to
    be looked at, and even they only where the next corner promises something better. For K points and blocks of about
    sqrt(K) a box costs O(log K), in the worst case O(sqrt(K)), and the table O(K log K).

    Parameters
    ----------
    points, settings, strict
        As for :func:`sorted_points`.
    """

    def __init__(self, points: np.ndarray, settings: DominanceSettings, strict: bool = False) -> None:
        count = len(points)
        self._order, self._settings = _Order(points, strict), settings
        shift = max(SHIFT, round(np.log2(settings.block * count**0.5)))
        self._block = block = 1 << shift
        self._blocks = blocks = count // block + 1
        # In the order of each objective, the places in the others and the values; beyond the last point nothing covers.
        self._place = np.full((3, 3, blocks * block), np.iinfo(np.int32).max, dtype=np.int32)
        self._value = np.full((3, 3, blocks * block), np.inf)
        self._place[:, :, :count] = self._order.place
        for a, k in permutations(range(3), 2):
            self._value[a, k, :count] = self._order.ordered[k][self._order.place[a, k]]
        corner = np.full((3, blocks + 1, blocks + 1), np.inf)
        for k, (a, b) in enumerate(PAIRS):
            at = self._order.place[k, a] // block + 1, self._order.place[k, b] // block + 1
            np.minimum.at(corner[k], at, self._order.ordered[k])
        np.minimum.accumulate(corner, axis=1, out=corner)
        self._corner = np.minimum.accumulate(corner, axis=2, out=corner)
        self._numbers = {"points": count, "shift": shift, "blocks": blocks, "strict": int(strict)}

    def least(self, lower: np.ndarray, code: DominanceCode | None = None) -> np.ndarray:
        """Least value of each objective, per box, among the points that cover it in all other objectives."""
        if code is not None:
            arrays = {"place": self._place, "value": self._value, "corner": self._corner}
            return code.from_table(self._numbers, {"ordered": self._order.ordered, **arrays}, lower)
        before = self._order.before(lower)
        result = np.empty(lower.shape)
        for k, (a, b) in enumerate(PAIRS):
            first, second = before[a] // self._block, before[b] // self._block
            least = self._corner[k, first, second]
            begun = np.flatnonzero(self._corner[k, first + 1, second + 1] < least)
            for at in range(0, len(begun), self._settings.boxes):
                rows = begun[at : at + self._settings.boxes]
                for x, y in ((a, b), (b, a)):
                    of_block = self._least_of_block(k, (x, y), before[x, rows], before[y, rows])
                    least[rows] = np.minimum(least[rows], of_block)
            result[:, k] = least
        return result

    def _least_of_block(self, k: int, pair: tuple[int, int], before: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Least values in the block that is begun in the order of the first of a pair of objectives."""
        number, begun = np.divmod(before, self._block)
        place = self._place[pair].reshape(self._blocks, self._block)[number]
        value = self._value[pair[0], k].reshape(self._blocks, self._block)[number]
        covers = (place < other[:, None]) & (np.arange(self._block) < begun[:, None])
        least: np.ndarray = np.where(covers, value, np.inf).min(axis=1)
        return least


class CoverSets:
    """Points of any number of objectives: which of them are among the first in an objective, as bits.

    The points that cover a box in one objective are the first ones in its order. The orders are cut into blocks; for
    each the set of all points up to there is kept, a bit for each point, those that are best in another objective
    first. The first point that the sets of all other objectives have in common is the least, once blocks that are only
    begun are looked at closely. For K points a box costs O(K / 64), and the sets as many words per block.

    Parameters
    ----------
    points, settings, strict
        As for :func:`sorted_points`.
    """

    def __init__(self, points: np.ndarray, settings: DominanceSettings, strict: bool = False) -> None:
        count, m = points.shape
        self._order, self._settings = _Order(points, strict), settings
        self._block = block = -(-count // settings.rows)
        rows, words = -(-count // block) + 1, -(-count // WORD)
        self._inside = np.zeros((m, m, rows, words), dtype=np.uint64)
        word, bit = np.divmod(np.arange(count), WORD)
        one = np.left_shift(np.uint64(1), bit.astype(np.uint64))
        for k, j in permutations(range(m), 2):
            np.bitwise_or.at(self._inside[k, j], (self._order.place[k, j] // block + 1, word), one)
        np.bitwise_or.accumulate(self._inside, axis=2, out=self._inside)
        self._numbers = {"points": count, "objectives": m, "block": block, "rows": rows, "words": words}
        self._numbers["strict"] = int(strict)

    def least(self, lower: np.ndarray, code: DominanceCode | None = None) -> np.ndarray:
        """Least value of each objective, per box, among the points that cover it in all other objectives."""
        if code is not None:
            arrays = {"ordered": self._order.ordered, "place": self._order.place, "inside": self._inside}
            return code.from_sets(self._numbers, arrays, lower)
        result = np.full(lower.shape, np.inf)
        before = self._order.before(lower)
        for first in range(0, len(lower), self._settings.boxes):
            rows = slice(first, first + self._settings.boxes)
            for k in range(lower.shape[1]):
                box, point = self._first(k, before[:, rows])
                result[rows, k][box] = self._order.ordered[k, point]
        return result

    def _first(self, k: int, before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Boxes that are covered in all other objectives, and the first point that does so."""
        others = [j for j in range(len(before)) if j != k]
        rows = -(-before // self._block)
        common = self._inside[k, others[0]][rows[others[0]]]
        for j in others[1:]:
            common &= self._inside[k, j][rows[j]]
        box, covered, points = np.arange(len(common)), [], []
        while len(box):
            word = np.argmax(common != 0, axis=1)
            bits = common[np.arange(len(box)), word]
            nonzero = bits != 0
            box, common, word, bits = box[nonzero], common[nonzero], word[nonzero], bits[nonzero]
            least = bits & (~bits + np.uint64(1))
            point = WORD * word + np.log2(least.astype(float)).astype(np.int64)
            covers = (self._order.place[k, others][:, point] < before[others][:, box]).all(axis=0)
            covered.append(box[covers])
            points.append(point[covers])
            common[np.arange(len(box)), word] ^= least
            box, common = box[~covers], common[~covers]
        return np.concatenate([*covered, box]), np.concatenate([*points, box])
