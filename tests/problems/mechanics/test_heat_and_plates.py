"""Heat of engagements and the parts of a plate pack, against independent calculations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from synth.problems.mechanics import heat, plates

QUICK = settings(deadline=None, derandomize=True, max_examples=40)


@QUICK
@given(st.floats(1e2, 1e5), st.floats(1e-4, 0.5), st.floats(100, 1e4), st.floats(5, 300), st.floats(0.05, 1))
def test_peak_temperature_is_the_fixed_point_of_heating_and_cooling(work, rate, capacity, transfer, area):
    peak = heat.peak_temperature_rise(work, rate, capacity, transfer, area)
    decay = math.exp(-heat.cycle_time(rate) / heat.thermal_time_constant(capacity, transfer, area))
    assert peak * decay + work / capacity == pytest.approx(peak, rel=1e-9)
    mean = heat.mean_temperature_rise(work, rate, transfer, area)
    assert peak >= mean * (1 - 1e-12)
    assert peak >= heat.adiabatic_rise(work, 1.0, capacity) * (1 - 1e-12)


def test_peak_temperature_at_a_low_rate_is_one_adiabatic_rise():
    assert heat.peak_temperature_rise(5000, 1e-7, 1000, 50, 0.2) == pytest.approx(5.0, rel=1e-12)


def test_peak_temperature_at_a_high_rate_is_the_mean_rise():
    mean = heat.mean_temperature_rise(1.0, 1e4, 50, 0.2)
    assert heat.peak_temperature_rise(1.0, 1e4, 1000, 50, 0.2) == pytest.approx(mean, rel=1e-6)


@QUICK
@given(st.integers(1, 60), st.floats(1e2, 1e5), st.floats(1e-3, 0.5), st.floats(100, 1e4), st.floats(0.5, 100))
def test_the_rise_of_a_row_is_that_of_heating_and_cooling_one_by_one(n, work, rate, capacity, conductance):
    rise = 0.0
    for _ in range(n):  # cooling until the next, by the exact solution of C dT/dt = -G T
        rise = rise * math.exp(-conductance / (capacity * rate)) + work / capacity
    assert heat.rise_after(n, work, rate, capacity, conductance) == pytest.approx(rise, rel=1e-9)


def test_the_rise_of_a_row_is_that_of_integration():
    work, rate, capacity, conductance = 39524.1, 50 / 3600, 4000.0, 9.0
    rises, rise = [], 0.0
    for _ in range(100):
        rises.append(rise := rise + work / capacity)
        cooling = solve_ivp(lambda _, y: -conductance * y / capacity, (0, 1 / rate), [rise], rtol=1e-12, atol=1e-12)
        rise = cooling.y[0, -1]
    for n, worked in ((1, 9.881025), (10, 52.9930920), (100, 66.0678234)):
        assert heat.rise_after(n, work, rate, capacity, conductance) == pytest.approx(worked, rel=1e-8)
        assert rises[n - 1] == pytest.approx(worked, rel=1e-8)
    steady = heat.rise_after(math.inf, work, rate, capacity, conductance)
    assert steady == pytest.approx(66.0678295, rel=2e-9)
    assert steady == pytest.approx(heat.peak_temperature_rise(work, rate, capacity, conductance, 1.0), rel=1e-14)


def test_heat_goes_into_air_and_oil_by_the_worked_numbers():
    for speed, factor, worked in ((0, 1, 0.6), (15, 1, 1.90907421), (15, 2.5, 4.77268552)):
        assert heat.conductance(12, 3, speed, 0.05, factor) == pytest.approx(worked, rel=3e-9)
        steady = heat.mean_temperature_rise(
            100.0, 1.0, 12 + 3 * math.exp(0.8 * math.log(speed or 1e-99)), 0.05 * factor
        )
        assert 100.0 / heat.conductance(12, 3, speed, 0.05, factor) == pytest.approx(steady, rel=1e-12)
    for power, worked in ((1000.0, 1.76834660), (548.9, 0.970645447)):
        flow = heat.oil_flow(power, 20, 870 * 1950)
        assert 60000 * flow == pytest.approx(worked, rel=3e-9)
        assert heat.adiabatic_rise(power, 870 * flow, 1950) == pytest.approx(20, rel=1e-12)  # of what flows in a second


@pytest.mark.parametrize(
    ("single", "hourly", "per_hour", "allowed"),
    [(1.8, 25, 50, 0.436562769), (1.5, 12, 8, 0.948180838), (2.5, 18, 60, 0.282698908), (1.8, 250, 50, 1.68808226)],
)
def test_allowed_work_has_single_and_hourly_heat_as_its_ends(single, hourly, per_hour, allowed):
    def law(rate):
        return heat.allowed_work_at_rate(single, hourly / single, rate)

    assert law(per_hour) == pytest.approx(allowed, rel=2e-9)
    assert law(1e-6) == pytest.approx(single, rel=1e-12)
    assert law(1e7) * 1e7 == pytest.approx(hourly, rel=1e-5)


def test_flash_rise_is_the_largest_convolution_of_the_flux():
    flux, time, conductivity, density, specific = 1.7e6, 0.8, 50.0, 7800.0, 470.0
    effusivity = math.sqrt(conductivity * density * specific)

    def rise(t):
        # u = sqrt(t - s) takes away the singularity of the half-space kernel
        return quad(lambda u: 2 * flux * (1 - (t - u * u) / time), 0, math.sqrt(t))[0] / (
            effusivity * math.sqrt(math.pi)
        )

    grid = np.linspace(0.01, 1, 199) * time
    values = [rise(t) for t in grid]
    assert grid[int(np.argmax(values))] == pytest.approx(time / 2, abs=0.006 * time)
    assert heat.flash_rise(flux, time, conductivity, density, specific) == pytest.approx(rise(time / 2), rel=1e-10)


def test_allowed_work_falls_with_the_rate_and_starts_at_the_single_work():
    rates = np.array([1e-9, 0.01, 0.1, 1.0])
    allowed = heat.allowed_work_at_rate(2000.0, 0.05, rates)
    assert allowed[0] == pytest.approx(2000.0)
    assert np.all(np.diff(allowed) < 0)


def test_pack_length_is_the_plates_one_by_one():
    inner, outer, lining, gap = 2.0, 1.5, 0.4, 0.3
    for surfaces in (2, 8, 24):
        stack = inner
        for _ in range(surfaces // 2):
            stack += gap + lining + outer + lining + gap + inner
        assert plates.pack_length(surfaces, inner, outer, lining, gap) == pytest.approx(stack, rel=1e-13)


def test_annulus_mass_is_the_difference_of_two_discs():
    discs = [7850 * 3 * 0.002 * math.pi * r**2 for r in (0.11, 0.07)]
    mass = plates.annulus_mass(7850, 3, 0.002, 0.11 + 0.07, 0.11 - 0.07)
    assert mass == pytest.approx(discs[0] - discs[1], rel=1e-13)


def test_drag_torque_is_the_shear_integral():
    dm, c, eta, omega, gap = 0.2, 0.22, 0.03, 100.0, 0.2e-3
    r1, r2 = dm * (1 - c) / 2, dm * (1 + c) / 2
    one = quad(lambda r: eta * omega * r / gap * 2 * math.pi * r * r, r1, r2)[0]
    assert plates.drag_torque(12, eta, omega, dm, c, gap) == pytest.approx(12 * one, rel=1e-10)


def test_squeeze_time_follows_from_the_reynolds_equation():
    eta, force, r1, r2, h0, h1 = 0.05, 4000.0, 0.06, 0.09, 0.2e-3, 20e-6

    def speed(h):
        """Closing speed at which the film of an annulus, open at both edges, carries the force."""
        # p(r) = 3 eta v/h**3 [r1**2 - r**2 + (r2**2 - r1**2) ln(r/r1)/ln(r2/r1)], zero at both edges
        carried = quad(
            lambda r: (
                3
                * eta
                / h**3
                * (r1**2 - r**2 + (r2**2 - r1**2) * math.log(r / r1) / math.log(r2 / r1))
                * 2
                * math.pi
                * r
            ),
            r1,
            r2,
        )[0]
        return force / carried

    numeric = quad(lambda h: 1 / speed(h), h1, h0, epsrel=1e-10)[0]
    assert plates.squeeze_time(eta, force, r1, r2, h0, h1) == pytest.approx(numeric, rel=1e-7)


@pytest.mark.parametrize(("waves", "factor"), [(3, 3.88), (4, 3.88), (5, 2.9), (7, 2.3), (10, 2.13)])
def test_wave_factor_by_number_of_waves(waves, factor):
    force = plates.sine_plate_force(1e-3, 200e9, 0.01, 0.001, waves, 0.11, 0.09)
    by_hand = 1e-3 * 200e9 * 0.01 * 1e-9 * waves**4 / (factor * 0.1**3) * 0.11 / 0.09
    assert force == pytest.approx(by_hand, rel=1e-12)


def test_lug_pressure_times_flank_area_times_radius_is_the_torque():
    pressure = plates.lug_pressure(150.0, 0.08, 10, 0.003, 0.002)
    assert pressure * (10 * 0.003 * 0.002) * 0.08 == pytest.approx(150.0, rel=1e-13)


def test_cylinder():
    assert plates.cylinder_surface(0.3, 0.1) == pytest.approx(math.pi * 0.3 * 0.1 + 2 * math.pi * 0.15**2)
    assert plates.cylinder_volume(0.3, 0.1) == pytest.approx(math.pi * 0.15**2 * 0.1)
    assert plates.drum_diameter(0.12, 0.005) == pytest.approx(0.25)
