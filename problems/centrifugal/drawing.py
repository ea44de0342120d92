"""Drawings of centrifugal clutches: front view, springs and the room along the shaft, which all of them share.

The front view is seen from the flyweights, at rest. Where flyweights and springs stand around the circle is assumed:
the model asks for room on it alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from problems.drawing_parts import SHAFT_OUT, Sizes, envelope, ring, shaft_end
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
    Slant,
    Vertex,
    View,
    Weight,
    diameter,
    disc,
)

PLATES, LINING, FLYWEIGHT, FIRST_SPRING = 1, 2, 3, 4
FRONT = "Front view"
TOP = math.pi / 2  # where the first flyweight stands [rad]
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
class Spring:
    """A set of springs in a drawing: its slot and name, when it is shortest, and the name of the way until then."""

    slot: str
    name: str
    shortest: str
    travel: str = ""

    @property
    def counted(self) -> str:
        """What their number is called."""
        return f"{self.slot}s"

    def outside(self, size: Sizes) -> float:
        """Outside diameter of the coils [mm]."""
        return size(f"{self.slot}.mean_diameter_D") + size(f"{self.slot}.wire_diameter_d")


CLAMP = Spring("clamp_spring", "Clamp spring", "at the stop")


@dataclass(frozen=True)
class Placed:
    """Something on the circle: its number in the parts list, angle [rad], half of its width and its wire [mm]."""

    item: int
    half: float
    wire: float = 0.0
    angle: float = 0.0


def at(radius: float, angle: float) -> XY:
    """Return the point at a radius and an angle."""
    return radius * math.cos(angle), radius * math.sin(angle)


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
    whole = "length" in size.design.values
    boss = FIRST_SPRING + len(springs)
    front = _front_view(size, flyweight, springs, springs_behind=springs_behind)
    views = [*([_room_view(size, boss)] if whole else []), front, mechanism]
    views += [_spring_view(size, spring, FIRST_SPRING + k) for k, spring in enumerate(springs)]
    items = [
        Item(PLATES, "Plates", 1, "steel", "together as one ring"),
        Item(LINING, "Lining", size.count("friction_surfaces"), size.part("friction_pair"), "behind the plate"),
        Item(FLYWEIGHT, flyweight.name, size.count(flyweight.counted), flyweight.material, flyweight.note),
    ]
    for k, spring in enumerate(springs):
        coils = size.number(f"{spring.slot}.total_coils_nt")
        note = f"{coils:g} coils, two of them closed ends"
        items.append(Item(FIRST_SPRING + k, spring.name, size.count(spring.counted), size.part(spring.slot), note))
    weights = [
        Weight((PLATES,), ("plates_mass",), "steel_density"),
        Weight((FLYWEIGHT,), ("flyweight_mass",), flyweight.density, FRONT),
    ]
    told = [
        "each of the plates: thickness, place along the shaft and shape; the model knows a thickness that they amount "
        "to together",
        "carrier of the linings and their thickness, cover, guides and seats of the springs",
        *omitted,
    ]
    if whole:
        items.append(Item(boss, "Boss on either shaft", 2, "steel", "places assumed"))
        weights.append(Weight((boss,), ("boss_mass",), "steel_density"))
        told.append("bores, keys and bearings")
    else:
        told.append("shaft, bosses and length: mass is that of plates, flyweights and springs")
    return Drawing(
        "front view and mechanism, released",
        tuple(views),
        tuple(items),
        omitted=tuple(told),
        remarks=(
            "Flyweights and springs are drawn at rest; where they stand around their circle is assumed. "
            "Double-dot-dash lines show the end of the way, and room that the model reckons with.",
            *remarks,
            *_crowded(size, springs, () if springs_behind else (flyweight,)),
        ),
        weights=tuple(weights),
    )


def _crowded(size: Sizes, springs: Sequence[Spring], flyweights: Sequence[Flyweight]) -> tuple[str, ...]:
    """Return the remark on springs that are drawn over each other, where they have no room on their circle."""
    taken = sum(size.count(spring.counted) * spring.outside(size) for spring in springs)
    taken += sum(size.count(one.counted) * size(one.size) for one in flyweights)
    if taken <= 2 * math.pi * size("rest_radius"):
        return ()
    return ("What stands on the circle of rest_radius has no room there beside each other: it is drawn overlapping.",)


def _front_view(size: Sizes, flyweight: Flyweight, springs: Sequence[Spring], *, springs_behind: bool) -> View:
    rest, end, across = size("rest_radius"), size("end_radius"), size("outer_diameter") / 2
    hub, inner, outer = size("hub_radius"), size("lining_inner_radius"), size("lining_outer_radius")
    half = size(flyweight.size) / 2
    placed = _in_order(size, springs)
    weights = [Placed(FLYWEIGHT, half, angle=TOP + t) for t in _even(size.count(flyweight.counted))]
    beside = _on_one_circle(weights, placed, rest)
    if springs_behind and beside is None:
        placed = _behind(weights, placed, rest)
    else:
        weights, placed = beside or _crowded_circle(weights, placed, rest)
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
        dimensions.append(Slant((0, wall[1]), (0, across), wall[0], apart=8.0))
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
            for t in _even(24)
        ]
        yield Balloon(max(found, key=lambda p: (_clearance(p, seats, but=item) > 0, -p[0])), item)
    inner, outer, hub = size("lining_inner_radius"), size("lining_outer_radius"), size("hub_radius")
    yield Balloon(_clear(seats, [(inner + outer) / 2], low=110), LINING)
    within = min(inner, rest) - hub
    yield Balloon(_clear(seats, [hub + share * within for share in (0.25, 0.4, 0.55)], low=195), PLATES)


def _clearance(point: XY, seats: Sequence[tuple[XY, Placed]], but: int = 0) -> float:
    """Return how far a point is from flyweights and rings of springs, ``but`` for those of one set [mm]."""
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


def _even(count: int) -> list[float]:
    """Return angles [rad] of things that stand evenly around a circle."""
    return [2 * math.pi * k / count for k in range(count)]


def _in_order(size: Sizes, springs: Sequence[Spring]) -> list[Placed]:
    """Return the springs of all sets, spread evenly among each other."""
    found = []
    for k, spring in enumerate(springs):
        one = Placed(FIRST_SPRING + k, spring.outside(size) / 2, size(f"{spring.slot}.wire_diameter_d"))
        count = size.count(spring.counted)
        found += [((j + 0.5) / count, one.item, one) for j in range(count)]
    return [one for _, _, one in sorted(found, key=lambda x: x[:2])]


def _on_one_circle(
    weights: Sequence[Placed], springs: Sequence[Placed], radius: float
) -> tuple[list[Placed], list[Placed]] | None:
    """Return evenly spread flyweights with the springs between them; None where they have no room there."""
    room = 2 * math.pi * radius / len(weights)
    placed: list[Placed] = []
    for k, weight in enumerate(weights):
        sector = [one for j, one in enumerate(springs) if j * len(weights) // len(springs) == k]
        gap = (room - 2 * weight.half - sum(2 * one.half for one in sector)) / (len(sector) + 1)
        if gap <= 0:
            return None
        along = weight.half + gap
        for one in sector:
            placed.append(replace(one, angle=weight.angle + (along + one.half) / radius))
            along += 2 * one.half + gap
    return list(weights), placed


def _crowded_circle(
    weights: Sequence[Placed], springs: Sequence[Placed], radius: float
) -> tuple[list[Placed], list[Placed]]:
    """Return flyweights and springs with the same gap between all of them, as the model reckons."""
    order = sorted(
        [((k + 0.5) / len(group), one.item, one) for group in (weights, springs) for k, one in enumerate(group)],
        key=lambda x: x[:2],
    )
    gap = (2 * math.pi * radius - sum(2 * one.half for _, _, one in order)) / len(order)
    along = 0.0
    found: list[Placed] = []
    for _, _, one in order:
        found.append(replace(one, angle=TOP + (along + one.half) / radius))
        along += 2 * one.half + gap
    turn = TOP - next(one.angle for one in found if one.item == FLYWEIGHT)
    found = [replace(one, angle=one.angle + turn) for one in found]
    return [one for one in found if one.item == FLYWEIGHT], [one for one in found if one.item != FLYWEIGHT]


def _behind(weights: Sequence[Placed], springs: Sequence[Placed], radius: float) -> list[Placed]:
    """Return evenly spread springs, turned so that of each set one is seen as well as can be."""

    def turned(turn: float) -> list[Placed]:
        return [replace(one, angle=TOP + turn + t) for one, t in zip(springs, _even(len(springs)), strict=True)]

    def seen(placed: Sequence[Placed]) -> float:
        best: dict[int, float] = {}
        for one in placed:
            apart = min(math.dist(at(radius, one.angle), at(radius, weight.angle)) for weight in weights)
            best[one.item] = max(best.get(one.item, 0.0), apart)
        return min(best.values())

    step = 2 * math.pi / len(springs)
    return max((turned(step * k / 12) for k in range(12)), key=lambda placed: round(seen(placed), 6))


def _room_view(size: Sizes, boss: int) -> View:
    """Return the room that the clutch takes along the shaft, with the bosses on both shafts."""
    long, across = size("length"), size("outer_diameter") / 2
    shaft, outside, out = size("shaft_diameter") / 2, size("boss_diameter") / 2, size("boss_length")
    broken = 2 * shaft * SHAFT_OUT
    return View(
        "Room along the shaft",
        (
            *envelope(0.0, long, 0.0, across),
            *shaft_end(0.0, -out, shaft, broken=broken),
            *shaft_end(long, long + out, shaft, broken=broken),
            ring(-out, 0.0, shaft, outside, boss),
            ring(long, long + out, shaft, outside, boss),
        ),
        (
            Dimension((0.0, across), (long, across), "length", "top"),
            Dimension((-out, outside), (0.0, outside), "boss_length", "top"),
            diameter(-out, shaft, "shaft_diameter", side="left"),
            diameter(-out, outside, "boss_diameter", side="left"),
        ),
        (Balloon((long + out / 2, -(shaft + outside) / 2), boss, "bottom"),),
        revolved=True,
    )


def _spring_view(size: Sizes, spring: Spring, item: int) -> View:
    """Return one spring at rest, with its free length and its least length."""
    slot = spring.slot
    wire, mean = size(f"{slot}.wire_diameter_d"), size(f"{slot}.mean_diameter_D")
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
