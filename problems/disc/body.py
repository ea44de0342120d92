"""The complete disc clutch around its discs, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Requirement

from .. import wear
from ..friction.duty import Size
from ..mechanics import disc, plates
from ..practice import UNSOURCED, ShaftRequirements, declare_shaft, shaft_for
from ..sources import DRIVE
from .pack import DiscRequirements, Discs

FEW_STARTS = 20_000  # engagements: what lasts less is remarked
RUNOUT = "run-out limit of a disc 0.7 mm (Mazda), 0.6 mm (Porsche 911 SC)"


class DiscBodyRequirements(ShaftRequirements):
    """What a complete disc clutch has around its discs, all in SI."""

    group = "practice"

    wear_depth_limit = Requirement(
        "mm",
        lower=0.01,
        upper=50,
        symbol="d_w_max",
        text="Wear of one lining before it is replaced, where less than its wearable depth (eight car discs: 1.0 mm)",
        source="Porsche 964, drive plate wear: 1.0 to 0.3 mm",
    )


class DiscRules(Block):
    """Rules for discs, all in SI."""

    group = "practice"

    plate_stiffness_ratio = Requirement(
        "-",
        20,
        lower=2,
        upper=500,
        symbol="k_plate",
        text=f"Ring diameter over thickness of a pressure plate at most ({UNSOURCED}; car plates of 10 to 15 mm at 200 "
        "to 240 mm: thinner ones cone)",
        source=UNSOURCED,
    )
    disc_runout = Requirement(
        "mm",
        0.7,
        lower=0,
        upper=10,
        symbol="e_run",
        text="Run-out of a disc, half of which the release gap must exceed",
        source=RUNOUT,
    )
    pressure_use_min = Requirement(
        "-",
        0.2,
        lower=0,
        upper=1,
        symbol="u_p_min",
        text="Least share of the allowed pressure that is used (linings of car discs: 0.35 to 0.5)",
        source=UNSOURCED,
    )
    wear_life_min = wear.LEAST_LIFE
    top_speed = Requirement(
        "1/min",
        lower=0.1,
        upper=100000,
        optional=True,
        symbol="omega_top",
        text="Highest speed of the disc",
        source=DRIVE,
        group="duty",
    )
    rim_speed_limit = Requirement(
        "m/s",
        80,
        lower=5,
        upper=500,
        symbol="v_rim",
        text=f"Highest speed of the rim of a disc ({UNSOURCED}; organic rings)",
        source=UNSOURCED,
    )


@dataclass(frozen=True)
class DiscBody:
    """What is around the discs, and the whole size."""

    wants: DiscBodyRequirements
    size: Size
    hub: Any
    cover: Any
    spring: Any = None


def declare_body_requirements(d: Declaration, *, required: Any, wear_depth_limit: float = 1.0) -> DiscBodyRequirements:
    """Declare the requirements of the complete clutch.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    required : symbol
        Sizing torque M_req [N m], which the shaft carries.
    wear_depth_limit : float
        Default of the requirement [mm].

    Returns
    -------
    DiscBodyRequirements
        Symbols of the block.
    """
    wants = d.block(DiscBodyRequirements, shaft_diameter=shaft_for(required), wear_depth_limit=wear_depth_limit)
    declare_shaft(d, wants, diameter=wants.shaft_diameter, torque=required)
    return wants


def declare_disc_requirements(d: Declaration, *, body: DiscBodyRequirements) -> DiscRequirements:
    """Declare the requirements of discs whose hub follows from the shaft."""
    return d.block(DiscRequirements, disc_hub_radius=body.hub_diameter / 2)


def complete_body(discs: Discs, wants: DiscBodyRequirements) -> DiscBody:
    """Parts around the discs: hub, cover and diaphragm spring; the flywheel stays outside."""
    rho, pack, size, radius = discs.duty.steel_density, discs.pack, discs.size, discs.ring.outer_radius
    hub = disc.hub_mass(rho, pack.discs, pack.wants.disc_hub_radius, wants.shaft_diameter)
    cover = disc.cover_mass(rho, size.diameter, size.length)
    spring = disc.diaphragm_spring_mass(rho, radius)
    length = size.length + disc.cover_thickness(size.diameter) + disc.SPRING_ROOM * 2 * radius
    complete = Size(mass=size.mass + (hub + cover + spring), diameter=size.diameter, length=length)
    return DiscBody(wants, complete, hub, cover, spring)


def body_at_magnet(discs: Discs, wants: DiscBodyRequirements) -> DiscBody:
    """Parts around discs that an armature presses: hub and cover, no diaphragm spring; the size is without magnet."""
    rho, pack, size = discs.duty.steel_density, discs.pack, discs.size
    hub = disc.hub_mass(rho, pack.discs, pack.wants.disc_hub_radius, wants.shaft_diameter)
    cover = disc.cover_mass(rho, size.diameter, size.length)
    length = size.length + disc.cover_thickness(size.diameter)
    complete = Size(mass=size.mass + (hub + cover), diameter=size.diameter, length=length)
    return DiscBody(wants, complete, hub, cover)


def wear_depth(wants: DiscBodyRequirements, discs: Discs) -> Any:
    """Wear of one lining before it is replaced [m]; facings of a list wear no deeper than it says."""
    depth, facing = wear.depth(discs.pair.part, wants.wear_depth_limit), discs.pack.facing
    return depth if facing is None else np.minimum(depth, facing.wearable_depth)


def declare_body(d: Declaration, discs: Discs, body: DiscBody) -> None:
    """Name what a complete clutch adds to its discs: parts of the mass, and wear."""
    pair, size = discs.pair, discs.size
    for name, unit, value, symbol, text in (
        ("part_mass", "kg", size.mass, "m_part", "Pressure plates, linings and cores"),
        ("pack_length", "mm", size.length, "L_pk", "Released discs and pressure plates"),
    ):
        d.derive(name, unit, value, symbol=symbol, text=text, source="geometry")
    least, text = 1000 * disc.COVER_LEAST, "Least thickness of a cover"
    d.constant("cover_thickness_least", "mm", least, symbol="t_cover_min", text=text, source=UNSOURCED)
    thickness = disc.cover_thickness(size.diameter)
    spring = "Diaphragm spring, three quarters of a disc of 0.9 of the outer radius"
    for name, unit, value, symbol, text, source in (
        ("cover_thickness", "mm", thickness, "t_cover", "Thickness of the pressed cover", UNSOURCED),
        ("hub_mass", "kg", body.hub, "m_hub", "Hubs of the discs", "geometry"),
        ("cover_mass", "kg", body.cover, "m_cover", "Face and shell of the cover", "geometry"),
        ("diaphragm_spring_mass", "kg", body.spring, "m_sp", spring, UNSOURCED),
    ):
        if value is not None:
            d.step(name, unit, value, symbol=symbol, text=text, source=source)
    life = wear.declare_wear_life(
        d,
        pair.part,
        area=discs.pack.surfaces * discs.ring.area,
        depth=wear_depth(body.wants, discs),
        work=discs.start.friction_work,
        text="Engagements until the linings are worn",
    )
    if life is not None:
        d.advise(
            "few_starts",
            life < FEW_STARTS,
            "the linings last for less than 20 000 engagements",
            source=UNSOURCED,
        )


def declare_rules(d: Declaration, discs: Discs, rules: DiscRules) -> None:
    """Declare the limits that an engineer adds to discs."""
    ring, pair = discs.ring, discs.pair
    d.at_least(
        "pressure_plate_stiffness",
        discs.pack.plate_thickness,
        2 * ring.outer_radius / rules.plate_stiffness_ratio,
        "mm",
        text="The pressure plate does not cone",
        source=UNSOURCED,
    )
    d.at_least(
        "release_clearance",
        discs.duty.plate_gap,
        rules.disc_runout / 2,
        "mm",
        text="The disc comes free although it runs out",
        source=RUNOUT,
    )
    d.at_least(
        "pressure_use",
        d.derived["surface_pressure"].sx,
        rules.pressure_use_min * pair.part.p_allow,
        "N/mm2",
        text="The lining is used",
        source=UNSOURCED,
    )
    if rules.top_speed is not None:
        d.at_most(
            "rim_speed",
            plates.sliding_speed(rules.top_speed, ring.outer_radius),
            rules.rim_speed_limit,
            "m/s",
            text="The disc does not burst",
            source=UNSOURCED,
        )
    if rules.wear_life_min is not None:
        wear.limit_wear_life(d, pair.part, rules.wear_life_min, text="The linings last long enough", source=DRIVE)
