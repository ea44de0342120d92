"""The proof of the designs chosen: nothing is better than one of them by more than the gap in every objective."""

from __future__ import annotations

import numpy as np

from synth.search.branch_and_bound import TreeOutcome, branch_and_bound
from synth.search.epsilon_constraint import prove_by_epsilon_constraint
from synth.search.front_state import FrontState
from synth.search.pruning import NonImprovement
from synth.search.stages.spreading import different
from synth.search.stages.trees import close_open_boxes


def proven_at_gap(state: FrontState) -> bool:
    """Tell whether everything is covered as finely as the gap."""
    cover = state.proof.finest_cover
    return cover is not None and float(np.max(cover.tolerance / state.rule.tolerance)) <= 1.0


def prove_designs(state: FrontState) -> bool:
    """Prove the designs chosen; tell whether they stand, or better ones were found for some of too few."""
    proven = state.proof.designs
    staircase = NonImprovement(state.front, state.rule.columns, state.rule.tolerance, state.form.archive, proven)
    state.proof.staircase = staircase
    outcome = _tree(state, staircase)
    state.counters.nodes += outcome.looked
    left = close_open_boxes(state, outcome.open, staircase)
    state.proof.staircase = None
    state.end_tree()
    replaced = any(a is not b for a, b in zip(staircase.designs, state.front, strict=True))
    finished = staircase.finished()
    state.front = different(state, finished)
    if not len(left):
        proven.update(c.phi.tobytes() for c in finished)
    return bool(len(left)) or not replaced or len(state.front) >= state.task.settings.points


def _tree(state: FrontState, staircase: NonImprovement) -> TreeOutcome:
    """Search below the designs, step by step where that has turned out to be easier."""
    form, pool, clock, rng = state.form, state.pool, state.clock, state.rng
    if state.by_steps:
        state.begin_tree(None)  # the boxes of one step are not all that is open
        return prove_by_epsilon_constraint(form, pool, staircase, clock, rng, state.node_limit)
    state.begin_tree(staircase.tolerance)
    return branch_and_bound(form, pool, staircase, clock, rng, state.task.limits.boxes)
