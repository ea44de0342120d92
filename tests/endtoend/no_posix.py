"""A process of Linux in which our own modules see what Windows has: begun by ``sitecustomize``, never by tests.

What is ours finds no ``fcntl`` and its like, an ``os`` and a ``signal`` without the names of POSIX, and branches as on
Windows, whose own functions are stood in for; a file that is open can be neither removed nor replaced, as there. The
libraries of others go on as on Linux, and files that other processes have open can go: nothing is shown of those.
"""

from __future__ import annotations

import builtins
import ctypes
import errno
import functools
import importlib.machinery
import os
import platform
import shutil
import signal
import subprocess
import sys
import types
from collections.abc import Callable
from contextlib import suppress
from ctypes import wintypes
from pathlib import Path
from typing import Any

OURS = {"synth", "problems", "catalogs", "reports"}
MODULES = ("fcntl", "resource", "pwd", "grp", "termios", "tty", "pty")
OF_POSIX = {
    "os": {
        *("chown", "fchmod", "fchown", "fork", "forkpty", "getegid", "geteuid", "getgid", "getloadavg", "getpgid"),
        *("getpgrp", "getsid", "getuid", "kill", "killpg", "mkfifo", "nice", "openpty", "posix_spawn", "pread"),
        *("pwrite", "register_at_fork", "sched_getaffinity", "sched_setaffinity", "setpgid", "setsid", "statvfs"),
        *("sysconf", "uname", "wait", "waitpid", "O_CLOEXEC", "O_DIRECTORY", "O_NOFOLLOW", "O_NONBLOCK"),
    },
    "signal": {
        *("SIGALRM", "SIGCHLD", "SIGHUP", "SIGKILL", "SIGPIPE", "SIGQUIT", "SIGUSR1", "SIGUSR2", "alarm", "setitimer"),
        *("pause", "pthread_kill", "pthread_sigmask", "sigwait", "siginterrupt"),
    },
}
WATCHED = "CLUTCHSYNTH_WATCHED"  # the folder in which files that are open stay
# What synth.system.operating_system imports: it must be there before, as it would take this for Windows.
PRELOADED = (wintypes, functools, platform, shutil, subprocess)
BUSY = 33  # ERROR_LOCK_VIOLATION


class Lacking(types.ModuleType):
    """A module without some names, and with some of Windows."""

    def __init__(self, module: types.ModuleType, lacking: set[str], **more: Any) -> None:
        super().__init__(module.__name__)
        self.__dict__.update(more, _module=module, _lacking=lacking)

    def __getattr__(self, name: str) -> Any:
        if name in self._lacking:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        return getattr(self._module, name)


def _opened(path: Any, flags: int, mode: int = 0o777) -> int:
    if Path(path).is_dir():
        raise PermissionError(errno.EACCES, "Permission denied", str(path))
    return os.open(path, flags | os.O_CLOEXEC, mode)


def _windows() -> dict[str, types.ModuleType]:
    """Return the modules as what is ours sees them."""
    import fcntl

    told = types.SimpleNamespace(code=0)

    def let_go(file: Any, *_: Any) -> int:
        fcntl.flock(file.value, fcntl.LOCK_UN)
        return 1

    def locked(file: Any, flags: int, *_: Any) -> int:
        assert flags & 1, "nobody waits for a lock"
        try:
            fcntl.flock(file.value, (fcntl.LOCK_EX if flags & 2 else fcntl.LOCK_SH) | fcntl.LOCK_NB)
        except OSError:
            told.code = BUSY
            return 0
        return 1

    kernel = types.SimpleNamespace(LockFileEx=locked, UnlockFileEx=let_go)
    libraries = {"WinDLL": lambda *_, **__: kernel, "get_last_error": lambda: told.code, "WinError": OSError}
    msvcrt: Any = types.ModuleType("msvcrt")
    msvcrt.get_osfhandle = lambda handle: handle
    # On Linux it must be asked for nothing that Linux has not; what it is asked for stands in a test.
    starting: dict[str, Any] = {"CREATE_NEW_PROCESS_GROUP": 0, "CREATE_NO_WINDOW": 0}
    return {
        "os": Lacking(os, OF_POSIX["os"], open=_opened),
        "signal": Lacking(signal, OF_POSIX["signal"], SIGBREAK=signal.SIGUSR2),
        "subprocess": Lacking(subprocess, set(), **starting),
        "ctypes": Lacking(ctypes, set(), **libraries),
        "msvcrt": msvcrt,
    }


class _Loader(importlib.machinery.SourceFileLoader):
    """Loads a module of ours, with what it would see on Windows."""

    seen: dict[str, types.ModuleType]

    def exec_module(self, module: types.ModuleType) -> None:
        real = {name: sys.modules.get(name) for name in self.seen}
        if module.__name__ == "synth.system.operating_system":
            before = sys.platform
            sys.platform = "win32"
            sys.modules.update(self.seen)
            try:
                super().exec_module(module)
            finally:
                sys.platform = before
                sys.modules.update({name: old for name, old in real.items() if old is not None})
                del sys.modules["msvcrt"]  # by which libraries would take this for Windows
            module.sys = types.SimpleNamespace(platform="win32")  # type: ignore[attr-defined]
        else:
            super().exec_module(module)
        for name, seen in self.seen.items():
            if real[name] is not None and module.__dict__.get(name) is real[name]:
                setattr(module, name, seen)


class _Finder:
    def __init__(self) -> None:
        _Loader.seen = _windows()

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> Any:
        if name.split(".")[0] not in OURS:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None and isinstance(spec.loader, importlib.machinery.SourceFileLoader):
            spec.loader = _Loader(spec.loader.name, spec.loader.path)
        return spec


def _keep_what_is_open(folder: str) -> Callable[[str, tuple[Any, ...]], None]:
    """Return what refuses to remove or rename files below a folder that this process has open."""

    def check(event: str, told: tuple[Any, ...]) -> None:
        if event not in ("os.remove", "os.rename"):
            return
        places = [str(Path(os.fsdecode(place)).absolute()) for place in told[: 1 if event == "os.remove" else 2]]
        if not any(place.startswith(folder) for place in places):
            return
        opened = set()
        for handle in Path("/proc/self/fd").iterdir():
            with suppress(OSError):
                opened.add(str(handle.readlink()))
        for place in places:
            if any(name == place or name.startswith(f"{place}/") for name in opened):
                raise PermissionError(errno.EACCES, "The process cannot access the file", place)

    return check


def begin() -> None:
    """Let it be so for the rest of this process, and for those that it starts."""
    assert PRELOADED
    sys.meta_path.insert(0, _Finder())  # type: ignore[arg-type]
    _imported = builtins.__import__

    def imported(name: str, given: Any = None, *more: Any, **told: Any) -> Any:
        if name in MODULES and str((given or {}).get("__name__", "")).split(".")[0] in OURS:
            raise ModuleNotFoundError(name)
        return _imported(name, given, *more, **told)

    builtins.__import__ = imported
    import psutil

    psutil.BELOW_NORMAL_PRIORITY_CLASS = 1
    shutil._use_fd_functions = False  # type: ignore[attr-defined]
    shutil.rmtree.avoids_symlink_attacks = False
    if WATCHED in os.environ:
        sys.addaudithook(_keep_what_is_open(os.environ[WATCHED]))
