"""Models of the fitted spring: ``seed`` is the source as printed, ``refined`` what was derived from it.

Source: S2 (Kozma, Molnar, Varadi, Oroszvary, wrap spring clutch).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar

from synth.declaration import Declaration

from ...mechanics import Quantity
from ...sources import NOT_IN_S2
from . import formulas


class Refined:
    """Hub radius and mean coil radius apart, exact change of curvature, centrifugal force on the wire."""

    at_rest: ClassVar[bool] = False  # whether speed changes no torque

    mean_radius = staticmethod(formulas.mean_radius)
    radius_ratio = staticmethod(formulas.radius_ratio)
    free_radius = staticmethod(formulas.free_radius)
    interference_for = staticmethod(formulas.interference_for)
    centrifugal_moment = staticmethod(formulas.centrifugal_moment)

    @staticmethod
    def loosened(free_radius: Quantity, growth: Quantity) -> Quantity:
        """Mean radius of a free spring that is larger by a tolerance [m]."""
        return free_radius + growth

    def declare_steps(self, d: Declaration, steps: Iterable[tuple[str, str, Any, str, str]], source: str) -> None:
        """Name what this model alone has: name, unit, value, symbol and text."""
        for name, unit, value, symbol, text in steps:
            d.step(name, unit, value, symbol=symbol, text=text, source=source)

    def declare_grip(self, d: Declaration, moment: Any, spinning: Any) -> tuple[str, ...]:
        """Declare that a preload grips at speed; the guards without which there is no closing torque."""
        d.at_least(
            "grip",
            moment,
            spinning,
            "N*m",
            guard=True,
            text="At spring speed the loosest spring is below its lift-off; otherwise nothing grips",
            source=NOT_IN_S2,
        )
        return ("grip",)  # without interference there is no preload either


class Seed(Refined):
    """The source: mean radius and hub radius are one, small changes of curvature, a wire without mass."""

    at_rest = True

    @staticmethod
    def mean_radius(hub_diameter: Quantity, thickness: Quantity) -> Quantity:
        """Mean radius of the fitted coils [m]: S2 calls r the mean radius in (1), the radius of the drum in (14)."""
        return hub_diameter / 2

    @staticmethod
    def radius_ratio(hub_diameter: Quantity, thickness: Quantity) -> Quantity:
        """Hub radius over mean coil radius [-]."""
        return 1.0

    @staticmethod
    def free_radius(interference: Quantity, mean_radius: Quantity) -> Quantity:
        """Mean radius of the free spring as it enters the curvature [m], as if the interference were nothing."""
        return mean_radius

    @staticmethod
    def interference_for(curvature: Quantity, mean_radius: Quantity) -> Quantity:
        """Interference that gives a curvature change [m], dr = dk r**2."""
        return curvature * mean_radius * mean_radius

    @staticmethod
    def centrifugal_moment(
        density: Quantity, width: Quantity, thickness: Quantity, mean_radius: Quantity, speed: Quantity
    ) -> Quantity:
        """Share of its bending moment that the spinning wire carries itself [N m]: none."""
        return 0.0 * speed

    @staticmethod
    def loosened(free_radius: Quantity, growth: Quantity) -> Quantity:
        """Mean radius of a free spring [m], whatever its tolerance."""
        return free_radius

    def declare_steps(self, d: Declaration, steps: Iterable[tuple[str, str, Any, str, str]], source: str) -> None:
        """Name nothing."""

    def declare_grip(self, d: Declaration, moment: Any, spinning: Any) -> tuple[str, ...]:
        """The preload alone decides; what the speed does is told by the limit ``liftoff`` in both models."""
        return ("interference_positive",)


MODELS: dict[str, Refined] = {"refined": Refined(), "seed": Seed()}
