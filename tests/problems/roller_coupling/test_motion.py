"""The motion of the roller coupling from its joints, and the closed forms of the limits against it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synth.problems.roller_coupling import formulas as rc
from synth.problems.roller_coupling import motion as rm

R, K, D = 0.06, 0.1, 0.047
TORQUE, SPEED, MASS, ROLLER = 300.0, 100.0, 2.0, 0.4
ANGLES = [60, 68, 75, 90]


def plain_turn(offset, chi, steps=3600):
    """Places of the four rollers and the float centre for parallel shafts, by plane trigonometry."""
    phi = np.linspace(0, 2 * np.pi, steps + 1)
    u1 = np.stack([np.cos(phi), np.sin(phi)])
    u2 = np.stack([np.cos(phi + chi), np.sin(phi + chi)])
    second = np.array([[offset], [0.0]])
    # Both rollers of an arm lie on its guide: the centre is where the two lines cross.
    along = (second[0] * u2[1] - second[1] * u2[0]) / (u1[0] * u2[1] - u1[1] * u2[0])
    centre = along * u1
    rollers = [R * u1, -R * u1, second + R * u2, second - R * u2]
    return phi, u1, u2, centre, rollers


@pytest.mark.parametrize("chi", ANGLES)
@pytest.mark.parametrize("offset", [0.0, 0.003, 0.012])
def test_roller_distance_and_run_in_against_a_scan(chi, offset):
    angle = math.radians(chi)
    _, u1, u2, centre, rollers = plain_turn(offset, angle)
    distances = [np.hypot(*(rollers[i] - rollers[j])) for i in (0, 1) for j in (2, 3)]
    closest = min(x.min() for x in distances)
    assert closest == pytest.approx(float(rc.least_roller_distance(R, offset, angle)), abs=2e-8)
    found = rm.clearances(rm.turn(offset, guide_angle=angle), R, K, D)
    assert found.gaps.min() + D == pytest.approx(closest, abs=1e-6)
    first = np.abs([np.sum((rollers[k] - centre) * u1, axis=0) for k in (0, 1)])
    second = np.abs([np.sum((rollers[k] - centre) * u2, axis=0) for k in (2, 3)])
    nearest, farthest = min(first.min(), second.min()), max(first.max(), second.max())
    corner = D / 2 / math.tan(angle / 2)
    assert nearest - corner == pytest.approx(float(rc.run_in(R, offset, D, angle)), abs=1e-7)
    assert K - farthest == pytest.approx(float(rc.run_out(K, R, offset, angle)), abs=1e-7)
    assert found.run_in.min() == pytest.approx(nearest - corner, abs=1e-6)
    assert found.run_out.min() == pytest.approx(K - farthest, abs=1e-6)


def test_rollers_are_closest_at_45_and_farthest_at_225_degrees():
    """In the source's angle, from the normal of the common normal; it prints 235 for the second."""
    e = 0.01
    phi = np.radians(np.arange(0, 360, 0.01))
    h2 = 2 * R**2 + e**2 - 2 * e * R * (np.sin(phi) + np.cos(phi))
    assert math.degrees(phi[np.argmin(h2)]) == pytest.approx(45)
    assert math.degrees(phi[np.argmax(h2)]) == pytest.approx(225)
    assert math.sqrt(h2.min()) == pytest.approx(math.sqrt(2) * R - e)


