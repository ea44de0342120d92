"""What a service looks at of jobs, a piece at a time: how they stand, packed records, and rows of batches."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa

from synth.batches.store import Answered, answered_rows
from synth.queue.job_queue import JobQueue
from synth.queue.models import Job, JobRecord, Layout, Result, Row, RowQuestion, Tenant, Upload, moment

BAD_INPUT, NOT_SOLVED = "bad_input", "not_solved"  # rows without an answer: they ask nothing, or wait


@dataclass(frozen=True)
class Standing:
    """How a job stands."""

    state: str
    outcome: str | None
    updated: float
    progress: dict[str, Any] | None


@dataclass(frozen=True)
class PackedRecord:
    """A file of a job as it is kept: packed with gzip; ``digest`` and ``size`` are those of what is in it."""

    media: str
    digest: str
    size: int
    packed: bytes


def standings(queue: JobQueue, jobs: Collection[str]) -> dict[str, Standing]:
    """States of some jobs; those that are gone are missing."""
    query = sa.select(Job.id, Job.state, Job.outcome, Job.updated, Job.progress)
    with queue.engine.connect() as connection:
        rows = connection.execute(query.where(Job.id.in_(list(jobs))))
        return {job: Standing(*standing) for job, *standing in rows}


@dataclass(frozen=True)
class JobTrace:
    """That there is a job, and whose: nothing of what it asks or has found."""

    id: str
    tenant: str
    kind: str
    state: str
    rows: int
    created: float
    started: float | None
    ended: float | None


def traces(
    queue: JobQueue,
    *,
    tenant: str | None = None,
    states: Collection[str] = (),
    before: tuple[float, str] | None = None,
    most: int = 50,
) -> list[JobTrace]:
    """Jobs of all tenants, the latest first.

    Parameters
    ----------
    queue : JobQueue
    tenant : str, optional
        Only those of the tenant with this name.
    states : collection of str
        Only those in these states.
    before : tuple of float and str, optional
        ``created`` and ``id`` of the last job of the page before.
    most : int
    """
    query = sa.select(Job.id, Tenant.name, Job.kind, Job.state, Job.rows, Job.created, Job.started, Job.ended)
    query = query.join(Tenant, Tenant.id == Job.tenant).order_by(Job.created.desc(), Job.id.desc()).limit(most)
    if tenant is not None:
        query = query.where(Tenant.name == tenant)
    if states:
        query = query.where(Job.state.in_(states))
    if before is not None:
        created, name = before
        query = query.where(sa.or_(Job.created < created, sa.and_(Job.created == created, Job.id < name)))
    with queue.engine.connect() as connection:
        return [JobTrace(*row) for row in connection.execute(query)]


def packed_record(queue: JobQueue, job: str, name: str) -> PackedRecord | None:
    """Return a file of a job; None where it has none of that name."""
    query = sa.select(JobRecord.media, JobRecord.digest, JobRecord.size, JobRecord.content)
    with queue.engine.connect() as connection:
        row = connection.execute(query.where(JobRecord.job == job, JobRecord.name == name)).one_or_none()
    return None if row is None else PackedRecord(*row)


def uploads_kept(queue: JobQueue, tenant: int) -> int:
    """Number of files kept that a tenant has uploaded."""
    query = sa.select(sa.func.count()).select_from(Upload).where(Upload.tenant == tenant, Upload.expires > moment())
    with queue.engine.connect() as connection:
        return int(connection.scalar(query) or 0)


# ---- rows -----------------------------------------------------------------------------------------------------------


def rows_after(queue: JobQueue, job: str, line: int, most: int, statuses: Sequence[str] = ()) -> list[Answered]:
    """Return rows of a batch beside their answers, in the order of the table.

    Parameters
    ----------
    queue : JobQueue
    job : str
    line : int
        Of the last row of the page before.
    most : int
    statuses : sequence of str
        Only rows that stand so; all where there is none.
    """
    conditions: list[Any] = [Row.job == job, Row.line > line]
    if statuses:
        stands: list[sa.ColumnElement[bool]] = [Result.status.in_(statuses)]
        if BAD_INPUT in statuses:
            stands.append(Row.key.is_(None))
        if NOT_SOLVED in statuses:
            stands.append(sa.and_(Row.key.is_not(None), Result.status.is_(None)))
        conditions.append(sa.or_(*stands))
    with queue.engine.connect() as connection:
        rows = connection.execute(answered_rows().where(*conditions).order_by(Row.line).limit(most))
        return [Answered(*row) for row in rows]


def row_at(queue: JobQueue, job: str, line: int) -> tuple[Answered, dict[str, Any] | None] | None:
    """Return a row of a batch beside its answer, and what it asks; None where there is none."""
    with queue.engine.connect() as connection:
        row = connection.execute(answered_rows().where(Row.job == job, Row.line == line)).one_or_none()
        if row is None:
            return None
        query = sa.select(RowQuestion.content).where(RowQuestion.job == job, RowQuestion.key == row.key)
        return Answered(*row), connection.scalar(query)


def layouts_of(queue: JobQueue, job: str, keys: Collection[str]) -> dict[str, dict[str, Any]]:
    """Return some layouts of a job by key."""
    query = sa.select(Layout.key, Layout.content).where(Layout.job == job, Layout.key.in_(list(keys)))
    with queue.engine.connect() as connection:
        return {key: content for key, content in connection.execute(query)}
