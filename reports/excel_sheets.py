"""A workbook in memory: formats, and cells that hold what they are given and nothing else."""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Container, Mapping, Sequence
from datetime import datetime
from typing import Any, TypeAlias

from synth.text.plain_text import printable

from .extras import needed

Result: TypeAlias = float | str | bool

MOST_TEXT = 32767  # what a cell holds, in units of UTF-16
CREATED = datetime(1980, 1, 1)  # the same input gives the same bytes
LINE = 15.5  # points
LETTERS_PER_WIDTH = 1.15  # letters in a cell by its width; other fonts than ours may be wider
BROAD = 1.15  # bold letters against others
MOST_LINES, LONGEST = 12, 3000
ROUND = 1e10  # below, numbers of few digits are written in full
DIGITS = 5  # significant, of what is shown; a cell holds all of them
ERRORS = {"nan": "#N/A", "inf": "#DIV/0!", "-inf": "#DIV/0!"}

BLUE, BAND, RULE = "#1F3A5F", "#E4EAF1", "#C9D1DB"
INPUT, FOLLOWS, GREY = "#FFF4CC", "#FFFBEA", "#6B7280"
GOOD, BAD = "#1B7F4B", "#B3261E"
MARKED, FULL = "#FFE9A8", "#F6B26B"
NEARLY = 0.9  # share of a limit from which it is coloured as nearly used up
FONT = "Calibri"

INDENTED = {"align": "left", "indent": 1}  # a number is not to run into the text beside it
HEAD = {"bold": True, "bg_color": BLUE, "font_color": "#FFFFFF", "text_wrap": True, "valign": "vcenter"}
STYLES: Mapping[str, Mapping[str, Any]] = {
    "title": {"bold": True, "font_size": 16, "font_color": BLUE, **INDENTED},
    "state": {"bold": True, "font_size": 13, **INDENTED},
    "title_line": {"bold": True, "font_size": 16, "font_color": BLUE},
    "state_line": {"bold": True},
    "section": {"bold": True, "bg_color": BAND, "font_color": BLUE, **INDENTED},
    "head": {**HEAD, **INDENTED},
    "head_right": {**HEAD, "align": "right"},
    "head_centre": {**HEAD, "align": "center"},
    "text": {"text_wrap": True, **INDENTED},
    "plain": INDENTED,
    "name": {"bold": True, "text_wrap": True, **INDENTED},
    "small": {"font_size": 9, "font_color": GREY, "text_wrap": True, **INDENTED},
    "line": {"font_size": 9, "font_color": GREY, **INDENTED},
    "code": {"font_size": 9, "font_color": GREY, "font_name": "Consolas"},
    "unit": {"font_color": GREY, **INDENTED},
    "input": {"bg_color": INPUT, "border": 1, "border_color": RULE, "locked": False, "align": "right"},
    "word": {
        "bg_color": INPUT,
        "border": 1,
        "border_color": RULE,
        "locked": False,
        "num_format": "@",
        "align": "right",
    },
    "follows": {"bg_color": FOLLOWS, "border": 1, "border_color": RULE, "locked": False, "align": "right", "italic": 1},
    "number": {"align": "right"},
    "result": {"align": "right", "bold": True},
    "result_text": {"align": "right", "text_wrap": True},
    "solved": {"align": "right", "font_color": GREY},
    "si": {"align": "right", "font_color": GREY},
    "percent": {"align": "right", "num_format": "0.0 %"},
    "change": {"align": "right", "font_color": GREY, "num_format": "+0.0 %;-0.0 %;0.0 %"},
    "verdict": {"align": "center"},
}


