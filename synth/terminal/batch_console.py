"""What the command line shows of batches: what the table means, progress, outcome, and lists of jobs."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

from synth.batches.entries import BatchProgress, BatchState
from synth.batches.outputs import RowOutcome, row_outcomes
from synth.errors import shortened
from synth.results.batch_record import IN_WORDS, STATES, WITH_DESIGNS
from synth.terminal.console import column_heading, console_on, in_common, made_of, output, plain_table, print_wrapped
from synth.terminal.session import say, tell, tell_written
from synth.text.numbers import column_texts, number_text, thousands
from synth.text.plain_text import counted

if TYPE_CHECKING:
    from synth.batches.batch import BatchJob
    from synth.batches.store import Account, Store
    from synth.queue.models import Job

MOST_ROWS = 20  # that are all shown
FIRST = 5  # of many that have no design
NAME, REASON = 24, 160  # characters
EVERY = 5.0  # seconds between lines of progress where there is no terminal


def print_table_remarks(job: BatchJob, continues: bool) -> None:
    """Tell on standard error how the table was understood, and which rows cannot be asked."""
    if continues:
        tell(f"going on with job {job.id}")
    if job.table.sentence():
        tell(f"read as {job.table.sentence().removeprefix(f'{job.table.name}: ')}: {job.table.name}")
    for sentence in job.catalogs.readings():
        name, _, how = sentence.partition(": ")
        tell(f"read as {how}: {name}")
    if job.questioner.carried:
        tell(f"carried along unread: {', '.join(column.title for column in job.questioner.carried)}")
    remarks = job.remarks
    for family, columns in sorted(remarks.unused.items()):
        tell(f"not used by {family}: {', '.join(sorted(columns))}")
    for fault in remarks.faults:
        tell(fault.first.sentence() + _more_lines(fault.others, fault.count - 1))
    if remarks.bad:
        more = "" if remarks.shown == remarks.bad else ", the first are shown"
        tell(f"{counted(remarks.bad, 'row')} cannot be asked{more}; rows.csv lists them all, the others run")


def _more_lines(lines: Sequence[int], count: int) -> str:
    """Other places of a fault: the first of so many lines."""
    if not count:
        return ""
    listed = ", ".join(map(str, lines)) + (", ..." if count > len(lines) else "")
    return f" (also in {'line' if count == 1 else f'{thousands(count)} lines:'} {listed})"


@contextmanager
def batch_display(quiet: bool) -> Iterator[BatchProgress | None]:
    """Give a callable that shows how far a batch is: a bar on a terminal, a line now and then elsewhere."""
    if quiet:
        yield None
    elif not sys.stderr.isatty():
        yield _occasional_lines()
    else:
        columns = (TextColumn("{task.description}"), BarColumn(20), TaskProgressColumn(), TimeElapsedColumn())
        text = TextColumn("{task.fields[figures]}")
        with Progress(*columns, text, console=console_on(sys.stderr), transient=True) as bar:
            task = bar.add_task("rows", total=1.0, figures="")

            def show(state: BatchState) -> None:
                bar.update(task, total=max(state["rows"], 1), completed=state["done"], figures=figures(state))

            yield show


def _occasional_lines() -> BatchProgress:
    shown_at = time.monotonic()

    def show(state: BatchState) -> None:
        nonlocal shown_at
        # What is done is said by what comes next.
        if state["done"] < state["rows"] and time.monotonic() - shown_at >= EVERY:
            shown_at = time.monotonic()
            print(figures(state), file=sys.stderr, flush=True)

    return show


def figures(state: BatchState) -> str:
    """Return progress in words.

    Examples
    --------
    >>> figures({"rows": 10000, "done": 1200, "failed": 1, "infeasible": 30, "bad": 2, "rate": 12.5, "left": 704.0})
    '1200 of 10 000 rows, 12.5 rows/s, 12 min left, 30 infeasible, 2 bad, 1 failed'
    >>> figures({"rows": 400, "done": 0, "found": 180, "failed": 0, "infeasible": 0, "bad": 0, "rate": 0, "left": None})
    '0 of 400 rows, 180 more have designs'
    >>> figures({"rows": 1000000, "done": 12500, "stage": "checked"})
    '12 500 of 1 000 000 rows checked'
    """
    if "stage" in state:
        return f"{thousands(state['done'])} of {thousands(state['rows'])} rows {state['stage']}"
    parts = [f"{thousands(state['done'])} of {thousands(state['rows'])} rows"]
    if state.get("found"):
        parts.append(f"{thousands(state['found'])} more have designs")
    if state["rate"] > 0:
        parts.append(f"{number_text(state['rate'], 3)} rows/s")
    if state["left"]:
        parts.append(f"{_duration(state['left'])} left")
    parts += [f"{thousands(state[key])} {key}" for key in ("infeasible", "bad", "failed") if state[key]]
    return ", ".join(parts)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{round(seconds)} s"
    return f"{round(seconds / 60)} min" if seconds < 6000 else f"{number_text(seconds / 3600, 2)} h"


WITHOUT = frozenset(STATES) - frozenset(WITH_DESIGNS)


def print_summary(
    counts: Mapping[str, int], rows: Sequence[RowOutcome], place: Path, folder: Path, stopped: str
) -> None:
    """Print what a batch has come to, and where it was written."""
    total = sum(counts.values())
    say(f"{counted(total, 'row')}: " + ", ".join(f"{thousands(n)} {IN_WORDS[s]}" for s, n in _sorted(counts)))
    _print_rows(rows, counts)
    if stopped:
        say(f"stopped: {stopped}; what was found is saved, the same command goes on")
    tell_written(place, folder, ["designs.csv", "rows.csv", "batch.json"])


def shown_rows(store: Store, job: str, counts: Mapping[str, int]) -> list[RowOutcome]:
    """Return the rows that a screen shows: all of few, of many the first that have no design."""
    if sum(counts.values()) <= MOST_ROWS:
        return list(row_outcomes(store, job))
    if not any(counts.get(status) for status in WITHOUT):
        return []
    return list(islice((row for row in row_outcomes(store, job) if row.status in WITHOUT), FIRST))


def _print_rows(rows: Sequence[RowOutcome], counts: Mapping[str, int]) -> None:
    """Print a line per row: its name, how it stands, and the leading design or the reason why there is none."""
    if not rows:
        return
    console = output()
    without = sum(counts.get(status, 0) for status in WITHOUT)
    if sum(counts.values()) <= MOST_ROWS:
        console.print()
    elif without > len(rows):
        console.print(f"\nthe first {len(rows)} of {thousands(without)} without a design; rows.csv has them all")
    else:
        console.print("\nwithout a design")
    named = next(iter(rows[0].carried), "")
    objectives = list(dict.fromkeys(heading for row in rows for heading in row.objectives))
    shared = in_common([row.made for row in rows if row.made])
    heads = ["line", *([named] if named else []), "state", *map(column_heading, objectives), "parts of #1, or why not"]
    last = len(heads) - 1
    table = plain_table(*heads, right=(0, *range(last - len(objectives), last)), wide=last)
    numbers = [column_texts([_number(row.objectives.get(heading)) for row in rows]) for heading in objectives]
    for k, row in enumerate(rows):
        name = [shortened(row.carried.get(named, ""), NAME)] if named else []
        own = made_of({n: text for n, text in row.made.items() if n not in shared}) or "as all"
        told = own if row.made else shortened(row.reason, REASON)
        table.add_row(str(row.line), *name, STATES[row.status], *(column[k] for column in numbers), told)
    console.print(table)
    console.print()
    if shared:
        print_wrapped(console, f"#1 of every row: {made_of(shared)}")
        console.print()


def _number(cell: str | None) -> float | None:
    return float(cell) if cell else None


def _sorted(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    return [(status, counts[status]) for status in IN_WORDS if counts.get(status)]


def print_jobs(jobs: Sequence[tuple[Job, Account]]) -> None:
    """Print jobs as a table, the latest first."""
    if not jobs:
        print("no jobs")
        return
    table = plain_table("job", "kind", "state", "rows", "done", "made", "of", "folder", right=(3, 4), wide=7)
    for job, account in sorted(jobs, key=lambda pair: -pair[0].created):
        made = time.strftime("%Y-%m-%d %H:%M", time.localtime(job.created))
        rows = (thousands(account.rows), thousands(account.done)) if job.rows else ("", "")
        table.add_row(job.id, job.kind, job.state, *rows, made, job.title, job.folder)
    output().print(table)


def print_job(job: Job, account: Account, units: tuple[int, int], events: Sequence[tuple[float, str, str]]) -> None:
    """Print everything about a job."""
    print(f"{job.id}: {job.title}, {job.state}")
    if job.error:
        print(f"error: {job.error.get('message', '')}")
    if job.folder:
        print(f"folder: {job.folder}")
    if "settings" in job.content:
        settings = ", ".join(f"{name} {value}" for name, value in job.content["settings"].items() if value is not None)
        print(f"settings: {settings}")
    if job.rows:
        counts = {**account.status, "bad_input": account.bad, "not_solved": account.rows - account.done}
        print(
            f"{counted(account.rows, 'row')}: " + ", ".join(f"{thousands(n)} {IN_WORDS[s]}" for s, n in _sorted(counts))
        )
    print(f"units: {units[0]} open, {units[1]} at work")
    for moment, kind, text in events:
        print(f"{time.strftime('%Y-%m-%d %H:%M:%S', time.localtime(moment))}  {kind}{f': {text}' if text else ''}")
