"""Formulas of the wrap spring: the worked example, the errata of the source, and derivations by other means."""

import inspect
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from synth.problems.components.wrap_spring import formulas as ws
from synth.problems.components.wrap_spring.models import MODELS

from tests.problems.formula_checks import assert_homogeneous, assert_same_on_symbols_and_arrays, name_of

A, B, E, RHO = 0.003, 0.004, 206e9, 7850.0
HUB, INTERFERENCE, COILS, MU = 0.040, 0.25e-3, 4, 0.10


def figures(model):
    """Everything of the worked example, with the formulas of one model."""
    formulas = MODELS[model]
    mean = formulas.mean_radius(HUB, A)
    curvature = ws.curvature_change(INTERFERENCE, mean, formulas.free_radius(INTERFERENCE, mean))
    moment = ws.bending_moment(E, B, A, curvature)
    beta = ws.belt_exponent(MU, COILS, formulas.radius_ratio(HUB, A))
    closing = ws.closing_torque(moment, beta)
    return {
        "M": moment,
        "p": ws.contact_pressure(moment, B, HUB / 2, mean),
        "M_z": closing,
        "M_ny exact": ws.opening_torque(moment, beta),
        "sigma_b": ws.bending_stress(moment, B, A),
        "p_max": ws.contact_pressure(moment + closing, B, HUB / 2, mean),
        "lift-off": ws.liftoff_speed(moment, RHO, B, A, mean),
        "mean": mean,
        "beta": beta,
    }


# -- the worked example ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "name", "value"),
    [
        ("seed", "M", 1.15875),
        ("seed", "p", 724219),
        ("seed", "M_z", 13.1463),
        ("seed", "M_ny exact", 1.06489),
        ("seed", "sigma_b", 1.93125e8),
        ("seed", "p_max", 8.94069e6),
        ("refined", "M", 1.01450),
        ("refined", "p", 589826),
        ("refined", "M_z", 9.49549),
        ("refined", "M_ny exact", 0.916574),
        ("refined", "sigma_b", 1.69083e8),
        ("refined", "p_max", 6.11046e6),
        ("refined", "lift-off", 1040.98),
    ],
)
def test_worked_example(model, name, value):
    assert float(figures(model)[name]) == pytest.approx(value, rel=6e-6)


@pytest.mark.parametrize("model", MODELS)
def test_every_multiple_of_one_figure_is_one(model):
    """Pressure, torques and stress hang together by M and beta alone, whatever the model."""
    f = figures(model)
    assert f["p_max"] == pytest.approx(f["p"] * math.exp(f["beta"]), rel=1e-12)
    assert f["M_ny exact"] / f["M_z"] == pytest.approx(math.exp(-f["beta"]), rel=1e-12)
    assert f["M_ny exact"] < f["M"]
    assert f["sigma_b"] == pytest.approx(f["M"] * A / (2 * ws.second_moment(B, A)), rel=1e-12)


# -- errata of the source --------------------------------------------------------------------------


def test_eq_7_axial_friction_force_lacks_mu():
    pressure = figures("seed")["p"]
    area = 2 * math.pi * HUB / 2 * B * COILS
    printed = pressure * HUB * math.pi * B * COILS
    assert printed == pytest.approx(pressure * area, rel=1e-12)  # a normal force, no friction in it
    assert ws.axial_friction_force(MU, pressure, HUB / 2, B, COILS) == pytest.approx(MU * printed, rel=1e-12)


def test_eq_11_the_sine_of_half_an_element_is_half_the_element():
    element = 1e-4
    assert math.sin(element / 2) == pytest.approx(element / 2, rel=1e-8)


def test_eq_21_drag_is_the_limit_and_is_always_high():
    f = figures("seed")
    printed = INTERFERENCE * ws.second_moment(B, A) * E / (HUB / 2) ** 2
    assert printed == pytest.approx(1.15875, rel=1e-6)
    assert printed == pytest.approx(f["M"], rel=1e-12)
    at_two_and_a_half = ws.opening_torque(1.0, 2.5)
    assert 1 / float(at_two_and_a_half) - 1 == pytest.approx(0.089, abs=5e-4)
    for beta in (0.1, 1.0, 5.0):
        assert ws.opening_torque(f["M"], beta) < printed
    assert float(ws.opening_torque(f["M"], 40.0)) == pytest.approx(printed, rel=1e-12)


