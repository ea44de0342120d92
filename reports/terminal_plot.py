"""The front on a terminal: its first two objectives against each other, in braille dots or in plain characters."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from rich.cells import cell_len, set_cell_size
from rich.console import Console
from rich.text import Text

from synth.results import Design
from synth.text.numbers import number_text
from synth.text.plain_text import one_line, printable, words

from .front_plot import LABELLED, Axis, Drawn
from .label_spots import Box, label_spots

WIDEST = 100  # characters of the whole plot
ROWS, FEWEST_ROWS, MOST_ROWS = 16, 13, 19  # of the field: ordinarily, and as far as ticks may ask for others
FEWEST = 12  # characters of a field that is still drawn
# Bits of the dots of a braille character by place, two wide and four high.
BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
BRAILLE = 0x2800
# Dots of a point: a disc, or a small square where there are many.
DISC = tuple((x, y) for x in (-1, 0, 1, 2) for y in (-1, 0, 1, 2) if (x, y) not in {(-1, -1), (2, -1), (-1, 2), (2, 2)})
SMALL = ((0, 0), (1, 0), (0, 1), (1, 1))
BORDER, POINT, FAINT = "dim", "bold cyan", "dim"
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


@dataclass(frozen=True)
class Glyphs:
    """What a plot is drawn with."""

    fine: tuple[int, int]  # dots of a cell, across and down
    upright: str
    level: str
    corner: str
    value_tick: str
    low_tick: str


BRAILLE_GLYPHS = Glyphs((2, 4), "│", "─", "└", "┤", "┬")
ASCII_GLYPHS = Glyphs((1, 1), "|", "-", "+", "+", "+")


def print_plot(
    designs: Sequence[Design],
    objectives: Mapping[str, str],
    console: Console,
    families: Sequence[str] = (),
    braille: bool | None = None,
) -> None:
    """Draw the designs of a front on a terminal, or say why there is nothing to draw.

    Parameters
    ----------
    designs : list of Design
    objectives : mapping
        Names and senses; the first two are drawn.
    console : rich.console.Console
        Where to; its width and its encoding decide how.
    families : list of str
        The family of each design, where there are several: each has a letter.
    braille : bool, optional
        Whether to draw in braille dots; by default where the encoding has them.
    """
    drawn = Drawn(designs, objectives, families)
    if braille is None:
        braille = _writes(console, chr(BRAILLE) + "│┤")
    if drawn.why_not():
        lines = [Text(f"no plot: {drawn.why_not()}")]
    else:
        lines = plot_lines(drawn, min(console.width, WIDEST), BRAILLE_GLYPHS if braille else ASCII_GLYPHS)
    for line in lines:
        console.print(line, soft_wrap=True)


def _writes(console: Console, text: str) -> bool:
    try:
        text.encode(console.encoding)
    except (UnicodeEncodeError, LookupError):
        return False
    return True


def plot_lines(drawn: Drawn, width: int, glyphs: Glyphs) -> list[Text]:
    """Return the lines of a plot, none of them wider than ``width``.

    Parameters
    ----------
    drawn : Drawn
        At least two designs of at least two objectives.
    width : int
        Characters on a line.
    glyphs : Glyphs
        What it is drawn with.
    """
    first, second, *_ = drawn.objectives
    x_axis, y_axis = drawn.axis(first), drawn.axis(second)
    numbers = [number_text(tick) for tick in y_axis.ticks]
    margin = max(map(len, numbers)) + 1
    columns = width - margin - 1
    if columns < FEWEST:
        return [Text(line) for line in textwrap.wrap("no plot: it needs wider lines", width)]
    canvas = _field(drawn, (x_axis, y_axis), Canvas(columns, _rows(y_axis), glyphs))
    by_row = _numbers_by_row(y_axis, numbers, canvas.rows)
    lines = [Text(_cut(y_axis.title(), width))]
    for row in range(canvas.rows):
        number = by_row.get(row, "")
        line = Text(f"{number:>{margin - 1}} ")
        line.append(glyphs.value_tick if number else glyphs.upright, FAINT)
        line.append_text(canvas.line(row))
        line.rstrip()
        lines.append(line)
    ticks, below = _below(x_axis, columns)
    rule = "".join(glyphs.low_tick if column in ticks else glyphs.level for column in range(columns))
    lines.append(Text(" " * margin).append(glyphs.corner + rule, FAINT))
    lines.append(Text((" " * margin + below).rstrip()))
    title = _cut(x_axis.title(), width)
    lines.append(Text(" " * (width - cell_len(title)) + title))
    for sentence in _sentences(drawn):
        lines += [Text(_cut(line, width)) for line in textwrap.wrap(printable(sentence), width)]
    return lines


def _cut(text: str, width: int) -> str:
    """Return a text that takes no more than so many places of a line, and does nothing there."""
    text = one_line(text)
    return text if cell_len(text) <= width else set_cell_size(text, width - 3) + "..."


def _sentences(drawn: Drawn) -> list[str]:
    sentences = [f"{LETTERS[k % 26]}: {words(name)}" for name, k in drawn.listed().items()]
    names = [words(name) for name in drawn.objectives]
    if len(names) > 2:
        sentences.append(f"drawn are the first two of {len(names)} objectives, without {', '.join(names[2:])}")
    return sentences


# ---- the axes -------------------------------------------------------------------------------------------------------


def _rows(axis: Axis) -> int:
    """Number of rows of the field: so many that ticks are equally far apart, where they are on the axis."""
    steps = len(axis.ticks) - 1
    even = [k + 1 for k in range(steps, MOST_ROWS, steps) if k + 1 >= FEWEST_ROWS and not axis.log]
    return min(even, key=lambda rows: (abs(rows - ROWS), -rows), default=ROWS)


def _numbers_by_row(axis: Axis, numbers: Sequence[str], rows: int) -> dict[int, str]:
    """Return the numbers left of the field by row, one for each row at most."""
    by_row: dict[int, str] = {}
    for tick, text in zip(axis.ticks, numbers, strict=True):
        by_row.setdefault(round((1 - axis.share(tick)) * (rows - 1)), text)
    return by_row


def _below(axis: Axis, columns: int) -> tuple[set[int], str]:
    """Return the columns with ticks, and the line of their numbers from the corner on."""
    ticks, line = set(), ""
    for tick in axis.ticks:
        column, text = round(axis.share(tick) * (columns - 1)), number_text(tick)
        # The line begins below the corner, one place left of the field.
        begin = min(max(column + 1 - len(text) // 2, 0), columns + 1 - len(text))
        if not line or begin >= len(line) + 2:
            line = line.ljust(begin) + text
            ticks.add(column)
    return ticks - {0}, line  # the corner stands there


# ---- the field ------------------------------------------------------------------------------------------------------


@dataclass
class Canvas:
    """The field of a plot: characters, of which each may hold several dots."""

    columns: int
    rows: int
    glyphs: Glyphs
    border: dict[tuple[int, int], int] = field(default_factory=dict)  # bits of each cell
    points: dict[tuple[int, int], int] = field(default_factory=dict)
    texts: dict[tuple[int, int], tuple[str, str]] = field(default_factory=dict)  # a character and its style

    def place(self, across: float, up: float) -> tuple[int, int]:
        """Return the dot for shares of the field, which goes from the middle of the outermost cells to the other."""
        dots_x, dots_y = self.glyphs.fine
        x = (dots_x - 1) / 2 + across * (self.columns - 1) * dots_x
        y = (dots_y - 1) / 2 + (1 - up) * (self.rows - 1) * dots_y
        return math.floor(x + 0.5), math.floor(y + 0.5)

    def cell(self, x: int, y: int) -> tuple[int, int]:
        """Return column and row of a dot, within the field."""
        dots_x, dots_y = self.glyphs.fine
        return min(max(x // dots_x, 0), self.columns - 1), min(max(y // dots_y, 0), self.rows - 1)

    def dot(self, layer: dict[tuple[int, int], int], x: int, y: int) -> None:
        """Draw a dot; what lies outside is left."""
        dots_x, dots_y = self.glyphs.fine
        if 0 <= x < self.columns * dots_x and 0 <= y < self.rows * dots_y:
            cell = self.cell(x, y)
            layer[cell] = layer.get(cell, 0) | BITS[y % dots_y][x % dots_x]

    def line(self, row: int) -> Text:
        """Return a row of the field."""
        line = Text()
        for column in range(self.columns):
            cell = (column, row)
            if cell in self.texts:
                line.append(*self.texts[cell])
            elif cell in self.points:
                line.append(self._sign(self.points[cell], "o"), POINT)
            elif cell in self.border:
                line.append(self._sign(self.border[cell], "."), BORDER)
            else:
                line.append(" ")
        return line

    def _sign(self, bits: int, plain: str) -> str:
        return plain if self.glyphs.fine == (1, 1) else chr(BRAILLE + bits)


def _field(drawn: Drawn, axes: tuple[Axis, Axis], canvas: Canvas) -> Canvas:
    glyphs = canvas.glyphs
    first, second, *_ = drawn.objectives
    pair = (first, second)
    corners = [canvas.place(axes[0].share(x), axes[1].share(y)) for x, y in drawn.staircase(pair)]
    for (x1, y1), (x2, y2) in pairwise(corners):
        for x in range(min(x1, x2), max(x1, x2) + 1):
            for y in range(min(y1, y2), max(y1, y2) + 1):
                if (x + y) % 2 == 0 or max(glyphs.fine) == 1:
                    canvas.dot(canvas.border, x, y)
    dots = [
        canvas.place(axes[0].share(x), axes[1].share(y))
        for x, y in zip(drawn.values(pair[0]), drawn.values(pair[1]), strict=True)
    ]
    covered = [_point(canvas, drawn, k, dots[k]) for k in reversed(range(len(dots)))][::-1]  # the best ranks on top
    labels = [_label(drawn, design) for design in drawn.designs]
    lines = [Box(c, r, c + 1, r + 1) for c, r in canvas.border]
    field = Box(0, 0, canvas.columns, canvas.rows)
    sizes = [(len(label), 1) if label else None for label in labels]
    spots = label_spots(covered, sizes, field, lines, 1, integer=True)
    for label, spot in zip(labels, spots, strict=True):
        for k, letter in enumerate(label if spot is not None else ""):
            assert spot is not None
            canvas.texts[int(spot.left) + k, int(spot.top)] = (letter, "")
    return canvas


def _label(drawn: Drawn, design: Design) -> str:
    label = drawn.label(design)
    return f"{label} knee" if label and "knee" in design.note else label


def _point(canvas: Canvas, drawn: Drawn, k: int, dot: tuple[int, int]) -> Box:
    """Draw a design; return the cells that it covers."""
    x, y = dot
    if drawn.families:
        column, row = canvas.cell(x, y)
        letter = LETTERS[drawn.listed()[drawn.families[k]] % 26]
        canvas.texts[column, row] = (letter, POINT)
        return Box(column, row, column + 1, row + 1)
    shape = ((0, 0),) if canvas.glyphs.fine == (1, 1) else DISC if len(drawn.designs) <= LABELLED else SMALL
    for dx, dy in shape:
        canvas.dot(canvas.points, x + dx, y + dy)
    cells = [canvas.cell(x + dx, y + dy) for dx, dy in shape]
    left, right = min(c for c, _ in cells), max(c for c, _ in cells) + 1
    return Box(left, min(r for _, r in cells), right, max(r for _, r in cells) + 1)
