"""What the command line shows: descriptions, checks, explanations and progress, as text of at most one screen width."""

from __future__ import annotations

import io
import math
import os
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import IO, TYPE_CHECKING, Any

from rich import box
from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressDisplay
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from synth.folders.files import csv_text
from synth.order.feasibility import most_used
from synth.order.margins import MARGINS
from synth.question.settings import Progress, ProgressState
from synth.results import Design, ParetoFront
from synth.results.least_infeasible import LeastInfeasible
from synth.text.numbers import FULL_DIGITS, number_text, percent, thousands, used_share
from synth.text.plain_text import PlainStream, printable, words, wrapped
from synth.units import from_si, in_words, miss_text, quantity_text, split_header, unit_text

if TYPE_CHECKING:
    import pandas as pd

    from synth.results.verification import Verification
    from synth.studies.infeasibility.explanation import Explanation

NARROWEST = 40  # that a line may be asked to be
ENOUGH = 30  # characters that a column of sentences wants beside others
WIDTH = 100  # where the output goes to a file or a pipe
SOON, LATER = 1.0, 10.0  # seconds between lines of progress where there is no terminal: other stage, same stage
STATISTICS = {  # what the numbers of a search are called
    "nlp_solves": "continuous problems solved",
    "nlp_solves_to_find": "of these until all designs were found",
    "scalar_problems": "searches for one best design",
    "outer_trials": "combinations drawn at random",
}
SIGNS = {"at_most": "<=", "at_least": ">=", "equal": "="}


class PlainConsole(Console):
    """A console that acts on the terminal by itself alone, never by what it is given to show."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterator[Segment]:
        """Text with characters that act on a terminal written out."""
        for segment in super().render(renderable, options):
            yield segment if segment.control else Segment(printable(segment.text), segment.style)


def output() -> Console:
    """Return the console on standard output; text is shown as it is, brackets mean nothing."""
    return console_on(sys.stdout)


def console_on(stream: IO[str] | PlainStream, width: int | None = None) -> Console:
    """Return a console that shows text as it is; where no terminal is, lines end at a fixed width."""
    if width is None and not stream.isatty():
        width = _asked_width()
    if isinstance(stream, PlainStream):
        stream = stream.stream  # colours are the console's own
    return PlainConsole(file=stream, width=width, markup=False, highlight=False, emoji=False)


def _asked_width() -> int:
    """Width of lines where no terminal states it: as in COLUMNS, which may be set to anything."""
    asked = os.environ.get("COLUMNS", "")
    return max(int(asked), NARROWEST) if asked.isascii() and asked.isdigit() else WIDTH


class PlainTable(Table):
    """A table whose column of sentences stands below each row where the screen leaves it too little room."""

    wide: int | None = None  # the column of sentences

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Render it as columns, or with the sentences below."""
        lines = self._stacked(console, options)
        if lines is None:
            yield from super().__rich_console__(console, options)
            return
        for line in lines:
            yield from line
            yield Segment.line()

    def _stacked(self, console: Console, options: ConsoleOptions) -> list[list[Segment]] | None:
        """Return the lines with the sentences below the rows; nothing where the columns have room beside each other."""
        if not self.wide:
            return None
        columns = [[cell_len(str(cell)) for cell in (x.header, *x.cells)] for x in self.columns]
        others = [column for k, column in enumerate(columns) if k != self.wide]
        taken = sum(map(max, others)) + 3 * (len(others) - 1)
        room, texts = options.max_width - taken - 3, [str(cell) for cell in self.columns[self.wide].cells]
        if room >= min(ENOUGH, max(columns[self.wide])) or taken > options.max_width:
            return None
        bare = Table(box=self.box, pad_edge=False, show_edge=False, header_style="")
        for k, column in enumerate(self.columns):
            if k != self.wide:
                bare.add_column(column.header, justify=column.justify, no_wrap=True)
        for row in zip(*(x.cells for k, x in enumerate(self.columns) if k != self.wide), strict=True):
            bare.add_row(*row)
        heading, rule, *rows = console.render_lines(bare, options, pad=False)
        lines = [heading, [Segment(f"    {self.columns[self.wide].header}")], rule]
        for shown, text in zip(rows, texts, strict=True):
            lines.append(shown)
            lines += [[Segment(line)] for line in wrapped(text, options.max_width, 4, 4)]
        return lines


