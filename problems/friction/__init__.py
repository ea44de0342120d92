"""Blocks of declarations that the friction clutches share: duty and engagement.

A block declares its quantities and limits and hands back their symbols. Each family composes the blocks it is made of,
so that one thing has one name, one text and one formula everywhere.
"""

from __future__ import annotations

from .duty import (
    COMMON,
    Duty,
    DutyOfDiscs,
    DutyOfPack,
    DutyOfPlates,
    Size,
    Starting,
    declare_duty,
    declare_envelope,
    declare_ramp_time,
    declare_size,
)
from .engagement import (
    Startup,
    Torques,
    advise_frequent_switching,
    declare_heated_body,
    declare_startup,
    declare_torque,
)

__all__ = [
    "COMMON",
    "Duty",
    "DutyOfDiscs",
    "DutyOfPack",
    "DutyOfPlates",
    "Size",
    "Starting",
    "Startup",
    "Torques",
    "advise_frequent_switching",
    "declare_duty",
    "declare_envelope",
    "declare_heated_body",
    "declare_ramp_time",
    "declare_size",
    "declare_startup",
    "declare_torque",
]
