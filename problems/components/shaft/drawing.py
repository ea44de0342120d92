"""Ends of a shaft and the bosses on it."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Area, Dimension, Drawable, Line, LineKind

from ...drawing_parts import Sizes, ring
from ..drawn import DrawnComponent

Extent = tuple[float, float]
SHAFT_OUT = 0.25  # of its diameter: how far a shaft is drawn beyond what sits on it


def shaft_end(x0: float, x1: float, radius: float) -> tuple[Drawable, ...]:
    """End of a shaft as a neighbour: it ends at x0 and goes on beyond x1 [mm]; ``radius`` is half of it."""
    broken = 2 * radius * SHAFT_OUT
    out = x1 + broken if x1 > x0 else x1 - broken
    edge = LineKind.PHANTOM
    return Line((x0, radius), (out, radius), edge), Line((x0, 0.0), (x0, radius), edge)


@dataclass(frozen=True)
class DrawnShaft:
    """A shaft of a radius, and the radius and length of the bosses on it [mm]; 0 where the model has none."""

    radius: float
    boss_radius: float = 0.0
    boss_length: float = 0.0

    def drawn(self, *ends: Extent, bosses: tuple[Extent, ...] = (), times: int = 1) -> DrawnComponent:
        """Ends of shafts as neighbours, each from where it ends to what it leaves [mm], measured at the left of them.

        Parameters
        ----------
        *ends, bosses : pairs of float
            Extents along the axis of the ends, and of the bosses that are measured [mm].
        times : int
            Bosses for each that is measured.
        """
        left = min(x for end in ends for x in end)
        shapes = tuple(shape for x0, x1 in ends for shape in shaft_end(x0, x1, self.radius))
        return DrawnComponent(shapes, dimensions=self.measured(left, *bosses, times=times))

    def measured(self, x: float, *bosses: Extent, times: int = 1, axis: float = 0.0) -> tuple[Dimension, ...]:
        """Diameters at a place along the axis, and lengths of bosses; the axis may be off that of the drawing [mm]."""

        def across(radius: float, name: str) -> Dimension:
            return Dimension((x, axis - radius), (x, axis + radius), name, "left", diameter=True)

        top, shaft = axis + self.boss_radius, across(self.radius, "shaft_diameter")
        if not bosses:
            return (shaft,)
        lengths = (Dimension((x0, top), (x1, top), "boss_length", "top", times=times) for x0, x1 in bosses)
        return *lengths, across(self.boss_radius, "boss_diameter"), shaft

    def as_long(self, x: float, y: float) -> Dimension:
        """Length of a part below the axis that is as long as the shaft is thick, from its left corner on [mm]."""
        return Dimension((x, y), (x + 2 * self.radius, y), "shaft_diameter", "bottom")

    def boss(self, x: float, item: int) -> Area:
        """Section of a boss from its left face on [mm]."""
        return ring(x, x + self.boss_length, self.radius, self.boss_radius, item)


def drawn_shaft(size: Sizes) -> DrawnShaft:
    """The shaft of a design, with its bosses where they are named."""
    radius = size("shaft_diameter") / 2
    if "boss_length" not in size.design.steps:
        return DrawnShaft(radius)
    return DrawnShaft(radius, size("boss_diameter") / 2, size("boss_length"))
