"""Interval propagation node by node: over a whole question, for what holds in every box of it, or over many boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.intervals import FORWARD, ROUNDING, backward, loosened, special_range
from synth.bounds.propagated_nodes import PropagatedNodes
from synth.model.constraint import NodeConstraint
from synth.model.program import OP_SPECIAL, TRAITS, Node, Program
from synth.operations.enclosures import unbounded
from synth.operations.record import Interval, Trait

SWEEPS = 4  # forward over the whole question, with what limits cut carried back between them


@dataclass(frozen=True)
class Root:
    """What is known of every node over the whole question.

    ``low``, ``high``: intervals; ``narrowed``: nodes of which limits tell more than their arguments do.
    """

    low: np.ndarray
    high: np.ndarray
    narrowed: np.ndarray
    empty: bool


@dataclass(frozen=True)
class Leaves:
    """Where propagation over a whole question starts.

    Parameters
    ----------
    low, high : array (variables,) or (variables, boxes)
    tables : pair of arrays (tables,) or (tables, boxes)
        Least and largest value of every tabulated node.
    constants : list of float
        Values of the constant nodes.
    right_sides : list of float
        Constant right sides of the limits.
    """

    low: np.ndarray
    high: np.ndarray
    tables: tuple[np.ndarray, np.ndarray]
    constants: Sequence[float]
    right_sides: Sequence[float]


def propagated_root(nodes: PropagatedNodes, leaves: Leaves) -> Root:
    """Ranges of every node over the hull of everything."""
    with np.errstate(all="ignore"):
        propagation = _NodePropagation(nodes, leaves)
        propagation.run(SWEEPS)
        return propagation.root


SIGN_KEEPING = {ca.OP_CONST, ca.OP_INPUT} | {op for op, traits in TRAITS.items() if Trait.ROUNDS_WELL in traits}


def forward_of(program: Program, node: Node, args: Sequence[Interval]) -> Interval:
    """Return the interval of a node from those of its arguments."""
    if node.op == OP_SPECIAL:
        return special_range(program.specials[int(node.constant)], args)
    forward = FORWARD.get(node.op)
    return forward(*args) if forward else unbounded(*args)


def propagated_boxes(
    nodes: PropagatedNodes, leaves: Leaves, cutoffs: Sequence[Any], sweeps: int
) -> tuple[list[Any], list[Any], np.ndarray]:
    """Ranges of every node in each of many boxes.

    Parameters
    ----------
    nodes : PropagatedNodes
    leaves : Leaves
        Ends with a column per box; after the variables those of the auxiliary variables.
    cutoffs : list of array (boxes,)
        Upper bounds of the objectives of the nodes, with their sign; infinite where there is none.
    sweeps : int

    Returns
    -------
    tuple
        Lower and upper ends per node, a number or an array (boxes,) each, and which boxes hold nothing feasible.
    """
    with np.errstate(all="ignore"):
        propagation = _NodePropagation(nodes, leaves, cutoffs)
        propagation.run(sweeps)
        return propagation.a, propagation.b, np.broadcast_to(propagation.crossed(), (leaves.low.shape[1],))


class _NodePropagation:
    """Ends ``a`` and ``b`` of all nodes, a number or one for each of many boxes, tightened sweep by sweep."""

    def __init__(self, nodes: PropagatedNodes, leaves: Leaves, cutoffs: Sequence[Any] = ()) -> None:
        self.nodes, self.program, self.right_sides, self.cutoffs = nodes, nodes.program, leaves.right_sides, cutoffs
        n = len(self.program.nodes)
        self.a, self.b = [np.float64(-np.inf)] * n, [np.float64(np.inf)] * n
        for k, value in zip(nodes.constants, leaves.constants, strict=True):
            self.a[k] = self.b[k] = np.float64(value)
        for k, x, y in zip(nodes.tables, *leaves.tables, strict=True):
            self.a[k], self.b[k] = x, y
        for k in nodes.variables:
            self.a[k], self.b[k] = leaves.low[nodes.position(k)], leaves.high[nodes.position(k)]
        carried = zip(
            nodes.auxiliary,
            leaves.low[nodes.layout.n_variables :],
            leaves.high[nodes.layout.n_variables :],
            strict=False,
        )
        self.carried = {k: (low, high) for k, low, high in carried}
        self.empty: Any = False
        self.narrowed = np.zeros(n, dtype=bool)

    def run(self, sweeps: int) -> None:
        """Sweep forward, and back in between."""
        for sweep in range(sweeps):
            for k in self.nodes.inner:
                self._forward(k, sweep > 0)
            if sweep == sweeps - 1:
                break
            for constraint, constant in zip(self.nodes.constraints, self.right_sides, strict=True):
                self._cut(constraint, constant)
            for goal, cutoff in zip(self.nodes.goals, self.cutoffs, strict=False):
                ends = (-np.inf, cutoff) if goal.sign > 0 else (-cutoff, np.inf)
                self._narrow(goal.node, *ends)
            for k in reversed(self.nodes.inner):
                if not self.nodes.sizes[k]:
                    self._backward(k)

    def crossed(self) -> Any:
        """Tell where nothing feasible is left."""
        empty = self.empty
        for a, b in zip(self.a, self.b, strict=True):
            empty = empty | (a > b + ROUNDING * np.abs(b))
        return empty

    @property
    def root(self) -> Root:
        """What is known where there is but one box."""
        a, b = np.array(self.a, dtype=float), np.array(self.b, dtype=float)
        # Code for boxes takes signs that hold here for granted. In a box whose ends are no numbers (a special function
        # beyond its border) a rule that divides or inverts knows nothing, not even the sign, so that it is held.
        blind = [node.op not in SIGN_KEEPING for node in self.program.nodes]
        narrowed = self.narrowed | ((a >= 0) & np.array(blind))
        return Root(np.where(a > b, b, a), b, narrowed, bool(self.crossed()))

    def _forward(self, k: int, later: bool) -> None:
        node, a, b = self.program.nodes[k], self.a, self.b
        low, high = forward_of(self.program, node, [(a[j], b[j]) for j in node.args])
        if k in self.carried:
            low, high = np.fmax(low, self.carried[k][0]), np.fmin(high, self.carried[k][1])
        if later:
            self.narrowed[k] = bool(np.any(a[k] > low) or np.any(b[k] < high))
            low, high = np.fmax(a[k], low), np.fmin(b[k], high)
        # A plain number stays one: rules for powers ask for it.
        a[k], b[k] = (np.float64(x) if np.ndim(x) == 0 else x for x in (low, high))

    def _backward(self, k: int) -> None:
        node, a, b = self.program.nodes[k], self.a, self.b
        contracted = backward(node.op, (a[k], b[k]), [(a[j], b[j]) for j in node.args])
        for j, bound in zip(node.args, contracted, strict=True):
            if bound is not None:
                self._narrow(j, *bound)

    def _cut(self, constraint: NodeConstraint, constant: float) -> None:
        a, b, v, w = self.a, self.b, constraint.value, constraint.limit
        low, high = (constant, constant) if w is None else (a[w], b[w])
        size = constraint.scale if constraint.terms is None else b[constraint.terms]
        more, less = constraint.slack, -constraint.slack
        if constraint.sense in ("at_most", "equal"):
            top, bottom = loosened(high, size, more), loosened(a[v], size, less)
            self.empty = self.empty | (a[v] > top)
            self._narrow(v, -np.inf, top)
            if w is not None:
                self._narrow(w, bottom, np.inf)
        if constraint.sense in ("at_least", "equal"):
            bottom, top = loosened(low, size, less), loosened(b[v], size, more)
            self.empty = self.empty | (b[v] < bottom)
            self._narrow(v, bottom, np.inf)
            if w is not None:
                self._narrow(w, -np.inf, top)

    def _narrow(self, k: int, low: float, high: float) -> None:
        if self.nodes.narrows[k]:
            self.a[k], self.b[k] = np.fmax(self.a[k], low), np.fmin(self.b[k], high)
