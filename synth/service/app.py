"""The application: settings, a job database and engine processes in, something that answers HTTP out."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager, suppress
from importlib.metadata import version

from fastapi import APIRouter, Depends, FastAPI
from sqlalchemy.exc import SQLAlchemyError
from starlette.middleware import Middleware

from synth.batches.store import Store
from synth.errors import InputError
from synth.queue.accounts import Accounts
from synth.service import figures, health, token_routes
from synth.service.addresses import Addresses
from synth.service.api import (
    batch_routes,
    catalogue_routes,
    event_routes,
    family_routes,
    file_routes,
    job_routes,
    result_routes,
    table_routes,
    tenant_routes,
)
from synth.service.api.asking import known_query
from synth.service.api.description import DescribedService
from synth.service.attempts import FailedTokens
from synth.service.auth import Callers
from synth.service.code_facts import CodeFacts
from synth.service.context import API, ServiceContext, WriteProbe, in_thread
from synth.service.errors import REFUSALS, register_errors
from synth.service.event_hub import EventHub
from synth.service.metrics import ServiceMetrics
from synth.service.pages import assets, routes
from synth.service.recording import Recorder, log
from synth.service.security import AnswerHeaders, BodyCheck, CrossSiteCheck, HostCheck, RequestLimit
from synth.service.settings import ServiceSettings
from synth.service.shares import FairShares
from synth.service.small_work import EngineCalls, SmallWork, Times

# Of the interface; each states API as its prefix, so that the figures of requests know the whole path.
ROUTERS: tuple[APIRouter, ...] = (
    family_routes.router,
    job_routes.router,
    result_routes.router,
    file_routes.router,
    event_routes.router,
    batch_routes.router,
    catalogue_routes.router,
    table_routes.router,
    tenant_routes.router,
    token_routes.router,
)
DESCRIPTION = (
    "What is asked becomes a job, which workers take up. `POST /jobs` and `POST /batches` take `Idempotency-Key`: said "
    "again with the same body they make no second job. Nothing else needs one: the same part table is the version "
    "that is there (409 with its `Location`), a file that was brought twice goes by itself, and the value of a token "
    "is kept nowhere, so that it can be told only once."
)
OUTSIDE: tuple[APIRouter, ...] = (health.router, figures.router, assets.router, routes.router)


def create_app(
    settings: ServiceSettings, store: Store, engines: EngineCalls, file_engines: EngineCalls | None = None
) -> FastAPI:
    """Return the application.

    Parameters
    ----------
    settings : ServiceSettings
    store : Store
        The job database; whoever has opened it closes it.
    engines : EngineCalls
        For small questions, such as :class:`synth.workers.engine_process.Engines`.
    file_engines : EngineCalls, optional
        For files that are read or made; by default the same.
    """
    context = _context(settings, store, engines, file_engines or engines)
    app = DescribedService(
        title="clutchsynth",
        version=version("clutchsynth"),
        summary="Design synthesis of clutches and shaft couplings.",
        description=DESCRIPTION,
        servers=[{"url": "/", "description": "This server: all paths stand below its address."}],
        openapi_url=f"{API}/openapi.json",
        docs_url=None,  # the usual pages load scripts from elsewhere
        redoc_url=None,
        redirect_slashes=False,
        lifespan=_lifespan,
        middleware=[
            Middleware(AnswerHeaders),
            Middleware(Recorder, context.metrics),
            Middleware(HostCheck, settings),
            Middleware(CrossSiteCheck, settings),
            Middleware(Callers, context),
            Middleware(RequestLimit, settings, context.requests, context.metrics),
            Middleware(BodyCheck, settings, context.uploads),
        ],
    )
    app.state.context = context
    _watch(context)
    own = [route for router in (*ROUTERS, *OUTSIDE) for route in router.routes]
    register_errors(app, settings.retry_after, Addresses([*app.routes, *own]), routes.unknown)
    for router in ROUTERS:
        app.include_router(router, responses=REFUSALS, dependencies=[Depends(known_query)])
    for router in OUTSIDE:
        app.include_router(router, include_in_schema=False)
    return app


def _context(
    settings: ServiceSettings, store: Store, engines: EngineCalls, file_engines: EngineCalls
) -> ServiceContext:
    """What requests share: accounts, engines with their fair shares, and figures."""

    def shares(places: int) -> FairShares:
        return FairShares(places, settings.tenant_share, settings.token_share, settings.requests_at_once)

    metrics = ServiceMetrics(settings, store)
    small = SmallWork(
        engines,
        shares(settings.engines),
        Times(queue=settings.queue_wait, deadline=settings.small_deadline, limit=settings.small_limit),
        metrics.questions("small"),
    )
    files = SmallWork(
        file_engines,
        shares(settings.file_engines),
        Times(queue=settings.queue_wait, deadline=settings.file_deadline, limit=settings.file_limit),
        metrics.questions("files"),
    )
    return ServiceContext(
        settings=settings,
        store=store,
        accounts=Accounts(store),
        small=small,
        files=files,
        metrics=metrics,
        facts=CodeFacts(small, settings.remembered, settings.retry_after),
        requests=shares(settings.requests_at_once),
        uploads=shares(settings.uploads_at_once),
        failed_tokens=FailedTokens(settings.failed_tokens, settings.failed_window, settings.addresses),
        write_probe=WriteProbe(store, settings.ready_write),
        hub=EventHub(settings, store),
    )


def _watch(context: ServiceContext) -> None:
    """Let figures tell how full the server is, and what it has read of its own code."""
    places, facts = context.metrics.places, context.facts
    places.labels("under_way").set_function(lambda: context.requests.held)
    places.labels("waiting").set_function(lambda: context.requests.waiting)
    context.metrics.facts.labels("missing").set_function(lambda: facts.missing)
    context.metrics.facts.labels("kept").set_function(lambda: facts.wanted - facts.missing)


async def _prepare(context: ServiceContext) -> None:
    """Find what depends on the code alone."""
    await context.facts.prepare()


# What a server does beside answering, until it ends.
TASKS: tuple[Callable[[ServiceContext], Awaitable[None]], ...] = (event_routes.tail, _prepare)


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    """Do what is done beside answering, while the server runs."""
    context: ServiceContext = app.state.context
    tasks = [asyncio.ensure_future(task(context)) for task in (_prune, *TASKS)]
    try:
        yield
    finally:
        context.ending.set()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _prune(context: ServiceContext) -> None:
    """Remove what is too old, some at a time."""
    settings = context.settings
    while True:
        try:
            while gone := await in_thread(context.store.prune, settings.prune_most):
                log("pruned", jobs=gone)
        except (SQLAlchemyError, InputError, OSError) as error:
            log("not_pruned", error=type(error).__name__)
        with suppress(TimeoutError):
            async with asyncio.timeout(settings.prune_interval):
                await context.ending.wait()
                return