def test_eq_22_peak_pressure_is_low_by_the_preload():
    f = figures("seed")
    force = f["M_z"] / (HUB / 2)  # F of the source: tension beyond the preload
    printed = force / (B * HUB / 2)
    assert printed == pytest.approx(8.21647e6, rel=1e-6)
    assert printed == pytest.approx(f["p"] * math.expm1(f["beta"]), rel=1e-12)
    assert f["p_max"] - printed == pytest.approx(f["p"], rel=1e-9)
    assert f["p_max"] == pytest.approx(8.94069e6, rel=1e-6)


def test_two_radii_cost_a_quarter_of_the_torque():
    assert figures("refined")["M_z"] / figures("seed")["M_z"] == pytest.approx(0.72, abs=5e-3)


def test_energy_route_of_the_source_gives_its_pressure():
    """(1)-(6): the work of the pressure on the interference is that of the moment on its angle."""
    r, inertia = HUB / 2, ws.second_moment(B, A)

    def difference(pressure):
        work_of_pressure = pressure * 2 * math.pi * r * B * COILS * INTERFERENCE / 2
        moment = E * inertia * INTERFERENCE / r**2
        angle = moment * 2 * math.pi * r * COILS / (E * inertia)
        return work_of_pressure - moment * angle / 2

    assert brentq(difference, 1e3, 1e8, xtol=1e-6) == pytest.approx(figures("seed")["p"], rel=1e-9)


# -- belt equation against integration -------------------------------------------------------------


def integrated_belt(moment, beta, sense, centrifugal=0.0, actuator=0.0):
    """Integrate d(N r) = +-mu (N - N_c) r_h dalpha along the wrap; return the torque through the last section."""
    found = solve_ivp(
        lambda _, tension: sense * (tension - centrifugal), (0, beta), [moment + actuator], rtol=1e-11, atol=1e-13
    )
    return float(found.y[0, -1] - moment)


@pytest.mark.parametrize(
    ("moment", "beta", "centrifugal", "actuator"),
    [(1.0145, 2.338, 0.0, 0.0), (1.0145, 2.338, 0.4, 0.0), (3.0, 6.0, 1.0, 2.0), (-0.6, 3.0, 0.0, 1.1)],
)
def test_closing_torque_is_the_integral_of_the_belt_equation(moment, beta, centrifugal, actuator):
    wanted = integrated_belt(moment, beta, +1, centrifugal, actuator)
    assert float(ws.closing_torque(moment - centrifugal, beta, actuator)) == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize(("moment", "beta", "centrifugal"), [(1.0145, 2.338, 0.0), (1.0145, 0.7, 0.5), (2.0, 9.0, 0.1)])
def test_opening_torque_is_the_integral_of_the_belt_equation(moment, beta, centrifugal):
    wanted = -integrated_belt(moment, beta, -1, centrifugal)
    assert float(ws.opening_torque(moment - centrifugal, beta)) == pytest.approx(wanted, rel=1e-8)


def test_radii_enter_the_belt_equation_as_their_ratio():
    """Friction mu p b r_h dalpha acts at the hub, the tension at the mean radius: d(N r_m) = mu N r_h dalpha."""
    hub, mean = HUB / 2, ws.mean_radius(HUB, A)
    found = solve_ivp(
        lambda _, tension: MU * (tension / (B * hub)) * B * hub * hub / mean,
        (0, 2 * math.pi * COILS),
        [1.0145 / mean],
        rtol=1e-11,
    )
    torque = float(found.y[0, -1]) * mean - 1.0145
    beta = ws.belt_exponent(MU, COILS, ws.radius_ratio(HUB, A))
    assert torque == pytest.approx(float(ws.closing_torque(1.0145, beta)), rel=1e-8)


