"""Cone clutch against integrals over its face and the equilibrium of single elements."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from synth.problems.cone import formulas as cone
from synth.problems.mechanics import ring

QUICK = settings(deadline=None, derandomize=True, max_examples=60)
angles = st.floats(math.radians(4), math.radians(30))
frictions = st.floats(0.05, 0.6)
diameters = st.floats(0.05, 0.8)
ratios = st.floats(0.05, 0.3)


def face(mean, ratio, angle):
    """Radius at a place along the generator, and the ends of the generator."""
    half = mean * ratio / 2
    return (lambda s: mean / 2 + s * math.sin(angle)), -half, half


@QUICK
@given(diameters, ratios, angles, frictions)
def test_torque_and_area_are_the_integrals_over_the_face(mean, ratio, angle, mu):
    radius, low, high = face(mean, ratio, angle)
    area = quad(lambda s: 2 * math.pi * radius(s), low, high)[0]
    moment = quad(lambda s: 2 * math.pi * radius(s) ** 2, low, high)[0]
    assert cone.face_area(mean, mean * ratio) == pytest.approx(area, rel=1e-10)
    pressure = 3e5
    torque = mu * pressure * moment
    assert cone.pressure_torque(mu, pressure, mean, ratio, angle) == pytest.approx(torque, rel=1e-10)
    assert cone.friction_torque(mu * pressure * area, mean, ratio, angle) == pytest.approx(torque, rel=1e-10)
    assert cone.largest_diameter(mean, mean * ratio, angle) == pytest.approx(2 * radius(high), rel=1e-12)


@QUICK
@given(diameters, ratios, angles, frictions)
def test_worn_in_faces_carry_by_their_mean_radius(mean, ratio, angle, mu):
    radius, low, high = face(mean, ratio, angle)
    constant = 4e4  # pressure times radius
    normal = quad(lambda s: constant / radius(s) * 2 * math.pi * radius(s), low, high)[0]
    torque = quad(lambda s: mu * constant / radius(s) * 2 * math.pi * radius(s) ** 2, low, high)[0]
    assert cone.worn_torque(mu * normal, mean) == pytest.approx(torque, rel=1e-10)
    new = cone.friction_torque(mu * normal, mean, ratio, angle)
    assert new / torque == pytest.approx(cone.mean_radius_factor(ratio, angle), rel=1e-10)


@QUICK
@given(angles, frictions, st.floats(100, 1e5))
def test_axial_forces_balance_pressure_and_friction_on_every_element(angle, mu, normal):
    """Vectors in the axial plane: the pressure is normal to the generator, friction along it and against the motion."""
    along = np.array([math.cos(angle), math.sin(angle)])  # of the generator, towards the wide end: axis, radius
    outward = np.array([-math.sin(angle), math.cos(angle)])  # normal to the generator
    push = -normal * outward  # on the inner cone, which is narrow at its negative end
    # Engaging moves the inner cone towards its narrow end, so friction on it points to the wide one; releasing back.
    for sign, formula in ((1, cone.engaging_force), (-1, cone.release_force)):
        on_inner = push + sign * mu * normal * along
        assert formula(normal, angle, mu) == pytest.approx(on_inner[0], rel=1e-9, abs=1e-9 * normal)
    assert cone.service_force(normal, angle) == pytest.approx(push[0], rel=1e-12)
    assert cone.normal_force(cone.engaging_force(normal, angle, mu), angle, mu) == pytest.approx(normal, rel=1e-12)


@QUICK
@given(angles, frictions)
def test_order_of_the_axial_forces_and_self_locking(angle, mu):
    engage = cone.engaging_force(1.0, angle, mu)
    release = cone.release_force(1.0, angle, mu)
    assert release < cone.service_force(1.0, angle) < engage
    assert bool(cone.self_locking(angle, mu)) == (release < 0)
    assert cone.release_force(1.0, cone.locking_angle(mu), mu) == pytest.approx(0, abs=1e-12)


@QUICK
@given(angles, frictions, diameters, st.floats(10, 1e4))
def test_forces_of_a_torque_are_those_of_the_lecture(angle, mu, mean, torque):
    """F = 2 M sin(alpha)/(mu dm) in service, with the mean radius; engaging adds mu cos(alpha)."""
    normal = 2 * torque / (mu * mean)
    assert cone.worn_torque(mu * normal, mean) == pytest.approx(torque, rel=1e-12)
    assert cone.service_force(normal, angle) == pytest.approx(2 * torque * math.sin(angle) / (mu * mean), rel=1e-12)
    spring = 2 * torque / (mu * mean) * (math.sin(angle) + mu * math.cos(angle))
    assert cone.engaging_force(normal, angle, mu) == pytest.approx(spring, rel=1e-12)
    assert spring * cone.grip_factor(angle, mu) * mean / 2 == pytest.approx(torque, rel=1e-12)


@QUICK
@given(angles, frictions, st.floats(100, 1e5))
def test_seating_keeps_the_spring_and_loses_the_axial_friction(angle, mu, spring):
    engaged, seated = cone.normal_force(spring, angle, mu), cone.seated_force(spring, angle)
    assert cone.service_force(seated, angle) == pytest.approx(spring, rel=1e-12)
    assert seated / engaged == pytest.approx(cone.seating_factor(angle, mu), rel=1e-12)


def test_seating_of_the_reference():
    assert float(cone.seating_factor(math.radians(12), 0.25)) == pytest.approx(2.2, abs=0.05)


@QUICK
@given(st.floats(10, 1e4), frictions, st.floats(1e5, 2e6), ratios, angles)
def test_sizing_is_the_inverse_of_the_torque(torque, mu, pressure, ratio, angle):
    mean = cone.sizing_mean_diameter(torque, mu, pressure, ratio, angle)
    assert cone.pressure_torque(mu, pressure, mean, ratio, angle) == pytest.approx(torque, rel=1e-12)


def test_the_mean_radius_is_good_enough_in_the_range_of_the_lecture():
    """What the lecture presumably printed, cbrt(2 M/(mu pi c p)), is at most 0.26 % off in torque."""
    mean = float(cone.sizing_mean_diameter(352.94, 0.3, 4e5, 0.2, 0.0))
    assert mean == pytest.approx((2 * 352.94 / (0.3 * math.pi * 0.2 * 4e5)) ** (1 / 3), rel=1e-12)
    excess = cone.mean_radius_factor(np.linspace(0.15, 0.2, 6)[:, None], np.linspace(0.1, 0.45, 20)) - 1
    assert 0.0025 < excess.max() <= 0.0026


def test_a_right_angle_is_a_disc():
    mean, ratio = 0.2, 0.12
    disc = ring.friction_torque(0.3, 5000, ring.friction_radius(mean, ratio), 1)
    flat = cone.friction_torque(0.3 * 5000, mean, ratio, math.pi / 2)
    assert flat == pytest.approx(disc, rel=1e-12)
    assert cone.pressure_torque(0.3, 4e5, mean, ratio, math.pi / 2) == pytest.approx(
        ring.pressure_torque(1, 0.3, 4e5, mean, ratio), rel=1e-12
    )
    assert cone.service_force(5000, math.pi / 2) == pytest.approx(5000)
    assert cone.wedge_factor(math.pi / 2, 0.3) == pytest.approx(1.0)


@QUICK
@given(angles, angles, frictions)
def test_a_slender_cone_needs_less_spring_but_seats_and_locks(first, second, mu):
    slender, blunt = min(first, second), max(first, second)
    assert cone.grip_factor(slender, mu) >= cone.grip_factor(blunt, mu)
    # The wedge effect, less spring than a disc needs, ends where (1 - sin)/cos has fallen to the friction.
    assert (cone.grip_factor(slender, mu) > mu) == (mu < (1 - math.sin(slender)) / math.cos(slender))
    assert cone.seating_factor(slender, mu) >= cone.seating_factor(blunt, mu)
    assert cone.release_force(1.0, slender, mu) <= cone.release_force(1.0, blunt, mu)


def test_size_and_mass_by_hand():
    angle = math.radians(15)
    widest = cone.largest_diameter(0.2, 0.036, angle)
    assert cone.overall_diameter(widest, 0.005, 0.003) == pytest.approx(0.2 + 0.036 * math.sin(angle) + 0.016)
    assert cone.overall_length(0.036, angle, 0.03) == pytest.approx(0.036 * math.cos(angle) + 0.03)
    area = math.pi * 0.2 * 0.036
    shells, lining = 2 * 7850 * area * 0.005, 1600 * area * 0.003
    assert 2 * cone.shell_mass(7850, area, 0.005) == pytest.approx(shells)
    assert cone.clutch_mass(1.35, area, 7850, 0.005, 1600, 0.003) == pytest.approx(1.35 * (shells + lining))
    assert cone.bearing_force(900.0, 1) == 0
    assert cone.bearing_force(900.0, 0) == 900
