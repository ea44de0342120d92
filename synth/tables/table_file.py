"""How a table is named: a file, and behind # what of it is read and how: ``own.xlsx#Plates#rows=visible``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from synth.errors import InputError
from synth.tables.encodings import known_encoding

EXCEL = (".xlsx", ".xlsm")
ENCODING, VISIBLE = "encoding=", "rows=visible"
NAMED = re.compile(r"([^#]+)((?:#[^#]+)+)")


@dataclass(frozen=True)
class TableFile:
    """A file with a table, and how it is read.

    Parameters
    ----------
    path : Path
    sheet : str
        Of a workbook; nothing: that which holds a table.
    visible : bool
        Whether the rows of a workbook are left out that are hidden or filtered.
    encoding : str
        Of a CSV file; nothing: it is recognised.
    """

    path: Path
    sheet: str = ""
    visible: bool = False
    encoding: str = ""

    @property
    def is_workbook(self) -> bool:
        """Whether the file is a workbook."""
        return self.path.suffix.lower() in EXCEL


def table_file(named: Path) -> TableFile:
    """Parts of a file name.

    Raises
    ------
    InputError
        Something behind # is said of another kind of file, or is no encoding.

    Examples
    --------
    >>> table_file(Path("parts/own.xlsx#Linings")).sheet, table_file(Path("own.csv#encoding=cp1250")).encoding
    ('Linings', 'cp1250')
    """
    match = NAMED.fullmatch(named.name)
    if match is None or named.exists():
        return TableFile(named)
    path, parts = named.with_name(match[1]), match[2][1:].split("#")
    encodings = [part.removeprefix(ENCODING) for part in parts if part.startswith(ENCODING)]
    sheets = [part for part in parts if part != VISIBLE and not part.startswith(ENCODING)]
    workbook = TableFile(path).is_workbook
    if not workbook and sheets:
        return TableFile(named)  # the name of a file that is not there
    if workbook == bool(encodings) and (encodings or VISIBLE in parts):
        right = "encoding=NAME behind the name of a CSV file, rows=visible behind that of a workbook"
        raise InputError("table", named.name, right)
    if len(sheets) > 1 or len(encodings) > 1:
        raise InputError("table", named.name, "one sheet, or one encoding, behind #")
    encoding = known_encoding(encodings[0], "encoding") if encodings else ""
    return TableFile(path, "".join(sheets), VISIBLE in parts, encoding)


def read_as(named: str, encoding: str | None, visible: bool) -> str:
    """Return the name of a table with how it is read, where it does not say so itself and is of that kind."""
    known = table_file(Path(named))
    if known.is_workbook:
        return f"{named}#{VISIBLE}" if visible and not known.visible else named
    return f"{named}#{ENCODING}{encoding}" if encoding and not known.encoding else named
