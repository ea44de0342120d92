"""Rows are checked by several processes as by one."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from synth.batches import row_checks
from synth.batches.batch import BatchJob
from synth.batches.row_checks import Lines, RowChecker, check_lines
from synth.batches.row_questions import ReadRow
from synth.batches.row_remarks import RowRemarks
from synth.batches.settings import BatchSettings, PlanSettings
from synth.batches.store import Store
from synth.errors import InputError
from synth.question.settings import SearchSettings
from synth.queue.database import file_url
from tests.sample_problems.rod import Rod

SEVERAL = BatchSettings(plan=PlanSettings(few=3, lines=4, pause=0.0, shown_faults=2, shown_lines=2))


def table(folder: Path, count: int) -> Path:
    """Return a table in which some rows are bad, in several ways, and some say what is not used."""
    path = folder / "rows.csv"
    cells = [
        f"R{k},{'x' if k % 7 == 3 else 10 + k},{'square' if k % 3 else ''},{'much' if k % 5 == 4 else 30},{k % 2 or ''}"
        for k in range(count)
    ]
    path.write_text("\n".join(["id,force [kN],section,diameter_limit [mm],load_torque", *cells]), encoding="utf-8")
    return path


def job(source: Any, folder: Path, numbers: BatchSettings = SEVERAL, problem: Any = Rod) -> BatchJob:
    common = {"parts": {"steel": ["S185"]}, "limits": None, "fix": None, "objectives": ["mass"], "grid": True}
    return BatchJob(problem, source, folder, None, None, None, SearchSettings(points=1), common, numbers)


def planned(made: BatchJob, workers: int | None) -> list[Any]:
    """Return all that is kept of the rows and questions of a job, and what is told of it."""
    made.plan(workers)
    made.close()
    with Store(file_url(made.folder / "jobs.sqlite")) as store:
        rows = list(store.rows(made.id, canonical=True))
        told = [(fault.first, fault.others, fault.count) for fault in made.remarks.faults]
        return [rows, list(store.questions(made.id)), told, made.remarks.bad, made.remarks.shown, made.remarks.unused]


@pytest.mark.slow
def test_workers_change_nothing_of_a_plan(tmp_path: Path) -> None:
    source = table(tmp_path, 41)
    alone, several = (planned(job(source, tmp_path / f"{workers}"), workers) for workers in (None, 2))
    assert several == alone
    assert len(alone[0]) == 41
    assert alone[3] == 13
    whole = planned(job(source, tmp_path / "other", BatchSettings(), Rod(section="square")), None)
    assert planned(job(source, tmp_path / "own", SEVERAL, Rod(section="square")), 2)[1] == whole[1]


def dying(checker: RowChecker, lines: Lines) -> list[ReadRow]:
    """Check lines in a process that ends at some of them."""
    if any(line == 12 for line, _ in lines):
        os._exit(1)
    return check_lines(checker, lines)


@pytest.mark.slow
def test_the_rows_of_a_process_that_dies_are_checked_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = table(tmp_path, 41)
    alone = planned(job(source, tmp_path / "alone"), None)
    monkeypatch.setattr(row_checks, "check_lines", dying)
    assert planned(job(source, tmp_path / "dying"), 2) == alone


@pytest.mark.slow
def test_what_is_wrong_with_the_table_as_a_whole_is_refused_by_any_process(tmp_path: Path) -> None:
    """The unit of a column is known to be wrong where a row has the option that needs it."""
    path = tmp_path / "rows.csv"
    rows = [f"{10 + k},," for k in range(20)]
    path.write_text("\n".join(["force [kN],family,load_torque [kg]", *rows, "5,disc_clutch,3"]), encoding="utf-8")
    said = []
    for workers in (None, 2):
        with pytest.raises(InputError) as refused:
            job(path, tmp_path / f"{workers}").plan(workers)
        said.append(str(refused.value))
        assert not (tmp_path / f"{workers}").exists() or not list((tmp_path / f"{workers}").iterdir())
    assert said[0] == said[1]
    assert "load_torque" in said[0]


def test_progress_tells_how_many_rows_are_checked_and_written(tmp_path: Path) -> None:
    states: list[Mapping[str, Any]] = []
    made = job(table(tmp_path, 11), tmp_path / "out")
    made.plan(None, states.append)
    made.close()
    assert [(state["stage"], state["done"]) for state in states] == [
        (stage, k) for stage in ("checked", "grouped", "written") for k in range(1, 12)
    ]
    assert {state["rows"] for state in states} == {11}


def test_of_many_faults_the_first_are_kept(tmp_path: Path) -> None:
    made, remarks = job(table(tmp_path, 100), tmp_path / "out"), RowRemarks(SEVERAL.plan)
    for row in made.questioner.rows():
        remarks.add(row)
    assert [(fault.first.line, fault.others, fault.count) for fault in remarks.faults] == [
        (5, [12, 19], 14),
        (6, [11, 16], 20),
    ]
    assert remarks.bad == remarks.shown == 31
    assert remarks.unused == {"rod": {"load_torque"}}
