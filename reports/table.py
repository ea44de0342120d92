"""A front on the terminal: what one decides by as a ranked table, then why the leading designs are there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Sized
from dataclasses import dataclass

from rich import box
from rich.console import Console
from rich.table import Table

from synth.results import Design, ParetoFront
from synth.results.calculation import Calculation
from synth.results.design import lines_of, near_ones, reached_limits
from synth.results.hookspecs import FrontOfFamilies
from synth.results.rating_tables import rating_row
from synth.text.numbers import SHARE_DIGITS, column_texts
from synth.text.plain_text import words, wrapped
from synth.units import finite_from_si, in_unit, unit_text

from .reasons import why
from .sizing import sizing_line

SHOWN = 10  # designs on one screen
EXPLAINED = 3  # designs with a reason for their place, in addition to the best of each objective
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
    shown = lines_of(front.designs, every)[: None if every else SHOWN]
    _print_wrapped(console, f"{front.frame.title}: {_counted(front)}", 0)
    line = "" if calculation is None else sizing_line(calculation, front.designs[0])
    if line:
        _print_wrapped(console, line, 0)
    console.print()
    for table in ranked_tables(shown, console.width):
        console.print(table)
        console.print()
    shared = shared_parts(shown)
    if shared:
        _print_wrapped(console, f"all of these: {', '.join(f'{words(n)} {part}' for n, part in shared.items())}", 0)
        console.print()
    for design in shown:
        if design.rank is not None and (design.rank <= EXPLAINED or design.note or every):
            _print_reason(front, design, console)
        _print_near(design, front.designs, console, every)
    if len(shown) < len(front.designs):
        console.print(f"{len(front.designs) - len(shown)} more with --all, and in designs.csv")


def _print_near(design: Design, designs: Sequence[Design], console: Console, every: bool) -> None:
    """Print which designs stand on the line of one."""
    near = "" if every else near_ones(design.rank, ((d.rank, d.group) for d in designs))
    if near:
        _print_wrapped(console, f"#{design.rank}: {near}", 0)


def _counted(front: ParetoFront) -> str:
    number = _number(front.designs, "design", "designs")
    if len(front.designs) == 1 or len(front.frame.objectives) == 1:
        return number
    return f"{number}; #1 comes nearest to the best {_listed(map(words, front.frame.objectives))}"


def _listed(names: Iterable[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _print_reason(front: ParetoFront, design: Design, console: Console) -> None:
    """Print why a design is on the front; of the first one also its other sizes, and what there is to remark."""
    _print_wrapped(console, f"#{design.rank}: {why(front, design, limits=False)}", 0)
    if design is not front.designs[0]:
        return
    sizes = _other_sizes(design)
    if sizes:
        _print_wrapped(console, f"other sizes: {sizes}", 4)
    for name, row in design.next_rows.items():
        _print_wrapped(console, f"next in the tables: {words(name)} {row}", 4)
    for remark in design.bare_advice:
        _print_wrapped(console, f"remark: {remark}", 4)
    for remark in design.not_checked:
        _print_wrapped(console, remark, 4)


def _print_wrapped(console: Console, text: str, indent: int) -> None:
    """Print a text on lines no wider than the screen, the later ones indented."""
    for line in wrapped(text, console.width, indent, indent + 4):
        console.print(line, soft_wrap=True)


def _other_sizes(design: Design) -> str:
    """Variables and counts of a design that have no column."""
    frame = design.frame
    shown = _quantities(frame.headline, frame.objectives)
    return ", ".join(
        f"{words(name)} {in_unit(design.values[name], frame.units[name])} {unit_text(frame.units[name])}".rstrip()
        for name, kind in frame.kinds.items()
        if kind in ("variable", "count") and name not in shown
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


def ranked_tables(shown: Sequence[Design], width: int) -> list[Table]:
    """Return designs of a front as tables that are no wider than ``width`` characters; each begins with the rank."""
    frame = shown[0].frame
    names = _quantities(frame.headline, frame.objectives)
    if not frame.headline:
        names += [n for n, kind in frame.kinds.items() if kind in ("variable", "count") and n not in names]
    columns = _number_columns(shown, names, len(frame.objectives))
    shared = shared_parts(shown)
    columns += [_column(words(n), "", cells) for n, cells in _parts(shown).items() if n not in shared]
    return _side_by_side(shown, columns, width)


def _parts(shown: Sequence[Design]) -> dict[str, list[str]]:
    """Return choices and parts by name, design by design."""
    first = shown[0]
    choices = {n: [words(d.choices[n]) for d in shown] for n in first.choices}
    return choices | {slot: [str(d.parts[slot]) for d in shown] for slot in first.parts}


def shared_parts(shown: Sequence[Design]) -> dict[str, str]:
    """Parts and counts that several designs share, by name of the choice or slot."""
    return {n: cells[0] for n, cells in _parts(shown).items() if len(shown) > 1 and len(set(cells)) == 1}


def _number_columns(shown: Sequence[Design], names: Sequence[str], objectives: int) -> list[_Column]:
    """Return quantities as columns, behind the objectives the reserve of torque."""
    units = shown[0].frame.units
    columns = [
        _column(
            words(n), unit_text(units[n]), column_texts([finite_from_si(d.values[n], units[n], None) for d in shown])
        )
        for n in names
    ]
    if any(d.frame.sized_by for d in shown):
        columns.insert(
            objectives, _column("torque reserve", "%", column_texts([_reserve(d) for d in shown], SHARE_DIGITS))
        )
    return columns


def _side_by_side(shown: Sequence[Design], columns: Iterable[_Column], width: int) -> list[Table]:
    """Return columns as tables no wider than a screen, each begun with the rank; last what limits each design."""
    ranks = _column("rank", "", [f"#{design.rank}" for design in shown])
    groups: list[list[_Column]] = [[ranks]]
    remaining = width - ranks.width
    for column in columns:
        if column.width + BETWEEN > remaining and len(groups[-1]) > 1:
            groups.append([ranks])
            remaining = width - ranks.width
        groups[-1].append(column)
        remaining -= column.width + BETWEEN
    limits = [", ".join(map(words, reached_limits(d))) or "no limit" for d in shown]
    if remaining - BETWEEN < min(NARROWEST, max(map(len, limits))):
        groups.append([ranks])
        remaining = width - ranks.width
    cells = ["\n".join(wrapped(text, remaining - BETWEEN)) for text in limits]
    groups[-1].append(_column("limited by", "", cells))
    return [_grid(group) for group in groups]


def print_common_front(front: FrontOfFamilies, console: Console, every: bool = False) -> None:
    """Print the common front of several families by what one decides by, as far as all of them have it.

    Parameters
    ----------
    front : FrontOfFamilies
        With designs.
    console, every
        As for :func:`print_front`.
    """
    lines = [k for k, d in enumerate(front.designs) if every or d.group is None][: None if every else SHOWN]
    shown = [front.designs[k] for k in lines]
    families = dict.fromkeys(front.families)
    designs, kinds = _number(front.designs, "design", "designs"), _number(families, "family", "families")
    first = f"; #1 comes nearest to the best {_listed(map(words, front.objectives))}" if len(front.designs) > 1 else ""
    _print_wrapped(console, f"{designs} of {kinds}{first}", 0)
    console.print()
    one_each = [next(d for d, name in zip(front.designs, front.families, strict=True) if name == f) for f in families]
    names = _quantities(_shared_headline(one_each), front.objectives)
    columns = _number_columns(shown, names, len(front.objectives))
    columns.insert(0, _column("family", "", [front.families[k] for k in lines]))
    if any(d.robust for d in front.designs):
        columns.append(_column("robust", "", [rating_row(d)[0] or "not rated" for d in shown]))
    for table in _side_by_side(shown, columns, console.width):
        console.print(table)
        console.print()
    for design in shown:
        if design.note:
            _print_wrapped(console, f"#{design.rank}: {words(design.note)}", 0)
        _print_near(design, front.designs, console, every)
    if len(shown) < len(front.designs):
        console.print(f"{len(front.designs) - len(shown)} more with --all, and in designs.csv")


def _number(things: Sized, one: str, more: str) -> str:
    return f"1 {one}" if len(things) == 1 else f"{len(things)} {more}"


def _shared_headline(designs: Sequence[Design]) -> list[str]:
    """Objectives of some family that all of them have, measured alike."""
    units = [d.frame.units for d in designs]
    shown = dict.fromkeys(name for d in designs for name in d.frame.headline)
    return [n for n in shown if all(n in its for its in units) and len({its[n] for its in units}) == 1]


def _reserve(design: Design) -> float | None:
    """Return by how many per cent a design carries more than it is sized for."""
    carried, needed = design.limits.get(design.frame.sized_by, (0.0, 0.0))
    return round(100 * (carried / needed - 1), 1) + 0.0 if needed else None


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
