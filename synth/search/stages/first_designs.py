"""The first designs: from similar questions, or from a coarse look at everything."""

from __future__ import annotations

from synth.search.front_state import FrontState
from synth.search.large_neighbourhood import large_neighbourhood_search
from synth.search.one_exchange import OneExchange
from synth.search.pruning import EpsilonCover
from synth.search.stages.trees import cover_everything
from synth.search.warm_start import warm_start


def bound_everything(state: FrontState) -> None:
    """Begin with the box of everything; nothing is feasible where nothing is left of it."""
    state.clock.check()
    state.set_pool()
    if not len(state.pool):
        state.proof.open_combinations = 0.0


def find_first_designs(state: FrontState) -> None:
    """Search for the first designs; where there are none yet, prepare a proof of infeasibility."""
    known = state.task.warm.designs
    if known and warm_start(state.form, state.rule, known, state.rng):
        # For one objective little is left to look for, where what is worth splitting is known as well.
        if state.task.m > 1 or not state.taught:
            search_near_known(state, state.fine_cover())
        return
    if _explore(state) or not len(state.pool):
        return
    state.begin_again(infeasibility=True)
    _explore(state)


def _explore(state: FrontState) -> bool:
    """Cover everything coarsely and search near the new designs; True if a feasible one is known."""
    limits, one, form = state.task.limits, state.task.m == 1, state.form
    coarse = state.cover_within(state.rule.tolerance * max(limits.coarse / state.task.settings.gap, 1.0))
    outcome = cover_everything(state, coarse, limits.first_boxes if one else limits.coarse_boxes)
    if not len(form.archive) and not outcome.closed and one:
        outcome = cover_everything(state, coarse, limits.coarse_boxes)
    if len(form.archive):
        search_near_known(state, state.fine_cover())
    elif outcome.closed:
        state.pool, state.proof.open_combinations = form.boxes.nothing(), 0.0
    return bool(len(form.archive))


def search_near_known(state: FrontState, rule: EpsilonCover) -> None:
    """Search for designs near the known ones."""
    OneExchange(state.form, rule, state.rng).improve(state.clock)


def beyond_enumeration(state: FrontState) -> bool:
    """True if there are more combinations than are solved one by one."""
    return state.task.instance.combinations.count > state.task.limits.few_combinations


def few_known(state: FrontState) -> bool:
    """True if so few designs of many combinations are known, but not none, that more effort pays."""
    return beyond_enumeration(state) and 0 < len(state.form.archive) < state.task.tuning.heuristics.primal.scarce


def search_neighbourhoods(state: FrontState) -> None:
    """Search a few combinations near the known designs, where these are few."""
    if few_known(state):
        large_neighbourhood_search(state.form, state.rule.columns, state.rule.tolerance, state.clock, state.rng)
        search_near_known(state, state.fine_cover())
