"""Disc clutch: mass, inertia, length and pressure of one or two lined discs between pressure plates.

Torque, ring integrals and sizing are those of :mod:`synth.problems.mechanics.ring`. Every function takes floats, arrays
or CasADi symbols.

Sources: S1 (lecture on friction clutches), disc clutch and its use in motor cars; Shigley (Mechanical Engineering
Design), uniform wear; geometry.
"""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = [
    "COVER_LEAST",
    "COVER_RATIO",
    "HOTTEST_PLATE_SHARE",
    "SPRING_RATIO",
    "SPRING_ROOM",
    "clutch_length",
    "core_inertia",
    "cover_mass",
    "cover_thickness",
    "diaphragm_spring_mass",
    "disc_inertia",
    "hub_mass",
    "lining_inertia",
    "pressure_plate_mass",
    "surface_count",
    "worn_pressure",
]

# The linings insulate, so that the metal takes the heat. The pressure plate of a single disc meets one surface of two;
# of a twin disc the intermediate plate is the hottest and meets two of four.
HOTTEST_PLATE_SHARE = 0.5  # of the work of an engagement, that enters the hottest plate


def surface_count(discs: Quantity) -> Quantity:
    """Friction surface pairs of lined discs.

    Equation: z = 2 n_d

    Parameters
    ----------
    discs : scalar, array or symbol
        n_d [-].

    Returns
    -------
    scalar, array or symbol
        z [-].

    References
    ----------
    S1 (lecture), disc clutch of a motor car: two friction surface pairs.

    Examples
    --------
    >>> surface_count(1), surface_count(2)
    (2, 4)
    """
    return 2 * discs


def pressure_plate_mass(density: Quantity, thickness: Quantity, ring_area: Quantity) -> Quantity:
    """Mass of a pressure plate as wide as the friction ring.

    Equation: m = rho t_p A1

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    thickness : scalar, array or symbol
        t_p [m].
    ring_area : scalar, array or symbol
        Area of one friction surface A1 [m2].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 7200 x 0.01 x 0.02:

    >>> pressure_plate_mass(7200, 0.01, 0.02)
    1.44
    """
    return density * thickness * ring_area


def lining_inertia(density: Quantity, thickness: Quantity, mean_diameter: Quantity, ring_ratio: Quantity) -> Quantity:
    """Moment of inertia of the two linings of a disc.

    Equation: J = rho t pi dm**4 c (1 + c**2)/2

    Uses r2**4 - r1**4 = dm**4 c (1 + c**2)/2.

    Parameters
    ----------
    density : scalar, array or symbol
        Density of the lining rho [kg/m3].
    thickness : scalar, array or symbol
        Thickness of one lining t [m].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].

    Returns
    -------
    scalar, array or symbol
        Inertia of both [kg m2].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 2000 x 0.003 x pi (0.112**4 - 0.088**4):

    >>> lining_inertia(2000, 0.003, 0.2, 0.12)
    0.0018356
    """
    return density * thickness * np.pi * mean_diameter**4 * ring_ratio * (1 + ring_ratio**2) / 2


def core_inertia(density: Quantity, thickness: Quantity, outer_radius: Quantity, hub_radius: Quantity) -> Quantity:
    """Moment of inertia of the core of a disc.

    Equation: J = rho t_core pi (r2**4 - r_hub**4)/2

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    thickness : scalar, array or symbol
        t_core [m].
    outer_radius, hub_radius : scalar, array or symbol
        r2, r_hub [m].

    Returns
    -------
    scalar, array or symbol
        Inertia [kg m2].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 7850 x 0.002 x pi (0.112**4 - 0.02**4)/2:

    >>> core_inertia(7850, 0.002, 0.112, 0.02)
    0.0038766
    """
    return density * thickness * np.pi * (outer_radius**4 - hub_radius**4) / 2


def disc_inertia(discs: Quantity, lining: Quantity, core: Quantity) -> Quantity:
    """Moment of inertia of the discs on the driven shaft.

    Equation: J_disc = n_d (J_lining + J_core)

    Parameters
    ----------
    discs : scalar, array or symbol
        n_d [-].
    lining, core : scalar, array or symbol
        Of one disc both linings J_lining and the core J_core [kg m2].

    Returns
    -------
    scalar, array or symbol
        J_disc [kg m2]; a gearbox has to synchronise it when it shifts.

    References
    ----------
    Geometry.

    Examples
    --------
    >>> disc_inertia(2, 0.0018356, 0.0038766)
    0.0114244
    """
    return discs * (lining + core)


