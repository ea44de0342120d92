"""The report of a batch: what it says first, what it tells of rows, and that nothing of a text is done."""

from __future__ import annotations

import io
import json
import re
import shutil
import sqlite3
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest

import synth
from reports.about import About
from reports.batch_report import batch_report, batch_state
from reports.batch_workbook import batch_workbook
from reports.sheet.html import AT_A_TIME, html
from synth.errors import InputError
from synth.jobs.batch import BatchResult
from synth.jobs.batch_report import chosen_row
from synth.results.batch_record import BatchRecord, BatchRow
from tests.analysis.test_calculation import Beam
from tests.jobs.many_rows import multiplied
from tests.reports.browser import chromium, needs_chromium, opened, serious
from tests.terminal.entry import in_process as clutchsynth
from tests.terminal.test_report_commands import Page

HOSTILE = (
    "<script>alert(1)</script>",
    "=cmd()",
    '#read("/etc/passwd")',
    "$x^2$ \\ \" ' ]",
    "\u202eright to left",
    "</table>&lt;",
    "x" * 10000,
)
ROWS = [
    {"name": "first", "mass_carried": "100 kg"},
    {"name": HOSTILE[0], "mass_carried": "200 kg"},
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


def row(line: int, status: str = "optimal", name: str = "", **more: Any) -> BatchRow:
    found = BatchRow(line, "abcdef123456", "beam", status, 0, (None,), "", "", (), "", (name, "5"))
    if status in ("optimal", "feasible"):
        found = replace(found, designs=1, objectives=(float(line),), best="width 5 mm")
    return replace(found, **more)


def record(*rows: BatchRow, state: str = "done") -> BatchRecord:
    headings, settings = ("name", "mass_carried [kg]"), {"objectives": None, "points": 4, "gap": 1e-3, "grid": True}
    return BatchRecord("rows.csv", state, rows, headings, (0,), ("area [mm2]",), settings, {}, {"clutchsynth": "0"})


def data_of(text: str) -> dict[str, Any]:
    found = re.search(r'<script type="application/json" id="all-rows">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    told: dict[str, Any] = json.loads(found[1])
    return told


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
    assert f"{best['modulus [mm3]']:.5g}" in shown
    assert "Limits, the most used first" in shown
    front = synth.synthesize(Beam, {"mass_carried": "100 kg"}, objectives={"width": "min", "height": "min"}, points=4)
    assert f"{len(front.designs)} designs: proven to 0.1 %" in shown


@pytest.mark.parametrize(
    ("named", "head"),
    [("3", "Line 3: <script>"), ("too much", "NO FEASIBLE DESIGN"), (5, "BAD INPUT"), ("name=wrong", "BAD INPUT")],
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


def test_a_name_that_several_rows_have_is_asked_back() -> None:
    same = record(row(2, name="A"), row(3, name="A"), row(4, name="7"), row(5, name="5"))
    with pytest.raises(InputError, match="this fits lines 2, 3"):
        chosen_row(same, "A")
    found = [chosen_row(same, named) for named in ("7", "5", "name = 5", "")]
    assert [x and x.line for x in found] == [4, 5, 5, 2]
    assert chosen_row(record(), "") is None


@pytest.mark.parametrize(
    ("rows", "state", "level", "head"),
    [
        (("optimal", "optimal"), "done", "good", "All rows have designs, proven to 0.1 %"),
        (("optimal",), "done", "good", "The row has designs, proven to 0.1 %"),
        (("optimal", "feasible"), "done", "open", "All rows have designs, not all PROVEN"),
        (("optimal", "refused"), "done", "open", "1 of 2 rows has designs, 1 NOT"),
        (("optimal", "failed"), "done", "bad", "1 row FAILED; 1 of 2 rows has designs"),
        (("infeasible", "bad_input"), "done", "bad", "NO DESIGN: none of 2 rows has one"),
        (("optimal", "not_solved"), "running", "open", "NOT FINISHED: 1 of 2 rows are answered; it is being worked at"),
        (("not_solved",), "cancelled", "open", "NOT FINISHED: 0 of 1 row are answered; it was cancelled"),
    ],
)
def test_states_in_words(rows: tuple[str, ...], state: str, level: str, head: str) -> None:
    told = batch_state(record(*(row(k, status) for k, status in enumerate(rows, start=2)), state=state))
    assert (told.level, told.head) == (level, head)


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


# ---- texts and bytes ------------------------------------------------------------------------------------------------


def hostile() -> BatchRecord:
    rows = [row(2, name=HOSTILE[0])]
    for line, text in enumerate(HOSTILE, start=3):
        rows.append(row(line, "bad_input", text, reason=text, causes=(text,), remarks=text))
    return replace(record(*rows), source=HOSTILE[0], headings=(HOSTILE[1], HOSTILE[5]))


def test_no_text_is_markup_or_code() -> None:
    text = html(batch_report(hostile(), About.of({"project": HOSTILE[0], "note": HOSTILE[2]})))
    assert Page(text).open == []
    assert text.count("<script") == 2  # the rows and what shows them
    told = data_of(text)["rows"]
    assert [cells[1] for cells in told[1:4]] == list(HOSTILE[:3])
    assert told[5][1] == "\\u202eright to left"


def test_hostile_texts_are_texts_of_a_pdf() -> None:
    from reports.files import batch_files

    files, notes = batch_files({"batch": hostile(), "formats": ["pdf"], "fonts": []})
    data = files["report.pdf"]
    assert isinstance(data, bytes)
    assert data.startswith(b"%PDF-1.7")
    assert notes == []


def test_the_workbook_holds_all_rows_as_texts_and_numbers() -> None:
    batch = hostile()
    book = openpyxl.load_workbook(io.BytesIO(batch_workbook(batch, About())))
    assert book.sheetnames == ["summary", "rows", "without a design"]
    assert book["summary"]["A2"].value == "1 of 8 rows has designs, 7 NOT"
    rows = list(book["rows"].iter_rows())
    heads = [cell.value for cell in rows[0]]
    assert heads[:7] == ["line", "row", "family", "state", "designs", "area [mm2]", "best design"]
    assert len(rows) == 1 + len(batch.rows)
    assert (rows[1][0].value, rows[1][5].value) == (2, 2.0)
    assert rows[3][heads.index("why none")].value == "=cmd()"
    assert {cell.data_type for line in rows for cell in line} <= {"s", "n", "inlineStr"}
    assert len(rows[8][heads.index("remarks")].value) == 10000
    assert book["without a design"].max_row == len(batch.rows)


def test_the_same_batch_gives_the_same_bytes(result: BatchResult, tmp_path: Path) -> None:
    for name in ("one", "two"):
        result.report(tmp_path / name, formats=["html", "pdf", "xlsx"])
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert names == ["batch.xlsx", "report.html", "report.pdf"]
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes(), name


@pytest.mark.slow
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


# ---- in a browser ---------------------------------------------------------------------------------------------------


def many() -> BatchRecord:
    rows = [row(line, "bad_input" if line % 10 == 0 else "optimal", f"machine {line}") for line in range(2, 452)]
    return record(*rows)


def test_without_a_script_the_first_rows_are_there() -> None:
    text = html(batch_report(many(), About()))
    assert "The first 200 rows; a browser with scripts shows the others." in text
    assert f"machine {AT_A_TIME + 1}</td>" in text
    assert f"machine {AT_A_TIME + 2}</td>" not in text
    assert len(data_of(text)["rows"]) == 450


@pytest.mark.slow
@needs_chromium
def test_rows_are_chosen_sorted_and_turned(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text(html(batch_report(many(), About())), encoding="utf-8")
    with chromium() as browser, opened(browser, tmp_path / "report.html") as shown:
        page = shown.page

        def told() -> tuple[str, int, str]:
            first = page.locator("#many-rows tbody tr:first-child td:nth-child(2)").inner_text()
            counted = page.locator("#many-rows .counted").inner_text()
            return counted, page.locator("#many-rows tbody tr").count(), first

        before = page.locator("#many-rows tbody").inner_html()
        assert told() == ("1 to 200 of 450 rows", 200, "machine 2")
        page.get_by_role("button", name="Rows after").click()
        assert told() == ("201 to 400 of 450 rows", 200, "machine 202")
        page.get_by_label("State").select_option("bad input")
        assert told() == ("45 rows (of 450)", 45, "machine 10")
        page.get_by_role("button", name="line").click()
        page.get_by_role("button", name="line").click()
        assert told() == ("45 rows (of 450)", 45, "machine 450")
        assert page.locator("#many-rows th").first.get_attribute("aria-sort") == "descending"
        page.get_by_role("button", name="area").click()  # none of these has one: they stay in their order
        assert told()[2] == "machine 10"
        page.get_by_label("State").select_option("")
        page.get_by_label("Text").fill("MACHINE 11")
        assert told() == ("14 rows (of 450)", 14, "machine 11")
        page.get_by_label("Text").fill("")
        page.get_by_role("button", name="line").click()
        assert told()[0] == "1 to 200 of 450 rows"
        # What the script writes is what stands there without it.
        assert page.locator("#many-rows tbody").inner_html() == before
        assert (serious(page), shown.faults, shown.strangers()) == ([], [], [])


@pytest.mark.slow
def test_many_rows_are_read_from_their_database(result: BatchResult, tmp_path: Path) -> None:
    large = multiplied(result.folder, tmp_path / "large", 1000)
    assert clutchsynth("report", large, "--xlsx", "-q").returncode == 0
    told = words(large / "report.html")
    assert "500 of 1 000 rows have designs, 500 NOT" in told
    assert "300 more: see report.html or rows.csv." in told
    book = openpyxl.load_workbook(large / "batch.xlsx", read_only=True)
    assert sum(1 for _ in book["rows"].iter_rows()) == 1001
