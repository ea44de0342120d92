"""Heat of repeated engagements.

Every function takes floats, arrays or CasADi symbols. The switching rate is in 1/s (50 engagements per
hour are 50/3600 1/s), so that an hourly heat per area is a heat flux in W/m2.

Sources: S1 (lecture), Neale (Tribology Handbook), Carslaw & Jaeger (Conduction of Heat in Solids).
"""

from __future__ import annotations

import numpy as np

from synth.special import special

from . import Quantity, magnetics

__all__ = [
    "adiabatic_rise",
    "allowed_work_at_rate",
    "conductance",
    "cycle_time",
    "flash_rise",
    "hourly_heat",
    "mean_temperature_rise",
    "oil_flow",
    "peak_rise_per_work",
    "peak_temperature_rise",
    "power_density",
    "rise_after",
    "row_share",
    "single_heat",
    "specific_hourly_heat",
    "thermal_time_constant",
]


def cycle_time(switching_rate: Quantity) -> Quantity:
    """Time from one engagement to the next.

    Equation: t_c = 1/f

    Parameters
    ----------
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].

    Returns
    -------
    scalar, array or symbol
        t_c [s].

    References
    ----------
    S1 (lecture): the slip time must be shorter.

    Examples
    --------
    >>> cycle_time(50 / 3600)
    72.0
    """
    return 1 / switching_rate


def hourly_heat(friction_work: Quantity, switching_rate: Quantity) -> Quantity:
    """Mean heat flow of repeated engagements, their work times their rate.

    Equation: P = W f

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].

    Returns
    -------
    scalar, array or symbol
        Heat flow [W]; 3600 times it is the heat per hour in J.

    References
    ----------
    S1 (lecture), hourly heat; S1 prints 1 963 550 J/h with its slightly low W.

    Examples
    --------
    >>> 3600 * hourly_heat(39524.1389, 50 / 3600)
    1976207.
    """
    return friction_work * switching_rate


def specific_hourly_heat(friction_work: Quantity, switching_rate: Quantity, area: Quantity) -> Quantity:
    """Mean heat flux into the friction surfaces.

    Equation: w = W f/A

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].
    area : scalar, array or symbol
        All friction surfaces A [m2].

    Returns
    -------
    scalar, array or symbol
        w [W/m2]; 1 J/(mm2 h) is 277.7778 W/m2.

    References
    ----------
    S1 (lecture), specific hourly heat, 5.9 J/(mm2 h) in its example.

    Examples
    --------
    >>> specific_hourly_heat(39524.1389, 50 / 3600, 0.334874) / 277.77778
    5.9013
    """
    return friction_work * switching_rate / area


def single_heat(friction_work: Quantity, area: Quantity) -> Quantity:
    """Friction work per engagement and area.

    Equation: Q_A = W/A

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    area : scalar, array or symbol
        All friction surfaces A [m2].

    Returns
    -------
    scalar, array or symbol
        Q_A [J/m2].

    References
    ----------
    Makers' limit for a single engagement; definition.

    Examples
    --------
    S1's example, in J/mm2:

    >>> single_heat(39524.1389, 334874)
    0.11803
    """
    return friction_work / area


def power_density(slip_power: Quantity, area: Quantity) -> Quantity:
    """Friction power per area.

    Equation: q = P/A

    Parameters
    ----------
    slip_power : scalar, array or symbol
        Peak slip power P [W].
    area : scalar, array or symbol
        All friction surfaces A [m2].

    Returns
    -------
    scalar, array or symbol
        q [W/m2].

    References
    ----------
    Neale, Tribology Handbook, Table 7.4 (0.3 to 2.3 W/mm2 by material).

    Examples
    --------
    S1's example, in W/mm2:

    >>> power_density(21703.7, 334874)
    0.064812
    """
    return slip_power / area


