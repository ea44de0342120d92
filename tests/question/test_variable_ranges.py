"""Ranges of variables: what limits and pins leave, and the makeable values in it."""

import pytest

from synth import DesignProblem
from synth.errors import DeclarationError, InputError
from synth.question.variable_ranges import VariableRanges
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of


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


class Rod(DesignProblem):
    name, title = "rod", "Rod"
    sources = ("test",)

    def declare(self, d):
        force = d.requirement("force", "N", lower=1, upper=1e9, symbol="F", text="Pull")
        size = (force / 1e6) ** 0.5
        d.variable("diameter", "mm", 1, 5000, grid=1, symbol="b", text="Diameter", within=(0.4 * size, 3 * size))
        d.objective("diameter", "min")


@pytest.mark.parametrize(
    ("force", "low", "high"),
    [("1e4 N", 2**-5, 2**-1), ("1.2e4 N", 2**-5, 2**-1), ("1 N", 0.001, 2**-8), ("1e8 N", 4.0, 5.0)],
)
def test_a_range_made_of_requirements_is_rounded_outwards_inside_the_bounds(force, low, high):
    found = instance_of(Rod(), {"force": force}, Catalogs({})).ranges
    assert (found.lower[0], found.upper[0]) == (low, high)


@pytest.mark.parametrize(
    ("limits", "fix", "low", "high"),
    [
        ({"diameter": "<= 100 mm"}, {}, 2**-5, 0.1),
        ({"diameter": "<= 20 mm"}, {}, 0.001, 0.02),
        ({"diameter": ">= 2 m"}, {}, 2.0, 5.0),
        ({"diameter": ["<= 900 mm", ">= 800 mm"]}, {}, 0.8, 0.9),
        ({}, {"diameter": "3 m"}, 3.0, 3.0),
    ],
)
def test_what_is_asked_counts_beside_a_range_made_of_requirements(limits, fix, low, high):
    found = instance_of(Rod(), {"force": "1e4 N"}, Catalogs({}), limits=limits, fix=fix).ranges
    assert (found.lower[0], found.upper[0]) == (low, high)


def test_a_range_of_what_is_searched_is_refused():
    class Wrong(Rod):
        name = "wrong"

        def declare(self, d):
            super().declare(d)
            d.variable("length", "mm", 1, 10, within=(0.5 * self_of(d), 5))

    def self_of(d):
        return d.variables["diameter"].sx

    with pytest.raises(DeclarationError, match="the range of variable length depends on diameter"):
        Wrong().model(frozenset({"force"}), Catalogs({}))
