"""What a search for a front knows: how far its trees go, and what is kept when it begins again."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from synth.search.front_state import FrontProof, FrontState, FrontTask
from synth.search.settings import TUNING, Tuning
from synth.search.starting_front import StartingFront
from tests.asking import pose
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import tuned


def task(tuning: Tuning = TUNING, **more: Any) -> FrontTask:
    asked = pose(Strut(), NEEDED, catalogs={"rods": RODS}, tuning=tuning, **more)
    return asked.search().state.task


@pytest.mark.parametrize(
    ("limits", "objectives", "expected"),
    [
        ({}, None, "boxes"),
        ({"few_combinations": 10**6}, ["mass"], "boxes_of_many"),
        ({"few_combinations": 10**6}, None, "boxes"),
        ({"few_combinations": 0, "many_variables": 0}, None, "boxes_of_many"),
        ({"few_combinations": 10**6, "many_variables": 0}, None, "boxes_of_few_parts"),
    ],
)
def test_trees_go_as_far_as_unknowns_and_combinations_promise(
    limits: dict[str, int], objectives: list[str] | None, expected: str
) -> None:
    own = task(tuned(tree=limits), objectives=objectives)
    assert own.boxes_per_tree() == getattr(TUNING.tree, expected)
    assert own.thorough


def test_a_question_with_a_node_limit_of_its_own_is_no_thorough_search() -> None:
    own = replace(task(), node_limit=50)
    assert own.boxes_per_tree() == 50
    assert not own.thorough


def test_what_is_known_stays_when_a_search_begins_again() -> None:
    state = FrontState(task(points=4))
    state.set_pool()
    form = state.form
    points = form.makeable.nearest(np.tile(form.upper, (form.instance.combinations.count, 1)))
    every = np.arange(len(points))
    rows, phi = form.points.feasible_rows(points, every)
    form.archive.add(every[rows], points[rows], phi[rows])
    assert len(form.archive)
    state.begin_again(infeasibility=True)
    assert state.infeasibility_mode
    assert state.form is not form
    assert state.form.counters is form.counters
    assert len(state.pool)
    np.testing.assert_array_equal(state.form.archive.phi, form.archive.phi)
    assert state.rule.known is state.form.archive
    # What the box of everything allows is noted each time.
    assert [len(bound.corners) for bound in state.proof.bounds] == [1, 1]


def test_covers_are_never_finer_than_the_gap() -> None:
    state = FrontState(task(points=4, gap=1e-2))
    np.testing.assert_array_equal(state.fine_cover().tolerance, state.rule.tolerance)
    np.testing.assert_allclose(state.rule.tolerance, -np.log1p(-1e-2))


@pytest.mark.parametrize(
    ("objectives", "times", "at_gap"),
    [
        (["mass", "flexibility", "width"], (1.6, 1.0, 0.5), True),
        (["mass", "flexibility", "width"], (1.4, 1.3, 1.5), True),  # 2.73 in all: less than twice as many designs
        (["mass", "flexibility", "width"], (1.4, 1.4, 1.5), False),
        (["mass", "flexibility", "width"], (9.0, 0.1, 0.1), False),
        (["mass", "flexibility"], (1.1, 1.0), False),
    ],
)
def test_with_three_objectives_a_cover_hardly_coarser_than_the_gap_is_made_at_the_gap(
    objectives: list[str], times: tuple[float, ...], at_gap: bool
) -> None:
    state = FrontState(task(objectives=objectives, points=50, gap=1e-3))
    m, gap = len(objectives), state.rule.tolerance
    ends = np.zeros((2, len(state.form.goals)))
    ends[0, 0] = ends[1, 1:m] = 1.0  # neither is better than the other in all objectives
    ends[:, :m] *= np.array(times) * gap * 50 / state.task.limits.fine
    state.form.archive.add(np.zeros(2, dtype=np.int64), np.zeros((2, state.form.n)), ends)
    coarser = gap * np.maximum(times, 1.0)
    np.testing.assert_allclose(state.fine_cover().tolerance, gap if at_gap else coarser, rtol=1e-12)
    assert not at_gap or np.array_equal(state.fine_cover().tolerance, gap)


def test_with_three_objectives_a_first_cover_is_as_fine_as_points_lie_apart_on_a_surface() -> None:
    for points, coarser in ((100, 2.5), (64, 2.0), (16, 1.0), (4, 1.0)):
        state = FrontState(task(objectives=["mass", "flexibility", "width"], points=points, gap=1e-4))
        ends = np.zeros((2, len(state.form.goals)))
        ends[0, 0] = ends[1, 1:3] = 1.0
        state.form.archive.add(np.zeros(2, dtype=np.int64), np.zeros((2, state.form.n)), ends)
        fine = state.fine_cover().tolerance
        np.testing.assert_allclose(fine, np.full(3, 2.0 / points))
        np.testing.assert_allclose(state.rough_cover().tolerance, coarser * fine)


def test_a_cover_that_is_noted_bounds_all_designs() -> None:
    state, proof = FrontState(task()), FrontProof(open_combinations=1.0)
    rule = state.rule
    proof.note_cover(rule)
    assert proof.finest_cover is rule
    (bound,) = proof.bounds
    np.testing.assert_array_equal(bound.tolerance, rule.tolerance)
    assert bound.corners.shape == (0, 2)
    proof.give_up()
    assert (proof.closed, proof.exhausted, proof.complete) == (False, False, False)


def test_a_design_takes_the_place_of_a_given_one_that_it_is_as_good_as() -> None:
    given = StartingFront(np.array([[0.0, 3.0], [2.0, 1.0], [-1.0, -1.0]]), None, np.full(2, np.inf))
    phi = np.array([[2.0, 0.5], [0.0, 3.0 + 1e-12], [1.0, 0.9], [5.0, 5.0]])
    # The third is as good as the second one given, and so is the first: the better sum wins; none reaches the last.
    assert given.places(phi, 1e-9) == [1, 2]
    assert StartingFront.nothing(2).places(phi, 1e-9) == []
