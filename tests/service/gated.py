"""Engine processes that answer when a test lets them: what is judged is who comes when, not how long it takes."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from typing import Any

from tests.waiting import PATIENCE

TURNS = 200  # of the event loop, in which everything happens that can without anything from outside


class Gated:
    """Stands in for engine processes: each question waits until the gate is open.

    Parameters
    ----------
    answer : callable, optional
    """

    def __init__(self, answer: Callable[[str, Any], Any] = lambda task, payload: payload) -> None:
        self.answer = answer
        self.gate = threading.Event()
        self.begun: list[tuple[str, Any]] = []
        self.ended = 0
        self._changed = threading.Condition()

    def call(self, task: str, payload: Any, limit: float) -> Any:
        with self._changed:
            self.begun.append((task, payload))
            self._changed.notify_all()
        assert self.gate.wait(60.0), "nobody has opened the gate"
        try:
            return self.answer(task, payload)
        finally:
            with self._changed:
                self.ended += 1

    async def until_begun(self, count: int) -> None:
        """Wait until so many questions have been begun."""
        await until(lambda: len(self.begun) >= count)


async def until(right: Callable[[], bool]) -> None:
    """Let everything else go on until something holds."""
    async with asyncio.timeout(PATIENCE):
        while not right():
            await asyncio.sleep(0.001)


async def settled() -> None:
    """Let everything happen that can."""
    for _ in range(TURNS):
        await asyncio.sleep(0)
