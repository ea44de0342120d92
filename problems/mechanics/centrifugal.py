"""Centrifugal clutches: what ball ramps, levers, spring sets, linings and envelopes have in common.

Every function takes floats, arrays or CasADi symbols. Masses, rates and preloads are those of all flyweights and of all
springs of a set together. The transmission i is radial travel over axial travel, dr/dx: the tangent of the ramp angle
measured from the shaft axis, or the ratio of two lever arms.

Sources: S4 (notes on centrifugal clutches); friction at the balls, limits and sizes are extensions of it.
"""

from __future__ import annotations

import numpy as np

from synth.special import special

from . import Quantity

__all__ = [
    "COVER",
    "FURTHER_CORE",
    "FURTHER_PLATE",
    "STANDARD_GRAVITY",
    "axial_force",
    "axial_gain",
    "ball_pressure",
    "ball_set_mass",
    "centrifugal_force",
    "clutch_inertia",
    "contact_loss",
    "engagement_energy",
    "force_for_torque",
    "further_discs_mass",
    "gravity_ratio",
    "inward_efficiency",
    "lining_area",
    "lining_pressure",
    "lining_radius",
    "orbit_radius",
    "outside_diameter",
    "outward_efficiency",
    "overall_length",
    "plates_mass",
    "ramp_angle",
    "ramp_gain",
    "ramp_normal_force",
    "release_ratio",
    "rim_stress",
    "series_rate",
    "set_rate",
    "speed_for_force",
    "speed_ratio",
    "spring_bow_load",
    "spring_force",
    "weight_thickness",
]

STANDARD_GRAVITY = 9.80665  # [m/s2]
# What a clutch has beyond the two surfaces that the thickness of all plates is for: engineering practice.
FURTHER_PLATE = 6e-3  # plate between two friction discs [m]
FURTHER_CORE = 2e-3  # core of a friction disc [m]
COVER = 5e-3  # cover over the flyweights [m]


# -- flyweights -------------------------------------------------------------------------------------


def centrifugal_force(mass: Quantity, radius: Quantity, speed: Quantity) -> Quantity:
    """Centrifugal force of all flyweights together.

    Equation: F_C = m r omega**2

    Parameters
    ----------
    mass : scalar, array or symbol
        Total mass of the flyweights m [kg].
    radius : scalar, array or symbol
        Radius of their centres r [m].
    speed : scalar, array or symbol
        Speed of the flyweight carrier omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        F_C [N].

    References
    ----------
    S4 (notes on centrifugal clutches), the force on the balls.

    Examples
    --------
    S4, practice 3 (1 kg at 152 mm, 62.8281 rad/s; 600 N):

    >>> centrifugal_force(1.0, 0.152, 62.8281)
    600.00
    """
    return mass * radius * speed**2


def orbit_radius(rest_radius: Quantity, ratio: Quantity, travel: Quantity) -> Quantity:
    """Radius of the flyweights after some travel.

    Equation: r = r0 + i x

    Parameters
    ----------
    rest_radius : scalar, array or symbol
        Radius of the flyweight centres at rest r0 [m].
    ratio : scalar, array or symbol
        Transmission i = dr/dx [-].
    travel : scalar, array or symbol
        Axial travel x [m]; for a lever with i as its arm its angle in rad.

    Returns
    -------
    scalar, array or symbol
        r [m].

    References
    ----------
    S4, analysis 1, eq. (5) and (8): x = (r - r0)/tan(alpha).

    Examples
    --------
    S4, practice 1 (contact after 11.5 mm on a ramp with tan 60 degrees), computed here in mm:

    >>> 1000 * orbit_radius(0.18, 3**0.5, 0.0115)
    199.919
    """
    return rest_radius + ratio * travel


