"""Magnetic-powder clutch: shear stress of the powder, iron sections, masses and inertias.

A smooth rotor turns inside a drum or body; powder fills the gap between, and the flux of a ring coil outside crosses it
twice, under two cylindrical pole faces. Every function takes floats, arrays or CasADi symbols.

Sources: equation numbers [P..] are those of the notes on centrifugal clutches (S4), section 3.5. The shear curve of
the powder is an unverified engineering calibration: its form follows Chen, Tian et al., Smart Mater. Struct. 22 (2013)
115036 (rises with the field, independent of the slip speed), its figures are chosen so that the powder volume of S4
gives about 75 N m at 80 mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from synth.special import special

from ..mechanics import Quantity, magnetics
from ..mechanics.magnetics import gap_field

IRON_DENSITY = 7870.0  # of solid iron [kg/m3]
# What closes a powder clutch and carries it: proportions of practice, of no source that could be opened.
SHIELD_DENSITY = 2700.0  # light metal [kg/m3]
SHIELD_THICKNESS = 8e-3  # of one shield [m]
SHAFT_ENDS = 60e-3  # what the shaft is longer than the body [m]


def packed_permeability(bulk_density: Quantity) -> Quantity:
    """Relative permeability of packed iron powder, (1 + 2 phi)/(1 - phi), phi = rho_bulk/rho_iron.

    Parameters
    ----------
    bulk_density : scalar, array or symbol
        rho_bulk [kg/m3].

    Returns
    -------
    scalar, array or symbol
        mu_r [-].

    References
    ----------
    Maxwell-Garnett for grains of high permeability; S4 [P2].

    Examples
    --------
    S4: 4.26 at 4.1 g/cm3:

    >>> round(packed_permeability(4100), 2)
    4.26
    """
    filling = bulk_density / IRON_DENSITY
    return (1 + 2 * filling) / (1 - filling)


def shear_stress(flux_density: Quantity, saturation_stress: Quantity, half_flux_density: Quantity) -> Quantity:
    """Shear stress of magnetised powder, tau_sat/(1 + (B_h/B)**2), whatever the slip speed.

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B in the powder [T], above 0.
    saturation_stress : scalar, array or symbol
        tau_sat [Pa].
    half_flux_density : scalar, array or symbol
        B_h, where half of it is reached [T].

    Returns
    -------
    scalar, array or symbol
        tau [Pa].

    References
    ----------
    S4 [P1], unverified calibration.

    Examples
    --------
    S4: 25 kPa at 0.6 T:

    >>> round(shear_stress(0.6, 60e3, 0.7) / 1e3, 1)
    25.4
    """
    return saturation_stress / (1 + (half_flux_density / flux_density) ** 2)


def pole_area(gap_radius: Quantity, pole_length: Quantity) -> Quantity:
    """Area of one cylindrical pole face, 2 pi r_g l_p.

    Parameters
    ----------
    gap_radius : scalar, array or symbol
        r_g, outside of the rotor [m].
    pole_length : scalar, array or symbol
        l_p [m].

    Returns
    -------
    scalar, array or symbol
        A_p [m2].

    References
    ----------
    Geometry; S4 [P4].

    Examples
    --------
    >>> round(float(pole_area(0.08, 0.02)) * 1e4, 1)
    100.5
    """
    return 2 * np.pi * gap_radius * pole_length


def torque(stress: Quantity, gap_radius: Quantity, pole_length: Quantity) -> Quantity:
    """Torque of the powder under two pole faces, tau 2 A_p r_g = 4 pi tau l_p r_g**2.

    Parameters
    ----------
    stress : scalar, array or symbol
        tau [Pa].
    gap_radius : scalar, array or symbol
        r_g [m].
    pole_length : scalar, array or symbol
        l_p of one face [m].

    Returns
    -------
    scalar, array or symbol
        M [N m].

    References
    ----------
    S4 [P5].

    Examples
    --------
    S4: the powder of the source (60 to 100 cm3) gives about 75 N m at 80 mm and 0.6 T; 46 cm3 of it lie under two poles
    of 36.7 mm in a gap of 1.25 mm:

    >>> round(float(torque(shear_stress(0.6, 60e3, 0.7), 0.08, 0.0367)))
    75
    """
    return 4 * np.pi * stress * pole_length * gap_radius**2


def yoke_flux_density(
    leakage_factor: Quantity, line_flux: Quantity, radius_ratio: Quantity, thickness: Quantity
) -> Quantity:
    """Flux density of the yoke outside the coil, leak B A_p/(2 pi r t) = leak B l_p/(t r/r_g).

    Parameters
    ----------
    leakage_factor : scalar, array or symbol
        Flux of the yoke over flux of the working gap [-].
    line_flux : scalar, array or symbol
        Flux per circumference of the gap, B l_p [T m].
    radius_ratio : scalar, array or symbol
        Mean radius of the yoke over that of the gap, r/r_g [-].
    thickness : scalar, array or symbol
        t of the yoke [m].

    Returns
    -------
    scalar, array or symbol
        B_out [T].

    References
    ----------
    Continuity of the flux; S4 [P4].

    Examples
    --------
    By hand, 1.15 x 0.6 x 0.02/(0.008 x 1.4):

    >>> round(float(yoke_flux_density(1.15, 0.6 * 0.02, 1.4, 0.008)), 3)
    1.232
    """
    return leakage_factor * line_flux / (thickness * radius_ratio)


@special((0.0, 1.0), (0.0, 1.0), curvature="log-concave")
def rim_section_width(outer_radius: Quantity, thickness: Quantity) -> Quantity:
    """Section of a rim over its outer circumference, (r**2 - (r - t)**2)/(2 r) = t (1 - t/(2 r)).

    A rim thicker than its radius is a solid cylinder.

    Parameters
    ----------
    outer_radius : scalar, array or symbol
        r [m].
    thickness : scalar, array or symbol
        t [m].

    Returns
    -------
    scalar, array or symbol
        Width [m].

    References
    ----------
    Geometry; the section of the rotor in S4 [P4].

    Examples
    --------
    By hand, (0.08**2 - 0.07**2)/0.16:

    >>> round(float(rim_section_width(0.08, 0.01)) * 1e3, 3)
    9.375
    """
    depth = np.minimum(thickness, outer_radius)
    return depth * (1 - depth / (2 * outer_radius))


def rotor_flux_density(line_flux: Quantity, section_width: Quantity) -> Quantity:
    """Flux density in the rim of the rotor, B A_p/[pi (r_g**2 - (r_g - t)**2)].

    Parameters
    ----------
    line_flux : scalar, array or symbol
        Flux per circumference of the gap, B l_p [T m].
    section_width : scalar, array or symbol
        Of :func:`rim_section_width` [m].

    Returns
    -------
    scalar, array or symbol
        B_in [T].

    References
    ----------
    Continuity of the flux; S4 [P4].

    Examples
    --------
    >>> round(float(rotor_flux_density(0.6 * 0.02, 9.375e-3)), 3)
    1.28
    """
    return line_flux / section_width


def powder_mass(
    bulk_density: Quantity, fill_factor: Quantity, gap_radius: Quantity, gap: Quantity, length: Quantity
) -> Quantity:
    """Mass of the powder, rho_bulk fill pi ((r_g + g)**2 - r_g**2) l.

    Parameters
    ----------
    bulk_density : scalar, array or symbol
        rho_bulk [kg/m3].
    fill_factor : scalar, array or symbol
        Part of the gap that is filled [-].
    gap_radius : scalar, array or symbol
        r_g [m].
    gap : scalar, array or symbol
        g [m].
    length : scalar, array or symbol
        Length of the gap, 2 l_p + l_m [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; S4 [P10].

    Examples
    --------
    >>> round(float(powder_mass(4100, 0.6, 0.08, 1.25e-3, 0.07)), 4)
    0.109
    """
    return bulk_density * fill_factor * np.pi * gap * (2 * gap_radius + gap) * length


def cylinder_mass(density: Quantity, inner_radius: Quantity, thickness: Quantity, length: Quantity) -> Quantity:
    """Mass of a tube, rho pi t (2 r_i + t) l.

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    inner_radius : scalar, array or symbol
        r_i [m].
    thickness : scalar, array or symbol
        t [m]; 0 is no tube.
    length : scalar, array or symbol
        l [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry.

    Examples
    --------
    By hand, 7850 pi (0.09**2 - 0.08**2) 0.07:

    >>> round(float(cylinder_mass(7850, 0.08, 0.01, 0.07)), 4)
    2.9347
    """
    return density * np.pi * thickness * (2 * inner_radius + thickness) * length


def rotor_mass(
    density: Quantity, gap_radius: Quantity, section_width: Quantity, length: Quantity, web_thickness: Quantity
) -> Quantity:
    """Mass of the rotor, a rim of length l with a web inside, without hub and shaft.

    rho pi [(r_g**2 - (r_g - t)**2) l + (r_g - t)**2 t_web].

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    gap_radius : scalar, array or symbol
        r_g, outside of the rim [m].
    section_width : scalar, array or symbol
        Of :func:`rim_section_width` [m].
    length : scalar, array or symbol
        l = 2 l_p + l_m [m].
    web_thickness : scalar, array or symbol
        t_web [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; S4 [P10].

    Examples
    --------
    By hand, 7850 pi ((0.08**2 - 0.07**2) 0.07 + 0.07**2 x 0.008):

    >>> round(float(rotor_mass(7850, 0.08, 9.375e-3, 0.07, 0.008)), 4)
    3.5562
    """
    # The web is a full disc and the rim as much shorter, so that the section stands here once.
    rim = 2 * section_width * (length - web_thickness)
    return density * np.pi * gap_radius * (gap_radius * web_thickness + rim)


def body_mass(
    density: Quantity,
    bore_radius: Quantity,
    coil_height: Quantity,
    coil_length: Quantity,
    thickness: Quantity,
    length: Quantity,
) -> Quantity:
    """Mass of the iron around the coil: a yoke tube of full length and two pole rings with their flanges.

    rho pi [t (2 r_s + 2 h_c + t) L + h_c (2 r_s + h_c) (L - l_m)], which is rho [pi (R**2 - r_s**2) L - 2 pi r_c A_w].

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    bore_radius : scalar, array or symbol
        r_s [m].
    coil_height, coil_length : scalar, array or symbol
        Window of the coil h_c, l_m [m].
    thickness : scalar, array or symbol
        Yoke t_y [m].
    length : scalar, array or symbol
        L = 2 l_p + l_m + 2 t_y [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; S4 [P10].

    Examples
    --------
    By hand, 7850 [pi (0.12**2 - 0.08**2) 0.09 - 2 pi 0.095 x 0.03 x 0.03]:

    >>> round(float(body_mass(7850, 0.08, 0.03, 0.03, 0.01, 0.09)), 3)
    13.539
    """
    tube = cylinder_mass(density, bore_radius + coil_height, thickness, length)
    return tube + cylinder_mass(density, bore_radius, coil_height, length - coil_length)


def ring_inertia(mass: Quantity, outer_radius: Quantity, inner_radius: Quantity) -> Quantity:
    """Moment of inertia of a ring, m (r_o**2 + r_i**2)/2.

    Parameters
    ----------
    mass : scalar, array or symbol
        m [kg].
    outer_radius, inner_radius : scalar, array or symbol
        r_o, r_i [m].

    Returns
    -------
    scalar, array or symbol
        J [kg m2].

    References
    ----------
    Geometry; S4 [P10].

    Examples
    --------
    >>> round(ring_inertia(2.0, 0.09, 0.08), 4)
    0.0145
    """
    return mass * (outer_radius**2 + inner_radius**2) / 2


def shields_mass(outer_radius: Quantity) -> Quantity:
    """Mass of both bearing shields, 2 x 2700 kg/m3 pi R**2 x 8 mm.

    Parameters
    ----------
    outer_radius : scalar, array or symbol
        R of the body [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; light metal and thickness are engineering practice.

    Examples
    --------
    By hand, 43.2 kg/m2 x pi 0.1**2:

    >>> round(float(shields_mass(0.1)), 4)
    1.3572
    """
    return 2 * SHIELD_DENSITY * np.pi * SHIELD_THICKNESS * outer_radius**2


def shaft_mass(density: Quantity, radius: Quantity, length: Quantity) -> Quantity:
    """Mass of the shaft, rho pi r**2 (L + 60 mm).

    Parameters
    ----------
    density : scalar, array or symbol
        rho [kg/m3].
    radius : scalar, array or symbol
        r of the shaft [m].
    length : scalar, array or symbol
        L of the body [m].

    Returns
    -------
    scalar, array or symbol
        Mass [kg].

    References
    ----------
    Geometry; the ends are engineering practice.

    Examples
    --------
    By hand, 7850 pi 0.012**2 x 0.2:

    >>> round(float(shaft_mass(7850, 0.012, 0.14)), 4)
    0.7103
    """
    return density * np.pi * radius**2 * (length + SHAFT_ENDS)


@dataclass(frozen=True)
class Layout:
    """Dimensions of a powder clutch; with a rotating coil ``drum`` and ``air_gap`` are 0 [m]."""

    gap_radius: Quantity
    pole_length: Quantity
    gap: Quantity
    coil_length: Quantity
    coil_height: Quantity
    thickness: Quantity
    drum: Quantity
    air_gap: Quantity

    @property
    def face_length(self) -> Quantity:
        """Length of rotor and powder gap, 2 l_p + l_m [m]."""
        return 2 * self.pole_length + self.coil_length

    @property
    def length(self) -> Quantity:
        """Length of the body L = 2 l_p + l_m + 2 t_y [m]."""
        return self.face_length + 2 * self.thickness

    @property
    def drum_radius(self) -> Quantity:
        """Outside of the drum r_d; of the powder where the coil rotates [m]."""
        return self.gap_radius + self.gap + self.drum

    @property
    def bore(self) -> Quantity:
        """Bore of the body r_s [m]."""
        return self.drum_radius + self.air_gap

    @property
    def coil_radius(self) -> Quantity:
        """Mean radius of the coil r_c [m]."""
        return self.bore + self.coil_height / 2

    @property
    def yoke_ratio(self) -> Quantity:
        """Mean radius of the yoke over that of the powder gap [-]."""
        outside = self.gap + self.drum + self.air_gap + self.coil_height + self.thickness / 2
        return 1 + outside / self.gap_radius

    @property
    def outer_radius(self) -> Quantity:
        """Outside R_out [m]."""
        return self.bore + self.coil_height + self.thickness

    @property
    def iron_path(self) -> Quantity:
        """Mean length of the flux in iron l_fe = 2 (h_c + t_y) + 2 (l_m + l_p) [m]."""
        return 2 * (self.coil_height + self.thickness + self.coil_length + self.pole_length)

    @property
    def air_flux_share(self) -> Quantity:
        """Flux density in the air gap over that in the powder, A_p/A_a [-]."""
        return 1 / (1 + (self.gap + self.drum + self.air_gap / 2) / self.gap_radius)


def gap_ampere_turns(relative_permeability: Quantity, layout: Layout) -> tuple[Quantity, Quantity]:
    """Ampere-turns per tesla in the powder of twice the powder and of twice the air gap, 2 g/(mu0 mu_r), 2 g_a k_a/mu0.

    Parameters
    ----------
    relative_permeability : scalar, array or symbol
        mu_r [-] of the powder.
    layout : Layout
        Dimensions.

    Returns
    -------
    tuple
        Both [A/T].

    References
    ----------
    S4 [P4].

    Examples
    --------
    By hand, 2 x 1.25 mm/(mu0 4.26):

    >>> layout = Layout(0.05, 0.02, 1.25e-3, 0.03, 0.02, 0.01, drum=0.0, air_gap=0.0)
    >>> float(gap_ampere_turns(4.26, layout)[0])
    467.0
    """
    powder = 2 * layout.gap * gap_field(1.0, relative_permeability)
    air = 2 * layout.air_gap * layout.air_flux_share * gap_field(1.0)
    return powder, air


def ampere_turns(
    flux_density: Quantity, relative_permeability: Quantity, layout: Layout, iron_field: Quantity
) -> Quantity:
    """Ampere-turns of the circuit: twice the powder, twice the air gap of a stationary coil, and the iron.

    Parameters
    ----------
    flux_density : scalar, array or symbol
        B in the powder [T].
    relative_permeability : scalar, array or symbol
        mu_r of the powder [-].
    layout : Layout
        Dimensions.
    iron_field : scalar, array or symbol
        Field in the densest iron, taken along the whole path [A/m].

    Returns
    -------
    scalar, array or symbol
        NI [A].

    References
    ----------
    S4 [P4].

    Examples
    --------
    S4, section 3.5: 280 A for the powder; 382 A more for two air gaps of 0.4 mm of the same area

    >>> thin = Layout(1e6, 0.02, 1.25e-3, 0.03, 0.03, 0.01, 0.006, 0.4e-3)
    >>> round(float(ampere_turns(0.6, 4.26, thin, 0.0)) - 280.2)
    382
    """
    powder, air = gap_ampere_turns(relative_permeability, layout)
    return flux_density * (powder + air) + iron_field * layout.iron_path


class Iron(NamedTuple):
    """Flux densities of the iron: yoke outside the coil, rim of the rotor, and the larger of both [T]."""

    yoke: Quantity
    rotor: Quantity
    densest: Quantity


@dataclass(frozen=True)
class Circuit:
    """The magnetic circuit of a powder clutch: what a flux density of the powder asks of iron and coil.

    Declaration and curves speak through it of the same iron; all in SI, numbers or symbols. ``rim`` is the width of the
    section of the rotor's rim.
    """

    layout: Layout
    rim: Quantity
    permeability: Quantity
    leakage_factor: Quantity
    iron_reluctance: Quantity
    iron_saturation: Quantity

    def iron(self, flux_density: Quantity) -> Iron:
        """Flux densities of the iron."""
        line_flux = flux_density * self.layout.pole_length
        yoke = yoke_flux_density(self.leakage_factor, line_flux, self.layout.yoke_ratio, self.layout.thickness)
        rotor = rotor_flux_density(line_flux, self.rim)
        return Iron(yoke, rotor, magnetics.larger(yoke, rotor))

    def ampere_turns(self, flux_density: Quantity, densest: Quantity) -> Quantity:
        """Ampere-turns that a flux density needs, with that of the densest iron [A]."""
        field = magnetics.iron_field(densest, self.iron_reluctance, self.iron_saturation)
        return ampere_turns(flux_density, self.permeability, self.layout, field)

    def linkage(self, flux_density: Quantity) -> Quantity:
        """Flux of the coil over its ampere-turns, leak A_p B/NI [Wb/A].

        The flux density stands in it once, as far as the iron saturates, so that bounds are tight.
        """
        densest = self.iron(flux_density).densest
        ratio = magnetics.iron_reluctivity(densest, self.iron_reluctance, self.iron_saturation)
        turned = ampere_turns(1.0, self.permeability, self.layout, ratio * self.iron(1.0).densest)
        return self.leakage_factor * pole_area(self.layout.gap_radius, self.layout.pole_length) / turned
