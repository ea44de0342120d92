"""What the proof is asked: coordinates, limits and points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Coordinate:
    """One input that moves: a variable, a ladder (makeable values, counts, choices) or a column of a slot.

    A value inside of the formulas that boxes carry along counts as a variable.
    """

    kind: str  # variable, ladder, column
    group: int  # number of the variable, ladder or slot
    column: int
    low: float
    high: float

    @property
    def log(self) -> bool:
        """Whether distances count by logarithm."""
        return self.low > 0

    @property
    def least(self) -> float:
        """The least size of a value."""
        return max(self.low, -self.high, 0.0)


@dataclass(frozen=True)
class LimitSides:
    """A limit: instructions of its two sides (or a number), and the columns without which it is void."""

    value: int
    bound: int | float
    sense: str
    scale: float
    terms: int | None = None  # instruction of its largest term, where the sides do not tell it
    void: tuple[int, ...] = ()
    guard: bool = False
    share: float = 1.0  # of the tolerances of limits


@dataclass(frozen=True)
class Point:
    """A single design: variables in the declared order, data inputs of the model, and the row of each slot."""

    variables: np.ndarray
    data: list[float]
    rows: dict[str, int]


@dataclass(frozen=True)
class ProofOutcome:
    """How a proof ended: closed, or refuted by a design, or neither; ``open_regions`` are those not proven."""

    closed: bool
    nodes: int
    witness: Point | None = None
    open_regions: tuple[int, ...] = ()
