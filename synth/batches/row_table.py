"""Rows of a batch as they stand in a CSV file, an Excel sheet or a DataFrame: a header, and lines of text."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import islice
from pathlib import Path

from synth.errors import Described, InputError
from synth.folders.files import open_bytes, read_bytes
from synth.tables.delimited_text import DelimitedText, delimited_file, delimited_text, first_lines
from synth.tables.table_file import table_file
from synth.tables.workbook import LOOKED_AT, Sheet, cell_text, header_first, is_workbook, sheet_of, table_elsewhere
from synth.text.input_limits import INPUT_LIMITS
from synth.text.plain_text import as_list, as_meant

ROWS = "a CSV or .xlsx file"


@dataclass(frozen=True)
class RowTable:
    """A table of rows. It can be read again and again, and is read line by line.

    Parameters
    ----------
    name : str
        How messages call it.
    source : Path or sequence
        A file, or header and cells that are in memory.
    most : int or None
        Lines that are read of a file, to look at its head; None for all.
    """

    name: str
    source: Path | tuple[tuple[str, ...], tuple[tuple[str, ...], ...]]
    most: int | None = None

    def header(self) -> tuple[str, ...]:
        """Return the cells of the first line.

        Raises
        ------
        InputError
            The file cannot be read, or has no header.
        """
        for _, cells in self._records():
            return _checked_header(self.name, cells)
        raise InputError(self.name, "an empty file", "a header such as 'family,load_torque [N*m]' and rows below it")

    def lines(self) -> Iterator[tuple[int, tuple[str, ...]]]:
        """Return the lines below the header that are not blank: number in the file, cells.

        Raises
        ------
        InputError
            A line cannot be read, or they are too many.
        """
        records, count = self._records(), 0
        width = len(_checked_header(self.name, next(records)[1]))
        for number, cells in records:
            if any(cell.strip() for cell in cells):
                count += 1
                if count > INPUT_LIMITS.rows:
                    right = f"at most {INPUT_LIMITS.rows} rows; divide the table"
                    raise InputError(f"{self.name}, line {number}", Described("more rows than that"), right)
                spare = len(cells) > width and not any(cell.strip() for cell in cells[width:])
                yield number, cells[:width] if spare else cells

    def header_elsewhere(self, fits: Callable[[Sequence[str]], bool]) -> str:
        """Hint where a header is not in the first line; empty where no line near it is one."""
        if isinstance(self.source, Path) and is_workbook(self.source):
            return table_elsewhere(self.source, "rows", fits, self.name)
        return next((header_first(k) for k, cells in islice(self._records(), LOOKED_AT) if fits(cells)), "")

    def count(self) -> int:
        """Rows that are not blank."""
        return sum(1 for _ in self.lines())

    def digest(self) -> str:
        """Return the SHA-256 of the file, or of what is in memory."""
        if isinstance(self.source, Path):
            named = table_file(self.source)
            with open_bytes(named.path, "rows", ROWS) as content:
                checksum = hashlib.file_digest(content, "sha256")
            if named.path != self.source:
                checksum.update(self.source.name.removeprefix(named.path.name).encode())
            return checksum.hexdigest()
        return hashlib.sha256(repr(self.source).encode("utf-8", "surrogatepass")).hexdigest()

    def _records(self) -> Iterator[tuple[int, tuple[str, ...]]]:
        if not isinstance(self.source, Path):
            header, rows = self.source
            yield 1, header
            yield from enumerate(rows, start=2)
        elif is_workbook(self.source):
            yield from ((line, tuple(cells)) for line, cells in self._sheet.lines())
        else:
            yield from ((line, tuple(map(as_meant, cells))) for line, cells in self._text.lines())

    def sentence(self) -> str:
        """Dialect of the file, if not the expected one: delimiters, encoding, decimal commas, sheet."""
        if not isinstance(self.source, Path):
            return ""
        return self._sheet.sentence() if is_workbook(self.source) else self._text.sentence()

    @cached_property
    def _sheet(self) -> Sheet:
        assert isinstance(self.source, Path)
        return sheet_of(self.source, "rows", ROWS, name=self.name, most=self.most, most_bytes=INPUT_LIMITS.workbook)

    @cached_property
    def _text(self) -> DelimitedText:
        assert isinstance(self.source, Path)
        named = table_file(self.source)
        if self.most is None:
            return delimited_file(partial(open_bytes, named.path, "rows", ROWS), self.name, named.encoding)
        raw = read_bytes(named.path, "rows", ROWS)
        return delimited_text(first_lines(raw, self.name, self.most, named.encoding), self.name)


def read_table(table: object) -> RowTable:
    """Return the rows of a batch, whatever form they have.

    Parameters
    ----------
    table : path, DataFrame or sequence of mappings
        A CSV file, an Excel file (``file.xlsx#Sheet``; without that its first sheet), a DataFrame, or one mapping per
        row.

    Raises
    ------
    InputError
        It is none of these, or cannot be read.
    """
    if isinstance(table, RowTable):
        return table
    if isinstance(table, (str, Path)):
        path = Path(table)
        file = table_file(path).path
        open_bytes(file, "rows", ROWS).close()
        if path.suffix.lower() == ".xls":
            raise InputError("rows", str(table), f"{ROWS}; save the old format .xls as one of these")
        return RowTable(file.name, path)
    if isinstance(table, Sequence) and table and all(isinstance(row, Mapping) for row in table):
        names = tuple(dict.fromkeys(str(key) for row in table for key in row))
        cells = [{str(key): text_of(value) for key, value in row.items()} for row in table]
        return RowTable("rows", (names, tuple(tuple(row.get(name, "") for name in names) for row in cells)))
    pandas = sys.modules.get("pandas")  # whoever holds a DataFrame has imported it
    if pandas is not None and isinstance(table, pandas.DataFrame):
        present = table.notna().to_numpy()
        columns = [table.iloc[:, j].tolist() for j in range(table.shape[1])]
        rows = tuple(
            tuple(text_of(columns[j][i]) if present[i, j] else "" for j in range(len(columns)))
            for i in range(len(table))
        )
        return RowTable("DataFrame", (tuple(str(name) for name in table.columns), rows))
    raise InputError("rows", type(table).__name__, "a CSV or .xlsx file, a DataFrame, or a list of mappings")


def text_of(value: object) -> str:
    """Return a cell as the text that somebody would have typed.

    Examples
    --------
    >>> text_of(20.0), text_of(True), text_of({"mass": "<= 20 kg", "friction_pair": ["a", "b"]})
    ('20', 'yes', 'mass: <= 20 kg; friction_pair: a, b')
    """
    if isinstance(value, Mapping):
        return "; ".join(f"{name}: {part}" for name, parts in value.items() for part in _several(name, parts))
    return cell_text(value)


def _several(name: str, value: object) -> list[str]:
    """Parsed entry of a mapping; a list of comparisons is several entries, one of names is one."""
    if not isinstance(value, (list, tuple)):
        return [text_of(value)]
    texts = [text_of(entry) for entry in value]
    compared = any(text.lstrip()[:1] in ("<", ">", "=") or ".." in text for text in texts)
    return texts if compared else [as_list(texts)]


def _checked_header(name: str, cells: Sequence[str]) -> tuple[str, ...]:
    titles = [cell.strip() for cell in cells]
    while titles and not titles[-1]:
        titles.pop()
    where = f"{name}, line 1"
    if not titles:
        raise InputError(where, None, "a header such as 'family,load_torque [N*m]'")
    if len(titles) > INPUT_LIMITS.columns:
        raise InputError(where, f"{len(titles)} columns", f"at most {INPUT_LIMITS.columns}")
    for title in titles:
        if not title:
            raise InputError(where, "a column without a name", "a name for each column")
        if titles.count(title) > 1:
            raise InputError(where, title, "each column once")
    return tuple(titles)
