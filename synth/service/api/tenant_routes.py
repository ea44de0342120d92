"""What administrators see of all tenants: which jobs there are, nothing of what is in them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

from fastapi import APIRouter, Query

from synth.batches.views import traces
from synth.service.api.asking import Cursor, Limit, State, Word, cursor_of, entries, place_of
from synth.service.api.schemas import TraceAnswer, TraceList
from synth.service.auth import Administrator
from synth.service.context import API, Context, in_thread

router = APIRouter(prefix=API, tags=["tenants"])


@router.get("/tenants/jobs", summary="The jobs of all tenants")
async def list_all_jobs(
    principal: Administrator,
    context: Context,
    state: Annotated[list[State] | None, Query(description="Only those in these states.")] = None,
    tenant: Word = None,
    limit: Limit = None,
    cursor: Cursor = None,
) -> TraceList:
    """List which jobs there are, and whose, the latest first: neither titles nor what is asked or was found."""
    states = tuple(state or ())
    most = entries(context, limit)
    scope = ["tenants", list(states), tenant]
    place = place_of(cursor, scope, (float, str))
    before = None if place is None else (place[0], place[1])
    found = await in_thread(traces, context.store, tenant=tenant, states=states, before=before, most=most + 1)
    following = cursor_of([found[most - 1].created, found[most - 1].id], scope) if len(found) > most else None
    return TraceList(jobs=[TraceAnswer(**asdict(one)) for one in found[:most]], next=following)
