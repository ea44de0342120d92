"""The command line: ``clutchsynth``."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from synth.errors import InputError

if TYPE_CHECKING:
    import pandas as pd

    from synth.problem import DesignProblem
    from synth.results import Design, ParetoFront
    from synth.spec import Spec
    from synth.tables import Catalogs

FOUND, INTERNAL, BAD_INPUT, INFEASIBLE, STOPPED, DOES_NOT_HOLD = 0, 1, 2, 3, 4, 5
REPORTS = "clutchsynth.reports"

app = typer.Typer(
    name="clutchsynth",
    help="Design synthesis for clutches and shaft couplings: requirement in, ranked Pareto designs out.",
    epilog="Exit codes: 0 designs found or check passed, 1 internal error, 2 bad input (nothing is written), "
    "3 no feasible design or a limit violated, 4 stopped by time limit or Ctrl-C (what was found is saved), "
    "5 what verify checked does not hold.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

SpecFile = Annotated[Path, typer.Argument(help="A spec, YAML or JSON.", metavar="SPEC.yaml")]
DesignFile = Annotated[Path, typer.Argument(help="A design: a spec with values and parts.", metavar="DESIGN.yaml")]
Folder = Annotated[Path, typer.Option("--output", "-o", help="Folder for the results.", metavar="DIR")]


def main() -> None:
    """Run the command line; every fault of the input becomes one sentence and exit code 2."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="replace")  # a terminal without these letters must not stop the work
    try:
        app()
    except InputError as error:
        _tell(" ".join(str(error).split()))
        sys.exit(BAD_INPUT)
    except BrokenPipeError:
        # Whoever read the output has gone (``| head``); there is nobody left to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(INTERNAL)
    except Exception as error:
        if os.environ.get("CLUTCHSYNTH_DEBUG") == "1":
            raise
        first = next(iter(str(error).splitlines()), "")
        _tell(f"internal error, {type(error).__name__}: {first}")
        _tell("this is a fault of the program: please report it, with the output that CLUTCHSYNTH_DEBUG=1 gives")
        sys.exit(INTERNAL)


def _tell(sentence: str) -> None:
    print(f"clutchsynth: {sentence}", file=sys.stderr)


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
def families() -> None:
    """List the design families."""
    from synth.problem import families as names
    from synth.problem import load

    listed = names()
    width = max((len(name) for name in listed), default=0)
    for name in listed:
        print(f"{name:{width}}  {load(name).title}")


@app.command()
def describe(
    family: Annotated[str, typer.Argument(help="Name of a family.", metavar="FAMILY")],
    option: Annotated[
        list[str] | None, typer.Option("--option", help="A structural choice, name=value.", metavar="NAME=VALUE")
    ] = None,
    as_csv: Annotated[bool, typer.Option("--csv", help="Write CSV.")] = False,
) -> None:
    """Show what a family asks for, searches, computes and limits."""
    from synth.console import output, print_description
    from synth.description import describe as describe_problem

    problem = _load(family, dict(_pair("--option", text) for text in option or []))
    table = describe_problem(problem)
    if as_csv:
        table.to_csv(sys.stdout, index=False, lineterminator="\n")
        return
    console = output()
    console.print(f"{problem.title} ({problem.name})")
    for source in problem.sources:
        console.print(f"  {source}")
    print_description(table, console)


@app.command()
def run(
    spec: SpecFile,
    folder: Folder,
    points: Annotated[int | None, typer.Option(help="At most this many designs.")] = None,
    gap: Annotated[float | None, typer.Option(help="How far from proven a design may be, as a fraction.")] = None,
    grid: Annotated[bool | None, typer.Option("--grid/--no-grid", help="Makeable sizes only.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the random starts.")] = None,
    time_limit: Annotated[str | None, typer.Option(help="Stop after this time, in seconds or such as '2 min'.")] = None,
    workers: Annotated[int | None, typer.Option(help="Processes to use.")] = None,
    objective: Annotated[
        list[str] | None,
        typer.Option(
            "--objective", help="An objective, name or name=min or name=max; repeat it.", metavar="NAME[=SENSE]"
        ),
    ] = None,
    every: Annotated[bool, typer.Option("--all", help="Show all designs, not only the first ten.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Write the files, show nothing.")] = False,
) -> None:
    """Search the designs for a spec, show them ranked and save them."""
    from synth.spec import read_spec

    asked = read_spec(spec).merged(
        points=points, gap=gap, grid=grid, seed=seed, time_limit=time_limit, workers=workers,
        objectives=_objectives(objective or []),
    )  # fmt: skip
    if asked.values is not None:
        raise InputError(
            f"{asked.file}: values",
            ", ".join(asked.values),
            "a question without values; clutchsynth check reads a given design",
        )
    _check_output(folder)
    front = _synthesize(asked, quiet)
    front.save(folder)
    explanation = _write_explanation(front, folder)
    if not quiet:
        _show(front, folder, explanation, every)
    if front.interrupted:
        raise typer.Exit(STOPPED)
    if not front.designs:
        raise typer.Exit(INFEASIBLE)


