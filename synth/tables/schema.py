"""Schemas: columns of a table, with unit and meaning."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from synth.errors import InputError
from synth.tables.csv_file import read_csv_bytes, read_csv_file
from synth.text.numbers import typed_number
from synth.units import Unit, check_number, header, parse_unit

_SCHEMA_HEADER = ["column", "type", "unit", "minimum", "maximum", "required", "symbol", "description"]
_TYPES = ("text", "number", "integer", "flag")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
SCHEMA_SUFFIX = ".schema.csv"
_UNIT_IN_COLUMN = "column:"


@dataclass(frozen=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    name : str
        Name of the column.
    type : str
        text, number, integer or flag (0 or 1).
    unit : str or None
        Unit of the header; None for text and flags. ``column:NAME`` where the unit stands in the cells of column NAME.
    minimum, maximum : float or None
        Inclusive limits of plausibility [in `unit`].
    required : bool
        No shipped row may leave the cell empty.
    symbol : str
        Symbol of the reference, or empty.
    description : str
        One line of meaning.
    """

    name: str
    type: str
    unit: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    required: bool = False
    symbol: str = ""
    description: str = ""

    @property
    def numeric(self) -> bool:
        """Whether the cells are numbers (a flag is one)."""
        return self.type != "text"

    @property
    def scale(self) -> Unit:
        """Unit of conversion; a flag and a unit that stands in another column are taken as they are."""
        return parse_unit("-" if self.unit is None or self.unit.startswith(_UNIT_IN_COLUMN) else self.unit)

    @property
    def heading(self) -> str:
        """Header of the column in a file."""
        if self.unit is None or self.unit.startswith(_UNIT_IN_COLUMN):
            return self.name
        return header(self.name, self.unit)


@dataclass(frozen=True)
class Schema:
    """The columns of a table, in order.

    Parameters
    ----------
    columns : tuple of Column
        Columns in the order of the file.
    """

    columns: tuple[Column, ...]

    def get(self, name: str) -> Column | None:
        """Column of that name, or None."""
        return next((column for column in self.columns if column.name == name), None)

    def extended(self, more: Schema) -> Schema:
        """Give this schema with the columns of another one that it does not have."""
        return Schema((*self.columns, *(column for column in more.columns if self.get(column.name) is None)))


def load_schema(path: str | Path) -> Schema:
    """Read a schema file.

    Parameters
    ----------
    path : str or Path
        ``NAME.schema.csv``.

    Returns
    -------
    Schema
        Its columns.

    Raises
    ------
    InputError
        A line of the schema is not right.
    """
    path = Path(path)
    return _schema_of(*read_csv_file(path).rows(), path.name)


def schema_of_text(text: str, name: str) -> Schema:
    """Read what would stand in a schema file; ``name`` is that of it, for messages.

    Raises
    ------
    InputError
        A line of the schema is not right.
    """
    return _schema_of(*read_csv_bytes(text.encode(), name).rows(), name)


def _schema_of(head: list[str], rows: list[tuple[int, list[str]]], file: str) -> Schema:
    if head != _SCHEMA_HEADER:
        raise InputError(f"{file}, line 1", ",".join(head), ",".join(_SCHEMA_HEADER))
    columns: list[Column] = []
    for line, cells in rows:
        where = f"{file}, line {line}"
        if len(cells) != len(_SCHEMA_HEADER):
            raise InputError(where, f"{len(cells)} cells", f"{len(_SCHEMA_HEADER)} cells")
        column = _schema_column(dict(zip(_SCHEMA_HEADER, cells, strict=True)), where)
        if any(column.name == other.name for other in columns):
            raise InputError(f"{where}, column column", column.name, "a name that is not used yet")
        if column.symbol and any(column.symbol == other.symbol for other in columns):
            raise InputError(f"{where}, column symbol", column.symbol, "a symbol that is not used yet in this table")
        columns.append(column)
    if not columns:
        raise InputError(file, "a header only", "one line for each column of the table")
    for column in columns:
        if column.unit and column.unit.startswith(_UNIT_IN_COLUMN):
            name = column.unit.removeprefix(_UNIT_IN_COLUMN)
            if not any(c.name == name and not c.numeric for c in columns):
                raise InputError(
                    f"{file}, column {column.name}", column.unit, "the name of a text column of this table"
                )
    return Schema(tuple(columns))


def _schema_column(cell: dict[str, str], where: str) -> Column:
    if not _NAME.fullmatch(cell["column"]):
        raise InputError(f"{where}, column column", cell["column"], "a name of letters, digits and underscores")
    if cell["type"] not in _TYPES:
        raise InputError(f"{where}, column type", cell["type"], f"one of {', '.join(_TYPES)}")
    if cell["required"] not in ("0", "1"):
        raise InputError(f"{where}, column required", cell["required"], "0 or 1")
    if not cell["description"]:
        raise InputError(f"{where}, column description", None, "one line of meaning")
    quantity = cell["type"] in ("number", "integer")
    if quantity != bool(cell["unit"]):
        right = "a unit (- where there is none)" if quantity else "no unit for a column of text or flags"
        raise InputError(f"{where}, column unit", cell["unit"] or None, right)
    if quantity and not cell["unit"].startswith(_UNIT_IN_COLUMN):
        try:
            parse_unit(cell["unit"])
        except InputError as error:
            raise InputError(f"{where}, column unit", cell["unit"], error.expected) from None
    limits: list[float | None] = []
    for side in ("minimum", "maximum"):
        limit_text = cell[side]
        if limit_text and cell["type"] == "text":
            raise InputError(f"{where}, column {side}", limit_text, "an empty cell for a column of text")
        limits.append(float(check_number(limit_text, f"{where}, column {side}")) if limit_text else None)
    low, high = limits
    if low is not None and high is not None and not low < high:
        raise InputError(f"{where}, column minimum", low, f"less than the maximum {typed_number(high)}")
    return Column(
        name=cell["column"],
        type=cell["type"],
        unit=cell["unit"] or None,
        minimum=low,
        maximum=high,
        required=cell["required"] == "1",
        symbol=cell["symbol"],
        description=cell["description"],
    )
