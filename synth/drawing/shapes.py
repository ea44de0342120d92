"""Shapes of a drawing: areas with a boundary of lines and arcs, lines, arcs and circles, in millimetres of the part.

In a section the axis of rotation is y = 0: x runs along it, y is the radius.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TypeAlias

XY: TypeAlias = tuple[float, float]
# A corner of a boundary; the third number is the bulge of the arc to the next corner: tan of a quarter of its angle,
# positive where the arc turns anticlockwise, as DXF has it. Two numbers: a straight line follows.
Vertex: TypeAlias = tuple[float, float] | tuple[float, float, float]
Box2: TypeAlias = tuple[float, float, float, float]  # least x, least y, most x, most y


class LineKind(StrEnum):
    """What a line means (ISO 128-2)."""

    OUTLINE = "outline"  # visible edges: wide
    THIN = "thin"  # imagined edges, bounds of details
    HIDDEN = "hidden"  # edges behind: dashed
    CENTRE = "centre"  # axes and circles of centres: long dash, dot
    PHANTOM = "phantom"  # neighbouring parts and envelopes, no part of the design: long dash, two dots


@dataclass(frozen=True)
class Area:
    """A cut or seen surface of one part.

    Parameters
    ----------
    outline : tuple of Vertex
        Boundary, anticlockwise; it is closed by itself.
    item : int
        Number of the part in the parts list.
    cut : bool
        Whether the section cuts it, so that it is hatched; shafts, balls, rollers and wire are not.
    holes : tuple of outlines
        Boundaries of openings.
    depth : float, optional
        Of a front view: how far the part reaches along the axis [mm]. None: the area is revolved about y = 0.
    half : bool
        Whether it goes half around the axis only, so that a section has it on the side where it is written and not on
        the other: coils of a helix.
    """

    outline: tuple[Vertex, ...]
    item: int
    cut: bool = True
    holes: tuple[tuple[Vertex, ...], ...] = ()
    depth: float | None = None
    half: bool = False

    @property
    def volume(self) -> float:
        """Volume of the part [mm3]: by Pappus' rule where it is revolved."""
        rings = [moments(self.outline), *(moments(hole) for hole in self.holes)]
        column = 1 if self.depth is None else 0
        net = abs(rings[0][column]) - sum(abs(m[column]) for m in rings[1:])
        if self.depth is not None:
            return net * self.depth
        return net * (math.pi if self.half else 2 * math.pi)


@dataclass(frozen=True)
class Line:
    """A straight line; centre lines reach beyond their ends by themselves."""

    a: XY
    b: XY
    kind: LineKind = LineKind.OUTLINE


@dataclass(frozen=True)
class Circle:
    """A circle."""

    centre: XY
    radius: float
    kind: LineKind = LineKind.OUTLINE


@dataclass(frozen=True)
class Arc:
    """An arc, anticlockwise from ``start`` to ``end`` [degrees]."""

    centre: XY
    radius: float
    start: float
    end: float
    kind: LineKind = LineKind.OUTLINE


Drawable: TypeAlias = Area | Line | Circle | Arc


def rectangle(x0: float, x1: float, y0: float, y1: float) -> tuple[Vertex, ...]:
    """Return a rectangle between two places along the axis and two radii.

    >>> round(Area(rectangle(0, 2, 10, 20), 1).volume / 3.14159265, 3)
    600.0
    """
    return (x0, y0), (x1, y0), (x1, y1), (x0, y1)


def disc(centre: XY, radius: float) -> tuple[Vertex, ...]:
    """Return a full circle as a boundary: two half circles.

    >>> round(Area(disc((0, 0), 2), 1, depth=1).volume / 3.14159265, 3)
    4.0
    """
    x, y = centre
    return (x + radius, y, 1.0), (x - radius, y, 1.0)


