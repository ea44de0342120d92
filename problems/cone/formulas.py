"""Cone clutch: torque, axial forces in service, on engaging and on releasing, self-locking, seating and sizing.

The half angle alpha lies between generator and axis, the friction face has the mean diameter dm and the generator
length l, c = l/dm. N is the resultant of the pressure. alpha = 90 degrees gives the disc clutch. Every function takes
floats, arrays or CasADi symbols, angles in radians.

Sources: S1 (lecture on friction clutches), single-cone and inner-cone clutch; its formulas are lost in print and were
derived again from its questions (axial force for a torque, axial force for engaging) and sizing steps.
"""

from __future__ import annotations

import numpy as np

from synth.special import special

from ..mechanics import Quantity


def wedge_factor(half_angle: Quantity, mu: Quantity) -> Quantity:
    """Axial force over normal force while the cones slide into each other, sin(alpha) + mu cos(alpha).

    Parameters
    ----------
    half_angle : scalar, array or symbol
        alpha [rad].
    mu : scalar, array or symbol
        Friction along the generator [-]; 0 in service, where it is used up tangentially.

    Returns
    -------
    scalar, array or symbol
        F/N [-].

    References
    ----------
    S1 (lecture), force for engaging; derived from the equilibrium along the axis.

    Examples
    --------
    By hand, sin 30 degrees + 0.2 cos 30 degrees:

    >>> float(wedge_factor(np.pi / 6, 0.2))
    0.673205
    """
    return np.sin(half_angle) + mu * np.cos(half_angle)


@special((-1.0, 0.0), (0.0, 1.0))
def grip_factor(half_angle: Quantity, mu: Quantity) -> Quantity:
    """Peripheral force over the spring force of a clutch that has just engaged, mu/(sin(alpha) + mu cos(alpha)).

    It falls with the angle while tan(alpha) < 1/mu, and rises with the friction.

    Parameters
    ----------
    half_angle : scalar, array or symbol
        alpha [rad], with tan(alpha) < 1/mu.
    mu : scalar, array or symbol
        Sliding friction [-].

    Returns
    -------
    scalar, array or symbol
        mu N/F [-]; the wedge effect for which a cone is chosen (mu for a disc).

    References
    ----------
    S1 (lecture), advantage of the cone: the wedge effect; derived.

    Examples
    --------
    By hand, 0.2/(0.5 + 0.2 cos 30 degrees):

    >>> float(grip_factor(np.pi / 6, 0.2))
    0.297086
    """
    return mu / wedge_factor(half_angle, mu)


def normal_force(engaging_force: Quantity, half_angle: Quantity, mu: Quantity) -> Quantity:
    """Resultant of the pressure under a spring that has just engaged the clutch, N = F/(sin(alpha) + mu cos(alpha)).

    Parameters
    ----------
    engaging_force : scalar, array or symbol
        Spring force F [N].
    half_angle : scalar, array or symbol
        alpha [rad], with tan(alpha) < 1/mu.
    mu : scalar, array or symbol
        Sliding friction [-].

    Returns
    -------
    scalar, array or symbol
        N [N].

    References
    ----------
    S1 (lecture): the spring is sized for engaging; derived.

    Examples
    --------
    By hand, 673.205 N at 30 degrees and 0.2:

    >>> float(normal_force(673.205, np.pi / 6, 0.2))
    1000.0
    """
    return engaging_force * grip_factor(half_angle, mu) / mu


def mean_radius_factor(ring_ratio: Quantity, half_angle: Quantity) -> Quantity:
    """Friction radius at uniform pressure over the mean radius, 1 + c**2 sin(alpha)**2/3.

    Parameters
    ----------
    ring_ratio : scalar, array or symbol
        c = l/dm [-].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        Factor [-]; 1 for worn-in faces (pressure times radius constant).

    References
    ----------
    Integral of the pressure over the cone; S1 takes the mean radius, at most 0.26 % less (c 0.2, alpha 26 degrees).

    Examples
    --------
    At 90 degrees the factor of the disc clutch, by hand 1 + 0.04/3:

    >>> float(mean_radius_factor(0.2, np.pi / 2))
    1.013333
    """
    return 1 + (ring_ratio * np.sin(half_angle)) ** 2 / 3


