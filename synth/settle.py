"""What comes after the proof: ties settled, equal designs named, open combinations solved one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from synth.batch_nlp import Tasks
from synth.clock import Clock
from synth.formulation import TIE, Boxes, Candidate, Formulation
from synth.instance import Instance
from synth.purposes import Purpose

STARTS = 6
DIRECTIONS = 5
BATCH = 2048
MOST_TIES = 50
MOST_MOVES = 8


def polish_extremes(form: Formulation, traded: int, slack: float) -> None:
    """Make the design that is best in each objective exact: solve in all combinations that come near to it."""
    archive = form.archive
    for k in range(traded if form.n else 0):
        near = np.flatnonzero(archive.phi[:, k] <= archive.phi[:, k].min() + 2 * slack)
        _, first = np.unique(archive.combination[near], return_index=True)
        chosen = [archive[int(near[i])] for i in np.sort(first)[:MOST_TIES]]
        order = [k, *(j for j in range(traded) if j != k)]
        exact = settle_discrete(form, settle_variables(form, chosen, 0, order), traded, order)
        for c in settle_variables(form, exact, 0, order):
            archive.add(np.array([c.combination]), c.variables[None, :], c.phi[None, :])


def settle_discrete(
    form: Formulation, candidates: Sequence[Candidate], traded: int, order: Sequence[int], parts: bool = True
) -> list[Candidate]:
    """Change one makeable value or part at a time while the objectives, compared in their order, become smaller.

    None of the first ``traded`` becomes larger. What the best design in one objective leaves free over a grid or among
    parts, the other objectives decide that way. Parts stay where ``parts`` is False.
    """
    return [_settle_discrete(form, candidate, traded, list(order), parts) for candidate in candidates]


def _settle_discrete(form: Formulation, candidate: Candidate, traded: int, order: list[int], parts: bool) -> Candidate:
    movable = np.flatnonzero(form.gridded & (form.lower < form.upper))
    for _ in range(MOST_MOVES):
        before = candidate
        for k in movable:
            grid = form.grids[k]
            grid = grid[(grid >= form.lower[k]) & (grid <= form.upper[k])]
            trials = np.tile(candidate.variables, (len(grid), 1))
            trials[:, k] = grid
            candidate = _better(form, candidate, trials, np.full(len(grid), candidate.combination), traded, order)
        others = form.instance.neighbours(candidate.combination) if parts else np.empty(0, dtype=np.int64)
        trials = np.tile(candidate.variables, (len(others), 1))
        candidate = _better(form, candidate, trials, others, traded, order)
        if candidate is before:
            break
    return candidate


def _better(
    form: Formulation, own: Candidate, trials: np.ndarray, combinations: np.ndarray, traded: int, order: list[int]
) -> Candidate:
    """Return the best trial by the objectives in their order where it is better than a design, else the design."""
    rows, phi = form.feasible_rows(trials, combinations)
    left = rows[np.all(phi[rows, :traded] <= own.phi[:traded] + TIE, axis=1)]
    for j in order:
        left = left[phi[left, j] <= np.min(phi[left, j], initial=np.inf) + TIE]
    for row in left[:1]:
        gain = own.phi[order] - phi[row, order]
        decisive = np.flatnonzero(np.abs(gain) > TIE)
        if len(decisive) and gain[decisive[0]] > 0:
            return Candidate(int(combinations[row]), trials[row], phi[row])
    return own


def settle_variables(
    form: Formulation, candidates: Sequence[Candidate], traded: int, order: Sequence[int] | None = None
) -> list[Candidate]:
    """Make objectives as small as possible in their order, while the first ``traded`` stay as good as they are.

    ``order``: all objectives and then the variables, by default. For the traded ones this only takes what the gap
    of the search left; parts, counts and makeable values stay.
    """
    if not form.n or not candidates:
        return list(candidates)
    combinations = np.array([c.combination for c in candidates])
    variables = np.array([c.variables for c in candidates])
    phi = np.array([c.phi for c in candidates])
    low = np.where(form.gridded, variables, form.lower)
    high = np.where(form.gridded, variables, form.upper)
    goals = len(form.goals)
    caps = np.full(phi.shape, np.inf)
    caps[:, :traded] = phi[:, :traded] + TIE
    for j in range(goals) if order is None else order:
        moving = np.flatnonzero(np.any((high > low) & form.seen_by_goal[j], axis=1))
        if not len(moving):
            continue
        tasks = Tasks(
            weights=np.tile(np.eye(goals)[j], (len(moving), 1)),
            slopes=np.zeros((len(moving), goals)),
            caps=caps[moving],
            goal_scales=form.goal_scales,
            t_weight=0.0,
        )
        answer = form.solve_many(tasks, combinations[moving], variables[moving], low[moving], high[moving])
        rows, found = form.feasible_rows(answer.variables, combinations[moving])
        for k in rows:
            own = moving[k]
            if np.all(found[k] <= caps[own] + TIE) and found[k, j] < phi[own, j] - TIE:
                variables[own], phi[own] = answer.variables[k], found[k]
        caps[:, j] = phi[:, j] + TIE
    return [Candidate(int(c), x, p) for c, x, p in zip(combinations, variables, phi, strict=True)]


def settle_ties(
    form: Formulation, pool: Boxes, chosen: Sequence[Candidate], traded: int
) -> list[tuple[Candidate, tuple[str, ...]]]:
    """Settle what the traded objectives leave open, and name other combinations that are as good.

    Returns
    -------
    list of (Candidate, tuple of str)
        Per design the one that stands for it, and in what others that tie with it differ.
    """
    chosen = settle_discrete(form, chosen, traded, range(len(form.goals)))
    chosen = settle_variables(form, chosen, traded)
    result = []
    for candidate, ties in zip(chosen, same_designs(form, pool, chosen, traded), strict=True):
        current = min(ties, key=lambda c: tuple(np.round(c.phi[traded:], 9)), default=candidate)
        others = [c.combination for c in ties if c.combination != current.combination]
        result.append((current, tuple(_difference(form.instance, current.combination, other) for other in others)))
    return result


def _difference(instance: Instance, combination: int, other: int) -> str:
    """Return in words in what another combination differs."""
    own, its = instance.describe(combination), instance.describe(other)
    words = []
    for slot in own[0]:
        if own[0][slot] != its[0][slot]:
            table, row = its[0][slot]
            words.append(f"{slot} {table.designations[row]}")
    words += [f"{n} {its[1][n]:g}" for n in own[1] if own[1][n] != its[1][n]]
    words += [f"{n} {its[2][n]}" for n in own[2] if own[2][n] != its[2][n]]
    return ", ".join(words)


def same_designs(form: Formulation, pool: Boxes, candidates: Sequence[Candidate], traded: int) -> list[list[Candidate]]:
    """Return, per design, those of all combinations that reach the same traded objectives with the same dimensions."""
    found: list[list[Candidate]] = [[] for _ in candidates]
    if not len(pool) or not candidates:
        return found
    phi = np.array([c.phi for c in candidates])
    points = np.array([c.variables for c in candidates]).reshape(len(candidates), form.n)
    caps = np.full(phi.shape, np.inf)
    caps[:, :traded] = phi[:, :traded] + TIE
    start, apart = pool.take(np.zeros(len(candidates), dtype=np.int64)), form.instance.apart
    cell, own = np.zeros_like(start.cell), np.array([c.combination for c in candidates])
    cell[:, :apart] = form.cell_of(own)[:, :apart]
    questions = form.instance.digits(own)[:apart]
    boxes = replace(start, cell=cell, low=points, high=points, tag=np.arange(len(candidates)))
    while len(boxes):
        boxes = form.contract(boxes, caps[boxes.tag], passes=1)
        single = form.cells.single(boxes.cell)
        numbers = [form.cells.members(cell, MOST_TIES) for cell in boxes.cell[single]]
        tags = np.repeat(boxes.tag[single], [len(n) for n in numbers])
        combinations = np.concatenate(numbers) if numbers else np.empty(0, dtype=np.int64)
        # A cell may hold questions that are the same in all that counts: theirs are no other designs.
        keep = np.ones(len(tags), dtype=bool)
        for digit, its in zip(form.instance.digits(combinations)[:apart], questions, strict=True):
            keep &= digit == its[tags]
        combinations, tags = combinations[keep], tags[keep]
        rows, values = form.feasible_rows(points[tags], combinations)
        for k in rows:
            same = np.all(np.abs(values[k, :traded] - phi[tags[k], :traded]) <= TIE)
            if same and len(found[tags[k]]) < MOST_TIES:
                found[tags[k]].append(Candidate(int(combinations[k]), points[tags[k]], values[k]))
        boxes, _ = form.split(boxes.take(~single))
    return found


def solve_everywhere(
    form: Formulation, combinations: np.ndarray, purpose: Purpose, clock: Clock, rng: np.random.Generator
) -> None:
    """Solve the continuous problem of every combination from several starts and in several directions."""
    columns, goals = purpose.columns, len(form.goals)
    directions = np.concatenate([np.eye(len(columns)), np.full((1, len(columns)), 1.0), rng.random((2, len(columns)))])
    for number in range(0, len(combinations), BATCH):
        own = combinations[number : number + BATCH]
        for _ in range(STARTS):
            share = rng.random((len(own), form.n))
            start = form.lower + share * (form.upper - form.lower)
            for direction in directions if len(columns) > 1 else [np.ones(1)]:
                clock.check()
                weights = np.zeros((len(own), goals))
                weights[:, columns] = np.maximum(direction, 1e-3)
                tasks = Tasks(
                    weights, np.zeros((len(own), goals)), np.tile(purpose.plain, (len(own), 1)), form.goal_scales, 0.0
                )
                points = form.makeable(form.solve_many(tasks, own, start).variables if form.n else start)
                rows, phi = form.feasible_rows(points, own)
                form.archive.add(own[rows], points[rows], phi[rows])
                purpose.take(own[rows], points[rows], phi[rows])
