"""Tables: strict shipped files, forgiving user tables, replacement and extension."""

from __future__ import annotations

import codecs
import csv
import os
import re
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import synth.tables.catalogs
from synth.errors import InputError
from synth.tables.catalogs import Catalogs, shipped_folders
from synth.tables.reading import load_table, table_from_frame
from synth.tables.schema import Column, Schema, load_schema
from synth.tables.table import Table
from synth.units import parse_quantity
from tests.units.test_units import SPELLINGS

QUICK = settings(deadline=None, derandomize=True, max_examples=100)
CATALOGS = Path(__file__).parents[2] / "catalogs"

SCHEMA = """column,type,unit,minimum,maximum,required,symbol,description
designation,text,,,,1,,unique name
p_allow,number,N/mm2,0.01,50,1,p,allowed pressure
mass,number,kg,0,10,0,m,mass
teeth,integer,-,3,200,0,z,number of teeth
crowned,flag,,0,1,0,,1 = crowned
note,text,,,,0,,remarks
source,text,,,,1,,where the figures come from
confidence,text,,,,1,,how sure
"""
HEAD = "designation,p_allow [N/mm2],mass [kg],teeth [-],crowned,note,source,confidence\n"
ROWS = 'a,0.4,1.5,12,0,"with, comma",book 1,typical\nb,2,,,1,,book 2,verified\n'


@pytest.fixture
def shipped(tmp_path: Path) -> Path:
    folder = tmp_path / "shipped"
    folder.mkdir()
    (folder / "parts.csv").write_text(HEAD + ROWS, encoding="utf-8")
    (folder / "parts.schema.csv").write_text(SCHEMA, encoding="utf-8")
    return folder


def rewrite(folder: Path, text: str | bytes) -> Path:
    path = folder / "parts.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def user(tmp_path: Path, text: str, name: str = "mine.csv") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8", newline="")
    return path


# ---- shipped --------------------------------------------------------------------------------------------------------


def test_a_shipped_table(shipped: Path) -> None:
    table = load_table(shipped / "parts.csv")
    assert table.name == "parts"
    assert table.origin == "shipped"
    assert len(table) == 2
    assert table.designations == ("a", "b")
    assert list(table.columns) == ["designation", "p_allow", "mass", "teeth", "crowned", "note", "source", "confidence"]
    assert table.number("p_allow").tolist() == [4e5, 2e6]
    assert table.number("p").tolist() == [4e5, 2e6]
    assert np.isnan(table.number("mass")[1])
    assert table.text("note") == ("with, comma", "")
    assert table.row(1) == {
        "designation": "b",
        "p_allow": 2e6,
        "mass": None,
        "teeth": None,
        "crowned": 1.0,
        "note": None,
        "source": "book 2",
        "confidence": "verified",
    }
    assert not table.user_rows.any()
    assert table.has("mass")
    assert table.has("m")
    assert not table.has("volume")
    assert table.row_index("b") == 1
    assert table.column("p_allow").maximum == 50
    assert "parts: 2 rows" in repr(table)
    with pytest.raises(ValueError, match="read-only"):
        table.number("p_allow")[0] = 1.0


def test_wrong_names_are_answered_with_close_ones(shipped: Path) -> None:
    table = load_table(shipped / "parts.csv")
    with pytest.raises(InputError, match="perhaps p_allow"):
        table.number("p_alow")
    with pytest.raises(InputError, match="this one is text"):
        table.number("note")
    with pytest.raises(InputError, match="this one has numbers"):
        table.text("mass")
    with pytest.raises(InputError, match="a designation of this table, perhaps a"):
        table.row_index("A")


def test_crlf_and_a_byte_order_mark_change_nothing(shipped: Path) -> None:
    plain = load_table(shipped / "parts.csv")
    other = load_table(rewrite(shipped, codecs.BOM_UTF8 + (HEAD + ROWS).replace("\n", "\r\n").encode()))
    assert other.hashes == plain.hashes
    assert other.row(0) == plain.row(0)


