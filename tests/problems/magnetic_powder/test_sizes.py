"""Powder clutches of any torque: searched over sizes that follow from it, so that limits decide and no bound."""

from __future__ import annotations

import pytest

import synth

pytestmark = pytest.mark.slow
SEARCHED = ("gap_radius", "pole_length", "coil_length", "coil_height", "yoke_thickness")


def test_a_small_clutch_is_smaller_than_any_bound_of_a_large_one():
    wants = {"required_torque": "1.695 N*m", "driver_speed": "1000 1/min"}
    front = synth.synthesize("magnetic_powder_clutch", wants, points=2)
    assert front.status.value == "optimal"
    assert all(front.designs[0].values[name] < 0.06 for name in SEARCHED)


@pytest.mark.parametrize(
    ("torque", "speed", "limit"),
    [
        ("0.226 N*m", 1000, "powder_per_torque"),
        ("0.565 N*m", 1000, "powder_per_torque"),
        ("2e6 N*m", 500, "torque_capacity"),
    ],
)
def test_what_is_infeasible_is_so_by_a_limit(torque, speed, limit):
    wants = {"required_torque": torque, "driver_speed": f"{speed} 1/min"}
    assert synth.synthesize("magnetic_powder_clutch", wants, points=1).status.value == "infeasible"
    assert limit in synth.explain("magnetic_powder_clutch", wants).conflict
