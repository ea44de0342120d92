"""Drawing of a roller coupling: section along one guide, and float, rollers and pins from the front.

It stands in the position in which the middle of the float lies on the axis of shaft 2, and the guide of arm 1 stands
upright. In the front view this middle is (0, 0); the section shows the plane x = 0 of the front view.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from synth import Design
from synth.drawing import (
    XY,
    Angle,
    Area,
    Balloon,
    Circle,
    Dimension,
    Drawable,
    Drawing,
    Hatch,
    Item,
    Line,
    LineKind,
    Measured,
    Radius,
    Slant,
    Vertex,
    View,
    Weight,
    disc,
    rectangle,
)

from ..components.drawn import DrawnComponent
from ..components.shaft.drawing import SHAFT_OUT, drawn_shaft
from ..drawing_parts import Sizes

FLOAT, ROLLER, PIN, ARM, BOSS = 1, 2, 3, 4, 5
SECTION, FRONT = "Section along guide I", "Float from the left, cut in its middle, without arm 1"


class _Shape:
    """Sizes of a coupling [mm], and where things are."""

    def __init__(self, size: Sizes) -> None:
        self.size = size
        self.angle = size.number("guide_angle")
        self.square = math.isclose(self.angle, math.pi / 2, rel_tol=1e-9)
        self.offset, self.arm = size("effective_offset"), size("arm_radius")
        self.roller, self.pin = size("roller.outer_diameter") / 2, size("roller.bore") / 2
        self.half, self.outside = size("guide_half_length"), size("float_radius")
        self.wide, self.roller_width = size("float_width"), size("roller.width")
        self.has_bosses = "length" in size.design.values
        self.counter = size.number("counter_floats") > 0
        # Faces of the arms: a gap beside what is wider, float or roller; a counter float takes room before arm 2.
        beside = max(self.wide, self.roller_width) / 2
        self.beside = beside
        self.face_1 = -beside - size("pin_gap")
        self.face_2 = beside + size("pin_gap") + (self.wide + size("pin_gap") if self.counter else 0.0)
        self.arm_half, self.bar = size("arm_length") / 2, size("arm_width") / 2
        self.end_1, self.end_2 = self.face_1 - size("arm_thickness"), self.face_2 + size("arm_thickness")
        out = drawn_shaft(size).boss_length if self.has_bosses else 0.0
        self.left, self.right = self.end_1 - out, self.end_2 + out
        self.top = max(self.offset + self.arm_half, self.outside)
        self.along_2 = (math.sin(self.angle), math.cos(self.angle))

    @property
    def reach(self) -> float:
        """How far a roller reaches beyond the end of its guide over a turn."""
        return self.offset / math.sin(self.angle) + self.arm + self.roller - self.half

    @property
    def arms(self) -> list[tuple[XY, float]]:
        """Directions from the middle of the float to the four guide ends, anticlockwise, with the angle to the next."""
        x, y = self.along_2
        beside = math.pi - self.angle
        return [((x, y), self.angle), ((0.0, 1.0), beside), ((-x, -y), self.angle), ((0.0, -1.0), beside)]

    def corner(self, angle: float) -> float:
        """Distance from the middle, along the guides, at which two of them meet whose directions have an angle."""
        return self.roller / math.tan(angle / 2)

    def guides(self) -> tuple[Vertex, ...]:
        """Return the boundary of both guides."""
        points: list[Vertex] = []
        for (ux, uy), angle in self.arms:
            nx, ny = -uy, ux
            for along, across in (
                (self.half, -self.roller),
                (self.half, self.roller),
                (self.corner(angle), self.roller),
            ):
                points.append((along * ux + across * nx, along * uy + across * ny))
        return tuple(points)

    def rollers(self) -> list[XY]:
        """Return the centres of all rollers, those of arm 1 first."""
        x, y = self.along_2
        first = [(0.0, self.offset + self.arm), (0.0, self.offset - self.arm)]
        return [*first, (self.arm * x, self.arm * y), (-self.arm * x, -self.arm * y)]


def coupling_drawing(spec: Mapping[str, Any], design: Design) -> Drawing:
    """Return the drawing of a roller coupling.

    Parameters
    ----------
    spec : mapping
        What the hook is told.
    design : Design
        The design.
    """
    size = Sizes(spec, design)
    shape = _Shape(size)
    items = [
        Item(FLOAT, "Float", 1, size.part("float_material"), hatch=Hatch.RIGHT),
        Item(ROLLER, "Roller", 4, size.part("roller")),
        Item(PIN, "Pin", 4, "steel", "as thick as the bore of the roller"),
        Item(ARM, "Arm", 2, "steel", "bar of usual proportions, assumed", Hatch.LEFT),
    ]
    weights = [
        Weight((FLOAT,), ("float_mass",), "float_material.density", FRONT),
        Weight((ARM,), ("arms_mass",), "steel_density", SECTION),
    ]
    if shape.has_bosses:
        items.append(Item(BOSS, "Boss of an arm", 2, "steel", "place as the length counts it", Hatch.RIGHT))
        weights.append(Weight((BOSS,), ("boss_mass",), "steel_density", SECTION, times=2.0))
    return Drawing(
        "section and front view",
        (_section(shape), _front(shape)),
        tuple(items),
        omitted=tuple(_omitted(shape)),
        remarks=tuple(_remarks(shape)),
        weights=tuple(weights),
    )


def _omitted(shape: _Shape) -> Iterator[str]:
    """What the drawing does not show."""
    if shape.counter:
        yield "counter float: the model knows its mass and the room it takes, drawn with double-dot-dash lines"
    if not shape.has_bosses:
        yield "shafts and bosses of the arms"
    yield "how pins are fastened to the arms and rollers held on the pins, inside of the rollers"
    yield "keys, and what holds the arms along their shafts"


def _remarks(shape: _Shape) -> Iterator[str]:
    """What a reader of the drawing must know."""
    yield (
        "The middle of the float is drawn on the axis of shaft 2; twice per turn it runs around the circle that has "
        "the distance of both axes as its diameter."
        if shape.offset > 0
        else "The shafts are in line."
    )
    if shape.reach > 0:
        yield (
            "The run-out is counted to the middle of a roller: rollers reach beyond the ends of the guides, where the "
            "rim of the float must be cut free for them. The model does not know how."
        )
    if shape.size.number("shaft_angle") > 0:
        yield "The shafts are at an angle; they are drawn parallel, with the offset seen in the plane of the float."
    yield "Double-dot-dash lines are neighbours and envelopes."


def _front(shape: _Shape) -> View:
    """Return the float with rollers and pins."""
    e, across, r, d = shape.offset, shape.outside, shape.arm, shape.roller
    (x, y), swept = shape.along_2, shape.size("outer_diameter") / 2
    shapes: list[Drawable] = [
        *((Circle((0.0, e), swept, LineKind.PHANTOM),) if e > 0 else ()),
        *_behind(shape),
        Area(disc((0.0, 0.0), across), FLOAT, holes=(shape.guides(),), depth=shape.wide),
    ]
    for centre in shape.rollers():
        shapes += [Area(disc(centre, d), ROLLER, cut=False, depth=0.0)]
        shapes += [Area(disc(centre, shape.pin), PIN, cut=False, depth=0.0)]
    shapes += [
        Line((0.0, min(-across, e - swept)), (0.0, e + swept), LineKind.CENTRE),
        Line((-across * x, -across * y), (across * x, across * y), LineKind.CENTRE),
        *((Line((-d, k), (d, k), LineKind.CENTRE) for k in (e, e + r, e - r)) if e > 0 else ()),
    ]
    t = 0.75 * math.pi
    middle = (across * math.cos(t) * 0.9, -across * math.sin(t) * 0.9)
    balloons = (
        Balloon(middle, FLOAT, "bottom"),
        Balloon((0.4 * d, e - r - 0.5 * d), ROLLER, "bottom"),
        Balloon((0.3 * shape.pin, e - r - 0.3 * shape.pin), PIN, "bottom"),
    )
    return View(FRONT, tuple(shapes), tuple(_front_dimensions(shape)), balloons)


def _front_dimensions(shape: _Shape) -> Iterator[Measured]:
    e, across, r, half, d = shape.offset, shape.outside, shape.arm, shape.half, shape.roller
    (x, y), swept = shape.along_2, shape.size("outer_diameter") / 2
    last = shape.rollers()[2]
    tip = (half * x + d * y, half * y - d * x)
    long = math.hypot(*tip)
    yield Dimension((-swept, e), (swept, e), "outer_diameter", "top", diameter=True)
    yield Dimension((-d, -half), (-d, half), "guide_half_length", "left", factor=2.0)
    yield Dimension((0.0, e), (0.0, e + r), "arm_radius", "left")
    yield Slant(tip, (tip[0] * across / long, tip[1] * across / long), "rim", apart=-7.0)
    yield Radius(last, d, "roller.outer_diameter", 20.0, "right", diameter=True, times=4)
    yield Radius(last, shape.pin, "roller.bore", -30.0, "right", diameter=True, times=4)
    if e > 0:
        yield Dimension((-across, 0.0), (across, 0.0), "float_radius", "top", factor=2.0, diameter=True)
        yield Dimension((0.0, 0.0), (0.0, e), "effective_offset", "left")
    if not shape.square:
        yield Angle((0.0, 0.0), (x, y), (0.0, 1.0), "guide_angle", radius=14.0)


def _behind(shape: _Shape) -> list[Drawable]:
    """Visible part of arm 2 and its boss, unless a counter float stands before them."""
    if shape.counter:
        return []
    (x, y), long, bar = shape.along_2, shape.arm_half, shape.bar
    ends = ((long, bar), (-long, bar), (-long, -bar), (long, -bar))
    arm = Area(tuple((u * x - v * y, u * y + v * x) for u, v in ends), ARM, cut=False, depth=0.0)
    if not shape.has_bosses:
        return [arm]
    return [Area(disc((0.0, 0.0), drawn_shaft(shape.size).boss_radius), BOSS, cut=False, depth=0.0), arm]


def _section(shape: _Shape) -> View:
    """Return the section through both shafts and guide I; what is seen behind it is drawn first."""
    e, d, r, half = shape.offset, shape.roller, shape.arm, shape.half
    wide, face, long, bar = shape.wide / 2, shape.roller_width / 2, shape.arm_half, shape.bar
    sine, end_1, end_2 = math.sin(shape.angle), shape.end_1, shape.end_2
    shapes = _behind_section(shape)
    for side in (1, -1):
        ends = sorted((side * half, side * shape.outside))
        shapes.append(Area(rectangle(-wide, wide, *ends), FLOAT, depth=0.0))
        at = e + side * r
        shapes.append(Area(rectangle(shape.face_1, -face, at - shape.pin, at + shape.pin), PIN, cut=False, depth=0.0))
        shapes.append(Area(rectangle(-face, face, at - d, at + d), ROLLER, cut=False, depth=0.0))
    shapes += [
        Area(rectangle(end_1, shape.face_1, e - long, e + long), ARM, depth=2 * bar),
        Area(rectangle(shape.face_2, end_2, -bar / sine, bar / sine), ARM, depth=2 * long * sine),
    ]
    if shape.counter:
        start, across = shape.beside + shape.size("pin_gap"), shape.outside
        corners = [(start, -across), (start + 2 * wide, -across), (start + 2 * wide, across), (start, across)]
        shapes += [Line(p, q, LineKind.PHANTOM) for p, q in pairwise([*corners, corners[0]])]
    bosses = _bosses(shape)
    lines = (
        Line((shape.left, e), (shape.face_1, e), LineKind.CENTRE),
        Line((shape.face_2, 0.0), (shape.right, 0.0), LineKind.CENTRE),
        *(Line((end_1, e + k), (face, e + k), LineKind.CENTRE) for k in (r, -r)),
    )
    arm = Balloon(((end_1 + shape.face_1) / 2, e - 0.8 * long), ARM, "bottom")
    dimensions = (*_section_dimensions(shape), *bosses.dimensions)
    return View(SECTION, (*shapes, *bosses.shapes, *lines), dimensions, (arm, *bosses.balloons))


def _behind_section(shape: _Shape) -> list[Drawable]:
    """What is seen behind the plane of the section: bar, pin and roller of arm 2, and the walls of the guides."""
    d, wide, face = shape.roller, shape.wide / 2, shape.roller_width / 2
    sine, cosine = math.sin(shape.angle), math.cos(shape.angle)
    low, high = shape.corner(shape.angle), shape.corner(math.pi - shape.angle)
    y = -shape.arm * cosine  # of the roller of arm 2
    shapes: list[Drawable] = []
    if not shape.square:  # the bar of arm 2 leaves the plane askew
        reach = shape.arm_half * cosine + shape.bar * sine
        shapes.append(Area(rectangle(shape.face_2, shape.end_2, -reach, shape.bar / sine), ARM, cut=False, depth=0.0))
    shapes.append(Area(rectangle(face, shape.face_2, y - shape.pin, y + shape.pin), PIN, cut=False, depth=0.0))
    mouth = max(y - d, -low), min(y + d, high)
    if mouth[1] > mouth[0]:
        shapes.append(Area(rectangle(-face, face, *mouth), ROLLER, cut=False, depth=0.0))
    walls = [(-shape.half, -low), (high, shape.half)]
    shapes += [Line((x, a), (x, b)) for x in (-wide, wide) for a, b in walls]
    return shapes + [Line((-wide, k), (wide, k)) for k in (-low, high)]


def _section_dimensions(shape: _Shape) -> Iterator[Measured]:
    e, d, r, long, across = shape.offset, shape.roller, shape.arm, shape.arm_half, shape.outside
    wide, face, top, end_1, end_2 = shape.wide / 2, shape.roller_width / 2, shape.top, shape.end_1, shape.end_2
    yield Dimension((end_1, top), (shape.face_1, top), "arm_thickness", "top")
    yield Dimension((shape.face_1, top), (-shape.beside, top), "pin_gap", "top")
    yield Dimension((-face, e + r + d), (face, e + r + d), "roller.width", "top")
    yield Dimension((-wide, across), (wide, across), "float_width", "top")
    yield Dimension((end_1, e - long), (end_1, e + long), "arm_length", "left")
    if shape.square:
        yield Dimension((end_2, -shape.bar), (end_2, shape.bar), "arm_width", "right")


def _bosses(shape: _Shape) -> DrawnComponent:
    """Bosses of both arms with the ends of their shafts, where the design has them."""
    if not shape.has_bosses:
        return DrawnComponent()
    e, left, right, end_1, end_2, top = shape.offset, shape.left, shape.right, shape.end_1, shape.end_2, shape.top
    seat = drawn_shaft(shape.size)
    shaft, boss = seat.radius, seat.boss_radius
    broken = 2 * shaft * SHAFT_OUT
    # Revolved about y = 0, one of the rings weighs as the boss of shaft 2 does; both bosses are alike.
    shapes: list[Drawable] = [
        Area(rectangle(end_2, right, shaft, boss), BOSS),
        Area(rectangle(end_2, right, -boss, -shaft), BOSS, depth=0.0),
        *(Area(rectangle(left, end_1, e + a, e + b), BOSS, depth=0.0) for a, b in ((shaft, boss), (-boss, -shaft))),
        *(Line((x, a - shaft), (x, a + shaft)) for x, a in ((left, e), (end_2, 0.0), (right, 0.0))),
    ]
    for axis, near, far in ((e, end_1, left - broken), (0.0, end_2, right + broken)):
        shapes += [Line((near, axis + k), (far, axis + k), LineKind.PHANTOM) for k in (shaft, -shaft)]
    return DrawnComponent(
        tuple(shapes),
        balloons=(Balloon(((left + end_1) / 2, e - (shaft + boss) / 2), BOSS, "bottom"),),
        dimensions=(
            Dimension((left, top), (right, top), "length", "top"),
            *seat.measured(left, (left, end_1), times=2, axis=e),
        ),
    )
