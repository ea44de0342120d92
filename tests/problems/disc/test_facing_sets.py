"""Facings of a list: the same clutch as with a ring of that size, and what a maker's list may say."""

import pandas as pd
import pytest

import synth
from synth.question.catalogs import as_catalogs

DUTY = {
    "load_torque": "60 N*m",
    "driver_speed": "1500 1/min",
    "driven_inertia": "0.7 kg*m2",
    "engagements_per_hour": "20 1/h",
}
SIZES = {"pressure_plate_thickness": "11 mm", "actuation_force": "3 kN", "ramp_time": "0.5 s", "discs": 1}
PAIR = "moulded_dry"
LIST = pd.DataFrame(
    {
        "designation": ["free", "bound", "other"],
        "ring_outer_diameter [mm]": [200.0, 200.0, 215.0],
        "ring_inner_diameter [mm]": [130.0, 130.0, 145.0],
        "facing_thickness [mm]": [3.5, 3.5, 3.5],
        "rivet_depth [mm]": [None, 0.8, None],
        "lining": ["", PAIR, "woven_dry"],
        "p_max [N/mm2]": [None, 0.1, None],
    }
)


def evaluated(plates, parts, sizes=None, catalogs=None, practice="on", requirements=None):
    return synth.evaluate(
        synth.load("disc_clutch", practice=practice, plates=plates),
        DUTY | (requirements or {}),
        values={**SIZES, **(sizes or {})},
        parts={"friction_pair": PAIR, **parts},
        catalogs=catalogs,
    )


def listed(row, facings=LIST, **more):
    return evaluated("standard", {"facing_set": row}, catalogs={"facing_sets": facings}, **more)


@pytest.mark.parametrize("practice", ["on", "off"])
def test_facings_of_a_list_make_the_clutch_that_a_ring_of_their_size_makes(practice):
    linings = as_catalogs(None).table("friction_materials")
    own = 1000 * linings.number("lining_thickness")[linings.row_index(PAIR)]
    ring = {"ring_outer_diameter": "200 mm", "ring_inner_diameter": "130 mm"}
    alike = evaluated("made", {}, sizes=ring, practice=practice)
    found = listed("free", LIST.assign(**{"facing_thickness [mm]": own}), practice=practice)
    assert len(alike.values) > 20
    for name, value in alike.values.items():
        assert found.values[name] == pytest.approx(value, rel=1e-12), name


def test_facings_wear_to_their_rivets_or_by_their_thickness():
    def life(**cells):
        return listed("free", LIST.assign(**cells), requirements={"wear_depth_limit": "1.5 mm"}).values["wear_life"]

    full = life()  # 1.5 of 3.5 mm, glued
    assert life(**{"rivet_depth [mm]": 0.6}) == pytest.approx(full * 0.6 / 1.5)
    assert life(**{"facing_thickness [mm]": 0.5}) == pytest.approx(full * 0.5 / 1.5)
    assert life(**{"rivet_depth [mm]": 2.0}) == pytest.approx(full)


def test_a_thicker_facing_makes_a_longer_and_heavier_clutch():
    thin, thick = (listed("free", LIST.assign(**{"facing_thickness [mm]": t})).values for t in (3.0, 4.0))
    assert thick["length"] - thin["length"] == pytest.approx(2e-3)
    for name in ("mass", "disc_inertia"):
        assert thick[name] > thin[name]


def test_a_list_may_name_the_lining_and_what_it_stands():
    found = listed("bound")
    assert found.limits["set_pressure"][1] == pytest.approx(1e5)
    assert "set_pressure" in found.violated
    assert "not checked: set_pressure, no facing_set.p_max" in listed("free").not_checked
    with pytest.raises(synth.InputError, match="lining_of_facings"):
        listed("other")
    # Without the columns a list allows everything.
    plain = LIST.drop(columns=["lining", "p_max [N/mm2]", "rivet_depth [mm]"])
    assert listed("other", plain).limits["set_pressure"][0] > 0


@pytest.mark.slow
def test_the_search_chooses_among_rows_and_computed_ones_say_so():
    front = synth.synthesize(synth.load("disc_clutch", plates="standard"), DUTY, points=3)
    assert front.certificate.kind == "global"
    shipped = as_catalogs(None).table("facing_sets").designations
    for design in front.designs:
        assert str(design.parts["facing_set"]) in shipped
        assert any(remark.startswith("computed_facings") for remark in design.advice)
    bought = synth.synthesize(
        synth.load("disc_clutch", plates="standard"), DUTY, points=3, catalogs={"facing_sets": LIST}
    )
    assert bought.designs
    for design in bought.designs:
        assert not any(remark.startswith("computed_facings") for remark in design.advice)
