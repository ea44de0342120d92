"""What an engagement does to a friction clutch: torque, start-up and heat."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from synth.declaration import Requirement

from ..mechanics import heat, plates, startup
from ..practice import UNSOURCED
from ..sources import PRACTICE, S0, S1
from .duty import Duty, DutyInRows, Starting

if TYPE_CHECKING:
    from synth.declaration import Declaration

    from ..components.lining.model import Pair

SOFT_START_SHARE = Requirement(
    "-",
    0.1,
    lower=0,
    upper=1,
    symbol="k_soft",
    text=f"Least ramp over slip time, where jerk limit is not given ({UNSOURCED})",
    source=UNSOURCED,
    group="practice",
)


@dataclass(frozen=True)
class Torques:
    """Torques of the start-up: with the friction counted on (low) and the friction feared (high)."""

    ramp_low: Any
    ramp_high: Any
    apart: bool = False  # whether the one differs from the other


def declare_torque(
    d: Declaration,
    *,
    duty: Duty,
    pair: Pair,
    torque_low: Any,
    torque_high: Any,
    source: str,
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
    torque_low, torque_high : symbol
        Built capacity M_k with the friction counted on and with the friction feared [N m].
    source : str
        Of the formula of the built capacity, which is that of the family.
    overload : symbol, optional
        Torque that must stay below overload_torque; by default torque_high [N m].
    needs : tuple of str
        Guards without which the torques do not exist.

    Returns
    -------
    Torques
        Torques at the end of the ramp.
    """
    d.derive(
        "torque",
        "N*m",
        torque_low,
        symbol="M_k",
        needs=needs,
        text="Built capacity with new lining (worst case: least friction)",
        source=source,
    )
    if duty.friction_basis == "worst_case":
        d.step(
            "greatest_torque",
            "N*m",
            torque_high,
            symbol="M_k_max",
            text="Built capacity with the friction that is feared",
            source=source,
        )
    given = duty.startup_torque
    torques = Torques(
        ramp_low=torque_low if given is None else given,
        ramp_high=torque_high if given is None else given,
        apart=given is None and duty.friction_basis == "worst_case",
    )
    d.derive(
        "ramp_torque",
        "N*m",
        torques.ramp_low,
        symbol="T_k",
        text="Torque at the end of the ramp in start-up: torque, or startup torque when given",
        source=f"{S1}, start-up",
    )
    d.at_least(
        "torque_capacity",
        torque_low,
        duty.required_torque,
        "N*m",
        text="The clutch carries the sizing torque",
        source=f"{S1}, sizing",
    )
    if given is not None:
        d.at_least(
            "startup_torque_available",
            torque_low,
            given,
            "N*m",
            text="The clutch can deliver the start-up torque",
            source=f"{S1}, start-up and sizing linked",
        )
    d.advise(
        "static_hold",
        plates.static_hold(torque_low, pair.part.optional("mu_static"), pair.part.mu_dynamic, duty.load_torque) < 1.2,
        "locked, the clutch holds less than 1.2 times the load torque",
        source=PRACTICE,
    )
    if duty.overload_torque is not None:
        d.at_most(
            "torque_limit",
            torque_high if overload is None else overload,
            duty.overload_torque,
            "N*m",
            text="The clutch slips at the overload torque",
            source=f"{S1}, clutch as safety element",
        )
        d.refuse(
            "capacity_window_empty",
            duty.overload_torque < duty.required_torque,
            "an overload_torque of at least the sizing torque (load_torque times safety_factor over the other "
            "operating factors); otherwise no torque satisfies both",
        )
    return torques


@dataclass(frozen=True)
class Startup:
    """What one engagement costs."""

    friction_work: Any
    slip_time: Any
    peak_slip_power: Any
    ramp_time: Any


