"""Text that acts on nobody's terminal and is nobody's formula, and reads back as it was."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pandas as pd
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import synth
from synth.batches.row_table import read_table
from synth.folders.files import csv_text, frame_csv, yaml_text
from synth.folders.output_folder import save_files
from synth.terminal.console import console_on, plain_table
from synth.text.plain_text import FORMULA, NUMBER, UNSAFE, PlainStream, as_meant, defused, escaped, printable
from tests.sample_problems.rod import Rod

ACTS = "\x1b[2J", "\x9b31m", "\x1b]0;title\x07", "a\rb", "\u202egnp.exe", "\u2066x\u2069", "\x7f", "\ud800", "a\u2028b"
FORMULAS = "=1+1", "+1+1", "-1+1", "@SUM(A1)", "\t=1", "=cmd|' /C calc'!A0", "\uff1d1+1", "-5 mm", "'=1", "''@x"
CELLS = st.text(st.sampled_from("'=+-@\t\r\uff1d0123456789.einfa x"), max_size=8)


@pytest.mark.parametrize("text", ACTS)
def test_what_acts_on_a_terminal_is_written_out(text: str) -> None:
    shown = printable(f"core {text} 4")
    assert not UNSAFE.search(shown)
    assert shown.startswith("core ")
    assert "\\" in shown
    assert printable(shown) == shown
    error = synth.InputError(f"requirement {text}", text, f"no {text}")
    assert not UNSAFE.search(str(error))
    assert not UNSAFE.search(csv_text(["name", text], [[text, 1.0]]))
    assert not UNSAFE.search(frame_csv(pd.DataFrame({text: [text], "x": [1.5]})))


def test_plain_text_stays_as_it_is() -> None:
    text = "Kupplung \u00e4\u00f6\u00fc \u4e2d\u6587 \U0001f600\ttab\nline\r\n\u200d"
    assert printable(text) == text


@pytest.mark.parametrize("text", ACTS)
def test_nothing_shown_acts_on_the_terminal_but_colours_do(text: str) -> None:
    stream = io.StringIO()
    PlainStream(stream).writelines([f"{text}\n", "plain\n"])
    console = console_on(stream, 100)
    table = plain_table(f"name {text}")
    table.add_row(text)
    console.print(table)
    console.print(f"said: {text}", style="bold red")
    assert not UNSAFE.search(stream.getvalue().replace("\n", ""))
    coloured = io.StringIO()
    console = console_on(PlainStream(coloured), 100)
    console._force_terminal, console._color_system = True, None
    console.print(f"said: {text}", style="bold")
    assert not UNSAFE.search(coloured.getvalue().replace("\n", ""))


@pytest.mark.parametrize("text", [*ACTS, *FORMULAS, "plain"])
def test_files_for_programs_read_back_as_they_were(text: str, tmp_path: Path) -> None:
    content = {"parts": {text: [text, "plain"]}, "value": -5.3}
    written = yaml_text(content)
    assert not UNSAFE.search(written)
    assert yaml.safe_load(written) == content
    save_files(tmp_path, {"a.json": json.dumps(content, ensure_ascii=False), "a.svg": f"<svg>{text}</svg>"})
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8")) == content
    for name in ("a.json", "a.svg"):
        assert not UNSAFE.search((tmp_path / name).read_text(encoding="utf-8"))
    assert json.loads(escaped(json.dumps(text, ensure_ascii=False))) == text


@pytest.mark.parametrize("text", FORMULAS)
def test_no_cell_is_a_formula(text: str) -> None:
    (cell,) = next(csv.reader(io.StringIO(csv_text([text], []))))
    assert cell[0] not in "=+-@\t\r\uff1d"
    assert as_meant(cell) == text


@pytest.mark.parametrize("text", ["-5.3", "+1", "-1e-12", "-.5", "-inf", "5", "-", "+", "mass", "'tis", "1-2", ""])
def test_numbers_and_plain_cells_stay(text: str) -> None:
    assert defused(text) == text
    assert as_meant(text) == text


def test_numbers_of_a_table_are_numbers() -> None:
    assert csv_text(["x [mm]"], [[-5.3], [-2], [None], ["-5.3"]]).splitlines() == ["x [mm]", "-5.3", "-2", '""', "-5.3"]
    assert frame_csv(pd.DataFrame({"x": [-5.3], "y": ["=1"]})) == "x,y\n-5.3,'=1\n"


@given(CELLS)
def test_every_cell_reads_back_as_it_was(text: str) -> None:
    cell = defused(text)
    assert as_meant(cell) == text
    assert NUMBER.fullmatch(cell) or len(cell) < 2 or cell[0] == "'" or not FORMULA.match(cell)


# ---- round trips ----------------------------------------------------------------------------------------------------

STEELS = pd.DataFrame({"designation": ["=core", "@S2"], "yield_Re [N/mm2]": [235.0, 300.0]})


def test_a_part_whose_name_begins_like_a_formula_is_found_again(tmp_path: Path) -> None:
    front = synth.synthesize(Rod, {"force": "13 kN"}, catalogs={"metals": STEELS}, parts={"steel": ["=core"]})
    folder = front.save(tmp_path / "out")
    with (folder / "designs.csv").open(newline="") as file:
        row = next(csv.DictReader(file))
    assert row["steel"] == "'=core"
    spec = yaml.safe_load((folder / "design_01.yaml").read_text())
    assert spec["parts"] == {"steel": "=core"}
    # What stands in the table is understood as well where somebody takes it from there.
    for name in ("=core", "'=core"):
        again = synth.evaluate(
            Rod, spec["requirements"], {**spec, "parts": {"steel": name}}, catalogs={"metals": STEELS}
        )
        assert str(again.parts["steel"]) == "=core"
        found = synth.synthesize(Rod, {"force": "13 kN"}, catalogs={"metals": STEELS}, parts={"steel": [name]})
        assert len(found.designs) == len(front.designs)
    assert str(synth.load_front(folder).designs[0].parts["steel"]) == "=core"


def test_cells_that_are_carried_through_a_batch_come_back_as_they_were(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text(csv_text(["id", "force [N]", "=note"], [["@1", 13000, "=1+1"], ["-2", 13500, "\x1b[2J"]]))
    result = synth.batch(
        Rod, rows, tmp_path / "out", catalogs={"metals": STEELS}, fix={"length": "100 mm"}, parts={"steel": ["=core"]}
    )
    for name in ("designs.csv", "rows.csv"):
        raw = (tmp_path / "out" / name).read_text()
        assert not UNSAFE.search(raw)
        with (tmp_path / "out" / name).open(newline="") as file:
            for line in csv.reader(file):
                assert not [cell for cell in line if defused(cell) != cell and not cell.startswith("'")]
    assert set(result.designs()["=note"]) == {"=1+1", "\\x1b[2J"}
    assert set(result.designs()["steel"]) == {"=core"}
    assert list(result.rows()["id"]) == ["@1", "-2"]
    # A table that was written by us is a table of rows again.
    assert read_table(tmp_path / "out" / "rows.csv").header()[-1] == "=note"
