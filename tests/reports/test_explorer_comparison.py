"""What the explorer is told of several families: one front, with quantities that not every family has."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

import synth
from synth.analysis.reporting import explored_comparison

pytestmark = pytest.mark.slow
DUTY = {"load_torque": "200 N*m", "driver_speed": "700 1/min", "driven_inertia": "2 kg*m2"}
DISC = {"family": "disc_clutch", "parts": {"friction_pair": ["moulded_dry"]}}
PLATES = {
    "family": "multi_plate_clutch",
    "parts": {"friction_pair": ["paper_wet"], "inner_plate": ["core 2"], "outer_plate": ["core 2"]},
}


@cache
def compared() -> tuple[synth.Comparison, dict[str, Any]]:
    found = synth.compare(
        [DISC, PLATES, "roller_coupling"],
        DUTY,
        objectives=["mass", "outer_diameter"],
        fix={"ramp_time": "0.3 s"},
        limits={"outer_diameter": "<= 300 mm"},
        points=4,
    )
    with TemporaryDirectory() as place:
        found.save(place)
        return found, explored_comparison(Path(place))


def test_designs_are_those_of_the_common_front_in_the_units_of_their_columns() -> None:
    found, record = compared()
    assert [d["rank"] for d in record["designs"]] == [d.rank for d in found.designs]
    assert [d["family"] for d in record["designs"]] == found.families
    names = [q["name"] for q in record["quantities"]]
    units = {q["name"]: q["unit"] for q in record["quantities"]}
    assert len(set(names)) == len(names)
    assert (names[:2], units["mass"], units["outer_diameter"]) == (["mass", "outer_diameter"], "kg", "mm")
    for told, own in zip(record["designs"], found.designs, strict=True):
        assert len(told["v"]) == len(names)
        assert len(told["used"]) == len(told["sides"]) == len(record["limits"])
        values = dict(zip(names, told["v"], strict=True))
        assert values["mass"] == pytest.approx(own.values["mass"], rel=1e-6)
        assert values["outer_diameter"] == pytest.approx(1000 * own.values["outer_diameter"], rel=1e-6)
        known = {name for name in names if name in own.values}
        assert {name for name, value in values.items() if value is not None} <= known
        assert set(told["parts"].values()) <= set(record["parts"])


def test_the_first_designs_have_their_drawing() -> None:
    found, record = compared()
    for told, own in zip(record["designs"][:8], found.designs, strict=False):
        assert told["drawing"].startswith("<svg")
        measures = [float(number) for number in re.findall(r'data-measure="([^"]*)"', told["drawing"])]
        assert pytest.approx(1000 * own.values["outer_diameter"], rel=1e-12) in measures


def test_what_became_of_each_family_and_how_far_it_is_proven_is_told() -> None:
    found, record = compared()
    told = {family["name"]: family for family in record["families"]}
    assert list(told) == [outcome.family for outcome in found.outcomes]
    assert told["roller_coupling"]["outcome"] == "not_covered"
    assert "use a friction clutch, and this beside it" in told["roller_coupling"]["why"]
    for name in found.families:
        assert told[name]["spec"]["family"] == name
    assert (record["certificate"]["level"], record["certificate"]["word"]) == ("good", "Proven")
    assert any("Roller coupling" in text for text in record["certificate"]["not_part"])
    assert ("load torque", "N·m") in [(entry["label"], entry.get("unit")) for entry in record["asked"]]
