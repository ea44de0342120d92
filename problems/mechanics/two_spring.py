"""Device B: balls or levers push a tension disc, which presses clamp springs on the pressure plate; a stop caps them.

Return springs R1 (set rate s1, preload F10) push the plate back, clamp springs R2 (s2, F20) stand between tension disc
and plate. The tension disc travels x up to its stop at b, the plate z up to the friction disc at a. F = F_C i eta is
the axial force of the flyweights.

| regime           | while       | x             | z             | force of R1 | of R2 | clamp force |
|------------------|-------------|---------------|---------------|-------------|-------|-------------|
| 0 rest           | F <= F20    | 0             | 0             | F10         | F20   | 0           |
| 1 tension disc   | F20 .. F10  | (F - F20)/s2  | 0             | F10         | F     | 0           |
| 2 both           | F10 .. Fa   | z + (F-F20)/s2| (F - F10)/s1  | F           | F     | 0           |
| 3 clamping       | Fa .. Fb    | a + (F-F20)/s2| a             | Fa          | F     | F - Fa      |
| 4 stopped        | from Fb on  | b             | a             | Fa          | Fb    | Fb - Fa     |

with Fa = F10 + s1 a and Fb = F20 + s2 (b - a). R1 and R2 are in series until the plate touches: one force F goes
through both. S4 adds their forces, which practice 1 of the same source refutes (it wants 84 N where the sum is 168 N),
and it asks for F20 > F10, with which the plate would creep onto the disc at rest.

Every function takes floats, arrays or CasADi symbols. Source: S4 (notes on centrifugal clutches), analysis 2,
corrected; friction, wear and the conditions against snapping are derived.
"""

from __future__ import annotations

import numpy as np

from . import Quantity

__all__ = [
    "clamp_force",
    "clamp_force_at",
    "clamp_spring_travel",
    "contact_force",
    "contact_travel",
    "disc_travel",
    "plate_travel_at",
    "stop_force",
    "stop_load",
    "stretched_force",
    "worn_clamp_force",
    "worn_contact_travel",
]


def stretched_force(preload: Quantity, deflection: Quantity, travel: Quantity) -> Quantity:
    """Force of a spring set, from its preload and how far it is deflected further.

    Equation: F = F0 (1 + x/delta)

    Parameters
    ----------
    preload : scalar, array or symbol
        Force of a spring set at rest F0 [N].
    deflection : scalar, array or symbol
        Its deflection at rest delta [m].
    travel : scalar, array or symbol
        What is added to the deflection x [m].

    Returns
    -------
    scalar, array or symbol
        F [N].

    References
    ----------
    Statics: F0 = s delta, so that the rate does not appear.

    Examples
    --------
    S4, practice 1 (F10 = 60 N at s1 = 8 N/mm, that is 7.5 mm; 84 N after 3 mm):

    >>> stretched_force(60.0, 7.5e-3, 3e-3)
    84.0
    """
    return preload * (1 + travel / deflection)


def clamp_spring_travel(force: Quantity, clamp_preload: Quantity, deflection: Quantity) -> Quantity:
    """By how much the clamp springs give beyond their preload.

    Equation: x - z = delta2 (F/F20 - 1)

    Parameters
    ----------
    force : scalar, array or symbol
        Force through the clamp springs F [N].
    clamp_preload : scalar, array or symbol
        Preload of the clamp springs F20 [N].
    deflection : scalar, array or symbol
        Their deflection at rest delta2 [m].

    Returns
    -------
    scalar, array or symbol
        x - z [m].

    References
    ----------
    S4, analysis 2: (F - F20)/s2, with F20 = s2 delta2; at F = F10 it is x_p, the travel at which the plate starts.

    Examples
    --------
    S4, practice 1 (F10 = 60 N, F20 = 50 N at s2 = 4 N/mm, that is 12.5 mm; 2.5 mm):

    >>> 1000 * clamp_spring_travel(60.0, 50.0, 12.5e-3)
    2.5
    """
    return deflection * (force / clamp_preload - 1)


def contact_force(return_preload: Quantity, return_rate: Quantity, plate_travel: Quantity) -> Quantity:
    """Force at contact.

    Equation: Fa = F10 + s1 a

    Parameters
    ----------
    return_preload : scalar, array or symbol
        Preload of the return springs F10 [N].
    return_rate : scalar, array or symbol
        Rate of the return springs s1 [N/m].
    plate_travel : scalar, array or symbol
        Gap of the plate a [m].

    Returns
    -------
    scalar, array or symbol
        Fa [N].

    References
    ----------
    S4, analysis 2, force of R1 at z = a.

    Examples
    --------
    S4, practice 1 (84 N):

    >>> contact_force(60.0, 8e3, 3e-3)
    84.0
    """
    return return_preload + return_rate * plate_travel


