"""How an area is filled on paper: hatched, or whole where it is thin."""

from __future__ import annotations

from enum import StrEnum

from synth.drawing import Area, Hatch, Item
from synth.drawing.shapes import thickness

THIN = 1.2  # mm on paper: thinner sections are filled (ISO 128-3)


class Filling(StrEnum):
    """What an area looks like."""

    RIGHT = "right"
    LEFT = "left"
    CROSS = "cross"
    DOTS = "dots"
    BLACK = "black"
    GREY = "grey"
    WHITE = "white"


def filling(area: Area, item: Item | None, scale: float) -> Filling:
    """Filling of an area of a part at a scale."""
    if not area.cut or item is None or item.filling is Hatch.NONE:
        return Filling.WHITE
    if thickness(area) * scale < THIN * (1 + 1e-6):
        return Filling.BLACK if item.filling in (Hatch.RIGHT, Hatch.LEFT) else Filling.GREY
    return Filling(item.filling.value)
