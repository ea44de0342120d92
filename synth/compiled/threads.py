"""Work of compiled code shared among threads, which run side by side as long as they are in such code."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import Context
from functools import cache
from typing import TypeVar

T = TypeVar("T")


def side_by_side(work: Sequence[Callable[[], T]], workers: int) -> list[T]:
    """Return what comes of parts of some work, in their order, shared among threads of which the caller's is one.

    Threads take the next part when they are free: a core that is busy with something else holds nobody up. They are
    kept, as starting one takes as long as some parts do. Nothing of it is under way any more when this ends, however it
    ends: parts may write to arrays that do not outlive the caller.

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
    waiting, found = iter(enumerate(work)), dict[int, T]()

    def run() -> None:
        try:
            for k, part in waiting:
                found[k] = part()
        finally:
            deque(waiting, maxlen=0)  # after an error nothing more is begun

    # Threads that are kept know nothing of whoever was the first to need them, as a time limit.
    beside = [_threads(workers - 1).submit(Context().run, run) for _ in range(min(workers, len(work)) - 1)]
    try:
        run()
    finally:
        for other in beside:
            if not other.cancel():
                other.result()
    return [found[k] for k in range(len(work))]


@cache
def _threads(count: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(count, thread_name_prefix="compiled")
