"""What a search tells of itself in numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from synth.results.ratings import RatingCounts
from synth.results.record import UNSET, FileRecord, Unset


class SearchStatistics(FileRecord, frozen=True, kw_only=True, eq=False):
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

    combinations: int | Unset = UNSET
    rows_offered: Mapping[str, int] | Unset = UNSET
    rows_used: Mapping[str, int] | Unset = UNSET
    counts: Mapping[str, int] | Unset = UNSET
    choices: Mapping[str, int] | Unset = UNSET
    rows_left_out: Sequence[Mapping[str, str]] | Unset = UNSET
    combinations_left_out: Sequence[str] | Unset = UNSET
    not_asked: Sequence[str] | Unset = UNSET
    excluded_by_bound: int | Unset = UNSET
    solved: int | Unset = UNSET
    searched_together: int | Unset = UNSET
    boxes: int | Unset = UNSET
    scalar_problems: int | Unset = UNSET
    designs_known: int | Unset = UNSET
    nlp_solves: int | Unset = UNSET
    nlp_solves_to_find: int | Unset | None = UNSET
    outer_trials: int | Unset = UNSET
    seconds: Mapping[str, float] | Unset = UNSET
    robust: RatingCounts | Unset = UNSET
