"""Levers of centrifugal clutches: practice 3, the misprinted rate, and every regime against a direct equilibrium."""

import inspect
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from synth.problems.mechanics import centrifugal
from synth.problems.mechanics import centrifugal_levers as levers
from synth.problems.mechanics.lever_motion import CONTACT, ReversedLever, RodLever

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays

RPM = math.pi / 30
# Practice 3. The arms stand on a lost figure: ratios 1 : 1 : 1/2 give exactly 600/min at the start.
PRACTICE = RodLever(
    mass=1.0,
    rest_radius=0.152,
    flyweight_arm=0.100,
    preload=1200.0,
    rate=1e5,
    contact_travel=0.010,
    stop_angle=0.3,
    spring_arm=0.100,
    rod_arm=0.050,
)


# -- practice 3 ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mark", "radius", "force", "speed", "per_minute", "spring", "clamp"),
    [
        (0, 152, 600, 62.8281, 599.964, 1200, 0),
        (1, 172, 1100, 79.9709, 763.666, 2200, 0),
        (2, 172, 2200, 113.096, 1079.99, 2200, 2200),
        (3, 182, 3200, 132.599, 1266.22, 3200, 3200),
    ],
    ids=["starts", "contact", "rod free", "stop"],
)
def test_marks_of_practice_3(mark, radius, force, speed, per_minute, spring, clamp):
    borders = PRACTICE.borders()
    assert borders.forces[mark] == pytest.approx(force, rel=1e-12)
    assert borders.speeds[mark] == pytest.approx(speed, rel=1e-5)
    assert borders.speeds[mark] / RPM == pytest.approx(per_minute, rel=1e-5)
    motion = PRACTICE.motion(150.0, points=21)
    last = 21 * (mark + 1) - 1  # the last point of the regime that ends here
    found = [float(x[last]) for x in (motion.radius, motion.spring_force, motion.clamp_force)]
    assert found == pytest.approx([radius / 1000, spring, clamp])


def test_between_the_marks_of_practice_3():
    arms = (PRACTICE.rest_radius, PRACTICE.flyweight_arm, PRACTICE.spring_arm)
    angle = levers.travel_angle(700 * RPM, 1.0, *arms, 0.050, 1200.0, 1e5)
    assert 0.010 - 0.050 * angle == pytest.approx(4.47777e-3, rel=1e-5)
    assert 0.152 + 0.1 * angle == pytest.approx(163.044e-3, rel=1e-5)
    for per_minute, rod, clamp in ((800, 1985.68, 214.325), (1000, 627.618, 1572.38)):
        force = centrifugal.centrifugal_force(1.0, 0.172, per_minute * RPM)
        found = levers.rod_force(force, 2200.0, 0.100, 0.050, 0.100)
        assert found == pytest.approx(rod, rel=1e-5)
        assert 2200 - found == pytest.approx(clamp, rel=1e-5)
    # The change of radius is not small: without it the force at 1300/min would be a sixth too small.
    assert centrifugal.centrifugal_force(1.0, 0.152, 1300 * RPM) == pytest.approx(2817, rel=1e-4)
    assert centrifugal.centrifugal_force(1.0, 0.182, 1300 * RPM) == pytest.approx(3372.99, rel=1e-5)


def test_the_motion_follows_the_explicit_angles():
    motion = PRACTICE.motion(150.0, points=41)
    for regime, explicit, own in (
        (1, levers.travel_angle, (0.050, 1200.0, 1e5)),
        (3, levers.clamp_angle, (0.010, 1200.0, 1e5)),
    ):
        rows = motion.regime == regime
        found = explicit(motion.speed[rows], 1.0, 0.152, 0.100, 0.100, *own)
        np.testing.assert_allclose(found, motion.angle[rows], rtol=1e-9, atol=1e-12)


def test_erratum_of_practice_3_the_rate():
    """Printed "105 N/m": the superscript is lost. With 105 N/m the lever jumps through, with 10**5 N/m it does not."""
    assert not PRACTICE.borders().snaps
    printed = replace(PRACTICE, rate=105.0)
    assert printed.borders().snaps
    assert printed.borders().speeds[1] < printed.borders().speeds[0]
    # The spring would gain nothing to speak of: its force is the preload all the way.
    assert float(printed.motion(150.0).spring_force.max()) == pytest.approx(1200, rel=2e-3)


