"""Roller-type mobile coupling: clearances, forces, contact, pins, float and angled shafts.

A floating plate with two crossing guides joins two arms; each arm has two pins with a roller on each. Every function
takes floats, arrays or CasADi symbols.

Source S3: B. Szoke, MTA VI. Osztaly Kozlemenyei 39 (1967), part II (received 1966), chapters X to XIV, equations (14)
to (29). "ext" marks what is not in the source: it was derived here and is tested against an independent calculation.
"""

from __future__ import annotations

import math

import numpy as np

from ..mechanics import Quantity
from ..mechanics.shaft import BOSS_LENGTH

# ISO 76: a line contact loaded beyond this is dented by more than 0.0001 of the roller diameter [Pa].
STATIC_CONTACT_LIMIT = 4.0e9
ARM_THICKNESS = 1.2  # of an arm along its shaft over the diameter of its pins: usual proportion


# -- clearances ------------------------------------------------------------------------------------


def effective_offset(offset: Quantity, float_distance: Quantity, shaft_angle: Quantity) -> Quantity:
    """Offset seen in the plane of the float, e_eff = sqrt(e**2 + h**2 tan(alpha)**2).

    Parameters
    ----------
    offset : scalar, array or symbol
        Length of the common normal of the shafts e [m].
    float_distance : scalar, array or symbol
        Distance h of the float plane from the intersection or the common normal [m].
    shaft_angle : scalar, array or symbol
        Angle between the shafts alpha [rad].

    Returns
    -------
    scalar, array or symbol
        e_eff [m]. Exact where e or h or alpha is 0; else the way of the float is longer by less than 0.01 % up to
        10 degrees (synth.problems.roller_coupling.motion).

    References
    ----------
    ext; S3 speaks of e and h apart.

    Examples
    --------
    By hand, 600 mm tan 2.5 degrees = 26.197 mm; with e = 10 mm:

    >>> float(1000 * effective_offset(0.010, 0.600, 0.0436332))
    28.040
    """
    return np.sqrt(offset**2 + (float_distance * np.tan(shaft_angle)) ** 2)


def least_roller_distance(arm_radius: Quantity, offset: Quantity, guide_angle: Quantity = math.pi / 2) -> Quantity:
    """Least distance between the centres of neighbouring rollers over a turn, 2 r sin(chi/2) - e.

    Parameters
    ----------
    arm_radius : scalar, array or symbol
        r [m].
    offset : scalar, array or symbol
        e [m].
    guide_angle : scalar, array or symbol
        Acute angle between the guides chi [rad].

    Returns
    -------
    scalar, array or symbol
        h_min [m].

    References
    ----------
    S3, eq. (18): sqrt(2) r - e at 45 degrees. S3 prints 235 degrees for the other extreme; it is 225 degrees, and a
    maximum. For guides not at right angles: ext.

    Examples
    --------
    S3's example, r = 50 mm, e = 14.7107 mm: rollers of 54 mm keep 2 mm.

    >>> float(1000 * least_roller_distance(0.050, 0.0147107))
    56.0000
    """
    return 2 * arm_radius * np.sin(guide_angle / 2) - offset


