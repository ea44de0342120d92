"""A front as a ranked table on the terminal, and for each design why it is there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from reports.reasons import significant, why
from synth.results import ParetoFront

SHOWN = 10  # designs on one screen
BETWEEN = 3  # blanks between two columns


def print_front(front: ParetoFront, console: Console, every: bool = False) -> None:
    """Print the ranked designs: objectives, dimensions, parts, and why each is on the front.

    Parameters
    ----------
    front : ParetoFront
    console : rich.console.Console
        Where to; its width decides how the columns are arranged.
    every : bool
        All designs instead of the first ten.
    """
    count = len(front.designs) if every else min(SHOWN, len(front.designs))
    console.print(f"{front.frame.title} ({front.frame.family}): {_counted(len(front.designs))}")
    console.print()
    for table in ranked_tables(front, count, console.width):
        console.print(table)
        console.print()
    for design in front.designs[:count]:
        console.print(f"#{design.rank}: {why(front, design)}")
    if count < len(front.designs):
        console.print(f"{len(front.designs) - count} more with --all, and in designs.csv")


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
    headers, rows = front.table()
    described = len(headers) - len(front.frame.limit_units)
    derived = [n for n, kind in front.frame.kinds.items() if kind == "derived" and n not in front.frame.objectives]
    places = [1, *range(6, described - len(derived))]  # score, objectives, variables, counts, choices, parts
    columns = [_column(headers[k], [row[k] for row in rows[:count]]) for k in places]
    ranks = _column("rank", [f"#{design.rank}" for design in front.designs[:count]])
    groups: list[list[list[str]]] = []
    room = 0
    for column in columns:
        needed = _width(column) + BETWEEN
        if not groups or needed > room:
            groups.append([ranks])
            room = width - _width(ranks)
        groups[-1].append(column)
        room -= needed
    return [_grid(group) for group in groups]


def _column(name: str, values: Sequence[Any]) -> list[str]:
    """Return heading and cells of a column as text; a long heading is broken after underscores."""
    cells = [significant(x) if isinstance(x, float) else "" if x is None else str(x) for x in values]
    quantity, _, unit = name.partition(" [")
    words = quantity.replace("_", "_ ").split()
    broad = max(len(x) for x in [*words, *cells])
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) <= broad:
            lines[-1] += word
        else:
            lines.append(word)
    if unit and unit != "-]":
        lines.append(f"[{unit}")
    return ["\n".join(lines), *cells]


def _width(column: Sequence[str]) -> int:
    return max(len(line) for text in column for line in text.split("\n"))


def _grid(columns: Sequence[Sequence[str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, header_style="")
    for heading, *cells in columns:
        number = all(_is_number(cell) for cell in cells)
        table.add_column(heading, justify="right" if number else "left", no_wrap=True, vertical="bottom")
    for row in zip(*(column[1:] for column in columns), strict=True):
        table.add_row(*row)
    return table


def _is_number(cell: str) -> bool:
    try:
        float(cell.removeprefix("#") or "0")
    except ValueError:
        return False
    return True


def _counted(designs: int) -> str:
    return "1 design" if designs == 1 else f"{designs} designs"
