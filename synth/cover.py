"""The tree that proves: one best design, or a whole front at once.

Boxes of everything that may be designed are tightened, compared with the designs known, and split, until
every box is empty or *covered*: no design in it could be better than each known design by more than the
slack in some objective. What is then known is a front of which no design can be improved by more than the slack in
every objective, because whatever improves it would itself be covered by a known design that dominates it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from synth.batch_nlp import Tasks
from synth.formulation import SNAP, TIE, Archive, Boxes, Candidate, Formulation

BATCH = 8192
GENERATION = 8 * BATCH
FEW = 1024
PROBES = 256
MOST_NLPS = 128
LEAST_NLPS = 8
PATIENCE = 3
EDGE = 0.02  # a point just inside the lower ends: limits are loosened a little in propagation, not in evaluation
REACH = 2
TIE_WEIGHT = 1e-6
ROWS = 1024


class Stopped(Exception):
    """The time limit is reached, or the user interrupted."""

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


@dataclass
class Clock:
    """The time that is left, the boxes that are open, and the way to say how far the search has come."""

    deadline: float = np.inf
    report: Callable[[int], None] = lambda open_boxes: None
    open: list[Boxes] = field(default_factory=list)

    def check(self, boxes: Sequence[Boxes] = ()) -> None:
        """Hold the boxes that are open, tell how many, and raise Stopped when time is over."""
        self.open = list(boxes)
        self.report(sum(len(b) for b in boxes))
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")


class Purpose(Protocol):
    """What a search is for: which designs would still be of use."""

    columns: list[int]
    slack: np.ndarray
    plain: np.ndarray

    def caps(self, lower: np.ndarray) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to be of use."""

    def room(self, lower: np.ndarray) -> np.ndarray:
        """Return how much better than needed a box could be: the least distance to a cap, 0 if it is of no use."""

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many were of use."""


class Cover:
    """Cover everything: for each possible design a known one that is at most the slack worse in every objective.

    Parameters
    ----------
    columns : list of int
        Numbers of the objectives that are traded off; one of them: its best design is sought.
    slack : array (columns,)
        In phi.
    plain : array (objectives,)
        Caps of phi that every design must keep; infinite where there is none.
    known : Archive
        Designs known, no one better than another in all the objectives traded.
    """

    def __init__(self, columns: Sequence[int], slack: np.ndarray, plain: np.ndarray, known: Archive) -> None:
        self.columns, self.slack, self.plain, self.known = list(columns), slack, plain, known

    def caps(self, lower: np.ndarray) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to be of use."""
        caps = np.tile(self.plain + TIE, (len(lower), 1))
        own = self.known.caps(lower[:, self.columns], self.slack)
        caps[:, self.columns] = np.minimum(caps[:, self.columns], own)
        return caps

    def room(self, lower: np.ndarray) -> np.ndarray:
        """Return how much better than the designs known a box could be."""
        if not len(lower):
            return np.empty(0)
        with np.errstate(all="ignore"):
            distance = self.known.caps(lower[:, self.columns], self.slack) - lower[:, self.columns]
            result = np.where(np.isnan(distance), np.inf, distance).min(axis=1)
            broken = np.any(lower > self.plain + TIE, axis=1)
        return np.where(broken, 0.0, result)

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many no known one covered."""
        keep = np.all(phi <= self.plain + TIE, axis=1)
        combinations, variables, phi = combinations[keep], variables[keep], phi[keep]
        new = int((self.room(phi) > 0).sum())
        self.known.add(combinations, variables, phi)
        return new


class Staircase:
    """Prove some designs: nothing is better than one of them by more than the slack in every objective.

    Those that are best in one objective are proven in that objective alone. A design that is beaten is replaced.
    What a known design covers can beat none of them either, as no known design dominates one of them: this settles
    boxes that miss a step by no more than limits are loosened.

    Parameters
    ----------
    designs : list of Candidate
        None of them dominated by a known one.
    columns : list of int
        Numbers of the objectives.
    slack : array (columns,)
        In phi.
    known : Archive
    proven : set of bytes
        phi of designs that need no proof any more.
    """

    def __init__(
        self,
        designs: Sequence[Candidate],
        columns: Sequence[int],
        slack: np.ndarray,
        known: Archive,
        proven: Collection[bytes] = (),
    ) -> None:
        self.designs, self.columns, self.slack, self.known = list(designs), list(columns), slack, known
        self.plain = np.full(known.phi.shape[1], np.inf)
        self._proven = proven
        self._set()

    def finished(self) -> list[Candidate]:
        """Return the designs, the best known in each objective among them, none dominated by a known one.

        What has been proven of a design holds for one that dominates it, and of the best in an objective for the
        best known.
        """
        known = self.known.phi[:, self.columns]
        result = [self.known[int(k)] for k in dict.fromkeys(np.argmin(known, axis=0).tolist())]
        for c in self.designs:
            rows = np.flatnonzero(beating(known, c.phi[self.columns]))
            result.append(self.known[int(rows[0])] if len(rows) else c)
        return result

    def _set(self) -> None:
        phi = np.array([c.phi[self.columns] for c in self.designs])
        steps = [phi[[c.phi.tobytes() not in self._proven for c in self.designs]] - self.slack]
        for k in range(len(self.columns)):
            row = np.full((1, len(self.columns)), np.inf)
            row[0, k] = phi[:, k].min() - self.slack[k]
            steps.append(row)
        self.steps = np.concatenate(steps)

    def caps(self, lower: np.ndarray) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to beat one of the designs."""
        caps = np.full(lower.shape, np.inf)
        own = lower[:, self.columns]
        below = self._below_two(own) if len(self.columns) == 2 else self._below(own)
        caps[:, self.columns] = np.minimum(below, self.known.caps(own, self.slack))
        return caps

    def room(self, lower: np.ndarray) -> np.ndarray:
        """Return how far below one of the designs a box could be."""
        own = lower[:, self.columns]
        with np.errstate(all="ignore"):
            distance = (self.caps(lower)[:, self.columns] - own).min(axis=1, initial=np.inf)
        room: np.ndarray = np.maximum(distance, 0.0)
        return room

    def _below(self, own: np.ndarray) -> np.ndarray:
        """Return, per box, the largest step in each objective among those that the box could be below."""
        result = np.full(own.shape, -np.inf)
        for first in range(0, len(own), ROWS):
            part = own[first : first + ROWS]
            below = np.all(part[:, None, :] < self.steps[None, :, :], axis=2)
            for k in range(own.shape[1]):
                result[first : first + ROWS, k] = np.where(below, self.steps[None, :, k], -np.inf).max(axis=1)
        return result

    def _below_two(self, own: np.ndarray) -> np.ndarray:
        """Do the same for two objectives: steps in order of the first fall in the second."""
        steps = self.steps[np.argsort(self.steps[:, 0], kind="stable")]
        highest = np.maximum.accumulate(steps[::-1, 1])[::-1]  # the largest second among this and all later steps
        from_here = np.searchsorted(steps[:, 0], own[:, 0], side="right")  # steps above the box in the first objective
        up_to = len(steps) - np.searchsorted(highest[::-1], own[:, 1], side="right")  # ... and in the second
        alive = from_here < up_to
        last = np.minimum(up_to, len(steps)) - 1
        result = np.full(own.shape, -np.inf)
        result[alive, 0] = steps[last[alive], 0]
        result[alive, 1] = highest[from_here[alive]]
        return result

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Replace designs that are beaten; return how many were."""
        beaten = 0
        own = phi[:, self.columns]
        least = np.array([c.phi[self.columns] for c in self.designs])
        extreme = [int(np.argmin(least[:, k])) for k in range(len(self.columns))]
        for j, c in enumerate(self.designs):
            rows = np.flatnonzero(beating(own, c.phi[self.columns]))
            worth = (own[rows] / self.slack).sum(axis=1)
            for k in np.flatnonzero(np.array(extreme) == j):
                lower = np.flatnonzero(own[:, k] < c.phi[self.columns[k]] - self.slack[k])
                if len(lower):
                    rows, worth = lower, own[lower, k]
            if len(rows):
                row = rows[int(np.argmin(worth))]
                self.designs[j] = Candidate(int(combinations[row]), variables[row].copy(), phi[row])
                beaten += 1
        if beaten:
            self._set()
        return beaten


def beating(rows: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Tell which rows are as good as phi in everything and better in something, by more than rounding."""
    better: np.ndarray = np.all(rows <= phi, axis=1) & np.any(rows < phi - TIE, axis=1)
    return better


