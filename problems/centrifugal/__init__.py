"""Blocks of declarations that the centrifugal clutches share: duty, lining, springs, speeds, clamp force and size."""

from __future__ import annotations

from .body import Built
from .duty import COMMON, SOURCES, Duty
from .engagement import (
    Contact,
    declare_band,
    declare_clamp,
    declare_contact,
    declare_full_clamp,
    declare_stop_force,
)
from .flyweights import (
    Flyweights,
    Weights,
    advise_gravity,
    declare_rest_radius,
    declare_weights,
    limit_weight_room,
)
from .lining import Lining, advise_release_gap, declare_lining, declare_wear
from .rules import LeverRules, Rules
from .springs import (
    SpringSet,
    advise_springs,
    declare_springs,
    limit_share_of_force,
    limit_spring_force,
    name_spring_lengths,
)

__all__ = [
    "COMMON",
    "SOURCES",
    "Built",
    "Contact",
    "Duty",
    "Flyweights",
    "LeverRules",
    "Lining",
    "Rules",
    "SpringSet",
    "Weights",
    "advise_gravity",
    "advise_release_gap",
    "advise_springs",
    "declare_band",
    "declare_clamp",
    "declare_contact",
    "declare_full_clamp",
    "declare_lining",
    "declare_rest_radius",
    "declare_springs",
    "declare_stop_force",
    "declare_wear",
    "declare_weights",
    "limit_share_of_force",
    "limit_spring_force",
    "limit_weight_room",
    "name_spring_lengths",
]
