"""Catalogue tables: a CSV file, its schema, and what a user puts in their place.

A shipped table is read strictly against ``NAME.schema.csv``; every row names its source. A user's own table is met with
defaults: other units of the same kind are converted, further columns are kept, columns and cells that are missing stay
missing. Whatever is wrong is told with file, line and column.

Numbers are SI inside. An empty cell is nan in a column of numbers and the empty text in a column of text.
"""

from __future__ import annotations

import csv
import difflib
import hashlib
import io
import json
import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from synth.errors import InputError, at
from synth.files import read_bytes
from synth.plain_text import as_meant
from synth.units import Unit, check_number, from_si, header, number_to_si, parse_unit, split_header

if TYPE_CHECKING:
    import pandas as pd

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

CONFIDENCE = ("verified", "textbook", "typical", "computed", "synthetic")
SHIPPED = "shipped"
ENTRY_POINTS = "clutchsynth.catalogs"

_SCHEMA_HEADER = ["column", "type", "unit", "minimum", "maximum", "required", "symbol", "description"]
_TYPES = ("text", "number", "integer", "flag")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_SCHEMA_SUFFIX = ".schema.csv"
_UNIT_IN_COLUMN = "column:"


CODE_OF = "code of "  # before the name of a column of text: the column of numbers that stand for its texts


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

    def once(self, key: Any, make: Callable[[], BoolArray]) -> BoolArray:
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
        return self._find(column.removeprefix(CODE_OF)) is not None

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
        found = self._find(name)
        if found is None:
            raise InputError(f"table {self.name}", name, f"a column of this table, {_close(name, self.columns)}")
        return self.columns[found]

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
        Behind CODE_OF stands a column of text, whose cells are told by their ``text_code``.
        """
        if column.startswith(CODE_OF):
            return np.array([text_code(cell) for cell in self.text(column.removeprefix(CODE_OF))])
        found = self.column(column)
        cells = self._data[found.name]
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
        found = self.column(column)
        cells = self._data[found.name]
        if isinstance(cells, np.ndarray):
            raise InputError(f"table {self.name}", column, "a column of text; this one has numbers")
        return cells

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
            known = f"a designation of this table, {_close(str(designation), self.designations)}"
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
        found = []
        for i in range(len(self)):
            content = {name: value for name, value in self.row(i).items() if value is not None}
            canonical = json.dumps(content, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
            found.append(hashlib.sha256(canonical.encode("utf-8", "surrogatepass")).hexdigest())
        return tuple(found)

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
        return Table(self.name, columns, data, labels, f"{self.origin} + {more.origin}", user_rows)


@lru_cache(maxsize=1 << 16)
def text_code(text: str) -> float:
    """Return a whole number that stands for a text, the same everywhere; different texts have different ones.

    Notes
    -----
    The first 48 bits of the SHA-256: exact as a float, and two of a million texts share one once in 500 tries.
    """
    return float(int.from_bytes(hashlib.sha256(text.encode()).digest()[:6], "big"))


def _close(name: str, known: Iterable[str]) -> str:
    """Tell which known names are meant, perhaps."""
    names = list(known)
    folded = {n.casefold(): n for n in names}
    close = [folded[c] for c in difflib.get_close_matches(name.casefold(), folded, n=3, cutoff=0.6)]
    if close:
        return f"perhaps {' or '.join(close)}"
    shown = ", ".join(names[:12])
    return f"for example {shown}, ..." if len(names) > 12 else f"one of {shown}" if names else "which has none"


# ---- reading --------------------------------------------------------------------------------------------------------


def _read_csv(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows with their line numbers."""
    name = path.name
    raw = read_bytes(path, "catalogue file", "a CSV file")
    try:
        # spreadsheets put a byte order mark before UTF-8; it is no part of the first name
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise InputError(
            f"{name}, line {line}", raw[error.start : error.start + 1], "UTF-8 text: save as CSV UTF-8"
        ) from None
    if not text.strip():
        raise InputError(name, "an empty file", "a header row and at least one row below it")
    first = text.split("\n", 1)[0]
    if "," not in first and (";" in first or "\t" in first):
        mark = "semicolons" if ";" in first else "tabs"
        raise InputError(
            f"{name}, line 1", first.strip(), f"columns separated by commas, not by {mark}, with decimal points"
        )
    rows: list[tuple[int, list[str]]] = []
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    line = 1
    try:
        for cells in reader:
            rows.append((line, cells))
            line = reader.line_num + 1
    except csv.Error as error:
        raise InputError(
            f"{name}, line {reader.line_num}", str(error), "plain CSV with every quoted cell closed"
        ) from None
    return rows[0][1], rows[1:]


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
    head, rows = _read_csv(path)
    if head != _SCHEMA_HEADER:
        raise InputError(f"{path.name}, line 1", ",".join(head), ",".join(_SCHEMA_HEADER))
    columns: list[Column] = []
    for line, cells in rows:
        where = f"{path.name}, line {line}"
        if len(cells) != len(_SCHEMA_HEADER):
            raise InputError(where, f"{len(cells)} cells", f"{len(_SCHEMA_HEADER)} cells")
        column = _schema_column(dict(zip(_SCHEMA_HEADER, cells, strict=True)), where)
        if any(column.name == other.name for other in columns):
            raise InputError(f"{where}, column column", column.name, "a name that is not used yet")
        if column.symbol and any(column.symbol == other.symbol for other in columns):
            raise InputError(f"{where}, column symbol", column.symbol, "a symbol that is not used yet in this table")
        columns.append(column)
    if not columns:
        raise InputError(path.name, "a header only", "one line for each column of the table")
    for column in columns:
        if column.unit and column.unit.startswith(_UNIT_IN_COLUMN):
            name = column.unit.removeprefix(_UNIT_IN_COLUMN)
            if not any(c.name == name and not c.numeric for c in columns):
                raise InputError(
                    f"{path.name}, column {column.name}", column.unit, "the name of a text column of this table"
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
        given = cell[side]
        if given and cell["type"] == "text":
            raise InputError(f"{where}, column {side}", given, "an empty cell for a column of text")
        limits.append(float(check_number(given, f"{where}, column {side}")) if given else None)
    low, high = limits
    if low is not None and high is not None and not low < high:
        raise InputError(f"{where}, column minimum", low, f"less than the maximum {high:g}")
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


@dataclass(frozen=True)
class _Field:
    """A column of a file and the unit its cells are in."""

    column: Column
    unit: Unit
    position: int


def _strict_fields(head: Sequence[str], schema: Schema, where: str) -> list[_Field]:
    """Check the header of a shipped table: the schema's, in its order."""
    wanted = [column.heading for column in schema.columns]
    for i, (found, right) in enumerate(zip(head, wanted, strict=False)):
        if found != right:
            name = split_header(found)[0] if "[" in found and "]" in found else found
            if schema.get(name) is None:
                hint = f"the column {right!r} in place {i + 1}; the schema has no {name!r}"
            elif name == schema.columns[i].name:
                hint = f"the unit of the schema: {right}"
            else:
                hint = f"the order of the schema, with {right!r} in place {i + 1}"
            raise InputError(f"{where}, line 1, column {name}", found, hint)
    if len(head) > len(wanted):
        raise InputError(f"{where}, line 1", head[len(wanted)], "no column that the schema does not have")
    if len(head) < len(wanted):
        raise InputError(f"{where}, line 1, column {schema.columns[len(head)].name}", None, wanted[len(head)])
    return [_Field(column, column.scale, i) for i, column in enumerate(schema.columns)]


def _user_fields(head: Sequence[object], schema: Schema | None, where: str) -> list[_Field]:
    """Match the header of a user's table with a schema, if there is one; infer what it does not know."""
    fields: list[_Field] = []
    known = {_folded(column.name): column.name for column in schema.columns} if schema else {}
    for position, title in enumerate(head):
        if not isinstance(title, str) or not title.strip():
            raise InputError(f"{where}, column {position + 1}", title or None, "a name in every cell of the header")
        try:
            name, unit_text = split_header(title)
        except InputError as error:
            raise InputError(where, title, error.expected) from None
        place = f"{where}, column {name}"
        if any(name == other.column.name for other in fields):
            raise InputError(place, title, "each column once")
        column = schema.get(name) if schema else None
        if column is not None and column.type == "text" and unit_text is not None:
            raise InputError(place, title, f"{name} without a unit: it is a column of text")
        if column is None and _folded(name) in known:
            raise InputError(place, title, f"the spelling {known[_folded(name)]}")
        try:
            if column is None:
                unit = parse_unit("-" if unit_text is None else unit_text)
                column = Column(name, "text" if unit_text is None else "number", unit_text)
            elif unit_text is None:
                unit = column.scale
            else:
                unit = parse_unit(unit_text, column.scale.kind)
        except InputError as error:
            raise InputError(place, title, error.expected) from None
        fields.append(_Field(column, unit, position))
    return fields


def _folded(name: str) -> str:
    return re.sub(r"[\s_-]", "", name).casefold()


def _number_cell(cell: object, column: Column, unit: Unit, where: str) -> float:
    """SI value of one cell; nan where it is empty."""
    if isinstance(cell, str):
        if not cell.strip():
            return math.nan
        number = check_number(cell, where)
    elif isinstance(cell, (bool, np.bool_)):
        if column.type != "flag":
            raise InputError(where, cell, "a number")
        number = str(int(cell))
    elif isinstance(cell, (int, float, np.integer, np.floating)):
        try:
            plain = float(cell)
        except OverflowError:
            plain = math.inf
        if math.isnan(plain):
            return math.nan
        if math.isinf(plain):
            raise InputError(where, cell, "a finite number")
        number = repr(plain)
    else:
        raise InputError(where, cell, "a number")
    si = number_to_si(number, unit)
    if not math.isfinite(si):
        raise InputError(where, cell, "a finite number")
    if column.type == "flag" and si not in (0.0, 1.0):
        raise InputError(where, cell, "0 or 1")
    if column.type == "integer" and not si.is_integer():
        raise InputError(where, cell, "a whole number")
    for limit, outside in ((column.minimum, float.__lt__), (column.maximum, float.__gt__)):
        if limit is not None and outside(si, number_to_si(repr(limit), column.scale)):
            shown = "" if column.unit is None or column.unit == "-" else f" {column.unit}"
            ends = [f"{end:g}" for end in (column.minimum, column.maximum) if end is not None]
            raise InputError(
                where, f"{cell} {unit.text}".removesuffix(" -"), f"a plausible value, {' .. '.join(ends)}{shown}"
            )
    return si


def _text_cell(cell: object, where: str) -> str:
    if isinstance(cell, str):
        return cell.strip()
    if isinstance(cell, (bool, np.bool_)) or not isinstance(cell, (int, float, np.integer, np.floating)):
        raise InputError(where, cell, "text")
    if math.isnan(cell):
        return ""
    # a spreadsheet turns the designation 6205 into a number
    return str(int(cell)) if math.isfinite(cell) and float(cell).is_integer() else str(cell)


def _build(
    name: str,
    fields: Sequence[_Field],
    rows: Sequence[tuple[str, Sequence[object]]],
    places: Sequence[int],
    origin: str,
    *,
    strict: bool,
    catalogue: bool,
) -> Table:
    """Check every cell and make the table; ``places`` are the lines (rows of a frame) for the paths of faults."""
    data: dict[str, FloatArray | tuple[str, ...]] = {}
    columns = {field.column.name: field.column for field in fields}
    for field in fields:
        column, values = field.column, list[Any]()
        for (label, row), place in zip(rows, places, strict=True):
            with at(place, column.name):
                cell, where = row[field.position], f"{label}, column {column.name}"
                if strict and isinstance(cell, str) and cell != cell.strip():
                    raise InputError(where, cell, "a cell without blanks at its ends")
                if strict and column.required and cell == "":
                    raise InputError(where, None, f"a value: {column.description}")
                read = _number_cell(cell, column, field.unit, where) if column.numeric else _text_cell(cell, where)
                values.append(read)
        data[column.name] = np.array(values, dtype=np.float64) if column.numeric else tuple(values)
    labels = [label for label, _ in rows]
    if catalogue:
        _check_designations(data.get("designation"), labels, places)
    if strict:
        for label, word in zip(labels, data.get("confidence", ()), strict=False):
            if word not in CONFIDENCE:
                raise InputError(f"{label}, column confidence", word, f"one of {', '.join(CONFIDENCE)}")
    else:
        for given, default in (("source", origin), ("confidence", "user")):
            texts = data.get(given, ("",) * len(rows))
            data[given] = tuple(str(text) or default for text in texts)
            columns.setdefault(given, Column(given, "text"))
    return Table(name, columns, data, labels, origin, np.full(len(rows), not strict))


def _check_designations(designations: object, labels: Sequence[str], places: Sequence[int]) -> None:
    seen: dict[str, str] = {}
    known = designations if isinstance(designations, tuple) else ()
    for label, place, designation in zip(labels, places, known, strict=True):
        where = f"{label}, column designation"
        with at(place, "designation"):
            if not designation:
                raise InputError(where, None, "a unique name of the row")
            if re.search(r"[,;\r\n]", designation):
                raise InputError(where, designation, "a name without comma, semicolon or line break")
            if designation in seen:
                raise InputError(where, designation, f"a name of its own (it stands in {seen[designation]} already)")
        seen[designation] = label


def load_table(
    path: str | Path, schema: str | Path | Schema | None = None, *, name: str | None = None, shipped: bool = True
) -> Table:
    """Read a table from a CSV file.

    Parameters
    ----------
    path : str or Path
        The CSV file.
    schema : str, Path or Schema, optional
        Its schema; by default ``NAME.schema.csv`` beside it. A table that is not shipped may have none: then a column
        is a number where its header has a unit (``mass [kg]``), else text.
    name : str, optional
        Name of the table; by default that of the file.
    shipped : bool
        Strict: exactly the columns of the schema in its order, every required cell filled, every row with a source.

    Returns
    -------
    Table
        The table, numbers in SI.

    Raises
    ------
    InputError
        Something in the file is not right; file, line and column are named.
    """
    path = Path(path)
    name = path.name.removesuffix(".csv") if name is None else name
    if schema is None:
        beside = path.with_name(path.name.removesuffix(".csv") + _SCHEMA_SUFFIX)
        if shipped or beside.is_file():
            schema = beside
    if schema is not None and not isinstance(schema, Schema):
        schema = load_schema(schema)
    head, body = _read_csv(path)
    if shipped and schema is not None:
        for title in head:
            if head.count(title) > 1:
                raise InputError(f"{path.name}, line 1", title, "each column once")
        fields = _strict_fields(head, schema, path.name)
    else:
        while head and not head[-1].strip() and all(not "".join(cells[len(head) - 1 :]).strip() for _, cells in body):
            head = head[:-1]
            body = [(line, cells[: len(head)]) for line, cells in body]
        fields = _user_fields(head, schema, f"{path.name}, line 1")
        body = [(line, cells) for line, cells in body if "".join(cells).strip()]
    if not body:
        raise InputError(path.name, "a header only", "at least one row below the header")
    rows: list[tuple[str, Sequence[object]]] = []
    for line, cells in body:
        if len(cells) != len(head):
            right = f"{len(head)} cells as in the header (decimal points, and quotes around a text that has a comma)"
            raise InputError(f"{path.name}, line {line}", f"{len(cells)} cells", right, (line,))
        rows.append((f"{path.name}, line {line}", cells))
    catalogue = any(field.column.name == "designation" for field in fields)
    lines = [line for line, _ in body]
    return _build(name, fields, rows, lines, SHIPPED if shipped else path.name, strict=shipped, catalogue=catalogue)


def table_from_frame(frame: pd.DataFrame, schema: Schema | None = None, *, name: str = "table") -> Table:
    """Make a table of a DataFrame with headers such as ``mass [kg]``.

    Parameters
    ----------
    frame : pandas.DataFrame
        A user's table; its index may be named ``designation``.
    schema : Schema, optional
        Schema of the table it replaces or extends.
    name : str
        Name of the table.

    Returns
    -------
    Table
        The table, numbers in SI.

    Raises
    ------
    InputError
        Something in the frame is not right; row and column are named.
    """
    if frame.index.name == "designation" and "designation" not in frame.columns:
        frame = frame.reset_index()
    fields = _user_fields(list(frame.columns), schema, f"{name}, DataFrame header")
    if frame.empty:
        raise InputError(f"{name}, DataFrame", "a header only", "at least one row below the header")
    # pandas has several values for "nothing here"
    present = frame.notna().to_numpy()
    cells = [frame.iloc[:, j].tolist() for j in range(frame.shape[1])]
    rows = [
        (f"{name}, DataFrame row {label}", [cells[j][i] if present[i, j] else "" for j in range(frame.shape[1])])
        for i, label in enumerate(frame.index)
    ]
    catalogue = any(field.column.name == "designation" for field in fields)
    return _build(name, fields, rows, range(len(rows)), "DataFrame", strict=False, catalogue=catalogue)


# ---- catalogues -----------------------------------------------------------------------------------------------------


def shipped_folders() -> tuple[Path, ...]:
    """Folders of the installed catalogue packages.

    Each entry point of the group ``clutchsynth.catalogs`` names a package whose folder holds CSV files and their
    schemas. The packages are found, not imported.

    Returns
    -------
    tuple of Path
        Folders, each once.

    Raises
    ------
    InputError
        An entry point names a package that is not there.
    """
    folders: dict[Path, None] = {}
    for point in sorted(entry_points(group=ENTRY_POINTS), key=lambda point: (point.name, point.value)):
        try:
            spec = find_spec(point.value)
        except (ImportError, ValueError):
            spec = None
        if spec is None or not spec.submodule_search_locations:
            raise InputError(f"entry point {point.name}", point.value, "an installed package with CSV files")
        for location in spec.submodule_search_locations:
            folders[Path(location).resolve()] = None
    return tuple(folders)


@lru_cache(maxsize=256)
def _shipped_table(path: Path, stamps: tuple[int, ...]) -> Table:
    return load_table(path)


@lru_cache(maxsize=256)
def _shipped_schema(path: Path, stamp: int) -> Schema:
    return load_schema(path)


def _csv_files(folder: Path) -> dict[str, Path]:
    return {p.name.removesuffix(".csv"): p for p in sorted(folder.glob("*.csv")) if not p.name.endswith(_SCHEMA_SUFFIX)}


class Catalogs:
    """The tables a problem may use: the shipped ones, replaced or extended by a user's own.

    Parameters
    ----------
    spec : str, Path or mapping, optional
        A folder, whose CSV files replace the tables of their names; or table name to a CSV path, a DataFrame, or a
        list ``["+", more, ...]`` whose paths and DataFrames are appended to the shipped rows.
    folders : sequence of str or Path, optional
        Folders of shipped tables instead of those of the installed packages.
    base : str or Path, optional
        Folder that relative paths start from; by default the working directory.

    Attributes
    ----------
    added : tuple of str
        Tables of `spec` that no shipped table is called.

    Raises
    ------
    InputError
        The specification is not one of these.
    """

    def __init__(
        self,
        spec: object = None,
        folders: Sequence[str | Path] | None = None,
        *,
        base: str | Path | None = None,
    ) -> None:
        self._base = Path() if base is None else Path(base)
        self._shipped: dict[str, Path] = {}
        for folder in shipped_folders() if folders is None else folders:
            for name, path in _csv_files(Path(folder)).items():
                if name in self._shipped:
                    raise InputError(f"table {name}", str(path), f"one shipped table of a name ({self._shipped[name]})")
                self._shipped[name] = path
        self._spec = self._read_spec(spec)
        self.added = tuple(sorted(set(self._spec) - set(self._shipped)))
        self._cache: dict[str, Table] = {}

    def _path(self, given: str | Path) -> Path:
        return self._base / given

    def _read_spec(self, spec: object) -> dict[str, tuple[bool, list[Any]]]:
        """Table name to (extend the shipped rows?, sources)."""
        if spec is None:
            return {}
        right = "a folder, or a mapping of table names to a CSV path, a DataFrame or ['+', more]"
        if isinstance(spec, (str, Path)):
            folder = self._path(spec)
            try:
                files = _csv_files(folder) if folder.is_dir() else None
            except (OSError, ValueError):
                files = None
            if files is None:
                raise InputError("catalogs", str(spec), "a folder that exists", ("catalogs",))
            if not files:
                wanted = "a folder with CSV files named like the tables they replace"
                raise InputError("catalogs", str(spec), wanted, ("catalogs",))
            return {name: (False, [path]) for name, path in files.items()}
        if not isinstance(spec, Mapping):
            raise InputError("catalogs", spec, right, ("catalogs",))
        found: dict[str, tuple[bool, list[Any]]] = {}
        for name, value in spec.items():
            if not isinstance(name, str):
                raise InputError("catalogs", name, "the name of a table", ("catalogs", str(name)))
            where = f"catalogs: {name}"
            with at("catalogs", name):
                if isinstance(value, (list, tuple)):
                    if len(value) < 2 or value[0] != "+":
                        raise InputError(where, value, "a list such as ['+', 'more.csv'] to extend the shipped table")
                    if name not in self._shipped:
                        raise InputError(where, name, f"a shipped table to extend, {_close(name, self._shipped)}")
                    found[name] = (True, list(value[1:]))
                else:
                    found[name] = (False, [value])
                for source in found[name][1]:
                    if not isinstance(source, (str, Path)) and not _is_frame(source):
                        raise InputError(where, source, "a CSV path, a DataFrame or ['+', more]")
        return found

    def files(self) -> dict[str, Any]:
        """Return the user's own tables that are files, as a spec states them, with absolute paths."""
        result: dict[str, Any] = {}
        for name, (extends, sources) in self._spec.items():
            paths = [str(self._path(s).resolve()) for s in sources if isinstance(s, (str, Path))]
            if len(paths) == len(sources):
                result[name] = ["+", *paths] if extends else paths[0]
        return result

    def stated(self) -> dict[str, Any]:
        """Return the user's own tables as :meth:`files`, all of them.

        Raises
        ------
        InputError
            When one is in memory.
        """
        files = self.files()
        for name in self._spec:
            if name not in files:
                right = "a file that can be named"
                raise InputError(f"catalogs: {name}", "a table in memory", right, ("catalogs", name))
        return files

    def digest(self) -> str:
        """SHA-256 of everything in these tables: shipped files byte by byte, a user's own row by row."""
        total = hashlib.sha256()
        for name, path in sorted(self._shipped.items()):
            schema = path.with_name(name + _SCHEMA_SUFFIX)
            for file in (path, schema):
                total.update(file.name.encode() + b"\0" + (file.read_bytes() if file.is_file() else b"") + b"\0")
        for name in sorted(self._spec):
            total.update(json.dumps([name, *self.table(name).hashes]).encode())
        return total.hexdigest()

    def names(self) -> tuple[str, ...]:
        """Names of all tables, sorted."""
        return tuple(sorted({*self._shipped, *self._spec}))

    def schema(self, name: str) -> Schema | None:
        """Give the schema of a shipped table; None where no shipped table has that name."""
        path = self._shipped.get(name)
        if path is None:
            return None
        beside = path.with_name(name + _SCHEMA_SUFFIX)
        return _shipped_schema(beside, _stamp(beside))

    def table(self, name: str) -> Table:
        """Give a table as this set of catalogues has it.

        Parameters
        ----------
        name : str
            Name of the table.

        Returns
        -------
        Table
            The shipped, replaced or extended table.

        Raises
        ------
        InputError
            There is no such table, or something in a user's table is not right.
        """
        if name not in self._cache:
            self._cache[name] = self._load(name)
        return self._cache[name]

    def _load(self, name: str) -> Table:
        if name not in self._spec:
            if name not in self._shipped:
                right = f"a known table, one of {', '.join(self.names())}"
                raise InputError("table", name, right, ("catalogs", name))
            path = self._shipped[name]
            return _shipped_table(path, (_stamp(path), _stamp(path.with_name(name + _SCHEMA_SUFFIX))))
        extend, sources = self._spec[name]
        with at("catalogs", name):
            tables = [self._user_table(name, source) for source in sources]
        if not extend:
            return tables[0]
        path = self._shipped[name]
        table = _shipped_table(path, (_stamp(path), _stamp(path.with_name(name + _SCHEMA_SUFFIX))))
        with at("catalogs", name):
            for more in tables:
                table = table.extended(more)
        return table

    def _user_table(self, name: str, source: Any) -> Table:
        schema = self.schema(name)
        if isinstance(source, (str, Path)):
            path = self._path(source)
            own = path.with_name(path.name.removesuffix(".csv") + _SCHEMA_SUFFIX)
            if own.is_file():
                described = load_schema(own)
                schema = described if schema is None else schema.extended(described)
            table = load_table(path, schema, name=name, shipped=False)
        else:
            table = table_from_frame(source, schema, name=name)
        if "designation" not in table.columns and (schema is None or schema.get("designation") is not None):
            raise InputError(f"{table.origin}, header", None, "a column designation with a unique name in every row")
        return table


def _is_frame(value: object) -> bool:
    # whoever holds a DataFrame has imported pandas; importing it only to look would cost its second
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(value, pandas.DataFrame)


def _stamp(path: Path) -> int:
    """Change time of a file, so that an edited one is read again."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0
