"""The command line: ``clutchsynth``."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from synth.analysis.design_spec import design_of_spec, must_be_a_design, must_be_a_question, must_be_one_family
from synth.errors import DeclarationError, InputError, RefusedError, derived
from synth.folders.csv_style import csv_style
from synth.folders.files import frame_csv
from synth.folders.output_folder import EXPLANATION, EXPLANATION_TEXT, FRONT, save_files, save_result
from synth.question.request_fields import pair
from synth.question.spec_keys import A_DESIGN, A_QUESTION, ONE_FAMILY
from synth.results.drawings import PLOT, report
from synth.system.interrupts import sigterm_as_interrupt
from synth.system.operating_system import reader_has_gone
from synth.terminal import batch_commands as batches
from synth.terminal import (
    choice_commands,
    new_command,
    report_commands,
    robust_commands,
    service_commands,
    worker_commands,
)
from synth.terminal import size_range_commands as size_ranges
from synth.terminal import study_commands as studies
from synth.terminal.options import (
    Csv,
    Encoding,
    ExplainOptions,
    Family,
    Folder,
    FrontFolder,
    Plot,
    Quiet,
    SearchOptions,
    SpecFile,
    VisibleRows,
    takes,
)
from synth.terminal.plots import show_plot
from synth.terminal.session import (
    BAD_INPUT,
    DOES_NOT_HOLD,
    HELPS,
    INTERNAL,
    INTERRUPTED,
    NOT_PROVEN,
    STOPPED,
    as_csv,
    blamed_on,
    claim_output,
    derived_told,
    end,
    explaining,
    frame_files,
    one_command,
    own_tables,
    say,
    stopped_as,
    tell,
    tell_readings,
    tell_written,
)
from synth.text.notices import listening
from synth.text.plain_text import plain_streams
from synth.verbs.requests import VerifyRequest

if TYPE_CHECKING:
    from synth.model.problem import DesignProblem
    from synth.question.spec import Spec
    from synth.results import ParetoFront

app = typer.Typer(
    name="clutchsynth",
    help="Design synthesis for clutches and shaft couplings: requirement in, ranked Pareto designs out.",
    epilog="Exit codes: 0 designs found or check passed, 1 internal error, 2 bad input (nothing is written; "
    "report lacks an extra: the rest is), "
    "3 no feasible design or a limit violated, 4 stopped by time limit or Ctrl-C (what was found is saved), "
    "5 what verify checked does not hold, 6 verify could neither prove it again nor refute it.",
    add_completion=True,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

DesignFile = Annotated[Path, typer.Argument(help="A design: a spec with values and parts.", metavar="DESIGN.yaml")]


def main() -> None:
    """Run the command line; every fault of the input becomes one sentence and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without these letters must not stop the work
    with plain_streams():
        _run()


# What sentences for everybody leave out: the command that does what is wanted.
COMMANDS = {
    ONE_FAMILY: " (clutchsynth run compares several)",
    A_QUESTION: " (clutchsynth check reads it)",
    A_DESIGN: " (clutchsynth run takes one)",
}


def _run() -> None:
    try:
        with sigterm_as_interrupt(), one_command(), derived_told(), listening(tell):
            app(prog_name="clutchsynth")
    except InputError as error:
        tell(" ".join(f"{error}{COMMANDS.get(error.expected, '')}".split()))
        sys.exit(BAD_INPUT)
    except OSError as error:
        if reader_has_gone(error):  # ``| head``: there is nobody left to tell
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            sys.exit(INTERNAL)
        if error.filename is None:
            _give_up(error)
        tell(f"{error.filename}: got what cannot be read or written; expected a place where it can ({error.strerror})")
        sys.exit(BAD_INPUT)
    except SystemExit as end:
        if end.code != INTERRUPTED:
            raise
        _tell_stopped()
    except KeyboardInterrupt:
        _tell_stopped()
    except Exception as error:
        _give_up(error)


def _tell_stopped() -> NoReturn:
    tell("stopped before all was done; what is written stays, the same command begins again or goes on")
    sys.exit(STOPPED)


def _give_up(error: Exception) -> NoReturn:
    """Tell of a fault of the program itself, or of a family."""
    if os.environ.get("CLUTCHSYNTH_DEBUG") == "1":
        raise error
    if isinstance(error, DeclarationError):
        tell(str(error))
        tell("this is a fault of the family, not of the input: whoever wrote the family can mend it")
        sys.exit(INTERNAL)
    first = next(iter(str(error).splitlines()), "")
    tell(f"internal error, {type(error).__name__}: {first}")
    tell("this is a fault of the program: please report it, with the output that CLUTCHSYNTH_DEBUG=1 gives")
    sys.exit(INTERNAL)


