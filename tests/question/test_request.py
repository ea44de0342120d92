"""Every verb refuses the same wrong input with the same sentence: the records are checked, not the verbs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.errors import InputError
from synth.question.request import Request
from synth.question.settings import SearchSettings
from tests.sample_problems.strut import NEEDED, RODS, Strut


class Common(Strut):
    """A strut of which a sheet for several families may ask."""

    understands = tuple(NEEDED)


OWN = {"rods": RODS}
FRONT = synth.synthesize(Strut(), NEEDED, points=1, catalogs=OWN)
VARY = {"room": "90, 100 mm"}

ASKS: dict[str, Callable[..., Any]] = {
    "synthesize": lambda needed=NEEDED, **more: synth.synthesize(Strut(), needed, catalogs=OWN, **more),
    "whatif": lambda needed=NEEDED, **more: synth.whatif(Strut(), needed, VARY, catalogs=OWN, **more),
    "explain": lambda needed=NEEDED, **more: synth.explain(Strut(), needed, catalogs=OWN, **more),
    "compare": lambda needed=NEEDED, **more: synth.compare([Common()], needed, catalogs=OWN, **more),
    "batch": lambda needed=NEEDED, **more: synth.batch(Strut(), [dict(needed)], catalogs=OWN, **more),
    "near_equals": lambda **more: synth.near_equals(FRONT, 1, **more),
    "prices": lambda **more: synth.prices(FRONT, **more),
    "rate": lambda **more: synth.rate(FRONT, {"load": "+-5 %"}, **more),
    "improve": lambda **more: FRONT.improve(**more),
}
SEARCHING = ("synthesize", "whatif", "compare", "batch")
ASKING = (*SEARCHING, "explain")
ALL = tuple(ASKS)


def sentence(run: Callable[[], Any]) -> str:
    with pytest.raises(InputError) as fault:
        run()
    return str(fault.value)


@pytest.mark.parametrize(
    ("wrong", "verbs"),
    [
        ({"points": 0}, SEARCHING),
        ({"points": 2.5}, SEARCHING),
        ({"gap": 0.6}, SEARCHING),
        ({"gap": True}, SEARCHING),
        ({"gap": float("nan")}, SEARCHING),
        ({"grid": "no"}, ASKING),
        ({"workers": 0}, (*SEARCHING, "improve")),
        ({"seed": -1}, (*ASKING, "near_equals")),
        ({"seed": 0.5}, (*ASKING, "near_equals")),
        ({"time_limit": 0}, ALL),
        ({"time_limit": "soon"}, ALL),
        ({"time_limit": float("inf")}, ALL),
        ({"progress": 5}, ALL),
        ({"limits": [1]}, ASKING),
        ({"fix": 5}, ASKING),
        ({"parts": "rod"}, ASKING),
        ({"needed": [1]}, ("synthesize", "whatif", "explain", "compare")),
        ({"robust": 5}, ("synthesize", "whatif", "explain")),
        ({"robust": {}}, ("synthesize", "whatif", "explain")),
        ({"weights": 5}, ("synthesize", "whatif", "compare")),
        ({"limits": {"mass": "small"}}, ("synthesize", "whatif", "explain", "compare")),
        ({"needed": {**NEEDED, "load": "5 kg"}}, ("synthesize", "whatif", "explain", "compare")),
    ],
    ids=lambda x: str(x)[:40],
)
def test_every_verb_refuses_the_same_with_the_same_sentence(
    wrong: dict[str, Any], verbs: tuple[str, ...], tmp_path: Path
) -> None:
    said = {verb: sentence(lambda: ASKS[verb](**wrong)) for verb in verbs}  # noqa: B023
    assert len(set(said.values())) == 1, said


def test_records_refuse_what_the_verbs_refuse() -> None:
    assert sentence(lambda: SearchSettings(points=0)) == sentence(lambda: ASKS["synthesize"](points=0))
    assert sentence(lambda: Request.of(Strut(), 5)) == sentence(lambda: ASKS["synthesize"](5))  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        SearchSettings(30)  # type: ignore[misc]


def test_a_table_in_memory_is_in_no_spec() -> None:
    request = Request.of(Strut(), NEEDED, OWN)
    assert "rods" in sentence(request.to_json)


def test_designs_and_several_families_are_no_request() -> None:
    shelf = {"family": "disc_clutch", "requirements": {}}
    assert "without values" in sentence(lambda: Request.from_json({**shelf, "values": {"a": 1}}))
    assert "one family" in sentence(lambda: Request.from_json({**shelf, "family": ["disc_clutch", "cone_clutch"]}))
    assert "one family" in sentence(lambda: Request.from_json({**shelf, "family": "any"}))
    assert "request: key" in sentence(lambda: Request.from_json({**shelf, "colour": 1}))
    assert "request: points" in sentence(lambda: SearchSettings.from_json({"points": 0}, "request"))