def reaches_beyond(purpose: Purpose, traded: int) -> bool:
    """Tell whether a search speaks of more than the first objectives."""
    return max(purpose.columns) >= traded or bool(np.any(np.isfinite(purpose.plain[traded:])))


@dataclass(frozen=True)
class Covered:
    """What a cover left open, how many boxes were looked into, and whether it stopped because enough is known."""

    open: Boxes
    looked: int
    full: bool = False

    @property
    def closed(self) -> bool:
        """Tell whether everything is covered."""
        return not len(self.open) and not self.full


def cover(
    form: Formulation,
    boxes: Boxes,
    purpose: Purpose,
    clock: Clock,
    rng: np.random.Generator,
    effort: float = np.inf,
    enough: int | None = None,
) -> Covered:
    """Cover everything that boxes may hold by known designs.

    Parameters
    ----------
    form : Formulation
    boxes : Boxes
        Where to search.
    purpose : Purpose
        Feasible designs go there, and into the archive of the formulation.
    clock : Clock
    rng : Generator
    effort : float
        Boxes that may be looked into.
    enough : int, optional
        Stop when more designs than this are known.

    Returns
    -------
    Covered
    """
    every = reaches_beyond(purpose, form.traded)
    seeker, looked = _Seeker(form, purpose, rng, every), 0
    nothing = boxes.take(slice(0, 0))
    queue, fresh, stuck = nothing, [boxes], nothing
    while (len(queue) or fresh) and looked <= effort:
        if not len(queue):
            # Sorting everything that waits costs time, so that a whole generation is taken at once.
            queue, rest = _most_open(form, Boxes.joined(fresh), purpose)
            fresh = [rest] if len(rest) else []
        clock.check([queue, *fresh, stuck])
        if enough is not None and len(form.archive) > enough:
            return Covered(Boxes.joined([queue, *fresh, stuck]), looked, True)
        batch, queue = queue.take(slice(0, BATCH)), queue.take(slice(BATCH, None))
        looked += len(batch)
        batch = form.contract(batch, purpose.caps(form.phi_of(batch.bounds)), every_goal=every)
        batch = batch.take(purpose.room(form.phi_of(batch.bounds)) > 0)
        if not len(batch):
            continue
        seeker.look(batch)
        for _ in range(2 if len(batch) < FEW else 1):
            # A small batch costs as much as a larger one, so that it is split twice at once.
            batch, small = form.split(batch)
            if len(small):
                stuck = Boxes.joined([stuck, seeker.settle(small)])
        fresh.append(batch)
    left = Boxes.joined([queue, *fresh, stuck])
    return Covered(left.take(purpose.room(form.phi_of(left.bounds)) > 0), looked)


