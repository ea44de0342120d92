"""Looks for designs where hardly any are known: in a few promising combinations to the bottom, not in all a little.

Where sizes are coarse steps and limits are tight, most combinations whose continuous problem has a good optimum have no
makeable design near it. A small tree over such combinations alone finds what rounding misses.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from synth.nlp.batch import Tasks
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.pruning import EpsilonCover, rows_of_use
from synth.search.refused_cells import not_refused


def large_neighbourhood_search(
    form: Formulation, columns: Sequence[int], tolerance: np.ndarray, clock: Clock, rng: np.random.Generator
) -> None:
    """Improve the best design known in each objective in turn, until nothing better comes.

    It proves nothing.

    Parameters
    ----------
    form : Formulation
        Its archive holds at least one design; new ones are added.
    columns : list of int
        Numbers of the objectives that are traded off.
    tolerance : array (columns,)
        In phi; less is no progress.
    clock : Clock
    rng : Generator
    """
    limits, failures = form.tuning.heuristics.neighbourhood, 0
    for turn in range(limits.rounds):
        place = turn % len(columns)
        k = columns[place]
        best = form.archive.phi[:, k].min()
        no_cutoffs = np.full(len(form.goals), np.inf)
        rule = EpsilonCover([k], tolerance[place : place + 1], no_cutoffs, form.new_archive([k]))
        rule.take(form.archive.combination, form.archive.variables, form.archive.phi)
        combinations = _promising(form, rule, columns, rng)
        if len(combinations):
            branch_and_bound(form, form.boxes.leaves(combinations), rule, clock, rng, limits.boxes)
        failures = 0 if form.archive.phi[:, k].min() < best - tolerance[place] else failures + 1
        if failures >= limits.patience * len(columns):
            return


def _promising(form: Formulation, rule: EpsilonCover, columns: Sequence[int], rng: np.random.Generator) -> np.ndarray:
    """Return combinations near the designs known that could be better in one objective if all sizes were makeable.

    The better they could be the more of them are taken, but not the best alone: these may have nothing makeable.
    """
    limits, k = form.tuning.heuristics.neighbourhood, rule.columns[0]
    combinations, start = _two_parts_away(form, rng, limits.solved)
    rows = rows_of_use(form, rule, combinations)
    combinations, start = combinations[rows], start[rows]
    weights = np.zeros((len(combinations), len(form.goals)))
    weights[:, list(columns)] = limits.tie_weight
    weights[:, k] = 1.0
    free = np.full(weights.shape, np.inf)
    tasks = Tasks(weights, np.zeros_like(weights), free, form.objectives.scales, 0.0)
    solutions = form.continuous.solve_batch(tasks, combinations, start, rough=True)
    reach = np.where(solutions.violation <= form.tuning.nlp.missed, solutions.phi[:, k], np.nan)
    good = np.flatnonzero(reach < form.archive.phi[:, k].min() - float(rule.tolerance[0]))
    if not len(good):
        return np.zeros(0, dtype=np.int64)
    good = good[np.argsort(reach[good], kind="stable")]
    chosen: np.ndarray = combinations[good[np.unique((rng.random(limits.promising) ** 2 * len(good)).astype(int))]]
    return chosen


def _two_parts_away(form: Formulation, rng: np.random.Generator, solved: int) -> tuple[np.ndarray, np.ndarray]:
    """Return random combinations that differ from a design known in at most two parts, with its variables."""
    archive, radix = form.archive, np.array(form.instance.combinations.radix)
    parents = rng.integers(len(archive), size=solved)
    digits = np.stack(form.instance.combinations.digits(archive.combination[parents]), axis=1)
    for _ in range(2):
        part = rng.choice(np.flatnonzero(radix > 1), solved)
        digits[np.arange(solved), part] = rng.integers(radix[part])
    numbers = form.instance.combinations.composed(list(digits.T), solved)
    combinations, first = np.unique(numbers, return_index=True)
    keep = not_refused(form.instance, combinations)
    return combinations[keep], archive.variables[parents[first[keep]]]
