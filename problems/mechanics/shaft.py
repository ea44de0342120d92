"""Shaft and hub of a clutch: what every clutch has beside the parts that its own formulas size.

Every function takes floats, arrays or CasADi symbols.

Sources: elementary strength of materials, DIN 743-2; the proportions are engineering practice, stated where they are
used.
"""

from __future__ import annotations

import math

import numpy as np

from . import Quantity

__all__ = ["BOSS_LENGTH", "TEST_BAR", "boss_mass", "fatigue_shear", "shaft_diameter", "size_factor"]

BOSS_LENGTH = 1.2  # of the shaft diameter: room for a parallel key that carries the torque of the shaft
_NOTCH_FACTOR = 2.0  # of a keyway: stress that counts for fatigue over that of the plain shaft
_PULSATING_SHARE = 0.5  # of the torque of a drive that starts over and over and never reverses
TEST_BAR = 0.0075  # diameter of a test bar for fatigue [m]


def shaft_diameter(torque: Quantity, shear_stress: Quantity) -> Quantity:
    """Diameter of a solid shaft that carries a torque.

    Equation: d_s = (16 M/(pi tau))**(1/3)

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    shear_stress : scalar, array or symbol
        Allowed shear stress tau [Pa].

    Returns
    -------
    scalar, array or symbol
        d_s [m].

    References
    ----------
    Torsion of a solid shaft, tau = 16 M/(pi d**3).

    Examples
    --------
    By hand, a shaft of 50 mm at 40 N/mm2 carries pi/16 40 50**3 N mm = 981.75 N m:

    >>> shaft_diameter(981.748, 40e6)
    0.05
    """
    return (16 / np.pi * torque / shear_stress) ** (1 / 3)


def size_factor(diameter: Quantity) -> Quantity:
    """Strength of a shaft over that of a test bar: thick ones are hardened less, and fail from smaller flaws.

    Equation: K_d = min(1, 1 - 0.26 ln(7.5 d/(16 d_B))/ln(10)) min(1, 1 - 0.2 ln(d/d_B)/ln(20)), with d_B = 0.0075

    Parameters
    ----------
    diameter : scalar, array or symbol
        At the root of the notch d [m].

    Returns
    -------
    scalar, array or symbol
        K_d [-].

    References
    ----------
    DIN 743-2, from memory: heat-treated steel hardens through up to 16 mm, and geometric size. Beyond 150 mm it is
    cautious, as the standard does not go on below 0.8 in the second.

    Examples
    --------
    By hand, 0.26 ln(65/16)/ln(10) = 0.15829 and 0.2 ln(65/7.5)/ln(20) = 0.14417:

    >>> float(size_factor(0.065))
    0.7204
    """
    hardened = np.minimum(1, 1 - 0.26 / np.log(10) * np.log(diameter / TEST_BAR * (7.5 / 16)))
    return hardened * np.minimum(1, 1 - 0.2 / np.log(20) * np.log(diameter / TEST_BAR))


def fatigue_shear(fatigue_strength: Quantity, size_factor: Quantity, safety: Quantity) -> Quantity:
    """Shear stress that a shaft with a keyway stands in a drive that starts over and over and never reverses.

    Equation: tau = sigma_bW K_d/(2 0.5 sqrt(3) S_D)

    Parameters
    ----------
    fatigue_strength : scalar, array or symbol
        In reversed bending sigma_bW [Pa].
    size_factor : scalar, array or symbol
        K_d [-].
    safety : scalar, array or symbol
        S_D [-].

    Returns
    -------
    scalar, array or symbol
        tau [Pa].

    References
    ----------
    DIN 743-2, from memory: 2 sqrt(3) (0.5 tau) <= sigma_bW K_d/S_D without bending. The notch factor 2 of a keyway and
    the share 0.5 of the torque that pulsates are engineering practice.

    Examples
    --------
    By hand, C45 of 65 mm, 315 0.72036/(sqrt(3) 1.5):

    >>> fatigue_shear(315e6, 0.72036, 1.5) / 1e6
    87.339
    """
    return fatigue_strength * size_factor / (_NOTCH_FACTOR * _PULSATING_SHARE * math.sqrt(3) * safety)


def boss_mass(density: Quantity, diameter: Quantity, hub_factor: Quantity) -> Quantity:
    """Mass of the boss of a hub on its shaft.

    Equation: m = rho pi (k_b**2 - 1) (d_s/2)**2 1.2 d_s

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    diameter : scalar, array or symbol
        Of the shaft d_s [m].
    hub_factor : scalar, array or symbol
        Outside of the hub over its bore k_b [-].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the length of 1.2 d_s is engineering practice.

    Examples
    --------
    By hand, 7850 pi (1.5**2 - 1) 0.025**2 0.06:

    >>> boss_mass(7850, 0.05, 1.5)
    1.156
    """
    return density * np.pi * (hub_factor**2 - 1) / 4 * BOSS_LENGTH * diameter**3
