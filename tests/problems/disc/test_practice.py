"""The complete disc clutch and the rules of practice: worked numbers, and what each rule does."""

import pytest

import synth

DUTY = {
    "load_torque": "60 N*m",
    "driver_speed": "1500 1/min",
    "driven_inertia": "0.7 kg*m2",
    "safety_factor": 2.5,
    "engagements_per_hour": "20 1/h",
    "startup_torque": "120 N*m",
    "top_speed": "7000 1/min",
}
# The worked numbers were computed with these, some of which are no longer defaults.
THEN = {"plate_gap": "0.35 mm", "shaft_shear_allow": "40 N/mm2", "wear_depth_limit": "0.7 mm", "ring_ratio_min": 0.12}
THIN = (
    {
        "ring_outer_diameter": "205 mm",
        "ring_inner_diameter": "158 mm",
        "pressure_plate_thickness": "3 mm",
        "actuation_force": "3500 N",
    },
    "wound_yarn_dry",
)
THICK = (
    {
        "ring_outer_diameter": "215 mm",
        "ring_inner_diameter": "145 mm",
        "pressure_plate_thickness": "11 mm",
        "actuation_force": "2850 N",
    },
    "moulded_dry",
)
WORK = 19947.1087  # J, for which the wear lives were worked out: they go with its inverse


def design(case, requirements=None, duty=DUTY, **options):
    sizes, pair = case
    return synth.evaluate(
        synth.load("disc_clutch", **{"practice": "on", **options}),
        {**duty, **(requirements or {})},
        values={**sizes, "discs": 1, "ramp_time": "0.5 s"},
        parts={"friction_pair": pair},
    )


def missed(found):
    """Return the limits that a design does not keep."""
    return {name for name, residual in found.residuals.items() if residual > 1e-6}


# SI; by hand from the formulas, each to the digits given.
@pytest.mark.parametrize(
    ("case", "part", "mass", "length", "life", "speed", "thickness"),
    [
        (THIN, 0.914178, 2.34623, 39.9833e-3, 11755.8, 7453.11, 10.25e-3),
        (THICK, 2.33710, 4.07203, 47.35e-3, 23151.9, 7106.45, 10.75e-3),
    ],
)
def test_worked_numbers(case, part, mass, length, life, speed, thickness):
    found = design(case, THEN)
    assert found.frame.requirement_values["required_torque"] == pytest.approx(176.4706, rel=1e-6)
    assert found.values["part_mass"] == pytest.approx(part, rel=6e-6)
    assert found.values["mass"] == pytest.approx(mass, rel=6e-6)
    assert found.values["length"] == pytest.approx(length, rel=6e-6)
    assert found.values["wear_life"] * found.values["friction_work"] / WORK == pytest.approx(life, rel=6e-6)
    value, bound = found.limits["rim_speed"]
    assert 7000 * bound / value == pytest.approx(speed, rel=6e-6)
    assert found.limits["pressure_plate_stiffness"][1] == pytest.approx(thickness, rel=1e-9)
    assert found.limits["hub_bore"][1] == pytest.approx(21.1636e-3, rel=6e-6)


@pytest.mark.slow
def test_every_rule_can_bind_and_can_be_widened():
    assert "pressure_plate_stiffness" in missed(design(THIN))
    assert "pressure_plate_stiffness" not in missed(design(THIN, {"plate_stiffness_ratio": 70}))
    assert "release_clearance" in missed(design(THICK, {"plate_gap": "0.3 mm"}))
    assert "release_clearance" not in missed(design(THICK, {"plate_gap": "0.3 mm", "disc_runout": "0.6 mm"}))
    assert "release_clearance" not in missed(design(THICK))
    assert "pressure_use" in missed(design(THICK, {"pressure_use_min": 0.33}))
    assert "pressure_use" not in missed(design(THICK))
    assert "rim_speed" in missed(design(THICK, {"top_speed": "7200 1/min"}))
    assert "rim_speed" not in missed(design(THICK, {"top_speed": "7200 1/min", "rim_speed_limit": "90 m/s"}))
    assert "ring_ratio_min" in missed(design(THIN, {"ring_ratio_min": 0.26}))
    life = design(THICK).values["wear_life"]
    assert "wear_life" in missed(design(THICK, {"wear_life_min": 1.01 * life}))
    assert "wear_life" not in missed(design(THICK, {"wear_life_min": 0.99 * life}))
    short = design(THIN, {"wear_depth_limit": "0.1 mm"})
    assert any(remark.startswith("few_starts") for remark in short.advice)
    assert not any(remark.startswith("few_starts") for remark in design(THICK).advice)


def test_without_practice_nothing_is_added():
    duty = {name: value for name, value in DUTY.items() if name != "top_speed"}
    plain = design(THICK, duty=duty, practice="off")
    whole = design(THICK, {"disc_hub_radius": "20 mm"}, duty, practice="off", mass_scope="complete")
    assert whole.values["part_mass"] == plain.values["mass"]
    assert whole.values["mass"] > plain.values["mass"]
    for found in (plain, whole):
        assert not {"pressure_plate_stiffness", "pressure_use", "release_clearance", "rim_speed"} & set(found.limits)
    assert "wear_life" not in plain.values


def test_designs_by_practice_are_ones_that_are_built():
    front = synth.synthesize(synth.load("disc_clutch", practice="on"), {**DUTY, "top_speed": "6000 1/min"}, points=5)
    assert front.certificate.kind == "global"
    assert len(front.designs) == 5
    for found in front.designs:
        assert found.values["pressure_plate_thickness"] >= found.values["ring_outer_diameter"] / 20 * (1 - 1e-9)
        assert found.values["surface_pressure"] >= 0.3 * found.parts["friction_pair"]["p_mean_allow"] * (1 - 1e-9)
        assert 0.17 - 1e-9 <= found.values["ring_ratio"] <= 0.28 + 1e-9
