"""The interior-point method compiled for one set of row functions, where there is a C compiler.

Compiled code is kept in the user's cache folder, by the hash of all it was made from. Everything works without it;
the environment variable ``CLUTCHSYNTH_NATIVE=0`` switches it off.
"""

from __future__ import annotations

import ctypes
import hashlib
import os
import platform
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from synth.compilation import compile_shared, switched_on
from synth.derivatives import RowFunctions
from synth.interior_point import Ends, Problems
from synth.native_source import source
from synth.native_switch import c_compiler
from synth.tuning import InteriorPointSettings

FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-std=gnu11", "-shared", "-fPIC")
DOUBLES = ctypes.POINTER(ctypes.c_double)
INTEGERS = ctypes.POINTER(ctypes.c_longlong)


class _Problems(ctypes.Structure):
    """The structure of the same name in the C source."""

    _fields_ = (
        ("count", ctypes.c_longlong),
        ("stored", ctypes.POINTER(DOUBLES)),
        ("stored_steps", INTEGERS),
        *((name, DOUBLES) for name in ("start", "low", "high", "slopes", "rights", "weights", "t_weight")),
        ("counts", ctypes.POINTER(ctypes.c_ubyte)),
        *((name, DOUBLES) for name in ("y", "t", "rows", "multipliers")),
        ("status", INTEGERS),
        ("evaluations", INTEGERS),
    )


class Solver:
    """The compiled solver of one set of row functions.

    Parameters
    ----------
    functions : RowFunctions
    code : CDLL
    """

    def __init__(self, functions: RowFunctions, code: ctypes.CDLL) -> None:
        self.functions = functions
        self._solve = code.solve
        self._solve.restype = None
        self._more: list[Any] = []  # what the code takes after the problems

    def solve(self, problems: Problems) -> Ends:
        """Solve all problems, each from its start."""
        n, rows, count = self.functions.n, self.functions.n_rows, len(problems)
        ends = Ends(
            np.empty((n, count)), np.empty(count), np.empty((rows, count)), np.empty((rows, count)),
            np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64),
        )  # fmt: skip
        stored = [np.ascontiguousarray(x, dtype=float).reshape(-1) for x in problems.stored]
        steps = np.array([0 if len(x) == 1 else 1 for x in stored] or [0], dtype=np.int64)
        columns = (DOUBLES * max(len(stored), 1))(*(x.ctypes.data_as(DOUBLES) for x in stored))
        # The arrays must outlive the call, so they are kept by name until it is over.
        inputs = {
            name: np.ascontiguousarray(getattr(problems, name), dtype=float)
            for name in ("start", "low", "high", "slopes", "rights", "weights", "t_weight")
        }
        counts = np.ascontiguousarray(problems.counts, dtype=np.uint8)
        given = _Problems(
            count=count,
            stored=columns,
            stored_steps=steps.ctypes.data_as(INTEGERS),
            counts=counts.ctypes.data_as(ctypes.POINTER(ctypes.c_ubyte)),
            status=ends.status.ctypes.data_as(INTEGERS),
            evaluations=ends.evaluations.ctypes.data_as(INTEGERS),
            **{name: array.ctypes.data_as(DOUBLES) for name, array in inputs.items()},
            **{name: getattr(ends, name).ctypes.data_as(DOUBLES) for name in ("y", "t", "rows", "multipliers")},
        )
        self._solve(ctypes.byref(given), *self._more)
        return ends


def native(functions: RowFunctions, method: InteriorPointSettings) -> Solver | None:
    """Return the compiled solver; None where code cannot be compiled, kept or loaded."""
    if not switched_on() or functions.n == 0:
        return None
    loaded = library("nlp", source(functions, method))
    return None if loaded is None else Solver(functions, loaded)


def library(name: str, text: str, flags: Sequence[str] = FLAGS) -> ctypes.CDLL | None:
    """Return a C source as loaded code; None where it cannot be compiled, kept or loaded.

    Parameters
    ----------
    name : str
        Of the kind of code, for the cache folder.
    text : str
        The translation unit.
    flags : list of str
        For the compiler.

    Raises
    ------
    Stopped
        Time is over before it is compiled.
    NotCompiled
        The time limit is too short for compiling it.
    """
    compiler, folder = (_compiler(), cache_folder()) if switched_on() else (None, None)
    if compiler is None or folder is None:
        return None
    key = hashlib.sha256("\0".join([text, *flags, *compiler, _machine()]).encode()).hexdigest()[:32]
    path = folder / f"{name}_{key}.so"
    try:
        if not path.exists():
            compile_shared(compiler[0], text, path, flags)
        return ctypes.CDLL(str(path))
    except (OSError, subprocess.SubprocessError):
        return None


def cache_folder() -> Path | None:
    """Return the folder for compiled code, made if need be; None where it cannot be written."""
    given = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = (Path(given) if given else Path.home() / ".cache") / "clutchsynth"
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
    try:
        done = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=30, check=True)
    except (OSError, subprocess.SubprocessError):
        return None
    return path, done.stdout


@cache
def _machine() -> str:
    """Return what code for this very processor depends on: a cache folder may be shared between machines."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = [platform.processor()]
    flags = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return "\n".join([platform.machine(), platform.system(), flags])
