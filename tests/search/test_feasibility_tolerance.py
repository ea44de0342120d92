"""What is feasible by the tolerance of limits alone stands only where nothing keeps them more closely."""

import math

import pandas as pd
import pytest

import synth
from synth.order.feasibility import TOLERANCE

CLOSE = 1e-8


class Corner(synth.DesignProblem):
    """An area from below and a sum from above, which leave one point or, by a share, nothing."""

    name = "corner"

    def __init__(self, short):
        self.short = short
        super().__init__()

    def declare(self, d):
        x, y = d.variable("x", "-", 1, 10), d.variable("y", "-", 1, 10)
        d.at_least("area", x * y, 6 + 0 * x, "-")
        d.at_most("sum", x + y, 2 * math.sqrt(6) * (1 - self.short) + 0 * x, "-")
        d.derive("cost", "-", x + 3 * y)
        d.objective("cost")


def test_a_design_on_the_edge_is_feasible_and_no_other_is():
    front = synth.synthesize(Corner(3e-7), {})
    (design,) = front.designs
    assert CLOSE < max(design.residuals.values()) <= TOLERANCE
    assert (front.certificate.kind, front.verify().holds) == ("global", True)
    assert synth.synthesize(Corner(3e-6), {}).designs == []


def test_what_can_keep_the_limits_does():
    front = synth.synthesize(Corner(-1e-4), {})
    assert max(front.designs[0].residuals.values()) <= CLOSE


class Strip(synth.DesignProblem):
    """A length between two columns of a part."""

    name = "strip"

    def declare(self, d):
        x = d.variable("x", "-", 1, 10)
        part = d.part("part", "strips")
        d.at_least("need", x, part.need, "-")
        d.at_most("room", x, part.room, "-")
        for name in ("cost", "size"):
            d.derive(name, "-", x * getattr(part, name))
            d.objective(name)


def strips(cost):
    """Return a wide strip, and a narrow one that is met by the tolerance alone and costs a share of the other."""
    return pd.DataFrame(
        {
            "designation": ["wide", "narrow"],
            "need [-]": [3.0, 3.0],
            "room [-]": [4.0, 3.0 * (1 - 5e-7)],
            "cost [-]": [1.0, cost],
            "size [-]": [1.0, 1.0],
        }
    )


@pytest.mark.parametrize("objectives", [["cost"], ["cost", "size"]])
def test_the_edge_gains_nothing_by_the_tolerance(objectives):
    front = synth.synthesize(Strip(), {}, objectives, catalogs={"strips": strips(1 - 5e-7)})
    assert [str(d.parts["part"]) for d in front.designs] == ["wide"]
    assert max(front.designs[0].residuals.values()) <= CLOSE
    assert (front.complete, front.verify().holds) == (True, True)


@pytest.mark.parametrize("objectives", [["cost"], ["cost", "size"]])
def test_the_edge_wins_by_what_is_more_than_the_tolerance_is_worth(objectives):
    front = synth.synthesize(Strip(), {}, objectives, catalogs={"strips": strips(0.9)})
    assert [str(d.parts["part"]) for d in front.designs] == ["narrow"]
    assert front.verify().holds


def test_limits_of_ones_own_are_kept_closely_too():
    problem = Corner(-0.2)
    front = synth.synthesize(problem, {}, {"cost": "max"}, limits={"cost": "<= 13"})
    assert max(front.designs[0].residuals.values()) <= CLOSE
    pinned = synth.synthesize(problem, {}, {"cost": "max"}, fix={"x": 2.4, "y": 2.6}, limits={"cost": "<= 10.199995"})
    assert CLOSE < max(pinned.designs[0].residuals.values()) <= TOLERANCE
