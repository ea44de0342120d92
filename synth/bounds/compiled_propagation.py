"""Compiled code for the boxes of one question: whether it is worth having, and what it reads.

The same steps as :mod:`synth.bounds.propagation` and :mod:`synth.bounds.branching` take over arrays, in one call:
boxes are tightened, snapped to the grid and scored.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from synth.bounds.branching import BranchingWeights, ScoreTables
from synth.bounds.compiled_boxes import BoxCode, CompiledQuestion, Packed, Prepared, compiled
from synth.bounds.compiled_subtrees import CapTables, Grown, Halves
from synth.bounds.propagation import Propagation
from synth.tuning import CompilingLimits


class CompiledPropagation:
    """Compiled contraction of the boxes of one question, as far as it is worth compiling.

    Parameters
    ----------
    propagation : Propagation
    branching : BranchingWeights
    allowed : bool
        Whether code may be compiled for this question alone.
    alike : int
        How many questions of this kind are asked: code serves them all.
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    limits : CompilingLimits
    """

    def __init__(
        self,
        propagation: Propagation,
        branching: BranchingWeights,
        allowed: bool,
        alike: int,
        margins: tuple[float, float],
        limits: CompilingLimits,
    ) -> None:
        self._propagation, self._branching, self._margins, self._limits = propagation, branching, margins, limits
        combinations = propagation.question.instance.combinations.count
        self._allowed, self.at_once = allowed, allowed and combinations * alike >= limits.combinations
        self._contracted: Counter[tuple[bool, bool]] = Counter()
        self._prepared: dict[bool, tuple[ScoreTables, Prepared]] = {}
        self._halved: Halves | None = None

    def packed(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: np.ndarray | None,
        passes: int,
        every: bool,
        workers: int = 1,
    ) -> Packed | None:
        """Tighten, snap and score boxes, and pack what is alive; None where no code is compiled.

        Parameters
        ----------
        cell, low, high, bounds, tag : array (boxes, ...)
        caps : array (objectives,) or (boxes, objectives), optional
        passes : int
        every : bool
        workers : int
            Threads.
        """
        code = self._code(every, caps is not None, len(cell))
        if code is None:
            return None
        weights = self._branching.weights
        return code.contract(self._read(every), cell, low, high, bounds, tag, caps, weights, passes, workers)

    def grown(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: CapTables,
        passes: int,
        levels: int,
        workers: int = 1,
    ) -> Grown | None:
        """Tighten and split boxes for some generations; None where no code is compiled.

        Parameters
        ----------
        cell, low, high, bounds, tag, passes, workers
            As for :meth:`packed`, for the objectives that are bounded in every box.
        caps : CapTables
        levels : int
            Generations.
        """
        code = self._code(False, True, 0)
        if code is None:
            return None
        weights = self._branching.weights
        found = code.grow(
            self._read(False), self._halves(), cell, low, high, bounds, tag, caps, weights, passes, levels, workers
        )
        self._contracted[False, True] += found.contracted
        return found

    def to_compile(self, every: bool, capped: bool, boxes: int) -> bool:
        """Count so many boxes more, and tell whether they are worth compiling: by the question, not by what exists."""
        self._contracted[every, capped] += boxes
        many = self._allowed and self._contracted[every, capped] > self._limits.boxes
        return many or (self.at_once and capped and not every)

    def _code(self, every: bool, capped: bool, boxes: int) -> BoxCode | None:
        if not self.to_compile(every, capped, boxes):
            return None
        return compiled(self._propagation.code(every, capped), self._limits.effort)

    def _read(self, every: bool) -> Prepared:
        """Return the arrays that the code reads, made anew where boxes are scored by other tables."""
        scoring, prepared = self._prepared.get(every, (None, None))
        if prepared is None or scoring is not self._branching.tables:
            contractor = self._propagation.question.contractors[every]
            prepared = Prepared(contractor, self._question(every))
            self._prepared[every] = self._branching.tables, prepared
        return prepared

    def _question(self, every: bool) -> CompiledQuestion:
        question = self._propagation.question
        instance, n = question.instance, question.n
        return CompiledQuestion(
            tables=self._propagation.tables[every],
            constants=np.array(question.constants[every]),
            rights=np.array(question.right_sides),
            root=question.root,
            lower=np.concatenate([instance.ranges.lower, question.low[n:]]),
            upper=np.concatenate([instance.ranges.upper, question.high[n:]]),
            spans=self._branching.spans,
            steep=self._branching.tables.steep,
            spreads=self._branching.tables.spreads,
            grids=question.grids,
            margins=self._margins,
            sizes=self._limits.sizes,
        )

    def _halves(self) -> Halves:
        if self._halved is None:
            question, trees = self._propagation.question, self._propagation.cells.trees
            ranges = np.concatenate(
                [question.instance.ranges.upper - question.instance.ranges.lower, np.zeros(len(question.auxiliary))]
            )
            self._halved = Halves([t.left for t in trees], [t.right for t in trees], ranges)
        return self._halved
