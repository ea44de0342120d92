"""A sheet as DXF: the part in true size in the model, with real dimensions; frame and lists on a layout with viewports.

Each view has layers of its own for dimensions and hatching, which are frozen in the viewports of others, so that a
detail is another look at the same part.
"""

from __future__ import annotations

import io
import math
from collections.abc import Iterable
from typing import Any

from reports.drawing.filling import Filling, filling
from reports.drawing.paper import ARROW, PaperSheet, PlacedMeasure, PlacedView, Ring, Stroke, Text
from reports.drawing.svg import NARROW_PART, lengthened
from reports.drawing.view_places import CENTRE_OVER
from reports.extras import needed
from synth.drawing import XY, Angle, Area, Box2, Circle, Dimension, Drawable, Drawing, Line, LineKind, Radius, Slant
from synth.drawing.shapes import Vertex, box_of, corner, points_of, thickness

STYLE = "CLUTCHSYNTH"
FONT = "arial.ttf"
CAP = "HATCH"
# Line types as lengths of dashes (positive) and gaps [mm on paper].
DASHES = {
    LineKind.HIDDEN: (3.0, -1.0),
    LineKind.CENTRE: (8.0, -1.0, 0.5, -1.0),
    LineKind.PHANTOM: (8.0, -1.0, 0.5, -1.0, 0.5, -1.0),
}
# Layer: line type, width in hundredths of a millimetre, colour.
LAYERS = {
    "OUTLINE": ("Continuous", 50, 7),
    "THIN": ("Continuous", 25, 7),
    "HIDDEN": ("HIDDEN", 25, 3),
    "CENTRE": ("CENTRE", 25, 1),
    "PHANTOM": ("PHANTOM", 25, 6),
    "HATCH": ("Continuous", 25, 8),
    "DIMENSION": ("Continuous", 25, 4),
    "TEXT": ("Continuous", 25, 7),
    "FRAME": ("Continuous", 70, 7),
    "VIEWPORT": ("Continuous", 13, 9),
}
GEOMETRY = ("OUTLINE", "THIN", "HIDDEN", "CENTRE", "PHANTOM")
PATTERNS = {Filling.RIGHT: ("ANSI31", 0.0), Filling.LEFT: ("ANSI31", 90.0), Filling.CROSS: ("ANSI37", 0.0)}
PATTERN_SCALE = {Filling.RIGHT: 0.5, Filling.LEFT: 0.5, Filling.CROSS: 0.35}  # of ANSI31: lines 3.175 mm apart
SPARE = 5.0  # mm around what a viewport shows: letters of another program may be wider
APART = 200.0  # mm on paper between views in the model


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
    ezdxf = needed("ezdxf", "--dxf", "dxf")
    ezdxf.options.write_fixed_meta_data_for_testing = True  # ours is the only use: no time, no chance in the file
    return _Dxf(ezdxf, sheet, drawing).document()


