"""The scalar search: one best design over all boxes, and the proof that nothing is better by more than the gap.

A scalar problem asks for the least t with phi_k <= base_k + slope_k t for every objective k (slope 0:
a plain cap). Boxes are tightened against the limits and against the incumbent less the gap; what
survives is split. When nothing survives, the incumbent is proven. A solver never excludes a box.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from synth.formulation import SNAP, TIE, Boxes, Candidate, Formulation
from synth.nlp import Solution, Task

BATCH = 4096
FEW = 1024
PATIENCE = 3
TRIES_PER_ROUND = 2
TRIES_PER_COMBINATION = 3
PROBES = 256
KNOWN = 20
EDGE = 0.02  # a point just inside the lower ends: limits are loosened a little in propagation, not in evaluation
ROUNDINGS = 256
VECTORS = 6


class Stopped(Exception):
    """The time limit is reached, or the user interrupted."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


@dataclass(frozen=True)
class Target:
    """A scalar problem: least t with phi_k <= base_k + slope_k t."""

    base: np.ndarray
    slope: np.ndarray

    def reaches_beyond(self, count: int) -> bool:
        """Tell whether it speaks of more than the first objectives."""
        return bool(np.any(self.slope[count:] > 0) or np.any(np.isfinite(self.base[count:])))

    def t_of(self, phi: np.ndarray) -> np.ndarray:
        """Return t of objectives (batch, objectives); infinite where a plain cap is broken."""
        moving = self.slope > 0
        t = np.max((phi[..., moving] - self.base[moving]) / self.slope[moving], axis=-1)
        broken = np.any(phi[..., ~moving] > self.base[~moving] + TIE, axis=-1)
        return np.where(broken, np.inf, t)

    def caps(self, t: float, slack: np.ndarray) -> np.ndarray:
        """Return the caps of phi that a design better than t by the slack must keep."""
        moving = self.slope > 0
        with np.errstate(all="ignore"):
            level = np.where(moving, self.base + np.where(moving, self.slope, 0.0) * t - slack, self.base + TIE)
        return np.where(moving & ~np.isfinite(t), np.inf, level)


@dataclass
class Clock:
    """The time that is left, and the way to say how far the search has come."""

    deadline: float = np.inf
    report: Callable[[int], None] = lambda open_boxes: None

    def check(self, open_boxes: int = 0) -> None:
        """Tell how many boxes are open, and raise Stopped when time is over."""
        self.report(open_boxes)
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")


@dataclass
class Outcome:
    """What a scalar search found and how far it is proven."""

    best: Candidate | None
    t: float
    closed: bool
    open_combinations: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    unresolved: int = 0


def relative_slack(form: Formulation, gap: float, level: np.ndarray, ranges: np.ndarray | None) -> np.ndarray:
    """Return the gap as a distance in phi, per objective.

    Positive objectives: a factor 1 - gap. Others: a share of their range on the front, or of their size.
    """
    size = np.abs(np.where(np.isfinite(level), level, 0.0)) if ranges is None else ranges
    return np.where(form.log_goals, -np.log1p(-gap), gap * np.maximum(size, 1e-9))


@dataclass(frozen=True)
class Question:
    """One scalar problem: where to look, for what, and what is known already.

    Parameters
    ----------
    target : Target
    boxes : Boxes
        Where to search.
    start : Candidate, optional
        A design known to be feasible.
    ceiling : float
        Only designs with t below this are of interest.
    """

    target: Target
    boxes: Boxes
    start: Candidate | None = None
    ceiling: float = np.inf


