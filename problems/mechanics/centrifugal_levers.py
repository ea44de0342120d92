"""Centrifugal clutches with levers: statics of the lever with a headed rod, and of the reversed lever.

A flyweight at the arm l_c swings the lever outwards; angles are small, so that sin(phi) = phi and r = r0 + l_c phi.
Forces are totals of all flyweights and of all parallel springs. Every function takes floats, arrays or CasADi symbols.

*Lever with a headed rod*: the clamp spring stands between lever and pressure plate at the arm l_s, the rod ties the
plate to the lever at the smaller arm l_r. Until the plate meets the disc, the rod is taut and the plate travels with
it; then the rod unloads at constant angle; then the spring alone clamps.

*Reversed lever*: the pivot sits on a disc 1 that the clamp springs press against the housing. The short leg l_p pushes
the plate; once it pushes harder than the springs do, disc 1 lifts and the springs clamp.

Source: S4 (notes on centrifugal clutches), figures 2-24 to 2-26 and practice 3. The source describes both in words
only; the relations are derived from them.
"""

from __future__ import annotations

from . import Quantity

__all__ = [
    "band_squared",
    "clamp_angle",
    "clamp_flyweight_force",
    "clamp_spring_force",
    "contact_angle",
    "gradual_radius",
    "growth",
    "plate_force",
    "retraction_force",
    "return_force",
    "rod_force",
    "speed_squared",
    "travel_angle",
    "travel_flyweight_force",
    "travel_spring_force",
]

# -- both levers -----------------------------------------------------------------------------------


def contact_angle(contact_travel: Quantity, plate_arm: Quantity) -> Quantity:
    """Lever angle at which the plate meets the disc.

    Equation: phi1 = x0/l

    Parameters
    ----------
    contact_travel : scalar, array or symbol
        Gap between plate and disc at rest x0 [m].
    plate_arm : scalar, array or symbol
        Arm that moves the plate l [m]: l_r of the rod, l_p of the reversed lever.

    Returns
    -------
    scalar, array or symbol
        phi1 [rad].

    References
    ----------
    Derived; small angles.

    Examples
    --------
    >>> contact_angle(0.010, 0.050)
    0.2
    """
    return contact_travel / plate_arm


# -- lever with a headed rod -----------------------------------------------------------------------


def travel_spring_force(
    preload: Quantity, rate: Quantity, spring_arm: Quantity, rod_arm: Quantity, angle: Quantity
) -> Quantity:
    """Spring force while the plate travels.

    Equation: F_R = F_R0 + s (l_s - l_r) phi

    Parameters
    ----------
    preload : scalar, array or symbol
        Preload of the set F_R0 [N].
    rate : scalar, array or symbol
        Rate of the set s [N/m].
    spring_arm : scalar, array or symbol
        l_s [m].
    rod_arm : scalar, array or symbol
        l_r [m].
    angle : scalar, array or symbol
        phi, up to contact [rad].

    Returns
    -------
    scalar, array or symbol
        F_R, which is also the force in the rod [N].

    References
    ----------
    Derived: the rod moves the plate by l_r phi, the lever closes the spring by l_s phi.

    Examples
    --------
    Practice 3 at contact; with the misprinted rate of 105 N/m the spring force would hardly change:

    >>> travel_spring_force(1200, 1e5, 0.100, 0.050, 0.2), travel_spring_force(1200, 105, 0.100, 0.050, 0.2)
    (2200.0, 1201.05)
    """
    return preload + rate * (spring_arm - rod_arm) * angle


def clamp_spring_force(
    preload: Quantity, rate: Quantity, spring_arm: Quantity, contact_travel: Quantity, angle: Quantity
) -> Quantity:
    """Spring force from contact on.

    Equation: F_R = F_R0 + s (l_s phi - x0)

    Parameters
    ----------
    preload : scalar, array or symbol
        Preload of the set F_R0 [N].
    rate : scalar, array or symbol
        Rate of the set s [N/m].
    spring_arm : scalar, array or symbol
        l_s, or l_p of the reversed lever, whose spring force it is once disc 1 has lifted [m].
    contact_travel : scalar, array or symbol
        x0, with the wear of the lining where it is worn [m].
    angle : scalar, array or symbol
        phi, from contact on [rad].

    Returns
    -------
    scalar, array or symbol
        F_R [N].

    References
    ----------
    Derived: the plate stands on the disc.

    Examples
    --------
    Practice 3 at the stop:

    >>> clamp_spring_force(1200, 1e5, 0.100, 0.010, 0.3)
    3200.0
    """
    return preload + rate * (spring_arm * angle - contact_travel)


