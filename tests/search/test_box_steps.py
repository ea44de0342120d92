"""Steps of trees that compiled code takes beside looks for designs: nothing of use is lost, however a tree ends."""

import numpy as np
import pytest

from synth.bounds.boxes import Boxes
from synth.kernels.loading import best_variant
from synth.search.archive import Archive
from synth.search.box_steps import BoxStep
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.pruning import EpsilonCover
from synth.search.settings import TUNING
from synth.system.deadline import Stopped
from tests.sample_problems.strut import designs_of, lost, strut_form
from tests.tuned import tuned

pytestmark = pytest.mark.skipif(best_variant("boxes") is None, reason="no kernel was built")
# Many steps are under way in a small tree: few boxes in a batch.
SMALL = {"batch": 48, "generation": 256, "small_batch": 16}
SLACK = np.array([0.02, 0.05])


@pytest.fixture(autouse=True)
def compiled(monkeypatch):
    """Let kernels compute."""
    monkeypatch.delenv("CLUTCHSYNTH_NATIVE", raising=False)


def posed(workers=2):
    """Return the form of a small tree."""
    return strut_form(tuning=tuned(tree=SMALL), workers=workers)


def cover(form, known=20):
    """Return the rule that covers everything by designs, some of which are known."""
    archive = Archive([0, 1], form.n, len(form.goals))
    points, combinations, phi = designs_of(form, np.random.default_rng(1), known)
    archive.add(combinations, points, phi)
    form.archive.add(combinations, points, phi)
    return EpsilonCover([0, 1], SLACK, np.full(len(form.goals), np.inf), archive)


def missed_of_use(form, rule, boxes):
    """Return how many random designs of use no box holds, and how many there are of use."""
    points, combinations, phi = designs_of(form, np.random.default_rng(9), 20_000)
    useful = rule.possible_gain(phi) > 10 * TUNING.tolerances.tie
    return int(lost(form, boxes, points[useful], combinations[useful]).sum()), int(useful.sum())


def tree(form, rule, clock=None, **more):
    """Return what a tree from the root leaves."""
    return branch_and_bound(form, form.boxes.root(), rule, clock or Clock(), np.random.default_rng(3), **more)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.parametrize("node_limit", [0, 50, 300, 1000, 2000])
def test_a_tree_that_ends_early_leaves_open_what_may_be_of_use(workers, node_limit, monkeypatch):
    monkeypatch.setattr(PrimalHeuristics, "search_boxes", lambda self, batch: None)  # else nearly all is covered soon
    form = posed(workers)
    rule = cover(form)
    outcome = tree(form, rule, node_limit=node_limit)
    missed, useful = missed_of_use(form, rule, outcome.open)
    assert missed == 0
    assert useful > 20


def test_a_tree_that_closes_has_covered_every_design():
    form = posed()
    rule = cover(form)
    assert tree(form, rule).closed
    phi = designs_of(form, np.random.default_rng(9), 20_000)[2]
    assert not np.any(rule.possible_gain(phi) > 10 * TUNING.tolerances.tie)


@pytest.mark.parametrize("more", [{"enough": 25}, {"hopeless": lambda looked, waiting: looked > 400}])
def test_so_does_one_that_is_given_up(more):
    form = posed()
    rule = cover(form)
    outcome = tree(form, rule, **more)
    assert outcome.full or outcome.abandoned
    missed, useful = missed_of_use(form, rule, outcome.open)
    assert missed == 0
    assert useful > 0


@pytest.mark.parametrize("after", [0, 1, 2, 5, 10])
def test_whatever_stops_a_tree_its_clock_holds_what_is_open_and_nothing_is_under_way(after, monkeypatch):
    form = posed()
    rule, clock = cover(form), Clock()
    steps, calls = list[BoxStep](), 0
    begun = BoxStep.__init__

    def noted(self, *args):
        begun(self, *args)
        steps.append(self)

    def look(self, batch):
        nonlocal calls
        calls += 1
        if calls > after:
            raise Stopped("time limit")

    monkeypatch.setattr(BoxStep, "__init__", noted)
    monkeypatch.setattr(PrimalHeuristics, "search_boxes", look)
    with pytest.raises(Stopped):
        tree(form, rule, clock)
    missed, useful = missed_of_use(form, rule, Boxes.joined(clock.open))
    assert missed == 0
    assert useful > 20
    assert len(steps) > after
    for step in steps:
        assert step._growth is not None
        assert all(other.done() for other in step._growth._parts._futures)


def outcome_of(workers):
    """Return numbers of boxes and designs of a tree."""
    form = posed(workers)
    rule = cover(form)
    outcome = tree(form, rule, node_limit=3000)
    return outcome.looked, len(outcome.open), outcome.open.low.tobytes(), form.archive.phi.tobytes()


@pytest.mark.slow
def test_threads_change_nothing():
    assert outcome_of(1) == outcome_of(2) == outcome_of(3)


@pytest.mark.slow
@pytest.mark.parametrize("native", ["1", "0"])
def test_arrays_cover_as_much(native, monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", native)
    form = posed()
    rule = cover(form)
    assert tree(form, rule).closed
    phi = designs_of(form, np.random.default_rng(9), 20_000)[2]
    assert not np.any(rule.possible_gain(phi) > 10 * TUNING.tolerances.tie)


def test_a_step_goes_by_what_was_known_when_it_began():
    """What is found meanwhile counts for the next one: else the result would hang on what the threads are at."""
    found = []
    for meanwhile in (0, 300):
        form = posed()
        rule = cover(form, 1)
        rng = np.random.default_rng(3)
        heuristics = PrimalHeuristics(form, rule, rng, False)
        heuristics.failures = 10**6  # nothing is looked for in it
        boxes = form.boxes.lean(form.boxes.root())
        for _ in range(4):
            boxes = BoxStep(form, boxes, rule, heuristics).finish(0)[0]
        step = BoxStep(form, boxes, rule, heuristics)
        points, combinations, phi = designs_of(form, rng, meanwhile)
        rule.take(combinations, points, phi)
        found.append(step.finish(0))
    (halves, _, looked), (others, _, looked_then) = found
    assert looked == looked_then > 0
    np.testing.assert_array_equal(halves.low, others.low)
    np.testing.assert_array_equal(halves.cell, others.cell)
