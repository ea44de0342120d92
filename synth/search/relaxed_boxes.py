"""Boxes that are bounded by all limits together, one linear program each: few, where limits one by one leave many."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.log_relaxation import LogRelaxation
from synth.bounds.relaxed_branching import relaxed_scores
from synth.search.formulation import Formulation
from synth.system import deadline


class RelaxedBoxes:
    """Tightens the boxes of a formulation by all limits together.

    Parameters
    ----------
    form : Formulation
    target : int
        The objective that is bounded.
    """

    def __init__(self, form: Formulation, target: int) -> None:
        self.form, self.target, self.settings = form, target, form.tuning.tree.together
        self.relaxation = LogRelaxation(form.bounding.propagation, self.settings)

    def tighten(self, boxes: Boxes, cutoffs: np.ndarray) -> Boxes:
        """Remaining boxes after tightening limit by limit; ``cutoffs`` bound phi, a row per box."""
        kept = []
        for first in range(0, len(boxes), self.settings.at_once):
            deadline.check()
            rows = slice(first, first + self.settings.at_once)
            kept.append(self._tightened(boxes.take(rows), self.form.objectives.values_of(cutoffs[rows])))
        return self.form.boxes.snapped(Boxes.joined(kept)) if kept else boxes

    def _tightened(self, boxes: Boxes, values: np.ndarray) -> Boxes:
        relaxed = self.relaxation.run(boxes, values, self.target)
        scores = boxes.scores.copy()
        width, factors = boxes.low.shape[1], boxes.cell.shape[1]
        for points in relaxed.points:
            local_scores = relaxed_scores(self.relaxation.nodes, points, width, factors)
            most = local_scores.max(axis=1, keepdims=True, initial=0.0)
            before = scores[points.rows]
            others = before / np.maximum(before.max(axis=1, keepdims=True, initial=0.0), 1e-30)
            scores[points.rows] = np.where(
                most > 0, local_scores / np.maximum(most, 1e-300) + self.settings.others * others, before
            )
        return replace(relaxed.boxes, scores=scores).take(relaxed.alive)
