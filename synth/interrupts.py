"""Ctrl-C that could be lost: while symbols are made it waits, and a batch asks for it again."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def held_back() -> Iterator[None]:
    """Let Ctrl-C wait for the end of the block.

    CasADi asks Python to convert numbers and drops whatever is raised meanwhile, so that the wish to stop would go
    unheard.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield  # signals arrive in the main thread alone, or nobody wants to hear of this one
        return
    heard: list[FrameType | None] = []
    signal.signal(signal.SIGINT, lambda number, frame: heard.append(frame))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if heard:
            before(signal.SIGINT, heard[0])


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

    # Who starts a program with Ctrl-C switched off does not want it heard.
    deaf = signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    before = {number: signal.signal(number, stop) for number in (signal.SIGTERM, *([] if deaf else [signal.SIGINT]))}
    try:
        yield check
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
