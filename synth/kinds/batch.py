"""The kind ``batch``: a table of requirements, and what is asked of all its rows.

Its work is done row by row in the tables of the database; here its table is read, checked and planned, and the files
of its results are made.
"""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from synth.batches.batch import BatchJob
from synth.batches.batch_report import BatchOptions, BatchReader
from synth.batches.outputs import write_outputs
from synth.batches.row_questions import Fault
from synth.batches.row_table import RowTable, read_table
from synth.batches.store import Store
from synth.errors import Described, InputError, at, first_with_others, gathered, refuse_gathered
from synth.kinds.asked import catalogs_of
from synth.kinds.files import UnknownFileError
from synth.kinds.settings import KIND_SETTINGS
from synth.model.registry import load
from synth.question.request_fields import shown_kind
from synth.question.settings import SearchSettings
from synth.queue.records import TABLE, CheckedRequest, Record, ReportProgress, Sources
from synth.results.drawings import can_make
from synth.results.report_request import ReportOptions
from synth.tables.table_file import EXCEL
from synth.verbs.request import WHERE, in_request, known_keys
from synth.verbs.requests import ROW, BatchRequest

UPLOAD, ROWS = "upload", "rows"
KEYS = tuple(BatchRequest.fields())
KEPT = tuple(key for key in KEYS if key not in (UPLOAD, ROWS))
SUMMARY = "batch.json"
FILES = ("designs.csv", "rows.csv", SUMMARY)
REPORTS = {"report.html": "html", "report.pdf": "pdf", "batch.xlsx": "xlsx"}  # by the format that they are of
STATED = "rows.json"  # what rows are kept as that stand in a request


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request: its table as a whole, its settings, and rows until one can be asked.

    All of them are checked when it is planned.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    stated = known_keys(request, KEYS)
    table = table_of(stated, sources)
    kept = {key: value for key, value in stated.items() if key in KEPT}
    with _job(kept, table, sources) as job:
        job.refuse_hopeless(KIND_SETTINGS.checked_seconds)
        count = job.table.count()
        counted = f"{count} row{'' if count == 1 else 's'}"
        asked = {**kept, "table": {"name": table.name, "digest": table.digest}}
        return CheckedRequest(
            request=asked,
            title=counted if table.name == STATED else f"{job.table.name}: {counted}",
            families=tuple(sorted(job.questioner.named)),
            bulk=True,
            fingerprint=job.id,
            rows=count,
            kept=(Record(name=f"{TABLE}{_ending(table.name)}", media=table.media, content=table.content),),
        )


def check(payload: Mapping[str, Any], tell: ReportProgress) -> dict[str, Any]:
    """Content of a table and the rows that cannot be asked; of a long one the first, as far as time allows.

    Raises
    ------
    InputError
        The table as a whole is wrong.
    """
    sources: Sources = payload["sources"]
    stated = known_keys(payload["request"], KEYS)
    table = table_of(stated, sources)
    kept = {key: value for key, value in stated.items() if key in KEPT}
    end = time.monotonic() + KIND_SETTINGS.checked_seconds
    with _job(kept, table, sources) as job:
        faults: list[Fault] = []
        unused: dict[str, set[str]] = {}
        checked = bad = 0
        for row in job.questioner.rows():
            checked += 1
            bad += bool(row.faults)
            faults += row.faults
            if row.unused:
                unused.setdefault(row.family, set()).update(row.unused)
            if time.monotonic() > end:
                break
        return {
            "rows": job.table.count(),
            "checked": checked,
            "bad": bad,
            "faults": [_told(fault) for fault in faults[: KIND_SETTINGS.told_faults]],
            "more_faults": max(len(faults) - KIND_SETTINGS.told_faults, 0),
            "families": sorted(job.questioner.named),
            "columns": [
                {"title": column.title, "name": "" if column in job.questioner.carried else column.name}
                for column in job.questioner.columns
            ],
            "carried": [c.title for c in job.questioner.carried],
            "unused": {family: sorted(columns) for family, columns in sorted(unused.items())},
        }


def plan(payload: Mapping[str, Any], tell: ReportProgress) -> bool:
    """Check the rows of a batch and write them to its job, unless somebody else does meanwhile.

    Raises
    ------
    InputError
        No row asks a question.
    """
    sources: Sources = payload["sources"]
    request = payload["request"]
    stated = {key: value for key, value in request.items() if key in KEPT}
    table = Record(name=request["table"]["name"], media="", content=payload["table"].content)
    with _job(stated, table, sources) as job:
        try:
            return job.plan_claimed(payload["job"], payload["claim"], payload["owner"], stated.get("catalogs", {}))
        finally:
            job.close()


def files_to_have() -> tuple[str, ...]:
    """Return the names of the files of a batch for which no extra is lacking here."""
    return (*FILES, *(name for name, word in REPORTS.items() if can_make(word)))


