"""Where the names of points find room in a drawing: beside their point, on no other one and on no other name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Box:
    """A rectangle, in the units of the drawing; downwards is more."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: Box) -> bool:
        """True if two boxes have more in common than an edge."""
        across = self.left < other.right and other.left < self.right
        return across and self.top < other.bottom and other.top < self.bottom

    def holds(self, other: Box) -> bool:
        """True if another box lies within this one."""
        across = self.left <= other.left and other.right <= self.right
        return across and self.top <= other.top and other.bottom <= self.bottom


def label_spots(
    points: Sequence[Box],
    sizes: Sequence[tuple[float, float] | None],
    field: Box,
    lines: Sequence[Box] = (),
    gap: float = 1.0,
    integer: bool = False,
) -> list[Box | None]:
    """Positions of the names of points; None where there is no room.

    Parameters
    ----------
    points : list of Box
        What the points cover, the ones first whose names matter most.
    sizes : list of tuple
        Width and height of each name; None for a point without.
    field : Box
        Names stay within it.
    lines : list of Box
        What names cover only where there is no other room.
    gap : float
        Between a point and a name beside it.
    integer : bool
        Whether places are whole numbers, as the cells of a terminal.

    Examples
    --------
    >>> field = Box(0, 0, 10, 3)
    >>> label_spots([Box(2, 1, 3, 2), Box(4, 1, 5, 2)], [(2, 1), (2, 1)], field, integer=True)
    [Box(left=4.0, top=0, right=6.0, bottom=1), Box(left=6.0, top=0, right=8.0, bottom=1)]
    """
    spots: list[Box | None] = []
    occupied = list(points)
    for point, size in zip(points, sizes, strict=True):
        free = (
            []
            if size is None
            else [
                box
                for box in _positions(point, size, gap, integer)
                if field.holds(box) and not any(box.meets(other) for other in occupied)
            ]
        )
        clear = [box for box in free if not any(box.meets(line) for line in lines)]
        spot = next(iter([*clear, *free]), None)
        spots.append(spot)
        if spot is not None:
            occupied.append(spot)
    return spots


def _positions(point: Box, size: tuple[float, float], gap: float, integer: bool) -> Iterator[Box]:
    """Yield the places beside a point, those first that are read as its name at once."""
    width, height = size
    right, left = point.right + gap, point.left - gap - width
    above, level, below = point.top - height, (point.top + point.bottom - height) / 2, point.bottom
    middle = (point.left + point.right - width) / 2
    if integer:
        level, middle = level // 1, middle // 1
    for x, y in (
        (right, above),
        (right, level),
        (left, below),
        (left, level),
        (left, above),
        (right, below),
        (middle, above),
        (middle, below),
    ):
        yield Box(x, y, x + width, y + height)
