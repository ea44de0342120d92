"""Disc and cone clutch against plain enumeration: nothing makeable beats a front by more than its gap.

Every combination and every makeable dimension inside the limits of an instance is evaluated, with the ramp given.
Torque, pressure and power grow with the force, so the least force that carries what must be carried is tried first,
then a ladder of larger ones for objectives that fall with the force.
"""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

pytestmark = pytest.mark.slow

GAP = 1e-3
LADDER = (1.0, 1.04, 1.15, 1.4, 1.9)
DISC = {"load_torque": "60 N*m", "driver_speed": "1500 rpm", "driven_inertia": "0.7 kg*m2", "safety_factor": 2.5}
CONE = {"load_torque": "200 N*m", "driver_speed": "700 rpm", "driven_inertia": "2 kg*m2"}
INSTANCES = {
    "car": (
        "disc_clutch",
        {**DISC, "engagements_per_hour": 20, "startup_torque": "120 N*m"},
        {"friction_pair": ["woven_dry", "wound_yarn_dry", "moulded_dry"]},
        {
            "ring_outer_diameter": "170 mm .. 240 mm",
            "pressure_plate_thickness": "3 mm .. 6 mm",
            "ramp_time": "== 0.6 s",
        },
    ),
    "twin": (
        "disc_clutch",
        {**DISC, "load_torque": "120 N*m", "driver_speed": "900 rpm", "actuation_force_limit": "6 kN"},
        {"friction_pair": ["sinter_bronze_dry", "moulded_dry"]},
        {
            "ring_outer_diameter": "150 mm .. 230 mm",
            "pressure_plate_thickness": "3 mm .. 6 mm",
            "ramp_time": "== 0.3 s",
        },
    ),
    "drive": (
        "cone_clutch",
        {**CONE, "outer_diameter_limit": "280 mm"},
        {"friction_pair": ["millboard_dry", "moulded_dry"]},
        {
            "mean_diameter": "215 mm .. 262 mm",
            "shell_thickness": "3 mm .. 4 mm",
            "cone_half_angle": "22 deg .. 25 deg",
            "ramp_time": "== 0.3 s",
        },
    ),
    "inner": (
        "cone_clutch",
        {**CONE, "overload_torque": "620 N*m", "bearing_force_limit": "2 kN", "engagements_per_hour": 20},
        {"friction_pair": ["sinter_bronze_dry", "moulded_dry"]},
        {
            "mean_diameter": "205 mm .. 230 mm",
            "shell_thickness": "3 mm .. 4 mm",
            "cone_half_angle": "20.5 deg .. 24 deg",
            "ramp_time": "== 0.3 s",
        },
    ),
}
OBJECTIVES = ("mass", "actuation_force", "friction_work", "outer_diameter", "length", "volume")


def dimensions(instance):
    """All makeable dimensions inside the limits, force left out: columns in the order of the variables."""
    names = [v.name for v in instance.model.variables]
    axes = {
        name: grid[(grid >= low - 1e-12) & (grid <= high + 1e-12)] if len(grid) else np.array([low])
        for name, grid, low, high in zip(
            names, instance.ranges.grids(), instance.ranges.lower, instance.ranges.upper, strict=True
        )
    }
    if "ring_inner_diameter" in axes:
        first, second, ratio = "ring_outer_diameter", "ring_inner_diameter", lambda a, b: (a - b) / (a + b)
        least, most = 0.1095, 0.1305
    else:
        first, second, ratio = "mean_diameter", "generator_length", lambda a, b: b / a
        least, most = 0.1495, 0.2005
    pairs = np.array([(a, b) for a in axes[first] for b in axes[second] if least <= ratio(a, b) <= most])
    others = [n for n in names if n not in (first, second)]
    index = np.meshgrid(np.arange(len(pairs)), *[np.arange(len(axes[n])) for n in others], indexing="ij")
    points = {n: axes[n][k.ravel()] for n, k in zip(others, index[1:], strict=True)}
    points |= {first: pairs[index[0].ravel(), 0], second: pairs[index[0].ravel(), 1]}
    return names, np.stack([points[n] for n in names], axis=1)


@pytest.fixture(scope="module", params=INSTANCES)
def enumerated(request):
    family, requirements, parts, limits = INSTANCES[request.param]
    instance = instance_of(
        synth.load(family, practice="off"), requirements, as_catalogs(None), parts=parts, limits=limits
    )
    names, points = dimensions(instance)
    force = names.index("actuation_force")
    found = []
    for combination in range(instance.combinations.count):
        data = instance.data(np.array([combination]))
        trial = points.copy()
        trial[:, force] = 1e3
        base = instance.model.evaluate(trial, data)
        needed = instance.values.requirements["required_torque"] / base.values.get("worn_torque", base.values["torque"])
        for factor in LADDER:
            trial = points.copy()
            trial[:, force] = 1e3 * needed * factor
            result = instance.evaluate(trial, data)
            feasible = result.feasible
            found.append(np.stack([result.values[n][feasible] for n in OBJECTIVES], axis=1))
    values = np.concatenate(found)
    assert len(values) > 2000
    return request.param, dict(zip(OBJECTIVES, values.T, strict=True))


def search(name, **more):
    family, requirements, parts, limits = INSTANCES[name]
    front = synth.synthesize(
        synth.load(family, practice="off"), requirements, parts=parts, limits=limits, gap=GAP, time_limit=60, **more
    )
    assert front.interrupted == ""
    assert front.certificate.kind == "global"
    return front


FRONTS = {
    "car": ("friction_work", "mass"),
    "twin": ("mass", "actuation_force"),
    "drive": ("mass", "actuation_force"),
    "inner": ("mass", "actuation_force"),
}


def test_no_enumerated_design_beats_a_front(enumerated):
    name, values = enumerated
    objectives = FRONTS[name]
    front = search(name, objectives=list(objectives), points=4)
    every = np.stack([values[n] for n in objectives], axis=1)
    for design in front.designs:
        own = np.array([design.values[n] for n in objectives])
        assert not np.any(np.all(every < own * (1 - GAP) - 1e-12, axis=1))
    for k, objective in enumerate(objectives):
        assert min(d.values[objective] for d in front.designs) <= every[:, k].min() * (1 + GAP)


def test_no_enumerated_design_beats_a_single_objective(enumerated):
    name, values = enumerated
    objective = {"car": "outer_diameter", "inner": "length", "twin": "volume", "drive": "volume"}[name]
    best = search(name, objectives=[objective]).designs[0]
    assert best.values[objective] <= values[objective].min() * (1 + GAP)
    family, requirements, _, limits = INSTANCES[name]
    again = synth.evaluate(synth.load(family, practice="off"), requirements, best, limits=limits)
    assert again.status.value == "feasible"
    assert again.values == best.values
    assert again.off_grid == {}
