"""Subtrees grown by compiled code: the same boxes as step by step, and nothing of use is lost."""

from dataclasses import replace

import numpy as np
import pytest

from synth.bounds.boxes import Boxes
from synth.bounds.settings import KernelSizes
from synth.kernels.loading import best_variant
from synth.search.archive import Archive
from synth.search.pruning import EpsilonCover, NonImprovement
from synth.search.settings import TUNING
from tests.sample_problems.strut import designs_of, lost, strut_form

TIE = TUNING.tolerances.tie

pytestmark = pytest.mark.skipif(best_variant("boxes") is None, reason="no kernel was built")


SLACK = np.array([0.02, 0.05])
KINDS = ("front", "front with a cap", "one objective", "staircase")


@pytest.fixture(autouse=True)
def compiled(monkeypatch):
    """Let kernels compute."""
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)


def known_designs(form, rng, count):
    """Return an archive of random designs."""
    points, combinations, phi = designs_of(form, rng, count)
    archive = Archive([0, 1], form.n, len(form.goals))
    archive.add(combinations, points, phi)
    return archive


def purpose_of(kind, form, rng):
    nowhere = np.full(len(form.goals), np.inf)
    if kind == "one objective":
        plain = nowhere.copy()
        plain[0] = np.median(known_designs(form, rng, 300).phi[:, 0])
        archive = Archive([1], form.n, len(form.goals))
        points, combinations, phi = designs_of(form, rng, 300)
        keep = phi[:, 0] <= plain[0]
        archive.add(combinations[keep], points[keep], phi[keep])
        return EpsilonCover([1], SLACK[1:], plain, archive)
    archive = known_designs(form, rng, 300)
    if kind == "staircase":
        return NonImprovement([archive[k] for k in range(0, len(archive), 3)], [0, 1], SLACK, archive)
    if kind == "front with a cap":
        nowhere[0] = np.median(archive.phi[:, 0])
    return EpsilonCover([0, 1], SLACK, nowhere, archive)


def after(form, rule, generations):
    """Return boxes after some generations from the root, step by step."""
    return by_single_steps(form, rule, form.boxes.lean(form.boxes.root()), generations)[0]


def in_order(boxes):
    """Return boxes as rows of numbers in an order of their own."""
    rows = np.concatenate([boxes.cell, boxes.low, boxes.high, boxes.bounds], axis=1)
    return rows[np.lexsort(np.round(rows, 9).T)]


