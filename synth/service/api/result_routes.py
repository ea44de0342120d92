"""What came out of jobs: main records, designs as flat rows, and rows of batches."""

from __future__ import annotations

import gzip
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Path, Query, Request, Response

from synth.batches.outputs import GROUPS, RANKING, best_design, explanation_of, status_of
from synth.batches.store import Answered
from synth.batches.views import layouts_of, packed_record, row_at, rows_after
from synth.kinds import kind
from synth.queue.accounts import Principal
from synth.queue.job_table import BATCH
from synth.queue.models import Job
from synth.queue.records import Record, Sources
from synth.service.api.asking import (
    ENDED,
    NOT_MODIFIED,
    Cursor,
    Limit,
    OwnJob,
    accepts_gzip,
    cursor_of,
    entries,
    place_of,
    refuse_live,
    tagged,
    word,
)
from synth.service.api.schemas import ColumnAnswer, DesignPage, RowAnswer, RowPage, RowRecord
from synth.service.auth import Reader
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import JSON, not_found
from synth.service.small_work import asker_of
from synth.workers.engine_tasks import DESIGNS_TASK, RENDER_TASK

router = APIRouter(prefix=API, tags=["results"])
LARGEST_LINE = 2**53
NO_RESULT = "the job has ended without a result"
RowStatus = Literal["optimal", "feasible", "infeasible", "not_found", "not_solved", "refused", "failed", "bad_input"]


@router.get(
    "/jobs/{job}/result",
    response_model=dict[str, Any],
    responses={**NOT_MODIFIED, **ENDED},
    summary="The result of a job",
)
async def read_result(request: Request, found: OwnJob, principal: Reader, context: Context) -> Response:
    """Give the main record of a job: everything else that is shown of it is rendered from records."""
    refuse_live(found)
    name = kind(found.kind).record
    if found.kind == BATCH:
        record = await _summary_of_batch(context, principal, found, name)
        return tagged(request, record.content, JSON, f'"{record.digest}"')
    packed = await in_thread(packed_record, context.store, found.id, name)
    if packed is None:
        raise not_found(NO_RESULT)
    vary = {"Vary": "Accept-Encoding"}
    if accepts_gzip(request):
        own = {**vary, "Content-Encoding": "gzip"}
        return tagged(request, packed.packed, packed.media, f'W/"{packed.digest}"', own)
    return tagged(request, gzip.decompress(packed.packed), packed.media, f'"{packed.digest}"', vary)


async def _summary_of_batch(context: ServiceContext, principal: Principal, job: Job, name: str) -> Record:
    if not job.rows:
        raise not_found(NO_RESULT)
    url = context.store.engine.url.render_as_string(hide_password=False)
    payload = {"job": job.id, "kind": job.kind, "updated": job.updated, "name": name, "sources": Sources(database=url)}
    found: Record = await context.files.ask(asker_of(principal), RENDER_TASK, payload)
    return found


# ---- designs --------------------------------------------------------------------------------------------------------


@router.get("/jobs/{job}/designs", responses=ENDED, summary="The designs of a job")
async def list_designs(
    found: OwnJob,
    principal: Reader,
    context: Context,
    family: Annotated[str | None, word("Of a job that compares several.")] = None,
    where: Annotated[
        str | None, word("A condition on columns.", 10_000, ["mass < '20 kg' and status == 'optimal'"])
    ] = None,
    sort: Annotated[str | None, word("A column; with - before it from the largest.", examples=["-mass"])] = None,
    limit: Limit = None,
    cursor: Cursor = None,
) -> DesignPage:
    """List the designs of a front as flat rows: all that designs.csv says, chosen and ordered."""
    refuse_live(found)
    most = entries(context, limit)
    scope = [found.id, found.updated, family, where, sort]
    place = place_of(cursor, scope, (int,))
    offset = 0 if place is None else place[0]
    kept = await in_thread(context.store.records, found.id)
    if not any(name.endswith(kind("synthesis").record) for name in kept):
        raise not_found("the job has no designs" + ("; see its rows" if found.kind == BATCH else ""))
    payload = {
        "records": {name: record.content for name, record in kept.items()},
        "family": family,
        "where": where,
        "sort": sort,
        "offset": offset,
        "most": most,
    }
    page = await context.small.ask(asker_of(principal), DESIGNS_TASK, payload)
    names = [column["name"] for column in page["columns"]]
    more = offset + most < page["total"]
    return DesignPage(
        total=page["total"],
        columns=[ColumnAnswer(**column) for column in page["columns"]],
        designs=[dict(zip(names, row, strict=True)) for row in page["rows"]],
        next=cursor_of([offset + most], scope) if more else None,
    )


