"""Clusters of rows: a k-d tree over the rows of each factor, and the combinations that cells of clusters stand for."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.bounds.clusters import Cells, ClusterTree, Factor


def random_columns(rng):
    """Return rows of positive and signed columns, some rows equal, some values missing, some columns constant."""
    rows, width = int(rng.integers(1, 40)), int(rng.integers(1, 4))
    columns = np.where(
        rng.random(width) < 0.5, np.exp(rng.normal(0, 2, (rows, width))), rng.normal(0, 2, (rows, width))
    )
    columns[:, rng.random(width) < 0.2] = 3.0
    if rng.random() < 0.5:
        columns = np.round(columns, 1)
    columns[rng.random(columns.shape) < rng.choice([0.0, 0.2])] = np.nan
    return columns[rng.integers(rows, size=rows)]


def tree_of(columns, weights=None):
    inputs = tuple(range(columns.shape[1]))
    return ClusterTree(Factor("part", inputs, columns), np.ones(len(inputs)) if weights is None else weights)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=80)
def test_every_row_is_in_exactly_one_leaf_and_leaves_hold_equal_rows(seed):
    rng = np.random.default_rng(seed)
    columns = random_columns(rng)
    weights = rng.choice([0.0, 1.0, 5.0, np.nan], columns.shape[1])
    tree = tree_of(columns, weights)
    leaves = np.flatnonzero(tree.leaf)
    held = np.concatenate([tree.rows(int(k)) for k in leaves])
    assert sorted(held) == list(range(len(columns)))
    for k in leaves:
        rows = tree.rows(int(k))
        np.testing.assert_array_equal(tree.leaf_of_row[rows], k)
        np.testing.assert_array_equal(columns[rows], np.tile(columns[rows[0]], (len(rows), 1)))
    # As many leaves as there are different rows: equal ones are never told apart.
    assert len(leaves) == len({row.tobytes() for row in columns + 0.0})


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=80)
def test_halves_share_out_the_rows_of_a_cluster(seed):
    columns = random_columns(np.random.default_rng(seed))
    tree = tree_of(columns)
    assert sorted(tree.rows(0)) == list(range(len(columns)))
    for k in range(len(tree)):
        rows = tree.rows(k)
        assert tree.size[k] == len(rows) > 0
        assert tree.first[k] in rows
        assert tree.leaf[k] == (tree.left[k] < 0) == (tree.right[k] < 0)
        if not tree.leaf[k]:
            left, right = tree.rows(int(tree.left[k])), tree.rows(int(tree.right[k]))
            assert sorted([*left, *right]) == sorted(rows)
            assert len(left)
            assert len(right)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=80)
def test_hulls_are_the_least_and_largest_of_their_rows(seed):
    columns = random_columns(np.random.default_rng(seed))
    tree = tree_of(columns)
    values = np.stack([columns[:, 0] ** 2, columns.sum(axis=1)], axis=1)
    low, high = tree.hull(values)
    for k in range(len(tree)):
        # A row without a value makes all of its cluster unknown: NaN, as np.min gives.
        np.testing.assert_array_equal(low[k], values[tree.rows(k)].min(axis=0))
        np.testing.assert_array_equal(high[k], values[tree.rows(k)].max(axis=0))


def test_rows_without_a_value_are_kept_apart_first():
    columns = np.array([[1.0, 100.0], [2.0, np.nan], [30.0, 3.0], [4.0, np.nan], [5.0, 900.0]])
    tree = tree_of(columns, np.array([1.0, 0.0]))
    known, unknown = sorted(tree.rows(int(tree.left[0]))), sorted(tree.rows(int(tree.right[0])))
    assert (known, unknown) == ([0, 2, 4], [1, 3])
    low, high = tree.hull(columns)
    assert np.isnan(low[0, 1])
    assert (low[tree.left[0], 1], high[tree.left[0], 1]) == (3.0, 900.0)
    assert np.isnan(low[tree.right[0], 1])
    assert (low[tree.right[0], 0], high[tree.right[0], 0]) == (2.0, 4.0)


def test_the_column_that_matters_most_is_halved_first():
    columns = np.array([[1.0, 1.0], [1.0, 10.0], [100.0, 1.0], [100.0, 10.0]])
    for weights, sides in (((1.0, 1.0), [[0, 1], [2, 3]]), ((0.1, 1.0), [[0, 2], [1, 3]])):
        tree = tree_of(columns, np.array(weights))
        assert [sorted(tree.rows(int(side[0]))) for side in (tree.left, tree.right)] == sides


def test_a_factor_without_columns_is_one_leaf():
    tree = tree_of(np.empty((3, 0)))
    assert len(tree) == 1
    assert tree.leaf[0]
    assert tree.leaf_of_row.tolist() == [0, 0, 0]


# -- cells -------------------------------------------------------------------------------------------


@pytest.fixture
def cells():
    rng = np.random.default_rng(2)
    columns = [rng.uniform(1, 9, (5, 2)), np.array([[1.0], [2.0], [2.0]]), rng.uniform(1, 9, (4, 1))]
    trees = [tree_of(c) for c in columns]
    return Cells(trees, [5, 3, 4])


def all_cells(cells):
    return np.array(list(product(*(range(len(t)) for t in cells.trees))), dtype=np.int32)


def by_hand(cells, cell):
    rows = [sorted(t.rows(int(k))) for t, k in zip(cells.trees, cell, strict=True)]
    return [(a * 3 + b) * 4 + c for a, b, c in product(*rows)]


def test_members_are_the_combinations_of_the_rows(cells):
    every = all_cells(cells)
    sizes = cells.size(every)
    for cell, size in zip(every, sizes, strict=True):
        members = cells.members(cell, 1000).tolist()
        assert members == by_hand(cells, cell)
        assert len(members) == size
        for most in (1, 7):
            few = cells.members(cell, most)
            assert len(few) == min(most, len(members))
            assert set(few.tolist()) <= set(members)
    assert cells.members(cells.all_combinations()[0], 1000).tolist() == list(range(60))
    np.testing.assert_array_equal(cells.size(cells.all_combinations()), [60.0])


def test_numbers_and_leaves_go_round(cells):
    digits = [np.repeat(np.arange(5), 12), np.tile(np.repeat(np.arange(3), 4), 5), np.tile(np.arange(4), 15)]
    numbers = cells.numbers.composed(digits, 60)
    np.testing.assert_array_equal(numbers, np.arange(60))
    for k in range(60):
        leaf = cells.leaf_of([int(d[k]) for d in digits])
        assert cells.single(leaf).all()
        assert k in cells.members(leaf[0], 100)
        assert cells.combination(leaf)[0] in cells.members(leaf[0], 100)


def test_single_cells_hold_equal_combinations_only(cells):
    every = all_cells(cells)
    leaves = np.all([t.leaf[every[:, f]] for f, t in enumerate(cells.trees)], axis=0)
    np.testing.assert_array_equal(cells.single(every), leaves)
    # Every combination lies in exactly one single cell; rows 1 and 2 of the second factor are equal and share one.
    held = np.concatenate([cells.members(cell, 1000) for cell in every[leaves]])
    assert sorted(held) == list(range(60))
    assert leaves.sum() == 5 * 2 * 4


def test_members_of_several_cells_count_once(cells):
    every = all_cells(cells)
    some = every[[0, 3, 3, len(every) - 1]]
    expected = sorted(set().union(*(by_hand(cells, c) for c in some)))
    assert cells.all_members(some, 1000).tolist() == expected
    assert len(cells.all_members(some, 11)) == 11
    assert cells.all_members(some[:0], 5).tolist() == []


def test_random_leaves_stay_inside_their_cell_and_reach_all_of_it(cells):
    rng = np.random.default_rng(0)
    for cell in all_cells(cells)[::15]:
        leaves = cells.random_leaves(np.tile(cell, (1500, 1)), rng)
        assert cells.single(leaves).all()
        reached = {int(k) for leaf in np.unique(leaves, axis=0) for k in cells.members(leaf, 100)}
        assert reached == set(by_hand(cells, cell))


def test_sizes_beyond_whole_numbers_do_not_overflow():
    tree = tree_of(np.arange(1.0, 201.0)[:, None])
    cells = Cells([tree] * 12, [200] * 12)
    assert cells.size(cells.all_combinations())[0] == pytest.approx(200.0**12)
