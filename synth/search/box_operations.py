"""What a search does with boxes, thousands at a time: tighten, snap to grids, split, and take points from them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from synth.bounds.bounding import Bounding
from synth.bounds.boxes import Boxes, Subtrees
from synth.bounds.kernel_subtrees import CutoffTables, Growth
from synth.order.margins import above
from synth.search.archive import Archive
from synth.search.counters import SearchCounters
from synth.search.log_objectives import LogObjectives
from synth.search.makeable_values import MakeableValues
from synth.search.refused_cells import RefusedCells, not_refused
from synth.search.settings import TUNING, Tuning
from synth.system import deadline


class BoxOperations:
    """Operations on the boxes of a question.

    A box may carry more than the variables: auxiliary variables, which come after them.

    Parameters
    ----------
    bounding : Bounding
        Bounds of the question and its boxes, and where to split them.
    makeable : MakeableValues
    objectives : LogObjectives
    bounded : int
        How many objectives, from the first, are bounded in every box.
    counters : SearchCounters
        Counts the boxes that are tightened.
    tuning : Tuning
    """

    def __init__(
        self,
        bounding: Bounding,
        makeable: MakeableValues,
        objectives: LogObjectives,
        bounded: int,
        counters: SearchCounters,
        tuning: Tuning = TUNING,
    ) -> None:
        self.bounding, self.makeable, self.objectives, self.bounded = bounding, makeable, objectives, bounded
        self.counters, self.tuning = counters, tuning
        question = bounding.question
        self.instance = instance = question.instance
        self.n, self.goals = len(instance.model.variables), len(question.goals)
        self.cells, self.width = bounding.propagation.cells, question.width
        self.refused_cells = RefusedCells(instance, self.cells, tuning.arrays.pairs)
        auxiliary = np.zeros(self.width - self.n)
        self._gridded = np.concatenate([makeable.gridded, auxiliary]).astype(bool)
        self._span = np.concatenate([instance.ranges.upper - instance.ranges.lower, auxiliary])
        self._focused: np.ndarray | None = None

    # -- boxes of some combinations ----------------------------------------------------------------

    def root(self, passes: int = 3) -> Boxes:
        """Return the box of everything, tightened; no box where nothing is feasible."""
        boxes = self._boxes(self.cells.all_combinations())
        if self.bounding.question.root.empty or not self.instance.combinations.count:
            return boxes.take(np.zeros(0, dtype=np.int64))
        # With the instructions that all other boxes are tightened with: cutoffs of infinity say nothing.
        return self.contract(boxes, np.full(self.goals, np.inf), passes)

    def roots(self, scenarios: int) -> Boxes:
        """Return the box of everything, once for each of the clusters of at most so many scenarios."""
        root, tree = self.root(), self.cells.trees[0]
        waiting, clusters = [0], list[int]()
        while waiting:
            k = waiting.pop()
            if tree.leaf[k] or tree.size[k] <= scenarios:
                clusters.append(k)
            else:
                waiting += [int(tree.right[k]), int(tree.left[k])]
        boxes = root.take(np.zeros(len(clusters) * len(root), dtype=np.int64))
        cell = boxes.cell.copy()
        cell[:, 0] = clusters[: len(boxes)]
        return replace(boxes, cell=cell)

    def nothing(self) -> Boxes:
        """Return no boxes."""
        return self._boxes(self.cells.all_combinations()).take(slice(0, 0))

    def leaves(self, combinations: np.ndarray, low: np.ndarray | None = None, high: np.ndarray | None = None) -> Boxes:
        """A box per combination, over the full range of the variables unless ends are given."""
        boxes = self._boxes(self.cell_of(combinations))
        return boxes if low is None or high is None else replace(boxes, low=low, high=high)

    def box_of(self, combination: int) -> Boxes:
        """Box of one combination over the full range of the variables."""
        digits = [int(x[0]) for x in self.instance.combinations.digits(np.array([combination]))]
        return self._boxes(self.cells.leaf_of(digits))

    def lean(self, boxes: Boxes) -> Boxes:
        """Return boxes with the bounds of the first objectives alone, which are all that most searches need."""
        return replace(boxes, bounds=np.ascontiguousarray(boxes.bounds[:, : self.bounded]))

    def combination(self, boxes: Boxes) -> np.ndarray:
        """Return a combination of each box; the only one where its cell is single."""
        return self.cells.combination(boxes.cell)

    def cell_of(self, combinations: np.ndarray) -> np.ndarray:
        """Return the cell of each combination (combinations, factors)."""
        digits = self.instance.combinations.digits(combinations)
        leaves = [tree.leaf_of_row[d] for tree, d in zip(self.cells.trees, digits, strict=True)]
        return np.stack(leaves, axis=1) if leaves else np.zeros((len(combinations), 0), dtype=np.int32)

    def _boxes(self, cell: np.ndarray) -> Boxes:
        n = len(cell)
        return Boxes(
            cell,
            np.broadcast_to(self.bounding.question.low, (n, self.width)).copy(),
            np.broadcast_to(self.bounding.question.high, (n, self.width)).copy(),
            np.full((n, self.goals), -np.inf),
            np.ones((n, self.width + len(self.cells.trees)), dtype=np.float32),
            np.zeros(n, dtype=np.int32),
        )

    # -- tightening --------------------------------------------------------------------------------

    def contract(
        self, boxes: Boxes, cutoffs: np.ndarray | None, passes: int | None = None, every_goal: bool = False
    ) -> Boxes:
        """Remaining boxes, tightened and snapped to the grid.

        ``cutoffs`` bound phi: one row for all boxes, or a row per box. ``every_goal``: also those objectives
        that only settle ties. ``passes``: sweeps over the formulas, if not as many as usual.
        """
        passes = self.tuning.tree.sweeps if passes is None else passes
        if boxes.low.shape[1] < self.width:
            boxes = self._with_auxiliary(boxes)
        width = boxes.bounds.shape[1]
        if every_goal and width < self.goals:
            unknown = np.full((len(boxes), self.goals - width), -np.inf)
            boxes = replace(boxes, bounds=np.concatenate([boxes.bounds, unknown], axis=1))
        if not len(boxes):
            return boxes
        deadline.check()
        values = None if cutoffs is None else self.objectives.values_of(cutoffs)
        self.counters.contracted += len(boxes)
        contracted = self.bounding.kernel.contract(boxes, values, passes, every_goal)
        if contracted is None:
            contracted = self._over_arrays(boxes, values, passes, every_goal)
        return self._without_refused(contracted)

    def grow(self, boxes: Boxes, cutoffs: CutoffTables, levels: int) -> Growth | None:
        """Begin to tighten and split boxes, and what comes of them; None where there is no kernel.

        That goes on beside whatever is done before the subtrees are asked for, and reads nothing that changes by then.

        Parameters
        ----------
        boxes : Boxes
            With their auxiliary variables and the bounds of the first objectives alone.
        cutoffs : CutoffTables
        levels : int
            Generations.
        """
        growth = self.bounding.kernel.grow(boxes, cutoffs, self.tuning.tree.sweeps, levels)
        return None if growth is None else growth.then(self._allowed)

    def _allowed(self, subtrees: Subtrees) -> Subtrees:
        """Subtrees without refused combinations; counts them."""
        self.counters.contracted += subtrees.looked
        return Subtrees(self._without_refused(subtrees.halves), self._without_refused(subtrees.small), subtrees.looked)

    def _with_auxiliary(self, boxes: Boxes) -> Boxes:
        """Return boxes of variables with all that the auxiliary variables could be."""
        low, high = (
            np.concatenate([ends, np.broadcast_to(known[self.n :], (len(boxes), self.width - self.n))], axis=1)
            for ends, known in ((boxes.low, self.bounding.question.low), (boxes.high, self.bounding.question.high))
        )
        return replace(boxes, low=low, high=high)

    def _over_arrays(self, boxes: Boxes, values: np.ndarray | None, passes: int, every: bool) -> Boxes:
        """Tighten boxes over arrays, so many at a time that arrays stay in the cache."""
        kept, at_once = [], self.tuning.arrays.boxes
        for first in range(0, len(boxes), at_once):
            deadline.check()
            rows = slice(first, first + at_once)
            row_values = values if values is None or values.ndim == 1 else values[rows]
            kept.append(self._propagated(boxes.take(rows), row_values, passes, every))
        return Boxes.joined(kept)

    def _propagated(self, boxes: Boxes, values: np.ndarray | None, passes: int, every: bool) -> Boxes:
        propagated = self.bounding.propagation.run(boxes, values, passes, every)
        low, high = propagated.low, propagated.high
        alive = propagated.alive & self._snap(low, high)
        bounds = boxes.bounds.copy()
        for j, least in enumerate(propagated.goals):
            bounds[:, j] = np.fmax(bounds[:, j], least)
        tightened = replace(boxes, low=low, high=high, bounds=bounds)
        scores = self.bounding.branching.scores(tightened, propagated.undecided, len(propagated.goals), values)
        return replace(tightened, scores=scores).take(alive)

    def _without_refused(self, boxes: Boxes) -> Boxes:
        """Return the boxes that may hold a combination that no refusal over several slots forbids."""
        if not self.instance.selection.joint_refusals:
            return boxes
        boxes = boxes.take(self.refused_cells.may_be_allowed(boxes.cell))
        keep = ~self.cells.single(boxes.cell)
        single = ~keep
        keep[single] = not_refused(self.instance, self.combination(boxes.take(single)))
        return boxes.take(keep)

    def snapped(self, boxes: Boxes) -> Boxes:
        """Return the boxes that hold something makeable, with their ends on the grid."""
        low, high = boxes.low.copy(), boxes.high.copy()
        alive = self._snap(low, high)
        return replace(boxes, low=low, high=high).take(alive)

    def _snap(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Move ends of gridded variables onto the grid, in place; tell which boxes hold something makeable."""
        # An active limit loosened by the margin must not cost a grid point or a pinned value.
        n = self.n
        np.maximum(low[:, :n], self.instance.ranges.lower, out=low[:, :n])
        np.minimum(high[:, :n], self.instance.ranges.upper, out=high[:, :n])
        alive = self.makeable.snap(low, high)
        alive &= ~np.any(low > above(high, *self.tuning.tolerances.margins), axis=1)
        np.maximum(high, low, out=high)
        return alive

    # -- splitting ---------------------------------------------------------------------------------

    def focus(self, known: Archive) -> None:
        """Split boxes from now on where it matters at the designs known."""
        if not len(known) or known.phi is self._focused:
            return
        self._focused = known.phi
        rows = np.unique(np.linspace(0, len(known) - 1, self.tuning.tree.focus).astype(int))
        self.bounding.branching.focus(known.variables[rows], known.combination[rows])

    def split(self, boxes: Boxes) -> tuple[Boxes, Boxes]:
        """Halves of all boxes that can be split, and the boxes that are too small to be split."""
        halves = self.bounding.kernel.split(boxes) if len(boxes) else None
        return self._split(boxes) if halves is None else halves

    def _split(self, boxes: Boxes) -> tuple[Boxes, Boxes]:
        n, count = self.width, len(boxes)
        can = np.zeros((count, n + len(self.cells.trees)), dtype=bool)
        width = self._splittable(boxes.low, boxes.high)
        can[:, :n] = width > 0
        for f, tree in enumerate(self.cells.trees):
            can[:, n + f] = ~tree.leaf[boxes.cell[:, f]]
        score = np.where(can, boxes.scores, -1.0)
        factors = len(self.cells.trees)
        # Where no score tells (nothing depends on the box any more) parts are told apart first, then the widest.
        flat = ~np.any(score > 1e-9, axis=1)
        if flat.any():
            parts = np.full((int(flat.sum()), factors), 1e3)
            score[flat] = np.where(can[flat], np.concatenate([width[flat], parts], axis=1), -1.0)
        small = ~np.any(can, axis=1)
        unsplit, splittable = boxes.take(small), boxes.take(~small)
        return self._halves(splittable, np.argmax(score[~small], axis=1)), unsplit

    def _halves(self, boxes: Boxes, choice: np.ndarray) -> Boxes:
        """Both halves of boxes, each split along the variable or factor of its choice."""
        rows, n = np.arange(len(boxes)), self.width
        first_cell, second_cell = boxes.cell.copy(), boxes.cell.copy()
        first_high, second_low = boxes.high.copy(), boxes.low.copy()
        by_variable = choice < n
        if by_variable.any():
            at, variable = rows[by_variable], choice[by_variable]
            first_end, second_start = self.makeable.middle(variable, boxes.low[at, variable], boxes.high[at, variable])
            first_high[at, variable], second_low[at, variable] = first_end, second_start
        for f, tree in enumerate(self.cells.trees):
            at = rows[choice == n + f]
            if len(at):
                clusters = boxes.cell[at, f]
                first_cell[at, f], second_cell[at, f] = tree.left[clusters], tree.right[clusters]
        return Boxes.joined(
            [replace(boxes, cell=first_cell, high=first_high), replace(boxes, cell=second_cell, low=second_low)]
        )

    def _splittable(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return widths, 0 where a variable cannot be split any more."""
        size = np.maximum(np.abs(low), np.abs(high))
        snap = self.tuning.tolerances.snap
        floor = np.where(self._gridded, snap * size, 1e-7 * np.maximum(size, 1e-9 * self._span))
        width = self.bounding.branching.widths(low, high)
        result: np.ndarray = np.where(high - low > floor, np.maximum(width, 1e-12), 0.0)
        return result

    # -- what boxes hold ---------------------------------------------------------------------------

    def ends(self, boxes: Boxes) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of the variables of boxes, without those of auxiliary variables."""
        return boxes.low[:, : self.n], boxes.high[:, : self.n]

    def inside(self, boxes: Boxes, share: np.ndarray | float) -> np.ndarray:
        """Return points inside boxes: share 0 is the lower, 1 the upper end; by ratio where positive."""
        low, high = self.ends(boxes)
        with np.errstate(all="ignore"):
            ratio = low * (high / low) ** share
        points: np.ndarray = np.where(low > 0, ratio, low + share * (high - low))
        return points

    def extent(self, boxes: Boxes) -> float:
        """Measure of boxes together: combinations times shares of the ranges of variables.

        What is narrower than ``point_share`` of its range counts as that wide, so that one point is not nothing.
        """
        least, shares = self.tuning.tolerances.point_share, np.ones(len(boxes))
        # Variable by variable: boxes are many, and variables few.
        for k in np.flatnonzero(self._span[: self.n] > 0).tolist():
            shares *= np.maximum((boxes.high[:, k] - boxes.low[:, k]) / self._span[k], least)
        # Not as a product of vectors: for one that long the threads of BLAS are woken, and keep cores busy long after.
        return float(np.sum(self.cells.size(boxes.cell) * shares))
