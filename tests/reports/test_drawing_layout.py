"""Drawings on paper: texts that fit whatever they are, tiers, sheets, and what a writer must not let through."""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET

import pytest
from synth.reports.drawing.lettering import fitted, width, wrapped
from synth.reports.drawing.page import paper_sheet
from synth.reports.drawing.paper import overlap
from synth.reports.drawing.svg import drawing_svg

from synth.drawing import Area, Balloon, Detail, Dimension, Drawing, Item, View, diameter, disc, rectangle
from synth.results.report_request import About
from synth.text.plain_text import one_line
from tests.reports.sheet_places import texts_of

HOSTILE = (
    "<script>alert(1)</script>",
    "=cmd()",
    '#read("/etc/passwd")',
    "$x$ & \"'",
    "\u202eevil",
    "漢字" * 40,
    "w" * 499,
)
LENGTHS = [0.05, 0.2, 0.3, 1.0, 2.0, 3.5, 5.0, 8.0, 13.0, 40.0, 41.0]


def drawing(shapes=None, dimensions=(), words="Ring", **more):
    shapes = shapes or (Area(rectangle(0, 20, 15, 40), 1),)
    view = View(words, shapes, dimensions, (Balloon((10, 30), 1),), revolved=True, **more)
    return Drawing(words, (view,), (Item(1, words, 1, words, words),), (words, words), (words,))


def assert_apart(sheet):
    texts = [text for _, text in texts_of(sheet)]
    x0, y0, x1, y1 = sheet.frame
    for text in texts:
        assert all(x0 <= x <= x1 and y0 <= y <= y1 for x, y in text.corners), text
    for a, b in itertools.combinations(texts, 2):
        assert not overlap(a.corners, b.corners), (a, b)


@pytest.mark.parametrize("words", HOSTILE, ids=range(len(HOSTILE)))
def test_no_text_leaves_its_place_or_becomes_more_than_text(words):
    about = About(company=words, project=words, number=words, title=words, author=words, revision=words, date=words)
    found = drawing(words=words)
    sheet = paper_sheet(found, words, words, about)
    assert_apart(sheet)
    root = ET.fromstring(drawing_svg(sheet, found))
    assert not [x for x in root.iter() if x.tag.endswith("script")]
    assert "".join(one_line(words).split()) in "".join("".join(root.itertext()).split())  # nothing is lost


def test_the_same_drawing_gives_the_same_bytes():
    texts = {drawing_svg(paper_sheet(drawing(), "Clutch", "program"), drawing()) for _ in range(3)}
    assert len(texts) == 1


@pytest.mark.parametrize("seed", range(12))
def test_many_small_dimensions_stand_apart(seed):
    x, chain = 0.0, []
    for k in range(len(LENGTHS)):
        long = LENGTHS[(k * (seed + 1) + seed) % len(LENGTHS)]
        chain.append(Dimension((x, 40), (x + long, 40), "a", "top" if (k + seed) % 3 else "bottom"))
        x += long
    across = [diameter(x, r, "d") for r in (1.0, 2.0, 15.0, 15.5, 39.0, 40.0)]
    shapes = (Area(rectangle(0, x, 15, 40), 1),)
    found = drawing(shapes, (*chain, Dimension((0, 40), (x, 40), "all", "top"), *across))
    assert_apart(paper_sheet(found, "Clutch", "program"))


@pytest.mark.parametrize("size", [0.5, 3.0, 40.0, 400.0, 4000.0])
def test_parts_of_any_size_find_a_sheet(size):
    shapes = (Area(rectangle(0, size, size / 3, size), 1),)
    detail = Detail("X", (0, size * 0.8, size * 0.2, size), least=size / 50)
    found = drawing(shapes, (diameter(size, size, "d"),), details=(detail,))
    sheet = paper_sheet(found, "Clutch", "program")
    assert_apart(sheet)
    assert sheet.scale * 2 * size < 420
    assert any(view.detail and view.scale >= 2 * sheet.scale for view in sheet.views)


def test_words_are_cut_where_they_are_too_long():
    assert fitted("short", 30, 2.5, 1.8) == ("short", 2.5)
    words, height = fitted("a designation of forty letters and more", 30, 2.5, 1.8)
    assert words.endswith("…")
    assert height == 1.8
    assert width(words, height) <= 30
    assert all(width(line, 2.5) <= 20 for line in wrapped("w" * 60 + " and so on", 20, 2.5))


@pytest.mark.parametrize("size", [20.0, 90.0, 400.0])
def test_views_stand_in_one_row(size):
    ring = Area(rectangle(0, size, size / 2, size), 1)
    front = View("front", (Area(disc((0, 0), size), 1, depth=1.0),), balloons=(Balloon((0, 0), 1),))
    section = View(
        "section", (ring,), (diameter(size, size, "d"),), (Balloon((size / 2, 0.7 * size), 1),), revolved=True
    )
    found = paper_sheet(Drawing("both", (section, front), (Item(1, "Ring"),), ("nothing",)), "Clutch", "program")
    assert found.views[0].origin[1] == found.views[1].origin[1]
    assert found.views[0].region[2] <= found.views[1].region[0]


def test_a_sheet_is_large_enough_for_its_details():
    wide = tuple(Area(rectangle(400 * k, 400 * k + 390, 50, 80), 1) for k in range(2))
    detail = Detail("X", (0, 70, 20, 82), least=0.4)
    view = View("section", wide, (), (Balloon((10, 60), 1),), (detail,), revolved=True)
    sheet = paper_sheet(Drawing("long", (view,), (Item(1, "Ring"),), ("nothing",) * 9), "Clutch", "program")
    assert all(v.scale * 0.4 >= 1.0 for v in sheet.views if v.detail)
