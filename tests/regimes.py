"""A referee of problems with kinks: IPOPT in every regime, each with its conditions as limits."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from synth.nlp import ParametricNlp, Task


def best_in_any_regime(
    nlp: ParametricNlp,
    task: Task,
    data: Sequence[float],
    starts: np.ndarray,
    ends: tuple[np.ndarray, np.ndarray],
    bounds: Sequence[float],
    void: np.ndarray,
    cost_of: Callable[[np.ndarray], float],
) -> float:
    """Return the least cost that IPOPT finds in any regime, from any of the starts; infinite where it finds nothing.

    Parameters
    ----------
    nlp, task, data, bounds, void
        As of ``ParametricNlp.solve``; a column without a value is NaN.
    starts : array (starts, variables)
        SI.
    ends : pair of array (variables,)
        The box that is looked into, SI.
    cost_of : callable
        The cost of variables by the formulas as they were written; infinite where a limit does not hold.
    """
    clean = [1.0 if np.isnan(x) else float(x) for x in data]
    least = np.inf
    for regime in itertools.product((False, True), repeat=len(nlp.branches.decisions)):
        for start in starts:
            answer, _ = nlp._solve_branch(regime, task, clean, start, *ends, bounds, void)
            least = least if answer is None else min(least, cost_of(answer.variables))
    return least
