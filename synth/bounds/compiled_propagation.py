"""Compiled code for the boxes of one question: whether it is worth having, and what it reads.

The same steps as :mod:`synth.bounds.propagation` and :mod:`synth.bounds.branching` take over arrays, in one call:
boxes are tightened, snapped to the grid and scored.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from synth.bounds.box_batches import CompiledQuestion, Prepared
from synth.bounds.boxes import Boxes, Subtrees
from synth.bounds.branching import BranchingWeights, ScoreTables
from synth.bounds.compiled_boxes import BoxCode, compiled
from synth.bounds.compiled_subtrees import CutoffTables, Growth, Halves
from synth.bounds.propagation import Propagation
from synth.compiled.execution import Execution
from synth.tuning import CompilingLimits


class CompiledPropagation:
    """Compiled contraction of the boxes of one question, as far as it is worth compiling.

    Parameters
    ----------
    propagation : Propagation
    branching : BranchingWeights
    execution : Execution
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    limits : CompilingLimits

    Attributes
    ----------
    at_once : bool
        Whether code for boxes with cutoffs is compiled from the first: by the question alone.
    """

    def __init__(
        self,
        propagation: Propagation,
        branching: BranchingWeights,
        execution: Execution,
        margins: tuple[float, float],
        limits: CompilingLimits,
    ) -> None:
        self._propagation, self._branching, self._margins, self._limits = propagation, branching, margins, limits
        combinations = propagation.question.instance.combinations.count
        self._execution = execution
        self.at_once = execution.compiled and combinations * execution.similar_questions >= limits.combinations
        self._contracted: Counter[tuple[bool, bool]] = Counter()
        self._prepared: dict[bool, tuple[ScoreTables, Prepared]] = {}
        self._halved: Halves | None = None
        self._grown = 0

    def contract(self, boxes: Boxes, cutoffs: np.ndarray | None, passes: int, every: bool) -> Boxes | None:
        """Tighten, snap and score boxes; return what is alive, and None where no code is compiled.

        Parameters
        ----------
        boxes : Boxes
        cutoffs : array (objectives,) or (boxes, objectives), optional
            Upper bounds of the objectives, with their sign.
        passes : int
            Forward-backward sweeps.
        every : bool
            Whether objectives that only settle ties count.
        """
        code = self._code(every, cutoffs is not None, len(boxes))
        if code is None:
            return None
        weights, workers = self._branching.weights, self._execution.workers
        return code.contract(self._read(every), boxes, cutoffs, weights, passes, workers)

    def grow(self, boxes: Boxes, cutoffs: CutoffTables, passes: int, levels: int) -> Growth | None:
        """Begin to tighten and split boxes for some generations; None where no code is compiled.

        Parameters
        ----------
        boxes : Boxes
            With bounds of those objectives alone that are bounded in every box.
        cutoffs : CutoffTables
        passes : int
            Forward-backward sweeps.
        levels : int
            Generations.
        """
        # What one call looks into is known afterwards; the next one counts it.
        counted, self._grown = self._grown, 0
        code = self._code(False, True, 0, counted)
        if code is None:
            return None
        prepared, weights, workers = self._read(False), self._branching.weights, self._execution.workers
        growth = code.subtrees.grow(prepared, self._halves(), boxes, cutoffs, weights, passes, levels, workers)
        return growth.then(self._counted)

    def _counted(self, found: Subtrees) -> Subtrees:
        self._contracted[False, True] += found.looked
        self._grown += found.looked
        return found

    def split(self, boxes: Boxes) -> tuple[Boxes, Boxes] | None:
        """Split scored boxes; return their halves and what is too small, and None where no code is compiled."""
        code = self._code(False, True, 0)
        if code is None:
            return None
        return code.subtrees.split(self._read(False), self._halves(), boxes, self._execution.workers)

    def to_compile(self, every: bool, capped: bool, boxes: int) -> bool:
        """Count so many boxes more, and tell whether they are worth compiling: by the question, not by what exists."""
        self._contracted[every, capped] += boxes
        many = self._execution.compiled and self._contracted[every, capped] > self._limits.boxes
        return many or (self.at_once and capped and not every)

    def _code(self, every: bool, capped: bool, boxes: int, grown: int = 0) -> BoxCode | None:
        if not self.to_compile(every, capped, boxes):
            return None
        return compiled(self._propagation.code(every, capped), boxes + grown, self._limits)

    def _read(self, every: bool) -> Prepared:
        """Return the arrays that the code reads, made anew where boxes are scored by other tables."""
        scoring, prepared = self._prepared.get(every, (None, None))
        if prepared is None or scoring is not self._branching.tables:
            prepared = Prepared(self._question(every))
            self._prepared[every] = self._branching.tables, prepared
        return prepared

    def _question(self, every: bool) -> CompiledQuestion:
        question = self._propagation.question
        instance, n, floors = question.instance, question.n, self._propagation.floors
        goals = len(question.contractors[every].nodes.goals)
        return CompiledQuestion(
            tables=self._propagation.tables[every],
            constants=np.array(question.constants[every]),
            right_sides=np.array(question.right_sides),
            root=question.root,
            lower=np.concatenate([instance.ranges.lower, question.low[n:]]),
            upper=np.concatenate([instance.ranges.upper, question.high[n:]]),
            spans=self._branching.spans,
            scoring=self._branching.tables,
            grids=question.grids,
            margins=self._margins,
            sizes=self._limits.sizes,
            floors=None if floors is None else floors[:, :goals],
        )

    def _halves(self) -> Halves:
        if self._halved is None:
            question, trees = self._propagation.question, self._propagation.cells.trees
            ranges = np.concatenate(
                [question.instance.ranges.upper - question.instance.ranges.lower, np.zeros(len(question.auxiliary))]
            )
            self._halved = Halves([t.left for t in trees], [t.right for t in trees], ranges)
        return self._halved
