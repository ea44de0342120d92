"""Reduction of a drive to the clutch shaft, against the energies of its bodies integrated in time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from synth.problems.mechanics import reduction

GRAVITY = 9.80665


@pytest.mark.parametrize(
    ("load", "inertia", "expected"),
    [
        ((0, 2000, 0.4, 2, 12.5, 0.93), (8, 0, 2000, 0.4, 2, 12.5, 0.93, 0.35), (168.716559, 0.542688172)),
        ((0, 2000, 0.4, 2, 12.5, 0.93, True), (8, 0, 2000, 0.4, 2, 12.5, 0.93, 0.35, True), (145.922952, 0.516656)),
        ((180, 0, 1, 1, 3.2, 0.96), (2.4, 0, 0, 1, 1, 3.2, 0.96, 0), (58.59375, 0.244140625)),
        ((25, 0, 0.315, 1, 8, 0.9), (0, 1200, 0, 0.315, 1, 8, 0.9, 0.02), (3.47222222, 0.536796875)),
    ],
)
def test_worked_numbers(load, inertia, expected):
    found = (reduction.load_at_clutch(*load), reduction.inertia_at_clutch(*inertia))
    assert found == pytest.approx(expected, rel=5e-9)


@pytest.mark.parametrize("braking", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_energies_of_the_bodies_integrated_in_time_give_the_same_motion(seed, braking):
    rng = np.random.default_rng(seed)
    machine_torque, machine_inertia, side_inertia = rng.uniform(5, 50), rng.uniform(0.5, 5), rng.uniform(0.01, 0.2)
    lifted, moved, drum, parts = rng.uniform(100, 900), rng.uniform(0, 500), rng.uniform(0.2, 0.6), rng.integers(1, 5)
    ratio, efficiency = rng.uniform(2, 20), rng.uniform(0.6, 0.98)
    common = (drum, parts, ratio, efficiency)
    load = reduction.load_at_clutch(machine_torque, lifted, *common, braking=braking)
    inertia = reduction.inertia_at_clutch(machine_inertia, moved, lifted, *common, side_inertia, braking=braking)
    torque, begun, time = 1.6 * load, 40.0, 0.5

    def powers(speed):
        """Power into machine and masses at a steady speed, and twice their kinetic energy over the speed squared."""
        shaft = speed / ratio
        travel = shaft * drum / 2 / parts
        steady = machine_torque * shaft + lifted * GRAVITY * travel
        return steady, (machine_inertia * shaft**2 + (lifted + moved) * travel**2) / speed**2

    def changes(_, state):
        """Speed by bisection of the power balance, so that no reduced inertia is needed; and the energies."""
        speed = state[0]
        steady, stored = powers(speed)

        def surplus(change):
            # While the clutch drives, the machine gets eta of what leaves the clutch shaft; while it brakes (the load
            # sinks, and slows down by change), the clutch shaft gets eta of what leaves the machine.
            if braking:
                return (torque - side_inertia * change) * speed - efficiency * (steady + stored * change * speed)
            return (torque - side_inertia * change) * speed * efficiency - (steady + stored * change * speed)

        below, above = -1e5, 1e5
        rate = below + (above - below) * surplus(below) / (surplus(below) - surplus(above))  # linear in the change
        return [-rate if braking else rate, torque * speed, steady]

    solved = solve_ivp(changes, (0, time), [begun, 0.0, 0.0], rtol=1e-11, atol=1e-11)
    speed, work, steady_work = solved.y[:, -1]
    sign = -1 if braking else 1
    assert speed == pytest.approx(begun + sign * (torque - load) / inertia * time, rel=1e-9)
    # The other route: energies at the ends alone.
    kinetic = 0.5 * (speed**2 - begun**2) * powers(1.0)[1]
    own = 0.5 * side_inertia * (speed**2 - begun**2)
    expected = efficiency * (steady_work - kinetic) - own if braking else own + (kinetic + steady_work) / efficiency
    assert work == pytest.approx(expected, rel=1e-9)
