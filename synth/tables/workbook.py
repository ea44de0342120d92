"""Sheets of workbooks: which one is meant, and its cells as the text that somebody would have typed.

Numbers that stand as text are read by the rule of text columns. A date is given as one: where a number is wanted it is
refused, as Excel has made it of a number that somebody typed. A formula whose value the file does not hold is refused.
"""

from __future__ import annotations

import datetime
import io
import re
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from synth.errors import Described, InputError
from synth.folders.files import read_bytes
from synth.tables.number_columns import PLAIN_NUMBERS, NumberColumn, WrittenNumbers, written_numbers
from synth.tables.table_file import VISIBLE, table_file
from synth.text.input_limits import INPUT_LIMITS
from synth.text.plain_text import as_meant, counted

TAGS = re.compile(rb"<(?:\w+:)?(row|mergeCell)\s([^>]*)>")
ROW = re.compile(rb"<((?:\w+:)?row)\s([^>]*?)(?:/>|>.*?</\1>)", re.DOTALL)
TRUE = (b"1", b"true")
LEAVE_OUT = f"--visible-rows, or #{VISIBLE} behind the name, leaves them out"
ATTRIBUTES = re.compile(rb"(\w+)=[\"']([^\"']*)[\"']")
SHOWN = 6  # rows that are listed by number
LOOKED_AT = 20  # lines above which a table may begin in vain
FORMULA = re.compile(rb"<f[ >/]")
TEXT_RESULT = "str"  # the kind of a formula's value that is text, also where that is empty
CHUNK = 1 << 20


def split_sheet(path: Path) -> tuple[Path, str]:
    """Return the file and the sheet of ``file.xlsx#Sheet``; no sheet where none is named.

    Examples
    --------
    >>> split_sheet(Path("parts/own.xlsx#Linings"))[1], split_sheet(Path("own.csv"))[1]
    ('Linings', '')
    """
    file = table_file(path)
    return file.path, file.sheet


def is_workbook(path: Path) -> bool:
    """True if a file, perhaps with a sheet named, is a workbook."""
    return table_file(path).is_workbook


def cell_text(value: object) -> str:
    """Return the value of a cell as the text that somebody would have typed.

    Examples
    --------
    >>> cell_text(20.0), cell_text(True), cell_text(None), cell_text(datetime.datetime(2024, 5, 1))
    ('20', 'yes', '', '2024-05-01')
    """
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    if isinstance(value, datetime.datetime):
        return value.date().isoformat() if value.time() == datetime.time() else value.isoformat(" ", "seconds")
    return str(value)


