"""What a search has done so far, as one record that is handed from one formulation of a question to the next."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field


@dataclass
class SearchCounters:
    """What a search has done so far.

    Parameters
    ----------
    contracted : int
        Boxes that were tightened.
    nlp_solves : int
        Continuous problems that were solved.
    solved_combinations : set of int
        Combinations of which a continuous problem was solved.
    """

    contracted: int = 0
    nlp_solves: int = 0
    solved_combinations: set[int] = field(default_factory=set)

    def add(self, other: SearchCounters, solved: Iterable[int]) -> None:
        """Count what another search has done, whose solved combinations have these numbers here."""
        self.contracted += other.contracted
        self.nlp_solves += other.nlp_solves
        self.solved_combinations.update(solved)
