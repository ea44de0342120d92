"""Device A: balls in conical ramps push the pressure plate against one set of return springs.

Regimes, with i = tan(alpha), F = m r omega**2 i eta the axial force of the balls, F_R0 and s preload and rate of the
springs, h the gap, r1 = r0 + i h:

1. at rest (x = 0): F below F_R0;
2. travelling (0 < x < h): F = F_R0 + s x, no clamp force;
3. clamping (x = h): the clamp force is F - F_R0 - s h and grows with the speed for ever.

Every function takes floats, arrays or CasADi symbols. Source: S4 (notes on centrifugal clutches), analysis 1. It is
printed with errors in equations (3), (6), (7) and (12); each is named where it is corrected.
"""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = [
    "clamp_force",
    "clamp_speed_ratio",
    "faster_clamp_force",
    "radius_at_speed",
    "rest_reaction",
    "travel_at_speed",
]


def rest_reaction(
    preload: Quantity, centrifugal_force: Quantity, ratio: Quantity, efficiency: Quantity = 1.0
) -> Quantity:
    """Radial reaction of the inner rest while the balls lie on it.

    Equation: F_2 = F_R0/(i eta) - F_C

    Parameters
    ----------
    preload : scalar, array or symbol
        Force of the springs at rest F_R0 [N].
    centrifugal_force : scalar, array or symbol
        F_C [N], below that of the start.
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-]: eta_out going out, eta_in coming in.

    Returns
    -------
    scalar, array or symbol
        F_2 [N].

    References
    ----------
    S4, analysis 1, eq. (3); printed with R_R0 for F_R0.

    Examples
    --------
    Computed here, 300 N on a ramp of 45 degrees, 120 N of centrifugal force:

    >>> rest_reaction(300.0, 120.0, 1.0)
    180.0
    """
    return preload / (ratio * efficiency) - centrifugal_force


def travel_at_speed(
    speed: Quantity,
    mass: Quantity,
    rest_radius: Quantity,
    ratio: Quantity,
    preload: Quantity,
    rate: Quantity,
    efficiency: Quantity = 1.0,
) -> Quantity:
    """Travel of the plate in regime 2.

    Equation: x = (k r0 - F_R0)/(s - k i), with k = m omega**2 i eta

    Parameters
    ----------
    speed : scalar, array or symbol
        Speed of the flyweight carrier omega [rad/s].
    mass : scalar, array or symbol
        Total mass of the flyweights m [kg].
    rest_radius : scalar, array or symbol
        Radius of the ball centres at rest r0 [m].
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].
    preload : scalar, array or symbol
        Force of the springs at rest F_R0 [N].
    rate : scalar, array or symbol
        Rate of the springs s [N/m].
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-]: eta_out going out, eta_in coming in.

    Returns
    -------
    scalar, array or symbol
        x [m].

    Notes
    -----
    Singular where the balls snap (k i = s): curves take the travel as parameter instead.

    References
    ----------
    S4, analysis 1, eq. (7); printed with tan(alpha) for tan(alpha)**2 in the denominator, which is right at 45
    degrees only.

    Examples
    --------
    Computed here: 0.25 kg at 70 mm, 40 degrees, 240 N and 60 N/mm; at 130 rad/s k = 3545 N/m:

    >>> 1000 * travel_at_speed(130.0, 0.25, 0.070, 0.8390996, 240.0, 60e3)
    0.14316
    """
    pull = mass * speed**2 * ratio * efficiency
    return (pull * rest_radius - preload) / (rate - pull * ratio)


