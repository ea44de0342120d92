"""How results are written: tables as CSV, and files that are never half-written."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from synth.errors import InputError


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table as CSV in full precision; nothing stands where there is no value."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(columns)
    for row in rows:
        writer.writerow(["" if cell is None else repr(cell) if isinstance(cell, float) else cell for cell in row])
    return buffer.getvalue()


def save_files(folder: str | Path, files: Mapping[str, str]) -> Path:
    """Write the files of a result and take away designs of an earlier one; return the folder.

    Every file is written beside its place and then renamed, so nothing half-written is ever seen.
    """
    target = Path(folder)
    if target.exists() and not target.is_dir():
        raise InputError("output", str(folder), "a folder; this is a file")
    try:
        target.mkdir(parents=True, exist_ok=True)
        for stale in [*target.glob("design_*.yaml"), target / "robust.csv"]:
            if stale.name not in files:
                stale.unlink(missing_ok=True)
        for name, text in files.items():
            write_atomically(target / name, text)
    except OSError as error:
        raise InputError("output", str(folder), f"a folder that can be written ({error.strerror})") from error
    return target


def write_atomically(path: Path, text: str) -> None:
    """Write a text file so that it is either the old one or the whole new one."""
    temporary = path.with_name(f".{path.name}.{hashlib.sha256(str(path).encode()).hexdigest()[:8]}.tmp")
    try:
        temporary.write_text(text, encoding="utf-8", newline="")
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
