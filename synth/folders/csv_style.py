"""How tables are written for people: the mark between the columns, the sign before decimals, and the beginning.

What is made is always written in one way, with commas and decimal points; a style turns its text into what the programs
of a country open. Readers of tables take it back as it was.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import TextIO, TypeVar

from synth.errors import InputError

Content = TypeVar("Content", str, str | bytes)

BLANKS = " \u00a0\u202f"  # that people put between thousands
# A number of a cell with what stands around it: a comparison, a sign, an exponent, a unit.
NUMBER = re.compile(
    r"(?P<before>[\s']*(?:[<>=]=?|[≤≥])?\s*[-+]?)"
    rf"(?P<number>\d(?:[\d.,]|[{BLANKS}](?=\d\d\d(?!\d)))*)"
    r"(?P<after>(?:[eE][-+]?\d+)?\s*(?:[^\d\s,.;][^,;]*)?)"
)
DOUBTFUL = re.compile(r"[1-9]\d{0,2},\d{3}")  # 1.234 or 1234
STRETCHED = re.compile(r"(?<![\d.])([1-9]\d{0,2}\.\d{3})0(?!\d)")  # what with_comma has put a zero to
DECIMAL = re.compile(r"\d+\.\d+")
NAMED_NUMBER = re.compile(r"^(\w+ -?\d+)([.,])(\d+(?:[eE][-+]?\d+)?(?: \S+)?)$")  # mass 9.36 kg


def with_point(cell: str) -> str:
    """Return a cell whose number has a decimal point in place of a comma, and nothing between its thousands.

    Examples
    --------
    >>> with_point("12,5 N*m"), with_point("<= 1.234,5"), with_point("1 234,5"), with_point("core 0,5")
    ('12.5 N*m', '<= 1234.5', '1234.5', 'core 0,5')
    """
    match = NUMBER.fullmatch(cell)
    if match is None or "," not in match["number"]:
        return cell
    number = re.sub(rf"[.{BLANKS}]", "", match["number"]).replace(",", ".")
    return match["before"].replace("'", "") + number + match["after"]


def without_blanks(cell: str) -> str:
    """Return a cell whose number has nothing between its thousands, and no apostrophe before it.

    Examples
    --------
    >>> without_blanks("12 345.6 N*m"), without_blanks("'12.5"), without_blanks("core 1 000")
    ('12345.6 N*m', '12.5', 'core 1 000')
    """
    match = NUMBER.fullmatch(cell)
    if match is None:
        return cell
    return match["before"].replace("'", "") + re.sub(rf"[{BLANKS}]", "", match["number"]) + match["after"]


def with_comma(cell: str) -> str:
    """Return a cell whose number has a decimal comma in place of a point.

    Three decimals get a zero, as nobody takes the comma of 1,2340 for one between thousands.

    Examples
    --------
    >>> with_comma("12.5 N*m"), with_comma("1.234"), with_comma("core 0.5"), with_comma("1e-05")
    ('12,5 N*m', '1,2340', 'core 0.5', '1e-05')
    """
    match = NUMBER.fullmatch(cell)
    if match is None or not DECIMAL.fullmatch(match["number"]):
        return cell
    number = match["number"].replace(".", ",")
    return match["before"] + number + ("0" if DOUBTFUL.fullmatch(number) else "") + match["after"]


def list_with_commas(cell: str) -> str:
    """Return a list of quantities with decimal commas, and semicolons between them; designations stay.

    Examples
    --------
    >>> list_with_commas("mass 9.36 kg, plates 12, plate core 1.5")
    'mass 9,36 kg; plates 12; plate core 1.5'
    """
    return "; ".join(NAMED_NUMBER.sub(r"\1,\3", item) for item in cell.split(", "))


def list_with_points(cell: str) -> str:
    """Return a list as it was before ``list_with_commas``.

    Examples
    --------
    >>> list_with_points("mass 9,36 kg; plates 12; plate core 1.5")
    'mass 9.36 kg, plates 12, plate core 1.5'
    """
    return ", ".join(NAMED_NUMBER.sub(r"\1.\3", item) for item in cell.split("; "))


class _CellCount:
    """Cells of a column, and how many of them are numbers."""

    def __init__(self) -> None:
        self.cells = self.numbers = 0
        self.commas = False

    def add(self, cell: str) -> None:
        """Count a cell; one that is empty says nothing."""
        if cell:
            self.cells += 1
            match = NUMBER.fullmatch(cell)
            if match is not None:
                self.numbers += 1
                self.commas |= "," in match["number"]

    @property
    def is_numeric(self) -> bool:
        """Whether most of them are numbers, and none has a comma."""
        return 2 * self.numbers > self.cells and not self.commas


@dataclass(frozen=True)
class CsvStyle:
    """How CSV is written.

    Parameters
    ----------
    delimiter : str
        Between the columns.
    commas : bool
        Whether numbers have decimal commas.
    mark : str
        What the text begins with.
    """

    delimiter: str = ","
    commas: bool = False
    mark: str = ""

    def text(self, plain: str, lists: Collection[str] = ()) -> str:
        """Return a table that is written with commas and decimal points in this style.

        Columns that hold more numbers than words get decimal commas, so that readers know them by the whole column, and
        so do the columns of ``lists`` of named quantities.
        """
        if self == ENGLISH:
            return plain
        buffer = io.StringIO()
        self.write(io.StringIO(plain, newline=""), buffer, lists)
        return buffer.getvalue()

    def write(self, plain: TextIO, file: TextIO, lists: Collection[str] = ()) -> None:
        """Write the table of one file into another, row by row, as :meth:`text`; the first is read twice."""
        plain.seek(0)
        rows = csv.reader(plain)
        writers: dict[int, Callable[[str], str]] = {}
        if self.commas:
            head = next(rows, [])
            columns = [_CellCount() for _ in head]
            for row in rows:
                for column, cell in zip(columns, row, strict=False):
                    column.add(cell)
            writers = {k: with_comma for k, column in enumerate(columns) if column.is_numeric}
            writers |= {k: list_with_commas for k, title in enumerate(head) if title in lists}
        file.write(self.mark)
        write = csv.writer(file, delimiter=self.delimiter, lineterminator="\n").writerow
        plain.seek(0)
        for number, row in enumerate(csv.reader(plain)):
            for k, written in writers.items() if number else ():
                if k < len(row):
                    row[k] = written(row[k])
            write(row)

    def files(self, files: Mapping[str, Content]) -> dict[str, Content]:
        """Return files by name, the tables among them in this style."""
        return {
            name: self.text(content) if isinstance(content, str) and name.endswith(".csv") else content
            for name, content in files.items()
        }


ENGLISH = CsvStyle()
GERMAN = CsvStyle(";", commas=True, mark="\ufeff")
STYLES = {"en": ENGLISH, "de": GERMAN}


def unstyled(text: str) -> str:
    r"""Return the text of a table as it was before a style was given to it.

    Examples
    --------
    >>> unstyled(GERMAN.text("mass [kg],part\n1.234,core 2\n"))
    'mass [kg],part\n1.234,core 2\n'
    """
    if not text.startswith(GERMAN.mark):
        return text
    rows = csv.reader(io.StringIO(text.removeprefix(GERMAN.mark), newline=""), delimiter=GERMAN.delimiter)
    buffer = io.StringIO()
    plain = ([STRETCHED.sub(r"\1", with_point(cell)) if "," in cell else cell for cell in row] for row in rows)
    csv.writer(buffer, lineterminator="\n").writerows(plain)
    return buffer.getvalue()


def csv_style(name: str, field: str = "csv") -> CsvStyle:
    """Return the style of a name.

    Raises
    ------
    InputError
        There is none.
    """
    if name not in STYLES:
        right = "en (commas, decimal points) or de (semicolons, decimal commas)"
        raise InputError(field, name, right, (field.lstrip("-"),))
    return STYLES[name]
