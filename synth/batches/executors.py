"""Where units are solved: in this process, in processes of this machine, or on a Dask cluster.

All are executors of ``concurrent.futures`` with a number of ``slots``. They are muscle: nothing is lost with them.
"""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import sys
import threading
import time
import warnings
from collections.abc import Callable
from concurrent.futures import CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from functools import cache
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnContext
from queue import SimpleQueue
from typing import Any

from synth.batches.settings import BATCHES, ClusterSettings
from synth.batches.signs import share
from synth.errors import InputError
from synth.queue.served_process import begin_to_serve

LOST = (OSError, RuntimeError, AttributeError, CancelledError, TimeoutError)  # what a client without scheduler raises
NOISY = ("distributed", "dask", "tornado", "asyncio", "bokeh")  # loggers


class Inline(Executor):
    """Solves at once, in the calling thread."""

    slots = 1

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call the function, and return a future that is finished."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class Processes(Executor):
    """Processes of this machine, each an executor of its own: one that dies takes only its own unit with it.

    Parameters
    ----------
    workers : int
        How many.
    """

    def __init__(self, workers: int) -> None:
        # Never fork: threads and solvers of this process do not survive it.
        self._context = multiprocessing.get_context("spawn")
        self.slots = workers
        self._all = [_Worker(self._context) for _ in range(workers)]
        self._exchange = threading.Lock()
        self._over = False
        self._idle: SimpleQueue[_Worker] = SimpleQueue()
        for worker in self._all:
            self._idle.put(worker)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Give work to an idle process; at most ``slots`` calls may be under way."""
        worker = self._idle.get()  # one whose work has just ended comes back a moment later
        try:
            future = worker.pool.submit(fn, *args, **kwargs)
        except BrokenProcessPool:  # it died while it was idle
            worker = self._replaced(worker)
            future = worker.pool.submit(fn, *args, **kwargs)
        future.add_done_callback(lambda done: self._idle.put(self._after(worker, done)))
        return future

    def _after(self, worker: _Worker, done: Future[Any]) -> _Worker:
        broken = not done.cancelled() and isinstance(done.exception(), BrokenProcessPool)
        return self._replaced(worker) if broken else worker

    def _replaced(self, worker: _Worker) -> _Worker:
        """Give a fresh process for one that died; after the end, when all die, there is none."""
        with self._exchange:
            if self._over:
                return worker
            worker.end()
            fresh = _Worker(self._context)
            self._all[self._all.index(worker)] = fresh
            return fresh

    def with_designs(self) -> int:
        """Number of rows with designs by now, of the groups that are under way."""
        return sum(int(worker.with_designs.value) for worker in self._all)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes at once, whatever they do."""
        # Threads in which processes are found dead must not close the same pipes: a file opened meanwhile would go.
        with self._exchange:
            if not self._over:
                self._over = True
                for worker in self._all:
                    worker.end()


class _Worker:
    """One process, which ends as soon as this side of its lifeline is closed, by hand or by death."""

    def __init__(self, context: SpawnContext) -> None:
        far, self._near = context.Pipe(duplex=False)
        self.with_designs = context.RawValue("q", 0)
        self.pool = ProcessPoolExecutor(1, mp_context=context, initializer=_begin, initargs=(far, self.with_designs))
        self._far = far

    def end(self) -> None:
        self._near.close()
        self._far.close()
        self.pool.shutdown(wait=False, cancel_futures=True)


def _begin(lifeline: Connection, shared_count: object) -> None:
    """Prepare a worker process: one thread, deaf to Ctrl-C and SIGTERM, and gone when its master is.

    ``shared_count``: memory for the number of rows of its group that have designs.
    """
    share(shared_count)
    begin_to_serve()

    def watch() -> None:
        try:
            lifeline.recv_bytes()
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=watch, name="lifeline", daemon=True).start()


def must_answer(address: str, settings: ClusterSettings = BATCHES.cluster) -> None:
    """Refuse the address of a scheduler that nothing answers at, before anything is written for it.

    Raises
    ------
    InputError
        As for :class:`Cluster`.
    """
    Cluster(address, lambda _: None, settings).shutdown()


