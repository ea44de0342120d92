"""Jobs as a worker does them, on a question that is answered in a fraction of a second."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

from synth.kinds import Sources, kind
from synth.question.examples import examples
from synth.workers.engine_work import work

SPECS: dict[str, dict[str, Any]] = {one.name: one.spec for one in examples()}
DISC = {**SPECS["automobile_disc"], "points": 4}
PAIR = {
    "family": ["multi_plate_clutch", "disc_clutch"],
    "requirements": {
        "load_torque": "600 N*m",
        "driver_speed": "26.6 rad/s",
        "driven_inertia": "30 kg*m2",
        "engagements_per_hour": "50 1/h",
    },
    "fix": {"ramp_time": "2 s"},
    "points": 3,
    "gap": 0.05,
}


def done(name: str, request: Mapping[str, Any], sources: Sources | None = None) -> dict[str, bytes]:
    """Return the records of a job; the request goes through its stored text, and progress through JSON."""
    sources = sources or Sources()
    one = kind(name)
    posed = one.load().read(request, sources)
    asked = json.loads(posed.text)
    told: list[str] = []
    payload = {"kind": name, "request": asked, "sources": sources}
    answer = work(payload, lambda state: told.append(json.dumps(state)))
    assert told, "nothing was told on the way"
    kept = {record.name: record.content for record in answer["records"]}
    assert {one.record, "question.json"} <= set(kept)
    assert json.loads(kept["question.json"])["request"] == asked
    json.dumps(answer["summary"], allow_nan=False)
    return kept


@cache
def disc() -> dict[str, bytes]:
    """Return the records of a front, searched once."""
    return done("synthesis", DISC)


@cache
def pair() -> dict[str, bytes]:
    """Return the records of a comparison, made once."""
    return done("compare", PAIR)


def earlier() -> Sources:
    """Return sources with the front as job ``front``."""
    return Sources(records={"front": disc()})


def summary(name: str, records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return what lists tell of the records of a job."""
    found = kind(name).load().summary(records)
    assert isinstance(found, dict)
    return found
