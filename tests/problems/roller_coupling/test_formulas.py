"""Formulas of the roller coupling: units, symbols, worked examples and misprints of the source, other derivations."""

import inspect
import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, optimize, special
from synth.problems.mechanics import contact as hertz
from synth.problems.roller_coupling import formulas as rc

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays

KP = 9.80665
SPEED = 2880 * math.pi / 30
RANGES = {"guide_angle": (1.05, 1.57), "shaft_angle": (0.01, 0.17), "oscillation_factor": (1.0, 4.0)}
RANGES |= {"roller_radius": (0.1, 0.4), "crown_radius": (0.5, 2.0), "first_poisson": (0.2, 0.4)}
RANGES |= {"second_poisson": (0.2, 0.4)}
ARM = {"arm_radius": "m", "offset": "m"}
TURN = {"torque": "N m", "roller_mass": "kg", "speed": "1/s"}
FLOAT = {"guide_half_length": "m", "roller_diameter": "m", "rim": "m"}
SHAFTS = {"offset": "m", "float_distance": "m", "shaft_angle": "-"}
LINE = {"normal_force": "N", "contact_modulus": "Pa", "contact_length": "m", "roller_radius": "m"}
POINT = {"normal_force": "N", "contact_modulus": "Pa", "roller_radius": "m", "crown_radius": "m"}
MOVING_MASS = {"angle": "-", "offset": "m", "speed": "1/s"}


def first(function):
    def call(**values):
        return function(**values)[0]

    return call


def first_components(**values):
    return rc.floating_mass_forces(**values)[1][1]


