"""What users bring, looked at: rows for a batch, and part tables."""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.jobs.engine_tasks import Tell
from synth.jobs.row_table import RowTable
from synth.tables.catalogs import Catalogs
from synth.tables.schema import SCHEMA_SUFFIX
from synth.tables.table_text import TableText


def rows_of_file(payload: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Return the header and the first rows of a file with rows for a batch.

    Raises
    ------
    InputError
        It cannot be read.
    """
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as folder:
        file = Path(folder) / f"table{Path(payload['name']).suffix}"
        file.write_bytes(payload["content"])
        table = RowTable(payload["name"], file)
        first = list(itertools.islice(table.lines(), payload["most"]))
        return {
            "header": list(table.header()),
            "rows": [{"line": line, "cells": list(cells)} for line, cells in first],
        }


def part_table(payload: Mapping[str, Any], tell: Tell) -> dict[str, Any]:
    """Read a part table as a question would, and return how many rows it has and its columns.

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
        table = Catalogs({name: text}).table(name)
    except InputError as fault:
        in_schema = fault.field.startswith(f"{text.reference}{SCHEMA_SUFFIX}")
        fault.path = ("schema" if in_schema else "csv",)
        raise
    if not len(table):
        raise InputError(f"{text.reference}", "a header only", "at least one row below the header", ("csv",))
    return {"rows": len(table), "columns": [column.heading for column in table.columns.values()]}
