"""The report of a batch: rows by state, all of them to look through, one in full, failures with their reasons."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any

from synth.results.batch_record import FAILURES, IN_WORDS, STATES, WITH_DESIGNS, BatchRecord, BatchRow, RowInFull
from synth.results.report_request import About
from synth.text.numbers import gap_text, page_text, percent, thousands
from synth.text.plain_text import counted, printable, words

from .drawing.files import svg_of
from .front_report import FrontReportRequest, first_design
from .sheet.blocks import (
    Block,
    Bullets,
    Cell,
    Code,
    Column,
    Document,
    Heading,
    Link,
    Paragraph,
    RowsBlock,
    State,
    TableBlock,
    TableRow,
    inline,
)
from .sheet.design_sheet import front_state

AT_WORK = {
    "open": "it waits to be worked at",
    "running": "it is being worked at",
    "cancelled": "it was cancelled",
    "stopped": "it was stopped",
    "failed": "it has failed",
}
NAMES = 2  # columns by which rows are called
SHOWN_CELLS = 5  # columns of the uploaded table, next to each other
LISTED_FAILURES = 200  # rows without a design that are listed one by one
LISTED_CAUSES = 30
LONGEST = 600  # letters of a cell or a reason
LONGEST_IN_LINE = 240  # where many rows stand below each other
LONGEST_NAME = 80  # of a row
ELSEWHERE = "report.html or rows.csv"


def batch_report(batch: BatchRecord, about: About) -> Document:
    """Return the report of a batch."""
    blocks = [_state(batch), *_leads(batch), *_counted(batch), *_causes(batch), *_all_rows(batch)]
    blocks += [*_size_range(batch), *_failures(batch), *_in_full(batch, about), *_question(batch)]
    return Document(
        kind="Batch report",
        title=about.title or f"{_short(batch.source, LONGEST_NAME)}: {counted(len(batch.rows), 'row')}",
        facts=about.facts(),
        blocks=tuple(blocks),
        program=_program(batch),
        logo=about.logo,
    )


def batch_state(batch: BatchRecord) -> State:
    """Notes that belong at the head of a batch."""
    return _state(batch)


def row_name(batch: BatchRecord, row: BatchRow) -> str:
    """Name of a row in the table, as far as columns are carried along; its line otherwise."""
    named = " · ".join(cell for k in batch.carried[:NAMES] if (cell := row.cells[k].strip()))
    return _short(named, LONGEST_NAME) or f"line {row.line}"


def short_reason(row: BatchRow) -> str:
    """Reason why a row has no design in a few words, where it is given at length elsewhere."""
    if row.status in ("infeasible", "not_found") and row.causes:
        return f"misses {', '.join(map(words, row.causes))}"
    return row.reason


def _short(text: str, most: int = LONGEST) -> str:
    cleaned = printable(" ".join(text.split()))
    return cleaned if len(cleaned) <= most else f"{cleaned[: most - 1].rstrip()}…"


def _program(batch: BatchRecord) -> str:
    return f"clutchsynth {batch.versions.get('clutchsynth', '')}".strip()


def _state(batch: BatchRecord) -> State:
    counts, rows = batch.counts, len(batch.rows)
    every = counted(rows, "row")
    text = (", ".join(f"{thousands(count)} {IN_WORDS[status]}" for status, count in counts.items()) + ".",)
    good = sum(counts.get(status, 0) for status in WITH_DESIGNS)
    have = "has designs" if good == 1 else "have designs"
    if not batch.finished:
        done = f"NOT FINISHED: {thousands(batch.answered)} of {every} are answered"
        return State("open", f"{done}; {AT_WORK.get(batch.state, batch.state)}", text)
    if not good:
        return State("bad", f"NO DESIGN: none of {every} has one", text)
    if counts.get("failed"):
        return State("bad", f"{counted(counts['failed'], 'row')} FAILED; {thousands(good)} of {every} {have}", text)
    if good < rows:
        return State("open", f"{thousands(good)} of {every} {have}, {thousands(rows - good)} NOT", text)
    if counts.get("feasible"):
        return State("open", f"{'The row' if rows == 1 else 'All rows'} {have}, not all PROVEN", text)
    gap = gap_text(float(batch.settings.get("gap") or 0))
    return State("good", f"{'The row has' if rows == 1 else 'All rows have'} designs, proven to {gap}", text)


def _leads(batch: BatchRecord) -> list[Block]:
    """Places of the sections that somebody looks for in a long file."""
    links: list[Cell] = []
    if batch.chosen is not None:
        links.append(inline("In full: ", Link(row_name(batch, batch.chosen.row), "#row")))
    failed = sum(batch.counts.get(status, 0) for status in FAILURES)
    if failed:
        links.append(Link(f"{counted(failed, 'row')} without a design, and why", "#failures"))
    if batch.size_range:
        links.append(Link("Size range", "#size-range"))
    return [Bullets(tuple(links))] if links else []


def _counted(batch: BatchRecord) -> list[Block]:
    total = len(batch.rows)
    rows = [
        TableRow((STATES.get(status, status), thousands(count), percent(count / total)))
        for status, count in batch.counts.items()
    ]
    blocks: list[Block] = [
        Heading("Rows by state", anchor="states"),
        TableBlock.of("What became of the rows", COUNT_COLUMNS, rows),
    ]
    spread = []
    for k, heading in enumerate(batch.objectives):
        values = sorted(x for row in batch.rows if (x := row.objectives[k]) is not None)
        if values:
            ends = (values[0], statistics.median(values), values[-1])
            spread.append(TableRow((_heading(heading), thousands(len(values)), *(page_text(value) for value in ends))))
    if spread:
        blocks.append(TableBlock.of("The best design of each row", SPREAD_COLUMNS, spread))
    return blocks


def _causes(batch: BatchRecord) -> list[Block]:
    """Reasons why rows have no design, counted."""
    tally = Counter((row.status, cause) for row in batch.rows if row.status in FAILURES for cause in row.causes)
    if not tally:
        return []
    ordered = sorted(tally.items(), key=lambda entry: (-entry[1], entry[0]))
    table = [
        TableRow((inline(_way(status), " ", Code(_short(cause, LONGEST_NAME))), STATES[status], thousands(count)))
        for (status, cause), count in ordered[:LISTED_CAUSES]
    ]
    more = len(ordered) - LISTED_CAUSES
    blocks: list[Block] = [
        Heading("What stands in the way", anchor="causes"),
        TableBlock.of("Limits that the nearest design misses, and columns with faults", CAUSE_COLUMNS, table),
        Paragraph("A row counts wherever it is concerned.", small=True),
    ]
    return blocks + ([Paragraph(f"{thousands(more)} more in fewer rows.", small=True)] if more > 0 else [])


def _way(status: str) -> str:
    return "limit" if status in ("infeasible", "not_found") else "column"


def _heading(text: str) -> str:
    name, bracket, unit = text.partition(" [")
    return words(name) + (f" [{unit}" if bracket and unit != "-]" else "")


def _all_rows(batch: BatchRecord) -> list[Block]:
    names = list(batch.carried[:NAMES])
    others = [*batch.carried[NAMES:], *(k for k in range(len(batch.headings)) if k not in batch.carried)]
    inputs = [k for k in others if batch.headings[k] != "family"][: SHOWN_CELLS - len(names)]
    families = len({row.family for row in batch.rows}) > 1

    def columns_of(places: Sequence[int]) -> list[Column]:
        return [Column(_short(batch.headings[k], LONGEST_NAME)) for k in places]

    columns = [Column("line", number=True, width=0.5), *columns_of(names)]
    kind = len(columns)
    columns += [Column("state"), Column("designs", number=True)]
    columns += [Column(_heading(name), number=True) for name in batch.objectives]
    columns += [*([Column("family")] if families else []), *columns_of(inputs)]
    columns += [Column("best design", width=2), Column("why none, remarks", width=2)]
    rows: list[tuple[str | float | None, ...]] = [
        (
            row.line,
            *(_short(row.cells[k], LONGEST_NAME) for k in names),
            STATES.get(row.status, row.status),
            row.designs,
            *row.objectives,
            *((row.family,) if families else ()),
            *(_short(row.cells[k], LONGEST_NAME) for k in inputs),
            _short(row.best, LONGEST_IN_LINE),
            _short("; ".join(text for text in (short_reason(row), row.remarks) if text), LONGEST_IN_LINE),
        )
        for row in batch.rows
    ]
    caption = "All rows, with the best design of each"
    return [Heading("All rows", anchor="rows"), RowsBlock(caption, tuple(columns), rows, kind, ELSEWHERE)]


def _size_range(batch: BatchRecord) -> list[Block]:
    """Return the variants that serve all rows."""
    size_range = batch.size_range
    if not size_range:
        return []
    chosen: Mapping[str, Any] = size_range["told"]
    count, unit = int(chosen.get("variants") or 0), str(chosen.get("unit") or "-")
    excess = chosen.get("total_excess")
    serve = "variant serves" if count == 1 else "variants serve"
    sentences: list[Cell] = [f"{thousands(count)} {serve} all rows that have designs."]
    if isinstance(excess, (int, float)):
        amount = page_text(float(excess)) + ("" if unit == "-" else f" {unit}")
        over = words(str(chosen.get("objective", "")))
        sentences.append(f"Over each row's own best they exceed the {over} by {amount} in all rows together.")
    proven = "proven" if chosen.get("fewest_proven") else "not proven to be the fewest"
    least = int(chosen.get("fewest") or 0)
    sentences.append(f"At least {least} {'is' if least == 1 else 'are'} needed ({proven}).")
    names = [name for name in size_range["columns"] if any(row.get(name) for row in size_range["rows"])][:RANGE_COLUMNS]
    columns = [Column(_heading(name), number=_is_number(size_range["rows"], name)) for name in names]
    rows = [TableRow(tuple(_range_cell(str(row.get(name, ""))) for name in names)) for row in size_range["rows"]]
    return [
        Heading("Size range", anchor="size-range"),
        Bullets(tuple(sentences)),
        TableBlock.of("Variants", columns, rows),
        Paragraph("All their sizes are in variants.csv; which row each serves, in assignment.csv.", small=True),
    ]


def _range_cell(cell: str) -> str:
    number = _number(cell)
    return _short(cell, LONGEST_NAME) if number is None else page_text(number)


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _is_number(rows: Sequence[Mapping[str, str]], name: str) -> bool:
    return all(_number(cell) is not None for row in rows if (cell := str(row.get(name, ""))))


# ---- one row --------------------------------------------------------------------------------------------------------


def _in_full(batch: BatchRecord, about: About) -> list[Block]:
    chosen = batch.chosen
    if chosen is None:
        return []
    row = chosen.row
    name = row_name(batch, row)
    title = f"Line {row.line}" + ("" if name == f"line {row.line}" else f": {name}")
    blocks: list[Block] = [Heading(title, anchor="row"), _row_state(chosen)]
    cells = [
        TableRow((_short(heading, LONGEST_NAME), _short(cell)))
        for heading, cell in zip(batch.headings, row.cells, strict=True)
        if cell.strip()
    ]
    blocks.append(TableBlock.of("The row as it was brought", CELL_COLUMNS, cells))
    if row.remarks:
        blocks.append(Paragraph(f"{row.remarks[:1].upper()}{_short(row.remarks)[1:]}.", small=True))
    if chosen.front is None or chosen.calculation is None:
        return blocks
    drawings = {}
    if chosen.drawing is not None:
        title = chosen.front.frame.title
        drawings[chosen.front.designs[0].rank or 0] = svg_of(chosen.drawing, title, _program(batch), about)
    inner = first_design(
        FrontReportRequest(front=chosen.front, calculation=chosen.calculation, about=about, drawings=drawings)
    )
    return blocks + [_deeper(block) for block in inner]


def _deeper(block: Block) -> Block:
    """Return a block of a report inside a section of this one."""
    if isinstance(block, Heading):
        return Heading(block.text, block.level + 1, block.anchor)
    return block


def _row_state(chosen: RowInFull) -> State:
    row = chosen.row
    if chosen.front is not None:
        level, head = front_state(chosen.front)
        count = f"{row.designs} designs" if row.designs != 1 else "One design"
        stopped = (f"Stopped: {chosen.front.interrupted}.",) if chosen.front.interrupted else ()
        return State(level, f"{count}: {head[:1].lower()}{head[1:]}", stopped)
    details = tuple(_short(text, 10 * LONGEST) for text in (row.reason, row.best, chosen.note) if text)
    if row.designs:
        return State("open", f"{row.designs} designs, not told in full", details)
    level = "open" if row.status == "not_solved" else "bad"
    return State(level, STATES.get(row.status, row.status).upper(), details)


# ---- what has no design, and what was asked -------------------------------------------------------------------------


def _failures(batch: BatchRecord) -> list[Block]:
    shares = _shares({status: batch.counts[status] for status in FAILURES if batch.counts.get(status)}, LISTED_FAILURES)
    if not shares:
        return []
    groups: list[tuple[str, tuple[TableRow, ...]]] = []
    for status, share in shares.items():
        rows = list(islice((row for row in batch.rows if row.status == status), share))
        listed = tuple(
            TableRow((str(row.line), row_name(batch, row), _short(row.reason) or "no reason is kept")) for row in rows
        )
        first = "" if share == batch.counts[status] else f", the first {share}"
        label = STATES[status][:1].upper() + STATES[status][1:]
        groups.append((f"{label}: {counted(batch.counts[status], 'row')}{first}", listed))
    blocks: list[Block] = [
        Heading("Rows without a design, and why", anchor="failures"),
        TableBlock("Lines of the table that was brought", FAILURE_COLUMNS, tuple(groups)),
    ]
    more = sum(batch.counts[status] for status in shares) - sum(shares.values())
    if more > 0:
        blocks.append(Paragraph(f"{thousands(more)} more: see {ELSEWHERE}."))
    return blocks


def _shares(counts: Mapping[str, int], most: int) -> dict[str, int]:
    """Number of rows listed of each kind: all of rare kinds, and equally many of the others.

    Examples
    --------
    >>> _shares({"failed": 3, "bad_input": 2000, "infeasible": 90}, 200)
    {'failed': 3, 'bad_input': 107, 'infeasible': 90}
    """
    shares: dict[str, int] = {}
    for place, status in enumerate(sorted(counts, key=lambda status: counts[status])):
        shares[status] = min(counts[status], (most - sum(shares.values())) // (len(counts) - place))
    return {status: shares[status] for status in counts}


def _question(batch: BatchRecord) -> list[Block]:
    settings = batch.settings
    gap, sizes = gap_text(float(settings.get("gap") or 0)), "makeable" if settings.get("grid") else "continuous"
    lines: list[Cell] = []
    if settings.get("objectives"):
        goals = settings["objectives"]
        names = [f"{name} ({sense})" for name, sense in goals.items()] if isinstance(goals, Mapping) else goals
        lines.append(f"Objectives: {', '.join(map(str, names))}")
    else:
        lines.append("Objectives: those that each family has by default")
    lines.append(
        f"At most {settings.get('points')} designs per row, gap {gap}, {sizes} sizes, seed {settings.get('seed')}"
    )
    if settings.get("time_limit"):
        lines.append(f"At most {page_text(float(settings['time_limit']))} s per row: results depend on the machine")
    versions = ", ".join(f"{name} {version}" for name, version in batch.versions.items())
    digests: list[Cell] = [inline(f"{name}: ", Code(_short(x, LONGEST_NAME))) for name, x in batch.hashes.items()]
    return [
        Heading("What was asked of all rows", anchor="asked"),
        Bullets(tuple(lines)),
        Heading("To reproduce", anchor="again"),
        Bullets(
            (
                inline(
                    "The table ", Code(_short(batch.source, LONGEST_NAME)), " with ", Code("clutchsynth batch"), "."
                ),
                f"Reported with {versions}.",
                *digests,
            )
        ),
    ]


RANGE_COLUMNS = 9
COUNT_COLUMNS = (Column("state", width=3), Column("rows", number=True), Column("share", number=True))
SPREAD_COLUMNS = (
    Column("objective", width=3),
    Column("rows", number=True),
    Column("least", number=True),
    Column("median", number=True),
    Column("largest", number=True),
)
CAUSE_COLUMNS = (Column("what", width=3), Column("state", width=1.5), Column("rows", number=True))
CELL_COLUMNS = (Column("column", width=1.5), Column("cell", width=3))
FAILURE_COLUMNS = (Column("line", number=True, width=0.6), Column("row", width=1.4), Column("reason", width=5))
