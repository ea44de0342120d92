"""Relative cost: worked numbers, costs of a table's own, and what has no class."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synth
from tests.problems.multi_plate import test_plate_sets as listed
from tests.problems.multi_plate.test_practice import COMPACT, DUTY, LECTURE, MANY, THEN, design

FOLDER = Path(__file__).parents[2] / "catalogs"
LININGS = FOLDER / "friction_materials.csv"
AREA = 16 * np.pi / 4 * (1.32**2 - 1.05**2)  # dm2, of the compact pack


@pytest.mark.parametrize(("case", "cost"), [(LECTURE, 41.8507), (MANY, 81.0926), (COMPACT, 15.7931)])
def test_cost_of_the_worked_packs(case, cost):
    assert design(case, THEN).values["cost"] == pytest.approx(cost, rel=6e-6)


def test_weights_count_as_they_are_typed():
    found = [
        design(COMPACT, weights)
        for weights in (
            {"cost_per_part": 0, "cost_per_lining": "0 1/dm2"},
            {"cost_per_mass": "0 1/kg", "cost_per_lining": "0 1/dm2"},
            {"cost_per_mass": "0 1/kg", "cost_per_part": 0},
        )
    ]
    mass, parts, lining = (x.values["cost"] for x in found)
    assert mass == pytest.approx(found[0].values["mass"])
    assert parts == pytest.approx(0.3 * 17)
    assert lining == pytest.approx(0.2 * 2 * AREA)  # graphitic lining, class 2


def with_linings(frame):
    """Return the compact pack with a table of linings in place of the shipped one."""
    own, asked, sizes, surfaces, parts = COMPACT
    return synth.evaluate(
        synth.load("multi_plate_clutch", practice="on", **own),
        DUTY | asked,
        values={**sizes, "ramp_time": "2 s", "friction_surfaces": surfaces},
        parts=dict(zip(("friction_pair", "inner_plate", "outer_plate"), parts, strict=True)),
        catalogs={"friction_materials": frame},
    )


def unclassed(found):
    return any(text.startswith("cost_class_unknown") for text in found.advice)


def test_a_lining_may_have_a_cost_of_its_own_and_one_without_any_counts_as_moulded():
    shipped = pd.read_csv(LININGS)
    bare = shipped.drop(columns="relative_cost [-]")
    usual, priced, unknown, bare_priced = (
        with_linings(frame)
        for frame in (shipped, shipped.assign(**{"unit_cost [-]": 0.7}), bare, bare.assign(**{"unit_cost [-]": 0.7}))
    )
    rest = usual.values["cost"] - 0.2 * 2 * AREA
    assert priced.values["cost"] == pytest.approx(rest + 0.7 * AREA)
    assert unknown.values["cost"] == pytest.approx(rest + 0.2 * AREA)
    assert bare_priced.values["cost"] == pytest.approx(priced.values["cost"])
    assert [unclassed(x) for x in (usual, priced, unknown, bare_priced)] == [False, False, True, False]


def test_a_cost_in_some_rows_leaves_the_others_their_class():
    shipped = pd.read_csv(LININGS)
    some = shipped.assign(**{"unit_cost [-]": np.where(shipped["designation"] == "paper_wet", 0.7, np.nan)})
    assert with_linings(some).values["cost"] == pytest.approx(with_linings(shipped).values["cost"])


def test_bought_plates_cost_what_their_list_says_lining_and_all():
    plain = listed.evaluated(
        listed.clutch("on", "standard"), {"plate_set": "free"}, catalogs={"plate_sets": listed.LIST}
    )
    priced = listed.evaluated(
        listed.clutch("on", "standard"),
        {"plate_set": "free"},
        catalogs={"plate_sets": listed.LIST.assign(**{"unit_cost [-]": 2.5})},
    )
    area = 8 * np.pi / 4 * (1.8**2 - 1.4**2)
    own = plain.values["plate_mass"] + 0.3 * 9 + 0.2 * 2 * area
    assert priced.values["cost"] == pytest.approx(plain.values["cost"] - own + 2.5 * 9)


@pytest.mark.slow
def test_the_cheapest_pack_is_found_and_proven():
    asked = {"objectives": ["cost"], "points": 1, "gap": 1e-2, "fix": {"ramp_time": "2 s"}}
    front = synth.synthesize(
        synth.load("multi_plate_clutch", practice="on"), DUTY, parts={"friction_pair": ["paper_wet"]}, **asked
    )
    assert front.certificate.kind == "global"
    assert front.verify().holds
    # What the experiment behind the rules found: few surfaces, 14.5 with the loads of then.
    assert 4 <= front.designs[0].values["friction_surfaces"] <= 12


def cost_of(family, requirements, values, parts, table=None, **costs):
    """Return a design, whose table of a name has costs of its own, by designation."""
    catalogs = None
    if table is not None:
        frame = pd.read_csv(FOLDER / f"{table}.csv")
        frame["unit_cost [-]"] = frame["designation"].map(costs)
        catalogs = {table: frame}
    problem = synth.load(family, practice="on")
    return synth.evaluate(problem, requirements, values=values, parts=parts, catalogs=catalogs)


def test_the_wire_of_a_spring_counts_threefold_or_by_its_own_cost():
    asked = (
        "wrap_spring",
        {"required_torque": "50 N*m", "peak_torque": "125 N*m", "bore_diameter": "20 mm"},
        {"hub_diameter": "63 mm", "coils_per_hub": 4.5, "interference": "1 mm"},
        {"wire": "square 3.5x3.5", "friction_pair": "hardened_steel_oil"},
    )
    usual, own = cost_of(*asked), cost_of(*asked, table="spring_wire_flat", **{"square 3.5x3.5": 5.0})
    wire = (usual.values["cost"] - usual.values["mass"] - 3 * 0.3) / 2
    assert 0.1 < wire < usual.values["mass"]
    assert own.values["cost"] == pytest.approx(usual.values["mass"] - wire + 2 * 0.3 + 5 * wire)


def test_rollers_and_floats_count_by_piece_and_material():
    asked = (
        "roller_coupling",
        {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"},
        {
            "arm_radius": "60 mm",
            "guide_half_length": "70 mm",
            "contact_length": "10 mm",
            "rim": "8 mm",
            "offset_capacity": "5 mm",
            "balance": "no",
        },
    )
    plain, strong = (cost_of(*asked, {"roller": "NATR 15", "float_material": m}) for m in ("100Cr6", "Ti-6Al-4V"))
    table = pd.read_csv(FOLDER / "float_materials.csv").set_index("designation")
    float_mass = plain.values["float_mass"]
    extra = float_mass * (table.loc["100Cr6", "relative_cost_per_kg [-]"] - 1)
    # Two arms, a float, and four rollers that count twice.
    assert plain.values["cost"] == pytest.approx(plain.values["mass"] + 0.3 * 7 + 0.3 * 4 + extra)
    assert strong.values["cost"] > plain.values["cost"] + 5 * strong.values["float_mass"]
    bought = [
        cost_of(
            *asked, {"roller": "NATR 15", "float_material": "100Cr6"}, table="guide_rolling_bearings", **{"NATR 15": c}
        )
        for c in (1.0, 3.0)
    ]
    assert bought[1].values["cost"] - bought[0].values["cost"] == pytest.approx(4 * 2)
    assert bought[0].values["cost"] - 4 < plain.values["cost"] - 0.3 * 8  # their mass goes as well
