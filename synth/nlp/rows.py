"""What every solver of continuous problems knows of limits and objectives."""

from __future__ import annotations

from dataclasses import dataclass

from synth.model.constraint import Goal, NodeConstraint

# A guard holds only strictly, by so much: beyond it the other formulas do not exist.
GUARD_MARGIN = 1e-6


@dataclass(frozen=True)
class Rows:
    """What the NLP knows of limits and objectives.

    Parameters
    ----------
    constraints : tuple of NodeConstraint
        Limits; a constant right side is handed over with each call.
    goals : tuple of Goal
        Objectives.
    log_constraints, log_goals : tuple of bool
        Which are positive on both sides, and so enter by logarithm.
    log_variables : tuple of bool
        Which variables are positive.
    """

    constraints: tuple[NodeConstraint, ...]
    goals: tuple[Goal, ...]
    log_constraints: tuple[bool, ...]
    log_goals: tuple[bool, ...]
    log_variables: tuple[bool, ...]

    @property
    def nodes(self) -> list[int]:
        """What is computed: both sides of each limit, as far as they move, then the objectives."""
        sides = [k for c in self.constraints for k in (c.value, c.limit) if k is not None]
        return sides + [goal.node for goal in self.goals]
