"""Files that users name, and how results are written: tables as CSV, and files that are never half-written."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import math
import os
import re
import stat
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TextIO

from synth.errors import InputError
from synth.system.operating_system import AS_BYTES, NO_WAIT, put_in_place
from synth.text.input_limits import INPUT_LIMITS
from synth.text.plain_text import UNSAFE, csv_cell, escaped, file_text

if TYPE_CHECKING:
    import pandas as pd

REFERENCE = re.compile(r"[^/\\]+@[0-9]+")  # of a table that is kept elsewhere, as questions name it
KINDS = {
    stat.S_ISDIR: "a folder",
    stat.S_ISFIFO: "a pipe",
    stat.S_ISSOCK: "a socket",
    stat.S_ISCHR: "a device",
    stat.S_ISBLK: "a device",
}


# ---- reading --------------------------------------------------------------------------------------------------------


def read_bytes(path: str | Path, field: str, right: str = "a file", most: int = INPUT_LIMITS.file) -> bytes:
    """Content of a file that a user has named.

    Parameters
    ----------
    path : path
    field : str
        What names it, for messages.
    right : str
        What it should be, for messages.
    most : int
        Bytes; no more than that is ever read.

    Raises
    ------
    InputError
        It is no regular file (a folder, a pipe, a device), is larger, or cannot be read.
    """
    with os.fdopen(_opened(path, field, right, most), "rb") as file:
        try:
            raw = file.read(most + 1)
        except OSError as error:
            raise InputError(field, str(path), f"{right} that can be read ({error.strerror})") from error
    if len(raw) > most:  # it grows while it is read, or its system tells no size
        _too_large(field, path, right, most)
    return raw


def read_text(path: str | Path, field: str, right: str = "a file", most: int = INPUT_LIMITS.file) -> str:
    """Return the text of a file, which is UTF-8.

    Raises
    ------
    InputError
        As for :func:`read_bytes`, and where it is no such text.
    """
    try:
        return read_bytes(path, field, right, most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(field, str(path), f"{right}, in UTF-8") from error


def open_bytes(path: str | Path, field: str, right: str = "a file") -> io.BufferedReader:
    """Open a file of any size that a user has named, to be read little by little.

    Raises
    ------
    InputError
        It is no regular file, or cannot be read.
    """
    return os.fdopen(_opened(path, field, right, None), "rb")


def _opened(path: str | Path, field: str, right: str, most: int | None) -> int:
    """Handle of a regular file that is not too large."""
    shown = str(path)
    try:
        handle = os.open(path, os.O_RDONLY | NO_WAIT | AS_BYTES)
    except FileNotFoundError:
        raise InputError(field, shown, f"{right} that exists (No such file or directory)") from None
    except (OSError, ValueError) as error:
        if isinstance(error, PermissionError) and Path(path).is_dir():  # where folders cannot be opened at all
            raise InputError(field, shown, f"{right} that can be read; this is a folder") from error
        reason = getattr(error, "strerror", None) or "not a possible file name"
        raise InputError(field, shown, f"{right} that can be read ({reason})") from error
    status = os.fstat(handle)
    if stat.S_ISREG(status.st_mode) and (most is None or status.st_size <= most):
        return handle
    os.close(handle)
    if most is not None and stat.S_ISREG(status.st_mode):
        _too_large(field, path, right, most)
    what = next((words for test, words in KINDS.items() if test(status.st_mode)), "something else")
    raise InputError(field, shown, f"{right} that can be read; this is {what}")


def read_json(path: str | Path, field: str, right: str, most: int = INPUT_LIMITS.file) -> Any:
    """Return the content of a JSON file, read strictly: finite numbers only.

    Raises
    ------
    InputError
        As for ``read_bytes``, or it is no JSON.
    """
    raw = read_bytes(path, field, right, most)
    try:
        text = raw.decode("utf-8")
        return json.loads(text, parse_constant=_no_number, parse_float=_finite, parse_int=_finite_integer)
    except RecursionError as error:
        raise InputError(field, str(path), f"{right}; this one is nested too deeply") from error
    except ValueError as error:
        raise InputError(field, str(path), f"{right}; this one is no JSON ({error})") from error


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"{word if len(word) <= 20 else word[:17] + '...'} is no finite number")


def _finite(word: str) -> float:
    number = float(word)
    return number if math.isfinite(number) else _no_number(word)


def _finite_integer(word: str) -> int:
    """Read a whole number, which may be used as a float."""
    _finite(word)
    return int(word)


def _too_large(field: str, path: str | Path, right: str, most: int) -> NoReturn:
    size = f"{most // 1_000_000} MB" if most > 1_000_000 else f"{most // 1000} kB"
    raise InputError(field, str(path), f"{right} of at most {size}")


# ---- writing --------------------------------------------------------------------------------------------------------


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table as CSV in full precision; nothing stands where there is no value."""
    buffer = io.StringIO()
    write = csv_writer(buffer)
    for row in (columns, *rows):
        write(row)
    return buffer.getvalue()


def csv_writer(file: TextIO) -> Callable[[Sequence[Any]], object]:
    """Writer of rows of cells into a file."""
    writer = csv.writer(file, lineterminator="\n")
    return lambda cells: writer.writerow([csv_cell(cell) for cell in cells])


def table_frame(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> pd.DataFrame:
    """Frame of a table."""
    import pandas as pd  # costly to import; most runs write CSV only

    return pd.DataFrame(rows, columns=list(columns))


def frame_csv(frame: pd.DataFrame, float_format: str | None = None) -> str:
    """Return a frame as CSV, without its index."""
    plain = frame.rename(columns=csv_cell)
    for k, kind in enumerate(plain.dtypes):
        if getattr(kind, "kind", "O") not in "biufcmM":  # text, or text among other things
            plain.isetitem(k, [csv_cell(cell) if isinstance(cell, str) else cell for cell in plain.iloc[:, k]])
    text: str = plain.to_csv(index=False, lineterminator="\n", float_format=float_format)
    return text


def named_from(source: str, folder: Path) -> str:
    """Return the name of a file as files in a folder call it; of what is no path on the same drive, what it was."""
    if not Path(source).is_absolute():
        return source
    with suppress(ValueError):  # on another drive
        return Path(os.path.relpath(source, folder.resolve())).as_posix()
    return source


def resolved_source(source: str, folder: Path) -> str:
    """Path of a file that is named relative to a folder; a reference (``my_linings@3``) is returned unchanged."""
    if Path(source).is_absolute() or REFERENCE.fullmatch(source):
        return source
    return str((folder / source).resolve())


def yaml_text(content: object) -> str:
    """Return a YAML text that reads back as it was, and acts on no terminal."""
    import yaml  # costly to import

    class Dumper(yaml.SafeDumper):
        """Puts text with characters that act on a terminal into quotes, where they are escaped."""

    def represented(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
        return dumper.represent_scalar("tag:yaml.org,2002:str", text, style='"' if UNSAFE.search(text) else None)

    Dumper.add_representer(str, represented)
    text: str = yaml.dump(content, Dumper=Dumper, sort_keys=False, allow_unicode=True, width=120)
    return escaped(text)


def write_atomically(path: Path, text: str) -> None:
    """Write a text file so that it is either the old one or the whole new one."""
    temporary = path.with_name(f".{path.name}.{hashlib.sha256(str(path).encode()).hexdigest()[:8]}.tmp")
    try:
        temporary.write_text(file_text(path.name, text), encoding="utf-8", newline="")
        put_in_place(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
