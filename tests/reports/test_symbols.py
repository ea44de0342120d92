"""All symbols of all families and tables, as people see them: compared with a list that was looked at."""

from __future__ import annotations

import csv
from functools import cache
from pathlib import Path

import pytest
from synth.reports.formula.symbols import symbol_parts

from synth.analysis.calculation import calculation_of
from tests.conformance.cases import CASES, question

pytestmark = pytest.mark.slow
LIST = Path(__file__).with_name("symbols.csv")


@cache
def symbols():
    found = set()
    for family, data in CASES.items():
        for options in data.option_sets.values():
            for optional in (False, True):
                calculation = calculation_of(question(family, options, optional=optional))
                found |= {q.symbol for q in calculation.quantities.values()}
    return sorted(found)


def shown(symbol):
    parts = symbol_parts(symbol)
    style = "italic" if parts.italic else "upright"
    return ("Δ" if parts.difference else "") + parts.base, ",".join(parts.subscripts), style


def test_every_symbol_is_typeset_as_it_was_looked_at():
    with LIST.open(encoding="utf-8") as file:
        known = {row["symbol"]: (row["base"], row["below"], row["style"]) for row in csv.DictReader(file)}
    known |= {symbol: seen for cases in CASES.values() for symbol, seen in cases.symbols.items()}
    found = {symbol: shown(symbol) for symbol in symbols()}
    assert found == known


def test_no_two_symbols_look_alike():
    seen = {}
    for symbol in symbols():
        seen.setdefault(shown(symbol), []).append(symbol)
    # One quantity may be spelled in two ways in two families, never two in one; a family's own are told apart.
    assert {k: v for k, v in seen.items() if len(v) > 1} == {}
