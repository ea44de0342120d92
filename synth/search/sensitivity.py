"""What a limit or requirement costs: per cent of an objective per per cent, from the multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.model.model import Evaluation, Model
from synth.model.numbers import numeric
from synth.model.program import InputValue
from synth.nlp.batch import Tasks
from synth.order.feasibility import residual
from synth.question.requirement_values import RequirementValues
from synth.search.archive import Candidate
from synth.search.formulation import Formulation
from synth.special import expanded


@dataclass(frozen=True)
class Optima:
    """Designs made as good as their parts allow in one objective, and what moves it there.

    Parameters
    ----------
    variables : array (designs, variables)
        SI; gridded ones are continuous.
    phi : array (designs,)
        The objective as the search measures it.
    converged : array of bool (designs,)
        Whether the solver confirms the optimum.
    multipliers : array (designs, limits)
    limits : array (designs, limits)
        d phi / d log of each limit; not-a-number where the limit is zero or void.
    requirements : array (designs, requirements)
        d phi / d log of each requirement, where limits that no variable moves let it change at all.
    ends : array (designs, variables)
        d phi / d log of the end of its range that a variable is at; 0 inside.
    """

    variables: np.ndarray
    phi: np.ndarray
    converged: np.ndarray
    multipliers: np.ndarray
    limits: np.ndarray
    requirements: np.ndarray
    ends: np.ndarray


def elasticities(form: Formulation, candidates: Sequence[Candidate], chosen: int) -> list[dict[str, dict[str, float]]]:
    """Elasticity of each chosen objective to every limit and requirement, per design.

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
    names = [x.name for x in form.constraints]
    combinations = np.array([c.combination for c in candidates])
    start = np.array([c.variables for c in candidates])
    phi = np.array([c.phi for c in candidates])
    positions = requirement_positions(form)
    speaking = np.array([_speaking_of(form, position) for position in positions.values()], dtype=bool)
    result = form.points.evaluate(start, combinations)
    tight, sizes = _tight(form, result), _sizes(form, result)
    # Where a tight limit speaks of a requirement, the least change breaks what no variable can restore.
    _, follows = _shares(form, combinations)
    spoken = np.einsum("iqr,rj,ij->iq", follows, speaking.reshape(len(positions), len(form.node_constraints)), tight)
    logs, noise = np.array(form.continuous.rows.log_constraints, dtype=bool), form.tuning.tolerances.multiplier_noise
    for k in range(chosen):
        if not form.objectives.log[k]:
            continue
        best = optima(form, combinations, start, phi, chosen, k, sizes)
        counts = np.concatenate(
            [logs & (np.abs(best.limits) > noise), (np.abs(best.requirements) > noise) & ~spoken], axis=1
        )
        numbers = np.concatenate([best.limits, best.requirements], axis=1).tolist()
        labels = [*names, *positions]
        for i in np.flatnonzero(best.converged).tolist():
            results[i][form.names[k]] = {labels[j]: numbers[i][j] for j in np.flatnonzero(counts[i]).tolist()}
    return results


def optima(
    form: Formulation,
    combinations: np.ndarray,
    start: np.ndarray,
    phi: np.ndarray,
    chosen: int,
    k: int,
    sizes: np.ndarray | None = None,
) -> Optima:
    """Make designs as good as their parts allow in one objective, and return what moves it there.

    Parameters
    ----------
    form : Formulation
    combinations, start : array (designs,), (designs, variables)
    phi : array (designs, objectives)
        The chosen objectives but the one numbered ``k`` are held at these.
    chosen, k : int
    sizes : array (designs, limits), optional
        Those of ``sides`` at the start, where they are known.
    """
    tasks = held(form, phi, chosen, k)
    # Limits that no variable can move have no multiplier; where they are tight, nothing is known of a change.
    answer = form.continuous.solve_batch(tasks, combinations, start, skipped=form.unmoved(gridded=True))
    data = form.instance.data(combinations)
    sizes = _sizes(form, form.instance.evaluate(start, data)) if sizes is None else sizes
    bounds = _bounds(form, answer.variables, data)
    logs = np.array(form.continuous.rows.log_constraints, dtype=bool)
    senses = np.array([1.0 if c.sense == "at_least" else -1.0 for c in form.node_constraints])
    with np.errstate(all="ignore"):
        limits = senses * answer.constraint_multipliers * np.where(logs, 1.0, bounds / sizes)
    limits = np.where(np.isfinite(limits) & (bounds != 0), limits, np.nan)
    positions = requirement_positions(form)
    slopes = form.model.function(("gradient", form.continuous.rows), lambda: _gradient(form))
    requirements, ends = np.zeros((len(start), len(positions))), np.zeros((len(start), form.n))
    solved = np.flatnonzero(answer.converged)
    if len(solved):
        known = np.empty((len(solved), len(data)))
        for j, x in enumerate(data):
            known[:, j] = x[solved] if isinstance(x, np.ndarray) and x.ndim else x
        points = answer.variables[solved]
        partials, at_ends = slopes(
            form,
            points,
            known,
            sizes[solved],
            answer.constraint_multipliers[solved],
            answer.goal_multipliers[solved],
            k,
        )
        ends[solved] = at_ends * points
        places = list(positions.values())
        share, _ = _shares(form, combinations[solved])
        slope = _sum_of_shares(share, partials[:, places])
        requirements[solved] = slope * known[:, places]
    return Optima(
        answer.variables, answer.phi[:, k], answer.converged, answer.constraint_multipliers, limits, requirements, ends
    )


