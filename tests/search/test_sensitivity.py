"""Elasticities against what a second search finds when a limit or requirement is moved a little."""

import math

import pytest

import synth
from synth.search.front_search import Report
from synth.search.joint.joint_search import JointSearch
from synth.search.sensitivity import elasticities
from tests.asking import pose
from tests.sample_problems.strut import RODS, Strut

STEP = 1e-3


def central(solve, objective, change):
    """Return d log(objective) / d log(what ``change`` scales) from two more searches."""
    up, down = solve(change(1 + STEP)), solve(change(1 - STEP))
    return (math.log(up.values[objective]) - math.log(down.values[objective])) / (
        math.log(1 + STEP) - math.log(1 - STEP)
    )


# -- a bar, where the answer is known ------------------------------------------------------------------


def strut(requirements, **more):
    front = synth.synthesize(
        Strut(),
        requirements,
        catalogs={"rods": RODS},
        grid=False,
        fix={"plates": 1, "end": "eye", "material": "hard"},
        parts={"plate": ["core 2"]},
        gap=1e-5,
        **more,
    )
    return front.designs


def test_one_objective_of_a_bar():
    # width = safety load / (stress t), length = 120 mm: mass grows with load, safety and reach, falls with stress.
    (design,) = strut({"load": "20 kN", "room": "150 mm"}, objectives=["mass"])
    assert design.elasticity["mass"] == pytest.approx({"stress": -1.0, "reach": 1.0, "load": 1.0, "safety": 1.0})
    assert "room" not in design.elasticity["mass"]  # has room to spare


def test_an_objective_that_is_held_counts_as_a_limit():
    # Mass times flexibility goes with the square of the length: with flexibility held, mass falls as length squared.
    designs = strut({"load": "20 kN", "room": "150 mm"}, points=3)
    inner = next(d for d in designs if 1.05 < d.utilisation["stress"] ** -1 < 10 and d.utilisation["room"] < 0.95)
    assert inner.elasticity["mass"] == pytest.approx({"reach": 2.0}, rel=1e-5)
    assert inner.elasticity["flexibility"] == pytest.approx({"reach": 2.0}, rel=1e-5)


def test_a_limit_of_the_question_has_its_price_too():
    (design,) = strut(
        {"load": "5 kN", "room": "150 mm"}, objectives=["mass"], limits={"area": ">= 150 mm2", "flexibility": "<= 1"}
    )
    assert design.elasticity["mass"] == pytest.approx({"area >= 150 mm2": 1.0, "reach": 1.0})


def test_a_limit_of_a_makeable_size_alone_has_a_price():
    # Flexibility goes with 1/width; the width, makeable in millimetres, is held by the room alone.
    for grid in (True, False):
        (design,) = synth.synthesize(
            Strut(),
            {"load": "20 kN", "room": "150 mm"},
            ["flexibility"],
            catalogs={"rods": RODS},
            grid=grid,
            fix={"plates": 1, "end": "eye", "material": "hard"},
            parts={"plate": ["core 2"]},
            gap=1e-5,
        ).designs
        assert design.elasticity["flexibility"] == pytest.approx({"room": -1.0, "reach": 1.0})


class Hung(synth.DesignProblem):
    """Has an equality, an objective to be large and one that is negative."""

    name = "hung"

    def declare(self, d):
        volume = d.requirement("volume", "dm3", lower=0.1, upper=10)
        width, height = d.variable("width", "mm", 10, 1000), d.variable("height", "mm", 10, 1000)
        d.equal("volume", width**2 * height, volume, "dm3")
        d.derive("surface", "mm2", 2 * width**2 + 4 * width * height)
        d.derive("below", "mm", -width)
        d.at_most("tall", height, 0.2 * d.requirement("scale", "-", 1.0), "mm")
        d.objective("surface")
        d.objective("below", default=False)


def test_an_equality_has_a_price_of_either_sign():
    # The cube: surface goes with volume to 2/3; the limit of the height is open.
    (design,) = synth.synthesize(Hung, {"volume": "1 dm3"}, gap=1e-5).designs
    assert design.values["width"] == pytest.approx(0.1, rel=1e-3)
    assert design.elasticity["surface"]["volume"] == pytest.approx(2 / 3, rel=1e-3)
    assert set(design.elasticity["surface"]) == {"volume"}


def test_an_objective_that_is_not_positive_has_none():
    (design,) = synth.synthesize(Hung, {"volume": "1 dm3"}, objectives=["below"], gap=1e-5).designs
    assert design.elasticity == {}


# -- the multi-plate family ----------------------------------------------------------------------------

DUTY = {
    "load_torque": 600.0,
    "driver_speed": 254.01128917466497,
    "driven_inertia": 30.0,
    "outer_diameter_limit": 330.0,
    "jerk_limit": 18.0,
    "safety_factor": 1.5,
    "speed_factor": 0.85,
    "guide_friction": 0.1,
    "lug_clearance": 3.0,
    "slip_time_limit": 4.0,
}
SETTINGS = {
    "parts": {"friction_pair": ["sinter_bronze_wet"], "inner_plate": ["core 2"], "outer_plate": ["core 1.5"]},
    "fix": {"friction_surfaces": 16},
    "grid": False,
    "gap": 1e-4,
}
FAMILY = synth.load("multi_plate_clutch", practice="off")


def lightest(duty, **more):
    (design,) = synth.synthesize(FAMILY, duty, objectives=["mass"], **SETTINGS, **more).designs
    return design


@pytest.fixture(scope="module")
def light():
    return lightest(DUTY)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["load_torque", "guide_friction", "lug_clearance"])
