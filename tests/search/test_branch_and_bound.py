"""The cover: what known designs leave to find, against brute force, and a small question that must close."""

from itertools import product

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth
from synth.question.catalogs import catalogs_for
from synth.search.archive import Archive, Candidate, distinct
from synth.search.branch_and_bound import best, branch_and_bound, cover_of_one
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import spread_choice
from synth.search.pruning import EpsilonCover, NonImprovement
from synth.search.settings import TUNING
from synth.system.deadline import Stopped
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut, feasible_candidates

TIE = TUNING.tolerances.tie

WIDTH = 4  # objectives; the first ones are traded off


def some_phi(rng, count):
    """Return rows on a coarse grid, so that equal values are frequent."""
    return np.round(rng.uniform(0, 1, (count, WIDTH)), 1)


def archive_of(phi, m):
    archive = Archive(range(m), 0, WIDTH)
    archive.add(np.arange(len(phi)), np.empty((len(phi), 0)), phi)
    return archive


def cutoff_by_hand(known, tolerance, lower, k):
    """Return the least value of objective k, less its tolerance, among those that cover the box in all others."""
    others = [j for j in range(len(lower)) if j != k]
    cutoffs = [p[k] - tolerance[k] for p in known if all(p[j] - tolerance[j] <= lower[j] for j in others)]
    return min(cutoffs, default=np.inf)


@pytest.mark.slow
@pytest.mark.parametrize("m", [1, 2, 3, 4])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_cutoffs_and_possible_gain_of_a_cover_against_brute_force(m, seed):
    rng = np.random.default_rng(seed)
    archive = archive_of(some_phi(rng, int(rng.integers(0, 30))), m)
    tolerance = np.round(rng.uniform(0.0, 0.3, m), 2)
    fixed_cutoffs = np.where(rng.random(WIDTH) < 0.3, 0.7, np.inf)
    lower = some_phi(rng, 50)
    lower[rng.random(lower.shape) < 0.1] = -np.inf
    rule = EpsilonCover(range(m), tolerance, fixed_cutoffs, archive)
    cutoffs, gain = rule.cutoffs(lower), rule.possible_gain(lower)
    for own, cutoff, own_gain in zip(lower, cutoffs, gain, strict=True):
        by_hand = [cutoff_by_hand(archive.phi[:, :m], tolerance, own[:m], k) for k in range(m)]
        expected = fixed_cutoffs + TIE
        expected[:m] = np.minimum(expected[:m], by_hand)
        np.testing.assert_array_equal(cutoff, expected)
        least = min(np.inf if np.isnan(c - o) else c - o for c, o in zip(by_hand, own[:m], strict=True))
        assert own_gain == (0.0 if np.any(own > fixed_cutoffs + TIE) else least)


@pytest.mark.parametrize("m", [1, 2, 3, 4])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_a_box_without_possible_gain_is_covered_and_cutoffs_exclude_only_what_is_covered(m, seed):
    rng = np.random.default_rng(seed)
    archive = archive_of(rng.uniform(0, 1, (20, WIDTH)), m)
    tolerance = rng.uniform(0, 0.1, m)
    rule = EpsilonCover(range(m), tolerance, np.full(WIDTH, np.inf), archive)
    lower = rng.uniform(0, 1, (60, WIDTH))
    design = lower + rng.exponential(0.1, lower.shape)  # anything the box may hold
    known = archive.phi[:, :m] - tolerance
    covered = np.all(known[None] <= design[:, None, :m], axis=2).any(axis=1)
    assert covered[rule.possible_gain(lower) <= 0].all()
    assert np.any(rule.possible_gain(lower) > 0) == (
        not np.all(np.all(known[None] <= lower[:, None, :m], axis=2).any(axis=1))
    )
    assert covered[np.any(design > rule.cutoffs(lower), axis=1)].all()