CASES = [
    (rc.effective_offset, SHAFTS, "m"),
    (rc.least_roller_distance, {**ARM, "guide_angle": "-"}, "m"),
    (rc.roller_gap_offset, {"arm_radius": "m", "roller_diameter": "m", "gap": "m", "guide_angle": "-"}, "m"),
    (rc.corner_distance, {"roller_diameter": "m", "gap": "m"}, "m"),
    (rc.run_in, {**ARM, "roller_diameter": "m", "guide_angle": "-"}, "m"),
    (rc.run_out, {"guide_half_length": "m", **ARM, "guide_angle": "-"}, "m"),
    (rc.even_guide_half_length, {"arm_radius": "m", "roller_diameter": "m", "guide_angle": "-"}, "m"),
    (rc.removal_clearance, {"arm_radius": "m", "roller_diameter": "m"}, "m"),
    (rc.removable_offset, {"arm_radius": "m", "gap": "m", "removal": "m"}, "m"),
    (
        rc.offset_capacity,
        {
            "arm_radius": "m",
            "guide_half_length": "m",
            "roller_diameter": "m",
            "gap": "m",
            "run_in_clearance": "m",
            "run_out_clearance": "m",
            "guide_angle": "-",
        },
        "m",
    ),
    (rc.float_centrifugal_force, {"float_mass": "kg", "offset": "m", "speed": "1/s"}, "N"),
    (rc.pin_centrifugal_force, {"float_mass": "kg", "offset": "m", "speed": "1/s", "guide_angle": "-"}, "N"),
    (rc.steady_shaft_force, {"pin_centrifugal_force": "N", "counter_force": "N"}, "N"),
    (rc.vibration_shaft_force, {"pin_centrifugal_force": "N", "counter_force": "N"}, "N"),
    (rc.tangential_force, {"torque": "N m", "first_radius": "m", "second_radius": "m"}, "N"),
    (rc.roller_centrifugal_force, {"roller_mass": "kg", "arm_radius": "m", "speed": "1/s"}, "N"),
    (rc.resultant_pin_force, {"normal_force": "N", "roller_force": "N"}, "N"),
    (rc.optimum_arm_radius, TURN, "m"),
    (rc.optimum_arm_radius_with_float, {**TURN, "pin_centrifugal_force": "N"}, "m"),
    (rc.rolling_efficiency, {"rolling_friction": "-", **ARM}, "-"),
    (rc.pin_shear_measure, {"torque": "N m", "arm_radius": "m", "bore": "m"}, "Pa"),
    (rc.pin_bending_stress, {"pin_force": "N", "width": "m", "pin_gap": "m", "bore": "m"}, "Pa"),
    (rc.pin_shear_stress, {"pin_force": "N", "bore": "m"}, "Pa"),
    (rc.pin_equivalent_stress, {"pin_force": "N", "width": "m", "pin_gap": "m", "bore": "m"}, "Pa"),
    (
        rc.pin_diameter_of_shaft,
        {"shaft_diameter": "m", "arm_radius": "m", "shaft_stress": "Pa", "pin_stress": "Pa"},
        "m",
    ),
    (
        hertz.contact_modulus,
        {"first_modulus": "Pa", "first_poisson": "-", "second_modulus": "Pa", "second_poisson": "-"},
        "Pa",
    ),
    (hertz.line_contact_pressure, LINE, "Pa"),
    (hertz.line_contact_half_width, LINE, "m"),
    (hertz.ellipticity, {"radius_share": "-"}, "-"),
    (hertz.point_contact_half_length, POINT, "m"),
    (hertz.point_contact_pressure, POINT, "Pa"),
    (
        hertz.barrel_contact_pressure,
        {
            "normal_force": "N",
            "loaded_rollers": "-",
            "contact_modulus": "Pa",
            "contact_length": "m",
            "barrel_radius": "m",
        },
        "Pa",
    ),
    (rc.allowed_pin_force, {"static_rating": "N", "oscillation_factor": "-", "static_safety": "-"}, "N"),
    (rc.float_radius, FLOAT, "m"),
    (rc.float_section, {**FLOAT, "guide_angle": "-"}, "m2"),
    (rc.float_width, {"contact_length": "m", "axial_slide": "m", "axial_play": "m"}, "m"),
    (rc.float_mass, {"density": "kg/m3", "width": "m", "section": "m2"}, "kg"),
    (rc.roller_mass, {"bearing_mass": "kg", "pin_density": "kg/m3", "bore": "m", "width": "m", "pin_gap": "m"}, "kg"),
    (rc.arms_mass, {"density": "kg/m3", "arm_radius": "m", "bore": "m"}, "kg"),
    (rc.ligament_stress, {"factor": "-", "normal_force": "N", "rim": "m", "width": "m"}, "Pa"),
    (rc.driven_angle, {"driving_angle": "-", "shaft_angle": "-"}, "-"),
    (rc.speed_ratio, {"driving_angle": "-", "shaft_angle": "-"}, "-"),
    (rc.speed_fluctuation, {"shaft_angle": "-"}, "-"),
    (rc.slide_position, {"driving_angle": "-", **SHAFTS}, "m"),
    (rc.axial_slide, {**SHAFTS, "guide_angle": "-"}, "m"),
    (rc.driven_inertia_torque, {"driven_inertia": "kg m2", "shaft_angle": "-", "speed": "1/s"}, "N m"),
    (
        rc.coupling_length,
        {"float_width": "m", "roller_width": "m", "pin_gap": "m", "bore": "m", "shaft_diameter": "m", "counter": "-"},
        "m",
    ),
    (rc.backlash_angle, {"play": "m", "arm_radius": "m"}, "-"),
    (rc.refuted_floating_mass, {"float_mass": "kg"}, "kg"),
    (first(rc.floating_mass_travel), MOVING_MASS, "m"),
    (first_components, {"mass": "kg", **MOVING_MASS}, "N"),
]
IDS = [getattr(case[0], "__name__", "call") + f"-{k}" for k, case in enumerate(CASES)]


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit_and_takes_symbols_and_arrays(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES)
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_no_formula_is_left_out():
    covered = {case[0].__name__ for case in CASES if not isinstance(case[0], partial)}
    covered |= {"floating_mass_travel", "floating_mass_forces"}
    public = {
        name
        for module in (rc, hertz)
        for name, member in inspect.getmembers(module, inspect.isfunction)
        if member.__module__ == module.__name__ and not name.startswith("_")
    }
    assert public <= covered, public - covered


# -- worked examples of the source, and what it prints --------------------------------------------------


