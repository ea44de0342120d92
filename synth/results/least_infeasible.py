"""Why a search found no design, as a front tells it: the design that misses limits by least."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from synth.results.told import UNTOLD, Told, Untold
from synth.text.plain_text import counted


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class MissedLimit(Told):
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

    limit: str | Untold = UNTOLD
    value: float | Untold = UNTOLD
    limit_value: float | Untold = UNTOLD
    unit: str | Untold = UNTOLD
    missed_by: float | Untold = UNTOLD
    sentence: str | Untold = UNTOLD


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LeastInfeasible(Told):
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

    message: str | Untold = UNTOLD
    conflicts: Sequence[MissedLimit] | Untold = UNTOLD
    nearest: Mapping[str, str] | Untold = UNTOLD
    parts: Mapping[str, str] | Untold = UNTOLD

    @property
    def headline(self) -> str:
        """Return the message where the limits that are missed stand beside it, so that they are told once."""
        message, count = str(self.message or "No design is feasible."), len(self.conflicts or ())
        nearest, misses, _ = message.partition(" misses ")
        return f"{nearest} misses {counted(count, 'limit')}:" if count and misses else message

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Self:
        """Return the record that a file tells, its limits too."""
        found = dict(content)
        if isinstance(found.get("conflicts"), list):
            found["conflicts"] = [MissedLimit.read(x) for x in found["conflicts"]]
        return super().from_json(found)
