"""A request alone: each verb gives the same by its function and by the request that a job takes."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.errors import InputError
from synth.verbs.requests import VERBS
from tests.kinds.jobs import DISC, PAIR

QUESTION = {key: value for key, value in DISC.items() if key not in ("family", "requirements")}
FEW = {**DISC, "points": 1, "objectives": ["mass"]}
TOO_FEW = {"actuation_force": "<= 100 N"}
Asked = tuple[dict[str, Any], Callable[[Path], Any]]


@cache
def front() -> synth.ParetoFront:
    return synth.synthesize(DISC["family"], DISC["requirements"], **QUESTION)


@cache
def table() -> synth.BatchResult:
    return synth.batch(DISC["family"], rows(), points=1)


def rows() -> list[dict[str, Any]]:
    return [{**DISC["requirements"], "load_torque": torque} for torque in ("50 N*m", "60 N*m")]


def asked(verb: str) -> Asked:
    """Request of a verb, and the call of its function that means the same."""
    family, duty = DISC["family"], DISC["requirements"]
    vary = {"load_torque": {"from": "50 N*m", "to": "60 N*m", "count": 2}}
    few = {key: value for key, value in FEW.items() if key not in ("family", "requirements")}
    pair = {key: value for key, value in PAIR.items() if key not in ("family", "requirements")}
    plain = {key: value for key, value in few.items() if key in ("parts", "limits", "fix", "seed", "time_limit")}
    robust = {"load_torque": "+-1 %"}
    return {
        "synthesis": (DISC, lambda place: synth.synthesize(family, duty, **QUESTION)),
        "compare": (PAIR, lambda place: synth.compare(PAIR["family"], PAIR["requirements"], **pair)),
        "whatif": (
            {"of": FEW, "vary": vary, "breaks": False},
            lambda place: synth.whatif(family, duty, {"load_torque": ("50 N*m", "60 N*m", 2)}, **few, breaks=False),
        ),
        "explain": (
            {"of": FEW, "limits": TOO_FEW},
            lambda place: synth.explain(family, duty, **{**plain, "limits": TOO_FEW}),
        ),
        "prices": ({"of": front(), "design": 1, "step": "2 %"}, lambda place: synth.prices(front(), 1, "2 %")),
        "near_equals": (
            {"of": front(), "within": "5 %", "count": 2},
            lambda place: synth.near_equals(front(), 1, "5 %", count=2),
        ),
        "rate": ({"of": front(), "robust": robust}, lambda place: synth.rate(front(), robust)),
        "verify": ({"of": front()}, lambda place: synth.verify(front())),
        "report": (
            {"of": front(), "length": "summary", "full": 0},
            lambda place: front().report(place, length="summary", full=0),
        ),
        "batch": ({"family": family, "rows": rows(), "points": 1}, lambda place: table()),
        "size_range": ({"of": table(), "variants": 1}, lambda place: synth.size_range(table(), 1)),
    }[verb]


def told(found: Any) -> Any:
    """What a result says, without what no two runs share."""
    if isinstance(found, Path):
        return sorted(path.name for path in found.iterdir())
    if isinstance(found, synth.BatchResult):
        return found.rows().drop(columns=["seconds"], errors="ignore").to_dict("list")
    if not hasattr(found, "files"):
        return found.verdict, found.designs, found.findings, found.proven_gap
    files = {name: text for name, text in found.files().items() if name.endswith((".csv", ".yaml"))}
    assert files
    return files


@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
def test_a_request_alone_gives_what_the_function_gives(verb: str, tmp_path: Path) -> None:
    request, called = asked(verb)
    more = {"folder": tmp_path / "request"} if verb == "report" else {}
    assert told(synth.run(verb, request, **more)) == told(called(tmp_path / "called"))


@pytest.mark.parametrize(
    ("kind", "request_", "said"),
    [
        ("prize", {}, "kind: got 'prize'; expected one of synthesis, compare"),
        ("prices", {"of": "x", "steps": 3}, "request: key: got 'steps'; expected one of design, step"),
        ("synthesis", {**DISC, "physics": True}, "request: key: got 'physics'"),
        ("synthesis", {**DISC, "family": "any"}, "family: got 'any'; expected"),
        ("compare", DISC, "family: got 'disc_clutch'; expected 'any', or a list of families"),
        ("whatif", DISC, "request: vary: is missing; expected names with values"),
        ("batch", {"family": "disc_clutch"}, "request: upload: is missing; expected the id of a file"),
    ],
)
def test_what_is_no_request_is_refused(kind: str, request_: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        synth.run(kind, request_)
    assert said in str(caught.value)
