"""What is best in one objective, by turns of plain boxes and of boxes that carry what limits share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from synth.bounds.boxes import Boxes
from synth.search.best_first import best_first
from synth.search.branch_and_bound import TreeOutcome, branch_and_bound, cover_of_one
from synth.search.formulation import Formulation
from synth.search.front_state import FrontState
from synth.search.proven_gap import Level, lowest
from synth.search.settings import SearchEffort
from synth.search.turns import TurnBudget, by_turns


class BestTree:
    """A tree for what is best in one objective, by one way of bounding.

    Parameters
    ----------
    state : FrontState
    form : Formulation
    left : Boxes
        Everything that may be feasible, but for what is proven.
    k : int
        Number of the objective.
    tolerance : float
        In phi.
    """

    def __init__(self, state: FrontState, form: Formulation, left: Boxes, k: int, tolerance: float) -> None:
        self.state, self.form, self.left, self.k, self.under_way = state, form, left, k, False
        no_cutoffs = np.full(len(form.goals), np.inf)
        self.rule = cover_of_one(form, k, tolerance, no_cutoffs)

    @property
    def extent(self) -> float:
        """How much of everything its open boxes hold."""
        return self.form.boxes.extent(self.left)

    def go_on(self, boxes: float, most: float) -> int:
        """Look into so many boxes; return how many were looked into."""
        state, known = self.state, self.state.form.archive
        self.form.archive.add(known.combination, known.variables, known.phi)
        # Where there is but one objective, what a tree leaves open speaks of all designs.
        state.begin_tree(self.rule.tolerance if state.task.m == 1 else None)
        looked = self._after(
            lambda: branch_and_bound(self.form, self.left, self.rule, state.clock, state.rng, min(boxes, most))
        ).looked
        state.end_tree()
        return looked

    def finish(self, effort: SearchEffort) -> bool:
        """Go on, what promises most first; tell whether its time was over."""
        clock, rng = self.state.clock, self.state.rng
        return self._after(lambda: best_first(self.form, self.left, self.rule, clock, rng, effort)).spent

    def _after(self, go_on: Callable[[], TreeOutcome]) -> TreeOutcome:
        """Let the tree go on with what is known; take what it has found and left open."""
        known, found = self.state.form.archive, self.form.archive
        self.rule.take(known.combination, known.variables, known.phi)
        self.under_way = True
        outcome = go_on()
        self.under_way = False
        self.left = outcome.open
        self.state.counters.nodes += outcome.looked
        known.add(found.combination, found.variables, found.phi)
        return outcome

    @property
    def open_boxes(self) -> int:
        """How many boxes are open."""
        return len(self.left)

    def open_combinations(self, most: int) -> np.ndarray:
        """Return combinations in open boxes, at most so many."""
        return self.form.boxes.cells.all_members(self.left.cell, most)

    def open(self) -> Boxes:
        """Return the boxes that are open: those at hand where it was stopped."""
        return self.state.clock.open_of(self.left, self.under_way)


def prove_end(state: FrontState, k: int, look_harder: Callable[[], None]) -> BestTree | None:
    """Prove what is best in one objective of a front, and note what is proven; designs go into the archive.

    Parameters
    ----------
    state : FrontState
    k : int
        Number of the objective.
    look_harder : callable
        Called where the first boxes have not closed all: with a better design known others may close soon.

    Returns
    -------
    BestTree, optional
        What is left open.
    """
    trees: list[BestTree] = []
    # As for levels: what settling ties may give away is no part of the gap.
    finer = float(state.rule.tolerance[k]) - state.task.tuning.tolerances.rounded

    def plain() -> BestTree:
        trees.append(BestTree(state, state.form, state.pool, k, finer))
        return trees[-1]

    def other() -> BestTree:
        form = state.formulation(not state.infeasibility_mode, state.form)
        form.bounding.branching.adopt(state.form.bounding.branching.statistics())
        trees.append(BestTree(state, form, form.boxes.root(), k, finer))
        return trees[-1]

    state.counters.scalar_problems += 1
    budget, limits = state.turn_budget(), state.task.limits.by_levels
    soon = TurnBudget(min(limits.before_looking_at_one, budget.boxes), replace(budget.effort, seconds=0.0))
    try:
        by_turns((plain, other), soon, limits.first_of_one, lambda: None)
        budget.looked = soon.looked
        if all(len(t.left) for t in trees):
            look_harder()
            begun = tuple(map(_itself, trees)) if len(trees) > 1 else (_itself(trees[0]), other)
            by_turns(begun, budget, limits.first_of_one, lambda: None)
    finally:
        state.budget.take(budget)
        if trees:
            state.proof.levels += _ends(state, k, trees)
    return trees[-1] if all(len(t.left) for t in trees) else None


def _itself(tree: BestTree) -> Callable[[], BestTree]:
    return lambda: tree


def _ends(state: FrontState, k: int, trees: list[BestTree]) -> list[Level]:
    """Bound of an objective from each tree; each of them covers all designs."""
    least = float(state.form.archive.phi[:, k].min(initial=np.inf)) + state.task.tuning.tolerances.rounded
    nowhere, tolerance = np.full(state.task.m, np.inf), state.rule.tolerance
    closed = [t for t in trees if not len(t.left)]
    corners = [t.form.objectives.phi_of(t.open().bounds)[:, : state.task.m] for t in closed[:1] or trees]
    return [Level(nowhere, k, least, tolerance, lowest(own)) for own in corners]


class BestByTurns:
    """Two trees for what is best in one objective, which go on by turns.

    Parameters
    ----------
    state : FrontState
        In infeasibility mode.
    k : int
        Number of the objective.
    plain : tuple
        The formulation for plain boxes, and those that it has left open.
    left : Boxes
        What the formulation of the state has left open.
    tolerance : float
        In phi.
    """

    def __init__(
        self, state: FrontState, k: int, plain: tuple[Formulation, Boxes], left: Boxes, tolerance: float
    ) -> None:
        self.state, self.k, self.looked = state, k, 0
        self.pair = BestTree(state, *plain, k, tolerance), BestTree(state, state.form, left, k, tolerance)
        limits, task = state.task.limits, state.task
        # Combinations that are few are solved one by one instead.
        few = task.instance.combinations.count <= limits.few_combinations
        self.most = limits.boxes if task.thorough and not few else state.node_limit

    @property
    def closed(self) -> bool:
        """Whether either tree has closed everything."""
        return any(not t.open_boxes for t in self.pair)

    def go_on(self, boxes: float) -> None:
        """Look into so many boxes, or as many as are worth it in all."""
        limits = self.state.task.limits
        budget = TurnBudget(min(boxes, self.most - self.looked), replace(limits.further, seconds=0.0))
        if not self.closed and budget.boxes > 0:
            by_turns([lambda: self.pair[0], lambda: self.pair[1]], budget, limits.first_try, lambda: None)
            self.looked += budget.looked

    def left(self) -> Boxes:
        """Unresolved boxes with the weakest bound; the state goes on with its formulation."""
        phi = [t.form.objectives.phi_of(t.left.bounds)[:, self.k].min(initial=np.inf) for t in self.pair]
        most = self.pair[int(np.argmax(phi))]
        if most.form is not self.state.form:
            self.state.go_on_with(most.form)
        return most.left