def roller_gap_offset(
    arm_radius: Quantity, roller_diameter: Quantity, gap: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Largest offset at which neighbouring rollers keep a gap, 2 r sin(chi/2) - (D + s).

    Parameters
    ----------
    arm_radius, roller_diameter : scalar, array or symbol
        r, D [m].
    gap : scalar, array or symbol
        s [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        e_max [m].

    References
    ----------
    S3, eq. (18b).

    Examples
    --------
    S3 prints 1.45 cm for r = 5, D = 5.4, s = 0.2 cm; exactly

    >>> float(100 * roller_gap_offset(0.050, 0.054, 0.002))
    1.47107
    """
    return 2 * arm_radius * np.sin(guide_angle / 2) - roller_diameter - gap


def corner_distance(roller_diameter: Quantity, gap: Quantity) -> Quantity:
    """Distance of the roller centres from the guide corner where the rollers are closest, R (sqrt(2) - 1) + s/sqrt(2).

    Parameters
    ----------
    roller_diameter : scalar, array or symbol
        D = 2 R [m].
    gap : scalar, array or symbol
        s [m].

    Returns
    -------
    scalar, array or symbol
        b [m].

    References
    ----------
    S3, chapter XI, section 3; it prints 1.248 cm because it takes 0.41 for sqrt(2) - 1.

    Examples
    --------
    >>> float(100 * corner_distance(0.054, 0.002))
    1.25980
    """
    return roller_diameter / 2 * (math.sqrt(2) - 1) + gap / math.sqrt(2)


def run_in(
    arm_radius: Quantity, offset: Quantity, roller_diameter: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Least distance of a roller from the mouth of the crossing guide, r - e/sin(chi) - R cot(chi/2).

    Parameters
    ----------
    arm_radius, roller_diameter : scalar, array or symbol
        r, D = 2 R [m].
    offset : scalar, array or symbol
        e [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        s1 [m].

    References
    ----------
    S3, chapter XI, section 3: s1 = r - (e + R). For guides not at right angles: ext.

    Examples
    --------
    S3 prints 0.85 cm for e = 1.45 cm:

    >>> float(100 * run_in(0.050, 0.0145, 0.054))
    0.850000
    """
    return arm_radius - offset / np.sin(guide_angle) - roller_diameter / (2 * np.tan(guide_angle / 2))


def run_out(
    guide_half_length: Quantity, arm_radius: Quantity, offset: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Least distance of a roller centre from the end of its guide, K - r - e/sin(chi).

    Parameters
    ----------
    guide_half_length, arm_radius : scalar, array or symbol
        K, r [m].
    offset : scalar, array or symbol
        e [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        s2 [m].

    References
    ----------
    S3, eq. (19a). For guides not at right angles: ext.

    Examples
    --------
    >>> float(100 * run_out(0.073, 0.050, 0.0145))
    0.850000
    """
    return guide_half_length - arm_radius - offset / np.sin(guide_angle)


def even_guide_half_length(
    arm_radius: Quantity, roller_diameter: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Half guide length at which run-in and run-out are equal, K = 2 r - R cot(chi/2).

    Parameters
    ----------
    arm_radius, roller_diameter : scalar, array or symbol
        r, D = 2 R [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        K [m].

    References
    ----------
    S3, eq. (20): 2 r - R.

    Examples
    --------
    S3 prints 7.3 cm:

    >>> float(100 * even_guide_half_length(0.050, 0.054))
    7.30000
    """
    return 2 * arm_radius - roller_diameter / (2 * np.tan(guide_angle / 2))


def removal_clearance(arm_radius: Quantity, roller_diameter: Quantity) -> Quantity:
    """Clearance for pulling an arm out sideways through the other guide, s3 = r - D; guides at right angles.

    Parameters
    ----------
    arm_radius, roller_diameter : scalar, array or symbol
        r, D [m].

    Returns
    -------
    scalar, array or symbol
        s3 [m]; negative where it does not go.

    References
    ----------
    S3, eq. (21).

    Examples
    --------
    S3 prints -0.4 cm for r = 5, D = 5.4 cm, and 5.6 cm as the least r for 0.2 cm:

    >>> float(100 * removal_clearance(0.050, 0.054)), float(100 * removal_clearance(0.056, 0.054))
    (-0.400000, 0.200000)
    """
    return arm_radius - roller_diameter


def removable_offset(arm_radius: Quantity, gap: Quantity, removal: Quantity) -> Quantity:
    """Largest offset of a coupling that can be pulled apart sideways, (sqrt(2) - 1) r - s + s3.

    Parameters
    ----------
    arm_radius : scalar, array or symbol
        Least arm radius r_min = D + s3 [m].
    gap, removal : scalar, array or symbol
        s, s3 [m].

    Returns
    -------
    scalar, array or symbol
        e_max [m].

    References
    ----------
    S3, eq. (22); with s = s3 it is 0.41421 r_min, eq. (22a).

    Examples
    --------
    S3 prints 2.3 cm for r = 5.6 cm:

    >>> float(100 * removable_offset(0.056, 0.002, 0.002))
    2.31960
    """
    return (math.sqrt(2) - 1) * arm_radius - gap + removal


def offset_capacity(
    arm_radius: Quantity,
    guide_half_length: Quantity,
    roller_diameter: Quantity,
    gap: Quantity,
    run_in_clearance: Quantity,
    run_out_clearance: Quantity,
    guide_angle: Quantity = math.pi / 2,
) -> Quantity:
    """Largest offset at which all three clearances are kept.

    min(2 r sin(chi/2) - D - s, (r - R cot(chi/2) - s1) sin(chi), (K - r - s2) sin(chi)).

    Parameters
    ----------
    arm_radius, guide_half_length, roller_diameter : scalar, array or symbol
        r, K, D = 2 R [m].
    gap, run_in_clearance, run_out_clearance : scalar, array or symbol
        s, s1, s2 [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        e_max [m].

    References
    ----------
    S3, chapter XI, section 3, eq. (18b), (19a).

    Examples
    --------
    S3's coupling, limited by the rollers:

    >>> float(100 * offset_capacity(0.050, 0.073, 0.054, 0.002, 0.003, 0.003))
    1.47107
    """
    across = roller_gap_offset(arm_radius, roller_diameter, gap, guide_angle)
    inward = (arm_radius - roller_diameter / (2 * np.tan(guide_angle / 2)) - run_in_clearance) * np.sin(guide_angle)
    outward = (guide_half_length - arm_radius - run_out_clearance) * np.sin(guide_angle)
    return np.minimum(across, np.minimum(inward, outward))


# -- forces ----------------------------------------------------------------------------------------


def float_centrifugal_force(float_mass: Quantity, offset: Quantity, speed: Quantity) -> Quantity:
    """Centrifugal force of the float, C = 2 m e omega**2.

    Its centre runs on the circle over the two shaft centres at twice the shaft speed (guides at right angles).

    Parameters
    ----------
    float_mass : scalar, array or symbol
        m [kg].
    offset : scalar, array or symbol
        e [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        C [N].

    References
    ----------
    S3, eq. (14).

    Examples
    --------
    By hand, 2 x 2 x 0.01 x 100**2:

    >>> float(float_centrifugal_force(2.0, 0.010, 100.0))
    400.0
    """
    return 2 * float_mass * offset * speed**2


def pin_centrifugal_force(
    float_mass: Quantity, offset: Quantity, speed: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Greatest share of one pin in the float's centrifugal force, Q = m e omega**2/sin(chi)**2.

    The same figure is the steady push of the float on each shaft and the amplitude of the part that turns at 2 omega.

    Parameters
    ----------
    float_mass : scalar, array or symbol
        m [kg].
    offset : scalar, array or symbol
        e [m].
    speed : scalar, array or symbol
        omega [rad/s].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        Q [N].

    References
    ----------
    S3, eq. (14): C/2. For guides not at right angles: ext, the force is resolved on the two directions in which the
    arms can push.

    Examples
    --------
    >>> float(pin_centrifugal_force(2.0, 0.010, 100.0))
    200.0
    """
    return float_mass * (offset / np.sin(guide_angle)) * speed**2 / np.sin(guide_angle)


def steady_shaft_force(pin_centrifugal_force: Quantity, counter_force: Quantity = 0.0) -> Quantity:
    """Steady radial push on each shaft: the floats' forces add, Q + Q_E.

    Parameters
    ----------
    pin_centrifugal_force : scalar, array or symbol
        Q of the float [N].
    counter_force : scalar, array or symbol
        Q_E of the counter float of the self-balancing chain, 0 without one [N].

    Returns
    -------
    scalar, array or symbol
        Force away from the other shaft [N].

    References
    ----------
    ext; S3, XIV.1 says that the bearings of a balanced coupling see no force: the vibration is gone, the push doubles.

    Examples
    --------
    >>> float(steady_shaft_force(200.0)), float(steady_shaft_force(200.0, 200.0))
    (200.0, 400.0)
    """
    return pin_centrifugal_force + counter_force


def vibration_shaft_force(pin_centrifugal_force: Quantity, counter_force: Quantity = 0.0) -> Quantity:
    """Amplitude of the force on each shaft that turns at twice the speed, |Q - Q_E|.

    Parameters
    ----------
    pin_centrifugal_force : scalar, array or symbol
        Q of the float [N].
    counter_force : scalar, array or symbol
        Q_E of the counter float, 0 without one [N].

    Returns
    -------
    scalar, array or symbol
        Amplitude [N].

    References
    ----------
    S3, XIV.1 (self-balancing kinematic chain); per shaft: ext.

    Examples
    --------
    >>> float(vibration_shaft_force(200.0)), float(vibration_shaft_force(200.0, 200.0))
    (200.0, 0.0)
    """
    return np.abs(pin_centrifugal_force - counter_force)


def tangential_force(torque: Quantity, first_radius: Quantity, second_radius: Quantity) -> Quantity:
    """Force of each pin of an arm, a pure couple even for unequal radii, F = M/(r' + r'').

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    first_radius, second_radius : scalar, array or symbol
        Radii of the two pins r', r'' [m]; both r as a rule.

    Returns
    -------
    scalar, array or symbol
        F [N].

    References
    ----------
    S3, chapter XI (Fig. 16).

    Examples
    --------
    S3 prints 150 kp = 1471 N for 15 mkp at 5 cm:

    >>> float(tangential_force(147.09975, 0.050, 0.050))
    1471.00
    """
    return torque / (first_radius + second_radius)


def roller_centrifugal_force(roller_mass: Quantity, arm_radius: Quantity, speed: Quantity) -> Quantity:
    """Centrifugal force of a roller with the protruding pin, m_c r omega**2.

    Parameters
    ----------
    roller_mass : scalar, array or symbol
        m_c [kg].
    arm_radius : scalar, array or symbol
        r [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        Force [N]; it loads its own pin only.

    References
    ----------
    S3, chapter XI; it prints 184 kp from G n**2 r/900, exact is 894.7.

    Examples
    --------
    0.4 kg at 5 cm and 2880/min:

    >>> float(roller_centrifugal_force(0.4, 0.050, 301.5929) / 9.80665)
    185.503
    """
    return roller_mass * arm_radius * speed**2


def resultant_pin_force(normal_force: Quantity, roller_force: Quantity) -> Quantity:
    """Resultant force on a pin, E = sqrt((F + Q)**2 + (m_c r omega**2)**2).

    Parameters
    ----------
    normal_force : scalar, array or symbol
        Force of the guide on the roller F + Q [N].
    roller_force : scalar, array or symbol
        Centrifugal force of the roller [N].

    Returns
    -------
    scalar, array or symbol
        E [N].

    References
    ----------
    S3, chapter XI, E; the float's share Q: ext.

    Examples
    --------
    S3 prints 237 kp (with 184 kp):

    >>> float(resultant_pin_force(1471.00, 1819.17) / 9.80665)
    238.561
    """
    return np.hypot(normal_force, roller_force)


def optimum_arm_radius(torque: Quantity, roller_mass: Quantity, speed: Quantity) -> Quantity:
    """Arm radius of the least pin force, r = sqrt(M/(2 m_c omega**2)).

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    roller_mass : scalar, array or symbol
        m_c [kg].
    speed : scalar, array or symbol
        omega [rad/s], above 0.

    Returns
    -------
    scalar, array or symbol
        r [m].

    References
    ----------
    S3, eq. (15), without the float; it prints 4.52 cm with the factor 21.2 in place of 21.1454.

    Examples
    --------
    >>> float(100 * optimum_arm_radius(147.09975, 0.4, 301.5929))
    4.49614
    """
    return np.sqrt(torque / (2 * roller_mass)) / speed


def optimum_arm_radius_with_float(
    torque: Quantity, roller_mass: Quantity, speed: Quantity, pin_centrifugal_force: Quantity
) -> Quantity:
    """Arm radius of the least pin force beside a float, root of m_c**2 omega**4 r**4 = Q M r/2 + M**2/4.

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    roller_mass : scalar, array or symbol
        m_c [kg].
    speed : scalar, array or symbol
        omega [rad/s], above 0.
    pin_centrifugal_force : scalar, array or symbol
        Q, held fixed [N].

    Returns
    -------
    scalar, array or symbol
        r [m], larger than by (15).

    References
    ----------
    ext.

    Examples
    --------
    Without a float it is (15):

    >>> float(100 * optimum_arm_radius_with_float(147.09975, 0.4, 301.5929, 0.0))
    4.49614
    """
    stiffness = (roller_mass * speed**2) ** 2
    constant, slope = torque**2 / 4 / stiffness, pin_centrifugal_force * torque / 2 / stiffness
    # Above the root, where the quartic is convex: Newton's steps come down to it and never pass it.
    radius = constant**0.25 + slope ** (1 / 3)
    for _ in range(12):
        radius = radius - (radius**4 - slope * radius - constant) / (4 * radius**3 - slope)
    return radius


def rolling_efficiency(rolling_friction: Quantity, offset: Quantity, arm_radius: Quantity) -> Quantity:
    """Efficiency with rolling friction in the guides, 1 - 4 mu_roll e/(pi r).

    Parameters
    ----------
    rolling_friction : scalar, array or symbol
        mu_roll [-].
    offset : scalar, array or symbol
        e_eff [m].
    arm_radius : scalar, array or symbol
        r [m].

    Returns
    -------
    scalar, array or symbol
        Efficiency [-].

    References
    ----------
    ext: the rollers roll at a mean speed of 2 e omega/pi.

    Examples
    --------
    By hand, 1 - 4 x 0.002 x 0.2/pi:

    >>> float(rolling_efficiency(0.002, 0.010, 0.050))
    0.999491
    """
    return 1 - 4 * rolling_friction * offset / (math.pi * arm_radius)


# -- pins and shaft --------------------------------------------------------------------------------


def pin_shear_measure(torque: Quantity, arm_radius: Quantity, bore: Quantity) -> Quantity:
    """Twice the greatest shear stress of a pin, 1.4 M/(r pi d**2/4).

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    arm_radius, bore : scalar, array or symbol
        r, pin diameter d [m].

    Returns
    -------
    scalar, array or symbol
        Stress to compare with sigma_c [Pa].

    References
    ----------
    S3, eq. (16); 1.4 is 4/3 rounded up.

    Examples
    --------
    By hand, 1.4 x 147.1/(0.05 x 3.14159e-4):

    >>> float(pin_shear_measure(147.1, 0.050, 0.020) / 1e6)
    13.1105
    """
    return 1.4 * torque / (arm_radius * (math.pi / 4) * bore**2)


def pin_equivalent_stress(pin_force: Quantity, width: Quantity, pin_gap: Quantity, bore: Quantity) -> Quantity:
    """Equivalent stress at the root of a pin, sqrt(sigma_b**2 + 3 tau**2).

    sigma_b = 32 E (B/2 + g)/(pi d**3), tau = 4 E/(pi d**2).

    Parameters
    ----------
    pin_force : scalar, array or symbol
        Resultant force in the middle of the roller E [N].
    width, pin_gap, bore : scalar, array or symbol
        Roller width B, gap to the arm g, pin diameter d [m].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa].

    References
    ----------
    ext: bending of a cantilever pin; S3 only says that pins of fast couplings are sized in bending.

    Examples
    --------
    By hand, sigma_b = 32 x 2000 x 0.009/(pi x 8e-6) = 22.92 MPa, tau = 6.37 MPa:

    >>> float(pin_equivalent_stress(2000.0, 0.014, 0.002, 0.020) / 1e6)
    25.43
    """
    bending = pin_bending_stress(pin_force, width, pin_gap, bore)
    shear = pin_shear_stress(pin_force, bore)
    return np.sqrt(bending**2 + 3 * shear**2)


def pin_bending_stress(pin_force: Quantity, width: Quantity, pin_gap: Quantity, bore: Quantity) -> Quantity:
    """Bending stress at the root of a pin, 32 E (B/2 + g)/(pi d**3).

    Parameters
    ----------
    pin_force : scalar, array or symbol
        Resultant force in the middle of the roller E [N].
    width, pin_gap, bore : scalar, array or symbol
        Roller width B, gap to the arm g, pin diameter d [m].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa].

    References
    ----------
    ext: bending of a cantilever pin.

    Examples
    --------
    By hand, 32 x 2000 x 0.009/(pi x 8e-6):

    >>> pin_bending_stress(2000.0, 0.014, 0.002, 0.020) / 1e6
    22.918
    """
    return 32 * pin_force * (width / 2 + pin_gap) / (math.pi * bore**3)


def pin_shear_stress(pin_force: Quantity, bore: Quantity) -> Quantity:
    """Mean shear stress of a pin, 4 E/(pi d**2).

    Parameters
    ----------
    pin_force : scalar, array or symbol
        Resultant force E [N].
    bore : scalar, array or symbol
        Pin diameter d [m].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa].

    References
    ----------
    ext: shear of a pin.

    Examples
    --------
    By hand, 4 x 2000/(pi x 4e-4):

    >>> pin_shear_stress(2000.0, 0.020) / 1e6
    6.3662
    """
    return 4 * pin_force / (math.pi * bore**2)


def pin_diameter_of_shaft(
    shaft_diameter: Quantity, arm_radius: Quantity, shaft_stress: Quantity, pin_stress: Quantity
) -> Quantity:
    """Pin diameter as strong as the shaft, d = sqrt((0.7/4)(D_t**3/r)(sigma_t/sigma_c)).

    Parameters
    ----------
    shaft_diameter, arm_radius : scalar, array or symbol
        D_t, r [m].
    shaft_stress, pin_stress : scalar, array or symbol
        sigma_t, sigma_c [Pa].

    Returns
    -------
    scalar, array or symbol
        d [m].

    References
    ----------
    S3, eq. (17). Its (17a), (D_t/2) sqrt(D_t/r) for 600 and 400 kp/cm2, drops a factor 1.05 under the root: 2.5 %
    small.

    Examples
    --------
    D_t = 40 mm, r = 50 mm; (17a) gives 17.889 mm, 1.0247 times less:

    >>> float(1000 * pin_diameter_of_shaft(0.040, 0.050, 58.8399e6, 39.2266e6))
    18.330
    """
    return np.sqrt(0.7 / 4 * shaft_diameter**3 / arm_radius * (shaft_stress / pin_stress))


# -- bearing ---------------------------------------------------------------------------------------


def allowed_pin_force(static_rating: Quantity, oscillation_factor: Quantity, static_safety: Quantity) -> Quantity:
    """Force that an oscillating rolling bearing may carry, f_osc C0/S_0.

    Parameters
    ----------
    static_rating : scalar, array or symbol
        C0 [N].
    oscillation_factor : scalar, array or symbol
        f_osc [-]; 1 where the bearing stands still and the same balls stay loaded (false brinelling).
    static_safety : scalar, array or symbol
        S_0 [-].

    Returns
    -------
    scalar, array or symbol
        Force [N].

    References
    ----------
    S3, chapter XI: up to 4 times C0 (the lower figure is illegible).

    Examples
    --------
    >>> float(allowed_pin_force(7800.0, 2.0, 1.5))
    10400.0
    """
    return oscillation_factor * static_rating / static_safety


# -- float and masses ------------------------------------------------------------------------------


def float_radius(guide_half_length: Quantity, roller_diameter: Quantity, rim: Quantity) -> Quantity:
    """Outer radius of the float, sqrt(K**2 + D**2/4) + t.

    Parameters
    ----------
    guide_half_length, roller_diameter, rim : scalar, array or symbol
        K, D, t [m].

    Returns
    -------
    scalar, array or symbol
        R_f [m].

    References
    ----------
    Geometry: the corners of the guide ends, and the rim around them.

    Examples
    --------
    By hand, sqrt(73**2 + 27**2) + 5:

    >>> float(1000 * float_radius(0.073, 0.054, 0.005))
    82.833
    """
    return np.hypot(guide_half_length, roller_diameter / 2) + rim


def float_section(
    guide_half_length: Quantity, roller_diameter: Quantity, rim: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Area of the float without its guides, pi R_f**2 - (4 K D - D**2/sin(chi)).

    Written with a completed square, pi (K - 2 D/pi)**2 + (pi/4 + 1/sin(chi) - 4/pi) D**2 + pi t (2 H + t) with H =
    sqrt(K**2 + D**2/4), so that the search sees that the area cannot vanish.

    Parameters
    ----------
    guide_half_length, roller_diameter, rim : scalar, array or symbol
        K, D, t [m].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        Area [m2].

    References
    ----------
    Geometry: two slots of length 2 K and width D overlap in a rhombus.

    Examples
    --------
    By hand, pi 82.833**2 - (4 x 73 x 54 - 54**2):

    >>> float(1e6 * float_section(0.073, 0.054, 0.005))
    8703.5
    """
    corner = np.hypot(guide_half_length, roller_diameter / 2)
    overlap = math.pi / 4 - 4 / math.pi + 1 / np.sin(guide_angle)
    inside = math.pi * (guide_half_length - (2 / math.pi) * roller_diameter) ** 2 + overlap * roller_diameter**2
    return inside + math.pi * rim * (2 * corner + rim)


def float_width(contact_length: Quantity, axial_slide: Quantity, axial_play: Quantity) -> Quantity:
    """Width of the float, contact length with room for slide and play, l + z + 2 g.

    Parameters
    ----------
    contact_length, axial_slide, axial_play : scalar, array or symbol
        l, z peak to peak, g per side [m].

    Returns
    -------
    scalar, array or symbol
        b_f [m].

    References
    ----------
    S3, chapter XII: the guide is wider by the slide.

    Examples
    --------
    S3's conclusion for 2.5 degrees, "a few tenths of a millimetre wider", is 1.14 mm:

    >>> float(1000 * float_width(0.010, 0.00114268, 0.0))
    11.1427
    """
    return contact_length + axial_slide + 2 * axial_play


def float_mass(density: Quantity, width: Quantity, section: Quantity) -> Quantity:
    """Mass of the float, rho b_f A.

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    width : scalar, array or symbol
        b_f [m].
    section : scalar, array or symbol
        A [m2].

    Returns
    -------
    scalar, array or symbol
        m [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> float(float_mass(7850.0, 0.012, 0.0087035))
    0.81987
    """
    return density * width * section


def roller_mass(
    bearing_mass: Quantity, pin_density: Quantity, bore: Quantity, width: Quantity, pin_gap: Quantity
) -> Quantity:
    """Mass of a roller with the pin that protrudes from the arm, m_b + rho (pi/4) d**2 (B + g).

    Parameters
    ----------
    bearing_mass : scalar, array or symbol
        m_b [kg].
    pin_density : scalar, array or symbol
        rho [kg/m3].
    bore, width, pin_gap : scalar, array or symbol
        d, B, g [m].

    Returns
    -------
    scalar, array or symbol
        m_c [kg].

    References
    ----------
    S3, chapter XI (its G); geometry.

    Examples
    --------
    Bearing 6204 by hand, 0.11 + 7850 x 3.1416e-4 x 0.016:

    >>> float(roller_mass(0.11, 7850.0, 0.020, 0.014, 0.002))
    0.149458
    """
    return bearing_mass + pin_density * (math.pi / 4) * bore**2 * (width + pin_gap)


def arms_mass(density: Quantity, arm_radius: Quantity, bore: Quantity) -> Quantity:
    """Mass of both arms, bars of 2 r + 2 d by 2 d by 1.2 d.

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    arm_radius, bore : scalar, array or symbol
        r, pin diameter d [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    ext: usual proportions; hubs are not included.

    Examples
    --------
    By hand, 2 x 7850 x 0.14 x 0.04 x 0.024:

    >>> float(arms_mass(7850.0, 0.050, 0.020))
    2.11008
    """
    return 2 * density * (2 * arm_radius + 2 * bore) * (2 * bore) * (ARM_THICKNESS * bore)


def coupling_length(
    float_width: Quantity,
    roller_width: Quantity,
    pin_gap: Quantity,
    bore: Quantity,
    shaft_diameter: Quantity,
    counter: Quantity = 0.0,
) -> Quantity:
    """Length over both bosses, max(b_f, B) + 2 g + 2 (1.2 d + 1.2 d_s), and b_f + g for a counter float beside.

    Parameters
    ----------
    float_width, roller_width, pin_gap : scalar, array or symbol
        b_f, B, gap between arm face and roller g [m].
    bore, shaft_diameter : scalar, array or symbol
        Pin diameter d, which tells how thick an arm is, and shaft d_s, which tells how long a boss is [m].
    counter : scalar, array or symbol
        1 with a counter float, 0 without one [-].

    Returns
    -------
    scalar, array or symbol
        Length [m].

    References
    ----------
    ext: proportions of :func:`arms_mass` and of the boss.

    Examples
    --------
    By hand, 19 + 2 x 2 + 2 (1.2 x 15 + 1.2 x 40):

    >>> float(1000 * coupling_length(0.011, 0.019, 0.002, 0.015, 0.040))
    155.0
    """
    between = np.maximum(float_width, roller_width) + 2 * pin_gap + counter * (float_width + pin_gap)
    return between + 2 * (ARM_THICKNESS * bore + BOSS_LENGTH * shaft_diameter)


def ligament_stress(factor: Quantity, normal_force: Quantity, rim: Quantity, width: Quantity) -> Quantity:
    """Stress in the bridge at the end of a guide, k F_n/(t b_f).

    Parameters
    ----------
    factor : scalar, array or symbol
        For bending and notch k [-].
    normal_force : scalar, array or symbol
        F_n [N]; each bridge carries about as much in tension.
    rim, width : scalar, array or symbol
        t, b_f [m].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa].

    References
    ----------
    ext, an estimate; check the rim by finite elements before it is made.

    Examples
    --------
    By hand, 2.5 x 2000/(0.005 x 0.012):

    >>> float(ligament_stress(2.5, 2000.0, 0.005, 0.012) / 1e6)
    83.333
    """
    return factor * normal_force / (rim * width)


# -- angled shafts ---------------------------------------------------------------------------------


def driven_angle(driving_angle: Quantity, shaft_angle: Quantity) -> Quantity:
    """Angle of the driven shaft, tan(phi2) = tan(phi1)/cos(alpha), in the turn of the driving angle.

    Parameters
    ----------
    driving_angle : scalar, array or symbol
        phi1 [rad].
    shaft_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        phi2 [rad]; leads by about alpha**2/4 sin(2 phi1).

    References
    ----------
    S3, eq. (23): as one Cardan joint, whatever the offset.

    Examples
    --------
    >>> float(driven_angle(0.0, 0.1)), float(driven_angle(1.0, 0.1) - 1.0)
    (0.0, 0.002275)
    """
    lead = np.arctan2(
        (1 - np.cos(shaft_angle)) * np.sin(driving_angle) * np.cos(driving_angle),
        np.cos(shaft_angle) * np.cos(driving_angle) ** 2 + np.sin(driving_angle) ** 2,
    )
    return driving_angle + lead


def speed_ratio(driving_angle: Quantity, shaft_angle: Quantity) -> Quantity:
    """Speed of the driven over that of the driving shaft, cos(alpha)/(sin(phi)**2 + cos(phi)**2 cos(alpha)**2).

    Parameters
    ----------
    driving_angle : scalar, array or symbol
        phi [rad].
    shaft_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        omega2/omega1 [-], from cos(alpha) to 1/cos(alpha).

    References
    ----------
    S3, eq. (24), (24a).

    Examples
    --------
    >>> float(speed_ratio(0.0, 0.0436332)), float(speed_ratio(1.570796, 0.0436332))
    (1.000953, 0.999048)
    """
    return np.cos(shaft_angle) / (np.sin(driving_angle) ** 2 + np.cos(driving_angle) ** 2 * np.cos(shaft_angle) ** 2)


def speed_fluctuation(shaft_angle: Quantity) -> Quantity:
    """Greatest excess of the driven speed, 1/cos(alpha) - 1, free of cancellation.

    Parameters
    ----------
    shaft_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        Excess [-]; peak to peak it is sin(alpha) tan(alpha).

    References
    ----------
    S3, eq. (24a). Its example for 2.5 degrees prints 0.063 %: the sine 0.03548 it takes is that of 2 degrees 2 minutes.

    Examples
    --------
    >>> float(100 * speed_fluctuation(0.0436332))
    0.095268
    """
    return 2 * np.sin(shaft_angle / 2) ** 2 / np.cos(shaft_angle)


def slide_position(
    driving_angle: Quantity, offset: Quantity, float_distance: Quantity, shaft_angle: Quantity
) -> Quantity:
    """Place of the driven rollers along shaft 2 (guides at right angles).

    (h cos(alpha) + e sin(alpha) sin(psi) cos(psi))/(cos(alpha)**2 + sin(alpha)**2 sin(psi)**2).

    Parameters
    ----------
    driving_angle : scalar, array or symbol
        psi [rad], from the normal of the plane of shaft 1 and common normal.
    offset, float_distance : scalar, array or symbol
        e, h [m].
    shaft_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        lambda [m].

    References
    ----------
    ext: the float's plane holds both guides.

    Examples
    --------
    >>> float(slide_position(0.0, 0.010, 0.600, 0.0436332) - slide_position(1.570796, 0.010, 0.600, 0.0436332))
    0.00114268
    """
    across = np.sin(driving_angle) * np.cos(driving_angle)
    return (float_distance * np.cos(shaft_angle) + offset * np.sin(shaft_angle) * across) / (
        np.cos(shaft_angle) ** 2 + (np.sin(shaft_angle) * np.sin(driving_angle)) ** 2
    )


def axial_slide(
    offset: Quantity, float_distance: Quantity, shaft_angle: Quantity, guide_angle: Quantity = math.pi / 2
) -> Quantity:
    """Axial slide forced on the rollers per turn, peak to peak, tan(alpha) sqrt(e**2 + h**2 sin(alpha)**2)/sin(chi).

    Parameters
    ----------
    offset, float_distance : scalar, array or symbol
        e, h [m].
    shaft_angle : scalar, array or symbol
        alpha [rad].
    guide_angle : scalar, array or symbol
        chi [rad].

    Returns
    -------
    scalar, array or symbol
        z [m]; for guides not at right angles up to 0.7 % small at 10 degrees, exact at right angles.

    References
    ----------
    ext; for intersecting shafts (e = 0) it is S3, eq. (25), h sin(alpha)**2/cos(alpha). S3 takes (25) for skew shafts
    as well and finds no slide with the float on the common normal: it looked at 0 and 90 degrees only, the extremes lie
    between, and z is e tan(alpha) there. The factor 1/sin(chi) follows from synth.problems.roller_coupling.motion.

    Examples
    --------
    S3's example, 2.5 degrees and 600 mm, prints 0.75 mm:

    >>> float(1000 * axial_slide(0.0, 0.600, 0.0436332))
    1.14268
    """
    slide = np.tan(shaft_angle) * np.sqrt(offset**2 + (float_distance * np.sin(shaft_angle)) ** 2)
    return slide / np.sin(guide_angle)


def driven_inertia_torque(driven_inertia: Quantity, shaft_angle: Quantity, speed: Quantity) -> Quantity:
    """Amplitude of the torque that a stiffly driven inertia asks twice per turn, J2 alpha**2 omega**2.

    Parameters
    ----------
    driven_inertia : scalar, array or symbol
        J2 [kg m2].
    shaft_angle : scalar, array or symbol
        alpha [rad], small.
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        Amplitude [N m].

    References
    ----------
    ext: second derivative of the lead alpha**2/4 sin(2 phi).

    Examples
    --------
    >>> float(driven_inertia_torque(2.0, 0.0436332, 100.0))
    38.077
    """
    return driven_inertia * (shaft_angle * speed) ** 2


def backlash_angle(play: Quantity, arm_radius: Quantity) -> Quantity:
    """Backlash between the shafts from the play in both guides, 2 j/r.

    Parameters
    ----------
    play : scalar, array or symbol
        Play of a roller in its guide j [m].
    arm_radius : scalar, array or symbol
        r [m].

    Returns
    -------
    scalar, array or symbol
        Angle [rad].

    References
    ----------
    ext: each guide gives j/(2 r) to either side.

    Examples
    --------
    >>> float(backlash_angle(0.0001, 0.050))
    0.0040
    """
    return 2 * play / arm_radius


# -- floating masses: refuted ----------------------------------------------------------------------


def refuted_floating_mass(float_mass: Quantity) -> Quantity:
    """Floating mass that is said to balance the float, m0 = m/2: **refuted, do not use**.

    Kept because it is printed. The source adds relative, transport and Coriolis forces by their size; as vectors they
    add to zero, for a mass that rests has no acceleration (floating_mass_forces), and so it balances nothing.

    Parameters
    ----------
    float_mass : scalar, array or symbol
        m [kg].

    Returns
    -------
    scalar, array or symbol
        m0 of each of the two masses as printed [kg].

    References
    ----------
    S3, eq. (29), from 4 m0 e omega**2 = C.

    Examples
    --------
    >>> float(refuted_floating_mass(3.0))
    1.5
    """
    return float_mass / 2


def floating_mass_travel(angle: Quantity, offset: Quantity, speed: Quantity) -> tuple[Quantity, Quantity, Quantity]:
    """Travel, speed and acceleration, in its guide, of a mass at rest on shaft 1.

    s1 = e (1 - cos(phi)), v1 = e omega sin(phi), a1 = e omega**2 cos(phi).

    Parameters
    ----------
    angle : scalar, array or symbol
        phi [rad].
    offset : scalar, array or symbol
        e [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    tuple of scalars, arrays or symbols
        Travel [m], speed [m/s], acceleration [m/s2], relative to the float.

    References
    ----------
    S3, eq. (26), (27), (28). For the mass on shaft 2 sine and cosine change places, and v2 = -e omega cos(phi): its
    (27a) lost the sign.

    Examples
    --------
    >>> tuple(float(x) for x in floating_mass_travel(0.0, 0.010, 100.0))
    (0.0, 0.0, 100.0)
    """
    return (offset * (1 - np.cos(angle)), offset * speed * np.sin(angle), offset * speed**2 * np.cos(angle))


def floating_mass_forces(
    angle: Quantity, mass: Quantity, offset: Quantity, speed: Quantity
) -> tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity], tuple[Quantity, Quantity]]:
    """Relative, transport and Coriolis part of the inertia of a mass at rest on shaft 1, along guides I and II.

    In units of m e omega**2: relative (sin, 0), transport (-sin, 2 cos), Coriolis (0, -2 cos). They add to zero.

    Parameters
    ----------
    angle : scalar, array or symbol
        phi [rad].
    mass : scalar, array or symbol
        m1 [kg].
    offset : scalar, array or symbol
        e [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    tuple of pairs
        Components along the two guides [N].

    References
    ----------
    ext; S3, XIV.2 takes one centre of rotation for the transport part and adds magnitudes.

    Examples
    --------
    >>> parts = floating_mass_forces(0.7, 1.5, 0.010, 100.0)
    >>> float(sum(part[0] for part in parts)), float(sum(part[1] for part in parts))
    (0.0, 0.0)
    """
    unit = mass * offset * speed**2
    along, across = unit * np.sin(angle), unit * np.cos(angle)
    return (along, 0 * along), (-along, 2 * across), (0 * across, -2 * across)