def travel_flyweight_force(
    spring_force: Quantity, spring_arm: Quantity, rod_arm: Quantity, flyweight_arm: Quantity
) -> Quantity:
    """Centrifugal force that holds the lever while the rod is taut.

    Equation: F_C = F_R (l_s - l_r)/l_c

    Parameters
    ----------
    spring_force : scalar, array or symbol
        F_R [N].
    spring_arm : scalar, array or symbol
        l_s [m].
    rod_arm : scalar, array or symbol
        l_r [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].

    Returns
    -------
    scalar, array or symbol
        F_C [N]; below 0 where the rod sits farther out than the spring: the lever swings out by itself.

    References
    ----------
    Derived: the spring pushes the lever back at l_s, the rod pulls it on at l_r with the same force.

    Examples
    --------
    Practice 3, start and contact; then with rod and spring changed over:

    >>> travel_flyweight_force(1200, 0.100, 0.050, 0.100), travel_flyweight_force(2200, 0.100, 0.050, 0.100)
    (600.0, 1100.0)
    >>> travel_flyweight_force(1200, 0.050, 0.100, 0.100)
    -600.0
    """
    return spring_force * (spring_arm - rod_arm) / flyweight_arm


def clamp_flyweight_force(spring_force: Quantity, spring_arm: Quantity, flyweight_arm: Quantity) -> Quantity:
    """Centrifugal force that holds a spring force without the rod.

    Equation: F_C = F_R l_s/l_c

    Parameters
    ----------
    spring_force : scalar, array or symbol
        F_R; of the reversed lever the force P of the short leg on the plate [N].
    spring_arm : scalar, array or symbol
        l_s; of the reversed lever l_p [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].

    Returns
    -------
    scalar, array or symbol
        F_C [N].

    References
    ----------
    Derived: moments about the pivot.

    Examples
    --------
    >>> clamp_flyweight_force(2200, 0.100, 0.100)
    2200.0
    """
    return spring_force * spring_arm / flyweight_arm


def rod_force(
    flyweight_force: Quantity, spring_force: Quantity, spring_arm: Quantity, rod_arm: Quantity, flyweight_arm: Quantity
) -> Quantity:
    """Force in the rod while it unloads at contact.

    Equation: F_rod = (F_R1 l_s - F_C l_c)/l_r

    The plate is pressed with what the rod no longer holds back, F_N = F_R1 - F_rod.

    Parameters
    ----------
    flyweight_force : scalar, array or symbol
        F_C [N].
    spring_force : scalar, array or symbol
        Spring force at contact F_R1 [N].
    spring_arm : scalar, array or symbol
        l_s [m].
    rod_arm : scalar, array or symbol
        l_r [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].

    Returns
    -------
    scalar, array or symbol
        F_rod [N].

    References
    ----------
    Derived: moments about the pivot at constant angle.

    Examples
    --------
    Practice 3 at 1000/min, on the radius of contact:

    >>> rod_force(0.172 * 104.71976**2, 2200, 0.100, 0.050, 0.100)
    627.618
    """
    return (spring_force * spring_arm - flyweight_force * flyweight_arm) / rod_arm


def retraction_force(preload: Quantity, spring_arm: Quantity, rod_arm: Quantity) -> Quantity:
    """Force at the spring's arm that brings the lever home at standstill.

    Equation: F = F_R0 (1 - l_r/l_s)

    Parameters
    ----------
    preload : scalar, array or symbol
        F_R0 [N].
    spring_arm : scalar, array or symbol
        l_s [m].
    rod_arm : scalar, array or symbol
        l_r [m].

    Returns
    -------
    scalar, array or symbol
        Retraction force [N]; below 0 where rod and spring have changed places: the clutch stays engaged.

    References
    ----------
    Derived; the question of the source what happens when rod and spring change places.

    Examples
    --------
    >>> retraction_force(1200, 0.100, 0.050), retraction_force(1200, 0.050, 0.100)
    (600.0, -1200.0)
    """
    return preload * (1 - rod_arm / spring_arm)


