"""The scalar search: one best design over all boxes, and the proof that nothing is better by more than the gap.

A scalar problem asks for the least t with phi_k <= base_k + slope_k t for every objective k (slope 0:
a plain cap). Boxes are tightened against the limits and against the incumbent less the gap; what
survives is split. When nothing survives, the incumbent is proven. A solver never excludes a box.
"""

from __future__ import annotations

import time
from collections.abc import Callable
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
EDGE = 0.02  # a point just inside the lower ends: limits are loosened a little in propagation, not in evaluation
ROUNDINGS = 256
VECTORS = 6


class Stopped(Exception):  # noqa: N818 - not a fault: the user's time or patience is over
    """The time limit is reached, or the user interrupted."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


@dataclass(frozen=True)
class Target:
    """A scalar problem: least t with phi_k <= base_k + slope_k t."""

    base: np.ndarray
    slope: np.ndarray

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
    report: Callable[[str], None] = lambda message: None

    def check(self) -> None:
        """Raise Stopped when time is over."""
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


def minimise(
    form: Formulation,
    boxes: Boxes,
    target: Target,
    gap: float,
    clock: Clock,
    start: Candidate | None = None,
    ceiling: float = np.inf,
    ranges: np.ndarray | None = None,
    effort: int = 400_000,
    seed: int = 0,
) -> Outcome:
    """Find the least t over all boxes.

    Parameters
    ----------
    form : Formulation
    boxes : Boxes
        Where to search.
    target : Target
    gap : float
        Relative improvement that need not be excluded.
    clock : Clock
    start : Candidate, optional
        A design known to be feasible.
    ceiling : float
        Only designs with t below this are of interest.
    ranges : array, optional
        Range of each objective on the front, for objectives that may be zero.
    effort : int
        Boxes that may be tightened before the search gives up proving.

    Returns
    -------
    Outcome
    """
    search = _Search(form, target, gap, ranges, start, ceiling, seed)
    search.improve_known()
    waiting, tightened = boxes, 0
    while len(waiting):
        clock.check()
        caps = search.caps()
        waiting = waiting.take(np.all(form.phi_of(waiting.bounds) <= caps, axis=1))
        if not len(waiting):
            break
        batch, waiting = _best(form, target, waiting)
        tightened += len(batch)
        batch = form.contract(batch, caps, combine=search.multipliers)
        search.try_some(batch)
        batch = batch.take(np.all(form.phi_of(batch.bounds) <= search.caps(), axis=1))
        for _ in range(1 if len(batch) > FEW else 2):
            # A small batch costs as much as a larger one, so that it is split twice at once.
            batch, small = form.split(batch)
            search.close_small(small)
        waiting = Boxes.joined([waiting, batch])
        if tightened > effort and len(waiting):
            open_ones = np.unique(np.concatenate([waiting.combination, search.left_open]))
            return Outcome(search.best, search.t, False, open_ones, len(waiting))
    closed = not len(search.left_open)
    return Outcome(search.best, search.t, closed, np.unique(search.left_open), len(search.left_open))


def _best(form: Formulation, target: Target, boxes: Boxes) -> tuple[Boxes, Boxes]:
    if len(boxes) <= BATCH:
        return boxes, boxes.take(np.zeros(0, dtype=np.int64))
    t = target.t_of(form.phi_of(boxes.bounds))
    order = np.argsort(t, kind="stable")
    return boxes.take(order[:BATCH]), boxes.take(order[BATCH:])


class _Search:
    """The incumbent of one scalar problem and the tries that improve it."""

    def __init__(
        self,
        form: Formulation,
        target: Target,
        gap: float,
        ranges: np.ndarray | None,
        start: Candidate | None,
        ceiling: float,
        seed: int,
    ) -> None:
        self.rng = np.random.default_rng(seed)
        self.form, self.target, self.gap, self.ranges = form, target, gap, ranges
        self.best = start
        self.t = ceiling if start is None else min(ceiling, float(target.t_of(start.phi)))
        self.tried: dict[int, int] = {}
        self.rounds = self.failures = 0
        self.multipliers = np.empty((0, len(form.cuts) + len(form.goals)))
        self.left_open = np.empty(0, dtype=np.int64)
        moving = target.slope > 0
        self.task = Task(
            weights=np.where(moving, 1e-6 / max(1, int(moving.sum())), 0.0),
            slopes=np.where(moving, target.slope, 0.0),
            caps=np.where(np.isfinite(target.base), target.base, np.inf),
            goal_scales=form.goal_scales,
        )

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
        tries = 0
        for k in np.argsort(t, kind="stable"):
            if tries == TRIES_PER_ROUND or not np.isfinite(t[k]):
                break
            candidate = archive[k]
            self.offer([candidate])
            if candidate.combination not in self.tried:
                tries += 1
                self.tried[candidate.combination] = 1
                self.improve(candidate)

    def improve(self, candidate: Candidate) -> None:
        """Solve in the combination of a known design, starting from it."""
        self.try_box(self.form.root(np.array([candidate.combination])), candidate.variables)

    def try_some(self, boxes: Boxes) -> None:
        """Look for better designs: points of many boxes at once, then the continuous problem of the best."""
        self.rounds += 1
        # After some rounds without a better design, looking for one every few rounds is enough.
        if not len(boxes) or (self.failures >= PATIENCE and self.rounds % (self.failures - PATIENCE + 2)):
            return
        form = self.form
        before = self.t
        self.failures += 1
        t = self.target.t_of(form.phi_of(boxes.bounds))
        order = np.argsort(t, kind="stable")
        self.probe(boxes.take(order[:PROBES]))
        if self.best is not None and self.t < before:
            self.failures = 0
            box = form.root(np.array([self.best.combination]))
            self.try_box(box, self.best.variables)
            return
        tries = 0
        for k in order[: 4 * TRIES_PER_ROUND]:
            combination = int(boxes.combination[k])
            if tries == TRIES_PER_ROUND or (np.isfinite(self.t) and t[k] >= self.t):
                break
            if self.tried.get(combination, 0) < TRIES_PER_COMBINATION:
                tries += 1
                self.tried[combination] = self.tried.get(combination, 0) + 1
                box = boxes.take(np.array([k]))
                self.try_box(box, form.good_start(box, self.rng))
        if self.t < before:
            self.failures = 0

    def probe(self, boxes: Boxes) -> None:
        """Fix the gridded variables of every box in its middle and evaluate what propagation leaves of the rest."""
        form = self.form
        middle = form.makeable(form.inside(boxes, 0.5))
        if form.gridded.any():
            boxes = replace(
                boxes,
                low=np.where(form.gridded, middle, boxes.low),
                high=np.where(form.gridded, middle, boxes.high),
            )
            boxes = form.contract(boxes, self.caps())
        for share in (EDGE, 0.5) if len(boxes) else ():
            self.offer(form.candidates(form.makeable(form.inside(boxes, share)), boxes.combination))

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
        probes = form.contract(self._roundings(box, solution.variables), self.caps())
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
        better = np.all(self.form.phi_of(boxes.bounds) <= self.caps(), axis=1)
        if better.any():
            self.left_open = np.concatenate([self.left_open, boxes.combination[better]])
