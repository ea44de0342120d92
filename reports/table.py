"""A front on the terminal: what one decides by as a ranked table, then why the leading designs are there."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rich import box
from rich.console import Console
from rich.table import Table

from reports.numbers import unit_text
from reports.reasons import binding, why
from reports.screen_numbers import in_unit, words
from reports.sizing import sizing_line
from synth.plain_text import plain_number
from synth.results import Design, ParetoFront
from synth.results.calculation import Calculation

SHOWN = 10  # designs on one screen
EXPLAINED = 3  # designs of which it is told why they are there, beside those that are best in something
BETWEEN = 3  # blanks between two columns
NARROWEST = 18  # of the column of what limits a design


def print_front(
    front: ParetoFront, console: Console, every: bool = False, calculation: Calculation | None = None
) -> None:
    """Print the ranked designs by what one decides by, and why the leading ones are on the front.

    Parameters
    ----------
    front : ParetoFront
    console : rich.console.Console
        Where to; its width decides how the columns are arranged.
    every : bool
        All designs instead of the first ten.
    calculation : Calculation, optional
        Of the front, to tell how the torque came about that designs are sized for.
    """
    count = len(front.designs) if every else min(SHOWN, len(front.designs))
    shown = front.designs[:count]
    _print_wrapped(console, f"{front.frame.title}: {_counted(front)}", 0)
    line = "" if calculation is None else sizing_line(calculation, front.designs[0])
    if line:
        _print_wrapped(console, line, 0)
    console.print()
    for table in ranked_tables(front, count, console.width):
        console.print(table)
        console.print()
    for design in shown:
        if design.rank is not None and (design.rank <= EXPLAINED or design.note or every):
            _print_reason(front, design, console)
    if count < len(front.designs):
        console.print(f"{len(front.designs) - count} more with --all, and in designs.csv")


def _counted(front: ParetoFront) -> str:
    designs = len(front.designs)
    if designs == 1:
        return "1 design"
    if len(front.frame.objectives) == 1:
        return f"{designs} designs"
    return f"{designs} designs; #1 comes nearest to the best {_listed(map(words, front.frame.objectives))}"


def _listed(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _print_reason(front: ParetoFront, design: Design, console: Console) -> None:
    """Print why a design is on the front; of the first one also its other sizes, and what there is to remark."""
    _print_wrapped(console, f"#{design.rank}: {why(front, design)}", 0)
    if design is not front.designs[0]:
        return
    sizes = _other_sizes(design)
    if sizes:
        _print_wrapped(console, f"other sizes: {sizes}", 4)
    for name, row in design.next_rows.items():
        _print_wrapped(console, f"next in the tables: {words(name)} {row}", 4)
    for remark in design.advice:
        _print_wrapped(console, f"remark: {remark.partition(': ')[2] or remark}", 4)
    for remark in design.not_checked:
        _print_wrapped(console, remark, 4)


def _print_wrapped(console: Console, text: str, indent: int) -> None:
    """Print a text on lines no wider than the screen, the later ones indented."""
    first, later = " " * indent, " " * (indent + 4)
    lines = textwrap.wrap(text, console.width, initial_indent=first, subsequent_indent=later, break_on_hyphens=False)
    for line in lines:
        console.print(line, soft_wrap=True)


def _other_sizes(design: Design) -> str:
    """Return the variables and counts of a design that no column tells."""
    frame = design.frame
    told = _quantities(frame.headline, frame.objectives)
    return ", ".join(
        f"{words(name)} {in_unit(design.values[name], frame.units[name])} {unit_text(frame.units[name])}".rstrip()
        for name, kind in frame.kinds.items()
        if kind in ("variable", "count") and name not in told
    )


def _quantities(headline: Sequence[str], objectives: Iterable[str]) -> list[str]:
    return list(dict.fromkeys([*objectives, *headline]))


@dataclass(frozen=True)
class _Column:
    """Lines of a heading, and cells."""

    heading: tuple[str, ...]
    cells: tuple[str, ...]

    @property
    def width(self) -> int:
        """Characters of the widest line."""
        return max(len(line) for text in (*self.heading, *self.cells) for line in text.split("\n"))


def ranked_tables(front: ParetoFront, count: int, width: int) -> list[Table]:
    """Return the first designs as tables that are no wider than ``width``; each begins with the rank.

    Parameters
    ----------
    front : ParetoFront
    count : int
        How many designs.
    width : int
        Characters on a line.
    """
    frame, shown = front.frame, front.designs[:count]
    names = _quantities(frame.headline, frame.objectives)
    if not frame.headline:
        names += [n for n, kind in frame.kinds.items() if kind in ("variable", "count") and n not in names]
    columns = [
        _column(words(n), unit_text(frame.units[n]), [in_unit(d.values[n], frame.units[n]) for d in shown])
        for n in names
    ]
    if frame.sized_by:
        columns.insert(len(frame.objectives), _column("reserve of torque", "%", [_reserve(d) for d in shown]))
    first = shown[0]
    columns += [_column(words(n), "", [words(d.choices[n]) for d in shown]) for n in first.choices]
    columns += [_column(words(slot), "", [str(d.parts[slot]) for d in shown]) for slot in first.parts]
    ranks = _column("rank", "", [f"#{design.rank}" for design in shown])
    groups: list[list[_Column]] = [[ranks]]
    room = width - ranks.width
    for column in columns:
        if column.width + BETWEEN > room and len(groups[-1]) > 1:
            groups.append([ranks])
            room = width - ranks.width
        groups[-1].append(column)
        room -= column.width + BETWEEN
    limits = [", ".join(map(words, binding(d))) or "no limit" for d in shown]
    if room - BETWEEN < min(NARROWEST, max(map(len, limits))):
        groups.append([ranks])
        room = width - ranks.width
    wrapped = ["\n".join(textwrap.wrap(text, room - BETWEEN, break_long_words=True)) for text in limits]
    groups[-1].append(_column("limited by", "", wrapped))
    return [_grid(group) for group in groups]


def _reserve(design: Design) -> str:
    """Return by how many per cent a design carries more than it is sized for."""
    carried, needed = design.limits.get(design.frame.sized_by, (0.0, 0.0))
    return plain_number(round(100 * (carried / needed - 1), 1) + 0.0) if needed else ""


def _column(name: str, unit: str, cells: Sequence[str]) -> _Column:
    """Return a column whose heading is broken between words, the unit on a line of its own."""
    parts = name.split() or [""]
    broad = max(len(x) for x in [*parts, *(line for cell in cells for line in cell.split("\n"))])
    lines = [parts[0]]
    for word in parts[1:]:
        if len(lines[-1]) + 1 + len(word) <= broad:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return _Column((*lines, f"[{unit}]") if unit else tuple(lines), tuple(cells))


def _grid(columns: Sequence[_Column]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, header_style="")
    for column in columns:
        number = all(_is_number(cell) for cell in column.cells)
        table.add_column(
            "\n".join(column.heading), justify="right" if number else "left", no_wrap=True, vertical="bottom"
        )
    for row in zip(*(column.cells for column in columns), strict=True):
        lines = max(cell.count("\n") for cell in row)
        table.add_row(*(cell + "\n" * (lines - cell.count("\n")) for cell in row))  # headings stand below, cells above
    return table


def _is_number(cell: str) -> bool:
    try:
        float(cell.removeprefix("#").replace(" ", "") or "0")
    except ValueError:
        return False
    return True
