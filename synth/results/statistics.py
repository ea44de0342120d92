"""What a search tells of itself in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from synth.results.ratings import RatingCounts
from synth.results.told import UNTOLD, Told, Untold


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SearchStatistics(Told):
    """The ``statistics`` of a front; what a search has not done is not told.

    Parameters
    ----------
    combinations : int
        Of parts, counts and choices.
    rows_offered, rows_used : mapping
        Slot -> rows of its table, and those that remain after all restrictions.
    counts, choices : mapping
        Count or choice -> how many of its values remain.
    rows_left_out : list
        Slot, designation and reason of what was left out although it was offered.
    combinations_left_out : list of str
        What conditions that compare slots exclude, where there are any.
    not_asked : list of str
        Optional requirements that were not given.
    excluded_by_bound, solved : int
        Combinations that bounds exclude, and those solved.
    searched_together : int
        Questions that were answered at once.
    boxes : int
        Boxes that were tightened.
    scalar_problems : int
        Searches for one objective.
    designs_known : int
        Designs that the front was chosen from.
    nlp_solves, nlp_solves_to_find : int
        Continuous problems solved, and those until all designs were found; None where that was not reached.
    outer_trials : int
        Combinations drawn where neither bounds nor enumeration reach.
    seconds : mapping
        Stage -> time; ``total``.
    robust : RatingCounts
        What was rated and posed because something scatters.
    """

    combinations: int | Untold = UNTOLD
    rows_offered: Mapping[str, int] | Untold = UNTOLD
    rows_used: Mapping[str, int] | Untold = UNTOLD
    counts: Mapping[str, int] | Untold = UNTOLD
    choices: Mapping[str, int] | Untold = UNTOLD
    rows_left_out: Sequence[Mapping[str, str]] | Untold = UNTOLD
    combinations_left_out: Sequence[str] | Untold = UNTOLD
    not_asked: Sequence[str] | Untold = UNTOLD
    excluded_by_bound: int | Untold = UNTOLD
    solved: int | Untold = UNTOLD
    searched_together: int | Untold = UNTOLD
    boxes: int | Untold = UNTOLD
    scalar_problems: int | Untold = UNTOLD
    designs_known: int | Untold = UNTOLD
    nlp_solves: int | Untold = UNTOLD
    nlp_solves_to_find: int | Untold | None = UNTOLD
    outer_trials: int | Untold = UNTOLD
    seconds: Mapping[str, float] | Untold = UNTOLD
    robust: RatingCounts | Untold = UNTOLD

    @classmethod
    def from_json(cls, content: Mapping[str, Any]) -> Self:
        """Return the record that a file tells, the counts of ratings too."""
        found = dict(content)
        if "robust" in found:
            found["robust"] = RatingCounts.read(found["robust"])
        return super().from_json(found)
