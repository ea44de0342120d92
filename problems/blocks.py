"""Blocks of declarations that several clutch families share: duty, ring and multi-plate pack.

A block declares its quantities and limits and hands back their symbols. Each family composes the blocks it is made of,
so that one thing has one name, one text and one formula everywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from problems.mechanics import guide_friction, heat, plates, startup
from problems.mechanics import ring as ring_formulas
from synth.errors import InputError

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

S0 = "S0 (Szoke 1966)"
S1 = "S1 (lecture on friction clutches)"
TYPICAL = "engineering-typical value"
PRACTICE = "common practice"

# Largest friction ring offered to the search [mm]; the refusal torque_above_guide_limit reasons with it.
RING_OUTER_DIAMETER_MAX = 800.0


# -- duty ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Duty:
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    load_torque: Any
    driver_speed: Any
    driven_inertia: Any
    load_kind: str
    friction_basis: str
    cooling: str
    allow_obsolete: str
    safety_factor: Any
    switching_factor: Any
    speed_factor: Any
    switching_rate: Any
    startup_torque: Any
    overload_torque: Any
    actuation_force_limit: Any
    outer_diameter_limit: Any
    length_limit: Any
    slip_time_limit: Any
    jerk_limit: Any
    acceleration_limit: Any
    ambient_temperature: Any
    heat_transfer: Any
    steel_density: Any
    steel_specific_heat: Any
    plate_gap: Any


def declare_duty(d: Declaration, cooling_default: str, lubrication: str | None) -> Duty:
    """Declare the block duty and the refusals that concern it alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    cooling_default : str
        Row of cooling_options used when the user names none.
    lubrication : str or None
        dry or oil where the family is bound to one of them; the cooling must fit.

    Returns
    -------
    Duty
        Symbols of the block.

    Raises
    ------
    InputError
        When the cooling does not go with the lubrication.
    """
    load_kind = d.option(
        "load_kind",
        startup.LOAD_KINDS,
        "reactive",
        symbol="load",
        text="reactive: the load only resists, still until the clutch moves it; active: it acts from the start",
        source=f"{S1}, hoisted weight",
    )
    friction_basis = d.option(
        "friction_basis",
        ("nominal", "worst_case"),
        "nominal",
        symbol="basis",
        text="nominal: mu_dynamic everywhere; worst_case: mu_min where much friction is needed, mu_max where it harms",
        source="scatter band of the friction pair",
    )
    cooling = d.option(
        "cooling",
        d.designations("cooling_options"),
        cooling_default,
        symbol="cool",
        text="How heat leaves the clutch; gives the default of heat_transfer",
        source=f"{S0}, cooling of the plates",
    )
    allow_obsolete = d.option(
        "allow_obsolete",
        ("no", "yes"),
        "no",
        symbol="obs",
        text="yes: also friction pairs that are not allowed in new designs (asbestos), to re-compute old machines",
        source="table friction_materials",
    )
    cooling_row = d.row("cooling_options", cooling)
    if lubrication is not None and _row_text(d, "cooling_options", cooling, "lubrication") not in ("", lubrication):
        fitting = [
            c
            for c in d.designations("cooling_options")
            if _row_text(d, "cooling_options", c, "lubrication") == lubrication
        ]
        raise InputError(
            "lubrication_mismatch",
            f"cooling {cooling}",
            f"a cooling for lubrication {lubrication}: {' or '.join(fitting)}",
        )
    load_torque = d.requirement(
        "load_torque", "N*m", lower=0.1, upper=1e6, symbol="M_load",
        text="Torque of the load during start-up", source=f"{S1}, M2",
    )  # fmt: skip
    driver_speed = d.requirement(
        "driver_speed", "1/min", lower=0.1, upper=60000, symbol="omega1",
        text="Speed of the driving side, constant during start-up", source=f"{S1}, omega1",
    )  # fmt: skip
    driven_inertia = d.requirement(
        "driven_inertia", "kg*m2", lower=1e-6, upper=1e5, symbol="J2",
        text="Driven inertia at the clutch shaft", source=f"{S1}, J2",
    )  # fmt: skip
    duty = Duty(
        load_torque=load_torque,
        driver_speed=driver_speed,
        driven_inertia=driven_inertia,
        load_kind=load_kind,
        friction_basis=friction_basis,
        cooling=cooling,
        allow_obsolete=allow_obsolete,
        safety_factor=d.requirement(
            "safety_factor", "-", 1.5, lower=1, upper=5, symbol="n",
            text="Shock factor of the load", source=f"{S1}, n",
        ),
        switching_factor=d.requirement(
            "switching_factor", "-", 1.0, lower=0.4, upper=1, symbol="c_m",
            text="Engagement-count factor; 1 up to about 50 engagements per hour", source=f"{S1}, c_m",
        ),
        speed_factor=d.requirement(
            "speed_factor", "-", 0.85, lower=0.5, upper=1.5, symbol="c_v",
            text="Sliding-speed factor", source=f"{S1}, c_v",
        ),
        switching_rate=d.requirement(
            "engagements_per_hour", "1/h", 50, lower=0.001, upper=36000, symbol="nu_h",
            text="Switching rate", source=f"{S1}, m_k",
        ),
        startup_torque=d.requirement(
            "startup_torque", "N*m", lower=0.1, upper=1e6, optional=True, symbol="T_start",
            text="Torque to which the actuator is limited during start-up; above load_torque",
            source=f"{S1}, start-up with 1080 N m",
        ),
        overload_torque=d.requirement(
            "overload_torque", "N*m", lower=0.1, upper=1e7, optional=True, symbol="M_max",
            text="The clutch must slip at this torque", source=f"{S1}, clutch as safety element",
        ),
        actuation_force_limit=d.requirement(
            "actuation_force_limit", "N", lower=1, upper=1e6, optional=True, symbol="F_max",
            text="Largest force of the actuator", source="requirement of the drive",
        ),
        outer_diameter_limit=d.requirement(
            "outer_diameter_limit", "mm", lower=5, upper=5000, optional=True, symbol="D_max",
            text="Largest outside diameter", source="requirement of the drive",
        ),
        length_limit=d.requirement(
            "length_limit", "mm", lower=2, upper=5000, optional=True, symbol="L_max",
            text="Largest length, without actuator and end stops", source="requirement of the drive",
        ),
        slip_time_limit=d.requirement(
            "slip_time_limit", "s", 4, lower=0.01, upper=600, symbol="t_slip_max",
            text="Longest slip of one engagement", source=f"{TYPICAL} of the reference model",
        ),
        jerk_limit=d.requirement(
            "jerk_limit", "rad/s3", lower=0.01, upper=1e6, optional=True, symbol="jerk_max",
            text="Largest jerk of the driven side: softness of the start", source="requirement of the drive",
        ),
        acceleration_limit=d.requirement(
            "acceleration_limit", "rad/s2", lower=0.01, upper=1e6, optional=True, symbol="acc_max",
            text="Largest acceleration, at the end of the ramp or of slip", source="requirement of the drive",
        ),
        ambient_temperature=d.requirement(
            "ambient_temperature", "degC", 40, lower=-60, upper=150, symbol="T_amb",
            text="Temperature of the surroundings", source=f"{TYPICAL} of the reference model",
        ),
        heat_transfer=d.requirement(
            "heat_transfer", "W/(m2*K)", cooling_row.heat_transfer, lower=1, upper=5000, symbol="h_conv",
            text=f"Surface coefficient; by default that of the cooling chosen ({TYPICAL})",
            source="table cooling_options",
        ),
        steel_density=d.requirement(
            "steel_density", "kg/m3", 7850, lower=1000, upper=20000, symbol="rho_steel",
            text="Density of the steel plates", source="material constant",
        ),
        steel_specific_heat=d.requirement(
            "steel_specific_heat", "J/(kg*K)", 480, lower=100, upper=2000, symbol="cp_steel",
            text="Specific heat of the steel plates", source="material constant",
        ),
        plate_gap=d.requirement(
            "plate_gap", "mm", 0.3, lower=0.05, upper=3, symbol="gap",
            text=f"Release gap per surface ({TYPICAL})", source=TYPICAL,
        ),
    )  # fmt: skip
    if duty.startup_torque is not None:
        d.refuse(
            "never_starts",
            duty.startup_torque <= duty.load_torque,
            "a startup_torque above load_torque; otherwise the load never starts",
        )
    if duty.load_kind == "active":
        d.advise(
            "runs_backwards",
            True,
            "an active load turns the driven side backwards until the clutch carries it; "
            "a brake or backstop that is released then makes it a reactive load with less heat",
            source=f"{S1}, start-up; friction work of the two kinds of load",
        )
    return duty


def _row_text(d: Declaration, table: str, designation: str, column: str) -> str:
    """Cell of a text column; empty where a user's own table does not have it."""
    found = d.catalogs.table(table)
    return found.text(column)[found.row_index(designation)] if found.has(column) else ""


