"""Pruning rules: when a box is of no use, because known designs cover it or because it improves on no listed one."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from synth.bounds.boxes import Boxes
from synth.bounds.kernel_subtrees import CutoffTables
from synth.search.archive import Archive, Candidate
from synth.search.dominance import SortedPoints, sorted_points
from synth.search.dominance_code import dominance_code
from synth.search.formulation import Formulation


class PruningRule(Protocol):
    """Says when a box is of no use, and which designs would still be of use."""

    columns: list[int]
    tolerance: np.ndarray
    fixed_cutoffs: np.ndarray
    proves: bool  # designs that have been looked for, so that hardly any better ones are left

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to be of use.

        ``cell`` (boxes, factors) tells which combinations a box holds; only in a joint search
        of several questions does it matter.
        """

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible gain of a box over what is needed: the least distance to a cutoff, 0 if it cannot improve."""

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return the designs that are best, where there is one objective: they are made as good as they can be."""

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many were of use."""


class TabledPruningRule(PruningRule, Protocol):
    """A rule whose cutoffs the kernel may read from tables."""

    def tables(self, form: Formulation) -> CutoffTables | None:
        """Tables for :meth:`cutoffs` and :meth:`possible_gain`; None where there are none."""


class EpsilonCover:
    """Cover everything: for each possible design a known one that is at most the tolerance worse in every objective.

    Parameters
    ----------
    columns : list of int
        Numbers of the objectives that are traded off; one of them: its best design is sought.
    tolerance : array (columns,)
        In phi.
    fixed_cutoffs : array (objectives,)
        Cutoffs of phi that every design must keep; infinite where there is none.
    known : Archive
        Designs known, no one better than another in all the objectives traded.
    """

    proves = False

    def __init__(
        self, columns: Sequence[int], tolerance: np.ndarray, fixed_cutoffs: np.ndarray, known: Archive
    ) -> None:
        self.columns, self.tolerance, self.fixed_cutoffs, self.known = list(columns), tolerance, fixed_cutoffs, known
        self.tie = known.tuning.tolerances.tie

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Cutoffs of an improving design, per box with these lower bounds of phi."""
        cutoffs = np.tile(self.fixed_cutoffs[: lower.shape[1]] + self.tie, (len(lower), 1))
        known = self.known.cutoffs(lower[:, self.columns], self.tolerance)
        cutoffs[:, self.columns] = np.minimum(cutoffs[:, self.columns], known)
        return cutoffs

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible gain of a box over the designs known."""
        if not len(lower):
            return np.empty(0)
        with np.errstate(all="ignore"):
            distance = self.known.cutoffs(lower[:, self.columns], self.tolerance) - lower[:, self.columns]
            result = np.where(np.isnan(distance), np.inf, distance).min(axis=1)
            broken = np.any(lower > self.fixed_cutoffs[: lower.shape[1]] + self.tie, axis=1)
        return np.where(broken, 0.0, result)

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many no known one covered."""
        keep = np.all(phi <= self.fixed_cutoffs + self.tie, axis=1)
        combinations, variables, phi = combinations[keep], variables[keep], phi[keep]
        new = int((self.possible_gain(phi) > 0).sum())
        self.known.add(combinations, variables, phi)
        return new

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return the best design of an archive in the one objective."""
        allowed = np.flatnonzero(np.all(archive.phi <= self.fixed_cutoffs + self.tie, axis=1))
        k = self.columns[0]
        return [archive[int(allowed[np.argmin(archive.phi[allowed, k])])]] if len(allowed) else []

    def tables(self, form: Formulation) -> CutoffTables | None:
        """Tables of the cutoffs, for one objective or two."""
        columns, bounded = self.columns, form.bounded
        if reaches_beyond(self, bounded) or len(columns) > 2:
            return None
        fixed_cutoffs = self.fixed_cutoffs[:bounded] + self.tie
        if len(columns) == 1:
            least = (self.known.phi[:, columns[0]] - self.tolerance[0]).min(initial=np.inf)
            fixed_cutoffs[columns[0]] = min(fixed_cutoffs[columns[0]], least)
        known = _covered_from(form, self.known, self.tolerance) if len(columns) == 2 else ()
        return CutoffTables(columns, form.objectives.values_of(fixed_cutoffs), known=known)


class NonImprovement:
    """Prove some designs: nothing is better than one of them by more than the tolerance in every objective.

    Those that are best in one objective are proven in that objective alone. A design that is beaten is replaced.
    What a known design covers can beat none of them either, as no known design dominates one of them: this settles
    boxes that miss a step by no more than limits are loosened.

    Parameters
    ----------
    designs : list of Candidate
        None of them dominated by a known one.
    columns : list of int
        Numbers of the objectives.
    tolerance : array (columns,)
        In phi.
    known : Archive
    proven : set of bytes
        phi of designs that need no proof any more.
    """

    proves = True

    def __init__(
        self,
        designs: Sequence[Candidate],
        columns: Sequence[int],
        tolerance: np.ndarray,
        known: Archive,
        proven: Collection[bytes] = (),
    ) -> None:
        self.designs, self.columns, self.tolerance, self.known = list(designs), list(columns), tolerance, known
        self.fixed_cutoffs, self.tie = np.full(known.phi.shape[1], np.inf), known.tuning.tolerances.tie
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
            rows = np.flatnonzero(beating(known, c.phi[self.columns], self.tie))
            result.append(self.known[int(rows[0])] if len(rows) else c)
        return result

    def renew(self, sought: int) -> None:
        """Exchange designs that a known one beats for the best of these in one objective; likewise the ends.

        A design so stays where it is on the front: what beats it by most may beat many others.
        """
        known = self.known.phi[:, self.columns]
        for j, c in enumerate(self.designs):
            rows = np.flatnonzero(beating(known, c.phi[self.columns], self.tie))
            if len(rows):
                self.designs[j] = self.known[int(rows[np.argmin(known[rows, sought])])]
        for k, best in enumerate(np.argmin(known, axis=0).tolist()):
            j = int(np.argmin([c.phi[self.columns[k]] for c in self.designs]))
            if known[best, k] < self.designs[j].phi[self.columns[k]]:
                self.designs[j] = self.known[best]
        self._set()

    def _set(self) -> None:
        phi = np.array([c.phi[self.columns] for c in self.designs])
        steps = [phi[[c.phi.tobytes() not in self._proven for c in self.designs]] - self.tolerance]
        for k in range(len(self.columns)):
            row = np.full((1, len(self.columns)), np.inf)
            row[0, k] = phi[:, k].min() - self.tolerance[k]
            steps.append(row)
        self.steps = np.concatenate(steps)
        self._sorted_steps: SortedPoints | None = None

    def cutoffs(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Cutoffs of a design that dominates one of the designs, per box with these lower bounds of phi."""
        cutoffs = np.full(lower.shape, np.inf)
        corner = lower[:, self.columns]
        below = self._below_two(corner) if len(self.columns) == 2 else self._below(corner)
        # Of what is below no step nothing is of use, whatever is known.
        below_any = np.flatnonzero(below[:, 0] > -np.inf)
        below[below_any] = np.minimum(below[below_any], self.known.cutoffs(corner[below_any], self.tolerance))
        cutoffs[:, self.columns] = below
        return cutoffs

    def possible_gain(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Possible distance of a box below one of the designs."""
        corner = lower[:, self.columns]
        with np.errstate(all="ignore"):
            distance = (self.cutoffs(lower)[:, self.columns] - corner).min(axis=1, initial=np.inf)
        gain: np.ndarray = np.maximum(distance, 0.0)
        return gain

    def _below(self, corner: np.ndarray) -> np.ndarray:
        """Largest step in each objective, per box, among those that the box could be below."""
        if corner.shape[1] == 1:
            return np.where(corner < self.steps.max(), self.steps.max(), -np.inf)
        if self._sorted_steps is None:
            self._sorted_steps = sorted_points(-self.steps, self.known.tuning.dominance, strict=True)
        # The largest step above a box in all other objectives; where it is not above it in its own, none is in all.
        largest = -self._sorted_steps.least(-corner, dominance_code())
        return np.where(corner < largest, largest, -np.inf)

    def _below_two(self, corner: np.ndarray) -> np.ndarray:
        """:meth:`_below` for two objectives: steps in order of the first fall in the second."""
        first, highest = self._in_order()
        from_here = np.searchsorted(first, corner[:, 0], side="right")  # steps above the box in the first objective
        up_to = len(first) - np.searchsorted(highest[::-1], corner[:, 1], side="right")  # ... and in the second
        alive = from_here < up_to
        last = np.minimum(up_to, len(first)) - 1
        result = np.full(corner.shape, -np.inf)
        result[alive, 0] = first[last[alive]]
        result[alive, 1] = highest[from_here[alive]]
        return result

    def _in_order(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the steps of two objectives in order, and the largest second among each and all later ones."""
        steps = self.steps[np.argsort(self.steps[:, 0], kind="stable")]
        return steps[:, 0], np.maximum.accumulate(steps[::-1, 1])[::-1]

    def tables(self, form: Formulation) -> CutoffTables | None:
        """Tables of the cutoffs, for two objectives."""
        columns = self.columns
        if reaches_beyond(self, form.bounded) or len(columns) != 2:
            return None
        (first, highest), known = self._in_order(), _covered_from(form, self.known, self.tolerance)
        steps = form.objectives.signed(columns[0], first), form.objectives.signed(columns[1], highest)
        return CutoffTables(columns, np.full(form.bounded, np.inf), known=known, steps=steps)

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Replace dominated designs; return how many were."""
        new = phi[:, self.columns]
        least = np.array([c.phi[self.columns] for c in self.designs])
        beats = beating(new[:, None, :], least[None, :, :], self.tie)
        worth = np.where(beats, (new / self.tolerance).sum(axis=1)[:, None], np.inf)
        for k, j in enumerate(np.argmin(least, axis=0)):
            lower = new[:, k] < least[j, k] - self.tolerance[k]
            if lower.any():
                worth[:, j] = np.where(lower, new[:, k], np.inf)
        beaten = np.flatnonzero(np.isfinite(worth).any(axis=0))
        for j in beaten:
            row = int(np.argmin(worth[:, j]))
            self.designs[j] = Candidate(int(combinations[row]), variables[row].copy(), phi[row])
        if len(beaten):
            self._set()
        return len(beaten)

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return nothing: designs that are proven in several objectives at once have no single best one."""
        return []


def beating(rows: np.ndarray, phi: np.ndarray, tie: float) -> np.ndarray:
    """Mask of rows (..., objectives) that are as good as phi in all, and better in one by more than rounding."""
    better: np.ndarray = np.all(rows <= phi, axis=-1) & np.any(rows < phi - tie, axis=-1)
    return better


def _covered_from(
    form: Formulation, known: Archive, tolerance: np.ndarray
) -> tuple[tuple[np.ndarray, np.ndarray], ...]:
    """Region that designs cover of two objectives, in signed values."""
    pairs = zip((0, 1), known.covering(tolerance), strict=True)
    first, second = known.columns
    return tuple(
        (form.objectives.signed((second, first)[k], at), form.objectives.signed((first, second)[k], least))
        for k, (at, least) in pairs
    )


def of_use(form: Formulation, rule: PruningRule, boxes: Boxes, every_goal: bool = False) -> Boxes:
    """Tighten boxes by what a design must keep to be of use; return those that may hold one.

    Parameters
    ----------
    form : Formulation
    rule : PruningRule
    boxes : Boxes
    every_goal : bool
        Whether objectives count that only settle ties.
    """
    cutoffs = rule.cutoffs(form.objectives.phi_of(boxes.bounds), boxes.cell)
    boxes = form.boxes.contract(boxes, cutoffs, every_goal=every_goal)
    return boxes.take(rule.possible_gain(form.objectives.phi_of(boxes.bounds), boxes.cell) > 0)


def rows_of_use(form: Formulation, rule: PruningRule, combinations: np.ndarray) -> np.ndarray:
    """Return the rows of combinations in which bounds leave room for a design of use.

    That takes a fiftieth of the time of solving for one.
    """
    boxes = form.boxes.leaves(combinations)
    boxes = replace(boxes, tag=np.arange(len(boxes), dtype=np.int32))
    for _ in range(2):  # what a box must keep is known once its objectives are bounded
        boxes = of_use(form, rule, boxes)
    return boxes.tag


def reaches_beyond(rule: PruningRule, bounded: int) -> bool:
    """True if a search speaks of more than the first objectives."""
    return max(rule.columns) >= bounded or bool(np.any(np.isfinite(rule.fixed_cutoffs[bounded:])))
