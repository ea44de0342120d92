"""The interior-point method compiled for one set of row functions, where there is a C compiler.

Compiled code is kept in the user's cache folder, by the hash of all it was made from. Everything works without it;
the environment variable ``CLUTCHSYNTH_NATIVE=0`` switches it off.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from synth.compiled.compilation import switched_on
from synth.compiled.compiler import library
from synth.nlp.interior_point import Ends, Problems
from synth.nlp.interior_point_c_source import source
from synth.nlp.row_functions import RowFunctions
from synth.tuning import NlpSettings

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
            np.empty((n, count)),
            np.empty(count),
            np.empty((rows, count)),
            np.empty((rows, count)),
            np.empty(count, dtype=np.int64),
            np.empty(count, dtype=np.int64),
        )
        stored = [np.ascontiguousarray(x, dtype=float).reshape(-1) for x in problems.stored]
        steps = np.array([0 if len(x) == 1 else 1 for x in stored] or [0], dtype=np.int64)
        columns = np.array([x.ctypes.data for x in stored] or [0], dtype=np.uintp)
        # The arrays must outlive the call, so they are kept by name until it is over.
        inputs = {
            name: np.ascontiguousarray(getattr(problems, name), dtype=float)
            for name in ("start", "low", "high", "slopes", "rights", "weights", "t_weight")
        }
        counts = np.ascontiguousarray(problems.counts, dtype=np.uint8)
        given = _Problems(
            count=count,
            stored=columns.ctypes.data_as(ctypes.POINTER(DOUBLES)),
            stored_steps=steps.ctypes.data_as(INTEGERS),
            counts=counts.ctypes.data_as(ctypes.POINTER(ctypes.c_ubyte)),
            status=ends.status.ctypes.data_as(INTEGERS),
            evaluations=ends.evaluations.ctypes.data_as(INTEGERS),
            **{name: array.ctypes.data_as(DOUBLES) for name, array in inputs.items()},
            **{name: getattr(ends, name).ctypes.data_as(DOUBLES) for name in ("y", "t", "rows", "multipliers")},
        )
        self._solve(ctypes.byref(given), *self._more)
        return ends


def native(functions: RowFunctions, settings: NlpSettings) -> Solver | None:
    """Return the compiled solver; None where code cannot be compiled, kept or loaded."""
    if not switched_on() or functions.n == 0:
        return None
    loaded = library("nlp", source(functions, settings.method), settings.effort)
    return None if loaded is None else Solver(functions, loaded)
