"""Commands beside a service: workers, and jobs that were made over HTTP."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from synth.batches.store import Store
from synth.queue.database import file_url
from synth.queue.job_table import CANCELLED, OPEN, NewJob
from synth.terminal.cli import app


def test_a_worker_refuses_a_database_that_is_not_there(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["worker", "--database", file_url(tmp_path / "none.sqlite").render_as_string()])
    assert "a job database that exists" in str(done.exception)
    assert list(tmp_path.iterdir()) == []


def test_a_worker_refuses_a_damaged_database(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    with Store(file_url(file).render_as_string()) as store:
        store.engine.connect().exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    content = bytearray(file.read_bytes())
    content[8 * 4096 : 14 * 4096] = b"\x11" * (6 * 4096)
    file.write_bytes(content)
    done = CliRunner().invoke(app, ["worker", "--database", file_url(file).render_as_string()])
    assert "a job database that is whole" in str(done.exception)


def test_a_job_of_a_service_is_opened_again_for_its_workers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    url = file_url(tmp_path / "jobs.sqlite").render_as_string()
    with Store(url) as store:
        new = NewJob(kind="synthesis", title="a", request={"family": "x"}, fingerprint="f", code="c" * 64)
        job, _ = store.submit(new)
        store.cancel(job)
        done = CliRunner().invoke(app, ["jobs", "resume", job, "--database", url])
        assert "open again" in done.output
        found = store.job(job)
        assert found is not None
        assert found.state == OPEN
        again = CliRunner().invoke(app, ["jobs", "resume", job, "--database", url])
        assert "this one is open" in str(again.exception)
        assert store.cancel(job)
        found = store.job(job)
        assert found is not None
        assert found.state == CANCELLED
