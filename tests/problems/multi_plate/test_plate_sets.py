"""Plates of a list: the same clutch as with made plates of those sizes, and what a maker's list may say."""

import pandas as pd
import pytest

import synth
from synth.question.catalogs import as_catalogs

DUTY = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
ROW = "set 140x190 core 2 lining 0.5"
SIZES = {"actuation_force": "13 kN", "ramp_time": "1 s"}
PAIR = "graphitic_wet"
# A maker's list: the first two plates alike but for what they say of lining, surfaces and pressure.
LIST = pd.DataFrame(
    {
        "designation": ["free", "bound", "other"],
        "ring_outer_diameter [mm]": [180.0, 180.0, 190.0],
        "ring_inner_diameter [mm]": [140.0, 140.0, 140.0],
        "inner_spline_diameter [mm]": [134.0, 134.0, 134.0],
        "outer_spline_diameter [mm]": [186.0, 186.0, 196.0],
        "inner_teeth [-]": [44, 44, 44],
        "outer_teeth [-]": [62, 62, 65],
        "tooth_height [mm]": [3.0, 3.0, 3.0],
        "inner_core_thickness [mm]": [2.0, 2.0, 2.0],
        "outer_core_thickness [mm]": [2.0, 2.0, 2.0],
        "lining_thickness [mm]": [0.5, 0.5, 0.5],
        "lining": ["", PAIR, "paper_wet"],
        "surfaces_max [-]": [None, 8, None],
        "p_max [N/mm2]": [None, 1.0, None],
    }
)


def clutch(practice, plates):
    return synth.load("multi_plate_clutch", practice=practice, plates=plates)


def evaluated(problem, parts, sizes=None, requirements=None, catalogs=None):
    return synth.evaluate(
        problem,
        DUTY | (requirements or {}),
        values={**SIZES, **(sizes or {}), "friction_surfaces": 8},
        parts={"friction_pair": PAIR, **parts},
        catalogs=catalogs,
    )


@pytest.mark.parametrize("practice", ["on", "off"])
def test_plates_of_a_list_make_the_clutch_that_made_plates_of_these_sizes_make(practice):
    linings = as_catalogs(None).table("friction_materials")
    own = linings.number("lining_thickness")[linings.row_index(PAIR)]
    plates = LIST.assign(**{"lining_thickness [mm]": 1000 * own})
    share = 0.5 if practice == "on" else 1.0  # of the teeth, which carries
    alike = evaluated(
        clutch(practice, "made"),
        {"inner_plate": "core 2", "outer_plate": "core 2"},
        sizes={"ring_outer_diameter": "180 mm", "ring_inner_diameter": "140 mm"},
        requirements={"lug_count": 44 * share},  # as the inner plate of the list has them; the outer one has 62
    )
    found = evaluated(clutch(practice, "standard"), {"plate_set": "free"}, catalogs={"plate_sets": plates})
    assert len(alike.values) > 20
    for name, value in alike.values.items():
        expected = value * 44 / 62 if name == "lug_pressure_outer" else value
        assert found.values[name] == pytest.approx(expected, rel=1e-12), name


def test_plates_wear_no_deeper_than_they_are_lined():
    thin = {"plate_sets": LIST.assign(**{"lining_thickness [mm]": 0.05})}
    lives = [
        evaluated(clutch("on", "standard"), {"plate_set": "free"}, catalogs=tables).values["wear_life"]
        for tables in (thin, {"plate_sets": LIST})
    ]
    assert lives[0] == pytest.approx(lives[1] * 0.05 / 0.2)  # wear_depth_limit in oil


def test_a_list_may_name_the_lining_and_what_it_stands():
    found = evaluated(clutch("on", "standard"), {"plate_set": "bound"}, catalogs={"plate_sets": LIST})
    assert found.limits["set_surfaces"][1] == 8
    assert found.limits["set_pressure"][1] == pytest.approx(1e6)
    with pytest.raises(synth.InputError, match="lining_of_plates"):
        evaluated(clutch("on", "standard"), {"plate_set": "other"}, catalogs={"plate_sets": LIST})


def test_a_front_holds_plates_of_the_list_alone_with_the_linings_it_names():
    asked = {"points": 10, "gap": 1e-2, "catalogs": {"plate_sets": LIST}, "fix": {"ramp_time": "1 s"}}
    front = synth.synthesize(clutch("on", "standard"), DUTY, **asked)
    assert front.certificate.kind == "global"
    assert front.designs
    for design in front.designs:
        row = design.parts["plate_set"]
        assert row["lining"] in (None, str(design.parts["friction_pair"]))
        assert design.values["friction_surfaces"] <= (8 if str(row) == "bound" else 20)
        assert not any("computed_plates" in str(remark) for remark in design.advice)


def test_rows_of_the_shipped_series_say_that_no_maker_lists_them():
    found = evaluated(clutch("on", "standard"), {"plate_set": ROW})
    assert any("computed_plates" in str(remark) for remark in found.advice)
