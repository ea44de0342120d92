"""What is asked of a search afterwards: whether it has designs that beat others, of other families for instance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from synth.search.archive import Candidate, distinct
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.front_state import FrontState
from synth.search.polishing import polish_variables
from synth.search.pruning import NonImprovement
from synth.search.resolution import ROUNDING, ranges


@dataclass(frozen=True)
class Challenge:
    """Comparison of foreign designs with everything that a question allows.

    Parameters
    ----------
    closed : bool
        Whether it is proven that nothing here improves one of them, or one of the designs found instead, by more than
        the gap in every objective.
    better : list of Candidate
        Designs that dominate listed ones, polished.
    amounts : array (objectives,)
        In SI: by how much a design had to be better to count.
    """

    closed: bool
    better: list[Candidate]
    amounts: np.ndarray


def challenge(state: FrontState, listed: np.ndarray, deadline: float) -> Challenge:
    """Search for designs that dominate the listed ones, and prove that no further ones do.

    Parameters
    ----------
    state : FrontState
        Of a search that has been run.
    listed : array (designs, objectives)
        Objectives of the others in SI, with their sign.
    deadline : float
        As of ``time.monotonic``.

    Raises
    ------
    Stopped
        When time is over.
    """
    form, m = state.form, state.task.m
    state.progress.enter("against the others")
    phi = np.zeros((len(listed), len(form.goals)))
    phi[:, :m] = form.objectives.phi_of(listed)
    sizes = np.ones(len(form.goals))
    sizes[:m] = ranges(np.concatenate([phi[:, :m], *(c.phi[None, :m] for c in state.front)]))
    nowhere, members = np.full(form.n, np.nan), {c.phi.tobytes() for c in state.front}
    designs = [*(Candidate(-1, nowhere, row) for row in phi), *state.front]
    tolerance = form.objectives.tolerance(state.task.settings.gap, sizes)[:m]
    staircase = NonImprovement(designs, range(m), tolerance, form.new_archive(range(m)), members)
    staircase.take(form.archive.combination, form.archive.variables, form.archive.phi)
    clock = Clock(deadline, state.progress.working)
    outcome = branch_and_bound(form, state.pool, staircase, clock, state.rng, state.task.limits.boxes)
    improving = [c for c in staircase.designs if c.combination >= 0 and c.phi.tobytes() not in members]
    better = polish_variables(form, distinct(improving, m, state.task.tuning), m, range(m))
    return Challenge(outcome.closed, better, (tolerance + ROUNDING) * form.objectives.scales[:m])
