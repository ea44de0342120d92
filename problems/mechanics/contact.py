"""Hertzian contact: peak pressure and size of the contact of rollers and balls.

Every function takes floats, arrays or CasADi symbols.

Sources: K. L. Johnson, Contact Mechanics (1985); B. J. Hamrock, D. Brewe, Journal of Lubrication Technology 105 (1983)
171-177; S3: B. Szoke, MTA VI. Osztaly Kozlemenyei 39 (1967), part II.
"""

from __future__ import annotations

import math

import numpy as np

from . import Quantity

__all__ = [
    "barrel_contact_pressure",
    "contact_modulus",
    "ellipticity",
    "line_contact_half_width",
    "line_contact_pressure",
    "point_contact_half_length",
    "point_contact_pressure",
]


def contact_modulus(
    first_modulus: Quantity, first_poisson: Quantity, second_modulus: Quantity, second_poisson: Quantity
) -> Quantity:
    """Modulus of a contact.

    Equation: E* = 1/((1 - nu1**2)/E1 + (1 - nu2**2)/E2)

    Parameters
    ----------
    first_modulus, first_poisson : scalar, array or symbol
        E1 [Pa], nu1 [-].
    second_modulus, second_poisson : scalar, array or symbol
        E2 [Pa], nu2 [-].

    Returns
    -------
    scalar, array or symbol
        E* [Pa].

    References
    ----------
    K. L. Johnson, Contact Mechanics (1985), eq. (4.3).

    Examples
    --------
    Steel on steel, by hand 206/1.82:

    >>> float(contact_modulus(206e9, 0.3, 206e9, 0.3) / 1e9)
    113.187
    """
    return 1 / ((1 - first_poisson**2) / first_modulus + (1 - second_poisson**2) / second_modulus)


def line_contact_pressure(
    normal_force: Quantity, contact_modulus: Quantity, contact_length: Quantity, roller_radius: Quantity
) -> Quantity:
    """Peak pressure of a cylindrical roller on a flat guide.

    Equation: p_H = sqrt(F_n E*/(pi l R))

    Parameters
    ----------
    normal_force : scalar, array or symbol
        F_n [N].
    contact_modulus : scalar, array or symbol
        E* [Pa].
    contact_length, roller_radius : scalar, array or symbol
        l, R [m].

    Returns
    -------
    scalar, array or symbol
        p_H [Pa].

    References
    ----------
    Johnson, Contact Mechanics, eq. (4.45). S3 prints 86.1 sqrt(f/(d l)) kp/mm2 for steel (f in kp, roller diameter d
    and width l in mm). Its limit of 20 000 kp/mm2 is a misprint: that is the modulus itself; 20 000 kp/cm2 = 1961 MPa
    is meant.

    Examples
    --------
    S3's 86.1 kp/mm2 for 1 kp on 1 mm x 1 mm (E = 207.83 GPa, nu = 0.3):

    >>> float(line_contact_pressure(9.80665, 207.83e9 / 1.82, 0.001, 0.0005) / 9.80665e6)
    86.10
    """
    return np.sqrt(normal_force * contact_modulus / (math.pi * contact_length * roller_radius))


def line_contact_half_width(
    normal_force: Quantity, contact_modulus: Quantity, contact_length: Quantity, roller_radius: Quantity
) -> Quantity:
    """Half width of the contact strip.

    Equation: a_H = sqrt(4 F_n R/(pi l E*))

    Parameters
    ----------
    normal_force : scalar, array or symbol
        F_n [N].
    contact_modulus : scalar, array or symbol
        E* [Pa].
    contact_length, roller_radius : scalar, array or symbol
        l, R [m].

    Returns
    -------
    scalar, array or symbol
        a_H [m]; the greatest shear stress, 0.30 p_H, lies 0.786 a_H below the surface.

    References
    ----------
    Johnson, Contact Mechanics, eq. (4.43).

    Examples
    --------
    Force from pressure and strip, pi a p_H l/2:

    >>> p = line_contact_pressure(2000.0, 113e9, 0.010, 0.020)
    >>> float(3.14159265 / 2 * line_contact_half_width(2000.0, 113e9, 0.010, 0.020) * p * 0.010)
    2000.0
    """
    return np.sqrt(4 * normal_force * roller_radius / (math.pi * contact_length * contact_modulus))


