"""Cells of tables, read with units and checked against the schema."""

from __future__ import annotations

import datetime
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from synth.errors import Described, InputError, at
from synth.folders.files import csv_text, read_bytes
from synth.tables.csv_file import read_csv_bytes, read_csv_file
from synth.tables.encodings import decoded
from synth.tables.number_columns import DESIGNATION
from synth.tables.schema import SCHEMA_SUFFIX, Column, Schema, load_schema
from synth.tables.table import SHIPPED, FloatArray, Table
from synth.tables.table_file import table_file
from synth.tables.table_text import TableText
from synth.tables.workbook import (
    LOOKED_AT,
    Sheet,
    cell_text,
    header_first,
    is_workbook,
    sheet_of,
    split_sheet,
    table_elsewhere,
)
from synth.text.numbers import typed_number
from synth.units import Unit, check_number, is_date, number_to_si, parse_unit, split_header

if TYPE_CHECKING:
    import pandas as pd

# Numbers as a table program writes them; 6205 was typed so, 1E5 and 1.10 are still as they were.
MADE = re.compile(r"[-+]?\d+[.,]\d*[1-9]|[-+]?\d+(?:[.,]\d+)?[eE][-+]\d+")
FAULT = re.compile(r"#[A-Z0/]+[?!]?|#+")
AS_TEXT = "a name; a table program has made a {} of it: set the cell to Text, and type it again"
OF_RECORD = ("table", "hash", "units")  # what a record adds to the cells of a row
CONFIDENCE = ("verified", "textbook", "typical", "computed", "synthetic")


@dataclass(frozen=True)
class _Field:
    """A column of a file and the unit its cells are in."""

    column: Column
    unit: Unit
    position: int


def _strict_fields(head: Sequence[str], schema: Schema, where: str) -> list[_Field]:
    """Check the header of a shipped table: the schema's, in its order."""
    headings = [column.heading for column in schema.columns]
    for i, (heading, right) in enumerate(zip(head, headings, strict=False)):
        if heading != right:
            name = split_header(heading)[0] if "[" in heading and "]" in heading else heading
            if schema.get(name) is None:
                hint = f"the column {right!r} in place {i + 1}; the schema has no {name!r}"
            elif name == schema.columns[i].name:
                hint = f"the unit of the schema: {right}"
            else:
                hint = f"the order of the schema, with {right!r} in place {i + 1}"
            raise InputError(f"{where}, line 1, column {name}", heading, hint)
    if len(head) > len(headings):
        raise InputError(f"{where}, line 1", head[len(headings)], "no column that the schema does not have")
    if len(head) < len(headings):
        raise InputError(f"{where}, line 1, column {schema.columns[len(head)].name}", None, headings[len(head)])
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
    elif isinstance(cell, datetime.date):
        number = check_number(cell_text(cell), where)  # which says what has become of it
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
            ends = [typed_number(end) for end in (column.minimum, column.maximum) if end is not None]
            raise InputError(
                where, f"{cell} {unit.text}".removesuffix(" -"), f"a plausible value, {' .. '.join(ends)}{shown}"
            )
    return si


def _text_cell(cell: object, where: str) -> str:
    if isinstance(cell, str):
        return cell.strip()
    if isinstance(cell, (bool, np.bool_)) or not isinstance(cell, (int, float, np.integer, np.floating)):
        raise InputError(where, cell, "text")
    try:
        return "" if math.isnan(cell) else str(int(cell)) if float(cell).is_integer() else str(cell)
    except OverflowError:
        raise InputError(where, cell, "text") from None


def _refuse_made(cell: object, where: str) -> None:
    """Refuse a designation that a table program has made of another text: 1.10 is 1.1 there, and 1E5 is 100000."""
    if isinstance(cell, str):
        if FAULT.fullmatch(cell.strip()):
            raise InputError(where, cell, AS_TEXT.format("fault"))
    elif isinstance(cell, (bool, int, float, np.bool_, np.floating)):
        raise InputError(where, cell, AS_TEXT.format("number"))
    elif isinstance(cell, (datetime.date, datetime.time, datetime.timedelta)):
        raise InputError(where, cell_text(cell), AS_TEXT.format("date"))


def _designation(text: str, where: str) -> str:
    """Return a designation of a CSV file; refuse what a table program writes there for a number, a date or a fault."""
    text = text.strip()
    if text.startswith("'") and _is_made(text[1:]):
        return text[1:]
    if _is_made(text):
        kind = "date" if is_date(text) else "number"
        raise InputError(where, text, f"{AS_TEXT.format(kind)}, or put an apostrophe before it where it is meant so")
    return text