def test_arm_radius_and_pin_force_of_the_example():
    torque, mass, r = 15 * KP, 0.4, 0.05
    assert 100 * rc.optimum_arm_radius(torque, mass, SPEED) == pytest.approx(4.49614, abs=5e-6)
    assert 21.2 / 2880 * math.sqrt(15 / 0.4) * 100 == pytest.approx(4.50774, abs=5e-6)  # printed 4.52
    tangential = rc.tangential_force(torque, r, r)
    own = rc.roller_centrifugal_force(mass, r, SPEED)
    assert tangential / KP == pytest.approx(150.0, abs=5e-4)
    assert own / KP == pytest.approx(185.503, abs=5e-4)  # printed 184
    assert mass * 2880**2 * r / 900 == pytest.approx(184.32)
    assert rc.resultant_pin_force(tangential, own) / KP == pytest.approx(238.561, abs=5e-4)  # printed 237
    best = rc.optimum_arm_radius(torque, mass, SPEED)
    at_best = rc.resultant_pin_force(
        rc.tangential_force(torque, best, best), rc.roller_centrifugal_force(mass, best, SPEED)
    )
    assert at_best / KP == pytest.approx(235.905, abs=5e-4)  # a flat optimum


def test_exact_factor_of_15():
    # r[m] = factor/n sqrt(M[mkp]/G[kp])
    assert 30 / math.pi * math.sqrt(KP / 2) == pytest.approx(21.1454, abs=5e-5)
    assert KP * (30 / math.pi) ** 2 == pytest.approx(894.7, abs=0.5)  # printed 900 as divisor


def test_clearances_of_the_example():
    r, diameter, s = 0.05, 0.054, 0.002
    assert 100 * rc.roller_gap_offset(r, diameter, s) == pytest.approx(1.47107, abs=5e-6)  # printed 1.45
    assert 100 * rc.corner_distance(diameter, s) == pytest.approx(1.25980, abs=5e-6)
    assert 100 * (0.027 * 0.41 + s / math.sqrt(2)) == pytest.approx(1.248, abs=5e-4)  # as printed
    assert 100 * rc.run_in(r, 0.0145, diameter) == pytest.approx(0.85)
    assert 100 * rc.run_in(r, rc.roller_gap_offset(r, diameter, s), diameter) == pytest.approx(0.828932, abs=5e-7)
    length = rc.even_guide_half_length(r, diameter)
    assert 100 * length == pytest.approx(7.3)
    assert rc.run_out(length, r, 0.0145) == pytest.approx(rc.run_in(r, 0.0145, diameter))
    assert 2 * length == pytest.approx(2 * (0.0145 + rc.run_in(r, 0.0145, diameter)) + 2 * r)
    assert 100 * rc.removal_clearance(r, diameter) == pytest.approx(-0.4)


def test_removable_version_of_the_example():
    r, diameter = 0.056, 0.054
    assert rc.removal_clearance(r, diameter) == pytest.approx(0.002)
    assert 100 * rc.removable_offset(r, 0.002, 0.002) == pytest.approx(2.31960, abs=5e-6)  # printed 2.3
    assert rc.removable_offset(r, 0.002, 0.002) == pytest.approx(0.41421 * r, rel=1e-5)  # (22a)
    # the same offset as by the gap between the rollers, (18b)
    assert rc.removable_offset(r, 0.003, 0.002) == pytest.approx(rc.roller_gap_offset(r, diameter, 0.003))
    assert 100 * rc.even_guide_half_length(r, diameter) == pytest.approx(8.5)
    assert 100 * rc.run_in(r, 0.0231960, diameter) == pytest.approx(0.580404, abs=5e-6)


def test_example_with_two_and_a_half_degrees():
    angle = math.radians(2.5)
    assert 100 * rc.speed_fluctuation(angle) == pytest.approx(0.0952685, abs=5e-8)  # printed 0.063
    assert 100 * math.sin(angle) * math.tan(angle) == pytest.approx(0.190446, abs=5e-7)
    assert 1000 * rc.axial_slide(0.0, 0.6, angle) == pytest.approx(1.14268, abs=5e-6)  # printed 0.75
    # the printed sine 0.03548 is that of 2 degrees 2 minutes, and the printed figures follow from it
    wrong = math.asin(0.03548)
    assert math.degrees(wrong) == pytest.approx(2 + 2 / 60, abs=1e-3)
    assert 100 * rc.speed_fluctuation(wrong) == pytest.approx(0.063, abs=5e-4)
    assert 1000 * rc.axial_slide(0.0, 0.6, wrong) == pytest.approx(0.755, abs=5e-3)


