"""One view on paper with all that belongs to it."""

from __future__ import annotations

from collections.abc import Iterable

from synth.drawing import XY, Angle, Box2, Detail, Dimension, Line, LineKind, Radius, Slant, View
from synth.drawing.shapes import box_of, points_of
from synth.text.plain_text import one_line

from .callout_places import callouts
from .dimension_places import angular, slanted, tiers
from .paper import Callout, PlacedMeasure, PlacedView, Stroke, Text, scale_label

CENTRE_OVER = 4.0  # mm that centre lines reach beyond their ends
HEADING = 5.0  # height of letters over details
NAME = 3.5  # and over views
APART = 1.2  # mm between edges behind a section
WELL_APART = 3.0  # mm: edges that stand nearer to each other are drawn with a narrow line


def placed_view(view: View, scale: float, origin: XY, *, named: bool) -> PlacedView:
    """Return a view at a place and scale, under its name where there are several."""
    shapes = (*_behind(view, scale), *view.drawn)
    bounds = tuple(_around(detail.window, scale, origin) for detail in view.details)
    tags = [*view.balloons, *view.details, *(d for d in view.dimensions if isinstance(d, Radius))]
    window = _on_paper(view.box, scale, origin)
    measures, called, region = _marked(view.dimensions, tags, window, scale, origin)
    words = one_line(f"{view.name} ({scale_label(scale)})" if view.own_scale else view.name)
    heading = Text((_middle(window), region[3] + 3), words, NAME, "middle") if named else None
    return PlacedView(
        view=view,
        detail=None,
        scale=scale,
        origin=origin,
        shapes=shapes,
        measures=tuple(measures),
        callouts=tuple(called),
        heading=heading,
        window=window,
        region=_with(region, heading),
        bounds=bounds,
    )


def _behind(view: View, scale: float) -> list[Line]:
    """Return the edges behind a section, but for those that would run together on paper."""
    lines: list[Line] = []
    edges = view.behind
    for k, (x, radius) in enumerate(edges):
        near = [abs(x - other) * scale for other, _ in (*edges[max(0, k - 1) : k], *edges[k + 1 : k + 2])]
        if not lines or k == len(edges) - 1 or scale * (x - lines[-1].a[0]) >= APART:
            kind = LineKind.THIN if min(near, default=WELL_APART) < WELL_APART else LineKind.OUTLINE
            lines.append(Line((x, -radius), (x, radius), kind))
    return lines


def placed_detail(view: View, detail: Detail, scale: float, origin: XY) -> PlacedView:
    """Return a detail of a view at a place and scale."""
    window = _on_paper(detail.window, scale, origin)
    tags = [*detail.balloons, *(d for d in detail.dimensions if isinstance(d, Radius))]
    measures, called, region = _marked(detail.dimensions, tags, window, scale, origin)
    words = f"{detail.letter} ({scale_label(scale)})"
    heading = Text((_middle(window), region[3] + 4), words, HEADING, "middle")
    return PlacedView(
        view=view,
        detail=detail,
        scale=scale,
        origin=origin,
        shapes=tuple(shape for shape in view.drawn if _meet(box_of(points_of(shape)), detail.window)),
        measures=tuple(measures),
        callouts=tuple(called),
        heading=heading,
        window=window,
        region=_with(region, heading),
    )


def _marked(
    dimensions: Iterable[Dimension | Slant | Angle | Radius], tags: list[object], window: Box2, scale: float, origin: XY
) -> tuple[list[PlacedMeasure], list[Callout], Box2]:
    linear = [d for d in dimensions if isinstance(d, Dimension)]
    measures = tiers(linear, window, scale, origin)
    measures += [slanted(d, scale, origin) for d in dimensions if isinstance(d, Slant)]
    measures += [angular(d, scale, origin) for d in dimensions if isinstance(d, Angle)]
    region = _region(window, measures, [])
    called, radii = callouts(tags, region, scale, origin)  # type: ignore[arg-type]
    measures += radii
    return measures, called, _region(window, measures, called)


def _region(window: Box2, measures: list[PlacedMeasure], called: list[Callout]) -> Box2:
    """Return the box around a view and its marks; centre lines reach over it."""
    x0, y0, x1, y1 = window
    points = [(x0 - CENTRE_OVER, y0 - CENTRE_OVER), (x1 + CENTRE_OVER, y1 + CENTRE_OVER)]
    for measure in measures:
        points += [p for stroke in measure.strokes for p in stroke.points]
        points += measure.text.corners
    for one in called:
        points += [p for stroke in one.strokes for p in stroke.points]
        points += one.text.corners
        if one.ring:
            (x, y), r = one.ring.centre, one.ring.radius
            points += [(x - r, y - r), (x + r, y + r)]
    return box_of(points)


def _with(region: Box2, heading: Text | None) -> Box2:
    if heading is None:
        return region
    return box_of([(region[0], region[1]), (region[2], region[3]), *heading.corners])


def _on_paper(box: Box2, scale: float, origin: XY) -> Box2:
    x, y = origin
    return x + scale * box[0], y + scale * box[1], x + scale * box[2], y + scale * box[3]


def _meet(a: Box2, b: Box2) -> bool:
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]


def _middle(box: Box2) -> float:
    return (box[0] + box[2]) / 2


def _around(window: Box2, scale: float, origin: XY) -> Stroke:
    x0, y0, x1, y1 = _on_paper(window, scale, origin)
    return Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), LineKind.THIN, closed=True)
