"""What the rules of practice reject of fronts that are asked without them, and what they cost."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import synth
from tests.benchmarks.tables import Report

POINTS = 30
THREADS = 2


@dataclass(frozen=True)
class Duty:
    """One duty of a family."""

    family: str
    size: str
    requirements: Mapping[str, Any]
    options: Mapping[str, str] = field(default_factory=dict)
    fix: Mapping[str, str] = field(default_factory=dict)


def _start(torque: str, speed: str, inertia: str, **more: str) -> dict[str, Any]:
    return {"load_torque": torque, "driver_speed": speed, "driven_inertia": inertia, **more}


def _speeds(torque: str, speeds: tuple[int, int, int, int, int], inertia: str, *, ramp: bool) -> dict[str, Any]:
    """Return a duty of a centrifugal clutch; speeds [1/min] from idle to the top, the earliest contact for ramps."""
    idle, early, late, full, top = (f"{n} 1/min" for n in speeds)
    wants = {
        "required_torque": torque,
        "idle_speed": idle,
        "contact_speed_max": late,
        "full_torque_speed": full,
        "top_speed": top,
        "driven_inertia": inertia,
    }
    return wants | ({"contact_speed_min": early} if ramp else {})


CENTRIFUGAL = [
    Duty(f"centrifugal_{kind}", torque.replace("*", " "), _speeds(torque, speeds, inertia, ramp=ramp))
    for kind, ramp in (("ball_ramp", True), ("two_spring", True), ("lever", False), ("reversed", False))
    for torque, speeds, inertia in (
        ("5 N*m", (1800, 2100, 2800, 4200, 6000), "0.005 kg*m2"),
        ("40 N*m", (1000, 1150, 1600, 2400, 3600), "0.05 kg*m2"),
        ("400 N*m", (600, 700, 1000, 1500, 2200), "1 kg*m2"),
    )
]


def _powder(torque: str, speed: str) -> dict[str, Any]:
    return {"required_torque": torque, "driver_speed": speed}


WRAP_SPRINGS = (("5 N*m", "10 mm", "12.5 N*m"), ("50 N*m", "28 mm", "125 N*m"), ("1 kN*m", "70 mm", "2.5 kN*m"))


def _wrap_spring(family: str, torque: str, bore: str, peak: str, **more: str) -> Duty:
    wants = {"required_torque": torque, "bore_diameter": bore, "peak_torque": peak, **more}
    return Duty(family, torque.replace("*", " "), wants)


DUTIES = [
    Duty("multi_plate_clutch", "5 N m", _start("5 N*m", "1500 1/min", "0.01 kg*m2")),
    Duty("multi_plate_clutch", "5 N m, dry", _start("5 N*m", "1500 1/min", "0.01 kg*m2"), {"lubrication": "dry"}),
    Duty("multi_plate_clutch", "200 N m", _start("200 N*m", "1450 1/min", "0.5 kg*m2")),
    Duty("multi_plate_clutch", "600 N m, hoist", _start("600 N*m", "254 1/min", "30 kg*m2", jerk_limit="18 rad/s3")),
    Duty("multi_plate_clutch", "20 kN m", _start("20 kN*m", "150 1/min", "800 kg*m2", slip_time_limit="6 s")),
    Duty("disc_clutch", "5 N m", _start("5 N*m", "1500 1/min", "0.02 kg*m2")),
    Duty("disc_clutch", "60 N m, car", _start("60 N*m", "1500 1/min", "0.7 kg*m2", engagements_per_hour="20 1/h")),
    Duty("disc_clutch", "200 N m", _start("200 N*m", "1500 1/min", "1 kg*m2", engagements_per_hour="20 1/h")),
    Duty("cone_clutch", "5 N m", _start("5 N*m", "1500 1/min", "0.02 kg*m2")),
    Duty("cone_clutch", "200 N m", _start("200 N*m", "700 1/min", "2 kg*m2", engagements_per_hour="30 1/h")),
    Duty(
        "electromagnetic_clutch",
        "5 N m",
        _start("5 N*m", "1500 1/min", "0.01 kg*m2"),
        fix={"ramp_time": "0.1 s", "coil_height": "10 mm", "yoke_thickness": "5 mm"},
    ),
    Duty(
        "electromagnetic_clutch",
        "40 N m",
        _start("40 N*m", "1000 1/min", "0.1 kg*m2"),
        fix={"ramp_time": "0.1 s", "coil_height": "15 mm"},
    ),
    Duty(
        "electromagnetic_clutch",
        "200 N m",
        _start("200 N*m", "750 1/min", "0.5 kg*m2"),
        fix={"ramp_time": "0.2 s", "coil_height": "15 mm", "yoke_thickness": "18 mm"},
    ),
    Duty("magnetic_powder_clutch", "5 N m", _powder("5 N*m", "1500 1/min"), fix={"powder_gap": "1.25 mm"}),
    Duty("magnetic_powder_clutch", "36 N m", _powder("36 N*m", "1000 1/min"), fix={"powder_gap": "1.25 mm"}),
    Duty("magnetic_powder_clutch", "100 N m", _powder("100 N*m", "1000 1/min"), fix={"powder_gap": "1.25 mm"}),
    Duty("roller_coupling", "20 N m", {"required_torque": "20 N*m", "driver_speed": "960 1/min", "offset": "2 mm"}),
    Duty("roller_coupling", "300 N m", {"required_torque": "300 N*m", "driver_speed": "960 1/min", "offset": "5 mm"}),
    Duty("roller_coupling", "5 kN m", {"required_torque": "5 kN*m", "driver_speed": "300 1/min", "offset": "10 mm"}),
    *CENTRIFUGAL,
    *(_wrap_spring("wrap_spring", *duty) for duty in WRAP_SPRINGS),
    *(_wrap_spring("wrap_spring_actuated", *duty, relative_speed="500 1/min") for duty in WRAP_SPRINGS),
]


@dataclass(frozen=True)
class Asked:
    """A front, and what it took: seconds on the clock and of the processor."""

    front: synth.ParetoFront
    clock: float
    processor: float


def asked(duty: Duty, practice: str, time_limit: float) -> Asked:
    """Return the front of a duty with the defaults of its family."""
    problem = synth.load(duty.family, practice=practice, **duty.options)
    synth.synthesize(problem, duty.requirements, points=1, gap=0.5, fix=duty.fix)  # compiling is not counted
    begin, busy = time.perf_counter(), time.process_time()
    front = synth.synthesize(
        problem, duty.requirements, points=POINTS, time_limit=time_limit, workers=THREADS, fix=duty.fix
    )
    return Asked(front, time.perf_counter() - begin, time.process_time() - busy)


def broken(duty: Duty, design: synth.Design) -> set[str]:
    """Return which rules a design breaks; a part that is built no more is one of them."""
    problem = synth.load(duty.family, practice="on", **duty.options)
    stated = design.to_spec()
    try:
        found = synth.evaluate(problem, duty.requirements, values=stated["values"], parts=stated["parts"])
    except synth.InputError as error:
        return {error.field}
    return set(found.violated)


def practice(time_limit: float, quick: bool) -> list[Report]:
    """Return what is rejected of each duty's front without the rules and with them."""
    rows, reasons = [], []
    for duty in DUTIES[: 1 if quick else None]:
        row: dict[str, Any] = {"family": duty.family, "duty": duty.size}
        for word in ("off", "on"):
            found = asked(duty, word, time_limit)
            front = found.front
            faults = [broken(duty, design) for design in front.designs]
            share = f"{sum(map(bool, faults))} of {len(faults)}"
            row |= {
                f"{word}: break a rule": share,
                f"{word}: s": found.clock,
                f"{word}: processor s": found.processor,
                f"{word}: certificate": front.certificate.kind,
            }
            if word == "off" and faults:
                counted = {name: sum(name in one for one in faults) for name in set().union(*faults)}
                told = ", ".join(f"{n} {k}" for n, k in sorted(counted.items(), key=lambda item: -item[1])[:4])
                reasons.append({"family": duty.family, "duty": duty.size, "rules that are broken, by designs": told})
        if front.designs:
            best = front.designs[0].values
            row |= {"#1 kg": best["mass"], "#1 mm": 1000 * best["outer_diameter"]}
        rows.append(row)
    return [
        Report("practice", rows, [f"fronts of at most {POINTS} to 0.1 %, makeable sizes, with {THREADS} threads"]),
        Report("practice: what is rejected without the rules", reasons, []),
    ]
