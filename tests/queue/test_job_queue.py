"""The queue: jobs of any kind, whose turn it is, and how they end; the same on SQLite and PostgreSQL."""

from __future__ import annotations

import secrets
import threading
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from synth.batches.store import Store
from synth.queue.database import file_url
from synth.queue.job_table import (
    CANCELLED,
    DONE,
    FAILED,
    LOCAL,
    OPEN,
    RUNNING,
    STOPPED,
    Ending,
    KeyInUseError,
    NewJob,
    QueueFullError,
    new_id,
)
from synth.queue.models import Job, Tenant, WorkUnit, moment
from synth.queue.owners import new_owner
from synth.queue.records import Record
from synth.queue.settings import StoreSettings

CODE = "c" * 64


def asked(title: str = "a", **more: Any) -> NewJob:
    usual: dict[str, Any] = {"kind": "synthesis", "request": {"family": title}, "fingerprint": title, "code": CODE}
    return NewJob(**{"title": title, **usual, **more})


@pytest.fixture
def store(database: str) -> Iterator[Store]:
    with Store(database, settings=StoreSettings(starving=5.0)) as opened:
        yield opened


def tenant(store: Store, name: str, **limits: int) -> int:
    with store.engine.begin() as connection:
        made = sa.insert(Tenant).values(name=name, limits=limits, created=moment()).returning(Tenant.id)
        return int(connection.execute(made).scalar_one())


def test_ids_differ_and_sort_by_time() -> None:
    first = new_id()
    time.sleep(0.002)
    later = [new_id() for _ in range(1000)]
    assert len({first, *later}) == 1001
    assert all(len(name) == 26 and name > first for name in later)


def test_a_job_is_made_worked_at_and_read_back(store: Store) -> None:
    job, made = store.submit(asked(parent="p", seconds_limit=3.0, keep=60.0))
    assert made
    taken = store.claim_next("me", CODE)
    assert taken is not None
    found, claim = taken
    assert (found.id, found.state, found.tenant, claim.task, claim.questions) == (job, RUNNING, LOCAL, "job", {})
    store.progress(job, {"share": 0.5})
    record = Record.of("front.json", '{"x": 0.1}')
    ending = Ending(state=DONE, outcome="optimal", summary={"designs": 3}, records=[record])
    assert store.complete(job, claim, "me", ending)
    ended = store.job(job)
    assert ended is not None
    assert (ended.state, ended.outcome, ended.summary, ended.progress) == (
        DONE,
        "optimal",
        {"designs": 3},
        {"share": 0.5},
    )
    assert ended.created <= (ended.started or 0) <= (ended.ended or 0)
    assert store.records(job) == {"front.json": record}
    assert [event.kind for event in store.happenings(0, job=job)] == ["created", "started", DONE]
    assert store.happenings(0)[-1].data == {"state": DONE, "outcome": "optimal"}
    assert store.claim_next("me", CODE) is None


def test_nothing_is_written_of_a_job_that_was_cancelled_or_lost(store: Store) -> None:
    job, _ = store.submit(asked())
    taken = store.claim_next("me", CODE, lease=-1.0)
    again = store.claim_next("you", CODE)
    assert taken is not None
    assert again is not None
    done = Ending(state=DONE, records=[Record.of("front.json", "{}")])
    assert not store.complete(job, taken[1], "me", done)  # somebody else has it
    assert store.cancel(job)
    assert not store.complete(job, again[1], "you", done)
    assert not store.end(job, done)
    assert store.records(job) == {}
    found = store.job(job)
    assert found is not None
    assert found.state == CANCELLED
    assert store.unfinished([job]) == set()
    assert store.claim_next("me", CODE) is None
    assert store.open_units(job) == (0, 1)  # the unit is still held; it is free again when the job is
    assert store.give_back(again[1], "you")
    store.reopen(job, "resumed")
    assert store.claim_next("me", CODE) is not None


