"""Device A: units, symbols, errata of the source, and its regimes against a direct equilibrium."""

import inspect
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from synth.problems.mechanics import ball_ramp, centrifugal

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays

MOVING = {
    "speed": "1/s",
    "mass": "kg",
    "rest_radius": "m",
    "ratio": "-",
    "preload": "N",
    "rate": "N/m",
    "efficiency": "-",
}
CASES = [
    (ball_ramp.rest_reaction, {"preload": "N", "centrifugal_force": "N", "ratio": "-", "efficiency": "-"}, "N"),
    (ball_ramp.travel_at_speed, MOVING, "m"),
    (ball_ramp.radius_at_speed, MOVING, "m"),
    (ball_ramp.clamp_force, {"gain": "kg m", "speed": "1/s", "contact_speed": "1/s"}, "N"),
    (ball_ramp.faster_clamp_force, {"clamp_force": "N", "gain": "kg m", "speed": "1/s", "faster": "1/s"}, "N"),
    (ball_ramp.clamp_speed_ratio, {"spring_force": "N", "clamp_force": "N"}, "-"),
]
RANGES = {"rate": (50.0, 90.0), "speed": (1.0, 2.0), "contact_speed": (0.3, 0.8), "faster": (2.2, 3.0)}
IDS = [case[0].__name__ for case in CASES]


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES)


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_floats_arrays_and_symbols_agree(function, units, result_unit):
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_no_formula_is_left_out():
    public = {n for n, f in inspect.getmembers(ball_ramp, inspect.isfunction) if f.__module__ == ball_ramp.__name__}
    assert public == set(IDS)


def random_clutch(rng):
    return {
        "mass": rng.uniform(0.1, 0.6),
        "rest_radius": rng.uniform(0.05, 0.12),
        "ratio": rng.uniform(0.4, 2.0),
        "deflection": rng.uniform(1e-3, 20e-3),
        "rate": rng.uniform(5e3, 2e5),
        "gap": rng.uniform(1.5e-3, 6e-3),
        "loss": rng.uniform(0.0, 0.4),
    }


def directly(clutch, speed, efficiency):
    """Equilibrium of plate and balls by bisection: travel, clamp force and reaction of the inner rest.

    The push of the balls less the force of the springs is positive where the plate moves on; from x = 0 and below h.
    """

    def excess(x):
        pull = clutch["mass"] * (clutch["rest_radius"] + clutch["ratio"] * x) * speed**2
        return pull * clutch["ratio"] * efficiency - clutch["rate"] * (clutch["deflection"] + x)

    if excess(0.0) <= 0:
        pull = clutch["mass"] * clutch["rest_radius"] * speed**2
        return 0.0, 0.0, clutch["rate"] * clutch["deflection"] / clutch["ratio"] / efficiency - pull
    if excess(clutch["gap"]) >= 0:
        return clutch["gap"], excess(clutch["gap"]), 0.0
    return brentq(excess, 0.0, clutch["gap"], xtol=1e-15, rtol=1e-14), 0.0, 0.0


@pytest.mark.parametrize("seed", range(60))
def test_regimes_are_the_direct_equilibrium(seed):
    clutch = random_clutch(np.random.default_rng(seed))
    mass, r0, i, rate, gap = (clutch[k] for k in ("mass", "rest_radius", "ratio", "rate", "gap"))
    efficiency = centrifugal.outward_efficiency(clutch["loss"])
    preload = centrifugal.spring_force(rate, clutch["deflection"])
    at_contact = centrifugal.spring_force(rate, clutch["deflection"] + gap)
    end = centrifugal.orbit_radius(r0, i, gap)
    start = centrifugal.speed_for_force(preload, mass, r0, i, efficiency)
    contact = centrifugal.speed_for_force(at_contact, mass, end, i, efficiency)
    gradual = clutch["deflection"] * i < r0
    assert (contact > start) == gradual
    for speed in np.linspace(0.2, 2.0, 19) * contact:
        x, clamp, rest = directly(clutch, speed, efficiency)
        if speed < min(start, contact):
            assert (x, clamp) == (0.0, 0.0)
            pull = centrifugal.centrifugal_force(mass, r0, speed)
            assert ball_ramp.rest_reaction(preload, pull, i, efficiency) == pytest.approx(rest, rel=1e-9)
        elif speed > max(start, contact) * (1 + 1e-9):
            gain = centrifugal.axial_gain(mass, end, i, efficiency)
            assert x == gap
            assert ball_ramp.clamp_force(gain, speed, contact) == pytest.approx(clamp, rel=1e-9, abs=1e-6)
            assert ball_ramp.clamp_speed_ratio(at_contact, clamp) == pytest.approx(speed / contact, rel=1e-9)
        elif gradual:
            found = ball_ramp.travel_at_speed(speed, mass, r0, i, preload, rate, efficiency)
            assert found == pytest.approx(x, rel=1e-7, abs=1e-12)
            radius = ball_ramp.radius_at_speed(speed, mass, r0, i, preload, rate, efficiency)
            assert radius == pytest.approx(r0 + i * x, rel=1e-9)


