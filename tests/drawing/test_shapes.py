"""Shapes of drawings: volumes by Pappus' rule, arcs, what is seen behind a section."""

from __future__ import annotations

import math

import pytest

from synth.drawing import Angle, Arc, Area, Circle, Dimension, Line, View, disc, rectangle
from synth.drawing.shapes import arc_of, box_of, edges_behind, flattened, mirrored, moments, points_of, sides, thickness


def test_a_ring_weighs_what_it_should():
    ring = Area(rectangle(3.0, 7.0, 20.0, 50.0), 1)
    assert ring.volume == pytest.approx(math.pi * (50**2 - 20**2) * 4, rel=1e-12)


def test_a_torus_and_a_ball_weigh_what_they_should():
    torus = Area(disc((4.0, 30.0), 5.0), 1)
    assert torus.volume == pytest.approx(2 * math.pi**2 * 30 * 25, rel=1e-12)
    ball = Area(((6.0, 0.0, 1.0), (-6.0, 0.0)), 1)
    assert ball.volume == pytest.approx(4 / 3 * math.pi * 6**3, rel=1e-12)


def test_holes_and_depth_count():
    plate = Area(rectangle(-10.0, 10.0, -5.0, 5.0), 1, holes=(disc((0.0, 0.0), 2.0),), depth=3.0)
    assert plate.volume == pytest.approx((200 - 4 * math.pi) * 3, rel=1e-12)


def test_arcs_agree_with_their_pieces():
    outline = ((0.0, 10.0, 0.3), (8.0, 10.0, -0.2), (8.0, 16.0), (0.0, 16.0))
    fine = moments(flattened(outline, step=1e-4))
    assert moments(outline) == pytest.approx(fine, rel=1e-7)
    centre, radius, start, turned = arc_of((0.0, 10.0), (8.0, 10.0), 0.3)
    end = (centre[0] + radius * math.cos(start + turned), centre[1] + radius * math.sin(start + turned))
    assert end == pytest.approx((8.0, 10.0))


def test_the_other_half_is_a_mirror_image():
    for shape in (Area(((0.0, 10.0, 0.3), (8.0, 10.0), (8.0, 16.0)), 1), Line((0, 1), (2, 3)), Circle((1, 5), 2)):
        there = {(round(x, 9), round(-y, 9)) for x, y in points_of(mirrored(shape))}
        box = box_of(points_of(shape))
        assert box_of(list(there)) == pytest.approx(box)
    turned = mirrored(Arc((0, 5), 2, 20, 70))
    assert (turned.start, turned.end, turned.centre) == (-70, -20, (0, -5))


def test_what_reaches_to_the_axis_is_one_area_without_an_edge_there():
    web = Area(((2.0, 0.0), (4.0, 0.0), (4.0, 20.0, 0.2), (2.0, 20.0)), 1)
    ring = Area(rectangle(0.0, 6.0, 20.0, 25.0), 1)
    whole, *others = View("section", (web, ring), revolved=True).drawn
    assert [type(x) for x in others] == [Area, Area, Line]
    assert moments(whole.outline) == pytest.approx((2 * moments(web.outline)[0], 0.0), abs=1e-9)
    assert not [a for a, b, _ in sides(whole.outline) if a[1] == b[1] == 0]
    assert View("section", (web, ring), revolved=True).areas == (web, ring)


def test_thin_areas_are_known_whatever_their_slope():
    slope = math.radians(15)
    c, s = math.cos(slope), math.sin(slope)
    shell = [(40 * c, 40 * s), (0.0, 0.0), (-2 * s, 2 * c), (40 * c - 2 * s, 40 * s + 2 * c)]
    assert thickness(Area(tuple(shell), 1)) == pytest.approx(2.0)


def test_bores_end_in_edges_and_what_is_hidden_has_none():
    drum = Area(((0.0, 10.0), (5.0, 10.0), (5.0, 40.0), (50.0, 40.0), (50.0, 46.0), (0.0, 46.0)), 1)
    assert edges_behind([drum]) == [(0.0, 10.0), (5.0, 10.0), (50.0, 40.0)]
    shaft = Area(rectangle(-5.0, 60.0, 0.0, 10.0), 2, cut=False)
    assert edges_behind([drum, shaft]) == []


def test_what_is_measured_is_what_is_drawn():
    assert Dimension((1, 2), (4, 7), "a", "top").measure == 3
    assert Dimension((1, 2), (4, 7), "a", "left").measure == 5
    assert Angle((0, 0), (1, 0), (1, 1), "a").measure == pytest.approx(math.pi / 4)
    assert Angle((0, 0), (1, -1), (1, 1), "a").measure == pytest.approx(math.pi / 2)
    view = View("section", (Area(rectangle(0, 20, 15, 40), 1),), revolved=True)
    assert view.box == (0, -40, 20, 40)


def test_halves_of_coils_stand_on_one_side_and_weigh_half_a_ring():
    tube = Area(rectangle(0, 20, 15, 40), 1)
    upper = Area(rectangle(0, 2, 40, 43), 2, half=True)
    lower = Area(rectangle(2, 4, -43, -40), 2, half=True)
    view = View("section", (tube, upper, lower), revolved=True)
    assert [a for a in view.drawn if isinstance(a, Area) and a.item == 2] == [upper, lower]
    assert view.behind == ((0, 15), (20, 15))
    assert upper.volume == pytest.approx(Area(rectangle(0, 2, 40, 43), 2).volume / 2)
    assert lower.volume == pytest.approx(upper.volume)