def declare_ramp_time(d: Declaration) -> Any:
    """Declare the variable ramp_time."""
    return d.variable(
        "ramp_time", "s", 0.01, 10, symbol="t_r",
        text="Ramp of the force: time until the clutch torque is built up; never 0", source=f"{S1}, t_max",
    )  # fmt: skip


def sizing_torque(duty: Duty, surface_factor: Any = 1.0) -> Any:
    """Return M_req = n M_load/(c_m c_v c_z)."""
    return ring_formulas.required_torque(
        duty.load_torque, duty.safety_factor, duty.switching_factor, duty.speed_factor, surface_factor
    )


# -- friction pair ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Pair:
    """Slot friction_pair with the friction to reckon with."""

    part: Part
    mu_low: Any
    mu_high: Any
    hourly_allow: Any


def declare_friction_pair(d: Declaration, family: str, duty: Duty, lubrication: str | None) -> Pair:
    """Declare the slot friction_pair of a family and its remarks.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    family : str
        Name that the column family_hint must contain.
    duty : Duty
        Block duty.
    lubrication : str or None
        dry or oil; None accepts both.

    Returns
    -------
    Pair
        The part, the friction that is counted on (mu_low) and the friction that is feared (mu_high).
    """
    conditions = [f"'{family}' in family_hint"]
    if lubrication is not None:
        conditions.append(f"lubrication == '{lubrication}'")
    if duty.allow_obsolete == "no":
        conditions.append("new_design_allowed == 1")
    part = d.part(
        "friction_pair",
        "friction_materials",
        where=tuple(conditions),
        symbol="pair",
        text="Lining and the surface it rubs on",
        source="table friction_materials",
    )
    worst_case = duty.friction_basis == "worst_case"
    pair = Pair(
        part=part,
        mu_low=part.mu_min if worst_case else part.mu_dynamic,
        mu_high=part.mu_max if worst_case else part.mu_dynamic,
        hourly_allow=part.first_of("q_hourly_allow_forced_oil", "q_hourly_allow")
        if duty.cooling == "through_oil"
        else part.q_hourly_allow,
    )
    # A remark must not make a row unusable, so that columns of remarks only are optional.
    d.advise(
        "stick_slip",
        part.optional("mu_static") < part.mu_dynamic,
        "static friction is below sliding friction: unusual, check the figures and the behaviour at lock-up",
        source=PRACTICE,
    )
    if duty.allow_obsolete == "yes":
        d.advise(
            "obsolete_material",
            part.optional("new_design_allowed") < 0.5,
            "this friction pair is not allowed in new designs; use it only to re-compute an old machine",
            source="table friction_materials",
        )
    return pair


# -- torque and start-up ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Torques:
    """Torques of the start-up: with the friction counted on (low) and the friction feared (high)."""

    required: Any
    ramp_low: Any
    ramp_high: Any


