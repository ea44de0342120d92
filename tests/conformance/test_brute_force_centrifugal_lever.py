"""The lever with a headed rod against plain enumeration: nothing on the whole grid beats a front by more than its gap.

Every combination and every makeable rest radius, spring arm, preload deflection and outer lining radius are evaluated.
The mass is continuous: less of it makes every objective better, so that each point gets the least that its speeds
allow, from speed**2 ~ 1/mass.
"""

import numpy as np
import pytest

import synth
from synth.feasibility import holds, residual
from synth.instance import Instance, as_catalogs

GAP = 1e-3
REQUIREMENTS = {
    "required_torque": "90 N*m",
    "idle_speed": "80 rad/s",
    "contact_speed_max": "135 rad/s",
    "full_torque_speed": "200 rad/s",
    "top_speed": "500 rad/s",
}
QUESTION = {
    "parts": {"clamp_spring": ["CS-3.2x16x12.5", "CS-4x20x12.5"], "friction_pair": ["moulded_dry"]},
    "limits": {
        "outer_diameter": "<= 190 mm",
        "rest_radius": "48 mm .. 66 mm",
        "spring_arm": "17 mm .. 31 mm",
        "spring_preload_deflection": "9.8 mm .. 10.2 mm",
        "lining_outer_radius": "74 mm .. 90 mm",
        "clamp_springs": "6 .. 7",
    },
    "fix": {
        "friction_surfaces": 2,
        "weights": 4,
        "rod_arm": "11 mm",
        "flyweight_arm": "35 mm",
        "lever_stop_angle": "0.34 rad",
        "lining_inner_radius": "60 mm",
    },
}


@pytest.fixture(scope="module")
def everything():
    """Return the objectives of all feasible makeable designs, each with the least mass."""
    instance = Instance(synth.load("centrifugal_lever"), REQUIREMENTS, as_catalogs(None), **QUESTION)
    names = [v.name for v in instance.model.variables]
    grids = [
        np.array([1.0]) if name == "flyweight_mass" else grid if len(grid) else np.array([low])
        for name, grid, low in zip(names, instance.grids(), instance.lower, strict=True)
    ]
    points = np.stack([x.ravel() for x in np.meshgrid(*grids, indexing="ij")], axis=1)
    mass = names.index("flyweight_mass")
    found = []
    for combination in range(instance.combinations):
        data = instance.data(np.array([combination]))
        unit = instance.model.evaluate(points, data).values
        asked = instance.requirements
        least = np.maximum(
            (unit["contact_speed"] / asked["contact_speed_max"]) ** 2,
            (unit["full_clamp_speed"] / asked["full_torque_speed"]) ** 2,
        )
        lightest = points.copy()
        lightest[:, mass] = np.clip(least, instance.lower[mass], instance.upper[mass])
        result = instance.model.evaluate(lightest, data)
        feasible = result.feasible
        for extra in instance.extra:
            feasible = feasible & holds(residual(result.values[extra.quantity], extra.limit, extra.sense, 1e-9), False)
        found.append(np.stack([result.values[n][feasible] for n in ("outer_diameter", "engagement_band")], axis=1))
    return np.concatenate(found)


def test_no_makeable_design_beats_the_front(everything):
    front = synth.synthesize(
        "centrifugal_lever",
        REQUIREMENTS,
        objectives=["outer_diameter", "engagement_band"],
        points=3,
        gap=GAP,
        time_limit=60,
        **QUESTION,
    )
    assert front.certificate.kind == "global"
    assert len(everything) > 10_000
    own = np.array([[d.values["outer_diameter"], d.values["engagement_band"]] for d in front.designs])
    assert len(own) == 3
    for design in own:
        assert not np.any(np.all(everything < design * (1 - GAP) - 1e-12, axis=1))
    assert np.all(own.min(axis=0) <= everything.min(axis=0) * (1 + GAP))
