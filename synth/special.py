"""Special functions: formulas whose monotonicity is known and tested, kept as one node of the trace.

A formula such as ``(1 - (1 + S)**-z)/S`` names its argument twice, and interval rules applied to its
pieces lose all they know. Decorated with :func:`special` it declares the range of its elasticities
(d log f / d log x) instead, and the search bounds it at the corners of a box. Evaluation and
derivatives still come from the formula itself. Every range is checked by a test on samples.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TypeVar

import casadi as ca

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class SpecialFunction:
    """A positive function of non-negative arguments with known ranges of elasticity.

    Parameters
    ----------
    name : str
    formula : callable
        Takes floats, arrays or symbols.
    elasticity : tuple of (float, float)
        Least and largest d log f / d log x per argument; each must keep one sign.
    """

    name: str
    formula: Callable[..., Any]
    elasticity: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class SpecialCall:
    """One use of a special function in a trace; ``symbol`` stands for its value in all that follows."""

    function: SpecialFunction
    arguments: tuple[Any, ...]
    symbol: Any


TABLE: dict[str, SpecialFunction] = {}
_calls: ContextVar[list[SpecialCall] | None] = ContextVar("special_calls", default=None)


def special(*elasticity: tuple[float, float]) -> Callable[[F], F]:
    """Declare a formula as a special function.

    Parameters
    ----------
    *elasticity : (least, largest)
        Per argument, in order; each range must keep one sign, so that the function is monotone.

    Raises
    ------
    ValueError
        When a range changes its sign.
    """
    if any(low < 0 < high or low > high for low, high in elasticity):
        raise ValueError(f"each elasticity range must keep one sign and be ordered, got {elasticity}")

    def decorate(formula: F) -> F:
        function = SpecialFunction(f"{formula.__module__}.{formula.__qualname__}", formula, tuple(elasticity))
        TABLE[function.name] = function

        @functools.wraps(formula)
        def call(*arguments: Any) -> Any:
            calls = _calls.get()
            if calls is None or not any(isinstance(a, ca.SX) for a in arguments):
                return formula(*arguments)
            # A symbol of its own keeps CasADi from taking the value apart when it simplifies.
            symbol = ca.SX.sym(f"{formula.__name__}#{len(calls)}")
            calls.append(SpecialCall(function, tuple(ca.SX(a) for a in arguments), symbol))
            return symbol

        return call  # type: ignore[return-value]

    return decorate


@contextmanager
def recorded() -> Iterator[list[SpecialCall]]:
    """Collect the special functions that are called on symbols inside the block."""
    calls: list[SpecialCall] = []
    token = _calls.set(calls)
    try:
        yield calls
    finally:
        _calls.reset(token)


def expanded(expression: Any, calls: Sequence[SpecialCall]) -> Any:
    """Return an expression with the formulas of special functions in place of their symbols."""
    result = ca.SX(expression)
    for call in reversed(calls):
        result = ca.substitute(result, call.symbol, ca.SX(call.function.formula(*call.arguments)))
    return result
