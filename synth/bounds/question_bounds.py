"""What holds over all boxes of a question: its constants, the values of table rows, an interval for every node.

Everything here is sound: it excludes nothing that a feasible design could have.
"""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.clusters import Factor
from synth.bounds.contractor import Contractor
from synth.bounds.propagated_nodes import INNER, MovingInputs, PropagatedNodes
from synth.bounds.root_propagation import Leaves, Root, propagated_root
from synth.bounds.settings import BranchingSettings
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import OP_SPECIAL
from synth.question.search_space import SearchSpace
from synth.special import SpecialCall, expanded


class QuestionBounds:
    """Bounds over a whole question, and what the propagation of its boxes starts from.

    What depends on whether objectives that only settle ties count is held twice, by ``every``: with all of them (True)
    and with the bounded ones alone (False), as ties would cost time where nothing is asked of them.

    Parameters
    ----------
    instance : SearchSpace
    constraints : list of NodeConstraint
        Limits, with the constant right sides of this question.
    goals : list of Goal
        Objectives: those to trade off first.
    bounded : int
        How many objectives, from the first, are bounded in every box.
    infeasibility : bool
        Nothing feasible is known: auxiliary variables are sought in limits as well as in objectives.
    settings : BranchingSettings
        How many auxiliary variables there may be.

    Attributes
    ----------
    contractors : dict of Contractor
    constants : dict of list of float
        Values of the constant nodes, in the order of the contractor.
    factors : list of Factor
    row_values : list of dict
        Per factor: the nodes that it alone decides, with their value per row.
    root : Root
        An interval of every node.
    auxiliary : tuple of int
        Nodes that boxes carry and split as if they were variables.
    low, high : array (width,)
        Ranges of the variables and of the auxiliary variables after them.
    grids : list of array
        Makeable values of each; empty where it is continuous.
    """

    def __init__(
        self,
        instance: SearchSpace,
        constraints: Sequence[NodeConstraint],
        goals: Sequence[Goal],
        bounded: int,
        infeasibility: bool,
        settings: BranchingSettings,
    ) -> None:
        self.instance, self.model = instance, instance.model
        self.constraints, self.goals, self.bounded = list(constraints), list(goals), bounded
        self.infeasibility = infeasibility
        self.right_sides = [constraint.bound for constraint in constraints]
        self.n = len(self.model.variables)
        owner = instance.owners()
        self.contractors = self._contractors(owner, ())
        self._read = self._data_read()
        self.factors = [self._factor(f, name, owner) for f, name in enumerate(instance.combinations.names)]
        self.constants = self._constants(owner)
        self.row_values = [self._values_of_rows(f) for f in range(len(self.factors))]
        values = {node: v for of_factor in self.row_values for node, v in of_factor.items()}
        self._least_known = {node: _least_known(v) for node, v in values.items()}
        self.root = self._root([values[node] for node in self.contractors[True].nodes.tables])
        self.auxiliary = () if self.root.empty else self._auxiliary(settings)
        if self.auxiliary:
            self.contractors = self._contractors(owner, self.auxiliary)
        self.width = self.n + len(self.auxiliary)
        ends = [self._range_of_variable(i) for i in range(self.n)] + [self.range_of(k) for k in self.auxiliary]
        self.low, self.high = np.array([a for a, _ in ends]), np.array([b for _, b in ends])
        self.positive = self.low > 0
        self.grids = [*instance.ranges.grids(), *(np.empty(0) for _ in self.auxiliary)]

    def among(self, instance: SearchSpace) -> QuestionBounds | None:
        """Bounds for other rows of the first factor, which reuse what holds for every row.

        Parameters
        ----------
        instance : SearchSpace
            Like that of this question but for the first factor.

        Returns
        -------
        QuestionBounds, optional
            None where rows do not lie within those known here, or where something else is not the same.
        """
        new, owner = copy.copy(self), instance.owners()
        new.instance = instance
        if owner != self.instance.owners() or not np.array_equal(new._fixed(owner), self._fixed(owner), equal_nan=True):
            return None
        first = new._factor(0, instance.combinations.names[0], owner)
        read, known = first.columns[:, : len(first.inputs)], self.factors[0].columns
        if not np.all((read >= known.min(axis=0)) & (read <= known.max(axis=0))):
            return None
        new.factors = [first, *self.factors[1:]]
        new.row_values = [new._values_of_rows(0), *self.row_values[1:]]
        return new

    def surely_positive(self, node: int) -> bool:
        """True if a node is positive wherever a design is feasible (rows without a value do not count)."""
        return bool(self.root.low[node] > 0 or self._least_known.get(node, 0.0) > 0)

    def range_of(self, node: int) -> tuple[float, float]:
        """Range of a node over the whole question."""
        return float(self.root.low[node]), float(self.root.high[node])

    def first_data(self) -> list[float]:
        """Return the data of the first combination: of no factor, they are those of all combinations."""
        return [float(np.asarray(x).ravel()[0]) for x in self.instance.data(np.zeros(1, dtype=np.int64))]

    def sides(self) -> list[int]:
        """Return the nodes of both sides of all limits and of all objectives, as far as there are any."""
        return [k for c in self.constraints for k in (c.value, c.limit) if k is not None] + [g.node for g in self.goals]

    # -- preparation ---------------------------------------------------------------------------

    def _contractors(self, owner: Sequence[int], auxiliary: tuple[int, ...]) -> dict[bool, Contractor]:
        model = self.model
        optional = tuple(k for k, e in enumerate(model.data_inputs) if not e.required)
        layout = MovingInputs(self.n, tuple(owner), optional)
        plain = tuple(replace(c, bound=0.0) for c in self.constraints)

        def contractor(goals: Sequence[Goal]) -> Contractor:
            made: Contractor = model.function(
                ("contractor", layout, plain, tuple(goals), auxiliary),
                lambda: Contractor(PropagatedNodes(model.program, layout, plain, goals, auxiliary)),
            )
            return made

        return {False: contractor(self.goals[: self.bounded]), True: contractor(self.goals)}

    def _data_read(self) -> set[int]:
        """Numbers of the data inputs that limits, objectives or refusals depend on."""
        instance, model, sides = self.instance, self.model, self.sides()
        needed = set(model.program.needed(sides)) if sides else set()
        read = {k for k, node in enumerate(model.program.input_nodes[self.n :]) if node in needed}
        for refusal in instance.selection.joint_refusals:
            symbols = model.function(("symbols", id(refusal)), partial(_symbols, refusal.when, model.calls))
            read |= {k for k, e in enumerate(model.data_inputs) if str(e.sx) in symbols}
        return read

    def _factor(self, f: int, name: str, owner: Sequence[int]) -> Factor:
        """A factor with the relevant numbers of its rows."""
        instance = self.instance
        inputs = tuple(k for k, factor in enumerate(owner) if factor == f and k in self._read)
        cutoffs = instance.cutoffs if f < instance.scenario_factors else {}
        columns = np.empty((instance.combinations.radix[f], len(inputs) + len(cutoffs)))
        for position, column in enumerate([*(instance.column(k) for k in inputs), *cutoffs.values()]):
            columns[:, position] = column
        return Factor(name, inputs, columns, tuple(cutoffs))

    def _fixed(self, owner: Sequence[int]) -> list[float]:
        """Data that belong to no factor."""
        return [v for v, factor in zip(self.first_data(), owner, strict=True) if factor < 0]

    def _constants(self, owner: Sequence[int]) -> dict[bool, list[float]]:
        # All that is known are requirements: what a factor decides is no number here.
        data = [np.nan if owner[k] >= 0 else v for k, v in enumerate(self.first_data())]
        every = self.contractors[True]
        values = [float(np.asarray(v).ravel()[0]) for v in every.constant_values([None] * self.n + data)]
        known = dict(zip(every.nodes.constants, values, strict=True))
        return {compared: [known[node] for node in c.nodes.constants] for compared, c in self.contractors.items()}

    def _values_of_rows(self, f: int) -> dict[int, np.ndarray]:
        """Return every node that one factor alone decides, per row of it."""
        contractor, factor = self.contractors[True], self.factors[f]
        inputs: list[Any] = [None] * self.n + self.first_data()
        for position, k in enumerate(factor.inputs):
            inputs[self.n + k] = factor.columns[:, position]
        with np.errstate(all="ignore"):
            values = contractor.tabulate(inputs)
        return {
            node: np.broadcast_to(np.asarray(v, dtype=float), (self.instance.combinations.radix[f],))
            for node, v in zip(contractor.nodes.tables, values, strict=True)
            if contractor.nodes.factor[node] == f
        }

    def _root(self, values: Sequence[np.ndarray]) -> Root:
        """Ranges that hold everywhere; objectives that only settle ties cut nothing off, so that they may count."""
        hull = (np.array([np.min(v) for v in values]), np.array([np.max(v) for v in values]))
        ranges = self.instance.ranges
        leaves = Leaves(ranges.lower, ranges.upper, hull, self.constants[True], self.right_sides)
        return propagated_root(self.contractors[True].nodes, leaves)

    def _auxiliary(self, settings: BranchingSettings) -> tuple[int, ...]:
        """Return the nodes to carry as auxiliary variables.

        What a special function reads of many variables and parts at once, a torque for instance, is blurred by all of
        them although the objective sees that one number alone. Where only limits see it the blur costs less than
        carrying it, unless nothing is feasible: then limits are all that there is. Which nodes are chosen is a matter
        of speed: bounds hold with any of them.
        """
        program, nodes, root = self.model.program, self.contractors[False].nodes, self.root
        order = set(nodes.order)
        seen = nodes.order if self.infeasibility else program.needed([g.node for g in nodes.goals])
        readers = [program.nodes[k] for k in nodes.order if program.nodes[k].op == OP_SPECIAL]
        read = {a for k in seen if program.nodes[k].op == OP_SPECIAL for a in program.nodes[k].args}
        count = Counter(a for node in readers for a in set(node.args) if a in read)
        moving = [program.dependence([i]) for i in range(self.n)]
        result = []
        for k, _ in count.most_common():
            inner = k in order and nodes.kind[k] == INNER and nodes.narrows[k]
            bounded = root.low[k] > 0 and bool(np.isfinite(root.high[k]))
            if inner and bounded and sum(bool(marked[k]) for marked in moving) >= settings.auxiliary_of:
                result.append(k)
        return tuple(sorted(result[: settings.most_auxiliary]))

    def _range_of_variable(self, position: int) -> tuple[float, float]:
        low, high = float(self.instance.ranges.lower[position]), float(self.instance.ranges.upper[position])
        node, root = self.model.program.input_nodes[position], self.root
        if node in self.contractors[True].nodes.order and not root.empty:
            low, high = max(low, float(root.low[node])), min(high, float(root.high[node]))
        return min(low, high), high


def _least_known(values: np.ndarray) -> float:
    """Return the least of the rows that have a value; not-a-number where none has."""
    known = values[~np.isnan(values)]
    return float(known.min()) if len(known) else np.nan


def _symbols(expression: ca.SX, calls: Sequence[SpecialCall]) -> set[str]:
    """Return the symbols that an expression reads, special functions written out."""
    return {str(s) for s in ca.symvar(expanded(expression, calls))}
