"""Magnetic-powder clutch: a ring coil magnetises iron powder between a rotor and a drum, which then carries shear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from synth import Design, DesignProblem
from synth.declaration import Choice, Declaration, Part, Requirement

from .. import friction, practice
from ..components.coil import model as coil_blocks
from ..duty import COOLING, WORDS, Drive, cooling, coverage, declare_gravity, of_drive, refuse_contradictions
from ..duty.kinds import CONTINUOUS_SLIP, COUPLING, OVERRUN, START, declare_kind
from ..mechanics import centrifugal, heat, magnetics
from ..practice import UNSOURCED
from ..sources import LIST_S1, S4, SHAFT, STANDARD_GRAVITY, TYPICAL
from . import curves as powder_curves
from . import formulas as powder
from .layers import LAYERS, Bore, Built, Rise, Sized, Sources

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing

SHEAR = 3e4  # shear stress of powder by which the size of a clutch is estimated [Pa]
SURFACE_WARNING = 348.15  # one maker's limit of the surface, 75 degC [K]


class PowderUnknowns(coil_blocks.CoilUnknowns):
    """Coil and iron of clutches of any size."""

    coil_length = replace(coil_blocks.CoilUnknowns.coil_length, lower=1, upper=5000)
    coil_height = replace(coil_blocks.CoilUnknowns.coil_height, lower=1, upper=5000)
    yoke_thickness = replace(coil_blocks.CoilUnknowns.yoke_thickness, lower=0.5, upper=5000)


class Wants(Drive):
    """Requirements beside those of the coil, all in SI; None where an optional one is not given."""

    group = "duty"

    driver_speed = replace(
        Drive.driver_speed,
        default=1432.39,
        lower=1,
        symbol="omega_in",
        text=f"Speed of the driving side ({TYPICAL}); cools a rotating coil",
        source=f"{S4}, section 6.1",
    )
    cooling = replace(COOLING, source="table cooling_options")
    required_torque = replace(Drive.required_torque, text="Torque that the clutch has to carry, slipping or not")
    steel_density = Requirement(
        "kg/m3",
        7850,
        lower=1000,
        upper=20000,
        symbol="rho_steel",
        text="Density of rotor, drum and body",
        source="material constant",
        group="material",
    )
    torque_reserve = Requirement(
        "-",
        1.2,
        lower=1,
        upper=5,
        symbol="k_M",
        text="Torque at full current over required torque",
        source=f"{S4}, section 6.1",
    )
    ambient_temperature = Requirement(
        "degC",
        40,
        lower=-60,
        upper=150,
        symbol="T_amb",
        text="Temperature of the surroundings",
        source=f"{S4}, section 6.1",
    )
    powder_flux_limit = Requirement(
        "T",
        1.0,
        lower=0.05,
        upper=1.6,
        symbol="B_max",
        text="Largest flux density in the powder",
        source=f"{S4}, section 6.1",
        group="material",
    )
    brush_voltage = Requirement(
        "V",
        1,
        lower=0,
        upper=10,
        symbol="U_brush",
        text=f"Drop of one brush contact ({TYPICAL}); rotating coil only",
        source=f"{S4} [P8]",
        group="actuator",
    )
    rotating_heat_transfer = Requirement(
        "-",
        3,
        lower=0,
        upper=100,
        symbol="h_rot",
        text=f"W/(m2 K) per 0.8th power of the speed of the rim in m/s, of a rotating coil body ({TYPICAL})",
        source=f"{S4} [P7]",
        group="model",
    )
    fill_factor = Requirement(
        "-",
        0.6,
        lower=0.05,
        upper=1,
        symbol="fill",
        text=f"Part of the gap that powder fills ({TYPICAL})",
        source=f"{S4} [P10]",
        group="actuator",
    )
    rotor_web_thickness = Requirement(
        "mm",
        8,
        lower=1,
        upper=200,
        symbol="t_web",
        text=f"Web of the rotor ({TYPICAL})",
        source=f"{S4} [P10]",
        group="model",
    )
    air_gap = Requirement(
        "mm",
        0.4,
        lower=0.05,
        upper=5,
        symbol="delta_a",
        text=f"Gap between drum and stationary body ({TYPICAL})",
        source=f"{S4} [P4]",
        group="model",
    )
    drum_thickness = Requirement(
        "mm",
        6,
        lower=0.5,
        upper=50,
        symbol="t_drum",
        text=f"Drum between powder and stationary body ({TYPICAL})",
        source=f"{S4} [P4]",
        group="model",
    )
    powder_mass_limit = Requirement(
        "kg",
        0.40,
        lower=0.01,
        upper=50,
        symbol="m_powder_max",
        text="Largest mass of powder",
        source=f"{S4}, 250 to 400 g",
        group="actuator",
    )
    outer_diameter_limit = of_drive("mm", 20, 2000, "D_max", "Largest outside diameter", group="envelope")
    length_limit = of_drive("mm", 10, 2000, "L_max", "Largest length of the body", group="envelope")


class Slipping(Wants):
    """Requirements of a clutch that slips all the time, all in SI."""

    group = "duty"

    slip_speed = Requirement(
        "1/min",
        9.549,
        lower=0,
        upper=60000,
        symbol="omega_slip",
        text=f"Continuous slip ({TYPICAL}, 1 rad/s)",
        source=f"{S4} [P9]",
    )


class Starting(friction.Starting, Wants):
    """Requirements of a clutch that brings a load up to speed, all in SI."""


WANTS = {START: Starting, COUPLING: Wants, CONTINUOUS_SLIP: Slipping}


class MagneticPowderClutch(DesignProblem):
    """Magnetic-powder clutch with a stationary coil, or with a coil that rotates and has slip rings.

    The source (S4) describes it in words and figures of experience; the sizing model is derived. The shear curve of the
    powder is an unverified calibration (table powders).
    """

    name = "magnetic_powder_clutch"
    title = "Magnetic-powder clutch"
    sources = (
        LIST_S1,
        "S4: notes on centrifugal clutches, powder clutch (coil about 50 W, 60 to 100 cm3 of carbonyl iron powder)",
        "Chen, Tian et al., Smart Mater. Struct. 22 (2013) 115036: form of the shear curve",
        "Ampere's law, Froehlich's saturation curve, steady heat balance",
        STANDARD_GRAVITY,
        *SHAFT,
    )
    understands = (*WORDS, *coverage.SIZES, *coverage.SLIPPED, "slip_speed", "ambient_temperature", "steel_density")
    declines, as_limits = coverage.POWDER, coverage.AT_FULL_CURRENT
    disregards = ("switching_factor", "speed_factor", "peak_torque")

    def declare(self, d: Declaration) -> None:
        """Declare requirements, unknowns, limits and objectives."""
        layer_of = LAYERS[practice.declare_scope(d)]
        kind = declare_kind(d, CONTINUOUS_SLIP, {OVERRUN: coverage.BOTH_WAYS})
        wants = d.block(WANTS[kind], cooling=layer_of.cooling if kind == CONTINUOUS_SLIP else COOLING.default)
        cooling.refuse_unfit(d, "dry", turning=False)
        refuse_contradictions(d, wants)
        layer = layer_of(d, wants)
        iron = coil_blocks.declare_coil_requirements(d, still_heat_transfer=cooling.still_transfer(d))
        size = (wants.torque_reserve * wants.required_torque / SHEAR / (2 * np.pi)) ** (1 / 3)
        radius = d.variable(
            "gap_radius",
            "mm",
            1,
            5000,
            grid=1,
            within=(0.3 * size, 4 * size),
            symbol="r_g",
            text="Outside of the rotor, where the powder acts",
            source=f"{S4} [P4]",
        )
        pole = d.variable(
            "pole_length",
            "mm",
            1,
            5000,
            grid=1,
            within=(0.05 * size, 3 * size),
            symbol="l_p",
            text="Length of one pole face; there are two",
            source=f"{S4} [P4]",
        )
        gap = d.variable(
            "powder_gap",
            "mm",
            1,
            1.5,
            grid=0.05,
            symbol="g",
            text="Gap between rotor and drum",
            source=f"{S4}, 1 to 1.5 mm",
        )
        sections = dict.fromkeys(("coil_length", "coil_height", "yoke_thickness"), (0.02 * size, 2 * size))
        unknowns = d.block(PowderUnknowns, **sections)
        coil = d.choice(
            "coil",
            ("stationary", "rotating"),
            symbol="lay",
            text="stationary: a second air gap, no slip rings; rotating: slip rings, the coil turns with the driver",
            source=f"{S4}, figures 2-27 to 2-29",
        )
        if cooling.stands(d):
            rotates = coil.select({"stationary": 0.0, "rotating": 1.0})
            d.at_most("standing_body", rotates, 0.5, "-", text="A jacket needs a body that stands", source=UNSOURCED)
        part = d.part("powder", "powders", symbol="pw", text="Magnetic powder", source="table powders")
        layout = powder.Layout(
            gap_radius=radius,
            pole_length=pole,
            gap=gap,
            coil_length=unknowns.coil_length,
            coil_height=unknowns.coil_height,
            thickness=unknowns.yoke_thickness,
            drum=coil.select({"stationary": wants.drum_thickness, "rotating": 0.0}),
            air_gap=coil.select({"stationary": wants.air_gap, "rotating": 0.0}),
        )
        rim = powder.rim_section_width(radius, unknowns.yoke_thickness)
        torque = _declare_torque(d, wants=wants, part=part, flux_density=unknowns.flux_density, layout=layout)
        circuit = powder.Circuit(
            layout=layout,
            rim=rim,
            permeability=part.relative_permeability,
            leakage_factor=iron.leakage_factor,
            iron_reluctance=iron.iron_reluctance,
            iron_saturation=iron.iron_saturation,
        )
        _name_layout(d, layout=layout, rim=rim)
        ampere_turns = _declare_circuit(
            d, bore=layer.bore, iron=iron, circuit=circuit, flux_density=unknowns.flux_density, layout=layout
        )
        slip_heat = _declare_slip_heat(d, wants=wants, torque=torque, rise=layer.rise)
        moving = magnetics.heat_transfer_in_motion(
            iron.still_heat_transfer, wants.rotating_heat_transfer, wants.driver_speed, layout.outer_radius
        )
        transfer = coil.select({"stationary": iron.still_heat_transfer, "rotating": moving})
        text = "Surface coefficient of a turning body"
        d.step("moving_heat_transfer", "W/(m2*K)", moving, symbol="h_mov", text=text, source=f"{S4} [P7]")
        text = "Surface coefficient of the body"
        d.step("coil_heat_transfer", "W/(m2*K)", transfer, symbol="h_c_body", text=text, source=f"{S4} [P7]")
        around = coil_blocks.Surroundings(
            ambient_temperature=wants.ambient_temperature,
            temperature_limit=np.minimum(unknowns.winding_wire.insulation_temperature, part.temp_max),
            heat_transfer=transfer,
            surface=cooling.effective(d, magnetics.cylinder_surface(layout.outer_radius, layout.length)),
            other_heat=0.0 if slip_heat is None else slip_heat,
            brush_drop=coil.select({"stationary": 0.0, "rotating": 2 * wants.brush_voltage}),
        )
        winding = coil_blocks.declare_winding(
            d, wants=iron, unknowns=unknowns, ampere_turns=ampere_turns, bore_radius=layout.bore, around=around
        )
        sized = _declare_size(
            d, layer=layer, part=part, coil=coil, layout=layout, rim=rim, copper_section=winding.copper_section
        )
        _declare_remarks(d, wants=wants, coil=coil, part=part, layout=layout)
        built = Built(iron, unknowns, part, circuit, sized, winding, slip_heat)
        layer.declare_rules(d, built)
        d.headline(
            "mass",
            "outer_diameter",
            "length",
            "coil_power",
            *(() if slip_heat is None else ("slip_heat",)),
            "coil_temperature_rise",
            sized_by="torque_capacity",
        )
        for name in ("coil_power", "input_inertia", "mass", "outer_diameter"):
            d.objective(name, default=name in layer.objectives)
        layer.declare_cost(d, built)

    def drawing(self, spec: Mapping[str, Any], design: Design) -> Drawing:
        """Return the section through rotor, gaps, body and coil; of a complete clutch shields and shaft as well."""
        from . import drawing as powder_drawing  # costly to import; searches do without

        return powder_drawing.powder_drawing(spec, design, scope=self.option("mass_scope"))

    def curves(self, spec: Mapping[str, Any], design: Design | None = None) -> dict[str, pd.DataFrame]:
        """Return the shear stress that a torque needs; of a design torque over current and temperature, heat balance.

        Parameters
        ----------
        spec : mapping
            Requirements in SI by name, None where an optional one is not given.
        design : Design, optional
            The design to draw.

        Returns
        -------
        dict of str to DataFrame
            ``stress_over_radius``, and of a design ``torque_over_current``, ``torque_over_temperature`` and
            ``heat_balance``.
        """
        frames = {"stress_over_radius": powder_curves.stress_over_radius(self, spec)}
        if design is not None:
            coil = powder_curves.drawings(self, spec, design)
            frames["torque_over_current"] = powder_curves.torque_over_current(coil, spec)
            frames["torque_over_temperature"] = coil.torque_over_temperature()
            frames["heat_balance"] = coil.heat_balance()
        return frames


def _declare_torque(d: Declaration, *, wants: Wants, part: Part, flux_density: Any, layout: powder.Layout) -> Any:
    """Declare the torque with its limits and return it."""
    stress = powder.shear_stress(flux_density, part.tau_sat, part.half_flux_density)
    text = "Shear stress of the powder"
    d.step("shear_stress", "N/mm2", stress, symbol="tau_p", text=text, source=f"{S4} [P1]")
    torque = d.derive(
        "torque",
        "N*m",
        powder.torque(stress, layout.gap_radius, layout.pole_length),
        symbol="M",
        text="Torque at full current, whatever the slip speed; rests on the unverified shear curve of the powder",
        source=f"{S4} [P1], [P5]",
    )
    d.at_least(
        "torque_capacity",
        torque,
        wants.torque_reserve * wants.required_torque,
        "N*m",
        text="The clutch carries the torque with its reserve",
        source=f"{S4}, section 6.3",
    )
    d.at_most(
        "powder_flux_density",
        flux_density,
        wants.powder_flux_limit,
        "T",
        text="The powder is not saturated",
        source=f"{S4}, section 6.3",
    )
    return torque


def _declare_slip_heat(d: Declaration, *, wants: Wants, torque: Any, rise: Rise | None) -> Any:
    """Declare the heat of slip and return it [W]; None where the clutch does not slip."""
    if isinstance(wants, Slipping):
        slip_heat, text = wants.required_torque * wants.slip_speed, "Heat of continuous slip under required torque"
    elif isinstance(wants, Starting) and rise is not None:
        full = friction.Torques(ramp_low=torque, ramp_high=torque)
        start = friction.declare_startup(d, duty=wants, torques=full, ramp_time=rise.rise_time_limit)
        slip_heat = heat.hourly_heat(start.friction_work, wants.engagements_per_hour)
        text = "Heat of the starts of an hour, spread over it"
    else:
        return None
    return d.derive("slip_heat", "W", slip_heat, symbol="P_slip", text=text, source=f"{S4} [P9]")


def _declare_circuit(
    d: Declaration,
    *,
    bore: Bore,
    iron: coil_blocks.CoilRequirements,
    circuit: powder.Circuit,
    flux_density: Any,
    layout: powder.Layout,
) -> Any:
    """Declare the flux densities of the iron and return the ampere-turns that the circuit needs."""
    found = circuit.iron(flux_density)
    coil_blocks.declare_saturation(d, wants=iron, iron_flux_density=found.densest)
    d.at_most(
        "yoke_flux_density",
        found.yoke,
        iron.iron_flux_limit,
        "T",
        text="The yoke outside the coil carries the flux",
        source=f"{S4} [P4]",
    )
    d.at_most(
        "rotor_flux_density",
        found.rotor,
        iron.iron_flux_limit,
        "T",
        text="The rim of the rotor carries the flux",
        source=f"{S4} [P4]",
    )
    d.at_least(
        "rotor_bore",
        layout.gap_radius,
        layout.thickness + bore.shaft_radius,
        "mm",
        text="The shaft fits inside the rim of the rotor",
        source="geometry",
    )
    area = powder.pole_area(layout.gap_radius, layout.pole_length)
    turns, air = powder.gap_ampere_turns(circuit.permeability, layout)
    field = magnetics.froehlich_field(found.densest, circuit.iron_reluctance, circuit.iron_saturation)
    for name, unit, value, symbol, text in (
        ("pole_area", "cm2", area, "A_p", "Area of one pole face"),
        ("powder_excitation", "A/T", turns, "theta_p", "Ampere-turns of twice the powder over the flux density"),
        ("air_excitation", "A/T", air, "theta_a", "Ampere-turns of twice the air gap over the flux density"),
        ("yoke_flux", "T", found.yoke, "B_y", "Flux density of the yoke outside the coil"),
        ("rotor_flux", "T", found.rotor, "B_r", "Flux density in the rim of the rotor"),
        ("iron_flux_density", "T", found.densest, "B_fe", "Flux density of the iron that has most"),
        ("iron_flux_ratio", "-", circuit.iron(1.0).densest, "k_fe", "Flux density of that iron over B"),
        ("iron_field", "A/m", field, "H_fe", "Field of the iron after Froehlich"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=f"{S4} [P3], [P4]")
    return circuit.ampere_turns(flux_density, found.densest)


def _name_layout(d: Declaration, *, layout: powder.Layout, rim: Any) -> None:
    """Name lengths and radii; the rotor has no drum and one gap less."""
    for name, unit, value, symbol, text in (
        ("built_drum", "mm", layout.drum, "t_d", "Drum of a stationary coil, 0 of a rotating one"),
        ("built_air_gap", "mm", layout.air_gap, "g_a", "Air gap of a stationary coil, 0 of a rotating one"),
        ("drum_radius", "mm", layout.drum_radius, "r_d", "Outside of the drum"),
        ("body_bore", "mm", layout.bore, "r_b", "Bore of the body around the coil"),
        ("outer_radius", "mm", layout.outer_radius, "R_out", "Outside of the yoke"),
        ("face_length", "mm", layout.face_length, "l_f", "Length of rotor and powder gap"),
        ("rim_section_width", "mm", rim, "w_rim", "Section of the rim of the rotor over its circumference"),
        ("rim_radius", "mm", layout.gap_radius - layout.thickness, "r_rim", "Inside of the rim of the rotor"),
        ("yoke_ratio", "-", layout.yoke_ratio, "k_y", "Mean radius of the yoke over that of the powder gap"),
        ("air_flux_share", "-", layout.air_flux_share, "k_a", "Flux density in the air gap over that in the powder"),
        ("iron_path", "mm", layout.iron_path, "l_fe", "Mean length of the flux in iron"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=f"geometry; {S4} [P4]")


def _declare_size(
    d: Declaration, *, layer: Sources, part: Part, coil: Choice, layout: powder.Layout, rim: Any, copper_section: Any
) -> Sized:
    wants = layer.wants
    filling = d.derive(
        "powder_mass",
        "kg",
        powder.powder_mass(part.bulk_density, wants.fill_factor, layout.gap_radius, layout.gap, layout.face_length),
        symbol="m_pow",
        text="Powder in the gap",
        source=f"{S4} [P10]",
    )
    d.at_most(
        "powder_mass",
        filling,
        wants.powder_mass_limit,
        "kg",
        text="The powder is not more than asked for",
        source=f"{S4}, 250 to 400 g",
    )
    density = wants.steel_density
    inner = layout.gap_radius + layout.gap
    drum = powder.cylinder_mass(density, inner, layout.drum, layout.face_length)
    body = powder.body_mass(
        density, layout.bore, layout.coil_height, layout.coil_length, layout.thickness, layout.length
    )
    rotor = powder.rotor_mass(density, layout.gap_radius, rim, layout.face_length, wants.rotor_web_thickness)
    for name, value, symbol, text in (
        ("rotor_mass", rotor, "m_rot", "Rotor, a rim with a web inside, without hub and shaft"),
        ("drum_mass", drum, "m_drum", "Drum of a stationary coil"),
        ("body_mass", body, "m_body", "Iron around the coil: a yoke tube, two pole rings with their flanges"),
    ):
        d.step(name, "kg", value, symbol=symbol, text=text, source=f"{S4} [P10]")
    copper = coil_blocks.declare_copper(d, section=copper_section, radius=layout.coil_radius, source=f"{S4} [P10]")
    tube = powder.cylinder_mass(density, layout.bore + layout.coil_height, layout.thickness, layout.length)
    fins = cooling.fin_mass(d, tube)
    if fins is not None:
        text = "Fins on the yoke tube"
        body += d.step("fins_mass", "kg", fins, symbol="m_fin", text=text, source=UNSOURCED)
    inertia = powder.ring_inertia(drum, layout.drum_radius, inner)
    d.step("drum_inertia", "kg*m2", inertia, symbol="J_drum", text="Inertia of the drum", source=f"{S4} [P10]")
    d.derive(
        "input_inertia",
        "kg*m2",
        coil.select(
            {
                "stationary": powder.ring_inertia(drum, layout.drum_radius, inner),
                "rotating": powder.ring_inertia(body, layout.outer_radius, layout.bore)
                + copper * layout.coil_radius**2,
            }
        ),
        symbol="J_in",
        text="Driving side: the drum, or the body with its rotating coil",
        source=f"{S4} [P10]",
    )
    diameter = d.derive(
        "outer_diameter", "mm", 2 * layout.outer_radius, symbol="D", text="Outside of the yoke", source="geometry"
    )
    sized = Sized(mass=rotor + drum + body + copper + filling, copper=copper, powder=filling)
    weight, extent = layer.declare_around(d, sized, layout)
    length = d.derive("length", "mm", extent, symbol="L", text=layer.along, source="geometry")
    d.derive("mass", "kg", weight, symbol="m", text=layer.mass_of, source=f"{S4} [P10]")
    asked = "requirement of the drive"
    if wants.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter",
            diameter,
            wants.outer_diameter_limit,
            "mm",
            text="The clutch fits the room across",
            source=asked,
        )
    if wants.length_limit is not None:
        d.at_most("length", length, wants.length_limit, "mm", text="The clutch fits the room along", source=asked)
    return sized


def _declare_remarks(d: Declaration, *, wants: Wants, coil: Choice, part: Part, layout: powder.Layout) -> None:
    rise = d.derived["coil_temperature_rise"].sx
    d.advise(
        "powder_calibration",
        True,
        "torque, flux density and coil power rest on the shear curve of the powder (saturation, half flux density), an "
        "unverified calibration: put measured values into table powders before the design is released",
        source=f"{S4} [P1], section 10",
    )
    d.advise(
        "unusual_powder_gap",
        np.logical_or(layout.gap < part.optional("gap_min"), layout.gap > part.optional("gap_max")),
        "the powder gap is outside what is usual for this powder",
        source=f"{S4}, section 9",
    )
    warning = SURFACE_WARNING - 273.15
    text = "Surface temperature that one maker names as the limit of powder clutches"
    d.constant("surface_warning", "degC", warning, symbol="T_warn", text=text, source=f"{S4} [P9]")
    declare_gravity(d)
    d.advise(
        "hot_surface",
        rise + wants.ambient_temperature > SURFACE_WARNING,
        "the surface is above 75 degC, which one maker names as the limit of powder clutches: look at seals and at "
        "what can be touched",
        source=f"{S4} [P9]",
    )
    d.advise(
        "powder_not_spread",
        wants.driver_speed**2 * layout.gap_radius < 10 * centrifugal.STANDARD_GRAVITY,
        "the centrifugal acceleration in the gap is below 10 g: the powder may lie at the bottom instead of all around",
        source=f"{S4}, checks X6 and X11",
    )
    d.advise(
        "slip_rings",
        coil.select({"stationary": 0.0, "rotating": 1.0}) > 0.5,
        "the rotating coil needs slip rings: their wear, and dust that must not reach the powder, are not in the model",
        source=f"{S4}, stationary and rotating coil",
    )
