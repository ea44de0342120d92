"""Plates, lugs, drum and oil film of a multi-plate clutch.

Every function takes floats, arrays or CasADi symbols.

Sources: S0 (Szoke 1966), section on plate thickness and release; Smalley (wave spring catalogue); derivations named in
each function.
"""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = [
    "annulus_mass",
    "cylinder_surface",
    "cylinder_volume",
    "drag_torque",
    "drum_diameter",
    "lining_mass",
    "lug_pressure",
    "pack_inner_inertia",
    "pack_length",
    "shaft_shear_stress",
    "sine_plate_force",
    "sliding_speed",
    "squeeze_time",
    "static_hold",
    "stroke",
]


def annulus_mass(
    density: Quantity, count: Quantity, thickness: Quantity, mean_diameter: Quantity, width: Quantity
) -> Quantity:
    """Mass of equal flat rings.

    Equation: m = rho n t pi dm b

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    count : scalar, array or symbol
        Number of rings n [-].
    thickness : scalar, array or symbol
        t [m].
    mean_diameter : scalar, array or symbol
        Sum of outer and inner radius dm [m].
    width : scalar, array or symbol
        Outer less inner radius b [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 7850 pi 0.01 (0.1**2 - 0.05**2):

    >>> annulus_mass(7850, 10, 0.001, 0.15, 0.05)
    1.8496
    """
    return density * np.pi * count * thickness * (mean_diameter * width)


def lining_mass(density: Quantity, thickness: Quantity, area: Quantity) -> Quantity:
    """Mass of the linings.

    Equation: m = rho t A

    Parameters
    ----------
    density : scalar, array or symbol
        Density of the lining rho [kg/m3].
    thickness : scalar, array or symbol
        Thickness of one lining t [m].
    area : scalar, array or symbol
        All lined surfaces A [m2].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand:

    >>> lining_mass(2000, 0.001, 0.3)
    0.6
    """
    return density * thickness * area


def pack_length(
    surfaces: Quantity, inner_thickness: Quantity, outer_thickness: Quantity, lining_thickness: Quantity, gap: Quantity
) -> Quantity:
    """Length of the released pack.

    Equation: L = z_b t_i + z_k t_o + z (t_lining + gap), with z_b = z/2 + 1, z_k = z/2

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-], even; z_k = z/2 outer and z_b = z/2 + 1 inner plates.
    inner_thickness, outer_thickness : scalar, array or symbol
        Steel cores t_i, t_o [m].
    lining_thickness : scalar, array or symbol
        One lining t_lining [m]; both sides of every outer plate are lined.
    gap : scalar, array or symbol
        Release gap per surface, gap [m].

    Returns
    -------
    scalar, array or symbol
        Length [m], without actuator and end stops.

    References
    ----------
    Geometry of S0 (Szoke 1966), fig. 1.

    Examples
    --------
    By hand, 6 x 2 + 5 x 1.5 + 10 (0.5 + 0.3) mm:

    >>> pack_length(10, 2, 1.5, 0.5, 0.3)
    27.5
    """
    return surfaces / 2 * (inner_thickness + outer_thickness) + inner_thickness + surfaces * (lining_thickness + gap)


def drum_diameter(outer_spline_radius: Quantity, drum_wall: Quantity) -> Quantity:
    """Outside diameter of the drum.

    Equation: D = 2 (b + s_drum)

    Parameters
    ----------
    outer_spline_radius : scalar, array or symbol
        Mean spline radius of the outer plates b [m].
    drum_wall : scalar, array or symbol
        Wall outside the mean spline radius s_drum [m].

    Returns
    -------
    scalar, array or symbol
        D [m].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand:

    >>> drum_diameter(0.13, 0.006)
    0.272
    """
    return 2 * (outer_spline_radius + drum_wall)