def files(payload: Mapping[str, Any], tell: ReportProgress) -> Record:
    """Return one of the files of a batch, as far as its rows are answered.

    Raises
    ------
    UnknownFileError
        There is no such file.
    """
    name = payload["name"]
    sources: Sources = payload["sources"]
    if name in REPORTS:
        return Record.of(name, _report(payload["job"], name, sources))
    if name not in FILES:
        raise UnknownFileError(name)
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as folder, Store(sources.database, create=False) as store:
        _, place = write_outputs(store, payload["job"], Path(folder))
        content = (place / name).read_bytes()
        if name == SUMMARY:  # where the rows stand is nobody's business who asks for them over a network
            told = {key: value for key, value in json.loads(content).items() if key != "database"}
            content = (json.dumps(told, indent=1, ensure_ascii=False) + "\n").encode()
        return Record.of(name, content)


def _report(name: str, file: str, sources: Sources) -> bytes | str:
    """Return a file of the report of a batch; of one that is worked at it says how far that is.

    Raises
    ------
    ExtraNeededError
        It needs an extra that is not installed.
    """
    options = BatchOptions("", ReportOptions(formats=(REPORTS[file],)))
    with Store(sources.database, create=False) as store:
        job = store.job(name)
        if job is None:
            raise UnknownFileError(file)
        tables = catalogs_of(job.content.get("catalogs"), sources)
        made, *_, lacking = BatchReader(store, job, tables).files(options)
        if file not in made:
            raise first_with_others(lacking)
        return made[file]


def must_have_one_table(stated: Mapping[str, object]) -> None:
    """Refuse a request with no table, or with two.

    Raises
    ------
    InputError
    """
    if (UPLOAD in stated) == (ROWS in stated):
        given = "both upload and rows" if UPLOAD in stated else None
        raise InputError(f"{WHERE}: {UPLOAD}", given, "the id of a file that was uploaded, or rows", (UPLOAD,))


def table_of(stated: Mapping[str, object], sources: Sources) -> Record:
    """Return the table of a request: a file that was brought, or rows that stand in it.

    Raises
    ------
    InputError
        There is neither, or both.
    """
    must_have_one_table(stated)
    if ROWS in stated:
        return Record.of(STATED, json.dumps(_stated_rows(stated[ROWS]), ensure_ascii=False))
    upload = stated[UPLOAD]
    found = sources.files.get(upload) if isinstance(upload, str) else None
    if found is None:
        raise InputError(f"{WHERE}: {UPLOAD}", upload, "the id of a file that was uploaded", (UPLOAD,))
    return Record.of(f"{Path(found.name).stem or 'rows'}{_ending(found.name)}", found.content)


def _stated_rows(rows: object) -> list[Any]:
    """Return rows that stand in a request.

    Raises
    ------
    InputError
        They are no list, there is none, or one of them is none.
    """
    with at(ROWS):
        if not isinstance(rows, list) or not rows:
            raise InputError(f"{WHERE}: {ROWS}", shown_kind(rows), f"a list with an object for each row, such as {ROW}")
        for k, row in enumerate(rows):
            if not isinstance(row, Mapping):
                raise InputError(f"{WHERE}: {ROWS}: entry {k + 1}", shown_kind(row), f"an object such as {ROW}", (k,))
        if all(value in (None, "") for row in rows for value in row.values()):
            right = f"names with values in them, such as {ROW}"
            raise InputError(f"{WHERE}: {ROWS}", Described("objects without values"), right)
    return rows


def _ending(name: str) -> str:
    """Return the ending by which the kind of a table is told: what is neither Excel nor ours is CSV."""
    ending = Path(name).suffix.lower()
    return ".xlsx" if ending in EXCEL else ending if ending == ".json" else ".csv"


@contextmanager
def _job(stated: Mapping[str, object], table: Record, sources: Sources) -> Iterator[BatchJob]:
    """Give a batch that knows its table and its settings; nothing of it is written.

    Raises
    ------
    InputError
        Something of it is wrong.
    """
    faults: list[InputError] = []
    with gathered(faults):
        asked = BatchRequest.read(stated, in_request)
    with gathered(faults):
        catalogs = catalogs_of(stated.get("catalogs"), sources)
    with gathered(faults):
        if isinstance(family := stated.get("family"), str):
            load(family)
    refuse_gathered(faults)
    settings = SearchSettings(points=asked.points, gap=asked.gap, seed=asked.seed, time_limit=asked.time_limit)
    common = {name: getattr(asked, name) for name in ("parts", "limits", "fix", "objectives", "grid")}
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as folder:
        yield BatchJob(
            asked.family,
            _rows(table, Path(folder)),
            Path(folder) / "out",
            dict(asked.mapping or {}),
            catalogs,
            sources.database or None,
            settings,
            common,
        )


def _rows(table: Record, folder: Path) -> RowTable:
    """Return the rows of a table that is in memory; what reads files gets one."""
    if table.name.endswith(".json"):
        found: RowTable = read_table(json.loads(table.content))
        return found
    file = folder / f"table{_ending(table.name)}"
    file.write_bytes(table.content)
    return RowTable(table.name, file)


def _told(fault: Fault) -> dict[str, Any]:
    return {
        "line": fault.line,
        "column": fault.column,
        "value": fault.value,
        "expected": fault.expected,
        "message": fault.sentence(),
    }
