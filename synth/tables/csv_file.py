"""CSV files, read strictly."""

from __future__ import annotations

import csv
import io
from pathlib import Path

from synth.errors import InputError
from synth.files import read_bytes

# ---- reading --------------------------------------------------------------------------------------------------------


def read_csv_file(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows with their line numbers."""
    return read_csv_bytes(read_bytes(path, "catalogue file", "a CSV file"), path.name)


def read_csv_bytes(raw: bytes, name: str) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows with their line numbers of what stands in a file; ``name`` is that of it, for messages."""
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
