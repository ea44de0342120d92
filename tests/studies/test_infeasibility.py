"""What would make a question feasible: refusals with amounts, what was asked gives way, and patches of the spec."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import synth
from synth.declaration import Declaration
from synth.question.spec_patch import patched
from synth.units import parse_quantity


class Bracket(synth.DesignProblem):
    """A bracket with one of everything that may be asked of it."""

    name, title = "bracket", "Bracket"

    def declare(self, d: Declaration) -> None:
        """Declare it."""
        load = d.requirement("load", "N", lower=1, upper=1e6, symbol="F", text="Load")
        room = d.requirement("room", "mm", lower=5, upper=500, symbol="h_max", text="Room", default=200)
        least = d.requirement("least", "mm", lower=1, upper=500, text="Least height", default=2)
        width = d.variable("width", "mm", 5, 100, grid=1, symbol="b", text="Width")
        height = d.variable("height", "mm", 1, 300, symbol="h", text="Height")
        tilt = d.variable("tilt", "deg", -30, 30, text="Tilt")
        arms = d.count("arms", 1, 12, symbol="z", text="Arms")
        finish = d.choice("finish", ("raw", "painted"), text="Finish")
        steel = d.part("steel", "metals", text="Material")
        d.refuse("no_room", room <= least, "a room above least")
        d.refuse("too_weak", load / 4e5 > steel.yield_Re / 2e8, "a stronger steel or less load")
        d.derive("mass", "kg", 7850 * arms * width * height * 0.2, symbol="m", text="Mass")
        d.derive("slant", "deg", 2 * tilt, text="Slant of the face")
        allowed = finish.select({"raw": 0.5, "painted": 1.0}) * steel.yield_Re
        d.at_most("bending", 6 * load * 0.2 / (arms * width * height**2), allowed, "N/mm2", source="statics")
        d.at_most("envelope", height, room, "mm", source="geometry")
        d.at_most("slenderness", height / width, 8.0, "-", source="practice")
        d.objective("mass", "min")


QUESTIONS: dict[str, dict[str, Any]] = {
    "limits and a requirement": {
        "requirements": {"F": "20 kN", "room": "20 mm"},
        "limits": {"m": "<= 2 kg", "b": ["<= 40 mm", ">= 10 mm"]},
    },
    "several limits on one quantity": {
        "requirements": {"load": "60 kN"},
        "limits": {"mass": [">= 1 kg", "<= 1.5 kg"], "height": "10 mm .. 25 mm"},
    },
    "pins": {"requirements": {"load": "20 kN"}, "fix": {"h": "20 mm", "width": "20 mm", "z": 2}},
    "counts": {"requirements": {"load": "60 kN"}, "limits": {"arms": "<= 2", "h": "<= 30 mm", "b": "<= 30 mm"}},
    "a set of counts": {"requirements": {"F": "60 kN"}, "limits": {"arms": [1, 2], "h": "<= 30 mm", "b": "<= 30 mm"}},
    "words and parts": {
        "requirements": {"load": "20 kN"},
        "limits": {"mass": "<= 3 kg"},
        "fix": {"finish": "raw", "arms": 1},
        "parts": {"steel": ["S185"]},
    },
    "below zero": {"requirements": {"load": "1 kN"}, "limits": {"tilt": "<= -5 deg", "slant": ">= -4 deg"}},
    "refused": {"requirements": {"load": "1 kN", "room": "10 mm", "least": "30 mm"}},
    "refused on its edge": {"requirements": {"load": "1 kN", "room": "30 mm", "least": "30 mm"}},
    "refused for every row": {"requirements": {"load": "400 kN"}, "parts": {"steel": ["S185"]}},
    "scattering": {
        "requirements": {"load": "20 kN"},
        "limits": {"mass": "<= 0.5 kg", "height": "<= 30 mm"},
        "robust": {"load": "+-5 %"},
    },
}
QUICK = ("pins", "below zero", "refused", "refused on its edge", "refused for every row")
BASE = {"parts": {"steel": ["S185", "42CrMo4"]}}


def question(name: str) -> dict[str, Any]:
    return {**BASE, **QUESTIONS[name]}


@cache
def explained(name: str) -> synth.Explanation:
    """Return why a question has no answer; several tests read the same one."""
    return synth.explain(Bracket(), **question(name))


def is_feasible(spec: dict[str, Any]) -> bool:
    return bool(synth.synthesize(Bracket(), points=1, gap=0.2, **spec).designs)


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n in QUICK else [pytest.mark.slow]) for n in QUESTIONS])
def test_every_patch_makes_the_question_feasible(name: str) -> None:
    spec, why = question(name), explained(name)
    assert not why.feasible
    ways = [way for way in why.ways if way.kind != "part"]
    assert ways
    assert why.joint is not None
    for way in ways:
        assert way.patch is not None, way.sentence
        assert is_feasible(way.applied(spec)), (way.sentence, way.patch)
        if way.kind not in ("joint", "choice"):
            assert not way.design.violated
            # What is told is what the patch states, and it is outside of what was asked.
            ((entries),) = way.patch.values()
            assert any(word in str(entries) for word in [str(way.needed), *way.sentence.split()])


@pytest.mark.slow
def test_less_than_an_amount_does_not_do() -> None:
    spec = question("limits and a requirement")
    for way in explained("limits and a requirement").single:
        assert way.proven
        less = way.given + 0.98 * (way.needed - way.given)
        ((key, entries),) = (way.patch or {}).items()
        if key == "requirements":
            assert not is_feasible(patched(spec, {key: {w: less / {"F": 1, "room": 1e-3}[w] for w in entries}}))


@pytest.mark.slow
def test_a_refusal_is_explained_with_amounts() -> None:
    why = explained("refused")
    (guard,) = why.fired
    assert (guard.name, guard.requirement, guard.unit) == ("no_room", "room", "mm")
    assert guard.sense == "at_least"
    assert (guard.value, guard.needed) == pytest.approx((0.010, 0.030))
    assert guard.missed_by == pytest.approx(2 / 3)
    assert guard.lifted_by == {"room": "30.0001 mm", "least": "9.99999 mm"}
    assert why.conflict == ()
    assert "room is 10 mm where more than 30 mm is needed (missed by 66.7 %)" in why.message
    rows = explained("refused for every row")
    (weak,) = rows.fired
    assert (weak.name, weak.part) == ("too_weak", "S185")
    assert parse_quantity(weak.lifted_by["load"], "N", "load") < 400e3
    assert [str(way.design.parts["steel"]) for way in rows.choices] != ["S185"]


@pytest.mark.slow
def test_only_what_was_asked_gives_way_unless_physics_may() -> None:
    spec = question("limits and a requirement")
    plain, all_of_it = explained("limits and a requirement"), synth.explain(Bracket(), **spec, physics=True)
    assert plain.physics is None
    assert all_of_it.physics is not None
    assert all_of_it.physics.patch is None
    with pytest.raises(synth.InputError, match="state"):
        all_of_it.physics.applied(spec)
    own = {"mass <= 2 kg", "width <= 40 mm", "width >= 10 mm"}
    assert {way.name for way in plain.single if way.kind == "limit"} <= own
    family = {way.name for way in all_of_it.single if way.kind == "limit"} - own
    assert family <= {"bending", "slenderness"}
    assert all(way.patch is None for way in all_of_it.single if way.name in family)


@pytest.mark.slow
def test_the_file_has_the_patches_and_the_amounts_of_refusals(tmp_path: Path) -> None:
    spec, why = question("refused on its edge"), explained("refused on its edge")
    told = json.loads(why.save(tmp_path)[1].read_text(encoding="utf-8"))
    assert told["refused"][0]["missed_by"] == 0
    assert told["refused"][0]["lifted_by"] == {"room": "30.0001 mm", "least": "29.9999 mm"}
    assert [way["patch"] for way in told["ways"]] == [way.patch for way in why.ways]
    assert is_feasible(patched(spec, told["ways"][0]["patch"]))


@pytest.mark.slow
def test_values_are_told_to_six_digits_and_pinned_ones_stated_in_full() -> None:
    joint = explained("pins").joint
    assert joint is not None
    assert joint.patch is not None
    assert "fix" in joint.patch
    assert all(len(number.replace(".", "").lstrip("0")) <= 6 for number in re.findall(r"[0-9.]+", joint.sentence))
    assert any(len(value) > len("0.123456 mm") for value in map(str, joint.patch["fix"].values()))


def test_a_patch_is_written_in_the_words_of_the_spec() -> None:
    why = explained("limits and a requirement")
    keys = {key: set(entries) for way in why.ways if way.patch for key, entries in way.patch.items()}
    assert "load" not in keys.get("requirements", set())
    assert keys.get("limits", set()) <= {"m", "b"}
    assert patched({"points": 3}, {"limits": {"m": "<= 3 kg"}}) == {"points": 3, "limits": {"m": "<= 3 kg"}}
