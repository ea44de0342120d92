"""One rule for numbers: its cases, its roundings, and what it is the only writer of."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.text.numbers import column_texts, number_text, page_text, percent, shown, signed, typed_number, used_share

ROOT = Path(__file__).parents[2]
CASES = json.loads((ROOT / "synth/text/number_cases.json").read_text(encoding="utf-8"))


def test_numbers_are_shown_as_the_cases_say() -> None:
    assert len(CASES["numbers"]) > 180
    assert [number_text(x, digits) for x, digits, _ in CASES["numbers"]] == [text for *_, text in CASES["numbers"]]


def test_shares_and_columns_are_shown_as_the_cases_say() -> None:
    assert [percent(x, digits) for x, digits, _ in CASES["shares"]] == [text for *_, text in CASES["shares"]]
    assert [column_texts(x, digits) for x, digits, _ in CASES["columns"]] == [texts for *_, texts in CASES["columns"]]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "–"),
        (float("nan"), "not known"),
        (float("inf"), "∞"),
        (float("-inf"), "-∞"),
        (-0.0, "0"),
        (5e-324, "4.941·10⁻³²⁴"),
        (1.7976931348623157e308, "1.798·10³⁰⁸"),
    ],
)
def test_what_is_not_finite_or_at_the_ends_of_floats(value: float | None, text: str) -> None:
    assert number_text(value) == text


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(3, 6))
def test_a_shown_number_is_the_nearest_of_its_digits(value: float, digits: int) -> None:
    told = shown(value, digits)
    read = Fraction(told.digits) * Fraction(10) ** told.power * (-1 if told.sign else 1)
    exact = Fraction(value)
    if value == 0:
        assert told.digits == "0"
        return
    exponent = len(str(abs(read.numerator) // read.denominator)) - 1 if abs(read) >= 1 else None
    decimals = len(told.digits.partition(".")[2])
    assert decimals <= digits + 3
    assert abs(read - exact) <= abs(exact) * Fraction(1, 2 * 10 ** (digits - 1))
    if exponent is not None and not told.power:
        assert abs(read - exact) <= Fraction(1, 2)


def test_ties_of_the_binary_value_go_away_from_zero() -> None:
    assert [number_text(x) for x in (1234.5, -1234.5, 12345.5, 0.5 + 2**-10)] == ["1235", "-1235", "12 346", "0.501"]


def test_characters_of_pages_and_of_specs() -> None:
    assert (page_text(-12345.6), page_text(3.25e-5)) == ("\u221212\u202f346", "3.25·10⁻⁵")
    assert (typed_number(-12345.6), typed_number(3.25e-5)) == ("-12345.6", "3.25e-5")
    assert (signed(0.5), signed(-0.5), used_share(1.0000001), used_share(None)) == ("+0.5", "-0.5", "100 %", "–")


# Files that are read by programs, sizes of drawings, and numbers that are rounded but not shown.
NOT_FOR_PEOPLE = {
    "problems/components/pack/curves.py": "headings of columns",
    "problems/cone/model.py": "headings of columns",
    "problems/friction/startup_curves.py": "headings of columns, a rounded number",
    "problems/magnetic_powder/curves.py": "headings of columns",
    "problems/wrap_spring/curves.py": "headings of columns",
    "reports/drawing/dxf.py": "name of a style",
    "reports/drawing/paper.py": "scale and dimensions of a drawing, by its standard",
    "reports/drawing/svg.py": "coordinates",
    "reports/formula/layout.py": "counts digits",
    "reports/front_plot.py": "coordinates",
    "reports/front_report.py": "data",
    "reports/sheet/html.py": "widths, data",
    "reports/sheet/typst_source.py": "widths",
    "synth/analysis/spec_template.py": "a spec",
    "synth/queue/database.py": "a setting of SQLite",
    "synth/batches/outputs.py": "a CSV file",
    "synth/system/operating_system.py": "arguments of commands",
    "synth/question/combinations.py": "a key",
    "synth/question/requirement_values.py": "a value of a spec",
    "synth/search/resolution.py": "a rounded number",
    "synth/studies/infeasibility/patches.py": "a spec",
    "synth/studies/whatif/study_answers.py": "a key",
    "synth/text/numbers.py": "the rule",
    "synth/units/quantity.py": "numbers of specs",
    "synth/variants/coverage.py": "a rounded number",
}
FORMATTED = re.compile(r"\{[^{}\n]*:[+,]?(?:\.\d+)?[gfe%]\}")


def test_no_other_module_writes_a_number_for_people() -> None:
    tops = (ROOT / top for top in ("synth", "problems", "reports"))
    found = {
        path.relative_to(ROOT).as_posix()
        for top in tops
        for path in top.rglob("*.py")
        if FORMATTED.search(path.read_text(encoding="utf-8"))
    }
    assert found <= set(NOT_FOR_PEOPLE)
    assert set(NOT_FOR_PEOPLE) <= found, "listed without need"