def by_single_steps(form, rule, boxes, levels):
    """Return halves, and boxes too small to be split, after some generations, step by step."""
    small = [boxes.take(slice(0, 0))]
    for _ in range(levels):
        boxes = form.boxes.contract(boxes, rule.cutoffs(form.objectives.phi_of(boxes.bounds), boxes.cell))
        boxes = boxes.take(rule.possible_gain(form.objectives.phi_of(boxes.bounds), boxes.cell) > 0)
        boxes, rest = form.boxes.split(boxes)
        small.append(rest)
    return boxes, Boxes.joined(small)


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_one_generation_is_a_single_step(kind, grid):
    form = strut_form(grid)
    rule = purpose_of(kind, form, np.random.default_rng(7))
    boxes = after(form, rule, 9)
    assert len(boxes) > 20
    grown = form.boxes.grow(boxes, rule.tables(form), 1).subtrees()
    halves, small = by_single_steps(form, rule, boxes, 1)
    np.testing.assert_allclose(in_order(grown.halves), in_order(halves), rtol=1e-9)
    np.testing.assert_allclose(in_order(grown.small), in_order(small), rtol=1e-9)
    assert grown.looked == len(boxes)


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_generations_are_about_those_of_single_steps(kind, grid):
    form = strut_form(grid)
    rule = purpose_of(kind, form, np.random.default_rng(7))
    boxes = after(form, rule, 9)
    grown = form.boxes.grow(boxes, rule.tables(form), 4).subtrees()
    halves, small = by_single_steps(form, rule, boxes, 4)
    # Caps differ in their last digit, and with them what is split of two that blur a box as much.
    assert len(grown.halves) == pytest.approx(len(halves), rel=0.02)
    assert len(grown.small) == pytest.approx(len(small), rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("room", [KernelSizes().extra_capacity, 40])
@pytest.mark.parametrize("kind", KINDS)
def test_no_design_of_use_is_lost_even_where_there_is_no_room_for_more_boxes(kind, room):
    sizes = KernelSizes(extra_capacity=room, capacity_per_box=4 if room > 40 else 1)
    form, rng = strut_form(tuning=replace(TUNING, kernels=sizes)), np.random.default_rng(3)
    rule = purpose_of(kind, form, rng)
    boxes = after(form, rule, 4)
    grown = form.boxes.grow(boxes, rule.tables(form), 6).subtrees()
    points, combinations, phi = designs_of(form, rng, 60_000)
    # Of use: better than what is known, by the slack and a little.
    useful = rule.possible_gain(phi) > 10 * TIE
    points, combinations = points[useful], combinations[useful]
    assert len(points) > 20
    assert not lost(form, boxes, points, combinations).any()
    assert not lost(form, Boxes.joined([grown.halves, grown.small]), points, combinations).any()
    assert len(grown.halves) + len(grown.small) <= len(boxes) * sizes.capacity_per_box + room


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("workers", [1, 3])
def test_boxes_are_split_as_over_arrays(grid, workers, monkeypatch):
    form = strut_form(grid, replace(TUNING, kernels=KernelSizes(part=16)), workers)
    rule = purpose_of("front", form, np.random.default_rng(7))
    boxes = Boxes.joined([after(form, rule, generations) for generations in (1, 6, 12)])
    # Boxes that nothing more can be told of by scores, and boxes that hold one design.
    boxes.scores[::5] = 0.0
    points = boxes.take(np.arange(0, len(boxes), 7))
    leaves = [tree.leaf_of_row[0] for tree in form.boxes.cells.trees]
    points.cell[:], points.high[:] = leaves, points.low
    boxes = Boxes.joined([boxes, points])
    boxes.tag[:] = np.arange(len(boxes))
    split = form.boxes.split(boxes)
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    over_arrays = strut_form(grid).boxes.split(boxes)
    assert len(split[1]) == len(points) > 4
    for found, expected in zip(split, over_arrays, strict=True):
        for name in ("cell", "low", "high", "bounds", "scores", "tag"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)


def test_threads_change_nothing():
    found = []
    for workers in (1, 3):
        form = strut_form(tuning=replace(TUNING, kernels=KernelSizes(tree_part=16)), workers=workers)
        rule = purpose_of("front", form, np.random.default_rng(5))
        boxes = after(form, rule, 9)
        assert len(boxes) > 64
        found.append(form.boxes.grow(boxes, rule.tables(form), 3).subtrees())
    one, three = found
    assert one.looked == three.looked > len(boxes)
    for name in ("cell", "low", "high", "bounds", "tag"):
        np.testing.assert_array_equal(getattr(one.halves, name), getattr(three.halves, name))


def test_boxes_carry_the_question_they_belong_to():
    form = strut_form()
    rule = purpose_of("front", form, np.random.default_rng(5))
    boxes = after(form, rule, 6)
    boxes.tag[:] = np.arange(len(boxes))
    grown = form.boxes.grow(boxes, rule.tables(form), 2).subtrees()
    own = boxes.take(grown.halves.tag)
    assert len(set(grown.halves.tag.tolist())) > 1
    assert np.all(grown.halves.low >= own.low - 1e-9)
    assert np.all(grown.halves.high <= own.high + 1e-9)


def test_three_objectives_and_ties_have_no_tables():
    form = strut_form()
    archive = Archive([0, 1, 2], form.n, 3)
    nowhere = np.full(3, np.inf)
    assert EpsilonCover([0, 1, 2], np.full(3, 0.1), nowhere, archive).tables(form) is None
    assert EpsilonCover([2], np.full(1, 0.1), nowhere, archive).tables(form) is None


def test_without_a_kernel_nothing_is_grown(monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    form = strut_form()
    rule = purpose_of("front", form, np.random.default_rng(5))
    assert form.boxes.grow(after(form, rule, 3), rule.tables(form), 2) is None
