"""Sheets of workbooks: which is meant, numbers that stand as text, dates and formulas."""

from __future__ import annotations

import builtins
import datetime
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from synth.batches.row_table import read_table
from synth.errors import InputError
from synth.tables.catalogs import Catalogs, with_reading_options
from synth.tables.reading import csv_of_file, load_table
from synth.tables.table_text import TableText
from synth.tables.workbook import is_workbook, sheet_of, split_sheet
from tests.terminal.entry import in_process


def written(path: Path, **sheets: Sequence[Sequence[Any]]) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for title, rows in sheets.items():
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(list(row))
    book.save(path)
    return path


def column(tmp_path: Path, cells: Sequence[Any], heading: str = "x [mm]") -> list[str]:
    rows = [["n", heading], *([f"row {k}", cell] for k, cell in enumerate(cells))]
    table = read_table(written(tmp_path / "rows.xlsx", Rows=rows))
    return [row[1] for _, row in table.lines()]


@pytest.mark.parametrize(
    ("cells", "read"),
    [
        (["12,5", 7, 1.25], ["12.5", "7", "1.25"]),
        (["12.5", 7], ["12.5", "7"]),
        (["'12,5", "'3,5"], ["12.5", "3.5"]),
        (["'12.5", 3], ["12.5", "3"]),
        (["1\u00a0234,5", "0,5"], ["1234.5", "0.5"]),
        (["1 234,5", "2 000"], ["1234.5", "2000"]),
        (["1 234", 5], ["1234", "5"]),
        (["\u00a012,5\u00a0"], ["\u00a012.5\u00a0"]),
        (["1.234,5", "1,234"], ["1234.5", "1.234"]),
        (["≤ 12,5 mm", 3], ["≤ 12.5 mm", "3"]),
        (["core 0,5", "plate 1,5"], ["core 0,5", "plate 1,5"]),
        (["1,5", "2.5"], ["1,5", "2.5"]),
        ([1.234, 2.5], ["1.234", "2.5"]),
        ([None, True], ["", "yes"]),
    ],
)
def test_numbers_that_stand_as_text(tmp_path: Path, cells: Sequence[Any], read: list[str]) -> None:
    rows = [["n", "x [mm]"], *([f"row {k}", cell] for k, cell in enumerate(cells))]
    table = read_table(written(tmp_path / "rows.xlsx", Rows=rows))
    assert [row[1] for _, row in table.lines()] == read


def test_blanks_stay_where_no_unit_says_that_it_is_a_number(tmp_path: Path) -> None:
    assert column(tmp_path, ["12 345", "67 890"], "order") == ["12 345", "67 890"]


@pytest.mark.parametrize(("cell", "asked"), [("1,234", "1.234 or 1234"), ("12,500 N*m", "12.500 or 12500")])
def test_what_may_be_meant_in_two_ways_is_asked_back(tmp_path: Path, cell: str, asked: str) -> None:
    with pytest.raises(InputError, match=r"rows.xlsx, sheet Rows, line 3, column x \[mm\]: got ") as refused:
        column(tmp_path, [12.5, cell])
    assert refused.value.expected.startswith(asked)


@pytest.mark.parametrize(
    "cell", [datetime.datetime(2026, 5, 1), "01.05.2026", "1. Mai", "May-05", datetime.time(1, 30)]
)
def test_dates_where_numbers_were_typed(tmp_path: Path, cell: Any) -> None:
    own = written(tmp_path / "own.xlsx", Own=[["designation", "mass [kg]"], ["a", 1.5], ["b", cell]])
    with pytest.raises(InputError, match=r"own.xlsx, sheet Own, line 3, column mass: .*has made a date of it"):
        load_table(own, shipped=False)


def test_a_date_that_is_carried_along_stays_one(tmp_path: Path) -> None:
    assert column(tmp_path, [datetime.datetime(2026, 5, 1), "x"], "ordered") == ["2026-05-01", "x"]


def test_formulas_have_values_or_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "rows.xlsx", Rows=[["n", "x [mm]"], ["a", "=1+1"]])
    with pytest.raises(InputError, match=r"rows.xlsx, sheet Rows, cell B2: .*; expected its value as well"):
        read_table(path).header()
    packed = {}
    with zipfile.ZipFile(path) as archive:
        packed = {name: archive.read(name) for name in archive.namelist()}
    name = "xl/worksheets/sheet1.xml"
    for value, kind, right in ((b"<v>2</v>", b"", "2"), (b"<v></v>", b' t="str"', "")):
        text = re.sub(rb"<v ?/>|<v></v>", value, packed[name])
        text = re.sub(rb'(<c r="B2"[^>]*?)(?: t="\w+")?>', rb"\1" + kind + rb">", text)
        with zipfile.ZipFile(path, "w") as archive:
            for other, content in packed.items():
                archive.writestr(other, text if other == name else content)
        assert [row for _, row in read_table(path).lines()] == [("a", right)]


