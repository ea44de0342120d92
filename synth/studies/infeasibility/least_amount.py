"""The least by which something must give way: one search of a relaxed question each time."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from synth.analysis.settings import WAYS_OUT, WayOutLimits
from synth.errors import RefusedError
from synth.question.instance import Instance
from synth.question.settings import Progress, SearchSettings
from synth.results import Design
from synth.search.question import one_best
from synth.studies.infeasibility.explained_question import ExplainedQuestion, Pin
from synth.studies.infeasibility.relaxation import AMOUNT, LIMIT, Relaxed
from synth.system.deadline import Stopped


@dataclass(frozen=True)
class LeastAmount:
    """The design that needs the least amount; ``closed`` where nothing less does, or surely none is."""

    design: Design | None
    closed: bool

    @property
    def amount(self) -> float:
        """How far what gives way must do so, as the logarithm of a factor."""
        return math.inf if self.design is None else self.design.values[AMOUNT]


@dataclass(frozen=True, kw_only=True)
class Giving:
    """What gives way in a relaxed question, and what stays.

    Parameters
    ----------
    give : mapping
        (kind, name) of requirements, limits and part columns -> 1 or -1, upwards or downwards.
    kept : list of str, optional
        Limits that count; None: all.
    most : float, optional
        The largest amount; None: the farthest that anything may give way.
    pins : list of Pin
        Give way as well.
    free : collection of str
        Slots and choices that may be anything that the family offers.
    rooms : mapping, optional
        Requirement -> the largest amount that its declared range allows.
    """

    give: Mapping[tuple[str, str], float]
    kept: Sequence[str] | None = None
    most: float | None = None
    pins: Sequence[Pin] = ()
    free: Collection[str] = ()
    rooms: Mapping[str, float] | None = None


class RelaxedSearch:
    """Asks relaxed forms of a question, within the time that there is for all of them.

    Parameters
    ----------
    question : ExplainedQuestion
    settings : SearchSettings
        Of which the seed counts.
    deadline : float
        As of ``time.monotonic``.
    progress : callable, optional
        Told how far the explanation is.
    ways : WayOutLimits
    """

    def __init__(
        self,
        question: ExplainedQuestion,
        settings: SearchSettings,
        deadline: float = math.inf,
        progress: Progress | None = None,
        ways: WayOutLimits = WAYS_OUT,
    ) -> None:
        self.question, self.deadline, self.progress, self.ways = question, deadline, progress, ways
        self.settings = replace(settings, points=1, gap=ways.gap, workers=1)

    def say(self, stage: str, done: float, message: str) -> None:
        """Show progress, and stop where time is over."""
        if time.monotonic() > self.deadline:
            raise Stopped("time limit")
        if self.progress is not None:
            self.progress({"stage": stage, "done": done, "message": message})

    def least(self, giving: Giving) -> LeastAmount:
        """Return the design that needs the least amount, of all that keep the limits.

        Raises
        ------
        Stopped
            When time is over.
        """
        spare = self.deadline - time.monotonic()
        if spare <= 0:
            raise Stopped("time limit")
        try:
            instance = self._relaxed(giving)
        except RefusedError:
            return LeastAmount(None, True)
        front = one_best(instance, AMOUNT, self.settings.within(None if spare == math.inf else spare), self.ways.boxes)
        if front.interrupted:
            raise Stopped(front.interrupted)
        return LeastAmount(front.designs[0] if front.designs else None, front.certificate.kind == "global")

    def _relaxed(self, giving: Giving) -> Instance:
        """Return the question in which something gives way."""
        question = self.question
        ends = [end for pin in giving.pins for end in pin.ends(question.instance.model)]
        give = {**giving.give, **{(LIMIT, x.name): sign for x, sign in ends if x.bound}}
        limits = [*(question.limits if giving.kept is None else giving.kept), *(x.name for x, _ in ends)]
        user_limits = [*question.user_limits, *(x for x, _ in ends)]
        farthest = self.ways.farthest
        relaxed = Relaxed(question.instance, user_limits, give, limits, giving.rooms, giving.free, farthest)
        loose = {*giving.free, *(pin.name for pin in giving.pins)}
        fix, bounds, parts = (
            {name: value for name, value in selection.items() if name not in loose}
            for selection in (question.fix, question.bounded, question.parts)
        )
        # Where nothing gives way any design will do.
        fix |= {} if give else {AMOUNT: 0.0}
        bounds |= {AMOUNT: f"<= {giving.most!r}"} if giving.most is not None and giving.most < farthest else {}
        request = replace(
            question.request, problem=relaxed, requirements=question.requirements, parts=parts, limits=bounds, fix=fix
        )
        return Instance(request)