def test_where_somebody_waits_goes_first_and_tenants_take_turns(store: Store) -> None:
    other = tenant(store, "other")
    bulk, _ = store.submit(asked("bulk", priority=0))
    first = [store.submit(asked(f"first {k}"))[0] for k in range(3)]
    second = [store.submit(asked(f"second {k}", tenant=other))[0] for k in range(2)]
    order = []
    while taken := store.claim_next("me", CODE, bulk=False):
        order.append(taken[0].id)
    assert order == [first[0], second[0], first[1], second[1], first[2]]
    assert not store.interactive_waits(CODE)
    taken = store.claim_next("me", CODE)
    assert taken is not None
    assert taken[0].id == bulk


def test_bulk_work_does_not_starve(store: Store) -> None:
    bulk, _ = store.submit(asked("bulk", priority=0))
    waiting, _ = store.submit(asked("waiting"))
    with store.engine.begin() as connection:
        connection.execute(sa.update(Job).where(Job.id == bulk).values(created=moment() - 6.0))
    taken = store.claim_next("me", CODE, bulk=False)
    assert taken is not None
    assert taken[0].id == bulk
    taken = store.claim_next("me", CODE, bulk=False)
    assert taken is not None
    assert taken[0].id == waiting


def test_tenants_have_limits(store: Store) -> None:
    small = tenant(store, "small", open_jobs=2, running=1)
    jobs = [store.submit(asked(str(k), tenant=small))[0] for k in range(2)]
    with pytest.raises(QueueFullError, match="2 jobs"):
        store.submit(asked("c", tenant=small))
    taken = store.claim_next("me", CODE)
    assert taken is not None
    assert store.claim_next("me", CODE) is None  # one at a time
    assert store.complete(taken[0].id, taken[1], "me", Ending(state=FAILED, error={"message": "no"}))
    assert store.claim_next("me", CODE) is not None
    assert store.submit(asked("c", tenant=small))[1]
    assert store.job(jobs[0], LOCAL) is None
    assert store.job(jobs[0], small) is not None


def test_many_who_ask_at_once_have_no_more_open_jobs_than_they_may(store: Store) -> None:
    small = tenant(store, "small", open_jobs=3)
    ended, _ = store.submit(asked("ended", tenant=small))
    assert store.cancel(ended)
    begin, found = threading.Barrier(10), []

    def ask(number: int) -> None:
        begin.wait()
        try:
            if number % 5 == 0:
                found.append(store.resume(ended, small, CODE))
            else:
                found.append(store.submit(asked(str(number), tenant=small))[1])
        except QueueFullError:
            found.append(False)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 10
    assert sum(found) == 3
    assert len(store.page(small, states=(OPEN,))) == 3


def test_the_same_said_again_is_the_same_job_where_no_other_could_be_had(store: Store) -> None:
    small = tenant(store, "small", open_jobs=1)
    one, _ = store.submit(asked(tenant=small, idempotency="k", body="x"))
    assert store.submit(asked(tenant=small, idempotency="k", body="x")) == (one, False)


def test_programs_with_other_code_take_nothing_and_adopt_what_was_left(store: Store) -> None:
    old, _ = store.submit(asked("old", code="a" * 64))
    batch, _ = store.submit(asked("batch", code="a" * 64, kind="batch"))
    assert store.claim_next("me", CODE) is None
    store.sign("old worker", "host", "a" * 64, {"slots": 1})
    assert store.adopt(CODE, 30.0) == 0
    assert [worker.owner for worker in store.workers(30.0)] == ["old worker"]
    store.sign_off("old worker")
    assert store.adopt(CODE, 30.0) == 1
    taken = store.claim_next("me", CODE)
    assert taken is not None
    assert taken[0].id == old
    kept = store.job(batch)
    assert kept is not None
    assert kept.code == "a" * 64


def test_a_key_makes_one_job_and_stands_for_one_request(store: Store) -> None:
    one, made = store.submit(asked(idempotency="k", body="x"))
    assert made
    assert store.submit(asked(idempotency="k", body="x")) == (one, False)
    with pytest.raises(KeyInUseError):
        store.submit(asked(idempotency="k", body="y"))
    other = tenant(store, "other")
    assert store.submit(asked(idempotency="k", body="y", tenant=other))[1]
    found = [store.submit(asked("rows", kind="batch")) for _ in range(2)]
    assert found == [(found[0][0], True), (found[0][0], False)]
    assert store.submit(asked("rows", kind="batch", tenant=other))[1]