def friction_torque(
    peripheral_force: Quantity, mean_diameter: Quantity, ring_ratio: Quantity, half_angle: Quantity
) -> Quantity:
    """Torque at uniform pressure, M = mu N (dm/2)(1 + c**2 sin(alpha)**2/3).

    Parameters
    ----------
    peripheral_force : scalar, array or symbol
        mu N [N].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S1 (lecture), torque of the cone clutch; derived.

    Examples
    --------
    By hand, 200 x 0.1 x (1 + 0.04 x 0.25/3):

    >>> float(friction_torque(200, 0.2, 0.2, np.pi / 6))
    20.0667
    """
    return peripheral_force * mean_diameter / 2 * mean_radius_factor(ring_ratio, half_angle)


def worn_torque(peripheral_force: Quantity, mean_diameter: Quantity) -> Quantity:
    """Torque of worn-in faces (pressure times radius constant), M = mu N dm/2.

    Parameters
    ----------
    peripheral_force : scalar, array or symbol
        mu N [N].
    mean_diameter : scalar, array or symbol
        dm [m].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    Shigley, Mechanical Engineering Design, cone clutch with uniform wear; S1's mean radius, exact for worn-in faces.

    Examples
    --------
    By hand:

    >>> worn_torque(200, 0.2)
    20.0
    """
    return peripheral_force * mean_diameter / 2


def service_force(normal_force: Quantity, half_angle: Quantity) -> Quantity:
    """Axial force that holds the normal force in service, N sin(alpha) = 2 M sin(alpha)/(mu dm).

    The friction is used up tangentially and none is left along the generator.

    Parameters
    ----------
    normal_force : scalar, array or symbol
        N [N].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        F [N].

    References
    ----------
    S1 (lecture), "what axial force does a torque need?"; derived.

    Examples
    --------
    By hand:

    >>> float(service_force(1000, np.pi / 6))
    500.0
    """
    return normal_force * np.sin(half_angle)


def engaging_force(normal_force: Quantity, half_angle: Quantity, mu: Quantity) -> Quantity:
    """Axial force that pushes the cones into each other, N (sin(alpha) + mu cos(alpha)).

    Parameters
    ----------
    normal_force : scalar, array or symbol
        N [N].
    half_angle : scalar, array or symbol
        alpha [rad].
    mu : scalar, array or symbol
        Sliding friction [-].

    Returns
    -------
    scalar, array or symbol
        F [N]; larger than in service, and the spring is sized for it.

    References
    ----------
    S1 (lecture), "what axial force does engaging need?"; derived.

    Examples
    --------
    By hand:

    >>> float(engaging_force(1000, np.pi / 6, 0.2))
    673.205
    """
    return normal_force * wedge_factor(half_angle, mu)


def release_force(normal_force: Quantity, half_angle: Quantity, mu: Quantity) -> Quantity:
    """Axial force with which the cones push apart, N (sin(alpha) - mu cos(alpha)).

    Parameters
    ----------
    normal_force : scalar, array or symbol
        N [N].
    half_angle : scalar, array or symbol
        alpha [rad].
    mu : scalar, array or symbol
        Friction along the generator [-].

    Returns
    -------
    scalar, array or symbol
        F [N]; negative where the cones must be pulled apart.

    References
    ----------
    S1 (lecture), release by an outer force; derived.

    Examples
    --------
    By hand, 30 degrees come loose, 10 degrees do not:

    >>> float(release_force(1000, np.pi / 6, 0.2)), float(release_force(1000, np.pi / 18, 0.2))
    (326.795, -23.313)
    """
    return normal_force * wedge_factor(half_angle, -mu)


def locking_angle(mu: Quantity) -> Quantity:
    """Half angle below which the cones lock, arctan(mu).

    Parameters
    ----------
    mu : scalar, array or symbol
        Static friction [-].

    Returns
    -------
    scalar, array or symbol
        alpha [rad].

    References
    ----------
    Release force of zero; derived.

    Examples
    --------
    >>> float(np.degrees(locking_angle(0.25)))
    14.0362
    """
    return np.arctan(mu)


