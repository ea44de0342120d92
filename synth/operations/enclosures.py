"""The rules of interval arithmetic for single operations, for many boxes at once.

Not-a-number stands for "nothing known". Intervals are not rounded outward: limits are loosened by a slack that is far
above rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from synth.operations.record import Domain, Interval

CANCELLATION = 1e-12  # of the size of the terms: what a sum or difference of them may be off by


def add(a: Interval, b: Interval) -> Interval:
    """Sum."""
    return a[0] + b[0], a[1] + b[1]


def subtract(a: Interval, b: Interval) -> Interval:
    """Difference."""
    return a[0] - b[1], a[1] - b[0]


_least = np.minimum.reduce  # a third of the cost of np.min, which counts at some 10^4 calls per batch


def _surely(values: float | np.ndarray) -> bool:
    """True if no value is negative (not-a-number counts as unknown)."""
    return bool((_least(values) if np.ndim(values) else values) >= 0.0)


def _surely_above(values: float | np.ndarray) -> bool:
    """True if all values are above zero."""
    return bool((_least(values) if np.ndim(values) else values) > 0.0)


def multiply(a: Interval, b: Interval) -> Interval:
    """Product."""
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


def invert(a: Interval) -> Interval:
    """Inverse; all numbers where zero lies inside."""
    low, high = np.asarray(a[0]), np.asarray(a[1])  # a plain zero would raise where an array gives infinity
    if _surely_above(low):
        return 1.0 / high, 1.0 / low
    positive, negative = low >= 0, high <= 0
    below = np.where(positive, 1.0 / high, np.where(negative, 1.0 / np.where(high == 0, -0.0, high), -np.inf))
    above = np.where(positive, 1.0 / np.where(low == 0, 0.0, low), np.where(negative, 1.0 / low, np.inf))
    return below, above


def divide(a: Interval, b: Interval) -> Interval:
    """Quotient."""
    return multiply(a, invert(b))


def negate(a: Interval) -> Interval:
    """Negative."""
    return -a[1], -a[0]


def square(a: Interval) -> Interval:
    """Square."""
    if _surely(a[0]):
        return a[0] * a[0], a[1] * a[1]
    p, q = a[0] * a[0], a[1] * a[1]
    return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(p, q)), np.maximum(p, q)


def scaled(factor: float) -> Callable[..., Interval]:
    """A multiple, by a positive number."""
    return lambda a, *others: (factor * a[0], factor * a[1])


def monotone(function: Callable[[Any], Any]) -> Callable[[Interval], Interval]:
    """A function that rises."""

    def forward(a: Interval) -> Interval:
        return function(a[0]), function(a[1])

    return forward


def on_domain(function: Callable[[Any], Any], domain: Domain) -> Callable[[Interval], Interval]:
    """A monotone function on the part of the interval that lies in its domain."""

    def forward(a: Interval) -> Interval:
        return function(np.clip(a[0], domain.low, domain.high)), function(np.clip(a[1], domain.low, domain.high))

    return forward


def power(a: Interval, b: Interval) -> Interval:
    """Power."""
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
        return invert(power(a, (-exponent, -exponent)))
    return unbounded(a, b)


def unbounded(*parts: Interval) -> Interval:
    """Unbounded interval, in the shape of other intervals."""
    size = sum(p[0] for p in parts) * 0.0
    return size - np.inf, size + np.inf


def magnitude(a: Interval) -> Interval:
    """Size."""
    p, q = np.abs(a[0]), np.abs(a[1])
    return np.where((a[0] <= 0) & (a[1] >= 0), 0.0, np.minimum(p, q)), np.maximum(p, q)


def periodic(function: Callable[[Any], Any], first_top: float) -> Callable[[Interval], Interval]:
    """Sine or cosine: tops at ``first_top + 2 k pi``, bottoms half a turn later."""

    def contains(a: Interval, at: float) -> Any:
        return np.floor((a[1] - at) / (2 * np.pi)) >= np.ceil((a[0] - at) / (2 * np.pi))

    def forward(a: Interval) -> Interval:
        p, q = function(a[0]), function(a[1])
        low = np.where(contains(a, first_top + np.pi), -1.0, np.minimum(p, q))
        return low, np.where(contains(a, first_top), 1.0, np.maximum(p, q))

    return forward


def tangent(a: Interval) -> Interval:
    """Tangent; all numbers where a pole lies inside."""
    same = np.floor(a[0] / np.pi + 0.5) == np.floor(a[1] / np.pi + 0.5)
    return np.where(same, np.tan(a[0]), -np.inf), np.where(same, np.tan(a[1]), np.inf)


def arc_cosine(a: Interval) -> Interval:
    """Arc cosine on the part of the interval that lies in its domain."""
    return np.arccos(np.clip(a[1], -1, 1)), np.arccos(np.clip(a[0], -1, 1))


def hyperbolic_cosine(a: Interval) -> Interval:
    """Hyperbolic cosine."""
    b = magnitude(a)
    return np.cosh(b[0]), np.cosh(b[1])


def least(a: Interval, b: Interval) -> Interval:
    """The smaller of two."""
    return np.minimum(a[0], b[0]), np.minimum(a[1], b[1])


def largest(a: Interval, b: Interval) -> Interval:
    """The larger of two."""
    return np.maximum(a[0], b[0]), np.maximum(a[1], b[1])


def length(a: Interval, b: Interval) -> Interval:
    """Root of the sum of two squares."""
    x, y = magnitude(a), magnitude(b)
    return np.hypot(x[0], y[0]), np.hypot(x[1], y[1])


def angle(a: Interval, b: Interval) -> Interval:
    """Angle of height and length."""
    inside = b[0] > 0  # elsewhere the branch cut makes corners worthless
    ratio = divide(a, b)
    return np.where(inside, np.arctan(ratio[0]), -np.pi), np.where(inside, np.arctan(ratio[1]), np.pi)


def _truth(sure: float | np.ndarray, never: float | np.ndarray) -> Interval:
    """One where surely true, 0 where surely not, and both where nothing is known."""
    return np.asarray(sure, dtype=float), 1.0 - np.asarray(never, dtype=float)


def less(a: Interval, b: Interval) -> Interval:
    """Whether one is less than another."""
    return _truth(a[1] < b[0], a[0] >= b[1])


def at_most(a: Interval, b: Interval) -> Interval:
    """Whether one is at most another."""
    return _truth(a[1] <= b[0], a[0] > b[1])


def equal(a: Interval, b: Interval) -> Interval:
    """Whether two are equal."""
    sure = (a[0] == a[1]) & (b[0] == b[1]) & (a[0] == b[0])
    return _truth(sure, (a[0] > b[1]) | (b[0] > a[1]))


def unequal(a: Interval, b: Interval) -> Interval:
    """Whether two are not equal."""
    low, high = equal(a, b)
    return 1.0 - high, 1.0 - low


def both(a: Interval, b: Interval) -> Interval:
    """Whether two conditions hold."""
    return a[0] * b[0], a[1] * b[1]


def opposite(a: Interval) -> Interval:
    """Whether something is not true."""
    return 1.0 - a[1], 1.0 - a[0]


def or_zero(c: Interval, x: Interval) -> Interval:
    """A value where a condition holds, and zero elsewhere."""
    sure, possible = c[0] > 0.5, c[1] > 0.5
    low = np.where(sure, x[0], np.where(possible, np.minimum(x[0], 0.0), 0.0))
    return low, np.where(sure, x[1], np.where(possible, np.maximum(x[1], 0.0), 0.0))


def chosen(c: Interval, x: Interval, y: Interval) -> Interval:
    """One of two values, by a condition."""
    sure, never = c[0] > 0.5, c[1] < 0.5
    low = np.where(sure, x[0], np.where(never, y[0], np.minimum(x[0], y[0])))
    return low, np.where(sure, x[1], np.where(never, y[1], np.maximum(x[1], y[1])))


# -- backward operations: what a node's interval says of the nodes it was computed from ---------


def _zero_free(a: Interval) -> Any:
    return (a[0] > 0) | (a[1] < 0)


def quotient(a: Interval, b: Interval) -> Interval:
    """Divide where the divisor is free of zero; elsewhere nothing is known."""
    if _surely_above(b[0]):
        return multiply(a, (1.0 / b[1], 1.0 / b[0]))
    low, high = divide(a, b)
    free = _zero_free(b)
    return np.where(free, low, -np.inf), np.where(free, high, np.inf)


def widened(result: Interval, *terms: Interval) -> Interval:
    """Widen a difference by what the rounding of its large terms may have cost."""
    size = sum(np.maximum(np.abs(t[0]), np.abs(t[1])) for t in terms)
    blur = np.where(np.isfinite(size), CANCELLATION * size, 0.0)
    return result[0] - blur, result[1] + blur


def _blurred(r: Interval) -> Interval:
    """Widen by what the rounding of a result may have cost, where an inverse magnifies it (exp(a) - 1 close to -1)."""
    return r[0] - CANCELLATION * np.abs(r[0]), r[1] + CANCELLATION * np.abs(r[1])


def back_exp(r: Interval, a: Interval) -> Interval:
    """Argument of an exponential."""
    low, high = _blurred(r)
    return np.log(np.maximum(low, 0.0)), np.log(np.maximum(high, 0.0))


def back_expm1(r: Interval, a: Interval) -> Interval:
    """Argument of exp(a) - 1."""
    low, high = _blurred(r)
    return np.log1p(np.maximum(low, -1.0)), np.log1p(np.maximum(high, -1.0))


def back_root(r: Interval, a: Interval) -> Interval:
    """Argument of a square root."""
    return np.where(r[0] > 0, r[0] * r[0], 0.0), r[1] * r[1]


def back_abs(r: Interval, a: Interval) -> Interval:
    """What has a size."""
    return np.where(a[0] >= 0, r[0], -r[1]), np.where(a[1] <= 0, -r[0], r[1])


def back_yes(r: Interval, c: Interval, *values: Interval) -> Interval:
    """What is chosen where a condition holds."""
    return where_sure(c[0] > 0.5, r)


def back_no(r: Interval, c: Interval, *values: Interval) -> Interval:
    """What is chosen where a condition does not hold."""
    return where_sure(c[1] < 0.5, r)


def back_square(r: Interval, a: Interval) -> Interval:
    """Argument of a square."""
    root = np.sqrt(np.maximum(r[1], 0.0)), np.sqrt(np.maximum(r[0], 0.0))
    low = np.where(a[0] >= 0, root[1], -root[0])
    return low, np.where(a[1] <= 0, -root[1], root[0])


def back_power(r: Interval, a: Interval, b: Interval) -> Interval | None:
    """Base of a power."""
    exponent = b[0]
    if _surely(a[0]) and np.ndim(exponent) == 0 and np.all(b[0] == b[1]) and float(exponent) != 0.0:
        return power((np.maximum(r[0], 0.0), np.maximum(r[1], 0.0)), (1.0 / exponent, 1.0 / exponent))
    return None


def where_sure(sure: float | np.ndarray, r: Interval) -> Interval:
    """An interval where it is sure that it counts; elsewhere nothing is known."""
    return np.where(sure, r[0], -np.inf), np.where(sure, r[1], np.inf)


def below(r: Interval, a: Interval, b: Interval) -> Interval:
    """Arguments of the larger of two."""
    return np.full_like(r[1], -np.inf), r[1]


def above(r: Interval, a: Interval, b: Interval) -> Interval:
    """Arguments of the smaller of two."""
    return r[0], np.full_like(r[0], np.inf)
