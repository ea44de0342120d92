"""A joint search: many questions as one tree. What is proven of each is what a search of its own would prove."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np

from synth.bounds.boxes import Boxes
from synth.compiled.execution import Execution
from synth.parametric.joint_heuristics import JointHeuristics
from synth.parametric.joint_question import BestPerScenario, IncumbentPerScenario, JointInstance
from synth.parametric.joint_report import JointReport
from synth.question.objectives import with_ties
from synth.results import Design, ParetoFront
from synth.search.archive import Candidate, rows_of
from synth.search.branch_and_bound import branch_and_bound
from synth.search.budget import Clock
from synth.search.formulation import Formulation
from synth.search.question import Question
from synth.search.resolution import gap_tolerance


class SharedBounds:
    """What holds for many questions, found once for all searches of some of them.

    Parameters
    ----------
    questions : list of Question
        Alike.
    moving : collection of str
        As for :class:`JointInstance`.
    first : str, optional
        Of several chosen objectives that which comes first; the others settle ties.
    """

    def __init__(self, questions: Sequence[Question], moving: Collection[str], first: str | None = None) -> None:
        self.moving, self._tuning = moving, questions[0].tuning
        self._instance = JointInstance([q.instance for q in questions], moving)
        chosen = dict(questions[0].chosen)
        in_order = {first: chosen[first], **chosen} if first is not None else chosen
        self.goals = with_ties(self._instance.model, in_order)
        self._forms: dict[bool, Formulation] = {}

    def among(self, instance: JointInstance, infeasibility: bool, workers: int = 1) -> Formulation | None:
        """Return questions prepared for a search; None where their numbers are not among those of these."""
        if infeasibility not in self._forms:
            self._forms[infeasibility] = Formulation(self._instance, self.goals, 1, infeasibility, tuning=self._tuning)
        return self._forms[infeasibility].among(instance, workers)


class JointTree:
    """One tree over the questions, by one way of bounding them, which goes on where it stopped."""

    def __init__(self, search: JointSearch, form: Formulation, known: IncumbentPerScenario, boxes: Boxes) -> None:
        self.search, self.form, self.known, self.left = search, form, known, boxes

    def open_questions(self, asked: np.ndarray, node_limit: float) -> np.ndarray:
        """Go on for so many boxes; tell of which of the questions asked it is not proven what is best."""
        search, form = self.search, self.form
        limits = search.limits
        if not asked.any():
            return asked
        if self.known is not search.known:
            # Designs of other questions would only seem to say that those of these are found.
            rows = asked[search.known.questions()]
            self.known.add(search.known.combination[rows], search.known.variables[rows], search.known.phi[rows])
        before = form.counters.contracted, form.counters.nlp_solves
        rule = BestPerScenario(form, self.known, search.tolerance_of(search.sought), asked)
        for _ in range(2):
            self.left = branch_and_bound(
                form, self.left, rule, search.clock, search.rng, min(node_limit, limits.most_boxes)
            ).open
            if not 0 < len(self.left) < limits.nearly_closed * node_limit:
                break
        if self.known is not search.known:
            search.known.add(self.known.combination, self.known.variables, self.known.phi)
            search.form.counters.contracted += form.counters.contracted - before[0]
            search.form.counters.nlp_solves += form.counters.nlp_solves - before[1]
        return rule.open_questions(self.left)


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
    sought : int
        Number of the objective that is sought.
    cutoffs : mapping, optional
        As for :class:`JointInstance`.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        progress: Callable[[Mapping[str, Any]], None] | None = None,
        time_limit: float | None = None,
        starts: Sequence[Design] = (),
        shared: SharedBounds | None = None,
        sought: int = 0,
        cutoffs: Mapping[int, np.ndarray] | None = None,
    ) -> None:
        self.started = time.monotonic()
        self.questions, self.progress = list(questions), progress
        first = questions[0]
        self.tuning, self.limits = first.tuning, first.tuning.joint
        self.shared, self.workers, self.sought = shared, first.settings.workers, sought
        moving = () if shared is None else shared.moving
        self.instance = JointInstance([q.instance for q in questions], moving, cutoffs)
        self.gap = first.settings.gap
        self.goals = with_ties(first.instance.model, dict(first.chosen)) if shared is None else shared.goals
        self.form = self._prepared()
        self.fixed_cutoffs = np.full((len(self.questions), len(self.form.goals)), np.inf)
        for k, values in (cutoffs or {}).items():
            self.fixed_cutoffs[:, k] = self.form.objectives.phi_of(np.tile(values[:, None], k + 1))[:, k]
        self.report = JointReport(self.questions, self.instance, self.form, self.goals, self.started)
        self.known = self._none_known()
        self.form.archive = self.known
        self.clock = Clock(math.inf if time_limit is None else self.started + time_limit, self._working)
        self.rng = np.random.default_rng(first.settings.seed)
        self.pool = self.form.boxes.nothing()
        # What is capped is as narrow as what boxes cannot settle soon: good designs are worth a longer look.
        self.heuristics = JointHeuristics(
            self.instance, self.clock, self.rng, bool(cutoffs), self.tuning.heuristics.joint
        )
        self.heuristics.starts = self._starts(starts)

    def answers(self) -> list[ParetoFront | None]:
        """Return the front of each question; None where it is not proven or has no design: better asked alone."""
        chosen = self.optima(self.told_apart())
        return self.report.fronts(self.pool, chosen, 1, self.form.counters.nlp_solves)

    def optima(self, asked: np.ndarray) -> list[Candidate]:
        """Return the best designs of the questions asked, as far as they are proven; the next objective settles ties.

        Parameters
        ----------
        asked : array of bool (questions,)
        """
        proven = self._search(asked, False)
        return self._second([c for c, q in zip(self.known, self.known.questions(), strict=True) if proven[q]])

    def glimpse(self) -> list[Candidate]:
        """Return good designs of the questions, of which nothing is proven."""
        self.pool, self.heuristics.thorough = self.form.boxes.root(), False
        if len(self.pool):
            rule = BestPerScenario(self.form, self.known, self.tolerance_of(self.sought), self.told_apart())
            self.heuristics.warm_start(rule)
            self.heuristics.improve(rule)
        return list(self.known)

    def best(self, wanted: Sequence[int]) -> list[tuple[Design | None, bool]]:
        """Return the best designs of some questions, None where there is none, and whether that is proven.

        Parameters
        ----------
        wanted : list of int
            Positions of the questions.
        """
        asked = self.told_apart() & np.isin(np.arange(len(self.questions)), wanted)
        proven = self._search(asked, True)
        designs = self.report.designs([(c, ()) for c in self.known], 0)
        return [(designs.get(q, [None])[0], bool(proven[q])) for q in wanted]

    def _search(self, asked: np.ndarray, excluded: bool) -> np.ndarray:
        """Find the best design of each question asked; tell of which it is proven.

        ``excluded``: also where no question has a design that is easily found; then it is proven that there is none.
        """
        self.pool = self.form.boxes.root()
        if not len(self.pool) or not asked.any():
            return asked
        self.heuristics.first(BestPerScenario(self.form, self.known, self.tolerance_of(self.sought), asked), self.pool)
        found, unproven = np.isfinite(self.known.best()), asked.copy()
        if not found.any() and not excluded:
            return np.zeros_like(asked)
        by_objectives = JointTree(self, self.form, self.known, self.pool)
        by_limits: JointTree | None = None
        # What one way of bounding can hardly tell the other often can: each has its turn before one goes on for long.
        for boxes, sure_boxes, unsure_boxes in self.limits.turns:
            now = unproven & found
            unproven &= ~found | by_objectives.open_questions(now, boxes * int(now.sum()))
            if not unproven.any():
                break
            self.heuristics.thorough = True
            self.heuristics.improve(BestPerScenario(self.form, self.known, self.tolerance_of(self.sought), unproven))
            by_limits = self._in_infeasibility_mode() if by_limits is None else by_limits
            sure = int((unproven & np.isfinite(self.known.best())).sum())
            node_limit = sure_boxes * sure + unsure_boxes * (int(unproven.sum()) - sure)
            unproven &= by_limits.open_questions(unproven, node_limit)
        proven: np.ndarray = asked & ~unproven
        return proven

    def best_with(self, wanted: Sequence[tuple[int, Design]]) -> list[tuple[Design | None, bool]]:
        """Return the best designs with given parts, counts and choices, and whether each is proven.

        Parameters
        ----------
        wanted : list of (int, Design)
            The position of a question, and a design that has the parts.
        """
        found: list[tuple[Design | None, bool]] = [(None, False)] * len(wanted)
        waiting = list(range(len(wanted)))
        while waiting:
            # A question has one best design at a time.
            now = {wanted[k][0]: k for k in reversed(waiting)}
            waiting = [k for k in waiting if now[wanted[k][0]] != k]
            for k, answer in self._best_with([wanted[k] for k in now.values()]).items():
                found[now[k]] = answer
        return found

    def _best_with(self, wanted: Sequence[tuple[int, Design]]) -> dict[int, tuple[Design | None, bool]]:
        form, codec = self.form, self.instance.combinations
        form.archive = known = self._none_known()
        like = [(q, codec.each[q].find(design), design) for q, design in wanted]
        result: dict[int, tuple[Design | None, bool]] = {q: (None, True) for q, c, _ in like if c is None}
        rows = [(q, codec.joined(q, c), design) for q, c, design in like if c is not None]
        asked = np.zeros(len(self.questions), dtype=bool)
        asked[[q for q, _, _ in rows]] = True
        asked &= self.told_apart()
        rule = BestPerScenario(form, known, self.tolerance_of(self.sought), asked)
        combinations = np.array([c for _, c, _ in rows], dtype=np.int64)
        self.heuristics.tried(rule, combinations, self._points([design for _, _, design in rows]))
        outcome = branch_and_bound(
            form, form.boxes.leaves(combinations), rule, self.clock, self.rng, self.limits.given_parts * len(rows)
        )
        left = rule.open_questions(outcome.open)
        designs = self.report.designs([(c, ()) for c in known], 0)
        for q, _, _ in rows:
            result[q] = designs.get(q, [None])[0], bool(asked[q] and not left[q])
        form.archive = self.known
        return result

    def _in_infeasibility_mode(self) -> JointTree:
        """Return what tries with boxes that carry what limits share, which helps where limits leave little room."""
        form = self._prepared(infeasibility=True)
        form.counters.work = self.form.counters.work
        form.counters.solved_combinations = self.form.counters.solved_combinations
        form.bounding.branching.adopt(self.form.bounding.branching.statistics())
        form.archive = known = self._none_known()
        return JointTree(self, form, known, form.boxes.root())

    def _none_known(self) -> IncumbentPerScenario:
        return IncumbentPerScenario(
            self.instance, self.sought, self.form.n, len(self.form.goals), self.fixed_cutoffs, self.tuning
        )

    def _prepared(self, infeasibility: bool = False) -> Formulation:
        form = None if self.shared is None else self.shared.among(self.instance, infeasibility, self.workers)
        if form is None:
            form = Formulation(
                self.instance, self.goals, 1, infeasibility, Execution(workers=self.workers), self.tuning
            )
        return form

    def told_apart(self) -> np.ndarray:
        """Return the questions that boxes can tell apart: of those that are the same in all that counts, one."""
        tree = self.form.boxes.cells.trees[0]
        result = np.zeros(len(self.questions), dtype=bool)
        result[tree.first[tree.leaf]] = True
        return result

    def tolerance_of(self, k: int) -> Callable[[np.ndarray], np.ndarray]:
        """Return the gap as a distance in phi of an objective, per design."""
        form = self.form
        own = (form.objectives.log[k], form.objectives.finest[k])
        return lambda phi: gap_tolerance(self.gap, *own, np.abs(phi))

    def _working(self, open_boxes: int) -> None:
        if self.progress is not None:
            self.progress(
                {
                    "stage": "search",
                    "done": 0.0,
                    "combinations": self.instance.combinations.size,
                    "incumbents": len(self.known),
                    "message": f"{open_boxes} boxes open",
                }
            )

    def _starts(self, designs: Sequence[Design]) -> dict[int, np.ndarray]:
        """Return where to look first, from designs of similar questions."""
        first = self.instance.each[0].combinations
        like = [first.find(d) for d in designs]
        return {c: x for c, x in zip(like, self._points(designs), strict=True) if c is not None}

    def _points(self, designs: Sequence[Design]) -> np.ndarray:
        """Return the variables of designs, moved into their ranges."""
        names = [v.name for v in self.form.model.variables]
        points = np.array([[d.values[n] for n in names] for d in designs]).reshape(len(designs), self.form.n)
        inside: np.ndarray = np.clip(points, self.form.lower, self.form.upper)
        return inside

    def _second(self, chosen: Sequence[Candidate]) -> list[Candidate]:
        """Return designs that are as good in the objective and better in the next one, over all parts."""
        form, sought = self.form, self.sought
        if len(form.goals) < 2 or not chosen:
            return list(chosen)
        following = 1 if sought == 0 else 0
        questions = self.instance.combinations.question(np.array([c.combination for c in chosen]))
        cutoffs = self.fixed_cutoffs.copy()
        cutoffs[questions, sought] = np.array([c.phi[sought] for c in chosen]) + form.tuning.tolerances.tie
        known = IncumbentPerScenario(self.instance, following, form.n, len(form.goals), cutoffs, self.tuning)
        asked = np.zeros(len(self.questions), dtype=bool)
        asked[questions] = True
        known.add(*rows_of(chosen))
        rule = BestPerScenario(form, known, self.tolerance_of(following), asked)
        self.heuristics.improve(rule)
        branch_and_bound(form, self.pool, rule, self.clock, self.rng, self.limits.tie * len(chosen))
        better = dict(zip(known.questions().tolist(), known, strict=True))
        return [better.get(int(q), c) for q, c in zip(questions, chosen, strict=True)]