def contact_travel(
    contact_force: Quantity, clamp_preload: Quantity, clamp_deflection: Quantity, plate_travel: Quantity
) -> Quantity:
    """Travel of the tension disc at contact.

    Equation: x_c = a + delta2 (Fa/F20 - 1)

    Parameters
    ----------
    contact_force : scalar, array or symbol
        Force at contact Fa [N].
    clamp_preload : scalar, array or symbol
        Preload of the clamp springs F20 [N].
    clamp_deflection : scalar, array or symbol
        Deflection of the clamp springs at rest delta2 [m].
    plate_travel : scalar, array or symbol
        Gap of the plate a [m].

    Returns
    -------
    scalar, array or symbol
        x_c [m].

    References
    ----------
    S4, analysis 2, eq. (8), corrected: R1 and R2 are in series, so that x_c = a + (Fa - F20)/s2.

    Examples
    --------
    S4, practice 1 (11.5 mm):

    >>> 1000 * contact_travel(84.0, 50.0, 12.5e-3, 3e-3)
    11.5
    """
    return plate_travel + clamp_spring_travel(contact_force, clamp_preload, clamp_deflection)


def stop_force(
    clamp_preload: Quantity, clamp_rate: Quantity, plate_travel: Quantity, stop_travel: Quantity
) -> Quantity:
    """Force at the stop.

    Equation: Fb = F20 + s2 (b - a)

    Parameters
    ----------
    clamp_preload : scalar, array or symbol
        Preload of the clamp springs F20 [N].
    clamp_rate : scalar, array or symbol
        Rate of the clamp springs s2 [N/m].
    plate_travel : scalar, array or symbol
        Gap of the plate a [m].
    stop_travel : scalar, array or symbol
        Way of the tension disc to its stop b [m].

    Returns
    -------
    scalar, array or symbol
        Fb [N].

    References
    ----------
    S4, analysis 2, eq. (12), corrected.

    Examples
    --------
    S4, practice 1, rounded (b = 18.3 mm; 111.2 N):

    >>> stop_force(50.0, 4e3, 3e-3, 18.3e-3)
    111.2
    """
    return clamp_preload + clamp_rate * (stop_travel - plate_travel)


def clamp_force(stop_force: Quantity, contact_force: Quantity) -> Quantity:
    """Largest clamp force.

    Equation: F_N = Fb - Fa

    Parameters
    ----------
    stop_force : scalar, array or symbol
        Force at the stop Fb [N].
    contact_force : scalar, array or symbol
        Force at contact Fa [N].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    References
    ----------
    S4, analysis 2, eq. (14) and (15), with their signs corrected: F20 + s2 (b - a) - F10 - s1 a.

    Examples
    --------
    S4, practice 1, rounded (27.2 N):

    >>> clamp_force(111.2, 84.0)
    27.2
    """
    return stop_force - contact_force


def worn_clamp_force(clamp_force: Quantity, return_rate: Quantity, clamp_rate: Quantity, wear: Quantity) -> Quantity:
    """Largest clamp force with worn lining.

    Equation: F_Nw = F_N - (s1 + s2) w

    Parameters
    ----------
    clamp_force : scalar, array or symbol
        Largest clamp force, new lining F_N [N].
    return_rate : scalar, array or symbol
        Rate of the return springs s1 [N/m].
    clamp_rate : scalar, array or symbol
        Rate of the clamp springs s2 [N/m].
    wear : scalar, array or symbol
        Wear of the lining w [m].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    References
    ----------
    Derived; not in S4: a grows by w, b stays.

    Examples
    --------
    Computed here, practice 1 with 0.6 mm of wear:

    >>> worn_clamp_force(27.2, 8e3, 4e3, 0.6e-3)
    20.0
    """
    return clamp_force - (return_rate + clamp_rate) * wear


def worn_contact_travel(
    contact_travel: Quantity, return_rate: Quantity, clamp_rate: Quantity, wear: Quantity
) -> Quantity:
    """Travel of the tension disc at contact with worn lining.

    Equation: x_cw = x_c + w (1 + s1/s2)

    Parameters
    ----------
    contact_travel : scalar, array or symbol
        Travel at contact, new lining x_c [m].
    return_rate : scalar, array or symbol
        Rate of the return springs s1 [N/m].
    clamp_rate : scalar, array or symbol
        Rate of the clamp springs s2 [N/m].
    wear : scalar, array or symbol
        Wear of the lining w [m].

    Returns
    -------
    scalar, array or symbol
        x_c [m].

    References
    ----------
    Derived; not in S4.

    Examples
    --------
    Computed here, practice 1 with 0.6 mm of wear:

    >>> 1000 * worn_contact_travel(11.5e-3, 8e3, 4e3, 0.6e-3)
    13.3
    """
    return contact_travel + wear * (1 + return_rate / clamp_rate)


