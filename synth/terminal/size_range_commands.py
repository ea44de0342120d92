"""The command size-range."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from synth.folders.csv_style import csv_style
from synth.folders.output_folder import SIZE_RANGE, save_result
from synth.results.drawings import report
from synth.tables.table_file import read_as
from synth.terminal.batch_commands import Database, Workers, batch_job, finish
from synth.terminal.options import Csv, Encoding, Headings, Quiet, RowFamily, RowPoints, VisibleRows, takes
from synth.terminal.session import STOPPED, claim_output, rows_folder, tell_written
from synth.verbs.requests import BatchRequest, SizeRangeRequest


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command(name="size-range")(size_range)


@takes(SizeRangeRequest)
def size_range(
    asked: SizeRangeRequest,
    *,
    source: Annotated[
        Path, typer.Argument(help="The folder of a batch, or a table of rows to run first.", metavar="DIR|ROWS.csv")
    ],
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for the results; by default DIR or ROWS_batch.", metavar="DIR"),
    ] = None,
    family: RowFamily = None,
    mapping: Headings = None,
    points: RowPoints = BatchRequest.points,
    workers: Workers = None,
    database: Database = None,
    encoding: Encoding = None,
    visible_rows: VisibleRows = False,
    csv: Csv = "en",
    quiet: Quiet = False,
) -> None:
    """Choose the standard variants that serve all feasible rows of a batch."""
    from synth.variants.size_range import size_range as choose

    style = csv_style(csv, "--csv")
    job_id = None
    if not source.is_dir():
        place = rows_folder(source, folder)
        objectives = None if asked.objective is None else [asked.objective]
        searched = BatchRequest(family=family, points=points, objectives=objectives)
        rows = Path(read_as(str(source), encoding, visible_rows))
        job = batch_job(searched, rows, place, mapping, None, database, style)
        job_id = job.id
        code = finish(lambda: job, workers, None, quiet, named=folder is not None)
        if code == STOPPED:
            raise typer.Exit(code)
        source = place
    target = source if folder is None else folder
    claim_output(target)
    found = choose(source, database=database, job=job_id, **vars(asked))
    files = found.files()
    draw = report("figure")
    if draw is not None:
        files["curve.svg"] = draw(found.curve())
    save_result(target, style.files(files), SIZE_RANGE, False)
    if not quiet:
        from synth.terminal.size_range_console import print_size_range

        print_size_range(found)
        tell_written(target, target, sorted(files))
