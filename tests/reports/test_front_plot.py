"""The drawing of a front: round ticks, logarithms where the range asks, a link for every design."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

import synth
from reports.front_plot import Axis, front_svg
from tests.analysis.test_calculation import Beam

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize(
    ("values", "log", "ends"),
    [
        ([0.0, 10.0], False, (0, 12)),
        ([13.9, 19.1], False, (13, 20)),
        ([2.0, 74.0], True, (1, 100)),
        ([1e-9, 1e3], True, (1e-10, 1e4)),
        ([-5.0, 3.0], False, (-6, 4)),
        ([7.0, 7.0], False, (6, 8)),
        ([0.0, 0.0], False, (0, 0.2)),
    ],
)
def test_axes_have_round_ends_with_room_for_all(values, log, ends):
    axis = Axis.of("x", "kg", values)
    assert axis.log == log
    assert (axis.low, axis.high) == pytest.approx(ends)
    assert all(0 <= axis.share(value) <= 1 for value in values)
    assert axis.ticks[0] == axis.low
    assert axis.ticks[-1] == axis.high


@pytest.fixture(scope="module")
def front():
    return synth.synthesize(Beam, {"mass_carried": "100 kg"}, objectives={"width": "min", "height": "min"}, points=12)


def test_every_design_is_a_link_to_its_row(front):
    drawn = ElementTree.fromstring(front_svg(front, [1]))
    links = [a.get("href") for a in drawn.iter(f"{SVG}a")]
    assert sorted(links) == sorted(f"#design-{d.rank}" for d in front.designs)
    titles = [t.text for t in drawn.iter(f"{SVG}title")]
    assert all("width" in t and "height" in t for t in titles)
    ElementTree.fromstring(front_svg(front, [], linked=False))


def test_one_objective_has_no_drawing():
    assert front_svg(synth.synthesize(Beam, {"mass_carried": "100 kg"}, objectives=["area"])) == ""


def test_points_lie_inside_the_frame(front):
    drawn = ElementTree.fromstring(front_svg(front))
    frame = drawn.find(f"{SVG}rect")
    x, y, w, h = (float(frame.get(k)) for k in ("x", "y", "width", "height"))
    for dot in drawn.iter(f"{SVG}circle"):
        assert x <= float(dot.get("cx")) <= x + w
        assert y <= float(dot.get("cy")) <= y + h
