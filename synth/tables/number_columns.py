"""Columns of numbers that stand as text: which have decimal commas, blanks between thousands, apostrophes.

What is not beyond doubt by the whole column is asked back, never guessed.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from synth.errors import InputError
from synth.folders.csv_style import BLANKS, DOUBTFUL, NUMBER, with_point, without_blanks

GROUPED = re.compile(rf"\d{{1,3}}(?:[.{BLANKS}]\d{{3}})+,\d+")
PLAIN = re.compile(r"\d+,\d+")
THOUSANDS = re.compile(r"[1-9]\d{0,2}(?:\.\d{3})+")  # where others have decimal commas
DESIGNATION = "designation"
TITLES = 6  # columns that are told by name


class NumberColumn:
    """What the numbers of a column look like."""

    def __init__(self) -> None:
        self.numbers = self.others = 0
        self.certain = self.points = False  # numbers whose comma, or point, is a decimal sign beyond doubt
        self.blanks = self.apostrophes = False
        self.commas: tuple[int, str] | None = None  # the first number whose comma may part thousands
        self.thousands: tuple[int, str] | None = None  # the first whose points may

    def add_number(self) -> None:
        """Take a cell into account that is a number, not its text: it says nothing of how texts are meant."""
        self.numbers += 1

    def add(self, line: int, cell: str) -> None:
        """Take the text of another cell into account."""
        if not cell.strip():
            return
        match = NUMBER.fullmatch(cell)
        number = match["number"] if match else ""
        known = "," not in number or any(form.fullmatch(number) for form in (DOUBTFUL, GROUPED, PLAIN))
        if match is None or not known:
            self.others += 1
            return
        self.numbers += 1
        self.blanks |= any(blank in number for blank in BLANKS)
        self.apostrophes |= "'" in match["before"]
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
        """True if its numbers have decimal commas and no points; what is wrong with both the reader says."""
        return self.is_numeric and self.certain and not (self.points or self.thousands)

    def has_more(self, title: str) -> bool:
        """True if its numbers have an apostrophe before them or, in a column with a unit, blanks in them."""
        return self.is_numeric and (self.apostrophes or (self.blanks and "[" in title))

    def doubt(self, elsewhere: bool) -> tuple[int, str] | None:
        """Return line and number that can be read in two ways; ``elsewhere``: other columns have decimal commas."""
        if not self.is_numeric or self.certain or self.points:
            return None
        return (self.thousands if elsewhere else None) if self.thousands else self.commas


@dataclass(frozen=True)
class WrittenNumbers:
    """How the numbers of a table are written.

    Parameters
    ----------
    commas : tuple of int
        Columns, from 0, whose numbers have decimal commas.
    titles : tuple of str
        Of those columns.
    more : tuple of int
        Columns whose numbers have blanks between thousands or apostrophes before them, and no decimal commas.
    """

    commas: tuple[int, ...] = ()
    titles: tuple[str, ...] = ()
    more: tuple[int, ...] = ()

    def read(self, cells: list[str]) -> list[str]:
        """Return the cells of a row, numbers with decimal points."""
        for k in self.commas:
            if k < len(cells):
                cells[k] = with_point(cells[k])
        for k in (*self.commas, *self.more):
            if k < len(cells):
                cells[k] = without_blanks(cells[k])
        return cells

    def sentence(self) -> str:
        """Return in which columns decimal commas are; nothing where there are none."""
        further = len(self.titles) - TITLES
        more = f" and {further} more" if further > 0 else ""
        return f"decimal commas in {', '.join(self.titles[:TITLES])}{more}" if self.titles else ""


PLAIN_NUMBERS = WrittenNumbers()


def written_numbers(header: Sequence[str], columns: Sequence[NumberColumn], name: str) -> WrittenNumbers:
    """Number style of columns; ``name`` is that of the table, for messages.

    Raises
    ------
    InputError
        A column has nothing but numbers that can be read in two ways.
    """
    # Designations are names: 1,10 is another one than 1.1.
    columns = [NumberColumn() if title.strip() == DESIGNATION else c for c, title in zip(columns, header, strict=True)]
    commas = tuple(k for k, column in enumerate(columns) if column.has_commas())
    for column, written in zip(columns, header, strict=True):
        doubt = column.doubt(bool(commas))
        if doubt is not None:
            (line, number), title = doubt, written.strip()
            right = (
                f"{number.replace(',', '.')} or {re.sub('[.,]', '', number)}, whichever is meant: both can be read here"
            )
            raise InputError(f"{name}, line {line}, column {title}", number, right, ("rows", line, title))
    more = (k for k, (c, title) in enumerate(zip(columns, header, strict=True)) if c.has_more(title))
    return WrittenNumbers(commas, tuple(header[k].strip() for k in commas), tuple(k for k in more if k not in commas))