class _Dxf:
    """Writes one sheet."""

    def __init__(self, ezdxf: Any, sheet: PaperSheet, drawing: Drawing) -> None:
        self.sheet = sheet
        self.items = {item.number: item for item in drawing.items}
        self.doc = ezdxf.new("R2010", units=4)
        self.doc.header["$LTSCALE"] = 1.0
        self.doc.header["$PSLTSCALE"] = 1
        self.doc.header["$MEASUREMENT"] = 1
        self.doc.styles.add(STYLE, font=FONT)
        for kind, dashes in DASHES.items():
            pattern = [sum(map(abs, dashes)), *dashes]
            self.doc.linetypes.add(kind.name, pattern, description=kind.value)
        for name, (linetype, weight, colour) in LAYERS.items():
            self.doc.layers.add(name, linetype=linetype, lineweight=weight, color=colour)
        self.doc.layers.get("VIEWPORT").off()
        self.model = self.doc.modelspace()
        self.paper = self.doc.paperspace()
        self.own_layers: dict[int, tuple[str, str]] = {}  # by view: of dimensions and of hatching

    def document(self) -> Any:
        size = self.sheet.size
        self.paper.page_setup(size=size, margins=(0, 0, 0, 0), units="mm")
        self.doc.layouts.rename(self.paper.name, "Sheet")
        offsets = self._offsets()
        for k, placed in enumerate(self.sheet.views):
            self.own_layers[k] = self._layers_of(k, placed)
            if placed.detail is None:
                for shape in placed.shapes:
                    self._shape(shape, placed, offsets[k])
            self._hatch(k, placed, offsets[k])
            for measure in placed.measures:
                self._measure(k, measure, placed, offsets[k])
        for k, placed in enumerate(self.sheet.views):
            self._viewports(k, placed, offsets[k])
            self._marks(placed)
        for stroke in self.sheet.strokes:
            self._stroke(stroke)
        for ring in self.sheet.rings:
            self._ring(ring)
        for text in self.sheet.texts:
            self._text(text)
        return self.doc

    def _offsets(self) -> list[XY]:
        """Return where the point (0, 0) of each view is in the model; details are where their view is."""
        of_view: dict[int, XY] = {}
        right = 0.0
        for placed in self.sheet.views:
            if placed.detail is not None:
                continue
            x0, _, x1, _ = _in_part(placed.region, placed)
            of_view[id(placed.view)] = (right - x0, 0.0)
            right += x1 - x0 + APART / placed.scale
        return [of_view[id(placed.view)] for placed in self.sheet.views]

    def _layers_of(self, k: int, placed: PlacedView) -> tuple[str, str]:
        """Return the layers that are a view's own."""
        if k == 0:
            return "DIMENSION", CAP
        name = placed.detail.letter if placed.detail else str(k + 1)
        found = []
        for base in ("DIMENSION", CAP):
            linetype, weight, colour = LAYERS[base]
            layer = f"{base}_{name}"
            if layer not in self.doc.layers:
                self.doc.layers.add(layer, linetype=linetype, lineweight=weight, color=colour)
            found.append(layer)
        return found[0], found[1]

    def _shape(self, shape: Drawable, placed: PlacedView, offset: XY) -> None:
        def at(point: XY) -> XY:
            return point[0] + offset[0], point[1] + offset[1]

        if isinstance(shape, Area):
            narrow = thickness(shape) * placed.scale < NARROW_PART
            attributes = {"layer": "THIN" if narrow else "OUTLINE"}
            for outline in (shape.outline, *shape.holes):
                self.model.add_lwpolyline(_moved(outline, offset), format="xyb", close=True, dxfattribs=attributes)
            return
        layer = {"layer": shape.kind.name}
        if isinstance(shape, Line):
            over = CENTRE_OVER / placed.scale if shape.kind is LineKind.CENTRE else 0.0
            a, b = lengthened(shape.a, shape.b, over)
            self.model.add_line(at(a), at(b), dxfattribs=layer)
        elif isinstance(shape, Circle):
            self.model.add_circle(at(shape.centre), shape.radius, dxfattribs=layer)
        else:
            self.model.add_arc(at(shape.centre), shape.radius, shape.start, shape.end, dxfattribs=layer)

    def _hatch(self, k: int, placed: PlacedView, offset: XY) -> None:
        """Hatch what is cut, at the scale of a view: of a detail what lies in its window."""
        window = None if placed.detail is None else placed.detail.window
        for area in (shape for shape in placed.shapes if isinstance(shape, Area)):
            kind = filling(area, self.items.get(area.item), placed.scale)
            if kind is Filling.WHITE or (window is not None and not _meet(box_of(points_of(area)), window)):
                continue
            hatch = self.model.add_hatch(color=256, dxfattribs={"layer": self.own_layers[k][1]})
            if kind in PATTERNS:
                name, turn = PATTERNS[kind]
                hatch.set_pattern_fill(name, scale=PATTERN_SCALE[kind] / placed.scale, angle=turn)
            elif kind is Filling.DOTS:
                hatch.set_pattern_fill("DOTS", scale=0.5 / placed.scale)
            else:
                hatch.set_solid_fill(color=256 if kind is Filling.BLACK else 8)
            hatch.paths.add_polyline_path(_moved(area.outline, offset), is_closed=True)
            for hole in area.holes:
                hatch.paths.add_polyline_path(_moved(hole, offset), is_closed=True, flags=16)

    def _style(self, scale: float) -> str:
        """Return the dimension style of a scale: sizes are those on paper."""
        name = f"{STYLE}_{1 / scale:g}".replace(".", "_")
        if name not in self.doc.dimstyles:
            style = self.doc.dimstyles.new(name).dxf
            style.dimscale = 1 / scale
            style.dimtxt, style.dimasz, style.dimexe, style.dimexo, style.dimgap = 3.5, ARROW, 1.5, 1.0, 1.0
            style.dimtad, style.dimtih, style.dimtoh, style.dimtmove = 1, 0, 0, 2
            style.dimdec, style.dimzin, style.dimdsep, style.dimtxsty = 2, 8, ord("."), STYLE
            style.dimadec, style.dimazin, style.dimaunit = 2, 2, 0
            style.dimtix, style.dimtofl, style.dimlunit = 1, 1, 2
        return name

    def _measure(self, k: int, placed_measure: PlacedMeasure, placed: PlacedView, offset: XY) -> None:
        measured = placed_measure.measured
        attributes = {"layer": self.own_layers[k][0]}

        def part(point: XY) -> XY:
            return tuple(  # type: ignore[return-value]
                (p - o) / placed.scale + shift for p, o, shift in zip(point, placed.origin, offset, strict=True)
            )

        def at(point: XY) -> XY:
            return point[0] + offset[0], point[1] + offset[1]

        style = self._style(placed.scale)
        override = _written(measured)
        text = part(_middle(placed_measure.text))
        if isinstance(measured, Dimension):
            axis, turn = (0, 0) if measured.along == "x" else (1, 90)
            aside = abs(_middle(placed_measure.text)[axis] - placed_measure.base[axis]) > 0.01
            made = self.model.add_linear_dim(
                part(placed_measure.base), at(measured.a), at(measured.b), location=text if aside else None, angle=turn,
                dimstyle=style, override=override, dxfattribs=attributes,
            )  # fmt: skip
        elif isinstance(measured, Slant):
            made = self.model.add_aligned_dim(
                at(measured.a), at(measured.b), distance=measured.apart / placed.scale, dimstyle=style,
                override=override, dxfattribs=attributes,
            )  # fmt: skip
        elif isinstance(measured, Angle):
            start, end = measured.ends
            radius = measured.radius / placed.scale
            made = self.model.add_angular_dim_cra(
                at(measured.vertex), radius, math.degrees(start), math.degrees(end), distance=0.0, dimstyle=style,
                override=override, dxfattribs=attributes,
            )  # fmt: skip
        else:
            add = self.model.add_diameter_dim if measured.diameter else self.model.add_radius_dim
            made = add(
                center=at(measured.centre), radius=measured.radius, angle=measured.angle, location=text,
                dimstyle=style, override={**override, "dimtmove": 1, "dimtoh": 1, "dimtih": 1}, dxfattribs=attributes,
            )  # fmt: skip
        made.render()

    def _viewports(self, k: int, placed: PlacedView, offset: XY) -> None:
        others = [name for j, own in self.own_layers.items() if j != k for name in own]
        x0, y0, x1, y1 = placed.region
        around = (x0 - SPARE, y0 - SPARE, x1 + SPARE, y1 + SPARE)
        if placed.detail is None:
            self._viewport(around, placed, offset, others)
            return
        dimensions, hatching = self.own_layers[k]
        self._viewport(placed.window, placed, offset, [*others, dimensions])
        self._viewport(around, placed, offset, [*others, hatching, *GEOMETRY])

    def _viewport(self, box: Box2, placed: PlacedView, offset: XY, frozen: Iterable[str]) -> None:
        centre = ((box[0] + box[2]) / 2, (box[1] + box[3]) / 2)
        seen = tuple((c - o) / placed.scale + s for c, o, s in zip(centre, placed.origin, offset, strict=True))
        high = box[3] - box[1]
        viewport = self.paper.add_viewport(
            center=centre, size=(box[2] - box[0], high), view_center_point=seen, view_height=high / placed.scale,
            dxfattribs={"layer": "VIEWPORT"},
        )  # fmt: skip
        viewport.frozen_layers = [name for name in dict.fromkeys(frozen) if name in self.doc.layers]

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
        named = layer or ("FRAME" if stroke.wide == 0.7 else stroke.kind.name)
        self.paper.add_lwpolyline(stroke.points, close=stroke.closed, dxfattribs={"layer": named})
        for tip, back, wanted in (
            (stroke.points[0], stroke.points[1], stroke.arrows[0]),
            (stroke.points[-1], stroke.points[-2], stroke.arrows[1]),
        ):
            if wanted:
                long = math.dist(tip, back)
                ux, uy = (tip[0] - back[0]) / long * ARROW, (tip[1] - back[1]) / long * ARROW
                base = (tip[0] - ux, tip[1] - uy)
                wings = (base[0] - uy / 6, base[1] + ux / 6), (base[0] + uy / 6, base[1] - ux / 6)
                self.paper.add_solid([tip, *wings, wings[1]], dxfattribs={"layer": named})

    def _ring(self, ring: Ring) -> None:
        self.paper.add_circle(ring.centre, ring.radius, dxfattribs={"layer": "THIN"})

    def _text(self, text: Text) -> None:
        words = text.text.replace("%%", "%%%%%%")  # %% begins a code of the format, %%% is a percent sign
        made = self.paper.add_text(
            words, height=text.height, rotation=text.turn, dxfattribs={"layer": "TEXT", "style": STYLE}
        )
        alignment = {"start": 0, "middle": 1, "end": 2}[text.anchor]
        made.dxf.halign, made.dxf.insert = alignment, text.at
        if alignment:
            made.dxf.align_point = text.at


def _written(measured: Dimension | Slant | Angle | Radius) -> dict[str, Any]:
    """Return how a dimension writes what it measures."""
    if isinstance(measured, Angle):
        return {}
    times = f"{measured.times} × " if measured.times > 1 else ""
    sign = "Ø" if measured.diameter else "R" if isinstance(measured, Radius) else ""
    found: dict[str, Any] = {"dimpost": f"{times}{sign}<>"} if times or sign else {}
    return {**found, "dimdec": 4} if measured.measure < 0.1 else found


def _middle(text: Text) -> XY:
    """Return the middle of a text."""
    x0, y0, x1, y1 = box_of(text.corners)
    return (x0 + x1) / 2, (y0 + y1) / 2


def _moved(outline: Iterable[Vertex], offset: XY) -> list[tuple[float, float, float]]:
    return [(x + offset[0], y + offset[1], bulge) for x, y, bulge in map(corner, outline)]


def _in_part(box: Box2, placed: PlacedView) -> Box2:
    """Return a box on paper in millimetres of the part."""
    (x, y), s = placed.origin, placed.scale
    return (box[0] - x) / s, (box[1] - y) / s, (box[2] - x) / s, (box[3] - y) / s


def _meet(a: Box2, b: Box2) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
