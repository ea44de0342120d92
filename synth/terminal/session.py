"""What the modules of the command line share: exit codes, and how it speaks, writes and refuses."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from synth.errors import InputError
from synth.files import frame_csv
from synth.output_folder import ResultKind, check_kind, check_not_held, claimed
from synth.plain_text import wrapped
from synth.results.drawings import report

if TYPE_CHECKING:
    import pandas as pd

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


def tell_readings(tables: Catalogs) -> None:
    """Say how files with own part tables were read that are not written as is expected."""
    for sentence in tables.readings():
        name, _, how = sentence.partition(": ")
        tell(f"read as {how}: {name}")


def pair(flag: str, text: str) -> tuple[str, str]:
    """Split name=value."""
    name, sign, value = text.partition("=")
    if not sign or not name.strip() or not value.strip():
        raise InputError(flag, text, "name=value")
    return name.strip(), value.strip()


def objectives(texts: list[str]) -> list[str] | dict[str, str] | None:
    """Return what repeated flags ask for: names, or names with min or max."""
    if not texts:
        return None
    if not any("=" in text for text in texts):
        return texts
    pairs = [pair("--objective", text) if "=" in text else (text, "") for text in texts]
    unsaid = [name for name, sense in pairs if not sense]
    if unsaid:
        raise InputError(
            "--objective", unsaid[0], f"{unsaid[0]}=min or {unsaid[0]}=max: all objectives with a sense, or none"
        )
    return dict(pairs)


def frame_files(frames: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """Return what frames are written as: file name -> text, a table and a drawing of each."""
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


def claim_output(folder: Path, kind: ResultKind | None = None, job: str = "") -> None:
    """Refuse a folder that cannot be written before the search, not after it; keep others out of it from now on.

    Parameters
    ----------
    folder : Path
    kind : ResultKind, optional
        What is written, where other commands have files of the same names.
    job : str
        The name of a job that several processes may work at.
    """
    check_output(folder)
    if kind is not None:
        check_kind(folder, kind)
        check_not_held(folder, kind)
    _for_this_command.enter_context(claimed(folder, job))


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
