"""What is known of an elementary operation."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from enum import Flag, auto
from functools import cached_property
from typing import Any, Protocol

import numpy as np

INF = float("inf")
Interval = tuple[Any, Any]  # both ends, of one interval or of many
Ends = tuple[float, float]
Enclosure = Callable[..., Interval]
BackwardRule = Callable[..., Interval | None]  # of the interval of the result, and those of the arguments


@dataclass(frozen=True)
class Domain:
    """Numbers between two ends, which belong to it unless it is open."""

    low: float
    high: float
    open: bool = False

    def holds(self, ends: Ends) -> bool:
        """True if a whole interval lies in it."""
        inside = operator.lt if self.open else operator.le
        # What is not bounded is not asked about: not-a-number may stand there.
        above = self.low == -INF or inside(self.low, ends[0])
        return above and (self.high == INF or inside(ends[1], self.high))


@dataclass(frozen=True)
class Elasticity:
    """Elasticity of a function of one positive argument y, as far as the function is positive.

    It is a function of y that rises (log-convex) or falls (log-concave) all the way from ``first`` at the lower end of
    the domain to ``last`` at the upper one.
    """

    domain: Ends
    at: Callable[[Any], Any]
    first: float
    last: float
    sign: int = 1

    @property
    def rising(self) -> bool:
        """True if the function rises all the way."""
        return min(self.first, self.last) >= 0

    @property
    def falling(self) -> bool:
        """True if the function falls all the way."""
        return max(self.first, self.last) <= 0

    def ends(self, argument: Ends) -> Ends:
        """Range of the elasticity over a range of the argument."""
        values = []
        for y, limit in zip(argument, (self.first, self.last), strict=True):
            if y <= self.domain[0]:  # also the upper end of a range that is this point alone
                values.append(self.first)
                continue
            value = float(self.at(np.float64(y))) if y < self.domain[1] else self.last
            values.append(value if np.isfinite(value) else limit)
        return min(values), max(values)


class Trait(Flag):
    """What holds of an operation or does not."""

    DIVIDES = auto()  # it is undefined where its last argument is zero
    NEVER_NEGATIVE = auto()
    KEEPS_SIGN = auto()  # its value is not negative where no argument is
    ADDS = auto()  # sizes of its arguments add to that of the result
    CROSSES_ZERO = auto()  # it is zero where its argument is not
    STAYS_INFINITE = auto()  # infinite or without value where an argument is infinite; of a quotient the dividend
    # Its enclosure gives no number only where an end of an argument is none, and no infinite end with the wrong sign.
    ROUNDS_WELL = auto()
    TRUTH = auto()  # its value is true or false
    COMMUTES = auto()  # its arguments can be exchanged
    KEEPS_UNIT = auto()  # its value has the dimension of its arguments


NO_TRAIT = Trait(0)


class Nodes(Protocol):
    """A program to which nodes can be added."""

    def put(self, name: str, *args: int) -> int:
        """Node of an operation, by its name."""

    def size(self, node: int) -> int:
        """Node of the size of another."""

    def number(self, value: float) -> int:
        """Node of a constant."""


@dataclass(frozen=True)
class InCell:
    """Formula of a spreadsheet.

    Arguments stand in braces, with how firmly each must hold together (``term``, ``factor``, ``divisor``, ``base``), or
    ``cell`` for one that stands there several times; ``negative`` is minus the argument, ``power`` e to it. Where the
    whole must hold together as firmly as ``falls_apart_in`` it needs brackets.
    """

    text: str
    falls_apart_in: str | None = None


@dataclass(frozen=True, kw_only=True)
class Operation:
    """What is known of an operation; proofs know it by themselves.

    Parameters
    ----------
    name : str
        CasADi's, in capitals.
    numeric : str
        NumPy code over arrays, with numbers in braces for its arguments.
    text : str
        What formulas as trees call it; empty where they have a form of their own for it.
    scalar : callable, optional
        Its value for plain numbers, if it has a text.
    enclosure : callable, optional
        Interval of the result from those of the arguments; without one nothing is known of the result.
    backward : tuple
        What the interval of the result says of each argument; None where nothing follows.
    domain : Domain, optional
        Where it is defined; None where that is everywhere, or no interval of one argument.
    instruction : str
        Instruction over registers that computes it; empty where it takes several.
    function : callable, optional
        Of NumPy, if it is a single one.
    finite : Domain, optional
        Where its value is a finite number, if it is not wherever it is defined.
    exponent : float, optional
        The logarithm of the size of the result is so many times that of the argument; twice something adds a constant.
    elasticity, mirrored : Elasticity, optional
        Of the function at y, and of its size at -y.
    slope : callable, optional
        Node of the size of its derivative, or of a bound of that, given its own node and that of its argument.
    traits : Trait
    plain : tuple, optional
        Text of another function of the argument plus a number, plus another number, which is the same.
    sheet : InCell, optional
        How spreadsheets write it, where they have no function of the same text.
    """

    name: str
    numeric: str
    text: str
    scalar: Callable[..., Any] | None
    enclosure: Enclosure | None
    backward: tuple[BackwardRule | None, ...]
    domain: Domain | None
    instruction: str
    function: Callable[..., Any] | None = None
    finite: Domain | None = None
    exponent: float | None = None
    elasticity: Elasticity | None = None
    mirrored: Elasticity | None = None
    slope: Callable[[Nodes, int, int], int] | None = None
    traits: Trait = NO_TRAIT
    plain: tuple[str, float, float] | None = None
    sheet: InCell | None = None

    def __post_init__(self) -> None:
        if len(self.backward) != self.arity:
            raise TypeError(f"{self.name} has {self.arity} arguments and {len(self.backward)} rules backward")
        if bool(self.text) != (self.scalar is not None):
            raise TypeError(f"{self.name} has a text without a value, or a value without a text")

    @cached_property
    def arity(self) -> int:
        """Number of arguments."""
        return next(n for n in (3, 2, 1) if f"{{{n - 1}}}" in self.numeric)
