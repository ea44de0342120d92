"""Documents as sources of Typst: data for the functions of ``assets/report.typ``, every text of others as a string."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import date
from itertools import pairwise

from ..formula.layout import MINUS, Amount, Call, Cases, Fence, Fraction, Layout, Letter, Power, Root, Row, Sign, Word
from ..formula.lines import broken, width
from ..formula.plain import plain
from ..formula.typst import string, typst_math
from ..numbers import printed
from .blocks import (
    Block,
    Bullets,
    Cell,
    Code,
    Column,
    Document,
    Figure,
    Heading,
    Inline,
    Link,
    Listing,
    Paragraph,
    RowsBlock,
    State,
    StepBlock,
    Strong,
    TableBlock,
    TableRow,
)
from .html import asset

PAGE = 175.0  # mm between the margins
DIGIT = 1.6  # mm that a digit takes in a formula of a table
SURELY = 2.4  # mm that a digit takes at most: what is narrower is not measured
MOST_SHRUNK = 1.25  # times its column, as wide as a formula of a table may be and be set smaller
BELOW = "as below"  # stands where a formula is too wide for its column
LINE_OF_TEXT = 74.0  # digits of a formula that stand in a line of text
LONG_WORD = 18  # letters from which on a word may be broken anywhere
LONG_NAME = 22  # letters from which on a public name may be broken behind its underscores
PIECE = 6  # letters of such a word that stay together
MUCH = 1500  # letters from which on something may go over two pages
LONGEST_LINE = 88  # letters of a listing that fit
RUNNING = 56  # letters of the title on every page
RUNNING_FACT = 36  # letters of project, number and revision there
REPEATED = 500  # letters of the head of a table that are said again on each page
LONGEST_ALT = 8000  # letters of a text that only machines read; those of PDF/A have 32767 bytes
LONGEST_FACT = 500  # letters of the title, author and keywords in the properties of a file
LONGEST_LINK = 2000  # letters
OPEN_SCHEMES = ("http", "https", "mailto")
COMPARED = ("≤", "≥", "=", "<", "≠")
LAYOUTS = (Letter, Amount, Word, Sign, Row, Fraction, Power, Root, Fence, Call, Cases)
NO_DATE = "datetime(year: 1970, month: 1, day: 1)"  # files for archives must have one
LINE_ENDS = re.compile(r"\s*[\r\n\x0b\x0c\x85\u2028\u2029]\s*")


def typst_source(document: Document, logo: str = "") -> str:
    """Return a document as one source of Typst.

    Parameters
    ----------
    document : Document
    logo : str
        The name of the file with its logo.
    """
    return _Writer(document, logo).source()


def one_text(text: str) -> str:
    """Return a text as a string of Typst, in one line."""
    return string(LINE_ENDS.sub(" ", text))


def _list(items: Iterable[str]) -> str:
    """Return items as an array of Typst."""
    return f"({''.join(f'{item}, ' for item in items)})"


def _pieces(text: str) -> list[str]:
    """Return a text in pieces between which a line may be broken, beside at blanks: long words are cut."""
    pieces: list[str] = [""]
    for word in re.split(r"(\s+)", text):
        if len(word) <= LONG_WORD or word.isspace():
            pieces[-1] += word
            continue
        cut = _cut(word)
        pieces[-1] += cut[0]
        pieces += cut[1:]
    return [piece for piece in pieces if piece]


def _cut(word: str) -> list[str]:
    """Cut a long word behind its signs; what is still long, anywhere."""
    parts = re.findall(r"[^_/.,;:=-]*[_/.,;:=-]+|[^_/.,;:=-]+", word)
    return [piece for part in parts for piece in (_bits(part) if len(part) > LONG_WORD else [part])]


def _bits(word: str) -> list[str]:
    return [word[k : k + PIECE] for k in range(0, len(word), PIECE)]


def _text(text: str) -> str:
    """Return a text as content."""
    pieces = _pieces(LINE_ENDS.sub(" ", text))
    if len(pieces) < 2:
        return one_text(text)
    return f"pieces({', '.join(map(one_text, pieces))})"


def _code(text: str) -> str:
    pieces = _pieces(text) if " " in text else _cut(text) if len(text) > LONG_NAME else [text]
    return f"code({', '.join(map(one_text, pieces))})"


def _shortened(text: str, most: int) -> str:
    return text if len(text) <= most else f"{text[: most - 1].rstrip()}…"


def _equation(layout: Layout) -> str:
    return f"eq({_alternative(plain(layout))}, ${typst_math(layout)}$)"


def _property(text: str) -> str:
    return one_text(_shortened(text, LONGEST_FACT))


def _alternative(text: str) -> str:
    """Text in place of a formula or a drawing."""
    return one_text(_shortened(text, LONGEST_ALT))


def _high_equation(layout: Layout) -> str:
    """Return a formula that stands alone in its line: fractions are set as high as they are."""
    return f"eq({_alternative(plain(layout))}, $display({typst_math(layout)})$)"


def _lines_of(layout: Layout, widest: float) -> list[Layout]:
    """Return a layout as lines of a narrow column: broken before a comparison, then before terms and factors."""
    if width(layout) <= widest:
        return [layout]
    if isinstance(layout, Row):
        for place, item in enumerate(layout.items):
            if place and isinstance(item, Sign) and item.text in COMPARED:
                before, after = Row(layout.items[:place]), Row(layout.items[place:])
                return [*broken(_single(before), widest), *broken(after, widest)]
    return broken(layout, widest)


def _single(row: Row) -> Layout:
    return row.items[0] if len(row.items) == 1 else row


@dataclass
class _Writer:
    document: Document
    logo: str
    anchors: set[str] = field(default_factory=set)  # that links may lead to
    placed: set[str] = field(default_factory=set)
    level: int = 0

    def source(self) -> str:
        """Return the whole source."""
        document = self.document
        self.anchors = _anchors(document.blocks)
        facts = dict(document.facts)
        day = re.fullmatch(r"(\d{4})-(\d{2})-(\d{2})", facts.get("Date", "").strip())
        running = [facts.get("Project", ""), facts.get("Number", "")]
        if facts.get("Revision"):
            running.append(f"rev. {facts['Revision']}")
        keywords = [document.kind, document.program, facts.get("Project", ""), facts.get("Number", "")]
        named = {
            "metadata-title": _property(f"{document.title}: {document.kind.lower()}"),
            "author": _list([_property(facts["Author"])] if facts.get("Author") else []),
            "keywords": _list(_property(word) for word in keywords if word),
            "date": _date(*map(int, day.groups())) if day else NO_DATE,
            "kind": one_text(_shortened(document.kind, RUNNING // 2)),
            "heading-title": _text(document.title),
            "running-title": one_text(_shortened(document.title, RUNNING)),
            "running-facts": one_text(" · ".join(_shortened(word, RUNNING_FACT) for word in running if word)),
            "program": one_text(_shortened(document.program, RUNNING)),
            "facts": _list(f"({_text(label)}, {_text(words)})" for label, words in document.facts),
            "logo": one_text(self.logo) if self.logo else "none",
        }
        head = ",\n".join(f"  {name}: {value}" for name, value in named.items())
        blocks = [self._block(block, after) for block, after in pairwise([*document.blocks, None]) if block]
        return f"{asset('report.typ')}\n#show: paper.with(\n{head},\n)\n" + "\n".join(f"#{b}" for b in blocks) + "\n"

    # -- pieces of a line ----------------------------------------------------------------------

    def _inline(self, part: Inline) -> str:
        if isinstance(part, str):
            return _text(part)
        if isinstance(part, Code):
            return _code(part.text)
        if isinstance(part, Strong):
            return f"must({_text(part.text)})"
        if isinstance(part, Link):
            return self._link(part)
        if isinstance(part, Amount):
            return one_text(printed(part.shown))
        return _text(part.text) if isinstance(part, Word) else _equation(part)

    def _link(self, link: Link) -> str:
        if link.target.startswith("#"):
            anchor = link.target[1:]
            return (
                f"link(label({one_text(anchor)}), {_text(link.text)})" if anchor in self.anchors else _text(link.text)
            )
        scheme, colon, _ = link.target.partition(":")
        if not 0 < len(link.target) <= LONGEST_LINK or (colon and scheme.lower() not in OPEN_SCHEMES):
            return _text(link.text)
        return f"link({one_text(link.target)}, {_text(link.text)})"

    def _line(self, cell: Cell) -> str:
        """Return a line: its pieces beside each other; formulas that are wider than a line stand on their own."""
        parts = cell if isinstance(cell, tuple) else (cell,)
        pieces = [self._lines(p, LINE_OF_TEXT) if _overflows(p, LINE_OF_TEXT) else self._inline(p) for p in parts]
        return pieces[0] if len(pieces) == 1 else f"[{''.join(f'#{x};' for x in pieces)}]"

    def _lines(self, layout: Inline, widest: float) -> str:
        assert isinstance(layout, LAYOUTS)
        return f"lines({', '.join(map(_high_equation, _lines_of(layout, widest)))})"

    def _cell(self, cell: Cell, column: Column, span: float) -> str:
        """Return a cell of a table; ``span`` is the width of the column in mm."""
        if isinstance(cell, (Amount, Letter)) or (column.number and isinstance(cell, str) and len(cell) <= LONG_WORD):
            digits = len(cell) if isinstance(cell, str) else width(cell)
            narrow = digits * SURELY <= span
            return f"box({self._inline(cell)})" if narrow else f"fit(box({self._inline(cell)}))"
        if isinstance(cell, LAYOUTS) and not isinstance(cell, Word):
            return _high_equation(cell) if width(cell) * SURELY <= span else self._lines(cell, span / DIGIT)
        parts = cell if isinstance(cell, tuple) else (cell,)
        pieces = [
            self._lines(p, span / DIGIT) if _overflows(p, span / DIGIT) else self._inline(p) for p in parts if p != ""
        ]
        return pieces[0] if len(pieces) == 1 else f"[{''.join(f'#{x};' for x in pieces)}]"

    # -- blocks --------------------------------------------------------------------------------

    def _anchor(self, anchor: str) -> str:
        """Return a place that links lead to; the first of a name."""
        if not anchor or anchor in self.placed:
            return "none"
        self.placed.add(anchor)
        return one_text(anchor)

    def _block(self, block: Block, after: Block | None) -> str:
        if isinstance(block, Heading):
            self.level = min(block.level, self.level + 1)
            return f"section({self.level}, {self._anchor(block.anchor)}, {_text(block.text)})"
        if isinstance(block, Paragraph):
            sticky = isinstance(after, (TableBlock, StepBlock, Figure, Listing, Bullets))
            return f"para({_flag(block.small)}, {_flag(sticky)}, {self._line(block.text)})"
        if isinstance(block, State):
            return f"state({', '.join([one_text(block.level), *map(_text, (block.head, *block.details))])})"
        if isinstance(block, TableBlock):
            return self._table(block)
        if isinstance(block, RowsBlock):
            return f"para(false, false, {_text(block.on_paper)})"
        if isinstance(block, StepBlock):
            return self._step(block)
        if isinstance(block, Bullets):
            return f"points({', '.join(self._line(item) for item in block.items)})"
        if isinstance(block, Figure):
            caption = _text(block.caption) if block.caption else "none"
            return f"drawing({_alternative(block.alt)}, {caption}, {string(block.svg)})"
        assert isinstance(block, Listing)
        return f"listing({_flag(len(block.text) <= MUCH)}, {_listing(block.text)})"

    def _table(self, block: TableBlock) -> str:
        total = sum(c.width for c in block.columns)
        widths = [PAGE * c.width / total - 3 for c in block.columns]
        bars = next((str(k) for k, c in enumerate(block.columns) if c.title == "used"), "none")
        labelled = False
        groups = []
        for label, rows in block.groups:
            labelled = labelled or bool(label)
            head = _text(label or "–") if labelled else "none"
            again = _flag(len(label) <= REPEATED)
            groups.append(f"({head}, {again}, {_list(self._row(row, block.columns, widths) for row in rows)})")
        arguments = [
            _text(block.caption),
            _list(f"{c.width:g}" for c in block.columns),
            _list(_flag(c.number) for c in block.columns),
            bars,
            _flag(sum(len(c.title) for c in block.columns) <= REPEATED),
            _list(_text(c.title) for c in block.columns),
            *groups,
        ]
        return f"tabular({', '.join(arguments)})"

    def _row(self, row: TableRow, columns: Sequence[Column], widths: Sequence[float]) -> str:
        arguments = [f"mark: {one_text(row.mark)}"] if row.mark else []
        if row.used is not None:
            arguments.append(f"used: {min(1.0, max(0.0, row.used)):.4g}")
        if row.anchor:
            arguments.append(f"anchor: {self._anchor(row.anchor)}")
        if sum(map(_letters, row.cells)) > MUCH:
            arguments.append("whole: false")
        cells = list(row.cells)
        below = next((k for k, cell in enumerate(cells) if k and _is_below(cell, widths[k] / DIGIT)), None)
        if below is not None:
            arguments.append(f"below: {self._line(cells[below])}")
            cells[below] = BELOW
        arguments += [self._cell(cell, column, mm) for cell, column, mm in zip(cells, columns, widths, strict=True)]
        return f"row({', '.join(arguments)})"

    def _step(self, block: StepBlock) -> str:
        rows: list[str] = []
        for position, lines in enumerate(block.equal):
            for place, line in enumerate(lines):
                body = typst_math(line)
                if place and isinstance(line, Row) and line.items[0] == MINUS:
                    body = f"- {typst_math(Row(line.items[1:]))}"
                if position == len(block.equal) - 1:
                    body = f" #result(${body}$) "
                rows.append(f'& quad #"" {body}' if place else f"&= {body}")
        alt, equal = "; ".join(block.plain), " \\ ".join(rows)
        unbroken = len(alt) + len(block.meaning) + len(block.source) + sum(map(_letters, block.notes)) <= MUCH
        arguments = [
            one_text(str(block.number)),
            self._anchor(block.anchor),
            _flag(unbroken),
            f"[#{_text(block.meaning)}; #{_code(block.name)}]" if block.name else _text(block.meaning),
            _text(block.source),
            f"formula({_alternative(alt)}, $ {typst_math(block.symbol)} {equal} $)",
            *map(self._line, dict.fromkeys(block.notes)),
        ]
        return f"step({', '.join(arguments)})"


def _flag(is_so: bool) -> str:
    return "true" if is_so else "false"


def _date(year: int, month: int, day: int) -> str:
    return f"datetime(year: {year}, month: {month}, day: {day})" if _exists(year, month, day) else NO_DATE


def _exists(year: int, month: int, day: int) -> bool:
    try:
        date(year, month, day)
    except ValueError:
        return False
    return True


def _overflows(part: Inline, widest: float) -> bool:
    return isinstance(part, LAYOUTS) and not isinstance(part, (Letter, Amount, Word)) and width(part) > widest


def _is_below(cell: Cell, widest: float) -> bool:
    """True if a cell is a formula that is too wide for its column, however it is broken."""
    if not isinstance(cell, LAYOUTS) or isinstance(cell, (Letter, Amount, Word)):
        return False
    return max(map(width, _lines_of(cell, widest))) > MOST_SHRUNK * widest


def _letters(cell: Cell) -> int:
    """Return about how much stands in a cell."""
    if isinstance(cell, tuple):
        return sum(map(_letters, cell))
    return len(cell) if isinstance(cell, str) else len(getattr(cell, "text", ""))


def _anchors(blocks: Sequence[Block]) -> set[str]:
    rows = [row.anchor for b in blocks if isinstance(b, TableBlock) for _, rows in b.groups for row in rows]
    return {a for a in [*(b.anchor for b in blocks if isinstance(b, (Heading, StepBlock))), *rows] if a}


def _listing(text: str) -> str:
    """Return lines as they are; those that have no place to break are cut."""
    text = text.rstrip("\n").replace("\r\n", "\n").replace("\t", "    ")
    if max(map(len, text.split()), default=0) <= LONGEST_LINE:
        return f"raw(block: true, {string(text)})"
    lines = [f"pieces({', '.join(f'raw({string(x)})' for x in _pieces(line) or [' '])})" for line in text.split("\n")]
    return f"{{ {'; linebreak(); '.join(lines)} }}"
