"""Formulas laid out: brackets, textbook forms, known numbers, and the three ways of writing them down."""

from __future__ import annotations

import math
from xml.etree import ElementTree

import pytest
from synth.reports.formula.layout import Typesetter, by_symbol, textbook
from synth.reports.formula.lines import WIDEST, broken, width
from synth.reports.formula.mathml import mathml
from synth.reports.formula.plain import plain
from synth.reports.formula.symbols import symbol_parts
from synth.reports.formula.typst import string, typst_math
from synth.reports.numbers import in_its_unit, printed

from synth.results.calculation import NamedQuantity
from synth.units import unit_text

A, B, C = (["q", name] for name in "abc")


POWER = ["*", [B, ["f", "log1p", [A]]], []]


def quantity(name, **more):
    return NamedQuantity(name=name, kind="derived", symbol=name, unit="-", **more)


QUANTITIES = {name: quantity(name) for name in "abc"}
SYMBOLS = Typesetter(QUANTITIES, by_symbol, numeric=False)


def text(tree):
    return plain(SYMBOLS.lay(textbook(tree)))


@pytest.mark.parametrize(
    ("tree", "line"),
    [
        (["+", [A, ["neg", B], ["n", -2.0]]], "a - b - 2"),
        (["*", [["+", [A, B]], C], []], "(a + b) * c"),
        (["*", [A], [B, C]], "a / (b * c)"),
        (["*", [["*", [A], [B]], C], []], "(a / b) * c"),
        (["^", ["+", [A, B]], ["n", 2.0]], "(a + b) ^ 2"),
        (["^", ["*", [A], [B]], ["n", 3.0]], "(a / b) ^ 3"),
        (["^", ["neg", A], ["n", 2.0]], "a ^ 2"),
        (["^", ["neg", A], ["n", 3.0]], "(- a) ^ 3"),
        (["^", A, ["n", 0.5]], "sqrt(a)"),
        (["^", A, ["n", -2.0]], "1 / (a ^ 2)"),
        (["neg", ["+", [A, B]]], "- (a + b)"),
        (["+", [A, ["neg", ["+", [B, C]]]]], "a - (b + c)"),
        (["f", "log1p", [A]], "ln(1 + a)"),
        (["neg", ["f", "expm1", [["neg", A]]]], "1 - e ^ (- a)"),
        (
            ["*", [["neg", ["f", "expm1", [["neg", ["*", [B, ["f", "log1p", [A]]], []]]]]]], [A]],
            "(1 - (1 + a) ^ (- b)) / a",
        ),
        (["neg", ["*", [["+", [A, ["neg", B]]], C], []]], "(b - a) * c"),
        (["+", [A, ["n", 1e-12]]], "a"),
        (["f", "min", [A, B]], "min(a; b)"),
        (["f", "abs", [["+", [A, ["neg", B]]]]], "abs(a - b)"),
        (["if", ["<", A, B], A, ["if", ["<=", B, C], B, C]], "{ a if a < b, b if b <= c, c otherwise }"),
        (["and", ["<", A, B], ["or", ["<", B, C], ["==", A, C]]], "a < b and (b < c or a = c)"),
        (["*", [["n", math.pi], A], [["n", 4.0]]], "(pi * a) / 4"),
        (["*", [["n", 2 / 3], A], []], "(2 / 3) * a"),
        (["*", [["n", math.sqrt(2)], A], []], "sqrt(2) * a"),
        (["n", 0.85], "0.85"),
        (["n", -0.5], "- 0.5"),
    ],
)
def test_formulas_read_like_a_textbook(tree, line):
    assert text(tree) == line


@pytest.mark.parametrize(
    ("number", "line"),
    [
        (math.pi / 4, "pi / 4"),
        (2 / math.pi, "2 / pi"),
        (math.pi**2, "pi ^ 2"),
        (1 / 7, "1 / 7"),
        (8 * math.pi / 180, "(2 * pi) / 45"),
        (0.85, "0.85"),
        (0.125, "0.125"),
        (12.5, "12.5"),
        (1e-7, "1e-7"),
        (3.14159, "3.14159"),
    ],
)
def test_fractions_and_powers_of_pi_are_told_others_are_not(number, line):
    assert text(["n", number]) == line


