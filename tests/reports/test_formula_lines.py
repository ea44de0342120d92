"""Formulas that are wider than a line are broken where people would; what is printed stays the same formula."""

from __future__ import annotations

from synth.reports.formula.layout import MINUS, PLUS, TIMES, Amount, Fence, Fraction, Letter, Power, Row, Word
from synth.reports.formula.lines import broken, width
from synth.reports.formula.mathml import mathml
from synth.reports.formula.plain import plain
from synth.reports.formula.typst import typst_math
from synth.reports.numbers import ShownQuantity, in_its_unit

from synth.text.numbers import Shown


def letters(sign, names):
    row = []
    for name in names:
        row += [sign, Letter(name)] if row else [Letter(name)]
    return Row(tuple(row))


TERMS = letters(PLUS, ["alpha_first", "beta_second", "gamma_third", "delta_fourth"])


def test_a_sum_in_brackets_is_broken_at_its_terms():
    lines = broken(Row((Letter("m"), TIMES, Fence(TERMS))), 20.0)
    assert [width(line) <= 20.0 for line in lines] == [True] * len(lines)
    assert " ".join(map(plain, lines)) == "m * ( alpha_first + beta_second + gamma_third + delta_fourth )"


def test_what_is_over_a_bar_is_broken_beside_what_is_under_it():
    lines = broken(Fraction(letters(TIMES, ["alpha_first", "beta_second", "gamma_third"]), Letter("m")), 16.0)
    assert plain(lines[0]).startswith("(1 / m) *")
    assert len(lines) > 1
    assert max(map(width, lines)) <= 16.0
    sums = broken(Fraction(TERMS, Letter("m")), 20.0)
    assert " ".join(map(plain, sums)).endswith("( alpha_first + beta_second + gamma_third + delta_fourth )")
    assert plain(sums[0]) == "1 / m"


def test_what_has_no_place_to_break_stays_whole():
    root = Power(Letter("x"), TERMS)
    assert broken(root, 10.0) == [root]
    assert broken(TERMS, 1000.0) == [TERMS]


def test_signs_of_typst_keep_their_distance():
    assert typst_math(Row((MINUS, Letter("z")))).strip() == '-italic("z")'
    raised = Power(Word("e"), Fraction(Letter("a"), Letter("b")))
    assert typst_math(raised).strip().startswith("exp lr((")
    assert 'upright("slip")#","upright("max")' in typst_math(Letter("t_slip_max"))


def test_a_unit_that_begins_with_a_digit_stands_apart_from_its_number():
    speed = Amount(in_its_unit(26.6, "1/min"))
    assert "thick" in typst_math(speed)
    assert "0.45em" in mathml(speed)
    assert "thick" not in typst_math(Amount(ShownQuantity(Shown("", "3"), "mm")))
    assert typst_math(Amount(ShownQuantity(Shown("", "90"), "deg"))).strip() == 'upright("90")upright("°")'