def point_contact_half_length(
    normal_force: Quantity, contact_modulus: Quantity, roller_radius: Quantity, crown_radius: Quantity
) -> Quantity:
    """Half length of the contact ellipse of a crowned roller along its axis.

    Equation: a_y = (3 k**2 e F_n R/(pi E*))**(1/3), with R = 1/(1/R_x + 1/R_y), k = 1.0339 (R_y/R_x)**0.636, e = 1.0003
        + 0.5968 R_x/R_y

    Parameters
    ----------
    normal_force : scalar, array or symbol
        F_n [N].
    contact_modulus : scalar, array or symbol
        E* [Pa].
    roller_radius, crown_radius : scalar, array or symbol
        R_x and R_y, not smaller [m].

    Returns
    -------
    scalar, array or symbol
        a_y [m].

    References
    ----------
    B. J. Hamrock, D. Brewe, Journal of Lubrication Technology 105 (1983) 171-177: fit of Hertz's elliptical contact.

    Examples
    --------
    Computed here; the elliptic integrals are met within 1.5 %:

    >>> float(1000 * point_contact_half_length(2000.0, 113e9, 0.020, 0.500))
    2.774
    """
    share = roller_radius / crown_radius
    reduced_radius = roller_radius / (1 + share)
    flatness = ellipticity(share) ** 2 * (1.0003 + 0.5968 * share)
    return (3 / math.pi * flatness * normal_force * reduced_radius / contact_modulus) ** (1 / 3)


def ellipticity(radius_share: Quantity) -> Quantity:
    """Long over short axis of the contact ellipse.

    Equation: k = 1.0339 q**(-0.636)

    Parameters
    ----------
    radius_share : scalar, array or symbol
        Radius of the roller over that of its crown, q = R_x/R_y [-], at most 1.

    Returns
    -------
    scalar, array or symbol
        k [-].

    References
    ----------
    Hamrock and Brewe (1983), as point_contact_half_length.

    Examples
    --------
    By hand, 1.0339 x 10**0.636:

    >>> ellipticity(0.1)
    4.4718
    """
    return 1.0339 * radius_share**-0.6360


def point_contact_pressure(
    normal_force: Quantity, contact_modulus: Quantity, roller_radius: Quantity, crown_radius: Quantity
) -> Quantity:
    """Peak pressure of a crowned roller on a flat guide.

    Equation: p_H = 3 F_n k/(2 pi a_y**2), with k = 1.0339 (R_y/R_x)**0.636, a_y = point_contact_half_length(F_n, E*,
        R_x, R_y)

    Parameters
    ----------
    normal_force : scalar, array or symbol
        F_n [N].
    contact_modulus : scalar, array or symbol
        E* [Pa].
    roller_radius, crown_radius : scalar, array or symbol
        R_x and R_y, not smaller [m].

    Returns
    -------
    scalar, array or symbol
        p_H [Pa]; within 0.5 % of the elliptic integrals for rollers of 34 to 90 mm on a crown of 500 mm, 1.4 % low for
        16 mm.

    References
    ----------
    Hamrock and Brewe (1983), as point_contact_half_length.

    Examples
    --------
    Computed here; a cylindrical roller would reach 600 MPa on 10 mm:

    >>> float(point_contact_pressure(2000.0, 113e9, 0.020, 0.500) / 1e6)
    993.7
    """
    half_length = point_contact_half_length(normal_force, contact_modulus, roller_radius, crown_radius)
    ratio = ellipticity(roller_radius / crown_radius)
    return 3 * normal_force * ratio / (2 * math.pi * half_length**2)


def barrel_contact_pressure(
    normal_force: Quantity,
    loaded_rollers: Quantity,
    contact_modulus: Quantity,
    contact_length: Quantity,
    barrel_radius: Quantity,
) -> Quantity:
    """Peak pressure under a closed chain of barrel rollers in a cylindrical guide, line contact of F_n/k each.

    Equation: p_H = sqrt(F_n E*/(k pi l R))

    Parameters
    ----------
    normal_force : scalar, array or symbol
        F_n on the whole chain [N].
    loaded_rollers : scalar, array or symbol
        Rollers that share it k [-].
    contact_modulus : scalar, array or symbol
        E* [Pa].
    contact_length, barrel_radius : scalar, array or symbol
        Length of the barrels l, their radius R [m]; the profile of the barrel fits the guide.

    Returns
    -------
    scalar, array or symbol
        p_H [Pa].

    References
    ----------
    S3, XIV.3, for very large torque; equal shares are an assumption.

    Examples
    --------
    Four rollers that share have half the pressure of one:

    >>> one, four = (barrel_contact_pressure(2e4, k, 113e9, 0.020, 0.010) / 1e6 for k in (1, 4))
    >>> float(one / four)
    2.0
    """
    return line_contact_pressure(normal_force / loaded_rollers, contact_modulus, contact_length, barrel_radius)
