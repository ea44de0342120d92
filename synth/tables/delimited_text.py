"""Tables as spreadsheets of any country write them: encodings, delimiters and decimal commas are recognised and told.

What is not beyond doubt is asked back, never guessed: a number such as 1,234 in a table with semicolons may be 1.234
or 1234.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from synth.errors import InputError

DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs"}
MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
# What Excel writes in western Europe and America where it does not write UTF-8. Detectors of encodings are no help with
# short tables: they take the superscript of mm² for a letter of another code page.
WESTERN = "cp1252"
SAMPLE = 200  # lines by which delimiters are compared
NUMBER = re.compile(
    r"(?P<before>\s*(?:[<>=]=?|[≤≥])?\s*[-+]?)(?P<number>\d[\d.,\u00a0\u202f]*)(?P<after>(?:[eE][-+]?\d+)?\s*(?:[^\d\s,.;][^,;]*)?)"
)
GROUPED = re.compile(r"\d{1,3}(?:[.\u00a0\u202f]\d{3})+,\d+")
PLAIN = re.compile(r"\d+,\d+")
DOUBTFUL = re.compile(r"[1-9]\d{0,2},\d{3}")
THOUSANDS = re.compile(r"[1-9]\d{0,2}(?:\.\d{3})+")  # where others have decimal commas


@dataclass(frozen=True)
class DelimitedText:
    """The text of a table, and how it is written.

    Parameters
    ----------
    name : str
        How messages call it.
    text : str
        Without byte order mark and without the line that names the delimiter.
    encoding, delimiter : str
    first : int
        Number of the first line of the text in the file.
    commas : tuple of int
        Columns, from 0, whose numbers have decimal commas.
    titles : tuple of str
        Of those columns.
    """

    name: str
    text: str
    encoding: str
    delimiter: str
    first: int = 1
    commas: tuple[int, ...] = ()
    titles: tuple[str, ...] = ()

    def lines(self) -> Iterator[tuple[int, list[str]]]:
        """Return number in the file and cells of every line, numbers with decimal points.

        Raises
        ------
        InputError
            A quote does not close.
        """
        for number, cells in self._written():
            for k in self.commas:
                if k < len(cells):
                    cells[k] = with_point(cells[k])
            yield number, cells

    def sentence(self) -> str:
        """Return what was recognised, in a sentence; nothing where it is written as is expected."""
        told = []
        if self.delimiter != ",":
            told.append(f"{DELIMITERS[self.delimiter]} between the columns")
        if self.encoding in (WESTERN, "utf-16"):
            told.append("text in Windows-1252" if self.encoding == WESTERN else "text in UTF-16")
        if self.titles:
            told.append(f"decimal commas in {', '.join(self.titles)}")
        return f"{self.name}: {', '.join(told)}" if told else ""

    def _written(self) -> Iterator[tuple[int, list[str]]]:
        reader = csv.reader(io.StringIO(self.text, newline=""), delimiter=self.delimiter, strict=True)
        line = self.first
        try:
            for cells in reader:
                yield line, cells
                line = self.first + reader.line_num
        except csv.Error as error:
            right = f"{DELIMITERS[self.delimiter]} between the columns, and quotes that close"
            raise InputError(f"{self.name}, line {line}", str(error), right) from None


def delimited_text(raw: bytes, name: str) -> DelimitedText:
    """Recognise how a table is written.

    Parameters
    ----------
    raw : bytes
        The file.
    name : str
        How messages call it.

    Raises
    ------
    InputError
        It is no text, a quote does not close, or numbers of a column can be read in two ways.
    """
    text, encoding = decoded(raw, name)
    first, delimiter = 1, ""
    stated = re.match(r"sep=(.)\r?\n", text)  # how Excel is told, and tells
    if stated:
        if stated[1] not in DELIMITERS:
            raise InputError(f"{name}, line 1", stated[0].strip(), "sep=; or sep=, or a tab")
        text, first, delimiter = text[stated.end() :], 2, stated[1]
    found = DelimitedText(name, text, encoding, delimiter or _delimiter(text), first)
    if found.delimiter == ",":
        return found
    return _with_commas(found)


def with_point(cell: str) -> str:
    """Return a cell whose number has a decimal point in place of a comma.

    Examples
    --------
    >>> with_point("12,5 N*m"), with_point("<= 1.234,5"), with_point("core 0,5")
    ('12.5 N*m', '<= 1234.5', 'core 0,5')
    """
    match = NUMBER.fullmatch(cell)
    if match is None or "," not in match["number"]:
        return cell
    return match["before"] + re.sub(r"[.\u00a0\u202f]", "", match["number"]).replace(",", ".") + match["after"]


def decoded(raw: bytes, name: str) -> tuple[str, str]:
    """Return the text of a file without its byte order mark, and its encoding.

    Raises
    ------
    InputError
        It is no text, or in no encoding that is known here.
    """
    for mark, encoding in MARKS:
        if raw.startswith(mark):
            try:
                return raw.decode(encoding), encoding
            except UnicodeDecodeError:
                raise InputError(name, "a broken file", f"text in {encoding.upper()} as its first bytes say") from None
    if b"\0" in raw:
        line = raw[: raw.index(b"\0")].count(b"\n") + 1
        raise InputError(f"{name}, line {line}", "a binary file", "a text file such as CSV, or .xlsx")
    try:
        return raw.decode("utf-8"), "utf-8"
    except UnicodeDecodeError:
        try:
            return raw.decode(WESTERN), WESTERN
        except UnicodeDecodeError as error:
            line = raw[: error.start].count(b"\n") + 1
            where, got = f"{name}, line {line}", raw[error.start : error.start + 1]
            raise InputError(where, got, "text in UTF-8, UTF-16 or Windows-1252: save as CSV UTF-8") from None


def _delimiter(text: str) -> str:
    """Return what stands between the columns: what gives the header most cells, and as many in every line."""
    head = text.split("\n", 1)[0]
    present = [mark for mark in DELIMITERS if mark in head]
    if len(present) < 2:
        return present[0] if present else ","

    def fit(mark: str) -> tuple[bool, int]:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=mark)
        try:
            counts = [len(cells) for cells, _ in zip(reader, range(SAMPLE), strict=False) if any(cells)]
        except csv.Error:
            return False, 0
        return len(set(counts)) == 1, counts[0] if counts else 0

    return max(present, key=fit)  # of those that are as good the first, a comma


def _with_commas(found: DelimitedText) -> DelimitedText:
    """Recognise the columns whose numbers have decimal commas.

    Raises
    ------
    InputError
        A column has nothing but numbers that can be read in two ways.
    """
    written = found._written()
    _, header = next(written, (1, []))
    columns = [_Column() for _ in header]
    for line, cells in written:
        for column, cell in zip(columns, cells, strict=False):
            column.add(line, cell)
    commas = tuple(k for k, column in enumerate(columns) if column.has_commas())
    for column, title in zip(columns, header, strict=True):
        doubt = column.doubt(bool(commas))
        if doubt is not None:
            line, number = doubt
            right = (
                f"{number.replace(',', '.')} or {re.sub('[.,]', '', number)}, whichever is meant: both can be read here"
            )
            title = title.strip()
            raise InputError(f"{found.name}, line {line}, column {title}", number, right, ("rows", line, title))
    return replace(found, commas=commas, titles=tuple(header[k].strip() for k in commas))


class _Column:
    """What the numbers of a column look like."""

    def __init__(self) -> None:
        self.numbers = self.others = 0
        self.certain = self.points = False  # numbers whose comma, or point, is a decimal sign beyond doubt
        self.commas: tuple[int, str] | None = None  # the first number whose comma may part thousands
        self.thousands: tuple[int, str] | None = None  # the first whose points may

    def add(self, line: int, cell: str) -> None:
        """Take another cell into account."""
        if not cell.strip():
            return
        match = NUMBER.fullmatch(cell)
        number = match["number"] if match else ""
        known = "," not in number or any(form.fullmatch(number) for form in (DOUBTFUL, GROUPED, PLAIN))
        if match is None or not known:
            self.others += 1
            return
        self.numbers += 1
        if THOUSANDS.fullmatch(number):
            self.thousands = self.thousands or (line, number)
        elif "," not in number:
            self.points |= "." in number
        elif DOUBTFUL.fullmatch(number):
            self.commas = self.commas or (line, number)
        else:
            self.certain = True

    @property
    def is_numeric(self) -> bool:
        """Whether most of it is numbers."""
        return self.numbers > self.others

    def has_commas(self) -> bool:
        """Tell whether its numbers have decimal commas and no points; what is wrong with both the reader says."""
        return self.is_numeric and self.certain and not (self.points or self.thousands)

    def doubt(self, elsewhere: bool) -> tuple[int, str] | None:
        """Return line and number that can be read in two ways; ``elsewhere``: other columns have decimal commas."""
        if not self.is_numeric or self.certain or self.points:
            return None
        return (self.thousands if elsewhere else None) if self.thousands else self.commas
