"""A family that takes part in a comparison: its search, which is kept, and its designs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth.question.instance import Instance
from synth.question.settings import Progress
from synth.question.uncertainty import RATE
from synth.results import Design, ParetoFront
from synth.robust.rating import Rater
from synth.search.front_state import FrontState
from synth.search.question import Question
from synth.search.settings import Tuning
from synth.search.warm_start import WarmStart
from synth.studies.families.requirement_sheet import Applicant
from synth.system.deadline import Stopped


@dataclass
class Competitor:
    """A family that is searched, and its designs on the way to the common front.

    Parameters
    ----------
    one : Applicant
    state : FrontState
        What its own search knows, of which more is asked.
    front : ParetoFront
        Of its own search.
    designs : list of Design
        Those of its front, and more that were found against the others.
    amounts : array (objectives,)
        In SI: by how much designs of others had to be beaten to count.
    rater : Rater, optional
        Rates its designs where something scatters.
    """

    one: Applicant
    state: FrontState
    front: ParetoFront
    designs: list[Design]
    amounts: np.ndarray
    rater: Rater | None = None

    @property
    def incomplete(self) -> bool:
        """True if designs are missing that did not stand the range: others may have been left out for them."""
        return bool(self.front.statistics.get("robust", {}).get("taken_off"))

    def with_what_it_had(self, before: Competitor | None) -> Competitor:
        """Itself; where it was stopped, with the designs of an earlier search of the same question."""
        if before is None or not self.front.interrupted:
            return self
        front = self.front if len(self.front.designs) >= len(before.front.designs) else before.front
        return replace(self, front=front, designs=[*self.designs, *before.designs])

    def standing(self, designs: Sequence[Design], deadline: float) -> list[Design]:
        """Return its designs without those that fail within the range, if they must not; rated, if anything scatters.

        Raises
        ------
        Stopped
            When there was no time to rate them.
        """
        if self.rater is None:
            return list(designs)
        ratings, stopped = self.rater.rate(designs, None, deadline)
        if stopped:
            raise Stopped(stopped)
        rated = [replace(d, frame=self.front.frame, robust=r) for d, r in zip(designs, ratings, strict=True)]
        return [d for d in rated if d.robust["holds"] is not False or self.rater.uncertainty.mode == RATE]


class KeptQuestion:
    """A question that keeps the search by which it was answered, as more is asked of it."""

    def __init__(self, question: Question) -> None:
        self.question = question
        self.state: FrontState | None = None

    @property
    def instance(self) -> Instance:
        """The model with its requirements and restrictions."""
        return self.question.instance

    @property
    def tuning(self) -> Tuning:
        """What its search goes by."""
        return self.question.tuning

    def within(self, seconds: float | None) -> KeptQuestion:
        """Limit the time of what is asked next."""
        self.question = self.question.within(seconds)
        return self

    def answer(self, progress: Progress | None = None, known: Sequence[Design] = ()) -> ParetoFront:
        """Search the designs; the arguments are those of ``Question.answer``."""
        search = self.question.search(progress, WarmStart(designs=known))
        self.state = search.state
        return search.run(self.question.report())
