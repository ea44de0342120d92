"""The complete wrap spring clutch around its spring, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from synth.declaration import Block, Declaration, Requirement

from .. import cost
from ..mechanics import shaft as shaft_formulas
from ..practice import UNSOURCED, ShaftRequirements, ShaftStress, declare_shaft

if TYPE_CHECKING:
    from .blocks import Coils, Duty, Size, Wire

SHAFT_RESERVE = 1.5  # torque that the shaft stands over required_torque
# Of required_torque: largest drag of an interference fit, largest energising torque of a clearance fit.
FREE_SHARE = 0.1


class BodyRequirements(ShaftStress):
    """Shaft and bosses of a complete clutch, all in SI."""

    group = "practice"

    shaft_shear_allow = replace(
        ShaftStress.shaft_shear_allow,
        text=f"Shear stress from which the default of bore diameter follows, with 1.5 required torque ({UNSOURCED}; "
        "twelve shafts of real units run at 6 to 25)",
    )
    hub_factor = ShaftRequirements.hub_factor

    def bore(self, duty: Duty) -> Any:
        """Return the bore of hubs on a shaft that stands what is asked [m]."""
        return shaft_formulas.shaft_diameter(SHAFT_RESERVE * duty.required_torque, self.shaft_shear_allow)

    def whole_size(self, *, duty: Duty, spring: Size) -> Size:
        """Return the size of a clutch whose hubs go on beyond the spring as bosses on their shafts."""
        bosses = 2 * shaft_formulas.boss_mass(duty.hub_density, duty.bore_diameter, self.hub_factor)
        return replace(
            spring,
            mass=spring.mass + bosses,
            length=spring.length + 2 * shaft_formulas.BOSS_LENGTH * duty.bore_diameter,
        )


class SpringRules(Block):
    """Rules for the spring of both fits, all in SI."""

    group = "practice"

    coils_per_hub_max = Requirement(
        "-",
        8,
        lower=2,
        upper=12,
        symbol="n_max",
        text=f"Most coils on one hub ({UNSOURCED})",
        source=UNSOURCED,
    )
    spring_index_max = Requirement(
        "-",
        25,
        lower=6,
        upper=300,
        symbol="index_max",
        text=f"Largest mean coil diameter over wire thickness: slimmer ones are hard to coil and handle ({UNSOURCED})",
        source=UNSOURCED,
    )


def declare_parts(d: Declaration, *, duty: Duty, wants: BodyRequirements, spring: Size) -> None:
    """Name what of a complete clutch its formulas know, and remark a bore that is thin for the torque.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    wants : BodyRequirements
        Shaft and bosses.
    spring : Size
        Mass and room of the spring and the hubs under it.
    """
    d.derive("part_mass", "kg", spring.mass, symbol="m_part", text="Spring and both hubs under it", source="geometry")
    d.derive("spring_length", "mm", spring.length, symbol="L_sp", text="Length of the spring", source="geometry")
    declare_shaft(d, wants, diameter=duty.bore_diameter, torque=SHAFT_RESERVE * duty.required_torque)
    bosses = 2 * shaft_formulas.boss_mass(duty.hub_density, duty.bore_diameter, wants.hub_factor)
    d.step("boss_mass", "kg", bosses, symbol="m_boss", text="Both bosses beyond the spring", source="geometry")
    for name, value, symbol, text in (
        ("boss_diameter", wants.hub_factor * duty.bore_diameter, "d_boss", "Outside of a boss"),
        ("boss_length", shaft_formulas.BOSS_LENGTH * duty.bore_diameter, "L_boss", "Length of a boss"),
    ):
        d.step(name, "mm", value, symbol=symbol, text=text, source=UNSOURCED)


def declare_cost(d: Declaration, *, wire: Wire, spring: Size, mass: Any, parts: float) -> None:
    """Declare the relative cost of a clutch.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    wire : Wire
        Wire of the spring; ``unit_cost`` of its row is for a kilogram.
    spring : Size
        Size of spring and hubs, with the mass of the spring alone.
    mass : symbol
        Mass of the whole clutch [kg].
    parts : float
        Parts: hubs, spring, and a collar.
    """
    coiled = cost.Special(
        "spring", wire.row, amount=spring.spring_mass, mass=spring.spring_mass, pieces=1, factor=cost.SPRING_WIRE
    )
    cost.declare_cost(d, mass=mass, parts=parts, special=[coiled])


def limit_spring(d: Declaration, *, rules: SpringRules, wire: Wire, coils: Coils) -> None:
    """Declare the limits that an engineer adds to the spring of both fits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rules : SpringRules
        What the limits go by.
    wire : Wire
        Wire of the spring.
    coils : Coils
        Hub and coils.
    """
    d.at_most(
        "coils_practice", coils.per_hub, rules.coils_per_hub_max, "-", text="So many coils are built", source=UNSOURCED
    )
    d.at_most(
        "spring_index_max",
        2 * coils.mean_radius / wire.thickness,
        rules.spring_index_max,
        "-",
        text="The spring can be coiled and handled",
        source=UNSOURCED,
    )
