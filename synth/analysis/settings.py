"""How much the analysis of given designs and refusals tries, and when it gives up: no part of an answer."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class WayOutLimits:
    """How ways out of a question without a design are looked for.

    Parameters
    ----------
    farthest : float
        The largest amount by which anything may give way, as the logarithm of a factor: twenty.
    gap : float
        Of the amount by which something must give way.
    boxes : int
        For each way out.
    nothing : float
        An amount as small as this is none, as the logarithm of a factor.
    first : int
        Limits that are looked at first.
    flat : float
        An elasticity as small as this is none.
    slack : float
        Relative, of bounds, for rounding.
    digits : int
        Of the value that is told where it does; where it does not, it has more.
    further : int
        Roundings of a value that are tried: to few digits, then to more, each further on the side where it does.
    """

    farthest: float = 3.0
    gap: float = 8e-3
    boxes: int = 100_000
    nothing: float = 1e-7
    first: int = 4
    flat: float = 1e-12
    slack: float = 1e-12
    digits: int = 4
    further: int = 6


@dataclass(frozen=True, kw_only=True)
class DerivedLimits:
    """How the variables of a given design are found for which derived quantities stand.

    Parameters
    ----------
    starts : int
        At random within what is searched, beside the middle.
    again : int
        Of the starts, that are tried again where solutions may lie outside of what is searched.
    outside : int
        Starts at random over three times the range.
    wider : float
        How many times further than it is searched a variable may lie.
    solved : float
        Relative: derived quantities that are met this closely are met.
    newton : int
        Steps at the end, as least squares stops at the square root of what is reachable.
    smallest : float
        SI. Of quantities: what is smaller is compared with it; and relative, of ranges.
    """

    starts: int = 24
    again: int = 6
    outside: int = 8
    wider: float = 100.0
    solved: float = 1e-12
    newton: int = 8
    smallest: float = 1e-12


@dataclass(frozen=True, kw_only=True)
class GuardLimits:
    """How far and how closely is looked for what a requirement must become so that a refusal goes away.

    Parameters
    ----------
    farthest : float
        As the logarithm of a factor: twenty.
    steps : int
        Into which that is divided.
    halvings : int
        Of the step that frees it: to nine digits.
    """

    farthest: float = 3.0
    steps: int = 12
    halvings: int = 26


DERIVED = DerivedLimits()
GUARDS = GuardLimits()
WAYS_OUT = WayOutLimits()