def test_windup_is_the_elongation_of_the_wire():
    torque, moment, friction, mean, gap = 5.0, 1.0145, 0.093, 0.0215, 0.5
    stiffness = E * A * B
    arc = float(ws.slip_arc(torque, moment, friction))
    loaded, preload = (moment + torque) / mean, moment / mean
    excess, _ = quad(lambda s: loaded * math.exp(-friction * s) - preload, 0, arc)
    elongation = 2 * excess * mean / stiffness + (loaded - preload) * 2 * math.pi * gap * mean / stiffness
    angle = float(ws.windup_angle(torque, moment, friction, mean, stiffness, gap))
    assert angle == pytest.approx(elongation / mean, rel=1e-9)
    assert loaded * math.exp(-friction * arc) == pytest.approx(preload, rel=1e-12)


def test_windup_begins_like_the_torque_squared_without_a_gap():
    angles = [float(ws.windup_angle(t, 1.0, 0.1, 0.02, 1e6, 0.0)) for t in (1e-3, 2e-3)]
    assert angles[1] / angles[0] == pytest.approx(4, rel=2e-3)


def test_closing_a_clearance_keeps_the_length_of_the_wire():
    coils, clearance, mean = 4.5, 0.3e-3, 0.0215
    closed_coils = coils * (mean + clearance) / mean  # the same length on the smaller radius
    turned = 2 * math.pi * (closed_coils - coils)
    assert ws.wrap_angle(coils, clearance, mean) == pytest.approx(turned, rel=1e-12)


def test_the_hub_carries_its_torque_as_a_tube():
    d, bore, torque = 0.04, 0.025, 100.0
    polar, _ = quad(lambda r: 2 * math.pi * r**3, bore / 2, d / 2)
    assert ws.hub_shear_stress(torque, d, bore) == pytest.approx(torque * d / 2 / polar, rel=1e-9)


def test_engagement_peak_is_that_of_a_swing():
    inertia, stiffness, speed = 2e-4, 3000.0, 40.0
    found = solve_ivp(
        lambda _, y: [y[1], -stiffness / inertia * y[0]], (0, 2e-3), [0.0, speed], rtol=1e-10, max_step=1e-6
    )
    peak = stiffness * float(np.max(found.y[0]))
    assert float(ws.engagement_peak_torque(speed, inertia, stiffness)) == pytest.approx(peak, rel=1e-5)


# -- tip, curvature, exact bar ---------------------------------------------------------------------


def test_tip_of_the_free_end_by_the_curved_beam():
    """A beam on a rigid cylinder, touching at the tip and from an arc psi on: no gap at both and no slope at psi."""

    def at_lift_off(psi):
        """Gap at the tip when the beam leaves the hub smoothly at psi, the tip force such that the moment is steady."""
        tip = 1 / math.sin(psi)  # tip force over M/r: its moment at psi is that of the fitted wire
        found = solve_ivp(
            lambda s, u: [u[1], -u[0] - (tip * math.sin(psi - s) - 1)], (0, psi), [0.0, 0.0], rtol=1e-12, atol=1e-14
        )
        return float(found.y[0, -1])

    psi = brentq(at_lift_off, 1.9, 2.4, xtol=1e-12)
    assert psi == pytest.approx(ws.TIP_ARC, abs=1e-8)
    assert math.degrees(psi) == pytest.approx(122.57, abs=5e-3)
    assert psi / 2 + math.sin(2 * psi) / 4 - math.sin(psi) == pytest.approx(0, abs=1e-9)
    tip, lift_off = 1 / math.sin(psi), -math.cos(psi) / math.sin(psi)
    assert tip == pytest.approx(1.18656, abs=6e-6)
    assert lift_off == pytest.approx(0.63869, abs=6e-6)
    assert tip + lift_off == pytest.approx(1.8253, abs=6e-5)
    assert ws.tip_coil_loss() == pytest.approx((psi - tip - lift_off) / (2 * math.pi), rel=1e-8)


def test_curved_bar_factor_against_the_exact_bar():
    """Winkler-Bach: the neutral axis of a rectangular bar lies at a/ln(ro/ri)."""
    index = 8.0
    inner, outer = index / 2 - 0.5, index / 2 + 0.5  # thickness 1
    neutral = 1 / math.log(outer / inner)
    exact = (neutral - inner) / (1 * (index / 2 - neutral) * inner) / 6
    assert exact == pytest.approx(1.09046, abs=6e-6)
    assert ws.curved_bar_factor(index) == pytest.approx(1.09048, abs=6e-6)


