"""Levels of a front: what they claim of designs, against all points there are; and turns of two trees."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.search.front_state import FrontState
from synth.search.joint.levels import Cutoffs, LevelProof, levels_of_corners
from synth.search.proven_gap import Level, LevelBound
from synth.search.settings import SearchEffort
from synth.search.stages import levels as stage
from synth.search.stages.proving import proven_at_gap
from synth.search.turns import TurnBudget, alternate
from tests.asking import pose
from tests.sample_problems.strut import NEEDED, RODS, Strut

LOGS = np.array([True, True])


def a_level(rng: np.random.Generator, points: np.ndarray, tolerance: np.ndarray) -> Level:
    """Return a true statement about points: what is not below its value stands in no box, the rest in some."""
    within = np.array([np.inf, np.inf])
    sought = int(rng.integers(2))
    if rng.random() < 0.8:
        within[1 - sought] = rng.choice(points[:, 1 - sought])
    inside = points[np.all(points <= within, axis=1)]
    least = float(rng.choice(inside[:, sought])) if len(inside) else np.inf
    left = inside[inside[:, sought] < least - tolerance[sought]]
    corners = left - rng.random(left.shape) * 0.1 if rng.random() < 0.7 else left.min(axis=0, initial=np.inf)[None, :]
    return Level(within, sought, least, tolerance, corners[: len(left)])


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=300)
def test_no_point_improves_a_design_by_more_than_levels_allow(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, tolerance = np.round(rng.random((30, 2)), 2), np.full(2, 0.05)
    levels = [a_level(rng, points, tolerance) for _ in range(4)]
    told = LevelBound(tolerance, levels).gaps(points, LOGS, np.ones(2))
    better = -np.expm1(-(points[:, None, :] - points[None, :, :]).min(axis=2)).max(axis=1)
    assert np.all(better <= told + 1e-12)
    for level in levels:
        proven = level.proves(points, tolerance)
        assert np.all(better[proven] <= -np.expm1(-0.05) + 1e-12)
        assert not level.proves(points, 0.9 * tolerance).any()


def test_the_same_cutoff_stands_once_with_the_most_that_is_to_beat() -> None:
    cutoffs = Cutoffs(first=np.array([2.0, 1.0, 2.0]), to_beat=np.array([5.0, 7.0, 6.0]), tolerance=0.1).distinct()
    assert cutoffs.first.tolist() == [1.0, 2.0]
    assert cutoffs.to_beat.tolist() == [7.0, 6.0]


def test_levels_side_by_side_search_what_no_other_tells_of() -> None:
    cutoffs = Cutoffs(first=np.array([1.0, 2.0, 2.1, 3.0]), to_beat=np.array([7.0, 6.0, 6.5, 5.0]), tolerance=0.1)
    asked = cutoffs.side_by_side(np.array([-np.inf, -np.inf, 1.5, 2.5]), 0.5)
    assert asked.above is not None
    assert asked.follows is not None
    # The first has nothing below it, the third is to beat more than the one before it, and of the last more is known.
    assert asked.follows.tolist() == [False, True, False, False]
    np.testing.assert_allclose(asked.above, [-np.inf, 1.0, 1.5, 2.5])
    np.testing.assert_allclose(cutoffs.side_by_side(np.full(4, -np.inf), 0.5).above, [-np.inf, 1.0, -np.inf, 2.1])


@pytest.mark.slow
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=400)
def test_levels_side_by_side_say_of_everything_within_their_cutoffs_what_is_true(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tolerance, points = 0.25, rng.integers(-8, 8, (40, 2)) / 4.0  # ties, and values of both signs
    asked = Cutoffs(first=rng.integers(-8, 8, 6) / 4.0, to_beat=rng.integers(-8, 8, 6) / 4.0, tolerance=tolerance)
    if rng.random() < 0.6:
        asked = replace(asked, to_beat=np.sort(asked.to_beat)[::-1][np.argsort(np.argsort(asked.first))])
    asked = asked.distinct()
    first, to_beat = asked.first, asked.to_beat
    beaten = points[:, None, 1] < to_beat - tolerance  # of each point, at each level
    least = np.array([points[own, 0].min(initial=np.inf) for own in beaten.T])
    excluded = np.where(rng.random(len(first)) < 0.4, np.minimum(least - 0.01, first - 0.01), -np.inf)
    cutoffs = asked.side_by_side(excluded, float(rng.choice([0.01, 0.5])))
    assert cutoffs.above is not None
    within = (points[:, None, 0] > cutoffs.above) & (points[:, None, 0] <= first)
    known = np.array([rng.choice(points[points[:, 0] <= c, 1]) if (points[:, 0] <= c).any() else 9.0 for c in first])
    best = np.minimum(to_beat, np.where(rng.random(len(first)) < 0.5, known, np.inf))
    corners: dict[int, np.ndarray | None] = {}
    for k in range(len(first)):
        own = points[within[:, k] & (points[:, 1] < best[k] - tolerance)]
        corners[k] = None if rng.random() < 0.1 else own - 0.1 * rng.random(own.shape)
    told = levels_of_corners(cutoffs, best, corners)
    for level in told:
        inside = points[points[:, 0] <= level.within[0]]
        better = inside[inside[:, 1] < level.least - tolerance]
        held = np.all(better[:, None, :] >= level.corners[None, :, :], axis=2).any(axis=1)
        assert held.all()
    if not any(own is None or len(own) for own in corners.values()) and np.array_equal(best, to_beat):
        assert not (beaten & (points[:, None, 0] <= first)).any()  # what was asked of each is proven


class Work:
    """A tree that closes when it has looked into so many boxes; until then what is open falls as a power of them."""

    def __init__(self, needed: float, power: float) -> None:
        self.needed, self.power, self.done, self.asked = needed, power, 0.0, list[float]()
        self.finished = False

    @property
    def extent(self) -> float:
        return 5.0 * (1 + self.done) ** -self.power if self.done < self.needed else 0.0

    def finish(self, effort: SearchEffort) -> bool:
        self.finished = True
        return True

    def go_on(self, boxes: float, most: float) -> int:
        self.asked.append(boxes)
        self.done += min(boxes, most)
        return int(min(boxes, most))


def turns(*trees: Work, boxes: float = 1e9, seconds: float = 0.0) -> TurnBudget:
    budget, looks = TurnBudget(boxes, SearchEffort(seconds=seconds)), list[int]()
    last = alternate([lambda t=t: t for t in trees], budget, 100, lambda: looks.append(1))[-1]  # type: ignore[misc]
    assert looks == [1] * (trees[0].done > 100)
    assert budget.looked >= boxes or not last.extent
    return budget


def test_what_closes_soon_has_one_turn() -> None:
    first, second = Work(50, 0.5), Work(50, 0.5)
    turns(first, second)
    assert (len(first.asked), len(second.asked)) == (1, 0)


def test_the_tree_that_closes_faster_has_most_of_the_effort_and_the_other_stays_alive() -> None:
    good, bad = Work(1e5, 0.9), Work(1e12, 0.4)
    for pair in ((good, bad), (Work(1e12, 0.4), Work(1e5, 0.9))):
        budget = turns(*pair)
        wasted = max(pair, key=lambda w: w.needed).done
        assert budget.looked < 1.6e5 + 2e5
        assert 0.1 * budget.looked < wasted < 0.5 * budget.looked
    assert good.asked == sorted(good.asked)


def test_turns_end_with_the_boxes_and_the_tree_ahead_goes_on_against_time() -> None:
    assert turns(Work(1e12, 0.5), Work(1e12, 0.4), boxes=5000).looked == 5000
    ahead, behind = Work(1e15, 0.5), Work(1e15, 0.4)
    assert turns(behind, ahead, boxes=5000, seconds=60.0).spent
    assert (ahead.finished, behind.finished) == (True, False)


class Stuck(Work):
    """A tree that comes to boxes which are too small to be split: it looks into those few again and closes nothing."""

    def go_on(self, boxes: float, most: float) -> int:
        return super().go_on(boxes, most) if self.done < 1000 else 3


class Shaved(Stuck):
    """The same, where tightening takes a little off at each look."""

    @property
    def extent(self) -> float:
        return super().extent * 0.999**self.looks

    looks = 0

    def go_on(self, boxes: float, most: float) -> int:
        self.looks += 1
        return super().go_on(boxes, most)


def test_turns_end_where_neither_tree_has_boxes_to_split() -> None:
    first, second = Stuck(1e12, 0.5), Stuck(1e12, 0.5)
    budget = TurnBudget(1e9, SearchEffort(seconds=60.0))
    alternate([lambda: first, lambda: second], budget, 100, lambda: None)
    assert budget.looked < 10_000
    assert first.finished != second.finished
    # Each look may take a little off, as tightening does.
    less, little = Shaved(1e12, 0.5), Shaved(1e12, 0.5)
    budget = TurnBudget(1e9, SearchEffort(seconds=60.0))
    alternate([lambda: less, lambda: little], budget, 100, lambda: None)
    assert budget.looked < 10_000
    # One of them alone does not end the turns of the other.
    ahead = Work(1e5, 0.9)
    alternate([lambda: Stuck(1e12, 0.5), lambda: ahead], TurnBudget(1e9, SearchEffort()), 100, lambda: None)
    assert not ahead.extent


@pytest.mark.parametrize("apart", [0.0, 1.0])
def test_one_design_that_is_best_in_both_objectives_needs_no_levels(
    apart: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing can lie between the ends; looking for it would take longer than proving them."""
    looked: list[np.ndarray] = []
    monkeypatch.setattr(stage, "_prove_ends", lambda _: True)
    monkeypatch.setattr(stage, "_explore_levels", lambda _, first: looked.append(first))
    state = FrontState(pose(Strut(), NEEDED, catalogs={"rods": RODS}, points=4).search().state.task)
    state.set_pool()
    form = state.form
    points = form.makeable.nearest(np.tile(form.upper, (form.instance.combinations.count, 1)))
    rows, phi = form.points.feasible_rows(points, np.arange(len(points)))
    two = np.array([phi[0], phi[0]])
    two[1, :2] += [apart, -apart]
    form.archive.add(rows[:2], points[rows[:2]], two)
    stage.seek_levels(state)
    assert proven_at_gap(state) == (apart == 0)
    assert bool(looked) == (apart > 0)


