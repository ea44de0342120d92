"""Start-up in closed form, against integration of the equations of motion."""

from dataclasses import fields
from functools import cache

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from synth.problems.mechanics import startup

from synth.errors import InputError

ca.GlobalOptions.setNumpyMode(-1)
QUICK = settings(deadline=None, derandomize=True, max_examples=80)
PER_REGIME = 25

torques = st.floats(1.02, 8.0)
positive = st.floats(0.05, 20.0)
kinds = st.sampled_from(startup.LOAD_KINDS)


def integrate(torque, load, inertia, speed, ramp, kind):
    """Slip until lock-up; the state is driven speed and angle, friction work, integral of M2 (omega1 - omega2)."""

    def clutch(t):
        return torque * min(t / ramp, 1.0)

    def resisting(t):
        return load if kind == "active" else min(clutch(t), load)

    def motion(t, y):
        slip = speed - y[0]
        return [(clutch(t) - resisting(t)) / inertia, y[0], clutch(t) * slip, resisting(t) * slip]

    def lock(t, y):
        return speed - y[0]

    lock.terminal = True
    start, state, peak, lowest = 0.0, [0.0, 0.0, 0.0, 0.0], 0.0, 0.0
    # Generous end: a slip of constant torque from the end of the ramp on, however far the load has run backwards.
    last = ramp + 2 * (inertia * speed + torque * ramp) / (torque - load)
    for end in (load * ramp / torque, ramp, last):
        if end <= start:
            continue
        piece = solve_ivp(
            motion, (start, end), state, method="DOP853", rtol=1e-12, atol=1e-13, events=lock, dense_output=True
        )
        stop = piece.t[-1]
        best = minimize_scalar(
            lambda t, y=piece.sol: -clutch(t) * (speed - y(t)[0]),
            bounds=(start, stop),
            method="bounded",
            options={"xatol": 1e-12},
        )
        ends = [clutch(t) * (speed - y0) for t, y0 in ((start, piece.y[0, 0]), (stop, piece.y[0, -1]))]
        peak, lowest = max(peak, -best.fun, *ends), min(lowest, piece.y[0].min())
        start, state = stop, piece.y[:, -1]
        if piece.status == 1:
            break
    return {
        "time": start,
        "angle": state[1],
        "work": state[2],
        "resisting": state[3],
        "peak": peak,
        "lowest": lowest,
        "torque": clutch(start),
    }


@cache
def cases():
    """Random inputs, the same number in each regime of lock-up and of peak power, for both kinds of load."""
    rng = np.random.default_rng(7)
    wanted = {
        (kind, after, inside): PER_REGIME
        for kind in startup.LOAD_KINDS
        for after, inside in ((True, False), (True, True), (False, True))
    }
    found = []
    while any(wanted.values()):
        torque = np.exp(rng.uniform(0, 7))
        load = 0.0 if rng.random() < 0.05 else torque * rng.uniform(0.03, 0.97)
        inertia, speed, ramp = np.exp(rng.uniform(-3, 5)), np.exp(rng.uniform(0, 5)), np.exp(rng.uniform(-3, 3))
        for kind in startup.LOAD_KINDS:
            after = bool(startup.locks_after_ramp(torque, load, inertia, speed, ramp, kind))
            backward = startup.lowest_driven_speed(torque, load, inertia, ramp) if kind == "active" else 0.0
            inside = 2 * torque * inertia * (speed - backward) < ramp * (torque - load) * (3 * torque - load)
            if wanted.get((kind, after, inside), 0) > 0:
                wanted[kind, after, inside] -= 1
                found.append((torque, load, inertia, speed, ramp, kind))
    return found


@pytest.mark.slow
def test_closed_forms_against_integration():
    for case in cases():
        expected = integrate(*case)
        torque, load, inertia, speed, ramp, kind = case
        assert float(startup.slip_time(*case)) == pytest.approx(expected["time"], rel=1e-8), case
        assert float(startup.friction_work(*case)) == pytest.approx(expected["work"], rel=1e-8), case
        assert float(startup.peak_slip_power(*case)) == pytest.approx(expected["peak"], rel=1e-8), case
        assert float(startup.lock_torque(*case)) == pytest.approx(expected["torque"], rel=1e-8), case
        if kind == "active":
            lowest = startup.lowest_driven_speed(torque, load, inertia, ramp)
            assert lowest == pytest.approx(expected["lowest"], rel=1e-8, abs=1e-9), case
        # the identity holds for the integration too, so that a wrong identity cannot hide a wrong formula
        assert expected["work"] == pytest.approx(inertia * speed**2 / 2 + expected["resisting"], rel=1e-8), case


