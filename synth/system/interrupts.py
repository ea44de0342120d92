"""Ctrl-C, and the signal by which schedulers end programs: taken alike, held back where they do harm, not lost."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import FrameType

from synth.system.operating_system import ENDING

TWICE = 1.0  # seconds; what comes from a terminal, and again from whoever started the program, is one wish


@contextmanager
def sigterm_as_interrupt() -> Iterator[None]:
    """Handle SIGTERM, by which schedulers and containers end a process, as Ctrl-C; two at once count as one."""
    last = -TWICE

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= TWICE:
            last = now
            raise KeyboardInterrupt

    with _handled(_heard_signals(), stop):
        yield


@contextmanager
def held_back() -> Iterator[None]:
    """Let Ctrl-C and SIGTERM wait for the end of the block.

    CasADi asks Python to convert numbers and drops whatever is raised meanwhile, so that the wish to stop would go
    unheard; and what is being saved shall be saved.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # signals arrive in the main thread alone
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, *ENDING)}
    heard: dict[int, FrameType | None] = {}
    try:
        with _handled([n for n, handler in before.items() if callable(handler)], heard.__setitem__):
            yield
    finally:
        for number, frame in heard.items():
            if callable(handler := before[signal.Signals(number)]):
                handler(number, frame)


@contextmanager
def heard_again() -> Iterator[Callable[[], None]]:
    """Take the signal by which a scheduler ends a program as a Ctrl-C, and remember both.

    What is raised while an object is cleared away, or inside a library that drops it, is lost. The block is given a
    function that raises KeyboardInterrupt where that has happened.
    """
    heard: list[int] = []

    def stop(number: int, frame: FrameType | None) -> None:
        heard.append(number)
        raise KeyboardInterrupt

    def check() -> None:
        if heard:
            raise KeyboardInterrupt

    with _handled(_heard_signals(), stop):
        yield check


def _heard_signals() -> list[signal.Signals]:
    """Return the signals that end a program; who starts one with Ctrl-C switched off does not want it heard."""
    deaf = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    return [*ENDING, *([] if deaf else [signal.SIGINT])]


@contextmanager
def _handled(numbers: Iterable[signal.Signals], handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Handle signals in a way of one's own within the block."""
    before = {number: signal.signal(number, handler) for number in numbers}
    try:
        yield
    finally:
        for number, old in before.items():
            signal.signal(number, old)
