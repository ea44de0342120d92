"""batch, size-range and jobs as a user meets them."""

from __future__ import annotations

import csv
import json
import os
import re
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest

import synth
from synth.terminal import batch_commands as commands
from tests.terminal.entry import in_process as clutchsynth

RULES = "friction_pair = seed_multiplate_ref; inner_plate = core 4; outer_plate = core 2"
GOOD = {
    "id": "A1",
    "family": "multi_plate_clutch",
    "load_torque [N*m]": "600",
    "driver_speed [1/min]": "254",
    "driven_inertia [kg*m2]": "30",
    "guide_model": "cz",
    "practice": "off",
    "ramp_time [s]": "2",
    "parts": RULES,
    "limits": "friction_surfaces == 10",
    "offset [mm]": "3",
}


def write(folder: Path, *rows: dict[str, Any], name: str = "rows.csv") -> Path:
    path = folder / name
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    return path


FLAGS = ("--points", "1", "--objective", "mass")


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, CompletedProcess[str]]:
    folder = tmp_path_factory.mktemp("batch")
    rows = [GOOD, {**GOOD, "id": "A2", "load_torque [N*m]": "450"}, {**GOOD, "id": "A3", "load_torque [N*m]": "6,5"}]
    rows.append({**GOOD, "id": "A4", "limits": "friction_surfaces == 10; outer_diameter <= 150 mm"})
    rows.append({**GOOD, "id": "A5", "family": "magnet"})
    rows.append({**GOOD, "id": "A6", "family": "magnet"})
    write(folder, *rows)
    return folder, clutchsynth("batch", "rows.csv", "-o", "out", *FLAGS, folder=folder)


def test_of_many_rows_the_first_without_a_design_are_shown(tmp_path: Path) -> None:
    write(tmp_path, GOOD, *({**GOOD, "id": f"A{k}", "family": "magnet"} for k in range(23)))
    said = clutchsynth("batch", "rows.csv", "-o", "out", *FLAGS, folder=tmp_path)
    lines = [" ".join(line.split()) for line in said.stdout.splitlines()]
    assert "the first 5 of 23 without a design; rows.csv has them all" in lines
    assert [line.split()[1] for line in lines if line.startswith(tuple("23456789"))][1:] == [f"A{k}" for k in range(5)]


@pytest.mark.slow
def test_a_batch_is_reported_with_a_row_of_ones_choice(done: tuple[Path, CompletedProcess[str]]) -> None:
    folder, _ = done
    said = clutchsynth("report", "out", "-o", "handed_on", "--row", "A2", "--pdf", "--xlsx", folder=folder)
    assert (said.returncode, said.stderr) == (0, "")
    assert said.stdout == "written to handed_on: report.html, report.pdf, batch.xlsx\n"
    page = (folder / "handed_on" / "report.html").read_text(encoding="utf-8")
    assert "2 of 6 rows have designs, 4 NOT" in page
    assert "Line 3: A2" in page
    assert "One design: proven to 0.1 %" in page
    assert "<figure" in page  # its drawing


@pytest.mark.slow
def test_a_batch_says_what_it_reads_and_what_came_out(done: tuple[Path, CompletedProcess[str]]) -> None:
    folder, said = done
    assert said.returncode == 0
    first, *table, last = (" ".join(line.split()) for line in said.stdout.splitlines())
    assert first == "6 rows: 2 with proven designs, 1 without a feasible design, 3 with bad input"
    assert last == "written to out: designs.csv, rows.csv, batch.json"
    with (folder / "out" / "designs.csv").open(newline="") as file:
        mass = {row["id"]: f"{float(row['mass [kg]']):.3f}" for row in csv.DictReader(file)}
    assert table[1:3] == ["line id state mass [kg] parts of #1, or why not", "─" * len(table[2])]
    assert table[3] == f"2 A1 proven {mass['A1']} as all"
    assert table[4] == f"3 A2 proven {mass['A2']} as all"
    assert table[5] == "4 A3 bad input – column load_torque [N*m]: got '6,5'"
    assert re.match("5 A4 not feasible – nearest design misses .*, ", table[6])
    assert [line.partition(":")[0] for line in table if line.startswith(("6 ", "7 "))] == [
        "6 A5 bad input – column family",
        "7 A6 bad input – column family",
    ]
    shared = "#1 of every row: friction pair seed_multiplate_ref, inner plate core 4, outer plate core 2"
    assert shared in table
    for words in (
        "clutchsynth: carried along unread: id\n",
        "clutchsynth: not used by multi_plate_clutch: offset [mm]\n",
        "clutchsynth: line 4, column load_torque [N*m]: got '6,5'; expected a decimal point",
        f"clutchsynth: line 6, column family: got 'magnet'; expected a registered family: {synth.families()[0]}",
        " (also in line 7)\n",
        "clutchsynth: 3 rows cannot be asked; rows.csv lists them all, the others run\n",
    ):
        assert words in said.stderr
    with (folder / "out" / "rows.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == [
        "optimal",
        "optimal",
        "bad_input",
        "infeasible",
        "bad_input",
        "bad_input",
    ]
    assert "outer_diameter <= 150 mm" in rows[3]["explanation"]
    assert [row["id"] for row in rows] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    with (folder / "out" / "designs.csv").open(newline="") as file:
        assert [row["id"] for row in csv.DictReader(file)] == ["A1", "A2"]


