"""The drawing of a front: round ticks, logarithms where the range asks, a link for every design."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import pytest
from synth.reports.front_plot import Axis, front_file, front_svg

import synth
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
        ([7.0, 7.0 * (1 + 1e-15)], False, (6, 8)),
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


def test_a_file_says_by_itself_what_it_shows(front):
    text = front_file(front.designs, front.frame.objectives, "Beam <of> \x1b steel", "proven & done")
    drawn = ElementTree.fromstring(text)
    wide, high = (float(x) for x in drawn.get("viewBox").split()[2:])
    assert (drawn.get("width"), drawn.get("height")) == (f"{wide:g}", f"{high:g}")
    said = ["".join(t.itertext()) for t in drawn.iter(f"{SVG}text")]
    assert said[0] == r"Beam <of> \x1b steel: width and height"
    assert f"{len(front.designs)} designs" in said[1]
    assert said[-1] == "proven & done"
    assert {"width [mm]", "height [mm]"} <= set(said)
    assert {f"#{d.rank}" for d in front.designs} <= set(said)
    assert not list(drawn.iter(f"{SVG}a"))
    paper = next(drawn.iter(f"{SVG}rect"))
    assert paper.get("fill") == "#ffffff"
    for part in drawn.iter():
        x, y = (float(part.get(a, part.get(f"c{a}", 0))) for a in "xy")
        assert 0 <= x <= wide
        assert 0 <= y <= high


def test_a_file_of_several_families_tells_them_apart(front):
    families = ["disc_clutch" if k % 2 else "cone & <b>" for k in range(len(front.designs))]
    drawn = ElementTree.fromstring(front_file(front.designs, front.frame.objectives, "Common front", "", families))
    said = ["".join(t.itertext()) for t in drawn.iter(f"{SVG}text")]
    assert {"disc clutch", "cone & <b>"} <= set(said)
    squares = [p for p in drawn.iter(f"{SVG}polygon")]
    rounds = [p for p in drawn.iter(f"{SVG}circle") if p.get("class") == "dot"]
    assert len(squares) == families.count("disc_clutch") + 1  # one in the legend
    assert len(rounds) == families.count("cone & <b>") + 1
    assert squares[0].get("fill") != rounds[0].get("fill")


def test_a_file_of_what_is_no_front_is_not_made(front):
    assert front_file(front.designs[:1], front.frame.objectives, "Beam") == ""
    assert front_file(front.designs, {"width": "min"}, "Beam") == ""


def test_long_numbers_keep_clear_of_the_name_of_their_axis(front):
    objectives = {"width": "min", "height": "max"}
    grown = [replace(d, objectives={"width": 1.0, "height": 123.4567 * d.rank}) for d in front.designs]
    drawn = ElementTree.fromstring(front_file(grown, objectives, "Beam"))
    numbers = [t for t in drawn.iter(f"{SVG}text") if t.get("text-anchor") == "end"]
    assert max(len(t.text) for t in numbers) >= 6
    name = next(t for t in drawn.iter(f"{SVG}text") if t.get("transform"))
    across = float(name.get("transform").split("(")[1].split()[0])
    assert all(float(t.get("x")) - 8 * len(t.text) > across + 4 for t in numbers)


def test_ranks_do_not_cover_each_other(front):
    drawn = ElementTree.fromstring(front_svg(front))
    ranks = [t for t in drawn.iter(f"{SVG}text") if (t.text or "").startswith("#")]
    boxes = [(float(t.get("x")), float(t.get("y")), 8 * len(t.text)) for t in ranks]
    for k, (x, y, w) in enumerate(boxes):
        assert not any(x < x2 + w2 and x2 < x + w and abs(y - y2) < 12 for x2, y2, w2 in boxes[:k])
