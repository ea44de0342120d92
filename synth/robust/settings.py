"""Settings of searches for worst cases."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, kw_only=True)
class AscentSettings:
    """How the worst point of a limit is searched from the worst samples. Nothing is proven by it.

    Parameters
    ----------
    rounds : int
        At most so many.
    starts : int
        Samples from which it begins.
    candidates : int
        The worst samples among which these are chosen.
    apart : float
        Least distance of two starts, as a share of the range.
    first_step, last_step : float
        Shares of the range.
    grow, shrink : float
        Of the step after success and after failure.
    strides : tuple of float
        Steps along the slope, in units of the step along the axes.
    """

    rounds: int = 60
    starts: int = 6
    candidates: int = 512
    apart: float = 0.15
    first_step: float = 0.25
    last_step: float = 1e-9
    grow: float = 2.0
    shrink: float = 0.4
    strides: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)


@dataclass(frozen=True, kw_only=True)
class RobustLimits:
    """How designs are rated over a range, and how often others are asked for that keep their limits over all of it.

    Parameters
    ----------
    searches : int
        At most so many, each with more points at which limits are posed.
    searches_for_first : int
        The same as long as the first design or the best in an objective fails: the order of all hangs on them.
    scenarios : int
        New points per limit.
    parts : int
        Boxes that a range is cut into, to prove a limit that is not monotone.
    batch : int
        Boxes that are bounded at a time.
    narrowest : float
        Width of the least box, as a share of the range: where one that small is not decided, none is.
    steep : float
        Relative: a derivative as small as this may have the wrong sign by rounding.
    pad : float
        Relative: a bound this close to a limit may lie on the wrong side of it by rounding.
    points : int
        That are evaluated at a time. The result is the same for any number.
    ascent : AscentSettings
        Of limits that are not monotone.
    """

    searches: int = 5
    searches_for_first: int = 12
    scenarios: int = 4
    parts: int = 2**14
    batch: int = 2**8
    narrowest: float = 1e-12
    steep: float = 1e-12
    pad: float = 1e-10
    points: int = 2**15
    ascent: AscentSettings = field(default_factory=AscentSettings)


ROBUST = RobustLimits()
