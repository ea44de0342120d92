"""Friction rings: geometry, torque and sizing of disc and multi-plate clutches.

Every function takes floats, arrays or CasADi symbols. Sizes enter as mean diameter dm and ring ratio
c = (ring width)/dm, because the products below then have no cancelling differences.

Sources: S0 (Szoke 1966), S1 (lecture on friction clutches), Shigley (Mechanical Engineering Design).
"""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = [
    "friction_radius",
    "friction_torque",
    "inner_diameter",
    "inner_plate_count",
    "mean_diameter",
    "outer_diameter",
    "outer_plate_count",
    "pressure_torque",
    "required_torque",
    "ring_area",
    "ring_ratio",
    "sizing_mean_diameter",
    "surfaces_needed",
    "worn_peak_pressure",
    "worn_torque",
]


def mean_diameter(outer_diameter: Quantity, inner_diameter: Quantity) -> Quantity:
    """Mean diameter of a friction ring.

    Equation: dm = (d_out + d_in)/2

    Parameters
    ----------
    outer_diameter, inner_diameter : scalar, array or symbol
        Diameters of the ring d_out, d_in [m].

    Returns
    -------
    scalar, array or symbol
        dm [m].

    References
    ----------
    S1 (lecture), sizing of the disc clutch; its d1 is the outer, d2 the inner diameter.

    Examples
    --------
    S1, sizing example (d1 = 258 mm, d2 = 155 mm, dm = 206 mm):

    >>> mean_diameter(258.111, 154.866)
    206.4885
    """
    return (outer_diameter + inner_diameter) / 2


def ring_ratio(outer_diameter: Quantity, inner_diameter: Quantity) -> Quantity:
    """Ring width over mean diameter.

    Equation: c = (d_out - d_in)/(d_out + d_in)

    Parameters
    ----------
    outer_diameter, inner_diameter : scalar, array or symbol
        Diameters of the ring d_out, d_in [m].

    Returns
    -------
    scalar, array or symbol
        c [-]; usual are 0.1 to 0.25 (multi-plate) and 0.11 to 0.13 (disc).

    References
    ----------
    S1 (lecture), c = b/dm.

    Examples
    --------
    S1, sizing example:

    >>> ring_ratio(258.1106, 154.8664)
    0.25000
    """
    return (outer_diameter - inner_diameter) / (outer_diameter + inner_diameter)