def declare_torque(
    d: Declaration,
    duty: Duty,
    pair: Pair,
    required: Any,
    torque_low: Any,
    torque_high: Any,
    overload: Any = None,
    needs: tuple[str, ...] = (),
) -> Torques:
    """Declare the torques of the clutch and their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    pair : Pair
        Slot friction_pair.
    required : symbol
        Sizing torque M_req [N m].
    torque_low, torque_high : symbol
        Built capacity M_k with the friction counted on and with the friction feared [N m].
    overload : symbol, optional
        Torque that must stay below overload_torque; by default torque_high [N m].
    needs : tuple of str
        Guards without which the torques do not exist.

    Returns
    -------
    Torques
        Sizing torque and the torques at the end of the ramp.
    """
    d.derive(
        "required_torque", "N*m", required, symbol="M_req",
        text="Sizing torque n M_load/(c_m c_v c_z)", source=f"{S1}, sizing",
    )  # fmt: skip
    d.derive(
        "torque", "N*m", torque_low, symbol="M_k", needs=needs,
        text="Built capacity with new lining (worst_case: with mu_min)", source=f"{S0}, eq. (5); {S1}, sizing",
    )  # fmt: skip
    given = duty.startup_torque
    torques = Torques(
        required=required,
        ramp_low=torque_low if given is None else given,
        ramp_high=torque_high if given is None else given,
    )
    d.derive(
        "ramp_torque", "N*m", torques.ramp_low, symbol="T_k",
        text="Torque at the end of the ramp in start-up: torque, or startup_torque when given",
        source=f"{S1}, start-up",
    )  # fmt: skip
    d.at_least(
        "torque_capacity", torque_low, required, "N*m",
        text="The clutch carries the sizing torque", source=f"{S1}, sizing; {S0}, eq. (5)",
    )  # fmt: skip
    if given is not None:
        d.at_least(
            "startup_torque_available", torque_low, given, "N*m",
            text="The clutch can deliver the start-up torque", source=f"{S1}, start-up and sizing linked",
        )  # fmt: skip
    d.at_least(
        "never_starts", torques.ramp_low, duty.load_torque, "N*m", guard=True,
        text="The start-up torque is above the load torque; otherwise the clutch slips for ever",
        source=f"{S1}, start-up",
    )  # fmt: skip
    d.advise(
        "static_hold",
        plates.static_hold(torque_low, pair.part.optional("mu_static"), pair.part.mu_dynamic, duty.load_torque) < 1.2,
        "locked, the clutch holds less than 1.2 times the load torque",
        source=PRACTICE,
    )
    if duty.overload_torque is not None:
        d.at_most(
            "torque_limit", torque_high if overload is None else overload, duty.overload_torque, "N*m",
            text="The clutch slips at the overload torque", source=f"{S1}, clutch as safety element",
        )  # fmt: skip
        d.refuse(
            "capacity_window_empty",
            duty.overload_torque < required,
            "an overload_torque of at least the sizing torque, safety_factor * load_torque over the factors "
            "switching_factor, speed_factor and surface_factor; otherwise no torque satisfies both",
        )
    return torques


@dataclass(frozen=True)
class Startup:
    """What one engagement costs."""

    friction_work: Any
    slip_time: Any
    peak_slip_power: Any


def declare_startup(d: Declaration, duty: Duty, torques: Torques, ramp_time: Any) -> Startup:
    """Declare friction work, slip time, power, jerk and acceleration of the start-up with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    torques : Torques
        Torques at the end of the ramp.
    ramp_time : symbol
        Variable ramp_time [s].

    Returns
    -------
    Startup
        Friction work, slip time and peak slip power.
    """
    low = (torques.ramp_low, duty.load_torque, duty.driven_inertia, duty.driver_speed, ramp_time, duty.load_kind)
    high = (torques.ramp_high, *low[1:])
    work = d.derive(
        "friction_work", "J", startup.friction_work(*low), symbol="W", needs="never_starts",
        text="Friction work per engagement", source=f"{S1}, start-up; closed form",
    )  # fmt: skip
    slip_time = d.derive(
        "slip_time", "s", startup.slip_time(*low), symbol="t_D", needs="never_starts",
        text="Time until lock-up", source=f"{S1}, start-up, t_D; closed form",
    )  # fmt: skip
    power = d.derive(
        "peak_slip_power", "W", startup.peak_slip_power(*high), symbol="P_peak", needs="never_starts",
        text="Greatest friction power (worst_case: with mu_max)", source=f"{S1}, start-up; closed form",
    )  # fmt: skip
    jerk = d.derive(
        "jerk", "rad/s3",
        startup.torque_rate_per_inertia(torques.ramp_high, duty.driven_inertia, ramp_time),
        text="Jerk of the driven side during the ramp (worst_case: with mu_max)", source=f"{S1}, equation of motion",
    )  # fmt: skip
    acceleration = d.derive(
        "acceleration", "rad/s2",
        (startup.lock_torque(*high) - duty.load_torque) / duty.driven_inertia, symbol="acc", needs="never_starts",
        text="Greatest acceleration, at the end of the ramp or of slip (worst_case: with mu_max)",
        source=f"{S1}, alpha_2C",
    )  # fmt: skip
    d.at_most(
        "slip_time", slip_time, duty.slip_time_limit, "s",
        text="Slip ends soon enough", source="requirement of the drive",
    )  # fmt: skip
    d.at_most(
        "cycle_time", slip_time, heat.cycle_time(duty.switching_rate), "s",
        text="Slip ends before the next engagement", source=f"{S1}, repeated switching",
    )  # fmt: skip
    if duty.jerk_limit is not None:
        d.at_most("jerk", jerk, duty.jerk_limit, "rad/s3", text="Soft start", source="requirement of the drive")
    if duty.acceleration_limit is not None:
        d.at_most(
            "acceleration", acceleration, duty.acceleration_limit, "rad/s2",
            text="The driven machine stands the acceleration", source="requirement of the drive",
        )  # fmt: skip
    return Startup(work, slip_time, power)


