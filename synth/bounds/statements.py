"""The statements that interval code is made of, whichever language it is written in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from synth.bounds.intervals import Interval


@dataclass(frozen=True)
class Assign:
    """A name takes the value of an expression."""

    target: str
    value: str


@dataclass(frozen=True)
class Kill:
    """Boxes die where a condition holds."""

    condition: str


@dataclass(frozen=True)
class Enclose:
    """``s`` and ``t`` become the ends of a node by a rule for both at once; ``rule`` is an operation or a special."""

    function: str
    args: tuple[int, ...]


@dataclass(frozen=True)
class Hold:
    """A node is held within what limits tell of it over the whole question, if they tell more than its arguments."""

    node: int


@dataclass(frozen=True)
class Narrow:
    """Arguments of a node, those at some positions, are narrowed by the rule of its operation."""

    op: int
    node: int
    args: tuple[int, ...]
    positions: tuple[int, ...]


@dataclass(frozen=True)
class EndOfFirstSweep:
    """The first sweep over all nodes is over: dead boxes need not be followed further."""


Statement = Assign | Kill | Enclose | Hold | Narrow | EndOfFirstSweep


@dataclass(frozen=True)
class SweepStatements:
    """The statements of the first forward-backward sweep and of those that follow, and what they read and give.

    ``l3`` and ``h3`` are the ends of node 3, ``B`` the constant right sides, ``C`` the cutoffs and ``F`` the floors of
    objectives, ``RL`` and ``RH`` what holds over the whole question, ``o4`` whether limit 4 is open; ``s``, ``t`` and
    ``m`` are numbers and ``p`` and ``q`` conditions on the way.
    """

    first: tuple[Statement, ...]
    later: tuple[Statement, ...]
    constants: tuple[int, ...]
    tables: tuple[int, ...]
    variables: tuple[tuple[int, int], ...]
    goals: tuple[str, ...]
    limits: int


def special_range(function: Any, args: Sequence[Interval]) -> Interval:
    """Return the range of a special function: it is monotone in every argument."""
    rising = [low >= 0 for low, _ in function.elasticity]
    least = function.formula(*[a[0] if up else a[1] for a, up in zip(args, rising, strict=True)])
    most = function.formula(*[a[1] if up else a[0] for a, up in zip(args, rising, strict=True)])
    inside = np.logical_and.reduce(np.broadcast_arrays(*[a[0] >= 0 for a in args]))
    return np.where(inside, least, -np.inf), np.where(inside, most, np.inf)
