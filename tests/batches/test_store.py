"""The job database: the same behaviour on SQLite and PostgreSQL."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext

from synth.batches.store import Outcome, Store
from synth.errors import InputError
from synth.queue import database as module
from synth.queue.database import digest, file_url
from synth.queue.job_table import CANCELLED, OPEN, RUNNING
from synth.queue.models import VERSION_TABLE, Base, WorkUnit
from synth.queue.owners import has_died, new_owner
from tests.waiting import PATIENCE


def outcome(text: str = "found", status: str = "optimal") -> Outcome:
    return Outcome(status, 0.5, {"family": "f", "columns": [text]}, {"rows": [[text]], "value": 0.1 + 0.2})


def rows(count: int, structure: str = "s") -> Iterator[dict[str, Any]]:
    for k in range(count):
        key = digest([structure, k])
        question = {"key": key, "structure": structure, "position": b"%05d" % k, "content": {"n": k}}
        yield {
            "line": k + 2,
            "position": b"%05d" % (count - k),
            "key": key,
            "family": "f",
            "cells": [str(k), "é;\n"],
            "remarks": "",
            "faults": [],
            "question": question,
        }


def job(name: str = "j", basis: str = "b") -> dict[str, Any]:
    return {"id": name, "basis": basis, "source": "rows.csv", "folder": "/tmp/x", "content": {"a": 1}}


@pytest.fixture
def store(database: str) -> Iterator[Store]:
    with Store(database) as opened:
        yield opened


def test_a_job_is_worked_off_and_read_back(store: Store) -> None:
    assert store.create(job(), rows(5), 2)
    assert store.open_units("j") == (3, 0)
    owner = new_owner()
    claims = store.claim("j", owner, 2)
    assert [len(claim.questions) for claim in claims] == [2, 2]
    assert [content["n"] for content in claims[0].questions.values()] == [0, 1]
    assert store.open_units("j") == (1, 2)
    for claim in claims:
        assert store.finish("j", claim, owner, {key: outcome() for key in claim.questions}, {}, 3)
    account = store.account("j")
    assert (account.rows, account.bad, account.done, account.status) == (5, 0, 4, {"optimal": 4})
    found = list(store.rows("j", canonical=False))
    assert [row.line for row in found] == [2, 3, 4, 5, 6]
    assert [row.status for row in found] == ["optimal"] * 4 + [None]
    assert found[0].cells == ["0", "é;\n"]
    assert found[0].content == {"rows": [["found"]], "value": 0.1 + 0.2}
    assert [row.line for row in store.rows("j", canonical=True)] == [6, 5, 4, 3, 2]
    assert list(store.layouts("j").values()) == [{"family": "f", "columns": ["found"]}]
    assert [kind for _, kind, _ in store.events("j")] == ["created", "started"]
    assert [content["n"] for _, _, content in store.questions("j")] == [0, 1, 2, 3, 4]


def test_a_job_is_made_once_and_whole(store: Store) -> None:
    assert store.create(job(), rows(3), 1)
    assert not store.create(job(), rows(3), 1)

    def broken() -> Iterator[dict[str, Any]]:
        yield from rows(2)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        store.create(job("k"), broken(), 1)
    assert store.job("k") is None
    assert [found.id for found in store.jobs()] == ["j"]


def test_rows_that_ask_the_same_share_an_answer(store: Store) -> None:
    same = [*rows(2), *({**row, "line": row["line"] + 10} for row in rows(2))]
    store.create(job(), same, 4)
    owner = new_owner()
    (claim,) = store.claim("j", owner, 9)
    assert len(claim.questions) == 2
    store.finish("j", claim, owner, {key: outcome() for key in claim.questions}, {}, 3)
    assert store.account("j").status == {"optimal": 4}


def test_every_unit_is_claimed_by_one_owner_only(store: Store) -> None:
    store.create(job(), rows(40), 1)
    taken: list[int] = []
    guard = threading.Lock()

    def work() -> None:
        owner = new_owner()
        while claims := store.claim("j", owner, 3):
            with guard:
                taken.extend(claim.unit for claim in claims)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(taken) == len(set(taken)) == 40


def test_an_owner_that_gives_no_sign_of_life_is_fenced_off(store: Store) -> None:
    store.create(job(), rows(1), 1)
    slow, quick = new_owner(), new_owner()
    (old,) = store.claim("j", slow, 1, lease=-1.0)
    (new,) = store.claim("j", quick, 1)
    assert (new.unit, new.token) == (old.unit, old.token + 1)
    (key,) = new.questions
    assert store.finish("j", new, quick, {key: outcome("quick")}, {}, 3)
    assert not store.finish("j", old, slow, {key: outcome("slow")}, {}, 3)
    (row,) = store.rows("j", canonical=True)
    assert row.content is not None
    assert row.content["rows"] == [["quick"]]


def test_a_sign_of_life_keeps_the_lease(store: Store) -> None:
    store.create(job(), rows(1), 1)
    owner = new_owner()
    store.claim("j", owner, 1, lease=-1.0)
    store.renew(owner)
    assert store.claim("j", new_owner(), 1) == []
    store.release(owner)
    assert len(store.claim("j", new_owner(), 1)) == 1


def test_an_answer_that_is_written_twice_stays_the_first(store: Store) -> None:
    store.create(job(), rows(1), 1)
    first, second = new_owner(), new_owner()
    (claim,) = store.claim("j", first, 1)
    (key,) = claim.questions
    store.finish("j", claim, first, {key: outcome("first")}, {}, 3)
    with store.engine.begin() as connection:  # as if the end of the unit had been lost
        connection.execute(sa.update(WorkUnit).values(state=OPEN))
    (again,) = store.claim("j", second, 1)
    assert store.finish("j", again, second, {key: outcome("second")}, {}, 3)
    (row,) = store.rows("j", canonical=True)
    assert row.content is not None
    assert row.content["rows"] == [["first"]]


def test_a_question_that_fails_is_tried_alone_and_at_last_keeps_its_error(store: Store) -> None:
    store.create(job(), rows(3), 3)
    owner = new_owner()
    (claim,) = store.claim("j", owner, 1)
    good, bad, other = claim.questions
    store.finish("j", claim, owner, {good: outcome()}, {bad: "boom 1", other: "boom 1"}, 3)
    for attempt in (2, 3):
        claims = store.claim("j", owner, 9)
        assert [list(c.questions) for c in claims] == ([[bad], [other]] if attempt == 2 else [[bad]])
        for c in claims:
            (key,) = c.questions
            store.finish(
                "j", c, owner, {} if key == bad else {key: outcome()}, {bad: f"boom {attempt}"} if key == bad else {}, 3
            )
    assert store.claim("j", owner, 9) == []
    assert store.account("j").status == {"optimal": 2, "failed": 1}
    (failed,) = (row for row in store.rows("j", canonical=False) if row.status == "failed")
    assert failed.content == {"error": "boom 3", "attempts": 3}
    events = [text for _, kind, text in store.events("j") if kind == "failed"]
    assert any("attempt 1" in text and "boom 1" in text for text in events)


@pytest.mark.slow
def test_units_of_a_process_that_died_are_free_at_once(store: Store) -> None:
    store.create(job(), rows(2), 1)
    gone = subprocess.run(
        [sys.executable, "-c", "from synth.queue.owners import new_owner; print(new_owner())"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    living = new_owner()
    store.claim("j", gone, 1)
    store.claim("j", living, 1)
    assert store.release_dead("j") == 1
    assert store.open_units("j") == (1, 1)
    host, process, _, rest = living.rsplit("/", 3)
    assert has_died(gone)
    assert not has_died(living)
    assert not has_died(f"elsewhere/{os.getpid() + 1}/0/x")
    assert has_died(f"{host}/{process}/1/{rest}")  # its number went to another process


def test_answers_of_the_same_basis_are_taken_over(store: Store) -> None:
    store.create(job(), rows(3), 1)
    owner = new_owner()
    for claim in store.claim("j", owner, 2):
        (key,) = claim.questions
        fault = claim.questions[key]["n"] == 1
        store.finish("j", claim, owner, {} if fault else {key: outcome()}, {key: "boom"} if fault else {}, 1)
    store.create(job("same"), rows(4), 1)
    store.create(job("other", basis="another"), rows(4), 1)
    assert store.account("same").status == {"optimal": 1}  # what failed is tried again
    assert store.open_units("same") == (3, 0)
    assert store.open_units("other") == (4, 0)


def test_the_state_of_a_job_changes_with_an_event(store: Store) -> None:
    store.create(job(), rows(1), 1)
    assert store.cancel("j")
    found = store.job("j")
    assert found is not None
    assert found.state == CANCELLED
    assert store.events("j")[-1][1:] == ("cancelled", "")
    assert not store.cancel("j")
    assert store.claim("j", new_owner(), 1) == []
    store.reopen("j", "resumed", "by hand")
    assert len(store.claim("j", new_owner(), 1)) == 1
    found = store.job("j")
    assert found is not None
    assert found.state == RUNNING
    assert [kind for _, kind, _ in store.events("j")] == ["created", "cancelled", "resumed", "started"]


def test_migrations_make_what_the_models_say(new_database: str) -> None:
    with Store(new_database) as store:
        with store.engine.connect() as connection:
            options = {"version_table": VERSION_TABLE, "compare_type": True}
            context = MigrationContext.configure(connection, opts=options)
            assert compare_metadata(context, Base.metadata) == []
        assert module.version_of(store.engine) == module.HEAD
        with Store(store.engine.url, create=False) as again:
            assert again.jobs() == []


@pytest.mark.parametrize("version", ["9", "10", "0", "02-later"])
def test_tables_of_a_later_version_are_left_alone(store: Store, version: str) -> None:
    # What counts is the chain of migrations that is known, not how the names of two versions sort as words.
    with store.engine.begin() as connection:
        connection.execute(sa.text(f"UPDATE {VERSION_TABLE} SET version_num = '{version}'"))
    with pytest.raises(InputError, match=f"these are {version}"):
        Store(store.engine.url)


def test_a_new_file_that_another_process_writes_into_is_waited_for(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    other = sqlite3.connect(file, isolation_level=None, check_same_thread=False)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(sqlite3.OperationalError, match="locked"), closing(sqlite3.connect(file, timeout=60)) as first:
        first.execute("PRAGMA journal_mode=WAL")  # SQLite itself does not wait
    done = threading.Timer(0.5, other.execute, ["COMMIT"])
    done.start()
    with Store(file_url(file)) as store:
        assert store.jobs() == []
        with store.engine.connect() as connection:
            assert connection.exec_driver_sql("PRAGMA journal_mode").scalar() == "wal"
    done.join()
    other.close()


def test_what_is_no_database_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "jobs.sqlite"
    file.write_text("no database at all, but text that is long enough to be looked at " * 20, encoding="utf-8")
    monkeypatch.setattr(module.time, "sleep", lambda seconds: pytest.fail("it waited"))
    with pytest.raises(InputError, match="--database"):
        Store(file_url(file))


@pytest.mark.slow
def test_two_processes_may_open_a_new_database_at_once(new_database: str) -> None:
    program = f"from synth.batches.store import Store; Store({new_database!r}).close()"
    both = [subprocess.Popen([sys.executable, "-c", program]) for _ in range(2)]
    assert [process.wait(timeout=PATIENCE) for process in both] == [0, 0]


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("nonsense", "sqlite:///jobs.sqlite"),
        ("mysql://a/b", "sqlite:///jobs.sqlite"),
        ("sqlite://", "name of a file"),
        ("postgresql://somebody:secret@127.0.0.1:1/none", "can be opened"),
    ],
)
def test_addresses_that_are_none_are_refused_without_their_password(url: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        Store(url)
    assert "secret" not in str(refused.value)


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "jobs.sqlite"
    file.write_text("something else, and long enough to be read as a header of a file of SQLite\n" * 30)
    with pytest.raises(InputError, match="is whole"):
        Store(f"sqlite:///{file}")
    with pytest.raises(InputError, match="that exists"):
        Store(f"sqlite:///{tmp_path / 'none.sqlite'}", create=False)
