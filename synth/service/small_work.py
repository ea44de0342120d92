"""Questions that engine processes answer while somebody waits: shared fairly, and none is begun in vain.

A question that is late goes on after its asker was told to come again. What it fills, as the caches of a process that
has just begun, serves the next one; its answer waits for whoever asks the same again.
"""

from __future__ import annotations

import asyncio
import hashlib
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Protocol

from anyio import CapacityLimiter
from anyio.to_thread import run_sync

from synth.errors import InputError
from synth.queue.accounts import Principal
from synth.service.metrics import QuestionFigures
from synth.service.shares import Asker, FairShares, NoPlaceError
from synth.text.numbers import typed_number
from synth.workers.engine_process import EngineCrashedError, EngineTimeoutError

KEPT = 32  # late questions that are remembered, with their answers
KEPT_FOR = 60.0  # s, that an answer waits for whoever asks again


class EngineCalls(Protocol):
    """What the service needs of engine processes; see :class:`synth.workers.engine_process.Engines`."""

    def call(self, task: str, payload: object, limit: float) -> Any:
        """Have a task done within a time of a processor."""


class LateError(EngineTimeoutError):
    """The answer is not there yet; the work goes on, for whoever asks the same again."""


class BusyError(EngineTimeoutError):
    """No process became free in time."""


@dataclass(frozen=True, kw_only=True)
class Times:
    """How long is waited for what, in s.

    Parameters
    ----------
    queue : float
        For a process.
    deadline : float
        For an answer, from then on.
    limit : float
        Of a processor, that a question may take, whether somebody waits or not; then its process is replaced.
    """

    queue: float
    deadline: float
    limit: float


def asker_of(principal: Principal) -> Asker:
    """Whose share a request counts to; where no tokens are needed there is nobody else."""
    return Asker(principal.tenant, principal.token, alone=principal.token is None)


class SmallWork:
    """Questions to some engine processes. They have threads of their own to wait in.

    Parameters
    ----------
    engines : EngineCalls
    shares : FairShares
        Of the processes.
    times : Times
    figures : QuestionFigures
    """

    def __init__(self, engines: EngineCalls, shares: FairShares, times: Times, figures: QuestionFigures) -> None:
        self._engines, self._shares, self.times, self._figures = engines, shares, times, figures
        self._threads: CapacityLimiter | None = None  # belongs to a running loop
        self._under_way = set[asyncio.Task[Any]]()
        self._late: dict[str, asyncio.Task[Any]] = {}
        figures.watch(lambda: shares.waiting, lambda: shares.held, lambda: self.late)

    @property
    def late(self) -> int:
        """Questions under way whose askers were told to come again."""
        return sum(not work.done() for work in self._late.values())

    @property
    def is_stuck(self) -> bool:
        """Whether every process is late with a question."""
        return self.late >= self._shares.places

    async def ask(self, asker: Asker, task: str, payload: object) -> Any:
        """Answer of a task.

        Raises
        ------
        InputError
            As the task has raised it.
        LateError, BusyError, EngineTimeoutError, EngineCrashedError, EngineFailedError
            It is late, no process is free, it took more than it may, the process has ended, or its program has failed.
        """
        key = _digest(asker, task, payload) if self._late else ""
        work = self._late.get(key)
        if work is None:
            work = await self._begun(asker, task, payload)
        await asyncio.wait({work}, timeout=self.times.deadline)
        if work.done():
            self._late.pop(key, None)
            return work.result()
        self._figures.ended("late")
        self._keep(key or _digest(asker, task, payload), work)
        raise LateError(f"{task}: more than {typed_number(self.times.deadline)} s")

    def _keep(self, key: str, work: asyncio.Task[Any]) -> None:
        """Remember a late question until some time after its answer."""
        if key in self._late:
            return
        while len(self._late) >= KEPT:
            del self._late[next(iter(self._late))]
        self._late[key] = work
        loop = asyncio.get_running_loop()
        work.add_done_callback(lambda _: loop.call_later(KEPT_FOR, self._late.pop, key, None))

    async def _begun(self, asker: Asker, task: str, payload: object) -> asyncio.Task[Any]:
        """Work on a question, once a process is free."""
        asked = time.monotonic()
        try:
            await self._shares.take(asker, self.times.queue)
        except NoPlaceError:
            self._figures.ended("busy")
            raise BusyError(f"{task}: no process is free") from None
        self._figures.waited(time.monotonic() - asked)
        work = asyncio.create_task(self._done(asker, task, payload))
        self._under_way.add(work)
        work.add_done_callback(self._forget)
        return work

    async def _done(self, asker: Asker, task: str, payload: object) -> Any:
        self._threads = self._threads or CapacityLimiter(self._shares.places)
        begun, outcome = time.monotonic(), "failed"
        try:
            found = await run_sync(
                self._engines.call, task, payload, self.times.limit, limiter=self._threads, abandon_on_cancel=True
            )
            outcome = "answered"
        except InputError:
            outcome = "refused"
            raise
        except EngineTimeoutError:
            outcome = "ended"
            raise
        except EngineCrashedError:
            outcome = "crashed"
            raise
        finally:
            self._shares.give_back(asker)
            self._figures.ended(outcome)
            self._figures.worked(time.monotonic() - begun)
        return found

    def _forget(self, work: asyncio.Task[Any]) -> None:
        self._under_way.discard(work)
        if not work.cancelled():
            work.exception()  # of one that nobody asks for again, nobody hears


def _digest(asker: Asker, task: str, payload: object) -> str:
    """Digest of a question; of another tenant it is another one, and so is the answer."""
    return hashlib.sha256(json.dumps([asker.tenant, task, payload], default=_plain).encode()).hexdigest()


def _plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return hashlib.sha256(value).hexdigest()
    if isinstance(value, Mapping):
        return dict(value)
    return {own.name: getattr(value, own.name) for own in fields(value)}
