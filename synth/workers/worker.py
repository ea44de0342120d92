"""A worker: takes work of any job from the queue, has it done by engine processes, and writes what comes out.

It computes nothing itself. Each slot has an engine process, and one more is kept warm: so a process may be ended at
once, because its job was cancelled, takes too long or too much memory, or makes room for somebody who waits, and the
slot goes on with the spare. Whatever happens to a worker, its units are taken by others when their lease ends.
"""

from __future__ import annotations

import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from sqlalchemy.exc import DBAPIError

from synth.batches.solve import is_group
from synth.batches.store import Store
from synth.batches.unit_results import sorted_out
from synth.errors import InputError
from synth.queue.job_queue import Claim
from synth.queue.job_table import FAILED, PLAN, ROWS, STOPPED, Ending
from synth.queue.models import Job
from synth.queue.owners import new_owner
from synth.queue.records import TABLE, Record
from synth.queue.tenant_files import TenantFiles
from synth.system.operating_system import resident
from synth.text.numbers import typed_number
from synth.workers.engine_process import (
    ANSWERED,
    PROGRESS,
    REFUSED,
    EngineCrashedError,
    EnginePool,
    EngineProcess,
    Failure,
    Message,
)
from synth.workers.engine_tasks import PLAN_TASK, ROWS_TASK, WORK_TASK
from synth.workers.settings import WORK, WorkSettings

T = TypeVar("T")
BROKEN = "something went wrong in the program that computes; what the worker has said tells where"
CANCEL, TIME, MEMORY, PREEMPTED, SHUTDOWN, CRASH, AGE = (
    "cancelled",
    "time",
    "memory",
    "preempted",
    "shutdown",
    "crash",
    "age",
)


@dataclass
class UnitAtWork:
    """A unit that a slot works at."""

    job: Job
    claim: Claim
    engine: EngineProcess
    begun: float = field(default_factory=time.monotonic)
    abort: str = ""  # why the process is to be ended

    @property
    def bulk(self) -> bool:
        """Whether it makes room for somebody who waits."""
        return self.job.priority == 0


