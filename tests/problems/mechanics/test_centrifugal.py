"""Formulas that the centrifugal clutches share: units, symbols, and the same numbers by other ways."""

import inspect
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from synth.problems.mechanics import centrifugal, ring
from synth.problems.mechanics.contact import contact_modulus

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays

FLY = {"mass": "kg", "radius": "m"}
LINING = {"inner_radius": "m", "outer_radius": "m"}
CASES = [
    (centrifugal.centrifugal_force, {**FLY, "speed": "1/s"}, "N"),
    (centrifugal.orbit_radius, {"rest_radius": "m", "ratio": "-", "travel": "m"}, "m"),
    (centrifugal.ramp_angle, {"ratio": "-"}, "-"),
    (centrifugal.contact_loss, {"ball_friction": "-", "ratio": "-"}, "-"),
    (centrifugal.outward_efficiency, {"loss": "-"}, "-"),
    (centrifugal.inward_efficiency, {"loss": "-"}, "-"),
    (centrifugal.release_ratio, {"loss": "-"}, "-"),
    (centrifugal.axial_force, {"centrifugal_force": "N", "ratio": "-", "efficiency": "-"}, "N"),
    (centrifugal.axial_gain, {**FLY, "ratio": "-", "efficiency": "-"}, "kg m"),
    (centrifugal.speed_for_force, {"force": "N", **FLY, "ratio": "-", "efficiency": "-"}, "1/s"),
    (centrifugal.speed_ratio, {"force": "N", "radius": "m", "other_force": "N", "other_radius": "m"}, "-"),
    (centrifugal.ball_set_mass, {"count": "-", "density": "kg/m3", "diameter": "m"}, "kg"),
    (centrifugal.weight_thickness, {"mass": "kg", "count": "-", "density": "kg/m3", "width": "m"}, "m"),
    (centrifugal.set_rate, {"count": "-", "rate": "N/m"}, "N/m"),
    (centrifugal.spring_force, {"rate": "N/m", "deflection": "m"}, "N"),
    (centrifugal.series_rate, {"first": "N/m", "second": "N/m"}, "N/m"),
    (centrifugal.lining_radius, LINING, "m"),
    (centrifugal.lining_pressure, {"force": "N", **LINING}, "Pa"),
    (centrifugal.lining_area, {"surfaces": "-", **LINING}, "m2"),
    (centrifugal.force_for_torque, {"torque": "N m", "friction": "-", "surfaces": "-", "friction_radius": "m"}, "N"),
    (centrifugal.engagement_energy, {"inertia": "kg m2", "speed": "1/s"}, "J"),
    (centrifugal.ramp_normal_force, {"centrifugal_force": "N", "ratio": "-"}, "N"),
    (centrifugal.ball_pressure, {"normal_force": "N", "ball_diameter": "m", "contact_modulus": "Pa"}, "Pa"),
    (centrifugal.outside_diameter, {"lining_reach": "m", "flyweight_reach": "m"}, "m"),
    (centrifugal.plates_mass, {"density": "kg/m3", "diameter": "m", "hub_radius": "m", "thickness": "m"}, "kg"),
    (
        centrifugal.clutch_inertia,
        {
            "plates_mass": "kg",
            "diameter": "m",
            "hub_radius": "m",
            "flyweight_mass": "kg",
            "flyweight_radius": "m",
            "spring_mass": "kg",
            "spring_radius": "m",
        },
        "kg m2",
    ),
    (centrifugal.rim_stress, {"density": "kg/m3", "radius": "m", "speed": "1/s"}, "Pa"),
    (
        centrifugal.spring_bow_load,
        {
            "density": "kg/m3",
            "wire_diameter": "m",
            "mean_diameter": "m",
            "active_coils": "-",
            "radius": "m",
            "speed": "1/s",
        },
        "N",
    ),
]
RANGES = {"loss": (0.01, 0.7), "ball_friction": (0.0, 0.1), "inner_radius": (0.3, 0.6), "outer_radius": (0.8, 2.0)}
IDS = [case[0].__name__ for case in CASES]
# Of the whole clutch: these hold lengths of their own.
BUILT = [
    (
        centrifugal.further_discs_mass,
        {
            "density": "kg/m3",
            "surfaces": "-",
            "ring_ratio": "-",
            "outer_radius": "m",
            "hub_radius": "m",
            "lining_density": "kg/m3",
            "lining_thickness": "m",
        },
        "kg",
    ),
    (
        centrifugal.overall_length,
        {"plates_thickness": "m", "surfaces": "-", "lining_thickness": "m", "travel": "m", "flyweight_width": "m"},
        "m",
    ),
]
SPECIAL = {"ramp_gain"}  # takes its arguments by position; tests/problems/mechanics/test_special_functions.py


