"""One question prepared for the search: limits and objectives as rows, boxes, propagation, NLP."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from synth import deadline
from synth.bounds.compiled_subtrees import CapTables
from synth.bounds.propagation import Propagation
from synth.compiled.compilation import NotCompiled, switched_on
from synth.feasibility import TOLERANCE, holds, residual
from synth.margins import above, below
from synth.model.constraint import Goal, NodeConstraint
from synth.model.model import Evaluation
from synth.nlp.batch import BatchNlp, Code, Solutions, Tasks
from synth.nlp.pieces import KinkedNlp, PiecedNlp, Pieces, decisions, sides
from synth.nlp.rows import Rows
from synth.question.instance import Instance
from synth.search.archive import Archive, Candidate, rows_of
from synth.search.boxes import Boxes, Subtrees
from synth.search.refused_cells import RefusedCells
from synth.search.resolution import declared_resolution, goal_scales, slack
from synth.tuning import TUNING, Tuning


class Formulation:
    """A question, ready to be searched.

    Parameters
    ----------
    instance : Instance
    objectives : mapping
        All objectives of interest with their sense: those to trade off first, then those that settle ties.
    traded : int
        How many, from the first, are traded off against each other.
    conflict : bool
        Whether to prepare for proving that limits exclude each other.
    compiled : bool
        Whether code of its own may be compiled for this question.
    alike : int
        How many questions of its kind are asked: code that is compiled serves them all.
    tuning : Tuning
        What the search in it goes by, its heuristics too.
    """

    def __init__(
        self,
        instance: Instance,
        objectives: Mapping[str, str],
        traded: int,
        conflict: bool = False,
        compiled: bool = True,
        alike: int = 1,
        tuning: Tuning = TUNING,
    ) -> None:
        self.instance, self.tuning = instance, tuning
        self.model = model = instance.model
        self.n = len(model.variables)
        self.names = list(objectives)
        self.goals = [
            Goal(model.quantity_node[name], 1 if sense == "min" else -1) for name, sense in objectives.items()
        ]
        self.constraints = instance.constraints
        # All that the search knows of limits is made of these rows, one of each constraint.
        self.cuts = cuts = [NodeConstraint.of(x) for x in self.constraints]
        self.bounds = [cut.bound for cut in cuts]
        # A single objective needs bounds of the next one as well, which settles ties.
        self.bounded = min(max(traded, 2), len(self.goals)) if traded else 0
        self.lower, self.upper = instance.lower, instance.upper
        self.grids = instance.grids()
        self.gridded = np.array([len(g) > 0 for g in self.grids], dtype=bool)
        self.conflict, self.compiled, self.alike = conflict, compiled, alike
        self.immovable = self.unmoved(gridded=False)
        moved = [model.program.dependence([k]) for k in range(self.n)]
        self.seen_by_goal = np.array([[m[g.node] for m in moved] for g in self.goals], dtype=bool)
        self.traded, self.workers = traded, 1
        self._rows: Rows | None = None
        self.propagation = Propagation(instance, cuts, self.goals, self.bounded, conflict, compiled, alike, tuning)
        self._begin()
        self.width = self.propagation.width
        carried = np.zeros(self.width - self.n, dtype=bool)
        self._gridded = np.concatenate([self.gridded, carried])
        self._span = np.concatenate([self.upper - self.lower, np.zeros(len(carried))])
        positive = [g.sign > 0 and self.propagation.surely_positive(g.node) for g in self.goals]
        self.log_goals = np.array(positive, dtype=bool)
        declared = [declared_resolution(model.declaration, name) for name in self.names]
        self.goal_scales, self.finest = goal_scales(self.log_goals, self.propagation.goal_sizes, declared)
        self._kinks = self._open_kinks()
        self._prepare_screen()

    def among(self, instance: Instance) -> Formulation | None:
        """Return the same for some of the questions it was made for, whose numbers lie within those known here.

        As for :meth:`Propagation.among`.
        """
        propagation = self.propagation.among(instance)
        if propagation is None:
            return None
        own = copy.copy(self)
        own.instance, own.propagation = instance, propagation
        own._begin()
        return own

    def _begin(self) -> None:
        """Know no design yet, and count from nothing."""
        self.cells = self.propagation.cells
        self.refused_cells = RefusedCells(self.instance, self.cells)
        self.archive = self.new_archive(range(self.traded))
        self.contracted = 0
        self.nlp_solves = 0
        self.work = 0  # of the solver without code of its own: evaluations times nodes of the program
        self.solved_combinations: set[int] = set()
        self.followers: dict[int, dict[str, dict[str, float]]] = {}  # of each question, by its identity
        self._focused: np.ndarray | None = None
        # By combination and makeable values, where the full tolerance was needed: whether something does without it.
        self.kept_closely: dict[tuple[int, bytes], bool] = {}

    def unmoved(self, gridded: bool) -> np.ndarray:
        """Return which limits no variable moves: of those that may move at all, or only the continuous ones of them.

        That is a matter of the question, its ranges, pins and grids; how narrow a box has become does not count.

        Parameters
        ----------
        gridded : bool
            Whether makeable values count as moving, as if they were continuous.
        """
        free = self.lower < self.upper if gridded else (self.lower < self.upper) & ~self.gridded
        moving = self.model.program.dependence(np.flatnonzero(free).tolist())
        return np.array([not any(moving[k] for k in x.nodes) for x in self.constraints], dtype=bool)

    def new_archive(self, columns: Sequence[int]) -> Archive:
        """Return an archive without designs, in which objectives of these numbers count."""
        return Archive(columns, self.n, len(self.goals), self.tuning)

    # -- boxes ---------------------------------------------------------------------------------

    def combination(self, boxes: Boxes) -> np.ndarray:
        """Return a combination of each box; the only one where its cell is single."""
        return self.cells.combination(boxes.cell)

    def root(self, passes: int = 3) -> Boxes:
        """Return the box of everything, tightened; no box where nothing is feasible."""
        boxes = self._boxes(self.cells.whole())
        if self.propagation.empty or not self.instance.combinations.count:
            return boxes.take(np.zeros(0, dtype=np.int64))
        if self.propagation.compiled_at_once:
            # The code that all other boxes are tightened with: caps of infinity say nothing.
            return self.contract(boxes, np.full(len(self.goals), np.inf), passes)
        return self.contract(boxes, None, passes, every_goal=True)

    def nothing(self) -> Boxes:
        """Return no boxes."""
        return self._boxes(self.cells.whole()).take(slice(0, 0))

    def lean(self, boxes: Boxes) -> Boxes:
        """Return boxes with the bounds of the first objectives alone, which are all that most searches need."""
        return replace(boxes, bounds=np.ascontiguousarray(boxes.bounds[:, : self.bounded]))

    def one(self, box: Boxes) -> Boxes:
        """Return a box with a single combination of its cell (the first)."""
        digits = [tree.first[box.cell[0, f]] for f, tree in enumerate(self.cells.trees)]
        return replace(box, cell=self.cells.leaf_of(digits))

    def leaves(self, combinations: np.ndarray, low: np.ndarray | None = None, high: np.ndarray | None = None) -> Boxes:
        """Return a box per combination, over the whole range of the variables unless ends are given."""
        boxes = self._boxes(self.cell_of(combinations))
        return boxes if low is None or high is None else replace(boxes, low=low, high=high)

    def cell_of(self, combinations: np.ndarray) -> np.ndarray:
        """Return the cell of each combination (combinations, factors)."""
        digits = self.instance.combinations.digits(combinations)
        leaves = [tree.leaf_of_row[d] for tree, d in zip(self.cells.trees, digits, strict=True)]
        return np.stack(leaves, axis=1) if leaves else np.zeros((len(combinations), 0), dtype=np.int32)

    def whole(self, combination: int) -> Boxes:
        """Return the box of one combination over the whole range of the variables."""
        digits = [int(x[0]) for x in self.instance.combinations.digits(np.array([combination]))]
        return self._boxes(self.cells.leaf_of(digits))

    def _boxes(self, cell: np.ndarray) -> Boxes:
        n, m = len(cell), len(self.goals)
        return Boxes(
            cell,
            np.broadcast_to(self.propagation.low, (n, self.width)).copy(),
            np.broadcast_to(self.propagation.high, (n, self.width)).copy(),
            np.full((n, m), -np.inf),
            np.ones((n, self.width + len(self.cells.trees)), dtype=np.float32),
            np.zeros(n, dtype=np.int32),
        )

    def not_refused(self, combinations: np.ndarray, moved: Instance | None = None) -> np.ndarray:
        """Tell which combinations no refusal over several slots forbids; ``moved``: or over one, where it differs."""
        keep, instance, d = np.ones(len(combinations), dtype=bool), moved or self.instance, self.model.declaration
        every = [r for r, kinds in zip(d.refusals, self.model.refusal_kinds, strict=True) if kinds]
        for refusal in instance.joint_refusals if moved is None else every:
            refused = self.model.refused(refusal)
            keep &= ~(np.asarray(refused([None] * self.n + instance.data(combinations))[0]) > 0.5)
        return keep

    def contract(self, boxes: Boxes, caps: np.ndarray | None, passes: int = 2, every_goal: bool = False) -> Boxes:
        """Return what survives of the boxes, tightened and snapped to the grid.

        ``caps`` bound phi: one row for all boxes, or a row per box. ``every_goal``: also those objectives
        that only settle ties.
        """
        if boxes.low.shape[1] < self.width:
            boxes = self._with_pivots(boxes)
        width = boxes.bounds.shape[1]
        if every_goal and width < len(self.goals):
            unknown = np.full((len(boxes), len(self.goals) - width), -np.inf)
            boxes = replace(boxes, bounds=np.concatenate([boxes.bounds, unknown], axis=1))
        at_once = self.tuning.arrays.boxes
        if len(boxes) <= at_once:
            return self._contract(boxes, caps, passes, every_goal) if len(boxes) else boxes
        kept = []
        for first in range(0, len(boxes), at_once):
            deadline.check()
            rows = slice(first, min(first + at_once, len(boxes)))
            own = caps if caps is None or caps.ndim == 1 else caps[rows]
            kept.append(self._contract(boxes.take(rows), own, passes, every_goal))
        return Boxes.joined(kept)

    def grow(self, boxes: Boxes, caps: CapTables, levels: int, passes: int = 2) -> Subtrees | None:
        """Tighten and split boxes, and what comes of them, for some generations; None where no code is compiled.

        The boxes carry their pivots and the bounds of the first objectives alone.
        """
        found = self.propagation.grown(
            boxes.cell,
            boxes.low,
            boxes.high,
            boxes.bounds,
            boxes.tag,
            caps,
            passes,
            levels,
            self.tuning.tolerances.margins,
            self.workers,
        )
        if found is None:
            return None
        self.contracted += found.contracted
        scores = np.ones((len(found.cell), boxes.scores.shape[1]), dtype=np.float32)
        both = Boxes(found.cell, found.low, found.high, found.bounds, scores, found.tag)
        halves, small = both.take(~found.too_small), both.take(found.too_small)
        if self.instance.joint_refusals:
            halves, small = self._without_refused(halves), self._without_refused(small)
        return Subtrees(halves, small, found.contracted)

    def _with_pivots(self, boxes: Boxes) -> Boxes:
        """Return boxes of variables with all that the inner nodes they carry could be."""
        low, high = (
            np.concatenate([ends, np.broadcast_to(known[self.n :], (len(boxes), self.width - self.n))], axis=1)
            for ends, known in ((boxes.low, self.propagation.low), (boxes.high, self.propagation.high))
        )
        return replace(boxes, low=low, high=high)

    def _contract(self, boxes: Boxes, caps: np.ndarray | None, passes: int, every: bool) -> Boxes:
        self.contracted += len(boxes)
        values = None if caps is None else self.values_of(caps)
        packed = self.propagation.packed(
            boxes.cell,
            boxes.low,
            boxes.high,
            boxes.bounds,
            boxes.tag,
            values,
            passes,
            every,
            self.tuning.tolerances.margins,
            self.workers,
        )
        if packed is not None:
            result = Boxes(packed.cell, packed.low, packed.high, packed.bounds, packed.scores, packed.tag)
            return self._without_refused(result) if self.instance.joint_refusals else result
        limits = None if values is None else list(np.moveaxis(values, -1, 0))
        found = self.propagation.run(boxes.cell, boxes.low, boxes.high, limits, passes, every)
        low, high = found.low, found.high
        alive = found.alive & self._snap(low, high)
        bounds = boxes.bounds.copy()
        for j, least in enumerate(found.goals):
            bounds[:, j] = np.fmax(bounds[:, j], least)
        scores = self.propagation.scores(boxes.cell, low, high, found.open, len(found.goals), values)
        result = Boxes(boxes.cell, low, high, bounds, scores, boxes.tag).take(alive)
        return self._without_refused(result) if self.instance.joint_refusals else result

    def _without_refused(self, boxes: Boxes) -> Boxes:
        boxes = boxes.take(self.refused_cells.may_be_allowed(boxes.cell))
        keep = ~self.cells.single(boxes.cell)
        single = ~keep
        keep[single] = self.not_refused(self.combination(boxes.take(single)))
        return boxes.take(keep)

    def _snap(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Move ends of gridded variables onto the grid, in place; tell which boxes hold something makeable."""
        alive = np.ones(len(low), dtype=bool)
        # An active limit loosened by the slack must not cost a grid point or a pinned value.
        n = self.n
        np.maximum(low[:, :n], self.lower, out=low[:, :n])
        np.minimum(high[:, :n], self.upper, out=high[:, :n])
        margins = self.tuning.tolerances.margins
        for k, grid in enumerate(self.grids):
            if len(grid):
                first = np.searchsorted(grid, below(low[:, k], *margins))
                last = np.searchsorted(grid, above(high[:, k], *margins), side="right") - 1
                alive &= first <= last
                low[:, k] = grid[np.minimum(first, len(grid) - 1)]
                high[:, k] = np.maximum(grid[np.maximum(last, 0)], low[:, k])
        alive &= ~np.any(low > above(high, *margins), axis=1)
        np.maximum(high, low, out=high)
        return alive

    def _splittable(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return widths, 0 where a variable cannot be split any more."""
        size = np.maximum(np.abs(low), np.abs(high))
        snap = self.tuning.tolerances.snap
        floor = np.where(self._gridded, snap * size, 1e-7 * np.maximum(size, 1e-9 * self._span))
        width = self.propagation.widths(low, high)
        result: np.ndarray = np.where(high - low > floor, np.maximum(width, 1e-12), 0.0)
        return result

    def split(self, boxes: Boxes) -> tuple[Boxes, Boxes]:
        """Return the halves of all boxes that can be split, and the boxes that are too small to be split."""
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
        rest, whole = boxes.take(small), boxes.take(~small)
        choice = np.argmax(score[~small], axis=1)
        rows = np.arange(len(whole))
        left_cell, right_cell = whole.cell.copy(), whole.cell.copy()
        left_high, right_low = whole.high.copy(), whole.low.copy()
        by_variable = choice < n
        if by_variable.any():
            own, variable = rows[by_variable], choice[by_variable]
            left_end, right_start = self._middle(variable, whole.low[own, variable], whole.high[own, variable])
            left_high[own, variable], right_low[own, variable] = left_end, right_start
        for f, tree in enumerate(self.cells.trees):
            own = rows[choice == n + f]
            if len(own):
                clusters = whole.cell[own, f]
                left_cell[own, f], right_cell[own, f] = tree.left[clusters], tree.right[clusters]
        halves = Boxes.joined(
            [replace(whole, cell=left_cell, high=left_high), replace(whole, cell=right_cell, low=right_low)]
        )
        return halves, rest

    def _middle(self, variable: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        with np.errstate(all="ignore"):
            middle = np.where(low > 0, np.sqrt(low * high), 0.5 * (low + high))
        left, right, margins = middle.copy(), middle.copy(), self.tuning.tolerances.margins
        for k, grid in enumerate(self.grids):
            rows = np.flatnonzero(variable == k)
            if len(grid) and len(rows):
                first = np.searchsorted(grid, below(low[rows], *margins))
                last = np.searchsorted(grid, above(high[rows], *margins), side="right") - 1
                cut = (first + last) // 2
                left[rows], right[rows] = grid[cut], grid[np.minimum(cut + 1, len(grid) - 1)]
        return left, right

    # -- objectives ----------------------------------------------------------------------------

    def values_of(self, phi: np.ndarray) -> np.ndarray:
        """Return signed objective values for phi (..., objectives), all or the first ones."""
        values = np.empty(phi.shape)
        for k in range(phi.shape[-1]):
            values[..., k] = self.signed(k, phi[..., k])
        return values

    def signed(self, k: int, phi: np.ndarray) -> np.ndarray:
        """Return signed values of one objective for its phi."""
        with np.errstate(all="ignore"):
            values: np.ndarray = np.exp(phi) if self.log_goals[k] else phi * self.goal_scales[k]
        return values

    def slack(self, gap: float, sizes: np.ndarray | None = None) -> np.ndarray:
        """Return a gap as a distance in phi, per objective; ``sizes`` in phi where it is no share of the value."""
        return slack(gap, self.log_goals, self.finest, np.ones(len(self.goals)) if sizes is None else sizes)

    def phi_of(self, values: np.ndarray) -> np.ndarray:
        """Return phi for signed objective values (batch, objectives), all or the first ones."""
        phi = np.empty(values.shape)
        with np.errstate(all="ignore"):
            for k in range(values.shape[1]):
                if self.log_goals[k]:
                    np.log(np.maximum(values[:, k], 1e-300), out=phi[:, k])
                else:
                    np.divide(values[:, k], self.goal_scales[k], out=phi[:, k])
        return phi

    # -- points --------------------------------------------------------------------------------

    def evaluate(self, variables: np.ndarray, combinations: np.ndarray) -> Evaluation:
        """Evaluate a batch of designs."""
        return self.instance.evaluate(variables, self.instance.data(np.asarray(combinations)))

    def candidates(self, variables: np.ndarray, combinations: np.ndarray) -> list[Candidate]:
        """Return those of the points that are feasible, and keep them in the archive."""
        rows, phi = self.feasible_rows(variables, combinations)
        found = [Candidate(int(combinations[k]), variables[k].copy(), phi[k]) for k in rows]
        if found:
            self.archive.add(*rows_of(found))
        return found

    def feasible_rows(self, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of the feasible points, and phi of all points.

        The search keeps limits more closely than feasibility asks for, so that designs do not live off the tolerance.
        """
        phi, closely = self._judged(variables, combinations, self._tolerances)
        return np.flatnonzero(closely), phi

    def edge_rows(self, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of the points that are feasible by the full tolerance alone, and phi of all points.

        Where something that moves continuously enters a limit such a point is of use only if nothing near to it keeps
        the limit more closely: ``PrimalHeuristics.on_edge``.
        """
        phi, held = self._judged(variables, combinations, np.full(len(self.cuts), TOLERANCE))
        rows = np.flatnonzero(held)
        closely = np.isin(rows, rows[self.feasible_rows(variables[rows], combinations[rows])[0]])
        return rows[~closely], phi

    def as_they_are(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        """Return designs with phi of their values: those on the edge count as worse while they are compared."""
        if not candidates:
            return []
        combinations, variables, _ = rows_of(candidates)
        _, phi = self.feasible_rows(variables.reshape(len(candidates), self.n), combinations)
        return [replace(c, phi=own) for c, own in zip(candidates, phi, strict=True)]

    def _judged(
        self, variables: np.ndarray, combinations: np.ndarray, tolerances: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return phi of points, and which of them are feasible with these tolerances of the limits."""
        count = len(combinations)
        if not count:
            return np.empty((0, len(self.goals))), np.empty(0, dtype=bool)
        data = self.instance.data(np.asarray(combinations))
        with np.errstate(all="ignore"):
            raw = self._screen([variables[:, k] for k in range(self.n)] + list(data))
            sides = np.empty((len(raw), count))
            for row, x in zip(sides, raw, strict=True):
                row[:] = x
            limits = len(self.cuts)
            phi = self.phi_of((sides[2 * limits :] * self._goal_signs[:, None]).T)
            held = self.void(data, count).T
            for (sense, guard), rows in self._alike.items():
                r = residual(sides[rows], sides[limits + rows], sense, self._scales[rows, None])
                held[rows] |= holds(r, guard, tolerances[rows, None])
        feasible = held.all(axis=0) & np.all(np.isfinite(phi), axis=1) & self.not_refused(combinations)
        feasible &= np.all(variables >= below(self.lower, self.tuning.tolerances.pinned), axis=1)
        return phi, feasible

    def promising(self, variables: Sequence[np.ndarray], combinations: np.ndarray, caps: np.ndarray) -> np.ndarray:
        """Tell which of many points may be feasible and keep caps of phi; ``feasible_rows`` has the last word.

        What many points have in common is computed once for them, so this costs much less than to look at each.

        Parameters
        ----------
        variables, combinations : array per variable, array
            That broadcast to (designs, points of each).
        caps : array (designs, objectives)
            Of the first objectives.
        """
        data = self.instance.data(combinations)
        keep = np.ones(np.broadcast_shapes(combinations.shape, *(x.shape for x in variables)), dtype=bool)
        tie = self.tuning.tolerances.tie
        most = self.values_of(caps + 2 * tie * np.maximum(np.abs(caps), 1.0))
        limits = len(self.cuts)
        with np.errstate(all="ignore"):
            sides = self._screen([*variables, *data])
            for k, sign in enumerate(self._goal_signs[: caps.shape[1]]):
                keep &= sign * sides[2 * limits + k] <= most[:, k, None]
            for j, cut in enumerate(self.cuts):
                value, limit = sides[j], sides[limits + j]
                # Where a limit holds within the tolerance, it does within twice that of its own size, and little more.
                room = 4 * TOLERANCE * np.maximum(np.abs(limit), cut.scale)
                kept = np.True_ if cut.sense == "at_least" else value <= limit + room
                kept = kept if cut.sense == "at_most" else kept & (value >= limit - room)
                for k in self.constraints[j].void_without:
                    kept = kept | np.isnan(np.asarray(data[k], dtype=float))
                keep &= kept
        return keep

    def _prepare_screen(self) -> None:
        """Prepare what tells which of many points are feasible: both sides of all limits, and the objectives."""
        values = [c.value for c in self.cuts]
        bounds = [c.value if c.limit is None else c.limit for c in self.cuts]
        nodes = (*values, *bounds, *(g.node for g in self.goals))
        evaluate = self.model.function(("screen", nodes), lambda: self.model.program.compile(nodes))
        constant = {len(values) + k: c.bound for k, c in enumerate(self.cuts) if c.limit is None}

        def screen(inputs: Sequence[Any]) -> list[Any]:
            return [constant.get(k, x) for k, x in enumerate(evaluate(inputs))]

        self._screen = screen
        self._goal_signs = np.array([float(g.sign) for g in self.goals])
        kinds = [(c.sense, c.guard) for c in self.cuts]
        self._alike = {kind: np.flatnonzero([k == kind for k in kinds]) for kind in dict.fromkeys(kinds)}
        self._scales = np.array([c.scale for c in self.cuts], dtype=float)
        self._tolerances = np.where(self.immovable, TOLERANCE, self.tuning.tolerances.limit)

    def sample(self, boxes: Boxes, rng: np.random.Generator) -> None:
        """Evaluate a random makeable point of a random combination of every box; what is feasible is archived."""
        at_once = self.tuning.arrays.boxes
        for first in range(0, len(boxes), at_once):
            part = boxes.take(slice(first, first + at_once))
            share = rng.random((len(part), self.n))
            combinations = self.cells.combination(self.cells.random_leaves(part.cell, rng))
            self.candidates(self.makeable(self.inside(part, share)), combinations)

    def ends(self, boxes: Boxes) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of the variables of boxes, without those of the inner nodes that they carry."""
        return boxes.low[:, : self.n], boxes.high[:, : self.n]

    def inside(self, boxes: Boxes, share: np.ndarray | float) -> np.ndarray:
        """Return points inside boxes: share 0 is the lower, 1 the upper end; by ratio where positive."""
        low, high = self.ends(boxes)
        with np.errstate(all="ignore"):
            ratio = low * (high / low) ** share
        points: np.ndarray = np.where(low > 0, ratio, low + share * (high - low))
        return points

    def extent(self, boxes: Boxes) -> float:
        """Return how much of everything boxes hold together: combinations times shares of the ranges of variables.

        What is narrower than ``point_share`` of its range counts as that wide, so that one point is not nothing.
        """
        ranged = np.flatnonzero(self._span[: self.n] > 0)
        shares = (boxes.high[:, ranged] - boxes.low[:, ranged]) / self._span[ranged]
        least = self.tuning.tolerances.point_share
        return float(self.cells.size(boxes.cell) @ np.maximum(shares, least).prod(axis=1))

    def makeable(self, variables: np.ndarray) -> np.ndarray:
        """Return points with gridded variables moved to the nearest makeable value."""
        result = variables.copy()
        for k, grid in enumerate(self.grids):
            if len(grid):
                after = np.clip(np.searchsorted(grid, result[:, k]), 1, max(len(grid) - 1, 1))
                before = np.minimum(after - 1, len(grid) - 1)
                after = np.minimum(after, len(grid) - 1)
                nearer = np.abs(grid[after] - result[:, k]) < np.abs(grid[before] - result[:, k])
                result[:, k] = np.where(nearer, grid[after], grid[before])
        return result

    # -- the continuous problem ----------------------------------------------------------------

    def _both_positive(self, cut: NodeConstraint) -> bool:
        positive = self.propagation.surely_positive
        # Where nothing is feasible nothing proves a sign, and logarithms would not exist.
        right = cut.bound > 0 if cut.limit is None else positive(cut.limit)
        return not self.propagation.empty and positive(cut.value) and right

    def rows(self) -> Rows:
        """Return what a solver knows of limits and objectives."""
        if self._rows is None:
            self._rows = Rows(
                cuts=tuple(replace(c, bound=0.0) for c in self.cuts),
                goals=tuple(self.goals),
                log_cuts=tuple(c.sense != "equal" and self._both_positive(c) for c in self.cuts),
                log_goals=tuple(bool(x) for x in self.log_goals),
                log_variables=tuple(bool(x > 0) for x in self.lower),
            )
        return self._rows

    def batch_nlp(self) -> BatchNlp | KinkedNlp:
        """Return the NLP of this question for many designs at once; built once per model and set of rows."""
        try:
            return self._batch_nlp()
        except NotCompiled:
            return self._batch_nlp()  # over arrays: compiled code is switched off now

    def _batch_nlp(self) -> BatchNlp | KinkedNlp:
        rows, kinks, model, nlp = self.rows(), self._kinks, self.model, self.tuning.nlp
        large = self.instance.combinations.count * self.alike >= self.tuning.compiling.combinations
        long = self.work > self.tuning.compiling.work
        code: Code = "arrays" if not switched_on() else "own" if self.compiled and (large or long) else "general"
        # At an optimum on the edge a solver finds no way; a rounded edge leads there, and near to it.
        edge = nlp.edge if self._has_edges(kinks) else 0.0
        first: BatchNlp = model.function(
            ("batch", rows, code, edge, nlp),
            lambda: BatchNlp(model.program, self.n, rows, code, edge, settings=nlp),
        )
        if not kinks:
            return first
        positive = tuple(dict.fromkeys(k for d in kinks for k in sides(model.program, d) if self._positive(k)))

        def made() -> KinkedNlp:
            pieces = Pieces(model.program, self.n, rows, kinks, positive.__contains__)
            # Few problems are solved again where the formulas are solved as they stand.
            return KinkedNlp(first, PiecedNlp(pieces, "general" if code == "own" and not edge else code, nlp))

        kinked: KinkedNlp = model.function(("kinked", rows, code, edge, kinks, positive, nlp), made)
        return kinked

    def _positive(self, node: int | None) -> bool:
        return node is not None and not self.propagation.empty and self.propagation.surely_positive(node)

    def _open_kinks(self) -> tuple[int, ...]:
        """Return the decisions of formulas that may go either way somewhere in the question."""
        program, propagation = self.model.program, self.propagation
        every = decisions(program, self.n, self.rows())
        if propagation.empty:
            return tuple(every)

        def settled(k: int) -> bool:
            a, b = (propagation.range_of(x) if x is not None else (0.0, 0.0) for x in sides(program, k))
            return a[1] < b[0] or b[1] < a[0]

        return tuple(k for k in every if not settled(k))

    def _has_edges(self, kinks: Sequence[int]) -> bool:
        """Tell whether limits or objectives read the larger or smaller of two things that move."""
        moving, nodes = self.model.program.dependence(range(self.n)), self.model.program.nodes
        return any(nodes[k].op in (ca.OP_FMAX, ca.OP_FMIN) and all(moving[a] for a in nodes[k].args) for k in kinks)

    def solve_many(
        self,
        tasks: Tasks,
        combinations: np.ndarray,
        start: np.ndarray,
        low: np.ndarray | None = None,
        high: np.ndarray | None = None,
        skipped: np.ndarray | None = None,
        data: Sequence[Any] | None = None,
        rough: bool = False,
    ) -> Solutions:
        """Solve the continuous problems of many combinations at once, over the whole range unless ends are given.

        ``skipped`` marks limits that are left out; ``data``: in place of that of the question. ``rough``: answers may
        be near optima, where formulas have edges.
        """
        count = len(combinations)
        data = self.instance.data(combinations) if data is None else data
        self.solved_combinations.update(np.unique(combinations).tolist())
        self.nlp_solves += count
        low = np.broadcast_to(self.lower, (count, self.n)) if low is None else low
        high = np.broadcast_to(self.upper, (count, self.n)) if high is None else high
        void = self.void(data, count) if skipped is None else self.void(data, count) | skipped
        start = np.clip(start, low, high)

        def solved() -> Solutions:
            nlp = self.batch_nlp()
            before = nlp.evaluations
            if isinstance(nlp, KinkedNlp):
                found = nlp.solve(tasks, data, start, low, high, self.bounds, void, self.workers, rough)
            else:
                found = nlp.solve(tasks, data, start, low, high, self.bounds, void, self.workers)
            self.work += (nlp.evaluations - before) * len(self.model.program.nodes)
            return found

        try:
            return solved()
        except NotCompiled:
            return solved()  # pieces ask for code of their own; compiled code is switched off now

    def learn(self, tasks: Tasks, found: Solutions, importance: np.ndarray) -> None:
        """Learn from the multipliers of problems solved what is worth splitting; ``importance`` per problem."""
        prices = np.concatenate([found.cut_multipliers, found.goal_multipliers + tasks.weights], axis=1)
        self.propagation.learn(prices[found.converged], importance[found.converged])

    def focus(self) -> None:
        """Split boxes from now on where it matters at the designs known."""
        known = self.archive.phi
        if not len(known) or known is self._focused:
            return
        self._focused = known
        rows = np.unique(np.linspace(0, len(known) - 1, self.tuning.tree.focus).astype(int))
        self.propagation.focus(self.archive.variables[rows], self.archive.combination[rows])

    def void(self, data: Sequence[Any], count: int) -> np.ndarray:
        """Return which limits do not count for which designs (designs, limits): a column has no value."""
        void = np.zeros((count, len(self.cuts)), dtype=bool)
        for j, limit in enumerate(self.constraints):
            if limit.void_without:
                void[:, j] = limit.void(data, (count,))
        return void
