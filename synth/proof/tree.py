"""A tree of boxes that proves that some regions of the objectives hold no feasible design.

The tree belongs to ``verify`` and shares no code with the search; limits are read from the declaration once more, as
``synth.verification.verify`` tells. A node is a box of everything that is open: a
range of each variable, of each count and choice, a cluster of rows per slot, and a cluster of regions. The rows of
a slot are arranged once as a tree over the columns that the question uses, so that one node can speak of thousands
of combinations. Boxes whose enclosures (``synth.proof.enclosure``) break a limit or miss every region are dead; the
others are tightened and split where the limits and objectives are spread most.

References
----------
J. L. Bentley: Multidimensional binary search trees used for associative searching. Communications of the ACM 18
(1975) 509-517. H. Schichl, A. Neumaier: Interval analysis on directed acyclic graphs for global optimization. J. of
Global Optimization 33 (2005) 541-562.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from synth.model.limit_terms import LimitTerms
from synth.model.model import Model
from synth.model.program import Program
from synth.proof.clusters import FAR, TINY, Clusters
from synth.proof.enclosure import Enclosed, Encloser, NodeComparison
from synth.proof.interval_arithmetic import INF
from synth.proof.multipliers import StraightRows, lifted_value
from synth.proof.questions import Coordinate, LimitSides, Point, ProofOutcome
from synth.proof.settings import PROOF, ProofLimits
from synth.proof.tape import Expr, Ref, Tape
from synth.proof.tightening import ProofRow, _Step
from synth.question.instance import Instance
from synth.special import expanded


@dataclass
class ProofBoxes:
    """Unresolved boxes: ends of the continuous variables, and ends of ladders, nodes of slots and of the regions."""

    real: np.ndarray  # (2 variables, boxes): low ends, then high ends
    discrete: np.ndarray  # (2 ladders + slots + 1, boxes): first ends, last ends, nodes

    def __len__(self) -> int:
        return int(self.discrete.shape[1])

    def take(self, which: np.ndarray | slice) -> ProofBoxes:
        """Boxes of a mask or of positions."""
        return ProofBoxes(self.real[:, which], self.discrete[:, which])

    def each(self) -> Iterator[ProofBoxes]:
        """Yield the boxes one by one."""
        return (self.take(slice(k, k + 1)) for k in range(len(self)))

    @staticmethod
    def joined(parts: Sequence[ProofBoxes]) -> ProofBoxes:
        """One batch of several."""
        return ProofBoxes(
            np.concatenate([p.real for p in parts], axis=1), np.concatenate([p.discrete for p in parts], axis=1)
        )


def void_without(model: Model) -> dict[str, list[int]]:
    """Data inputs, per limit of the family, without which the limit is void."""
    optional = {str(e.sx): k for k, e in enumerate(model.data_inputs) if not e.required}
    result: dict[str, list[int]] = {}
    for limit in model.limits:
        sides = expanded(ca.vertcat(limit.value, limit.limit), model.calls) if optional else ca.SX()
        result[limit.name] = sorted(optional[str(s)] for s in ca.symvar(sides) if str(s) in optional)
    return result


def moved_limits(instance: Instance) -> dict[str, bool]:
    """Per limit, in order: whether something continuous enters it."""
    ranges, model = instance.ranges, instance.model
    free = [
        k
        for k, (low, high, grid) in enumerate(zip(ranges.lower, ranges.upper, ranges.grids(), strict=True))
        if low < high and not len(grid)
    ]
    moving = model.program.dependence(free)
    return {x.name: any(moving[k] for k in x.nodes) for x in instance.constraints}


class ProofTree:
    """A question as a tree can prove it; made once, asked for any regions of the objectives.

    Inside, an objective that is surely positive and to be small (``positive``) counts by logarithm.

    Parameters
    ----------
    instance : Instance
    objectives : mapping
        Names and senses.
    limits : ProofLimits
    guided : bool
        Boxes begin with the whole question, carry an inner value that objectives see (``lifted_value``), and are split
        where the limits that hold a design in its place are spread (``synth.proof.multipliers``).
    share : float
        Of the tolerances of limits that something continuous moves (``ProofLimits.share_for``).
    """

    def __init__(
        self,
        instance: Instance,
        objectives: Mapping[str, str],
        limits: ProofLimits = PROOF,
        guided: bool = False,
        share: float = 1.0,
    ) -> None:
        self.instance, self.limits, self.guided = instance, limits, guided
        self._shares = {name: share if moved else 1.0 for name, moved in moved_limits(instance).items()}
        self._senses = [1 if sense == "min" else -1 for sense in objectives.values()]
        model = instance.model
        sides: list[Any] = [model.quantity_sx[name] for name in objectives]
        sides += [side for limit in model.limits for side in (limit.value, limit.limit)]
        sides += [model.quantity_sx[x.quantity] for x in instance.limits.judging]
        sides += [refusal.when for refusal in instance.selection.joint_refusals]
        self.program = Program(model.inputs, sides, model.calls)
        self._terms = LimitTerms(self.program, len(model.variables), *model.zeros())
        self._used = set(self.program.needed(self.program.outputs))
        self._coordinates: list[Coordinate] = []
        self._variables: list[
            int
        ] = []  # numbers of those that are continuous, then instructions that are carried along
        self._lifted: dict[int, int] = {}  # instructions that boxes carry along, and their coordinates
        self._ladders: list[np.ndarray] = []
        self._tables: list[np.ndarray] = []  # per slot with columns that matter: values (rows, columns)
        self._rows: list[np.ndarray] = []  # per such slot: the rows that are left
        self._table_of: dict[str, int] = {}
        self._inputs = self._read_inputs()
        self._read_outputs(len(objectives))
        self._order = self._in_order()
        self.positive = [False] * len(objectives)
        with np.errstate(all="ignore"):
            self.empty = not (self._tighten_root() and self._keep_inside())
            if not self.empty:
                self._record()

    # -- reading the question ------------------------------------------------------------------

    def _read_inputs(self) -> list[int | float]:
        """Return, per input of the program, the number of its coordinate, or its value where it has but one."""
        instance, model = self.instance, self.instance.model
        inputs: list[int | float] = [math.nan] * self.program.n_inputs
        for k, grid in enumerate(instance.ranges.grids()):
            low, high = float(instance.ranges.lower[k]), float(instance.ranges.upper[k])
            if len(grid):
                inputs[k] = self._ladder(k, grid)
            elif low == high or not self._matters(k):
                inputs[k] = low
            else:
                self._variables.append(k)
                inputs[k] = self._moving("variable", len(self._variables) - 1, 0, np.array([low, high]))
        stepped = {**instance.selection.counts, **instance.selection.choices}
        slots: dict[str, list[int]] = {s.slot: [] for s in instance.selection.slots}
        first = len(model.variables)
        for k, entry in enumerate(model.data_inputs, start=first):
            if entry.kind == "requirement":
                inputs[k] = float(instance.values.requirements[entry.name])
            elif entry.kind == "row":
                inputs[k] = float(instance.values.rows[str(entry.sx)])
            elif entry.kind == "part":
                slots[entry.name].append(k)
            else:
                inputs[k] = self._ladder(k, stepped[entry.name])
        for slot in instance.selection.slots:
            moving: list[np.ndarray] = []
            for k in slots[slot.slot]:
                values = slot.columns["|".join(model.data_inputs[k - first].columns)]
                if not self._matters(k) or np.isnan(values).all() or np.all(values == values[0]):
                    inputs[k] = float(values[0])
                else:
                    moving.append(values)
                    inputs[k] = self._moving("column", len(self._tables), len(moving) - 1, values)
            if moving:
                self._table_of[slot.slot] = len(self._tables)
                self._tables.append(np.array(moving).T)
        return inputs

    def _matters(self, k: int) -> bool:
        return self.program.input_nodes[k] in self._used

    def _moving(self, kind: str, group: int, column: int, values: np.ndarray) -> int:
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        self._coordinates.append(Coordinate(kind, group, column, low, high))
        return len(self._coordinates) - 1

    def _ladder(self, k: int, values: np.ndarray) -> int | float:
        if len(values) == 1 or not self._matters(k):
            return float(values[0])
        self._ladders.append(np.asarray(values, dtype=float))
        return self._moving("ladder", len(self._ladders) - 1, 0, values)

    def _read_outputs(self, objectives: int) -> None:
        model, outputs = self.instance.model, iter(self.program.outputs)
        first = len(model.variables)
        self._goals = [next(outputs) for _ in range(objectives)]
        self._limits: list[LimitSides] = []
        void_inputs = void_without(model)
        for limit in model.limits:
            value, bound = next(outputs), next(outputs)
            optional = [self._inputs[first + k] for k in void_inputs[limit.name]]
            if not any(isinstance(x, float) and math.isnan(x) for x in optional):  # else void whatever is chosen
                void = tuple(x for x in optional if isinstance(x, int) and self._lacks(x))
                terms = None if limit.guard else self._terms.of([value, bound], limit.scale)
                share = self._shares[limit.name]
                self._limits.append(LimitSides(value, bound, limit.sense, limit.scale, terms, void, limit.guard, share))
        for x in self.instance.limits.judging:
            value = next(outputs)
            sides = LimitSides(value, float(x.bound), x.sense, x.scale, self._terms.of([value]))
            self._limits.append(replace(sides, share=self._shares[x.name]))
        self._refusals = list(outputs)

    def _in_order(self) -> list[int]:
        """Return all instructions, the bounds of limits first, so that they can cut the values when those come."""
        first = [x.bound for x in self._limits if isinstance(x.bound, int)]
        order: dict[int, None] = {}
        terms = [x.terms for x in self._limits if x.terms is not None]
        for node in [*first, *terms, *(x.value for x in self._limits), *self.program.outputs]:
            order.update(dict.fromkeys(self.program.needed([node])))
        return list(order)

    def _lacks(self, coordinate: int) -> bool:
        c = self._coordinates[coordinate]
        return c.kind == "column" and bool(np.isnan(self._tables[c.group][:, c.column]).any())

    def _cuts(self) -> dict[int, list[NodeComparison]]:
        cuts: dict[int, list[NodeComparison]] = {}
        for x in self._limits:
            if not x.void:
                direction = {"at_most": 1, "at_least": -1, "equal": 0}[x.sense]
                loose = 0.0 if x.guard else x.share * self.limits.cut_tolerance  # a guard has no tolerance
                cuts.setdefault(x.value, []).append(NodeComparison(x.bound, direction, x.scale, x.terms, loose))
                if isinstance(x.bound, int):
                    other = NodeComparison(x.value, -direction, x.scale, x.terms, loose)
                    cuts.setdefault(x.bound, []).append(other)
        return cuts

    # -- the root box --------------------------------------------------------------------------

    def _root(self) -> list[Enclosed]:
        return [self._full_range(x) if isinstance(x, int) else Enclosed.constant(x) for x in self._inputs]

    def _full_range(self, k: int) -> Enclosed:
        """Enclosure of a coordinate over its full range."""
        c = self._coordinates[k]
        pair = (c.low, c.high)
        middle = math.sqrt(c.low * c.high) if c.log else 0.5 * (c.low + c.high)
        sign = 1 if c.low > 0 else -1 if c.high < 0 else 0
        return Enclosed(pair, (middle, middle), c.log, {k: (1.0, 1.0)}, sign, pair, pair, c.least)

    def _tighten_root(self) -> bool:
        """Contract the ranges of all inputs by the limits; False where they become empty."""
        nodes, cuts = self.program.nodes, self._cuts()
        pad = self.limits.pad
        for _ in range(self.limits.sweeps):
            encloser = Encloser(Tape(), self.program, slopes=False)
            enclosed = encloser.run(nodes, self._order, self._root(), cuts)
            self._certain = encloser.carried_back(nodes, self._order, enclosed)
            for k, source in enumerate(self._inputs):
                if isinstance(source, int):
                    c = self._coordinates[source]
                    low, high = self._certain[self.program.input_nodes[k]]
                    low, high = np.fmax(c.low, low - pad * abs(low)), np.fmin(c.high, high + pad * abs(high))
                    if low > high:
                        return False
                    self._coordinates[source] = replace(c, low=float(low), high=float(high))
        return True

    def _keep_inside(self) -> bool:
        """Drop values of ladders and rows outside the root box; False where none remain."""
        self._rows, snap = [np.arange(len(table)) for table in self._tables], self.limits.snap
        for k, c in enumerate(self._coordinates):
            if c.kind == "ladder":
                values = self._ladders[c.group]
                values = values[_between(values, c.low, c.high, snap)]
                if not len(values):
                    return False
                self._ladders[c.group] = values
                self._coordinates[k] = replace(c, low=float(values[0]), high=float(values[-1]))
            elif c.kind == "column":
                values = self._tables[c.group][self._rows[c.group], c.column]
                self._rows[c.group] = self._rows[c.group][_between(values, c.low, c.high, snap) | np.isnan(values)]
        if not all(len(rows) for rows in self._rows):
            return False
        for k, c in enumerate(self._coordinates):
            if c.kind == "column":
                values = self._tables[c.group][self._rows[c.group], c.column]
                there = values[~np.isnan(values)]
                low, high = (float(there.min()), float(there.max())) if len(there) else (1.0, 1.0)
                self._coordinates[k] = replace(c, low=low, high=high)
        self._slots = []
        for group, table in enumerate(self._tables):
            columns = [c for c in self._coordinates if c.kind == "column" and c.group == group]
            scale = np.array([max(abs(c.low), abs(c.high)) or 1.0 for c in columns])
            self._slots.append(Clusters(table[self._rows[group]], np.array([c.log for c in columns]), scale))
        return True

    # -- recording what is done with a batch of boxes ------------------------------------------

    def _record(self) -> None:
        """Record the work on a batch of boxes: narrow ranges, then slopes; both give tightened ends."""
        if self.guided:
            self._carry_along()
        lifted = {node: self._full_range(k) for node, k in self._lifted.items()}
        scout = Encloser(Tape(), self.program, certain=self._certain, lifted=lifted)
        seen = scout.run(self.program.nodes, self._order, self._root())
        self.positive = [seen[g].sign > 0 and sense > 0 for g, sense in zip(self._goals, self._senses, strict=True)]
        tape = Tape()
        ends, middles, halves, leaves = [], [], [], []
        for k, c in enumerate(self._coordinates):
            side = 1 if c.low >= 0 else -1 if c.high <= 0 else 0
            pair, middle = (tape.leaf(side), tape.leaf(side)), tape.leaf(side)
            ends.append(pair)
            middles.append(middle)
            halves.append(tape.leaf(1))
            sign = 1 if c.low > 0 else -1 if c.high < 0 else 0
            leaves.append(Enclosed(pair, (middle, middle), c.log, {k: (1.0, 1.0)}, sign, pair, pair, c.least))
        levels = [tape.leaf() for _ in self._goals]
        widths = [tape.leaf(1) for _ in self._goals]
        caps = [tape.leaf(1 if positive else 0) for positive in self.positive]
        masks = {void: tape.leaf() for void in dict.fromkeys(x.void for x in self._limits if x.void)}
        self._masks = list(masks)

        lifted = {node: leaves[k] for node, k in self._lifted.items()}
        encloser = Encloser(tape, self.program, known=scout.record, lifted=lifted)
        cuts = self._cuts()
        for goal, sense, cap in zip(self._goals, self._senses, caps, strict=True):
            cuts.setdefault(goal, []).append(NodeComparison(cap, sense, loose=0.0))
        inputs = [leaves[x] if isinstance(x, int) else Enclosed.constant(x) for x in self._inputs]
        enclosed = encloser.run(self.program.nodes, self._order, inputs, cuts)
        rows = [self._goal_row(encloser, enclosed, k, levels[k]) for k in range(len(self._goals))]
        for limit in self._limits:
            rows += self._limit_rows(encloser, enclosed, limit, masks)
        for node, made in encloser.made.items():
            same = LimitSides(node, node, "equal", 0.0)
            sides = made, enclosed[node]
            rows += [self._limit_row(encloser, *two, same, None) for two in (sides, sides[::-1])]
        for k in self._refusals:
            surely = encloser.do("subtract", enclosed[k].narrow[0], 0.5)
            rows.append(ProofRow(surely, surely, surely, {}))

        step = _Step(
            encloser, ends, halves, self._coordinates, [self._group_of(c) for c in self._coordinates], self.limits.pad
        )
        handed = [x for pair in ends for x in pair] + levels + caps + list(masks.values())
        back = encloser.carried_back(self.program.nodes, self._order, enclosed)
        place = {x: self.program.input_nodes[k] for k, x in enumerate(self._inputs) if isinstance(x, int)}
        place |= {k: node for node, k in self._lifted.items()}
        self._narrowing = tape.kernel(handed, step.narrowed(rows, levels, [back[place[k]] for k in range(len(ends))]))
        handed += middles + halves + widths
        self._emphasised = len(rows)
        emphasis: list[Expr] = [tape.leaf(1) for _ in rows] if self.guided else [1.0] * len(rows)
        outputs = step.sloped(rows, levels, widths, self._groups, emphasis)
        self._sloping = tape.kernel(handed + (emphasis if self.guided else []), outputs)
        if self.guided:
            self._straight = StraightRows(tape, rows, handed, len(self._coordinates))

    def _carry_along(self) -> None:
        """Let boxes carry an inner value with ends of its own, if there is one that objectives see."""
        void = {k for k, x in enumerate(self._inputs) if isinstance(x, int) and self._lacks(x)}
        moving = {k for k, x in enumerate(self._inputs) if isinstance(x, int)}
        node = lifted_value(self.program, self._goals, self._certain, moving, void)
        if node is not None:
            low, high = (float(x) for x in self._certain[node])
            pad = self.limits.pad
            self._lifted[node] = len(self._coordinates)
            self._variables.append(node)
            inner = Coordinate("variable", len(self._variables) - 1, 0, low * (1 - pad), high * (1 + pad))
            self._coordinates.append(inner)

    @property
    def _groups(self) -> int:
        """How many things can be split: variables, ladders, slots, and last the regions."""
        return len(self._variables) + len(self._ladders) + len(self._tables) + 1

    def _group_of(self, c: Coordinate) -> int:
        first = {"variable": 0, "ladder": len(self._variables), "column": len(self._variables) + len(self._ladders)}
        return first[c.kind] + c.group

    def _goal_row(self, encloser: Encloser, enclosed: Mapping[int, Enclosed], k: int, level: Ref) -> ProofRow:
        v, do = enclosed[self._goals[k]], encloser.do
        if self.positive[k]:
            ends = (do("log", v.uncut[0]), do("log", v.range[0]), do("log", v.center[0]))
            slopes = encloser.logarithmic(v)
        elif self._senses[k] > 0:
            ends, slopes = (v.uncut[0], v.range[0], v.center[0]), encloser.linear(v)
        else:
            ends = (do("negative", v.uncut[1]), do("negative", v.range[1]), do("negative", v.center[1]))
            slopes = {q: encloser.negative(s) for q, s in encloser.linear(v).items()}
        least, anywhere, center = (do("subtract", x, level) for x in ends)
        return ProofRow(least, anywhere, center, slopes)

    def _limit_rows(
        self, encloser: Encloser, enclosed: Mapping[int, Enclosed], x: LimitSides, masks: Mapping[Any, Ref]
    ) -> list[ProofRow]:
        value = enclosed[x.value]
        bound = enclosed[x.bound] if isinstance(x.bound, int) else Enclosed.constant(x.bound)
        terms = None if x.terms is None else enclosed[x.terms]
        void = masks[x.void] if x.void else None
        rows = []
        if x.sense in ("at_most", "equal"):
            rows.append(self._limit_row(encloser, value, bound, x, void, terms))
        if x.sense in ("at_least", "equal"):
            rows.append(self._limit_row(encloser, bound, value, x, void, terms))
        return rows

    def _limit_row(
        self,
        e: Encloser,
        small: Enclosed,
        large: Enclosed,
        x: LimitSides,
        void: Ref | None,
        terms: Enclosed | None = None,
    ) -> ProofRow:
        """Return small <= large as a row: log(small/large), or their difference over their size."""
        do, limits = e.do, self.limits
        share = limits.guard_tolerance if x.guard else x.share * limits.row_tolerance
        if terms is None and small.sign > 0 and large.sign > 0 and x.scale <= max(small.least, large.least):
            ends = []
            for a, b in ((small.uncut, large.uncut), (small.range, large.range), (small.center, large.center)):
                ends.append(do("subtract", do("log", do("divide", a[0], b[1])), share))
            slopes = e.merged(e.logarithmic(small), e.logarithmic(large), e.subtract)
            return ProofRow(ends[0], ends[1], ends[2], slopes, void)
        least, most = (x.scale, x.scale) if terms is None else (terms.center[0], terms.range[1])
        size = do("maximum", do("absolute", large.center[0]), do("maximum", do("absolute", small.center[0]), least))
        factor = do("divide", 1.0, size)
        pair = (factor, factor)
        tolerance = do("multiply", share, do("maximum", e.largest(large.range), most))
        ends = []
        for a, b in ((small.uncut, large.uncut), (small.range, large.range), (small.center, large.center)):
            ends.append(do("subtract", do("subtract", a[0], b[1]), tolerance))
        ends[1:] = [do("multiply", factor, x) for x in ends[1:]]
        slopes = e.merged(e.linear(small), e.linear(large), e.subtract)
        return ProofRow(ends[0], ends[1], ends[2], {k: e.multiply(pair, s) for k, s in slopes.items()}, void)

    # -- the tree ------------------------------------------------------------------------------

    def prove(self, ends: np.ndarray, confirm: Callable[[Point], bool], deadline: float = INF) -> ProofOutcome:
        """Prove that no feasible design lies in any region: below an end in every objective.

        Parameters
        ----------
        ends : array (regions, objectives)
            In SI, with the sign turned where an objective is to be large; infinite where it does not bound a region.
        confirm : callable
            Takes a design that may refute the claim and tells whether it does.
        deadline : float
            On the clock of ``time.monotonic``.
        """
        growth = self.growth(ends, confirm)
        growth.go_on(INF, deadline)
        return growth.outcome

    def growth(
        self, ends: np.ndarray, confirm: Callable[[Point], bool], near: Sequence[Sequence[Point]] = ()
    ) -> ProofGrowth:
        """Return a proof that is about to begin; see ``prove``.

        ``near``: per region, designs by which boxes are split where the tree is guided.
        """
        with np.errstate(all="ignore"):
            logs = np.where(ends > 0, np.log(np.maximum(ends, TINY)), -INF)  # nothing positive lies below 0
            levels = np.where(self.positive, logs, ends)
            finite = np.where(np.isfinite(levels), levels, np.nan)
            spread = [np.ptp(x[~np.isnan(x)]) if not np.isnan(x).all() else 0.0 for x in finite.T]
            scale = np.array([x if x > 0 else 1.0 for x in spread])
            regions = Clusters(levels, np.zeros(levels.shape[1], dtype=bool), scale)
            emphasis = self._emphasis(regions, levels, near) if self.guided and not self.empty else None
        return ProofGrowth(self, regions, emphasis, confirm)

    def _emphasis(self, regions: Clusters, levels: np.ndarray, near: Sequence[Sequence[Point]]) -> np.ndarray:
        """Weight of each row (rows, clusters of regions), by the designs near the regions."""
        weights = np.zeros((self._emphasised, len(regions.first)))
        for node in reversed(range(len(regions.first))):  # what a cluster is split into comes after it
            if regions.left[node] < 0:
                k = regions.first[node]
                for point in near[k]:
                    weights[:, node] += self._straight.multipliers(*self._around(point, levels[k]))
            else:
                weights[:, node] = weights[:, regions.left[node]] + weights[:, regions.right[node]]
        most = weights.max(axis=0)
        return np.where(most > 0, weights / np.where(most > 0, most, 1.0), 1.0) + self.limits.faint

    def _around(self, point: Point, levels: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
        """Inputs of a kernel for a small box around a design, and half of its widths; its parts stay."""
        inputs = [*point.variables, *point.data]
        values = np.ones(len(self._coordinates))
        free = np.zeros(len(self._coordinates), dtype=bool)
        for k, source in enumerate(self._inputs):
            if isinstance(source, int):
                values[source] = 1.0 if math.isnan(inputs[k]) else inputs[k]
                free[source] = k < len(self.instance.model.variables)
        nodes = list(self._lifted)
        for node, value in zip(nodes, self.program.compile(nodes)(inputs) if nodes else [], strict=True):
            values[self._lifted[node]], free[self._lifted[node]] = value, True
        low, high = values.copy(), values.copy()
        around = self.limits.around
        for k, c in enumerate(self._coordinates):
            if free[k]:
                reach = abs(values[k]) * around if c.log else (c.high - c.low) * around
                low[k], high[k] = max(c.low, values[k] - reach), min(c.high, values[k] + reach)
        low, high = np.minimum(low, values), np.maximum(high, values)
        log = np.array([c.log for c in self._coordinates], dtype=bool)
        middle = np.where(log, np.sqrt(np.abs(low * high)), 0.5 * (low + high))
        halves = 0.5 * np.where(log, np.log(high / low), high - low)
        lacking = [float(any(math.isnan(inputs[self._inputs.index(x)]) for x in void)) for void in self._masks]
        ends = [np.exp(x) if p else s * x for x, p, s in zip(levels, self.positive, self._senses, strict=True)]
        arguments = [x for pair in zip(low, high, strict=True) for x in pair] + [*levels, *ends]
        box = [np.array([x]) for x in arguments] + [np.array([x > 0]) for x in lacking]
        return box + [np.array([x]) for x in (*middle, *halves, *np.zeros(len(levels)))], halves

    def _begin(self, regions: Clusters) -> ProofBoxes:
        """Boxes that cover everything, split blindly to a useful number."""
        real = [c.low for c in self._coordinates if c.kind == "variable"]
        real += [c.high for c in self._coordinates if c.kind == "variable"]
        integer = [0] * len(self._ladders) + [len(v) - 1 for v in self._ladders] + [0] * (len(self._tables) + 1)
        boxes = ProofBoxes(np.array(real, dtype=float).reshape(-1, 1), np.array(integer, dtype=np.int64).reshape(-1, 1))
        while len(boxes) < (1 if self.guided else self.limits.first):
            widths = self._widths(boxes, regions)
            if not np.any(widths > 0):
                break
            group = np.argmax(widths, axis=0)
            fixed = widths.max(axis=0) <= 0
            boxes = ProofBoxes.joined([boxes.take(fixed), self._halved(boxes.take(~fixed), group[~fixed], regions)])
        return boxes

    def _tightened(
        self, boxes: ProofBoxes, regions: Clusters, emphasis: np.ndarray | None = None
    ) -> tuple[ProofBoxes, np.ndarray, np.ndarray]:
        """Remaining boxes, how much each group spreads the rows, and the largest row at the middle."""
        result = self._narrowing.run(self._handed(boxes, regions, False))
        boxes, _ = self._placed(boxes, regions, result)
        if not len(boxes):
            return boxes, np.zeros((self._groups, 0)), np.zeros(0)
        count = len(boxes)
        result = self._sloping.run(
            [*self._handed(boxes, regions, True), *(() if emphasis is None else emphasis[:, boxes.discrete[-1]])]
        )
        boxes, kept = self._placed(boxes, regions, result)
        scores = np.array([np.broadcast_to(x, count)[kept] for x in result[-self._groups - 1 : -1]])
        # A spread without a bound counts as large, but not so that widths no longer matter.
        return boxes, np.where(np.isfinite(scores), scores, FAR), np.broadcast_to(result[-1], count)[kept]

    def _handed(self, boxes: ProofBoxes, regions: Clusters, slopes: bool) -> list[np.ndarray]:
        """Arrays that a kernel reads, in its order."""
        v, m = len(self._variables), len(self._ladders)
        nodes, region = boxes.discrete[2 * m : -1], boxes.discrete[-1]
        tables = [(slot.low[:, node], slot.high[:, node]) for slot, node in zip(self._slots, nodes, strict=True)]
        ends = []
        for c in self._coordinates:
            if c.kind == "variable":
                ends.append((boxes.real[c.group], boxes.real[v + c.group]))
            elif c.kind == "ladder":
                values = self._ladders[c.group]
                ends.append((values[boxes.discrete[c.group]], values[boxes.discrete[m + c.group]]))
            else:
                low, high = tables[c.group]
                ends.append((low[c.column], high[c.column]))
        handed = [x for pair in ends for x in pair]
        levels = regions.high[:, region]
        handed += list(levels)
        for level, positive, sense in zip(levels, self.positive, self._senses, strict=True):
            handed.append(np.exp(level) if positive else sense * level)
        for void in self._masks:
            lacking = np.zeros(len(boxes), dtype=bool)
            for k in void:
                c = self._coordinates[k]
                lacking |= self._slots[c.group].lacking[c.column, nodes[c.group]]
            handed.append(lacking)
        if slopes:
            pairs = list(zip(self._coordinates, ends, strict=True))
            handed += [np.sqrt(low * high) if c.log else 0.5 * (low + high) for c, (low, high) in pairs]
            handed += [0.5 * (np.log(high / low) if c.log else high - low) for c, (low, high) in pairs]
            widths = levels - regions.low[:, region]
            handed += list(np.where(np.isfinite(widths), widths, 0.0))
        return handed

    def _placed(self, boxes: ProofBoxes, regions: Clusters, result: Sequence[Any]) -> tuple[ProofBoxes, np.ndarray]:
        """Return the boxes that are not dead, between their new ends, and which of the old ones they are."""
        count, n = len(boxes), len(self._coordinates)
        low = [np.broadcast_to(x, count) for x in result[1 : 1 + n]]
        high = [np.broadcast_to(x, count) for x in result[1 + n : 1 + 2 * n]]
        dead = np.broadcast_to(result[0], count) > 0
        for a, b in zip(low, high, strict=True):
            dead |= a > b
        alive = np.flatnonzero(~dead)
        low, high = [x[alive] for x in low], [x[alive] for x in high]
        floor = np.array([np.broadcast_to(x, count)[alive] for x in result[1 + 2 * n : 1 + 2 * n + len(self._goals)]])
        v, m = len(self._variables), len(self._ladders)
        real, discrete = boxes.real[:, alive], boxes.discrete[:, alive]
        kept = np.ones(len(alive), dtype=bool)
        for k, c in enumerate(self._coordinates):
            if c.kind == "variable":
                real[c.group], real[v + c.group] = low[k], high[k]
            elif c.kind == "ladder":
                values = self._ladders[c.group]
                reach = self.limits.snap * np.maximum(np.abs(low[k]), np.abs(high[k]))
                first = np.maximum(np.searchsorted(values, low[k] - reach), discrete[c.group])
                last = np.minimum(np.searchsorted(values, high[k] + reach, side="right") - 1, discrete[m + c.group])
                kept &= first <= last
                discrete[c.group], discrete[m + c.group] = first, last
        for group, slot in enumerate(self._slots):
            columns = [k for k, c in enumerate(self._coordinates) if c.kind == "column" and c.group == group]
            least, most = np.array([low[k] for k in columns]), np.array([high[k] for k in columns])
            reach = self.limits.snap * np.maximum(np.abs(least), np.abs(most))
            discrete[2 * m + group] = slot.narrowed(discrete[2 * m + group], least - reach, most + reach)
            kept &= discrete[2 * m + group] >= 0
        floor = np.where(np.isnan(floor), -INF, floor)
        discrete[-1] = regions.narrowed(discrete[-1], floor, np.full(floor.shape, INF))
        kept &= discrete[-1] >= 0
        return ProofBoxes(real[:, kept], discrete[:, kept]), alive[kept]

    def _widths(self, boxes: ProofBoxes, regions: Clusters) -> np.ndarray:
        """Width of each group of a box; 0 where it cannot be split."""
        v, m = len(self._variables), len(self._ladders)
        result = np.zeros((self._groups, len(boxes)))
        for c in self._coordinates:
            if c.kind == "column":
                continue
            if c.kind == "variable":
                low, high = boxes.real[c.group], boxes.real[v + c.group]
            else:
                values = self._ladders[c.group]
                low, high = values[boxes.discrete[c.group]], values[boxes.discrete[m + c.group]]
            width = np.log(high / low) if c.log else (high - low) / max(c.high - c.low, 1e-300)
            thin = self.limits.thin if c.kind == "variable" else 0.0
            result[self._group_of(c)] = np.where(width > thin, width, 0.0)
        for group, slot in enumerate(self._slots):
            result[v + m + group] = slot.spread[boxes.discrete[2 * m + group]]
        result[-1] = regions.spread[boxes.discrete[-1]]
        return result

    def _single(self, boxes: ProofBoxes) -> np.ndarray:
        """Mask of boxes that are a single design as far as the question is concerned; regions may be many."""
        v, m = len(self._variables), len(self._ladders)
        free = v - len(self._lifted)  # lifted values follow from the other variables
        single: np.ndarray = np.all(boxes.real[:free] == boxes.real[v : v + free], axis=0)
        single &= np.all(boxes.discrete[:m] == boxes.discrete[m : 2 * m], axis=0)
        for slot, nodes in zip(self._slots, boxes.discrete[2 * m : -1], strict=True):
            single &= slot.left[nodes] < 0
        return single

    def _split(self, boxes: ProofBoxes, scores: np.ndarray, widths: np.ndarray, regions: Clusters) -> ProofBoxes:
        """Return boxes split where the rows are spread most, once, or more often where there are few."""
        few = self.limits.few_guided if self.guided else self.limits.few
        while True:
            score = np.where(widths > 0, scores + 1e-9 * widths, -1.0)
            group = np.argmax(score, axis=0)
            fixed = score.max(axis=0) < 0
            scores[group, np.arange(len(boxes))] *= 0.5
            boxes = ProofBoxes.joined([boxes.take(fixed), self._halved(boxes.take(~fixed), group[~fixed], regions)])
            if len(boxes) >= few or fixed.any():
                return boxes
            scores, widths = np.concatenate([scores, scores], axis=1), self._widths(boxes, regions)

    def _halved(self, boxes: ProofBoxes, group: np.ndarray, regions: Clusters) -> ProofBoxes:
        """All left halves, then all right halves."""
        v, m = len(self._variables), len(self._ladders)
        left = ProofBoxes(boxes.real.copy(), boxes.discrete.copy())
        right = ProofBoxes(boxes.real.copy(), boxes.discrete.copy())
        for c in self._coordinates:
            at = np.flatnonzero(group == self._group_of(c)) if c.kind != "column" else np.empty(0, dtype=np.int64)
            if not len(at):
                continue
            if c.kind == "variable":
                low, high = boxes.real[c.group, at], boxes.real[v + c.group, at]
                middle = np.sqrt(low * high) if c.log else 0.5 * (low + high)
                left.real[v + c.group, at] = right.real[c.group, at] = middle
            else:
                values = self._ladders[c.group]
                first, last = boxes.discrete[c.group, at], boxes.discrete[m + c.group, at]
                low, high = values[first], values[last]
                middle = np.sqrt(low * high) if c.log else 0.5 * (low + high)
                cut = np.clip(np.searchsorted(values, middle, side="right") - 1, first, last - 1)
                left.discrete[m + c.group, at], right.discrete[c.group, at] = cut, cut + 1
        for k, tree in enumerate([*self._slots, regions]):
            at = np.flatnonzero(group == v + m + k)
            node = boxes.discrete[2 * m + k, at]
            left.discrete[2 * m + k, at], right.discrete[2 * m + k, at] = tree.left[node], tree.right[node]
        return ProofBoxes.joined([left, right])

    def _point(self, box: ProofBoxes) -> Point:
        """Design in the middle of a box, of rows and makeable values."""
        model, v, m = self.instance.model, len(self._variables), len(self._ladders)
        values = [0.0] * self.program.n_inputs
        for k, source in enumerate(self._inputs):
            if not isinstance(source, int):
                values[k] = source
                continue
            c = self._coordinates[source]
            if c.kind == "variable":
                low, high = float(box.real[c.group, 0]), float(box.real[v + c.group, 0])
                values[k] = math.sqrt(low * high) if c.log else 0.5 * (low + high)
            elif c.kind == "ladder":
                values[k] = float(self._ladders[c.group][int(box.discrete[[c.group, m + c.group], 0].sum()) // 2])
        first = len(model.variables)
        digits: dict[str, int] = {}
        for slot in self.instance.selection.slots:
            group = self._table_of.get(slot.slot)
            row = 0
            if group is not None:
                node = int(box.discrete[2 * m + group, 0])
                row = int(self._rows[group][self._slots[group].first[node]])
            digits[slot.slot] = row
            for k, entry in enumerate(model.data_inputs, start=first):
                if entry.kind == "part" and entry.name == slot.slot:
                    values[k] = float(slot.columns["|".join(entry.columns)][row])
        return Point(np.array(values[:first]), values[first:], digits)


class ProofGrowth:
    """A proof in progress: its regions, and the boxes in which they are not yet proven empty.

    Parameters
    ----------
    tree : ProofTree
    regions : Clusters
    emphasis : array (rows, clusters of regions), optional
        Of a guided tree: how much each row counts when a box is split.
    confirm : callable
        Takes a design that may refute the claim and tells whether it does.
    """

    def __init__(
        self, tree: ProofTree, regions: Clusters, emphasis: np.ndarray | None, confirm: Callable[[Point], bool]
    ) -> None:
        self._tree, self._regions, self._emphasis, self._confirm = tree, regions, emphasis, confirm
        self._pool = [] if tree.empty else [tree._begin(regions)]
        self._stuck: list[np.ndarray] = []  # clusters of regions of boxes that are too small to be split
        self.nodes = 0
        self.witness: Point | None = None
        self.abandoned = False

    @property
    def closed(self) -> bool:
        """Whether the regions are proven to be empty."""
        return not self._pool and not self._stuck and self.witness is None

    @property
    def under_way(self) -> bool:
        """True if further work may still settle the proof."""
        return bool(self._pool) and not self.abandoned and self.witness is None

    @property
    def outcome(self) -> ProofOutcome:
        """How far it is."""
        return ProofOutcome(self.closed, self.nodes, self.witness, tuple(sorted(self.open_regions)))

    @property
    def open_regions(self) -> set[int]:
        """Regions with unresolved boxes."""
        clusters = [boxes.discrete[-1] for boxes in self._pool] + self._stuck
        waiting = np.unique(np.concatenate(clusters)).tolist() if clusters else []
        regions: set[int] = set()
        while waiting:
            node = waiting.pop()
            if self._regions.left[node] < 0:
                regions.add(int(self._regions.first[node]))
            else:
                waiting += [int(self._regions.left[node]), int(self._regions.right[node])]
        return regions

    def go_on(self, boxes: float, deadline: float) -> None:
        """Look into so many boxes more, as far as there are any and time allows."""
        with np.errstate(all="ignore"):
            most = self.nodes + boxes
            while self.under_way and self.nodes < most and time.monotonic() <= deadline:
                self._step()

    def _step(self) -> None:
        tree, regions, limits, pool = self._tree, self._regions, self._tree.limits, self._pool
        if self.nodes > limits.most_nodes or sum(map(len, pool)) > limits.most_open:
            self.abandoned = True
            return
        batch = _batch(pool, limits.chunk)
        self.nodes += len(batch)
        boxes, scores, middle = tree._tightened(batch, regions, self._emphasis)
        if not len(boxes):
            return
        widths = tree._widths(boxes, regions)
        small = ~np.any(widths > 0, axis=0) | tree._single(boxes)
        # Once more: what is too small to be split has been tightened only now.
        unsplit = boxes.take(small)
        unsplit = tree._tightened(unsplit, regions, self._emphasis)[0] if small.any() else unsplit
        single = tree._single(unsplit)
        hopeful = np.argsort(middle)[: limits.tries]
        few = [unsplit.take(np.flatnonzero(~single)[: limits.tries]), boxes.take(hopeful[middle[hopeful] <= 0])]
        # One point is settled by its evaluation, also where a formula does not exist and ranges tell nothing.
        for point in map(tree._point, ProofBoxes.joined([unsplit.take(single), *few]).each()):
            if self._confirm(point):
                self.witness = point
                return
        if not single.all():
            self._stuck.append(unsplit.discrete[-1, ~single])
        self.abandoned = sum(map(len, self._stuck)) > limits.most_stuck
        if not small.all():
            pool.append(tree._split(boxes.take(~small), scores[:, ~small], widths[:, ~small], regions))


def _between(values: np.ndarray, low: float, high: float, snap: float) -> np.ndarray:
    reach = snap * max(abs(low), abs(high))
    return (values >= low - reach) & (values <= high + reach)


def _batch(pool: list[ProofBoxes], chunk: int) -> ProofBoxes:
    """Take boxes from the end of the pool: one chunk, or less where there are fewer."""
    parts, count = [], 0
    while pool and count < chunk:
        parts.append(pool.pop())
        count += len(parts[-1])
    boxes = ProofBoxes.joined(parts)
    if len(boxes) > chunk:
        pool.append(boxes.take(slice(chunk, None)))
        boxes = boxes.take(slice(0, chunk))
    return boxes