def ramp_angle(ratio: Quantity) -> Quantity:
    """Angle of a ramp from the shaft axis.

    Equation: alpha = arctan(i)

    Parameters
    ----------
    ratio : scalar, array or symbol
        Transmission of the ramp i = dr/dx [-].

    Returns
    -------
    scalar, array or symbol
        alpha [rad], measured from the shaft axis.

    References
    ----------
    S4, analysis 1: tan(alpha) = (r - r0)/x.

    Examples
    --------
    60 degrees, as in S4, practice 1:

    >>> float(np.degrees(ramp_angle(3**0.5)))
    60.000
    """
    return np.arctan(ratio)


def contact_loss(ball_friction: Quantity, ratio: Quantity) -> Quantity:
    """Share that friction at the balls takes.

    Equation: c_b = mu_b (i + sqrt(1 + i**2))

    Parameters
    ----------
    ball_friction : scalar, array or symbol
        Friction at the contacts of a ball mu_b [-].
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].

    Returns
    -------
    scalar, array or symbol
        c_b [-].

    Notes
    -----
    A ball between ramp and plate cannot roll on both. At the speed v along the ramp it slips with v (1 + sin(alpha))
    wherever it slips, and does so at the plate, where the normal force F is the smaller one (F/sin(alpha) at the ramp).
    Power going out: F_C v sin(alpha) = F v cos(alpha) + mu_b F v (1 + sin(alpha)); divided by F v cos(alpha),
    F_C i/F = 1 + mu_b (1 + sin(alpha))/cos(alpha) = 1 + c_b.

    References
    ----------
    Derived; not in S4, which has no friction at the balls.

    Examples
    --------
    Computed here, a ramp of 45 degrees: 0.03 (1 + 1.41421):

    >>> float(contact_loss(0.03, 1.0))
    0.072426
    """
    return ball_friction * (ratio + np.sqrt(1 + ratio**2))


def outward_efficiency(loss: Quantity) -> Quantity:
    """Axial force over F_C i while the balls move out.

    Equation: eta_out = 1/(1 + c_b)

    Parameters
    ----------
    loss : scalar, array or symbol
        Share of the friction at the contacts c_b [-].

    Returns
    -------
    scalar, array or symbol
        eta_out [-].

    References
    ----------
    Derived; not in S4.

    Examples
    --------
    Computed here, mu_b = 0.03 on a ramp of 45 degrees:

    >>> float(outward_efficiency(contact_loss(0.03, 1.0)))
    0.932465
    """
    return 1 / (1 + loss)


def inward_efficiency(loss: Quantity) -> Quantity:
    """Axial force over F_C i while the balls move in.

    Equation: eta_in = 1/(1 - c_b)

    Parameters
    ----------
    loss : scalar, array or symbol
        Share of the friction at the contacts c_b [-], below 1.

    Returns
    -------
    scalar, array or symbol
        eta_in [-].

    Notes
    -----
    From c_b = 1 on the balls do not come back by themselves: the ramp locks.

    References
    ----------
    Derived; not in S4.

    Examples
    --------
    Computed here, mu_b = 0.03 on a ramp of 45 degrees:

    >>> float(inward_efficiency(contact_loss(0.03, 1.0)))
    1.078082
    """
    return 1 / (1 - loss)


@special((0.0, 1.0), (-1.0, 0.0), curvature="log-concave")
def ramp_gain(ratio: Quantity, ball_friction: Quantity) -> Quantity:
    """Axial over centrifugal force of balls that move out.

    Equation: i eta_out = i/(1 + mu_b (i + sqrt(1 + i**2)))

    Parameters
    ----------
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].
    ball_friction : scalar, array or symbol
        Friction at the contacts of a ball mu_b [-].

    Returns
    -------
    scalar, array or symbol
        i eta_out [-].

    Notes
    -----
    One node of the trace, so that the search knows that a steeper ramp always pushes harder.

    References
    ----------
    Derived; S4, analysis 1, eq. (4) without friction: tan(alpha).

    Examples
    --------
    Computed here, the product of the two:

    >>> float(ramp_gain(1.0, 0.03))
    0.932465
    """
    return ratio / (1 + ball_friction * (ratio + np.sqrt(1 + ratio**2)))


