"""The complete wrap spring clutch around its spring, and what an engineer demands of both."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar

from synth.declaration import Block, Declaration, Requirement

from ... import cost
from ...friction.duty import Duty as FrictionDuty
from ...mechanics import shaft as shaft_formulas
from ...practice import UNSOURCED
from ..shaft.model import ShaftRequirements, ShaftStress, declare_shaft

if TYPE_CHECKING:
    from .model import Built, Size
    from .requirements import Duty

SHAFT_RESERVE = 1.5  # torque that the shaft stands over required_torque


class BodyRequirements(ShaftStress):
    """Shaft and bosses of a complete clutch, all in SI."""

    group = "practice"
    parts: ClassVar[int] = 3  # hubs and spring

    shaft_shear_allow = replace(
        ShaftStress.shaft_shear_allow,
        text=f"Shear stress from which the default of bore diameter follows, with 1.5 required torque ({UNSOURCED}; "
        "twelve shafts of real units run at 6 to 25)",
    )
    hub_factor = ShaftRequirements.hub_factor

    def bore(self, duty: Duty) -> Any:
        """Return the bore of hubs on a shaft that stands what is asked [m]."""
        return shaft_formulas.shaft_diameter(SHAFT_RESERVE * duty.required_torque, self.shaft_shear_allow)

    def complete_size(self, built: Built) -> Size:
        """Return the size of a clutch whose hubs go on beyond the spring as bosses on their shafts."""
        duty, spring = built.spring.duty, built.size
        return replace(
            spring,
            mass=spring.mass + 2 * shaft_formulas.boss_mass(duty.hub_density, duty.bore_diameter, self.hub_factor),
            length=spring.length + 2 * shaft_formulas.BOSS_LENGTH * duty.bore_diameter,
            mass_of="The whole clutch",
            along="The whole clutch, with the bosses beyond the spring",
        )

    def declare(self, d: Declaration, built: Built) -> None:
        """Declare parts of the mass, shaft and cost of a complete clutch."""
        duty, spring = built.spring.duty, built.size
        d.derive("part_mass", "kg", spring.mass, symbol="m_part", text=spring.mass_of, source="geometry")
        d.derive("spring_length", "mm", spring.length, symbol="L_sp", text=spring.along, source="geometry")
        declare_shaft(d, self, diameter=duty.bore_diameter, torque=SHAFT_RESERVE * duty.required_torque)
        bosses = 2 * shaft_formulas.boss_mass(duty.hub_density, duty.bore_diameter, self.hub_factor)
        d.step("boss_mass", "kg", bosses, symbol="m_boss", text="Both bosses beyond the spring", source="geometry")
        for name, value, symbol, text in (
            ("boss_diameter", self.hub_factor * duty.bore_diameter, "d_boss", "Outside of a boss"),
            ("boss_length", shaft_formulas.BOSS_LENGTH * duty.bore_diameter, "L_boss", "Length of a boss"),
        ):
            d.step(name, "mm", value, symbol=symbol, text=text, source=UNSOURCED)
        wire, mass = built.spring.wire.row, spring.spring_mass
        coiled = cost.Special("spring", wire, amount=mass, mass=mass, pieces=1, factor=cost.SPRING_WIRE)
        cost.declare_cost(d, mass=self.complete_size(built).mass, parts=self.parts, special=[coiled])


class SpringRules(Block):
    """Rules for the spring of both fits, all in SI."""

    group = "practice"

    allow_obsolete = replace(
        FrictionDuty.allow_obsolete,
        choices=("no", "historical"),
        text="historical: also dry hubs, on which steel galls, where nothing overruns",
    )
    coils_per_hub_max = Requirement(
        "-", 8, lower=2, upper=12, symbol="n_max", text=f"Most coils on one hub ({UNSOURCED})", source=UNSOURCED
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

    def pairs(self, d: Declaration, wants: Any) -> list[str]:
        """Conditions on friction pairs, where the table tells: in oil or greased, as dry steel on steel galls."""
        known = all(d.has_column("friction_materials", c) for c in ("lubrication", "lubrication_note"))
        return (
            ["(lubrication == 'oil' or lubrication_note == 'greased')"] if known and not self.may_run_dry(wants) else []
        )

    def may_run_dry(self, wants: Any) -> bool:
        """True if dry friction pairs are offered."""
        return self.allow_obsolete != "no"

    def limit(self, d: Declaration, built: Built) -> None:
        """Declare the limits that an engineer adds to the spring of both fits."""
        spring = built.spring
        text, most = "So many coils are built", self.coils_per_hub_max
        d.at_most("coils_practice", spring.per_hub, most, "-", text=text, source=UNSOURCED)
        d.at_most(
            "spring_index_max",
            2 * spring.mean_radius / spring.wire.thickness,
            self.spring_index_max,
            "-",
            text="The spring can be coiled and handled",
            source=UNSOURCED,
        )
