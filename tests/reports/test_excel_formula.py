"""Formulas of spreadsheets give the numbers of the trees they are written from."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from synth.reports.excel_formula import LONGEST, from_si_text, number_text, to_si_text, write
from synth.reports.excel_names import LegalNames

from synth.results.expression import FUNCTIONS, value_of
from synth.units import from_si, to_si
from tests.reports.spreadsheet import computed

pytestmark = pytest.mark.slow

NAMES = {"x": "slot.x_value", "y": "why", "z": "zed"}
X, Y, Z = (["q", name] for name in NAMES)


def number(text, values):
    return computed(text, {NAMES[name]: value for name, value in values.items()})


def same(a, b, tolerance=1e-13):
    return (math.isnan(a) and not math.isfinite(b)) or a == b or abs(a - b) <= tolerance * max(abs(a), abs(b))


OLD = "IF AND OR NOT MIN MAX ABS SQRT EXP LN SIN COS TAN ATAN ATAN2 SIGN INT TRUNC PI IFERROR TANH ASINH ERF"

TREES = [
    ["neg", ["^", X, ["n", 2.0]]],
    ["+", [["neg", ["^", X, ["n", 2.0]]], Y]],
    ["*", [["neg", X], Y], [["neg", Z]]],
    ["^", ["neg", X], ["n", 2.0]],
    ["^", X, ["neg", Y]],
    ["^", X, ["n", -0.5]],
    ["^", ["^", X, Y], Z],
    ["^", X, ["^", Y, Z]],
    ["^", ["n", -2.0], ["n", 3.0]],
    ["^", ["n", math.pi / 4], X],
    ["*", [X], [["*", [Y], [Z]]]],
    ["*", [X, ["*", [Y], [Z]]], [Y, ["n", 1 / 3]]],
    ["*", [], [X, Y]],
    ["*", [["+", [X, Y]]], [["n", math.pi]]],
    ["+", [["n", -1.0], X, ["n", -0.25], ["neg", ["+", [Y, ["neg", Z]]]]]],
    ["neg", ["neg", X]],
    ["neg", ["+", [["neg", X], Y]]],
    ["neg", ["*", [["^", X, ["n", 2.0]]], [Y]]],
    ["f", "atan2", [X, Y]],
    ["f", "hypot", [["+", [X, Y]], ["neg", Z]]],
    ["f", "min", [X, ["neg", Y], Z]],
    ["f", "max", [["+", [X, Y]], Z]],
    ["f", "fmod", [["neg", ["*", [X, ["n", 7.0]], []]], ["+", [Y, Z]]]],
    ["*", [["f", "fmod", [X, Y]], ["f", "ceil", [Z]]], []],
    ["f", "copysign", [X, ["neg", Y]]],
    ["f", "sqrt", [["neg", X]]],
    ["if", ["<", X, Y], ["neg", X], ["^", Y, ["n", 2.0]]],
    ["if", ["and", ["<=", X, Y], ["not", ["==", Y, Z]]], X, Z],
    ["if", ["or", ["<", Y, X], ["!=", X, X]], X, Z],
    ["*", [["<", X, Y], Z], []],
    ["+", [["<=", X, Y], ["and", ["<", X, Y], Z]]],
    ["if", ["<", ["f", "sqrt", [["neg", X]]], Y], X, Z],  # a comparison with what does not exist is not true
    ["if", ["!=", ["f", "ln", [["neg", X]]], Y], X, Z],
    *(["f", name, [X]] for name in ("log1p", "expm1", "floor", "ceil", "sign", "tanh", "asinh", "erf")),
    *(["f", name, [["neg", X]]] for name in ("log1p", "expm1", "floor", "ceil", "sign", "exp", "abs", "atan")),
]


@pytest.mark.parametrize("tree", TREES, ids=lambda tree: write(tree, NAMES)[:40])
def test_a_formula_gives_what_the_tree_gives(tree):
    for values in ({"x": 0.75, "y": 0.3, "z": 1.7}, {"x": 0.2, "y": 2.6, "z": 0.4}):
        assert same(number(write(tree, NAMES), values), value_of(tree, values)), write(tree, NAMES)


def test_random_trees_give_the_same():
    rng = np.random.default_rng(5)

    def tree(depth):
        kind = rng.choice(["q", "n"]) if depth == 0 else rng.choice(["+", "*", "^", "neg", "if", "min", "q"])
        if kind == "q":
            return [X, Y, Z][rng.integers(3)]
        if kind == "n":
            return ["n", float(rng.choice([-2.0, 0.5, 3.0, math.pi, 1 / 3, -0.1, 1e-5]))]
        part = [tree(depth - 1) for _ in range(3)]
        if kind == "+":
            return ["+", part]
        if kind == "*":
            return ["*", part[:2], part[2:]]
        if kind == "if":
            return ["if", ["<", part[0], part[1]], part[2], part[0]]
        if kind == "min":
            return ["f", "min", part]
        return ["neg", part[0]] if kind == "neg" else ["^", part[0], ["n", float(rng.choice([2.0, 3.0, -1.0]))]]

    for _ in range(80):
        own = tree(3)
        values = dict(zip(NAMES, rng.uniform(0.3, 2.0, 3).tolist(), strict=True))
        text = write(own, NAMES)
        assert same(number(text, values), value_of(own, values), 1e-9), text


@pytest.mark.parametrize("name", sorted(FUNCTIONS))
def test_every_function_can_be_written(name):
    count = 2 if name in ("atan2", "hypot", "fmod", "copysign", "min", "max") else 1
    value = 1.5 if name == "acosh" else 0.4
    tree = ["f", name, [X, Y][:count]]
    values = {"x": value, "y": 0.3}
    assert same(number(write(tree, NAMES), {k: values[k] for k in list(values)[:count]}), value_of(tree, values), 1e-12)


@pytest.mark.parametrize("x", [1e-3, 1e-9, 3e-14, 1e-18, -1e-12, 0.0, 0.7, -0.6, 40.0])
def test_what_is_near_one_keeps_its_digits(x):
    for name in ("log1p", "expm1"):
        if name == "expm1" or x > -1:
            tree = ["f", name, [X]]
            assert same(number(write(tree, NAMES), {"x": x}), value_of(tree, {"x": x})), name
    assert same(number(write(["f", "expm1", [["neg", X]]], NAMES), {"x": 900.0}), -1.0)


def test_arguments_that_are_needed_twice_have_a_cell():
    cells = []

    def helper(tree):
        cells.append(write(tree, NAMES, helper))
        return f"Helpers!$A${len(cells)}"

    text = write(["f", "expm1", [["neg", ["*", [X, Y], []]]]], NAMES, helper)
    assert cells == ["EXP(-(slot.x_value*why))", "-(slot.x_value*why)"]
    assert text.count("slot") == 0
    assert "Helpers!$A$2" in text


def test_long_formulas_are_told_in_parts():
    cells, values = {}, dict(zip(NAMES, (1.01, 0.3, 0.7), strict=True))

    def helper(tree):
        text = write(tree, NAMES, helper)
        cells[f"Cell{len(cells)}"] = (text, value_of(tree, values))
        return f"Cell{len(cells) - 1}"

    long = ["+", [["*", [["n", float(k)], X, ["f", "sin", [Y]]], [Z]] for k in range(400)]]
    deep = X
    for _ in range(40):
        deep = ["f", "sqrt", [["+", [["if", ["<", X, Z], deep, Y], Y]]]]
    wide = [
        "if",
        ["<", long, Y],
        ["*", [["+", [X, ["n", float(k)]]] for k in range(300)], []],
        ["f", "max", [long, deep]],
    ]
    for tree in (long, deep, wide):
        text = write(tree, NAMES, helper)
        for formula in (text, *(text for text, _ in cells.values())):
            assert len(formula) <= LONGEST
        told = {name: value for name, (_, value) in cells.items()} | {NAMES[k]: v for k, v in values.items()}
        found = computed(text, told)
        assert same(found, value_of(tree, values), 1e-12)
    with pytest.raises(ValueError, match="needs cells"):
        write(long, NAMES)


def test_nothing_that_old_spreadsheets_do_not_know_is_used():
    for tree in TREES:
        assert set(re.findall(r"[A-Z0-9]+(?=\()", write(tree, NAMES))) <= set(OLD.split())


@pytest.mark.parametrize(
    "value", [1 / 3, 2 / 3, math.pi, math.pi / 180, 0.1, 1e-9, 1.25e300, -2.5, 0.0, 123456.789, 7 / 12]
)
def test_numbers_are_those_they_stand_for(value):
    assert same(number(number_text(value), {}), value, 1e-15)


@pytest.mark.parametrize(
    "unit", ["mm", "1/min", "degC", "deg", "J/(mm2 h)", "N*m", "-", "", "1/h", "mm3/MJ", "kp", "km/h"]
)
def test_units_are_converted_by_their_factors(unit):
    si = to_si(12.5, unit or "-")
    assert same(number(to_si_text("why", unit), {"y": 12.5}), si, 1e-15)
    assert same(number(from_si_text("why", unit), {"y": si}), from_si(si, unit or "-"), 1e-13)


def test_names_are_legal_and_told_apart():
    names = LegalNames()
    public = [
        "F0",
        "J2",
        "r",
        "c",
        "R1C1",
        "xfd1",
        "log10",
        "a b",
        "wire.d",
        "Wire.D",
        "true",
        "ä.ö",
        "",
        "_xlnm.x",
        "x" * 300,
    ]
    found = [names.of(name) for name in public]
    assert len({name.lower() for name in found}) == len(found)
    for name in found:
        assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_.]*", name)
        assert not re.fullmatch(r"[A-Za-z]{1,3}[0-9]+|[rRcC]|[rR][0-9]*[cC][0-9]*", name), name
        assert len(name) <= 255
