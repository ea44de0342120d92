"""What a drive asks of a clutch or coupling, in the words that all families share."""

from __future__ import annotations

from .cooling import COOLING
from .drive import WORDS, Drive, Start, refuse_contradictions, sized_by_load
from .machine import INERT, MOVED, MovedMachine, declare_gravity, of_drive

__all__ = [
    "COOLING",
    "INERT",
    "MOVED",
    "WORDS",
    "Drive",
    "MovedMachine",
    "Start",
    "declare_gravity",
    "of_drive",
    "refuse_contradictions",
    "sized_by_load",
]
