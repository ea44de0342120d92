"""Text that does nothing but be read: no terminal escapes and reversed lines, no formulas in a table that is opened."""

from __future__ import annotations

import csv
import re
import sys
import textwrap
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import IO, Any

from synth.text.numbers import thousands

# Control characters, what turns the direction of writing, separators that are no blank, halves of characters.
_ACTING = r"\u007f-\u009f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufff9-\ufffb"
UNSAFE = re.compile(rf"[\x00-\x08\x0b\x0c\x0e-\x1f{_ACTING}\ud800-\udfff]|\r(?!\n)")
# The same for texts of one line, tabs and ends of lines too, without brackets: as all readers of patterns know it.
UNSAFE_IN_LINE = rf"\u0000-\u001f{_ACTING}"
# What programs for tables take for the beginning of a formula, the wide forms of it too.
FORMULA = re.compile("'*[=+\\-@\t\r\uff1d\uff0b\uff0d\uff20]")
NUMBER = re.compile(r"[-+](?:(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|inf|nan)")


def printable(text: str) -> str:
    r"""Return a text in which what acts on a terminal is written out, as in a Python string.

    Examples
    --------
    >>> printable("core\x1b[2J 4"), printable("two\nlines")
    ('core\\x1b[2J 4', 'two\nlines')
    """
    return UNSAFE.sub(_written_out, text)


def one_line(text: str) -> str:
    r"""Return a text on one line, in which what acts on the program that reads it is written out.

    Examples
    --------
    >>> one_line("core\x1b[2J\n 4")
    'core\\x1b[2J 4'
    """
    return " ".join(printable(text).split())


def counted(number: int, what: str, several: str = "") -> str:
    """Return a number of things in words; ``several`` of them are called otherwise than with an s.

    Examples
    --------
    >>> counted(1, "row"), counted(12000, "row")
    ('1 row', '12 000 rows')
    """
    return f"{thousands(number)} {what if number == 1 else several or f'{what}s'}"


def words(name: str) -> str:
    """Return the name of a quantity as words.

    Examples
    --------
    >>> words("ring_outer_diameter")
    'ring outer diameter'
    """
    return name.replace("_", " ")


def wrapped(text: str, width: int, first: int = 0, later: int = 0, broken: bool = True) -> list[str]:
    """Return a text as lines no wider than a screen, none of them broken inside a word that fits.

    Parameters
    ----------
    text : str
    width : int
        Characters on a line.
    first, later : int
        Blanks before the first line of each paragraph, and before its others.
    broken : bool
        Whether words that fit on no line are broken; names of files are not.

    Examples
    --------
    >>> wrapped("two words, and more", 12, later=2)
    ['two words,', '  and more']
    """
    wrapper = textwrap.TextWrapper(
        width,
        initial_indent=" " * first,
        subsequent_indent=" " * later,
        break_long_words=broken,
        break_on_hyphens=False,
    )
    return [line for part in text.split("\n") for line in wrapper.wrap(part)]


def escaped(text: str) -> str:
    r"""Return a JSON text, or a YAML text in double quotes, in which such characters are escaped; it means the same.

    Examples
    --------
    >>> escaped('"a\x9bb"')
    '"a\\u009bb"'
    """
    return UNSAFE.sub(lambda match: f"\\u{ord(match[0]):04x}", text)


def defused(text: str) -> str:
    """Return the text of a cell as no program takes it for a formula: with an apostrophe before it. Numbers stay.

    Examples
    --------
    >>> defused("=1+1"), defused("-5.3"), defused("core 4"), defused("-")
    ("'=1+1", '-5.3', 'core 4', '-')
    """
    return f"'{text}" if len(text) > 1 and FORMULA.match(text) and not NUMBER.fullmatch(text) else text


def listed(text: str) -> list[str]:
    """Return the names of a list with commas between them; one that has a comma itself stands in double quotes.

    The rule is that of CSV: two double quotes within quotes are one. Where quotes do not close they mean nothing.

    Examples
    --------
    >>> listed('core 2, "plate 3, thick",, 3/8" pin')
    ['core 2', 'plate 3, thick', '', '3/8" pin']
    """
    try:
        rows = list(csv.reader([text.replace("\n", " ")], skipinitialspace=True, strict=True))
    except csv.Error:
        rows = [text.split(",")]
    return [name.strip() for row in rows for name in row or [""]]


def as_list(names: Iterable[str]) -> str:
    """Return names as a list that ``listed`` reads.

    Examples
    --------
    >>> as_list(["core 2", "plate 3, thick"])
    'core 2, "plate 3, thick"'
    """
    return ", ".join('"' + n.replace('"', '""') + '"' if "," in n or n.startswith('"') else n for n in names)


def as_meant(cell: str) -> str:
    """Text of a cell before ``defused``.

    Examples
    --------
    >>> as_meant("'=1+1"), as_meant("-5.3"), as_meant("'tis")
    ('=1+1', '-5.3', "'tis")
    """
    return cell[1:] if cell.startswith("'") and FORMULA.match(cell) else cell


def csv_cell(value: object) -> Any:
    """Cell of a table: numbers in full precision, text that does nothing."""
    if isinstance(value, float):
        return repr(value)
    return "" if value is None else defused(printable(value)) if isinstance(value, str) else value


def file_text(name: str, text: str) -> str:
    """Return the text of a file as it is written: nothing in it acts on the terminal of whoever looks at it."""
    if name.endswith((".yaml", ".yml")):
        return text  # only what makes it knows which of its texts stand in quotes
    return escaped(text) if name.endswith(".json") else printable(text)


class PlainStream:
    """A stream of text that writes out what acts on a terminal; all else is that of ``stream``."""

    def __init__(self, stream: IO[str]) -> None:
        self.stream = stream

    def write(self, text: str) -> int:
        """Write a text."""
        self.stream.write(printable(text))
        return len(text)

    def writelines(self, lines: Iterable[str]) -> None:
        """Write several texts."""
        for line in lines:
            self.write(line)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


@contextmanager
def plain_streams() -> Iterator[None]:
    """Let nothing that is printed act on the terminal."""
    before = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (PlainStream(stream) for stream in before)
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def _written_out(match: re.Match[str]) -> str:
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
