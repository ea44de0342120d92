"""The complete roller coupling and the rules of practice: worked numbers, and what each rule does."""

import math

import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

DUTY = {"required_torque": "300 N*m", "driver_speed": "960 rpm", "offset": "5 mm"}
THEN = {"shaft_shear_allow": "40 N/mm2"}  # the worked numbers were computed with it
BALLS = {"roller_kind": "any", "roller_contact": "line"}
SHEET = (
    {
        "arm_radius": "86 mm",
        "guide_half_length": "94 mm",
        "contact_length": "4.5 mm",
        "rim": "3 mm",
        "offset_capacity": "5 mm",
        "balance": "no",
    },
    ("6202", "Ti-6Al-4V"),
    BALLS,
)
SOLID = (
    {
        "arm_radius": "60 mm",
        "guide_half_length": "70 mm",
        "contact_length": "10 mm",
        "rim": "8 mm",
        "offset_capacity": "5 mm",
        "balance": "no",
    },
    ("NATR 15", "100Cr6"),
    {},
)
RULES = {"rim_practice", "contact_length_min", "float_slenderness", "material_cost"}


def design(case, requirements=None, sizes=None, **options):
    own, parts, chosen = case
    return synth.evaluate(
        synth.load("roller_coupling", **{"practice": "on", **chosen, **options}),
        {**DUTY, **(requirements or {})},
        values=own | (sizes or {}),
        parts=dict(zip(("roller", "float_material"), parts, strict=True)),
    )


def missed(found):
    """Return the limits that a design does not keep."""
    return {name for name, residual in found.residuals.items() if residual > 1e-6}


# SI; by hand from the formulas, each to the digits given: rim, contact length and float width, and what they need.
@pytest.mark.parametrize(
    ("case", "rim", "contact", "radius", "width", "broken"),
    [
        (SHEET, (3e-3, 7e-3), (4.5e-3, 4.9e-3), 98.6151e-3, (5.5e-3, 11.8338e-3), {"rim", *RULES}),
        (SOLID, (8e-3, 7e-3), (10e-3, 9e-3), 80.1543e-3, (11e-3, 9.61852e-3), set()),
    ],
)
def test_worked_numbers(case, rim, contact, radius, width, broken):
    found = design(case, THEN)
    assert found.limits["rim_practice"] == pytest.approx(rim, rel=1e-9)
    assert found.limits["contact_length_min"] == pytest.approx(contact, rel=1e-9)
    assert found.limits["float_slenderness"] == pytest.approx(width, rel=6e-6)
    assert found.values["outer_diameter"] / 2 - 5e-3 == pytest.approx(radius, rel=6e-6)
    assert found.values["mass"] - found.values["part_mass"] == pytest.approx(1.05975, rel=6e-6)
    assert missed(found) == broken


def test_every_rule_can_bind_and_can_be_widened():
    wide = {
        "rim_min": "3 mm",
        "rim_ratio": 0.08,
        "contact_share_min": 0.45,
        "float_slenderness_min": 0.02,
        "material_cost_max": 25,
    }
    assert missed(design(SHEET)) >= RULES
    assert not missed(design(SHEET, wide))
    assert missed(design(SHEET, {name: value for name, value in wide.items() if name != "rim_min"})) == {"rim"}


def test_length_and_backlash_by_hand():
    found = design(SOLID, THEN)
    shaft = (16 * 450 / (math.pi * 40e6)) ** (1 / 3)
    assert shaft == pytest.approx(38.5515e-3, rel=6e-6)
    # Roller of 19 mm with a gap of 2 mm to either arm; arms of 1.2 15 mm, bosses of 1.2 shaft diameters.
    alone = 19e-3 + 2 * 2e-3 + 2 * (1.2 * 15e-3 + 1.2 * shaft)
    assert found.values["length"] == pytest.approx(alone)
    assert found.values["backlash"] == pytest.approx(2 * 0.05 / 60)
    paired = design(SOLID, THEN, sizes={"balance": "yes"})
    assert paired.values["length"] == pytest.approx(alone + 11e-3 + 2e-3)
    assert paired.values["mass"] - found.values["mass"] == pytest.approx(found.values["float_mass"])


