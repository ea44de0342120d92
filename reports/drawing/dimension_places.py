"""Where dimensions stand on paper: in tiers beside a view, small ones next to it, no text over another or a line."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from synth.drawing import XY, Angle, Box2, Dimension, Edge, Radius, Slant

from .lettering import TEXT, width
from .paper import ARROW, Bow, PlacedMeasure, Stroke, Text, shown

FIRST = 10.0  # mm from the view to the first tier (ISO 129: at least 10)
PITCH = 7.0  # from tier to tier
GAP = 1.0  # between the part and an extension line
BEYOND = 1.5  # extension lines over the dimension line
OVER = 1.0  # text over its line
TAIL = 5.0  # of arrows that point at each other from outside
CLEAR = 0.8  # between a text and a line
EDGES: tuple[Edge, ...] = ("top", "bottom", "left", "right")


@dataclass(frozen=True)
class _Place:
    """A way to write a dimension along its line: what it takes up of it, and where the text is."""

    low: float
    high: float
    text_low: float
    text_high: float
    outside: bool
    text_beyond: bool

    def clear_of(self, other: _Place) -> bool:
        gap = 0.0 if not (self.outside or self.text_beyond or other.outside or other.text_beyond) else 1.0
        return self.high + gap <= other.low + 1e-6 or other.high + gap <= self.low + 1e-6


@dataclass(frozen=True)
class _Used:
    tier: int
    place: _Place
    ends: tuple[float, float]


def label(dimension: Dimension | Slant | Radius | Angle) -> str:
    """Return the text of a dimension, from what it measures."""
    if isinstance(dimension, Angle):
        return shown(math.degrees(dimension.measure)) + "°"
    sign = "Ø" if dimension.diameter else "R" if isinstance(dimension, Radius) else ""
    times = f"{dimension.times} × " if dimension.times > 1 else ""
    return f"{times}{sign}{shown(dimension.measure)}"


def tiers(dimensions: Sequence[Dimension], window: Box2, scale: float, origin: XY) -> list[PlacedMeasure]:
    """Return dimensions beside a view, each side in its tiers."""
    measures = []
    for edge in EDGES:
        of_edge = sorted((d for d in dimensions if d.side == edge), key=lambda d: d.measure)
        all_ends = [_ends(d, scale, origin) for d in of_edge]
        used: list[_Used] = []
        for k, (dimension, ends) in enumerate(zip(of_edge, all_ends, strict=True)):
            others = [
                x for j, pair in enumerate(all_ends) if j != k for x in pair if min(abs(x - e) for e in ends) > 1e-6
            ]
            at = _free(used, ends, width(label(dimension), TEXT), others)
            used.append(at)
            measures.append(_drawn(dimension, at, window, scale, origin))
    return measures


def _ends(dimension: Dimension, scale: float, origin: XY) -> tuple[float, float]:
    axis = 0 if dimension.along == "x" else 1
    a, b = (origin[axis] + scale * p[axis] for p in (dimension.a, dimension.b))
    return min(a, b), max(a, b)


def _free(used: Sequence[_Used], ends: tuple[float, float], length: float, others: Sequence[float]) -> _Used:
    """Return the lowest tier where a dimension has room, and how it is written there."""
    ways = list(_ways(ends, length, others))
    for tier in range(len(used) + 1):
        for place in ways:
            if all(_fit(_Used(tier, place, ends), other) for other in used):
                return _Used(tier, place, ends)
    raise AssertionError("a tier above all others is free")


def _fit(new: _Used, old: _Used) -> bool:
    if new.tier == old.tier:
        return new.place.clear_of(old.place)
    low, high = (new, old) if new.tier < old.tier else (old, new)
    # Extension lines to the higher tier pass the lower one: not through its text, nor along arrows from outside.
    nearly = CLEAR - 1e-3
    return all(not low.place.text_low - nearly < end < low.place.text_high + nearly for end in high.ends)


def _ways(ends: tuple[float, float], length: float, others: Sequence[float]) -> Iterable[_Place]:
    """Return the ways to write a text between two ends or beside them, best first.

    No end of another dimension lies in a text, so that no extension line goes through it whatever their tiers are.
    """
    low, high = ends
    span = high - low
    outside = span < 2 * ARROW + 2
    tail = TAIL if outside else 0.0
    middle, half = (low + high) / 2, length / 2
    if length + 2 * CLEAR <= span:
        reach = (span - length) / 2 - CLEAR
        steps = [0.0, *(sign * reach * k / 8 for k in range(1, 9) for sign in (1, -1))]
        for at in (middle + step for step in steps):
            if not _hit(at - half, at + half, others):
                yield _Place(low - tail, high + tail, at - half, at + half, outside, False)
    first = high + 1.5
    while hit := _hit(first, first + length, others):
        first = max(hit) + CLEAR + 0.01
    last = low - 1.5
    while hit := _hit(last - length, last, others):
        last = min(hit) - CLEAR - 0.01
    beyond = [
        _Place(low - tail, max(high + tail, first + length + 0.5), first, first + length, outside, True),
        _Place(min(low - tail, last - length - 0.5), high + tail, last - length, last, outside, True),
    ]
    yield from sorted(beyond, key=lambda place: place.high - place.low)


def _hit(low: float, high: float, ends: Sequence[float]) -> list[float]:
    """Return the ends that lie in a text."""
    return [end for end in ends if low - CLEAR < end < high + CLEAR]


def _drawn(dimension: Dimension, at: _Used, window: Box2, scale: float, origin: XY) -> PlacedMeasure:
    edge = dimension.side
    axis = 0 if dimension.along == "x" else 1
    border = {"left": window[0], "bottom": window[1], "right": window[2], "top": window[3]}[edge]
    sign = 1.0 if edge in ("right", "top") else -1.0
    line = border + sign * (FIRST + PITCH * at.tier)

    def point(along: float, across: float) -> XY:
        return (along, across) if axis == 0 else (across, along)

    place = at.place
    first, last = at.ends
    strokes = []
    for p in (dimension.a, dimension.b):
        along, across = origin[axis] + scale * p[axis], origin[1 - axis] + scale * p[1 - axis]
        strokes.append(Stroke((point(along, across + sign * GAP), point(along, line + sign * BEYOND))))
    if place.outside:
        strokes.append(Stroke((point(place.low, line), point(first, line)), arrows=(False, True)))
        strokes.append(Stroke((point(place.high, line), point(last, line)), arrows=(False, True)))
        strokes.append(Stroke((point(first, line), point(last, line))))
    else:
        strokes.append(Stroke((point(first, line), point(last, line)), arrows=(True, True)))
        if place.text_beyond:
            beyond = place.high if place.high > last else place.low
            strokes.append(Stroke((point(last if place.high > last else first, line), point(beyond, line))))
    middle = (place.text_low + place.text_high) / 2
    above = OVER if axis == 0 else -OVER
    text = Text(point(middle, line + above), label(dimension), TEXT, "middle", 0.0 if axis == 0 else 90.0)
    return PlacedMeasure(dimension, text, tuple(strokes), point((first + last) / 2, line), place.outside)


def slanted(dimension: Slant, scale: float, origin: XY) -> PlacedMeasure:
    """Return a dimension along the line through its points."""
    p, q = (_moved(point, scale, origin) for point in (dimension.a, dimension.b))
    long = math.dist(p, q)
    ux, uy = (q[0] - p[0]) / long, (q[1] - p[1]) / long
    nx, ny = -uy, ux
    sign = math.copysign(1.0, dimension.apart)

    def offset(point: XY, apart: float) -> XY:
        return point[0] + nx * apart, point[1] + ny * apart

    first, last = offset(p, dimension.apart), offset(q, dimension.apart)
    lines = [Stroke((offset(x, sign * GAP), offset(x, dimension.apart + sign * BEYOND))) for x in (p, q)]
    turn = math.degrees(math.atan2(uy, ux))
    turn = turn - 180 if turn > 90 else turn + 180 if turn <= -90 else turn
    words, outside = label(dimension), long < 2 * ARROW + 2
    if outside:
        tails = [(first[0] - ux * TAIL, first[1] - uy * TAIL), (last[0] + ux * TAIL, last[1] + uy * TAIL)]
        lines += [Stroke((tails[0], first), arrows=(False, True)), Stroke((tails[1], last), arrows=(False, True))]
    lines.append(Stroke((first, last), arrows=(not outside, not outside)))
    up = (-math.sin(math.radians(turn)), math.cos(math.radians(turn)))
    middle = ((first[0] + last[0]) / 2, (first[1] + last[1]) / 2)
    if width(words, TEXT) + 1 > long:
        away = long / 2 + TAIL + width(words, TEXT) / 2
        middle = (middle[0] + ux * away, middle[1] + uy * away)
        lines.append(Stroke((last, (last[0] + ux * (away + 1), last[1] + uy * (away + 1)))))
    at = (middle[0] + up[0] * OVER, middle[1] + up[1] * OVER)
    return PlacedMeasure(dimension, Text(at, words, TEXT, "middle", turn), tuple(lines), first, outside)


def angular(dimension: Angle, scale: float, origin: XY) -> PlacedMeasure:
    """Return an angle: an arc about its point on paper, with its text beyond."""
    vertex = _moved(dimension.vertex, scale, origin)
    start, end = dimension.ends
    radius = dimension.radius
    lines = []
    for point, t in ((dimension.a, start), (dimension.b, end)):
        from_here = scale * math.dist(point, dimension.vertex)
        to = radius + BEYOND
        if to > from_here + GAP:
            lines.append(Stroke((_polar(vertex, from_here + GAP, t), _polar(vertex, to, t))))
    inwards = radius * (end - start) < 2 * ARROW + 2
    bows = [Bow(vertex, radius, start, end, inwards)]
    middle = (start + end) / 2
    words = label(dimension)
    length = width(words, TEXT)
    away = radius + 1.5 + abs(math.cos(middle)) * length / 2 + abs(math.sin(middle)) * TEXT / 2
    # Where arrows come from outside the text stands at the end of the first of them.
    centre = _polar(vertex, radius, start - (TAIL + TEXT) / radius) if inwards else _polar(vertex, away, middle)
    text = Text((centre[0], centre[1] - TEXT / 2), words, TEXT, "middle")
    return PlacedMeasure(dimension, text, tuple(lines), _polar(vertex, radius, middle), inwards, tuple(bows))


def _polar(centre: XY, radius: float, t: float) -> XY:
    return centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)


def _moved(point: XY, scale: float, origin: XY) -> XY:
    return origin[0] + scale * point[0], origin[1] + scale * point[1]
