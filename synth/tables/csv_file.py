"""CSV files, read strictly; how they are written is recognised."""

from __future__ import annotations

from pathlib import Path

from synth.errors import InputError
from synth.files import read_bytes
from synth.tables.delimited_text import delimited_text

# ---- reading --------------------------------------------------------------------------------------------------------


def read_csv_file(path: Path, plain: bool = False) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows with their line numbers; ``plain``: written in one way alone, as tables of ours are."""
    return read_csv_bytes(read_bytes(path, "catalogue file", "a CSV file"), path.name, plain)


def read_csv_bytes(raw: bytes, name: str, plain: bool = False) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Header and rows with their line numbers of what stands in a file; ``name`` is that of it, for messages."""
    found = delimited_text(raw, name)
    if plain and found.sentence():
        right = "columns separated by commas, decimal points, UTF-8"
        raise InputError(f"{name}, line 1", found.sentence().removeprefix(f"{name}: "), right)
    if not found.text.strip():
        raise InputError(name, "an empty file", "a header row and at least one row below it")
    (_, head), *rows = found.lines()
    return head, rows
