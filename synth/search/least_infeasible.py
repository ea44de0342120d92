"""A first answer to "why is nothing feasible": the nearest design and the limits it misses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.model.constraint import Constraint
from synth.nlp.batch import Tasks
from synth.order.feasibility import VANISHING, missed_share, size_of_miss
from synth.results.least_infeasible import LeastInfeasible, MissedLimit
from synth.search.formulation import Formulation
from synth.text.numbers import typed_number
from synth.text.plain_text import counted
from synth.units import miss_text, typed_quantity

PROVEN, NOT_PROVEN = "No combination is feasible.", "No feasible design was found; that there is none is not proven."
NEAREST = "The nearest design found"
AT_BOUND = "(its bound, no limit of physics)"
BETWEEN = "Sizes between the makeable ones would keep every limit; the nearest makeable design found"


def explain_infeasible(
    form: Formulation, rng: np.random.Generator, among: range | None = None, proven: bool = True
) -> LeastInfeasible:
    """Return the design that misses the limits by least (over a sample of combinations), and which it misses.

    Every limit may be exceeded by the same fraction, guards excepted; the fraction is made as small as possible.
    ``among``: the numbers of the combinations that count, all unless they are given. ``proven``: whether bounds prove
    that none is feasible.
    """
    instance, limits = form.instance, form.tuning.heuristics.least_infeasible
    among = range(instance.combinations.count) if among is None else among
    total = len(among)
    numbers = rng.choice(total, size=limits.tries, replace=False) if total > limits.tries else np.arange(total)
    numbers = numbers + among.start
    tried = np.empty(0, dtype=np.int64)
    nearest: list[tuple[float, int, np.ndarray]] = []
    for _ in range(limits.rounds):
        numbers = np.setdiff1d(numbers, tried)
        if not len(numbers):
            break
        tried = np.concatenate([tried, numbers])
        nearest = sorted([*nearest, *_least_missed(form, numbers, rng)], key=lambda x: (x[0], x[1]))[: limits.parents]
        near = [instance.combinations.neighbours(combination) for _, combination, _ in nearest]
        numbers = np.unique(np.concatenate([np.empty(0, dtype=np.int64), *near]))
        numbers = numbers if len(numbers) <= limits.tries else rng.choice(numbers, size=limits.tries, replace=False)
    if not nearest:
        return LeastInfeasible(
            message="no design could be evaluated; check the requirements for values far from each other"
        )
    if nearest[0][0] <= 0 and form.gridded.any():
        # Something keeps every limit, but only between makeable sizes: what these miss is what is in the way.
        _, combination, variables = _makeable(form, [x for x in nearest if x[0] <= 0], rng)
        return _explanation(form, combination, variables, proven, BETWEEN)
    _, combination, variables = nearest[0]
    return _explanation(form, combination, variables, proven)


def _makeable(
    form: Formulation, nearest: Sequence[tuple[float, int, np.ndarray]], rng: np.random.Generator
) -> tuple[float, int, np.ndarray]:
    """Return the makeable design around designs that keep all limits which misses them by least."""
    limits = form.tuning.heuristics.least_infeasible
    around = [form.makeable.around(point, limits.tries // len(nearest), rng) for _, _, point in nearest]
    every = np.repeat([combination for _, combination, _ in nearest], [len(points) for points in around])
    start = np.concatenate(around)
    points = start
    if not form.gridded.all():
        low = np.where(form.gridded, start, form.lower)
        high = np.where(form.gridded, start, form.upper)
        solved = form.continuous.solve_batch(_elastic(form, len(every)), every, start, low, high).variables
        better = _misses(form, solved, every) <= _misses(form, start, every)
        points = np.where(better[:, None], solved, start)
    misses = _misses(form, points, every)
    best = int(np.argmin(misses))
    return float(misses[best]), int(every[best]), points[best]


def _elastic(form: Formulation, count: int) -> Tasks:
    """Return the task of missing all limits by as little as can be, so many times."""
    nothing = np.zeros((count, len(form.goals)))
    return Tasks(nothing, nothing, np.full(nothing.shape, np.inf), form.objectives.scales, elastic=1.0)


def _least_missed(
    form: Formulation, combinations: np.ndarray, rng: np.random.Generator
) -> list[tuple[float, int, np.ndarray]]:
    """Distance of each combination from feasible, where that could be found, with the design.

    Limits that cannot all hold have many places where none of them gives way a little without another: combinations
    that are few are tried from several starts.
    """
    limits = form.tuning.heuristics.least_infeasible
    number = np.repeat(np.arange(len(combinations)), np.clip(limits.tries // len(combinations), 1, limits.starts))
    every = combinations[number]
    tasks = _elastic(form, len(every))
    start = form.boxes.inside(form.boxes.leaves(every), rng.random((len(every), form.n)))
    points = form.continuous.solve_batch(tasks, every, start).variables if form.n else start
    misses, before = _misses(form, points, every), _misses(form, start, every)
    # Far from everything feasible a solver may end where nothing makes sense: there the place it began at is better.
    worse = ~(misses <= before)
    points, misses = np.where(worse[:, None], start, points), np.where(worse, before, misses)
    order = np.lexsort((misses, number))
    best = order[np.unique(number[order], return_index=True)[1]]  # of each combination
    return [(float(misses[k]), int(every[k]), points[k]) for k in best if np.isfinite(misses[k])]


def _misses(form: Formulation, variables: np.ndarray, combinations: np.ndarray) -> np.ndarray:
    """Return the largest violation of each design; one of a guard, or of a limit that does not exist, counts more."""
    result = form.points.evaluate(variables, combinations)
    rows, never = [], form.tuning.heuristics.least_infeasible.never
    for limit in form.constraints:
        sides, scale = result.limits[limit.name], result.scales[limit.name]
        with np.errstate(all="ignore"):
            missed = missed_share(*sides, limit.sense, scale)
        missed = np.where(np.isnan(result.residuals[limit.name]), never, np.nan_to_num(missed, nan=never))
        missed = missed + (never if limit.guard else 0.0)
        rows.append(np.where(result.holds[limit.name], 0.0, missed))
    worst: np.ndarray = np.max([np.zeros(len(variables)), *rows], axis=0)
    return worst


def _explanation(
    form: Formulation, combination: int, variables: np.ndarray, proven: bool, nearest_is: str = NEAREST
) -> LeastInfeasible:
    result = form.points.evaluate(variables[None, :], np.array([combination]))
    conflicts = []
    for limit in form.constraints:
        value, bound = (float(x[0]) for x in result.limits[limit.name])
        if not bool(result.holds[limit.name][0]):
            conflicts.append(_conflict(limit, value, bound, float(np.ravel(result.scales[limit.name])[0])))
    parts, counts, choices = form.instance.combinations.describe(combination)
    model = form.model
    nearest = {v.name: typed_quantity(float(x), v.unit) for v, x in zip(model.variables, variables, strict=True)}
    reach = form.tuning.heuristics.least_infeasible.at_bound
    nearest |= {name: f"{nearest[name]} {AT_BOUND}" for name in form.instance.ranges.at_bounds(variables, reach)}
    nearest |= {n: typed_number(v) for n, v in counts.items()} | dict(choices)
    sentences = "; ".join(c["sentence"] for c in conflicts)
    # What holds by the tolerance of limits alone misses none.
    text = f"misses {counted(len(conflicts), 'limit')}: {sentences}"
    text = text if conflicts else "keeps every limit by its tolerance alone"
    return LeastInfeasible(
        message=f"{PROVEN if proven else NOT_PROVEN} {nearest_is} {text}.",
        conflicts=conflicts,
        nearest=nearest,
        parts={slot: table.designations[row] for slot, (table, row) in parts.items()},
    )


def _conflict(limit: Constraint, value: float, bound: float, scale: float) -> MissedLimit:
    # A limit of nothing, or next to it, has no share of its own.
    size = abs(bound) if abs(bound) > VANISHING * scale else float(size_of_miss(value, bound, scale))
    shown, allowed = (typed_quantity(x, limit.unit, 5) for x in (value, bound))
    words = {"at_most": "at most", "at_least": "at least", "equal": "exactly"}[limit.sense]
    asked = "allowed" if limit.sense == "at_most" else "needed"
    missed_by = miss_text(value, bound, limit.unit)
    return MissedLimit(
        limit=limit.name,
        value=value,
        limit_value=bound,
        unit=limit.unit,
        missed_by=abs(value - bound) / size,
        sentence=f"{limit.name} is {shown} where {words} {allowed} is {asked} (missed by {missed_by})",
    )
