"""State of the centrifugal clutches at a speed: against formulas by hand, the equilibrium, and the curves."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from synth.problems.centrifugal import curves
from synth.problems.centrifugal.state import balance, of_path
from typer.testing import CliRunner

import synth
from synth.terminal.cli import app
from tests.conformance.cases import CASES, answer

RPM = 2 * math.pi / 60
BALLS = ("centrifugal_ball_ramp", "centrifugal_two_spring")
LEVERS = ("centrifugal_lever", "centrifugal_reversed")


@lru_cache
def given(family):
    """Return the problem, the requirements and one feasible design of a family."""
    case = next(iter(CASES[family].feasible.values()))
    front = answer(family, case, points=1, gap=0.05)
    return synth.load(family, **case.options), case.requirements, front.designs[0]


@pytest.fixture(scope="module", params=(*BALLS, *LEVERS))
def clutch(request):
    return request.param, *given(request.param)


def state(clutch, speed):
    _, problem, requirements, design = clutch
    return synth.state(problem, requirements, design, at={"speed": f"{speed!r} rad/s"}).set_index("course")


def known_speeds(design):
    names = ("release_speed", "contact_speed", "full_clamp_speed")
    return [design.values[n] for n in names if n in design.values]


@pytest.mark.slow
def test_nothing_engages_below_contact_and_all_is_there_above(clutch):
    family, _, _, design = clutch
    contact = design.values["contact_speed"]
    (below, beyond) = (state(clutch, contact * share) for share in (0.999, 1.001))
    first = below.index[0]
    assert below.loc[first, "torque [N*m]"] == 0
    assert beyond.loc[first, "torque [N*m]"] > 0
    gap = "plate gap [mm]" if family == "centrifugal_two_spring" else "gap [mm]"
    assert below.loc[first, gap] > 0
    assert beyond.loc[first, gap] == pytest.approx(0, abs=1e-9)
    if "full_clamp_speed" in design.values:
        speed = design.values["full_clamp_speed"]
        worn = next(c for c in below.index if not c.startswith("new"))
        full = state(clutch, 1.01 * speed)
        assert full["clamp force [N]"].max() == pytest.approx(design.values["clamp_force"], rel=1e-9)
        assert full.loc[worn if family in LEVERS else first, "regime"] in ("stop", "at the stop")
        if family in LEVERS:
            assert full.loc[worn, "torque [N*m]"] == pytest.approx(design.values["worn_torque"], rel=1e-9)


def test_a_ball_ramp_by_hand():
    clutch = ("centrifugal_ball_ramp", *given("centrifugal_ball_ramp"))
    design = clutch[-1]
    v, row = design.values, design.parts["return_spring"]
    spec = design.frame.requirement_values
    i, rate = v["ramp_ratio"], v["return_springs"] * row["rate_R"]
    loss = spec["ball_friction"] * (i + math.sqrt(1 + i * i))
    lining = design.parts["friction_pair"]["mu_dynamic"] * v["friction_surfaces"]
    lining *= (v["lining_inner_radius"] + v["lining_outer_radius"]) / 2
    for speed in (0.0, 0.5 * v["contact_speed"], 1.1 * v["contact_speed"], 2 * v["contact_speed"]):
        told = state(clutch, speed)
        for course, efficiency in (("speeding up", 1 / (1 + loss)), ("slowing down", 1 / (1 - loss))):
            # Move the plate until ramp and springs balance, by bisection.
            low, high = 0.0, v["plate_gap"]

            def excess(x, efficiency=efficiency, speed=speed):
                push = v["flyweight_mass"] * (v["rest_radius"] + i * x) * speed**2 * i * efficiency
                return push - rate * (v["spring_preload_deflection"] + x)

            for _ in range(200):
                middle = (low + high) / 2
                low, high = (middle, high) if excess(middle) > 0 else (low, middle)
            gap = v["plate_gap"] - low
            clamp = max(excess(v["plate_gap"]), 0.0)
            assert told.loc[course, "gap [mm]"] == pytest.approx(1e3 * gap, rel=1e-9, abs=1e-9)
            assert told.loc[course, "clamp force [N]"] == pytest.approx(clamp, rel=1e-9, abs=1e-9)
            assert told.loc[course, "torque [N*m]"] == pytest.approx(clamp * lining, rel=1e-9, abs=1e-9)
    at_full = state(clutch, spec["full_torque_speed"]).loc["speeding up", "torque [N*m]"]
    assert at_full == pytest.approx(v["full_speed_torque"], rel=1e-9)


@pytest.mark.slow
def test_the_state_lies_on_the_curves(clutch):
    _, problem, requirements, design = clutch
    drawn = synth.curves(problem, requirements, design)
    names = {
        "speeding up": "engaging_over_speed",
        "slowing down": "releasing_over_speed",
        "new linings": "over_speed",
        "worn linings": "over_speed_worn",
    }
    compared = 0
    for speed in np.linspace(0.3, 1.9, 23) * design.values["contact_speed"]:
        for course, row in state(clutch, float(speed)).iterrows():
            frame = drawn[names[course]]
            along = frame["speed [1/min]"].to_numpy()
            assert np.all(np.diff(along) >= -1e-9)  # nothing jumps in a feasible design
            if not along[0] <= speed / RPM <= along[-1]:
                continue
            for column in frame.columns[1:]:
                fine = frame[column].to_numpy()
                size = np.abs(fine).max()
                expected = np.interp(speed / RPM, along, fine)
                assert row[column] == pytest.approx(expected, abs=2e-3 * size + 1e-12), (course, column)
                compared += 1
    assert compared > 100


@pytest.mark.slow
def test_flyweights_and_springs_balance_at_any_speed(clutch):
    """The equilibrium that the state claims, from its own figures: forces at the plate, and the centrifugal force."""
    family, _, _, design = clutch
    v = design.values
    for speed in np.linspace(0.2, 2.2, 17) * v["contact_speed"]:
        for _, row in state(clutch, float(speed)).iterrows():
            pull = v["flyweight_mass"] * row["radius [mm]"] / 1e3 * speed**2
            assert row["centrifugal force [N]"] == pytest.approx(pull, rel=1e-9, abs=1e-12)
            assert row["torque over required_torque [-]"] == pytest.approx(
                row["torque [N*m]"] / design.frame.requirement_values["required_torque"], rel=1e-12
            )
            if family == "centrifugal_two_spring" and row["regime"] not in ("at rest", "at the stop"):
                held = row["clamp spring force [N]"]
                assert row["axial force [N]"] == pytest.approx(held, rel=1e-9)
            if family == "centrifugal_two_spring" and row["regime"] == "clamping":
                pressed = row["clamp spring force [N]"] - row["return spring force [N]"]
                assert row["clamp force [N]"] == pytest.approx(pressed, rel=1e-9)
            if family == "centrifugal_lever" and row["regime"] == "spring clamps":
                moment = row["spring force [N]"] * v["spring_arm"]
                assert row["centrifugal force [N]"] * v["flyweight_arm"] == pytest.approx(moment, rel=1e-9)
            if family == "centrifugal_reversed" and row["regime"] in ("travel", "disc 1 lifts"):
                push = row["return force [N]"] + row["clamp force [N]"]
                assert row["centrifugal force [N]"] * v["flyweight_arm"] == pytest.approx(
                    push * v["plate_arm"], rel=1e-9
                )


def test_where_the_motion_jumps_the_two_courses_differ():
    """Held by 100 N at rest and by 80 N further on: out at once at 100, home again only below 80."""
    knots = [(100.0, 0.0), (80.0, 0.01), (300.0, 0.02)]

    def stands(force, outward):
        return balance(knots, lambda x: force, outward)

    assert [stands(f, True).position for f in (99, 100)] == [0, 0]
    assert stands(101, True).position == pytest.approx(0.01 + 0.01 * 21 / 220)
    assert stands(101, False).position == stands(101, True).position
    assert stands(99, False).position == pytest.approx(0.01 + 0.01 * 19 / 220)
    assert stands(79, False) == stands(79, True)
    assert (stands(400, True).stretch, stands(400, False).stretch) == (3, 3)
    rng = np.random.default_rng(5)
    for _ in range(200):
        forces, places = rng.uniform(50, 300, 4), np.sort(rng.uniform(0, 1, 4))
        slope, base = rng.uniform(0, 100), rng.uniform(0, 400)
        fine = np.linspace(places[0], places[-1], 4001)
        excess = base + slope * fine - np.interp(fine, places, forces)
        held = list(zip(forces, places, strict=True))
        out = balance(held, lambda x, s=slope, b=base: b + s * x, True).position
        home = balance(held, lambda x, s=slope, b=base: b + s * x, False).position
        first, last = np.flatnonzero(excess <= 0), np.flatnonzero(excess >= 0)
        assert out == pytest.approx(fine[first[0]] if len(first) else places[-1], abs=5e-4)
        assert home == pytest.approx(fine[last[-1]] if len(last) else places[0], abs=5e-4)


@pytest.mark.parametrize("inward", [math.inf, -4.0])
def test_flyweights_that_do_not_come_back_have_no_state_on_the_way_back(inward):
    design = given("centrifugal_ball_ramp")[-1]
    spec = design.frame.requirement_values
    path = replace(curves.ball_ramp_path(spec, design), inward=inward)
    speed = 1.5 * design.values["contact_speed"]
    told = of_path(spec, path, speed).set_index("course")
    assert told.loc["speeding up", "torque [N*m]"] > 0
    assert told.loc["slowing down", "regime"] == "held out: the flyweights do not come back"
    assert math.isnan(told.loc["slowing down", "torque [N*m]"])


@pytest.mark.parametrize(
    ("at", "message"),
    [
        ({}, "at: speed: is missing; expected speed of the driving side, for example '900 1/min'"),
        ({"sped": 900}, "at: got 'sped'; expected speed"),
        ({"speed": "900 N"}, "at: speed: got '900 N'"),
        ({"speed": -1}, "at: speed: got -1; expected a value of 0 1/min or more"),
        ({"speed": 1e300}, "at: got .*a point at which the design has a state"),
    ],
)
def test_an_operating_point_that_cannot_be_is_one_sentence(at, message):
    problem, requirements, design = given("centrifugal_ball_ramp")
    with pytest.raises(synth.InputError, match=message):
        synth.state(problem, requirements, design, at=at)


def test_a_family_without_states_says_so(tmp_path):
    with pytest.raises(synth.InputError, match=r"family: got 'disc_clutch'; expected a family that tells its state"):
        synth.state("disc_clutch", {}, at={"speed": 900})
    ran = CliRunner().invoke(app, ["check", "examples/lecture_design.yaml", "--at", "speed=900 rpm"])
    assert isinstance(ran.exception, synth.InputError)
    assert "Quantities" not in ran.output


def test_the_command_line_shows_and_writes_it(tmp_path):
    problem, requirements, design = given("centrifugal_lever")
    path = tmp_path / "design.yaml"
    path.write_text(design.yaml())
    ran = CliRunner().invoke(app, ["check", str(path), "--at", "speed=900 rpm", "-o", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.output
    told = " ".join(ran.output.split())
    assert "State at speed=900 rpm" in told
    assert "regime" in told.split("State at")[1]
    table = synth.state(problem, requirements, design, at={"speed": "900 rpm"})
    lines = (tmp_path / "out" / "state.csv").read_text().splitlines()
    assert lines[0].split(",")[:3] == ["course", "regime", "speed [1/min]"]
    assert len(lines) == 1 + len(table)
