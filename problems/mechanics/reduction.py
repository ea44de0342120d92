"""Reduction of a drive to the clutch shaft: machine, gear, rope and masses as one load torque and one inertia.

The gear stands between clutch and machine: i is the speed of the clutch over that of the machine, eta the share of the
power that the gear passes on. A rope of k carrying parts runs onto a drum of diameter D on the machine's shaft, so that
the load moves by r = D/(2 k i) per radian of the clutch; a travelling mass moves so with its wheel. While the clutch
drives, the gear's loss adds to the load; while it brakes, the loss helps. Every function takes floats, arrays or CasADi
symbols.
"""

from __future__ import annotations

from . import Quantity, centrifugal

__all__ = ["inertia_at_clutch", "load_at_clutch"]


def load_at_clutch(
    machine_torque: Quantity,
    lifted_mass: Quantity,
    drum_diameter: Quantity,
    rope_parts: Quantity,
    machine_ratio: Quantity,
    gear_efficiency: Quantity,
    braking: bool = False,
) -> Quantity:
    """Load torque of a machine and a lifted mass at the clutch shaft.

    Equation: M_load = (M_m/i + m g r) (eta if braking else 1/eta), with r = D/(2 k i), g = 9.80665 m/s2

    Parameters
    ----------
    machine_torque : scalar, array or symbol
        Torque at the machine's shaft M_m [N m].
    lifted_mass : scalar, array or symbol
        Mass whose weight acts m [kg].
    drum_diameter : scalar, array or symbol
        Diameter of drum or wheel D [m].
    rope_parts : scalar, array or symbol
        Parts of the rope that carry k [-], at least 1.
    machine_ratio : scalar, array or symbol
        Speed of the clutch over that of the machine i [-], above 0.
    gear_efficiency : scalar, array or symbol
        Efficiency of the gear eta [-], above 0, at most 1.
    braking : bool
        True where power flows from the machine to the clutch, braking.

    Returns
    -------
    scalar, array or symbol
        M_load [N m].

    References
    ----------
    Power balance of the gear; derived here.

    Examples
    --------
    Computed here: a hoist of 2 t on two parts of the rope; the same as a brake:

    >>> load_at_clutch(0, 2000, 0.4, 2, 12.5, 0.93), load_at_clutch(0, 2000, 0.4, 2, 12.5, 0.93, braking=True)
    (168.716559, 145.922952)
    """
    weight = lifted_mass * centrifugal.STANDARD_GRAVITY * _lever(drum_diameter, rope_parts, machine_ratio)
    return (machine_torque / machine_ratio + weight) * (gear_efficiency if braking else 1 / gear_efficiency)


def inertia_at_clutch(
    machine_inertia: Quantity,
    moved_mass: Quantity,
    lifted_mass: Quantity,
    drum_diameter: Quantity,
    rope_parts: Quantity,
    machine_ratio: Quantity,
    gear_efficiency: Quantity,
    clutch_side_inertia: Quantity,
    braking: bool = False,
) -> Quantity:
    """Driven inertia of a machine and its masses at the clutch shaft.

    Equation: J2 = J_c + (J_m/i**2 + (m + m_t) r**2) (eta if braking else 1/eta), with r = D/(2 k i)

    Parameters
    ----------
    machine_inertia : scalar, array or symbol
        Inertia at the machine's shaft J_m [kg m2].
    moved_mass : scalar, array or symbol
        Mass that is moved without its weight m_t [kg].
    lifted_mass : scalar, array or symbol
        Mass whose weight acts m [kg].
    drum_diameter : scalar, array or symbol
        Diameter of drum or wheel D [m].
    rope_parts : scalar, array or symbol
        Parts of the rope that carry k [-], at least 1.
    machine_ratio : scalar, array or symbol
        Speed of the clutch over that of the machine i [-], above 0.
    gear_efficiency : scalar, array or symbol
        Efficiency of the gear eta [-], above 0, at most 1.
    clutch_side_inertia : scalar, array or symbol
        Inertia between clutch and gear J_c [kg m2].
    braking : bool
        True where power flows from the machine to the clutch, braking.

    Returns
    -------
    scalar, array or symbol
        J2 [kg m2].

    References
    ----------
    Power balance of the gear, M_k - (M_m + J_m alpha/i)/(i eta) = J_c alpha; derived here.

    Examples
    --------
    Computed here: a hoist of 2 t on two parts of the rope:

    >>> inertia_at_clutch(8, 0, 2000, 0.4, 2, 12.5, 0.93, 0.35)
    0.542688172
    """
    lever = _lever(drum_diameter, rope_parts, machine_ratio)
    beyond_gear = machine_inertia / machine_ratio**2 + (lifted_mass + moved_mass) * lever**2
    return clutch_side_inertia + beyond_gear * (gear_efficiency if braking else 1 / gear_efficiency)


def _lever(drum_diameter: Quantity, rope_parts: Quantity, machine_ratio: Quantity) -> Quantity:
    """Way of the load per radian of the clutch shaft [m]."""
    return drum_diameter / (2 * rope_parts * machine_ratio)
