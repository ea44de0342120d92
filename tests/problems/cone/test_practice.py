"""The complete cone clutch and the rules of practice: worked numbers, and what each rule does."""

import math

import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of
from tests.problems.of_a_family import requirements_in_si

DUTY = {
    "load_torque": "200 N*m",
    "driver_speed": "700 1/min",
    "driven_inertia": "2 kg*m2",
    "engagements_per_hour": "20 1/h",
}
# The worked numbers were computed with these, which are no longer defaults.
THEN = {"shaft_shear_allow": "40 N/mm2", "wear_depth_limit": "5 mm"}
SIZES = {"mean_diameter": "226 mm", "generator_length": "34 mm", "ramp_time": "0.5 s"}
BLUNT = {**SIZES, "cone_half_angle": "23 deg", "shell_thickness": "3 mm", "actuation_force": "6382.78441 N"}
SHARP = {**SIZES, "cone_half_angle": "12.5 deg", "shell_thickness": "8 mm", "actuation_force": "5000 N"}
PARTS = {"friction_pair": "moulded_dry", "cone_layout": "outer_spring"}
RULES = {
    "cone_angle_min",
    "cone_angle_max",
    "release_pull",
    "shell_stiffness",
    "shell_hoop",
    "stroke",
    "hub_room",
    "pressure_use",
}


def design(sizes, requirements=None, parts=None, **options):
    return synth.evaluate(
        synth.load("cone_clutch", **{"practice": "on", **options}),
        {**DUTY, **(requirements or {})},
        values=sizes,
        parts=PARTS | (parts or {}),
    )


def missed(found):
    """Return the limits that a design does not keep."""
    return {name for name, residual in found.residuals.items() if residual > 1e-6}


# SI; by hand from the formulas, each to the digits given.
WORKED = {
    "blunt": (
        BLUNT,
        {
            "wedge_gain": 1.40271,
            "stroke": 5.88640e-3,
            "hoop_stress": 25.4890e6,
            "part_mass": 1.27218,
            "mass": 4.40193,
            "length": 67.2972e-3,
        },
        8953.17,
        {"cone_angle_max", "shell_stiffness"},
    ),
    "sharp": (
        SHARP,
        {
            "wedge_gain": 1.79165,
            "stroke": 10.6265e-3,
            "hoop_stress": 13.5171e6,
            "part_mass": 3.16717,
            "mass": 9.26924,
            "length": 79.1941e-3,
            "release_pull": 1559.45,
            "torque": 354.425,
        },
        8958.27,
        set(),
    ),
}


@pytest.mark.parametrize("name", WORKED)
def test_worked_numbers(name):
    sizes, values, normal, broken = WORKED[name]
    found = design(sizes, THEN)
    assert found.frame.requirement_values["required_torque"] == pytest.approx(352.9412, rel=1e-6)
    for quantity, value in values.items():
        assert found.values[quantity] == pytest.approx(value, rel=6e-6), quantity
    assert found.values["wedge_gain"] * found.values["actuation_force"] == pytest.approx(normal, rel=1e-6)
    assert found.limits["shell_stiffness"][1] == pytest.approx(7.53333e-3, rel=6e-6)
    assert found.limits["stroke"][1] == pytest.approx(16.3e-3, rel=1e-9)
    assert missed(found) & RULES == broken


def test_parts_of_the_mass():
    """Web, bosses and spring of the worked numbers, each by itself."""
    for sizes, web, spring in ((BLUNT, 1.84266, 0.455913), (SHARP, 4.91376, 0.357143)):
        found = design(sizes, THEN).values
        no_spring = design(sizes, THEN | {"spring_deflection": "1 mm"}).values
        assert (found["mass"] - no_spring["mass"]) * 20 / 19 == pytest.approx(spring, rel=6e-6)
        assert found["mass"] - found["part_mass"] - spring - web == pytest.approx(0.831176, rel=2e-5)


@pytest.mark.slow
def test_every_rule_can_bind_and_can_be_widened():
    assert {"cone_angle_max", "shell_stiffness"} <= missed(design(BLUNT))
    assert not missed(design(BLUNT, {"cone_angle_max": "23 deg", "shell_stiffness_ratio": 76})) & RULES
    assert not missed(design(SHARP))
    slender = {**SHARP, "cone_half_angle": "7.5 deg", "actuation_force": "4 kN"}
    assert {"cone_angle_min", "release_pull"} <= missed(design(slender))
    assert not missed(design(slender, {"cone_angle_min": "7 deg", "release_pull_max": 0.6})) & RULES
    assert "shell_hoop" in missed(design(SHARP, {"hoop_stress_limit": "13.5 N/mm2"}))
    assert "shell_hoop" not in missed(design(SHARP, {"hoop_stress_limit": "13.6 N/mm2"}))
    assert "stroke" in missed(design(SHARP, {"stroke_base": "0 mm", "stroke_per_diameter": 0.026}))
    assert "stroke" not in missed(design(SHARP, {"stroke_base": "0 mm", "stroke_per_diameter": 0.027}))
    # 226 mm less 34 mm sin(12.5 deg) and two shells of 8 mm leave 202.6 mm.
    assert "hub_room" in missed(design(SHARP, {"shaft_diameter": "136 mm"}))
    assert "hub_room" not in missed(design(SHARP, {"shaft_diameter": "135 mm"}))
    used = design(SHARP).values["surface_pressure"] / 0.45e6
    assert "pressure_use" in missed(design(SHARP, {"pressure_use_min": 1.01 * used}))
    assert "pressure_use" not in missed(design(SHARP, {"pressure_use_min": 0.99 * used}))
    life = design(SHARP).values["wear_life"]
    assert "wear_life" in missed(design(SHARP, {"wear_life_min": 1.01 * life}))
    assert "wear_life" not in missed(design(SHARP, {"wear_life_min": 0.99 * life}))