@pytest.mark.parametrize("chi", ANGLES)
def test_forces_of_parallel_shafts_are_those_of_the_closed_forms(chi):
    angle, e = math.radians(chi), 0.008
    motion = rm.turn(e, guide_angle=angle)
    found = rm.forces(motion, R, TORQUE, SPEED, MASS, ROLLER)
    tangential = float(rc.tangential_force(TORQUE, R, R))
    push = float(rc.pin_centrifugal_force(MASS, e, SPEED, angle))
    own = float(rc.roller_centrifugal_force(ROLLER, R, SPEED))
    assert found.contact.max(axis=0) == pytest.approx([tangential + push] * 4, rel=1e-4)
    assert found.contact.min(axis=0) == pytest.approx([tangential - push] * 4, rel=1e-4)
    assert found.pins.max() == pytest.approx(float(rc.resultant_pin_force(tangential + push, own)), rel=1e-4)
    assert found.driven_torque == pytest.approx(TORQUE, rel=1e-9)  # equal all the time
    steady, vibration = rm.steady_and_vibrating(found.first_shaft)
    assert steady == pytest.approx(float(rc.steady_shaft_force(push)), rel=1e-9)
    assert vibration == pytest.approx(float(rc.vibration_shaft_force(push)), rel=1e-9)
    assert found.first_shaft[:-1, 0].mean() < 0  # away from the other shaft, which lies at x = e
    # Two pins of an arm share the push evenly, and twice per turn each is at its worst.
    assert found.contact[:, 0] + found.contact[:, 1] == pytest.approx(2 * tangential, rel=1e-9)


def test_centrifugal_force_by_newton():
    """The centre of the float by plane trigonometry, differentiated twice: 2 m e omega**2, (14)."""
    e = 0.008
    phi, _, _, centre, _ = plain_turn(e, math.pi / 2)
    step = phi[1]
    acceleration = (centre[:, 2:] - 2 * centre[:, 1:-1] + centre[:, :-2]) / step**2 * SPEED**2
    force = MASS * np.hypot(*acceleration)
    assert force == pytest.approx(np.full_like(force, float(rc.float_centrifugal_force(MASS, e, SPEED))), rel=1e-5)
    for chi in (60, 75):
        _, _, _, centre, _ = plain_turn(e, math.radians(chi))
        radius = np.hypot(*(centre - centre[:, :-1].mean(axis=1, keepdims=True)))
        assert 2 * radius == pytest.approx(np.full_like(radius, e / math.sin(math.radians(chi))), rel=1e-9)


@pytest.mark.parametrize("chi", ANGLES)
def test_counter_float_of_equal_mass_leaves_a_steady_push_of_twice_the_size(chi):
    angle, e = math.radians(chi), 0.008
    push = float(rc.pin_centrifugal_force(MASS, e, SPEED, angle))
    motion = rm.turn(e, guide_angle=angle)
    for counter in (0.5, 2.0, 3.0):
        found = rm.forces(motion, R, TORQUE, SPEED, MASS, ROLLER, counter_mass=counter)
        other = push * counter / MASS
        steady, vibration = rm.steady_and_vibrating(found.first_shaft)
        assert steady == pytest.approx(float(rc.steady_shaft_force(push, other)), rel=1e-9)
        assert vibration == pytest.approx(float(rc.vibration_shaft_force(push, other)), rel=1e-9, abs=1e-8)


def test_contact_is_lost_where_the_retention_limit_says():
    e = 0.02
    motion = rm.turn(e)
    mass = TORQUE / (2 * R) / (e * SPEED**2)  # F = Q
    assert rm.forces(motion, R, TORQUE, SPEED, 0.99 * mass, ROLLER).contact.min() > 0
    assert rm.forces(motion, R, TORQUE, SPEED, 1.01 * mass, ROLLER).contact.min() < 0


@pytest.mark.parametrize(("alpha", "size"), [(0.5, 3e-4), (2.5, 1.5e-3), (10, 2e-2)])
@pytest.mark.parametrize(("e", "h"), [(0.008, 0.0), (0.0, 0.05), (0.006, 0.03), (0.004, 0.3)])
@pytest.mark.parametrize("chi", [60, 90])
def test_closed_forms_of_angled_shafts_are_good_to_the_order_of_alpha_squared(alpha, size, e, h, chi):
    angle, across = math.radians(alpha), math.radians(chi)
    motion = rm.turn(e, h, angle, across)
    effective = float(rc.effective_offset(e, h, angle))
    travel = max(np.abs(motion.first_travel).max(), np.abs(motion.second_travel).max())
    assert travel == pytest.approx(effective / math.sin(across), rel=size if chi < 90 else min(size, 2e-4))
    slide = float(rc.axial_slide(e, h, angle, across))
    assert np.ptp(motion.slide) == pytest.approx(slide, rel=min(size, 7e-3) if chi < 90 else 1e-4)
    found = rm.clearances(motion, R, K, D)
    assert found.gaps.min() == pytest.approx(float(rc.least_roller_distance(R, effective, across)) - D, abs=R * size)
    loaded = rm.forces(motion, R, TORQUE, SPEED, MASS, ROLLER)
    tangential = float(rc.tangential_force(TORQUE, R, R))
    push = float(rc.pin_centrifugal_force(MASS, effective, SPEED, across))
    assert loaded.contact.max() == pytest.approx(tangential + push, rel=size)
    # Power goes through: torque falls as the speed rises, but for what moves the float.
    idle = rm.forces(motion, R, TORQUE, SPEED, 1e-9, ROLLER)
    assert idle.driven_torque * motion.speed_ratio == pytest.approx(TORQUE, rel=1e-6 if chi == 90 else size)


