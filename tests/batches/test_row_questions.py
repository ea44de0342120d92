"""What rows ask, and what is said of those that ask nothing sensible."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from synth.batches.row_questions import Questioner, ReadRow, canonical_position, read_mapping
from synth.batches.row_table import read_table
from synth.batches.vocabulary import edit_distance
from synth.errors import InputError
from synth.model.registry import families
from synth.units import split_header
from tests.sample_problems.rod import Rod

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "requirements_batch.csv"
SETTINGS = {"objectives": None, "points": 1, "gap": 1e-3, "grid": True, "seed": 0, "time_limit": None}


def questioner(table: Any, problem: Any = Rod, mapping: dict[str, str] | None = None, **common: Any) -> Questioner:
    return Questioner(read_table(table), problem, mapping or {}, SETTINGS, common, None)


def asked(row: dict[str, Any], problem: Any = Rod, **more: Any) -> ReadRow:
    (found,) = questioner([row], problem, **more).rows()
    return found


def fault(row: dict[str, Any], problem: Any = Rod) -> str:
    found = asked(row, problem)
    assert found.question is None
    assert found.key is None
    return "; ".join(x.sentence() for x in found.faults)


GOOD = {"force [kN]": "10", "parts": "steel = S185"}


def test_a_row_becomes_a_question() -> None:
    row = {
        "id": "A",
        "F [kN]": "10",
        "n": "2",
        "D_max": "3 cm",
        "section": "square",
        "length [mm]": 100,
        "z": 2,
        "steel": "",
        "parts": "steel = S185, 42CrMo4",
        "limits": "mass <= 20 kg",
        "fix": "d = 20 mm",
    }
    found = asked(row)
    assert found.faults == ()
    assert found.question == {
        "family": "rod",
        "options": {"section": "square"},
        "requirements": {"diameter_limit": "3 cm", "force": "10 kN", "safety_factor": "2"},
        "limits": {"mass": ["<= 20 kg"]},
        "fix": {"d": "20 mm", "length": "100 mm", "rods": "2"},
        "parts": {"steel": ["S185", "42CrMo4"]},
    }
    assert [column.title for column in questioner([row]).carried] == ["id"]


def test_what_rows_share_is_there_unless_a_row_says_otherwise() -> None:
    table = [{"force": 10, "parts": ""}, {"force": 10, "parts": "steel = 42CrMo4"}]
    found = list(questioner(table, parts={"steel": ["S185"]}, fix={"length": "90 mm"}).rows())
    assert [row.question and row.question["parts"]["steel"] for row in found] == [["S185"], ["42CrMo4"]]
    assert all(row.question and row.question["fix"] == {"length": "90 mm"} for row in found)


def test_a_question_is_known_by_its_content() -> None:
    first, again = asked({**GOOD, "id": 1}), asked({"note": "x", **GOOD})
    other = asked({**GOOD, "force [kN]": "11"})
    assert first.key == again.key != other.key
    assert first.structure == other.structure != asked({**GOOD, "diameter_limit": 40}).structure


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"force [kN]": "6,5"}, "line 2, column force [kN]: got '6,5'; expected a decimal point"),
        ({"force [kN]": "-5"}, "line 2, column force [kN]: got '-5 kN'; expected 1 N to 1000000 N"),
        ({"force [kN]": "5 kg"}, "line 2, column force [kN]: got '5 kg'; expected kgf instead of kg"),
        ({"force [kN]": ""}, "line 2, column force [kN]: is missing; expected a value in N"),
        ({"force [kN]": "ten"}, "line 2, column force [kN]: got 'ten'; expected a number"),
        ({"F": "3"}, "line 2, column F: got '3'; expected each quantity once; column force [kN] gives force too"),
        ({"length [mm]": "5"}, "line 2, column length [mm]: got '5 mm'; expected 10 mm to 1000 mm"),
        ({"rods": "7"}, "line 2, column rods: got '== 7'"),
        ({"steel": "cheese"}, "cheese"),
        ({"section": "flat"}, "line 2, column section: got 'flat'; expected one of round, square"),
        ({"options": "section = round", "section": "round"}, "in one place"),
        ({"options": "colour = red"}, "line 2, column options: got 'colour'; expected an option of rod"),
        ({"parts": "steel = nothing"}, "line 2, column parts: got"),
        ({"parts": "steal = S185"}, "line 2, column parts: got 'steal'"),
        ({"limits": "mass < 3 m"}, "line 2, column limits: got 'mass: 3 m'; expected a mass"),
        ({"limits": "mass"}, "line 2, column limits: got 'mass'; expected entries"),
        ({"limits": "mass < 3; mass > 4"}, "limits that do not exclude each other"),
        ({"fix": "length = 90", "length": "90"}, "in one place"),
    ],
)
def test_faults_name_line_column_and_what_is_right(change: dict[str, str], words: str) -> None:
    assert words in fault({**GOOD, **change})


def test_all_faults_of_a_row_are_told() -> None:
    found = asked({"force": "x", "safety_factor": "y", "limits": "?"})
    assert [x.column for x in found.faults] == ["limits", "force", "safety_factor"]


def test_a_line_with_too_few_cells_is_a_fault(tmp_path: Path) -> None:
    path = tmp_path / "rows.csv"
    path.write_text("force [kN],id\n10,A\n10\n10,B,C\n10,D,\n")
    found = list(questioner(path, parts={"steel": "S185"}).rows())
    assert [[x.sentence()[:22] for x in row.faults] for row in found] == [
        [],
        ["line 3: got '1 cells';"],
        ["line 4: got '3 cells';"],
        [],
    ]


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("forse [kN]", "expected force (or 'forse [kN]: carry' in the mapping"),
        ("saftey_factor", "expected safety_factor"),
        ("load_torqe [N*m]", "expected load_torque"),
        ("familly", "expected family"),
        ("force [kg]", "line 1, column force [kg]: got 'kg'; expected kgf instead of kg"),
        ("section [mm]", "section without a unit"),
        ("limits [kg]", "limits without a unit"),
    ],
)
def test_a_heading_that_cannot_be_meant_stops_the_table(header: str, words: str) -> None:
    column = {header: "10"} if header.startswith("for") else {**GOOD, header: "10"}
    with pytest.raises(InputError, match=re.escape(words)):
        list(questioner([column]).rows())


@pytest.mark.parametrize(
    "header", ["id", "note", "code", "price", "rated_power [kW]", "forse [mm]", "a [b] c", "driver_inertia"]
)
def test_headings_of_ones_own_are_carried_along(header: str) -> None:
    found = questioner([{**GOOD, header: "?"}])
    (row,) = found.rows()
    assert row.faults == ()
    # A setting of simulations is a name too; that this family does not use it is said.
    assert ([c.title for c in found.carried], row.unused) == (
        ([], (header,)) if header == "driver_inertia" else ([header], ())
    )


@pytest.mark.parametrize("above", ["Drives of 2026\n", "\n", "Drives,,\n,,\n,in kN,\n"])
def test_titles_above_the_header_are_told(tmp_path: Path, above: str) -> None:
    path = tmp_path / "rows.csv"
    path.write_text(f"{above}id,Kraft [kN],steel\nA,10,S185\n", encoding="utf-8")
    line = above.count("\n") + 1
    with pytest.raises(
        InputError, match=f"the header in the first line; it stands in line {line}: delete what is above"
    ):
        questioner(path, mapping={"Kraft [kN]": "force"})


def test_first_sheets_without_rows_are_told(tmp_path: Path) -> None:
    book = openpyxl.Workbook()
    book.active.append(["ACME"])
    sheet = book.create_sheet("Drives")
    sheet.append(["force [kN]", "steel"])
    sheet.append([10, "S185"])
    book.save(tmp_path / "rows.xlsx")
    right = r"it stands in line 1 of sheet Drives: name that sheet \(#Drives behind the name\)"
    with pytest.raises(InputError, match=rf"rows.xlsx, line 1: got 'ACME'; .*{right}"):
        questioner(tmp_path / "rows.xlsx")
    (row,) = questioner(f"{tmp_path / 'rows.xlsx'}#Drives").rows()
    assert row.faults == ()


def test_a_heading_beside_the_name_it_resembles_is_another_one() -> None:
    found = questioner([{**GOOD, "length [mm]": "100", "lengths [mm]": "1; 2"}])
    assert [c.title for c in found.carried] == ["lengths [mm]"]
    with pytest.raises(InputError, match="expected length"):
        questioner([{**GOOD, "lengths [mm]": "1; 2"}])


def test_names_that_a_family_does_not_take_are_said() -> None:
    found = asked({**GOOD, "load_torque [N*m]": "3", "mass [kg]": "1", "offset [mm]": ""})
    assert found.unused == ("load_torque [N*m]", "mass [kg]")


@pytest.mark.slow
def test_families_and_their_options_are_checked_row_by_row() -> None:
    base = {"load_torque": "600", "driver_speed": "254", "driven_inertia": "30"}
    table = [
        {**base, "family": "multi_plate_clutch", "lubrication": "dry"},
        {**base, "family": "disc_clutch", "lubrication": "dry"},
        {**base, "family": "multi_plate", "lubrication": ""},
        {**base, "family": "", "lubrication": ""},
    ]
    first, second, third, fourth = questioner(table, None).rows()
    assert first.question is not None
    assert first.question["options"] == {"lubrication": "dry"}
    assert second.unused == ("lubrication",)
    (wrong,) = third.faults
    assert (wrong.line, wrong.column, wrong.value) == (4, "family", "multi_plate")
    assert all(name in wrong.expected for name in families())
    assert fourth.faults[0].value is None
    with pytest.raises(InputError, match=r"line 1, column family: is missing; expected such a column, or one family"):
        questioner([base], None)


def test_refusals_of_a_family_are_told_beforehand() -> None:
    tight = {
        "family": "multi_plate_clutch",
        "load_torque": "600",
        "driver_speed": "254",
        "driven_inertia": "30",
        "hub_bore_diameter": "90 mm",
        "outer_diameter_limit": "100 mm",
    }
    assert "no_room_for_ring" in fault(tight, None)


# ---- mapping --------------------------------------------------------------------------------------------------------


def test_a_mapping_gives_names_to_a_companys_columns(tmp_path: Path) -> None:
    path = tmp_path / "columns.yaml"
    path.write_text("Zugkraft [kN]: force\nSicherheit: safety_factor [-]\nforce: carry\nWerkstoff: parts\n")
    row = {"Zugkraft [kN]": "10", "Sicherheit": "2", "force": "not ours", "Werkstoff": "steel = S185"}
    found = questioner([row], mapping=read_mapping(path))
    (first,) = found.rows()
    assert first.question is not None
    assert first.question["requirements"] == {"force": "10 kN", "safety_factor": "2"}
    assert [c.title for c in found.carried] == ["force"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "lines such as"),
        ("- a\n", "lines such as"),
        ("a: [b]\n", "lines such as"),
        ("Zugkrft [kN]: force\n", "expected Zugkraft"),
        ("Zugkraft [kN]: forse\n", "expected force"),
        ("Zugkraft [kN]: force [m\n", "unit in brackets"),
    ],
)
def test_a_mapping_that_does_not_fit_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "columns.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=re.escape(words)):
        questioner([{"Zugkraft [kN]": "10"}], mapping=read_mapping(path))


# ---- the example ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_example_asks_all_that_registered_families_can_answer() -> None:
    found = questioner(EXAMPLE, None)
    rows = list(found.rows())
    with EXAMPLE.open(encoding="utf-8", newline="") as file:
        written = list(csv.DictReader(file))
    assert len(rows) == len(written) == 200
    for row, line in zip(rows, written, strict=True):
        registered = line["family"] in families()
        assert bool(row.question) is registered, [x.sentence() for x in row.faults]
        assert row.family == line["family"]
        assert registered or [x.column for x in row.faults] == ["family"]
        if line["ramp_time [s]"] and line["family"] == "multi_plate_clutch":
            assert row.question is not None
            assert row.question["fix"] == {"ramp_time": f"{line['ramp_time [s]']} s"}
    known = {split_header(c.title)[0] for c in found.columns} - {split_header(c.title)[0] for c in found.carried}
    assert {"load_torque", "lubrication", "ramp_time", "offset", "driver_inertia", "family"} <= known
    assert {"request_id", "application", "power", "rated_torque", "priority"}.isdisjoint(known)
    assert EXAMPLE.read_bytes() == (ROOT / "catalogs" / "requirements_batch.csv").read_bytes()


# ---- small things ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "distance"), [("", "ab", 2), ("abc", "abc", 0), ("abc", "acb", 2), ("kitten", "sitting", 3)]
)
def test_edit_distance(a: str, b: str, distance: int) -> None:
    assert edit_distance(a, b, 3) == edit_distance(b, a, 3) == distance
    assert edit_distance(a, b, 1) == min(distance, 2)


def test_rows_have_one_order_whatever_their_order() -> None:
    cells = [("R10", "a"), ("R9", "b"), ("R9", "a"), ("r9", "a"), ("R09", "a"), ("", ""), ("R9a", "")]
    order = sorted(cells, key=canonical_position)
    assert order == sorted(reversed(cells), key=canonical_position)
    assert order.index(("R9", "b")) < order.index(("R10", "a"))
    assert len({canonical_position(c) for c in cells}) == len(cells)