def cylinder_volume(diameter: Quantity, length: Quantity) -> Quantity:
    """Volume of the enveloping cylinder.

    Equation: V = pi D**2 L/4

    Parameters
    ----------
    diameter, length : scalar, array or symbol
        D, L [m].

    Returns
    -------
    scalar, array or symbol
        V [m3].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> cylinder_volume(2.0, 1.0)
    3.1416
    """
    return np.pi * diameter**2 * length / 4


def cylinder_surface(diameter: Quantity, length: Quantity) -> Quantity:
    """Surface that gives off heat: shell and both faces.

    Equation: A = pi D L + pi D**2/2

    Parameters
    ----------
    diameter, length : scalar, array or symbol
        D, L [m].

    Returns
    -------
    scalar, array or symbol
        Surface [m2].

    References
    ----------
    Geometry.

    Examples
    --------
    >>> cylinder_surface(2.0, 1.0)
    12.566
    """
    return np.pi * diameter * (length + diameter / 2)


def lug_pressure(
    plate_torque: Quantity, spline_radius: Quantity, lug_count: Quantity, lug_height: Quantity, thickness: Quantity
) -> Quantity:
    """Pressure of the lugs of one plate on the spline flanks.

    Equation: p = M_plate/(R n_lug h_lug t)

    Parameters
    ----------
    plate_torque : scalar, array or symbol
        Torque of one plate, both faces M_plate [N m].
    spline_radius : scalar, array or symbol
        Mean spline radius R [m].
    lug_count : scalar, array or symbol
        Lugs that carry n_lug [-].
    lug_height : scalar, array or symbol
        Loaded flank height h_lug [m].
    thickness : scalar, array or symbol
        Core of the plate t [m].

    Returns
    -------
    scalar, array or symbol
        p [Pa]; 25 to 40 N/mm2 are usual on hardened flanks.

    References
    ----------
    S0 (Szoke 1966): the lugs must not bite into the groove; formula derived.

    Examples
    --------
    By hand, 200 N m at 100 mm on 12 lugs of 3 x 1.5 mm:

    >>> lug_pressure(200, 0.1, 12, 0.003, 0.0015) / 1e6
    37.037
    """
    return plate_torque / (spline_radius * lug_count * lug_height * thickness)


def drag_torque(
    surfaces: Quantity,
    viscosity: Quantity,
    speed_difference: Quantity,
    mean_diameter: Quantity,
    ring_ratio: Quantity,
    gap: Quantity,
) -> Quantity:
    """Drag of the released pack with full oil films.

    Equation: T = z (pi/2) eta omega dm**4 c (1 + c**2)/(2 h)

    Uses r2**4 - r1**4 = dm**4 c (1 + c**2)/2.

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    viscosity : scalar, array or symbol
        Dynamic viscosity eta [Pa s].
    speed_difference : scalar, array or symbol
        omega [rad/s].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].
    gap : scalar, array or symbol
        Film thickness h [m].

    Returns
    -------
    scalar, array or symbol
        T [N m].

    References
    ----------
    Laminar shear between rings; too high at high speed, where the film takes in air.

    Examples
    --------
    Computed here for the rings of the S1 example in oil of 0.02 Pa s:

    >>> drag_torque(10, 0.02, 26.6, 0.206488499, 0.25, 0.3e-3)
    6.726
    """
    fourth_powers = mean_diameter**4 * ring_ratio * (1 + ring_ratio**2) / 2
    return surfaces * np.pi / 2 * viscosity * speed_difference * fourth_powers / gap


def stroke(surfaces: Quantity, gap: Quantity, wear_depth: Quantity) -> Quantity:
    """Way of the actuator that closes the released pack when its linings are worn.

    Equation: s = z (gap + d_w)

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    gap : scalar, array or symbol
        Release gap per surface, gap [m].
    wear_depth : scalar, array or symbol
        Wear of one lining before it is replaced d_w [m].

    Returns
    -------
    scalar, array or symbol
        s [m].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 10 surfaces of 0.3 mm gap and 0.4 mm wear:

    >>> stroke(10, 0.3e-3, 0.4e-3)
    0.007
    """
    return surfaces * (gap + wear_depth)


