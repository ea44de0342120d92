"""Until when the work that is being done may go on, known to all code below without being handed down.

Whoever answers a question sets the end with :func:`until`, or with :func:`stoppable` where he returns what is known by
then; loops that may take long ask :func:`check` at every turn.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

NEEDLESS = "needless"  # the reason of what nobody waits for any more
INTERRUPTED = "interrupted"  # that of what Ctrl-C has ended


class Stopped(Exception):
    """The time limit is reached, or the user interrupted."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


def _never() -> bool:
    return False


@dataclass(frozen=True, eq=False)
class End:
    """When some work ends.

    Parameters
    ----------
    time : float
        In s, as of ``time.monotonic``.
    duration : float
        In s: how long the work may take in all.
    needless : callable
        Tells whether nobody waits for it any more.
    """

    time: float = math.inf
    duration: float = math.inf
    needless: Callable[[], bool] = _never


_end: ContextVar[End] = ContextVar("end", default=End())  # noqa: B039 - it is frozen


@contextmanager
def until(end: float, needless: Callable[[], bool] | None = None) -> Iterator[None]:
    """Let what is done in the block stop at a time, as of ``time.monotonic``; an earlier end from outside stays.

    ``needless`` tells whether the block does what nobody waits for any more.
    """
    outside = _end.get()
    if end < outside.time:
        inside = End(end, min(end - time.monotonic(), outside.duration), needless or outside.needless)
    else:
        inside = outside if needless is None else End(outside.time, outside.duration, needless)
    before = _end.set(inside)
    try:
        yield
    finally:
        _end.reset(before)


@dataclass
class EarlyEnd:
    """Why some work ended early; nothing where it came to its end."""

    reason: str = ""


@contextmanager
def stoppable(end: float) -> Iterator[EarlyEnd]:
    """Let the block stop at a time, as :func:`until`, or by Ctrl-C, and go on behind it; the ending tells why."""
    ending = EarlyEnd()
    try:
        with until(end):
            yield ending
    except Stopped as stop:
        ending.reason = stop.reason
    except KeyboardInterrupt:
        ending.reason = INTERRUPTED


def check() -> None:
    """Raise Stopped when time is over."""
    end = _end.get()
    if time.monotonic() > end.time:
        raise Stopped("time limit")
    if end.needless():
        raise Stopped(NEEDLESS)


def current() -> End:
    """Return the end of the work that is being done; while nothing brings it forward it is the same object."""
    return _end.get()
