"""Wrap spring clutch: a helical spring across two hubs that grips them by belt friction.

Every function takes floats, arrays or CasADi symbols. An interference below 0 is a clearance. Hub radius and mean coil
radius are apart here; module ``models`` has the source as printed too.

Source: S2 (Kozma, Molnar, Varadi, Oroszvary, wrap spring clutch), eq. (1)-(22); "derived" marks what is not in it.
"""

from __future__ import annotations

import math

import numpy as np

from ...mechanics import Quantity

# Beyond this exponent the clutch is locked for any practical purpose, and exp() would sooner or later overflow.
LOCKED_BELT_EXPONENT = 50.0
# Arc at a free end that lifts off a rigid hub: root of psi/2 + sin(2 psi)/4 - sin(psi) = 0 [rad].
TIP_ARC = 2.1391821738


# -- geometry --------------------------------------------------------------------------------------


def mean_radius(hub_diameter: Quantity, thickness: Quantity) -> Quantity:
    """Mean radius of the fitted coils, r_m = (d_h + a)/2.

    Parameters
    ----------
    hub_diameter : scalar, array or symbol
        d_h [m].
    thickness : scalar, array or symbol
        Radial wire thickness a [m].

    Returns
    -------
    scalar, array or symbol
        r_m [m].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> mean_radius(0.040, 0.003)
    0.0215
    """
    return (hub_diameter + thickness) / 2


def radius_ratio(hub_diameter: Quantity, thickness: Quantity) -> Quantity:
    """Hub radius over mean coil radius, r_h/r_m = 1/(1 + a/d_h).

    Parameters
    ----------
    hub_diameter : scalar, array or symbol
        d_h [m].
    thickness : scalar, array or symbol
        Radial wire thickness a [m].

    Returns
    -------
    scalar, array or symbol
        r_h/r_m [-].

    References
    ----------
    Geometry; written so that the diameter stands in it once.

    Examples
    --------
    >>> radius_ratio(0.040, 0.003)
    0.93023
    """
    return 1 / (1 + thickness / hub_diameter)


def second_moment(width: Quantity, thickness: Quantity) -> Quantity:
    """Second moment of area of rectangular wire in radial bending, I = b a**3/12.

    Parameters
    ----------
    width : scalar, array or symbol
        Axial wire width b [m].
    thickness : scalar, array or symbol
        Radial wire thickness a [m].

    Returns
    -------
    scalar, array or symbol
        I [m4].

    References
    ----------
    S2 (Kozma et al.), I.

    Examples
    --------
    In mm:

    >>> second_moment(4, 3)
    9.0
    """
    return width * thickness**3 / 12


def total_coils(coils_per_hub: Quantity, gap_coils: Quantity, fixed_coils: Quantity | None = None) -> Quantity:
    """Coils of the spring: 2 n + n_gap, or n + n_gap + n_fix where one end is anchored.

    Parameters
    ----------
    coils_per_hub : scalar, array or symbol
        n [-].
    gap_coils : scalar, array or symbol
        Coils over the gap between the hubs n_gap [-].
    fixed_coils : scalar, array or symbol, optional
        Coils n_fix anchored on the second hub [-]; without it n coils grip there as well.

    Returns
    -------
    scalar, array or symbol
        n_tot [-].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> total_coils(4, 0.5), total_coils(4, 0.5, 1)
    (8.5, 5.5)
    """
    second = coils_per_hub if fixed_coils is None else fixed_coils
    return coils_per_hub + gap_coils + second


def spring_length(coils: Quantity, width: Quantity, coil_gap: Quantity) -> Quantity:
    """Length of the spring, L = n_tot (b + g_c).

    Parameters
    ----------
    coils : scalar, array or symbol
        n_tot [-].
    width : scalar, array or symbol
        Axial wire width b [m].
    coil_gap : scalar, array or symbol
        Axial gap between coils g_c [m].

    Returns
    -------
    scalar, array or symbol
        L [m].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> spring_length(8.5, 0.004, 0.0002)
    0.0357
    """
    return coils * (width + coil_gap)