def test_keystone_growth_is_the_cross_strain_of_the_inner_fibre():
    strain = A / 2 / 0.0215
    assert ws.keystone_growth(0.3, B, A, 0.0215) == pytest.approx(0.3 * strain * B, rel=1e-12)


# -- limits and inverses ---------------------------------------------------------------------------


@given(st.floats(0.01, 8), st.floats(0.1, 50), st.floats(-5, 5))
def test_energising_torque_is_the_inverse_of_the_closing_torque(beta, torque, moment):
    actuator = ws.actuator_torque_for(torque, moment, beta)
    assert float(ws.closing_torque(moment, beta, actuator)) == pytest.approx(torque, rel=1e-9, abs=1e-9)


@given(st.floats(1e-6, 3e-3), st.floats(0.004, 0.1))
@pytest.mark.parametrize("model", MODELS)
def test_interference_is_the_inverse_of_the_curvature(model, interference, mean):
    formulas = MODELS[model]
    curvature = ws.curvature_change(interference, mean, formulas.free_radius(interference, mean))
    assert formulas.interference_for(curvature, mean) == pytest.approx(interference, rel=1e-9)
    if model == "refined":
        assert curvature == pytest.approx(1 / (mean - interference) - 1 / mean, rel=1e-6)


@given(st.floats(1e-5, 1e-3), st.floats(1e-6, 2e-4), st.floats(0.004, 0.1))
@pytest.mark.parametrize("model", MODELS)
def test_tightened_moment_is_that_of_the_larger_interference(model, interference, growth, mean):
    free_radius = MODELS[model].free_radius

    def moment(dr):
        return ws.bending_moment(E, B, A, ws.curvature_change(dr, mean, free_radius(dr, mean)))

    radii = [free_radius(dr, mean) for dr in (interference, interference + growth)]
    tightened = ws.tightened_moment(moment(interference), interference, growth, *radii)
    assert tightened == pytest.approx(moment(interference + growth), rel=1e-9)


@given(st.floats(1e-12, 1e-7))
def test_small_friction_loses_no_digits(beta):
    assert float(ws.closing_torque(2.0, beta, 1.0)) - 1 == pytest.approx(3 * beta, rel=1e-6, abs=1e-15)
    assert float(ws.opening_torque(2.0, beta)) == pytest.approx(2 * beta, rel=1e-6)


def test_a_locked_clutch_has_a_finite_torque():
    assert float(ws.closing_torque(1.0, 900.0)) == float(ws.closing_torque(1.0, ws.LOCKED_BELT_EXPONENT))


# -- units, symbols, arrays ------------------------------------------------------------------------

