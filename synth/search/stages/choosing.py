"""The designs to list: those that spread best, each made as good as its parts allow, and proven."""

from __future__ import annotations

import numpy as np

from synth.search.archive import Candidate, rows_of
from synth.search.front_state import FrontState
from synth.search.polishing import polish_extremes, polish_variables
from synth.search.resolution import ranges
from synth.search.stages.levels import fill_levels
from synth.search.stages.proving import prove_designs, proven_at_gap
from synth.search.stages.spreading import different, spread
from synth.search.stages.trees import cover_everything


def choose_designs(state: FrontState) -> None:
    """Choose the designs to list and prove them; where too few are known, search until there are no more."""
    proof, points = state.proof, state.task.settings.points
    for last in (*(False,) * (state.task.limits.choices - 1), True):
        state.front = _polished(state)
        _rescale(state)
        if not last and _too_few(state) and _search_further(state):
            continue
        # Level by level what one design lacks is nothing to the others.
        open_for_all = not proof.closed and not state.by_levels
        if open_for_all or proof.complete or proven_at_gap(state) or prove_designs(state):
            break
    if proof.closed and not proof.complete and len(state.front) < points and _covered_at_gap(state):
        # Now each design stands that no known one beats, also those that were found meanwhile.
        state.front = _polished(state)
        proof.complete = len(state.front) <= points and _stand_for_all(state)
    standing, state.front = state.front, spread(state, state.front, points)
    state.spare = [c for c in standing if not any(c is member for member in state.front)]
    # Designs that were found since everything was known may be more than are listed.
    proof.complete = proof.complete and _stand_for_all(state)


def _polished(state: FrontState) -> list[Candidate]:
    """Return some more designs than asked for that spread over the front, each made as good as its parts allow."""
    form, m, most = state.form, state.task.m, state.task.oversampled
    archive, done = form.archive, set[bytes]()
    polish_extremes(form, m, float(state.rule.tolerance.max()))
    for _ in range(state.task.limits.polishings):
        rough = [c for c in spread(state, list(archive), most) if c.phi[:m].tobytes() not in done]
        if not rough:
            break
        better = polish_variables(form, rough, m, range(m))
        done.update(c.phi[:m].tobytes() for c in better)
        archive.add(*rows_of(better))
    return spread(state, different(state, list(archive)), most)


def _rescale(state: FrontState) -> None:
    """Measure the gap of objectives that can be zero against their range on this front."""
    phi, rule = np.array([c.phi for c in state.front]), state.rule
    needed = state.form.objectives.tolerance(state.task.settings.gap, ranges(phi))[: state.task.m]
    too_coarse = needed < rule.tolerance
    if np.any(too_coarse):
        # A little less than needed: a range that shrinks by next to nothing shall not need another proof.
        rule.tolerance = np.where(too_coarse, state.task.limits.margin * needed, rule.tolerance)
        state.proof.designs.clear()


def _too_few(state: FrontState) -> bool:
    """True if fewer designs are chosen than asked for, and there may be more."""
    if len(state.front) >= state.task.settings.points or not state.proof.closed or state.proof.complete:
        return False
    return state.may_find_more and not (state.by_levels and proven_at_gap(state))


def _search_further(state: FrontState) -> bool:
    """Find all non-dominated designs, or more than enough of them; True if there are new ones."""
    archive, m, points = state.form.archive, state.task.m, state.task.settings.points
    known, node_limit = archive.phi, state.task.limits.fill + state.counters.nodes
    if state.by_levels:
        # Not everything that is not dominated, but everything that the gap tells apart.
        state.may_find_more = fill_levels(state)
    else:
        finest = state.cover_within(np.full(m, state.task.tuning.tolerances.tie))
        # What was covered before stays so, and need not be looked into again.
        outcome = cover_everything(state, finest, node_limit, points, unresolved=state.open_at_ties)
        state.open_at_ties = outcome.open
        state.proof.complete = outcome.closed and len(archive) <= points
    return not np.array_equal(archive.phi, known)


def _covered_at_gap(state: FrontState) -> bool:
    """True if everything is covered as finely as the gap; a front at once is covered now."""
    if proven_at_gap(state):
        return True
    return not state.by_levels and cover_everything(state, state.rule, state.task.limits.boxes).closed


def _stand_for_all(state: FrontState) -> bool:
    """True if the designs of the front cover all that are known."""
    listed, known = state.phi_listed(), state.form.archive.phi[:, : state.task.m]
    covered = np.all(listed[None, :, :] - state.rule.tolerance <= known[:, None, :], axis=2).any(axis=1)
    return bool(covered.all())
