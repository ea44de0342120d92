"""The row of a table that is next to a quantity, and the row of another table that goes with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from synth.order.margins import MARGINS
from synth.results.next_row import NextRow

if TYPE_CHECKING:
    from synth.declaration.records import NextRowRecord
    from synth.tables.catalogs import Catalogs
    from synth.tables.table import Table


def next_row(record: NextRowRecord, needed: float, catalogs: Catalogs) -> NextRow:
    """Row with the smallest value of a column that is not below the needed one.

    Parameters
    ----------
    record : NextRowRecord
        What was declared.
    needed : float
        What the design needs, or the size that was typed; SI.
    catalogs : Catalogs
        The tables in force.
    """
    table = catalogs.table(record.table)
    column = table.number(record.column)
    # A size that was typed in another unit than that of the table differs in its last digits.
    offered = np.where(column >= needed * (1 - MARGINS.same), column, np.inf)
    index = int(np.argmin(offered)) if len(offered) else -1
    has_row = index >= 0 and bool(np.isfinite(offered[index]))
    companion = record.beside
    value = float(column[index]) if has_row else None
    with np.errstate(all="ignore"):
        last = float(np.fmax.reduce(column)) if len(column) else np.nan
    return NextRow(
        needed=needed,
        typed=record.typed,
        unit=record.unit,
        table=record.table,
        designation=table.designations[index] if has_row else None,
        value=value,
        last=None if np.isnan(last) else last,
        beside_table=None if companion is None else companion.table,
        beside=None
        if companion is None or value is None
        else _row_around(companion.table, companion.over, companion.up_to, value, catalogs),
    )


def rows_read(record: NextRowRecord, match: NextRow, catalogs: Catalogs) -> list[tuple[str, int]]:
    """Return rows that are enough to find the same row again: tables, and numbers of rows in them.

    Where no row fits it is one that does not, the largest if it is by size.
    """
    table = catalogs.table(record.table)
    rows = [(record.table, _number_of(table, match.designation, table.number(record.column)))]
    if record.beside is not None:
        companion = catalogs.table(record.beside.table)
        rows.append((record.beside.table, _number_of(companion, match.beside, companion.number(record.beside.up_to))))
    return [(name, row) for name, row in rows if row >= 0]


def _number_of(table: Table, designation: str | None, column: np.ndarray) -> int:
    """Return the number of a row; without a designation that of the largest value, -1 where the table has no row."""
    if designation is not None:
        return table.row_index(designation)
    return int(np.argmax(np.where(np.isnan(column), -np.inf, column))) if len(column) else -1


def _row_around(name: str, over: str, up_to: str, value: float, catalogs: Catalogs) -> str | None:
    """Return the designation of the row of a table whose range holds a value; None where none does."""
    table = catalogs.table(name)
    margin = abs(value) * MARGINS.same
    holds = (table.number(over) + margin < value) & (value <= table.number(up_to) + margin)
    index = int(np.argmax(holds)) if len(holds) else -1
    return table.designations[index] if index >= 0 and holds[index] else None
