"""Wear of friction linings.

Every function takes floats, arrays or CasADi symbols.
"""

from __future__ import annotations

from . import Quantity

__all__ = ["wear_life"]


def wear_life(area: Quantity, depth: Quantity, wear_rate: Quantity, friction_work: Quantity) -> Quantity:
    """Engagements until the linings are worn.

    Equation: N = A d_w/(k_w W)

    Parameters
    ----------
    area : scalar, array or symbol
        All friction surfaces A [m2].
    depth : scalar, array or symbol
        Wear of one lining before it is replaced d_w [m].
    wear_rate : scalar, array or symbol
        Volume worn off per friction work k_w [m3/J]; 1 mm3/MJ is 1e-15 m3/J.
    friction_work : scalar, array or symbol
        Work of one engagement W [J].

    Returns
    -------
    scalar, array or symbol
        N [-].

    References
    ----------
    Wear volume in proportion to friction work (Archard).

    Examples
    --------
    By hand, 0.1 m2 worn by 0.5 mm are 50 000 mm3; 40 kJ wear off 0.4 mm3 at 10 mm3/MJ:

    >>> wear_life(0.1, 0.5e-3, 10e-15, 40e3)
    125000.0
    """
    return area * depth / (wear_rate * friction_work)
