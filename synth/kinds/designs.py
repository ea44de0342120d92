"""The designs of a front as flat rows: some of them, chosen by a condition on their columns, and in an order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.errors import InputError
from synth.kinds.asked import front_in
from synth.queue.records import ReportProgress
from synth.results.plain import finite
from synth.tables.conditions import parse_condition
from synth.tables.schema import Column
from synth.tables.table import Table, perhaps_meant
from synth.units import split_header, to_si

NAME = "designs"
DOWN = "-"


def page(payload: Mapping[str, Any], tell: ReportProgress) -> dict[str, Any]:
    """Return some designs of a front.

    Parameters
    ----------
    payload : mapping
        ``records`` of the job, ``family`` where it compares several, ``where`` and ``sort`` (the name of a column,
        with ``-`` before it from the largest) or None, ``offset`` and ``most``.
    tell : callable

    Returns
    -------
    dict
        ``columns`` with name and unit, ``rows`` with the values in these units, None where there is none, and
        ``total``: how many fit the condition.

    Raises
    ------
    InputError
        There is no front, or the condition or the order is wrong.
    """
    headings, rows = front_in(payload["records"], payload["family"]).table()
    columns = [_column(heading, [row[k] for row in rows]) for k, heading in enumerate(headings)]
    order = list(range(len(rows)))
    if payload["where"] is not None:
        order = _fitting(payload["where"], columns, rows)
    if payload["sort"] is not None:
        order = _sorted(payload["sort"], columns, rows, order)
    chosen = order[payload["offset"] : payload["offset"] + payload["most"]]
    return {
        "columns": [{"name": column.name, "unit": column.unit} for column in columns],
        "rows": [[_cell(value) for value in rows[k]] for k in chosen],
        "total": len(order),
    }


def _column(heading: str, cells: Sequence[Any]) -> Column:
    name, unit = split_header(heading)
    text = any(isinstance(cell, str) for cell in cells)
    return Column(name=name, type="text" if text else "number", unit=None if text else unit)


def _cell(value: object) -> Any:
    return finite(value) if isinstance(value, float) else value


def _fitting(where: str, columns: Sequence[Column], rows: Sequence[Sequence[Any]]) -> list[int]:
    """Return the numbers of the rows for which a condition holds."""
    data: dict[str, Any] = {}
    for k, column in enumerate(columns):
        cells = [row[k] for row in rows]
        if column.numeric:
            numbers = np.array([np.nan if cell is None else float(cell) for cell in cells])
            data[column.name] = to_si(numbers, column.scale)
        else:
            data[column.name] = tuple("" if cell is None else str(cell) for cell in cells)
    labels = [f"design {k + 1}" for k in range(len(rows))]
    own = np.ones(len(rows), dtype=np.bool_)
    table = Table(NAME, {column.name: column for column in columns}, data, labels, NAME, own)
    try:
        return [int(k) for k in np.flatnonzero(parse_condition(where).mask(table))]
    except InputError as fault:
        fault.path = ("where",)
        raise


def _sorted(sort: str, columns: Sequence[Column], rows: Sequence[Sequence[Any]], order: list[int]) -> list[int]:
    """Return rows in the order of a column; those without a value come last."""
    name = sort.removeprefix(DOWN)
    names = [column.name for column in columns]
    if name not in names:
        right = f"a column of the designs, {perhaps_meant(name, names)}"
        raise InputError("sort", name, right, ("sort",))
    k = names.index(name)
    there = [row for row in order if rows[row][k] not in (None, "")]
    missing = [row for row in order if rows[row][k] in (None, "")]
    return sorted(there, key=lambda row: rows[row][k], reverse=sort.startswith(DOWN)) + missing
