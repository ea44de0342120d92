"""Part tables of one's own, in versions that are never changed."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response

from synth.errors import InputError
from synth.queue.accounts import Principal
from synth.queue.models import Catalogue
from synth.queue.tenant_files import NAME, TenantFiles, text_of
from synth.service.api.schemas import (
    BroughtCatalogue,
    CatalogueAnswer,
    CatalogueDiff,
    CatalogueEntry,
    CatalogueList,
    CatalogueRequest,
    ChangedCell,
)
from synth.service.auth import Reader, Submitter
from synth.service.context import API, Context, ServiceContext, in_thread
from synth.service.errors import ServiceError, not_found
from synth.service.small_work import asker_of
from synth.tables.delimited_text import delimited_text
from synth.workers.engine_tasks import PART_TABLE_TASK, TABLE_TEXT_TASK

router = APIRouter(prefix=API, tags=["catalogues"])
LARGEST_VERSION = 999_999_999  # as references have it
SHOWN_USES = 3
Name = Annotated[str, Path(description="By which questions name it.", examples=["my_linings"])]
Version = Annotated[int, Path(ge=1, le=LARGEST_VERSION)]
KEPT: dict[int | str, dict[str, Any]] = {409: {"description": "It has the same content as the latest version."}}
USED: dict[int | str, dict[str, Any]] = {409: {"description": "Jobs refer to it."}}


@router.get("/catalogues", summary="Your part tables")
async def list_catalogues(principal: Reader, context: Context) -> CatalogueList:
    """List all versions of the part tables that you have brought."""
    found = await in_thread(TenantFiles(context.store).catalogues, principal.tenant)
    return CatalogueList(catalogues=[_entry(one) for one in found])


@router.post("/catalogues", status_code=201, responses=KEPT, summary="Bring a part table")
async def add_catalogue(
    request: Request, response: Response, asked: CatalogueRequest, principal: Submitter, context: Context
) -> BroughtCatalogue:
    """Keep a part table as the next version of its name, after it was read as questions will read it.

    Its rows stand in `csv`, or in a file that was brought (`POST /uploads`) and is named as `upload`.
    The answer tells how it was read, which columns no family knows, and what slots of families lack in it.
    """
    if not NAME.fullmatch(asked.name):
        right = "up to 60 letters, digits, _, . or -, the first a letter, digit or _"
        raise InputError("name", asked.name, right, ("name",))
    table = asked.table or asked.name
    csv = await _text(asked, principal, context)
    payload = {"name": asked.name, "table": table, "csv": csv, "schema": asked.schema_}
    told = await context.files.ask(asker_of(principal), PART_TABLE_TASK, payload)
    shelf = TenantFiles(context.store)
    added, is_new = await in_thread(
        shelf.add_catalogue, principal.tenant, asked.name, table, csv, asked.schema_, told["rows"], asked.note
    )
    place = f"{request.app.url_path_for('list_catalogues')}/{added.name}/{added.version}"
    if not is_new:
        same = f"{added.name}@{added.version} has the same content"
        raise ServiceError(409, same, "same_content", headers={"Location": place})
    response.headers["Location"] = place
    understood = {key: told[key] for key in ("reading", "columns", "missing", "remarks")}
    return BroughtCatalogue(**_entry(added).model_dump(), **understood)


async def _text(asked: CatalogueRequest, principal: Principal, context: ServiceContext) -> str:
    """Return the rows that are brought, as text.

    Raises
    ------
    InputError
        There are none, or there are two; the file is not there, or cannot be read.
    """
    if bool(asked.csv) == bool(asked.upload):
        got = "both" if asked.csv else None
        raise InputError("csv", got, "the rows as text, or upload with the id of a file that was brought", ("csv",))
    if not asked.upload:
        return asked.csv
    kept = await in_thread(TenantFiles(context.store).upload, principal.tenant, asked.upload)
    if kept is None:
        raise InputError("upload", asked.upload, "the id of a file that was brought and is still kept", ("upload",))
    payload = {"name": kept.name, "content": kept.content, "sheet": asked.sheet}
    try:
        return str(await context.files.ask(asker_of(principal), TABLE_TEXT_TASK, payload))
    except InputError as fault:
        fault.path = ("upload",)
        raise


@router.get("/catalogues/{name}/{version}", summary="A version of a part table")
async def read_catalogue(name: Name, version: Version, principal: Reader, context: Context) -> CatalogueAnswer:
    """Give a version of a part table, and the jobs that name it."""
    found = await _own(context, principal.tenant, name, version)
    text = text_of(found)
    used = await in_thread(TenantFiles(context.store).uses, principal.tenant, text.reference)
    written = delimited_text(text.csv.encode(), text.reference)
    return CatalogueAnswer(
        entry=_entry(found), csv=text.csv, separator=written.delimiter, schema=text.schema, used_by=used
    )


@router.get("/catalogues/{name}/{version}/changes", summary="What a version has changed")
async def compare_catalogues(
    name: Name,
    version: Version,
    principal: Reader,
    context: Context,
    since: Annotated[int, Query(ge=1, le=LARGEST_VERSION, description="The version that it is compared with.")],
) -> CatalogueDiff:
    """Tell which rows and cells differ between two versions of a part table."""
    after = await _own(context, principal.tenant, name, version)
    before = await _own(context, principal.tenant, name, since)
    return await in_thread(difference, before, after)


@router.delete("/catalogues/{name}/{version}", status_code=204, responses=USED, summary="Remove a version")
async def remove_catalogue(name: Name, version: Version, principal: Submitter, context: Context) -> None:
    """Remove a version of a part table that no job names."""
    found = await _own(context, principal.tenant, name, version)
    shelf = TenantFiles(context.store)
    used = await in_thread(shelf.uses, principal.tenant, f"{found.name}@{found.version}")
    if used:
        shown = ", ".join(used[:SHOWN_USES])
        raise ServiceError(409, f"{len(used)} jobs refer to it, such as {shown}", "in_use")
    await in_thread(shelf.remove_catalogue, principal.tenant, name, version)


async def _own(context: ServiceContext, tenant: int, name: str, version: int) -> Catalogue:
    found = None
    if NAME.fullmatch(name):
        found = await in_thread(TenantFiles(context.store).catalogue, tenant, name, version)
    if found is None:
        raise not_found()
    return found


def _entry(found: Catalogue) -> CatalogueEntry:
    return CatalogueEntry(
        name=found.name,
        version=found.version,
        reference=f"{found.name}@{found.version}",
        table=found.table,
        rows=found.rows,
        digest=found.digest,
        created=found.created,
        note=found.note,
    )


def difference(before: Catalogue, after: Catalogue) -> CatalogueDiff:
    """Differences between two versions: rows are known by their first cell, columns by their heading."""
    old, new = _cells(text_of(before).csv), _cells(text_of(after).csv)
    old_columns, new_columns = _columns(old), _columns(new)
    both = [column for column in new_columns if column in old_columns]
    return CatalogueDiff(
        before=_entry(before),
        after=_entry(after),
        added=[name for name in new if name not in old],
        removed=[name for name in old if name not in new],
        changed=[
            ChangedCell(designation=name, column=column, before=old[name][column], after=new[name][column])
            for name in new
            if name in old
            for column in both
            if old[name][column] != new[name][column]
        ],
        columns_added=[column for column in new_columns if column not in old_columns],
        columns_removed=[column for column in old_columns if column not in new_columns],
    )


def _cells(text: str) -> dict[str, dict[str, str]]:
    """Return the rows of a table by their first cell."""
    lines = [cells for _, cells in delimited_text(text.encode(), "table").lines()]
    header, *rows = [[cell.strip() for cell in line] for line in lines if any(line)]
    return {row[0]: dict(zip(header, [*row, *[""] * (len(header) - len(row))], strict=False)) for row in rows}


def _columns(rows: dict[str, dict[str, str]]) -> list[str]:
    return list(next(iter(rows.values()))) if rows else []
