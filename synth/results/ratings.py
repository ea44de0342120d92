"""How designs stand what scatters, as fronts tell it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec

from synth.results.record import UNSET, FileRecord, Number, Unset, force_setattr

YES, NO, NOT_SHOWN = "yes", "no", "not shown"
SAMPLED = "sampled"


class RangeVerdict(FileRecord, frozen=True, kw_only=True, eq=False):
    """Whether limits hold over a range.

    Parameters
    ----------
    holds : bool or None
        True only where that is proven, False where a violation was found; None where neither is shown.
    verdict : str
        The same in words, whatever is handed over: ``yes``, ``no`` or ``not shown``.
    proof : str
        What is known of the rest of the range: ``proven``, ``bounded`` or ``sampled``.
    """

    holds: bool | Unset | None = UNSET
    verdict: str | Unset = UNSET
    proof: str | Unset = UNSET

    def __post_init__(self) -> None:
        """Put the verdict into words; where an old file says that samples hold, nothing is shown by them."""
        if self.verdict is UNSET and self.proof == SAMPLED and self.holds is True:
            force_setattr(self, "holds", None)
        if self.holds is not UNSET:
            force_setattr(self, "verdict", in_words(self.holds))


def in_words(holds: bool | None) -> str:
    """Return whether limits hold over a range, in words.

    Examples
    --------
    >>> in_words(True), in_words(False), in_words(None)
    ('yes', 'no', 'not shown')
    """
    return YES if holds is True else NO if holds is False else NOT_SHOWN


class LimitRating(RangeVerdict, frozen=True, kw_only=True, eq=False):
    """How a limit stands the range, at its worst point; the fields of ``RangeVerdict`` come first.

    Parameters
    ----------
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

    residual: Number | Unset = UNSET
    value: Number | Unset = UNSET
    limit: Number | Unset = UNSET
    utilisation: Number | Unset = UNSET
    at: Mapping[str, float] | Unset = UNSET
    position: Sequence[float] | Unset = UNSET


class DesignRating(RangeVerdict, frozen=True, kw_only=True, eq=False):
    """The ``robust`` of a design; empty where it was not rated. The fields of ``RangeVerdict`` come first.

    Parameters
    ----------
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

    share_good: float | Unset = msgspec.field(name="yield", default=UNSET)
    yield_low: float | Unset = UNSET
    yield_high: float | Unset = UNSET
    confidence: float | Unset = UNSET
    samples: int | Unset = UNSET
    worst_limit: str | Unset = UNSET
    worst_utilisation: Number | Unset = UNSET
    worst_residual: Number | Unset = UNSET
    worst_at: Mapping[str, float] | Unset = UNSET
    units: Mapping[str, str] | Unset = UNSET
    limits: Mapping[str, LimitRating] | Unset = UNSET

    def __post_init__(self) -> None:
        """Put the verdict into words; a yield of 1 that nothing proves is of an old file."""
        if self.verdict is UNSET and self.proof == SAMPLED and self.share_good == 1:
            force_setattr(self, "share_good", self.yield_low)
        super().__post_init__()


class RatingCounts(FileRecord, frozen=True, kw_only=True, eq=False):
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

    searches: int | Unset = UNSET
    rated: int | Unset = UNSET
    samples: int | Unset = UNSET
    limits_posed: int | Unset = UNSET
    taken_off: int | Unset = UNSET
