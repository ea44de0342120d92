"""The tables of the job database: jobs, their units of work, what came out, and who may see it.

A job is of some kind (a synthesis, a batch, a what-if study, ...). Its units are what workers claim; a batch has rows,
questions and results besides, all others have records: the files that everything else is rendered from.

Times are seconds since 1970 on the clock of the database, so that machines whose clocks differ agree on a lease.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    SmallInteger,
    String,
    Text,
    UniqueConstraint,
    text,
)
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.sql.functions import FunctionElement

VERSION_TABLE = "batch_version"  # as the first version called it: only so is its database recognised
KEY = 64  # hexadecimal digits of a SHA-256
ID = 26  # characters of the id of a job
OF_TABLES = text("kind IN ('batch', 'size_range')")  # kinds of which the same question is the same job


class moment(FunctionElement[float]):  # written as SQL writes functions
    """Now, on the clock of the database."""

    type = Float()
    inherit_cache = True
    name = "moment"


@compiles(moment, "sqlite")
def _moment_of_sqlite(element: object, compiler: object, **context: Any) -> str:
    return "((julianday('now') - 2440587.5) * 86400.0)"


@compiles(moment, "postgresql")
def _moment_of_postgresql(element: object, compiler: object, **context: Any) -> str:
    return "CAST(extract(epoch FROM clock_timestamp()) AS double precision)"


class Base(DeclarativeBase):
    """What all tables share."""


# ---- who -----------------------------------------------------------------------------------------------------------


class Tenant(Base):
    """Whoever sees the same jobs. The first one, ``local``, is the command line, and a service without tokens."""

    __tablename__ = "tenant"

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    name: Mapped[str] = mapped_column(String(60), unique=True)
    limits: Mapped[dict[str, Any]] = mapped_column(JSON)
    created: Mapped[float] = mapped_column(Float, default=moment())


class Token(Base):
    """What a program proves with who it is. Only the hash of it is kept, and its first letters to tell it apart."""

    __tablename__ = "token"
    __table_args__ = (Index("token_prefix", "prefix"),)

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    tenant: Mapped[int] = mapped_column(ForeignKey("tenant.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(60))
    prefix: Mapped[str] = mapped_column(String(8))
    hash: Mapped[str] = mapped_column(String(KEY), unique=True)
    scopes: Mapped[str] = mapped_column(Text)
    created: Mapped[float] = mapped_column(Float, default=moment())
    expires: Mapped[float | None] = mapped_column(Float)
    used: Mapped[float | None] = mapped_column(Float)
    revoked: Mapped[float | None] = mapped_column(Float)


class BrowserSession(Base):
    """A browser that has shown a token; the value is in its cookie alone."""

    __tablename__ = "session"

    hash: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    token: Mapped[int] = mapped_column(ForeignKey("token.id", ondelete="CASCADE"))
    created: Mapped[float] = mapped_column(Float, default=moment())
    expires: Mapped[float] = mapped_column(Float)


# ---- what ----------------------------------------------------------------------------------------------------------


class Job(Base):
    """One thing that is asked: a synthesis, a study, a batch of rows.

    ``id`` is random and sorts by time. ``fingerprint`` is made of what decides the results: of a batch (rows, settings,
    code, families, tables) there is one job for each, so that the same command finds it again; ``basis`` of the same
    without the rows. ``code`` is the fingerprint of the programs that may work at it; None where only whoever made the
    job can. ``state`` is open, running, done, failed, cancelled or stopped (by a limit of time or memory; what was
    found is kept); ``outcome`` the status of the front that came out.
    """

    __tablename__ = "job"
    __table_args__ = (
        UniqueConstraint("tenant", "idempotency", name="job_idempotency"),
        Index(
            "job_fingerprint",
            "tenant",
            "kind",
            "fingerprint",
            unique=True,
            sqlite_where=OF_TABLES,
            postgresql_where=OF_TABLES,
        ),
        Index("job_list", "tenant", "created"),
        Index("job_state", "state", "priority"),
    )

    id: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    tenant: Mapped[int] = mapped_column(ForeignKey("tenant.id", ondelete="CASCADE"))
    kind: Mapped[str] = mapped_column(String(16))
    title: Mapped[str] = mapped_column(Text)
    state: Mapped[str] = mapped_column(String(16))
    priority: Mapped[int] = mapped_column(SmallInteger)
    fingerprint: Mapped[str] = mapped_column(String(KEY))
    basis: Mapped[str] = mapped_column(String(KEY), default="")
    code: Mapped[str | None] = mapped_column(String(KEY))
    idempotency: Mapped[str | None] = mapped_column(String(200))
    parent: Mapped[str | None] = mapped_column(String(KEY))
    request: Mapped[dict[str, Any]] = mapped_column(JSON)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)
    progress: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    summary: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    rows: Mapped[int] = mapped_column(Integer, default=0)
    seconds_limit: Mapped[float | None] = mapped_column(Float)
    outcome: Mapped[str | None] = mapped_column(String(16))
    error: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    pinned: Mapped[bool] = mapped_column(Boolean, default=False)
    expires: Mapped[float | None] = mapped_column(Float)
    source: Mapped[str] = mapped_column(Text)
    folder: Mapped[str] = mapped_column(Text, default="")
    created: Mapped[float] = mapped_column(Float, default=moment())
    started: Mapped[float | None] = mapped_column(Float)
    served: Mapped[float | None] = mapped_column(Float)
    updated: Mapped[float] = mapped_column(Float, default=moment())
    ended: Mapped[float | None] = mapped_column(Float)


class WorkUnit(Base):
    """A piece of work: a whole job, the planning of a batch, or some rows of one structure that are solved together.

    ``task`` says which (``job``, ``plan``, ``rows``). ``state`` is open, running or done. A unit that runs belongs to
    ``owner`` until ``lease``; ``token`` counts how often it was claimed, so that an owner who lost it cannot write any
    more.
    """

    __tablename__ = "unit"
    __table_args__ = (
        Index("unit_open", "job", "state", "id"),
        Index("unit_owner", "state", "owner"),
        {"sqlite_autoincrement": True},  # the number of a unit that is gone must not mean another one
    )

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"))
    task: Mapped[str] = mapped_column(String(16))
    state: Mapped[str] = mapped_column(String(16))
    owner: Mapped[str | None] = mapped_column(String(120))
    lease: Mapped[float | None] = mapped_column(Float)
    token: Mapped[int] = mapped_column(Integer, default=0)
    attempts: Mapped[int] = mapped_column(Integer, default=0)


class JobRecord(Base):
    """A file of a job that is its result, packed with gzip: whatever else is shown is rendered from these."""

    __tablename__ = "record"

    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(60), primary_key=True)
    media: Mapped[str] = mapped_column(String(60))
    digest: Mapped[str] = mapped_column(String(KEY))
    size: Mapped[int] = mapped_column(Integer)
    content: Mapped[bytes] = mapped_column(LargeBinary)


class RowQuestion(Base):
    """What some row asks, in full; rows that ask the same share it.

    ``key`` is made of its content. ``position`` orders the questions of one structure by their content,
    so that neighbours are alike, whatever the order of the rows.
    """

    __tablename__ = "question"
    __table_args__ = (Index("question_unit", "unit"),)

    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    structure: Mapped[str] = mapped_column(String(KEY))
    position: Mapped[bytes] = mapped_column(LargeBinary)
    unit: Mapped[int | None] = mapped_column(Integer)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Row(Base):
    """One line of the table: its cells as they stand there, and the question they ask, or why they ask none.

    ``position`` orders the rows by what is in them, whatever their order in the file.
    """

    __tablename__ = "job_row"
    __table_args__ = (Index("job_row_key", "job", "key"),)

    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), primary_key=True)
    line: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    position: Mapped[bytes] = mapped_column(LargeBinary)
    key: Mapped[str | None] = mapped_column(String(KEY))
    family: Mapped[str] = mapped_column(Text)
    cells: Mapped[list[str]] = mapped_column(JSON)
    remarks: Mapped[str] = mapped_column(Text)
    faults: Mapped[list[dict[str, Any]]] = mapped_column(JSON)


class Result(Base):
    """The answer to one question; rows that ask the same share it. Written once, never changed."""

    __tablename__ = "result"

    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    status: Mapped[str] = mapped_column(String(16))
    seconds: Mapped[float] = mapped_column(Float)
    layout: Mapped[str | None] = mapped_column(String(KEY))
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Layout(Base):
    """The columns that the designs of many results share."""

    __tablename__ = "layout"

    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Event(Base):
    """Something that happened to a job; events are only ever added, and go with their job."""

    __tablename__ = "event"
    __table_args__ = (Index("event_job", "job", "id"), {"sqlite_autoincrement": True})

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("job.id", ondelete="CASCADE"))
    time: Mapped[float] = mapped_column(Float, default=moment())
    kind: Mapped[str] = mapped_column(String(32))
    text: Mapped[str] = mapped_column(Text)
    data: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))


# ---- with what -----------------------------------------------------------------------------------------------------


class Catalogue(Base):
    """A version of a part table that a tenant has brought. Versions are added, never changed."""

    __tablename__ = "catalogue"
    __table_args__ = (UniqueConstraint("tenant", "name", "version", name="catalogue_version"),)

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    tenant: Mapped[int] = mapped_column(ForeignKey("tenant.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(60))
    version: Mapped[int] = mapped_column(Integer)
    table: Mapped[str] = mapped_column(String(60))
    digest: Mapped[str] = mapped_column(String(KEY))
    rows: Mapped[int] = mapped_column(Integer)
    content: Mapped[bytes] = mapped_column(LargeBinary)
    schema: Mapped[bytes] = mapped_column(LargeBinary)
    created: Mapped[float] = mapped_column(Float, default=moment())
    note: Mapped[str] = mapped_column(Text)


class Upload(Base):
    """A file that a tenant has brought for a batch; it goes after a day."""

    __tablename__ = "upload"
    __table_args__ = (Index("upload_expires", "expires"),)

    id: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    tenant: Mapped[int] = mapped_column(ForeignKey("tenant.id", ondelete="CASCADE"))
    name: Mapped[str] = mapped_column(String(200))
    size: Mapped[int] = mapped_column(Integer)
    digest: Mapped[str] = mapped_column(String(KEY))
    content: Mapped[bytes] = mapped_column(LargeBinary)
    created: Mapped[float] = mapped_column(Float, default=moment())
    expires: Mapped[float] = mapped_column(Float)


class WorkerSign(Base):
    """A sign of life of a worker: which code it has, and what its slots do."""

    __tablename__ = "worker"

    owner: Mapped[str] = mapped_column(String(120), primary_key=True)
    host: Mapped[str] = mapped_column(Text)
    code: Mapped[str] = mapped_column(String(KEY))
    started: Mapped[float] = mapped_column(Float)
    seen: Mapped[float] = mapped_column(Float)
    slots: Mapped[dict[str, Any]] = mapped_column(JSON)