def self_locking(half_angle: Quantity, mu: Quantity) -> Quantity:
    """Whether the cones stay locked without any axial force, tan(alpha) < mu.

    Parameters
    ----------
    half_angle : scalar, array or symbol
        alpha [rad].
    mu : scalar, array or symbol
        Static friction [-].

    Returns
    -------
    bool, array or symbol
        True where they must be pulled apart.

    References
    ----------
    Release force below zero; derived.

    Examples
    --------
    >>> bool(self_locking(np.radians(12), 0.25)), bool(self_locking(np.radians(15), 0.25))
    (True, False)
    """
    return np.tan(half_angle) < mu


def face_area(mean_diameter: Quantity, generator_length: Quantity) -> Quantity:
    """Area of the friction face, A = pi dm l.

    Parameters
    ----------
    mean_diameter : scalar, array or symbol
        dm [m].
    generator_length : scalar, array or symbol
        l [m].

    Returns
    -------
    scalar, array or symbol
        A [m2].

    References
    ----------
    S1 (lecture), b = c dm; exact for the frustum of a cone.

    Examples
    --------
    >>> face_area(0.2, 0.04)
    0.0251327
    """
    return np.pi * mean_diameter * generator_length


def pressure_torque(
    mu: Quantity, pressure: Quantity, mean_diameter: Quantity, ring_ratio: Quantity, half_angle: Quantity
) -> Quantity:
    """Torque at uniform pressure, M = mu p (pi dm**3/6)(3c + c**3 sin(alpha)**2).

    Parameters
    ----------
    mu : scalar, array or symbol
        Sliding friction [-].
    pressure : scalar, array or symbol
        p [Pa].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S1 (lecture), torque and allowed pressure; derived.

    Examples
    --------
    By hand, 0.2 x 1e5 x (pi 0.008/6)(0.6 + 0.008 x 0.25):

    >>> float(pressure_torque(0.2, 1e5, 0.2, 0.2, np.pi / 6))
    50.4330
    """
    bracket = 3 * ring_ratio + ring_ratio**3 * np.sin(half_angle) ** 2
    return mu * pressure * np.pi * mean_diameter**3 / 6 * bracket


def sizing_mean_diameter(
    torque: Quantity, mu: Quantity, pressure: Quantity, ring_ratio: Quantity, half_angle: Quantity
) -> Quantity:
    """Mean diameter that a torque needs, dm = cbrt(6 M/(mu pi p (3c + c**3 sin(alpha)**2))).

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    mu : scalar, array or symbol
        Sliding friction [-].
    pressure : scalar, array or symbol
        Allowed pressure p [Pa].
    ring_ratio : scalar, array or symbol
        c [-].
    half_angle : scalar, array or symbol
        alpha [rad]; 0 gives cbrt(2 M/(mu pi c p)), the mean radius of worn-in faces.

    Returns
    -------
    scalar, array or symbol
        dm [m].

    References
    ----------
    S1 (lecture), sizing of the cone clutch; the formula is lost in print and was derived.

    Examples
    --------
    The inverse of the torque above, and with the mean radius:

    >>> float(sizing_mean_diameter(50.4330, 0.2, 1e5, 0.2, np.pi / 6))
    0.200000
    >>> float(sizing_mean_diameter(50.4330, 0.2, 1e5, 0.2, 0.0))
    0.200222
    """
    bracket = 3 * ring_ratio + ring_ratio**3 * np.sin(half_angle) ** 2
    return np.cbrt(6 * torque / (mu * np.pi * pressure * bracket))


def seating_factor(half_angle: Quantity, mu: Quantity) -> Quantity:
    """Rise of normal force, pressure and torque by seating, 1 + mu/tan(alpha).

    After engagement vibration removes the axial friction; the same spring then gives N = F/sin(alpha).

    Parameters
    ----------
    half_angle : scalar, array or symbol
        alpha [rad].
    mu : scalar, array or symbol
        Sliding friction [-].

    Returns
    -------
    scalar, array or symbol
        Factor [-].

    References
    ----------
    Engaging force over service force; derived.

    Examples
    --------
    Computed here, 12 degrees and 0.25:

    >>> float(seating_factor(np.radians(12), 0.25))
    2.17616
    """
    return 1 + mu / np.tan(half_angle)


