"""A lining in the parts list, and what its thickness is called."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Hatch, Item, Weight

from ...drawing_parts import Sizes

SLOT = "friction_pair"


@dataclass(frozen=True)
class DrawnLining:
    """A lining of a thickness [mm], by the name of that in the design, and which one it is."""

    thickness: float
    name: str
    material: str

    def item(self, number: int, count: int, note: str) -> Item:
        """Line of the parts list."""
        return Item(number, "Lining", count, self.material, note, Hatch.CROSS)

    def weight(self, number: int, mass: str) -> Weight:
        """What the areas of all linings must weigh, by the name of their mass."""
        return Weight((number,), (mass,), f"{SLOT}.density")


def drawn_lining(size: Sizes, listed: str = "") -> DrawnLining:
    """The lining of a design; ``listed`` names its thickness where that is of another list than the lining."""
    name = listed or f"{SLOT}.lining_thickness"
    return DrawnLining(size(name), name, size.part(SLOT))
