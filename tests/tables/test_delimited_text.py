"""How tables are written is recognised, and what may be meant in two ways is asked back."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.batches.row_table import read_table
from synth.errors import InputError
from synth.tables.delimited_text import delimited_text
from synth.tables.reading import load_table
from tests.terminal.entry import in_process

ROWS = [
    ["Größe", "load_torque [N·m]", "driver_speed [1/min]", "mass"],
    ["A", "60,5", "1450", "≤ 12,5 kg"],
    ["B", "7", "90", ""],
]
READ = [
    ["Größe", "load_torque [N·m]", "driver_speed [1/min]", "mass"],
    ["A", "60.5", "1450", "≤ 12.5 kg"],
    ["B", "7", "90", ""],
]


def text_of(rows: list[list[str]], delimiter: str) -> str:
    return "".join(delimiter.join(cells) + "\r\n" for cells in rows)


def read(raw: bytes) -> list[list[str]]:
    return [cells for _, cells in delimited_text(raw, "rows.csv").lines()]


@pytest.mark.parametrize("delimiter", [";", "\t"])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "latin-1", "utf-16", "utf-16-be"])
@pytest.mark.parametrize("stated", [False, True])
def test_what_excel_writes_reads_the_same(delimiter: str, encoding: str, stated: bool) -> None:
    rows = ROWS if encoding not in ("cp1252", "latin-1") else [[c.replace("≤", "<=") for c in row] for row in ROWS]
    right = READ if rows is ROWS else [[c.replace("≤", "<=") for c in row] for row in READ]
    text = (f"sep={delimiter}\r\n" if stated else "") + text_of(rows, delimiter)
    raw = text.encode(encoding)
    if encoding == "utf-16-be":
        raw = b"\xfe\xff" + raw
    found = delimited_text(raw, "rows.csv")
    lines = list(found.lines())
    assert [cells for _, cells in lines] == right
    assert [number for number, _ in lines] == ([2, 3, 4] if stated else [1, 2, 3])
    told = found.sentence()
    assert ("semicolons" if delimiter == ";" else "tabs") in told
    assert "decimal commas in load_torque [N·m], mass" in told
    assert ("Windows-1252" in told) == (encoding in ("cp1252", "latin-1"))


def test_what_is_written_as_expected_is_not_told() -> None:
    found = delimited_text(b'a,b\n"1,5",x\n', "rows.csv")
    assert found.sentence() == ""
    assert list(found.lines()) == [(1, ["a", "b"]), (2, ["1,5", "x"])]  # commas between columns: lists, as before


@pytest.mark.parametrize(
    ("column", "read_as"),
    [
        (["1,5", "2"], ["1.5", "2"]),
        (["1.234,5", "0,125"], ["1234.5", "0.125"]),
        (["1,234", "0,5"], ["1.234", "0.5"]),  # the second says which the first is
        (["-0,5 mm", "12"], ["-0.5 mm", "12"]),
        (["3,0e-3"], ["3.0e-3"]),
        (["core 0,5", "1,5"], ["core 0,5", "1,5"]),  # text
        (["60,5", "80", "much", "120"], ["60.5", "80", "much", "120"]),  # one faulty cell says nothing of the others
        (["1,5", "2.5"], ["1,5", "2.5"]),  # both signs: whoever reads it says what is wrong
        (["4, 6, 8"], ["4, 6, 8"]),
        (["1,2,3"], ["1,2,3"]),
        (["1.5", ""], ["1.5", ""]),
        (["12 mm .. 14,5 mm"], ["12 mm .. 14,5 mm"]),
    ],
)
def test_commas_are_decimal_where_the_whole_column_says_so(column: list[str], read_as: list[str]) -> None:
    raw = "\n".join(["n;x", *(f"{k};{cell}" for k, cell in enumerate(column))]).encode()
    assert [cells[1] for cells in read(raw)[1:]] == read_as


@pytest.mark.parametrize(("cells", "asked"), [("1,234", "1.234 or 1234"), ("12,500 N*m", "12.500 or 12500")])
def test_what_may_be_meant_in_two_ways_is_asked_back(cells: str, asked: str) -> None:
    with pytest.raises(InputError, match=r"rows.csv, line 3, column x: got ") as refused:
        delimited_text(f"n;x\n1;2\n2;{cells}\n".encode(), "rows.csv")
    assert refused.value.expected.startswith(asked)


def test_points_may_part_thousands_where_other_columns_have_decimal_commas() -> None:
    speeds = "n;torque;speed\n1;60,5;1.500\n2;80;{}\n"
    with pytest.raises(InputError, match=r"rows.csv, line 2, column speed: got '1.500'; expected 1.500 or 1500"):
        delimited_text(speeds.format("900").encode(), "rows.csv")
    assert read(speeds.format("12.5").encode())[1] == ["1", "60.5", "1.500"]  # the other says which it is
    assert read(speeds.replace("60,5", "60").format("900").encode())[1] == ["1", "60", "1.500"]  # no comma anywhere


def test_a_delimiter_that_only_some_lines_have_is_none() -> None:
    assert read(b"name,note\nA,one; two\nB,three\n")[1] == ["A", "one; two"]
    assert read(b"a;b, c;d\n1;2;3\n")[0] == ["a", "b, c", "d"]


@given(st.lists(st.lists(st.floats(-1e6, 1e6), min_size=3, max_size=3), min_size=1, max_size=8))
@settings(deadline=None, derandomize=True, max_examples=100)
def test_numbers_come_back_whatever_their_sign_of_decimals_is(rows: list[list[float]]) -> None:
    written = [[f"{x:.7f}".replace(".", ",") for x in row] for row in rows]
    found = read(text_of([["a", "b", "c"], *written], ";").encode("cp1252"))[1:]
    assert [[float(cell) for cell in row] for row in found] == [[float(f"{x:.7f}") for x in row] for row in rows]


def test_a_catalogue_in_german_is_read(tmp_path: Path) -> None:
    own = tmp_path / "linings.csv"
    own.write_bytes("designation;µ [-];mass [kg]\nfein;0,12;1,5\ngrob;0,3;2\n".replace("µ", "mu").encode("cp1252"))
    table = load_table(own, shipped=False)
    assert table.number("mu").tolist() == [0.12, 0.3]


@pytest.mark.slow
def test_a_batch_in_german_runs_and_says_how_it_was_read(tmp_path: Path) -> None:
    rows = tmp_path / "Antriebe.csv"
    rows.write_bytes(
        "Antrieb für;load_torque [N*m];driver_speed [1/min];driven_inertia [kg*m2]\r\n"
        "Rührer;60,5;1500;0,5\r\nMühle;80;1000;0,75\r\n".encode("cp1252")
    )
    assert read_table(rows).sentence().startswith("Antriebe.csv: semicolons between the columns")
    done = in_process("batch", rows, "--family", "cone_clutch", "-o", tmp_path / "out", "--points", "2")
    assert done.returncode == 0, done.stderr
    assert "semicolons between the columns, text in Windows-1252, decimal commas in load_torque [N*m]" in done.stderr
    assert "Rührer" in (tmp_path / "out" / "designs.csv").read_text(encoding="utf-8")


@settings(deadline=None, max_examples=40)
@given(
    st.lists(st.sampled_from(["a,b", "Größe,1", "", "x" * 70_000, "x" * 65_535 + "ü,2", "€,3"]), min_size=1),
    st.sampled_from(["utf-8", "cp1252", "utf-8-sig", "utf-16"]),
    st.sampled_from(["\n", "\r\n"]),
)
def test_a_file_that_is_read_line_by_line_is_read_as_a_whole(lines: list[str], encoding: str, end: str) -> None:
    text = end.join([*lines, "last"])
    found = delimited_text(text.encode(encoding), "rows.csv")
    assert "".join(found.written_lines()) == text
    assert found.encoding == (encoding if not text.isascii() or encoding in ("utf-8-sig", "utf-16") else "utf-8")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n1,2\n" + "x" * 1_000_001 + "\n", "line 3: got more than that in one row"),
        ("a,b\n1," + "2," * 600_000 + "\n", "line 2: got more than that in one row"),
        ("a,b\n" + '"x\ny",' * 300_000, "line 2: got more than that in one row"),
        ('a,b\n1,"' + "x\n" * 100_000, "field larger than field limit"),
    ],
)
def test_no_row_fills_the_memory(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        list(delimited_text(text.encode(), "rows.csv").lines())


def test_what_is_no_text_any_more_is_told() -> None:
    """The first million bytes that are not ASCII tell the encoding."""
    raw = ("ü" * 1000 + "\n").encode() * 600 + b"\xfc\n"
    with pytest.raises(InputError, match=r"rows\.csv: got 'a broken file'; expected text in UTF-8 throughout"):
        list(delimited_text(raw, "rows.csv").lines())