def held(form: Formulation, phi: np.ndarray, chosen: int, k: int, moved: np.ndarray | None = None) -> Tasks:
    """Return problems of one objective that hold the other chosen ones; ``moved`` is that of :class:`Tasks`."""
    count, goals = phi.shape
    cutoffs = np.full((count, goals), np.inf)
    cutoffs[:, :chosen] = phi[:, :chosen] + form.tuning.tolerances.tie
    cutoffs[:, k] = np.inf
    return Tasks(
        np.tile(np.eye(goals)[k], (count, 1)),
        np.zeros((count, goals)),
        cutoffs,
        form.objectives.scales,
        0.0,
        moved=moved,
    )


def requirement_positions(form: Formulation) -> dict[str, int]:
    """Return the requirements in force with the number of their data input."""
    return {e.name: k for k, e in enumerate(form.model.data_inputs) if e.kind == "requirement"}


def _shares(form: Formulation, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slope of requirements that follow others, and mask of these (combinations, requirements, followers)."""
    questions: dict[RequirementValues, int] = {}
    kinds, numbers = list[dict[str, dict[str, float]]](), list[int]()
    for combination in combinations.tolist():
        values = form.instance.values_of(combination)
        if values not in questions:
            questions[values] = len(kinds)
            kinds.append(_followers_of(form, values))
        numbers.append(questions[values])
    place = {name: q for q, name in enumerate(requirement_positions(form))}
    share = np.zeros((len(kinds), len(place), len(place)))
    follows = np.zeros(share.shape, dtype=bool)
    for kind, moved in enumerate(kinds):
        for name, others in moved.items():
            for other, by in others.items():
                share[kind, place[name], place[other]] = by
                follows[kind, place[name], place[other]] = True
    return share[numbers], follows[numbers]


def _sum_of_shares(share: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """Total slope to each requirement with its followers, from the partial slopes (designs, requirements)."""
    each = np.arange(slopes.shape[1])
    total: np.ndarray = 0.0 + share[:, each, each] * slopes
    # One after another, in the order in which they are declared: sums of numbers depend on it.
    for other in each[np.any(share, axis=(0, 1))]:
        more = share[:, :, other] * slopes[:, [other]]
        more[:, other] = 0.0
        total += more
    return total


def _followers_of(form: Formulation, values: RequirementValues) -> dict[str, dict[str, float]]:
    """Quantities that move with each requirement of a question; computed once."""
    known = form.followers.get(values)
    if known is None:
        known = form.followers[values] = followers(form.model, values)
    return known


def followers(model: Model, known: RequirementValues) -> dict[str, dict[str, float]]:
    """Return, per requirement, what moves with it and by how much: itself, and those whose default is made of it."""
    declared = model.declaration.requirements
    active = {name: r for name, r in declared.items() if r.sx is not None}
    moved: dict[str, dict[str, float]] = {name: {name: 1.0} for name in active}
    values = known.by_symbol(model)
    slopes: dict[str, list[tuple[str, Any, list[str]]]] = model.function("slopes of defaults", lambda: _slopes(model))
    for name, made in slopes.items():
        if name in known.given:
            continue
        for other, function, names in made:
            slope = float(function.call([values[n] for n in names])[0])
            if slope:
                for origin in moved:
                    share = moved[origin].get(other, 0.0)
                    if share:
                        moved[origin][name] = moved[origin].get(name, 0.0) + share * slope
    return moved


def _slopes(model: Model) -> dict[str, list[tuple[str, Any, list[str]]]]:
    """Return, per requirement whose default is made of others, the functions that give its slopes to each."""
    active = {name: r for name, r in model.declaration.requirements.items() if r.sx is not None}
    result: dict[str, list[tuple[str, Any, list[str]]]] = {}
    for name, r in active.items():
        if r.default is not None and not isinstance(r.default, float):
            expression = expanded(r.default, model.calls)
            slopes = {other: ca.gradient(expression, earlier.sx) for other, earlier in active.items()}
            result[name] = [(other, *numeric(slope)) for other, slope in slopes.items() if not slope.is_zero()]
    return result


def _gradient(form: Formulation) -> Any:
    """Derivatives of the Lagrangian by data inputs and variables, a function of point, data and multipliers."""
    rows, program, n = form.continuous.rows, form.model.program, form.n
    x, data = ca.SX.sym("x", n), ca.SX.sym("data", program.n_inputs - n)
    values = dict(zip(program.outputs, program.symbolic(ca.vertsplit(ca.vertcat(x, data))), strict=True))
    bounds, sizes = ca.SX.sym("bounds", len(rows.constraints)), ca.SX.sym("sizes", len(rows.constraints))
    constraint_rows = []
    for j, constraint in enumerate(rows.constraints):
        value, limit = values[constraint.value], bounds[j] if constraint.limit is None else values[constraint.limit]
        row = ca.log(value / limit) if rows.log_constraints[j] else (value - limit) / sizes[j]
        constraint_rows.append(-row if constraint.sense == "at_least" else row)
    phi = []
    for j, goal in enumerate(rows.goals):
        form_of = ca.log(values[goal.node]) if rows.log_goals[j] else values[goal.node]
        phi.append(goal.sign * form_of)
    constraint_weights, goal_weights = ca.SX.sym("constraints", len(constraint_rows)), ca.SX.sym("goals", len(phi))
    total = ca.dot(constraint_weights, ca.vertcat(*constraint_rows)) + ca.dot(goal_weights, ca.vertcat(*phi))
    gradients = [ca.gradient(total, data), ca.gradient(total, x)]
    function = ca.Function("gradient", [x, data, bounds, sizes, constraint_weights, goal_weights], gradients)

    def evaluate(
        formulation: Formulation,
        points: np.ndarray,
        known: np.ndarray,
        size: np.ndarray,
        constraints: np.ndarray,
        goals: np.ndarray,
        k: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        clean = np.where(np.isnan(known), 1.0, known)
        units = np.where(rows.log_goals, 1.0, formulation.objectives.scales)
        weights = np.where(np.isfinite(goals), goals, 0.0) / units
        weights[:, k] += 1.0 / units[k]
        limits = np.tile(formulation.bounds, (len(points), 1))
        # One call for all designs, a column each.
        parts = function(points.T, clean.T, limits.T, size.T, np.where(constraints == 0, 0.0, constraints).T, weights.T)
        slopes, ends = (np.nan_to_num(np.asarray(part)).T for part in parts)
        return slopes, ends

    return evaluate


def sides(form: Formulation, variables: np.ndarray, data: Sequence[InputValue]) -> tuple[np.ndarray, np.ndarray]:
    """Return the size of every limit as its row measures it, and the limit itself (designs, limits)."""
    return _sizes(form, form.instance.evaluate(variables, data)), _bounds(form, variables, data)


def _sizes(form: Formulation, result: Evaluation) -> np.ndarray:
    """Return the size of every limit as its row measures it (designs, limits)."""
    sizes = np.empty((len(result.feasible), len(form.node_constraints)))
    for j, x in enumerate(form.constraints):
        value, limit = result.limits[x.name]
        size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), result.scales[x.name])
        sizes[:, j] = np.where(np.isfinite(size), size, 1.0)
    return sizes


def _bounds(form: Formulation, variables: np.ndarray, data: Sequence[InputValue]) -> np.ndarray:
    """Bounds of the limits (designs, limits)."""
    moving = [constraint.limit for constraint in form.node_constraints if constraint.limit is not None]
    limits = form.model.function(("right sides", *moving), lambda: form.model.program.compile(moving))
    with np.errstate(all="ignore"):
        values = iter(limits([*variables.T, *data]))
    bounds = np.empty((len(variables), len(form.node_constraints)))
    for j, constraint in enumerate(form.node_constraints):
        bounds[:, j] = constraint.bound if constraint.limit is None else next(values)
    return bounds


def _tight(form: Formulation, result: Evaluation) -> np.ndarray:
    """Active limits that no variable can move (designs, limits)."""
    fixed = form.unmoved(gridded=True)
    tight = np.zeros((len(result.feasible), len(form.node_constraints)), dtype=bool)
    for j in np.flatnonzero(fixed):
        x = form.constraints[j]
        tight[:, j] = (
            np.abs(residual(*result.limits[x.name], x.sense, result.scales[x.name])) < form.tuning.tolerances.tight
        )
    return tight


def _speaking_of(form: Formulation, position: int) -> np.ndarray:
    """Limits that depend on a data input."""
    marked = form.model.program.dependence([form.n + position])
    return np.array([any(marked[k] for k in x.nodes) for x in form.constraints], dtype=bool)