def declare_startup(d: Declaration, *, duty: Starting, torques: Torques, ramp_time: Any) -> Startup:
    """Declare friction work, slip time, power, jerk and acceleration of the start-up with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Starting
        Block duty.
    torques : Torques
        Torques at the end of the ramp.
    ramp_time : symbol
        Variable ramp_time [s].

    Returns
    -------
    Startup
        Friction work, slip time, peak slip power and ramp.
    """
    d.at_least(
        "never_starts",
        torques.ramp_low,
        duty.load_torque,
        "N*m",
        guard=True,
        text="The start-up torque is above the load torque; otherwise the clutch slips for ever",
        source=f"{S1}, start-up",
    )
    low = (torques.ramp_low, duty.load_torque, duty.driven_inertia, duty.driver_speed, ramp_time, duty.load_kind)
    high = (torques.ramp_high, *low[1:])
    work = d.derive(
        "friction_work",
        "J",
        startup.friction_work(*low),
        symbol="W",
        needs="never_starts",
        text="Friction work per engagement",
        source=f"{S1}, start-up; closed form",
    )
    slip_time = d.derive(
        "slip_time",
        "s",
        startup.slip_time(*low),
        symbol="t_D",
        needs="never_starts",
        text="Time until lock-up",
        source=f"{S1}, start-up, t_D; closed form",
    )
    power = d.derive(
        "peak_slip_power",
        "W",
        startup.peak_slip_power(*high),
        symbol="P_peak",
        needs="never_starts",
        text="Greatest friction power (worst case: greatest friction)",
        source=f"{S1}, start-up; closed form",
    )
    _name_startup(d, duty=duty, torques=torques, ramp_time=ramp_time)
    jerk = d.derive(
        "jerk",
        "rad/s3",
        startup.torque_rate_per_inertia(torques.ramp_high, duty.driven_inertia, ramp_time),
        text="Jerk of the driven side during the ramp (worst case: greatest friction)",
        source=f"{S1}, equation of motion",
    )
    acceleration = d.derive(
        "acceleration",
        "rad/s2",
        (startup.lock_torque(*high) - duty.load_torque) / duty.driven_inertia,
        symbol="acc",
        needs="never_starts",
        text="Greatest acceleration, at the end of the ramp or of slip (worst case: greatest friction)",
        source=f"{S1}, alpha_2C",
    )
    d.at_most(
        "slip_time",
        slip_time,
        duty.slip_time_limit,
        "s",
        text="Slip ends soon enough",
        source="requirement of the drive",
    )
    d.at_most(
        "cycle_time",
        slip_time,
        heat.cycle_time(duty.engagements_per_hour),
        "s",
        text="Slip ends before the next engagement",
        source=f"{S1}, repeated switching",
    )
    if duty.jerk_limit is not None:
        d.at_most("jerk", jerk, duty.jerk_limit, "rad/s3", text="Soft start", source="requirement of the drive")
    if duty.acceleration_limit is not None:
        d.at_most(
            "acceleration",
            acceleration,
            duty.acceleration_limit,
            "rad/s2",
            text="The driven machine stands the acceleration",
            source="requirement of the drive",
        )
    if duty.jerk_limit is None:
        d.advise(
            "hard_start",
            ramp_time < (0.1 - 1e-6) * slip_time,  # at the limit of soft_start it is a tenth but for the tolerance
            "the ramp lasts less than a tenth of the slip, nearly a step: the driven side is jerked into motion; "
            "jerk limit asks for a soft start",
            source=f"{S1}, soft start",
        )
    d.advise(
        "locks_in_ramp",
        slip_time < ramp_time,
        "lock-up comes before the ramp ends: ramp torque is not reached in start-up, and slip is longer than the "
        "torque would allow",
        source=f"{S1}, omega2C <= omega1",
    )
    return Startup(work, slip_time, power, ramp_time)


def limit_soft_start(d: Declaration, duty: Duty, start: Startup, share: Any) -> None:
    """Declare the least ramp over the slip time [-], and one inside it, where no jerk limit asks for a soft start."""
    if duty.jerk_limit is None:
        least, text = share * start.slip_time, "Soft start: the torque does not come as a step"
        d.at_least("soft_start", start.ramp_time, least, "s", text=text, source=UNSOURCED)
        text = "The torque is up before lock-up; a longer ramp only lengthens the slip"
        d.at_most("ramp_in_slip", start.ramp_time, start.slip_time, "s", text=text, source=UNSOURCED)


