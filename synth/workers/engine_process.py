"""Engine processes: where everything that is costly to import computes, so that it can be ended at any moment.

They are spawned, warmed up before they get work, and do one thing at a time. One that is ended takes nothing with it:
what it was asked is asked again, or was not wanted any more. The pipe to it is its lifeline, too: it goes with the
process that has started it.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import signal
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

from synth.errors import InputError, where_raised
from synth.queue.served_process import begin_to_serve
from synth.system.operating_system import bound_memory, give_way, processor_time, resident
from synth.text.numbers import typed_number
from synth.workers.engine_tasks import task_of
from synth.workers.settings import WORK, EngineSettings

READY, PROGRESS, ANSWERED, REFUSED, FAILED = "ready", "progress", "answered", "refused", "failed"


class EngineTimeoutError(Exception):
    """What was asked took longer than it may, or no process was free in time."""


class EngineCrashedError(Exception):
    """The process ended while it was at work."""


@dataclass(frozen=True)
class Failure:
    """How work ended in an error that is nobody's input: the fault is in a program.

    Parameters
    ----------
    kind : str
        The name of the error.
    message : str
        What it says; it may repeat parts of a request.
    where : tuple of str
        Where it was raised, innermost first.
    """

    kind: str
    message: str
    where: tuple[str, ...]


class EngineFailedError(Exception):
    """The work ended in an error that is nobody's input; the process is there and can go on.

    Parameters
    ----------
    failure : Failure
    """

    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.message)
        self.failure = failure


@dataclass(frozen=True)
class Message:
    """What an engine process says: how far it is, or how its work ended."""

    kind: str
    content: Any


class EngineProcess:
    """One process; it is warming up when this returns.

    Parameters
    ----------
    settings : EngineSettings, optional
    """

    def __init__(self, settings: EngineSettings = WORK.engine) -> None:
        context = multiprocessing.get_context("spawn")  # never fork: threads and solvers do not survive it
        self._near, far = context.Pipe()
        self._process = context.Process(target=_serve, args=(far, settings), name="engine", daemon=True)
        self._process.start()
        far.close()
        self._ending = threading.Lock()
        self.settings = settings
        self.code = ""  # the fingerprint of its programs, once it is warm
        self.calls = 0

    @property
    def pid(self) -> int:
        """The number of the process."""
        return int(self._process.pid or 0)

    def is_alive(self) -> bool:
        """True if the process is there."""
        return self._process.is_alive()

    def is_worn(self) -> bool:
        """True if it should be replaced before it gets more work: caches grow."""
        return self.calls >= self.settings.calls or resident(self.pid) > self.settings.worn

    def warm(self, limit: float) -> bool:
        """Wait until the process has imported what it needs; tell whether it has, in so many s of a processor."""
        if not self.code:
            message = self._hear_within(_Budget(self, limit))
            if message is not None and message.kind == READY:
                self.code = str(message.content)
        return bool(self.code)

    def ask(self, task: str, payload: object) -> None:
        """Give work to a process that has none.

        Raises
        ------
        EngineCrashedError
            The process has ended.
        """
        self.calls += 1
        try:
            self._near.send((task, payload))
        except OSError as error:
            raise EngineCrashedError(self.ended()) from error

    def hear(self, timeout: float) -> Message | None:
        """Next message of the process; None where none comes in time.

        Raises
        ------
        EngineCrashedError
            The process has ended.
        """
        try:
            if not self._near.poll(timeout):
                return None
            return Message(*self._near.recv())
        except (EOFError, OSError) as error:
            raise EngineCrashedError(self.ended()) from error

    def _hear_within(self, budget: _Budget) -> Message | None:
        """Message that the process sends next; None where its budget is spent before."""
        while (message := self.hear(self.settings.poll)) is None:
            if budget.is_spent():
                return None
        return message

    def call(self, task: str, payload: object, limit: float) -> Any:
        """Ask, and wait for the answer.

        Parameters
        ----------
        task : str
        payload : object
        limit : float
            In s of a processor: a busy machine ends nobody's work.

        Raises
        ------
        InputError
            As the task has raised it.
        EngineTimeoutError
            It takes more; the process is of no use any more.
        EngineCrashedError
            The process has ended.
        EngineFailedError
            The work has failed by an error of a program.
        """
        budget = _Budget(self, limit)
        self.ask(task, payload)
        while True:
            message = self._hear_within(budget)
            if message is None:
                self.end()
                raise EngineTimeoutError(f"{task}: more than {typed_number(limit)} s of a processor")
            if message.kind != PROGRESS:
                return answer_of(message)

    def ended(self) -> str:
        """Return in words how the process ended."""
        self._process.join(timeout=1.0)
        code = self._process.exitcode
        if code is None:
            return "the process does not answer"
        if code < 0:
            with contextlib.suppress(ValueError):
                return f"the process was ended by {signal.Signals(-code).name}"
        return f"the process ended with code {code}"

    def end(self) -> None:
        """End the process at once, whatever it does; who asks, and who ends all, may do so at once."""
        with self._ending:  # a pipe that two threads close takes a file with it that was opened between
            self._process.kill()
            self._near.close()
            self._process.join(timeout=5.0)


class _Budget:
    """Processor time that a process may use from now on; on the clock it has longer, unless it is stuck."""

    def __init__(self, engine: EngineProcess, seconds: float) -> None:
        self._pid, self._settings, self._seconds = engine.pid, engine.settings, seconds
        self._limit = processor_time(engine.pid) + seconds
        self._moved(processor_time(engine.pid))

    def _moved(self, used: float) -> None:
        self._seen, self._end = used, time.monotonic() + self._settings.stuck * self._seconds

    def is_spent(self) -> bool:
        """Whether the time is used up, or the process has long had hardly any of it."""
        used = processor_time(self._pid)
        if used - self._seen >= self._settings.stirs * self._seconds:
            self._moved(used)
        return used >= self._limit or time.monotonic() >= self._end


def answer_of(message: Message) -> Any:
    """Result of a task; an error is raised again.

    Raises
    ------
    InputError
        As the task has raised it.
    EngineFailedError
        It ended in another error.
    """
    if message.kind == ANSWERED:
        return message.content
    if message.kind == REFUSED:
        refusal: InputError = message.content
        raise refusal
    raise EngineFailedError(message.content)


class EnginePool:
    """Processes that are kept warm, or warming up: taken by whoever has work, and put back or replaced.

    Parameters
    ----------
    count : int
        Processes that are started at once.
    settings : EngineSettings, optional
    """

    def __init__(self, count: int, settings: EngineSettings = WORK.engine) -> None:
        self.settings = settings
        self._idle: queue.SimpleQueue[EngineProcess] = queue.SimpleQueue()
        self._all: set[EngineProcess] = set()
        self._guard = threading.Lock()
        self.closed = False
        for _ in range(count):
            self.add()

    def __len__(self) -> int:
        return len(self._all)

    def add(self) -> None:
        """Start one more, unless all is over."""
        with self._guard:
            if not self.closed:
                engine = EngineProcess(self.settings)
                self._all.add(engine)
                self._idle.put(engine)

    def is_empty(self) -> bool:
        """True if no process is free."""
        return self._idle.empty()

    def take(self, timeout: float) -> EngineProcess | None:
        """Return a process that is free, which may be warming up still; None where none is in time."""
        try:
            return self._idle.get(timeout=timeout)
        except queue.Empty:
            return None

    def put_back(self, engine: EngineProcess, usable: bool = True) -> None:
        """Give back a process that was taken; one that is of no use any more, or worn, is replaced."""
        if usable and not engine.is_worn():
            self._idle.put(engine)
        else:
            self.drop(engine)
            self.add()

    def drop(self, engine: EngineProcess) -> None:
        """End a process for good."""
        with self._guard:
            self._all.discard(engine)
        engine.end()

    def close(self) -> None:
        """End all processes."""
        with self._guard:
            self.closed = True
            for engine in self._all:
                engine.end()
            self._all.clear()


class Engines:
    """Some warm processes that answer small questions, one at a time each.

    Parameters
    ----------
    count : int
        Processes.
    settings : EngineSettings, optional
    at_once : int, optional
        Those that are started at once, by default all. Each other one is when it is needed first, which then takes as
        long as it takes to warm up.
    """

    def __init__(self, count: int, settings: EngineSettings = WORK.engine, *, at_once: int | None = None) -> None:
        begun = count if at_once is None else min(at_once, count)
        self.pool = EnginePool(begun, settings)
        self._later = count - begun
        self._guard = threading.Lock()

    def _add_late(self) -> None:
        """Start one of those that were not needed so far, where no other is free."""
        with self._guard:
            if not self._later or not self.pool.is_empty():
                return
            self._later -= 1
        self.pool.add()

    def call(self, task: str, payload: object, limit: float) -> Any:
        """Have a task done; as :meth:`EngineProcess.call`.

        Raises
        ------
        InputError, EngineTimeoutError, EngineCrashedError, EngineFailedError
            As there; a timeout, too, where no process is free in time.
        """
        self._add_late()
        engine = self.pool.take(limit)
        self._add_late()  # whoever comes next meets one that has begun already
        if engine is None:
            raise EngineTimeoutError(f"{task}: no process is free")
        usable = False
        try:
            # The time of a process that is just starting is its own: nothing is wrong with the question.
            if not engine.warm(self.pool.settings.start):
                raise EngineTimeoutError(f"{task}: the process is not ready")
            answer = engine.call(task, payload, limit)
            usable = True
        except (InputError, EngineFailedError):
            usable = True
            raise
        finally:
            self.pool.put_back(engine, usable)
        return answer

    def close(self) -> None:
        """End all processes."""
        self.pool.close()


# ---- in the process -------------------------------------------------------------------------------------------------


def _serve(pipe: Connection, settings: EngineSettings) -> None:
    """Do what is asked, one thing after the other, until the other side is gone."""
    begin_to_serve()
    give_way(settings.nice)
    bound_memory(settings.addresses)  # the supervisor looks at what is really used
    tasks: queue.SimpleQueue[tuple[str, Any]] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(pipe, tasks), name="lifeline", daemon=True).start()
    from synth.workers.engine_work import warm_up

    say = _Speaker(pipe, settings.report_pause)
    say(READY, warm_up())
    while True:
        task, payload = tasks.get()
        try:
            say(ANSWERED, task_of(task)(payload, say.report))
        except InputError as refusal:
            say(REFUSED, refusal)
        except (Exception, SystemExit, KeyboardInterrupt) as error:
            from synth.batches.solve import error_text

            say(FAILED, Failure(type(error).__name__, error_text(error), tuple(where_raised(error))))


def _listen(pipe: Connection, tasks: queue.SimpleQueue[tuple[str, Any]]) -> None:
    """Take what is asked while something else may be computed; end the process with the one that has started it."""
    while True:
        try:
            tasks.put(pipe.recv())
        except (EOFError, OSError):
            os._exit(1)


class _Speaker:
    """Says things to the other side; how far something is not more often than anybody can read."""

    def __init__(self, pipe: Connection, pause: float) -> None:
        self._pipe, self._pause, self._last_report = pipe, pause, 0.0

    def __call__(self, kind: str, content: object) -> None:
        try:
            self._pipe.send((kind, content))
        except OSError:
            os._exit(1)

    def report(self, state: Mapping[str, object]) -> None:
        now = time.monotonic()
        if now - self._last_report >= self._pause:
            self._last_report = now
            self(PROGRESS, dict(state))
