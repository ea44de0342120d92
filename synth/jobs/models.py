"""The tables of the job database: job -> unit -> result, the rows they belong to, and what happened.

Times are seconds since 1970 on the clock of the database, so that machines whose clocks differ agree on a lease.
"""

from __future__ import annotations

from typing import Any

from sqlalchemy import JSON, BigInteger, Float, ForeignKey, Index, Integer, LargeBinary, String, Text
from sqlalchemy.ext.compiler import compiles
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column
from sqlalchemy.sql.functions import FunctionElement

VERSION_TABLE = "batch_version"
KEY = 64  # hexadecimal digits of a SHA-256


class Base(DeclarativeBase):
    """What all tables share."""


class Job(Base):
    """One batch: a table of rows and the settings they are solved with.

    ``id`` is made of what decides the results (rows, settings, code, families, tables), so the same command finds its
    job again; ``basis`` of the same without the rows. ``state`` is open, cancelled or done.
    """

    __tablename__ = "batch_job"

    id: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    basis: Mapped[str] = mapped_column(String(KEY))
    state: Mapped[str] = mapped_column(String(16))
    source: Mapped[str] = mapped_column(Text)
    folder: Mapped[str] = mapped_column(Text)
    created: Mapped[float] = mapped_column(Float)
    updated: Mapped[float] = mapped_column(Float)
    rows: Mapped[int] = mapped_column(Integer)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class WorkUnit(Base):
    """Some rows of one structure, solved together: a piece of work of about a second.

    ``state`` is open, running or done. A unit that runs belongs to ``owner`` until ``lease``; ``token`` counts how
    often it was claimed, so that an owner who lost it cannot write any more.
    """

    __tablename__ = "batch_unit"
    __table_args__ = (Index("batch_unit_open", "job", "state", "id"),)

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"))
    state: Mapped[str] = mapped_column(String(16))
    owner: Mapped[str | None] = mapped_column(String(120))
    lease: Mapped[float | None] = mapped_column(Float)
    token: Mapped[int] = mapped_column(Integer)
    attempts: Mapped[int] = mapped_column(Integer)


class RowQuestion(Base):
    """What some row asks, in full; rows that ask the same share it.

    ``key`` is made of its content. ``position`` orders the questions of one structure by their content,
    so that neighbours are alike, whatever the order of the rows.
    """

    __tablename__ = "batch_question"
    __table_args__ = (Index("batch_question_unit", "unit"),)

    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    structure: Mapped[str] = mapped_column(String(KEY))
    position: Mapped[bytes] = mapped_column(LargeBinary)
    unit: Mapped[int | None] = mapped_column(Integer)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Row(Base):
    """One line of the table: its cells as they stand there, and the question they ask, or why they ask none.

    ``position`` orders the rows by what is in them, whatever their order in the file.
    """

    __tablename__ = "batch_row"
    __table_args__ = (Index("batch_row_key", "job", "key"),)

    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True)
    line: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    position: Mapped[bytes] = mapped_column(LargeBinary)
    key: Mapped[str | None] = mapped_column(String(KEY))
    family: Mapped[str] = mapped_column(Text)
    cells: Mapped[list[str]] = mapped_column(JSON)
    remarks: Mapped[str] = mapped_column(Text)
    faults: Mapped[list[dict[str, Any]]] = mapped_column(JSON)


class Result(Base):
    """The answer to one question; rows that ask the same share it. Written once, never changed."""

    __tablename__ = "batch_result"

    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    status: Mapped[str] = mapped_column(String(16))
    seconds: Mapped[float] = mapped_column(Float)
    layout: Mapped[str | None] = mapped_column(String(KEY))
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Layout(Base):
    """The columns that the designs of many results share."""

    __tablename__ = "batch_layout"

    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(String(KEY), primary_key=True)
    content: Mapped[dict[str, Any]] = mapped_column(JSON)


class Event(Base):
    """Something that happened to a job; events are only ever added."""

    __tablename__ = "batch_event"
    __table_args__ = (Index("batch_event_job", "job", "id"),)

    id: Mapped[int] = mapped_column(Integer, primary_key=True, autoincrement=True)
    job: Mapped[str] = mapped_column(ForeignKey("batch_job.id", ondelete="CASCADE"))
    time: Mapped[float] = mapped_column(Float)
    kind: Mapped[str] = mapped_column(String(32))
    text: Mapped[str] = mapped_column(Text)


class moment(FunctionElement[float]):  # written as SQL writes functions
    """Now, on the clock of the database."""

    type = Float()
    inherit_cache = True
    name = "moment"


@compiles(moment, "sqlite")
def _moment_of_sqlite(element: Any, compiler: Any, **context: Any) -> str:
    return "((julianday('now') - 2440587.5) * 86400.0)"


@compiles(moment, "postgresql")
def _moment_of_postgresql(element: Any, compiler: Any, **context: Any) -> str:
    return "CAST(extract(epoch FROM clock_timestamp()) AS double precision)"