LENGTHS = tuple((centrifugal, name, "m") for name in ("FURTHER_PLATE", "FURTHER_CORE", "COVER"))


@pytest.mark.parametrize(("function", "units", "result_unit"), BUILT, ids=[case[0].__name__ for case in BUILT])
def test_what_the_whole_clutch_adds_scales_with_its_own_lengths(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES, constants=LENGTHS)
    assert_same_on_symbols_and_arrays(function, units, RANGES)


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES)


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_floats_arrays_and_symbols_agree(function, units, result_unit):
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_gravity_ratio_of_arrays_and_floats():
    speeds = np.array([5.0, 10.0])
    np.testing.assert_allclose(
        centrifugal.gravity_ratio(0.2, speeds), [centrifugal.gravity_ratio(0.2, w) for w in speeds]
    )
    # One g is what a mass on a string of 9.80665 m feels at 1 rad/s.
    assert centrifugal.gravity_ratio(9.80665, 1.0) == pytest.approx(1.0)


def test_no_formula_is_left_out():
    public = {
        name
        for name, member in inspect.getmembers(centrifugal, inspect.isfunction)
        if member.__module__ == centrifugal.__name__
    }
    assert public == set(IDS) | {"gravity_ratio"} | SPECIAL | {case[0].__name__ for case in BUILT}


def test_ramp_gain_is_transmission_times_efficiency():
    ratio, mu = np.meshgrid(np.linspace(0.4, 2, 9), np.linspace(0, 0.1, 5))
    loss = centrifugal.contact_loss(mu, ratio)
    np.testing.assert_allclose(centrifugal.ramp_gain(ratio, mu), ratio * centrifugal.outward_efficiency(loss))
    both = centrifugal.outward_efficiency(loss) / centrifugal.inward_efficiency(loss)
    np.testing.assert_allclose(centrifugal.release_ratio(loss) ** 2, both)


@pytest.mark.parametrize("ratio", [0.4, 1.0, 3**0.5])
@pytest.mark.parametrize("mu", [0.0, 0.03, 0.1])
@pytest.mark.parametrize("sign", [1, -1])
def test_ball_efficiency_is_the_statics_of_a_ball_that_rolls_on_the_ramp(ratio, mu, sign):
    # On the plate P and friction mu P, on the ramp N and along it T; moments about the centre of the ball: T = mu P.
    # Radial F_C - N cos(alpha) - mu P - T sin(alpha) = 0, axial N sin(alpha) - P - T cos(alpha) = 0; inwards mu < 0.
    alpha = math.atan(ratio)
    force_c = 700.0
    system = np.array(
        [[math.cos(alpha), sign * mu * (1 + math.sin(alpha))], [math.sin(alpha), -1 - sign * mu * math.cos(alpha)]]
    )
    normal, plate = np.linalg.solve(system, [force_c, 0.0])
    loss = centrifugal.contact_loss(mu, ratio)
    efficiency = centrifugal.outward_efficiency(loss) if sign > 0 else centrifugal.inward_efficiency(loss)
    assert normal > 0
    assert plate == pytest.approx(centrifugal.axial_force(force_c, ratio, efficiency), rel=1e-12)


@pytest.mark.parametrize("mu", [0.0, 0.05])
def test_power_going_in_and_out_balances(mu):
    # One metre along the ramp: work of the centrifugal force is work on the plate and friction at the plate.
    for ratio in (0.5, 1.3):
        alpha, plate = math.atan(ratio), 200.0
        loss = centrifugal.contact_loss(mu, ratio)
        slip = 1 + math.sin(alpha)
        for efficiency, sign in ((centrifugal.outward_efficiency(loss), 1), (centrifugal.inward_efficiency(loss), -1)):
            force_c = plate / (ratio * efficiency)
            work = force_c * math.sin(alpha) - plate * math.cos(alpha)
            assert work == pytest.approx(sign * mu * plate * slip, abs=1e-9)


