"""The time a search may take, and how it tells how far it has come."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from synth.bounds.boxes import Boxes
from synth.system import deadline
from synth.system.deadline import Stopped

__all__ = ["Clock", "Stopped"]


@dataclass
class Clock:
    """Remaining time, unresolved boxes, and reports of progress."""

    deadline: float = np.inf
    report: Callable[[int], None] = lambda open_boxes: None
    open: list[Boxes] = field(default_factory=list)

    def open_of(self, remaining: Boxes, under_way: bool) -> Boxes:
        """Unresolved boxes of a tree: those at hand where it was stopped under way, else those it has left."""
        return Boxes.joined(self.open) if under_way and self.open else remaining

    def check(self, boxes: Sequence[Boxes] = ()) -> None:
        """Hold the boxes that are open, tell how many, and raise Stopped when time is over."""
        self.open = list(boxes)
        self.report(sum(len(b) for b in boxes))
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")
        deadline.check()
