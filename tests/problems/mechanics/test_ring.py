"""Geometry, torque and sizing of friction rings."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from synth.problems.mechanics import ring

QUICK = settings(deadline=None, derandomize=True, max_examples=60)
mean_diameters = st.floats(0.01, 2.0)
ratios = st.floats(0.001, 0.9)


@QUICK
@given(mean_diameters, ratios)
def test_diameters_and_ratio_are_one_to_one(mean, ratio):
    outer, inner = ring.outer_diameter(mean, ratio), ring.inner_diameter(mean, ratio)
    assert ring.mean_diameter(outer, inner) == pytest.approx(mean, rel=1e-12)
    assert ring.ring_ratio(outer, inner) == pytest.approx(ratio, rel=1e-10)


@QUICK
@given(mean_diameters, st.floats(0.05, 0.9))
def test_radius_and_area_are_the_ring_integrals(mean, ratio):
    r1, r2 = mean * (1 - ratio) / 2, mean * (1 + ratio) / 2
    area = quad(lambda r: 2 * math.pi * r, r1, r2)[0]
    moment = quad(lambda r: 2 * math.pi * r**2, r1, r2)[0]
    assert ring.ring_area(mean, ratio) == pytest.approx(area, rel=1e-10)
    assert ring.friction_radius(mean, ratio) == pytest.approx(moment / area, rel=1e-10)
    assert ring.pressure_torque(3, 0.2, 1e5, mean, ratio) == pytest.approx(3 * 0.2 * 1e5 * moment, rel=1e-10)


@QUICK
@given(mean_diameters, st.floats(1e-12, 1e-6))
def test_radius_of_a_vanishing_ring_is_half_the_mean_diameter(mean, ratio):
    assert ring.friction_radius(mean, ratio) == pytest.approx(mean / 2, rel=1e-11)


@QUICK
@given(st.floats(1, 1e5), st.integers(1, 60), st.floats(0.03, 0.5), st.floats(1e5, 5e6), st.floats(0.02, 0.5))
def test_sizing_is_the_inverse_of_the_torque(torque, surfaces, mu, pressure, ratio):
    mean = ring.sizing_mean_diameter(torque, surfaces, mu, pressure, ratio)
    assert ring.pressure_torque(surfaces, mu, pressure, mean, ratio) == pytest.approx(torque, rel=1e-12)


@QUICK
@given(st.floats(1, 1e5), mean_diameters, st.floats(0.05, 0.3), st.floats(0.03, 0.5), st.floats(1e5, 5e6))
def test_surfaces_needed_are_even_enough_and_not_too_many(torque, mean, ratio, mu, pressure):
    surfaces = float(ring.surfaces_needed(torque, mean, ratio, mu, pressure))
    one = ring.pressure_torque(1, mu, pressure, mean, ratio)
    assert surfaces % 2 == 0
    assert surfaces * one >= torque * (1 - 1e-11)
    assert (surfaces - 2) * one < torque


def test_surfaces_needed_takes_an_exact_fit():
    mean = ring.sizing_mean_diameter(1000.0, 8, 0.1, 5e5, 0.2)
    assert ring.surfaces_needed(1000.0, mean, 0.2, 0.1, 5e5) == 8


@pytest.mark.parametrize(("surfaces", "outer", "inner"), [(2, 1, 2), (10, 5, 6), (24, 12, 13)])
def test_plate_counts(surfaces, outer, inner):
    assert ring.outer_plate_count(surfaces) == outer
    assert ring.inner_plate_count(surfaces) == inner
    assert outer + inner == surfaces + 1


@QUICK
@given(st.floats(0.01, 0.3))
def test_worn_lining_loses_the_share_of_the_ring_ratio(ratio):
    new = ring.friction_torque(0.3, 5000, ring.friction_radius(0.25, ratio), 2)
    assert ring.worn_torque(2, 0.3, 5000, 0.25) * (1 + ratio**2 / 3) == pytest.approx(new, rel=1e-13)


def test_worn_pressure_carries_the_force_with_pressure_times_radius_constant():
    mean, ratio, force = 0.2, 0.2, 7000.0
    r1, r2 = mean * (1 - ratio) / 2, mean * (1 + ratio) / 2
    peak = ring.worn_peak_pressure(force, mean, ratio)
    assert quad(lambda r: peak * r1 / r * 2 * math.pi * r, r1, r2)[0] == pytest.approx(force, rel=1e-12)


@pytest.mark.parametrize(
    ("outer", "inner", "surfaces", "mu", "force", "sine", "mean_pressure", "edge_pressure", "worn", "new"),
    [
        (0.2484, 0.1987, 2, 0.3, 1938.0, 1.0, 0.111045978, 0.124933711, 129.971970, 130.507313),
        (0.258110624, 0.154866374, 10, 0.1, 13394.966, 1.0, 0.4, 0.533333342, 1382.95321, 1411.76474),
        (0.236, 0.196, 1, 0.3, 1500.0, math.sin(math.radians(12)), 0.110524266, 0.121802252, 233.753089, 234.421108),
    ],
)
def test_new_and_worn_rings_of_a_car_a_pack_and_a_cone(
    outer, inner, surfaces, mu, force, sine, mean_pressure, edge_pressure, worn, new
):
    mean, ratio = ring.mean_diameter(outer, inner), ring.ring_ratio(outer, inner)
    normal = force / sine  # the surfaces of a cone are larger by the same share
    assert normal / (ring.ring_area(mean, ratio) / sine) / 1e6 == pytest.approx(mean_pressure, rel=2e-8)
    peak = ring.worn_peak_pressure(force, mean, ratio)
    assert peak / 1e6 == pytest.approx(edge_pressure, rel=2e-8)
    assert ring.worn_torque(surfaces, mu, normal, mean) == pytest.approx(worn, rel=2e-8)
    radius = ring.friction_radius(mean, ratio)
    assert ring.friction_torque(mu, normal, radius, surfaces) == pytest.approx(new, rel=2e-8)
    # Pressure times radius is constant: torque of the rings one by one.
    rings = quad(lambda r: mu * peak * inner / 2 / r * r * 2 * math.pi * r / sine, inner / 2, outer / 2)[0]
    assert surfaces * rings == pytest.approx(worn, rel=2e-8)


def test_required_torque_without_surface_factor_is_that_with_factor_one():
    assert ring.required_torque(600, 1.5, 0.9, 0.85) == ring.required_torque(600, 1.5, 0.9, 0.85, 1)
    assert np.all(ring.required_torque(np.array([1.0, 2.0]), 1.5, 1, 0.75, 0.5) == [4.0, 8.0])