def corner(vertex: Vertex) -> tuple[float, float, float]:
    """Return a corner with its bulge."""
    return (vertex[0], vertex[1], vertex[2] if len(vertex) > 2 else 0.0)


def sides(outline: Sequence[Vertex]) -> Iterator[tuple[XY, XY, float]]:
    """Return the sides of a boundary: both ends and the bulge."""
    for here, there in zip(outline, (*outline[1:], outline[0]), strict=True):
        x, y, bulge = corner(here)
        yield (x, y), (there[0], there[1]), bulge


def arc_of(a: XY, b: XY, bulge: float) -> tuple[XY, float, float, float]:
    """Return centre, radius, start [rad] and turned angle [rad] of the arc of a side."""
    turned = 4 * math.atan(bulge)
    chord = math.dist(a, b)
    radius = chord / (2 * math.sin(abs(turned) / 2))
    apart = chord / 2 / math.tan(turned / 2)  # from the middle of the chord to the centre, to its left
    mid, ux, uy = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2), (b[0] - a[0]) / chord, (b[1] - a[1]) / chord
    centre = (mid[0] - uy * apart, mid[1] + ux * apart)
    return centre, radius, math.atan2(a[1] - centre[1], a[0] - centre[0]), turned


def moments(outline: Sequence[Vertex]) -> tuple[float, float]:
    """Return area [mm2] and its moment about y = 0 [mm3], both with the sign of the sense of the boundary."""
    area = moment = 0.0
    for (ax, ay), (bx, by), bulge in sides(outline):
        cross = ax * by - bx * ay
        area += cross / 2
        moment += cross * (ay + by) / 6
        if bulge:
            centre, radius, start, turned = arc_of((ax, ay), (bx, by), bulge)
            piece = radius**2 * (turned - math.sin(turned)) / 2
            # The centre of gravity of a segment lies on its axis of symmetry.
            apart = 4 * radius * math.sin(turned / 2) ** 3 / (3 * (turned - math.sin(turned)))
            area += piece
            moment += piece * (centre[1] + apart * math.sin(start + turned / 2))
    return area, moment


def flattened(outline: Sequence[Vertex], step: float = math.pi / 18) -> list[XY]:
    """Return a boundary as corners of straight lines, arcs in pieces of ``step`` [rad] at most."""
    points: list[XY] = []
    for a, b, bulge in sides(outline):
        points.append(a)
        if bulge:
            centre, radius, start, turned = arc_of(a, b, bulge)
            pieces = math.ceil(abs(turned) / step)
            angles = (start + turned * k / pieces for k in range(1, pieces))
            points += [(centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)) for t in angles]
    return points


def thickness(area: Area) -> float:
    """Thickness of an area: the short side of the rectangle with its surface and its perimeter [mm].

    >>> thickness(Area(rectangle(0, 2, 10, 20), 1))
    2.0
    """
    surface = abs(moments(area.outline)[0]) - sum(abs(moments(hole)[0]) for hole in area.holes)
    around = 0.0
    for outline in (area.outline, *area.holes):
        points = flattened(outline)
        around += sum(math.dist(p, q) for p, q in zip(points, [*points[1:], points[0]], strict=True))
    inner = (around / 4) ** 2 - surface
    return around / 4 - math.sqrt(inner) if inner > 0 else math.sqrt(max(surface, 0.0))


def points_of(shape: Drawable) -> list[XY]:
    """Return points between which a shape lies."""
    if isinstance(shape, Area):
        return flattened(shape.outline)
    if isinstance(shape, Line):
        return [shape.a, shape.b]
    (x, y), r = shape.centre, shape.radius
    if isinstance(shape, Circle):
        return [(x - r, y - r), (x + r, y + r)]
    span = (shape.end - shape.start) % 360 or 360
    angles = [math.radians(shape.start + span * k / 36) for k in range(37)]
    return [(x + r * math.cos(t), y + r * math.sin(t)) for t in angles]


