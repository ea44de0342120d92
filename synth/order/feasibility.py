"""The one definition of feasible, of utilisation and of status; search, check and reports all use it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import numpy as np

from synth.order.margins import Numbers

TOLERANCE = 1e-6
SLACK = 2 * TOLERANCE  # by which bounds loosen limits: what holds within the tolerance, and rounding
SLACKS_PER_GAP = 500
VANISHING = 1e-3  # share of its terms below which both sides of a limit are next to nothing
BINDING = 0.999  # a limit that is used by so much decides something
SMALLEST = 1e-300  # SI; smallest size that counts where none is declared: where all is zero a limit holds


class Status(StrEnum):
    """How a design (or a whole front) stands."""

    OPTIMAL = "optimal"  # within the gap that was asked for
    FEASIBLE = "feasible"
    INFEASIBLE = "infeasible"  # proven: no design can be feasible
    NOT_FOUND = "not_found"  # no feasible design was found, and that there is none is not proven
    NOT_SOLVED = "not_solved"  # stopped before it was reached
    FAILED = "failed"  # numerical failure


def size_of_miss(value: Numbers, limit: Numbers, scale: Numbers) -> Any:
    """Size that people measure a miss by: the limit, unless that vanishes beside the terms.

    Parameters
    ----------
    value, limit : float or array
        Both sides in SI.
    scale : float or array
        Size of the largest term.
    """
    return np.maximum(np.maximum(np.abs(value), np.abs(limit)), np.maximum(VANISHING * scale, SMALLEST))


def missed_share(value: Numbers, limit: Numbers, sense: str, scale: Numbers) -> Any:
    """Share by which a limit is missed, comparable between limits; not positive where it holds.

    Of a limit that is missed it is 1 - 1/utilisation where both sides are positive, and finite where they are not.

    Parameters
    ----------
    value, limit : float or array
        Both sides in SI.
    sense : {"at_most", "at_least", "equal"}
        Which way the limit points.
    scale : float or array
        Size of the largest term.
    """
    return residual(value, limit, sense, size_of_miss(value, limit, scale))


def slack_for(gap: float) -> float:
    """Share of its size by which a proof to some gap loosens a limit that something continuous moves.

    What a loosened limit lets in may be better by its price times the slack: far less than the gap, or no tree would
    close. A limit that nothing continuous moves is always loosened by :data:`SLACK`, as parts and makeable sizes may
    need the whole tolerance.

    Examples
    --------
    >>> [slack_for(gap) for gap in (1e-2, 1e-3, 1e-6)]
    [2e-06, 2e-06, 2e-09]
    """
    return min(SLACK, gap / SLACKS_PER_GAP)


def residual(value: Numbers, limit: Numbers, sense: str, scale: Numbers) -> Any:
    """Return the signed, scaled violation of a limit; positive = violated.

    A share of its terms where these are larger than the sides: what holds is told by it, but not which of two limits is
    nearer. That is told by :func:`utilisation`, or :func:`missed_share`.

    Parameters
    ----------
    value, limit : float or array
        Both sides in SI.
    sense : {"at_most", "at_least", "equal"}
        Which way the limit points.
    scale : float or array
        Smallest size that counts, in SI: that of the terms where the sides do not tell it.
    """
    # Where all terms are zero they have no size, and some have none at all: both sides alone tell then.
    size = np.maximum(np.maximum(np.abs(value), np.abs(limit)), np.fmax(scale, SMALLEST))
    difference = value - limit
    if sense == "at_least":
        difference = -difference
    elif sense == "equal":
        difference = np.abs(difference)
    return difference / size


def holds(residuals: Numbers, guard: bool, tolerance: Numbers = TOLERANCE) -> Any:
    """True if a limit holds: within the tolerance, for a guard strictly."""
    return residuals < 0.0 if guard else residuals <= tolerance


def utilisation(value: Numbers, limit: Numbers, sense: str) -> Any:
    """Used share of a limit, for people: value/limit, or limit/value for ``at_least``.

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


def most_used(used: Mapping[str, float | None]) -> list[str]:
    """Names of limits, those that are used most first; without those of which nothing is known.

    The one order of limits for people.

    Parameters
    ----------
    used : mapping
        Limit -> its utilisation, None where it is not checked.

    Examples
    --------
    >>> most_used({"stress": 0.4, "heat": None, "torque": 0.97, "width": 0.4})
    ['torque', 'stress', 'width']
    """
    known = {name: x for name, x in used.items() if x is not None}
    return sorted(known, key=lambda name: -known[name])


def binds(used: float | None, sense: str) -> bool:
    """True if a limit is reached; an equality always is and says nothing.

    Examples
    --------
    >>> binds(0.9995, "at_most"), binds(0.97, "at_least"), binds(1.0, "equal"), binds(None, "at_most")
    (True, False, False, False)
    """
    return used is not None and used >= BINDING and sense != "equal"
