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

from synth.errors import InputError
from synth.files import read_bytes
from synth.input_limits import INPUT_LIMITS
from synth.plain_text import as_meant
from synth.tables.number_columns import PLAIN_NUMBERS, NumberColumn, WrittenNumbers, written_numbers

EXCEL = (".xlsx", ".xlsm")
SHEET = re.compile(r"(.*\.xls[xm])#(.+)", re.IGNORECASE)
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
    found = SHEET.fullmatch(path.name)
    return (path, "") if found is None or path.exists() else (path.with_name(found[1]), found[2])


def is_workbook(path: Path) -> bool:
    """Tell whether a file, perhaps with a sheet named, is a workbook."""
    return split_sheet(path)[0].suffix.lower() in EXCEL


def cell_text(value: Any) -> str:
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
        whole = value.time() == datetime.time()
        return value.date().isoformat() if whole else value.isoformat(" ", "seconds")
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
    numbers : WrittenNumbers
        How the numbers are written that stand as text.
    """

    name: str
    named_by: str
    raw: bytes = field(repr=False)
    title: str
    position: int
    several: bool
    numbers: WrittenNumbers = PLAIN_NUMBERS

    def lines(self, text: Callable[[Any], str] = cell_text) -> Iterator[tuple[int, list[str]]]:
        """Return number and cells of every line, numbers with decimal points; ``text``: what a value is as text.

        Raises
        ------
        InputError
            It cannot be read.
        """
        for number, cells in self._values():
            texts = [as_meant(text(cell)) for cell in cells]
            read = self.numbers.read([*texts])
            yield number, [r if isinstance(c, str) else t for r, t, c in zip(read, texts, cells, strict=True)]

    def sentence(self) -> str:
        """Return what was recognised, in a sentence; nothing where there is one way to read it."""
        told = [f"sheet {self.title}"] if self.several else []
        if self.numbers.titles:
            told.append(self.numbers.sentence())
        return f"{self.name}: {', '.join(told)}" if told else ""

    def _values(self) -> Iterator[tuple[int, tuple[Any, ...]]]:
        with _book(self.raw, self.name, self.named_by) as book:
            rows = book.worksheets[self.position].iter_rows(values_only=True)
            yield from enumerate(_whole(rows, self.name, self.named_by), start=1)

    def recognised(self) -> Sheet:
        """Return the sheet with how its numbers are written.

        Raises
        ------
        InputError
            Texts of a column can be read as two numbers, or the value of a formula is missing.
        """
        self._check_formulas()
        columns: list[NumberColumn] = []
        header: list[str] = []
        for number, cells in self._values():
            if number == 1:
                header = [cell_text(cell) for cell in cells]
                columns = [NumberColumn() for _ in header]
                continue
            for column, cell in zip(columns, cells, strict=False):
                if isinstance(cell, str):
                    column.add(number, as_meant(cell))
                elif isinstance(cell, (int, float)):
                    column.add_number()
        return replace(self, numbers=written_numbers(header, columns, f"{self.name}, sheet {self.title}"))

    def _check_formulas(self) -> None:
        """Refuse formulas whose values are not in the file: a program that computes nothing has written it."""
        if not _has_formulas(self.raw):
            return
        with (
            _book(self.raw, self.name, self.named_by) as values,
            _book(self.raw, self.name, self.named_by, True) as formulas,
        ):
            sheets = (book.worksheets[self.position].iter_rows() for book in (values, formulas))
            pairs = zip(*(_whole(rows, self.name, self.named_by) for rows in sheets), strict=False)
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
        first.
    name : str
        How messages call it; by default as the file.

    Raises
    ------
    InputError
        It cannot be read, there is no such sheet, or its numbers can be read in two ways.
    """
    file, wanted = split_sheet(path)
    raw, name = read_bytes(file, field, right), name or file.name
    with _book(raw, name, field) as book:
        titles = [sheet.title for sheet in book.worksheets]
        if not titles:
            raise InputError(field, name, "a workbook with a sheet in it")
        if wanted and wanted not in titles:
            raise InputError(field, f"{name}#{wanted}", f"a sheet that it has: {', '.join(titles)}")
        position = titles.index(wanted) if wanted else 0
        if not wanted and len(titles) > 1:
            heads = (next(_whole(sheet.iter_rows(values_only=True), name, field), ()) for sheet in book.worksheets)
            position = next((k for k, head in enumerate(heads) if fits([cell_text(cell) for cell in head])), 0)
    return Sheet(name, field, raw, titles[position], position, len(titles) > 1).recognised()


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


def _whole(rows: Iterator[Any], name: str, field: str) -> Iterator[Any]:
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


def _has_formulas(raw: bytes) -> bool:
    """Tell whether a workbook, which has been opened before, has a formula anywhere: most have none."""
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
