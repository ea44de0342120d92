"""Which designs stand for all that are known: those that spread best, and differ."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.order.pareto import extremes, spread_subset
from synth.search.archive import Candidate, distinct
from synth.search.front_state import FrontState
from synth.search.resolution import ROUNDING


def spread(state: FrontState, designs: Sequence[Candidate], most: int) -> list[Candidate]:
    """Designs, at most so many, that spread best; the best in each objective among them.

    Designs that take the places of given ones stay before others.
    """
    m = state.task.m
    phi = np.array([c.phi[:m] for c in designs]).reshape(len(designs), m)
    kept, ends = state.start.places(phi, state.task.tuning.tolerances.rounded), leading(state, phi)
    if not kept:
        return [designs[int(k)] for k in spread_subset(phi, most, ends)]
    if not state.proof.closed:
        return [designs[int(k)] for k in spread_subset(phi, most, [*kept, *ends])]
    # What is proven speaks of the best in each objective: they come before designs that were given.
    required = np.array(list(dict.fromkeys([*ends, *kept])))
    if len(required) >= most:
        return [designs[int(required[k])] for k in spread_subset(phi[required], most)]
    return [designs[int(k)] for k in spread_subset(phi, most, required.tolist())]


def leading(state: FrontState, phi: np.ndarray) -> list[int]:
    """Return the positions of designs that are listed in any case: the best in each objective, and the first one."""
    ends = extremes(phi)
    return ends if state.scored is None or not len(phi) else list(dict.fromkeys([*ends, state.scored.best(phi)]))


def different(state: FrontState, designs: Sequence[Candidate]) -> list[Candidate]:
    """Designs that still differ when ties are settled."""
    m = state.task.m
    return distinct(designs, m, state.task.tuning, np.where(state.form.objectives.log[:m], 0.0, ROUNDING))
