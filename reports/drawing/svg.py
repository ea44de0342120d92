"""A sheet as one SVG file: nothing is fetched, no script; texts are as wide as the layout took them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from synth.drawing import XY, Angle, Area, Circle, Drawable, Drawing, Line, LineKind, Slant
from synth.drawing.shapes import arc_of, sides, thickness
from synth.text.plain_text import one_line

from .dimension_places import TAIL
from .filling import Filling, filling
from .lettering import size_of, width
from .paper import ARROW, Bow, PaperSheet, PlacedMeasure, PlacedView, Ring, Stroke, Text, scale_label
from .view_places import CENTRE_OVER

BROAD, NARROW = 0.5, 0.25  # mm (ISO 128-2)
NARROW_PART = 3.0  # parts thinner than that on paper have lighter outlines
DASHES = {LineKind.HIDDEN: "3 1", LineKind.CENTRE: "8 1 .5 1", LineKind.PHANTOM: "8 1 .5 1 .5 1"}
FONT = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif"
GREY = "#9a9a9a"


def drawing_svg(sheet: PaperSheet, drawing: Drawing, prefix: str = "drawing") -> str:
    """Return a sheet as SVG.

    Parameters
    ----------
    sheet : PaperSheet
    drawing : Drawing
        What is on it: the parts list says how areas are filled.
    prefix : str
        Of the names inside, which must differ where several drawings stand in one page.
    """
    return "\n".join(_Svg(sheet, drawing, prefix).lines())


class _Svg:
    """Writes one sheet; y of the paper goes upwards, that of SVG down."""

    def __init__(self, sheet: PaperSheet, drawing: Drawing, prefix: str) -> None:
        self.sheet, self.prefix = sheet, prefix
        self.items = {item.number: item for item in drawing.items}
        self.out: list[str] = []

    def lines(self) -> list[str]:
        sheet_width, sheet_height = self.sheet.size
        title = f"{self.sheet.title}, scale {scale_label(self.sheet.scale)}, sheet {self.sheet.name}"
        self.out = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{sheet_width:g}mm" height="{sheet_height:g}mm" '
            f'viewBox="0 0 {sheet_width:g} {sheet_height:g}" font-family="{FONT}" role="img">',
            f"<title>{escape(one_line(title))}</title>",
            self._definitions(),
            f'<rect width="{sheet_width:g}" height="{sheet_height:g}" fill="#fff"/>',
            f'<g fill="none" stroke="#000" stroke-width="{NARROW:g}">',
        ]
        for placed in self.sheet.views:
            self._view(placed)
        for stroke in self.sheet.strokes:
            self._stroke(stroke)
        for ring in self.sheet.rings:
            self._ring(ring)
        for text in self.sheet.texts:
            self._text(text)
        return [*self.out, "</g>", "</svg>", ""]

    def _definitions(self) -> str:
        """Return the hatchings."""
        spaced = {Filling.RIGHT: (45, 1.6), Filling.LEFT: (-45, 1.6)}
        patterns = [
            f'<pattern id="{self.prefix}-{kind}" width="{gap}" height="{gap}" patternUnits="userSpaceOnUse" '
            f'patternTransform="rotate({turn})"><path d="M0 0V{gap}" stroke="#000" stroke-width=".35"/></pattern>'
            for kind, (turn, gap) in spaced.items()
        ]
        patterns.append(
            f'<pattern id="{self.prefix}-{Filling.CROSS}" width="1.1" height="1.1" patternUnits="userSpaceOnUse" '
            'patternTransform="rotate(45)"><path d="M0 0H1.1M0 0V1.1" stroke="#000" stroke-width=".25"/></pattern>'
        )
        patterns.append(
            f'<pattern id="{self.prefix}-{Filling.DOTS}" width="1.2" height="1.2" patternUnits="userSpaceOnUse" '
            'patternTransform="rotate(30)"><circle cx=".4" cy=".4" r=".18" fill="#000"/></pattern>'
        )
        return f"<defs>{''.join(patterns)}</defs>"

    def _view(self, placed: PlacedView) -> None:
        name = placed.view.name + (f", detail {placed.detail.letter}" if placed.detail else "")
        self.out.append(f'<g data-view="{escape(one_line(name))}">')
        if placed.detail:
            x0, y0, x1, y1 = placed.window
            high = self.sheet.size[1]
            place = f'x="{x0:.2f}" y="{high - y1:.2f}" width="{x1 - x0:.2f}" height="{y1 - y0:.2f}"'
            clip = f"{self.prefix}-window-{placed.detail.letter}"
            self.out.append(f'<clipPath id="{clip}"><rect {place}/></clipPath><g clip-path="url(#{clip})">')
        for shape in placed.shapes:
            self._shape(placed, shape)
        if placed.detail:
            self.out.append("</g>")
        for stroke in placed.bounds:
            self._stroke(stroke)
        for measure in placed.measures:
            self._measure(measure)
        for called in placed.callouts:
            for stroke in called.strokes:
                self._stroke(stroke)
            for ring in (called.ring, called.dot):
                if ring:
                    self._ring(ring)
            self._text(called.text)
        if placed.heading:
            self._text(placed.heading)
        self.out.append("</g>")

    def _shape(self, placed: PlacedView, shape: Drawable) -> None:
        if isinstance(shape, Area):
            self._area(placed, shape)
        elif isinstance(shape, Line):
            a, b = placed.on_paper(shape.a), placed.on_paper(shape.b)
            if shape.kind is LineKind.CENTRE:
                a, b = lengthened(a, b, CENTRE_OVER)
            self._stroke(Stroke((a, b), shape.kind))
        elif isinstance(shape, Circle):
            (x, y), r = self._at(placed.on_paper(shape.centre)), shape.radius * placed.scale
            self.out.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{r:.2f}"{_pen(shape.kind)}/>')
        else:
            centre, r = placed.on_paper(shape.centre), shape.radius * placed.scale
            self._bow(centre, r, math.radians(shape.start), math.radians(shape.end), _pen(shape.kind))

    def _area(self, placed: PlacedView, area: Area) -> None:
        item = self.items.get(area.item)
        kind = filling(area, item, placed.scale)
        thin = thickness(area) * placed.scale
        solid = {Filling.BLACK: "#000", Filling.GREY: GREY, Filling.WHITE: "#fff"}
        fill = solid.get(kind, f"url(#{self.prefix}-{kind})")
        pen = 0.05 if kind in (Filling.BLACK, Filling.GREY) else 0.3 if thin < NARROW_PART else BROAD
        colour = GREY if kind is Filling.GREY else "#000"
        path = " ".join(self._outline(placed, outline) for outline in (area.outline, *area.holes))
        back = f'<path d="{path}" fill="#fff" fill-rule="evenodd" stroke="none"/>' if kind not in solid else ""
        self.out.append(
            f'{back}<path d="{path}" fill="{fill}" fill-rule="evenodd" stroke="{colour}" stroke-width="{pen}">'
            f"<title>{escape(one_line(f'{item.number} {item.name}') if item else '')}</title></path>"
        )

    def _outline(self, placed: PlacedView, outline: Sequence[tuple[float, ...]]) -> str:
        steps: list[str] = []
        for a, b, bulge in sides(outline):  # type: ignore[arg-type]
            x, y = self._at(placed.on_paper(b))
            if not steps:
                u, v = self._at(placed.on_paper(a))
                steps.append(f"M{u:.2f} {v:.2f}")
            if bulge:
                _, radius, _, turned = arc_of(a, b, bulge)
                r = radius * placed.scale
                large, sweep = int(abs(turned) > math.pi), int(turned < 0)
                steps.append(f"A{r:.2f} {r:.2f} 0 {large} {sweep} {x:.2f} {y:.2f}")
            else:
                steps.append(f"L{x:.2f} {y:.2f}")
        return "".join(steps) + "Z"

    def _measure(self, measure: PlacedMeasure) -> None:
        name, value = escape(measure.measured.quantity), repr(measure.measured.measure)
        self.out.append(f'<g class="dimension" data-quantity="{name}" data-measure="{value}"><title>{name}</title>')
        for stroke in measure.strokes:
            self._stroke(stroke)
        for bow in measure.bows:
            self._angle_line(bow)
        self._text(measure.text, over_hatching=isinstance(measure.measured, Slant | Angle))
        self.out.append("</g>")

    def _angle_line(self, bow: Bow) -> None:
        over = TAIL / bow.radius if bow.inwards else 0.0
        self._bow(bow.centre, bow.radius, bow.start - over, bow.end + over, _pen(LineKind.THIN))
        for t, sense in ((bow.start, -1.0), (bow.end, 1.0)):
            tip = (bow.centre[0] + bow.radius * math.cos(t), bow.centre[1] + bow.radius * math.sin(t))
            sense = -sense if bow.inwards else sense
            self._arrow(tip, (-math.sin(t) * sense, math.cos(t) * sense))

    def _bow(self, centre: XY, r: float, start: float, end: float, pen: str) -> None:
        while end <= start:
            end += 2 * math.pi
        a = self._at((centre[0] + r * math.cos(start), centre[1] + r * math.sin(start)))
        b = self._at((centre[0] + r * math.cos(end), centre[1] + r * math.sin(end)))
        large = int(end - start > math.pi)
        path = f"M{a[0]:.2f} {a[1]:.2f}A{r:.2f} {r:.2f} 0 {large} 0 {b[0]:.2f} {b[1]:.2f}"
        self.out.append(f'<path d="{path}"{pen}/>')

    def _stroke(self, stroke: Stroke) -> None:
        points = " ".join(f"{x:.2f},{y:.2f}" for x, y in map(self._at, stroke.points))
        tag = "polygon" if stroke.closed else "polyline"
        self.out.append(f'<{tag} points="{points}"{_pen(stroke.kind, stroke.line_width)}/>')
        first, last = stroke.arrows
        ends = stroke.points
        if first:
            self._arrow(ends[0], _towards(ends[1], ends[0]))
        if last:
            self._arrow(ends[-1], _towards(ends[-2], ends[-1]))

    def _arrow(self, tip: XY, towards: XY) -> None:
        """Draw an arrow whose tip is a point, in a direction."""
        (ux, uy), half = towards, ARROW / 6
        back = (tip[0] - ux * ARROW, tip[1] - uy * ARROW)
        wings = (back[0] - uy * half, back[1] + ux * half), (back[0] + uy * half, back[1] - ux * half)
        points = " ".join(f"{x:.2f},{y:.2f}" for x, y in map(self._at, (tip, *wings)))
        self.out.append(f'<polygon points="{points}" fill="#000" stroke="none"/>')

    def _ring(self, ring: Ring) -> None:
        x, y = self._at(ring.centre)
        fill = ' fill="#fff"' if ring.filled else ""
        self.out.append(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{ring.radius:g}"{fill}/>')

    def _text(self, text: Text, *, over_hatching: bool = False) -> None:
        x, y = self._at(text.at)
        turn = f' transform="rotate({-text.turn:g} {x:.2f} {y:.2f})"' if text.turn else ""
        length = width(text.text, text.height)
        bold = ' font-weight="bold"' if text.bold else ""
        tooltip = f"<title>{escape(one_line(text.full_text))}</title>" if text.full_text else ""
        anchor = f' text-anchor="{text.anchor}"' if text.anchor != "start" else ""
        edge = 'stroke="#fff" stroke-width="1.2" paint-order="stroke"' if over_hatching else 'stroke="none"'
        self.out.append(
            f'<text x="{x:.2f}" y="{y:.2f}" font-size="{size_of(text.height):.2f}"{anchor}{turn}{bold} '
            f'textLength="{length:.2f}" lengthAdjust="spacingAndGlyphs" fill="#000" {edge}>'
            f"{escape(text.text)}{tooltip}</text>"
        )

    def _at(self, point: XY) -> XY:
        return point[0], self.sheet.size[1] - point[1]


def lengthened(a: XY, b: XY, over: float) -> tuple[XY, XY]:
    """Return the ends of a line that reaches over both of its ends."""
    ux, uy = _towards(a, b)
    return (a[0] - ux * over, a[1] - uy * over), (b[0] + ux * over, b[1] + uy * over)


def _towards(a: XY, b: XY) -> XY:
    long = math.dist(a, b) or 1.0
    return (b[0] - a[0]) / long, (b[1] - a[1]) / long


def _pen(kind: LineKind, line_width: float | None = None) -> str:
    """Attributes that differ from those of a narrow continuous line."""
    dash = f' stroke-dasharray="{DASHES[kind]}"' if kind in DASHES else ""
    thick = line_width or (BROAD if kind is LineKind.OUTLINE else NARROW)
    return (f' stroke-width="{thick:g}"' if thick != NARROW else "") + dash
