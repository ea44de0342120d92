"""Interval propagation over a whole question, node by node: what holds for every box of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.bounds.intervals import BACKWARD, FORWARD, ROUNDING, Interval, loosened, whole
from synth.bounds.propagated_nodes import PropagatedNodes
from synth.bounds.statements import special_range
from synth.model.constraint import NodeConstraint
from synth.model.program import OP_SPECIAL, Node, Program

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
    low, high : array (variables,)
    tables : pair of arrays (tables,)
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
    """Return what holds of every node over the hull of everything."""
    with np.errstate(all="ignore"):
        return _RootPropagation(nodes, leaves).root


def forward_of(program: Program, node: Node, args: Sequence[Interval]) -> Interval:
    """Return the interval of a node from those of its arguments."""
    if node.op == OP_SPECIAL:
        return special_range(program.specials[int(node.constant)], args)
    forward = FORWARD.get(node.op)
    return forward(*args) if forward else whole(*args)


class _RootPropagation:
    """Ends ``a`` and ``b`` of all nodes, tightened sweep by sweep."""

    def __init__(self, nodes: PropagatedNodes, leaves: Leaves) -> None:
        self.nodes, self.program, self.right_sides = nodes, nodes.program, leaves.right_sides
        n = len(self.program.nodes)
        self.a, self.b = np.full(n, -np.inf), np.full(n, np.inf)
        for k, value in zip(nodes.constants, leaves.constants, strict=True):
            self.a[k] = self.b[k] = value
        for k, x, y in zip(nodes.tables, *leaves.tables, strict=True):
            self.a[k], self.b[k] = x, y
        for k in nodes.variables:
            self.a[k], self.b[k] = leaves.low[nodes.position(k)], leaves.high[nodes.position(k)]
        self.empty, self.narrowed = False, np.zeros(n, dtype=bool)
        self.root = self._tightened()

    def _tightened(self) -> Root:
        for sweep in range(SWEEPS):
            for k in self.nodes.inner:
                self._forward(k, sweep > 0)
            if sweep == SWEEPS - 1:
                break
            for constraint, constant in zip(self.nodes.constraints, self.right_sides, strict=True):
                self._cut(constraint, constant)
            for k in reversed(self.nodes.inner):
                self._backward(k)
        a, b = self.a, self.b
        empty = self.empty or bool(np.any(a > b + ROUNDING * np.abs(b)))
        return Root(np.where(a > b, b, a), b, self.narrowed, empty)

    def _forward(self, k: int, later: bool) -> None:
        node, a, b = self.program.nodes[k], self.a, self.b
        low, high = forward_of(self.program, node, [(np.float64(a[j]), np.float64(b[j])) for j in node.args])
        natural = float(low), float(high)
        if later:
            self.narrowed[k] = bool(a[k] > natural[0]) or bool(b[k] < natural[1])
            natural = float(np.fmax(a[k], natural[0])), float(np.fmin(b[k], natural[1]))
        a[k], b[k] = natural

    def _backward(self, k: int) -> None:
        node, a, b = self.program.nodes[k], self.a, self.b
        backward = BACKWARD.get(node.op)
        if backward is None:
            return
        args = [(np.float64(a[j]), np.float64(b[j])) for j in node.args]
        for j, bound in zip(node.args, backward((np.float64(a[k]), np.float64(b[k])), *args), strict=True):
            if bound is not None:
                self._narrow(j, *bound)

    def _cut(self, constraint: NodeConstraint, constant: float) -> None:
        a, b, v, w = self.a, self.b, constraint.value, constraint.limit
        low, high = (constant, constant) if w is None else (a[w], b[w])
        if constraint.sense in ("at_most", "equal"):
            top, bottom = loosened(high, constraint.scale, +1), loosened(a[v], constraint.scale, -1)
            self.empty |= bool(a[v] > top)
            self._narrow(v, -np.inf, top)
            if w is not None:
                self._narrow(w, bottom, np.inf)
        if constraint.sense in ("at_least", "equal"):
            bottom, top = loosened(low, constraint.scale, -1), loosened(b[v], constraint.scale, +1)
            self.empty |= bool(b[v] < bottom)
            self._narrow(v, bottom, np.inf)
            if w is not None:
                self._narrow(w, -np.inf, top)

    def _narrow(self, k: int, low: float, high: float) -> None:
        if self.nodes.narrows[k]:
            self.a[k], self.b[k] = np.fmax(self.a[k], low), np.fmin(self.b[k], high)
