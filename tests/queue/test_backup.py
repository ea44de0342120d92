"""A copy that is taken while a batch is computed goes on elsewhere, and ends with the same bytes."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa

from synth.batches.batch_folder import DATABASE
from synth.batches.store import Store
from synth.queue.database import engine_for, file_url
from tests.batches.test_kill import small_table
from tests.terminal.entry import COMMAND, at_once, in_process
from tests.waiting import until

ROWS = 12
ASKED = ("--points", "1", "--objective", "mass", "-q")


@contextmanager
def restored(copy: Path, url: sa.URL, folder: Path) -> Iterator[str]:
    """Bring a copy back as another database; yield its address."""
    if url.get_backend_name() == "sqlite":
        folder.mkdir()
        shutil.copy(copy, folder / DATABASE)
        yield file_url(folder / DATABASE).render_as_string()
        return
    name = f"{url.database}_again"
    address = url.set(database=name)
    admin = engine_for(url, 5.0).execution_options(isolation_level="AUTOCOMMIT")
    try:
        with admin.connect() as connection:
            connection.execute(sa.text(f"CREATE DATABASE {name}"))
        place = address.set(drivername="postgresql").render_as_string(hide_password=False)
        subprocess.run(["pg_restore", "--no-owner", f"--dbname={place}", str(copy)], check=True)
        yield address.render_as_string(hide_password=False)
    finally:
        with admin.connect() as connection:
            connection.execute(sa.text(f"DROP DATABASE IF EXISTS {name} WITH (FORCE)"))
        admin.dispose()


def answered(url: str) -> int:
    """Return how many rows have an answer; none where the tables are just being made."""
    engine = engine_for(url, 5.0)
    try:
        with engine.connect() as connection:
            if not sa.inspect(connection).has_table("result"):
                return 0
            return int(connection.execute(sa.text("SELECT count(*) FROM result")).scalar_one())
    finally:
        engine.dispose()


@pytest.fixture
def database(new_database: str) -> str:
    """Return the address of a database in which nothing is: the batch makes its tables."""
    return new_database


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a table and of what a batch makes of it that nothing happens to."""
    folder = tmp_path_factory.mktemp("undisturbed")
    table = small_table(tmp_path_factory.mktemp("table"), ROWS)
    first = in_process("batch", table, "-o", folder, *ASKED)
    assert first.returncode == 0, first.stderr
    return folder


@pytest.mark.slow
def test_a_backup_of_a_batch_that_runs_goes_on_elsewhere_with_the_same_bytes(
    undisturbed: Path, tmp_path: Path, database: str
) -> None:
    url = sa.make_url(database)
    if url.get_backend_name() == "postgresql" and not (shutil.which("pg_dump") and shutil.which("pg_restore")):
        pytest.skip("NO PG_DUMP or pg_restore on this machine")
    table, copy = small_table(tmp_path, ROWS), tmp_path / "copy"
    words = ["batch", str(table), "-o", str(tmp_path / "out"), "--database", database, "--workers", "1", *ASKED]
    process = subprocess.Popen([*COMMAND, *words], stderr=subprocess.DEVNULL)
    try:
        until(lambda: process.poll() is not None or answered(database))
        assert process.poll() is None
        done = at_once("database", "backup", copy, "--database", database)
        assert done.returncode == 0, done.stderr
        assert process.poll() is None  # the batch has noticed nothing
    finally:
        process.kill()
        process.wait()
    with restored(copy, url, tmp_path / "again") as place:
        with Store(place, create=False) as store:
            (job,) = store.jobs()
            known = store.account(job.id).done
        assert 0 < known < ROWS
        again = in_process("batch", table, "-o", tmp_path / "again", "--database", place, *ASKED)
        assert again.returncode == 0, again.stderr
        with Store(place, create=False) as store:
            (same,) = store.jobs()
            assert (same.id, same.state) == (job.id, "done")
            assert store.account(job.id).done == ROWS
    designs = (tmp_path / "again" / "designs.csv").read_bytes()
    assert designs == (undisturbed / "designs.csv").read_bytes()
    assert len(designs.splitlines()) == ROWS + 1