def test_the_question_what_if_rod_and_spring_change_places():
    """The spring would then open while the lever swings out: nothing brings the clutch home, even at standstill."""
    assert levers.retraction_force(1200.0, 0.100, 0.050) == pytest.approx(600.0)
    assert levers.retraction_force(1200.0, 0.050, 0.100) < 0
    changed = replace(PRACTICE, spring_arm=0.050, rod_arm=0.100)
    assert changed.travel_force(0.0) < 0  # the flyweights would have to be pushed in to keep it off the disc
    angle, clamp, *_ = equilibrium_with_rod(changed, 0.0)
    assert angle >= changed.contact_angle - 1e-12
    assert clamp > 0  # at standstill the plate is on the disc


# -- direct equilibrium ----------------------------------------------------------------------------


def balance(stiffness, load, rows, gaps):
    """Minimise q K q/2 - load q under rows q <= gaps; return q and the forces of the rows that touch.

    Every set of touching rows is tried: the balance of forces is linear, forces push, and no row is passed.
    """
    n = len(load)
    found = []
    for size in range(len(rows) + 1):
        for active in itertools.combinations(range(len(rows)), size):
            a = rows[list(active)]
            matrix = np.block([[stiffness, a.T], [a, np.zeros((size, size))]])
            if np.linalg.matrix_rank(matrix) < n + size:
                continue
            solved = np.linalg.solve(matrix, np.concatenate([load, gaps[list(active)]]))
            q, forces = solved[:n], np.zeros(len(rows))
            forces[list(active)] = solved[n:]
            if np.all(forces >= -1e-9) and np.all(rows @ q <= gaps + 1e-12):
                found.append((q, forces))
    for q, _ in found[1:]:
        np.testing.assert_allclose(q, found[0][0], rtol=1e-7, atol=1e-10)
    return found[0]


def equilibrium_with_rod(lever, speed):
    """Return angle, clamp force, rod force, moments of rest and stop; unknowns are angle and plate travel."""
    pull = lever.mass * speed**2 * lever.flyweight_arm
    s, arm = lever.rate, lever.spring_arm
    stiffness = np.array([[s * arm**2 - pull * lever.flyweight_arm, -s * arm], [-s * arm, s]])
    load = np.array([pull * lever.rest_radius - lever.preload * arm, lever.preload])
    # Rod: the plate is not ahead of it. Disc: the plate does not pass it. Rest and stop of the lever.
    rows = np.array([[-lever.rod_arm, 1.0], [0.0, 1.0], [-1.0, 0.0], [1.0, 0.0]])
    q, (rod, disc, rest, stop) = balance(
        stiffness, load, rows, np.array([0.0, lever.contact_travel, 0.0, lever.stop_angle])
    )
    return q[0], disc, rod, rest, stop


def equilibrium_reversed(lever, speed):
    """Return angle, clamp force, force on the housing, moments of rest and stop; unknowns: angle and lift of disc 1."""
    pull = lever.mass * speed**2 * lever.flyweight_arm
    leg, back = lever.short_leg, lever.return_rate
    # The plate travels leg * angle - lift.
    stiffness = np.array([[back * leg**2 - pull * lever.flyweight_arm, -back * leg], [-back * leg, lever.rate + back]])
    load = np.array([pull * lever.rest_radius - lever.return_preload * leg, lever.return_preload - lever.preload])
    rows = np.array([[0.0, -1.0], [leg, -1.0], [-1.0, 0.0], [1.0, 0.0]])
    q, (housing, disc, rest, stop) = balance(
        stiffness, load, rows, np.array([0.0, lever.contact_travel, 0.0, lever.stop_angle])
    )
    return q[0], disc, housing, rest, stop, q[1]


def random_rod_levers(count):
    rng = np.random.default_rng(5)
    found = []
    while len(found) < count:
        spring_arm = rng.uniform(0.02, 0.06)
        lever = RodLever(
            mass=rng.uniform(0.2, 2),
            rest_radius=rng.uniform(0.06, 0.15),
            flyweight_arm=rng.uniform(0.02, 0.1),
            preload=rng.uniform(200, 900),
            rate=rng.uniform(3e4, 3e5),
            contact_travel=rng.uniform(0.001, 0.004),
            stop_angle=rng.uniform(0.15, 0.35),
            spring_arm=spring_arm,
            rod_arm=spring_arm * rng.uniform(0.3, 0.8),
        )
        if lever.contact_angle < lever.stop_angle and not lever.borders().snaps:
            found.append(lever)
    return found


def random_reversed_levers(count):
    rng = np.random.default_rng(6)
    found = []
    while len(found) < count:
        lever = ReversedLever(
            mass=rng.uniform(0.2, 2),
            rest_radius=rng.uniform(0.06, 0.15),
            flyweight_arm=rng.uniform(0.02, 0.1),
            preload=rng.uniform(600, 2000),
            rate=rng.uniform(3e4, 3e5),
            contact_travel=rng.uniform(0.001, 0.004),
            stop_angle=rng.uniform(0.15, 0.35),
            short_leg=rng.uniform(0.015, 0.05),
            return_preload=rng.uniform(30, 300),
            return_rate=rng.uniform(1e4, 1e5),
        )
        ordered = lever.borders().forces[1] <= lever.borders().forces[2]
        if ordered and lever.contact_angle < lever.stop_angle and not lever.borders().snaps:
            found.append(lever)
    return found


