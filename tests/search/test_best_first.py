"""The tree that goes on: it closes what a first search leaves open, and else tells the gap that is proven."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import synth
from synth.bounds.boxes import Boxes
from synth.bounds.log_relaxation import LogRelaxation
from synth.question.catalogs import catalogs_for
from synth.search.best_first import OpenBoxes, Progress, best_first
from synth.search.branch_and_bound import best, branch_and_bound, cover_of_one
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.proven_gap import Bound, least_gap
from synth.search.pruning import EpsilonCover
from synth.search.settings import TUNING, SearchEffort
from synth.system.deadline import Stopped
from tests.asking import instance_of
from tests.sample_problems.spring import OPTIMUM, TensionSpring
from tests.sample_problems.strut import NEEDED, RODS, Strut
from tests.tuned import synthesize, tuned

EFFORT = SearchEffort(seconds=np.inf)


def prepared():
    instance = instance_of(Strut(), NEEDED, catalogs_for(Strut(), {"rods": RODS}))
    return Formulation(instance, {"mass": "min", "flexibility": "min"}, 2)


@pytest.fixture
def form():
    return prepared()


def whole(form, tolerance):
    return EpsilonCover([0, 1], np.full(2, tolerance), np.full(2, np.inf), form.archive)


def test_it_closes_what_a_cover_leaves_open(form):
    rule = whole(form, 0.01)
    begun = branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 100)
    assert len(begun.open)
    ended = best_first(form, begun.open, rule, Clock(), np.random.default_rng(0), EFFORT)
    assert ended.closed
    assert not ended.spent


def test_boxes_with_the_largest_possible_gain_come_first_until_too_many_wait(form):
    rule = whole(form, 0.01)
    branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 100)
    left = branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), 100).open
    gain = rule.possible_gain(form.objectives.phi_of(left.bounds))
    little = 2 * gain.min()
    assert little < gain.max() / 2
    # Within a level what waits is in no order: levels are factors of the square root of 2, above the tolerance.
    for most, low, high in ((10**6, gain.max() / 2, gain.max()), (0, 0.0, little)):
        waiting = OpenBoxes(form, rule, most)
        waiting.add(left)
        assert len(waiting) == len(left) == sum(len(b) for b in waiting.batches)
        batch = waiting.next()
        first = rule.possible_gain(form.objectives.phi_of(batch.bounds))[0]
        assert low <= first <= high
        assert len(waiting) + len(batch) == len(left)


@pytest.mark.slow
def test_what_does_not_close_ends_by_the_count_of_boxes(form):
    limits = SearchEffort(seconds=np.inf, spell=200, patience=2, most_waiting=500, most_stuck=5)
    ends = []
    for own in (prepared(), prepared()):
        rule = whole(own, 1e-9)  # less than numbers can tell
        found = best_first(own, own.boxes.root(), rule, Clock(), np.random.default_rng(0), limits)
        ends.append((found.looked, len(found.open)))
    assert ends[0] == ends[1]
    assert ends[0][1] > 0
    rule = whole(form, 1e-9)
    spent = best_first(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), SearchEffort(seconds=0.0))
    assert spent.spent
    assert not spent.closed
    with pytest.raises(Stopped, match="time limit"):
        best_first(form, form.boxes.root(), rule, Clock(deadline=-np.inf), np.random.default_rng(0), EFFORT)


def test_boxes_close_where_fewer_wait_or_promise_less_or_hold_less():
    known = Progress(highest=5, waiting=100, extent=1.0)
    assert known.after(known, 0.05) is None
    for closed in ({"highest": 4}, {"waiting": 99}, {"extent": 0.9}):
        now = replace(known, **closed)
        assert now.after(known, 0.05) == now
    # Little counts as nothing, and adds up.
    first, second = replace(known, extent=0.97), replace(known, extent=0.94)
    assert first.after(known, 0.05) is None
    assert second.after(known, 0.05) == second
    # More of one does not spoil what is known of another.
    assert replace(known, highest=4, waiting=200).after(known, 0.05) == replace(known, highest=4)


def test_what_waits_holds_less_the_more_is_closed(form):
    rule = whole(form, 0.01)

    def left(node_limit: int) -> Boxes:
        return branch_and_bound(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0), node_limit).open

    extents = [form.boxes.extent(boxes) for boxes in (form.boxes.root(), left(50), left(100), left(200))]
    assert extents == sorted(extents, reverse=True)
    assert extents[0] > extents[-1] > 0
    # Halves hold as much as what was split, be it along a variable or between combinations; but for what lies between
    # makeable values.
    boxes = form.boxes.root()
    for _ in range(6):
        halves = Boxes.joined(list(form.boxes.split(boxes)))
        assert 0.98 * form.boxes.extent(boxes) < form.boxes.extent(halves) <= form.boxes.extent(boxes) * (1 + 1e-9)
        boxes = halves


def test_the_gap_of_open_boxes_is_what_they_allow(form):
    rule = cover_of_one(form, 0, 1e-3, np.full(2, np.inf))
    found, ended = best(form, form.boxes.root(), rule, Clock(), np.random.default_rng(0))
    assert ended.closed
    form.archive.__init__([0, 1], form.n, 2)
    left = branch_and_bound(form, form.boxes.root(), whole(form, 1e-3), Clock(), np.random.default_rng(0), 50).open
    assert len(left)
    corners, logs = form.objectives.phi_of(left.bounds)[:, :1], np.array([True])
    gap = least_gap([Bound(np.array([1e-3]), corners)], found.phi[None, :1], logs, np.ones(1))
    assert gap == pytest.approx(max(1 - np.exp(corners.min() - found.phi[0]), 1 - np.exp(-1e-3)))


def test_nothing_is_bounded_without_bounds():
    logs, one = np.array([True]), np.ones((1, 1))
    assert least_gap([], one, logs, np.ones(1)) is None
    assert least_gap([Bound(np.zeros(1), np.array([[-np.inf]]))], one, logs, np.ones(1)) is None
    signed = Bound(np.zeros(1), np.array([[-3.0]]))  # more than all of the range, and a bound nevertheless
    assert least_gap([signed], one, ~logs, np.ones(1)) == 4.0


def test_two_objectives_must_both_improve():
    corners = np.log([[1.0, 9.0], [4.0, 4.0]])
    listed = np.log([[2.0, 10.0], [8.0, 5.0]])
    bound = Bound(np.zeros(2), corners)
    gaps = bound.gaps(listed, np.ones(2, dtype=bool), np.ones(2))
    np.testing.assert_allclose(gaps, [0.1, 0.2])  # by the first box; by the second


# -- whole questions -------------------------------------------------------------------------------


def test_the_tension_spring_is_proven():
    front = synth.synthesize(TensionSpring, {}, gap=1e-5)
    assert front.certificate.kind == "global"
    assert front.certificate.budget is None
    assert front.designs[0].objectives["volume"] == pytest.approx(OPTIMUM, rel=2e-6)


@pytest.mark.slow
def test_a_narrow_engagement_band_is_proven_after_more_boxes_than_those_of_a_first_search(monkeypatch):
    by_all_limits, run = [], LogRelaxation.run
    monkeypatch.setattr(LogRelaxation, "run", lambda *given: by_all_limits.append(1) or run(*given))
    first = 50_000
    together = replace(TUNING.tree.together, after=first)
    front = synthesize(
        tuned(tree={"first_try": first, "cover_front": first, "together": together}),
        synth.load("centrifugal_two_spring", practice="off"),
        requirements={
            "required_torque": "90 N*m",
            "lining_wear": "0.4 mm",
            "driven_inertia": "0.1 kg*m2",
            "idle_speed": "80 rad/s",
            "contact_speed_min": "95 rad/s",
            "contact_speed_max": "135 rad/s",
            "full_torque_speed": "200 rad/s",
            "top_speed": "500 rad/s",
        },
        parts={
            "ball": ["ball 30"],
            "return_spring": ["CS-1.25x6.3x5.5"],
            "clamp_spring": ["CS-2.5x12.5x5.5"],
            "friction_pair": ["metal_ceramic_bronze_dry"],
        },
        fix={"balls": 4, "return_springs": 2, "clamp_springs": 3, "friction_surfaces": 8, "plate_travel": "1 mm"},
        objectives=["engagement_band"],
        points=1,
        grid=False,
        gap=2.5e-3,
        time_limit=600,  # however busy the machine is
    )
    assert front.certificate.kind == "global"
    assert front.statistics["boxes"] > first
    assert by_all_limits


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [["mass"], ["mass", "flexibility"]])
def test_what_is_left_open_tells_the_gap_and_that_the_budget_is_spent(objectives):
    trees = ("first_boxes", "coarse_boxes", "first_try", "cover_front", "boxes", "boxes_of_many", "boxes_of_few_parts")
    soon = dict.fromkeys(trees, 50 if len(objectives) > 1 else 1)
    soon["together"] = replace(TUNING.tree.together, boxes=0)
    ask = {"objectives": objectives, "catalogs": {"rods": RODS}, "points": 5}
    proven = synthesize(tuned(tree=soon), Strut(), NEEDED, **ask)
    assert proven.certificate.kind == "global"  # what the first search leaves open is closed
    left = synthesize(tuned(tree={**soon, "further": SearchEffort(seconds=0.0)}), Strut(), NEEDED, **ask)
    assert left.certificate.kind == "exhaustive"
    assert left.certificate.budget == 0.0
    assert 1e-3 <= left.certificate.gap < 1
    assert "budget" in left.certificate.sentence()
    assert not left.interrupted


def test_a_front_that_is_stopped_at_once_knows_the_gap_of_the_whole():
    front = synth.synthesize(Strut(), NEEDED, catalogs={"rods": RODS}, points=5, time_limit=0.3)
    assert front.certificate.gap is not None or not front.designs
