"""The start-up integrated in time: against closed forms, a plain integration of one's own, and its energy."""

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synth.problems.mechanics import heat, motors, startup
from synth.problems.mechanics.startup_simulation import StartupRun, simulate_startup, simulate_switching

from synth.errors import InputError

QUICK = settings(deadline=None, derandomize=True, max_examples=25)
LECTURE = (1080.0, 600.0, 30.0, 26.6, 2.0)
S1_MOTOR = {"synchronous_speed": 26.6 / 0.985, "breakdown_torque": 3000.0, "breakdown_slip": 0.15}


def names(run: StartupRun) -> list[str]:
    return [event.name for event in run.events]


def energy_error(run: StartupRun) -> float:
    """Driver work less load work, kinetic and friction work, over the largest of them."""
    parts = (run.driver_work, run.load_work, run.kinetic_work, run.friction_work)
    return (parts[0] - parts[1] - parts[2] - parts[3]) / max(max(abs(x) for x in parts), 1e-300)


def random_cases(count):
    rng = np.random.default_rng(11)
    for _ in range(count):
        torque = np.exp(rng.uniform(0, 7))
        load = 0.0 if rng.random() < 0.1 else torque * rng.uniform(0.03, 0.95)
        ramp = 0.0 if rng.random() < 0.1 else np.exp(rng.uniform(-3, 3))
        yield torque, load, np.exp(rng.uniform(-3, 5)), np.exp(rng.uniform(0, 5)), ramp


# ---- constant driver speed: the closed forms ------------------------------------------------------------------------


def test_the_lecture():
    run = simulate_startup(*LECTURE)
    phases = startup.startup_phases(*LECTURE)
    assert run.outcome == "locked"
    assert run.slip_time == pytest.approx(3.21806, abs=5e-6)
    assert run.friction_work == pytest.approx(39524.1, abs=0.05)
    assert run.peak_slip_power == pytest.approx(21703.7, abs=0.05)
    assert run.greatest_acceleration == pytest.approx(16.0)
    assert [(e.name, e.time) for e in run.events] == [
        ("load starts", pytest.approx(float(phases.duration_1))),
        ("ramp ends", 2.0),
        ("lock-up", pytest.approx(float(phases.lock_time))),
    ]
    frame = run.frame()
    at_c = frame[frame["time [s]"] == 2.0].iloc[0]
    for column, value in (
        ("driver_work [J]", 28728.0),
        ("load_work [J]", 1264.20),
        ("kinetic_work [J]", 758.519),
        ("driver_power [W]", 28728.0),
        ("load_power [W]", 4266.67),
        ("kinetic_power [W]", 3413.33),
        ("driven_acceleration [rad/s2]", 16.0),
        ("driven_speed [1/min]", 7.11111 * 30 / math.pi),
    ):
        assert at_c[column] == pytest.approx(value, rel=1e-5), column


@pytest.mark.slow
@pytest.mark.parametrize("kind", startup.LOAD_KINDS)
def test_closed_forms_against_simulation_on_random_inputs(kind):
    inside, after = 0, 0
    for case in random_cases(60):
        torque, load, inertia, speed, ramp = case
        run = simulate_startup(*case, kind)
        assert run.outcome == "locked", case
        assert run.slip_time == pytest.approx(float(startup.slip_time(*case, kind)), rel=1e-8), case
        assert run.friction_work == pytest.approx(float(startup.friction_work(*case, kind)), rel=1e-8), case
        assert abs(energy_error(run)) < 1e-9, case
        if ramp == 0:
            assert run.peak_slip_power == pytest.approx(torque * speed), case
            continue
        assert run.peak_slip_power == pytest.approx(float(startup.peak_slip_power(*case, kind)), rel=1e-7), case
        greatest = (float(startup.lock_torque(*case, kind)) - load) / inertia
        assert run.greatest_acceleration == pytest.approx(greatest, rel=1e-7), case
        if kind == "active":
            lowest = startup.lowest_driven_speed(torque, load, inertia, ramp)
            assert run.lowest_driven_speed == pytest.approx(lowest, rel=1e-7, abs=1e-9 * speed), case
        if startup.locks_after_ramp(*case, kind):
            after += 1
            assert names(run)[-2:] == ["ramp ends", "lock-up"], case
        else:
            inside += 1
            assert "ramp ends" not in names(run)[: names(run).index("lock-up")], case
    assert min(inside, after) > 5  # both regimes were met


