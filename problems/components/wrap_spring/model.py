"""Wrap spring on its hubs: wire, coils, friction, the torque that it holds, its strength and its size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.declaration import Declaration, Part
from synth.errors import InputError
from synth.text.numbers import typed_number

from ...sources import NOT_IN_S2, S2
from . import formulas
from .models import MODELS, Refined
from .requirements import COILS_RANGE, HUB_DIAMETER_RANGE, Duty, Options

HUB_TABLE = "hub_diameters"
# Figures of a wire of one's own: name, unit, range [unit], symbol and text.
WIRE_FIGURES = (
    ("modulus", "N/mm2", 1e3, 1e6, "E_u", "Young's modulus of the wire"),
    ("density", "kg/m3", 500, 20000, "rho_u", "Density of the wire"),
    ("bending_allow", "N/mm2", 1, 1e4, "sigma_u", "Allowed static bending stress"),
    ("tensile_strength", "N/mm2", 1, 1e4, "R_u", "Least tensile strength"),
    ("endurance_amplitude", "N/mm2", 1, 1e4, "S_u", "Endurance amplitude in bending"),
)


@dataclass(frozen=True)
class Wire:
    """Wire of the spring, all in SI."""

    thickness: Any
    width: Any
    modulus: Any
    density: Any
    bending_allow: Any
    tensile_strength: Any
    endurance_amplitude: Any
    row: Part | None = None


@dataclass(frozen=True)
class Size:
    """Mass and outside of the spring with the hubs under it, or of the clutch, and what they are of."""

    mass: Any
    length: Any
    diameter: Any
    spring_mass: Any
    mass_of: str = "Spring and both hubs under it"
    along: str = "Length of the spring"
    outside: str = "Outside of the coils"


@dataclass(frozen=True)
class WrapSpring:
    """A spring as it is when fitted on its hubs, by a model, and what is asked of it; all in SI."""

    duty: Duty
    model: Refined
    wire: Wire
    hub_diameter: Any
    hub_radius: Any
    mean_radius: Any
    radius_ratio: Any
    per_hub: Any
    pair: Part
    exponent_low: Any
    exponent_high: Any

    def fitted_moment(self, interference: Any, free_radius: Any) -> Any:
        """Bending moment of the wire for one end of the tolerance of the fit [N m]."""
        curvature = formulas.curvature_change(interference, self.mean_radius, free_radius)
        return formulas.bending_moment(self.wire.modulus, self.wire.width, self.wire.thickness, curvature)

    def centrifugal_moment(self) -> Any:
        """Share of its bending moment that the spinning wire carries itself [N m]."""
        section = self.wire.density, self.wire.width, self.wire.thickness
        return self.model.centrifugal_moment(*section, self.mean_radius, self.duty.spring_speed)

    def bending_stress(self, moment: Any) -> Any:
        """Stress of the wire under a bending moment [Pa]."""
        return formulas.bending_stress(moment, self.wire.width, self.wire.thickness)

    def wire_stress(self, bending_stress: Any, moment: Any) -> Any:
        """Stress of the wire that is bent and, at the gap, stretched by a moment about the axis [Pa]."""
        tension = formulas.wire_tension(moment, self.mean_radius)
        return formulas.wire_stress(bending_stress, tension, self.wire.width, self.wire.thickness)

    def contact_pressure(self, moment: Any) -> Any:
        """Pressure on the hub where the wire carries a moment about the axis [Pa]."""
        return formulas.contact_pressure(moment, self.wire.width, self.hub_radius, self.mean_radius)

    def declare_closing(self, d: Declaration, torque: Any, *, needs: str | tuple[str, ...]) -> None:
        """Declare the least closing torque [N m], for which guards are needed, and its limit."""
        source, text = f"{S2}, eq. (18)-(20)", "Least torque at which the closing clutch slips: "
        text += "least friction, loosest fit, at spring speed"
        torque = d.derive("closing_torque", "N*m", torque, symbol="T_c", needs=needs, text=text, source=source)
        least, text = self.duty.slip_safety * self.duty.required_torque, "The clutch holds the required torque"
        d.at_least("closing_torque", torque, least, "N*m", text=text, source=f"{S2}, eq. (20)")

    def declare_load(
        self, d: Declaration, *, bending_stress: Any, moment: Any, load: Any, needs: str | tuple[str, ...] = ()
    ) -> tuple[Any, Any]:
        """Declare moment, stress and pressure of the loaded wire with their limits.

        Parameters
        ----------
        d : Declaration
            Takes the declarations.
        bending_stress : symbol
            Largest size of the bending stress [Pa].
        moment : symbol
            Largest bending moment of the fitted wire [N m].
        load : symbol
            Torque that the wire sees [N m].
        needs : str or tuple of str
            Guards without which the moment does not exist.

        Returns
        -------
        tuple
            Stress of the wire and peak pressure [Pa].
        """
        text = "Bending moment of the fitted wire, at the tightest fit; below 0 for a clearance"
        source = f"{S2}, eq. (4)"
        d.derive("bending_moment", "N*m", moment, symbol="M_b", needs=needs, text=text, source=source)
        stress, text = self.wire_stress(bending_stress, moment + load), "Largest stress of the loaded wire"
        source = f"{S2}, eq. (8), with the tension of the loaded coil"
        stress = d.derive("wire_stress", "N/mm2", stress, symbol="sigma", text=text, source=source)
        pressure, text = self.contact_pressure(moment + load), "Largest pressure of the wire on the hub, at the gap"
        source = f"{S2}, eq. (22), corrected"
        pressure = d.derive("contact_pressure", "N/mm2", pressure, symbol="p_max", text=text, source=source)
        for name, value, most, text, equation in (
            ("wire_stress", stress, self.wire.bending_allow, "The wire does not yield", "eq. (8) and (18)"),
            ("contact_pressure", pressure, self.pair.p_allow, "Wire and hub stand the pressure", "eq. (22), corrected"),
        ):
            d.at_most(name, value, most, "N/mm2", text=text, source=f"{S2}, {equation}")
        second = formulas.second_moment(self.wire.width, self.wire.thickness)
        tension = formulas.wire_tension(moment + load, self.mean_radius)
        for name, unit, value, symbol, text in (
            ("second_moment", "mm4", second, "I_w", "Of the wire"),
            ("bending_stress", "N/mm2", bending_stress, "sigma_b", "Largest bending stress of the fitted wire"),
            ("wire_tension", "N", tension, "N_w", "Tension of the loaded wire"),
        ):
            d.step(name, unit, value, symbol=symbol, text=text, source=f"{S2}, eq. (4) and (8)")
        return stress, pressure

    def declare_size(self, d: Declaration, *, fixed_coils: Any = None) -> Size:
        """Declare the coils and their masses; size of the spring with the hubs under it.

        Parameters
        ----------
        d : Declaration
            Takes the declarations.
        fixed_coils : symbol, optional
            Coils anchored on the second hub; without it both hubs have coils_per_hub [-].
        """
        duty, wire = self.duty, self.wire
        total, text = formulas.total_coils(self.per_hub, duty.gap_coils, fixed_coils), "Coils of the whole spring"
        total = d.derive("total_coils", "-", total, symbol="n_tot", text=text, source="geometry")
        length = formulas.spring_length(total, wire.width, duty.coil_gap)
        spring = formulas.spring_mass(wire.density, wire.width, wire.thickness, self.mean_radius, total)
        hubs = formulas.hub_mass(duty.hub_density, self.hub_diameter, duty.bore_diameter, length)
        pitch = wire.width + duty.coil_gap
        lengths = [
            ("spring_mass", "kg", spring, "m_sp", "Spring"),
            ("hub_mass", "kg", hubs, "m_hub", "Both hubs under the spring"),
            ("coil_pitch", "mm", pitch, "p_c", "From coil to coil"),
            ("grip_length", "mm", self.per_hub * pitch, "L_n", "Length of the coils on one hub"),
            ("gap_length", "mm", duty.gap_coils * pitch, "L_gap", "Length of the coils over the gap"),
        ]
        if fixed_coils is not None:
            text = "Length of the coils anchored on the second hub"
            lengths.append(("fixed_length", "mm", fixed_coils * pitch, "L_fix", text))
        for name, unit, value, symbol, text in lengths:
            d.step(name, unit, value, symbol=symbol, text=text, source="geometry")
        return Size(
            mass=spring + hubs, length=length, diameter=self.hub_diameter + 2 * wire.thickness, spring_mass=spring
        )


@dataclass(frozen=True)
class Built:
    """Spring and hubs that are declared, with the requirements of their fit; clearance of released coils [m]."""

    spring: WrapSpring
    wants: Any
    size: Size
    clearance: Any = 0.0


def declare_spring(d: Declaration, *, options: Options, duty: Duty, pairs: Sequence[str]) -> WrapSpring:
    """Declare wire, hub diameter, coils and friction pair, with the limits of their shape and of the belt exponent.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    options : Options
        Options of the family.
    duty : Duty
        Requirements.
    pairs : sequence of str
        Conditions on friction pairs beside that they suit.
    """
    wire, model = _declare_wire(d, catalogue=options.wire_choice == "catalogue"), MODELS[options.model]
    grid, text = hub_grid(d, ladder=options.hub_ladder), "Outer diameter of both hubs"
    diameter = d.variable(
        "hub_diameter", "mm", *HUB_DIAMETER_RANGE, grid=grid, symbol="d_h", text=text, source=f"{S2}, 2 r"
    )
    per_hub = d.count("coils_per_hub", *COILS_RANGE, step=0.5, symbol="n", text="Coils on one hub", source=f"{S2}, n")
    text = "Mean radius of the fitted coils; model seed: the hub radius"
    mean = model.mean_radius(diameter, wire.thickness)
    mean = d.derive("mean_coil_radius", "mm", mean, symbol="r_m", text=text, source=f"{S2}, r")
    _limit_coiling(d, duty=duty, wire=wire, mean=mean)
    radius, ratio, pair = diameter / 2, model.radius_ratio(diameter, wire.thickness), _declare_pair(d, pairs)
    low, high = (formulas.belt_exponent(mu, per_hub, ratio) for mu in (pair.mu_min, pair.mu_max))
    high = _declare_exponents(d, duty=duty, low=low, high=high)
    return WrapSpring(duty, model, wire, diameter, radius, mean, ratio, per_hub, pair, low, high)


def hub_grid(d: Declaration, *, ladder: str) -> Any:
    """Makeable hub diameters: a series, or the values of table hub_diameters in mm.

    Raises
    ------
    InputError
        When a table of the user's own has no diameter in the range of the variable.
    """
    if ladder != "hub_diameters":
        return ladder
    low, high = HUB_DIAMETER_RANGE
    diameters = 1000 * d.numbers(HUB_TABLE, "diameter")
    # Rounding to a nanometre undoes what the conversion to metres adds.
    inside = sorted({round(float(x), 6) for x in diameters if low <= x <= high})
    if not inside:
        raise InputError(
            f"table {HUB_TABLE}, column diameter",
            None,
            f"a diameter from {typed_number(low)} to {typed_number(high)} mm",
        )
    return inside


def _declare_wire(d: Declaration, *, catalogue: bool) -> Wire:
    """Declare the wire: a slot, or two variables and requirements for its material."""
    figures = {
        name: d.requirement(
            f"wire_{name}",
            unit,
            lower=lower,
            upper=upper,
            optional=catalogue,
            symbol=symbol,
            text=f"{text}; for wire choice custom, where it must be given",
            source="data sheet of the wire",
            group="material",
        )
        for name, unit, lower, upper, symbol, text in WIRE_FIGURES
    }
    if not catalogue:
        thick, wide = (
            d.variable(f"wire_{name}", "mm", 0.3, upper, grid=0.1, symbol=symbol, text=text, source=f"{S2}, {symbol}")
            for name, upper, symbol, text in (
                ("thickness", 15, "a", "Radial wire thickness"),
                ("width", 30, "b", "Axial wire width"),
            )
        )
        return Wire(thick, wide, **figures)
    if any(value is not None for value in figures.values()):
        d.advise(
            "wire_material_unused",
            True,
            "the wire comes from the catalogue: wire modulus and the other figures of a wire of one's own are not "
            "used; they belong to wire choice custom",
        )
    text = "Square or rectangular wire of the spring"
    row = d.part("wire", "spring_wire_flat", symbol="wire", text=text, source="table spring_wire_flat")
    return Wire(
        thickness=row.radial_thickness_a,
        width=row.axial_width_b,
        modulus=row.E,
        density=row.density,
        bending_allow=row.bending_allow_static,
        tensile_strength=row.Rm_min,
        endurance_amplitude=row.endurance_amplitude,
        row=row,
    )


def _limit_coiling(d: Declaration, *, duty: Duty, wire: Wire, mean: Any) -> None:
    """Limit the spring index, and remark wire that is hard to coil to a mean radius [m]."""
    index, text, source = 2 * mean / wire.thickness, "The wire can be coiled", "coiling practice"
    d.at_least("spring_index", index, duty.spring_index_min, "-", text=text, source=source)
    d.advise(
        "unwound_shape",
        np.logical_or(wire.thickness > 4 * wire.width, wire.width > 6 * wire.thickness),
        "wire thicker than 4 times its width, or wider than 6 times its thickness, is hard to coil flat",
        source=source,
    )
    d.advise(
        "keystoning",
        formulas.keystone_growth(0.3, wire.width, wire.thickness, mean) > duty.coil_gap,
        "coiling widens the inner edge of the wire by more than coil gap: neighbouring coils would rub on each other",
        source="anticlastic bending",
    )


def _declare_pair(d: Declaration, conditions: Sequence[str]) -> Part:
    """Declare the slot friction_pair of pairs that meet conditions."""
    table, text = "friction_materials", "Wire and the hub surface it grips"
    where = ("'wire on hub' in surfaces", *conditions)
    pair = d.part("friction_pair", table, where=where, symbol="pair", text=text, source=f"table {table}")
    text = "a friction pair whose mu_min is at most its mu_max"
    d.refuse("friction_range_reversed", pair.mu_min > pair.mu_max, text)
    return pair


def _declare_exponents(d: Declaration, *, duty: Duty, low: Any, high: Any) -> Any:
    """Declare the belt exponents at the ends of the friction, with limit and remarks; the symbol of the high one."""
    text, source = "Belt exponent of one hub at the highest friction", f"{S2}, mu alpha in eq. (18)"
    high = d.derive("belt_exponent", "-", high, symbol="beta_hi", text=text, source=source)
    if duty.belt_exponent_limit is not None:
        text = "The clutch still slips before everything else breaks"
        d.at_most("belt_exponent", high, duty.belt_exponent_limit, "-", text=text, source=NOT_IN_S2)
    d.advise(
        "locks_at_any_peak",
        high > 6,
        "at the highest friction the belt exponent is above 6: any peak is locked instead of slipping through; "
        "belt exponent limit 6 keeps the search to clutches that can slip",
        source=NOT_IN_S2,
    )
    d.advise(
        "locked",
        high > formulas.LOCKED_BELT_EXPONENT,
        "at the highest friction the clutch is locked; the belt exponent counts up to 50 only",
        source=NOT_IN_S2,
    )
    text = "Belt exponent of one hub at the least friction"
    d.step("belt_exponent_low", "-", low, symbol="beta_lo", text=text, source=source)
    return high
