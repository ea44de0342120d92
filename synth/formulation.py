"""One question prepared for the search: limits and objectives as rows, boxes, propagation, NLP."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from synth.declaration import Refusal
from synth.feasibility import holds, residual
from synth.instance import Instance
from synth.intervals import Cut, Goal, Propagator
from synth.model import Evaluation
from synth.nlp import ParametricNlp, Rows, Solution, Task
from synth.pareto import non_dominated, spread_subset
from synth.program import Program

CHUNK = 4096
SNAP = 1e-9
PINNED = 1e-12
TIE = 1e-9
# Designs may miss a limit by the tolerance of feasibility; the search does not live off it.
SEARCH_TOLERANCE = 1e-8
CAP_POINTS = 150


@dataclass(frozen=True)
class Boxes:
    """A batch of boxes: the combination of each, its ends, and lower bounds of the objectives.

    ``tag`` tells which of several questions a box belongs to, when they share a batch.
    """

    combination: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounds: np.ndarray
    scores: np.ndarray
    tag: np.ndarray

    def __len__(self) -> int:
        return len(self.combination)

    def take(self, rows: np.ndarray) -> Boxes:
        """Return some of the boxes, by mask or positions."""
        return Boxes(
            self.combination[rows],
            self.low[rows],
            self.high[rows],
            self.bounds[rows],
            self.scores[rows],
            self.tag[rows],
        )

    def tagged(self, tag: int) -> Boxes:
        """Return the same boxes with another tag."""
        return replace(self, tag=np.full(len(self), tag))

    @staticmethod
    def joined(batches: Sequence[Boxes]) -> Boxes:
        """Return several batches as one."""
        return Boxes(
            np.concatenate([b.combination for b in batches]),
            np.concatenate([b.low for b in batches]),
            np.concatenate([b.high for b in batches]),
            np.concatenate([b.bounds for b in batches]),
            np.concatenate([b.scores for b in batches]),
            np.concatenate([b.tag for b in batches]),
        )


@dataclass(frozen=True)
class Candidate:
    """A feasible design the search has found: its combination, SI variables and objectives as phi."""

    combination: int
    variables: np.ndarray
    phi: np.ndarray


class Archive:
    """The feasible designs found so far that no other one dominates in the traded objectives.

    Parameters
    ----------
    traded : int
        How many objectives count for dominance.
    variables, objectives : int
        Width of the stored rows.
    """

    def __init__(self, traded: int, variables: int, objectives: int) -> None:
        self.traded = traded
        self.combination = np.empty(0, dtype=np.int64)
        self.variables = np.empty((0, variables))
        self.phi = np.empty((0, objectives))

    def __len__(self) -> int:
        return len(self.combination)

    def __getitem__(self, k: int) -> Candidate:
        return Candidate(int(self.combination[k]), self.variables[k], self.phi[k])

    def __iter__(self) -> Iterator[Candidate]:
        return (self[k] for k in range(len(self)))

    def add(self, combination: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> None:
        """Take new designs and keep what is not dominated."""
        if not len(combination):
            return
        combination = np.concatenate([self.combination, combination])
        variables = np.concatenate([self.variables, variables])
        phi = np.concatenate([self.phi, phi])
        keep = non_dominated(phi[:, : self.traded])
        self.combination, self.variables, self.phi = combination[keep], variables[keep], phi[keep]

    def caps(self, lower: np.ndarray) -> np.ndarray:
        """Return, per box with lower bounds ``lower`` (boxes, objectives), what a design must keep to be of use.

        Cap k is the least value of objective k among the known designs that beat the box in all other objectives.
        """
        m = self.traded
        result = np.full(lower.shape, np.inf)
        known = self.phi[spread_subset(self.phi[:, :m], CAP_POINTS)][:, :m] if len(self) else self.phi[:, :m]
        for k in range(m if len(known) else 0):
            others = [j for j in range(m) if j != k]
            beaten = np.all(known[None, :, others] <= lower[:, None, others], axis=2)
            result[:, k] = np.where(beaten, known[None, :, k], np.inf).min(axis=1) + TIE
        return result


class Formulation:
    """A question, ready to be searched.

    Parameters
    ----------
    instance : Instance
    objectives : mapping
        All objectives of interest with their sense: those to trade off first, then those that settle ties.
    traded : int
        How many, from the first, are traded off against each other.
    """

    def __init__(self, instance: Instance, objectives: Mapping[str, str], traded: int) -> None:
        self.instance = instance
        self.model = model = instance.model
        self.n = len(model.variables)
        self.names = list(objectives)
        self.goals = [
            Goal(model.quantity_node[name], 1 if sense == "min" else -1) for name, sense in objectives.items()
        ]
        cuts = [Cut(x.sense, *model.limit_nodes[x.name], x.scale, guard=x.guard) for x in model.limits]
        cuts += [Cut(x.sense, model.quantity_node[x.quantity], None, 1e-9, x.limit) for x in instance.extra]
        self.cuts = cuts
        self.bounds = [cut.bound for cut in cuts]
        self.traded = traded
        # Objectives that only settle ties would cost time and mislead the splitting while others are traded off.
        self._traded_only = Propagator(model.program, self.n, cuts, self.goals[:traded])
        self._all_goals = Propagator(model.program, self.n, cuts, self.goals)
        self.lower, self.upper = instance.lower, instance.upper
        self.grids = instance.grids()
        self.gridded = np.array([len(g) > 0 for g in self.grids], dtype=bool)
        self.log_goals = np.zeros(len(self.goals), dtype=bool)
        self.goal_scales = np.ones(len(self.goals))
        self.immovable = self._immovable()
        self.contracted = 0
        self.nlp_solves = 0
        self.solved_combinations: set[int] = set()
        self.archive = Archive(traded, self.n, len(self.goals))
        self._nlp: ParametricNlp | None = None
        self._positive_cuts = np.ones(len(cuts), dtype=bool)
        self._seen_feasible_boxes = False

    def _immovable(self) -> np.ndarray:
        """Return which limits depend on no variable that is free to move."""
        free = [k for k in range(self.n) if self.lower[k] < self.upper[k]]
        moving = self.model.program.dependence(free)
        sides = [[k for k in (c.value, c.limit) if k is not None] for c in self.cuts]
        return np.array([not any(moving[k] for k in nodes) for nodes in sides], dtype=bool)

    # -- boxes ---------------------------------------------------------------------------------

    def root(self, combinations: np.ndarray, passes: int = 3) -> Boxes:
        """Return the boxes of the combinations that no bound excludes, over the whole range of the variables."""
        start = self._start(combinations)
        return self.contract(start.take(self._not_refused(combinations)), None, passes, every_goal=True)

    def whole(self, combination: int) -> Boxes:
        """Return the box of one combination over the whole range of the variables."""
        return self._start(np.array([combination], dtype=np.int64))

    def _start(self, combinations: np.ndarray) -> Boxes:
        n, m = len(combinations), len(self.goals)
        return Boxes(
            combinations,
            np.broadcast_to(self.lower, (n, self.n)),
            np.broadcast_to(self.upper, (n, self.n)),
            np.full((n, m), -np.inf),
            np.zeros((n, self.n)),
            np.zeros(n, dtype=np.int64),
        )

    def _not_refused(self, combinations: np.ndarray) -> np.ndarray:
        keep = np.ones(len(combinations), dtype=bool)
        for refusal in self.instance.joint_refusals:
            refused = self._refusal_function(refusal)
            keep &= ~(np.asarray(refused([None] * self.n + self.instance.data(combinations))[0]) > 0.5)
        return keep

    def _refusal_function(self, refusal: Refusal) -> Any:
        model = self.model
        return model.function(
            ("refusal", id(refusal)), lambda: Program(model.inputs, [refusal.when], model.calls).compile()
        )

    def contract(
        self,
        boxes: Boxes,
        caps: np.ndarray | None,
        passes: int = 3,
        combine: np.ndarray | None = None,
        every_goal: bool = False,
    ) -> Boxes:
        """Return what survives of the boxes, tightened and snapped to the grid.

        ``caps`` bound phi: one row for all boxes, or a row per box. ``combine`` holds multipliers of
        limits and caps (see ``Propagator``). ``every_goal``: also those objectives that only settle ties.
        """
        kept = []
        for first in range(0, len(boxes), CHUNK):
            rows = np.arange(first, min(first + CHUNK, len(boxes)))
            own = caps if caps is None or caps.ndim == 1 else caps[rows]
            kept.append(self._contract(boxes.take(rows), own, passes, combine, every_goal))
        return Boxes.joined(kept) if kept else boxes

    def _contract(
        self, boxes: Boxes, caps: np.ndarray | None, passes: int, combine: np.ndarray | None, every_goal: bool
    ) -> Boxes:
        self.contracted += len(boxes)
        data = self.instance.data(boxes.combination)
        limits = None if caps is None else list(np.moveaxis(self.values_of(caps), -1, 0))
        if every_goal:
            result = self._all_goals.contract(boxes.low, boxes.high, data, limits, passes, combine)
            bounds = np.maximum(result.bounds, boxes.bounds)
        else:
            m = self.traded
            kept = None if combine is None else combine[:, : len(self.cuts) + m]
            own = None if limits is None else limits[:m]
            result = self._traded_only.contract(boxes.low, boxes.high, data, own, passes, kept)
            bounds = boxes.bounds.copy()
            bounds[:, :m] = np.maximum(bounds[:, :m], result.bounds)
        # An active limit loosened by the slack must not cost a grid point or a pinned value.
        low, high, alive = result.low, result.high, result.alive
        low, high = np.maximum(low, self.lower), np.minimum(high, self.upper)
        for k, grid in enumerate(self.grids):
            if len(grid):
                first = np.searchsorted(grid, low[:, k] * (1 - SNAP) - PINNED)
                last = np.searchsorted(grid, high[:, k] * (1 + SNAP) + PINNED, side="right") - 1
                alive = alive & (first <= last)
                low[:, k] = grid[np.minimum(first, len(grid) - 1)]
                high[:, k] = np.maximum(grid[np.maximum(last, 0)], low[:, k])
        alive = alive & ~np.any(low > high * (1 + SNAP) + PINNED, axis=1)
        high = np.maximum(high, low)
        if alive.any():
            self._positive_cuts &= result.positive_cuts
            self._seen_feasible_boxes = True
        return Boxes(boxes.combination, low, high, bounds, result.scores, boxes.tag).take(alive)

    def split(self, boxes: Boxes) -> tuple[Boxes, Boxes]:
        """Return the halves of all boxes that can be split, and the boxes that are too small to be split."""
        if not self.n:
            return boxes.take(np.zeros(0, dtype=np.int64)), boxes
        width = self._widths(boxes)
        score = np.where(width > 0, boxes.scores * 1.0, -1.0)
        # Where no score tells (nothing depends on the box any more, or the slopes are unbounded) the widest is split.
        flat = ~np.any((score > 1e-9) & (width > 0), axis=1)
        score[flat] = np.where(width[flat] > 0, width[flat], -1.0)
        small = ~np.any(width > 0, axis=1)
        rest, whole = boxes.take(small), boxes.take(~small)
        variable = np.argmax(score[~small], axis=1)
        rows = np.arange(len(whole))
        low, high = whole.low[rows, variable], whole.high[rows, variable]
        left_end, right_start = self._middle(variable, low, high)
        left, right = whole.high.copy(), whole.low.copy()
        left[rows, variable], right[rows, variable] = left_end, right_start
        halves = Boxes.joined([replace(whole, high=left), replace(whole, low=right)])
        return halves, rest

    def _widths(self, boxes: Boxes) -> np.ndarray:
        """Return relative widths, 0 where a variable cannot be split any more."""
        size = np.maximum(np.abs(boxes.low), np.abs(boxes.high))
        span = boxes.high - boxes.low
        floor = np.where(self.gridded, SNAP * size, 1e-7 * np.maximum(size, 1e-9 * (self.upper - self.lower)))
        with np.errstate(all="ignore"):
            return np.where(span > floor, span / np.maximum(size, 1e-300), 0.0)

    def _middle(self, variable: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        with np.errstate(all="ignore"):
            middle = np.where(low > 0, np.sqrt(low * high), 0.5 * (low + high))
        left, right = middle.copy(), middle.copy()
        for k, grid in enumerate(self.grids):
            rows = np.flatnonzero(variable == k)
            if len(grid) and len(rows):
                first = np.searchsorted(grid, low[rows] * (1 - SNAP) - PINNED)
                last = np.searchsorted(grid, high[rows] * (1 + SNAP) + PINNED, side="right") - 1
                cut = (first + last) // 2
                left[rows], right[rows] = grid[cut], grid[np.minimum(cut + 1, len(grid) - 1)]
        return left, right

    # -- objectives ----------------------------------------------------------------------------

    def settle_objectives(self, boxes: Boxes) -> None:
        """Decide, from the root boxes, which objectives are surely positive and enter by logarithm."""
        smallest = boxes.bounds.min(axis=0)
        signs = np.array([goal.sign for goal in self.goals])
        self.log_goals = (smallest > 0) & (signs > 0)
        sample = boxes.take(np.linspace(0, len(boxes) - 1, min(len(boxes), 200)).astype(int))
        result = self.evaluate(0.5 * (sample.low + sample.high), sample.combination)
        for j, name in enumerate(self.names):
            sizes = np.abs(result.values[name])
            sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
            self.goal_scales[j] = 1.0 if self.log_goals[j] or not len(sizes) else float(np.median(sizes))
        self._nlp = None

    def values_of(self, phi: np.ndarray) -> np.ndarray:
        """Return signed objective values for phi."""
        with np.errstate(all="ignore"):
            return np.where(self.log_goals, np.exp(phi), phi * self.goal_scales)

    def phi_of(self, values: np.ndarray) -> np.ndarray:
        """Return phi for signed objective values (batch, objectives)."""
        with np.errstate(all="ignore"):
            logs = np.log(np.where(self.log_goals, np.maximum(values, 1e-300), 1.0))
        return np.where(self.log_goals, logs, values / self.goal_scales)

    # -- points --------------------------------------------------------------------------------

    def evaluate(self, variables: np.ndarray, combinations: np.ndarray) -> Evaluation:
        """Evaluate a batch of designs."""
        return self.model.evaluate(variables, self.instance.data(np.asarray(combinations)))

    def candidates(self, variables: np.ndarray, combinations: np.ndarray) -> list[Candidate]:
        """Return those of the points that are feasible, and keep them in the archive."""
        rows, phi = self._feasible(variables, combinations)
        self.archive.add(combinations[rows], variables[rows], phi[rows])
        return [Candidate(int(combinations[k]), variables[k].copy(), phi[k]) for k in rows]

    def feasible_points(self, variables: np.ndarray, combinations: np.ndarray) -> list[Candidate]:
        """Return those of the points that are feasible."""
        rows, phi = self._feasible(variables, combinations)
        return [Candidate(int(combinations[k]), variables[k].copy(), phi[k]) for k in rows]

    def _feasible(self, variables: np.ndarray, combinations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        result = self.evaluate(variables, combinations)
        feasible = result.feasible & self._not_refused(combinations)
        for limit, fixed in zip(self.model.limits, self.immovable, strict=False):
            if not fixed:
                r = result.residuals[limit.name]
                feasible = feasible & (np.isnan(r) | (r <= SEARCH_TOLERANCE))
        feasible = feasible & np.all(variables >= self.lower * (1 - np.sign(self.lower) * 1e-12), axis=1)
        for extra in self.instance.extra:
            r = residual(result.values[extra.quantity], extra.limit, extra.sense, 1e-9)
            feasible = feasible & holds(r, guard=False)
        signed = np.stack(
            [g.sign * result.values[name] for g, name in zip(self.goals, self.names, strict=True)], axis=1
        )
        phi = self.phi_of(signed)
        return np.flatnonzero(feasible & np.all(np.isfinite(phi), axis=1)), phi

    def sample(self, boxes: Boxes, count: int, rng: np.random.Generator) -> None:
        """Evaluate ``count`` random makeable points per box and keep the feasible ones in the archive."""
        for first in range(0, len(boxes), CHUNK):
            part = boxes.take(np.arange(first, min(first + CHUNK, len(boxes))))
            for _ in range(count):
                share = rng.random((len(part), self.n))
                self.candidates(self.makeable(self.inside(part, share)), part.combination)

    def inside(self, boxes: Boxes, share: np.ndarray | float) -> np.ndarray:
        """Return points inside boxes: share 0 is the lower, 1 the upper end; by ratio where positive."""
        with np.errstate(all="ignore"):
            ratio = boxes.low * (boxes.high / boxes.low) ** share
        points: np.ndarray = np.where(boxes.low > 0, ratio, boxes.low + share * (boxes.high - boxes.low))
        return points

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

    def good_start(self, box: Boxes, rng: np.random.Generator, count: int = 48) -> np.ndarray:
        """Return the random point of a box that breaks its worst limit least."""
        many = box.take(np.zeros(count, dtype=np.int64))
        share = rng.random((count, self.n))
        share[0] = 0.5
        points = self.inside(many, share)
        result = self.evaluate(points, many.combination)
        worst = np.zeros(count)
        for limit in self.model.limits:
            r = result.residuals[limit.name]
            # Behind a guard that fails nothing else is known, so it counts most.
            guard = limit.guard & ~result.holds[limit.name]
            worst = np.fmax(worst, np.where(guard, 1e3, np.where(np.isinf(r), 1e2, r)))
        broken = np.any([~h for h in result.holds.values()], axis=0) if result.holds else np.zeros(count, dtype=bool)
        best: np.ndarray = points[int(np.argmin(np.where(broken, np.maximum(worst, 1e-9), 0.0)))]
        return best

    # -- the continuous problem ----------------------------------------------------------------

    def nlp(self) -> ParametricNlp:
        """Return the NLP of this question; built once per model and set of rows."""
        if self._nlp is None:
            # Where no box is left, nothing proves a sign, and logarithms would not exist.
            positive = self._positive_cuts & self._seen_feasible_boxes
            log_variables = tuple(bool(x > 0) for x in self.lower)
            rows = Rows(
                cuts=tuple(replace(c, bound=0.0) for c in self.cuts),
                goals=tuple(self.goals),
                log_cuts=tuple(bool(p) and c.sense != "equal" for p, c in zip(positive, self.cuts, strict=True)),
                log_goals=tuple(bool(x) for x in self.log_goals),
                log_variables=log_variables,
            )
            self._nlp = self.model.function(rows, lambda: ParametricNlp(self.model.program, self.n, rows))
        return self._nlp

    def solve(
        self,
        task: Task,
        combination: int,
        start: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        gradient: bool = False,
        skipped: np.ndarray | None = None,
    ) -> Solution | None:
        """Solve the continuous problem of one combination inside a box, from one start; leave some limits out."""
        data = [float(np.asarray(x).ravel()[0]) for x in self.instance.data(np.array([combination]))]
        self.solved_combinations.add(combination)
        self.nlp_solves += 1
        void = np.zeros(len(self.cuts), dtype=bool) if skipped is None else skipped.copy()
        for j, limit in enumerate(self.model.limits):
            void[j] |= any(np.isnan(data[k]) for k in self.model.void_inputs[limit.name])
        return self.nlp().solve(task, data, start, low, high, self.bounds, void, gradient)
