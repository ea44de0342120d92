"""Questions that are answered together, each with one objective: their fronts, or their best designs."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

import numpy as np

from synth.question.settings import Progress
from synth.results import Design, ParetoFront
from synth.results.least_infeasible import LeastInfeasible
from synth.search.budget import Clock
from synth.search.joint.joint_optima import JointOptima, SharedBounds
from synth.search.joint.joint_report import JointReport
from synth.search.question import Question


class JointSearch:
    """A joint (multi-parametric) search: several questions as one tree.

    Parameters
    ----------
    questions : list of Question
        Alike, each with one objective; threads as the first asks.
    progress : callable, optional
    time_limit : float, optional
        Seconds; then ``Stopped`` is raised.
    starts : list of Design
        Designs of similar questions, where to look first. They prove nothing.
    shared : SharedBounds, optional
        Of questions that these are among.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        progress: Progress | None = None,
        time_limit: float | None = None,
        starts: Sequence[Design] = (),
        shared: SharedBounds | None = None,
    ) -> None:
        started = time.monotonic()
        self.questions, self.progress = list(questions), progress
        clock = Clock(math.inf if time_limit is None else started + time_limit, self._working)
        self.search = search = JointOptima(questions, clock, shared)
        self.report = JointReport(self.questions, search.instance, search.form, search.goals, started)
        search.heuristics.starts = self._starts(starts)

    def answers(self) -> list[ParetoFront | None]:
        """Front of each question; None where it is unproven or has no design, for a separate search."""
        search = self.search
        chosen = search.optima(search.distinct())
        return self.report.fronts(search.pool, chosen, 1, search.form.counters.nlp_solves)

    def settled(self) -> list[ParetoFront | None]:
        """Front of each question, also where it is proven that there is no design; None: for a separate search.

        Questions that are the same in all that counts have the same answer.
        """
        search, every = self.search, np.arange(len(self.questions))
        first = search.representatives()
        proven = search.prove(first == every, True)[first]
        same = {q: int(first[q]) for q in every[first != every].tolist()}
        solves, without = search.form.counters.nlp_solves, proven & ~np.isfinite(search.known.best()[first])
        chosen, reasons = search.ties_settled(proven), dict[int, LeastInfeasible]()
        for number in np.flatnonzero(without).tolist():
            search.clock.check()
            reasons[number] = self.report.explanation(number)
        fronts = self.report.fronts(search.pool, chosen, 1, solves, same)
        for number, reason in reasons.items():
            fronts[number] = self.report.front_without_design(number, same.get(number, number), solves, reason)
        return fronts

    def best(self, positions: Sequence[int]) -> list[tuple[Design | None, bool]]:
        """Best design of each of the given questions (None where there is none), and whether that is proven.

        Parameters
        ----------
        positions : list of int
            Positions of the questions.
        """
        search = self.search
        requested = search.distinct() & np.isin(np.arange(len(self.questions)), positions)
        proven = search.prove(requested, True)
        designs = self.report.designs([(c, ()) for c in search.known], 0)
        return [(designs.get(q, [None])[0], bool(proven[q])) for q in positions]

    def best_with(self, requests: Sequence[tuple[int, Design]]) -> list[tuple[Design | None, bool]]:
        """Best designs with given parts, counts and choices, and whether each is proven.

        Parameters
        ----------
        requests : list of (int, Design)
            The position of a question, and a design that has the parts.
        """
        answers: list[tuple[Design | None, bool]] = [(None, False)] * len(requests)
        waiting = list(range(len(requests)))
        while waiting:
            # A question has one best design at a time.
            now = {requests[k][0]: k for k in reversed(waiting)}
            waiting = [k for k in waiting if now[requests[k][0]] != k]
            for k, answer in self._best_with([requests[k] for k in now.values()]).items():
                answers[now[k]] = answer
        return answers

    def _best_with(self, requests: Sequence[tuple[int, Design]]) -> dict[int, tuple[Design | None, bool]]:
        search, codec = self.search, self.search.instance.combinations
        like = [(q, codec.each[q].find(design), design) for q, design in requests]
        result: dict[int, tuple[Design | None, bool]] = {q: (None, True) for q, c, _ in like if c is None}
        rows = [(q, codec.joined(q, c), design) for q, c, design in like if c is not None]
        combinations = np.array([c for _, c, _ in rows], dtype=np.int64)
        known, proven = search.best_among(combinations, self._points([design for _, _, design in rows]))
        designs = self.report.designs([(c, ()) for c in known], 0)
        return {**result, **{q: (designs.get(q, [None])[0], bool(proven[q])) for q, _, _ in rows}}

    def _working(self, open_boxes: int) -> None:
        report_progress(self.progress, self.search, open_boxes)

    def _starts(self, designs: Sequence[Design]) -> dict[int, np.ndarray]:
        """First boxes to look into, from designs of similar questions."""
        first = self.search.instance.each[0].combinations
        like = [first.find(d) for d in designs]
        return {c: x for c, x in zip(like, self._points(designs), strict=True) if c is not None}

    def _points(self, designs: Sequence[Design]) -> np.ndarray:
        """Return the variables of designs, moved into their ranges."""
        names = [v.name for v in self.search.form.model.variables]
        points = np.array([[d.values[n] for n in names] for d in designs]).reshape(len(designs), self.search.form.n)
        inside: np.ndarray = np.clip(points, self.search.form.lower, self.search.form.upper)
        return inside


def report_progress(progress: Progress | None, search: JointOptima, open_boxes: int) -> None:
    """Report the progress of a search to the callback, if there is one."""
    if progress is not None:
        progress(
            {
                "stage": "search",
                "done": 0.0,
                "combinations": search.instance.combinations.size,
                "incumbents": len(search.known),
                "message": f"{open_boxes} boxes open",
            }
        )
