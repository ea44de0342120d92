"""From a requirement to ranked Pareto designs over all combinations of parts and counts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from synth import deadline
from synth.analysis.designs import make_frame, offered
from synth.bounds.branching import BranchingStatistics
from synth.compiled.compilation import meanwhile, switched_off
from synth.deadline import Stopped
from synth.feasibility import Status
from synth.pareto import extremes, spread_subset
from synth.question.instance import Instance
from synth.question.objectives import with_ties
from synth.question.settings import Progress, SearchSettings
from synth.results import Certificate, Design, Frame, ParetoFront
from synth.results.assembly import front_of, ranked
from synth.search.archive import Archive, Candidate, distinct, rows_of
from synth.search.best_first import best_first
from synth.search.boxes import Boxes
from synth.search.branch_and_bound import TreeOutcome, best, branch_and_bound
from synth.search.budget import Clock
from synth.search.counters import SearchCounters
from synth.search.epsilon_constraint import cover_by_epsilon_constraint, prove_by_epsilon_constraint
from synth.search.execution import Execution
from synth.search.formulation import Formulation
from synth.search.found_designs import found_designs
from synth.search.large_neighbourhood import large_neighbourhood_search
from synth.search.least_infeasible import explain_infeasible
from synth.search.part_sampling import BEGUN_ANEW, passed_over, sample_parts, study_file
from synth.search.polishing import break_ties, polish_extremes, polish_variables, solve_everywhere
from synth.search.primal_heuristics import PrimalHeuristics
from synth.search.proven_gap import Bound, least_gap
from synth.search.pruning import EpsilonCover, NonImprovement, PruningRule, TabledPruningRule
from synth.search.resolution import ROOM, ranges, rounded_up
from synth.search.sensitivity import elasticities
from synth.search.warm_start import warm_start
from synth.tuning import TUNING, TreeLimits, Tuning


def _effort(instance: Instance, objectives: int, limits: TreeLimits) -> int:
    """Return how many boxes are worth looking into: with many unknowns they hardly close.

    Combinations that are few are solved one by one instead; where boxes for one best design over few combinations do
    not close soon, limits leave a sliver that they hardly ever close on.
    """
    few = instance.combinations.count <= limits.few_combinations
    if int(np.sum(instance.ranges.lower < instance.ranges.upper)) < limits.many_variables:
        return limits.boxes_of_many if objectives == 1 and few else limits.boxes
    return limits.boxes_of_few_parts if few else limits.boxes_of_many


class FrontSearch:
    """One run: the front, its extremes, ties, and the report; afterwards it answers what more is asked of it."""

    def __init__(
        self,
        instance: Instance,
        chosen: Mapping[str, str],
        settings: SearchSettings,
        progress: Progress | None = None,
        effort: int | None = None,
        known: Sequence[Design] = (),
        alike: int = 1,
        lessons: BranchingStatistics | None = None,
        tuning: Tuning = TUNING,
    ) -> None:
        self.tuning, self.limits = tuning, tuning.tree
        # A question that is worth only some effort is not worth compiling for, nor solving what stays open.
        self.thorough = effort is None
        self.effort = _effort(instance, len(chosen), self.limits) if effort is None else effort
        self.alike = alike
        self.instance, self.chosen, self.settings = instance, dict(chosen), settings
        self.points, self.gap, self.workers = settings.points, settings.gap, settings.workers
        self.started = time.monotonic()
        self.m = len(chosen)
        self.form = self._formulation(conflict=False)
        limit = settings.time_limit
        self.clock = Clock(math.inf if limit is None else self.started + limit, self._working)
        # s left for what a first effort leaves open
        self.budget = self.limits.further.seconds if limit is None else math.inf
        self.budget_spent = self.reporting = False
        self.stage, self.done = "", 0.0
        self.rng = np.random.default_rng(settings.seed)
        self.outer_trials = 0
        self.progress = progress
        self.stage_seconds: dict[str, float] = {}
        self.in_conflict = False
        self.closed = True
        self.exhausted = True
        self.unresolved = 0
        self.bounds: list[Bound] = []  # what is proven of all designs, each on its own
        # What was found and proven without compiled code, while the compiler was at work.
        self.meanwhile: list[Candidate] = []
        self.bounded_meanwhile: list[Bound] = []
        self.found_meanwhile: ParetoFront | None = None
        self.pool: Boxes = self.form.boxes.nothing()  # the boxes that may hold a feasible design
        self.front: list[Candidate] = []
        self.spare: list[Candidate] = []  # designs that stand as well, but are more than were asked for
        self.complete = False
        self.scalar_problems = 0
        self.solves_to_find: int | None = None  # of the designs listed; settling ties and prices come after
        self.open_combinations = float(instance.combinations.count)
        self.rule = self._rule(None)
        self.covering: EpsilonCover | None = None  # the finest cover that is finished
        self.under_way: np.ndarray | None = None  # the slack of the tree that is under way, if it speaks of all designs
        self.stairs: NonImprovement | None = None  # the proof of designs that is under way
        self.proven_designs = set[bytes]()
        self.looked = 0
        self.by_steps = False  # whether a front at once has turned out to cost too much
        self.may_find_more = True  # unless a try was given up
        self.against = np.zeros(self.m)  # in SI: by how much designs of others must be beaten to be taken for beaten
        self.recalled = list(known)
        self.to_report: tuple[Sequence[float], Mapping[str, Any], bool] = ([1.0] * self.m, {}, False)
        self.given = np.empty((0, self.m))  # phi of the designs of an earlier search
        self.given_gap: float | None = None
        self.given_amounts = np.full(self.m, math.inf)  # in SI: of its claim, where that is no share of the value
        self.taught = lessons is not None and self.form.bounding.branching.adopt(lessons)

    def _formulation(self, conflict: bool, counters: SearchCounters | None = None) -> Formulation:
        goals = with_ties(self.instance.model, self.chosen)
        execution = Execution(self.thorough, self.alike, self.workers)
        return Formulation(self.instance, goals, self.m, conflict, execution, self.tuning, counters)

    def _rule(self, ranges: np.ndarray | None, least: np.ndarray | float = 0.0) -> EpsilonCover:
        """Return the search for the front; ``ranges`` of the objectives are needed where they may be zero."""
        form = self.form
        slack = np.maximum(form.objectives.tolerance(self.gap, ranges)[: self.m], least)
        return EpsilonCover(range(self.m), slack, np.full(len(form.goals), np.inf), form.archive)

    def begin_from(self, front: ParetoFront) -> None:
        """Begin with the front of an earlier search of the same question: none of its designs is lost."""
        form = self.form
        points = np.array([[d.values[v.name] for v in form.model.variables] for d in front.designs])
        points = points.reshape(len(front.designs), form.n)
        combinations = np.array([self.instance.combinations.number(d) for d in front.designs], dtype=np.int64)
        closely, phi = form.points.feasible_rows(points, combinations)
        edge, _ = form.points.edge_rows(points, combinations)
        phi[edge] += self.tuning.tolerances.edge_worth
        rows = np.concatenate([closely, edge])
        form.archive.add(combinations[rows], points[rows], phi[rows])
        self.given = phi[rows, : self.m]
        self.given_gap = front.certificate.gap
        told = front.certificate.resolution
        self.given_amounts = np.array([told.get(name, math.inf) for name in self.chosen])

    def _in_place_of_given(self, phi: np.ndarray) -> list[int]:
        """Return the positions of those designs that take the places of the given ones: each as good in everything."""
        places = dict[int, None]()
        for own in self.given:
            room = self.tuning.tolerances.rounded * np.maximum(np.abs(own), 1.0)
            as_good = np.flatnonzero(np.all(phi <= own + room, axis=1))
            if len(as_good):
                places[int(as_good[np.argmin(phi[as_good].sum(axis=1))])] = None
        return list(places)

    def _claim_no_less(self) -> None:
        """Where less is proven than was of the given designs, list only those that take their places.

        What improves one of these by more than the gap of the given ones would have improved those as well.
        """
        if self.given_gap is None or not len(self.given) or not self.front:
            return
        gap, logs = self._proven_gap(), self.form.objectives.log[: self.m]
        if (gap is not None and gap <= self.given_gap) or (logs.any() and self.given_gap >= 1.0):
            return
        phi = np.array([c.phi[: self.m] for c in self.front])
        self.front = [self.front[k] for k in sorted(self._in_place_of_given(phi))]
        share = -math.log1p(-self.given_gap) if logs.any() else 0.0
        slack = np.where(logs, share, self.given_amounts / self.form.objectives.scales[: self.m])
        self.bounds.append(Bound(slack, np.empty((0, self.m))))

    # -- the run -------------------------------------------------------------------------------

    def run(self, weights: Sequence[float], settings: Mapping[str, Any], explained: bool = True) -> ParetoFront:
        """Search, and return the front; what stops the search early leaves what is known by then."""
        frame = make_frame(self.instance, self.chosen)
        interrupted = ""
        designs: list[Design] = []
        explanation = None
        self.to_report = weights, settings, explained
        try:
            with deadline.until(self.clock.deadline), meanwhile(self._look_meanwhile):
                self.find()
                if len(self.form.archive):
                    if self.m > 1:
                        self._timed("front", self._choose)
                    if not self.closed:
                        self._claim_no_less()
                    self.solves_to_find, self.reporting = self.form.counters.nlp_solves, True
                    designs = self._timed("report", lambda: self._designs(frame, weights, settle=True))
                elif explained:
                    searched = set(self.form.counters.solved_combinations)
                    explanation = self._timed("explanation", lambda: explain_infeasible(self.form, self.rng))
                    # What was solved only to explain does not change how the combinations were excluded.
                    self.form.counters.solved_combinations = searched
        except Stopped as stop:
            interrupted = stop.reason
        except KeyboardInterrupt:
            interrupted = "interrupted"
        if interrupted and self.found_meanwhile is not None:
            return self.found_meanwhile
        if interrupted:
            self._stop_early()
            designs = self._designs(frame, weights, settle=False) if self.front else []
        return self._result(frame, designs, settings, explanation, interrupted)

    def find(self) -> None:
        """Find the designs that are known when the front is chosen."""
        self._timed("bounds", self._root)
        if len(self.pool):
            self._timed("coarse", self._coarse)
        if len(self.pool):
            if self.m == 1 or not self.form.objectives.log[: self.m].all():
                self._timed("extremes", self._extremes)
            if self.m > 1:
                self._timed("front", self._cover)

    def _look_meanwhile(self, ready: Callable[[], bool]) -> None:
        """Search without compiled code until the compiler is done: what is found counts if time is over before.

        The search that waits goes on as if nothing had happened, so that its result does not depend on how long the
        compiler takes.
        """
        with switched_off(), deadline.until(self.clock.deadline, ready):
            alone = replace(self.settings, workers=1, time_limit=None)
            aside = FrontSearch(
                self.instance, self.chosen, alone, self.progress, self.effort, self.recalled, tuning=self.tuning
            )
            for c in (*self.form.archive, *self.meanwhile):
                aside.form.archive.add(*rows_of([c]))
            found = aside.run(*self.to_report)
        self.meanwhile, self.bounded_meanwhile = list(aside.form.archive), aside.bounds
        if found.certificate.kind == "global" and not found.interrupted:
            self.found_meanwhile = found
        if found.interrupted == "interrupted":
            raise KeyboardInterrupt
        deadline.check()

    def _stop_early(self) -> None:
        """Take what is known when time is over; what the open boxes still allow is the gap that is proven."""
        for c in self.meanwhile:
            self.form.archive.add(*rows_of([c]))
        self.bounds += self.bounded_meanwhile
        if self.reporting and self.closed:
            # The designs stand; only what the objectives do not see is left as it is.
            self.bounds.append(Bound(self.rule.tolerance, np.empty((0, self.m))))
            self.closed = self.exhausted = self.complete = False
            return
        self._note_open()
        self.closed = self.exhausted = self.complete = False
        proven = self.stairs.finished() if self.stairs is not None and len(self.form.archive) else []
        some = self._spread(proven or list(self.form.archive), self._more_than_asked)
        self.front = self._spread(self._distinct(some), self.points)
        self._claim_no_less()

    def _note_open(self) -> None:
        """Note what is proven where a tree was stopped: what its open boxes still allow."""
        slack, m = self.under_way, self.m
        if slack is None or (not self.clock.open and not self.clock.beyond):
            return
        boxes = [self.form.objectives.phi_of(b.bounds)[:, :m] for b in self.clock.open]
        corners = list(self.clock.beyond) or boxes
        self.bounds.append(Bound(slack, np.concatenate([c.reshape(-1, m) for c in corners])))

    def _proven_gap(self) -> float | None:
        """Return the gap that bounds prove of the designs listed, where it is not the one asked for; none, if any."""
        if not self.front or not self.bounds:
            return None
        phi = np.array([c.phi[: self.m] for c in self.front])
        least = least_gap(self.bounds, phi, self.form.objectives.log[: self.m], self._sizes())
        return None if least is None else max(least, self.gap)

    def _sizes(self) -> np.ndarray:
        """Return what the gap of objectives that may be zero is a share of on this front, in phi."""
        phi = np.array([c.phi[: self.m] for c in self.front])
        sizes: np.ndarray = np.maximum(ranges(phi), self.form.objectives.finest[: self.m] / self.gap)
        return sizes

    def _amounts(self, gap: float) -> dict[str, float]:
        """Return in SI what the gap of a claim stands for, where it is no share of the value."""
        form = self.form
        least = gap * self._sizes()
        if self.m > 1:
            # The range of a few designs may be less than that of the front they were chosen from.
            least = np.maximum(least, self.rule.tolerance + ROOM)
        amounts = least * form.objectives.scales[: self.m]
        return {
            name: rounded_up(float(amounts[k]), self.instance.model.units[name])
            for k, name in enumerate(self.chosen)
            if not form.objectives.log[k]
        }

    def _timed(self, stage: str, work: Callable[[], Any]) -> Any:
        begin = time.monotonic()
        self._say(stage, 0.0)
        try:
            return work()
        finally:
            self.stage_seconds[stage] = self.stage_seconds.get(stage, 0.0) + time.monotonic() - begin
            self._say(stage, 1.0)

    def _working(self, open_boxes: int) -> None:
        """Show that work goes on inside a stage."""
        if open_boxes:
            self._say(self.stage, self.done, f"{open_boxes} boxes open")

    def _say(self, stage: str, done: float, message: str = "") -> None:
        self.stage, self.done = stage, done
        if self.progress is not None:
            self.progress(
                {
                    "stage": stage,
                    "done": float(min(max(done, 0.0), 1.0)),
                    "combinations": self.instance.combinations.count,
                    "incumbents": len(self.form.archive),
                    "message": message,
                }
            )

    def _root(self) -> None:
        self.clock.check()
        self._set_pool()
        if not len(self.pool):
            self.open_combinations = 0.0

    def _set_pool(self) -> None:
        """Begin with the box of everything; what it allows is the first that is proven."""
        self.pool = self.form.boxes.root()
        corners = self.form.objectives.phi_of(self.pool.bounds)[:, : self.m]
        self.bounds.append(Bound(np.zeros(self.m), corners))

    # -- one best design -----------------------------------------------------------------------

    def _best(
        self, k: int, plain: np.ndarray, start: Candidate | None = None, effort: int | None = None
    ) -> Candidate | None:
        """Return the design that is best in one objective, the others capped.

        With an ``effort`` of its own the search may end early and is content with what it has.
        """
        self.scalar_problems += 1
        before = len(self.form.archive)
        soon = self.effort if self.in_conflict else min(self.limits.first_try, self.effort)
        first = soon if effort is None else effort
        found, outcome, slack = self._best_within(k, plain, start, first)
        if not outcome.closed and effort is None and not self.in_conflict:
            # What is feasible is so narrow that it costs most to tell which limits leave nothing.
            self._begin_again(conflict=True)
            found, outcome, slack = self._best_within(k, plain, found, self.effort)
        if not outcome.closed and effort is None:
            rule = self._for_best(k, plain, slack, found)
            left = self._close(outcome.open, rule)
            while not len(left) and (finer := self._finer(k, slack, rule.known)) is not None:
                slack = finer
                rule = self._for_best(k, plain, slack, rule.known[0])
                left = self._close(self.pool, rule)
            found = rule.known[0] if len(rule.known) else None
        elif before == 0 and found is None:
            self.open_combinations = 0.0
        return found

    def _for_best(self, k: int, plain: np.ndarray, slack: float, known: Candidate | None) -> EpsilonCover:
        """Return the search for the design that is best in one objective."""
        rule = EpsilonCover([k], np.array([slack]), plain, self.form.new_archive([k]))
        if known is not None:
            rule.take(*rows_of([known]))
        return rule

    def _best_within(
        self, k: int, plain: np.ndarray, start: Candidate | None, effort: float
    ) -> tuple[Candidate | None, TreeOutcome, float]:
        """Return the best design found with so much effort, how the search ended, and the slack it had."""
        form = self.form
        slack = float(form.objectives.tolerance(self.gap, None if start is None else np.abs(start.phi))[k])
        found, outcome = self._tree_for_best(k, plain, slack, start, effort)
        while found is not None and outcome.closed:
            # The gap is a share of the best value, whose size is known only now; a better one may be smaller again.
            finer = self._finer(k, slack, [found])
            if finer is None:
                break
            slack = finer
            found, outcome = self._tree_for_best(k, plain, slack, found, effort)
        return found, outcome, slack

    def _tree_for_best(
        self, k: int, plain: np.ndarray, slack: float, start: Candidate | None, effort: float
    ) -> tuple[Candidate | None, TreeOutcome]:
        self._begin_tree(np.array([slack]) if self.m == 1 else None)
        found = best(self.form, self.pool, k, plain, slack, self.clock, self.rng, start, effort)
        self.under_way = None
        return found

    def _finer(self, k: int, slack: float, known: Archive | Sequence[Candidate]) -> float | None:
        """Return the slack that the gap means at the best value known; None where the slack is as fine as that."""
        if self.m > 1 or not len(known) or self.form.objectives.log[k]:
            return None
        finer = float(self.form.objectives.tolerance(self.gap, np.abs(known[0].phi))[k])
        return finer if finer < slack else None

    def _begin_tree(self, slack: np.ndarray | None) -> None:
        """Remember what a tree is to prove; if time runs out, the boxes that are open then tell what it has proven."""
        self.under_way = slack
        self.clock.open, self.clock.beyond = [], ()

    def _close(self, left: Boxes, rule: TabledPruningRule) -> Boxes:
        """Go on with boxes that a first effort has left open; return what stays open, and note what is proven then.

        Combinations that are few are solved one by one first: boxes close around what is best. Where too many stay open
        to be solved, Optuna draws some of them.
        """
        solved = False
        if self.thorough and len(left):
            solved = self._solve_few(left, rule)
            left = self._go_on(left, rule)
        if not len(left):
            return left
        self.closed = False
        self.unresolved += len(left)
        if self.thorough and not solved and not self._solve_few(left, rule):
            seed, trials = self.settings.seed, self.tuning.heuristics.parts.trials
            journal = study_file(self.instance, self.chosen, seed, self.tuning)
            self._say("parts", 0.0, BEGUN_ANEW if passed_over(journal) else "")
            self.outer_trials += sample_parts(self.form, left, rule, self.clock, journal, seed, trials)
            self.exhausted = False
        self.exhausted = self.exhausted and self.thorough
        if len(rule.columns) == self.m:
            self.bounds.append(Bound(rule.tolerance, self.form.objectives.phi_of(left.bounds)[:, : self.m]))
        return left

    def _solve_few(self, boxes: Boxes, rule: PruningRule) -> bool:
        """Solve the combinations of boxes from several starts, where they are few enough; tell whether they are."""
        combinations = self.form.boxes.cells.all_members(boxes.cell, self.limits.few_combinations + 1)
        few = len(combinations) <= self.limits.few_combinations
        if few:
            solve_everywhere(self.form, combinations, rule, self.clock, self.rng)
        return few

    def _go_on(self, left: Boxes, rule: TabledPruningRule) -> Boxes:
        """Go on with boxes while they keep closing and there is time; return what stays open."""
        self._begin_tree(rule.tolerance if len(rule.columns) == self.m else None)
        begun = time.monotonic()
        effort = replace(self.limits.further, seconds=self.budget)
        outcome = best_first(self.form, left, rule, self.clock, self.rng, effort)
        self.budget -= time.monotonic() - begun
        self.budget_spent |= outcome.spent
        self.looked += outcome.looked
        self.under_way = None
        return outcome.open

    def _extremes(self) -> None:
        """Find the design that is best in each objective, before the front: its ranges are needed, or it is all."""
        found = [self._best(k, np.full(len(self.form.goals), np.inf)) for k in range(self.m)]
        known = [c for c in found if c is not None]
        if self.m == 1:
            self.front, self.complete = known, self.closed
        elif known:
            phi = np.array([c.phi for c in known])
            self.rule = self._rule(ranges(phi))

    # -- the front -----------------------------------------------------------------------------

    def _coarse(self) -> None:
        """Look for the first designs; where there are none yet, prepare for proving that there cannot be any."""
        if self.recalled and warm_start(self.form, self.rule, self.recalled, self.rng):
            # For one objective little is left to look for, where what is worth splitting is known as well.
            if self.m > 1 or not self.taught:
                self._seek(self._fine())
            return
        if self._look_round() or not len(self.pool):
            return
        self._begin_again(conflict=True)
        self._look_round()

    def _begin_again(self, conflict: bool) -> None:
        """Begin again with boxes that also carry what limits share (conflict) or do not, and keep what is known."""
        known, self.in_conflict = self.form, conflict
        self.form = self._formulation(conflict, known.counters)
        if conflict:
            self.form.bounding.branching.adopt(known.bounding.branching.statistics())
        self.form.archive.add(known.archive.combination, known.archive.variables, known.archive.phi)
        self.rule = self._rule(None)
        self._set_pool()

    def _look_round(self) -> bool:
        """Cover everything coarsely and look beside what is found; tell whether anything feasible is known."""
        coarse = self._with_slack(self.rule.tolerance * max(self.limits.coarse / self.gap, 1.0))
        outcome = self._covered(coarse, self.limits.first_boxes if self.m == 1 else self.limits.coarse_boxes)
        if not len(self.form.archive) and not outcome.closed and self.m == 1:
            outcome = self._covered(coarse, self.limits.coarse_boxes)
        if len(self.form.archive):
            self._seek(self._fine())
        elif outcome.closed:
            self.pool, self.open_combinations = self.form.boxes.nothing(), 0.0
        return bool(len(self.form.archive))

    def _cover(self) -> None:
        """Cover everything as finely as the points asked for need, at most as the gap."""
        scarce = self.m == 2 and self.instance.combinations.count > self.limits.few_combinations and self._dive()
        form = self.form
        fine = self._fine()
        together = self.limits.scarce_front if scarce else self.limits.whole_front
        outcome = self._covered(fine, min(self.effort, together) if self.m == 2 else self.effort)
        if not outcome.closed and self.m == 2:
            fine = self._fine()
            # Where designs are many the boxes do close; where they are few or unknowns many, they hardly do.
            self.by_steps = self.effort < self.limits.boxes or len(form.archive) < self.points
            outcome = self._in_steps(fine) if self.by_steps else self._covered(fine, self.effort)
        left = self._close(outcome.open, fine)
        if len(outcome.open) and not len(left):
            self.covering = fine
            self.bounds.append(Bound(fine.tolerance, np.empty((0, self.m))))
        form = self.form
        self.open_combinations = float(form.boxes.cells.size(left.cell).sum())

    def _dive(self) -> bool:
        """Look for more where few designs are known; tell whether they are still few, but not none."""
        if not len(self.form.archive):
            self._covered(self._with_slack(self.rule.tolerance), min(self.effort, self.limits.whole_front), enough=0)
        if not 0 < len(self.form.archive) < self.tuning.heuristics.seeker.scarce:
            return False
        if self.in_conflict:
            self._begin_again(conflict=False)
        large_neighbourhood_search(self.form, self.rule.columns, self.rule.tolerance, self.clock, self.rng)
        self._seek(self._fine())
        return len(self.form.archive) < self.tuning.heuristics.seeker.scarce

    def _fine(self) -> EpsilonCover:
        """Return the cover that is as fine as the points asked for need, at most as the gap."""
        phi = self.form.archive.phi[:, : self.m]
        span = np.ptp(phi, axis=0) if len(phi) else np.zeros(self.m)
        return self._with_slack(np.maximum(self.limits.fine * span / self.points, self.rule.tolerance))

    def _seek(self, rule: EpsilonCover) -> None:
        """Look for designs beside those that are known."""
        PrimalHeuristics(self.form, rule, self.rng, False).beside(self.clock)

    def _with_slack(self, slack: np.ndarray) -> EpsilonCover:
        return EpsilonCover(self.rule.columns, slack, self.rule.fixed_cutoffs, self.form.archive)

    def _covered(self, rule: EpsilonCover, effort: float, enough: int | None = None) -> TreeOutcome:
        """Cover everything with one slack; if the time runs out, the boxes that are open tell what is proven."""
        self._begin_tree(rule.tolerance)
        outcome = branch_and_bound(self.form, self.pool, rule, self.clock, self.rng, effort, enough)
        return self._noted(rule, outcome)

    def _in_steps(self, rule: EpsilonCover) -> TreeOutcome:
        """Cover everything with one slack, one objective capped step by step."""
        self._begin_tree(rule.tolerance)
        return self._noted(
            rule, cover_by_epsilon_constraint(self.form, self.pool, rule, self.clock, self.rng, self.effort)
        )

    def _noted(self, rule: EpsilonCover, outcome: TreeOutcome) -> TreeOutcome:
        """Count the boxes; what is covered with one slack stays known if the time runs out later."""
        self.under_way = None
        self.looked += outcome.looked
        if outcome.closed:
            self.covering = rule
            self.bounds.append(Bound(rule.tolerance, np.empty((0, self.m))))
        return outcome

    def _multiple(self, rule: EpsilonCover) -> float:
        """Return the slack of a cover in units of the slack that the gap stands for."""
        return float(np.max(rule.tolerance / self.rule.tolerance))

    def _choose(self) -> None:
        """Choose the designs to return and prove them; where too few are known, look for more until nothing is left."""
        for last in (*(False,) * (self.limits.choices - 1), True):
            self.front = self._polished(self._more_than_asked)
            self._rescale()
            if not last and self._too_few() and self._look_for_more():
                continue
            if not self.closed or self.complete or self._proven_at_gap() or self._prove():
                break
        if self.closed and not self.complete and len(self.front) < self.points:
            covered = self._proven_at_gap() if self.by_steps else self._covered(self.rule, self.limits.boxes).closed
            if covered:
                # Now each design stands that no known one beats, also those that were found meanwhile.
                self.front = self._polished(self._more_than_asked)
                self.complete = len(self.front) <= self.points and self._stand_for_all()
        standing, self.front = self.front, self._spread(self.front, self.points)
        self.spare = [c for c in standing if not any(c is own for own in self.front)]

    @property
    def _more_than_asked(self) -> int:
        """Some more than asked for: designs that turn out to be equal, or beaten by the same one, become one."""
        return self.points + self.points // 3 + 5

    def _too_few(self) -> bool:
        """Tell whether fewer designs are chosen than asked for, and there may be more."""
        if len(self.front) >= self.points or not self.closed or self.complete:
            return False
        return self.may_find_more and not (self.by_steps and self._proven_at_gap())

    def _spread(self, designs: Sequence[Candidate], most: int) -> list[Candidate]:
        """Return those designs, at most so many, that spread best; the best in each objective among them."""
        phi = np.array([c.phi[: self.m] for c in designs]).reshape(len(designs), self.m)
        kept, ends = self._in_place_of_given(phi), extremes(phi)
        if not kept:
            return [designs[int(k)] for k in spread_subset(phi, most)]
        if not self.closed:
            return [designs[int(k)] for k in spread_subset(phi, most, [*kept, *ends])]
        # What is proven speaks of the best in each objective: they come before designs that were given.
        some = np.array(list(dict.fromkeys([*ends, *kept])))
        if len(some) >= most:
            return [designs[int(some[k])] for k in spread_subset(phi[some], most)]
        return [designs[int(k)] for k in spread_subset(phi, most, some.tolist())]

    def _distinct(self, designs: Sequence[Candidate]) -> list[Candidate]:
        """Return designs that still differ when ties are settled, which gives away some of what may be zero."""
        return distinct(designs, self.m, self.tuning, np.where(self.form.objectives.log[: self.m], 0.0, ROOM))

    def _stand_for_all(self) -> bool:
        """Tell whether the designs of the front cover all that are known."""
        listed = np.array([c.phi[: self.m] for c in self.front])
        known = self.form.archive.phi[:, : self.m]
        covered = np.all(listed[None, :, :] - self.rule.tolerance <= known[:, None, :], axis=2).any(axis=1)
        return bool(covered.all())

    def _rescale(self) -> None:
        """Measure the gap of objectives that can be zero against their range on this front."""
        phi = np.array([c.phi for c in self.front])
        needed = self.form.objectives.tolerance(self.gap, ranges(phi))[: self.m]
        too_wide = needed < self.rule.tolerance
        if np.any(too_wide):
            # A little less than needed: a range that shrinks by next to nothing shall not need another proof.
            self.rule.tolerance = np.where(too_wide, self.limits.margin * needed, self.rule.tolerance)
            self.proven_designs.clear()

    def _proven_at_gap(self) -> bool:
        return self.covering is not None and self._multiple(self.covering) <= 1.0

    def _polished(self, most: int) -> list[Candidate]:
        """Return designs that spread over the front, at most so many, each made as good as its parts allow."""
        form, archive, done = self.form, self.form.archive, set[bytes]()
        polish_extremes(form, self.m, float(self.rule.tolerance.max()))
        for _ in range(self.limits.polishings):
            rough = [c for c in self._spread(list(archive), most) if c.phi[: self.m].tobytes() not in done]
            if not rough:
                break
            better = polish_variables(form, rough, self.m, range(self.m))
            done.update(c.phi[: self.m].tobytes() for c in better)
            archive.add(*rows_of(better))
        return self._spread(self._distinct(list(archive)), most)

    def _look_for_more(self) -> bool:
        """Without slack everything non-dominated is found, or more than enough; tell whether anything was."""
        known, effort = self.form.archive.phi, self.limits.fill + self.looked
        if self.by_steps:
            # Not everything that is not dominated, but everything that the gap tells apart.
            self.may_find_more = self._in_steps(self._with_slack(self.rule.tolerance)).closed
            return not np.array_equal(self.form.archive.phi, known)
        outcome = self._covered(self._with_slack(np.full(self.m, self.tuning.tolerances.tie)), effort, self.points)
        self.complete = outcome.closed and len(self.form.archive) <= self.points
        return not np.array_equal(self.form.archive.phi, known)

    def _prove(self) -> bool:
        """Prove the designs chosen; tell whether they stand or better ones were found for some."""
        form, proven = self.form, self.proven_designs
        stairs = NonImprovement(self.front, self.rule.columns, self.rule.tolerance, form.archive, proven)
        self.stairs = stairs
        if self.by_steps:
            self._begin_tree(None)  # the boxes of one step are not all that is open
            outcome = prove_by_epsilon_constraint(form, self.pool, stairs, self.clock, self.rng, self.effort)
        else:
            self._begin_tree(stairs.tolerance)
            outcome = branch_and_bound(form, self.pool, stairs, self.clock, self.rng, self.limits.boxes)
        self.looked += outcome.looked
        left = self._close(outcome.open, stairs)
        self.stairs, self.under_way = None, None
        replaced = any(a is not b for a, b in zip(stairs.designs, self.front, strict=True))
        finished = stairs.finished()
        self.front = self._distinct(finished)
        if not len(left):
            proven.update(c.phi.tobytes() for c in finished)
        return bool(len(left)) or not replaced or len(self.front) >= self.points

    # -- afterwards ----------------------------------------------------------------------------

    def challenged(self, listed: np.ndarray, deadline: float) -> tuple[bool, list[Candidate]]:
        """Look for designs that beat others, of other families for instance, and prove that no further ones do.

        Parameters
        ----------
        listed : array (designs, objectives)
            Objectives of the others in SI, with their sign.
        deadline : float
            As of ``time.monotonic``.

        Returns
        -------
        tuple
            Whether it is proven that nothing here improves one of them, or one of the designs found instead, by more
            than the gap in every objective; and the designs found, as good as their parts allow.
        """
        form, m = self.form, self.m
        self.stage, self.done = "against the others", 0.0
        phi = np.zeros((len(listed), len(form.goals)))
        phi[:, :m] = form.objectives.phi_of(listed)
        every = np.concatenate([phi[:, :m], *(c.phi[None, :m] for c in self.front)])
        sizes = np.ones(len(form.goals))
        sizes[:m] = ranges(every)
        nowhere = np.full(form.n, np.nan)
        designs = [*(Candidate(-1, nowhere, row) for row in phi), *self.front]
        own = {c.phi.tobytes() for c in self.front}
        nothing = form.new_archive(range(m))
        slack = form.objectives.tolerance(self.gap, sizes)[:m]
        self.against = np.maximum(self.against, (slack + ROOM) * form.objectives.scales[:m])
        stairs = NonImprovement(designs, range(m), slack, nothing, own)
        stairs.take(form.archive.combination, form.archive.variables, form.archive.phi)
        outcome = branch_and_bound(form, self.pool, stairs, Clock(deadline, self._working), self.rng, self.limits.boxes)
        better = [c for c in stairs.designs if c.combination >= 0 and c.phi.tobytes() not in own]
        return outcome.closed, polish_variables(form, distinct(better, m, self.tuning), m, range(m))

    def reported(self, candidates: Sequence[Candidate]) -> list[Design]:
        """Return designs for more candidates, ties settled."""
        known, self.front = self.front, list(candidates)
        designs = self._designs(make_frame(self.instance, self.chosen), [1.0] * self.m, settle=True)
        self.front = [*known, *candidates]
        return designs

    # -- the report ----------------------------------------------------------------------------

    def _designs(self, frame: Frame, weights: Sequence[float], settle: bool) -> list[Design]:
        settled = distinct(self.form.points.as_they_are(self.front), self.m, self.tuning)
        alternatives: list[tuple[str, ...]] = [()] * len(settled)
        if settle:
            settled, alternatives = self._settled()
            self._say("report", 0.5)
        costs = elasticities(self.form, settled if settle else [], self.m) or [{}] * len(settled)
        points = np.array([c.variables for c in settled]).reshape(len(settled), self.form.n)
        result = self.form.points.evaluate(points, np.array([c.combination for c in settled], dtype=np.int64))
        proven = self.closed and settle
        more = [
            {
                "status": Status.OPTIMAL if proven else Status.FEASIBLE,
                "gap": self.gap if proven else None,
                "alternatives": alternatives[k],
                "elasticity": costs[k],
            }
            for k in range(len(settled))
        ]
        designs = found_designs(self.form, [frame] * len(settled), settled, result, more)
        return ranked(designs, self.chosen, weights, settle and self.complete)[1]

    def _settled(self) -> tuple[list[Candidate], list[tuple[str, ...]]]:
        """Settle what the chosen objectives do not see, and name other combinations that tie."""
        form, chosen = self.form, list(self.front)
        if self.m == 1 and len(form.goals) > 1:
            # One objective leaves whole families of parts open; the next objective is settled over all of them.
            caps = np.full(len(form.goals), np.inf)
            caps[0] = chosen[0].phi[0] + self.tuning.tolerances.tie
            better = self._best(1, caps, chosen[0], self.limits.tie)
            chosen[0] = chosen[0] if better is None else better
        pairs: list[tuple[Candidate, tuple[str, ...]]] = []
        while chosen:
            settled = break_ties(form, self.pool, chosen, self.m)
            listed = form.points.as_they_are([c for c, _ in settled])
            pairs += [(c, a) for c, (_, a) in zip(listed, settled, strict=True)]
            stay = {id(c) for c in distinct([c for c, _ in pairs], self.m, self.tuning)}
            pairs = [pair for pair in pairs if id(pair[0]) in stay]
            # Where settling has made two designs one, others that stand as well take the place.
            missing = max(self.points - len(pairs), 0)
            chosen, self.spare = self.spare[:missing], self.spare[missing:] if missing else []
        return [c for c, _ in pairs], [a for _, a in pairs]

    def _result(
        self,
        frame: Frame,
        designs: Sequence[Design],
        settings: Mapping[str, Any],
        explanation: Mapping[str, Any] | None,
        interrupted: str,
    ) -> ParetoFront:
        total = self.instance.combinations.count
        kind = "global" if self.closed else "exhaustive" if self.exhausted and not interrupted else "heuristic"
        gap = (self.gap if designs else None) if kind == "global" else self._proven_gap()
        solved = len(self.form.counters.solved_combinations)
        excluded = int(max(total - max(self.open_combinations if kind != "global" else 0.0, solved), 0))
        spent = self.limits.further.seconds if self.budget_spent and kind != "global" else None
        amounts = self._amounts(gap) if designs and gap is not None else {}
        units = {name: self.instance.model.units[name] for name in amounts}
        certificate = Certificate(kind, gap, total, excluded, solved, self.unresolved, spent, amounts, units)
        statistics = replace(
            offered(self.instance),
            excluded_by_bound=excluded,
            solved=solved,
            boxes=self.form.counters.contracted,
            scalar_problems=self.scalar_problems,
            designs_known=len(self.form.archive),
            nlp_solves=self.form.counters.nlp_solves,
            nlp_solves_to_find=self.solves_to_find,
            outer_trials=self.outer_trials,
            seconds={**self.stage_seconds, "total": time.monotonic() - self.started},
        )
        return front_of(
            self.instance,
            frame,
            designs,
            certificate,
            statistics,
            settings,
            complete=self.complete,
            explanation=explanation,
            interrupted=interrupted,
        )
