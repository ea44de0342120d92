"""What is written at the shapes of a drawing: dimensions, part numbers and bounds of details.

A dimension names a quantity of the design. Its text is measured from its points, never typed; a measure that is not
that of the quantity is refused.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from synth.drawing.shapes import XY, Box2

Edge: TypeAlias = Literal["top", "bottom", "left", "right"]


@dataclass(frozen=True)
class Dimension:
    """A length between two points, along x where it stands on top or at the bottom, along y at the left or right.

    The layout sets dimensions of a side beside or above each other, small ones next to the part.

    Parameters
    ----------
    a, b : point
        What is measured [mm].
    quantity : str
        Name of a variable, count, derived quantity, step or requirement of the design, or ``slot.column``.
    side : {"top", "bottom", "left", "right"}
        Where it stands.
    factor : float
        What is measured over the quantity: 2 where a radius of the design is drawn as a diameter.
    diameter : bool
        Whether it is one of a circle.
    times : int
        How many such places there are, if more than one: ``6 x 2``.
    """

    a: XY
    b: XY
    quantity: str
    side: Edge
    factor: float = 1.0
    diameter: bool = False
    times: int = 1

    @property
    def along(self) -> Literal["x", "y"]:
        """The direction in which it measures."""
        return "x" if self.side in ("top", "bottom") else "y"

    @property
    def measure(self) -> float:
        """What is measured [mm]."""
        axis = 0 if self.along == "x" else 1
        return abs(self.b[axis] - self.a[axis])


@dataclass(frozen=True)
class Slant:
    """A length between two points along the line through them, written beside it.

    ``apart`` is the distance of the dimension line on paper [mm], positive to the left of the way from a to b.
    Other parameters as for :class:`Dimension`.
    """

    a: XY
    b: XY
    quantity: str
    apart: float = 8.0
    factor: float = 1.0
    times: int = 1
    diameter: bool = False

    @property
    def measure(self) -> float:
        """What is measured [mm]."""
        return math.dist(self.a, self.b)


@dataclass(frozen=True)
class Angle:
    """An angle at a point, anticlockwise from the direction of ``a`` to that of ``b``.

    ``radius`` is that of the dimension line on paper [mm]; ``factor`` as for :class:`Dimension`.
    """

    vertex: XY
    a: XY
    b: XY
    quantity: str
    radius: float = 25.0
    factor: float = 1.0

    @property
    def ends(self) -> tuple[float, float]:
        """Directions of both sides [rad], the second after the first."""
        first, second = (math.atan2(p[1] - self.vertex[1], p[0] - self.vertex[0]) for p in (self.a, self.b))
        return first, second if second > first else second + 2 * math.pi

    @property
    def measure(self) -> float:
        """What is measured [rad]."""
        first, second = self.ends
        return second - first


@dataclass(frozen=True)
class Radius:
    """A radius of an arc or circle, with a line from the point at ``angle`` [degrees] to its text beside the view."""

    centre: XY
    radius: float
    quantity: str
    angle: float = 45.0
    side: Edge = "left"
    factor: float = 1.0
    diameter: bool = False
    times: int = 1

    @property
    def measure(self) -> float:
        """What is measured [mm]: the diameter where one is meant."""
        return self.radius * (2 if self.diameter else 1)

    @property
    def at(self) -> XY:
        """The point of the circle that the line leads to."""
        t = math.radians(self.angle)
        return self.centre[0] + self.radius * math.cos(t), self.centre[1] + self.radius * math.sin(t)


Measured: TypeAlias = Dimension | Slant | Angle | Radius


def diameter(x: float, radius: float, quantity: str, *, side: Edge = "right", factor: float = 1.0) -> Dimension:
    """Return the dimension of a diameter of what is revolved.

    Parameters
    ----------
    x : float
        Where along the axis the diameter is [mm].
    radius : float
        Half of it [mm].
    quantity : str
        What the design calls it.
    side : {"right", "left"}
        Where the dimension stands.
    factor : float
        2 where the quantity is the radius.
    """
    return Dimension((x, -radius), (x, radius), quantity, side, factor=factor, diameter=True)


@dataclass(frozen=True)
class Balloon:
    """The number of a part, with a line that ends at a point inside it."""

    at: XY
    item: int
    side: Edge = "left"


@dataclass(frozen=True)
class Detail:
    """A piece of a view that is drawn again, larger.

    Parameters
    ----------
    letter : str
        X, Y, Z: at the piece and over the detail.
    window : box
        Least x, least y, most x, most y [mm].
    dimensions : tuple
        What is measured there.
    balloons : tuple of Balloon
    least : float, optional
        The thinnest part that must be seen [mm]: the detail is enlarged until it is plain on paper, if there is room.
        Without it the detail is as large as its room allows.
    side : edge
        Where its letter stands.
    """

    letter: str
    window: Box2
    dimensions: tuple[Measured, ...] = ()
    balloons: tuple[Balloon, ...] = ()
    least: float | None = None
    side: Edge = "left"