# ---- commands -------------------------------------------------------------------------------------------------------


def _version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        print(f"clutchsynth {version('clutchsynth')}")
        raise typer.Exit


@app.callback()
def _entry(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    pass


@app.command()
def families(
    common: Annotated[bool, typer.Option("--common", help="List the requirements that several understand.")] = False,
) -> None:
    """List the design families."""
    from synth.model.registry import every_family

    if common:
        choice_commands.show_common()
        return
    listed = every_family()
    width = max((len(name) for name in listed), default=0)
    for name, problem in listed.items():
        print(f"{name:{width}}  {problem.title}")


@app.command()
def describe(
    *,
    family: Family,
    option: Annotated[
        list[str] | None, typer.Option("--option", help="A structural choice, name=value.", metavar="NAME=VALUE")
    ] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Write CSV.")] = False,
    every: Annotated[bool, typer.Option("--all", help="Show quantities on the way to others as well.")] = False,
) -> None:
    """Show what a family asks for, searches, computes and limits."""
    from synth.analysis.describe import described, tabulated
    from synth.terminal.console import output, print_description

    problem = _load(family, dict(pair("--option", text) for text in option or []))
    rows = described(problem, steps=every)
    if as_csv:
        print(frame_csv(tabulated(rows)), end="")
        return
    console = output()
    console.print(f"{problem.title} ({problem.name})")
    for source in problem.sources:
        console.print(f"  {source}")
    print_description(rows, console)


@app.command()
@takes(SearchOptions)
def run(
    options: SearchOptions,
    *,
    spec: SpecFile,
    folder: Folder = None,
    every: Annotated[bool, typer.Option("--all", help="Show all designs: near-equals, and more than ten.")] = False,
    more: Annotated[
        Path | None, typer.Option(help="Go on from the front in this folder, of the same question.", metavar="DIR")
    ] = None,
    plot: Plot = False,
    encoding: Encoding = None,
    visible_rows: VisibleRows = False,
    csv: Csv = "en",
    quiet: Quiet = False,
    verbose: Annotated[bool, typer.Option("--verbose", "-v", help="Show what the search did as well.")] = False,
) -> None:
    """Search the designs for a spec, show them ranked, and save them in a folder that is named."""
    begun = time.monotonic()
    from synth.question.spec import read_spec
    from synth.terminal.console import explanation_text

    style, every = csv_style(csv, "--csv"), every or options.points is not None
    asked = read_spec(spec).merged(**options.of_spec())
    must_be_a_question(asked)
    asked = asked.merged(catalogs=own_tables(asked.catalogs, asked.folder, encoding, visible_rows))
    claim_output(folder, FRONT)
    if asked.compares:
        if more is not None:
            raise InputError("--more", str(more), "a spec of one family")
        choice_commands.compare_families(asked, folder, every, quiet, plot, style)
        return
    front = _synthesize(spec, asked, quiet, begun, more)
    files: dict[str, str] = {}

    def record(place: Path | None) -> dict[str, str]:
        files.update(front.record_files(folder=place))
        return style.files(files)

    # The front is on the disk before anything is made from it.
    target = None
    if folder is None:
        record(None)
    else:
        target = save_result(folder, record, FRONT, bool(front.interrupted))
    made = front.derived_files(target)
    told = derived(EXPLANATION_TEXT, lambda: explanation_text(front)) if front.explanation is not None else None
    picture = derived(PLOT, front.svg) if plot else None
    made |= {name: text for name, text in ((EXPLANATION_TEXT, told), (PLOT, picture)) if text}
    if target is not None and made:
        save_files(target, made)
    files |= made
    if not quiet:
        _show(front, files, every, verbose, plot)
        if not front.designs:
            say(f"{HELPS}: {explaining(spec)}")
        tell_written(target, folder, _listed(files))
    end(front.interrupted, bool(front.designs))


@app.command()
@takes(ExplainOptions)
def explain(
    options: ExplainOptions, *, spec: SpecFile, folder: Folder = None, csv: Csv = "en", quiet: Quiet = False
) -> None:
    """Tell why nothing is feasible, over all parts and counts, and what would make it so."""
    from synth.question.spec import read_spec
    from synth.studies.infeasibility.explain import explanation_of
    from synth.terminal.console import output, print_explanation, progress_display

    style = csv_style(csv, "--csv")
    asked = read_spec(spec).merged(time_limit=options.time_limit)
    must_be_a_question(asked)
    must_be_one_family(asked)
    claim_output(folder, EXPLANATION)
    with blamed_on(asked.file), progress_display(quiet) as progress:
        request = asked.request()
        if not quiet:
            tell_readings(request.catalogs)
        found = explanation_of(request, asked.settings(), progress, options.physics)
    if not quiet:
        print_explanation(found, request.problem.title, output())
    if folder is not None:
        files = found.save(folder, style)
        if not quiet:
            tell_written(files[0].parent, folder, [file.name for file in files])
    end(found.interrupted, found.feasible)


@app.command()
def check(
    *,
    design: DesignFile,
    folder: Folder = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", help='Tell the state at an operating point, "speed=900 rpm".', metavar="NAME=VALUE"),
    ] = None,
    csv: Csv = "en",
) -> None:
    """Compute everything about a given design and test every limit; nothing is rounded or searched."""
    from synth.analysis.describe import described
    from synth.question.spec import read_spec
    from synth.terminal.console import check_table, output, print_check, print_state

    style = csv_style(csv, "--csv")
    asked = read_spec(design)
    must_be_a_design(asked)
    claim_output(folder)
    with blamed_on(asked.file):
        problem, catalogs, result = design_of_spec(asked)
        tell_readings(catalogs)
        details = described(problem, catalogs)
    found = None
    if at:
        from synth.analysis.operating_state import read_point, state_of

        found = state_of(problem, result, read_point(problem, dict(pair("--at", text) for text in at)))
    print_check(result, details, output())
    if found is not None:
        print_state(found, ", ".join(at or ()), output())
    if folder is not None:
        files = {"check.csv": check_table(result, details)}
        if found is not None:
            files["state.csv"] = as_csv(found)
        save_files(folder, style.files(files))
        print()
        say(f"written: {', '.join(str(folder / name) for name in files)}")
    end("", not result.violated)


