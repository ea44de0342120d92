"""Drawings of wrap springs whose coils do not come out even: what is drawn weighs what the design weighs."""

import pytest

import synth
from synth.analysis.drawing import weighed

FITS = {
    "wrap_spring": (
        {"interference": "0.7 mm", "coils_per_hub": 6},
        {"overrun_speed": "3 1/min"},
        "hardened_steel_greased",
    ),
    "wrap_spring_actuated": (
        {"clearance": "0.085 mm", "actuator_torque": "1.95 N*m", "coils_per_hub": 2},
        {"relative_speed": "500 1/min", "fixed_coils": 0.7},
        "hardened_steel_oil",
    ),
}
ASKED = {
    "even": {},
    "no gap between the hubs": {"gap_coils": 0},
    "coils that touch": {"coil_gap": 0},
    "other parts of a coil": {"gap_coils": 0.3},
    "far apart": {"gap_coils": 3.7, "coil_gap": "5 mm"},
    "bosses wider than the hubs": {"bore_diameter": "39 mm"},
}


@pytest.mark.parametrize("asked", ASKED.values(), ids=ASKED)
@pytest.mark.parametrize("family", FITS)
def test_coils_that_do_not_come_out_even_are_drawn(family, asked):
    values, needed, pair = FITS[family]
    problem = synth.load(family, practice="on")
    requirements = {"required_torque": "20 N*m", "bore_diameter": "12 mm", **needed, **asked}
    parts = {"wire": "rect 2.5x1.5", "friction_pair": pair}
    design = synth.evaluate(problem, requirements, values={"hub_diameter": "40 mm", **values}, parts=parts)
    drawing = synth.draw(problem, requirements, design)
    masses = weighed(drawing, design)
    assert len(masses) == (2 if family == "wrap_spring" else 3)
    for names, of_drawing, of_design in masses:
        assert of_drawing == pytest.approx(of_design, rel=1e-9), names
    names = {dimension.quantity for dimension in drawing.measured}
    assert ("gap_length" in names) == (asked.get("gap_coils") != 0)
    assert ("coil_gap" in names) == (asked.get("coil_gap") != 0)
    ends = [x for area in drawing.views[0].areas if area.half for x, *_ in area.outline]
    assert min(ends) >= 0
    assert max(ends) <= 1e3 * design.values["spring_length"] * (1 + 1e-12)