def release_ratio(loss: Quantity) -> Quantity:
    """Speed at which balls let go over that at which they took hold.

    Equation: omega_release/omega_contact = sqrt((1 - c_b)/(1 + c_b))

    Parameters
    ----------
    loss : scalar, array or symbol
        Share of the friction at the contacts c_b [-], below 1.

    Returns
    -------
    scalar, array or symbol
        Release speed over contact speed [-].

    Notes
    -----
    The same force at the same radius, so that the speeds go with 1/sqrt(eta): (1 - c_b)/(1 + c_b) = 2/(1 + c_b) - 1,
    written so that c_b stands once. No design has a larger idle margin than contact_speed_max/idle_speed times this.

    References
    ----------
    Derived; not in S4, which has no friction at the balls.

    Examples
    --------
    Computed here, mu_b = 0.03 on a ramp of 45 degrees: sqrt(0.927574/1.072426):

    >>> float(release_ratio(contact_loss(0.03, 1.0)))
    0.93002
    """
    return np.sqrt(2 / (1 + loss) - 1)


def axial_force(centrifugal_force: Quantity, ratio: Quantity, efficiency: Quantity = 1.0) -> Quantity:
    """Axial force that the flyweights exert.

    Equation: F = F_C i eta

    Parameters
    ----------
    centrifugal_force : scalar, array or symbol
        F_C [N].
    ratio : scalar, array or symbol
        Transmission i = dr/dx [-].
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-]: eta_out going out, eta_in coming in.

    Returns
    -------
    scalar, array or symbol
        F [N].

    References
    ----------
    S4, analysis 1, eq. (4) and (11), there without friction; virtual work F_C dr = F dx.

    Examples
    --------
    S4, practice 1 (48.5 N at contact on tan 60 degrees; 84 N):

    >>> axial_force(48.4974, 3**0.5)
    84.000
    """
    return centrifugal_force * ratio * efficiency


def axial_gain(mass: Quantity, radius: Quantity, ratio: Quantity = 1.0, efficiency: Quantity = 1.0) -> Quantity:
    """Axial force over the square of the speed.

    Equation: g = m i eta r

    Parameters
    ----------
    mass : scalar, array or symbol
        Total mass of the flyweights m [kg].
    radius : scalar, array or symbol
        Radius of their centres r [m].
    ratio : scalar, array or symbol, optional
        Transmission i = dr/dx [-]; 1 for a force at the flyweights themselves.
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-].

    Returns
    -------
    scalar, array or symbol
        g [kg m].

    References
    ----------
    S4, analysis 1, eq. (4): F = g omega**2.

    Examples
    --------
    S4, practice 1 (1 kg at 199.919 mm, tan 60 degrees; 84 N at 15.5752 rad/s):

    >>> axial_gain(1.0, 0.199919, 3**0.5) * 15.5752**2
    84.000
    """
    return mass * ratio * efficiency * radius


def speed_for_force(
    force: Quantity, mass: Quantity, radius: Quantity, ratio: Quantity = 1.0, efficiency: Quantity = 1.0
) -> Quantity:
    """Speed at which the flyweights exert a force.

    Equation: omega = sqrt(F/(m i eta r))

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force F [N].
    mass : scalar, array or symbol
        Total mass of the flyweights m [kg].
    radius : scalar, array or symbol
        Radius of their centres r [m].
    ratio : scalar, array or symbol, optional
        Transmission i = dr/dx [-]; 1 for a force at the flyweights themselves.
    efficiency : scalar, array or symbol, optional
        Axial force over F_C i, eta [-].

    Returns
    -------
    scalar, array or symbol
        omega [rad/s].

    Notes
    -----
    The closed form for every border of a regime: force and radius are known there, the speed follows. The explicit
    forms x(omega) of S4 are singular where the flyweights snap and are not needed.

    References
    ----------
    S4, analysis 1, eq. (4), solved for omega.

    Examples
    --------
    S4, practice 1 (84 N at 199.919 mm, 1 kg, tan 60 degrees; 15.5752 rad/s):

    >>> float(speed_for_force(84.0, 1.0, 0.199919, 3**0.5))
    15.5752
    """
    return np.sqrt(force / axial_gain(mass, radius, ratio, efficiency))