@app.command()
def simulate(
    design: DesignFile,
    folder: Folder = None,
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", help="A setting of the simulation, name=value; repeat it.", metavar="NAME=VALUE"),
    ] = None,
    csv: Csv = "en",
) -> None:
    """Simulate a given design in time; draw it, and set what it finds beside the closed forms."""
    from synth.analysis.hooks import read_settings, second_opinion, simulate_design
    from synth.question.spec import read_spec
    from synth.terminal.console import output, print_simulation

    style = csv_style(csv, "--csv")
    asked = read_spec(design)
    must_be_a_design(asked)
    claim_output(folder)
    pairs = [pair("--set", text) for text in setting or []]
    for name, _ in pairs:
        if [other for other, _ in pairs].count(name) > 1:
            raise InputError("--set", name, "each setting once")
    with blamed_on(asked.file):
        problem, catalogs, result = design_of_spec(asked)
    tell_readings(catalogs)
    frames = simulate_design(problem, result, read_settings(problem, dict(pairs), catalogs))
    opinion = second_opinion(result, frames)
    files = {} if folder is None else frame_files(frames)
    if folder is not None:
        if len(opinion):
            files["second_opinion.csv"] = as_csv(opinion)
        save_files(folder, style.files(files))
    print_simulation(result, frames, opinion, output())
    tell_written(folder, folder, sorted(files))


@app.command()
def curves(
    family: Annotated[str, typer.Argument(help="Name of a family.", metavar="FAMILY")],
    spec: Annotated[
        Path, typer.Argument(help="A spec, or a design: a spec with values and parts.", metavar="SPEC.yaml")
    ],
    folder: Folder = None,
    csv: Csv = "en",
) -> None:
    """Draw the curves of a family for a spec, or for a given design."""
    from synth.analysis.hooks import curves as curves_of
    from synth.question.catalogs import catalogs_for
    from synth.question.spec import read_spec
    from synth.terminal.console import output, print_curves

    style = csv_style(csv, "--csv")
    asked = read_spec(spec)
    if asked.family != family:
        raise InputError("FAMILY", family, f"{asked.family}, the family of {asked.file}")
    claim_output(folder)
    with blamed_on(asked.file):
        if asked.values is None:
            problem = _load(asked.family, asked.options)
            catalogs = catalogs_for(problem, asked.catalogs, asked.folder)
            frames = curves_of(problem, asked.requirements, catalogs=catalogs)
        else:
            must_be_a_design(asked)
            problem, catalogs, result = design_of_spec(asked)
            frames = curves_of(problem, asked.requirements, result, catalogs=catalogs)
        tell_readings(catalogs)
    files = {} if folder is None else frame_files(frames)
    if folder is None:
        print_curves(frames, output())
    else:
        save_files(folder, style.files(files))
        for frame in frames.values():
            print(frame.attrs["title"])
    tell_written(folder, folder, sorted(files))


