"""Files that a process has to itself, by locks that end with the process."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from synth.system import operating_system
from synth.system.operating_system import SAFELY, lock


@contextmanager
def exclusive_access(path: Path) -> Iterator[bool]:
    """Exclude other processes for the block with a lock file; yields False if another one holds it.

    Parameters
    ----------
    path : Path
        Of the file to lock, in an existing folder.
    """
    handle = locked(path)
    try:
        yield handle is not None
    finally:
        if handle is not None:
            unlock(path, handle)


def locked(path: Path) -> int | None:
    """Handle of the locked file; None where another process holds it, or it cannot be written."""
    while True:
        try:
            handle = os.open(path, os.O_RDWR | os.O_CREAT | SAFELY, 0o666)
        except OSError:
            return None
        acquired = False
        try:
            acquired = lock(handle, shared=False)
            if acquired and is_at(handle, path):
                return handle
        except OSError:
            acquired = False
        os.close(handle)
        if not acquired:
            return None  # otherwise the file was removed meanwhile


def is_locked(path: Path) -> bool:
    """True if another process holds an exclusive lock on a file."""
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
