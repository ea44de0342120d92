"""What users bring, looked at: rows for a batch, and part tables."""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from synth.batches.row_table import RowTable
from synth.errors import Described, InputError, shortened
from synth.kinds.settings import KIND_SETTINGS
from synth.model.registry import every_declaration
from synth.question.catalogs import as_catalogs, meant_by, needed_columns
from synth.queue.records import ReportProgress
from synth.tables.catalogs import Catalogs, must_have_designation
from synth.tables.delimited_text import DelimitedText, delimited_text, first_lines
from synth.tables.reading import csv_of_file
from synth.tables.schema import SCHEMA_SUFFIX, Schema, schema_of_text
from synth.tables.table_text import TableText
from synth.text.plain_text import printable
from synth.units import split_header

OF_ROWS = ("source", "confidence")  # that every row has, in any table


def rows_of_file(payload: Mapping[str, Any], tell: ReportProgress) -> dict[str, Any]:
    """Dialect of a file with rows for a batch, its header and its first rows.

    Raises
    ------
    InputError
        It cannot be read.
    """
    with _as_file(payload) as file:
        table = RowTable(payload["name"], file, KIND_SETTINGS.head)
        first = list(itertools.islice(table.lines(), payload["most"]))
        return {
            "reading": printable(table.sentence()),
            "header": list(table.header()),
            "rows": [{"line": line, "cells": list(cells)} for line, cells in first],
        }


def text_of_file(payload: Mapping[str, Any], tell: ReportProgress) -> str:
    """Return the text of a file with a part table; of a workbook that of ``sheet``, or the first with designations.

    Raises
    ------
    InputError
        It cannot be read.
    """
    with _as_file(payload) as file:
        return csv_of_file(file.with_name(f"{file.name}#{payload['sheet']}") if payload["sheet"] else file)


@contextmanager
def _as_file(payload: Mapping[str, Any]) -> Iterator[Path]:
    """Put what was brought into a file while it is read."""
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as folder:
        file = Path(folder) / f"table{Path(payload['name']).suffix}"
        file.write_bytes(payload["content"])
        yield file


def part_table(payload: Mapping[str, Any], tell: ReportProgress) -> dict[str, Any]:
    """Read a part table as a question would.

    Returns
    -------
    dict
        ``rows``: how many there are; ``reading``: how the text is written; ``columns``: which of them families know,
        and what is perhaps meant by the others; ``missing``: what slots of families cannot do without, with the
        options as they are by default; ``remarks``: all of this that is not as it should be, in sentences.

    Raises
    ------
    InputError
        Something of it is wrong: under ``csv`` or ``schema``.
    """
    name, text = payload["table"], TableText(reference=payload["name"], csv=payload["csv"], schema=payload["schema"])
    shipped = Catalogs()
    if not text.schema and name not in shipped.names():
        right = f"a table that families use ({', '.join(shipped.names())}), or a schema for one of your own"
        raise InputError("table", name, right, ("table",))
    try:
        _look_at_head(text, shipped.schema(name))
        table = Catalogs({name: text}).table(name)
    except InputError as fault:
        in_schema = fault.field.startswith(f"{text.reference}{SCHEMA_SUFFIX}")
        fault.path = ("schema" if in_schema else "csv",)
        raise
    if not len(table):
        raise InputError(f"{text.reference}", "a header only", "at least one row below the header", ("csv",))
    written = delimited_text(text.csv.encode(), text.reference)
    columns = _columns(written, text, shipped.schema(name))
    there = {column["name"] for column in columns}
    missing = [one for one in _needed().get(name, ()) if not there & {*one[2]}]
    slots = dict.fromkeys((family, slot) for family, slot, _ in missing)
    return {
        "rows": len(table),
        "reading": {
            "separator": written.delimiter,
            "encoding": written.encoding,
            "decimal_commas": list(written.numbers.titles),
        },
        "columns": columns,
        "missing": [
            {
                "family": family,
                "slot": slot,
                "columns": [" or ".join(names) for *place, names in missing if place == [family, slot]],
            }
            for family, slot in slots
        ],
        "remarks": _remarks(written, columns, missing),
    }


def _look_at_head(text: TableText, known: Schema | None) -> None:
    """Refuse a table that is too long, or whose rows have no names, before its cells are read.

    Raises
    ------
    InputError
    """
    lines = text.csv.count("\n")
    if lines > KIND_SETTINGS.part_rows:
        got = Described(f"{lines} lines")
        raise InputError(text.reference, got, f"a part table of at most {KIND_SETTINGS.part_rows}", ("csv",))
    if text.schema:
        return  # which may do without
    head = delimited_text(first_lines(text.csv.encode(), text.reference, KIND_SETTINGS.head), text.reference)
    _, titles = next(head.lines(), (1, []))
    must_have_designation([split_header(title)[0] for title in titles if title.strip()], known, text.reference)


def _columns(written: DelimitedText, text: TableText, known: Schema | None) -> list[dict[str, Any]]:
    """Return the columns of a table as they stand there, and which of them are known."""
    _, head = next(written.lines())
    found = [(*split_header(title), title) for title in head if title.strip()]
    schemas = [known, schema_of_text(text.schema, text.reference + SCHEMA_SUFFIX) if text.schema else None]
    names = [column.name for schema in schemas if schema is not None for column in schema.columns]
    there = {name for name, *_ in found}
    absent = [name for name in names if name not in there]
    return [
        {
            "name": name,
            "unit": unit,
            "known": name in (*names, *OF_ROWS),
            "meant": None if name in (*names, *OF_ROWS) else meant_by(name, absent),
        }
        for name, unit, _ in found
    ]


@cache
def _needed() -> Mapping[str, tuple[tuple[str, str, tuple[str, ...]], ...]]:
    """Return by table what families cannot do without: family, slot, and the names of which one is enough."""
    found: dict[str, dict[tuple[str, str, tuple[str, ...]], None]] = {}
    for problem, declared in every_declaration(as_catalogs(None)):
        for part, names in needed_columns(declared):
            found.setdefault(part.table, {})[problem.name, part.slot, names] = None
    return {table: tuple(needed) for table, needed in found.items()}


def _remarks(
    written: DelimitedText, columns: Sequence[Mapping[str, object]], missing: Sequence[tuple[str, str, tuple[str, ...]]]
) -> list[str]:
    """Return in sentences what whoever brings a table should look at."""
    told = [written.sentence()] if written.sentence() else []
    for column in columns:
        if not column["known"]:
            meant = f"; did you mean {column['meant']}?" if column["meant"] else ""
            told.append(f"column {column['name']}: no family knows it, and it is carried along{meant}")
    lacking: dict[str, dict[str, None]] = {}
    for family, slot, names in missing:
        lacking.setdefault(" or ".join(names), {})[f"{slot} of {family}"] = None
    told += [f"column {name} is missing, which {', '.join(users)} cannot do without" for name, users in lacking.items()]
    return [printable(shortened(text, KIND_SETTINGS.remark)) for text in told]
