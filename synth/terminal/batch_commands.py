"""The commands for many rows: batch and jobs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from synth.errors import InputError, whole_number
from synth.folders.csv_style import CsvStyle, csv_style
from synth.folders.output_folder import BATCH
from synth.system.interrupts import heard_again
from synth.tables.table_file import read_as
from synth.terminal.options import Csv, Encoding, Headings, Quiet, RowsFolder, VisibleRows, takes
from synth.terminal.session import (
    INFEASIBLE,
    INTERNAL,
    STOPPED,
    check_output,
    claim_output,
    own_tables,
    rows_folder,
    stopped_as,
    tell,
)
from synth.text.input_limits import INPUT_LIMITS
from synth.verbs.requests import BatchRequest

if TYPE_CHECKING:
    from synth.batches.batch import BatchJob
    from synth.batches.entries import BatchProgress, BatchState
    from synth.batches.store import Store
    from synth.question.arguments import UserTables
    from synth.queue.models import Job

DATABASE_VARIABLE = "CLUTCHSYNTH_DATABASE"

RowsFile = Annotated[Path, typer.Argument(help="A table of rows, CSV or .xlsx (FILE.xlsx#SHEET).", metavar="ROWS.csv")]
Workers = Annotated[int | None, typer.Option(help="Processes of this machine; by default one per core.")]
Scheduler = Annotated[
    str | None,
    typer.Option(help="Work on a Dask cluster instead: the address of its scheduler.", metavar="tcp://HOST:PORT"),
]
Database = Annotated[
    str | None,
    typer.Option(
        envvar=DATABASE_VARIABLE,
        help="Database of the jobs: sqlite:///FILE or postgresql://USER@HOST/NAME; by default a file in DIR.",
        metavar="URL",
    ),
]
JobName = Annotated[str, typer.Argument(help="The folder of a batch, or the id of a job.", metavar="JOB")]

jobs_app = typer.Typer(help="List, show, cancel and resume jobs.", no_args_is_help=True, rich_markup_mode=None)


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command(name="batch")(batch)
    app.add_typer(jobs_app, name="jobs")


@takes(BatchRequest)
def batch(
    asked: BatchRequest,
    *,
    rows: RowsFile,
    folder: RowsFolder = None,
    mapping: Headings = None,
    catalogs: Annotated[Path | None, typer.Option(help="Folder with your own tables.", metavar="DIR")] = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    database: Database = None,
    encoding: Encoding = None,
    visible_rows: VisibleRows = False,
    csv: Csv = "en",
    quiet: Quiet = False,
) -> None:
    """Search the designs for every row of a table; run again to go on after an interruption."""
    style = csv_style(csv, "--csv")
    place = rows_folder(rows, folder)
    own = own_tables(catalogs, Path(), encoding, visible_rows)
    rows = Path(read_as(str(rows), encoding, visible_rows))

    def make() -> BatchJob:
        return batch_job(asked, rows, place, mapping, own, database, style)

    raise typer.Exit(finish(make, workers, scheduler, quiet, named=folder is not None))


def batch_job(
    asked: BatchRequest,
    rows: Path,
    folder: Path,
    mapping: Path | None,
    tables: UserTables,
    database: str | None,
    csv: CsvStyle,
) -> BatchJob:
    """Return the batch that options describe."""
    from synth.batches.batch import BatchJob
    from synth.question.settings import SearchSettings

    check_output(folder)
    settings = SearchSettings(points=asked.points, gap=asked.gap, seed=asked.seed, time_limit=asked.time_limit)
    common = {name: getattr(asked, name) for name in ("parts", "limits", "fix", "objectives", "grid")}
    return BatchJob(asked.family, rows, folder, mapping, tables, database, settings, common, csv=csv)


def finish(make: Callable[[], BatchJob], workers: int | None, scheduler: str | None, quiet: bool, named: bool) -> int:
    """Plan a batch, work it off, write it, and return the exit code that it has; ``named``: its folder by the user."""
    if workers is not None:
        whole_number(workers, "--workers", INPUT_LIMITS.workers, path=("workers",))
    if scheduler is not None:
        from synth.batches.executors import must_answer

        must_answer(scheduler)
    with heard_again() as check:
        with stopped_as("stopped while the rows were checked; nothing is kept"):
            from synth.terminal.batch_console import batch_display, print_summary, print_table_remarks, shown_rows

            job = make()
            claim_output(job.folder, BATCH, job.id)
            with batch_display(quiet) as progress:
                continues = job.plan(_processes(workers), _checked(progress, check))
            check()
            if not (named or quiet):
                tell(f"the results go to {job.folder}; -o DIR names another folder")
        with closing(job), _goes_on():
            if not quiet:
                print_table_remarks(job, continues)
            with batch_display(quiet) as progress:
                stopped = job.work(_processes(workers), scheduler, _checked(progress, check), tell)
            counts = job.write()
            rows = [] if quiet else shown_rows(job.store, job.id, counts)
    if not quiet:
        print_summary(counts, rows, job.place, job.folder, stopped)
    return _code(counts, stopped)


@contextmanager
def _goes_on() -> Iterator[None]:
    """Say how a job goes on that is stopped, or has no place for its results; other faults are for others to say."""
    how = "what was found is in the database, the same command goes on"
    try:
        with stopped_as(f"stopped; {how}"):
            yield
    except (OSError, InputError) as error:
        if isinstance(error, InputError):
            reason = str(error) if error.field == "output" else ""
        else:
            reason = f"{error.filename} cannot be written ({error.strerror})" if error.filename is not None else ""
        if not reason:
            raise
        tell(f"stopped: {reason}; {how}")
        raise typer.Exit(STOPPED) from error


def _processes(workers: int | None) -> int:
    from synth.system.operating_system import cores

    return cores() if workers is None else workers


def _code(counts: dict[str, int], stopped: str) -> int:
    """Return the exit code of a batch: stopped, a row failed, nothing feasible, or fine."""
    if stopped:
        return STOPPED
    if counts.get("failed"):
        return INTERNAL
    return 0 if counts.get("optimal", 0) + counts.get("feasible", 0) else INFEASIBLE


def _checked(progress: BatchProgress | None, check: Callable[[], None]) -> BatchProgress:
    """Progress callback that also stops where a signal has been lost."""

    def show(state: BatchState) -> None:
        check()
        if progress is not None:
            progress(state)

    return show


# ---- jobs -----------------------------------------------------------------------------------------------------------


@jobs_app.command(name="list")
def list_jobs(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(help="Folders of batches; by default those below this one.", metavar="[DIR]..."),
    ] = None,
    database: Database = None,
) -> None:
    """List the jobs of a database, or of the folders that hold one."""
    from synth.terminal.batch_console import print_jobs

    found: list[tuple[Job, Any]] = []
    for store in _stores(database, folders or None):
        with store:
            store.release_dead()
            for job in store.jobs():
                store.requeue(job.id)
            found += [(job, store.account(job.id)) for job in store.jobs()]
    print_jobs(found)


@jobs_app.command()
def show(job: JobName, database: Database = None) -> None:
    """Show how far a job is, and what happened to it."""
    from synth.terminal.batch_console import print_job

    store, found = _find(job, database)
    with store:
        store.release_dead(found.id)
        store.requeue(found.id)
        found = store.job(found.id) or found
        print_job(found, store.account(found.id), store.open_units(found.id), store.events(found.id, 20))


@jobs_app.command()
def cancel(job: JobName, database: Database = None) -> None:
    """Stop a job wherever it runs; what it has found is kept, and resume goes on."""
    store, found = _find(job, database)
    with store:
        if not store.cancel(found.id):
            raise InputError("JOB", job, f"a job that is not {found.state} yet")
    print(f"{found.id}: cancelled; clutchsynth jobs resume goes on")


@jobs_app.command()
def resume(
    job: JobName,
    workers: Workers = None,
    scheduler: Scheduler = None,
    database: Database = None,
    csv: Csv = "en",
    quiet: Quiet = False,
) -> None:
    """Go on with a job that was stopped or cancelled, without its table."""
    from synth.batches.batch import resume as go_on
    from synth.batches.outputs import write_outputs
    from synth.terminal.batch_console import batch_display, print_summary, shown_rows

    style = csv_style(csv, "--csv")
    store, found = _find(job, database)
    if found.code is not None:
        with store:
            _let_workers_go_on(store, found)
        return
    with store, heard_again() as check, _goes_on():
        claim_output(Path(found.folder), BATCH, found.id)
        with batch_display(quiet) as progress:
            shown = _checked(progress, check)
            stopped = go_on(store, found.id, _processes(workers), scheduler, shown, tell)
        counts, place = write_outputs(store, found.id, Path(found.folder), style)
        rows = [] if quiet else shown_rows(store, found.id, counts)
    if not quiet:
        print_summary(counts, rows, place, Path(found.folder), stopped)
    raise typer.Exit(_code(counts, stopped))


def _let_workers_go_on(store: Store, found: Job) -> None:
    """Open a job of a service again: workers of its database go on with it.

    Raises
    ------
    InputError
        The job has not ended, or is done.
    """
    if not store.resume(found.id, found.tenant, str(found.code)):
        raise InputError(
            "JOB", found.id, f"a job that was cancelled or stopped, or has failed; this one is {found.state}"
        )
    print(f"{found.id}: open again; the workers of its database go on with it")


def _stores(database: str | None, folders: list[Path] | None) -> list[Store]:
    """Return the databases that are meant: the one named, or those in folders."""
    from synth.batches.batch_folder import DATABASE
    from synth.batches.store import Store
    from synth.queue.database import file_url

    if database is not None and folders is None:
        return [Store(database, create=False)]
    files = [folder / DATABASE for folder in folders or [Path(), *sorted(p for p in Path().iterdir() if p.is_dir())]]
    if folders is not None:
        missing = next((file.parent for file in files if not file.is_file()), None)
        if missing is not None:
            raise InputError("DIR", str(missing), f"the folder of a batch, with {DATABASE} in it")
    return [Store(file_url(file.resolve()), create=False) for file in files if file.is_file()]


def _find(job: str, database: str | None) -> tuple[Store, Job]:
    """Return the job that is meant by a folder (its latest), or by the beginning of an id."""
    from synth.batches.batch_folder import DATABASE

    if database is None and (Path(job) / DATABASE).is_file():
        (store,) = _stores(None, [Path(job)])
        jobs = store.jobs()
        if jobs:
            return store, max(jobs, key=lambda found: found.updated)
        store.close()
    else:
        matches = []
        for store in _stores(database, None):
            matches += [(store, found) for found in store.jobs() if found.id.startswith(job)]
        if len(matches) == 1:
            return matches[0]
        if matches:
            raise InputError("JOB", job, "more of the id: it fits several jobs")
    raise InputError("JOB", job, "the folder of a batch, or the id of a job that clutchsynth jobs list shows")
