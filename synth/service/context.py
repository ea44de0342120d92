"""What all routes of a server share, and how they come to it."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Annotated, ParamSpec, TypeVar

from anyio.to_thread import run_sync
from fastapi import Depends, Request

from synth.batches.store import Store
from synth.queue.accounts import Accounts
from synth.service.attempts import FailedTokens
from synth.service.code_facts import CodeFacts
from synth.service.event_hub import EventHub
from synth.service.metrics import ServiceMetrics
from synth.service.settings import ServiceSettings
from synth.service.shares import FairShares
from synth.service.small_work import SmallWork

P = ParamSpec("P")
T = TypeVar("T")
API = "/api/v1"  # below which the interface stands


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
    write_probe : WriteProbe
    hub : EventHub
        Tells event streams what happens to jobs.
    facts : CodeFacts
        What depends on the code of this server alone.
    requests, uploads : FairShares
        Of requests that are under way, and of files that are brought at a time.
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
    write_probe: WriteProbe
    hub: EventHub
    facts: CodeFacts
    requests: FairShares
    uploads: FairShares
    ending: asyncio.Event = field(default_factory=asyncio.Event)

    async def read(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
        """Result of a quick look into the database.

        A file is read in less time than it takes to hand over to a thread; a database elsewhere may let one wait.
        """
        if self.store.engine.dialect.name == "sqlite":
            return function(*args, **kwargs)
        return await in_thread(function, *args, **kwargs)


class WriteProbe:
    """Looks whether a database can be written to, once in a while: everybody may ask whether a server is ready.

    Parameters
    ----------
    store : Store
    pause : float
        In s, for which a write that succeeded is believed.
    """

    def __init__(self, store: Store, pause: float) -> None:
        self._store, self._pause, self._written = store, pause, -math.inf

    def __call__(self) -> None:
        """Write something, unless that was done just now.

        Raises
        ------
        OSError, DBAPIError
            Nothing can be written.
        """
        if time.monotonic() - self._written > self._pause:
            self._store.probe()
            self._written = time.monotonic()


async def in_thread(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """Result of a function that may wait: everything that writes, or reads much."""
    return await run_sync(lambda: function(*args, **kwargs))


async def context_of(request: Request) -> ServiceContext:
    """Shared objects of the routes of this server."""
    found: ServiceContext = request.app.state.context
    return found


Context = Annotated[ServiceContext, Depends(context_of)]
