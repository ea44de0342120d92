"""The report of a batch that was worked off: what it tells of rows, where it is written, and what it refuses."""

from __future__ import annotations

import re
import shutil
import sqlite3
import sys
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import synth
from synth.batches.batch import BatchResult
from synth.errors import InputError
from synth.text.numbers import page_text
from tests.analysis.test_calculation import Beam
from tests.batches.many_rows import multiplied
from tests.terminal.entry import in_process as clutchsynth
from tests.terminal.test_report_commands import Page

pytestmark = pytest.mark.slow
ROWS = [
    {"name": "first", "mass_carried": "100 kg"},
    {"name": "<script>alert(1)</script>", "mass_carried": "200 kg"},
    {"name": "too much", "mass_carried": "1e9 kg"},
    {"name": "wrong", "mass_carried": "heavy"},
]


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> BatchResult:
    return synth.batch(
        Beam, ROWS, tmp_path_factory.mktemp("batch") / "out", objectives={"width": "min", "height": "min"}, points=4
    )


def words(path: Path) -> str:
    return " ".join(" ".join(Page(path.read_text(encoding="utf-8")).words).split())


def test_it_says_its_state_first_and_why_rows_have_no_design(result: BatchResult, tmp_path: Path) -> None:
    result.report(tmp_path)
    told = words(tmp_path / "report.html")
    assert "2 of 4 rows have designs, 2 NOT" in told
    assert (
        told.index("2 of 4 rows") < told.index("Rows by state") < told.index("All rows") < told.index("Line 2: first")
    )
    reasons = told[told.index("Rows without a design, and why") :]
    assert "line 5, column mass_carried: got 'heavy'" in reasons
    assert "4 too much" in reasons
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert {link[1:] for link in page.links if link.startswith("#")} <= set(page.ids)
    assert not [link for link in page.links if not link.startswith("#")]


def test_a_row_in_full_is_computed_again_as_the_batch_has_found_it(result: BatchResult, tmp_path: Path) -> None:
    result.report(tmp_path, row="first")
    told = words(tmp_path / "report.html")
    best = result.designs().query("name == 'first' and rank == 1").iloc[0]
    shown = told[told.index("Line 2: first") :]
    assert page_text(best["modulus [mm3]"]) in shown
    assert "Limits, the most used first" in shown
    front = synth.synthesize(Beam, {"mass_carried": "100 kg"}, objectives={"width": "min", "height": "min"}, points=4)
    assert f"{len(front.designs)} designs: proven to 0.1 %" in shown


@pytest.mark.parametrize(
    ("named", "head"),
    [("3", "Line 3: <script>"), ("too much", "NOT FEASIBLE"), (5, "BAD INPUT"), ("name=wrong", "BAD INPUT")],
)
def test_any_other_row_is_told_by_line_or_name(result: BatchResult, tmp_path: Path, named: Any, head: str) -> None:
    result.report(tmp_path, row=named)
    assert head in words(tmp_path / "report.html")


@pytest.mark.parametrize("named", ["sixth", "17", "abc"])
def test_a_row_that_is_not_there_is_refused_and_nothing_is_written(
    result: BatchResult, tmp_path: Path, named: str
) -> None:
    done = clutchsynth("report", result.folder, "-o", tmp_path / "new", "--row", named)
    assert done.returncode == 2
    assert done.stderr.strip() == (f"clutchsynth: row: got '{named}'; expected a line from 2 to 5, or a cell of name")
    assert not (tmp_path / "new").exists()


def test_a_batch_under_way_is_reported_as_far_as_it_is(result: BatchResult, tmp_path: Path) -> None:
    shutil.copytree(result.folder, tmp_path / "stopped")
    with closing(sqlite3.connect(tmp_path / "stopped" / "jobs.sqlite")) as database, database:
        database.execute("UPDATE job SET state = 'cancelled'")
        database.execute("DELETE FROM result WHERE status = 'infeasible'")
    done = clutchsynth("report", tmp_path / "stopped", "-q")
    assert done.returncode == 0, done.stderr
    assert "NOT FINISHED: 3 of 4 rows are answered; it was cancelled" in words(tmp_path / "stopped" / "report.html")
    # The problem is no registered one: the command line cannot compute its designs again, and says so.
    assert done.stderr.startswith("clutchsynth: row of line 2: its designs cannot be computed again: ")


