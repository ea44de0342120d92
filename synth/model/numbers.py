"""Expressions evaluated: as a number, or as the function that gives it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca


def number(expression: ca.SX, values: Mapping[str, float]) -> float:
    """Evaluate an expression whose symbols all have values."""
    function, names = numeric(expression)
    return float(function.call([values[name] for name in names])[0])


def numeric(expression: ca.SX) -> tuple[Any, list[str]]:
    """Return the function that evaluates an expression, and the names of its arguments."""
    symbols = ca.symvar(ca.SX(expression))
    return ca.Function("number", symbols, [ca.SX(expression)]), [str(s) for s in symbols]