def plate_travel_at(
    force: Quantity, return_preload: Quantity, return_rate: Quantity, plate_travel: Quantity
) -> Quantity:
    """Travel of the plate under a force, between 0 and its gap.

    Equation: z = min(max((F - F10)/s1, 0), a)

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force of the flyweights F [N].
    return_preload : scalar, array or symbol
        Preload of the return springs F10 [N].
    return_rate : scalar, array or symbol
        Rate of the return springs s1 [N/m].
    plate_travel : scalar, array or symbol
        Gap of the plate a [m].

    Returns
    -------
    scalar, array or symbol
        z [m].

    References
    ----------
    S4, analysis 2, eq. (10), corrected.

    Examples
    --------
    S4, practice 2 (5 mm at 300 N):

    >>> 1000 * float(plate_travel_at(300.0, 200.0, 20e3, 0.010))
    5.0
    """
    return np.clip((force - return_preload) / return_rate, 0.0, plate_travel)


def disc_travel(
    force: Quantity,
    return_preload: Quantity,
    clamp_preload: Quantity,
    return_rate: Quantity,
    clamp_rate: Quantity,
    plate_travel: Quantity,
    stop_travel: Quantity,
) -> Quantity:
    """Travel of the tension disc under a force, by the table above.

    Equation: x = min(z + max(F - F20, 0)/s2, b), with z = min(max((F - F10)/s1, 0), a)

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force of the flyweights F [N].
    return_preload : scalar, array or symbol
        Preload of the return springs F10 [N].
    clamp_preload : scalar, array or symbol
        Preload of the clamp springs F20 [N].
    return_rate : scalar, array or symbol
        Rate of the return springs s1 [N/m].
    clamp_rate : scalar, array or symbol
        Rate of the clamp springs s2 [N/m].
    plate_travel : scalar, array or symbol
        Gap of the plate a [m].
    stop_travel : scalar, array or symbol
        Way of the tension disc to its stop b [m].

    Returns
    -------
    scalar, array or symbol
        x [m].

    References
    ----------
    S4, analysis 2, corrected; as one expression: x = (F - F20)/s2 and what the plate has moved, up to b.

    Examples
    --------
    S4, practice 2 (F10 = 200 N, s1 = 20, s2 = 80 N/mm, a = 10, b = 20 mm; 8.75 mm at 300 N):

    >>> 1000 * float(disc_travel(300.0, 200.0, 0.0, 20e3, 80e3, 0.010, 0.020))
    8.75
    """
    plate = plate_travel_at(force, return_preload, return_rate, plate_travel)
    spring = np.maximum(force - clamp_preload, 0.0) / clamp_rate
    return np.minimum(plate + spring, stop_travel)


def clamp_force_at(force: Quantity, contact_force: Quantity, stop_force: Quantity) -> Quantity:
    """Clamp force under a force of the flyweights.

    Equation: F_N = min(max(F, Fa), Fb) - Fa

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force of the flyweights F [N].
    contact_force : scalar, array or symbol
        Force at contact Fa [N].
    stop_force : scalar, array or symbol
        Force at the stop Fb [N].

    Returns
    -------
    scalar, array or symbol
        F_N [N].

    References
    ----------
    S4, analysis 2, eq. (14), corrected.

    Examples
    --------
    S4, practice 2 (200 N at 600 N):

    >>> float(clamp_force_at(600.0, 400.0, 800.0))
    200.0
    """
    return np.clip(force, contact_force, stop_force) - contact_force


def stop_load(force: Quantity, stop_force: Quantity) -> Quantity:
    """Force on the stop of the tension disc, not below 0.

    Equation: F_stop = max(F - Fb, 0)

    Parameters
    ----------
    force : scalar, array or symbol
        Axial force of the flyweights F [N].
    stop_force : scalar, array or symbol
        Force at the stop Fb [N].

    Returns
    -------
    scalar, array or symbol
        Force [N].

    References
    ----------
    S4, analysis 2: what the springs do not take the stop takes.

    Examples
    --------
    S4, practice 2 (3200 N at 4000 N):

    >>> float(stop_load(4000.0, 800.0))
    3200.0
    """
    return np.maximum(force - stop_force, 0.0)