def test_a_summary_in_a_folder_below_leads_to_its_database(result: BatchResult, tmp_path: Path) -> None:
    shutil.copytree(result.folder, tmp_path / "out")
    below = tmp_path / "out" / "stopped_1"
    below.mkdir()
    (tmp_path / "out" / "batch.json").rename(below / "batch.json")
    assert clutchsynth("report", below / "batch.json", "-q").returncode == 0
    assert (below / "report.html").is_file()


def test_reports_go_with_their_batch_and_keep_out_of_others(result: BatchResult, tmp_path: Path) -> None:
    out = tmp_path / "out"
    again = synth.batch(Beam, ROWS[:1], out, objectives={"width": "min"}, points=1)
    assert again.report() == out
    assert (out / "report.html").is_file()
    with pytest.raises(InputError, match="this one holds another batch"):
        result.report(out)
    synth.batch(Beam, ROWS[:1], out, objectives={"width": "min"}, points=1)
    assert not (out / "report.html").exists()
    (tmp_path / "front").mkdir()
    (tmp_path / "front" / "front.json").write_text("{}")
    with pytest.raises(InputError, match="another folder"):
        result.report(tmp_path / "front")


@pytest.mark.parametrize("flag", ["--design=1", "--full=2", "--explorer", "--drawing", "--dxf", "--json"])
def test_flags_of_fronts_are_refused(result: BatchResult, flag: str) -> None:
    done = clutchsynth("report", result.folder, flag)
    assert (done.returncode, done.stdout) == (2, "")
    assert "a batch has report.html, --pdf and --xlsx" in done.stderr
    assert done.stderr.count("\n") == 1


def test_rows_belong_to_batches_alone(tmp_path: Path) -> None:
    done = clutchsynth("report", tmp_path, "--row", "2")
    assert (done.returncode, done.stderr) == (
        2,
        "clutchsynth: --row: got '2'; expected the folder of a batch with it\n",
    )


def test_a_batch_without_designs_ends_with_the_code_for_it(tmp_path: Path) -> None:
    synth.batch(Beam, [ROWS[2]], tmp_path / "out", objectives={"width": "min"}, points=1)
    done = clutchsynth("report", tmp_path / "out")
    assert (done.returncode, "written to" in done.stdout) == (3, True)
    assert "NO DESIGN: none of 1 row has one" in words(tmp_path / "out" / "report.html")


def test_the_same_batch_gives_the_same_bytes(result: BatchResult, tmp_path: Path) -> None:
    for name in ("one", "two"):
        result.report(tmp_path / name, formats=["html", "pdf", "xlsx"])
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert names == ["batch.xlsx", "report.html", "report.pdf"]
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes(), name


def test_without_an_extra_what_needs_none_is_written(
    result: BatchResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(InputError, match=re.escape("--xlsx needs the extra excel: pip install 'clutchsynth[excel]'")):
        result.report(tmp_path / "new", formats=["html", "xlsx"])
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["report.html"]
    with pytest.raises(InputError, match="--xlsx needs the extra excel"):
        result.report(tmp_path / "none", formats=["xlsx"])
    with pytest.raises(InputError, match="some of html, pdf, xlsx for a batch"):
        result.report(tmp_path / "none", formats=["docx"])
    assert not (tmp_path / "none").exists()


def test_a_size_range_of_these_rows_stands_in_their_report(result: BatchResult, tmp_path: Path) -> None:
    shutil.copytree(result.folder, tmp_path / "out")
    copied = replace(result, folder=tmp_path / "out")
    synth.size_range(result, 1, objective="width").save(tmp_path / "out" / "range")
    copied.report()
    assert "1 variant serves all rows that have designs" in words(tmp_path / "out" / "report.html")
    assigned = tmp_path / "out" / "range" / "assignment.csv"
    assigned.write_text(re.sub("(?m)^([0-9]+),[0-9a-f]{12}", r"\1,000000000000", assigned.read_text()))
    copied.report()  # of another batch
    assert "Size range" not in words(tmp_path / "out" / "report.html")


def test_many_rows_are_read_from_their_database(result: BatchResult, tmp_path: Path) -> None:
    large = multiplied(result.folder, tmp_path / "large", 1000)
    assert clutchsynth("report", large, "--xlsx", "-q").returncode == 0
    told = words(large / "report.html")
    assert "500 of 1000 rows have designs, 500 NOT" in told
    assert "300 more: see report.html or rows.csv." in told
    book = openpyxl.load_workbook(large / "batch.xlsx", read_only=True)
    assert sum(1 for _ in book["rows"].iter_rows()) == 1001