def spring_mass(
    density: Quantity, width: Quantity, thickness: Quantity, mean_radius: Quantity, coils: Quantity
) -> Quantity:
    """Mass of the spring, rho a b 2 pi r_m n_tot.

    Parameters
    ----------
    density : scalar, array or symbol
        rho of the wire [kg/m3].
    width, thickness : scalar, array or symbol
        b and a [m].
    mean_radius : scalar, array or symbol
        r_m [m].
    coils : scalar, array or symbol
        n_tot [-].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 7850 x 12e-6 x 2 pi 0.0215 x 8.5:

    >>> spring_mass(7850, 0.004, 0.003, 0.0215, 8.5)
    0.10817
    """
    return density * thickness * width * 2 * math.pi * mean_radius * coils


def hub_mass(density: Quantity, hub_diameter: Quantity, bore_diameter: Quantity, length: Quantity) -> Quantity:
    """Mass of both hubs together over the length of the spring, rho pi/4 (d_h - d_bore)(d_h + d_bore) L.

    Parameters
    ----------
    density : scalar, array or symbol
        rho_hub [kg/m3].
    hub_diameter, bore_diameter : scalar, array or symbol
        d_h and d_bore [m].
    length : scalar, array or symbol
        L [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> hub_mass(7850, 0.040, 0.025, 0.0357)
    0.21460
    """
    return density * math.pi / 4 * (hub_diameter - bore_diameter) * (hub_diameter + bore_diameter) * length


def collar_mass(
    density: Quantity, spring_diameter: Quantity, clearance: Quantity, wall: Quantity, length: Quantity
) -> Quantity:
    """Mass of a control collar around the whole spring, rho pi ((r_i + t)**2 - r_i**2) L with r_i = D_s/2 + 2 c.

    Parameters
    ----------
    density : scalar, array or symbol
        rho of the collar [kg/m3].
    spring_diameter : scalar, array or symbol
        Outside of the closed coils D_s [m].
    clearance : scalar, array or symbol
        c between hub and coils; the collar clears the open coils by as much again [m].
    wall : scalar, array or symbol
        Wall of the collar t [m].
    length : scalar, array or symbol
        L of the spring [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry (derived).

    Examples
    --------
    By hand, 7850 pi (0.0252**2 - 0.0222**2) 0.04:

    >>> collar_mass(7850, 0.044, 0.0001, 0.003, 0.04)
    0.14027
    """
    return density * math.pi * wall * (collar_diameter(spring_diameter, clearance, wall) - wall) * length


def collar_diameter(spring_diameter: Quantity, clearance: Quantity, wall: Quantity) -> Quantity:
    """Outside of a control collar, D_s + 4 c + 2 t.

    Parameters
    ----------
    spring_diameter : scalar, array or symbol
        Outside of the closed coils D_s [m].
    clearance : scalar, array or symbol
        c between hub and coils; the collar clears the open coils by as much again [m].
    wall : scalar, array or symbol
        Wall of the collar t [m].

    Returns
    -------
    scalar, array or symbol
        Diameter [m].

    References
    ----------
    Geometry (derived).

    Examples
    --------
    In mm:

    >>> collar_diameter(44, 0.1, 3)
    50.4
    """
    return spring_diameter + 4 * clearance + 2 * wall


# -- the fitted spring -----------------------------------------------------------------------------


def free_radius(interference: Quantity, mean_radius: Quantity) -> Quantity:
    """Mean radius of the free spring as it enters the curvature, r_m - dr.

    Parameters
    ----------
    interference : scalar, array or symbol
        dr at the mean radius, below 0 for a clearance [m].
    mean_radius : scalar, array or symbol
        r_m of the fitted spring [m]; above dr.

    Returns
    -------
    scalar, array or symbol
        Free mean radius [m].

    References
    ----------
    S2 (Kozma et al.), figure of the preload; d_free = d - 2 dr.

    Examples
    --------
    >>> 1000 * free_radius(0.00025, 0.0215)
    21.25
    """
    # Through the ratio dr/r_m, which a limit bounds: so the search knows the free radius to be positive.
    return mean_radius * (1 - interference / mean_radius)


def curvature_change(interference: Quantity, mean_radius: Quantity, free_radius: Quantity) -> Quantity:
    """Curvature change of the fitted wire, dk = dr/(r_m r_free), the exact 1/r_free - 1/r_m.

    Parameters
    ----------
    interference : scalar, array or symbol
        dr at the mean radius, below 0 for a clearance [m].
    mean_radius : scalar, array or symbol
        r_m of the fitted spring [m].
    free_radius : scalar, array or symbol
        As `free_radius` gives it for the model [m].

    Returns
    -------
    scalar, array or symbol
        dk [1/m].

    References
    ----------
    S2 (Kozma et al.), eq. (4), dr/r**2, for small dr; refined: exact (derived).

    Examples
    --------
    >>> curvature_change(0.00025, 0.0215, free_radius(0.00025, 0.0215))
    0.54719
    """
    return interference / (mean_radius * free_radius)


