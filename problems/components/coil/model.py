"""The coil of an electromagnet: winding, current, heat and their limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Block, Declaration, Requirement, Slot, Variable

from ...mechanics import magnetics
from ...practice import UNSOURCED
from ...sources import S4, TYPICAL

SATURATION, STABILITY = "iron_saturation", "thermal_stability"  # guards
WHOLE = 1e-9  # of a turn: what lacks no more to a whole number is rounding


class CoilRequirements(Block):
    """Requirements of a coil and its iron, all in SI."""

    group = "actuator"

    iron_flux_limit = Requirement(
        "T",
        1.5,
        lower=0.1,
        upper=1.9,
        symbol="B_fe_max",
        text="Largest flux density of the iron",
        source=f"{S4}, section 6.1",
        group="material",
    )
    leakage_factor = Requirement(
        "-",
        1.15,
        lower=1,
        upper=3,
        symbol="leak",
        text="Flux of the iron outside over flux of the working gap",
        source=f"{S4} [P4]",
        group="model",
    )
    iron_reluctance = Requirement(
        "A/(m*T)",
        160,
        lower=1,
        upper=1e5,
        symbol="a_fe",
        text="Froehlich coefficient of the iron, by default mild steel",
        source=f"{S4} [P3]",
        group="material",
    )
    iron_saturation = Requirement(
        "T",
        2.0,
        lower=1.6,
        upper=2.5,
        symbol="B_s",
        text="Flux density that saturated iron does not reach",
        source=f"{S4} [P3]",
        group="material",
    )
    winding_factor = Requirement(
        "-",
        0.85,
        lower=0.2,
        upper=1.15,
        symbol="k_wind",
        text=f"Turns over window area per square of the wire ({TYPICAL})",
        source=f"{S4} [P6]",
    )
    coil_voltage_limit = Requirement(
        "V", 24, lower=1, upper=1000, symbol="U_max", text="Voltage of the supply", source=f"{S4}, section 6.1"
    )
    current_density_limit = Requirement(
        "A/mm2",
        5,
        lower=0.1,
        upper=50,
        symbol="J_max",
        text="Largest current density of the copper",
        source=f"{S4}, section 6.1",
    )
    coil_power_limit = Requirement(
        "W",
        60,
        lower=0.1,
        upper=1e5,
        symbol="P_coil_max",
        text="Largest power of the coil",
        source=f"{S4}, section 6.1; its source takes about 50 W",
    )
    still_heat_transfer = Requirement(
        "W/(m2*K)",
        12,
        lower=1,
        upper=5000,
        symbol="h_still",
        text=f"Surface coefficient of a body at rest, convection and radiation ({TYPICAL}; with rules of practice, and "
        "in a powder clutch, that of cooling)",
        source=f"{S4} [P7]",
        group="model",
    )


class CoilRules(Block):
    """Rules for coils, all in SI."""

    group = "practice"

    over_excitation = Requirement(
        "-",
        2,
        lower=1.01,
        upper=100,
        symbol="k_over",
        text=f"Voltage while the current rises over that of the steady coil ({UNSOURCED})",
        source=UNSOURCED,
    )
    coil_aspect_min = Requirement(
        "-",
        0.5,
        lower=0.01,
        upper=10,
        symbol="k_coil_min",
        text=f"Least length over height of the coil window ({UNSOURCED})",
        source=UNSOURCED,
    )
    coil_aspect_max = Requirement(
        "-",
        3,
        lower=0.1,
        upper=100,
        symbol="k_coil_max",
        text=f"Largest length over height of the coil window ({UNSOURCED})",
        source=UNSOURCED,
    )
    voltage_use_min = Requirement(
        "-",
        0.85,
        lower=0,
        upper=1,
        symbol="u_U_min",
        text=f"Least share of coil voltage limit that the coil takes: it is wound for its supply ({UNSOURCED})",
        source=UNSOURCED,
    )
    coil_rise_max = Requirement(
        "K", 80, lower=1, upper=1000, symbol="dT_c_max", text="Largest rise by the loss of the coil", source=UNSOURCED
    )


class CoilUnknowns(Block):
    """What the search decides of a coil."""

    coil_length = Variable(
        "mm", 5, 100, grid=1, symbol="l_m", text="Axial length of the coil window", source=f"{S4} [P6]"
    )
    coil_height = Variable(
        "mm", 5, 80, grid=1, symbol="h_c", text="Radial height of the coil window", source=f"{S4} [P6]"
    )
    yoke_thickness = Variable(
        "mm", 3, 40, grid=0.5, symbol="t_y", text="Thickness of the iron around the coil", source=f"{S4} [P4]"
    )
    flux_density = Variable(
        "T",
        0.02,
        1.6,
        symbol="B",
        text="Flux density in the working gap; ampere turns follow from it",
        source=f"{S4} [P4], section 8",
    )
    winding_wire = Slot("winding_wire", symbol="wire", text="Enamelled copper wire", source="table winding_wire")


@dataclass(frozen=True)
class Winding:
    """What a family needs of the winding, all in SI: copper of all turns and loss of the hot copper per NI**2."""

    copper_section: Any
    unit_loss: Any


@dataclass(frozen=True)
class Surroundings:
    """What heats and cools the body of a coil beside its copper, all in SI.

    ``brush_drop`` is the voltage of both brushes, 0 without slip rings; ``temperature_limit`` the least of the limits.
    """

    ambient_temperature: Any
    temperature_limit: Any
    heat_transfer: Any
    surface: Any
    other_heat: Any
    brush_drop: Any = 0.0


def declare_coil_requirements(d: Declaration, **defaults: Any) -> CoilRequirements:
    """Declare the requirements of the block coil and the refusals that concern them alone."""
    wants = d.block(CoilRequirements, **defaults)
    d.refuse(
        "iron_saturates",
        wants.iron_flux_limit >= wants.iron_saturation,
        "an iron_flux_limit below iron_saturation, which no field reaches",
    )
    return wants


def refuse_bad_window(d: Declaration, rules: CoilRules) -> None:
    """Refuse windows that no coil can have."""
    d.refuse(
        "bad_coil_aspect",
        rules.coil_aspect_min > rules.coil_aspect_max,
        "a coil_aspect_min of at most coil_aspect_max; otherwise no window satisfies both",
    )


def declare_saturation(d: Declaration, *, wants: CoilRequirements, iron_flux_density: Any) -> None:
    """Declare the guard of the iron: its field exists only below saturation."""
    d.at_most(
        SATURATION,
        iron_flux_density,
        wants.iron_saturation,
        "T",
        guard=True,
        text="The iron is not saturated; no ampere-turns make a flux beyond",
        source=f"{S4} [P3], section 9",
    )


def declare_winding(
    d: Declaration,
    *,
    wants: CoilRequirements,
    unknowns: CoilUnknowns,
    ampere_turns: Any,
    bore_radius: Any,
    around: Surroundings,
) -> Winding:
    """Declare winding, current, voltage, temperature and power of the coil with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wants : CoilRequirements
        Requirements of the block.
    unknowns : CoilUnknowns
        Window and wire.
    ampere_turns : symbol
        What the circuit needs [A].
    bore_radius : symbol
        Inside of the coil [m].
    around : Surroundings
        What heats and cools the body.

    Returns
    -------
    Winding
        Copper and its loss.
    """
    wire = unknowns.winding_wire
    # Of one row of the table alone, so that it is known per wire.
    copper_share = wants.winding_factor * magnetics.copper_fill(wire.copper_area, wire.overall_diameter)
    coil = _Coil(wants, unknowns, bore_radius, copper_share, unknowns.coil_length * unknowns.coil_height)
    wound = _declare_turns(d, coil, ampere_turns)
    hot = _declare_heat(d, coil, wound, around)
    _declare_supply(d, coil, wound, hot, around)
    return Winding(hot.section, coil.cold_loss(1.0) * hot.hot_ratio)


@dataclass(frozen=True)
class _Coil:
    """A coil: requirements, window and wire, inside [m], copper over the window, and area of the window [m2]."""

    wants: CoilRequirements
    unknowns: CoilUnknowns
    bore_radius: Any
    copper_share: Any
    window: Any

    @property
    def mean_radius(self) -> Any:
        """Mean radius of the turns [m]."""
        return self.bore_radius + self.unknowns.coil_height / 2

    def cold_loss(self, ampere_turns: Any) -> Any:
        """Copper loss of ampere-turns at 20 degC [W]."""
        height, length = self.unknowns.coil_height, self.unknowns.coil_length
        return magnetics.cold_copper_loss(ampere_turns, self.bore_radius, height, length, self.copper_share)


@dataclass(frozen=True)
class _Wound:
    """Turns that fill the window, turns to wind, and ampere-turns [A]."""

    filled: Any
    turns: Any
    ampere_turns: Any


@dataclass(frozen=True)
class _Hot:
    """The hot coil: copper of all turns [m2], cold and runaway loss [W], heat and that of brushes [W], resistance.

    ``ratio`` is the resistance at ambient temperature over that at 20 degC, ``rise`` what heating adds to it.
    """

    section: Any
    cold: Any
    runaway: Any
    brushes: Any
    heat: Any
    ratio: Any
    rise: Any

    @property
    def hot_ratio(self) -> Any:
        """Resistance over that at 20 degC."""
        return self.ratio + self.rise


def _declare_turns(d: Declaration, coil: _Coil, ampere_turns: Any) -> _Wound:
    """Declare turns, ampere-turns, current and current density."""
    wants, source = coil.wants, f"{S4} [P6]"
    filled = d.step(
        "window_turns",
        "-",
        magnetics.turns(wants.winding_factor, coil.window, coil.unknowns.winding_wire.overall_diameter),
        symbol="N_fill",
        text="Turns that fill the window, as its heat is computed with them",
        source=source,
    )
    floor, text = np.maximum(np.floor(filled + WHOLE), 1.0), "Turns to wind: whole ones that the window holds"
    turns = d.derive("turns", "-", floor, symbol="N_t", text=text, source=source)
    text = "Ampere-turns of the circuit: gaps and iron"
    ampere_turns = d.derive(
        "ampere_turns", "A", ampere_turns, symbol="NI", needs=SATURATION, text=text, source=f"{S4} [P4]"
    )
    current, text = ampere_turns / turns, "Current of the coil"
    d.derive("current", "A", current, symbol="I_c", needs=SATURATION, text=text, source=source)
    density, text = ampere_turns / (coil.copper_share * coil.window), "Current per copper area"
    density = d.derive("current_density", "A/mm2", density, symbol="J_c", needs=SATURATION, text=text, source=source)
    return _Wound(filled, turns, ampere_turns)


def _declare_heat(d: Declaration, coil: _Coil, wound: _Wound, around: Surroundings) -> _Hot:
    """Name losses and resistance of the coil, and declare that it does not heat up without end."""
    cold = coil.cold_loss(wound.ampere_turns)
    runaway = magnetics.runaway_loss(around.heat_transfer, around.surface)
    ratio = magnetics.resistance_ratio(around.ambient_temperature)
    # As all heat by the turns that fill the window: whole ones jump from size to size, and proofs take much longer.
    brushes = around.brush_drop * wound.ampere_turns / wound.filled
    heat = around.other_heat + brushes
    _name_constants(d)
    _name_body(d, coil, wound.turns, around)
    if not isinstance(around.brush_drop, float):
        d.step("brush_loss", "W", brushes, symbol="P_br", text="Loss of both brushes", source=f"{S4} [P8]")
        text = "What heats the body beside its copper"
        d.step("body_heat", "W", heat, symbol="Q_body", text=text, source=f"{S4} [P7]")
    d.at_most(
        STABILITY,
        cold / runaway,
        0.9,
        "-",
        guard=True,
        text="A hotter coil has more resistance; at 1 it heats up without end under constant current",
        source=f"{S4} [P7]",
    )
    hot = _Hot(
        section=coil.copper_share * coil.window,
        cold=cold,
        runaway=runaway,
        brushes=brushes,
        heat=heat,
        ratio=ratio,
        rise=magnetics.resistance_rise(cold, runaway, ratio, heat),
    )
    _name_copper(d, coil, hot)
    return hot


def _name_copper(d: Declaration, coil: _Coil, hot: _Hot) -> None:
    """Name the copper, what it loses and its resistance."""
    density = magnetics.COPPER_DENSITY * coil.copper_share
    for name, unit, value, symbol, text in (
        ("copper_share", "-", coil.copper_share, "k_cu", "Copper over the area of the window"),
        ("copper_section", "mm2", hot.section, "A_cu", "Copper of all turns"),
        ("coil_density", "kg/m3", density, "rho_coil", "Copper over room of the coil"),
        ("cold_copper_loss", "W", hot.cold, "P_20", "Copper loss at 20 degC"),
        ("runaway_loss", "W", hot.runaway, "P_run", "Copper loss at 20 degC at which the coil heats up without end"),
        ("ambient_ratio", "-", hot.ratio, "k_amb", "Resistance at ambient temperature over that at 20 degC"),
        ("resistance_rise", "-", hot.rise, "k_rise", "Rise of the resistance by heating, over that at 20 degC"),
        ("hot_ratio", "-", hot.hot_ratio, "k_hot", "Resistance of the hot coil over that at 20 degC"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=f"{S4} [P6], [P7]")


def _declare_supply(d: Declaration, coil: _Coil, wound: _Wound, hot: _Hot, around: Surroundings) -> None:
    """Declare temperature, voltage and power of the hot coil, and the limits of all that it is fed with."""
    wants, ambient = coil.wants, around.ambient_temperature
    needs = (SATURATION, STABILITY)
    rise = d.derive(
        "coil_temperature_rise",
        "K",
        hot.rise / magnetics.COPPER_COEFFICIENT,
        symbol="dT_c",
        needs=needs,
        text="Coil and body over ambient, steady",
        source=f"{S4} [P7]",
    )
    text = "Coil and body, steady"
    d.step("coil_temperature", "degC", ambient + rise, symbol="T_c", text=text, source=f"{S4} [P7]")
    # R20 I with the turns cancelled, so that bounds use the ampere-turns once.
    resistance = magnetics.coil_resistance(coil.mean_radius, 1.0, coil.unknowns.winding_wire.copper_area)
    voltage = resistance * wound.ampere_turns * hot.hot_ratio + around.brush_drop
    text = "Voltage of the hot coil, with brushes where there are any"
    d.derive("coil_voltage", "V", voltage, symbol="U", needs=needs, text=text, source=f"{S4} [P8]")
    d.derive(
        "coil_power",
        "W",
        magnetics.hot_copper_loss(hot.cold, hot.runaway, hot.ratio, hot.heat) + hot.brushes,
        symbol="P_coil",
        needs=needs,
        text="Loss of the hot copper and of brushes where there are any",
        source=f"{S4} [P7], [P8]",
    )
    _limit_supply(d, wants, around.temperature_limit - ambient)
    text = "The window holds the wire at least once"
    d.at_least("turns", wound.filled, 1.0, "-", text=text, source=f"{S4}, section 9")


def _limit_supply(d: Declaration, wants: CoilRequirements, hottest: Any) -> None:
    """Declare the limits of the hot coil, whose rise has a limit [K], and of its supply."""
    drive, voltage = "requirement of the drive", "The supply gives the voltage, also for the hot coil"
    loaded, source = "The copper is not loaded too much", f"{S4}, section 6.1"
    for name, of, most, unit, text, reason in (
        ("coil_temperature", "coil_temperature_rise", hottest, "K", "Nothing in the body gets too hot", f"{S4} [P7]"),
        ("coil_power", "coil_power", wants.coil_power_limit, "W", "The supply gives the power", drive),
        ("coil_voltage", "coil_voltage", wants.coil_voltage_limit, "V", voltage, drive),
        ("current_density", "current_density", wants.current_density_limit, "A/mm2", loaded, source),
    ):
        d.at_most(name, d.derived[of].sx, most, unit, text=text, source=reason)


def declare_copper(d: Declaration, *, section: Any, radius: Any, source: str) -> Any:
    """Name the mass of the copper of all turns, of a section [m2] on a mean radius [m], and return it [kg]."""
    mass = magnetics.copper_mass(radius, section)
    d.step("copper_mass", "kg", mass, symbol="m_cu", text="Copper of the coil", source=source)
    return mass


def declare_rise_time(d: Declaration, *, rules: CoilRules, winding: Winding, linkage: Any) -> Any:
    """Declare the time in which the current rises and the objective that asks for it; return it [s].

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : CoilRules
        Rules for coils.
    winding : Winding
        Copper and its loss.
    linkage : symbol
        Flux of the coil over its ampere-turns [Wb/A].

    Returns
    -------
    symbol
        Rise time [s].
    """
    text = "Loss of the hot copper over the square of the ampere-turns"
    d.step("unit_loss", "W/A2", winding.unit_loss, symbol="p_NI", text=text, source=f"{S4} [P7]")
    text = "Flux of the coil over its ampere-turns"
    d.step(
        "linkage",
        "V*s/A",
        linkage,
        symbol="Phi_NI",
        text=text,
        source="inductance over the square of the turns; derived",
    )
    rise = d.derive(
        "rise_time",
        "s",
        magnetics.current_rise_time(magnetics.time_constant(linkage, winding.unit_loss), rules.over_excitation),
        symbol="t_rise",
        needs=(SATURATION, STABILITY),
        text="Current of the hot coil up to its steady value, with over excitation",
        source="L/R of the circuit; derived",
    )
    d.objective("rise_time", default=False)
    return rise


def limit_coil(d: Declaration, *, rules: CoilRules, wants: CoilRequirements, unknowns: CoilUnknowns) -> None:
    """Declare the limits that an engineer adds to every coil: window, own heat, and the supply it is wound for.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : CoilRules
        What the limits go by.
    wants : CoilRequirements
        Requirements of the coil.
    unknowns : CoilUnknowns
        Window and wire.
    """
    length, height = unknowns.coil_length, unknowns.coil_height
    d.at_least(
        "coil_aspect_min",
        length,
        rules.coil_aspect_min * height,
        "mm",
        text="The coil is not a flat disc",
        source=UNSOURCED,
    )
    d.at_most(
        "coil_aspect_max",
        length,
        rules.coil_aspect_max * height,
        "mm",
        text="The coil is not a long tube",
        source=UNSOURCED,
    )
    d.at_least(
        "coil_voltage_min",
        d.derived["coil_voltage"].sx,
        rules.voltage_use_min * wants.coil_voltage_limit,
        "V",
        text="The coil is wound for its supply",
        source=UNSOURCED,
    )
    by_itself, text = d.derived["coil_power"].sx / d.steps["coil_conductance"].sx, "The coil stays cool by itself"
    d.at_most("coil_rise", by_itself, rules.coil_rise_max, "K", text=text, source=UNSOURCED)


def _name_constants(d: Declaration) -> None:
    """Name the constants of copper and of the field."""
    cold = magnetics.COPPER_REFERENCE - 273.15
    for name, unit, number, symbol, text, source in (
        ("magnetic_constant", "T*m/A", magnetics.MU_0, "mu_0", "Magnetic constant", "4 pi 1e-7"),
        ("copper_resistivity", "ohm*m", magnetics.COPPER_RESISTIVITY, "rho_e", "Copper at 20 degC", f"{S4} [P6]"),
        ("copper_coefficient", "1/K", magnetics.COPPER_COEFFICIENT, "alpha_cu", "Of its resistance", f"{S4} [P6]"),
        ("copper_density", "kg/m3", magnetics.COPPER_DENSITY, "rho_cu", "Density of copper", "material constant"),
        ("copper_reference", "degC", cold, "T_20", "Temperature of the figures for copper", f"{S4} [P6]"),
    ):
        d.constant(name, unit, number, symbol=symbol, text=text, source=source)


def _name_body(d: Declaration, coil: _Coil, turns: Any, around: Surroundings) -> None:
    """Name what heats and cools the body of the coil; curves over current and temperature read it."""
    area, mean_radius = coil.unknowns.winding_wire.copper_area, coil.mean_radius
    conductance, most = around.heat_transfer * around.surface, coil.wants.current_density_limit * area
    resistance = magnetics.coil_resistance(mean_radius, turns, area)
    limit, other, drop = around.temperature_limit, around.other_heat, around.brush_drop
    warm, wire = f"{S4} [P7]", f"{S4} [P6]"
    for name, unit, value, symbol, text, source in (
        ("coil_surface", "cm2", around.surface, "S_c", "Outside that gives off the heat of the body", warm),
        ("coil_conductance", "W/K", conductance, "G_c", "Heat that the body gives off per kelvin over ambient", warm),
        (
            "coil_temperature_limit",
            "degC",
            limit,
            "T_c_allow",
            "The least of the temperatures that its parts stand",
            warm,
        ),
        ("coil_other_heat", "W", other, "P_other", "What heats the body beside its copper and its brushes", warm),
        ("coil_brush_drop", "V", drop, "U_brushes", "Voltage of both brushes, 0 without slip rings", f"{S4} [P8]"),
        ("wire_current_limit", "A", most, "I_max", "Current at current density limit", f"{S4}, section 6.1"),
        ("coil_radius", "mm", mean_radius, "r_c", "Mean radius of the coil", "geometry"),
        ("coil_resistance", "ohm", resistance, "R_20", "Resistance of the coil at 20 degC", wire),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=source)
