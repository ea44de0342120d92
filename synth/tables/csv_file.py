"""CSV files, read strictly; how they are written is recognised."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from synth.errors import InputError
from synth.folders.files import read_bytes
from synth.tables.delimited_text import DelimitedText, delimited_text
from synth.tables.table_file import TableFile, table_file

# ---- reading --------------------------------------------------------------------------------------------------------


def read_csv_file(path: Path, plain: bool = False) -> CsvFile:
    """Content of a file; ``plain``: written in one way alone, as shipped tables are."""
    file = TableFile(path) if plain else table_file(path)
    raw = read_bytes(file.path, "catalogue file", "a CSV file")
    return read_csv_bytes(raw, file.path.name, plain, file.encoding)


def read_csv_bytes(raw: bytes, name: str, plain: bool = False, encoding: str = "") -> CsvFile:
    """Content of the bytes of a file; ``name`` is that of the file, for messages."""
    text = delimited_text(raw, name, encoding)
    if plain and text.sentence():
        right = "columns separated by commas, decimal points, UTF-8"
        raise InputError(f"{name}, line 1", text.sentence().removeprefix(f"{name}: "), right)
    if not any(line.strip() for line in text.written_lines()):
        raise InputError(name, "an empty file", "a header row and at least one row below it")
    return CsvFile(text)


@dataclass(frozen=True)
class CsvFile:
    """A table as it is written; there is something in it."""

    text: DelimitedText

    def rows(self) -> tuple[list[str], list[tuple[int, list[str]]]]:
        """Return header, and rows with their line numbers."""
        (_, head), *rows = self.text.lines()
        return head, rows

    def sentence(self) -> str:
        """Dialect of the file, if not the expected one."""
        return self.text.sentence()