@pytest.mark.slow
def test_phases_against_integration():
    for case in cases():
        expected = integrate(*case)
        _, load, inertia, speed, _, _ = case
        phases = startup.startup_phases(*case)
        assert float(phases.lock_time) == pytest.approx(expected["time"], rel=1e-8), case
        angle_scale = max(abs(expected["angle"]), speed * expected["time"])
        assert float(phases.load_work_d) == pytest.approx(
            load * expected["angle"], rel=1e-8, abs=1e-9 * load * angle_scale
        )
        assert float(phases.friction_work) == pytest.approx(expected["work"], rel=1e-7), case
        driver = float(phases.driver_work_d)
        assert driver == pytest.approx(
            float(phases.load_work_d) + inertia * speed**2 / 2 + expected["work"], rel=1e-7
        ), case


@QUICK
@given(torques, positive, positive, positive, positive, kinds)
def test_energy_identity(ratio, load, inertia, speed, ramp, kind):
    """W = J omega1**2/2 + integral of M2 (omega1 - omega2) dt."""
    case = (ratio * load, load, inertia, speed, ramp, kind)
    phases = startup.startup_phases(*case)
    time, time_b = float(phases.lock_time), float(phases.duration_1)
    impulse = load * time if kind == "active" else load * time_b / 2 + load * (time - time_b)
    resisting = speed * impulse - float(phases.load_work_d)
    energy = inertia * speed**2 / 2
    work = float(startup.friction_work(*case))
    assert work == pytest.approx(energy + resisting, rel=1e-9)
    assert work >= energy * (1 - 1e-12)
    assert float(phases.driver_power_d) == pytest.approx(
        float(phases.load_power_d) + float(phases.kinetic_power_d), rel=1e-12
    )


@QUICK
@given(torques, positive, positive, positive, kinds)
def test_regimes_agree_on_their_border(ratio, load, inertia, speed, kind):
    torque = ratio * load
    if kind == "active" and torque <= 2.1 * load:
        torque = 2.1 * load + torque
    border = (
        2 * inertia * speed / (torque - 2 * load)
        if kind == "active"
        else 2 * inertia * torque * speed / (torque - load) ** 2
    )
    for function in (startup.slip_time, startup.friction_work, startup.peak_slip_power, startup.lock_torque):
        before, behind = (
            float(function(torque, load, inertia, speed, border * (1 + step), kind)) for step in (-1e-9, 1e-9)
        )
        assert before == pytest.approx(behind, rel=1e-6)
    assert startup.locks_after_ramp(torque, load, inertia, speed, border * (1 - 1e-9), kind)
    assert not startup.locks_after_ramp(torque, load, inertia, speed, border * (1 + 1e-9), kind)


@QUICK
@given(torques, positive, positive, positive, st.floats(0.0, 20.0))
def test_monotone_in_every_argument(ratio, load, inertia, speed, ramp):
    base = {
        "torque": ratio * load,
        "load_torque": load,
        "driven_inertia": inertia,
        "driver_speed": speed,
        "ramp_time": ramp,
    }
    for function in (startup.slip_time, startup.friction_work):
        value = float(function(**base))
        assert float(function(**base | {"torque": ratio * load * 1.05})) <= value * (1 + 1e-12)
        for name in ("driven_inertia", "driver_speed", "ramp_time"):
            assert float(function(**base | {name: base[name] * 1.05})) >= value * (1 - 1e-12)
        more_load = load + 0.1 * (ratio - 1) * load
        assert float(function(**base | {"load_torque": more_load})) >= value * (1 - 1e-12)


