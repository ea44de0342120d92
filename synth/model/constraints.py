"""Limits and goals as positions in a traced program."""

from __future__ import annotations

from dataclasses import dataclass

from synth.model.constraint import Constraint

# -- limits and objectives ---------------------------------------------------------------------


@dataclass(frozen=True)
class NodeConstraint:
    """A limit as the propagation sees it: nodes of both sides (or a constant right side) and its sense."""

    sense: str
    value: int
    limit: int | None
    scale: float
    bound: float = 0.0
    guard: bool = False

    @staticmethod
    def of(constraint: Constraint) -> NodeConstraint:
        """Return the row of a constraint."""
        x = constraint
        node, bound = (x.bound, 0.0) if isinstance(x.bound, int) else (None, x.bound)
        return NodeConstraint(x.sense, x.value, node, x.scale, bound, x.guard)


@dataclass(frozen=True)
class Goal:
    """An objective as the propagation sees it: its node, and +1 to make it small or -1 to make it large."""

    node: int
    sign: int = 1
