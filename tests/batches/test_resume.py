"""Jobs that go on after they have ended, and what services look at; the same on SQLite and PostgreSQL."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import sqlalchemy as sa

from synth.batches.store import Outcome, Store
from synth.batches.views import layouts_of, packed_record, row_at, rows_after, standings, uploads_kept
from synth.queue.job_table import (
    CANCELLED,
    DONE,
    FAILED,
    LOCAL,
    OPEN,
    OPEN_LIMIT,
    PLAN,
    RUNNING,
    STOPPED,
    Ending,
    NewJob,
    QueueFullError,
)
from synth.queue.models import Job, Row, RowQuestion, Tenant
from synth.queue.records import Record

CODE, NEW_CODE = "c" * 64, "d" * 64


@pytest.fixture
def store(database: str) -> Iterator[Store]:
    with Store(database) as opened:
        yield opened


def asked(title: str = "a", **more: object) -> NewJob:
    usual: dict[str, object] = {"kind": "synthesis", "request": {}, "fingerprint": title, "code": CODE, "title": title}
    return NewJob(**{**usual, **more})  # type: ignore[arg-type]


@pytest.mark.parametrize("state", [FAILED, STOPPED])
def test_a_job_that_has_ended_badly_begins_anew(store: Store, state: str) -> None:
    job, _ = store.submit(asked())
    (claim,) = store.claim(job, "me", 1)
    kept = Record.of("front.json", "{}")
    ending = Ending(state=state, outcome="feasible", error={"code": "x", "message": "y"}, records=[kept])
    assert store.complete(job, claim, "me", ending)
    assert store.resume(job, LOCAL, NEW_CODE)
    found = store.job(job)
    assert found is not None
    assert (found.state, found.ended, found.error, found.outcome, found.code) == (OPEN, None, None, None, NEW_CODE)
    assert store.open_units(job) == (1, 0)
    assert set(store.records(job)) == {"front.json"}  # what was found is there until it ends again
    taken = store.claim_next("me", NEW_CODE)
    assert taken is not None
    assert taken[1].attempts == 0
    assert store.complete(job, taken[1], "me", Ending(state=DONE))
    assert not store.resume(job, LOCAL, CODE)
    assert [one.kind for one in store.happenings(0, job=job)] == [
        "created",
        "started",
        state,
        "resumed",
        "started",
        "done",
    ]


def test_whoever_worked_at_a_cancelled_job_cannot_end_it_when_it_goes_on(store: Store) -> None:
    job, _ = store.submit(asked())
    (claim,) = store.claim(job, "me", 1)
    assert not store.resume(job, LOCAL, CODE)
    assert store.cancel(job)
    assert not store.resume(job, LOCAL + 1, CODE)  # another tenant's
    assert store.resume(job, LOCAL, CODE)
    assert not store.complete(job, claim, "me", Ending(state=DONE))
    (again,) = store.claim(job, "you", 1)
    assert store.complete(job, again, "you", Ending(state=DONE))


def test_a_job_goes_on_only_where_there_is_room(store: Store) -> None:
    with store.engine.begin() as connection:
        connection.execute(sa.update(Tenant).where(Tenant.id == LOCAL).values(limits={OPEN_LIMIT: 1}))
    job, _ = store.submit(asked())
    assert store.cancel(job)
    store.submit(asked("b"))
    with pytest.raises(QueueFullError):
        store.resume(job, LOCAL, CODE)
    found = store.job(job)
    assert found is not None
    assert found.state == CANCELLED


def rows(count: int) -> list[dict[str, object]]:
    return [
        {
            "line": k,
            "position": bytes([k]),
            "key": f"k{k}" if k else None,
            "family": "f",
            "cells": [str(k)],
            "remarks": "",
            "faults": [],
            "question": {"key": f"k{k}", "structure": "s", "position": bytes([k]), "content": {"n": k}} if k else None,
        }
        for k in range(count)
    ]


def test_a_batch_that_was_planned_is_not_planned_again(store: Store) -> None:
    request = asked(kind="batch", task=PLAN, idempotency="key", body="digest")
    job, _ = store.submit(request)
    (claim,) = store.claim(job, "me", 1)
    assert store.cancel(job)
    assert store.resume(job, LOCAL, CODE)
    (claim,) = store.claim(job, "me", 1)
    assert claim.task == PLAN
    assert store.plan(job, claim, "me", {"families": ["f"]}, "basis", rows(4), 1)
    assert store.submit(request) == (job, False)  # the same request is still known by its key
    assert store.cancel(job)
    assert store.resume(job, LOCAL, CODE)
    assert store.open_units(job) == (3, 0)
    assert {claim.task for claim in store.claim(job, "me", 9)} == {"rows"}
    found = store.job(job)
    assert found is not None
    assert found.state == RUNNING


def test_a_batch_that_was_cancelled_with_its_last_row_ends_when_it_goes_on(store: Store) -> None:
    job, _ = store.submit(asked(kind="batch", task=PLAN))
    (claim,) = store.claim(job, "me", 1)
    assert store.plan(job, claim, "me", {"families": ["f"]}, "basis", rows(2), 1)
    (claim,) = store.claim(job, "me", 1)
    answers = {key: Outcome("optimal", 0.1, None, {}) for key in claim.questions}
    assert store.finish(job, claim, "me", answers, {}, 3)
    assert store.cancel(job)
    assert store.resume(job, LOCAL, CODE)
    found = store.job(job)
    assert found is not None
    assert (found.state, found.outcome) == (DONE, "optimal")


def test_rows_and_standings_are_looked_at_in_pieces(store: Store) -> None:
    job, _ = store.submit(asked(kind="batch", task=PLAN))
    (claim,) = store.claim(job, "me", 1)
    assert store.plan(job, claim, "me", {"families": ["f", "g_h"]}, "basis", rows(4), 1)
    assert [row.line for row in rows_after(store, job, -1, 2)] == [0, 1]
    assert [row.line for row in rows_after(store, job, 1, 9)] == [2, 3]
    assert [row.line for row in rows_after(store, job, -1, 9, ["bad_input"])] == [0]
    assert [row.line for row in rows_after(store, job, -1, 9, ["not_solved"])] == [1, 2, 3]
    assert [row.line for row in rows_after(store, job, -1, 9, ["optimal"])] == []
    there = row_at(store, job, 2)
    assert there is not None
    assert (there[0].cells, there[1]) == (["2"], {"n": 2})
    assert row_at(store, job, 9) is None
    assert layouts_of(store, job, []) == {}
    assert set(standings(store, [job, "nothing"])) == {job}
    assert [found.id for found in store.page(LOCAL, family="g_h")] == [job]
    assert store.page(LOCAL, family="gxh") == []
    assert store.page(LOCAL, family="g") == []
    store.keep(job, Record.of("front.json", "{}"))
    packed = packed_record(store, job, "front.json")
    assert packed is not None
    assert (packed.size, packed.media) == (2, "application/json")
    assert packed_record(store, job, "other") is None
    assert uploads_kept(store, LOCAL) == 0
    with store.engine.connect() as connection:
        for table in (Row, RowQuestion, Job):
            assert connection.scalar(sa.select(sa.func.count()).select_from(table))
