"""The files of a batch: designs.csv, rows.csv and batch.json, written row by row, and changed together."""

from __future__ import annotations

import hashlib
import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

from synth.batches.entries import Layout
from synth.batches.store import Answered, Store
from synth.folders.csv_style import ENGLISH, CsvStyle
from synth.folders.files import csv_writer, read_json
from synth.folders.output_folder import (
    BATCH,
    BATCH_REPORTS,
    STOPPED,
    Replacement,
    check_kind,
    claimed,
    holds,
    replaced,
    settle,
)
from synth.queue.job_table import DONE
from synth.results.provenance import installed_versions
from synth.text.numbers import typed_number
from synth.text.plain_text import words

TABLES = ("designs.csv", "rows.csv")
BATCH_FORMAT = 1  # of batch.json
RANKING = ("rank", "score", "status", "gap", "note", "alternatives")
GROUPS = ("objectives", "searched", "choices", "parts", "derived", "limits")
BEST = "best design"  # a list of quantities and parts in words
ROW_COLUMNS = (
    "line",
    "row",
    "family",
    "status",
    "designs",
    "seconds",
    "certificate",
    "gap",
    BEST,
    "explanation",
    "remarks",
)
MISSED = re.compile(r"(?:: |; )([^;:]+?) is [^;]+? where ")  # in the explanation of a row, behind "misses"
NAMED_LIMITS = 3  # limits of a row that are named
BRIEF = ("objectives", "searched", "choices", "parts")  # of a design in words
SHORT = 12  # digits of a key that tell rows apart


def write_outputs(store: Store, job: str, folder: Path, csv: CsvStyle = ENGLISH) -> tuple[dict[str, int], Path]:
    """Write what is known of a job, all files or none.

    Parameters
    ----------
    store : Store
    job : str
    folder : Path
    csv : CsvStyle
        How the tables are written.

    Returns
    -------
    dict
        Rows by status; ``bad_input`` and ``not_solved`` are among them.
    Path
        Where it stands: the folder, or one below it where an unfinished job found the result of another one.

    Raises
    ------
    InputError
        The folder cannot be written; then nothing has changed.
    """
    record = store.job(job)
    assert record is not None
    content = record.content
    with claimed(folder, job):
        check_kind(folder, BATCH)
        settle(folder)
        stopped_folder = folder / f"{STOPPED}_{job[:8]}"
        target = folder if record.state == DONE or _job_in(folder) in (None, job) else stopped_folder
        with replaced(target) as new:
            with _styled(new, "designs.csv", csv) as file:
                _write_designs(file, store, job, content)
            with _styled(new, "rows.csv", csv) as file:
                counts = _write_rows(file, store, job, content)
            summary = {
                "format": BATCH_FORMAT,
                "job": job,
                "state": record.state,
                "rows": counts,
                **{key: content[key] for key in ("source", "settings", "columns", "mapping", "hashes")},
                "versions": installed_versions(),
                "database": store.url,
                "files": {name: _hash_of(new.staged(name)) for name in TABLES},
            }
            new.write("batch.json", json.dumps(summary, indent=1, ensure_ascii=False) + "\n")
            if holds(target, BATCH):
                new.drop(BATCH_REPORTS)
            if target != stopped_folder:
                new.drop(f"{stopped_folder.name}/{name}" for name in BATCH.owned)
    return counts, target


@contextmanager
def _styled(new: Replacement, name: str, csv: CsvStyle) -> Iterator[TextIO]:
    """Give a file to write a table into; when the block ends the table stands there in a style."""
    with new.open(name) as file:
        if csv == ENGLISH:
            yield file
            return
        with tempfile.TemporaryFile("w+", encoding="utf-8", newline="", prefix="clutchsynth-") as plain:
            yield plain
            csv.write(plain, file, lists=(BEST,))


def _job_in(folder: Path) -> str | None:
    """Return the job whose result stands in a folder; None where there is none."""
    if not holds(folder, BATCH):
        return None
    try:
        return str(read_json(folder / "batch.json", "batch", "a batch")["job"])
    except (ValueError, KeyError, TypeError):
        return ""


# ---- designs.csv ----------------------------------------------------------------------------------------------------


def _write_designs(file: TextIO, store: Store, job: str, content: Mapping[str, Any]) -> None:
    """Write the designs of all rows, in the order of what is in the rows."""
    layouts = store.layouts(job)
    groups, places = _common_columns(layouts)
    titles, carried = _carried(content)
    columns = [name for group in groups for name in group]
    write = csv_writer(file)
    write(["row", "family", *titles, *RANKING, *columns])
    for row in store.rows(job, canonical=True):
        if row.layout is None or row.content is None:
            continue
        identity = [(row.key or "")[:SHORT], row.family, *(row.cells[k] for k in carried)]
        place = places[row.layout]
        for cells in row.content["rows"]:
            line = [""] * len(columns)
            for k, cell in zip(place, cells[len(RANKING) :], strict=True):
                line[k] = cell
            write([*identity, *cells[: len(RANKING)], *line])


def _common_columns(layouts: Mapping[str, Layout]) -> tuple[list[list[str]], dict[str, list[int]]]:
    """Return the columns that hold all layouts, by group, and where each layout puts its cells.

    The order follows from the layouts alone: of each family as it declares them, families by name.
    """
    widths = {key: sum(len(layout[group]) for group in GROUPS) for key, layout in layouts.items()}
    order = sorted(layouts, key=lambda key: (layouts[key]["family"], -widths[key], key))
    where: dict[str, int] = {}  # column -> the first group that has it
    groups: list[list[str]] = [[] for _ in GROUPS]
    for k, group in enumerate(GROUPS):
        for key in order:
            for name in layouts[key][group]:
                if name not in where:
                    where[name] = k
                    groups[k].append(name)
    position = {name: k for k, name in enumerate(name for group in groups for name in group)}
    return groups, {
        key: [position[name] for group in GROUPS for name in layout[group]] for key, layout in layouts.items()
    }


