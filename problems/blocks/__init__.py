"""Blocks of declarations that several clutch families share: duty, engagement, ring, packs.

A block declares its quantities and limits and hands back their symbols. Each family composes the blocks it is made of,
so that one thing has one name, one text and one formula everywhere.
"""

from __future__ import annotations

from problems.blocks.disc import (
    DiscPack,
    DiscRequirements,
    declare_disc_inertia,
    declare_disc_pack,
    declare_disc_temperature,
    declare_worn_torque,
    disc_size,
)
from problems.blocks.duty import (
    Duty,
    Size,
    declare_duty,
    declare_envelope,
    declare_ramp_time,
    declare_size,
    sizing_torque,
    sizing_torque_of,
)
from problems.blocks.engagement import (
    Pair,
    Startup,
    Torques,
    advise_frequent_switching,
    declare_friction_pair,
    declare_startup,
    declare_surface_loads,
    declare_torque,
)
from problems.blocks.multi_plate import (
    Pack,
    PackOptions,
    PackRequirements,
    PackSize,
    PackTorque,
    ReleaseAid,
    declare_drag,
    declare_lubrication,
    declare_pack,
    declare_pack_options,
    declare_pack_remarks,
    declare_pack_requirements,
    declare_pack_temperature,
    declare_pack_torque,
    pack_size,
)
from problems.blocks.ring import RING_OUTER_DIAMETER_MAX, Ring, declare_ring

__all__ = [
    "RING_OUTER_DIAMETER_MAX",
    "DiscPack",
    "DiscRequirements",
    "Duty",
    "Pack",
    "PackOptions",
    "PackRequirements",
    "PackSize",
    "PackTorque",
    "Pair",
    "ReleaseAid",
    "Ring",
    "Size",
    "Startup",
    "Torques",
    "advise_frequent_switching",
    "declare_disc_inertia",
    "declare_disc_pack",
    "declare_disc_temperature",
    "declare_drag",
    "declare_duty",
    "declare_envelope",
    "declare_friction_pair",
    "declare_lubrication",
    "declare_pack",
    "declare_pack_options",
    "declare_pack_remarks",
    "declare_pack_requirements",
    "declare_pack_temperature",
    "declare_pack_torque",
    "declare_ramp_time",
    "declare_ring",
    "declare_size",
    "declare_startup",
    "declare_surface_loads",
    "declare_torque",
    "declare_worn_torque",
    "disc_size",
    "pack_size",
    "sizing_torque",
    "sizing_torque_of",
]
