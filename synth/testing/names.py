"""Names, symbols, units, defaults and bounds of a family against the table of its public names.

Its column ``for`` names the options (``pack=disc``) with which a row stands, ``default`` where none of them is chosen;
a row without stands always.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pytest

from synth.model.model import Model
from synth.question.catalogs import as_catalogs
from synth.question.instance import Instance
from synth.testing.properties import Properties
from synth.testing.records import cases_of, question
from synth.text.row_cells import CODE_OF
from synth.units import from_si, parse_unit

GROUPS = {"duty", "envelope", "practice", "model", "material", "actuator"}
of_names = Properties()


def rows_of(family: str) -> list[dict[str, str]]:
    """Rows of the table of a family."""
    return list(csv.DictReader(cases_of(family).names.read_text(encoding="utf-8").splitlines()))


def structures(family: str) -> list[str]:
    """``default``, and each option with a value that changes names, as the table has them."""
    return ["default", *sorted({key for row in rows_of(family) for key in row["for"].split(";")} - {"", "default"})]


def chosen(structure: str) -> dict[str, str]:
    """Option of a structure."""
    return {} if structure == "default" else dict([structure.split("=")])


def with_structure(family: str, structure: str) -> list[Mapping[str, str]]:
    """Option sets with the option of one structure and with none of another."""
    others = [chosen(other).items() for other in structures(family) if other != structure]
    kept = [
        options
        for options in cases_of(family).option_sets.values()
        if chosen(structure).items() <= options.items() and not any(o and o <= options.items() for o in others)
    ]
    assert kept
    return kept


@dataclass(frozen=True)
class Named:
    """Models of a structure with all optional requirements, its rows, and the question without, for defaults."""

    plain: Instance
    rows: list[dict[str, str]]
    models: Sequence[Model]


def named(family: str, structure: str) -> Named:
    """Models and rows of a structure."""
    models = [question(family, options, optional=True).model for options in with_structure(family, structure)]
    rows = [row for row in rows_of(family) if not row["for"] or structure in row["for"].split(";")]
    return Named(question(family, chosen(structure), optional=False), rows, models)


def numbers(text: str) -> float | None:
    """Number of a cell."""
    return float(text) if text else None


@of_names
def requirements(named: Named) -> None:
    plain, rows = named.plain, named.rows
    wanted = {r["name"]: r for r in rows if r["kind"] in ("req", "opt")}
    declared = plain.model.declaration.requirements
    assert set(declared) == set(wanted)
    for name, row in wanted.items():
        r = declared[name]
        assert (r.symbol, r.unit, r.optional) == (row["symbol"], row["unit"], row["kind"] == "opt"), name
        unit = parse_unit(r.unit)
        assert from_si(r.lower, unit) == pytest.approx(numbers(row["lower"])), name
        assert from_si(r.upper, unit) == pytest.approx(numbers(row["upper"])), name
        if row["default"]:
            assert from_si(plain.values.requirements[name], unit) == pytest.approx(float(row["default"])), name
        else:
            assert r.given or r.default is None or r.sx is None, name


@of_names
def options(named: Named) -> None:
    rows, default = named.rows, named.models[0]
    wanted = {r["name"]: r for r in rows if r["kind"] == "option"}
    declared = default.declaration.options
    assert set(declared) == set(wanted)
    for name, row in wanted.items():
        o = declared[name]
        assert (o.symbol, o.default) == (row["symbol"], row["default"]), name
        assert set(o.choices) == set(row["choices"].split(";")), name


@of_names
def every_requirement_and_option_stands_in_a_group(named: Named) -> None:
    for model in named.models:
        asked: list[Any] = [*model.declaration.requirements.values(), *model.declaration.options.values()]
        assert {record.name: record.group for record in asked if record.group not in GROUPS} == {}


@of_names
def choices(named: Named) -> None:
    rows, everything = named.rows, named.models
    wanted = {r["name"]: r for r in rows if r["kind"] == "choice"}
    for model in everything:
        choices = model.declaration.choices
        assert set(choices) == set(wanted)
        for name, row in wanted.items():
            assert (choices[name].symbol, ";".join(choices[name].labels)) == (row["symbol"], row["choices"]), name


@of_names
def variables_and_counts(named: Named) -> None:
    rows, everything = named.rows, named.models
    d = everything[0].declaration
    wanted = {r["name"]: r for r in rows if r["kind"] == "var"}
    seen = {name: v for model in reversed(everything) for name, v in model.declaration.variables.items()}
    assert set(seen) == set(wanted)
    for name, row in wanted.items():
        v = seen[name]
        assert (v.symbol, v.unit) == (row["symbol"], row["unit"]), name
        lower, upper = from_si(v.lower, v.unit), from_si(v.upper, v.unit)
        assert (lower, upper) == (float(row["lower"]), float(row["upper"])), name
        if row["step"]:
            steps = from_si(v.grid, v.unit)
            assert len(steps) == round((upper - lower) / float(row["step"])) + 1
            assert steps[1] - steps[0] == pytest.approx(float(row["step"]))
        elif row["choices"]:  # the ladder of a table
            ladder = from_si(as_catalogs(None).table(row["choices"]).number("diameter"), v.unit)
            assert from_si(v.grid, v.unit) == pytest.approx(ladder[(ladder >= lower) & (ladder <= upper)])
        else:
            assert not len(v.grid), name
    wanted = {r["name"]: r for r in rows if r["kind"] == "count"}
    assert set(d.counts) == set(wanted)
    for name, row in wanted.items():
        values = d.counts[name].values
        assert d.counts[name].symbol == row["symbol"]
        assert (values[0], values[-1], values[1] - values[0]) == tuple(
            float(row[k]) for k in ("lower", "upper", "step")
        )


@of_names
def slots_and_their_columns(named: Named) -> None:
    plain, rows, everything = named.plain, named.rows, named.models
    everything = [*everything, plain.model]  # an optional requirement may take the place of a column
    slots = {r["name"]: r for r in rows if r["kind"] == "slot"}
    seen = {name: part for model in everything for name, part in model.declaration.slots.items()}
    assert set(seen) == set(slots)
    for name, row in slots.items():
        assert (seen[name].symbol, seen[name].table) == (row["symbol"], row["choices"]), name
    used = {
        f"{part.slot}.{c}"
        for model in everything
        for part in model.declaration.slots.values()
        for column in part.columns.values()
        for c in column.columns
    }
    columns = {r["name"]: r for r in rows if r["kind"] in ("col", "col?")}
    text = {name for name, row in columns.items() if not row["unit"]}
    assert set(columns) - text <= used
    conditions = " ".join(w for model in everything for p in model.declaration.slots.values() for w in p.where)
    for name in text:
        slot, column = name.split(".")
        assert column in conditions or f"{slot}.{CODE_OF}{column}" in used
    for name, row in columns.items():
        if row["unit"]:
            slot, column = name.split(".")
            table = as_catalogs(None).table(slots[slot]["choices"])
            found, expected = table.columns[column].scale, parse_unit(row["unit"], table.columns[column].scale.kind)
            assert found.dimension == expected.dimension, name
            assert found.factor == pytest.approx(expected.factor), name


@of_names
def optional_columns_are_those_of_the_table(named: Named) -> None:
    plain, rows, everything = named.plain, named.rows, named.models
    everything = [*everything, plain.model]  # an optional requirement may take the place of a column
    wanted = {r["name"] for r in rows if r["kind"] == "col?"}
    for model in everything:
        for limit in model.constraints:
            for k in limit.void_without:
                assert model.data_inputs[k].label in wanted, limit.name
    voids = {model.data_inputs[k].label for model in everything for x in model.constraints for k in x.void_without}
    assert voids == wanted


@of_names
def derived_quantities(named: Named) -> None:
    rows, everything = named.rows, named.models
    wanted = {r["name"]: r for r in rows if r["kind"] == "out"}
    for model in everything:
        declared = model.declaration.derived
        assert set(declared) == set(wanted) | {r["name"] for r in rows if r["kind"] == "obj"}
        for name, quantity in declared.items():
            row = next(r for r in rows if r["name"] == name)
            assert (quantity.symbol, quantity.unit) == (row["symbol"], row["unit"]), name


@of_names
def objectives(named: Named) -> None:
    rows, everything = named.rows, named.models
    wanted = {r["name"]: r["objective"] for r in rows if r["objective"]}
    wanted |= {r["name"]: "on request" for r in rows if r["kind"] == "obj"}
    for model in everything:
        found = {o.name: "default" if o.default else "on request" for o in model.declaration.objectives.values()}
        assert found == wanted


@of_names
def a_symbol_works_wherever_the_name_does(named: Named) -> None:
    plain, rows, everything = named.plain, named.rows, named.models
    spellings = {word: name for model in everything for word, name in model.declaration.names().items()}
    structural = {r["name"] for r in rows if "." not in r["name"]}
    for row in rows:
        if row["name"] in structural:
            assert spellings[row["symbol"]] == row["name"]
            assert spellings[row["name"]] == row["name"]
    assert {model.title for model in everything} == {plain.model.title}