class Cluster(Executor):
    """A Dask cluster. A scheduler that dies is waited for; what it was doing is asked for again.

    Parameters
    ----------
    address : str
        ``tcp://host:port`` of the scheduler.
    say : callable
        Told in a sentence when the scheduler is lost or found again.
    settings : ClusterSettings, optional

    Raises
    ------
    InputError
        When nothing answers there, or the extra is not installed.
    """

    def __init__(self, address: str, say: Callable[[str], None], settings: ClusterSettings = BATCHES.cluster) -> None:
        try:
            import distributed  # an extra: only for those who outgrow one machine
        except ImportError:
            expected = "the extra for clusters: pip install 'clutchsynth[cluster]'"
            raise InputError("--scheduler", address, expected) from None
        self._address, self._say, self._settings = address, say, settings
        self._client_type = _quiet_client(distributed.Client)
        self._is_idle = False  # nobody works there, and that was said
        try:
            self._connect()
        except Exception as error:  # whatever comes of an address of another kind, or of another server there
            expected = f"the address of a Dask scheduler that answers, such as tcp://host:8786 ({type(error).__name__})"
            raise InputError("--scheduler", address, expected) from error

    def _connect(self) -> None:
        import dask

        answer = self._settings.answer
        with ThreadPoolExecutor(1) as apart:  # a loop of its own: there may be one at work here
            apart.submit(asyncio.run, _must_be_scheduler(self._address, answer)).result()
        with dask.config.set({"distributed.comm.timeouts.connect": answer}), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of versions: what matters of them is checked with every unit
            self._client = self._client_type(self._address, timeout=answer, set_as_default=False)
        self._executor = self._client.get_executor(pure=False)
        self._threads, self._counted = 0, float("-inf")

    @property
    def slots(self) -> int:
        """Units to have under way: some more than the cluster has threads, so that none waits for the next."""
        if time.monotonic() - self._counted > self._settings.recount:
            try:
                self._threads = sum(int(count) for count in self._client.nthreads().values())
            except LOST:
                self._threads = 0
            self._counted = time.monotonic()
            if self._threads == 0 and not self._is_idle:
                self._say(f"the scheduler at {self._address} has no workers; waiting for them")
            self._is_idle = self._threads == 0
        return max(2 * self._threads, 2)

    def alive(self) -> bool:
        """True if the scheduler is there."""
        return bool(self._client.status == "running")

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Give work to the cluster; what cannot be given comes back as cancelled."""
        future: Future[Any]
        try:
            future = self._executor.submit(fn, *args, **kwargs)
        except LOST:
            future = Future()
            future.cancel()
            future.set_running_or_notify_cancel()
        except Exception as error:  # what cannot be sent fails as a unit
            future = Future()
            future.set_exception(error)
        return future

    def reconnect(self, stopped: Callable[[], bool]) -> bool:
        """Wait for the scheduler to come back; tell whether it has.

        Parameters
        ----------
        stopped : callable
            Tells whether there is no more need.
        """
        self._say(f"the scheduler at {self._address} does not answer; nothing is lost, waiting for it")
        self._close()
        deadline = time.monotonic() + self._settings.patience
        while time.monotonic() < deadline and not stopped():
            try:
                self._connect()
            except Exception:  # a scheduler that is just ending, or beginning, may answer anything
                time.sleep(self._settings.retry)
                continue
            self._say("the scheduler is back; what it had not finished is asked for again")
            return True
        return False

    def _close(self) -> None:
        with suppress(Exception):  # it was closed by what happened to the scheduler
            self._client.close(timeout=1)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let go of the cluster; it goes on without us."""
        self._close()


async def _must_be_scheduler(address: str, seconds: float) -> None:
    """Ask who answers at an address; a client would wait for ever for a server that says nothing.

    Raises
    ------
    Exception
        Of any kind, where nobody answers in time or somebody else does.
    """
    from distributed.core import rpc

    async def answered() -> str:
        async with rpc(address) as far:
            return str((await far.identity())["type"])

    if await asyncio.wait_for(answered(), seconds) != "Scheduler":
        raise ValueError(f"no scheduler at {address}")


@cache
def _quiet_client(client: type[Any]) -> type[Any]:
    """Return a client of Dask that keeps its troubles to itself: what they mean is told in sentences of ours."""
    # It sends tracebacks to standard error by handlers of its own, and by that of last resort; handlers that others
    # have set up hear of them as before.
    names = [name for name in logging.root.manager.loggerDict if name.partition(".")[0] in NOISY]
    for name in {*NOISY, *names}:
        logger = logging.getLogger(name)
        for handler in list(logger.handlers):
            if isinstance(handler, logging.StreamHandler) and handler.stream is sys.stderr:
                logger.removeHandler(handler)
        logger.addHandler(logging.NullHandler())

    class QuietClient(client):  # type: ignore[misc]
        """Ends without a word where it was never connected."""

        def __del__(self) -> None:
            with suppress(Exception):
                super().__del__()

    return QuietClient


def is_foreign(error: BaseException) -> bool:
    """True if a scheduler or worker could not read what it was sent, as its program is another one."""
    return isinstance(error, ImportError) or (isinstance(error, RuntimeError) and "deserializ" in str(error))


def is_lost(future: Future[Any]) -> bool:
    """True if work was lost with whoever held it, which says nothing about the work."""
    return future.cancelled() or isinstance(future.exception(), (CancelledError, OSError))
