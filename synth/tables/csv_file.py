"""CSV files, read strictly; how they are written is recognised."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from synth.errors import InputError
from synth.files import read_bytes
from synth.tables.delimited_text import DelimitedText, delimited_text

# ---- reading --------------------------------------------------------------------------------------------------------


def read_csv_file(path: Path, plain: bool = False) -> CsvFile:
    """Return what stands in a file; ``plain``: written in one way alone, as tables of ours are."""
    return read_csv_bytes(read_bytes(path, "catalogue file", "a CSV file"), path.name, plain)


def read_csv_bytes(raw: bytes, name: str, plain: bool = False) -> CsvFile:
    """Return what stands in the bytes of a file; ``name`` is that of it, for messages."""
    found = delimited_text(raw, name)
    if plain and found.sentence():
        right = "columns separated by commas, decimal points, UTF-8"
        raise InputError(f"{name}, line 1", found.sentence().removeprefix(f"{name}: "), right)
    if not found.text.strip():
        raise InputError(name, "an empty file", "a header row and at least one row below it")
    return CsvFile(found)


@dataclass(frozen=True)
class CsvFile:
    """A table as it is written; there is something in it."""

    text: DelimitedText

    def rows(self) -> tuple[list[str], list[tuple[int, list[str]]]]:
        """Return header, and rows with their line numbers."""
        (_, head), *rows = self.text.lines()
        return head, rows

    def sentence(self) -> str:
        """Return how it is written, if not as is expected."""
        return self.text.sentence()
