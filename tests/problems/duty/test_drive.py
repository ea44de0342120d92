"""Torques of a drive by the words that state them: worked numbers, contradictions, the same answer by each word."""

from __future__ import annotations

import math

import pytest

import synth
from synth.question.catalogs import as_catalogs
from tests.asking import instance_of

SPEED = 1450 * math.pi / 30
START = {"driver_speed": "1450 1/min", "driven_inertia": "0.4 kg*m2"}
NEEDED = {  # beside the torque, by family
    "multi_plate_clutch": START,
    "disc_clutch": START,
    "cone_clutch": START,
    "electromagnetic_clutch": START,
    "magnetic_powder_clutch": {"driver_speed": "1450 1/min"},
    "centrifugal_ball_ramp": START,
    "centrifugal_two_spring": START,
    "centrifugal_lever": START,
    "centrifugal_reversed": START,
    "roller_coupling": {"driver_speed": "1450 1/min", "offset": "5 mm"},
    "wrap_spring": {"driver_speed": "1450 1/min"},
    "wrap_spring_actuated": {"driver_speed": "1450 1/min", "relative_speed": "1450 1/min"},
}
STARTS = ("multi_plate_clutch", "disc_clutch", "cone_clutch", "electromagnetic_clutch")
TORQUES = ("load_torque", "required_torque")


def torques(family, **stated):
    """Load torque and required torque [N m] of a drive, None where a family does not ask for one."""
    values = instance_of(synth.load(family), NEEDED[family] | stated, as_catalogs(None)).values.requirements
    return tuple(values.get(name) for name in TORQUES)


# Torques of lined clutches, and of all others: n 1.5, c_m 1, c_v 0.85.
WORKED = {
    "load": ({"load_torque": "100 N*m"}, (100, 176.470588), (100, 150)),
    "rating": ({"required_torque": "100 N*m"}, (56.6666667, 100), (None, 100)),
    "power": ({"power": "15 kW"}, (98.7858268, 174.327930), (98.7858268, 148.178740)),
    "both": ({"load_torque": "60 N*m", "required_torque": "100 N*m"}, (60, 100), (60, 100)),
    "inertia": ({"load_torque": "0 N*m", "required_torque": "15.1843645 N*m"}, (0, 15.1843645), (0, 15.1843645)),
}


@pytest.mark.parametrize("words", WORKED)
@pytest.mark.parametrize("family", NEEDED)
def test_worked_numbers(family, words):
    stated, of_starts, of_others = WORKED[words]
    for found, expected in zip(torques(family, **stated), of_starts if family in STARTS else of_others, strict=True):
        assert found == (expected if expected is None else pytest.approx(expected, rel=1e-8))


def test_a_pack_by_the_factor_of_the_lecture_needs_more():
    problem = synth.load("multi_plate_clutch", guide_model="cz")
    for stated in ({"load_torque": "100 N*m"}, {"required_torque": f"{150 / 0.85 / 0.75} N*m"}):
        values = instance_of(problem, START | stated, as_catalogs(None)).values.requirements
        assert [values[name] for name in TORQUES] == pytest.approx([100, 150 / 0.85 / 0.75], rel=1e-12)


@pytest.mark.parametrize("family", NEEDED)
def test_a_power_is_taken_at_its_speed(family):
    load = torques(family, power="15 kW", power_speed="725 1/min")[0]
    assert load == pytest.approx(15000 / (SPEED / 2), rel=1e-12)
    # What is stated twice must agree within 1 %.
    assert torques(family, power="15 kW", load_torque="99 N*m")[0] == 99


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ({"power": "15 kW", "load_torque": "120 N*m"}, "one of power and load_torque"),
        ({"load_torque": "120 N*m", "required_torque": "100 N*m"}, "a required_torque of at least load_torque"),
        ({"load_torque": "0 N*m"}, "a required_torque where load_torque is 0"),
        ({"required_torque": "100 N*m", "power_speed": "725 1/min"}, "a power that belongs to power_speed"),
    ],
)
@pytest.mark.parametrize("family", NEEDED)
def test_contradictions_are_refused(family, stated, said):
    with pytest.raises(synth.InputError, match=said):
        torques(family, **stated)


@pytest.mark.parametrize("family", [name for name in NEEDED if name.startswith("centrifugal")])
def test_speeds_of_a_centrifugal_clutch_follow_from_that_of_the_driver(family):
    def speeds(**stated):
        wants = {"required_torque": "150 N*m", "driven_inertia": "0.4 kg*m2", **stated}
        values = instance_of(synth.load(family), wants, as_catalogs(None)).values.requirements
        names = ("driver_speed", "full_torque_speed", "idle_speed", "contact_speed_max", "top_speed")
        return [values[name] * 30 / math.pi for name in names]

    assert speeds(driver_speed="1450 1/min") == pytest.approx([1450, 1450, 725, 1087.5, 1595])
    assert speeds(full_torque_speed="1450 1/min") == pytest.approx([1450, 1450, 725, 1087.5, 1595])
    both = {"driver_speed": "1450 1/min", "full_torque_speed": "1400 1/min", "idle_speed": "800 1/min"}
    assert speeds(**both) == pytest.approx([1450, 1400, 800, 1087.5, 1595])


