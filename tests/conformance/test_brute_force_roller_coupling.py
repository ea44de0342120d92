"""The roller coupling against plain enumeration: nothing on the whole grid beats a front by more than its gap.

Every combination and every makeable arm radius, guide half length, contact length and rim are evaluated. The offset
capacity is continuous: it is tried at the offset asked for and, where it is an objective, at the most that each of the
three clearances leaves.
"""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

pytestmark = pytest.mark.slow

GAP = 1e-3
CASES = {
    "plain": (
        {},
        {"required_torque": "150 N*m", "driver_speed": "1450 rpm", "offset": "5 mm"},
        {"roller": ["6001", "6002", "6202"], "float_material": ["100Cr6", "Ti-6Al-4V"]},
        {
            "arm_radius": "30 mm .. 48 mm",
            "guide_half_length": "38 mm .. 58 mm",
            "contact_length": "3 mm .. 8 mm",
            "rim": "3 mm .. 4.5 mm",
        },
    ),
    "crowned": (
        {"roller_contact": "crowned"},
        {
            "required_torque": "90 N*m",
            "driver_speed": "2880 rpm",
            "offset": "3 mm",
            "shaft_angle": "1.5 deg",
            "float_distance": "100 mm",
            "guide_angle": "75 deg",
            "outer_diameter_limit": "180 mm",
        },
        {"roller": ["NATV 12", "NUTR 15"], "float_material": ["100Cr6", "EN AW-7075-T6"]},
        {
            "arm_radius": "30 mm .. 60 mm",
            "guide_half_length": "40 mm .. 70 mm",
            "contact_length": "5 mm .. 9 mm",
            "rim": "3 mm .. 4 mm",
        },
    ),
}
NAMES = ("outer_diameter", "mass", "pin_force", "vibration_force", "offset_capacity")


def enumerate_all(case):
    """Return the objectives of all feasible makeable designs."""
    options, requirements, parts, limits = CASES[case]
    instance = instance_of(
        synth.load("roller_coupling", practice="off", **options),
        requirements,
        as_catalogs(None),
        parts=parts,
        limits=limits,
    )
    arms, halves, lengths, rims, _ = instance.ranges.grids()
    asked = instance.values.requirements
    effective = np.hypot(asked["offset"], asked["float_distance"] * np.tan(asked["shaft_angle"]))
    chi = asked["guide_angle"]
    grid = np.meshgrid(arms, halves, lengths, rims, indexing="ij")
    arm, half, length, rim = (x.ravel() for x in grid)
    found = []
    for combination in range(instance.combinations.count):
        data = instance.data(np.array([combination]))
        parts_of, _, _ = instance.combinations.describe(combination)
        table, row = parts_of["roller"]
        diameter = table.number("outer_diameter")[row]
        most = np.minimum(
            2 * arm * np.sin(chi / 2) - diameter - asked["roller_gap_min"],
            np.sin(chi)
            * np.minimum(arm - diameter / 2 / np.tan(chi / 2) - asked["run_in_min"], half - arm - asked["run_out_min"]),
        )
        inside = most >= effective
        for capacity in (np.full_like(most, effective), most):
            points = np.stack([arm, half, length, rim, capacity], axis=1)[inside]
            result = instance.evaluate(points, data)
            feasible = result.feasible
            found.append(np.stack([result.values[n][feasible] for n in NAMES], axis=1))
    return dict(zip(NAMES, np.concatenate(found).T, strict=True))


@pytest.fixture(scope="module", params=CASES)
def enumerated(request):
    return request.param, enumerate_all(request.param)


PAIRS = [("outer_diameter", "mass"), ("pin_force", "mass"), ("vibration_force", "mass"), ("offset_capacity", "mass")]


@pytest.mark.parametrize("objectives", PAIRS, ids="-".join)
def test_no_makeable_design_beats_the_front(enumerated, objectives):
    case, every = enumerated
    options, requirements, parts, limits = CASES[case]
    front = synth.synthesize(
        synth.load("roller_coupling", practice="off", **options),
        requirements,
        objectives=list(objectives),
        parts=parts,
        limits=limits,
        points=6,
        gap=GAP,
        time_limit=60,
    )
    assert front.certificate.kind == "global"
    assert len(every["mass"]) > 3000
    signs = np.array([-1.0 if name == "offset_capacity" else 1.0 for name in objectives])
    values = np.stack([every[n] for n in objectives], axis=1) * signs
    own = np.array([[d.values[n] for n in objectives] for d in front.designs]) * signs
    # What can be zero or is to be large is measured by its range on the front.
    spread = np.where(
        [name in ("vibration_force", "offset_capacity") for name in objectives], np.ptp(own, axis=0), np.abs(own)
    )
    for design, size in zip(own, spread, strict=True):
        assert not np.any(np.all(values < design - GAP * size - 1e-12, axis=1))
    assert np.all(own.min(axis=0) <= values.min(axis=0) + GAP * np.abs(values.min(axis=0)) + 1e-12)
