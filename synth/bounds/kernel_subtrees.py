"""Whole subtrees of boxes by the kernel: tighten, compare with what is known, split, and again; or split alone.

What a search does with a box between two looks for designs, written once in C: the same steps as
:func:`synth.search.branch_and_bound.branch_and_bound` takes over arrays. Boxes that a later generation is left for come
back, and those that are too small to be split.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from synth.bounds.box_batches import Batches, BatchStructure, Prepared, filled, output_arrays, scored_output_arrays
from synth.bounds.boxes import Boxes, Subtrees
from synth.kernels.threads import SideBySide, side_by_side

# Room for the boxes that the kernel takes at once: a block of 32, both halves of each, and more than that.
MOST_AT_HAND = 256

NUMBERS = ("levels", "capacity", "columns", "known", "steps", "contracted")
PLACES = (
    "column",
    "fixed",
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
class CutoffTables:
    """What designs must keep to be of use, as tables from which the cutoffs of any box can be read.

    All numbers are signed values of objectives, not phi.

    Parameters
    ----------
    columns : list of int
        One or two objectives that are traded off.
    fixed : array (objectives,)
        Cutoffs of every box.
    of_cluster : array (clusters, objectives), optional
        Cutoffs of boxes by their cluster of the first factor.
    known : list of (at, least), optional
        For each of two objectives: in order, values of the other one from which a known design covers, and the least
        value of this one among the designs that cover from there.
    steps : (at, largest), optional
        Of a front that is being proven: its steps in order of the first objective, and the largest second one among
        each and all later ones. Boxes below none of them are of no use.
    """

    columns: Sequence[int]
    fixed: np.ndarray
    of_cluster: np.ndarray | None = None
    known: tuple[tuple[np.ndarray, np.ndarray], ...] = ()
    steps: tuple[np.ndarray, np.ndarray] | None = None

    def numbers(self) -> dict[str, int]:
        """Return the numbers of the record that the kernel reads."""
        return {
            "columns": len(self.columns),
            "known": len(self.known[0][0]) if self.known else 0,
            "steps": -1 if self.steps is None else len(self.steps[0]),
        }

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays of the record that the kernel reads."""
        result = {"fixed": self.fixed}
        if self.of_cluster is not None:
            result["of_cluster"] = self.of_cluster
        for name, (at, least) in zip(("first", "second"), self.known, strict=False):
            result |= {f"known_at_{name}": at, f"known_least_{name}": least}
        if self.steps is not None:
            result["steps_at"], result["steps_largest"] = self.steps
        result = {name: np.ascontiguousarray(values, dtype=float) for name, values in result.items()}
        return result | {"column": np.array([*self.columns, 0], dtype=np.int64)}


class _TreeStructure(ctypes.Structure):
    """The structure ``Tree`` of the C source."""

    _fields_ = (*((name, ctypes.c_longlong) for name in NUMBERS), *((name, ctypes.c_void_p) for name in PLACES))


