"""The nearest design where nothing is feasible: nearer than any that chance finds, and one that makes sense."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import synth
from synth.model.registry import load
from synth.search.formulation import Formulation
from tests.asking import pose

DUTY = {
    "load_torque": "600 N*m",
    "driver_speed": "26.6 rad/s",
    "driven_inertia": "30 kg*m2",
    "engagements_per_hour": "50 1/h",
    "jerk_limit": "18 rad/s3",
}
FEW: dict[str, Any] = {"fix": {"ramp_time": "2 s"}, "parts": {"friction_pair": ["graphitic_wet", "paper_wet"]}}


def nearest(torque: str) -> tuple[dict[str, float], dict[str, Any]]:
    """Return the limits that the nearest design misses with the share, and the whole explanation."""
    front = synth.synthesize(synth.load("multi_plate_clutch", practice="off"), {**DUTY, "load_torque": torque}, **FEW)
    assert not front.designs
    explanation = dict(front.explanation or {})
    return {c["limit"]: c["missed_by"] for c in explanation["conflicts"]}, explanation


@pytest.mark.slow
@pytest.mark.parametrize("torque", ["60 kN*m", "900 kN*m"])
def test_far_from_everything_feasible_the_nearest_design_is_still_a_clutch(torque: str) -> None:
    missed, explanation = nearest(torque)
    sizes = {name: float(text.split()[0]) for name, text in explanation["nearest"].items() if " mm" in text}
    assert sizes["ring_inner_diameter"] < sizes["ring_outer_diameter"]
    # It bears a good part of the load at least: chance alone finds designs that do.
    assert missed["torque_capacity"] < 0.9
    assert "e+" not in explanation["message"]


def test_a_combination_alone_is_tried_from_several_starts() -> None:
    # 0.02 per cent more time to slip would do: one start ends at plates without any width.
    spec = {
        "load_torque": "88.053 N*m",
        "driver_speed": "1500 1/min",
        "driven_inertia": "0.7 kg*m2",
        "safety_factor": 2,
        "engagements_per_hour": "20 1/h",
        "startup_torque": "120 N*m",
    }
    robust = {"friction": "catalogue range", "load_torque": "+-5 %", "ambient_temperature": "0 .. 60 degC"}
    front = synth.synthesize(
        synth.load("disc_clutch", practice="off"),
        spec,
        fix={"discs": 1},
        parts={"friction_pair": ["moulded_dry"]},
        robust=robust,
    )
    assert not front.designs
    conflicts = (front.explanation or {})["conflicts"]
    assert [c["limit"] for c in conflicts] == ["slip_time (load_torque high)"]
    assert conflicts[0]["missed_by"] == pytest.approx(2e-4, rel=0.1)


def test_no_design_that_chance_finds_is_nearer() -> None:
    missed, _ = nearest("900 kN*m")
    question = pose(load("multi_plate_clutch", practice="off"), {**DUTY, "load_torque": "900 kN*m"}, **FEW)
    form, rng = Formulation(question.instance, dict(question.chosen), 2), np.random.default_rng(5)
    combinations = rng.integers(question.instance.combinations.count, size=200)
    points = form.lower + rng.random((200, form.n)) * (form.upper - form.lower)
    result = form.points.evaluate(points, combinations)
    capacity, needed = (np.asarray(x, dtype=float) for x in result.limits["torque_capacity"])
    assert missed["torque_capacity"] <= 1 - (capacity / needed).max() + 1e-9


class Stepped(synth.DesignProblem):
    """Sizes that keep both limits exist, but none that is made."""

    name, title = "stepped", "Stepped"

    def declare(self, d: Any) -> None:
        side = d.variable("side", "mm", 1, 10, grid=1, symbol="s")
        height = d.variable("height", "mm", 1, 10, grid=(1, 4, 10), symbol="h")
        free = d.variable("free", "mm", 1, 10)
        d.at_least("area", side * height, 21e-6, "mm2")
        d.at_most("edge", side + height, 9.6e-3, "mm")
        d.at_most("free", free, 0.5 * side, "mm")
        d.objective("side")


def test_where_only_sizes_between_the_makeable_ones_keep_all_limits_a_makeable_one_tells_what_is_in_the_way() -> None:
    assert synth.synthesize(Stepped, {}, grid=False).designs
    front = synth.synthesize(Stepped, {})
    assert front.certificate.kind == "global"
    assert not front.designs
    explanation = dict(front.explanation or {})
    # Beside what keeps both lie sides of 5 and 6 with a height of 4: one misses the area by 1/21, the other the edge.
    assert [c["limit"] for c in explanation["conflicts"]] in (["area"], ["edge"])
    assert all(0 < c["missed_by"] < 0.05 for c in explanation["conflicts"])
    assert explanation["nearest"]["height"] == "4 mm"
    assert explanation["nearest"]["side"] in ("5 mm", "6 mm")
    told = "Sizes between the makeable ones would keep every limit; the nearest makeable design found misses "
    assert told in explanation["message"]
    (missed,) = explanation["conflicts"]
    asked = {"area": "at least 21 mm2 is needed", "edge": "at most 9.6 mm is allowed"}
    assert asked[missed["limit"]] in missed["sentence"]


def test_a_winding_of_a_batch_row_that_only_other_hubs_would_hold_names_its_limits() -> None:
    row = {"required_torque": "460.7 N*m", "bore_diameter": "48 mm", "length_limit": "180 mm"}
    front = synth.synthesize(synth.load("wrap_spring", allow_obsolete="historical"), row, points=3)
    assert not front.designs
    missed = {c["limit"] for c in dict(front.explanation or {})["conflicts"]}
    assert missed
    assert missed <= {"closing_torque", "wire_stress", "interference_range", "length"}


@pytest.mark.slow
def test_a_nearest_design_tells_which_of_its_sizes_lie_at_a_bound() -> None:
    wants = {"required_torque": "2e6 N*m", "driver_speed": "500 1/min"}
    front = synth.synthesize("magnetic_powder_clutch", wants, points=1)
    sizes = dict(front.explanation or {})["nearest"]
    assert sizes["powder_gap"] == "1 mm (its bound, no limit of physics)"
    assert "bound" not in sizes["gap_radius"]
