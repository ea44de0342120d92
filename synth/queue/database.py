"""One database of jobs, SQLite or PostgreSQL: opened, and brought to the tables that this version uses.

Both run the same statements. SQLite has one writer at a time, and all who open it wait for each other.
"""

from __future__ import annotations

import errno
import hashlib
import json
import shutil
import sqlite3
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import ArgumentError, DBAPIError, NoSuchModuleError
from sqlalchemy.orm import DeclarativeBase

from synth.errors import InputError
from synth.queue.models import VERSION_TABLE
from synth.queue.settings import STORE, StoreSettings
from synth.system.operating_system import private_file, private_folder
from synth.text.plain_text import one_line

HEAD = "2"  # the last of the migrations
INTACT = "a job database that is whole"
SIDE_FILES = ("-wal", "-shm")  # endings of what SQLite keeps beside a file
DISK_FULL = "53100"  # state that PostgreSQL tells where it has no room
LOCK = 0x636C7574  # of PostgreSQL, while tables are made


def encoded(value: object) -> str:
    """Return JSON of one form only: the same value always gives the same text."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)


def digest(value: object) -> str:
    """Return the SHA-256 of a value that JSON can hold."""
    return hashlib.sha256(encoded(value).encode("utf-8", "surrogatepass")).hexdigest()


def way_back(file: str) -> str:
    """Instructions for replacing a SQLite file by its backup."""
    old = ", ".join(f"{file}{ending}" for ending in ("", *SIDE_FILES))
    return f"to go back to a backup, end all that uses it, move {old} away, and copy the backup to {file}"


class DamagedError(InputError):
    """A SQLite file that is no job database, or is damaged; it says the way back.

    Parameters
    ----------
    file, reason : str
    """

    def __init__(self, file: str, reason: str) -> None:
        super().__init__("--database", file, f"{INTACT} ({reason}); {way_back(file)}")
        self.reason = reason

    def __reduce__(self) -> tuple[type[DamagedError], tuple[str, str]]:  # type: ignore[override]
        """Pickle by what is damaged, and how."""
        return type(self), (str(self.value), self.reason)


def refuse_damaged(engine: sa.Engine) -> None:
    """Refuse a SQLite file of which pages are damaged.

    Raises
    ------
    DamagedError
    """
    if engine.dialect.name == "sqlite":
        with engine.connect() as connection:
            verdict = str(connection.exec_driver_sql("PRAGMA quick_check(1)").scalar())
        if verdict != "ok":
            raise DamagedError(str(engine.url.database), one_line(verdict))


# ---- opening --------------------------------------------------------------------------------------------------------


def engine_for(url: str | sa.URL, patience: float, overflow: int = STORE.overflow) -> sa.Engine:
    """Return the engine of a database.

    Parameters
    ----------
    url : str
        ``sqlite:///path`` or ``postgresql://user@host/name``.
    patience : float
        Of :class:`StoreSettings`, for SQLite; PostgreSQL waits by itself.
    overflow : int
        Of :class:`StoreSettings`.

    Raises
    ------
    InputError
        The text is not such an address, or what PostgreSQL needs is not installed.
    """
    right = "an address such as sqlite:///jobs.sqlite or postgresql://user@host/name"
    try:
        address = sa.make_url(url)
    except ArgumentError:
        raise InputError("--database", url, right) from None
    kind = address.get_backend_name()
    shown = address.render_as_string(hide_password=True)
    if kind not in ("sqlite", "postgresql"):
        raise InputError("--database", shown, right)
    if kind == "sqlite" and address.database in (None, "", ":memory:"):
        raise InputError("--database", shown, "the name of a file: a job in memory would end with its process")
    if address.drivername == "postgresql":
        address = address.set(drivername="postgresql+psycopg")
    try:
        engine = sa.create_engine(
            address,
            connect_args={"timeout": patience} if kind == "sqlite" else {},
            pool_pre_ping=True,
            max_overflow=overflow,
            json_deserializer=_ReadBack(shown),
        )
    except (ImportError, NoSuchModuleError) as error:
        expected = "an installed driver: pip install 'clutchsynth[postgres]'"
        raise InputError("--database", shown, expected) from error
    if kind == "sqlite":
        sa.event.listen(engine, "connect", lambda connection, _: _prepare_sqlite(connection, patience))
        sa.event.listen(engine, "handle_error", _report_fault)
    return engine


@dataclass(frozen=True)
class _ReadBack:
    """Reads cells of JSON of one database; a function made for each database would stay in the driver's cache."""

    shown: str

    def __call__(self, text: str | bytes) -> Any:
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError("--database", self.shown, f"{INTACT} (a cell that cannot be read)") from error


