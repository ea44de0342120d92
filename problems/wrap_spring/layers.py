"""What stands on the declared spring of either fit: nothing, the complete clutch, rules of practice, or both."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

from synth.declaration import Block, Declaration

from ..components.wrap_spring import body
from ..components.wrap_spring.model import Built, Size
from ..components.wrap_spring.requirements import Duty, declare_duty
from ..practice import by_scope
from ..sources import DRIVE

# Of required_torque: largest drag of an interference fit, largest energising torque of a clearance fit.
SMALL_SHARE = 0.1


@dataclass(frozen=True)
class Fit:
    """Blocks of a fit, by its sources and by the rules of practice.

    ``small_torque`` names what is best small: the drag when overrunning, or the torque that closes the spring.
    """

    small_torque: str
    duty: type[Duty]
    ruled_duty: type[Duty]
    wants: type[Block]
    ruled_wants: type[Block]
    rules: type[body.SpringRules]
    body: type[body.BodyRequirements]


class Sources:
    """Spring and hubs by the formulas of their sources, with nothing around them."""

    def __init__(self, fit: Fit, d: Declaration) -> None:
        """Declare requirements of what is around the spring."""
        self.fit = fit

    def declare_duty(self, d: Declaration) -> Duty:
        """Requirements of the drive."""
        return declare_duty(d, kind=self.fit.duty)

    def declare_wants(self, d: Declaration, duty: Duty) -> Any:
        """Requirements of the fit."""
        return d.block(self.fit.wants)

    def pairs(self, d: Declaration, wants: Any) -> list[str]:
        """Conditions on friction pairs."""
        return []

    def size(self, built: Built) -> Size:
        """Size that counts."""
        return built.size

    def extend(self, d: Declaration, built: Built) -> None:
        """Declare what stands on the spring."""

    def declare_objectives(self, d: Declaration, *others: str) -> None:
        """Offer objectives; others count only where the question names them."""
        d.objective("mass")
        d.objective(self.fit.small_torque)
        for name in others:
            d.objective(name, default=False)


class WithBody(Sources):
    """Spring and hubs with bosses, whose mass and length are known beside those of the spring."""

    def __init__(self, fit: Fit, d: Declaration) -> None:
        super().__init__(fit, d)
        self._body = d.block(fit.body)

    def declare_duty(self, d: Declaration) -> Duty:
        """Requirements of the drive, with a bore that stands its torque."""
        return declare_duty(d, kind=self.fit.duty, bore=self._body.bore)

    def extend(self, d: Declaration, built: Built) -> None:
        """Declare parts of the mass, shaft and cost."""
        self._body.declare(d, built)


class Complete(WithBody):
    """Spring and hubs in a complete clutch, whose mass and length count."""

    def size(self, built: Built) -> Size:
        """Size of the clutch."""
        return self._body.complete_size(built)


class Ruled(WithBody):
    """Spring and hubs by rules of practice."""

    def declare_duty(self, d: Declaration) -> Duty:
        """Requirements of the drive, of a clutch that can slip."""
        return declare_duty(d, kind=self.fit.ruled_duty, bore=self._body.bore)

    def declare_wants(self, d: Declaration, duty: Duty) -> Any:
        """Requirements of the fit, whose small torque is bounded, and of the rules."""
        wants = d.block(self.fit.ruled_wants, **{f"{self.fit.small_torque}_limit": SMALL_SHARE * duty.required_torque})
        self._rules = d.block(self.fit.rules)
        return wants

    def pairs(self, d: Declaration, wants: Any) -> list[str]:
        """Conditions on friction pairs, which are in oil or greased."""
        return self._rules.pairs(d, wants)

    def extend(self, d: Declaration, built: Built) -> None:
        """Declare the complete clutch, and limits by the rules."""
        super().extend(d, built)
        self._rules.limit(d, built)

    def declare_objectives(self, d: Declaration, *others: str) -> None:
        """Offer objectives: as that torque is bounded, what is left to ask for is a small clutch."""
        d.objective("mass")
        for name in (self.fit.small_torque, *others):
            d.objective(name, default=False)
        d.objective("length")


class RuledComplete(Ruled, Complete):
    """Spring and hubs by rules of practice, in a complete clutch whose mass and length count."""


def declare_size(d: Declaration, size: Size, duty: Duty) -> None:
    """Declare length, diameter and mass that count, and the limits of the room there is."""
    d.derive("length", "mm", size.length, symbol="L", text=size.along, source="geometry")
    d.derive("outer_diameter", "mm", size.diameter, symbol="D_o", text=size.outside, source="geometry")
    d.derive("mass", "kg", size.mass, symbol="m", text=size.mass_of, source="geometry")
    for name, value, most, text in (
        ("outer_diameter", size.diameter, duty.outer_diameter_limit, "The clutch fits the room across"),
        ("length", size.length, duty.length_limit, "The clutch fits the room along"),
    ):
        if most is not None:
            d.at_most(name, value, most, "mm", text=text, source=DRIVE)


def layers_of(fit: Fit) -> dict[tuple[bool, bool], partial[Sources]]:
    """Layers of a fit by scope."""
    kinds = (Sources, Complete, Ruled, RuledComplete)
    return by_scope(*(partial(kind, fit) for kind in kinds))
