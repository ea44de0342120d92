"""Device B: units, symbols, both practices of the source, its misprints, its regimes against a direct equilibrium."""

import inspect
import math

import numpy as np
import pytest
from scipy.optimize import brentq
from synth.problems.mechanics import centrifugal, two_spring

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays

SPRINGS = {"return_preload": "N", "clamp_preload": "N", "return_rate": "N/m", "clamp_rate": "N/m"}
CASES = [
    (two_spring.stretched_force, {"preload": "N", "deflection": "m", "travel": "m"}, "N"),
    (two_spring.clamp_spring_travel, {"force": "N", "clamp_preload": "N", "deflection": "m"}, "m"),
    (two_spring.contact_force, {"return_preload": "N", "return_rate": "N/m", "plate_travel": "m"}, "N"),
    (
        two_spring.contact_travel,
        {"contact_force": "N", "clamp_preload": "N", "clamp_deflection": "m", "plate_travel": "m"},
        "m",
    ),
    (two_spring.stop_force, {"clamp_preload": "N", "clamp_rate": "N/m", "plate_travel": "m", "stop_travel": "m"}, "N"),
    (two_spring.clamp_force, {"stop_force": "N", "contact_force": "N"}, "N"),
    (two_spring.worn_clamp_force, {"clamp_force": "N", "return_rate": "N/m", "clamp_rate": "N/m", "wear": "m"}, "N"),
    (
        two_spring.worn_contact_travel,
        {"contact_travel": "m", "return_rate": "N/m", "clamp_rate": "N/m", "wear": "m"},
        "m",
    ),
    (two_spring.disc_travel, {"force": "N", **SPRINGS, "plate_travel": "m", "stop_travel": "m"}, "m"),
    (two_spring.plate_travel_at, {"force": "N", "return_preload": "N", "return_rate": "N/m", "plate_travel": "m"}, "m"),
    (two_spring.clamp_force_at, {"force": "N", "contact_force": "N", "stop_force": "N"}, "N"),
    (two_spring.stop_load, {"force": "N", "stop_force": "N"}, "N"),
]
RANGES = {"clamp_preload": (0.2, 0.5), "contact_force": (0.4, 0.8), "stop_force": (1.2, 2.0), "stop_travel": (2.1, 3.0)}
IDS = [case[0].__name__ for case in CASES]


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES)


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_floats_arrays_and_symbols_agree(function, units, result_unit):
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_no_formula_is_left_out():
    public = {n for n, f in inspect.getmembers(two_spring, inspect.isfunction) if f.__module__ == two_spring.__name__}
    assert public == set(IDS)


# -- the regimes ---------------------------------------------------------------------------------------


def directly(c, force):
    """Unilateral equilibrium of plate and disc by nested bisection: x, z, forces of R1 and R2, clamp and stop force."""

    def plate(x):
        # R2 pushes the plate on, R1 back; it rests at 0 or lies on the friction disc at a.
        def excess(z):
            return c["s2"] * (c["delta2"] + x - z) - c["s1"] * (c["delta1"] + z)

        if excess(0.0) <= 0:
            return 0.0
        return c["a"] if excess(c["a"]) >= 0 else brentq(excess, 0.0, c["a"], xtol=1e-16)

    def against(x):
        return c["s2"] * (c["delta2"] + x - plate(x))

    if against(0.0) >= force:
        x = 0.0
    elif against(c["b"]) <= force:
        x = c["b"]
    else:
        x = brentq(lambda x: against(x) - force, 0.0, c["b"], xtol=1e-16)
    z = plate(x)
    r1, r2 = c["s1"] * (c["delta1"] + z), against(x)
    clamp = r2 - r1 if z >= c["a"] else 0.0
    return x, z, r1, r2, clamp, max(force - r2, 0.0) if x >= c["b"] else 0.0


def random_springs(rng):
    c = {
        "s1": rng.uniform(5e3, 1e5),
        "s2": rng.uniform(5e3, 2e5),
        "delta1": rng.uniform(0.5e-3, 20e-3),
        "a": rng.uniform(1e-3, 6e-3),
    }
    c["delta2"] = rng.uniform(0.1, 1.0) * c["s1"] * c["delta1"] / c["s2"]
    fa = c["s1"] * (c["delta1"] + c["a"])
    c["b"] = (c["a"] + fa / c["s2"] - c["delta2"]) * rng.uniform(1.05, 2.0)
    return c