def assert_equilibrium(lever, equilibrium, names):
    top = 1.3 * lever.borders().speeds[3]
    motion = lever.motion(top, points=7)
    scale = lever.borders().forces[3] * lever.flyweight_arm / min(lever.plate_arm, lever.flyweight_arm)
    for k, speed in enumerate(motion.speed):
        angle, *forces = equilibrium(lever, float(speed))
        assert motion.angle[k] == pytest.approx(angle, abs=1e-7)
        arms = {"rest_force": lever.flyweight_arm, "stop_force": lever.flyweight_arm}
        for name, force in zip(names, forces, strict=True):
            found = getattr(motion, name)[k] * arms.get(name, 1.0)
            assert found == pytest.approx(force, rel=1e-6, abs=1e-6 * scale), (name, k)


@pytest.mark.parametrize("lever", random_rod_levers(12), ids=range(12))
def test_lever_with_rod_against_a_direct_equilibrium(lever):
    assert_equilibrium(lever, equilibrium_with_rod, ("clamp_force", "link_force", "rest_force", "stop_force"))


@pytest.mark.parametrize("lever", random_reversed_levers(12), ids=range(12))
def test_reversed_lever_against_a_direct_equilibrium(lever):
    names = ("clamp_force", "link_force", "rest_force", "stop_force", "lift")
    assert_equilibrium(lever, equilibrium_reversed, names)


def test_practice_3_against_a_direct_equilibrium():
    assert_equilibrium(PRACTICE, equilibrium_with_rod, ("clamp_force", "link_force", "rest_force", "stop_force"))


def test_forces_of_a_motion_are_continuous():
    for lever in (*random_rod_levers(3), *random_reversed_levers(3)):
        motion = lever.motion(2 * lever.borders().speeds[3], points=11)
        for name in ("speed", "radius", "clamp_force", "link_force", "spring_force", "return_force", "lift", "gap"):
            values = getattr(motion, name)
            for end in (10, 21, 32, 43):
                at, after = values[end], values[end + 1]
                assert after == pytest.approx(at, rel=1e-9, abs=1e-9), (name, end)
        assert np.all(np.diff(motion.speed) >= -1e-12)
        assert np.ptp(motion.angle[motion.regime == CONTACT]) == 0


# -- snap and wear ---------------------------------------------------------------------------------


def test_a_phase_snaps_exactly_below_the_gradual_radius():
    rng = np.random.default_rng(9)
    seen = set()
    for _ in range(400):
        lever = replace(
            PRACTICE,
            preload=float(rng.uniform(200, 12000)),
            rest_radius=float(rng.uniform(0.03, 0.2)),
            flyweight_arm=float(rng.uniform(0.02, 0.2)),
            rod_arm=float(rng.uniform(0.04, 0.08)),
        )
        start, contact, free, stop = lever.borders().speeds
        deflection = lever.preload / lever.rate
        travel = levers.gradual_radius(deflection, lever.flyweight_arm, lever.spring_arm - lever.rod_arm)
        clamp = levers.gradual_radius(deflection - lever.contact_travel, lever.flyweight_arm, lever.spring_arm)
        assert (start <= contact) == (travel <= lever.rest_radius)
        assert (free <= stop) == (clamp <= lever.rest_radius)
        assert clamp < travel  # so a gradual travel means a gradual clamping
        seen.add((start <= contact, free <= stop))
    assert len(seen) == 3


def test_the_reversed_lever_snaps_exactly_below_the_gradual_radius():
    rng = np.random.default_rng(10)
    seen = set()
    for _ in range(400):
        lever = ReversedLever(
            mass=0.8,
            rest_radius=rng.uniform(0.03, 0.15),
            flyweight_arm=rng.uniform(0.02, 0.2),
            preload=rng.uniform(300, 3000),
            rate=1e5,
            contact_travel=0.003,
            stop_angle=0.3,
            short_leg=rng.uniform(0.012, 0.05),
            return_preload=rng.uniform(30, 900),
            return_rate=3e4,
        )
        start, contact, lift, stop = lever.borders().speeds
        travel = levers.gradual_radius(lever.return_preload / lever.return_rate, lever.flyweight_arm, lever.short_leg)
        clamp = levers.gradual_radius(lever.preload / lever.rate - 0.003, lever.flyweight_arm, lever.short_leg)
        assert (start <= contact) == (travel <= lever.rest_radius)
        assert (lift <= stop) == (clamp <= lever.rest_radius)
        seen.add((start <= contact, lift <= stop))
    assert len(seen) == 4


