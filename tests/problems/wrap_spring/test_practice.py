"""The complete wrap spring clutches and the rules of practice: worked numbers, and what each rule does."""

import math

import pytest

import synth

INDEXER = {"required_torque": "50 N*m", "bore_diameter": "20 mm", "peak_torque": "125 N*m"}
SLIM = (
    {"interference": "2.3724231 mm", "hub_diameter": "70 mm", "coils_per_hub": 4.5},
    ("square 3x3", "nitrocarburised_steel_dry"),
)
STOUT = (
    {"interference": "1.1581978 mm", "hub_diameter": "63 mm", "coils_per_hub": 4.5},
    ("square 3.5x3.5", "nitrocarburised_steel_dry"),
)
FREEWHEEL = {
    "required_torque": "30 N*m",
    "bore_diameter": "16 mm",
    "peak_torque": "45 N*m",
    "spring_speed": "1400 1/min",
    "overrun_speed": "300 1/min",
    "overrun_duty": 0.2,
}
RUBBING = {"interference": "0.22683783 mm", "hub_diameter": "36 mm", "coils_per_hub": 6.5}
ACTUATED = {**INDEXER, "relative_speed": "500 1/min", "actuator_torque_limit": "15 N*m"}
MANY = {"clearance": "0.08 mm", "actuator_torque": "0.975373 N*m", "hub_diameter": "40 mm", "coils_per_hub": 12}
FEW = {"clearance": "0.08 mm", "actuator_torque": "3.77336 N*m", "hub_diameter": "40 mm", "coils_per_hub": 8}
RULES = {
    "coils_practice",
    "belt_exponent",
    "spring_index_max",
    "interference_range",
    "hub_wall",
    "overrun_life",
    "tang",
}


def design(case, requirements=None, duty=INDEXER, **options):
    sizes, (wire, pair) = case
    return synth.evaluate(
        synth.load("wrap_spring", **{"practice": "on", **options}),
        {**duty, **(requirements or {})},
        values=sizes,
        parts={"wire": wire, "friction_pair": pair},
    )


def actuated(sizes, requirements=None, wire="rect 3x2", **options):
    return synth.evaluate(
        synth.load("wrap_spring_actuated", **{"practice": "on", **options}),
        {**ACTUATED, **(requirements or {})},
        values=sizes,
        parts={"wire": wire, "friction_pair": "hardened_steel_oil"},
    )


def missed(found):
    """Return the limits that a design does not keep."""
    return {name for name, residual in found.residuals.items() if residual > 1e-6}


# -- by hand from the formulas, each to the digits given -----------------------------------------------


def test_worked_numbers_of_the_interference_fit():
    slim, stout = design(SLIM), design(STOUT)
    assert slim.limits["spring_index_max"] == pytest.approx((24.3333, 25), rel=6e-6)
    ratio = slim.values["interference"] / slim.values["mean_coil_radius"]
    assert ratio == pytest.approx(0.0649979, rel=6e-6)
    assert slim.limits["interference_range"] == pytest.approx((ratio + 0.03 / 36.5, 0.04), rel=6e-6)
    assert slim.values["belt_exponent"] == pytest.approx(5.6936, rel=6e-6)
    assert missed(slim) & RULES == {"interference_range"}
    assert stout.limits["spring_index_max"][0] == pytest.approx(19)
    assert stout.values["interference"] / stout.values["mean_coil_radius"] == pytest.approx(0.034833, rel=6e-6)
    assert stout.values["belt_exponent"] == pytest.approx(5.6251, rel=6e-6)
    assert missed(stout) == set()


@pytest.mark.parametrize(
    ("pair", "hours", "digit"), [("hardened_steel_dry", 3.2140, 1e-4), ("hardened_steel_oil", 102.8, 0.1)]
)
def test_worked_overrun_life(pair, hours, digit):
    found = design((RUBBING, ("rect 3.5x2", pair)), duty=FREEWHEEL)
    # At 0.135042 W/mm2, with whose inverse the life goes, and at a duty of a fifth.
    life = found.values["overrun_life"] * found.values["overrun_pv"] / 0.135042e6
    assert life * 0.2 / 3600 == pytest.approx(hours, abs=digit / 2)
    assert "overrun_life" in missed(found)
    # Dry pairs are none that the search would take.
    assert any("lubrication" in remark for remark in found.advice) == (pair == "hardened_steel_dry")


@pytest.mark.parametrize(
    ("sizes", "belt_exponent", "tang", "collar", "broken"),
    [(MANY, 8.617, 139.339e6, 0.151241, {"coils_practice", "belt_exponent"}), (FEW, 5.745, 539.052e6, 0.106429, set())],
)
def test_worked_numbers_of_the_clearance_fit(sizes, belt_exponent, tang, collar, broken):
    found = actuated(sizes)
    assert found.values["belt_exponent"] == pytest.approx(belt_exponent, rel=1e-4)
    assert found.values["tang_stress"] == pytest.approx(tang, rel=6e-6)
    assert found.values["collar_mass"] == pytest.approx(collar, rel=6e-6)
    assert missed(found) & RULES == broken


# -- the whole clutch -----------------------------------------------------------------------------------


