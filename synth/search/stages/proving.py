"""The proof of the designs chosen: nothing is better than one of them by more than the gap in every objective."""

from __future__ import annotations

import numpy as np

from synth.order.pareto import spread_subset
from synth.search.archive import Candidate
from synth.search.branch_and_bound import branch_and_bound
from synth.search.front_state import FrontState
from synth.search.pruning import NonImprovement
from synth.search.stages.levels import prove_levels, proven_by_levels
from synth.search.stages.spreading import different, leading, spread
from synth.search.stages.trees import close_open_boxes


def proven_at_gap(state: FrontState) -> bool:
    """True if everything is covered as finely as the gap."""
    cover = state.proof.finest_cover
    return cover is not None and float(np.max(cover.tolerance / state.rule.tolerance)) <= 1.0


def prove_designs(state: FrontState) -> bool:
    """Prove the designs chosen; tell whether they stand, or better ones were found for some of too few."""
    stand = None if state.by_levels else _prove_at_once(state)
    return _prove_by_levels(state) if stand is None else stand


def _prove_at_once(state: FrontState) -> bool | None:
    """Search below all designs at once; None where that does not end soon, and two objectives are traded off."""
    limits, two, staircase = state.task.limits, state.task.m == 2, _staircase(state)
    state.begin_tree(staircase.tolerance)
    clock, rng, hopeless = state.clock, state.rng, state.hopeless
    outcome = branch_and_bound(state.form, state.pool, staircase, clock, rng, limits.boxes, hopeless=hopeless)
    state.counters.nodes += outcome.looked
    if two and not outcome.closed:
        state.end_tree()
        state.front, state.by_levels = different(state, staircase.finished()), True
        return None
    return _stand(state, staircase, not len(close_open_boxes(state, outcome.open, staircase)))


def _prove_by_levels(state: FrontState) -> bool:
    """Prove each design at a level of its own, so that no more are worth it than are listed."""
    state.front = _worth_proving(state)
    staircase = _staircase(state)
    return _stand(state, staircase, prove_levels(state, staircase))


def _worth_proving(state: FrontState) -> list[Candidate]:
    """Return as many designs as are asked for that spread best; those that are proven stay."""
    points, phi = state.task.settings.points, state.phi_listed()
    proven = np.flatnonzero(proven_by_levels(state, phi)).tolist()
    if len(state.start.phi) or not proven:
        return spread(state, state.front, points)
    return [state.front[int(k)] for k in spread_subset(phi, points, [*leading(state, phi), *proven])]


def _staircase(state: FrontState) -> NonImprovement:
    """Criterion for designs that improve those of the front."""
    proven, rule = state.proof.designs, state.rule
    state.proof.staircase = NonImprovement(state.front, rule.columns, rule.tolerance, state.form.archive, proven)
    return state.proof.staircase


def _stand(state: FrontState, staircase: NonImprovement, closed: bool) -> bool:
    """Take the designs that stand; tell whether they are enough, or nothing better is found for them."""
    state.proof.staircase = None
    state.end_tree()
    replaced = any(a is not b for a, b in zip(staircase.designs, state.front, strict=True))
    finished = staircase.finished()
    state.front = different(state, finished)
    if closed:
        state.proof.designs.update(c.phi.tobytes() for c in finished)
    return not closed or not replaced or len(state.front) >= state.task.settings.points
