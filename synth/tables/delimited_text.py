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
from synth.tables.number_columns import PLAIN_NUMBERS, NumberColumn, WrittenNumbers, written_numbers

DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs"}
MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
# What Excel writes in western Europe and America where it does not write UTF-8. Detectors of encodings are no help with
# short tables: they take the superscript of mm² for a letter of another code page.
WESTERN = "cp1252"
SAMPLE = 200  # lines by which delimiters are compared


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
    numbers : WrittenNumbers
        Which columns have decimal commas.
    stated : bool
        Whether a line names the delimiter.
    """

    name: str
    text: str
    encoding: str
    delimiter: str
    first: int = 1
    numbers: WrittenNumbers = PLAIN_NUMBERS
    stated: bool = False

    def lines(self) -> Iterator[tuple[int, list[str]]]:
        """Return number in the file and cells of every line, numbers with decimal points.

        Raises
        ------
        InputError
            A quote does not close.
        """
        for number, cells in self._written():
            yield number, self.numbers.read(cells)

    def sentence(self) -> str:
        """Return what was recognised, in a sentence; nothing where it is written as is expected."""
        told = []
        if self.delimiter != "," or self.stated:
            says = " as its first line says" if self.stated else ""
            told.append(f"{DELIMITERS[self.delimiter]} between the columns{says}")
        if self.encoding in (WESTERN, "utf-16"):
            told.append("text in Windows-1252" if self.encoding == WESTERN else "text in UTF-16")
        if self.numbers.titles:
            told.append(self.numbers.sentence())
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
    stated = re.match(r"(\"?)sep=(.)\1\r?\n", text, re.IGNORECASE)  # how Excel is told, and tells
    if stated:
        if stated[2] not in DELIMITERS:
            raise InputError(f"{name}, line 1", stated[0].strip(), "sep=; or sep=, or a tab")
        text, first, delimiter = text[stated.end() :], 2, stated[2]
    found = DelimitedText(name, text, encoding, delimiter or _delimiter(text), first, stated=stated is not None)
    if found.delimiter == ",":
        return found
    return _with_commas(found)


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
    columns = [NumberColumn() for _ in header]
    for line, cells in written:
        for column, cell in zip(columns, cells, strict=False):
            column.add(line, cell)
    return replace(found, numbers=written_numbers(header, columns, found.name))