def speed_ratio(force: Quantity, radius: Quantity, other_force: Quantity, other_radius: Quantity) -> Quantity:
    """Ratio of two speeds of the same flyweights.

    Equation: omega/omega_other = sqrt(F r_other/(F_other r))

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force at the one speed F [N].
    radius : scalar, array or symbol
        Radius of the flyweights there r [m].
    other_force : scalar, array or symbol
        Axial force at the other speed F_other [N].
    other_radius : scalar, array or symbol
        Radius there r_other [m].

    Returns
    -------
    scalar, array or symbol
        omega/omega_other [-].

    References
    ----------
    S4, analysis 1, eq. (4), for two travels; mass and transmission cancel.

    Examples
    --------
    S4, practice 1 (50 N at 180 mm, 60 N at 184.330 mm; 12.6639/13.7087):

    >>> float(speed_ratio(50.0, 0.18, 60.0, 0.184330))
    0.92379
    """
    return np.sqrt(force * other_radius / (other_force * radius))


def ball_set_mass(count: Quantity, density: Quantity, diameter: Quantity) -> Quantity:
    """Mass of all balls.

    Equation: m = n_b rho_b pi d_b**3/6

    Parameters
    ----------
    count : scalar, array or symbol
        Number of balls n_b [-].
    density : scalar, array or symbol
        Density rho_b [kg/m3].
    diameter : scalar, array or symbol
        Diameter d_b [m].

    Returns
    -------
    scalar, array or symbol
        m [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    Computed here, eight steel balls of 20 mm, 8 x 32.8 g:

    >>> ball_set_mass(8, 7830, 0.020)
    0.26239
    """
    return count * density * np.pi * diameter**3 / 6


def weight_thickness(mass: Quantity, count: Quantity, density: Quantity, width: Quantity) -> Quantity:
    """Side of a square weight.

    Equation: t_w = sqrt(m/(n_w rho b_w))

    Parameters
    ----------
    mass : scalar, array or symbol
        Mass of all weights m [kg].
    count : scalar, array or symbol
        Number of weights n_w [-].
    density : scalar, array or symbol
        Density of the weights rho [kg/m3].
    width : scalar, array or symbol
        Axial width of a weight b_w [m].

    Returns
    -------
    scalar, array or symbol
        t_w [m].

    References
    ----------
    Geometry: a bar of square section t_w x t_w and length b_w.

    Examples
    --------
    Computed here, three weights of 1 kg together, steel, 30 mm wide:

    >>> float(1000 * weight_thickness(1.0, 3, 7850, 0.030))
    37.622
    """
    return np.sqrt(mass / (count * density * width))


def gravity_ratio(rest_radius: Quantity, start_speed: Quantity) -> Quantity:
    """Centrifugal acceleration over gravity where the flyweights start.

    Equation: q = r0 omega**2/g, with g = 9.80665 m/s2

    Parameters
    ----------
    rest_radius : scalar, array or symbol
        Radius of the flyweight centres at rest r0 [m].
    start_speed : scalar, array or symbol
        Speed at which the flyweights leave their rest omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        Centrifugal acceleration over that of gravity [-].

    References
    ----------
    Derived; not in S4. Below about 10 the flyweights move once per turn, up and down.

    Examples
    --------
    S4, practice 1 (180 mm, 12.6639 rad/s): 2.9, so that the exercise is no real clutch:

    >>> gravity_ratio(0.18, 12.6639)
    2.94
    """
    return rest_radius * start_speed**2 / STANDARD_GRAVITY


# -- springs ----------------------------------------------------------------------------------------


def set_rate(count: Quantity, rate: Quantity) -> Quantity:
    """Rate of a spring set.

    Equation: s = N k

    Parameters
    ----------
    count : scalar, array or symbol
        Number of springs side by side N [-].
    rate : scalar, array or symbol
        Rate of one spring k [N/m].

    Returns
    -------
    scalar, array or symbol
        s [N/m].

    References
    ----------
    Statics of parallel springs.

    Examples
    --------
    Computed here:

    >>> set_rate(6, 10.0)
    60.0
    """
    return count * rate


