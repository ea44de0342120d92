"""Whether the server is alive, and whether it is of use: for whoever starts it, and sends people to it."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from fastapi.responses import JSONResponse
from sqlalchemy.exc import SQLAlchemyError

from synth.errors import InputError
from synth.jobs.database import HEAD
from synth.service.context import Context, ServiceContext, in_thread
from synth.service.errors import again

router = APIRouter(tags=["health"])


@router.get("/healthz")
async def alive() -> dict[str, str]:
    """Tell that the server answers."""
    return {"status": "alive"}


@router.get("/readyz", responses={503: {"description": "Not ready; `reasons` tells why."}})
async def ready(context: Context) -> JSONResponse:
    """Tell whether jobs can be asked for and will be worked at."""
    reasons = await why_not_ready(context)
    if not reasons:
        return JSONResponse({"status": "ready", "reasons": []})
    told = {"status": "not ready", "reasons": reasons}
    return JSONResponse(told, 503, again(context.settings.retry_after))


async def why_not_ready(context: ServiceContext) -> list[str]:
    """Return what is missing, in words; nothing where all is well."""
    settings = context.settings
    if context.ending.is_set():
        return ["the server is ending"]
    try:
        async with asyncio.timeout(settings.ready_database):
            return await in_thread(_missing, context)
    except TimeoutError:
        return [f"the database does not answer in {settings.ready_database:g} s"]
    except (SQLAlchemyError, InputError, OSError) as error:
        return [f"the database cannot be used ({type(error).__name__})"]


def _missing(context: ServiceContext) -> list[str]:
    known = context.store.version()
    if known != HEAD:
        return [f"the tables are of version {known}; this server needs {HEAD}"]
    if not context.store.workers(context.settings.ready_worker):
        within = f"within {context.settings.ready_worker:g} s"
        return [f"no worker has given a sign of life {within}; one that has just begun does so in a few seconds"]
    return []
