"""The choice of columns against trying all of them, and what its bounds claim."""

from __future__ import annotations

import itertools
import time

import numpy as np
import pytest

from synth.variants.p_median import Chooser, _not_dominated
from tests.waiting import PATIENCE


def cheapest(costs: np.ndarray, weights: np.ndarray, number: int) -> float:
    """Return the least cost of so many columns, by trying all choices."""
    return min(
        float(weights @ costs[:, list(columns)].min(axis=1))
        for columns in itertools.combinations(range(costs.shape[1]), number)
    )


def soon() -> float:
    return time.monotonic() + PATIENCE


@pytest.mark.parametrize("seed", range(12))
def test_the_choice_is_the_best_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = rng.integers(3, 10), rng.integers(3, 9)
    costs = np.round(10 * rng.random(shape), 1)
    costs[rng.random(shape) < 0.5] = np.inf
    costs[np.arange(shape[0]), rng.integers(0, shape[1], shape[0])] = 3.0
    weights = rng.integers(1, 4, shape[0]).astype(float)
    chooser = Chooser(costs, weights, 1e-6)
    fewest, bound = chooser.fewest(soon())
    least = next(k for k in range(1, shape[1] + 1) if np.isfinite(cheapest(costs, weights, k)))
    assert len(fewest) == bound == least
    for number in range(least, shape[1] + 1):
        choice = chooser.best(number, soon(), fewest)
        best = cheapest(costs, weights, number)
        assert choice.cost == pytest.approx(best, abs=1e-6)
        assert choice.bound <= best + 1e-6
        assert choice.gap <= 1e-5
        assert len(choice.columns) <= number
        assert float(weights @ costs[:, list(choice.columns)].min(axis=1)) == pytest.approx(choice.cost)


@pytest.mark.parametrize("number", [3, 6, 15])
def test_bounds_hold_where_no_column_dominates_another(number: int) -> None:
    rng = np.random.default_rng(4)
    rows, columns = rng.random((60, 2)), rng.random((25, 2))
    costs = np.hypot(*(rows[:, None] - columns[None]).transpose(2, 0, 1))
    chooser = Chooser(costs, np.ones(60), 1e-4)
    assert chooser.columns == 25
    exact = chooser.best(number, soon())
    assert exact.gap <= 1e-4
    quick = Chooser(costs, np.ones(60), 1e-4).best(number, soon(), exact=False)
    stopped = Chooser(costs, np.ones(60), 1e-9).best(number, time.monotonic())
    for other in (quick, stopped):
        assert other.bound <= exact.cost + 1e-9
        assert other.cost >= exact.bound - 1e-9
    # No exchange of one column improves it, and many random choices do not either.
    chosen = list(exact.columns)
    others = [k for k in range(25) if k not in chosen]
    for out, into in itertools.product(range(number), others):
        changed = chosen[:out] + chosen[out + 1 :] + [into]
        assert costs[:, changed].min(axis=1).sum() >= exact.bound - 1e-9
    for _ in range(300):
        assert costs[:, rng.choice(25, number, replace=False)].min(axis=1).sum() >= exact.bound - 1e-9


def test_columns_that_others_replace_are_left_out() -> None:
    inf = np.inf
    costs = np.array([[1.0, 2.0, 1.0, inf, 0.0], [1.0, 1.0, 1.0, 0.5, inf]])
    assert list(_not_dominated(costs)) == [0, 3, 4]
    chooser = Chooser(costs, np.ones(2), 0.0)
    assert chooser.best(1, soon()).columns == (0,)
    assert chooser.best(2, soon()).columns == (3, 4)
    assert chooser.best(5, soon()).cost == 0.5


def test_rows_that_cost_the_same_count_together() -> None:
    costs = np.array([[0.0, 5.0], [0.0, 5.0], [9.0, 0.0]])
    chooser = Chooser(costs, np.array([1.0, 1.0, 1.0]), 0.0)
    assert chooser.rows == 2
    assert chooser.best(1, soon()).columns == (0,)
    assert Chooser(costs, np.array([1.0, 0.0, 1.0]), 0.0).best(1, soon()).columns == (1,)
