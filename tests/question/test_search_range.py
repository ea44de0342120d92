"""Designs that exist, outside the range that is searched: computed and told, unless nothing can be computed."""

import math

import pytest

import synth
from synth.terminal.cli import app
from tests.sample_problems.strut import NEEDED, RODS, Strut

PARTS = {"plate": "core 2", "material": "soft"}
POINT = {"width": "50 mm", "length": "200 mm", "plates": 2, "end": "eye"}
CATALOGS = {"rods": RODS}


class Spread(synth.DesignProblem):
    """A formula with a pole and a root, a variable of both signs, a count of one step, a guard and an optional cell."""

    name, title = "spread", "Spread"

    def declare(self, d):
        x = d.variable("x", "mm", 1, 10)
        y = d.variable("y", "-", -1, 1)
        z = d.variable("z", "-", 0, 4)
        one = d.count("one", 3, 3)
        rod = d.part("rod", "rods")
        d.derive("root", "-", (4 - y) ** 0.5)
        d.derive("share", "-", rod.optional("stress_allow") / 160e6)
        d.derive("area", "mm2", x * x * one * (1 + z))
        d.at_least("open", x, 0.0005, "mm", guard=True)
        d.derive("inverse", "1/mm", (x - 0.0005) ** 0.5 / x**2, needs="open")
        d.objective("area")


def spread(x=2, y=0, z=0, one=3, rod="soft", **derived):
    values = {"x": x, "y": y, "z": z, "one": one} | derived
    given = {k: v for k, v in values.items() if v is not None}
    return synth.evaluate(Spread(), {}, values=given, parts={"rod": rod}, catalogs=CATALOGS)


def strut(**values):
    return synth.evaluate(Strut(), NEEDED, values=POINT | values, parts=PARTS, catalogs=CATALOGS)


def test_values_outside_are_computed_and_told_with_the_range():
    design = strut(width="300 mm", length="50 mm", plates=6)
    assert design.outside == {
        "width": "300 mm, searched is 5 mm to 200 mm",
        "length": "50 mm, searched is 100 mm to 300 mm",
        "plates": "6, searched is 1 to 4 in steps of 1",
    }
    assert design.values["area"] == pytest.approx(6 * 0.3 * 0.002, rel=1e-12)
    assert design.violated == ("reach",)  # limits are tested as ever
    assert strut().outside == {}
    assert strut(width="5 mm", length="300 mm", plates=4).outside == {}


def test_a_count_between_its_steps_is_computed():
    design = strut(plates=2.5)
    assert design.outside == {"plates": "2.5, searched is 1 to 4 in steps of 1"}
    assert design.values["area"] == pytest.approx(2.5 * 0.05 * 0.002, rel=1e-12)
    assert spread(one=4).outside == {"one": "4, searched is 3"}


def test_what_is_told_is_stated_and_evaluated_again():
    design = strut(width="300 mm", plates=6)
    spec = design.to_spec()
    again = synth.evaluate(Strut(), NEEDED, spec, catalogs=CATALOGS)
    assert (again.outside, again.values) == (design.outside, design.values)
    assert synth.evaluate(Strut(), NEEDED, design, catalogs=CATALOGS).outside == design.outside


def test_limits_of_ones_own_on_unknowns_may_lie_outside_as_well():
    limits = {"width": ["<= 310 mm", ">= 250 mm"], "plates": "<= 5"}
    design = synth.evaluate(
        Strut(), NEEDED, values=POINT | {"width": "300 mm", "plates": 6}, parts=PARTS, catalogs=CATALOGS, limits=limits
    )
    assert design.violated == ("reach", "plates <= 5")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"width": "-1 mm"}, r"values: width: got '-1 mm'; expected a value above 0 mm \(searched is 5 mm to 200 mm\)"),
        ({"width": 0}, r"values: width: got '0 mm'; expected a value above 0 mm"),
        ({"plates": 0}, r"values: plates: got '0'; expected a value above 0 \(searched is 1 to 4 in steps of 1\)"),
        ({"length": "1e308 m"}, r"values: length: .*values for which .* can be computed"),
    ],
)
def test_what_no_formula_can_compute_is_one_sentence(values, message):
    with pytest.raises(synth.InputError, match=message):
        strut(**values)


def test_not_a_number_is_told_but_not_what_a_guard_or_a_missing_cell_explains():
    with pytest.raises(synth.InputError, match=r"values: y: got '5, searched is -1 to 1'; expected values .* root can"):
        spread(y=5)
    with pytest.raises(synth.InputError, match=r"values: z: got '-0\.1'; expected a value at least 0"):
        spread(z=-0.1)
    assert spread(y=-3).outside == {"y": "-3, searched is -1 to 1"}
    with pytest.raises(synth.InputError, match=r"values: y, z: .* root can"):
        spread(y=4.5, z=5)  # of two outside the one that matters may be either
    thin = spread(x=0.4, rod="odd")
    assert set(thin.outside) == {"x"}
    assert thin.violated == ("open",)
    assert math.isnan(thin.values["inverse"])
    assert math.isnan(thin.values["share"])
    assert thin.values["area"] == pytest.approx(3 * 0.4e-3**2)


@pytest.mark.parametrize(
    ("area", "x", "outside"), [("108 mm2", 6e-3, False), ("1200 mm2", 20e-3, True), ("0.75 mm2", 0.5e-3, True)]
)
def test_a_derived_quantity_may_ask_for_a_size_outside(area, x, outside):
    design = spread(x=None, area=area)
    assert design.values["x"] == pytest.approx(x, rel=1e-11)
    assert ("x" in design.outside) == outside


def test_of_several_sizes_outside_the_nearest_is_taken_and_none_is_made_up():
    # (1 + z) x^2 one = area: with x = 20 mm the z of 0.5 is searched; without one the nearest to 0..4 is.
    assert spread(x=20, z=None, area="1800 mm2").values["z"] == pytest.approx(0.5, rel=1e-10)
    assert spread(z=None, area="120 mm2").values["z"] == pytest.approx(9, rel=1e-10)
    with pytest.raises(synth.InputError, match=r"quantities that some x \(1 mm to 10 mm\) can give"):
        spread(x=None, area="-3 mm2")


def test_the_screen_and_the_table_of_a_check_say_it(tmp_path):
    from typer.testing import CliRunner

    (tmp_path / "design.yaml").write_text(
        "family: multi_plate_clutch\n"
        "requirements: {load_torque: 60 N*m, driver_speed: 254, driven_inertia: 3 kg*m2}\n"
        "values: {ring_outer_diameter: 300 mm, ring_inner_diameter: 240 mm, actuation_force: 5 kN, ramp_time: 25 s,\n"
        "  friction_surfaces: 9}\n"
        "parts: {friction_pair: seed_multiplate_ref, inner_plate: core 4, outer_plate: core 2}\n"
    )
    result = CliRunner().invoke(app, ["check", str(tmp_path / "design.yaml"), "-o", str(tmp_path / "out")])
    assert result.exit_code in (0, 3), result.output
    told = " ".join(result.output.split())
    assert "outside the range that is searched: friction surfaces 9, searched is 2 to 60 in steps of 2" in told
    table = (tmp_path / "out" / "check.csv").read_text().splitlines()
    (row,) = (line for line in table if line.startswith("count,friction_surfaces"))
    assert row.endswith(",outside the range that is searched")
