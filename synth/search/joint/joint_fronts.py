"""Fronts of few designs in two objectives, of several questions at once.

What is best in each objective is sought for all questions at once. Between these two ends the first objective is
capped at some levels, and the least of the second is sought under each cutoff, for all questions and levels at once: a
question with a cutoff is one more question. Where the levels lie is told by a rough picture of some of the fronts, so
that the designs spread as those of a question asked alone do.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.order.pareto import spread_subset
from synth.question.settings import Progress
from synth.results import ParetoFront
from synth.search.archive import Candidate, distinct
from synth.search.budget import Clock
from synth.search.joint.joint_groups import groups_of
from synth.search.joint.joint_optima import JointOptima, SharedBounds
from synth.search.joint.joint_question import different
from synth.search.joint.joint_report import JointReport
from synth.search.joint.joint_search import JointSearch, report_progress
from synth.search.question import Question


def joint_groups(questions: Sequence[Question]) -> list[list[int]]:
    """Positions of questions that are answered sooner together, in groups that are alike."""
    groups = groups_of(questions)
    for group in groups_of(questions, objectives=2):
        joint = questions[group[0]].tuning.joint
        sizes: dict[int, list[int]] = {}
        for k in group:
            sizes.setdefault(questions[k].settings.points, []).append(k)
        # Every level of every question has combinations of its own, which must be numbered.
        most = joint.numbers // (joint.levels * questions[group[0]].instance.combinations.count)
        few = (group for points, group in sizes.items() if 2 <= points <= joint.front_points)
        groups += [group for group in few if len(group) > 1 and max(len(group), joint.places) <= most]
    return groups


def joint_answers(
    questions: Sequence[Question], progress: Progress | None = None, time_limit: float | None = None
) -> list[ParetoFront | None]:
    """Return the front of each question of a group; None where a question is better asked alone.

    Parameters
    ----------
    questions : list of Question
        A group of :func:`joint_groups`.
    progress : callable, optional
    time_limit : float, optional
        Seconds; then ``Stopped`` is raised.
    """
    search = JointSearch if len(questions[0].chosen) == 1 else JointFrontSearch
    return search(questions, progress, time_limit).answers()


class JointFrontSearch:
    """One search for the fronts of several questions.

    Parameters
    ----------
    questions : list of Question
        Alike, each with two objectives.
    progress : callable, optional
    time_limit : float, optional
        Seconds; then ``Stopped`` is raised.
    """

    def __init__(
        self, questions: Sequence[Question], progress: Progress | None = None, time_limit: float | None = None
    ) -> None:
        self.questions, self.progress = list(questions), progress
        self.tuning, self.limits = questions[0].tuning, questions[0].tuning.joint
        started = time.monotonic()
        self.clock = Clock(math.inf if time_limit is None else started + time_limit, self._working)
        self.between = questions[0].settings.points - 2
        moving = different([q.instance for q in questions])
        self.others: list[tuple[JointOptima, np.ndarray]] = []  # with the positions of the questions that each asks
        self.shared, self.reverse = (SharedBounds(questions, moving, first) for first in questions[0].chosen)
        self.first = first = self._search(np.arange(len(self.questions)), self.shared)
        self.report = JointReport(self.questions, first.instance, first.form, first.goals, started)

    def answers(self) -> list[ParetoFront | None]:
        """Front of each question; None where it is unproven or has too few designs, for a separate search."""
        first, every = self.first, np.arange(len(self.questions))
        if not first.form.objectives.log[:2].all():
            # The gap of what may be zero is measured against the range of a front, which is not known before.
            return [None] * len(self.questions)
        second = self._search(every, self.reverse)
        self.others.append((second, every))
        ends = self._ends(first.optima(first.distinct()), self._turned(second.optima(second.distinct())))
        pools = {q: list(pair) for q, pair in ends.items()}
        if ends and self.between:
            numbers, codec = list(ends), first.instance.combinations
            level = self._at_levels(numbers, *self._levels(ends))
            for c in level.optima(level.distinct()):
                question = numbers[codec.question(c.combination) // self.between]
                pools[question].append(Candidate(codec.joined(question, codec.own(c.combination)), c.variables, c.phi))
        solves = self._work_counted()
        fronts = [distinct(first.form.points.as_they_are(designs), 2, self.tuning) for designs in pools.values()]
        chosen = [c for front in fronts if len(front) == 2 + self.between for c in front]
        return self.report.fronts(first.pool, chosen, 2, solves)

    def _search(self, positions: np.ndarray, shared: SharedBounds, **more: Any) -> JointOptima:
        self.under_way = JointOptima([self.questions[q] for q in positions], self.clock, shared, **more)
        return self.under_way

    def _working(self, open_boxes: int) -> None:
        report_progress(self.progress, self.under_way, open_boxes)

    def _work_counted(self) -> int:
        """Add the work of all other searches to that of the first; return how many continuous problems were solved."""
        for search, positions in self.others:
            self.first.count(search, positions)
        return self.first.form.counters.nlp_solves

    # -- the ends ------------------------------------------------------------------------------

    def _turned(self, designs: Sequence[Candidate]) -> list[Candidate]:
        """Return designs of the search for the second objective as that for the first one has them."""
        return self.first.form.points.as_they_are(designs)

    def _ends(self, best: Sequence[Candidate], least: Sequence[Candidate]) -> dict[int, tuple[Candidate, Candidate]]:
        """Designs that are best in the first and in the second objective, where they differ."""
        codec = self.first.instance.combinations
        first, second = ({codec.question(c.combination): c for c in designs} for designs in (best, least))
        pairs = {q: (c, second[q]) for q, c in first.items() if q in second}
        return {q: pair for q, pair in pairs.items() if len(distinct(pair, 2, self.tuning)) == 2}

    # -- designs between -----------------------------------------------------------------------

    def _at_levels(self, numbers: Sequence[int], levels: np.ndarray, known: Sequence[Candidate]) -> JointOptima:
        """Search for the least second objective, the first one being capped.

        Parameters
        ----------
        numbers : list of int
            Positions of the questions.
        levels : array (questions, levels)
            phi of the first objective.
        known : list of Candidate
            Where to look first.
        """
        positions = np.repeat(numbers, levels.shape[1])
        cutoffs = {0: self.first.form.objectives.signed(0, levels.ravel())}
        search = self._search(positions, self.shared, sought=1, cutoffs=cutoffs)
        self.others.append((search, positions))
        search.heuristics.starts = {self.first.instance.combinations.own(c.combination): c.variables for c in known}
        return search

    def _levels(self, ends: Mapping[int, tuple[Candidate, Candidate]]) -> tuple[np.ndarray, list[Candidate]]:
        """Cap of the first objective of each question, and designs that are good between the ends."""
        numbers = list(ends)
        low, high = (np.array([pair[k].phi[0] for pair in ends.values()]) for k in range(2))
        places = np.unique(np.linspace(0, len(numbers) - 1, self.limits.places).round().astype(int))
        even = np.arange(1, self.limits.levels + 1) / (self.limits.levels + 1)
        at = low[places, None] + even * (high - low)[places, None]
        known = [c for k in places for c in ends[numbers[k]]]
        picture = self._at_levels([numbers[k] for k in places], at, known)
        drawn: dict[int, list[Candidate]] = {}
        for c in picture.glimpse():
            drawn.setdefault(picture.instance.combinations.question(c.combination) // self.limits.levels, []).append(c)
        shares, good = [], list[Candidate]()
        for row, k in enumerate(places):
            every = distinct([*ends[numbers[k]], *drawn.get(row, [])], 2, self.tuning)
            phi = np.array([c.phi[:2] for c in every])
            chosen = spread_subset(phi, 2 + self.between)
            inner = np.sort((phi[chosen, 0] - low[k]) / (high[k] - low[k]))[1:-1]
            if len(inner) < self.between:
                inner = np.arange(1, self.between + 1) / (self.between + 1)
            shares.append(inner)
            good += every
        nearest = np.abs(np.arange(len(numbers))[:, None] - places[None, :]).argmin(axis=1)
        return low[:, None] + np.array(shares)[nearest] * (high - low)[:, None], good
