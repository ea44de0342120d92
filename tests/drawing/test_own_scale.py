"""Views of single parts have a scale of their own."""

from __future__ import annotations

import itertools

from synth.reports.drawing.page import SINGLE_LEAST, SINGLE_MOST, paper_sheet

from synth.drawing import Area, Balloon, Drawing, Item, View, rectangle


def test_a_small_part_is_drawn_larger_than_the_sheet_says_and_tells_its_scale():
    body = Area(rectangle(0, 60, 50, 100), item=1)
    main = View("Section", (body,), balloons=(Balloon((30, -75), 1),), revolved=True)
    parts = tuple(
        View(name, (Area(rectangle(0, long, 0, 4), item=1, cut=False),), own_scale=True)
        for name, long in (("Pin", 12.0), ("Rod", 260.0))
    )
    sheet = paper_sheet(Drawing("both", (main, *parts), (Item(1, "Ring"),), omitted=("shaft",)), "Title", "program")
    section, pin, rod = sheet.views
    assert section.scale == sheet.scale
    assert pin.heading.text == "Pin (5:1)"
    assert (pin.scale, rod.scale) == (5, 0.2)
    for placed, long in ((pin, 12), (rod, 260)):
        assert SINGLE_LEAST <= placed.scale * long <= SINGLE_MOST
    for one, other in itertools.combinations(sheet.views, 2):
        assert one.region[2] <= other.region[0] or one.region[3] <= other.region[1] or other.region[3] <= one.region[1]
