"""Best-first search of the boxes that a first search has left unresolved.

The first search, depth first, takes the boxes that were split last, so that few wait at a time; what it leaves open
tells little. Here the boxes from which a design could gain most are split first, so that the gap that is proven becomes
smaller all the time, whenever it ends.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.box_steps import BoxStep
from synth.search.branch_and_bound import TreeOutcome
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.pruning import PruningRule, TabledPruningRule, reaches_beyond
from synth.search.settings import SearchEffort


@dataclass(frozen=True, kw_only=True)
class Progress:
    """Measure of whether boxes keep closing.

    Parameters
    ----------
    highest : int
        The level of the boxes with the largest possible gain.
    waiting : int
        Boxes that wait.
    extent : float
        How much of everything they hold: it only falls, while their number may stand still for long.
    """

    highest: int
    waiting: int
    extent: float

    def after(self, known: Progress, closing: float) -> Progress | None:
        """Least progress measure so far, where less is unresolved than before; None where nothing has closed.

        Of the extent a share of at least ``closing`` counts. Less than that adds up, because nothing is returned then.
        """
        no_fewer = self.highest >= known.highest and self.waiting >= known.waiting
        if no_fewer and self.extent > (1 - closing) * known.extent:
            return None
        return Progress(
            highest=min(self.highest, known.highest),
            waiting=min(self.waiting, known.waiting),
            extent=min(self.extent, known.extent),
        )


class OpenBoxes:
    """Boxes that wait, in levels of how much better than needed each could be.

    Parameters
    ----------
    form : Formulation
    rule : PruningRule
    most : int
        When more boxes wait, those of the lowest level are taken first.
    """

    def __init__(self, form: Formulation, rule: PruningRule, most: int) -> None:
        self.form, self.rule, self.most, self.tree = form, rule, most, form.tuning.tree
        self.levels: list[list[Boxes]] = [[] for _ in range(self.tree.levels)]
        self.counts = np.zeros(self.tree.levels, dtype=np.int64)

    def __len__(self) -> int:
        return int(self.counts.sum())

    def add(self, boxes: Boxes) -> None:
        """Add boxes; those that cannot improve are dropped."""
        gain = self.rule.possible_gain(self.form.objectives.phi_of(boxes.bounds), boxes.cell)
        useful = gain > 0
        boxes, gain = boxes.take(useful), gain[useful]
        with np.errstate(all="ignore"):
            doublings = np.log2(gain / float(self.rule.tolerance.min()))
        highest = self.tree.levels - 1
        level = np.clip(
            np.nan_to_num(self.tree.levels_per_doubling * doublings, nan=highest, posinf=highest), 0, highest
        )
        level = np.ceil(level).astype(int)
        for k in np.unique(level).tolist():
            entering = boxes.take(level == k)
            self.levels[k].append(entering)
            self.counts[k] += len(entering)
            if len(self.levels[k]) > self.tree.level_batches:
                self.levels[k] = [Boxes.joined(self.levels[k])]

    def next(self) -> Boxes:
        """Pop a batch of the boxes with the largest possible gain; of those with the least where too many wait."""
        filled = np.flatnonzero(self.counts)
        parts, count = list[Boxes](), 0
        for k in (filled if len(self) > self.most else filled[::-1]).tolist():
            level = self.levels[k]
            while level and count < self.tree.batch:
                batch = level.pop()
                if count + len(batch) > self.tree.batch:
                    excess = count + len(batch) - self.tree.batch
                    level.append(batch.take(slice(0, excess)))
                    batch = batch.take(slice(excess, None))
                parts.append(batch)
                count += len(batch)
                self.counts[k] -= len(batch)
        return Boxes.joined(parts)

    @property
    def batches(self) -> list[Boxes]:
        """All waiting boxes."""
        return [b for level in self.levels for b in level]

    def progress(self) -> Progress:
        """Number of unresolved boxes."""
        extent = sum(self.form.boxes.extent(b) for b in self.batches)
        return Progress(highest=self.highest, waiting=len(self), extent=extent)

    @property
    def highest(self) -> int:
        """The level of the boxes with the largest possible gain; -1 where none waits."""
        return int(np.flatnonzero(self.counts).max(initial=-1))


def best_first(
    form: Formulation,
    boxes: Boxes,
    rule: TabledPruningRule,
    clock: Clock,
    rng: np.random.Generator,
    limits: SearchEffort,
    over: Callable[[], bool] | None = None,
) -> TreeOutcome:
    """Go on with boxes that are open until they are closed, no longer close, or the budget of time is spent.

    Parameters
    ----------
    form, boxes, rule, clock, rng
        As for :func:`synth.search.branch_and_bound.branch_and_bound`.
    limits : SearchEffort
    over : callable, optional
        Tells whether the budget is spent; by default it begins with the call.

    Returns
    -------
    TreeOutcome
        ``spent`` where it was the budget that ended it.
    """
    end = time.monotonic() + limits.seconds
    over = (lambda: time.monotonic() > end) if over is None else over
    every = reaches_beyond(rule, form.bounded)
    form.boxes.focus(form.archive)
    heuristics, looked, spent = PrimalHeuristics(form, rule, rng, every), 0, False
    boxes = boxes if every else form.boxes.lean(boxes)
    waiting, stuck = OpenBoxes(form, rule, limits.most_waiting), boxes.take(slice(0, 0))
    waiting.add(boxes)
    least, idle, mark = waiting.progress(), 0, limits.spell
    while len(waiting):
        clock.check([*waiting.batches, stuck])
        if over():
            spent = True
            break
        if looked >= mark:
            mark = looked + limits.spell
            closed = waiting.progress().after(least, limits.closing)
            idle, least = (idle + 1, least) if closed is None else (0, closed)
            if idle >= limits.patience or len(stuck) > limits.most_stuck:
                break
        children, small, seen = BoxStep(form, waiting.next(), rule, heuristics).finish(np.inf)
        looked += seen
        waiting.add(children)
        stuck = Boxes.joined([stuck, small]) if len(small) else stuck
    kept = Boxes.joined([stuck, *waiting.batches])
    return TreeOutcome(
        kept.take(rule.possible_gain(form.objectives.phi_of(kept.bounds), kept.cell) > 0), looked, spent=spent
    )
