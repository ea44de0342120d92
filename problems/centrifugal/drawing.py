"""Drawings of centrifugal clutches: front view, springs and the room along the shaft, which all of them share.

The front view is seen from the flyweights, at rest. Where flyweights and springs stand around the circle is assumed:
the model asks for room on it alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from synth.drawing import (
    XY,
    Area,
    Balloon,
    Circle,
    Dimension,
    Drawable,
    Drawing,
    Item,
    Line,
    LineKind,
    Measured,
    Radius,
    Vertex,
    View,
    Weight,
    disc,
)

from ..components.shaft.drawing import drawn_shaft
from ..components.springs.drawing import Spring, spring_view
from ..drawing_parts import Sizes, envelope
from .places import FIRST_SPRING, FLYWEIGHT, TOP, Placed, at, even, places

PLATES, LINING = 1, 2
FRONT = "Front view"
CORNER = 1.4  # of half a weight: how far its corners reach
RADII_FROM, RADII_STEP = 38.0, 17.0  # degrees: where the largest radius is measured, and the next ones below it


@dataclass(frozen=True)
class Flyweight:
    """What a flyweight looks like from the front.

    Attributes
    ----------
    name, material, note : str
        In the parts list.
    counted : str
        What their number is called.
    size : str
        What their radial size is called.
    depth : float
        How far they reach along the axis [mm], on average.
    round : bool
        Whether they are balls.
    density : str
        What it is called.
    """

    name: str
    material: str
    counted: str
    size: str
    depth: float
    round: bool
    density: str
    note: str = ""

    def outline(self, size: Sizes, radius: float, angle: float) -> tuple[Vertex, ...]:
        """Return its outline with the centre at a radius [mm] and an angle [rad]."""
        centre, half = at(radius, angle), size(self.size) / 2
        if self.round:
            return disc(centre, half)
        c, s = math.cos(angle), math.sin(angle)
        corners = (-half, -half), (half, -half), (half, half), (-half, half)
        return tuple((centre[0] + x * c - y * s, centre[1] + x * s + y * c) for x, y in corners)


@dataclass(frozen=True)
class Along:
    """What a design knows along its shaft, and what it does not."""

    omitted: str
    views: tuple[View, ...] = ()
    items: tuple[Item, ...] = ()
    weights: tuple[Weight, ...] = ()


PARTS_ALONE = Along("shaft, bosses and length: mass is that of plates, flyweights and springs")


def clutch_drawing(
    size: Sizes,
    flyweight: Flyweight,
    springs: Sequence[Spring],
    mechanism: View,
    *,
    omitted: Sequence[str],
    remarks: Sequence[str],
    springs_behind: bool,
) -> Drawing:
    """Return the drawing of a centrifugal clutch.

    Parameters
    ----------
    size : Sizes
    flyweight : Flyweight
    springs : list of Spring
    mechanism : View
        Ramp or lever.
    omitted, remarks : list of str
        Those of the mechanism.
    springs_behind : bool
        Whether springs may stand behind flyweights: they have their circle to themselves.
    """
    boss = FIRST_SPRING + len(springs)
    along = _with_room(size, boss) if "length" in size.design.values else PARTS_ALONE
    front = _front_view(size, flyweight, springs, springs_behind=springs_behind)
    views = [*along.views, front, mechanism]
    views += [spring_view(size, spring, FIRST_SPRING + k) for k, spring in enumerate(springs)]
    items = [
        Item(PLATES, "Plates", 1, "steel", "together as one ring"),
        Item(LINING, "Lining", size.count("friction_surfaces"), size.part("friction_pair"), "behind the plate"),
        Item(FLYWEIGHT, flyweight.name, size.count(flyweight.counted), flyweight.material, flyweight.note),
    ]
    items += [spring.item(size, FIRST_SPRING + k) for k, spring in enumerate(springs)]
    weights = [
        Weight((PLATES,), ("plates_mass",), "steel_density"),
        Weight((FLYWEIGHT,), ("flyweight_mass",), flyweight.density, FRONT),
    ]
    omitted = (
        "each of the plates: thickness, place along the shaft and shape; the model knows a thickness that they amount "
        "to together",
        "carrier of the linings and their thickness, cover, guides and seats of the springs",
        *omitted,
        along.omitted,
    )
    return Drawing(
        "front view and mechanism, released",
        tuple(views),
        (*items, *along.items),
        omitted=omitted,
        remarks=(
            "Flyweights and springs are drawn at rest; where they stand around their circle is assumed. "
            "Double-dot-dash lines show the end of the way, and room that the model reckons with.",
            *remarks,
            *_crowded(size, springs, () if springs_behind else (flyweight,)),
        ),
        weights=(*weights, *along.weights),
    )


def _with_room(size: Sizes, boss: int) -> Along:
    """Room along the shaft and bosses of a number in the parts list."""
    return Along(
        "bores, keys and bearings",
        (_room_view(size, boss),),
        (Item(boss, "Boss on either shaft", 2, "steel", "places assumed"),),
        (Weight((boss,), ("boss_mass",), "steel_density"),),
    )


def _crowded(size: Sizes, springs: Sequence[Spring], flyweights: Sequence[Flyweight]) -> tuple[str, ...]:
    """Return the remark on springs that are drawn over each other, where they have no room on their circle."""
    taken = sum(spring.count(size) * spring.outside(size) for spring in springs)
    taken += sum(size.count(one.counted) * size(one.size) for one in flyweights)
    if taken <= 2 * math.pi * size("rest_radius"):
        return ()
    return ("What stands on the circle of rest_radius has no room there beside each other: it is drawn overlapping.",)


def _front_view(size: Sizes, flyweight: Flyweight, springs: Sequence[Spring], *, springs_behind: bool) -> View:
    rest, end, across = size("rest_radius"), size("end_radius"), size("outer_diameter") / 2
    hub, inner, outer = size("hub_radius"), size("lining_inner_radius"), size("lining_outer_radius")
    half = size(flyweight.size) / 2
    weights, placed = places(
        size, Placed(FLYWEIGHT, half), size.count(flyweight.counted), springs, behind=springs_behind
    )
    plates = Area(
        disc((0, 0), across), PLATES, cut=False, holes=(disc((0, 0), hub),), depth=size("equivalent_plate_thickness")
    )
    shapes: list[Drawable] = [plates]
    shapes += [Circle((0, 0), radius, LineKind.HIDDEN) for radius in (inner, outer)]
    for one in placed:
        centre = at(rest, one.angle)
        hole = disc(centre, one.half - one.wire)
        shapes.append(Area(disc(centre, one.half), one.item, cut=False, holes=(hole,)))
    for one in weights:
        outline = flyweight.outline(size, rest, one.angle)
        shapes.append(Area(outline, FLYWEIGHT, cut=False, depth=flyweight.depth))
    shapes += _outline_at_end(size, flyweight, end)
    for radius in (rest, end):
        shapes.append(Circle((0, 0), radius, LineKind.CENTRE))
    reach = across + 0.02 * across
    shapes += [Line((-reach, 0), (reach, 0), LineKind.CENTRE), Line((0, -reach), (0, reach), LineKind.CENTRE)]
    radii = sorted(
        [
            (rest, "rest_radius"),
            (end, "end_radius"),
            (inner, "lining_inner_radius"),
            (outer, "lining_outer_radius"),
            (hub, "hub_radius"),
        ],
        reverse=True,
    )
    rim = outer + size("rim_width") >= end + half + size("wall_thickness")
    wall = ("rim_width", outer) if rim else ("wall_thickness", end + half)
    dimensions: list[Measured] = [
        Dimension((-across, 0), (across, 0), "outer_diameter", "bottom", diameter=True),
        *(Radius((0, 0), radius, name, RADII_FROM - k * RADII_STEP, "right") for k, (radius, name) in enumerate(radii)),
    ]
    if across - wall[1] > 0:
        dimensions.append(Dimension((0, wall[1]), (0, across), wall[0], "right"))
    return View(FRONT, tuple(shapes), tuple(dimensions), tuple(_front_balloons(size, weights, placed)))


def _outline_at_end(size: Sizes, flyweight: Flyweight, end: float) -> Iterator[Drawable]:
    """Yield the first flyweight at the end of its way."""
    if flyweight.round:
        yield Circle(at(end, TOP), size(flyweight.size) / 2, LineKind.PHANTOM)
        return
    corners = [(v[0], v[1]) for v in flyweight.outline(size, end, TOP)]
    for p, q in zip(corners, [*corners[1:], corners[0]], strict=True):
        yield Line(p, q, LineKind.PHANTOM)


def _front_balloons(size: Sizes, weights: Sequence[Placed], springs: Sequence[Placed]) -> Iterator[Balloon]:
    rest = size("rest_radius")
    seats = [(at(rest, one.angle), one) for one in (*springs, *weights)]
    left = max(weights, key=lambda one: (math.cos(one.angle) < -0.3, math.sin(one.angle) * -math.cos(one.angle)))
    yield Balloon(at(rest, left.angle), FLYWEIGHT)
    for item in sorted({one.item for one in springs}):
        found = [
            (x + (one.half - one.wire / 2) * math.cos(t), y + (one.half - one.wire / 2) * math.sin(t))
            for (x, y), one in seats
            if one.item == item
            for t in even(24)
        ]
        yield Balloon(max(found, key=lambda p: (_clearance(p, seats, but=item) > 0, -p[0])), item)
    inner, outer, hub = size("lining_inner_radius"), size("lining_outer_radius"), size("hub_radius")
    yield Balloon(_clear(seats, [(inner + outer) / 2], low=110), LINING)
    within = min(inner, rest) - hub
    yield Balloon(_clear(seats, [hub + share * within for share in (0.25, 0.4, 0.55)], low=195), PLATES)


def _clearance(point: XY, seats: Sequence[tuple[XY, Placed]], but: int = 0) -> float:
    """Distance of a point from flyweights and rings of springs, ``but`` for those of one set [mm]."""
    return min(
        abs(math.dist(point, centre) - one.half) - one.wire
        if one.wire
        else math.dist(point, centre) - CORNER * one.half
        for centre, one in seats
        if one.item != but
    )


def _clear(seats: Sequence[tuple[XY, Placed]], radii: Sequence[float], low: int) -> XY:
    """Return a point at the left on one of some radii, as far from all that stands on the circle as can be."""
    points = [at(radius, math.radians(t)) for radius in radii for t in range(low, 255, 5)]
    return max(points, key=lambda p: _clearance(p, seats))


def _room_view(size: Sizes, boss: int) -> View:
    """Return the room that the clutch takes along the shaft, with the bosses on both shafts."""
    long, across = size("length"), size("outer_diameter") / 2
    shaft = drawn_shaft(size)
    out = shaft.boss_length
    ends = shaft.drawn((0.0, -out), (long, long + out), bosses=((-out, 0.0),))
    return View(
        "Room along the shaft",
        (*envelope(0.0, long, 0.0, across), *ends.shapes, shaft.boss(-out, boss), shaft.boss(long, boss)),
        (Dimension((0.0, across), (long, across), "length", "top"), *ends.dimensions),
        (Balloon((long + out / 2, -(shaft.radius + shaft.boss_radius) / 2), boss, "bottom"),),
        revolved=True,
    )