# ---- rows of batches ------------------------------------------------------------------------------------------------


def _refuse_other(job: Job) -> None:
    if job.kind != BATCH:
        raise not_found("only batches have rows")


@router.get("/jobs/{job}/rows", summary="The rows of a batch")
async def list_rows(
    found: OwnJob,
    principal: Reader,
    context: Context,
    status: Annotated[list[RowStatus] | None, Query(description="Only rows that stand so.")] = None,
    limit: Limit = None,
    cursor: Cursor = None,
) -> RowPage:
    """List the rows of a batch, also while it is worked at: how each stands, its best design, or why it has none."""
    _refuse_other(found)
    most = entries(context, limit)
    scope = [found.id, status]
    place = place_of(cursor, scope, (int,))
    after = 0 if place is None else place[0]
    rows = await in_thread(rows_after, context.store, found.id, after, most + 1, tuple(status or ()))
    following = cursor_of([rows[most - 1].line], scope) if len(rows) > most else None
    rows = rows[:most]
    layouts = await in_thread(layouts_of, context.store, found.id, {row.layout for row in rows if row.layout})
    return RowPage(header=_header(found), rows=[_row(row, layouts) for row in rows], next=following)


@router.get("/jobs/{job}/rows/{line}", summary="A row of a batch")
async def read_row(
    found: OwnJob,
    line: Annotated[int, Path(ge=1, le=LARGEST_LINE, description="Its line in the table.")],
    principal: Reader,
    context: Context,
) -> RowRecord:
    """Give a row of a batch in full: what it asks, what is wrong with it, and its designs as far as they are kept."""
    _refuse_other(found)
    there = await in_thread(row_at, context.store, found.id, line)
    if there is None:
        raise not_found()
    row, question = there
    layouts = await in_thread(layouts_of, context.store, found.id, {row.layout} if row.layout else set())
    layout = layouts.get(row.layout or "")
    headings = [*RANKING, *(name for group in GROUPS for name in layout[group])] if layout else []
    columns = [_split(heading) for heading in headings]
    return RowRecord(
        row=_row(row, layouts),
        header=_header(found),
        faults=row.faults,
        question=question,
        columns=columns,
        designs=[
            {column.name: _value(cell, column) for column, cell in zip(columns, cells, strict=True)}
            for cells in (row.content or {}).get("rows", [])
        ],
    )


def _header(job: Job) -> list[str]:
    return [column["title"] for column in job.content.get("columns", ())]


def _split(heading: str) -> ColumnAnswer:
    name, bracket, unit = heading.partition(" [")
    return ColumnAnswer(name=name, unit=unit.removesuffix("]") if bracket else None)


def _value(cell: object, column: ColumnAnswer) -> Any:
    """Return a cell as designs have it: numbers stand as text where rows are kept."""
    if column.unit is None or not isinstance(cell, str):
        return cell
    return float(cell) if cell else None


def _row(row: Answered, layouts: dict[str, dict[str, Any]]) -> RowAnswer:
    content = row.content or {}
    designs = content.get("rows", [])
    shown = best_design(layouts[row.layout], designs[0]) if designs and row.layout in layouts else ""
    return RowAnswer(
        line=row.line,
        key=row.key,
        family=row.family,
        status=status_of(row),
        designs=len(designs),
        seconds=row.seconds,
        certificate=content.get("certificate") or None,
        gap=content.get("gap"),
        best_design=shown,
        explanation=explanation_of(row),
        remarks=row.remarks,
        cells=row.cells,
    )