def test_the_same_is_said_at_the_same_time(store: Store) -> None:
    found: list[tuple[str, bool]] = []

    def say() -> None:
        found.append(store.submit(asked(idempotency="k", body="x")))

    threads = [threading.Thread(target=say) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({job for job, _ in found}) == 1
    assert sum(made for _, made in found) == 1


def test_pages_hold_every_job_once(store: Store) -> None:
    made = [store.submit(asked(f"job {k}", kind="explain" if k % 3 == 0 else "synthesis"))[0] for k in range(10)]
    seen: list[str] = []
    before = None
    while some := store.page(LOCAL, most=3, before=before):
        seen += [job.id for job in some]
        before = some[-1].created, some[-1].id
    assert sorted(seen) == sorted(made)
    assert [job.id for job in store.page(LOCAL, kind="explain")] == [made[k] for k in (9, 6, 3, 0)]
    assert [job.title for job in store.page(LOCAL, text="job 7")] == ["job 7"]
    assert store.page(LOCAL, text="%") == []
    assert store.page(LOCAL, states=[DONE]) == []
    assert store.page(2) == []


def test_what_is_over_goes_and_what_is_pinned_stays(store: Store) -> None:
    gone, kept, live = (store.submit(asked(name, keep=-1.0))[0] for name in "abc")
    for job in (gone, kept):
        store.cancel(job)
    store.change(kept, pinned=True)
    assert store.prune() == 1
    assert {job.id for job in store.jobs()} == {kept, live}
    assert {event.job for event in store.happenings(0)} == {kept, live}
    assert store.delete(live)
    assert not store.delete(kept)  # as long as it is pinned
    assert [job.id for job in store.jobs()] == [kept]
    store.change(kept, pinned=False)
    assert store.delete(kept)


def over(store: Store, *jobs: str) -> None:
    """Let the time of some jobs be over."""
    with store.engine.begin() as connection:
        connection.execute(sa.update(Job).where(Job.id.in_(jobs)).values(expires=moment() - 1.0))


@pytest.mark.slow
@pytest.mark.parametrize("how", ["of", "parent"])
@pytest.mark.parametrize("why", ["open", "younger", "pinned"])
def test_what_a_job_refers_to_stays_as_long_as_that_does(store: Store, how: str, why: str) -> None:
    def follow(title: str, before: str) -> str:
        given: dict[str, Any] = {"parent": before} if how == "parent" else {"request": {"of": before}}
        return store.submit(asked(title, keep=100.0, **given))[0]

    front, _ = store.submit(asked("front", keep=100.0))
    prices = follow("prices", front)
    report = follow("report", prices)
    other, _ = store.submit(asked("other", keep=100.0))
    for job in (front, prices, other, *(() if why == "open" else (report,))):
        store.cancel(job)
    store.change(report, pinned=why == "pinned")
    over(store, front, prices, other, *(() if why == "younger" else (report,)))
    assert store.prune() == 1
    assert {job.id for job in store.jobs()} == {front, prices, report}
    assert store.prune() == 0
    store.cancel(report)
    store.change(report, pinned=False)
    over(store, report)
    assert [store.prune() for _ in range(4)] == [1, 1, 1, 0]
    assert store.jobs() == []


def test_the_time_of_a_job_runs_from_its_last_use(store: Store) -> None:
    def left(job: str) -> float:
        found = store.job(job)
        assert found is not None
        assert found.expires is not None
        return found.expires - time.time()

    def is_kept(job: str) -> bool:
        return 90.0 < left(job) < 110.0

    job, _ = store.submit(asked("a", keep=100.0))
    over(store, job)
    assert store.prune() == 0  # it is open
    assert store.end(job, Ending(state=DONE))
    assert is_kept(job)  # its end is a use: it has waited for longer than it is kept
    over(store, job)
    store.note_use([job])
    assert is_kept(job)
    cancelled, _ = store.submit(asked("b", keep=100.0))
    over(store, cancelled)
    store.cancel(cancelled)
    assert is_kept(cancelled)
    for_ever, _ = store.submit(asked("c"))
    store.note_use([for_ever], 5.0)
    store.cancel(for_ever)
    found = store.job(for_ever)
    assert found is not None
    assert found.expires is None
    with store.engine.begin() as connection:  # as an earlier version has made it
        connection.execute(sa.update(Job).where(Job.id == job).values(content={}, expires=moment() + 7.0))
    store.note_use([job])
    assert 0.0 < left(job) < 8.0
    store.note_use([job], 100.0)
    assert is_kept(job)


def test_an_open_job_tells_what_it_waits_for(store: Store) -> None:
    front, _ = store.submit(asked("front"))
    report, _ = store.submit(asked("report", request={"of": front}))
    assert (store.waits_for(front), store.waits_for(report)) == (report, None)
    store.cancel(report)
    assert store.waits_for(front) is None


def test_a_file_gets_smaller_when_jobs_go(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    with Store(file_url(file), settings=StoreSettings(pages_released=300)) as store:

        def pages() -> int:
            with store.engine.connect() as connection:
                return int(connection.exec_driver_sql("PRAGMA page_count").scalar_one())

        least = pages()
        for k in range(20):
            job, _ = store.submit(asked(str(k), keep=0.0, kept=[Record.of("table.csv", secrets.token_hex(100_000))]))
            store.cancel(job)
        most = pages()
        assert most > least + 400
        assert store.prune() == 20
        assert pages() == most - 300  # so many at a time
        for _ in range(5):
            store.prune()
        assert pages() <= least + 20
        with store.engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
        assert file.stat().st_size <= 4096 * (least + 20)
        assert store.submit(asked("more"))[1]


def test_numbers_of_units_and_events_are_not_given_twice(store: Store) -> None:
    store.submit(asked())
    last = store.last_event()
    (unit,) = _units(store)
    store.delete(store.jobs()[0].id)
    store.submit(asked())
    assert store.last_event() > last
    assert _units(store) > [unit]


def _units(store: Store) -> list[int]:
    with store.engine.connect() as connection:
        return list(connection.scalars(sa.select(WorkUnit.id)))


def test_a_census_counts_what_there_is(store: Store) -> None:
    assert store.census() == {"jobs": {}, "units": {}, "oldest": 0.0}
    store.submit(asked())
    store.submit(asked("b", kind="explain"))
    store.claim_next("me", CODE)
    found = store.census()
    assert found["jobs"] == {("synthesis", RUNNING): 1, ("explain", OPEN): 1}
    assert found["units"] == {OPEN: 1, RUNNING: 1}
    assert 0 <= found["oldest"] < 60


@pytest.mark.slow
def test_a_stopped_job_keeps_what_it_has_found(store: Store) -> None:
    job, _ = store.submit(asked())
    taken = store.claim_next("me", CODE)
    assert taken is not None
    found = Ending(state=STOPPED, records=[Record.of("front.json", "{}")])
    assert store.complete(job, taken[1], "me", replace(found, error={"code": "time_limit", "message": "late"}))
    ended = store.job(job)
    assert ended is not None
    assert ended.error == {"code": "time_limit", "message": "late"}
    assert list(store.records(job)) == ["front.json"]


@pytest.mark.slow
def test_every_job_is_taken_by_one_worker_only(store: Store) -> None:
    for k in range(12):
        store.submit(asked(str(k)))
    taken: list[str] = []
    guard = threading.Lock()

    def work() -> None:
        owner = new_owner()
        while found := store.claim_next(owner, CODE):
            with guard:
                taken.append(found[0].id)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(taken) == len(set(taken)) == 12


def test_only_units_that_are_named_stay_with_their_owner(store: Store) -> None:
    for k in range(2):
        store.submit(asked(str(k)))
    kept, lost = (store.claim_next("me", CODE, lease=-1.0) for _ in range(2))
    assert kept is not None
    assert lost is not None
    store.renew("me", 60.0, [kept[1].unit])
    taken = store.claim_next("you", CODE)
    assert taken is not None
    assert taken[0].id == lost[0].id
    assert store.claim_next("you", CODE) is None