def spring_force(rate: Quantity, deflection: Quantity) -> Quantity:
    """Force of a spring or a spring set.

    Equation: F = s delta

    Parameters
    ----------
    rate : scalar, array or symbol
        Rate s of the set, or k of one spring [N/m].
    deflection : scalar, array or symbol
        Deflection from the free length delta [m]: preload deflection, more what the parts have travelled.

    Returns
    -------
    scalar, array or symbol
        F [N].

    References
    ----------
    Statics; S4 writes F_R0 + s x with F_R0 = s delta.

    Examples
    --------
    S4, practice 3 (10**5 N/m, preload 1200 N, 10 mm further; 2200 N):

    >>> spring_force(1e5, 0.012 + 0.010)
    2200.0
    """
    return rate * deflection


def series_rate(first: Quantity, second: Quantity) -> Quantity:
    """Rate of two spring sets in series.

    Equation: s = 1/(1/s1 + 1/s2)

    Parameters
    ----------
    first : scalar, array or symbol
        Rate of the first set s1 [N/m].
    second : scalar, array or symbol
        Rate of the second set s2 [N/m].

    Returns
    -------
    scalar, array or symbol
        Rate [N/m].

    References
    ----------
    Statics; S4, analysis 2, where one set presses on the other.

    Examples
    --------
    S4, practice 1 (8 and 4 N/mm), computed here:

    >>> series_rate(8000.0, 4000.0)
    2666.67
    """
    return 1 / (1 / first + 1 / second)


# -- lining -----------------------------------------------------------------------------------------


def lining_radius(inner_radius: Quantity, outer_radius: Quantity) -> Quantity:
    """Friction radius of a worn-in lining.

    Equation: r_f = (r_i + r_o)/2

    Parameters
    ----------
    inner_radius : scalar, array or symbol
        Inner radius of the lining r_i [m].
    outer_radius : scalar, array or symbol
        Outer radius of the lining r_o [m].

    Returns
    -------
    scalar, array or symbol
        r_f [m].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch with uniform wear; a new lining has a little more.

    Examples
    --------
    Computed here:

    >>> lining_radius(0.06, 0.09)
    0.075
    """
    return (inner_radius + outer_radius) / 2


def lining_pressure(force: Quantity, inner_radius: Quantity, outer_radius: Quantity) -> Quantity:
    """Pressure at the inner edge of a worn-in lining.

    Equation: p = F_N/(2 pi r_i (r_o - r_i))

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force F_N [N].
    inner_radius : scalar, array or symbol
        Inner radius of the lining r_i [m].
    outer_radius : scalar, array or symbol
        Outer radius of the lining r_o [m].

    Returns
    -------
    scalar, array or symbol
        p [Pa].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch with uniform wear; the same as
    :func:`synth.problems.mechanics.ring.worn_peak_pressure`, with each radius named less often.

    Examples
    --------
    Computed here, ring of 3.5 and 4.7 cm radius under 1 kN: 1000/(2 pi 0.035 0.012):

    >>> lining_pressure(1000.0, 0.035, 0.047)
    378940.
    """
    return force / (2 * np.pi * inner_radius * (outer_radius - inner_radius))


def lining_area(surfaces: Quantity, inner_radius: Quantity, outer_radius: Quantity) -> Quantity:
    """Area of all friction surfaces.

    Equation: A = z_f pi (r_o**2 - r_i**2)

    Parameters
    ----------
    surfaces : scalar, array or symbol
        Number of friction surfaces z_f [-].
    inner_radius : scalar, array or symbol
        Inner radius of the lining r_i [m].
    outer_radius : scalar, array or symbol
        Outer radius of the lining r_o [m].

    Returns
    -------
    scalar, array or symbol
        A [m2].

    References
    ----------
    Geometry.

    Examples
    --------
    Computed here, two surfaces of 60 and 90 mm radius, in cm2:

    >>> 1e4 * lining_area(2, 0.06, 0.09)
    282.74
    """
    return surfaces * np.pi * (outer_radius**2 - inner_radius**2)


