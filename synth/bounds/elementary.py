"""Ranges of elementary functions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.bounds.curvature import INF, Curvature, Ends

# -- functions of one argument -----------------------------------------------------------------


@dataclass(frozen=True)
class OuterFunction:
    """A function of one positive argument y, as far as it is positive.

    Its elasticity is given as a function of y that rises (log-convex) or falls (log-concave) all the way from
    ``first`` at the lower end of the domain to ``last`` at the upper one.
    """

    domain: Ends
    elasticity: Callable[[Any], Any]
    first: float
    last: float
    sign: int = 1

    @property
    def curvature(self) -> Curvature:
        """Return the curvature of its logarithm in the logarithm of y: that of an elasticity that rises or falls."""
        return Curvature(self.last > self.first, self.last < self.first)

    @property
    def rising(self) -> bool:
        """True if it rises all the way."""
        return min(self.first, self.last) >= 0

    @property
    def falling(self) -> bool:
        """True if it falls all the way."""
        return max(self.first, self.last) <= 0

    def ends(self, argument: Ends) -> Ends:
        """Return the range of the elasticity over a range of the argument."""
        values = []
        for y, limit in zip(argument, (self.first, self.last), strict=True):
            if y <= self.domain[0]:  # also the upper end of a range that is this point alone
                values.append(self.first)
                continue
            value = float(self.elasticity(np.float64(y))) if y < self.domain[1] else self.last
            values.append(value if np.isfinite(value) else limit)
        return min(values), max(values)


HALF_TURN = float(np.pi)
OUTER: dict[int, OuterFunction] = {
    ca.OP_EXP: OuterFunction((0.0, INF), lambda y: y, 0.0, INF),
    ca.OP_EXPM1: OuterFunction((0.0, INF), lambda y: y / -np.expm1(-y), 1.0, INF),
    ca.OP_LOG1P: OuterFunction((0.0, INF), lambda y: y / ((1 + y) * np.log1p(y)), 1.0, 0.0),
    ca.OP_LOG: OuterFunction((1.0, INF), lambda y: 1 / np.log(y), INF, 0.0),
    ca.OP_SIN: OuterFunction((0.0, HALF_TURN), lambda y: y / np.tan(y), 1.0, -INF),
    ca.OP_COS: OuterFunction((0.0, HALF_TURN / 2), lambda y: -y * np.tan(y), 0.0, -INF),
    ca.OP_TAN: OuterFunction((0.0, HALF_TURN / 2), lambda y: 2 * y / np.sin(2 * y), 1.0, INF),
    ca.OP_ASIN: OuterFunction((0.0, 1.0), lambda y: y / (np.sqrt(1 - y * y) * np.arcsin(y)), 1.0, INF),
    ca.OP_ACOS: OuterFunction((0.0, 1.0), lambda y: -y / (np.sqrt(1 - y * y) * np.arccos(y)), 0.0, -INF),
    ca.OP_ATAN: OuterFunction((0.0, INF), lambda y: y / ((1 + y * y) * np.arctan(y)), 1.0, 0.0),
    ca.OP_SINH: OuterFunction((0.0, INF), lambda y: y / np.tanh(y), 1.0, INF),
    ca.OP_COSH: OuterFunction((0.0, INF), lambda y: y * np.tanh(y), 0.0, INF),
    ca.OP_TANH: OuterFunction((0.0, INF), lambda y: 2 * y / np.sinh(2 * y), 1.0, 0.0),
    ca.OP_ASINH: OuterFunction((0.0, INF), lambda y: y / (np.sqrt(1 + y * y) * np.arcsinh(y)), 1.0, 0.0),
    ca.OP_ACOSH: OuterFunction((1.0, INF), lambda y: y / (np.sqrt(y * y - 1) * np.arccosh(y)), INF, 0.0),
    ca.OP_ATANH: OuterFunction((0.0, 1.0), lambda y: y / ((1 - y * y) * np.arctanh(y)), 1.0, INF),
}
# The size of the function at -y.
MIRRORED: dict[int, OuterFunction] = {
    ca.OP_EXP: OuterFunction((0.0, INF), lambda y: -y, 0.0, -INF),
    ca.OP_EXPM1: OuterFunction((0.0, INF), lambda y: y / np.expm1(y), 1.0, 0.0, sign=-1),
    ca.OP_LOG1P: OuterFunction((0.0, 1.0), lambda y: -y / ((1 - y) * np.log1p(-y)), 1.0, INF, sign=-1),
    ca.OP_COS: OUTER[ca.OP_COS],
    ca.OP_COSH: OUTER[ca.OP_COSH],
    **{
        op: OuterFunction(o.domain, o.elasticity, o.first, o.last, sign=-1)
        for op, o in OUTER.items()
        if op in (ca.OP_SIN, ca.OP_TAN, ca.OP_ASIN, ca.OP_ATAN, ca.OP_SINH, ca.OP_TANH, ca.OP_ASINH, ca.OP_ATANH)
    },
}
# The size of the logarithm of less than 1, which is negative.
LOG_BELOW_ONE = OuterFunction((0.0, 1.0), lambda y: 1 / np.log(y), 0.0, -INF, sign=-1)
