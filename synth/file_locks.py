"""Files that a process has to itself, by locks that end with the process."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # a system without these locks: nobody is kept out
    fcntl = None  # type: ignore[assignment]

SAFELY = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0)
NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP)  # file systems that have none


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
            taken = has_lock(handle, shared=False)
            if taken and is_at(handle, path):
                return handle
        except OSError:
            taken = False
        os.close(handle)
        if not taken:
            return None  # otherwise whoever had it has just taken it away


def is_taken(path: Path) -> bool:
    """Tell whether another process has a file to itself."""
    try:
        handle = os.open(path, os.O_RDWR | SAFELY)
    except OSError:
        return False
    try:
        return not has_lock(handle, shared=True)
    except OSError:
        return False
    finally:
        os.close(handle)


def has_lock(handle: int, shared: bool) -> bool:
    """Lock an open file if nobody else has it; tell whether it is locked, as it counts where there are no locks."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in NO_LOCKS:
            return True
        if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
            return False
        raise
    return True


def unlock(path: Path, handle: int) -> None:
    """Let go of a locked file; the last one takes it away."""
    with suppress(OSError):
        if has_lock(handle, shared=False) and is_at(handle, path):
            path.unlink()
    os.close(handle)


def is_at(handle: int, path: Path) -> bool:
    """Tell whether an open file is still the one at a path."""
    try:
        return os.path.samestat(os.fstat(handle), path.stat())
    except FileNotFoundError:
        return False
