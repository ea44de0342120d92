"""Batches: a table of rows becomes a job, the job is worked off, its results are written."""

from __future__ import annotations

import pickle
import shutil
import tempfile
import time
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from sqlalchemy import URL

from synth.batches.batch_folder import DATABASE
from synth.batches.entries import BatchProgress, RowSource
from synth.batches.executors import Cluster, Inline, Processes
from synth.batches.outputs import BEST, write_outputs
from synth.batches.row_checks import PlanProgress, checked_rows
from synth.batches.row_groups import RowGroups
from synth.batches.row_questions import Fault, Questioner, ReadRow, canonical_position, read_mapping
from synth.batches.row_remarks import RowRemarks
from synth.batches.row_table import RowTable, read_table
from synth.batches.runner import Runner, Shares
from synth.batches.settings import BATCHES, BatchSettings
from synth.batches.store import Store
from synth.batches.warm_starts import WarmStarts
from synth.errors import InputError, SeveralErrors, whole_number
from synth.folders.csv_style import ENGLISH, GERMAN, CsvStyle, list_with_points
from synth.folders.output_folder import claimed, settle
from synth.kernels.loading import native_code
from synth.model.registry import families, load
from synth.question.arguments import Family, Limits, Objectives, PartRules, Pins, UserTables
from synth.question.catalogs import as_catalogs
from synth.question.count_domain import stated_value
from synth.question.names import as_mapping
from synth.question.request import EXAMPLES, check_grid, listed_objectives
from synth.question.settings import SearchSettings, check_progress
from synth.queue.database import digest, encoded, file_url
from synth.queue.job_queue import Claim
from synth.queue.job_table import BATCH
from synth.results.provenance import code_digest, problem_digest, processor
from synth.results.report_request import AboutSource
from synth.text.input_limits import INPUT_LIMITS
from synth.text.plain_text import as_meant

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class BatchResult:
    """What a batch has come to: its files, and how many rows stand how."""

    folder: Path
    job: str
    stopped: str  # why it was stopped; empty when it is done
    counts: Mapping[str, int]  # rows by status
    database: Any = field(repr=False)
    catalogs: Any = field(default=None, repr=False, compare=False)  # own tables, and
    user_family: Any = field(default=None, repr=False, compare=False)  # a problem that is not registered
    keep: Any = field(default=None, repr=False, compare=False)  # a temporary folder lives as long as this

    def designs(self) -> pd.DataFrame:
        """Return designs.csv: the ranked designs of all rows, in an order that only their content decides."""
        settle(self.folder)
        return _frame_of(self.folder / "designs.csv", low_memory=False)

    def rows(self) -> pd.DataFrame:
        """Return rows.csv: what became of each row, in the order of the table."""
        settle(self.folder)
        return _frame_of(self.folder / "rows.csv", keep_default_na=False)

    def report(
        self,
        folder: str | Path | None = None,
        *,
        row: str | int | None = None,
        formats: Sequence[str] = ("html",),
        about: AboutSource = None,
        fonts: Sequence[str | Path] = (),
    ) -> Path:
        """Write report.html: rows by state, all of them to filter and sort, failures with reasons, one row in full.

        Parameters
        ----------
        folder : path, optional
            By default that of the batch.
        row : str or int, optional
            The row in full: its line, or what stands in a column that is carried along. By default the first with
            designs.
        formats : list of str
            Some of ``html``, ``pdf``, ``xlsx``.
        about, fonts
            As for ``ParetoFront.report``.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        InputError
            Something asked is wrong; then nothing is written. Or an extra is not installed: what can be made without
            it is written.
        """
        from synth.batches.batch_report import BatchOptions, report_batch
        from synth.results.report_request import ReportOptions

        options = BatchOptions("" if row is None else str(row).strip(), ReportOptions.read(formats, about, fonts=fonts))
        target = self.folder if folder is None else Path(folder)
        memory = {"tables": self.catalogs, "family": self.user_family}
        return report_batch(self.folder, target, options, self.database, self.job, **memory).complete()