class Worker:
    """Serves the queue of a database until it is stopped.

    Parameters
    ----------
    store : Store
    slots : int
        Units that are worked at side by side: not more than there are processors.
    spare : bool
        Whether a process more is kept warm.
    settings : WorkSettings, optional
    say : callable, optional
        Told in a sentence what happens to processes and to the database.
    """

    def __init__(
        self,
        store: Store,
        slots: int,
        *,
        spare: bool = True,
        settings: WorkSettings = WORK,
        say: Callable[[str], None] = lambda sentence: None,
    ) -> None:
        self.store, self.settings, self.say = store, settings, say
        self.tenant_files = TenantFiles(store)
        self.owner = new_owner()
        self.slots = slots
        self.spares = EnginePool(slots + spare, settings.engine)
        self.stopping = threading.Event()
        self.tasks: dict[int, UnitAtWork] = {}  # by slot; a slot alone changes its own
        self.restarts: Counter[str] = Counter()
        self.lost = 0  # units that could not be written, as others had them by then
        self.code = ""
        self._threads = [threading.Thread(target=self._slot, args=(k,), name=f"slot {k}") for k in range(slots)]
        self._waiting_since: float | None = None

    def run(self) -> None:
        """Serve the queue; returns when it was told to stop, and everything is given back."""
        self._patiently(self.store.release_dead)
        for thread in self._threads:
            thread.start()
        try:
            self._watch()
        finally:
            self.stop()
            for thread in self._threads:
                thread.join()
            self.spares.close()
            self._quietly(lambda: self.store.release(self.owner))  # else the leases end by themselves
            self._quietly(lambda: self.store.sign_off(self.owner))

    def stop(self) -> None:
        """Let everything go, at once; may be called from a signal handler."""
        self.stopping.set()

    # -- a slot --------------------------------------------------------------------------------

    def _slot(self, number: int) -> None:
        """Take one unit after the other."""
        engine: EngineProcess | None = None
        while not self.stopping.is_set():
            if engine is None:
                engine = self._warm()
                continue
            self.code = engine.code
            try:
                claimed = self.store.claim_next(self.owner, engine.code, lease=self.settings.worker.lease)
            except (DBAPIError, OSError):
                self.stopping.wait(self.settings.worker.weigh)
                continue
            if claimed is None:
                self.stopping.wait(self.settings.worker.poll)
                continue
            task = self.tasks[number] = UnitAtWork(*claimed, engine)
            try:
                usable = self._do(task)
            except Exception as error:  # the unit is taken again when its lease ends; the slot must go on
                self.say(f"job {task.job.id}: {type(error).__name__}: {error}")
                usable = False
            finally:
                del self.tasks[number]
            if not usable or engine.is_worn():
                if usable:
                    self.restarts[AGE] += 1
                self.spares.drop(engine)
                self.spares.add()
                engine = None

    def _warm(self) -> EngineProcess | None:
        """Return a process that is warm; None where there is none in time, or all is over."""
        engine = self.spares.take(self.settings.worker.poll)
        if engine is None:
            return None
        try:
            if engine.warm(self.settings.engine.start):
                return engine
        except EngineCrashedError:
            pass
        self.spares.drop(engine)
        if not self.spares.closed:
            time.sleep(self.settings.worker.weigh)  # what ends at once, always, must not keep the machine busy
            self.spares.add()
        return None

    def _do(self, task: UnitAtWork) -> bool:
        """Have a unit done and write what comes out; return whether the process can be used again."""
        try:
            name, payload = self._payload(task)
            task.engine.ask(name, payload)
            message = self._hear(task)
        except EngineCrashedError as crash:
            self._crashed(task, str(crash))
            return False
        if message is None:
            self._aborted(task)
            return False
        self._write(task, message)
        return True

    def _payload(self, task: UnitAtWork) -> tuple[str, dict[str, Any]]:
        """Return the name of a task, and what it is asked."""
        job = task.job
        payload: dict[str, Any] = {"job": job.id, "kind": job.kind, "request": job.request}
        payload["sources"] = self.tenant_files.sources(job.tenant, job.request)
        if task.claim.task == ROWS:
            return ROWS_TASK, {
                **payload,
                "questions": task.claim.questions,
                "settings": job.content["settings"],
                "catalogs": job.content["catalogs"],
                "own": None,
            }
        if task.claim.task == PLAN:
            return PLAN_TASK, {**payload, "claim": task.claim, "owner": self.owner, "table": self._table(job)}
        return WORK_TASK, payload

    def _table(self, job: Job) -> Record:
        """Return the table of a batch, which is kept with it."""
        kept = self.store.records(job.id)
        return next(record for name, record in kept.items() if name.startswith(TABLE))

    def _hear(self, task: UnitAtWork) -> Message | None:
        """Wait for the end of a task; None where it was ended for a reason of ours."""
        while not task.abort:
            if self.stopping.is_set():
                task.abort = SHUTDOWN
                break
            message = task.engine.hear(self.settings.worker.watch / 2)
            if message is None:
                continue
            if message.kind != PROGRESS:
                return message
            if task.claim.task != ROWS:  # the process itself tells no more often than anybody can read
                self._report_progress(task.job, message.content)
        return None

    def _report_progress(self, job: Job, state: Mapping[str, object]) -> None:
        self._quietly(lambda: self.store.progress(job.id, state))

    # -- what came out -------------------------------------------------------------------------

    def _write(self, task: UnitAtWork, message: Message) -> None:
        job, claim = task.job, task.claim
        if claim.task == ROWS:
            if message.kind == ANSWERED:
                outcomes, errors, single = sorted_out(message.content)
                most = self.settings.runner.attempts
                self._written(job, lambda: self.store.finish(job.id, claim, self.owner, outcomes, errors, most, single))
                self._after_rows(job)
            else:
                self._broken(task, message.content)
        elif message.kind == REFUSED:
            refusal: InputError = message.content
            error = {
                "code": "bad_input",
                "message": str(refusal),
                "problems": [fault.told() for fault in refusal.every()],
            }
            self._end(task, Ending(state=FAILED, error=error))
        elif message.kind != ANSWERED:
            self._broken(task, message.content)
        elif claim.task == PLAN:
            self._after_rows(job)  # the engine has written the rows itself: they are many
        else:
            facts = message.content["summary"]
            state = STOPPED if facts.get("interrupted") else "done"
            self._end(
                task,
                Ending(state=state, outcome=facts.get("outcome"), summary=facts, records=message.content["records"]),
            )

    def _after_rows(self, job: Job) -> None:
        """Note how far a batch is, and end it where nothing is left."""
        if not self._patiently(lambda: self.store.settle(job.id)):
            self._quietly(lambda: self.store.count_rows(job.id, self.settings.worker.kept))

    def _end(self, task: UnitAtWork, ending: Ending) -> None:
        self._written(task.job, lambda: self.store.complete(task.job.id, task.claim, self.owner, ending))

    def _written(self, job: Job, write: Callable[[], bool]) -> None:
        """Write what came of a unit; count it where the lease had ended before, and others have the unit now."""
        if self._patiently(write) is not False:
            return
        live = self._patiently(lambda: self.store.unfinished([job.id]))
        if live:
            self.lost += 1
            self.say(f"job {job.id}: a unit was lost to another worker: the database did not hear in time of this one")

    def _broken(self, task: UnitAtWork, failure: Failure) -> None:
        """Note an error of a program: where it was raised is for whoever runs it, not for whoever has asked."""
        self.say(f"job {task.job.id}: {failure.message}; raised at {' < '.join(failure.where)}")
        self._failed(task, failure.message if task.claim.task == ROWS else BROKEN)

    def _failed(self, task: UnitAtWork, error: str) -> None:
        """Note that an attempt failed; after the last one the job has, or these rows have."""
        job, claim, owner = task.job, task.claim, self.owner
        last = claim.attempts + 1 >= self.settings.worker.attempts
        self.say(f"job {job.id}: {error}")
        if claim.task != ROWS:
            if last:
                self._end(task, Ending(state=FAILED, error={"code": "failed", "message": error}))
            else:
                self._written(job, lambda: self.store.put_back(job.id, claim, owner, error))
        elif is_group(claim.questions) and claim.attempts + 2 < self.settings.runner.attempts:
            self._written(job, lambda: self.store.put_back(job.id, claim, owner, error))
        else:
            errors = dict.fromkeys(claim.questions, error)
            most = self.settings.runner.attempts
            self._written(job, lambda: self.store.finish(job.id, claim, owner, {}, errors, most))
            self._after_rows(job)

    def _crashed(self, task: UnitAtWork, reason: str) -> None:
        """Tell apart whether a process has ended because we wanted it, or by itself."""
        if task.abort or self.stopping.is_set():
            self._aborted(task)
        else:
            self.restarts[CRASH] += 1
            self._failed(task, reason)

    def _aborted(self, task: UnitAtWork) -> None:
        """End the process of a task, and say what becomes of the unit."""
        task.engine.end()
        reason = task.abort or SHUTDOWN
        self.restarts[reason] += 1
        if reason in (TIME, MEMORY):
            limit = (
                f"{typed_number(task.job.seconds_limit)} s"
                if reason == TIME
                else f"{self.settings.engine.memory >> 20} MiB"
            )
            error = {"code": f"{reason}_limit", "message": f"stopped: it needs more than {limit}"}
            if task.claim.task == ROWS:
                self._failed(task, str(error["message"]))
            else:
                self._end(task, Ending(state=STOPPED, error=error))
        else:  # nothing is wrong with it: whoever comes next takes it, if it is still wanted
            self._patiently(lambda: self.store.give_back(task.claim, self.owner))

    # -- watching ------------------------------------------------------------------------------

    def _watch(self) -> None:
        """See what has to be ended, give signs of life, and take over what others have left."""
        worker = self.settings.worker
        signed = weighed = tidied = -1e9
        while not self.stopping.wait(worker.watch):
            now = time.monotonic()
            try:
                self._end_unwanted()
                self._free_slot()
                if now - weighed >= worker.weigh:
                    weighed = now
                    self._weigh()
                if now - signed >= worker.sign:
                    # Only what is at work: a unit that could not be written is to be free again when its lease ends.
                    self.store.renew(self.owner, worker.lease, [t.claim.unit for t in list(self.tasks.values())])
                    self._sign()
                    signed = now
                if now - tidied >= worker.tidy and self.code:
                    tidied = now
                    self.store.release_dead()
                    self.store.adopt(self.code, worker.alive)
                    self.store.prune()
            except (DBAPIError, OSError) as error:
                reason = getattr(error, "strerror", None) or type(error).__name__  # few errors have one of the system
                self.say(f"the database does not answer ({reason}); waiting")
                self.stopping.wait(worker.weigh)

    def _end_unwanted(self) -> None:
        tasks = list(self.tasks.values())
        if not tasks:
            return
        live = self.store.unfinished({task.job.id for task in tasks})
        for task in tasks:
            limit = task.job.seconds_limit
            if task.job.id not in live:
                self._abort(task, CANCEL)
            elif (
                limit is not None
                and task.claim.task != ROWS
                and time.monotonic() - task.begun > limit + self.settings.worker.grace
            ):
                self._abort(task, TIME)

    @staticmethod
    def _abort(task: UnitAtWork, reason: str) -> None:
        if not task.abort:
            task.abort = reason

    def _weigh(self) -> None:
        for task in list(self.tasks.values()):
            if resident(task.engine.pid) > self.settings.engine.memory:
                self._abort(task, MEMORY)

    def _free_slot(self) -> None:
        """Let bulk work go where somebody waits and all slots are busy: of what was begun last, least is lost."""
        bulk = [task for task in list(self.tasks.values()) if task.bulk and not task.abort]
        if not bulk or len(self.tasks) < self.slots or not self.store.interactive_waits(self.code):
            self._waiting_since = None
            return
        now = time.monotonic()
        if self._waiting_since is None:
            self._waiting_since = now
        elif now - self._waiting_since >= self.settings.worker.patience:
            self._waiting_since = None
            self._abort(max(bulk, key=lambda task: task.begun), PREEMPTED)

    def _sign(self) -> None:
        slots = {
            "slots": self.slots,
            "busy": len(self.tasks),
            "jobs": sorted({task.job.id for task in list(self.tasks.values())}),
            "restarts": dict(self.restarts),
            "lost": self.lost,
        }
        self.store.sign(self.owner, socket.gethostname(), self.code, slots)

    # -- the database --------------------------------------------------------------------------

    def _patiently(self, call: Callable[[], T]) -> T | None:
        """Call the database, again and again while it does not answer; None where all is over before it does."""
        deadline = time.monotonic() + self.settings.runner.outage
        while True:
            try:
                return call()
            except (DBAPIError, OSError):
                if time.monotonic() > deadline or self.stopping.wait(self.settings.worker.weigh):
                    raise

    @staticmethod
    def _quietly(call: Callable[[], object]) -> None:
        """Call the database for something that the next call makes up for."""
        try:
            call()
        except (DBAPIError, OSError):
            return
