"""What was asked of a search, as a front keeps it beside its frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from synth.results.told import UNTOLD, Told, Untold


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SettingsRecord(Told):
    """The ``settings`` of a front: with its frame they pose the question again.

    Parameters
    ----------
    points : int
        At most this many designs.
    gap : float
        Relative improvement in every objective that need not be excluded.
    grid : bool
        Whether only makeable values were asked for.
    seed : int
    weights : mapping
        Objective -> weight for the ranking.
    parts, limits, fix : mapping
        Restrictions, as texts, numbers and lists of these.
    robust : mapping
        The block of what scatters, where anything does.
    """

    points: int | Untold = UNTOLD
    gap: float | Untold = UNTOLD
    grid: bool | Untold = UNTOLD
    seed: int | Untold = UNTOLD
    weights: Mapping[str, float] | Untold = UNTOLD
    parts: Mapping[str, Any] | Untold = UNTOLD
    limits: Mapping[str, Any] | Untold = UNTOLD
    fix: Mapping[str, Any] | Untold = UNTOLD
    robust: Mapping[str, Any] | Untold = UNTOLD