def outer_diameter(mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Outer diameter of a ring.

    Equation: d_out = dm (1 + c)

    Parameters
    ----------
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        d_out [m].

    References
    ----------
    S1 (lecture), sizing example.

    Examples
    --------
    S1 prints 258 mm:

    >>> outer_diameter(206.488499, 0.25)
    258.1106
    """
    return mean_diameter * (1 + ring_ratio)


def inner_diameter(mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Inner diameter of a ring.

    Equation: d_in = dm (1 - c)

    Parameters
    ----------
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        d_in [m].

    References
    ----------
    S1 (lecture), sizing example.

    Examples
    --------
    S1 prints 155 mm:

    >>> inner_diameter(206.488499, 0.25)
    154.8664
    """
    return mean_diameter * (1 - ring_ratio)


def friction_radius(mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Friction radius at uniform pressure.

    Equation: r = (dm/2) (1 + c**2/3)

    The factored form of 2/3 (r2**3 - r1**3)/(r2**2 - r1**2), which would cancel for narrow rings.

    Parameters
    ----------
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        r [m].

    References
    ----------
    S0 (Szoke 1966), friction radius of the ring; S0 prints 4.15 cm for its example, 4.12927 cm is right.

    Examples
    --------
    S0, rings of 3.5 and 4.7 cm radius:

    >>> friction_radius(8.2, 1.2 / 8.2)
    4.12927
    """
    return mean_diameter / 2 * (1 + ring_ratio**2 / 3)


def ring_area(mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Area of one friction surface.

    Equation: A1 = pi dm**2 c

    Parameters
    ----------
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        A1 [m2].

    References
    ----------
    S1 (lecture), A = z pi (d1**2 - d2**2)/4.

    Examples
    --------
    S1, ten surfaces of the sizing example, 3349 cm2:

    >>> 10 * ring_area(20.6488499, 0.25)
    3348.74
    """
    return np.pi * mean_diameter**2 * ring_ratio


def friction_torque(mu: Quantity, force: Quantity, friction_radius: Quantity, sum_factor: Quantity) -> Quantity:
    """Torque of a pack.

    Equation: M = mu F0 r E

    Parameters
    ----------
    mu : scalar, array or symbol
        Sliding friction mu [-].
    force : scalar, array or symbol
        Axial force of the actuator F0 [N].
    friction_radius : scalar, array or symbol
        r [m].
    sum_factor : scalar, array or symbol
        E [-]: the number of surfaces z, less what the guides take.

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S0 (Szoke 1966), eq. (1), (1a), (5).

    Examples
    --------
    The design form of the S1 sizing example (M_req = 1411.76 N m):

    >>> friction_torque(0.1, 13394.966, friction_radius(0.206488499, 0.25), 10)
    1411.76
    """
    return mu * force * friction_radius * sum_factor


def pressure_torque(
    surfaces: Quantity, mu: Quantity, pressure: Quantity, mean_diameter: Quantity, ring_ratio: Quantity
) -> Quantity:
    """Torque of z surfaces at uniform pressure without guide friction.

    Equation: M = z mu p pi dm**3 (3c + c**3)/6

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    mu : scalar, array or symbol
        Sliding friction mu [-].
    pressure : scalar, array or symbol
        p [Pa].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S1 (lecture), torque of the multi-plate clutch.

    Examples
    --------
    S1, sizing example (1412 N m):

    >>> pressure_torque(10, 0.1, 0.4e6, 0.206488499, 0.25)
    1411.76
    """
    return surfaces * mu * pressure * np.pi * mean_diameter**3 * (3 * ring_ratio + ring_ratio**3) / 6


def sizing_mean_diameter(
    torque: Quantity, surfaces: Quantity, mu: Quantity, pressure: Quantity, ring_ratio: Quantity
) -> Quantity:
    """Mean diameter that a torque needs.

    Equation: dm = cbrt(6 (M/z)/(mu pi (3c + c**3) p))

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    surfaces : scalar, array or symbol
        z [-]; 2 per disc.
    mu : scalar, array or symbol
        Sliding friction mu [-].
    pressure : scalar, array or symbol
        Allowed pressure p [Pa].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        dm [m].

    References
    ----------
    S1 (lecture), sizing of disc and multi-plate clutch.

    Examples
    --------
    S1, sizing example (206 mm):

    >>> float(sizing_mean_diameter(1411.7647, 10, 0.1, 0.4e6, 0.25) * 1000)
    206.488
    """
    return np.cbrt(6 * torque / (surfaces * mu * np.pi * (3 * ring_ratio + ring_ratio**3) * pressure))


def surfaces_needed(
    torque: Quantity, mean_diameter: Quantity, ring_ratio: Quantity, mu: Quantity, pressure: Quantity
) -> Quantity:
    """Even number of surfaces that a torque needs on a given ring, rounded up.

    Equation: z = 2 ceil(M/(2 M1)), with M1 = mu p pi dm**3 (3 c + c**3)/6

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].
    mu : scalar, array or symbol
        Sliding friction mu [-].
    pressure : scalar, array or symbol
        Allowed pressure p [Pa].

    Returns
    -------
    scalar, array or symbol
        z [-], even.

    References
    ----------
    S1 (lecture), number of surface pairs; without guide friction.

    Examples
    --------
    S1, sizing example: ten; with a slightly smaller ring twelve:

    >>> [float(surfaces_needed(1411.76, dm, 0.25, 0.1, 0.4e6)) for dm in (0.2065, 0.205)]
    [10.0, 12.0]
    """
    exact = torque / pressure_torque(1, mu, pressure, mean_diameter, ring_ratio)
    # A count that the arithmetic misses by its last digits only is not a reason for two more surfaces.
    return 2 * np.ceil(exact / 2 * (1 - 1e-12))


def outer_plate_count(surfaces: Quantity) -> Quantity:
    """Outer plates of a pack that ends in two inner plates.

    Equation: z_k = z/2

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-], even.

    Returns
    -------
    scalar, array or symbol
        z_k [-].

    References
    ----------
    S0 (Szoke 1966): 24 surfaces are 12 outer plates.

    Examples
    --------
    >>> outer_plate_count(24)
    12.0
    """
    return surfaces / 2


def inner_plate_count(surfaces: Quantity) -> Quantity:
    """Inner plates of a pack that ends in two inner plates.

    Equation: z_b = z/2 + 1

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-], even.

    Returns
    -------
    scalar, array or symbol
        z_b [-].

    References
    ----------
    S1 (lecture), z_b = z_k + 1 (the sign is lost in print).

    Examples
    --------
    >>> inner_plate_count(10)
    6.0
    """
    return surfaces / 2 + 1


def required_torque(
    load_torque: Quantity,
    safety_factor: Quantity,
    switching_factor: Quantity,
    speed_factor: Quantity,
    surface_factor: Quantity = 1.0,
) -> Quantity:
    """Sizing torque.

    Equation: M_req = n M_load/(c_m c_v c_z)

    Parameters
    ----------
    load_torque : scalar, array or symbol
        M_load [N m].
    safety_factor : scalar, array or symbol
        Shock factor n [-].
    switching_factor : scalar, array or symbol
        Engagement-count factor c_m [-].
    speed_factor : scalar, array or symbol
        Sliding-speed factor c_v [-].
    surface_factor : scalar, array or symbol
        Surface-count factor c_z [-]; 1 where the guide friction is computed instead.

    Returns
    -------
    scalar, array or symbol
        M_req [N m].

    References
    ----------
    S1 (lecture), sizing of the multi-plate clutch.

    Examples
    --------
    S1 prints 1412 N m:

    >>> required_torque(600, 1.5, 1, 0.85, 0.75)
    1411.76
    """
    return safety_factor * load_torque / (switching_factor * speed_factor * surface_factor)


def worn_torque(surfaces: Quantity, mu: Quantity, force: Quantity, mean_diameter: Quantity) -> Quantity:
    """Torque of a worn-in lining (pressure times radius constant).

    Equation: M = z mu F dm/2

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    mu : scalar, array or symbol
        Sliding friction mu [-].
    force : scalar, array or symbol
        Axial force F [N].
    mean_diameter : scalar, array or symbol
        dm [m].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch with uniform wear.

    Examples
    --------
    Computed here: 2 % below the new lining at c = 0.25:

    >>> worn_torque(10, 0.1, 13394.966, 0.206488499)
    1382.95
    """
    return surfaces * mu * force * mean_diameter / 2


def worn_peak_pressure(force: Quantity, mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Pressure at the inner edge of a worn-in lining.

    Equation: p = F/(pi dm**2 c (1 - c))

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force F [N].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        p [Pa].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch with uniform wear; 2 r1 (r2 - r1) = dm**2 c (1 - c).

    Examples
    --------
    Computed here, ring of 3.5 and 4.7 cm radius under 1 kN: 1000/(2 pi 0.035 0.012):

    >>> worn_peak_pressure(1000, 0.082, 0.012 / 0.082)
    378940.
    """
    return force / (np.pi * mean_diameter**2 * ring_ratio * (1 - ring_ratio))
