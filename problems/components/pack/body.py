"""The complete multi-plate clutch around its pack, and what an engineer demands of both."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any, ClassVar

import numpy as np

from synth.declaration import Declaration

from ...duty import cooling
from ...friction.duty import Size
from ...friction.engagement import limit_soft_start
from ...mechanics import plates
from ...mechanics import ring as ring_formulas
from ...practice import UNSOURCED
from ..lining import wear
from ..shaft.model import declare_shaft, name_boss, shaft_for
from .model import BuiltPack
from .requirements import FLATNESS, BodyRequirements, OilRules, PackBodyRequirements, PackRules, PistonPackRules

PARTS = {  # symbol and meaning of the masses around a pack
    "end_plate_mass": ("m_end", "What the end plates are thicker than the cores"),
    "drum_shell_mass": ("m_shell", "Shell of the drum"),
    "hub_rim_mass": ("m_rim", "Rim of the hub, which carries the inner plates"),
    "hub_web_mass": ("m_web", "Web of the hub"),
    "boss_mass": ("m_boss", "Both bosses on the shaft"),
    "fins_mass": ("m_fin", "Fins on the shell of the drum"),
    "drum_bottom_mass": ("m_bot", "Bottom of the drum"),
    "piston_mass": ("m_pis", "Piston of the actuator"),
}
FILM_BREAKS = 8.0  # m/s: beyond this sliding speed an oil film takes in air, and its drag is overestimated
INERTIA_COUNTS = 0.05  # of driven_inertia: what turns with the inner plates is told from here on


@dataclass(frozen=True)
class Body:
    """What is around a pack: its end plates that are thicker, way and piston of its actuator, and the whole size.

    ``stroke`` is None where a magnet presses, ``piston_area`` also where something outside does. ``parts`` are the
    masses of what is around the pack, in order, the two bosses as one.
    """

    wants: PackBodyRequirements
    end_plates: int
    end_thickness: Any
    size: Size
    parts: Mapping[str, Any]
    stroke: Any = None
    piston_area: Any = None
    actuator_length: Any = None


class PackHousing:
    """Drum, hub and shaft around a pack that an armature presses, which is one of its end plates."""

    rules: ClassVar[type[PackRules]] = PackRules
    offered: ClassVar[tuple[str, ...]] = ("inner_inertia",)  # further objectives
    # Defaults by lubrication; a magnet does not reach over more wear of dry linings.
    wear_depth_limit: ClassVar[Mapping[str, float]] = {"oil": 0.2, "dry": 0.3}  # mm
    friction_surfaces_max: ClassVar[Mapping[str, int]] = {"oil": 12, "dry": 8}

    def __init__(self, d: Declaration, lubrication: str, required: Any) -> None:
        """Declare the requirements of the complete clutch, whose shaft carries the sizing torque [N m]."""
        self.lubrication = lubrication
        self.wants = self.declare_requirements(
            d, shaft_diameter=shaft_for(required), wear_depth_limit=self.wear_depth_limit[lubrication]
        )
        declare_shaft(d, self.wants, diameter=self.wants.shaft_diameter, torque=required)

    def declare_requirements(self, d: Declaration, **defaults: Any) -> PackBodyRequirements:
        """Declare the block of requirements."""
        return d.block(PackBodyRequirements, **defaults)

    def declare_rules(self, d: Declaration) -> PackRules:
        """Declare the requirements that rules for packs go by."""
        least = 0.05 if self.lubrication == "oil" else 0.3
        most = self.friction_surfaces_max[self.lubrication]
        self.oil = d.block(OilRules) if self.lubrication == "oil" else None
        return d.block(self.rules, friction_surfaces_max=most, release_gap_min=least)

    def complete(self, built: BuiltPack) -> Body:
        """Parts around a pack: their mass adds an end plate, the shell of the drum, hub, web and bosses."""
        size = built.size
        end = 2 * built.ring.outer_radius / self.wants.end_plate_ratio
        along = size.length + (end - built.pack.inner_thickness)
        parts = _masses_around(built, self.wants, end=end, end_plates=1, along=along, drum_length=along)
        complete = Size(mass=size.mass + _together(parts), diameter=size.diameter, length=along)
        return Body(wants=self.wants, end_plates=1, end_thickness=end, size=complete, parts=parts)


class PistonHousing(PackHousing):
    """Drum, hub and shaft around a pack that a ring piston in the drum presses, or something outside."""

    wants: BodyRequirements
    rules = PistonPackRules
    offered = ("stroke", "inner_inertia")
    wear_depth_limit: ClassVar[Mapping[str, float]] = {"oil": 0.2, "dry": 1.0}
    friction_surfaces_max: ClassVar[Mapping[str, int]] = {"oil": 20, "dry": 8}

    def declare_requirements(self, d: Declaration, **defaults: Any) -> BodyRequirements:
        """Declare the block of requirements; pistons of packs in oil are pressed by oil, those of dry ones by air."""
        oil = self.lubrication == "oil"
        return d.block(
            BodyRequirements,
            actuator="hydraulic" if oil else "pneumatic",
            actuator_pressure=1.4 if oil else 0.55,
            **defaults,
        )

    def complete(self, built: BuiltPack) -> Body:
        """Parts around a pack: their mass adds end plates, drum, hub, web, bosses and piston."""
        wants, pack, size, rho = self.wants, built.pack, built.size, built.duty.steel_density
        b, shaft = pack.outer_spline_radius, wants.shaft_diameter / 2
        end = 2 * built.ring.outer_radius / wants.end_plate_ratio
        along = size.length + 2 * (end - pack.inner_thickness)
        way = plates.stroke(pack.surfaces, pack.gap, wear_depth(wants, built))
        piston = built.force / wants.actuator_pressure
        actuator = 0.0 if wants.actuator == "external" else way + end
        length = along + end + actuator
        parts = _masses_around(built, wants, end=end, end_plates=2, along=along, drum_length=length)
        bottom = plates.annulus_mass(rho, 1, end, b + shaft, b - shaft)
        pressing = rho * piston * actuator
        mass = size.mass + _together(parts) + bottom + pressing
        parts["drum_bottom_mass"] = bottom
        if wants.actuator != "external":
            parts["piston_mass"] = pressing
        return Body(
            wants=wants,
            end_plates=2,
            end_thickness=end,
            size=Size(mass=mass, diameter=plates.drum_diameter(b, built.wants.drum_wall), length=length),
            parts=parts,
            stroke=way,
            piston_area=None if wants.actuator == "external" else piston,
            actuator_length=None if wants.actuator == "external" else actuator,
        )


def wear_depth(wants: PackBodyRequirements, built: BuiltPack) -> Any:
    """Wear of one lining before it is replaced [m]; plates of a list wear no deeper than they are lined."""
    depth, lining = wear.depth(built.pair.part, wants.wear_depth_limit), built.pack.plates.lining_thickness
    return depth if lining is None else np.minimum(depth, lining)


def _masses_around(
    built: BuiltPack, wants: PackBodyRequirements, *, end: Any, end_plates: int, along: Any, drum_length: Any
) -> dict[str, Any]:
    """Masses of what every pack has around it [kg]: end plates over cores, drum shell, hub and bosses."""
    pack = built.pack
    rho, wall, shaft = built.duty.steel_density, built.wants.drum_wall, wants.shaft_diameter / 2
    a, b = pack.inner_spline_radius, pack.outer_spline_radius
    thicker = end - pack.inner_thickness
    shell = plates.annulus_mass(rho, 1, drum_length, 2 * b + wall, wall)
    fins = cooling.fin_mass(built.duty.declaration, shell)
    return {
        "end_plate_mass": plates.annulus_mass(
            rho, end_plates, thicker, pack.plates.inner_mean_diameter, pack.plates.inner_width
        ),
        "drum_shell_mass": shell,
        "hub_rim_mass": plates.annulus_mass(rho, 1, along, 2 * a - wall, wall),
        "hub_web_mass": plates.annulus_mass(rho, 1, end, a - wall + shaft, a - wall - shaft),
        "boss_mass": 2 * wants.boss_mass(rho),
        **({} if fins is None else {"fins_mass": fins}),
    }


def _together(parts: Mapping[str, Any]) -> Any:
    return reduce(add, parts.values())


def declare_body(d: Declaration, built: BuiltPack, body: Body) -> None:
    """Name what a complete clutch adds to its pack: parts of the mass, stroke, wear and inertia."""
    duty, ring, pack, pack_size = built.duty, built.ring, built.pack, built.size
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
    for name, mass in body.parts.items():
        symbol, text = PARTS[name]
        d.step(name, "kg", mass, symbol=symbol, text=text, source="geometry")
    if body.stroke is not None:
        d.derive(
            "stroke", "mm", body.stroke, symbol="s_st", text="Way of the actuator with worn linings", source="geometry"
        )
    wear.declare_wear_life(
        d,
        built.pair.part,
        area=pack.aid.area_factor * pack.surfaces * ring.area,
        depth=wear_depth(body.wants, built),
        work=built.start.friction_work,
        text="Engagements until the linings are worn",
    )
    inner = ring_formulas.inner_plate_count(pack.surfaces) * pack.inner_thickness
    thicker = body.end_plates * (body.end_thickness - pack.inner_thickness)
    for name, value, symbol, text in (
        ("end_plate_thickness", body.end_thickness, "t_end", "An end plate, and the web of the hub"),
        ("inner_stack", inner + thicker, "t_stack", "All inner plates on each other, end plates included"),
        ("hub_length", pack_size.length + thicker, "L_hub", "Rim of the hub: the pack with its end plates"),
        ("rim_radius", pack.inner_spline_radius - built.wants.drum_wall, "r_rim", "Inside of the rim of the hub"),
    ):
        d.step(name, "mm", value, symbol=symbol, text=text, source="geometry")
    name_boss(d, body.wants)
    if body.actuator_length is not None:
        d.step(
            "actuator_length",
            "mm",
            body.actuator_length,
            symbol="L_act",
            text="Room of the ring piston along the shaft: its stroke and as much as an end plate",
            source="geometry",
        )
    inertia = d.derive(
        "inner_inertia",
        "kg*m2",
        plates.pack_inner_inertia(
            duty.steel_density,
            inner + thicker,
            pack_size.length + thicker,
            body.end_thickness,
            ring.outer_radius,
            pack.inner_spline_radius,
            built.wants.drum_wall,
            body.wants.shaft_diameter / 2,
        ),
        symbol="J_in",
        text="Inertia of inner plates, rim and web of the hub",
        source="geometry",
    )
    d.advise(
        "inner_inertia",
        inertia > INERTIA_COUNTS * duty.driven_inertia,
        "what turns with the inner plates has more than 5 % of driven inertia: where they are on the driven side, add "
        "inner inertia to it",
        source=UNSOURCED,
    )


def declare_rules(d: Declaration, built: BuiltPack, body: Body, rules: PackRules, oil: OilRules | None) -> None:
    """Declare the limits that an engineer adds to a pack."""
    duty, wants, ring, pair, pack = built.duty, built.wants, built.ring, built.pair, built.pack
    across = 2 * ring.outer_radius
    d.at_most(
        "surfaces_practice", pack.surfaces, rules.friction_surfaces_max, "-", text="So many plates are built",
        source="flott.de, disk clutch: up to 20 discs; makers of dry clutches stop at 6 to 8",
    )  # fmt: skip
    lined, bare, text = rules.core_slenderness_max, rules.plate_slenderness_max, "thick enough to stay flat"
    lining = pair.part.lining_thickness if pack.plates.lining_thickness is None else pack.plates.lining_thickness
    for name, thickness, most, what in (
        ("core_slenderness", pack.outer_thickness, np.where(lining > 0, lined, bare), "cores"),
        ("plate_slenderness", pack.inner_thickness, bare, "steel plates"),
    ):
        source = f"{UNSOURCED}; {FLATNESS}"
        d.at_most(name, across / thickness, most, "-", text=f"The {what} are {text}", source=source)
    rules.limit_stroke(d, stroke=body.stroke, ring=ring)
    if duty.plate_gap is not None:
        d.at_least(
            "release_clearance",
            pack.gap,
            rules.release_gap_min,
            "mm",
            text="The plates come free although they are not quite flat",
            source=f"{UNSOURCED}; {FLATNESS}",
        )
    rules.limit_piston(
        d, area=body.piston_area, width=pack.plates.spline_width, diameter=pack.plates.spline_mean_diameter
    )
    d.at_least(
        "hub_room",
        2 * (pack.inner_spline_radius - wants.drum_wall),
        body.wants.hub_diameter,
        "mm",
        text="The hub of the shaft fits inside the rim of the plates",
        source=UNSOURCED,
    )
    drag = d.derived["drag_torque"].sx
    ratio = d.derive(
        "drag_ratio",
        "-",
        drag / duty.rated_torque,
        symbol="r_drag",
        text="Drag of the released clutch over the torque of the load, over required torque where nothing resists",
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
        drag * wants.released_speed(duty),
        symbol="P_drag",
        text="Power of the drag of the released clutch",
        source="definition",
    )
    text = "Sliding speed above which an oil film takes in air"
    d.constant("film_speed", "m/s", FILM_BREAKS, symbol="v_film", text=text, source=UNSOURCED)
    d.advise(
        "film_breaks",
        wants.released_speed(duty) * ring.mean_diameter / 2 > FILM_BREAKS,
        "above 8 m/s an oil film takes in air, and the drag is less than computed: state drag speed, at which it is to "
        "be judged",
        source=UNSOURCED,
    )
    _limit_mean_temperature(d, built, built.start.friction_work * duty.engagements_per_hour + power, oil)
    limit_soft_start(d, duty, built.start, rules.soft_start_share)
    wear.limit_wear_life(d, pair.part, rules.wear_life_min, text="The linings last long enough")


def _limit_mean_temperature(d: Declaration, built: BuiltPack, heating: Any, oil: OilRules | None) -> None:
    """Declare what lining, plates and oil stand of a mean heating [W]."""
    duty, pair = built.duty, built.pair
    rise = built.mean_rise(heating, 1.0)
    d.at_most(
        "mean_temperature",
        rise,
        pair.linings.mean_temperature(pair.part, pair.part.optional("temp_continuous")) - duty.ambient_temperature,
        "K",
        text="The lining stands the mean temperature, drag included",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    if oil is not None:
        most, text = oil.oil_temperature_limit - duty.ambient_temperature, "The oil in the pack does not age"
        d.at_most("oil_temperature", rise, most, "K", text=text, source=UNSOURCED)
    cooling.advise_stronger(d, "mean_temperature")
