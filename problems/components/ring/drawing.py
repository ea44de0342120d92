"""The friction ring in a section."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Area, Dimension, Edge, diameter

from ...drawing_parts import Sizes, ring


@dataclass(frozen=True)
class DrawnRing:
    """A friction ring between two radii [mm]."""

    inside: float
    outside: float

    def facing(self, x0: float, x1: float, item: int) -> Area:
        """Section of a part as wide as the ring, between two places along the axis [mm]."""
        return ring(x0, x1, self.inside, self.outside, item)

    def below(self, share: float) -> float:
        """Place across the axis, below it, at a share of the width from the inside [mm]."""
        return -(self.inside + share * (self.outside - self.inside))

    def diameters(self, x: float, side: Edge) -> tuple[Dimension, ...]:
        """Both diameters, measured at a place along the axis [mm]."""
        return (
            diameter(x, self.inside, "ring_inner_diameter", side=side),
            diameter(x, self.outside, "ring_outer_diameter", side=side),
        )


def drawn_ring(size: Sizes) -> DrawnRing:
    """The friction ring of a design."""
    return DrawnRing(size("ring_inner_diameter") / 2, size("ring_outer_diameter") / 2)