def declare_surface_loads(
    d: Declaration,
    duty: Duty,
    pair: Pair,
    start: Startup,
    area: Any,
    rubbing_area: Any,
    pressure: Any,
    rubbing_radius: Any,
) -> None:
    """Declare pressure, heat, power and sliding speed of the friction surfaces with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    pair : Pair
        Slot friction_pair, whose limits apply.
    start : Startup
        What one engagement costs.
    area, rubbing_area : symbol
        All friction surfaces, whole and as far as they rub [m2].
    pressure : symbol
        Largest pressure [Pa].
    rubbing_radius : symbol
        Outermost radius that rubs [m].
    """
    part = pair.part
    d.derive("friction_area", "cm2", area, symbol="A", text="All friction surfaces together", source=f"{S1}, A")
    hourly = d.derive(
        "hourly_heat", "J/(mm2*h)",
        heat.specific_hourly_heat(start.friction_work, duty.switching_rate, rubbing_area), symbol="w",
        text="Friction work per hour and area", source=f"{S1}, w",
    )  # fmt: skip
    single = d.derive(
        "single_heat", "J/mm2", heat.single_heat(start.friction_work, rubbing_area), symbol="Q_A",
        text="Friction work per engagement and area", source="makers' limit for a single engagement",
    )  # fmt: skip
    density = d.derive(
        "power_density", "W/mm2", heat.power_density(start.peak_slip_power, rubbing_area), symbol="q_peak",
        text="Greatest friction power per area", source="Neale, Tribology Handbook, Table 7.4",
    )  # fmt: skip
    speed = d.derive(
        "sliding_speed", "m/s", plates.sliding_speed(duty.driver_speed, rubbing_radius), symbol="v_s",
        text="Sliding speed at the outer edge when slip begins", source="kinematics",
    )  # fmt: skip
    pressure = d.derive(
        "surface_pressure", "N/mm2", pressure, symbol="p_s",
        text="Largest pressure on a friction surface", source=f"{S1}, p; {S0}, eq. (3)",
    )  # fmt: skip
    d.at_most(
        "surface_pressure", pressure, part.p_allow, "N/mm2",
        text="The lining stands the pressure", source=f"{S1}, sizing",
    )  # fmt: skip
    d.at_most(
        "specific_heat", hourly, pair.hourly_allow, "J/(mm2*h)",
        text="The lining stands the hourly heat", source=f"{S1}, w <= w_allow",
    )  # fmt: skip
    d.at_most(
        "engagement_heat", single, part.optional("q_single_allow"), "J/mm2",
        text="The lining stands the heat of one engagement", source="makers' limit for a single engagement",
    )  # fmt: skip
    d.at_most(
        "specific_power", density, part.power_density_allow, "W/mm2",
        text="The lining stands the peak power", source="Neale, Tribology Handbook, Table 7.4",
    )  # fmt: skip
    d.at_most(
        "sliding_speed", speed, part.v_allow, "m/s",
        text="The lining stands the sliding speed", source="makers' limit of the lining",
    )  # fmt: skip


def declare_envelope(d: Declaration, duty: Duty, force: Any, diameter: Any, length: Any) -> None:
    """Declare the limits of force, diameter and length that were asked for."""
    asked = "requirement of the drive"
    if duty.actuation_force_limit is not None:
        d.at_most(
            "actuation_force", force, duty.actuation_force_limit, "N",
            text="The actuator can press so hard", source=asked,
        )  # fmt: skip
    if duty.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter", diameter, duty.outer_diameter_limit, "mm",
            text="The clutch fits the room across", source=asked,
        )  # fmt: skip
    if duty.length_limit is not None:
        d.at_most("length", length, duty.length_limit, "mm", text="The clutch fits the room along", source=asked)


# -- ring ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Ring:
    """A friction ring."""

    ratio_min: Any
    ratio_max: Any
    mean_diameter: Any
    ratio: Any
    friction_radius: Any
    width: Any
    inner_radius: Any
    outer_radius: Any
    area: Any


def declare_ring(d: Declaration, ratio_min: float, ratio_max: float) -> Ring:
    """Declare the block ring with the empirical range of its ratio.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    ratio_min, ratio_max : float
        Defaults of the range of ring width over mean diameter [-].

    Returns
    -------
    Ring
        Symbols of the block.
    """
    least = d.requirement(
        "ring_ratio_min", "-", ratio_min, lower=0.02, upper=0.9, symbol="c_min",
        text="Least ring width over mean diameter", source=f"{S1}, empirical range of c",
    )  # fmt: skip
    most = d.requirement(
        "ring_ratio_max", "-", ratio_max, lower=0.02, upper=0.9, symbol="c_max",
        text="Largest ring width over mean diameter", source=f"{S1}, empirical range of c",
    )  # fmt: skip
    d.refuse(
        "bad_ratio",
        least > most,
        "a ring_ratio_min of at most ring_ratio_max; otherwise no ring satisfies both",
    )
    outer = d.variable(
        "ring_outer_diameter", "mm", 40, RING_OUTER_DIAMETER_MAX, grid=1, symbol="d_out",
        text="Outer diameter of the friction ring", source=f"{S1}, d1",
    )  # fmt: skip
    inner = d.variable(
        "ring_inner_diameter", "mm", 20, 700, grid=1, symbol="d_in",
        text="Inner diameter of the friction ring", source=f"{S1}, d2",
    )  # fmt: skip
    mean = d.derive(
        "mean_diameter", "mm", ring_formulas.mean_diameter(outer, inner), symbol="dm",
        text="Mean diameter of the friction ring", source=f"{S1}, dm",
    )  # fmt: skip
    ratio = d.derive(
        "ring_ratio", "-", ring_formulas.ring_ratio(outer, inner), symbol="c",
        text="Ring width over mean diameter", source=f"{S1}, c = b/dm",
    )  # fmt: skip
    radius = d.derive(
        "friction_radius", "mm", ring_formulas.friction_radius(mean, ratio), symbol="r",
        text="Friction radius at uniform pressure", source=f"{S0}, friction radius",
    )  # fmt: skip
    d.advise(
        "bad_ring",
        inner >= outer,
        "ring_inner_diameter is not below ring_outer_diameter: this is no ring, and its other figures mean nothing",
        source=S0,
    )
    d.at_least(
        "ring_ratio_min", ratio, least, "-",
        text="The ring is not too narrow", source=f"{S1}, empirical range of c",
    )  # fmt: skip
    d.at_most(
        "ring_ratio_max", ratio, most, "-",
        text="The ring is not too wide", source=f"{S1}, empirical range of c",
    )  # fmt: skip
    return Ring(
        ratio_min=least,
        ratio_max=most,
        mean_diameter=mean,
        ratio=ratio,
        friction_radius=radius,
        # From the ratio, whose range is known, so that it is surely positive wherever the ratio is.
        width=mean * ratio,
        # Straight from the variables: a radius formed from mean diameter and ratio would use each of them twice.
        inner_radius=inner / 2,
        outer_radius=outer / 2,
        area=ring_formulas.ring_area(mean, ratio),
    )


