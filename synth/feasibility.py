"""The one definition of feasible, of utilisation and of status; search, check and reports all use it."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import numpy as np

TOLERANCE = 1e-6
SMALLEST = 1e-9  # SI; smallest size that counts, of limits of which none is told


class Status(StrEnum):
    """How a design (or a whole front) stands."""

    OPTIMAL = "optimal"  # within the gap that was asked for
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"
    NOT_SOLVED = "not_solved"  # stopped before it was reached
    FAILED = "failed"  # numerical failure


def residual(value: Any, limit: Any, sense: str, scale: Any) -> Any:
    """Return the signed, scaled violation of a limit; positive = violated.

    Parameters
    ----------
    value, limit : float or array
        Both sides in SI.
    sense : {"at_most", "at_least", "equal"}
        Which way the limit points.
    scale : float
        Smallest size that counts, in SI.
    """
    size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), scale)
    difference = value - limit
    if sense == "at_least":
        difference = -difference
    elif sense == "equal":
        difference = np.abs(difference)
    return difference / size


def holds(residuals: Any, guard: bool, tolerance: Any = TOLERANCE) -> Any:
    """Tell whether a limit holds: within the tolerance, for a guard strictly."""
    return residuals < 0.0 if guard else residuals <= tolerance


def utilisation(value: Any, limit: Any, sense: str) -> Any:
    """Return how much of a limit is used, for people: value/limit, or limit/value for ``at_least``.

    Where a side is not positive it is 0 (holds) or infinite (violated); an equality that holds counts as 1.
    """
    value, limit = np.asarray(value, dtype=float), np.asarray(limit, dtype=float)
    used, allowed = (limit, value) if sense == "at_least" else (value, limit)
    if sense == "equal":
        used, allowed = np.maximum(np.abs(value), np.abs(limit)), np.minimum(np.abs(value), np.abs(limit))
        same_sign = np.sign(value) == np.sign(limit)
        ratio = np.where(same_sign & (allowed > 0), used / np.where(allowed > 0, allowed, 1.0), np.inf)
        return np.where(value == limit, 1.0, ratio)
    positive = (used > 0) & (allowed > 0)
    ratio = used / np.where(positive, allowed, 1.0)
    return np.where(positive, ratio, np.where(used <= allowed, 0.0, np.inf))