def travel_angle(
    speed: Quantity,
    mass: Quantity,
    rest_radius: Quantity,
    flyweight_arm: Quantity,
    spring_arm: Quantity,
    rod_arm: Quantity,
    preload: Quantity,
    rate: Quantity,
) -> Quantity:
    """Lever angle at a speed between start and contact, for a lever that does not snap.

    Equation: phi = (m r0 omega**2 l_c - F_R0 D)/(s D**2 - m omega**2 l_c**2), with D = l_s - l_r

    Parameters
    ----------
    speed : scalar, array or symbol
        omega [rad/s].
    mass : scalar, array or symbol
        Mass of all flyweights m [kg].
    rest_radius : scalar, array or symbol
        r0 [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].
    spring_arm : scalar, array or symbol
        l_s [m].
    rod_arm : scalar, array or symbol
        l_r [m].
    preload : scalar, array or symbol
        F_R0 [N].
    rate : scalar, array or symbol
        s [N/m].

    Returns
    -------
    scalar, array or symbol
        phi [rad]. Singular at the snap limit; a design program takes phi as the parameter and the speed that a force
        belongs to (:func:`synth.problems.mechanics.centrifugal.speed_for_force`).

    References
    ----------
    Derived.

    Examples
    --------
    Practice 3 at 700/min, gap left of 10 mm:

    >>> 10 - 50 * travel_angle(700 * 0.10471976, 1, 0.152, 0.100, 0.100, 0.050, 1200, 1e5)
    4.47777
    """
    arm = spring_arm - rod_arm
    pull = mass * speed**2 * flyweight_arm
    return (pull * rest_radius - preload * arm) / (rate * arm**2 - pull * flyweight_arm)


def clamp_angle(
    speed: Quantity,
    mass: Quantity,
    rest_radius: Quantity,
    flyweight_arm: Quantity,
    spring_arm: Quantity,
    contact_travel: Quantity,
    preload: Quantity,
    rate: Quantity,
) -> Quantity:
    """Lever angle at a speed between the free rod (disc 1 lifting) and the stop, for a lever that does not snap.

    Equation: phi = (m r0 omega**2 l_c - (F_R0 - s x0) l_s)/(s l_s**2 - m omega**2 l_c**2)

    Parameters
    ----------
    speed : scalar, array or symbol
        omega [rad/s].
    mass : scalar, array or symbol
        Mass of all flyweights m [kg].
    rest_radius : scalar, array or symbol
        r0 [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].
    spring_arm : scalar, array or symbol
        l_s; of the reversed lever l_p [m].
    contact_travel : scalar, array or symbol
        x0 [m].
    preload : scalar, array or symbol
        F_R0 [N].
    rate : scalar, array or symbol
        s [N/m].

    Returns
    -------
    scalar, array or symbol
        phi [rad]; singular at the snap limit.

    References
    ----------
    Derived.

    Examples
    --------
    Practice 3 at the stop:

    >>> clamp_angle(132.59871, 1, 0.152, 0.100, 0.100, 0.010, 1200, 1e5)
    0.3
    """
    pull = mass * speed**2 * flyweight_arm
    return (pull * rest_radius - (preload - rate * contact_travel) * spring_arm) / (
        rate * spring_arm**2 - pull * flyweight_arm
    )


# -- reversed lever --------------------------------------------------------------------------------


def return_force(preload: Quantity, rate: Quantity, travel: Quantity) -> Quantity:
    """Force of the springs that draw the plate back.

    Equation: F_ret = F_ret0 + s_ret x

    Parameters
    ----------
    preload : scalar, array or symbol
        F_ret0 [N].
    rate : scalar, array or symbol
        s_ret [N/m].
    travel : scalar, array or symbol
        Travel of the plate x, at contact x0 [m].

    Returns
    -------
    scalar, array or symbol
        F_ret [N].

    References
    ----------
    Statics.

    Examples
    --------
    >>> return_force(210, 3e4, 0.003)
    300.0
    """
    return preload + rate * travel


def plate_force(flyweight_force: Quantity, flyweight_arm: Quantity, plate_arm: Quantity) -> Quantity:
    """Force of the short leg on the plate.

    Equation: P = F_C l_c/l_p

    Parameters
    ----------
    flyweight_force : scalar, array or symbol
        F_C [N].
    flyweight_arm : scalar, array or symbol
        l_c [m].
    plate_arm : scalar, array or symbol
        l_p [m].

    Returns
    -------
    scalar, array or symbol
        P [N]. The plate is pressed with P less the force of the return springs; the springs press disc 1 on the housing
        with F_R0 - P, and from P = F_R0 on disc 1 lifts.

    References
    ----------
    Derived: moments about the pivot.

    Examples
    --------
    >>> plate_force(600, 0.060, 0.025)
    1440.0
    """
    return flyweight_force * flyweight_arm / plate_arm


# -- no snap ---------------------------------------------------------------------------------------


