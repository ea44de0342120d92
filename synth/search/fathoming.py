"""Fathoming: what becomes of boxes that are too small to be split. A fault here makes a certificate wrong."""

from __future__ import annotations

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.pruning import PruningRule


def unresolved_small(form: Formulation, small: Boxes, rule: PruningRule, heuristics: PrimalHeuristics) -> Boxes:
    """Evaluate boxes that are too small to be split; return those that may hold a design no known one covers.

    Parameters
    ----------
    form : Formulation
    small : Boxes
    rule : PruningRule
        Tells what known designs cover.
    heuristics : PrimalHeuristics
        Takes what is feasible in a box; what it misses stays open.

    Returns
    -------
    Boxes
        Never fewer than what is open: a box is dropped where the rule leaves nothing to gain in it, or where it is a
        single point that was evaluated.
    """
    heuristics.offer(form.boxes.inside(small, 0.5), form.boxes.combination(small))
    kept = small.take(rule.possible_gain(form.objectives.phi_of(small.bounds), small.cell) > 0)
    # The boxes kept are feasible by the tolerance alone, or nearly so.
    _, stood_for = heuristics.on_edge(form.boxes.inside(kept, 0.5), form.boxes.combination(kept), len(kept))
    low, high = form.boxes.ends(kept)
    extended = np.any(high - low > form.tuning.tolerances.point * np.abs(high), axis=1)
    phi = form.objectives.phi_of(kept.bounds)
    # Whatever the tolerance of the rule, what a design gains by using up the tolerance is not worth telling apart.
    extended[stood_for] = True
    worth = np.zeros(phi.shape[1])
    worth[rule.columns] = np.maximum(form.tuning.tolerances.edge_worth - rule.tolerance, 0.0)
    phi[stood_for] += worth
    return kept.take(extended & (rule.possible_gain(phi, kept.cell) > 0))