def mean_temperature_rise(
    friction_work: Quantity, switching_rate: Quantity, heat_transfer: Quantity, cooled_area: Quantity
) -> Quantity:
    """Mean rise over ambient of a body heated at every engagement.

    Equation: dT = W f/(h A)

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].
    heat_transfer : scalar, array or symbol
        Surface coefficient h [W/(m2 K)].
    cooled_area : scalar, array or symbol
        Surface that gives off heat A [m2].

    Returns
    -------
    scalar, array or symbol
        Temperature rise [K].

    References
    ----------
    Lumped heat balance.

    Examples
    --------
    By hand, 1000 J each 10 s over 0.1 m2 at 20 W/(m2 K) is 100 W over 2 W/K:

    >>> mean_temperature_rise(1000, 0.1, 20, 0.1)
    50.0
    """
    return friction_work * switching_rate / (heat_transfer * cooled_area)


def thermal_time_constant(heat_capacity: Quantity, heat_transfer: Quantity, cooled_area: Quantity) -> Quantity:
    """Time constant of a lumped body.

    Equation: tau = C/(h A)

    Parameters
    ----------
    heat_capacity : scalar, array or symbol
        C [J/K].
    heat_transfer : scalar, array or symbol
        Surface coefficient h [W/(m2 K)].
    cooled_area : scalar, array or symbol
        Surface that gives off heat A [m2].

    Returns
    -------
    scalar, array or symbol
        tau [s].

    References
    ----------
    Lumped heat balance.

    Examples
    --------
    By hand:

    >>> thermal_time_constant(4800, 20, 0.1)
    2400.0
    """
    return heat_capacity / (heat_transfer * cooled_area)


def peak_temperature_rise(
    friction_work: Quantity,
    switching_rate: Quantity,
    heat_capacity: Quantity,
    heat_transfer: Quantity,
    cooled_area: Quantity,
) -> Quantity:
    """Rise over ambient just after an engagement, in steady repetition.

    Equation: dT = (W/C)/(1 - exp(-t_c/tau)), with t_c = 1/f, tau = C/(h A)

    Written with expm1, because t_c is often much shorter than tau; at a low rate it is the single adiabatic rise W/C.

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].
    heat_capacity : scalar, array or symbol
        C [J/K].
    heat_transfer : scalar, array or symbol
        Surface coefficient h [W/(m2 K)].
    cooled_area : scalar, array or symbol
        Surface that gives off heat A [m2].

    Returns
    -------
    scalar, array or symbol
        Temperature rise [K].

    References
    ----------
    Lumped heat balance of a body heated in steps of W/C and cooling with tau = C/(h A).

    Examples
    --------
    By hand, steps of 10 K each time constant: 10/(1 - 1/e):

    >>> float(peak_temperature_rise(1000, 0.02, 100, 20, 0.1))
    15.8198
    """
    return friction_work * peak_rise_per_work(switching_rate, heat_capacity, heat_transfer, cooled_area)


@special((0.0, 1.0), (-1.0, 0.0), (-1.0, 0.0), (-1.0, 0.0), curvature="log-convex")
def peak_rise_per_work(
    switching_rate: Quantity, heat_capacity: Quantity, heat_transfer: Quantity, cooled_area: Quantity
) -> Quantity:
    """Peak temperature rise in steady repetition per joule of an engagement.

    Equation: dT/W = 1/(C (1 - exp(-t_c/tau))), with t_c = 1/f, tau = C/(h A)

    Parameters
    ----------
    switching_rate : scalar, array or symbol
        Engagements per second f [1/s].
    heat_capacity : scalar, array or symbol
        C [J/K].
    heat_transfer : scalar, array or symbol
        Surface coefficient h [W/(m2 K)].
    cooled_area : scalar, array or symbol
        Surface that gives off heat A [m2].

    Returns
    -------
    scalar, array or symbol
        Temperature rise per work [K/J].

    References
    ----------
    As :func:`peak_temperature_rise`; it rises with the rate and falls with capacity, coefficient and surface.

    Examples
    --------
    By hand, 0.01/(1 - 1/e):

    >>> float(peak_rise_per_work(0.02, 100, 20, 0.1))
    0.0158198
    """
    cooled = heat_transfer * cooled_area / (heat_capacity * switching_rate)
    return -1 / (heat_capacity * np.expm1(-cooled))