LININGS = [["designation", "mu [-]"], ["a", "0,12"], ["b", 0.3]]


def test_the_sheet_that_is_meant(tmp_path: Path) -> None:
    book = written(tmp_path / "own.xlsx", Notes=[["of 2026"]], Beläge=LININGS, Other=[["designation"], ["c"]])
    table = load_table(book, shipped=False)
    assert table.number("mu").tolist() == [0.12, 0.3]
    assert table.readings == ("own.xlsx: sheet Beläge, decimal commas in mu [-]",)
    assert table.labels[0] == "own.xlsx, sheet Beläge, line 2"
    assert load_table(Path(f"{book}#Other"), shipped=False).designations == ("c",)
    with pytest.raises(InputError, match="a sheet that it has: Notes, Beläge, Other"):
        load_table(Path(f"{book}#Others"), shipped=False)
    rows = read_table(f"{book}#Beläge")
    assert rows.name == "own.xlsx"
    assert rows.header() == ("designation", "mu [-]")
    assert read_table(book).header() == ("of 2026",)  # rows of a batch: the first sheet
    assert len({rows.digest(), read_table(book).digest()}) == 2


def test_a_hash_is_part_of_a_name_where_a_file_is_called_so(tmp_path: Path) -> None:
    path = tmp_path / "own.xlsx#1"
    path.write_text("designation\na\n")
    assert split_sheet(path) == (path, "")
    assert not is_workbook(path)


def test_a_folder_may_hold_workbooks(tmp_path: Path) -> None:
    written(tmp_path / "core_plates.xlsx", Own=[["designation", "thickness [mm]"], ["p", "1,9"], ["q", True]][:2])
    (tmp_path / "~$core_plates.xlsx").write_bytes(b"open elsewhere")
    own = Catalogs(tmp_path)
    assert own.readings() == ("core_plates.xlsx: decimal commas in thickness [mm]",)
    assert own.files() == {"core_plates": str(tmp_path / "core_plates.xlsx")}
    assert own.table("core_plates").number("thickness").tolist() == [0.0019]
    (tmp_path / "core_plates.csv").write_text("designation,thickness [mm]\np,1.9\n")
    with pytest.raises(InputError, match=r"one file of each table; there is core_plates\.csv as well"):
        Catalogs(tmp_path)