def interference_for(curvature: Quantity, mean_radius: Quantity) -> Quantity:
    """Interference that gives a curvature change, dr = dk r_m**2/(1 + dk r_m).

    Parameters
    ----------
    curvature : scalar, array or symbol
        dk [1/m].
    mean_radius : scalar, array or symbol
        r_m [m].

    Returns
    -------
    scalar, array or symbol
        dr [m].

    References
    ----------
    Inverse of `curvature_change` (derived).

    Examples
    --------
    >>> 1000 * interference_for(curvature_change(0.00025, 0.0215, 0.02125), 0.0215)
    0.25
    """
    return curvature * mean_radius * mean_radius / (1 + curvature * mean_radius)


def bending_moment(elastic_modulus: Quantity, width: Quantity, thickness: Quantity, curvature: Quantity) -> Quantity:
    """Bending moment of the fitted wire, M = E I dk.

    Parameters
    ----------
    elastic_modulus : scalar, array or symbol
        E [Pa].
    width, thickness : scalar, array or symbol
        b and a of the wire [m].
    curvature : scalar, array or symbol
        dk [1/m]; below 0 for a clearance.

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S2 (Kozma et al.), eq. (4).

    Examples
    --------
    >>> bending_moment(206e9, 0.004, 0.003, 0.00025 / 0.02**2)
    1.15875
    """
    return elastic_modulus * second_moment(width, thickness) * curvature


def tightened_moment(
    moment: Quantity, interference: Quantity, growth: Quantity, free_radius: Quantity, tightened_radius: Quantity
) -> Quantity:
    """Bending moment after the interference has grown by g, M (dr + g)/dr r_free/r_free'.

    It says what `bending_moment` says, but in terms of the smaller moment: a bound on that one is a bound on this one,
    whatever wire and hub, and the search needs that.

    Parameters
    ----------
    moment : scalar, array or symbol
        M with the smaller interference [N m].
    interference : scalar, array or symbol
        The smaller interference dr [m]; above 0.
    growth : scalar, array or symbol
        g [m].
    free_radius, tightened_radius : scalar, array or symbol
        Free radius before and after, as `free_radius` gives it [m].

    Returns
    -------
    scalar, array or symbol
        M with the larger interference [N m].

    References
    ----------
    Quotient of S2 (Kozma et al.), eq. (4), at both interferences.

    Examples
    --------
    >>> tightened_moment(1.15875, 0.00025, 0.00005, 0.02, 0.02)
    1.3905
    """
    return moment * (1 + growth / interference) * (free_radius / tightened_radius)


def bending_stress(moment: Quantity, width: Quantity, thickness: Quantity) -> Quantity:
    """Bending stress of the fitted wire, sigma_b = M a/(2 I) = 6 M/(b a**2).

    Parameters
    ----------
    moment : scalar, array or symbol
        Size of the bending moment M [N m].
    width, thickness : scalar, array or symbol
        b and a of the wire [m].

    Returns
    -------
    scalar, array or symbol
        sigma_b [Pa].

    References
    ----------
    S2 (Kozma et al.), eq. (8), which writes E a dr/(2 r**2) with M of its (4).

    Examples
    --------
    >>> bending_stress(1.15875, 0.004, 0.003) / 1e6
    193.125
    """
    return 6 * moment / (width * thickness**2)


def contact_pressure(moment: Quantity, width: Quantity, hub_radius: Quantity, mean_radius: Quantity) -> Quantity:
    """Pressure of the wire on the hub, p = (M + T)/(b r_h r_m).

    Parameters
    ----------
    moment : scalar, array or symbol
        Bending moment M of the fitted wire alone for the preload, with the torque T of the section added for the loaded
        wire [N m].
    width : scalar, array or symbol
        Axial wire width b [m].
    hub_radius, mean_radius : scalar, array or symbol
        r_h and r_m [m].

    Returns
    -------
    scalar, array or symbol
        p [Pa].

    References
    ----------
    S2 (Kozma et al.), eq. (6) for the preload. Its (22), p_max = F/(b r) = p (exp(mu alpha) - 1), is low by exactly p,
    because F is the tension beyond the preload; at the slip limit p_max = p exp(mu alpha). Derived from the balance of
    a piece of wire: tension N on the radius r presses with N/(b r), and N r_m = M + T.

    Examples
    --------
    >>> contact_pressure(1.15875, 0.004, 0.02, 0.02)
    724218.75
    """
    return moment / (width * hub_radius * mean_radius)


