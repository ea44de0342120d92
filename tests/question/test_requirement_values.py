"""Values of requirements: moved ones take with them what is made of them."""

import pytest

from synth import DesignProblem
from synth.errors import InputError
from synth.question.requirement_values import RequirementValues
from synth.tables.catalogs import Catalogs

NONE = Catalogs({})


class Beam(DesignProblem):
    name, title = "beam", "Beam"
    sources = ("test",)

    def declare(self, d):
        load = d.requirement("load", "kN", lower=1, upper=100, symbol="F", text="Load")
        peak = d.requirement("peak", "kN", default=2 * load, lower=1, upper=100, symbol="P", text="Peak load")
        d.requirement("room", "mm", optional=True, lower=1, upper=900, symbol="r", text="Room")
        width = d.variable("width", "mm", 1, 100, symbol="b", text="Width")
        d.at_most("stress", peak / width**2, 1e9, "N/mm2", source="test")
        d.objective("width", "min")


def read(asked):
    model = Beam().model(frozenset(asked), NONE)
    return model, RequirementValues.read(model, NONE, asked)


def test_what_is_made_of_a_moved_requirement_moves_with_it_unless_it_was_given():
    model, values = read({"load": "5 kN"})
    assert values.requirements == {"load": 5e3, "peak": 10e3}
    assert (values.given, values.not_asked) == ({"load"}, ("room",))
    assert values.moved(model, "load", 7e3).requirements == {"load": 7e3, "peak": 14e3}
    assert values.requirements["load"] == 5e3  # what it was made of stays
    model, both = read({"load": "5 kN", "peak": "6 kN"})
    assert both.moved(model, "load", 7e3).requirements == {"load": 7e3, "peak": 6e3}


def test_a_moved_default_counts_as_given():
    model, values = read({"load": "5 kN"})
    moved = values.moved(model, "peak", 20e3)
    assert moved.given == {"load", "peak"}
    assert moved.moved(model, "load", 8e3).requirements == {"load": 8e3, "peak": 20e3}
    assert moved.by_symbol(model) == {"load": 5e3, "peak": 20e3}


def test_nothing_moves_out_of_its_range():
    model, values = read({"load": "5 kN"})
    with pytest.raises(InputError, match="requirement load"):
        values.moved(model, "load", 200e3)
