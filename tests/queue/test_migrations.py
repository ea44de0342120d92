"""Databases of the first version: opened by this one they keep everything, and what was stopped goes on."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
import yaml
from alembic import command
from alembic.config import Config

from synth.batches.batch import BatchJob, batch, resume
from synth.batches.outputs import write_outputs
from synth.batches.settings import BATCHES, RunnerSettings
from synth.batches.store import Store
from synth.question.settings import SearchSettings
from synth.queue.database import HEAD, engine_for, file_url
from synth.queue.job_table import CANCELLED, DONE, OPEN

HERE = Path(__file__).parent
KEPT = (
    HERE / "version_1"
)  # written by the first version: one batch that is done, one that was stopped after 8 of 10 rows
ROOT = HERE.parents[1]
FIX = {"ramp_time": "2 s"}  # a row is answered in a tenth of a second
OLD_TABLES = {
    "batch_job": ("job", "id, basis, state, source, folder, created, updated, rows, content"),
    "batch_unit": ("unit", "id, job, state, owner, lease, token, attempts"),
    "batch_question": ("question", "job, key, structure, position, unit, content"),
    "batch_row": ("job_row", "job, line, position, key, family, cells, remarks, faults"),
    "batch_result": ("result", "job, key, status, seconds, layout, content"),
    "batch_layout": ("layout", "job, key, content"),
    "batch_event": ("event", "id, job, time, kind, text"),
}


pytestmark = pytest.mark.slow


@pytest.fixture
def database(new_database: str) -> str:
    """Return the address of a database in which nothing is, and whose tables are replaced."""
    return new_database


@pytest.fixture
def old(tmp_path: Path) -> Path:
    file = tmp_path / "jobs.sqlite"
    with sqlite3.connect(file) as connection:
        connection.executescript((KEPT / "jobs.sql").read_text(encoding="utf-8"))
    connection.close()
    return file


def test_what_the_first_version_has_found_is_kept_to_the_byte(old: Path, tmp_path: Path) -> None:
    with Store(file_url(old)) as store:
        finished, stopped = sorted(store.jobs(), key=lambda job: job.folder)
        assert (finished.state, finished.kind, finished.tenant, finished.rows) == (DONE, "batch", 1, 4)
        assert (stopped.state, stopped.rows, stopped.ended) == (OPEN, 10, None)
        assert finished.fingerprint == finished.id
        assert store.open_units(stopped.id) == (1, 0)
        assert next(kind for _, kind, _ in store.events(stopped.id)) == "created"
        write_outputs(store, finished.id, tmp_path / "again")
    for name in ("designs.csv", "rows.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (KEPT / f"finished_{name}").read_bytes()


def test_a_copy_of_the_old_file_stays(old: Path) -> None:
    Store(file_url(old)).close()
    with sqlite3.connect(f"{old}.v1") as copy:
        assert copy.execute("SELECT version_num FROM batch_version").fetchone() == ("1",)
        assert copy.execute("SELECT count(*) FROM batch_row").fetchone() == (14,)
    copy.close()
    with sqlite3.connect(old) as now:
        assert now.execute("SELECT version_num FROM batch_version").fetchone() == (HEAD,)
    now.close()


def test_a_batch_that_the_first_version_has_stopped_ends_with_the_same_bytes(tmp_path: Path, database: str) -> None:
    """The tables are put back to those of the first version; the code is of today, as answers of others are refused."""
    rows = hoists("300 N*m", "350 N*m", "450 N*m", "many", "550 N*m", "650 N*m")
    asked: dict[str, Any] = {"objectives": ["mass"], "points": 1, "fix": FIX}
    undisturbed = batch("multi_plate_clutch", rows, tmp_path / "first", **asked)

    def stop(state: Mapping[str, Any]) -> None:
        if state["done"] > 1:
            raise KeyboardInterrupt

    often = replace(BATCHES, runner=RunnerSettings(pause=0.0, report_share=1e9))
    common = {"parts": None, "limits": None, "fix": FIX, "objectives": ["mass"], "grid": True}
    settings = SearchSettings(points=1)
    planned = BatchJob("multi_plate_clutch", rows, tmp_path / "out", None, None, database, settings, common, often)
    assert planned.result(1, None, stop).stopped
    _put_back(database)
    with Store(database) as store:
        (job,) = store.jobs()
        assert job.state == OPEN
        assert sum(store.open_units(job.id)) > 0
        assert resume(store, job.id, None, None, None, print) == ""
        write_outputs(store, job.id, tmp_path / "out")
        (job,) = store.jobs()
        assert job.state == DONE
        fresh = {"job": job.id, "task": "rows", "state": CANCELLED, "token": 0, "attempts": 0}
        with store.engine.begin() as connection:  # numbers go on after those that were copied
            connection.execute(sa.text(_insert("unit", fresh)), fresh)
    assert (tmp_path / "out" / "designs.csv").read_bytes() == (undisturbed.folder / "designs.csv").read_bytes()


def test_a_batch_of_the_first_version_is_found_by_its_command(tmp_path: Path, database: str) -> None:
    common = {"parts": None, "limits": None, "fix": FIX, "objectives": ["mass"], "grid": True}
    settings = SearchSettings(points=1)

    def job() -> BatchJob:
        return BatchJob(
            "multi_plate_clutch", hoists("400 N*m"), tmp_path / "out", None, None, database, settings, common
        )

    assert job().result(1, None, None).counts == {"optimal": 1}
    _put_back(database)
    again = job()
    assert again.plan()
    again.close()


def hoists(*torques: str) -> list[dict[str, str]]:
    """Return rows that ask the question of the hoist for other torques."""
    spec = yaml.safe_load((ROOT / "examples" / "hoist_multi_plate.yaml").read_text(encoding="utf-8"))
    return [{**{k: str(v) for k, v in spec["requirements"].items()}, "load_torque": torque} for torque in torques]


def _insert(table: str, values: Mapping[str, Any]) -> str:
    return f"INSERT INTO {table} ({', '.join(values)}) VALUES ({', '.join(f':{name}' for name in values)})"


def _put_back(database: str) -> None:
    """Turn a database of this version into one of the first."""
    engine = engine_for(database, 10.0)
    with engine.begin() as connection:
        kept = {
            old: [dict(row) for row in connection.execute(sa.text(f"SELECT {columns} FROM {new}")).mappings()]
            for old, (new, columns) in OLD_TABLES.items()
        }
    metadata = sa.MetaData()
    metadata.reflect(engine)
    metadata.drop_all(engine)
    config = Config()
    config.set_main_option("script_location", str(ROOT / "synth" / "queue" / "migrations"))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "1")
    old = sa.MetaData()
    old.reflect(engine)
    with engine.begin() as connection:
        for name, rows in kept.items():
            if rows:
                connection.execute(sa.insert(old.tables[name]), [_unpacked(row) for row in rows])
    engine.dispose()


def _unpacked(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row with its JSON read, as SQLite gives texts."""

    packed = ("content", "cells", "faults")
    return {k: json.loads(v) if k in packed and isinstance(v, str) else v for k, v in row.items()}