def radius_at_speed(
    speed: Quantity,
    mass: Quantity,
    rest_radius: Quantity,
    ratio: Quantity,
    preload: Quantity,
    rate: Quantity,
    efficiency: Quantity = 1.0,
) -> Quantity:
    """Radius of the balls in regime 2.

    Equation: r = (F_R0 - s r0/i)/(k - s/i), with k = m omega**2 i eta

    Parameters
    ----------
    speed : scalar, array or symbol
        Speed of the flyweight carrier omega [rad/s].
    mass : scalar, array or symbol
        Total mass of the flyweights m [kg].
    rest_radius : scalar, array or symbol
        Radius of the ball centres at rest r0 [m].
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].
    preload : scalar, array or symbol
        Force of the springs at rest F_R0 [N].
    rate : scalar, array or symbol
        Rate of the springs s [N/m].
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-]: eta_out going out, eta_in coming in.

    Returns
    -------
    scalar, array or symbol
        r [m].

    References
    ----------
    S4, analysis 1, eq. (6); printed without - s/tan(alpha) in the denominator.

    Examples
    --------
    Computed here, as in :func:`travel_at_speed`, 70 mm + i x:

    >>> 1000 * radius_at_speed(130.0, 0.25, 0.070, 0.8390996, 240.0, 60e3)
    70.1201
    """
    pull = mass * speed**2 * ratio * efficiency
    return (preload - rate * rest_radius / ratio) / (pull - rate / ratio)


def clamp_force(gain: Quantity, speed: Quantity, contact_speed: Quantity) -> Quantity:
    """Clamp force above the contact speed.

    Equation: F_N = g (omega**2 - omega_contact**2)

    Parameters
    ----------
    gain : scalar, array or symbol
        Axial force over the square of the speed at r1, g = m i eta r1 [kg m].
    speed : scalar, array or symbol
        Speed of the flyweight carrier omega [rad/s].
    contact_speed : scalar, array or symbol
        Speed at which the plates touch omega_contact [rad/s].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    Notes
    -----
    The spring force at contact F_R0 + s h is g omega_contact**2, because there the balls just balance it.

    References
    ----------
    S4, analysis 1, eq. (12), F_N = m r1 omega**2 tan(alpha) - F_R0 - s h, whose spring term is printed with + s h.

    Examples
    --------
    Computed here, 0.04 kg m, twice the contact speed:

    >>> clamp_force(0.04, 200.0, 100.0)
    1200.0
    """
    return gain * (speed**2 - contact_speed**2)


def clamp_speed_ratio(spring_force: Quantity, clamp_force: Quantity) -> Quantity:
    """Speed of a clamp force over the contact speed.

    Equation: omega/omega_contact = sqrt(1 + F_N/F_R1)

    Parameters
    ----------
    spring_force : scalar, array or symbol
        Force of the springs at contact F_R1 [N].
    clamp_force : scalar, array or symbol
        F_N [N].

    Returns
    -------
    scalar, array or symbol
        omega/omega_contact [-].

    References
    ----------
    S4, analysis 1, eq. (12), corrected, solved for the speed.

    Examples
    --------
    Computed here, 1200 N over 400 N of spring force, as in :func:`clamp_force`:

    >>> float(clamp_speed_ratio(400.0, 1200.0))
    2.0
    """
    return np.sqrt(1 + clamp_force / spring_force)


def faster_clamp_force(clamp_force: Quantity, gain: Quantity, speed: Quantity, faster: Quantity) -> Quantity:
    """Clamp force at a higher speed.

    Equation: F_N2 = F_N + g (omega2**2 - omega**2)

    Parameters
    ----------
    clamp_force : scalar, array or symbol
        Clamp force at some speed F_N [N].
    gain : scalar, array or symbol
        Axial force over the square of the speed at r1, g [kg m].
    speed : scalar, array or symbol
        Speed of the flyweight carrier omega [rad/s].
    faster : scalar, array or symbol
        A higher speed omega2 [rad/s].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    References
    ----------
    S4, analysis 1, eq. (12): in contact the springs do not move any more.

    Examples
    --------
    Computed here, from 200 to 300 rad/s:

    >>> faster_clamp_force(1200.0, 0.04, 200.0, 300.0)
    3200.0
    """
    return clamp_force + gain * (faster**2 - speed**2)