def minimise(
    form: Formulation,
    questions: Sequence[Question],
    gap: float,
    clock: Clock,
    ranges: np.ndarray | None = None,
    effort: int = 400_000,
) -> list[Outcome]:
    """Find the least t of several scalar problems, all in one go so that they share the cost of a batch.

    Parameters
    ----------
    form : Formulation
    questions : list of Question
    gap : float
        Relative improvement that need not be excluded.
    clock : Clock
    ranges : array, optional
        Range of each objective on the front, for objectives that may be zero.
    effort : int
        Boxes that may be tightened per question before the search gives up proving.

    Returns
    -------
    list of Outcome, one per question
    """
    every_goal = any(q.target.reaches_beyond(form.traded) for q in questions)
    searches = [_Search(form, q, gap, ranges, tag) for tag, q in enumerate(questions)]
    for search in searches:
        search.improve_known()
    while active := [s for s in searches if s.alive(effort)]:
        clock.check(sum(len(s.waiting) for s in active))
        batches = [s.next_batch(max(BATCH // len(active), FEW)) for s in active]
        multipliers = np.concatenate([s.multipliers[: max(1, VECTORS // len(active))] for s in active])
        joined = form.contract(
            Boxes.joined(batches), _caps_of(searches, batches), combine=multipliers, every_goal=every_goal
        )
        parts = {s: joined.take(joined.tag == s.tag) for s in active}
        _probe(form, searches, parts, every_goal)
        for search, boxes in parts.items():
            search.advance(boxes)
    return [s.outcome() for s in searches]


def _caps_of(searches: Sequence[_Search], batches: Sequence[Boxes]) -> np.ndarray:
    """Return a row of caps per box, each from the incumbent of its own question."""
    caps = np.array([s.caps() for s in searches])
    rows: np.ndarray = caps[np.concatenate([b.tag for b in batches])]
    return rows


def _probe(form: Formulation, searches: Sequence[_Search], parts: Mapping[_Search, Boxes], every_goal: bool) -> None:
    """Evaluate points of the most promising boxes of every question that still looks for designs.

    Gridded variables are fixed in the middle of a box; propagation then says what is left of the others.
    """
    chosen = [s.promising(boxes) for s, boxes in parts.items() if s.looks_for_designs() and len(boxes)]
    if not chosen:
        return
    boxes = Boxes.joined(chosen)
    if form.gridded.any():
        middle = form.makeable(form.inside(boxes, 0.5))
        boxes = replace(
            boxes,
            low=np.where(form.gridded, middle, boxes.low),
            high=np.where(form.gridded, middle, boxes.high),
        )
        boxes = form.contract(boxes, _caps_of(searches, [boxes]), every_goal=every_goal)
    for search in parts:
        own = boxes.take(boxes.tag == search.tag)
        for share in (EDGE, 0.5) if len(own) else ():
            search.offer(form.candidates(form.makeable(form.inside(own, share)), own.combination))


class _Search:
    """The incumbent of one scalar problem and the tries that improve it."""

    def __init__(self, form: Formulation, question: Question, gap: float, ranges: np.ndarray | None, tag: int) -> None:
        self.form, self.target, self.gap, self.ranges, self.tag = form, question.target, gap, ranges, tag
        self.rng = np.random.default_rng(tag)
        self.waiting = question.boxes.tagged(tag)
        self.best = question.start
        known = np.inf if self.best is None else float(self.target.t_of(self.best.phi))
        self.t = self.t_before = min(question.ceiling, known)
        self.tightened = self.rounds = self.failures = 0
        self.tried: dict[int, int] = {}
        self.multipliers = np.empty((0, len(form.cuts) + len(form.goals)))
        self.left_open = np.empty(0, dtype=np.int64)
        moving = self.target.slope > 0
        self.task = Task(
            weights=np.where(moving, 1e-6 / max(1, int(moving.sum())), 0.0),
            slopes=np.where(moving, self.target.slope, 0.0),
            caps=np.where(np.isfinite(self.target.base), self.target.base, np.inf),
            goal_scales=form.goal_scales,
        )

    def alive(self, effort: int) -> bool:
        """Tell whether there are boxes left that may hold something better, and effort to look into them."""
        self.waiting = self._possible(self.waiting)
        return len(self.waiting) > 0 and self.tightened <= effort

    def _possible(self, boxes: Boxes) -> Boxes:
        return boxes.take(np.all(self.form.phi_of(boxes.bounds) <= self.caps(), axis=1))

    def next_batch(self, size: int) -> Boxes:
        """Take the boxes that promise most."""
        batch, rest = self.waiting, self.waiting.take(np.zeros(0, dtype=np.int64))
        if len(batch) > size:
            order = np.argsort(self.t_of(batch), kind="stable")
            batch, rest = batch.take(order[:size]), batch.take(order[size:])
        self.waiting = rest
        self.tightened += len(batch)
        return batch

    def t_of(self, boxes: Boxes) -> np.ndarray:
        """Return the least t that the bounds of boxes allow."""
        return self.target.t_of(self.form.phi_of(boxes.bounds))

    def advance(self, boxes: Boxes) -> None:
        """Look for better designs in tightened boxes, then split what may still hold some."""
        self.try_some(boxes)
        boxes = self._possible(boxes)
        for _ in range(1 if len(boxes) > FEW else 2):
            # A small batch costs as much as a larger one, so that it is split twice at once.
            boxes, small = self.form.split(boxes)
            self.close_small(small)
        self.waiting = Boxes.joined([self.waiting, boxes])

    def outcome(self) -> Outcome:
        """Return what was found, and which combinations are left open."""
        left = np.unique(np.concatenate([self.waiting.combination, self.left_open]))
        return Outcome(self.best, self.t, not len(left), left, len(self.waiting) + len(self.left_open))

    def caps(self) -> np.ndarray:
        level = self.target.base + np.where(self.target.slope > 0, self.target.slope, 0.0) * (
            self.t if np.isfinite(self.t) else 0.0
        )
        return self.target.caps(self.t, relative_slack(self.form, self.gap, level, self.ranges))

    def learn(self, solution: Solution) -> None:
        """Keep the multipliers of a solution: near other optima they nearly are multipliers too."""
        row = np.concatenate([solution.cut_multipliers, solution.goal_multipliers])
        total = np.abs(row).sum()
        if not solution.converged or not np.isfinite(total) or total == 0:
            return
        row = np.where(np.abs(row) > 1e-4 * total, row / total, 0.0)
        either_sign = np.array([c.sense == "equal" for c in self.form.cuts] + [False] * len(self.form.goals))
        row = np.where(either_sign, row, np.maximum(row, 0.0))
        known = np.any(np.all(np.abs(self.multipliers - row) < 0.02, axis=1))
        if not known:
            self.multipliers = np.vstack([row, self.multipliers])[:VECTORS]

    def offer(self, candidates: list[Candidate]) -> None:
        for candidate in candidates:
            t = float(self.target.t_of(candidate.phi))
            if t < self.t - 1e-13 * abs(self.t) or (self.best is None and t <= self.t):
                self.best, self.t = candidate, t

    def improve_known(self) -> None:
        """Start from designs found earlier: take the best, and solve in the combinations that promise most."""
        archive = self.form.archive
        if not len(archive):
            return
        t = self.target.t_of(archive.phi)
        order = np.argsort(t, kind="stable")[:KNOWN]
        # A list of its own: the archive changes while solving.
        known = [archive[int(k)] for k in order if np.isfinite(t[k])]
        self.offer(known[:1])
        for candidate in known:
            if len(self.tried) == TRIES_PER_ROUND:
                break
            if candidate.combination not in self.tried:
                self.tried[candidate.combination] = 1
                self.improve(candidate)

    def improve(self, candidate: Candidate) -> None:
        """Solve in the combination of a known design, starting from it."""
        self.try_box(self.form.root(np.array([candidate.combination])), candidate.variables)

    def looks_for_designs(self) -> bool:
        """Tell whether this round looks for designs: after some without success, only every few rounds."""
        return self.failures < PATIENCE or self.rounds % (self.failures - PATIENCE + 2) == 0

    def promising(self, boxes: Boxes) -> Boxes:
        """Return the boxes to probe."""
        return boxes.take(np.argsort(self.t_of(boxes), kind="stable")[:PROBES])

    def try_some(self, boxes: Boxes) -> None:
        """Solve the continuous problem where the probes found a better design, or else where bounds promise one."""
        looked = self.looks_for_designs()
        self.rounds += 1
        if not looked or not len(boxes):
            return
        found = self.t < self.t_before
        if found and self.best is not None:
            self.improve(self.best)
        else:
            self._try_best_bounds(boxes)
        self.failures = 0 if self.t < self.t_before else self.failures + 1
        self.t_before = self.t

    def _try_best_bounds(self, boxes: Boxes) -> None:
        t = self.t_of(boxes)
        tries = 0
        for k in np.argsort(t, kind="stable")[: 4 * TRIES_PER_ROUND]:
            combination = int(boxes.combination[k])
            if tries == TRIES_PER_ROUND or (np.isfinite(self.t) and t[k] >= self.t):
                break
            if self.tried.get(combination, 0) < TRIES_PER_COMBINATION:
                tries += 1
                self.tried[combination] = self.tried.get(combination, 0) + 1
                box = boxes.take(np.array([k]))
                self.try_box(box, self.form.good_start(box, self.rng))

    def try_box(self, box: Boxes, start: np.ndarray) -> None:
        """Solve in one box; with a grid, round the answer and solve again for what remains."""
        if not len(box):
            return
        form = self.form
        low, high, combination = box.low[0], box.high[0], int(box.combination[0])
        solution = form.solve(self.task, combination, start, low, high)
        if solution is None:
            return
        self.learn(solution)
        if not form.gridded.any():
            self.offer(form.candidates(solution.variables[None, :], np.array([combination])))
            return
        probes = form.contract(
            self._roundings(box, solution.variables),
            self.caps(),
            every_goal=self.target.reaches_beyond(form.traded),
        )
        t = self.target.t_of(form.phi_of(probes.bounds)) if len(probes) else np.empty(0)
        for k in np.argsort(t, kind="stable")[:4]:
            if t[k] < self.t:
                self.try_leaf(probes.take(np.array([k])), solution.variables)

    def _roundings(self, box: Boxes, variables: np.ndarray) -> Boxes:
        """Return the makeable points around a continuous optimum, as boxes with gridded variables fixed.

        The nearest ones alone would not do: along a limit that two variables share, the best makeable point
        is often several steps away.
        """
        form = self.form
        gridded = int(form.gridded.sum())
        reach = max(1, int(ROUNDINGS ** (1 / gridded) / 2))
        ends: list[np.ndarray] = []
        for k, grid in enumerate(form.grids):
            if not len(grid):
                ends.append(np.array([np.nan]))
                continue
            position = int(np.searchsorted(grid, variables[k]))
            near = grid[max(position - reach, 0) : position + reach]
            inside = (near >= box.low[0, k] * (1 - SNAP)) & (near <= box.high[0, k] * (1 + SNAP))
            ends.append(near[inside] if inside.any() else near[:1])
        choices = np.array(np.meshgrid(*ends, indexing="ij")).reshape(form.n, -1).T
        if len(choices) > 4 * ROUNDINGS:
            choices = choices[self.rng.choice(len(choices), 4 * ROUNDINGS, replace=False)]
        count = len(choices)
        return Boxes(
            np.full(count, box.combination[0]),
            np.where(np.isnan(choices), box.low, choices),
            np.where(np.isnan(choices), box.high, choices),
            np.repeat(box.bounds, count, axis=0),
            np.repeat(box.scores, count, axis=0),
            np.repeat(box.tag, count),
        )

    def try_leaf(self, box: Boxes, near: np.ndarray) -> None:
        """Solve in a box whose gridded variables are fixed."""
        form = self.form
        low, high = box.low[0], box.high[0]
        solution = form.solve(self.task, int(box.combination[0]), np.clip(near, low, high), low, high)
        if solution is not None:
            self.offer(form.candidates(solution.variables[None, :], box.combination))

    def close_small(self, boxes: Boxes) -> None:
        """Look into boxes too small to split: their points are evaluated; what stays possible is left open."""
        if not len(boxes):
            return
        middle = 0.5 * (boxes.low + boxes.high)
        self.offer(self.form.candidates(middle, boxes.combination))
        for k in range(min(len(boxes), 8)):
            self.try_leaf(boxes.take(np.array([k])), middle[k])
        # A box that is a single point is settled by its evaluation; a small one only nearly so.
        point = np.all(boxes.high - boxes.low <= 1e-12 * np.abs(boxes.high), axis=1)
        better = np.all(self.form.phi_of(boxes.bounds) <= self.caps(), axis=1) & ~point
        if better.any():
            self.left_open = np.concatenate([self.left_open, boxes.combination[better]])