def pack_inner_inertia(
    density: Quantity,
    plates_thickness: Quantity,
    pack_length: Quantity,
    web_thickness: Quantity,
    outer_radius: Quantity,
    spline_radius: Quantity,
    rim_wall: Quantity,
    shaft_radius: Quantity,
) -> Quantity:
    """Inertia of what turns with the inner plates: plates, rim and web of the hub.

    Equation: J = (rho pi/2) (t (r2**4 - a**4) + L (a**4 - (a - s)**4) + t_w ((a - s)**4 - r_b**4))

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    plates_thickness : scalar, array or symbol
        All inner plates together, end plates included t [m].
    pack_length : scalar, array or symbol
        Of the rim of the hub L [m].
    web_thickness : scalar, array or symbol
        t_w [m].
    outer_radius, spline_radius : scalar, array or symbol
        Outside r2 and mean spline radius a of the inner plates [m].
    rim_wall : scalar, array or symbol
        Rim inside the mean spline radius s [m].
    shaft_radius : scalar, array or symbol
        r_b [m].

    Returns
    -------
    scalar, array or symbol
        J [kg m2].

    References
    ----------
    Inertia of rings, rho pi/2 t (ro**4 - ri**4).

    Examples
    --------
    By hand, plates alone, 7850 pi/2 0.02 (0.1**4 - 0.05**4):

    >>> pack_inner_inertia(7850, 0.02, 0.0, 0.0, 0.1, 0.05, 0.01, 0.02)
    0.02312
    """
    rim_radius = spline_radius - rim_wall
    plates = plates_thickness * (outer_radius**4 - spline_radius**4)
    rim = pack_length * (spline_radius**4 - rim_radius**4)
    web = web_thickness * (rim_radius**4 - shaft_radius**4)
    return density * np.pi / 2 * (plates + rim + web)


def squeeze_time(
    viscosity: Quantity,
    force: Quantity,
    inner_radius: Quantity,
    outer_radius: Quantity,
    start_gap: Quantity,
    end_gap: Quantity,
) -> Quantity:
    """Time in which a force squeezes the oil film of a smooth ring from h0 to h1.

    Equation: t = 3 pi eta/(4 F) (r2**4 - r1**4 - (r2**2 - r1**2)**2/ln(r2/r1)) (1/h1**2 - 1/h0**2)

    Parameters
    ----------
    viscosity : scalar, array or symbol
        Dynamic viscosity eta [Pa s].
    force : scalar, array or symbol
        Axial force F [N].
    inner_radius, outer_radius : scalar, array or symbol
        r1, r2 [m].
    start_gap, end_gap : scalar, array or symbol
        h0, h1 [m].

    Returns
    -------
    scalar, array or symbol
        t [s].

    References
    ----------
    Reynolds equation, annular squeeze film. S0 (Szoke 1966) prefers tests on rotating parts to a formula.

    Examples
    --------
    Computed here, ungrooved rings of the S1 example, 0.3 mm to 10 um under 10 kN:

    >>> float(squeeze_time(0.02, 1e4, 0.07743, 0.12906, 0.3e-3, 10e-6))
    0.8957
    """
    squares = outer_radius**2 - inner_radius**2
    bracket = outer_radius**4 - inner_radius**4 - squares**2 / np.log(outer_radius / inner_radius)
    return 3 * np.pi * viscosity / (4 * force) * bracket * (1 / end_gap**2 - 1 / start_gap**2)


