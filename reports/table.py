"""A front as a ranked table on the terminal, and for each design why it is there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from synth.results import Design, ParetoFront

SHOWN = 10  # designs on one screen
BINDING = 0.999  # a limit used more than this decides something
BETWEEN = 3  # blanks between two columns
EQUAL = 1e-9  # relative; objectives closer than this are the same


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


def significant(value: float, digits: int = 5) -> str:
    """Write a number with so many significant digits and without an exponent where people would not use one.

    Examples
    --------
    >>> significant(13394.966), significant(1234567.0), significant(0.25), significant(math.nan)
    ('13395', '1234567', '0.25', '')
    """
    if math.isnan(value):
        return ""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e" in text and 1 <= abs(value) < 1e12 else text


def why(front: ParetoFront, design: Design) -> str:
    """Return in one sentence why a design is on the front: what it is best in, what it trades, which limits it meets.

    Parameters
    ----------
    front : ParetoFront
        The front it belongs to.
    design : Design
        One of its designs.
    """
    objectives = front.frame.objectives
    clauses = [
        f"{'smallest' if sense == 'min' else 'largest'} {name}"
        for name, sense in objectives.items()
        if _is_best(front, design, name, sense)
    ]
    if "knee" in design.note:
        clauses.insert(0, "knee of the front")
    others = [d for d in front.designs if d is not design]
    if len(objectives) == 2 and others:
        clauses.append(_between(front, design))
    elif len(objectives) > 2 and others:
        nearest = min(others, key=lambda d: _distance(front, design, d))
        clauses.append(f"against #{nearest.rank} next to it {_comparison(design, nearest, list(objectives))}")
    binding = [
        name
        for name, used in design.utilisation.items()
        if used is not None and used >= BINDING and front.frame.limit_senses[name] != "equal"
    ]
    clauses.append(f"at the limit of {', '.join(binding)}" if binding else "no limit is reached")
    if design.alternatives:
        clauses.append(f"{len(design.alternatives)} others with the same objectives")
    return "; ".join(clause for clause in clauses if clause)


def _is_best(front: ParetoFront, design: Design, name: str, sense: str) -> bool:
    values = [d.objectives[name] for d in front.designs]
    best = min(values) if sense == "min" else max(values)
    return abs(design.objectives[name] - best) <= EQUAL * max(abs(best), 1e-300)


def _between(front: ParetoFront, design: Design) -> str:
    """Return what a design of a front of two objectives gains over each of its two neighbours."""
    first, second = front.frame.objectives
    line = sorted(front.designs, key=lambda d: d.objectives[first])
    place = next(k for k, d in enumerate(line) if d is design)
    sides = [line[k] for k in (place - 1, place + 1) if 0 <= k < len(line)]
    if len(sides) == 2:
        # The neighbour that is better in the first objective is worse in the second: name what is gained.
        lower, upper = sides
        toward = (second, first) if front.frame.objectives[first] == "min" else (first, second)
        gains = [_comparison(design, other, [name]) for other, name in zip((lower, upper), toward, strict=True)]
        return f"between #{lower.rank} and #{upper.rank}: {gains[0]} than #{lower.rank}, {gains[1]} than #{upper.rank}"
    return f"{_comparison(design, sides[0], [first, second])} than #{sides[0].rank} next to it"


def _comparison(design: Design, other: Design, names: Sequence[str]) -> str:
    parts = []
    for name in names:
        mine, theirs = design.objectives[name], other.objectives[name]
        difference = mine - theirs
        if abs(difference) <= EQUAL * max(abs(mine), abs(theirs)):
            parts.append(f"the same {name}")
            continue
        size = f"{significant(100 * abs(difference / theirs), 2)} % " if theirs else ""
        parts.append(f"{size}{'more' if difference > 0 else 'less'} {name}")
    return " and ".join(parts) if len(parts) < 3 else ", ".join(parts)


def _distance(front: ParetoFront, design: Design, other: Design) -> float:
    """Return the distance of two designs, every objective measured by its range on the front."""
    total = 0.0
    for name in front.frame.objectives:
        values = [d.objectives[name] for d in front.designs]
        span = max(values) - min(values)
        if span > 0:
            total += ((design.objectives[name] - other.objectives[name]) / span) ** 2
    return total


def _counted(designs: int) -> str:
    return "1 design" if designs == 1 else f"{designs} designs"
