"""The part tables that come with the families."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response
from pydantic import BaseModel

from synth.service.api.asking import LONGEST, NOT_MODIFIED, tagged_json
from synth.service.api.family_routes import listed
from synth.service.auth import Reader
from synth.service.context import API, Context
from synth.service.errors import not_found
from synth.service.small_work import asker_of
from synth.service.wording import WORD
from synth.workers.engine_tasks import TABLES_TASK

router = APIRouter(prefix=API, tags=["catalogues"])


class TableEntry(BaseModel):
    """A table as lists show it."""

    name: str
    rows: int
    families: list[str]


class TableList(BaseModel):
    """All tables that come with the families."""

    tables: list[TableEntry]


class ShippedColumn(BaseModel):
    """A column of a part table; `lower` and `upper` are what is plausible, in its unit."""

    name: str
    unit: str | None
    symbol: str
    text: str
    lower: float | None
    upper: float | None


class TableAnswer(BaseModel):
    """A table: cells in the units of the columns, nothing where a value is not known."""

    name: str
    families: list[str]
    columns: list[ShippedColumn]
    rows: list[list[float | str | None]]


@router.get("/tables", response_model=TableList, responses=NOT_MODIFIED, summary="Tables of the families")
async def list_tables(request: Request, principal: Reader, context: Context) -> Response:
    """Tell which part tables there are before anybody brings one, and which families take parts from them."""
    return await listed(request, context, principal, TABLES_TASK, "tables")


@router.get("/tables/{name}", response_model=TableAnswer, responses=NOT_MODIFIED, summary="One of these tables")
async def read_table(
    request: Request,
    name: Annotated[str, Path(max_length=LONGEST, pattern=WORD, description="Name of a table.")],
    principal: Reader,
    context: Context,
) -> Response:
    """Give a part table with its units, and with source and confidence of each row."""
    found = await context.facts.get(asker_of(principal), TABLES_TASK)
    if name not in found["contents"]:
        raise not_found()
    return tagged_json(request, found["contents"][name], found["code"])
