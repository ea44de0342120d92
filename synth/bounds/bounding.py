"""All that bounds and scores the boxes of one question: sound bounds, branching weights and the kernel together."""

from __future__ import annotations

import copy

from synth.bounds.branching import BranchingWeights
from synth.bounds.clusters import Cells
from synth.bounds.influences import Influences
from synth.bounds.kernel_propagation import KernelPropagation
from synth.bounds.propagation import Propagation
from synth.bounds.question_bounds import QuestionBounds
from synth.bounds.settings import BranchingSettings, KernelSizes
from synth.question.search_space import SearchSpace


class Bounding:
    """All that bounds the boxes of one question and says where to split them.

    Parameters
    ----------
    question : QuestionBounds
    workers : int
        Threads that may tighten boxes at the same time, where kernels compute.
    settings : BranchingSettings
    sizes : KernelSizes
    margins : tuple of float
        By how much a value may miss the grid: relative, and absolute in SI.

    Attributes
    ----------
    question : QuestionBounds
        What holds everywhere in it: sound.
    propagation : Propagation
        What holds in boxes: sound.
    branching : BranchingWeights
        Where boxes are split: proves nothing.
    kernel : KernelPropagation
        Both by the kernel.
    goal_sizes : array (objectives,)
        Median sizes of the objectives over the question.
    """

    def __init__(
        self,
        question: QuestionBounds,
        workers: int,
        settings: BranchingSettings,
        sizes: KernelSizes,
        margins: tuple[float, float],
    ) -> None:
        self._settings, self._sizes, self._margins = settings, sizes, margins
        self._influences = Influences(question, settings)
        self.goal_sizes = self._influences.goal_sizes
        trees = [self._influences.clusters(factor) for factor in question.factors]
        self._begin(Propagation(question, Cells(trees, question.instance.combinations.radix)), workers)

    def among(self, instance: SearchSpace, workers: int) -> Bounding | None:
        """Bounding for other rows of the first factor, with nothing learned: :meth:`QuestionBounds.among`."""
        question = self.question.among(instance)
        if question is None:
            return None
        new = copy.copy(self)
        first = self._influences.clusters(question.factors[0])
        new._begin(self.propagation.among(question, first), workers)
        return new

    def _begin(self, propagation: Propagation, workers: int) -> None:
        self.question, self.propagation = propagation.question, propagation
        self.branching = BranchingWeights(self.question, propagation.cells.trees, self._influences, self._settings)
        self.kernel = KernelPropagation(propagation, self.branching, workers, self._margins, self._sizes)
