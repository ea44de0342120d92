"""What a designer would send back of the first three designs of each duty, by rules that no model reads."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import synth
from tests.benchmarks.families import SHIPPED, example
from tests.benchmarks.practice import DUTIES, Duty
from tests.benchmarks.tables import Report

LOOKED_AT = 3  # designs of a front
POINTS = 10
ROUNDING = 1 + 1e-9  # a design at its limit is not above it
RAMP = (0.010 * ROUNDING, 2.0 / ROUNDING)  # s; faster or slower than what presses without a word of the user
SURFACE_RISE = 160.0  # K, mean over hours, of a dry lining on iron
COIL_RISE = 80.0  # K, class F by resistance
HEAVIEST_POWDER = (2.5 * 0.45, 0.85)  # kg: factor and power of the torque [N m]; units on the market have 0.45 M^0.85
# Mean pressure [N/mm2] that linings see in machines, and not in catalogues; duty and heat, E4.
PRACTICAL = {
    "woven_dry": 0.30,
    "wound_yarn_dry": 0.35,
    "moulded_dry": 0.45,
    "aramid_dry": 0.50,
    "moulded_dry_heavy": 0.70,
    "sinter_bronze_dry": 0.70,
    "sinter_iron_dry": 0.70,
    "carbon_graphite_dry": 0.70,
    "metal_ceramic_bronze_dry": 0.50,
    "cermet_dry": 0.50,
    "cc_composite_dry": 1.0,
    "paper_wet": 1.0,
}
GALLS = ("millboard_dry", "steel_steel_dry", "hardened_steel_dry", "nitrocarburised_steel_dry")


def _ramp(duty: Duty, design: synth.Design) -> bool:
    ramp = design.values.get("ramp_time")
    return ramp is not None and "ramp_time" not in duty.fix and not RAMP[0] < ramp < RAMP[1]


def _surface(_: Duty, design: synth.Design) -> bool:
    return design.values.get("mean_temperature_rise", 0.0) > SURFACE_RISE


def _coil(_: Duty, design: synth.Design) -> bool:
    return design.values.get("coil_temperature_rise", 0.0) > COIL_RISE * ROUNDING


def _pressure(_: Duty, design: synth.Design) -> bool:
    pressure = design.values.get("surface_pressure", design.values.get("lining_pressure", 0.0))
    return pressure > 1e6 * PRACTICAL.get(_lining(design), float("inf")) * ROUNDING


def _galls(_: Duty, design: synth.Design) -> bool:
    return _lining(design) in GALLS


def _heavy_powder(_: Duty, design: synth.Design) -> bool:
    factor, power = HEAVIEST_POWDER
    return "powder" in design.parts and design.values["mass"] > factor * design.values["torque"] ** power


def _lining(design: synth.Design) -> str:
    return str(design.parts["friction_pair"]) if "friction_pair" in design.parts else ""


RULES: Mapping[str, Callable[[Duty, synth.Design], bool]] = {
    "ramp of 10 ms and less or 2 s and more": _ramp,
    "surface hotter than 160 K": _surface,
    "coil hotter than 80 K": _coil,
    "lining above its practical pressure": _pressure,
    "millboard, dry steel on steel": _galls,
    "powder clutch too heavy": _heavy_powder,
}


def shipped() -> list[tuple[Duty, Mapping[str, Any]]]:
    """Return the shipped examples as duties, with all that their specs say."""
    found = []
    for name in SHIPPED:
        asked = example(name)
        given = {key: value for key, value in asked.given.items() if value}
        duty = Duty(asked.family, name, asked.requirements, asked.options, given.pop("fix", {}))
        found.append((duty, {**given, "objectives": list(asked.objectives) or None}))
    return found


def sent_back(time_limit: float, quick: bool) -> list[Report]:
    """Return the share of looked-at designs that break a rule, by family and by duty, with seconds and certificate."""
    rows = []
    for duty, more in [*((duty, {}) for duty in DUTIES), *shipped()][: 1 if quick else None]:
        problem, begin = synth.load(duty.family, **duty.options), time.perf_counter()
        front = synth.synthesize(
            problem, duty.requirements, points=POINTS, time_limit=time_limit, fix=duty.fix or None, **more
        )
        designs = front.designs[:LOOKED_AT]
        broken = [[name for name, rule in RULES.items() if rule(duty, design)] for design in designs]
        rows.append(
            {
                "family": duty.family,
                "duty": duty.size,
                "designs": len(designs),
                "sent back": sum(map(bool, broken)),
                "why": ", ".join(dict.fromkeys(name for one in broken for name in one)) or "-",
                "#1 kg": designs[0].values.get("mass") if designs else None,
                "s": time.perf_counter() - begin,
                "certificate": front.certificate.kind,
            }
        )
    remarks = [f"the first {LOOKED_AT} designs of fronts of {POINTS} points; rules of practice as by default"]
    return [Report("sent back, by family", _by_family(rows), remarks), Report("sent back, by duty", rows)]


def _by_family(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    names = dict.fromkeys(row["family"] for row in rows)
    grouped = [(name, [row for row in rows if row["family"] == name]) for name in names] + [("all", list(rows))]
    return [
        {
            "family": name,
            "duties": len(own),
            "without a design": sum(not row["designs"] for row in own),
            "designs": (count := sum(row["designs"] for row in own)),
            "sent back": (back := sum(row["sent back"] for row in own)),
            "share": f"{back / count:.0%}" if count else "-",
            "s (median)": statistics.median(row["s"] for row in own),
            "global": sum(row["certificate"] == "global" for row in own),
        }
        for name, own in grouped
    ]
