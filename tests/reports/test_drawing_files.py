"""Drawings as files: DXF that other programs read, SVG in reports, and what is told where there is none."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from synth.reports.drawing.dxf import dxf_document
from synth.reports.drawing.files import dxf_of, svg_of
from synth.reports.drawing.page import paper_sheet

import synth
from synth.analysis.drawing import drawing_of
from synth.analysis.reporting import explored, report
from synth.drawing import (
    Angle,
    Area,
    Balloon,
    Circle,
    Detail,
    Dimension,
    Drawing,
    Item,
    Line,
    LineKind,
    Radius,
    Slant,
    View,
    diameter,
    disc,
    rectangle,
)
from synth.errors import InputError
from synth.results.report_request import About, ReportOptions
from tests.reports.dxf_measures import drawn_measure, measured_in

pytestmark = pytest.mark.slow

ezdxf = pytest.importorskip("ezdxf")
pytest.importorskip("ezdxf.bbox")


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(
        "multi_plate_clutch",
        {"load_torque": "600 N*m", "driver_speed": "254 rpm", "driven_inertia": "30 kg*m2"},
        parts={"friction_pair": ["paper_wet"], "inner_plate": ["core 2.5"], "outer_plate": ["core 1.8", "core 2"]},
        fix={"ramp_time": "2 s"},
        points=2,
    )


def everything() -> Drawing:
    """Return a drawing with one of all that there is."""
    ring = Area(rectangle(0, 20, 15, 40), 1)
    section = View(
        "Section", (ring, Line((-4, 0), (-4, 30), LineKind.PHANTOM)),
        (Dimension((0, 40), (20, 40), "length", "top"), diameter(20, 40, "outer"),
         Slant((0, 15), (20, 40), "slope", apart=40.0), Angle((20, 0), (30, 0), (30, 10), "chi", radius=30.0)),
        (Balloon((10, -30), 1, "bottom"),),
        (Detail("X", (0, 35, 5, 41), (Dimension((0, 40), (0.04, 40), "thin", "top"),), least=0.5),),
        revolved=True,
    )  # fmt: skip
    front = View(
        "Front view",
        (Area(disc((0, 0), 30), 2, holes=(disc((0, 0), 10),), depth=4.0), Circle((0, 0), 20, LineKind.CENTRE)),
        (Radius((0, 0), 20, "r"), Radius((0, 0), 10, "d", angle=200, diameter=True, times=2)),
        (Balloon((0, -25), 2, "bottom"),),
    )
    return Drawing("all", (section, front), (Item(1, "Ring"), Item(2, "Disc")), ("nothing",))


def test_dxf_is_sound_and_measures_what_is_drawn():
    drawing = everything()
    document = dxf_document(paper_sheet(drawing, "Clutch", "program"), drawing)
    audit = document.audit()
    assert (audit.errors, audit.fixes) == ([], [])
    assert measured_in(document) == pytest.approx(sorted(drawn_measure(d) for d in drawing.measured), rel=1e-9)


def test_dxf_has_layers_line_types_and_a_layout():
    drawing = everything()
    sheet = paper_sheet(drawing, "Clutch", "program")
    document = ezdxf.read(io.StringIO(dxf_of(drawing, "Clutch", "program")))
    assert document.units == 4
    weights = {layer.dxf.name: layer.dxf.lineweight for layer in document.layers}
    assert (weights["OUTLINE"], weights["CENTRE"], weights["DIMENSION"]) == (50, 25, 25)
    assert document.layers.get("CENTRE").dxf.linetype == "CENTER"
    (port,) = [v for v in document.layout("Sheet").query("VIEWPORT") if v.dxf.id != 1]
    assert port.dxf.height / port.dxf.view_height == pytest.approx(sheet.scale)
    assert (port.dxf.width, port.dxf.height) == sheet.size


def test_a_view_is_in_true_size_in_the_model_and_all_lies_within_the_frame():
    drawing = everything()
    sheet = paper_sheet(drawing, "Clutch", "program")
    assert sheet.scale != 1
    model = dxf_document(sheet, drawing).modelspace()
    assert sorted(c.dxf.radius for c in model.query('CIRCLE[layer=="CENTRE"]')) == [20.0]
    rings = [p for p in model.query('LWPOLYLINE[layer=="OUTLINE"]') if p.closed and len(p) == 4]
    sides = sorted(max(x for x, *_ in p) - min(x for x, *_ in p) for p in rings)
    assert any(side == pytest.approx(20.0) for side in sides)
    low, high = sheet.frame[:2], sheet.frame[2:]
    extents = ezdxf.bbox.extents(e for e in model if e.dxftype() != "DIMENSION")
    assert all(p >= x / sheet.scale - 1e-6 for p, x in zip(extents.extmin, low, strict=False))
    assert all(p <= x / sheet.scale + 1e-6 for p, x in zip(extents.extmax, high, strict=False))


def test_of_a_detail_only_its_window_is_drawn():
    drawing = everything()
    sheet = paper_sheet(drawing, "Clutch", "program")
    (placed,) = [view for view in sheet.views if view.detail]
    x0, y0, x1, y1 = (end / sheet.scale for end in placed.window)
    model = dxf_document(sheet, drawing).modelspace()
    pieces = [p for p in model.query("LWPOLYLINE") if not p.closed and p.dxf.layer in ("OUTLINE", "THIN")]
    corners = [[(x, y) for x, y, *_ in p] for p in pieces]
    inside = [
        own for own in corners if all(x0 - 1e-6 <= x <= x1 + 1e-6 and y0 - 1e-6 <= y <= y1 + 1e-6 for x, y in own)
    ]
    # Of the ring: its end at the left, its outside, and nothing where the window cuts it.
    edges = [(a, b) for own in inside for a, b in pairwise(own)]
    assert len(edges) == 2
    assert sum(abs(a[0] - b[0]) > 1 for a, b in edges) == 1


def test_the_same_design_gives_the_same_files(front, tmp_path):
    for word in ("a", "b"):
        report(front, tmp_path / word, ReportOptions.read(["svg", "dxf"]))
    for name in ("design_01_drawing.svg", "design_01_drawing.dxf"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_dimensions_say_their_quantity_in_svg(front):
    design = front.designs[0]
    drawing = drawing_of(synth.load("multi_plate_clutch"), design)
    text = svg_of(drawing, design.frame.title, "program", About(project="Hoist 7", author="Á. Őri <b>"))
    told = dict(re.findall(r'data-quantity="([^"]+)" data-measure="([^"]+)"', text))
    assert float(told["length"]) == pytest.approx(design.values["length"] * 1e3, rel=1e-12)
    assert float(told["drum_wall"]) == pytest.approx(6.0)
    assert "Hoist 7" in text
    assert "Á. Őri &lt;b&gt;" in text


def test_sheets_and_the_explorer_show_the_drawing(front, tmp_path):
    report(front, tmp_path, ReportOptions.read(["html", "svg", "explorer"]))
    sheet = (tmp_path / "design_01_sheet.html").read_text()
    assert "Not part of the model, not drawn:" in sheet
    assert "design_01_drawing.svg" in (tmp_path / "explorer.html").read_text()
    assert explored(front)["designs"][0]["drawing"].startswith("<svg")


def test_the_report_draws_what_it_tells_in_full_and_names_inside_differ(front, tmp_path):
    report(front, tmp_path, design=2, full=2)
    told = (tmp_path / "report.html").read_text()
    assert told.count("Dimensioned drawing of the design") == 2
    names = re.findall(r' id="([^"]+)"', told)
    assert {"drawing-1-right", "drawing-2-right"} <= set(names)
    assert len(names) == len(set(names))
    # A sheet is asked for of designs that are not told in full.
    report(front, tmp_path / "none", design=2, full=0)
    assert "Dimensioned drawing" not in (tmp_path / "none" / "report.html").read_text()
    assert "Dimensioned drawing" in (tmp_path / "none" / "design_02_sheet.html").read_text()


def test_a_detail_holds_only_what_its_window_shows():
    drawing = everything()
    far = Area(rectangle(10, 12, 15, 20), 1)
    section = replace(drawing.views[0], shapes=(*drawing.views[0].shapes, far))
    sheet = paper_sheet(replace(drawing, views=(section, *drawing.views[1:])), "Clutch", "program")
    (placed,) = [view for view in sheet.views if view.detail]
    assert far in section.drawn
    assert far not in placed.shapes
    assert section.shapes[0] in placed.shapes


HOSTILE = (
    "<script>alert(1)</script>",
    '=cmd() #read("/etc/passwd") $HOME',
    "%%c {\\fArial;x} \\P \\U+0041 ^J",
    "0\nEOF\n\x00\x1b[2J\u2028\ud800",
    "\u202eabc\u202c\u0627\u0644 \u9f8d",
    "\"'`&;" + "x" * 10_000,
)


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_texts_do_nothing_in_drawings(text):
    drawing = everything()
    items = tuple(replace(item, name=text, material=text, note=text) for item in drawing.items)
    views = tuple(replace(view, name=text[:60]) for view in drawing.views)
    hostile = replace(drawing, title=text[:60], items=items, omitted=(text[:300],), remarks=(text[:300],), views=views)
    about = About(project=text[:200], company=text[:200])
    picture = svg_of(hostile, text[:60], "program", about)
    tree = ElementTree.fromstring(picture)
    assert not [e.tag for e in tree.iter() if e.tag.endswith(("script", "foreignObject", "image"))]
    written = dxf_of(hostile, text[:60], "program", about)
    audit = ezdxf.read(io.StringIO(written.encode().decode())).audit()
    assert (audit.errors, audit.fixes) == ([], [])


def test_a_front_of_another_version_has_a_report_without_a_drawing(front, tmp_path):
    design = front.designs[0]
    old = replace(design, steps=type(design.steps)({k: v for k, v in design.steps.items() if k != "release_gap"}))
    written = report(replace(front, designs=(old,)), tmp_path, ReportOptions.read(["html", "svg"]))
    assert written.files == ["report.html", "design_01_sheet.html"]
    assert [
        note for note in written.notes if note.startswith("no drawing of design #1: design: release_gap: is missing")
    ]


def test_the_extra_is_named_where_it_is_missing(front, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "ezdxf", None)
    with pytest.raises(InputError, match=r"^--dxf needs the extra dxf: pip install 'clutchsynth\[dxf\]'$"):
        report(front, tmp_path, ReportOptions.read(["dxf"]))
    assert list(tmp_path.iterdir()) == []
