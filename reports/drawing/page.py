"""The sheet of a drawing: its size, the scale, and the places of views and details.

Scales are those of ISO 5455, sheets A4 to A1 lying (ISO 5457). Views stand in one row, to the left of title block and
parts list or above them, whichever lets them be larger; details are as large as their room allows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from synth.drawing import Box2, Detail, Drawing, LineKind, View
from synth.results.report_request import About

from .paper import PaperSheet, PlacedView, Stroke
from .sheet_blocks import BLOCK, BLOCK_WIDTH, NOTE, list_height, note_lines, notes, parts_list, title_block
from .view_places import placed_detail, placed_view

SHEETS = {"A4": (297.0, 210.0), "A3": (420.0, 297.0), "A2": (594.0, 420.0), "A1": (841.0, 594.0)}
FILING, MARGIN = 20.0, 10.0  # left, and around (ISO 5457)
SCALES = tuple(sorted((n * 10.0**e for e in (-2, -1, 0, 1) for n in (1, 2, 5)), reverse=True))
STANDARD = tuple(s for s in SCALES if s <= 50)
LARGE_ENOUGH = {"A4": 80.0, "A3": 70.0, "A2": 0.0, "A1": 0.0}  # mm: what the largest side of the main view should be
CLEARANCE = 6.0  # around a view
PLAIN = 2.5  # mm on paper of the thinnest part of a detail
SINGLE_MOST, SINGLE_LEAST = 90.0, 28.0  # mm: largest side of a view with a scale of its own
SEEN = 1.0  # mm on paper, less than that of it asks for a larger sheet


@dataclass(frozen=True)
class _Block:
    """A view or a detail that is to be placed: how it looks at a place."""

    make: Callable[[float, float], PlacedView]
    region: Box2  # with the origin of the part at (0, 0)
    aligned: bool  # whether it stands in one row with others by its axis

    @property
    def width(self) -> float:
        return self.region[2] - self.region[0] + 2 * CLEARANCE

    @property
    def up(self) -> float:
        return (self.region[3] if self.aligned else (self.region[3] - self.region[1]) / 2) + CLEARANCE

    @property
    def down(self) -> float:
        return (-self.region[1] if self.aligned else (self.region[3] - self.region[1]) / 2) + CLEARANCE


def paper_sheet(drawing: Drawing, title: str, program: str, about: About | None = None) -> PaperSheet:
    """Return a drawing on a sheet: the smallest that shows it large enough.

    Parameters
    ----------
    drawing : Drawing
    title : str
        Of the family.
    program : str
        What made it, with its version.
    about : About, optional
        What the title block tells.
    """
    about = about or About()
    for name in SHEETS:
        sheet = _on_sheet(drawing, title, program, about, name)
        if sheet is not None:
            return sheet
    raise ValueError("the drawing fits no sheet")


def _on_sheet(drawing: Drawing, title: str, program: str, about: About, name: str) -> PaperSheet | None:
    size = SHEETS[name]
    frame = (FILING, MARGIN, size[0] - MARGIN, size[1] - MARGIN)
    note_width = frame[2] - frame[0] - BLOCK_WIDTH
    if note_width < 60:
        return None  # the title block takes the whole width
    lines = note_lines(drawing, note_width - 4)
    low, right = NOTE * len(lines) + 4, BLOCK + list_height(drawing.items)
    if max(low, right) > frame[3] - frame[1] - 60:
        return None
    largest = max(_extent(view) for view in drawing.views if not view.own_scale)
    for scale in STANDARD:
        if scale * largest < LARGE_ENOUGH[name] and not scale == STANDARD[0]:
            return None
        views = _placed(drawing, scale, frame, low, right)
        if views is not None and (LARGE_ENOUGH[name] == 0 or _details_seen(views)):
            break
    else:
        return None
    written = [
        parts_list(drawing.items, frame[2], frame[1] + BLOCK),
        title_block(drawing, title, program, about, scale, name, frame[2], frame[1]),
        notes(lines, frame[0] + 3, frame[1]),
    ]
    x0, y0, x1, y1 = frame
    border = Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), LineKind.OUTLINE, line_width=0.7, closed=True)
    strokes = (border, *(s for w in written for s in w.strokes))
    rings, texts = tuple(r for w in written for r in w.rings), tuple(t for w in written for t in w.texts)
    boxes = (
        (frame[2] - BLOCK_WIDTH, frame[1], frame[2], frame[1] + right),
        (frame[0], frame[1], frame[2] - BLOCK_WIDTH, frame[1] + low),
    )
    return PaperSheet(
        name, size, scale, f"{title}: {drawing.title}", frame, strokes, rings, texts, tuple(views), boxes,
    )  # fmt: skip


def _placed(drawing: Drawing, scale: float, frame: Box2, low: float, right: float) -> list[PlacedView] | None:
    """Return all views and details in their places at a scale; None where there is no room."""
    named = len(drawing.views) > 1
    views = [_view_block(view, scale, named) for view in drawing.views if not view.own_scale]
    lone = [view for view in drawing.views if view.own_scale]
    details = [(view, detail) for view in drawing.views for detail in view.details]
    x0, y0, x1, y1 = frame
    two_areas = (x0, y0 + low, x1 - BLOCK_WIDTH, y1), (x1 - BLOCK_WIDTH, y0 + right, x1, y1)
    band = (x0, y0 + max(low, right), x1, y1)
    least = 2 * scale if scale < 20 else scale
    scales = [s for s in STANDARD if s >= least] if details else STANDARD[:1]
    # Beside single parts, whose scale is free, the other views stay together.
    for together, enlarged, shrunk in product((True, False) if lone else (True,), scales, tuple(_lone_scales(lone))):
        magnified = [_detail_block(view, detail, _detail_scale(detail, enlarged, scale)) for view, detail in details]
        magnified += [_view_block(view, its, named) for view, its in zip(lone, shrunk, strict=True)]
        blocks = [*views, *magnified]
        for first in range(len(views), len(views) - 1 if together else 0, -1):
            placed = _filled([(two_areas[0], blocks[:first]), (two_areas[1], blocks[first:])])
            if placed is not None:
                return placed
        placed = _filled([(band, blocks)])
        if placed is not None:
            return placed
        # Details may stand under each other at the left where the views do not need all of it, some of several single
        # parts at the right.
        for first in range(len(blocks), len(views) if lone else len(blocks) - 1, -1):
            placed = _filled([(two_areas[0], blocks[:first]), (two_areas[1], blocks[first:])])
            if placed is not None:
                return placed
    return None


def _details_seen(views: Sequence[PlacedView]) -> bool:
    return all(v.scale * v.detail.least >= SEEN for v in views if v.detail and v.detail.least is not None)


def _detail_scale(detail: Detail, enlarged: float, scale: float) -> float:
    """Return the scale of a detail: no larger than what makes its thinnest part plain."""
    if detail.least is None:
        return enlarged
    plain = [s for s in STANDARD if s * detail.least >= PLAIN and s > scale]
    return min(enlarged, min(plain, default=enlarged))


def _extent(view: View) -> float:
    x0, y0, x1, y1 = view.box
    return max(x1 - x0, y1 - y0)


def _lone_scales(views: Sequence[View]) -> Iterator[tuple[float, ...]]:
    """Yield scales of single parts, large ones first; what is largest on paper is the first to be made smaller."""
    extents = [_extent(view) for view in views]
    places = [next((k for k, s in enumerate(STANDARD) if s * x <= SINGLE_MOST), len(STANDARD) - 1) for x in extents]
    while True:
        yield tuple(STANDARD[k] for k in places)
        smaller = [
            (STANDARD[k] * x, j)
            for j, (k, x) in enumerate(zip(places, extents, strict=True))
            if k + 1 < len(STANDARD) and STANDARD[k + 1] * x >= SINGLE_LEAST
        ]
        if not smaller:
            return
        places[max(smaller)[1]] += 1


def _view_block(view: View, scale: float, named: bool) -> _Block:
    def make(x: float, y: float) -> PlacedView:
        return placed_view(view, scale, (x, y), named=named)

    return _Block(make, make(0, 0).region, aligned=not view.own_scale)


def _detail_block(view: View, detail: Detail, scale: float) -> _Block:
    def make(x: float, y: float) -> PlacedView:
        return placed_detail(view, detail, scale, (x, y))

    return _Block(make, make(0, 0).region, aligned=False)


def _filled(places: Sequence[tuple[Box2, Sequence[_Block]]]) -> list[PlacedView] | None:
    """Return blocks in their rooms; None where one does not fit."""
    placed: list[PlacedView] = []
    for area, blocks in places:
        if not blocks:
            continue
        rows = _rows(blocks, area[2] - area[0])
        if rows is None:
            return None
        high = sum(max(b.up for b in row) + max(b.down for b in row) for row in rows)
        spare = area[3] - area[1] - high
        if spare < 0:
            return None
        placed += _set(rows, area, spare)
    return placed


def _rows(blocks: Sequence[_Block], most: float) -> list[list[_Block]] | None:
    """Return blocks in rows that are no wider than the room, in their order; views stand in one row."""
    rows: list[list[_Block]] = [[]]
    for block in blocks:
        if block.width > most:
            return None
        if rows[-1] and sum(b.width for b in rows[-1]) + block.width > most:
            if block.aligned:
                return None
            rows.append([])
        rows[-1].append(block)
    return rows


def _set(rows: Sequence[Sequence[_Block]], area: Box2, spare: float) -> Iterator[PlacedView]:
    """Return rows one below the other, what is left of the room shared among them."""
    top = area[3]
    for row in rows:
        up, down = max(b.up for b in row), max(b.down for b in row)
        share = spare / (len(rows) + 1)
        line = top - share - up
        spacing = (area[2] - area[0] - sum(b.width for b in row)) / (len(row) + 1)
        x = area[0] + spacing
        for block in row:
            middle = 0.0 if block.aligned else (block.region[1] + block.region[3]) / 2
            yield block.make(x + CLEARANCE - block.region[0], line - middle)
            x += block.width + spacing
        top = line - down
