"""Clutches with a coil against plain enumeration: nothing makeable beats a front by more than its gap.

Every combination and every makeable dimension inside the limits is evaluated. Power grows with the flux density and
inertia does not see it, so the least flux density that carries the torque is the best one; it is a closed form.
"""

import math

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

pytestmark = pytest.mark.slow

GAP = 1e-3
FAMILY = synth.load("magnetic_powder_clutch", practice="off")
ASKED = {"required_torque": "30 N*m", "outer_diameter_limit": "236 mm"}
PARTS = {"powder": ["carbonyl_graphite", "carbonyl_glass"], "winding_wire": ["Cu 0.8 class 155"]}
LIMITS = {
    "gap_radius": "70 mm .. 76 mm",
    "pole_length": "22 mm .. 28 mm",
    "coil_height": "20 mm .. 22 mm",
    "yoke_thickness": "12 mm .. 13 mm",
    "powder_gap": "1.2 mm .. 1.25 mm",
}
FIX = {"coil_length": "48 mm"}
OBJECTIVES = ("coil_power", "input_inertia", "mass", "outer_diameter")


@pytest.fixture(scope="module")
def enumerated():
    instance = instance_of(FAMILY, ASKED, as_catalogs(None), parts=PARTS, limits=LIMITS, fix=FIX)
    names = [v.name for v in instance.model.variables]
    axes = [
        grid[(grid >= low - 1e-12) & (grid <= high + 1e-12)] if len(grid) else np.array([low])
        for grid, low, high in zip(instance.ranges.grids(), instance.ranges.lower, instance.ranges.upper, strict=True)
    ]
    points = np.stack([x.ravel() for x in np.meshgrid(*axes, indexing="ij")], axis=1)
    radius, pole = points[:, names.index("gap_radius")], points[:, names.index("pole_length")]
    found = []
    for combination in range(instance.combinations.count):
        table, row = instance.combinations.describe(combination)[0]["powder"]
        needed = 1.2 * 30 / (4 * math.pi * pole * radius**2) * (1 + 1e-9)
        most, half = (float(table.number(c)[row]) for c in ("tau_sat", "half_flux_density"))
        points[:, names.index("flux_density")] = half / np.sqrt(most / needed - 1)
        result = instance.evaluate(points, instance.data(np.array([combination])))
        feasible = result.feasible
        found.append(np.stack([result.values[n][feasible] for n in OBJECTIVES], axis=1))
    values = np.concatenate(found)
    assert len(values) > 1000
    return dict(zip(OBJECTIVES, values.T, strict=True))


def search(**more):
    front = synth.synthesize(FAMILY, ASKED, parts=PARTS, limits=LIMITS, fix=FIX, gap=GAP, time_limit=60, **more)
    assert front.interrupted == ""
    assert front.certificate.kind == "global"
    return front


def test_no_makeable_design_beats_the_front(enumerated):
    front = search(points=4)
    values = np.stack([enumerated[n] for n in ("coil_power", "input_inertia")], axis=1)
    own = np.array([[d.values[n] for n in ("coil_power", "input_inertia")] for d in front.designs])
    for design in own:
        assert not np.any(np.all(values < design * (1 - GAP) - 1e-12, axis=1))
    assert np.all(own.min(axis=0) <= values.min(axis=0) * (1 + GAP))
    # Both parts of the front: much less power with the coil that turns, much less inertia with the one that does not.
    assert {d.choices["coil"] for d in front.designs} == {"stationary", "rotating"}


def test_no_makeable_design_is_lighter(enumerated):
    best = search(objectives=["mass"]).designs[0]
    assert best.values["mass"] <= enumerated["mass"].min() * (1 + GAP)
    assert best.off_grid == {}


# -- the electromagnetic clutch ------------------------------------------------------------------------

SPINDLE = {"load_torque": "8 N*m", "driver_speed": "960 1/min", "driven_inertia": "0.05 kg*m2"}
PRESSED = {
    "friction_pair": ["steel_steel_wet"],
    "inner_plate": ["core 1.5"],
    "outer_plate": ["core 1.5"],
    "winding_wire": ["Cu 0.5 class 155"],
}
PINNED = {"ramp_time": "0.1 s", "ring_outer_diameter": "112 mm", "ring_inner_diameter": "90 mm", "coil_length": "30 mm"}
MAGNETS = {
    "friction_surfaces": "2 .. 4",
    "inner_pole_width": "11 mm .. 14 mm",
    "coil_height": "18 mm .. 21 mm",
    "yoke_thickness": "11 mm .. 12.5 mm",
}


def least_flux_density(instance, points, position, combination, steps=60):
    """Least flux density that gives torque and pull-in, by halving: both grow with it."""
    data = instance.data(np.array([combination]))
    low, high = np.full(len(points), 0.02), np.full(len(points), 1.25)
    for _ in range(steps):
        points[:, position] = (low + high) / 2
        result = instance.model.evaluate(points, data)
        torque, asked = result.limits["torque_capacity"]
        pull, needed = result.limits["pull_in"]
        with np.errstate(invalid="ignore"):
            enough = (torque >= asked) & ~(pull < needed)  # a pull that does not exist is one of saturated iron
        high, low = np.where(enough, points[:, position], high), np.where(enough, low, points[:, position])
    points[:, position] = high
    return instance.model.evaluate(points, data)


def test_no_makeable_magnet_beats_the_front():
    """Power and saturation grow with the flux density, mass does not see it: the least one is the best."""
    family = "electromagnetic_clutch"
    instance = instance_of(
        synth.load(family, practice="off"), SPINDLE, as_catalogs(None), parts=PRESSED, limits=MAGNETS, fix=PINNED
    )
    names = [v.name for v in instance.model.variables]
    axes = [
        grid[(grid >= low - 1e-12) & (grid <= high + 1e-12)] if len(grid) else np.array([low])
        for grid, low, high in zip(instance.ranges.grids(), instance.ranges.lower, instance.ranges.upper, strict=True)
    ]
    points = np.stack([x.ravel() for x in np.meshgrid(*axes, indexing="ij")], axis=1)
    found = []
    for combination in range(instance.combinations.count):
        result = least_flux_density(instance, points, names.index("flux_density"), combination)
        found.append(np.stack([result.values[n][result.feasible] for n in ("coil_power", "mass")], axis=1))
    values = np.concatenate(found)
    assert len(values) > 100
    front = synth.synthesize(
        synth.load(family, practice="off"),
        SPINDLE,
        parts=PRESSED,
        limits=MAGNETS,
        fix=PINNED,
        gap=GAP,
        points=4,
        time_limit=60,
    )
    assert front.interrupted == ""
    assert front.certificate.kind == "global"
    own = np.array([[d.values[n] for n in ("coil_power", "mass")] for d in front.designs])
    for design in own:
        assert not np.any(np.all(values < design * (1 - GAP) - 1e-12, axis=1))
    assert np.all(own.min(axis=0) <= values.min(axis=0) * (1 + GAP))
    # And nothing is claimed that cannot be made.
    assert np.all(own.min(axis=0) >= values.min(axis=0) * (1 - GAP))
