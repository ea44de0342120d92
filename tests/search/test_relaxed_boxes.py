"""One best design by all limits together: what closes then, and what is told where it does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import synth
from synth.search.branch_and_bound import branch_and_bound, cover_of_one
from synth.search.budget import Clock
from synth.search.relaxed_boxes import RelaxedBoxes
from synth.search.settings import TUNING
from tests.asking import pose
from tests.benchmarks.families import example
from tests.sample_problems.spring import OPTIMUM, TensionSpring
from tests.tuned import synthesize, tuned

TOGETHER = replace(TUNING.tree.together, after=3)  # nearly at once


@pytest.mark.slow
def test_the_lightest_spring_is_proven_with_a_fraction_of_the_boxes():
    nearly, never = (
        synthesize(
            tuned(tree={"first_try": 3, "together": limits}), TensionSpring, {}, points=1, gap=1e-5, time_limit=60
        )
        for limits in (TOGETHER, replace(TOGETHER, boxes=0))
    )
    assert nearly.certificate.kind == never.certificate.kind == "global"
    assert nearly.designs[0].values["volume"] == pytest.approx(OPTIMUM, rel=1e-4)
    assert 10 * nearly.statistics["boxes"] < never.statistics["boxes"]


class Plate(synth.DesignProblem):
    """A plate of a least area with the least cost, whose length comes in steps."""

    name, title, sources = "plate", "Plate", ("any textbook",)

    def declare(self, d):
        length = d.variable("length", "mm", 10, 1000, grid=7)
        width = d.variable("width", "mm", 10, 1000)
        d.derive("cost", "m", length + 3 * width)
        d.at_least("area", length * width, 0.01, "m2")
        d.objective("cost", "min")


def test_makeable_sizes_stay_makeable():
    form = pose(Plate, {}).search().state.form
    cutoffs = np.full((1, form.bounded), np.inf)
    cutoffs[0, 0] = np.log(0.36)
    boxes = form.boxes.lean(form.boxes.root())
    tight = RelaxedBoxes(form, 0).tighten(boxes, cutoffs)
    grid = form.instance.ranges.grids()[0]
    assert len(tight) == 1
    assert tight.low[0, 0] > boxes.low[0, 0]
    assert tight.high[0, 0] < boxes.high[0, 0]
    for end in (tight.low[0, 0], tight.high[0, 0]):
        assert np.abs(grid - end).min() <= 1e-9


def test_a_tree_that_is_given_up_tells_what_is_open():
    state = pose(TensionSpring, {}, gap=1e-6).search().state
    state.set_pool()
    form = state.form
    rule = cover_of_one(form, 0, 1e-6, np.full(len(form.goals), np.inf))
    outcome = branch_and_bound(
        form,
        state.pool,
        rule,
        Clock(),
        state.rng,
        hopeless=lambda looked, waiting: looked >= 3,
        together=RelaxedBoxes(form, 0),
    )
    least = np.exp(form.objectives.phi_of(outcome.open.bounds)[:, 0].min())
    assert outcome.abandoned
    assert 0.3 * OPTIMUM < least < OPTIMUM


@pytest.mark.slow
def test_the_least_diameter_of_the_reversed_clutch_is_proven_with_all_sizes_open():
    question = example("centrifugal_reversed", ())
    problem, asked = synth.load(question.family, practice="off"), question.requirements
    front = synth.synthesize(problem, asked, objectives=["outer_diameter"], points=1, gap=1e-2, grid=False)
    assert front.certificate.kind == "global"
    assert front.designs[0].values["outer_diameter"] == pytest.approx(0.11168, rel=1e-2)