def test_speed_is_where_the_forces_meet():
    def excess(speed):
        pull = centrifugal.centrifugal_force(0.8, 0.09, speed)
        return centrifugal.axial_force(pull, 0.9, 0.93) - 1200.0

    speed = centrifugal.speed_for_force(1200.0, 0.8, 0.09, 0.9, 0.93)
    assert brentq(excess, 1.0, 1000.0, xtol=1e-12) == pytest.approx(speed, rel=1e-12)


def test_lining_is_that_of_the_ring_formulas_and_of_the_integral():
    inner, outer, force, mu, surfaces = 0.061, 0.088, 2500.0, 0.35, 4
    mean, ratio = inner + outer, (outer - inner) / (outer + inner)
    pressure = centrifugal.lining_pressure(force, inner, outer)
    assert pressure == pytest.approx(ring.worn_peak_pressure(force, mean, ratio), rel=1e-12)
    carried = quad(lambda r: pressure * inner / r * 2 * math.pi * r, inner, outer)[0]
    assert carried == pytest.approx(force, rel=1e-12)
    torque = surfaces * quad(lambda r: mu * pressure * inner / r * 2 * math.pi * r**2, inner, outer)[0]
    radius = centrifugal.lining_radius(inner, outer)
    assert ring.friction_torque(mu, force, radius, surfaces) == pytest.approx(torque, rel=1e-12)
    assert centrifugal.force_for_torque(torque, mu, surfaces, radius) == pytest.approx(force, rel=1e-12)
    assert centrifugal.lining_area(surfaces, inner, outer) == pytest.approx(surfaces * ring.ring_area(mean, ratio))


def test_the_area_of_contact_carries_the_force_of_the_ball():
    # Hertz: a**3 = 3 Q R/(4 E*); the pressure p0 sqrt(1 - (r/a)**2) sums up to Q over that circle.
    force, diameter, modulus = 900.0, 0.018, contact_modulus(210e9, 0.3, 210e9, 0.3)
    peak = centrifugal.ball_pressure(force, diameter, modulus)
    radius = (3 * force * diameter / 2 / (4 * modulus)) ** (1 / 3)
    carried = quad(lambda r: peak * math.sqrt(1 - (r / radius) ** 2) * 2 * math.pi * r, 0, radius)[0]
    assert carried == pytest.approx(force, rel=1e-6)
    assert modulus == pytest.approx(210e9 / (2 * (1 - 0.3**2)), rel=1e-12)


def test_masses_are_integrals():
    mass = quad(lambda r: 7850 * 0.025 * 2 * math.pi * r, 0.02, 0.1)[0]
    inertia = quad(lambda r: 7850 * 0.025 * 2 * math.pi * r**3, 0.02, 0.1)[0]
    assert centrifugal.plates_mass(7850, 0.2, 0.02, 0.025) == pytest.approx(mass, rel=1e-12)
    assert centrifugal.clutch_inertia(mass, 0.2, 0.02, 0.0, 0.1, 0.0, 0.1) == pytest.approx(inertia, rel=1e-12)
    ball = quad(lambda z: math.pi * (0.01**2 - z**2), -0.01, 0.01)[0]
    assert centrifugal.ball_set_mass(5, 7830, 0.02) == pytest.approx(5 * 7830 * ball, rel=1e-12)
    side = centrifugal.weight_thickness(1.2, 3, 7850, 0.03)
    assert 3 * 7850 * side**2 * 0.03 == pytest.approx(1.2, rel=1e-12)


def test_springs_side_by_side_and_one_behind_the_other():
    first, second, push = centrifugal.set_rate(3, 4000.0), centrifugal.set_rate(2, 9000.0), 120.0
    travel = push / first + push / second
    both = centrifugal.series_rate(first, second)
    assert centrifugal.spring_force(both, travel) == pytest.approx(push, rel=1e-12)
