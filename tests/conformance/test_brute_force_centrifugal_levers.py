"""The centrifugal clutches with levers against plain enumeration: nothing on the grid beats a front beyond its gap.

Every combination and every makeable size are evaluated. The mass is continuous: less of it makes every objective
better, so that each point gets the least that its speeds allow, from speed**2 ~ 1/mass.
"""

import numpy as np
import pytest
from synth.problems.centrifugal.cases import ENGINE

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

pytestmark = pytest.mark.slow

GAP = 1e-3
FIXED = {"friction_surfaces": 2, "weights": 4, "lever_stop_angle": "0.34 rad", "lining_inner_radius": "60 mm"}
QUESTIONS = {
    "centrifugal_lever": {
        "parts": {"clamp_spring": ["CS-3.2x16x12.5", "CS-4x20x12.5"], "friction_pair": ["moulded_dry"]},
        "limits": {
            "outer_diameter": "<= 190 mm",
            "rest_radius": "48 mm .. 66 mm",
            "spring_arm": "17 mm .. 31 mm",
            "spring_preload_deflection": "9.8 mm .. 10.2 mm",
            "lining_outer_radius": "74 mm .. 90 mm",
            "clamp_springs": "6 .. 7",
        },
        "fix": {**FIXED, "rod_arm": "11 mm", "flyweight_arm": "35 mm"},
    },
    "centrifugal_reversed": {
        "parts": {
            "clamp_spring": ["CS-5x25x5.5"],
            "return_spring": ["CS-3.2x16x3.5", "CS-2.5x12.5x3.5"],
            "friction_pair": ["moulded_dry"],
        },
        "limits": {
            "outer_diameter": "<= 200 mm",
            "rest_radius": "45 mm .. 60 mm",
            "spring_preload_deflection": "15.9 mm .. 16.1 mm",
            "return_preload_deflection": "5.8 mm .. 6.2 mm",
            "lining_outer_radius": "74 mm .. 90 mm",
            "return_springs": "5 .. 6",
        },
        "fix": {**FIXED, "flyweight_arm": "40 mm", "plate_arm": "12 mm", "clamp_springs": 6},
    },
}
OBJECTIVES = ["outer_diameter", "engagement_band"]


def enumerate_all(family):
    """Return the objectives of all feasible makeable designs, each with the least mass."""
    instance = instance_of(synth.load(family, practice="off"), ENGINE, as_catalogs(None), **QUESTIONS[family])
    names = [v.name for v in instance.model.variables]
    grids = [
        np.array([1.0]) if name == "flyweight_mass" else grid if len(grid) else np.array([low])
        for name, grid, low in zip(names, instance.ranges.grids(), instance.ranges.lower, strict=True)
    ]
    points = np.stack([x.ravel() for x in np.meshgrid(*grids, indexing="ij")], axis=1)
    mass, asked, found = names.index("flyweight_mass"), instance.values.requirements, []
    for combination in range(instance.combinations.count):
        data = instance.data(np.array([combination]))
        unit = instance.model.evaluate(points, data).values
        least = np.maximum(
            (unit["contact_speed"] / asked["contact_speed_max"]) ** 2,
            (unit["full_clamp_speed"] / asked["full_torque_speed"]) ** 2,
        )
        lightest = points.copy()
        lightest[:, mass] = np.clip(least, instance.ranges.lower[mass], instance.ranges.upper[mass])
        result = instance.evaluate(lightest, data)
        feasible = result.feasible
        found.append(np.stack([result.values[n][feasible] for n in OBJECTIVES], axis=1))
    return np.concatenate(found)


@pytest.mark.parametrize("family", QUESTIONS)
def test_no_makeable_design_beats_the_front(family):
    every = enumerate_all(family)
    question = QUESTIONS[family]
    front = synth.synthesize(
        synth.load(family, practice="off"), ENGINE, objectives=OBJECTIVES, points=2, gap=GAP, time_limit=60, **question
    )
    assert front.certificate.kind == "global"
    assert len(every) > 5_000
    own = np.array([[d.values[name] for name in OBJECTIVES] for d in front.designs])
    assert len(own) == 2
    for design in own:
        assert not np.any(np.all(every < design * (1 - GAP) - 1e-12, axis=1))
    assert np.all(own.min(axis=0) <= every.min(axis=0) * (1 + GAP))
