"""The report of a batch as a document: what it says first, its rows in a browser, and that no text is acted on."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import openpyxl
import pytest
from synth.reports.about import About
from synth.reports.batch_report import batch_report, batch_state
from synth.reports.batch_workbook import batch_workbook
from synth.reports.files import batch_files
from synth.reports.sheet.html import AT_A_TIME, html

from synth.batches.batch_report import chosen_row
from synth.errors import InputError
from synth.results.batch_record import BatchRecord, BatchRow
from tests.reports.browser import chromium, needs_chromium, opened, serious
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
    files, notes, _ = batch_files({"batch": hostile(), "formats": ["pdf"], "fonts": []})
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
