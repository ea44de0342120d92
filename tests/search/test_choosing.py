"""What is looked for where a front has fewer designs than asked for, and what the covers of that prove."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from synth.order.pareto import non_dominated
from synth.search.front_search import find_designs
from synth.search.front_state import FrontState
from synth.search.stages.choosing import _search_further, choose_designs
from synth.search.stages.first_by_rank import find_first
from synth.search.stages.trees import cover_everything
from tests.asking import pose
from tests.repetitions import repetitions
from tests.sample_problems.strut import NEEDED, RODS, Strut


def state_of(points: int = 4, **more: Any) -> FrontState:
    """Return the state of a search that has found its first box."""
    state = FrontState(pose(Strut(), NEEDED, catalogs={"rods": RODS}, points=points, **more).search().state.task)
    state.set_pool()
    return state


def everything(state: FrontState, count: int = 3000, seed: int = 0) -> np.ndarray:
    """Return phi of feasible designs of all parts: random ones, and the ends of what is free."""
    form, rng = state.form, np.random.default_rng(seed)
    combinations = rng.integers(form.instance.combinations.count, size=count)
    own = rng.random((count, form.n)) ** rng.integers(0, 2, (count, 1))
    share = rng.choice([0.0, 1.0, 0.5], size=(count, form.n)) * own
    points = form.makeable.nearest(form.lower + share * (form.upper - form.lower))
    rows, phi = form.points.feasible_rows(points, combinations)
    return phi[rows][:, : state.task.m]


def covered(state: FrontState, phi: np.ndarray, tolerance: np.ndarray) -> bool:
    """Tell whether each design has a known one that is worse by no more than a tolerance in any objective."""
    known = state.form.archive.phi[:, : state.task.m]
    return bool(np.all(known[None, :, :] <= phi[:, None, :] + tolerance, axis=2).any(axis=1).all())


TWO, NARROW, THREE = ["mass", "flexibility"], ["mass", "width"], ["mass", "flexibility", "width"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("objectives", "share", "node_limit", "noted"),
    [
        (TWO, 0.1, 5000, False),
        (TWO, 0.1, 10_000, True),
        (TWO, 0.3, 3500, True),
        (NARROW, 1e-6, 1000, True),
        (THREE, 0.8, 2000, False),
    ],
)
def test_what_a_tree_that_does_not_end_has_covered_at_the_gap_is_noted(
    objectives: list[str], share: float, node_limit: int, noted: bool
) -> None:
    state = state_of(objectives=objectives, gap=0.05)
    tolerance = share * state.rule.tolerance
    outcome = cover_everything(state, state.cover_within(tolerance), node_limit)
    cover = state.proof.finest_cover
    assert not outcome.closed
    assert (cover is not None) == noted
    if cover is not None:
        assert np.all((tolerance < cover.tolerance) & (cover.tolerance <= state.rule.tolerance))
        assert covered(state, everything(state), cover.tolerance + 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("objectives", [TWO, NARROW, THREE])
@pytest.mark.parametrize("share", [1e-6, 0.1, 0.5, 1.0])
def test_what_is_noted_of_a_tree_is_true_of_every_design(objectives: list[str], share: float) -> None:
    for node_limit in (0, 100, 1000, 4000, 8000, 13_000):
        state = state_of(objectives=objectives, gap=0.05)
        outcome = cover_everything(state, state.cover_within(share * state.rule.tolerance), node_limit)
        cover = state.proof.finest_cover
        assert cover is not None or not outcome.closed
        assert cover is None or covered(state, everything(state), cover.tolerance + 1e-12)


def test_a_second_look_goes_on_with_what_the_first_has_left_open() -> None:
    state = state_of(points=500, gap=1e-2, limits={"length": "<= 160 mm"})
    find_designs(state)
    before, known = state.counters.nodes, state.form.archive.phi
    _search_further(state)
    first, left = state.counters.nodes - before, state.open_at_ties
    assert left is not None
    assert state.proof.finest_cover is not None
    assert len(state.form.archive.phi) >= len(known)
    before = state.counters.nodes
    _search_further(state)
    second = state.counters.nodes - before
    assert second < first
    assert second <= 4 * len(left)
    assert covered(state, everything(state), state.proof.finest_cover.tolerance + 1e-12)


def test_the_finest_cover_is_kept() -> None:
    state = state_of()
    fine, coarse = (state.cover_within(share * state.rule.tolerance) for share in (0.1, 0.9))
    for cover in (coarse, fine, coarse):
        state.proof.note_cover(cover)
    assert state.proof.finest_cover is fine
    assert len(state.proof.bounds) == 4  # with that of the box of everything


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(repetitions(3, 12)))
def test_what_is_covered_spares_the_search_for_the_first_place_and_changes_nothing_of_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    load, weights = f"{rng.uniform(2, 60):.3g} kN", rng.uniform(0.2, 3.0, 2).tolist()
    found = []
    for forget in (False, True):
        asked = pose(Strut(), {"load": load}, ["mass", "width"], catalogs={"rods": RODS}, points=50, gap=1e-3)
        state = FrontState(asked.search().state.task)
        state.set_pool()
        find_designs(state)
        choose_designs(state)
        if forget:
            state.proof.finest_cover = None
        before = state.counters.scalar_problems, state.form.counters.contracted
        find_first(state, weights)
        assert (state.counters.scalar_problems > before[0]) == forget
        assert (state.form.counters.contracted > before[1]) == forget
        assert state.scored is not None
        phi = state.form.archive.phi[:, :2]
        assert np.all(non_dominated(phi))
        found.append((state.scored, phi[state.scored.best(phi)]))
    (one, first), (other, second) = found
    np.testing.assert_allclose(one.scale.ideal, other.scale.ideal, rtol=2e-4)
    np.testing.assert_allclose(one.scale.nadir, other.scale.nadir, rtol=2e-4)
    np.testing.assert_allclose(first, second, atol=2e-4)