def test_a_worn_lining_costs_clamp_force():
    worn = replace(PRACTICE, contact_travel=PRACTICE.contact_travel + 0.6e-3)
    lost = PRACTICE.motion(150.0).clamp_force.max() - worn.motion(150.0).clamp_force.max()
    assert lost == pytest.approx(1e5 * 0.6e-3)
    for lever in random_reversed_levers(3):
        worn = replace(lever, contact_travel=lever.contact_travel + 1e-4)
        lost = lever.motion(1e3).clamp_force.max() - worn.motion(1e3).clamp_force.max()
        assert lost == pytest.approx((lever.rate + lever.return_rate) * 1e-4)


def test_the_band_is_that_of_the_border_speeds():
    for lever in random_rod_levers(5):
        _, contact, _, stop = lever.borders().speeds
        after = lever.stop_angle - lever.contact_angle
        lead = lever.spring_arm - lever.rod_arm
        squeezed = lever.preload / lever.rate + lead * lever.contact_angle
        forces = levers.growth(squeezed, lever.spring_arm, after)
        radii = levers.growth(lever.radius(lever.contact_angle), lever.flyweight_arm, after)
        band = levers.band_squared(forces, radii, lever.rod_arm / lever.spring_arm)
        assert band**0.5 == pytest.approx(stop / contact, rel=1e-12)
    for lever in random_reversed_levers(5):
        _, contact, _, stop = lever.borders().speeds
        motion = lever.motion(2 * stop)
        force = motion.clamp_force.max() + motion.return_force.max()
        radii = lever.radius(lever.stop_angle) / lever.radius(lever.contact_angle)
        band = levers.band_squared(force / motion.return_force.max(), radii)
        assert band**0.5 == pytest.approx(stop / contact, rel=1e-12)


# -- units, arrays and symbols ---------------------------------------------------------------------

ARMS = {"spring_arm": "m", "rod_arm": "m"}
SET = {"preload": "N", "rate": "N/m"}
TURNING = {"speed": "1/s", "mass": "kg", "rest_radius": "m", "flyweight_arm": "m"}
RANGES = {"rod_ratio": (0.1, 0.9)}
CASES = [
    (levers.contact_angle, {"contact_travel": "m", "plate_arm": "m"}, "-"),
    (levers.travel_spring_force, {**SET, **ARMS, "angle": "-"}, "N"),
    (levers.clamp_spring_force, {**SET, "spring_arm": "m", "contact_travel": "m", "angle": "-"}, "N"),
    (levers.travel_flyweight_force, {"spring_force": "N", **ARMS, "flyweight_arm": "m"}, "N"),
    (levers.clamp_flyweight_force, {"spring_force": "N", "spring_arm": "m", "flyweight_arm": "m"}, "N"),
    (levers.rod_force, {"flyweight_force": "N", "spring_force": "N", **ARMS, "flyweight_arm": "m"}, "N"),
    (levers.retraction_force, {"preload": "N", **ARMS}, "N"),
    (levers.travel_angle, {**TURNING, **ARMS, **SET}, "-"),
    (levers.clamp_angle, {**TURNING, "spring_arm": "m", "contact_travel": "m", **SET}, "-"),
    (levers.return_force, {**SET, "travel": "m"}, "N"),
    (levers.plate_force, {"flyweight_force": "N", "flyweight_arm": "m", "plate_arm": "m"}, "N"),
    (levers.growth, {"start": "m", "arm": "m", "angle": "-"}, "-"),
    (levers.speed_squared, {"force": "N", "mass": "kg", "radius": "m"}, "1/s2"),
    (levers.band_squared, {"force_ratio": "-", "radius_ratio": "-", "rod_ratio": "-"}, "-"),
    (levers.gradual_radius, {"deflection": "m", "flyweight_arm": "m", "resisting_arm": "m"}, "m"),
]


@pytest.mark.parametrize(("function", "units", "result"), CASES, ids=[case[0].__name__ for case in CASES])
def test_every_formula_keeps_its_units_and_takes_anything(function, units, result):
    assert_homogeneous(function, units, result, RANGES)
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_no_formula_is_forgotten():
    public = {
        name
        for name, f in inspect.getmembers(levers, inspect.isfunction)
        if f.__module__ == levers.__name__ and not name.startswith("_")
    }
    assert public == {case[0].__name__ for case in CASES}