class Book:
    """One workbook; ``bytes`` closes it.

    Parameters
    ----------
    option : str
        The option that requested it, for the message that the extra is not installed.
    title : str
    row_by_row : bool
        Whether rows are written from the first to the last, each cell once, and not kept: for many of them. Sheets too
        are written one after the other, and rows do not grow with their texts.
    """

    def __init__(self, option: str, title: str, row_by_row: bool = False) -> None:
        xlsxwriter = needed("xlsxwriter", option, "excel")
        self._buffer, self._row_by_row = io.BytesIO(), row_by_row
        # Nothing that is written as text is looked at: it is no formula, no address and no number.
        kept = {"constant_memory": True} if row_by_row else {"in_memory": True}
        options = {**kept, "strings_to_formulas": False, "strings_to_urls": False}
        self._book = xlsxwriter.Workbook(self._buffer, {**options, "strings_to_numbers": False})
        self._book.set_properties({"title": cell_text(title)[:255], "comments": "clutchsynth", "created": CREATED})
        self._book.set_calc_mode("auto")
        self._formats: dict[tuple[str, str], Any] = {}
        self._sheets: list[Sheet] = []

    def sheet(self, name: str, widths: Sequence[float], locked: bool = True, over_pages: bool = False) -> Sheet:
        """Return a new sheet with columns of these widths [characters].

        Parameters
        ----------
        locked : bool
            Whether it is protected, without a password; cells for inputs stay open.
        over_pages : bool
            Whether it is too wide for one page.
        """
        sheet = self._book.add_worksheet(name)
        for column, width in enumerate(widths):
            sheet.set_column(column, column, width)
        sheet.hide_gridlines(2)
        sheet.set_paper(9)
        sheet.set_landscape()
        sheet.set_margins(0.4, 0.4, 0.5, 0.6)
        if over_pages:
            sheet.set_print_scale(60)
            sheet.repeat_columns(0)
        else:
            sheet.fit_to_pages(1, 0)
        sheet.set_footer("&L&8clutchsynth&C&8&A&R&8&P / &N")
        if locked:
            sheet.protect("", {"format_columns": True, "format_rows": True, "select_locked_cells": True})
        self._sheets.append(Sheet(self, sheet, name, widths))
        return self._sheets[-1]

    def style(self, name: str, number_format: str = "") -> Any:
        """Return a format, with the digits that a number is shown with."""
        if (name, number_format) not in self._formats:
            made = {"font_name": FONT, "valign": "top", **STYLES[name]}
            if number_format:
                made["num_format"] = number_format
            self._formats[name, number_format] = self._book.add_format(made)
        return self._formats[name, number_format]

    def added(self, **properties: Any) -> Any:
        """Return a format for cells of which a condition holds."""
        return self._book.add_format(properties)

    def define(self, name: str, place: str) -> None:
        """Give a cell a name."""
        self._book.define_name(name, f"={place}")

    def bytes(self) -> bytes:
        """Return the file."""
        for sheet in self._sheets if not self._row_by_row else ():
            sheet.set_heights()
        self._book.close()
        return self._buffer.getvalue()


class Sheet:
    """One sheet; rows and columns count from 0, ``last`` is the last row with a text in it."""

    def __init__(self, book: Book, worksheet: Any, name: str, widths: Sequence[float]) -> None:
        self.book, self.worksheet, self.name = book, worksheet, name
        self.widths, self._heights = widths, dict[int, float]()
        self.last = 1
        self._joined = set[tuple[int, int]]()

    def text(self, row: int, column: int, text: str, style: str = "text") -> None:
        """Write a text, whatever stands in it, as a text."""
        self.worksheet.write_string(row, column, cell_text(text), self.book.style(style))
        self.last = max(self.last, row)
        self._fit_height(row, column, text, style)

    def heads(self, row: int, heads: Sequence[str], right: Container[int] = (), centre: Container[int] = ()) -> None:
        """Write the heads of columns, over numbers to the right."""
        for column, text in enumerate(heads):
            plain_head = "head_centre" if column in centre else "head"
            self.text(row, column, text, "head_right" if column in right else plain_head)

    def texts(self, row: int, texts: Sequence[str], style: str = "text", first: int = 0) -> None:
        """Write texts side by side."""
        for column, text in enumerate(texts):
            self.text(row, first + column, text, style)

    def number(self, row: int, column: int, value: float | None, style: str = "number", digits: bool = True) -> None:
        """Write a number; nothing where there is none.

        Parameters
        ----------
        digits : bool
            Whether it is shown with few digits, as what was measured or computed.
        """
        if value is None or not math.isfinite(value):
            self.worksheet.write_blank(row, column, None, self.book.style(style))
        else:
            form = number_format(value) if digits else ""
            self.worksheet.write_number(row, column, value, self.book.style(style, form))

    def formula(
        self,
        row: int,
        column: int,
        formula: str,
        result: float | str | bool,
        style: str = "number",
        digits: bool = True,
    ) -> None:
        """Write a formula with what it comes to, which is shown until something computes it again.

        Parameters
        ----------
        formula : str
            Without the sign of equality. It is made of names of ours, never of texts of somebody else.
        result : float, str or bool
            Not-a-number stands for a value that does not exist.
        """
        form = number_format(result) if digits and isinstance(result, float) and math.isfinite(result) else ""
        shown: Any = result
        if isinstance(result, float) and not math.isfinite(result):
            shown = ERRORS[str(result)]
        elif isinstance(result, str):
            shown = cell_text(result)
            self._fit_height(row, column, result, style)
        self.worksheet.write_formula(row, column, f"={formula}", self.book.style(style, form), shown)

    def merge(self, row: int, first: int, last: int, text: str) -> None:
        """Join the cells of a row, to be written afterwards with a text of this length."""
        self.worksheet.merge_range(row, first, row, last, "", self.book.style("text"))
        self._grow(row, LINE * lines_of(text, sum(self.widths[first : last + 1])))
        self._joined.add((row, first))

    def _fit_height(self, row: int, column: int, text: str, style: str) -> None:
        if STYLES[style].get("text_wrap") and (row, column) not in self._joined and column < len(self.widths):
            size = STYLES[style].get("font_size", 11) / 11
            broad = size * (BROAD if STYLES[style].get("bold") else 1)
            self._grow(row, LINE * size * lines_of(text, self.widths[column] / broad))

    def _grow(self, row: int, height: float) -> None:
        self._heights[row] = max(self._heights.get(row, LINE), height)

    def set_heights(self) -> None:
        """Make rows as high as their texts are long; not every program does that by itself."""
        for row, height in self._heights.items():
            if height > LINE:
                self.worksheet.set_row(row, round(height, 1))

    def scale(self, column: int, first: int, last: int, cells: str = "") -> None:
        """Colour shares by their size, from white over yellow to orange where all is used.

        Parameters
        ----------
        column, first, last : int
            The cells, one below the other.
        cells : str, optional
            Addresses of some of them.
        """
        rule: dict[str, Any] = {"type": "3_color_scale", "min_type": "num", "mid_type": "num", "max_type": "num"}
        rule |= {"min_value": 0, "mid_value": NEARLY, "max_value": 1}
        rule |= {"min_color": "#FFFFFF", "mid_color": MARKED, "max_color": FULL}
        self.worksheet.conditional_format(first, column, last, column, rule | ({"multi_range": cells} if cells else {}))

    def place(self, row: int, column: int) -> str:
        """Return a cell as formulas of any sheet call it."""
        return f"{self.name}!{cell(row, column, fixed=True)}"

    def area(self, row: int, column: int, last_row: int, last_column: int | None = None) -> str:
        """Return cells as formulas of any sheet call them."""
        last = cell(last_row, column if last_column is None else last_column, fixed=True)
        return f"{self.place(row, column)}:{last}"


