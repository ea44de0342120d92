"""Saved fronts keep what reports need: no question is posed again, and nothing is traced."""

from __future__ import annotations

import io
import json
import shutil

import pytest

import synth
from synth.analysis.reporting import report
from synth.errors import InputError
from synth.model import registry
from synth.model.program import Program
from synth.question.instance import Instance
from synth.results import front_record as records
from synth.results.plain import digest_of
from synth.results.report_request import ReportOptions
from tests.reports.explorer_records import small_front

EVERY = ("html", "explorer", "xlsx", "json", "svg")
pytestmark = pytest.mark.slow


@pytest.fixture
def nothing_posed(monkeypatch):
    """Questions that cannot be posed and families that cannot be traced."""

    def refused(*_, **__):
        raise AssertionError("a question is posed again")

    monkeypatch.setattr(Instance, "__init__", refused)
    monkeypatch.setattr(Program, "__init__", refused)
    registry._shared.cache_clear()


@pytest.fixture
def saved(tmp_path):
    return small_front().save(tmp_path / "out")


def without(folder, *names):
    """Let the record of a front name no such files, as one that was saved before they were kept."""
    path = folder / "front.json"
    content = {k: v for k, v in json.loads(path.read_text()).items() if k not in (*names, "digest")}
    path.write_text(records.record_text(content | {"digest": digest_of(content)}))
    for name in names:
        (folder / f"{name}.json").unlink()


def choices(folder):
    """Texts of the live workbook of the first design."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.load_workbook(io.BytesIO((folder / "design_01_live.xlsx").read_bytes()))
    return {str(cell) for sheet in book for row in sheet.iter_rows(values_only=True) for cell in row}


def test_a_question_is_not_posed_for_a_report(saved, nothing_posed, tmp_path):
    front = synth.load_front(saved)
    front.report(tmp_path / "report", formats=EVERY)
    assert front.explore()._repr_html_()
    names = {path.name for path in (tmp_path / "report").iterdir()}
    assert names >= {"report.html", "explorer.html", "designs.xlsx", "design_01_live.xlsx", "design_01_drawing.svg"}
    assert {"core 2", "core 3"} <= choices(tmp_path / "report")  # all rows that were offered


def test_reports_of_a_saved_front_are_those_of_the_front(saved, tmp_path):
    synth.load_front(saved).report(tmp_path / "a", formats=EVERY)
    small_front().report(tmp_path / "b", formats=EVERY)
    files = sorted((tmp_path / "a").glob("design_*"))
    assert len(files) == 4
    for path in files:
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes(), path.name


def test_own_tables_need_not_be_there(tmp_path, monkeypatch, request):
    tables = tmp_path / "tables"
    tables.mkdir()
    steel = "designation,density [kg/m3],stress_allow [MPa],source,confidence\nown,7850,100,own,user\n"
    (tables / "own_metals.csv").write_text(steel, encoding="utf-8")
    front = synth.synthesize(Strut, {"force": "10 kN"}, catalogs={"own_metals": str(tables / "own_metals.csv")})
    front.save(tmp_path / "out")
    shutil.rmtree(tables)
    request.getfixturevalue("nothing_posed")
    how = ReportOptions.read(EVERY)
    written = report(synth.load_front(tmp_path / "out"), tmp_path / "r", how, problem=Strut)
    assert [note for note in written.notes if "own_metals" in note]
    assert "own" in choices(tmp_path / "r")


def test_a_front_of_before_rows_were_kept_has_a_report(saved, tmp_path):
    without(saved, "offered")
    front = synth.load_front(saved)
    assert front.kept.keys() == {"calculation"}
    front.report(tmp_path / "report", formats=["xlsx"])
    assert {"core 2", "core 3"} <= choices(tmp_path / "report")
    assert front.verify().holds


def test_rows_of_another_front_are_refused_and_found_out(saved, tmp_path):
    path = saved / "offered.json"
    path.write_text(path.read_text().replace("core 2", "core 9"))
    front = synth.load_front(saved)
    with pytest.raises(InputError, match=r"offered.json"):
        front.report(tmp_path / "report", formats=["xlsx"])
    assert any("offered.json" in finding for finding in front.verify().findings)


def test_a_front_that_was_loaded_saves_the_same_files(saved, tmp_path):
    again = synth.load_front(saved).save(tmp_path / "again")
    for path in saved.iterdir():
        if path.name != "front.json":  # which names the versions of now
            assert path.read_bytes() == (again / path.name).read_bytes(), path.name


class Strut(synth.DesignProblem):
    """A strut of a metal from a table of one's own."""

    name, title = "strut_of_own", "Strut"

    def declare(self, d):
        """Declare it."""
        force = d.requirement("force", "N")
        diameter = d.variable("diameter", "mm", 1, 100)
        metal = d.part("metal", "own_metals")
        d.at_most("stress", force / (0.785398 * diameter**2), metal.stress_allow, "MPa")
        d.objective("diameter")
