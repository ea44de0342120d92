"""What the modules of the command line share: exit codes, and how it speaks, writes and refuses."""

from __future__ import annotations

import os
import shlex
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TextIO

import typer

from synth.errors import DerivedFileWarning, InputError
from synth.folders.csv_style import CsvStyle
from synth.folders.files import frame_csv
from synth.folders.output_folder import ResultKind, check_kind, check_not_held, claimed
from synth.results.drawings import report
from synth.tables.table_file import table_file
from synth.text.plain_text import wrapped

if TYPE_CHECKING:
    import pandas as pd

    from synth.question.arguments import UserTables
    from synth.tables.catalogs import Catalogs

FOUND, INTERNAL, BAD_INPUT, INFEASIBLE, STOPPED, DOES_NOT_HOLD, NOT_PROVEN = 0, 1, 2, 3, 4, 5, 6
INTERRUPTED = 130  # what the command line's library ends with after Ctrl-C


def tell(sentence: str) -> None:
    """Say something beside the results: on standard error, where that is a terminal on lines no wider than it."""
    lines = [f"clutchsynth: {sentence}"]
    if sys.stderr.isatty():
        from synth.terminal.console import console_on

        lines = wrapped(lines[0], console_on(sys.stderr).width, later=4, broken=False)
    print("\n".join(lines), file=sys.stderr)


@contextmanager
def derived_told() -> Iterator[None]:
    """Tell in one sentence each which files could not be made from a result; other warnings are shown as ever."""
    told: set[str] = set()
    with warnings.catch_warnings():
        others = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if not issubclass(category, DerivedFileWarning):
                others(message, category, filename, lineno, file, line)
            elif str(message) not in told:
                told.add(str(message))
                tell(str(message))

        warnings.simplefilter("always", DerivedFileWarning)
        warnings.showwarning = show
        yield


def tell_readings(tables: Catalogs) -> None:
    """Say how files with own part tables were read that are not written as is expected, and what differs in them."""
    for sentence in tables.differences():
        tell(sentence)
    for sentence in tables.readings():
        name, _, how = sentence.partition(": ")
        tell(f"read as {how}: {name}")


def own_tables(catalogs: UserTables, base: Path, encoding: str | None, visible: bool) -> Any:
    """Return own tables, as flags or a spec name them, with how other flags say that their files are read."""
    if catalogs is None or not (encoding or visible):
        return catalogs
    from synth.tables.catalogs import with_reading_options  # NumPy comes with it; --help does without

    return with_reading_options(catalogs, base, encoding, visible)


def frame_files(frames: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """Files for frames: file name -> text, a table and a drawing of each."""
    draw = report("figure")
    files = {}
    for key, frame in frames.items():
        files[f"{key}.csv"] = as_csv(frame)
        if draw is not None:
            files[f"{key}.svg"] = draw(frame)
    return files


def as_csv(frame: pd.DataFrame) -> str:
    """Return a frame as CSV."""
    return frame_csv(frame, "%.10g")


def tell_written(target: Path | None, folder: Path | None, files: Iterable[str]) -> None:
    """Say where a result was written, and that an earlier one still stands where this one was stopped."""
    if target is None:
        print("nothing is written; -o DIR keeps the result")
        return
    say(f"written to {target}: {', '.join(files)}")
    if target != folder:
        say(f"the earlier result in {folder} stays as it was, as this one is not finished")


class _Result(Protocol):
    def save(self, folder: Path, csv: CsvStyle) -> Path: ...
    def files(self) -> Mapping[str, str]: ...


def hand_over(result: _Result, folder: Path | None, csv: CsvStyle, show: Callable[[], object] | None) -> None:
    """Save a result where a folder is named, and show it where there is something that shows."""
    target = None if folder is None else result.save(folder, csv)
    if show is not None:
        show()
        tell_written(target, folder, [] if target is None else sorted(result.files()))


def end(interrupted: str, holds: bool = True) -> None:
    """End a command with the code of a result that was interrupted, or has no design that holds."""
    if interrupted or not holds:
        raise typer.Exit(STOPPED if interrupted else INFEASIBLE)


@contextmanager
def stopped_as(sentence: str) -> Iterator[None]:
    """Say a sentence where Ctrl-C stops what is done inside, and end."""
    try:
        yield
    except KeyboardInterrupt:
        tell(sentence)
        raise typer.Exit(STOPPED) from None


HELPS = "which limits exclude each other, and what would help"


def explaining(spec: Path) -> str:
    """Return the command that tells why nothing is feasible, and what would help."""
    return f"clutchsynth explain {shlex.quote(str(spec))}"


def say(sentence: str) -> None:
    """Print a sentence on lines no wider than the terminal; names of files stay whole."""
    from synth.terminal.console import output

    lines = wrapped(sentence, output().width, later=4, broken=False)
    print("\n".join(lines))


@contextmanager
def blamed_on(file: str) -> Iterator[None]:
    """Put the name of the file in front of what is wrong in it."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{file}: {error.field}", error.value, error.expected, error.path) from error


_for_this_command = ExitStack()


@contextmanager
def one_command() -> Iterator[None]:
    """Run a command; folders that it keeps others out of are free again when it ends."""
    with _for_this_command:
        yield


def claim_output(
    folder: Path | None, kind: ResultKind | None = None, job: str = "", source: Path | None = None
) -> None:
    """Refuse a folder that cannot be written before the search, not after it; keep others out of it from now on.

    Parameters
    ----------
    folder : Path, optional
        Without one nothing will be written.
    kind : ResultKind, optional
        What is written, where other commands have files of the same names.
    job : str
        The name of a job that several processes may work at.
    source : Path, optional
        The folder that is read, where its files would be lost.
    """
    if folder is None:
        return
    check_output(folder)
    if source is not None and folder.resolve() == source.resolve():
        raise InputError("--output", str(folder), "another folder than that of the front: its designs would be lost")
    if kind is not None:
        check_kind(folder, kind)
        check_not_held(folder, kind)
    _for_this_command.enter_context(claimed(folder, job))


def tell_not_kept(folder: Path | None, quiet: bool) -> None:
    """Say of what goes on from its folder that without one it cannot, before time is spent."""
    if folder is None and not quiet:
        tell("without -o DIR nothing is kept: if this is stopped, the same command begins anew")


def rows_folder(rows: Path, folder: Path | None) -> Path:
    """Return the folder for what becomes of the rows of a table, which are worked off in it: by default beside it."""
    if folder is not None:
        return folder
    file = table_file(rows).path
    return file.with_name(f"{file.stem}_batch")


def check_output(folder: Path) -> None:
    """Refuse a folder that cannot be written."""
    if str(folder) in ("", "."):
        raise InputError("--output", str(folder), "the name of a folder for the results, for example out/")
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        raise InputError("--output", str(folder), f"a folder; {place} is a file")
    if not os.access(place, os.W_OK | os.X_OK):
        raise InputError("--output", str(folder), f"a folder that can be written; {place} is read-only for you")
