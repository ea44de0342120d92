"""The tables of batches: rows, the questions they ask, and their answers. Everything else of a job is in the queue.

A result is written in one transaction with the end of its unit; written twice, it stays the first.
"""

from __future__ import annotations

import itertools
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, cast

import sqlalchemy as sa
from sqlalchemy.exc import IntegrityError

from synth.batches.solve import GROUP
from synth.queue.database import digest
from synth.queue.job_queue import Claim, JobQueue, hand_over
from synth.queue.job_table import BATCH, BODY, DONE, KEEP, LOCAL, OPEN, ROWS, Ending, insert_event
from synth.queue.models import Job, Layout, Result, Row, RowQuestion, WorkUnit, moment

WITH_DESIGNS = ("optimal", "feasible")  # how rows stand that have some
NONE_UNGROUPED: Mapping[str, str] = MappingProxyType({})  # no question that a group leaves to a search by itself


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


class Store(JobQueue):
    """A job database with what batches keep in it."""

    def create(self, job: Mapping[str, object], rows: Iterable[Mapping[str, object]], rows_per_unit: int) -> bool:
        """Write a batch with its rows, questions and units, all or nothing.

        Parameters
        ----------
        job : mapping
            The columns of the job that are not those of every new batch: at least ``id``, ``basis``, ``source``,
            ``folder`` and ``content``.
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
        usual = {
            "tenant": LOCAL,
            "kind": BATCH,
            "title": job["source"],
            "fingerprint": name,
            "priority": 0,
            "request": {},
        }
        try:
            with self.engine.begin() as connection:
                connection.execute(sa.insert(Job).values(**{**usual, **job, "state": OPEN}))
                self._fill_on(connection, name, rows, rows_per_unit)
        except IntegrityError:
            if self.job(name) is None and self.job_like(BATCH, str(job.get("fingerprint", name))) is None:
                raise
            return False
        return True

    def plan(
        self,
        job: str,
        claim: Claim,
        owner: str,
        content: Mapping[str, object],
        basis: str,
        rows: Iterable[Mapping[str, object]],
        rows_per_unit: int,
    ) -> bool:
        """Write the rows of a batch that stands there without them, if the owner still holds the unit of planning.

        Parameters
        ----------
        job, claim, owner
            The unit, and who holds it.
        content, basis
            Columns of the job.
        rows, rows_per_unit
            As for :meth:`create`.

        Returns
        -------
        bool
            False where another owner has the unit, or the job is gone; then nothing is written.
        """
        with self.engine.begin() as connection:
            if not hand_over(connection, claim, owner, state=DONE, attempts=claim.attempts + 1):
                return False
            stored = connection.execute(sa.select(Job.content).where(Job.id == job)).scalar_one()
            # By which the same request is known when it comes again, and how long it is kept.
            kept = {name: stored[name] for name in (BODY, KEEP) if name in stored}
            planned = {**content, BODY: "", **kept}
            connection.execute(
                sa.update(Job).where(Job.id == job).values(content=planned, basis=basis, updated=moment())
            )
            self._fill_on(connection, job, rows, rows_per_unit)
        return True

    def _fill_on(
        self, connection: sa.Connection, job: str, rows: Iterable[Mapping[str, object]], rows_per_unit: int
    ) -> None:
        count = self._write_rows(connection, job, rows)
        connection.execute(sa.update(Job).where(Job.id == job).values(rows=count))
        known = self._copy_known(connection, job)
        units = self._write_units(connection, job, rows_per_unit)
        insert_event(connection, job, "created", f"{count} rows in {units} units, {known} questions answered before")

    def count_rows(self, job: str, pause: float) -> None:
        """Note how far a batch is among its progress, if that was not done within so many seconds."""
        record = self.job(job)
        known = None if record is None else (record.progress or {}).get("counted")
        now = time.time()
        if record is None or (known is not None and 0 <= now - known < pause):
            return
        self._record_progress(job, self.account(job), now)

    def _record_progress(self, job: str, account: Account, now: float) -> None:
        state = {"rows": account.rows, "done": account.done, "bad": account.bad, "status": dict(account.status)}
        self.progress(job, {**state, "counted": now})

    def settle(self, job: str) -> bool:
        """End a batch of which nothing is left to do; return whether it has ended by this."""
        if sum(self.open_units(job)):
            return False
        account = self.account(job)
        self._record_progress(job, account, time.time())  # all of them, once it has ended
        counts = {**account.status, "bad_input": account.bad} if account.bad else dict(account.status)
        has_designs = any(counts.get(status) for status in WITH_DESIGNS)
        outcome = next((status for status in WITH_DESIGNS if counts.get(status)), "infeasible")
        summary = {"rows": account.rows, "status": dict(sorted(counts.items())), "designs": has_designs}
        return self.end(job, Ending(state=DONE, outcome=outcome, summary=summary))

    def resume(self, job: str, tenant: int, code: str) -> bool:
        """Let a job go on, as :meth:`JobQueue.resume`; a batch of which all rows are answered ends at once."""
        goes_on = super().resume(job, tenant, code)
        if goes_on:
            self.settle(job)
        return goes_on

    def _write_rows(self, connection: sa.Connection, job: str, rows: Iterable[Mapping[str, object]]) -> int:
        count = 0
        for chunk in _chunks(rows, self.settings.chunk):
            questions = [{"job": job, "unit": None, **row["question"]} for row in chunk if row["question"] is not None]
            if questions:
                connection.execute(self.insert_once(RowQuestion), questions)
            connection.execute(
                sa.insert(Row), [{"job": job, **{k: v for k, v in row.items() if k != "question"}} for row in chunk]
            )
            count += len(chunk)
        return count

    def _copy_known(self, connection: sa.Connection, job: str) -> int:
        """Take the answers that another job of the same tenant and the same basis has; return how many."""
        keys = sa.select(RowQuestion.key).where(RowQuestion.job == job)
        this, other = sa.alias(cast(sa.Table, Job.__table__)), Job
        others = sa.select(other.id).where(
            this.c.id == job, other.basis == this.c.basis, other.tenant == this.c.tenant, other.id != job
        )
        usable = sa.and_(Result.job.in_(others), Result.key.in_(keys), Result.status != "failed")
        answers = sa.select(
            sa.literal(job), Result.key, Result.status, Result.seconds, Result.layout, Result.content
        ).where(usable)
        columns = ["job", "key", "status", "seconds", "layout", "content"]
        connection.execute(self.insert_once(Result).from_select(columns, answers))
        layout_keys = sa.select(Result.layout).where(Result.job == job)
        layouts = sa.select(sa.literal(job), Layout.key, Layout.content).where(
            Layout.job.in_(others), Layout.key.in_(layout_keys)
        )
        connection.execute(self.insert_once(Layout).from_select(["job", "key", "content"], layouts))
        return int(
            connection.execute(sa.select(sa.func.count()).select_from(Result).where(Result.job == job)).scalar_one()
        )

    def _write_units(self, connection: sa.Connection, job: str, rows_per_unit: int) -> int:
        count = 0
        waiting: list[list[str]] = []
        for unit in self._units_of(connection, job, rows_per_unit):
            waiting.append(unit)
            count += 1
            if sum(map(len, waiting)) >= self.settings.chunk:
                self._add_units(connection, job, waiting, 0)
                waiting.clear()
        if waiting:
            self._add_units(connection, job, waiting, 0)
        return count

    def _units_of(self, connection: sa.Connection, job: str, rows_per_unit: int) -> Iterator[list[str]]:
        """Yield the keys of each unit of what is not answered, some at a time."""
        order = (RowQuestion.structure, RowQuestion.position, RowQuestion.key)
        answered = sa.select(Result.key).where(Result.job == job)
        group = RowQuestion.content[GROUP]
        query = (
            sa.select(RowQuestion.structure, RowQuestion.key, group["name"].as_string(), group["rows"].as_integer())
            .where(RowQuestion.job == job, RowQuestion.key.not_in(answered))
            .order_by(*order)
            .execution_options(stream_results=True, yield_per=self.settings.chunk)
        )
        for (_, _, rows), same in itertools.groupby(
            connection.execute(query), key=lambda question: (question[0], *question[2:])
        ):
            if rows is None:
                yield from _chunks((question[1] for question in same), rows_per_unit)
                continue
            keys = [question[1] for question in same]
            # What is left of a group that was answered before cannot be answered as the group was.
            yield from [keys] if len(keys) == rows else _chunks(keys, rows_per_unit)

    @staticmethod
    def _add_units(connection: sa.Connection, job: str, units: Sequence[Sequence[str]], attempts: int) -> None:
        new = {"job": job, "task": ROWS, "state": OPEN, "attempts": attempts}
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

    def _add_results(self, connection: sa.Connection, job: str, outcomes: Mapping[str, Outcome]) -> None:
        layouts = {digest(o.layout): o.layout for o in outcomes.values() if o.layout is not None}
        if layouts:
            rows = [{"job": job, "key": key, "content": layout} for key, layout in layouts.items()]
            connection.execute(self.insert_once(Layout), rows)
        if outcomes:
            new = [
                {**vars(o), "job": job, "key": key, "layout": None if o.layout is None else digest(o.layout)}
                for key, o in outcomes.items()
            ]
            connection.execute(self.insert_once(Result), new)

    def finish(
        self,
        job: str,
        claim: Claim,
        owner: str,
        outcomes: Mapping[str, Outcome],
        errors: Mapping[str, str],
        most_attempts: int,
        ungrouped: Mapping[str, str] = NONE_UNGROUPED,
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
        ungrouped : mapping
            Question key -> why its group leaves it to a search by itself: each in a unit of its own, as if for the
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
            if not hand_over(connection, claim, owner, state=DONE, attempts=attempts):
                return False
            self._add_results(connection, job, final)
            for keys, tried in ((again, attempts), (list(ungrouped), claim.attempts)):
                if keys:
                    self._add_units(connection, job, [[key] for key in keys], tried)
            for key, error in errors.items():
                insert_event(connection, job, "failed", f"attempt {attempts} of question {key[:12]}: {error}")
            for reason, count in Counter(filter(None, ungrouped.values())).items():
                insert_event(connection, job, "alone", f"{count} questions of a group: {reason}")
        return True

    # -- looking -------------------------------------------------------------------------------

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
        order = (Row.position, Row.line) if canonical else (Row.line,)
        # Lines alone are put in order: to sort rows with all that was found would take as much room again.
        streamed = {"stream_results": True, "yield_per": self.settings.chunk}
        query = sa.select(Row.line).where(Row.job == job).order_by(*order).execution_options(**streamed)
        with self.engine.connect() as connection:
            for chunk in _chunks(connection.scalars(query), self.settings.chunk):
                answers = answered_rows().where(Row.job == job, Row.line.in_(chunk))
                by_line = {row[0]: row for row in connection.execute(answers)}
                yield from (Answered(*by_line[line]) for line in chunk)

    def questions(self, job: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
        """Return the questions of a job in canonical order: key, structure, content."""
        query = (
            sa.select(RowQuestion.key, RowQuestion.structure, RowQuestion.content)
            .where(RowQuestion.job == job)
            .order_by(RowQuestion.structure, RowQuestion.position, RowQuestion.key)
        )
        with self.engine.connect().execution_options(stream_results=True, yield_per=self.settings.chunk) as connection:
            for row in connection.execute(query):
                yield row[0], row[1], row[2]

    def layouts(self, job: str) -> dict[str, dict[str, Any]]:
        """Return the layouts of a job by key."""
        with self.engine.begin() as connection:
            rows = connection.execute(sa.select(Layout.key, Layout.content).where(Layout.job == job))
            return {key: content for key, content in rows}


def answered_rows() -> sa.Select[Any]:
    """Return the question for rows beside their answers, with the columns of :class:`Answered`."""
    joined = sa.and_(Result.job == Row.job, Result.key == Row.key)
    return sa.select(
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
    ).join(Result, joined, isouter=True)


def _chunks(items: Iterable[Any], size: int) -> Iterator[list[Any]]:
    remaining = iter(items)
    while chunk := list(itertools.islice(remaining, size)):
        yield chunk
