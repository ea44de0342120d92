"""Torque curves of driving motors."""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = ["breakdown_slip", "kloss_torque"]


def kloss_torque(
    speed: Quantity, synchronous_speed: Quantity, breakdown_torque: Quantity, breakdown_slip: Quantity
) -> Quantity:
    """Torque of an asynchronous motor over its speed.

    Equation: M1 = 2 M_b s s_b/(s**2 + s_b**2), with s = 1 - omega1/omega_sync

    Above the synchronous speed it is negative: the motor brakes.

    Parameters
    ----------
    speed : scalar, array or symbol
        omega1 [rad/s].
    synchronous_speed : scalar, array or symbol
        omega_sync [rad/s].
    breakdown_torque : scalar, array or symbol
        M_b [N m].
    breakdown_slip : scalar, array or symbol
        Slip at the breakdown torque s_b [-].

    Returns
    -------
    scalar, array or symbol
        M1 [N m].

    References
    ----------
    M. Kloss, Drehmoment und Schluepfung des Drehstrommotors, 1909: stator resistance left out.

    Examples
    --------
    By hand, at the breakdown slip the breakdown torque, at standstill 2 x 300/(5 + 0.2):

    >>> kloss_torque(80.0, 100, 300, 0.2), kloss_torque(0.0, 100, 300, 0.2)
    (300.0, 115.385)
    """
    slip = 1 - speed / synchronous_speed
    return 2 * breakdown_torque * slip * breakdown_slip / (slip**2 + breakdown_slip**2)


def breakdown_slip(rated_slip: Quantity, pullout_torque_ratio: Quantity) -> Quantity:
    """Slip at the breakdown torque that the rated point asks for.

    Equation: s_b = s_N (k + sqrt(k**2 - 1))

    Parameters
    ----------
    rated_slip : scalar, array or symbol
        s_N [-].
    pullout_torque_ratio : scalar, array or symbol
        k = M_b/M_N [-], at least 1.

    Returns
    -------
    scalar, array or symbol
        s_b [-].

    References
    ----------
    Kloss's curve through the rated point (s_N, M_N).

    Examples
    --------
    Computed here, k = 3 and 2.67 % rated slip:

    >>> float(breakdown_slip(0.0267, 3.0))
    0.15562
    """
    return rated_slip * (pullout_torque_ratio + np.sqrt(pullout_torque_ratio**2 - 1))