def test_jobs_are_listed_shown_cancelled_and_resumed(done: tuple[Path, CompletedProcess[str]]) -> None:
    folder, _ = done
    job = json.loads((folder / "out" / "batch.json").read_text())["job"]
    listed = clutchsynth("jobs", "list", folder=folder).stdout
    assert re.search(rf"{job} +batch +done +6 +6 .*rows.csv", listed)
    assert clutchsynth("jobs", "list", "out", folder=folder).stdout == listed
    url = f"sqlite:///{folder}/out/jobs.sqlite"
    assert clutchsynth("jobs", "list", "--database", url, folder=folder).stdout == listed
    shown = clutchsynth("jobs", "show", "out", folder=folder).stdout
    assert shown == clutchsynth("jobs", "show", job[:6], folder=folder).stdout
    assert "6 rows: 2 with proven designs, 1 without a feasible design, 3 with bad input\n" in shown
    assert "units: 0 open, 0 at work\n" in shown
    assert "created: 6 rows in" in shown
    refused = clutchsynth("jobs", "cancel", "out", folder=folder)
    assert (refused.returncode, "not done yet" in refused.stderr) == (2, True)
    before = (folder / "out" / "designs.csv").read_bytes()
    (folder / "out" / "designs.csv").unlink()
    resumed = clutchsynth("jobs", "resume", "out", folder=folder)
    assert resumed.returncode == 0
    assert (folder / "out" / "designs.csv").read_bytes() == before
    for words in (["show", "nothing"], ["list", "nowhere"], ["show", "out", "--database", "sqlite:///none"]):
        assert clutchsynth("jobs", *words, folder=folder).returncode == 2
    assert clutchsynth("jobs", "list", folder=folder / "out" / "..").returncode == 0


def test_an_empty_folder_has_no_jobs(tmp_path: Path) -> None:
    assert clutchsynth("jobs", "list", folder=tmp_path).stdout == "no jobs\n"


def test_a_job_that_is_cancelled_is_resumed_without_its_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from synth.batches import batch as run

    write(tmp_path, GOOD)
    with monkeypatch.context() as patch:
        patch.setattr(run, "work_off", lambda *words: "interrupted")
        stopped = clutchsynth("batch", "rows.csv", "-o", "out", *FLAGS, folder=tmp_path)
    assert stopped.returncode == 4
    assert "stopped: interrupted; what was found is saved, the same command goes on" in stopped.stdout
    assert "1 row: 1 not solved yet" in stopped.stdout
    cancelled = clutchsynth("jobs", "cancel", "out", folder=tmp_path)
    assert cancelled.stdout.endswith("cancelled; clutchsynth jobs resume goes on\n")
    (tmp_path / "rows.csv").unlink()
    resumed = clutchsynth("jobs", "resume", "out", "-q", folder=tmp_path)
    assert (resumed.returncode, resumed.stdout) == (0, "")
    with (tmp_path / "out" / "rows.csv").open(newline="") as file:
        assert [row["status"] for row in csv.DictReader(file)] == ["optimal"]


