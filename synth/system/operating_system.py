"""What Linux, macOS and Windows do differently: everything of the kind is here, and nowhere else.

``tests/test_portability.py`` forbids its names elsewhere. What is said of Windows and macOS is written from their
documentation and checked for types (``mypy --platform``); it is run by nobody here.
"""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

if sys.platform == "win32":
    import ctypes
    import msvcrt
    from ctypes import wintypes
else:
    import fcntl
    import resource


# ---- signals --------------------------------------------------------------------------------------------------------

# By which schedulers, containers and consoles end a program, beside Ctrl-C.
if sys.platform == "win32":
    ENDING = (signal.SIGTERM, signal.SIGBREAK)
else:
    ENDING = (signal.SIGTERM,)


# ---- processes ------------------------------------------------------------------------------------------------------


def is_alive(process: int) -> bool:
    """True if there is a process of a number; so it counts where the system does not tell."""
    import psutil  # on Windows the way of POSIX to ask would end the process

    return bool(psutil.pid_exists(process))


def beginning(process: int) -> str:
    """Start time of a process, in a clock that nobody sets; an empty text where the system does not state it."""
    if sys.platform == "linux":
        try:
            status = Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace")
            return status.rsplit(")", 1)[1].split()[19]
        except (OSError, IndexError):
            return ""
    if sys.platform == "win32":
        import psutil

        with suppress(psutil.Error):
            return f"{psutil.Process(process).create_time():.3f}"
    return ""


def resident(process: int) -> int:
    """Return the memory that a process uses, in bytes; 0 where the system does not tell."""
    import psutil

    with suppress(psutil.Error, OSError):
        return int(psutil.Process(process).memory_info().rss)
    return 0


def processor_time(process: int) -> float:
    """Time that a process has had on processors, in s; 0 where the system does not tell."""
    import psutil

    with suppress(psutil.Error, OSError):
        used = psutil.Process(process).cpu_times()
        return float(used.user + used.system)
    return 0.0


def bound_memory(size: int) -> None:
    """Let no allocation of this process go beyond a size, where the system can."""
    if sys.platform != "win32":
        with suppress(ValueError, OSError):
            resource.setrlimit(resource.RLIMIT_AS, (size, size))


def give_way(steps: int) -> None:
    """Let other programs go before this one, by steps of niceness; Windows knows one such step."""
    if steps <= 0:
        return
    if sys.platform == "win32":
        import psutil

        with suppress(psutil.Error):
            psutil.Process().nice(psutil.BELOW_NORMAL_PRIORITY_CLASS)
    else:
        os.nice(steps)