def plain_table(*headings: str, right: Sequence[int] = (), wide: int | None = None) -> Table:
    """Return a table with one rule under its headings; column ``wide`` takes what room there is, and wraps."""
    table = PlainTable(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, header_style="")
    table.wide = wide
    for k, heading in enumerate(headings):
        table.add_column(
            heading,
            justify="right" if k in right else "left",
            no_wrap=k != wide,
            overflow="fold",
            ratio=1 if k == wide else None,
        )
    return table


def named_file(name: str, kept: bool) -> str:
    """Name of a file that has more than the screen, with what would write it where it is not kept."""
    return name if kept else f"{name} with -o DIR"


def in_common(made: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Parts and counts that several designs share; empty for a single design."""
    return {n: text for n, text in made[0].items() if all(x.get(n) == text for x in made)} if len(made) > 1 else {}


def made_of(made: Mapping[str, str]) -> str:
    """Return in words what a design is made of."""
    return ", ".join(f"{words(name)} {text}" for name, text in made.items())


# ---- explain --------------------------------------------------------------------------------------------------------


def print_explanation(found: Explanation, title: str, console: Console) -> None:
    """Print why nothing is feasible, and every way out with the smallest change first."""
    names = found.names

    def tell(sentence: str, indent: int = 0) -> None:
        print_wrapped(console, in_words(sentence, names), indent)

    tell(f"{title}: {found.message}")
    for guard in found.fired:
        console.print()
        tell(f"Refused: {guard.name}: expected {guard.message}")
        for name, value in guard.lifted_by.items():
            tell(f"not refused with {name} {value}", 2)
    titles = {
        "requirement": "One requirement alone",
        "limit": "One limit alone",
        "fix": "One pin alone",
        "choice": "Another choice",
        "joint": "All that was asked together",
        "physics": "All limits together",
        "part": "Another part",
    }
    for kind, heading in titles.items():
        ways = [way for way in found.ways if way.kind == kind]
        if not ways:
            continue
        console.print(f"\n{heading}")
        for way in ways:
            tell(way.sentence + ("" if way.proven else " (less may do: not proven)"), 2)
    if found.conflict and not found.minimal:
        console.print("\nFewer limits may exclude each other as well: not proven to be minimal.")
    for sentence in found.not_settled:
        tell(f"not settled: {sentence}")


def print_wrapped(console: Console, text: str, indent: int = 0) -> None:
    """Print a text on lines no wider than the screen, the later ones indented."""
    for line in wrapped(text, console.width, indent, indent + 4):
        console.print(line, soft_wrap=True)


# ---- describe -------------------------------------------------------------------------------------------------------

TITLES = {
    "option": "Options (fixed before the search)",
    "requirement": "Requirements",
    "variable": "Variables (found by the search)",
    "count": "Counts (found by the search)",
    "choice": "Choices (found by the search)",
    "slot": "Parts (found by the search)",
    "column": "Columns of the parts that are used, and what is plausible in their tables",
    "derived": "Derived quantities",
    "step": "Quantities on the way to others (in front.json, for curves)",
    "limit": "Limits",
    "objective": "Objectives",
    "setting": "Settings of the simulation (simulate --set)",
    "point": "Operating point (check --at)",
    "refusal": "Refused input",
    "advice": "Remarks",
    "next_row": "Rows of tables named with a design",
}


CLOSE_CALL = 6  # digits of a limit that is violated, perhaps by little
NEAREST = 3  # limits that are named as those with the least room
CODED = ("refusal", "advice", "next_row")  # kinds of which only a code or name and a text are shown


def print_description(description: Sequence[Mapping[Any, Any]], console: Console) -> None:
    """Print the rows of ``describe``, kind by kind; requirements group by group."""
    for kind, title, rows in _sections(description):
        console.print(f"\n{title}")
        if kind in CODED:
            shown = plain_table("name" if kind == "next_row" else "code", "meaning", wide=1)
            for row in rows:
                shown.add_row(row["name"], _meaning(row))
        else:
            shown = plain_table("name", "unit", "value", "meaning", wide=3)
            for row in rows:
                short = str(row["symbol"]).rsplit(".", 1)[-1]  # the slot stands in the name already
                symbol = f" ({short})" if short not in ("", str(row["name"]).rsplit(".", 1)[-1]) else ""
                shown.add_row(f"{row['name']}{symbol}", row["unit"], _range(row), _meaning(row))
        console.print(shown)


def _sections(description: Sequence[Mapping[Any, Any]]) -> Iterator[tuple[str, str, list[Mapping[Any, Any]]]]:
    """Yield kind, title and rows of what is listed under one title; groups stand in the order of their first rows."""
    for kind, title in TITLES.items():
        rows = [row for row in description if row["kind"] == kind]
        if kind != "requirement":
            if rows:
                yield kind, title, rows
            continue
        for group in dict.fromkeys(row["group"] for row in rows):
            named = f"{title}: {group}" if group else title
            yield kind, named, [row for row in rows if row["group"] == group]


def _range(row: Mapping[Any, Any]) -> str:
    kind, default = row["kind"], row["default"]
    if kind in ("limit", "objective"):
        return f"{row['sense'].replace('_', ' ')}{' (default)' if default == 'yes' else ''}"
    if kind in ("setting", "point", "option", "derived", "step", "slot", "choice"):
        return "optional" if row["optional"] else (str(default) if default is not None else "")
    low, high = row["lower"], row["upper"]
    bounds = [number_text(x, FULL_DIGITS) for x in (low, high) if not math.isnan(x)]
    if len(bounds) == 2:
        span = " .. ".join(bounds)
    else:
        span = f">= {bounds[0]}" if bounds and not math.isnan(low) else f"<= {bounds[0]}" if bounds else ""
    if kind == "column":
        return f"optional  {span}".rstrip() if row["optional"] else span
    if kind != "requirement":
        return span
    if row["optional"]:
        return f"optional  {span}"
    if default is None:
        return f"needed  {span}"
    return f"{number_text(default, FULL_DIGITS)}  {span}" if isinstance(default, float) else f"(see right)  {span}"


def _meaning(row: Mapping[Any, Any]) -> str:
    text = str(row["text"])
    if row["choices"]:
        text = f"{text}: {row['choices']}" if text else str(row["choices"])
    if row["kind"] == "requirement" and isinstance(row["default"], str):
        text = f"{text}; default {row['default']} (SI)"
    if row["source"] and row["kind"] in ("derived", "step", "limit"):
        text = f"{text} [{row['source']}]"
    if row["classification"] and row["kind"] in ("limit", "objective"):
        text = f"{text}\n" * bool(text) + f"class: {row['classification']}"
    return text


# ---- check ----------------------------------------------------------------------------------------------------------


def print_check(design: Design, details: Sequence[Mapping[Any, Any]], console: Console) -> None:
    """Print every quantity and every limit of one design.

    Parameters
    ----------
    design : Design
    details : sequence of mapping
        The rows of ``describe``, for symbols and meanings.
    console : rich.console.Console
    """
    frame = design.frame
    known = {row["name"]: row for row in details if row["kind"] not in ("limit", "objective", "point", *CODED)}
    console.print(f"{frame.title} ({frame.family})")
    if frame.options:
        print_wrapped(console, "options: " + ", ".join(f"{words(n)} {v}" for n, v in frame.options.items()))
    states = _limit_states(design)
    tables = {
        "Requirements": _requirements(design, known),
        "Parts": _parts(design),
        "Quantities": _quantities(design, known),
        "Limits": _limits(design, states),
    }
    for heading, table in tables.items():
        console.print(f"\n{heading}")
        console.print(table)
    for remark in _remarks(design):
        print_wrapped(console, remark)
    console.print()
    if design.violated:
        print_wrapped(console, f"violated: {', '.join(map(words, design.violated))}")
        return
    used = most_used(design.utilisation)[:NEAREST]
    if used:
        nearest = ", ".join(f"{words(name)} ({used_share(design.utilisation[name] or 0.0)} used)" for name in used)
        print_wrapped(console, f"nearest to their limits: {nearest}")
    console.print(f"all {sum(s == 'ok' for s in states.values())} limits that apply hold")


def _requirements(design: Design, known: Mapping[str, Mapping[Any, Any]]) -> Table:
    table = plain_table("name", "symbol", "value", "", "meaning", right=(2,), wide=4)
    for name, si in design.frame.requirement_values.items():
        row = known[name]
        stated = "" if name in design.frame.requirements else "default"
        table.add_row(words(name), row["symbol"], quantity_text(si, row["unit"]), stated, row["text"])
    return table


def _parts(design: Design) -> Table:
    table = plain_table("slot", "designation", "table", "source", wide=3)
    for slot, part in design.parts.items():
        table.add_row(words(slot), str(part), str(part["table"]), str(part.get("source") or ""))
    return table


def _quantities(design: Design, known: Mapping[str, Mapping[Any, Any]]) -> Table:
    table = plain_table("name", "symbol", "value", "meaning", right=(2,), wide=3)
    for name, label in design.choices.items():
        table.add_row(words(name), known[name]["symbol"], words(label), known[name]["text"])
    for name, si in design.values.items():
        shown = quantity_text(si, design.frame.units[name]) if math.isfinite(si) else "does not exist"
        table.add_row(words(name), known[name]["symbol"], shown, known[name]["text"])
    return table


def _limits(design: Design, states: Mapping[str, str]) -> Table:
    table = plain_table("name", "value", "", "limit", "used", "", right=(1, 3, 4), wide=0)
    for name, state in states.items():
        value, limit = (_limit_side(design, name, side) for side in (0, 1))
        used = design.utilisation.get(name)
        shown_use = "" if used is None else used_share(used)
        style = "bold red" if state == "VIOLATED" else ""
        table.add_row(words(name), value, SIGNS[design.frame.limit_senses[name]], limit, shown_use, Text(state, style))
    return table


def _remarks(design: Design) -> list[str]:
    """Further remarks on a design."""
    not_asked = ", ".join(map(words, design.frame.not_asked))
    return [
        *(in_words(remark, design.names) for remark in design.not_checked),
        *([f"not asked, so their limits are not built: {not_asked}"] if not_asked else []),
        *(f"off the grid: {words(name)}, {remark}" for name, remark in design.off_grid.items()),
        *(f"outside the range that is searched: {words(name)} {remark}" for name, remark in design.outside.items()),
        *(f"next in the tables: {words(name)} {row}" for name, row in design.next_rows.items()),
        *(f"remark: {remark}" for remark in design.bare_advice),
    ]


def print_state(found: pd.DataFrame, point: str, console: Console) -> None:
    """Print the state of a design at an operating point: a column per course that leads there."""
    from synth.analysis.operating_state import state_rows  # most checks ask for none

    head, *rows = state_rows(found)
    console.print(f"\nState at {point}")
    table = plain_table(*head, right=range(1, len(head)))
    for row in rows:
        table.add_row(*row)
    console.print(table)


def _limit_side(design: Design, name: str, side: int) -> str:
    si = design.limits[name][side]
    digits = CLOSE_CALL if name in design.violated else 4
    return quantity_text(si, design.frame.limit_units[name], digits)


def _limit_states(design: Design) -> dict[str, str]:
    """State of each limit: ok, VIOLATED, not checked (no column), or not defined (a guard fails)."""
    unchecked = {remark.removeprefix("not checked: ").split(",")[0] for remark in design.not_checked}
    states = {}
    for name in design.frame.limit_units:
        if name in design.violated:
            states[name] = "VIOLATED"
        elif name in unchecked:
            states[name] = "not checked"
        else:
            states[name] = "ok" if design.utilisation.get(name) is not None else "not defined"
    return states


def print_simulation(
    design: Design, frames: Mapping[str, pd.DataFrame], opinion: pd.DataFrame, console: Console
) -> None:
    """Print what simulations show: their titles and events, and the second opinion beside the closed forms."""
    for frame in frames.values():
        console.print(frame.attrs["title"])
        unit = split_header(str(frame.attrs.get("x", frame.columns[0])))[1] or ""
        marks = [mark for mark in frame.attrs.get("marks", ()) if mark.get("label")]
        events = [f"{mark['label']} {number_text(mark['x'])} {unit}" for mark in marks]
        if events:
            console.print(f"  {', '.join(events)}")
    if len(opinion):
        console.print()
        table = plain_table("quantity", "closed form", "simulation", "difference", "", right=(1, 2, 3, 4))
        for row in opinion.to_dict("records"):
            relative = row["relative_difference"]
            if abs(relative) < MARGINS.same:
                relative = row["difference"] = 0.0  # rounding only
            numbers = [row[key] for key in ("closed_form", "simulation", "difference")]
            unit = unit_text(row["unit"])
            shown = [f"{number_text(x)} {unit}".rstrip() if math.isfinite(x) else "does not exist" for x in numbers]
            table.add_row(words(row["quantity"]), *shown, percent(relative) if math.isfinite(relative) else "")
        console.print(table)
    if design.violated:
        console.print()
        listed = ", ".join(map(words, design.violated))
        print_wrapped(console, f"limits violated: {listed} (clutchsynth check lists them)")
    console.print()


SAMPLED = 5  # points of a curve that a screen shows


def print_curves(frames: Mapping[str, pd.DataFrame], console: Console) -> None:
    """Print curves at a few points each, from the first to the last."""
    for frame in frames.values():
        console.print(frame.attrs["title"])
        last = len(frame) - 1
        shown = frame.iloc[sorted({round(k * last / (SAMPLED - 1)) for k in range(SAMPLED)})] if len(frame) else frame
        along = str(frame.attrs.get("x", frame.columns[0]))
        table = plain_table(column_heading(along), *_curve_cells(shown[along]), right=range(1, len(shown) + 1))
        for column in frame.columns:
            if column != along:
                table.add_row(column_heading(str(column)), *_curve_cells(shown[column]))
        console.print(table)
        console.print()


def column_heading(column: str) -> str:
    """Name and unit of a column of a file as screens write them."""
    name, unit = split_header(column)
    return f"{words(name)} [{unit_text(unit or '-')}]".removesuffix(" []")


def _curve_cells(values: Iterable[Any]) -> list[str]:
    return [number_text(x) if isinstance(x, (int, float)) else str(x) for x in values]


def check_table(design: Design, details: Sequence[Mapping[Any, Any]]) -> str:
    """Return the text of check.csv: every quantity and every limit in full precision."""
    frame = design.frame
    symbols = {row["name"]: row["symbol"] for row in details if row["kind"] not in ("limit", "objective", "point")}
    units = {row["name"]: row["unit"] for row in details if row["kind"] == "requirement"}
    columns = ["kind", "name", "symbol", "unit", "value", "limit", "sense", "utilisation", "state"]
    rows: list[list[str]] = []
    for name, si in frame.requirement_values.items():
        rows.append(["requirement", name, symbols[name], units[name], _plain(si, units[name]), "", "", "", ""])
    for slot, part in design.parts.items():
        rows.append(["part", slot, symbols[slot], "", str(part), "", "", "", ""])
    for name, label in design.choices.items():
        rows.append(["choice", name, symbols[name], "", label, "", "", "", ""])
    for name, si in design.values.items():
        unit = frame.units[name]
        grid = "off the grid" if name in design.off_grid else ""
        grid = "outside the range that is searched" if name in design.outside else grid
        rows.append([frame.kinds[name], name, symbols[name], unit, _plain(si, unit), "", "", "", grid])
    for name, state in _limit_states(design).items():
        unit, (value, limit), used = frame.limit_units[name], design.limits[name], design.utilisation.get(name)
        sense = SIGNS[frame.limit_senses[name]]
        shown = ["" if used is None else repr(used), state]
        rows.append(["limit", name, "", unit, _plain(value, unit), _plain(limit, unit), sense, *shown])
    return csv_text(columns, rows)


def _plain(si: float, unit: str) -> str:
    return repr(float(from_si(si, unit))) if math.isfinite(si) else ""


# ---- run ------------------------------------------------------------------------------------------------------------


def explanation_text(front: ParetoFront, width: int = WIDTH) -> str:
    """Return in words and one table why nothing is feasible, on lines no wider than that."""
    explanation = front.explanation or LeastInfeasible()
    buffer = io.StringIO()
    console = console_on(buffer, width)
    console.print(explanation.headline)
    conflicts = explanation.get("conflicts") or []
    if conflicts:
        table = plain_table("limit", "value", "limit value", "missed by", right=(1, 2, 3), wide=0)
        for row in conflicts:
            sides = row["value"], row["limit_value"]
            shown = [quantity_text(side, row["unit"], FULL_DIGITS) for side in sides]
            table.add_row(row["limit"], *shown, miss_text(*sides, row["unit"]))
        console.print(table)
    nearest = [f"{n} {value}" for n, value in (explanation.get("nearest") or {}).items()]
    nearest += [f"{slot} {designation}" for slot, designation in (explanation.get("parts") or {}).items()]
    if nearest:
        console.print(f"nearest design: {', '.join(nearest)}")
    return buffer.getvalue()


def print_outcome(front: ParetoFront, console: Console, verbose: bool = False) -> None:
    """Print how far the front is proven, and what was left out of the search.

    Parameters
    ----------
    front : ParetoFront
    console : rich.console.Console
    verbose : bool
        Print also what the search did, in numbers.
    """
    console.print()
    if front.interrupted:
        kept = "the designs found so far are shown" if front.designs else "no design was found until then"
        print_wrapped(console, f"stopped: {front.interrupted}; {kept}")
    if front.designs or front.interrupted:
        print_wrapped(console, front.certificate.sentence())
    else:
        print_wrapped(console, front.certificate.of_no_design())
    few = len(front.designs) < len(front.frame.objectives) and not front.complete
    if front.designs and few:
        best = [words(name) for name in front.frame.objectives][: len(front.designs)]
        print_wrapped(console, f"fewer designs than objectives: what is best in {' and '.join(best)} alone is listed")
    if front.complete and front.designs and len(front.frame.objectives) > 1:
        print_wrapped(
            console, "the front is complete: beyond that gap there is no other design that none beats in everything"
        )
    left_out = front.statistics.get("rows_left_out", ())
    if verbose:
        for line in statistics_lines(front.statistics.to_json()):
            print_wrapped(console, line)
    elif left_out:
        slots = Counter(row["slot"] for row in left_out)
        rows = ", ".join(f"{count} of {slot}" for slot, count in slots.items())
        print_wrapped(console, f"rows left out although they were offered: {rows} (--verbose tells why)")


def print_verification(verification: Verification, console: Console) -> None:
    """Print what checking a front again has shown: every finding and what stays open, then the outcome."""
    for sentence in (*verification.findings, *verification.open):
        print_wrapped(console, f"- {sentence}")
    print_wrapped(console, verification.sentence())


def statistics_lines(statistics: Mapping[str, object]) -> list[str]:
    """Return the statistics of a search as lines: plain numbers on one, everything else on its own.

    Examples
    --------
    >>> statistics_lines({"combinations": 12000, "nlp_solves": 31, "seconds": {"trace": 0.5, "tree": 1.25}})
    ['combinations 12 000, continuous problems solved 31', 'seconds: trace 0.5, tree 1.25']
    """
    plain, lines = [], []
    for key, value in statistics.items():
        name = STATISTICS.get(key, words(key))
        if isinstance(value, Mapping):
            if value:
                lines.append(f"{name}: " + ", ".join(f"{k} {_brief(v)}" for k, v in value.items()))
        elif isinstance(value, (list, tuple)):
            lines += _left_out(name, value)
        else:
            plain.append(f"{name} {_brief(value)}")
    return ([", ".join(plain)] if plain else []) + lines


def _left_out(name: str, entries: Sequence[Any]) -> list[str]:
    """Group rows left out by slot and reason, so that a thousand rows make one line."""
    groups: dict[tuple[str, str], list[str]] = {}
    bare = [str(entry) for entry in entries if not isinstance(entry, Mapping)]
    for entry in entries:
        if isinstance(entry, Mapping):
            groups.setdefault((entry["slot"], entry["reason"]), []).append(entry["designation"])
    lines = [f"{name}: {', '.join(bare)}"] if bare else []
    for (slot, reason), members in groups.items():
        shown = ", ".join(members[:3]) + (f" and {len(members) - 3} more" if len(members) > 3 else "")
        lines.append(f"{name}: {slot} {shown} ({reason})")
    return lines


def _brief(value: object) -> str:
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: "-"}[value]
    if isinstance(value, int):
        return thousands(value)
    return number_text(value, 3) if isinstance(value, float) else str(value)


@contextmanager
def progress_display(quiet: bool) -> Iterator[Progress | None]:
    """Give a callable that shows the progress of a search on standard error.

    A bar on a terminal, a line now and then elsewhere, nothing where ``quiet``.
    """
    if quiet:
        yield None
    elif not sys.stderr.isatty():
        yield _occasional_lines()
    else:
        console = console_on(sys.stderr)
        columns = (TextColumn("{task.description}"), BarColumn(20), TaskProgressColumn(), TimeElapsedColumn())
        with ProgressDisplay(*columns, TextColumn("{task.fields[figures]}"), console=console, transient=True) as bar:
            task = bar.add_task("starting", total=1.0, figures="")

            def show(state: ProgressState) -> None:
                done = float(state.get("done") or 0.0)
                bar.update(task, completed=done, description=str(state.get("stage", "")), figures=_figures(state))

            yield show


def _occasional_lines() -> Progress:
    """Write a line when a stage begins and now and then within it, but none for what is over in a moment."""
    shown_at, shown_stage = time.monotonic(), ""

    def show(state: ProgressState) -> None:
        nonlocal shown_at, shown_stage
        stage = str(state.get("stage", ""))
        if time.monotonic() - shown_at < (SOON if stage != shown_stage else LATER):
            return
        shown_at, shown_stage = time.monotonic(), stage
        done = percent(round(float(state.get("done") or 0.0), 2))
        print(f"{stage}: {done}, {_figures(state)}", file=sys.stderr, flush=True)

    return show


def _figures(state: ProgressState) -> str:
    parts = []
    if state.get("combinations") is not None:
        parts.append(f"{_brief(state['combinations'])} combinations")
    if state.get("incumbents") is not None:
        parts.append(f"{_brief(state['incumbents'])} designs")
    if state.get("message"):
        parts.append(str(state["message"]))
    return ", ".join(parts)
