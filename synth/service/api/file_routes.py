"""The files of jobs: a closed list for each, made from its records when somebody asks."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from importlib.metadata import version
from typing import Annotated, Any, Literal
from urllib.parse import quote

from fastapi import APIRouter, Path, Query, Request, Response

from synth.folders.csv_style import csv_style
from synth.queue.accounts import Principal
from synth.queue.job_table import BATCH, LIVE
from synth.queue.models import Job
from synth.queue.records import MEDIA, Record
from synth.queue.tenant_files import TenantFiles
from synth.service.api.asking import ENDED, NOT_MODIFIED, OwnJob, knows, refuse_live
from synth.service.api.presenting import job_place
from synth.service.api.schemas import FileAnswer, FileList
from synth.service.auth import Reader
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import not_found
from synth.service.small_work import asker_of
from synth.text.plain_text import as_meant
from synth.workers.engine_tasks import FILES_TASK, RENDER_TASK

router = APIRouter(prefix=API, tags=["results"])
CSV = ".csv"
VERSION = version("clutchsynth")
ANY_FILE: dict[int | str, dict[str, Any]] = {
    200: {"description": "The file.", "content": {media.partition(";")[0]: {"schema": {}} for media in MEDIA.values()}},
    501: {"description": "It needs an extra that is not installed here."},
    **NOT_MODIFIED,
    **ENDED,
}


@router.get("/jobs/{job}/files", summary="The files of a job")
async def list_files(request: Request, found: OwnJob, principal: Reader, context: Context) -> FileList:
    """List the files of a job that can be had here: those that are kept, and those that are made when asked for."""
    place = job_place(request, found.id)
    sizes: dict[str, int | None] = {}
    if found.kind == BATCH:
        sizes = await _files(context, principal, found, {}) if found.rows else {}
    elif found.state not in LIVE:
        kept = await in_thread(context.store.records, found.id)
        sizes = await _files(context, principal, found, {name: record.content for name, record in kept.items()})
    return FileList(
        files=[FileAnswer(name=name, size=size, href=f"{place}/files/{quote(name)}") for name, size in sizes.items()]
    )


async def _files(
    context: ServiceContext, principal: Principal, job: Job, records: dict[str, bytes]
) -> dict[str, int | None]:
    payload = {"kind": job.kind, "records": records}
    found: dict[str, int | None] = await context.small.ask(asker_of(principal), FILES_TASK, payload)
    return found


@router.get("/jobs/{job}/files/{name:path}", response_class=Response, responses=ANY_FILE, summary="A file of a job")
async def read_file(
    request: Request,
    found: OwnJob,
    name: Annotated[str, Path(description="One of those that are listed.", examples=["designs.csv"])],
    principal: Reader,
    context: Context,
    raw: Annotated[
        bool, Query(description="Cells of CSV as they were brought, also those that a spreadsheet would compute.")
    ] = False,
    style: Annotated[
        Literal["en", "de"],
        Query(alias="csv", description="How CSV is written: with commas, or with semicolons and decimal commas."),
    ] = "en",
    length: Annotated[Literal["summary", "normal", "full"] | None, Query(description="Of a report.")] = None,
    full: Annotated[int | None, Query(ge=0, le=1000, description="Designs that a report shows in full.")] = None,
) -> Response:
    """Give a file of a job; of a batch also while it is worked at."""
    if found.kind == BATCH:
        if not found.rows:
            refuse_live(found)
            raise not_found()
    else:
        refuse_live(found)
    options: dict[str, Any] = {key: value for key, value in (("length", length), ("full", full)) if value is not None}
    etag = _tag(found, name, {**options, "raw": raw, "csv": style})
    kept = {} if found.kind == BATCH else await in_thread(context.store.records, found.id)
    if found.state not in LIVE and name in await _known(context, principal, found, kept) and knows(request, etag):
        return Response(status_code=304, headers={"ETag": etag})
    record = await _rendered(context, principal, found, kept, name, options)
    content = as_brought(record.content) if raw and name.endswith(CSV) else record.content
    if name.endswith(CSV) and style != "en":
        content = csv_style(style).text(content.decode()).encode()
    base = name.rsplit("/", 1)[-1]
    headers = {"Content-Disposition": f'attachment; filename="{base}"'}
    if found.state not in LIVE:
        headers["ETag"] = etag
    return Response(content, media_type=record.media, headers=headers)


async def _known(
    context: ServiceContext, principal: Principal, job: Job, kept: dict[str, Record]
) -> dict[str, int | None]:
    return await _files(context, principal, job, {name: record.content for name, record in kept.items()})


async def _rendered(
    context: ServiceContext, principal: Principal, job: Job, kept: dict[str, Record], name: str, options: dict[str, Any]
) -> Record:
    sources = await in_thread(TenantFiles(context.store).sources, job.tenant, job.request)
    payload = {
        "job": job.id,
        "kind": job.kind,
        "updated": job.updated,  # a late answer is none to what is asked after the job went on
        "records": {own: record.content for own, record in kept.items()},
        "name": name,
        "options": options,
        "sources": sources,
    }
    found: Record | None = await context.files.ask(asker_of(principal), RENDER_TASK, payload)
    if found is None:
        raise not_found()
    return found


def _tag(job: Job, name: str, options: dict[str, Any]) -> str:
    """Return the tag of a file: it follows from what the job has found, from this program and from what is asked."""
    told = json.dumps([job.id, job.ended, name, options, VERSION], sort_keys=True)
    return f'"{hashlib.sha256(told.encode()).hexdigest()[:32]}"'


def as_brought(content: bytes) -> bytes:
    """Return a CSV file without what keeps spreadsheets from computing its texts.

    Examples
    --------
    >>> as_brought(b"'=1+1,-5.3").decode().strip()
    '=1+1,-5.3'
    """
    buffer = io.StringIO(newline="")
    writer = csv.writer(buffer, lineterminator="\n")
    for cells in csv.reader(io.StringIO(content.decode(), newline="")):
        writer.writerow([as_meant(cell) for cell in cells])
    return buffer.getvalue().encode()