@QUICK
@given(
    st.floats(0.1, 10), st.floats(0.1, 10), st.floats(0.1, 10), st.floats(0.0, 5), st.sampled_from(["linear", "smooth"])
)
def test_inertia_alone_costs_its_own_energy_whatever_the_ramp(torque, inertia, speed, ramp_time, ramp):
    run = simulate_startup(torque, 0.0, inertia, speed, ramp_time, "inertia", ramp=ramp)
    assert run.outcome == "locked"
    assert run.friction_work == pytest.approx(inertia * speed**2 / 2, rel=1e-8)
    assert "load starts" not in names(run)


def test_a_clutch_that_never_starts_slips_at_full_power():
    run = simulate_startup(1080, 1200, 30, 26.6, 2, time_limit=12)
    assert run.outcome == "slipping"
    assert names(run) == ["ramp ends"]
    assert math.isnan(run.slip_time)
    assert run.friction_work == pytest.approx(1080 * 26.6 * 11)
    assert run.peak_slip_power == pytest.approx(1080 * 26.6)
    assert run.end == 12
    assert all(math.isnan(run.quantities()[name]) for name in ("slip_time", "friction_work"))
    # exactly the load torque is not enough either, and the integration comes to an end
    assert simulate_startup(600, 600, 30, 26.6, 2).outcome == "slipping"


# ---- any ramp -------------------------------------------------------------------------------------------------------


def plain_integration(case, ramp, driver_inertia=math.inf, driver=None, steps=200_000):
    """Small equal steps of the midpoint rule, without events; the reactive load is held by hand."""
    torque, load, inertia, first, ramp_time = case
    limit = 3 * (ramp_time + inertia * first / (torque - load))
    step = limit / steps
    speed_1, speed_2, work, time = first, 0.0, 0.0, 0.0

    def rates(now, a, b):
        clutch = torque * (ramp(now / ramp_time) if now < ramp_time else 1.0)
        held = b <= 0 and clutch <= load
        return (
            0.0 if driver is None else (driver(a) - clutch) / driver_inertia,
            0.0 if held else (clutch - load) / inertia,
            clutch * (a - b),
        )

    while speed_2 < speed_1 and time < limit:
        one = rates(time, speed_1, speed_2)
        half = rates(time + step / 2, speed_1 + step / 2 * one[0], speed_2 + step / 2 * one[1])
        speed_1, speed_2, work = speed_1 + step * half[0], speed_2 + step * half[1], work + step * half[2]
        time += step
    return time, work, speed_1


@pytest.mark.parametrize(
    ("ramp", "course"),
    [
        ("smooth", lambda x: (1 - math.cos(math.pi * x)) / 2),
        (((0, 0.1), (0.4, 0.2), (1, 1)), lambda x: float(np.interp(x, [0, 0.4, 1], [0.1, 0.2, 1]))),
        (lambda x: x**2, lambda x: x**2),
    ],
)
def test_any_ramp_against_a_plain_integration(ramp, course):
    run = simulate_startup(*LECTURE, ramp=ramp)
    time, work, _ = plain_integration(LECTURE, course, steps=40_000)
    assert run.slip_time == pytest.approx(time, abs=5e-4)
    assert run.friction_work == pytest.approx(work, rel=1e-5)
    assert abs(energy_error(run)) < 1e-9


def test_a_ramp_of_corners_on_a_line_is_the_linear_one():
    straight = simulate_startup(*LECTURE)
    cornered = simulate_startup(*LECTURE, ramp=((0, 0), (0.3, 0.3), (0.6, 0.6), (1, 1)))
    assert cornered.friction_work == pytest.approx(straight.friction_work, rel=1e-10)
    assert cornered.slip_time == pytest.approx(straight.slip_time, rel=1e-10)
    assert names(cornered) == names(straight)


def test_torque_that_falls_away_loses_lock_and_load_and_finds_both_again():
    # After lock-up the torque falls to a tenth, the load comes to rest, and the torque returns.
    ramp = ((0, 0), (0.1, 1), (0.4, 1), (0.45, 0.1), (0.8, 0.1), (0.9, 1), (1, 1))
    run = simulate_startup(1080, 600, 3, 26.6, 20, ramp=ramp, hold_time=20)
    assert names(run) == ["load starts", "lock-up", "slips again", "load stops", "load starts", "lock-up", "ramp ends"]
    assert run.outcome == "locked"
    assert abs(energy_error(run)) < 1e-9
    again = next(event.time for event in run.events if event.name == "slips again")
    assert 1080 * np.interp(again / 20, *np.transpose(ramp)) == pytest.approx(600)
    assert [name for _, _, name in run.phases()][:4] == ["load at rest", "ramp", "locked", "slips again"]
    # Static friction holds on longer.
    stronger = simulate_startup(1080, 600, 3, 26.6, 20, ramp=ramp, hold_time=20, static_ratio=1.5)
    later = next(event.time for event in stronger.events if event.name == "slips again")
    assert 1080 * 1.5 * np.interp(later / 20, *np.transpose(ramp)) == pytest.approx(600)


