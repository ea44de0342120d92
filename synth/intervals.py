"""Interval propagation over a traced program: what cannot be feasible, for many boxes at once.

Every node of the program gets an interval per box. Limits cut the intervals of their two sides
(forward), the cuts are carried back to the variables (backward). This is forward-backward bound
tightening on the expression graph (Schichl and Neumaier 2005, "Interval analysis on directed
acyclic graphs for global optimization"). On top of it, derivative intervals tell in which
variables a limit or objective is monotone over a box; its bound is then taken at the best corner,
with a mean-value correction for the variables whose sign is not proven.

Not-a-number stands for "nothing known" and never excludes a box. Intervals are not rounded
outward: limits are loosened by ``SLACK``, which is far above rounding and twice the tolerance of
feasibility.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.program import COMPARISONS, OP_SELECT, OP_SPECIAL, Node, Program

SLACK = 2e-6
ROUNDING = 1e-8
CANCELLATION = 1e-12

Interval = tuple[Any, Any]


# -- forward operations ------------------------------------------------------------------------


def _add(a: Interval, b: Interval) -> Interval:
    return a[0] + b[0], a[1] + b[1]


def _sub(a: Interval, b: Interval) -> Interval:
    return a[0] - b[1], a[1] - b[0]


_least = np.minimum.reduce  # a third of the cost of np.min, which counts at some 10^4 calls per batch


def _surely(values: Any) -> bool:
    """Tell whether no value is negative (not-a-number counts as unknown)."""
    return bool((_least(values) if np.ndim(values) else values) >= 0.0)


def _surely_above(values: Any) -> bool:
    """Tell whether all values are above zero."""
    return bool((_least(values) if np.ndim(values) else values) > 0.0)


def _mul(a: Interval, b: Interval) -> Interval:
    # Zero times infinity gives not-a-number, which stands for nothing known: valid, if less than could be said.
    a_positive, b_positive = _surely(a[0]), _surely(b[0])
    if a_positive and b_positive:
        return a[0] * b[0], a[1] * b[1]
    if b_positive:
        return np.minimum(a[0] * b[0], a[0] * b[1]), np.maximum(a[1] * b[0], a[1] * b[1])
    if a_positive:
        return np.minimum(b[0] * a[0], b[0] * a[1]), np.maximum(b[1] * a[0], b[1] * a[1])
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return np.minimum(np.minimum(p, q), np.minimum(r, s)), np.maximum(np.maximum(p, q), np.maximum(r, s))


def _inv(a: Interval) -> Interval:
    low, high = a
    if _surely_above(low):
        return 1.0 / high, 1.0 / low
    positive, negative = low >= 0, high <= 0
    below = np.where(positive, 1.0 / high, np.where(negative, 1.0 / np.where(high == 0, -0.0, high), -np.inf))
    above = np.where(positive, 1.0 / np.where(low == 0, 0.0, low), np.where(negative, 1.0 / low, np.inf))
    return below, above


def _div(a: Interval, b: Interval) -> Interval:
    return _mul(a, _inv(b))


def _neg(a: Interval) -> Interval:
    return -a[1], -a[0]


def _sq(a: Interval) -> Interval:
    if _surely(a[0]):
        return a[0] * a[0], a[1] * a[1]
    p, q = a[0] * a[0], a[1] * a[1]
    return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(p, q)), np.maximum(p, q)


def _monotone(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    def forward(a: Interval) -> Interval:
        return function(a[0]), function(a[1])

    return forward


def _on_domain(function: Callable[[Any], Any], low: float, high: float) -> Callable[[Interval], Interval]:
    """Return a monotone function on the part of the interval that lies in its domain."""

    def forward(a: Interval) -> Interval:
        return function(np.clip(a[0], low, high)), function(np.clip(a[1], low, high))

    return forward


def _pow(a: Interval, b: Interval) -> Interval:
    exponent = b[0] if b[0] is b[1] or np.all(b[0] == b[1]) else None
    if _surely(a[0]):
        if exponent is not None and np.ndim(exponent) == 0:
            p, q = a[0] ** exponent, a[1] ** exponent
            return (p, q) if exponent >= 0 else (q, p)
        corners = [a[0] ** b[0], a[0] ** b[1], a[1] ** b[0], a[1] ** b[1]]
        return np.minimum.reduce(corners), np.maximum.reduce(corners)
    if exponent is not None and np.ndim(exponent) == 0 and float(exponent).is_integer():
        n = int(exponent)
        if n == 0:
            return np.ones_like(a[0]), np.ones_like(a[1])
        if n > 0:
            p, q = a[0] ** n, a[1] ** n
            if n % 2:
                return p, q
            return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(p, q)), np.maximum(p, q)
        return _inv(_pow(a, (-exponent, -exponent)))
    return _whole(a, b)


def _whole(*parts: Interval) -> Interval:
    size = sum(p[0] for p in parts) * 0.0
    return size - np.inf, size + np.inf


def _abs(a: Interval) -> Interval:
    p, q = np.abs(a[0]), np.abs(a[1])
    return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(p, q)), np.maximum(p, q)


def _periodic(function: Callable[[Any], Any], first_top: float) -> Callable[[Interval], Interval]:
    """Return sine or cosine: tops at ``first_top + 2 k pi``, bottoms half a turn later."""

    def contains(a: Interval, at: float) -> Any:
        return np.floor((a[1] - at) / (2 * np.pi)) >= np.ceil((a[0] - at) / (2 * np.pi))

    def forward(a: Interval) -> Interval:
        p, q = function(a[0]), function(a[1])
        low = np.where(contains(a, first_top + np.pi), -1.0, np.minimum(p, q))
        return low, np.where(contains(a, first_top), 1.0, np.maximum(p, q))

    return forward


def _tan(a: Interval) -> Interval:
    same = np.floor(a[0] / np.pi + 0.5) == np.floor(a[1] / np.pi + 0.5)
    return np.where(same, np.tan(a[0]), -np.inf), np.where(same, np.tan(a[1]), np.inf)


def _cosh(a: Interval) -> Interval:
    b = _abs(a)
    return np.cosh(b[0]), np.cosh(b[1])


def _fmin(a: Interval, b: Interval) -> Interval:
    return np.minimum(a[0], b[0]), np.minimum(a[1], b[1])


def _fmax(a: Interval, b: Interval) -> Interval:
    return np.maximum(a[0], b[0]), np.maximum(a[1], b[1])


def _hypot(a: Interval, b: Interval) -> Interval:
    x, y = _abs(a), _abs(b)
    return np.hypot(x[0], y[0]), np.hypot(x[1], y[1])


def _atan2(a: Interval, b: Interval) -> Interval:
    inside = b[0] > 0  # elsewhere the branch cut makes corners worthless
    ratio = _div(a, b)
    return np.where(inside, np.arctan(ratio[0]), -np.pi), np.where(inside, np.arctan(ratio[1]), np.pi)


def _truth(sure: Any, never: Any) -> Interval:
    """Return 1 where surely true, 0 where surely not, and both where nothing is known."""
    return np.asarray(sure, dtype=float), 1.0 - np.asarray(never, dtype=float)


def _lt(a: Interval, b: Interval) -> Interval:
    return _truth(a[1] < b[0], a[0] >= b[1])


def _le(a: Interval, b: Interval) -> Interval:
    return _truth(a[1] <= b[0], a[0] > b[1])


def _eq(a: Interval, b: Interval) -> Interval:
    sure = (a[0] == a[1]) & (b[0] == b[1]) & (a[0] == b[0])
    return _truth(sure, (a[0] > b[1]) | (b[0] > a[1]))


def _ne(a: Interval, b: Interval) -> Interval:
    low, high = _eq(a, b)
    return 1.0 - high, 1.0 - low


def _not(a: Interval) -> Interval:
    return 1.0 - a[1], 1.0 - a[0]


def _if_else_zero(c: Interval, x: Interval) -> Interval:
    sure, possible = c[0] > 0.5, c[1] > 0.5
    low = np.where(sure, x[0], np.where(possible, np.minimum(x[0], 0.0), 0.0))
    return low, np.where(sure, x[1], np.where(possible, np.maximum(x[1], 0.0), 0.0))


def _select(c: Interval, x: Interval, y: Interval) -> Interval:
    sure, never = c[0] > 0.5, c[1] < 0.5
    low = np.where(sure, x[0], np.where(never, y[0], np.minimum(x[0], y[0])))
    return low, np.where(sure, x[1], np.where(never, y[1], np.maximum(x[1], y[1])))


FORWARD: dict[int, Callable[..., Interval]] = {
    ca.OP_ADD: _add,
    ca.OP_SUB: _sub,
    ca.OP_MUL: _mul,
    ca.OP_DIV: _div,
    ca.OP_NEG: _neg,
    ca.OP_SQ: _sq,
    ca.OP_TWICE: lambda a: (2.0 * a[0], 2.0 * a[1]),
    ca.OP_EXP: _monotone(np.exp),
    ca.OP_LOG: _on_domain(np.log, 0.0, np.inf),
    ca.OP_LOG1P: _on_domain(np.log1p, -1.0, np.inf),
    ca.OP_EXPM1: _monotone(np.expm1),
    ca.OP_SQRT: _on_domain(np.sqrt, 0.0, np.inf),
    ca.OP_POW: _pow,
    ca.OP_CONSTPOW: _pow,
    ca.OP_INV: _inv,
    ca.OP_FABS: _abs,
    ca.OP_SIN: _periodic(np.sin, np.pi / 2),
    ca.OP_COS: _periodic(np.cos, 0.0),
    ca.OP_TAN: _tan,
    ca.OP_ASIN: _on_domain(np.arcsin, -1.0, 1.0),
    ca.OP_ACOS: lambda a: (np.arccos(np.clip(a[1], -1, 1)), np.arccos(np.clip(a[0], -1, 1))),
    ca.OP_ATAN: _monotone(np.arctan),
    ca.OP_SINH: _monotone(np.sinh),
    ca.OP_COSH: _cosh,
    ca.OP_TANH: _monotone(np.tanh),
    ca.OP_ASINH: _monotone(np.arcsinh),
    ca.OP_ACOSH: _on_domain(np.arccosh, 1.0, np.inf),
    ca.OP_ATANH: _on_domain(np.arctanh, -1.0, 1.0),
    ca.OP_FLOOR: _monotone(np.floor),
    ca.OP_CEIL: _monotone(np.ceil),
    ca.OP_SIGN: _monotone(np.sign),
    ca.OP_FMIN: _fmin,
    ca.OP_FMAX: _fmax,
    ca.OP_HYPOT: _hypot,
    ca.OP_ATAN2: _atan2,
    ca.OP_LT: _lt,
    ca.OP_LE: _le,
    ca.OP_EQ: _eq,
    ca.OP_NE: _ne,
    ca.OP_NOT: _not,
    ca.OP_AND: lambda a, b: (a[0] * b[0], a[1] * b[1]),
    ca.OP_OR: lambda a, b: (np.maximum(a[0], b[0]), np.maximum(a[1], b[1])),
    ca.OP_IF_ELSE_ZERO: _if_else_zero,
    OP_SELECT: _select,
}


# -- backward operations: what a node's interval says of the nodes it was computed from ---------


def _zero_free(a: Interval) -> Any:
    return (a[0] > 0) | (a[1] < 0)


def _quotient(a: Interval, b: Interval) -> Interval:
    """Divide where the divisor is free of zero; elsewhere nothing is known."""
    if _surely_above(b[0]):
        return _mul(a, (1.0 / b[1], 1.0 / b[0]))
    low, high = _div(a, b)
    free = _zero_free(b)
    return np.where(free, low, -np.inf), np.where(free, high, np.inf)


def _widened(result: Interval, *terms: Interval) -> Interval:
    """Widen a difference by what the rounding of its large terms may have cost."""
    size = sum(np.maximum(np.abs(t[0]), np.abs(t[1])) for t in terms)
    blur = np.where(np.isfinite(size), CANCELLATION * size, 0.0)
    return result[0] - blur, result[1] + blur


def _back_sq(r: Interval, a: Interval) -> tuple[Interval]:
    root = np.sqrt(np.maximum(r[1], 0.0)), np.sqrt(np.maximum(r[0], 0.0))
    low = np.where(a[0] >= 0, root[1], -root[0])
    return ((low, np.where(a[1] <= 0, -root[1], root[0])),)


def _back_pow(r: Interval, a: Interval, b: Interval) -> tuple[Interval | None, None]:
    exponent = b[0]
    if _surely(a[0]) and np.ndim(exponent) == 0 and np.all(b[0] == b[1]) and float(exponent) != 0.0:
        base = _pow((np.maximum(r[0], 0.0), np.maximum(r[1], 0.0)), (1.0 / exponent, 1.0 / exponent))
        return base, None
    return None, None


def _back_if_else_zero(r: Interval, c: Interval, x: Interval) -> tuple[None, Interval]:
    sure = c[0] > 0.5
    return None, (np.where(sure, r[0], -np.inf), np.where(sure, r[1], np.inf))


def _back_select(r: Interval, c: Interval, x: Interval, y: Interval) -> tuple[None, Interval, Interval]:
    sure, never = c[0] > 0.5, c[1] < 0.5
    return (
        None,
        (np.where(sure, r[0], -np.inf), np.where(sure, r[1], np.inf)),
        (np.where(never, r[0], -np.inf), np.where(never, r[1], np.inf)),
    )


BACKWARD: dict[int, Callable[..., tuple[Interval | None, ...]]] = {
    ca.OP_ADD: lambda r, a, b: (_widened(_sub(r, b), r, b), _widened(_sub(r, a), r, a)),
    ca.OP_SUB: lambda r, a, b: (_widened(_add(r, b), r, b), _widened(_sub(a, r), a, r)),
    ca.OP_MUL: lambda r, a, b: (_quotient(r, b), _quotient(r, a)),
    ca.OP_DIV: lambda r, a, b: (_mul(r, b), _quotient(a, r)),
    ca.OP_NEG: lambda r, a: (_neg(r),),
    ca.OP_TWICE: lambda r, a: ((0.5 * r[0], 0.5 * r[1]),),
    ca.OP_SQ: _back_sq,
    ca.OP_INV: lambda r, a: (_quotient((1.0, 1.0), r),),
    ca.OP_EXP: lambda r, a: ((np.log(np.maximum(r[0], 0.0)), np.log(np.maximum(r[1], 0.0))),),
    ca.OP_LOG: lambda r, a: ((np.exp(r[0]), np.exp(r[1])),),
    ca.OP_LOG1P: lambda r, a: ((np.expm1(r[0]), np.expm1(r[1])),),
    ca.OP_EXPM1: lambda r, a: ((np.log1p(np.maximum(r[0], -1.0)), np.log1p(np.maximum(r[1], -1.0))),),
    ca.OP_SQRT: lambda r, a: ((np.where(r[0] > 0, r[0] * r[0], 0.0), r[1] * r[1]),),
    ca.OP_FABS: lambda r, a: ((np.where(a[0] >= 0, r[0], -r[1]), np.where(a[1] <= 0, -r[0], r[1])),),
    ca.OP_POW: _back_pow,
    ca.OP_CONSTPOW: _back_pow,
    ca.OP_FMAX: lambda r, a, b: ((np.full_like(r[1], -np.inf), r[1]), (np.full_like(r[1], -np.inf), r[1])),
    ca.OP_FMIN: lambda r, a, b: ((r[0], np.full_like(r[0], np.inf)), (r[0], np.full_like(r[0], np.inf))),
    ca.OP_IF_ELSE_ZERO: _back_if_else_zero,
    OP_SELECT: _back_select,
}


# -- derivative intervals ----------------------------------------------------------------------


def _positive_part(a: Interval) -> Interval:
    return np.maximum(a[0], 0.0), np.maximum(a[1], 0.0)


def _hull_zero(a: Interval) -> Interval:
    return np.fmin(a[0], 0.0), np.fmax(a[1], 0.0)


def _local_slopes(op: int, r: Interval, args: Sequence[Interval]) -> tuple[Interval | None, ...]:
    """Return the interval of d(node)/d(argument) per argument; None where it is not bounded."""
    one = (1.0, 1.0)
    if op == ca.OP_ADD:
        return one, one
    if op == ca.OP_SUB:
        return one, (-1.0, -1.0)
    if op == ca.OP_MUL:
        return args[1], args[0]
    if op == ca.OP_DIV:
        inverse = _inv(args[1])
        return inverse, _neg(_mul(r, inverse))
    if op == ca.OP_NEG:
        return ((-1.0, -1.0),)
    if op == ca.OP_TWICE:
        return ((2.0, 2.0),)
    a = args[0]
    if op == ca.OP_SQ:
        return ((2.0 * a[0], 2.0 * a[1]),)
    if op == ca.OP_INV:
        return (_neg(_sq(r)),)
    if op == ca.OP_EXP:
        return (r,)
    if op == ca.OP_EXPM1:
        return ((r[0] + 1.0, r[1] + 1.0),)
    if op == ca.OP_LOG:
        return (_inv(_positive_part(a)),)
    if op == ca.OP_LOG1P:
        return (_inv(_positive_part((a[0] + 1.0, a[1] + 1.0))),)
    if op == ca.OP_SQRT:
        return (_inv((2.0 * r[0], 2.0 * r[1])),)
    if op in (ca.OP_POW, ca.OP_CONSTPOW) and np.ndim(args[1][0]) == 0 and np.all(args[1][0] == args[1][1]):
        n = args[1][0]
        return _mul((n, n), _pow(a, (n - 1.0, n - 1.0))), None
    if op == ca.OP_SIN:
        return (FORWARD[ca.OP_COS](a),)
    if op == ca.OP_COS:
        return (_neg(FORWARD[ca.OP_SIN](a)),)
    if op == ca.OP_TAN:
        s = _sq(r)
        return ((1.0 + s[0], 1.0 + s[1]),)
    if op == ca.OP_ATAN:
        s = _sq(a)
        return (_inv((1.0 + s[0], 1.0 + s[1])),)
    if op == ca.OP_TANH:
        s = _sq(r)
        return ((1.0 - s[1], 1.0 - s[0]),)
    if op == ca.OP_FABS:
        return ((np.where(a[0] >= 0, 1.0, -1.0), np.where(a[1] <= 0, -1.0, 1.0)),)
    if op == ca.OP_FMAX:
        first = _le(args[1], args[0])  # 1 where surely the first is the larger, up to 1 where it may be
        return first, (1.0 - first[1], 1.0 - first[0])
    if op == ca.OP_FMIN:
        first = _le(args[0], args[1])
        return first, (1.0 - first[1], 1.0 - first[0])
    if op in COMPARISONS:
        undecided = ~(r[0] == r[1])  # there the value jumps
        return tuple((np.where(undecided, -np.inf, 0.0), np.where(undecided, np.inf, 0.0)) for _ in args)
    return tuple(None for _ in args)


@dataclass(frozen=True)
class Cut:
    """A limit as the propagation sees it: nodes of both sides (or a constant right side) and its sense."""

    sense: str
    value: int
    limit: int | None
    scale: float
    bound: float = 0.0
    guard: bool = False


@dataclass(frozen=True)
class Goal:
    """An objective as the propagation sees it: its node, and +1 to make it small or -1 to make it large."""

    node: int
    sign: int = 1


@dataclass(frozen=True)
class Tightened:
    """Boxes after propagation.

    ``alive`` is False where nothing feasible can be (the other rows are then meaningless);
    ``bounds`` are lower bounds of the objectives (with their sign), ``scores`` tell how much each
    variable still blurs limits and objectives: the one to split. ``positive_cuts`` tells, per limit,
    whether both sides are surely positive in every box that is alive.
    """

    alive: np.ndarray
    low: np.ndarray
    high: np.ndarray
    bounds: np.ndarray
    scores: np.ndarray
    positive_cuts: np.ndarray


class Propagator:
    """Interval propagation of one program for batches of boxes.

    Parameters
    ----------
    program : Program
        Inputs are the variables first, then the data of the combination.
    n_variables : int
        How many of the inputs are variables.
    cuts : list of Cut
        Limits that must hold.
    objectives : list of Goal
        The objectives.
    """

    def __init__(self, program: Program, n_variables: int, cuts: Sequence[Cut], objectives: Sequence[Goal]) -> None:
        self.program = program
        self.n_variables = n_variables
        self.cuts = list(cuts)
        self.objectives = list(objectives)
        wanted = [c.value for c in cuts] + [c.limit for c in cuts if c.limit is not None]
        wanted += [goal.node for goal in objectives]
        self.dependent = program.dependence(range(n_variables))
        needed = program.needed(wanted)
        self.order = [k for k in needed if self.dependent[k] and program.nodes[k].op != ca.OP_INPUT]
        read = {a for k in self.order for a in program.nodes[k].args} | set(wanted)
        self.fixed = sorted(k for k in read if not self.dependent[k])
        self._fixed_values = program.compile(self.fixed)
        self.variables = program.input_nodes[:n_variables]
        self._cuts_at: dict[int, list[Cut]] = {}
        for cut in self.cuts:
            sides = [k for k in (cut.value, cut.limit) if k is not None and self.dependent[k]]
            self._cuts_at.setdefault(max(sides or [self.fixed[-1]]), []).append(cut)
        self._goals_at: dict[int, list[int]] = {}
        for j, goal in enumerate(self.objectives):
            self._goals_at.setdefault(goal.node, []).append(j)
        self._uses = {k: self._variable_uses(k) for k in wanted if self.dependent[k]}
        self._evaluators: dict[int, Callable[[Sequence[Any]], list[Any]]] = {}

    def _variable_uses(self, node: int) -> list[int]:
        needed = set(self.program.needed([node]))
        return [i for i, k in enumerate(self.variables) if k in needed]

    def data(self, inputs: Sequence[Any]) -> list[Any]:
        """Compute all nodes that depend on the combination only, from the data inputs."""
        return self._fixed_values([None] * self.n_variables + list(inputs))

    def contract(
        self,
        low: np.ndarray,
        high: np.ndarray,
        inputs: Sequence[Any],
        caps: Sequence[Any] | None = None,
        passes: int = 2,
        combine: np.ndarray | None = None,
    ) -> Tightened:
        """Tighten boxes and bound the objectives.

        Parameters
        ----------
        low, high : array (boxes, variables)
            The boxes.
        inputs : list of arrays (boxes,) or numbers
            Data of the combination of each box.
        caps : list, optional
            Upper bounds of the objectives (with their sign), one number or array each.
        passes : int
            Forward-backward sweeps.
        combine : array (vectors, limits + objectives), optional
            Multipliers, each row a sum of limits and objective caps that must hold together.
        """
        n = len(low)
        alive = np.ones(n, dtype=bool)
        low, high = low.copy(), high.copy()
        bounds = np.full((n, len(self.objectives)), -np.inf)
        scores = np.zeros((n, self.n_variables))
        with np.errstate(all="ignore"):
            fixed = self.data(inputs)
            box: _Box | None = None
            for sweep in range(passes):
                box = self._forward(low, high, fixed, caps, alive, box)
                if sweep == passes - 1:
                    free = self._free(box, fixed)
                    slopes = self._slopes(free)
                    self._corner_cuts(box, slopes, inputs, alive)
                    self._score(box, slopes, scores)
                    if combine is not None and caps is not None and len(combine):
                        self._combined_cuts(box, slopes, inputs, caps, combine, alive)
                for j, goal in enumerate(self.objectives):
                    least = box.low[goal.node] if goal.sign > 0 else -box.high[goal.node]
                    bounds[:, j] = np.fmax(bounds[:, j], least)
                self._backward(box, alive)
                for i, k in enumerate(self.variables):
                    low[:, i] = np.fmax(low[:, i], box.low[k])
                    high[:, i] = np.fmin(high[:, i], box.high[k])
            positive = np.ones(len(self.cuts), dtype=bool)
            for j, cut in enumerate(self.cuts):
                positive[j] = box is not None and self._surely_positive(cut, box, alive)
        return Tightened(alive, low, np.maximum(high, low), bounds, scores, positive)

    @staticmethod
    def _surely_positive(cut: Cut, box: _Box, alive: np.ndarray) -> bool:
        sides = [box.low[cut.value], cut.bound if cut.limit is None else box.low[cut.limit]]
        # Void sides (not-a-number) do not count.
        return all(bool(np.all((np.asarray(side) > 0) | np.isnan(side) | ~alive)) for side in sides)

    def _forward(
        self,
        low: np.ndarray,
        high: np.ndarray,
        fixed: list[Any],
        caps: Sequence[Any] | None,
        alive: np.ndarray,
        before: _Box | None,
    ) -> _Box:
        """Compute all intervals from the boxes; what an earlier sweep knew of a node stays known."""
        box = _Box(len(self.program.nodes))
        for k, value in zip(self.fixed, fixed, strict=True):
            box.low[k] = box.high[k] = np.asarray(value, dtype=float)
        for i, k in enumerate(self.variables):
            box.low[k], box.high[k] = low[:, i], high[:, i]
        for k in [*self.fixed, *self.variables]:
            self._cut_node(box, k, caps, alive)
        for k in self.order:
            self._compute(box, k)
            if before is not None:
                box.cut(k, (before.low[k], before.high[k]), alive)
            self._cut_node(box, k, caps, alive)
        return box

    def _free(self, cut: _Box, fixed: list[Any]) -> _Box:
        """Compute the intervals over the boxes without any limit.

        A slope is used along a line from one point of the box to another, and the points between
        need not keep the limits: so its interval must not know of them.
        """
        box = _Box(len(self.program.nodes))
        for k, value in zip(self.fixed, fixed, strict=True):
            box.low[k] = box.high[k] = np.asarray(value, dtype=float)
        for k in self.variables:
            box.low[k], box.high[k] = cut.low[k], np.maximum(cut.high[k], cut.low[k])
        for k in self.order:
            self._compute(box, k)
        return box

    def _compute(self, box: _Box, k: int) -> None:
        """Set the interval of a node from those of its arguments."""
        node = self.program.nodes[k]
        args = [(box.low[a], box.high[a]) for a in node.args]
        if node.op == OP_SPECIAL:
            box.low[k], box.high[k] = self._special(node, args)
        else:
            forward = FORWARD.get(node.op)
            box.low[k], box.high[k] = forward(*args) if forward else _whole(*args)

    def _special(self, node: Node, args: Sequence[Interval]) -> Interval:
        """Return the range of a special function: it is monotone in every argument."""
        function = self.program.specials[int(node.constant)]
        rising = [low >= 0 for low, _ in function.elasticity]
        least = function.formula(*[a[0] if up else a[1] for a, up in zip(args, rising, strict=True)])
        most = function.formula(*[a[1] if up else a[0] for a, up in zip(args, rising, strict=True)])
        inside = np.logical_and.reduce(np.broadcast_arrays(*[a[0] >= 0 for a in args]))
        return np.where(inside, least, -np.inf), np.where(inside, most, np.inf)

    def _special_slopes(self, node: Node, r: Interval, args: Sequence[Interval]) -> tuple[Interval | None, ...]:
        elasticity = self.program.specials[int(node.constant)].elasticity
        return tuple(_mul(e, _div(r, _positive_part(a))) for e, a in zip(elasticity, args, strict=True))

    def _cut_node(self, box: _Box, k: int, caps: Sequence[Any] | None, alive: np.ndarray) -> None:
        if caps is not None:
            for j in self._goals_at.get(k, ()):
                if self.objectives[j].sign > 0:
                    box.cut_high(k, caps[j], alive)
                else:
                    box.cut_low(k, -np.asarray(caps[j]), alive)
        for cut in self._cuts_at.get(k, ()):
            v, b = cut.value, cut.limit
            low, high = (cut.bound, cut.bound) if b is None else (box.low[b], box.high[b])
            if cut.sense in ("at_most", "equal"):
                box.cut_high(v, loosened(high, cut.scale, +1), alive)
                if b is not None and self.dependent[b]:
                    box.cut_low(b, loosened(box.low[v], cut.scale, -1), alive)
            if cut.sense in ("at_least", "equal"):
                box.cut_low(v, loosened(low, cut.scale, -1), alive)
                if b is not None and self.dependent[b]:
                    box.cut_high(b, loosened(box.high[v], cut.scale, +1), alive)

    def _backward(self, box: _Box, alive: np.ndarray) -> None:
        for k in reversed(self.order):
            node = self.program.nodes[k]
            backward = BACKWARD.get(node.op)
            if backward is None or not box.tightened[k]:
                continue
            args = [(box.low[a], box.high[a]) for a in node.args]
            for a, bounds in zip(node.args, backward((box.low[k], box.high[k]), *args), strict=True):
                if bounds is not None and self.dependent[a]:
                    box.cut(a, bounds, alive)

    def _slopes(self, box: _Box) -> list[list[Interval | None]]:
        """Return, per node, the interval of its derivative to each variable (None: identically zero)."""
        n = self.n_variables
        slopes: list[list[Interval | None]] = [[None] * n for _ in self.program.nodes]
        # A variable that no box leaves open needs no slope: it cannot move.
        moving = [i for i, k in enumerate(self.variables) if np.any(box.high[k] > box.low[k])]
        for i in moving:
            slopes[self.variables[i]][i] = (1.0, 1.0)
        for k in self.order:
            node = self.program.nodes[k]
            args = [(box.low[a], box.high[a]) for a in node.args]
            if node.op in (ca.OP_IF_ELSE_ZERO, OP_SELECT):
                self._slopes_of_where(slopes, k, node.args, args)
                continue
            own = (box.low[k], box.high[k])
            local = (
                self._special_slopes(node, own, args) if node.op == OP_SPECIAL else _local_slopes(node.op, own, args)
            )
            for i in moving:
                total: Interval | None = None
                for a, slope in zip(node.args, local, strict=True):
                    inner = slopes[a][i]
                    if inner is None or not self.dependent[a]:
                        continue
                    term = _whole(inner) if slope is None else _mul(slope, inner)
                    total = term if total is None else _add(total, term)
                slopes[k][i] = total
        return slopes

    def _slopes_of_where(
        self, slopes: list[list[Interval | None]], k: int, nodes: Sequence[int], args: Sequence[Interval]
    ) -> None:
        # Where the condition is undecided over the box the value may jump, so nothing is known there.
        sure, never = args[0][0] > 0.5, args[0][1] < 0.5
        zero = (0.0, 0.0)
        for i in range(self.n_variables):
            pieces = [slopes[a][i] for a in nodes]
            if all(piece is None for piece in pieces):
                continue
            yes = pieces[1] or zero
            no = (pieces[2] or zero) if len(pieces) == 3 else zero
            if not self.dependent[nodes[0]]:
                never = ~sure
            slopes[k][i] = (
                np.where(sure, yes[0], np.where(never, no[0], -np.inf)),
                np.where(sure, yes[1], np.where(never, no[1], np.inf)),
            )

    def _corner_cuts(
        self, box: _Box, slopes: list[list[Interval | None]], inputs: Sequence[Any], alive: np.ndarray
    ) -> None:
        for cut in self.cuts:
            both_move = cut.limit is not None and self.dependent[cut.limit]
            if both_move or not self.dependent[cut.value]:
                continue  # two moving sides are left to the propagation
            if cut.sense in ("at_most", "equal"):
                box.cut_low(cut.value, self._corner(cut.value, -1, box, slopes, inputs), alive)
            if cut.sense in ("at_least", "equal"):
                box.cut_high(cut.value, self._corner(cut.value, +1, box, slopes, inputs), alive)
        for goal in self.objectives:
            if not self.dependent[goal.node]:
                continue
            extreme = self._corner(goal.node, -goal.sign, box, slopes, inputs)
            if goal.sign > 0:
                box.cut_low(goal.node, extreme, alive)
            else:
                box.cut_high(goal.node, extreme, alive)

    def _combined_cuts(
        self,
        box: _Box,
        slopes: list[list[Interval | None]],
        inputs: Sequence[Any],
        caps: Sequence[Any],
        combine: np.ndarray,
        alive: np.ndarray,
    ) -> None:
        """Drop boxes where a weighted sum of limits and caps cannot hold.

        Each row g <= 0 lies, by the mean-value theorem, above g(centre) + slope (u - centre) with the slope in
        its interval over the box; so does any sum with multipliers. With the multipliers of an optimum the
        slopes of the sum nearly cancel, and the bound is good to second order in the width of the box. Any
        multipliers are valid; bad ones only drop nothing.
        """
        wanted = np.flatnonzero(np.any(combine != 0, axis=0))
        centre = [0.5 * (box.low[k] + box.high[k]) for k in self.variables]
        half = [0.5 * (box.high[k] - box.low[k]) for k in self.variables]
        rows = [self._row(int(j), caps) for j in wanted]
        nodes = sorted({node for row in rows for node in row.nodes})
        key = -1 - hash(tuple(nodes))
        if key not in self._evaluators:
            self._evaluators[key] = self.program.compile(nodes)
        at_centre = dict(zip(nodes, self._evaluators[key]([*centre, *inputs]), strict=True))
        for multipliers in combine[:, wanted]:
            total: Any = 0.0
            slope_low: list[Any] = [0.0] * self.n_variables
            slope_high: list[Any] = [0.0] * self.n_variables
            for weight, row in zip(multipliers, rows, strict=True):
                if weight == 0.0:
                    continue
                size = np.maximum(np.abs(row.size(box)), row.scale)
                factor = weight / size
                value = sum(sign * at_centre[node] for node, sign in zip(row.nodes, row.signs, strict=True))
                total = total + np.where(np.isfinite(size), factor * (value + row.constant), np.nan)
                for node, sign in zip(row.nodes, row.signs, strict=True):
                    for i in range(self.n_variables):
                        slope = slopes[node][i]
                        if slope is not None:
                            a, b = factor * sign * slope[0], factor * sign * slope[1]
                            slope_low[i] = slope_low[i] + np.minimum(a, b)
                            slope_high[i] = slope_high[i] + np.maximum(a, b)
            for i in range(self.n_variables):
                steepest = np.maximum(np.abs(slope_low[i]), np.abs(slope_high[i]))
                total = total - np.where(half[i] > 0, steepest * half[i], 0.0)
            alive &= ~(total > 2 * SLACK * np.abs(multipliers).sum())

    def _row(self, j: int, caps: Sequence[Any]) -> _Row:
        """Return limit or objective cap number j as a sum of nodes and a constant that must not be positive."""
        if j >= len(self.cuts):
            goal = self.objectives[j - len(self.cuts)]
            cap = caps[j - len(self.cuts)]
            return _Row((goal.node,), (float(goal.sign),), -np.asarray(cap), None, np.asarray(cap), 1e-300)
        cut = self.cuts[j]
        sign = -1.0 if cut.sense == "at_least" else 1.0
        if cut.limit is None:
            return _Row((cut.value,), (sign,), -sign * cut.bound, None, np.asarray(cut.bound), cut.scale)
        return _Row((cut.value, cut.limit), (sign, -sign), 0.0, cut.limit, None, cut.scale)

    def _score(self, box: _Box, slopes: list[list[Interval | None]], scores: np.ndarray) -> None:
        """Add up, per variable, how far limits that are undecided and objectives spread over the box."""

        def spread(node: int, size: Any, counts: Any) -> None:
            for i in self._uses.get(node, ()):
                slope, k = slopes[node][i], self.variables[i]
                if slope is None:
                    continue
                steepest = np.fmax(np.abs(slope[0]), np.abs(slope[1]))
                width = np.minimum(steepest * (box.high[k] - box.low[k]) / size, 1e3)
                scores[:, i] = np.fmax(scores[:, i], np.where(counts, width, 0.0))

        for cut in self.cuts:
            low, high = box.low[cut.value], box.high[cut.value]
            least, most = (cut.bound, cut.bound) if cut.limit is None else (box.low[cut.limit], box.high[cut.limit])
            open_above = (high > least) if cut.sense in ("at_most", "equal") else False
            open_below = (low < most) if cut.sense in ("at_least", "equal") else False
            size = np.maximum(np.maximum(np.abs(least), np.abs(most)), cut.scale)
            for node in (cut.value, cut.limit):
                if node is not None:
                    spread(node, size, open_above | open_below)
        for goal in self.objectives:
            size = np.maximum(np.maximum(np.abs(box.low[goal.node]), np.abs(box.high[goal.node])), 1e-300)
            spread(goal.node, size, True)

    def _corner(self, k: int, side: int, box: _Box, slopes: list[list[Interval | None]], inputs: Sequence[Any]) -> Any:
        """Return the bound of node k over the box: least value for side -1, largest for +1."""
        point: list[Any] = [None] * self.n_variables
        correction: Any = 0.0
        for i in self._uses[k]:
            low, high = box.low[self.variables[i]], box.high[self.variables[i]]
            slope = slopes[k][i]
            if slope is None:
                point[i] = low
                continue
            rising, falling = slope[0] >= 0, slope[1] <= 0
            # A variable of unproven sign is put in the middle; the mean-value term pays for the rest.
            at_low = rising if side < 0 else falling
            at_high = falling if side < 0 else rising
            point[i] = np.where(at_low, low, np.where(at_high, high, 0.5 * (low + high)))
            steepest = np.fmax(np.abs(slope[0]), np.abs(slope[1]))
            paid = np.where(high > low, steepest * 0.5 * (high - low), 0.0)
            correction = correction + np.where(at_low | at_high, 0.0, paid)
        if k not in self._evaluators:
            self._evaluators[k] = self.program.compile([k])
        value = self._evaluators[k](point + list(inputs))[0]
        return value + side * correction


@dataclass(frozen=True)
class _Row:
    """sum(sign * node) + constant <= 0, to be divided by the size of its right side."""

    nodes: tuple[int, ...]
    signs: tuple[float, ...]
    constant: Any
    size_node: int | None
    fixed_size: Any
    scale: float

    def size(self, box: _Box) -> Any:
        if self.size_node is None:
            return self.fixed_size
        return np.maximum(np.abs(box.low[self.size_node]), np.abs(box.high[self.size_node]))


class _Box:
    """Intervals of all nodes for a batch of boxes."""

    def __init__(self, n: int) -> None:
        self.low: list[Any] = [None] * n
        self.high: list[Any] = [None] * n
        self.tightened = [False] * n  # whether more is known of a node than follows from its arguments

    def cut(self, k: int, bounds: Interval, alive: np.ndarray) -> None:
        """Intersect an interval; a box whose ends pass each other by more than rounding is dead."""
        old_low, old_high = self.low[k], self.high[k]
        low, high = np.fmax(old_low, bounds[0]), np.fmin(old_high, bounds[1])
        if not (np.any(low != old_low) or np.any(high != old_high)):
            return
        self.tightened[k] = True
        alive &= ~(low > high + ROUNDING * np.abs(high))
        # Ends that meet by rounding stay together: were they to cross, later sweeps would pull them apart.
        self.low[k], self.high[k] = np.fmin(low, high), high

    def cut_low(self, k: int, bound: Any, alive: np.ndarray) -> None:
        """Raise the lower end."""
        self.cut(k, (bound, np.inf), alive)

    def cut_high(self, k: int, bound: Any, alive: np.ndarray) -> None:
        """Lower the upper end."""
        self.cut(k, (-np.inf, bound), alive)


def loosened(limit: Any, scale: float, side: int) -> Any:
    """Return the limit moved outward by the slack that feasibility and rounding may use."""
    return limit + side * SLACK * np.maximum(np.abs(limit), scale)