# -- multi-plate pack ------------------------------------------------------------------------------


@dataclass(frozen=True)
class PackOptions:
    """Options of a multi-plate pack."""

    guide_model: str
    guide_series: str
    release_aid: str
    spline_choice: str
    shaft_position: str


@dataclass(frozen=True)
class PackRequirements:
    """Requirements of a multi-plate pack, all in SI; None where an optional one is not given."""

    surface_factor: Any
    guide_friction: Any
    hub_bore_diameter: Any
    drag_torque_limit: Any
    oil_viscosity: Any
    lug_clearance: Any
    lug_count: Any
    lug_height: Any
    lug_pressure_limit: Any
    drum_wall: Any
    plate_effectiveness_min: Any


@dataclass(frozen=True)
class ReleaseAid:
    """What a release aid takes of the force and leaves of area and drag; 0, 1, 1 without one."""

    force_fraction: Any = 0.0
    area_factor: Any = 1.0
    drag_factor: Any = 1.0


@dataclass(frozen=True)
class Pack:
    """The plates of a multi-plate pack."""

    surfaces: Any
    inner_thickness: Any
    outer_thickness: Any
    inner_spline_radius: Any
    outer_spline_radius: Any
    inner_mean_diameter: Any
    inner_width: Any
    inner_lug_count: Any
    inner_lug_height: Any
    aid: ReleaseAid


@dataclass(frozen=True)
class PackTorque:
    """Torque and pressure of a pack under an actuation force."""

    low: Any
    high: Any
    pressure: Any


@dataclass(frozen=True)
class PackSize:
    """Mass, size and heat capacity of a pack."""

    mass: Any
    diameter: Any
    length: Any
    heat_capacity: Any
    cooled_area: Any


def declare_lubrication(d: Declaration) -> str:
    """Declare the option lubrication; it comes first, because defaults of others depend on it."""
    return d.option(
        "lubrication",
        ("oil", "dry"),
        "oil",
        symbol="lub",
        text="Condition on the friction pair; sets the defaults of oil_viscosity and cooling",
        source=f"{S0}, plates in oil",
    )


def declare_pack_options(d: Declaration) -> PackOptions:
    """Declare the options of a multi-plate pack."""
    return PackOptions(
        guide_model=d.option(
            "guide_model",
            ("series", "cz"),
            "series",
            symbol="guide",
            text="series: friction in the plate guides is computed; cz: the lecture's factor surface_factor instead",
            source=f"{S0}, eq. (2) to (5); {S1}, c_z",
        ),
        guide_series=d.option(
            "guide_series",
            guide_friction.GUIDE_SERIES,
            "geometric",
            symbol="gs",
            text="Torque sum: geometric (5), exponential_form (5'), lipka (5''), exponential_K (10), exact",
            source=f"{S0}, eq. (5), (10) and appendix",
        ),
        release_aid=d.option(
            "release_aid",
            d.designations("release_aids"),
            "none",
            symbol="aid",
            text="What separates the plates of the released pack",
            source=f"{S0}, release of the plates",
        ),
        spline_choice=d.option(
            "spline_choice",
            ("free", "catalogue"),
            "free",
            symbol="spl",
            text="free: the inner spline follows the ring; catalogue: it is a row of table splines",
            source="table splines",
        ),
        shaft_position=d.option(
            "shaft_position",
            ("horizontal", "vertical"),
            "horizontal",
            symbol="pos",
            text="Position of the shaft",
            source=f"{S0}, vertical shafts",
        ),
    )


