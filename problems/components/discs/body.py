"""The complete disc clutch around its discs, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from synth.declaration import Block, Declaration, Requirement

from ...duty import cooling, of_drive
from ...friction.duty import Size
from ...friction.engagement import SOFT_START_SHARE, limit_soft_start
from ...mechanics import disc, plates
from ...practice import UNSOURCED
from ..lining import wear
from ..shaft.model import ShaftRequirements, declare_shaft, shaft_for
from .model import DiscRequirements, Discs

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
    discs_max = Requirement(
        "-",
        1,
        lower=1,
        upper=2,
        symbol="n_d_max",
        text=f"Most discs: the plate between two needs a release of its own ({UNSOURCED}; 10 of 12 units compared have "
        "one)",
        source=UNSOURCED,
    )
    pressure_use_min = Requirement(
        "-",
        0.3,
        lower=0,
        upper=1,
        symbol="u_p_min",
        text="Least share of the practical pressure that is used (linings of car discs: 0.6 to 1)",
        source=UNSOURCED,
    )
    wear_life_min = wear.LEAST_LIFE
    soft_start_share = SOFT_START_SHARE
    top_speed = of_drive("1/min", 0.1, 100000, "omega_top", "Highest speed of the disc", group="duty")
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


class DiscHousing:
    """Hubs and cover around discs that an armature presses."""

    # Default [mm]; a magnet does not reach over more wear.
    wear_depth_limit: ClassVar[float] = 0.3

    def __init__(self, d: Declaration, required: Any) -> None:
        """Declare the requirements of the complete clutch, whose shaft carries the sizing torque [N m]."""
        self.wants = d.block(
            DiscBodyRequirements, shaft_diameter=shaft_for(required), wear_depth_limit=self.wear_depth_limit
        )
        declare_shaft(d, self.wants, diameter=self.wants.shaft_diameter, torque=required)

    def declare_disc_requirements(self, d: Declaration) -> DiscRequirements:
        """Declare the requirements of discs whose hub follows from the shaft."""
        return d.block(DiscRequirements, disc_hub_radius=self.wants.hub_diameter / 2)

    def complete(self, discs: Discs) -> DiscBody:
        """Parts around the discs: hub and cover; the size is without magnet."""
        rho, pack, size = discs.duty.steel_density, discs.pack, discs.size
        hub = disc.hub_mass(rho, pack.discs, pack.wants.disc_hub_radius, self.wants.shaft_diameter)
        cover = disc.cover_mass(rho, size.diameter, size.length)
        length = size.length + disc.cover_thickness(size.diameter)
        return DiscBody(
            self.wants, Size(mass=size.mass + (hub + cover), diameter=size.diameter, length=length), hub, cover
        )


class SpringHousing(DiscHousing):
    """Hubs and cover around discs that a diaphragm spring presses."""

    wear_depth_limit = 1.0

    def complete(self, discs: Discs) -> DiscBody:
        """Parts around the discs: hub, cover and diaphragm spring; the flywheel stays outside."""
        bare, radius = super().complete(discs), discs.ring.outer_radius
        spring = disc.diaphragm_spring_mass(discs.duty.steel_density, radius)
        mass = discs.size.mass + (bare.hub + bare.cover + spring)
        length = bare.size.length + disc.SPRING_ROOM * 2 * radius
        return replace(bare, size=replace(bare.size, mass=mass, length=length), spring=spring)


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
        area=discs.area,
        depth=wear_depth(body.wants, discs),
        work=discs.start.friction_work,
        text="Engagements until the linings are worn",
    )
    if life is not None:
        d.advise("few_starts", life < FEW_STARTS, "the linings last for less than 20 000 engagements", source=UNSOURCED)


def declare_rules(d: Declaration, discs: Discs, rules: DiscRules) -> None:
    """Declare the limits that an engineer adds to discs."""
    ring, pair, pack, pressure = discs.ring, discs.pair, discs.pack, d.derived["surface_pressure"].sx
    thickness, least = 2 * ring.outer_radius / rules.plate_stiffness_ratio, rules.pressure_use_min
    used, free = least * pair.linings.pressure(pair.part), "The disc comes free although it runs out"
    stiff, coned = pack.plate_thickness, "The pressure plate does not cone"
    for limit, name, value, border, unit, text, source in (
        (d.at_most, "discs_practice", pack.discs, rules.discs_max, "-", "So many discs are built", UNSOURCED),
        (d.at_least, "pressure_plate_stiffness", stiff, thickness, "mm", coned, UNSOURCED),
        (d.at_least, "release_clearance", discs.duty.plate_gap, rules.disc_runout / 2, "mm", free, RUNOUT),
        (d.at_least, "pressure_use", pressure, used, "N/mm2", "The lining is used", UNSOURCED),
    ):
        limit(name, value, border, unit, text=text, source=source)
    limit_soft_start(d, discs.duty, discs.start, rules.soft_start_share)
    if rules.top_speed is not None:
        d.at_most(
            "rim_speed",
            plates.sliding_speed(rules.top_speed, ring.outer_radius),
            rules.rim_speed_limit,
            "m/s",
            text="The disc does not burst",
            source=UNSOURCED,
        )
    cooling.advise_stronger(d, "mean_temperature")
    wear.limit_wear_life(d, pair.part, rules.wear_life_min, text="The linings last long enough")