@app.command()
def check(
    design: DesignFile,
    folder: Annotated[Path | None, typer.Option("--output", "-o", help="Folder for check.csv.", metavar="DIR")] = None,
) -> None:
    """Compute everything about a given design and test every limit; nothing is rounded or searched."""
    from synth.console import output, print_check, write_check
    from synth.description import describe as describe_problem
    from synth.spec import read_spec

    asked = read_spec(design)
    _must_be_a_design(asked)
    if folder is not None:
        _check_output(folder)
    with _blamed_on(asked.file):
        problem, catalogs, result = _given_design(asked)
        details = describe_problem(problem, catalogs).to_dict("records")
    print_check(result, details, output())
    if folder is not None:
        print(f"\nwritten: {write_check(result, details, folder)}")
    if result.violated:
        raise typer.Exit(INFEASIBLE)


@app.command()
def simulate(
    design: DesignFile,
    folder: Folder,
    setting: Annotated[
        list[str] | None,
        typer.Option("--set", help="A setting of the simulation, name=value; repeat it.", metavar="NAME=VALUE"),
    ] = None,
) -> None:
    """Simulate a given design in time; draw it, and set what it finds beside the closed forms."""
    from synth.console import output, print_simulation
    from synth.hooks import read_settings, second_opinion, simulate_design
    from synth.spec import read_spec

    asked = read_spec(design)
    _must_be_a_design(asked)
    _check_output(folder)
    pairs = [_pair("--set", text) for text in setting or []]
    for name, _ in pairs:
        if [other for other, _ in pairs].count(name) > 1:
            raise InputError("--set", name, "each setting once")
    with _blamed_on(asked.file):
        problem, catalogs, result = _given_design(asked)
    frames = simulate_design(problem, result, read_settings(problem, dict(pairs), catalogs))
    opinion = second_opinion(result, frames)
    files = _frame_files(frames)
    if len(opinion):
        files["second_opinion.csv"] = _as_csv(opinion)
    _write_all(folder, files)
    print_simulation(result, frames, opinion, output())
    print(f"written to {folder}: {', '.join(sorted(files))}")


@app.command()
def curves(
    family: Annotated[str, typer.Argument(help="Name of a family.", metavar="FAMILY")],
    spec: Annotated[
        Path, typer.Argument(help="A spec, or a design: a spec with values and parts.", metavar="SPEC.yaml")
    ],
    folder: Folder,
) -> None:
    """Draw the curves of a family for a spec, or for a given design."""
    from synth.hooks import curves as curves_of
    from synth.instance import catalogs_for
    from synth.spec import read_spec

    asked = read_spec(spec)
    if asked.family != family:
        raise InputError("FAMILY", family, f"{asked.family}, the family of {asked.file}")
    _check_output(folder)
    with _blamed_on(asked.file):
        if asked.values is None:
            problem = _load(asked.family, asked.options)
            catalogs = catalogs_for(problem, asked.catalogs, asked.folder)
            frames = curves_of(problem, asked.requirements, catalogs=catalogs)
        else:
            _must_be_a_design(asked)
            problem, catalogs, result = _given_design(asked)
            frames = curves_of(problem, asked.requirements, result, catalogs=catalogs)
    files = _frame_files(frames)
    _write_all(folder, files)
    for frame in frames.values():
        print(frame.attrs["title"])
    print(f"written to {folder}: {', '.join(sorted(files))}")


@app.command()
def verify(
    folder: Annotated[Path, typer.Argument(help="A folder that run has written.", metavar="DIR")],
    time_limit: Annotated[
        str | None, typer.Option(help="Give the proof up after this time, in seconds or such as '2 min'.")
    ] = None,
) -> None:
    """Check a saved front without the search: its files, every design, and the proof of the certificate."""
    from synth.console import output, print_verification
    from synth.results import load_front
    from synth.units import parse_quantity

    front = load_front(folder)
    limit = {} if time_limit is None else {"time_limit": parse_quantity(time_limit, "s", "--time-limit")}
    verification = front.verify(**limit)
    print_verification(verification, output())
    if not verification.holds:
        raise typer.Exit(DOES_NOT_HOLD)


# ---- what the commands share ----------------------------------------------------------------------------------------


def _load(family: str, options: Mapping[str, str]) -> DesignProblem:
    from synth.problem import load

    return load(family, **options)