def _report_fault(context: sa.engine.ExceptionContext) -> None:
    """Raise an error for a SQLite file where waiting does not help: no room, damaged, not ours.

    Raises
    ------
    OSError
        There is no room, or the disk fails.
    InputError
        The file is not a job database, or no longer.
    """
    error = context.original_exception
    if not isinstance(error, sqlite3.Error) or context.engine is None:
        return
    file, reason = str(context.engine.url.database), str(error)
    primary = getattr(error, "sqlite_errorcode", 0) & 0xFF
    if primary in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR):
        raise OSError(errno.ENOSPC if primary == sqlite3.SQLITE_FULL else errno.EIO, reason, file) from error
    if primary in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB) or reason.startswith("no such "):
        raise DamagedError(file, reason) from error


def _prepare_sqlite(connection: sqlite3.Connection, patience: float) -> None:
    cursor = connection.cursor()
    for pragma in (f"busy_timeout={1000 * patience:.0f}", "synchronous=NORMAL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    _write_ahead(cursor, patience)
    cursor.close()


def _write_ahead(cursor: sqlite3.Cursor, patience: float) -> None:
    """Let there be readers and one writer at a time; a killed process loses nothing that was committed.

    While another process writes into a file that is new, SQLite refuses to change it so without waiting at all.
    """
    deadline, pause = time.monotonic() + patience, 0.005
    while True:
        try:
            if cursor.execute("PRAGMA page_count").fetchone()[0] == 0:  # a file that is new can give back what it frees
                cursor.execute("PRAGMA auto_vacuum=INCREMENTAL")
            cursor.execute("PRAGMA journal_mode=WAL")
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode & 0xFF not in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
                raise
            if time.monotonic() > deadline:
                raise
        else:
            return
        time.sleep(pause)
        pause = min(2 * pause, 0.25)


def file_url(path: Path) -> sa.URL:
    """Return the address of a SQLite file, whatever letters are in its name."""
    return sa.URL.create("sqlite", database=str(path))


def migrate(engine: sa.Engine) -> None:
    """Bring the tables of a database to the form that this version uses.

    Raises
    ------
    InputError
        The database was made by a later version: its tables are at none of the migrations that this one knows.
    """
    if version_of(engine) == HEAD:
        return
    from alembic import command  # costly to import; a database needs it once
    from alembic.config import Config
    from alembic.script import ScriptDirectory

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).with_name("migrations")).replace("%", "%%"))
    chain = {revision.revision for revision in ScriptDirectory.from_config(config).walk_revisions()}
    _keep_copy(engine, chain)
    with engine.connect() as connection:
        if engine.dialect.name == "sqlite":
            connection.exec_driver_sql("BEGIN IMMEDIATE")
        else:
            connection.execute(sa.select(sa.func.pg_advisory_xact_lock(LOCK)))
        known = _version_on(connection)
        if known is not None and known not in chain:
            raise InputError(
                "--database",
                engine.url.render_as_string(hide_password=True),
                f"tables of version {HEAD}; these are {known}",
            )
        if known != HEAD:
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
        connection.commit()


def _keep_copy(engine: sa.Engine, chain: set[str]) -> None:
    """Copy a SQLite file of an earlier version beside itself, before its tables are changed."""
    known = version_of(engine)
    if engine.dialect.name != "sqlite" or known not in chain:
        return
    copy = f"{engine.url.database}.v{known}"
    if not Path(copy).exists():
        private_file(Path(copy))
        with engine.connect() as connection:
            connection.exec_driver_sql("VACUUM INTO ?", (copy,))


