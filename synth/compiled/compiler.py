"""Finding a C compiler, and keeping what it has built."""

from __future__ import annotations

import ctypes
import hashlib
import os
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from synth.compiled.compilation import compile_beside, compile_shared, switched_on
from synth.compiled.demand import Demand, demand_for
from synth.native_switch import c_compiler
from synth.operating_system import COMPILER_FLAGS, LIBRARY, cache_home, processor, version_of
from synth.tuning import CompilingEffort

QUICK = (*COMPILER_FLAGS, "-O1")  # for what the first answer waits for: half the time, a tenth slower


def library(name: str, text: str, effort: CompilingEffort, flags: Sequence[str] = COMPILER_FLAGS) -> ctypes.CDLL | None:
    """Return a C source as loaded code; None where it cannot be compiled, kept or loaded.

    Parameters
    ----------
    name : str
        Of the kind of code, for the cache folder.
    text : str
        The translation unit.
    effort : CompilingEffort
    flags : list of str
        For the compiler.

    Raises
    ------
    Stopped
        Time is over before it is compiled.
    NotCompiled
        The time limit is too short for compiling it.
    """
    place = _place(name, text, flags)
    if place is None:
        return None
    compiler, path = place
    try:
        if not path.exists():
            compile_shared(compiler, text, path, flags, effort)
        return ctypes.CDLL(str(path))
    except (OSError, subprocess.SubprocessError):
        return None


class LibraryBeside:
    """A C source that is compiled while other work goes on, and loaded once it is there.

    Parameters
    ----------
    name, text, effort, flags
        As for :func:`library`.
    """

    def __init__(self, name: str, text: str, effort: CompilingEffort, flags: Sequence[str] = COMPILER_FLAGS) -> None:
        self._text, self._effort, self._flags = text, effort, flags
        self._place = _place(name, text, flags)
        self._loaded: ctypes.CDLL | None = None

    def kept(self) -> ctypes.CDLL | None:
        """Return the loaded code where an earlier program has left it; nothing is begun."""
        return self.loaded() if self._place is not None and self._place[1].exists() else None

    def demand(self, enough: float) -> Demand | None:
        """Return what the code would be used for, which from so much on is compiled for programs to come."""
        if self._place is None:
            return None
        compiler, path = self._place
        return demand_for([compiler, *self._flags], self._text, path, self._effort, enough)

    def loaded(self) -> ctypes.CDLL | None:
        """Return the loaded code; None as long as it is not there, which may be for good."""
        if self._loaded is None and self._place is not None and switched_on():
            compiler, path = self._place
            try:
                if compile_beside(compiler, self._text, path, self._flags, self._effort):
                    self._loaded = ctypes.CDLL(str(path))
            except (OSError, subprocess.SubprocessError):
                self._place = None
        return self._loaded


def _place(name: str, text: str, flags: Sequence[str]) -> tuple[str, Path] | None:
    """Return the compiler and the place of what it makes of a source; None where nothing can be compiled or kept."""
    compiler, folder = (_compiler(), cache_folder()) if switched_on() else (None, None)
    if compiler is None or folder is None:
        return None
    key = hashlib.sha256("\0".join([text, *flags, *compiler, processor()]).encode()).hexdigest()[:32]
    return compiler[0], folder / f"{name}_{key}{LIBRARY}"


def cache_folder() -> Path | None:
    """Return the folder for compiled code, made if need be; None where it cannot be written."""
    try:
        folder = cache_home() / "clutchsynth"
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):
        return None
    return folder if os.access(folder, os.W_OK) else None


@cache
def _compiler() -> tuple[str, str] | None:
    """Return the path and version of the system's C compiler."""
    path = c_compiler()
    if path is None:
        return None
    version = version_of(path)
    return None if version is None else (path, version)
