"""The kernel for the boxes of one question: what it reads.

The same steps as :mod:`synth.bounds.propagation` and :mod:`synth.bounds.branching` take over arrays, in one call:
boxes are tightened, snapped to the grid and scored.
"""

from __future__ import annotations

import numpy as np

from synth.bounds.box_batches import KernelQuestion, Prepared
from synth.bounds.boxes import Boxes
from synth.bounds.branching import BranchingWeights, ScoreTables
from synth.bounds.kernel_boxes import BoxKernel, box_kernel
from synth.bounds.kernel_subtrees import CutoffTables, Growth, Halves
from synth.bounds.propagation import Propagation
from synth.bounds.settings import KernelSizes


class KernelPropagation:
    """Contraction of the boxes of one question by the kernel.

    Parameters
    ----------
    propagation : Propagation
    branching : BranchingWeights
    workers : int
        Threads.
    margins : (float, float)
        By how much a value may miss the grid, relative and absolute.
    sizes : KernelSizes
    """

    def __init__(
        self,
        propagation: Propagation,
        branching: BranchingWeights,
        workers: int,
        margins: tuple[float, float],
        sizes: KernelSizes,
    ) -> None:
        self._propagation, self._branching, self._workers = propagation, branching, workers
        self._margins, self._sizes = margins, sizes
        self._prepared: dict[bool, tuple[ScoreTables, Prepared]] = {}
        self._halved: Halves | None = None

    def contract(self, boxes: Boxes, cutoffs: np.ndarray | None, passes: int, every: bool) -> Boxes | None:
        """Tighten, snap and score boxes; return what is alive, and None where there is no kernel.

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
        kernel = self._kernel(every, cutoffs is not None)
        if kernel is None:
            return None
        return kernel.contract(self._read(every), boxes, cutoffs, self._branching.weights, passes, self._workers)

    def grow(self, boxes: Boxes, cutoffs: CutoffTables, passes: int, levels: int) -> Growth | None:
        """Begin to tighten and split boxes for some generations; None where there is no kernel.

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
        kernel = self._kernel(False, True)
        if kernel is None:
            return None
        prepared, weights, workers = self._read(False), self._branching.weights, self._workers
        return kernel.subtrees.grow(prepared, self._halves(), boxes, cutoffs, weights, passes, levels, workers)

    def split(self, boxes: Boxes) -> tuple[Boxes, Boxes] | None:
        """Split scored boxes; return their halves and what is too small, and None where there is no kernel."""
        kernel = self._kernel(False, True)
        if kernel is None:
            return None
        return kernel.subtrees.split(self._read(False), self._halves(), boxes, self._workers)

    def _kernel(self, every: bool, capped: bool) -> BoxKernel | None:
        return box_kernel(self._propagation.code(every, capped))

    def _read(self, every: bool) -> Prepared:
        """Return the arrays that the code reads, made anew where boxes are scored by other tables."""
        scoring, prepared = self._prepared.get(every, (None, None))
        if prepared is None or scoring is not self._branching.tables:
            prepared = Prepared(self._question(every))
            self._prepared[every] = self._branching.tables, prepared
        return prepared

    def _question(self, every: bool) -> KernelQuestion:
        question = self._propagation.question
        instance, n, floors = question.instance, question.n, self._propagation.floors
        goals = len(question.contractors[every].nodes.goals)
        return KernelQuestion(
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
            sizes=self._sizes,
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
