"""Makeable values: steps and preferred numbers."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Real

import numpy as np

from synth.errors import DeclarationError
from synth.order.margins import MARGINS, within

RENARD_STEPS = {"R5": 5, "R10": 10, "R20": 20, "R40": 40}
# ISO 3 rounds the exact tenth-powers; the rounded mantissas are the preferred numbers themselves.
RENARD_R40 = (
    1.00, 1.06, 1.12, 1.18, 1.25, 1.32, 1.40, 1.50, 1.60, 1.70, 1.80, 1.90, 2.00, 2.12, 2.24, 2.36, 2.50, 2.65, 2.80,
    3.00, 3.15, 3.35, 3.55, 3.75, 4.00, 4.25, 4.50, 4.75, 5.00, 5.30, 5.60, 6.00, 6.30, 6.70, 7.10, 7.50, 8.00, 8.50,
    9.00, 9.50,
)  # fmt: skip


def grid_values(grid: float | str | Sequence[float] | None, lower: float, upper: float) -> np.ndarray:
    """Return the makeable values inside ``lower .. upper``.

    Parameters
    ----------
    grid : step, name of a preferred number series, list of values, or None
        ``1`` = whole units, ``"R20"`` = ISO 3 series, or the values themselves.
    lower, upper : float
        Bounds in the same unit.

    Returns
    -------
    numpy.ndarray
        Sorted values; empty for a continuous variable.

    Examples
    --------
    >>> grid_values("R10", 10, 32)
    array([10. , 12.5, 16. , 20. , 25. , 31.5])
    """
    if grid is None:
        return np.empty(0)
    if isinstance(grid, str):
        if grid not in RENARD_STEPS:
            raise DeclarationError(f"unknown preferred number series {grid!r}; known are {', '.join(RENARD_STEPS)}")
        if not lower > 0:
            raise DeclarationError(f"the preferred number series {grid} needs bounds above 0")
        mantissas = RENARD_R40[:: 40 // RENARD_STEPS[grid]]
        decades = np.arange(np.floor(np.log10(lower)), np.ceil(np.log10(upper)) + 1)
        values = np.array([float(f"{m}e{int(d)}") for d in decades for m in mantissas])
    elif isinstance(grid, Real):
        step = float(grid)
        if isinstance(grid, bool) or not 0 < step < np.inf:
            raise DeclarationError(f"a grid step must be above 0 and finite, not {grid}")
        first, last = np.ceil(lower / step - MARGINS.step), np.floor(upper / step + MARGINS.step)
        steps = np.arange(first, last + 1)
        per_unit = round(1 / step) if step < 1 else 0
        # Division by the reciprocal of a fractional step keeps 0.1 mm ladders free of 0.30000000000000004.
        values = steps / per_unit if per_unit and abs(per_unit * step - 1) < MARGINS.step else steps * step
    else:
        values = np.sort(np.asarray(grid, dtype=float))
        if not np.isfinite(values).all():
            raise DeclarationError(f"the values of a grid must be finite, not {grid}")
    inside: np.ndarray = values[within(values, lower, upper, MARGINS.conversion)]
    return inside
