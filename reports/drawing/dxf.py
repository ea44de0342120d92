"""A sheet as DXF: all in the model, around the part in true size, with real dimensions; a layout shows it on paper.

Everything that stands in lengths of the paper is as much larger in the model as the part is smaller on paper. So it
looks the same in programs that know no layouts. Details, and single parts at a scale of their own, are enlarged copies
whose dimensions are told to divide what they measure.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable, Sequence
from typing import Any

from synth.drawing import (
    XY,
    Angle,
    Arc,
    Area,
    Circle,
    Dimension,
    Drawable,
    Drawing,
    Line,
    LineKind,
    Measured,
    Radius,
    Slant,
)
from synth.drawing.shapes import Vertex, box_of, corner, flattened, points_of, thickness
from synth.results.drawings import EXTRAS

from ..extras import needed
from .filling import Filling, filling
from .paper import ARROW, PaperSheet, PlacedMeasure, PlacedView, Ring, Stroke, Text
from .svg import NARROW_PART, lengthened
from .view_places import CENTRE_OVER

STYLE = "CLUTCHSYNTH"
FONT = "arial.ttf"
# Line types, by names that other programs know, as lengths of dashes (positive) and gaps [mm on paper].
DASHES = {"HIDDEN": (3.0, -1.0), "CENTER": (8.0, -1.0, 0.5, -1.0), "PHANTOM": (8.0, -1.0, 0.5, -1.0, 0.5, -1.0)}
# Layer: line type, width in hundredths of a millimetre, colour.
LAYERS = {
    "OUTLINE": ("Continuous", 50, 7),
    "THIN": ("Continuous", 25, 7),
    "HIDDEN": ("HIDDEN", 25, 3),
    "CENTRE": ("CENTER", 25, 1),
    "PHANTOM": ("PHANTOM", 25, 6),
    "HATCH": ("Continuous", 25, 8),
    "DIMENSION": ("Continuous", 25, 4),
    "TEXT": ("Continuous", 25, 7),
    "FRAME": ("Continuous", 70, 7),
    "VIEWPORT": ("Continuous", 13, 9),
}
PATTERNS = {Filling.RIGHT: ("ANSI31", 0.0), Filling.LEFT: ("ANSI31", 90.0), Filling.CROSS: ("ANSI37", 0.0)}
PATTERN_SCALE = {Filling.RIGHT: 0.5, Filling.LEFT: 0.5, Filling.CROSS: 0.35}  # of ANSI31: lines 3.175 mm apart
FITTED = 4  # texts of so many letters are as wide as the layout takes them, whatever the font; fewer look distorted
FINE = math.radians(0.5)  # of arcs that the window of a detail cuts


def drawing_dxf(sheet: PaperSheet, drawing: Drawing) -> str:
    """Return a sheet as DXF (R2010); the same sheet gives the same text.

    Parameters
    ----------
    sheet : PaperSheet
    drawing : Drawing
        What is on it: the parts list says how areas are filled.

    Raises
    ------
    InputError
        The extra is not installed.
    """
    stream = io.StringIO()
    dxf_document(sheet, drawing).write(stream)
    return stream.getvalue()


def dxf_document(sheet: PaperSheet, drawing: Drawing) -> Any:
    """Return a sheet as a document of ezdxf, without the time at which it was made.

    Parameters and errors as for :func:`drawing_dxf`.
    """
    ezdxf = needed(*EXTRAS["dxf"])
    ezdxf.options.write_fixed_meta_data_for_testing = True  # ours is the only use: no time, no chance in the file
    return _Dxf(ezdxf, sheet, drawing).document()


class _Dxf:
    """Writes one sheet."""

    def __init__(self, ezdxf: Any, sheet: PaperSheet, drawing: Drawing) -> None:
        self.sheet, self.larger = sheet, 1 / sheet.scale
        self.clipping, self.align = needed("ezdxf.math.clipping", "--dxf", "dxf"), ezdxf.enums.TextEntityAlignment
        self.items = {item.number: item for item in drawing.items}
        self.doc = ezdxf.new("R2010", units=4)
        self.doc.header["$LTSCALE"] = self.larger
        self.doc.header["$PSLTSCALE"] = 0  # on the layout line types are as small as all else
        self.doc.header["$MEASUREMENT"] = 1
        self.doc.styles.add(STYLE, font=FONT)
        for name, dashes in DASHES.items():
            self.doc.linetypes.add(name, [sum(map(abs, dashes)), *dashes], description=name.lower())
        for name, (linetype, weight, colour) in LAYERS.items():
            self.doc.layers.add(name, linetype=linetype, lineweight=weight, color=colour)
        self.doc.layers.get("VIEWPORT").off()
        self.model = self.doc.modelspace()
        # Some programs go by the header alone.
        self.doc.dimstyles.get(self._style(1.0)).copy_to_header(self.doc)

    def document(self) -> Any:
        for placed in self.sheet.views:
            for shape in placed.shapes:
                self._shape(shape, placed)
            for measure in placed.measures:
                self._measure(measure, placed)
            self._marks(placed)
        for stroke in self.sheet.strokes:
            self._stroke(stroke)
        for ring in self.sheet.rings:
            self._ring(ring)
        for text in self.sheet.texts:
            self._text(text)
        self._layout()
        return self.doc

    def _layout(self) -> None:
        """Show all of the model on paper."""
        (width, height), paper = self.sheet.size, self.doc.paperspace()
        paper.page_setup(size=self.sheet.size, margins=(0, 0, 0, 0), units="mm")
        self.doc.layouts.rename(paper.name, "Sheet")
        centre = (width / 2, height / 2)
        paper.add_viewport(
            center=centre, size=self.sheet.size, view_center_point=self._at(centre), view_height=height * self.larger,
            dxfattribs={"layer": "VIEWPORT"},
        )  # fmt: skip

    def _at(self, point: XY) -> XY:
        """Point of the paper in the coordinates of the model."""
        return point[0] * self.larger, point[1] * self.larger

    # -- the part ----------------------------------------------------------------------------------

    def _shape(self, shape: Drawable, placed: PlacedView) -> None:
        window = self._window(shape, placed)
        if isinstance(shape, Area):
            self._area(shape, placed, window)
            return
        layer = {"layer": shape.kind.name}
        if isinstance(shape, Line):
            over = CENTRE_OVER / placed.scale if shape.kind is LineKind.CENTRE else 0.0
            a, b = (self._at(placed.on_paper(end)) for end in lengthened(shape.a, shape.b, over))
            for start, end in [(a, b)] if window is None else window.lines([a, b]):
                self.model.add_line(start, end, dxfattribs=layer)
            return
        if window is not None:
            for piece in window.lines([self._at(placed.on_paper(p)) for p in _along(shape)]):
                self.model.add_lwpolyline(piece, dxfattribs=layer)
            return
        centre, radius = self._at(placed.on_paper(shape.centre)), shape.radius * placed.scale * self.larger
        if isinstance(shape, Circle):
            self.model.add_circle(centre, radius, dxfattribs=layer)
        else:
            self.model.add_arc(centre, radius, shape.start, shape.end, dxfattribs=layer)

    def _window(self, shape: Drawable, placed: PlacedView) -> _Window | None:
        """Clipping region of a shape in a detail; None where all of it is seen."""
        if placed.detail is None:
            return None
        x0, y0, x1, y1 = placed.window
        u0, v0, u1, v1 = box_of([placed.on_paper(p) for p in points_of(shape)])
        over = CENTRE_OVER if isinstance(shape, Line) and shape.kind is LineKind.CENTRE else 0.0
        if x0 <= u0 - over and y0 <= v0 - over and u1 + over <= x1 and v1 + over <= y1:
            return None
        return _Window(self.clipping, self._at((x0, y0)), self._at((x1, y1)))

    def _area(self, area: Area, placed: PlacedView, window: _Window | None) -> None:
        layer = {"layer": "THIN" if thickness(area) * placed.scale < NARROW_PART else "OUTLINE"}
        outlines: list[Sequence[Sequence[float]]] = []
        for outline in (area.outline, *area.holes):
            if window is None:
                outlines.append(self._moved(outline, placed))
                self.model.add_lwpolyline(outlines[-1], format="xyb", close=True, dxfattribs=layer)
                continue
            corners = [self._at(placed.on_paper(p)) for p in flattened(outline, FINE)]
            for piece in window.lines([*corners, corners[0]]):
                self.model.add_lwpolyline(piece, dxfattribs=layer)
            outlines += window.surfaces(corners)
        self._hatch(area, placed, outlines)

    def _hatch(self, area: Area, placed: PlacedView, outlines: Sequence[Sequence[Sequence[float]]]) -> None:
        """Fill what is cut; the first outline is that of the area, others are of holes."""
        kind = filling(area, self.items.get(area.item), placed.scale)
        if kind is Filling.WHITE or not outlines:
            return
        hatch = self.model.add_hatch(color=256, dxfattribs={"layer": "HATCH"})
        if kind in PATTERNS:
            name, turn = PATTERNS[kind]
            hatch.set_pattern_fill(name, scale=PATTERN_SCALE[kind] * self.larger, angle=turn)
        elif kind is Filling.DOTS:
            hatch.set_pattern_fill("DOTS", scale=0.5 * self.larger)
        else:
            hatch.set_solid_fill(color=256 if kind is Filling.BLACK else 8)
        for k, outline in enumerate(outlines):
            hatch.paths.add_polyline_path(outline, is_closed=True, flags=16 if k else 1)

    def _moved(self, outline: Iterable[Vertex], placed: PlacedView) -> list[tuple[float, float, float]]:
        return [(*self._at(placed.on_paper((x, y))), bulge) for x, y, bulge in map(corner, outline)]

    # -- dimensions --------------------------------------------------------------------------------

    def _style(self, enlarged: float) -> str:
        """Return the dimension style of what is enlarged in the model: sizes are those on paper."""
        name = STYLE if enlarged == 1 else f"{STYLE}_{enlarged:g}".replace(".", "_")
        if name not in self.doc.dimstyles:
            style = self.doc.dimstyles.new(name).dxf
            style.dimscale, style.dimlfac = self.larger, 1 / enlarged
            style.dimtxt, style.dimasz, style.dimexe, style.dimexo, style.dimgap = 3.5, ARROW, 1.5, 1.0, 1.0
            style.dimtad, style.dimtih, style.dimtoh, style.dimtmove = 1, 0, 0, 2
            style.dimdec, style.dimzin, style.dimdsep, style.dimtxsty = 2, 8, ord("."), STYLE
            style.dimadec, style.dimazin, style.dimaunit = 2, 2, 0
            style.dimtix, style.dimtofl, style.dimlunit = 1, 1, 2
        return name

    def _measure(self, placed_measure: PlacedMeasure, placed: PlacedView) -> None:
        measured = placed_measure.measured
        attributes, enlarged = {"layer": "DIMENSION"}, placed.scale / self.sheet.scale
        style, override = self._style(enlarged), _digits(measured)
        words = _words(placed_measure, enlarged)
        middle, base = _middle(placed_measure.text), placed_measure.base
        text = self._at(middle)

        def at(point: XY) -> XY:
            return self._at(placed.on_paper(point))

        if isinstance(measured, Dimension):
            axis, turn = (0, 0) if measured.along == "x" else (1, 90)
            moved = abs(middle[axis] - base[axis]) > 0.01
            made = self.model.add_linear_dim(
                self._at(base), at(measured.a), at(measured.b), location=text if moved else None, angle=turn,
                text=words, dimstyle=style, override=override, dxfattribs=attributes,
            )  # fmt: skip
        elif isinstance(measured, Slant):
            made = self.model.add_aligned_dim(
                at(measured.a), at(measured.b), distance=measured.apart * self.larger, text=words,
                dimstyle=style, override=override, dxfattribs=attributes,
            )  # fmt: skip
        elif isinstance(measured, Angle):
            # By both legs: not every program knows angles by three points.
            vertex, radius = at(measured.vertex), measured.radius * self.larger
            start, end = measured.ends
            legs = [[_around(vertex, share * radius, t) for share in (0.5, 1.0)] for t in (start, end)]
            made = self.model.add_angular_dim_2l(
                _around(vertex, radius, (start + end) / 2), *reversed(legs), text=words, dimstyle=style,
                override=override, dxfattribs=attributes,
            )  # fmt: skip
        else:
            add = self.model.add_diameter_dim if measured.diameter else self.model.add_radius_dim
            made = add(
                center=at(measured.centre), radius=measured.radius * enlarged, angle=measured.angle, location=text,
                text=words, dimstyle=style, override={**override, "dimtmove": 1, "dimtoh": 1, "dimtih": 1},
                dxfattribs=attributes,
            )  # fmt: skip
        made.render()

    # -- what stands in lengths of the paper -------------------------------------------------------

    def _marks(self, placed: PlacedView) -> None:
        for stroke in placed.bounds:
            self._stroke(stroke, "THIN")
        for called in placed.callouts:
            for stroke in called.strokes:
                self._stroke(stroke, "THIN")
            for ring in (called.ring, called.dot):
                if ring:
                    self._ring(ring)
            self._text(called.text)
        if placed.heading:
            self._text(placed.heading)

    def _stroke(self, stroke: Stroke, layer: str = "") -> None:
        named = layer or ("FRAME" if stroke.line_width == 0.7 else stroke.kind.name)
        points = [self._at(p) for p in stroke.points]
        self.model.add_lwpolyline(points, close=stroke.closed, dxfattribs={"layer": named})
        arrow = ARROW * self.larger
        for tip, back, has_arrow in (
            (points[0], points[1], stroke.arrows[0]),
            (points[-1], points[-2], stroke.arrows[1]),
        ):
            if has_arrow:
                long = math.dist(tip, back)
                ux, uy = (tip[0] - back[0]) / long * arrow, (tip[1] - back[1]) / long * arrow
                base = (tip[0] - ux, tip[1] - uy)
                wings = (base[0] - uy / 6, base[1] + ux / 6), (base[0] + uy / 6, base[1] - ux / 6)
                self.model.add_solid([tip, *wings, wings[1]], dxfattribs={"layer": named})

    def _ring(self, ring: Ring) -> None:
        self.model.add_circle(self._at(ring.centre), ring.radius * self.larger, dxfattribs={"layer": "THIN"})

    def _text(self, text: Text) -> None:
        words = text.text.replace("%%", "%%%%%%")  # %% begins a code of the format, %%% is a percent sign
        made = self.model.add_text(
            words, height=text.height * self.larger, rotation=text.turn, dxfattribs={"layer": "TEXT", "style": STYLE}
        )
        if len(words) >= FITTED:
            made.set_placement(*map(self._at, text.base_line), self.align.FIT)
            return
        alignment = {"start": self.align.LEFT, "middle": self.align.CENTER, "end": self.align.RIGHT}[text.anchor]
        made.set_placement(self._at(text.at), align=alignment)


class _Window:
    """What is seen of a detail."""

    def __init__(self, clipping: Any, low: XY, high: XY) -> None:
        self._vector, self._cut = clipping.Vec2, clipping.ClippingRect2d(clipping.Vec2(low), clipping.Vec2(high))

    def lines(self, points: Sequence[XY]) -> list[list[XY]]:
        """Return the pieces of a line that are seen."""
        return self._pieces(self._cut.clip_polyline(self._vector.list(points)))

    def surfaces(self, corners: Sequence[XY]) -> list[list[XY]]:
        """Return the pieces of a surface that are seen."""
        return self._pieces(self._cut.clip_polygon(self._vector.list(corners)))

    @staticmethod
    def _pieces(paths: Iterable[Sequence[Any]]) -> list[list[XY]]:
        return [[(p.x, p.y) for p in piece] for piece in paths if len(piece) > 1]


def _along(shape: Circle | Arc) -> list[XY]:
    """Return points along a round line, near to each other."""
    start, end = (0.0, 360.0) if isinstance(shape, Circle) else (shape.start, shape.end)
    turned = math.radians((end - start) % 360 or 360)
    pieces = math.ceil(turned / FINE)
    angles = [math.radians(start) + turned * k / pieces for k in range(pieces + 1)]
    return [_around(shape.centre, shape.radius, t) for t in angles]


def _words(placed: PlacedMeasure, enlarged: float) -> str:
    """Return the text of a dimension: <> where programs write there what they measure.

    Of what is enlarged, and of radii, all is written out: not every program knows factors, and signs of radii.
    """
    measured = placed.measured
    if isinstance(measured, Angle):
        return "<>"  # as large in any scale
    if enlarged != 1 or isinstance(measured, Radius):
        return placed.text.text
    times = f"{measured.times} × " if measured.times > 1 else ""
    return f"{times}{'Ø' if measured.diameter else ''}<>"


def _digits(measured: Measured) -> dict[str, int]:
    """Decimals of a dimension where they are not those of its style."""
    return {"dimdec": 4} if not isinstance(measured, Angle) and measured.measure < 0.1 else {}


def _around(centre: XY, radius: float, angle: float) -> XY:
    """Return the point at so many radians on a circle."""
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def _middle(text: Text) -> XY:
    """Return the middle of a text."""
    x0, y0, x1, y1 = box_of(text.corners)
    return (x0 + x1) / 2, (y0 + y1) / 2
