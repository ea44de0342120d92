"""The command that hands results on: report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from synth.errors import InputError
from synth.terminal.batch_commands import Database
from synth.terminal.options import Quiet, option
from synth.terminal.session import BAD_INPUT, INFEASIBLE, check_output, tell, tell_readings, tell_written
from synth.verbs.request import as_flag
from synth.verbs.requests import FrontReportRequest

if TYPE_CHECKING:
    from synth.analysis.reporting import WrittenReport
    from synth.results.report_request import ReportOptions

FIELDS = FrontReportRequest.fields()
FILES = (".yaml", ".yml", ".json")
SUMMARY, JOBS = "batch.json", "jobs.sqlite"  # by which the folder of a batch is known
OPTION = {"svg": "drawing"}  # of formats that are called otherwise


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command(name="report")(report)


def report(
    *,
    source: Annotated[
        Path, typer.Argument(help="A folder that run or batch has written, or a DESIGN.yaml.", metavar="SOURCE")
    ],
    folder: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for the files, by default that of the source.", metavar="DIR"),
    ] = None,
    design: Annotated[str | None, option(FIELDS["design"])] = None,
    full: Annotated[
        int | None, option(FIELDS["full"], help="Designs that report.html tells in full, 5 by default.", min=0)
    ] = None,
    row: Annotated[
        str | None,
        typer.Option(
            help="Of a batch the row that is told in full: its line or name; by default the first with designs.",
            metavar="NAME|LINE",
        ),
    ] = None,
    explorer: Annotated[bool, typer.Option("--explorer", help="The front to explore, as explorer.html.")] = False,
    as_pdf: Annotated[bool, typer.Option("--pdf", help="PDF as well (extra pdf).")] = False,
    as_xlsx: Annotated[bool, typer.Option("--xlsx", help="Live workbooks and designs.xlsx (extra excel).")] = False,
    as_svg: Annotated[bool, typer.Option("--drawing", help="Drawings of the chosen designs, as SVG.")] = False,
    as_dxf: Annotated[bool, typer.Option("--dxf", help="The same drawings for CAD, as DXF (extra dxf).")] = False,
    as_step: Annotated[
        bool, typer.Option("--step", help="Round parts of the drawings as bodies, STEP and glTF (extra step).")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Sheets for programs as well.")] = False,
    about: Annotated[
        Path | None, typer.Option(help="YAML: project, customer, number, author, date, ...", metavar="FILE")
    ] = None,
    length: Annotated[str, option(FIELDS["length"])] = FrontReportRequest.length,
    fonts: Annotated[
        list[Path] | None,
        typer.Option("--font-path", help="A font, or a folder of fonts, for PDF; repeat it.", metavar="PATH"),
    ] = None,
    database: Database = None,
    quiet: Quiet = False,
) -> None:
    """Write what can be handed on: the report of a front or a batch, calculation sheets, drawings, PDF, workbooks."""
    wanted = {"explorer": explorer, "pdf": as_pdf, "xlsx": as_xlsx, "svg": as_svg, "dxf": as_dxf}
    wanted |= {"step": as_step, "glb": as_step, "json": as_json}
    if fonts and not as_pdf:
        raise InputError("--font-path", str(fonts[0]), "--pdf as well: only PDF takes fonts")
    if folder is not None:
        check_output(folder)
    if source.name == SUMMARY and source.is_file():
        source = source.parent
    from synth.results.report_request import ReportOptions

    formats = ["html", *(word for word, on in wanted.items() if on)]
    how = ReportOptions.read(formats, _about(about), length, fonts or (), None if about is None else about.parent)
    of_fronts = (("--design", design), ("--full", full))
    flags = (*of_fronts, *((f"--{OPTION.get(word, word)}", on or None) for word, on in wanted.items()))
    if _is_batch(source):
        _refuse(flags, "no option of fronts alone: a batch has report.html, --pdf and --xlsx", ("--pdf", "--xlsx"))
        if length != FrontReportRequest.length:
            raise InputError("--length", length, "the folder of a front with it: a batch has no sheets")
        target = folder or source
        written = _of_batch(source, target, row, how, database)
    elif row is not None:
        raise InputError("--row", row, "the folder of a batch with it")
    elif source.suffix in FILES and source.is_file() and source.name != "front.json":
        for flag, value in (*of_fronts, ("--explorer", explorer or None)):
            if value is not None:
                raise InputError(flag, value, f"the folder of a front with it: {source.name} is one design")
        target = folder or source.parent
        written = _of_design(source, target, how, quiet)
    else:
        target = folder or (source if source.is_dir() else source.parent)
        typed_fields = {"design": design or None, "full": full}
        written = _of_front(source, target, FrontReportRequest.read(typed_fields, as_flag, typed=True), how)
    if not quiet:
        tell_written(written.folder, target, written.files)
    for note in (*written.notes, *map(str, written.lacking)):
        tell(note)
    if written.lacking:
        raise typer.Exit(BAD_INPUT)
    if not written.feasible:
        raise typer.Exit(INFEASIBLE)


def _about(file: Path | None) -> Any:
    """About block of a report, read from a file."""
    from synth.question.spec import read_content

    return None if file is None else read_content(file, "about")


def _is_batch(source: Path) -> bool:
    """True if a folder is that of a batch, without importing what batches need where it is not."""
    from synth.folders.output_folder import settle
    from synth.results.front_record import FRONT_FILE
    from synth.results.loading import COMPARISON

    if not source.is_dir():
        return False
    settle(source)
    if any((source / name).is_file() for name in (FRONT_FILE, COMPARISON)):
        return False
    return any((source / name).is_file() for name in (SUMMARY, JOBS))


def _refuse(flags: Sequence[tuple[str, Any]], right: str, but: Sequence[str]) -> None:
    """Refuse flags that what is reported does not take."""
    for flag, value in flags:
        if value is not None and flag not in but:
            raise InputError("report", flag, right) if value is True else InputError(flag, value, right)


def _of_batch(source: Path, target: Path, row: str | None, how: ReportOptions, database: str | None) -> WrittenReport:
    """Write the report of a batch."""
    from synth.batches.batch_report import BatchOptions, report_batch

    return report_batch(source, target, BatchOptions((row or "").strip(), how), database)


def _of_front(source: Path, target: Path, request: FrontReportRequest, how: ReportOptions) -> WrittenReport:
    """Write the report of a front, or of several families."""
    from synth.analysis.reporting import report as write
    from synth.analysis.reporting import report_comparison
    from synth.results.loading import COMPARISON, load_front

    if (source / COMPARISON).is_file():
        return report_comparison(source, target, how, design=request.design, full=request.full)
    return write(load_front(source), target, how, design=request.design, full=request.full)


def _of_design(source: Path, target: Path, how: ReportOptions, quiet: bool) -> WrittenReport:
    """Write the sheet of a design that stands in a file."""
    from synth.analysis.design_spec import design_of_spec, must_be_a_design
    from synth.analysis.reporting import report_design
    from synth.question.instance import Instance
    from synth.question.request import Request
    from synth.question.spec import read_spec

    spec = read_spec(source)
    must_be_a_design(spec)
    problem, catalogs, design = design_of_spec(spec)
    if not quiet:
        tell_readings(catalogs)
    instance = Instance(Request.of(problem, spec.requirements, catalogs, limits=spec.limits), restrict=False)
    return report_design(design, instance, target, how, name=source.stem)