def best(
    form: Formulation,
    boxes: Boxes,
    column: int,
    plain: np.ndarray,
    slack: float,
    clock: Clock,
    rng: np.random.Generator,
    start: Candidate | None = None,
    effort: float = np.inf,
) -> tuple[Candidate | None, Covered]:
    """Find the least phi of one objective, the others capped, and prove it within the slack.

    Designs of the archive of the formulation, and ``start``, are known already.
    """
    purpose = Cover([column], np.array([slack]), plain, Archive([column], form.n, len(form.goals)))
    if len(form.archive):
        purpose.take(form.archive.combination, form.archive.variables, form.archive.phi)
    if start is not None:
        purpose.take(np.array([start.combination]), start.variables[None, :], start.phi[None, :])
    found = cover(form, boxes, purpose, clock, rng, effort)
    return (purpose.known[0] if len(purpose.known) else None), found


def _most_open(form: Formulation, waiting: Boxes, purpose: Purpose) -> tuple[Boxes, Boxes]:
    """Return the next generation, boxes with most room first, and the rest; covered ones are dropped."""
    lower = form.phi_of(waiting.bounds)
    space = purpose.room(lower)
    keep = np.flatnonzero(space > 0)
    # While no design is known, all room is infinite; then low bounds promise most.
    low = lower[:, purpose.columns].mean(axis=1)
    key = np.where(np.isfinite(space), -space, np.where(np.isfinite(low), low, 0.0) - 1e6)[keep]
    order = keep[np.argsort(key, kind="stable")] if len(keep) > BATCH else keep
    return waiting.take(order[:GENERATION]), waiting.take(order[GENERATION:])