@dataclass(frozen=True)
class Sheet:
    """A sheet of a workbook. It can be read again and again, and is read line by line.

    Parameters
    ----------
    name : str
        How messages call the workbook.
    named_by : str
        What names it, for messages.
    raw : bytes
        The file.
    title : str
        Of the sheet.
    position : int
        Which of the sheets it is, from 0.
    several : bool
        Whether there are others.
    unseen : bool
        Whether the sheet itself is hidden.
    hidden : tuple of int
        Rows with something in them that are hidden, by hand or by a filter.
    omitted : bool
        Whether hidden rows are left out.
    numbers : WrittenNumbers
        How the numbers are written that stand as text.
    most : int or None
        Lines that are read; None for all.
    """

    name: str
    named_by: str
    raw: bytes = field(repr=False)
    title: str
    position: int
    several: bool
    unseen: bool = False
    hidden: tuple[int, ...] = ()
    omitted: bool = False
    numbers: WrittenNumbers = PLAIN_NUMBERS
    most: int | None = None

    def lines(self, text: Callable[[Any], str] = cell_text) -> Iterator[tuple[int, list[str]]]:
        """Return number and cells of every line, numbers with decimal points; ``text``: what a value is as text.

        Raises
        ------
        InputError
            It cannot be read.
        """
        for number, cells in self.values():
            texts = [as_meant(text(cell)) for cell in cells]
            read = self.numbers.read([*texts])
            yield number, [r if isinstance(c, str) else t for r, t, c in zip(read, texts, cells, strict=True)]

    def sentence(self) -> str:
        """Recognised dialect, in a sentence; empty where there is one way to read the sheet."""
        sheet = f"{'hidden ' if self.unseen else ''}sheet {self.title}"
        remarks = [sheet] if self.several or self.unseen or self.hidden else []
        if self.hidden:
            listed = ", ".join(map(str, self.hidden[:SHOWN])) + (", ..." if len(self.hidden) > SHOWN else "")
            rows = counted(len(self.hidden), "hidden or filtered row")
            remarks.append(f"without {rows} ({listed})" if self.omitted else f"with {rows} ({listed}; {LEAVE_OUT})")
        if self.numbers.titles:
            remarks.append(self.numbers.sentence())
        return f"{self.name}: {', '.join(remarks)}" if remarks else ""

    def values(self) -> Iterator[tuple[int, tuple[Any, ...]]]:
        """Return number and values of every line that is read."""
        with _book(self.raw, self.name, self.named_by) as book:
            rows = book.worksheets[self.position].iter_rows(values_only=True, max_row=self.most)
            yield from enumerate(_checked_rows(rows, self.name, self.named_by), start=1)

    def recognised(self, visible: bool = False) -> Sheet:
        """Return the sheet with how its numbers are written, and its hidden rows; ``visible``: these are left out.

        Raises
        ------
        InputError
            Texts of a column can be read as two numbers, the value of a formula is missing, or cells are merged.
        """
        hidden, merged = self._layout()
        if merged:
            right = "one cell for each value: unmerge them, and fill in all that they stood for"
            raise InputError(f"{self.name}, sheet {self.title}", Described(f"merged cells, {merged}"), right)
        sheet = self
        if visible and hidden:
            sheet = replace(self, raw=without_hidden_rows(self.raw, self.name, self.named_by), omitted=True)
        sheet._check_formulas()
        columns: list[NumberColumn] = []
        header: list[str] = []
        filled = list[int]()
        if hidden:
            filled = [k for k, cells in self.values() if k in hidden and any(c not in (None, "") for c in cells)]
        for number, cells in sheet.values():
            if number == 1:
                header = [cell_text(cell) for cell in cells]
                columns = [NumberColumn() for _ in header]
                continue
            for column, cell in zip(columns, cells, strict=False):
                if isinstance(cell, str):
                    column.add(number, as_meant(cell))
                elif isinstance(cell, (int, float)):
                    column.add_number()
        numbers = written_numbers(header, columns, f"{self.name}, sheet {self.title}")
        return replace(sheet, numbers=numbers, hidden=tuple(filled))

    def _layout(self) -> tuple[set[int], str]:
        """Hidden rows, and some merged cells: readers that go line by line do not see them."""
        with _book(self.raw, self.name, self.named_by) as book:
            place = book.worksheets[self.position]._worksheet_path
        hidden, line = set[int](), 0
        for tag, tag_text in _checked_rows(_tags(self.raw, place), self.name, self.named_by):
            attributes = dict(ATTRIBUTES.findall(tag_text))
            if tag == b"mergeCell":
                return hidden, attributes.get(b"ref", b"").decode("ascii", "replace")
            line = int(attributes.get(b"r", line + 1))
            if line > 1 and attributes.get(b"hidden") in TRUE:
                hidden.add(line)
        return hidden, ""

    def _check_formulas(self) -> None:
        """Refuse formulas whose values are not in the file: a program that computes nothing has written it."""
        if not _has_formulas(self.raw):
            return
        with (
            _book(self.raw, self.name, self.named_by) as values,
            _book(self.raw, self.name, self.named_by, True) as formulas,
        ):
            sheets = (book.worksheets[self.position].iter_rows(max_row=self.most) for book in (values, formulas))
            pairs = zip(*(_checked_rows(rows, self.name, self.named_by) for rows in sheets), strict=False)
            for number, (cells, written) in enumerate(pairs, start=1):
                for cell, formula in zip(cells, written, strict=False):
                    if cell.value is None and formula.value is not None and cell.data_type != TEXT_RESULT:
                        where = f"{self.name}, sheet {self.title}, cell {formula.coordinate}"
                        right = "its value as well: open the file in a table program and save it there"
                        raise InputError(where, "a formula", right, (self.named_by, number))


def sheet_of(
    path: Path,
    field: str,
    right: str,
    fits: Callable[[list[str]], bool] = lambda header: True,
    name: str = "",
    most: int | None = None,
    most_bytes: int = INPUT_LIMITS.file,
) -> Sheet:
    """Return the sheet of a workbook that is meant.

    Parameters
    ----------
    path : Path
        The file; ``file.xlsx#Sheet`` names one of its sheets.
    field : str
        What names it, for messages.
    right : str
        What it should be, for messages.
    fits : callable
        Told the first line of a sheet. Where no sheet is named, it is the first one for which this holds, or else the
        first; hidden sheets come last.
    name : str
        How messages call it; by default as the file.
    most : int, optional
        Lines that are read of it.
    most_bytes : int
        Of the file.

    Raises
    ------
    InputError
        It cannot be read, there is no such sheet, or its numbers can be read in two ways.
    """
    named = table_file(path)
    file, title = named.path, named.sheet
    raw, name = read_bytes(file, field, right, most_bytes), name or file.name
    with _book(raw, name, field) as book:
        titles = [sheet.title for sheet in book.worksheets]
        if not titles:
            raise InputError(field, name, "a workbook with a sheet in it")
        if title and title not in titles:
            raise InputError(field, f"{name}#{title}", f"a sheet that it has: {', '.join(titles)}")
        unseen = [sheet.sheet_state != "visible" for sheet in book.worksheets]
        order = sorted(range(len(titles)), key=unseen.__getitem__)
        position = titles.index(title) if title else order[0]
        if not title and len(titles) > 1:
            sheets = ((k, book.worksheets[k].iter_rows(values_only=True)) for k in order)
            heads = ((k, next(_checked_rows(rows, name, field), ())) for k, rows in sheets)
            position = next((k for k, head in heads if fits([cell_text(cell) for cell in head])), order[0])
    chosen = Sheet(name, field, raw, titles[position], position, len(titles) > 1, unseen[position], most=most)
    return chosen.recognised(named.visible)


