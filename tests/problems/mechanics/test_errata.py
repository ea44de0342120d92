"""Misprints of the sources: what they print, what follows from their own figures, and what is right."""

import math

import pytest
from synth.problems.mechanics import guide_friction as gf
from synth.problems.mechanics import heat, ring, startup

RADIUS = 100 * ring.friction_radius(0.082, 0.012 / 0.082)  # S0's example in cm
START = (1080.0, 600.0, 30.0, 26.6, 2.0)  # S1's example


def as_printed(value, printed, decimals):
    """Whether a figure, rounded as the source rounds, is what it prints."""
    return round(value, decimals) == printed


def test_s0_friction_radius_415_should_be_412927():
    assert pytest.approx(4.12927, abs=5e-6) == RADIUS
    assert not as_printed(RADIUS, 4.15, 2)
    # the printed numerator leads to neither
    assert 2 / 3 * 60.948 / 9.84 == pytest.approx(4.12927, abs=1e-5)
    assert 2 / 3 * 60.92 / 9.84 == pytest.approx(4.1274, abs=5e-5)


def test_s0_guide_number_00642_should_be_00634875():
    guide = gf.guide_number(0.1, 0.3, RADIUS, 3.2, 5.0)
    assert guide == pytest.approx(0.0634875, abs=5e-8)
    assert gf.guide_number(0.1, 0.3, 4.15, 3.2, 5.0) == pytest.approx(0.0638063, abs=6e-8)
    assert 0.125 * 0.513 == pytest.approx(0.064125)
    for value in (guide, 0.0638063, 0.125 * 0.513):
        assert not as_printed(value, 0.0642, 4)


def test_s0_damped_guide_number_00604_should_be_00596975():
    guide = gf.guide_number(0.1, 0.3, RADIUS, 3.2, 5.0)
    assert gf.damped_guide_number(guide) == pytest.approx(0.0596975, abs=5e-8)
    assert gf.damped_guide_number(0.0642) == pytest.approx(0.060327, abs=5e-7)
    assert not as_printed(gf.damped_guide_number(0.0642), 0.0604, 4)


def test_s0_eq_13_is_a_force_not_a_torque():
    """Printed F = dM/dx = F0 r mu exp(-K x): that is a torque; the slope of M(x) over mu r is the force."""
    mu, force, guide = 0.1, 1000.0, 0.06
    damped = gf.damped_guide_number(guide)
    for x in (0.0, 3.0, 12.0):
        step = 1e-5
        slope = mu * force * RADIUS * (gf.sum_exponential_k(x + step, guide) - gf.sum_exponential_k(x - step, guide))
        slope = float(slope) / (2 * step)
        assert slope == pytest.approx(mu * force * RADIUS * math.exp(-damped * x), rel=1e-6)
        assert slope / (mu * RADIUS) == pytest.approx(force * math.exp(-damped * x), rel=1e-6)
        # the force on a surface is the mean of that course over the surface
        mean = force * math.exp(-damped * x) * -math.expm1(-damped) / damped
        assert float(gf.contact_force("exponential_K", force, x + 1, guide, 0.0)) == pytest.approx(mean, rel=1e-9)


def test_s0_legacy_limit_234_should_be_236897():
    guide = gf.guide_number(0.1, 0.3, RADIUS, 3.2, 5.0)
    assert float(gf.legacy_plate_limit(guide)) == pytest.approx(23.6897, abs=5e-5)
    assert float(gf.legacy_plate_limit(0.0642)) == pytest.approx(23.44, abs=5e-3)
    # 1.412 instead of 1.4142 for the root of two
    assert as_printed(1.412 / 0.0604, 23.4, 1)
    assert math.sqrt(2) == pytest.approx(1.4142, abs=5e-5)


def test_s0_check_of_sixteen():
    """Printed 0.0642 x 24 = 1.5308 and 4.29 x 0.4692 = 2.015."""
    assert 0.0642 * 24 == pytest.approx(1.5408)

    def left_side(guide):
        return (1 + guide) ** 24 * (2 - 24 * guide)

    guide = gf.guide_number(0.1, 0.3, RADIUS, 3.2, 5.0)
    assert 1.0642**24 == pytest.approx(4.4520, abs=5e-5)
    assert left_side(0.0642) == pytest.approx(2.04437, abs=1e-5)
    assert left_side(guide) == pytest.approx(2.08669, abs=1e-5)
    # still "sufficiently accurate": the root lies close to 24
    assert float(gf.surface_limit_geometric(0.0642)) == pytest.approx(24.27, abs=5e-3)
    assert float(gf.surface_limit_geometric(guide)) == pytest.approx(24.55, abs=5e-3)
    root = float(gf.surface_limit_geometric(guide))
    assert (1 + guide) ** root * (2 - root * guide) == pytest.approx(2, rel=1e-9)


