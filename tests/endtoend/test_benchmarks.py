"""The benchmarks work; what they measure is not judged here."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.benchmarks import batch, cases
from tests.benchmarks.__main__ import main
from tests.benchmarks.child import MARK
from tests.benchmarks.families import QUESTIONS, measure
from tests.benchmarks.hypervolume import Reference
from tests.benchmarks.tables import Report, write_csv
from tests.shipped import FAMILIES

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("size", "combinations"), [("6k", 5_940), ("110k", 108_900), ("240k", 240_000), ("1M", 1_001_880)]
)
def test_catalogues_have_the_combinations_that_are_documented(size: str, combinations: int) -> None:
    question = cases.question(cases.SIZES[size])
    catalogs = question["catalogs"] or Catalogs()
    assert instance_of(cases.problem(), cases.HOIST, catalogs, question["parts"]).combinations.count == combinations


def test_a_larger_catalogue_begins_with_a_smaller_one() -> None:
    few, many = cases.more_rows(cases.LININGS, 30), cases.more_rows(cases.LININGS, 69)
    assert len(few) == 30 - len(cases.offered()[cases.LININGS])
    assert few.equals(many.head(len(few)))
    assert cases.requirement_rows(3) == cases.requirement_rows(9)[:3]


def test_hypervolume_ratio() -> None:
    reference = Reference(np.array([[1.0, 20.0], [2.0, 10.0], [3.0, 30.0]]))  # the last one is dominated
    # (0, 1) and (1, 0) up to (1.1, 1.1): 1.1 * 0.1 + 0.1 * 1.0
    assert reference.volume == pytest.approx(0.21)
    assert reference.ratio([[1.0, 20.0]]) == pytest.approx(0.11 / 0.21)
    assert reference.ratio([[1.0, 10.0]]) == pytest.approx(1.21 / 0.21)
    assert reference.ratio(np.empty((0, 2))) == 0.0


def test_tables_are_aligned_and_written(tmp_path: Path) -> None:
    report = Report("part", [{"name": "a", "x": 12345, "y": 0.5}, {"name": "long", "x": None, "y": 1234.6}], ["said"])
    assert report.text().splitlines() == [
        "part",
        "====",
        "name       x      y",
        "----  ------  -----",
        "a     12 345  0.500",
        "long       -  1 235",
        "* said",
    ]
    write_csv(tmp_path / "a.csv", [report])
    assert (tmp_path / "a.csv").read_text().splitlines()[:3] == [
        "part,row,figure,value",
        "part,1,name,a",
        "part,1,x,12345",
    ]


@pytest.mark.slow
def test_a_case_runs_in_a_process_of_its_own() -> None:
    case = {
        "kind": "search",
        "size": "tiny",
        "objectives": ["mass"],
        "grid": True,
        "gap": 0.05,
        "points": 1,
        "repeat": 1,
        "time_limit": 10.0,
    }
    command = [sys.executable, "-m", "tests.benchmarks.child", json.dumps(case)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=100, check=True)
    result = json.loads(done.stdout.split(MARK)[1])
    assert "error" not in result, result
    assert result["combinations"] == 30
    assert result["certificate"] == "global"
    assert len(result["designs"]) == 1
    assert result["seconds"] > 0
    assert result["memory"] > 0


@pytest.mark.slow
def test_the_command_prints_a_table_and_writes_its_figures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", "--quick", "--only", "nlp", "--csv", str(tmp_path / "a.csv")])
    main()
    assert "NLPs per second and core" in capsys.readouterr().out
    lines = (tmp_path / "a.csv").read_text().splitlines()
    rate = next(line for line in lines if line.startswith("nlp,1,NLPs per second and core,"))
    assert float(rate.rsplit(",", 1)[1]) > 0


@pytest.mark.parametrize("arguments", [["--only", "nothing"], ["--repeat", "0"], ["--time-limit", "0"]])
def test_wrong_options_are_refused(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["benchmarks", *arguments])
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 2


@pytest.mark.slow
def test_a_question_to_a_family_is_measured() -> None:
    question = QUESTIONS[0]
    found = measure(question, repeat=1, time_limit=60.0, points=2)
    assert found["certificate"] == "global"
    assert found["designs"] == 2
    assert found["combinations"] > 1
    assert 0 < found["processor s"]
    assert {q.family for q in QUESTIONS} <= set(FAMILIES)


@pytest.mark.slow
def test_a_batch_is_measured() -> None:
    found = batch.measure(2, 1, "tiny", None)
    assert (found["rows"], found["with designs"], found["global"]) == (2, 1, 2)
    assert found["combinations"] == 30
    assert found["NLPs in all, median"] > 0
    assert 0 < found["MiB, master"]
    spent = batch.overhead(4)
    assert 0 < spent["claim and keep ms"]
    (report,) = batch.ranges(quick=True)
    assert [row["kind"] for row in report.rows] == ["capacity and room", "plane"]
    assert all(row["gap"] <= 1e-3 for row in report.rows)
