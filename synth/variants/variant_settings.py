"""The numbers that the choice of a size range goes by: how much it tries, and how much it does at a time.

With others it takes longer or leaves a larger gap, and says so. ``VARIANTS`` are those that everybody gets.
"""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class MedianSettings:
    """How the p-median problem is solved.

    Parameters
    ----------
    swaps : int
        Exchanges of a choice, and choices that prices propose of which exchanges are tried.
    promising : float
        Times the cost of the best choice known: what prices propose must be cheaper to be improved by exchanges.
    saving : float
        Share of the scale of the costs that an exchange must save, as sums may differ by less through rounding.
    pricings : int
        Steps of the Lagrangean bound.
    first_step, least_step : float
        Of these, as a share of the way to where the bound would meet the cost; it ends at the least one.
    patience : int
        Steps without a better bound, after which they are half as long.
    target : float
        Times the cost of the best choice known: where steps aim, a little above it so that they do not fade there.
    rise : float
        Share of the scale of the costs by which a bound must be better to count as better.
    rounds : int
        Of cutting the linear relaxation.
    broken : float
        Share of the scale of the costs from which a cut counts as broken, and below which a gap is closed.
    rounding : float
        A gap as small as this is the arithmetic's.
    """

    swaps: int = 200
    promising: float = 1.02
    saving: float = 1e-12
    pricings: int = 600
    first_step: float = 1.5
    least_step: float = 1e-3
    patience: int = 15
    target: float = 1.001
    rise: float = 1e-9
    rounds: int = 60
    broken: float = 1e-7
    rounding: float = 1e-9


@dataclass(frozen=True, kw_only=True)
class VariantSettings:
    """All numbers that the choice of a size range goes by.

    Parameters
    ----------
    medians : MedianSettings
    pairs : int
        Of questions and variants that are evaluated at a time: what memory allows. The result is the same.
    sample : int
        Questions on which candidates are tried where there are too many of them.
    curve_points : int
        Numbers of variants of which the curve is made; beyond half of them they lie further and further apart.
    """

    medians: MedianSettings = field(default_factory=MedianSettings)
    pairs: int = 40_000
    sample: int = 400
    curve_points: int = 40


VARIANTS = VariantSettings()
