"""Tables as spreadsheets of any country write them: encodings, delimiters and decimal commas are recognised and told.

What is not beyond doubt is asked back, never guessed: a number such as 1,234 in a table with semicolons may be 1.234
or 1234.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import BinaryIO

from synth.errors import Described, InputError
from synth.tables.encodings import MARKS, NAMES, decoded
from synth.tables.number_columns import PLAIN_NUMBERS, NumberColumn, WrittenNumbers, written_numbers
from synth.text.input_limits import INPUT_LIMITS

DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs"}
SAMPLE = 200  # lines by which delimiters are compared
PIECE = 1 << 16  # bytes that are looked at at a time
TELLING = 1 << 20  # bytes of lines that are not ASCII by which the encoding is told
ByteSource = Callable[[], BinaryIO]


@dataclass(frozen=True)
class DelimitedText:
    """The text of a table, and how it is written.

    Parameters
    ----------
    name : str
        How messages call it.
    source : callable
        Opens it anew; it is read line by line, however long it is.
    encoding, delimiter : str
    first : int
        Number in the file of its first line, behind the one that names the delimiter.
    numbers : WrittenNumbers
        Which columns have decimal commas.
    declared : bool
        Whether a line names the delimiter.
    """

    name: str
    source: ByteSource
    encoding: str
    delimiter: str = ","
    first: int = 1
    numbers: WrittenNumbers = PLAIN_NUMBERS
    declared: bool = False

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
        """Recognised dialect, in a sentence; empty where the text is written as expected."""
        remarks = []
        if self.delimiter != "," or self.declared:
            origin = " as its first line says" if self.declared else ""
            remarks.append(f"{DELIMITERS[self.delimiter]} between the columns{origin}")
        if not self.encoding.startswith("utf-8"):
            remarks.append(f"text in {NAMES.get(self.encoding, self.encoding)}")
        if self.numbers.titles:
            remarks.append(self.numbers.sentence())
        return f"{self.name}: {', '.join(remarks)}" if remarks else ""

    def written_lines(self) -> Iterator[str]:
        """Yield its lines as they are written, with their ends.

        Raises
        ------
        InputError
            Something of it is no text in its encoding, or a line is too long.
        """
        with io.TextIOWrapper(self.source(), encoding=self.encoding, newline="") as text:
            number = 0
            try:
                while line := text.readline(INPUT_LIMITS.row + 1):
                    number += 1
                    self._check_length(number, len(line))
                    if number >= self.first:
                        yield line
            except UnicodeError:
                right = f"text in {self.encoding.upper()} throughout"
                raise InputError(self.name, "a broken file", right) from None  # it is decoded some lines ahead

    def _check_length(self, line: int, characters: int) -> None:
        if characters > INPUT_LIMITS.row:
            right = f"at most {INPUT_LIMITS.row} characters in a row, and quotes that close"
            raise InputError(f"{self.name}, line {line}", Described("more than that in one row"), right)

    def _written(self) -> Iterator[tuple[int, list[str]]]:
        line, characters = self.first, 0

        def counted() -> Iterator[str]:
            nonlocal characters
            for text in self.written_lines():
                characters += len(text)
                self._check_length(line, characters)
                yield text

        reader = csv.reader(counted(), delimiter=self.delimiter, strict=True)
        try:
            for cells in reader:
                yield line, cells
                line, characters = self.first + reader.line_num, 0
        except csv.Error as error:
            right = f"{DELIMITERS[self.delimiter]} between the columns, and quotes that close"
            raise InputError(f"{self.name}, line {line}", str(error), right) from None


def delimited_text(raw: bytes, name: str, encoding: str = "") -> DelimitedText:
    """Recognise how a table in memory is written.

    Else as :func:`delimited_file`.
    """
    return delimited_file(partial(io.BytesIO, raw), name, encoding)


def delimited_file(source: ByteSource, name: str, encoding: str = "") -> DelimitedText:
    """Recognise how a table is written.

    Parameters
    ----------
    source : callable
        Opens the file.
    name : str
        How messages call it.
    encoding : str
        Where somebody has named it; by default it is recognised.

    Raises
    ------
    InputError
        It is no text or may be in several encodings, a quote does not close, or numbers of a column can be read in two
        ways.
    """
    plain = DelimitedText(name, source, _encoding(source, name, encoding))
    head = next(plain.written_lines(), "")
    declaration = re.fullmatch(r"(\"?)sep=(.)\1\r?\n", head, re.IGNORECASE)  # a line of Excel
    if declaration:
        if declaration[2] not in DELIMITERS:
            raise InputError(f"{name}, line 1", declaration[0].strip(), "sep=; or sep=, or a tab")
        text = replace(plain, delimiter=declaration[2], first=2, declared=True)
    else:
        text = replace(plain, delimiter=_delimiter(head, plain))
    return text if text.delimiter == "," else _with_commas(text)


def _encoding(source: ByteSource, name: str, named: str) -> str:
    """Return the encoding of a file, by its mark or its lines that are not ASCII: others are the same in any encoding.

    Raises
    ------
    InputError
        It is no text, or in no encoding that is known here.
    """
    telling, kept = io.BytesIO(), 0
    with source() as file:
        start = file.readline(PIECE)
        for mark, encoding in MARKS:
            if not named and start.startswith(mark):
                return encoding
        piece = start
        while piece and kept < TELLING:
            plain = piece.isascii() and b"\0" not in piece
            telling.write(piece if not plain else b"\n" if piece.endswith(b"\n") else b"")
            kept += 0 if plain else len(piece)
            piece = file.readline(PIECE)
    return decoded(telling.getvalue(), name, named)[1]


def first_lines(raw: bytes, name: str, most: int, encoding: str = "") -> bytes:
    r"""Head of a table, in UTF-8: its first lines, and those that a cell in quotes goes on in.

    Raises
    ------
    InputError
        As :func:`decoded`.

    Examples
    --------
    >>> first_lines(b'a,b\n1,"x\ny"\n2,z\n', "table", 2)
    b'a,b\n1,"x\ny"\n'
    """
    lines = io.StringIO(decoded(raw, name, encoding)[0], newline="")
    kept, quotes = list[str](), 0
    for line in lines:
        kept.append(line)
        quotes += line.count('"')
        if len(kept) >= most and quotes % 2 == 0:
            break
    return "".join(kept).encode()


def _delimiter(head: str, written: DelimitedText) -> str:
    """Delimiter of columns: the one that gives the header most cells, and as many in every line."""
    present = [mark for mark in DELIMITERS if mark in head]
    if len(present) < 2:
        return present[0] if present else ","

    def fit(mark: str) -> tuple[bool, int]:
        reader = csv.reader(written.written_lines(), delimiter=mark)
        try:
            counts = [len(cells) for cells, _ in zip(reader, range(SAMPLE), strict=False) if any(cells)]
        except csv.Error:
            return False, 0
        return len(set(counts)) == 1, counts[0] if counts else 0

    return max(present, key=fit)  # of those that are as good the first, a comma


def _with_commas(text: DelimitedText) -> DelimitedText:
    """Recognise the columns whose numbers have decimal commas.

    Raises
    ------
    InputError
        A column has nothing but numbers that can be read in two ways.
    """
    written = text._written()
    _, header = next(written, (1, []))
    columns = [NumberColumn() for _ in header]
    for line, cells in written:
        for column, cell in zip(columns, cells, strict=False):
            column.add(line, cell)
    return replace(text, numbers=written_numbers(header, columns, text.name))