def seated_force(spring_force: Quantity, half_angle: Quantity) -> Quantity:
    """Resultant of the pressure after seating, N = F/sin(alpha).

    Parameters
    ----------
    spring_force : scalar, array or symbol
        F [N].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        N [N].

    References
    ----------
    Equilibrium along the axis without friction; derived.

    Examples
    --------
    By hand:

    >>> float(seated_force(500, np.pi / 6))
    1000.0
    """
    return spring_force / np.sin(half_angle)


def bearing_force(spring_force: Quantity, force_closed: Quantity) -> Quantity:
    """Axial load of the shaft bearings, F where the spring pushes against them, 0 where the force closes inside.

    Parameters
    ----------
    spring_force : scalar, array or symbol
        F [N].
    force_closed : scalar, array or symbol
        1 where the force closes inside the clutch (inner cone), 0 where not (outer spring).

    Returns
    -------
    scalar, array or symbol
        Force [N].

    References
    ----------
    S1 (lecture): the spring loads the bearings axially; the inner-cone clutch does not.

    Examples
    --------
    >>> bearing_force(900, 0), bearing_force(900, 1)
    (900, 0)
    """
    return spring_force * (1 - force_closed)


def largest_diameter(mean_diameter: Quantity, generator_length: Quantity, half_angle: Quantity) -> Quantity:
    """Diameter of the friction face at its wide end, dm + l sin(alpha).

    Parameters
    ----------
    mean_diameter, generator_length : scalar, array or symbol
        dm, l [m].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        Diameter [m].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> float(largest_diameter(0.2, 0.04, np.pi / 6))
    0.22
    """
    return mean_diameter + generator_length * np.sin(half_angle)


def overall_diameter(largest_diameter: Quantity, shell_thickness: Quantity, lining_thickness: Quantity) -> Quantity:
    """Outside of the outer cone, D = d_max + 2 (t_s + t_lining).

    Parameters
    ----------
    largest_diameter : scalar, array or symbol
        Friction face at its wide end [m].
    shell_thickness, lining_thickness : scalar, array or symbol
        t_s, t_lining [m].

    Returns
    -------
    scalar, array or symbol
        D [m].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> overall_diameter(0.22, 0.005, 0.003)
    0.236
    """
    return largest_diameter + 2 * (shell_thickness + lining_thickness)


def overall_length(generator_length: Quantity, half_angle: Quantity, length_add: Quantity) -> Quantity:
    """Length of the clutch, l cos(alpha) and what the layout adds.

    Parameters
    ----------
    generator_length : scalar, array or symbol
        l [m].
    half_angle : scalar, array or symbol
        alpha [rad].
    length_add : scalar, array or symbol
        Hub, spring and release of the layout [m].

    Returns
    -------
    scalar, array or symbol
        Length [m].

    References
    ----------
    Geometry; the addition is a modelling assumption of the layout.

    Examples
    --------
    >>> float(overall_length(0.04, np.pi / 3, 0.03))
    0.05
    """
    return generator_length * np.cos(half_angle) + length_add


def shell_mass(density: Quantity, area: Quantity, shell_thickness: Quantity) -> Quantity:
    """Mass of one cone shell, rho A t_s.

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    area : scalar, array or symbol
        Friction face [m2].
    shell_thickness : scalar, array or symbol
        t_s [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry, thin shell.

    Examples
    --------
    By hand:

    >>> shell_mass(7850, 0.02, 0.005)
    0.785
    """
    return density * area * shell_thickness


def clutch_mass(
    mass_factor: Quantity,
    area: Quantity,
    density: Quantity,
    shell_thickness: Quantity,
    lining_density: Quantity,
    lining_thickness: Quantity,
) -> Quantity:
    """Mass of the clutch, mass_factor A (2 rho t_s + rho_lining t_lining).

    Parameters
    ----------
    mass_factor : scalar, array or symbol
        Of the layout [-].
    area : scalar, array or symbol
        Friction face A [m2].
    density : scalar, array or symbol
        Density of the shells rho [kg/m3].
    shell_thickness : scalar, array or symbol
        Inner and outer cone, each t_s [m].
    lining_density : scalar, array or symbol
        Density of the lining [kg/m3].
    lining_thickness : scalar, array or symbol
        t_lining [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the factor is a modelling assumption of the layout.

    Examples
    --------
    By hand, 1.35 x 0.02 x (2 x 7850 x 0.005 + 2000 x 0.003):

    >>> clutch_mass(1.35, 0.02, 7850, 0.005, 2000, 0.003)
    2.2815
    """
    return mass_factor * area * (2 * density * shell_thickness + lining_density * lining_thickness)


