"""The numbers of what is asked about a front afterwards: how much it tries, and when it gives up.

As in ``synth.search.settings`` none of them is part of an answer: with other numbers less is told, or later.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class NearLimits:
    """How far designs that are nearly as good as a chosen one are enumerated.

    Parameters
    ----------
    batch : int
        Boxes that are looked into at a time.
    boxes : int
        That are looked into in all.
    most : int
        Combinations that are told apart; more are only said to be more.
    problems : int
        Continuous problems that are solved at a time.
    rounded : int
        Makeable points around one continuous optimum that are tried.
    settling_boxes : int
        Boxes for making one design as good as its parts allow.
    settling_gap : float
        The gap of that.
    widest : float
        Share by which designs may be asked to be worse, at most: beyond it hardly a limit of the objective is left.
    """

    batch: int = 2048
    boxes: int = 2_000_000
    most: int = 20_000
    problems: int = 1024
    rounded: int = 256
    settling_boxes: int = 20_000
    settling_gap: float = 1e-3
    widest: float = 0.5


@dataclass(frozen=True, kw_only=True)
class PriceLimits:
    """How prices are found, and when they count as confirmed.

    Parameters
    ----------
    all : int
        Combinations that are all tried; of more, those that differ in one part and those on the front.
    fine : float
        Share of the step: for prices that bend within it.
    share, slack : float
        By how much a price and a re-solve may differ: a share of the price, and per cent per per cent.
    parents : int
        Of the combinations tried, the best, of which again one part is exchanged.
    reach : float
        In steps: combinations that are worse by more are not tried again.
    looser : float
        In steps: nor those that need limits looser by more.
    even : float
        Relative: what is better by more is better without a step.
    binds : float
        Multiplier from which a limit binds.
    alike : float
        Relative: prices upwards and downwards that differ by less are told as one.
    """

    all: int = 512
    fine: float = 0.1
    share: float = 0.03
    slack: float = 0.003
    parents: int = 8
    reach: float = 10.0
    looser: float = 5.0
    even: float = 1e-6
    binds: float = 1e-4
    alike: float = 5e-3


@dataclass(frozen=True, kw_only=True)
class BreakLimits:
    """How closely is told where the best parts change between two steps.

    Parameters
    ----------
    width : float
        Of a value: a break is known to be within this.
    finest : float
        Of the step: how narrow the range of a break at zero gets.
    gap : float
        Of the searches that compare parts.
    same : float
        Relative: values that differ by less count as equal, so that parts that tie do not change at random. At least
        twice the gap.
    most : int
        Breaks of one objective between two steps.
    at_once : int
        Intervals that are looked into together; what is found of them is kept together.
    parts : int
        Into which an interval is divided at a time.
    guesses : int
        Where a break lies, before its interval is simply halved.
    seconds : float
        Of one search.
    """

    width: float = 1e-3
    finest: float = 1e-6
    gap: float = 1e-5
    same: float = 2e-5
    most: int = 20
    at_once: int = 64
    parts: int = 6
    guesses: int = 4
    seconds: float = 60.0


@dataclass(frozen=True, kw_only=True)
class ComparisonLimits:
    """How long families are made to compete.

    Parameters
    ----------
    rounds : int
        In which every family looks for designs that beat those of the others; mostly two or three are enough.
    budget : float
        In s, for all families where no time limit is stated: with reading and writing an answer takes a minute.
    """

    rounds: int = 6
    budget: float = 50.0


@dataclass(frozen=True, kw_only=True)
class StudyTexts:
    """How much of a study a drawing and a line of text hold.

    Parameters
    ----------
    lines : int
        Of a drawing; one with more is not read.
    labels, ticks : int
        Of a drawing; break points have a line below it each.
    missed : int
        Limits that a line names.
    """

    lines: int = 7
    labels: int = 12
    ticks: int = 20
    missed: int = 2


COMPARING = ComparisonLimits()
STUDY_TEXTS = StudyTexts()
NEAR = NearLimits()
PRICES = PriceLimits()
BREAKS = BreakLimits()
