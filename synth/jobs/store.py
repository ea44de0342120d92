"""The job database: what is to be done, by whom, and what came out. It alone is the truth; whoever works may die.

A unit is claimed for a time, and the claim is renewed while its owner lives. A result is written only by the owner
that still holds the claim (its token counts claims), in one transaction with the end of the unit; written twice, it
stays the first. SQLite and PostgreSQL run the same statements.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import json
import os
import socket
import sqlite3
import time
import uuid
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import ArgumentError, DBAPIError, IntegrityError, NoSuchModuleError
from sqlalchemy.orm import Session

from synth.errors import InputError
from synth.jobs.job_settings import JOBS, StoreSettings
from synth.jobs.models import VERSION_TABLE, Event, Job, Layout, Result, Row, RowQuestion, WorkUnit, moment
from synth.jobs.solve import GROUP

HEAD = "1"  # the last of the migrations
WHOLE = "a job database that is whole"
LOCK = 0x636C7574  # of PostgreSQL, while tables are made
NONE_ALONE: Mapping[str, str] = MappingProxyType({})  # no question that a group leaves to be asked alone
OPEN, RUNNING, DONE, CANCELLED = "open", "running", "done", "cancelled"


def encoded(value: Any) -> str:
    """Return JSON of one form only: the same value always gives the same text."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)


def digest(value: Any) -> str:
    """Return the SHA-256 of a value that JSON can hold."""
    return hashlib.sha256(encoded(value).encode("utf-8", "surrogatepass")).hexdigest()


@dataclass(frozen=True)
class Claim:
    """A unit that this owner may work on, as long as the lease is renewed."""

    unit: int
    token: int
    attempts: int
    questions: dict[str, Any]  # by key


@dataclass(frozen=True)
class Outcome:
    """The answer to a question, as it is kept."""

    status: str
    seconds: float
    layout: Mapping[str, Any] | None
    content: Mapping[str, Any]


@dataclass(frozen=True)
class Account:
    """How far a job is, counted in rows of the table."""

    rows: int
    bad: int
    status: Mapping[str, int]

    @property
    def done(self) -> int:
        """Rows that need no more work; those that ask no question are among them."""
        return self.bad + sum(self.status.values())


@dataclass(frozen=True)
class Answered:
    """A row beside its answer; without one it is not solved yet."""

    line: int
    key: str | None
    family: str
    cells: list[str]
    remarks: str
    faults: list[dict[str, Any]]
    status: str | None
    seconds: float | None
    layout: str | None
    content: dict[str, Any] | None


# ---- opening --------------------------------------------------------------------------------------------------------


def engine_for(url: str | sa.URL, patience: float) -> sa.Engine:
    """Return the engine of a database.

    Parameters
    ----------
    url : str
        ``sqlite:///path`` or ``postgresql://user@host/name``.
    patience : float
        Of :class:`StoreSettings`, for SQLite; PostgreSQL waits by itself.

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
            json_deserializer=lambda text: _read_back(text, shown),
        )
    except (ImportError, NoSuchModuleError) as error:
        wanted = "an installed driver: pip install 'clutchsynth[postgres]'"
        raise InputError("--database", shown, wanted) from error
    if kind == "sqlite":
        sa.event.listen(engine, "connect", lambda connection, _: _prepare_sqlite(connection, patience))
        sa.event.listen(engine, "handle_error", _tell_fault)
    return engine


def _read_back(text: str, shown: str) -> Any:
    """Return what a cell of JSON says."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError("--database", shown, f"{WHOLE} (a cell that cannot be read)") from error


