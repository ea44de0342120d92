"""What a limit or requirement costs: per cent of an objective per per cent, from the multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from synth.batch_nlp import Tasks
from synth.feasibility import residual
from synth.formulation import TIE, Candidate, Formulation
from synth.instance import Instance, number
from synth.special import expanded

NOISE = 1e-6
TIGHT = 1e-5


def elasticities(form: Formulation, candidates: Sequence[Candidate], chosen: int) -> list[dict[str, dict[str, float]]]:
    """Return, per design, the elasticity of each chosen objective to every limit and requirement.

    The other chosen objectives are held at their values, parts and counts are fixed, gridded
    variables are taken as continuous. What a default makes of a requirement moves with it.
    Objectives that are not positive, and designs where the solver does not confirm the optimum,
    have none.

    Parameters
    ----------
    form : Formulation
    candidates : list of Candidate
    chosen : int
        How many objectives, from the first, are traded off.
    """
    results: list[dict[str, dict[str, float]]] = [{} for _ in candidates]
    if not candidates:
        return results
    names = [x.name for x in form.model.limits] + [x.name for x in form.instance.extra]
    combinations = np.array([c.combination for c in candidates])
    start = np.array([c.variables for c in candidates])
    phi = np.array([c.phi for c in candidates])
    count, goals = phi.shape
    data = form.instance.data(combinations)
    requirements = {e.name: k for k, e in enumerate(form.model.data_inputs) if e.kind == "requirement"}
    gradient = form.model.function(("gradient", form.rows()), lambda: _gradient(form))
    tight, sizes = _tight(form, start, combinations)
    moved = followers(form.instance)
    speaking = {name: _speaking_of(form, position) for name, position in requirements.items()}
    spoken = {name: np.any([speaking[other] for other in moved[name]], axis=0) for name in requirements}
    for k in range(chosen):
        if not form.log_goals[k]:
            continue
        caps = np.full((count, goals), np.inf)
        caps[:, :chosen] = phi[:, :chosen] + TIE
        caps[:, k] = np.inf
        tasks = Tasks(np.tile(np.eye(goals)[k], (count, 1)), np.zeros((count, goals)), caps, form.goal_scales, 0.0)
        # Limits that no variable can move have no multiplier; where they are tight, nothing is known of a change.
        answer = form.solve_many(tasks, combinations, start, skipped=form.immovable)
        for i in np.flatnonzero(answer.converged):
            own: dict[str, float] = {}
            for j, name in enumerate(names):
                value = -float(answer.cut_multipliers[i, j])
                value = -value if form.cuts[j].sense == "at_least" else value
                if abs(value) > NOISE and form.rows().log_cuts[j]:
                    own[name] = value
            point = [float(np.asarray(x).ravel()[i if np.size(x) > 1 else 0]) for x in data]
            slopes = gradient(
                answer.variables[i], point, sizes[i], answer.cut_multipliers[i], answer.goal_multipliers[i], k
            )
            for name in requirements:
                if np.any(tight[i] & spoken[name]):
                    continue  # the least change breaks a limit that no variable can restore
                slope = sum(share * float(slopes[requirements[other]]) for other, share in moved[name].items())
                value = slope * form.instance.requirements[name]
                if abs(value) > NOISE:
                    own[name] = value
            results[i][form.names[k]] = own
    return results


def followers(instance: Instance) -> dict[str, dict[str, float]]:
    """Return, per requirement, what moves with it and by how much: itself, and those whose default is made of it."""
    model, declared = instance.model, instance.model.declaration.requirements
    active = {name: r for name, r in declared.items() if r.sx is not None}
    moved: dict[str, dict[str, float]] = {name: {name: 1.0} for name in active}
    values = {**{str(active[n].sx): v for n, v in instance.requirements.items()}, **instance.row_values}
    for name, r in active.items():
        if name in instance.given or r.default is None or isinstance(r.default, float):
            continue
        expression = expanded(r.default, model.calls)
        for other, earlier in active.items():
            slope = number(ca.gradient(expression, earlier.sx), values)
            if slope:
                for origin in moved:
                    share = moved[origin].get(other, 0.0)
                    if share:
                        moved[origin][name] = moved[origin].get(name, 0.0) + share * slope
    return moved


def _gradient(form: Formulation) -> Any:
    """Return the derivative of the Lagrangian to the data inputs as a function of point, data and multipliers."""
    rows, program, n = form.rows(), form.model.program, form.n
    x, data = ca.SX.sym("x", n), ca.SX.sym("data", program.n_inputs - n)
    values = dict(zip(program.outputs, program.symbolic(ca.vertsplit(ca.vertcat(x, data))), strict=True))
    bounds, sizes = ca.SX.sym("bounds", len(rows.cuts)), ca.SX.sym("sizes", len(rows.cuts))
    cut_rows = []
    for j, cut in enumerate(rows.cuts):
        value, limit = values[cut.value], bounds[j] if cut.limit is None else values[cut.limit]
        row = ca.log(value / limit) if rows.log_cuts[j] else (value - limit) / sizes[j]
        cut_rows.append(-row if cut.sense == "at_least" else row)
    phi = []
    for j, goal in enumerate(rows.goals):
        form_of = ca.log(values[goal.node]) if rows.log_goals[j] else values[goal.node]
        phi.append(goal.sign * form_of)
    cut_weights, goal_weights = ca.SX.sym("cuts", len(cut_rows)), ca.SX.sym("goals", len(phi))
    total = ca.dot(cut_weights, ca.vertcat(*cut_rows)) + ca.dot(goal_weights, ca.vertcat(*phi))
    function = ca.Function("gradient", [x, data, bounds, sizes, cut_weights, goal_weights], [ca.gradient(total, data)])

    def evaluate(
        point: np.ndarray, known: Sequence[float], size: np.ndarray, cuts: np.ndarray, goals: np.ndarray, k: int
    ) -> np.ndarray:
        clean = [1.0 if np.isnan(v) else v for v in known]
        weights = np.where(np.isfinite(goals), goals, 0.0) / np.where(rows.log_goals, 1.0, form.goal_scales)
        weights[k] += 1.0
        found = function(point, clean, form.bounds, size, np.where(cuts == 0, 0.0, cuts), weights)
        slopes: np.ndarray = np.nan_to_num(np.asarray(found).ravel())
        return slopes

    return evaluate


def _tight(form: Formulation, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which limits that no variable can move are active, and the size of every limit (designs, limits)."""
    result = form.evaluate(variables, combinations)
    tight = np.zeros((len(variables), len(form.cuts)), dtype=bool)
    sizes = np.ones(tight.shape)
    sides = [(*result.limits[x.name], x.sense, x.scale) for x in form.model.limits]
    sides += [(result.values[x.quantity], np.array(x.limit), x.sense, 1e-9) for x in form.instance.extra]
    for j, (value, limit, sense, scale) in enumerate(sides):
        size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), scale)
        sizes[:, j] = np.where(np.isfinite(size), size, 1.0)
        if form.immovable[j]:
            tight[:, j] = np.abs(residual(value, limit, sense, scale)) < TIGHT
    return tight, sizes


def _speaking_of(form: Formulation, position: int) -> np.ndarray:
    """Return which limits depend on a data input."""
    marked = form.model.program.dependence([form.n + position])
    return np.array([any(marked[k] for k in (cut.value, cut.limit) if k is not None) for cut in form.cuts], dtype=bool)