# ---- a driver of finite inertia -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("inertia", "work", "speed"), [(1e6, 39524.1, 26.6), (30.0, 38979.4, 26.2506)])
def test_kloss_motor_on_the_data_of_the_lecture(inertia, work, speed):
    motor = partial(motors.kloss_torque, **S1_MOTOR)
    run = simulate_startup(*LECTURE, driver_inertia=inertia, driver_torque=motor)
    assert run.friction_work == pytest.approx(work, abs=0.05)
    assert run.lock_speed == pytest.approx(speed, abs=6e-4)
    assert run.keeps_load
    assert abs(energy_error(run)) < 1e-8


def test_a_motor_against_a_plain_integration():
    motor = partial(motors.kloss_torque, synchronous_speed=27.0, breakdown_torque=1500.0, breakdown_slip=0.2)
    run = simulate_startup(*LECTURE, driver_inertia=8.0, driver_torque=motor)
    time, work, speed = plain_integration(LECTURE, lambda x: x, 8.0, motor, steps=40_000)
    assert run.slip_time == pytest.approx(time, abs=5e-4)
    assert run.friction_work == pytest.approx(work, rel=1e-5)
    assert run.lock_speed == pytest.approx(speed, rel=1e-4)


@QUICK
@given(st.floats(1.1, 4), st.floats(0, 0.9), st.floats(0.2, 5), st.floats(0.2, 5), st.floats(0, 1), st.floats(1, 20))
def test_two_finite_inertias_under_constant_torques(torque, load, first, second, driver, speed):
    """The step engagement has a closed form; it holds as long as the driver keeps turning, and it does."""
    time, work = startup.constant_torque_slip(speed, torque, driver, load, first, second)
    if speed - (torque - driver) / first * time <= 0:
        return
    run = simulate_startup(torque, load, second, speed, 0.0, driver_inertia=first, driver_torque=driver)
    assert run.slip_time == pytest.approx(time, rel=1e-7)
    work_until_lock = run.pieces[-1 if run.pieces[-1].mode.slip else 0].state(run.slip_time)[4]
    assert work_until_lock == pytest.approx(work, rel=1e-7)


def test_a_run_that_is_not_to_go_on_ends_with_lock_up():
    full, short = simulate_startup(*LECTURE), simulate_startup(*LECTURE, hold_time=0)
    assert short.end == short.slip_time == full.slip_time
    assert short.friction_work == pytest.approx(full.friction_work, rel=1e-12)
    assert {name for _, _, name in short.phases()} == {"load at rest", "ramp", "full torque"}
    assert simulate_switching(short, 50 / 3600, 2400, 150, 0.2).peak_rise == pytest.approx(27.2241, abs=1e-4)


def test_a_weak_motor_stalls_and_both_are_reported():
    motor = partial(motors.kloss_torque, synchronous_speed=27.0, breakdown_torque=900.0, breakdown_slip=0.15)
    run = simulate_startup(*LECTURE, driver_inertia=1.0, driver_torque=motor)
    assert run.outcome == "stalled"
    assert not run.keeps_load
    assert names(run)[-1] == "driver stalls"
    assert run.slip_time < run.end
    assert run.headline() == f"lock-up after {run.slip_time:.4g} s, then the driver stalls"
    assert run.frame()["driver_speed [1/min]"].iloc[-1] == pytest.approx(0, abs=1e-6)
    # Who says how long to go on after lock-up is not shown more.
    for hold in (0.0, 0.05):
        shown = simulate_startup(*LECTURE, driver_inertia=1.0, driver_torque=motor, hold_time=hold)
        assert shown.end == pytest.approx(run.slip_time + hold, rel=1e-12)
        assert (shown.outcome, shown.keeps_load, shown.slip_time) == ("locked", False, run.slip_time)
        assert names(shown)[-1] == "lock-up"
        assert shown.headline() == f"lock-up after {run.slip_time:.4g} s, but the driver cannot hold the load"
        assert abs(energy_error(shown)) < 1e-9
        assert shown.frame()["time [s]"].iloc[-1] == shown.end
        assert math.isnan(shown.hold_reserve) == (hold == 0)
    # A driver without torque stops before the load has moved.
    flywheel = simulate_startup(1080, 1000, 30, 26.6, 2, driver_inertia=1.0, driver_torque=0.0)
    assert (flywheel.outcome, flywheel.headline()) == ("stalled", "the driver stalls")
    assert math.isnan(flywheel.slip_time)
    assert flywheel.friction_work == pytest.approx(26.6**2 / 2, rel=1e-8)


