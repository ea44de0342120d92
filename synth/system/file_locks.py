"""Files that a process has to itself, by locks that end with the process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from synth.system import operating_system
from synth.system.operating_system import SAFELY, lock


@contextmanager
def alone(path: Path) -> Iterator[bool]:
    """Keep others out for the block, by a file that is there as long; tell whether nobody else was there before.

    Parameters
    ----------
    path : Path
        Of the file that is locked, in a folder that is there.
    """
    handle = locked(path)
    try:
        yield handle is not None
    finally:
        if handle is not None:
            unlock(path, handle)


def locked(path: Path) -> int | None:
    """Return the handle of a file that is locked now; None where another has it, or it cannot be written."""
    while True:
        try:
            handle = os.open(path, os.O_RDWR | os.O_CREAT | SAFELY, 0o666)
        except OSError:
            return None
        taken = False
        try:
            taken = lock(handle, shared=False)
            if taken and is_at(handle, path):
                return handle
        except OSError:
            taken = False
        os.close(handle)
        if not taken:
            return None  # otherwise whoever had it has just taken it away


def is_taken(path: Path) -> bool:
    """True if another process has a file to itself."""
    try:
        handle = os.open(path, os.O_RDWR | SAFELY)
    except OSError:
        return False
    try:
        return not lock(handle, shared=True)
    except OSError:
        return False
    finally:
        os.close(handle)


def unlock(path: Path, handle: int) -> None:
    """Let go of a locked file; the last one takes it away."""
    last = False
    with suppress(OSError):
        last = lock(handle, shared=False) and is_at(handle, path)
        if last and operating_system.OPEN_FILES_CAN_GO:
            path.unlink()
    os.close(handle)
    if last and not operating_system.OPEN_FILES_CAN_GO:
        with suppress(OSError):  # whoever has opened it meanwhile keeps it
            path.unlink()


def is_at(handle: int, path: Path) -> bool:
    """True if an open file is still the one at a path."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False
