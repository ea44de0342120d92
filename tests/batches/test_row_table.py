"""Tables as they come from people: CSV, Excel, DataFrames, and what is wrong with them."""

from __future__ import annotations

import itertools
import tracemalloc
from pathlib import Path

import openpyxl
import pandas as pd
import pytest

from synth.batches.cells import read_fix, read_limits, read_options, read_parts
from synth.batches.row_table import RowTable, read_table, text_of
from synth.errors import InputError
from synth.text.input_limits import INPUT_LIMITS


def written(folder: Path, text: str | bytes) -> RowTable:
    path = folder / "rows.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return read_table(path)


def test_lines_keep_their_numbers(tmp_path: Path) -> None:
    table = written(tmp_path, '\ufeffa,b [mm],\n1,"two\nlines",\n\n , ,\n2,x,\n')
    assert table.header() == ("a", "b [mm]")
    assert list(table.lines()) == [(2, ("1", "two\nlines")), (6, ("2", "x"))]


def test_an_excel_sheet_a_frame_and_mappings_read_alike(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for line in (["id", "force [N]", "new"], ["A", 20, True], ["B", 1.5, None]):
        book.active.append(line)
    book.save(tmp_path / "rows.xlsx")
    frame = pd.DataFrame({"id": ["A", "B"], "force [N]": [20, 1.5], "new": [True, None]})
    mappings = [{"id": "A", "force [N]": 20, "new": True}, {"id": "B", "force [N]": 1.5}]
    for table in (tmp_path / "rows.xlsx", frame, mappings):
        found = read_table(table)
        assert found.header() == ("id", "force [N]", "new")
        assert list(found.lines()) == [(2, ("A", "20", "yes")), (3, ("B", "1.5", ""))]
        assert found.digest() == read_table(table).digest()
    assert read_table(frame).digest() != read_table(frame.head(1)).digest()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "a header"),
        (",,\n1,2,3\n", "a header"),
        ("a,,b\n", "a name for each column"),
        ("a,b,a\n", "each column once"),
        (b"a,b\n\x81,1\n", "UTF-8"),
        (b"a,b\n\x00,1\n", "a text file such as CSV"),
        ('a,b\n"1,2\n', "quotes that close"),
    ],
)
def test_a_file_that_is_no_table_is_refused(tmp_path: Path, text: str | bytes, words: str) -> None:
    table = written(tmp_path, text)
    with pytest.raises(InputError, match=words) as refused:
        _ = table.header(), list(table.lines())
    assert "rows.csv" in str(refused.value)


@pytest.mark.parametrize("table", ["nowhere.csv", "rows.xls", 3, [], "."])
def test_what_is_no_table_at_all_is_refused(table: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rows.xls").write_text("old")
    with pytest.raises(InputError, match="rows"):
        read_table(table)


def test_a_broken_excel_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rows.xlsx").write_text("no archive")
    with pytest.raises(InputError, match="Excel file that can be read"):
        read_table(tmp_path / "rows.xlsx").header()


def test_cells_of_programs_become_what_people_type() -> None:
    assert [text_of(x) for x in (1, 2.0, 0.1, 1e300, False, None)] == ["1", "2", "0.1", "1e+300", "no", ""]
    limits = text_of({"mass": ["<= 20 kg", ">= 5 kg"], "length": "1 mm .. 2 mm"})
    assert read_limits(limits, "") == {"mass": ["<= 20 kg", ">= 5 kg"], "length": ["1 mm .. 2 mm"]}


def test_entries_of_a_cell() -> None:
    assert read_parts("a = x y, z; b: 'p; q' in hint and mu > 0.1;", "") == {
        "a": ["x y", "z"],
        "b": "'p; q' in hint and mu > 0.1",
    }
    assert read_parts("""a = "core 3, thick", z; b: "x" == hint; c: "p, q"; d: "in" in hint """, "") == {
        "a": ["core 3, thick", "z"],
        "b": '"x" == hint',
        "c": ["p, q"],
        "d": '"in" in hint',
    }
    assert read_parts(text_of({"a": ["core 3, thick", "z"]}), "") == {"a": ["core 3, thick", "z"]}
    assert read_limits("mass <= 20 kg; z: 10 .. 14; z == 12", "") == {"mass": ["<= 20 kg"], "z": ["10 .. 14", "== 12"]}
    assert read_fix("", "") == {}


@pytest.mark.parametrize(
    ("read", "text"),
    [(read_fix, "a"), (read_fix, "a = "), (read_fix, "a < 3"), (read_options, "a = b; a = c"), (read_parts, "= x")],
)
def test_entries_that_are_none_are_refused(read: object, text: str) -> None:
    with pytest.raises(InputError, match="column x"):
        read(text, "column x")  # type: ignore[operator]


@pytest.mark.slow
def test_a_long_file_is_read_in_little_memory(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    with path.open("w", encoding="utf-8") as file:
        file.write("name;force [kN]\n")
        file.writelines(f"{k} {'ü' * 400};{k},5\n" for k in range(30_000))
    assert path.stat().st_size > 20_000_000  # more than any file that is read as a whole
    tracemalloc.start()
    table = read_table(path)
    assert table.count() == 30_000
    assert len(table.digest()) == 64
    assert "decimal commas" in table.sentence()
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < 5_000_000
    assert next(itertools.islice(table.lines(), 29_999, None))[1][1] == "29999.5"


@pytest.mark.slow
def test_more_rows_than_may_be_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("force\n" + "1\n" * (INPUT_LIMITS.rows + 1), encoding="utf-8")
    with pytest.raises(InputError, match="line 2000002: got more rows than that; expected at most 2000000 rows"):
        read_table(path).count()
