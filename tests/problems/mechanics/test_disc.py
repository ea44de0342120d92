"""Mass, inertia, length and pressure of disc clutches, by integrals and by hand."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from synth.problems.mechanics import disc, ring

QUICK = settings(deadline=None, derandomize=True, max_examples=60)
mean_diameters = st.floats(0.05, 1.0)
ratios = st.floats(0.05, 0.3)


@QUICK
@given(mean_diameters, ratios)
def test_inertia_is_the_integral_over_the_ring(mean, ratio):
    r1, r2 = mean * (1 - ratio) / 2, mean * (1 + ratio) / 2
    per_radius = quad(lambda r: 2 * math.pi * r**3, r1, r2)[0]
    assert disc.lining_inertia(1600, 0.003, mean, ratio) == pytest.approx(2 * 1600 * 0.003 * per_radius, rel=1e-10)
    core = quad(lambda r: 2 * math.pi * r**3, 0.02, r2)[0]
    assert disc.core_inertia(7850, 0.002, r2, 0.02) == pytest.approx(7850 * 0.002 * core, rel=1e-9)


@QUICK
@given(mean_diameters, ratios, st.floats(100, 2e4))
def test_worn_pressure_carries_the_force_and_the_worn_torque(mean, ratio, force):
    r1, r2 = mean * (1 - ratio) / 2, mean * (1 + ratio) / 2

    def pressure(r):
        return disc.worn_pressure(force, mean, ratio, r)

    assert quad(lambda r: pressure(r) * 2 * math.pi * r, r1, r2)[0] == pytest.approx(force, rel=1e-10)
    torque = quad(lambda r: 0.3 * pressure(r) * 2 * math.pi * r**2, r1, r2)[0]
    assert ring.worn_torque(1, 0.3, force, mean) == pytest.approx(torque, rel=1e-10)
    assert pressure(r1) == pytest.approx(ring.worn_peak_pressure(force, mean, ratio), rel=1e-12)
    # The worn-in ring carries less than the new one by the factor 1/(1 + c**2/3).
    new = ring.friction_torque(0.3, force, ring.friction_radius(mean, ratio), 1)
    assert new / torque == pytest.approx(1 + ratio**2 / 3, rel=1e-10)


def test_length_is_that_of_the_stack():
    lining, core, plate, gap = 3.0, 2.0, 8.0, 0.3
    one = [gap, lining, core, lining, gap, plate]
    assert disc.clutch_length(1, lining, core, plate, gap) == pytest.approx(sum(one))
    assert disc.clutch_length(2, lining, core, plate, gap) == pytest.approx(2 * sum(one))


def test_the_lecture_sizes_a_disc_for_one_pair_of_surfaces():
    """S1 prints dm = cbrt(6 M/(mu pi (3c + c**3) p)) for one pair; a disc in a car has two."""
    mean = float(ring.sizing_mean_diameter(176.47, 1, 0.35, 0.5e6, 0.12))
    assert mean == pytest.approx((6 * 176.47 / (0.35 * math.pi * (3 * 0.12 + 0.12**3) * 0.5e6)) ** (1 / 3), rel=1e-12)
    two = float(ring.sizing_mean_diameter(176.47, disc.surface_count(1), 0.35, 0.5e6, 0.12))
    assert two == pytest.approx(mean / 2 ** (1 / 3), rel=1e-12)
    assert ring.pressure_torque(2, 0.35, 0.5e6, two, 0.12) == pytest.approx(176.47, rel=1e-12)


def test_half_of_the_work_heats_the_hottest_plate():
    """Work per surface is W/z, and the linings insulate: the metal that faces a surface takes its work."""
    single = {"pressure plate": 1, "flywheel": 1}
    twin = {"pressure plate": 1, "intermediate plate": 2, "flywheel": 1}
    for discs, faces in ((1, single), (2, twin)):
        assert sum(faces.values()) == disc.surface_count(discs)
        assert max(faces.values()) / disc.surface_count(discs) == disc.HOTTEST_PLATE_SHARE
