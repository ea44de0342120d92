"""Looking for designs beside known ones, and what is learned for splitting."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import synth
from synth.nlp.batch import Tasks
from synth.question.catalogs import catalogs_for
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.one_exchange import OneExchange, corners
from synth.search.primal_heuristics import PrimalHeuristics, spread_choice
from synth.search.pruning import EpsilonCover
from tests.asking import instance_of
from tests.sample_problems.strut import NEEDED, RODS, Strut


def strut_form(traded=2, grid=False):
    problem = Strut()
    instance = instance_of(problem, NEEDED, catalogs_for(problem, {"rods": RODS}), grid=grid)
    return Formulation(instance, {"mass": "min", "flexibility": "min", "width": "min"}, traded)


def cover(form, tolerance=1e-3):
    m = len(form.archive.columns)
    return EpsilonCover(range(m), np.full(m, tolerance), np.full(len(form.goals), np.inf), form.archive)


def heuristics(form):
    return PrimalHeuristics(form, cover(form), np.random.default_rng(0), False)


def one_exchange(form):
    return OneExchange(form, cover(form), np.random.default_rng(0))


def first_design(form, combination, rng):
    """Archive one feasible design of a combination, as it comes."""
    points = form.lower + rng.random((4000, form.n)) * (form.upper - form.lower)
    rows, phi = form.points.feasible_rows(form.makeable.nearest(points), np.full(len(points), combination))
    worst = rows[int(np.argmax(phi[rows, 0]))]
    form.archive.add(np.array([combination]), form.makeable.nearest(points[worst][None, :]), phi[worst][None, :])


@pytest.mark.parametrize("grid", [False, True])
def test_exchanging_parts_finds_what_solving_everything_finds(grid):
    form, rng = strut_form(1, grid), np.random.default_rng(3)
    everything = np.arange(form.instance.combinations.count)
    points = form.lower + rng.random((20000, form.n)) * (form.upper - form.lower)
    own = rng.choice(everything, len(points))
    rows, phi = form.points.feasible_rows(form.makeable.nearest(points), own)
    first_design(form, int(own[rows[int(np.argmax(phi[rows, 0]))]]), rng)
    before = form.archive.phi[0, 0]
    one_exchange(form).improve(Clock())
    assert form.archive.phi[0, 0] < before - 0.1
    assert form.archive.phi[0, 0] <= phi[rows, 0].min() + 1e-9


def test_a_front_grows_to_both_ends_and_keeps_only_feasible_designs():
    form, rng = strut_form(), np.random.default_rng(4)
    points = form.lower + rng.random((20000, form.n)) * (form.upper - form.lower)
    own = rng.choice(form.instance.combinations.count, len(points))
    rows, phi = form.points.feasible_rows(points, own)
    first_design(form, int(own[rows[0]]), rng)
    one_exchange(form).improve(Clock())
    archive = form.archive
    assert len(archive) > 10
    assert len(form.points.feasible_rows(archive.variables, archive.combination)[0]) == len(archive)
    assert np.all(archive.phi[:, :2].min(axis=0) <= phi[rows, :2].min(axis=0) + 1e-9)


def test_nothing_is_looked_for_where_nothing_is_known():
    form = strut_form()
    one_exchange(form).improve(Clock())
    assert form.counters.nlp_solves == 0


def test_corners_lie_below_two_neighbours_where_the_steps_are_widest():
    phi = np.array([[0.0, 10.0], [1.0, 4.0], [1.5, 3.9], [5.0, 0.0]])
    assert corners(phi, 9).tolist() == [[0.0, 4.0], [1.0, 3.9], [1.5, 0.0]]
    assert corners(phi, 2).tolist() == [[0.0, 4.0], [1.5, 0.0]]
    assert corners(phi[:1], 5).tolist() == [[0.0, 10.0]]


def test_a_spread_choice_takes_the_largest_gain_of_each_stretch():
    rng = np.random.default_rng(1)
    along, space = rng.random(103), rng.random(103)
    chosen = spread_choice(along, space, 10)
    order = np.argsort(along)
    groups = np.arange(103) * 10 // 103
    assert sorted(chosen) == sorted(int(order[groups == g][np.argmax(space[order[groups == g]])]) for g in range(10))
    assert spread_choice(along[:5], space[:5], 10).tolist() == [0, 1, 2, 3, 4]


def test_limits_that_exclude_each_other_teach_what_to_split():
    form = strut_form()
    assert not len(form.archive)
    boxes = form.boxes.root()
    heuristics(form).search_boxes(boxes)
    assert form.bounding.branching.learned > 0


class Narrow(synth.DesignProblem):
    """A size in whole numbers, for which force and time are left a sliver that is curved."""

    name, title = "narrow", "Narrow"

    def declare(self, d):
        size = d.variable("size", "-", 1, 100, grid=1)
        force, time = d.variable("force", "-", 1, 100), d.variable("time", "-", 1, 3.2)
        d.at_least("torque", force * size, 100, "-")
        d.at_most("jerk", force, time**2, "-")
        d.objective("size")


def test_what_no_point_hits_is_solved_for():
    form = Formulation(instance_of(Narrow(), {}, catalogs_for(Narrow(), {})), {"size": "min"}, 1)
    sliver, combination = np.array([0.02, 0.5]), np.zeros(1, dtype=np.int64)
    force, time = 10 + sliver * (3.2**2 - 10), 10**0.5 + sliver * (3.2 - 10**0.5)
    assert not len(form.points.feasible_rows(np.stack([[10.0, 10.0], force, time], axis=1), np.zeros(2, dtype=int))[0])
    tasks = Tasks(np.ones((1, 1)), np.zeros((1, 1)), np.full((1, 1), np.inf), form.objectives.scales, 0.0)
    optimum = form.continuous.solve_batch(tasks, combination, np.array([[50.0, 50.0, 2.0]]))
    assert optimum.variables[0, 0] == pytest.approx(100 / 3.2**2, rel=1e-6)
    assert heuristics(form).round_off(form.boxes.leaves(combination), optimum.variables, tasks) > 0
    assert form.archive.variables[0, 0] == 10
    assert len(form.points.feasible_rows(form.archive.variables, form.archive.combination)[0]) == 1


class Lidded(synth.DesignProblem):
    """A frame of any size with a lid: anywhere the frame weighs most by far, in a good design the lid does."""

    name, title = "lidded", "Lidded"

    def declare(self, d):
        frame, lid = d.variable("frame", "-", 1, 100), d.part("lid", "rows")
        d.derive("mass", "kg", frame**3 + 100 * lid.size)
        d.at_least("room", frame * lid.size, 1.5, "-")
        d.objective("mass")


def test_boxes_are_split_along_what_matters_at_the_designs_known():
    rows = pd.DataFrame({"designation": list("abcd"), "size [-]": [1.0, 1.1, 1.3, 1.6]})
    problem = Lidded()
    form = Formulation(instance_of(problem, {}, catalogs_for(problem, {"rows": rows})), {"mass": "min"}, 1)
    cutoffs = np.array([np.inf])
    before = form.boxes.contract(form.boxes.root(), cutoffs)
    point, combination = np.array([[1.5]]), np.array([0])
    feasible, phi = form.points.feasible_rows(point, combination)
    form.archive.add(combination[feasible], point[feasible], phi[feasible])
    form.boxes.focus(form.archive)
    after = form.boxes.contract(form.boxes.root(), cutoffs)
    assert before.scores[0, 0] > before.scores[0, 1]
    assert after.scores[0, 0] < before.scores[0, 0]
    assert after.scores[0, 1] > before.scores[0, 1]
    for name in ("cell", "low", "high", "bounds"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))


class Clearance(synth.DesignProblem):
    """The smallest clearance of a pair: no bound knows it to be positive, and the best is far below the usual."""

    name, title = "clearance", "Clearance"

    def declare(self, d):
        hole, pin = d.part("hole", "rows"), d.part("pin", "rows")
        d.at_least("fits", hole.size, pin.size, "-")
        d.derive("clearance", "-", hole.size - 1.01 * pin.size + 0.0101)
        d.objective("clearance")


def test_the_gap_of_one_objective_is_a_share_of_its_best_value():
    size = np.random.default_rng(2).random(80)
    rows = pd.DataFrame({"designation": [f"r{k}" for k in range(80)], "size [-]": size})
    front = synth.synthesize(Clearance(), {}, catalogs={"rows": rows}, gap=0.1)
    pairs = size[:, None] - 1.01 * size[None, :] + 0.0101
    least = pairs[size[:, None] >= size[None, :]].min()
    assert front.certificate.kind == "global"
    assert 0 < least <= front.designs[0].values["clearance"] <= least / 0.9


class Wide(synth.DesignProblem):
    """A size in whole numbers beside a force that any point may have, of which the least that will do is best."""

    name, title = "wide", "Wide"

    def declare(self, d):
        size, force = d.variable("size", "-", 1, 100, grid=1), d.variable("force", "-", 1, 100)
        d.at_least("torque", force * size, 100, "-")
        d.derive("cost", "-", size + 1.3 * force)
        d.objective("cost")


def test_beside_a_makeable_size_the_rest_is_the_best_there_is():
    form = Formulation(instance_of(Wide(), {}, catalogs_for(Wide(), {})), {"cost": "min"}, 1)
    combination = np.zeros(1, dtype=np.int64)
    tasks = Tasks(np.ones((1, 1)), np.zeros((1, 1)), np.full((1, 1), np.inf), form.objectives.scales, 0.0)
    optimum = form.continuous.solve_batch(tasks, combination, np.array([[50.0, 50.0]]))
    assert optimum.variables[0] == pytest.approx([130**0.5, 100 / 130**0.5], rel=1e-6)
    heuristics(form).round_off(form.boxes.leaves(combination), optimum.variables, tasks)
    size, force = form.archive.variables[np.argmin(form.archive.phi[:, 0])]
    assert (size, force) == (11, pytest.approx(100 / 11, rel=1e-6))
