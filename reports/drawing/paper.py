"""What stands on paper: positions in millimetres from the lower left corner, y upwards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from synth.drawing import XY, Box2, Detail, Drawable, LineKind, Measured, View

from .lettering import width

ARROW = 3.0  # length of an arrow; a third as wide


@dataclass(frozen=True)
class Text:
    """A text at its place; ``anchor`` start, middle or end of the base line, ``turn`` in degrees.

    ``full_text`` is the text before it was cut to fit.
    """

    at: XY
    text: str
    height: float
    anchor: str = "start"
    turn: float = 0.0
    bold: bool = False
    full_text: str = ""

    @property
    def corners(self) -> list[XY]:
        """The corners of the box around it."""
        left, right = self._ends(width(self.text, self.height) * (1.08 if self.bold else 1.0))
        below, above = -0.28 * self.height, 1.05 * self.height
        return [self._turned(u, v) for u, v in ((left, below), (right, below), (right, above), (left, above))]

    @property
    def base_line(self) -> tuple[XY, XY]:
        """The ends of the line on which the letters stand."""
        left, right = self._ends(width(self.text, self.height))
        return self._turned(left, 0.0), self._turned(right, 0.0)

    def _ends(self, length: float) -> tuple[float, float]:
        left = {"start": 0.0, "middle": -length / 2, "end": -length}[self.anchor]
        return left, left + length

    def _turned(self, along: float, above: float) -> XY:
        c, s = math.cos(math.radians(self.turn)), math.sin(math.radians(self.turn))
        return self.at[0] + c * along - s * above, self.at[1] + s * along + c * above


@dataclass(frozen=True)
class Stroke:
    """A line through points; ``arrows`` says at which of its ends arrows are (first, last)."""

    points: tuple[XY, ...]
    kind: LineKind = LineKind.THIN
    arrows: tuple[bool, bool] = (False, False)
    line_width: float | None = None
    closed: bool = False


@dataclass(frozen=True)
class Ring:
    """A circle on paper: of a part number, or of the symbol of the projection; ``filled`` for the end of a leader."""

    centre: XY
    radius: float
    filled: bool = False


@dataclass(frozen=True)
class Bow:
    """The arc of the dimension line of an angle, anticlockwise between two directions [rad]."""

    centre: XY
    radius: float
    start: float
    end: float
    inwards: bool = False  # arrows from outside


@dataclass(frozen=True)
class PlacedMeasure:
    """A dimension on paper: lines and text, and what the writer of a DXF needs to make a real one.

    ``base`` is a point of the dimension line, ``outside`` tells that its arrows point at each other.
    """

    measured: Measured
    text: Text
    strokes: tuple[Stroke, ...]
    base: XY
    outside: bool = False
    bows: tuple[Bow, ...] = ()


@dataclass(frozen=True)
class Callout:
    """A part number or the letter of a detail, with its line."""

    text: Text
    ring: Ring | None
    strokes: tuple[Stroke, ...]
    dot: Ring | None = None


@dataclass(frozen=True)
class PlacedView:
    """A view or a detail on paper.

    Parameters
    ----------
    view : View
    detail : Detail or None
        The piece that is drawn; None: the whole view.
    scale : float
        Paper over part.
    origin : point
        Where the point (0, 0) of the part is on paper.
    shapes : tuple
        In millimetres of the part.
    measures, callouts : tuple
    heading : Text or None
    window : box
        What is seen of the shapes, on paper.
    region : box
        All that belongs to it, on paper.
    """

    view: View
    detail: Detail | None
    scale: float
    origin: XY
    shapes: tuple[Drawable, ...]
    measures: tuple[PlacedMeasure, ...]
    callouts: tuple[Callout, ...]
    heading: Text | None
    window: Box2
    region: Box2
    bounds: tuple[Stroke, ...] = ()

    def on_paper(self, point: XY) -> XY:
        """Point of the part in the coordinates of the paper."""
        return self.origin[0] + self.scale * point[0], self.origin[1] + self.scale * point[1]


@dataclass(frozen=True)
class PaperSheet:
    """A sheet: its size and name, frame and lists, and the views."""

    name: str
    size: XY
    scale: float
    title: str
    frame: Box2
    strokes: tuple[Stroke, ...]
    rings: tuple[Ring, ...]
    texts: tuple[Text, ...]
    views: tuple[PlacedView, ...]
    boxes: tuple[Box2, ...] = field(default=())  # of title block, parts list and notes


def scale_label(scale: float) -> str:
    """Return a scale in words.

    >>> scale_label(0.5), scale_label(2)
    ('1:2', '2:1')
    """
    return f"{scale:g}:1" if scale >= 1 else f"1:{1 / scale:g}"


def shown(measure: float) -> str:
    """Return a length [mm] as a dimension says it: to a hundredth, below a tenth of a millimetre with three digits.

    >>> shown(204), shown(58.6312), shown(0.0423)
    ('204', '58.63', '0.0423')
    """
    if 0 < abs(measure) < 0.1:
        return f"{measure:.3g}"
    return f"{measure:.2f}".rstrip("0").rstrip(".")


def overlap(a: Sequence[XY], b: Sequence[XY], slack: float = 1e-6) -> bool:
    """Return whether two convex figures overlap: no line of theirs separates them."""
    for one, other in ((a, b), (b, a)):
        for p, q in zip(one, (*one[1:], one[0]), strict=True):
            normal = (q[1] - p[1], p[0] - q[0])
            sides = [[normal[0] * x + normal[1] * y for x, y in figure] for figure in (one, other)]
            if min(sides[1]) >= max(sides[0]) - slack or min(sides[0]) >= max(sides[1]) - slack:
                return False
    return True
