"""The design that comes first: looked for on its own, so that it does not depend on how many others are listed.

Nothing of it is proven but what is proven of every design listed: that none improves it in all objectives. That none
comes nearer to the ideal is as far searched as the boxes allow.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.order.pareto import Scale, nearly
from synth.search.archive import Candidate
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.front_state import FrontState
from synth.search.nearest_ideal import NearestIdeal, ScoredFront
from synth.search.polishing import polish_extremes, polish_variables
from synth.search.stages.one_best import better_in


def find_first(state: FrontState, weights: Sequence[float]) -> None:
    """Measure the front by its ends, and look for the design that comes nearest to the ideal.

    Parameters
    ----------
    state : FrontState
        Designs go into the archive of its formulation.
    weights : list of float
        Of the objectives.
    """
    form, limits = state.form, state.task.limits
    state.scored = ScoredFront(_scale(state), np.asarray(weights, dtype=float), form.objectives)
    rule = NearestIdeal(state.scored, limits.first_share, form.archive)
    if not rule.least or _none_nearer(state, rule):
        return
    state.begin_tree(None)
    outcome = branch_and_bound(
        form, state.pool, rule, state.clock, state.rng, min(limits.first_nodes, state.node_limit)
    )
    state.counters.nodes += outcome.looked
    state.end_tree()


def nearest_among(state: FrontState, signed: np.ndarray, weights: Sequence[float], deadline: float) -> list[Candidate]:
    """Return the design of a finished search that comes first among designs of others, if none of those does.

    What the others reach already cuts off all that comes no nearer to the ideal of all, so the tree is small. Where it
    closes nothing improves the design in every objective, as that would come nearer; where it does not there is none.

    Parameters
    ----------
    state : FrontState
    signed : array (designs, objectives)
        Objectives of all designs in SI, with their sign: the ideal is theirs.
    weights : list of float
    deadline : float
        As of ``time.monotonic``.

    Raises
    ------
    Stopped
        When time is over.
    """
    form, limits, m = state.form, state.task.limits, state.task.m
    scored = ScoredFront(Scale.of(signed), np.asarray(weights, dtype=float), form.objectives)
    least = float(scored.scale.scores(signed, weights).min())
    rule = NearestIdeal(scored, limits.first_share, form.archive, least)
    if not rule.least:
        return []
    state.progress.enter("against the others")
    clock, node_limit = Clock(deadline, state.progress.working), min(limits.first_nodes, state.node_limit)
    outcome = branch_and_bound(form, state.pool, rule, clock, state.rng, node_limit)
    phi = form.archive.phi[:, :m]
    first = scored.best(phi)
    nearer = outcome.closed and scored.scores(phi[[first]])[0] < least * (1.0 - limits.first_share)
    return polish_variables(form, [form.archive[first]], m, range(m)) if nearer else []


def _none_nearer(state: FrontState, rule: NearestIdeal) -> bool:
    """True if what is covered proves already that no design comes nearer to the ideal than the rule asks for."""
    least = _covered_from(state)
    return least is not None and bool(rule.scored.scores(least).min() >= rule.enough)


def _covered_from(state: FrontState) -> np.ndarray | None:
    """Return phi (designs, objectives) such that each possible design is nowhere below some row; None if unknown.

    For each possible design one is known that is worse by no more than the tolerance of the cover in any objective.
    """
    cover = state.proof.finest_cover
    return None if cover is None else state.form.archive.phi[:, : state.task.m] - cover.tolerance


def first_is_listed(state: FrontState) -> bool:
    """True if the design that comes first is listed, with what is best in each objective, and none is beaten."""
    m, rounded = state.task.m, state.task.tuning.tolerances.rounded
    phi, scored = state.form.archive.phi[:, :m], state.scored
    if scored is None or not len(state.front):
        return True
    listed, known = state.phi_listed(), {row.tobytes() for row in phi}
    beaten = any(row.tobytes() not in known for row in listed)
    if beaten or np.any(phi.min(axis=0) < listed.min(axis=0) - rounded):
        return False
    return bool(np.any(np.all(listed <= phi[scored.best(phi)] + rounded, axis=1)))


def _scale(state: FrontState) -> Scale:
    """Return the scale of the front: what is best in each objective, and what the others must cost then."""
    form, m, limits = state.form, state.task.m, state.task.limits
    for k in range(m):
        _least_in(state, k, np.full(len(form.goals), np.inf), limits.first_nodes)
    polish_extremes(form, m, float(state.rule.tolerance.max()))
    ideal = form.objectives.values_of(form.archive.phi[:, :m]).min(axis=0)
    worst = _worst_at_ends(state, ideal, limits.end_nodes)  # what comes first at an end is best in the others as well
    near = nearly(ideal, worst)
    return Scale(ideal, np.maximum(near, _worst_at_ends(state, near, limits.first_nodes)))


def _worst_at_ends(state: FrontState, ends: np.ndarray, node_limit: int) -> np.ndarray:
    """Return the most that each objective must be, for another one to be as good as its end (objectives, in SI)."""
    form, m = state.form, state.task.m
    phi, worst = form.objectives.phi_of(ends[None, :])[0], np.full(m, -np.inf)
    for k in range(m):
        for j in (j for j in range(m) if j != k):
            cutoffs = np.full(len(form.goals), np.inf)
            # As known now: a better design may have taken the place of the one that was the best in this one by a hair.
            cutoffs[k] = max(phi[k], float(form.archive.phi[:, k].min()))
            worst[j] = max(worst[j], _least_in(state, j, cutoffs, node_limit))
    return worst


def _least_in(state: FrontState, k: int, cutoffs: np.ndarray, node_limit: int) -> float:
    """Return the least signed value of an objective that is found within cutoffs, which some known design keeps."""
    form, limits = state.form, state.task.limits
    phi = form.archive.phi
    within = np.flatnonzero(np.all(phi <= cutoffs, axis=1))
    start = form.archive[int(within[np.argmin(phi[within, k])])]
    beaten = start.phi[k] > phi[:, k].min() or not np.isfinite(cutoffs).any()
    if beaten and not _is_least(state, k, cutoffs, start):
        start = better_in(state, k, cutoffs, start, node_limit, limits.first_gap) or start
    return float(form.objectives.signed(k, start.phi[k]))


def _is_least(state: FrontState, k: int, cutoffs: np.ndarray, design: Candidate) -> bool:
    """True if what is covered proves already that nothing within cutoffs is better than a design."""
    least = _covered_from(state)
    if least is None:
        return False
    # What covers a design within the cutoffs may itself miss them, by no more than the tolerance.
    within = np.all(least <= cutoffs[: state.task.m], axis=1)
    gap = min(state.task.settings.gap, state.task.limits.first_gap)
    tolerance = float(state.form.objectives.tolerance(gap, np.abs(design.phi))[k])
    return bool(design.phi[k] - least[within, k].min(initial=np.inf) <= tolerance)