def version_of(engine: sa.Engine) -> str | None:
    """Return of which version the tables of a database are; None where there are none."""
    with engine.connect() as connection:
        return _version_on(connection)


def _version_on(connection: sa.Connection) -> str | None:
    if not sa.inspect(connection).has_table(VERSION_TABLE):
        return None
    version = connection.execute(sa.text(f"SELECT version_num FROM {VERSION_TABLE}")).scalar()
    return None if version is None else str(version)


def _refuse_empty(engine: sa.Engine, shown: str) -> None:
    """Refuse a database without tables of ours: somebody has emptied it, or means another one."""
    if version_of(engine) is None:
        raise InputError("--database", shown, f"{INTACT} (there are no jobs in it)")


def _find_file(file: Path, create: bool) -> None:
    """Refuse a SQLite file that is not there, or make its folder."""
    if not file.exists() and not create:
        raise InputError("--database", str(file), "a job database that exists")
    if file.exists() and not file.is_file():
        raise InputError("--database", str(file), "a job database; this is no regular file")
    private_folder(file.parent)
    for name in (file, *(file.with_name(f"{file.name}{ending}") for ending in SIDE_FILES)):
        if name == file or name.exists():
            private_file(name)


# ---- the database --------------------------------------------------------------------------------------------------


class Database:
    """One job database.

    Parameters
    ----------
    url : str
        ``sqlite:///path`` or ``postgresql://user@host/name``.
    create : bool
        Whether a SQLite file may be made; PostgreSQL databases must be there.
    settings : StoreSettings, optional

    Raises
    ------
    InputError
        The database cannot be opened.
    """

    def __init__(self, url: str | sa.URL, create: bool = True, settings: StoreSettings = STORE) -> None:
        self.settings = settings
        self.engine = engine_for(url, settings.patience, settings.overflow)
        self.url = self.engine.url.render_as_string(hide_password=True)
        try:
            if self.engine.dialect.name == "sqlite":
                _find_file(Path(str(self.engine.url.database)), create)
            if not create:
                _refuse_empty(self.engine, self.url)
            migrate(self.engine)
        except InputError:
            self.engine.dispose()
            raise
        except (DBAPIError, OSError) as error:
            self.engine.dispose()
            reason = str(getattr(error, "orig", error)).strip().splitlines()
            expected = f"a database that can be opened ({reason[0] if reason else type(error).__name__})"
            raise InputError("--database", self.url, expected) from error

    def version(self) -> str | None:
        """Return of which version the tables are, as the database says now; None where there are none."""
        return version_of(self.engine)

    def probe(self) -> None:
        """Write what is there already.

        Raises
        ------
        OSError, DBAPIError
            Nothing can be written.
        """
        with self.engine.begin() as connection:
            connection.execute(sa.text(f"UPDATE {VERSION_TABLE} SET version_num = version_num"))

    def free_space(self) -> int | None:
        """Free bytes where a SQLite file is; None of a server, which looks after its own."""
        if self.engine.dialect.name != "sqlite":
            return None
        return shutil.disk_usage(Path(str(self.engine.url.database)).absolute().parent).free

    def shrink(self, most: int) -> None:
        """Give pages of a SQLite file that hold nothing any more back to the disk; older files keep theirs.

        Parameters
        ----------
        most : int
            Pages.
        """
        if self.engine.dialect.name != "sqlite":
            return
        with self.engine.connect() as connection:
            if connection.exec_driver_sql("PRAGMA freelist_count").scalar():
                driver: Any = connection.connection.driver_connection
                with suppress(sqlite3.OperationalError):  # others write for long: the next round does it
                    driver.executescript(f"PRAGMA incremental_vacuum({most})")  # a mere execute gives back one page

    def close(self) -> None:
        """Let go of the connections."""
        self.engine.dispose()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def insert_once(self, table: type[DeclarativeBase]) -> Any:
        """Return an insert that leaves what is there already."""
        make = sqlite.insert if self.engine.dialect.name == "sqlite" else postgresql.insert
        return make(table).on_conflict_do_nothing()
