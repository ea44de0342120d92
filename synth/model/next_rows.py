"""The row of a table that is next to a quantity, and the row of another table that goes with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from synth.margins import MARGINS
from synth.results.next_row import NextRow

if TYPE_CHECKING:
    from synth.declaration.records import NextRowRecord
    from synth.tables.catalogs import Catalogs


def next_row(record: NextRowRecord, needed: float, catalogs: Catalogs) -> NextRow:
    """Return the row whose column is smallest but not below what is needed, as results tell it.

    Parameters
    ----------
    record : NextRowRecord
        What was declared.
    needed : float
        SI.
    catalogs : Catalogs
        The tables in force.
    """
    table = catalogs.table(record.table)
    column = table.number(record.column)
    # A size that was typed in another unit than that of the table differs in its last digits.
    offered = np.where(column >= needed * (1 - MARGINS.same), column, np.inf)
    index = int(np.argmin(offered)) if len(offered) else -1
    found = index >= 0 and bool(np.isfinite(offered[index]))
    beside = record.beside
    value = float(column[index]) if found else None
    with np.errstate(all="ignore"):
        last = float(np.fmax.reduce(column)) if len(column) else np.nan
    return NextRow(
        needed=needed,
        unit=record.unit,
        table=record.table,
        designation=table.designations[index] if found else None,
        value=value,
        last=None if np.isnan(last) else last,
        beside_table=None if beside is None else beside.table,
        beside=None
        if beside is None or value is None
        else _row_around(beside.table, beside.over, beside.up_to, value, catalogs),
    )


def _row_around(name: str, over: str, up_to: str, value: float, catalogs: Catalogs) -> str | None:
    """Return the designation of the row of a table whose range holds a value; None where none does."""
    table = catalogs.table(name)
    margin = abs(value) * MARGINS.same
    holds = (table.number(over) + margin < value) & (value <= table.number(up_to) + margin)
    index = int(np.argmax(holds)) if len(holds) else -1
    return table.designations[index] if index >= 0 and holds[index] else None
