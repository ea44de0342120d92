"""The queue of a job database: whose turn it is, who works at what, and what came out of it. It alone is the truth.

A unit is claimed for a time, and the claim is renewed while its owner lives. What comes out is written only by the
owner that still holds the claim (its token counts claims), in one transaction with the end of the unit.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import sqlalchemy as sa
from sqlalchemy.orm import Session

from synth.queue.job_table import BATCH, DONE, LIVE, OPEN, ROWS, RUNNING, RUNNING_LIMIT, Ending, JobTable, insert_event
from synth.queue.models import Job, RowQuestion, Tenant, WorkerSign, WorkUnit, moment
from synth.queue.owners import has_died


@dataclass(frozen=True)
class Claim:
    """A unit that this owner may work on, as long as the lease is renewed."""

    unit: int
    token: int
    attempts: int
    questions: dict[str, Any]  # by key
    task: str = ROWS


class JobQueue(JobTable):
    """The jobs of a database, and the work that they are."""

    # -- work ----------------------------------------------------------------------------------

    def claim(self, job: str, owner: str, most: int, lease: float | None = None) -> list[Claim]:
        """Take units that are open, or whose owner has not renewed its lease; for so many seconds, or as set."""
        # PostgreSQL passes over what others are just taking; SQLite has one writer at a time and ignores the clause.
        claimable = (
            sa.select(WorkUnit.id)
            .where(WorkUnit.job == job, _free())
            .order_by(WorkUnit.id)
            .limit(most)
            .with_for_update(skip_locked=True)
            .cte("claimable")
        )
        take = (
            sa.update(WorkUnit)
            .where(WorkUnit.id.in_(sa.select(claimable.c.id)))
            .values(state=RUNNING, owner=owner, lease=self._until(lease), token=WorkUnit.token + 1)
            .returning(WorkUnit.id, WorkUnit.token, WorkUnit.attempts, WorkUnit.task)
            .execution_options(synchronize_session=False)
        )
        with self.engine.begin() as connection:
            # First what changes the job: of a statement WITH an update in it, SQLite begins no transaction.
            if not self._begin_on(connection, job, owner):
                return []
            claimed = sorted((unit, token, attempts, task) for unit, token, attempts, task in connection.execute(take))
            if not claimed:
                connection.rollback()
                return []
            questions = connection.execute(
                sa.select(RowQuestion.unit, RowQuestion.key, RowQuestion.content)
                .where(RowQuestion.unit.in_([unit[0] for unit in claimed]))
                .order_by(RowQuestion.position, RowQuestion.key)
            ).all()
        return [
            Claim(unit, token, attempts, {key: content for of, key, content in questions if of == unit}, task)
            for unit, token, attempts, task in claimed
        ]

    @staticmethod
    def _begin_on(connection: sa.Connection, job: str, owner: str) -> bool:
        """Note that a job is worked at; return False where it has ended."""
        of_job = sa.update(Job).where(Job.id == job)
        first = of_job.where(Job.state == OPEN).values(
            state=RUNNING, started=sa.func.coalesce(Job.started, moment()), served=moment(), updated=moment()
        )
        if connection.execute(first).rowcount == 1:
            insert_event(connection, job, "started", owner, {"state": RUNNING})
            return True
        return connection.execute(of_job.where(Job.state == RUNNING).values(served=moment())).rowcount == 1

    def claim_next(
        self, owner: str, code: str, *, bulk: bool = True, lease: float | None = None
    ) -> tuple[Job, Claim] | None:
        """Take the unit whose turn it is, of any job that programs with this code may work at.

        Where somebody waits goes before bulk work, then the tenant that has least under way, then the job that was
        served longest ago. Bulk work that nobody has served for a while counts as waited for: it never starves.

        Parameters
        ----------
        owner, code : str
        bulk : bool
            Whether bulk work may be taken; without, only what somebody waits for.
        lease : float, optional
            In s.
        """
        for job in self._in_turn(code, bulk):
            claims = self.claim(job, owner, 1, lease)
            if claims:
                record = self.job(job)
                if record is not None:
                    return record, claims[0]
        return None

    def _in_turn(self, code: str, bulk: bool) -> list[str]:
        """Return the jobs that have units to be taken, the next first."""
        has_free = sa.exists().where(WorkUnit.job == Job.id, _free())
        query = sa.select(Job.id, Job.tenant, Job.priority, Job.served, Job.created, moment()).where(
            Job.state.in_(LIVE), Job.code == code, has_free
        )
        with self.engine.connect() as connection:
            rows = connection.execute(query).all()
            if not rows:
                return []
            under_way = {
                tenant: int(count)
                for tenant, count in connection.execute(
                    sa.select(Job.tenant, sa.func.count())
                    .join(WorkUnit, WorkUnit.job == Job.id)
                    .where(WorkUnit.state == RUNNING, WorkUnit.lease >= moment())
                    .group_by(Job.tenant)
                )
            }
            limits = {name: limit for name, limit in connection.execute(sa.select(Tenant.id, Tenant.limits))}
        queue = []
        for job, tenant, priority, served, created, now in rows:
            most = limits.get(tenant, {}).get(RUNNING_LIMIT)
            if most is not None and under_way.get(tenant, 0) >= most:
                continue
            waited = priority > 0 or now - (served or created) > self.settings.starving
            if waited or bulk:
                queue.append((not waited, under_way.get(tenant, 0), served or 0.0, created, job))
        return [job for *_, job in sorted(queue)]

    def interactive_waits(self, code: str) -> bool:
        """True if a unit is open that somebody waits for."""
        has_open = sa.exists().where(WorkUnit.job == Job.id, WorkUnit.state == OPEN)
        query = sa.select(sa.exists().where(Job.state.in_(LIVE), Job.code == code, Job.priority > 0, has_open))
        with self.engine.connect() as connection:
            return bool(connection.scalar(query))

    def _until(self, lease: float | None) -> sa.ColumnElement[float]:
        return moment() + (self.settings.lease if lease is None else lease)

    def renew(self, owner: str, lease: float | None = None, units: Collection[int] | None = None) -> None:
        """Give a sign of life: everything that an owner works on stays its own, or only the units that are named."""
        held = [WorkUnit.owner == owner, WorkUnit.state == RUNNING]
        if units is not None:
            held.append(WorkUnit.id.in_(units))
        with self.engine.begin() as connection:
            connection.execute(sa.update(WorkUnit).where(*held).values(lease=self._until(lease)))

    def release(self, owner: str) -> None:
        """Give back everything that an owner works on; that is no failed attempt."""
        with self.engine.begin() as connection:
            connection.execute(
                sa.update(WorkUnit)
                .where(WorkUnit.owner == owner, WorkUnit.state == RUNNING)
                .values(state=OPEN, owner=None, lease=None)
            )

    def give_back(self, claim: Claim, owner: str) -> bool:
        """Give one unit back, to be taken again; that is no failed attempt."""
        with self.engine.begin() as connection:
            return hand_over(connection, claim, owner, state=OPEN, owner=None)

    def release_dead(self, job: str | None = None) -> int:
        """Take units back from processes of this machine that are gone, without waiting for their leases."""
        of_job = () if job is None else (WorkUnit.job == job,)
        with self.engine.begin() as connection:
            owners = connection.scalars(
                sa.select(WorkUnit.owner).where(*of_job, WorkUnit.state == RUNNING).distinct()
            ).all()
        dead = [owner for owner in owners if owner is not None and has_died(owner)]
        for owner in dead:
            self.release(owner)
        return len(dead)

    def put_back(self, job: str, claim: Claim, owner: str, error: str) -> bool:
        """Leave a whole unit to be tried again, after an attempt that ended in an error."""
        with self.engine.begin() as connection:
            held = hand_over(connection, claim, owner, state=OPEN, owner=None, attempts=claim.attempts + 1)
            if held:
                what = f" of {len(claim.questions)} questions" if claim.questions else ""
                insert_event(connection, job, "failed", f"attempt {claim.attempts + 1}{what}: {error}")
        return held

    def complete(self, job: str, claim: Claim, owner: str, ending: Ending) -> bool:
        """Write how a job of one unit ended, if the owner still holds the unit and the job has not ended.

        Returns
        -------
        bool
            False where another owner has the unit, or the job was cancelled; then nothing of it is written.
        """
        with self.engine.begin() as connection:
            held = hand_over(connection, claim, owner, state=DONE, attempts=claim.attempts + 1)
            if held and self._end_on(connection, job, ending):
                return True
            connection.rollback()
        return False

    def unfinished(self, jobs: Iterable[str]) -> set[str]:
        """Those of the jobs that have not ended."""
        with self.engine.connect() as connection:
            return set(connection.scalars(sa.select(Job.id).where(Job.id.in_(list(jobs)), Job.state.in_(LIVE))))

    def progress(self, job: str, state: Mapping[str, object]) -> None:
        """Note how far a job is; of one that has ended nothing is noted."""
        with self.engine.begin() as connection:
            connection.execute(
                sa.update(Job).where(Job.id == job, Job.state == RUNNING).values(progress=dict(state), updated=moment())
            )

    def open_units(self, job: str) -> tuple[int, int]:
        """Numbers of units that are open, and that somebody works on."""
        with self.engine.begin() as connection:
            counted = connection.execute(
                sa.select(WorkUnit.state, sa.func.count()).where(WorkUnit.job == job).group_by(WorkUnit.state)
            )
            counts = {state: count for state, count in counted}
        return int(counts.get(OPEN, 0)), int(counts.get(RUNNING, 0))

    # -- workers -------------------------------------------------------------------------------

    def sign(self, owner: str, host: str, code: str, slots: Mapping[str, object]) -> None:
        """Give a sign of life of a worker, and renew what it works on."""
        with self.engine.begin() as connection:
            seen = {"seen": moment(), "slots": dict(slots), "code": code}
            known = connection.execute(sa.update(WorkerSign).where(WorkerSign.owner == owner).values(**seen))
            if known.rowcount == 0:
                new = {"owner": owner, "host": host, "started": moment(), **seen}
                connection.execute(sa.insert(WorkerSign).values(**new))

    def sign_off(self, owner: str) -> None:
        """Take a worker from the list."""
        with self.engine.begin() as connection:
            connection.execute(sa.delete(WorkerSign).where(WorkerSign.owner == owner))

    def workers(self, within: float) -> list[WorkerSign]:
        """Return the workers that have given a sign within so many seconds."""
        with Session(self.engine, expire_on_commit=False) as session:
            return list(session.scalars(sa.select(WorkerSign).where(WorkerSign.seen > moment() - within)))

    def adopt(self, code: str, within: float) -> int:
        """Take over jobs of one unit whose programs have gone, as after an update; return how many.

        Batches stay with the program they were begun with: their answers must not be mixed.
        """
        living = sa.select(WorkerSign.code).where(WorkerSign.seen > moment() - within)
        with self.engine.begin() as connection:
            adopted = connection.execute(
                sa.update(Job)
                .where(Job.state.in_(LIVE), Job.kind != BATCH, Job.code != code, Job.code.not_in(living))
                .values(code=code)
            )
        return int(adopted.rowcount)


def hand_over(connection: sa.Connection, claim: Claim, holder: str, **values: Any) -> bool:
    """Write to a unit that its holder is done with; return whether it was still held under the claim."""
    held = (WorkUnit.state == RUNNING, WorkUnit.owner == holder, WorkUnit.token == claim.token)
    written = sa.update(WorkUnit).where(WorkUnit.id == claim.unit, *held).values(lease=None, **values)
    return bool(connection.execute(written).rowcount == 1)


def _free() -> sa.ColumnElement[bool]:
    """Return the condition that a unit may be taken."""
    return sa.or_(WorkUnit.state == OPEN, sa.and_(WorkUnit.state == RUNNING, WorkUnit.lease < moment()))
