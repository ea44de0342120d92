"""What can be claimed of the designs listed: the gap that is proven, and the amounts it stands for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from synth.results import Design
from synth.search.front_state import FrontState
from synth.search.proven_gap import Bound, least_gap
from synth.search.resolution import ROUNDING, ranges, rounded_up


def proven_gap(state: FrontState) -> float | None:
    """Return the gap that bounds prove of the designs listed, where it is not the one asked for; none, if any."""
    m, bounds = state.task.m, state.proof.bounds
    if not state.front or not bounds:
        return None
    least = least_gap(bounds, state.phi_listed(), state.form.objectives.log[:m], _sizes(state))
    return None if least is None else max(least, state.task.settings.gap)


def settle_proof(state: FrontState) -> None:
    """Take back a proof that is coarser than the gap; take one that bounds give by themselves."""
    proof, gap = state.proof, state.task.settings.gap
    if not state.front:
        return
    if not _resolved(state):
        proof.closed = proof.exhausted = proof.complete = False
    if state.task.m == 1 and not proof.closed:
        proven = proven_gap(state)
        proof.closed = proof.complete = proven is not None and proven <= gap


def _resolved(state: FrontState) -> bool:
    """True if no objective was told apart more coarsely than the gap asks for, unless the declaration says so."""
    objectives, m = state.form.objectives, state.task.m
    phi = state.phi_listed()
    sizes = np.maximum(np.abs(phi).max(axis=0), np.maximum(ranges(phi), state.spans))
    undeclared = ~objectives.log[:m] & ~objectives.declared[:m]
    return not np.any(undeclared & (objectives.finest[:m] > state.task.settings.gap * sizes))


def gap_amounts(state: FrontState, gap: float, designs: Sequence[Design]) -> dict[str, float]:
    """Amounts in SI that the gap of a claim stands for, per objective where it is no share of the value.

    Parameters
    ----------
    state : FrontState
    gap : float
    designs : list of Design
        As listed: settling ties may have found one that is better by a hair.
    """
    form, m = state.form, state.task.m
    least = gap * _sizes(state)
    if m > 1:
        # The range of a few designs may be less than that of the front they were chosen from.
        least = np.maximum(least, state.rule.tolerance + ROUNDING)
    amounts = least * form.objectives.scales[:m]
    if m == 1 and not form.objectives.declared[0]:
        (name,) = state.task.chosen
        amounts = np.minimum(amounts, gap * abs(designs[0].objectives[name]))
    return {
        name: rounded_up(float(amounts[k]), state.task.instance.model.units[name])
        for k, name in enumerate(state.task.chosen)
        if not form.objectives.log[k]
    }


def finer_than_ties(state: FrontState) -> np.ndarray:
    """Mask of the objectives whose gap is less than settling ties may give away: nearly zero on this front."""
    objectives, m = state.form.objectives, state.task.m
    resolved = state.task.settings.gap * _sizes(state)
    finer: np.ndarray = ~objectives.log[:m] & (resolved < ROUNDING)
    return finer


def claim_no_less(state: FrontState) -> None:
    """Where less is proven than of the starting front, list only the designs that weakly dominate its designs.

    Whatever improves one of these by more than the gap of the starting front would have improved that one as well.
    """
    start, m = state.start, state.task.m
    if start.gap is None or not len(start.phi) or not state.front:
        return
    gap, logs = proven_gap(state), state.form.objectives.log[:m]
    if (gap is not None and gap <= start.gap) or (logs.any() and start.gap >= 1.0):
        return
    places = start.places(state.phi_listed(), state.task.tuning.tolerances.rounded)
    state.front = [state.front[k] for k in sorted(places)]
    share = -math.log1p(-start.gap) if logs.any() else 0.0
    state.proof.note_covered_within(np.where(logs, share, start.amounts / state.form.objectives.scales[:m]))


def note_open_boxes(state: FrontState) -> None:
    """Note what is proven where a tree was stopped: what its open boxes still allow."""
    tolerance, clock, m = state.proof.tolerance_under_way, state.clock, state.task.m
    if tolerance is None or not clock.open:
        return
    boxes = [state.form.objectives.phi_of(b.bounds)[:, :m] for b in clock.open]
    state.proof.bounds.append(Bound(tolerance, np.concatenate(boxes)))


def _sizes(state: FrontState) -> np.ndarray:
    """Reference in phi of the gap of objectives that may be zero, on this front."""
    objectives, m = state.form.objectives, state.task.m
    declared = np.where(objectives.declared[:m], objectives.finest[:m] / state.task.settings.gap, 0.0)
    sizes: np.ndarray = np.maximum(ranges(state.phi_listed()), declared)
    return sizes