def axial_friction_force(
    mu: Quantity, pressure: Quantity, hub_radius: Quantity, width: Quantity, coils: Quantity
) -> Quantity:
    """Axial force that the preloaded coils hold, F_S = mu p 2 pi r_h b n.

    Parameters
    ----------
    mu : scalar, array or symbol
        Friction coefficient [-].
    pressure : scalar, array or symbol
        Pressure of the preload p [Pa].
    hub_radius : scalar, array or symbol
        r_h [m].
    width : scalar, array or symbol
        Axial wire width b [m].
    coils : scalar, array or symbol
        n [-].

    Returns
    -------
    scalar, array or symbol
        F_S [N].

    References
    ----------
    S2 (Kozma et al.), eq. (7), whose print lacks mu.

    Examples
    --------
    >>> axial_friction_force(0.1, 589826, 0.02, 0.004, 4)
    118.59
    """
    return mu * pressure * 2 * math.pi * hub_radius * width * coils


# -- belt friction ---------------------------------------------------------------------------------


def belt_exponent(mu: Quantity, coils: Quantity, radius_ratio: Quantity) -> Quantity:
    """Belt exponent, beta = mu 2 pi n r_h/r_m.

    Parameters
    ----------
    mu : scalar, array or symbol
        Friction coefficient [-].
    coils : scalar, array or symbol
        Coils on one hub n [-].
    radius_ratio : scalar, array or symbol
        r_h/r_m [-].

    Returns
    -------
    scalar, array or symbol
        beta [-].

    References
    ----------
    S2 (Kozma et al.), mu alpha in (18); the ratio of the radii is derived: friction acts at the hub, tension at the
    mean radius.

    Examples
    --------
    >>> belt_exponent(0.1, 4, 1.0)
    2.51327
    """
    return mu * 2 * math.pi * coils * radius_ratio


def centrifugal_moment(
    density: Quantity, width: Quantity, thickness: Quantity, mean_radius: Quantity, speed: Quantity
) -> Quantity:
    """Part of the moment that the spinning wire carries itself, N_c r_m = rho a b r_m**3 omega**2.

    Parameters
    ----------
    density : scalar, array or symbol
        rho of the wire [kg/m3].
    width, thickness : scalar, array or symbol
        b and a [m].
    mean_radius : scalar, array or symbol
        r_m [m].
    speed : scalar, array or symbol
        Speed of the spring omega_s [rad/s].

    Returns
    -------
    scalar, array or symbol
        N_c r_m [N m]; what is left of M presses on the hub.

    References
    ----------
    Hoop tension of a spinning ring (derived; not in S2).

    Examples
    --------
    At the lift-off speed it is the bending moment:

    >>> centrifugal_moment(7850, 0.004, 0.003, 0.0215, 1040.98)
    1.01449
    """
    return density * thickness * width * mean_radius**3 * speed**2


def liftoff_speed(
    moment: Quantity, density: Quantity, width: Quantity, thickness: Quantity, mean_radius: Quantity
) -> Quantity:
    """Speed at which the spring lifts off its hub, omega_lift = sqrt(M/(rho a b r_m**3)).

    Parameters
    ----------
    moment : scalar, array or symbol
        Bending moment M of the fitted wire [N m]; above 0.
    density : scalar, array or symbol
        rho of the wire [kg/m3].
    width, thickness : scalar, array or symbol
        b and a [m].
    mean_radius : scalar, array or symbol
        r_m [m].

    Returns
    -------
    scalar, array or symbol
        omega_lift [rad/s].

    References
    ----------
    Centrifugal moment equal to the bending moment, E a**2 dk/(12 rho r_m**3) (derived; not in S2).

    Examples
    --------
    >>> float(liftoff_speed(1.0144995, 7850, 0.004, 0.003, 0.0215))
    1040.98
    """
    return np.sqrt(moment / (density * thickness * width * mean_radius**3))


