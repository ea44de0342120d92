"""Jobs: asked for, listed, looked at, changed, cancelled, gone on with, and removed."""

from __future__ import annotations

import json
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response

from synth.folders.files import yaml_text
from synth.kinds import KINDS
from synth.kinds import kind as kind_named
from synth.queue.job_table import LIVE
from synth.queue.tenant_files import TenantFiles
from synth.service.api.asking import (
    ENDED,
    LONGEST,
    NOT_MODIFIED,
    Cursor,
    Limit,
    OwnJob,
    State,
    Word,
    cursor_of,
    entries,
    note_use,
    place_of,
    tag_of,
    tagged,
    word,
)
from synth.service.api.family_routes import must_be_family
from synth.service.api.presenting import job_answer, job_bytes, job_place
from synth.service.api.schemas import JobAnswer, JobChange, JobList, JobRequest
from synth.service.api.submission import Wish, submit
from synth.service.auth import Reader, Submitter
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import JSON, ServiceError, not_found
from synth.service.security import header
from synth.service.small_work import asker_of
from synth.service.wording import PRINTED
from synth.workers.engine_tasks import CHANGED_TASK

router = APIRouter(prefix=API, tags=["jobs"])
YAML = "application/yaml"
RESUMABLE = "cancelled, failed or stopped"
PLACE = {"Location": {"description": "Where the job is.", "schema": {"type": "string"}}}
NEEDED: dict[int | str, dict[str, Any]] = {409: {"description": "It is kept for good, or an open job refers to it."}}
SUBMITTED: dict[int | str, dict[str, Any]] = {
    200: {
        "model": JobAnswer,
        "description": "The same was asked before: this is the job that was made then.",
        "headers": PLACE,
    },
    202: {"description": "A job was made.", "headers": PLACE},
    409: {"description": "The key was used for another request."},
}
IdempotencyKey = Annotated[
    str | None,
    Header(
        min_length=1,
        max_length=LONGEST,
        pattern=PRINTED,
        description="Chosen by the client: said again with the same body it makes no second job.",
    ),
]


async def submitted(
    request: Request, context: ServiceContext, principal: Submitter, wish: Wish, key: str | None
) -> Response:
    """Make a job, and answer with it: 202, or 200 where the same was asked before."""
    name, made = await submit(context, principal, wish, key)
    job = await in_thread(context.store.job, name, principal.tenant)
    if job is None:  # it was removed at the same time
        raise not_found()
    await note_use(context, job)
    return Response(job_bytes(request, job), 202 if made else 200, {"Location": job_place(request, name)}, JSON)


@router.post("/jobs", status_code=202, response_model=JobAnswer, responses=SUBMITTED, summary="Ask for a job")
async def make_job(
    request: Request, asked: JobRequest, principal: Submitter, context: Context, idempotency_key: IdempotencyKey = None
) -> Response:
    """Check a request and make a job of it, which workers take up.

    Paths of problems within the request begin with its own keys, as those of a check do.
    """
    return await submitted(request, context, principal, Wish(**dict(asked)), idempotency_key)


@router.get("/jobs", summary="The jobs")
async def list_jobs(
    request: Request,
    principal: Reader,
    context: Context,
    state: Annotated[list[State] | None, Query(description="Only those in these states.")] = None,
    kind: Annotated[str | None, Query(json_schema_extra={"enum": list(KINDS)})] = None,
    family: Annotated[str | None, word("Only those that ask it.")] = None,
    q: Annotated[str | None, word("A text in the title, or an id.")] = None,
    parent: Word = None,
    follows: Annotated[
        bool | None, Query(description="Only those that follow from another job, or only those that follow from none.")
    ] = None,
    pinned: bool | None = None,
    limit: Limit = None,
    cursor: Cursor = None,
) -> JobList:
    """List your jobs, the latest first."""
    if kind is not None:
        kind_named(kind)
    if family is not None:
        must_be_family(family)
    states = tuple(state or ())
    most = entries(context, limit)
    scope = [principal.tenant, list(states), kind, family, q, parent, follows, pinned]
    place = place_of(cursor, scope, (float, str))
    jobs = await in_thread(
        context.store.page,
        principal.tenant,
        states=states,
        kind=kind,
        family=family,
        text=q or "",
        parent=parent,
        follows=follows,
        pinned=pinned,
        before=None if place is None else (place[0], place[1]),
        most=most + 1,
    )
    following = cursor_of([jobs[most - 1].created, jobs[most - 1].id], scope) if len(jobs) > most else None
    return JobList(jobs=[job_answer(request, job) for job in jobs[:most]], next=following)


