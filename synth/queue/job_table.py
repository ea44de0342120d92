"""The jobs of a database: what is asked, how it stands, how it ended, and its records and events.

States change by compare-and-set: a job that was cancelled cannot end in another way any more.
"""

from __future__ import annotations

import gzip
import secrets
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session, aliased

from synth.queue.database import Database, encoded
from synth.queue.models import Event, Job, JobRecord, Tenant, Upload, WorkerSign, WorkUnit, moment
from synth.queue.records import Record

OPEN, RUNNING, DONE, CANCELLED, FAILED, STOPPED = "open", "running", "done", "cancelled", "failed", "stopped"
LIVE = (OPEN, RUNNING)  # states of a job that somebody has to work at
JOB_TASK, PLAN, ROWS = "job", "plan", "rows"  # tasks of units
BATCH, SIZE_RANGE = "batch", "size_range"  # kinds that the store itself knows of: their answers stand in tables
LOCAL = 1  # the tenant of the command line, and of a service without tokens
LETTERS = "0123456789abcdefghjkmnpqrstvwxyz"  # of ids: none that is read as another
RUNNING_LIMIT, OPEN_LIMIT = "running", "open_jobs"  # of a tenant
KEEP = "keep"  # what is kept with a job of how long it stays without being used, in s
BODY = "body"  # what is kept with a job of the request that has made it


@dataclass(frozen=True, kw_only=True)
class NewJob:
    """A job to be made, of one unit.

    Parameters
    ----------
    kind, title : str
    request : mapping
        The request as it is kept.
    fingerprint, code : str
        Of what decides the results, and of the programs that may work at it.
    tenant : int
    task : str
        Of its first unit.
    priority : int
        0 for bulk work, 1 where somebody waits.
    content : mapping
        What the kind keeps with it.
    idempotency, body : str, optional
        A key that the client has chosen for this request, and the digest of the request: said again, it makes no
        second job.
    parent : str, optional
        The job that it follows from.
    seconds_limit, keep : float, optional
        In s: how long it may be worked at, and how long it is kept after it was used last.
    source : str
        Where it comes from, for people.
    kept : sequence of Record
        What was brought for it, and stays with it.
    """

    kind: str
    title: str
    request: Mapping[str, Any]
    fingerprint: str
    code: str | None
    tenant: int = LOCAL
    task: str = JOB_TASK
    priority: int = 1
    content: Mapping[str, Any] = field(default_factory=dict)
    idempotency: str | None = None
    body: str = ""
    parent: str | None = None
    seconds_limit: float | None = None
    keep: float | None = None
    source: str = ""
    kept: Sequence[Record] = ()


@dataclass(frozen=True, kw_only=True)
class Ending:
    """How a job ended: its state, its records, and its summary for lists."""

    state: str
    outcome: str | None = None
    summary: Mapping[str, Any] | None = None
    error: Mapping[str, Any] | None = None
    records: Sequence[Record] = ()


@dataclass(frozen=True)
class Happening:
    """An event as subscribers receive it."""

    id: int
    job: str
    time: float
    kind: str
    text: str
    data: Mapping[str, Any] | None


class KeyInUseError(Exception):
    """The idempotency key was used for another request."""


class QueueFullError(Exception):
    """A tenant has as many open jobs as it may have; ``most`` says how many."""

    def __init__(self, most: int) -> None:
        super().__init__(f"{most} jobs are open already")
        self.most = most