def closing_torque(moment: Quantity, belt_exponent: Quantity, actuator_torque: Quantity = 0.0) -> Quantity:
    """Torque at which the closing clutch slips, T_c = T0 + (T0 + M) (exp(beta) - 1).

    Parameters
    ----------
    moment : scalar, array or symbol
        Bending moment less the centrifugal moment [N m]; below 0 for a clearance.
    belt_exponent : scalar, array or symbol
        beta [-]; counts up to 50, beyond which nothing slips.
    actuator_torque : scalar, array or symbol
        Energising torque T0 at the free end [N m].

    Returns
    -------
    scalar, array or symbol
        T_c [N m]; with T0 + M <= 0 there is no grip and it means nothing.

    References
    ----------
    S2 (Kozma et al.), eq. (18)-(20) for T0 = 0: the bending moment times (exp(mu alpha) - 1). T0 is derived.

    Examples
    --------
    >>> float(closing_torque(1.15875, belt_exponent(0.1, 4, 1.0)))
    13.1463
    """
    gain = np.expm1(np.minimum(belt_exponent, LOCKED_BELT_EXPONENT))
    return actuator_torque + (actuator_torque + moment) * gain


def opening_torque(moment: Quantity, belt_exponent: Quantity) -> Quantity:
    """Torque of the overrunning clutch, T_o = M (1 - exp(-beta)).

    Parameters
    ----------
    moment : scalar, array or symbol
        Bending moment less the centrifugal moment [N m].
    belt_exponent : scalar, array or symbol
        beta [-].

    Returns
    -------
    scalar, array or symbol
        T_o [N m]; never above the moment.

    References
    ----------
    S2 (Kozma et al.), eq. (15) with friction reversed. Its (21), T_o = M, is the limit for a large exponent: at 2.5 it
    is 8.9 % too high, and the text "exp(mu alpha) is taken as zero" should read exp(-mu alpha).

    Examples
    --------
    >>> float(opening_torque(1.15875, belt_exponent(0.1, 4, 1.0)))
    1.06489
    """
    return -moment * np.expm1(-belt_exponent)


def actuator_torque_for(torque: Quantity, moment: Quantity, belt_exponent: Quantity) -> Quantity:
    """Energising torque with which the clutch slips at a torque, T0 = T exp(-beta) - M (1 - exp(-beta)).

    Parameters
    ----------
    torque : scalar, array or symbol
        Demand T [N m].
    moment : scalar, array or symbol
        Bending moment less the centrifugal moment [N m]; below 0 for a clearance, so that both terms are positive.
    belt_exponent : scalar, array or symbol
        beta [-].

    Returns
    -------
    scalar, array or symbol
        T0 [N m].

    References
    ----------
    Inverse of `closing_torque` (derived; S2 announces the clearance fit and leaves it to the reader).

    Examples
    --------
    >>> float(closing_torque(-0.4, 2.5, actuator_torque_for(20, -0.4, 2.5)))
    20.0
    """
    return torque * np.exp(-belt_exponent) + moment * np.expm1(-belt_exponent)


def wire_tension(moment: Quantity, mean_radius: Quantity) -> Quantity:
    """Total tension of the wire, N = (M + T)/r_m.

    Parameters
    ----------
    moment : scalar, array or symbol
        Bending moment M and torque T of the section together [N m].
    mean_radius : scalar, array or symbol
        r_m [m].

    Returns
    -------
    scalar, array or symbol
        N [N].

    References
    ----------
    Balance about the hub axis (derived): without friction N r_m - M = 0; F of S2 is T/r.

    Examples
    --------
    >>> wire_tension(1.0145, 0.0215)
    47.186
    """
    return moment / mean_radius


def wire_stress(bending_stress: Quantity, tension: Quantity, width: Quantity, thickness: Quantity) -> Quantity:
    """Stress of the most loaded fibre, sigma = sigma_b + N/(a b).

    Parameters
    ----------
    bending_stress : scalar, array or symbol
        Size of the bending stress [Pa].
    tension : scalar, array or symbol
        Total tension N [N].
    width, thickness : scalar, array or symbol
        b and a [m].

    Returns
    -------
    scalar, array or symbol
        sigma [Pa]; inner fibre of an interference fit, outer fibre of a clearance fit.

    References
    ----------
    S2 (Kozma et al.), eq. (8) with the tension of the loaded coil added, which S2's abstract calls for.

    Examples
    --------
    >>> wire_stress(193.125e6, 500.0, 0.004, 0.003) / 1e6
    234.79
    """
    return bending_stress + tension / (thickness * width)


