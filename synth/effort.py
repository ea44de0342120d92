"""How much work a search takes upon itself before it ends although something is still open."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class SearchEffort:
    """What is done about boxes that a first effort has left open.

    Counts of boxes decide wherever they can, so that the same question goes the same way on every machine; the budget
    of time is the last net.

    Parameters
    ----------
    seconds : float
        The budget: so long the search goes on with what a first effort has left open. A time limit takes its place.
    spell : int
        Boxes between two looks at whether boxes keep closing.
    patience : int
        Spells in which neither fewer boxes wait, nor the gap of those that wait is smaller, nor what they hold together
        is, after which it ends.
    closing : float
        The share of what open boxes hold together by which it must fall to count.
    most_waiting : int
        Boxes that may wait; when there are more, those that nearly close come first, so that they become fewer.
    most_stuck : int
        Boxes that are open but too small to be split, after which it ends: limits leave a sliver that never closes.
    """

    seconds: float = 60.0
    spell: int = 1_000_000
    patience: int = 10
    closing: float = 0.05
    most_waiting: int = 1_000_000
    most_stuck: int = 20_000


@dataclass(frozen=True, kw_only=True)
class CompilingEffort:
    """How long a compiler may work, and when it is not begun at all.

    Parameters
    ----------
    worthwhile : float
        In s: a time limit shorter than that may be over before anything is compiled. What has such a limit is done
        without code that is not there yet.
    most : float
        In s, after which a compiler is given up.
    """

    worthwhile: float = 10.0
    most: float = 300.0