@pytest.mark.slow
@QUICK
@given(
    st.floats(1.05, 3),
    st.floats(0.0, 0.9),
    st.floats(0.2, 20),
    st.floats(0.05, 20),
    st.floats(0.05, 5),
    st.sampled_from(["reactive", "active"]),
    st.sampled_from(["linear", "smooth"]),
    st.floats(0.8, 3),
)
def test_no_energy_is_lost_whatever_happens(torque, load, first, second, ramp_time, kind, ramp, breakdown):
    motor = partial(motors.kloss_torque, synchronous_speed=10.2, breakdown_torque=breakdown, breakdown_slip=0.2)
    run = simulate_startup(
        torque, load, second, 10.0, ramp_time, kind, ramp=ramp, driver_inertia=first, driver_torque=motor
    )
    assert abs(energy_error(run)) < 1e-7
    assert run.outcome in ("locked", "stalled")
    frame = run.frame()
    balance = frame["driver_work [J]"] - frame[["load_work [J]", "kinetic_work [J]", "friction_work [J]"]].sum(axis=1)
    assert np.abs(balance).max() <= 1e-7 * frame["driver_work [J]"].abs().max()
    powers = frame[["load_power [W]", "kinetic_power [W]", "friction_power [W]"]].sum(axis=1)
    assert np.abs(frame["driver_power [W]"] - powers).max() <= 1e-9 * frame["driver_power [W]"].abs().max()
    assert frame["friction_work [J]"].diff().min() >= -1e-9 * frame["friction_work [J]"].iloc[-1]


def test_locked_the_clutch_carries_its_share_and_keeps_a_reserve():
    run = simulate_startup(*LECTURE, driver_inertia=10.0, driver_torque=800.0, static_ratio=1.2)
    locked = run.frame().query("`phase [-]` == 4")
    carried = 600 + 30 * (800 - 600) / 40
    assert locked["clutch_torque [N*m]"].to_numpy() == pytest.approx(carried)
    assert run.hold_reserve == pytest.approx(1.2 * 1080 / carried)


# ---- the frame ------------------------------------------------------------------------------------------------------


def test_the_frame_says_how_to_draw_itself():
    frame = simulate_startup(*LECTURE).frame()
    assert all(column.endswith("]") for column in frame.columns)
    assert frame["time [s]"].is_monotonic_increasing
    assert 300 < len(frame) < 600
    # two rows where the torque drops at lock-up
    at_lock = frame[np.isclose(frame["time [s]"], 3.2180555555)]
    assert at_lock["clutch_torque [N*m]"].tolist() == pytest.approx([1080, 600])
    assert [span["label"] for span in frame.attrs["spans"]] == ["load at rest", "ramp", "full torque", "locked"]
    assert frame["phase [-]"].unique().tolist() == [1, 2, 3, 4]
    panels = [panel["label"] for panel in frame.attrs["panels"]]
    assert panels == ["torque [N*m]", "speed [1/min]", "acceleration [rad/s2]", "power [W]", "work [J]"]
    for name in ("driver", "load", "kinetic", "friction"):
        # the works are the areas under the powers
        pieces = frame["time [s]"].diff().fillna(0) * frame[f"{name}_power [W]"].rolling(2).mean().fillna(0)
        assert pieces.sum() == pytest.approx(frame[f"{name}_work [J]"].iloc[-1], rel=1e-4)


# ---- repeated switching ---------------------------------------------------------------------------------------------


@QUICK
@given(st.floats(0.01, 0.2), st.floats(500, 2e4), st.floats(5, 300), st.floats(0.05, 1))
def test_repeated_switching_against_the_lumped_closed_form(rate, capacity, transfer, area):
    run = simulate_startup(1080, 200, 3, 26.6, 0.3)
    switching = simulate_switching(run, rate, capacity, transfer, area, engagements=3)
    work, constant = run.friction_work, heat.thermal_time_constant(capacity, transfer, area)
    closed = float(heat.peak_temperature_rise(work, rate, capacity, transfer, area))
    # Heat that comes over the slip time, and not at once, can only leave earlier: by what cools off during slip.
    assert closed * math.exp(-run.slip_time / constant) * (1 - 1e-6) <= switching.peak_rise <= closed * (1 + 1e-6)
    assert switching.mean_rise == pytest.approx(float(heat.mean_temperature_rise(work, rate, transfer, area)), rel=1e-7)


