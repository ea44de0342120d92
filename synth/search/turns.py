"""Two ways of bounding by turns: what one can hardly tell the other often can, and neither goes on alone."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from synth.tuning import SearchEffort


class TurnTree(Protocol):
    """A tree that goes on where it stopped."""

    @property
    def extent(self) -> float:
        """How much of everything its open boxes hold; nothing where all is proven."""

    @property
    def open_boxes(self) -> int:
        """How many boxes are open."""

    def go_on(self, boxes: float, most: float) -> int:
        """Look into so many boxes for each question that is open, at most so many in all; return how many it were."""


class TurnBudget:
    """How long trees have turns: a count of boxes that is the same on every machine, then a budget of time.

    Parameters
    ----------
    boxes : float
        That may be looked into before time counts.
    seconds : float
        That may be spent afterwards.
    effort : SearchEffort
        Its ``patience`` and ``spell`` tell how many boxes may be looked into while nothing closes.
    """

    def __init__(self, boxes: float, seconds: float, effort: SearchEffort) -> None:
        self.boxes, self.seconds, self.effort = boxes, seconds, effort
        self.looked, self.idle, self.spent = 0, 0, False

    def turn(self, tree: TurnTree, boxes: float) -> int:
        """Let a tree go on; return how many boxes it has looked into."""
        begun, timed, before = time.monotonic(), self.looked >= self.boxes, tree.extent
        looked = tree.go_on(boxes, np.inf if timed else self.boxes - self.looked)
        self.looked += looked
        if timed:
            self.seconds -= time.monotonic() - begun
        closing = tree.extent <= (1 - self.effort.closing) * before
        self.idle = 0 if closing else self.idle + looked
        return looked

    def over(self) -> bool:
        """Tell whether no tree shall have another turn."""
        if self.idle > self.effort.patience * self.effort.spell:
            return True
        self.spent = self.looked >= self.boxes and self.seconds <= 0
        return self.spent


def by_turns(
    ways: Sequence[Callable[[], TurnTree]], budget: TurnBudget, first: float, between: Callable[[], None]
) -> list[TurnTree]:
    """Let two trees go on by turns, each time with twice the effort; most of it has that which leaves less open.

    Parameters
    ----------
    ways : list of callable
        Each begins a tree; a way that never has its turn is not begun.
    budget : TurnBudget
    first : float
        Boxes of the first turns, for each question that is open.
    between : callable
        Called after the first turn of the first tree, if it has not closed all.

    Returns
    -------
    list of TurnTree
        Those begun, that which went on last at the end; it has closed all that any of them can.
    """
    trees: list[TurnTree] = []
    looked = [0] * len(ways)
    effort, turn = first, 0
    while True:
        k = turn % len(ways)
        if turn < len(ways):
            trees.append(ways[k]())
            share = 1.0
        else:
            left = [t.open_boxes / max(n, 1) for t, n in zip(trees, looked, strict=True)]
            share = 1.0 if left[k] <= min(left) else budget.effort.behind
            effort *= 2 if k == 0 else 1
        looked[k] += budget.turn(trees[k], share * effort)
        if not trees[k].extent or budget.over():
            return [t for t in trees if t is not trees[k]] + [trees[k]]
        if not turn:
            between()
        turn += 1
