"""Load and inertia of a machine behind a gear: worked numbers, words that contradict each other, the sheet."""

from __future__ import annotations

import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

SPEED = {"driver_speed": "1450 1/min"}
HOIST = {
    "lifted_mass": "2000 kg",
    "drum_diameter": "0.4 m",
    "rope_parts": 2,
    "machine_ratio": 12.5,
    "gear_efficiency": 0.93,
}
WORKED = {
    "hoist": ({**HOIST, "machine_inertia": 8, "clutch_side_inertia": 0.35}, 168.716559, 0.542688172),
    "machine": (
        {"machine_torque": "180 N*m", "machine_inertia": 2.4, "machine_ratio": 3.2, "gear_efficiency": 0.96},
        58.59375,
        0.244140625,
    ),
    "travel": (
        {
            "machine_torque": "25 N*m",
            "moved_mass": "1200 kg",
            "drum_diameter": "315 mm",
            "machine_ratio": 8,
            "gear_efficiency": 0.9,
            "clutch_side_inertia": 0.02,
        },
        3.47222222,
        0.536796875,
    ),
}
OTHERS = {"roller_coupling": {"offset": "5 mm"}, "wrap_spring_actuated": {"relative_speed": "1450 1/min"}}


def values(family="cone_clutch", **stated):
    """Numbers of the requirements."""
    return instance_of(synth.load(family), SPEED | stated, as_catalogs(None)).values.requirements


WITHOUT_FACTORS = ("centrifugal_two_spring", "magnetic_powder_clutch")


@pytest.mark.parametrize("family", ["multi_plate_clutch", "disc_clutch", "cone_clutch", *WITHOUT_FACTORS])
@pytest.mark.parametrize("words", WORKED)
def test_worked_numbers(words, family):
    stated, load, inertia = WORKED[words]
    found = values(family, **stated)
    factor = 1.5 if family in WITHOUT_FACTORS else 1.5 / 0.85
    expected = [load, inertia, factor * load]
    assert [found[n] for n in ("load_torque", "driven_inertia", "required_torque")] == pytest.approx(expected, rel=1e-8)


@pytest.mark.parametrize("family", ["roller_coupling", "wrap_spring", "wrap_spring_actuated"])
def test_load_of_a_machine_where_no_inertia_is_started(family):
    found = values(family, **OTHERS.get(family, {}), **HOIST)
    assert found["required_torque"] == pytest.approx(1.5 * 168.716559, rel=1e-8)
    with pytest.raises(synth.InputError, match="machine_inertia: got 8; expected another family"):
        values(family, **OTHERS.get(family, {}), **HOIST, machine_inertia=8)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ({**HOIST, "load_torque": "100 N*m"}, "one of load_torque and machine; .* different torques"),
        ({**HOIST, "power": "3 kW"}, "one of power and machine; at the clutch they are different torques"),
        ({**HOIST, "driven_inertia": 1}, "one of driven_inertia and machine; .* different inertias"),
        ({"lifted_mass": "2000 kg"}, "a drum_diameter .* with lifted_mass"),
        ({"load_torque": "9 N*m", "driven_inertia": 1, "machine_ratio": 2}, "which alone are reduced"),
        ({**HOIST, "machine_ratio": 0}, "requirement machine_ratio: got 0; expected 0.001 to 10000"),
    ],
)
def test_contradictions_are_refused(stated, said):
    with pytest.raises(synth.InputError, match=said):
        values(**stated)


def test_both_are_steps_of_the_calculation_that_scatter_with_the_mass():
    front = synth.synthesize("cone_clutch", SPEED | HOIST, points=1, objectives=["mass"])
    told = synth.calculation(front).quantities
    assert {"lifted_mass", "drum_diameter"} <= set(synth.results.expression.names_in(told["load_torque"].expression))
    assert told["driven_inertia"].kind == "step"
    assert synth.rate(front, {"lifted_mass": "+-10 %"}).to_frame()["robust"].tolist() == ["no"]