@pytest.mark.parametrize(
    ("old", "new", "field", "expected"),
    [
        ("0.4,", "much,", "parts.csv, line 2, column p_allow", "a number"),
        ("0.4,", '"0,4",', "parts.csv, line 2, column p_allow", "decimal point instead of a decimal comma"),
        ("0.4,", "nan,", "parts.csv, line 2, column p_allow", "a finite number"),
        ("0.4,", "0.4 N/mm2,", "parts.csv, line 2, column p_allow", "without a unit"),
        ("0.4,", ",", "parts.csv, line 2, column p_allow", "a value: allowed pressure"),
        ("0.4,", " 0.4,", "parts.csv, line 2, column p_allow", "without blanks at its ends"),
        ("b,2,", "b,51,", "parts.csv, line 3, column p_allow", "0.01 .. 50 N/mm2"),
        ("b,2,", "b,0.001,", "parts.csv, line 3, column p_allow", "0.01 .. 50 N/mm2"),
        (",12,", ",12.5,", "parts.csv, line 2, column teeth", "a whole number"),
        (",1,,book", ",2,,book", "parts.csv, line 3, column crowned", "0 or 1"),
        ("b,2", "a,2", "parts.csv, line 3, column designation", "a name of its own (it stands in parts.csv, line 2"),
        ("b,2", '"b;c",2', "parts.csv, line 3, column designation", "without semicolon or line break"),
        ("b,2", ",2", "parts.csv, line 3, column designation", "a value"),
        ("book 2", "", "parts.csv, line 3, column source", "where the figures come from"),
        ("verified", "sure", "parts.csv, line 3, column confidence", "one of verified"),
        (",12,", ",", "parts.csv, line 2", "8 cells as in the header"),
        ('"with, comma"', "with, comma", "parts.csv, line 2", "quotes around a text that has a comma"),
        ("p_allow [N/mm2]", "p_allow", "parts.csv, line 1, column p_allow", "the unit of the schema: p_allow [N/mm2]"),
        ("p_allow [N/mm2]", "p_allow [bar]", "parts.csv, line 1, column p_allow", "the unit of the schema"),
        ("p_allow [N/mm2]", "p_alow [N/mm2]", "parts.csv, line 1, column p_alow", "the schema has no 'p_alow'"),
        ("mass [kg],teeth [-]", "teeth [-],mass [kg]", "parts.csv, line 1, column teeth", "the order of the schema"),
        ("mass [kg]", "p_allow [N/mm2]", "parts.csv, line 1", "each column once"),
        ("confidence\n", "confidence,more\n", "parts.csv, line 1", "no column that the schema does not have"),
        ("source,confidence\n", "source\n", "parts.csv, line 1, column confidence", "confidence"),
        ('"with, comma"', '"with, comma', "parts.csv, line", "quotes that close"),
        (ROWS, "", "parts.csv", "at least one row below the header"),
        (HEAD + ROWS, "", "parts.csv", "a header row"),
        (HEAD, HEAD.replace(",", ";"), "parts.csv, line 1", "separated by commas"),
        (HEAD, HEAD.replace(",", "\t"), "parts.csv, line 1", "separated by commas"),
    ],
)
def test_faults_of_a_shipped_table(shipped: Path, old: str, new: str, field: str, expected: str) -> None:
    text = HEAD + ROWS
    assert old in text
    with pytest.raises(InputError) as caught:
        load_table(rewrite(shipped, text.replace(old, new, 1)))
    assert caught.value.field.startswith(field)
    assert expected in caught.value.expected


def test_tables_of_ours_are_in_no_other_encoding(shipped: Path) -> None:
    text = (HEAD + ROWS).replace("with", "groß")
    for encoding, told in (("latin-1", "Windows-1252"), ("utf-16", "UTF-16")):
        with pytest.raises(InputError, match=rf"parts.csv, line 1: .*{told}.*UTF-8"):
            load_table(rewrite(shipped, text.encode(encoding)))