@router.get("/jobs/{job}", response_model=JobAnswer, responses=NOT_MODIFIED, summary="A job")
async def read_job(request: Request, found: OwnJob, principal: Reader) -> Response:
    """Tell how a job stands."""
    content = job_bytes(request, found)
    return tagged(request, content, JSON, tag_of(content))


@router.patch("/jobs/{job}", summary="Change a job")
async def change_job(
    request: Request, found: OwnJob, change: JobChange, principal: Submitter, context: Context
) -> JobAnswer:
    """Give a job another title, or keep it for good."""
    stated = {name: value for name, value in dict(change).items() if value is not None}
    if stated:
        await in_thread(lambda: context.store.change(found.id, **stated))
    return await _again(request, context, found.id, principal)


@router.post("/jobs/{job}/cancel", status_code=202, responses=ENDED, summary="Cancel a job")
async def cancel_job(request: Request, found: OwnJob, principal: Submitter, context: Context) -> JobAnswer:
    """Cancel a job that has not ended; rows of a batch that are answered are kept."""
    if not await in_thread(context.store.cancel, found.id):
        raise ServiceError(409, "the job has ended already", "ended")
    return await _again(request, context, found.id, principal)


@router.post("/jobs/{job}/resume", status_code=202, responses=ENDED, summary="Go on with a job")
async def resume_job(request: Request, found: OwnJob, principal: Submitter, context: Context) -> JobAnswer:
    """Let a job go on that was cancelled or stopped, or has failed.

    A batch goes on with the rows that are not answered, if programs and tables are what they were; all else begins
    anew.
    """
    if found.state in LIVE:
        raise ServiceError(409, f"the job is {found.state}; there is nothing to go on with", "not_ended")
    if found.code is None:
        raise ServiceError(
            409, "only the command line, or the script, that has made this job can go on with it", "not_here"
        )
    sources = await in_thread(TenantFiles(context.store).sources, principal.tenant, found.request)
    told = await context.small.ask(asker_of(principal), CHANGED_TASK, {"content": found.content, "sources": sources})
    if told["changed"]:
        changed = " and ".join(told["changed"])
        raise ServiceError(409, f"not what it was when the job was begun: {changed}; please ask it anew", "changed")
    if not await in_thread(context.store.resume, found.id, principal.tenant, told["code"]):
        raise ServiceError(409, f"only a job that is {RESUMABLE} can go on; this one is {found.state}", "ended")
    return await _again(request, context, found.id, principal)


@router.delete("/jobs/{job}", status_code=204, responses=NEEDED, summary="Remove a job")
async def remove_job(found: OwnJob, principal: Submitter, context: Context) -> None:
    """Remove a job with everything that belongs to it; one that runs is cancelled first.

    One that is kept for good, or that an open job refers to, stays.
    """
    store = context.store
    if found.pinned:
        raise ServiceError(409, "the job is kept for good; take that back first: PATCH it with pinned false", "pinned")
    waiting = await in_thread(store.waits_for, found.id)
    if waiting is not None:
        raise ServiceError(409, f"the job {waiting} needs it; wait for that to end, or cancel it", "in_use")
    await in_thread(store.cancel, found.id)
    if not await in_thread(store.delete, found.id) and await in_thread(store.job, found.id) is not None:
        raise ServiceError(409, "the job was pinned just now", "pinned")


@router.get(
    "/jobs/{job}/request",
    response_model=dict[str, Any],
    responses={200: {"content": {YAML: {"schema": {"type": "string"}}}}},
    summary="What a job asks",
)
async def read_request(request: Request, found: OwnJob, principal: Reader) -> Response:
    """Give the request as it is stored, with all that was not stated written out; as YAML where that is asked for."""
    if wants_yaml(header(request.scope, "accept")):
        return Response(yaml_text(found.request), media_type=YAML, headers={"Vary": "Accept"})
    content = json.dumps(found.request, ensure_ascii=False, allow_nan=False).encode()
    return Response(content, media_type=JSON, headers={"Vary": "Accept"})


def wants_yaml(accept: str) -> bool:
    """True if a client prefers YAML to JSON: it names it, and JSON not before.

    Examples
    --------
    >>> [wants_yaml(text) for text in ("application/yaml", "application/json, application/yaml", "*/*", "")]
    [True, False, False, False]
    """
    named = [entry.partition(";")[0].strip().lower() for entry in accept.split(",")]
    known = [name for name in named if name in (YAML, JSON)]
    return known[:1] == [YAML]


async def _again(request: Request, context: ServiceContext, job: str, principal: Submitter) -> JobAnswer:
    """Return a job as it stands now."""
    found = await in_thread(context.store.job, job, principal.tenant)
    if found is None:
        raise not_found()
    return job_answer(request, found)