def declare_pack_requirements(d: Declaration, options: PackOptions, lubrication: str) -> PackRequirements:
    """Declare the requirements of a multi-plate pack and the refusals that concern them alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : PackOptions
        Options of the pack.
    lubrication : str
        dry or oil.

    Returns
    -------
    PackRequirements
        Symbols of the block.
    """
    series = options.guide_model == "series"
    pack = PackRequirements(
        surface_factor=d.requirement(
            "surface_factor", "-", 1.0 if series else 0.75, lower=0.3, upper=1, symbol="c_z",
            text="Surface-count factor, used with guide_model cz only; 0.75 belongs to ten surfaces",
            source=f"{S1}, c_z",
        ),
        guide_friction=d.requirement(
            "guide_friction", "-", 0.1, lower=0, upper=0.5, symbol="mu_guide",
            text="Friction of the plates in their splines", source=f"{S0}, mu1",
        ),
        hub_bore_diameter=d.requirement(
            "hub_bore_diameter", "mm", lower=2, upper=700, optional=True, symbol="d_hub_min",
            text="Least mean diameter 2a of the inner spline: room for the shaft", source="requirement of the drive",
        ),
        drag_torque_limit=d.requirement(
            "drag_torque_limit", "N*m", lower=0.001, upper=1e4, optional=True, symbol="T_drag_max",
            text="Largest drag of the released clutch", source=f"{S0}, after-running",
        ),
        oil_viscosity=d.requirement(
            "oil_viscosity", "Pa*s", 0.02 if lubrication == "oil" else 0.0, lower=0, upper=2, symbol="eta_oil",
            text=f"Dynamic viscosity of the oil, 0 when dry ({TYPICAL})", source=TYPICAL,
        ),
        lug_clearance=d.requirement(
            "lug_clearance", "mm", 3, lower=0.1, upper=30, symbol="e_lug",
            text="From the edge of the friction ring to the mean spline radius", source=f"{S0}, example",
        ),
        lug_count=d.requirement(
            "lug_count", "-", 12, lower=3, upper=200, symbol="n_lug",
            text=f"Lugs of a plate that carry ({TYPICAL})", source=TYPICAL,
        ),
        lug_height=d.requirement(
            "lug_height", "mm", 3, lower=0.5, upper=30, symbol="h_lug",
            text=f"Loaded flank height of a lug ({TYPICAL})", source=TYPICAL,
        ),
        lug_pressure_limit=d.requirement(
            "lug_pressure_limit", "N/mm2", 30, lower=1, upper=200, symbol="p_lug_allow",
            text=f"Pressure of the lugs on the spline flanks; 25 to 40 when hardened ({TYPICAL})", source=TYPICAL,
        ),
        drum_wall=d.requirement(
            "drum_wall", "mm", 6, lower=1, upper=50, symbol="s_drum",
            text=f"Drum outside the mean radius of the outer spline ({TYPICAL})", source=TYPICAL,
        ),
        plate_effectiveness_min=d.requirement(
            "plate_effectiveness_min", "-", 0.5, lower=0.05, upper=1, symbol="eta_min",
            text="Least torque of the pack over that without guide friction; used with guide_model series",
            source=f"{S0}, eq. (16)",
        ),
    )  # fmt: skip
    if series:
        d.refuse(
            "double_guide_loss",
            pack.surface_factor < 1,
            "no surface_factor below 1 with guide_model series, which computes the friction in the guides itself; "
            "leave surface_factor out or choose guide_model cz",
        )
    if lubrication == "dry":
        d.refuse("lubrication_mismatch", pack.oil_viscosity > 0, "an oil_viscosity of 0 with lubrication dry")
    else:
        d.refuse("lubrication_mismatch", pack.oil_viscosity <= 0, "an oil_viscosity above 0 with lubrication oil")
    return pack


def declare_pack(d: Declaration, options: PackOptions, wants: PackRequirements, ring: Ring) -> Pack:
    """Declare the plates of a pack and their splines.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : PackOptions
        Options of the pack.
    wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.

    Returns
    -------
    Pack
        The plates.
    """
    surfaces = d.count(
        "friction_surfaces", 2, 60, step=2, symbol="z",
        text="Friction surface pairs; even, because both end plates are inner plates", source=f"{S0}, x; {S1}, z",
    )  # fmt: skip
    inner_plate = d.part(
        "inner_plate", "core_plates", symbol="ip",
        text="Steel core of the inner plates", source="table core_plates",
    )  # fmt: skip
    outer_plate = d.part(
        "outer_plate", "core_plates", symbol="op",
        text="Steel core of the outer plates, lined on both sides", source="table core_plates",
    )  # fmt: skip
    if options.spline_choice == "catalogue":
        spline = d.part(
            "inner_spline", "splines", symbol="is", text="Spline of the inner plates", source="table splines"
        )
        inner_spline_radius = spline.mean_flank_diameter / 2
        inner_mean_diameter = ring.outer_radius + inner_spline_radius
        inner_width = ring.outer_radius - inner_spline_radius
        lug_count, lug_height = spline.teeth, spline.flank_height_h
        d.at_least(
            "spline_clearance", ring.inner_radius - inner_spline_radius, wants.lug_clearance, "mm",
            text="The spline stays clear of the friction ring", source=f"{S0}, a < r1",
        )  # fmt: skip
    else:
        inner_spline_radius = ring.inner_radius - wants.lug_clearance
        inner_mean_diameter = ring.mean_diameter - wants.lug_clearance
        inner_width = ring.width + wants.lug_clearance
        lug_count, lug_height = wants.lug_count, wants.lug_height
    aid_row = None if options.release_aid == "none" else d.row("release_aids", options.release_aid)
    d.derive(
        "outer_plates", "-", ring_formulas.outer_plate_count(surfaces), symbol="z_k",
        text="Outer plates", source=f"{S1}, z_k",
    )  # fmt: skip
    d.derive(
        "inner_plates", "-", ring_formulas.inner_plate_count(surfaces), symbol="z_b",
        text="Inner plates", source=f"{S1}, z_b = z_k + 1",
    )  # fmt: skip
    pack = Pack(
        surfaces=surfaces,
        inner_thickness=inner_plate.thickness,
        outer_thickness=outer_plate.thickness,
        inner_spline_radius=d.derive(
            "inner_spline_radius", "mm", inner_spline_radius, symbol="a",
            text="Mean spline radius of the inner plates", source=f"{S0}, a",
        ),
        outer_spline_radius=d.derive(
            "outer_spline_radius", "mm", ring.outer_radius + wants.lug_clearance, symbol="b",
            text="Mean spline radius of the outer plates", source=f"{S0}, b",
        ),
        inner_mean_diameter=inner_mean_diameter,
        inner_width=inner_width,
        inner_lug_count=lug_count,
        inner_lug_height=lug_height,
        aid=ReleaseAid()
        if aid_row is None
        else ReleaseAid(aid_row.force_fraction, aid_row.area_factor, aid_row.drag_factor),
    )  # fmt: skip
    if wants.hub_bore_diameter is not None:
        d.at_least(
            "hub_bore", 2 * pack.inner_spline_radius, wants.hub_bore_diameter, "mm",
            text="The shaft fits inside the plates", source="requirement of the drive",
        )  # fmt: skip
    return pack