def test_without_the_extra_it_is_said_which(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    book, known = written(tmp_path / "own.xlsx", Own=LININGS), builtins.__import__

    def missing(name: str, *more: Any) -> Any:
        if name == "openpyxl":
            raise ImportError(name)
        return known(name, *more)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(InputError, match=r"pip install 'clutchsynth\[excel\]'"):
        sheet_of(book, "catalogs", "a table")


def test_an_empty_sheet_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a header row"):
        load_table(written(tmp_path / "own.xlsx", Own=[]), shipped=False)
    with pytest.raises(InputError, match="at least one row"):
        load_table(written(tmp_path / "two.xlsx", Own=[["designation"]]), shipped=False)


@pytest.mark.slow
def test_how_own_tables_were_read_is_told_once(tmp_path: Path) -> None:
    """With every command that takes a spec or a design, once for each file."""
    heads = "designation;mu_dynamic;p_allow;v_allow;q_hourly_allow;power_density_allow;lining_thickness;wearable_depth"
    (tmp_path / "own.csv").write_bytes(
        f"sep=;\n{heads};density;temp_max\nBelag ü;0,12;1,2;20;20;0,6;0,8;0,3;1800;220\n".encode("cp1252")
    )
    spec = tmp_path / "spec.yaml"
    spec.write_text(
        "family: multi_plate_clutch\n"
        "requirements: {load_torque: 600 N*m, driver_speed: 254 rpm, driven_inertia: 30 kg*m2}\n"
        "objectives: [mass]\npoints: 1\ncatalogs: {friction_materials: own.csv}\n"
        "parts: {inner_plate: [core 2], outer_plate: [core 2]}\nfix: {ramp_time: 2 s, friction_surfaces: 10}\n"
    )
    told = "read as semicolons between the columns as its first line says, text in Windows-1252, decimal commas in"
    done = in_process("run", spec, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count(told) == 1
    assert ": own.csv\n" in done.stderr
    done = in_process("check", tmp_path / "out" / "design_01.yaml")
    assert done.stderr.count(told) == 1
    assert told not in in_process("run", spec, "-o", tmp_path / "out", "-q").stderr


# ---- as Excel left them ---------------------------------------------------------------------------------------------

PLATES = [["designation", "thickness [mm]"], ["a", 1.5], ["b", 2.0], ["c", 2.5], ["d", 3.0]]


def changed(path: Path, rows: Sequence[Sequence[Any]], hidden: Sequence[int] = (), merged: str = "") -> Path:
    """A workbook with hidden rows and merged cells, and a filter where rows are hidden."""
    book = openpyxl.Workbook()
    for row in rows:
        book.active.append(list(row))
    for row in hidden:
        book.active.row_dimensions[row].hidden = True
    if hidden:
        book.active.auto_filter.ref = f"A1:B{len(rows)}"
    if merged:
        book.active.merge_cells(merged)
    book.save(path)
    return path


def test_hidden_rows_are_told_and_left_out_where_it_is_asked(tmp_path: Path) -> None:
    own = changed(tmp_path / "own.xlsx", PLATES, hidden=[3, 5, 9])
    table = load_table(own, shipped=False)
    assert table.designations == ("a", "b", "c", "d")
    (told,) = table.readings
    assert told.startswith("own.xlsx: sheet Sheet, with 2 hidden or filtered rows (3, 5; ")
    assert "#rows=visible" in told
    shown = load_table(Path(f"{own}#Sheet#rows=visible"), shipped=False)
    assert shown.designations == ("a", "c")
    assert shown.labels == ("own.xlsx, sheet Sheet, line 2", "own.xlsx, sheet Sheet, line 4")
    assert shown.readings == ("own.xlsx: sheet Sheet, without 2 hidden or filtered rows (3, 5)",)
    rows = read_table(f"{own}#rows=visible")
    assert [(line, cells[0]) for line, cells in rows.lines()] == [(2, "a"), (4, "c")]
    assert rows.sentence() == shown.readings[0]
    assert rows.digest() != read_table(own).digest()
    assert Catalogs({"plates": f"{own}#rows=visible"}).table("plates").designations == ("a", "c")


@pytest.mark.parametrize("state", ["hidden", "veryHidden"])
def test_a_hidden_sheet_is_read_last_and_told(tmp_path: Path, state: str) -> None:
    others = [["designation", "thickness [mm]"], ["old", 9.0]]
    own = written(tmp_path / "own.xlsx", Old=others, Plates=PLATES)
    book = openpyxl.load_workbook(own)
    book["Old"].sheet_state = state
    book.active = 1
    book.save(own)
    table = load_table(own, shipped=False)
    assert (table.designations[0], table.readings) == ("a", ("own.xlsx: sheet Plates",))
    named = load_table(Path(f"{own}#Old"), shipped=False)
    assert (named.designations, named.readings) == (("old",), ("own.xlsx: hidden sheet Old",))


def test_numbers_of_hidden_rows_say_nothing_where_they_are_left_out(tmp_path: Path) -> None:
    rows = [["designation", "mass [kg]"], ["a", "1,5"], ["b", "2.5"], ["c", "3,5"]]
    own = changed(tmp_path / "own.xlsx", rows, hidden=[3])
    assert load_table(Path(f"{own}#rows=visible"), shipped=False).number("mass").tolist() == [1.5, 3.5]
    with pytest.raises(InputError):
        load_table(own, shipped=False)


@pytest.mark.slow
@settings(deadline=None, derandomize=True, max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(hidden=st.sets(st.integers(2, 8)), empty=st.sets(st.integers(2, 8)))
def test_all_rows_are_read_or_told(tmp_path: Path, hidden: set[int], empty: set[int]) -> None:
    filled = set(range(2, 9)) - empty
    rows = [["designation", "mass [kg]"], *([f"r{k}", k] if k in filled else [None, None] for k in range(2, 9))]
    own = changed(tmp_path / "own.xlsx", rows, hidden=sorted(hidden))
    every, shown = (read_table(f"{own}{how}") for how in ("", "#rows=visible"))
    assert {line for line, _ in every.lines()} == filled
    assert {line for line, _ in shown.lines()} == filled - hidden
    for line, cells in (*every.lines(), *shown.lines()):
        assert cells == (f"r{line}", str(line))
    told = re.search(r"with(out)? (\d+) hidden", every.sentence() + shown.sentence())
    assert (int(told[2]) if told else 0) == len(hidden & filled)


@pytest.mark.parametrize("cells", ["B2:B3", "A1:B1", "A4:B4"])
def test_merged_cells_are_refused(tmp_path: Path, cells: str) -> None:
    own = changed(tmp_path / "own.xlsx", PLATES, merged=cells)
    for read in (lambda: load_table(own, shipped=False), lambda: read_table(own).header()):
        with pytest.raises(InputError, match=f"sheet Sheet: got merged cells, {cells}; expected one cell for each"):
            read()


@pytest.mark.parametrize(
    ("cell", "made"),
    [
        (100000, "number"),
        (6205, "number"),
        (1.1, "number"),
        (True, "number"),
        (datetime.datetime(2026, 3, 1), "date"),
        (datetime.date(2026, 3, 1), "date"),
        (datetime.time(1, 30), "date"),
        ("#NAME?", "fault"),
    ],
)
def test_designations_that_are_numbers_or_dates_are_refused(tmp_path: Path, cell: Any, made: str) -> None:
    own = written(tmp_path / "own.xlsx", Own=[["x [-]", "designation"], [1, "a"], [2, cell]])
    with pytest.raises(InputError, match=rf"sheet Own, line 3, column designation: .* has made a {made} of it") as no:
        load_table(own, shipped=False)
    assert no.value.path == (3, "designation")
    assert "set the cell to Text" in no.value.expected


NAMES = ["1E5", "1.10", "1.1", "1,1", "2026-03-01", "100000", "Mar 26", "0042", "1.00E+05"]


def test_designations_that_are_text_stay_as_they_were_typed(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    for k, name in enumerate(["designation", *NAMES], start=1):
        book.active.cell(k, 1).value = name
        book.active.cell(k, 1).data_type = "s"
        book.active.cell(k, 2).value = "x [-]" if k == 1 else k
    own = tmp_path / "own.xlsx"
    book.save(own)
    assert load_table(own, shipped=False).designations == tuple(NAMES)
    text = TableText(reference="own@1", csv=csv_of_file(own))  # as the service keeps it
    assert Catalogs({"plates": text}).table("plates").designations == tuple(NAMES)


@pytest.mark.parametrize("above", [[["Plates of 2026"]], [[]], [["Plates", None, "x"], [], [None, "mm"]]])
def test_titles_above_the_header_are_told(tmp_path: Path, above: list[list[Any]]) -> None:
    own = written(tmp_path / "own.xlsx", Own=[*above, *PLATES])
    with pytest.raises(InputError, match=rf"it stands in line {len(above) + 1}: delete what is above it"):
        load_table(own, shipped=False)


def test_sheets_without_a_table_are_told(tmp_path: Path) -> None:
    own = written(tmp_path / "own.xlsx", Cover=[["ACME"]], Data=[["Stock"], *PLATES])
    right = r"it stands in line 2 of sheet Data: name that sheet \(#Data behind the name\), and delete what is above it"
    with pytest.raises(InputError, match=f"sheet Cover: got no header in the first row; .*{right}"):
        load_table(own, shipped=False)
    with pytest.raises(InputError, match="it stands in line 2: delete what is above it"):
        load_table(Path(f"{own}#Data"), shipped=False)


def test_flags_say_how_all_files_of_a_spec_are_read(tmp_path: Path) -> None:
    changed(tmp_path / "plates.xlsx", PLATES, hidden=[3])
    (tmp_path / "bolts.csv").write_bytes("designation\nčep\n".encode("cp1250"))
    stated = {
        "plates": "plates.xlsx",
        "bolts": "bolts.csv",
        "more": ["+", "plates.xlsx#Sheet", "bolts.csv#encoding=cp1252"],
    }
    assert with_reading_options(stated, tmp_path, "cp1250", True) == {
        "plates": "plates.xlsx#rows=visible",
        "bolts": "bolts.csv#encoding=cp1250",
        "more": ["+", "plates.xlsx#Sheet#rows=visible", "bolts.csv#encoding=cp1252"],
    }
    for folder in (tmp_path, str(tmp_path)):
        own = Catalogs(with_reading_options(folder, Path(), "cp1250", True))
        assert own.table("plates").designations == ("a", "c", "d")
        assert own.table("bolts").designations == ("čep",)
    assert with_reading_options("nothing", tmp_path, "cp1250", True) == "nothing"