def without_hidden_rows(raw: bytes, name: str, field: str) -> bytes:
    """Return a workbook whose hidden rows are empty, but for first rows.

    Raises
    ------
    InputError
        It cannot be read.
    """

    def shown(row: re.Match[bytes]) -> bytes:
        attributes = dict(ATTRIBUTES.findall(row[2]))
        return b"" if attributes.get(b"hidden") in TRUE and attributes.get(b"r") != b"1" else row[0]

    packed = io.BytesIO()
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as written:
            for entry in archive.infolist():
                content = archive.read(entry)
                written.writestr(entry, ROW.sub(shown, content) if "worksheets/" in entry.filename else content)
    except Exception as error:  # whatever a broken archive may raise
        raise InputError(field, name, f"an Excel file that can be read ({type(error).__name__})") from error
    return packed.getvalue()


def table_elsewhere(path: Path, field: str, fits: Callable[[list[str]], bool], name: str = "") -> str:
    """Hint where the header of a table is not in the first row of the sheet that is meant.

    Parameters
    ----------
    path, field, fits, name
        As for :func:`sheet_of`.

    Returns
    -------
    str
        Where it stands and what to do; nothing where no row that is looked at is one.
    """
    named = table_file(path)
    name = name or named.path.name
    with _book(read_bytes(named.path, field), name, field) as book:
        first = book.worksheets[0].title
        for sheet in book.worksheets:
            if named.sheet in ("", sheet.title):
                rows = _checked_rows(sheet.iter_rows(values_only=True, max_row=LOOKED_AT), name, field)
                for number, cells in enumerate(rows, start=1):
                    if fits([cell_text(cell) for cell in cells]):
                        return header_first(number, "" if named.sheet or sheet.title == first else sheet.title)
    return ""


def header_first(line: int, sheet: str = "") -> str:
    """Hint where a header is not in the first line, or on another sheet than the first."""
    where = f"{line} of sheet {sheet}" if sheet else str(line)
    ways = [f"name that sheet (#{sheet} behind the name)"] if sheet else []
    ways += ["delete what is above it"] if line > 1 else []
    return f"the header in the first line; it stands in line {where}: {', and '.join(ways)}"


@contextmanager
def _book(raw: bytes, name: str, field: str, formulas: bool = False) -> Iterator[Any]:
    """Give an open workbook; ``formulas``: with them in place of their values.

    Raises
    ------
    InputError
        It cannot be read.
    """
    try:
        import openpyxl  # an extra; only for those who have such files
    except ImportError:
        raise InputError(field, name, "CSV, or the extra for Excel: pip install 'clutchsynth[excel]'") from None
    packed = io.BytesIO(raw)
    try:
        with zipfile.ZipFile(packed) as archive:
            unpacked = sum(entry.file_size for entry in archive.infolist())
        book = (
            openpyxl.load_workbook(packed, read_only=True, data_only=not formulas)
            if unpacked <= INPUT_LIMITS.workbook
            else None
        )
    except Exception as error:  # whatever a broken archive may raise
        raise InputError(field, name, f"an Excel file that can be read ({type(error).__name__})") from error
    if book is None:
        raise InputError(field, name, f"an Excel file of at most {INPUT_LIMITS.workbook // 1_000_000} MB when unpacked")
    try:
        yield book
    finally:
        book.close()


def _checked_rows(rows: Iterator[Any], name: str, field: str) -> Iterator[Any]:
    """Yield the rows of a sheet, which is read as it is gone through: only now what is broken in it shows.

    Raises
    ------
    InputError
        Something of it cannot be read.
    """
    while True:
        try:
            cells = next(rows)
        except StopIteration:
            return
        except Exception as error:  # whatever a broken sheet may raise
            raise InputError(field, name, f"an Excel file that can be read ({type(error).__name__})") from error
        yield cells


def _tags(raw: bytes, place: str) -> Iterator[tuple[bytes, bytes]]:
    """Yield the tags of rows and of merged cells in a sheet, with their attributes."""
    with zipfile.ZipFile(io.BytesIO(raw)) as archive, archive.open(place.lstrip("/")) as file:
        before = b""
        while chunk := file.read(CHUNK):
            text, mark, before = (before + chunk).rpartition(b">")
            yield from ((tag[1], tag[2]) for tag in TAGS.finditer(text + mark))


def _has_formulas(raw: bytes) -> bool:
    """True if a workbook, which has been opened before, has a formula anywhere: most have none."""
    with zipfile.ZipFile(io.BytesIO(raw)) as archive:
        for entry in archive.infolist():
            if not entry.filename.endswith(".xml") or "worksheets/" not in entry.filename:
                continue
            before = b""
            try:
                with archive.open(entry) as file:
                    while chunk := file.read(CHUNK):
                        if FORMULA.search(before + chunk):
                            return True
                        before = chunk[-2:]
            except Exception:  # what is broken in it shows when its rows are read
                return False
    return False
