"""The hooks that all friction clutches share: the start-up in time, and what the duty alone says about it.

They read a design by its public names (``ramp_torque``, ``ramp_time``, ``jerk`` ...), so that a family uses them with a
line each.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.declaration import Setting
from synth.errors import InputError
from synth.text.numbers import number_text, typed_number

from ..mechanics import heat, motors, startup

if TYPE_CHECKING:
    import pandas as pd

    from synth import Design, DesignProblem

    from ..mechanics.startup_simulation import StartupRun

SETTINGS: Mapping[str, Setting] = {
    "motor": Setting("asynchronous motor that drives, with Kloss's torque curve", table="motors_iec"),
    "gear_ratio": Setting("speed of the motor over that of the clutch; by default it idles at driver_speed", unit="-"),
    "driver_inertia": Setting(
        "driving inertia at the clutch shaft; by default infinite, with a motor that of its rotor", unit="kg*m2"
    ),
    "driver_torque": Setting("constant torque of a driver without motor curve; 0 for a flywheel", unit="N*m"),
    "ramp": Setting("course of the clutch torque up to ramp_time", choices=("linear", "smooth")),
    "hold_time": Setting("how long to go on after lock-up; 0 ends with it, whatever the driver does then", unit="s"),
    "time_limit": Setting("longest time, for a clutch that does not lock", unit="s"),
}
WORST = "worst_case"


def startup_frames(problem: DesignProblem, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
    """Simulate the start-up of a friction clutch of any family.

    Parameters
    ----------
    problem : DesignProblem
        The family; its options load_kind and friction_basis count.
    spec : mapping
        Requirements of the block duty and SETTINGS, in SI.
    design : Design
        With ramp_torque, ramp_time, jerk, slot friction_pair, and the steps heat_capacity and cooled_area.

    Returns
    -------
    dict
        Frame ``startup``; with friction_basis worst_case it is that with the least friction, and
        ``startup_high_friction`` is added where the greatest friction gives more torque; ``temperature`` over repeated
        engagements where they leave time for another.

    Raises
    ------
    InputError
        When the torque of the design does not exist, or a setting is not possible.
    """
    low = design.values["ramp_torque"]
    if not math.isfinite(low):
        raise InputError(
            "ramp_torque", None, f"a design whose torque exists; this one violates {', '.join(design.violated)}"
        )
    # The jerk is given with the friction feared, so that it tells the torque that belongs to it.
    high = design.values["jerk"] * design.values["ramp_time"] * spec["driven_inertia"]
    run = simulate_duty(problem, spec, design, low)
    frames = {"startup": _frame(problem, spec, run, "")}
    if problem.option("friction_basis") == WORST and high > low * (1 + 1e-9):
        more = simulate_duty(problem, spec, design, high)
        frames["startup"].attrs["title"] += ", least friction"
        frames["startup_high_friction"] = _frame(problem, spec, more, ", greatest friction")
        for name in ("peak_slip_power", "acceleration"):
            del frames["startup"].attrs["quantities"][name]
        for name in ("slip_time", "friction_work"):
            del frames["startup_high_friction"].attrs["quantities"][name]
    fits = run.outcome == "locked" and run.slip_time < heat.cycle_time(spec["engagements_per_hour"])
    if fits:
        frames["temperature"] = _temperature(problem, spec, design, run)
    return frames


def simulate_duty(problem: DesignProblem, spec: Mapping[str, Any], design: Design, torque: float) -> StartupRun:
    """Simulate the start-up under the duty of a spec.

    Parameters
    ----------
    problem : DesignProblem
        The family.
    spec : mapping
        Requirements of the block duty and SETTINGS, in SI.
    design : Design
        With ramp_time and slot friction_pair.
    torque : float
        Clutch torque at the end of the ramp [N m].

    Returns
    -------
    StartupRun
        The start-up in time.
    """
    from ..mechanics.startup_simulation import simulate_startup  # scipy is not needed to declare

    pair = design.parts["friction_pair"]
    static = pair.get("mu_static")
    return simulate_startup(
        torque,
        spec["load_torque"],
        spec["driven_inertia"],
        spec["driver_speed"],
        design.values["ramp_time"],
        problem.option("load_kind"),
        ramp=spec.get("ramp", "linear"),
        static_ratio=static / pair["mu_dynamic"] if static else 1.0,
        hold_time=spec.get("hold_time"),
        time_limit=spec.get("time_limit"),
        **_driver(spec),
    )


def _driver(spec: Mapping[str, Any]) -> dict[str, Any]:
    """Return inertia and torque of the driver at the clutch shaft."""
    motor = spec.get("motor")
    if motor is None:
        if spec.get("gear_ratio") is not None:
            raise InputError("settings: gear_ratio", spec["gear_ratio"], "a motor too, to which the ratio belongs")
        given = {key: spec[key] for key in ("driver_inertia", "driver_torque") if spec.get(key) is not None}
        if len(given) == 1:
            missing = "driver_torque" if "driver_inertia" in given else "driver_inertia"
            ((name, value),) = given.items()
            raise InputError(f"settings: {name}", value, f"{missing} (or a motor) too: the speed depends on both")
        return given
    if spec.get("driver_torque") is not None:
        raise InputError("settings: driver_torque", spec["driver_torque"], "either driver_torque or motor")
    for column in ("pullout_torque_ratio", "rotor_inertia"):
        if motor[column] is None:
            raise InputError("settings: motor", motor["designation"], f"a motor with a value in column {column}")
    ratio = spec.get("gear_ratio") or motor["synchronous_speed"] / spec["driver_speed"]
    synchronous = motor["synchronous_speed"] / ratio
    if ratio < 0 or synchronous < spec["driver_speed"] * (1 - 1e-12):
        most = motor["synchronous_speed"] / spec["driver_speed"]
        raise InputError(
            "settings: gear_ratio", ratio, f"above 0 and at most {typed_number(most)}, so that it reaches driver_speed"
        )
    slip = motor["breakdown_slip"]
    curve = partial(
        motors.kloss_torque,
        synchronous_speed=synchronous,
        breakdown_torque=motor["pullout_torque_ratio"] * motor["rated_torque"] * ratio,
        breakdown_slip=slip or motors.breakdown_slip(motor["rated_slip"], motor["pullout_torque_ratio"]),
    )
    return {"driver_inertia": spec.get("driver_inertia") or motor["rotor_inertia"] * ratio**2, "driver_torque": curve}


def _frame(problem: DesignProblem, spec: Mapping[str, Any], run: StartupRun, more: str) -> pd.DataFrame:
    frame = run.frame()
    frame.attrs["title"] = f"{problem.title}, start-up: {run.headline()}{more}"
    inertia = run.question.driver_inertia
    motor = spec.get("motor")
    driver = "at constant speed" if math.isinf(inertia) else f"of {number_text(inertia)} kg m² at the clutch"
    if motor is not None:
        driver = f"{motor['designation']} (Kloss), {number_text(inertia)} kg m² at the clutch"
    elif not math.isinf(inertia):
        driver += f" with {number_text(spec['driver_torque'])} N m"
    load = problem.option("load_kind")
    frame.attrs["source"] = (
        f"Load {number_text(spec['load_torque'])} N m, {load}; "
        f"driven inertia {number_text(spec['driven_inertia'])} kg m²; "
        f"driver {driver}. Equations of motion integrated (S1, eq. (1), (2))."
    )
    return frame


def _temperature(problem: DesignProblem, spec: Mapping[str, Any], design: Design, run: StartupRun) -> pd.DataFrame:
    from ..mechanics.startup_simulation import simulate_switching

    capacity, surface = design.steps["heat_capacity"], design.steps["cooled_area"]
    switching = simulate_switching(run, spec["engagements_per_hour"], capacity, spec["heat_transfer"], surface)
    highest = design.parts["friction_pair"].get("temp_max")
    frame = switching.frame(None if highest is None else highest - spec["ambient_temperature"])
    frame.attrs["title"] = f"{problem.title}, r{frame.attrs['title'][1:]}"
    return frame


# -- curves ----------------------------------------------------------------------------------------

RAMPS = (0.0, 0.5, 1.0, 2.0)  # in units of omega1 J2/M_load, the time that the load torque alone would take


def startup_over_torque(problem: DesignProblem, spec: Mapping[str, Any], design: Design | None = None) -> pd.DataFrame:
    """Friction work, slip time and peak power over the torque of the start-up: what the duty alone decides.

    Parameters
    ----------
    problem : DesignProblem
        The family; its option load_kind counts.
    spec : mapping
        Requirements of the block duty in SI.
    design : Design, optional
        Its ramp time is drawn and its torque marked; otherwise a few ramp times of the order of the slip time are.

    Returns
    -------
    pandas.DataFrame
        One column per ramp time and quantity.
    """
    import pandas as pd

    load, inertia, speed = spec["load_torque"], spec["driven_inertia"], spec["driver_speed"]
    kind = problem.option("load_kind")
    sizing = spec["required_torque"]
    ramps = [float(f"{k * inertia * speed / (load or sizing):.2g}") for k in RAMPS]
    marks = [{"x": load, "label": "load torque"}, {"x": sizing, "label": "required torque"}]
    if spec.get("startup_torque") is not None:
        marks.append({"x": spec["startup_torque"], "label": "start-up torque"})
    most = 2 * max(sizing, spec.get("startup_torque") or 0.0)
    if design is not None:
        torque, ramp = design.values["ramp_torque"], design.values["ramp_time"]
        ramps = [0.0, ramp / 2, ramp, 2 * ramp]
        if math.isfinite(torque):
            if spec.get("startup_torque") is None:
                marks.append({"x": torque, "label": "this design"})
            most = max(most, 1.3 * torque)
    # The work grows without bound towards the load torque; what nobody builds would hide the rest.
    torques = load + np.linspace(0.15 * (sizing - load), most - load, 200)
    data: dict[str, Any] = {"ramp_torque [N*m]": torques}
    panels = []
    for name, unit, function in (
        ("friction_work", "J", startup.friction_work),
        ("slip_time", "s", startup.slip_time),
        ("peak_slip_power", "W", startup.peak_slip_power),
    ):
        columns = []
        for ramp in ramps:
            header = f"{name}_ramp_{ramp:.3g}_s [{unit}]"
            step = ramp == 0 and name == "peak_slip_power"
            data[header] = torques * speed if step else function(torques, load, inertia, speed, ramp, kind)
            columns.append(header)
        panels.append({"label": f"{name} [{unit}]", "columns": columns})
    frame = pd.DataFrame(data)
    frame.attrs = {
        "title": f"{problem.title}: cost of a start-up over the torque of its ramp",
        "x": "ramp_torque [N*m]",
        "panels": panels,
        "marks": marks,
        "lines": [{"panel": 1, "y": spec["slip_time_limit"], "label": "slip_time_limit"}],
        "source": f"Load {number_text(load)} N m, {kind}; driven inertia {number_text(inertia)} kg m²; driver at "
        "constant speed. Closed forms of the start-up (S1).",
    }
    return frame
