"""Blocks of declarations that the centrifugal clutches share: duty, lining, springs, speeds, clamp force and size."""

from __future__ import annotations

from .body import Built
from .duty import COMMON, SOURCES, Duty
from .engagement import Contact, declare_band, declare_clamp, declare_contact, declare_full_clamp, declare_stop_force
from .flyweights import Flyweights, Weights, advise_gravity, declare_rest_radius, declare_weights, limit_weight_room
from .lining import Lining, advise_release_gap, declare_lining, declare_wear
from .rules import LeverRules, Rules

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
    "Weights",
    "advise_gravity",
    "advise_release_gap",
    "declare_band",
    "declare_clamp",
    "declare_contact",
    "declare_full_clamp",
    "declare_lining",
    "declare_rest_radius",
    "declare_stop_force",
    "declare_wear",
    "declare_weights",
    "limit_weight_room",
]
