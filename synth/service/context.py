"""What all routes of a server share, and how they come to it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, Any, ParamSpec, Protocol, TypeVar

from anyio import CapacityLimiter
from anyio.to_thread import run_sync
from fastapi import Depends, Request

from synth.jobs.accounts import Accounts
from synth.jobs.engine_process import EngineTimeoutError
from synth.jobs.store import Store
from synth.service.attempts import FailedTokens
from synth.service.event_hub import EventHub
from synth.service.metrics import ServiceMetrics
from synth.service.settings import ServiceSettings

P = ParamSpec("P")
T = TypeVar("T")
API = "/api/v1"  # below which the interface stands
WAITING = 4  # small questions per engine process that wait for it; more are asked to come again


class EngineCalls(Protocol):
    """What the service needs of engine processes; see :class:`synth.jobs.engine_process.Engines`."""

    def call(self, task: str, payload: Any, deadline: float) -> Any:
        """Have a task done within a time."""


class SmallWork:
    """Questions that are answered at once by engine processes. They have threads of their own to wait in.

    Parameters
    ----------
    engines : EngineCalls
    processes : int
        That answer.
    deadline : float
        In s, of a question of which nothing else is said.
    """

    def __init__(self, engines: EngineCalls, processes: int, deadline: float) -> None:
        self._engines, self._most, self._deadline = engines, (1 + WAITING) * processes, deadline
        self._threads: CapacityLimiter | None = None  # belongs to a running loop
        self._asked = 0

    async def ask(self, task: str, payload: Any, deadline: float | None = None) -> Any:
        """Return what a task answers.

        Parameters
        ----------
        task : str
        payload : object
        deadline : float, optional
            In s.

        Raises
        ------
        InputError
            As the task has raised it.
        EngineTimeoutError, EngineCrashedError, EngineFailedError
            It takes too long, too many wait for an answer, the process has ended, or its program has failed.
        """
        if self._threads is None:
            self._threads = CapacityLimiter(self._most)
        if self._asked >= self._most:
            raise EngineTimeoutError(f"{task}: too many wait")
        self._asked += 1
        try:
            within = self._deadline if deadline is None else deadline
            return await run_sync(self._engines.call, task, payload, within, limiter=self._threads)
        finally:
            self._asked -= 1


@dataclass(frozen=True, kw_only=True)
class ServiceContext:
    """What all routes of a server share.

    Parameters
    ----------
    settings : ServiceSettings
    store : Store
    accounts : Accounts
    small, files : SmallWork
        What somebody waits for who types or looks, and files that are read or made: a long report delays no check.
    metrics : ServiceMetrics
    failed_tokens : FailedTokens
    hub : EventHub
        Tells event streams what happens to jobs.
    declared : dict
        What families declare, as it was found: it depends on the code of this server alone.
    ending : asyncio.Event
        Set when the server is told to end: whoever waits for something, as event streams do, ends then.
    """

    settings: ServiceSettings
    store: Store
    accounts: Accounts
    small: SmallWork
    files: SmallWork
    metrics: ServiceMetrics
    failed_tokens: FailedTokens
    hub: EventHub
    declared: dict[Any, Any] = field(default_factory=dict)
    ending: asyncio.Event = field(default_factory=asyncio.Event)

    async def read(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
        """Return what a quick look into the database finds.

        A file is read in less time than it takes to hand over to a thread; a database elsewhere may let one wait.
        """
        if self.store.engine.dialect.name == "sqlite":
            return function(*args, **kwargs)
        return await in_thread(function, *args, **kwargs)


async def in_thread(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Return what a function finds that may wait: everything that writes, or reads much."""
    return await run_sync(lambda: function(*args, **kwargs))


async def context_of(request: Request) -> ServiceContext:
    """Return what the routes of this server share."""
    found: ServiceContext = request.app.state.context
    return found


async def store_of(request: Request) -> Store:
    """Return the job database."""
    return (await context_of(request)).store


Context = Annotated[ServiceContext, Depends(context_of)]
JobStore = Annotated[Store, Depends(store_of)]
