"""A catalogue table: rows with designations, columns of numbers in SI or of text.

A shipped table is read strictly against ``NAME.schema.csv``; every row names its source. A user's own table is met with
defaults: other units of the same kind are converted, further columns are kept, columns and cells that are missing stay
missing. Whatever is wrong is told with file, line and column.

Numbers are SI inside. An empty cell is nan in a column of numbers and the empty text in a column of text.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import InputError
from synth.tables.schema import Column
from synth.text.plain_text import as_meant
from synth.text.row_cells import CODE_OF, ELSE, text_code
from synth.units import from_si

if TYPE_CHECKING:
    import pandas as pd

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
SHIPPED = "shipped"


def row_hash(cells: Mapping[str, float | str | None]) -> str:
    """SHA-256 of the cells of a row, without those that are empty."""
    content = {name: value for name, value in cells.items() if value is not None}
    canonical = json.dumps(content, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    return hashlib.sha256(canonical.encode("utf-8", "surrogatepass")).hexdigest()


class Table:
    """A table in memory; never changed after it is made.

    Parameters
    ----------
    name : str
        Name of the table.
    columns : mapping of str to Column
        The columns that are there.
    data : mapping of str to ndarray or tuple of str
        SI floats of each numeric column, texts of the others.
    labels : sequence of str
        Where each row comes from, for messages (``metals.csv, line 4``).
    origin : str
        ``shipped``, a file name or ``DataFrame``.
    user_rows : ndarray of bool
        True for rows that are not shipped.

    Attributes
    ----------
    readings : tuple of str
        How files that are not written as is expected were read, in sentences.
    """

    def __init__(
        self,
        name: str,
        columns: Mapping[str, Column],
        data: Mapping[str, FloatArray | tuple[str, ...]],
        labels: Sequence[str],
        origin: str,
        user_rows: BoolArray,
    ) -> None:
        self.name = name
        self.columns = dict(columns)
        self.origin = origin
        self.labels = tuple(labels)
        self.readings: tuple[str, ...] = ()
        self.user_rows = np.array(user_rows, dtype=np.bool_)
        self.user_rows.setflags(write=False)
        self._made: dict[Any, BoolArray] = {}
        self._data: dict[str, FloatArray | tuple[str, ...]] = {}
        for column, cells in data.items():
            if isinstance(cells, np.ndarray):
                numbers = np.array(cells, dtype=np.float64)
                numbers.setflags(write=False)
                self._data[column] = numbers
            else:
                self._data[column] = tuple(cells)

    def __len__(self) -> int:
        return len(self.labels)

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self)} rows, {len(self.columns)} columns, {self.origin}>"

    def once(self, key: object, make: Callable[[], BoolArray]) -> BoolArray:
        """Return a mask of the rows that is made once per table.

        Parameters
        ----------
        key : hashable
            What the mask tells.
        make : callable
            Makes it.
        """
        if key not in self._made:
            mask = make()
            mask.setflags(write=False)
            self._made[key] = mask
        return self._made[key]

    @cached_property
    def _symbols(self) -> dict[str, str]:
        return {column.symbol: name for name, column in reversed(self.columns.items()) if column.symbol}

    def _find(self, column: str) -> str | None:
        return column if column in self.columns else self._symbols.get(column)

    def has(self, column: str) -> bool:
        """Whether the table has a column of this name or symbol."""
        return ELSE in column or self._find(column.removeprefix(CODE_OF)) is not None

    def column(self, name: str) -> Column:
        """Find a column by its name or symbol.

        Parameters
        ----------
        name : str
            Name, or symbol of the schema.

        Returns
        -------
        Column
            The column.

        Raises
        ------
        InputError
            There is none; close names are listed.
        """
        key = self._find(name)
        if key is None:
            raise InputError(f"table {self.name}", name, f"a column of this table, {perhaps_meant(name, self.columns)}")
        return self.columns[key]

    def number(self, column: str) -> FloatArray:
        """SI values of a column of numbers.

        Parameters
        ----------
        column : str
            Name or symbol.

        Returns
        -------
        ndarray
            SI floats, nan where the cell is empty.

        Raises
        ------
        InputError
            No such column, or a column of text.

        Notes
        -----
        Behind CODE_OF stands a column of text, whose cells are told by their ``text_code``. Behind ELSE stands the
        number that counts in rows without a value, and in all rows where the table has no such column.
        """
        if column.startswith(CODE_OF):
            return np.array([text_code(cell) for cell in self.text(column.removeprefix(CODE_OF))])
        if ELSE in column:
            name, _, other = column.partition(ELSE)
            known = self.number(name) if self.has(name) else np.full(len(self), np.nan)
            return np.where(np.isnan(known), float(other), known)
        match = self.column(column)
        cells = self._data[match.name]
        if not isinstance(cells, np.ndarray):
            raise InputError(f"table {self.name}", column, "a column of numbers; this one is text")
        return cells

    def text(self, column: str) -> tuple[str, ...]:
        """Cells of a column of text.

        Parameters
        ----------
        column : str
            Name or symbol.

        Returns
        -------
        tuple of str
            Texts, empty where the cell is empty.

        Raises
        ------
        InputError
            No such column, or a column of numbers.
        """
        match = self.column(column)
        cells = self._data[match.name]
        if isinstance(cells, np.ndarray):
            raise InputError(f"table {self.name}", column, "a column of text; this one has numbers")
        return cells

    def empty(self, column: str) -> BoolArray:
        """Rows whose cell in a column is empty; InputError where there is no such column."""
        cells = self._data[self.column(column).name]
        return np.isnan(cells) if isinstance(cells, np.ndarray) else np.array([not cell for cell in cells], dtype=bool)

    @property
    def designations(self) -> tuple[str, ...]:
        """Designation of each row; empty for a table of data that has none."""
        return self.text("designation") if "designation" in self.columns else ()

    @cached_property
    def _rows(self) -> dict[str, int]:
        return {designation: i for i, designation in enumerate(self.designations)}

    def row_index(self, designation: str) -> int:
        """Row number of a designation.

        Parameters
        ----------
        designation : str
            As it stands in the table.

        Returns
        -------
        int
            Row number from 0.

        Raises
        ------
        InputError
            There is none; close designations are listed.
        """
        if designation not in self._rows:
            designation = as_meant(designation)  # as a table that we have written shows it
        if designation not in self._rows:
            known = f"a designation of this table, {perhaps_meant(str(designation), self.designations)}"
            raise InputError(
                f"table {self.name}", designation, known if self.designations else "a table with designations"
            )
        return self._rows[designation]

    def row(self, index: int) -> dict[str, float | str | None]:
        """Cells of one row.

        Parameters
        ----------
        index : int
            Row number from 0.

        Returns
        -------
        dict
            Column name to SI float or text; None where the cell is empty.
        """
        cells: dict[str, float | str | None] = {}
        for name, values in self._data.items():
            if isinstance(values, np.ndarray):
                number = float(values[index])
                cells[name] = None if math.isnan(number) else number
            else:
                cells[name] = values[index] or None
        return cells

    @cached_property
    def hashes(self) -> tuple[str, ...]:
        """SHA-256 of the content of each row: SI values and texts, without regard to the order or unit of columns."""
        return tuple(row_hash(self.row(i)) for i in range(len(self)))

    def select(self, indices: Sequence[int] | NDArray[np.int_] | BoolArray) -> Table:
        """Give the table with some of its rows only.

        Parameters
        ----------
        indices : sequence of int or ndarray
            Row numbers in the wanted order, or a mask.

        Returns
        -------
        Table
            A new table.
        """
        rows = np.asarray(indices)
        chosen = np.flatnonzero(rows) if rows.dtype == np.bool_ else rows.astype(np.intp)
        data: dict[str, FloatArray | tuple[str, ...]] = {
            name: cells[chosen] if isinstance(cells, np.ndarray) else tuple(cells[i] for i in chosen)
            for name, cells in self._data.items()
        }
        labels = [self.labels[i] for i in chosen]
        return Table(self.name, self.columns, data, labels, self.origin, self.user_rows[chosen])

    def to_frame(self) -> pd.DataFrame:
        """Give the table as a DataFrame with units in its headers.

        Returns
        -------
        pandas.DataFrame
            Numbers in the unit of the header, nan or None where a cell is empty.
        """
        import pandas as pd

        frame: dict[str, Any] = {}
        for name, cells in self._data.items():
            column = self.columns[name]
            if isinstance(cells, np.ndarray):
                frame[column.heading] = from_si(cells, column.scale)
            else:
                frame[column.heading] = pd.Series([cell or None for cell in cells], dtype=object)
        return pd.DataFrame(frame)

    def extended(self, more: Table) -> Table:
        """Append the rows of another table.

        Parameters
        ----------
        more : Table
            Rows to append; columns that only one of the two has stay empty in the rows of the other.

        Returns
        -------
        Table
            A new table.

        Raises
        ------
        InputError
            A designation stands in both, or a column is of another kind.
        """
        for designation, label in zip(more.designations, more.labels, strict=False):
            if designation in self._rows:
                there = self.labels[self._rows[designation]]
                raise InputError(
                    f"{label}, column designation", designation, f"a new designation (it stands in {there})"
                )
        columns = {**self.columns, **{name: c for name, c in more.columns.items() if name not in self.columns}}
        data: dict[str, FloatArray | tuple[str, ...]] = {}
        for name, column in columns.items():
            other = more.columns.get(name, column)
            if other.numeric != column.numeric or other.scale.kind != column.scale.kind:
                raise InputError(
                    f"{more.origin}, column {name}", other.heading, f"{column.heading}, as in {self.origin}"
                )
            parts = [table._data.get(name) for table in (self, more)]
            if column.numeric:
                blocks = [np.full(len(t), np.nan) if p is None else p for t, p in zip((self, more), parts, strict=True)]
                data[name] = np.concatenate([np.asarray(block, dtype=np.float64) for block in blocks])
            else:
                texts = [("",) * len(t) if p is None else p for t, p in zip((self, more), parts, strict=True)]
                data[name] = (*map(str, texts[0]), *map(str, texts[1]))
        labels = (*self.labels, *more.labels)
        user_rows = np.concatenate([self.user_rows, more.user_rows])
        table = Table(self.name, columns, data, labels, f"{self.origin} + {more.origin}", user_rows)
        table.readings = (*self.readings, *more.readings)
        return table


def perhaps_meant(name: str, known: Iterable[str]) -> str:
    """Tell which known names are meant, perhaps."""
    names = list(known)
    folded = {n.casefold(): n for n in names}
    close = [folded[c] for c in difflib.get_close_matches(name.casefold(), folded, n=3, cutoff=0.6)]
    if close:
        return f"perhaps {' or '.join(close)}"
    shown = ", ".join(names[:12])
    return f"for example {shown}, ..." if len(names) > 12 else f"one of {shown}" if names else "which has none"