def force_for_torque(torque: Quantity, friction: Quantity, surfaces: Quantity, friction_radius: Quantity) -> Quantity:
    """Axial force that a torque needs.

    Equation: F_N = M/(mu z_f r_f)

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    friction : scalar, array or symbol
        Sliding friction of the lining mu [-].
    surfaces : scalar, array or symbol
        Number of friction surfaces z_f [-].
    friction_radius : scalar, array or symbol
        r_f [m].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch.

    Examples
    --------
    Computed here, the inverse of :func:`synth.problems.mechanics.ring.friction_torque`:

    >>> force_for_torque(105.0, 0.35, 2, 0.075)
    2000.0
    """
    return torque / (friction * surfaces * friction_radius)


def engagement_energy(inertia: Quantity, speed: Quantity) -> Quantity:
    """Heat of one engagement.

    Equation: Q = J omega**2/2

    Parameters
    ----------
    inertia : scalar, array or symbol
        Driven inertia J [kg m2].
    speed : scalar, array or symbol
        Speed that it is brought to omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        Q [J].

    References
    ----------
    Energy balance: at constant speed of the driver and without load torque as much heat arises as
    the driven side gains; with a load torque M_L under a constant clutch torque M it is M/(M - M_L) times as much.

    Examples
    --------
    Computed here:

    >>> engagement_energy(0.5, 200.0)
    10000.0
    """
    return inertia * speed**2 / 2


# -- contact of a ball ------------------------------------------------------------------------------


def ramp_normal_force(centrifugal_force: Quantity, ratio: Quantity) -> Quantity:
    """Force of a ball across the ramp.

    Equation: Q = F_C sqrt(1 + i**2)

    Parameters
    ----------
    centrifugal_force : scalar, array or symbol
        F_C of one ball [N].
    ratio : scalar, array or symbol
        Transmission of the ramp i [-].

    Returns
    -------
    scalar, array or symbol
        Q [N].

    References
    ----------
    Statics without friction, Q = F_C/cos(alpha): on the safe side, friction makes it smaller.

    Examples
    --------
    Computed here, 500 N on a ramp of 45 degrees:

    >>> float(ramp_normal_force(500.0, 1.0))
    707.1
    """
    return centrifugal_force * np.sqrt(1 + ratio**2)


def ball_pressure(normal_force: Quantity, ball_diameter: Quantity, contact_modulus: Quantity) -> Quantity:
    """Peak pressure of a ball on a flat ramp.

    Equation: p0 = (24 Q (E*)**2/(pi**3 d_b**2))**(1/3)

    Parameters
    ----------
    normal_force : scalar, array or symbol
        Q [N].
    ball_diameter : scalar, array or symbol
        d_b = 2 R [m].
    contact_modulus : scalar, array or symbol
        E* [Pa], of :func:`synth.problems.mechanics.contact.contact_modulus`.

    Returns
    -------
    scalar, array or symbol
        p0 [Pa].

    References
    ----------
    K. L. Johnson, Contact Mechanics (1985), eq. (4.24). A groove that fits the ball lowers it.

    Examples
    --------
    Computed here, a steel ball of 20 mm under 1 kN (E* = 115.385 GPa), in GPa:

    >>> ball_pressure(1000.0, 0.020, 115.385e9) / 1e9
    2.953
    """
    return (24 * normal_force * contact_modulus**2 / (np.pi**3 * ball_diameter**2)) ** (1 / 3)


# -- size -------------------------------------------------------------------------------------------


def outside_diameter(lining_reach: Quantity, flyweight_reach: Quantity) -> Quantity:
    """Outside diameter over linings and flyweights, twice the larger reach.

    Equation: D = 2 max(R_l, R_w)

    Parameters
    ----------
    lining_reach : scalar, array or symbol
        Outer radius of the lining and the rim around it R_l [m].
    flyweight_reach : scalar, array or symbol
        Outermost radius of the flyweights and the wall around them R_w [m].

    Returns
    -------
    scalar, array or symbol
        D [m].

    References
    ----------
    Geometry.

    Examples
    --------
    Computed here:

    >>> float(outside_diameter(0.095, 0.090))
    0.19
    """
    return 2 * np.maximum(lining_reach, flyweight_reach)


