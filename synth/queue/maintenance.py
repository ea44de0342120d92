"""What is done to a job database as a whole: looked over, copied while it is used, brought to the tables of today."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
from dataclasses import dataclass
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.exc import DBAPIError

from synth.errors import InputError
from synth.queue.database import HEAD, INTACT, DamagedError, Database, engine_for, version_of
from synth.queue.settings import STORE
from synth.system.operating_system import private_file, put_in_place

SHOWN = 5  # faults of a damaged file that are listed


@dataclass(frozen=True)
class Finding:
    """What was found of a database: of which version its tables are, and what is wrong with it."""

    url: str
    version: str | None
    faults: tuple[str, ...]

    @property
    def current(self) -> bool:
        """Whether its tables are those that this version uses."""
        return self.version == HEAD

    @property
    def file(self) -> str:
        """The file of a SQLite database, the name of one on a server."""
        return str(sa.make_url(self.url).database)


def examine(url: str) -> Finding:
    """Look a database over; nothing is changed.

    Raises
    ------
    InputError
        There is none, or it cannot be opened.
    """
    engine = engine_for(url, STORE.patience)
    shown = engine.url.render_as_string(hide_password=True)
    try:
        if engine.dialect.name == "sqlite" and not Path(str(engine.url.database)).is_file():
            raise InputError("--database", shown, "a job database that exists")
        return Finding(shown, version_of(engine), _faults(engine))
    except DamagedError as damaged:  # so much that it cannot even be looked through
        return Finding(shown, None, (damaged.reason,))
    except (DBAPIError, OSError) as error:
        reason = str(getattr(error, "orig", error)).strip().split("\n")[0]
        raise InputError("--database", shown, f"{INTACT} ({reason})") from error
    finally:
        engine.dispose()


def _faults(engine: sa.Engine) -> tuple[str, ...]:
    """Faults of a SQLite file; a server looks after its own."""
    if engine.dialect.name != "sqlite":
        return ()
    with engine.connect() as connection:
        bad = [str(row[0]) for row in connection.exec_driver_sql(f"PRAGMA integrity_check({SHOWN})")]
        loose = connection.exec_driver_sql("PRAGMA foreign_key_check").fetchmany(SHOWN)
    return (*(text for text in bad if text != "ok"), *(f"{row[0]}: row {row[1]} belongs to nothing" for row in loose))


def bring_up(url: str) -> tuple[str | None, str]:
    """Bring the tables of a database to today's form; return of which version they were, and are."""
    engine = engine_for(url, STORE.patience)
    try:
        known = engine.dialect.name != "sqlite" or Path(str(engine.url.database)).is_file()
        before = version_of(engine) if known else None
    except (DBAPIError, OSError):
        before = None  # what is wrong is told by whoever opens it
    finally:
        engine.dispose()
    with Database(url) as database:
        return before, str(database.version())


def back_up(url: str, file: Path) -> None:
    """Copy a database into a file that is not there yet, while others use it; what is half done is not in the copy.

    Raises
    ------
    InputError
        The file is there already, or the database cannot be copied.
    """
    if file.exists():
        raise InputError("FILE", str(file), "a file that is not there yet: no backup is written over another")
    if not file.parent.is_dir():
        raise InputError("FILE", str(file), "a file in a folder that is there")
    finding = examine(url)
    if finding.faults:
        raise DamagedError(finding.file, finding.faults[0])
    engine = engine_for(url, STORE.patience)
    half = file.with_name(f"{file.name}.part")
    half.unlink(missing_ok=True)  # left by a backup that was interrupted
    try:
        private_file(half)
        (_copy_file if engine.dialect.name == "sqlite" else _dump)(engine, half)
        put_in_place(half, file)
    finally:
        half.unlink(missing_ok=True)
        engine.dispose()


def _copy_file(engine: sa.Engine, file: Path) -> None:
    with engine.connect() as connection:
        connection.exec_driver_sql("VACUUM INTO ?", (str(file),))
    copy = sqlite3.connect(file)
    try:
        verdict = copy.execute("PRAGMA integrity_check").fetchone()[0]
    finally:
        copy.close()
    if verdict != "ok":
        raise InputError("FILE", str(file), f"a disk that keeps what is written ({verdict})")


def _dump(engine: sa.Engine, file: Path) -> None:
    program = shutil.which("pg_dump")
    shown = engine.url.render_as_string(hide_password=True)
    if program is None:
        raise InputError("--database", shown, "the program pg_dump on this machine, which copies such databases")
    address = engine.url.set(drivername="postgresql", password=None).render_as_string(hide_password=False)
    password = {} if engine.url.password is None else {"PGPASSWORD": str(engine.url.password)}
    done = subprocess.run(
        [program, "--format=custom", "--no-password", f"--file={file}", f"--dbname={address}"],
        env={**os.environ, **password},
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        check=False,
    )
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or [f"code {done.returncode}"])[0]
        raise InputError("--database", shown, f"a database that pg_dump can copy ({reason})")