def _tell_fault(context: sa.engine.ExceptionContext) -> None:
    """Tell what is wrong with a SQLite file where waiting does not help: no room, damaged, not ours.

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
        raise InputError("--database", file, f"{WHOLE} ({reason})") from error


def _prepare_sqlite(connection: Any, patience: float) -> None:
    cursor = connection.cursor()
    for pragma in (f"busy_timeout={1000 * patience:.0f}", "synchronous=NORMAL", "foreign_keys=ON"):
        cursor.execute(f"PRAGMA {pragma}")
    _write_ahead(cursor, patience)
    cursor.close()


def _write_ahead(cursor: Any, patience: float) -> None:
    """Let there be readers and one writer at a time; a killed process loses nothing that was committed.

    While another process writes into a file that is new, SQLite refuses to change it so without waiting at all.
    """
    deadline, pause = time.monotonic() + patience, 0.005
    while True:
        try:
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
    if _version(engine) == HEAD:
        return
    from alembic import command  # costly to import; a database needs it once
    from alembic.config import Config
    from alembic.script import ScriptDirectory

    config = Config()
    config.set_main_option("script_location", str(Path(__file__).with_name("migrations")).replace("%", "%%"))
    chain = {revision.revision for revision in ScriptDirectory.from_config(config).walk_revisions()}
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


def _version(engine: sa.Engine) -> str | None:
    with engine.connect() as connection:
        return _version_on(connection)


def _version_on(connection: sa.Connection) -> str | None:
    if not sa.inspect(connection).has_table(VERSION_TABLE):
        return None
    found = connection.execute(sa.text(f"SELECT version_num FROM {VERSION_TABLE}")).scalar()
    return None if found is None else str(found)


def _refuse_empty(engine: sa.Engine, shown: str) -> None:
    """Refuse a database without tables of ours: somebody has emptied it, or means another one."""
    if _version(engine) is None:
        raise InputError("--database", shown, f"{WHOLE} (there are no jobs in it)")


def _find_file(file: Path, create: bool) -> None:
    """Refuse a SQLite file that is not there, or make its folder."""
    if not file.exists() and not create:
        raise InputError("--database", str(file), "a job database that exists")
    if file.exists() and not file.is_file():
        raise InputError("--database", str(file), "a job database; this is no regular file")
    file.parent.mkdir(parents=True, exist_ok=True)


# ---- owners ---------------------------------------------------------------------------------------------------------


def new_owner() -> str:
    """Return a name for this process that no other has: host, process, when it began, and a random part."""
    return f"{socket.gethostname()}/{os.getpid()}/{_beginning(os.getpid())}/{uuid.uuid4().hex[:12]}"


def has_died(owner: str) -> bool:
    """Tell whether an owner was a process of this machine that is gone; of other machines only the lease tells."""
    parts = owner.rsplit("/", 3)
    if len(parts) != 4 or parts[0] != socket.gethostname():
        return False
    process, beginning = parts[1], parts[2]
    if not process.isdigit():
        return False
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return beginning != _beginning(int(process))  # the number went to another process


def _beginning(process: int) -> str:
    """Return when a process began, in the clock ticks of the system; an empty text where it does not tell."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace").rsplit(")", 1)[1].split()[19]
    except (OSError, IndexError):
        return ""


# ---- the store ------------------------------------------------------------------------------------------------------