def test_a_short_slip_is_the_sudden_step_of_the_closed_form():
    run = simulate_startup(1e6, 0, 3, 26.6, 0.0)
    switching = simulate_switching(run, 0.05, 2000, 50, 0.3)
    closed = float(heat.peak_temperature_rise(run.friction_work, 0.05, 2000, 50, 0.3))
    assert switching.peak_rise == pytest.approx(closed, rel=1e-5)


def test_cycle_after_cycle_against_a_plain_integration():
    run = simulate_startup(*LECTURE)
    capacity, loss, cycle = 2400.0, 30.0, 20.0
    switching = simulate_switching(run, 1 / cycle, capacity, 100.0, 0.3, engagements=4)
    frame = run.frame()
    times, powers = frame["time [s]"], frame["friction_power [W]"]
    step, rise, peaks = 0.01, 0.0, [0.0] * 4
    for k in range(round(4 * cycle / step)):
        middle = (k + 0.5) * step % cycle
        power = np.interp(middle, times, powers) if middle < run.slip_time else 0.0
        rise += step * (power - loss * rise) / capacity
        peaks[int(k * step // cycle)] = max(peaks[int(k * step // cycle)], rise)
    for n in range(4):
        within = (switching.times >= n * cycle) & (switching.times <= (n + 1) * cycle)
        assert switching.rises[within].max() == pytest.approx(peaks[n], rel=2e-3)
    assert np.all(np.diff(switching.times) >= 0)
    assert switching.rises.max() < switching.peak_rise
    long = simulate_switching(run, 1 / cycle, capacity, 100.0, 0.3)
    assert long.rises.max() == pytest.approx(long.peak_rise, rel=0.01)


# ---- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"torque": 0.0}, "torque: got 0.0; expected a number above 0, in N m"),
        ({"load_torque": -1.0}, "load_torque: got -1.0"),
        ({"driver_speed": math.inf}, "driver_speed: got inf"),
        ({"load_kind": "passive"}, "reactive, active or inertia"),
        ({"load_kind": "inertia"}, "load_torque: got 600.0; expected 0"),
        ({"ramp": "steep"}, "linear, smooth"),
        ({"ramp": ((0, 0), (0.5, 1))}, "corners from"),
        ({"ramp": ((0, 0), (0.5, -1), (1, 1))}, "corners from"),
        ({"ramp": lambda x: x / 2}, "1 at the end"),
        ({"driver_inertia": 3.0}, "driver_torque too"),
        ({"driver_torque": 3.0}, "finite driver_inertia too"),
        ({"driver_inertia": -3.0, "driver_torque": 3.0}, "driver_inertia: got -3.0"),
        ({"time_limit": 0.0}, "time_limit: got 0.0"),
    ],
)
def test_impossible_arguments_are_refused(changes, words):
    arguments = dict(
        zip(("torque", "load_torque", "driven_inertia", "driver_speed", "ramp_time"), LECTURE, strict=True)
    )
    with pytest.raises(InputError) as told:
        simulate_startup(**arguments | changes)
    assert words in str(told.value)


def test_impossible_switching_is_refused():
    run = simulate_startup(*LECTURE)
    with pytest.raises(InputError, match="less than"):
        simulate_switching(run, 0.5, 1000, 50, 0.2)
    with pytest.raises(InputError, match="ends in lock-up"):
        simulate_switching(simulate_startup(1080, 1200, 30, 26.6, 2), 0.01, 1000, 50, 0.2)
    with pytest.raises(InputError, match="engagements"):
        simulate_switching(run, 0.01, 1000, 50, 0.2, engagements=0)


# ---- the motor ------------------------------------------------------------------------------------------------------


def test_kloss_curve_goes_through_rated_and_breakdown_point():
    slip = float(motors.breakdown_slip(0.0267, 3.0))
    curve = partial(motors.kloss_torque, synchronous_speed=157.08, breakdown_torque=3.0 * 49.05, breakdown_slip=slip)
    assert curve(157.08 * (1 - 0.0267)) == pytest.approx(49.05)
    assert curve(157.08 * (1 - slip)) == pytest.approx(3 * 49.05)
    assert max(curve(speed) for speed in np.linspace(0, 157, 2000)) <= 3 * 49.05
    assert curve(160.0) < 0 == curve(157.08)
    # the straight line of small slip
    assert curve(157.08 * (1 - 1e-4)) == pytest.approx(2 * 3 * 49.05 / slip * 1e-4, rel=1e-6)
