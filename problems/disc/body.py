"""The complete disc clutch around its discs, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Requirement

from .. import wear
from ..friction.duty import Duty, Size
from ..friction.engagement import Pair, Startup
from ..friction.ring import Ring
from ..mechanics import disc, plates
from ..practice import UNSOURCED, ShaftRequirements, declare_shaft, shaft_for
from ..sources import DRIVE
from .pack import DiscPack, DiscRequirements

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


def complete_body(*, duty: Duty, wants: DiscBodyRequirements, ring: Ring, pack: DiscPack, pack_size: Size) -> DiscBody:
    """Parts around the discs: hub, cover and diaphragm spring; the flywheel stays outside.

    Parameters
    ----------
    duty : Duty
        Block duty.
    wants : DiscBodyRequirements
        Requirements of the complete clutch.
    ring : Ring
        Block ring.
    pack : DiscPack
        The discs.
    pack_size : Size
        Mass and room of discs and pressure plates.

    Returns
    -------
    DiscBody
        The whole size.
    """
    rho, shaft = duty.steel_density, wants.shaft_diameter
    hub = disc.hub_mass(rho, pack.discs, pack.wants.disc_hub_radius, shaft)
    cover = disc.cover_mass(rho, pack_size.diameter, pack_size.length)
    spring = disc.diaphragm_spring_mass(rho, ring.outer_radius)
    added = hub + cover + spring
    length = pack_size.length + disc.cover_thickness(pack_size.diameter) + disc.SPRING_ROOM * 2 * ring.outer_radius
    size = Size(mass=pack_size.mass + added, diameter=pack_size.diameter, length=length)
    return DiscBody(wants, size, hub, cover, spring)


def body_at_magnet(*, duty: Duty, wants: DiscBodyRequirements, pack: DiscPack, pack_size: Size) -> DiscBody:
    """Parts around discs that an armature presses: hub and cover, no diaphragm spring.

    Parameters
    ----------
    duty : Duty
        Block duty.
    wants : DiscBodyRequirements
        Requirements of the complete clutch.
    pack : DiscPack
        The discs.
    pack_size : Size
        Mass and room of discs and pressure plates.

    Returns
    -------
    DiscBody
        The whole size, without the magnet.
    """
    rho = duty.steel_density
    hub = disc.hub_mass(rho, pack.discs, pack.wants.disc_hub_radius, wants.shaft_diameter)
    cover = disc.cover_mass(rho, pack_size.diameter, pack_size.length)
    length = pack_size.length + disc.cover_thickness(pack_size.diameter)
    size = Size(mass=pack_size.mass + (hub + cover), diameter=pack_size.diameter, length=length)
    return DiscBody(wants, size, hub, cover)


def wear_depth(wants: DiscBodyRequirements, pair: Pair, pack: DiscPack) -> Any:
    """Return the wear of one lining before it is replaced [m]; facings of a list wear no deeper than it says."""
    depth = wear.depth(pair.part, wants.wear_depth_limit)
    return depth if pack.facing is None else np.minimum(depth, pack.facing.wearable_depth)


def declare_body(
    d: Declaration, *, ring: Ring, pair: Pair, pack: DiscPack, start: Startup, body: DiscBody, pack_size: Size
) -> None:
    """Name what a complete clutch adds to its discs: parts of the mass, and wear.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : DiscPack
        The discs.
    start : Startup
        What one engagement costs.
    body : DiscBody
        What is around the discs.
    pack_size : Size
        Mass and room of discs and pressure plates.
    """
    d.derive(
        "part_mass", "kg", pack_size.mass, symbol="m_part", text="Pressure plates, linings and cores", source="geometry"
    )
    d.derive(
        "pack_length",
        "mm",
        pack_size.length,
        symbol="L_pk",
        text="Released discs and pressure plates",
        source="geometry",
    )
    d.constant(
        "cover_thickness_least",
        "mm",
        1000 * disc.COVER_LEAST,
        symbol="t_cover_min",
        text="Least thickness of a cover",
        source=UNSOURCED,
    )
    d.step(
        "cover_thickness",
        "mm",
        disc.cover_thickness(pack_size.diameter),
        symbol="t_cover",
        text="Thickness of the pressed cover",
        source=UNSOURCED,
    )
    d.step("hub_mass", "kg", body.hub, symbol="m_hub", text="Hubs of the discs", source="geometry")
    d.step("cover_mass", "kg", body.cover, symbol="m_cover", text="Face and shell of the cover", source="geometry")
    if body.spring is not None:
        d.step(
            "diaphragm_spring_mass",
            "kg",
            body.spring,
            symbol="m_sp",
            text="Diaphragm spring, three quarters of a disc of 0.9 of the outer radius",
            source=UNSOURCED,
        )
    life = wear.declare_wear_life(
        d,
        pair.part,
        area=pack.surfaces * ring.area,
        depth=wear_depth(body.wants, pair, pack),
        work=start.friction_work,
        text="Engagements until the linings are worn",
    )
    if life is not None:
        d.advise(
            "few_starts",
            life < FEW_STARTS,
            "the linings last for less than 20 000 engagements",
            source=UNSOURCED,
        )


def declare_rules(d: Declaration, *, rules: DiscRules, duty: Duty, ring: Ring, pair: Pair, pack: DiscPack) -> None:
    """Declare the limits that an engineer adds to discs.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : DiscRules
        What the limits go by.
    duty : Duty
        Block duty.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : DiscPack
        The discs.
    """
    d.at_least(
        "pressure_plate_stiffness",
        pack.plate_thickness,
        2 * ring.outer_radius / rules.plate_stiffness_ratio,
        "mm",
        text="The pressure plate does not cone",
        source=UNSOURCED,
    )
    d.at_least(
        "release_clearance",
        duty.plate_gap,
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