def _frame_of(path: Path, **how: Any) -> pd.DataFrame:
    """Return a table of a batch, in whatever style it is written."""
    import pandas as pd  # costly to import; who asks has waited long enough for the batch

    with path.open(encoding="utf-8") as file:
        style = GERMAN if file.read(1) == GERMAN.mark else ENGLISH
    decimal = "," if style.commas else "."
    frame = pd.read_csv(path, dtype={"row": str}, encoding="utf-8-sig", sep=style.delimiter, decimal=decimal, **how)
    if style.commas and BEST in frame:
        frame[BEST] = frame[BEST].map(list_with_points)
    return _as_meant(frame)


def _as_meant(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table as it was before its texts were kept from being formulas."""
    frame = frame.rename(columns=as_meant)
    for k, kind in enumerate(frame.dtypes):
        if getattr(kind, "kind", "O") not in "biuf":
            frame.isetitem(k, [as_meant(cell) if isinstance(cell, str) else cell for cell in frame.iloc[:, k]])
    return frame


def batch(
    p: Family | None,
    table: RowSource,
    output: str | Path | None = None,
    *,
    mapping: Mapping[str, str] | str | Path | None = None,
    objectives: Objectives = None,
    points: int = 30,
    catalogs: UserTables = None,
    parts: PartRules | None = None,
    limits: Limits | None = None,
    fix: Pins | None = None,
    gap: float = 1e-3,
    grid: bool = True,
    workers: int = 1,
    seed: int = 0,
    scheduler: str | None = None,
    database: str | None = None,
    progress: BatchProgress | None = None,
    time_limit: float | None = None,
) -> BatchResult:
    """Find the ranked designs for every row of a table of requirements.

    The rows are checked first; a bad one is reported in ``rows()`` and the others run. What was found is kept in a
    database: the same call after an interruption goes on where it was, and ends with the same designs.csv.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance, or None
        Of rows that name no ``family``.
    table : path, DataFrame or list of mappings
        CSV or .xlsx. Columns are names or symbols of requirements with units in brackets, options, variables that are
        pinned, and ``family``, ``options``, ``limits``, ``fix``, ``parts``.
    output : path, optional
        Folder for designs.csv, rows.csv, batch.json and the database; a temporary one if not given.
    mapping : path or mapping, optional
        Headings of the table -> names; ``carry`` for a column that is only carried along.
    objectives, points, catalogs, gap, grid, seed
        As for ``synthesize``, for each row.
    parts, limits, fix : mapping, optional
        As for ``synthesize``; a row that states the same name replaces it.
    workers : int
        Processes; 1 works in this one.
    scheduler : str, optional
        ``tcp://host:port`` of a Dask cluster, instead of processes.
    database : str, optional
        ``sqlite:///file`` or ``postgresql://...``, instead of a file in the folder.
    progress : callable, optional
        Called with a mapping: rows, done, failed, infeasible, bad, rate, left, found (rows not done that have designs).
    time_limit : float, optional
        Seconds per row. What is found within a time is not the same on every machine.

    Returns
    -------
    BatchResult

    Raises
    ------
    InputError
        The table as a whole is wrong, or none of its rows asks a question.
    """
    settings = SearchSettings(points=points, gap=gap, workers=workers, seed=seed, time_limit=time_limit)
    check_progress(progress)
    keep = None
    if output is None:
        keep = _TemporaryFolder()
        output = keep.path
    job = BatchJob(
        p,
        table,
        Path(output),
        mapping,
        catalogs,
        database,
        settings,
        {"parts": parts, "limits": limits, "fix": fix, "objectives": objectives, "grid": grid},
    )
    return job.result(workers, scheduler, progress, keep)


class _TemporaryFolder:
    """A folder that goes when nobody needs it any more."""

    def __init__(self) -> None:
        self.path = tempfile.mkdtemp(prefix="clutchsynth-")
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


def _common(common: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """What is asked in all rows of parts, limits and pins."""
    return {
        name: {str(key): stated_value(x) for key, x in as_mapping(common[name], name, EXAMPLES[name]).items()}
        for name in ("parts", "limits", "fix")
    }


class BatchJob:
    """The steps of a batch: plan, work, write. Each can be repeated, by any process.

    Parameters
    ----------
    problem, table, mapping, catalogs, database
        As for :func:`batch`.
    folder : Path
        For the results.
    settings : SearchSettings
        Of every row.
    common : mapping
        What is asked in all rows: ``parts``, ``limits``, ``fix``, ``objectives``, ``grid``.
    numbers : BatchSettings, optional
    csv : CsvStyle
        How designs.csv and rows.csv are written.

    Raises
    ------
    InputError
        The table as a whole, or a setting, is wrong.
    """

    def __init__(
        self,
        problem: Family | None,
        table: RowSource | RowTable,
        folder: Path,
        mapping: Mapping[str, str] | str | Path | None,
        catalogs: UserTables,
        database: str | None,
        settings: SearchSettings,
        common: Mapping[str, Any],
        numbers: BatchSettings = BATCHES,
        csv: CsvStyle = ENGLISH,
    ) -> None:
        self.numbers, self.csv = numbers, csv
        check_grid(common["grid"])
        if folder.exists() and not folder.is_dir():
            raise InputError("--output", str(folder), "a folder; this is a file")
        self.folder = self.place = folder
        self.table = read_table(table)
        self.mapping = dict(mapping) if isinstance(mapping, Mapping) else read_mapping(mapping)
        self.settings: dict[str, Any] = {
            "objectives": listed_objectives(common["objectives"]),
            "points": settings.points,
            "gap": settings.gap,
            "grid": common["grid"],
            "seed": settings.seed,
            "time_limit": settings.time_limit,
        }
        self.common = _common(common)
        self.catalog_spec = str(Path(catalogs).resolve()) if isinstance(catalogs, (str, Path)) else catalogs
        self.catalogs = as_catalogs(self.catalog_spec)
        self.questioner = Questioner(self.table, problem, self.mapping, self.settings, self.common, self.catalogs)
        self.hashes = self._hashes()
        self.basis = digest([self.settings, {k: v for k, v in self.hashes.items() if k != "rows"}])
        self.id = self._id()
        self.address: Any = database or file_url(folder.resolve() / DATABASE)
        self.remarks = RowRemarks(numbers.plan)
        self._store: Store | None = None

    def _hashes(self) -> dict[str, str]:
        """Digests of what the answers depend on."""
        return {
            "rows": self.table.digest(),
            "code": code_digest(),
            "native code": native_code(),
            "processor": processor(),
            "families": problem_digest(self.questioner.problems()),
            "tables": self.catalogs.digest(),
        }

    def _id(self) -> str:
        """Name of the job: the same for the same rows, settings, programs and tables."""
        user_family = self.questioner.user_family
        return digest(
            [
                self.basis,
                self.hashes["rows"],
                self.table.header(),
                self.mapping,
                self.common,
                self.questioner.default,
                self.questioner.user_options,
                None if user_family is None else user_family.__qualname__,
            ]
        )[:16]

    @property
    def store(self) -> Store:
        """The database; made when it is first needed."""
        if self._store is None:
            self._store = Store(self.address, settings=self.numbers.store)
        return self._store

    def close(self) -> None:
        """Let go of the database."""
        if self._store is not None:
            self._store.close()

    # -- plan ----------------------------------------------------------------------------------

    def plan(self, workers: int | None = None, progress: BatchProgress | None = None) -> bool:
        """Check all rows and write the job, unless it is there already.

        Parameters
        ----------
        workers : int, optional
            Processes that check; none checks in this one.
        progress : callable, optional
            Told how far it is, as :class:`PlanProgress` tells it.

        Returns
        -------
        bool
            Whether it was there: then it goes on.

        Raises
        ------
        InputError
            No row asks a question; then nothing is written.
        """
        file = Path(str(self.address.database)) if isinstance(self.address, URL) else None
        fresh = file is not None and not file.exists()
        try:
            return self._planned(workers, progress)
        except BaseException:
            if file is not None and fresh:  # nothing is kept of a job that could not be written
                self.close()
                for place in (file, *(file.with_name(f"{file.name}-{more}") for more in ("wal", "shm", "journal"))):
                    place.unlink(missing_ok=True)
            raise

    def _planned(self, workers: int | None, progress: BatchProgress | None) -> bool:
        if self._is_planned():
            self._reopen()
            return True
        with self._checked(workers, progress) as rows:
            job = {
                "id": self.id,
                "basis": self.basis,
                "source": self.table.name,
                "folder": str(self.folder.resolve()),
                "content": self._content(),
            }
            return not self.store.create(job, rows, self._rows_per_unit())

    def plan_claimed(self, job: str, claim: Claim, owner: str, catalogs: Mapping[str, object]) -> bool:
        """Check all rows and write them to a job that stands there without them.

        Parameters
        ----------
        job, claim, owner
            The unit of planning, and who holds it.
        catalogs : mapping
            References of the tables of a user's own, under which they are found again.

        Returns
        -------
        bool
            False where somebody else holds the unit; then nothing is written.

        Raises
        ------
        InputError
            No row asks a question; then nothing is written.
        """
        with self._checked() as rows:
            content = {**self._content(), "catalogs": dict(catalogs)}
            return self.store.plan(job, claim, owner, content, self.basis, rows, self._rows_per_unit())

    def refuse_hopeless(self, seconds: float) -> None:
        """Refuse a table of which no row can be asked, as far as that shows in some seconds.

        Raises
        ------
        InputError
            With what is wrong in the first rows.
        """
        end = time.monotonic() + seconds
        count, first = 0, list[ReadRow]()
        for count, row in enumerate(self.questioner.rows(), start=1):
            if row.key is not None or time.monotonic() > end:
                return
            if count <= self.numbers.plan.shown_faults:
                first.append(row)
        self._refuse(first, count)

    @contextmanager
    def _checked(self, workers: int | None = None, progress: BatchProgress | None = None) -> Iterator[Iterator[Any]]:
        """Check all rows, and give them as they are kept.

        Raises
        ------
        InputError
            No row asks a question.
        """
        plan_progress = PlanProgress(progress, self.numbers.plan.pause, self.table)
        # Rows wait in a file until all are checked: nothing is written before, and the database is not held up.
        with (
            tempfile.TemporaryFile(prefix="clutchsynth-") as checked,
            closing(RowGroups(self.numbers.groups)) as groups,
        ):
            valid, first, count = 0, list[ReadRow](), 0
            rows = checked_rows(self.questioner, self.id, self.catalog_spec, workers, self.numbers.plan)
            for count, row in enumerate(plan_progress.each(rows, "checked"), start=1):
                if row.key is not None:
                    valid += 1
                    if self._has_one_objective():
                        groups.show(row.key, row.alike, row.place)
                if count <= self.numbers.plan.shown_faults and not valid:
                    first.append(row)
                pickle.dump((self._recorded(row), row.alike, row.place), checked)
            if not valid:
                self._refuse(first, count)
            company = _Company(groups, WarmStarts(self.numbers.warm_starts))
            for waiting in plan_progress.each(_read_again(checked, count), "grouped"):
                company.show(*waiting)
            yield plan_progress.each((company.placed(*waiting) for waiting in _read_again(checked, count)), "written")

    def _rows_per_unit(self) -> int:
        single = self.settings["points"] == 1 or self._has_one_objective()  # each row asks for one best design
        return self.numbers.rows_per_unit if single else self.numbers.fronts_per_unit

    def _is_planned(self) -> bool:
        place = self.address if isinstance(self.address, str) else Path(str(self.address.database))
        if isinstance(place, Path) and not place.is_file():
            return False
        record = self.store.job(self.id) or self.store.job_like(BATCH, self.id)
        if record is not None:
            self.id = record.id  # one that a service has made has an id of its own
        return record is not None

    def _has_one_objective(self) -> bool:
        return len(self.settings["objectives"] or ()) == 1

    def _reopen(self) -> None:
        job = self.store.job(self.id)
        assert job is not None
        if job.folder != str(self.folder.resolve()):
            self.store.change(self.id, folder=str(self.folder.resolve()))
        self.store.reopen(self.id, "continued", f"was {job.state}")

    def _refuse(self, rows: list[ReadRow], count: int) -> None:
        if not rows:
            raise InputError(self.table.name, "a header only", "at least one row below the header")
        others = f" (none of {count} rows can be asked)" if count > 1 else ""
        faults = [fault for row in rows for fault in row.faults]
        raise SeveralErrors([self._input_error(fault, "" if k else others) for k, fault in enumerate(faults)])

    def _input_error(self, fault: Fault, more: str) -> InputError:
        where = f"{self.table.name}, line {fault.line}{f', column {fault.column}' if fault.column else ''}"
        path = ("rows", fault.line, fault.column) if fault.column else ("rows", fault.line)
        return InputError(where, fault.value, f"{fault.expected}{more}", path)

    def _content(self) -> dict[str, Any]:
        """Record stored with the job: how it is solved, and its columns."""
        carried = {column.position for column in self.questioner.carried}
        kept = None if self.catalogs is None else self._catalogs_as_text()
        return {
            "source": self.table.name,
            "settings": self.settings,
            "mapping": self.mapping,
            "hashes": self.hashes,
            "catalogs": kept,
            "own": None if self.questioner.user_family is None else self.questioner.user_family.__qualname__,
            "families": sorted(name for name in self.questioner.named if name in families()),
            "columns": [
                {"title": c.title, "position": c.position, "carried": c.position in carried}
                for c in self.questioner.columns
            ],
        }

    def _catalogs_as_text(self) -> Any:
        """Return own tables as another process can find them; the word ``memory`` where it cannot."""
        if self.catalog_spec is None or isinstance(self.catalog_spec, str):
            return self.catalog_spec
        files = self.catalogs.files()
        return files if isinstance(self.catalog_spec, Mapping) and set(files) == set(self.catalog_spec) else "memory"

    def _recorded(self, row: ReadRow) -> dict[str, Any]:
        self.remarks.add(row)
        question = None
        if row.question is not None:
            question = {"key": row.key, "structure": row.structure, "content": row.question}
        return {
            "line": row.line,
            "position": canonical_position(row.cells),
            "key": row.key,
            "family": row.family,
            "cells": list(row.cells),
            "remarks": f"not used: {', '.join(row.unused)}" if row.unused else "",
            "faults": [
                {"column": f.column, "value": f.value, "expected": f.expected, "sentence": f.sentence()}
                for f in row.faults
            ],
            "question": question,
        }

    # -- work and results ----------------------------------------------------------------------

    def result(
        self, workers: int, scheduler: str | None, progress: BatchProgress | None, keep: object = None
    ) -> BatchResult:
        """Plan, work off and write the job, as ``batch`` does; ``keep`` lives as long as the result."""
        with closing(self), claimed(self.folder, self.id):
            self.plan(workers)
            stopped = self.work(None if workers == 1 and scheduler is None else workers, scheduler, progress)
            counts = self.write()
        user_family = self.questioner.user_family
        return BatchResult(self.place, self.id, stopped, counts, self.address, self.catalog_spec, user_family, keep)

    def work(
        self,
        workers: int | None,
        scheduler: str | None,
        progress: BatchProgress | None,
        say: Callable[[str], None] = lambda sentence: None,
    ) -> str:
        """Work the job off; return why it was stopped, or an empty text."""
        shares = Shares(self.settings, self.catalog_spec, self.questioner.user_family)
        return work_off(self.store, self.id, shares, workers, scheduler, progress, say, self.numbers)

    def write(self) -> dict[str, int]:
        """Write the results that there are to ``place``; return the rows by status."""
        counts, self.place = write_outputs(self.store, self.id, self.folder, self.csv)
        return counts


def work_off(
    store: Store,
    job: str,
    shares: Shares,
    workers: int | None,
    scheduler: str | None,
    progress: BatchProgress | None,
    say: Callable[[str], None],
    numbers: BatchSettings = BATCHES,
) -> str:
    """Work a job off.

    Parameters
    ----------
    store, job, shares, progress
        As for ``Runner``.
    workers : int or None
        Processes; None works in this one.
    scheduler : str, optional
        Of a Dask cluster, instead of processes.
    say : callable
        Told in a sentence what happens to the cluster.
    numbers : BatchSettings, optional

    Returns
    -------
    str
        Why it was stopped; empty when the job is done.
    """
    if workers is not None:
        whole_number(workers, "workers", INPUT_LIMITS.workers, path=("workers",))
    if sum(store.open_units(job)):
        executor: Any
        if scheduler is not None:
            executor = Cluster(scheduler, say, numbers.cluster)
        else:
            executor = Inline() if workers is None else Processes(workers)
        stopped = Runner(store, job, shares, executor, progress, numbers.runner).run()
    else:
        stopped = ""
    if stopped == "cancelled":
        return stopped
    if stopped:
        store.requeue(job)
        store.add_event(job, "stopped", stopped)
    else:
        store.settle(job)
    return stopped


def _read_again(file: IO[bytes], count: int) -> Iterator[tuple[dict[str, Any], str, tuple[float, ...]]]:
    """Yield the rows that wait in a file, from the first."""
    file.seek(0)
    for _ in range(count):
        yield pickle.load(file)


class _Company:
    """What helps the rows of a job: a group to be answered with, or else a teacher.

    Parameters
    ----------
    groups : RowGroups
        All rows were shown to them.
    school : WarmStarts
        No row was.
    """

    def __init__(self, groups: RowGroups, school: WarmStarts) -> None:
        self._groups, self._school = groups, school

    def show(self, record: Mapping[str, Any], alike: str, where: tuple[float, ...]) -> None:
        """Show a row: whoever is in no group may teach."""
        question = record["question"]
        if question is not None and self._groups.member(question["key"], alike) is None:
            self._school.show(question["structure"], question["key"], where, question["content"])

    def placed(self, record: dict[str, Any], alike: str, where: tuple[float, ...]) -> dict[str, Any]:
        """Return a row as it is kept: with the group that it is in, or the question whose experience helps it."""
        question = record["question"]
        if question is None:
            return record
        member = self._groups.member(question["key"], alike)
        content: Mapping[str, Any]
        if member is not None:
            position, content = member.position(), member.with_group(question["content"])
            key = digest(content)
        else:
            key, content, teacher = self._school.taught(
                question["structure"], question["key"], where, question["content"]
            )
            # Questions with one teacher stand together, so that few processes need its experience.
            position = teacher.encode() + b"\0" + canonical_position((encoded(question["content"]),))
        return {**record, "key": key, "question": {**question, "key": key, "content": content, "position": position}}


def resume(
    store: Store,
    job: str,
    workers: int | None,
    scheduler: str | None,
    progress: BatchProgress | None,
    say: Callable[[str], None],
) -> str:
    """Go on with a job from what the database says alone; return why it was stopped, or an empty text.

    Raises
    ------
    InputError
        The job has a problem or tables that only the script that made it knows, or the program has changed.
    """
    record = store.job(job)
    if record is None:
        raise InputError("job", job, "a job of this database")
    content = record.content
    if record.kind != BATCH:
        raise InputError("job", job, f"a batch; this is a job of the kind {record.kind}, which a worker goes on with")
    if record.request.get("catalogs"):
        raise InputError("job", job, "the service that has its tables, to go on with it")
    if content["own"] is not None or content["catalogs"] == "memory":
        raise InputError("job", job, "its own script: only that knows the problem or the tables it was made with")
    now = {
        "code": code_digest(),
        "native code": native_code(),
        "processor": processor(),
        "families": problem_digest([type(load(name)) for name in content["families"]]),
        "tables": as_catalogs(content["catalogs"]).digest(),
    }
    # Of the processor the first version has told nothing.
    changed = [name for name, text in now.items() if content["hashes"].get(name, text) != text]
    if changed:
        expected = f"the {' and '.join(changed)} it was made with; run clutchsynth batch with its table instead"
        raise InputError("job", job, expected)
    store.reopen(job, "resumed", f"was {record.state}")
    return work_off(
        store, job, Shares(content["settings"], content["catalogs"], None), workers, scheduler, progress, say
    )