def goodman_utilisation(
    safety: Quantity,
    least_stress: Quantity,
    largest_stress: Quantity,
    endurance_amplitude: Quantity,
    tensile_strength: Quantity,
) -> Quantity:
    """Fatigue after Goodman, S_F (sigma_a/S_e + sigma_m/R_m); at most 1.

    Parameters
    ----------
    safety : scalar, array or symbol
        S_F [-].
    least_stress, largest_stress : scalar, array or symbol
        Ends of the stress cycle [Pa].
    endurance_amplitude : scalar, array or symbol
        S_e [Pa].
    tensile_strength : scalar, array or symbol
        R_m [Pa].

    Returns
    -------
    scalar, array or symbol
        Utilisation [-].

    References
    ----------
    Goodman's straight line (any textbook of machine elements; not in S2).

    Examples
    --------
    >>> goodman_utilisation(1.2, 200e6, 400e6, 400e6, 1400e6)
    0.55714
    """
    amplitude = (largest_stress - least_stress) / 2
    mean = (largest_stress + least_stress) / 2
    return safety * (amplitude / endurance_amplitude + mean / tensile_strength)


def tang_stress(
    actuator_torque: Quantity, mean_radius: Quantity, thickness: Quantity, length_ratio: Quantity
) -> Quantity:
    """Bending stress of the tang that holds the free end, 6 F_t l_t/(b a**2) with F_t = T0/r_m and l_t = k_t b.

    Parameters
    ----------
    actuator_torque : scalar, array or symbol
        T0 [N m].
    mean_radius : scalar, array or symbol
        r_m, at which the tang is held [m].
    thickness : scalar, array or symbol
        Radial wire thickness a [m].
    length_ratio : scalar, array or symbol
        Length of the tang over the width of the wire k_t [-].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa].

    References
    ----------
    Bending of a cantilever (derived).

    Examples
    --------
    By hand, a tang of 3 mm wide, 2 mm thick wire held by 50 N at 6 mm:

    >>> tang_stress(1.0, 0.02, 0.002, 2)
    150000000.0
    """
    return 6 * length_ratio * (actuator_torque / mean_radius) / thickness**2


# -- elasticity ------------------------------------------------------------------------------------


def slip_arc(torque: Quantity, moment: Quantity, friction: Quantity) -> Quantity:
    """Arc, counted from the gap, over which the loaded wire slips, alpha_s = ln(1 + T/M)/mu'.

    Parameters
    ----------
    torque : scalar, array or symbol
        Torque T carried [N m].
    moment : scalar, array or symbol
        Bending moment M of the fitted wire [N m]; above 0.
    friction : scalar, array or symbol
        mu' = mu r_h/r_m [-].

    Returns
    -------
    scalar, array or symbol
        alpha_s [rad]; the coils beyond it are a reserve.

    References
    ----------
    Belt equation (derived; not in S2): the tension falls to that of the preload.

    Examples
    --------
    At the slip limit all four coils slip:

    >>> round(float(slip_arc(13.1463, 1.15875, 0.1)) / (2 * math.pi), 4)
    4.0
    """
    return np.log1p(torque / moment) / friction


def windup_angle(
    torque: Quantity,
    moment: Quantity,
    friction: Quantity,
    mean_radius: Quantity,
    wire_stiffness: Quantity,
    gap_coils: Quantity,
) -> Quantity:
    """Angle by which one hub turns against the other until a torque is carried.

    theta = (2 ((N_L - N_0)/mu' - N_0 alpha_s) + 2 pi n_gap (N_L - N_0))/(E a b), with N_L = (M + T)/r_m, N_0 = M/r_m.

    Parameters
    ----------
    torque : scalar, array or symbol
        Torque T carried [N m]; at most the closing torque.
    moment : scalar, array or symbol
        Bending moment M of the fitted wire [N m]; above 0.
    friction : scalar, array or symbol
        mu' = mu r_h/r_m [-].
    mean_radius : scalar, array or symbol
        r_m [m].
    wire_stiffness : scalar, array or symbol
        E a b [N].
    gap_coils : scalar, array or symbol
        Coils over the gap n_gap [-].

    Returns
    -------
    scalar, array or symbol
        theta [rad].

    References
    ----------
    Elongation of the slipping arcs and of the coils over the gap (derived; not in S2).

    Examples
    --------
    >>> 1000 * float(windup_angle(5.0, 1.0145, 0.093023, 0.0215, 206e9 * 12e-6, 0.5))
    1.5878
    """
    excess = torque / mean_radius
    slipping = excess / friction - moment / mean_radius * slip_arc(torque, moment, friction)
    return (2 * slipping + 2 * math.pi * gap_coils * excess) / wire_stiffness


