"""Any JSON at any place of a request of any kind: it is read, or refused in sentences; nothing else."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import ExtraNeededError, InputError
from synth.kinds import KINDS, Sources, batch
from synth.question.request_fields import FIELDS
from synth.verbs.requests import VERBS, design_schema
from synth.workers.engine_questions import check, evaluate
from synth.workers.engine_work import read
from tests.kinds.jobs import DISC, PAIR, SPECS, disc, pair
from tests.repetitions import repetitions

pytestmark = pytest.mark.slow
DESIGN = design_schema()
REQUESTS = {name: verb.schema() for name, verb in VERBS.items()}
DUTY = DISC["requirements"]
LECTURE = SPECS["lecture_design"]
SPREAD = {"friction": "catalogue range", "tolerance": {}, "mode": "rate", "samples": 64, "seed": 1, "confidence": 0.9}
# What is right, to be taken apart: between them they have every key.
RIGHT: Mapping[str, list[dict[str, Any]]] = {
    "synthesis": [
        {**DISC, "limits": {"mass": ["<= 30 kg"]}, "weights": {"mass": 1}, "robust": {"friction": "+-1 %"}},
        {**DISC, "options": {}, "catalogs": {}, "grid": False, "gap": 0.01, "seed": 1, "time_limit": "2 min"},
        {"of": "front", "points": 2, "limits": {"mass": "<= 30 kg"}, "workers": 1},
    ],
    "compare": [PAIR, {**PAIR, "family": ["disc_clutch", {"family": "multi_plate_clutch", "options": {}, "fix": {}}]}],
    "whatif": [
        {**DISC, "vary": {"load_torque": "50, 60 N*m"}, "breaks": False},
        {**DISC, "vary": {"load_torque": {"from": "50 N*m", "to": "60 N*m", "count": 3}}},
        {"of": "front", "vary": {"mass <=": ["30 kg", "40 kg"], "robust.friction": ["+-5:10:5 %"]}},
    ],
    "explain": [{**DISC, "physics": True}, {"of": "front", "limits": {"mass": "<= 1 kg"}}],
    "prices": [{"of": "front", "design": [1], "step": "1 %", "time_limit": 3}],
    "near_equals": [{"of": "front", "design": 1, "within": "10 %", "count": 5, "seed": 1, "time_limit": "2 min"}],
    "rate": [
        {"of": "pair", "family": "disc_clutch", "design": 1, "robust": SPREAD, "time_limit": 1},
        {**LECTURE, "robust": {"friction": "catalogue range"}},
    ],
    "verify": [{"of": "front", "time_limit": 3}, {"of": "pair", "family": "disc_clutch"}],
    "report": [
        {"of": "front", "formats": ["html"], "design": ["1"], "full": 1, "length": "full", "about": {"project": "x"}},
        {"of": "pair"},
    ],
    "batch": [
        {
            "family": "disc_clutch",
            "rows": [{**DUTY, "note": "x"}],
            "mapping": {"note": "carry"},
            "objectives": ["mass"],
        },
        {"family": "disc_clutch", "rows": [DUTY], "points": 1, "gap": 0.01, "grid": True, "seed": 0, "time_limit": 1}
        | {"parts": {}, "limits": {"mass": "<= 30 kg"}, "fix": {}, "catalogs": {}},
    ],
    "size_range": [
        {"of": "front", "variants": 3, "objective": "mass", "per_row": [], "candidates": 5, "gap": 0, "time_limit": 1}
    ],
}
CASES = [(kind, request) for kind, requests in RIGHT.items() for request in requests]
# Names and texts that mean something somewhere, and such as are nearly right.
NAMES = (
    *FIELDS,
    "of",
    "vary",
    "from",
    "to",
    "count",
    "near",
    "friction",
    "mass",
    "load_torque",
    "friction_pair",
    "",
    "x",
)
TEXTS = (
    *NAMES,
    "front",
    "pair",
    "disc_clutch",
    "any",
    "+",
    "x@1",
    "60 N*m",
    "1e400 N*m",
    "nan",
    "<= 3 kg",
    "<=",
    "1:2:1",
)
TEXTS += ("2 %", "+-5 %", "1 .. 2", "catalogue range", "knee", "((((", "1,5", "1/0 kg", "\u202e", "a\u2028b", "x" * 200)
NUMBERS = (0, 1, -1, 2, 0.5, 1e-300, -0.0, 1e308, 2**53, 10**30, 10**400)
JSON = st.recursive(
    st.none() | st.booleans() | st.sampled_from(NUMBERS) | st.sampled_from(TEXTS) | st.text("ab1 .:-%", max_size=6),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(TEXTS), inner, max_size=3),
    max_leaves=6,
)


def places(value: Any, place: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where something stands in JSON."""
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in entries:
        yield (*place, key)
        yield from places(inner, (*place, key))


