"""Dominance as a kernel, with the very numbers that arrays give."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np

from synth.kernels.loading import kernel

TABLE = ("points", "shift", "blocks", "strict"), ("ordered", "place", "value", "corner")
SETS = ("points", "objectives", "block", "rows", "words", "strict"), ("ordered", "place", "inside")


class _Table(ctypes.Structure):
    """The structure ``Table`` of the C source."""

    _fields_ = (*((x, ctypes.c_longlong) for x in TABLE[0]), *((x, ctypes.c_void_p) for x in TABLE[1]))


class _Sets(ctypes.Structure):
    """The structure ``Sets`` of the C source."""

    _fields_ = (*((x, ctypes.c_longlong) for x in SETS[0]), *((x, ctypes.c_void_p) for x in SETS[1]))


class DominanceCode:
    """Answers of the kernel about which points cover boxes.

    Parameters
    ----------
    loaded : CDLL
    """

    def __init__(self, loaded: ctypes.CDLL) -> None:
        self._loaded = loaded
        for name, structure in (("from_table", _Table), ("from_sets", _Sets)):
            function = getattr(loaded, name)
            function.argtypes = [ctypes.POINTER(structure), ctypes.c_longlong, ctypes.c_void_p, ctypes.c_void_p]
            function.restype = None

    def from_table(self, numbers: Mapping[str, int], arrays: Mapping[str, np.ndarray], lower: np.ndarray) -> np.ndarray:
        """Numbers and arrays of a :class:`CornerTable` by the names in the C source."""
        return _answer(self._loaded.from_table, _record(_Table, numbers, arrays), lower)

    def from_sets(self, numbers: Mapping[str, int], arrays: Mapping[str, np.ndarray], lower: np.ndarray) -> np.ndarray:
        """Numbers and arrays of :class:`CoverSets` by the names in the C source."""
        return _answer(self._loaded.from_sets, _record(_Sets, numbers, arrays), lower)


def _record(
    kind: type[ctypes.Structure], numbers: Mapping[str, int], arrays: Mapping[str, np.ndarray]
) -> ctypes.Structure:
    return kind(**numbers, **{name: x.ctypes.data for name, x in arrays.items()})


def _answer(function: Callable[..., None], record: ctypes.Structure, lower: np.ndarray) -> np.ndarray:
    lower = np.ascontiguousarray(lower, dtype=float)
    least = np.empty_like(lower)
    function(ctypes.byref(record), len(lower), lower.ctypes.data, least.ctypes.data)
    return least


def dominance_code() -> DominanceCode | None:
    """The kernel; None where there is none."""
    loaded = kernel("dominance")
    return None if loaded is None else _code(loaded)


@cache
def _code(loaded: ctypes.CDLL) -> DominanceCode:
    return DominanceCode(loaded)