def declare_pack_torque(
    d: Declaration,
    options: PackOptions,
    wants: PackRequirements,
    ring: Ring,
    pair: Pair,
    pack: Pack,
    force: Any,
) -> PackTorque:
    """Declare guide friction, lug pressures and drag of a pack; return its torque and pressure.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : PackOptions
        Options of the pack.
    wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.
    pair : Pair
        Slot friction_pair.
    pack : Pack
        The plates.
    force : symbol
        Actuation force F0 [N].

    Returns
    -------
    PackTorque
        Torque with the friction counted on and the friction feared, largest pressure.
    """
    radius, surfaces = ring.friction_radius, pack.surfaces
    a, b = pack.inner_spline_radius, pack.outer_spline_radius
    series = options.guide_model == "series"

    def ratios(mu: Any) -> tuple[Any, Any]:
        return (
            guide_friction.guide_ratio(mu, wants.guide_friction, radius, a),
            guide_friction.guide_ratio(mu, wants.guide_friction, radius, b),
        )

    def sum_factor(mu: Any) -> Any:
        return guide_friction.torque_sum_factor(options.guide_series, surfaces, *ratios(mu)) if series else surfaces

    def share(surface: int, mu: Any) -> Any:
        """Return the part of the actuation force that reaches a surface."""
        return guide_friction.contact_force(options.guide_series, 1.0, surface, *ratios(mu)) if series else 1.0

    net_force = force * (1 - pack.aid.force_fraction)
    # M0 = mu r F0 stays one expression for torque and lugs, so that a bound on the torque reaches the lugs.
    moment_low = pair.mu_low * net_force * radius
    moment_high = moment_low if pair.mu_high is pair.mu_low else pair.mu_high * net_force * radius
    d.at_least(
        "guide_jams", a, pair.mu_high * wants.guide_friction * radius, "mm", guard=True,
        text="The inner plates slide in their spline and do not jam; their mean spline radius is above 0",
        source=f"{S0}, first phase of engagement",
    )  # fmt: skip
    guide_number = sum(ratios(pair.mu_low)) if series else 0.0
    d.derive(
        "guide_number", "-", guide_number, symbol="S", needs="guide_jams",
        text="Friction in the guides; 0 with guide_model cz", source=f"{S0}, eq. (2)",
    )  # fmt: skip
    factor = d.derive(
        "torque_sum_factor", "-", sum_factor(pair.mu_low), symbol="E", needs="guide_jams",
        text="Torque of the pack over mu F0 r", source=f"{S0}, eq. (5)",
    )  # fmt: skip
    factor_high = factor if pair.mu_high is pair.mu_low else sum_factor(pair.mu_high)
    effectiveness = d.derive(
        "plate_effectiveness", "-", factor_high / surfaces, symbol="eta_z", needs="guide_jams",
        text="Torque of the pack over that of as many surfaces without guide friction (worst_case: with mu_max)",
        source=f"{S0}, eq. (16)",
    )  # fmt: skip
    if series:
        d.at_least(
            "plate_count_worthwhile", effectiveness, wants.plate_effectiveness_min, "-",
            text="Adding plates is still worth while", source=f"{S0}, eq. (16)",
        )  # fmt: skip
        d.advise(
            "beyond_legacy_plate_limit",
            surfaces > guide_friction.legacy_plate_limit(guide_number),
            "more friction surfaces than the rule sqrt(2)/K of eq. (15) allows; plate_count_worthwhile (16) decides",
            source=f"{S0}, eq. (15)",
        )
    else:
        d.advise(
            "surface_factor_fits_ten_surfaces",
            np.logical_or(surfaces < 10, surfaces > 10),
            "surface_factor was taken for a pack that may have another number of surfaces: 0.75 belongs to ten; "
            "guide_model series computes the loss for any number",
            source=f"{S1}, c_z",
        )
    _declare_lugs(d, wants, pack, moment_high, [share(j, pair.mu_high) for j in (1, 2, 3)])
    return PackTorque(
        low=moment_low * factor,
        high=moment_high * factor_high,
        pressure=net_force * share(1, pair.mu_low) / (pack.aid.area_factor * ring.area),
    )


def _declare_lugs(d: Declaration, wants: PackRequirements, pack: Pack, moment: Any, shares: Sequence[Any]) -> None:
    """Declare the lug pressures; ``moment`` is mu r F0 and ``shares`` the parts of F0 on surfaces 1, 2 and 3."""
    first, second, third = shares
    outer_torque = moment * (first + second)
    # With two surfaces both inner plates are end plates, and the first is loaded by surface 1 alone.
    inner_torque = moment * np.where(pack.surfaces > 2, second + third, first)
    outer = d.derive(
        "lug_pressure_outer", "N/mm2",
        plates.lug_pressure(
            outer_torque, pack.outer_spline_radius, wants.lug_count, wants.lug_height, pack.outer_thickness
        ),
        symbol="p_lo", needs="guide_jams",
        text="Pressure of the lugs of the first outer plate (worst_case: with mu_max)",
        source=f"{S0}, plate thickness; derived",
    )  # fmt: skip
    inner = d.derive(
        "lug_pressure_inner", "N/mm2",
        plates.lug_pressure(
            inner_torque, pack.inner_spline_radius, pack.inner_lug_count, pack.inner_lug_height, pack.inner_thickness
        ),
        symbol="p_li", needs="guide_jams",
        text="Pressure of the lugs of the first inner plate between two surfaces (worst_case: with mu_max)",
        source=f"{S0}, plate thickness; derived",
    )  # fmt: skip
    rule = f"{S0}: the lugs must not bite into the spline groove"
    d.at_most(
        "lug_pressure_outer", outer, wants.lug_pressure_limit, "N/mm2",
        text="The lugs of the outer plates do not bite into the drum", source=rule,
    )  # fmt: skip
    d.at_most(
        "lug_pressure_inner", inner, wants.lug_pressure_limit, "N/mm2",
        text="The lugs of the inner plates do not bite into the hub", source=rule,
    )  # fmt: skip
    d.advise(
        "thin_plates",
        np.logical_or(outer > 25e6, inner > 25e6),
        "thin plates load the spline flanks above 25 N/mm2: the groove flanks must be hardened",
        source=f"{S0}, thin plates need hard grooves",
    )