def test_numbers_beside_quantities_carry_their_unit():
    known = {"l": NamedQuantity(name="l", kind="derived", symbol="l", unit="mm")}
    setter = Typesetter(known, by_symbol, numeric=False)
    assert plain(setter.lay(["f", "max", [["q", "l"], ["n", 0.003]]])) == "max(l; 3 mm)"
    assert plain(setter.lay(["+", [["q", "l"], ["n", -0.5]]])) == "l - 500 mm"
    assert plain(setter.lay(["<", ["q", "l"], ["n", 0.0]])) == "l < 0"


def test_a_declared_constant_is_found_in_its_multiples():
    g = NamedQuantity(name="gravity", kind="constant", symbol="g_n", unit="m/s2", value=9.80665)
    setter = Typesetter({**QUANTITIES, "gravity": g}, by_symbol, numeric=False)
    assert plain(setter.lay(["*", [["n", 2 * 9.80665], A], []])) == "2 * g_n * a"
    assert plain(setter.lay(["*", [["n", 1 / 9.80665], A], []])) == "(1 / g_n) * a"


def test_labels_stand_for_the_numbers_of_choices():
    choice = NamedQuantity(name="side", kind="choice", symbol="side", unit="-", labels=("inner", "outer"))
    setter = Typesetter({"side": choice}, by_symbol, numeric=False)
    assert plain(setter.lay(["==", ["q", "side"], ["n", 1.0]])) == "side = outer"


@pytest.mark.parametrize(
    ("symbol", "parts"),
    [
        ("F0", (False, "F", ("0",))),
        ("mu_guide", (False, "μ", ("guide",))),
        ("omega1", (False, "ω", ("1",))),
        ("dT_pk", (True, "T", ("pk",))),
        ("dr", (True, "r", ())),
        ("dm", (False, "d", ("m",))),
        ("d_out", (False, "d", ("out",))),
        ("NI", (False, "NI", ())),
        ("d_w_max", (False, "d", ("w", "max"))),
    ],
)
def test_symbols_follow_the_grammar(symbol, parts):
    found = symbol_parts(symbol)
    assert (found.difference, found.base, found.subscripts) == parts


def test_mathml_is_well_formed_and_escapes_texts():
    tree = ["if", ["<", A, B], ["*", [["^", A, ["n", 2.0]]], [["f", "sqrt", [B]]]], ["f", "<script>", [C]]]
    found = mathml(SYMBOLS.lay(tree))
    ElementTree.fromstring(f"<math>{found.replace('&#160;', ' ')}</math>")
    assert "<script>" not in found


def test_typst_texts_stand_in_strings():
    hostile = '#read("/etc/passwd") \\ $ "'
    assert string(hostile) == '"#read(\\"/etc/passwd\\") \\\\ $ \\""'
    setter = Typesetter({"a": NamedQuantity(name="a", kind="derived", symbol='x"#y', unit="-")}, by_symbol, False)
    assert '\\"#y' in typst_math(setter.lay(["q", "a"]))


def test_wide_sums_are_broken_before_terms():
    terms = [["*", [A, B, C, ["n", 1.23456 + k]], []] for k in range(14)]
    laid = SYMBOLS.lay(["+", terms])
    lines = broken(laid)
    assert len(lines) > 1
    assert all(width(line) <= WIDEST for line in lines)
    assert all(plain(line).startswith("+") for line in lines[1:])
    assert "".join(plain(line).replace(" ", "") for line in lines) == plain(laid).replace(" ", "")


@pytest.mark.parametrize(
    ("value", "digits", "line"),
    [
        (1058.8235, 5, "1058.8"),
        (1e-7, 5, "1e-7"),
        (-0.0001234567, 5, "-0.00012346"),
        (123456789.0, 5, "1.2346e8"),
        (999999.0, 5, "999999"),
        (0.99999999, 5, "1"),
        (math.nan, 5, "–"),
        (math.inf, 5, "∞"),
        (0.0, 5, "0"),
    ],
)
def test_numbers_are_shown_in_significant_digits(value, digits, line):
    assert in_its_unit(value, "-", digits).plain() == line


def test_numbers_carry_units_as_people_print_them():
    assert printed(in_its_unit(0.00012, "mm2")) == "120 mm²"
    assert printed(in_its_unit(1.5e-12, "kg")) == "1.5·10⁻¹² kg"
    assert printed(in_its_unit(math.pi / 6, "deg")) == "30°"
    assert unit_text("W/(m2*K)") == "W/(m² K)"