def test_s0_series_ten_12670_should_be_126796():
    assert float(gf.sum_exponential_k(24, 0.0642)) == pytest.approx(12.6796, abs=5e-5)
    assert -math.expm1(-24 * 0.0604) / 0.0604 == pytest.approx(12.6711, abs=5e-5)
    assert not as_printed(float(gf.sum_exponential_k(24, 0.0642)), 12.670, 3)


def test_s0_larger_plate_limit_is_the_less_cautious_one():
    """The source calls (15) safer because it is larger; beyond a larger maximum more torque is lost than gained."""
    guide = 0.01
    legacy, cautious = float(gf.legacy_plate_limit(guide)), float(gf.surface_limit_geometric(guide))
    assert legacy < cautious  # for small S the three-term series errs on the cautious side
    guide = 0.2
    legacy, cautious = float(gf.legacy_plate_limit(guide)), float(gf.surface_limit_geometric(guide))
    assert legacy > cautious
    assert float(gf.sum_geometric(cautious, guide)) / cautious == pytest.approx(0.5, rel=1e-9)
    assert float(gf.sum_geometric(legacy, guide)) / legacy < 0.5


def test_s1_kinetic_work_at_c_1011_should_be_758519():
    phases = startup.startup_phases(*START)
    power, time = float(phases.kinetic_power_c), float(phases.duration_2)
    assert float(phases.kinetic_work_c) == pytest.approx(758.519, abs=5e-4)
    assert power * time / 4 == pytest.approx(758.519, abs=5e-4)  # cubic course: a quarter
    assert power * time / 3 == pytest.approx(1011.36, abs=5e-3)  # parabola: a third, as printed


def test_s1_kinetic_work_at_d_10866_should_be_106134():
    phases = startup.startup_phases(*START)
    assert float(phases.kinetic_work_d) == pytest.approx(10613.4, abs=0.05)
    assert 0.5 * 30 * 26.6**2 == pytest.approx(10613.4, abs=0.05)
    excess = 1011.36 - 758.519
    assert 10613.4 + excess == pytest.approx(10866, abs=0.5)  # the same third once more


def test_s1_friction_work_39271_should_be_395241():
    phases = startup.startup_phases(*START)
    work = float(startup.friction_work(*START))
    assert work == pytest.approx(39524.1, abs=0.05)
    assert work == pytest.approx(63720.3 - 13582.8 - 10613.4, abs=0.2)
    assert work / 39271 - 1 == pytest.approx(0.0064, abs=5e-5)
    rounded = [round(float(x)) for x in (phases.driver_work_d, phases.load_work_d)]
    assert rounded[0] - rounded[1] - 10866 == 39271


def test_s1_hourly_heat_1963550_should_be_1976207():
    work = float(startup.friction_work(*START))
    assert 3600 * heat.hourly_heat(work, 50 / 3600) == pytest.approx(1976207, abs=2)
    assert 3600 * heat.hourly_heat(39271, 50 / 3600) == pytest.approx(1963550, abs=0.5)
    assert heat.specific_hourly_heat(work, 50 / 3600, 0.334874) * 3600e-6 == pytest.approx(5.90134, abs=1e-5)


def test_s1_unit_of_the_inertia():
    """30 "N m s2" is 30 kg m2: with it the printed acceleration of 16 1/s2 follows."""
    assert float(startup.startup_phases(*START).acceleration_c) == pytest.approx((1080 - 600) / 30)


def test_s1_built_clutch_starts_with_1412_unless_the_force_is_limited():
    """The lecture sizes for 1412 N m and starts with 1080 N m; unlimited, the clutch starts harder and cooler."""
    required = ring.required_torque(600, 1.5, 1, 0.85, 0.75)
    unlimited = (required, *START[1:])
    assert required > START[0]
    assert float(startup.friction_work(*unlimited)) == pytest.approx(33523.5, abs=0.1)
    assert float(startup.slip_time(*unlimited)) < float(startup.slip_time(*START))