def sine_plate_force(
    deflection: Quantity,
    elastic_modulus: Quantity,
    radial_width: Quantity,
    thickness: Quantity,
    waves: Quantity,
    outer_diameter: Quantity,
    inner_diameter: Quantity,
    turns: Quantity = 1.0,
) -> Quantity:
    """Force that flattens a waved ring.

    Equation: F = f E b t**3 N**4 (OD/ID)/(K Dm**3 Z), with Dm = (OD + ID)/2, K = 3.88 if N <= 4 else 2.9 if N <= 6.5
        else 2.3 if N <= 9.5 else 2.13

    Parameters
    ----------
    deflection : scalar, array or symbol
        f [m].
    elastic_modulus : scalar, array or symbol
        E [Pa].
    radial_width : scalar, array or symbol
        b [m].
    thickness : scalar, array or symbol
        t [m].
    waves : scalar, array or symbol
        Waves per turn N [-].
    outer_diameter, inner_diameter : scalar, array or symbol
        OD, ID [m]; Dm is their mean.
    turns : scalar, array or symbol
        Rings in series Z [-].

    Returns
    -------
    scalar, array or symbol
        F [N]; to be subtracted from the actuation force.

    References
    ----------
    Smalley, wave spring catalogue: K = 3.88 (N <= 4), 2.90 (<= 6.5), 2.30 (<= 9.5), 2.13 above.

    Examples
    --------
    Computed here, a 1.5 mm plate of 155/258 mm with 6 waves of 0.3 mm:

    >>> float(sine_plate_force(0.3e-3, 206e9, 0.0516, 0.0015, 6, 0.258, 0.155))
    909.17
    """
    factor = np.where(waves <= 4, 3.88, np.where(waves <= 6.5, 2.90, np.where(waves <= 9.5, 2.30, 2.13)))
    mean = (outer_diameter + inner_diameter) / 2
    stiffness = elastic_modulus * radial_width * thickness**3 * waves**4 / (factor * mean**3 * turns)
    return deflection * stiffness * outer_diameter / inner_diameter


def sliding_speed(speed_difference: Quantity, radius: Quantity) -> Quantity:
    """Rubbing speed at a radius.

    Equation: v = omega r

    Parameters
    ----------
    speed_difference : scalar, array or symbol
        omega [rad/s].
    radius : scalar, array or symbol
        Outer radius of the ring r [m].

    Returns
    -------
    scalar, array or symbol
        v [m/s].

    References
    ----------
    Kinematics; limited by the makers of linings.

    Examples
    --------
    S1's example at its outer edge:

    >>> sliding_speed(26.6, 0.129055)
    3.4329
    """
    return speed_difference * radius


def static_hold(torque: Quantity, mu_static: Quantity, mu_dynamic: Quantity, load_torque: Quantity) -> Quantity:
    """Torque that the locked clutch holds over the load torque.

    Equation: q = (mu_static/mu) M_k/M_load

    Parameters
    ----------
    torque : scalar, array or symbol
        Slipping torque M_k [N m].
    mu_static, mu_dynamic : scalar, array or symbol
        Breakaway friction mu_static and sliding friction mu [-].
    load_torque : scalar, array or symbol
        M_load [N m].

    Returns
    -------
    scalar, array or symbol
        Ratio [-]; 1.2 to 2 is common practice.

    References
    ----------
    Common practice.

    Examples
    --------
    By hand:

    >>> static_hold(1080, 0.12, 0.1, 600)
    2.16
    """
    return mu_static / mu_dynamic * torque / load_torque


def shaft_shear_stress(torque: Quantity, diameter: Quantity) -> Quantity:
    """Torsion stress of a solid shaft.

    Equation: tau = 16 M/(pi d**3)

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    diameter : scalar, array or symbol
        d [m].

    Returns
    -------
    scalar, array or symbol
        tau [Pa].

    References
    ----------
    Standard strength of materials.

    Examples
    --------
    By hand, 1000 N m on 50 mm:

    >>> shaft_shear_stress(1000, 0.05) / 1e6
    40.744
    """
    return 16 * torque / (np.pi * diameter**3)