class Store:
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

    def __init__(self, url: str | sa.URL, create: bool = True, settings: StoreSettings = JOBS.store) -> None:
        self.settings = settings
        self.engine = engine_for(url, settings.patience)
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
            wanted = f"a database that can be opened ({reason[0] if reason else type(error).__name__})"
            raise InputError("--database", self.url, wanted) from error

    def close(self) -> None:
        """Let go of the connections."""
        self.engine.dispose()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- jobs ----------------------------------------------------------------------------------

    def job(self, job: str) -> Job | None:
        """Return a job; None where there is none."""
        with Session(self.engine, expire_on_commit=False) as session:
            return session.get(Job, job)

    def jobs(self) -> list[Job]:
        """Return all jobs, the latest first."""
        with Session(self.engine, expire_on_commit=False) as session:
            return list(session.scalars(sa.select(Job).order_by(Job.created.desc(), Job.id)))

    def create(self, job: Mapping[str, Any], rows: Iterable[Mapping[str, Any]], rows_per_unit: int) -> bool:
        """Write a job with its rows, questions and units, all or nothing.

        Parameters
        ----------
        job : mapping
            The columns of the job, ``rows`` and times apart.
        rows : iterable of mapping
            The columns of the rows, each with ``question``, its columns or None; read once, not kept.
        rows_per_unit : int
            Questions of one structure that are a unit; a group is one, whatever its size.

        Returns
        -------
        bool
            False where another process has made the same job meanwhile.
        """
        name = str(job["id"])
        try:
            with self.engine.begin() as connection:
                connection.execute(sa.insert(Job).values(**job, rows=0, state=OPEN, created=moment(), updated=moment()))
                count = self._write_rows(connection, name, rows)
                connection.execute(sa.update(Job).where(Job.id == name).values(rows=count))
                known = self._copy_known(connection, name, str(job["basis"]))
                units = self._write_units(connection, name, rows_per_unit)
                _tell(connection, name, "created", f"{count} rows in {units} units, {known} questions answered before")
        except IntegrityError:
            if self.job(name) is None:
                raise
            return False
        return True

    def _write_rows(self, connection: sa.Connection, job: str, rows: Iterable[Mapping[str, Any]]) -> int:
        count = 0
        for some in _chunks(rows, self.settings.chunk):
            asked = [{"job": job, "unit": None, **row["question"]} for row in some if row["question"] is not None]
            if asked:
                connection.execute(self._insert_once(RowQuestion), asked)
            connection.execute(
                sa.insert(Row), [{"job": job, **{k: v for k, v in row.items() if k != "question"}} for row in some]
            )
            count += len(some)
        return count

    def _copy_known(self, connection: sa.Connection, job: str, basis: str) -> int:
        """Take the answers that another job of the same basis has; return how many."""
        asked = sa.select(RowQuestion.key).where(RowQuestion.job == job)
        others = sa.select(Job.id).where(Job.basis == basis, Job.id != job)
        usable = sa.and_(Result.job.in_(others), Result.key.in_(asked), Result.status != "failed")
        answers = sa.select(
            sa.literal(job), Result.key, Result.status, Result.seconds, Result.layout, Result.content
        ).where(usable)
        columns = ["job", "key", "status", "seconds", "layout", "content"]
        connection.execute(self._insert_once(Result).from_select(columns, answers))
        taken = sa.select(Result.layout).where(Result.job == job)
        layouts = sa.select(sa.literal(job), Layout.key, Layout.content).where(
            Layout.job.in_(others), Layout.key.in_(taken)
        )
        connection.execute(self._insert_once(Layout).from_select(["job", "key", "content"], layouts))
        return int(
            connection.execute(sa.select(sa.func.count()).select_from(Result).where(Result.job == job)).scalar_one()
        )

    def _write_units(self, connection: sa.Connection, job: str, rows_per_unit: int) -> int:
        order = (RowQuestion.structure, RowQuestion.position, RowQuestion.key)
        answered = sa.select(Result.key).where(Result.job == job)
        group = RowQuestion.content[GROUP]
        asked = connection.execute(
            sa.select(RowQuestion.structure, RowQuestion.key, group["name"].as_string(), group["rows"].as_integer())
            .where(RowQuestion.job == job, RowQuestion.key.not_in(answered))
            .order_by(*order)
        ).all()
        units: list[list[str]] = []
        for (_, _, rows), same in itertools.groupby(asked, key=lambda question: (question[0], *question[2:])):
            keys = [question[1] for question in same]
            # What is left of a group that was answered before cannot be answered as the group was.
            units += [keys] if len(keys) == rows else _chunks(keys, rows_per_unit)
        for some in _chunks(units, self.settings.chunk):
            self._add_units(connection, job, some, 0)
        return len(units)

    @staticmethod
    def _add_units(connection: sa.Connection, job: str, units: Sequence[Sequence[str]], attempts: int) -> None:
        new = {"job": job, "state": OPEN, "token": 0, "attempts": attempts}
        numbers = connection.execute(
            sa.insert(WorkUnit).returning(WorkUnit.id, sort_by_parameter_order=True), [new for _ in units]
        ).scalars()
        members = [{"of_unit": unit, "of_key": key} for unit, keys in zip(numbers, units, strict=True) for key in keys]
        connection.execute(
            sa.update(cast(sa.Table, RowQuestion.__table__))
            .where(RowQuestion.job == job, RowQuestion.key == sa.bindparam("of_key"))
            .values(unit=sa.bindparam("of_unit")),
            members,
        )

    def _insert_once(self, table: Any) -> Any:
        """Return an insert that leaves what is there already."""
        make = sqlite.insert if self.engine.dialect.name == "sqlite" else postgresql.insert
        return make(table).on_conflict_do_nothing()

    def set_state(self, job: str, state: str, kind: str, text: str = "") -> None:
        """Change the state of a job, and say so among its events."""
        with self.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == job).values(state=state, updated=moment()))
            _tell(connection, job, kind, text)

    def set_folder(self, job: str, folder: str) -> None:
        """Note where the results of a job are written."""
        with self.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == job).values(folder=folder, updated=moment()))

    # -- work ----------------------------------------------------------------------------------

    def claim(self, job: str, owner: str, most: int, lease: float | None = None) -> list[Claim]:
        """Take units that are open, or whose owner has not renewed its lease; for so many seconds, or as set."""
        free = sa.or_(WorkUnit.state == OPEN, sa.and_(WorkUnit.state == RUNNING, WorkUnit.lease < moment()))
        # PostgreSQL passes over what others are just taking; SQLite has one writer at a time and ignores the clause.
        wanted = (
            sa.select(WorkUnit.id)
            .where(WorkUnit.job == job, free)
            .order_by(WorkUnit.id)
            .limit(most)
            .with_for_update(skip_locked=True)
            .cte("wanted")
        )
        take = (
            sa.update(WorkUnit)
            .where(WorkUnit.id.in_(sa.select(wanted.c.id)))
            .values(state=RUNNING, owner=owner, lease=self._until(lease), token=WorkUnit.token + 1)
            .returning(WorkUnit.id, WorkUnit.token, WorkUnit.attempts)
            .execution_options(synchronize_session=False)
        )
        with self.engine.begin() as connection:
            taken = sorted(tuple(unit) for unit in connection.execute(take))
            if not taken:
                return []
            asked = connection.execute(
                sa.select(RowQuestion.unit, RowQuestion.key, RowQuestion.content)
                .where(RowQuestion.unit.in_([unit[0] for unit in taken]))
                .order_by(RowQuestion.position, RowQuestion.key)
            ).all()
        return [
            Claim(unit, token, attempts, {key: content for of, key, content in asked if of == unit})
            for unit, token, attempts in taken
        ]

    def _until(self, lease: float | None) -> sa.ColumnElement[float]:
        return moment() + (self.settings.lease if lease is None else lease)

    def renew(self, owner: str, lease: float | None = None) -> None:
        """Give a sign of life: everything that an owner works on stays its own."""
        with self.engine.begin() as connection:
            connection.execute(
                sa.update(WorkUnit)
                .where(WorkUnit.owner == owner, WorkUnit.state == RUNNING)
                .values(lease=self._until(lease))
            )

    def release(self, owner: str) -> None:
        """Give back everything that an owner works on; that is no failed attempt."""
        with self.engine.begin() as connection:
            connection.execute(
                sa.update(WorkUnit)
                .where(WorkUnit.owner == owner, WorkUnit.state == RUNNING)
                .values(state=OPEN, owner=None, lease=None)
            )

    def release_dead(self, job: str) -> int:
        """Take units back from processes of this machine that are gone, without waiting for their leases."""
        with self.engine.begin() as connection:
            owners = connection.scalars(
                sa.select(WorkUnit.owner).where(WorkUnit.job == job, WorkUnit.state == RUNNING).distinct()
            ).all()
        dead = [owner for owner in owners if owner is not None and has_died(owner)]
        for owner in dead:
            self.release(owner)
        return len(dead)

    def finish(
        self,
        job: str,
        claim: Claim,
        owner: str,
        outcomes: Mapping[str, Outcome],
        errors: Mapping[str, str],
        most_attempts: int,
        alone: Mapping[str, str] = NONE_ALONE,
    ) -> bool:
        """Write what came out of a unit, if the owner still holds it.

        Parameters
        ----------
        job, claim, owner
            The unit, and who holds it.
        outcomes : mapping
            Question key -> answer.
        errors : mapping
            Question key -> error. Each of these questions is tried again in a unit of its own, until it has failed
            ``most_attempts`` times; then it is answered by its error.
        most_attempts : int
        alone : mapping
            Question key -> why it has to be asked alone, as one of a group: each in a unit of its own, as if for the
            first time.

        Returns
        -------
        bool
            False where another owner has the unit; then nothing is written.
        """
        attempts = claim.attempts + 1
        final = dict(outcomes)
        again = [key for key in errors if attempts < most_attempts]
        final |= {
            key: Outcome("failed", 0.0, None, {"error": error, "attempts": attempts})
            for key, error in errors.items()
            if attempts >= most_attempts
        }
        with self.engine.begin() as connection:
            held = connection.execute(
                sa.update(WorkUnit).where(*_held(claim, owner)).values(state=DONE, lease=None, attempts=attempts)
            )
            if held.rowcount != 1:
                return False
            layouts = {digest(o.layout): o.layout for o in final.values() if o.layout is not None}
            if layouts:
                connection.execute(
                    self._insert_once(Layout), [{"job": job, "key": k, "content": v} for k, v in layouts.items()]
                )
            if final:
                connection.execute(
                    self._insert_once(Result),
                    [
                        {
                            "job": job,
                            "key": key,
                            "status": o.status,
                            "seconds": o.seconds,
                            "content": o.content,
                            "layout": None if o.layout is None else digest(o.layout),
                        }
                        for key, o in final.items()
                    ],
                )
            for keys, tried in ((again, attempts), (list(alone), claim.attempts)):
                if keys:
                    self._add_units(connection, job, [[key] for key in keys], tried)
            for key, error in errors.items():
                _tell(connection, job, "failed", f"attempt {attempts} of question {key[:12]}: {error}")
            for reason, count in Counter(filter(None, alone.values())).items():
                _tell(connection, job, "alone", f"{count} questions of a group: {reason}")
        return True

    def put_back(self, job: str, claim: Claim, owner: str, error: str) -> bool:
        """Leave a whole unit to be tried again, after an attempt that ended in an error; as for :meth:`finish`."""
        with self.engine.begin() as connection:
            held = connection.execute(
                sa.update(WorkUnit)
                .where(*_held(claim, owner))
                .values(state=OPEN, owner=None, lease=None, attempts=claim.attempts + 1)
            )
            if held.rowcount == 1:
                text = f"attempt {claim.attempts + 1} of {len(claim.questions)} questions: {error}"
                _tell(connection, job, "failed", text)
        return bool(held.rowcount == 1)

    # -- looking -------------------------------------------------------------------------------

    def open_units(self, job: str) -> tuple[int, int]:
        """Return how many units are open, and how many somebody works on."""
        with self.engine.begin() as connection:
            counted = connection.execute(
                sa.select(WorkUnit.state, sa.func.count()).where(WorkUnit.job == job).group_by(WorkUnit.state)
            )
            found = {state: count for state, count in counted}
        return int(found.get(OPEN, 0)), int(found.get(RUNNING, 0))

    def account(self, job: str) -> Account:
        """Count the rows of a job by what became of them."""
        with self.engine.begin() as connection:
            rows, bad = connection.execute(
                sa.select(sa.func.count(), sa.func.count() - sa.func.count(Row.key)).where(Row.job == job)
            ).one()
            joined = sa.and_(Result.job == Row.job, Result.key == Row.key)
            counted = connection.execute(
                sa.select(Result.status, sa.func.count())
                .select_from(Row)
                .join(Result, joined)
                .where(Row.job == job)
                .group_by(Result.status)
            )
            status = {name: count for name, count in counted}
        return Account(int(rows), int(bad), status)

    def rows(self, job: str, canonical: bool) -> Iterator[Answered]:
        """Return the rows beside their answers, some at a time: in canonical order, or as in the table."""
        joined = sa.and_(Result.job == Row.job, Result.key == Row.key)
        asked = (
            sa.select(
                Row.line,
                Row.key,
                Row.family,
                Row.cells,
                Row.remarks,
                Row.faults,
                Result.status,
                Result.seconds,
                Result.layout,
                Result.content,
            )
            .join(Result, joined, isouter=True)
            .where(Row.job == job)
            .order_by(*((Row.position, Row.line) if canonical else (Row.line,)))
        )
        with self.engine.connect().execution_options(stream_results=True, yield_per=self.settings.chunk) as connection:
            for row in connection.execute(asked):
                yield Answered(*row)

    def questions(self, job: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Return the questions of a job in canonical order: key, structure, content."""
        asked = (
            sa.select(RowQuestion.key, RowQuestion.structure, RowQuestion.content)
            .where(RowQuestion.job == job)
            .order_by(RowQuestion.structure, RowQuestion.position, RowQuestion.key)
        )
        with self.engine.connect().execution_options(stream_results=True, yield_per=self.settings.chunk) as connection:
            for row in connection.execute(asked):
                yield row[0], row[1], row[2]

    def layouts(self, job: str) -> dict[str, dict[str, Any]]:
        """Return the layouts of a job by key."""
        with self.engine.begin() as connection:
            found = connection.execute(sa.select(Layout.key, Layout.content).where(Layout.job == job))
            return {key: content for key, content in found}

    def events(self, job: str, most: int = 1000) -> list[tuple[float, str, str]]:
        """Return the latest events of a job, oldest first: time, kind, text."""
        with self.engine.begin() as connection:
            found = connection.execute(
                sa.select(Event.time, Event.kind, Event.text)
                .where(Event.job == job)
                .order_by(Event.id.desc())
                .limit(most)
            )
            return [(moment, kind, text) for moment, kind, text in found][::-1]

    def tell(self, job: str, kind: str, text: str = "") -> None:
        """Add an event."""
        with self.engine.begin() as connection:
            _tell(connection, job, kind, text)


def _held(claim: Claim, owner: str) -> tuple[Any, ...]:
    return (
        WorkUnit.id == claim.unit,
        WorkUnit.state == RUNNING,
        WorkUnit.owner == owner,
        WorkUnit.token == claim.token,
    )


def _tell(connection: sa.Connection, job: str, kind: str, text: str) -> None:
    connection.execute(sa.insert(Event).values(job=job, time=moment(), kind=kind, text=text))


def _chunks(items: Iterable[Any], size: int) -> Iterator[list[Any]]:
    remaining = iter(items)
    while some := list(itertools.islice(remaining, size)):
        yield some
