"""What Linux, macOS and Windows do differently: everything of the kind is here, and nowhere else.

``tests/test_portability.py`` forbids its names elsewhere. What is said of Windows and macOS is written from their
documentation and checked for types (``mypy --platform``); it is run by nobody here.
"""

from __future__ import annotations

import errno
import os
import platform
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
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
    """Tell whether there is a process of a number; so it counts where the system does not tell."""
    import psutil  # on Windows the way of POSIX to ask would end the process

    return bool(psutil.pid_exists(process))


def beginning(process: int) -> str:
    """Return when a process began, in a clock that nobody sets; an empty text where the system does not tell."""
    if sys.platform == "linux":
        try:
            told = Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace")
            return told.rsplit(")", 1)[1].split()[19]
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
    """Return what ``subprocess.Popen`` is told so that Ctrl-C in the terminal does not reach a process."""
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.CREATE_NO_WINDOW}
    return {"start_new_session": True}


def after_fork(call: Callable[[], object]) -> None:
    """Have something called in every process that is forked off from this one, where processes are."""
    if sys.platform != "win32":
        os.register_at_fork(after_in_child=call)


def end_with_all(process: subprocess.Popen[bytes]) -> None:
    """End a process that was started :func:`apart`, with the programs that it has started, and wait for it."""
    if process.poll() is not None:
        return
    if sys.platform == "win32":
        end_family(process.pid)
    else:
        with suppress(OSError):
            os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def end_family(process: int) -> None:
    """End a process and all that descends from it, where the system keeps no group of them."""
    import psutil

    with suppress(psutil.Error):
        first = psutil.Process(process)
        family = [first, *first.children(recursive=True)]
        for member in family:
            with suppress(psutil.Error):
                member.kill()


# Compiles in a folder of its own and moves what was made to its place at once; nothing else is left.
SCRIPT = """
ulimit -t "$1"; folder=$2 made=$3 place=$4 lock=$5; shift 5
nice "$@" && mv -f "$made" "$place"
rm -rf "$folder" "$lock"
"""
CAN_LEAVE_BEHIND = sys.platform != "win32"


def leave_behind(
    command: Sequence[str], most: float, folder: Path, made: Path, place: Path, lock: Path, handle: int
) -> None:
    """Start a program that goes on where this one ends, and moves what it has made to its place; nobody waits for it.

    Only where :data:`CAN_LEAVE_BEHIND`: Windows hands no lock down to another process.

    Parameters
    ----------
    command : sequence
    most : float
        How long it may compute, in s.
    folder : Path
        Where it works; it goes in the end.
    made, place : Path
        What it makes, and where that belongs.
    lock : Path
        Of the file that is locked as long as it works.
    handle : int
        Of the lock.
    """
    process = subprocess.Popen(
        ["/bin/sh", "-c", SCRIPT, "sh", f"{most:.0f}", folder, made, place, lock, *command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        pass_fds=[handle],  # who has it keeps others out, as long as it works
    )
    process.returncode = 0  # nobody waits for it


# ---- files ----------------------------------------------------------------------------------------------------------

NO_WAIT = getattr(os, "O_NONBLOCK", 0)  # a pipe that nobody writes into would be waited for
# Not handed to other programs, through no link, and bytes as they are.
SAFELY = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
AS_BYTES = getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
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
    """Tell whether another program has a file open in a way that keeps it from being replaced, as on Windows."""
    if OPEN_FILES_CAN_GO:
        return False
    try:
        path.replace(path)  # needs what replacing it would need, and changes nothing
    except FileNotFoundError:
        return False
    except PermissionError:
        return True
    return False


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
    if given := os.environ.get("XDG_CACHE_HOME"):
        return Path(given)
    if sys.platform == "win32":
        return _local_data()
    return Path.home() / ("Library/Caches" if sys.platform == "darwin" else ".cache")


def data_home() -> Path:
    """Return the folder in which programs of this user keep what they must not lose."""
    if given := os.environ.get("XDG_DATA_HOME"):
        return Path(given)
    if sys.platform == "win32":
        return _local_data()
    return Path.home() / ("Library/Application Support" if sys.platform == "darwin" else ".local/share")


def _local_data() -> Path:
    given = os.environ.get("LOCALAPPDATA")
    return Path(given) if given else Path.home() / "AppData" / "Local"


# ---- streams --------------------------------------------------------------------------------------------------------


def reader_has_gone(error: OSError) -> bool:
    """Tell whether an error says that nobody reads any more what is written into a pipe."""
    return isinstance(error, BrokenPipeError) or (
        sys.platform == "win32" and error.errno == errno.EINVAL and error.filename is None
    )


# ---- the C compiler -------------------------------------------------------------------------------------------------

# In the order of preference. The flags of Linux decide the last digits of results there.
_COMMON = ("-fno-math-errno", "-std=gnu11")
if sys.platform == "win32":
    COMPILERS = ("gcc", "clang", "cc")
    # No AVX: GCC does not align the stack for its registers on Windows (its bug 54412).
    COMPILER_FLAGS = ("-O3", "-mtune=native", *_COMMON, "-shared", "-static-libgcc")
    LIBRARY = ".dll"
elif sys.platform == "darwin":
    COMPILERS = ("cc", "clang", "gcc")
    # Clang knows the very processor of an Apple by the one name, and that of an Intel by the other.
    COMPILER_FLAGS = (
        "-O3",
        "-mcpu=native" if platform.machine() == "arm64" else "-march=native",
        *_COMMON,
        "-dynamiclib",
        "-fPIC",
    )
    LIBRARY = ".dylib"
else:
    COMPILERS = ("cc", "gcc", "clang")
    COMPILER_FLAGS = ("-O3", "-march=native", *_COMMON, "-shared", "-fPIC")
    LIBRARY = ".so"
TRIED_FOR = 30.0  # seconds that a compiler may take to say what it is


def find_compiler() -> str | None:
    """Return the path of a C compiler whose libraries this Python can load; None where there is none."""
    found = (shutil.which(name) for name in COMPILERS)
    return next((path for path in found if path is not None and _suits(path)), None)


@cache
def _suits(compiler: str) -> bool:
    """Tell whether what stands at a path is there to compile for this Python."""
    if sys.platform == "darwin" and compiler.startswith("/usr/bin/"):
        # Without the tools of the command line it is a stand-in, which asks in a window to install them.
        return _says(["/usr/bin/xcode-select", "-p"]) is not None
    if sys.platform == "win32":
        # That of Visual Studio, and LLVM for it, take other flags and export nothing by themselves.
        target = (_says([compiler, "-dumpmachine"]) or "").lower()
        machine = {"amd64": "x86_64", "x86": "i686", "arm64": "aarch64"}.get(platform.machine().lower(), "?")
        return target.startswith(machine) and ("mingw" in target or "windows-gnu" in target)
    return True


def _says(command: Sequence[str]) -> str | None:
    """Return what a program says, None where it fails."""
    try:
        done = subprocess.run(
            command, capture_output=True, encoding="utf-8", errors="replace", timeout=TRIED_FOR, check=True
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout


def version_of(compiler: str) -> str | None:
    """Return what a compiler says of itself; None where it does not work."""
    return _says([compiler, "--version"])


@cache
def processor() -> str:
    """Return what code for this very processor depends on: a cache folder may be shared between machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = [platform.processor()]
    flags = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return "\n".join([platform.machine(), platform.system(), flags])
