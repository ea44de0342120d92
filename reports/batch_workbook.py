"""The workbook of a batch: how its rows stand, and all of them, for sorting and filtering of one's own."""

from __future__ import annotations

from collections.abc import Sequence

from synth.results.batch_record import FAILURES, BatchRecord, BatchRow
from synth.results.report_request import About

from .batch_report import batch_state
from .excel_sheets import Book

OPTION = "--xlsx"
LEADING = (("line", 8), ("row", 14), ("family", 22), ("state", 14), ("designs", 9))
TRAILING = (("best design", 60), ("why none", 60), ("remarks", 40))
OBJECTIVE, CELL = 16.0, 18.0  # widths [characters]
HEAD_ROW = 3


def batch_workbook(batch: BatchRecord, about: About) -> bytes:
    """Return the workbook of a batch; the same batch gives the same bytes.

    Raises
    ------
    InputError
        The extra ``excel`` is not there.
    """
    # Of many rows nothing is kept that is written.
    book = Book(OPTION, about.title or batch.source, row_by_row=True)
    _summary(book, batch, about)
    _rows(book, "rows", batch, batch.rows)
    failed = [row for row in batch.rows if row.status in FAILURES]
    if failed:
        _rows(book, "without a design", batch, failed)
    return book.bytes()


def _summary(book: Book, batch: BatchRecord, about: About) -> None:
    sheet = book.sheet("summary", (28, 16, 60), locked=False)
    state = batch_state(batch)
    sheet.text(0, 0, about.title or batch.source, "title_line")
    sheet.text(1, 0, state.head, "state_line")
    sheet.heads(HEAD_ROW, ("state", "rows"), right=(1,))
    below = HEAD_ROW + 1
    for place, (status, count) in enumerate(batch.counts.items(), start=below):
        sheet.text(place, 0, status, "plain")
        sheet.number(place, 1, count)
    facts = (*about.facts(), *((name, str(value)) for name, value in batch.settings.items() if value))
    for place, (label, words) in enumerate(facts, start=below + len(batch.counts) + 1):
        sheet.text(place, 0, label, "plain")
        sheet.text(place, 1, words, "line")


def _rows(book: Book, name: str, batch: BatchRecord, rows: Sequence[BatchRow]) -> None:
    """Write rows, each cell once and from the top, as nothing is kept of them."""
    columns = [*LEADING, *((heading, OBJECTIVE) for heading in batch.objectives), *TRAILING]
    columns += [(heading, CELL) for heading in batch.headings]
    heads = [heading for heading, _ in columns]
    numeric = {0, 4, *range(len(LEADING), len(LEADING) + len(batch.objectives))}
    sheet = book.sheet(name, [width for _, width in columns], locked=False, over_pages=True)
    sheet.worksheet.freeze_panes(1, 1)
    sheet.worksheet.repeat_rows(0)
    sheet.worksheet.autofilter(0, 0, max(len(rows), 1), len(heads) - 1)
    sheet.heads(0, heads, numeric)
    for place, row in enumerate(rows, start=1):
        leading = (row.line, row.key, row.family, row.status, row.designs)
        cells = (*leading, *row.objectives, row.best, row.reason, row.remarks, *row.cells)
        for column, cell in enumerate(cells):
            if isinstance(cell, str):
                if cell:
                    sheet.text(place, column, cell, "plain")
            else:
                sheet.number(place, column, cell)
