"""A step of a tree: a batch of boxes is tightened, looked into for designs and split.

The kernel tightens and splits them beside whatever goes on meanwhile, as looking for designs in the batch before.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from synth.bounds.boxes import Boxes, Subtrees
from synth.search.fathoming import unresolved_small
from synth.search.pruning import of_use

if TYPE_CHECKING:
    from synth.bounds.kernel_subtrees import Growth
    from synth.search.formulation import Formulation
    from synth.search.primal_heuristics import PrimalHeuristics
    from synth.search.pruning import TabledPruningRule
    from synth.search.relaxed_boxes import RelaxedBoxes


class BoxStep:
    """A batch of boxes in progress, which must be ended: by finishing or by stopping it.

    Where the kernel is at it, it goes by what designs must keep to be of use when it begins.

    Parameters
    ----------
    form : Formulation
    batch : Boxes
    rule : TabledPruningRule
    heuristics : PrimalHeuristics
    together : RelaxedBoxes, optional
        Bounds boxes by all limits together as well.
    """

    def __init__(
        self,
        form: Formulation,
        batch: Boxes,
        rule: TabledPruningRule,
        heuristics: PrimalHeuristics,
        together: RelaxedBoxes | None = None,
    ) -> None:
        self.form, self.batch, self.rule, self.heuristics, self.together = form, batch, rule, heuristics, together
        # A small batch costs as much as a larger one, so that it is split twice at once.
        self._splits = 2 if together is None and len(batch) < form.tuning.tree.small_batch else 1
        self._growable = together is None and not heuristics.every_goal
        self._open: list[Boxes] = []
        self._growth = self._grown(batch, self._splits)

    def finish(self, node_limit: float) -> tuple[Boxes, Boxes, int]:
        """Look for designs in the boxes that are left, and go on with what they are split into.

        Parameters
        ----------
        node_limit : float
            Boxes that may be looked into.

        Returns
        -------
        tuple
            What is to be looked into next, what is open but too small to be split, and how many boxes were looked into.
        """
        if self._growth is None:
            halves, looked = self._by_steps(), len(self.batch)
        else:
            subtrees = self._growth.subtrees()
            halves, looked = self._without_small(subtrees), subtrees.looked
            if len(halves):
                self.heuristics.search_boxes(halves)
        levels = self.form.tuning.tree.generations
        if self.heuristics.content and len(halves) << levels <= node_limit - looked:
            # It hardly helps to look for designs in between.
            further = self._grown(halves, levels)
            if further is not None:
                subtrees = further.subtrees()
                halves, looked = self._without_small(subtrees), looked + subtrees.looked
        nothing = self.batch.take(slice(0, 0))
        return halves, Boxes.joined(self._open) if self._open else nothing, looked

    def stop(self) -> None:
        """End it; its boxes are open as they were."""
        if self._growth is not None:
            self._growth.stop()

    def _grown(self, boxes: Boxes, levels: int) -> Growth | None:
        """Begin to take boxes some generations further; None where there is no kernel."""
        tables = self.rule.tables(self.form) if self._growable and len(boxes) else None
        return None if tables is None else self.form.boxes.grow(boxes, tables, levels)

    def _by_steps(self) -> Boxes:
        """Tighten the boxes, look for designs in them and split them, one after the other."""
        form, rule, together = self.form, self.rule, self.together
        boxes = of_use(form, rule, self.batch, self.heuristics.every_goal)
        if together is not None and len(boxes):
            boxes = together.tighten(boxes, rule.cutoffs(form.objectives.phi_of(boxes.bounds), boxes.cell))
            boxes = boxes.take(rule.possible_gain(form.objectives.phi_of(boxes.bounds), boxes.cell) > 0)
        if len(boxes):
            self.heuristics.search_boxes(boxes)
            for _ in range(self._splits):
                boxes = self._without_small(Subtrees(*form.boxes.split(boxes), looked=0))
        return boxes

    def _without_small(self, subtrees: Subtrees) -> Boxes:
        """Boxes that can be split; the others are evaluated, and noted if they stay open."""
        if len(subtrees.small):
            self._open.append(unresolved_small(self.form, subtrees.small, self.rule, self.heuristics))
        return subtrees.halves
