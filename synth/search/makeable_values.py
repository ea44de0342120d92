"""Makeable values: the grids that some variables keep to, and what they make of points and of ranges."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.order.margins import above, below


class MakeableValues:
    """The makeable values of each variable; a variable without any is continuous.

    Parameters
    ----------
    grids : list of array
        Per variable its values in order; none where it is continuous.
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    """

    def __init__(self, grids: Sequence[np.ndarray], margins: tuple[float, float]) -> None:
        self.grids, self._margins = list(grids), margins
        self.gridded = np.array([len(g) > 0 for g in self.grids], dtype=bool)

    def nearest(self, points: np.ndarray) -> np.ndarray:
        """Return points (points, variables) with gridded variables moved to the nearest makeable value."""
        result = points.copy()
        for k, grid in enumerate(self.grids):
            if len(grid):
                after = np.clip(np.searchsorted(grid, result[:, k]), 1, max(len(grid) - 1, 1))
                before = np.minimum(after - 1, len(grid) - 1)
                after = np.minimum(after, len(grid) - 1)
                nearer = np.abs(grid[after] - result[:, k]) < np.abs(grid[before] - result[:, k])
                result[:, k] = np.where(nearer, grid[after], grid[before])
        return result

    def around(self, point: np.ndarray, most: int, rng: np.random.Generator) -> np.ndarray:
        """Return the makeable points around a point (variables,): each gridded variable next below or next above.

        Parameters
        ----------
        point : array (variables,)
        most : int
            Points; where there are more around, so many of them at random.
        rng : Generator
        """
        sides = []
        for k in np.flatnonzero(self.gridded).tolist():
            after = int(np.searchsorted(self.grids[k], point[k]))
            sides.append(self.grids[k][[max(after - 1, 0), min(after, len(self.grids[k]) - 1)]])
        count = 2 ** len(sides)
        chosen = np.arange(count) if count <= most else rng.choice(count, size=most, replace=False)
        result = np.tile(point, (len(chosen), 1))
        for k, (variable, values) in enumerate(zip(np.flatnonzero(self.gridded).tolist(), sides, strict=True)):
            result[:, variable] = values[(chosen >> k) & 1]
        return np.unique(result, axis=0)

    def snap(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Move ends of ranges (boxes, variables or more) onto the grids, in place.

        Returns
        -------
        array of bool (boxes,)
            Whether each box holds something makeable.
        """
        held = np.ones(len(low), dtype=bool)
        for k, grid in enumerate(self.grids):
            if len(grid):
                first, last = self._positions(k, low[:, k], high[:, k])
                held &= first <= last
                low[:, k] = grid[np.minimum(first, len(grid) - 1)]
                high[:, k] = np.maximum(grid[np.maximum(last, 0)], low[:, k])
        return held

    def middle(self, variable: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Middles at which ranges are halved.

        Parameters
        ----------
        variable : array of int (ranges,)
            Of which each is a range; what is beyond the variables is continuous.
        low, high : array (ranges,)

        Returns
        -------
        tuple of array (ranges,)
            Ends of the lower halves and starts of the upper: one number, by ratio where positive, or neighbours on a
            grid.
        """
        with np.errstate(all="ignore"):
            middle = np.where(low > 0, np.sqrt(low * high), 0.5 * (low + high))
        below, above = middle.copy(), middle.copy()
        for k, grid in enumerate(self.grids):
            rows = np.flatnonzero(variable == k)
            if len(grid) and len(rows):
                first, last = self._positions(k, low[rows], high[rows])
                cut = (first + last) // 2
                below[rows], above[rows] = grid[cut], grid[np.minimum(cut + 1, len(grid) - 1)]
        return below, above

    def _positions(self, k: int, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of the first and last value of a grid within ranges, but for the margins."""
        first = np.searchsorted(self.grids[k], below(low, *self._margins))
        last = np.searchsorted(self.grids[k], above(high, *self._margins), side="right") - 1
        return first, last
