"""Clusters of rows for the proof."""

from __future__ import annotations

import math

import numpy as np

from synth.proof.interval_arithmetic import INF

FAR = 1e3  # in place of a width or a spread without a bound
TINY = 1e-100  # in place of a zero that is divided by


class Clusters:
    """Rows arranged as a tree; node 0 holds all of them.

    Parameters
    ----------
    values : array (rows, columns)
        Not-a-number where a row has no value.
    log : array (columns,)
        Which columns are measured by logarithm.
    scale : array (columns,)
        The unit of distance in the others.
    """

    def __init__(self, values: np.ndarray, log: np.ndarray, scale: np.ndarray) -> None:
        low: list[np.ndarray] = []
        high: list[np.ndarray] = []
        lacking: list[np.ndarray] = []
        spread: list[float] = []
        self._children: list[list[int]] = []
        self._first: list[int] = []
        waiting = [(np.arange(len(values)), -1, 0)]
        while waiting:
            rows, parent, side = waiting.pop()
            number = len(self._children)
            if parent >= 0:
                self._children[parent][side] = number
            subset = values[rows]
            void = np.isnan(subset)
            empty = void.all(axis=0)
            low.append(np.where(empty, 1.0, np.where(void, INF, subset).min(axis=0)))
            high.append(np.where(empty, 1.0, np.where(void, -INF, subset).max(axis=0)))
            lacking.append(void.any(axis=0))
            self._first.append(int(rows[0]))
            self._children.append([-1, -1])
            below, width = self._halves(subset, void, low[-1], high[-1], log, scale)
            spread.append(width)
            if below is not None:
                waiting += [(rows[~below], number, 1), (rows[below], number, 0)]
        self.low, self.high, self.lacking = np.array(low).T, np.array(high).T, np.array(lacking).T
        self.left, self.right = np.array(self._children).T
        self.first, self.spread = np.array(self._first), np.array(spread)

    @staticmethod
    def _halves(
        values: np.ndarray, void: np.ndarray, low: np.ndarray, high: np.ndarray, log: np.ndarray, scale: np.ndarray
    ) -> tuple[np.ndarray | None, float]:
        """Rows that go to the left, and the distance between rows."""
        partly = void.any(axis=0) & ~void.all(axis=0)
        if partly.any():
            return void[:, int(np.argmax(partly))], FAR  # a limit that is void for some rows only bounds none
        with np.errstate(all="ignore"):
            width = np.where(log, np.log(high / low), (high - low) / scale)
        width = np.where(low == high, 0.0, np.where(np.isfinite(width), width, FAR))
        k = int(np.argmax(width))
        if width[k] == 0:
            return None, 0.0
        column = values[:, k]
        finite = column[np.isfinite(column)]
        middle = math.sqrt(low[k] * high[k]) if log[k] else 0.5 * (finite.min() + finite.max())
        below = column <= middle
        return (below if below.any() and not below.all() else column < high[k]), float(width[k])

    def narrowed(self, node: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return the least nodes that hold all rows between the ends (columns, boxes); -1 where there are none."""
        node = node.copy()
        outside = np.any((self.low[:, node] < low) | (self.high[:, node] > high), axis=0)
        at = np.flatnonzero(outside & (self.left[node] >= 0))
        while len(at):
            children = self.left[node[at]], self.right[node[at]]
            first, second = (
                np.all(((self.low[:, c] <= high[:, at]) & (self.high[:, c] >= low[:, at])) | self.lacking[:, c], axis=0)
                for c in children
            )
            one = np.where(first, children[0], np.where(second, children[1], -1))
            node[at] = np.where(first & second, node[at], one)
            at = at[first ^ second]
            at = at[self.left[node[at]] >= 0]
        return node
