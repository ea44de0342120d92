"""Magnetic circuit, winding and steady heat of a direct-current coil in an iron body.

Every function takes floats, arrays or CasADi symbols, except :func:`flux_density_at`, which is numeric only.

Sources: Ampere's law and Maxwell's force; Froehlich's saturation curve, with engineering-typical coefficients for
mild steel; copper as in any handbook. Equation numbers [P..] are those of the notes on centrifugal clutches (S4),
section 3.5.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from synth.errors import InputError
from synth.special import special

from . import Quantity

__all__ = [
    "COPPER_COEFFICIENT",
    "COPPER_DENSITY",
    "COPPER_REFERENCE",
    "COPPER_RESISTIVITY",
    "MU_0",
    "UNIT_HEAT_TRANSFER",
    "UNIT_SPEED",
    "coil_resistance",
    "coil_temperature_rise",
    "cold_copper_loss",
    "copper_fill",
    "copper_mass",
    "current_rise_time",
    "cylinder_surface",
    "flux_density_at",
    "froehlich_field",
    "gap_field",
    "heat_transfer_in_motion",
    "hot_copper_loss",
    "iron_field",
    "iron_reluctivity",
    "larger",
    "pole_force",
    "resistance_ratio",
    "resistance_rise",
    "runaway_loss",
    "time_constant",
    "turns",
]

MU_0 = 4e-7 * np.pi  # magnetic constant [V s/(A m)]
COPPER_RESISTIVITY = 1.72e-8  # at 20 degC [ohm m]
COPPER_COEFFICIENT = 0.00393  # of the resistance at 20 degC [1/K]
COPPER_DENSITY = 8960.0  # [kg/m3]
COPPER_REFERENCE = 293.15  # temperature of the two figures above [K]
# Empirical coefficients that belong to fractional powers: their units stand here, so that formulas scale.
UNIT_HEAT_TRANSFER = 1.0  # [W/(m2 K)]
UNIT_SPEED = 1.0  # [m/s]


# -- circuit ---------------------------------------------------------------------------------------


def gap_field(flux_density: Quantity, relative_permeability: Quantity = 1.0) -> Quantity:
    """Magnetic field in a gap; times the length of the gap it is the ampere-turns that the gap needs.

    Equation: H = B/(mu0 mu_r), with mu0 = 4e-7 pi V s/(A m)

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B [T].
    relative_permeability : scalar, array or symbol
        mu_r of what fills the gap [-]; 1 for air.

    Returns
    -------
    scalar, array or symbol
        H [A/m].

    References
    ----------
    Ampere's law; S4 [P4].

    Examples
    --------
    S4, section 3.5: two powder gaps of 1.25 mm at 0.6 T need 280 A, two air gaps of 0.4 mm 382 A more:

    >>> float(gap_field(0.6, 4.26)) * 2 * 1.25e-3, float(gap_field(0.6)) * 2 * 0.4e-3
    (280.2, 382.0)
    """
    return flux_density / (MU_0 * relative_permeability)


def froehlich_field(flux_density: Quantity, iron_reluctance: Quantity, iron_saturation: Quantity) -> Quantity:
    """Magnetic field in iron after Froehlich, the formula of :func:`iron_field`, which a step names.

    Equation: H = a_fe B/(1 - B/B_s)

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B [T], below B_s.
    iron_reluctance : scalar, array or symbol
        a_fe [A/(m T)].
    iron_saturation : scalar, array or symbol
        B_s [T].

    Returns
    -------
    scalar, array or symbol
        H [A/m].

    References
    ----------
    Froehlich (1881).

    Examples
    --------
    By hand, 160 x 1.5/0.25:

    >>> froehlich_field(1.5, 160.0, 2.0)
    960.0
    """
    return iron_reluctance * flux_density / (1 - flux_density / iron_saturation)


@special((1.0, np.inf), (1.0, 1.0), (-np.inf, 0.0), curvature="log-convex", above=(2, 0))
def iron_field(flux_density: Quantity, iron_reluctance: Quantity, iron_saturation: Quantity) -> Quantity:
    """Magnetic field in iron after Froehlich.

    Equation: H = a_fe B/(1 - B/B_s)

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B [T], below B_s.
    iron_reluctance : scalar, array or symbol
        a_fe [A/(m T)].
    iron_saturation : scalar, array or symbol
        B_s [T].

    Returns
    -------
    scalar, array or symbol
        H [A/m]; it has a pole at B_s.

    References
    ----------
    Froehlich (1881); S4 [P3], mild steel: 160 A/(m T), 2.0 T.

    Examples
    --------
    By hand, 160 x 1.5/0.25:

    >>> float(iron_field(1.5, 160.0, 2.0))
    960.0
    """
    return froehlich_field(flux_density, iron_reluctance, iron_saturation)


def iron_reluctivity(flux_density: Quantity, iron_reluctance: Quantity, iron_saturation: Quantity) -> Quantity:
    """Field over flux density of iron after Froehlich.

    Equation: H/B = a_fe/(1 - B/B_s)

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B [T], below B_s.
    iron_reluctance : scalar, array or symbol
        a_fe [A/(m T)].
    iron_saturation : scalar, array or symbol
        B_s [T].

    Returns
    -------
    scalar, array or symbol
        H/B [A/(m T)]; it has a pole at B_s.

    References
    ----------
    Froehlich (1881), as in :func:`iron_field`.

    Examples
    --------
    By hand, 160/0.25:

    >>> float(iron_reluctivity(1.5, 160.0, 2.0))
    640.0
    """
    return iron_reluctance / (1 - flux_density / iron_saturation)


def larger(first: Quantity, second: Quantity) -> Quantity:
    """Return the larger of two: of two flux densities in series, or of two radii outside.

    Equation: x = max(x1, x2)

    Parameters
    ----------
    first, second : scalar, array or symbol
        Two of one kind x1, x2, for example the flux densities of two sections [T].

    Returns
    -------
    scalar, array or symbol
        The larger.

    References
    ----------
    S4 [P4], max(H(B_out), H(B_in)).

    Examples
    --------
    >>> float(larger(1.2, 1.3))
    1.3
    """
    return np.maximum(first, second)


def pole_force(flux_density: Quantity, area: Quantity) -> Quantity:
    """Pull of a pole face across an air gap.

    Equation: F = B**2 A/(2 mu0), with mu0 = 4e-7 pi V s/(A m)

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B in the gap [T].
    area : scalar, array or symbol
        All pole faces together A [m2].

    Returns
    -------
    scalar, array or symbol
        Force [N].

    References
    ----------
    Maxwell; S4, section 3.5. With two faces of A_p each the force is B**2 A_p/mu0.

    Examples
    --------
    The rule of thumb of 40 N/cm2 at 1 T:

    >>> float(pole_force(1.0, 1e-4))
    39.79
    """
    return flux_density**2 * area / (2 * MU_0)


def flux_density_at(
    ampere_turns: float, excitation: Callable[[np.ndarray], np.ndarray], highest: float, steps: int = 200
) -> float:
    """Flux density that some ampere-turns give: the inverse of a rising magnetisation curve, by bisection.

    Equation (implicit): NI(B) = NI

    Numeric only, for curves and checks; in a design problem the flux density is the unknown.

    Parameters
    ----------
    ampere_turns : float
        NI [A], not negative.
    excitation : callable
        NI(B) [A] of a flux density [T], rising from 0.
    highest : float
        Flux density that is not reached, such as that of saturated iron [T].
    steps : int
        Halvings at most.

    Returns
    -------
    float
        B [T].

    Raises
    ------
    InputError
        When the ampere-turns are negative.

    References
    ----------
    S4, section 8: B(NI) by bisection.

    Examples
    --------
    >>> round(flux_density_at(240.0, lambda b: 100 * b / (1 - b / 2), 2.0), 9)
    1.090909091
    """
    if not ampere_turns >= 0:
        raise InputError("ampere_turns", ampere_turns, "ampere-turns of 0 or more")
    low, high = 0.0, float(highest)
    for _ in range(steps):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        if float(excitation(np.asarray(middle))) <= ampere_turns:
            low = middle
        else:
            high = middle
    return low


# -- winding ---------------------------------------------------------------------------------------


def turns(winding_factor: Quantity, window_area: Quantity, wire_diameter: Quantity) -> Quantity:
    """Return the turns that a window holds; a real number.

    Equation: N = k_wind A_w/d_o**2

    Parameters
    ----------
    winding_factor : scalar, array or symbol
        k_wind [-]: 1 for square packing without bobbin.
    window_area : scalar, array or symbol
        A_w [m2].
    wire_diameter : scalar, array or symbol
        d_o over the insulation [m].

    Returns
    -------
    scalar, array or symbol
        N [-].

    References
    ----------
    Geometry; S4 [P6].

    Examples
    --------
    By hand, 0.85 x 600/0.6**2:

    >>> turns(0.85, 600e-6, 0.6e-3)
    1416.667
    """
    return winding_factor * window_area / wire_diameter**2


def copper_fill(copper_area: Quantity, wire_diameter: Quantity) -> Quantity:
    """Copper per square that a wire takes.

    Equation: k = a_w/d_o**2

    Parameters
    ----------
    copper_area : scalar, array or symbol
        a_w [m2].
    wire_diameter : scalar, array or symbol
        d_o over the insulation [m].

    Returns
    -------
    scalar, array or symbol
        Share [-], pi/4 without insulation.

    References
    ----------
    Geometry.

    Examples
    --------
    >>> round(copper_fill(0.19635e-6, 0.544e-3), 3)
    0.663
    """
    return copper_area / wire_diameter**2


def coil_resistance(mean_radius: Quantity, turns: Quantity, copper_area: Quantity) -> Quantity:
    """Resistance of a round coil at 20 degC.

    Equation: R20 = rho 2 pi r_c N/a_w, with rho = 1.72e-8 ohm m

    Parameters
    ----------
    mean_radius : scalar, array or symbol
        r_c [m].
    turns : scalar, array or symbol
        N [-].
    copper_area : scalar, array or symbol
        a_w of one wire [m2].

    Returns
    -------
    scalar, array or symbol
        R20 [ohm].

    References
    ----------
    Ohm's law; S4 [P6].

    Examples
    --------
    1000 turns of 0.5 mm wire at 80 mm:

    >>> round(float(coil_resistance(0.08, 1000, 0.19635e-6)), 2)
    44.03
    """
    return COPPER_RESISTIVITY * 2 * np.pi * mean_radius * turns / copper_area


def cold_copper_loss(
    ampere_turns: Quantity, bore_radius: Quantity, height: Quantity, length: Quantity, copper_share: Quantity
) -> Quantity:
    """Copper loss of a coil at 20 degC.

    Equation: P20 = rho 2 pi r_c NI**2/(k h_c l_m), with r_c = r_s + h_c/2, rho = 1.72e-8 ohm m

    The number of turns cancels: only the copper in the window counts.

    Parameters
    ----------
    ampere_turns : scalar, array or symbol
        NI [A].
    bore_radius : scalar, array or symbol
        Inside of the coil r_s [m].
    height, length : scalar, array or symbol
        Window of the coil h_c, l_m [m].
    copper_share : scalar, array or symbol
        Part k of the window that is copper [-].

    Returns
    -------
    scalar, array or symbol
        P20 [W].

    References
    ----------
    Ohm's law; S4 [P6], [P7].

    Examples
    --------
    The 44 ohm of :func:`coil_resistance` under 1 A, the copper of 1000 turns in 400 mm2:

    >>> round(float(cold_copper_loss(1000.0, 0.07, 0.02, 0.02, 1000 * 0.19635e-6 / 400e-6)), 2)
    44.03
    """
    # r_c/h_c is written with h_c once.
    return COPPER_RESISTIVITY * 2 * np.pi * ampere_turns**2 * (bore_radius / height + 0.5) / (copper_share * length)


def resistance_ratio(temperature: Quantity) -> Quantity:
    """Resistance of copper over that at 20 degC.

    Equation: R/R20 = 1 + alpha (T - 293.15), with alpha = 0.00393 1/K

    Parameters
    ----------
    temperature : scalar, array or symbol
        T [K].

    Returns
    -------
    scalar, array or symbol
        R/R20 [-].

    References
    ----------
    Handbook value of the coefficient, 0.00393 1/K; S4 [P7].

    Examples
    --------
    >>> resistance_ratio(393.15)
    1.393
    """
    return 1 + COPPER_COEFFICIENT * (temperature - COPPER_REFERENCE)


def copper_mass(mean_radius: Quantity, copper_section: Quantity) -> Quantity:
    """Mass of the copper of a round coil.

    Equation: m = rho 2 pi r_c A_cu, with rho = 8960 kg/m3

    Parameters
    ----------
    mean_radius : scalar, array or symbol
        r_c [m].
    copper_section : scalar, array or symbol
        Copper of all turns together, A_cu = N a_w [m2].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; S4 [P10].

    Examples
    --------
    >>> round(float(copper_mass(0.08, 1000 * 0.19635e-6)), 3)
    0.884
    """
    return COPPER_DENSITY * 2 * np.pi * mean_radius * copper_section


# -- heat ------------------------------------------------------------------------------------------


def cylinder_surface(outer_radius: Quantity, length: Quantity) -> Quantity:
    """Outside of a closed cylinder.

    Equation: A = 2 pi R (L + R)

    Parameters
    ----------
    outer_radius : scalar, array or symbol
        R [m].
    length : scalar, array or symbol
        L [m].

    Returns
    -------
    scalar, array or symbol
        Surface [m2].

    References
    ----------
    Geometry; S4 [P7].

    Examples
    --------
    >>> round(float(cylinder_surface(0.1, 0.08)), 4)
    0.1131
    """
    return 2 * np.pi * outer_radius * (length + outer_radius)


def heat_transfer_in_motion(
    still: Quantity, coefficient: Quantity, driver_speed: Quantity, outer_radius: Quantity
) -> Quantity:
    """Surface coefficient of a turning body.

    Equation: h = h_still + h_rot (omega R)**0.8

    Parameters
    ----------
    still : scalar, array or symbol
        h_still [W/(m2 K)].
    coefficient : scalar, array or symbol
        h_rot [-]: of (m/s)**0.8 and W/(m2 K).
    driver_speed : scalar, array or symbol
        omega [rad/s].
    outer_radius : scalar, array or symbol
        R [m].

    Returns
    -------
    scalar, array or symbol
        h [W/(m2 K)].

    References
    ----------
    Turbulent boundary layer, exponent 0.8; coefficients engineering-typical, S4 [P7].

    Examples
    --------
    By hand, 12 + 3 x 15**0.8:

    >>> round(float(heat_transfer_in_motion(12.0, 3.0, 150.0, 0.1)), 2)
    38.18
    """
    return still + UNIT_HEAT_TRANSFER * coefficient * (driver_speed * outer_radius / UNIT_SPEED) ** 0.8


def runaway_loss(heat_transfer: Quantity, surface: Quantity) -> Quantity:
    """Cold copper loss at which a coil under constant current heats up without end.

    Equation: P_run = h S/alpha, with alpha = 0.00393 1/K

    One kelvin more makes alpha P20 more heat, and the surface gives off h S more: above this loss the first is larger.

    Parameters
    ----------
    heat_transfer : scalar, array or symbol
        h [W/(m2 K)].
    surface : scalar, array or symbol
        S [m2].

    Returns
    -------
    scalar, array or symbol
        Loss [W]; P20 over it is 0.00393 R_th P20 of S4.

    References
    ----------
    S4 [P7], thermal runaway.

    Examples
    --------
    By hand, 12 x 0.1/0.00393:

    >>> round(float(runaway_loss(12.0, 0.1)), 1)
    305.3
    """
    return heat_transfer * surface / COPPER_COEFFICIENT


@special((0.0, np.inf), (-np.inf, -1.0), (0.0, 1.0), (0.0, 1.0), curvature="log-convex", above=(1, 0))
def resistance_rise(
    cold_loss: Quantity, runaway_loss: Quantity, ambient_ratio: Quantity, other_heat: Quantity
) -> Quantity:
    """Steady rise of the resistance over R20 by heating up from ambient.

    Equation: alpha dT = (P20 c + Q)/(P_run - P20)

    Parameters
    ----------
    cold_loss : scalar, array or symbol
        P20 [W], below P_run.
    runaway_loss : scalar, array or symbol
        P_run = h S/alpha [W].
    ambient_ratio : scalar, array or symbol
        Resistance at ambient temperature over that at 20 degC, c [-].
    other_heat : scalar, array or symbol
        Q, what else heats the body [W].

    Returns
    -------
    scalar, array or symbol
        alpha dT [-].

    References
    ----------
    S4 [P7], with R_th = 1/(h S).

    Examples
    --------
    By hand, (30 + 20)/(305.3 - 30):

    >>> round(float(resistance_rise(30.0, 305.3, 1.0, 20.0)), 4)
    0.1816
    """
    return (cold_loss * ambient_ratio + other_heat) / (runaway_loss - cold_loss)


def coil_temperature_rise(
    cold_loss: Quantity, runaway_loss: Quantity, ambient_ratio: Quantity, other_heat: Quantity
) -> Quantity:
    """Steady temperature rise of a coil under constant current.

    Equation: dT = (P20 c + Q)/(alpha (P_run - P20)), with alpha = 0.00393 1/K

    Solves dT h S = P20 (c + alpha dT) + Q, c being R/R20 at ambient temperature.

    Parameters
    ----------
    cold_loss : scalar, array or symbol
        P20 [W], below P_run.
    runaway_loss : scalar, array or symbol
        P_run = h S/alpha [W].
    ambient_ratio : scalar, array or symbol
        Resistance at ambient temperature over that at 20 degC, c [-].
    other_heat : scalar, array or symbol
        Q, what else heats the body [W].

    Returns
    -------
    scalar, array or symbol
        dT [K].

    References
    ----------
    S4 [P7], with R_th = 1/(h S).

    Examples
    --------
    30 W cold and 20 W of slip on 12 W/(m2 K) x 0.1 m2 at 20 degC: 41.7 K with the cold loss alone

    >>> round(float(coil_temperature_rise(30.0, 305.3, 1.0, 20.0)), 2)
    46.21
    """
    return resistance_rise(cold_loss, runaway_loss, ambient_ratio, other_heat) / COPPER_COEFFICIENT


@special((1.0, np.inf), (-np.inf, 0.0), (0.0, 1.0), (0.0, 1.0), curvature="log-convex", above=(1, 0))
def hot_copper_loss(
    cold_loss: Quantity, runaway_loss: Quantity, ambient_ratio: Quantity, other_heat: Quantity
) -> Quantity:
    """Copper loss at the steady temperature.

    Equation: P_cu = P20 (c + Q/P_run)/(1 - P20/P_run)

    This is P20 (c + alpha dT) with the dT of :func:`coil_temperature_rise`.

    Parameters
    ----------
    cold_loss : scalar, array or symbol
        P20 [W], below P_run.
    runaway_loss : scalar, array or symbol
        P_run = h S/alpha [W].
    ambient_ratio : scalar, array or symbol
        Resistance at ambient temperature over that at 20 degC, c [-].
    other_heat : scalar, array or symbol
        Q, what else heats the body [W].

    Returns
    -------
    scalar, array or symbol
        P_cu [W].

    References
    ----------
    S4 [P7].

    Examples
    --------
    30 W x (1 + 0.00393 x 46.21 K):

    >>> round(float(hot_copper_loss(30.0, 305.3, 1.0, 20.0)), 2)
    35.45
    """
    return cold_loss * (ambient_ratio + other_heat / runaway_loss) / (1 - cold_loss / runaway_loss)


def time_constant(linkage: Quantity, unit_loss: Quantity) -> Quantity:
    """Time constant of the current of a coil, inductance over resistance.

    Equation: tau = Lambda/p

    L = N Phi/I and R = P/I**2; the turns cancel.

    Parameters
    ----------
    linkage : scalar, array or symbol
        Flux of the coil over its ampere-turns, Lambda = Phi/NI [Wb/A].
    unit_loss : scalar, array or symbol
        Copper loss over the square of the ampere-turns, p = P/NI**2 [W/A2].

    Returns
    -------
    scalar, array or symbol
        tau [s].

    References
    ----------
    Circuit of a resistance and an inductance; derived.

    Examples
    --------
    By hand, 2.5 mWb of 900 A that lose 6.3 W:

    >>> round(float(time_constant(2.5e-3 / 900, 6.3 / 900**2)), 4)
    0.3571
    """
    return linkage / unit_loss


def current_rise_time(time_constant: Quantity, over_excitation: Quantity) -> Quantity:
    """Time in which the current rises to that of the steady coil.

    Equation: t = tau ln(k/(k - 1))

    Parameters
    ----------
    time_constant : scalar, array or symbol
        tau = L/R [s].
    over_excitation : scalar, array or symbol
        Voltage while the current rises over that of the steady coil k [-], above 1.

    Returns
    -------
    scalar, array or symbol
        t [s].

    References
    ----------
    I(t) = k I (1 - exp(-t/tau)).

    Examples
    --------
    By hand, 0.1 s x ln 2:

    >>> round(float(current_rise_time(0.1, 2.0)), 4)
    0.0693
    """
    return time_constant * np.log(over_excitation / (over_excitation - 1))
