"""The contraction of boxes as a kernel: one code for all questions, which carries out a list of instructions.

One call tightens boxes, snaps them to the grid, scores what is left of them and packs what is alive. Requirement
values, tables and ends are arguments, so that a list serves all questions of a family and pattern of signs.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from synth.bounds.box_batches import Batches, BatchStructure, Prepared, filled, scored_output_arrays
from synth.bounds.boxes import Boxes
from synth.bounds.contractor import Code
from synth.bounds.fused_instructions import fused
from synth.bounds.kernel_subtrees import SubtreeCode
from synth.kernels.loading import kernel
from synth.kernels.threads import side_by_side

# Capacities of the kernel; boxes of a larger question are contracted over arrays.
# Variables are goals as well: the last that settle ties.
MOST = {"N": 24, "LIMITS": 256, "GOALS": 40, "TABLES": 256, "NODES": 1536}
MOST_REGISTERS = 4096


class KernelList:
    """Instructions as the kernel reads them.

    Parameters
    ----------
    code : Code

    Attributes
    ----------
    record : array
        The structure ``Shape`` of the C source: numbers and addresses of eight bytes each.
    """

    def __init__(self, code: Code) -> None:
        nodes, code_list = code.nodes, code.instructions
        at, sizes, factor = code_list.regions, sizes_of(code), [nodes.factor[k] for k in nodes.tables]
        numbers = [
            *(sizes[name] for name in ("N", "LIMITS", "GOALS", "TABLES", "NODES")),
            len(code_list.variables),
            at.count,
            len(code_list.literals),
            code_list.constants,
            *(at.literals, at.constants, at.right_sides, at.cutoffs, at.floors),
            *(at.tables, at.variables, at.open, at.goals, at.scratch),
        ]
        self._kept = [
            code_list.literals,
            np.array(code_list.variables, dtype=np.intc),
            np.array(factor, dtype=np.intc),
            np.array([2 * factor.count(f) for f in factor], dtype=np.intc),
            np.array([2 * factor[:i].count(f) for i, f in enumerate(factor)], dtype=np.intc),
            *(fused(rows) for rows in (code_list.first, code_list.later, code_list.last)),
        ]
        self.record = np.array([*numbers, *(x.ctypes.data for x in self._kept)], dtype=np.int64)


def sizes_of(code: Code) -> dict[str, int]:
    """How large the arrays are that tightening works in."""
    nodes = code.nodes
    return {
        "N": nodes.layout.n_variables + len(nodes.auxiliary),
        "LIMITS": len(nodes.constraints),
        "GOALS": len(nodes.goals),
        "TABLES": len(nodes.tables),
        "NODES": len(nodes.program.nodes),
    }


@dataclass(frozen=True)
class Verdicts:
    """Result of a contraction for each box.

    Parameters
    ----------
    alive : array (boxes,)
        Which boxes are left.
    undecided : array (boxes, limits)
        Limits that a box may still break.
    """

    alive: np.ndarray
    undecided: np.ndarray

    @staticmethod
    def empty(boxes: int, limits: int) -> Verdicts:
        """Arrays for a contraction to fill: no box is alive, no limit undecided."""
        return Verdicts(np.zeros(boxes, dtype=bool), np.zeros((boxes, limits), dtype=bool))


class BoxKernel:
    """Contraction of boxes by a list of instructions.

    Parameters
    ----------
    loaded : CDLL
    listed : KernelList

    Attributes
    ----------
    subtrees : SubtreeCode
        The same, with splitting.
    """

    def __init__(self, loaded: ctypes.CDLL, listed: KernelList) -> None:
        self._listed = listed  # addresses of its arrays are in its record
        self._read = {"shape": listed.record}
        self.subtrees = SubtreeCode(loaded, self._read)
        self._contract = loaded.contract
        self._contract.argtypes = [ctypes.POINTER(BatchStructure)]
        self._contract.restype = ctypes.c_longlong

    def contract(
        self,
        prepared: Prepared,
        boxes: Boxes,
        cutoffs: np.ndarray | None,
        weights: np.ndarray,
        passes: int,
        workers: int = 1,
        verdicts: Verdicts | None = None,
    ) -> Boxes:
        """Tighten, snap and score boxes; return what is alive.

        Parameters
        ----------
        prepared : Prepared
        boxes : Boxes
        cutoffs : array (objectives,) or (boxes, objectives), optional
            Upper bounds of the objectives, with their sign.
        weights : array (sets, limits + objectives)
            One row per set of objectives with a cutoff, a power of 2; or one row alone.
        passes : int
            Forward-backward sweeps.
        workers : int
            Threads; the boxes are split between them and the result is the same for any number.
        verdicts : Verdicts, optional
            Filled with the result for each box.
        """
        most = np.ascontiguousarray(np.full(boxes.bounds.shape[1], np.inf) if cutoffs is None else cutoffs, dtype=float)
        step = most.shape[1] if most.ndim == 2 else 0
        outputs = scored_output_arrays(boxes, len(boxes))
        moving, still = dict(outputs), dict(self._read)
        (moving if step else still)["cutoffs"] = most
        if verdicts is not None:
            moving |= {"alive": verdicts.alive, "undecided": verdicts.undecided}
        batches = Batches(prepared, boxes, weights, passes, moving, still, cutoffs_step=step)
        ends = prepared.parts(len(boxes), workers)
        work = [partial(self._tightened, batches.part(first, last)) for first, last in pairwise(ends)]
        kept = side_by_side(work, workers)
        rows = [slice(first, first + number) for first, number in zip(ends[:-1], kept, strict=True)]
        contracted = filled(outputs)
        return Boxes.joined([contracted.take(alive_rows) for alive_rows in rows])

    def _tightened(self, batch: BatchStructure) -> int:
        """Tighten some boxes; return how many are left."""
        return int(self._contract(ctypes.byref(batch)))


def fits(code: Code) -> bool:
    """True if the code is within the capacities of the kernel."""
    small = all(size <= MOST[name] for name, size in sizes_of(code).items())
    return small and code.instructions.regions.count <= MOST_REGISTERS


def box_kernel(code: Code) -> BoxKernel | None:
    """Kernel for the instructions of a sign pattern; None where none is built or its capacity is exceeded."""
    loaded = kernel("boxes")
    if loaded is None:
        return None
    if code.kernel is None:
        code.kernel = (BoxKernel(loaded, KernelList(code)) if fits(code) else None,)
    cached: BoxKernel | None = code.kernel[0]
    return cached
