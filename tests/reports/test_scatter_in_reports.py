"""What is not shown over a range is called so in every report, and nowhere said to hold."""

from __future__ import annotations

import io

import pytest
from synth.reports.explorer.record import explorer_record
from synth.reports.files import report_files

import synth
from synth.results.report_request import ReportOptions, ReportRequest
from tests.sample_problems.scattered_limit import ScatteredLimit, ridged
from tests.terminal.test_report_commands import Page

pytestmark = pytest.mark.slow

NO_PROOF = "no violation was found, from the corners and 4096 samples on, and none is excluded"


@pytest.fixture(scope="module")
def unknown() -> synth.ParetoFront:
    problem = ScatteredLimit(ridged, 4, 1.0)
    return synth.synthesize(problem, problem.needed, robust=problem.block, fix={"factor": "1"})


@pytest.fixture(scope="module")
def request_of(unknown: synth.ParetoFront) -> ReportRequest:
    how = ReportOptions(formats=("html", "xlsx"))
    return ReportRequest(calculation=synth.calculation(unknown), front=unknown, how=how)


def words(text: str) -> str:
    return " ".join(" ".join(Page(text).words).split())


def test_pages_say_that_it_is_not_shown(request_of: ReportRequest) -> None:
    files, *_ = report_files(request_of)
    report, sheet = words(files["report.html"]), words(files["design_01_sheet.html"])
    for page in (report, sheet):
        assert NO_PROOF in page
        assert "Over the range that scatters it is NOT SHOWN to hold; yield 99.9 % (99.9 % to 100 %" in page
        assert "it holds (proven)" not in page
    assert "over the range" in report
    assert "not shown" in report
    rows = sheet[sheet.index("Each limit at its worst point") :]
    assert "not shown sampled" in rows[: rows.index("sampled") + len("sampled")]


def test_workbooks_say_that_it_is_not_shown(request_of: ReportRequest) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    files, *_ = report_files(request_of)
    books = {name: openpyxl.load_workbook(io.BytesIO(files[name])) for name in ("designs.xlsx", "design_01_live.xlsx")}
    heads, first, *_ = books["designs.xlsx"]["designs"].iter_rows(min_row=4, values_only=True)
    design = dict(zip(heads, first, strict=True))
    assert design["robust"] == "not shown"
    assert design["yield"] < 1
    texts = [
        str(cell) for sheet in books["design_01_live.xlsx"] for row in sheet.iter_rows(values_only=True) for cell in row
    ]
    assert any("NOT SHOWN to hold" in text for text in texts)


def test_the_explorer_and_notebooks_say_that_it_is_not_shown(
    unknown: synth.ParetoFront, request_of: ReportRequest
) -> None:
    record = explorer_record(request_of)
    own = record["designs"][0]["robust"]
    assert own["verdict"] == "not shown"
    assert own["yield"] < 100
    assert "NOT SHOWN to hold" in own["words"]
    assert NO_PROOF in unknown._repr_html_()
