"""Whether the server is alive, and whether it is of use: for whoever starts it, and sends people to it."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from fastapi.responses import JSONResponse
from sqlalchemy.exc import SQLAlchemyError

from synth.errors import InputError
from synth.queue.database import HEAD
from synth.service.context import Context, ServiceContext, in_thread
from synth.service.errors import again
from synth.text.numbers import number_text, typed_number

router = APIRouter(tags=["health"])


@router.get("/healthz")
async def alive() -> dict[str, str]:
    """Tell that the server answers."""
    return {"status": "alive"}


@router.get("/readyz", responses={503: {"description": "Not ready; `reasons` tells why."}})
async def ready(context: Context) -> JSONResponse:
    """True if jobs can be asked for and will be worked at."""
    reasons = await why_not_ready(context)
    if not reasons:
        return JSONResponse({"status": "ready", "reasons": []})
    told = {"status": "not ready", "reasons": reasons}
    return JSONResponse(told, 503, again(context.settings.retry_after))


async def why_not_ready(context: ServiceContext) -> list[str]:
    """Missing parts, in words; empty where all is well."""
    settings = context.settings
    if context.ending.is_set():
        return ["the server is ending"]
    try:
        async with asyncio.timeout(settings.ready_database):
            return await in_thread(_missing, context) + _not_answered(context)
    except TimeoutError:
        return [f"the database does not answer in {typed_number(settings.ready_database)} s"]
    except (SQLAlchemyError, InputError, OSError) as error:
        told = error.strerror if isinstance(error, OSError) else type(error).__name__
        return [f"the database cannot be used ({told})"]


def _not_answered(context: ServiceContext) -> list[str]:
    """Reasons why pages and programs would wait for answers."""
    facts, reasons = context.facts, list[str]()
    if facts.missing:
        there = f"{facts.wanted - facts.missing} of {facts.wanted} are there"
        reasons.append(f"families, examples and tables are being read: {there}")
    for work, what in ((context.small, "answers small questions"), (context.files, "reads and makes files")):
        if work.is_stuck:
            reasons.append(f"every process that {what} is late")
    return reasons


def _missing(context: ServiceContext) -> list[str]:
    known = context.store.version()
    if known != HEAD:
        return [f"the tables are of version {known}; this server needs {HEAD}"]
    needed, free = context.settings.ready_space, context.store.free_space()
    if free is not None and free < needed:
        return [f"{_megabytes(free)} are free where the database is; {_megabytes(needed)} are needed"]
    context.write_probe()
    if not context.store.workers(context.settings.ready_worker):
        within = f"within {typed_number(context.settings.ready_worker)} s"
        return [f"no worker has given a sign of life {within}; one that has just begun does so in a few seconds"]
    return []


def _megabytes(size: int) -> str:
    return f"{number_text(size / 1e6, 3)} MB"
