"""Blocks of declarations that the two wrap spring clutches share: duty, wire, hub, friction and size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Option, Part, Requirement
from synth.errors import InputError
from synth.text.numbers import typed_number

from ..sources import ARCHARD, DRIVE, NOT_IN_S2, S2, SHAFT, TYPICAL
from . import formulas
from .models import MODELS, Refined

SOURCES = (
    "S2: M. Kozma, G. Molnar, K. Varadi, R. Oroszvary, Preloaded force-locking clutch with a helical spring "
    "(wrap spring clutch, in Hungarian)",
    "A. M. Wahl, Mechanical Springs",
    "Goodman, fatigue under a mean stress",
    "ISO 3, preferred numbers",
    ARCHARD,
    *SHAFT,
)

# What a sheet for several families may state.
COMMON = (
    "required_torque",
    "slip_safety",
    "peak_torque",
    "spring_speed",
    "bore_diameter",
    "outer_diameter_limit",
    "length_limit",
    "gap_coils",
    "coil_gap",
    "spring_index_min",
    "hub_density",
    "belt_exponent_limit",
)

WIRE_CHOICES = ("catalogue", "custom")
HUB_LADDERS = ("hub_diameters", "R20", "R40")
HUB_TABLE = "hub_diameters"
# Range of the hub diameter and of the coils offered to the search; refusals reason with their upper ends.
HUB_DIAMETER_RANGE = (6.0, 200.0)
COILS_RANGE = (2, 12)


# -- options and duty ------------------------------------------------------------------------------


class Options(Block):
    """Options that both fits have."""

    group = "model"

    model = Option(
        tuple(MODELS),
        "refined",
        symbol="mdl",
        text="refined: hub and mean coil radius apart, exact curvature, centrifugal force; seed: as in the source, "
        "which counts all torques at rest",
        source=f"{S2}; refined: derived",
    )
    wire_choice = Option(
        WIRE_CHOICES,
        "catalogue",
        symbol="wc",
        text="catalogue: wire of table spring_wire_flat; custom: thickness and width are variables, the material "
        "is given by wire modulus, wire density and so on",
        source="supply of the wire",
    )
    hub_ladder = Option(
        HUB_LADDERS,
        "hub_diameters",
        symbol="lad",
        text="Makeable hub diameters: of table hub_diameters, or a series of preferred numbers",
        source="table hub_diameters; ISO 3",
    )


class Duty(Block):
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    group = "duty"

    required_torque = Requirement(
        "N*m", lower=0.01, upper=1e5, symbol="T_req", text="Torque to hold without slip", source=DRIVE
    )
    slip_safety = Requirement(
        "-",
        1.3,
        lower=1,
        upper=4,
        symbol="S_T",
        text="Safety of the least closing torque over required torque",
        source=f"{TYPICAL} of the reference model",
    )
    peak_torque = Requirement(
        "N*m",
        lambda duty: 2.5 * duty.required_torque,
        lower=0.01,
        upper=1e12,
        symbol="T_peak",
        text="Highest torque that the drive can apply; by default 2.5 required torque",
        source=DRIVE,
    )
    spring_speed = Requirement(
        "1/min", 0, lower=0, upper=60000, symbol="omega_s", text="Speed of the spring when driving", source=DRIVE
    )
    interference_tolerance = Requirement(
        "mm",
        0.03,
        lower=0.001,
        upper=1,
        symbol="tol",
        text="Tolerance of the fit, +- of wire, bore and hub together",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    bore_diameter = Requirement(
        "mm", lower=1, upper=500, symbol="d_bore", text="Shaft bore of the hubs", source=DRIVE, group="envelope"
    )
    outer_diameter_limit = Requirement(
        "mm",
        lower=3,
        upper=1000,
        optional=True,
        symbol="D_max",
        text="Largest outside diameter",
        source=DRIVE,
        group="envelope",
    )
    length_limit = Requirement(
        "mm",
        lower=2,
        upper=2000,
        optional=True,
        symbol="L_max",
        text="Largest length of the spring",
        source=DRIVE,
        group="envelope",
    )
    gap_coils = Requirement(
        "-",
        0.5,
        lower=0,
        upper=4,
        symbol="n_gap",
        text="Coils over the gap between the hubs",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    coil_gap = Requirement(
        "mm",
        0.2,
        lower=0,
        upper=5,
        symbol="g_c",
        text="Axial gap between coils",
        source=f"{TYPICAL} of the reference model",
        group="model",
    )
    spring_index_min = Requirement(
        "-",
        6,
        lower=2,
        upper=30,
        symbol="index_min",
        text="Least mean coil diameter over wire thickness",
        source="coiling practice",
        group="practice",
    )
    hub_density = Requirement(
        "kg/m3",
        7850,
        lower=0,
        upper=20000,
        symbol="rho_hub",
        text="Density of the hubs; 0 counts the spring only",
        source="material constant",
        group="material",
    )
    belt_exponent_limit = Requirement(
        "-",
        lower=1,
        upper=50,
        optional=True,
        symbol="beta_max",
        text="Largest belt exponent at the highest friction; beyond about 6 any peak is locked and the preload "
        "means little",
        source=NOT_IN_S2,
        group="model",
    )


class PracticeDuty(Duty):
    """A duty of clutches that can slip, by the rules of practice."""

    belt_exponent_limit = replace(
        Duty.belt_exponent_limit,
        default=6,
        optional=False,
        text="Largest belt exponent at the highest friction; beyond about 6 any peak is locked and the preload means "
        "little: a freewheel may have more",
    )


def declare_duty(d: Declaration, *, kind: type[Duty], bore: Callable[[Duty], Any] | None = None) -> Duty:
    """Declare the requirements that both fits have, and the refusals that concern them alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    kind : subclass of Duty
        Block of the family, which says what interference_tolerance means in it.
    bore : callable, optional
        Default of bore_diameter [m], from the block; without it the bore must be given.

    Returns
    -------
    Duty
        Symbols of the block.
    """
    duty = d.block(kind, bore_diameter=bore)
    d.refuse(
        "peak_below_required",
        duty.peak_torque < duty.required_torque,
        "a peak_torque of at least required_torque; the drive must be able to apply what the clutch has to hold",
    )
    largest_hub = HUB_DIAMETER_RANGE[1]
    d.refuse(
        "hub_thinner_than_bore",
        duty.bore_diameter >= largest_hub / 1000,
        f"a bore_diameter below {typed_number(largest_hub)} mm, the largest hub there is; "
        "a hub is not thinner than its bore",
    )
    if duty.outer_diameter_limit is not None:
        d.refuse(
            "no_room_for_hub",
            duty.outer_diameter_limit <= duty.bore_diameter,
            "an outer_diameter_limit above bore_diameter; hub and wire go between them",
        )
    return duty


# -- wire ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Wire:
    """Wire of the spring, all in SI."""

    thickness: Any
    width: Any
    modulus: Any
    density: Any
    bending_allow: Any
    tensile_strength: Any
    endurance_amplitude: Any
    row: Part | None = None


def declare_wire(d: Declaration, *, options: Options) -> Wire:
    """Declare the wire: a slot, or two variables and requirements for its material.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : Options
        Options of the family.

    Returns
    -------
    Wire
        Symbols of the block.
    """
    catalogue = options.wire_choice == "catalogue"

    def material(name: str, unit: str, lower: float, upper: float, symbol: str, text: str) -> Any:
        return d.requirement(
            name,
            unit,
            lower=lower,
            upper=upper,
            optional=catalogue,
            symbol=symbol,
            text=f"{text}; for wire choice custom, where it must be given",
            source="data sheet of the wire",
            group="material",
        )

    given = {
        "modulus": material("wire_modulus", "N/mm2", 1e3, 1e6, "E_u", "Young's modulus of the wire"),
        "density": material("wire_density", "kg/m3", 500, 20000, "rho_u", "Density of the wire"),
        "bending_allow": material("wire_bending_allow", "N/mm2", 1, 1e4, "sigma_u", "Allowed static bending stress"),
        "tensile_strength": material("wire_tensile_strength", "N/mm2", 1, 1e4, "R_u", "Least tensile strength"),
        "endurance_amplitude": material(
            "wire_endurance_amplitude", "N/mm2", 1, 1e4, "S_u", "Endurance amplitude in bending"
        ),
    }
    if not catalogue:
        thickness = d.variable(
            "wire_thickness", "mm", 0.3, 15, grid=0.1, symbol="a", text="Radial wire thickness", source=f"{S2}, a"
        )
        width = d.variable(
            "wire_width", "mm", 0.3, 30, grid=0.1, symbol="b", text="Axial wire width", source=f"{S2}, b"
        )
        return Wire(thickness, width, **given)
    if any(value is not None for value in given.values()):
        d.advise(
            "wire_material_unused",
            True,
            "the wire comes from the catalogue: wire modulus and the other figures of a wire of one's own are not "
            "used; they belong to wire choice custom",
        )
    part = d.part(
        "wire",
        "spring_wire_flat",
        symbol="wire",
        text="Square or rectangular wire of the spring",
        source="table spring_wire_flat",
    )
    return Wire(
        thickness=part.radial_thickness_a,
        width=part.axial_width_b,
        modulus=part.E,
        density=part.density,
        bending_allow=part.bending_allow_static,
        tensile_strength=part.Rm_min,
        endurance_amplitude=part.endurance_amplitude,
        row=part,
    )


# -- hub and coils ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Coils:
    """Hub and coils as they are when fitted, by a model."""

    model: Refined
    hub_diameter: Any
    hub_radius: Any
    mean_radius: Any
    radius_ratio: Any
    per_hub: Any


def hub_grid(d: Declaration, *, ladder: str) -> Any:
    """Return the makeable hub diameters: a series, or the values of table hub_diameters in mm.

    Raises
    ------
    InputError
        When a table of the user's own has no diameter in the range of the variable.
    """
    if ladder != "hub_diameters":
        return ladder
    low, high = HUB_DIAMETER_RANGE
    diameters = 1000 * d.numbers(HUB_TABLE, "diameter")
    # Rounding to a nanometre undoes what the conversion to metres adds.
    inside = sorted({round(float(x), 6) for x in diameters if low <= x <= high})
    if not inside:
        raise InputError(
            f"table {HUB_TABLE}, column diameter",
            None,
            f"a diameter from {typed_number(low)} to {typed_number(high)} mm",
        )
    return inside


def declare_coils(d: Declaration, *, options: Options, duty: Duty, wire: Wire) -> Coils:
    """Declare hub diameter, coils and mean radius, and the remarks on their shape.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : Options
        Options of the family.
    duty : Duty
        Requirements.
    wire : Wire
        Wire of the spring.

    Returns
    -------
    Coils
        Symbols of the block.
    """
    diameter = d.variable(
        "hub_diameter",
        "mm",
        *HUB_DIAMETER_RANGE,
        grid=hub_grid(d, ladder=options.hub_ladder),
        symbol="d_h",
        text="Outer diameter of both hubs",
        source=f"{S2}, 2 r",
    )
    per_hub = d.count(
        "coils_per_hub",
        *COILS_RANGE,
        step=0.5,
        symbol="n",
        text="Coils on one hub",
        source=f"{S2}, n",
    )
    model = MODELS[options.model]
    mean = d.derive(
        "mean_coil_radius",
        "mm",
        model.mean_radius(diameter, wire.thickness),
        symbol="r_m",
        text="Mean radius of the fitted coils; model seed: the hub radius",
        source=f"{S2}, r",
    )
    d.at_least(
        "spring_index",
        2 * mean / wire.thickness,
        duty.spring_index_min,
        "-",
        text="The wire can be coiled",
        source="coiling practice",
    )
    d.advise(
        "unwound_shape",
        np.logical_or(wire.thickness > 4 * wire.width, wire.width > 6 * wire.thickness),
        "wire thicker than 4 times its width, or wider than 6 times its thickness, is hard to coil flat",
        source="coiling practice",
    )
    d.advise(
        "keystoning",
        formulas.keystone_growth(0.3, wire.width, wire.thickness, mean) > duty.coil_gap,
        "coiling widens the inner edge of the wire by more than coil gap: neighbouring coils would rub on each other",
        source="anticlastic bending",
    )
    return Coils(
        model=model,
        hub_diameter=diameter,
        hub_radius=diameter / 2,
        mean_radius=mean,
        radius_ratio=model.radius_ratio(diameter, wire.thickness),
        per_hub=per_hub,
    )


# -- friction --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Friction:
    """Slot friction_pair, and the belt exponent at both ends of its friction."""

    part: Part
    exponent_low: Any
    exponent_high: Any


def declare_friction(d: Declaration, *, duty: Duty, coils: Coils, lubricated: bool = False) -> Friction:
    """Declare the slot friction_pair and the belt exponent with its limit.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    coils : Coils
        Hub and coils.
    lubricated : bool
        Whether dry pairs are left out, where the table tells.

    Returns
    -------
    Friction
        Symbols of the block.
    """
    conditions = ["'wire on hub' in surfaces"]
    if lubricated and all(d.has_column("friction_materials", c) for c in ("lubrication", "lubrication_note")):
        conditions.append("(lubrication == 'oil' or lubrication_note == 'greased')")
    part = d.part(
        "friction_pair",
        "friction_materials",
        where=tuple(conditions),
        symbol="pair",
        text="Wire and the hub surface it grips",
        source="table friction_materials",
    )
    d.refuse(
        "friction_range_reversed",
        part.mu_min > part.mu_max,
        "a friction pair whose mu_min is at most its mu_max",
    )
    low = formulas.belt_exponent(part.mu_min, coils.per_hub, coils.radius_ratio)
    high = d.derive(
        "belt_exponent",
        "-",
        formulas.belt_exponent(part.mu_max, coils.per_hub, coils.radius_ratio),
        symbol="beta_hi",
        text="Belt exponent of one hub at the highest friction",
        source=f"{S2}, mu alpha in eq. (18)",
    )
    if duty.belt_exponent_limit is not None:
        d.at_most(
            "belt_exponent",
            high,
            duty.belt_exponent_limit,
            "-",
            text="The clutch still slips before everything else breaks",
            source=NOT_IN_S2,
        )
    d.advise(
        "locks_at_any_peak",
        high > 6,
        "at the highest friction the belt exponent is above 6: any peak is locked instead of slipping through; "
        "belt exponent limit 6 keeps the search to clutches that can slip",
        source=NOT_IN_S2,
    )
    d.advise(
        "locked",
        high > formulas.LOCKED_BELT_EXPONENT,
        "at the highest friction the clutch is locked; the belt exponent counts up to 50 only",
        source=NOT_IN_S2,
    )
    text = "Belt exponent of one hub at the least friction"
    d.step("belt_exponent_low", "-", low, symbol="beta_lo", text=text, source=f"{S2}, mu alpha in eq. (18)")
    return Friction(part, low, high)


# -- torque and stress -----------------------------------------------------------------------------


def fitted_moment(wire: Wire, coils: Coils, interference: Any, free_radius: Any) -> Any:
    """Return the bending moment of the fitted wire for one end of the tolerance [N m]."""
    curvature = formulas.curvature_change(interference, coils.mean_radius, free_radius)
    return formulas.bending_moment(wire.modulus, wire.width, wire.thickness, curvature)


def centrifugal_moment(duty: Duty, wire: Wire, coils: Coils) -> Any:
    """Share of its bending moment that the spinning wire carries itself [N m]."""
    section = wire.density, wire.width, wire.thickness
    return coils.model.centrifugal_moment(*section, coils.mean_radius, duty.spring_speed)


def declare_closing(d: Declaration, *, duty: Duty, torque: Any, needs: str | tuple[str, ...] = ()) -> None:
    """Declare the least closing torque and its limit."""
    torque = d.derive(
        "closing_torque",
        "N*m",
        torque,
        symbol="T_c",
        needs=needs,
        text="Least torque at which the closing clutch slips: least friction, loosest fit, at spring speed",
        source=f"{S2}, eq. (18)-(20)",
    )
    d.at_least(
        "closing_torque",
        torque,
        duty.slip_safety * duty.required_torque,
        "N*m",
        text="The clutch holds the required torque",
        source=f"{S2}, eq. (20)",
    )


def declare_load(
    d: Declaration,
    *,
    wire: Wire,
    coils: Coils,
    friction: Friction,
    bending_stress: Any,
    moment: Any,
    load: Any,
    needs: str | tuple[str, ...] = (),
) -> tuple[Any, Any]:
    """Declare moment, stress and pressure of the loaded wire with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wire : Wire
        Wire of the spring.
    coils : Coils
        Hub and coils.
    friction : Friction
        Slot friction_pair, whose allowed pressure applies.
    bending_stress : symbol
        Largest size of the bending stress [Pa].
    moment : symbol
        Largest bending moment of the fitted wire [N m].
    load : symbol
        Torque that the wire sees [N m].
    needs : str or tuple of str
        Guards without which the moment does not exist.

    Returns
    -------
    tuple
        Stress of the wire and peak pressure [Pa].
    """
    d.derive(
        "bending_moment",
        "N*m",
        moment,
        symbol="M_b",
        needs=needs,
        text="Bending moment of the fitted wire, at the tightest fit; below 0 for a clearance",
        source=f"{S2}, eq. (4)",
    )
    stress = d.derive(
        "wire_stress",
        "N/mm2",
        formulas.wire_stress(
            bending_stress, formulas.wire_tension(moment + load, coils.mean_radius), wire.width, wire.thickness
        ),
        symbol="sigma",
        text="Largest stress of the loaded wire",
        source=f"{S2}, eq. (8), with the tension of the loaded coil",
    )
    pressure = d.derive(
        "contact_pressure",
        "N/mm2",
        formulas.contact_pressure(moment + load, wire.width, coils.hub_radius, coils.mean_radius),
        symbol="p_max",
        text="Largest pressure of the wire on the hub, at the gap",
        source=f"{S2}, eq. (22), corrected",
    )
    d.at_most(
        "wire_stress",
        stress,
        wire.bending_allow,
        "N/mm2",
        text="The wire does not yield",
        source=f"{S2}, eq. (8) and (18)",
    )
    d.at_most(
        "contact_pressure",
        pressure,
        friction.part.p_allow,
        "N/mm2",
        text="Wire and hub stand the pressure",
        source=f"{S2}, eq. (22), corrected",
    )
    tension = formulas.wire_tension(moment + load, coils.mean_radius)
    for name, unit, value, symbol, text in (
        ("second_moment", "mm4", formulas.second_moment(wire.width, wire.thickness), "I_w", "Of the wire"),
        ("bending_stress", "N/mm2", bending_stress, "sigma_b", "Largest bending stress of the fitted wire"),
        ("wire_tension", "N", tension, "N_w", "Tension of the loaded wire"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=f"{S2}, eq. (4) and (8)")
    return stress, pressure


# -- size ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Size:
    """Mass and outside of the spring with the hubs under it, or of the clutch, and what they are of."""

    mass: Any
    length: Any
    diameter: Any
    spring_mass: Any
    mass_of: str = "Spring and both hubs under it"
    along: str = "Length of the spring"
    outside: str = "Outside of the coils"


@dataclass(frozen=True)
class Built:
    """Spring and hubs that are declared, with the requirements of their fit; clearance of released coils [m]."""

    duty: Duty
    wants: Any
    wire: Wire
    coils: Coils
    friction: Friction
    spring: Size
    clearance: Any = 0.0


def spring_size(d: Declaration, *, duty: Duty, wire: Wire, coils: Coils, fixed_coils: Any = None) -> Size:
    """Declare the coils and return the size of the spring with the hubs under it.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    wire : Wire
        Wire of the spring.
    coils : Coils
        Hub and coils.
    fixed_coils : symbol, optional
        Coils anchored on the second hub; without it both hubs have coils_per_hub [-].

    Returns
    -------
    Size
        Mass and outside.
    """
    total = d.derive(
        "total_coils",
        "-",
        formulas.total_coils(coils.per_hub, duty.gap_coils, fixed_coils),
        symbol="n_tot",
        text="Coils of the whole spring",
        source="geometry",
    )
    length = formulas.spring_length(total, wire.width, duty.coil_gap)
    spring = formulas.spring_mass(wire.density, wire.width, wire.thickness, coils.mean_radius, total)
    hubs = formulas.hub_mass(duty.hub_density, coils.hub_diameter, duty.bore_diameter, length)
    d.step("spring_mass", "kg", spring, symbol="m_sp", text="Spring", source="geometry")
    d.step("hub_mass", "kg", hubs, symbol="m_hub", text="Both hubs under the spring", source="geometry")
    pitch = wire.width + duty.coil_gap
    for name, value, symbol, text in (
        ("coil_pitch", pitch, "p_c", "From coil to coil"),
        ("grip_length", coils.per_hub * pitch, "L_n", "Length of the coils on one hub"),
        ("gap_length", duty.gap_coils * pitch, "L_gap", "Length of the coils over the gap"),
    ):
        d.step(name, "mm", value, symbol=symbol, text=text, source="geometry")
    if fixed_coils is not None:
        text = "Length of the coils anchored on the second hub"
        d.step("fixed_length", "mm", fixed_coils * pitch, symbol="L_fix", text=text, source="geometry")
    return Size(
        mass=spring + hubs,
        length=length,
        diameter=coils.hub_diameter + 2 * wire.thickness,
        spring_mass=spring,
    )


def declare_size(d: Declaration, *, duty: Duty, size: Size) -> None:
    """Declare length, diameter and mass that count, and the limits of the room there is."""
    d.derive("length", "mm", size.length, symbol="L", text=size.along, source="geometry")
    d.derive("outer_diameter", "mm", size.diameter, symbol="D_o", text=size.outside, source="geometry")
    d.derive("mass", "kg", size.mass, symbol="m", text=size.mass_of, source="geometry")
    if duty.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter",
            size.diameter,
            duty.outer_diameter_limit,
            "mm",
            text="The clutch fits the room across",
            source=DRIVE,
        )
    if duty.length_limit is not None:
        d.at_most("length", size.length, duty.length_limit, "mm", text="The clutch fits the room along", source=DRIVE)