def cores() -> int:
    """Return the number of processors that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def apart() -> dict[str, Any]:
    """Arguments of ``subprocess.Popen`` that keep Ctrl-C in the terminal from a process."""
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.CREATE_NO_WINDOW}
    return {"start_new_session": True}


# ---- files ----------------------------------------------------------------------------------------------------------

NO_WAIT = getattr(os, "O_NONBLOCK", 0)  # a pipe that nobody writes into would be waited for
# Not handed to other programs, through no link, and bytes as they are.
SAFELY = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
AS_BYTES = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
PRIVATE_FOLDER, PRIVATE_FILE = 0o700, 0o600
OUT_OF_SPACE = tuple(getattr(errno, name) for name in ("ENOSPC", "EDQUOT") if hasattr(errno, name))
NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP)  # file systems that have none
HELD_PATIENCE = 2.0  # seconds; scanners and indexers of Windows look into a file that is new, for a moment
HELD_PAUSE = 0.05

# A file that is open can be taken away, or another put in its place, without disturbing who has it open.
OPEN_FILES_CAN_GO = sys.platform != "win32"


if sys.platform == "win32":

    class _Overlapped(ctypes.Structure):
        """Says where in a file a lock begins (OVERLAPPED)."""

        _fields_ = (
            ("internal", ctypes.c_void_p),
            ("internal_high", ctypes.c_void_p),
            ("offset", wintypes.DWORD),
            ("offset_high", wintypes.DWORD),
            ("event", wintypes.HANDLE),
        )

    AT_ONCE, EXCLUSIVE = 1, 2  # LOCKFILE_FAIL_IMMEDIATELY, LOCKFILE_EXCLUSIVE_LOCK
    FAR = 0x40000000  # upper half of a place beyond all content: what is locked there can be read by all
    WITHOUT_LOCKS = (1, 50)  # ERROR_INVALID_FUNCTION, ERROR_NOT_SUPPORTED
    LOCKED_BY_OTHERS = (33, 997)  # ERROR_LOCK_VIOLATION, ERROR_IO_PENDING

    def lock(handle: int, shared: bool) -> bool:
        """Lock an open file if nobody else has it; tell whether it is locked, as it counts where there are no locks."""
        kernel = ctypes.WinDLL("kernel32", use_last_error=True)
        file = wintypes.HANDLE(msvcrt.get_osfhandle(handle))
        place = _Overlapped(offset_high=FAR)
        # What this handle had is let go first: Windows turns no lock into one of the other kind.
        kernel.UnlockFileEx(file, 0, 1, 0, ctypes.byref(place))
        if kernel.LockFileEx(file, AT_ONCE | (0 if shared else EXCLUSIVE), 0, 1, 0, ctypes.byref(place)):
            return True
        code = ctypes.get_last_error()
        if code in LOCKED_BY_OTHERS:
            return False
        if code in WITHOUT_LOCKS:
            return True
        raise ctypes.WinError(code)

else:

    def lock(handle: int, shared: bool) -> bool:
        """Lock an open file if nobody else has it; tell whether it is locked, as it counts where there are no locks."""
        try:
            fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno in NO_LOCKS:
                return True
            if error.errno in (errno.EWOULDBLOCK, errno.EACCES):
                return False
            raise
        return True


def is_held(path: Path) -> bool:
    """True if another program has a file open in a way that keeps it from being replaced, as on Windows."""
    if OPEN_FILES_CAN_GO:
        return False
    try:
        path.replace(path)  # needs what replacing it would need, and changes nothing
    except FileNotFoundError:
        return False
    except PermissionError:
        return True
    return False


def private_folder(folder: Path) -> None:
    """Make a folder that its owner alone can enter; one that is there is closed to others where it is empty yet.

    Windows leaves it to the rights of the folder above.
    """
    try:
        folder.mkdir(mode=PRIVATE_FOLDER, parents=True)
    except FileExistsError:
        if folder.is_dir() and not any(folder.iterdir()):
            with suppress(OSError):  # it belongs to somebody else, who has given it as it is
                folder.chmod(PRIVATE_FOLDER)


def private_file(file: Path) -> None:
    """Have a file that its owner alone can read and write: an empty one where there is none.

    One that is there is not opened: to close it would end all locks that this process has on it.
    """
    try:
        os.close(os.open(file, os.O_CREAT | os.O_EXCL | os.O_RDWR | AS_BYTES, PRIVATE_FILE))
    except FileExistsError:
        with suppress(OSError):  # it belongs to somebody else, who has given it as it is, or has just gone
            file.chmod(PRIVATE_FILE)


def put_in_place(source: Path, target: Path) -> None:
    """Rename a file or folder, over what is there; wait a moment for programs that hold it on systems where they can.

    Raises
    ------
    OSError
    """
    patient_until = time.monotonic() + (0.0 if OPEN_FILES_CAN_GO else HELD_PATIENCE)
    while True:
        try:
            source.replace(target)
        except PermissionError:
            if time.monotonic() >= patient_until:
                raise
            time.sleep(HELD_PAUSE)
        else:
            return


def sync_folder(folder: Path) -> None:
    """Have the entries of a folder on the disk, where the system can."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


# ---- folders of the user --------------------------------------------------------------------------------------------


def cache_home() -> Path:
    """Return the folder in which programs of this user keep what can be made again.

    Raises
    ------
    RuntimeError
        The system does not tell where the user is at home.
    """
    if configured := os.environ.get("XDG_CACHE_HOME"):
        return Path(configured)
    if sys.platform == "win32":
        return _local_data()
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")


def data_home() -> Path:
    """Return the folder in which programs of this user keep what they must not lose."""
    if configured := os.environ.get("XDG_DATA_HOME"):
        return Path(configured)
    if sys.platform == "win32":
        return _local_data()
    return Path.home() / ("Library/Application Support" if sys.platform == "darwin" else ".local/share")


def _local_data() -> Path:
    configured = os.environ.get("LOCALAPPDATA")
    return Path(configured) if configured else Path.home() / "AppData" / "Local"


# ---- streams --------------------------------------------------------------------------------------------------------


def reader_has_gone(error: OSError) -> bool:
    """True if an error says that nobody reads any more what is written into a pipe."""
    return isinstance(error, BrokenPipeError) or (
        sys.platform == "win32" and error.errno == errno.EINVAL and error.filename is None
    )
