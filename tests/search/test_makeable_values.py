"""Makeable values: what grids make of points and of ranges."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.search.makeable_values import MakeableValues

MARGINS = (1e-9, 1e-12)
NONE = np.empty(0)


def grids(*values):
    return MakeableValues([np.asarray(v, dtype=float) for v in values], MARGINS)


def random_grid(rng):
    return np.unique(np.round(rng.uniform(1, 9, int(rng.integers(1, 12))), 1))


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_points_move_to_the_nearest_value(seed):
    rng = np.random.default_rng(seed)
    grid = random_grid(rng)
    points = rng.uniform(0, 10, (40, 2))
    moved = grids(NONE, grid).nearest(points)
    np.testing.assert_array_equal(moved[:, 0], points[:, 0])
    assert np.isin(moved[:, 1], grid).all()
    distance = np.abs(points[:, 1, None] - grid).min(axis=1)
    np.testing.assert_allclose(np.abs(moved[:, 1] - points[:, 1]), distance, atol=1e-12)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=60)
def test_snapped_ranges_hold_the_same_values(seed):
    rng = np.random.default_rng(seed)
    grid = random_grid(rng)
    ends = np.sort(rng.uniform(0, 10, (40, 2)), axis=1)
    low, high = ends[:, :1].copy(), ends[:, 1:].copy()
    held = grids(grid).snap(low, high)
    for k, (first, last) in enumerate(ends):
        inside = grid[(grid >= first) & (grid <= last)]
        assert held[k] == bool(len(inside))
        if held[k]:
            assert (low[k, 0], high[k, 0]) == (inside[0], inside[-1])


def test_a_value_that_is_missed_by_rounding_alone_is_held():
    low, high = np.array([[2.0 * (1 + 1e-10)]]), np.array([[2.0 * (1 + 1e-10)]])
    assert grids([1, 2, 3]).snap(low, high).tolist() == [True]
    assert (low[0, 0], high[0, 0]) == (2.0, 2.0)


def test_ranges_are_halved_between_neighbours_or_by_ratio():
    made = grids(NONE, [1, 2, 3, 4, 5])
    variable, low, high = np.array([0, 0, 1, 1, 2]), np.array([1.0, -1, 1, 2, 4]), np.array([9.0, 1, 5, 3, 9])
    left, right = made.middle(variable, low, high)
    np.testing.assert_allclose(left, [3.0, 0.0, 3.0, 2.0, 6.0])  # the last is of an auxiliary variable
    np.testing.assert_allclose(right, [3.0, 0.0, 4.0, 3.0, 6.0])


def test_around_a_point_are_its_makeable_neighbours():
    rng = np.random.default_rng(0)
    values = grids([1.0, 2.0, 5.0], NONE, [10.0, 20.0])
    around = values.around(np.array([3.0, 0.7, 20.0]), 100, rng)
    assert around.tolist() == [[2.0, 0.7, 10.0], [2.0, 0.7, 20.0], [5.0, 0.7, 10.0], [5.0, 0.7, 20.0]]
    beyond = values.around(np.array([9.0, 0.7, 3.0]), 100, rng)
    assert beyond.tolist() == [[5.0, 0.7, 10.0]]
    assert len(values.around(np.array([3.0, 0.7, 15.0]), 2, rng)) == 2