@QUICK
@given(torques, positive, positive, positive, kinds)
def test_step_is_the_limit_of_a_short_ramp(ratio, load, inertia, speed, kind):
    torque = ratio * load
    time, work = inertia * speed / (torque - load), inertia * speed**2 / 2 * torque / (torque - load)
    assert float(startup.slip_time(torque, load, inertia, speed, 0.0, kind)) == pytest.approx(time, rel=1e-12)
    assert float(startup.friction_work(torque, load, inertia, speed, 0.0, kind)) == pytest.approx(work, rel=1e-12)
    ramp = 1e-9 * time
    assert float(startup.peak_slip_power(torque, load, inertia, speed, ramp, kind)) == pytest.approx(
        torque * speed, rel=1e-6
    )


@QUICK
@given(positive, positive, positive, positive, kinds)
def test_inertia_alone_costs_its_own_energy_for_every_ramp(torque, inertia, speed, ramp, kind):
    assert float(startup.friction_work(torque, 0.0, inertia, speed, ramp, kind)) == pytest.approx(
        inertia * speed**2 / 2, rel=1e-12
    )


@QUICK
@given(torques, positive, positive, positive, positive)
def test_active_load_costs_more_than_a_reactive_one(ratio, load, inertia, speed, ramp):
    case = (ratio * load, load, inertia, speed, ramp)
    for function in (startup.slip_time, startup.friction_work, startup.peak_slip_power):
        assert float(function(*case, "active")) >= float(function(*case)) * (1 - 1e-12)


def test_work_of_a_reactive_start_grows_without_bound_towards_the_load_torque():
    works = [float(startup.friction_work(600 * (1 + e), 600, 30, 26.6, 2)) for e in (1e-1, 1e-3, 1e-5)]
    assert works[0] < works[1] / 50
    assert works[1] < works[2] / 50


def test_both_sides_of_every_branch_are_finite():
    """The search evaluates gradients on both sides of a branch; neither may be infinite or undefined."""
    names = ("torque", "load_torque", "driven_inertia", "driver_speed", "ramp_time")
    symbols = [ca.SX.sym(name) for name in names]
    for kind in startup.LOAD_KINDS:
        values = ca.vertcat(
            *(
                function(*symbols, kind)
                for function in (startup.slip_time, startup.friction_work, startup.peak_slip_power, startup.lock_torque)
            )
        )
        both = ca.Function("both", symbols, [values, ca.jacobian(values, ca.vertcat(*symbols))])
        for case in cases():
            for output in both(*case[:5]):
                assert np.all(np.isfinite(output.full())), case


def test_phases_on_symbols_and_arrays():
    case = (np.array([1080.0, 1080.0]), 600.0, np.array([30.0, 5.0]), 26.6, 2.0)
    for kind in startup.LOAD_KINDS:
        batch = startup.startup_phases(*case, kind)
        symbols = [ca.SX.sym(name) for name in "TLJwt"]
        traced = startup.startup_phases(*symbols, kind)
        names = [f.name for f in fields(traced)]
        compiled = ca.Function("phases", symbols, [ca.vertcat(*(getattr(traced, name) for name in names))])
        for k in range(2):
            point = [float(np.broadcast_to(c, 2)[k]) for c in case]
            single = startup.startup_phases(*point, kind)
            expected = [float(getattr(single, name)) for name in names]
            np.testing.assert_allclose(compiled(*point).full().ravel(), expected, rtol=1e-13)
            in_batch = [float(np.broadcast_to(getattr(batch, name), 2)[k]) for name in names]
            np.testing.assert_allclose(in_batch, expected, rtol=1e-13)


def test_two_finite_inertias_share_the_slip():
    # a very heavy driver is a driver of constant speed: the step of the closed form
    time, work = startup.constant_torque_slip(26.6, 1080, 0, 600, 1e15, 30)
    assert time == pytest.approx(float(startup.slip_time(1080, 600, 30, 26.6, 0.0)), rel=1e-9)
    assert work == pytest.approx(float(startup.friction_work(1080, 600, 30, 26.6, 0.0)), rel=1e-9)
    _, free = startup.constant_torque_slip(12.0, 75.0, 0, 0, 2.0, 6.0)
    assert free == pytest.approx(0.5 * 2 * 6 / 8 * 12**2, rel=1e-13)


def test_unknown_kind_of_load_is_refused():
    for function in (startup.slip_time, startup.friction_work, startup.peak_slip_power, startup.startup_phases):
        with pytest.raises(InputError, match="load_kind: got 'passive'; expected reactive or active"):
            function(1080, 600, 30, 26.6, 2, "passive")
