"""Workers: what they do with jobs of every kind, and that nothing is lost however they end."""

from __future__ import annotations

import gzip
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import psutil
import pytest
import sqlalchemy as sa
import yaml

from synth.batches.batch import batch
from synth.batches.store import Store
from synth.queue.database import file_url
from synth.queue.job_table import CANCELLED, DONE, FAILED, JOB_TASK, LOCAL, OPEN, PLAN, RUNNING, STOPPED, NewJob
from synth.queue.models import Job, JobRecord, WorkUnit
from synth.queue.records import NOTHING
from synth.queue.tenant_files import TenantFiles
from synth.system.operating_system import processor_time
from synth.workers import engine_process
from synth.workers.engine_process import (
    EngineCrashedError,
    EngineFailedError,
    EngineProcess,
    Engines,
    EngineTimeoutError,
    _Budget,
)
from synth.workers.engine_tasks import BATCH_FILE_TASK, EXAMPLES_TASK, FILES_TASK, READ_TASK
from synth.workers.settings import INTERACTIVE, WORK, EngineSettings, WorkSettings
from synth.workers.worker import Worker
from tests.queue.test_migrations import hoists
from tests.waiting import PATIENCE, until

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
HOIST: dict[str, Any] = yaml.safe_load((ROOT / "examples" / "hoist_multi_plate.yaml").read_text(encoding="utf-8"))
ONE_NUMBER: dict[str, Any] = {"objectives": ["mass"], "points": 1, "fix": HOIST["fix"]}
QUICK = {**HOIST, "objectives": ["mass"], "points": 1}
LONG = {**HOIST, "objectives": ["mass", "length", "friction_work"], "points": 200}


@pytest.fixture(scope="module")
def engines() -> Iterator[Engines]:
    found = Engines(1)
    yield found
    found.close()


def submit(store: Store, engines: Engines, kind: str, request: dict[str, Any], **more: Any) -> str:
    sources = TenantFiles(store).sources(LOCAL, request)
    read = engines.call(READ_TASK, {"kind": kind, "request": request, "sources": sources}, PATIENCE)
    new = NewJob(
        kind=kind,
        title=read["title"],
        request=read["request"],
        fingerprint=read["fingerprint"],
        code=read["code"],
        kept=read["kept"],
        task=PLAN if kind == "batch" else JOB_TASK,
        priority=0 if read["bulk"] else 1,
    )
    return store.submit(replace(new, **more))[0]


@contextmanager
def serving(store: Store, slots: int = 1, settings: WorkSettings = WORK, **more: Any) -> Iterator[Worker]:
    worker = Worker(store, slots, settings=settings, spare=False, **more)
    thread = threading.Thread(target=worker.run)
    thread.start()
    try:
        yield worker
    finally:
        worker.stop()
        thread.join()


def ended(store: Store, job: str) -> Job:
    return until(lambda: store.job(job), lambda found: found is not None and found.state not in (OPEN, RUNNING))


def test_jobs_of_several_kinds_are_done(database: str, engines: Engines, tmp_path: Path) -> None:
    rows = hoists("400 N*m", "500 N*m", "many")
    with Store(database) as store, serving(store, 2):
        front = submit(store, engines, "synthesis", QUICK)
        table = submit(store, engines, "batch", {"family": "multi_plate_clutch", "rows": rows, **ONE_NUMBER})
        found = ended(store, front)
        assert (found.state, found.outcome, found.summary["designs"]) == (DONE, "optimal", 1)
        assert {"front.json", "question.json"} <= set(store.records(front))
        priced = submit(store, engines, "verify", {"of": front})
        assert ended(store, priced).state == DONE
        found = ended(store, table)
        assert (found.state, found.summary["status"]) == (DONE, {"bad_input": 1, "optimal": 2})
        files = {
            name: engines.call(
                BATCH_FILE_TASK, {"job": table, "name": name, "sources": TenantFiles(store).sources(LOCAL, {})}, 60.0
            )
            for name in ("designs.csv", "rows.csv")
        }
        few = ended(store, submit(store, engines, "size_range", {"of": table}))
        assert (few.state, few.summary["variants"]) == (DONE, few.summary["fewest"])
    alone = batch("multi_plate_clutch", rows, tmp_path / "out", **ONE_NUMBER)
    assert files["designs.csv"].content == (alone.folder / "designs.csv").read_bytes()


