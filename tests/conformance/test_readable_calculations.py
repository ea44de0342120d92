"""The calculation of every family reads like a textbook: parts have names, units close, constants are told."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

import synth
from synth.analysis.calculation import calculation_of
from synth.results.dimensions import constant_in, dimension_of
from synth.results.expression import Expression, parts_of
from synth.units import parse_unit
from tests.conformance.cases import CASES, question
from tests.properties import Properties

pytestmark = pytest.mark.slow
of_a_calculation = Properties()

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
STRUCTURES = [(f, s) for f, data in CASES.items() for s in data.option_sets]
# Formulas that hold in SI alone: coefficients of powers that are not whole.
FOR_SI: dict[str, set[str]] = {
    "magnetic_powder_clutch": {"moving_heat_transfer"},  # h_still + h_rot v**0.8, with v in m/s
}


ASKED = [(f, s, optional) for f, s in STRUCTURES for optional in (True, False)]


@pytest.fixture(scope="module", params=ASKED, ids=lambda p: f"{p[0]}-{p[1]}{'' if p[2] else '-bare'}")
def told(request):
    """Return a family and the calculation of one of its structures, with and without optional requirements."""
    family, structure, optional = request.param
    return family, calculation_of(question(family, CASES[family].option_sets[structure], optional=optional))


def formulas(calculation):
    """Return all formulas of a calculation, by name."""
    found = {q.name: q.expression for q in calculation.quantities.values() if q.computed}
    for x in calculation.limits:
        found |= {f"limit {x.name}, value": x.value, f"limit {x.name}, limit": x.limit}
    return found


def numbers_in(tree: Expression):
    if tree[0] == "n":
        yield tree[1]
    for part in parts_of(tree):
        yield from numbers_in(part)


@of_a_calculation
def every_part_of_a_formula_has_a_name(told):
    _, calculation = told
    assert [name for name, q in calculation.quantities.items() if q.kind == "helper"] == []


@of_a_calculation
def units_close_except_where_a_formula_is_one_for_si(told):
    family, calculation = told
    still_open = {
        name for name, tree in formulas(calculation).items() if dimension_of(tree, calculation.quantities) is None
    }
    assert still_open <= FOR_SI.get(family, set())


def test_few_formulas_are_for_si_alone():
    assert len(set().union(*FOR_SI.values())) <= 5


@of_a_calculation
def formulas_have_the_unit_of_what_they_compute(told):
    _, calculation = told
    for q in calculation.quantities.values():
        dimension = dimension_of(q.expression, calculation.quantities) if q.computed else None
        # What comes to a number, as 0 without an actuator, has any unit.
        if dimension is not None and any(dimension):
            assert dimension == parse_unit(q.unit).dimension, q.name
    for x in calculation.limits:
        for side in (x.value, x.limit):
            dimension = dimension_of(side, calculation.quantities)
            if dimension is not None and any(dimension):
                assert dimension == parse_unit(x.unit).dimension, x.name


@of_a_calculation
def every_constant_stands_in_a_formula(told):
    _, calculation = told
    constants = [q for q in calculation.quantities.values() if q.kind == "constant"]
    trees = [*formulas(calculation).values(), *(x.condition for x in calculation.remarks)]
    folds = [constant_in(number, constants) for tree in trees for number in numbers_in(tree)]
    assert {c.name for c in constants} == {fold.constant for fold in folds if fold is not None}


def test_a_calculation_keeps_every_property(told):
    assert of_a_calculation.broken(told) == []


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda p: p.stem)
def test_examples_are_told_in_full(path):
    content = yaml.safe_load(path.read_text())
    problem = synth.load(content["family"], **content.get("options", {}))
    calculation = synth.calculation(problem, content["requirements"])
    assert [q.name for q in calculation.quantities.values() if q.kind == "helper"] == []
