"""What stands on the declared coupling: nothing, the complete coupling, rules of practice, or both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from synth.declaration import Declaration

from .. import cost
from ..components.shaft.model import name_boss
from ..practice import by_scope
from . import body, formulas
from .body import Unknowns

if TYPE_CHECKING:
    from .model import Loads, Wants


@dataclass(frozen=True)
class Built:
    """Parts of a coupling that are declared, and their mass [kg]."""

    wants: Wants
    unknowns: Unknowns
    loads: Loads
    part_mass: Any


class Sources:
    """The coupling by the formulas of its source."""

    defaults: ClassVar[dict[str, float]] = {}
    mass_of: ClassVar[str] = "without hubs"

    @staticmethod
    def roller_kind(d: Declaration) -> str:
        """Kind of rollers that is searched, where it is an option."""
        return ""

    def __init__(self, d: Declaration, wants: Wants) -> None:
        """Declare requirements of what is around the parts."""

    def extend(self, d: Declaration, built: Built) -> Any:
        """Declare what is around the parts; mass of it that counts [kg]."""
        return 0.0

    def declare_rules(self, d: Declaration, unknowns: Unknowns, float_radius: Any) -> None:
        """Declare limits by rules."""


class WithBody(Sources):
    """Coupling with bosses, whose mass is known beside that of the parts."""

    def __init__(self, d: Declaration, wants: Wants) -> None:
        self._body = body.declare_body_requirements(d, torque=wants.required_torque)

    def extend(self, d: Declaration, built: Built) -> Any:
        """Declare length, bosses, backlash and cost; none of the mass counts."""
        around, wants, roller, loads = self._body, built.wants, built.unknowns.roller, built.loads
        body.declare_body(d, wants=around, part_mass=built.part_mass, arm_radius=built.unknowns.sizes.arm_radius)
        width, shaft = d.derived["float_width"].sx, around.shaft_diameter
        long = formulas.coupling_length(width, roller.width, wants.pin_gap, roller.bore, shaft, loads.counter)
        text = "Over the bosses of both arms, with a counter float beside the float"
        d.derive("length", "mm", long, symbol="L", text=text, source="geometry")
        bosses = 2 * around.boss_mass(wants.steel_density)
        name_boss(d, around)
        d.step("boss_mass", "kg", bosses, symbol="m_boss", text="Bosses of both arms", source="geometry")
        material, floats = built.unknowns.material, 1 + loads.counter
        price, weight = material.filled("relative_cost_per_kg", 1.0), loads.float_mass * floats
        special = [
            cost.Special("floats", material, amount=weight, mass=weight, factor=price),
            cost.Special("rollers", roller, amount=4, mass=4 * loads.roller_mass, pieces=4, piece_factor=cost.ROLLER),
        ]
        # Arms, rollers with their pins, float and counter float.
        cost.declare_cost(d, mass=built.part_mass + bosses, parts=2 + 4 + floats, special=special)
        return 0.0


class Complete(WithBody):
    """Coupling whose bosses count."""

    mass_of = "with their bosses"

    def extend(self, d: Declaration, built: Built) -> Any:
        """Declare what is around the parts; mass of the bosses [kg]."""
        super().extend(d, built)
        return 2 * self._body.boss_mass(built.wants.steel_density)


class Ruled(WithBody):
    """Coupling by rules of practice."""

    defaults: ClassVar[dict[str, float]] = {"rim_min": body.RIM_PRACTICE}
    roller_kind = staticmethod(body.declare_roller_kind)

    def __init__(self, d: Declaration, wants: Wants) -> None:
        super().__init__(d, wants)
        self._rules = d.block(body.CouplingRules)

    def declare_rules(self, d: Declaration, unknowns: Unknowns, float_radius: Any) -> None:
        """Declare limits by the rules."""
        body.declare_rules(d, self._rules, unknowns, float_radius)


class RuledComplete(Ruled, Complete):
    """Coupling by rules of practice, whose bosses count."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
