"""Branch and bound, depth first: the tree that proves one best design, or a whole front at once.

Boxes of everything that may be designed are tightened, compared with the designs known, and split, until
every box is empty or *covered*: no design in it could be better than each known design by more than the
tolerance in some objective. What is then known is a front of which no design can be improved by more than the
tolerance in every objective, because whatever improves it would itself be covered by a known design that dominates it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.archive import Candidate, rows_of
from synth.search.box_steps import BoxStep
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.pruning import EpsilonCover, PruningRule, TabledPruningRule, reaches_beyond
from synth.search.relaxed_boxes import RelaxedBoxes


@dataclass(frozen=True)
class TreeOutcome:
    """Unresolved boxes of a tree, the number of boxes processed, and why it stopped.

    ``full``: enough is known; ``spent``: its time was over; ``abandoned``: so much was open that it hardly closes.
    """

    open: Boxes
    looked: int
    full: bool = False
    spent: bool = False
    abandoned: bool = False

    @property
    def closed(self) -> bool:
        """True if everything is covered."""
        return not len(self.open) and not self.full


def branch_and_bound(
    form: Formulation,
    boxes: Boxes,
    rule: TabledPruningRule,
    clock: Clock,
    rng: np.random.Generator,
    node_limit: float = np.inf,
    enough: int | None = None,
    hopeless: Callable[[int, int], bool] = lambda looked, waiting: False,
    together: RelaxedBoxes | None = None,
) -> TreeOutcome:
    """Cover everything that boxes may hold by known designs.

    Parameters
    ----------
    form : Formulation
    boxes : Boxes
        Where to search.
    rule : TabledPruningRule
        Feasible designs go there, and into the archive of the formulation.
    clock : Clock
    rng : Generator
    node_limit : float
        Boxes that may be looked into.
    enough : int, optional
        Stop when more designs than this are known.
    hopeless : callable, optional
        Tells by how many boxes were looked into, and how many are open, whether to give up.
    together : RelaxedBoxes, optional
        Bounds boxes by all limits together as well.

    Returns
    -------
    TreeOutcome
    """
    tree, every = form.tuning.tree, reaches_beyond(rule, form.bounded)
    at_once = tree.batch if together is None else tree.together.at_once
    form.boxes.focus(form.archive)
    heuristics, looked = PrimalHeuristics(form, rule, rng, every), 0
    boxes = boxes if every else form.boxes.lean(boxes)
    nothing = boxes.take(slice(0, 0))
    queue, fresh, stuck, abandoned = nothing, [boxes], nothing, False
    steps: list[BoxStep] = []  # the batch at hand, and the next one, which the kernel is at meanwhile
    try:
        while (steps or len(queue) or fresh) and looked <= node_limit:
            if not steps and not len(queue):
                queue = _most_open(form, _latest(fresh, tree.generation), rule)
                if not len(queue):
                    continue
            opened = [*(s.batch for s in steps), queue, *fresh, stuck]
            clock.check(opened)
            if enough is not None and len(form.archive) > enough:
                return TreeOutcome(Boxes.joined(opened), looked, True)
            if hopeless(looked, sum(len(b) for b in opened)):
                abandoned = True
                break
            while len(queue) and len(steps) < 2 and looked + sum(len(s.batch) for s in steps) <= node_limit:
                batch, queue = queue.take(slice(0, at_once)), queue.take(slice(at_once, None))
                steps.append(BoxStep(form, batch, rule, heuristics, together))
            children, small, seen = steps[0].finish(node_limit - looked)
            del steps[0]
            looked += seen
            if len(small):
                stuck = Boxes.joined([stuck, small])
            if len(children):
                fresh.append(children)
    finally:
        for step in steps:
            step.stop()
    unresolved = Boxes.joined([*(s.batch for s in steps), queue, *fresh, stuck])
    unresolved = unresolved.take(rule.possible_gain(form.objectives.phi_of(unresolved.bounds), unresolved.cell) > 0)
    return TreeOutcome(unresolved, looked, abandoned=abandoned)


def best(
    form: Formulation,
    boxes: Boxes,
    rule: EpsilonCover,
    clock: Clock,
    rng: np.random.Generator,
    start: Candidate | None = None,
    node_limit: float = np.inf,
    hopeless: Callable[[int, int], bool] = lambda looked, waiting: False,
    together: RelaxedBoxes | None = None,
) -> tuple[Candidate | None, TreeOutcome]:
    """Find the least phi of one objective, and prove it within the tolerance of a rule.

    Parameters
    ----------
    form, boxes, clock, rng, node_limit, hopeless, together
        As for :func:`branch_and_bound`. Designs of the archive of the formulation are known already.
    rule : EpsilonCover
        Of one objective, as :func:`cover_of_one` makes it.
    start : Candidate, optional
        Known as well.

    Returns
    -------
    tuple
        The best design, if any is known, and how the search ended.
    """
    if len(form.archive):
        rule.take(form.archive.combination, form.archive.variables, form.archive.phi)
    if start is not None:
        rule.take(*rows_of([start]))
    outcome = branch_and_bound(form, boxes, rule, clock, rng, node_limit, None, hopeless, together)
    return (rule.known[0] if len(rule.known) else None), outcome


def cover_of_one(form: Formulation, column: int, tolerance: float, fixed_cutoffs: np.ndarray) -> EpsilonCover:
    """Return the rule that seeks the best design in one objective, of which none is known yet.

    Parameters
    ----------
    form : Formulation
    column : int
        The number of the objective.
    tolerance : float
        In phi.
    fixed_cutoffs : array (objectives,)
        phi that the design must keep.
    """
    return EpsilonCover([column], np.array([tolerance]), fixed_cutoffs, form.new_archive([column]))


def _latest(fresh: list[Boxes], generation: int) -> Boxes:
    """Take the next generation off the end of a list: the boxes that were split last, so that few wait at a time."""
    parts: list[Boxes] = []
    count = 0
    while fresh and count < generation:
        parts.append(fresh.pop())
        count += len(parts[-1])
    if count > generation:
        fresh.append(parts[-1].take(slice(0, count - generation)))
        parts[-1] = parts[-1].take(slice(count - generation, None))
    return Boxes.joined(parts[::-1])


def _most_open(form: Formulation, waiting: Boxes, rule: PruningRule) -> Boxes:
    """Return boxes with the largest possible gain first; covered ones are dropped."""
    lower = form.objectives.phi_of(waiting.bounds)
    gain = rule.possible_gain(lower, waiting.cell)
    keep = np.flatnonzero(gain > 0)
    # While no design is known, every possible gain is infinite; then low bounds promise most.
    low = lower[:, rule.columns].mean(axis=1)
    key = np.where(np.isfinite(gain), -gain, np.where(np.isfinite(low), low, 0.0) - 1e6)[keep]
    order = keep[np.argsort(key, kind="stable")] if len(keep) > form.tuning.tree.batch else keep
    return waiting.take(order)