def test_a_cover_takes_what_no_known_design_covers():
    archive = archive_of(np.array([[0.5, 0.5, 0, 0]]), 2)
    rule = EpsilonCover([0, 1], np.array([0.1, 0.1]), np.array([np.inf, np.inf, 0.6, np.inf]), archive)
    phi = np.array([[0.45, 0.45, 0, 0], [0.3, 0.9, 0, 0], [0.1, 0.1, 0.9, 0]])
    # The first is better by less than the tolerance: kept, but of no use; the last breaks a cutoff.
    assert rule.take(np.arange(3), np.empty((3, 0)), phi) == 1
    assert sorted(archive.phi[:, 0]) == [0.3, 0.45]
    assert rule.take(np.arange(0), np.empty((0, 0)), phi[:0]) == 0


def non_improvement(rng, m):
    """Return the rule that proves some designs of a random front, these designs, and the tolerance."""
    archive = archive_of(some_phi(rng, 25), m)
    chosen = rng.choice(len(archive), size=int(rng.integers(1, len(archive) + 1)), replace=False)
    designs = [archive[int(k)] for k in chosen]
    tolerance = np.round(rng.uniform(0.01, 0.2, m), 2)
    proven = {c.phi.tobytes() for c in designs if rng.random() < 0.3}
    return NonImprovement(designs, range(m), tolerance, archive, proven), designs, tolerance, archive, proven


def steps_by_hand(designs, tolerance, proven, m):
    steps = [c.phi[:m] - tolerance for c in designs if c.phi.tobytes() not in proven]
    for k in range(m):
        best_one = min(c.phi[k] for c in designs) - tolerance[k]
        steps.append(np.array([best_one if j == k else np.inf for j in range(m)]))
    return steps


@pytest.mark.slow
@pytest.mark.parametrize("m", [1, 2, 3, 4])
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_cutoffs_and_possible_gain_of_non_improvement_against_brute_force(m, seed):
    rng = np.random.default_rng(seed)
    rule, designs, tolerance, archive, proven = non_improvement(rng, m)
    steps = steps_by_hand(designs, tolerance, proven, m)
    lower = some_phi(rng, 50) - 0.1
    lower[rng.random(lower.shape) < 0.1] = -np.inf
    for own, cutoff, own_gain in zip(lower[:, :m], rule.cutoffs(lower), rule.possible_gain(lower), strict=True):
        known = [cutoff_by_hand(archive.phi[:, :m], tolerance, own, k) for k in range(m)]
        below = [s for s in steps if np.all(own < s)]
        expected = [min(max((s[k] for s in below), default=-np.inf), known[k]) for k in range(m)]
        np.testing.assert_array_equal(cutoff[:m], expected)
        assert np.all(np.isinf(cutoff[m:]))
        covered = any(np.all(p[:m] - tolerance <= own) for p in archive.phi)
        if below and not covered:
            assert own_gain == min(np.array(expected) - own) > 0
        else:
            assert not own_gain > 0


def test_a_design_that_is_beaten_is_replaced():
    archive = archive_of(np.array([[0.2, 0.8, 0, 0], [0.5, 0.5, 0, 0], [0.8, 0.2, 0, 0]]), 2)
    rule = NonImprovement(list(archive), [0, 1], np.array([0.1, 0.1]), archive)
    beside = np.array([[0.15, 0.9, 0, 0], [0.45, 0.55, 0, 0]])
    assert rule.take(np.arange(2), np.empty((2, 0)), beside) == 0
    better = np.array([[0.48, 0.45, 0, 0], [0.05, 0.9, 0, 0]])
    assert rule.take(np.array([7, 8]), np.empty((2, 0)), better) == 2
    assert sorted(c.combination for c in rule.designs) == [2, 7, 8]
    assert rule.possible_gain(np.array([[0.36, 0.34, 0, 0]]))[0] == pytest.approx(0.01)


# -- what is chosen ----------------------------------------------------------------------------------


def candidates(*phi):
    return [Candidate(k, np.zeros(0), np.array(p, dtype=float)) for k, p in enumerate(phi)]


def test_distinct_keeps_the_first_of_those_that_differ_by_rounding():
    tiny = 0.4 * TUNING.tolerances.rounded
    kept = distinct(candidates((1, 2), (1 + tiny, 2 - tiny), (2, 1), (2, 2), (1, 2)), 2, TUNING)
    assert [c.combination for c in kept] == [0, 2]


