"""Results are never lost: a run that is stopped, killed or short of room leaves the earlier one as it was."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from tests.folders.test_output_folder import small_disk
from tests.terminal.entry import COMMAND, LONG_SEARCH, at_once, clutchsynth, in_process
from tests.terminal.test_choice_commands import SEVERAL
from tests.terminal.test_cli import HOIST, SMALL, refused
from tests.waiting import PATIENCE, until

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="signals and limits of POSIX")]

TIGHT = SMALL.replace("limits: {", "limits: {outer_diameter: <= 270 mm, ")
HEADER = (
    "family,load_torque [N*m],driver_speed [1/min],driven_inertia [kg*m2],guide_model,practice,ramp_time [s],parts,"
    "limits,ring_outer_diameter [mm],ring_inner_diameter [mm]"
)
PARTS = "friction_pair = seed_multiplate_ref; inner_plate = core 4; outer_plate = core 2"
BATCH = ["batch", "rows.csv", "-o", "out", "--points", "1", "--objective", "mass", "--workers", "1"]


def rows(path: Path, *torques: float, ring: str = "300,230") -> Path:
    """Write a table of one row per load torque, which asks for the force on a ring, or for the ring as well."""
    asked = f"254,30,cz,off,2,{PARTS},friction_surfaces == 10,{ring}"
    lines = [f"multi_plate_clutch,{torque},{asked}" for torque in torques]
    path.write_text("\n".join([HEADER, *lines]) + "\n")
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def beside(folder: Path) -> tuple[dict[str, bytes], dict[str, bytes]]:
    """Return what stands in a folder, and what a stopped run has left beside it."""
    found = contents(folder)
    stopped = {name: raw for name, raw in found.items() if name.startswith("stopped")}
    return {name: raw for name, raw in found.items() if name not in stopped}, stopped


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a finished front, and specs beside it."""
    folder = tmp_path_factory.mktemp("small")
    (folder / "small.yaml").write_text(SMALL)
    (folder / "tight.yaml").write_text(TIGHT)
    assert at_once("run", folder / "small.yaml", "-o", folder / "out", "-q").returncode == 0
    return folder


@pytest.fixture
def out(small: Path, tmp_path: Path) -> Path:
    """A copy of a finished front."""
    return Path(shutil.copytree(small / "out", tmp_path / "out"))


def until_it_works(database: Path, rows: int) -> None:
    """Wait until a worker has taken the first rows of a batch of so many."""
    taken = "SELECT count(*) FROM unit JOIN job ON unit.job = job.id WHERE rows = ? AND owner <> ''"

    def taken_by_now() -> int:
        with closing(sqlite3.connect(database)) as connection:
            return int(connection.execute(taken, (rows,)).fetchone()[0])

    until(taken_by_now)


