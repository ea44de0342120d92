"""What was asked of a search, as a front keeps it beside its frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.results.record import UNSET, FileRecord, Unset


class SettingsRecord(FileRecord, frozen=True, kw_only=True, eq=False):
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

    points: int | Unset = UNSET
    gap: float | Unset = UNSET
    grid: bool | Unset = UNSET
    seed: int | Unset = UNSET
    weights: Mapping[str, float] | Unset = UNSET
    parts: Mapping[str, Any] | Unset = UNSET
    limits: Mapping[str, Any] | Unset = UNSET
    fix: Mapping[str, Any] | Unset = UNSET
    robust: Mapping[str, Any] | Unset = UNSET