def declare_drag(d: Declaration, duty: Duty, wants: PackRequirements, ring: Ring, pack: Pack) -> None:
    """Declare the drag of the released pack and its limit."""
    drag = d.derive(
        "drag_torque", "N*m",
        pack.aid.drag_factor
        * plates.drag_torque(
            pack.surfaces, wants.oil_viscosity, duty.driver_speed, ring.mean_diameter, ring.ratio, duty.plate_gap
        ),
        symbol="T_drag",
        text="Drag of the released clutch with full oil films; 0 when dry",
        source=f"laminar shear; {S0}, after-running",
    )  # fmt: skip
    if wants.drag_torque_limit is not None:
        d.at_most(
            "drag_torque", drag, wants.drag_torque_limit, "N*m",
            text="The released clutch does not run after", source=f"{S0}, after-running",
        )  # fmt: skip


def pack_size(duty: Duty, wants: PackRequirements, ring: Ring, pair: Pair, pack: Pack) -> PackSize:
    """Return mass, size and heat capacity of a pack."""
    z, lining = pack.surfaces, pair.part.lining_thickness
    steel = plates.annulus_mass(
        duty.steel_density,
        ring_formulas.inner_plate_count(z),
        pack.inner_thickness,
        pack.inner_mean_diameter,
        pack.inner_width,
    ) + plates.annulus_mass(
        duty.steel_density,
        ring_formulas.outer_plate_count(z),
        pack.outer_thickness,
        ring.mean_diameter + wants.lug_clearance,
        ring.width + wants.lug_clearance,
    )
    diameter = plates.drum_diameter(pack.outer_spline_radius, wants.drum_wall)
    length = plates.pack_length(z, pack.inner_thickness, pack.outer_thickness, lining, duty.plate_gap)
    return PackSize(
        mass=steel + plates.lining_mass(pair.part.density, lining, z * ring.area),
        diameter=diameter,
        length=length,
        heat_capacity=steel * duty.steel_specific_heat,
        cooled_area=plates.cylinder_surface(diameter, length),
    )


def declare_pack_temperature(d: Declaration, duty: Duty, pair: Pair, start: Startup, size: PackSize) -> None:
    """Declare the peak temperature of a pack and its limit."""
    rise = d.derive(
        "peak_temperature_rise", "K",
        heat.peak_temperature_rise(
            start.friction_work, duty.switching_rate, size.heat_capacity, duty.heat_transfer, size.cooled_area
        ),
        symbol="dT_pk",
        text="Steel plates over ambient just after an engagement, in steady repetition",
        source=f"lumped heat balance; {S1}, repeated switching",
    )  # fmt: skip
    d.at_most(
        "peak_temperature", rise, pair.part.temp_max - duty.ambient_temperature, "K",
        text="The lining stands the temperature", source="Neale, Tribology Handbook, Table 7.4",
    )  # fmt: skip
    d.advise(
        "frequent_switching",
        heat.cycle_time(duty.switching_rate)
        < heat.thermal_time_constant(size.heat_capacity, duty.heat_transfer, size.cooled_area),
        "the next engagement comes before the plates have cooled down (the cycle is shorter than their thermal time "
        "constant): at this switching rate the cooling decides; best is to avoid the heat",
        source=f"{S0}, frequent switching makes cooling compulsory",
    )
    mean_rise = heat.mean_temperature_rise(
        start.friction_work, duty.switching_rate, duty.heat_transfer, size.cooled_area
    )
    d.advise(
        "mean_temperature",
        mean_rise > pair.part.optional("temp_continuous") - duty.ambient_temperature,
        "the mean temperature of the pack is above what the lining stands continuously; choose a stronger cooling",
        source="Neale, Tribology Handbook, Table 7.4",
    )


def declare_pack_remarks(d: Declaration, options: PackOptions, duty: Duty, lubrication: str) -> None:
    """Declare the remarks that depend on options only."""
    if options.shaft_position == "vertical":
        d.advise(
            "vertical_shaft",
            True,
            "on a vertical shaft the plates sink on each other by their weight: every plate needs a stop of its own "
            "(stepped rings on the shaft, inserts in the drum, lift springs)",
            source=f"{S0}, vertical shafts",
        )
    if lubrication == "oil" and options.release_aid == "none":
        d.advise(
            "no_release_aid",
            True,
            "without a release aid oil adhesion drags the plates along after release; drag_torque is for plates "
            "that stand apart by plate_gap",
            source=f"{S0}, after-running",
        )
    if options.release_aid == "sine_plates":
        d.advise(
            "release_aid_sine_plates",
            True,
            "waved plates touch on small areas when released and cannot stand fully apart; part of the force flattens "
            "them",
            source=f"{S0}, release of the plates",
        )
    if options.release_aid == "wavy_rings":
        d.advise(
            "release_aid_wavy_rings",
            True,
            "rings between neighbouring inner plates surely separate half the plates; they cost friction surface",
            source=f"{S0}, release of the plates",
        )
    if options.release_aid == "cone_springs":
        d.advise(
            "release_aid_cone_springs",
            True,
            "conical springs in the spline grooves need room in the grooves",
            source=f"{S0}, release of the plates",
        )
    if duty.cooling == "fan":
        d.advise(
            "fan_cooling",
            True,
            "plates shaped as fan blades cost power and treat the symptom only; best is to avoid the heat",
            source=f"{S0}, cooling of the plates",
        )
