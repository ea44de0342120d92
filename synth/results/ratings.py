"""How designs stand what scatters, as fronts tell it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from synth.results.told import UNTOLD, Told, Untold

YES, NO, NOT_SHOWN = "yes", "no", "not shown"
SAMPLED = "sampled"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RangeVerdict(Told):
    """Whether limits hold over a range.

    Parameters
    ----------
    holds : bool or None
        True only where that is proven, False where a violation was found; None where neither is shown.
    verdict : str
        The same in words, whatever is handed over: ``yes``, ``no`` or ``not shown``.
    """

    holds: bool | Untold | None = UNTOLD
    verdict: str | Untold = UNTOLD

    def __post_init__(self) -> None:
        """Put the verdict into words, and fill in the keys."""
        if not isinstance(self.holds, Untold):
            object.__setattr__(self, "verdict", in_words(self.holds))
        super().__post_init__()

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Self:
        """Return the record that a file tells; where an old one says that samples hold, nothing is shown by them."""
        sampled = "verdict" not in content and content.get("proof") == SAMPLED and content.get("holds") is True
        return super().from_json({**content, "holds": None} if sampled else content)


def in_words(holds: bool | None) -> str:
    """Return whether limits hold over a range, in words.

    Examples
    --------
    >>> in_words(True), in_words(False), in_words(None)
    ('yes', 'no', 'not shown')
    """
    return YES if holds is True else NO if holds is False else NOT_SHOWN


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LimitRating(RangeVerdict):
    """How a limit stands the range, at its worst point; the fields of ``RangeVerdict`` come first.

    Parameters
    ----------
    proof : str
        What is known of the rest of the range: ``proven``, ``bounded`` or ``sampled``.
    residual : float or None
        None where the limit cannot be computed.
    value, limit : float or None
        Both sides, in SI.
    utilisation : float or None
    at : mapping
        What scatters -> value in SI, as far as the limit depends on it.
    position : list of float
        The point as shares of the ranges of all that scatters.
    """

    proof: str | Untold = UNTOLD
    residual: float | Untold | None = UNTOLD
    value: float | Untold | None = UNTOLD
    limit: float | Untold | None = UNTOLD
    utilisation: float | Untold | None = UNTOLD
    at: Mapping[str, float] | Untold = UNTOLD
    position: Sequence[float] | Untold = UNTOLD


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DesignRating(RangeVerdict):
    """The ``robust`` of a design; empty where it was not rated. The fields of ``RangeVerdict`` come first.

    Parameters
    ----------
    proof : str
        ``proven`` or ``sampled``.
    share_good : float
        Under the key ``yield``: share of the samples that keep all limits; where all do and nothing proves the rest of
        the range, the lower end of its interval.
    yield_low, yield_high : float
        Ends of its confidence interval; below 1 where a violation is known.
    confidence : float
        Of that interval.
    samples : int
    worst_limit : str
        The limit that is used most; of those that fail if any does, else of those that are not shown to hold if any is.
    worst_utilisation, worst_residual : float or None
        Of that limit.
    worst_at : mapping
        What scatters -> value in SI where it is worst.
    units : mapping
        What scatters -> unit in which it is shown.
    limits : mapping
        Limit -> LimitRating.
    """

    proof: str | Untold = UNTOLD
    share_good: float | Untold = field(default=UNTOLD, metadata={"key": "yield"})
    yield_low: float | Untold = UNTOLD
    yield_high: float | Untold = UNTOLD
    confidence: float | Untold = UNTOLD
    samples: int | Untold = UNTOLD
    worst_limit: str | Untold = UNTOLD
    worst_utilisation: float | Untold | None = UNTOLD
    worst_residual: float | Untold | None = UNTOLD
    worst_at: Mapping[str, float] | Untold = UNTOLD
    units: Mapping[str, str] | Untold = UNTOLD
    limits: Mapping[str, LimitRating] | Untold = UNTOLD

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Self:
        """Return the record that a file tells, its limits too; a yield of 1 that nothing proves is of an old file."""
        found = dict(content)
        if "verdict" not in found and found.get("proof") == SAMPLED and found.get("yield") == 1:
            found["yield"] = found.get("yield_low")
        if isinstance(found.get("limits"), Mapping):
            found["limits"] = {name: LimitRating.read(x) for name, x in found["limits"].items()}
        return super().from_json(found)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RatingCounts(Told):
    """The ``robust`` of the statistics of a front.

    Parameters
    ----------
    searches : int
        Searches until all designs held, or none was left to be done.
    rated : int
        Designs rated.
    samples : int
        Points of the range at which each was evaluated, beside its corners.
    limits_posed : int
        Limits posed beside those of the family, where limits are to hold over the range.
    taken_off : int
        Designs that were found and do not keep them.
    """

    searches: int | Untold = UNTOLD
    rated: int | Untold = UNTOLD
    samples: int | Untold = UNTOLD
    limits_posed: int | Untold = UNTOLD
    taken_off: int | Untold = UNTOLD