def new_id() -> str:
    """Return an id that no other job has, and that sorts by time: 10 letters of milliseconds, 16 at random."""
    number = (time.time_ns() // 1_000_000) << 80 | secrets.randbits(80)
    return "".join(LETTERS[number >> shift & 31] for shift in range(125, -1, -5))


class JobTable(Database):
    """The jobs of a database, apart from the work at them."""

    # -- jobs ----------------------------------------------------------------------------------

    def job(self, job: str, tenant: int | None = None) -> Job | None:
        """Return a job; None where there is none, or where it belongs to another tenant than the one named."""
        with Session(self.engine, expire_on_commit=False) as session:
            return session.scalar(sa.select(Job).where(Job.id == job, *_of(tenant)))

    def job_like(self, kind: str, fingerprint: str, tenant: int = LOCAL) -> Job | None:
        """Return the job of a kind that asks just this; None where there is none."""
        with Session(self.engine, expire_on_commit=False) as session:
            where = (Job.tenant == tenant, Job.kind == kind, Job.fingerprint == fingerprint)
            return session.scalar(sa.select(Job).where(*where))

    def jobs(self) -> list[Job]:
        """Return all jobs, the latest first."""
        with Session(self.engine, expire_on_commit=False) as session:
            return list(session.scalars(sa.select(Job).order_by(Job.created.desc(), Job.id)))

    def page(
        self,
        tenant: int | None,
        *,
        states: Sequence[str] = (),
        kind: str | None = None,
        family: str | None = None,
        text: str = "",
        parent: str | None = None,
        follows: bool | None = None,
        pinned: bool | None = None,
        before: tuple[float, str] | None = None,
        most: int = 50,
    ) -> list[Job]:
        """Return some jobs of a tenant, the latest first.

        Parameters
        ----------
        tenant : int or None
            Of all tenants for None.
        states, kind, family, text, parent, follows, pinned
            Only those in these states, of this kind, that ask this family, with this text in their title or id, that
            follow from this job, that follow from any job that there is or from none, that are kept for good or not.
        before : tuple of float and str, optional
            ``created`` and ``id`` of the last job of the page before.
        most : int
        """
        where: list[Any] = [*_of(tenant)]
        if states:
            where.append(Job.state.in_(states))
        if kind is not None:
            where.append(Job.kind == kind)
        if family is not None:
            named = sa.cast(Job.content["families"], sa.Text)
            where.append(named.contains(encoded(family), autoescape=True))
        if parent is not None:
            where.append(Job.parent == parent)
        if follows is not None:
            other = aliased(Job)
            there = sa.exists().where(other.id == Job.parent)  # what followed from a removed job stands by itself
            where.append(there if follows else ~there)
        if pinned is not None:
            where.append(Job.pinned.is_(pinned))
        if text:
            where.append(sa.or_(Job.title.icontains(text, autoescape=True), Job.id.startswith(text, autoescape=True)))
        if before is not None:
            created, name = before
            where.append(sa.or_(Job.created < created, sa.and_(Job.created == created, Job.id < name)))
        with Session(self.engine, expire_on_commit=False) as session:
            query = sa.select(Job).where(*where).order_by(Job.created.desc(), Job.id.desc()).limit(most)
            return list(session.scalars(query))

    def submit(self, new: NewJob) -> tuple[str, bool]:
        """Write a job; return its id, and whether it is a new one.

        A key that was used for the same request, and the same question of a batch, give the job that there is.

        Raises
        ------
        KeyInUseError
            The key was used for another request.
        QueueFullError
            The tenant has as many open jobs as it may have.
        """
        known = self._known(new)
        if known is not None:
            return known, False
        name = new_id()
        columns = {
            "id": name,
            "tenant": new.tenant,
            "kind": new.kind,
            "title": new.title,
            "state": OPEN,
            "priority": new.priority,
            "fingerprint": new.fingerprint,
            "code": new.code,
            "idempotency": new.idempotency,
            "parent": new.parent,
            "request": dict(new.request),
            "content": {**new.content, BODY: new.body, **({} if new.keep is None else {KEEP: new.keep})},
            "seconds_limit": new.seconds_limit,
            "source": new.source,
            "expires": None if new.keep is None else moment() + new.keep,
        }
        try:
            with self.engine.begin() as connection:
                self._refuse_beyond(connection, new.tenant)
                connection.execute(sa.insert(Job).values(**columns))
                connection.execute(sa.insert(WorkUnit).values(job=name, task=new.task, state=OPEN))
                for record in new.kept:
                    self._keep_on(connection, name, record)
                insert_event(connection, name, "created", new.title)
        except (IntegrityError, QueueFullError):  # somebody may have said the same at the same time
            known = self._known(new)
            if known is None:
                raise
            return known, False
        return name, True

    def job_with_key(self, key: str, body: str, tenant: int) -> str | None:
        """Return the job that a request with this key has made before; None where there is none.

        Raises
        ------
        KeyInUseError
            The key was used for a request with another body.
        """
        with Session(self.engine) as session:
            same = session.scalar(sa.select(Job).where(Job.tenant == tenant, Job.idempotency == key))
            if same is not None and same.content.get(BODY) != body:
                raise KeyInUseError
            return None if same is None else same.id

    def _known(self, new: NewJob) -> str | None:
        """Return the job that a request has made before."""
        if new.idempotency is not None:
            same = self.job_with_key(new.idempotency, new.body, new.tenant)
            if same is not None:
                return same
        with Session(self.engine) as session:
            if new.kind in (BATCH, SIZE_RANGE):
                conditions = (Job.tenant == new.tenant, Job.kind == new.kind, Job.fingerprint == new.fingerprint)
                return session.scalar(sa.select(Job.id).where(*conditions))
        return None

    @staticmethod
    def _refuse_beyond(connection: sa.Connection, tenant: int) -> None:
        """Refuse one job more than a tenant may have open.

        It comes first in the transaction that opens the job: an update that changes nothing holds the tenant until
        the end of it, so that of several requests at once each counts what those before it have opened.
        """
        held = sa.update(Tenant).where(Tenant.id == tenant).values(created=Tenant.created).returning(Tenant.limits)
        most = (connection.scalar(held) or {}).get(OPEN_LIMIT)
        if most is not None:
            query = sa.select(sa.func.count()).select_from(Job).where(Job.tenant == tenant, Job.state.in_(LIVE))
            if int(connection.scalar(query) or 0) >= most:
                raise QueueFullError(int(most))

    def change(self, job: str, **columns: Any) -> None:
        """Change what people may change of a job: its title, its folder, whether it is kept for good."""
        with self.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == job).values(**columns, updated=moment()))

    def cancel(self, job: str) -> bool:
        """Cancel a job that has not ended; return False where it has. What it has found is kept."""
        return self._set_state(job, LIVE, CANCELLED, "cancelled")

    def reopen(self, job: str, kind: str, text: str = "") -> None:
        """Let a job that has ended, or was given up, go on; say so among its events."""
        with self.engine.begin() as connection:
            again = {"state": OPEN, "ended": None, "error": None, "updated": moment()}
            connection.execute(sa.update(Job).where(Job.id == job).values(**again))
            insert_event(connection, job, kind, text)

    def resume(self, job: str, tenant: int, code: str) -> bool:
        """Let a job that was cancelled or stopped, or has failed, go on; return False where it is in another state.

        What has been found stays: answered rows of a batch, and the records of a search until it ends again. A job
        that is one piece of work begins it anew.

        Parameters
        ----------
        job : str
        tenant : int
        code : str
            The fingerprint of the programs that go on with it.

        Raises
        ------
        QueueFullError
            The tenant has as many open jobs as it may have.
        """
        again = {"state": OPEN, "code": code, "ended": None, "outcome": None, "error": None, "updated": moment()}
        with self.engine.begin() as connection:
            self._refuse_beyond(connection, tenant)
            ended = (Job.id == job, Job.tenant == tenant, Job.state.in_((CANCELLED, FAILED, STOPPED)))
            if connection.execute(sa.update(Job).where(*ended).values(**again)).rowcount != 1:
                return False
            without_rows = sa.exists().where(Job.id == WorkUnit.job, Job.rows == 0)
            begun_anew = sa.or_(WorkUnit.task == JOB_TASK, sa.and_(WorkUnit.task == PLAN, without_rows))
            fresh = {"state": OPEN, "owner": None, "lease": None, "attempts": 0}
            connection.execute(sa.update(WorkUnit).where(WorkUnit.job == job, begun_anew).values(**fresh))
            insert_event(connection, job, "resumed", "", {"state": OPEN})
        return True

    def requeue(self, job: str) -> None:
        """Note that a job waits again, where nobody works at it any more."""
        at_work = sa.exists().where(WorkUnit.job == job, WorkUnit.state == RUNNING)
        with self.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == job, Job.state == RUNNING, ~at_work).values(state=OPEN))

    def end(self, job: str, ending: Ending) -> bool:
        """End a job that has not ended; return False where it has."""
        with self.engine.begin() as connection:
            return self._end_on(connection, job, ending)

    def _set_state(self, job: str, before: Sequence[str], state: str, kind: str, text: str = "") -> bool:
        with self.engine.begin() as connection:
            changed = connection.execute(
                sa.update(Job)
                .where(Job.id == job, Job.state.in_(before))
                .values(state=state, updated=moment(), ended=moment(), expires=_unused())
            )
            if changed.rowcount == 1:
                insert_event(connection, job, kind, text, {"state": state})
        return bool(changed.rowcount == 1)

    def _end_on(self, connection: sa.Connection, job: str, ending: Ending) -> bool:
        changed = connection.execute(
            sa.update(Job)
            .where(Job.id == job, Job.state.in_(LIVE))
            .values(
                state=ending.state,
                outcome=ending.outcome,
                summary=None if ending.summary is None else dict(ending.summary),
                error=None if ending.error is None else dict(ending.error),
                updated=moment(),
                ended=moment(),
                expires=_unused(),
            )
        )
        if changed.rowcount != 1:
            return False
        for record in ending.records:
            self._keep_on(connection, job, record)
        text = "" if ending.error is None else str(ending.error.get("message", ""))
        insert_event(connection, job, ending.state, text, {"state": ending.state, "outcome": ending.outcome})
        return True

    def delete(self, job: str) -> bool:
        """Remove a job with everything that belongs to it; whoever works at it stops.

        Returns
        -------
        bool
            False where it is pinned, or there is none: then nothing is removed.
        """
        with self.engine.begin() as connection:
            gone = connection.execute(sa.delete(Job).where(Job.id == job, Job.pinned.is_(False)))
        return bool(gone.rowcount == 1)

    def note_use(self, jobs: Collection[str], keep: float | None = None) -> None:
        """Let the time begin anew for which some jobs are kept; ``keep`` is that of jobs of earlier versions."""
        with self.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id.in_(jobs)).values(expires=_unused(keep)))

    def waits_for(self, job: str) -> str | None:
        """Return an open job that needs the records of a job; None where there is none."""
        with self.engine.connect() as connection:
            return connection.scalar(sa.select(Job.id).where(_REFERRED == job, Job.state.in_(LIVE)).limit(1))

    # -- records -------------------------------------------------------------------------------

    def keep(self, job: str, record: Record) -> None:
        """Keep a file with a job, in place of one of the same name."""
        with self.engine.begin() as connection:
            self._keep_on(connection, job, record)

    @staticmethod
    def _keep_on(connection: sa.Connection, job: str, record: Record) -> None:
        connection.execute(sa.delete(JobRecord).where(JobRecord.job == job, JobRecord.name == record.name))
        packed = gzip.compress(record.content, 6, mtime=0)
        connection.execute(
            sa.insert(JobRecord).values(
                job=job,
                name=record.name,
                media=record.media,
                digest=record.digest,
                size=len(record.content),
                content=packed,
            )
        )

    def records(self, job: str, names: Sequence[str] = ()) -> dict[str, Record]:
        """Return the files of a job by name: all, or those named that there are."""
        query = sa.select(JobRecord.name, JobRecord.media, JobRecord.content).where(JobRecord.job == job)
        if names:
            query = query.where(JobRecord.name.in_(names))
        with self.engine.connect() as connection:
            return {
                name: Record(name=name, media=media, content=gzip.decompress(content))
                for name, media, content in connection.execute(query.order_by(JobRecord.name))
            }

    # -- events --------------------------------------------------------------------------------

    def add_event(self, job: str, kind: str, text: str = "", data: Mapping[str, object] | None = None) -> None:
        """Add an event."""
        with self.engine.begin() as connection:
            insert_event(connection, job, kind, text, data)

    def events(self, job: str, most: int = 1000) -> list[tuple[float, str, str]]:
        """Return the latest events of a job, oldest first: time, kind, text."""
        with self.engine.begin() as connection:
            rows = connection.execute(
                sa.select(Event.time, Event.kind, Event.text)
                .where(Event.job == job)
                .order_by(Event.id.desc())
                .limit(most)
            )
            return [(time, kind, text) for time, kind, text in rows][::-1]

    def happenings(self, after: int, *, job: str | None = None, most: int = 1000) -> list[Happening]:
        """Return events of all jobs, or of one, with higher numbers than this one."""
        query = sa.select(Event.id, Event.job, Event.time, Event.kind, Event.text, Event.data).where(Event.id > after)
        if job is not None:
            query = query.where(Event.job == job)
        with self.engine.connect() as connection:
            return [Happening(*row) for row in connection.execute(query.order_by(Event.id).limit(most))]

    def last_event(self) -> int:
        """Return the number of the latest event; 0 before there are any."""
        with self.engine.connect() as connection:
            return int(connection.scalar(sa.select(sa.func.max(Event.id))) or 0)

    # -- housekeeping --------------------------------------------------------------------------

    def prune(self, most: int = 100) -> int:
        """Remove some of the jobs whose time is over, and files that nobody has used; return how many jobs.

        What another job refers to, or follows from, stays with it: of a chain the last goes first.
        """
        named = sa.select(_REFERRED).where(_REFERRED.is_not(None))
        followed = sa.select(Job.parent).where(Job.parent.is_not(None))
        over = (
            sa.select(Job.id)
            .where(Job.expires < moment(), Job.pinned.is_(False), Job.state.not_in(LIVE))
            .where(Job.id.not_in(named.union_all(followed)))
            .limit(most)
        )
        with self.engine.begin() as connection:
            gone = list(connection.scalars(over))
            connection.execute(sa.delete(Job).where(Job.id.in_(gone)))
            connection.execute(sa.delete(Upload).where(Upload.expires < moment()))
            connection.execute(sa.delete(WorkerSign).where(WorkerSign.seen < moment() - self.settings.forgotten))
        self.shrink(self.settings.pages_released)
        return len(gone)

    def census(self) -> dict[str, Any]:
        """Count jobs by kind and state, units by state, and tell in s how long the oldest open job waits."""
        with self.engine.connect() as connection:
            jobs = connection.execute(sa.select(Job.kind, Job.state, sa.func.count()).group_by(Job.kind, Job.state))
            units = connection.execute(sa.select(WorkUnit.state, sa.func.count()).group_by(WorkUnit.state))
            oldest = connection.scalar(sa.select(moment() - sa.func.min(Job.created)).where(Job.state == OPEN))
            return {
                "jobs": {(kind, state): int(count) for kind, state, count in jobs},
                "units": {state: int(count) for state, count in units},
                "oldest": float(oldest or 0.0),
            }


_REFERRED = Job.request["of"].as_string()  # the job whose records another one needs


def _unused(keep: float | None = None) -> sa.ColumnElement[Any]:
    """Return until when a job is kept that is used now; one that is kept without an end stays so."""
    stays = moment() + sa.func.coalesce(Job.content[KEEP].as_float(), keep)
    return sa.case((Job.expires.is_(None), None), else_=sa.func.coalesce(stays, Job.expires))


def insert_event(
    connection: sa.Connection, job: str, kind: str, text: str, data: Mapping[str, object] | None = None
) -> None:
    """Add an event in the transaction of its cause."""
    content = None if data is None else dict(data)
    connection.execute(sa.insert(Event).values(job=job, kind=kind, text=text, data=content))


def _of(tenant: int | None) -> tuple[Any, ...]:
    return () if tenant is None else (Job.tenant == tenant,)
