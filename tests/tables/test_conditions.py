"""Conditions on table rows: grammar, units, membership, messages."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from synth.errors import InputError
from synth.tables.conditions import parse_condition
from synth.tables.reading import table_from_frame
from synth.tables.schema import Column, Schema
from synth.tables.table import Table

QUICK = settings(deadline=None, derandomize=True, max_examples=300)

SCHEMA = Schema(
    (
        Column("designation", "text", required=True),
        Column("lubrication", "text"),
        Column("surfaces", "text"),
        Column("p_allow", "number", "N/mm2", 0.0, 500.0, symbol="p"),
        Column("mu_dynamic", "number", "-", 0.0, 1.0, symbol="mu"),
        Column("crowned", "flag"),
    )
)


@pytest.fixture(scope="module")
def table() -> Table:
    frame = pd.DataFrame(
        {
            "designation": ["a", "b", "c", "d"],
            "lubrication": ["dry", "oil", "oil", None],
            "surfaces": ["disc facing;cone facing", "plate pack", "disc facing 2", None],
            "p_allow [N/mm2]": [0.4, 0.5, np.nan, 2.0],
            "mu_dynamic": [0.35, 0.1, 0.12, 0.08],
            "crowned": [0, 1, 0, 1],
        }
    )
    return table_from_frame(frame, SCHEMA, name="pairs")


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("mu_dynamic > 0.1", "ac"),
        ("mu_dynamic >= 0.1", "abc"),
        ("mu_dynamic < 1e-1", "d"),
        ("mu<=0.1", "bd"),
        ("mu == '10 %'", "b"),
        ("p_allow > 0.4", "bd"),
        ("p_allow >= '4 bar'", "abd"),
        ("p_allow == '400 kPa'", "a"),
        ("p_allow != 0.4", "bd"),
        ("not p_allow == 0.4", "bcd"),
        ("p in (0.4, '20 bar')", "ad"),
        ("p not in (0.4, '20 bar')", "bc"),
        ("lubrication == 'oil'", "bc"),
        ('lubrication != "oil"', "ad"),
        ("lubrication == ''", "d"),
        ("lubrication in ('dry','oil')", "abc"),
        ("lubrication not in ('dry')", "bcd"),
        ("'disc facing' in surfaces", "a"),
        ("'cone facing' in surfaces", "a"),
        ("'disc' in surfaces", ""),
        ("'disc facing' not in surfaces", "bcd"),
        ("crowned == 1 and lubrication == 'oil' or mu > 0.3", "ab"),
        ("crowned == 1 and (lubrication == 'oil' or mu > 0.3)", "b"),
        ("not crowned == 1 and not (mu > 0.3)", "c"),
        ("not not crowned == 1", "bd"),
        ("mu > -1", "abcd"),
    ],
)
def test_rows(table: Table, text: str, rows: str) -> None:
    condition = parse_condition(text)
    mask = condition.mask(table)
    assert mask.dtype == np.bool_
    assert "".join(np.array(table.designations)[mask]) == rows
    assert str(condition) == text
    assert parse_condition(str(condition)) == condition


def test_columns() -> None:
    condition = parse_condition("crowned == 0 and (kind != 'x' or 'y' in surfaces) and not mu in (1, 2)")
    assert condition.columns == {"crowned", "kind", "surfaces", "mu"}


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("mu > 0,1", 7, "decimal point instead of a decimal comma"),
        ("mu = 1", 4, "== to compare"),
        ("mu <> 1", 4, "!="),
        ("mu > 1 && mu < 2", 8, "and"),
        ("mu > 1 | mu < 2", 8, "or"),
        ("mu > 0.1 AND mu < 2", 10, "and in small letters"),
        ("p > 0.4 N", 9, "'0.4 N'"),
        ("p > 0.4 N/mm2", 10, "quotes: '0.4 N/mm2'"),
        ("p > 0.4N", 5, "quotes: '0.4 N/mm2'"),
        ("0.1 < mu", 1, "the column first"),
        ("lubrication == oil", 16, "'oil'"),
        ("'oil' == lubrication", 7, "a column stands first"),
        ("'oil' in 'oil'", 10, "a column after 'in'"),
        ("lubrication in 'dry'", 16, "round brackets"),
        ("lubrication in ('dry' 'oil')", 23, "a comma or a closing bracket"),
        ("lubrication in ['dry']", 16, "round brackets"),
        ("lubrication == 'dry", 16, "a closing quote"),
        ("(mu > 1", 8, "a closing bracket"),
        ("mu > 1)", 7, "the end of the condition"),
        ("mu", 3, "after a column"),
        ("mu >", 5, "a number or a text in quotes"),
        ("mu > 1 and", 11, "a column"),
        ("mu > 1 mu < 2", 8, "and, or"),
        ("mu not > 3", 8, "after a column"),
        ("mu.real.x > 3", 8, "a column, one of"),
        ("__import__('os')", 11, "after a column"),
        ("(" * 60 + "mu > 1" + ")" * 60, 51, "at most 50"),
        ("not " * 60 + "mu > 1", 201, "at most 50"),
    ],
)
def test_texts_that_are_no_condition(text: str, place: int, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_condition(text)
    assert expected in caught.value.expected
    assert f"(character {place})" in caught.value.field


@pytest.mark.parametrize("text", ["", "  ", "mu > 1 or " * 2000 + "mu > 1", None, 5])
def test_empty_endless_or_no_text(text: object) -> None:
    with pytest.raises(InputError, match="condition"):
        parse_condition(text)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "place", "expected"),
    [
        ("mu_dynami > 1", 1, "perhaps mu_dynamic"),
        ("crowned == 1 and lubricaton == 'x'", 18, "perhaps lubrication"),
        ("lubrication > 'a'", 1, "== or != or in"),
        ("lubrication == 5", 16, "in quotes, '5'"),
        ("'x' in mu", 8, "a column of text"),
        ("p_allow > '3 J'", 11, "a pressure or stress"),
        ("p_allow > 'much'", 11, "column p_allow [N/mm2]"),
        ("mu > 1e999", 6, "computer can hold"),
    ],
)
def test_conditions_that_do_not_fit_the_table(table: Table, text: str, place: int, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_condition(text).mask(table)
    assert expected in caught.value.expected
    assert f"(character {place})" in caught.value.field


def is_condition_or_refused(text: str) -> bool:
    try:
        return str(parse_condition(text)) == text
    except InputError as error:
        return bool(error.expected)


@QUICK
@given(st.text())
@example("(" * 9000)
@example("not " * 2400)
@example("٣ < mu")
@example("mu > \x00")
def test_no_text_makes_anything_but_an_input_error(text: str) -> None:
    assert is_condition_or_refused(text)


WORDS = [
    "mu",
    "lubrication",
    "and",
    "or",
    "not",
    "in",
    "(",
    ")",
    ",",
    "==",
    "<",
    "'dry'",
    "'a;b'",
    "0.1",
    "-3",
    "=",
    "'",
]


@QUICK
@given(st.lists(st.sampled_from(WORDS), max_size=12).map(" ".join))
def test_no_likely_text_makes_anything_but_an_input_error(text: str) -> None:
    assert is_condition_or_refused(text)


TESTS = ["mu > 0.1", "lubrication == 'oil'", "crowned == 1", "'disc facing' in surfaces", "p >= '4 bar'"]
PYTHON = {
    "mu > 0.1": lambda r: r["mu_dynamic"] > 0.1,
    "lubrication == 'oil'": lambda r: r["lubrication"] == "oil",
    "crowned == 1": lambda r: r["crowned"] == 1,
    "'disc facing' in surfaces": lambda r: "disc facing" in (r["surfaces"] or "").split(";"),
    "p >= '4 bar'": lambda r: r["p_allow"] is not None and r["p_allow"] >= 4e5,
}
TREES = st.recursive(
    st.sampled_from(TESTS),
    lambda part: st.one_of(
        st.tuples(part, st.sampled_from([" and ", " or "]), part).map(lambda t: f"({t[0]}){t[1]}({t[2]})"),
        part.map(lambda t: f"not ({t})"),
    ),
    max_leaves=6,
)


@QUICK
@given(TREES)
def test_nested_conditions_mean_what_logic_says(table: Table, text: str) -> None:
    expected = []
    for i in range(len(table)):
        row = table.row(i)
        logic = text
        for number, test in enumerate(TESTS):
            logic = (
                logic.replace(f"({test})", f"(v{number})")
                if f"({test})" in logic
                else logic.replace(test, f"v{number}")
            )
        truth = {f"v{number}": bool(PYTHON[test](row)) for number, test in enumerate(TESTS)}
        expected.append(_truth(logic, truth))
    assert parse_condition(text).mask(table).tolist() == expected


def _truth(logic: str, values: dict[str, bool]) -> bool:
    """Evaluate fully bracketed logic by rewriting, innermost first."""
    for name, value in values.items():
        logic = logic.replace(name, "T" if value else "F")
    rules = {"not (T)": "F", "not (F)": "T"}
    for a in "TF":
        for b in "TF":
            rules[f"({a}) and ({b})"] = "T" if a == b == "T" else "F"
            rules[f"({a}) or ({b})"] = "F" if a == b == "F" else "T"
    while logic not in ("T", "F"):
        for pattern, result in rules.items():
            logic = logic.replace(pattern, result)
    return logic == "T"