def test_wear_life_by_hand():
    """Face of pi 226 34 mm2 worn by 1 mm, 60 mm3/MJ."""
    found = design(SHARP).values
    volume = math.pi * 226 * 34 * 1.0
    assert found["wear_life"] == pytest.approx(volume / (60 * found["friction_work"] / 1e6), rel=1e-9)


def test_cones_that_come_apart_by_themselves_keep_the_margin_of_friction():
    forced, alone = design(SHARP), design(SHARP, cone_release="self")
    assert "self_locking" not in forced.limits
    assert alone.limits["self_locking"] == pytest.approx((math.tan(math.radians(12.5)), 1.05 * 0.4))
    assert "release_pull" not in alone.limits
    assert alone.values["release_pull"] == forced.values["release_pull"]
    assert "self_locking" in missed(alone)
    iron = {"friction_pair": "ci_ci_dry"}
    assert "self_locking" not in missed(design(SHARP, parts=iron, cone_release="self"))


def test_seated_cones_are_pulled_apart_with_more():
    """5 kN (0.4/tan(12.5 deg) - 1), and a remark above the spring force."""
    assert design(SHARP).values["seated_pull"] == pytest.approx(4021.4, rel=1e-4)

    def sticks(angle):
        return any(remark.startswith("sticks") for remark in design({**SHARP, "cone_half_angle": angle}).advice)

    assert math.degrees(math.atan(0.2)) == pytest.approx(11.31, abs=0.005)
    assert sticks("11.25 deg")
    assert not sticks("11.35 deg")


def test_remarks_of_practice_take_the_place_of_those_on_angles():
    codes = {remark.split(":")[0] for remark in design(BLUNT).advice}
    assert "little_wedge" in codes
    assert "blunt_cone" not in codes
    assert "little_wedge" not in {remark.split(":")[0] for remark in design(SHARP).advice}


def test_without_practice_nothing_is_added():
    plain = design(SHARP, practice="off")
    explicit = design(SHARP, practice="off", mass_scope="parts")
    whole = design(SHARP, practice="off", mass_scope="complete")
    assert plain.values == explicit.values
    assert whole.values["part_mass"] == plain.values["mass"]
    assert whole.values["mass"] > plain.values["mass"]
    assert whole.values["temperature_rise"] == plain.values["temperature_rise"]
    for found in (plain, whole):
        assert not RULES & set(found.limits)
        assert "self_locking" in found.limits
    assert "wear_life" not in plain.values


def test_angles_that_no_cone_can_have_are_refused():
    with pytest.raises(synth.InputError, match="bad_angles"):
        design(SHARP, {"cone_angle_min": "15 deg", "cone_angle_max": "12 deg"})


def test_linings_that_are_built_no_more_are_asked_for():
    def pairs(**options):
        instance = instance_of(synth.load("cone_clutch", **options), DUTY, as_catalogs(None))
        (slot,) = [s for s in instance.selection.slots if s.slot == "friction_pair"]
        return {slot.table.designations[k] for k in slot.rows}

    current, historical = pairs(practice="on"), pairs(practice="on", allow_obsolete="historical")
    assert historical - current == {"leather_dry", "leather_greased", "wood_dry", "cork_dry", "millboard_dry"}
    assert pairs(practice="off") == pairs(practice="on", allow_obsolete="historical", take_up="any")


def test_curves_mark_the_angle_that_the_pull_allows():
    problem = synth.load("cone_clutch", practice="on")
    found = design(SHARP)
    frame = problem.curves(requirements_in_si(problem, DUTY), found)["force_over_angle"]
    hard, pulled = frame.attrs["spans"]
    # At this angle the pull is half of the spring force.
    angle = math.radians(hard["to"])
    ratio = (0.4 * math.cos(angle) - math.sin(angle)) / (math.sin(angle) + 0.35 * math.cos(angle))
    assert ratio == pytest.approx(0.5)
    assert math.tan(math.radians(pulled["to"])) == pytest.approx(0.4)
    assert pulled["from"] == hard["to"]


@pytest.mark.slow
def test_designs_by_practice_are_ones_that_are_built():
    front = synth.synthesize(synth.load("cone_clutch", practice="on"), {**DUTY, "jerk_limit": "600 rad/s3"}, points=5)
    assert front.certificate.kind == "global"
    assert len(front.designs) == 5
    for found in front.designs:
        assert 8 - 1e-9 <= math.degrees(found.values["cone_half_angle"]) <= 18 + 1e-9
        assert found.values["shell_thickness"] >= found.values["mean_diameter"] / 30 * (1 - 1e-9)
        assert found.values["release_pull"] <= 0.5 * found.values["actuation_force"] * (1 + 1e-6)
        assert 4 < found.values["mass"] < 40
