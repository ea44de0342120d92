"""Title block, parts list and notes of a sheet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from synth.drawing import Drawing, Item, LineKind
from synth.results.report_request import About

from .lettering import LABEL, SMALL, TEXT, fitted, wrapped
from .paper import Ring, Stroke, Text, scale_label

BLOCK_WIDTH = 180.0  # of title block and parts list (ISO 7200)
BLOCK = 36.0  # height of the title block
ROW = 5.0  # of the parts list
NOTE = 3.9  # from line to line of notes
INDENT = 3.0  # mm of the later lines of a note
LEAST = 1.8  # least height of letters
# Columns of the parts list: heading, width, whether numbers stand in it.
COLUMNS = (
    ("Item", 11.0, True),
    ("Qty", 11.0, True),
    ("Name", 48.0, False),
    ("Material", 50.0, False),
    ("Note", 60.0, False),
)
TYPE = "Design layout"
SIZES = "Computed sizes in mm, without tolerances"
NOT_DRAWN = "Not part of the model, not drawn:"


@dataclass(frozen=True)
class Written:
    """Lines and texts of a block."""

    strokes: tuple[Stroke, ...]
    texts: tuple[Text, ...]
    rings: tuple[Ring, ...] = ()


@dataclass(frozen=True)
class NoteLine:
    """A line of the notes, so far to the right [mm]."""

    words: str
    indent: float = 0.0
    bold: bool = False


def list_height(items: Sequence[Item]) -> float:
    """Return the height of the parts list with its heading [mm]."""
    return ROW * (len(items) + 1)


def parts_list(items: Sequence[Item], right: float, bottom: float) -> Written:
    """Return the parts list above the title block: item 1 at the bottom, as lists that grow upwards have it."""
    left = right - BLOCK_WIDTH
    strokes, texts = [], []
    top = bottom + list_height(items)
    rows: list[tuple[str, ...]] = [tuple(title for title, _, _ in COLUMNS)]
    rows += [(str(i.number), str(i.count), i.name, i.material, i.note) for i in sorted(items, key=lambda i: i.number)]
    for k, cells in enumerate(rows):
        base = bottom + ROW * k
        strokes.append(Stroke(((left, base + ROW), (right, base + ROW)), LineKind.THIN))
        x = left
        for (_, column_width, number), cell in zip(COLUMNS, cells, strict=True):
            if cell:
                words, height = fitted(cell, column_width - 2, LABEL if k == 0 else SMALL, LEAST)
                at = (x + column_width / 2 if number else x + 1.2, base + (ROW - height) / 2)
                full_text = cell if words != cell else ""
                texts.append(Text(at, words, height, "middle" if number else "start", bold=k == 0, full_text=full_text))
            x += column_width
    x = left
    for _, column_width, _ in (*COLUMNS, ("", 0.0, False)):
        strokes.append(Stroke(((x, bottom), (x, top)), LineKind.THIN))
        x += column_width
    strokes.append(Stroke(((left, top), (right, top)), LineKind.OUTLINE))
    return Written(tuple(strokes), tuple(texts))


def title_block(
    drawing: Drawing, title: str, program: str, about: About, scale: float, name: str, right: float, bottom: float
) -> Written:
    """Return the title block with the fields of ISO 7200; what is not told stays empty."""
    left = right - BLOCK_WIDTH
    fields = [  # x, y from the top, width, height, label, words
        (0, 0, 60, 12, "Legal owner", about.company),
        (60, 0, 80, 12, "Title", about.title or title),
        (140, 0, 40, 12, "Identification number", about.number),
        (0, 12, 60, 12, "Project, customer", ", ".join(x for x in (about.project, about.customer) if x)),
        (60, 12, 80, 12, "Shows", drawing.title),
        (140, 12, 20, 12, "Revision", about.revision),
        (160, 12, 20, 12, "Sheet", f"1/1 {name}"),
        (0, 24, 40, 12, "Created by", about.author or program),
        (40, 24, 35, 12, "Approved by", about.checked_by),
        (75, 24, 25, 12, "Date of issue", about.date),
        (100, 24, 40, 12, "Document type", TYPE),
        (140, 24, 20, 12, "Scale", scale_label(scale)),
        (160, 24, 20, 12, "Projection", ""),
    ]
    strokes, texts = [], []
    for x, y, field_width, high, what, words in fields:
        x0, y1 = left + x, bottom + BLOCK - y
        x1, y0 = x0 + field_width, y1 - high
        strokes.append(Stroke(((x0, y0), (x1, y0), (x1, y1), (x0, y1)), LineKind.THIN, closed=True))
        texts.append(Text((x0 + 1, y1 - 1 - LABEL), what, LABEL))
        if words:
            shown, height = fitted(words, field_width - 3, TEXT, LEAST)
            texts.append(Text((x0 + 1.5, y0 + 2.8), shown, height, full_text=words if shown != words else ""))
    outer = ((left, bottom), (right, bottom), (right, bottom + BLOCK), (left, bottom + BLOCK))
    strokes.append(Stroke(outer, LineKind.OUTLINE, closed=True))
    symbol = _first_angle(left + 170, bottom + 4.6)
    return Written((*strokes, *symbol.strokes), tuple(texts), symbol.rings)


def _first_angle(x: float, y: float) -> Written:
    """Return the symbol of first angle projection: a truncated cone, and to its right what is seen from the left."""
    cone = ((x - 7, y - 1.4), (x - 7, y + 1.4), (x - 1, y + 2.8), (x - 1, y - 2.8))
    strokes = (
        Stroke(cone, LineKind.OUTLINE, closed=True, line_width=0.35),
        Stroke(((x - 8, y), (x + 8, y)), LineKind.CENTRE, line_width=0.18),
        Stroke(((x + 4, y - 3.4), (x + 4, y + 3.4)), LineKind.CENTRE, line_width=0.18),
    )
    return Written(strokes, (), (Ring((x + 4, y), 2.8), Ring((x + 4, y), 1.4)))


def note_lines(drawing: Drawing, available: float) -> list[NoteLine]:
    """Return the notes of a sheet in lines that fit."""
    lines = [NoteLine(NOT_DRAWN, bold=True)]
    for text in drawing.omitted:
        lines += _note(text, available)
    lines.append(NoteLine("Remarks:", bold=True))
    for text in (f"{SIZES}.", *drawing.remarks):
        lines += _note(text, available)
    return lines


def _note(text: str, available: float) -> list[NoteLine]:
    lines = enumerate(wrapped(f"– {text}", available - INDENT, SMALL))
    return [NoteLine(words, INDENT if k else 1.0) for k, words in lines]


def notes(lines: Sequence[NoteLine], left: float, bottom: float) -> Written:
    """Return the notes, the last line at the bottom."""
    texts = []
    for k, line in enumerate(reversed(lines)):
        at = (left + line.indent, bottom + 1.5 + NOTE * k)
        texts.append(Text(at, line.words, SMALL, bold=line.bold))
    return Written((), tuple(texts))