def test_nothing_feasible_has_its_code(tmp_path: Path) -> None:
    write(tmp_path, {**GOOD, "limits": "outer_diameter <= 150 mm; friction_surfaces == 10"})
    assert clutchsynth("batch", "rows.csv", "-o", "out", *FLAGS, "-q", folder=tmp_path).returncode == 3


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["none.csv", "-o", "out"], "rows: got 'none.csv'"),
        (["rows.csv", "-o", "rows.csv"], "is a file"),
        (["rows.csv", "-o", "out", "--mapping", "none.yaml"], "--mapping"),
        (["rows.csv", "-o", "out", "--points", "0"], "points: got 0"),
        (["rows.csv", "-o", "out", "--objective", "weight"], "weight"),
        (["rows.csv", "-o", "out", "--catalogs", "nowhere"], "catalogs"),
        (["rows.csv", "-o", "out", "--database", "here"], "--database"),
        (["rows.csv", "-o", "out", "--time-limit", "soon"], "--time-limit"),
        (["wrong.csv", "-o", "out"], "wrong.csv, line 1: got 'lod_torque'; expected load_torque"),
    ],
)
def test_bad_input_is_one_sentence_and_nothing_written(tmp_path: Path, words: list[str], expected: str) -> None:
    write(tmp_path, GOOD)
    write(tmp_path, {"family": "multi_plate_clutch", "lod_torque": "3"}, name="wrong.csv")
    refused = clutchsynth("batch", *words, folder=tmp_path)
    assert refused.returncode == 2
    assert expected in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["rows.csv", "wrong.csv"]


@pytest.mark.slow
def test_a_size_range_from_a_table_and_again_from_its_folder(tmp_path: Path) -> None:
    write(tmp_path, *({**GOOD, "load_torque [N*m]": torque} for torque in ("500", "550", "600")))
    found = clutchsynth("size-range", "rows.csv", "-o", "out", *FLAGS, folder=tmp_path)
    assert found.returncode == 0, found.stderr
    assert "1 variant for 3 rows" in found.stdout
    assert "ramp_time is each row's own, no part of a variant" in found.stdout
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"variants.csv", "assignment.csv", "curve.csv", "curve.svg", "unserved.csv", "size_range.json"} <= written
    again = clutchsynth("size-range", "out", "--variants", "3", "-o", "three", folder=tmp_path)
    assert again.returncode == 0, again.stderr
    assert "total excess of mass over each row's own best: 0 kg, proven to 0 %" in again.stdout
    assert len((tmp_path / "three" / "variants.csv").read_text().splitlines()) == 4
    assert clutchsynth("size-range", "three", folder=tmp_path).returncode == 2


def test_progress_is_told_in_words() -> None:
    from synth.terminal.batch_console import figures

    state = {"rows": 200, "done": 50, "failed": 2, "infeasible": 0, "bad": 0, "rate": 0.5, "left": 300.0}
    assert figures(state) == "50 of 200 rows, 0.5 rows/s, 5 min left, 2 failed"
    assert figures({**state, "rate": 0.0, "left": None, "failed": 0}) == "50 of 200 rows"
    assert figures({**state, "left": 42.0}).split(", ")[2] == "42 s left"
    assert figures({**state, "left": 36000.0}).split(", ")[2] == "10 h left"


def test_the_database_may_be_named_by_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(commands.DATABASE_VARIABLE, f"sqlite:///{tmp_path}/all.sqlite")
    write(tmp_path, {**GOOD, "limits": "outer_diameter <= 150 mm; friction_surfaces == 10"})
    clutchsynth("batch", "rows.csv", "-o", "out", *FLAGS, "-q", folder=tmp_path)
    assert (tmp_path / "all.sqlite").is_file()
    assert not (tmp_path / "out" / "jobs.sqlite").exists()
    assert "rows.csv" in clutchsynth("jobs", "list", folder=tmp_path).stdout
    assert os.fspath(tmp_path / "out") in clutchsynth("jobs", "show", "", folder=tmp_path).stdout


def test_the_address_of_no_scheduler_leaves_nothing_behind(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text("load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2]\n60,1500,0.5\n")
    words = ("batch", rows, "--family", "cone_clutch", "-o", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:9")
    done = clutchsynth(*words)
    assert done.returncode == 2
    assert "--scheduler: got 'tcp://127.0.0.1:9'; expected the address of a Dask scheduler that answers" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["rows.csv"]
