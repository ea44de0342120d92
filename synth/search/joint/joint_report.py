"""What a joint search reports: the designs and the front of each of its questions."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np
from msgspec import structs

from synth.analysis.designs import make_frame, offered
from synth.bounds.boxes import Boxes
from synth.order.feasibility import Status
from synth.results import Certificate, Design, ParetoFront
from synth.results.assembly import front_of, ranked
from synth.results.least_infeasible import LeastInfeasible
from synth.results.statistics import SearchStatistics
from synth.search.archive import Candidate, rows_of
from synth.search.complete_designs import complete_designs
from synth.search.formulation import Formulation
from synth.search.joint.joint_question import JointInstance
from synth.search.least_infeasible import explain_infeasible
from synth.search.polishing import break_ties
from synth.search.question import Question
from synth.search.resolution import rounded_up
from synth.search.sensitivity import elasticities

Tied = tuple[Candidate, tuple[str, ...]]  # a design, and the other combinations that tie
NO_OTHER: Mapping[int, int] = MappingProxyType({})


class JointReport:
    """Result records of a joint search.

    Parameters
    ----------
    questions : list of Question
    instance : JointInstance
        These questions.
    form : Formulation
        Of the instance.
    goals : mapping
        The objectives of the formulation with their sense.
    started : float
        When the search began, by the monotonic clock.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        instance: JointInstance,
        form: Formulation,
        goals: Mapping[str, str],
        started: float,
    ) -> None:
        self.questions, self.instance, self.form = questions, instance, form
        self.goals, self.started = goals, started
        self.gap, self.tuning = questions[0].settings.gap, questions[0].tuning

    def fronts(
        self, pool: Boxes, chosen: Sequence[Candidate], traded: int, solves: int, same: Mapping[int, int] = NO_OTHER
    ) -> list[ParetoFront | None]:
        """Front of each question that has designs, ties settled; None where a separate search is better.

        Parameters
        ----------
        pool : Boxes
            All that may hold a feasible design.
        chosen : list of Candidate
            Proven designs, those of a question side by side.
        traded : int
            How many objectives, from the first, are traded off.
        solves : int
            Continuous problems that were solved to find them.
        same : mapping
            Position of a question that was not searched -> that of one which is the same in all that counts.
        """
        form, instance = self.form, self.instance
        fronts: list[ParetoFront | None] = [None] * len(instance.each)
        results = break_ties(form, pool, chosen, traded) if chosen else []
        results += [pair for q, first in same.items() for pair in self._turned(results, first, q)]
        every = np.array(sorted(form.counters.solved_combinations), dtype=np.int64)
        solved = np.bincount(instance.combinations.question(every), minlength=len(instance.each))
        for number, designs in self.designs(results, traded).items():
            if not self._resolved(designs, traded):
                continue  # a separate search measures its objectives near its front
            question, here = self.questions[number], int(solved[same.get(number, number)])
            total = question.instance.combinations.count
            certificate = Certificate("global", self.gap, total, total - here, here, **self._amounts(designs, traded))
            fronts[number] = front_of(
                question.instance,
                designs[0].frame,
                designs,
                certificate,
                self._statistics(question, here, solves),
                question.record(),
                complete=traded == 1,
            )
        return fronts

    def _turned(self, results: Sequence[Tied], first: int, number: int) -> Iterator[Tied]:
        """Results of one question as those of another that is equal in all relevant data."""
        codec = self.instance.combinations
        for c, also in results:
            if codec.question(c.combination) == first:
                yield Candidate(codec.joined(number, codec.own(c.combination)), c.variables, c.phi), also

    def explanation(self, number: int) -> LeastInfeasible:
        """Reason why the question at a position has no design: what comes nearest."""
        counters, codec = self.form.counters, self.instance.combinations
        searched, first = set(counters.solved_combinations), codec.joined(number, 0)
        rng = np.random.default_rng(self.questions[number].settings.seed)
        explanation = explain_infeasible(self.form, rng, range(first, first + codec.size))
        # What was solved only to explain does not change how the combinations were excluded.
        counters.solved_combinations = searched
        return explanation

    def front_without_design(
        self, number: int, searched: int, solves: int, explanation: LeastInfeasible
    ) -> ParetoFront:
        """Return the front of a question of which it is proven that no design is feasible.

        Parameters
        ----------
        number : int
            Position of the question.
        searched : int
            That of the one that was searched for it.
        solves : int
            Continuous problems that were solved to find designs.
        explanation : LeastInfeasible
        """
        question, codec = self.questions[number], self.instance.combinations
        solved = sum(codec.question(c) == searched for c in self.form.counters.solved_combinations)
        total = question.instance.combinations.count
        return front_of(
            question.instance,
            make_frame(question.instance, question.chosen),
            [],
            Certificate("global", None, total, total - solved, solved),
            self._statistics(question, solved, solves),
            question.record(),
            complete=False,
            explanation=explanation,
        )

    def _statistics(self, question: Question, solved: int, solves: int) -> SearchStatistics:
        """Cost of the search of all questions, and how many combinations of one were solved."""
        counters = self.form.counters
        return structs.replace(
            offered(question.instance),
            excluded_by_bound=question.instance.combinations.count - solved,
            solved=solved,
            searched_together=len(self.questions),
            boxes=counters.contracted,
            nlp_solves=counters.nlp_solves,
            nlp_solves_to_find=solves,
            seconds={"total": time.monotonic() - self.started},
        )

    def _resolved(self, designs: Sequence[Design], traded: int) -> bool:
        """True if no objective was told apart more coarsely than the gap asks for, unless the declaration says so."""
        objectives = self.form.objectives
        names = list(designs[0].frame.objectives)[:traded]
        values = np.abs([[d.values[name] for name in names] for d in designs]).max(axis=0)
        amounts = (objectives.finest * objectives.scales)[:traded]
        undeclared = ~objectives.log[:traded] & ~objectives.declared[:traded]
        return not np.any(undeclared & (amounts > self.gap * values))

    def _amounts(self, designs: Sequence[Design], traded: int) -> dict[str, Any]:
        """Return in SI by how much a design must be better for a claim, where that is no share of its value; units."""
        form, units = self.form, designs[0].frame.units
        amounts = {}
        for k, name in enumerate(list(designs[0].frame.objectives)[:traded]):
            if not form.objectives.log[k]:
                size = abs(designs[0].values[name]) / form.objectives.scales[k]
                amounts[name] = rounded_up(
                    max(self.gap * size, form.objectives.finest[k]) * form.objectives.scales[k], units[name]
                )
        return {"resolution": amounts, "units": {name: units[name] for name in amounts}}

    def designs(self, results: Sequence[Tied], traded: int) -> dict[int, list[Design]]:
        """Designs of each question in order of rank, from candidates with their ties.

        ``traded``: how many objectives are traded off and have elasticities; none where designs are not reported.
        """
        form, instance = self.form, self.instance
        if not results:
            return {}
        candidates = [c for c, _ in results]
        costs = self._prices(candidates, traded) if traded else [{}] * len(candidates)
        combinations, points, _ = rows_of(candidates)
        result = form.points.evaluate(points.reshape(len(candidates), form.n), combinations)
        numbers = instance.combinations.question(combinations).tolist()
        made = {q: make_frame(self.questions[q].instance, self.questions[q].chosen) for q in dict.fromkeys(numbers)}
        more = [
            {"status": Status.OPTIMAL, "gap": self.gap, "alternatives": also, "elasticity": cost}
            for (_, also), cost in zip(results, costs, strict=True)
        ]
        designs: dict[int, list[Design]] = {}
        frames = [made[number] for number in numbers]
        for number, design in zip(numbers, complete_designs(form, frames, candidates, result, more), strict=True):
            designs.setdefault(number, []).append(design)
        questions = {number: self.questions[number] for number in designs}
        return {q: ranked(d, questions[q].chosen, list(questions[q].weights.values()))[1] for q, d in designs.items()}

    def _prices(self, designs: Sequence[Candidate], traded: int) -> list[dict[str, dict[str, float]]]:
        """Elasticities of each design, as in a separate search of its question."""
        if self.form.objectives.log[:traded].all():
            return elasticities(self.form, designs, traded)
        # The objective may be positive in some questions although it is not in all.
        result = []
        for c in designs:
            codec = self.instance.combinations
            question, combination = codec.question(c.combination), codec.own(c.combination)
            form = Formulation(self.instance.each[question], self.goals, 1, tuning=self.tuning)
            _, phi = form.points.feasible_rows(c.variables[None, :], np.array([combination]))
            result += elasticities(form, [Candidate(combination, c.variables, phi[0])], traded)
        return result
