"""Tables of requirements: brought, checked before they are asked, and asked."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Body, File, Query, Request, Response, UploadFile

from synth.batches.views import uploads_kept
from synth.errors import InputError
from synth.queue.job_table import BATCH
from synth.queue.tenant_files import TenantFiles
from synth.service.api.job_routes import SUBMITTED, IdempotencyKey, submitted
from synth.service.api.schemas import EXAMPLES, BatchCheck, FirstRow, JobAnswer, UploadAnswer
from synth.service.api.submission import Wish
from synth.service.api.uploads import FIELD, plain_name, taken
from synth.service.auth import Reader, Submitter
from synth.service.context import API, Context, in_thread
from synth.service.errors import ServiceError, again, not_found
from synth.service.security import FILE_BODY
from synth.service.small_work import asker_of
from synth.workers.engine_tasks import CHECK_ROWS_TASK, UPLOAD_TASK

router = APIRouter(prefix=API, tags=["batches"])
HOUR = 3600.0  # s
FORM = {"requestBody": {"content": {FILE_BODY: {"examples": {"rows": {"value": {FIELD: EXAMPLES["upload"]}}}}}}}
BatchBody = Annotated[
    dict[str, Any],
    Body(
        openapi_examples={"rows": {"value": EXAMPLES["batch"]}},
        description="`upload` (the id of a file) or `rows`, and what is asked of all: family, mapping, objectives, ...",
    ),
]


@router.post("/uploads", status_code=201, summary="Bring a file with rows", openapi_extra=FORM)
async def bring_file(
    principal: Submitter,
    context: Context,
    file: Annotated[UploadFile, File(description="CSV as spreadsheets write it, or an .xlsx workbook.")],
    encoding: Annotated[str, Query(max_length=40, description="Of a CSV file, where it is not recognised.")] = "",
    visible: Annotated[bool, Query(description="Leave out hidden and filtered rows of a workbook.")] = False,
) -> UploadAnswer:
    """Keep a file for a day, to be asked as a batch; its content says what it is, not its name."""
    settings, shelf = context.settings, TenantFiles(context.store)
    if await in_thread(uploads_kept, context.store, principal.tenant) >= settings.tenant_uploads:
        message = f"{settings.tenant_uploads} files are kept, as many as you may have; they go by themselves"
        raise ServiceError(429, message, headers=again(HOUR))
    content = await file.read()
    ending, content = await in_thread(taken, content, settings, encoding, visible)
    name = plain_name(file.filename, ending)
    payload = {"name": name, "content": content, "most": settings.upload_shown}
    try:
        told = await context.files.ask(asker_of(principal), UPLOAD_TASK, payload)
    except InputError as fault:
        fault.path = (FIELD,)
        raise
    number = await in_thread(shelf.add_upload, principal.tenant, name, content, HOUR * settings.upload_hours)
    kept = await in_thread(shelf.upload, principal.tenant, number)
    if kept is None:
        raise not_found()
    return UploadAnswer(
        id=kept.id,
        name=kept.name,
        size=kept.size,
        digest=kept.digest,
        expires=kept.expires,
        reading=told["reading"],
        header=told["header"],
        rows=[FirstRow(**row) for row in told["rows"]],
    )


@router.post("/batches/check", summary="Check a table")
async def check_batch(asked: BatchBody, principal: Reader, context: Context) -> BatchCheck:
    """Tell how a table is understood, and which of its rows cannot be asked; of a long one the first rows."""
    sources = await in_thread(TenantFiles(context.store).sources, principal.tenant, asked)
    payload = {"request": asked, "sources": sources}
    told = await context.files.ask(asker_of(principal), CHECK_ROWS_TASK, payload)
    return BatchCheck.model_validate(told)


@router.post("/batches", status_code=202, response_model=JobAnswer, responses=SUBMITTED, summary="Ask for a batch")
async def make_batch(
    request: Request, asked: BatchBody, principal: Submitter, context: Context, idempotency_key: IdempotencyKey = None
) -> Response:
    """Ask all rows of a table: a job of the kind batch. The same table, asked the same way, is the same job."""
    return await submitted(request, context, principal, Wish(kind=BATCH, request=asked), idempotency_key)
