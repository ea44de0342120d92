"""What a search has done so far, as one record that is handed from one formulation of a question to the next."""

from __future__ import annotations

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
    work : int
        Evaluations of the solver times nodes of the program: what it costs without compiled code of its own.
    solved_combinations : set of int
        Combinations of which a continuous problem was solved.
    """

    contracted: int = 0
    nlp_solves: int = 0
    work: int = 0
    solved_combinations: set[int] = field(default_factory=set)