def _pair(flag: str, text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise InputError(flag, text, "name=value")
    return name.strip(), value.strip()


def _objectives(texts: list[str]) -> list[str] | dict[str, str] | None:
    if not texts:
        return None
    if not any("=" in text for text in texts):
        return texts
    pairs = [_pair("--objective", text) if "=" in text else (text, "") for text in texts]
    unsaid = [name for name, sense in pairs if not sense]
    if unsaid:
        raise InputError(
            "--objective", unsaid[0], f"{unsaid[0]}=min or {unsaid[0]}=max: all objectives with a sense, or none"
        )
    return dict(pairs)


def _must_be_a_design(asked: Spec) -> None:
    """Refuse a spec without values, or with something left to fix."""
    if asked.values is None:
        raise InputError(
            f"{asked.file}: values",
            None,
            "the variables, counts and choices of the design (clutchsynth run takes a question)",
        )
    if asked.fix:
        raise InputError(
            f"{asked.file}: fix", ", ".join(asked.fix), "these under values: a given design has nothing left to fix"
        )


def _given_design(asked: Spec) -> tuple[DesignProblem, Catalogs, Design]:
    """Load the problem and evaluate the design that a spec with values describes."""
    from synth.analysis import evaluate
    from synth.instance import catalogs_for

    problem = _load(asked.family, asked.options)
    catalogs = catalogs_for(problem, asked.catalogs, asked.folder)
    design = evaluate(
        problem, asked.requirements, values=asked.values, parts=_one_each(asked),
        catalogs=catalogs, limits=asked.limits, objectives=asked.objectives,
    )  # fmt: skip
    return problem, catalogs, design


def _frame_files(frames: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """Return what frames are written as: file name -> text, a table and a drawing of each."""
    draw = _report("figure")
    files = {}
    for key, frame in frames.items():
        files[f"{key}.csv"] = _as_csv(frame)
        if draw is not None:
            files[f"{key}.svg"] = draw(frame)
    return files


def _as_csv(frame: pd.DataFrame) -> str:
    text: str = frame.to_csv(index=False, lineterminator="\n", float_format="%.10g")
    return text


def _write_all(folder: Path, files: Mapping[str, str]) -> None:
    """Write files that are all complete before the first one is touched."""
    from synth.results import write_atomically

    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            write_atomically(folder / name, text)
    except OSError as error:
        raise InputError("--output", str(folder), f"a folder that can be written ({error.strerror})") from error


def _one_each(asked: Spec) -> dict[str, str]:
    """Return the designation per slot; a list of one counts as that one."""
    result = {}
    for slot, rule in asked.parts.items():
        rows = [rule] if isinstance(rule, str) else list(rule)
        if len(rows) != 1:
            raise InputError(
                f"{asked.file}: parts: {slot}", rows, "one designation: a given design has one part in each slot"
            )
        result[slot] = rows[0]
    return result


@contextmanager
def _blamed_on(file: str) -> Iterator[None]:
    """Put the name of the file in front of what is wrong in it."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{file}: {error.field}", error.value, error.expected) from error


def _check_output(folder: Path) -> None:
    """Refuse a folder that cannot be written before the search, not after it."""
    if str(folder) in ("", "."):
        raise InputError("--output", str(folder), "the name of a folder for the results, for example out/")
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise InputError("--output", str(folder), f"a folder; {place} is a file")
    if not os.access(place, os.W_OK | os.X_OK):
        raise InputError("--output", str(folder), f"a folder that can be written; {place} is read-only for you")


def _synthesize(asked: Spec, quiet: bool) -> ParetoFront:
    from synth.console import progress_display
    from synth.instance import catalogs_for
    from synth.search import synthesize

    with _blamed_on(asked.file), progress_display(quiet) as progress:
        problem = _load(asked.family, asked.options)
        catalogs = catalogs_for(problem, asked.catalogs, asked.folder)
        try:
            return synthesize(
                problem, asked.requirements, catalogs=catalogs, progress=progress, **asked.search_settings()
            )
        except KeyboardInterrupt:
            _tell("stopped before the search began; nothing is written")
            raise typer.Exit(STOPPED) from None


def _write_explanation(front: ParetoFront, folder: Path) -> str:
    """Keep explanation.txt beside the front where nothing is feasible, and only there."""
    from synth.console import explanation_text
    from synth.results import write_atomically

    path = folder / "explanation.txt"
    if front.explanation is None:
        path.unlink(missing_ok=True)
        return ""
    text = explanation_text(front)
    write_atomically(path, text)
    return text


def _show(front: ParetoFront, folder: Path, explanation: str, every: bool) -> None:
    from synth.console import output, print_outcome

    console = output()
    if front.designs:
        (_report("table") or _plain_table)(front, console, every)
    if explanation:
        print(explanation, end="")
    print_outcome(front, console)
    files = sorted(path.name for path in folder.iterdir() if path.is_file() and not path.name.startswith("."))
    designs = [name for name in files if name.startswith("design_")]
    shown = [name for name in files if name not in designs and name in ("designs.csv", "front.json", "explanation.txt")]
    if designs:
        shown.append(designs[0] if len(designs) == 1 else f"{designs[0]} .. {designs[-1]}")
    console.print(f"written to {folder}: {', '.join(shown)}", soft_wrap=True)


def _report(name: str) -> Callable[..., Any] | None:
    """Return a report by its registered name; None where it is not installed."""
    from importlib.metadata import entry_points

    for point in entry_points(group=REPORTS):
        if point.name == name:
            found: Callable[..., Any] = point.load()
            return found
    return None


def _plain_table(front: ParetoFront, console: Any, every: bool) -> None:
    names = list(front.frame.objectives)
    table = front.to_frame() if every else front.to_frame().head(10)
    print(table.iloc[:, [0, 1, *range(6, 6 + len(names))]].to_string(index=False))
