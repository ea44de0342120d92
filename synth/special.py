"""Special functions: formulas whose monotonicity is known and tested, kept as one node of the trace.

A formula such as ``(1 - (1 + S)**-z)/S`` names its argument twice, and interval rules applied to its
pieces lose all they know. Decorated with :func:`special` it declares the range of its elasticities
(d log f / d log x) instead, and the search bounds it at the corners of a box; it may declare as well
that log f is convex or concave in the logarithms of its arguments. Evaluation and derivatives still
come from the formula itself. Every declaration is checked by a test on samples.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np

# What formulas take and return: a number, an array, or an expression of CasADi symbols. No type that could be checked
# holds for all three: the operators of one do not know the others.
Numeric: TypeAlias = Any

F = TypeVar("F", bound=Callable[..., Any])
Interval = tuple[Any, Any]

CURVATURES = ("log-convex", "log-concave")


@dataclass(frozen=True)
class SpecialFunction:
    """A positive function of non-negative arguments with known ranges of elasticity.

    Parameters
    ----------
    name : str
    formula : callable
        Takes floats, arrays or symbols; numbers give not-a-number where the function does not exist.
    elasticity : tuple of (float, float)
        Least and largest d log f / d log x per argument; each must keep one sign, an end may be infinite.
    curvature : {"log-convex", "log-concave"}, optional
        Of log f as a function of the logarithms of all arguments together; None where nothing is known.
    above : (int, int), optional
        Positions of two arguments: the function exists only where the first is above the second, and nothing
        declared counts elsewhere. A guard of the problem must keep designs there.
    """

    name: str
    formula: Callable[..., Any]
    elasticity: tuple[tuple[float, float], ...]
    curvature: str | None = None
    above: tuple[int, int] | None = None

    def bounds(self, arguments: Sequence[Interval]) -> Interval:
        """Return the range over boxes of arguments, as far as the function exists there.

        It is monotone in every argument, so that both ends are values at corners. Where the largest (or least) value
        lies beyond the border of existence that end is open, and where the function exists nowhere both are.

        Parameters
        ----------
        arguments : list of (low, high)
            Numbers or arrays that broadcast.

        Returns
        -------
        tuple
            Least and largest value.
        """
        lows = [np.asarray(low, dtype=float) for low, _ in arguments]
        highs = [np.asarray(high, dtype=float) for _, high in arguments]
        known = _none_negative(lows)
        if self.above is not None:
            first, second = self.above
            known = known & (highs[first] > lows[second])
            lows[first] = np.maximum(lows[first], lows[second])
            highs[second] = np.minimum(highs[second], highs[first])
        rising = [least >= 0 for least, _ in self.elasticity]
        least = [low if up else high for low, high, up in zip(lows, highs, rising, strict=True)]
        most = [high if up else low for low, high, up in zip(lows, highs, rising, strict=True)]
        return self._corner(least, known, -np.inf), self._corner(most, known, np.inf)

    def _corner(self, point: Sequence[Any], known: np.ndarray, unknown: float) -> Any:
        with np.errstate(all="ignore"):
            value = self.formula(*point)
        return np.where(known & ~np.isnan(value), value, unknown)

    def exists(self, arguments: Sequence[Interval]) -> Any:
        """Return whether the function exists everywhere in boxes of arguments."""
        known = _none_negative([np.asarray(low, dtype=float) for low, _ in arguments])
        if self.above is not None:
            known = known & (arguments[self.above[0]][0] > arguments[self.above[1]][1])
        return known


def _none_negative(values: Sequence[Any]) -> Any:
    return np.logical_and.reduce(np.broadcast_arrays(*[value >= 0 for value in values]))


@dataclass(frozen=True)
class SpecialCall:
    """One use of a special function in a trace; ``symbol`` stands for its value in all that follows."""

    function: SpecialFunction
    arguments: tuple[Any, ...]
    symbol: Any


TABLE: dict[str, SpecialFunction] = {}
_calls: ContextVar[list[SpecialCall] | None] = ContextVar("special_calls", default=None)


def special(
    *elasticity: tuple[float, float], curvature: str | None = None, above: tuple[int, int] | None = None
) -> Callable[[F], F]:
    """Declare a formula as a special function.

    Parameters
    ----------
    *elasticity : (least, largest)
        Per argument, in order; each range must keep one sign, so that the function is monotone.
    curvature : {"log-convex", "log-concave"}, optional
        Of log f as a function of the logarithms of all arguments together.
    above : (int, int), optional
        Positions of two arguments: the function exists only where the first is above the second.

    Raises
    ------
    ValueError
        When a range changes its sign, or curvature or positions are not among those possible.
    """
    if any(low < 0 < high or low > high for low, high in elasticity):
        raise ValueError(f"each elasticity range must keep one sign and be ordered, got {elasticity}")
    if curvature not in (None, *CURVATURES):
        raise ValueError(f"the curvature must be one of {', '.join(CURVATURES)}, got {curvature!r}")
    if above is not None and (above[0] == above[1] or not all(0 <= k < len(elasticity) for k in above)):
        raise ValueError(f"above must name two arguments of {len(elasticity)} by position, got {above}")

    def decorate(formula: F) -> F:
        name = f"{formula.__module__}.{formula.__qualname__}"
        existing = formula if above is None else _where_above(formula, *above)
        function = SpecialFunction(name, existing, tuple(elasticity), curvature, above)
        TABLE[function.name] = function

        parameters = inspect.signature(formula)

        @functools.wraps(formula)
        def call(*arguments: Any, **named: Any) -> Any:
            if named:
                arguments = parameters.bind(*arguments, **named).args
            calls = _calls.get()
            if calls is None or not any(_is_symbol(a) for a in arguments):
                return existing(*arguments)
            import casadi as ca

            # A symbol of its own keeps CasADi from taking the value apart when it simplifies.
            symbol = ca.SX.sym(f"{formula.__name__}#{len(calls)}")
            calls.append(SpecialCall(function, tuple(ca.SX(a) for a in arguments), symbol))
            return symbol

        return call  # type: ignore[return-value]

    return decorate


def _is_symbol(value: object) -> bool:
    """True if a value is a symbol, without importing CasADi for numbers: formulas are used without it, too."""
    casadi = sys.modules.get("casadi")
    return casadi is not None and isinstance(value, casadi.SX)


def _where_above(formula: Callable[..., Any], first: int, second: int) -> Callable[..., Any]:
    """Return a formula that gives not-a-number where its first argument of the two is below the second.

    The value on the border is the limit. Symbols are left alone: a solver needs finite numbers to find its way back.
    """

    @functools.wraps(formula)
    def existing(*arguments: Any) -> Any:
        value = formula(*arguments)
        if any(_is_symbol(a) for a in arguments):
            return value
        return np.where(arguments[first] >= arguments[second], value, np.nan)

    return existing


@contextmanager
def recorded() -> Iterator[list[SpecialCall]]:
    """Collect the special functions that are called on symbols inside the block."""
    calls: list[SpecialCall] = []
    token = _calls.set(calls)
    try:
        yield calls
    finally:
        _calls.reset(token)


def expanded(expression: Numeric, calls: Sequence[SpecialCall]) -> Any:
    """Return an expression with the formulas of special functions in place of their symbols."""
    import casadi as ca

    result = ca.SX(expression)
    for call in reversed(calls):
        if ca.depends_on(result, call.symbol):  # most calls stand elsewhere, and formulas are long
            result = ca.substitute(result, call.symbol, ca.SX(call.function.formula(*call.arguments)))
    return result
