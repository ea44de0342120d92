"""What stands on the declared pack: nothing, the complete clutch, rules of practice, or both."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from synth.declaration import Declaration, Part

from ... import cost, practice
from ...friction.duty import DutyOfPack, DutyOfPlates, Size
from ...practice import by_scope
from ..lining.model import MakersHeat, RateHeat
from ..shaft.model import ShaftRequirements
from . import body
from .model import BuiltPack, advise_mean_temperature
from .requirements import PackRequirements, PracticePackRequirements


class Sources:
    """The pack by the formulas of its sources, with nothing around it."""

    kind: ClassVar[type[DutyOfPlates]] = DutyOfPlates
    pack: ClassVar[type[PackRequirements]] = PackRequirements
    linings = staticmethod(practice.allowed_linings)
    ratio_min: ClassVar[float] = 0.10
    heat: ClassVar[type[MakersHeat]] = MakersHeat
    mass_of: ClassVar[str] = "Plates with linings"
    along: ClassVar[str] = "Length of the released pack, without actuator and end stops"
    objectives: ClassVar[tuple[str, ...]] = ("mass", "actuation_force")  # by default
    offered: tuple[str, ...] = ()  # further objectives
    shaft: ShaftRequirements | None = None

    def __init__(self, d: Declaration, housing: type[body.PackHousing], lubrication: str, required: Any) -> None:
        """Declare requirements of what is around the pack."""

    def judge_temperature(self, d: Declaration, built: BuiltPack) -> None:
        """Remark mean temperatures that the lining does not stand."""
        advise_mean_temperature(d, built)

    def size(self, built: BuiltPack) -> Size:
        """Size that counts."""
        return built.size

    def full_size(self, built: BuiltPack) -> Size:
        """Size with all that is known to be around the pack."""
        return built.size

    def wear_depth(self, built: BuiltPack) -> Any:
        """Wear of one lining that is reckoned with [m]."""
        return 0.0

    def declare_body(self, d: Declaration, built: BuiltPack) -> None:
        """Declare what stands on the pack."""

    def declare_cost(self, d: Declaration, built: BuiltPack, plate_set: Part | None) -> None:
        """Declare the relative cost."""


class WithBody(Sources):
    """Pack with drum, hub and shaft, whose mass and length are known beside those of the plates."""

    def __init__(self, d: Declaration, housing: type[body.PackHousing], lubrication: str, required: Any) -> None:
        self.housing = housing(d, lubrication, required)
        self.offered, self.shaft = self.housing.offered, self.housing.wants

    def full_size(self, built: BuiltPack) -> Size:
        """Size of the clutch."""
        return self.housing.complete(built).size

    def wear_depth(self, built: BuiltPack) -> Any:
        """Wear of one lining before it is replaced [m]."""
        return body.wear_depth(self.housing.wants, built)

    def declare_body(self, d: Declaration, built: BuiltPack) -> None:
        """Declare parts of the mass, stroke, wear and inertia."""
        body.declare_body(d, built, self.housing.complete(built))

    def declare_cost(self, d: Declaration, built: BuiltPack, plate_set: Part | None) -> None:
        """Declare the relative cost of the complete clutch; plates of a list may be bought with their lining."""
        mass, plates, area, special = self.full_size(built).mass, built.pack.surfaces + 1, built.area, []
        if plate_set is not None:
            area = np.where(plate_set.filled(cost.UNIT_COST, cost.NONE) > cost.NONE, 0.0, area)
            special = [cost.Special("plates", plate_set, amount=plates, mass=built.size.mass, pieces=plates)]
        cost.declare_cost(d, mass=mass, parts=plates, lining=(built.pair.part, area), special=special)


class Complete(WithBody):
    """Pack in a complete clutch, whose mass and length count."""

    mass_of = "The whole clutch"
    along = "Drum with pack, bottom and actuator"

    def size(self, built: BuiltPack) -> Size:
        """Size of the clutch."""
        return self.full_size(built)


class Ruled(WithBody):
    """Pack by rules of practice; a pump presses as hard as its piston allows, so that least force is no aim."""

    kind = DutyOfPack
    pack = PracticePackRequirements
    linings = staticmethod(practice.current_linings)
    ratio_min = 0.15
    objectives = ("mass", "length")
    heat = RateHeat

    def __init__(self, d: Declaration, housing: type[body.PackHousing], lubrication: str, required: Any) -> None:
        super().__init__(d, housing, lubrication, required)
        self._rules = self.housing.declare_rules(d)

    def judge_temperature(self, d: Declaration, built: BuiltPack) -> None:
        """Leave the mean temperature to the limit of the rules."""

    def declare_body(self, d: Declaration, built: BuiltPack) -> None:
        """Declare the complete clutch, and limits by the rules."""
        super().declare_body(d, built)
        body.declare_rules(d, built, self.housing.complete(built), self._rules)


class RuledComplete(Ruled, Complete):
    """Pack by rules of practice, in a complete clutch whose mass and length count."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
