"""Sets of springs in a drawing: one of each, with its lengths."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from synth.drawing import Area, Dimension, Drawable, Item, Line, LineKind, View
from synth.text.numbers import typed_number

from ...drawing_parts import Sizes


@dataclass(frozen=True)
class Spring:
    """A set of springs in a drawing: its slot and name, when it is shortest, and the name of the way until then."""

    slot: str
    name: str
    shortest: str
    travel: str = ""

    def count(self, size: Sizes) -> int:
        """Springs of the set."""
        return size.count(f"{self.slot}s")

    def wire(self, size: Sizes) -> float:
        """Diameter of the wire [mm]."""
        return size(f"{self.slot}.wire_diameter_d")

    def item(self, size: Sizes, number: int) -> Item:
        """Line of the set in the parts list."""
        coils = typed_number(size.number(f"{self.slot}.total_coils_nt"))
        note = f"{coils} coils, two of them closed ends"
        return Item(number, self.name, self.count(size), size.part(self.slot), note)

    def outside(self, size: Sizes) -> float:
        """Outside diameter of the coils [mm]."""
        return size(f"{self.slot}.mean_diameter_D") + self.wire(size)


CLAMP = Spring("clamp_spring", "Clamp spring", "at the stop")


def spring_view(size: Sizes, spring: Spring, item: int) -> View:
    """Return one spring at rest, with its free length and its least length."""
    slot = spring.slot
    wire, mean = spring.wire(size), size(f"{slot}.mean_diameter_D")
    free, rest, least = (size(f"{slot}{x}") for x in (".free_length_L0", "_rest_length", "_least_length"))
    coils = size.number(f"{slot}.active_coils_n")
    pitch = (rest - 2 * wire) / coils
    # Coils that would cross each other, in a design that cannot be, have no bodies.
    across = math.copysign(wire, min(pitch, least - 2 * wire)) / 2
    top = mean / 2
    shapes: list[Drawable] = []
    halves = math.floor(2 * coils + 0.5)
    for k in (*range(1, halves, 2), *range(0, halves, 2)):  # half turns; those in front, which go down, come last
        high, low = (wire + pitch * (k + turn) / 2 for turn in ((0, 1) if k % 2 == 0 else (1, 0)))
        turn = ((low - across, -top, 1.0), (low + across, -top), (high + across, top, 1.0), (high - across, top))
        shapes.append(Area(turn, item, cut=False))
    for x in (0.0, rest - wire):
        ends = ((x, -top - wire / 2), (x + wire, -top - wire / 2), (x + wire, top + wire / 2), (x, top + wire / 2))
        shapes.append(Area(ends, item, cut=False))
    reach = top + wire
    shapes += [Line((x, -reach), (x, reach), LineKind.PHANTOM) for x in (least, free)]
    shapes.append(Line((0.0, 0.0), (free, 0.0), LineKind.CENTRE))
    end = -top - wire / 2
    way = (Dimension((least, -reach), (rest, end), spring.travel, "bottom"),) if spring.travel else ()
    return View(
        spring.name,
        tuple(shapes),
        (
            Dimension((0.0, top + wire / 2), (rest, top + wire / 2), f"{slot}_rest_length", "top"),
            Dimension((0.0, top + wire / 2), (free, reach), f"{slot}.free_length_L0", "top"),
            Dimension((0.0, end), (wire, end), f"{slot}.wire_diameter_d", "bottom"),
            Dimension((0.0, end), (least, -reach), f"{slot}_least_length", "bottom"),
            *way,
            Dimension((rest, -top), (rest, top), f"{slot}.mean_diameter_D", "right", diameter=True),
        ),
        own_scale=True,
    )


def return_spring(travel: str) -> Spring:
    """Return the springs that push the plate back, with the name of its travel to contact."""
    return Spring("return_spring", "Return spring", "at contact", travel)


def told_of_springs(springs: Sequence[Spring]) -> str:
    """Return in words which lengths of the springs are drawn."""
    words = "; ".join(f"{spring.name.lower()}: shortest {spring.shortest}" for spring in springs)
    return f"Springs are drawn as long as they are at rest, with their free length and their least length ({words})."
