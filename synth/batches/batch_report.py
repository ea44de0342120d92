"""The report of a batch: what became of its rows is read from the database, and reports make files of it."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.analysis.calculation import calculation_of
from synth.analysis.drawing import drawings_of
from synth.analysis.evaluate import analysed
from synth.analysis.reporting import WrittenReport, installed, write_report
from synth.batches.batch_folder import job_of_folder, job_written, opened_batch
from synth.batches.entries import RowQuestion
from synth.batches.outputs import BRIEF, GROUPS, RANKING, SHORT, best_design, explanation_of, missed_limits, status_of
from synth.batches.solve import GROUP, LIKE
from synth.batches.store import Answered, Store
from synth.batches.views import row_at
from synth.errors import ExtraNeededError, InputError
from synth.folders.csv_style import unstyled
from synth.folders.files import read_bytes, read_json
from synth.folders.output_folder import BATCH, check_kind
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.order.feasibility import Status
from synth.order.margins import MARGINS
from synth.question.arguments import UserTables
from synth.question.catalogs import as_catalogs
from synth.question.instance import Instance
from synth.question.request import Request
from synth.results import Design, ParetoFront
from synth.results.batch_record import BatchRecord, BatchRow, RowInFull
from synth.results.certificate import Certificate
from synth.results.drawings import report as report_named
from synth.results.provenance import installed_versions
from synth.results.report_request import BatchReportRequest, ReportOptions
from synth.results.search_record import SettingsRecord
from synth.results.statistics import SearchStatistics
from synth.tables.catalogs import Catalogs
from synth.text.numbers import typed_number
from synth.text.plain_text import as_meant

if TYPE_CHECKING:
    from synth.queue.models import Job

FORMATS = ("html", "pdf", "xlsx")
RANGE, VARIANTS, ASSIGNED = "size_range.json", "variants.csv", "assignment.csv"
LISTED_LINES = 6  # of rows that a name fits


@dataclass(frozen=True)
class BatchOptions:
    """How a batch is reported; ``row`` is the one in full, empty for the first with designs."""

    row: str
    how: ReportOptions


def report_batch(
    source: Path,
    folder: Path,
    options: BatchOptions,
    database: str | None = None,
    job: str | None = None,
    *,
    tables: UserTables = None,
    family: type[DesignProblem] | None = None,
) -> WrittenReport:
    """Write the report of the batch that stands in a folder.

    ``job``, ``tables`` and ``family`` are those of a batch that ran from Python.

    Raises
    ------
    InputError
        There is no such batch or row, or something asked is wrong; then nothing is written.
    """
    with opened_batch(source, database) as store:
        reader = BatchReader(store, job_of_folder(store, source, job or job_written(source)), tables, family)
        check_kind(folder, BATCH)
        if job_written(folder) not in (None, reader.job.id):
            raise InputError("output", str(folder), "another folder: this one holds another batch")
        return write_report(folder, *reader.files(options, source))


def _tables_of(job: Job, catalogs: UserTables) -> Catalogs | InputError:
    """User tables of a batch, or why they cannot be had."""
    source = job.content.get("catalogs") if catalogs is None else catalogs
    if source == "memory":
        return InputError("tables", job.source, "the BatchResult itself: its tables were in memory")
    try:
        return as_catalogs(source)
    except InputError as error:
        return error


class BatchReader:
    """Reads a batch, row by row.

    Parameters
    ----------
    store, job
        Where the batch is kept.
    tables : optional
        User tables that were in memory.
    family : DesignProblem subclass, optional
        A problem that is not registered.
    """

    def __init__(
        self, store: Store, job: Job, tables: UserTables = None, family: type[DesignProblem] | None = None
    ) -> None:
        self.store, self.job, self.tables, self.family = store, job, _tables_of(job, tables), family
        content = job.content
        self.headings = tuple(str(column["title"]) for column in content["columns"])
        positions = [int(column["position"]) for column in content["columns"]]
        self.order = positions  # of the cells of a row
        self.carried = tuple(k for k, column in enumerate(content["columns"]) if column["carried"])
        self.layouts = store.layouts(job.id)
        families = sorted(self.layouts.values(), key=lambda layout: str(layout["family"]))
        self.objectives = tuple(dict.fromkeys(name for layout in families for name in layout["objectives"]))
        self.places = {
            key: {name: len(RANKING) + k for k, name in enumerate(n for group in GROUPS for n in layout[group])}
            for key, layout in self.layouts.items()
        }

    def files(
        self, options: BatchOptions, folder: Path | None = None
    ) -> tuple[dict[str, str | bytes], list[str], bool, tuple[ExtraNeededError, ...]]:
        """Files of the report of the batch, its notes, whether some row has designs, and missing extras.

        ``folder``: one in which a size range may stand.
        """
        for word in options.how.formats or ("",):
            if word not in FORMATS:
                raise InputError("formats", word, f"some of {', '.join(FORMATS)} for a batch", ("formats",))
        make = installed(report_named("batch_files"), "report")
        record, notes = self.record(options.row, folder)
        files, messages, lacking = make(BatchReportRequest(record, options.how))
        return files, [*notes, *messages], any(row.designs for row in record.rows), lacking

    def record(self, named: str, folder: Path | None) -> tuple[BatchRecord, list[str]]:
        """Batch with one row in full, and notes."""
        rows = [self._row(answered) for answered in self.store.rows(self.job.id, canonical=False)]
        content = self.job.content
        record = BatchRecord(
            source=str(content["source"]),
            state=self.job.state,
            rows=rows,
            headings=self.headings,
            carried=self.carried,
            objectives=self.objectives,
            settings=content["settings"],
            hashes={name: str(value) for name, value in content["hashes"].items()},
            versions=installed_versions(),
            size_range=None if folder is None else _size_range(folder, {row.key for row in rows}),
        )
        row = chosen_row(record, named)
        if row is None:
            return record, []
        in_full = self._in_full(row)
        return replace(record, chosen=in_full), [f"row of line {row.line}: {in_full.note}"] if in_full.note else []

    def _row(self, answered: Answered) -> BatchRow:
        content = answered.content or {}
        designs = content.get("rows") or []
        layout = answered.layout if designs else None
        reason = explanation_of(answered)
        cells = answered.cells
        return BatchRow(
            line=answered.line,
            key=(answered.key or "")[:SHORT],
            family=answered.family,
            status=status_of(answered),
            designs=len(designs),
            objectives=self._objectives(layout, designs[0]) if layout else (None,) * len(self.objectives),
            best=best_design(self.layouts[layout], designs[0], BRIEF[1:]) if layout else "",
            reason=reason,
            causes=_causes(answered, reason),
            remarks=answered.remarks,
            cells=tuple(str(cells[k]) if k < len(cells) else "" for k in self.order),
        )

    def _objectives(self, layout: str, cells: Sequence[str]) -> tuple[float | None, ...]:
        places = self.places[layout]
        texts = [cells[places[name]] if name in places else "" for name in self.objectives]
        return tuple(float(cell) if cell else None for cell in texts)

    # -- one row ---------------------------------------------------------------------------------------------------

    def _in_full(self, row: BatchRow) -> RowInFull:
        """Return a row with its front; where it cannot be computed again, why."""
        there = row_at(self.store, self.job.id, row.line)
        assert there is not None
        answered, question = there
        if question is None or answered.content is None or not answered.content.get("rows"):
            return RowInFull(row)
        try:
            if isinstance(self.tables, InputError):
                raise self.tables
            return self._computed(row, answered, question, self.tables)
        except InputError as error:
            return RowInFull(row, note=f"its designs cannot be computed again: {error}")

    def _computed(self, row: BatchRow, answered: Answered, question: RowQuestion, catalogs: Catalogs) -> RowInFull:
        """Return a row with its front.

        Raises
        ------
        InputError
            Family or tables cannot be had, or are others than those that the batch was computed with.
        """
        content: Mapping[str, Any] = answered.content or {}
        settings = self.job.content["settings"]
        request_content = {key: value for key, value in question.items() if key not in (LIKE, GROUP)}
        users, family = self.family, question["family"]
        problem = load(users if users is not None and users.name == family else family, **question["options"])
        request = Request.from_json(
            {**request_content, "objectives": settings["objectives"], "grid": settings["grid"]},
            problem=problem,
            catalogs=catalogs,
        )
        instance = Instance(request)
        designs = [
            self._design(instance, request, kept, cells, row)
            for kept, cells in zip(content["designs"], content["rows"], strict=True)
        ]
        front = ParetoFront(
            frame=designs[0].frame,
            designs=designs,
            status=Status(row.status),
            complete=bool(content.get("complete")),
            statistics=SearchStatistics(),
            certificate=Certificate(
                str(content.get("certificate", "")), content.get("gap"), int(content.get("combinations") or 0), 0, 0
            ),
            explanation=None,
            settings=SettingsRecord(),
            interrupted=str(content.get("interrupted") or ""),
            question=instance,
        )
        drawings, _ = drawings_of(problem, designs[:1])
        return RowInFull(row, front, calculation_of(instance), next(iter(drawings.values()), None))

    def _design(
        self, instance: Instance, request: Request, kept: Mapping[str, Any], cells: Sequence[str], row: BatchRow
    ) -> Design:
        design = analysed(
            instance.problem,
            request.requirements,
            {**kept["values"], **kept["choices"]},
            kept["parts"],
            catalogs=instance.catalogs,
            limits=request.limits,
            objectives=request.objectives,
        )
        for name, value in kept["objectives"].items():
            if abs(design.objectives[name] - value) > MARGINS.same * max(abs(value), 1e-300):
                where = f"line {row.line}: {name}"
                raise InputError(
                    where, design.objectives[name], f"{typed_number(value)}, as the batch has found with its program"
                )
        known = dict(zip(RANKING, cells, strict=False))
        return replace(
            design,
            rank=int(known["rank"]),
            score=float(known["score"]) if known["score"] else None,
            gap=float(known["gap"]) if known["gap"] else None,
            note=known["note"],
            status=Status(known["status"]),
            alternatives=tuple(x for x in known["alternatives"].split("; ") if x),
        )


def chosen_row(record: BatchRecord, named: str) -> BatchRow | None:
    """Return the row that is told in full: the first with designs, or the one that is named.

    Parameters
    ----------
    record : BatchRecord
    named : str
        Its line, what stands in one of the columns that are carried along, ``column=cell``, or the beginning of its
        key; empty for the first row with designs.

    Raises
    ------
    InputError
        There is no such row, or there are several.
    """
    if not named:
        return next((row for row in record.rows if row.designs), None)
    heading, equals, cell = named.partition("=")
    column = next((k for k, title in enumerate(record.headings) if equals and title == heading.strip()), None)
    fitting = [row for row in record.rows if named.isdecimal() and row.line == int(named)]
    fitting = fitting or [row for row in record.rows if any(row.cells[k].strip() == named for k in record.carried)]
    if not fitting and column is not None:
        fitting = [row for row in record.rows if row.cells[column].strip() == cell.strip()]
    fitting = fitting or [row for row in record.rows if len(named) >= 6 and row.key.startswith(named)]
    if len(fitting) == 1:
        return fitting[0]
    if fitting:
        lines = ", ".join(str(row.line) for row in fitting[:LISTED_LINES])
        more = ", ..." if len(fitting) > LISTED_LINES else ""
        raise InputError("row", named, f"a line of the table: this fits lines {lines}{more}", ("row",))
    names = " or ".join(record.headings[k] for k in record.carried[:2])
    lines = f"a line from {record.rows[0].line} to {record.rows[-1].line}" if record.rows else "a batch with rows"
    raise InputError("row", named, lines + (f", or a cell of {names}" if names else ""), ("row",))


def _causes(answered: Answered, reason: str) -> tuple[str, ...]:
    """Reason why a row has no design, in a few words that many rows share."""
    if answered.faults:
        return tuple(dict.fromkeys(str(fault["column"]) or "the row as a whole" for fault in answered.faults))
    # A limit that a row adds has its number in its name.
    names = (name.split(" ", 1) for name in missed_limits(reason) if name[:1].isalpha())
    return tuple(dict.fromkeys(name[0] + (" (own limit)" if len(name) > 1 else "") for name in names))


def _size_range(folder: Path, keys: set[str]) -> dict[str, Any] | None:
    """Return the size range that was chosen for these rows, in the folder of the batch or in one below."""
    for path in (folder / RANGE, *sorted(folder.glob(f"*/{RANGE}"))):
        if not path.is_file() or not (path.parent / VARIANTS).is_file():
            continue
        served = {row.get("row", "") for row in _table(path.parent / ASSIGNED)}
        content = read_json(path, "size range", "a size_range.json as clutchsynth has written it")
        if isinstance(content, Mapping) and served and served <= keys:
            rows = _table(path.parent / VARIANTS)
            return {"told": dict(content), "columns": list(rows[0]) if rows else [], "rows": rows}
    return None


def _table(path: Path) -> list[dict[str, str]]:
    if not path.is_file():
        return []
    text = read_bytes(path, "size range", "a table as clutchsynth has written it").decode("utf-8", "replace")
    rows = csv.DictReader(io.StringIO(unstyled(text), newline=""))
    return [{as_meant(str(k)): as_meant(v or "") for k, v in row.items() if k is not None} for row in rows]