def box_of(points: Sequence[XY]) -> Box2:
    """Return the box around points."""
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    return min(xs), min(ys), max(xs), max(ys)


def mirrored(shape: Drawable) -> Drawable:
    """Return a shape on the other side of y = 0."""
    if isinstance(shape, Area):
        return replace(shape, outline=_turned(shape.outline), holes=tuple(map(_turned, shape.holes)))
    if isinstance(shape, Line):
        return replace(shape, a=(shape.a[0], -shape.a[1]), b=(shape.b[0], -shape.b[1]))
    centre = (shape.centre[0], -shape.centre[1])
    if isinstance(shape, Circle):
        return replace(shape, centre=centre)
    return replace(shape, centre=centre, start=-shape.end, end=-shape.start)


def both_halves(shape: Drawable) -> Drawable:
    """Return an area with a side on y = 0 together with its other half, so that no edge is drawn there.

    Other shapes are returned as they are.

    >>> both_halves(Area(rectangle(0, 2, 0, 1), 1)).outline
    ((2, 0), (2, 1), (0, 1), (0, 0), (0, -1), (2, -1))
    """
    if not isinstance(shape, Area):
        return shape
    corners = [corner(v) for v in shape.outline]
    on_axis = [k for k, (x, y, bulge) in enumerate(corners) if y == bulge == 0 == corners[(k + 1) % len(corners)][1]]
    if len(on_axis) != 1:
        return shape
    first = on_axis[0] + 1
    upper = [*corners[first:], *corners[:first]]
    bulges = [bulge for _, _, bulge in upper[:-1]]
    lower = [(x, -y) for x, y, _ in upper[-2:0:-1]]
    points = [*((x, y) for x, y, _ in upper), *lower]
    outline = tuple(
        (x, y, bulge) if bulge else (x, y) for (x, y), bulge in zip(points, [*bulges, *reversed(bulges)], strict=True)
    )
    return replace(shape, outline=outline, holes=(*shape.holes, *map(_turned, shape.holes)))


def _turned(outline: tuple[Vertex, ...]) -> tuple[Vertex, ...]:
    return tuple((x, -y, -bulge) if bulge else (x, -y) for x, y, bulge in map(corner, outline))


def edges_behind(areas: Sequence[Area]) -> list[XY]:
    """Return the edges that are seen behind a section through the axis, where nothing is cut.

    Bores end in circles, which are lines across the axis from this side.

    Parameters
    ----------
    areas : list of Area
        The upper half of the section.

    Returns
    -------
    list of tuple
        Place along the axis and radius [mm].

    Examples
    --------
    >>> edges_behind([Area(rectangle(0, 20, 15, 40), 1)])
    [(0, 15), (20, 15)]
    """
    pieces = sorted(
        (min(p[0], q[0]), max(p[0], q[0]), p, q)
        for points in (flattened(area.outline) for area in areas)
        for p, q in zip(points, [*points[1:], points[0]], strict=True)
        if p[0] != q[0]
    )
    corners = sorted({(p[0], p[1]) for area in areas for p in area.outline})
    if not corners:
        return []
    span = corners[-1][0] - corners[0][0]
    near = 1e-7 * span
    edges: list[tuple[float, float]] = []
    free: dict[float, float] = {}
    for x, y in corners:
        if x not in free:
            free[x] = min(_innermost(pieces, x - near), _innermost(pieces, x + near))
        if 0 < y <= free[x] + 10 * near and not (edges and x - edges[-1][0] <= near):
            edges.append((x, y))
    return edges


def _innermost(pieces: Sequence[tuple[float, float, XY, XY]], x: float) -> float:
    """Return the least radius of what is cut at a place along the axis; infinite where there is nothing."""
    least = math.inf
    for low, high, (ax, ay), (bx, by) in pieces:
        if low > x:
            break
        if high > x:
            least = min(least, ay + (by - ay) * (x - ax) / (bx - ax))
    return least
