"""A front of several objectives, covered as finely as the points asked for need."""

from __future__ import annotations

import numpy as np

from synth.search.branch_and_bound import TreeOutcome
from synth.search.front_state import FrontState
from synth.search.pruning import EpsilonCover
from synth.search.stages.first_designs import beyond_enumeration, few_known
from synth.search.stages.levels import seek_levels
from synth.search.stages.trees import close_open_boxes, cover_everything


def cover_front(state: FrontState) -> None:
    """Cover everything as finely as the requested points need, at most as the gap."""
    rule, outcome = _first_cover(state) if state.task.m == 2 else _cover_three_or_more(state)
    if not outcome.closed and state.task.m == 2:
        if not outcome.abandoned and not _scarce(state):
            rule, outcome = _at_once(state, state.fine_cover(), state.node_limit)
        if not outcome.closed:
            seek_levels(state)
            return
    unresolved = close_open_boxes(state, outcome.open, rule)
    if len(outcome.open) and not len(unresolved):
        state.proof.note_cover(rule)
    state.proof.open_combinations = float(state.form.boxes.cells.size(unresolved.cell).sum())


def _first_cover(state: FrontState) -> tuple[EpsilonCover, TreeOutcome]:
    """Cover a front of two objectives at once, but not for long, least where designs are scarce."""
    limits = state.task.limits
    if beyond_enumeration(state) and not len(state.form.archive):
        at_gap = state.cover_within(state.rule.tolerance)
        cover_everything(state, at_gap, min(state.node_limit, limits.cover_front), enough=0)
    if few_known(state) and state.infeasibility_mode:
        state.begin_again(infeasibility=False)
    at_once = limits.scarce_front if few_known(state) else limits.cover_front
    return _at_once(state, state.fine_cover(), min(state.node_limit, at_once))


def _cover_three_or_more(state: FrontState) -> tuple[EpsilonCover, TreeOutcome]:
    """Cover a front of three objectives or more; as finely as its points lie apart if enough are known then."""
    rule = state.rough_cover()
    outcome = cover_everything(state, rule, state.node_limit)
    fine = state.fine_cover()
    enough = len(state.form.archive) >= state.task.oversampled
    if enough or not outcome.closed or not np.any(fine.tolerance < rule.tolerance):
        return rule, outcome
    return fine, cover_everything(state, fine, state.node_limit)


def _at_once(state: FrontState, rule: EpsilonCover, node_limit: float) -> tuple[EpsilonCover, TreeOutcome]:
    return rule, cover_everything(state, rule, node_limit, judged=True)


def _scarce(state: FrontState) -> bool:
    """True if boxes hardly close: because unknowns are many, or designs few."""
    return state.node_limit < state.task.limits.boxes or len(state.form.archive) < state.task.settings.points
