"""The complete roller coupling with its bosses, and what an engineer demands of its parts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Choice, Declaration, Part, Requirement, Variable
from synth.errors import InputError

from ..components.shaft.model import ShaftRequirements, declare_shaft, shaft_for
from ..practice import UNSOURCED
from ..sources import EXTENDS_S3, S3
from . import formulas

SHAFT_FACTOR = 1.5  # torque for which the shaft is sized over the torque to transmit: shocks of the drive
RIM_PRACTICE = 5.0  # mm
# Bounds of the arm radius and the least of the other sizes [mm]; the refusals reason with them.
ARM_RADIUS_MIN, ARM_RADIUS_MAX = 15.0, 200.0
CONTACT_LENGTH_MIN = 3.0
ROLLERS = "guide_rolling_bearings"


class Sizes(Block):
    """Sizes of arms and float, all in SI, and the offset that they allow."""

    arm_radius = Variable(
        "mm", ARM_RADIUS_MIN, ARM_RADIUS_MAX, grid=0.5, symbol="r", text="Radius of the pins", source=f"{S3}, r"
    )
    guide_half_length = Variable(
        "mm",
        15,
        400,
        grid=0.5,
        symbol="K",
        text="From the centre of the float to the end of a guide",
        source=f"{S3}, K",
    )
    contact_length = Variable(
        "mm",
        CONTACT_LENGTH_MIN,
        30,
        grid=0.5,
        symbol="l",
        text="Length on which a roller bears on the guide",
        source=f"{S3}, l",
    )
    rim = Variable(
        "mm",
        3,
        60,
        grid=0.5,
        symbol="t",
        text="Rim of the float around the corners of the guide ends",
        source=EXTENDS_S3,
    )
    offset_capacity = Variable(
        "mm", 0.1, 80, symbol="e_cap", text="Offset up to which all clearances are kept", source=f"{S3}, eq. (18b)"
    )


@dataclass(frozen=True)
class Unknowns:
    """What the search decides."""

    sizes: Sizes
    balance: Choice
    roller: Part
    material: Part


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
    text = "Float, counter float, rollers with pins, and arms"
    d.derive("part_mass", "kg", part_mass, symbol="m_part", text=text, source="geometry")
    d.derive(
        "backlash",
        "deg",
        formulas.backlash_angle(wants.guide_play, arm_radius),
        symbol="phi_j",
        text="Angle between the shafts that the play of both guides leaves free",
        source="geometry, 2 j/r",
    )


def declare_rules(d: Declaration, rules: CouplingRules, unknowns: Unknowns, float_radius: Any) -> None:
    """Declare the limits that an engineer adds to a coupling, with a float of a radius R_f [m]."""
    roller, sizes, width = unknowns.roller, unknowns.sizes, d.derived["float_width"].sx
    bridges = "The bridges at the guide ends stand the bending over the width of a guide"
    bear, slender = "The rollers bear on enough of their width", rules.float_slenderness_min * 2 * float_radius
    for name, value, least, text in (
        ("rim_practice", sizes.rim, rules.rim_ratio * roller.outer_diameter, bridges),
        ("contact_length_min", sizes.contact_length, rules.contact_share_min * roller.contact_width, bear),
        ("float_slenderness", width, slender, "The float is no sheet"),
    ):
        d.at_least(name, value, least, "mm", text=text, source=UNSOURCED)
    d.at_most(
        "material_cost",
        unknowns.material.optional("relative_cost_per_kg"),
        rules.material_cost_max,
        "-",
        text="The float is of a material that one pays for",
        source=UNSOURCED,
    )