class _Seeker:
    """Looks for designs in boxes that nothing known covers."""

    def __init__(self, form: Formulation, purpose: Purpose, rng: np.random.Generator, every: bool) -> None:
        self.form, self.purpose, self.rng, self.every = form, purpose, rng, every
        self.nlps = MOST_NLPS // 4
        self.rounds = self.failures = 0

    def look(self, batch: Boxes) -> None:
        """Try the boxes with most room, all along the front; after rounds without success, only now and then."""
        self.rounds += 1
        if self.failures >= PATIENCE and self.rounds % (self.failures - PATIENCE + 2):
            return
        form = self.form
        phi = form.phi_of(batch.bounds)
        space, along = self.purpose.room(phi), phi[:, self.purpose.columns[0]]
        found = self._probe(batch.take(spread_choice(along, space, PROBES)))
        if form.n:
            most = MOST_NLPS if len(self.purpose.columns) > 1 else LEAST_NLPS
            chosen = batch.take(spread_choice(along, space, min(self.nlps, most)))
            chosen = chosen.take(self.purpose.room(form.phi_of(chosen.bounds)) > 0)
            good = self._solve(chosen)
            self.nlps = min(2 * self.nlps, MOST_NLPS) if 4 * good > len(chosen) else max(self.nlps // 2, LEAST_NLPS)
            found += good
        self.failures = 0 if found else self.failures + 1

    def settle(self, small: Boxes) -> Boxes:
        """Look into boxes too small to split; return those that may still hold something nothing known covers."""
        form = self.form
        point = np.all(small.high - small.low <= 1e-12 * np.abs(small.high), axis=1)
        # A single point is settled by its evaluation; a small box only nearly so.
        self._offer(small.low[point], form.combination(small.take(point)), exact=True)
        rest = small.take(~point)
        self._offer(0.5 * (rest.low + rest.high), form.combination(rest))
        rest = rest.take(self.purpose.room(form.phi_of(rest.bounds)) > 0)
        # What is left is feasible by the tolerance alone, or nearly so.
        self._offer(0.5 * (rest.low + rest.high), form.combination(rest), exact=True)
        return rest.take(self.purpose.room(form.phi_of(rest.bounds)) > 0)

    def _tightened(self, boxes: Boxes) -> Boxes:
        return self.form.contract(boxes, self.purpose.caps(self.form.phi_of(boxes.bounds)), every_goal=self.every)

    def _probe(self, boxes: Boxes) -> int:
        """Evaluate points of a random combination of each box; gridded variables are fixed in its middle first."""
        form = self.form
        single = form.cells.single(boxes.cell).all()
        if not single:
            boxes = replace(boxes, cell=form.cells.random_leaves(boxes.cell, self.rng))
        if form.gridded.any():
            middle = form.makeable(form.inside(boxes, 0.5))
            boxes = replace(
                boxes,
                low=np.where(form.gridded, middle, boxes.low),
                high=np.where(form.gridded, middle, boxes.high),
            )
        if form.gridded.any() or not single:
            boxes = self._tightened(boxes)
        return self._keep(boxes)

    def _keep(self, boxes: Boxes) -> int:
        """Evaluate two points of each box; return how many were new."""
        found = 0
        for share in (EDGE, 0.5) if len(boxes) else ():
            points = self.form.makeable(self.form.inside(boxes, share))
            found += self._offer(points, self.form.combination(boxes))
        return found

    def _offer(self, points: np.ndarray, combinations: np.ndarray, exact: bool = False) -> int:
        """Take what is feasible; return how many designs no known one covered."""
        form = self.form
        rows, phi = form.feasible_rows(points, combinations, exact)
        if not len(rows):
            return 0
        used = self.purpose.take(combinations[rows], points[rows], phi[rows])
        form.archive.add(combinations[rows], points[rows], phi[rows])
        return used

    def _solve(self, boxes: Boxes) -> int:
        """Solve the continuous problems of a random combination of each box: straight up from its lower bounds."""
        form, columns = self.form, self.purpose.columns
        if not len(boxes):
            return 0
        if not form.cells.single(boxes.cell).all():
            boxes = replace(boxes, cell=form.cells.random_leaves(boxes.cell, self.rng))
            boxes = self._tightened(boxes)
            if not len(boxes):
                return 0
        count, goals = len(boxes), len(form.goals)
        base = form.phi_of(boxes.bounds)[:, columns]
        slopes, weights = np.zeros((count, goals)), np.zeros((count, goals))
        slopes[:, columns] = self.purpose.slack / self.purpose.slack.max()
        weights[:, columns] = TIE_WEIGHT / slopes[:, columns]
        caps = np.tile(self.purpose.plain, (count, 1))
        if len(columns) == 1:
            slopes[:], weights[:, columns] = 0.0, 1.0
        else:
            known = np.isfinite(base)
            caps[:, columns] = np.where(known, base, np.inf)
            slopes[:, columns] = np.where(known, slopes[:, columns], 0.0)
            weights[:, columns] = np.where(known, weights[:, columns], 1.0)
        t_weight = 1.0 if len(columns) > 1 else 0.0
        tasks = Tasks(weights, slopes, caps, form.goal_scales, t_weight)
        combinations = form.combination(boxes)
        settled = form.gridded & (boxes.low == boxes.high)
        low, high = np.where(settled, boxes.low, form.lower), np.where(settled, boxes.high, form.upper)
        answer = form.solve_many(tasks, combinations, form.inside(boxes, 0.5), low, high)
        whole = np.all(settled == form.gridded, axis=1)
        found = self._offer(answer.variables[whole], combinations[whole])
        rest = np.flatnonzero(~whole)
        return found + (self._round(boxes.take(rest), answer.variables[rest]) if len(rest) else 0)

    def _round(self, boxes: Boxes, variables: np.ndarray) -> int:
        """Try the makeable points around continuous optima."""
        form = self.form
        low, high, source = roundings(form, variables)
        around = replace(boxes.take(source), low=low, high=high, bounds=np.full((len(low), len(form.goals)), -np.inf))
        return self._keep(self._tightened(around))


def roundings(form: Formulation, variables: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return boxes (low, high, which design) with gridded variables fixed at values around those of each design."""
    steps = np.array(np.meshgrid(*[np.arange(-REACH, REACH) if g else [0] for g in form.gridded], indexing="ij"))
    steps = steps.reshape(form.n, -1).T
    count = len(steps)
    low = np.tile(form.propagation.low, (len(variables) * count, 1))
    high = np.tile(form.propagation.high, (len(variables) * count, 1))
    for k, grid in enumerate(form.grids):
        if len(grid):
            place = np.searchsorted(grid, variables[:, k] * (1 - SNAP))[:, None] + steps[None, :, k]
            low[:, k] = high[:, k] = grid[np.clip(place, 0, len(grid) - 1)].ravel()
    return low, high, np.repeat(np.arange(len(variables)), count)


def spread_choice(along: np.ndarray, space: np.ndarray, count: int) -> np.ndarray:
    """Return positions of boxes with much room, spread along an objective."""
    if len(space) <= count:
        return np.arange(len(space))
    order = np.argsort(along, kind="stable")
    groups = np.array_split(order, count)
    return np.array([g[int(np.argmax(space[g]))] for g in groups])


def proven_slack(form: Formulation, purpose: Cover, open_boxes: Boxes) -> float:
    """Return the multiple of the slack at which the known designs cover all open boxes; infinite if none does."""
    columns, worst = purpose.columns, 0.0
    known = purpose.known.phi[:, columns] / purpose.slack
    if not len(known):
        return np.inf
    for first in range(0, len(open_boxes), 1024):
        lower = form.phi_of(open_boxes.bounds[first : first + 1024])[:, columns] / purpose.slack
        worst = max(worst, float(np.max(known[None, :, :] - lower[:, None, :], axis=2).min(axis=1).max()))
    return worst