BELT = {"moment": "N m", "belt_exponent": "-"}
WIRE = {"width": "m", "thickness": "m"}
CASES = [
    *((m.mean_radius, {"hub_diameter": "m", "thickness": "m"}, "m") for m in MODELS.values()),
    (ws.radius_ratio, {"hub_diameter": "m", "thickness": "m"}, "-"),
    (ws.second_moment, WIRE, "m4"),
    (ws.total_coils, {"coils_per_hub": "-", "gap_coils": "-", "fixed_coils": "-"}, "-"),
    (ws.spring_length, {"coils": "-", "width": "m", "coil_gap": "m"}, "m"),
    (ws.spring_mass, {"density": "kg/m3", **WIRE, "mean_radius": "m", "coils": "-"}, "kg"),
    (ws.hub_mass, {"density": "kg/m3", "hub_diameter": "m", "bore_diameter": "m", "length": "m"}, "kg"),
    *((m.free_radius, {"interference": "m", "mean_radius": "m"}, "m") for m in MODELS.values()),
    (ws.curvature_change, {"interference": "m", "mean_radius": "m", "free_radius": "m"}, "1/m"),
    *((m.interference_for, {"curvature": "1/m", "mean_radius": "m"}, "m") for m in MODELS.values()),
    (ws.bending_moment, {"elastic_modulus": "Pa", **WIRE, "curvature": "1/m"}, "N m"),
    (
        ws.tightened_moment,
        {"moment": "N m", "interference": "m", "growth": "m", "free_radius": "m", "tightened_radius": "m"},
        "N m",
    ),
    (ws.bending_stress, {"moment": "N m", **WIRE}, "Pa"),
    (ws.contact_pressure, {"moment": "N m", "width": "m", "hub_radius": "m", "mean_radius": "m"}, "Pa"),
    (ws.axial_friction_force, {"mu": "-", "pressure": "Pa", "hub_radius": "m", "width": "m", "coils": "-"}, "N"),
    (ws.belt_exponent, {"mu": "-", "coils": "-", "radius_ratio": "-"}, "-"),
    (ws.centrifugal_moment, {"density": "kg/m3", **WIRE, "mean_radius": "m", "speed": "1/s"}, "N m"),
    (ws.liftoff_speed, {"moment": "N m", "density": "kg/m3", **WIRE, "mean_radius": "m"}, "1/s"),
    (ws.closing_torque, {**BELT, "actuator_torque": "N m"}, "N m"),
    (ws.opening_torque, BELT, "N m"),
    (ws.actuator_torque_for, {"torque": "N m", **BELT}, "N m"),
    (ws.wire_tension, {"moment": "N m", "mean_radius": "m"}, "N"),
    (ws.wire_stress, {"bending_stress": "Pa", "tension": "N", **WIRE}, "Pa"),
    (
        ws.goodman_utilisation,
        {
            "safety": "-",
            "least_stress": "Pa",
            "largest_stress": "Pa",
            "endurance_amplitude": "Pa",
            "tensile_strength": "Pa",
        },
        "-",
    ),
    (ws.slip_arc, {"torque": "N m", "moment": "N m", "friction": "-"}, "-"),
    (
        ws.windup_angle,
        {
            "torque": "N m",
            "moment": "N m",
            "friction": "-",
            "mean_radius": "m",
            "wire_stiffness": "N",
            "gap_coils": "-",
        },
        "-",
    ),
    (ws.wrap_angle, {"coils": "-", "clearance": "m", "mean_radius": "m"}, "-"),
    (ws.engagement_peak_torque, {"speed_difference": "1/s", "inertia": "kg m2", "stiffness": "N m"}, "N m"),
    (ws.hub_shear_stress, {"torque": "N m", "hub_diameter": "m", "bore_diameter": "m"}, "Pa"),
    (ws.collar_mass, {"density": "kg/m3", "spring_diameter": "m", "clearance": "m", "wall": "m", "length": "m"}, "kg"),
    (ws.collar_diameter, {"spring_diameter": "m", "clearance": "m", "wall": "m"}, "m"),
    (ws.tang_stress, {"actuator_torque": "N m", "mean_radius": "m", "thickness": "m", "length_ratio": "-"}, "Pa"),
    (ws.overrun_life, {"depth": "m", "wear_rate": "m3/J", "friction": "-", "rubbing": "W/m2", "duty": "-"}, "s"),
    (ws.overrun_pv, {"pressure": "Pa", "speed": "1/s", "hub_radius": "m"}, "W/m2"),
    (
        ws.overrun_temperature_rise,
        {
            "torque": "N m",
            "speed": "1/s",
            "duty": "-",
            "heat_transfer": "W/(m2 K)",
            "outer_diameter": "m",
            "length": "m",
        },
        "K",
    ),
    (ws.curved_bar_factor, {"spring_index": "-"}, "-"),
    (ws.keystone_growth, {"poisson_ratio": "-", **WIRE, "mean_radius": "m"}, "m"),
]
RANGES = {"interference": (0.01, 0.4), "bore_diameter": (0.2, 0.4), "spring_index": (4, 12)}
NO_FORMULA_OF_ARGUMENTS = {"tip_coil_loss"}


IDS = [f"{number}-{name_of(case[0])}" for number, case in enumerate(CASES)]


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_scales_as_its_unit(function, units, result_unit):
    assert_homogeneous(function, units, result_unit, RANGES)


@pytest.mark.parametrize(("function", "units", "result_unit"), CASES, ids=IDS)
def test_floats_arrays_and_symbols_agree(function, units, result_unit):
    assert_same_on_symbols_and_arrays(function, units, RANGES)


def test_no_formula_is_left_out():
    public = {
        name
        for name, member in inspect.getmembers(ws, inspect.isfunction)
        if member.__module__ == ws.__name__ and not name.startswith("_")
    }
    assert public == {name_of(case[0]) for case in CASES} | NO_FORMULA_OF_ARGUMENTS
