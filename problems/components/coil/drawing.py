"""The coil in a section, and the iron around it."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import XY, Dimension, Edge, Hatch, Item, Weight

from ...drawing_parts import Sizes


@dataclass(frozen=True)
class DrawnCoil:
    """Window of a coil and thickness of the iron around it [mm], with the wire that fills the window."""

    length: float
    height: float
    iron: float
    wire: str
    turns: int

    def item(self, number: int) -> Item:
        """Line of the coil in the parts list."""
        return Item(number, "Coil", 1, self.wire, f"{self.turns} turns", Hatch.CROSS)

    def weight(self, number: int) -> Weight:
        """Mass of the coil of a number in the parts list."""
        return Weight((number,), ("copper_mass",), "coil_density")

    def along(self, x0: float, x1: float, y: float) -> Dimension:
        """Length of the window between two places along the axis, at a radius [mm]."""
        return Dimension((x0, y), (x1, y), "coil_length", "top")

    def across(self, x: float, y0: float, y1: float) -> Dimension:
        """Height of the window between two radii, at a place along the axis [mm]."""
        return Dimension((x, y0), (x, y1), "coil_height", "right")

    def around(self, start: XY, end: XY, side: Edge, times: int = 1) -> Dimension:
        """Thickness of the iron between two points, as often as it is that thick."""
        return Dimension(start, end, "yoke_thickness", side, times=times)


def drawn_coil(size: Sizes) -> DrawnCoil:
    """The coil of a design."""
    length, height, iron = size("coil_length"), size("coil_height"), size("yoke_thickness")
    return DrawnCoil(length, height, iron, size.part("winding_wire"), size.count("turns"))
