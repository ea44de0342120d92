"""Shock factor by driver and machine, and engagement-count factor by rate: worked numbers, rows that are named."""

from __future__ import annotations

import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

DRIVE = {"load_torque": "100 N*m", "driver_speed": "1450 1/min", "driven_inertia": "0.4 kg*m2"}


def asked(family="cone_clutch", options=None, **stated):
    """Question of a drive with options."""
    return instance_of(synth.load(family, **(options or {})), DRIVE | stated, as_catalogs(None))


@pytest.mark.parametrize(
    ("driver", "machine", "factor", "row"),
    [
        ("electric motor", "medium", 1.5, "coupling_service_AGMA514 4"),
        ("piston engine 4-12 cylinders", "high", 3.0, "coupling_service_AGMA514 8"),
        ("PISTON ENGINE 1", "Uni", 1.8, "coupling_service_AGMA514 3"),
        ("electric motor", "belt conveyor", 2.0, "coupling_service_AGMA514 7"),
        ("piston engine 4", "elevator", 2.3, "coupling_service_AGMA514 5"),
        ("elec", "hoists", 1.65, "mean of moment_safety_by_machine 9 and moment_safety_by_machine 10"),
    ],
)
def test_shock_factor_of_driver_and_machine(driver, machine, factor, row):
    classes = {"driver_class": driver, "driven_class": machine}
    for family, others in (("cone_clutch", 0.85), ("centrifugal_lever", 1.0)):
        question = asked(family, classes)
        assert question.values.requirements["required_torque"] == pytest.approx(factor * 100 / others, rel=1e-12)
        assert question.model.declaration.requirements["safety_factor"].source == f"table application_factors, {row}"
        assert asked(family, classes, safety_factor=1.2).values.requirements["safety_factor"] == 1.2


@pytest.mark.parametrize("family", ["cone_clutch", "multi_plate_clutch", "disc_clutch", "electromagnetic_clutch"])
def test_upper_end_of_a_rate_belongs_to_its_bin(family):
    for rate, factor in ((50, 1), (100, 1), (120, 0.95), (150, 0.8), (360, 0.5), (361, 0.4), (1000, 0.4)):
        typed = {"engagements_per_hour": f"{rate} 1/h"}
        found = asked(family, **typed).values.requirements
        assert found["switching_factor"] == factor
        assert found["required_torque"] == pytest.approx(1.5 * 100 / factor / 0.85, rel=1e-12)
        assert asked(family, **typed, switching_factor=0.9).values.requirements["switching_factor"] == 0.9
        assert asked(family, {"practice": "off"}, **typed).values.requirements["switching_factor"] == 1


def test_engine_that_starts_a_heavy_machine_often():
    engine = {"driver_class": "piston engine 4", "driven_class": "high"}
    rate = {"engagements_per_hour": "150 1/h"}
    assert asked(options=engine, **rate).values.requirements["required_torque"] == pytest.approx(441.176471, rel=1e-8)
    alone = asked("centrifugal_lever", engine).values.requirements["required_torque"]
    assert alone == pytest.approx(300, rel=1e-12)


@pytest.mark.parametrize(
    ("family", "options", "stated", "said"),
    [
        ("cone_clutch", {"driver_class": "piston engine 4", "driven_class": "cars"}, {}, "driver_class not used"),
        ("cone_clutch", {"driven_class": "cars"}, {"safety_factor": 2}, "driven_class not used: safety_factor is"),
        ("wrap_spring", {"driven_class": "cars"}, {"required_torque": "9 N*m"}, "driven_class not used: required"),
        ("cone_clutch", {"driven_class": "cars"}, {}, None),
    ],
)
def test_class_without_effect_is_remarked(family, options, stated, said):
    words = {**({} if "required_torque" in stated else DRIVE), **stated}
    advices = synth.load(family, **options).model(frozenset(words), as_catalogs(None)).declaration.advices
    told = [a.message for a in advices if a.code == "class_unused"]
    assert [said in message for message in told] == [True] if said else told == []


def test_machine_of_several_is_refused_by_name():
    with pytest.raises(synth.InputError, match=r"got 'hoist'; expected one of hoist \(building\); hoists and cranes$"):
        asked(options={"driven_class": "hoist"})
