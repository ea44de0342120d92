"""From a requirement to ranked Pareto designs over all combinations of parts and counts."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from synth.analysis import chosen_objectives, make_design, make_frame, part_row
from synth.conflicts import explain_infeasible
from synth.elasticity import elasticities
from synth.errors import InputError
from synth.feasibility import Status
from synth.formulation import TIE, Boxes, Candidate, Formulation
from synth.instance import Instance, as_mapping, catalogs_for
from synth.nlp import Task
from synth.pareto import Zone, Zones, non_dominated, rank, spread_subset
from synth.problem import DesignProblem, load
from synth.results import Certificate, Design, Frame, ParetoFront
from synth.tree import Clock, Outcome, Question, Stopped, Target, minimise, relative_slack

ROOT_CHUNK = 16384
EXHAUST_EFFORT = 400
TOGETHER = 8
ZONE_BOXES = 12_000
ZONE_SPLITS = 3
MULTI_STARTS = 6
EXHAUSTIVE_LIMIT = 3000


def synthesize(
    p: str | type[DesignProblem] | DesignProblem,
    requirements: Mapping[str, Any],
    objectives: Any = None,
    points: int = 30,
    catalogs: Any = None,
    parts: Mapping[str, Any] | None = None,
    limits: Mapping[str, Any] | None = None,
    fix: Mapping[str, Any] | None = None,
    weights: Mapping[str, float] | None = None,
    gap: float = 1e-3,
    grid: bool = True,
    workers: int = 1,
    seed: int = 0,
    progress: Callable[[Mapping[str, Any]], None] | None = None,
    time_limit: float | None = None,
) -> ParetoFront:
    """Find the ranked Pareto designs for a requirement.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
    requirements : mapping
        Name or symbol -> text with unit ("600 N*m") or bare number in the declared unit.
    objectives : names, or mapping name -> "min"/"max", optional
        The family's defaults when not given.
    points : int
        At most this many designs.
    catalogs : folder or mapping, optional
        Own part tables; others stay the shipped ones.
    parts : mapping, optional
        Slot -> list of designations, or a condition on columns.
    limits : mapping, optional
        Quantity -> "<= 260 mm", "200 mm .. 260 mm", "== 4", or a list of them.
    fix : mapping, optional
        Pins variables, counts, choices, parts.
    weights : mapping, optional
        Objective -> weight >= 0 for the ranking; 1 where missing.
    gap : float
        Relative improvement in every objective that need not be excluded.
    grid : bool
        True: only makeable values of gridded variables. False: all variables continuous.
    workers : int
        Processes that may be used; the result is the same for any number.
    seed : int
        Of all random choices.
    progress : callable, optional
        Called with a mapping: stage, done (0..1), combinations, incumbents, message.
    time_limit : float, optional
        Seconds after which the best front so far is returned.

    Returns
    -------
    ParetoFront

    Raises
    ------
    InputError
        For everything that is wrong with the input, in one sentence.
    """
    problem = load(p)
    _check_settings(points, gap, grid, workers, seed, progress, time_limit)
    instance = Instance(problem, requirements, catalogs_for(problem, catalogs), parts, limits, fix, grid)
    chosen = chosen_objectives(instance.model, objectives)
    weight_list = _weights(instance, chosen, weights)
    settings = {
        "points": points,
        "gap": gap,
        "grid": grid,
        "seed": seed,
        "weights": dict(zip(chosen, weight_list, strict=True)),
        "parts": {k: v if isinstance(v, str) else list(v) for k, v in (parts or {}).items()},
        "limits": {k: v if isinstance(v, str) else list(v) for k, v in (limits or {}).items()},
        "fix": {k: v if isinstance(v, (str, int, float, bool)) else str(v) for k, v in (fix or {}).items()},
    }
    search = _FrontSearch(instance, chosen, points, gap, seed, progress, time_limit)
    return search.run(weight_list, settings)


def _check_settings(points: Any, gap: Any, grid: Any, workers: Any, seed: Any, progress: Any, time_limit: Any) -> None:
    def whole(value: Any) -> bool:
        return isinstance(value, (int, np.integer)) and not isinstance(value, bool)

    def real(value: Any) -> bool:
        return isinstance(value, (int, float, np.floating)) and not isinstance(value, bool) and math.isfinite(value)

    if not whole(points) or points < 1:
        raise InputError("points", points, "a whole number of designs, at least 1")
    if not real(gap) or not 1e-6 <= gap <= 0.5:
        raise InputError("gap", gap, "a fraction from 1e-6 to 0.5, for example 0.001")
    if not isinstance(grid, (bool, np.bool_)):
        raise InputError("grid", grid, "true or false")
    if progress is not None and not callable(progress):
        raise InputError("progress", progress, "a function of one mapping, or none")
    if not whole(workers) or workers < 1:
        raise InputError("workers", workers, "a whole number, at least 1")
    if not whole(seed) or seed < 0:
        raise InputError("seed", seed, "a whole number, at least 0")
    if time_limit is not None and (not real(time_limit) or time_limit <= 0):
        raise InputError("time_limit", time_limit, "a positive number of seconds")


def _weights(instance: Instance, chosen: Mapping[str, str], weights: Mapping[str, float] | None) -> list[float]:
    values = dict.fromkeys(chosen, 1.0)
    asked = as_mapping(weights, "weights", "{'mass': 2}")
    for name, weight in instance.model.by_name(asked, "weights", list(chosen), "a chosen objective").items():
        number = weight if isinstance(weight, (int, float)) and not isinstance(weight, bool) else math.nan
        if not (math.isfinite(number) and number >= 0):
            raise InputError(f"weights: {name}", weight, "a number that is not negative")
        values[name] = float(number)
    if not any(values.values()):
        raise InputError("weights", dict(asked), "at least one weight above 0")
    return list(values.values())


class _FrontSearch:
    """One run: root boxes, extremes, the zones between them, ties, and the report."""

    def __init__(
        self,
        instance: Instance,
        chosen: Mapping[str, str],
        points: int,
        gap: float,
        seed: int,
        progress: Callable[[Mapping[str, Any]], None] | None,
        time_limit: float | None,
    ) -> None:
        self.instance, self.chosen, self.points, self.gap = instance, dict(chosen), points, gap
        self.form = Formulation(instance, self._chain(), len(chosen))
        self.m = len(chosen)
        self.started = time.monotonic()
        self.clock = Clock(math.inf if time_limit is None else self.started + time_limit, self._working)
        self.stage, self.done = "", 0.0
        self.rng = np.random.default_rng(seed)
        self.progress = progress
        self.stage_seconds: dict[str, float] = {}
        self.closed = True
        self.exhausted = True
        self.unresolved = 0
        self.pool: Boxes = self.form.root(np.empty(0, dtype=np.int64))  # all boxes that may hold a feasible design
        self.front: list[Candidate] = []
        self.complete = False
        self.scalar_problems = 0
        self.rooted = 0
        self.ranges: np.ndarray | None = None

    def _chain(self) -> dict[str, str]:
        """Return the chosen objectives, then what settles ties: other objectives, then the variables."""
        declared = self.instance.model.declaration.objectives
        chain = dict(self.chosen)
        for default in (True, False):
            for objective in declared.values():
                if objective.default == default and objective.name not in chain:
                    chain[objective.name] = objective.sense
        for variable in self.instance.model.variables:
            chain.setdefault(variable.name, "min")
        return chain

    # -- the run -------------------------------------------------------------------------------

    def run(self, weights: Sequence[float], settings: Mapping[str, Any]) -> ParetoFront:
        frame = make_frame(self.instance, self.chosen)
        interrupted = ""
        designs: list[Design] = []
        explanation = None
        try:
            self._timed("bounds", self._root)
            if len(self.pool):
                self._timed("extremes", self._extremes)
            if self.front:
                self._timed("front", self._fill)
                designs = self._timed("report", lambda: self._designs(frame, weights, settle=True))
            else:
                searched = set(self.form.solved_combinations)
                explanation = self._timed("explanation", lambda: explain_infeasible(self.form, self.rng))
                # What was solved only to explain does not change how the combinations were excluded.
                self.form.solved_combinations = searched
        except Stopped as stop:
            interrupted = stop.reason
        except KeyboardInterrupt:
            interrupted = "interrupted"
        if interrupted:
            self.closed = self.exhausted = self.complete = False
            self._take_from_archive()
            designs = self._designs(frame, weights, settle=False) if self.front else []
        return self._result(frame, designs, settings, explanation, interrupted)

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
            self.progress({
                "stage": stage,
                "done": float(min(max(done, 0.0), 1.0)),
                "combinations": self.instance.combinations,
                "incumbents": len(self.front),
                "message": message,
            })  # fmt: skip

    def _root(self) -> None:
        total = self.instance.combinations
        kept = []
        for first in range(0, total, ROOT_CHUNK):
            self.clock.check()
            numbers = np.arange(first, min(first + ROOT_CHUNK, total), dtype=np.int64)
            kept.append(self.form.root(numbers))
            self.rooted += len(numbers)
            self._say("bounds", self.rooted / total)
        self.pool = Boxes.joined(kept)
        if len(self.pool):
            self.form.settle_objectives(self.pool)
            self.form.sample(self.pool, 3, self.rng)

    def _target(self, k: int, caps: np.ndarray) -> Target:
        """Return the problem: least phi_k, the other objectives capped."""
        slope = np.zeros(len(self.form.goals))
        slope[k] = 1.0
        return Target(np.where(slope > 0, 0.0, caps), slope)

    def _solve(self, questions: Sequence[Question]) -> list[Outcome]:
        self.scalar_problems += len(questions)
        outcomes = minimise(self.form, questions, self.gap, self.clock, self.ranges)
        return [o if o.closed else self._exhaust(o, q) for o, q in zip(outcomes, questions, strict=True)]

    def _exhaust(self, outcome: Outcome, question: Question) -> Outcome:
        """Solve every combination that bounds could not exclude, from several starts."""
        self.closed = False
        self.unresolved += outcome.unresolved
        if len(outcome.open_combinations) > EXHAUSTIVE_LIMIT:
            self.exhausted = False
        target, best, t = question.target, outcome.best, outcome.t
        boxes = self.pool.take(np.isin(self.pool.combination, outcome.open_combinations[:EXHAUSTIVE_LIMIT]))
        for k in range(len(boxes)):
            self.clock.check()
            box = boxes.take(np.array([k]))
            found = minimise(
                self.form, [Question(target, box, best, t)], self.gap, self.clock, self.ranges, EXHAUST_EFFORT
            )
            for candidate in [found[0].best, *self._multi_start(box, target)]:
                if candidate is not None and float(target.t_of(candidate.phi)) < t:
                    best, t = candidate, float(target.t_of(candidate.phi))
        return Outcome(best, t, False, outcome.open_combinations, outcome.unresolved)

    def _multi_start(self, box: Boxes, target: Target) -> list[Candidate]:
        if self.form.gridded.any():
            return []  # the small tree over the grid was searched instead
        low, high = box.low[0], box.high[0]
        moving = target.slope > 0
        task = Task(
            weights=np.where(moving, 1e-6, 0.0),
            slopes=target.slope,
            caps=np.where(np.isfinite(target.base), target.base, np.inf),
            goal_scales=self.form.goal_scales,
        )
        found = []
        for _ in range(MULTI_STARTS):
            start = low + (high - low) * self.rng.random(len(low))
            solution = self.form.solve(task, int(box.combination[0]), start, low, high)
            if solution is not None:
                found += self.form.candidates(solution.variables[None, :], box.combination)
        return found

    def _extremes(self) -> None:
        """Find, for every objective, the design that is best in it, the others settled in order."""
        open_caps = np.full(len(self.form.goals), np.inf)
        found: list[Candidate] = []
        for k in range(self.m):
            outcome = self._solve([Question(self._target(k, open_caps), self.pool, self._best_known(found, k))])[0]
            if outcome.best is None:
                return
            found.append(self._improve(outcome.best, [j for j in range(self.m) if j != k]))
            self._say("extremes", (k + 1) / self.m)
        self.front = self._distinct(found)

    @staticmethod
    def _best_known(found: Sequence[Candidate], k: int) -> Candidate | None:
        return min(found, key=lambda c: float(c.phi[k]), default=None)

    def _improve(self, candidate: Candidate, order: Sequence[int]) -> Candidate:
        """Return a design at least as good in every objective, improved in each in turn."""
        caps = np.full(len(self.form.goals), np.inf)
        caps[: self.m] = candidate.phi[: self.m]
        for k in order:
            outcome = self._solve([Question(self._target(k, caps), self.pool, candidate)])[0]
            if outcome.best is not None:
                candidate = outcome.best
                caps[: self.m] = np.minimum(caps[: self.m], candidate.phi[: self.m])
        return candidate

    def _distinct(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        result: list[Candidate] = []
        for c in candidates:
            if not any(np.all(np.abs(c.phi[: self.m] - d.phi[: self.m]) <= TIE) for d in result):
                result.append(c)
        phi = np.array([c.phi[: self.m] for c in result])
        keep = non_dominated(phi)
        return [c for c, good in zip(result, keep, strict=True) if good]

    def _fill(self) -> None:
        """Place points in the largest holes of the front until there are enough or nothing is left."""
        if self.m == 1 or len(self.front) == 1:
            self.complete = self.closed
            return
        phi = np.array([c.phi[: self.m] for c in self.front])
        zones = Zones(phi.min(axis=0), phi.max(axis=0), self.pool)
        self.ranges = np.concatenate([zones.range, np.ones(len(self.form.goals) - self.m)])
        for point in phi:
            zones.add(point)
        while zones.zones and len(self.front) < self.points:
            largest = sorted(zones.zones, key=zones.size, reverse=True)
            self._fill_zones(zones, largest[: min(TOGETHER, self.points - len(self.front))])
            self._say("front", len(self.front) / self.points)
        self.complete = self.closed and not zones.zones
        self.front = self._distinct(self.front)
        self._keep_points()

    def _keep_points(self) -> None:
        """Keep at most as many designs as were asked for."""
        if len(self.front) > self.points:
            phi = np.array([c.phi[: self.m] for c in self.front])
            self.front = [self.front[k] for k in spread_subset(phi, self.points)]
            self.complete = False

    def _fill_zones(self, zones: Zones, chosen: Sequence[Zone]) -> None:
        """Seek the middle of several zones at once; a zone that holds nothing is closed."""
        questions = []
        for zone in chosen:
            zone.cover = self._narrowed(zone)
            lower = zones.lower(zone)
            base = np.full(len(self.form.goals), np.inf)
            slope = np.zeros(len(self.form.goals))
            closed = np.flatnonzero(np.isfinite(zone.upper))
            base[closed], slope[closed] = lower[closed], (zone.upper - lower)[closed]
            questions.append(Question(Target(base, slope), zone.cover, self._inside(zone.upper), 1.0))
        outcomes = self._solve(questions)
        found = []
        for zone, question, outcome in zip(chosen, questions, outcomes, strict=True):
            if outcome.best is None or outcome.t >= 1.0 - TIE:
                zones.close(zone)
                continue
            corner = question.target.base[: self.m] + question.target.slope[: self.m] * outcome.t
            found.append((zone, outcome.best, corner))
        for zone, point in self._tightened(found):
            if any(np.all(c.phi[: self.m] <= point.phi[: self.m] + TIE) for c in self.front):
                zones.close(zone)
                continue
            self.front.append(point)
            zones.add(point.phi[: self.m])

    def _narrowed(self, zone: Zone) -> Boxes:
        """Return the boxes that reach into a zone, tightened to it and split a little; its parts start from them."""
        caps = np.full(len(self.form.goals), np.inf)
        caps[: self.m] = zone.upper
        boxes: Boxes = zone.cover
        for _ in range(ZONE_SPLITS):
            self.clock.check()
            boxes = boxes.take(np.all(self.form.phi_of(boxes.bounds) <= caps, axis=1))
            known = self.form.archive.caps(self.form.phi_of(boxes.bounds))
            boxes = self.form.contract(boxes, np.minimum(known, caps))
            if len(boxes) > ZONE_BOXES:
                break
            boxes = Boxes.joined(self.form.split(boxes))
        return boxes

    def _tightened(self, found: Sequence[tuple[Zone, Candidate, np.ndarray]]) -> list[tuple[Zone, Candidate]]:
        """Improve designs from the middle of zones in the objectives that did not decide them.

        An objective that reaches the corner is proven already: less of it would have meant a smaller t.
        """
        points = [candidate for _, candidate, _ in found]
        for k in range(self.m):
            asked, questions = [], []
            for position, (zone, first, corner) in enumerate(found):
                slack = relative_slack(self.form, self.gap, first.phi, self.ranges)[k]
                if first.phi[k] < corner[k] - slack:
                    caps = np.full(len(self.form.goals), np.inf)
                    caps[: self.m] = points[position].phi[: self.m]
                    asked.append(position)
                    questions.append(Question(self._target(k, caps), zone.cover, points[position]))
            for position, outcome in zip(asked, self._solve(questions) if questions else [], strict=True):
                if outcome.best is not None:
                    points[position] = outcome.best
        return [(zone, point) for (zone, _, _), point in zip(found, points, strict=True)]

    def _inside(self, upper: np.ndarray) -> Candidate | None:
        """Return a known design that lies in a zone, if there is one."""
        inside = [c for c in self.form.archive if np.all(c.phi[: self.m] < upper - 1e-6)]
        return min(inside, key=lambda c: float(np.max(c.phi[: self.m] - upper)), default=None)

    def _take_from_archive(self) -> None:
        pool = [*self.front, *self.form.archive]
        if pool:
            distinct = self._distinct(pool)
            phi = np.array([c.phi[: self.m] for c in distinct])
            self.front = [distinct[k] for k in spread_subset(phi, self.points)]

    # -- the report ----------------------------------------------------------------------------

    def _designs(self, frame: Frame, weights: Sequence[float], settle: bool) -> list[Design]:
        settled, alternatives = list[Candidate](), list[tuple[str, ...]]()
        for k, candidate in enumerate(self.front):
            if not settle:
                settled.append(candidate)
                alternatives.append(())
                continue
            final, others = self._settle(candidate)
            settled.append(final)
            alternatives.append(others)
            self._say("report", (k + 1) / len(self.front))
        results = [self.form.evaluate(c.variables[None, :], np.array([c.combination])) for c in settled]
        values = np.array([[float(r.values[name][0]) for name in self.chosen] for r in results])
        ranking = rank(self.chosen, values, weights)
        designs = []
        for position, k in enumerate(ranking.order):
            c = settled[k]
            parts, _, choices = self.instance.describe(c.combination)
            proven = self.closed and settle
            designs.append(
                make_design(
                    self.instance,
                    frame,
                    c.variables,
                    self.instance.data(np.array([c.combination])),
                    {slot: part_row(table, row) for slot, (table, row) in parts.items()},
                    choices,
                    status=Status.OPTIMAL if proven else Status.FEASIBLE,
                    gap=self.gap if proven else None,
                    rank=position + 1,
                    score=float(ranking.scores[k]),
                    note=ranking.notes[k],
                    alternatives=alternatives[k],
                    elasticity={} if not settle else elasticities(self.form, c, self.m),
                )
            )
        return designs

    def _settle(self, candidate: Candidate) -> tuple[Candidate, tuple[str, ...]]:
        """Settle what the chosen objectives do not see, and name other combinations that tie."""
        form, current = self.form, candidate
        caps = np.full(len(form.goals), np.inf)
        caps[: self.m] = candidate.phi[: self.m] + TIE
        if self.m == 1 and len(form.goals) > 1:
            # One objective leaves whole families of parts open; the next objective is settled over all of them.
            outcome = self._solve([Question(self._target(self.m, caps), self.pool, current)])[0]
            current = current if outcome.best is None else outcome.best
        ties = self._ties(current)
        current = min(ties, key=lambda c: tuple(np.round(c.phi[self.m :], 9)), default=current)
        current = self._settle_variables(current, caps)
        others = [c.combination for c in ties if c.combination != current.combination]
        return current, tuple(self._difference(current.combination, other) for other in others)

    def _ties(self, candidate: Candidate) -> list[Candidate]:
        """Return the designs of all combinations that reach the same chosen objectives with the same dimensions."""
        found = []
        phi = candidate.phi[: self.m]
        for first in range(0, self.instance.combinations, ROOT_CHUNK):
            numbers = np.arange(first, min(first + ROOT_CHUNK, self.instance.combinations), dtype=np.int64)
            variables = np.broadcast_to(candidate.variables, (len(numbers), self.form.n))
            points = self.form.feasible_points(variables, numbers)
            found += [c for c in points if np.all(np.abs(c.phi[: self.m] - phi) <= TIE)]
        return found

    def _settle_variables(self, candidate: Candidate, caps: np.ndarray) -> Candidate:
        """Make all objectives, the chosen ones first, then the variables, as small as possible in their order.

        For the chosen ones this only takes what the gap of the search left; parts, counts and makeable
        values stay.
        """
        form, current, caps = self.form, candidate, caps.copy()
        low = np.where(form.gridded, candidate.variables, form.lower)
        high = np.where(form.gridded, candidate.variables, form.upper)
        for j in range(len(form.goals)):
            task = Task(
                weights=np.eye(len(form.goals))[j],
                slopes=np.zeros(len(form.goals)),
                caps=caps,
                goal_scales=form.goal_scales,
                t_weight=0.0,
            )
            solution = form.solve(task, current.combination, current.variables, low, high)
            if solution is not None:
                numbers = np.array([current.combination])
                for better in form.feasible_points(solution.variables[None, :], numbers):
                    if np.all(better.phi <= caps + TIE) and better.phi[j] < current.phi[j] - TIE:
                        current = better
            caps[j] = current.phi[j] + TIE
        return current

    def _difference(self, combination: int, other: int) -> str:
        own, its = self.instance.describe(combination), self.instance.describe(other)
        words = []
        for slot in own[0]:
            if own[0][slot] != its[0][slot]:
                table, row = its[0][slot]
                words.append(f"{slot} {table.designations[row]}")
        words += [f"{n} {its[1][n]:g}" for n in own[1] if own[1][n] != its[1][n]]
        words += [f"{n} {its[2][n]}" for n in own[2] if own[2][n] != its[2][n]]
        return ", ".join(words)

    def _result(
        self,
        frame: Frame,
        designs: Sequence[Design],
        settings: Mapping[str, Any],
        explanation: Mapping[str, Any] | None,
        interrupted: str,
    ) -> ParetoFront:
        total, selection = self.instance.combinations, self.instance.selection
        solved = len(self.form.solved_combinations)
        kind = "global" if self.closed else "exhaustive" if self.exhausted and not interrupted else "heuristic"
        gap = self.gap if kind == "global" and designs else None
        uncovered = total - self.rooted
        certificate = Certificate(kind, gap, total, total - solved - uncovered, solved, self.unresolved)
        statistics = {
            "combinations": total,
            "excluded_by_bound": total - solved - uncovered,
            "solved": solved,
            "not_reached": uncovered,
            "alive_after_first_bound": len(self.pool),
            "boxes": self.form.contracted,
            "scalar_problems": self.scalar_problems,
            "nlp_solves": self.form.nlp_solves,
            "rows_offered": {s.slot: selection.offered[s.slot] for s in selection.slots},
            "rows_used": {s.slot: len(s.rows) for s in selection.slots},
            "counts": {n: len(v) for n, v in selection.counts.items()},
            "choices": {n: len(v) for n, v in selection.choices.items()},
            "rows_left_out": selection.left_out,
            "not_asked": list(self.instance.not_asked),
            "seconds": {**self.stage_seconds, "total": time.monotonic() - self.started},
        }
        status = Status.OPTIMAL if designs and kind == "global" else Status.FEASIBLE if designs else Status.NOT_SOLVED
        if not designs and not interrupted:
            status = Status.INFEASIBLE
        return ParetoFront(
            frame=frame,
            designs=list(designs),
            status=status,
            complete=self.complete and not interrupted,
            statistics=statistics,
            certificate=certificate,
            explanation=explanation,
            settings=settings,
            interrupted=interrupted,
        )
