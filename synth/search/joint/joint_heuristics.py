"""Looks for good designs in a joint search: the better they are, the fewer boxes it takes to prove them."""

from __future__ import annotations

import numpy as np

from synth.bounds.boxes import Boxes
from synth.nlp.batch import Solutions, Tasks
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.joint.joint_question import BestPerScenario, JointInstance
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.pruning import rows_of_use
from synth.search.refused_cells import not_refused
from synth.search.settings import JointHeuristicLimits


class JointHeuristics:
    """Primal heuristics of a joint search; none of their designs is proven.

    Parameters
    ----------
    instance : JointInstance
    clock : Clock
    rng : Generator
    thorough : bool
        Look longer, where boxes are costly.
    limits : JointHeuristicLimits
    """

    def __init__(
        self,
        instance: JointInstance,
        clock: Clock,
        rng: np.random.Generator,
        thorough: bool,
        limits: JointHeuristicLimits,
    ) -> None:
        self.instance, self.clock, self.rng, self.thorough = instance, clock, rng, thorough
        self.codec, self.limits = instance.combinations, limits
        # Where to look first: variables, by the combination that they are of in any question.
        self.starts: dict[int, np.ndarray] = {}

    def first(self, rule: BestPerScenario, pool: Boxes) -> None:
        """Search for good designs of every question: near the best of each, and with good parts of any other.

        ``pool``: boxes that hold everything.
        """
        self.warm_start(rule)
        if not len(rule.known):
            self._anywhere(rule)
        for node_limit in self.limits.first_boxes:
            if not len(rule.known):
                branch_and_bound(rule.form, pool, rule, self.clock, self.rng, node_limit)
        self.improve(rule)
        if self.thorough and self._further_away(rule):
            self.improve(rule)

    def warm_start(self, rule: BestPerScenario) -> None:
        """Try the starting designs in every question."""
        combinations, points = np.array(list(self.starts), dtype=np.int64), np.array(list(self.starts.values()))
        questions = np.repeat(np.flatnonzero(rule.requested), len(combinations))
        starts = np.tile(np.arange(len(combinations)), len(questions) // max(len(combinations), 1))
        if len(combinations):
            self.tried(rule, self.codec.joined(questions, combinations[starts]), points[starts])

    def _anywhere(self, rule: BestPerScenario) -> None:
        """Try random combinations of each question: where designs are many, one is found soon."""
        questions, count = np.flatnonzero(rule.requested), self.limits.anywhere
        every = questions[np.arange(count) % len(questions)]
        every = np.unique(self.codec.joined(every, self.rng.integers(self.codec.size, size=count)))
        self.tried(rule, every, rule.form.boxes.inside(rule.form.boxes.leaves(every), 0.5))

    def improve(self, rule: BestPerScenario) -> None:
        """Search in rounds near the best design of each question, and with good parts of any other."""
        elsewhere, made, expanded = set[tuple[int, bytes]](), set[tuple[int, bytes]](), set[tuple[int, int]]()
        for _ in range(self.limits.rounds if len(rule.known) else 0):
            improved = self._everywhere(rule, elsewhere)
            improved += self._everywhere(rule, made, True) if self.thorough and rule.form.gridded.any() else 0
            improved += self._exchange_one(rule, expanded) if rule.form.n else 0
            if not improved:
                return

    def _everywhere(self, rule: BestPerScenario, tried: set[tuple[int, bytes]], as_made: bool = False) -> int:
        """Try known combinations in every question; return the number of improving designs.

        ``tried`` are those of earlier rounds. ``as_made``: with the makeable values that they have.
        """
        questions, known = np.flatnonzero(rule.requested), rule.known
        numbers = self.codec.own(known.combination)
        made = np.where(rule.form.gridded & as_made, known.variables, 0.0)
        marks = [(int(c), x.tobytes()) for c, x in zip(numbers, made, strict=True)]
        first = {mark: k for k, mark in reversed(list(enumerate(marks))) if mark not in tried}
        place = np.array(sorted(first.values())[: self.limits.known], dtype=np.int64)
        tried.update(marks[k] for k in place)
        rows = np.tile(place, len(questions))
        every = self.codec.joined(np.repeat(questions, len(place)), numbers[rows])
        return self.tried(rule, every, known.variables[rows], as_made)

    def _exchange_one(self, rule: BestPerScenario, expanded: set[tuple[int, int]]) -> int:
        """Exchange one part at a time of the best design of each question; return the number of improving designs."""
        # Parts that are best in many questions have the same neighbours in all of them: some places are enough.
        questions = rule.known.questions() * self.limits.places // len(self.instance.each)
        best_at = {(int(q), self.codec.own(c.combination)): c for q, c in zip(questions, rule.known, strict=True)}
        parents = [c for place, c in best_at.items() if place not in expanded]
        expanded.update(best_at)
        if not parents:
            return 0
        made = [self.codec.neighbours(c.combination) for c in parents]
        rows = np.repeat(np.arange(len(made)), [len(x) for x in made])
        every, start = np.concatenate(made), np.array([c.variables for c in parents])[rows]
        if len(every) > self.limits.solved:
            chosen = np.sort(self.rng.choice(len(every), self.limits.solved, replace=False))
            every, start = every[chosen], start[chosen]
        return self.tried(rule, every, start)

    def _further_away(self, rule: BestPerScenario) -> int:
        """Exchange two parts at a time of the best design of a few questions; return the number of improving ones."""
        known, every, start = rule.known, [np.empty(0, dtype=np.int64)], [np.empty((0, rule.form.n))]
        limits = self.limits
        for k in np.unique(np.linspace(0, len(known) - 1, limits.far_places).round().astype(int)) if len(known) else ():
            near = self.codec.neighbours(known.combination[k])
            sampled = self.rng.choice(near, min(len(near), limits.drawn // max(len(near), 1)), replace=False)
            away = np.unique(self.codec.neighbours(sampled))
            every.append(self.rng.choice(away, min(len(away), limits.solved // limits.far_places), replace=False))
            start.append(np.tile(known.variables[k], (len(every[-1]), 1)))
        return self.tried(rule, np.concatenate(every), np.concatenate(start))

    def tried(self, rule: BestPerScenario, combinations: np.ndarray, start: np.ndarray, as_made: bool = False) -> int:
        """Solve continuous problems and round off the best of each question; return the number of improving designs.

        ``as_made``: makeable values stay what they are to begin with.
        """
        form, k = rule.form, rule.columns[0]
        heuristics = PrimalHeuristics(form, rule, self.rng, False)
        keep = not_refused(form.instance, combinations)
        combinations, start = combinations[keep], start[keep]
        self.clock.check()
        if not form.n or not len(combinations):
            return heuristics.offer(start, combinations)
        rows = rows_of_use(form, rule, combinations)
        if not len(rows):
            return 0
        combinations, start = combinations[rows], start[rows]
        tasks, solved = self._solved(rule, combinations, start, as_made)
        best = self._best_of_each(rule, combinations, solved)
        if not len(best):
            return 0
        if form.gridded.any() and not as_made:
            new = heuristics.round_off(form.boxes.leaves(combinations[best]), solved.variables[best], tasks.take(best))
        else:
            new = heuristics.offer(solved.variables[best], combinations[best])
        heuristics.polish_best(k, range(k + 1))
        if self.thorough and not as_made:
            # What a combination leaves of the grid may lie far from where it is best without one.
            unsettled = best[solved.phi[best, k] < rule.needed()[self.codec.question(combinations[best])]]
            self._settle(rule, heuristics, combinations[unsettled])
        return new

    def _solved(
        self, rule: BestPerScenario, combinations: np.ndarray, start: np.ndarray, as_made: bool
    ) -> tuple[Tasks, Solutions]:
        """Solve the continuous problem of each combination for the objective that is sought; learn from the answers."""
        form, held = rule.form, rule.form.gridded & as_made
        low, high = np.where(held, start, form.lower), np.where(held, start, form.upper)
        weights = np.zeros((len(combinations), len(form.goals)))
        weights[:, rule.columns[0]] = 1.0
        cutoffs = rule.known.fixed_cutoffs[self.codec.question(combinations)]
        tasks = Tasks(weights, np.zeros_like(weights), cutoffs, form.objectives.scales, 0.0)
        solutions = form.continuous.solve_batch(tasks, combinations, start, low, high)
        form.continuous.learn(tasks, solutions, np.ones(len(combinations)))
        return tasks, solutions

    def _best_of_each(self, rule: BestPerScenario, combinations: np.ndarray, solutions: Solutions) -> np.ndarray:
        """Rows of the few best improving solutions of each question."""
        k, questions = rule.columns[0], self.codec.question(combinations)
        better = solutions.phi[:, k] < rule.needed()[questions]
        good = np.flatnonzero((solutions.violation <= rule.form.tuning.nlp.missed) & better)
        order = good[np.lexsort((solutions.phi[good, k], questions[good]))]
        question = questions[order]
        best: np.ndarray = order[np.arange(len(order)) - np.searchsorted(question, question) < self.limits.rounded_off]
        return best

    def _settle(self, rule: BestPerScenario, heuristics: PrimalHeuristics, combinations: np.ndarray) -> None:
        """Search the makeable designs of a few combinations by trees of a few boxes."""
        if not len(combinations):
            return
        form, k, boxes = rule.form, rule.columns[0], self.limits.settling_boxes * len(combinations)
        branch_and_bound(form, form.boxes.leaves(combinations), rule, self.clock, self.rng, boxes)
        heuristics.polish_best(k, range(k + 1))