def wrap_angle(coils: Quantity, clearance: Quantity, mean_radius: Quantity) -> Quantity:
    """Angle by which the free end must turn until a clearance is closed, phi = 2 pi n c/r_m.

    Parameters
    ----------
    coils : scalar, array or symbol
        Coils that have to close [-].
    clearance : scalar, array or symbol
        c at the mean radius [m].
    mean_radius : scalar, array or symbol
        r_m of the closed coils [m].

    Returns
    -------
    scalar, array or symbol
        phi [rad].

    References
    ----------
    The length of the wire stays (derived; not in S2).

    Examples
    --------
    >>> wrap_angle(4.5, 0.08e-3, 0.0215)
    0.10521
    """
    return 2 * math.pi * coils * clearance / mean_radius


def engagement_peak_torque(speed_difference: Quantity, inertia: Quantity, stiffness: Quantity) -> Quantity:
    """Peak torque when a running clutch closes on a mass at rest, T = d_omega sqrt(J k).

    Parameters
    ----------
    speed_difference : scalar, array or symbol
        d_omega [rad/s].
    inertia : scalar, array or symbol
        J behind the clutch [kg m2].
    stiffness : scalar, array or symbol
        Secant k = T/theta of the wind-up [N m/rad].

    Returns
    -------
    scalar, array or symbol
        T [N m]; the slip torque where that is smaller.

    References
    ----------
    Energy of one swing (derived; not in S2).

    Examples
    --------
    >>> float(engagement_peak_torque(100, 0.0001, 2500))
    50.0
    """
    return speed_difference * np.sqrt(inertia * stiffness)


# -- hub and heat ----------------------------------------------------------------------------------


def hub_shear_stress(torque: Quantity, hub_diameter: Quantity, bore_diameter: Quantity) -> Quantity:
    """Shear stress of the hub in torsion, tau = 16 T d_h/(pi (d_h**4 - d_bore**4)).

    Parameters
    ----------
    torque : scalar, array or symbol
        T [N m].
    hub_diameter, bore_diameter : scalar, array or symbol
        d_h and d_bore [m]; d_h the larger.

    Returns
    -------
    scalar, array or symbol
        tau [Pa].

    References
    ----------
    Torsion of a tube (any textbook).

    Examples
    --------
    >>> hub_shear_stress(100, 0.040, 0.025) / 1e6
    9.3906
    """
    # The diameter stands outside and inside with the same sense, so that a range of it gives no wider result.
    return 16 * torque / (math.pi * hub_diameter**3 * (1 - (bore_diameter / hub_diameter) ** 4))


def overrun_pv(pressure: Quantity, speed: Quantity, hub_radius: Quantity) -> Quantity:
    """Pressure times sliding speed when overrunning, p omega r_h.

    Parameters
    ----------
    pressure : scalar, array or symbol
        Pressure of the preload [Pa].
    speed : scalar, array or symbol
        Overrun speed [rad/s].
    hub_radius : scalar, array or symbol
        r_h [m].

    Returns
    -------
    scalar, array or symbol
        pv [W/m2].

    References
    ----------
    Definition; the pressure is largest at the free end.

    Examples
    --------
    In W/mm2:

    >>> overrun_pv(0.59, 100, 0.02)
    1.18
    """
    return pressure * speed * hub_radius


