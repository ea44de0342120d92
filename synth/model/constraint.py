"""A limit as everything reads it: one record, whoever states it, what designs make of it, and its row in the program.

Search, check, ratings and explanations take their sides, senses and scales from here. Verification alone reads the
declaration itself (``synth.verification.verify``, ``synth.proof.tree``), so that a mistake made here would show.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from synth.declaration import Limit, Origin
from synth.model.limit_terms import MOST_TIMES
from synth.model.program import InputValue
from synth.order.feasibility import SLACK, SMALLEST

SYMBOLS = {"at_most": "<=", "at_least": ">=", "equal": "=="}


@dataclass(frozen=True, kw_only=True)
class Constraint:
    """A limit on designs of a model.

    Parameters
    ----------
    name : str
        As reports call it.
    sense : {"at_most", "at_least", "equal"}
    value : int
        Node of the program that is limited.
    bound : int or float
        What limits it: another node, or a number in SI.
    unit : str
        Of both sides, for reports.
    scale : float
        Smallest size that counts, in SI.
    terms : int, optional
        Node of the size of its largest term, where the sides do not tell it (:mod:`synth.model.limit_terms`).
    guard : bool
        Whether formulas exist only where it holds: then it holds strictly.
    origin : Origin
        Who states it.
    quantity : str
        The named quantity that a user limits; nothing where the family limits an expression.
    void_without : tuple of int
        Data inputs; where one of them has no value the limit does not count.
    behind : tuple of str
        Guards without which its sides do not exist.
    """

    name: str
    sense: str
    value: int
    bound: int | float
    unit: str
    scale: float = SMALLEST
    terms: int | None = None
    guard: bool = False
    origin: Origin = Origin.FAMILY
    quantity: str = ""
    void_without: tuple[int, ...] = ()
    behind: tuple[str, ...] = ()

    @property
    def most_terms(self) -> float:
        """Most that its terms count for, in SI: a bound that is given tells a size as well."""
        return MOST_TIMES * abs(self.bound) if isinstance(self.bound, float) and self.bound else math.inf

    @property
    def nodes(self) -> tuple[int, ...]:
        """Return the sides that are nodes of the program."""
        return (self.value, self.bound) if isinstance(self.bound, int) else (self.value,)

    def void(self, data: Sequence[InputValue], shape: tuple[int, ...]) -> np.ndarray:
        """Return for which designs it does not count: an optional column has no value.

        Parameters
        ----------
        data : list of numbers or arrays
            The data inputs of the model, which broadcast to the shape.
        shape : tuple of int
            Of the batch of designs.
        """
        gone = np.zeros(shape, dtype=bool)
        for k in self.void_without:
            gone |= np.isnan(np.asarray(data[k], dtype=float))
        return gone

    def declared(self, value: ca.SX) -> Limit:
        """Return the limit on a number as a declaration states it, of the expression that has its value there."""
        assert not isinstance(self.bound, int)
        return Limit(
            self.name, self.sense, self.unit, "", "", value, ca.SX(self.bound), self.guard, self.scale, self.origin
        )


def void_limits(constraints: Sequence[Constraint], data: Sequence[InputValue], count: int) -> np.ndarray:
    """Limits that do not count for some designs (designs, limits): an optional column has no value.

    Parameters
    ----------
    constraints : list of Constraint
    data : list of numbers or arrays (designs,)
        The data inputs of the model.
    count : int
        Designs.
    """
    void = np.zeros((count, len(constraints)), dtype=bool)
    for j, limit in enumerate(constraints):
        if limit.void_without:
            void[:, j] = limit.void(data, (count,))
    return void


@dataclass(frozen=True)
class NodeConstraint:
    """A limit as the propagation sees it: nodes of both sides (or a constant right side) and its sense.

    ``terms`` is the node of its largest term, where the sides do not tell it; ``slack`` the share of its size by which
    bounds loosen it.
    """

    sense: str
    value: int
    limit: int | None
    scale: float
    bound: float = 0.0
    guard: bool = False
    terms: int | None = None
    slack: float = SLACK

    @staticmethod
    def of(constraint: Constraint, slack: float = SLACK) -> NodeConstraint:
        """Row of a constraint."""
        x = constraint
        node, bound = (x.bound, 0.0) if isinstance(x.bound, int) else (None, x.bound)
        return NodeConstraint(x.sense, x.value, node, x.scale, bound, x.guard, x.terms, slack)

    @property
    def nodes(self) -> tuple[int, ...]:
        """Nodes that it reads: its sides, then its terms."""
        return tuple(k for k in (self.value, self.limit, self.terms) if k is not None)


@dataclass(frozen=True)
class Goal:
    """An objective as the propagation sees it: its node, and +1 to make it small or -1 to make it large."""

    node: int
    sign: int = 1