def cell(row: int, column: int, fixed: bool = False) -> str:
    """Return the address of a cell.

    Examples
    --------
    >>> cell(4, 2), cell(0, 27, fixed=True)
    ('C5', '$AB$1')
    """
    letters, remaining = "", column + 1
    while remaining:
        remaining, letter = divmod(remaining - 1, 26)
        letters = chr(65 + letter) + letters
    return f"${letters}${row + 1}" if fixed else f"{letters}{row + 1}"


def lines_of(text: str, letters: float) -> int:
    """Number of lines that a text takes in a cell; what is very long is read in the cell itself.

    Examples
    --------
    >>> lines_of("a short text", 20), lines_of("one line and then a bit more", 20), lines_of("x" * 10000, 20)
    (1, 2, 12)
    """
    width = max(1, int(letters * LETTERS_PER_WIDTH))
    return min(MOST_LINES, sum(max(1, len(textwrap.wrap(line, width))) for line in text[:LONGEST].split("\n")))


def cell_text(text: str) -> str:
    r"""Return a text as a cell can hold it: what turns or hides text is written out, what is too long ends in dots.

    Examples
    --------
    >>> cell_text("=cmd()"), cell_text("a\u202eb\ufffe"), len(cell_text("x" * 40000))
    ('=cmd()', 'a\\u202eb\\ufffe', 32767)
    """
    plain = printable(text).replace("\ufffe", "\\ufffe").replace("\uffff", "\\uffff")
    units = len(plain) + sum(letter > "\uffff" for letter in plain)
    if units <= MOST_TEXT:
        return plain
    # A letter may take two units.
    return plain[: MOST_TEXT - 1 if units == len(plain) else MOST_TEXT // 2 - 1] + "…"


def number_format(value: float, digits: int = DIGITS) -> str:
    """Return the format that shows so many significant digits of a number, and of others of about its size.

    Examples
    --------
    >>> [number_format(x) for x in (1714.2378, 0.0123456, 30.0, 2.5, 0.0, 1.2566e-6, 81234567.8)]
    ['0.0', '0.000000', 'General', 'General', 'General', '0.0000E+00', '0.0000E+00']
    """
    if value == 0 or (float(f"{value:.{digits - 1}g}") == value and 1e-4 <= abs(value) < ROUND):
        return "General"
    size = math.floor(math.log10(abs(value)))
    if not -4 <= size < 7:
        return "0." + "0" * (digits - 1) + "E+00"
    return "0." + "0" * (digits - 1 - size) if size < digits - 1 else "0"