def _is_made(text: str) -> bool:
    return is_date(text) or MADE.fullmatch(text) is not None


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
                if not strict and column.name == DESIGNATION and not isinstance(cell, int):
                    _refuse_made(cell, where)
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
        for title, default in (("source", origin), ("confidence", "user")):
            texts = data.get(title, ("",) * len(rows))
            data[title] = tuple(str(text) or default for text in texts)
            columns.setdefault(title, Column(title, "text"))
    return Table(name, columns, data, labels, origin, np.full(len(rows), not strict))


def _check_designations(designations: object, labels: Sequence[str], places: Sequence[int]) -> None:
    seen: dict[str, str] = {}
    known = designations if isinstance(designations, tuple) else ()
    for label, place, designation in zip(labels, places, known, strict=True):
        where = f"{label}, column designation"
        with at(place, "designation"):
            if not designation:
                raise InputError(where, None, "a unique name of the row")
            if re.search(r"[;\r\n]", designation):
                raise InputError(where, designation, "a name without semicolon or line break")
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
        The CSV file; where it is not shipped also a workbook, ``file.xlsx#Sheet``.
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
    name = table_name(path) if name is None else name
    if schema is None:
        schema_file = path.with_name(table_name(path) + SCHEMA_SUFFIX)
        if shipped or schema_file.is_file():
            schema = schema_file
    if schema is not None and not isinstance(schema, Schema):
        schema = load_schema(schema)
    if not shipped and is_workbook(path):
        return _table_of_sheet(path, schema, name)
    written = read_csv_file(path, plain=shipped)
    return _table_of(*written.rows(), schema, name, written.text.name, shipped, written.sentence())


def csv_of_file(path: Path) -> str:
    """Return the text of a user's table as a CSV file holds it, whatever its encoding; of a workbook that of a sheet.

    Raises
    ------
    InputError
        The file cannot be read.
    """
    named = table_file(path)
    if not named.is_workbook:
        raw = read_bytes(named.path, "catalogue file", "a CSV or .xlsx file")
        return decoded(raw, named.path.name, named.encoding)[0]
    _, lines = _lines_of_sheet(path, None)
    (_, head), *rows = lines
    if DESIGNATION in head:
        k = head.index(DESIGNATION)
        for _, cells in rows:
            cells[k] = f"'{cells[k]}" if _is_made(cells[k]) else cells[k]
    return csv_text(head, [cells for _, cells in rows])


def _table_of_sheet(path: Path, schema: Schema | None, name: str) -> Table:
    """Read a user's table from a workbook: the sheet that is named, or the first that has what is needed."""
    sheet, ((_, head), *rows) = _lines_of_sheet(path, schema)
    width = max((len(cells) for _, cells in rows), default=0)
    place = f"{sheet.name}, sheet {sheet.title}"
    head = head + [""] * (width - len(head))
    return _table_of(head, rows, schema, name, place, False, sheet.sentence(), typed=True)


def _lines_of_sheet(path: Path, schema: Schema | None) -> tuple[Sheet, list[tuple[int, list[str]]]]:
    """Return the sheet that holds a table, and its lines that are not empty, the header first."""
    fits = _holds_header(schema)
    sheet = sheet_of(path, "catalogue file", "a CSV or .xlsx file", fits)
    place = f"{sheet.name}, sheet {sheet.title}"
    lines = [(line, cells) for line, cells in sheet.lines(_flag_or_text) if "".join(cells).strip()]
    if not lines or lines[0][0] != 1 or not fits(lines[0][1]):
        right = table_elsewhere(path, "catalogue file", fits)
        if right:
            raise InputError(place, Described("no header in the first row"), right)
    if not lines or lines[0][0] != 1:
        raise InputError(place, "an empty first row", "a header row and at least one row below it")
    (_, head), *rows = lines
    if DESIGNATION in head:
        k = head.index(DESIGNATION)
        for line, cells in sheet.values():
            if line > 1 and k < len(cells):
                with at(line, DESIGNATION):
                    _refuse_made(cells[k], f"{place}, line {line}, column {DESIGNATION}")
    rows = [(line, cells + [""] * (len(head) - len(cells))) for line, cells in rows]
    return sheet, [(1, head), *rows]


def _holds_header(schema: Schema | None) -> Callable[[Sequence[str]], bool]:
    """Test whether cells are the header of a table: by its designations, or the columns of its data."""
    required = {DESIGNATION}
    if schema is not None and schema.get(DESIGNATION) is None:
        required = {column.name for column in schema.columns}
    return lambda cells: bool({title.partition("[")[0].strip() for title in cells} & required)


