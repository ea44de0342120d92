"""Records for tests of the explorer: a real front, one with many designs, one with hostile texts everywhere."""

from __future__ import annotations

import copy
import random
from functools import cache
from typing import Any

from synth.reports.explorer.record import explorer_record

import synth
from synth.results.report_request import ReportRequest

HOSTILE = "</script><img src=x onerror=alert(1)>\u202egnp.exe\u2066 <b>&amp;`${1}`"
ASKED = {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"}


@cache
def small_front() -> synth.ParetoFront:
    """Return a front of a few designs with different parts."""
    return synth.synthesize(
        "multi_plate_clutch",
        ASKED,
        parts={"friction_pair": ["sinter_bronze_wet", "paper_wet"], "inner_plate": ["core 2", "core 3"]},
        fix={"ramp_time": "2 s"},
        objectives=["mass", "actuation_force"],
        points=8,
    )


@cache
def empty_front() -> synth.ParetoFront:
    """Return a front without a design."""
    parts = {"friction_pair": ["paper_wet"], "inner_plate": ["core 3"], "outer_plate": ["core 3"]}
    return synth.synthesize("multi_plate_clutch", ASKED, parts=parts, limits={"outer_diameter": "<= 90 mm"}, points=2)


@cache
def _record() -> dict[str, Any]:
    front = small_front()
    return explorer_record(ReportRequest(calculation=synth.calculation(front), front=front))


def small_record() -> dict[str, Any]:
    """Return the record of a real front."""
    return copy.deepcopy(_record())


def empty_record() -> dict[str, Any]:
    """Return the record of a front without a design."""
    return explorer_record(ReportRequest(calculation=synth.calculation(empty_front()), front=empty_front()))


def grown(count: int) -> dict[str, Any]:
    """Return a record of so many designs, made of those of a real front."""
    record, draw = small_record(), random.Random(7)
    models = record["designs"]
    designs = []
    for k in range(count):
        own = copy.deepcopy(models[k % len(models)])
        own["rank"], own["note"] = k + 1, "knee" if k == 0 else ""
        own["v"] = [None if v is None else float(f"{v * draw.uniform(0.8, 1.25):.7g}") for v in own["v"]]
        designs.append(own)
    return record | {"designs": designs}


def hostile_record() -> dict[str, Any]:
    """Return a record in which every text that a user or a table may have written is hostile."""
    record = small_record()
    rows = {key: f"{HOSTILE} {number}" for number, key in enumerate(record["parts"])}

    def spoilt(told: Any, key: str = "") -> Any:
        if isinstance(told, dict):
            return {k: spoilt(v, k) for k, v in told.items()}
        if isinstance(told, list):
            return [spoilt(v, key) for v in told]
        return HOSTILE if isinstance(told, str) and key not in KEPT else told

    designs = [spoilt(d) | {"parts": {s: rows[p] for s, p in d["parts"].items()}} for d in record["designs"]]
    for own in designs:
        own |= {
            "remarks": [HOSTILE],
            "alternatives": [HOSTILE],
            "next": [[HOSTILE, HOSTILE]],
            "choices": {HOSTILE: HOSTILE},
        }
        own |= {"files": [[HOSTILE, "javascript:alert(2)"], ["Sheet", "design_01_sheet.html"]]}
        own |= {"drawing": "<svg xmlns='http://www.w3.org/2000/svg' onload='alert(3)'><script>alert(4)</script></svg>"}
    parts = {rows[key]: spoilt(part) | {"name": f"{HOSTILE} {key}"} for key, part in record["parts"].items()}
    objectives = record["objectives"]
    return spoilt(record) | {"designs": designs, "parts": parts, "objectives": objectives, "spec": {HOSTILE: HOSTILE}}


KEPT = {"name", "kind", "level", "sign", "status", "note", "at_limit"}  # what is compared, not shown
