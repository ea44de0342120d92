"""What families say of their quantities: works, symbols and words, and calculations that read like a textbook."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import synth
from synth.analysis.calculation import calculation_of
from synth.question.instance import Instance
from synth.results.calculation import Calculation
from synth.results.dimensions import constant_in, dimension_of
from synth.results.expression import Expression, names_in, parts_of
from synth.testing.properties import Properties
from synth.testing.records import cases_of, question
from synth.units import parse_unit

of_texts, of_a_calculation = Properties(), Properties()

RECORDS = (
    *("requirements", "options", "variables", "counts", "choices", "slots"),
    *("derived", "steps", "constants", "next_rows", "limits"),
)
NO_WORK = {"Delta"}  # of a source that is cited by its own symbols
WORK = re.compile(r"\bS\d\b(?= \()|\b(?:CGPM|DIN|EN|ISO) \d+|(?<![\w.])flott|\b[A-Z][a-z]{3,}\b")
NAME = re.compile(r"(?<![\w.])(?<!table )[a-z]{2,}\d*(?:_[a-z0-9]+)+(?!\w)")
SYMBOL = re.compile(r"(?<![\w.])[A-Za-z]\w*_\w+")


@cache
def structures(family: str) -> list[Instance]:
    """All option sets, with and without optional requirements."""
    return [
        question(family, options, optional=optional)
        for options in cases_of(family).option_sets.values()
        for optional in (False, True)
    ]


def told(family: str) -> Iterator[tuple[str, str, str]]:
    """Name, text and source of every record; choices of an option stand in its text as they are typed."""
    for posed in structures(family):
        d = posed.model.declaration
        for kind in RECORDS:
            for name, record in getattr(d, kind).items():
                typed = record.choices if kind == "options" else ()
                yield name, re.sub("|".join(map(re.escape, typed)) or "$^", "", record.text), record.source
        for advice in d.advices:
            yield advice.code, advice.message, advice.source


def works(source: str) -> set[str]:
    """Works that a source names."""
    return set(WORK.findall(source)) - NO_WORK


@of_texts
def every_work_that_is_cited_is_listed(family: str) -> None:
    listed = "\n".join(synth.load(family).sources)
    assert {(name, work) for name, _, source in told(family) for work in works(source) if work not in listed} == set()


@of_texts
def texts_are_words(family: str) -> None:
    assert {text for _, text, source in told(family) if "**" in text + source} == set()
    assert {(name, word) for name, text, _ in told(family) for word in NAME.findall(text)} == set()
    assert {name for name, _, source in told(family) if NAME.search(source)} == set()


def used(calculation: Calculation, name: str) -> set[str]:
    """Symbols of a quantity and of its formula."""
    quantity = calculation.quantities[name]
    tree = quantity.expression
    inputs = set() if tree is None else set(names_in(tree))
    return {calculation.quantities[other].symbol for other in {name} | inputs}


@of_texts
def every_symbol_of_a_text_is_one_of_its_formula(family: str) -> None:
    wrong = set()
    for posed in structures(family):
        calculation = calculation_of(posed)
        for name, quantity in calculation.quantities.items():
            words = set(SYMBOL.findall(quantity.text or "")) - set(NAME.findall(quantity.text or ""))
            wrong |= {(name, word) for word in words - used(calculation, name)}
    assert wrong == set()


# -- calculations ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Calculated:
    """A family and the calculation of one of its option sets."""

    family: str
    calculation: Calculation


def formulas(calculation: Calculation) -> dict[str, Any]:
    """All formulas of a calculation, by name."""
    found = {q.name: q.expression for q in calculation.quantities.values() if q.computed}
    for x in calculation.limits:
        found |= {f"limit {x.name}, value": x.value, f"limit {x.name}, limit": x.limit}
    return found


def dimension_in(unit: str) -> tuple[Any, ...]:
    """Exponents of a unit."""
    return parse_unit(unit).dimension


def numbers_in(tree: Expression) -> Iterator[Any]:
    """Numbers of a formula."""
    if tree[0] == "n":
        yield tree[1]
    for part in parts_of(tree):
        yield from numbers_in(part)


@of_a_calculation
def every_part_of_a_formula_has_a_name(calculated: Calculated) -> None:
    calculation = calculated.calculation
    assert [name for name, q in calculation.quantities.items() if q.kind == "helper"] == []


@of_a_calculation
def units_close_except_where_a_formula_is_one_for_si(calculated: Calculated) -> None:
    family, calculation = calculated.family, calculated.calculation
    still_open = {
        name for name, tree in formulas(calculation).items() if dimension_of(tree, calculation.quantities) is None
    }
    assert still_open <= cases_of(family).for_si


@of_a_calculation
def formulas_have_the_unit_of_what_they_compute(calculated: Calculated) -> None:
    calculation = calculated.calculation
    for q in calculation.quantities.values():
        dimension = dimension_of(q.expression, calculation.quantities) if q.expression and q.computed else None
        # What comes to a number, as 0 without an actuator, has any unit.
        if dimension is not None and any(dimension):
            assert dimension == dimension_in(q.unit), q.name
    for x in calculation.limits:
        for side in (x.value, x.limit):
            dimension = dimension_of(side, calculation.quantities)
            if dimension is not None and any(dimension):
                assert dimension == dimension_in(x.unit), x.name


@of_a_calculation
def every_constant_stands_in_a_formula(calculated: Calculated) -> None:
    calculation = calculated.calculation
    constants = [q for q in calculation.quantities.values() if q.kind == "constant"]
    trees = [*formulas(calculation).values(), *(x.condition for x in calculation.remarks)]
    folds = [constant_in(number, constants) for tree in trees for number in numbers_in(tree)]
    assert {c.name for c in constants} == {fold.constant for fold in folds if fold is not None}