def rise_after(n: Quantity, work: Quantity, rate: Quantity, capacity: Quantity, conductance: Quantity) -> Quantity:
    """Rise over ambient just after an engagement of a row that begins cold.

    Equation: dT = (W/C) (1 - q**n)/(1 - q), with q = exp(-G/(C f))

    An infinite row gives :func:`peak_temperature_rise`.

    Parameters
    ----------
    n : scalar, array or symbol
        Number of the engagement in its row n [-], at least 1.
    work : scalar, array or symbol
        Work per engagement W [J].
    rate : scalar, array or symbol
        Engagements per second f [1/s].
    capacity : scalar, array or symbol
        C [J/K].
    conductance : scalar, array or symbol
        Heat given off per kelvin G [W/K].

    Returns
    -------
    scalar, array or symbol
        dT [K].

    References
    ----------
    Lumped heat balance of a body heated in steps of W/C, as a geometric series; derived here.

    Examples
    --------
    Computed here, the first, the tenth and any later start of a row of 50 an hour:

    >>> [round(float(rise_after(n, 39524.1, 50 / 3600, 4000, 9)), 6) for n in (1, 10, float("inf"))]
    [9.881025, 52.993092, 66.06783]
    """
    return work * peak_rise_per_work(rate, capacity, conductance, 1.0) * row_share(n, rate, capacity, conductance)


@special((0.0, 1.0), (-1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), curvature="log-concave")
def row_share(n: Quantity, rate: Quantity, capacity: Quantity, conductance: Quantity) -> Quantity:
    """Rise after an engagement of a row that begins cold over that of steady repetition, just after it or on average.

    Equation: x = 1 - exp(-n G/(C f))

    Parameters
    ----------
    n : scalar, array or symbol
        Number of the engagement in its row n [-], at least 1.
    rate : scalar, array or symbol
        Engagements per second f [1/s].
    capacity : scalar, array or symbol
        C [J/K].
    conductance : scalar, array or symbol
        Heat given off per kelvin G [W/K].

    Returns
    -------
    scalar, array or symbol
        x [-].

    References
    ----------
    As :func:`rise_after`; the mean is that from one engagement to the next.

    Examples
    --------
    Computed here, the tenth start of 50 an hour:

    >>> float(row_share(10, 50 / 3600, 4000, 9))
    0.802101
    """
    return -np.expm1(-n * conductance / (capacity * rate))


def conductance(
    still: Quantity, moving: Quantity, speed: Quantity, area: Quantity, area_factor: Quantity = 1.0
) -> Quantity:
    """Heat that a body gives off per kelvin, standing or turning.

    Equation: G = (h_still + h_rot v**0.8) A k_A

    Parameters
    ----------
    still : scalar, array or symbol
        Surface coefficient at rest h_still [W/(m2 K)].
    moving : scalar, array or symbol
        h_rot [-]: of (m/s)**0.8 and W/(m2 K); 0 where the body stands.
    speed : scalar, array or symbol
        Circumferential speed v [m/s].
    area : scalar, array or symbol
        Outer surface without fins A [m2].
    area_factor : scalar, array or symbol
        Effective surface over that without fins k_A [-].

    Returns
    -------
    scalar, array or symbol
        G [W/K].

    References
    ----------
    Newton's law of cooling, with the coefficient of :func:`synth.problems.mechanics.magnetics.heat_transfer_in_motion`.

    Examples
    --------
    Computed here, 0.05 m2 at rest, turning at 15 m/s, and finned:

    >>> [round(float(conductance(12, 3, v, 0.05, k)), 8) for v, k in ((0, 1), (15, 1), (15, 2.5))]
    [0.6, 1.90907421, 4.77268552]
    """
    return magnetics.heat_transfer_in_motion(still, moving, speed, 1.0) * area * area_factor


