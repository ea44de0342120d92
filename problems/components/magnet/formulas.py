"""Pot magnet with a ring coil: an inner and an outer annular pole of equal area pull an armature plate.

Every function takes floats, arrays or CasADi symbols.

Sources: the pull of an electromagnet in place of clamp springs is an idea of the notes on centrifugal clutches (S4,
figure 2-27); geometry and circuit are derived (section 6.6 there). Circuit, winding and heat: see
:mod:`synth.problems.mechanics.magnetics`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...mechanics import Quantity, magnetics


@dataclass(frozen=True, kw_only=True)
class ExpectedPack:
    """What a duty lets expect of a pack before it is sized; figures of engineering practice, without a source.

    Parameters
    ----------
    friction : float
        Coefficient of a dry lining.
    surfaces : float
        Friction surfaces of one disc.
    radius : float
        Friction radius over shaft diameter; packs that were searched have 1.8 to 3.
    return_share, drag_share : float
        Return springs and sliding plates over the clamping force.
    gap_ratio : float
        Gap at each pole of the engaged magnet over shaft diameter.
    gap_min, gap_max : float
        Its ends [m]: what can be held, and the typical gap of larger magnets.
    """

    friction: float = 0.3
    surfaces: float = 2.0
    radius: float = 2.5
    return_share: float = 0.015
    drag_share: float = 0.004
    gap_ratio: float = 0.015
    gap_min: float = 0.1e-3
    gap_max: float = 0.4e-3


EXPECTED = ExpectedPack()


@dataclass(frozen=True)
class PotMagnet:
    """Dimensions of a pot magnet with its armature plate [m]."""

    bore: Quantity
    pole_width: Quantity
    coil_length: Quantity
    coil_height: Quantity
    thickness: Quantity
    residual_gap: Quantity

    @property
    def inner_pole_radius(self) -> Quantity:
        """Outside of the inner pole r_2, inside of the coil [m]."""
        return self.bore + self.pole_width

    @property
    def coil_outer_radius(self) -> Quantity:
        """Outside of the coil r_3 [m]."""
        return self.inner_pole_radius + self.coil_height

    @property
    def pole_section(self) -> Quantity:
        """Area of one pole over pi, r_2**2 - r_1**2 [m2]."""
        return self.pole_width * (2 * self.bore + self.pole_width)

    @property
    def pole_area(self) -> Quantity:
        """Area of one pole A_p = pi (r_2**2 - r_1**2) [m2]."""
        return np.pi * self.pole_section

    @property
    def outer_radius(self) -> Quantity:
        """Outside r_4 of the outer pole of the same area [m]."""
        return np.sqrt(self.coil_outer_radius**2 + self.pole_section)

    @property
    def disc_section(self) -> Quantity:
        """Section of yoke and of armature over pi, r_4**2 - r_1**2 as a sum, of which bounds are tight [m2]."""
        inside = self.pole_width + self.coil_height
        return inside * (2 * self.bore + inside) + self.pole_section

    @property
    def outer_pole_width(self) -> Quantity:
        """Width r_4 - r_3 of the outer pole [m]."""
        return self.pole_section / (self.coil_outer_radius + self.outer_radius)

    @property
    def yoke_width(self) -> Quantity:
        """Thickness that a yoke needs to be as wide for the flux as the pole, A_p/(2 pi r_2) [m]."""
        radius = self.inner_pole_radius
        return (radius - self.bore**2 / radius) / 2

    @property
    def iron_path(self) -> Quantity:
        """Mean length of the flux in iron, l_fe = 2 (l_m + t_y) + 2 h_c + (r_2 - r_1) + (r_4 - r_3) [m]."""
        return 2 * (self.coil_length + self.thickness + self.coil_height) + self.pole_width + self.outer_pole_width

    @property
    def body_length(self) -> Quantity:
        """Length of pot and armature without the gap, l_m + 2 t_y [m]."""
        return self.coil_length + 2 * self.thickness

    @property
    def length(self) -> Quantity:
        """Length of the engaged magnet l_m + 2 t_y + g_r [m]."""
        return self.body_length + self.residual_gap


def magnet_force(flux_density: Quantity, magnet: PotMagnet) -> Quantity:
    """Pull on the armature, B**2 A_p/mu0: two poles of A_p.

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B at the poles [T].
    magnet : PotMagnet
        Dimensions.

    Returns
    -------
    scalar, array or symbol
        F_m [N].

    References
    ----------
    Maxwell; S4, section 3.5.

    Examples
    --------
    By hand, 0.8**2 pi (0.035**2 - 0.02**2)/mu0:

    >>> round(float(magnet_force(0.8, PotMagnet(0.02, 0.015, 0.03, 0.02, 0.01, 0.4e-3))), 1)
    1320.0
    """
    return magnetics.pole_force(flux_density, 2 * magnet.pole_area)


def yoke_flux_ratio(magnet: PotMagnet) -> Quantity:
    """Flux density of yoke and armature at the inner pole over that of the pole iron, A_p/(2 pi r_2 t_y).

    Parameters
    ----------
    magnet : PotMagnet
        Dimensions.

    Returns
    -------
    scalar, array or symbol
        Ratio [-]; 1 where the yoke is as wide for the flux as the pole.

    References
    ----------
    Continuity of the flux; S4, section 6.6.

    Examples
    --------
    By hand, (0.035**2 - 0.02**2)/(2 x 0.035 x 0.01):

    >>> round(float(yoke_flux_ratio(PotMagnet(0.02, 0.015, 0.03, 0.02, 0.01, 0.4e-3))), 4)
    1.1786
    """
    return magnet.yoke_width / magnet.thickness


def engaged_ampere_turns(flux_density: Quantity, magnet: PotMagnet, iron_field: Quantity) -> Quantity:
    """Ampere-turns of the engaged magnet, 2 g_r B/mu0 + H l_fe.

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B at the poles [T].
    magnet : PotMagnet
        Dimensions.
    iron_field : scalar, array or symbol
        Field in the densest iron, taken along the whole path [A/m].

    Returns
    -------
    scalar, array or symbol
        NI [A].

    References
    ----------
    Ampere's law; S4, section 6.6.

    Examples
    --------
    By hand, 2 x 0.4e-3 x 0.8/mu0 + 300 x 0.142:

    >>> magnet = PotMagnet(0.02, 0.015, 0.03, 0.02, 0.01, 0.4e-3)
    >>> round(float(magnet.iron_path), 3)
    0.142
    >>> round(float(engaged_ampere_turns(0.8, magnet, 300.0)), 1)
    551.9
    """
    return 2 * magnet.residual_gap * magnetics.gap_field(flux_density) + iron_field * magnet.iron_path


def pull_in_force(ampere_turns: Quantity, gap: Quantity, pole_area: Quantity) -> Quantity:
    """Pull on the released armature, B**2 A_p/mu0 with B = mu0 NI/(2 g); the iron is neglected, its flux is low.

    Parameters
    ----------
    ampere_turns : scalar, array or symbol
        NI [A].
    gap : scalar, array or symbol
        Gap at each pole g_in [m].
    pole_area : scalar, array or symbol
        A_p of one pole [m2].

    Returns
    -------
    scalar, array or symbol
        F_in [N].

    References
    ----------
    Ampere, Maxwell; S4, section 6.6.

    Examples
    --------
    By hand, mu0 A_p (600/(2 x 2.2e-3))**2:

    >>> round(float(pull_in_force(600.0, 2.2e-3, 2.5918e-3)), 2)
    60.56
    """
    return magnetics.MU_0 * pole_area * (ampere_turns / (2 * gap)) ** 2


def expected_clamping_force(torque: Quantity, shaft_diameter: Quantity) -> Quantity:
    """Force that presses a pack for a torque, as far as the duty alone tells it, F_c = M/(mu z r).

    With two dry surfaces and the friction radius of packs on such a shaft.

    Parameters
    ----------
    torque : scalar, array or symbol
        M [N m].
    shaft_diameter : scalar, array or symbol
        d_s [m].

    Returns
    -------
    scalar, array or symbol
        F_c [N].

    References
    ----------
    Torque of a friction pack; coefficient, surfaces and radius are engineering practice.

    Examples
    --------
    8.82 N m on a shaft of 13.1 mm, by hand 8.82/(0.3 x 2 x 2.5 x 0.0131):

    >>> round(float(expected_clamping_force(8.82, 0.0131)), 2)
    448.85
    """
    return torque / (EXPECTED.friction * EXPECTED.surfaces * EXPECTED.radius * shaft_diameter)


def return_force(clamping_force: Quantity) -> Quantity:
    """Springs that part a pack whose magnet has let go: a share of the clamping force.

    They stand against three things that grow with it. Iron of a coercive field H_c around a path l keeps
    B_r = mu0 H_c l/(2 g): with 200 A/m, 0.15 m and 0.4 mm 0.047 T, or 0.13 % of the pull at 1.3 T; twice the field, of
    iron that was not annealed, 0.5 %. An armature weighs about 0.4 % of its clamping force, plates that slide take as
    much (``release_drag``).

    Parameters
    ----------
    clamping_force : scalar, array or symbol
        F_c [N].

    Returns
    -------
    scalar, array or symbol
        F_ret [N].

    References
    ----------
    Ampere's law, Maxwell's force; the share is engineering practice.

    Examples
    --------
    >>> round(float(return_force(448.85)), 3)
    6.733
    """
    return EXPECTED.return_share * clamping_force


def release_drag(clamping_force: Quantity) -> Quantity:
    """Push of plates that slide in their guides, a share of the clamping force: 20 N of 5000 N.

    Parameters
    ----------
    clamping_force : scalar, array or symbol
        F_c [N].

    Returns
    -------
    scalar, array or symbol
        F_drag [N].

    References
    ----------
    Engineering practice.

    Examples
    --------
    >>> release_drag(5000.0)
    20.0
    """
    return EXPECTED.drag_share * clamping_force


def gap_against_sticking(shaft_diameter: Quantity) -> Quantity:
    """Gap at each pole of the engaged magnet for a clutch of a size, g_r = 0.015 d_s from 0.1 to 0.4 mm.

    Remanence makes B_r = mu0 H_c l/(2 g_r) across it, and the way l through the iron grows with the size: the gap of a
    small magnet may be as much smaller. Larger ones keep the typical 0.4 mm.

    Parameters
    ----------
    shaft_diameter : scalar, array or symbol
        d_s [m].

    Returns
    -------
    scalar, array or symbol
        g_r [m].

    References
    ----------
    Ampere's law; the ratio is engineering practice, so chosen that a shaft of 27 mm has 0.4 mm.

    Examples
    --------
    >>> [round(1e3 * float(gap_against_sticking(d)), 4) for d in (0.004, 0.0131, 0.045)]
    [0.1, 0.1965, 0.4]
    """
    return np.minimum(np.maximum(EXPECTED.gap_ratio * shaft_diameter, EXPECTED.gap_min), EXPECTED.gap_max)


def magnet_mass(density: Quantity, magnet: PotMagnet, copper: Quantity) -> Quantity:
    """Mass of pot, armature and coil, rho [2 A_p l_m + 2 pi (r_4**2 - r_1**2) t_y] + copper.

    Parameters
    ----------
    density : scalar, array or symbol
        rho of the iron [kg/m3].
    magnet : PotMagnet
        Dimensions.
    copper : scalar, array or symbol
        Mass of the coil [kg].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; S4, section 6.6.

    Examples
    --------
    By hand, 7850 (2 x 2.5918e-3 x 0.03 + 2 pi (0.06205**2 - 0.02**2) 0.01) + 0.5:

    >>> round(float(magnet_mass(7850.0, PotMagnet(0.02, 0.015, 0.03, 0.02, 0.01, 0.4e-3), 0.5)), 3)
    3.422
    """
    discs = 2 * np.pi * magnet.disc_section * magnet.thickness
    return density * (2 * magnet.pole_area * magnet.coil_length + discs) + copper


@dataclass(frozen=True)
class Circuit:
    """The magnetic circuit of an engaged magnet: what a flux density of its poles' gap asks of iron and coil.

    Declaration and curves speak through it of the same iron; all in SI, numbers or symbols.
    """

    shape: PotMagnet
    leakage_factor: Quantity
    iron_reluctance: Quantity
    iron_saturation: Quantity

    def pole(self, flux_density: Quantity) -> Quantity:
        """Flux density of the pole iron [T]."""
        return self.leakage_factor * flux_density

    def yoke(self, flux_density: Quantity) -> Quantity:
        """Flux density of yoke and armature [T]."""
        return self.pole(flux_density) * yoke_flux_ratio(self.shape)

    def densest(self, flux_density: Quantity) -> Quantity:
        """Flux density of the iron that has most [T]."""
        return self.pole(flux_density) * np.maximum(yoke_flux_ratio(self.shape), 1.0)

    def ampere_turns(self, flux_density: Quantity) -> Quantity:
        """Ampere-turns that the flux density needs [A]."""
        field = magnetics.iron_field(self.densest(flux_density), self.iron_reluctance, self.iron_saturation)
        return engaged_ampere_turns(flux_density, self.shape, field)

    def linkage(self, flux_density: Quantity) -> Quantity:
        """Flux of the coil over its ampere-turns, leak A_p/(2 g_r/mu0 + l_fe H/B) [Wb/A].

        The flux density stands in it once, as far as the iron saturates, so that bounds are tight.
        """
        ratio = magnetics.iron_reluctivity(self.densest(flux_density), self.iron_reluctance, self.iron_saturation)
        field = ratio * self.densest(1.0)
        return self.leakage_factor * self.shape.pole_area / engaged_ampere_turns(1.0, self.shape, field)