def plates_mass(density: Quantity, diameter: Quantity, hub_radius: Quantity, thickness: Quantity) -> Quantity:
    """Mass of all plates as one ring.

    Equation: m = rho pi (D**2/4 - r_hub**2) t

    Parameters
    ----------
    density : scalar, array or symbol
        Density of steel rho [kg/m3].
    diameter : scalar, array or symbol
        Outside diameter D [m].
    hub_radius : scalar, array or symbol
        Inner radius r_hub [m].
    thickness : scalar, array or symbol
        Steel thickness that all plates together amount to, t [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry, with an equivalent thickness.

    Examples
    --------
    Computed here, 200 mm across, hub of 20 mm radius, 25 mm thick:

    >>> plates_mass(7850, 0.200, 0.020, 0.025)
    5.919
    """
    return density * np.pi * (diameter**2 / 4 - hub_radius**2) * thickness


def further_discs_mass(
    density: Quantity,
    surfaces: Quantity,
    ring_ratio: Quantity,
    outer_radius: Quantity,
    hub_radius: Quantity,
    lining_density: Quantity,
    lining_thickness: Quantity,
) -> Quantity:
    """Mass of all friction discs beyond the first and of the plates between them.

    Equation: m = pi (z_f/2 - 1) ((0.006 rho + 2 rho_l t_l) (r_o**2 - r_i**2) + 0.002 rho (r_o**2 - r_hub**2)), with r_i
        = q r_o

    Each adds a plate of 6 mm as wide as the lining, a core of 2 mm down to the hub and two linings.

    Parameters
    ----------
    density : scalar, array or symbol
        Density of steel rho [kg/m3].
    surfaces : scalar, array or symbol
        Friction surfaces z_f, two for each disc [-].
    ring_ratio : scalar, array or symbol
        Inner over outer radius of the lining, q = r_i/r_o [-]; the ratio, because limits bound it whatever r_o is.
    outer_radius, hub_radius : scalar, array or symbol
        r_o, r_hub [m].
    lining_density, lining_thickness : scalar, array or symbol
        rho_l [kg/m3] and t_l [m] of one lining.

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; both thicknesses are engineering practice.

    Examples
    --------
    By hand, three further discs of 100/126 mm with sintered linings of 2 mm: 0.652089 + 0.528099 + 0.254765 kg:

    >>> further_discs_mass(7850, 8, 50 / 63, 0.063, 0.020, 4600, 0.002)
    1.43495
    """
    ring = (density * FURTHER_PLATE + 2 * lining_density * lining_thickness) * outer_radius**2 * (1 - ring_ratio**2)
    core = density * FURTHER_CORE * (outer_radius**2 - hub_radius**2)
    return np.pi * (surfaces / 2 - 1) * (ring + core)


def overall_length(
    plates_thickness: Quantity,
    surfaces: Quantity,
    lining_thickness: Quantity,
    travel: Quantity,
    flyweight_width: Quantity,
) -> Quantity:
    """Length of the clutch.

    Equation: L = t_plates + (z_f/2 - 1) (0.008 + 2 t_l) + x + b_w + 0.005

    Parameters
    ----------
    plates_thickness : scalar, array or symbol
        Of all plates with one friction disc t_plates [m].
    surfaces : scalar, array or symbol
        Friction surfaces z_f, two for each disc [-].
    lining_thickness : scalar, array or symbol
        Of one lining t_l [m].
    travel : scalar, array or symbol
        Way along the axis for which there must be room x [m].
    flyweight_width : scalar, array or symbol
        Flyweights along the axis b_w [m].

    Returns
    -------
    scalar, array or symbol
        Length [m].

    References
    ----------
    Geometry; plates, cores and cover are engineering practice.

    Examples
    --------
    By hand, in mm 25 + 3 (8 + 4) + 1.6 + 23 + 5:

    >>> 1e3 * overall_length(0.025, 8, 0.002, 0.0016, 0.023)
    90.6
    """
    further = (surfaces / 2 - 1) * (FURTHER_PLATE + FURTHER_CORE + 2 * lining_thickness)
    return plates_thickness + further + travel + flyweight_width + COVER


