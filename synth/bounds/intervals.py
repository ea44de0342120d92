"""The rules of interval arithmetic for traced programs, for many boxes at once.

``FORWARD`` gives the interval of a node from those of its arguments, ``BACKWARD`` what the interval of a
node says of its arguments. Together they are forward-backward bound tightening on the expression graph
(Schichl and Neumaier 2005, "Interval analysis on directed acyclic graphs for global optimization"), which
:mod:`synth.bounds.contractor` carries out.

Not-a-number stands for "nothing known" and never excludes a box. Intervals are not rounded
outward: limits are loosened by ``SLACK``, which is far above rounding and twice the tolerance of
feasibility.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from synth.model.program import OP_SELECT
from synth.special import SpecialFunction

ROUNDING = 1e-8  # relative: ends of an interval that pass each other by less do so by rounding
CANCELLATION = 1e-12  # of the size of the terms: what a sum or difference of them may be off by

Interval = tuple[Any, Any]


# -- forward operations ------------------------------------------------------------------------


def _add(a: Interval, b: Interval) -> Interval:
    return a[0] + b[0], a[1] + b[1]


def _sub(a: Interval, b: Interval) -> Interval:
    return a[0] - b[1], a[1] - b[0]


_least = np.minimum.reduce  # a third of the cost of np.min, which counts at some 10^4 calls per batch


def _surely(values: Any) -> bool:
    """True if no value is negative (not-a-number counts as unknown)."""
    return bool((_least(values) if np.ndim(values) else values) >= 0.0)


def _surely_above(values: Any) -> bool:
    """True if all values are above zero."""
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
    low, high = np.asarray(a[0]), np.asarray(a[1])  # a plain zero would raise where an array gives infinity
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
    return whole(a, b)


def whole(*parts: Interval) -> Interval:
    """Return the interval of all numbers, in the shape of some others."""
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


def _blurred(r: Interval) -> Interval:
    """Widen by what the rounding of a result may have cost, where an inverse magnifies it (exp(a) - 1 close to -1)."""
    return r[0] - CANCELLATION * np.abs(r[0]), r[1] + CANCELLATION * np.abs(r[1])


def _back_exp(r: Interval, a: Interval) -> Interval:
    low, high = _blurred(r)
    return np.log(np.maximum(low, 0.0)), np.log(np.maximum(high, 0.0))


def _back_expm1(r: Interval, a: Interval) -> Interval:
    low, high = _blurred(r)
    return np.log1p(np.maximum(low, -1.0)), np.log1p(np.maximum(high, -1.0))


def _back_sq(r: Interval, a: Interval) -> Interval:
    root = np.sqrt(np.maximum(r[1], 0.0)), np.sqrt(np.maximum(r[0], 0.0))
    low = np.where(a[0] >= 0, root[1], -root[0])
    return low, np.where(a[1] <= 0, -root[1], root[0])


def _back_pow(r: Interval, a: Interval, b: Interval) -> Interval | None:
    exponent = b[0]
    if _surely(a[0]) and np.ndim(exponent) == 0 and np.all(b[0] == b[1]) and float(exponent) != 0.0:
        return _pow((np.maximum(r[0], 0.0), np.maximum(r[1], 0.0)), (1.0 / exponent, 1.0 / exponent))
    return None


def _where(sure: Any, r: Interval) -> Interval:
    """An interval where it is sure that it counts; elsewhere nothing is known."""
    return np.where(sure, r[0], -np.inf), np.where(sure, r[1], np.inf)


def _below(r: Interval, a: Interval, b: Interval) -> Interval:
    return np.full_like(r[1], -np.inf), r[1]


def _over(r: Interval, a: Interval, b: Interval) -> Interval:
    return r[0], np.full_like(r[0], np.inf)


# Per argument, None where nothing follows for it.
BACKWARD: dict[int, tuple[Callable[..., Interval | None] | None, ...]] = {
    ca.OP_ADD: (lambda r, a, b: _widened(_sub(r, b), r, b), lambda r, a, b: _widened(_sub(r, a), r, a)),
    ca.OP_SUB: (lambda r, a, b: _widened(_add(r, b), r, b), lambda r, a, b: _widened(_sub(a, r), a, r)),
    ca.OP_MUL: (lambda r, a, b: _quotient(r, b), lambda r, a, b: _quotient(r, a)),
    ca.OP_DIV: (lambda r, a, b: _mul(r, b), lambda r, a, b: _quotient(a, r)),
    ca.OP_NEG: (lambda r, a: _neg(r),),
    ca.OP_TWICE: (lambda r, a: (0.5 * r[0], 0.5 * r[1]),),
    ca.OP_SQ: (_back_sq,),
    ca.OP_INV: (lambda r, a: _quotient((1.0, 1.0), r),),
    ca.OP_EXP: (_back_exp,),
    ca.OP_LOG: (lambda r, a: (np.exp(r[0]), np.exp(r[1])),),
    ca.OP_LOG1P: (lambda r, a: (np.expm1(r[0]), np.expm1(r[1])),),
    ca.OP_EXPM1: (_back_expm1,),
    ca.OP_SQRT: (lambda r, a: (np.where(r[0] > 0, r[0] * r[0], 0.0), r[1] * r[1]),),
    ca.OP_FABS: (lambda r, a: (np.where(a[0] >= 0, r[0], -r[1]), np.where(a[1] <= 0, -r[0], r[1])),),
    ca.OP_POW: (_back_pow, None),
    ca.OP_CONSTPOW: (_back_pow, None),
    ca.OP_FMAX: (_below, _below),
    ca.OP_FMIN: (_over, _over),
    ca.OP_IF_ELSE_ZERO: (None, lambda r, c, x: _where(c[0] > 0.5, r)),
    OP_SELECT: (None, lambda r, c, x, y: _where(c[0] > 0.5, r), lambda r, c, x, y: _where(c[1] < 0.5, r)),
}


def backward(op: int, result: Interval, args: Sequence[Interval]) -> list[Interval | None]:
    """What the interval of a node says of each of its arguments; None where nothing follows."""
    return [None if rule is None else rule(result, *args) for rule in BACKWARD.get(op, (None,) * len(args))]


def special_range(function: SpecialFunction, args: Sequence[Interval]) -> Interval:
    """Range of a special function: it is monotone in every argument."""
    rising = [low >= 0 for low, _ in function.elasticity]
    least = function.formula(*[a[0] if up else a[1] for a, up in zip(args, rising, strict=True)])
    most = function.formula(*[a[1] if up else a[0] for a, up in zip(args, rising, strict=True)])
    inside = np.logical_and.reduce(np.broadcast_arrays(*[a[0] >= 0 for a in args]))
    return _where(inside, (least, most))


def loosened(limit: Any, size: Any, share: float) -> Any:
    """The limit moved by a share of its size: outward by the slack that feasibility and rounding may use.

    Parameters
    ----------
    limit : float or array
    size : float or array
        Smallest size that counts.
    share : float
        Negative to move it down.
    """
    return limit + share * np.maximum(np.abs(limit), size)
