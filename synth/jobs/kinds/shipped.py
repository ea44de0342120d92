"""The part tables that come with the families, as pages and programs read them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.jobs.engine_tasks import Tell
from synth.model.registry import families, load
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from synth.tables.schema import Column
from synth.tables.table import Table
from synth.units import finite_from_si


def tables(payload: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return all tables: name, number of rows, and the families whose parts are rows of it; and their digest."""
    shipped = Catalogs()
    users = _users()
    found = [
        {"name": name, "rows": len(shipped.table(name)), "families": users.get(name, [])} for name in shipped.names()
    ]
    return {"tables": found, "code": shipped.digest()}


def table(payload: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return a table with what its columns are, each cell as it stands in the file; None where there is none."""
    shipped = Catalogs()
    if payload["table"] not in shipped.names():
        return {"table": None, "code": shipped.digest()}
    found = shipped.table(payload["table"])
    told = {
        "name": found.name,
        "families": _users().get(found.name, []),
        "columns": [
            {
                "name": column.name,
                "unit": column.unit,
                "symbol": column.symbol,
                "text": column.description,
                "lower": column.minimum,
                "upper": column.maximum,
            }
            for column in found.columns.values()
        ],
        "rows": [_cells(found, index) for index in range(len(found))],
    }
    return {"table": told, "code": shipped.digest()}


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
    for name in families():
        declared = load(name).declaration(frozenset(), as_catalogs(None))
        for one in sorted({slot.table for slot in declared.slots.values()}):
            users.setdefault(one, []).append(name)
    return users