def test_a_refusal_that_only_the_work_sees_is_told_with_its_place(tmp_path: Path, engines: Engines) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store:
        name = submit(store, engines, "batch", {"family": "multi_plate_clutch", "rows": [HOIST["requirements"]]})
        rows = [{**HOIST["requirements"], "load_torque": "much"}]
        with store.engine.begin() as connection:  # of long tables the first rows alone are checked before
            packed = gzip.compress(json.dumps(rows).encode())
            connection.execute(sa.update(JobRecord).where(JobRecord.job == name).values(content=packed))
        with serving(store):
            job = ended(store, name)
        assert job.state == FAILED
        assert job.error["code"] == "bad_input"
        (problem,) = job.error["problems"]
        assert problem["path"] == ["rows", 2, "load_torque"]
        assert "much" in problem["message"]


def test_a_search_that_runs_is_cancelled_and_the_slot_goes_on(database: str, engines: Engines) -> None:
    with Store(database) as store, serving(store) as worker:
        job = submit(store, engines, "synthesis", LONG)
        until(lambda: worker.tasks, bool)
        until(lambda: store.job(job), lambda found: bool(found.progress))
        store.cancel(job)
        until(lambda: worker.tasks, lambda tasks: not tasks)
        assert worker.restarts == {"cancelled": 1}
        assert ended(store, submit(store, engines, "synthesis", QUICK)).state == DONE
        found = store.job(job)
        assert found is not None
        assert found.state == CANCELLED
        assert store.records(job) == {}


def test_a_process_that_dies_is_replaced_and_its_job_done(tmp_path: Path, engines: Engines) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store) as worker:
        job = submit(store, engines, "synthesis", {**HOIST, "points": 3})
        task = until(lambda: worker.tasks.get(0), bool)
        os.kill(task.engine.pid, signal.SIGKILL)
        assert ended(store, job).state == DONE
        assert worker.restarts == {"crash": 1}
        failed = [event.text for event in store.happenings(0, job=job) if event.kind == "failed"]
        assert failed == ["attempt 1: the process was ended by SIGKILL"]


def test_a_job_that_kills_every_process_fails_at_last(tmp_path: Path, engines: Engines) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store) as worker:
        job = submit(store, engines, "synthesis", LONG)
        for _ in range(WORK.worker.attempts):
            task = until(lambda: worker.tasks.get(0), lambda task: task and task.engine.is_alive())
            os.kill(task.engine.pid, signal.SIGKILL)
            until(lambda: worker.tasks.get(0), lambda now, task=task: now is not task)
        found = ended(store, job)
        assert (found.state, found.error["code"]) == (FAILED, "failed")
        assert "SIGKILL" in found.error["message"]


def test_a_unit_that_another_has_by_now_is_counted_as_lost(tmp_path: Path, engines: Engines) -> None:
    told: list[str] = []
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store) as worker:
        worker.say = told.append
        kept, cancelled = (submit(store, engines, "synthesis", {**LONG, "time_limit": 2.0}) for _ in range(2))
        until(lambda: worker.tasks.get(0), lambda task: task and task.job.id == kept)
        with store.engine.begin() as connection:
            connection.execute(sa.update(WorkUnit).where(WorkUnit.job == kept).values(token=WorkUnit.token + 1))
        until(lambda: worker.lost, bool)
        assert any(kept in sentence and "lost" in sentence for sentence in told)
        assert store.job(kept).state == RUNNING  # whoever has it goes on
        until(lambda: worker.tasks.get(0), lambda task: task and task.job.id == cancelled)
        with store.engine.begin() as connection:
            connection.execute(sa.update(WorkUnit).where(WorkUnit.job == cancelled).values(token=WorkUnit.token + 1))
        store.cancel(cancelled)
        until(lambda: worker.tasks, lambda tasks: not tasks)
        assert worker.lost == 1  # nobody wanted it any more
        until(lambda: store.workers(60.0), lambda signs: signs and signs[0].slots["lost"] == 1)


def test_limits_of_time_and_memory_stop_a_job(tmp_path: Path, engines: Engines) -> None:
    impatient = replace(WORK, worker=replace(WORK.worker, grace=0.2))
    with Store(file_url(tmp_path / "jobs.sqlite")) as store:
        with serving(store, settings=impatient):
            job = ended(store, submit(store, engines, "synthesis", LONG, seconds_limit=0.5))
            assert (job.state, job.error["code"]) == (STOPPED, "time_limit")
        small = replace(WORK, engine=replace(WORK.engine, memory=90_000_000), worker=replace(WORK.worker, weigh=0.1))
        with serving(store, settings=small):
            job = ended(store, submit(store, engines, "synthesis", LONG))
            assert (job.state, job.error["code"]) == (STOPPED, "memory_limit")