class Halves:
    """How boxes of one question are split, as the kernel reads it.

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


class Growth:
    """Subtrees that grow concurrently with the caller, who must end it: with :meth:`subtrees` or :meth:`stop`.

    Parameters
    ----------
    parts : SideBySide
        Each gives boxes, which of them are too small to be split, and how many were tightened.
    """

    def __init__(self, parts: SideBySide[tuple[Boxes, np.ndarray, int]]) -> None:
        self._parts = parts
        self._changed: Callable[[Subtrees], Subtrees] = lambda grown: grown

    def then(self, changed: Callable[[Subtrees], Subtrees]) -> Growth:
        """Let something be done to the subtrees once they are asked for."""
        self._changed = changed
        return self

    def subtrees(self) -> Subtrees:
        """Grown subtrees.

        Raises
        ------
        MemoryError
            If the kernel could not allocate its work space.
        """
        parts = self._parts.results()
        both = Boxes.joined([boxes for boxes, _, _ in parts])
        too_small = np.concatenate([small for _, small, _ in parts])
        contracted = sum(contracted for _, _, contracted in parts)
        return self._changed(Subtrees(both.take(~too_small), both.take(too_small), contracted))

    def stop(self) -> None:
        """Let nothing grow any more."""
        self._parts.stop()


class SubtreeCode:
    """Splitting of boxes and growth of subtrees by the kernel.

    Parameters
    ----------
    loaded : CDLL
    read : mapping
        Arrays that it reads beside those of a question.
    """

    def __init__(self, loaded: ctypes.CDLL, read: Mapping[str, np.ndarray]) -> None:
        self._read = read
        self._grow = loaded.grow
        self._grow.argtypes = [ctypes.POINTER(BatchStructure), ctypes.POINTER(_TreeStructure)]
        self._grow.restype = ctypes.c_longlong
        self._split = loaded.split
        self._split.argtypes = [ctypes.POINTER(BatchStructure), ctypes.POINTER(_TreeStructure)]
        self._split.restype = None

    def grow(
        self,
        prepared: Prepared,
        halves: Halves,
        boxes: Boxes,
        cutoffs: CutoffTables,
        weights: np.ndarray,
        passes: int,
        levels: int,
        workers: int = 1,
    ) -> Growth:
        """Begin to tighten and split boxes, and what comes of them, for some generations.

        Parameters
        ----------
        prepared : Prepared
        halves : Halves
        boxes : Boxes
            With bounds of the objectives that the code knows, no others. Scores of what comes back say nothing.
        cutoffs : CutoffTables
        weights : array (sets, limits + objectives)
        passes : int
            Forward-backward sweeps.
        levels : int
            Generations.
        workers : int
            Threads; the result is the same for any number.
        """
        batches, sizes = Batches(prepared, boxes, weights, passes, still=self._read), prepared.sizes
        fixed, numbers = halves.kept | cutoffs.arrays(), {"levels": levels, **cutoffs.numbers()}
        places = {name: a.ctypes.data for name, a in fixed.items()}
        # Parts have one size, whatever the number of threads: the boxes returned when the capacity is exhausted
        # must not depend on it.
        ends = [(k, min(k + sizes.tree_part, len(boxes))) for k in range(0, len(boxes), sizes.tree_part)]

        def grown(first: int, last: int, read: object) -> tuple[Boxes, np.ndarray, int]:
            """Grow a part; ``read``: what its records have addresses of, which must not end before it does."""
            count = last - first
            # At most all halves of the last generation come back, beside the boxes at hand.
            capacity = min(sizes.capacity_per_box * count + sizes.extra_capacity, (count << levels) + MOST_AT_HAND)
            outputs = output_arrays(boxes, capacity) | {"too_small": np.empty(capacity, dtype=bool)}
            written = {name: a.ctypes.data for name, a in outputs.items()}
            tree = _TreeStructure(capacity=capacity, **numbers, **places, **written)
            kept = self._grow(ctypes.byref(batches.part(first, last)), ctypes.byref(tree))
            if kept < 0:
                raise MemoryError
            return *_grown_boxes(outputs, kept, boxes.scores.shape[1], len(ends) == 1), int(tree.contracted)

        return Growth(SideBySide([partial(grown, *part, (halves, fixed)) for part in ends], workers))

    def split(self, prepared: Prepared, halves: Halves, boxes: Boxes, workers: int = 1) -> tuple[Boxes, Boxes]:
        """Split boxes by their scores.

        Parameters
        ----------
        prepared, halves, boxes, workers
            As for :meth:`grow`; the boxes are scored, and may have bounds of all objectives.

        Returns
        -------
        tuple of Boxes
            First the first halves, in order, then the second halves; and the boxes that are too small to be split.
        """
        count = len(boxes)
        outputs, too_small = scored_output_arrays(boxes, 2 * count), np.empty(count, dtype=bool)
        scores = np.ascontiguousarray(boxes.scores, dtype=np.float32)
        unweighted = np.zeros((1, 0))
        batches = Batches(prepared, boxes, unweighted, 0, moving={**outputs, "scores": scores}, still=self._read)
        places = {name: a.ctypes.data for name, a in halves.kept.items()}

        def halved(first: int, last: int) -> None:
            tree = _TreeStructure(capacity=count, too_small=too_small[first:].ctypes.data, **places)
            self._split(ctypes.byref(batches.part(first, last)), ctypes.byref(tree))

        side_by_side([partial(halved, *ends) for ends in pairwise(prepared.parts(count, workers))], workers)
        both = filled(outputs)
        if not too_small.any():
            return both, boxes.take(slice(0, 0))
        return both.take(np.tile(~too_small, 2)), boxes.take(too_small)


def _grown_boxes(outputs: dict[str, np.ndarray], kept: int, scores: int, sole: bool) -> tuple[Boxes, np.ndarray]:
    """Grown boxes, and which of them are too small; spare capacity is not kept alive.

    ``sole``: the only part, so that no joining will copy them.
    """
    columns = {name.removeprefix("out_"): a[:kept].copy() if sole else a[:kept] for name, a in outputs.items()}
    too_small = columns.pop("too_small")
    return Boxes(scores=np.ones((kept, scores), dtype=np.float32), **columns), too_small
