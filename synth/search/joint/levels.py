"""Levels: the best in the second of two objectives while the first is capped, at many cutoffs as one tree.

A question with a cutoff is one more question, so that the levels of one front are a joint search. A box from which both
objectives could still be good has no cap; with the first objective capped outright there is no such box.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from synth.bounds.branching import BranchingStatistics
from synth.order.pareto import spread_subset
from synth.search.archive import Archive, Candidate
from synth.search.budget import Clock
from synth.search.joint.joint_optima import JointOptima, JointTree, Needs, QuestionLike, SharedBounds
from synth.search.proven_gap import Level, lowest
from synth.search.settings import SearchEffort
from synth.search.turns import TurnBudget, alternate

CAPPED, SOUGHT = 0, 1


@dataclass(frozen=True, kw_only=True)
class Cutoffs:
    """Epsilon levels: cutoffs of the first objective, each with one of the second.

    Parameters
    ----------
    first : array (levels,)
        phi that a design must keep; no two are the same.
    to_beat : array (levels,)
        phi of the second objective; infinite where nothing is.
    tolerance : float
        In phi of the second objective: by how much a design must be better to count.
    above : array (levels,), optional
        phi of the first objective that a level searches above; by default everything within its cutoff.
    follows : array of bool (levels,), optional
        Whether what lies no higher is searched by the level before, which is to beat no less; otherwise it is proven
        elsewhere that nothing there beats what the level is to beat.
    """

    first: np.ndarray
    to_beat: np.ndarray
    tolerance: float
    above: np.ndarray | None = None
    follows: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.first)

    def distinct(self) -> Cutoffs:
        """Distinct cutoffs, each with the largest value to beat."""
        first, places = np.unique(self.first, return_inverse=True)
        to_beat = np.full(len(first), -np.inf)
        np.maximum.at(to_beat, places, self.to_beat)
        return Cutoffs(first=first, to_beat=to_beat, tolerance=self.tolerance)

    def side_by_side(self, excluded: np.ndarray, width: float) -> Cutoffs:
        """Return the same where levels, which are in order, do not search what others tell of.

        Parameters
        ----------
        excluded : array (levels,)
            phi of the first objective within which it is proven that nothing beats what a level is to beat; -infinity
            where it is of nothing.
        width : float
            In phi: levels search at least so much below their cutoffs.
        """
        before = np.concatenate([[-np.inf], self.first[:-1]])
        follows = np.concatenate([[False], self.to_beat[1:] <= self.to_beat[:-1]]) & (before > excluded)
        above = np.minimum(np.where(follows, before, excluded), self.first - width)
        return replace(self, above=above, follows=follows)


class LevelTree:
    """One tree over all levels, by one way of bounding."""

    def __init__(self, proof: LevelProof, tree: JointTree) -> None:
        self.proof, self.tree = proof, tree

    def corners(self, levels: Iterable[int]) -> dict[int, np.ndarray | None]:
        """Lower bounds (phi) of the relevant unresolved boxes per level."""
        form, questions = self.tree.form, self.tree.form.boxes.cells.trees[0]
        boxes = self.proof.clock.open_of(self.tree.unresolved, self.tree.under_way)
        phi = form.objectives.phi_of(boxes.bounds)[:, : SOUGHT + 1]
        result: dict[int, np.ndarray | None] = {}
        for level in levels:
            holding = np.array([level in questions.rows(k) for k in range(len(questions))])
            result[level] = lowest(phi[holding[boxes.cell[:, 0]]])
        return result

    @property
    def extent(self) -> float:
        """Share of the root box that is unresolved; 0 where all levels are proven."""
        return self.tree.form.boxes.extent(self.tree.unresolved) if self.proof.unproven.any() else 0.0

    def finish(self, effort: SearchEffort) -> bool:
        """Continue best first; True if time ran out."""
        unproven, spent = self.tree.finish(self.proof.unproven, effort)
        self.proof.unproven &= unproven
        return spent

    def go_on(self, boxes: float, most: float) -> int:
        """Look into so many boxes for each level that is open, at most so many in all; return how many it were."""
        proof, counters = self.proof, self.tree.form.counters
        before = counters.contracted
        boxes = min(boxes * int(proof.unproven.sum()), most)
        proof.unproven &= self.tree.open_questions(proof.unproven, boxes)
        return counters.contracted - before


class LevelProof:
    """The search for the best design of each level, and its proof.

    Parameters
    ----------
    task : QuestionLike
        The question, of two objectives.
    shared : SharedBounds
        Of the question.
    clock : Clock
    cutoffs : Cutoffs
    """

    def __init__(self, task: QuestionLike, shared: SharedBounds, clock: Clock, cutoffs: Cutoffs) -> None:
        self.cutoffs, self.clock = cutoffs, clock
        # Settling ties may make a proven design worse by so much; the proof is as much finer.
        self.rounding = task.tuning.tolerances.rounded
        needs = Needs(to_beat=cutoffs.to_beat, tolerance=cutoffs.tolerance - self.rounding)
        capped, floors = {CAPPED: shared.objectives.signed(CAPPED, cutoffs.first)}, {}
        if cutoffs.above is not None:
            # Levels overlap by what a design may miss its cutoff.
            above = cutoffs.above - task.tuning.tolerances.tie
            floors = {CAPPED: np.where(np.isinf(above), -np.inf, shared.objectives.signed(CAPPED, above))}
        self.search = JointOptima([task] * len(cutoffs), clock, shared, SOUGHT, capped, needs, floors)
        self.unproven = self.search.distinct()
        self.known_before: set[bytes] = set()
        self.trees: list[LevelTree] = []

    def begin_with(self, known: Archive, learned: BranchingStatistics | None = None) -> None:
        """Start from known designs at every level that they keep, and from learned branching weights."""
        search, levels = self.search, np.arange(len(self.cutoffs))
        rows = np.tile(np.arange(len(known)), len(levels))
        every = search.instance.combinations.joined(np.repeat(levels, len(known)), known.combination[rows])
        search.known.add(every, known.variables[rows], known.phi[rows])
        most = search.tuning.heuristics.primal.families
        if len(known):
            chosen = spread_subset(known.phi[:, : SOUGHT + 1], most).tolist()
            search.heuristics.starts = {int(known.combination[k]): known.variables[k] for k in chosen}
        self.known_before = {x.tobytes() for x in known.phi}
        if learned is not None:
            search.form.bounding.branching.adopt(learned)

    def learned(self) -> BranchingStatistics:
        """Branching knowledge learned from solved problems."""
        return self.search.form.bounding.branching.statistics()

    def try_known(self) -> None:
        """Try the parts of the designs known at all levels: what is solved tells where boxes are worth splitting."""
        search = self.search
        search.heuristics.warm_start(search.rule(self.unproven))

    def sweep(self) -> None:
        """Run the heuristics on the unproven levels."""
        search = self.search
        search.pool = search.everything(search.form)
        if len(search.pool) and self.unproven.any():
            search.heuristics.first(search.rule(self.unproven), search.pool)

    def new_designs(self) -> list[Candidate]:
        """New best designs of the levels."""
        number_of = self.search.instance.combinations.own
        new = [c for c in self.search.known if c.phi.tobytes() not in self.known_before]
        return [Candidate(number_of(c.combination), c.variables, c.phi) for c in new]

    def prove_soon(self, budget: TurnBudget, first: float) -> None:
        """Search by turns, and solve no combination but those of boxes; as for :meth:`prove`."""
        self._prove(budget, first, lambda: None)

    def prove(self, budget: TurnBudget, first: float) -> None:
        """Prove the levels by alternating trees; plain boxes begin.

        Parameters
        ----------
        budget : TurnBudget
        first : float
            Boxes of the first turns, per level.
        """
        self._prove(budget, first, self._sweep_unproven)

    def _prove(self, budget: TurnBudget, first: float, between: Callable[[], None]) -> None:
        search = self.search
        search.pool = search.everything(search.form)
        if not len(search.pool):
            self.unproven[:] = False
            return
        ways = (
            lambda: self._begun(JointTree(search, search.form, search.known, search.pool)),
            lambda: self._begun(search.in_infeasibility_mode()),
        )
        alternate(ways, budget, first, between)

    def levels(self, only_proven: bool = False) -> list[Level]:
        """Proven bound of each level; those of unproven levels follow from their unresolved boxes.

        ``only_proven``: only of levels that are proven, which spares those bounds.
        """
        best = np.minimum(self.search.known.best(), self.cutoffs.to_beat) + self.rounding
        apart = np.flatnonzero(self.search.distinct()).tolist()
        result: list[Level] = []
        unproven, closed = [k for k in apart if self.unproven[k]], np.empty((0, 2))
        # Where no tree has begun nothing is known of what is open.
        still_open = [] if only_proven else [t.corners(unproven) for t in self.trees]
        for still in still_open or [dict.fromkeys(unproven)]:
            corners = {k: still.get(k) if self.unproven[k] else closed for k in apart}
            result += levels_of_corners(self.cutoffs, best, corners)
        proven = {float(level.within[CAPPED]): level for level in result if not len(level.corners)}
        return [*proven.values(), *(level for level in result if len(level.corners))]

    def combination_of(self, combination: int) -> int:
        """Number of a combination within the question."""
        return self.search.instance.combinations.own(combination)

    def open_combinations(self, most: int) -> np.ndarray:
        """Combinations of the question in unresolved boxes of the last tree, ``most`` at most."""
        tree, codec = self.trees[-1].tree, self.search.instance.combinations
        return np.unique(codec.own(tree.form.boxes.cells.all_members(tree.unresolved.cell, most)))

    @property
    def open_boxes(self) -> int:
        """Number of unresolved boxes of the last tree."""
        return len(self.trees[-1].tree.unresolved)

    def _begun(self, tree: JointTree) -> LevelTree:
        self.trees.append(LevelTree(self, tree))
        return self.trees[-1]

    def _sweep_unproven(self) -> None:
        """Run the heuristics on the unproven levels between the steps of a proof."""
        self.search.heuristics.thorough = True
        self.search.heuristics.improve(self.search.rule(self.unproven))


def levels_of_corners(cutoffs: Cutoffs, best: np.ndarray, corners: Mapping[int, np.ndarray | None]) -> list[Level]:
    """Levels with the lower bounds of their unresolved boxes.

    A level that follows another one says what both say: nothing in either range is better than the least of both, but
    for what is open in either.

    Parameters
    ----------
    cutoffs : Cutoffs
    best : array (levels,)
        phi of the second objective that nothing beats by more than the tolerance, but for what is open.
    corners : dict of int to array (boxes, 2) or None
        Per level, in order: lower bounds of phi of its unresolved boxes; None where all may be unresolved.
    """
    result: list[Level] = []
    least, held = np.inf, list[np.ndarray | None]()
    for k, lower in corners.items():
        if cutoffs.follows is None or not cutoffs.follows[k]:
            least, held = np.inf, []
        least, held = min(least, float(best[k])), [*held, lower]
        known = [x for x in held if x is not None and len(x)]
        if not any(x is None for x in held):
            within, tolerance = np.array([cutoffs.first[k], np.inf]), np.array([0.0, cutoffs.tolerance])
            both = known[0] if len(known) == 1 else lowest(np.concatenate([np.empty((0, 2)), *known]))
            result.append(Level(within, SOUGHT, least, tolerance, both))
    return result