def oil_flow(heat: Quantity, rise: Quantity, volumetric_heat: Quantity) -> Quantity:
    """Oil flow that carries a heat flow away.

    Equation: Q = P/(s dT)

    Parameters
    ----------
    heat : scalar, array or symbol
        Heat flow P [W].
    rise : scalar, array or symbol
        Rise of the oil dT [K].
    volumetric_heat : scalar, array or symbol
        Density times specific heat of the oil s [J/(m3 K)].

    Returns
    -------
    scalar, array or symbol
        Q [m3/s].

    References
    ----------
    Heat balance.

    Examples
    --------
    Computed here, 1 kW into oil of 870 kg/m3 and 1950 J/(kg K), in l/min:

    >>> 60000 * oil_flow(1000, 20, 870 * 1950)
    1.76834660
    """
    return heat / (volumetric_heat * rise)


def adiabatic_rise(friction_work: Quantity, mass: Quantity, specific_heat: Quantity, share: Quantity = 1.0) -> Quantity:
    """Rise of a body that takes a share of the work without losing heat.

    Equation: dT = x W/(m c_p)

    Parameters
    ----------
    friction_work : scalar, array or symbol
        Work per engagement W [J].
    mass : scalar, array or symbol
        m [kg].
    specific_heat : scalar, array or symbol
        c_p [J/(kg K)].
    share : scalar, array or symbol
        Part of W that enters the body x [-]; 1/2 for the hottest pressure plate of a single or twin disc.

    Returns
    -------
    scalar, array or symbol
        Temperature rise [K].

    References
    ----------
    Heat balance.

    Examples
    --------
    By hand:

    >>> adiabatic_rise(40000, 5, 500, 0.5)
    8.0
    """
    return share * friction_work / (mass * specific_heat)


def flash_rise(
    heat_flux: Quantity, slip_time: Quantity, conductivity: Quantity, density: Quantity, specific_heat: Quantity
) -> Quantity:
    """Largest surface rise under a flux that falls linearly to zero, at half the time.

    Equation: dT = (2 sqrt(2)/3) q0 sqrt(t_s/pi)/e, with e = sqrt(k rho c)

    Parameters
    ----------
    heat_flux : scalar, array or symbol
        Flux q0 at the start [W/m2].
    slip_time : scalar, array or symbol
        t_s [s].
    conductivity : scalar, array or symbol
        k [W/(m K)].
    density : scalar, array or symbol
        rho [kg/m3].
    specific_heat : scalar, array or symbol
        c [J/(kg K)]; effusivity e = sqrt(k rho c).

    Returns
    -------
    scalar, array or symbol
        Temperature rise [K].

    References
    ----------
    Carslaw & Jaeger, Conduction of Heat in Solids, half space with a prescribed flux.

    Examples
    --------
    Computed here, 1 W/mm2 for 1 s on steel (e = 13 726 W s0.5/(m2 K)):

    >>> float(flash_rise(1e6, 1.0, 50, 7850, 480))
    38.7533
    """
    effusivity = np.sqrt(conductivity * density * specific_heat)
    return 2 * np.sqrt(2.0) / 3 * heat_flux * np.sqrt(slip_time / np.pi) / effusivity


def allowed_work_at_rate(single_work: Quantity, transition_rate: Quantity, switching_rate: Quantity) -> Quantity:
    """Work per engagement allowed at a switching rate.

    Equation: Q = Q_E (1 - exp(-S_hu/S_h))

    Parameters
    ----------
    single_work : scalar, array or symbol
        Allowed work of a single engagement Q_E [J].
    transition_rate : scalar, array or symbol
        Transition rate S_hu [1/s].
    switching_rate : scalar, array or symbol
        Engagements per second S_h [1/s].

    Returns
    -------
    scalar, array or symbol
        Q [J].

    References
    ----------
    VDI 2241 (recalled; the text itself was not at hand).

    Examples
    --------
    By hand, at the transition rate 1 - 1/e of the single work:

    >>> float(allowed_work_at_rate(1000, 0.1, 0.1))
    632.12
    """
    return -single_work * np.expm1(-transition_rate / switching_rate)