def clutch_inertia(
    plates_mass: Quantity,
    diameter: Quantity,
    hub_radius: Quantity,
    flyweight_mass: Quantity,
    flyweight_radius: Quantity,
    spring_mass: Quantity,
    spring_radius: Quantity,
) -> Quantity:
    """Inertia of plates, flyweights and springs.

    Equation: J = m_d (D**2/4 + r_hub**2)/2 + m r**2 + m_s r_s**2

    Parameters
    ----------
    plates_mass : scalar, array or symbol
        Mass of the plates m_d [kg].
    diameter : scalar, array or symbol
        Outside diameter D [m].
    hub_radius : scalar, array or symbol
        Inner radius of the plates r_hub [m].
    flyweight_mass : scalar, array or symbol
        m [kg].
    flyweight_radius : scalar, array or symbol
        Outermost radius of the flyweight centres r [m].
    spring_mass : scalar, array or symbol
        Mass of all springs m_s [kg].
    spring_radius : scalar, array or symbol
        Radius on which they stand r_s [m].

    Returns
    -------
    scalar, array or symbol
        J [kg m2].

    References
    ----------
    Geometry.

    Examples
    --------
    Computed here, 5.919/2 (0.01 + 0.0004) + 0.26 0.0064 + 0.05 0.0049:

    >>> clutch_inertia(5.919, 0.200, 0.020, 0.26, 0.080, 0.05, 0.070)
    0.03269
    """
    disc = plates_mass * (diameter**2 / 4 + hub_radius**2) / 2
    return disc + flyweight_mass * flyweight_radius**2 + spring_mass * spring_radius**2


def spring_bow_load(
    density: Quantity,
    wire_diameter: Quantity,
    mean_diameter: Quantity,
    active_coils: Quantity,
    radius: Quantity,
    speed: Quantity,
) -> Quantity:
    """Load across a spring that turns with the clutch: its active coils' own centrifugal force.

    Equation: F = rho (pi d**2/4) (pi D n) r omega**2

    Parameters
    ----------
    density : scalar, array or symbol
        Density of the wire rho [kg/m3].
    wire_diameter : scalar, array or symbol
        d [m].
    mean_diameter : scalar, array or symbol
        Mean coil diameter D [m].
    active_coils : scalar, array or symbol
        n [-].
    radius : scalar, array or symbol
        Radius on which the spring stands r [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        Load [N].

    References
    ----------
    Derived; not in S4: rho (pi d**2/4) (pi D n) r omega**2.

    Examples
    --------
    Computed here, wire of 2 mm, coils of 16 mm, 5.5 of them, at 70 mm and 500 rad/s:

    >>> spring_bow_load(7850, 0.002, 0.016, 5.5, 0.070, 500.0)
    119.3
    """
    wire_mass = density * np.pi**2 * wire_diameter**2 * mean_diameter * active_coils / 4
    return wire_mass * radius * speed**2


def rim_stress(density: Quantity, radius: Quantity, speed: Quantity) -> Quantity:
    """Hoop stress of a thin rim that turns freely.

    Equation: sigma = rho (omega r)**2

    Parameters
    ----------
    density : scalar, array or symbol
        Density of the rim rho [kg/m3].
    radius : scalar, array or symbol
        Radius of the rim r [m].
    speed : scalar, array or symbol
        omega [rad/s].

    Returns
    -------
    scalar, array or symbol
        sigma [Pa].

    References
    ----------
    Hoop stress of a thin ring.

    Examples
    --------
    Computed here, steel, 100 mm, 500 rad/s, in N/mm2:

    >>> rim_stress(7850, 0.1, 500.0) / 1e6
    19.625
    """
    return density * (speed * radius) ** 2
