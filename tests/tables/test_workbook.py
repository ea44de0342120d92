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

from synth.errors import InputError
from synth.jobs.row_table import read_table
from synth.tables.catalogs import Catalogs
from synth.tables.reading import load_table
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
