"""Fronts of thirty designs over the shipped catalogues, family by family."""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import synth
from synth.question.spec import read_spec
from tests.benchmarks.tables import Report

POINTS = 30
EXAMPLES = Path(__file__).parents[2] / "examples"
THREADS = 2
# Asked as the example asks, with all parts open, and again with all sizes open as well.
SHIPPED = (
    "centrifugal_ball_ramp",
    "centrifugal_two_spring",
    "centrifugal_lever",
    "centrifugal_reversed",
    "powder_winder",
    "electromagnetic_spindle",
)


@dataclass(frozen=True)
class Question:
    """What is asked of a family; without objectives its defaults."""

    family: str
    objectives: Sequence[str]
    requirements: Mapping[str, Any]
    options: Mapping[str, str] = field(default_factory=dict)
    given: Mapping[str, Any] = field(default_factory=dict)  # parts, fix, limits


MILL = {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"}
SKEW = {**MILL, "shaft_angle": "2 deg", "float_distance": "50 mm", "guide_angle": "75 deg"}
CAR = {
    "load_torque": "60 N*m",
    "driver_speed": "1500 1/min",
    "driven_inertia": "0.7 kg*m2",
    "safety_factor": 2.5,
    "engagements_per_hour": "20 1/h",
    "startup_torque": "120 N*m",
    "jerk_limit": "300 rad/s3",
    "outer_diameter_limit": "240 mm",
}
DRIVE = {
    "load_torque": "200 N*m",
    "driver_speed": "700 1/min",
    "driven_inertia": "2 kg*m2",
    "engagements_per_hour": "30 1/h",
    "jerk_limit": "600 rad/s3",
    "outer_diameter_limit": "400 mm",
}
QUESTIONS = [
    Question("disc_clutch", ("mass", "actuation_force"), CAR),
    Question("cone_clutch", ("mass", "actuation_force"), DRIVE),
    Question("roller_coupling", ("outer_diameter", "pin_force"), MILL),
    Question("roller_coupling", ("mass", "pin_force"), MILL),
    Question("roller_coupling", ("mass", "offset_capacity"), MILL),
    Question(
        "roller_coupling", ("mass", "pin_force"), {**MILL, "required_torque": "2 kN*m"}, {"roller_contact": "crowned"}
    ),
    Question("roller_coupling", ("outer_diameter", "pin_force"), SKEW),
]


def example(name: str, kept: Sequence[str] = ("parts", "fix", "limits")) -> Question:
    """Return the question of a shipped example, with as much as is kept of what it says of parts and sizes."""
    spec = read_spec(EXAMPLES / f"{name}.yaml")
    given = {key: dict(getattr(spec, key) or {}) for key in kept}
    return Question(spec.family, tuple(spec.objectives or ()), spec.requirements, spec.options, given)


def questions() -> list[Question]:
    """Return all questions: those stated here, and the examples of the other families, as shipped and opened."""
    found = list(QUESTIONS)
    for name in SHIPPED:
        asked = [example(name), example(name, ("fix", "limits")), example(name, ())]
        found += [q for k, q in enumerate(asked) if not any(_said(q) == _said(other) for other in asked[:k])]
    return found


def _said(question: Question) -> dict[str, Any]:
    return {key: own for key, own in question.given.items() if own}


def measure(question: Question, repeat: int, time_limit: float, points: int = POINTS) -> dict[str, Any]:
    """Return seconds and certificate of one question; the first call, which traces and compiles, stands apart."""
    problem = synth.load(question.family, **question.options)
    used, passed = [], []
    for _ in range(repeat + 1):
        processor, clock = time.process_time(), time.perf_counter()
        front = synth.synthesize(
            problem,
            question.requirements,
            objectives=list(question.objectives) or None,
            points=points,
            time_limit=time_limit,
            workers=THREADS,
            **question.given,
        )
        used.append(time.process_time() - processor)
        passed.append(time.perf_counter() - clock)
    return {
        "family": question.family,
        "options": ", ".join(question.options.values()) or "-",
        "given": ", ".join(key for key, own in question.given.items() if own) or "-",
        "objectives": ", ".join(front.frame.objectives),
        "combinations": front.certificate.combinations,
        "designs": len(front.designs),
        "certificate": front.certificate.kind,
        "processor s": statistics.median(used[1:]),
        "seconds": statistics.median(passed[1:]),
        "first call s": passed[0],
    }


def families(repeat: int, time_limit: float, quick: bool) -> list[Report]:
    """Return the table of all questions, or of the first one."""
    rows = [measure(q, 1 if quick else repeat, time_limit) for q in questions()[: 1 if quick else None]]
    return [Report("families", rows, [f"to a gap of 0.1 %, makeable sizes, {THREADS} threads"])]