def test_hertz_limit_is_1961_mpa_and_not_the_modulus():
    assert 20_000 * KP * 1e4 / 1e6 == pytest.approx(1961.33)
    # p = sqrt(2 f E*/(pi l d)) with both bodies alike, E* = E/(2 (1 - nu**2)), in kp and mm
    modulus = 86.1**2 * math.pi * (1 - 0.3**2)
    assert modulus == pytest.approx(21193, abs=1)
    assert modulus * KP / 1e3 == pytest.approx(207.83, abs=0.01)
    assert 20_000 == pytest.approx(modulus, rel=0.06)  # so 20 000 kp/mm2 cannot be a pressure
    contact = hertz.contact_modulus(207.83e9, 0.3, 207.83e9, 0.3)
    pressure = hertz.line_contact_pressure(KP * 100, contact, 0.01, 0.01)
    assert pressure / KP / 1e6 == pytest.approx(86.1 * math.sqrt(100 / (20 * 10)), rel=1e-4)


def test_plastic_float_has_a_sixth_of_the_pressure():
    steel = hertz.contact_modulus(206e9, 0.3, 206e9, 0.3)
    nylon = hertz.contact_modulus(206e9, 0.3, 2.8e9, 0.39)
    assert math.sqrt(nylon / steel) == pytest.approx(0.1696, abs=2e-4)


def test_printed_pin_diameter_is_two_and_a_half_per_cent_small():
    shaft, r = 0.04, 0.05
    exact = rc.pin_diameter_of_shaft(shaft, r, 600 * KP * 1e4, 400 * KP * 1e4)
    assert exact / (shaft / 2 * math.sqrt(shaft / r)) == pytest.approx(1.0247, abs=5e-5)
    # (17) is (16) with the torque of the shaft, M = pi D**3/32 sigma_t
    torque = math.pi * shaft**3 / 32 * 600 * KP * 1e4
    assert rc.pin_shear_measure(torque, r, exact) == pytest.approx(400 * KP * 1e4)


# -- independent derivations ----------------------------------------------------------------------------


def test_optimum_arm_radius_is_a_minimum():
    torque, mass, speed, push = 400.0, 0.8, 200.0, 900.0

    def force(r):
        return math.hypot(torque / 2 / r + push, mass * r * speed**2)

    best = optimize.minimize_scalar(force, bounds=(0.01, 1), method="bounded", options={"xatol": 1e-10}).x
    found = float(rc.optimum_arm_radius_with_float(torque, mass, speed, push))
    assert found == pytest.approx(best, rel=1e-6)
    assert found > rc.optimum_arm_radius(torque, mass, speed)


@settings(max_examples=100, deadline=None)
@given(st.floats(1, 1e5), st.floats(0.01, 20), st.floats(1, 600), st.one_of(st.just(0.0), st.floats(1e-3, 1e6)))
def test_optimum_arm_radius_solves_its_quartic(torque, mass, speed, push):
    r = float(rc.optimum_arm_radius_with_float(torque, mass, speed, push))
    left = mass**2 * speed**4 * r**4
    assert left == pytest.approx(push * torque * r / 2 + torque**2 / 4, rel=1e-9)


def test_line_contact_carries_its_load():
    force, modulus, length, radius = 2500.0, 113e9, 0.012, 0.026
    p = hertz.line_contact_pressure(force, modulus, length, radius)
    a = hertz.line_contact_half_width(force, modulus, length, radius)
    carried, _ = integrate.quad(lambda x: p * math.sqrt(1 - (x / a) ** 2) * length, -a, a)
    assert carried == pytest.approx(force, rel=1e-6)
    # the strip has the curvature of the roller, 1/R = 2 p/(a E*)
    assert 2 * p / (a * modulus) == pytest.approx(1 / radius)


