"""The gap of a question: by how much a design may be better that need not be excluded."""

from __future__ import annotations

import math
from numbers import Real
from typing import Any

LEAST, MOST = 1e-6, 0.5
GAP_EXPECTED = "a fraction from 1e-6 to 0.5, for example 0.001"


def is_gap(value: Any) -> bool:
    """Tell whether something can be the gap of a question."""
    number = isinstance(value, Real) and not isinstance(value, bool)
    return number and math.isfinite(value) and LEAST <= value <= MOST
