"""Fronts whose limits hold over the whole range of what scatters, checked design by design."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from msgspec import structs

from synth.order.feasibility import Status
from synth.order.pareto import extremes, senses_of
from synth.question.instance import Instance
from synth.question.settings import LEAST_SECONDS, Progress
from synth.question.uncertainty import LIMITS, Uncertainty
from synth.results import Design, ParetoFront
from synth.results.assembly import ranked, scale_of
from synth.results.ratings import DesignRating, RatingCounts
from synth.robust.rating import Rater
from synth.robust.settings import RobustLimits
from synth.robust.uncertainty import check_rows
from synth.system.deadline import INTERRUPTED

GRACE = 2.0  # s, in which known designs are rated although time is over
NOTHING_STANDS = "no design was found that keeps its limits over the whole range"


# ---- fronts ---------------------------------------------------------------------------------------------------------


class Tunes(Protocol):
    """Settings of a search."""

    @property
    def robust(self) -> RobustLimits:
        """Those of worst cases."""
        ...


class Asks(Protocol):
    """A question that was checked: see ``synth.search.front_search``."""

    @property
    def instance(self) -> Instance:
        """The model with its requirements and restrictions."""
        ...

    @property
    def tuning(self) -> Tunes:
        """Settings of its search."""
        ...

    def within(self, seconds: float | None) -> Asks:
        """Return the same with another time limit; None: without any."""
        ...

    def answer(self, progress: Progress | None = None, known: Sequence[Design] = ()) -> ParetoFront:
        """Search the designs."""
        ...


def robust_front(
    pose: Callable[[Uncertainty], Asks],
    rater: Rater,
    progress: Progress | None = None,
    time_limit: float | None = None,
    known: Sequence[Design] = (),
    first: ParetoFront | None = None,
) -> ParetoFront:
    """Search designs and rate them; where limits are to hold over the range, until they do.

    Designs that keep all limits that were posed, but not everywhere in the range, tell where they fail: there those
    limits are posed as well, and the search begins again from what is known. What still fails in the end is taken off
    the front; what is neither shown to hold nor to fail stays, and says so. Each question asked leaves out limits at
    most, so that its bounds hold for all robust designs.

    Parameters
    ----------
    pose : callable
        Returns the question with the limits that a block poses.
    rater : Rater
        Rates designs of the nominal problem.
    progress, time_limit
        As for ``synthesize``.
    known : list of Design
        Where to look first.
    first : ParetoFront, optional
        The answer to the first question, where it is known.
    """
    deadline = math.inf if time_limit is None else time.monotonic() + time_limit

    def ask(uncertainty: Uncertainty, known: Sequence[Design], front: ParetoFront | None = None) -> _RatedFront:
        question = pose(uncertainty)
        check_rows(rater.quantities, question.instance.selection.slots)
        if front is None:
            remaining = None if time_limit is None else max(deadline - time.monotonic(), LEAST_SECONDS)
            front = question.within(remaining).answer(progress, known)
        # Designs that nobody rated are of little use: that takes a moment even where the time is over.
        ratings, stopped = rater.rate(front.designs, progress, max(deadline, time.monotonic() + GRACE))
        more = len(question.instance.model.limits) - len(rater.model.limits)
        return _RatedFront(uncertainty, front, ratings, front.interrupted or stopped, more, question.tuning.robust)

    got, searches = ask(rater.uncertainty, known, first), 1
    while got.uncertainty.mode == LIMITS and got.failing and not got.stopped and searches < got.most_searches:
        try:
            better = ask(got.uncertainty.with_scenarios(got.scenarios()), got.front.designs)
        except KeyboardInterrupt:
            got = replace(got, stopped=INTERRUPTED)
            break
        searches += 1
        # A search that was not finished counts only where it brought more designs that hold.
        got = replace(got, stopped=better.stopped) if better.stopped and better.holding <= got.holding else better
    return got.with_ratings(searches)


@dataclass(frozen=True)
class _RatedFront:
    """A front with the ratings of its designs, and what stopped the work if something did."""

    uncertainty: Uncertainty
    front: ParetoFront
    ratings: list[DesignRating]
    stopped: str
    added_limits: int  # limits beside those of the problem
    limits: RobustLimits

    @property
    def failing(self) -> list[int]:
        """Positions of the designs that break a limit somewhere in the range."""
        return [j for j, rating in enumerate(self.ratings) if rating["holds"] is False]

    @property
    def most_searches(self) -> int:
        """At most so many searches: more where a design fails that the order of all depends on.

        Where the best in each objective hold, they are the best of all that holds, so that the ideal stays; and
        where the first design holds, no other one that does comes nearer to it.
        """
        designs, objectives = self.front.designs, self.front.frame.objectives
        signed = np.array([[d.values[n] for n in objectives] for d in designs]) * senses_of(objectives)
        decide = {0, *extremes(signed)} & set(self.failing)
        return self.limits.searches_for_first if decide else self.limits.searches

    @property
    def holding(self) -> int:
        """Return of how many designs no limit is known to fail."""
        return len(self.ratings) - len(self.failing)

    def scenarios(self) -> dict[str, list[tuple[float, ...]]]:
        """Points at which limits fail, the worst first, and a few of each limit."""
        by_limit: dict[str, list[tuple[float, tuple[float, ...]]]] = {}
        for j in self.failing:
            for name, limit in self.ratings[j]["limits"].items():
                if limit["holds"] is False:
                    worst = math.inf if limit["residual"] is None else limit["residual"]
                    by_limit.setdefault(name, []).append((worst, tuple(limit["position"])))
        few = {name: sorted(points, key=lambda x: -x[0])[: self.limits.scenarios] for name, points in by_limit.items()}
        return {name: [point for _, point in points] for name, points in few.items()}

    def with_ratings(self, searches: int) -> ParetoFront:
        """The front with the ratings of its designs and, in its question, the block of scatter."""
        front, block = self.front, self.uncertainty.block()
        counts = RatingCounts(searches=searches, rated=len(self.ratings), samples=self.uncertainty.samples)
        if self.uncertainty.mode == LIMITS:
            counts = structs.replace(counts, limits_posed=self.added_limits, taken_off=len(self.failing))
        frame = replace(front.frame, restated={**front.frame.restated, "robust": block})
        known = [*self.ratings, *(DesignRating() for _ in range(len(front.designs) - len(self.ratings)))]
        done = replace(
            front,
            frame=frame,
            designs=[replace(d, frame=frame, robust=rating) for d, rating in zip(front.designs, known, strict=True)],
            statistics=structs.replace(front.statistics, robust=counts),
            settings=structs.replace(front.settings, robust=block),
            interrupted=self.stopped,
        )
        return _without(done, self.failing) if self.uncertainty.mode == LIMITS and self.failing else done


def _without(front: ParetoFront, failing: Sequence[int]) -> ParetoFront:
    """Return a front without some of its designs, ranked again."""
    kept = [d for j, d in enumerate(front.designs) if j not in failing]
    chosen = dict(front.frame.objectives)
    weights = front.settings.get("weights") or {}
    _, kept = ranked(kept, chosen, [weights.get(n, 1.0) for n in chosen], scale=front.scale)
    if not kept:
        # Nothing says that there is no robust design; there is none here that anything could be proven of.
        certificate = replace(front.certificate, kind="heuristic", gap=None, resolution={}, units={})
        return replace(front, designs=[], scale=None, complete=False, status=Status.NOT_SOLVED, certificate=certificate)
    return replace(front, designs=kept, complete=False, scale=scale_of(kept, chosen, front.scale))
