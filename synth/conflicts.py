"""A first answer to "why is nothing feasible": the nearest design and the limits it misses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from synth.feasibility import holds, residual
from synth.formulation import Formulation
from synth.nlp import Task
from synth.units import format_quantity

TRIES = 60
STARTS = 200


def explain_infeasible(form: Formulation, rng: np.random.Generator) -> Mapping[str, Any]:
    """Return the design that misses the limits by least (over a sample of combinations), and which it misses.

    Every limit may be exceeded by the same fraction, guards excepted; the fraction is made as small as possible.
    """
    instance = form.instance
    total = instance.combinations
    numbers = rng.choice(total, size=min(TRIES, total), replace=False) if total > TRIES else np.arange(total)
    task = Task(
        weights=np.zeros(len(form.goals)),
        slopes=np.zeros(len(form.goals)),
        caps=np.full(len(form.goals), np.inf),
        goal_scales=form.goal_scales,
        t_weight=1.0,
        elastic=1.0,
    )
    best: tuple[float, int, np.ndarray] | None = None
    queue = [int(c) for c in numbers]
    tried: set[int] = set()
    while queue:
        combination = queue.pop(0)
        if combination in tried:
            continue
        tried.add(combination)
        start = form.good_start(form.whole(combination), rng, STARTS)
        solution = form.solve(task, combination, start, form.lower, form.upper)
        if solution is None:
            continue
        worst = _worst(form, solution.variables, combination)
        if best is None or worst < best[0] - 1e-9:
            best = (worst, combination, solution.variables)
            if len(tried) < 4 * TRIES:
                queue += [c for c in _neighbours(form, combination) if c not in tried]
    if best is None:
        return {"message": "no design could be evaluated; check the requirements for values far from each other"}
    return _told(form, best[1], best[2])


def _neighbours(form: Formulation, combination: int) -> list[int]:
    """Return combinations that differ in one part, count or choice by one step."""
    radix = form.instance.radix
    digits = [int(x[0]) for x in form.instance.digits(np.array([combination]))]
    result = []
    for k, size in enumerate(radix):
        for step in (-1, 1):
            if 0 <= digits[k] + step < size:
                moved = [*digits[:k], digits[k] + step, *digits[k + 1 :]]
                number = 0
                for digit, base in zip(moved, radix, strict=True):
                    number = number * base + digit
                result.append(number)
    return result


def _worst(form: Formulation, variables: np.ndarray, combination: int) -> float:
    result = form.evaluate(variables[None, :], np.array([combination]))
    worst = 0.0
    for limit in form.model.limits:
        r = float(result.residuals[limit.name][0])
        if not bool(result.holds[limit.name][0]):
            worst = max(worst, 10.0 if limit.guard or np.isnan(r) else r)
    for extra in form.instance.extra:
        r = float(residual(result.values[extra.quantity][0], extra.limit, extra.sense, 1e-9))
        worst = max(worst, r if np.isfinite(r) else 10.0)
    return worst


def _told(form: Formulation, combination: int, variables: np.ndarray) -> Mapping[str, Any]:
    result = form.evaluate(variables[None, :], np.array([combination]))
    conflicts = []
    for limit in form.model.limits:
        value, bound = (float(x[0]) for x in result.limits[limit.name])
        if not bool(result.holds[limit.name][0]):
            conflicts.append(_conflict(limit.name, limit.sense, value, bound, limit.unit))
    for extra in form.instance.extra:
        value = float(result.values[extra.quantity][0])
        if not holds(residual(value, extra.limit, extra.sense, 1e-9), guard=False):
            conflicts.append(_conflict(extra.name, extra.sense, value, extra.limit, extra.unit))
    parts, counts, choices = form.instance.describe(combination)
    model = form.model
    nearest = {v.name: format_quantity(float(x), v.unit) for v, x in zip(model.variables, variables, strict=True)}
    nearest |= {n: f"{v:g}" for n, v in counts.items()} | dict(choices)
    names = ", ".join(c["limit"] for c in conflicts)
    sentences = "; ".join(c["sentence"] for c in conflicts)
    return {
        "message": f"No combination is feasible. The nearest design found misses {names}: {sentences}.",
        "conflicts": conflicts,
        "nearest": nearest,
        "parts": {slot: table.designations[row] for slot, (table, row) in parts.items()},
    }


def _conflict(name: str, sense: str, value: float, bound: float, unit: str) -> dict[str, Any]:
    missed = abs(value - bound) / max(abs(bound), 1e-300)
    shown, allowed = format_quantity(value, unit, 5), format_quantity(bound, unit, 5)
    words = {"at_most": "at most", "at_least": "at least", "equal": "exactly"}[sense]
    return {
        "limit": name,
        "value": value,
        "limit_value": bound,
        "unit": unit,
        "missed_by": missed,
        "sentence": f"{name} is {shown} where {words} {allowed} is allowed (missed by {100 * missed:.3g} %)",
    }
