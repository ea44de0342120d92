"""Exact motion of the roller coupling over one turn: float, clearances, slide and forces.

Nothing here uses the closed forms of synth.problems.roller_coupling.formulas; they are checked against it.

Shaft 1 is the z axis and turns evenly. The common normal of the shafts lies along x, shaft 2 passes it at x = e and is
tilted by alpha about x. Arm 1 turns in the plane z = h. Its guide I points along u1, at the angle psi from x; guide II
points along u2, across shaft 2 and at the angle chi from u1. Both guides lie in one plane, the middle plane of the
float, and that settles where its centre is and how far the rollers of arm 2 slide along their shaft. The tilt of the
rollers in the guides and play are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..mechanics import Quantity

# Rows per turn: a multiple of 4 for quarter turns, with every whole and half degree.
STEPS = 720


@dataclass(frozen=True)
class Turn:
    """Positions over one turn of shaft 1; arrays over the driving angle, the last row is the first again.

    Attributes
    ----------
    driving_angle : array
        psi [rad].
    lead : array
        Angle of shaft 2 less psi [rad].
    speed_ratio : array
        omega2/omega1 [-].
    slide : array
        Place of arm 2 along shaft 2, from the common normal [m].
    centre : array (rows, 3)
        Centre of the float [m].
    first_direction, second_direction, normal : array (rows, 3)
        Unit vectors along guide I, along guide II, and across the float.
    first_travel, second_travel : array
        Centre of the float from the centres of arm 1 and arm 2, along guides I and II [m].
    guide_angle, shaft_angle : float
        chi, alpha [rad].
    """

    driving_angle: np.ndarray
    lead: np.ndarray
    speed_ratio: np.ndarray
    slide: np.ndarray
    centre: np.ndarray
    first_direction: np.ndarray
    second_direction: np.ndarray
    normal: np.ndarray
    first_travel: np.ndarray
    second_travel: np.ndarray
    guide_angle: float
    shaft_angle: float


@dataclass(frozen=True)
class Clearances:
    """Clearances over one turn [m]; arrays over the driving angle.

    Attributes
    ----------
    gaps : array (rows, 4)
        Between the rollers 1a-2a, 1a-2b, 1b-2a, 1b-2b.
    run_in : array (rows, 2)
        Of the roller nearer to the crossing guide, in guide I and guide II.
    run_out : array (rows, 2)
        Of the roller nearer to the end, in guide I and guide II.
    """

    gaps: np.ndarray
    run_in: np.ndarray
    run_out: np.ndarray


@dataclass(frozen=True)
class Forces:
    """Forces over one turn [N]; arrays over the driving angle.

    Attributes
    ----------
    contact : array (rows, 4)
        Of the guides on the rollers 1a, 1b, 2a, 2b; negative where the roller would have to pull.
    pins : array (rows, 4)
        Resultants on the pins, with the rollers' own centrifugal force.
    first_shaft : array (rows, 2)
        Inertia of the float (and of the counter float) on shaft 1, along x and y.
    driven_torque : array
        Torque of shaft 2 [N m].
    """

    contact: np.ndarray
    pins: np.ndarray
    first_shaft: np.ndarray
    driven_torque: np.ndarray


def _dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    product: np.ndarray = np.sum(first * second, axis=-1)
    return product


def _unit(vectors: np.ndarray) -> np.ndarray:
    unit: np.ndarray = vectors / np.sqrt(_dot(vectors, vectors))[:, None]
    return unit


def _derivative(values: np.ndarray, order: int) -> np.ndarray:
    """Return the derivative by the angle of periodic columns, exact to rounding; the last row repeats the first."""
    periodic = values[:-1]
    waves = np.fft.rfftfreq(len(periodic), 1 / len(periodic))
    factor = (1j * waves) ** order
    if order % 2:
        factor[-1] = 0  # the highest wave has no odd derivative on the grid
    spectrum = np.fft.rfft(periodic, axis=0)
    result = np.fft.irfft(spectrum * factor.reshape(-1, *[1] * (values.ndim - 1)), len(periodic), axis=0)
    return np.concatenate([result, result[:1]])


def _second_guide(first: np.ndarray, second_axis: np.ndarray, guide_angle: float) -> np.ndarray:
    """Directions of guide II, which lies across shaft 2 and at the angle chi from guide I."""
    shadow = first - _dot(first, second_axis)[:, None] * second_axis
    along = math.cos(guide_angle) / np.sqrt(_dot(shadow, shadow))
    level = _unit(shadow)
    second: np.ndarray = along[:, None] * level + np.sqrt(1 - along**2)[:, None] * np.cross(second_axis, level)
    return second


def turn(
    offset: float,
    float_distance: float = 0.0,
    shaft_angle: float = 0.0,
    guide_angle: float = math.pi / 2,
    steps: int = STEPS,
) -> Turn:
    """Positions of float and arms over one turn of shaft 1.

    Parameters
    ----------
    offset : float
        Length of the common normal e [m].
    float_distance : float
        Arm 1 from the common normal along shaft 1, h [m]; without a shaft angle it does not matter.
    shaft_angle, guide_angle : float
        alpha, chi [rad].
    steps : int
        Rows per turn, a multiple of 4.

    Returns
    -------
    Turn

    References
    ----------
    Derived here from the joints; S3 (Szoke 1967), chapters XI and XII, gives the closed forms.

    Examples
    --------
    The centre runs on the circle over the two shaft centres:

    >>> centre = turn(0.010).centre
    >>> radius = np.hypot(centre[:, 0] - 0.005, centre[:, 1])
    >>> float(1000 * radius.min()), float(1000 * radius.max())
    (5.0000, 5.0000)
    """
    psi = np.linspace(0.0, 2 * math.pi, steps + 1)
    zero = np.zeros_like(psi)
    first_axis = np.array([0.0, 0.0, 1.0])
    second_axis = np.array([0.0, math.sin(shaft_angle), math.cos(shaft_angle)])
    first = np.stack([np.cos(psi), np.sin(psi), zero], axis=1)
    second = _second_guide(first, second_axis, guide_angle)
    normal = _unit(np.cross(first, second))
    # Both guides lie in one plane: the way between the arm centres has no part across the float.
    start = np.array([offset, 0.0, -float_distance])
    slide = -_dot(start, normal) / _dot(second_axis, normal)
    between = start + slide[:, None] * second_axis
    cosine = math.cos(guide_angle)
    on_first, on_second = _dot(between, first), _dot(between, second)
    first_travel = (on_first - cosine * on_second) / math.sin(guide_angle) ** 2
    second_travel = (cosine * on_first - on_second) / math.sin(guide_angle) ** 2
    centre = float_distance * first_axis + first_travel[:, None] * first
    # The angle of guide II about shaft 2 runs evenly but for the lead.
    beside = np.array([0.0, math.cos(shaft_angle), -math.sin(shaft_angle)])
    angle = np.unwrap(np.arctan2(_dot(second, beside), second[:, 0])) - guide_angle
    lead = angle - psi
    return Turn(
        driving_angle=psi,
        lead=lead,
        speed_ratio=1 + _derivative(lead, 1),
        slide=slide,
        centre=centre,
        first_direction=first,
        second_direction=second,
        normal=normal,
        first_travel=first_travel,
        second_travel=second_travel,
        guide_angle=guide_angle,
        shaft_angle=shaft_angle,
    )


def clearances(motion: Turn, arm_radius: float, guide_half_length: float, roller_diameter: float) -> Clearances:
    """Clearances between rollers and in the guides over one turn.

    Parameters
    ----------
    motion : Turn
    arm_radius, guide_half_length, roller_diameter : float
        r, K, D [m].

    Returns
    -------
    Clearances

    References
    ----------
    Positions of the rollers in the float's plane.

    Examples
    --------
    S3's example, r = 50 mm, D = 54 mm, e = 14.5 mm, K = 73 mm:

    >>> found = clearances(turn(0.0145), 0.050, 0.073, 0.054)
    >>> [float(1000 * x.min()) for x in (found.gaps, found.run_in, found.run_out)]
    [2.2107, 8.5000, 8.5000]
    """
    cosine = math.cos(motion.guide_angle)
    first = [sign * arm_radius - motion.first_travel for sign in (1, -1)]
    second = [sign * arm_radius - motion.second_travel for sign in (1, -1)]
    distances = [np.sqrt(p**2 + q**2 - 2 * p * q * cosine) for p in first for q in second]
    travel = np.abs(np.stack([motion.first_travel, motion.second_travel], axis=1))
    corner = roller_diameter / (2 * math.tan(motion.guide_angle / 2))
    return Clearances(
        gaps=np.stack(distances, axis=1) - roller_diameter,
        run_in=arm_radius - travel - corner,
        run_out=guide_half_length - arm_radius - travel,
    )


def forces(
    motion: Turn,
    arm_radius: float,
    torque: float,
    speed: float,
    float_mass: float,
    roller_mass: float,
    counter_mass: float = 0.0,
) -> Forces:
    """Return the forces over one turn from the equilibrium of the float, whose centre is accelerated.

    Parameters
    ----------
    motion : Turn
    arm_radius : float
        r [m].
    torque : float
        M of shaft 1 [N m].
    speed : float
        omega of shaft 1 [rad/s].
    float_mass, roller_mass, counter_mass : float
        m, m_c, and the mass of the counter float, 0 without one [kg].

    Returns
    -------
    Forces

    References
    ----------
    Newton's law for the float in its own plane; its turning inertia (angled shafts only) is left out.

    Examples
    --------
    Greatest and least contact force are M/(2 r) +- m e omega**2:

    >>> found = forces(turn(0.010), 0.050, 150.0, 100.0, 2.0, 0.4).contact
    >>> float(found.max()), float(found.min())
    (1700.0, 1300.0)
    """
    second_axis = np.array([0.0, math.sin(motion.shaft_angle), math.cos(motion.shaft_angle)])
    acceleration = speed**2 * _derivative(motion.centre, 2)
    sine = math.sin(motion.guide_angle)
    # Arm 1 can push along normal x u1 only, arm 2 along normal x u2.
    first_push = float_mass * _dot(acceleration, motion.second_direction) / sine
    second_push = -float_mass * _dot(acceleration, motion.first_direction) / sine
    first_way = np.cross(motion.normal, motion.first_direction)
    couple = torque / motion.normal[:, 2]
    driven_couple = couple - first_push * motion.first_travel - second_push * motion.second_travel
    first, second = couple / (2 * arm_radius), driven_couple / (2 * arm_radius)
    contact = np.stack(
        [first + first_push / 2, first - first_push / 2, second - second_push / 2, second + second_push / 2], axis=1
    )
    own_speed = speed * np.stack([np.ones_like(motion.speed_ratio)] * 2 + [motion.speed_ratio] * 2, axis=1)
    push = -(first_push[:, None] * first_way)[:, :2]
    quarter = (len(push) - 1) // 4
    # The counter float has its guides across those of the float: it does the same a quarter of a turn later.
    later = np.roll(push[:-1], -quarter, axis=0)
    counter = counter_mass / float_mass * np.concatenate([later, later[:1]])
    return Forces(
        contact=contact,
        pins=np.hypot(contact, roller_mass * arm_radius * own_speed**2),
        first_shaft=push + counter,
        driven_torque=driven_couple * _dot(motion.normal, second_axis),
    )


def steady_and_vibrating(force: np.ndarray) -> tuple[Quantity, Quantity]:
    """Steady part of a force on a shaft, and the greatest deviation from it.

    Parameters
    ----------
    force : array (rows, 2)
        Along x and y over one turn, the last row is the first again [N].

    Returns
    -------
    tuple of float
        Steady force and amplitude [N].

    References
    ----------
    Mean over the turn.

    Examples
    --------
    Both are m e omega**2; with a counter float of the same mass the steady push doubles and the vibration is gone:

    >>> found = forces(turn(0.010), 0.050, 150.0, 100.0, 2.0, 0.4)
    >>> [float(x) for x in steady_and_vibrating(found.first_shaft)]
    [200.0, 200.0]
    >>> found = forces(turn(0.010), 0.050, 150.0, 100.0, 2.0, 0.4, counter_mass=2.0)
    >>> [float(x) for x in steady_and_vibrating(found.first_shaft)]
    [400.0, 0.0]
    """
    mean = force[:-1].mean(axis=0)
    around = force - mean
    return np.hypot(*mean), np.hypot(around[:, 0], around[:, 1]).max()