def gradual_radius(deflection: Quantity, flyweight_arm: Quantity, resisting_arm: Quantity) -> Quantity:
    """Least rest radius at which a phase of the motion is gradual.

    Equation: r0 = delta l_c/l

    While a lever moves against a spring, F_C grows with r omega**2 and the spring force with the angle. The lever
    follows the speed step by step only if the spring gains more than the radius does: s l**2 r >= F l l_c at the start
    of the phase; then it holds in all of it. Otherwise the lever jumps through the phase and back at a lower speed.

    Parameters
    ----------
    deflection : scalar, array or symbol
        Deflection of the spring by which its force is F_R0 + s l phi for phi counted from rest: the preload deflection
        delta while the plate travels, delta - x0 while the lever clamps [m].
    flyweight_arm : scalar, array or symbol
        l_c [m].
    resisting_arm : scalar, array or symbol
        Arm at which the spring resists l [m]: l_s - l_r or l_p while the plate travels, l_s or l_p while it clamps.

    Returns
    -------
    scalar, array or symbol
        Least r0 [m].

    References
    ----------
    Derived; the source does not speak of it. Of the lever with a rod the clamping phase is gradual whenever the travel
    is, because l_s > l_s - l_r and delta - x0 < delta.

    Examples
    --------
    Practice 3: 12 mm of preload deflection is gradual; the misprinted rate needs 11.4 m of it and snaps:

    >>> gradual_radius(0.012, 0.100, 0.050), gradual_radius(1200 / 105, 0.100, 0.050)
    (0.024, 22.857143)
    """
    return deflection * flyweight_arm / resisting_arm


# -- engagement ------------------------------------------------------------------------------------


def growth(start: Quantity, arm: Quantity, angle: Quantity) -> Quantity:
    """Growth of a length that an arm makes longer.

    Equation: q = 1 + l phi/x

    Parameters
    ----------
    start : scalar, array or symbol
        Length before x [m]: deflection of the springs, or radius of the flyweights.
    arm : scalar, array or symbol
        Arm l [m].
    angle : scalar, array or symbol
        Angle by which it swings on phi [rad].

    Returns
    -------
    scalar, array or symbol
        Length after over length before [-].

    References
    ----------
    Geometry.

    Examples
    --------
    Practice 3 from contact to the stop, springs (12 + 10 mm, 3200/2200 N) and radius (182/172 mm):

    >>> growth(22, 100, 0.1), growth(172, 100, 0.1)
    (1.454545, 1.058140)
    """
    return 1 + arm * angle / start


def speed_squared(force: Quantity, mass: Quantity, radius: Quantity) -> Quantity:
    """Square of the speed at which the flyweights pull with a force.

    Equation: omega**2 = F_C/(m r)

    Parameters
    ----------
    force : scalar, array or symbol
        Centrifugal force of all flyweights F_C [N].
    mass : scalar, array or symbol
        Mass of all flyweights m [kg].
    radius : scalar, array or symbol
        Radius of their centres r [m].

    Returns
    -------
    scalar, array or symbol
        omega**2 [1/s2].

    References
    ----------
    F_C = m r omega**2.

    Examples
    --------
    Practice 3 at the stop (132.599 rad/s):

    >>> speed_squared(3200, 1, 0.182) ** 0.5
    132.599
    """
    return force / (mass * radius)


def band_squared(force_ratio: Quantity, radius_ratio: Quantity, rod_ratio: Quantity = 0.0) -> Quantity:
    """Square of the speed at the stop over that at contact.

    Equation: (omega_stop/omega_contact)**2 = q_F/(q_r (1 - q_l))

    Both speeds are sqrt(F_C/(m r)); mass and arm of the flyweights cancel, and so does the rate of the springs where
    the same springs resist at contact and at the stop.

    Parameters
    ----------
    force_ratio : scalar, array or symbol
        Force at the stop over force at contact q_F [-]: of the springs, or of the short leg on the plate.
    radius_ratio : scalar, array or symbol
        Radius of the flyweights at the stop over that at contact q_r [-].
    rod_ratio : scalar, array or symbol, optional
        Of a lever with a rod q_l = l_r/l_s [-]; it is taut at contact and slack at the stop.

    Returns
    -------
    scalar, array or symbol
        (omega_stop/omega_contact)**2 [-].

    References
    ----------
    Derived.

    Examples
    --------
    Practice 3 (132.599/79.9709):

    >>> band_squared(3200 / 2200, 182 / 172, 0.5) ** 0.5
    1.65809
    """
    return force_ratio / (radius_ratio * (1 - rod_ratio))
