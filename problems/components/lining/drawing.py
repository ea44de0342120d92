"""A lining in the parts list, and what its thickness is called."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Hatch, Item, Weight

from ...drawing_parts import Sizes


@dataclass(frozen=True)
class DrawnLining:
    """A lining of a thickness [mm], by the name of that in the design, and which one it is."""

    thickness: float
    name: str
    material: str

    def item(self, number: int, count: int, note: str) -> Item:
        """Line of the parts list."""
        return Item(number, "Lining", count, self.material, note, Hatch.CROSS)


def drawn_lining(size: Sizes, name: str = "friction_pair.lining_thickness") -> DrawnLining:
    """The lining of a design; ``name`` is that of its thickness."""
    return DrawnLining(size(name), name, size.part("friction_pair"))


def lining_weight(number: int) -> Weight:
    """Mass that all linings of a number in the parts list must give."""
    return Weight((number,), ("lining_mass",), "friction_pair.density")
