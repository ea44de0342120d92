"""Work of kernels shared among threads, which run side by side as long as they are in such code."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import Context
from functools import cache
from typing import Generic, TypeVar

T = TypeVar("T")


class SideBySide(Generic[T]):
    """Parts of some work that run concurrently with the caller until it requests their results.

    Threads take the next part when they are free: a core that is busy with something else holds nobody up. They are
    kept, as starting one takes as long as some parts do. Nothing of it is under way any more when it has ended, however
    it ends: parts may write to arrays that do not outlive the caller, who therefore has to end it.

    Parameters
    ----------
    work : sequence of callable
        The parts.
    workers : int
        Threads at most; the caller's is one of them, once it requests the results.
    """

    def __init__(self, work: Sequence[Callable[[], T]], workers: int) -> None:
        self._waiting, self._results, self._count = iter(enumerate(work)), dict[int, T](), len(work)
        # Threads that are kept know nothing of whoever was the first to need them, as a time limit.
        self._futures = [
            _threads(workers - 1).submit(Context().run, self._run) for _ in range(min(workers, len(work)) - 1)
        ]

    def results(self) -> list[T]:
        """Results of all parts, in their order; runs those that no thread has begun.

        Raises
        ------
        Exception
            As a part has raised it; what is waiting then is not begun.
        """
        try:
            self._run()
        finally:
            self.stop()
        for future in self._futures:
            if not future.cancelled():
                future.result()
        return [self._results[k] for k in range(self._count)]

    def stop(self) -> None:
        """Begin nothing more, and wait for what is under way, whatever becomes of it."""
        deque(self._waiting, maxlen=0)
        for future in self._futures:
            if not future.cancel():
                future.exception()

    def _run(self) -> None:
        try:
            for k, part in self._waiting:
                self._results[k] = part()
        finally:
            deque(self._waiting, maxlen=0)  # after an error nothing more is begun


def side_by_side(work: Sequence[Callable[[], T]], workers: int) -> list[T]:
    """Results of parts of some work, in their order, shared among threads of which the caller's is one.

    Parameters
    ----------
    work : sequence of callable
        The parts.
    workers : int
        Threads at most.

    Raises
    ------
    Exception
        As a part has raised it; what is waiting then is not begun.
    """
    return SideBySide(work, workers).results()


@cache
def _threads(count: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(count, thread_name_prefix="kernel")