def test_balls_snap_where_the_speed_would_have_to_fall():
    # At the border delta i = r0 the speed is the same at every travel.
    r0, i, rate = 0.06, 1.5, 4e4
    travel = np.linspace(0, 5e-3, 9)
    for factor, sign in ((0.9, 1), (1.0, 0), (1.1, -1)):
        deflection = factor * r0 / i
        speed = centrifugal.speed_for_force(
            centrifugal.spring_force(rate, deflection + travel), 0.3, centrifugal.orbit_radius(r0, i, travel), i
        )
        steps = np.diff(speed) / speed[0]
        assert np.all(np.sign(np.where(np.abs(steps) < 1e-12, 0, steps)) == sign)


def test_faster_is_the_same_law():
    slow = ball_ramp.clamp_force(0.02, 200.0, 110.0)
    assert ball_ramp.faster_clamp_force(slow, 0.02, 200.0, 500.0) == pytest.approx(
        ball_ramp.clamp_force(0.02, 500.0, 110.0), rel=1e-12
    )


# -- misprints of the source: the printed form fails where the corrected one balances -----------------

ALPHA = math.radians(40)
SEEN = {"speed": 130.0, "mass": 0.25, "rest_radius": 0.070, "ratio": math.tan(ALPHA), "preload": 240.0, "rate": 60e3}


def unbalanced(x):
    """Push of the balls less the force of the springs, eq. (4) and (5)."""
    r = SEEN["rest_radius"] + math.tan(ALPHA) * x
    return SEEN["mass"] * r * SEEN["speed"] ** 2 * math.tan(ALPHA) - SEEN["preload"] - SEEN["rate"] * x


def test_equation_6_lacks_a_term():
    pull, tan = SEEN["mass"] * SEEN["speed"] ** 2, math.tan(ALPHA)
    printed = (SEEN["preload"] - SEEN["rate"] * SEEN["rest_radius"] / tan) / (pull * tan)
    assert printed < 0  # no radius
    found = ball_ramp.radius_at_speed(**SEEN)
    assert unbalanced((found - SEEN["rest_radius"]) / tan) == pytest.approx(0, abs=1e-9)


def test_equation_7_wants_the_square_of_the_tangent():
    pull, tan = SEEN["mass"] * SEEN["speed"] ** 2, math.tan(ALPHA)
    printed = (pull * SEEN["rest_radius"] * tan - SEEN["preload"]) / (SEEN["rate"] - pull * tan)
    assert abs(unbalanced(printed)) > 0.01
    assert unbalanced(ball_ramp.travel_at_speed(**SEEN)) == pytest.approx(0, abs=1e-9)
    upright = SEEN | {"ratio": 1.0}
    assert ball_ramp.travel_at_speed(**upright) == pytest.approx(
        (pull * 0.070 - SEEN["preload"]) / (SEEN["rate"] - pull), rel=1e-12
    )


def test_equation_3_and_12_balance_plate_and_rest():
    tan, pull = math.tan(ALPHA), 100.0
    rest = ball_ramp.rest_reaction(SEEN["preload"], pull, tan)
    assert (pull + rest) * tan == pytest.approx(SEEN["preload"])  # eq. (2)
    # eq. (12): F_1 - F_N - F_R1 = 0; with the printed + s h it is 2 s h off.
    gap, speed = 0.003, 300.0
    end = SEEN["rest_radius"] + tan * gap
    springs = SEEN["preload"] + SEEN["rate"] * gap
    push = SEEN["mass"] * end * speed**2 * tan
    gain = centrifugal.axial_gain(SEEN["mass"], end, tan)
    contact = centrifugal.speed_for_force(springs, SEEN["mass"], end, tan)
    found = ball_ramp.clamp_force(gain, speed, contact)
    assert push - found - springs == pytest.approx(0, abs=1e-9)
    printed = push - SEEN["preload"] + SEEN["rate"] * gap
    assert printed - found == pytest.approx(2 * SEEN["rate"] * gap)
