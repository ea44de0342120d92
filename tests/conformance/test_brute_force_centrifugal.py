"""Centrifugal clutches against plain enumeration: nothing on the whole grid beats a front by more than its gap.

Every combination and every makeable radius and deflection is evaluated. What is continuous is pinned, or laid on a fine
ladder, whose designs are feasible ones and must not beat the front either.
"""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

pytestmark = pytest.mark.slow

GAP = 1e-3
SPEEDS = {
    "idle_speed": "80 rad/s",
    "contact_speed_min": "95 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
CASES = {
    "ball_ramp": (
        "centrifugal_ball_ramp",
        {},
        {**SPEEDS, "required_torque": "60 N*m", "clamp_force_limit": "9 kN", "driven_inertia": "0.1 kg*m2"},
        {
            "ball": ["ball 18", "ball 20", "ball 22"],
            "return_spring": ["CS-1x5x3.5", "CS-1.25x6.3x5.5"],
            "friction_pair": ["metal_ceramic_bronze_dry", "sinter_iron_dry"],
        },
        {
            "rest_radius": "36 mm .. 50 mm",
            "lining_inner_radius": "37 mm .. 38 mm",
            "lining_outer_radius": "47 mm .. 48 mm",
            "spring_preload_deflection": "1 mm .. 4 mm",
            "balls": "9 .. 11",
            "return_springs": "2 .. 4",
        },
        {"friction_surfaces": 8, "plate_gap": "2 mm"},
        {"ramp_ratio": 21},
        ("outer_diameter", "engagement_band"),
    ),
    "two_spring": (
        "centrifugal_two_spring",
        {},
        {**SPEEDS, "required_torque": "90 N*m", "lining_wear": "0.4 mm", "driven_inertia": "0.1 kg*m2"},
        {
            "ball": ["ball 25", "ball 30"],
            "return_spring": ["CS-1.25x6.3x5.5"],
            "clamp_spring": ["CS-2.5x12.5x5.5", "CS-2x10x3.5"],
            "friction_pair": ["metal_ceramic_bronze_dry"],
        },
        {
            "rest_radius": "36 mm .. 42 mm",
            "stop_travel": "5 mm .. 9 mm",
            "clamp_preload_deflection": "0.8 mm .. 1.2 mm",
            "return_preload_deflection": "3.9 mm .. 4.1 mm",
            "balls": "4 .. 5",
            "return_springs": "2 .. 3",
            "clamp_springs": "3 .. 4",
        },
        {
            "friction_surfaces": 8,
            "plate_travel": "1 mm",
            "lining_inner_radius": "44 mm",
            "lining_outer_radius": "56 mm",
        },
        {"ramp_ratio": 31},
        ("outer_diameter", "engagement_band"),
    ),
    "lever": (
        "centrifugal_two_spring",
        {"mechanism": "lever"},
        {**SPEEDS, "required_torque": "90 N*m", "lining_wear": "0.4 mm", "driven_inertia": "0.1 kg*m2"},
        {
            "return_spring": ["CS-1.25x6.3x5.5"],
            "clamp_spring": ["CS-2.5x12.5x5.5", "CS-2x10x3.5"],
            "friction_pair": ["metal_ceramic_bronze_dry"],
        },
        {
            "rest_radius": "32 mm .. 36 mm",
            "stop_travel": "5 mm .. 9 mm",
            "flyweight_arm": "56 mm .. 62 mm",
            "axial_arm": "29 mm .. 30 mm",
            "return_springs": "2 .. 3",
            "clamp_springs": "3 .. 4",
        },
        {
            "friction_surfaces": 8,
            "plate_travel": "1 mm",
            "lining_inner_radius": "44 mm",
            "lining_outer_radius": "56 mm",
            "weights": 3,
            "return_preload_deflection": "4 mm",
            "clamp_preload_deflection": "1 mm",
        },
        {"flyweight_mass": 41},
        ("outer_diameter", "engagement_band"),
    ),
}
QUANTITIES = ("outer_diameter", "mass", "engagement_band")


def enumerate_all(case):
    """Return the objectives of all feasible designs on the ladder."""
    family, options, requirements, parts, limits, pins, ladders, _ = CASES[case]
    problem = synth.load(family, practice="off", **options)
    instance = instance_of(problem, requirements, as_catalogs(None), parts=parts, limits=limits, fix=pins)
    names = [v.name for v in instance.model.variables]
    axes = []
    for k, (name, grid) in enumerate(zip(names, instance.ranges.grids(), strict=True)):
        low, high = instance.ranges.lower[k], instance.ranges.upper[k]
        if name in ladders:
            axes.append(np.linspace(low, high, ladders[name]))
        elif low == high or not len(grid):
            axes.append(np.array([low]))
        else:
            axes.append(np.asarray(grid))
    points = np.stack([x.ravel() for x in np.meshgrid(*axes, indexing="ij")], axis=1)
    found = []
    for combination in range(instance.combinations.count):
        result = instance.evaluate(points, instance.data(np.array([combination])))
        feasible = result.feasible
        found.append(np.stack([np.broadcast_to(result.values[n], len(points))[feasible] for n in QUANTITIES], axis=1))
    return dict(zip(QUANTITIES, np.concatenate(found).T, strict=True)), len(points) * instance.combinations.count


@pytest.mark.parametrize("case", CASES)
def test_no_makeable_design_beats_the_front(case):
    every, looked = enumerate_all(case)
    family, options, requirements, parts, limits, pins, _, objectives = CASES[case]
    assert looked > 3e5
    assert len(every["mass"]) > 300
    front = synth.synthesize(
        synth.load(family, practice="off", **options),
        requirements,
        objectives=list(objectives),
        parts=parts,
        limits=limits,
        fix=pins,
        points=3,
        gap=GAP,
        time_limit=60,
    )
    assert front.certificate.kind == "global"
    values = np.stack([every[n] for n in objectives], axis=1)
    own = np.array([[d.values[n] for n in objectives] for d in front.designs])
    for design in own:
        assert not np.any(np.all(values < design * (1 - GAP) - 1e-12, axis=1))
    # The best of each objective is at least as good as the ladder's, and the ladder comes near to it.
    best, ladder = own.min(axis=0), values.min(axis=0)
    assert np.all(best <= ladder * (1 + GAP))
    assert np.all(best >= ladder * 0.97)
