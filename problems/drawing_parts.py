"""What drawings of several families have: sizes in millimetres by name, rings and envelopes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from synth import Design
from synth.drawing import Area, Drawable, Line, LineKind, rectangle
from synth.errors import InputError

MM = 1e3  # from SI
NEIGHBOURS = "Double-dot-dash lines are neighbours and envelopes: room that the model reckons with, no shapes."


class Sizes:
    """Sizes of a design in millimetres, by the names that dimensions use.

    Parameters
    ----------
    spec : mapping
        What the hook is told: requirements in SI.
    design : Design
        The design.
    """

    def __init__(self, spec: Mapping[str, Any], design: Design) -> None:
        self.spec, self.design = spec, design

    def __call__(self, name: str) -> float:
        """Return a length [mm]: of a value, a step, a requirement, or a column of a part (``slot.column``)."""
        return MM * self.number(name)

    def number(self, name: str) -> float:
        """Return a quantity in SI.

        Raises
        ------
        InputError
            The table of a part has no number there: a user's own may lack what nothing but the drawing reads.
        """
        slot, _, column = name.partition(".")
        if column:
            part = self.design.parts[slot]
            return _there(part.get(column), f"table {part['table']}, row {part}, column {column}")
        for numbers in (self.design.values, self.spec):
            if numbers.get(name) is not None:
                return float(numbers[name])
        return _there(self.design.steps[name], name)

    def count(self, name: str) -> int:
        """Return a number of things."""
        return round(self.number(name))

    def part(self, slot: str) -> str:
        """Return the designation of the row that fills a slot; empty without such a slot."""
        return str(self.design.parts[slot]) if slot in self.design.parts else ""


def _there(value: Any, name: str) -> float:
    """Return a number that a drawing shows."""
    if value is None or math.isnan(value):
        raise InputError(name, None, "a number, which the drawing shows")
    return float(value)


def ring(x0: float, x1: float, inner: float, outer: float, item: int) -> Area:
    """Return the section of a ring between two places along the axis and two radii [mm]."""
    return Area(rectangle(x0, x1, inner, outer), item)


def envelope(x0: float, x1: float, inner: float, outer: float) -> tuple[Drawable, ...]:
    """Return room that something takes whose shape the model does not know: a rectangle of phantom lines [mm].

    What reaches to the axis has no line there.
    """
    corners = [(x1, inner), (x1, outer), (x0, outer), (x0, inner)]
    corners += [(x1, inner)] if inner > 0 else []
    return tuple(Line(p, q, LineKind.PHANTOM) for p, q in pairwise(corners))