def two_designs(state: FrontState) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Put two designs that do not beat each other into the archive of a state, and return their rows."""
    state.set_pool()
    form = state.form
    points = form.makeable.nearest(np.tile(form.upper, (form.instance.combinations.count, 1)))
    rows, phi = form.points.feasible_rows(points, np.arange(len(points)))
    two = np.array([phi[0], phi[0]])
    two[1, :2] += [1.0, -1.0]
    form.archive.add(rows[:2], points[rows[:2]], two)
    return rows[:2], points[rows[:2]], two


def asked_strut() -> FrontState:
    """Return the state of a search for struts that has not begun."""
    return FrontState(pose(Strut(), NEEDED, catalogs={"rods": RODS}, points=4).search().state.task)


def test_what_levels_have_taught_is_known_to_later_ones() -> None:
    state = asked_strut()
    _, _, phi = two_designs(state)
    cutoffs = Cutoffs(first=phi[:, 0], to_beat=np.full(2, np.inf), tolerance=1e-3)
    first = state.levels_within(cutoffs)
    branching = first.search.form.bounding.branching
    assert branching.learned == 0
    branching.learn(np.random.default_rng(1).random((30, branching.weights.shape[1])), np.ones(30))
    stage._take(state, first)
    second = state.levels_within(cutoffs)
    assert second.search.form.bounding.branching.learned == 30
    np.testing.assert_array_equal(second.search.form.bounding.branching.weights, branching.weights)


def test_first_levels_are_taught_by_the_designs_known_and_later_ones_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    state = asked_strut()
    _, _, phi = two_designs(state)
    monkeypatch.setattr(stage, "few_known", lambda _: True)
    tried: list[int] = []
    kept = LevelProof.try_known
    monkeypatch.setattr(LevelProof, "try_known", lambda self: tried.append(len(self.cutoffs)) or kept(self))
    for _ in range(2):
        stage._explore_levels(state, phi[:, 0])
    assert tried == [2]
    assert state.learned_at_levels is not None


@pytest.mark.parametrize("few", [True, False])
def test_where_few_designs_are_known_gaps_are_proven_and_not_looked_at(
    few: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = asked_strut()
    two_designs(state)
    looked: list[int] = []
    proven: list[int] = []
    monkeypatch.setattr(stage, "few_known", lambda _: few)
    monkeypatch.setattr(stage, "_prove_ends", lambda _: True)
    monkeypatch.setattr(stage, "_explore_levels", lambda _, first: looked.append(len(first)))
    monkeypatch.setattr(stage, "_prove", lambda _, first, *others: not proven.append(len(first)))
    assert stage.fill_levels(state)
    assert looked == ([] if few else [1])
    assert proven == [1]
    assert proven_at_gap(state)


def test_what_is_open_is_told_only_where_it_is_asked_for() -> None:
    state = asked_strut()
    _, _, phi = two_designs(state)
    levels = state.levels_within(Cutoffs(first=phi[:, 0], to_beat=np.full(2, np.inf), tolerance=1e-3))
    levels.prove_soon(TurnBudget(0.0, SearchEffort(seconds=0.0)), 0.0)
    levels.unproven[:] = [False, True]
    assert [len(level.corners) > 0 for level in levels.levels()] == [False, *(True for _ in levels.trees)]
    assert [len(level.corners) for level in levels.levels(only_proven=True)] == [0]


@pytest.mark.slow
@pytest.mark.parametrize("objectives", ["mass flexibility", "flexibility mass", "-width mass", "mass -width"])
def test_levels_prove_the_same_side_by_side_and_each_alone(objectives: str) -> None:
    asked = {name.strip("-"): "max" if name[0] == "-" else "min" for name in objectives.split()}
    question = pose(Strut(), NEEDED, catalogs={"rods": RODS}, points=4, objectives=asked)
    state = FrontState(question.search().state.task)
    form, rng = state.form, np.random.default_rng(5)
    share = rng.random((400, form.n))
    points = form.makeable.nearest(form.lower + share * (form.upper - form.lower))
    combinations = rng.integers(form.instance.combinations.count, size=400)
    rows, phi = form.points.feasible_rows(points, combinations)
    form.archive.add(combinations[rows], points[rows], phi[rows])
    known, tolerance = form.archive.phi[np.argsort(form.archive.phi[:, 0]), :2], state.rule.tolerance
    gaps = Cutoffs(first=known[1:, 0], to_beat=known[:-1, 1], tolerance=float(tolerance[1])).distinct()
    assert len(gaps) > 3
    nowhere = np.full(len(gaps), -np.inf)
    found = []
    for cutoffs in (gaps, gaps.side_by_side(nowhere, float(tolerance[0]))):
        levels = state.levels_within(cutoffs)
        levels.prove(TurnBudget(1e6, SearchEffort(seconds=0.0)), 100.0)
        assert not levels.unproven.any()
        found.append({float(level.within[0]): level.least for level in levels.levels()})
    assert found[0].keys() == found[1].keys() == set(gaps.first.tolist())
    # Each is the best there is to within the tolerance.
    assert max(abs(found[0][c] - found[1][c]) for c in found[0]) <= tolerance[1] + 1e-6
    assert any(found[0][c] < to_beat - tolerance[1] for c, to_beat in zip(gaps.first, gaps.to_beat, strict=True))
