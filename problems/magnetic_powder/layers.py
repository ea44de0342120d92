"""What stands on the declared powder clutch: nothing, the complete clutch, rules of practice, or both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from synth.declaration import Block, Declaration, Part, Requirement

from .. import cost
from ..components.coil import model as coil_blocks
from ..components.shaft.model import ShaftSize, declare_shaft, shaft_for
from ..duty import Start, cooling
from ..mechanics import centrifugal
from ..practice import UNSOURCED, by_scope
from ..sources import S4, TYPICAL
from . import formulas as powder

if TYPE_CHECKING:
    from .model import Wants

PARTS = 7  # rotor, drum or slip rings, body, coil, two shields and shaft


class Bore(Block):
    """What the rotor is bored for, in SI."""

    group = "envelope"

    shaft_radius = Requirement(
        "mm",
        12,
        lower=1,
        upper=200,
        symbol="r_shaft",
        text=f"Shaft with hub inside the rotor ({TYPICAL})",
        source=f"{S4}, section 6.1",
    )


class Rise(Block):
    """How soon the torque is there, all in SI."""

    group = "practice"

    rise_time_limit = Requirement(
        "s",
        0.2,
        lower=0.001,
        upper=60,
        symbol="t_rise_max",
        text="Longest rise of the current (ten units; a maker's torque rises in 0.17 to 0.26 s)",
        source=f"{UNSOURCED}; {S4}, check X11",
    )


class PowderRules(coil_blocks.CoilRules):
    """Rules for powder clutches, all in SI."""

    group = "practice"

    spread_acceleration = Requirement(
        "-",
        5,
        lower=0,
        upper=1000,
        symbol="k_spread",
        text=f"Least centrifugal acceleration in the gap over gravity: the powder must be thrown out ({UNSOURCED})",
        source=f"{UNSOURCED}; {S4}, check X11",
    )
    powder_per_torque_max = Requirement(
        "g/(N*m)",
        5,
        lower=0.01,
        upper=1000,
        symbol="k_pow",
        text="Largest mass of powder over required torque (makers take 1.2 to 2.5)",
        source=UNSOURCED,
    )
    powder_load_limit = Requirement(
        "W/kg",
        1500,
        lower=1,
        upper=1e6,
        symbol="k_load",
        text="Slip heat over mass of powder above which a remark comes; with forced air five units stand 10 000",
        source=f"{UNSOURCED}; {S4} [P9]",
    )


@dataclass(frozen=True)
class Sized:
    """Mass of a powder clutch as its formulas size it, and of copper and powder in it [kg]."""

    mass: Any
    copper: Any
    powder: Any


@dataclass(frozen=True)
class Built:
    """Powder clutch that is declared; ``slip_heat`` [W]: None where it does not slip."""

    iron: coil_blocks.CoilRequirements
    unknowns: coil_blocks.CoilUnknowns
    part: Part
    circuit: powder.Circuit
    sized: Sized
    winding: coil_blocks.Winding
    slip_heat: Any


class Sources:
    """The powder clutch by the formulas of its source, without shields and shaft."""

    mass_of: ClassVar[str] = "Rotor without shaft, drum of a stationary coil, body, copper and powder"
    along: ClassVar[str] = "Length of the body"
    objectives: ClassVar[tuple[str, ...]] = ("coil_power", "input_inertia")  # where the question names none
    cooling: ClassVar[str] = "still_air"  # default of a clutch that slips all the time

    ruled: ClassVar[bool] = False

    def __init__(self, d: Declaration, wants: Wants) -> None:
        """Declare the bore of the rotor, and the rise of the torque where it counts."""
        self.wants = wants
        self.rise = d.block(Rise) if self.ruled or isinstance(wants, Start) else None
        self.bore = self.declare_bore(d)

    def declare_bore(self, d: Declaration) -> Bore:
        """The bore of the rotor."""
        return d.block(Bore)

    def declare_around(self, d: Declaration, sized: Sized, layout: powder.Layout) -> tuple[Any, Any]:
        """Declare what is around the parts; mass [kg] and length [m] that count."""
        return sized.mass, layout.length

    def declare_rules(self, d: Declaration, built: Built) -> None:
        """Declare limits by rules."""

    def declare_cost(self, d: Declaration, built: Built) -> None:
        """Declare cost and objectives of a complete clutch."""


class WithBody(Sources):
    """The powder clutch with shields and shaft, whose mass is known beside that of its parts."""

    def around(self, layout: powder.Layout) -> Any:
        """Mass of shields and shaft [kg]."""
        shaft = powder.shaft_mass(self.wants.steel_density, self.bore.shaft_radius, layout.length)
        return powder.shields_mass(layout.outer_radius) + shaft

    def declare_around(self, d: Declaration, sized: Sized, layout: powder.Layout) -> tuple[Any, Any]:
        """Declare shields and shaft, of which nothing counts, and the proportions that they go by."""
        shields = powder.shields_mass(layout.outer_radius)
        shaft = powder.shaft_mass(self.wants.steel_density, self.bore.shaft_radius, layout.length)
        d.step("shields_mass", "kg", shields, symbol="m_sh", text="Both bearing shields", source=UNSOURCED)
        d.step("shaft_mass", "kg", shaft, symbol="m_shaft", text="Shaft with its ends", source=UNSOURCED)
        load = 2 * powder.SHIELD_DENSITY * powder.SHIELD_THICKNESS
        text = "Both shields over their area: light metal of 8 mm each"
        d.constant("shields_area_mass", "kg/m2", load, symbol="q_sh", text=text, source=UNSOURCED)
        text = "What the shaft is longer than the body"
        d.constant("shaft_ends", "mm", 1000 * powder.SHAFT_ENDS, symbol="l_ends", text=text, source=UNSOURCED)
        d.derive("part_mass", "kg", sized.mass, symbol="m_part", text=Sources.mass_of, source=f"{S4} [P10]")
        d.derive("pack_length", "mm", layout.length, symbol="L_pk", text=Sources.along, source="geometry")
        return super().declare_around(d, sized, layout)

    def declare_cost(self, d: Declaration, built: Built) -> None:
        """Declare cost and objectives of a complete clutch."""
        d.objective("length", default=False)
        sized, wire = built.sized, built.unknowns.winding_wire
        special = [
            cost.Special("copper", wire, amount=sized.copper, mass=sized.copper, pieces=1, factor=cost.COPPER),
            cost.Special("powder", built.part, amount=sized.powder, mass=sized.powder, factor=cost.POWDER),
        ]
        cost.declare_cost(d, mass=sized.mass + self.around(built.circuit.layout), parts=PARTS, special=special)


class Complete(WithBody):
    """The powder clutch whose shields and shaft count."""

    mass_of = "The whole clutch, with shields and shaft"
    along = f"{Sources.along} with its shields"

    def declare_around(self, d: Declaration, sized: Sized, layout: powder.Layout) -> tuple[Any, Any]:
        """Declare shields and shaft, which count."""
        mass, length = super().declare_around(d, sized, layout)
        long, thick = layout.length + powder.SHAFT_ENDS, powder.SHIELD_THICKNESS
        d.step("shaft_length", "mm", long, symbol="L_shaft", text="Shaft with its ends", source=UNSOURCED)
        d.step("shield_thickness", "mm", thick, symbol="t_sh", text="One shield along the shaft", source=UNSOURCED)
        text = "Light metal of the shields"
        d.step("shield_density", "kg/m3", powder.SHIELD_DENSITY, symbol="rho_sh", text=text, source=UNSOURCED)
        text = "Both shields along the shaft"
        d.constant("shields_length", "mm", 1000 * 2 * thick, symbol="l_sh", text=text, source=UNSOURCED)
        return mass + self.around(layout), length + 2 * thick


class Ruled(WithBody):
    """The powder clutch by rules of practice."""

    # Least power and least inertia ask for ever larger bodies; with the rules of practice the supply limits power.
    objectives = ("mass", "outer_diameter")
    ruled = True
    cooling = "finned"

    def declare_cost(self, d: Declaration, built: Built) -> None:
        """Declare cost and objectives; of equal designs the one with the cooler coil."""
        super().declare_cost(d, built)
        d.prefer("coil_temperature_rise")

    def declare_bore(self, d: Declaration) -> Bore:
        """The bore of the rotor, by default for a shaft that stands the torque."""
        torque = self.wants.torque_reserve * self.wants.required_torque
        shaft = d.block(ShaftSize, shaft_diameter=shaft_for(torque))
        bore = d.block(Bore, shaft_radius=shaft.shaft_diameter / 2)
        thinnest = np.minimum(shaft.shaft_diameter, 2 * bore.shaft_radius)
        declare_shaft(d, shaft, diameter=thinnest, torque=torque)
        return bore

    def declare_rules(self, d: Declaration, built: Built) -> None:
        """Declare the limits that an engineer adds to a powder clutch."""
        wants, filling, rules = self.wants, built.sized.powder, d.block(PowderRules)
        linkage = built.circuit.linkage(built.unknowns.flux_density)
        coil_blocks.refuse_bad_window(d, rules)
        coil_blocks.limit_coil(d, rules=rules, wants=built.iron, unknowns=built.unknowns)
        time = coil_blocks.declare_rise_time(d, rules=rules, winding=built.winding, linkage=linkage)
        if self.rise is not None:
            text, source = "The torque follows what is asked of it", f"{UNSOURCED}; {S4}, check X11"
            d.at_most("rise_time", time, self.rise.rise_time_limit, "s", text=text, source=source)
        d.at_least(
            "powder_spread",
            wants.driver_speed**2 * built.circuit.layout.gap_radius,
            rules.spread_acceleration * centrifugal.STANDARD_GRAVITY,
            "m/s2",
            text="The powder is thrown out all around the gap",
            source=f"{UNSOURCED}; {S4}, check X11",
        )
        per_torque = d.derive(
            "powder_per_torque",
            "g/(N*m)",
            filling / wants.required_torque,
            symbol="q_pow",
            text="Powder over required torque",
            source="definition",
        )
        d.at_most(
            "powder_per_torque",
            per_torque,
            rules.powder_per_torque_max,
            "g/(N*m)",
            text="As much powder as the torque needs",
            source=UNSOURCED,
        )
        cooling.advise_stronger(d, "coil_temperature", cooling.STILL)
        if built.slip_heat is not None:
            self.declare_load(d, built.slip_heat / filling, rules.powder_load_limit)

    def declare_load(self, d: Declaration, load: Any, limit: Any) -> None:
        """Declare the heat of slip over the mass of powder [W/kg], and the remark above a limit."""
        text = "Heat of slip over mass of powder"
        load = d.derive("powder_load", "W/kg", load, symbol="p_pow", text=text, source="definition")
        d.advise(
            "powder_load",
            load > limit,
            "the slip heats the powder more than powder load limit: its life is short, unless forced air cools the "
            "clutch",
            source=f"{UNSOURCED}; {S4} [P9]",
        )


class RuledComplete(Ruled, Complete):
    """The powder clutch by rules of practice, whose shields and shaft count."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