def exact_point_contact(force, modulus, rx, ry):
    """Long half axis and peak pressure by the elliptic integrals of Hertz's theory."""

    def curvature_ratio(k):  # of the gap, as a function of long over short axis
        m = 1 - 1 / k**2
        e, f = special.ellipe(m), special.ellipk(m)
        return (k**2 * e - f) / (f - e) - ry / rx

    k = optimize.brentq(curvature_ratio, 1.0001, 1e3)
    e = special.ellipe(1 - 1 / k**2)
    reduced = 1 / (1 / rx + 1 / ry)
    long_axis = (3 * k**2 * e * force * reduced / (math.pi * modulus)) ** (1 / 3)
    return long_axis, 3 * force * k / (2 * math.pi * long_axis**2)


@pytest.mark.parametrize(("rx", "share"), [(0.008, 0.015), (0.017, 0.005), (0.026, 0.005), (0.045, 0.005)])
def test_point_contact_against_the_elliptic_integrals(rx, share):
    length, pressure = exact_point_contact(3000.0, 113e9, rx, 0.5)
    assert float(hertz.point_contact_pressure(3000.0, 113e9, rx, 0.5)) == pytest.approx(pressure, rel=share)
    assert float(hertz.point_contact_half_length(3000.0, 113e9, rx, 0.5)) == pytest.approx(length, rel=0.03)


@pytest.mark.parametrize("chi", [60, 75, 90])
def test_section_of_the_float_by_counting(chi):
    angle, k, d, t = math.radians(chi), 0.073, 0.054, 0.005
    radius = float(rc.float_radius(k, d, t))
    x, y = np.meshgrid(*[np.linspace(-radius, radius, 1201)] * 2)

    def slot(direction):
        along = x * math.cos(direction) + y * math.sin(direction)
        across = -x * math.sin(direction) + y * math.cos(direction)
        return (np.abs(along) <= k) & (np.abs(across) <= d / 2)

    solid = (np.hypot(x, y) <= radius) & ~slot(0.0) & ~slot(angle)
    counted = solid.mean() * (2 * radius) ** 2
    assert float(rc.float_section(k, d, t, angle)) == pytest.approx(counted, rel=4e-3)
    plain = math.pi * radius**2 - (4 * k * d - d**2 / math.sin(angle))
    assert float(rc.float_section(k, d, t, angle)) == pytest.approx(plain, rel=1e-12)


def test_driven_angle_and_speed_ratio_of_a_cardan_joint():
    angle = math.radians(4.0)
    phi = np.linspace(0.1, 1.4, 50)
    assert np.tan(rc.driven_angle(phi, angle)) == pytest.approx(np.tan(phi) / math.cos(angle))
    step = 1e-6
    slope = (rc.driven_angle(phi + step, angle) - rc.driven_angle(phi - step, angle)) / (2 * step)
    assert slope == pytest.approx(rc.speed_ratio(phi, angle), rel=1e-8)
    turn = np.linspace(0, 2 * np.pi, 1441)
    assert rc.speed_ratio(turn, angle).max() == pytest.approx(1 / math.cos(angle))
    assert rc.speed_ratio(turn, angle).min() == pytest.approx(math.cos(angle))
    lead = rc.driven_angle(turn, angle) - turn
    assert lead == pytest.approx(angle**2 / 4 * np.sin(2 * turn), abs=2e-3 * angle**2)


@settings(max_examples=60, deadline=None)
@given(st.floats(0, 0.2), st.floats(0, 2), st.floats(1e-3, 0.17))
def test_slide_is_the_range_of_its_course(offset, distance, angle):
    psi = np.linspace(0, 2 * np.pi, 7201)
    course = rc.slide_position(psi, offset, distance, angle)
    assert np.ptp(course) == pytest.approx(float(rc.axial_slide(offset, distance, angle)), rel=1e-5, abs=1e-12)


def test_skew_shafts_slide_with_the_float_on_the_common_normal():
    """The source finds none: it looked at 0 and 90 degrees only, where there is none indeed."""
    angle = math.radians(2.5)
    at = rc.slide_position(np.array([0.0, math.pi / 2]), 0.01, 0.0, angle)
    assert at == pytest.approx([0, 0], abs=1e-18)
    assert rc.axial_slide(0.01, 0.0, angle) == pytest.approx(0.01 * math.tan(angle))
    # intersecting shafts: equation (25)
    assert rc.axial_slide(0.0, 0.6, angle) == pytest.approx(0.6 * math.sin(angle) ** 2 / math.cos(angle))


