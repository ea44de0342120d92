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
from synth.search.turns import TurnBudget, alternate


class BestTree:
    """A tree for the optimum of one objective, by one way of bounding.

    Parameters
    ----------
    state : FrontState
    form : Formulation
    unresolved : Boxes
        Everything that may be feasible, but for what is proven.
    k : int
        Number of the objective.
    tolerance : float
        In phi.
    """

    def __init__(self, state: FrontState, form: Formulation, unresolved: Boxes, k: int, tolerance: float) -> None:
        self.state, self.form, self.unresolved, self.k, self.under_way = state, form, unresolved, k, False
        no_cutoffs = np.full(len(form.goals), np.inf)
        self.rule = cover_of_one(form, k, tolerance, no_cutoffs)

    @property
    def extent(self) -> float:
        """Share of the root box that is unresolved."""
        return self.form.boxes.extent(self.unresolved)

    def go_on(self, boxes: float, most: float) -> int:
        """Process a number of boxes; return how many were processed."""
        state, known = self.state, self.state.form.archive
        self.form.archive.add(known.combination, known.variables, known.phi)
        # Where there is but one objective, what a tree leaves open speaks of all designs.
        state.begin_tree(self.rule.tolerance if state.task.m == 1 else None)
        looked = self._after(
            lambda: branch_and_bound(self.form, self.unresolved, self.rule, state.clock, state.rng, min(boxes, most))
        ).looked
        state.end_tree()
        return looked

    def finish(self, effort: SearchEffort) -> bool:
        """Continue best first; True if time ran out."""
        clock, rng = self.state.clock, self.state.rng
        return self._after(lambda: best_first(self.form, self.unresolved, self.rule, clock, rng, effort)).spent

    def _after(self, go_on: Callable[[], TreeOutcome]) -> TreeOutcome:
        """Continue the tree with the known designs; keep its new designs and unresolved boxes."""
        known, added = self.state.form.archive, self.form.archive
        self.rule.take(known.combination, known.variables, known.phi)
        self.under_way = True
        outcome = go_on()
        self.under_way = False
        self.unresolved = outcome.open
        self.state.counters.nodes += outcome.looked
        known.add(added.combination, added.variables, added.phi)
        return outcome

    @property
    def open_boxes(self) -> int:
        """Number of unresolved boxes."""
        return len(self.unresolved)

    def open_combinations(self, most: int) -> np.ndarray:
        """Combinations in unresolved boxes, ``most`` at most."""
        return self.form.boxes.cells.all_members(self.unresolved.cell, most)

    def open(self) -> Boxes:
        """Unresolved boxes: those at hand where the tree was stopped."""
        return self.state.clock.open_of(self.unresolved, self.under_way)


def prove_end(state: FrontState, k: int, intensify: Callable[[], None]) -> BestTree | None:
    """Prove the extreme point of a front in one objective, and note the bound; designs go into the archive.

    Parameters
    ----------
    state : FrontState
    k : int
        Number of the objective.
    intensify : callable
        Called where the first boxes have not closed all: with a better design known others may close soon.

    Returns
    -------
    BestTree, optional
        The unresolved tree.
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
        alternate((plain, other), soon, limits.first_of_one, lambda: None)
        budget.looked = soon.looked
        if all(len(t.unresolved) for t in trees):
            intensify()
            begun = tuple(map(_itself, trees)) if len(trees) > 1 else (_itself(trees[0]), other)
            alternate(begun, budget, limits.first_of_one, lambda: None)
    finally:
        state.budget.take(budget)
        if trees:
            state.proof.levels += _ends(state, k, trees)
    return trees[-1] if all(len(t.unresolved) for t in trees) else None


def _itself(tree: BestTree) -> Callable[[], BestTree]:
    return lambda: tree


def _ends(state: FrontState, k: int, trees: list[BestTree]) -> list[Level]:
    """Bound of an objective from each tree; each of them covers all designs."""
    least = float(state.form.archive.phi[:, k].min(initial=np.inf)) + state.task.tuning.tolerances.rounded
    nowhere, tolerance = np.full(state.task.m, np.inf), state.rule.tolerance
    closed = [t for t in trees if not len(t.unresolved)]
    corners = [t.form.objectives.phi_of(t.open().bounds)[:, : state.task.m] for t in closed[:1] or trees]
    return [Level(nowhere, k, least, tolerance, lowest(phi)) for phi in corners]


class BestOfTwoTrees:
    """Two alternating trees for the optimum of one objective.

    Parameters
    ----------
    state : FrontState
        In infeasibility mode.
    k : int
        Number of the objective.
    plain : tuple
        The formulation for plain boxes, and its unresolved boxes.
    unresolved : Boxes
        Unresolved boxes of the formulation of the state.
    tolerance : float
        In phi.
    """

    def __init__(
        self, state: FrontState, k: int, plain: tuple[Formulation, Boxes], unresolved: Boxes, tolerance: float
    ) -> None:
        self.state, self.k, self.looked = state, k, 0
        self.pair = BestTree(state, *plain, k, tolerance), BestTree(state, state.form, unresolved, k, tolerance)
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
            alternate([lambda: self.pair[0], lambda: self.pair[1]], budget, limits.first_try, lambda: None)
            self.looked += budget.looked

    def weakest(self) -> Boxes:
        """Unresolved boxes with the weakest bound; the state goes on with its formulation."""
        phi = [t.form.objectives.phi_of(t.unresolved.bounds)[:, self.k].min(initial=np.inf) for t in self.pair]
        most = self.pair[int(np.argmax(phi))]
        if most.form is not self.state.form:
            self.state.go_on_with(most.form)
        return most.unresolved
