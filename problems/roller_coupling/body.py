"""The complete roller coupling with its bosses, and what an engineer demands of its parts."""

from __future__ import annotations

from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Part, Requirement
from synth.errors import InputError

from ..practice import UNSOURCED, ShaftRequirements, declare_shaft, shaft_for
from . import formulas

SHAFT_FACTOR = 1.5  # torque for which the shaft is sized over the torque to transmit: shocks of the drive
RIM_PRACTICE = 5.0  # mm
ROLLERS = "guide_rolling_bearings"


class CouplingBodyRequirements(ShaftRequirements):
    """What a complete coupling has beside arms, rollers and float, all in SI."""

    group = "practice"

    guide_play = Requirement(
        "mm",
        0.05,
        lower=0,
        upper=5,
        symbol="j",
        text=f"Play of a roller in its guide, for the backlash ({UNSOURCED})",
        source=UNSOURCED,
    )


class CouplingRules(Block):
    """Rules for roller couplings, all in SI."""

    group = "practice"

    rim_ratio = Requirement(
        "-",
        0.2,
        lower=0,
        upper=2,
        symbol="k_rim",
        text="Least rim of the float over the roller diameter: the bridge behind a guide end is bent over that width, "
        f"not only pulled ({UNSOURCED})",
        source=UNSOURCED,
    )
    contact_share_min = Requirement(
        "-",
        0.5,
        lower=0,
        upper=1,
        symbol="k_l",
        text=f"Least length of contact over contact width of the roller ({UNSOURCED})",
        source=UNSOURCED,
    )
    float_slenderness_min = Requirement(
        "-",
        0.06,
        lower=0,
        upper=1,
        symbol="k_b_f",
        text=f"Least width of the float over its diameter: a sheet buckles and tilts ({UNSOURCED})",
        source=UNSOURCED,
    )
    material_cost_max = Requirement(
        "-",
        5,
        lower=0.1,
        upper=1000,
        symbol="k_cost",
        text=f"Largest relative cost per kg of the float: no titanium, no PEEK ({UNSOURCED})",
        source=UNSOURCED,
    )


def declare_roller_kind(d: Declaration) -> str:
    """Declare which rolling bearings may be rollers; return the word chosen."""
    return d.option(
        "roller_kind",
        ("track", "any"),
        "track",
        symbol="rk",
        text="track: track rollers, whose outer ring is thick and has a load limit; any: ball bearings as well, whose "
        "free outer ring bends",
        source=f"table {ROLLERS}; {UNSOURCED}",
        group="practice",
    )


def track_rollers(d: Declaration, *, contact: str) -> tuple[str, ...]:
    """Return the condition on rows that are track rollers; none where a user's table does not tell.

    Parameters
    ----------
    d : Declaration
        Knows the tables.
    contact : str
        line, crowned or either; the rows must have such a tread.

    Raises
    ------
    InputError
        When no track roller has one.
    """
    if not d.has_column(ROLLERS, "outer_ring_load_limit"):
        return ()
    crowned, limit = d.numbers(ROLLERS, "crowned"), d.numbers(ROLLERS, "outer_ring_load_limit")
    tread = contact == "either" or crowned == (contact == "crowned")
    if not np.any(tread & (limit > 0)):
        raise InputError(
            "no_track_roller",
            f"roller_contact {contact}",
            f"the other roller_contact, or roller_kind any: table {ROLLERS} has no track rollers with such a tread",
        )
    return ("outer_ring_load_limit > 0",)


def declare_body_requirements(d: Declaration, *, torque: Any) -> CouplingBodyRequirements:
    """Declare the requirements of the complete coupling; its shafts carry a multiple of the torque [N m]."""
    wants = d.block(CouplingBodyRequirements, shaft_diameter=shaft_for(SHAFT_FACTOR * torque))
    declare_shaft(d, wants, diameter=wants.shaft_diameter, torque=SHAFT_FACTOR * torque)
    return wants


def declare_body(d: Declaration, *, wants: CouplingBodyRequirements, part_mass: Any, arm_radius: Any) -> None:
    """Name what belongs to a complete coupling: the mass of its parts, and its backlash.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wants : CouplingBodyRequirements
        Requirements of the complete coupling.
    part_mass : symbol
        Float, counter float, rollers with pins, and arms [kg].
    arm_radius : symbol
        Radius of the pins [m].
    """
    d.derive(
        "part_mass",
        "kg",
        part_mass,
        symbol="m_part",
        text="Float, counter float, rollers with pins, and arms",
        source="geometry",
    )
    d.derive(
        "backlash",
        "deg",
        formulas.backlash_angle(wants.guide_play, arm_radius),
        symbol="phi_j",
        text="Angle between the shafts that the play of both guides leaves free",
        source="geometry, 2 j/r",
    )


def declare_rules(
    d: Declaration,
    *,
    rules: CouplingRules,
    roller: Part,
    material: Part,
    contact_length: Any,
    rim: Any,
    float_width: Any,
    float_radius: Any,
) -> None:
    """Declare the limits that an engineer adds to a coupling.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : CouplingRules
        What the limits go by.
    roller, material : Part
        Slots of the rolling bearing and of the float.
    contact_length, rim, float_width, float_radius : symbol
        l, t, b_f, R_f [m].
    """
    d.at_least(
        "rim_practice",
        rim,
        rules.rim_ratio * roller.outer_diameter,
        "mm",
        text="The bridges at the guide ends stand the bending over the width of a guide",
        source=UNSOURCED,
    )
    d.at_least(
        "contact_length_min",
        contact_length,
        rules.contact_share_min * roller.contact_width,
        "mm",
        text="The rollers bear on enough of their width",
        source=UNSOURCED,
    )
    d.at_least(
        "float_slenderness",
        float_width,
        rules.float_slenderness_min * 2 * float_radius,
        "mm",
        text="The float is no sheet",
        source=UNSOURCED,
    )
    d.at_most(
        "material_cost",
        material.optional("relative_cost_per_kg"),
        rules.material_cost_max,
        "-",
        text="The float is of a material that one pays for",
        source=UNSOURCED,
    )
