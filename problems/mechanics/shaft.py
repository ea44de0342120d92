"""Shaft and hub of a clutch: what every clutch has beside the parts that its own formulas size.

Every function takes floats, arrays or CasADi symbols.

Sources: elementary strength of materials; the proportions are engineering practice, stated where they are used.
"""

from __future__ import annotations

import numpy as np

from problems.mechanics import Quantity

__all__ = [
    "BOSS_LENGTH",
    "boss_mass",
    "shaft_diameter",
]

BOSS_LENGTH = 1.2  # of the shaft diameter: room for a parallel key that carries the torque of the shaft


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
