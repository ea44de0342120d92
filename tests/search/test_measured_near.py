"""Objectives that may be zero, over wide boxes: never proven more coarsely than the gap that is told."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import least_squares

import synth
from synth import DesignProblem

POINTS = [(-5, 127), (-3, 151), (-1, 379), (5, 421), (3, 460), (1, 426)]


def problem(declared):
    class Own(DesignProblem):
        """A problem of one's own."""

        name, title, sources = "own", "Own problem", ("none",)

        def declare(self, d):
            declared(d)

    return Own


def honest(front, name, lower_bound):
    """True if what the certificate says of a design holds for a lower bound of the objective that is known."""
    value, gap = front.designs[0].objectives[name], front.certificate.gap
    if gap is None:
        return True
    amount = front.certificate.resolution.get(name, gap * abs(value))
    return value - amount <= lower_bound and amount <= 1.01 * gap * abs(value)


def test_a_gear_train_is_as_good_as_can_be():
    def declared(d):
        a, b, c, e = (d.count(k, 12, 60) for k in "abcd")
        d.derive("miss", "-", (1 / 6.931 - a * b / (c * e)) ** 2)
        d.objective("miss", "min")

    front = synth.synthesize(problem(declared), {})
    teeth = np.arange(12, 61, dtype=float)
    products = np.unique(np.outer(teeth, teeth))
    best = float(np.min((1 / 6.931 - products[:, None] / products[None, :]) ** 2))
    assert front.certificate.kind == "global"
    assert front.designs[0].objectives["miss"] == pytest.approx(best, rel=1e-6)
    assert honest(front, "miss", best)


@pytest.mark.slow
@pytest.mark.parametrize("width", [10.0, 1e3, 1e5])
@pytest.mark.parametrize("seed", range(3))
def test_sums_of_squares_over_wide_boxes_are_polished_and_proven_to_what_is_told(width, seed):
    rng = np.random.default_rng(seed)
    matrix, right = rng.normal(size=(4, 2)), rng.normal(size=4)

    def declared(d):
        x = [d.variable(k, "-", -width, width) for k in "xy"]
        d.derive("error", "-", sum((right[i] - matrix[i, 0] * x[0] - matrix[i, 1] * x[1]) ** 2 for i in range(4)))
        d.objective("error", "min")

    front = synth.synthesize(problem(declared), {}, time_limit=60)
    best = 2 * least_squares(lambda x: right - matrix @ x, np.zeros(2)).cost
    assert front.designs[0].objectives["error"] == pytest.approx(best, rel=1e-3)
    assert honest(front, "error", best)
    assert front.certificate.kind == "global"


def test_a_sum_of_squares_that_can_vanish_is_found_and_nothing_more_is_claimed():
    def declared(d):
        x, y, z = d.variable("x", "-", 0.1, 20), d.variable("y", "-", 0.1, 20), d.variable("z", "-", 1, 100)
        d.at_least("wide", z * x, 30, "-")
        d.derive("error", "-", ((x * y - 7) ** 2 + (x - ca.sqrt(y)) ** 2) * z**6)
        d.objective("error", "min")

    front = synth.synthesize(problem(declared), {}, time_limit=60)
    assert front.designs[0].objectives["error"] < 1e-9
    assert honest(front, "error", 0.0)


def test_of_two_objectives_both_ends_are_as_fine_as_the_front():
    def declared(d):
        x, y = d.variable("x", "-", -1e5, 1e5), d.variable("y", "-", -1e5, 1e5)
        d.derive("f", "-", (x - 3) ** 2 + (y - 1) ** 2)
        d.derive("g", "-", (x - 4) ** 2 + (y + 1) ** 2)
        d.objective("f", "min")
        d.objective("g", "min")

    front = synth.synthesize(problem(declared), {}, points=5)
    assert front.certificate.kind == "global"
    assert len(front.designs) == 5
    for name in "fg":
        # From 0 to 5 on the front, whatever the box is.
        assert front.certificate.resolution[name] <= 0.0051
        assert min(d.objectives[name] for d in front.designs) < 1e-3
    assert synth.verify(front, problem(declared)).holds


def test_a_constant_that_is_added_changes_the_share_and_not_the_design():
    def declared(d):
        x = d.variable("x", "-", -1e4, 1e4)
        d.derive("f", "-", (x - 2) ** 4 - 100)
        d.objective("f", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.certificate.kind == "global"
    assert front.designs[0].objectives["f"] == pytest.approx(-100, rel=1e-3)
    assert honest(front, "f", -100)


@pytest.mark.parametrize("second", [None, lambda x, y: 3 * y + x])
def test_a_design_at_zero_gives_nothing_away_to_what_was_not_asked(second):
    def declared(d):
        x, y = d.variable("x", "-", -3, 3), d.variable("y", "-", 1, 2)
        d.derive("miss", "-", x * x * (1 + y))
        d.objective("miss", "min")
        if second is not None:
            d.derive("size", "-", second(x, y))
            d.objective("size", default=False)

    front = synth.synthesize(problem(declared), {}, objectives=["miss"])
    assert honest(front, "miss", 0.0)
    assert synth.verify(front, problem(declared)).findings == ()