def test_requirements_of_a_light_clutch(light, name):
    expected = central(lightest, "mass", lambda factor: {**DUTY, name: DUTY[name] * factor})
    assert abs(expected) > 1e-3
    assert light.elasticity["mass"][name] == pytest.approx(expected, rel=2e-3, abs=1e-5)


def test_requirements_with_room_to_spare_cost_nothing(light):
    for name in ("outer_diameter_limit", "slip_time_limit"):
        assert name not in light.elasticity["mass"]
    wider = lightest({**DUTY, "outer_diameter_limit": 400.0, "slip_time_limit": 5.0})
    assert wider.values["mass"] == pytest.approx(light.values["mass"], rel=1e-7)


def test_limits_that_bind_are_those_with_a_price(light):
    priced = {n for n in light.elasticity["mass"] if n in light.utilisation}
    assert priced
    assert all(light.utilisation[n] == pytest.approx(1, abs=1e-5) for n in priced)
    assert "torque_capacity" in priced
    # The sizing torque is n M_load/(c_m c_v): all that the load costs goes through it or through the start-up.
    assert light.elasticity["mass"]["safety_factor"] == pytest.approx(
        light.elasticity["mass"]["torque_capacity"], rel=1e-6
    )


@pytest.mark.slow
def test_the_other_objective_is_held():
    front = synth.synthesize(FAMILY, DUTY, points=3, **SETTINGS)
    middle = sorted(front.designs, key=lambda d: d.values["mass"])[1]
    held = {"actuation_force": f"<= {middle.values['actuation_force']!r} N"}
    expected = central(
        lambda duty: lightest(duty, limits=held),
        "mass",
        lambda factor: {**DUTY, "load_torque": DUTY["load_torque"] * factor},
    )
    assert middle.elasticity["mass"]["load_torque"] == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
def test_a_limit_moved_by_the_user_costs_what_its_elasticity_says(light):
    weak = 0.8 * light.values["actuation_force"]
    duty = {**DUTY, "actuation_force_limit": weak}
    expected = central(lightest, "mass", lambda factor: {**duty, "actuation_force_limit": weak * factor})
    assert expected < -0.1
    found = lightest(duty).elasticity["mass"]
    assert found["actuation_force"] == pytest.approx(expected, rel=2e-3)
    assert found["actuation_force_limit"] == pytest.approx(expected, rel=2e-3)


class Followed(synth.DesignProblem):
    """A rod whose second load is made of the first by default, and a third of the second."""

    name = "followed"

    def declare(self, d):
        load = d.requirement("load", "kN", lower=1, upper=100)
        peak = d.requirement("peak", "kN", 2.0 * load)
        jolt = d.requirement("jolt", "kN", peak * peak / load)
        diameter = d.variable("diameter", "mm", 1, 200)
        d.derive("mass", "kg", 7850 * 0.785398 * diameter**2)
        d.at_least("strength", 100e6 * 0.785398 * diameter**2, jolt + load, "kN")
        d.objective("mass")


@pytest.mark.parametrize(("stated", "expected"), [({}, 1.0), ({"peak": 20.0}, -0.6), ({"jolt": 40.0}, 0.2)])
def test_what_a_default_makes_of_a_requirement_moves_with_it(stated, expected):
    # mass ~ jolt + load: 5 load where all follow, 400/load + load where the peak is stated, 40 + load.
    (design,) = synth.synthesize(Followed, {"load": 10.0, **stated}, gap=1e-5).designs
    assert design.elasticity["mass"]["load"] == pytest.approx(expected, rel=1e-4)
    if not stated:
        assert design.elasticity["mass"]["peak"] == pytest.approx(1.6, rel=1e-4)  # 2 * 40 of 50


# -- many designs at once ------------------------------------------------------------------------------


def test_elasticities_of_many_designs_are_those_of_each():
    search = pose(Strut(), {"load": "20 kN", "room": "150 mm"}, None, 12, {"rods": RODS}).search()
    search.run(Report(weights=[1.0, 1.0], explained=False))
    form, listed = search.state.form, search.state.front
    assert len(listed) == 12
    together = elasticities(form, listed, 2)
    for own, found in zip(listed, together, strict=True):
        (alone,) = elasticities(form, [own], 2)
        assert list(found) == list(alone) == ["mass", "flexibility"]
        for objective in alone:
            assert found[objective] == pytest.approx(alone[objective], rel=1e-12)


def test_elasticities_of_questions_searched_together_are_those_of_each_alone():
    # The second load follows the first one in every question, at its own slope.
    family = synth.load(Followed)
    ask = [pose(family, {"load": load}, ["mass"], 1, gap=1e-5) for load in (10.0, 20.0, 40.0)]
    search = JointSearch(ask)
    fronts = search.answers()
    for front, question in zip(fronts, ask, strict=True):
        (own,), (alone,) = front.designs, question.answer().designs
        assert own.elasticity["mass"] == pytest.approx(alone.elasticity["mass"], rel=1e-6)
        assert own.elasticity["mass"]["load"] == pytest.approx(1.0, rel=1e-4)


class Boxed(synth.DesignProblem):
    """Parts and a count, and nothing continuous."""

    name = "boxed"

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e6)
        bolts = d.count("bolts", 1, 12)
        rod = d.part("material", "rods")
        d.derive("mass", "kg", bolts * rod.density)
        d.at_most("stress", load / (bolts * 1e-4), rod.stress_allow, "N/mm2")
        d.objective("mass")


def test_without_variables_nothing_has_a_price():
    (design,) = synth.synthesize(Boxed, {"load": 50e3}, catalogs={"rods": RODS}).designs
    assert design.values["bolts"] == 4
    assert design.elasticity == {"mass": {}}
