"""The complete multi-plate clutch around its pack, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from problems.friction.duty import Duty, Size
from problems.friction.engagement import Pair, Startup
from problems.friction.ring import Ring
from problems.mechanics import heat, plates
from problems.mechanics import ring as ring_formulas
from problems.mechanics.wear import wear_life
from problems.multi_plate.pack import Pack, PackSize
from problems.multi_plate.requirements import FLATNESS, BodyRequirements, PackRequirements, PackRules
from problems.practice import UNSOURCED, shaft_for
from problems.sources import DRIVE
from synth.declaration import Declaration

FILM_BREAKS = 8.0  # m/s: beyond this sliding speed an oil film takes in air, and its drag is overestimated
INERTIA_COUNTS = 0.05  # of driven_inertia: what turns with the inner plates is told from here on


@dataclass(frozen=True)
class Body:
    """What is around a pack: thickness of its end plates, way and piston of its actuator, and the whole size."""

    wants: BodyRequirements
    end_thickness: Any
    stroke: Any
    piston_area: Any
    size: Size


def declare_body_requirements(d: Declaration, *, lubrication: str, required: Any) -> BodyRequirements:
    """Declare the requirements of the complete clutch.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lubrication : str
        dry or oil; pistons of packs in oil are pressed by oil, those of dry ones by air.
    required : symbol
        Sizing torque M_req [N m], which the shaft carries.

    Returns
    -------
    BodyRequirements
        Symbols of the block.
    """
    oil = lubrication == "oil"
    return d.block(
        BodyRequirements,
        shaft_diameter=shaft_for(required),
        actuator="hydraulic" if oil else "pneumatic",
        actuator_pressure=1.4 if oil else 0.55,
        wear_depth_limit=0.2 if oil else 1.0,
    )


def declare_pack_rules(d: Declaration, *, lubrication: str) -> PackRules:
    """Declare the requirements that rules for packs go by.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lubrication : str
        dry or oil.

    Returns
    -------
    PackRules
        Symbols of the block.
    """
    oil = lubrication == "oil"
    return d.block(PackRules, friction_surfaces_max=20 if oil else 8, release_gap_min=0.05 if oil else 0.3)


def wear_depth(wants: BodyRequirements, pair: Pair, pack: Pack) -> Any:
    """Return the wear of one lining before it is replaced [m]; plates of a list wear no deeper than they are lined."""
    depth = np.minimum(pair.part.wearable_depth, wants.wear_depth_limit)
    lining = pack.plates.lining_thickness
    return depth if lining is None else np.minimum(depth, lining)


def complete_body(
    *,
    duty: Duty,
    wants: BodyRequirements,
    pack_wants: PackRequirements,
    ring: Ring,
    pair: Pair,
    pack: Pack,
    force: Any,
    pack_size: PackSize,
) -> Body:
    """Return what is around a pack.

    Parameters
    ----------
    duty : Duty
        Block duty.
    wants : BodyRequirements
        Requirements of the complete clutch.
    pack_wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : Pack
        The plates.
    force : symbol
        Actuation force F0 [N].
    pack_size : PackSize
        Mass and size of the pack alone.

    Returns
    -------
    Body
        Its mass adds end plates, drum, hub, web, bosses and piston to plates and linings.
    """
    rho, wall, shaft = duty.steel_density, pack_wants.drum_wall, wants.shaft_diameter / 2
    a, b = pack.inner_spline_radius, pack.outer_spline_radius
    end = 2 * ring.outer_radius / wants.end_plate_ratio
    along = pack_size.length + 2 * (end - pack.inner_thickness)
    way = plates.stroke(pack.surfaces, pack.gap, wear_depth(wants, pair, pack))
    piston = force / wants.actuator_pressure
    actuator = 0.0 if wants.actuator == "external" else way + end
    length = along + end + actuator
    thicker = end - pack.inner_thickness
    mass = (
        pack_size.mass
        + plates.annulus_mass(rho, 2, thicker, pack.plates.inner_mean_diameter, pack.plates.inner_width)  # end plates
        + plates.annulus_mass(rho, 1, length, 2 * b + wall, wall)  # drum
        + plates.annulus_mass(rho, 1, end, b + shaft, b - shaft)  # its bottom
        + plates.annulus_mass(rho, 1, along, 2 * a - wall, wall)  # rim of the hub
        + plates.annulus_mass(rho, 1, end, a - wall + shaft, a - wall - shaft)  # its web
        + 2 * wants.boss_mass(rho)
        + rho * piston * actuator
    )
    return Body(
        wants=wants,
        end_thickness=end,
        stroke=way,
        piston_area=piston,
        size=Size(mass=mass, diameter=plates.drum_diameter(b, wall), length=length),
    )


def declare_body(
    d: Declaration,
    *,
    duty: Duty,
    pack_wants: PackRequirements,
    ring: Ring,
    pair: Pair,
    pack: Pack,
    start: Startup,
    body: Body,
    pack_size: PackSize,
) -> None:
    """Name what a complete clutch adds to its pack: parts of the mass, stroke, wear and inertia.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    pack_wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : Pack
        The plates.
    start : Startup
        What one engagement costs.
    body : Body
        What is around the pack.
    pack_size : PackSize
        Mass and size of the pack alone.
    """
    d.derive(
        "plate_mass",
        "kg",
        pack_size.mass,
        symbol="m_pl",
        text="Plates with linings, as thermal formulas know them",
        source="geometry",
    )
    d.derive(
        "pack_length", "mm", pack_size.length, symbol="L_pk", text="Released pack without end stops", source="geometry"
    )
    d.derive(
        "stroke", "mm", body.stroke, symbol="s_st", text="Way of the actuator with worn linings", source="geometry"
    )
    d.derive(
        "wear_life",
        "-",
        wear_life(
            pack.aid.area_factor * pack.surfaces * ring.area,
            wear_depth(body.wants, pair, pack),
            pair.part.wear_rate,
            start.friction_work,
        ),
        symbol="N_w",
        text="Engagements until the linings are worn",
        source="wear volume in proportion to friction work (Archard)",
    )
    inner = ring_formulas.inner_plate_count(pack.surfaces) * pack.inner_thickness
    inertia = d.derive(
        "inner_inertia",
        "kg*m2",
        plates.pack_inner_inertia(
            duty.steel_density,
            inner + 2 * (body.end_thickness - pack.inner_thickness),
            pack_size.length + 2 * (body.end_thickness - pack.inner_thickness),
            body.end_thickness,
            ring.outer_radius,
            pack.inner_spline_radius,
            pack_wants.drum_wall,
            body.wants.shaft_diameter / 2,
        ),
        symbol="J_in",
        text="Inertia of inner plates, rim and web of the hub",
        source="geometry",
    )
    d.advise(
        "inner_inertia",
        inertia > INERTIA_COUNTS * duty.driven_inertia,
        "what turns with the inner plates has more than 5 % of driven_inertia: where they are on the driven side, add "
        "inner_inertia to it",
        source=UNSOURCED,
    )


def declare_rules(
    d: Declaration,
    *,
    rules: PackRules,
    duty: Duty,
    pack_wants: PackRequirements,
    ring: Ring,
    pair: Pair,
    pack: Pack,
    start: Startup,
    drag: Any,
    body: Body,
    cooled_area: Any,
) -> None:
    """Declare the limits that an engineer adds to a pack.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : PackRules
        What the limits go by.
    duty : Duty
        Block duty.
    pack_wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : Pack
        The plates.
    start : Startup
        What one engagement costs.
    drag : symbol
        Drag of the released pack [N m].
    body : Body
        What is around the pack.
    cooled_area : symbol
        Surface of the pack that gives off heat [m2].
    """
    across = 2 * ring.outer_radius
    d.at_most(
        "surfaces_practice", pack.surfaces, rules.friction_surfaces_max, "-", text="So many plates are built",
        source="flott.de, disk clutch: up to 20 discs; makers of dry clutches stop at 6 to 8",
    )  # fmt: skip
    d.at_most(
        "core_slenderness",
        across / np.minimum(pack.inner_thickness, pack.outer_thickness),
        rules.core_slenderness_max,
        "-",
        text="The cores are thick enough to stay flat",
        source=f"{UNSOURCED}; {FLATNESS}",
    )
    d.at_most(
        "stroke",
        body.stroke,
        rules.stroke_base + rules.stroke_per_diameter * across,
        "mm",
        text="An actuator has the stroke",
        source=UNSOURCED,
    )
    if duty.plate_gap is not None:
        d.at_least(
            "release_clearance",
            pack.gap,
            rules.release_gap_min,
            "mm",
            text="The plates come free although they are not quite flat",
            source=f"{UNSOURCED}; {FLATNESS}",
        )
    if body.wants.actuator != "external":
        d.at_most(
            "piston_fits",
            body.piston_area,
            rules.piston_fill * np.pi * pack.plates.spline_width * pack.plates.spline_mean_diameter,
            "cm2",
            text="A ring piston of that pressure fits between the splines",
            source=UNSOURCED,
        )
    d.at_least(
        "hub_room",
        2 * (pack.inner_spline_radius - pack_wants.drum_wall),
        body.wants.hub_diameter,
        "mm",
        text="The hub of the shaft fits inside the rim of the plates",
        source=UNSOURCED,
    )
    ratio = d.derive(
        "drag_ratio",
        "-",
        drag / duty.load_torque,
        symbol="r_drag",
        text="Drag of the released clutch over the torque of the load",
        source="definition",
    )
    d.at_most(
        "drag_ratio",
        ratio,
        rules.drag_ratio_max,
        "-",
        text="The released clutch lets go of the load",
        source=f"{UNSOURCED}; influences: de.wikipedia, Schleppmoment",
    )
    power = d.derive(
        "drag_power",
        "W",
        drag * pack_wants.released_speed(duty),
        symbol="P_drag",
        text="Power of the drag of the released clutch",
        source="definition",
    )
    d.advise(
        "film_breaks",
        pack_wants.released_speed(duty) * ring.mean_diameter / 2 > FILM_BREAKS,
        "above 8 m/s an oil film takes in air, and the drag is less than computed: state drag_speed, at which it is to "
        "be judged",
        source=UNSOURCED,
    )
    heating = start.friction_work * duty.engagements_per_hour + power
    d.at_most(
        "mean_temperature",
        heat.mean_temperature_rise(heating, 1.0, duty.heat_transfer, cooled_area),
        pair.part.optional("temp_continuous") - duty.ambient_temperature,
        "K",
        text="The lining stands the mean temperature, drag included",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    if rules.wear_life_min is not None:
        d.at_least(
            "wear_life",
            wear_life(
                pack.aid.area_factor * pack.surfaces * ring.area,
                wear_depth(body.wants, pair, pack),
                pair.part.wear_rate,
                start.friction_work,
            ),
            rules.wear_life_min,
            "-",
            text="The linings last long enough",
            source=DRIVE,
        )
