"""Friction in the plate guides (splines) of a multi-plate clutch: how the clamp force fades along the pack.

The pack is counted from the actuator: inner plate 0, surface 1, outer plate I, surface 2, inner plate 1, ... Inner
plates slide on a spline of mean radius a, outer plates on one of mean radius b. Friction in the guides is
measured by kappa_a = mu mu1 r/a and kappa_b = mu mu1 r/b; S = kappa_a + kappa_b is the guide number.

The torque of a pack of z surfaces is M = mu F0 r E. The sum factor E is offered in five series:

====================  ======================================  ==================================================
series                E                                       source
====================  ======================================  ==================================================
geometric             (1 - (1+S)**-z)/S                       S0 (5), default, cautious
exponential_form      (1 - exp(-z ln(1+S)))/S                 S0 (5'), the same number
lipka                 (1 - exp(-z S))/S                       S0 (5''), Lipka's appendix
exponential_K         (1 - exp(-z K))/K, K = S/(1+S)          S0 (10), too large by a factor up to 1 + S
exact                 (1 - exp(-z (artanh kappa_a             plate by plate, both faces of a plate load its guide
                      + artanh kappa_b)))/S
====================  ======================================  ==================================================

All functions take floats, arrays or CasADi symbols, except those under "Inverse relations", which are numeric.

Sources: S0 (Szoke 1966, with the appendix of I. Lipka).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.errors import InputError
from synth.special import special
from synth.text.numbers import typed_number

from . import Quantity
from .ring import friction_radius, mean_diameter, ring_ratio

__all__ = [
    "GUIDE_SERIES",
    "RELATION_VARIABLES",
    "contact_force",
    "damped_guide_number",
    "exponential_k_error",
    "first_phase_push_force",
    "guarded_damping",
    "guide_jams",
    "guide_number",
    "guide_number_of_effectiveness",
    "guide_ratio",
    "legacy_plate_limit",
    "plate_torque",
    "solve_relation",
    "sum_exact",
    "sum_exponential_k",
    "sum_geometric",
    "sum_lipka",
    "surface_limit_exponential",
    "surface_limit_geometric",
    "surface_limit_lipka",
    "torque_asymptote",
    "torque_sum_factor",
]

GUIDE_SERIES = ("geometric", "exponential_form", "lipka", "exponential_K", "exact")  # names of the sum factors

# Added to S so that E stays finite for frictionless guides; it changes E by less than 1e-10 of its value.
_TINY_GUIDE_NUMBER = 1e-12


def guide_ratio(mu: Quantity, mu_guide: Quantity, friction_radius: Quantity, spline_radius: Quantity) -> Quantity:
    """Guide friction of one kind of plate; at kappa >= 1 the plate jams.

    Equation: kappa = mu mu1 r/R

    Parameters
    ----------
    mu, mu_guide : scalar, array or symbol
        Friction between plates mu and in the guides mu1 [-].
    friction_radius : scalar, array or symbol
        r [m].
    spline_radius : scalar, array or symbol
        Mean spline radius R [m], a of inner or b of outer plates.

    Returns
    -------
    scalar, array or symbol
        kappa [-].

    References
    ----------
    S0 (Szoke 1966), first and second phase of engagement.

    Examples
    --------
    Computed here for the inner plates of S0's example:

    >>> guide_ratio(0.1, 0.3, 4.12927, 3.2)
    0.038712
    """
    return mu * mu_guide * friction_radius / spline_radius


def guide_number(
    mu: Quantity,
    mu_guide: Quantity,
    friction_radius: Quantity,
    inner_spline_radius: Quantity,
    outer_spline_radius: Quantity,
) -> Quantity:
    """Guide number.

    Equation: S = mu mu1 r (a + b)/(a b)

    Parameters
    ----------
    mu, mu_guide : scalar, array or symbol
        Friction between plates mu and in the guides mu1 [-].
    friction_radius : scalar, array or symbol
        r [m].
    inner_spline_radius, outer_spline_radius : scalar, array or symbol
        a, b [m].

    Returns
    -------
    scalar, array or symbol
        S [-].

    References
    ----------
    S0 (Szoke 1966), eq. (2); its example prints 0.0642, the value with the right friction radius is 0.0634875.

    Examples
    --------
    >>> guide_number(0.1, 0.3, 4.129268, 3.2, 5.0)
    0.0634875
    """
    return mu * mu_guide * friction_radius * (1 / inner_spline_radius + 1 / outer_spline_radius)


def damped_guide_number(guide_number: Quantity) -> Quantity:
    """Constant of the continuous pack.

    Equation: K = S/(1 + S)

    Parameters
    ----------
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        K [-].

    References
    ----------
    S0 (Szoke 1966), eq. (8), (12); the example prints 0.0604, from its own S it is 0.060327.

    Examples
    --------
    >>> damped_guide_number(0.0634875)
    0.0596975
    """
    return guide_number / (1 + guide_number)


def guarded_damping(guide_number: Quantity) -> Quantity:
    """Constant of the continuous pack as the series use it, K of S + 1e-12, so that S may be 0.

    Equation: K = (S + 1e-12)/(1 + S + 1e-12)

    Parameters
    ----------
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        K [-].

    References
    ----------
    S0 (Szoke 1966), eq. (10).

    Examples
    --------
    >>> guarded_damping(0.25)
    0.2
    """
    return damped_guide_number(guide_number + _TINY_GUIDE_NUMBER)


@special((0.0, 1.0), (-1.0, 0.0), curvature="log-concave")
def sum_geometric(surfaces: Quantity, guide_number: Quantity) -> Quantity:
    """Sum factor of the geometric series; z for S = 0.

    Equation: E = (1 - (1 + S)**-z)/S

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        E [-].

    References
    ----------
    S0 (Szoke 1966), eq. (5) and (5').

    Examples
    --------
    S0 prints 12.076 for S = 0.0642, z = 24; recomputed 12.0776:

    >>> float(sum_geometric(24, 0.0642))
    12.0776
    """
    guarded = guide_number + _TINY_GUIDE_NUMBER
    return -np.expm1(-surfaces * np.log1p(guarded)) / guarded


@special((0.0, 1.0), (-1.0, 0.0), curvature="log-concave")
def sum_lipka(surfaces: Quantity, guide_number: Quantity) -> Quantity:
    """Sum factor with ln(1+S) replaced by S; z for S = 0.

    Equation: E = (1 - exp(-z S))/S

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        E [-].

    References
    ----------
    S0 (Szoke 1966), appendix by I. Lipka, eq. (5'').

    Examples
    --------
    S0 prints 12.239 for S = 0.0642, z = 24; recomputed 12.2397:

    >>> float(sum_lipka(24, 0.0642))
    12.2397
    """
    guarded = guide_number + _TINY_GUIDE_NUMBER
    return -np.expm1(-surfaces * guarded) / guarded


def sum_exponential_k(surfaces: Quantity, guide_number: Quantity) -> Quantity:
    """Sum factor of the continuous pack; z for S = 0.

    Equation: E = (1 - exp(-z K))/K, with K = S/(1 + S)

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        E [-]; larger than the geometric series by about S/2 (z = 1) up to S (many surfaces).

    References
    ----------
    S0 (Szoke 1966), eq. (10), (11).

    Examples
    --------
    S0 prints 12.670 for S = 0.0642, z = 24; recomputed 12.6796:

    >>> float(sum_exponential_k(24, 0.0642))
    12.6796
    """
    damped = guarded_damping(guide_number)
    return -np.expm1(-surfaces * damped) / damped


@special((0.0, 1.0), (-1.0, 0.0), (-1.0, 0.0))
def sum_exact(surfaces: Quantity, inner_ratio: Quantity, outer_ratio: Quantity) -> Quantity:
    """Sum factor of the plate-by-plate balance.

    Equation: E = (1 - exp(-z (artanh(kappa_a) + artanh(kappa_b))))/(kappa_a + kappa_b)

    Every plate hands the friction torque of both its faces to its guide. The closed form is for even z.

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-], even.
    inner_ratio, outer_ratio : scalar, array or symbol
        kappa_a, kappa_b [-], below 1.

    Returns
    -------
    scalar, array or symbol
        E [-].

    References
    ----------
    Sum of the axial balances N_j - N_(j+1) = kappa (N_j + N_(j+1)); extension of S0 (Szoke 1966), eq. (5).

    Examples
    --------
    Computed here for S0's example, z = 24:

    >>> float(sum_exact(24, 0.1 * 0.3 * 4.129268 / 3.2, 0.1 * 0.3 * 4.129268 / 5.0))
    12.3209
    """
    inner = inner_ratio + _TINY_GUIDE_NUMBER / 2
    outer = outer_ratio + _TINY_GUIDE_NUMBER / 2
    return -np.expm1(-surfaces / 2 * _twice_artanh(inner, outer)) / (inner + outer)


def torque_sum_factor(series: str, surfaces: Quantity, inner_ratio: Quantity, outer_ratio: Quantity) -> Quantity:
    """Sum factor E of a chosen series.

    Equation: E = sum_lipka(z, S) if lipka else sum_exponential_k(z, S) if exponential_K else sum_exact(z, kappa_a,
        kappa_b) if exact else sum_geometric(z, S), with S = kappa_a + kappa_b

    Parameters
    ----------
    series : str
        One of ``GUIDE_SERIES``.
    surfaces : scalar, array or symbol
        z [-].
    inner_ratio, outer_ratio : scalar, array or symbol
        kappa_a, kappa_b [-]; S is their sum.

    Returns
    -------
    scalar, array or symbol
        E [-].

    Raises
    ------
    InputError
        When the series is not known.

    References
    ----------
    S0 (Szoke 1966), eq. (5), (5'), (5''), (10), and the exact balance.

    Examples
    --------
    Computed here for S0's example, z = 24:

    >>> float(torque_sum_factor("geometric", 24, 0.0387119, 0.0247756))
    12.1558
    """
    if series in ("geometric", "exponential_form"):
        return sum_geometric(surfaces, inner_ratio + outer_ratio)
    if series == "lipka":
        return sum_lipka(surfaces, inner_ratio + outer_ratio)
    if series == "exponential_K":
        return sum_exponential_k(surfaces, inner_ratio + outer_ratio)
    if series == "exact":
        return sum_exact(surfaces, inner_ratio, outer_ratio)
    raise InputError("guide_series", series, "one of " + ", ".join(GUIDE_SERIES))


def _twice_artanh(inner_ratio: Quantity, outer_ratio: Quantity) -> Quantity:
    return np.log1p(inner_ratio) - np.log1p(-inner_ratio) + np.log1p(outer_ratio) - np.log1p(-outer_ratio)


def contact_force(
    series: str, force: Quantity, surface: Quantity, inner_ratio: Quantity, outer_ratio: Quantity
) -> Quantity:
    """Contact force on surface j counted from the actuator.

    Equation: F_j = F0 (E_j - E_i), with E_j = torque_sum_factor(series, j, kappa_a, kappa_b), E_i =
        torque_sum_factor(series, j - 1, kappa_a, kappa_b)

    Parameters
    ----------
    series : str
        One of ``GUIDE_SERIES``.
    force : scalar, array or symbol
        Actuator force F0 [N].
    surface : scalar, array or symbol
        j = 1, 2, ... [-].
    inner_ratio, outer_ratio : scalar, array or symbol
        kappa_a, kappa_b [-].

    Returns
    -------
    scalar, array or symbol
        F_j [N]; mu r times their sum is the torque of the pack.

    Raises
    ------
    InputError
        When the series is not known.

    References
    ----------
    S0 (Szoke 1966), eq. (3), (4), (13); in (13) as printed stands a torque, F = F0 exp(-K x) is meant.

    Examples
    --------
    By hand, 1000/1.1 and 1000/1.1**2:

    >>> float(contact_force("geometric", 1000, 1, 0.06, 0.04)), float(contact_force("geometric", 1000, 2, 0.06, 0.04))
    (909.091, 826.446)
    """
    guide = inner_ratio + outer_ratio + _TINY_GUIDE_NUMBER
    if series in ("geometric", "exponential_form"):
        return force * np.exp(-surface * np.log1p(guide))
    if series == "lipka":
        return force * np.exp(-(surface - 1) * guide) * -np.expm1(-guide) / guide
    if series == "exponential_K":
        damped = guarded_damping(inner_ratio + outer_ratio)
        return force * np.exp(-(surface - 1) * damped) * -np.expm1(-damped) / damped
    if series == "exact":
        inner_passed, outer_passed = np.floor((surface - 1) / 2), np.floor(surface / 2)
        fade = inner_passed * (np.log1p(inner_ratio) - np.log1p(-inner_ratio))
        fade = fade + outer_passed * (np.log1p(outer_ratio) - np.log1p(-outer_ratio))
        return force / (1 + inner_ratio) * np.exp(-fade)
    raise InputError("guide_series", series, "one of " + ", ".join(GUIDE_SERIES))


def plate_torque(mu: Quantity, friction_radius: Quantity, *contact_forces: Quantity) -> Quantity:
    """Torque that one plate hands to its spline, mu r times the contact forces on its faces.

    Equation: M = mu r sum(F_j)

    Parameters
    ----------
    mu : scalar, array or symbol
        Friction between plates mu [-].
    friction_radius : scalar, array or symbol
        r [m].
    *contact_forces : scalar, array or symbol
        Force on each rubbing face F_j [N].

    Returns
    -------
    scalar, array or symbol
        Torque [N m].

    References
    ----------
    Equilibrium of one plate; with eq. (5) of S0 outer plate I carries mu r F0 (1/(1+S) + 1/(1+S)**2).

    Examples
    --------
    By hand:

    >>> plate_torque(0.1, 0.1, 909.1, 826.4)
    17.355
    """
    return mu * friction_radius * sum(contact_forces)


def torque_asymptote(
    force: Quantity, mu_guide: Quantity, inner_spline_radius: Quantity, outer_spline_radius: Quantity
) -> Quantity:
    """Torque that no number of plates can exceed, whatever mu, r and z.

    Equation: M = F0 a b/(mu1 (a + b))

    Parameters
    ----------
    force : scalar, array or symbol
        Actuator force F0 [N].
    mu_guide : scalar, array or symbol
        Friction in the guides mu1 [-], above 0.
    inner_spline_radius, outer_spline_radius : scalar, array or symbol
        a, b [m].

    Returns
    -------
    scalar, array or symbol
        Torque [N m]; eq. (10) of S0 has 1 + S times it.

    References
    ----------
    Limit of S0 (Szoke 1966), eq. (5), for many surfaces: M0/S.

    Examples
    --------
    By hand for S0's example with 1 kN: 1000 x 0.016/(0.3 x 0.82) ... in metres 0.032 x 0.05/(0.3 x 0.082):

    >>> torque_asymptote(1000, 0.3, 0.032, 0.05)
    65.041
    """
    inverse_radii = 1 / inner_spline_radius + 1 / outer_spline_radius
    return force / (mu_guide * inverse_radii)


def exponential_k_error(surfaces: Quantity, guide_number: Quantity) -> Quantity:
    """Relative error of eq. (10) against eq. (5).

    Equation: error = (1 + S) (1 - exp(-K z))/(1 - (1 + S)**-z) - 1, with K = S/(1 + S)

    Parameters
    ----------
    surfaces : scalar, array or symbol
        z [-].
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        Error [-]; S/2 for one surface, S for many.

    References
    ----------
    S0 (Szoke 1966), appendix by I. Lipka (prints 5 % for its example).

    Examples
    --------
    >>> float(100 * exponential_k_error(24, 0.0642))
    4.98452
    """
    return sum_exponential_k(surfaces, guide_number) / sum_geometric(surfaces, guide_number) - 1


def legacy_plate_limit(guide_number: Quantity) -> Quantity:
    """Plate limit of the three-term series: surfaces beyond which more torque is lost than gained.

    Equation: z = sqrt(2)/K, with K = S/(1 + S)

    Kept for comparison with S0; the cautious limit is :func:`surface_limit_geometric`.

    Parameters
    ----------
    guide_number : scalar, array or symbol
        S [-].

    Returns
    -------
    scalar, array or symbol
        Surfaces [-].

    References
    ----------
    S0 (Szoke 1966), eq. (15); its example prints 23.4, with the right S it is 23.6897.

    Examples
    --------
    >>> float(legacy_plate_limit(0.0634875))
    23.6897
    """
    return np.sqrt(2.0) / damped_guide_number(guide_number)


def first_phase_push_force(
    weights: Sequence[Quantity],
    mu: Quantity,
    mu_guide: Quantity,
    friction_radius: Quantity,
    inner_spline_radius: Quantity,
    outer_spline_radius: Quantity,
) -> Quantity:
    """Force that closes the gaps of the first plates, against weight and torque friction in the guides.

    Equation (recursion): N_j = (mu1 G_j + (1 + kappa_j) N_(j+1))/(1 - kappa_j), at the actuator mu1 G_0 + (1 + kappa_0)
        N_1

    Plates 0, I, 1, II, ... alternate inner and outer. The last one pushed, p, needs
    N_p = mu1 G_p/(1 - kappa_p); further forward N_j = (mu1 G_j + (1 + kappa_j) N_(j+1))/(1 - kappa_j), and the
    actuator mu1 G_0 + (1 + kappa_0) N_1. Shaft horizontal; weight and torque friction are added as
    scalars, an upper bound.

    Parameters
    ----------
    weights : sequence of scalars, arrays or symbols
        Weights of the plates from the actuator on, first an inner one G_0, G_1, ... [N].
    mu, mu_guide : scalar, array or symbol
        Friction between plates mu and in the guides mu1 [-].
    friction_radius : scalar, array or symbol
        r [m].
    inner_spline_radius, outer_spline_radius : scalar, array or symbol
        a, b [m].

    Returns
    -------
    scalar, array or symbol
        Push force [N]; meaningless where :func:`guide_jams` holds for a plate behind the first.

    References
    ----------
    S0 (Szoke 1966), first phase of engagement (two plates); any number of plates derived.

    Examples
    --------
    By hand for two plates of 1 and 1.5 N: kappa_a = 0.0387119, kappa_b = 0.0247756;
    f_I = 0.3 x 1.5/0.9752244 = 0.461432, push = 0.461432 x 1.0387119 + 0.3:

    >>> first_phase_push_force([1.0, 1.5], 0.1, 0.3, 4.129268, 3.2, 5.0)
    0.779295
    """
    radii = (inner_spline_radius, outer_spline_radius)
    push = 0.0
    for plate in range(len(weights) - 1, -1, -1):
        kappa = guide_ratio(mu, mu_guide, friction_radius, radii[plate % 2])
        ahead = mu_guide * weights[plate] + (1 + kappa) * push
        # The actuator turns with plate 0, so that this plate meets no torque on its front face.
        push = ahead if plate == 0 else ahead / (1 - kappa)
    return push


def guide_jams(mu: Quantity, mu_guide: Quantity, friction_radius: Quantity, spline_radius: Quantity) -> Quantity:
    """Whether a plate jams in its guide.

    Equation: jams = mu mu1 r >= R

    Parameters
    ----------
    mu, mu_guide : scalar, array or symbol
        Friction between plates mu and in the guides mu1 [-].
    friction_radius : scalar, array or symbol
        r [m].
    spline_radius : scalar, array or symbol
        Mean spline radius of the plate R [m].

    Returns
    -------
    bool, array or symbol
        True where no force moves the plate.

    References
    ----------
    S0 (Szoke 1966), denominator b - mu mu1 r of the first phase.

    Examples
    --------
    >>> guide_jams(0.1, 0.3, 0.1, 0.05), guide_jams(0.8, 0.8, 0.1, 0.05)
    (False, True)
    """
    return mu * mu_guide * friction_radius >= spline_radius


# -- Inverse relations: numeric only ---------------------------------------------------------------


def _principal_lambert(argument: Quantity) -> Quantity:
    """Real principal branch of Lambert W; clipped at -1/e, where rounding may step across the branch point."""
    from scipy.special import lambertw  # costly to import; few series of guides need it

    return np.real(lambertw(np.maximum(argument, -np.exp(-1.0))))


def _scaled_limit(start: Quantity) -> Quantity:
    """Root y > 0 of start (1 - exp(-y)) = y; 0 where start <= 1, because then there is none. Refuses symbols."""
    if not isinstance(start, (float, int, np.ndarray, np.generic)):
        # NumPy takes a symbol for not-a-number, which is above nothing: it would be told that there is no root.
        raise TypeError(f"a limit of surfaces is for numbers, not for {type(start).__name__}")
    start = np.asarray(start, dtype=float)
    return np.where(start > 1, start + _principal_lambert(-start * np.exp(-start)), 0.0)


def surface_limit_exponential(guide_number: Quantity, threshold: float = 0.5) -> Quantity:
    """Surfaces beyond which E/z of eq. (10) falls below a threshold.

    Equation: z = (1/eta + W0(-exp(-1/eta)/eta))/K, with K = S/(1 + S)

    Numeric only.

    Parameters
    ----------
    guide_number : scalar or array
        S [-].
    threshold : float
        Least E/z, eta [-]; 1/2 means that the torque exceeds the torque lost.

    Returns
    -------
    scalar or array
        Surfaces [-], real; 1.5936243/K for eta = 1/2.

    References
    ----------
    S0 (Szoke 1966), eq. (14), solved in closed form.

    Examples
    --------
    S0 prints lambda = 1.594 for K z:

    >>> float(surface_limit_exponential(0.0634875) * 0.0596975)
    1.59362
    """
    return _scaled_limit(1 / threshold) / damped_guide_number(guide_number)


def surface_limit_lipka(guide_number: Quantity, threshold: float = 0.5) -> Quantity:
    """Surfaces beyond which E/z of eq. (5'') falls below a threshold. Numeric only.

    Equation: z = (1/eta + W0(-exp(-1/eta)/eta))/S

    Parameters
    ----------
    guide_number : scalar or array
        S [-].
    threshold : float
        Least E/z, eta [-].

    Returns
    -------
    scalar or array
        Surfaces [-], real; 1.5936243/S for eta = 1/2.

    References
    ----------
    S0 (Szoke 1966), appendix by I. Lipka.

    Examples
    --------
    Computed here:

    >>> float(surface_limit_lipka(0.0635))
    25.0964
    """
    return _scaled_limit(1 / threshold) / guide_number


def surface_limit_geometric(guide_number: Quantity, threshold: float = 0.5) -> Quantity:
    """Surfaces beyond which E/z of eq. (5) falls below a threshold: the limit to use. Numeric only.

    Equation: z = (q + W0(-q exp(-q)))/L, with L = ln(1 + S), q = L/(eta S)

    Parameters
    ----------
    guide_number : scalar or array
        S [-].
    threshold : float
        Least E/z, eta [-].

    Returns
    -------
    scalar or array
        Surfaces [-], real; 0 where not even one surface reaches the threshold.

    References
    ----------
    S0 (Szoke 1966), eq. (16); its root z = 0 does not count.

    Examples
    --------
    Computed here (S0 finds z = 24 "sufficiently accurate"):

    >>> float(surface_limit_geometric(0.0634875)), float(surface_limit_geometric(0.0642))
    (24.55, 24.27)
    """
    log_ratio = np.log1p(guide_number)
    return _scaled_limit(log_ratio / (threshold * guide_number)) / log_ratio


def guide_number_of_effectiveness(effectiveness: float, surfaces: float, series: str = "geometric") -> float:
    """Guide number S at which E/z takes a value: what a surface-count factor c_z stands for. Numeric only.

    Equation (implicit): E(z, S)/z = effectiveness

    Parameters
    ----------
    effectiveness : float
        E/z [-], in (0, 1).
    surfaces : float
        z [-].
    series : str
        A series that depends on S alone: geometric, exponential_form, lipka or exponential_K.

    Returns
    -------
    float
        S [-].

    Raises
    ------
    InputError
        When no S gives this effectiveness, or the series needs more than S.

    References
    ----------
    S0 (Szoke 1966), eq. (5); S1 (lecture), c_z = 0.75 at z = 10.

    Examples
    --------
    >>> guide_number_of_effectiveness(0.75, 10)
    0.0560446
    """
    from scipy.optimize import brentq  # costly to import; designing needs no inverse relation

    if not 0 < effectiveness < 1:
        raise InputError("effectiveness", effectiveness, "a number between 0 and 1, both excluded")

    def excess(log_guide_number: float) -> float:
        return float(_sum_of_guide_number(series, surfaces, np.exp(log_guide_number)) / surfaces - effectiveness)

    low, high = np.log(1e-10), np.log(1e10)
    if excess(low) < 0 or excess(high) > 0:
        raise InputError(
            "effectiveness", effectiveness, f"a value that {typed_number(surfaces)} surfaces of series {series} reach"
        )
    return float(np.exp(brentq(excess, low, high, xtol=1e-15, rtol=1e-14)))


def _sum_of_guide_number(series: str, surfaces: float, guide_number: float) -> float:
    if series == "exact":
        raise InputError("guide_series", series, "a series that depends on S alone, for instance geometric")
    return float(torque_sum_factor(series, surfaces, guide_number, 0.0))


RELATION_VARIABLES = (
    "inner_radius",
    "outer_radius",
    "inner_spline_radius",
    "outer_spline_radius",
    "mu",
    "mu_guide",
    "surfaces",
    "force",
    "torque",
)


def solve_relation(unknown: str, series: str = "geometric", **known: float) -> float:
    """Solve the torque of a pack for any one of its nine variables. Numeric only.

    Equation (implicit): M = mu F0 r E(z, S)

    The nine are inner_radius r1, outer_radius r2, inner_spline_radius a, outer_spline_radius b, mu, mu_guide mu1,
    surfaces z (real), force F0 and torque M. The torque rises with all of them but mu_guide, so
    that the solution is unique.

    Parameters
    ----------
    unknown : str
        Name of the variable wanted.
    series : str
        A series that depends on S alone: geometric (default), exponential_form, lipka or exponential_K.
    **known : float
        The other eight [SI].

    Returns
    -------
    float
        The unknown [SI].

    Raises
    ------
    InputError
        When a variable is missing, too many are given, or no clutch satisfies the relation.

    References
    ----------
    S0 (Szoke 1966), eq. (5) with (2), "nine independent variables".

    Examples
    --------
    S0's example, 12.1558 times M0 at 24 surfaces:

    >>> clutch = dict(inner_radius=0.035, outer_radius=0.047, inner_spline_radius=0.032, outer_spline_radius=0.05)
    >>> solve_relation("torque", mu=0.1, mu_guide=0.3, force=1000.0, surfaces=24, **clutch) / (100 * 0.04129268)
    12.1558
    >>> solve_relation("surfaces", mu=0.1, mu_guide=0.3, force=1000.0, torque=50.0, **clutch)
    23.7883
    """
    if unknown not in RELATION_VARIABLES:
        raise InputError("unknown", unknown, "one of " + ", ".join(RELATION_VARIABLES))
    for name in RELATION_VARIABLES:
        if name != unknown and name not in known:
            raise InputError(name, None, f"a value, because {unknown} is sought")
    for name, value in known.items():
        if name not in RELATION_VARIABLES or name == unknown:
            raise InputError(name, value, f"only the eight variables besides {unknown}")
        allowed = np.isfinite(value) and (value > 0 or (name == "mu_guide" and value == 0))
        if not allowed:
            raise InputError(name, value, "a finite number above 0")
    if unknown in ("torque", "force"):
        return _solve_direct(unknown, series, known)
    if unknown == "surfaces":
        return _solve_surfaces(series, known)
    if unknown in ("mu", "inner_radius", "outer_radius"):
        return _solve_grip(unknown, series, known)
    return _solve_guides(unknown, series, known)


def _radius(known: dict[str, float]) -> float:
    if known["inner_radius"] >= known["outer_radius"]:
        raise InputError("inner_radius", known["inner_radius"], "a radius below outer_radius")
    outer, inner = 2 * known["outer_radius"], 2 * known["inner_radius"]
    return float(friction_radius(mean_diameter(outer, inner), ring_ratio(outer, inner)))


def _solve_direct(unknown: str, series: str, known: dict[str, float]) -> float:
    radius = _radius(known)
    guide = guide_number(
        known["mu"], known["mu_guide"], radius, known["inner_spline_radius"], known["outer_spline_radius"]
    )
    torque_per_force = known["mu"] * radius * _sum_of_guide_number(series, known["surfaces"], guide)
    return torque_per_force * known["force"] if unknown == "torque" else known["torque"] / torque_per_force


def _solve_surfaces(series: str, known: dict[str, float]) -> float:
    radius = _radius(known)
    guide = guide_number(
        known["mu"], known["mu_guide"], radius, known["inner_spline_radius"], known["outer_spline_radius"]
    )
    wanted = known["torque"] / (known["mu"] * known["force"] * radius)
    if guide == 0:
        return wanted
    rate, scale = {
        "geometric": (np.log1p(guide), guide),
        "exponential_form": (np.log1p(guide), guide),
        "lipka": (guide, guide),
        "exponential_K": (damped_guide_number(guide), damped_guide_number(guide)),
    }.get(series, (0.0, 0.0))
    if rate == 0:
        raise InputError("guide_series", series, "a series that depends on S alone, for instance geometric")
    lost = wanted * scale
    if lost >= 1:
        raise InputError("torque", known["torque"], "a torque below what the guides let pass, however many plates")
    return float(-np.log1p(-lost) / rate)


def _solve_grip(unknown: str, series: str, known: dict[str, float]) -> float:
    """Solve for mu, or for the friction radius and from it one radius of the ring."""
    from scipy.optimize import brentq  # costly to import; designing needs no inverse relation

    surfaces, mu_guide = known["surfaces"], known["mu_guide"]
    inverse_radii = 1 / known["inner_spline_radius"] + 1 / known["outer_spline_radius"]
    # M = F0 (mu r) E(z, (mu r) mu1 (1/a + 1/b)): only the product mu r is sought.
    reach = known["torque"] / known["force"]

    def excess(grip: float) -> float:
        return grip * _sum_of_guide_number(series, surfaces, grip * mu_guide * inverse_radii) - reach

    grip_high = reach / surfaces
    while excess(grip_high) < 0:
        grip_high *= 2
        if grip_high > 1e12 * reach:
            raise InputError("torque", known["torque"], "a torque below what the guides let pass, however large mu r")
    grip = reach / surfaces
    if grip < grip_high:
        grip = float(brentq(excess, grip, grip_high, xtol=1e-300, rtol=1e-14))
    if unknown == "mu":
        return grip / _radius(known)
    radius = grip / known["mu"]
    if unknown == "inner_radius":
        given = known["outer_radius"]
        if not 2 * given / 3 <= radius <= given:
            raise InputError(
                "outer_radius", given, f"a radius between {typed_number(radius)} and {typed_number(1.5 * radius)} m"
            )
    else:
        given = known["inner_radius"]
        if radius < given:
            raise InputError("inner_radius", given, f"a radius of at most {typed_number(radius)} m")
    # x**2 + x (given - 1.5 r) + given**2 - 1.5 r given = 0, from 2/3 (r1**2 + r1 r2 + r2**2)/(r1 + r2) = r
    half = (given - 1.5 * radius) / 2
    return float(-half + np.sqrt(half**2 - given**2 + 1.5 * radius * given))


def _solve_guides(unknown: str, series: str, known: dict[str, float]) -> float:
    """Solve for mu1, a or b: first the S that the torque leaves, then the one that makes it up."""
    radius = _radius(known)
    effectiveness = known["torque"] / (known["mu"] * known["force"] * radius * known["surfaces"])
    if effectiveness >= 1:
        raise InputError("torque", known["torque"], "a torque below mu F0 r z, which needs no friction in the guides")
    guide = guide_number_of_effectiveness(effectiveness, known["surfaces"], series)
    if unknown == "mu_guide":
        return float(
            guide / guide_number(1.0, known["mu"], radius, known["inner_spline_radius"], known["outer_spline_radius"])
        )
    other_name = "outer_spline_radius" if unknown == "inner_spline_radius" else "inner_spline_radius"
    inverse = guide / (known["mu"] * known["mu_guide"] * radius) - 1 / known[other_name]
    if inverse <= 0:
        raise InputError(other_name, known[other_name], f"a larger radius: with this one no {unknown} loses so little")
    found = 1 / inverse
    if unknown == "inner_spline_radius" and found >= known["inner_radius"]:
        raise InputError(
            "inner_radius", known["inner_radius"], f"a radius above the spline radius {typed_number(found)} m"
        )
    if unknown == "outer_spline_radius" and found <= known["outer_radius"]:
        raise InputError(
            "outer_radius", known["outer_radius"], f"a radius below the spline radius {typed_number(found)} m"
        )
    return float(found)
