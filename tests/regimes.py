"""IPOPT as the referee: of one design at a time, and of kinks in every regime with its conditions as limits."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from synth.model.constraint import void_limits
from synth.search.formulation import Formulation
from tests.referees.ipopt import ParametricNlp, Solution, Task


def referee(form: Formulation) -> ParametricNlp:
    """Return the problem of a question for IPOPT; built once per model and set of rows."""
    rows = form.continuous.rows
    made: ParametricNlp = form.model.function(
        ("referee", rows), lambda: ParametricNlp(form.model.program, form.n, rows)
    )
    return made


def refereed(
    form: Formulation, task: Task, combination: int, start: np.ndarray, low: np.ndarray, high: np.ndarray
) -> Solution | None:
    """Return what IPOPT finds for one combination inside a box (SI), from one start; None where it finds nothing."""
    data = [float(np.asarray(x).ravel()[0]) for x in form.instance.data(np.array([combination]))]
    return referee(form).solve(task, data, start, low, high, form.bounds, void_limits(form.constraints, data, 1)[0])


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
