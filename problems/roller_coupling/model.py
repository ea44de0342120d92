"""Roller coupling: a float with two crossing guides in which the rollers of two arms roll."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Block, Declaration, Option, Requirement

from .. import practice
from ..duty import WORDS, Drive, coverage, of_drive, refuse_contradictions
from ..mechanics import contact as hertz
from ..sources import DRIVE, EXTENDS_S3, ISO_76, JOHNSON, S3, SHAFT, TYPICAL
from . import body as coupling_body
from . import curves, formulas
from .body import ARM_RADIUS_MAX, ARM_RADIUS_MIN, CONTACT_LENGTH_MIN, Sizes, Unknowns
from .layers import LAYERS, Built, Sources

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing

ELLIPSE = "Hamrock and Brewe (1983)"
# Remarks only: below this modulus a float material counts as plastic, and above this pressure plastic creeps [Pa].
PLASTIC_MODULUS, PLASTIC_PRESSURE = 20e9, 100e6
# Remark only: from this amplitude of the roller's turning on, its rating life is worth a calculation [rad].
LONG_OSCILLATION = 0.5

# What the source says of the two predecessors (chapter X); what it does not say is said to be missing or assumed.
DEFAULT_CONTACT = {"track": "crowned", "any": "either"}  # by roller_kind; line where rules of practice do not count
# Where both treads count, a row goes by its own; spherical bearings roll in a housing, not in a guide.
CONTACT_ROWS = {
    "line": ("crowned == 0", "kind != 'spherical_roller_bearing'"),
    "crowned": ("crowned == 1",),
    "either": ("kind != 'spherical_roller_bearing'",),
}
GUIDES = {
    "roller": "rollers in the guides of the float; the only guide that the source gives formulas for",
    "piston": (
        "piston guide: two pairs of pistons turn and slide in two crossing bores of the float, the pins of the arms "
        "engage the bores of the pistons. Stated: it tolerates mounting inaccuracy; its drawback is sliding friction, "
        "the pistons need lubrication of their own; it was used on several machines, in 1954 a 51 hp diesel at "
        "1500/min with a generator on one concrete base shook 100 um at the engine and 10 um at the generator. Not "
        "stated: coefficient of friction and largest offset. Assumed: it moves as the roller coupling does, so that "
        "the pistons slide 4 times the offset per turn"
    ),
    "linkage": (
        "linkage guide: the arms hang on a frame by equal links (parallelograms) with turning joints. Stated: angle "
        "and, with turning joints at both ends, axial shift are free; all in one plane, short, no tilting moment, pure "
        "torque; one sample ran day and night in a mill from spring 1956 at about 30 mkp (294 N*m) and 10 mm set "
        "offset, its wear was never inspected. Not stated: friction, lubrication and largest offset. Assumed: its "
        "joints need grease as any pin joint"
    ),
}


class Options(Block):
    """Options of the coupling; the default of the contact goes by the kind of rollers."""

    group = "model"

    guide = Option(
        tuple(GUIDES),
        "roller",
        symbol="gd",
        text="How the arms are joined to the float: by rollers, or as in the predecessors that the source "
        "describes (advice only, they are not sized)",
        source=f"{S3}, chapters X and XI",
    )
    sideways_removable = Option(
        ("no", "yes"),
        "no",
        symbol="sw",
        text="yes: an arm can be pulled out sideways through the other guide, shafts staying in place",
        source=f"{S3}, eq. (21)",
        group="duty",
    )
    roller_contact = Option(
        tuple(CONTACT_ROWS),
        "line",
        symbol="rc",
        text="line: cylindrical outer ring; crowned: track rollers with a crowned tread, point contact; either: "
        "both, each row by its own tread",
        source=f"{S3}, XIV.3",
    )


class Wants(Drive):
    """Requirements, all in SI; None where an optional one is not given."""

    group = "model"

    driver_speed = replace(
        Drive.driver_speed, lower=0, symbol="omega", text="Speed of the driving shaft", source=f"{S3}, n", group="duty"
    )
    required_torque = replace(
        Drive.required_torque, symbol="M", text="Torque to transmit", source=f"{S3}, M", group="duty"
    )
    offset = Requirement(
        "mm",
        lower=0,
        upper=200,
        symbol="e",
        text="Parallel offset of the shafts; of skew shafts the length of their common normal",
        source=f"{S3}, e",
        group="duty",
    )
    shaft_angle = Requirement(
        "deg",
        0,
        lower=0,
        upper=10,
        symbol="alpha",
        text="Angle between the shafts; the source's example has 2.5 degrees, beyond 10 the tilt of the rollers in "
        "the guides would have to be modelled",
        source=f"{S3}, chapter XII",
        group="duty",
    )
    float_distance = Requirement(
        "mm",
        0,
        lower=0,
        upper=10000,
        symbol="h",
        text="Distance of the float plane from the intersection or the common normal of the shafts",
        source=f"{S3}, chapter XII, h",
        group="duty",
    )
    outer_diameter_limit = of_drive("mm", 20, 5000, "D_max", "Largest diameter that the float sweeps", group="envelope")
    mass_limit = of_drive("kg", 0.01, 1e5, "mass_max", "Largest mass", group="envelope")
    vibration_limit = of_drive(
        "N", 1e-3, 1e9, "vib_max", "Largest amplitude of the force on each shaft at twice the speed", group="duty"
    )
    guide_angle = Requirement(
        "deg",
        90,
        lower=60,
        upper=90,
        symbol="chi",
        text="Acute angle between the guides; forces are checked down to 60 degrees",
        source=f"{S3}, chapter XI; forces: {EXTENDS_S3}",
    )
    roller_gap_min = Requirement(
        "mm",
        2,
        lower=0.01,
        upper=50,
        symbol="s_min",
        text="Least gap between neighbouring rollers",
        source=f"{S3}, s in eq. (18a)",
    )
    run_in_min = Requirement(
        "mm",
        3,
        lower=0.01,
        upper=50,
        symbol="s1_min",
        text="Least distance of a roller from the mouth of the crossing guide",
        source=f"{S3}, s1",
    )
    run_out_min = Requirement(
        "mm",
        3,
        lower=0.01,
        upper=50,
        symbol="s2_min",
        text="Least distance of a roller centre from the end of its guide",
        source=f"{S3}, s2 in eq. (19a)",
    )
    removal_min = Requirement(
        "mm",
        2,
        lower=0.01,
        upper=50,
        symbol="s3_min",
        text="Least clearance for pulling apart; counts with sideways removable yes",
        source=f"{S3}, s3 in eq. (21)",
        group="duty",
    )
    pin_gap = Requirement(
        "mm", 2, lower=0, upper=50, symbol="g_pin", text=f"Gap between arm face and roller ({TYPICAL})", source=TYPICAL
    )
    axial_play = Requirement(
        "mm",
        0.5,
        lower=0,
        upper=20,
        symbol="g_ax",
        text=f"The guide is wider than the contact by this, each side ({TYPICAL})",
        source=TYPICAL,
        group="duty",
    )
    rim_min = Requirement(
        "mm",
        3,
        lower=0.5,
        upper=100,
        symbol="t_min",
        text=f"Least rim of the float at the guide ends ({TYPICAL})",
        source=TYPICAL,
    )
    pin_shear_limit = Requirement(
        "N/mm2",
        40,
        lower=1,
        upper=1000,
        symbol="sigma_c",
        text="Allowed stress of the pins, twice the shear stress",
        source=f"{S3}, eq. (16), 400 kp/cm2",
        group="material",
    )
    pin_stress_limit = Requirement(
        "N/mm2",
        160,
        lower=1,
        upper=2000,
        symbol="sigma_pin",
        text=f"Allowed equivalent stress of the pins in bending ({TYPICAL})",
        source=TYPICAL,
        group="material",
    )
    static_safety = Requirement(
        "-", 1.0, lower=0.5, upper=10, symbol="S_0", text="Static safety of the rolling bearings", source="ISO 76, s0"
    )
    oscillation_factor = Requirement(
        "-",
        lambda wants: np.where(wants.effective_offset > 0, 2.0, 1.0),
        lower=1,
        upper=4,
        symbol="f_osc",
        text="Oscillating bearings may carry this multiple of C0; 1 without offset, because then the same "
        "balls stay loaded",
        source=f"{S3}, chapter XI: up to 4 times, the lower figure is illegible",
        group="duty",
    )
    retention_margin = Requirement(
        "-",
        1.5,
        lower=1,
        upper=10,
        symbol="k_ret",
        text=f"Margin against the lighter loaded roller losing contact ({TYPICAL})",
        source=EXTENDS_S3,
    )
    ligament_factor = Requirement(
        "-",
        2.5,
        lower=1,
        upper=10,
        symbol="k_lig",
        text="Bending and notch in the bridges at the guide ends (estimate)",
        source=EXTENDS_S3,
    )
    roller_modulus = Requirement(
        "N/mm2",
        206000,
        lower=1e3,
        upper=1e6,
        symbol="E_r",
        text="Young's modulus of the rollers",
        source="material constant of bearing steel",
        group="material",
    )
    roller_poisson = Requirement(
        "-",
        0.3,
        lower=0,
        upper=0.49,
        symbol="nu_r",
        text="Poisson's ratio of the rollers",
        source="material constant of bearing steel",
        group="material",
    )
    crown_radius = Requirement(
        "mm",
        500,
        lower=1,
        upper=1e5,
        symbol="R_cr",
        text="Radius of a crowned tread; counts with roller contact crowned",
        source="makers' lists of track rollers",
    )
    rolling_friction = Requirement(
        "-",
        0.002,
        lower=0,
        upper=0.1,
        symbol="mu_roll",
        text=f"Rolling friction in the guides, for the efficiency ({TYPICAL})",
        source=TYPICAL,
        group="material",
    )
    steel_density = Requirement(
        "kg/m3",
        7850,
        lower=1000,
        upper=20000,
        symbol="rho_s",
        text="Density of pins and arms",
        source="material constant",
        group="material",
    )

    @cached_property
    def effective_offset(self) -> Any:
        """Offset seen in the plane of the float [m]."""
        return formulas.effective_offset(self.offset, self.float_distance, self.shaft_angle)


@dataclass(frozen=True)
class Loads:
    """Forces of a design [N], and what moves: mass of a roller and of a float [kg], number of counter floats."""

    tangential: Any
    centrifugal: Any
    normal: Any
    pin: Any
    vibration: Any
    float_mass: Any
    roller_mass: Any
    counter: Any


class RollerCoupling(DesignProblem):
    """Roller-type mobile coupling for offset and angled shafts, without sliding parts.

    A plate with two crossing guides, the float, joins two arms whose pins carry rolling bearings as rollers (S3).
    """

    name = "roller_coupling"
    title = "Roller coupling"
    sources = (
        "S3: B. Szoke, MTA VI. Osztaly Kozlemenyei 39 (1967), part II, chapters X to XIV, equations (14) to (29)",
        JOHNSON,
        "B. J. Hamrock, D. Brewe, Journal of Lubrication Technology 105 (1983) 171-177",
        ISO_76,
        *SHAFT,
    )
    understands = (
        *WORDS,
        "offset",
        "shaft_angle",
        "outer_diameter_limit",
        "mass_limit",
        "vibration_limit",
        "steel_density",
    )
    declines = coverage.JOINING
    disregards, as_limits = (*coverage.SOFTNESS, *coverage.NO_HOURS), {"length_limit": "length"}

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        kind = layer_of.roller_kind(d)
        options = d.block(Options, roller_contact=DEFAULT_CONTACT.get(kind, "line"))
        wants = d.block(Wants, **layer_of.defaults)
        refuse_contradictions(d, wants)
        layer = layer_of(d, wants)
        unknowns = self._declare_unknowns(d, contact=options.roller_contact, track=kind == "track")
        self._refuse_uncovered(d, wants=wants, unknowns=unknowns, options=options)
        self._refuse_impossible(d, wants=wants, unknowns=unknowns, options=options)
        loads = self._declare_loads(d, wants=wants, unknowns=unknowns)
        self._declare_motion(d, wants=wants, radius=unknowns.sizes.arm_radius)
        radius = self._declare_size(d, wants=wants, unknowns=unknowns, loads=loads, layer=layer)
        self._limit_clearances(d, wants=wants, unknowns=unknowns, options=options)
        self._declare_contact(d, wants=wants, unknowns=unknowns, loads=loads, contact=options.roller_contact)
        self._declare_pins(d, wants=wants, unknowns=unknowns, loads=loads)
        self._limit_float(d, wants=wants, unknowns=unknowns, loads=loads)
        layer.declare_rules(d, unknowns, radius)
        self._remark_on_duty(d, wants=wants, guide=options.guide)
        self._remark_on_design(d, wants=wants, unknowns=unknowns)
        d.headline("outer_diameter", "mass", "length", "hertz_pressure", "pin_stress", "efficiency")
        for name in ("outer_diameter", "mass"):
            d.objective(name)
        d.objective("pin_force", default=False)
        d.objective("offset_capacity", "max", default=False)
        d.objective("vibration_force", default=False)
        if "length" in d.derived:
            d.objective("length", default=False)

    def _declare_unknowns(self, d: Declaration, *, contact: str, track: bool) -> Unknowns:
        conditions = CONTACT_ROWS[contact]
        if track:
            conditions += coupling_body.track_rollers(d, contact=contact)
        return Unknowns(
            sizes=d.block(Sizes),
            balance=d.choice(
                "balance",
                ("no", "yes"),
                symbol="bal",
                text="yes: a second float of equal mass runs opposite (self-balancing chain)",
                source=f"{S3}, XIV.1",
                refused={
                    "floating_masses": "masses that float in the guides at rest have no acceleration and balance "
                    "nothing: equation (29) of the source is refuted"
                },
            ),
            roller=d.part(
                "roller",
                "guide_rolling_bearings",
                where=conditions,
                symbol="rol",
                text="Rolling bearing on each pin whose outer ring rolls in the guide",
                source="table guide_rolling_bearings",
            ),
            material=d.part(
                "float_material",
                "float_materials",
                symbol="mat",
                text="Material of the float",
                source="table float_materials",
            ),
        )

    def _refuse_uncovered(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, options: Options) -> None:
        """Refuse what the model does not cover, and rows and requirements that contradict themselves."""
        roller, guide, contact = unknowns.roller, options.guide, options.roller_contact
        if guide != "roller":
            d.refuse(
                "guide_not_sized",
                True,
                "guide = roller; the source gives neither dimensions nor friction nor strength of the predecessors, so "
                f"that they cannot be sized. {GUIDES[guide]}",
            )
        d.refuse(
            "bad_roller",
            np.logical_or(roller.bore >= roller.outer_diameter, roller.contact_width > roller.width),
            "a bearing with a bore below its outer_diameter and a contact_width of at most its width",
        )
        d.refuse(
            "no_oscillation",
            np.logical_and(wants.oscillation_factor > 1, wants.effective_offset <= 0),
            "an oscillation_factor of 1: without offset the bearings do not oscillate, and the raised static rating "
            "does not apply",
        )
        if contact != "line":
            round_crown = wants.crown_radius < roller.outer_diameter / 2
            d.refuse(
                "crown_too_round",
                np.logical_and(roller.crowned, round_crown) if contact == "either" else round_crown,
                "a crown_radius of at least the radius of the roller; the formula for the contact ellipse ends there",
            )
        if options.sideways_removable == "yes":
            d.refuse(
                "oblique_removal",
                wants.guide_angle < math.pi / 2 * (1 - 1e-9),
                "a guide_angle of 90 deg with sideways_removable: pulling apart is not derived for other angles",
            )

    def _refuse_impossible(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, options: Options) -> None:
        """Refuse what no design can meet, whatever the unknowns."""
        diameter, largest, most = unknowns.roller.outer_diameter, ARM_RADIUS_MAX / 1000, wants.outer_diameter_limit
        d.refuse(
            "no_roller_clears",
            wants.effective_offset + diameter + wants.roller_gap_min > 2 * largest * np.sin(wants.guide_angle / 2),
            "a roller for which effective offset + outer diameter + roller_gap_min is at most 2 sin(guide_angle/2) "
            "times the largest arm radius, 200 mm; no roller in the catalogue clears the other guide at this offset",
        )
        least = _least_arm_radius(wants, diameter)
        if most is not None:
            d.refuse(
                "envelope_too_small",
                _least_diameter(wants, diameter, least) > most,
                "an outer_diameter_limit that holds the smallest coupling with the smallest roller at this offset; the "
                "envelope is smaller than that",
            )
        if options.sideways_removable == "yes":
            apart = diameter + wants.removal_min
            wide = apart > largest
            if most is not None:
                wide = np.logical_or(wide, _least_diameter(wants, diameter, np.maximum(least, apart)) > most)
            d.refuse(
                "not_removable",
                wide,
                "a roller whose outer diameter and removal_min fit into the arm radius; with sideways_removable the "
                "coupling cannot be pulled apart sideways in this envelope",
            )
        if wants.vibration_limit is not None:
            d.refuse(
                "vibration_contradictory",
                unknowns.balance.select({"no": _least_vibration(d, wants=wants) > wants.vibration_limit, "yes": 0.0}),
                "balance = yes, or a larger vibration_limit: it is contradictory without balance, the lightest float "
                "that fits the offset shakes more",
            )

    def _declare_loads(self, d: Declaration, *, wants: Wants, unknowns: Unknowns) -> Loads:
        """Declare offset, float and forces on pins and shafts."""
        roller, radius, offset = unknowns.roller, unknowns.sizes.arm_radius, wants.effective_offset
        text = "Offset seen in the plane of the float"
        d.derive("effective_offset", "mm", offset, symbol="e_eff", text=text, source=EXTENDS_S3)
        float_mass = self._declare_float(d, wants=wants, unknowns=unknowns)
        tangential = d.derive(
            "tangential_force",
            "N",
            formulas.tangential_force(wants.required_torque, radius, radius),
            symbol="F",
            text="Force of each pin from the torque",
            source=f"{S3}, F = M/(2 r)",
        )
        centrifugal = d.derive(
            "centrifugal_force",
            "N",
            formulas.pin_centrifugal_force(float_mass, offset, wants.driver_speed, wants.guide_angle),
            symbol="Q",
            text="Greatest share of one pin in the centrifugal force of the float",
            source=f"{S3}, eq. (14), C/2",
        )
        mass = formulas.roller_mass(roller.mass, wants.steel_density, roller.bore, roller.width, wants.pin_gap)
        text = "Mass of a roller with its pin"
        mass = d.step("roller_mass", "kg", mass, symbol="m_rol", text=text, source="geometry")
        normal, spin = tangential + centrifugal, formulas.roller_centrifugal_force(mass, radius, wants.driver_speed)
        d.step("normal_force", "N", normal, symbol="F_n", text="Greatest force of a roller on its guide", source=S3)
        pin = formulas.resultant_pin_force(normal, spin)
        text = "Greatest force on a pin, with the centrifugal force of its roller"
        pin = d.derive("pin_force", "N", pin, symbol="F_pin", text=text, source=f"{S3}, E")
        counter, text = unknowns.balance.select({"no": 0.0, "yes": 1.0}), "Counter floats: one with balance"
        d.step("counter_floats", "-", counter, symbol="n_c", text=text, source=f"{S3}, XIV.1")
        vibration = self._declare_balance(d, centrifugal=centrifugal, counter=counter)
        return Loads(tangential, centrifugal, normal, pin, vibration, float_mass, mass, counter)

    def _declare_balance(self, d: Declaration, *, centrifugal: Any, counter: Any) -> Any:
        """Declare what the floats do to the shafts; the amplitude [N]."""
        d.derive(
            "steady_force",
            "N",
            centrifugal * (1 + counter),
            symbol="F_st",
            text="Steady push on each shaft, away from the other; balance doubles it",
            source=f"{EXTENDS_S3} to {S3}, XIV.1",
        )
        return d.derive(
            "vibration_force",
            "N",
            centrifugal * (1 - counter),
            symbol="F_vib",
            text="Amplitude of the force on each shaft, twice per turn",
            source=f"{S3}, XIV.1",
        )

    def _declare_motion(self, d: Declaration, *, wants: Wants, radius: Any) -> None:
        """Declare what the motion of the float costs: even speed and power."""
        d.derive(
            "speed_fluctuation",
            "-",
            formulas.speed_fluctuation(wants.shaft_angle),
            symbol="eps",
            text="Greatest excess of the driven speed, 1/cos(alpha) - 1",
            source=f"{S3}, eq. (24a)",
        )
        d.derive(
            "efficiency",
            "-",
            formulas.rolling_efficiency(wants.rolling_friction, wants.effective_offset, radius),
            symbol="eta",
            text="Efficiency with rolling friction in the guides",
            source=f"{EXTENDS_S3}, guides at right angles",
        )

    def _declare_size(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, loads: Loads, layer: Sources) -> Any:
        """Declare diameter and mass with the limits of the drive; the radius of the float [m]."""
        sizes, source = unknowns.sizes, "geometry"
        radius = formulas.float_radius(sizes.guide_half_length, unknowns.roller.outer_diameter, sizes.rim)
        outer = 2 * (radius + wants.effective_offset / np.sin(wants.guide_angle))
        text = "Diameter that the float sweeps about a shaft"
        outer = d.derive("outer_diameter", "mm", outer, symbol="D_o", text=text, source=source)
        d.step("float_radius", "mm", radius, symbol="R_f", text="Outside of the float", source=source)
        arms = self._declare_arms(d, wants=wants, unknowns=unknowns)
        parts = loads.float_mass * (1 + loads.counter) + 4 * loads.roller_mass + arms
        mass = parts + layer.extend(d, Built(wants, unknowns, loads, parts))
        text = f"Float, counter float, rollers with pins, and arms; {layer.mass_of}"
        mass = d.derive("mass", "kg", mass, symbol="m", text=text, source=source)
        for name, unit, value, most, text in (
            ("outer_diameter", "mm", outer, wants.outer_diameter_limit, "The coupling fits the room"),
            ("mass", "kg", mass, wants.mass_limit, "The coupling is not too heavy"),
            ("vibration", "N", loads.vibration, wants.vibration_limit, "The shafts do not shake too much"),
        ):
            if most is not None:
                d.at_most(name, value, most, unit, text=text, source=DRIVE)
        return radius

    def _declare_float(self, d: Declaration, *, wants: Wants, unknowns: Unknowns) -> Any:
        """Declare slide and sizes of the float; its mass [kg]."""
        sizes, diameter, source = unknowns.sizes, unknowns.roller.outer_diameter, "geometry"
        slide = d.derive(
            "axial_slide",
            "mm",
            formulas.axial_slide(wants.offset, wants.float_distance, wants.shaft_angle, wants.guide_angle),
            symbol="z_ax",
            text="Slide of the rollers along shaft 2 per turn, peak to peak",
            source=f"{EXTENDS_S3}; generalises {S3}, eq. (25)",
        )
        width = d.derive(
            "float_width",
            "mm",
            formulas.float_width(sizes.contact_length, slide, wants.axial_play),
            symbol="b_f",
            text="Width of the float: contact, slide and play",
            source=f"{S3}, chapter XII",
        )
        section = formulas.float_section(sizes.guide_half_length, diameter, sizes.rim, wants.guide_angle)
        text = "Float without its guides, a completed square"
        d.step("float_section", "cm2", section, symbol="A_f", text=text, source=source)
        ends = formulas.float_radius(sizes.guide_half_length, diameter, 0.0)
        d.step("guide_end_radius", "mm", ends, symbol="r_K", text="Corners of the guide ends", source=source)
        mass = formulas.float_mass(unknowns.material.density, width, section)
        return d.derive("float_mass", "kg", mass, symbol="m_fl", text="Mass of the float", source=source)

    def _declare_arms(self, d: Declaration, *, wants: Wants, unknowns: Unknowns) -> Any:
        """Name mass and bars of the arms; mass of both [kg]."""
        bore, radius = unknowns.roller.bore, unknowns.sizes.arm_radius
        arms = formulas.arms_mass(wants.steel_density, radius, bore)
        text = "Both arms, bars of 2 r + 2 d by 2 d by 1.2 d over a bore d"
        d.step("arms_mass", "kg", arms, symbol="m_arm", text=text, source="geometry")
        for name, value, symbol, text in (
            ("arm_length", 2 * radius + 2 * bore, "l_arm", "Bar of an arm along the line of its pins"),
            ("arm_width", 2 * bore, "b_arm", "Bar of an arm across that line"),
            ("arm_thickness", formulas.ARM_THICKNESS * bore, "t_arm", "Bar of an arm along its shaft"),
        ):
            d.step(name, "mm", value, symbol=symbol, text=text, source="usual proportions")
        return arms

    def _limit_clearances(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, options: Options) -> None:
        """Limit what is clear between rollers and guides at the offset that the coupling takes."""
        radius, capacity = unknowns.sizes.arm_radius, unknowns.sizes.offset_capacity
        diameter, angle = unknowns.roller.outer_diameter, wants.guide_angle
        gap = formulas.least_roller_distance(radius, capacity, angle) - diameter
        inside = formulas.run_in(radius, capacity, diameter, angle)
        outside = formulas.run_out(unknowns.sizes.guide_half_length, radius, capacity, angle)
        offset, apart = "The coupling takes the offset of the shafts", "Neighbouring rollers do not touch"
        clear, inward = "Rollers stay clear of the crossing guide", "Rollers stay inside their guide"
        for name, value, least, text, source in (
            ("offset", capacity, wants.effective_offset, offset, DRIVE),
            ("roller_gap", gap, wants.roller_gap_min, apart, f"{S3}, eq. (18a)"),
            ("run_in", inside, wants.run_in_min, clear, f"{S3}, chapter XI, s1"),
            ("run_out", outside, wants.run_out_min, inward, f"{S3}, eq. (19a)"),
        ):
            d.at_least(name, value, least, "mm", text=text, source=source)
        if options.sideways_removable == "yes":
            free, text = formulas.removal_clearance(radius, diameter), "An arm passes the other guide sideways"
            d.at_least("sideways", free, wants.removal_min, "mm", text=text, source=f"{S3}, eq. (21)")

    def _declare_contact(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, loads: Loads, contact: str) -> None:
        """Declare the pressure between roller and guide, with the limits of both."""
        roller, material, length = unknowns.roller, unknowns.material, unknowns.sizes.contact_length
        radius = roller.outer_diameter / 2
        modulus = hertz.contact_modulus(wants.roller_modulus, wants.roller_poisson, material.E, material.nu)
        text = "Inverse of the modulus of the contact E*"
        d.step("contact_compliance", "mm2/N", 1 / modulus, symbol="s_c", text=text, source="Johnson, Contact Mechanics")
        pressure, source, half = None, "", None
        if contact != "crowned":
            pressure = hertz.line_contact_pressure(loads.normal, modulus, length, radius)
            source = f"{S3}, chapter XI; Johnson, Contact Mechanics"
        if contact != "line":
            half = self._name_ellipse(d, wants=wants, loads=loads, modulus=modulus, radius=radius)
            point = hertz.point_contact_pressure(loads.normal, modulus, radius, wants.crown_radius)
            pressure = point if contact == "crowned" else np.where(roller.crowned, point, pressure)
            source = "; ".join(x for x in (source, ELLIPSE) if x)
        pressure = d.derive(
            "hertz_pressure",
            "N/mm2",
            pressure,
            symbol="p_H",
            ceiling=formulas.STATIC_CONTACT_LIMIT / 1e6,
            text="Greatest Hertz pressure between roller and guide",
            source=source,
        )
        text, most = "The roller is wide enough", np.minimum(material.hertz_allow, formulas.STATIC_CONTACT_LIMIT)
        d.at_most("contact_length", length, roller.contact_width, "mm", text=text, source="geometry")
        d.at_most("hertz", pressure, most, "N/mm2", text="The guide is not dented", source=source)
        if half is not None:
            ellipse, text = 2 * half, "The contact ellipse lies on the tread"
            long = ellipse if contact == "crowned" else roller.crowned * ellipse
            d.at_most("contact_ellipse", long, length, "mm", text=text, source=ELLIPSE)
        bends, text = roller.optional("outer_ring_load_limit"), "The unsupported outer ring does not bend too much"
        d.at_most("outer_ring_bending", loads.normal, bends, "N", text=text, source="makers' F0r of track rollers")

    def _declare_pins(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, loads: Loads) -> None:
        """Declare the stresses of the pins, with their limits and that of the bearings on them."""
        roller, text = unknowns.roller, "The pins stand the shear"
        shear = formulas.pin_shear_measure(wants.required_torque, unknowns.sizes.arm_radius, roller.bore)
        d.at_most("pin_shear", shear, wants.pin_shear_limit, "N/mm2", text=text, source=f"{S3}, eq. (16)")
        bending = formulas.pin_bending_stress(loads.pin, roller.width, wants.pin_gap, roller.bore)
        shear = formulas.pin_shear_stress(loads.pin, roller.bore)
        d.step("pin_bending", "N/mm2", bending, symbol="sigma_b", text="Bending of a pin", source=EXTENDS_S3)
        d.step("pin_shear_stress", "N/mm2", shear, symbol="tau_p", text="Shear of a pin", source=EXTENDS_S3)
        stress = d.derive(
            "pin_stress",
            "N/mm2",
            formulas.pin_equivalent_stress(loads.pin, roller.width, wants.pin_gap, roller.bore),
            symbol="sigma_v",
            text="Equivalent stress at the root of a pin",
            source=EXTENDS_S3,
        )
        d.at_most(
            "pin_stress", stress, wants.pin_stress_limit, "N/mm2", text="The pins stand the bending", source=EXTENDS_S3
        )
        most = formulas.allowed_pin_force(roller.C0_static_min, wants.oscillation_factor, wants.static_safety)
        text = "The rolling bearing stands the force at rest or oscillating"
        d.at_most("bearing_static", loads.pin, most, "N", text=text, source=f"{S3}, chapter XI")

    def _limit_float(self, d: Declaration, *, wants: Wants, unknowns: Unknowns, loads: Loads) -> None:
        """Limit what the rim of the float stands, and that no roller loses its guide."""
        rim, width = unknowns.sizes.rim, d.derived["float_width"].sx
        stress = formulas.ligament_stress(wants.ligament_factor, loads.normal, rim, width)
        stands, text = unknowns.material.strength_allow, "The bridges at the guide ends hold"
        d.at_most("ligament", stress, stands, "N/mm2", text=text, source=EXTENDS_S3)
        d.at_least("rim", rim, wants.rim_min, "mm", text="The rim is not too thin", source=TYPICAL)
        least = wants.retention_margin * loads.centrifugal
        text = "The lighter loaded rollers keep contact, the float does not hammer"
        d.at_least("contact_retention", loads.tangential, least, "N", text=text, source=EXTENDS_S3)

    def _name_ellipse(self, d: Declaration, *, wants: Wants, loads: Loads, modulus: Any, radius: Any) -> Any:
        """Name what the contact of a crowned roller is computed with; half the length of the ellipse [m]."""
        share = radius / wants.crown_radius
        half = hertz.point_contact_half_length(loads.normal, modulus, radius, wants.crown_radius)
        for name, unit, value, symbol, text in (
            ("crown_share", "-", share, "rho_crown", "Radius of the roller over that of its crown"),
            ("ellipticity", "-", hertz.ellipticity(share), "k_e", "Long over short axis of the contact ellipse"),
            ("contact_half_length", "mm", half, "a_y", "Half length of the contact ellipse along the roller"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=ELLIPSE)
        return half

    def _remark_on_duty(self, d: Declaration, *, wants: Wants, guide: str) -> None:
        if guide != "roller":
            d.advise(f"{guide}_guide", True, GUIDES[guide], source=f"{S3}, chapter X")
        d.advise(
            "distance_ignored",
            np.logical_and(wants.float_distance > 0, wants.shaft_angle <= 0),
            "float distance does nothing without a shaft angle",
            source=f"{S3}, chapter XII",
        )
        d.advise(
            "no_optimum_arm",
            wants.driver_speed <= 0,
            "at standstill the pin force falls with the arm radius without end: there is no optimum arm",
            source=f"{S3}, eq. (15)",
        )
        d.advise(
            "same_balls_loaded",
            wants.effective_offset <= 0,
            "without offset the same balls stay loaded (false brinelling); a slight offset does the bearings good",
            source=f"{S3}, chapter XI",
        )

    def _remark_on_design(self, d: Declaration, *, wants: Wants, unknowns: Unknowns) -> None:
        offset, material = wants.effective_offset, unknowns.material
        for name, unit, value, symbol, text in (
            ("plastic_modulus", "GPa", PLASTIC_MODULUS / 1e9, "E_plastic", "Modulus below which a float is of plastic"),
            ("plastic_pressure", "N/mm2", PLASTIC_PRESSURE / 1e6, "p_plastic", "Pressure above which plastics creep"),
        ):
            d.constant(name, unit, value, symbol=symbol, text=text, source=TYPICAL)
        text, static = "Static limit of a line contact", formulas.STATIC_CONTACT_LIMIT
        d.constant("static_contact_limit", "N/mm2", static / 1e6, symbol="p_static", text=text, source="ISO 76")
        d.advise(
            "plastic_creeps",
            np.logical_and(material.E < PLASTIC_MODULUS, d.derived["hertz_pressure"].sx > PLASTIC_PRESSURE),
            "a plastic float above 100 N/mm2 creeps; 40 to 80 N/mm2 are usual, less when warm",
            source=TYPICAL,
        )
        d.advise(
            "hertz_capped",
            material.hertz_allow > static,
            "hertz allow of this material is capped at 4000 N/mm2, the static limit of ISO 76",
            source="ISO 76",
        )
        d.advise(
            "rating_life",
            2 * offset / unknowns.roller.outer_diameter > LONG_OSCILLATION,
            "the rollers turn far to and fro: check the rating life L10 with the equivalent speed as well",
            source=TYPICAL,
        )
        d.advise(
            "rollers_tilt",
            wants.shaft_angle > 0,
            "with angled shafts the rollers must follow the tilt (self-aligning or crowned); closed forms of forces "
            "and gaps are then good to about 1/cos(alpha) - 1, simulate shows the exact ones",
            source=f"{S3}, chapter XII",
        )
        d.advise(
            "push_doubled",
            unknowns.balance.select({"no": 0.0, "yes": offset > 0}),
            "the counter float removes the vibration and doubles the steady push on the bearings of both shafts",
            source=f"{EXTENDS_S3} to {S3}, XIV.1",
        )

    # -- curves and motion -------------------------------------------------------------------------

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section along one guide, and the float with rollers and pins from the front."""
        from . import drawing as coupling_drawing  # costly to import; searches do without

        return coupling_drawing.coupling_drawing(spec, design)

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return the force on a pin over the arm radius, of the torque alone or of a design, and of angled shafts."""
        found: dict[str, pd.DataFrame] = {}
        if design is not None:
            found["pin_force"] = curves.pin_force(spec, design)
        else:
            found["torque_force"] = curves.torque_force(spec, ARM_RADIUS_MIN / 1000, ARM_RADIUS_MAX / 1000)
        if spec["shaft_angle"] > 0:
            found["angled_shafts"] = curves.angled_shafts(spec)
        return found

    def simulate(self, spec: Mapping[str, Any], design: Design) -> dict[str, pd.DataFrame]:
        """Return positions of the float, roller gaps and forces over one turn, from exact kinematics."""
        return {"motion": curves.one_turn(spec, design)}


# -- bounds for refusals ---------------------------------------------------------------------------


def _least_arm_radius(wants: Wants, roller_diameter: Any) -> Any:
    """Least arm radius at which a roller keeps the clearances at the offset asked for."""
    offset, half = wants.effective_offset, wants.guide_angle / 2
    apart = (offset + roller_diameter + wants.roller_gap_min) / (2 * np.sin(half))
    inward = offset / np.sin(wants.guide_angle) + roller_diameter / (2 * np.tan(half)) + wants.run_in_min
    return np.maximum(ARM_RADIUS_MIN / 1000, np.maximum(apart, inward))


def _least_half_length(wants: Wants, arm_radius: Any) -> Any:
    return arm_radius + wants.effective_offset / np.sin(wants.guide_angle) + wants.run_out_min


def _least_diameter(wants: Wants, roller_diameter: Any, arm_radius: Any) -> Any:
    radius = formulas.float_radius(_least_half_length(wants, arm_radius), roller_diameter, wants.rim_min)
    return 2 * (radius + wants.effective_offset / np.sin(wants.guide_angle))


def _least_vibration(d: Declaration, *, wants: Wants) -> Any:
    """Vibration force of the lightest material around the smallest roller: section and offset only grow from there."""
    density = float(np.nanmin(d.numbers("float_materials", "density")))
    diameter = float(np.nanmin(d.numbers("guide_rolling_bearings", "outer_diameter")))
    half_length = _least_half_length(wants, _least_arm_radius(wants, diameter))
    slide = formulas.axial_slide(wants.offset, wants.float_distance, wants.shaft_angle, wants.guide_angle)
    width = formulas.float_width(CONTACT_LENGTH_MIN / 1000, slide, wants.axial_play)
    section = formulas.float_section(half_length, diameter, wants.rim_min, wants.guide_angle)
    mass = formulas.float_mass(density, width, section)
    return formulas.pin_centrifugal_force(mass, wants.effective_offset, wants.driver_speed, wants.guide_angle)
