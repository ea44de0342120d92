"""The complete cone clutch around its cones, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Option, Requirement

from ..components.lining import wear
from ..components.lining.model import Pair
from ..components.shaft.model import ShaftRequirements, declare_shaft, shaft_for
from ..friction.duty import Duty, Size
from ..friction.engagement import SOFT_START_SHARE, Startup, limit_soft_start
from ..mechanics import plates
from ..practice import UNSOURCED
from ..sources import S1
from . import formulas as cone

DERIVED = f"{S1}, cone clutch; formula lost in print, derived"
USUAL_ANGLES = "Shop Practice vol. 2, requirements of clutches: cones of 8 to 18 degrees"
LITTLE_WEDGE = 1.5  # normal force over spring force; a disc with two surfaces has 2 at the same diameter


@dataclass(frozen=True)
class Cone:
    """The friction cone."""

    force: Any
    mean_diameter: Any
    length: Any
    angle: Any
    shell_thickness: Any
    ratio: Any
    area: Any
    largest_diameter: Any


@dataclass(frozen=True)
class Cones:
    """Cones that are declared; ``grip``: peripheral force, just engaged, with the friction counted on [N]."""

    duty: Duty
    shape: Cone
    pair: Pair
    start: Startup
    size: Size
    grip: Any


class ConeBodyRequirements(ShaftRequirements):
    """What a complete cone clutch has around its cones, all in SI."""

    group = "practice"

    spring_deflection = Requirement(
        "mm",
        20,
        lower=1,
        upper=500,
        symbol="f_sp",
        text=f"Deflection of the spring that engages, which with its force tells how heavy it is ({UNSOURCED})",
        source=UNSOURCED,
    )
    spring_energy = Requirement(
        "J/kg",
        140,
        lower=5,
        upper=1000,
        symbol="e_sp",
        text="Energy that a spring stores per mass: a round wire at 600 N/mm2",
        source=f"energy of a wire in torsion; stress: {UNSOURCED}",
    )
    gap_normal = Requirement(
        "mm",
        0.3,
        lower=0.01,
        upper=5,
        symbol="g_n",
        text=f"Release gap across the friction face ({UNSOURCED})",
        source=UNSOURCED,
    )
    wear_depth_limit = Requirement(
        "mm",
        1.0,
        lower=0.01,
        upper=50,
        symbol="d_w_max",
        text="Wear of the lining before it is replaced, where less than its wearable depth (eight car discs: 1.0 mm)",
        source=UNSOURCED,
    )


class ConeRules(Block):
    """Rules for cones, all in SI."""

    group = "practice"

    cone_release = Option(
        ("forced", "self"),
        "forced",
        symbol="rel",
        text="forced: a lever or spring pulls the cones apart, and release pull max limits with what force; self: they "
        "come apart by themselves, with locking margin",
        source=UNSOURCED,
    )
    cone_angle_min = Requirement(
        "deg",
        8,
        lower=1,
        upper=45,
        symbol="alpha_min",
        text="Least half angle; below it cones grab and stick",
        source=USUAL_ANGLES,
    )
    cone_angle_max = Requirement(
        "deg",
        18,
        lower=1,
        upper=60,
        symbol="alpha_max",
        text="Largest half angle; above it little is left of the wedge effect",
        source=USUAL_ANGLES,
    )
    release_pull_max = Requirement(
        "-",
        0.5,
        lower=0,
        upper=5,
        symbol="k_pull",
        text=f"Largest force that pulls the engaged cones apart over the spring force; with cone release forced "
        f"({UNSOURCED})",
        source=UNSOURCED,
    )
    shell_stiffness_ratio = Requirement(
        "-",
        30,
        lower=2,
        upper=500,
        symbol="k_shell",
        text=f"Mean diameter over thickness of a shell at most ({UNSOURCED})",
        source=UNSOURCED,
    )
    hoop_stress_limit = Requirement(
        "N/mm2",
        40,
        lower=1,
        upper=1000,
        symbol="sigma_hoop",
        text=f"Largest stress around a shell under the pressure of seated cones (grey iron; {UNSOURCED})",
        source=UNSOURCED,
    )
    stroke_base = Requirement(
        "mm",
        5,
        lower=0,
        upper=100,
        symbol="s_0",
        text=f"Stroke that any release gear has ({UNSOURCED})",
        source=UNSOURCED,
    )
    stroke_per_diameter = Requirement(
        "-",
        0.05,
        lower=0,
        upper=1,
        symbol="s_1",
        text=f"Further stroke over mean diameter of the cone ({UNSOURCED})",
        source=UNSOURCED,
    )
    pressure_use_min = Requirement(
        "-",
        0.3,
        lower=0,
        upper=1,
        symbol="u_p_min",
        text="Least share of the practical pressure that is used while the cones engage (car discs: 0.6 to 1)",
        source=UNSOURCED,
    )
    wear_life_min = replace(
        wear.LEAST_LIFE, text="Least engagements until the lining is worn; else those in service life"
    )
    soft_start_share = SOFT_START_SHARE

    @property
    def pull_max(self) -> Any:
        """Largest pull over the spring force [-]; None where the cones must come apart by themselves."""
        return self.release_pull_max if self.cone_release == "forced" else None


@dataclass(frozen=True)
class ConeBody:
    """What is around the cones, the way that parts them, and the whole size."""

    wants: ConeBodyRequirements
    stroke: Any
    size: Size
    webs: Any
    bosses: Any
    spring: Any


def declare_body_requirements(d: Declaration, *, required: Any) -> ConeBodyRequirements:
    """Declare the requirements of the complete clutch, whose shaft carries the sizing torque M_req [N m]."""
    wants = d.block(ConeBodyRequirements, shaft_diameter=shaft_for(required))
    declare_shaft(d, wants, diameter=wants.shaft_diameter, torque=required)
    return wants


def declare_cone_rules(d: Declaration) -> ConeRules:
    """Declare the requirements that rules for cones go by, and refuse angles that no cone can have."""
    rules = d.block(ConeRules)
    d.refuse(
        "bad_angles",
        rules.cone_angle_min > rules.cone_angle_max,
        "a cone_angle_min of at most cone_angle_max; otherwise no cone satisfies both",
    )
    return rules


def wear_depth(wants: ConeBodyRequirements, pair: Pair) -> Any:
    """Return the wear of the lining before it is replaced [m]."""
    return wear.depth(pair.part, wants.wear_depth_limit)


def complete_body(cones: Cones, wants: ConeBodyRequirements) -> ConeBody:
    """Parts around the cones: a web and a boss for each, and the spring."""
    shape, size, rho = cones.shape, cones.size, cones.duty.steel_density
    wall = shape.shell_thickness
    across, bore = shape.mean_diameter / 2, wants.shaft_diameter / 2
    webs = plates.annulus_mass(rho, 2, wall, across + bore, across - bore)
    bosses = 2 * wants.boss_mass(rho)
    spring = cone.spring_mass(shape.force, wants.spring_deflection, wants.spring_energy)
    added = webs + bosses + spring
    return ConeBody(
        wants=wants,
        stroke=cone.axial_stroke(wants.gap_normal, wear_depth(wants, cones.pair), shape.angle),
        size=Size(mass=size.mass + added, diameter=size.diameter, length=size.length + 2 * wall),
        webs=webs,
        bosses=bosses,
        spring=spring,
    )


def declare_body(d: Declaration, cones: Cones, body: ConeBody) -> None:
    """Name what a complete clutch adds to its cones: parts of the mass, stroke, wedge effect and wear."""
    shape, pair = cones.shape, cones.pair
    d.derive("part_mass", "kg", cones.size.mass, symbol="m_part", text="Both shells and the lining", source="geometry")
    for name, value, symbol, text in (
        ("web_mass", body.webs, "m_web", "Webs that carry both cones"),
        ("boss_mass", body.bosses, "m_boss", "Both bosses on the shafts"),
        ("spring_mass", body.spring, "m_sp", "Spring that engages the cones"),
    ):
        d.step(name, "kg", value, symbol=symbol, text=text, source="geometry")
    d.derive(
        "pack_length",
        "mm",
        cones.size.length,
        symbol="L_pk",
        text="Length of the cone and what the layout adds to it",
        source="geometry",
    )
    d.derive(
        "stroke",
        "mm",
        body.stroke,
        symbol="s_st",
        text="Way along the axis that opens the gap of a worn lining",
        source="geometry",
    )
    gain = d.derive(
        "wedge_gain",
        "-",
        cones.grip / pair.mu_low / shape.force,
        symbol="k_wedge",
        text="Normal force over spring force; a disc with two surfaces has 2 at the same diameter",
        source="derived, 1/(sin(alpha) + mu cos(alpha))",
    )
    d.advise(
        "little_wedge",
        gain < LITTLE_WEDGE,
        "the wedge effect gains less than 1.5: a disc with two surfaces of the same diameter gains 2",
        source="derived",
    )
    wear.declare_wear_life(
        d,
        pair.part,
        area=shape.area,
        depth=wear_depth(body.wants, pair),
        work=cones.start.friction_work,
        text="Engagements until the lining is worn",
    )


def declare_rules(d: Declaration, cones: Cones, rules: ConeRules, body: ConeBody) -> None:
    """Declare the limits that an engineer adds to cones."""
    shape, pair = cones.shape, cones.pair
    stress = d.derive(
        "hoop_stress",
        "N/mm2",
        cone.hoop_stress(d.derived["seated_pressure"].sx, shape.mean_diameter, shape.shell_thickness),
        symbol="sigma_h",
        text="Stress around a shell under the pressure of seated cones",
        source="thin ring under pressure",
    )
    thickness = shape.mean_diameter / rules.shell_stiffness_ratio
    stroke = rules.stroke_base + rules.stroke_per_diameter * shape.mean_diameter
    inside = shape.mean_diameter - shape.length * np.sin(shape.angle) - 2 * shape.shell_thickness
    burst = "The shells do not burst or buckle"
    hub, pressure = body.wants.hub_diameter, d.derived["surface_pressure"].sx
    least, hub_text = (
        rules.pressure_use_min * pair.linings.pressure(pair.part),
        "The hub of the shaft fits inside the inner cone",
    )
    for limit, name, value, border, unit, text, source in (
        (d.at_least, "cone_angle_min", shape.angle, rules.cone_angle_min, "deg", "The cones do not grab", USUAL_ANGLES),
        (d.at_most, "cone_angle_max", shape.angle, rules.cone_angle_max, "deg", "The cones wedge", USUAL_ANGLES),
        (d.at_least, "shell_stiffness", shape.shell_thickness, thickness, "mm", "The shells stay round", UNSOURCED),
        (d.at_most, "shell_hoop", stress, rules.hoop_stress_limit, "N/mm2", burst, UNSOURCED),
        (d.at_most, "stroke", body.stroke, stroke, "mm", "The release gear has the stroke", UNSOURCED),
        (d.at_least, "hub_room", inside, hub, "mm", hub_text, "geometry"),
        (d.at_least, "pressure_use", pressure, least, "N/mm2", "The lining is used", UNSOURCED),
    ):
        limit(name, value, border, unit, text=text, source=source)
    limit_soft_start(d, cones.duty, cones.start, rules.soft_start_share)
    wear.limit_wear_life(d, pair.part, rules.wear_life_min, text="The lining lasts long enough")