@pytest.mark.slow
@settings(max_examples=40, deadline=None)
@given(st.floats(0, 0.02), st.floats(0, 0.3), st.floats(1e-3, 0.17))
def test_motion_of_angled_shafts_at_right_angled_guides(e, h, angle):
    motion = rm.turn(e, h, angle)
    # The source counts from the normal of the common normal.
    psi = motion.driving_angle
    assert motion.speed_ratio == pytest.approx(rc.speed_ratio(psi - math.pi / 2, angle), rel=1e-9)
    assert motion.lead == pytest.approx(rc.driven_angle(psi - math.pi / 2, angle) - psi + math.pi / 2, abs=1e-9)
    course = rc.slide_position(math.pi / 2 - psi, e, h, angle)
    assert motion.slide == pytest.approx(course, abs=1e-12)
    # The joints: each arm centre on its guide, guide II across shaft 2, guides at right angles.
    second_axis = np.array([0.0, math.sin(angle), math.cos(angle)])
    second_arm = np.array([e, 0.0, 0.0]) + motion.slide[:, None] * second_axis
    reached = second_arm + motion.second_travel[:, None] * motion.second_direction
    assert reached == pytest.approx(motion.centre, abs=1e-12)
    assert motion.second_direction @ second_axis == pytest.approx(0, abs=1e-12)
    assert np.sum(motion.first_direction * motion.second_direction, axis=1) == pytest.approx(0, abs=1e-12)


def test_mean_rolling_gives_the_efficiency():
    """All four rollers roll with |d travel/dt|; friction mu F each, against the power M omega."""
    e, friction = 0.008, 0.002
    motion = rm.turn(e)
    way = sum(np.abs(np.diff(x)).sum() for x in (motion.first_travel, motion.second_travel))
    lost = 2 * friction * TORQUE / (2 * R) * way / (2 * np.pi)
    assert 1 - lost / TORQUE == pytest.approx(float(rc.rolling_efficiency(friction, e, R)), rel=1e-9)


def test_unequal_guides_and_radii_carry_a_pure_couple():
    """Statics of a float without mass: arm forces must vanish one by one, so that the pins of an arm pull evenly."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        chi = rng.uniform(1.0, 1.57)
        inner, outer = rng.uniform(0.03, 0.1, 2)
        u1, u2 = np.array([1.0, 0.0]), np.array([math.cos(chi), math.sin(chi)])
        way = [np.array([-u[1], u[0]]) for u in (u1, u2)]
        where = [outer * u1, -inner * u1, 0.05 * u2, -0.04 * u2]
        # unknown: four pin forces across their guides; known: no net force, and arm 1 gives the torque
        matrix = np.array(
            [
                [way[0][0], way[0][0], way[1][0], way[1][0]],
                [way[0][1], way[0][1], way[1][1], way[1][1]],
                [float(np.cross([*p, 0], [*w, 0])[2]) for p, w in zip(where, [way[0]] * 2 + [way[1]] * 2, strict=True)],
                [outer, -inner, 0, 0],
            ]
        )
        forces = np.linalg.solve(matrix, [0, 0, 0, TORQUE])
        expected = float(rc.tangential_force(TORQUE, outer, inner))
        assert forces[:2] == pytest.approx([expected, -expected])
        assert forces[2] == pytest.approx(-forces[3])
