"""What comes after the proof: ties settled, equal designs named, open combinations solved one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth.bounds.boxes import Boxes
from synth.nlp.batch import Tasks
from synth.question.search_space import SearchSpace
from synth.search.archive import Candidate
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.pruning import PruningRule
from synth.system import deadline


def polish_extremes(form: Formulation, traded: int, tolerance: float) -> None:
    """Make the design that is best in each objective exact: solve in all combinations that come near to it."""
    archive, ties = form.archive, form.tuning.heuristics.polishing.ties
    for k in range(traded if form.n else 0):
        near = np.flatnonzero(archive.phi[:, k] <= archive.phi[:, k].min() + 2 * tolerance)
        _, first = np.unique(archive.combination[near], return_index=True)
        chosen = [archive[int(near[i])] for i in np.sort(first)[:ties]]
        order = [k, *(j for j in range(traded) if j != k)]
        exact = polish_discrete(form, polish_variables(form, chosen, 0, order), traded, order)
        for c in polish_variables(form, exact, 0, order):
            archive.add(np.array([c.combination]), c.variables[None, :], c.phi[None, :])


def polish_discrete(
    form: Formulation, candidates: Sequence[Candidate], traded: int, order: Sequence[int], parts: bool = True
) -> list[Candidate]:
    """Change one makeable value or part at a time while the objectives, compared in their order, become smaller.

    None of the first ``traded`` becomes larger. What the best design in one objective leaves free over a grid or among
    parts, the other objectives decide that way. Parts stay where ``parts`` is False. All designs take their steps at
    the same time; each goes where it would go alone.
    """
    if not candidates:
        return []
    combinations = np.array([c.combination for c in candidates], dtype=np.int64)
    variables = np.array([c.variables for c in candidates]).reshape(len(candidates), form.n)
    phi = np.array([c.phi for c in candidates])
    steps: list[int | None] = [int(k) for k in np.flatnonzero(form.gridded & (form.lower < form.upper))]
    steps += [None] if parts else []
    moved, idle = np.zeros(len(candidates), dtype=bool), np.zeros(len(candidates), dtype=int)
    for step in steps * form.tuning.heuristics.polishing.moves:
        # Where as many steps in a row as there are kinds of them led nowhere, no further one does.
        active = np.flatnonzero(idle < len(steps))
        if not len(active):
            break
        known = combinations[active], variables[active], phi[active, :traded]
        trials = _other_parts(form, *known) if step is None else _other_values(form, step, *known)
        chosen = _better(phi[active], _feasible(form, *trials), traded, list(order), form.tuning.tolerances.tie)
        better = active[chosen.whose]
        idle[active] += 1
        idle[better], moved[better] = 0, True
        combinations[better], variables[better], phi[better] = chosen.combinations, chosen.variables, chosen.phi
    return [Candidate(int(combinations[k]), variables[k], phi[k]) if moved[k] else c for k, c in enumerate(candidates)]


@dataclass(frozen=True)
class _Replacements:
    """Feasible replacements of designs, each with the position of its design."""

    whose: np.ndarray
    combinations: np.ndarray
    variables: np.ndarray
    phi: np.ndarray

    def take(self, rows: np.ndarray) -> _Replacements:
        """Replacements of a mask or of positions."""
        return _Replacements(self.whose[rows], self.combinations[rows], self.variables[rows], self.phi[rows])


def _feasible(form: Formulation, whose: np.ndarray, combinations: np.ndarray, variables: np.ndarray) -> _Replacements:
    """Feasible points of the given ones."""
    rows, phi = [np.empty(0, dtype=np.int64)], [np.empty((0, len(form.goals)))]
    at_once = form.tuning.heuristics.polishing.evaluated_at_once
    for first in range(0, len(whose), at_once):
        deadline.check()
        part = slice(first, first + at_once)
        feasible, values = form.points.feasible_rows(variables[part], combinations[part])
        rows.append(first + feasible)
        phi.append(values[feasible])
    kept = np.concatenate(rows)
    return _Replacements(whose[kept], combinations[kept], variables[kept], np.concatenate(phi))


def _other_values(
    form: Formulation, k: int, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return designs with makeable values of one variable that promise to be as good: whose, combination, variables."""
    grid = form.makeable.grids[k]
    grid = grid[(grid >= form.lower[k]) & (grid <= form.upper[k])]
    designs = [np.empty(0, dtype=np.int64)]
    places = [np.empty(0, dtype=np.int64)]
    for part in _slices(form, len(combinations), len(grid)):
        deadline.check()
        columns = list(variables[part].T[:, :, None])
        columns[k] = grid[None, :]
        rows, there = np.nonzero(form.points.promising(columns, combinations[part, None], phi[part]))
        designs.append(part.start + rows)
        places.append(there)
    whose = np.concatenate(designs)
    points = variables[whose]
    points[:, k] = grid[np.concatenate(places)]
    return whose, combinations[whose], points


