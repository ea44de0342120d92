"""Where boxes are split: what solved problems teach, what designs show, and that bounds do not depend on it."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from synth.bounds.clusters import ClusterTree, Factor
from synth.search.settings import TUNING
from tests.sample_problems.strut import designs_of, strut_form


def test_weights_are_learned_for_each_set_of_objectives():
    bounding = strut_form().bounding
    constraints, branching = len(bounding.question.constraints), bounding.branching
    multipliers = np.zeros((40, constraints + 3))
    multipliers[:20, [0, constraints]] = 3.0, 1.0  # the first objective hinges on the first limit
    multipliers[20:, [1, constraints + 1]] = 1.0, 1.0
    branching.learn(multipliers, np.ones(40))
    weights = branching.weights
    assert np.argmax(weights[1, :constraints]) == 0
    assert np.argmax(weights[2, :constraints]) == 1
    assert (
        weights[1, constraints + 1] == weights[2, constraints] == 0.0
    )  # an objective without a cutoff decides nothing
    for one, other in itertools.pairwise((weights[0], weights[3])):
        np.testing.assert_array_equal(one, other)  # no cutoff, or both: all problems count
    assert weights[0, 0] == pytest.approx(0.375, abs=0.01)


def test_what_is_important_is_learned_most():
    bounding = strut_form().bounding
    constraints, branching = len(bounding.question.constraints), bounding.branching
    multipliers = np.zeros((10, constraints + 3))
    multipliers[:9, 0] = multipliers[9:, 1] = 1.0
    branching.learn(multipliers, np.array([1.0] * 9 + [91.0]))
    assert branching.weights[0, 1] == pytest.approx(0.91, abs=0.01)


def test_what_teaches_nothing_is_passed_over():
    bounding = strut_form().bounding
    constraints, branching = len(bounding.question.constraints), bounding.branching
    before = branching.weights
    multipliers = np.zeros((2, constraints + 3))
    multipliers[1, 0] = np.nan
    branching.learn(multipliers, np.ones(2))
    assert branching.learned == 0
    assert branching.weights is before


@pytest.mark.parametrize("importance", [0.0, np.inf, np.nan])
def test_what_has_no_importance_or_no_end_of_it_teaches_nothing(importance):
    bounding = strut_form().bounding
    branching = bounding.branching
    multipliers = np.eye(2, len(bounding.question.constraints) + 3)
    with np.errstate(all="raise"):
        branching.learn(multipliers, np.array([importance, 1.0]))
    assert branching.learned == 1
    assert np.isfinite(branching.weights).all()


def test_scores_are_finite_where_widths_have_no_end():
    form = strut_form()
    branching, root = form.bounding.branching, form.boxes.root()
    ends = replace(root, low=np.full(root.low.shape, 1e-250), high=np.full(root.high.shape, 1e250))
    with np.errstate(all="raise"):
        idle = branching.scores(ends, [False] * len(form.constraints), 0)
        scores = branching.scores(ends, [True] * len(form.constraints), 1)
    assert not idle.any()
    assert np.isfinite(scores).all()


def test_a_cutoff_that_is_missing_spreads_clusters_without_an_end_to_it():
    form = strut_form()
    branching, influences = form.bounding.branching, form.bounding._influences
    tree = ClusterTree(Factor("", (), np.array([[-2.0], [3.0], [np.inf]]), (0,)), np.ones(1))
    with np.errstate(all="raise"):
        spread = branching._spread(tree, influences.anywhere)
    assert np.isfinite(spread).all()
    assert spread[0].max() > 100 * spread[1:].max()  # what has a cutoff is told from what has none first


def test_statistics_are_handed_over_between_questions_of_a_kind():
    one, other = (strut_form().bounding.branching for _ in range(2))
    multipliers = np.random.default_rng(2).random((30, one.weights.shape[1]))
    one.learn(multipliers, np.ones(30))
    assert other.adopt(one.statistics())
    assert other.learned == one.learned == 30
    np.testing.assert_array_equal(other.weights, one.weights)
    other.learn(multipliers, np.ones(30))  # what was handed over is a copy
    assert (one.learned, other.learned) == (30, 60)
    shorter = one.statistics()
    assert not other.adopt(replace(shorter, shares=shorter.shares[:, 1:]))
    assert other.learned == 60


def test_widths_are_measured_on_the_scale_of_the_influences():
    bounding = strut_form().bounding
    low, high = bounding.question.low[None], bounding.question.high[None]
    np.testing.assert_allclose(bounding.branching.widths(low, high), np.log(high / low))
    assert not bounding.branching.widths(low, low).any()
    assert not bounding.branching.spans.any()


def test_bounds_do_not_depend_on_where_boxes_are_split():
    form, rng = strut_form(), np.random.default_rng(4)
    points, combinations, phi = designs_of(form, rng, 5_000)
    boxes = form.boxes.split(form.boxes.split(form.boxes.root())[0])[0]
    before = form.boxes.contract(boxes, np.median(phi, axis=0))
    branching = form.bounding.branching
    branching.learn(rng.random((50, branching.weights.shape[1])), np.ones(50))
    branching.focus(points[:5], combinations[:5])
    after = form.boxes.contract(boxes, np.median(phi, axis=0))
    assert len(after) > 1
    for name in ("cell", "low", "high", "bounds", "tag"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
    assert not np.array_equal(after.scores, before.scores)


def test_influences_are_slopes_between_logarithms():
    form = strut_form()
    question, influences = form.bounding.question, form.bounding._influences
    names = [v.name for v in form.model.variables]
    mass, flexibility, width = influences.anywhere[len(question.constraints) :]
    for objective, expected in ((mass, (1, 1)), (flexibility, (1, 1)), (width, (1, 0))):
        found = [objective[names.index(name)] for name in ("width", "length")]
        np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-12)
    assert np.all(form.bounding.goal_sizes > 0)
    np.testing.assert_array_equal(strut_form().bounding._influences.anywhere, influences.anywhere)


def test_what_is_declared_to_be_split_last_counts_little(monkeypatch):
    form = strut_form()
    bounding, points = form.bounding, designs_of(form, np.random.default_rng(3), 200)
    bounding.branching.focus(*points[:2])
    before = bounding.branching.tables
    declared = bounding.question.model.declaration
    monkeypatch.setattr(declared, "late", {"width": (), "plate": ()})
    bounding.branching.focus(*points[:2])
    after, share = bounding.branching.tables, TUNING.branching.late
    names = [v.name for v in bounding.question.model.variables]
    factors = [f.name for f in bounding.question.factors]
    for k, name in enumerate(names):
        expected = before.steep[:, k] * (share if name == "width" else 1.0)
        np.testing.assert_allclose(after.steep[:, k], expected, rtol=1e-6)
    for name, was, now in zip(factors, before.spreads, after.spreads, strict=True):
        np.testing.assert_allclose(now, was * (share if name == "plate" else 1.0), rtol=1e-6)
    # Where an objective is asked for that sees more of them, nothing is late.
    monkeypatch.setattr(declared, "late", {"width": ("mass",), "plate": ("mass",)})
    bounding.branching.focus(*points[:2])
    np.testing.assert_array_equal(bounding.branching.tables.steep, before.steep)