@st.composite
def requests(draw: st.DrawFn) -> tuple[str, Any]:
    """Draw a right request with other JSON at one to three places, under another key, or one more entry."""
    kind, right = draw(st.sampled_from(CASES))
    request = copy.deepcopy(right)
    for _ in range(draw(st.integers(1, 3))):
        *way, last = draw(st.sampled_from(list(places(request)) or [("of",)]))
        holder = request
        for key in way:
            holder = holder[key]
        value = draw(JSON)
        act = draw(st.sampled_from(("other", "nested", "renamed", "more", "typed")))
        if act == "renamed" and isinstance(holder, dict):
            holder[draw(st.sampled_from(NAMES))] = holder.pop(last, None)
        elif act == "more" and isinstance(holder, dict):
            holder[draw(st.sampled_from(NAMES))] = value
        elif act == "nested":
            holder[last] = draw(st.sampled_from(([holder[last]], {"near": holder[last]}))) if way else [holder[last]]
        elif act == "typed" and isinstance(holder[last], str):
            cut = draw(st.integers(0, len(holder[last])))
            holder[last] = holder[last][:cut] + draw(st.text("0 .,:%-=<>()*/e", max_size=2)) + holder[last][cut + 1 :]
        else:
            holder[last] = value
    return kind, draw(st.sampled_from([request] * 20 + [draw(JSON)]))


def sources() -> Sources:
    return Sources(records={"front": disc(), "pair": pair()})


def answer(ask: Callable[..., Any], **payload: Any) -> bool:
    """Tell whether something is answered; refused it must be in sentences that JSON holds."""
    try:
        ask({"sources": sources(), **payload}, lambda state: None)
    except (InputError, ExtraNeededError) as fault:
        told = [one.told() for one in fault.every()]
        assert all(one["message"] for one in told)
        json.dumps(told, allow_nan=False).encode()
        return False
    return True


def stated(request: Any) -> Any:
    """Return a request without entries that are null: those count as not stated."""
    if isinstance(request, list):
        return [stated(value) for value in request]
    if not isinstance(request, dict):
        return request
    return {key: stated(value) for key, value in request.items() if value is not None}


def fits(request: Any, schema: Mapping[str, Any]) -> None:
    jsonschema.validate(stated(request), schema)


@pytest.mark.parametrize(("kind", "request_"), CASES)
def test_what_is_right_fits_its_schema_and_is_taken(kind: str, request_: dict[str, Any]) -> None:
    fits(request_, REQUESTS[kind])
    assert answer(read, kind=kind, request=request_) == (kind != "size_range")  # which needs a batch in a database


def test_every_kind_has_a_schema() -> None:
    assert list(REQUESTS) == list(KINDS) == list(RIGHT)
    for kind, schema in REQUESTS.items():
        keys = {key for way in [*schema.get("anyOf", []), schema] for key in way.get("properties", ())}
        assert set(KINDS[kind].keys) <= keys
    assert set(DESIGN["properties"]) == set(FIELDS)


@pytest.mark.parametrize(
    ("kind", "request_", "path"),
    [
        ("synthesis", {"family": [{"x": 1}]}, ("family", 0, "x")),
        ("whatif", {"vary": {"near": "1", "vary": "2"}}, ("family",)),
        ("whatif", "a", ()),
        ("explain", [], ()),
        ("synthesis", {"of": "front", "points": {"x": 2}}, ("points",)),
        ("verify", {"of": "pair", "family": [[]]}, ("family",)),
        ("verify", {"of": "front", "time_limit": 10**400}, ("time_limit",)),
        ("rate", {"of": "front", "robust": [{}]}, ("robust",)),
        ("synthesis", {**DISC, "robust": {**SPREAD, "tolerance": []}}, ("robust", "tolerance")),
        ("batch", {"family": "disc_clutch", "rows": [DUTY], "objectives": True}, ("objectives",)),
        ("synthesis", {"of": "front", "requirements": "600 N*m"}, ("requirements",)),
        ("whatif", {**DISC, "vary": {"load_torque": {"from": "1 N*m"}, "mass <=": "3 kg"}}, ("vary", "load_torque")),
        ("rate", {**LECTURE, "robust": SPREAD, "workers": 4}, ("workers",)),
        ("report", {"of": "front", "about": {"number": 1.1}}, ("about", "number")),
    ],
)
def test_what_broke_the_reader_is_refused_where_it_stands(kind: str, request_: Any, path: tuple[Any, ...]) -> None:
    with pytest.raises(InputError) as caught:
        read({"kind": kind, "request": request_, "sources": sources()}, lambda state: None)
    assert path in [fault.path for fault in caught.value.every()]


def test_null_takes_an_entry_of_an_earlier_job_back() -> None:
    payload = {"kind": "synthesis", "sources": sources()}
    read_now = read({**payload, "request": {"of": "front", "requirements": {"top_speed": None}}}, lambda state: None)
    assert {*DUTY} - {*read_now["request"]["requirements"]} == {"top_speed"}


@given(requests())
@settings(deadline=None, derandomize=True, max_examples=repetitions(100, 20_000))
def test_any_request_is_read_or_refused_and_what_is_read_fits_its_schema(drawn: tuple[str, Any]) -> None:
    kind, request = drawn
    if answer(read, kind=kind, request=request):
        fits(request, REQUESTS[kind])


@given(requests())
@settings(deadline=None, derandomize=True, max_examples=repetitions(40, 5_000))
def test_any_request_is_checked_as_a_spec_as_a_design_and_as_rows(drawn: tuple[str, Any]) -> None:
    _, request = drawn
    assert answer(check, request=request)
    if answer(evaluate, request=request):
        fits(request, DESIGN)
    if answer(batch.check, request=request):
        fits(request, REQUESTS["batch"])