@app.command()
@takes(VerifyRequest)
def verify(asked: VerifyRequest, *, folder: FrontFolder) -> None:
    """Check a saved front without the search: its files, every design, and the proof of the certificate."""
    from synth.results.loading import unchecked_front
    from synth.terminal.console import output, print_verification
    from synth.verification.verify_comparison import is_comparison, verify_comparison

    if is_comparison(folder):
        verification = verify_comparison(folder, asked.time_limit)
    else:
        verification = unchecked_front(folder).verify(time_limit=asked.time_limit)
    print_verification(verification, output())
    if not verification.holds:
        raise typer.Exit(DOES_NOT_HOLD if verification.findings else NOT_PROVEN)


new_command.register(app)
batches.register(app)
size_ranges.register(app)
choice_commands.register(app)
studies.register(app)
robust_commands.register(app)
report_commands.register(app)
worker_commands.register(app)
service_commands.register(app)


# ---- what the commands share ----------------------------------------------------------------------------------------


def _load(family: str, options: Mapping[str, str]) -> DesignProblem:
    from synth.model.registry import load

    return load(family, **options)


def _synthesize(spec: Path, asked: Spec, quiet: bool, begun: float, more: Path | None) -> ParetoFront:
    """Search the designs for a spec; the time limit counts from ``begun``, and ``more`` is where to go on from."""
    from synth.results.loading import load_front
    from synth.search.improvement import improve_for
    from synth.search.synthesize import find_front
    from synth.terminal.console import progress_display

    given = None if more is None else load_front(more)
    stopped = stopped_as("stopped before the search began; nothing is written")
    with blamed_on(asked.file), progress_display(quiet) as progress:
        request = asked.request()
        if not quiet:
            tell_readings(request.catalogs)
        try:
            settings = asked.settings().since(begun)
            with stopped:
                if given is not None:
                    return improve_for(given, request, settings, "--more", progress)
                return find_front(request, settings, progress)
        except RefusedError as refusal:
            right = f"{refusal.expected} (what would help: {explaining(spec)})"
            raise InputError(refusal.field, refusal.value, right, refusal.path) from refusal


def _show(front: ParetoFront, files: Mapping[str, str], every: bool, verbose: bool, plot: bool) -> None:
    from synth.results.calculation import CALCULATION, Calculation
    from synth.terminal.console import explanation_text, output, print_outcome

    console = output()
    if front.designs:
        told = json.loads(files[CALCULATION]) if CALCULATION in files else None
        calculation = None if told is None else Calculation.from_json(told)
        (report("table") or _plain_table)(front, console, every, calculation)
    if plot:
        console.print()
        show_plot(front.designs, front.frame.objectives, console)
    explanation = files.get(EXPLANATION_TEXT, "")
    if "robust" in front.statistics and (front.designs or not explanation):
        from synth.terminal.robust_console import print_robust

        print_robust(front, console)
    if explanation:
        print(explanation_text(front, console.width), end="")
    print_outcome(front, console, verbose)


def _listed(files: Mapping[str, str]) -> list[str]:
    """Return the names of the files of a front, its designs as from .. to."""
    names = sorted(files)
    designs = [name for name in names if name.startswith("design_")]
    shown = [name for name in names if name not in designs]
    if designs:
        shown.append(designs[0] if len(designs) == 1 else f"{designs[0]} .. {designs[-1]}")
    return shown


def _plain_table(front: ParetoFront, console: object, every: bool, calculation: object) -> None:
    """Print objectives alone, and what is to be said of the first design, where reports are not installed."""
    names = list(front.frame.objectives)
    table = front.to_frame() if every else front.to_frame().head(10)
    print(table.iloc[:, [0, 1, *range(6, 6 + len(names))]].to_string(index=False))
    for remark in (*front.designs[0].bare_advice, *front.designs[0].not_checked):
        print(f"remark on #1: {remark}")
