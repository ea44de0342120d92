"""Names, symbols, units, defaults and bounds of a family against the table of its public names.

A family whose names depend on an option has a table per value: ``names_FAMILY.csv`` for the default, and
``names_FAMILY@OPTION=VALUE.csv``.
"""

import csv
from pathlib import Path

import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.text.row_cells import CODE_OF
from synth.units import from_si, parse_unit
from tests.conformance.cases import CASES, question
from tests.shipped import FAMILIES

FOLDER = Path(__file__).parent
TABLES = sorted(FOLDER.glob("names_*.csv"))


def rows_of(path):
    return list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))


def family_and_option(path):
    """Return the family of a table, and the option (name, value) that it is for, if it is for one."""
    family, _, option = path.stem.removeprefix("names_").partition("@")
    return family, tuple(option.split("=")) if option else None


def structures(family, option):
    """Return the options of all structures of the family that a table is for."""
    others = {own for f, own in map(family_and_option, TABLES) if f == family and own not in (None, option)}
    kept = [
        options
        for options in CASES[family].option_sets.values()
        if (option is None or option in options.items()) and not others & set(options.items())
    ]
    assert kept
    return kept


LARGE = ("names_multi_plate_clutch",)  # of many structures
PARAMS = [pytest.param(p, marks=pytest.mark.slow if p.stem in LARGE else []) for p in TABLES]


@pytest.fixture(scope="module", params=PARAMS, ids=lambda p: p.stem.removeprefix("names_"))
def named(request):
    family, option = family_and_option(request.param)
    models = [question(family, options, optional=True).model for options in structures(family, option)]
    default = {} if option is None else dict([option])
    plain = question(family, default, optional=False)  # expressions get their numbers here
    return plain, rows_of(request.param), models


def test_every_family_has_its_table():
    assert {family for family, option in map(family_and_option, TABLES) if option is None} == set(FAMILIES)


def numbers(text):
    return float(text) if text else None


@pytest.mark.slow
def test_requirements(named):
    plain, rows, (default, *_) = named
    wanted = {r["name"]: r for r in rows if r["kind"] in ("req", "opt")}
    declared = default.declaration.requirements
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
            assert r.default is None, name


def test_options(named):
    _, rows, (default, *_) = named
    wanted = {r["name"]: r for r in rows if r["kind"] == "option"}
    declared = default.declaration.options
    assert set(declared) == set(wanted)
    for name, row in wanted.items():
        o = declared[name]
        assert (o.symbol, o.default) == (row["symbol"], row["default"]), name
        assert set(o.choices) == set(row["choices"].split(";")), name


GROUPS = {"duty", "envelope", "practice", "model", "material", "actuator"}


def test_every_requirement_and_option_stands_in_a_group(named):
    _, _, models = named
    for model in models:
        asked = [*model.declaration.requirements.values(), *model.declaration.options.values()]
        assert {record.name: record.group for record in asked if record.group not in GROUPS} == {}


def test_choices(named):
    _, rows, everything = named
    wanted = {r["name"]: r for r in rows if r["kind"] == "choice"}
    for model in everything:
        choices = model.declaration.choices
        assert set(choices) == set(wanted)
        for name, row in wanted.items():
            assert (choices[name].symbol, ";".join(choices[name].labels)) == (row["symbol"], row["choices"]), name


def test_variables_and_counts(named):
    _, rows, everything = named
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


def test_slots_and_their_columns(named):
    plain, rows, everything = named
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
            assert (found.dimension, found.factor) == (expected.dimension, pytest.approx(expected.factor)), name


def test_optional_columns_are_those_of_the_table(named):
    plain, rows, everything = named
    everything = [*everything, plain.model]  # an optional requirement may take the place of a column
    wanted = {r["name"] for r in rows if r["kind"] == "col?"}
    for model in everything:
        for limit in model.constraints:
            for k in limit.void_without:
                assert model.data_inputs[k].label in wanted, limit.name
    voids = {model.data_inputs[k].label for model in everything for x in model.constraints for k in x.void_without}
    assert voids == wanted


def test_derived_quantities(named):
    _, rows, everything = named
    wanted = {r["name"]: r for r in rows if r["kind"] == "out"}
    for model in everything:
        declared = model.declaration.derived
        assert set(declared) == set(wanted) | {r["name"] for r in rows if r["kind"] == "obj"}
        for name, quantity in declared.items():
            row = next(r for r in rows if r["name"] == name)
            assert (quantity.symbol, quantity.unit) == (row["symbol"], row["unit"]), name


def test_objectives(named):
    _, rows, everything = named
    wanted = {r["name"]: r["objective"] for r in rows if r["objective"]}
    wanted |= {r["name"]: "on request" for r in rows if r["kind"] == "obj"}
    for model in everything:
        found = {o.name: "default" if o.default else "on request" for o in model.declaration.objectives.values()}
        assert found == wanted


def test_a_symbol_works_wherever_the_name_does(named):
    plain, rows, everything = named
    spellings = {word: name for model in everything for word, name in model.declaration.names().items()}
    structural = {r["name"] for r in rows if "." not in r["name"]}
    for row in rows:
        if row["name"] in structural:
            assert spellings[row["symbol"]] == row["name"]
            assert spellings[row["name"]] == row["name"]
    assert {model.title for model in everything} == {plain.model.title}


@pytest.mark.slow
@pytest.mark.parametrize(("family", "structure"), [(f, s) for f, data in CASES.items() for s in data.option_sets])
def test_every_structure_can_be_described(family, structure):
    described = synth.describe(synth.load(family, **CASES[family].option_sets[structure]))
    assert (described.loc[described["kind"] == "column", "text"] != "").all()