def clutch_length(
    discs: Quantity, lining_thickness: Quantity, core_thickness: Quantity, plate_thickness: Quantity, gap: Quantity
) -> Quantity:
    """Length of the released clutch.

    Equation: L = n_d (2 t_lining + t_core + t_p) + 2 n_d gap

    Parameters
    ----------
    discs : scalar, array or symbol
        n_d [-].
    lining_thickness : scalar, array or symbol
        One lining t_lining [m].
    core_thickness : scalar, array or symbol
        t_core [m].
    plate_thickness : scalar, array or symbol
        Pressure plate t_p [m].
    gap : scalar, array or symbol
        Release gap per surface, gap [m].

    Returns
    -------
    scalar, array or symbol
        Length [m], without flywheel, springs and cover.

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 2 (2 x 3 + 2 + 8) + 4 x 0.3 mm:

    >>> clutch_length(2, 3, 2, 8, 0.3)
    33.2
    """
    return discs * (2 * lining_thickness + core_thickness + plate_thickness) + surface_count(discs) * gap


def worn_pressure(force: Quantity, mean_diameter: Quantity, ring_ratio: Quantity, radius: Quantity) -> Quantity:
    """Pressure of a worn-in lining at a radius.

    Equation: p = F/(2 pi r dm c)

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force F [N].
    mean_diameter : scalar, array or symbol
        dm [m].
    ring_ratio : scalar, array or symbol
        c [-].
    radius : scalar, array or symbol
        r [m], from r1 to r2.

    Returns
    -------
    scalar, array or symbol
        p [Pa].

    References
    ----------
    Shigley, Mechanical Engineering Design, disc clutch with uniform wear: p r is constant.

    Examples
    --------
    By hand, 1000/(2 pi 0.035 0.012), at the inner edge of a ring of 3.5 and 4.7 cm:

    >>> worn_pressure(1000, 0.082, 0.012 / 0.082, 0.035)
    378940.
    """
    return force / (2 * np.pi * radius * mean_diameter * ring_ratio)


COVER_LEAST = 3e-3  # least thickness of a cover [m]: practice
COVER_RATIO = 60.0  # outside diameter over thickness of a cover: practice
SPRING_RATIO = 90.0  # ring diameter over thickness of a diaphragm spring: practice
SPRING_ROOM = 0.12  # length of a dished diaphragm spring with its bearing over ring diameter: practice


def cover_thickness(diameter: Quantity) -> Quantity:
    """Thickness of the pressed cover, 3 mm at least.

    Equation: t_c = max(0.003, D/60)

    Parameters
    ----------
    diameter : scalar, array or symbol
        Outside of the clutch D [m].

    Returns
    -------
    scalar, array or symbol
        t_c [m].

    References
    ----------
    Engineering practice, unsourced.

    Examples
    --------
    >>> float(cover_thickness(0.24)), float(cover_thickness(0.1))
    (0.004, 0.003)
    """
    return np.maximum(COVER_LEAST, diameter / COVER_RATIO)


def hub_mass(density: Quantity, discs: Quantity, hub_radius: Quantity, shaft_diameter: Quantity) -> Quantity:
    """Mass of the hubs of the discs, as long as the shaft is thick.

    Equation: m = n_d rho pi (r_hub**2 - (d_s/2)**2) d_s

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    discs : scalar, array or symbol
        n_d [-].
    hub_radius : scalar, array or symbol
        r_hub [m].
    shaft_diameter : scalar, array or symbol
        d_s [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the length is engineering practice.

    Examples
    --------
    By hand, 7850 pi (0.03**2 - 0.02**2) 0.04:

    >>> hub_mass(7850, 1, 0.03, 0.04)
    0.49323
    """
    return density * np.pi * discs * (hub_radius**2 - (shaft_diameter / 2) ** 2) * shaft_diameter


def cover_mass(density: Quantity, diameter: Quantity, length: Quantity) -> Quantity:
    """Mass of the cover, a ring face of 60 % of the disc and a shell.

    Equation: m = rho t_c (0.6 pi D**2/4 + pi D L), with t_c = max(0.003, D/60)

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    diameter, length : scalar, array or symbol
        Outside D and length L of discs and pressure plates [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the share of 60 % is engineering practice.

    Examples
    --------
    By hand, 7850 0.004 (0.6 pi 0.24**2/4 + pi 0.24 0.03):

    >>> float(cover_mass(7850, 0.24, 0.03))
    1.56255
    """
    return density * cover_thickness(diameter) * (0.15 * np.pi * diameter**2 + np.pi * diameter * length)


def diaphragm_spring_mass(density: Quantity, outer_radius: Quantity) -> Quantity:
    """Mass of a diaphragm spring, three quarters of a disc of 0.9 r2.

    Equation: m = rho pi 0.75 (0.9 r2)**2 (2 r2/90)

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    outer_radius : scalar, array or symbol
        Of the friction ring r2 [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the proportions are engineering practice.

    Examples
    --------
    By hand, 7850 pi 0.75 0.09**2 0.2/90:

    >>> diaphragm_spring_mass(7850, 0.1)
    0.33294
    """
    return density * np.pi * 0.75 * (0.9 * outer_radius) ** 2 * (2 * outer_radius / SPRING_RATIO)
