"""What stands on the declared cones: nothing, the complete clutch, rules of practice, or both."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from synth.declaration import Declaration

from .. import cost, practice
from ..components.lining.model import MakersHeat, Pair, RateHeat
from ..friction.duty import Duty, Size
from ..practice import by_scope
from . import body
from . import formulas as cone
from .body import DERIVED, Cone, ConeBody, Cones


class Sources:
    """The cones by the formulas of their sources, with nothing around them."""

    linings = staticmethod(practice.allowed_linings)
    heat: ClassVar[type[MakersHeat]] = MakersHeat
    mass_of: ClassVar[str] = "Both shells and the lining, times the mass factor of the layout"
    along: ClassVar[str] = "Length of the cone and what the layout adds to it"
    pull_max: Any = None  # pull over spring force; None where the cones must come apart by themselves

    def __init__(self, d: Declaration, duty: Duty) -> None:
        """Declare requirements of what is around the cones."""
        self.duty = duty

    def judge_angle(self, d: Declaration, shape: Cone) -> None:
        """Remark half angles that are unusual."""
        usual = "practice of cone clutches: 8 to 15, at most 18 degrees"
        text = "half angles below 8 degrees tend to grab and to stick"
        d.advise("slender_cone", shape.angle < np.radians(8), text, source=usual)
        d.advise(
            "blunt_cone",
            shape.angle > np.radians(18),
            "above 18 degrees little is left of the wedge effect for which a cone is chosen; a lining with less "
            "friction at rest allows a smaller angle",
            source=usual,
        )

    def declare_pull(self, d: Declaration, shape: Cone, static: Any, pair: Pair) -> None:
        """Declare the force that pulls the cones apart."""

    def size(self, cones: Cones) -> Size:
        """Size that counts."""
        return cones.size

    def extend(self, d: Declaration, cones: Cones) -> None:
        """Declare what stands on the cones."""


class WithBody(Sources):
    """Cones with webs, bosses and spring, whose mass and length are known beside those of the cones."""

    def __init__(self, d: Declaration, duty: Duty) -> None:
        super().__init__(d, duty)
        self._body = body.declare_body_requirements(d, required=self.duty.required_torque)

    def complete(self, cones: Cones) -> ConeBody:
        """The parts around the cones."""
        return body.complete_body(cones, self._body)

    def extend(self, d: Declaration, cones: Cones) -> None:
        """Declare parts of the mass, stroke, wear and cost."""
        built = self.complete(cones)
        body.declare_body(d, cones, built)
        # Two cones, the ring that presses and its spring.
        cost.declare_cost(d, mass=built.size.mass, parts=4, lining=(cones.pair.part, cones.shape.area))


class Complete(WithBody):
    """Cones in a complete clutch, whose mass and length count."""

    mass_of = "The whole clutch"
    along = f"{Sources.along}, with both webs"

    def size(self, cones: Cones) -> Size:
        """Size of the clutch."""
        return self.complete(cones).size


class Ruled(WithBody):
    """Cones by rules of practice."""

    linings = staticmethod(practice.current_linings)
    heat = RateHeat

    def __init__(self, d: Declaration, duty: Duty) -> None:
        super().__init__(d, duty)
        self._rules = body.declare_cone_rules(d)
        self.pull_max = self._rules.pull_max

    def judge_angle(self, d: Declaration, shape: Cone) -> None:
        """Leave angles to the limits of the rules."""

    def extend(self, d: Declaration, cones: Cones) -> None:
        """Declare the complete clutch, and limits by the rules."""
        super().extend(d, cones)
        body.declare_rules(d, cones, self._rules, self.complete(cones))

    def declare_pull(self, d: Declaration, shape: Cone, static: Any, pair: Pair) -> None:
        """Declare the force that pulls the cones apart, and its limit over the spring force where there is one."""
        ratio = cone.pull_ratio(shape.angle, static, pair.mu_low)
        # Seated cones have no friction along the generator left from engaging.
        seated = cone.pull_ratio(shape.angle, static, 0.0)
        d.derive(
            "release_pull",
            "N",
            ratio * shape.force,
            symbol="F_pull",
            text="Force that pulls the engaged cones apart against friction at rest; negative: they come apart by "
            "themselves",
            source=DERIVED,
        )
        if self.pull_max is not None:
            d.at_most(
                "release_pull",
                ratio,
                self.pull_max,
                "-",
                text="The release gear can pull the cones apart: its pull over the spring force",
                source=practice.UNSOURCED,
            )
        d.derive(
            "seated_pull",
            "N",
            seated * shape.force,
            symbol="F_pull_seat",
            text="Force that pulls cones apart which vibration has seated",
            source="derived, N = F/sin(alpha)",
        )
        d.advise(
            "sticks",
            seated > 1,
            "seated by vibration the cones need more than the spring force to come apart (seated pull): a larger "
            "cone angle min or a smaller release pull max helps, or a lining with less friction at rest",
            source=DERIVED,
        )


class RuledComplete(Ruled, Complete):
    """Cones by rules of practice, in a complete clutch whose mass and length count."""


LAYERS = by_scope(Sources, Complete, Ruled, RuledComplete)