def _name_startup(d: Declaration, *, duty: Starting, torques: Torques, ramp_time: Any) -> None:
    """Name what friction work, slip time and slip power are made of; T_k is M_k_max where worst_case asks for it."""
    load, inertia, speed = duty.load_torque, duty.driven_inertia, duty.driver_speed
    low, high = torques.ramp_low, torques.ramp_high
    source = f"{S1}, start-up; closed form"

    def name(name: str, unit: str, value: Any, symbol: str, text: str) -> None:
        d.step(name, unit, value, symbol=symbol, text=text, source=source)

    name("excess_torque", "N*m", low - load, "M_ex", "Torque that the load leaves for acceleration")
    energy = startup.kinetic_energy(inertia, speed)
    name("kinetic_energy", "J", energy, "E_kin", "Energy of the driven side after lock-up")
    waiting = startup.ramp_work(load, speed, ramp_time)
    name("ramp_work", "J", waiting, "W_ramp", "Work against the load in half the ramp")
    slip_speed = speed
    if duty.load_kind == "reactive":
        share = startup.excess_share(low, load)
        name("excess_share", "-", share, "x_ex", "Share of the torque that accelerates")
        work = startup.run_up_work(low, load, energy)
        name("run_up_work", "J", work, "W_run", "Friction work of a step of torque")
        relief = startup.ramp_relief(low, load, inertia, ramp_time)
        text = "Work that the load, moved in the ramp, takes over"
        name("ramp_relief", "J", relief, "W_rel", text)
        length = startup.catch_up_time(low, inertia, speed, ramp_time)
        name("catch_up_time", "s", length, "t_up", "Time from the start of the load to lock-up, if inside the ramp")
    else:
        bend = startup.driven_back_work(low, load, inertia, ramp_time)
        text = "Work that the load, moved in the ramp, adds"
        name("driven_back_work", "J", bend, "W_back", text)
        locked = startup.active_lock_in_ramp(low, load, inertia * speed, ramp_time)
        name("ramp_lock_time", "s", locked, "t_lock", "Time until lock-up, if inside the ramp")
        slip_speed = speed - startup.lowest_driven_speed(high, load, inertia, ramp_time)
        name("greatest_slip_speed", "rad/s", slip_speed, "omega_slip", "Slip speed when the load begins to be lifted")
    if torques.apart:
        text = "Torque that the load leaves for acceleration with the friction that is feared"
        name("greatest_excess_torque", "N*m", high - load, "M_ex_max", text)
    root = startup.peak_power_root(high, load, inertia, slip_speed, ramp_time)
    text = "Root of the greatest friction power inside the ramp"
    name("peak_power_root", "N*m", root, "M_root", text)


def mean_rise(duty: DutyInRows, work: Any, rate: Any, *, capacity: Any, cooled_area: Any) -> Any:
    """Mean rise of a body heated by a work [J] at a rate [1/s], of a row of starts that of its last [K]."""
    steady = heat.mean_temperature_rise(work, rate, duty.heat_transfer, cooled_area)
    if duty.starts_in_row is None:
        return steady
    conductance = duty.heat_transfer * cooled_area
    return steady * heat.row_share(duty.starts_in_row, duty.engagements_per_hour, capacity, conductance)


def peak_rise(duty: DutyInRows, work: Any, *, capacity: Any, cooled_area: Any) -> Any:
    """Rise of a body just after an engagement of a work [J], steady or at the end of a row of starts [K]."""
    n, rate, transfer = duty.starts_in_row, duty.engagements_per_hour, duty.heat_transfer
    if n is None:
        return heat.peak_temperature_rise(work, rate, capacity, transfer, cooled_area)
    return heat.rise_after(n, work, rate, capacity, transfer * cooled_area)


def declare_heated_body(d: Declaration, *, heat_capacity: Any, cooled_area: Any, body: str) -> None:
    """Name what stores the heat of a start and gives it off, for the temperature over repeated engagements.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    heat_capacity : symbol
        Of the body [J/K].
    cooled_area : symbol
        Surface that gives off the heat [m2].
    body : str
        What it is, for the reader.
    """
    d.step(
        "heat_capacity",
        "J/K",
        heat_capacity,
        symbol="C_heat",
        text=f"{body}, which store the heat of a start",
        source="heat balance",
    )
    d.step("cooled_area", "m2", cooled_area, symbol="A_cool", text="Outside that gives off the heat", source="geometry")


def advise_frequent_switching(d: Declaration, *, duty: Duty, heat_capacity: Any, cooled_area: Any) -> None:
    """Remark where the next engagement comes before the clutch has cooled down.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Block duty.
    heat_capacity : symbol
        Of what stores the heat [J/K].
    cooled_area : symbol
        Surface that gives it off [m2].
    """
    d.advise(
        "frequent_switching",
        heat.cycle_time(duty.engagements_per_hour)
        < heat.thermal_time_constant(heat_capacity, duty.heat_transfer, cooled_area),
        "the next engagement comes before the plates have cooled down (the cycle is shorter than their thermal time "
        "constant): at this switching rate the cooling decides; best is to avoid the heat",
        source=f"{S0}, frequent switching makes cooling compulsory",
    )