def test_files_that_cannot_be_read(shipped: Path) -> None:
    with pytest.raises(InputError, match="a CSV file that exists"):
        load_table(shipped / "other.csv", shipped=False)
    with pytest.raises(InputError, match="can be read"):
        load_table(shipped, shipped=False)
    with pytest.raises(InputError, match="can be read"):
        load_table("a\0b.csv", shipped=False)
    (shipped / "parts.schema.csv").unlink()
    with pytest.raises(InputError, match="exists"):
        load_table(shipped / "parts.csv")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("column,type", "col,type", "column,type,unit"),
        ("p_allow,number", "p allow,number", "letters, digits and underscores"),
        ("p_allow,number", "p_allow,real", "one of text, number"),
        ("N/mm2", "newtons", "a known unit"),
        ("N/mm2", "", "a unit"),
        ("0.01,50", "50,0.01", "less than the maximum"),
        ("0.01,50", "x,50", "a number"),
        ("50,1,p", "50,yes,p", "0 or 1"),
        (",m,mass", ",p,mass", "a symbol that is not used yet"),
        ("mass,number", "p_allow,number", "a name that is not used yet"),
        ("how sure", "", "one line of meaning"),
        ("note,text,,,", "note,text,mm,,", "no unit for a column of text"),
        ("note,text,,,", "note,text,,1,", "an empty cell"),
        ("how sure", "how sure,x", "8 cells"),
        ("number,kg", "number,column:nowhere", "the name of a text column"),
    ],
)
def test_faults_of_a_schema(shipped: Path, old: str, new: str, expected: str) -> None:
    assert old in SCHEMA
    path = shipped / "parts.schema.csv"
    path.write_text(SCHEMA.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_schema(path)
    assert expected in caught.value.expected
    assert caught.value.field.startswith("parts.schema.csv")


def test_a_unit_in_a_column_leaves_the_numbers_as_given(tmp_path: Path) -> None:
    head = "column,type,unit,minimum,maximum,required,symbol,description\n"
    rows = "quantity,text,,,,1,,q\nunit,text,,,,1,,u\nvalue,number,column:unit,0,1000,1,,v\n"
    rows += "source,text,,,,1,,s\nconfidence,text,,,,1,,c\n"
    user(tmp_path, head + rows, "data.schema.csv")
    table = load_table(
        user(tmp_path, "quantity,unit,value,source,confidence\nd,mm,20,book,typical\nd,h,1,book,typical\n", "data.csv")
    )
    assert table.number("value").tolist() == [20.0, 1.0]
    assert table.designations == ()
    with pytest.raises(InputError, match="a table with designations"):
        table.row_index("d")


# ---- users' tables --------------------------------------------------------------------------------------------------


def test_a_users_table_is_met_with_defaults(shipped: Path, tmp_path: Path) -> None:
    path = user(tmp_path, "lot,designation,p_allow [bar],hardness [N/mm2],mass\nL1, x ,4,900,1.5\n,y,,,\n,,,,\n")
    table = Catalogs({"parts": path}, folders=[shipped]).table("parts")
    assert table.origin == "mine.csv"
    assert table.designations == ("x", "y")
    assert table.number("p_allow").tolist()[0] == 4e5
    assert np.isnan(table.number("p_allow")[1])
    assert table.number("mass")[0] == 1.5
    assert table.number("hardness")[0] == 9e8
    assert table.text("lot") == ("L1", "")
    assert not table.has("teeth")
    assert table.text("source") == ("mine.csv", "mine.csv")
    assert table.text("confidence") == ("user", "user")
    assert table.user_rows.all()
    assert table.column("p_allow").unit == "N/mm2"


@pytest.mark.parametrize(
    ("text", "field", "expected"),
    [
        ("designation,p_allow [J]\nx,4\n", "mine.csv, line 1, column p_allow", "a pressure or stress"),
        ("designation,p_allow [Bar]\nx,4\n", "mine.csv, line 1, column p_allow", "bar instead of Bar"),
        ("designation,p_allow [bar]\nx,501\n", "mine.csv, line 2, column p_allow", "0.01 .. 50 N/mm2"),
        ("designation,P Allow [bar]\nx,4\n", "mine.csv, line 1, column P Allow", "the spelling p_allow"),
        ("designation,note [mm]\nx,4\n", "mine.csv, line 1, column note", "without a unit"),
        ("designation,extra [parsec]\nx,4\n", "mine.csv, line 1, column extra", "a known unit"),
        ("designation,p_allow [bar\nx,4\n", "mine.csv, line 1", "its unit in brackets"),
        ("designation,,mass\nx,4,1\n", "mine.csv, line 1, column 2", "a name in every cell"),
        ("designation,mass,mass [g]\nx,1,1\n", "mine.csv, line 1, column mass", "each column once"),
        ("name,mass\nx,1\n", "mine.csv, header", "a column designation"),
        ("designation,mass\nx,1\nx,2\n", "mine.csv, line 3, column designation", "a name of its own"),
        ("designation,mass\n,1\n", "mine.csv, line 2, column designation", "a unique name"),
        ("designation,mass\nx\n", "mine.csv, line 2", "2 cells"),
        ("designation;mass\nx;1,234\n", "mine.csv, line 2, column mass", "1.234 or 1234"),
        ("designation;mass\nx;1,5\ny;2.5\n", "mine.csv, line 2, column mass", "decimal comma"),
        ('designation,mass\nx,"1,5"\n', "mine.csv, line 2, column mass", "decimal comma"),
        ('designation,note,mass\nx,"two\nlines",1\ny,,"1,5"\n', "mine.csv, line 4, column mass", "decimal comma"),
        ("designation,mass\n\n", "mine.csv", "at least one row"),
    ],
)
def test_faults_of_a_users_table(shipped: Path, tmp_path: Path, text: str, field: str, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        Catalogs({"parts": str(user(tmp_path, text))}, folders=[shipped]).table("parts")
    assert caught.value.field.startswith(field)
    assert expected in caught.value.expected


def test_a_table_without_schema_is_inferred(tmp_path: Path) -> None:
    table = load_table(user(tmp_path, "designation,bore [cm],grade,,\nx,4,90,,\n"), shipped=False)
    assert table.number("bore").tolist() == [0.04]
    assert table.text("grade") == ("90",)
    assert list(table.columns) == ["designation", "bore", "grade", "source", "confidence"]


def test_a_data_frame(shipped: Path) -> None:
    frame = pd.DataFrame(
        {
            "designation": [6205, 6206],
            "p_allow [bar]": [4.0, np.nan],
            "teeth": pd.array([12, None], dtype="Int64"),
            "crowned": [True, False],
            "note": pd.array(["text", None], dtype="string"),
        }
    )
    catalogs = Catalogs({"parts": frame}, folders=[shipped])
    table = catalogs.table("parts")
    assert table.designations == ("6205", "6206")
    assert table.number("p_allow")[0] == 4e5
    assert table.number("teeth")[0] == 12
    assert np.isnan(table.number("teeth")[1])
    assert table.number("crowned").tolist() == [1.0, 0.0]
    assert table.text("note") == ("text", "")
    assert table.text("source") == ("DataFrame", "DataFrame")
    indexed = table_from_frame(frame.set_index("designation"), catalogs.schema("parts"), name="parts")
    assert indexed.hashes == table.hashes


@pytest.mark.parametrize(
    ("cell", "says"),
    [
        ("2026-03-01", "has made a date of it"),
        ("01.03.2026", "has made a date of it"),
        ("Mar 26", "has made a date of it"),
        ("1. Mai", "has made a date of it"),
        ("1.1", "has made a number of it"),
        ("1,1", "has made a number of it"),
        ("1.00E+05", "has made a number of it"),
        ("1E+05", "has made a number of it"),
        ("#NAME?", "has made a fault of it"),
        ("#DIV/0!", "has made a fault of it"),
        ("####", "has made a fault of it"),
    ],
)
@pytest.mark.parametrize("mark", [",", ";"])
def test_designations_that_a_table_program_has_made_are_refused(
    tmp_path: Path, cell: str, says: str, mark: str
) -> None:
    own = tmp_path / "own.csv"
    shown = f'"{cell}"' if mark in cell else cell
    own.write_text(f"designation{mark}mass [kg]\na{mark}1\n{shown}{mark}2\n", encoding="utf-8")
    with pytest.raises(InputError, match=says) as caught:
        load_table(own, shipped=False)
    assert caught.value.field == "own.csv, line 3, column designation"
    assert "set the cell to Text" in caught.value.expected
    if "fault" not in says:
        own.write_text(own.read_text().replace(cell, f"'{cell}"), encoding="utf-8")
        assert load_table(own, shipped=False).designations == ("a", cell)


@pytest.mark.parametrize("cell", ["6205", "1E5", "1.10", "0042", "core 1.1", "M8", "A-1", "'tis", "1.5 mm", "№ 3", "-"])
def test_other_designations_stay_as_they_are(tmp_path: Path, cell: str) -> None:
    own = tmp_path / "own.csv"
    own.write_text(f"designation,mass [kg]\n{cell},2\n", encoding="utf-8")
    assert load_table(own, shipped=False).designations == (cell,)


def test_decimal_commas_in_designations_are_part_of_the_name(tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_text("designation;mass [kg]\n1,10;1,5\n1,20;2,5\n", encoding="utf-8")
    table = load_table(own, shipped=False)
    assert (table.designations, table.number("mass").tolist()) == (("1,10", "1,20"), [1.5, 2.5])


@pytest.mark.parametrize("above", ["Plates of 2026\n", "\n", "Plates,,\n,,\n,mm,\n"])
def test_titles_above_the_header_are_told(tmp_path: Path, above: str) -> None:
    own = tmp_path / "own.csv"
    own.write_text(f"{above}designation,mass [kg],x [-]\na,1,2\n", encoding="utf-8")
    line = above.count("\n") + 1
    with pytest.raises(
        InputError, match=f"the header in the first line; it stands in line {line}: delete what is above"
    ):
        load_table(own, shipped=False)


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        (pd.DataFrame({"designation": ["x"], "mass": [float("inf")]}), "a finite number"),
        (pd.DataFrame({"designation": ["x"], "mass": ["much"]}), "a number"),
        (pd.DataFrame({"designation": ["x"], "mass": [True]}), "a number"),
        (pd.DataFrame({"designation": ["x"], "mass": [[1.0]]}), "a number"),
        (pd.DataFrame({"designation": ["x"], "mass": [10**400]}), "a finite number"),
        (pd.DataFrame({"designation": ["x"], "note": [pd.Timestamp(0)]}), "text"),
        (pd.DataFrame({"designation": ["x"], "note": [10**400]}), "text"),
        (pd.DataFrame({"designation": [1.1]}), "has made a number of it"),
        (pd.DataFrame({"designation": [pd.Timestamp(0)]}), "has made a date of it"),
        (pd.DataFrame({"designation": ["x"], 5: [1.0]}), "a name in every cell"),
        (pd.DataFrame({"designation": []}), "at least one row"),
        (pd.DataFrame(), "at least one row"),
        (pd.DataFrame({"mass": [1.0]}), "a column designation"),
    ],
)
def test_faults_of_a_data_frame(shipped: Path, frame: pd.DataFrame, expected: str) -> None:
    with pytest.raises(InputError) as caught:
        Catalogs({"parts": frame}, folders=[shipped]).table("parts")
    assert expected in caught.value.expected


def test_hashes_see_content_only(shipped: Path, tmp_path: Path) -> None:
    table = load_table(shipped / "parts.csv")
    schema = load_schema(shipped / "parts.schema.csv")
    other = user(
        tmp_path,
        "confidence,source,note,mass [g],crowned,teeth,p_allow [bar],designation\n"
        'verified,book 2,,,1,,20.0,b\ntypical,book 1,"with, comma",1500,0,12.0,4,a\n',
    )
    assert load_table(other, schema, shipped=False).hashes == table.hashes[::-1]
    assert table.hashes[0] != table.hashes[1]
    changed = load_table(rewrite(shipped, (HEAD + ROWS).replace("1.5", "1.6")))
    assert changed.hashes[0] != table.hashes[0]
    assert changed.hashes[1] == table.hashes[1]


def test_select_and_to_frame(shipped: Path) -> None:
    table = load_table(shipped / "parts.csv")
    second = table.select(table.number("crowned") == 1)
    assert second.designations == ("b",)
    assert second.hashes == table.hashes[1:]
    assert table.select([1, 0]).designations == ("b", "a")
    assert len(table.select([])) == 0
    frame = table.to_frame()
    assert list(frame.columns) == HEAD.strip().split(",")
    assert frame["p_allow [N/mm2]"].tolist() == [0.4, 2.0]
    assert frame["note"].tolist() == ["with, comma", None]
    again = table_from_frame(frame, load_schema(shipped / "parts.schema.csv"))
    assert again.hashes == table.hashes


# A denormal number has too few digits left to be converted and back.
NORMAL = st.just(0.0) | st.floats(1e-9, 1e9) | st.floats(-1e9, -1e-9)
SMALL = Schema((Column("designation", "text"), Column("size", "number", "mm"), Column("speed", "number", "1/min")))


@QUICK
@given(st.lists(st.tuples(NORMAL, st.none() | NORMAL), min_size=1, max_size=5))
def test_a_frame_survives_the_round_trip(rows: list[tuple[float, float | None]]) -> None:
    frame = pd.DataFrame(
        {
            "designation": [f"r{i}" for i in range(len(rows))],
            "size [mm]": [size for size, _ in rows],
            "speed [1/min]": pd.Series([speed for _, speed in rows], dtype=float),
        }
    )
    table = table_from_frame(frame, SMALL)
    again = table_from_frame(table.to_frame(), SMALL)
    np.testing.assert_allclose(again.number("size"), table.number("size"), rtol=5e-16)
    np.testing.assert_allclose(again.number("speed"), table.number("speed"), rtol=5e-16)


@pytest.mark.parametrize(("declared", "ours", "spelled"), [*SPELLINGS, ("mm", "mm", "mm"), ("l/min", "m3/h", "m3/h")])
def test_a_heading_may_have_its_unit_as_a_name_plate(tmp_path: Path, declared: str, ours: str, spelled: str) -> None:
    schema = Schema((Column("designation", "text"), Column("x", "number", declared)))
    for typed in (word.replace("_", " ") for word in spelled.split(" ")):
        with (tmp_path / "own.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([["designation", f"x [{typed}]"], ["a", "3"]])
        table = load_table(tmp_path / "own.csv", schema, shipped=False)
        assert table.number("x")[0] == parse_quantity(f"3 {ours}", declared, "x"), typed


@pytest.mark.parametrize(
    ("declared", "typed", "right"),
    [
        ("N*m", "kgm", "kgf*m instead of kgm"),
        ("N/mm2", "kg/cm2", "kgf/cm2 instead of kg/cm2"),
        ("l/min", "gpm", "US gpm instead of gpm"),
        ("kg*m2", "GD2", "J = GD2/4"),
    ],
)
def test_a_heading_of_which_two_units_may_be_meant_is_refused(declared: str, typed: str, right: str) -> None:
    schema = Schema((Column("designation", "text"), Column("x", "number", declared)))
    with pytest.raises(InputError, match=re.escape(right)):
        table_from_frame(pd.DataFrame({"designation": ["a"], f"x [{typed}]": [3.0]}), schema)


# ---- catalogues -----------------------------------------------------------------------------------------------------


def test_shipped_catalogues(shipped: Path) -> None:
    catalogs = Catalogs(folders=[shipped])
    assert catalogs.names() == ("parts",)
    assert catalogs.added == ()
    assert catalogs.table("parts") is catalogs.table("parts")
    assert catalogs.schema("other") is None
    with pytest.raises(InputError, match="one of parts"):
        catalogs.table("other")


def test_an_edited_shipped_file_is_read_again(shipped: Path) -> None:
    assert Catalogs(folders=[shipped]).table("parts").number("p_allow")[0] == 4e5
    path = rewrite(shipped, (HEAD + ROWS).replace("0.4", "0.5"))
    path_time = path.stat().st_mtime_ns + 1_000_000
    os.utime(path, ns=(path_time, path_time))
    assert Catalogs(folders=[shipped]).table("parts").number("p_allow")[0] == 5e5


def test_extension(shipped: Path, tmp_path: Path) -> None:
    more = user(tmp_path, "designation,p_allow [bar],lot\nx,4,L1\n")
    frame = pd.DataFrame({"designation": ["y"], "mass [g]": [500.0]})
    table = Catalogs({"parts": ["+", "mine.csv", frame]}, folders=[shipped], base=more.parent).table("parts")
    assert table.designations == ("a", "b", "x", "y")
    assert table.number("p_allow")[:3].tolist() == [4e5, 2e6, 4e5]
    assert np.isnan(table.number("p_allow")[3])
    assert table.number("mass")[3] == 0.5
    assert table.text("lot") == ("", "", "L1", "")
    assert table.user_rows.tolist() == [False, False, True, True]
    assert table.origin == "shipped + mine.csv + DataFrame"
    assert table.labels[2] == "mine.csv, line 2"
    assert table.text("confidence")[2:] == ("user", "user")
    assert table.hashes[:2] == load_table(shipped / "parts.csv").hashes


@pytest.mark.parametrize(
    ("more", "expected"),
    [(["a,1\n"], "stands in parts.csv, line 2"), (["x,1\n", "x,2\n"], "stands in mine0.csv, line 2")],
)
def test_extension_refuses_a_designation_twice(shipped: Path, tmp_path: Path, more: list[str], expected: str) -> None:
    paths = [user(tmp_path, f"designation,mass\n{rows}", f"mine{i}.csv") for i, rows in enumerate(more)]
    with pytest.raises(InputError) as caught:
        Catalogs({"parts": ["+", *paths]}, folders=[shipped]).table("parts")
    assert expected in caught.value.expected


def test_extension_refuses_a_column_of_another_kind(shipped: Path, tmp_path: Path) -> None:
    one = user(tmp_path, "designation,lot [mm]\nx,1\n", "one.csv")
    for head in ("lot [kg]", "lot"):
        two = user(tmp_path, f"designation,{head}\ny,1\n", "two.csv")
        with pytest.raises(InputError, match="column lot"):
            Catalogs({"parts": ["+", one, two]}, folders=[shipped]).table("parts")


def test_a_folder_replaces_tables_of_its_names(shipped: Path, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    user(folder, "designation,mass [g]\nx,500\n", "parts.csv")
    user(folder, "designation,bore [mm],hole\nx,5,6\n", "rings.csv")
    schema = "column,type,unit,minimum,maximum,required,symbol,description\n"
    schema += "designation,text,,,,1,,n\nhole,number,mm,,,0,D_h,h\n"
    user(folder, schema, "rings.schema.csv")
    for spec in ("mine", folder):
        catalogs = Catalogs(spec, folders=[shipped], base=tmp_path)
        assert catalogs.names() == ("parts", "rings")
        assert catalogs.added == ("rings",)
        assert catalogs.table("parts").number("mass").tolist() == [0.5]
        assert catalogs.table("rings").number("bore").tolist() == [0.005]
        assert catalogs.table("rings").number("D_h").tolist() == [0.006]


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("nowhere", "a folder that exists"),
        ("a\0b", "a folder that exists"),
        ("empty", "a folder with CSV files"),
        (5, "a folder, or a mapping"),
        (["+", "x.csv"], "a folder, or a mapping"),
        ({5: "x.csv"}, "the name of a table"),
        ({"parts": 5}, "a CSV path, a DataFrame"),
        ({"parts": None}, "a CSV path, a DataFrame"),
        ({"parts": ["+"]}, "['+', 'more.csv']"),
        ({"parts": ["x.csv"]}, "['+', 'more.csv']"),
        ({"parts": ["+", 5]}, "a CSV path, a DataFrame"),
        ({"part": ["+", "x.csv"]}, "a shipped table to extend, perhaps parts"),
    ],
)
def test_faults_of_a_specification(shipped: Path, tmp_path: Path, spec: object, expected: str) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError) as caught:
        Catalogs(spec, folders=[shipped], base=tmp_path)
    assert expected in caught.value.expected