def test_a_factor_beside_a_rating_is_remarked():
    stated = START | {"required_torque": "100 N*m", "safety_factor": 2}
    d = synth.load("disc_clutch").model(frozenset(stated), as_catalogs(None)).declaration
    assert any("safety_factor is not used" in advice.message for advice in d.advices)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "stated", "word", "others"),
    [
        ("cone_clutch", {"load_torque": "100 N*m"}, "required_torque", "load_torque or safety_factor"),
        ("cone_clutch", {"required_torque": "170 N*m"}, "load_torque", "required_torque or safety_factor"),
        ("centrifugal_lever", {"required_torque": "150 N*m"}, "full_torque_speed", "driver_speed"),
    ],
)
def test_what_follows_from_other_words_moves_with_them_and_not_alone(family, stated, word, others):
    front = synth.synthesize(family, NEEDED[family] | stated, points=1, objectives=["mass"])
    with pytest.raises(synth.InputError, match=f"{others}.*, from which {word} follows here"):
        synth.rate(front, {word: "+-10 %"})
    moved = "driver_speed" if word == "full_torque_speed" else next(iter(stated))
    assert synth.rate(front, {moved: "+-10 %"}).to_frame()["robust"].tolist() == ["no"]


@pytest.mark.slow
@pytest.mark.parametrize("family", ["multi_plate_clutch", "disc_clutch", "cone_clutch"])
def test_a_drive_with_inertia_alone_is_sized_shown_and_simulated(family):
    problem = synth.load(family)
    wants = START | {"load_torque": "0 N*m", "required_torque": "100 N*m"}
    found = synth.synthesize(problem, wants, points=1, objectives=["mass"])
    assert found.status.value == "optimal"
    design = found.designs[0]
    # Work of a start without load: the energy of the inertia, whatever the torque and the ramp.
    assert design.values["friction_work"] == pytest.approx(0.4 * SPEED**2 / 2, rel=1e-6)
    assert synth.curves(problem, wants, design)
    assert synth.simulate(problem, wants, design)


@pytest.mark.parametrize("family", STARTS)
def test_inertia_alone_is_brought_up_to_speed_within_the_slip_time_stated(family):
    stated = {"load_torque": "0 N*m", "slip_time_limit": "4 s"}
    assert torques(family, **stated) == pytest.approx((0, 15.1843645), rel=1e-8)
    assert torques(family, **stated, required_torque="20 N*m") == (0, 20)
    # With a load the sizing torque is that of the load, whatever the slip time.
    assert torques(family, load_torque="100 N*m", slip_time_limit="4 s") == pytest.approx((100, 150 / 0.85), rel=1e-12)
    with pytest.raises(synth.InputError, match="or the slip_time_limit within which driven_inertia is"):
        torques(family, load_torque="0 N*m")


@pytest.mark.parametrize("family", NEEDED)
def test_a_torque_that_is_missing_names_the_words_for_it(family):
    with pytest.raises(synth.InputError, match="is missing; expected a value in N") as caught:
        torques(family)
    assert all(word in str(caught.value) for word in ("load_torque", "power", "required_torque", "machine_torque"))


@pytest.mark.parametrize("family", STARTS)
def test_service_life_asks_for_its_engagements(family):
    wants = START | {"load_torque": "9 N*m", "engagements_per_hour": "20 1/h", "service_life": "1000 h"}
    for more, least in (({}, 20_000), ({"wear_life_min": 500}, 500)):
        model = instance_of(synth.load(family), wants | more, as_catalogs(None))
        limit = model.model.declaration.limits["wear_life"].limit
        assert model.model.number(limit, model.values.by_symbol(model.model)) == pytest.approx(least, rel=1e-12)
    with pytest.raises(synth.InputError, match=r"service_life.*practice"):
        instance_of(synth.load(family, practice="off"), wants, as_catalogs(None))


def test_service_life_of_a_freewheel_is_its_least_overrunning_life():
    wants = {"required_torque": "9 N*m", "driver_speed": "960 1/min"}
    for more, hours in (({}, 500), ({"service_life": "2000 h"}, 2000)):
        values = instance_of(synth.load("wrap_spring"), wants | more, as_catalogs(None)).values.requirements
        assert values["overrun_life_min"] == pytest.approx(3600 * hours)
