"""Until when the work that is being done may go on, known to all code below without being handed down.

Whoever answers a question sets the end with :func:`until`; loops that may take long ask :func:`check` at every turn.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar


class Stopped(Exception):
    """The time limit is reached, or the user interrupted."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


def _never() -> bool:
    return False


_end: ContextVar[tuple[float, Callable[[], bool]]] = ContextVar("end", default=(math.inf, _never))


@contextmanager
def until(end: float, needless: Callable[[], bool] | None = None) -> Iterator[None]:
    """Let what is done in the block stop at a time, as of ``time.monotonic``; an earlier end from outside stays.

    ``needless`` tells whether the block does what nobody waits for any more.
    """
    outside, other = _end.get()
    before = _end.set((min(end, outside), other if needless is None else needless))
    try:
        yield
    finally:
        _end.reset(before)


def check() -> None:
    """Raise Stopped when time is over."""
    end, needless = _end.get()
    if time.monotonic() > end:
        raise Stopped("time limit")
    if needless():
        raise Stopped("needless")