def test_one_shipped_table_of_a_name(shipped: Path) -> None:
    with pytest.raises(InputError, match="one shipped table of a name"):
        Catalogs(folders=[shipped, shipped])


def test_discovery_finds_packages_without_importing_them(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    package = tmp_path / "own_catalogs"
    package.mkdir()
    (package / "__init__.py").write_text("raise RuntimeError('imported')", encoding="utf-8")
    user(package, HEAD + ROWS, "parts.csv")
    user(package, SCHEMA, "parts.schema.csv")
    monkeypatch.syspath_prepend(tmp_path)
    points = [EntryPoint(name, "own_catalogs", synth.tables.catalogs.ENTRY_POINTS) for name in ("one", "again")]
    monkeypatch.setattr(synth.tables.catalogs, "installed", lambda group: points)
    assert shipped_folders() == (package.resolve(),)
    assert Catalogs().names() == ("parts",)
    assert "own_catalogs" not in sys.modules
    for gone in ("no_such_package_here", "no_such_package_here.part"):
        points[:] = [EntryPoint("gone", gone, synth.tables.catalogs.ENTRY_POINTS)]
        with pytest.raises(InputError, match="an installed package"):
            shipped_folders()


def test_reading_tables_does_not_import_pandas() -> None:
    code = (
        "import sys; from synth.tables.catalogs import Catalogs; import synth.tables.conditions;"
        f"Catalogs(folders=[{str(CATALOGS)!r}]).table('metals').hashes; print('pandas' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=CATALOGS.parent, check=True)
    assert done.stdout.strip() == "False"


def test_every_cell_of_a_random_file_is_read_or_refused(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    pieces = [
        "a",
        "1",
        "0,5",
        "1.5",
        ",",
        ",",
        "\n",
        '"',
        ";",
        "mass",
        "designation",
        " [kg]",
        "[",
        "\ufeff",
        "é",
        "\r",
        "nan",
    ]
    read = 0
    for i in range(300):
        text = "designation,mass [kg]\n" * (i % 2) + "".join(rng.choice(pieces, size=int(rng.integers(1, 12))))
        try:
            table: Table = load_table(user(tmp_path, text), SMALL, shipped=False)
            read += len(table) > 0
        except InputError as error:
            assert error.expected  # noqa: PT017
    assert read > 0
