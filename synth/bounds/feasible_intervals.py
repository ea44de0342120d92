"""What the limits of a model leave of the intervals of its nodes, without a question: where signs are known."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from synth.bounds.curvature import INF, Ends
from synth.bounds.intervals import FORWARD, ROUNDING, backward, loosened
from synth.model.constraint import Constraint
from synth.model.model import Model
from synth.model.program import OP_SPECIAL, Node, Program
from synth.order.feasibility import SLACK

SWEEPS = 3  # over all limits; more hardly narrow any further


def natural(program: Program, node: Node, ends: Sequence[Ends], low: np.ndarray, high: np.ndarray) -> Ends:
    """Return the interval of a node from those of its arguments; not-a-number is unknown."""
    if node.op == ca.OP_CONST:
        return node.constant, node.constant
    if node.op == ca.OP_INPUT:
        a, b = low[int(node.constant)], high[int(node.constant)]
    else:
        args = [(np.float64(ends[i][0]), np.float64(ends[i][1])) for i in node.args]
        if node.op == OP_SPECIAL:
            a, b = program.specials[int(node.constant)].bounds(args)
        else:
            forward = FORWARD.get(node.op)
            a, b = forward(*args) if forward else (-INF, INF)
    return (-INF if np.isnan(a) else float(a)), (INF if np.isnan(b) else float(b))


class FeasibleIntervals:
    """Intervals of all nodes of a model as far as its limits leave anything.

    Only what limits are made of is narrowed through its formulas: a quantity that no limit reads need not exist.
    Limits that a missing value may make void say nothing. A guard holds strictly: it also tells which nodes are above
    zero and which node is larger than another one. Where nothing is feasible at all the limits say nothing.

    Parameters
    ----------
    model : Model
    low, high : array (inputs,)
        Range of every input of the program.

    Attributes
    ----------
    low, high : list of float
        Per node.
    above_zero : set of int
        Nodes that a guard keeps above zero.
    larger : set of (int, int)
        Pairs of nodes of which guards keep the first above the second.
    """

    def __init__(self, model: Model, low: np.ndarray, high: np.ndarray) -> None:
        self._program, self._inputs = model.program, (low, high)
        self.above_zero = set[int]()
        self.larger = set[tuple[int, int]]()
        natural_ends: list[Ends] = []
        for node in self._program.nodes:
            natural_ends.append(natural(self._program, node, natural_ends, low, high))
        self.low, self.high = [a for a, _ in natural_ends], [b for _, b in natural_ends]
        limits = [x for x in model.constraints if not x.void_without]
        self._read = self._program.needed([k for x in limits for k in x.nodes])
        if not all(self._sweep(limits) for _ in range(SWEEPS)):
            self.low, self.high = [a for a, _ in natural_ends], [b for _, b in natural_ends]
            self.above_zero, self.larger = set(), set()

    def _sweep(self, limits: Sequence[Constraint]) -> bool:
        """Tighten by all limits, backward and forward; tell whether anything is feasible."""
        for limit in limits:
            value, bound = limit.nodes
            if limit.sense in ("at_most", "equal"):
                self._order(value, bound, limit)
            if limit.sense in ("at_least", "equal"):
                self._order(bound, value, limit)
        for k in reversed(self._read):
            self._backward(k)
        ends: list[Ends] = []
        for k, node in enumerate(self._program.nodes):
            a, b = natural(self._program, node, ends, *self._inputs)
            a, b = max(self.low[k], a), min(self.high[k], b)
            if a > b + ROUNDING * abs(b):
                return False
            self.low[k], self.high[k] = min(a, b), max(a, b)  # what crosses by rounding is one number
            ends.append((self.low[k], self.high[k]))
        return True

    def _order(self, small: int, large: int, limit: Constraint) -> None:
        """Carry small <= large over to the intervals of both."""
        size = limit.scale if limit.terms is None else self.high[limit.terms]
        if np.isfinite(self.high[large]):
            self.high[small] = min(self.high[small], float(loosened(self.high[large], size, SLACK)))
        if np.isfinite(self.low[small]):
            self.low[large] = max(self.low[large], float(loosened(self.low[small], size, -SLACK)))
        if limit.guard:
            self.larger.add((large, small))
            if self.low[small] >= 0:
                self.above_zero.add(large)

    def _backward(self, k: int) -> None:
        node = self._program.nodes[k]
        args = [(np.float64(self.low[j]), np.float64(self.high[j])) for j in node.args]
        contracted = backward(node.op, (np.float64(self.low[k]), np.float64(self.high[k])), args)
        for j, bounds in zip(node.args, contracted, strict=True):
            if bounds is not None:
                self.low[j] = float(np.fmax(self.low[j], bounds[0]))
                self.high[j] = float(np.fmin(self.high[j], bounds[1]))
