"""Blocks of declarations that the friction clutches share: duty, engagement, ring.

A block declares its quantities and limits and hands back their symbols. Each family composes the blocks it is made of,
so that one thing has one name, one text and one formula everywhere.
"""

from __future__ import annotations

from .duty import (
    COMMON,
    Duty,
    DutyOfDiscs,
    DutyOfPack,
    Size,
    declare_duty,
    declare_envelope,
    declare_ramp_time,
    declare_size,
    sizing_torque,
    sizing_torque_of,
)
from .engagement import (
    Pair,
    Startup,
    Torques,
    advise_frequent_switching,
    declare_friction_pair,
    declare_heated_body,
    declare_startup,
    declare_surface_loads,
    declare_torque,
)
from .ring import RING_OUTER_DIAMETER_MAX, Ring, declare_ring

__all__ = [
    "COMMON",
    "RING_OUTER_DIAMETER_MAX",
    "Duty",
    "DutyOfDiscs",
    "DutyOfPack",
    "Pair",
    "Ring",
    "Size",
    "Startup",
    "Torques",
    "advise_frequent_switching",
    "declare_duty",
    "declare_envelope",
    "declare_friction_pair",
    "declare_heated_body",
    "declare_ramp_time",
    "declare_ring",
    "declare_size",
    "declare_startup",
    "declare_surface_loads",
    "declare_torque",
    "sizing_torque",
    "sizing_torque_of",
]