def overrun_temperature_rise(
    torque: Quantity,
    speed: Quantity,
    duty: Quantity,
    heat_transfer: Quantity,
    outer_diameter: Quantity,
    length: Quantity,
) -> Quantity:
    """Steady rise over ambient when overrunning, T_o omega duty/(h pi D_o L).

    Parameters
    ----------
    torque : scalar, array or symbol
        Drag T_o [N m].
    speed : scalar, array or symbol
        Overrun speed [rad/s].
    duty : scalar, array or symbol
        Part of the time spent overrunning [-].
    heat_transfer : scalar, array or symbol
        h [W/(m2 K)].
    outer_diameter, length : scalar, array or symbol
        D_o and L of the cooled cylinder [m].

    Returns
    -------
    scalar, array or symbol
        Rise [K].

    References
    ----------
    Lumped heat balance (derived; not in S2).

    Examples
    --------
    >>> overrun_temperature_rise(0.9, 100, 0.2, 25, 0.046, 0.0357)
    139.56
    """
    return torque * speed * duty / (heat_transfer * math.pi * outer_diameter * length)


def overrun_life(
    depth: Quantity, wear_rate: Quantity, friction: Quantity, rubbing: Quantity, duty: Quantity
) -> Quantity:
    """Time until the hubs are worn, d_w/(k_w mu p v duty).

    Parameters
    ----------
    depth : scalar, array or symbol
        Wear before replacement d_w [m].
    wear_rate : scalar, array or symbol
        Volume worn off per friction work k_w [m3/J]; 1 mm3/MJ is 1e-15 m3/J.
    friction : scalar, array or symbol
        mu [-].
    rubbing : scalar, array or symbol
        Pressure times sliding speed when overrunning p v [W/m2].
    duty : scalar, array or symbol
        Part of the time spent overrunning [-].

    Returns
    -------
    scalar, array or symbol
        Time in service [s].

    References
    ----------
    Wear volume in proportion to friction work (Archard); derived.

    Examples
    --------
    By hand, 0.03 mm worn by 5 mm3/MJ at 0.1 x 0.1 W/mm2 for a fifth of the time, 833.33 h:

    >>> overrun_life(0.03e-3, 5e-15, 0.1, 0.1e6, 0.2) / 3600
    833.333
    """
    return depth / (wear_rate * friction * rubbing * duty)


# -- what an expert also checks --------------------------------------------------------------------


def curved_bar_factor(spring_index: Quantity) -> Quantity:
    """Factor on the bending stress of the inner fibre of a curved rectangular bar, (3 C**2 - C - 0.8)/(3 C (C - 1)).

    Parameters
    ----------
    spring_index : scalar, array or symbol
        C = 2 r_m/a [-].

    Returns
    -------
    scalar, array or symbol
        K_i [-].

    References
    ----------
    Wahl, Mechanical Springs, torsion springs of rectangular wire; Winkler-Bach's exact bar gives 1.09046 at C = 8.

    Examples
    --------
    >>> curved_bar_factor(8)
    1.09048
    """
    return (3 * spring_index**2 - spring_index - 0.8) / (3 * spring_index * (spring_index - 1))


def keystone_growth(poisson_ratio: Quantity, width: Quantity, thickness: Quantity, mean_radius: Quantity) -> Quantity:
    """Growth of the axial width at the inner edge when a straight wire is coiled, nu a b/(2 r_m).

    Parameters
    ----------
    poisson_ratio : scalar, array or symbol
        nu [-]; 0.5 for plastic coiling.
    width, thickness : scalar, array or symbol
        b and a [m].
    mean_radius : scalar, array or symbol
        r_m [m].

    Returns
    -------
    scalar, array or symbol
        Growth [m]; the gap between coils must be larger.

    References
    ----------
    Anticlastic bending (any textbook on strength of materials).

    Examples
    --------
    In mm:

    >>> keystone_growth(0.3, 4, 3, 21.5)
    0.083721
    """
    return poisson_ratio * width * thickness / (2 * mean_radius)


def tip_coil_loss() -> float:
    """Coils that do not grip at a free end, because its tip presses alone.

    Returns
    -------
    float
        Coils per free end [-].

    References
    ----------
    Curved beam on a rigid cylinder without friction (derived; not in S2): the last 2.13918 rad lift off and press with
    1.8253 M/r in all, where the uniform model counts 2.1392 M/r.

    Examples
    --------
    >>> tip_coil_loss()
    0.04996
    """
    # The tip presses with 1/sin(psi), the point of lift-off with -cos(psi)/sin(psi); together tan(psi/2).
    return (TIP_ARC - math.tan(TIP_ARC / 2)) / (2 * math.pi)
