"""What a document says, as neutral blocks: every writer gives all of them, so that HTML and PDF say the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from synth.text.plain_text import counted

from ..formula.layout import Layout


@dataclass(frozen=True)
class Code:
    """A name or command, as it is typed."""

    text: str


@dataclass(frozen=True)
class Strong:
    """Words that must not be overlooked."""

    text: str


@dataclass(frozen=True)
class Link:
    """Words that lead to a place: an anchor of the document (``#step-12``) or a file beside it."""

    text: str
    target: str


Inline: TypeAlias = str | Layout | Code | Strong | Link
Cell: TypeAlias = Inline | tuple[Inline, ...]


def inline(*parts: Cell) -> tuple[Inline, ...]:
    """Return words, symbols and numbers beside each other."""
    pieces: list[Inline] = []
    for part in parts:
        pieces += part if isinstance(part, tuple) else [part]
    return tuple(pieces)


@dataclass(frozen=True)
class Heading:
    """A heading; ``level`` 1 is that of a section."""

    text: str
    level: int = 1
    anchor: str = ""


@dataclass(frozen=True)
class Paragraph:
    """A paragraph; ``small`` for notes."""

    text: Cell
    small: bool = False


@dataclass(frozen=True)
class State:
    """What must be known first: ``good``, ``open`` or ``bad``, said in words."""

    level: str
    head: str
    details: tuple[str, ...] = ()


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading, whether numbers stand in it, and its share of the width."""

    title: str
    number: bool = False
    width: float = 1.0


@dataclass(frozen=True)
class TableRow:
    """A row; ``mark`` is ``bad`` or ``tight`` where it must be seen, ``used`` a share that is drawn as a bar."""

    cells: tuple[Cell, ...]
    mark: str = ""
    used: float | None = None
    anchor: str = ""


@dataclass(frozen=True)
class TableBlock:
    """A table; rows may stand in groups, each under a label."""

    caption: str
    columns: tuple[Column, ...]
    groups: tuple[tuple[str, tuple[TableRow, ...]], ...]

    @staticmethod
    def of(caption: str, columns: Sequence[Column], rows: Sequence[TableRow]) -> TableBlock:
        """Return a table without groups."""
        return TableBlock(caption, tuple(columns), (("", tuple(rows)),))


@dataclass(frozen=True)
class RowsBlock:
    """A table of many rows to look through: a screen sorts it and filters it, paper tells where it is.

    Parameters
    ----------
    caption : str
    columns : tuple of Column
    rows : sequence of tuple
        Texts and numbers; None where there is no number.
    kind : int
        The column of a few words by which rows are chosen.
    elsewhere : str
        The files that have the rows as well.
    """

    caption: str
    columns: tuple[Column, ...]
    rows: Sequence[tuple[str | float | None, ...]]
    kind: int
    elsewhere: str

    @property
    def on_paper(self) -> str:
        """What is said in place of the rows where nobody can look through them."""
        return f"{counted(len(self.rows), 'row')}: see {self.elsewhere}."


@dataclass(frozen=True)
class StepBlock:
    """One formula: meaning, name and source; what it equals, the last of which is the result; notes.

    Each of ``equal`` may take several lines; ``plain`` says the same as text, an entry for each.
    """

    number: int
    anchor: str
    meaning: str
    name: str
    source: str
    symbol: Layout
    equal: tuple[tuple[Layout, ...], ...]
    plain: tuple[str, ...]
    notes: tuple[Cell, ...] = ()


@dataclass(frozen=True)
class Bullets:
    """A list of short remarks."""

    items: tuple[Cell, ...]


@dataclass(frozen=True)
class Figure:
    """A drawing as SVG, with what it shows in words."""

    svg: str
    alt: str
    caption: str = ""


@dataclass(frozen=True)
class Listing:
    """Lines to be typed or read as they are."""

    text: str


Block: TypeAlias = Heading | Paragraph | State | TableBlock | RowsBlock | StepBlock | Bullets | Figure | Listing


@dataclass(frozen=True)
class Document:
    """A document: what it is, for whom, and its blocks.

    Parameters
    ----------
    kind : str
        What it is: ``Calculation sheet``.
    title : str
        What it is about.
    facts : tuple of (str, str)
        Label and words of its head: project, customer, author, date.
    blocks : tuple of Block
    program : str
        What made it, with its version.
    logo : str
        A picture as a data address; nothing where there is none.
    data : str
        JSON of all designs, for readers of HTML who want to see one that is not told in full.
    """

    kind: str
    title: str
    facts: tuple[tuple[str, str], ...]
    blocks: tuple[Block, ...]
    program: str
    logo: str = field(default="", repr=False)
    data: str = field(default="", repr=False)
