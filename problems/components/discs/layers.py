"""What stands on the declared discs: nothing, the complete clutch, rules of practice, or both.

The discs themselves do not know which: they are declared alike below every layer.
"""

from __future__ import annotations

from typing import Any, ClassVar

from synth.declaration import Declaration

from ... import cost, practice
from ...friction.duty import DutyInRows, DutyOfDiscs, Size
from ...practice import by_scope
from ..lining.model import MakersHeat, RateHeat
from ..shaft.model import ShaftRequirements
from . import body
from .body import DiscHousing, DiscRules
from .model import DiscRequirements, Discs


class Sources:
    """The discs by the formulas of their sources, with nothing around them."""

    kind: ClassVar[type[DutyInRows]] = DutyInRows
    linings = staticmethod(practice.allowed_linings)
    ring_ratios: ClassVar[tuple[float, float]] = (0.11, 0.13)
    heat: ClassVar[type[MakersHeat]] = MakersHeat
    mass_of: ClassVar[str] = "Pressure plates, linings and cores, without flywheel, springs and cover"
    along: ClassVar[str] = "Length of the released discs and pressure plates, without flywheel, springs and cover"
    shaft: ShaftRequirements | None = None

    def __init__(self, d: Declaration, housing: type[DiscHousing], duty: DutyInRows) -> None:
        """Declare requirements of what is around the discs."""
        self.duty = duty

    def requirements(self, d: Declaration) -> DiscRequirements:
        """Requirements of the discs."""
        return d.block(DiscRequirements)

    def size(self, discs: Discs) -> Size:
        """Size that counts."""
        return discs.size

    def full_size(self, discs: Discs) -> Size:
        """Size with all that is known to be around the discs."""
        return discs.size

    def wear_depth(self, discs: Discs) -> Any:
        """Wear of one lining that is reckoned with [m]."""
        return 0.0

    def declare_body(self, d: Declaration, discs: Discs) -> None:
        """Declare what is around the discs."""

    def declare_cost(self, d: Declaration, discs: Discs) -> None:
        """Declare the relative cost."""

    def declare_rules(self, d: Declaration, discs: Discs) -> None:
        """Declare limits by rules."""


class WithBody(Sources):
    """Discs with hub, cover and spring, whose mass and length are known beside those of the discs."""

    def __init__(self, d: Declaration, housing: type[DiscHousing], duty: DutyInRows) -> None:
        super().__init__(d, housing, duty)
        self.housing = housing(d, self.duty.required_torque)
        self.shaft = self.housing.wants
        self._discs = self.housing.declare_disc_requirements(d)

    def requirements(self, d: Declaration) -> DiscRequirements:
        """Requirements of discs whose hub follows from the shaft."""
        return self._discs

    def full_size(self, discs: Discs) -> Size:
        """Size of the clutch."""
        return self.housing.complete(discs).size

    def wear_depth(self, discs: Discs) -> Any:
        """Wear of one lining before it is replaced [m]."""
        return body.wear_depth(self.housing.wants, discs)

    def declare_body(self, d: Declaration, discs: Discs) -> None:
        """Declare parts of the mass, and wear."""
        body.declare_body(d, discs, self.housing.complete(discs))

    def declare_cost(self, d: Declaration, discs: Discs) -> None:
        """Declare the relative cost of the complete clutch."""
        pack, mass = discs.pack, self.full_size(discs).mass
        lining = (discs.pair.part, discs.area)
        cost.declare_cost(d, mass=mass, parts=2 * pack.discs + 2, lining=lining)


class Complete(WithBody):
    """Discs in a complete clutch, whose mass and length count."""

    mass_of = "The whole clutch, without flywheel"
    along = "The whole clutch, without flywheel"

    def size(self, discs: Discs) -> Size:
        """Size of the clutch."""
        return self.full_size(discs)


class Ruled(WithBody):
    """Discs by rules of practice."""

    kind = DutyOfDiscs
    linings = staticmethod(practice.current_linings)
    ring_ratios = (0.17, 0.28)
    heat = RateHeat

    def __init__(self, d: Declaration, housing: type[DiscHousing], duty: DutyInRows) -> None:
        super().__init__(d, housing, duty)
        self._rules = d.block(DiscRules)

    def declare_rules(self, d: Declaration, discs: Discs) -> None:
        """Declare limits by the rules."""
        body.declare_rules(d, discs, self._rules)


class RuledComplete(Ruled, Complete):
    """Discs by rules of practice, in a complete clutch whose mass and length count."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
