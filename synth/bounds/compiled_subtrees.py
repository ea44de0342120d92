"""Whole subtrees of boxes in compiled code: tighten, compare with what is known, split, and again.

What a search does with a box between two looks for designs, written once in C: the same steps as
:func:`synth.search.branch_and_bound.cover` takes over arrays. Boxes that a later generation is left for come back, and
those that are too small to be split.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.tuning import CodeSizes

# Boxes are taken by so many, whatever the number of threads: what comes back when there is no room for more
# must not depend on it.

NUMBERS = ("levels", "capacity", "columns", "known", "steps", "contracted")
PLACES = (
    "column",
    "plain",
    "of_cluster",
    "known_at_first",
    "known_least_first",
    "known_at_second",
    "known_least_second",
    "steps_at",
    "steps_largest",
    "left",
    "right",
    "ranges",
    "out_cell",
    "out_low",
    "out_high",
    "out_bounds",
    "out_tag",
    "too_small",
)


@dataclass(frozen=True)
class CapTables:
    """What designs must keep to be of use, as tables from which the caps of any box can be read.

    All numbers are signed values of objectives, not phi.

    Parameters
    ----------
    columns : list of int
        One or two objectives that are traded off.
    plain : array (objectives,)
        Caps of every box.
    of_cluster : array (clusters, objectives), optional
        Caps of boxes by their cluster of the first factor.
    known : list of (at, least), optional
        For each of two objectives: in order, values of the other one from which a known design covers, and the least
        value of this one among the designs that cover from there.
    steps : (at, largest), optional
        Of a staircase: its steps in order of the first objective, and the largest second one among each and all later
        ones. Boxes below none of them are of no use.
    """

    columns: Sequence[int]
    plain: np.ndarray
    of_cluster: np.ndarray | None = None
    known: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    steps: tuple[np.ndarray, np.ndarray] | None = None


@dataclass(frozen=True)
class Grown:
    """What subtrees leave: boxes to go on with, marked where they are too small to be split.

    ``contracted``: how many boxes were tightened.
    """

    cell: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounds: np.ndarray
    tag: np.ndarray
    too_small: np.ndarray
    contracted: int


class _Tree(ctypes.Structure):
    """The structure of the same name in the C source."""

    _fields_ = (
        *((name, ctypes.c_longlong) for name in NUMBERS),
        *((name, ctypes.c_void_p) for name in PLACES),
    )


class Halves:
    """How boxes of one question are split, as the compiled code reads it.

    Parameters
    ----------
    left, right : list of array (clusters,)
        Halves of each cluster per factor, -1 where it cannot be split.
    ranges : array (variables,)
        Width of the range of each variable: what is zero but for a billionth of it is not split.
    """

    def __init__(self, left: Sequence[np.ndarray], right: Sequence[np.ndarray], ranges: np.ndarray) -> None:
        self._left = [np.ascontiguousarray(x, dtype=np.int32) for x in left]
        self._right = [np.ascontiguousarray(x, dtype=np.int32) for x in right]
        self.kept = {
            "left": np.array([x.ctypes.data for x in self._left] or [0], dtype=np.uintp),
            "right": np.array([x.ctypes.data for x in self._right] or [0], dtype=np.uintp),
            "ranges": np.ascontiguousarray(ranges, dtype=float),
        }


def bind(loaded: ctypes.CDLL, batch: type[ctypes.Structure]) -> Any:
    """Return the compiled function."""
    function = loaded.grow
    function.argtypes = [ctypes.POINTER(batch), ctypes.POINTER(_Tree)]
    function.restype = ctypes.c_longlong
    return function


def grow(
    function: Any,
    batch_of: Callable[[int, int], ctypes.Structure],
    count: int,
    widths: tuple[int, int, int],
    halves: Halves,
    caps: CapTables,
    levels: int,
    sizes: CodeSizes,
    run: Callable[[Sequence[Callable[[], None]]], None],
) -> Grown:
    """Grow the subtrees of boxes.

    Parameters
    ----------
    function
        As :func:`bind` returns it.
    batch_of : callable
        Returns the boxes from a first to a last one as the code reads them.
    count : int
        Boxes.
    widths : (int, int, int)
        Factors, variables, objectives.
    halves : Halves
    caps : CapTables
    levels : int
        Generations.
    sizes : CodeSizes
    run : callable
        Does all of some work, which may be shared among threads.

    Returns
    -------
    Grown
    """
    factors, n, goals = widths
    fixed = dict(halves.kept)
    fixed["plain"] = np.ascontiguousarray(caps.plain, dtype=float)
    fixed["column"] = np.array([*caps.columns, 0], dtype=np.int64)
    if caps.of_cluster is not None:
        fixed["of_cluster"] = np.ascontiguousarray(caps.of_cluster, dtype=float)
    for name, (at, least) in zip(("first", "second"), caps.known, strict=False):
        fixed[f"known_at_{name}"] = np.ascontiguousarray(at, dtype=float)
        fixed[f"known_least_{name}"] = np.ascontiguousarray(least, dtype=float)
    if caps.steps is not None:
        fixed["steps_at"], fixed["steps_largest"] = (np.ascontiguousarray(x, dtype=float) for x in caps.steps)
    numbers = {
        "levels": levels,
        "columns": len(caps.columns),
        "known": len(caps.known[0][0]) if caps.known else 0,
        "steps": -1 if caps.steps is None else len(caps.steps[0]),
    }
    found: list[Grown | None] = [None] * -(-count // sizes.tree_part)

    def part(k: int) -> Callable[[], None]:
        def work() -> None:
            first, last = k * sizes.tree_part, min((k + 1) * sizes.tree_part, count)
            capacity = sizes.tree_room * (last - first) + sizes.tree_beside
            taken: dict[str, np.ndarray] = {
                "out_cell": np.empty((capacity, factors), dtype=np.int32),
                "out_low": np.empty((capacity, n)),
                "out_high": np.empty((capacity, n)),
                "out_bounds": np.empty((capacity, goals)),
                "out_tag": np.empty(capacity, dtype=np.int32),
                "too_small": np.empty(capacity, dtype=bool),
            }
            places = {name: a.ctypes.data for name, a in (fixed | taken).items()}
            tree = _Tree(capacity=capacity, **numbers, **places)
            kept = function(ctypes.byref(batch_of(first, last)), ctypes.byref(tree))
            if kept < 0:
                return  # told below: an exception would end a thread, not the search
            # Copies: what is kept shall not hold the room that was there for more.
            own = {name.removeprefix("out_"): a[:kept].copy() for name, a in taken.items()}
            found[k] = Grown(**own, contracted=int(tree.contracted))

        return work

    run([part(k) for k in range(len(found))])
    parts = [g for g in found if g is not None]
    if len(parts) < len(found):
        raise MemoryError
    names = ("cell", "low", "high", "bounds", "tag", "too_small")
    joined = {name: np.concatenate([getattr(g, name) for g in parts]) for name in names}
    return Grown(**joined, contracted=sum(g.contracted for g in parts))
