"""Ranges of variables: what limits and pins leave, and the makeable values in it."""

import pytest

from synth import DesignProblem
from synth.errors import InputError
from synth.question.variable_ranges import VariableRanges
from synth.tables.catalogs import Catalogs


class Plate(DesignProblem):
    name, title = "plate", "Plate"
    sources = ("test",)

    def declare(self, d):
        d.variable("width", "mm", 10, 50, grid=10, symbol="b", text="Width")
        d.variable("length", "mm", 100, 900, symbol="l", text="Length")
        d.objective("width", "min")


MODEL = Plate().model(frozenset(), Catalogs({}))


def ranges(grid=True):
    return VariableRanges(MODEL.variables, grid)


def test_limits_narrow_and_never_widen():
    own = ranges()
    for sense, bound in (("at_most", 0.04), ("at_most", 0.09), ("at_least", 0.02), ("at_least", 0.001)):
        own.bound(MODEL.constraint_on("width", sense, bound))
    assert (own.lower.tolist(), own.upper.tolist()) == ([0.02, 0.1], [0.04, 0.9])
    assert [g.tolist() for g in own.grids()] == [pytest.approx([0.02, 0.03, 0.04]), []]
    with pytest.raises(InputError, match="limits that leave something of 10 mm to 50 mm"):
        own.bound(MODEL.constraint_on("width", "at_least", 0.06))


def test_a_pin_is_one_value_makeable_or_not():
    own = ranges()
    own.pin("width", "25 mm", 0.025)
    own.pin("mass", "1 kg", 1.0)  # no variable
    assert (own.lower[0], own.upper[0], own.pinned.tolist()) == (0.025, 0.025, [True, False])
    assert not len(own.grids()[0])
    with pytest.raises(InputError, match="10 mm to 50 mm"):
        own.pin("width", "60 mm", 0.06)


def test_a_range_between_two_makeable_values_is_refused_where_they_are_asked_for():
    own, free = ranges(), ranges(grid=False)
    for some in (own, free):
        some.bound(MODEL.constraint_on("width", "at_least", 0.021))
        some.bound(MODEL.constraint_on("width", "at_most", 0.029))
    assert not len(free.grids()[0])
    with pytest.raises(InputError, match="makeable value"):
        own.grids()
