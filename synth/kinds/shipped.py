"""The part tables that come with the families, as pages and programs read them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from synth.model.registry import every_declaration
from synth.question.catalogs import as_catalogs
from synth.queue.records import ReportProgress
from synth.tables.catalogs import Catalogs
from synth.tables.schema import Column
from synth.tables.table import Table
from synth.units import finite_from_si


def tables(payload: Mapping[str, Any], tell: ReportProgress) -> dict[str, Any]:
    """All tables, as a list and with their rows, and the digest of their files.

    ``tables``: name, number of rows, and the families whose parts are rows of it; ``contents``: by name, with what the
    columns are, each cell as it stands in the file.
    """
    shipped, users = Catalogs(), _users()
    found = [shipped.table(name) for name in shipped.names()]
    return {
        "tables": [{"name": one.name, "rows": len(one), "families": users.get(one.name, [])} for one in found],
        "contents": {one.name: _content(one, users.get(one.name, [])) for one in found},
        "code": shipped.digest(),
    }


def _content(table: Table, users: Sequence[str]) -> dict[str, Any]:
    return {
        "name": table.name,
        "families": list(users),
        "columns": [
            {
                "name": column.name,
                "unit": column.unit,
                "symbol": column.symbol,
                "text": column.description,
                "lower": column.minimum,
                "upper": column.maximum,
            }
            for column in table.columns.values()
        ],
        "rows": [_cells(table, index) for index in range(len(table))],
    }


def _cells(found: Table, index: int) -> list[float | str | None]:
    row = found.row(index)
    return [_cell(row[name], column) for name, column in found.columns.items()]


def _cell(value: float | str | None, column: Column) -> float | str | None:
    """Return a cell in the unit of its column; where the unit stands in another cell, as it is."""
    if not isinstance(value, float) or column.unit is None or column.unit not in column.heading:
        return value
    return finite_from_si(value, column.unit, None)


def _users() -> dict[str, list[str]]:
    """Return the families that take parts from a table, by table."""
    users: dict[str, list[str]] = {}
    for problem, declared in every_declaration(as_catalogs(None)):
        for one in sorted({slot.table for slot in declared.slots.values()}):
            users.setdefault(one, []).append(problem.name)
    return users
