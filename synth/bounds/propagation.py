"""Propagation for one question: constants, tables per cluster, what holds over everything, and scores for splitting."""

from __future__ import annotations

import copy
from collections import ChainMap, Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.clusters import Cells, ClusterTree, Factor
from synth.bounds.compiled_boxes import BoxCode, CompiledQuestion, Packed, Prepared, compiled
from synth.bounds.compiled_subtrees import CapTables, Grown, Halves
from synth.bounds.contractor import INNER, Code, Contractor, MovingInputs
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import OP_SPECIAL
from synth.question.instance import Instance
from synth.special import SpecialCall, expanded
from synth.tuning import TUNING, Tuning


@dataclass(frozen=True)
class Propagated:
    """Boxes after propagation: what is alive, ends, lower bounds of the objectives, limits not decided yet."""

    alive: np.ndarray
    low: np.ndarray
    high: np.ndarray
    goals: list[Any]
    open: list[Any]


@dataclass(frozen=True)
class Lessons:
    """What solved problems tell about where to split, per set of objectives that are capped."""

    learned: np.ndarray
    importance: np.ndarray
    count: np.ndarray


class Propagation:
    """Interval propagation for one question.

    Parameters
    ----------
    instance : Instance
    cuts : list of NodeConstraint
        Limits, with the constant right sides of this question.
    goals : list of Goal
        Objectives: those to trade off first.
    bounded : int
        How many objectives, from the first, are bounded in every box.
    conflict : bool
        Nothing feasible is known, so that what limits see counts as what objectives see: for pivots.
    compiled : bool
        Whether code may be compiled.
    alike : int
        How many questions of this kind are asked.
    tuning : Tuning
    """

    def __init__(
        self,
        instance: Instance,
        cuts: Sequence[NodeConstraint],
        goals: Sequence[Goal],
        bounded: int,
        conflict: bool = False,
        compiled: bool = True,
        alike: int = 1,
        tuning: Tuning = TUNING,
    ) -> None:
        self._compiled, self._alike = compiled, alike
        self.compiling, self.branching = tuning.compiling, tuning.branching
        self.instance, self.model = instance, instance.model
        self.cuts, self.goals = list(cuts), list(goals)
        self.n = len(self.model.variables)
        self.bounds = [cut.bound for cut in cuts]
        model = self.model
        names, owner = instance.combinations.names, instance.owners()
        layout = MovingInputs(self.n, owner, tuple(k for k, e in enumerate(model.data_inputs) if not e.required))
        plain = tuple(replace(c, bound=0.0) for c in cuts)

        def contractor(wanted: Sequence[Goal], pivots: tuple[int, ...]) -> Contractor:
            key = ("contractor", layout, plain, tuple(wanted), pivots)
            made: Contractor = model.function(key, lambda: Contractor(model.program, layout, plain, wanted, pivots))
            return made

        # Objectives that only settle ties would cost time where others are sought.
        wanted = {False: goals[:bounded], True: goals}
        self._contractors = {every: contractor(own, ()) for every, own in wanted.items()}
        self._read = self._data_read()
        self.factors = [self._factor(f, name, owner) for f, name in enumerate(names)]
        self._constants = dict[bool, list[float]]()
        self._least = dict[int, float]()
        for every, c in self._contractors.items():
            values = c.constant_values(self._inputs(owner))
            self._constants[every] = [float(np.asarray(v).ravel()[0]) for v in values]
        places = range(len(names))
        per_row = {every: [self._values_of_tables(c, f) for f in places] for every, c in self._contractors.items()}
        every_row = {every: ChainMap(*own) for every, own in per_row.items()}
        for rows in every_row.values():
            for node, v in rows.items():
                known = v[~np.isnan(v)]
                self._least[node] = float(known.min()) if len(known) else np.nan
        # Objectives that only settle ties cut nothing off: what holds over the whole question is the same without them.
        ordered = [every_row[True][node] for node in self._contractors[True].tables]
        hull = (np.array([np.min(v) for v in ordered]), np.array([np.max(v) for v in ordered]))
        self._root = self._contractors[True].root(
            instance.lower, instance.upper, hull, self._constants[True], self.bounds
        )
        # What seems to matter to nothing must be split some day as well, or a box could be split for ever elsewhere.
        self._floor = self.branching.least_in_conflict if conflict else self.branching.least
        self.empty = self._root.empty
        self.pivots = self._pivots(conflict)
        if self.pivots:
            self._contractors = {every: contractor(own, self.pivots) for every, own in wanted.items()}
        self.width = self.n + len(self.pivots)
        ends = [self._ends_of_variable(i) for i in range(self.n)] + [self.range_of(k) for k in self.pivots]
        self.low, self.high = np.array([a for a, _ in ends]), np.array([b for _, b in ends])
        self.positive = self.low > 0
        self.grids = [*instance.grids(), *(np.empty(0) for _ in self.pivots)]
        self._range = np.maximum(self.high - self.low, 1e-300)
        self._codes: dict[tuple[bool, bool], Code] = {}
        self._bits = bounded if bounded <= self.branching.most_bits else 0
        self._anywhere = self._influences()
        self.cells = Cells([self._tree(f) for f in self.factors], instance.combinations.radix)
        self._ends_of = {
            every: [self._tables_of(c, f, per_row[every][f]) for f in places] for every, c in self._contractors.items()
        }
        self._begin()

    def among(self, instance: Instance) -> Propagation | None:
        """Return the same for other rows of the first factor: what holds over all rows here is not sought again.

        Parameters
        ----------
        instance : Instance
            Like that of this propagation but for the first factor.

        Returns
        -------
        Propagation, optional
            None where rows do not lie within those known here, or where something else is not the same.
        """
        own, owner = copy.copy(self), instance.owners()
        own.instance = instance
        if owner != self.instance.owners() or not np.array_equal(own._fixed(owner), self._fixed(owner), equal_nan=True):
            return None
        first = own._factor(0, instance.combinations.names[0], owner)
        read, known = first.columns[:, : len(first.inputs)], self.factors[0].columns
        if not np.all((read >= known.min(axis=0)) & (read <= known.max(axis=0))):
            return None
        own.factors = [first, *self.factors[1:]]
        own.cells = Cells([own._tree(first), *self.cells.trees[1:]], instance.combinations.radix)
        own._ends_of = {
            every: [own._tables_of(c, 0, own._values_of_tables(c, 0)), *self._ends_of[every][1:]]
            for every, c in own._contractors.items()
        }
        own._begin()
        return own

    def _begin(self) -> None:
        """Know nothing yet of where to split but what holds anywhere."""
        self._tables = {every: self._in_order(every) for every in self._contractors}
        self._influence = self._anywhere
        self._spreads = [self._spread(tree) for tree in self.cells.trees]
        self._steep = self._steep_of_moving()
        self._learned = np.zeros((1 << self._bits, len(self.cuts) + len(self.goals)))
        self._lessons = np.zeros(1 << self._bits, dtype=np.int64)
        self._importance = np.zeros(1 << self._bits)
        self.weights = self._weights()
        self._prepared: dict[bool, Prepared] = {}
        self._contracted: Counter[tuple[bool, bool]] = Counter()
        self._halved: Halves | None = None

    def _tree(self, factor: Factor) -> ClusterTree:
        weights = self._anywhere.sum(axis=0)[[self.n + i for i in factor.inputs]]
        return ClusterTree(factor, np.concatenate([weights, np.ones(len(factor.capped))]))

    def _fixed(self, owner: Sequence[int]) -> list[float]:
        """Return the data that belong to no factor."""
        return [v for v, own in zip(self._one_data(), owner, strict=True) if own < 0]

    def _inputs(self, owner: Sequence[int]) -> list[Any]:
        """Return what the program reads where only requirements are known."""
        data = self._one_data()
        return [None] * self.n + [np.nan if owner[k] >= 0 else v for k, v in enumerate(data)]

    def _one_data(self) -> list[float]:
        return [float(np.asarray(x).ravel()[0]) for x in self.instance.data(np.zeros(1, dtype=np.int64))]

    def _pivots(self, conflict: bool) -> tuple[int, ...]:
        """Return inner nodes that boxes carry and split as if they were variables.

        What a special function reads of many variables and parts at once, a torque for instance, is blurred by all of
        them although the objective sees that one number alone. Where only limits see it the blur costs less than
        carrying it, unless nothing is feasible: then limits are all that there is.
        """
        program, contractor, root = self.model.program, self._contractors[False], self._root
        order = set(contractor.order)
        seen = contractor.order if conflict else program.needed([g.node for g in contractor.goals])
        readers = [program.nodes[k] for k in contractor.order if program.nodes[k].op == OP_SPECIAL]
        read = {a for k in seen if program.nodes[k].op == OP_SPECIAL for a in program.nodes[k].args}
        count = Counter(a for node in readers for a in set(node.args) if a in read)
        moving = [program.dependence([i]) for i in range(self.n)]
        result = []
        for k, _ in count.most_common():
            inner = k in order and contractor.kind[k] == INNER and contractor.narrows[k]
            bounded = root.low[k] > 0 and bool(np.isfinite(root.high[k]))
            if inner and bounded and sum(bool(marked[k]) for marked in moving) >= self.branching.pivot_of:
                result.append(k)
        return () if self.empty else tuple(sorted(result[: self.branching.most_pivots]))

    def _ends_of_variable(self, position: int) -> tuple[float, float]:
        low, high = float(self.instance.lower[position]), float(self.instance.upper[position])
        node, root = self.model.program.input_nodes[position], self._root
        if node in self._contractors[True].order and not self.empty:
            low, high = max(low, float(root.low[node])), min(high, float(root.high[node]))
        return min(low, high), high

    def _data_read(self) -> set[int]:
        """Return the numbers of the data inputs that limits, objectives or refusals depend on."""
        instance, model = self.instance, self.model
        wanted = [k for c in self.cuts for k in (c.value, c.limit) if k is not None] + [g.node for g in self.goals]
        needed = set(model.program.needed(wanted)) if wanted else set()
        read = {k for k, node in enumerate(model.program.input_nodes[self.n :]) if node in needed}
        for refusal in instance.joint_refusals:
            symbols = model.function(("symbols", id(refusal)), partial(_symbols, refusal.when, model.calls))
            read |= {k for k, e in enumerate(model.data_inputs) if str(e.sx) in symbols}
        return read

    def _factor(self, f: int, name: str, owner: Sequence[int]) -> Factor:
        """Return a factor with the numbers of its rows that anything depends on."""
        instance = self.instance
        inputs, caps = tuple(k for k, own in enumerate(owner) if own == f and k in self._read), instance.caps(f)
        columns = np.empty((instance.combinations.radix[f], len(inputs) + len(caps)))
        for position, column in enumerate([*(instance.column(k) for k in inputs), *caps.values()]):
            columns[:, position] = column
        return Factor(name, inputs, columns, tuple(caps))

    def _values_of_tables(self, contractor: Contractor, f: int) -> dict[int, np.ndarray]:
        """Return every node that is tabulated by one factor, per row of it."""
        factor = self.factors[f]
        inputs: list[Any] = [None] * self.n + self._one_data()
        for position, k in enumerate(factor.inputs):
            inputs[self.n + k] = factor.columns[:, position]
        with np.errstate(all="ignore"):
            values = contractor.tabulate(inputs)
        return {
            node: np.broadcast_to(np.asarray(v, dtype=float), (self.instance.combinations.radix[f],))
            for node, v in zip(contractor.tables, values, strict=True)
            if contractor.factor[node] == f
        }

    def _tables_of(
        self, contractor: Contractor, f: int, per_row: Mapping[int, np.ndarray]
    ) -> dict[int, tuple[np.ndarray, np.ndarray]]:
        """Return the ends per cluster of the nodes that are tabulated by one factor."""
        if not per_row:
            return {}
        nodes, root = list(per_row), self._root
        low, high = self.cells.trees[f].hull(np.stack([per_row[k] for k in nodes], axis=1))
        result = {}
        for column, node in enumerate(nodes):
            # What the whole question excludes is cut off, so that signs settled there hold for every cluster.
            ends = np.fmax(low[:, column], root.low[node]), np.fmin(high[:, column], root.high[node])
            result[node] = np.ascontiguousarray(ends[0]), np.ascontiguousarray(ends[1])
        return result

    def _in_order(self, every: bool) -> list[tuple[int, np.ndarray, np.ndarray]]:
        """Return, per tabulated node in the order of the contractor, its factor and its ends per cluster."""
        ends = {node: (f, *pair) for f, own in enumerate(self._ends_of[every]) for node, pair in own.items()}
        return [ends[node] for node in self._contractors[every].tables]

    def _spread(self, tree: ClusterTree) -> np.ndarray:
        """Return how far limits and objectives spread over each cluster (clusters, limits + objectives)."""
        factor = tree.factor
        low, high = tree.hull(factor.columns) if factor.columns.size else (np.zeros((len(tree), 0)),) * 2
        with np.errstate(all="ignore"):
            width = np.where(low > 0, np.log(high / low), high - low)
        width = np.where(np.isnan(width), np.where(tree.leaf, 0.0, 1.0)[:, None], width)
        # A cap is as far off as the objective that it caps.
        capped = np.eye(len(self._influence))[:, [len(self.cuts) + g for g in factor.capped]]
        own = np.concatenate([self._influence[:, [self.n + i for i in factor.inputs]], capped], axis=1)
        first = self.branching.parts_first if factor.name else self.branching.questions_first
        result: np.ndarray = (first * width @ own.T).astype(np.float32)
        # Rows that differ only in what has no influence are still different rows.
        result += np.where(tree.leaf, 0.0, self._floor)[:, None].astype(np.float32)
        return result

    def _influences(self) -> np.ndarray:
        """Return how steep each limit and objective is in each input, (limits + objectives, inputs), as logarithms.

        A median over random points; it only decides where boxes are split, never what is excluded.
        """
        n, samples = self.n, self.branching.samples
        rng = np.random.default_rng(0)
        share, low, high = rng.random((samples, n)), self.low[:n], self.high[:n]
        with np.errstate(all="ignore"):
            ratio = low * (high / low) ** share
        points = np.where(self.positive[:n], ratio, low + share * (high - low))
        numbers = [rng.integers(size, size=samples) for size in self.instance.combinations.radix]
        data = [np.full(samples, v) for v in self._one_data()]
        for digits, factor in zip(numbers, self.factors, strict=True):
            for position, k in enumerate(factor.inputs):
                data[k] = factor.columns[digits, position]
        inputs = [points[:, i] for i in range(n)] + data
        self._relative = [bool(np.all(x > 0)) for x in inputs]
        self._reach = [float(np.ptp(x)) for x in inputs]
        result, self.goal_sizes = self._steepness(inputs)
        return result

    def focus(self, variables: np.ndarray, combinations: np.ndarray) -> None:
        """Measure influences at some designs: what matters there counts more than what matters anywhere.

        Like all influences these decide where boxes are split, never what is excluded.
        """
        data = self.instance.data(combinations)
        data = [np.broadcast_to(np.asarray(x, dtype=float), (len(variables),)) for x in data]
        near, _ = self._steepness([variables[:, i] for i in range(self.n)] + data)
        self._influence = np.maximum(near, self.branching.anywhere * self._anywhere)
        self._spreads = [self._spread(tree) for tree in self.cells.trees]
        self._steep = self._steep_of_moving()
        self._prepared.clear()

    def _steep_of_moving(self) -> np.ndarray:
        """Return the influences of variables and pivots."""
        first_pivot = self._influence.shape[1] - len(self.pivots)
        moving = np.concatenate([self._influence[:, : self.n], self._influence[:, first_pivot:]], axis=1)
        steep: np.ndarray = np.maximum(moving, self._floor).astype(np.float32)
        return steep

    def _steepness(self, inputs: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return the influences as medians over some designs, and the sizes of the objectives there.

        Parameters
        ----------
        inputs : list of array (designs,)
            Variables and data.
        """
        program, n, count, step_size = self.model.program, self.n, len(inputs[0]), self.branching.step
        nodes = [k for c in self.cuts for k in (c.value, c.limit) if k is not None] + [g.node for g in self.goals]
        moving = list(range(n)) + [n + k for f in self.factors for k in f.inputs]
        pivoted = program.with_inputs(self.pivots)
        evaluate = self.model.function(("influence", tuple(nodes), self.pivots), lambda: pivoted.compile(nodes))
        at_pivots = self.model.function(("pivots", self.pivots), lambda: program.compile(self.pivots))
        with np.errstate(all="ignore"):
            inputs = inputs + [np.broadcast_to(np.asarray(v, dtype=float), (count,)) for v in at_pivots(inputs)]
        moving += range(len(inputs) - len(self.pivots), len(inputs))
        result = np.zeros((len(self.cuts) + len(self.goals), len(inputs)))
        scales = np.ones(len(moving))
        # The points as they are, and with one input after the other a little larger: all in one evaluation.
        moved = [np.tile(x, (1 + len(moving), 1)) for x in inputs]
        relative = [*self._relative, *(True for _ in self.pivots)]
        for row, i in enumerate(moving):
            step = inputs[i] * step_size if relative[i] else np.full(count, step_size * self._reach[i])
            # Variables are measured as widths() does, columns as clusters do.
            scales[row] = step_size if relative[i] or i < n else step[0]
            moved[i][1 + row] += step
        with np.errstate(all="ignore"):
            values = [np.broadcast_to(np.asarray(v, dtype=float), moved[0].shape) for v in evaluate(moved)]
            goals = np.array([np.abs(v[0]) for v in values[len(nodes) - len(self.goals) :]]).reshape(-1, count)
            sizes = _medians(np.where(goals > 0, goals, np.nan))
            changed = np.array([size[1:] - size[0] for size in self._sizes(values)])
            if changed.size:
                steep = _medians(np.abs(changed) / scales[:, None])
                result[:, moving] = np.minimum(steep, self.branching.largest_influence)
        return result, np.where(sizes > 0, sizes, 1.0)

    def _sizes(self, values: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Return limits as log(value/limit) and objectives as logarithms, or as scaled differences."""
        sides = iter(values)
        result = []
        for cut in self.cuts:
            value = next(sides)
            limit = np.full(value.shape, cut.bound) if cut.limit is None else next(sides)
            size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), cut.scale)
            result.append(np.where((value > 0) & (limit > 0), np.log(value / limit), (value - limit) / size))
        for _ in self.goals:
            value = next(sides)
            size = _medians(np.abs(value))[:, None]
            result.append(np.where(value > 0, np.log(value), value / np.where(size > 0, size, 1.0)))
        return result

    def surely_positive(self, node: int) -> bool:
        """Tell whether a node is positive wherever a design is feasible (rows without a value do not count)."""
        root = self._root
        return bool(root.low[node] > 0 or self._least.get(node, 0.0) > 0)

    def range_of(self, node: int) -> tuple[float, float]:
        """Return what is known of a node over the whole question."""
        root = self._root
        return float(root.low[node]), float(root.high[node])

    def run(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        caps: Sequence[np.ndarray] | None,
        passes: int,
        every: bool,
    ) -> Propagated:
        """Tighten boxes.

        Parameters
        ----------
        cell : array (boxes, factors)
            A cluster per factor.
        low, high : array (boxes, variables)
        caps : list of arrays (boxes,) or numbers, optional
            Upper bounds of the objectives, with their sign.
        passes : int
            Forward-backward sweeps.
        every : bool
            Whether objectives that only settle ties count.
        """
        count = len(cell)
        function = self._code(every, caps is not None).function(self._root)
        variables = [(low[:, i], high[:, i]) for i in range(self.width)]
        tables = [(a.take(cell[:, f]), b.take(cell[:, f])) for f, a, b in self._tables[every]]
        root = self._root
        with np.errstate(all="ignore"):
            dead, goals, opens = function(
                variables, tables, self._constants[every], self.bounds, caps, root.low, root.high, passes, count
            )
        a, b = np.empty((count, self.width)), np.empty((count, self.width))
        for i, (x, y) in enumerate(variables):
            a[:, i], b[:, i] = x, y
        return Propagated(~dead, a, b, goals, opens)

    def _code(self, every: bool, capped: bool) -> Code:
        key = (every, capped)
        if key not in self._codes:
            self._codes[key] = self._contractors[every].code(self._root, capped)
        return self._codes[key]

    def packed(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: np.ndarray | None,
        passes: int,
        every: bool,
        margins: tuple[float, float],
        workers: int = 1,
    ) -> Packed | None:
        """Tighten, snap and score boxes by compiled code, and pack what is alive; None where there is none.

        Parameters
        ----------
        cell, low, high, bounds, tag : array (boxes, ...)
        caps : array (objectives,) or (boxes, objectives), optional
        passes : int
        every : bool
        margins : (float, float)
            By how much a value may miss the grid, relative and absolute.
        workers : int
            Threads.
        """
        code = self._compiled_code(every, caps is not None, len(cell))
        if code is None:
            return None
        prepared = self._prepared_for(every, margins)
        return code.contract(prepared, cell, low, high, bounds, tag, caps, self.weights, passes, workers)

    def grown(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        bounds: np.ndarray,
        tag: np.ndarray,
        caps: CapTables,
        passes: int,
        levels: int,
        margins: tuple[float, float],
        workers: int = 1,
    ) -> Grown | None:
        """Tighten and split boxes for some generations by compiled code; None where there is none.

        Parameters
        ----------
        cell, low, high, bounds, tag, passes, margins, workers
            As for :meth:`packed`, for the objectives that are bounded in every box.
        caps : CapTables
        levels : int
            Generations.
        """
        code = self._compiled_code(False, True, 0)
        if code is None:
            return None
        prepared = self._prepared_for(False, margins)
        found = code.grow(
            prepared, self._halves, cell, low, high, bounds, tag, caps, self.weights, passes, levels, workers
        )
        self._contracted[False, True] += found.contracted
        return found

    def _compiled_code(self, every: bool, capped: bool, boxes: int) -> BoxCode | None:
        """Return the code for so many boxes more, if they are worth compiling."""
        if not self._to_compile(every, capped, boxes):
            return None
        return compiled(self._code(every, capped), self.compiling.effort)

    def _prepared_for(self, every: bool, margins: tuple[float, float]) -> Prepared:
        if every not in self._prepared:
            self._prepared[every] = Prepared(self._contractors[every], self._question(every, margins))
        return self._prepared[every]

    @property
    def _halves(self) -> Halves:
        if self._halved is None:
            trees = self.cells.trees
            ranges = np.concatenate([self.instance.upper - self.instance.lower, np.zeros(len(self.pivots))])
            self._halved = Halves([t.left for t in trees], [t.right for t in trees], ranges)
        return self._halved

    @property
    def compiled_at_once(self) -> bool:
        """Tell whether code for capped boxes is compiled from the first: by the question alone."""
        return self._compiled and self.instance.combinations.count * self._alike >= self.compiling.combinations

    def _to_compile(self, every: bool, capped: bool, boxes: int) -> bool:
        """Tell whether code is to be compiled for so many boxes more."""
        self._contracted[every, capped] += boxes
        many = self._compiled and self._contracted[every, capped] > self.compiling.boxes
        return many or (self.compiled_at_once and capped and not every)

    def _question(self, every: bool, margins: tuple[float, float]) -> CompiledQuestion:
        instance = self.instance
        return CompiledQuestion(
            tables=self._tables[every],
            constants=np.array(self._constants[every]),
            rights=np.array(self.bounds),
            root=self._root,
            lower=np.concatenate([instance.lower, self.low[self.n :]]),
            upper=np.concatenate([instance.upper, self.high[self.n :]]),
            spans=np.where(self.positive, 0.0, self._range),
            steep=self._steep,
            spreads=self._spreads,
            grids=self.grids,
            margins=margins,
            sizes=self.compiling.sizes,
        )

    def scores(
        self,
        cell: np.ndarray,
        low: np.ndarray,
        high: np.ndarray,
        opens: Sequence[Any],
        goals: int,
        caps: np.ndarray | None = None,
    ) -> np.ndarray:
        """Return, per variable and factor, how far limits that are undecided and objectives spread over it."""
        count, limits = len(cell), len(self.cuts)
        counted = np.zeros((count, limits + len(self.goals)), dtype=np.float32)
        for j, flag in enumerate(opens):
            counted[:, j] = flag
        counted[:, limits : limits + goals] = 1.0
        counted *= self.weights[0 if caps is None else self._pattern(np.isfinite(caps[..., : self._bits]))]
        result = np.zeros((count, self.width + len(self.factors)), dtype=np.float32)
        if self.width:
            result[:, : self.width] = (counted @ self._steep) * self.widths(low, high)
        for f, spread in enumerate(self._spreads):
            result[:, self.width + f] = np.einsum("bj,bj->b", counted, spread.take(cell[:, f], axis=0))
        return result

    def learn(self, multipliers: np.ndarray, importance: np.ndarray) -> None:
        """Take multipliers of solved problems (problems, limits + objectives): where they are large, boxes are split.

        What blurs a bound is, to first order, the spread of every limit times its multiplier. It steers the
        search and proves nothing. ``importance`` (problems,) tells how much each problem counts.
        """
        sizes = np.abs(multipliers)
        total = sizes.sum(axis=1)
        good = np.isfinite(total) & (total > 0)
        if not good.any():
            return
        shares = sizes[good] / total[good, None]
        first = len(self.cuts)
        own = shares[:, first : first + self._bits]
        pattern = self._pattern(own > self.branching.some * own.sum(axis=1, keepdims=True))
        np.add.at(self._learned, pattern, importance[good, None] * shares)
        np.add.at(self._importance, pattern, importance[good])
        np.add.at(self._lessons, pattern, 1)
        self.weights = self._weights()

    @property
    def taught(self) -> int:
        """Return how many solved problems were learned from."""
        return int(self._lessons.sum())

    def lessons(self) -> Lessons:
        """Return what was learned so far."""
        return Lessons(self._learned.copy(), self._importance.copy(), self._lessons.copy())

    def taught_by(self, lessons: Lessons) -> bool:
        """Take what was learned for the same limits and objectives; tell whether they are the same in number."""
        if lessons.learned.shape != self._learned.shape:
            return False
        self._learned, self._importance = lessons.learned.copy(), lessons.importance.copy()
        self._lessons = lessons.count.copy()
        self.weights = self._weights()
        return True

    def _pattern(self, objectives: np.ndarray) -> np.ndarray:
        """Return the number of each set of objectives (..., bits)."""
        return np.asarray(objectives @ (1 << np.arange(self._bits)), dtype=np.int64)

    def _weights(self) -> np.ndarray:
        """Return the weights of limits and objectives, per set of objectives that are capped.

        An objective without a cap decides nothing, unless none has one.
        """
        first = len(self.cuts)
        result = np.ones(self._learned.shape)
        if self._lessons.any():
            result[:] = self._learned.sum(axis=0) / self._importance.sum()
            own = self._lessons >= self.branching.enough
            result[own] = self._learned[own] / self._importance[own, None]
            result += self._floor
        for pattern in range(1, len(result)):
            idle = [k for k in range(self._bits) if not pattern >> k & 1]
            result[pattern, [first + k for k in idle]] = 0.0
        return result.astype(np.float32)

    def widths(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Return widths of boxes on the scale of the influences."""
        with np.errstate(all="ignore"):
            result: np.ndarray = np.where(self.positive, np.log(high / low), (high - low) / self._range)
        return result


def _medians(values: np.ndarray) -> np.ndarray:
    """Return the median of what is finite in each row, 0 where nothing is."""
    ordered = np.sort(np.where(np.isfinite(values), values, np.nan), axis=-1)
    count = np.isfinite(ordered).sum(axis=-1, keepdims=True)
    middle = [np.take_along_axis(ordered, np.maximum(k, 0), axis=-1) for k in ((count - 1) // 2, count // 2)]
    with np.errstate(all="ignore"):
        result: np.ndarray = np.where(count > 0, 0.5 * (middle[0] + middle[1]), 0.0)[..., 0]
    return result


def _symbols(expression: Any, calls: Sequence[SpecialCall]) -> set[str]:
    """Return the symbols that an expression reads, special functions written out."""
    return {str(s) for s in ca.symvar(expanded(expression, calls))}