def test_only_track_rollers_are_offered_unless_others_are_asked_for():
    def rollers(**options):
        instance = instance_of(synth.load("roller_coupling", practice="on", **options), DUTY, as_catalogs(None))
        (slot,) = [s for s in instance.selection.slots if s.slot == "roller"]
        kinds = slot.table.text("kind")
        return {kinds[k] for k in slot.rows}

    tracks = rollers()
    assert tracks
    assert all(kind.startswith("track_roller") for kind in tracks)
    assert rollers(**BALLS) == {"deep_groove_ball_bearing"}
    assert rollers(roller_kind="any") == tracks | {"deep_groove_ball_bearing"}
    assert rollers(roller_contact="either") == tracks
    with pytest.raises(synth.InputError, match="no_track_roller"):
        rollers(roller_contact="line")


def test_without_practice_nothing_is_added():
    plain = design((*SHEET[:2], {}), practice="off")
    whole = design((*SHEET[:2], {}), practice="off", mass_scope="complete")
    assert not missed(plain)
    for found in (plain, whole):
        assert not RULES & set(found.limits)
    assert whole.values["part_mass"] == plain.values["mass"]
    assert whole.values["mass"] > plain.values["mass"]
    assert "length" not in plain.values


def test_float_materials_that_cost_too_much_are_named():
    front = synth.synthesize(
        synth.load("roller_coupling", practice="on", **BALLS),
        DUTY,
        parts={"float_material": ["Ti-6Al-4V"], "roller": ["6203"]},
    )
    assert not front.designs
    assert "material_cost is 25 where at most 5 is allowed" in front.explanation["message"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("torque", "speed", "offset", "heaviest"),
    [("20 N*m", "1450 rpm", "2 mm", 1), ("300 N*m", "960 rpm", "5 mm", 8), ("5 kN*m", "300 rpm", "10 mm", 100)],
)
def test_designs_by_practice_are_ones_that_are_built(torque, speed, offset, heaviest):
    front = synth.synthesize(
        synth.load("roller_coupling", practice="on"),
        {"required_torque": torque, "driver_speed": speed, "offset": offset},
        points=5,
    )
    assert front.certificate.kind == "global"
    assert front.designs
    for found in front.designs:
        assert found.parts["roller"]["outer_ring_load_limit"] > 0
        assert found.values["rim"] >= 0.2 * found.parts["roller"]["outer_diameter"] * (1 - 1e-9)
        assert found.values["float_width"] > 0.06 * (found.values["outer_diameter"] - 0.03)
        assert found.values["mass"] < heaviest


@pytest.mark.parametrize(("parts", "contact"), [(("6203", "100Cr6"), "line"), (("NATR 15", "100Cr6"), "crowned")])
def test_where_both_kinds_are_searched_a_row_goes_by_its_own_tread(parts, contact):
    sizes = SOLID[0] | {"rim": "9 mm", "contact_length": "9 mm"}
    both = design((sizes, parts, {"roller_kind": "any"}))
    own = design((sizes, parts, {"roller_kind": "any", "roller_contact": contact}))
    assert both.values == own.values
    assert both.not_checked == own.not_checked
    for name, sides in own.limits.items():
        assert both.limits[name] == pytest.approx(sides, rel=1e-15, nan_ok=True), name
    # A cylinder touches along a line that is as long as its contact: there is no ellipse that could be too long.
    assert both.limits["contact_ellipse"][0] == (own.limits["contact_ellipse"][0] if contact == "crowned" else 0)
    assert missed(both) == missed(own)


def test_a_crown_that_is_too_round_leaves_ball_bearings():
    sizes = SOLID[0] | {"rim": "9 mm", "contact_length": "9 mm"}
    small = {"crown_radius": "7 mm"}
    assert design((sizes, ("6203", "100Cr6"), {"roller_kind": "any"}), small).values
    with pytest.raises(synth.InputError, match="crown_too_round"):
        design((sizes, ("NATR 15", "100Cr6"), {"roller_kind": "any"}), small)


@pytest.mark.slow
def test_any_kind_finds_what_either_kind_alone_finds_best():
    small = {"required_torque": "20 N*m", "driver_speed": "960 1/min", "offset": "2 mm"}

    def least(quantity, **options):
        kind = synth.load("roller_coupling", **options)
        (best,) = synth.synthesize(kind, small, objectives=quantity).designs
        return best.objectives[quantity], str(best.parts["roller"])

    for quantity in ("mass", "outer_diameter"):
        alone = [least(quantity), least(quantity, **BALLS)]
        value, roller = least(quantity, roller_kind="any")
        assert value == pytest.approx(min(alone)[0], rel=2e-3)
        assert roller in {name for _, name in alone}
