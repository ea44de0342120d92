"""Why a search found no design, as a front tells it: the design that misses limits by least."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from synth.results.record import UNSET, FileRecord, Number, Unset
from synth.text.plain_text import counted


class MissedLimit(FileRecord, frozen=True, kw_only=True, eq=False):
    """A limit that the nearest design misses.

    Parameters
    ----------
    limit : str
        Its name.
    value, limit_value : float
        Both sides, in SI.
    unit : str
        In which both are shown.
    missed_by : float
        Their difference as a share of the limit.
    sentence : str
    """

    limit: str | Unset = UNSET
    value: Number | Unset = UNSET
    limit_value: Number | Unset = UNSET
    unit: str | Unset = UNSET
    missed_by: Number | Unset = UNSET
    sentence: str | Unset = UNSET


class LeastInfeasible(FileRecord, frozen=True, kw_only=True, eq=False):
    """The ``explanation`` of a front; only the message is told where no design could be evaluated.

    Parameters
    ----------
    message : str
    conflicts : list of MissedLimit
        The limits that the nearest design misses.
    nearest : mapping
        Its variables, counts and choices, as texts.
    parts : mapping
        Slot -> designation.
    """

    message: str | Unset = UNSET
    conflicts: Sequence[MissedLimit] | Unset = UNSET
    nearest: Mapping[str, str] | Unset = UNSET
    parts: Mapping[str, str] | Unset = UNSET

    @property
    def headline(self) -> str:
        """Return the message where the limits that are missed stand beside it, so that they are told once."""
        message, count = str(self.message or "No design is feasible."), len(self.conflicts or ())
        nearest, misses, _ = message.partition(" misses ")
        return f"{nearest} misses {counted(count, 'limit')}:" if count and misses else message