def test_a_search_that_stops_by_itself_keeps_what_it_has_found(tmp_path: Path, engines: Engines) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store):
        limit, found = 1.0, 0
        while not found:  # on a busy machine a search finds something later
            job = ended(store, submit(store, engines, "synthesis", {**LONG, "time_limit": limit}))
            assert job.state == STOPPED
            assert job.error is None
            found = job.summary["designs"]
            limit *= 4
            assert limit < PATIENCE
        assert "front.json" in store.records(job.id)


def test_bulk_work_makes_room_and_is_done_afterwards(tmp_path: Path, engines: Engines) -> None:
    quick = replace(WORK, worker=replace(WORK.worker, patience=0.0))
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store, settings=quick) as worker:
        slow = submit(store, engines, "synthesis", LONG, priority=0)
        until(lambda: worker.tasks.get(0), bool)
        waiting = submit(store, engines, "synthesis", QUICK)
        assert ended(store, waiting).state == DONE
        assert worker.restarts["preempted"] == 1
        found = until(lambda: store.job(slow), lambda job: worker.tasks.get(0) is not None)
        assert found.state == RUNNING
        store.cancel(slow)


def test_a_worker_that_is_stopped_gives_back_what_it_has(tmp_path: Path, engines: Engines) -> None:
    with Store(file_url(tmp_path / "jobs.sqlite")) as store:
        with serving(store) as worker:
            job = submit(store, engines, "synthesis", LONG)
            until(lambda: worker.tasks.get(0), bool)
        assert store.open_units(job) == (1, 0)
        assert store.workers(60.0) == []


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_the_command_is_ended_and_another_one_goes_on(tmp_path: Path, engines: Engines, number: signal.Signals) -> None:
    url = file_url(tmp_path / "jobs.sqlite").render_as_string()
    words = [sys.executable, "-c", "from synth.terminal.cli import main; main()", "worker", "--database", url]
    with Store(url) as store:
        job = submit(store, engines, "synthesis", {**LONG, "points": 5})
        first = subprocess.Popen([*words, "--slots", "1"], stderr=subprocess.PIPE, text=True)
        until(lambda: store.open_units(job), lambda units: units == (0, 1))
        first.send_signal(number)
        _, said = first.communicate(timeout=PATIENCE)
        assert first.returncode == (0 if number == signal.SIGTERM else -number)
        assert "working at the jobs of" in said
        second = subprocess.Popen([*words, "--slots", "1", "--follow"], stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            assert ended(store, job).state == DONE
        finally:
            second.communicate(timeout=PATIENCE)  # it ends with its standard input
        assert second.returncode == 0


def test_answers_do_not_depend_on_how_often_they_were_interrupted(tmp_path: Path, engines: Engines) -> None:
    asked = {**HOIST, "points": 8}
    with Store(file_url(tmp_path / "jobs.sqlite")) as store, serving(store) as worker:
        whole = submit(store, engines, "synthesis", asked)
        assert ended(store, whole).state == DONE
        broken = submit(store, engines, "synthesis", asked)
        for _ in range(2):
            task = until(lambda: worker.tasks.get(0), bool)
            time.sleep(0.2)
            os.kill(task.engine.pid, signal.SIGKILL)
            until(lambda: worker.tasks.get(0), lambda now, task=task: now is not task)
        assert ended(store, broken).state == DONE
        first, second = (_without_times(store, job) for job in (whole, broken))
        assert first == second


def _without_times(store: Store, job: str) -> Any:
    content = json.loads(store.records(job, ["front.json"])["front.json"].content)
    return content["designs"], content["certificate"]["kind"]


def test_a_warm_process_answers_and_a_late_one_is_replaced() -> None:
    engines = Engines(1, EngineSettings(nice=0))
    try:
        request = {"kind": "synthesis", "request": QUICK, "sources": NOTHING}
        assert engines.call(READ_TASK, request, 60.0)["title"].startswith("Multi-plate clutch")
        with pytest.raises(EngineTimeoutError):
            engines.call("work", {**request, "request": LONG}, 0.3)
        assert engines.call(READ_TASK, request, 60.0)["bulk"] is False
    finally:
        engines.close()


def test_processes_that_nobody_needs_are_not_started() -> None:
    lazy = Engines(3, at_once=0)
    try:
        assert not len(lazy.pool)
        for _ in range(2):
            lazy.call(EXAMPLES_TASK, {}, 60.0)
        assert len(lazy.pool) == 2  # the first was free again, and one is ready beside it
    finally:
        lazy.close()


class Looks:
    """Counts how often it was looked at the time that a process has had, and lets it go on after some looks."""

    def __init__(self, most: int) -> None:
        self.most, self.count = most, 0

    def __call__(self, process: int) -> float:
        self.count += 1
        if self.count == self.most:
            os.kill(process, signal.SIGCONT)
        return processor_time(process)


def test_a_process_that_waits_for_its_turn_is_not_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    """What counts is the time that it has had on a processor: none, however long the machine was busy."""
    engine = EngineProcess(EngineSettings(poll=0.02, stuck=1e6))
    try:
        assert engine.warm(60.0)
        engine.call(FILES_TASK, {"kind": "batch"}, 60.0)
        looks = Looks(50)  # a second, of a limit of half of one
        monkeypatch.setattr(engine_process, "processor_time", looks)
        os.kill(engine.pid, signal.SIGSTOP)
        assert "rows.csv" in engine.call(FILES_TASK, {"kind": "batch"}, 0.5)
        assert looks.count >= looks.most
    finally:
        engine.end()


def test_a_process_that_is_stuck_is_ended() -> None:
    engine = EngineProcess(EngineSettings(poll=0.02, stuck=1.0))
    assert engine.warm(60.0)
    os.kill(engine.pid, signal.SIGSTOP)
    with pytest.raises(EngineTimeoutError):
        engine.call(FILES_TASK, {"kind": "batch"}, 0.2)
    assert not engine.is_alive()


def test_a_process_that_a_busy_machine_gives_little_is_not_stuck() -> None:
    settings = EngineSettings(stuck=1e-3, stirs=1e-4)
    engine = cast("EngineProcess", SimpleNamespace(pid=os.getpid(), settings=settings))
    budget = _Budget(engine, 100.0)
    began = time.process_time()
    for _ in range(3):
        time.sleep(0.15)  # beyond the time that one has that gets nothing
        before = time.process_time()
        while time.process_time() < before + 0.03:
            pass
        assert not budget.is_spent()
    until(budget.is_spent, bool)
    assert time.process_time() < began + 50.0


def test_what_somebody_waits_for_is_not_nicer_than_a_search() -> None:
    kept = psutil.Process().nice()
    engine = EngineProcess(INTERACTIVE)
    try:
        assert engine.warm(60.0)
        assert psutil.Process(engine.pid).nice() == kept
        assert WORK.engine.nice > INTERACTIVE.nice == 0
    finally:
        engine.end()


def test_a_process_goes_with_the_one_that_has_started_it(tmp_path: Path) -> None:
    program = (
        "import os, sys, time\n"
        "from synth.workers.engine_process import EngineProcess\n"
        "if __name__ == '__main__':\n"
        "    engine = EngineProcess()\n"
        "    print(engine.pid, flush=True)\n"
        "    time.sleep(60)\n"
    )
    file = tmp_path / "program.py"
    file.write_text(program)
    process = subprocess.Popen([sys.executable, str(file)], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout is not None
    engine = int(process.stdout.readline())
    process.kill()
    process.communicate()
    until(lambda: Path(f"/proc/{engine}").exists(), lambda there: not there)


def test_an_error_of_a_program_is_told_with_its_place_and_the_process_goes_on(engines: Engines) -> None:
    before = {engine.pid for engine in engines.pool._all}
    with pytest.raises(EngineFailedError) as caught:
        engines.call(READ_TASK, {}, 60.0)
    failure = caught.value.failure
    assert failure.kind == "KeyError"
    assert "engine_work.py" in failure.where[0]
    assert {engine.pid for engine in engines.pool._all} == before


def test_a_job_that_no_program_can_do_fails_without_telling_the_program(tmp_path: Path, engines: Engines) -> None:
    said: list[str] = []
    with Store(file_url(tmp_path / "jobs.sqlite")) as store:
        job = submit(store, engines, "synthesis", QUICK)
        with store.engine.begin() as connection:
            connection.execute(sa.update(Job).where(Job.id == job).values(kind="size_range"))
        with serving(store, say=said.append):
            found = ended(store, job)
    assert found.state == FAILED
    assert "KeyError" not in json.dumps(found.error)
    assert any("KeyError" in line and "size_range.py" in line for line in said)


def test_a_process_that_was_ended_says_how() -> None:
    engine = EngineProcess()
    assert engine.warm(60.0)
    os.kill(engine.pid, signal.SIGKILL)
    with pytest.raises(EngineCrashedError, match="SIGKILL"):
        engine.call(READ_TASK, {}, 10.0)
    engine.end()
