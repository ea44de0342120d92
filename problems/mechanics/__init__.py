"""Sourced formulas of clutch mechanics: pure functions of floats, arrays or CasADi symbols."""

from __future__ import annotations

from typing import Any, TypeAlias

# A float, a NumPy array or a CasADi symbol: no common base class exists, the formulas use only what all three share.
Quantity: TypeAlias = Any
