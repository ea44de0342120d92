"""What a limit or requirement costs: per cent of an objective per per cent, from the multipliers."""

from __future__ import annotations

import numpy as np

from synth.feasibility import residual
from synth.formulation import TIE, Candidate, Formulation
from synth.nlp import Task

NOISE = 1e-6
TIGHT = 1e-5


def elasticities(form: Formulation, candidate: Candidate, chosen: int) -> dict[str, dict[str, float]]:
    """Return the elasticity of each chosen objective to every limit and requirement.

    The other chosen objectives are held at their values, parts and counts are fixed, gridded
    variables are taken as continuous. Objectives that are not positive, and designs where the solver
    does not confirm the optimum, have none.

    Parameters
    ----------
    form : Formulation
    candidate : Candidate
    chosen : int
        How many objectives, from the first, are traded off.
    """
    result: dict[str, dict[str, float]] = {}
    names = [x.name for x in form.model.limits] + [x.name for x in form.instance.extra]
    immovable = form.immovable
    tight = [int(j) for j in np.flatnonzero(immovable) if _is_tight(form, candidate, int(j))]
    requirements = {e.name: k for k, e in enumerate(form.model.data_inputs) if e.kind == "requirement"}
    for k in range(chosen):
        if not form.log_goals[k]:
            continue
        caps = np.full(len(form.goals), np.inf)
        caps[:chosen] = candidate.phi[:chosen] + TIE
        caps[k] = np.inf
        task = Task(
            weights=np.eye(len(form.goals))[k],
            slopes=np.zeros(len(form.goals)),
            caps=caps,
            goal_scales=form.goal_scales,
            t_weight=0.0,
        )
        start = np.clip(candidate.variables, form.lower, form.upper)
        solution = form.solve(task, candidate.combination, start, form.lower, form.upper, True, immovable)
        if solution is None or not solution.converged or solution.lagrangian_data_gradient is None:
            continue
        own: dict[str, float] = {}
        for j, name in enumerate(names):
            value = -float(solution.cut_multipliers[j])
            if form.cuts[j].sense == "at_least":
                value = -value
            if abs(value) > NOISE and form.nlp().rows.log_cuts[j]:
                own[name] = value
        for name, position in requirements.items():
            if any(_speaks_of(form, j, position) for j in tight):
                continue  # the least change breaks a limit that no variable can restore
            value = float(solution.lagrangian_data_gradient[position]) * form.instance.requirements[name]
            if abs(value) > NOISE:
                own[name] = value
        result[form.names[k]] = own
    return result


def _is_tight(form: Formulation, candidate: Candidate, j: int) -> bool:
    result = form.evaluate(candidate.variables[None, :], np.array([candidate.combination]))
    if j < len(form.model.limits):
        return abs(float(result.residuals[form.model.limits[j].name][0])) < TIGHT
    extra = form.instance.extra[j - len(form.model.limits)]
    return abs(float(residual(result.values[extra.quantity][0], extra.limit, extra.sense, 1e-9))) < TIGHT


def _speaks_of(form: Formulation, j: int, position: int) -> bool:
    marked = form.model.program.dependence([form.n + position])
    return any(marked[k] for k in (form.cuts[j].value, form.cuts[j].limit) if k is not None)
