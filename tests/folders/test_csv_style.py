"""Tables for people of other countries hold the same, and are read as they were."""

from __future__ import annotations

import csv
import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import InputError
from synth.folders.csv_style import ENGLISH, GERMAN, NUMBER, csv_style, with_comma, with_point
from synth.folders.files import csv_text
from synth.tables.delimited_text import delimited_text

numbers = st.floats(-1e9, 1e9, allow_nan=False).map(lambda x: x + 0.0)


def read(text: str) -> list[list[str]]:
    return [cells for _, cells in delimited_text(text.encode(), "designs.csv").lines()]


def test_the_usual_style_changes_nothing() -> None:
    text = csv_text(["a", "b [mm]"], [["x", 1.5]])
    assert ENGLISH.text(text) == text
    assert ENGLISH.files({"a.csv": text}) == {"a.csv": text}


def test_what_people_open_in_german() -> None:
    text = csv_text(["name", "mass [kg]", "parts"], [["core 0.5", 12.5, "a, b"], ["=1+1", 1.234, 'say "c"']])
    assert GERMAN.text(text) == ('\ufeffname;mass [kg];parts\ncore 0.5;12,5;a, b\n\'=1+1;1,2340;"say ""c"""\n')
    assert GERMAN.files({"a.csv": "x\n0.5\n", "a.json": "0.5", "b.csv": b"0.5"}) == {
        "a.csv": "\ufeffx\n0,5\n",
        "a.json": "0.5",
        "b.csv": b"0.5",
    }


@given(st.lists(st.tuples(numbers, numbers), min_size=1, max_size=9))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_numbers_are_read_as_they_were(rows: list[tuple[float, float]]) -> None:
    text = csv_text(["a [mm]", "b [mm]", "n"], [[*row, "core 1.5"] for row in rows])
    found = read(GERMAN.text(text))[1:]
    assert [(float(a), float(b)) for a, b, _ in found] == rows
    assert all(cells[2] == "core 1.5" for cells in found)


@pytest.mark.slow
@given(
    st.lists(st.sampled_from(["1.234", "12.5", "7", "core 2", "1.5 mm", "<= 3.25 kg", "", "inf", "1e-07"]), max_size=9)
)
@settings(deadline=None, derandomize=True, max_examples=200)
def test_columns_of_words_and_numbers_are_read_as_they_were(cells: list[str]) -> None:
    text = csv_text(["n", "x"], [["row", cell] for cell in cells])

    def meant(cell: str) -> tuple[str, float, str] | str:
        match = NUMBER.fullmatch(cell)
        return (match["before"], float(match["number"]), match["after"]) if match else cell

    found = [row[1] for row in read(GERMAN.text(text))[1:]]
    assert [meant(cell) for cell in found] == [meant(cell) for cell in cells]


@given(numbers)
@settings(deadline=None, derandomize=True)
def test_commas_and_points_change_places(number: float) -> None:
    assert float(with_point(with_comma(repr(number)))) == number
    assert "." not in with_comma(f"{number:.3f}")


def test_texts_with_commas_stay() -> None:
    text = csv_text(["x"], [["1,5"], [2.5]])
    assert list(csv.reader(io.StringIO(GERMAN.text(text).removeprefix("\ufeff")), delimiter=";")) == [
        ["x"],
        ["1,5"],
        ["2.5"],
    ]


def test_styles_have_names() -> None:
    assert (csv_style("en"), csv_style("de")) == (ENGLISH, GERMAN)
    with pytest.raises(InputError, match=r"--csv: got 'fr'; expected en \(commas, decimal points\) or de"):
        csv_style("fr", "--csv")
