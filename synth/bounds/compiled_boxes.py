"""The contraction of boxes compiled, where there is a C compiler: the same statements, over registers of boxes.

One call tightens boxes, snaps them to the grid, scores what is left of them and packs what is alive. Requirement
values, tables and ends are arguments, so that the code is compiled once per family and pattern of signs.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from synth.bounds.box_batches import Batches, BatchStructure, Prepared, filled, scored_room
from synth.bounds.box_source import source
from synth.bounds.boxes import Boxes
from synth.bounds.compiled_subtrees import SubtreeCode
from synth.bounds.contractor import Code
from synth.bounds.interpreted_boxes import ListedCode, listed_code
from synth.bounds.interpreted_boxes import source as interpreter_source
from synth.compiled.compilation import NotCompiled, switched_on
from synth.compiled.compiler import QUICK, LibraryBeside, library
from synth.compiled.threads import side_by_side
from synth.operating_system import COMPILER_FLAGS
from synth.tuning import CompilingEffort, CompilingLimits

# No contraction of products and sums: the ends of an interval must round as they do in NumPy.
BOX_FLAGS = (*COMPILER_FLAGS, "-ffp-contract=off")
GENERAL_FLAGS = (*QUICK, "-ffp-contract=off")


@dataclass(frozen=True)
class Verdicts:
    """What a contraction finds of each box, where that is wanted: searches go by the boxes that are left.

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
    def room(boxes: int, limits: int) -> Verdicts:
        """Return room for what is found of so many boxes."""
        return Verdicts(np.zeros(boxes, dtype=bool), np.zeros((boxes, limits), dtype=bool))


class BoxCode:
    """Compiled contraction of boxes.

    Parameters
    ----------
    loaded : CDLL
    listed : ListedCode, optional
        The list that the code goes by, if it is not the question's own.

    Attributes
    ----------
    subtrees : SubtreeCode
        The same, with splitting.
    """

    def __init__(self, loaded: ctypes.CDLL, listed: ListedCode | None = None) -> None:
        self._listed = listed  # addresses of its arrays are in its record
        self._read: dict[str, np.ndarray] = {} if listed is None else {"shape": listed.record}
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
            Takes what is found of each box.
        """
        most = np.ascontiguousarray(np.full(boxes.bounds.shape[1], np.inf) if cutoffs is None else cutoffs, dtype=float)
        step = most.shape[1] if most.ndim == 2 else 0
        taken = scored_room(boxes, len(boxes))
        moving, still = dict(taken), dict(self._read)
        (moving if step else still)["cutoffs"] = most
        if verdicts is not None:
            moving |= {"alive": verdicts.alive, "undecided": verdicts.undecided}
        batches = Batches(prepared, boxes, weights, passes, moving, still, cutoffs_step=step)
        ends = prepared.parts(len(boxes), workers)
        work = [partial(self._tightened, batches.part(first, last)) for first, last in pairwise(ends)]
        kept = side_by_side(work, workers)
        rows = [slice(first, first + number) for first, number in zip(ends[:-1], kept, strict=True)]
        found = filled(taken)
        return Boxes.joined([found.take(own) for own in rows])

    def _tightened(self, batch: BatchStructure) -> int:
        """Tighten some boxes; return how many are left."""
        return int(self._contract(ctypes.byref(batch)))


class CompiledForms:
    """What is compiled of generated code: one library for all formulas, then one of its own. Both give the same bits.

    Where an earlier program has left the latter it is used from the beginning.

    Parameters
    ----------
    code : Code
    """

    def __init__(self, code: Code) -> None:
        self._code, self._text = code, source(code)
        self._boxes, self._hopeless = 0.0, False
        self._shared: BoxCode | None = None
        self._own: BoxCode | None = None
        self._beside: LibraryBeside | None = None
        self._listed: ListedCode | None = None

    def take(self, boxes: int, limits: CompilingLimits) -> BoxCode | None:
        """Return the code for so many boxes more; None where it cannot be had.

        The code outlives a question, so that each brings its own limits.

        Raises
        ------
        NotCompiled
            The time limit is too short for compiling it.
        """
        if self._beside is None and self._text is not None:
            self._beside = LibraryBeside("boxes", self._text, limits.effort, BOX_FLAGS)
            kept = self._beside.kept()
            self._own = None if kept is None else BoxCode(kept)
        if self._own is None and self._listed is None and not self._hopeless:
            self._listed = listed_code(self._code)
            self._own = self._made_now(limits.effort) if self._listed is None else None
        if self._own is None and self._listed is not None and self._beside is not None:
            self._own = self._made_beside(self._beside, boxes, limits)
        return self._own or self._shared_code(limits.effort)

    def _shared_code(self, effort: CompilingEffort) -> BoxCode | None:
        if self._shared is None and self._listed is not None and not self._hopeless:
            loaded = library("boxes_general", interpreter_source(), effort, GENERAL_FLAGS)
            self._shared = None if loaded is None else BoxCode(loaded, self._listed)
            self._hopeless = loaded is None
        return self._shared

    def _made_now(self, effort: CompilingEffort) -> BoxCode | None:
        loaded = None if self._text is None else library("boxes", self._text, effort, BOX_FLAGS)
        self._hopeless = loaded is None
        return None if loaded is None else BoxCode(loaded)

    def _made_beside(self, beside: LibraryBeside, boxes: int, limits: CompilingLimits) -> BoxCode | None:
        demand = beside.demand(limits.again)
        if demand is not None:
            demand.here += boxes
        self._boxes += boxes
        loaded = beside.loaded() if self._boxes > limits.own else None
        return None if loaded is None else BoxCode(loaded)


def compiled(code: Code, boxes: int, limits: CompilingLimits) -> BoxCode | None:
    """Return the compiled form of generated code for so many boxes more; None where it cannot be had."""
    if not switched_on():
        return None
    if code.compiled is None:
        code.compiled = CompiledForms(code)
    forms: CompiledForms = code.compiled
    try:
        return forms.take(boxes, limits)
    except NotCompiled:
        return None


def begin(effort: CompilingEffort) -> None:
    """Let what serves all formulas be compiled beside other work, where it is not there yet."""
    LibraryBeside("boxes_general", interpreter_source(), effort, GENERAL_FLAGS).loaded()