def begun(folder: Path, *words: object) -> subprocess.Popen[str]:
    """Start a long search into a folder, and wait until it has begun."""
    process = subprocess.Popen(
        [*COMMAND, *LONG_SEARCH, "-o", str(folder), *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert "designs" in process.stderr.readline()
    return process


# ---- stopped --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_search_that_is_stopped_stands_beside_the_earlier_result(out: Path, number: signal.Signals) -> None:
    before = contents(out)
    with begun(out) as process:
        process.send_signal(number)
        said, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 4, errors
    kept, stopped = beside(out)
    assert kept == before
    assert json.loads(stopped["stopped/front.json"])["interrupted"] == "interrupted"
    assert "stopped/designs.csv" in stopped
    assert f"written to {out / 'stopped'}: calculation.json, designs.csv" in " ".join(said.split())
    assert f"the earlier result in {out} stays as it was" in " ".join(said.split())
    # Stopped once more, what was stopped before stays too; a finished search takes the place of the result alone.
    assert at_once("run", HOIST, "-o", out, "--time-limit", "0.01", "-q").returncode == 4
    assert beside(out)[0] == before
    assert "stopped_2/front.json" in contents(out)
    assert at_once("run", out.parent / "other.yaml", "-o", out, "-q").returncode == 2
    (out.parent / "other.yaml").write_text(SMALL.replace("10 .. 14", "10 .. 12"))
    assert at_once("run", out.parent / "other.yaml", "-o", out, "-q").returncode == 0
    now, still = beside(out)
    assert now.keys() != before.keys()
    assert still.items() >= stopped.items()


@pytest.mark.parametrize("command", ["explain", "near-equals", "rate", "prices", "whatif", "run"])
def test_other_questions_about_a_folder_keep_their_results_as_well(small: Path, tmp_path: Path, command: str) -> None:
    """Every command that searches: once to the end, once stopped at once."""
    spec, out = small / "small.yaml", tmp_path / "out"
    (small / "several.yaml").write_text(SEVERAL)
    words, again = {
        "explain": (["explain", small / "tight.yaml"], []),
        "near-equals": (["near-equals", small / "out"], []),
        "rate": (["rate", small / "out", "--over", "load_torque=+-1 %", "--samples", "64"], []),
        "prices": (["prices", small / "out", "--design", "1"], ["--step", "0.5 %"]),
        "whatif": (["whatif", spec, "--vary", "load_torque=600,610 N*m", "--no-breaks"], ["--points", "1"]),
        "run": (["run", small / "several.yaml"], []),
    }[command]
    done = at_once(*words, "-o", out)
    assert done.returncode in (0, 3), done.stderr
    before = contents(out)
    stopped = at_once(*words, *again, "-o", out, "--time-limit", "1e-4")
    assert stopped.returncode == 4, (stopped.stdout, stopped.stderr)
    kept, fresh = beside(out)
    assert kept == before
    assert fresh
    assert f"the earlier result in {out} stays as it was" in " ".join(stopped.stdout.split())


def test_a_study_that_was_stopped_beside_another_goes_on_there_and_then_takes_its_place(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    first = ["whatif", tmp_path / "small.yaml", "--vary", "load_torque=600,610 N*m", "--no-breaks"]
    other = ["whatif", tmp_path / "small.yaml", "--vary", "load_torque=600,620,630 N*m", "--no-breaks"]
    assert at_once(*other, "-o", tmp_path / "alone", "-q").returncode == 0
    assert at_once(*first, "-o", tmp_path / "out", "-q").returncode == 0
    before = contents(tmp_path / "out")
    assert at_once(*other, "-o", tmp_path / "out", "-q", "--time-limit", "1e-4").returncode == 4
    kept, stopped = beside(tmp_path / "out")
    assert kept == before
    assert stopped
    assert at_once(*other, "-o", tmp_path / "out", "-q").returncode == 0
    now, left = beside(tmp_path / "out")
    assert not left
    assert now["whatif.csv"] == (tmp_path / "alone" / "whatif.csv").read_bytes()
    assert [name for name in now if name.startswith("steps/")] == [f"steps/step_{k:04d}.json" for k in (1, 2, 3)]
    # It stands as if it had never been stopped: the same study again searches nothing.
    written = [path.stat().st_mtime_ns for path in sorted((tmp_path / "out" / "steps").iterdir())]
    assert at_once(*other, "-o", tmp_path / "out", "-q").returncode == 0
    assert [path.stat().st_mtime_ns for path in sorted((tmp_path / "out" / "steps").iterdir())] == written
    assert beside(tmp_path / "out")[0]["whatif.csv"] == now["whatif.csv"]


# ---- two jobs, no room ----------------------------------------------------------------------------------------------


def test_two_jobs_into_one_folder_are_refused(tmp_path: Path) -> None:
    (tmp_path / "small.yaml").write_text(SMALL)
    out = tmp_path / "out"
    with begun(out) as process:
        for words in (["run", tmp_path / "small.yaml"], ["curves", "multi_plate_clutch", tmp_path / "small.yaml"]):
            message = refused(at_once(*words, "-o", out))
            assert "nobody writes into" in message
            assert f"process {process.pid}" in message
        process.kill()  # at once: nothing is taken away
    assert at_once("run", tmp_path / "small.yaml", "-o", out, "-q").returncode == 0
    assert not list(out.glob(".*"))


def cramped() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))


def test_without_room_the_earlier_result_stays_and_one_sentence_says_so(out: Path, tmp_path: Path) -> None:
    before = contents(out)
    (tmp_path / "other.yaml").write_text(SMALL.replace("600 N*m", "610 N*m"))
    done = subprocess.run(
        [*COMMAND, "run", str(tmp_path / "other.yaml"), "-o", str(out), "-q"],
        preexec_fn=cramped,
        env={**os.environ, "CLUTCHSYNTH_NATIVE": "0"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "a folder that can be written (File too large)" in refused(done)
    assert contents(out) == before


def test_a_batch_without_room_says_so_in_one_sentence(tmp_path: Path) -> None:
    rows(tmp_path / "rows.csv", 600)
    done = subprocess.run(
        [*COMMAND, *BATCH], preexec_fn=cramped, cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "jobs.sqlite" in refused(done)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["rows.csv"]


@pytest.mark.skipif(not sys.platform.startswith("linux") or os.geteuid() != 0, reason="only root can mount a disk")
def test_a_batch_whose_disk_gets_full_keeps_what_it_has_and_goes_on(tmp_path: Path) -> None:
    rows(tmp_path / "rows.csv", *range(500, 516))
    with small_disk(tmp_path / "out", 600) as disk:
        full = clutchsynth(*BATCH, "-q", folder=tmp_path)
        assert full.returncode == 4
        assert len(full.stderr.splitlines()) == 1
        assert "is full" in full.stderr
        assert "what was found is in the database, the same command goes on" in full.stderr
        subprocess.run(["mount", "-o", "remount,size=20m", str(disk)], check=True)
        assert in_process(*BATCH, "-q", folder=tmp_path).returncode == 0
        assert len((disk / "rows.csv").read_text().splitlines()) == 17


def test_what_a_batch_has_found_is_kept_where_it_cannot_be_written(tmp_path: Path) -> None:
    rows(tmp_path / "rows.csv", 600)
    assert in_process(*BATCH, "-q", folder=tmp_path).returncode == 0
    before = (tmp_path / "out" / "designs.csv").read_bytes()
    rows(tmp_path / "rows.csv", 600, 610)
    (tmp_path / "out" / "rows.csv").unlink()
    (tmp_path / "out" / "rows.csv").mkdir()  # in the way
    blocked = in_process(*BATCH, "-q", folder=tmp_path)
    assert blocked.returncode == 4
    assert len(blocked.stderr.splitlines()) == 1
    assert "what was found is in the database, the same command goes on" in blocked.stderr
    assert (tmp_path / "out" / "designs.csv").read_bytes() == before
    (tmp_path / "out" / "rows.csv").rmdir()
    assert in_process(*BATCH, "-q", folder=tmp_path).returncode == 0
    assert len((tmp_path / "out" / "designs.csv").read_text().splitlines()) == 3


def test_a_batch_of_other_rows_that_is_stopped_stands_beside(tmp_path: Path) -> None:
    """The result of a finished batch stays until another one is finished."""
    out = tmp_path / "out"
    rows(tmp_path / "rows.csv", 600)
    assert in_process(*BATCH, "-q", folder=tmp_path).returncode == 0
    before = {name: raw for name, raw in contents(out).items() if not name.startswith("jobs.sqlite")}
    rows(tmp_path / "rows.csv", *(600 + k / 4 for k in range(2400)), ring=",")
    with subprocess.Popen(
        [*COMMAND, *BATCH],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        until_it_works(out / "jobs.sqlite", 2400)
        os.killpg(process.pid, signal.SIGTERM)  # its workers as well, as a scheduler does
        said, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 4, errors
    assert "failed" not in said
    kept, stopped = beside(out)
    assert {name: raw for name, raw in kept.items() if not name.startswith("jobs.sqlite")} == before
    assert {name.split("/")[1] for name in stopped} == {"designs.csv", "rows.csv", "batch.json"}
    assert f"the earlier result in {out.name} stays as it was" in " ".join(said.split())
    rows(tmp_path / "rows.csv", *range(600, 603))
    assert in_process(*BATCH, "-q", folder=tmp_path).returncode == 0
    assert len((out / "rows.csv").read_text().splitlines()) == 4
    assert beside(out)[1] == stopped