def _flag_or_text(cell: object) -> str:
    return str(int(cell)) if isinstance(cell, bool) else cell_text(cell)


def table_name(path: Path) -> str:
    """Return the name of the table that stands in a file: that of the file."""
    file, _ = split_sheet(path)
    return file.stem if is_workbook(file) else file.name.removesuffix(".csv")


def table_of_text(text: TableText, schema: Schema | None, name: str) -> Table:
    """Read a user's table from the text of a CSV file.

    Parameters
    ----------
    text : TableText
    schema : Schema or None
        Its schema, where it has one.
    name : str
        Name of the table.

    Raises
    ------
    InputError
        Something in the text is not right; reference, line and column are named.
    """
    written = read_csv_bytes(text.csv.encode(), text.reference)
    return _table_of(*written.rows(), schema, name, text.reference, False, written.sentence())


def table_of_rows(rows: Sequence[Mapping[str, Any]], schema: Schema | None, name: str, origin: str) -> Table:
    """Make a table of rows that a record has kept.

    Parameters
    ----------
    rows : list of mapping
        Column -> SI number or text, None where the cell was empty; what the record adds is none, but for units of
        columns.
    schema : Schema or None
        Of the shipped table of that name.
    name, origin : str
        Of the table, and of the file it was read from.
    """
    stored = [{column: cell for column, cell in row.items() if column not in OF_RECORD} for row in rows]
    columns, data = dict[str, Column](), dict[str, Any]()
    units = {column: unit for row in rows for column, unit in row.get("units", {}).items()}
    for column in dict.fromkeys(column for row in stored for column in row):
        cells = [row.get(column) for row in stored]
        known = [cell for cell in cells if cell is not None]
        if not known:
            continue  # as if the table had no such column
        described = schema.get(column) if schema is not None else None
        numeric = not isinstance(known[0], str)
        columns[column] = described or Column(column, "number" if numeric else "text", units.get(column))
        data[column] = np.array(cells, dtype=float) if numeric else tuple("" if c is None else str(c) for c in cells)
    labels = [f"{origin}, row {row['designation']}" for row in stored]
    return Table(name, columns, data, labels, origin, np.ones(len(stored), dtype=bool))


def _table_of(
    head: list[str],
    body: list[tuple[int, list[str]]],
    schema: Schema | None,
    name: str,
    file: str,
    shipped: bool,
    reading: str,
    typed: bool = False,
) -> Table:
    """Return the table of a header and rows; ``file`` is where they stand, ``reading`` how, for messages.

    ``typed``: cells that are text were text where they stand, as in a workbook; in CSV nobody knows.
    """
    fits = _holds_header(schema)
    if not shipped and not fits(head):
        line = next((line for line, cells in body[:LOOKED_AT] if fits(cells)), None)
        if line is not None:
            shown = " ".join(cell for cell in head if cell.strip()) or None
            raise InputError(f"{file}, line 1", shown, header_first(line))
    if shipped and schema is not None:
        for title in head:
            if head.count(title) > 1:
                raise InputError(f"{file}, line 1", title, "each column once")
        fields = _strict_fields(head, schema, file)
    else:
        while head and not head[-1].strip() and all(not "".join(cells[len(head) - 1 :]).strip() for _, cells in body):
            head = head[:-1]
            body = [(line, cells[: len(head)]) for line, cells in body]
        fields = _user_fields(head, schema, f"{file}, line 1")
        body = [(line, cells) for line, cells in body if "".join(cells).strip()]
    if not body:
        raise InputError(file, "a header only", "at least one row below the header")
    rows: list[tuple[str, Sequence[object]]] = []
    for line, cells in body:
        if len(cells) != len(head):
            right = f"{len(head)} cells as in the header (decimal points, and quotes around a text that has a comma)"
            raise InputError(f"{file}, line {line}", f"{len(cells)} cells", right, (line,))
        for field in fields:
            if field.column.name == DESIGNATION and not shipped and not typed:
                with at(line, DESIGNATION):
                    cells[field.position] = _designation(
                        cells[field.position], f"{file}, line {line}, column {DESIGNATION}"
                    )
        rows.append((f"{file}, line {line}", cells))
    catalogue = any(field.column.name == DESIGNATION for field in fields)
    lines = [line for line, _ in body]
    table = _build(name, fields, rows, lines, SHIPPED if shipped else file, strict=shipped, catalogue=catalogue)
    table.readings = (reading,) if reading else ()
    return table


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


def is_frame(value: object) -> bool:
    """True if something is a pandas frame: whoever holds one has imported pandas, and looking must not."""
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(value, pandas.DataFrame)
