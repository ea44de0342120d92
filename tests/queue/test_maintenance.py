"""A database as a whole: looked over, copied while it is used, brought to the tables of today."""

from __future__ import annotations

import shutil
import sqlite3
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
import sqlalchemy as sa

from synth.batches.store import Store
from synth.errors import InputError
from synth.queue.database import HEAD, DamagedError, engine_for, file_url, refuse_damaged
from synth.queue.job_table import NewJob
from synth.queue.maintenance import back_up, bring_up, examine

NEW = NewJob(kind="synthesis", title="hoist", request={}, fingerprint="f", code="c")


def test_a_backup_is_a_database_with_the_same_jobs(database: str, tmp_path: Path) -> None:
    with Store(database) as store:
        name, _ = store.submit(NEW)
        copy = tmp_path / "backup"
        if store.engine.dialect.name == "postgresql" and shutil.which("pg_dump") is None:
            with pytest.raises(InputError, match="pg_dump"):
                back_up(database, copy)
            return
        back_up(database, copy)
    assert not list(tmp_path.glob("backup.part"))
    if database.startswith("sqlite"):
        with Store(file_url(copy), create=False) as store:
            assert store.job(name) is not None
    else:
        assert copy.read_bytes().startswith(b"PGDMP")


@pytest.mark.slow
def test_a_backup_is_taken_while_others_write(tmp_path: Path) -> None:
    url = file_url(tmp_path / "jobs.sqlite").render_as_string()
    with Store(url) as store:
        store.submit(NEW)
        stop = threading.Event()
        written: list[str] = []

        def write() -> None:
            while not stop.is_set():
                written.append(store.submit(NEW)[0])

        thread = threading.Thread(target=write)
        thread.start()
        counts = []
        for k in range(5):
            back_up(url, tmp_path / f"copy_{k}.sqlite")
            with Store(file_url(tmp_path / f"copy_{k}.sqlite"), create=False) as copy:
                jobs, units = (
                    copy.engine.connect().execute(sa.text(f"SELECT count(*) FROM {t}")).scalar_one()
                    for t in ("job", "unit")
                )
                assert jobs == units
                counts.append(jobs)
        stop.set()
        thread.join()
    assert written
    assert counts == sorted(counts)


def test_no_backup_is_written_over_another(tmp_path: Path) -> None:
    url = file_url(tmp_path / "jobs.sqlite").render_as_string()
    Store(url).close()
    (tmp_path / "copy").write_text("kept")
    with pytest.raises(InputError, match="a file that is not there yet"):
        back_up(url, tmp_path / "copy")
    assert (tmp_path / "copy").read_text() == "kept"
    with pytest.raises(InputError, match="a file in a folder that is there"):
        back_up(url, tmp_path / "nowhere" / "copy")


WOUNDS: dict[str, Callable[[bytearray], bytes]] = {
    "pages": lambda content: bytes(content[: 20 * 4096]) + b"\x07" * (4 * 4096) + bytes(content[24 * 4096 :]),
    "first page": lambda content: bytes(content[:100]) + b"\x07" * 3996 + bytes(content[4096:]),
    "head": lambda content: b"\x07" * 100 + bytes(content[100:]),
    "end": lambda content: bytes(content[: len(content) // 2]),
    "half a page": lambda content: bytes(content[:5000]),
    "text": lambda _: b"this is no database at all, and longer than the head of one" * 10,
}


@pytest.mark.parametrize("wound", WOUNDS)
def test_a_damaged_file_is_told_not_copied_and_not_served(tmp_path: Path, wound: str) -> None:
    file = tmp_path / "jobs.sqlite"
    url = file_url(file).render_as_string()
    with Store(url) as store:
        for _ in range(50):
            store.submit(NEW)
        store.engine.connect().exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
    assert examine(url).faults == ()
    refuse_damaged(store.engine)
    file.write_bytes(WOUNDS[wound](bytearray(file.read_bytes())))
    assert examine(url).faults
    with pytest.raises(DamagedError, match=r"move .*jobs.sqlite-wal.* away, and copy the backup to"):
        back_up(url, tmp_path / "copy")
    assert not list(tmp_path.glob("copy*"))
    with pytest.raises(DamagedError, match="a job database that is whole"), Store(url) as store:
        refuse_damaged(store.engine)


@pytest.mark.skipif(sys.platform == "win32", reason="rights of files are those of their folder")
def test_nobody_else_can_read_what_is_kept(tmp_path: Path) -> None:
    def rights(place: Path) -> int:
        return stat.S_IMODE(place.stat().st_mode)

    for data, before in ((tmp_path / "new", None), (tmp_path / "empty", 0o755), (tmp_path / "used", 0o755)):
        if before is not None:
            data.mkdir(mode=before)
        if data.name == "used":
            (data / "notes.txt").write_text("of somebody")
            (data / "jobs.sqlite").touch(mode=0o644)
        url = file_url(data / "jobs.sqlite").render_as_string()
        with Store(url) as store:
            store.submit(NEW)
            back_up(url, data / "copy.sqlite")
            assert rights(data) == (0o755 if data.name == "used" else 0o700)  # a folder of others' files is theirs
            made = [file for file in data.iterdir() if file.name != "notes.txt"]
            assert {file.name for file in made} == {"jobs.sqlite", "jobs.sqlite-wal", "jobs.sqlite-shm", "copy.sqlite"}
            assert {rights(file) for file in made} == {0o600}


def test_rows_that_belong_to_nothing_are_told(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    Store(file_url(file)).close()
    with sqlite3.connect(file) as connection:
        connection.execute("INSERT INTO event (job, time, kind, text) VALUES ('nobody', 0, 'a', 'b')")
    connection.close()
    (fault,) = examine(file_url(file).render_as_string()).faults
    assert fault.startswith("event: row ")


def test_looking_at_an_old_database_changes_nothing(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    with sqlite3.connect(file) as connection:
        connection.execute("CREATE TABLE batch_version (version_num VARCHAR(32))")
        connection.execute("INSERT INTO batch_version VALUES ('1')")
    connection.close()
    found = examine(file_url(file).render_as_string())
    assert (found.version, found.current) == ("1", False)


def test_what_is_not_there_is_not_made_by_looking(tmp_path: Path) -> None:
    url = file_url(tmp_path / "jobs.sqlite").render_as_string()
    with pytest.raises(InputError, match="a job database that exists"):
        examine(url)
    assert not list(tmp_path.iterdir())


def test_tables_are_brought_to_those_of_today(new_database: str) -> None:
    assert bring_up(new_database) == (None, HEAD)
    assert bring_up(new_database) == (HEAD, HEAD)
    assert examine(new_database).current
    engine = engine_for(new_database, 5.0)
    with engine.begin() as connection:
        connection.execute(sa.text("UPDATE batch_version SET version_num = '99'"))
    engine.dispose()
    assert not examine(new_database).current
    with pytest.raises(InputError, match="99"):
        bring_up(new_database)


def test_who_opens_a_file_again_ends_no_lock_on_it(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    url = file_url(file).render_as_string()
    program = "import sqlite3, sys; sqlite3.connect(sys.argv[1], timeout=0.1).execute('BEGIN IMMEDIATE')"

    def others_write() -> bool:
        return subprocess.run([sys.executable, "-c", program, file], capture_output=True, check=False).returncode == 0

    with Store(url) as store:
        assert others_write()
        with store.engine.connect() as connection:
            connection.exec_driver_sql("BEGIN IMMEDIATE")
            assert not others_write()
            with Store(url, create=False):
                assert not others_write()
            assert not others_write()