def test_distinct_drops_what_is_beaten_wherever_it_stands():
    assert [c.combination for c in distinct(candidates((3, 3), (1, 2), (2, 1)), 2, TUNING)] == [1, 2]
    assert [c.combination for c in distinct(candidates((1, 2, 9), (1, 2.5, 0)), 2, TUNING)] == [0]
    assert distinct([], 2, TUNING) == []


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_distinct_leaves_designs_of_which_none_beats_another_and_drops_only_what_is_beaten(seed):
    rng = np.random.default_rng(seed)
    tried = candidates(*np.round(rng.uniform(0, 1, (int(rng.integers(1, 20)), 2)), 1))
    kept = distinct(tried, 2, TUNING)
    for a, b in product(kept, kept):
        assert a is b or not np.all(a.phi <= b.phi)
    for c in tried:
        assert any(np.all(a.phi <= c.phi) for a in kept)


def test_boxes_are_chosen_along_the_front_and_by_possible_gain():
    along, gain = np.arange(10.0)[::-1], np.array([0, 1, 0, 0, 0, 5, 4, 0, 3, 0.0])
    assert sorted(spread_choice(along, gain, 2)) == [1, 5]
    assert spread_choice(along, gain, 10).tolist() == list(range(10))


# -- a small question --------------------------------------------------------------------------------


@pytest.fixture
def form():
    problem = Strut()
    instance = instance_of(problem, NEEDED, catalogs_for(problem, {"rods": RODS}))
    return Formulation(instance, {"mass": "min", "flexibility": "min"}, 2)


def sampled(form, rng, count=20000):
    share = rng.random((count, form.n))
    points = form.makeable.nearest(form.lower + share * (form.upper - form.lower))
    return feasible_candidates(form, points, rng.integers(form.instance.combinations.count, size=count))


def test_a_cover_closes_and_no_design_is_better_by_more_than_the_tolerance(form):
    tolerance = np.array([0.02, 0.02])
    rule = EpsilonCover([0, 1], tolerance, np.full(2, np.inf), form.archive)
    outcome = branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 1e6)
    assert outcome.closed
    assert outcome.looked > 0
    rows, _ = form.points.feasible_rows(form.archive.variables, form.archive.combination)
    assert len(rows) == len(form.archive) > 3
    others = sampled(form, np.random.default_rng(1))
    assert len(others) > 500
    known = form.archive.phi - tolerance
    for c in others:
        assert np.any(np.all(known <= c.phi + 1e-6, axis=1))


@pytest.mark.parametrize("column", [0, 1])
def test_the_best_design_is_proven(form, column):
    others = sampled(form, np.random.default_rng(2))
    form.archive.__init__([0, 1], form.n, 2)
    fixed_cutoffs = np.full(2, np.inf)
    found, outcome = best(
        form, form.boxes.root(), cover_of_one(form, column, 1e-3, fixed_cutoffs), Clock(), np.random.default_rng(0)
    )
    assert outcome.closed
    assert found.phi[column] <= min(c.phi[column] for c in others) + 1e-3


def test_the_node_limit_and_time_end_a_tree(form):
    rule = EpsilonCover([0, 1], np.array([1e-4, 1e-4]), np.full(2, np.inf), form.archive)
    outcome = branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 1)
    assert not outcome.closed
    assert len(outcome.open)
    with pytest.raises(Stopped, match="time limit"):
        branch_and_bound(form, form.boxes.root(), rule, Clock(deadline=-np.inf), np.random.default_rng(0))


def test_enough_designs_end_a_cover(form):
    rule = EpsilonCover([0, 1], np.array([1e-3, 1e-3]), np.full(2, np.inf), form.archive)
    outcome = branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 1e6, enough=5)
    assert outcome.full
    assert not outcome.closed
    assert len(form.archive) > 5


def test_a_small_question_is_proven_from_end_to_end():
    front = synth.synthesize(Strut(), NEEDED, catalogs={"rods": RODS}, points=6, gap=0.01)
    assert front.certificate.kind == "global"
    assert 3 <= len(front.designs) <= 6
    again = synth.synthesize(Strut(), NEEDED, catalogs={"rods": RODS}, points=6, gap=0.01)
    first, second = (pd.DataFrame([dict(d.objectives) for d in f.designs]) for f in (front, again))
    pd.testing.assert_frame_equal(first, second)