def pull_ratio(half_angle: Quantity, static_mu: Quantity, mu: Quantity) -> Quantity:
    """Force that pulls engaged cones apart over the spring that has engaged them, (mu_0 + mu)/(tan(alpha) + mu) - 1.

    It is N (mu_0 cos(alpha) - sin(alpha))/F with N = F/(sin(alpha) + mu cos(alpha)), written with the angle once.

    Parameters
    ----------
    half_angle : scalar, array or symbol
        alpha [rad].
    static_mu : scalar, array or symbol
        Friction at rest along the generator mu_0 [-].
    mu : scalar, array or symbol
        Sliding friction while the cones were engaged [-].

    Returns
    -------
    scalar, array or symbol
        Ratio [-]; negative where the cones come apart by themselves.

    References
    ----------
    Equilibrium along the axis after engaging and before sliding apart; derived.

    Examples
    --------
    By hand at 12.5 degrees: 8958.27 N (0.4 0.976296 - 0.216440) over 5000 N:

    >>> float(pull_ratio(np.radians(12.5), 0.4, 0.35))
    0.311890
    """
    return (static_mu + mu) / (np.tan(half_angle) + mu) - 1


def pull_angle(static_mu: Quantity, mu: Quantity, ratio: Quantity) -> Quantity:
    """Half angle at which pulling the cones apart takes a share of the spring, the inverse of :func:`pull_ratio`.

    Parameters
    ----------
    static_mu : scalar, array or symbol
        Friction at rest along the generator mu_0 [-].
    mu : scalar, array or symbol
        Sliding friction while the cones were engaged [-].
    ratio : scalar, array or symbol
        Pull over spring force k [-].

    Returns
    -------
    scalar, array or symbol
        alpha [rad]; negative where every cone is pulled apart with less.

    References
    ----------
    tan(alpha) = (mu_0 - k mu)/(1 + k); derived.

    Examples
    --------
    >>> float(np.degrees(pull_angle(0.4, 0.35, 0.311890)))
    12.5000
    """
    return np.arctan((static_mu - ratio * mu) / (1 + ratio))


def hoop_stress(pressure: Quantity, mean_diameter: Quantity, shell_thickness: Quantity) -> Quantity:
    """Stress around a thin shell under the pressure of the friction face, p dm/(2 t_s).

    Parameters
    ----------
    pressure : scalar, array or symbol
        On the face [Pa].
    mean_diameter, shell_thickness : scalar, array or symbol
        dm, t_s [m].

    Returns
    -------
    scalar, array or symbol
        Stress [Pa]: tension in the outer shell, compression in the inner one.

    References
    ----------
    Thin ring under pressure.

    Examples
    --------
    >>> hoop_stress(1e6, 0.2, 0.005)
    20000000.0
    """
    return pressure * mean_diameter / (2 * shell_thickness)


def axial_stroke(gap: Quantity, wear: Quantity, half_angle: Quantity) -> Quantity:
    """Way along the axis that opens a gap across the face after the lining has worn, (g + d_w)/sin(alpha).

    Parameters
    ----------
    gap, wear : scalar, array or symbol
        Release gap and wear of the lining, both across the face [m].
    half_angle : scalar, array or symbol
        alpha [rad].

    Returns
    -------
    scalar, array or symbol
        Way [m].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> float(axial_stroke(0.3e-3, 0.7e-3, np.pi / 6))
    0.002
    """
    return (gap + wear) / np.sin(half_angle)


def spring_mass(force: Quantity, deflection: Quantity, energy: Quantity) -> Quantity:
    """Mass of the spring that engages the cones, F f/(2 e_s).

    Parameters
    ----------
    force : scalar, array or symbol
        F [N].
    deflection : scalar, array or symbol
        f [m].
    energy : scalar, array or symbol
        What a spring stores per mass e_s [J/kg].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Energy of a linear spring; of one in torsion e_s = tau**2/(4 G rho).

    Examples
    --------
    By hand, 5000 N x 20 mm/2 = 50 J at 140 J/kg:

    >>> spring_mass(5000, 0.02, 140)
    0.357143
    """
    return force * deflection / (2 * energy)