def _carried(content: Mapping[str, Any]) -> tuple[list[str], list[int]]:
    """Return the headings of the columns that are only carried along, and where they stand in a row.

    A heading that we use ourselves is told apart.
    """
    ours = {*ROW_COLUMNS, *RANKING}
    columns = [column for column in content["columns"] if column["carried"]]
    titles = [f"input: {column['title']}" if column["title"] in ours else column["title"] for column in columns]
    return titles, [column["position"] for column in columns]


# ---- rows.csv -------------------------------------------------------------------------------------------------------


def _write_rows(file: TextIO, store: Store, job: str, content: Mapping[str, Any]) -> dict[str, int]:
    """Write what became of each row, in the order of the table; return the rows by status."""
    layouts = store.layouts(job)
    titles, carried = _carried(content)
    write = csv_writer(file)
    write([*ROW_COLUMNS, *titles])
    counts: dict[str, int] = {}
    for row in store.rows(job, canonical=False):
        status = status_of(row)
        counts[status] = counts.get(status, 0) + 1
        answer = row.content or {}
        designs = answer.get("rows", [])
        leading = [
            row.line,
            (row.key or "")[:SHORT],
            row.family,
            status,
            len(designs),
            "" if row.seconds is None else f"{row.seconds:.3f}",
            answer.get("certificate", ""),
            _text(answer.get("gap")),
            best_design(layouts[row.layout], designs[0]) if designs and row.layout else "",
            explanation_of(row),
            row.remarks,
        ]
        write([*leading, *(row.cells[k] if k < len(row.cells) else "" for k in carried)])
    return dict(sorted(counts.items()))


def status_of(row: Answered) -> str:
    """State of a row: the status of its front, or bad_input, refused, failed, not_solved."""
    return "bad_input" if row.key is None else row.status or "not_solved"


def explanation_of(row: Answered) -> str:
    """Reason why a row has no designs, or was stopped; empty where there is nothing to explain."""
    if row.faults:
        return "; ".join(fault["sentence"] for fault in row.faults)
    content = row.content or {}
    stopped = f"stopped: {content['interrupted']}" if content.get("interrupted") else ""
    return str(content.get("error") or content.get("explanation") or stopped)


@dataclass(frozen=True)
class RowOutcome:
    """What became of a row: its line, what is carried along, status, and the leading design or the reason why none.

    ``objectives`` and ``made`` (choices and parts) are cells of the leading design by heading.
    """

    line: int
    carried: Mapping[str, str]
    status: str
    objectives: Mapping[str, str]
    made: Mapping[str, str]
    reason: str


def row_outcomes(store: Store, job: str) -> Iterator[RowOutcome]:
    """Outcome of each row, in the order of the table."""
    record = store.job(job)
    assert record is not None
    layouts = store.layouts(job)
    titles, places = _carried(record.content)
    for row in store.rows(job, canonical=False):
        designs = (row.content or {}).get("rows", [])
        leading = _grouped(layouts[row.layout], designs[0]) if designs and row.layout else {}
        yield RowOutcome(
            row.line,
            {title: row.cells[k] for title, k in zip(titles, places, strict=True) if k < len(row.cells)},
            status_of(row),
            leading.get("objectives", {}),
            {**leading.get("choices", {}), **leading.get("parts", {})},
            _reason(row),
        )


def missed_limits(explanation: str) -> list[str]:
    """Return the limits that the nearest design of a row misses, as its explanation names them.

    Examples
    --------
    >>> missed_limits("The nearest design found misses 2 limits: life is 3 h where ...; mass <= 5 kg is 9 kg where ...")
    ['life', 'mass <= 5 kg']
    """
    return MISSED.findall(explanation.partition(" misses ")[2])


def _reason(row: Answered) -> str:
    """Return in a few words why a row has no designs."""
    if row.faults:
        more = f" and {len(row.faults) - 1} more" if len(row.faults) > 1 else ""
        return str(row.faults[0]["sentence"]).partition(", ")[2].partition("; expected")[0] + more
    explanation = explanation_of(row)
    names = missed_limits(explanation)
    if not names:
        return explanation
    more = f" and {len(names) - NAMED_LIMITS} more" if len(names) > NAMED_LIMITS else ""
    return f"nearest design misses {', '.join(map(words, names[:NAMED_LIMITS]))}{more}"


def _grouped(layout: Layout, cells: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return the cells of a design by group and heading."""
    values = iter(cells[len(RANKING) :])
    return {group: {name: next(values) for name in layout[group]} for group in GROUPS}


def best_design(layout: Layout, cells: Sequence[str], groups: Sequence[str] = BRIEF) -> str:
    """Return a design in words: objectives, sizes, choices and parts, or some of them."""
    by_group = _grouped(layout, cells)
    return ", ".join(_cell_text(name, cell) for group in groups for name, cell in by_group[group].items() if cell)


def _cell_text(heading: str, cell: str) -> str:
    name, _, unit = heading.partition(" [")
    unit = unit.removesuffix("]")
    if heading == name:
        return f"{name} {cell}"
    return f"{name} {typed_number(float(cell))}{'' if unit in ('', '-') else f' {unit}'}"


def _text(value: object) -> str:
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def _hash_of(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
