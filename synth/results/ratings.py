"""How designs stand what scatters, as fronts tell it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Self

from synth.results.told import UNTOLD, Told, Untold


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LimitRating(Told):
    """How a limit stands the range, at its worst point.

    Parameters
    ----------
    holds : bool
        There, and so everywhere as far as ``proof`` tells.
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

    holds: bool | Untold = UNTOLD
    proof: str | Untold = UNTOLD
    residual: float | Untold | None = UNTOLD
    value: float | Untold | None = UNTOLD
    limit: float | Untold | None = UNTOLD
    utilisation: float | Untold | None = UNTOLD
    at: Mapping[str, float] | Untold = UNTOLD
    position: Sequence[float] | Untold = UNTOLD


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class DesignRating(Told):
    """The ``robust`` of a design; empty where it was not rated.

    Parameters
    ----------
    holds : bool
        Whether it keeps all limits, as far as ``proof`` tells.
    proof : str
        ``proven`` or ``sampled``.
    share_good : float
        Under the key ``yield``: share of the samples that keep all limits.
    yield_low, yield_high : float
        Ends of the confidence interval of that share.
    confidence : float
        Of that interval.
    samples : int
    worst_limit : str
        The limit with the largest residual.
    worst_utilisation, worst_residual : float or None
        Of that limit.
    worst_at : mapping
        What scatters -> value in SI where it is worst.
    units : mapping
        What scatters -> unit in which it is shown.
    limits : mapping
        Limit -> LimitRating.
    """

    holds: bool | Untold = UNTOLD
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
        """Return the record that a file tells, its limits too."""
        found = dict(content)
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
