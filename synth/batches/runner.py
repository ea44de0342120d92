"""Works off a job: claims units, has them solved, writes what comes out, and can be stopped or killed at any moment."""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from typing import Any, TypeVar

from sqlalchemy.exc import OperationalError

from synth.batches.entries import BatchProgress
from synth.batches.executors import Cluster, Inline, Processes, is_foreign, is_lost
from synth.batches.settings import BATCHES, RunnerSettings
from synth.batches.signs import show
from synth.batches.solve import OtherCodeError, is_group, solve_unit
from synth.batches.store import NONE_UNGROUPED, Account, Outcome, Store
from synth.batches.unit_results import sorted_out
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.question.arguments import UserTables
from synth.question.settings import ProgressState
from synth.queue.job_queue import Claim
from synth.queue.job_table import CANCELLED
from synth.queue.owners import new_owner
from synth.results.provenance import computing_digest
from synth.system.deadline import until

T = TypeVar("T")


@dataclass(frozen=True)
class Shares:
    """What all units of a job are solved with."""

    settings: Mapping[str, Any]
    catalogs: UserTables
    user_family: type[DesignProblem] | None


class Runner:
    """One process at work on a job; any number of them may be, on any machines.

    Parameters
    ----------
    store : Store
    job : str
    shares : Shares
    executor : Executor
        With ``slots``.
    progress : callable, optional
        Called with a mapping: rows, done, failed, infeasible, rate (rows per second), left (seconds; None = unknown),
        found (rows of groups under way that have designs by now).
    settings : RunnerSettings, optional
    """

    def __init__(
        self,
        store: Store,
        job: str,
        shares: Shares,
        executor: Inline | Processes | Cluster,
        progress: BatchProgress | None = None,
        settings: RunnerSettings = BATCHES.runner,
    ) -> None:
        self.settings = settings
        self.store, self.job, self.shares, self.executor, self.progress = store, job, shares, executor, progress
        self.owner = new_owner()
        self.started = time.monotonic()
        self.first: Account | None = None
        self.last_report = 0.0
        self.pause = settings.pause
        self.cancelled = threading.Event()
        self.over = threading.Event()
        self.waiting: deque[Claim] = deque()
        self.under_way: dict[Future[Any], Claim] = {}
        self.with_designs = 0

    def run(self) -> str:
        """Work until nothing is left.

        Returns
        -------
        str
            Empty when the job is done, otherwise why it was stopped; then everything that was found is kept.
        """
        heart = threading.Thread(target=self._beat, name="heartbeat", daemon=True)
        heart.start()
        try:
            self.store.release_dead(self.job)
            return self._work()
        except KeyboardInterrupt:
            if self.cancelled.is_set():
                return "cancelled"
            self.store.add_event(self.job, "interrupted", self.owner)
            return "interrupted"
        finally:
            self.over.set()
            executor: Executor = self.executor
            executor.shutdown(wait=False, cancel_futures=True)
            self.store.release(self.owner)
            heart.join(timeout=self.settings.tick)

    def _work(self) -> str:
        while True:
            self._report_progress()
            if self.cancelled.is_set():
                return "cancelled"
            if isinstance(self.executor, Cluster) and not self.executor.alive():
                # The futures of a scheduler that is gone never end.
                self.waiting.extend(self.under_way.values())
                self.under_way.clear()
                if not self.executor.reconnect(self.cancelled.is_set):
                    return "the scheduler did not come back"
            self._fill()
            if self.under_way:
                done, _ = wait(self.under_way, timeout=self.settings.tick, return_when=FIRST_COMPLETED)
                for future in done:
                    self._take(future, self.under_way.pop(future))
            elif not self.waiting and not self._others_work():
                self._report_progress(always=True)
                return ""

    def _fill(self) -> None:
        """Keep all slots busy."""
        free = self.executor.slots - len(self.under_way)
        missing = free - len(self.waiting)
        if missing > 0:
            # Some more than there are slots for: asking the database costs more than what it gives.
            ahead = missing + self.executor.slots
            self.waiting.extend(self._patiently(lambda: self.store.claim(self.job, self.owner, ahead)))
        while free > 0 and self.waiting:
            claim = self.waiting.popleft()
            work = {
                "job": self.job,
                "questions": claim.questions,
                "settings": dict(self.shares.settings),
                "catalogs": self.shares.catalogs,
                "own": self.shares.user_family,
                "code": computing_digest(),
                "tell": self._hear if isinstance(self.executor, Inline) else show,
            }
            with until(math.inf, self.cancelled.is_set):  # for what this process solves itself
                future = self.executor.submit(solve_unit, work)
            self.under_way[future] = claim
            free -= 1

    def _take(self, future: Future[Any], claim: Claim) -> None:
        """Write what came out of a unit; what was lost with its executor waits for another one."""
        if is_lost(future):
            self.waiting.append(claim)
            return
        error = future.exception()
        if isinstance(error, OtherCodeError) or (isinstance(self.executor, Cluster) and error and is_foreign(error)):
            right = "the same clutchsynth, kernels and kind of processor on all machines, that of the scheduler too"
            raise InputError("--scheduler", "workers with other code", right)
        if error is not None:
            self._failed(claim, f"{type(error).__name__}: {error}")
            return
        self._finish(claim, *sorted_out(future.result()))

    def _failed(self, claim: Claim, error: str) -> None:
        """Write that a unit has failed as a whole: a group is tried once more, then, as all others, row by row."""
        if is_group(claim.questions) and claim.attempts + 2 < self.settings.attempts:
            self._patiently(lambda: self.store.put_back(self.job, claim, self.owner, error))
        else:
            self._finish(claim, {}, dict.fromkeys(claim.questions, error))

    def _finish(
        self,
        claim: Claim,
        outcomes: Mapping[str, Outcome],
        errors: Mapping[str, str],
        ungrouped: Mapping[str, str] = NONE_UNGROUPED,
    ) -> None:
        most = self.settings.attempts
        self._patiently(lambda: self.store.finish(self.job, claim, self.owner, outcomes, errors, most, ungrouped))

    def _others_work(self) -> bool:
        """True if units are left that other processes have; wait a little for them."""
        open_units = sum(self._patiently(lambda: self.store.open_units(self.job)))
        if open_units:
            self.store.release_dead(self.job)
            self.cancelled.wait(self.settings.tick)
        return open_units > 0

    def _patiently(self, call: Callable[[], T]) -> T:
        """Call the database, again and again while it does not answer, for some time."""
        deadline = time.monotonic() + self.settings.outage
        while True:
            try:
                return call()
            except OperationalError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(self.settings.tick)

    # -- signs of life -------------------------------------------------------------------------

    def _beat(self) -> None:
        """Renew the leases, and see whether the job is still wanted; a thread of its own."""
        renewed = time.monotonic()
        while not self.over.wait(self.settings.tick):
            try:
                job = self.store.job(self.job)
                if job is None or job.state == CANCELLED:
                    self.cancelled.set()
                if time.monotonic() - renewed > self.store.settings.lease / 4:
                    self.store.renew(self.owner)
                    renewed = time.monotonic()
            except (OperationalError, OSError, InputError):
                continue  # the database may be back at the next beat, long before a lease ends

    def _hear(self, state: ProgressState) -> None:
        """Take note of how far the group is that this process searches."""
        self.with_designs = int(state["incumbents"])
        try:
            self._report_progress()
        except (OperationalError, OSError, InputError):
            return  # no matter of the search: whatever comes of it is written patiently

    def _report_progress(self, always: bool = False) -> None:
        """Report how far the job is, now and then."""
        if self.progress is None or (not always and time.monotonic() - self.last_report < self.pause):
            return
        begin = time.monotonic()
        account = self.store.account(self.job)
        self.last_report = time.monotonic()
        self.pause = max(
            self.settings.pause, (self.last_report - begin) / self.settings.report_share
        )  # counting must not cost what it counts
        if self.first is None:
            self.first = account
        elapsed, fresh = self.last_report - self.started, account.done - self.first.done
        rate = fresh / elapsed if elapsed > 0 else 0.0
        self.progress(
            {
                "rows": account.rows,
                "done": account.done,
                "failed": account.status.get("failed", 0),
                "infeasible": account.status.get("infeasible", 0),
                "bad": account.bad,
                "rate": rate,
                "found": self.executor.with_designs() if isinstance(self.executor, Processes) else self.with_designs,
                "left": (account.rows - account.done) / rate if rate > 0 else None,
            }
        )
