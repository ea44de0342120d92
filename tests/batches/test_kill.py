"""Killed at any moment, the same command goes on and ends with the same bytes."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import sqlalchemy as sa

from synth.batches.batch_folder import DATABASE
from synth.batches.store import Store
from synth.queue.database import file_url
from tests.repetitions import repetitions
from tests.terminal.entry import COMMAND, in_process
from tests.waiting import PATIENCE, until

ROOT = Path(__file__).parents[2]
ROWS = """id,family,load_torque,driver_speed [1/min],driven_inertia [kg*m2],guide_model,practice,ramp_time,parts,limits
{}"""
ROW = "{},multi_plate_clutch,{},254,30,cz,off,2,friction_pair = seed_multiplate_ref; inner_plate = core 4; outer_plate = core 2,friction_surfaces == 10"  # noqa: E501


def small_table(folder: Path, count: int) -> Path:
    path = folder / "rows.csv"
    lines = [
        ROW.format(f"A{k}", 400 + 10 * k).replace("friction_pair", '"friction_pair').replace("core 2,", 'core 2",')
        for k in range(count)
    ]
    path.write_text(ROWS.format("\n".join(lines)) + "\n")
    return path


@pytest.fixture
def database(new_database: str) -> str:
    """Return the address of a database in which nothing is: batches are killed while they make its tables, too."""
    return new_database


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="kills processes of POSIX")
def test_a_batch_that_is_killed_again_and_again_ends_with_the_same_bytes(tmp_path: Path, database: str) -> None:
    kills = repetitions(8, 14) if database.startswith("sqlite") else repetitions(6, 8)
    done = subprocess.run(
        [sys.executable, "-m", "tests.batches.stages", str(tmp_path), database, str(kills), "7"],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stderr
    words = done.stdout.split("\n")
    assert words.count("killed") >= 3
    assert not [word for word in words if word.startswith("ended") and word != "ended 0"]
    first, killed = tmp_path / "first" / "designs.csv", tmp_path / "killed" / "designs.csv"
    assert len(first.read_bytes().splitlines()) == 15
    assert killed.read_bytes() == first.read_bytes()
    assert not list((tmp_path / "killed").glob(".*.tmp"))
    with Store(database) as store:
        (job,) = store.jobs()
        assert job.state == "done"
        kinds = [kind for _, kind, _ in store.events(job.id)]
        assert kinds[0] == "created"
        assert kinds[-1] == "done"
        assert "failed" not in kinds  # an interruption is no attempt


def children_of(process: int) -> set[int]:
    found = set()
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == process:
            found.add(int(path.parent.name))
    return found


def exists(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks at processes of Linux")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_workers_go_with_their_master_and_the_command_goes_on(tmp_path: Path, number: signal.Signals) -> None:
    table = small_table(tmp_path, 3)
    words = ["batch", str(table), "-o", str(tmp_path / "out"), "--points", "1", "--objective", "mass", "-q"]
    process = subprocess.Popen([*COMMAND, *words, "--workers", "1"], stderr=subprocess.PIPE, text=True)
    try:
        file = tmp_path / "out" / DATABASE
        until(lambda: at_work(file))
        time.sleep(random.Random(int(number)).uniform(0.0, 0.5))
        workers = children_of(process.pid)
        assert workers
        process.send_signal(number)
        _, errors = process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == (-9 if number == signal.SIGKILL else 4), errors
    until(lambda: [worker for worker in workers if exists(worker)], right=lambda left: not left)
    if number == signal.SIGKILL:
        assert not (tmp_path / "out" / "designs.csv").exists()
        again = in_process(*words)
        assert again.returncode == 0, again.stderr
        assert len((tmp_path / "out" / "designs.csv").read_text().splitlines()) == 4
    else:
        text = (tmp_path / "out" / "rows.csv").read_text()
        assert "not_solved" in text
        with Store(file_url(file)) as store:
            (job,) = store.jobs()
            assert store.open_units(job.id)[1] == 0
            assert "interrupted" in [kind for _, kind, _ in store.events(job.id)]


def at_work(file: Path) -> bool:
    """Tell whether some unit is claimed."""
    if not file.exists():
        return False
    engine = sa.create_engine(file_url(file))
    try:
        with engine.connect() as connection:
            return bool(connection.execute(sa.text("SELECT count(*) FROM unit WHERE state = 'running'")).scalar())
    except sa.exc.OperationalError:
        return False  # the tables are just being made
    finally:
        engine.dispose()
