"""What depends on the code of a server alone: families, their declarations, examples and tables.

It is found once, by an engine process, and served from here. What every form needs is found as soon as the server
starts, however long that takes.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from synth.service.recording import log
from synth.service.shares import Asker
from synth.service.small_work import BusyError, LateError, SmallWork
from synth.workers.engine_process import EngineCrashedError, EngineFailedError, EngineTimeoutError
from synth.workers.engine_tasks import DECLARATION_TASK, EXAMPLES_TASK, FAMILIES_TASK, TABLES_TASK

SERVER = Asker("the server", None)
NOTHING: Mapping[str, Any] = MappingProxyType({})


def declaration_asked(family: str, options: Mapping[str, str] = NOTHING) -> dict[str, Any]:
    """How a declaration is asked for."""
    return {"family": family, "options": dict(sorted(options.items()))}


class CodeFacts:
    """Answers that depend on the code alone.

    Parameters
    ----------
    small : SmallWork
        Finds them.
    remembered : int
        Declarations with options chosen that are kept; of all else there is a fixed number.
    pause : float
        In s, before something is tried again that has failed.
    """

    def __init__(self, small: SmallWork, remembered: int, pause: float) -> None:
        self._small, self._remembered, self._pause = small, remembered, pause
        self._kept: dict[str, Any] = {}
        self._chosen: dict[str, Any] = {}  # declarations with options, the latest last
        self._under_way: dict[str, asyncio.Task[Any]] = {}
        self._wanted: frozenset[str] = frozenset()

    @property
    def missing(self) -> int:
        """Facts that are looked for since the start, and not there yet."""
        return sum(key not in self._kept for key in self._wanted)

    @property
    def wanted(self) -> int:
        """Facts that are looked for since the start."""
        return len(self._wanted)

    async def get(self, asker: Asker, task: str, payload: Mapping[str, object] = NOTHING) -> Any:
        """Fact that a task tells.

        Raises
        ------
        InputError, EngineTimeoutError, EngineCrashedError, EngineFailedError
            As :meth:`SmallWork.ask`; late only where it is asked for before it is there.
        """
        key = _key(task, payload)
        for kept in (self._kept, self._chosen):
            if key in kept:
                return kept[key]
        work = self._under_way.get(key)
        if work is None:
            work = self._under_way[key] = asyncio.create_task(self._found(asker, task, dict(payload), key))
            work.add_done_callback(lambda done: done.cancelled() or done.exception())
        await asyncio.wait({work}, timeout=self._small.times.deadline)
        if not work.done():
            raise LateError(f"{task}: is being read")
        return work.result()

    async def _found(self, asker: Asker, task: str, payload: dict[str, Any], key: str) -> Any:
        try:
            while True:
                try:
                    found = await self._small.ask(asker, task, payload)
                    break
                except LateError:
                    continue  # it goes on
        finally:
            del self._under_way[key]
        if payload.get("options"):
            while len(self._chosen) >= self._remembered:
                del self._chosen[next(iter(self._chosen))]
            self._chosen[key] = found
        else:
            self._kept[key] = found
        return found

    async def prepare(self) -> None:
        """Find what every form needs, one thing after the other."""
        wanted: list[tuple[str, dict[str, Any]]] = [(FAMILIES_TASK, {}), (EXAMPLES_TASK, {}), (TABLES_TASK, {})]
        self._wanted = frozenset(_key(*one) for one in wanted)
        for task, payload in wanted:
            while _key(task, payload) not in self._kept:
                try:
                    await self.get(SERVER, task, payload)
                except (LateError, BusyError):
                    continue
                except (EngineTimeoutError, EngineCrashedError, EngineFailedError) as error:
                    log("not_read", task=task, error=type(error).__name__)
                    await asyncio.sleep(self._pause)
            if task == FAMILIES_TASK:  # one that cannot be imported or declared is not among them
                listed = self._kept[_key(task, payload)]["families"]
                wanted += [(DECLARATION_TASK, declaration_asked(one["name"])) for one in listed]
                self._wanted = frozenset(_key(*one) for one in wanted)


def _key(task: str, payload: Mapping[str, object]) -> str:
    return json.dumps([task, payload], default=dict)