@pytest.mark.parametrize("seed", range(40))
def test_regimes_are_the_direct_equilibrium(seed):
    c = random_springs(np.random.default_rng(seed))
    f10, f20 = c["s1"] * c["delta1"], c["s2"] * c["delta2"]
    fa = two_spring.contact_force(f10, c["s1"], c["a"])
    fb = two_spring.stop_force(f20, c["s2"], c["a"], c["b"])
    assert f20 <= f10 * (1 + 1e-12) < fa < fb
    for force in np.linspace(0.05, 1.4, 28) * fb:
        x, z, r1, r2, clamp, stop = directly(c, force)
        found_x = two_spring.disc_travel(force, f10, f20, c["s1"], c["s2"], c["a"], c["b"])
        found_z = two_spring.plate_travel_at(force, f10, c["s1"], c["a"])
        assert found_x == pytest.approx(x, rel=1e-8, abs=1e-12)
        assert found_z == pytest.approx(z, rel=1e-8, abs=1e-12)
        assert f10 + c["s1"] * found_z == pytest.approx(r1, rel=1e-9)
        assert f20 + c["s2"] * (found_x - found_z) == pytest.approx(r2, rel=1e-9)
        assert two_spring.clamp_force_at(force, fa, fb) == pytest.approx(clamp, rel=1e-7, abs=1e-6)
        assert two_spring.stop_load(force, fb) == pytest.approx(stop, rel=1e-9, abs=1e-6)
    # The borders: travel at which the plate starts, and at which it touches.
    start = two_spring.clamp_spring_travel(f10, f20, c["delta2"])
    assert directly(c, f10 * (1 + 1e-12))[0] == pytest.approx(start, rel=1e-7, abs=1e-11)
    contact = two_spring.contact_travel(fa, f20, c["delta2"], c["a"])
    assert directly(c, fa)[0] == pytest.approx(contact, rel=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_worn_lining_is_a_longer_way_of_the_plate(seed):
    rng = np.random.default_rng(100 + seed)
    c = random_springs(rng)
    f10, f20, wear = c["s1"] * c["delta1"], c["s2"] * c["delta2"], rng.uniform(0, 0.5e-3)
    fa = two_spring.contact_force(f10, c["s1"], c["a"])
    new = two_spring.clamp_force(two_spring.stop_force(f20, c["s2"], c["a"], c["b"]), fa)
    worn = c | {"a": c["a"] + wear}
    predicted = two_spring.worn_clamp_force(new, c["s1"], c["s2"], wear)
    x_c = two_spring.contact_travel(fa, f20, c["delta2"], c["a"])
    worn_x = two_spring.worn_contact_travel(x_c, c["s1"], c["s2"], wear)
    assert (predicted > 0) == (worn_x < c["b"])
    if predicted > 0:
        assert directly(worn, 1e6)[4] == pytest.approx(predicted, rel=1e-9)
        fa_worn = two_spring.contact_force(f10, c["s1"], worn["a"])
        assert directly(worn, fa_worn)[0] == pytest.approx(worn_x, rel=1e-9)
    # Both figures say the same: what the stop still leaves, through the clamp springs.
    assert predicted == pytest.approx(c["s2"] * (c["b"] - worn_x), rel=1e-9, abs=1e-6)


@pytest.mark.parametrize("seed", range(30))
def test_no_snap_is_a_speed_that_rises_in_every_phase(seed):
    rng = np.random.default_rng(200 + seed)
    c = random_springs(rng)
    i, r0 = rng.uniform(0.4, 2.0), rng.uniform(0.015, 0.06)
    f10, f20 = c["s1"] * c["delta1"], c["s2"] * c["delta2"]
    fa = two_spring.contact_force(f10, c["s1"], c["a"])
    fb = two_spring.stop_force(f20, c["s2"], c["a"], c["b"])
    borders = [
        (f20, 0.0),
        (f10, two_spring.clamp_spring_travel(f10, f20, c["delta2"])),
        (fa, two_spring.contact_travel(fa, f20, c["delta2"], c["a"])),
        (fb, c["b"]),
    ]
    rates = (c["s2"], centrifugal.series_rate(c["s1"], c["s2"]), c["s2"])
    for (low, start), (high, end), rate in zip(borders, borders[1:], rates, strict=False):
        first, last = centrifugal.orbit_radius(r0, i, start), centrifugal.orbit_radius(r0, i, end)
        ratio = centrifugal.speed_ratio(low, first, high, last)
        share = np.linspace(0, 1, 12)
        speeds = np.sqrt((low + share * (high - low)) / (r0 + i * (start + share * (end - start))))
        assert ratio == pytest.approx(speeds[0] / speeds[-1], rel=1e-12)
        assert np.all(np.diff(speeds) > 0) == (ratio < 1)
        # The rule at the beginning of a phase alone: its rate times the radius above the force times i.
        assert (rate * first > low * i) == (ratio < 1)


# -- practice 1: the sizes that the source asks for ------------------------------------------------------


def sized(i):
    """Springs and gaps of practice 1 from its data alone, by the series regimes."""
    m, r0 = 1.0, 0.18
    f20 = m * r0 * 12.66**2 * i
    f10 = m * (r0 + i * 2.5e-3) * 13.71**2 * i
    s2 = (f10 - f20) / 2.5e-3
    fa = 48.5 * i
    a = 11.5e-3 - (fa - f20) / s2
    s1 = (fa - f10) / a
    # b from the speed at which it closes: F20 + s2 (b - a) = m (r0 + i b) omega**2 i.
    b = brentq(lambda b: f20 + s2 * (b - a) - m * (r0 + i * b) * 17.42**2 * i, a, 0.1)
    return f20, f10, s2, fa, a, s1, b, f20 + s2 * (b - a) - fa


@pytest.mark.parametrize(
    ("degrees", "expected"),
    [
        (30, (16.6563, 19.6904, 1213.64, 28.0015, 2.15199e-3, 3862.03, 15.7228e-3, 5.12502)),
        (60, (49.9690, 60.0111, 4016.86, 84.0045, 3.02685e-3, 7926.84, 18.2836e-3, 27.2487)),
    ],
)
def test_practice_1_both_readings_of_the_angle(degrees, expected):
    assert sized(math.tan(math.radians(degrees))) == pytest.approx(expected, rel=2e-5)


ROUND = {"f20": 50.0, "f10": 60.0, "s2": 4e3, "a": 3e-3, "s1": 8e3, "b": 18.3e-3}


def test_practice_1_the_rounded_answer_meets_its_data():
    i, r0 = math.sqrt(3), 0.18
    delta2 = ROUND["f20"] / ROUND["s2"]
    fa = two_spring.contact_force(ROUND["f10"], ROUND["s1"], ROUND["a"])
    fb = two_spring.stop_force(ROUND["f20"], ROUND["s2"], ROUND["a"], ROUND["b"])
    x_p = two_spring.clamp_spring_travel(ROUND["f10"], ROUND["f20"], delta2)
    x_c = two_spring.contact_travel(fa, ROUND["f20"], delta2, ROUND["a"])
    assert (fa, x_p, x_c) == pytest.approx((84, 2.5e-3, 11.5e-3))
    assert two_spring.clamp_force(fb, fa) == pytest.approx(27.2)
    speeds = [
        float(centrifugal.speed_for_force(force, 1.0, centrifugal.orbit_radius(r0, i, x), i))
        for force, x in ((ROUND["f20"], 0.0), (ROUND["f10"], x_p), (fa, x_c), (fb, ROUND["b"]))
    ]
    assert speeds == pytest.approx([12.6639, 13.7087, 15.5752, 17.4147], abs=1e-4)
    pull = centrifugal.centrifugal_force(1.0, centrifugal.orbit_radius(r0, i, x_c), speeds[2])
    assert pull == pytest.approx(48.4974, abs=1e-4)
    assert centrifugal.gravity_ratio(r0, speeds[0]) == pytest.approx(2.94, abs=0.01)


# -- practice 2: the table of the source's marks ----------------------------------------------------------

LEVERS = {"return_preload": 200.0, "clamp_preload": 0.0, "return_rate": 20e3, "clamp_rate": 80e3}
MARKS = [0, 100, 200, 300, 400, 600, 800, 2000, 4000]


def test_practice_2_table():
    force = np.array(MARKS, dtype=float)
    x = two_spring.disc_travel(force, **LEVERS, plate_travel=0.010, stop_travel=0.020)
    z = two_spring.plate_travel_at(force, 200.0, 20e3, 0.010)
    assert 1e3 * x == pytest.approx([0, 1.25, 2.5, 8.75, 15, 17.5, 20, 20, 20])
    assert 1e3 * z == pytest.approx([0, 0, 0, 5, 10, 10, 10, 10, 10])
    assert 200 + 20e3 * z == pytest.approx([200, 200, 200, 300, 400, 400, 400, 400, 400])
    assert 80e3 * (x - z) == pytest.approx([0, 100, 200, 300, 400, 600, 800, 800, 800])
    assert two_spring.contact_force(200.0, 20e3, 0.010) == 400
    assert two_spring.stop_force(0.0, 80e3, 0.010, 0.020) == pytest.approx(800)
    assert two_spring.clamp_force_at(force, 400.0, 800.0) == pytest.approx([0, 0, 0, 0, 0, 200, 400, 400, 400])
    assert two_spring.stop_load(force, 800.0) == pytest.approx([0, 0, 0, 0, 0, 0, 0, 1200, 3200])


# -- misprints: the printed relations contradict practice 1, the corrected ones give its data -------------


def test_parallel_springs_contradict_practice_1():
    # (6), (11): F = F_R1 + F_R2. At contact the sum of both springs is 168 N, the balls push with 84 N.
    push = 48.5 * math.sqrt(3)
    fa = ROUND["f10"] + ROUND["s1"] * ROUND["a"]
    through_r2 = ROUND["f20"] + ROUND["s2"] * (11.5e-3 - ROUND["a"])
    assert push == pytest.approx(84, abs=0.01)
    assert fa == pytest.approx(84)
    assert through_r2 == pytest.approx(84)
    assert fa + through_r2 == pytest.approx(168)


def test_printed_travels_contradict_practice_1():
    force, f10, f20, s1, s2 = 84.0, 60.0, 50.0, 8e3, 4e3
    printed_z = (force - f10 - f20) / (2 * s1)  # (10)
    assert 1e3 * printed_z == pytest.approx(-1.625)
    assert two_spring.plate_travel_at(force, f10, s1, 3e-3) == pytest.approx(3e-3)
    # (8), printed with the preloads added: the disc would move back 4.875 mm where practice 1 has 11.5 mm.
    assert 1e3 * (printed_z + (force - f10 - f20) / (2 * s2)) == pytest.approx(-4.875)
    assert two_spring.disc_travel(force, f10, f20, s1, s2, 3e-3, 18.3e-3) == pytest.approx(11.5e-3)


def test_signs_of_14_and_15():
    # The clamp force is what R2 pushes beyond what R1 takes; with the printed signs it is 2 s1 a too large.
    fa, fb = 84.0, 50.0 + 4e3 * (18.3e-3 - 3e-3)
    right = two_spring.clamp_force(fb, fa)
    printed_15 = fb - 60.0 + 8e3 * 3e-3
    assert printed_15 - right == pytest.approx(2 * 8e3 * 3e-3)
    printed_14 = 60.0 + 4e3 * (18.3e-3 - 3e-3) - 60.0 + 8e3 * 3e-3
    assert printed_14 != pytest.approx(right)
    x, z, r1, r2, clamp, _ = directly(
        {"s1": 8e3, "s2": 4e3, "delta1": 7.5e-3, "delta2": 12.5e-3, "a": 3e-3, "b": 18.3e-3}, 1e4
    )
    assert (x, z) == pytest.approx((18.3e-3, 3e-3))
    assert clamp == pytest.approx(r2 - r1)
    assert clamp == pytest.approx(right)


def test_the_printed_order_of_preloads_makes_the_plate_creep_on():
    # The text wants F20 > F10: at rest, with no force at all, the plate then lies on its way to the lining.
    c = {"s1": 8e3, "s2": 4e3, "delta1": 7.5e-3, "delta2": 20e-3, "a": 3e-3, "b": 18.3e-3}
    assert c["s2"] * c["delta2"] > c["s1"] * c["delta1"]
    assert directly(c, 0.0)[1] > 1e-3
    assert directly(c | {"delta2": 12.5e-3}, 0.0)[1] == 0
