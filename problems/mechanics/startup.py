"""Start-up of a driven inertia through a slipping clutch: closed forms in every regime.

The driver keeps its speed omega1. The clutch torque rises in proportion to time and stays constant after the ramp,
M_k(t) = T min(t/t_r, 1), until the driven side, inertia J and load torque L, has caught up (lock). Two kinds of load:

* reactive: the load only resists; the driven side stands still until M_k has reached L (a load on the
  ground with the rope just taut, dry friction);
* active: the load acts from the beginning and turns the driven side backwards until M_k has reached L.

Both are valid where T > L only; otherwise the clutch never starts the load (:func:`never_starts`). Every
function takes floats, arrays or CasADi symbols, in SI. Each regime (lock before or after the end of the
ramp, greatest power inside or at the end of the ramp) is chosen by its condition; the formulas agree on the border.

The expressions are arranged so that, as far as possible, each factor rises or falls with T and t_r the same way
(1 + L/(T-L) for T/(T-L), 1 - L/T for (T-L)/T): bounds over a range of designs are then as sharp as the formulas.

Source: S1 (lecture), start-up by the clutch; the lecture integrates graphically, the closed forms are derived from its
equations of motion M1 - M_k = J1 domega1/dt (J1 infinite) and M_k - M2 = J2 domega2/dt.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from synth.errors import InputError
from synth.special import special

from . import Quantity

__all__ = [
    "LOAD_KINDS",
    "StartupPhases",
    "active_lock_in_ramp",
    "burn_out_time",
    "catch_up_time",
    "constant_torque_slip",
    "driven_back_work",
    "excess_share",
    "friction_work",
    "kinetic_energy",
    "load_start_time",
    "lock_torque",
    "locks_after_ramp",
    "lowest_driven_speed",
    "never_starts",
    "peak_power_root",
    "peak_slip_power",
    "ramp_relief",
    "ramp_work",
    "reactive_friction_work",
    "reactive_peak_slip_power",
    "reactive_slip_time",
    "run_up_work",
    "slip_time",
    "startup_phases",
    "torque_rate_per_inertia",
]

LOAD_KINDS = ("reactive", "active")


def _is_active(load_kind: str) -> bool:
    if load_kind not in LOAD_KINDS:
        raise InputError("load_kind", load_kind, "reactive or active")
    return load_kind == "active"


def never_starts(torque: Quantity, load_torque: Quantity) -> Quantity:
    """Whether the clutch cannot move the load.

    Equation: never = T <= L

    Parameters
    ----------
    torque : scalar, array or symbol
        Clutch torque at the end of the ramp T [N m].
    load_torque : scalar, array or symbol
        L [N m].

    Returns
    -------
    bool, array or symbol
        True where the clutch slips for ever.

    References
    ----------
    S1 (lecture), start-up.

    Examples
    --------
    >>> never_starts(1080, 1200), never_starts(1080, 600)
    (True, False)
    """
    return torque <= load_torque


def burn_out_time(
    torque: Quantity, driver_speed: Quantity, heat_capacity: Quantity, temperature_rise: Quantity
) -> Quantity:
    """Time in which a clutch that never starts its load reaches a temperature rise.

    Equation: t = C dT/(T omega1)

    Parameters
    ----------
    torque : scalar, array or symbol
        T [N m].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    heat_capacity : scalar, array or symbol
        C [J/K].
    temperature_rise : scalar, array or symbol
        Allowed rise dT [K].

    Returns
    -------
    scalar, array or symbol
        Time [s].

    References
    ----------
    Heat balance: all the driver's power becomes heat.

    Examples
    --------
    By hand, 5000 x 100/(1000 x 25):

    >>> burn_out_time(1000, 25, 5000, 100)
    20.0
    """
    return heat_capacity * temperature_rise / (torque * driver_speed)


def locks_after_ramp(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> Quantity:
    """Whether lock-up comes after the end of the ramp.

    Equation: after = t_r (T - 2 L) <= 2 J omega1 if active else (T - L)**2 t_r < 2 J T omega1

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s].
    load_kind : str
        reactive or active.

    Returns
    -------
    bool, array or symbol
        True where the ramp ends before lock-up.

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture): "check omega2C <= omega1".

    Examples
    --------
    S1's start-up, with its inertia and with 5 kg m2:

    >>> locks_after_ramp(1080, 600, 30, 26.6, 2), locks_after_ramp(1080, 600, 5, 26.6, 2)
    (True, False)
    """
    if _is_active(load_kind):
        return ramp_time * (torque - 2 * load_torque) <= 2 * driven_inertia * driver_speed
    share = excess_share(torque, load_torque)
    return ramp_time * (torque - load_torque) * share < 2 * driven_inertia * driver_speed


def load_start_time(torque: Quantity, load_torque: Quantity, ramp_time: Quantity) -> Quantity:
    """Time at which the clutch torque reaches the load torque.

    Equation: t_B = L t_r/T

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        t_B [s].

    References
    ----------
    S1 (lecture), end of the first phase (prints 1.11 s).

    Examples
    --------
    >>> load_start_time(1080, 600, 2)
    1.11111
    """
    return load_torque * ramp_time / torque


def excess_share(torque: Quantity, load_torque: Quantity) -> Quantity:
    """Share of the clutch torque that the load leaves for acceleration.

    Equation: share = 1 - L/T

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].

    Returns
    -------
    scalar, array or symbol
        Share [-].

    References
    ----------
    S1 (lecture), start-up.

    Examples
    --------
    >>> excess_share(1080, 600)
    0.444444
    """
    return 1 - load_torque / torque


def kinetic_energy(driven_inertia: Quantity, driver_speed: Quantity) -> Quantity:
    """Energy of the driven side after lock-up.

    Equation: E = J omega1**2/2

    Parameters
    ----------
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].

    Returns
    -------
    scalar, array or symbol
        E [J].

    References
    ----------
    S1 (lecture), start-up.

    Examples
    --------
    >>> kinetic_energy(30, 26.6)
    10613.4
    """
    return driven_inertia * driver_speed * driver_speed / 2


def ramp_work(load_torque: Quantity, driver_speed: Quantity, ramp_time: Quantity) -> Quantity:
    """Work that the load torque would take of the driver in half the ramp.

    Equation: W = L omega1 t_r/2

    Parameters
    ----------
    load_torque : scalar, array or symbol
        L [N m].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Work [J].

    References
    ----------
    S1 (lecture), start-up; a term of :func:`friction_work`.

    Examples
    --------
    >>> ramp_work(600, 26.6, 2)
    15960.0
    """
    return load_torque * driver_speed * ramp_time / 2


def run_up_work(torque: Quantity, load_torque: Quantity, energy: Quantity) -> Quantity:
    """Friction work of a step of torque, arranged as E (1 + L/(T-L)).

    Equation: W = E T/(T - L)

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    energy : scalar, array or symbol
        E [J].

    Returns
    -------
    scalar, array or symbol
        Work [J].

    References
    ----------
    S1 (lecture), start-up.

    Examples
    --------
    By hand, 10613.4 1080/480:

    >>> run_up_work(1080, 600, 10613.4)
    23880.15
    """
    return energy * (1 + load_torque / (torque - load_torque))


def ramp_relief(torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, ramp_time: Quantity) -> Quantity:
    """Work that a load moved during the ramp takes over.

    Equation: W = L (T - L)**3 t_r**2/(24 J T**2)

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Work [J].

    References
    ----------
    S1 (lecture), start-up; a term of :func:`friction_work`.

    Examples
    --------
    By hand, 600 480**3 2**2/(24 30 1080**2):

    >>> ramp_relief(1080, 600, 30, 2)
    316.049
    """
    excess = torque - load_torque
    return load_torque * excess * excess_share(torque, load_torque) ** 2 * ramp_time**2 / (24 * driven_inertia)


def catch_up_time(torque: Quantity, driven_inertia: Quantity, driver_speed: Quantity, ramp_time: Quantity) -> Quantity:
    """Time from the start of a reactive load to lock-up inside the ramp.

    Equation: t = sqrt(2 J omega1 t_r/T)

    Parameters
    ----------
    torque : scalar, array or symbol
        T [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Time [s].

    References
    ----------
    S1 (lecture), equation of motion.

    Examples
    --------
    By hand, sqrt(2 5 26.6 2/1080):

    >>> float(catch_up_time(1080, 5, 26.6, 2))
    0.701850
    """
    return np.sqrt(2 * (driven_inertia * driver_speed) * ramp_time / torque)


def slip_time(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> Quantity:
    """Time from the first touch to lock-up.

    Equation: t_D = reactive_slip_time(T, L, J, omega1, t_r) if reactive else (J omega1 + T t_r/2)/(T - L) if t_r (T - 2
        L) <= 2 J omega1 else t_B + sqrt(t_B**2 + 2 J omega1 t_r/T), with t_B = L t_r/T

    Of an active load the first case is lock-up after the ramp, the second lock-up inside it.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s]; 0 for a step.
    load_kind : str
        reactive or active.

    Returns
    -------
    scalar, array or symbol
        t_D [s].

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture), start-up, phases 1 to 3 (its T1 + T2 + T3 = 1.11 + 0.89 + 1.22 s).

    Examples
    --------
    S1, then lock inside the ramp and the active load (computed here):

    >>> float(slip_time(1080, 600, 30, 26.6, 2))
    3.21806
    >>> float(slip_time(1080, 600, 5, 26.6, 2)), float(slip_time(1080, 600, 30, 26.6, 2, "active"))
    (1.81296, 3.91250)
    """
    if not _is_active(load_kind):
        return reactive_slip_time(torque, load_torque, driven_inertia, driver_speed, ramp_time)
    excess = torque - load_torque
    after_ramp = locks_after_ramp(torque, load_torque, driven_inertia, driver_speed, ramp_time, load_kind)
    momentum = driven_inertia * driver_speed
    after = momentum / excess + ramp_time / 2 * (1 + load_torque / excess)
    inside = active_lock_in_ramp(torque, load_torque, momentum, ramp_time)
    return np.where(after_ramp, after, inside)


@special((-np.inf, -0.5), (0.0, np.inf), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), curvature="log-convex", above=(0, 1))
def reactive_slip_time(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, driver_speed: Quantity, ramp_time: Quantity
) -> Quantity:
    """Time from the first touch to lock-up under a reactive load, see :func:`slip_time`.

    Equation: t_D = J omega1/(T - L) + t_r (T + L)/(2 T) if (T - L)**2 t_r < 2 J T omega1 else L t_r/T + sqrt(2 J omega1
        t_r/T)

    It falls with the torque and rises with all else; its logarithm is convex in those of all arguments together.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s]; 0 for a step.

    Returns
    -------
    scalar, array or symbol
        t_D [s].

    References
    ----------
    S1 (lecture), start-up, phases 1 to 3.

    Examples
    --------
    S1:

    >>> float(reactive_slip_time(1080, 600, 30, 26.6, 2))
    3.21806
    """
    after_ramp = locks_after_ramp(torque, load_torque, driven_inertia, driver_speed, ramp_time)
    momentum = driven_inertia * driver_speed
    after = momentum / (torque - load_torque) + ramp_time / 2 * (1 + load_torque / torque)
    inside = load_torque * ramp_time / torque + catch_up_time(torque, driven_inertia, driver_speed, ramp_time)
    return np.where(after_ramp, after, inside)


def active_lock_in_ramp(torque: Quantity, load_torque: Quantity, momentum: Quantity, ramp_time: Quantity) -> Quantity:
    """Time of lock-up inside the ramp under an active load.

    Equation: t = t_B + sqrt(t_B**2 + 2 H t_r/T), with t_B = L t_r/T

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    momentum : scalar, array or symbol
        Momentum to gain, H = J omega1 [N m s].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Time [s].

    References
    ----------
    Root of T t**2/(2 t_r) - L t = J omega1.

    Examples
    --------
    By hand, 1080 3**2/4 - 600 3 = 630:

    >>> float(active_lock_in_ramp(1080, 600, 630, 2))
    3.0
    """
    time_b = load_start_time(torque, load_torque, ramp_time)
    return time_b + np.sqrt(time_b**2 + 2 * momentum * ramp_time / torque)


def driven_back_work(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, ramp_time: Quantity
) -> Quantity:
    """Work by which the motion of an active load during the ramp adds.

    Equation: W = L (4 L - T) t_r**2/(24 J)

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Work [J], before the factor T/(T-L).

    References
    ----------
    S1 (lecture), equations of motion; a term of :func:`friction_work`.

    Examples
    --------
    By hand, 600 1320 2**2/(24 30):

    >>> driven_back_work(1080, 600, 30, 2)
    4400.0
    """
    return load_torque * (4 * load_torque - torque) * ramp_time**2 / (24 * driven_inertia)


def friction_work(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> Quantity:
    """Friction work of one engagement.

    Equation: W = reactive_friction_work(T, L, J, omega1, t_r) if reactive else T/(T - L) (J omega1**2/2 + L omega1
        t_r/2 + L (4 L - T) t_r**2/(24 J)) if t_r (T - 2 L) <= 2 J omega1 else (J omega1 + L t_D) (omega1/2 + L t_D/(6
        J)), with t_D = active_lock_in_ramp(T, L, J omega1, t_r)

    Of an active load the first case is lock-up after the ramp, the second lock-up inside it.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s]; 0 for a step.
    load_kind : str
        reactive or active.

    Returns
    -------
    scalar, array or symbol
        W [J], never below J omega1**2/2.

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture), work of friction; its 39 271 J takes the cubic kinetic power as a parabola, 39 524.1 J is right.

    Examples
    --------
    S1, then lock inside the ramp and the active load (computed here):

    >>> float(friction_work(1080, 600, 30, 26.6, 2))
    39524.1
    >>> float(friction_work(1080, 600, 5, 26.6, 2)), float(friction_work(1080, 600, 30, 26.6, 2, "active"))
    (18103.2, 69690.2)
    """
    if not _is_active(load_kind):
        return reactive_friction_work(torque, load_torque, driven_inertia, driver_speed, ramp_time)
    after_ramp = locks_after_ramp(torque, load_torque, driven_inertia, driver_speed, ramp_time, load_kind)
    momentum = driven_inertia * driver_speed
    energy = kinetic_energy(driven_inertia, driver_speed)
    bend = driven_back_work(torque, load_torque, driven_inertia, ramp_time)
    waiting = ramp_work(load_torque, driver_speed, ramp_time)
    after = (1 + load_torque / (torque - load_torque)) * (energy + waiting + bend)
    impulse = load_torque * active_lock_in_ramp(torque, load_torque, momentum, ramp_time)
    inside = (momentum + impulse) * (driver_speed / 2 + impulse / (6 * driven_inertia))
    return np.where(after_ramp, after, inside)


@special((-np.inf, 0.0), (0.0, np.inf), (0.0, 1.0), (1.0, 2.0), (0.0, 1.0), curvature="log-convex", above=(0, 1))
def reactive_friction_work(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, driver_speed: Quantity, ramp_time: Quantity
) -> Quantity:
    """Friction work of one engagement under a reactive load, see :func:`friction_work`.

    Equation: W = E T/(T - L) + L omega1 t_r/2 - L (T - L)**3 t_r**2/(24 J T**2) if (T - L)**2 t_r < 2 J T omega1 else E
        + L**2 omega1 t_r/(2 T) + (2/3) L omega1 sqrt(2 J omega1 t_r/T), with E = J omega1**2/2

    It falls with the torque and rises with all else; its logarithm is convex in those of all arguments together.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s]; 0 for a step.

    Returns
    -------
    scalar, array or symbol
        W [J].

    References
    ----------
    S1 (lecture), work of friction.

    Examples
    --------
    S1:

    >>> float(reactive_friction_work(1080, 600, 30, 26.6, 2))
    39524.1
    """
    after_ramp = locks_after_ramp(torque, load_torque, driven_inertia, driver_speed, ramp_time)
    energy = kinetic_energy(driven_inertia, driver_speed)
    waiting = ramp_work(load_torque, driver_speed, ramp_time)
    relief = ramp_relief(torque, load_torque, driven_inertia, ramp_time)
    after = run_up_work(torque, load_torque, energy) + waiting - relief
    length = catch_up_time(torque, driven_inertia, driver_speed, ramp_time)
    inside = energy + waiting * load_torque / torque + 2 / 3 * load_torque * driver_speed * length
    return np.where(after_ramp, after, inside)


def _speed_at_load_start(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, ramp_time: Quantity, load_kind: str
) -> Quantity:
    """Driven speed when the clutch torque reaches the load torque: 0, or backwards under an active load."""
    return lowest_driven_speed(torque, load_torque, driven_inertia, ramp_time) if _is_active(load_kind) else 0.0


def lowest_driven_speed(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, ramp_time: Quantity
) -> Quantity:
    """Greatest backward speed of an active load without brake or backstop.

    Equation: omega2 = -L**2 t_r/(2 J T)

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    ramp_time : scalar, array or symbol
        t_r [s].

    Returns
    -------
    scalar, array or symbol
        Speed [rad/s], negative.

    References
    ----------
    Integral of (T t/t_r - L)/J from 0 to t_B.

    Examples
    --------
    Computed here with S1's data:

    >>> lowest_driven_speed(1080, 600, 30, 2)
    -11.1111
    """
    return -(load_torque**2) * ramp_time / (2 * driven_inertia * torque)


def peak_slip_power(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> Quantity:
    """Greatest friction power of a start-up.

    Equation: P = (L + s x)**2 x/J if 2 T J omega < t_r (T - L) (3 T - L) else T (omega - (T - L)**2 t_r/(2 J T)), with
        omega = omega1 if reactive else omega1 + L**2 t_r/(2 J T), s = T/t_r, x = (-L + sqrt(L**2 + 6 s J omega))/(3 s)

    It is reached x after t_B where that is before the end of the ramp (the first case), otherwise at its end; omega is
    the slip speed at t_B: omega1, plus the backward speed of an active load.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s], above 0 (a step has T omega1).
    load_kind : str
        reactive or active.

    Returns
    -------
    scalar, array or symbol
        P [W].

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture), equations of motion; the maximum is derived.

    Examples
    --------
    Computed here with S1's data:

    >>> float(peak_slip_power(1080, 600, 30, 26.6, 2))
    21703.7
    """
    if not _is_active(load_kind):
        return reactive_peak_slip_power(torque, load_torque, driven_inertia, driver_speed, ramp_time)
    slip_speed = driver_speed - lowest_driven_speed(torque, load_torque, driven_inertia, ramp_time)
    return _peak_slip_power(torque, load_torque, driven_inertia, slip_speed, ramp_time)


@special((0.0, 1.0), (0.0, 1.0), (0.0, 0.5), (1.0, 1.5), (-0.5, 0.0), above=(0, 1))
def reactive_peak_slip_power(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, driver_speed: Quantity, ramp_time: Quantity
) -> Quantity:
    """Greatest friction power under a reactive load, see :func:`peak_slip_power`.

    Equation: P = (L + s x)**2 x/J if 2 T J omega1 < t_r (T - L) (3 T - L) else T (omega1 - (T - L)**2 t_r/(2 J T)),
        with s = T/t_r, x = (-L + sqrt(L**2 + 6 s J omega1))/(3 s)

    It falls with the ramp time and rises with all else.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s], above 0.

    Returns
    -------
    scalar, array or symbol
        P [W].

    References
    ----------
    S1 (lecture), equations of motion; the maximum is derived.

    Examples
    --------
    Computed here with S1's data:

    >>> float(reactive_peak_slip_power(1080, 600, 30, 26.6, 2))
    21703.7
    """
    return _peak_slip_power(torque, load_torque, driven_inertia, driver_speed, ramp_time)


def peak_power_root(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, slip_speed: Quantity, ramp_time: Quantity
) -> Quantity:
    """Root of the greatest friction power inside the ramp.

    Equation: root = L + sqrt(L**2 + 6 T J omega/t_r)

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    slip_speed : scalar, array or symbol
        omega [rad/s], when the clutch torque reaches the load torque.
    ramp_time : scalar, array or symbol
        t_r [s], above 0.

    Returns
    -------
    scalar, array or symbol
        Root [N m].

    References
    ----------
    S1 (lecture), equations of motion; see :func:`peak_slip_power`.

    Examples
    --------
    By hand, 3 + sqrt(9 + 6 2 4 1/3):

    >>> float(peak_power_root(2, 3, 4, 1, 3))
    8.0
    """
    return load_torque + np.sqrt(load_torque**2 + 6 * torque * driven_inertia * slip_speed / ramp_time)


def _peak_slip_power(
    torque: Quantity, load_torque: Quantity, driven_inertia: Quantity, slip_speed: Quantity, ramp_time: Quantity
) -> Quantity:
    """Greatest friction power, from the slip speed at the time when the clutch torque reaches the load torque."""
    excess = torque - load_torque
    interior = 2 * driven_inertia * slip_speed < ramp_time * excess * (3 - load_torque / torque)
    # With x* = 2 J omega/(L + root), which does not cancel when the load is large, (L + s x*)**2 x*/J is
    # 2 omega/9 (2 L + root)**2/(L + root); the division is carried out.
    sum_with_root = peak_power_root(torque, load_torque, driven_inertia, slip_speed, ramp_time)
    power_inside = 2 / 9 * slip_speed * (sum_with_root + 2 * load_torque + load_torque**2 / sum_with_root)
    power_at_end = torque * slip_speed - excess**2 * ramp_time / (2 * driven_inertia)
    return np.where(interior, power_inside, power_at_end)


def lock_torque(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> Quantity:
    """Clutch torque just before lock-up.

    Equation: M = min(T, L + sqrt(2 J omega1 T/t_r + (L**2 if active else 0)))

    Inside the ramp it is L + sqrt(2 J omega1 T/t_r) (reactive) or L + sqrt(L**2 + 2 J omega1 T/t_r) (active), which is
    below T there, and above T where lock-up comes after the ramp.

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s], above 0.
    load_kind : str
        reactive or active.

    Returns
    -------
    scalar, array or symbol
        Torque [N m]; less the load torque, over the inertia, it is the greatest acceleration.

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture), equations of motion.

    Examples
    --------
    Computed here: 1080 after the ramp, 979.0 inside it:

    >>> float(lock_torque(1080, 600, 30, 26.6, 2)), float(lock_torque(1080, 600, 5, 26.6, 2))
    (1080.0, 979.0)
    """
    square = 2 * driven_inertia * driver_speed * torque / ramp_time
    if _is_active(load_kind):
        square = square + load_torque**2
    return np.minimum(torque, load_torque + np.sqrt(square))


def torque_rate_per_inertia(torque: Quantity, driven_inertia: Quantity, ramp_time: Quantity) -> Quantity:
    """Jerk of the driven side during the ramp.

    Equation: jerk = T/(t_r J)

    Parameters
    ----------
    torque : scalar, array or symbol
        T [N m].
    driven_inertia : scalar, array or symbol
        J [kg m2].
    ramp_time : scalar, array or symbol
        t_r [s], above 0.

    Returns
    -------
    scalar, array or symbol
        Jerk [rad/s3].

    References
    ----------
    S1 (lecture), derivative of the equation of motion.

    Examples
    --------
    By hand with S1's data:

    >>> torque_rate_per_inertia(1080, 30, 2)
    18.0
    """
    return torque / (ramp_time * driven_inertia)


@dataclass(frozen=True)
class StartupPhases:
    """Times, speeds, powers and works of a start-up at the points B, C and D.

    B: the clutch torque reaches the load torque. C: the ramp ends, or lock-up if that is earlier. D: lock-up, just
    before the clutch torque drops. Powers and works: driver M_k omega1, load M2 omega2, kinetic (M_k - M2) omega2;
    works count from the first touch. All SI.
    """

    duration_1: Quantity
    duration_2: Quantity
    duration_3: Quantity
    lock_time: Quantity
    speed_b: Quantity
    speed_c: Quantity
    torque_c: Quantity
    acceleration_c: Quantity
    driver_power_b: Quantity
    driver_power_c: Quantity
    driver_power_d: Quantity
    load_power_c: Quantity
    load_power_d: Quantity
    kinetic_power_c: Quantity
    kinetic_power_d: Quantity
    driver_work_b: Quantity
    driver_work_c: Quantity
    driver_work_d: Quantity
    load_work_b: Quantity
    load_work_c: Quantity
    load_work_d: Quantity
    kinetic_work_c: Quantity
    kinetic_work_d: Quantity
    friction_work: Quantity
    peak_slip_power: Quantity


def startup_phases(
    torque: Quantity,
    load_torque: Quantity,
    driven_inertia: Quantity,
    driver_speed: Quantity,
    ramp_time: Quantity,
    load_kind: str = "reactive",
) -> StartupPhases:
    """Compute times, speeds, powers and works of the phases of a start-up.

    Equation (implicit): J domega2/dt = T min(t/t_r, 1) - L

    Parameters
    ----------
    torque, load_torque : scalar, array or symbol
        T, L [N m], T > L.
    driven_inertia : scalar, array or symbol
        J [kg m2].
    driver_speed : scalar, array or symbol
        omega1 [rad/s].
    ramp_time : scalar, array or symbol
        t_r [s], above 0.
    load_kind : str
        reactive or active.

    Returns
    -------
    StartupPhases
        Quantities at the points B, C and D.

    Raises
    ------
    InputError
        When load_kind is not known.

    References
    ----------
    S1 (lecture), table of powers and works. The kinetic power is cubic in phase 2: a quarter, not a third.

    Examples
    --------
    S1 prints 8867, 28728 and 63720 J:

    >>> phases = startup_phases(1080, 600, 30, 26.6, 2)
    >>> phases.driver_work_b, float(phases.driver_work_c), float(phases.driver_work_d)
    (8866.67, 28728.0, 63720.3)
    """
    inertia, rate = driven_inertia, torque / ramp_time
    after_ramp = locks_after_ramp(torque, load_torque, inertia, driver_speed, ramp_time, load_kind)
    excess = torque - load_torque
    time_b = load_start_time(torque, load_torque, ramp_time)
    speed_b = _speed_at_load_start(torque, load_torque, inertia, ramp_time, load_kind)
    angle_b = load_torque * time_b**2 / (-3 * inertia) if _is_active(load_kind) else 0.0 * time_b

    to_ramp_end = ramp_time * excess / torque
    to_lock = np.sqrt(2 * inertia * (driver_speed - speed_b) / rate)
    duration_2 = np.where(after_ramp, to_ramp_end, to_lock)
    time_c = time_b + duration_2
    torque_c = rate * time_c
    speed_c = speed_b + rate * duration_2**2 / (2 * inertia)
    angle_c = angle_b + speed_b * duration_2 + rate * duration_2**3 / (6 * inertia)

    to_speed = (driver_speed - speed_b - rate * to_ramp_end**2 / (2 * inertia)) * inertia / excess
    duration_3 = np.where(after_ramp, to_speed, 0.0)
    angle_d = angle_c + (speed_c + driver_speed) / 2 * duration_3

    driver_work_c = driver_speed * rate * time_c**2 / 2
    driver_work_d = driver_work_c + torque_c * driver_speed * duration_3
    load_work_d = load_torque * angle_d
    kinetic_work_d = inertia * driver_speed**2 / 2
    # A reactive load takes up the clutch torque without moving before B, so that no work is missed there.
    return StartupPhases(
        duration_1=time_b,
        duration_2=duration_2,
        duration_3=duration_3,
        lock_time=time_c + duration_3,
        speed_b=speed_b,
        speed_c=speed_c,
        torque_c=torque_c,
        acceleration_c=(torque_c - load_torque) / inertia,
        driver_power_b=load_torque * driver_speed,
        driver_power_c=torque_c * driver_speed,
        driver_power_d=torque_c * driver_speed,
        load_power_c=load_torque * speed_c,
        load_power_d=load_torque * driver_speed,
        kinetic_power_c=(torque_c - load_torque) * speed_c,
        kinetic_power_d=(torque_c - load_torque) * driver_speed,
        driver_work_b=driver_speed * rate * time_b**2 / 2,
        driver_work_c=driver_work_c,
        driver_work_d=driver_work_d,
        load_work_b=load_torque * angle_b,
        load_work_c=load_torque * angle_c,
        load_work_d=load_work_d,
        kinetic_work_c=inertia * speed_c**2 / 2,
        kinetic_work_d=kinetic_work_d,
        friction_work=driver_work_d - load_work_d - kinetic_work_d,
        peak_slip_power=peak_slip_power(torque, load_torque, inertia, driver_speed, ramp_time, load_kind),
    )


def constant_torque_slip(
    slip_speed: Quantity,
    torque: Quantity,
    driver_torque: Quantity,
    load_torque: Quantity,
    driver_inertia: Quantity,
    driven_inertia: Quantity,
) -> tuple[Quantity, Quantity]:
    """Slip time and friction work of two finite inertias under constant torques (step engagement).

    Equation: (t, W) = (t, T domega t/2), with t = domega/((T - M1)/J1 + (T - M2)/J2)

    Parameters
    ----------
    slip_speed : scalar, array or symbol
        Speed difference at the start domega [rad/s].
    torque, driver_torque, load_torque : scalar, array or symbol
        T, M1, M2 [N m].
    driver_inertia, driven_inertia : scalar, array or symbol
        J1, J2 [kg m2].

    Returns
    -------
    tuple
        Slip time [s] and friction work [J].

    References
    ----------
    S1 (lecture), equations of motion (1), (2).

    Examples
    --------
    By hand, without outer torques J1 J2/(J1+J2) domega**2/2 = 0.5 x 2 x 100:

    >>> constant_torque_slip(10, 50, 0, 0, 3, 6)
    (0.4, 100.0)
    """
    deceleration = (torque - driver_torque) / driver_inertia + (torque - load_torque) / driven_inertia
    time = slip_speed / deceleration
    return time, torque * slip_speed * time / 2
