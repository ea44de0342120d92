"""Two ways of bounding by turns: what one can hardly tell the other often can, and neither goes on alone."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Protocol

from synth.search.settings import SearchEffort


class TurnTree(Protocol):
    """A tree that goes on where it stopped."""

    @property
    def extent(self) -> float:
        """How much of everything its open boxes hold; nothing where all is proven."""

    def go_on(self, boxes: float, most: float) -> int:
        """Look into so many boxes for each question that is open, at most so many in all; return how many it were."""

    def finish(self, effort: SearchEffort) -> bool:
        """Go on, what promises most first; tell whether its time was over."""


class TurnBudget:
    """How long trees go on: by turns for a count of boxes, then one of them against time, what promises most first.

    Parameters
    ----------
    boxes : float
        That may be looked into by turns.
    effort : SearchEffort
        For what they leave open; ``behind`` counts while they have turns.
    """

    def __init__(self, boxes: float, effort: SearchEffort) -> None:
        self.boxes, self.effort = boxes, effort
        self.looked, self.spent = 0, False

    def turn(self, tree: TurnTree, boxes: float) -> int:
        """Let a tree go on; return how many boxes it has looked into."""
        looked = tree.go_on(boxes, self.boxes - self.looked)
        self.looked += looked
        return looked

    def finish(self, tree: TurnTree) -> None:
        """Let a tree go on against time."""
        if self.effort.seconds > 0 and tree.extent:
            begun = time.monotonic()
            self.spent = tree.finish(self.effort)
            self.effort = replace(self.effort, seconds=max(self.effort.seconds - time.monotonic() + begun, 0.0))
        else:
            self.spent = bool(tree.extent) and self.effort.seconds <= 0


def alternate(
    ways: Sequence[Callable[[], TurnTree]], budget: TurnBudget, first: float, between: Callable[[], None]
) -> list[TurnTree]:
    """Let two trees go on by turns, each time with twice the effort; most of it has that which closes faster.

    Boxes that close soon hold most of everything, and what is left is closed ever more slowly: what is open falls about
    as a power of the boxes looked into. The power tells which tree is faster, however unequal their shares were.

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
    looked, stuck = [0] * len(ways), [False] * len(ways)
    initial, extents, paces = [0.0] * len(ways), [0.0] * len(ways), [0.0] * len(ways)
    effort, turn = first, 0
    while True:
        k = turn % len(ways)
        if turn < len(ways):
            trees.append(ways[k]())
            initial[k] = extents[k] = trees[k].extent
            share = 1.0
        else:
            share = 1.0 if paces[k] >= max(paces) else budget.effort.behind
            effort *= 2 if k == 0 else 1
        before = extents[k]
        used = budget.turn(trees[k], share * effort)
        looked[k] += used
        # What is open is too small to be split: a tree that has nothing else to look into will never close. Each look
        # at it still takes a little off.
        extents[k] = trees[k].extent
        stuck[k] = used < share * effort and extents[k] > (1 - budget.effort.closing) * before
        if not extents[k]:
            return [t for t in trees if t is not trees[k]] + [trees[k]]
        paces[k] = math.log(initial[k] / extents[k]) / math.log(looked[k] + 2)
        if budget.looked >= budget.boxes or all(stuck):
            first_tree = trees[paces.index(max(paces[: len(trees)]))]
            budget.finish(first_tree)
            return [t for t in trees if t is not first_tree] + [first_tree]
        if not turn:
            between()
        turn += 1
