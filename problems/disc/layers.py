"""What stands on the declared discs: nothing, the complete clutch, rules of practice, or both.

The discs themselves do not know which: they are declared alike below every layer.
"""

from __future__ import annotations

from typing import ClassVar

from synth.declaration import Declaration

from .. import cost
from ..friction.duty import Duty, DutyOfDiscs, Size, sizing_torque
from . import body
from .body import DiscRules
from .pack import DiscRequirements, Discs


class Sources:
    """The discs by the formulas of their sources, with nothing around them."""

    kind: ClassVar[type[Duty]] = Duty
    rules: ClassVar[bool] = False
    ring_ratios: ClassVar[tuple[float, float]] = (0.11, 0.13)
    mass_of: ClassVar[str] = "Pressure plates, linings and cores, without flywheel, springs and cover"
    along: ClassVar[str] = "Length of the released discs and pressure plates, without flywheel, springs and cover"

    def __init__(self, d: Declaration, duty: Duty) -> None:
        """Declare requirements of what is around the discs."""
        self.required = sizing_torque(duty)

    def requirements(self, d: Declaration) -> DiscRequirements:
        """Requirements of the discs."""
        return d.block(DiscRequirements)

    def size(self, discs: Discs) -> Size:
        """Size that counts."""
        return discs.size

    def extend(self, d: Declaration, discs: Discs) -> None:
        """Declare what stands on the discs."""


class WithBody(Sources):
    """Discs with hub, cover and spring, whose mass and length are known beside those of the discs."""

    def __init__(self, d: Declaration, duty: Duty) -> None:
        super().__init__(d, duty)
        self._body = body.declare_body_requirements(d, required=self.required)
        self._discs = body.declare_disc_requirements(d, body=self._body)

    def requirements(self, d: Declaration) -> DiscRequirements:
        """Requirements of discs whose hub follows from the shaft."""
        return self._discs

    def complete(self, discs: Discs) -> body.DiscBody:
        """The parts around the discs."""
        return body.complete_body(discs, self._body)

    def extend(self, d: Declaration, discs: Discs) -> None:
        """Declare parts of the mass, wear and cost."""
        around, pack = self.complete(discs), discs.pack
        body.declare_body(d, discs, around)
        lining = (discs.pair.part, pack.surfaces * discs.ring.area)
        cost.declare_cost(d, mass=around.size.mass, parts=2 * pack.discs + 2, lining=lining)


class Complete(WithBody):
    """Discs in a complete clutch, whose mass and length count."""

    mass_of = "The whole clutch, without flywheel"
    along = "The whole clutch, without flywheel"

    def size(self, discs: Discs) -> Size:
        """Size of the clutch."""
        return self.complete(discs).size


class Ruled(WithBody):
    """Discs by rules of practice."""

    kind = DutyOfDiscs
    rules = True
    ring_ratios = (0.17, 0.28)

    def __init__(self, d: Declaration, duty: Duty) -> None:
        super().__init__(d, duty)
        self._rules = d.block(DiscRules)

    def extend(self, d: Declaration, discs: Discs) -> None:
        """Declare the complete clutch, and limits by the rules."""
        super().extend(d, discs)
        body.declare_rules(d, discs, self._rules)


class RuledComplete(Ruled, Complete):
    """Discs by rules of practice, in a complete clutch whose mass and length count."""


# By Scope.rules and Scope.complete.
LAYERS: dict[tuple[bool, bool], type[Sources]] = {
    (False, False): Sources,
    (False, True): Complete,
    (True, False): Ruled,
    (True, True): RuledComplete,
}
