"""Where part numbers, letters of details and radii stand: in a row beside a view, with lines that do not cross."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from synth.drawing import XY, Balloon, Box2, Detail, Edge, Radius

from .dimension_places import EDGES, label
from .lettering import TEXT, width
from .paper import Callout, PlacedMeasure, Ring, Stroke, Text

BALLOON = 3.5  # radius of the ring of a part number
LETTER = 5.0  # height of the letter of a detail
STEP = 9.0  # from number to number
AWAY = 6.0  # from what stands nearest
DOT = 0.6  # at the end of the line in a part


@dataclass(frozen=True)
class _Called:
    """A callout of a point: its words and, on paper, the point."""

    of: Balloon | Detail | Radius
    point: XY
    words: str
    height: float

    @property
    def reach(self) -> float:
        """Half of what it takes up across its row."""
        return BALLOON if isinstance(self.of, Balloon) else width(self.words, self.height) / 2 + 0.5


def callouts(
    marks: Sequence[Balloon | Detail | Radius], occupied: Box2, scale: float, origin: XY
) -> tuple[list[Callout], list[PlacedMeasure]]:
    """Return part numbers and letters, and radii, outside of an occupied box.

    Parameters
    ----------
    marks : list of Balloon, Detail, Radius
    occupied : box
        Of the view with its dimensions, on paper.
    scale, origin : float, point
        Of the view.
    """
    placed: list[Callout] = []
    measures: list[PlacedMeasure] = []
    for edge in EDGES:
        called = [_called(x, scale, origin) for x in marks if x.side == edge]
        for one, place in zip(called, _row(called, edge, occupied), strict=True):
            if isinstance(one.of, Radius):
                text, strokes = _lettered(one, edge, place, arrow=True)
                measures.append(PlacedMeasure(one.of, text, strokes, place))
            elif isinstance(one.of, Detail):
                text, strokes = _lettered(one, edge, place, arrow=False)
                placed.append(Callout(text, None, strokes))
            else:
                placed.append(_balloon(one, place))
    return placed, measures


def _called(of: Balloon | Detail | Radius, scale: float, origin: XY) -> _Called:
    if isinstance(of, Balloon):
        point, words, height = of.at, str(of.item), TEXT
    elif isinstance(of, Radius):
        point, words, height = of.at, label(of), TEXT
    else:
        x0, y0, x1, y1 = of.window
        ends = {
            "left": (x0, y0 + 0.8 * (y1 - y0)),
            "right": (x1, y0 + 0.8 * (y1 - y0)),
            "top": ((x0 + x1) / 2, y1),
            "bottom": ((x0 + x1) / 2, y0),
        }
        point, words, height = ends[of.side], of.letter, LETTER
    return _Called(of, (origin[0] + scale * point[0], origin[1] + scale * point[1]), words, height)


def _row(called: Sequence[_Called], edge: Edge, occupied: Box2) -> list[XY]:
    """Return the places of a row, each as near to its point as there is room, without crossing lines."""
    if not called:
        return []
    axis = 1 if edge in ("left", "right") else 0
    reach = max(one.reach for one in called)
    across = {
        "left": occupied[0] - AWAY - reach,
        "right": occupied[2] + AWAY + reach,
        "bottom": occupied[1] - AWAY - BALLOON,
        "top": occupied[3] + AWAY + BALLOON,
    }[edge]
    step = STEP if axis == 1 else max(STEP, 2 * reach + 2)
    order = sorted(range(len(called)), key=lambda k: (called[k].point[axis], called[k].point[1 - axis], k))
    places = _apart([called[k].point[axis] for k in order], step, occupied[axis], occupied[axis + 2])
    positions: list[XY] = [(0.0, 0.0)] * len(called)
    for k, along in zip(order, places, strict=True):
        positions[k] = (across, along) if axis == 1 else (along, across)
    for _ in range(len(called) ** 2):
        crossing = [
            (i, j)
            for i in range(len(called))
            for j in range(i)
            if _cross(called[i].point, positions[i], called[j].point, positions[j])
        ]
        if not crossing:
            break
        i, j = crossing[0]
        positions[i], positions[j] = positions[j], positions[i]
    return positions


def _apart(preferred: Sequence[float], step: float, low: float, high: float) -> list[float]:
    """Return ascending places at least a step apart, near those that are wanted and between two ends if they fit."""
    places: list[float] = []
    for place in preferred:
        places.append(max(place, places[-1] + step) if places else place)
    over = places[-1] - max(high, low + step * (len(places) - 1))
    if over > 0:
        places[-1] -= over
        for k in range(len(places) - 2, -1, -1):
            places[k] = min(places[k], places[k + 1] - step)
    return places


def _cross(p: XY, q: XY, r: XY, s: XY) -> bool:
    def side(a: XY, b: XY, c: XY) -> float:
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    return side(p, q, r) * side(p, q, s) < 0 and side(r, s, p) * side(r, s, q) < 0


def _balloon(one: _Called, place: XY) -> Callout:
    apart = math.dist(one.point, place)
    share = (apart - BALLOON) / apart
    end = (one.point[0] + (place[0] - one.point[0]) * share, one.point[1] + (place[1] - one.point[1]) * share)
    text = Text((place[0], place[1] - TEXT / 2), one.words, TEXT, "middle")
    return Callout(text, Ring(place, BALLOON), (Stroke((one.point, end)),), Ring(one.point, DOT, filled=True))


def _lettered(one: _Called, edge: Edge, place: XY, *, arrow: bool) -> tuple[Text, tuple[Stroke, ...]]:
    """Return a text without ring, and the line that leads from it to its point."""
    text = Text((place[0], place[1] - one.height / 2), one.words, one.height, "middle")
    half = width(one.words, one.height) / 2 + 1
    ends = {
        "left": (place[0] + half, place[1]),
        "right": (place[0] - half, place[1]),
        "top": (place[0], place[1] - one.height / 2 - 1),
        "bottom": (place[0], place[1] + one.height / 2 + 1),
    }
    return text, (Stroke((ends[edge], one.point), arrows=(False, arrow)),)
