"""What stands on the declared clutch: nothing, the whole clutch, rules of practice, or both."""

from __future__ import annotations

from typing import Any, ClassVar

from synth.declaration import Declaration

from ..components.lining import wear
from ..components.lining.allowed import Makers, Practice
from ..components.springs.model import Fitted, advise_springs, limit_set
from ..practice import by_scope
from . import body, size
from .body import Built
from .duty import Duty, WholeDuty, declare_duty, declare_whole_duty
from .engagement import advise_high_stop_force, advise_stop_load
from .lining import declare_wear
from .rules import Rules
from .size import Parts


class Sources:
    """The clutch by the formulas of its sources, with nothing around its parts."""

    mass_of: ClassVar[str] = "Plates (as a steel ring of equivalent plate thickness), flyweights and springs"
    offered: ClassVar[tuple[str, ...]] = ()  # further objectives
    judge_stop = staticmethod(advise_stop_load)

    def __init__(self, d: Declaration, rules: type[Rules]) -> None:
        """Declare what the drive asks for, and what rules of a kind go by."""
        self.duty: Duty = declare_duty(d)

    def declare_wear(self, d: Declaration) -> Any:
        """Wear of the linings where the formulas do without [m]."""
        return 0.0

    def linings(self, d: Declaration) -> Makers:
        """What linings stand, with conditions on them beside those of the family."""
        return Makers(d, "yes")

    def declare_size(self, d: Declaration, built: Built) -> None:
        """Declare outside diameter, mass and inertia, and the limit of the room there is."""
        parts = size.declare_parts(d, duty=self.duty, built=built)
        self.declare_mass(d, built, parts)
        size.declare_inertia(d, duty=self.duty, built=built, parts=parts)

    def declare_mass(self, d: Declaration, built: Built, parts: Parts) -> None:
        """Declare the mass that counts."""
        d.derive("mass", "kg", parts.mass, symbol="m", text=self.mass_of, source="geometry")

    def limit_set(self, d: Declaration, fitted: Fitted, prefix: str = "") -> None:
        """Declare limits of a set of springs by rules."""

    def advise_springs(self, d: Declaration, fitted: Fitted, *, radius: Any) -> None:
        """Remark springs on a radius [m] that bow outwards at top speed, or that tire."""
        advise_springs(d, fitted, radius=radius, density=self.duty.steel_density, top_speed=self.duty.top_speed)

    def declare_objectives(self, d: Declaration) -> None:
        """Declare the objectives of all centrifugal clutches."""
        d.headline(
            "outer_diameter",
            "mass",
            "length",
            "friction_surfaces",
            "contact_speed",
            "engagement_band",
            "clamp_force",
            "lining_pressure",
            sized_by="torque_worn" if "torque_worn" in d.limits else "torque_at_full_speed",
        )
        d.objective("outer_diameter")
        d.objective("mass")
        for name in self.offered:
            d.objective(name, default=False)
        wear.offer_wear_life(d)
        d.objective("engagement_band", default=False)
        d.objective("idle_margin", "max", default=False)


class WithBody(Sources):
    """Clutch with further discs, bosses and cover, whose mass and length are known beside those of the parts."""

    duty: WholeDuty
    offered = ("length",)

    def __init__(self, d: Declaration, rules: type[Rules]) -> None:
        self.duty = declare_whole_duty(d)

    def declare_wear(self, d: Declaration) -> Any:
        """Requirement on the wear of the linings [m]."""
        return declare_wear(d)

    def declare_mass(self, d: Declaration, built: Built, parts: Parts) -> None:
        """Declare the mass that counts, length, wear and cost of the whole clutch."""
        complete = body.declare_bosses(d, built, self.duty, parts)
        d.derive("part_mass", "kg", parts.mass, symbol="m_part", text=Sources.mass_of, source="geometry")
        super().declare_mass(d, built, self.counted(parts, complete))
        body.declare_body(d, built, self.duty, complete)

    def counted(self, parts: Parts, complete: Parts) -> Parts:
        """What counts, of the parts alone or with all that is around them."""
        return parts


class Complete(WithBody):
    """The whole clutch, whose mass counts."""

    mass_of = (
        "The whole clutch: its parts, the friction discs beyond the first with a plate for each, and a boss on either "
        "shaft; the cover is among the plates of equivalent plate thickness"
    )

    def counted(self, parts: Parts, complete: Parts) -> Parts:
        """All that is around the parts counts."""
        return complete


class Ruled(WithBody):
    """Clutch by rules of practice."""

    judge_stop = staticmethod(advise_high_stop_force)

    def __init__(self, d: Declaration, rules: type[Rules]) -> None:
        super().__init__(d, rules)
        self._rules = d.block(rules)

    def linings(self, d: Declaration) -> Makers:
        """What linings stand in practice; those which are built no more are left out."""
        return Practice(d, self._rules.allow_obsolete)

    def declare_size(self, d: Declaration, built: Built) -> None:
        """Declare the size, and limits of discs and springs around the shaft by the rules."""
        super().declare_size(d, built)
        body.limit_discs(d, rules=self._rules, lining=built.lining, travel=built.gap)
        self._rules.limit_circle(d, built)

    def limit_set(self, d: Declaration, fitted: Fitted, prefix: str = "") -> None:
        """Declare limits of a set of springs by the rules."""
        limit_set(d, fitted, rules=self._rules.springs, prefix=prefix)


class RuledComplete(Ruled, Complete):
    """Clutch by rules of practice, the whole of which counts."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