def test_the_hubs_go_on_as_bosses():
    found = design(STOUT)
    boss = 7850 * math.pi * (1.5**2 - 1) * 0.01**2 * 1.2 * 0.02
    assert found.values["mass"] == pytest.approx(found.values["part_mass"] + 2 * boss)
    assert found.values["length"] == pytest.approx(found.values["spring_length"] + 2 * 1.2 * 0.02)
    with_collar = actuated(FEW)
    values = with_collar.values
    assert values["mass"] == pytest.approx(values["part_mass"] + values["collar_mass"] + 2 * boss)
    # 40 mm hub, 2 mm wire, as much again as the clearance of 0.08 mm between coils and collar, 3 mm wall.
    assert values["outer_diameter"] == pytest.approx(0.04 + 0.004 + 4 * 0.08e-3 + 0.006)


def test_the_bore_follows_from_the_torque_where_it_is_not_given():
    free = {name: value for name, value in INDEXER.items() if name != "bore_diameter"}
    wall, bore = design(STOUT, duty=free).limits["hub_wall"]
    needed = (16 * 1.5 * 50 / (math.pi * 20e6)) ** (1 / 3)
    assert (wall, bore) == pytest.approx((0.063, 1.4 * needed))
    assert any(remark.startswith("thin_shaft") for remark in design(STOUT).advice)
    assert not any(remark.startswith("thin_shaft") for remark in design(STOUT, duty=free).advice)
    thick = design(STOUT, {"shaft_shear_allow": "50 N/mm2"})
    assert not any(remark.startswith("thin_shaft") for remark in thick.advice)


# -- the rules ------------------------------------------------------------------------------------------


def test_every_rule_can_bind_and_can_be_widened():
    assert "interference_range" not in missed(design(SLIM, {"interference_ratio_max": 0.066}))
    slimmer = (SLIM[0] | {"hub_diameter": "75 mm"}, SLIM[1])
    assert "spring_index_max" in missed(design(slimmer))
    assert "spring_index_max" not in missed(design(slimmer, {"spring_index_max": 26.1}))
    assert "hub_wall" in missed(design(STOUT, {"bore_diameter": "46 mm"}))
    assert "hub_wall" not in missed(design(STOUT, {"bore_diameter": "46 mm", "hub_wall_ratio": 1.36}))
    assert "drag_torque" in missed(design(STOUT, {"required_torque": "25 N*m"}))
    assert "drag_torque" not in missed(design(STOUT, {"required_torque": "25 N*m", "drag_torque_limit": "3 N*m"}))
    assert missed(actuated(MANY, {"coils_per_hub_max": 12, "belt_exponent_limit": 9})) == set()
    assert "tang" in missed(actuated(FEW, {"tang_length_ratio": 5}))
    assert "actuator_torque" in missed(
        actuated(FEW | {"actuator_torque": "5.1 N*m"}, {"actuator_torque_limit": "5 N*m"})
    )
    oiled = (RUBBING, ("rect 3.5x2", "hardened_steel_oil"))
    life = design(oiled, duty=FREEWHEEL).values["overrun_life"]
    for share, kept in ((0.99, True), (1.01, False)):
        found = design(oiled, {"overrun_life_min": f"{share * life} s"}, FREEWHEEL)
        assert ("overrun_life" not in missed(found)) == kept


def test_dry_hubs_are_historical_and_never_overrun():
    problem = synth.load("wrap_spring", practice="on", allow_obsolete="historical")
    assert "overrun_life" not in design(STOUT).values
    dry = {"friction_pair": ["hardened_steel_dry"], "wire": ["rect 6x3"]}
    assert synth.synthesize(problem, INDEXER, objectives=["mass"], points=1, parts=dry).designs
    for asked, duty in ((problem, FREEWHEEL), (synth.load("wrap_spring", practice="on"), INDEXER)):
        with pytest.raises(synth.InputError, match="lubrication"):
            synth.synthesize(asked, duty, points=1, parts={"friction_pair": "designation == 'hardened_steel_dry'"})


def test_without_practice_nothing_is_added():
    """The sources alone: the options off and parts give what was computed before there were rules."""
    for make, case in ((design, STOUT), (actuated, FEW)):
        plain = make(case, practice="off")
        assert plain.values == make(case, practice="off", mass_scope="parts").values
        assert not {"coils_practice", "spring_index_max", "hub_wall", "tang"} & set(plain.limits)
        assert "part_mass" not in plain.values
        whole = make(case, practice="off", mass_scope="complete")
        assert whole.values["part_mass"] == plain.values["mass"]
        assert whole.values["mass"] > plain.values["mass"]
        assert set(whole.limits) == {*plain.limits, "shaft_strength"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "duty"),
    [
        ("wrap_spring", {}),
        (
            "wrap_spring",
            {"overrun_speed": "60 1/min", "overrun_duty": 0.2, "peak_torque": "75 N*m", "belt_exponent_limit": 10},
        ),
        ("wrap_spring_actuated", {"relative_speed": "500 1/min"}),
    ],
)
def test_designs_by_practice_are_ones_that_are_built(family, duty):
    front = synth.synthesize(synth.load(family, practice="on"), {"required_torque": "50 N*m", **duty}, points=5)
    assert front.certificate.kind == "global"
    assert list(front.frame.objectives) == ["mass", "length"]
    assert front.designs
    for found in front.designs:
        wire = found.parts["wire"]
        assert found.values["coils_per_hub"] <= 8
        assert found.values["mean_coil_radius"] * 2 <= 25 * wire["radial_thickness_a"] * (1 + 1e-9)
        # Fronts have no end at which a clutch is heavy for nothing.
        assert 0.5 < found.values["mass"] < 4
        if family == "wrap_spring":
            assert found.values["drag_torque"] <= 5 * (1 + 1e-6)
        else:
            assert found.values["actuator_torque"] <= 5 * (1 + 1e-6)
