"""The pack of a multi-plate clutch: many rings in a drum, with friction in the plate guides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Declaration

from ...duty import cooling
from ...friction.duty import DutyOfPlates, Size
from ...friction.engagement import (
    Startup,
    Torques,
    advise_frequent_switching,
    declare_heated_body,
    declare_startup,
    declare_torque,
    mean_rise,
    peak_rise,
)
from ...mechanics import guide_friction
from ...mechanics import plates as plate_formulas
from ...mechanics import ring as ring_formulas
from ...sources import S0, S1
from ..lining.model import Pair, declare_surface_loads
from ..ring.model import RING_OUTER_DIAMETER_MAX, Ring
from .requirements import MadePackOptions, PackOptions, PackRequirements


@dataclass(frozen=True)
class ReleaseAid:
    """What a release aid takes of the force and leaves of area and drag; 0, 1, 1 without one."""

    force_fraction: Any = 0.0
    area_factor: Any = 1.0
    drag_factor: Any = 1.0


@dataclass(frozen=True)
class Plates:
    """Inner and outer plates with their splines: made to the sizes that the search finds, or of a list.

    ``lug_clearance`` is from the ring to the mean radius of the lugs, None where a list tells both;
    ``lining_thickness`` is that of the plates, None where they take the lining as its row has it.
    """

    inner_thickness: Any
    outer_thickness: Any
    inner_spline_radius: Any
    outer_spline_radius: Any
    inner_mean_diameter: Any
    inner_width: Any
    outer_mean_diameter: Any
    outer_width: Any
    spline_mean_diameter: Any
    spline_width: Any
    inner_lug_count: Any
    inner_lug_height: Any
    outer_lug_count: Any
    outer_lug_height: Any
    lug_clearance: Any = None
    lining_thickness: Any = None


@dataclass(frozen=True)
class Pack:
    """The plates of a multi-plate pack, how many surfaces they have and how far they stand apart."""

    surfaces: Any
    plates: Plates
    inner_thickness: Any
    outer_thickness: Any
    inner_spline_radius: Any
    outer_spline_radius: Any
    gap: Any
    aid: ReleaseAid


@dataclass(frozen=True)
class PackTorque:
    """Torque and pressure of a pack under an actuation force, and the sources of their formulas."""

    force: Any
    low: Any
    high: Any
    pressure: Any
    source: str
    pressure_source: str


@dataclass(frozen=True)
class PackSize(Size):
    """Mass, size and heat capacity of a pack; the masses of all plates of a kind and of all linings."""

    heat_capacity: Any
    cooled_area: Any
    inner_mass: Any
    outer_mass: Any
    lining_mass: Any


@dataclass(frozen=True)
class Stack:
    """A pack and its lining, with what they are declared for."""

    duty: DutyOfPlates
    options: PackOptions
    wants: PackRequirements
    ring: Ring
    pair: Pair
    pack: Pack


@dataclass(frozen=True)
class BuiltPack(Stack):
    """A pack whose torque and start are declared; ``area`` is that of all friction surfaces [m2]."""

    force: Any
    area: Any
    start: Startup
    size: PackSize

    def mean_rise(self, work: Any, rate: Any) -> Any:
        """Mean rise of the pack heated by a work [J] at a rate [1/s]; [K]."""
        size = self.size
        return mean_rise(self.duty, work, rate, capacity=size.heat_capacity, cooled_area=size.cooled_area)


def declare_lubrication(d: Declaration) -> str:
    """Declare the option lubrication; it comes first, because defaults of others depend on it."""
    return d.option(
        "lubrication",
        ("oil", "dry"),
        "oil",
        symbol="lub",
        text="Condition on the friction pair; sets the defaults of oil viscosity and cooling",
        source=f"{S0}, plates in oil",
        group="duty",
    )


def declare_pack_requirements(
    d: Declaration, *, duty: DutyOfPlates, lubrication: str, kind: type[PackRequirements]
) -> PackRequirements:
    """Declare the requirements of a multi-plate pack and the refusals that concern them alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : DutyOfPlates
        Block duty.
    lubrication : str
        dry or oil.
    kind : subclass of PackRequirements
        The block to declare.

    Returns
    -------
    PackRequirements
        Symbols of the block.
    """
    oil = lubrication == "oil"
    pack = d.block(kind, oil_viscosity=0.02 if oil else 0.0, **kind.defaults(duty, oil=oil))
    if duty.guide_model == "series" and duty.surface_factor is not None:
        d.refuse(
            "double_guide_loss",
            duty.surface_factor < 1,
            "no surface_factor below 1 with guide_model series, which computes the friction in the guides itself; "
            "leave surface_factor out or choose guide_model cz",
        )
    if lubrication == "dry":
        d.refuse("lubrication_mismatch", pack.oil_viscosity > 0, "an oil_viscosity of 0 with lubrication dry")
    else:
        d.refuse("lubrication_mismatch", pack.oil_viscosity <= 0, "an oil_viscosity above 0 with lubrication oil")
    return pack


def made_plates(d: Declaration, *, options: PackOptions, wants: PackRequirements, ring: Ring) -> Plates:
    """Declare plates that are made to size around their ring.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : PackOptions
        Options of the pack; only those of made plates tell where the inner spline comes from.
    wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.

    Returns
    -------
    Plates
        Cores from core_plates, lugs at lug_clearance from the ring.
    """
    lugs = d.block(wants.lugs)
    lug = lugs.lug_clearance
    inner_plate = d.part(
        "inner_plate", "core_plates", symbol="ip", text="Steel core of the inner plates", source="table core_plates"
    )
    outer_plate = d.part(
        "outer_plate",
        "core_plates",
        symbol="op",
        text="Steel core of the outer plates, lined on both sides",
        source="table core_plates",
    )
    if isinstance(options, MadePackOptions) and options.spline_choice == "catalogue":
        spline = d.part(
            "inner_spline", "splines", symbol="is", text="Spline of the inner plates", source="table splines"
        )
        inner_spline_radius = spline.mean_flank_diameter / 2
        inner_mean_diameter = ring.outer_radius + inner_spline_radius
        inner_width = ring.outer_radius - inner_spline_radius
        lug_count, lug_height = spline.teeth, spline.flank_height_h
        d.at_least(
            "spline_clearance",
            ring.inner_radius - inner_spline_radius,
            lug,
            "mm",
            text="The spline stays clear of the friction ring",
            source=f"{S0}, a < r1",
        )
    else:
        inner_spline_radius = ring.inner_radius - lug
        inner_mean_diameter = ring.mean_diameter - lug
        inner_width = ring.width + lug
        lug_count, lug_height = lugs.sizes(ring, wants)
    outer_lug_count, outer_lug_height = lugs.sizes(ring, wants)
    return Plates(
        inner_thickness=inner_plate.thickness,
        outer_thickness=outer_plate.thickness,
        inner_spline_radius=inner_spline_radius,
        outer_spline_radius=ring.outer_radius + lug,
        inner_mean_diameter=inner_mean_diameter,
        inner_width=inner_width,
        outer_mean_diameter=ring.mean_diameter + lug,
        outer_width=ring.width + lug,
        spline_mean_diameter=inner_mean_diameter + lug,
        spline_width=inner_width + lug,
        inner_lug_count=lug_count,
        inner_lug_height=lug_height,
        outer_lug_count=outer_lug_count,
        outer_lug_height=outer_lug_height,
        lug_clearance=lug,
    )


def declare_pack(
    d: Declaration,
    *,
    duty: DutyOfPlates,
    options: PackOptions,
    wants: PackRequirements,
    ring: Ring,
    plates: Plates | None = None,
) -> Pack:
    """Declare a pack: how many surfaces, of which plates, how far apart.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : DutyOfPlates
        Block duty.
    options : PackOptions
        Options of the pack.
    wants : PackRequirements
        Requirements of the pack.
    ring : Ring
        Block ring.
    plates : Plates, optional
        Plates of a list; without them plates are made to size.

    Returns
    -------
    Pack
        The pack.
    """
    surfaces = d.count(
        "friction_surfaces",
        2,
        60,
        step=2,
        symbol="z",
        text="Friction surface pairs; even, because both end plates are inner plates",
        source=f"{S0}, x; {S1}, z",
    )
    if plates is None:
        plates = made_plates(d, options=options, wants=wants, ring=ring)
    aid_row = None if options.release_aid == "none" else d.row("release_aids", options.release_aid)
    d.derive(
        "outer_plates",
        "-",
        ring_formulas.outer_plate_count(surfaces),
        symbol="z_k",
        text="Outer plates",
        source=f"{S1}, z_k",
    )
    d.derive(
        "inner_plates",
        "-",
        ring_formulas.inner_plate_count(surfaces),
        symbol="z_b",
        text="Inner plates",
        source=f"{S1}, z_b = z_k + 1",
    )
    pack = Pack(
        surfaces=surfaces,
        plates=plates,
        inner_thickness=plates.inner_thickness,
        outer_thickness=plates.outer_thickness,
        inner_spline_radius=d.derive(
            "inner_spline_radius",
            "mm",
            plates.inner_spline_radius,
            symbol="a",
            text="Mean spline radius of the inner plates",
            source=f"{S0}, a",
        ),
        outer_spline_radius=d.derive(
            "outer_spline_radius",
            "mm",
            plates.outer_spline_radius,
            symbol="b",
            text="Mean spline radius of the outer plates",
            source=f"{S0}, b",
        ),
        gap=wants.gap(duty, ring),
        aid=ReleaseAid()
        if aid_row is None
        else ReleaseAid(aid_row.force_fraction, aid_row.area_factor, aid_row.drag_factor),
    )
    d.step("release_gap", "mm", pack.gap, symbol="g_pl", text="Gap per surface of the released pack", source=S0)
    if wants.hub_bore_diameter is not None:
        d.at_least(
            "hub_bore",
            2 * pack.inner_spline_radius,
            wants.hub_bore_diameter,
            "mm",
            text="The shaft fits inside the plates",
            source="requirement of the drive",
        )
    return pack


def refuse_impossible_pack(d: Declaration, stack: Stack) -> None:
    """Refuse requirements that no design can meet, whatever the unknowns."""
    duty, options, wants, ring, pack = stack.duty, stack.options, stack.wants, stack.ring, stack.pack
    lug = pack.plates.lug_clearance
    if lug is None:
        return  # of plates of a list the sizes are known, and limits tell what is wrong with them
    if wants.hub_bore_diameter is not None and duty.outer_diameter_limit is not None:
        least_inner = wants.hub_bore_diameter + 2 * lug
        least_outer = least_inner * (1 + ring.ratio_min) / (1 - ring.ratio_min)
        d.refuse(
            "no_room_for_ring",
            least_outer + 2 * lug + 2 * wants.drum_wall > duty.outer_diameter_limit,
            "room for a friction ring of at least ring_ratio_min between hub_bore_diameter and "
            "outer_diameter_limit, besides lug_clearance and drum_wall",
        )
    # Series (10) overshoots the saturation by the factor 1 + S, so that nothing can be said beforehand there.
    saturates = duty.guide_model == "series" and options.guide_series != "exponential_K"
    if duty.actuation_force_limit is not None and saturates:
        outer_spline = RING_OUTER_DIAMETER_MAX / 2000 + lug
        if duty.outer_diameter_limit is not None:
            outer_spline = np.minimum(outer_spline, duty.outer_diameter_limit / 2 - wants.drum_wall)
        outer_radius = outer_spline - lug
        inner_spline = outer_radius * (1 - ring.ratio_min) / (1 + ring.ratio_min) - lug
        net_force = duty.actuation_force_limit * (1 - pack.aid.force_fraction)
        d.refuse(
            "torque_above_guide_limit",
            np.logical_and(
                inner_spline > 0,
                duty.required_torque * wants.guide_friction * (inner_spline + outer_spline)
                > net_force * inner_spline * outer_spline,
            ),
            "a sizing torque that the friction in the guides lets pass at actuation_force_limit with the largest "
            "splines that fit; more plates do not help: raise actuation_force_limit or outer_diameter_limit, or "
            "lower guide_friction",
        )


def declare_pack_torque(d: Declaration, stack: Stack, force: Any) -> PackTorque:
    """Declare guide friction and lug pressures of a pack; torque and pressure under an actuation force F0 [N]."""
    options, wants, ring, pair, pack = stack.options, stack.wants, stack.ring, stack.pair, stack.pack
    radius, surfaces = ring.friction_radius, pack.surfaces
    a, b = pack.inner_spline_radius, pack.outer_spline_radius
    series = stack.duty.guide_model == "series"

    def ratios(mu: Any) -> tuple[Any, Any]:
        return (
            guide_friction.guide_ratio(mu, wants.guide_friction, radius, a),
            guide_friction.guide_ratio(mu, wants.guide_friction, radius, b),
        )

    def sum_factor(mu: Any) -> Any:
        return guide_friction.torque_sum_factor(options.guide_series, surfaces, *ratios(mu)) if series else surfaces

    def share(surface: int, mu: Any) -> Any:
        """Return the part of the actuation force that reaches a surface."""
        return guide_friction.contact_force(options.guide_series, 1.0, surface, *ratios(mu)) if series else 1.0

    net_force = force * (1 - pack.aid.force_fraction)
    # M0 = mu r F0 stays one expression for torque and lugs, so that a bound on the torque reaches the lugs.
    moment_low = pair.mu_low * net_force * radius
    moment_high = moment_low if pair.mu_high is pair.mu_low else pair.mu_high * net_force * radius
    d.at_least(
        "guide_jams",
        a,
        pair.mu_high * wants.guide_friction * radius,
        "mm",
        guard=True,
        text="The inner plates slide in their spline and do not jam; their mean spline radius is above 0",
        source=f"{S0}, first phase of engagement",
    )
    inner, outer = ratios(pair.mu_low)
    _name_guides(d, inner=inner, outer=outer, net_force=net_force, moment=moment_low)
    guide_number = sum((inner, outer)) if series else 0.0
    d.derive(
        "guide_number",
        "-",
        guide_number,
        symbol="S",
        needs="guide_jams",
        text="Friction in the guides; 0 with guide model cz",
        source=f"{S0}, eq. (2)",
    )
    factor = d.derive(
        "torque_sum_factor",
        "-",
        sum_factor(pair.mu_low),
        symbol="E",
        needs="guide_jams",
        text="Torque of the pack over that of one surface without guide friction",
        source=f"{S0}, eq. (5)",
    )
    factor_high = factor if pair.mu_high is pair.mu_low else sum_factor(pair.mu_high)
    effectiveness = d.derive(
        "plate_effectiveness",
        "-",
        factor_high / surfaces,
        symbol="eta_z",
        needs="guide_jams",
        text="Torque of the pack over that without guide friction (worst case: greatest friction)",
        source=f"{S0}, eq. (16)",
    )
    if series:
        d.at_least(
            "plate_count_worthwhile",
            effectiveness,
            wants.plate_effectiveness_min,
            "-",
            text="Adding plates is still worth while",
            source=f"{S0}, eq. (16)",
        )
        d.advise(
            "beyond_legacy_plate_limit",
            surfaces > guide_friction.legacy_plate_limit(guide_number),
            "more friction surfaces than the rule sqrt(2)/K of eq. (15) allows; plate count worthwhile (16) decides",
            source=f"{S0}, eq. (15)",
        )
    else:
        d.advise(
            "surface_factor_fits_ten_surfaces",
            np.logical_or(surfaces < 10, surfaces > 10),
            "surface factor was taken for a pack that may have another number of surfaces: 0.75 belongs to ten; "
            "guide model series computes the loss for any number",
            source=f"{S1}, c_z",
        )
    shares = [share(j, pair.mu_high) for j in (1, 2, 3)]
    if pair.mu_high is not pair.mu_low:
        _name_greatest(d, guides=sum(ratios(pair.mu_high)), moment=moment_high)
    if series:
        _name_shares(d, options=options, guides=inner + outer, shares=shares)
    _declare_lugs(d, wants=wants, pack=pack, moment=moment_high, shares=shares)
    return PackTorque(
        force=force,
        low=moment_low * factor,
        high=moment_high * factor_high,
        pressure=net_force * share(1, pair.mu_low) / (pack.aid.area_factor * ring.area),
        source=f"{S0}, eq. (5)" if series else f"{S1}, sizing",
        pressure_source=f"{S0}, eq. (3)" if series else f"{S1}, p",
    )


def declare_pack_torques(
    d: Declaration, stack: Stack, *, force: Any, needs: tuple[str, ...] = ()
) -> tuple[PackTorque, Torques]:
    """Refuse a pack that cannot be, declare what it carries under an actuation force, and that it carries its load.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    stack : Stack
        What is asked, and what it is made of.
    force : symbol
        Actuation force [N].
    needs : tuple of str
        Guards beside that of the guides without which the torque does not exist.
    """
    refuse_impossible_pack(d, stack)
    torque = declare_pack_torque(d, stack, force)
    torques = declare_torque(
        d,
        duty=stack.duty,
        pair=stack.pair,
        torque_low=torque.low,
        torque_high=torque.high,
        source=torque.source,
        needs=("guide_jams", *needs),
    )
    return torque, torques


def declare_pack_start(
    d: Declaration, stack: Stack, *, torque: PackTorque, torques: Torques, ramp_time: Any
) -> BuiltPack:
    """Declare a start with a pack and what it does to the surfaces."""
    ring, pack = stack.ring, stack.pack
    start = declare_startup(d, duty=stack.duty, torques=torques, ramp_time=ramp_time)
    area = pack.surfaces * ring.area
    declare_surface_loads(
        d,
        duty=stack.duty,
        pair=stack.pair,
        start=start,
        area=area,
        rubbing_area=pack.aid.area_factor * area,
        pressure=torque.pressure,
        pressure_source=torque.pressure_source,
        rubbing_radius=ring.outer_radius,
        narrowing=ring.ratio,
    )
    return BuiltPack(**vars(stack), force=torque.force, area=area, start=start, size=pack_size(stack))


def _name_guides(d: Declaration, *, inner: Any, outer: Any, net_force: Any, moment: Any) -> None:
    """Name what the curves of a pack show of its guides, whatever guide_model sizes it."""
    d.step("inner_guide_ratio", "-", inner, symbol="S_i", text="Friction of the inner plates in their guide", source=S0)
    d.step("outer_guide_ratio", "-", outer, symbol="S_o", text="Friction of the outer plates in their guide", source=S0)
    d.step("net_force", "N", net_force, symbol="F_net", text="Actuation force that a release aid leaves", source=S0)
    d.step(
        "surface_moment",
        "N*m",
        moment,
        symbol="M_0",
        text="Torque of one surface without guide friction",
        source=f"{S0}, M0",
    )
    total = inner + outer
    d.step(
        "torque_bound",
        "N*m",
        moment / total,
        symbol="M_bound",
        text="Torque that no number of plates reaches",
        source=f"{S0}, eq. (5)",
    )
    # (14) and (16) are roots that only numbers have; the curve asks for them with the S named here.
    d.step(
        "surfaces_legacy",
        "-",
        guide_friction.legacy_plate_limit(total),
        symbol="z_15",
        text="Friction surfaces that are still worth while by (15)",
        source=f"{S0}, eq. (15)",
    )


def _name_greatest(d: Declaration, *, guides: Any, moment: Any) -> None:
    """Name what loads the lugs where the friction that is feared is another than the one that is counted on."""
    d.step(
        "greatest_guide_number",
        "-",
        guides,
        symbol="S_max",
        text="Friction in the guides, with the greatest friction",
        source=f"{S0}, eq. (2)",
    )
    d.step(
        "greatest_surface_moment",
        "N*m",
        moment,
        symbol="M_0_max",
        text="Torque of one surface without guide friction, with the greatest friction",
        source=f"{S0}, M0",
    )


def _name_shares(d: Declaration, *, options: PackOptions, guides: Any, shares: Sequence[Any]) -> None:
    """Name the shares of the actuation force that reach the first surfaces, with the sum S of the guides."""
    if options.guide_series == "exponential_K":
        d.step(
            "damped_guide_number",
            "-",
            guide_friction.guarded_damping(guides),
            symbol="K",
            text="Constant of the continuous pack, S/(1 + S)",
            source=f"{S0}, eq. (10)",
        )
    for surface, part in enumerate(shares, start=1):
        d.step(
            f"force_share_{surface}",
            "-",
            part,
            symbol=f"f_{surface}",
            text=f"Share of the actuation force that reaches surface {surface} (worst case: greatest friction)",
            source=f"{S0}",
        )


def _declare_lugs(d: Declaration, *, wants: PackRequirements, pack: Pack, moment: Any, shares: Sequence[Any]) -> None:
    """Declare the lug pressures; ``moment`` is mu r F0 and ``shares`` the parts of F0 on surfaces 1, 2 and 3."""
    first, second, third = shares
    outer_torque = moment * (first + second)
    # With two surfaces both inner plates are end plates, and the first is loaded by surface 1 alone.
    inner_torque = moment * np.where(pack.surfaces > 2, second + third, first)
    outer = d.derive(
        "lug_pressure_outer",
        "N/mm2",
        plate_formulas.lug_pressure(
            outer_torque,
            pack.outer_spline_radius,
            pack.plates.outer_lug_count,
            pack.plates.outer_lug_height,
            pack.outer_thickness,
        ),
        symbol="p_lo",
        needs="guide_jams",
        text="Pressure of the lugs of the first outer plate (worst case: greatest friction)",
        source=f"{S0}, plate thickness; derived",
    )
    inner = d.derive(
        "lug_pressure_inner",
        "N/mm2",
        plate_formulas.lug_pressure(
            inner_torque,
            pack.inner_spline_radius,
            pack.plates.inner_lug_count,
            pack.plates.inner_lug_height,
            pack.inner_thickness,
        ),
        symbol="p_li",
        needs="guide_jams",
        text="Pressure of the lugs of the first inner plate between two surfaces (worst case: greatest friction)",
        source=f"{S0}, plate thickness; derived",
    )
    rule = f"{S0}: the lugs must not bite into the spline groove"
    d.at_most(
        "lug_pressure_outer",
        outer,
        wants.lug_pressure_limit,
        "N/mm2",
        text="The lugs of the outer plates do not bite into the drum",
        source=rule,
    )
    d.at_most(
        "lug_pressure_inner",
        inner,
        wants.lug_pressure_limit,
        "N/mm2",
        text="The lugs of the inner plates do not bite into the hub",
        source=rule,
    )
    hard = d.constant(
        "lug_pressure_hard",
        "N/mm2",
        25,
        symbol="p_hard",
        text="Pressure of lugs above which the groove flanks must be hardened",
        source=f"{S0}, thin plates need hard grooves",
    )
    d.advise(
        "thin_plates",
        np.logical_or(outer > hard, inner > hard),
        "thin plates load the spline flanks above 25 N/mm2: the groove flanks must be hardened",
        source=f"{S0}, thin plates need hard grooves",
    )


def declare_drag(d: Declaration, built: BuiltPack) -> None:
    """Declare the drag of the released pack and its limit."""
    wants, ring, pack = built.wants, built.ring, built.pack
    drag = d.derive(
        "drag_torque",
        "N*m",
        pack.aid.drag_factor
        * plate_formulas.drag_torque(
            pack.surfaces,
            wants.oil_viscosity,
            wants.released_speed(built.duty),
            ring.mean_diameter,
            ring.ratio,
            pack.gap,
        ),
        symbol="T_drag",
        text="Drag of the released clutch with full oil films; 0 when dry",
        source=f"laminar shear; {S0}, after-running",
    )
    if wants.drag_torque_limit is not None:
        d.at_most(
            "drag_torque",
            drag,
            wants.drag_torque_limit,
            "N*m",
            text="The released clutch does not run after",
            source=f"{S0}, after-running",
        )


def pack_size(stack: Stack) -> PackSize:
    """Mass, size and heat capacity of a pack."""
    duty, ring, pair, pack = stack.duty, stack.ring, stack.pair, stack.pack
    z, plates = pack.surfaces, pack.plates
    lining = pair.part.lining_thickness if plates.lining_thickness is None else plates.lining_thickness
    inner = plate_formulas.annulus_mass(
        duty.steel_density,
        ring_formulas.inner_plate_count(z),
        pack.inner_thickness,
        plates.inner_mean_diameter,
        plates.inner_width,
    )
    outer = plate_formulas.annulus_mass(
        duty.steel_density,
        ring_formulas.outer_plate_count(z),
        pack.outer_thickness,
        plates.outer_mean_diameter,
        plates.outer_width,
    )
    steel = inner + outer
    linings = plate_formulas.lining_mass(pair.part.density, lining, z * ring.area)
    diameter = plate_formulas.drum_diameter(pack.outer_spline_radius, stack.wants.drum_wall)
    length = plate_formulas.pack_length(z, pack.inner_thickness, pack.outer_thickness, lining, pack.gap)
    return PackSize(
        mass=steel + linings,
        diameter=diameter,
        length=length,
        heat_capacity=steel * duty.steel_specific_heat,
        cooled_area=cooling.effective(duty.declaration, plate_formulas.cylinder_surface(diameter, length)),
        inner_mass=inner,
        outer_mass=outer,
        lining_mass=linings,
    )


def declare_pack_temperature(d: Declaration, built: BuiltPack) -> None:
    """Declare the peak temperature of a pack and its limit."""
    duty, pair, start, size = built.duty, built.pair, built.start, built.size
    for name, value, symbol, text in (
        ("inner_plate_mass", size.inner_mass, "m_ip", "All inner plates"),
        ("outer_plate_mass", size.outer_mass, "m_op", "Cores of all outer plates"),
        ("lining_mass", size.lining_mass, "m_lin", "All linings"),
    ):
        d.step(name, "kg", value, symbol=symbol, text=text, source="geometry")
    declare_heated_body(d, heat_capacity=size.heat_capacity, cooled_area=size.cooled_area, body="The steel plates")
    rise = d.derive(
        "peak_temperature_rise",
        "K",
        peak_rise(duty, start.friction_work, capacity=size.heat_capacity, cooled_area=size.cooled_area),
        symbol="dT_pk",
        text=f"Steel plates over ambient just after an engagement, {duty.repetition}",
        source=f"lumped heat balance; {S1}, repeated switching",
    )
    d.at_most(
        "peak_temperature",
        rise,
        pair.linings.peak_temperature(pair.part, pair.part.temp_max) - duty.ambient_temperature,
        "K",
        text="The lining stands the temperature",
        source="Neale, Tribology Handbook, Table 7.4",
    )
    advise_frequent_switching(d, duty=duty, heat_capacity=size.heat_capacity, cooled_area=size.cooled_area)


def advise_mean_temperature(d: Declaration, built: BuiltPack) -> None:
    """Remark a mean temperature above what the lining stands continuously."""
    duty = built.duty
    d.advise(
        "mean_temperature",
        built.mean_rise(built.start.friction_work, duty.engagements_per_hour)
        > built.pair.part.optional("temp_continuous") - duty.ambient_temperature,
        "the mean temperature of the pack is above what the lining stands continuously; choose a stronger cooling",
        source="Neale, Tribology Handbook, Table 7.4",
    )


def declare_pack_remarks(d: Declaration, *, options: PackOptions, lubrication: str) -> None:
    """Declare the remarks that depend on options only."""
    if options.shaft_position == "vertical":
        d.advise(
            "vertical_shaft",
            True,
            "on a vertical shaft the plates sink on each other by their weight: every plate needs a stop of its own "
            "(stepped rings on the shaft, inserts in the drum, lift springs)",
            source=f"{S0}, vertical shafts",
        )
    if lubrication == "oil" and options.release_aid == "none":
        d.advise(
            "no_release_aid",
            True,
            "without a release aid oil adhesion drags the plates along after release; drag torque is for plates "
            "that stand apart by plate gap",
            source=f"{S0}, after-running",
        )
    if options.release_aid == "sine_plates":
        d.advise(
            "release_aid_sine_plates",
            True,
            "waved plates touch on small areas when released and cannot stand fully apart; part of the force flattens "
            "them",
            source=f"{S0}, release of the plates",
        )
    if options.release_aid == "wavy_rings":
        d.advise(
            "release_aid_wavy_rings",
            True,
            "rings between neighbouring inner plates surely separate half the plates; they cost friction surface",
            source=f"{S0}, release of the plates",
        )
    if options.release_aid == "cone_springs":
        d.advise(
            "release_aid_cone_springs",
            True,
            "conical springs in the spline grooves need room in the grooves",
            source=f"{S0}, release of the plates",
        )