# -- floating masses: the refuted claim -----------------------------------------------------------------


def inertia_in_the_float(phi, e, omega, point):
    """Relative, transport and Coriolis acceleration, along u1 and u2, of a point that stays where it is in space.

    By finite differences of its coordinates in the float, whose centre is O = e sin(phi) u1 with u1 = (sin, cos).
    """

    def frame(p):
        u1, u2 = np.array([math.sin(p), math.cos(p)]), np.array([math.cos(p), -math.sin(p)])
        return e * math.sin(p) * u1, u1, u2

    def local(p):
        centre, u1, u2 = frame(p)
        return np.array([(point - centre) @ u1, (point - centre) @ u2])

    step = 1e-4
    _, u1, u2 = frame(phi)
    speed = (local(phi + step) - local(phi - step)) / (2 * step) * omega
    relative = (local(phi + step) - 2 * local(phi) + local(phi - step)) / step**2 * omega**2

    def fixed(p):  # where the point of the float that the mass is at now goes
        c, a, b = frame(p)
        return c + local(phi) @ np.array([a, b])

    drawn = (fixed(phi + step) - 2 * fixed(phi) + fixed(phi - step)) / step**2 * omega**2
    transport = np.array([drawn @ u1, drawn @ u2])
    turning = -omega  # u1 turns clockwise with rising phi
    moving = speed[0] * u1 + speed[1] * u2
    coriolis = 2 * turning * np.array([-moving[1], moving[0]])
    return relative, transport, np.array([coriolis @ u1, coriolis @ u2])


def test_masses_at_rest_exert_no_force_so_that_29_is_wrong():
    e, omega, m = 0.01, 100.0, 3.0
    m0 = rc.refuted_floating_mass(m)
    assert m0 == m / 2
    # The print adds the sizes of the three parts: 4 m0 e omega**2, and sets it equal to the float's own force.
    assert 4 * m0 * e * omega**2 == pytest.approx(rc.float_centrifugal_force(m, e, omega))
    for phi in np.linspace(0.1, 6.2, 13):
        for point, own in ((np.zeros(2), True), (np.array([e, 0.0]), False)):
            parts = inertia_in_the_float(phi, e, omega, point)
            assert np.sum(parts, axis=0) == pytest.approx([0, 0], abs=1e-5 * e * omega**2)
            sizes = [float(np.hypot(*x)) / (e * omega**2) for x in parts]
            assert max(sizes) > 0.5  # the parts themselves are not small
            if own:
                stated = rc.floating_mass_forces(phi, 1.0, e, omega)
                for found, part in zip(parts, stated, strict=True):
                    assert found == pytest.approx(np.array(part), abs=1e-5 * e * omega**2)
    # What is left of the float's force is therefore all of it.
    left = rc.float_centrifugal_force(m, e, omega) - np.hypot(
        *np.sum(rc.floating_mass_forces(0.7, m0, e, omega), axis=0)
    )
    assert left == pytest.approx(rc.float_centrifugal_force(m, e, omega))


def test_travel_of_a_floating_mass_and_its_derivatives():
    e, omega = 0.01, 100.0
    phi, step = np.linspace(0, 6, 20), 1e-4
    travel, speed, acceleration = rc.floating_mass_travel(phi, e, omega)
    later, earlier = rc.floating_mass_travel(phi + step, e, omega), rc.floating_mass_travel(phi - step, e, omega)
    assert (later[0] - earlier[0]) / (2 * step) * omega == pytest.approx(speed, abs=1e-7)
    assert (later[1] - earlier[1]) / (2 * step) * omega == pytest.approx(acceleration, abs=1e-5)
    assert travel[0] == 0
    # the mass on shaft 2, e (1 - sin(phi)): the sign that (27a) lost
    second = (e * (1 - np.sin(phi + step)) - e * (1 - np.sin(phi - step))) / (2 * step) * omega
    assert second == pytest.approx(-e * omega * np.cos(phi), abs=1e-7)
