"""What families say of their quantities: works that they list, symbols of their own formulas, and words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest

import synth
from synth.analysis.calculation import calculation_of
from synth.results.calculation import Calculation
from synth.results.expression import names_in
from tests.conformance.cases import CASES, question

pytestmark = pytest.mark.slow

RECORDS = (
    *("requirements", "options", "variables", "counts", "choices", "slots"),
    *("derived", "steps", "constants", "next_rows", "limits"),
)
NO_WORK = {"Delta"}  # of a source that is cited by its own symbols
WORK = re.compile(r"\bS\d\b(?= \()|\b(?:CGPM|DIN|EN|ISO) \d+|(?<![\w.])flott|\b[A-Z][a-z]{3,}\b")
NAME = re.compile(r"(?<![\w.])(?<!table )[a-z]{2,}\d*(?:_[a-z0-9]+)+(?!\w)")
SYMBOL = re.compile(r"(?<![\w.])[A-Za-z]\w*_\w+")


@cache
def structures(family: str) -> list[Any]:
    return [
        question(family, options, optional=optional)
        for options in CASES[family].option_sets.values()
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
    return set(WORK.findall(source)) - NO_WORK


def test_works_are_seen() -> None:
    assert works("S0 (Szoke 1966), eq. (5)") == {"S0", "Szoke"}
    assert works("DIN 743-2, from memory; practice") == {"DIN 743"}
    assert works("geometry; table metals, C45") == works("S4, Delta r") == set()


@pytest.mark.parametrize("family", CASES)
def test_every_work_that_is_cited_is_listed(family: str) -> None:
    listed = "\n".join(synth.load(family).sources)
    assert {(name, work) for name, _, source in told(family) for work in works(source) if work not in listed} == set()


@pytest.mark.parametrize("family", CASES)
def test_texts_are_words(family: str) -> None:
    assert {text for _, text, source in told(family) if "**" in text + source} == set()
    assert {(name, word) for name, text, _ in told(family) for word in NAME.findall(text)} == set()
    assert {name for name, _, source in told(family) if NAME.search(source)} == set()


def used(calculation: Calculation, name: str) -> set[str]:
    """Symbols of a quantity and of its formula."""
    quantity = calculation.quantities[name]
    tree = quantity.expression
    inputs = set() if tree is None else set(names_in(tree))
    return {calculation.quantities[other].symbol for other in {name} | inputs}


@pytest.mark.parametrize("family", CASES)
def test_every_symbol_of_a_text_is_one_of_its_formula(family: str) -> None:
    wrong = set()
    for posed in structures(family):
        calculation = calculation_of(posed)
        for name, quantity in calculation.quantities.items():
            words = set(SYMBOL.findall(quantity.text or "")) - set(NAME.findall(quantity.text or ""))
            wrong |= {(name, word) for word in words - used(calculation, name)}
    assert wrong == set()


# The formulas of torque and pressure are those of the family: a pack with friction in its guides, discs, a cone.
OWN = {
    "disc_clutch": ("S1 (lecture on friction clutches), sizing", "S1 (lecture on friction clutches), p"),
    "cone_clutch": ("S1 (lecture on friction clutches), cone clutch; formula lost in print, derived",) * 2,
}


@pytest.mark.parametrize("family", ["disc_clutch", "cone_clutch", "multi_plate_clutch", "electromagnetic_clutch"])
def test_the_main_result_cites_its_own_formula(family: str) -> None:
    for posed in structures(family):
        d = posed.model.declaration
        if family in OWN:
            right = OWN[family]
        elif "guide_model" in d.options and d.options["guide_model"].chosen == "series":
            right = ("S0 (Szoke 1966), eq. (5)", "S0 (Szoke 1966), eq. (3)")
        else:
            right = OWN["disc_clutch"]
        assert (d.derived["torque"].source, d.derived["surface_pressure"].source) == right
        assert "S0" not in d.limits["torque_capacity"].source