def _other_parts(
    form: Formulation, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Designs with one other part that may be as good: position, combination, variables."""
    designs, numbers = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    for part in _slices(form, len(combinations), len(form.instance.combinations.neighbours(combinations[0]))):
        deadline.check()
        others = form.instance.combinations.neighbours(combinations[part])
        keep = form.points.promising(list(variables[part].T[:, :, None]), others, phi[part])
        designs.append(part.start + np.nonzero(keep)[0])
        numbers.append(others[keep])
    whose = np.concatenate(designs)
    return whose, np.concatenate(numbers), variables[whose]


def _slices(form: Formulation, count: int, each: int) -> list[slice]:
    """Batches of so many designs that are tried at once, with so many points each."""
    at_once = max(form.tuning.heuristics.polishing.tried_at_once // max(each, 1), 1)
    return [slice(first, first + at_once) for first in range(0, count, at_once)]


def _better(phi: np.ndarray, trials: _Replacements, traded: int, order: list[int], tie: float) -> _Replacements:
    """Best replacement of each design by the objectives in their order, where it is better than its ``phi``."""
    best = trials.take(np.all(trials.phi[:, :traded] <= phi[trials.whose, :traded] + tie, axis=1))
    for j in order:
        least = np.full(len(phi), np.inf)
        np.minimum.at(least, best.whose, best.phi[:, j])
        best = best.take(best.phi[:, j] <= least[best.whose] + tie)
    _, first = np.unique(best.whose, return_index=True)
    best = best.take(first)
    gain = (phi[best.whose] - best.phi)[:, order]
    decisive = np.argmax(np.abs(gain) > tie, axis=1)
    return best.take(gain[np.arange(len(gain)), decisive] > tie)


def polish_variables(
    form: Formulation, candidates: Sequence[Candidate], traded: int, order: Sequence[int] | None = None
) -> list[Candidate]:
    """Make objectives as small as possible in their order, while the first ``traded`` stay as good as they are.

    ``order``: all objectives and then the variables, by default. For the traded ones this only takes what the gap
    of the search left; parts, counts and makeable values stay.
    """
    if not form.n or not candidates:
        return list(candidates)
    tie = form.tuning.tolerances.tie
    combinations = np.array([c.combination for c in candidates])
    variables = np.array([c.variables for c in candidates])
    phi = np.array([c.phi for c in candidates])
    low = np.where(form.gridded, variables, form.lower)
    high = np.where(form.gridded, variables, form.upper)
    goals = len(form.goals)
    cutoffs = np.full(phi.shape, np.inf)
    cutoffs[:, :traded] = phi[:, :traded] + tie
    for j in range(goals) if order is None else order:
        moving = np.flatnonzero(np.any((high > low) & form.seen_by_goal[j], axis=1))
        if not len(moving):
            continue
        tasks = Tasks(
            weights=np.tile(np.eye(goals)[j], (len(moving), 1)),
            slopes=np.zeros((len(moving), goals)),
            cutoffs=cutoffs[moving],
            goal_scales=form.objectives.scales,
            t_weight=0.0,
        )
        answer = form.continuous.solve_batch(tasks, combinations[moving], variables[moving], low[moving], high[moving])
        rows, refined = form.points.feasible_rows(answer.variables, combinations[moving])
        for k in rows:
            design = moving[k]
            if np.all(refined[k] <= cutoffs[design] + tie) and refined[k, j] < phi[design, j] - tie:
                variables[design], phi[design] = answer.variables[k], refined[k]
        cutoffs[:, j] = phi[:, j] + tie
    return [Candidate(int(c), x, p) for c, x, p in zip(combinations, variables, phi, strict=True)]


def break_ties(
    form: Formulation, pool: Boxes, chosen: Sequence[Candidate], traded: int
) -> list[tuple[Candidate, tuple[str, ...]]]:
    """Settle what the traded objectives leave open, and name other combinations that are as good.

    Returns
    -------
    list of (Candidate, tuple of str)
        Per design the one that stands for it, and in what others that tie with it differ.
    """
    chosen = polish_discrete(form, chosen, traded, range(len(form.goals)))
    chosen = polish_variables(form, chosen, traded)
    result = []
    for candidate, ties in zip(chosen, same_designs(form, pool, chosen, traded), strict=True):
        current = min(ties, key=lambda c: tuple(np.round(c.phi[traded:], 9)), default=candidate)
        others = [c.combination for c in ties if c.combination != current.combination]
        result.append((current, tuple(_difference(form.instance, current.combination, other) for other in others)))
    return result


def _difference(instance: SearchSpace, combination: int, other: int) -> str:
    """Differences of another combination, in words."""
    return ", ".join(f"{name} {its}" for name, _, its in instance.combinations.differences(combination, other))


def same_designs(form: Formulation, pool: Boxes, candidates: Sequence[Candidate], traded: int) -> list[list[Candidate]]:
    """Designs of all combinations, per design, with the same traded objectives and dimensions."""
    tied: list[list[Candidate]] = [[] for _ in candidates]
    if not len(pool) or not candidates:
        return tied
    tie, limits = form.tuning.tolerances.tie, form.tuning.heuristics.polishing
    phi = np.array([c.phi for c in candidates])
    points = np.array([c.variables for c in candidates]).reshape(len(candidates), form.n)
    cutoffs = np.full(phi.shape, np.inf)
    cutoffs[:, :traded] = phi[:, :traded] + tie
    start, apart = pool.take(np.zeros(len(candidates), dtype=np.int64)), form.instance.scenario_factors
    cell, combinations = np.zeros_like(start.cell), np.array([c.combination for c in candidates])
    cell[:, :apart] = form.boxes.cell_of(combinations)[:, :apart]
    questions = form.instance.combinations.digits(combinations)[:apart]

    def take(whose: np.ndarray, every: np.ndarray) -> None:
        # A cell may hold questions that are the same in all that counts: theirs are no other designs.
        keep = np.ones(len(whose), dtype=bool)
        for digit, its in zip(form.instance.combinations.digits(every)[:apart], questions, strict=True):
            keep &= digit == its[whose]
        same = _feasible(form, whose[keep], every[keep], points[whose[keep]])
        for k in np.flatnonzero(np.all(np.abs(same.phi - phi[same.whose])[:, :traded] <= tie, axis=1)):
            if len(tied[same.whose[k]]) < limits.ties:
                tied[same.whose[k]].append(Candidate(int(same.combinations[k]), same.variables[k], same.phi[k]))

    waiting = [replace(start, cell=cell, low=points, high=points, tag=np.arange(len(candidates)))]
    while waiting:  # where millions tie, only as many boxes at a time as memory holds, and no more than are told
        boxes = waiting.pop()
        boxes = boxes.take(np.array([len(its) < limits.ties for its in tied])[boxes.tag])
        later, boxes = boxes.take(slice(limits.evaluated_at_once, None)), boxes.take(slice(limits.evaluated_at_once))
        boxes = form.boxes.contract(boxes, cutoffs[boxes.tag], passes=1)
        single = form.boxes.cells.single(boxes.cell)
        numbers = _members(form, boxes.cell[single], limits.ties)
        take(
            np.repeat(boxes.tag[single], [len(n) for n in numbers]),
            np.concatenate([np.empty(0, dtype=np.int64), *numbers]),
        )
        boxes, _ = form.boxes.split(boxes.take(~single))
        waiting += [batch for batch in (later, boxes) if len(batch)]
    return tied


def _members(form: Formulation, cells: np.ndarray, most: int) -> list[np.ndarray]:
    """Return combinations of each of some cells that cannot be split, most of which have one: at most so many."""
    if np.all(form.boxes.cells.size(cells) == 1):
        return list(form.boxes.cells.combination(cells)[:, None])
    return [form.boxes.cells.members(cell, most) for cell in cells]


def solve_everywhere(
    form: Formulation, combinations: np.ndarray, rule: PruningRule, clock: Clock, rng: np.random.Generator
) -> None:
    """Solve the continuous problem of every combination from several starts and in several directions."""
    columns, goals, limits = rule.columns, len(form.goals), form.tuning.heuristics.polishing
    directions = np.concatenate([np.eye(len(columns)), np.full((1, len(columns)), 1.0), rng.random((2, len(columns)))])
    for number in range(0, len(combinations), limits.batch):
        part = combinations[number : number + limits.batch]
        for _ in range(limits.starts):
            share = rng.random((len(part), form.n))
            start = form.lower + share * (form.upper - form.lower)
            for direction in directions if len(columns) > 1 else [np.ones(1)]:
                clock.check()
                weights = np.zeros((len(part), goals))
                weights[:, columns] = np.maximum(direction, 1e-3)
                tasks = Tasks(
                    weights,
                    np.zeros((len(part), goals)),
                    np.tile(rule.fixed_cutoffs, (len(part), 1)),
                    form.objectives.scales,
                    0.0,
                )
                points = form.makeable.nearest(
                    form.continuous.solve_batch(tasks, part, start).variables if form.n else start
                )
                rows, phi = form.points.feasible_rows(points, part)
                form.archive.add(part[rows], points[rows], phi[rows])
                rule.take(part[rows], points[rows], phi[rows])
