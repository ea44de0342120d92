"""Several questions at once: alike but for the numbers of some requirements, each for its best design in one objective.

Which question a design answers is one more thing to choose among, as a slot is: a box may speak of many questions, is
tightened once for all of them, and is split between them only where that matters. A box is of no use any more when
none of its questions could have a better design in it. What is proven of each question is what a search of its
own would prove.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from synth.analysis import found_designs, make_frame, offered, with_ties
from synth.batch_nlp import MISSED, Tasks
from synth.clock import Clock
from synth.cover import cover
from synth.elasticity import elasticities
from synth.feasibility import Status
from synth.formulation import TIE, Archive, Boxes, Candidate, Formulation
from synth.instance import Instance
from synth.pareto import rank
from synth.results import Certificate, ParetoFront
from synth.search import Question
from synth.seeker import Seeker
from synth.settle import settle_ties, settle_variables

LARGEST = 2**61  # combinations of all questions, whose numbers must fit 64 bits
EFFORT = 150_000  # boxes per question; what needs more is easier alone
FIRST_EFFORTS = (1_000, 20_000)  # boxes until a first design is known
TIE_EFFORT = 500
ROUNDS = 6
MOST_KNOWN = 32  # combinations that are tried for every question
ROUNDED_OFF = 2  # of them, per question
SMALLEST_SIZE = 1e-6  # of an objective that may be zero, in units of its usual size


class Together(Instance):
    """Several questions as one: the first digit of a combination tells which.

    Parameters
    ----------
    each : list of Instance
        That are alike, as :func:`alike` tells.
    """

    def __init__(self, each: Sequence[Instance]) -> None:
        self.__dict__.update(each[0].__dict__)
        self.each = list(each)
        self.size = each[0].combinations
        names = [n for n, v in self.requirements.items() if any(i.requirements[n] != v for i in each)]
        self.moving = {n: np.array([i.requirements[n] for i in each]) for n in names}
        self.apart = 1
        self.radix = [len(each), *each[0].radix]
        self.combinations = len(each) * self.size

    def factors(self) -> list[str]:
        """Return the names of the factors; the first one, the question, has no name of the model."""
        return ["", *super().factors()]

    def owners(self) -> tuple[int, ...]:
        """Return, per data input of the model, the number of the factor it belongs to."""
        inputs = zip(super().owners(), self.model.data_inputs, strict=True)
        return tuple(0 if self._moves(entry) else own for own, entry in inputs)

    def of(self, combination: int) -> Instance:
        """Return the question that a combination belongs to."""
        return self.each[combination // self.size]

    def question(self, combinations: np.ndarray) -> np.ndarray:
        """Return the numbers of the questions that combinations belong to."""
        return np.asarray(combinations, dtype=np.int64) // self.size

    def data(self, combinations: np.ndarray) -> list[Any]:
        """Return the data inputs of the model for combinations given by number."""
        question, own = np.divmod(np.asarray(combinations, dtype=np.int64), self.size)
        data = self.each[0].data(own)
        for k, entry in enumerate(self.model.data_inputs):
            if self._moves(entry):
                data[k] = self.moving[entry.name][question]
        return data

    def column(self, position: int) -> np.ndarray:
        """Return data input number ``position`` for every alternative of the factor it belongs to."""
        entry = self.model.data_inputs[position]
        return self.moving[entry.name] if self._moves(entry) else super().column(position)

    def neighbours(self, combination: int | np.ndarray) -> np.ndarray:
        """Return the combinations of the same question that differ in one part, count or choice."""
        question, own = np.divmod(np.asarray(combination, dtype=np.int64), self.size)
        beside: np.ndarray = question[..., None] * self.size + self.each[0].neighbours(own)
        return beside

    def describe(self, combination: int) -> tuple[Any, dict[str, float], dict[str, str]]:
        """Return parts, counts and choices of one combination."""
        question, own = divmod(combination, self.size)
        return self.each[question].describe(own)

    def _moves(self, entry: Any) -> bool:
        return entry.kind == "requirement" and entry.name in self.moving


def alike(question: Question) -> tuple[Any, ...]:
    """Return what questions must have in common to be answered together."""
    instance, settings = question.instance, question.settings
    selection = instance.selection
    return (
        instance.model,
        instance.grid,
        instance.lower.tobytes(),
        instance.upper.tobytes(),
        instance.pinned.tobytes(),
        tuple(instance.extra),
        tuple((s.slot, tuple(s.table.hashes[int(r)] for r in s.rows)) for s in selection.slots),
        tuple((n, v.tobytes()) for n, v in (*selection.counts.items(), *selection.choices.items())),
        tuple(question.chosen.items()),
        settings["gap"],
        settings["seed"],
    )


class BestOfEach(Archive):
    """The best feasible design of each question in one objective.

    Parameters
    ----------
    together : Together
    column : int
        Number of the objective.
    variables, objectives : int
        Width of the stored rows.
    plain : array (questions, objectives), optional
        Caps of phi that a design must keep.
    """

    def __init__(
        self, together: Together, column: int, variables: int, objectives: int, plain: np.ndarray | None = None
    ) -> None:
        super().__init__([column], variables, objectives)
        self.together, self.column = together, column
        self.plain = np.full((len(together.each), objectives), np.inf) if plain is None else plain

    def add(self, combination: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> None:
        """Take new designs and keep the best of each question; of equal ones that which was known first."""
        keep = np.all(phi <= self.plain[self.together.question(combination)] + TIE, axis=1)
        if combination is self.combination or not keep.any():
            return
        combination = np.concatenate([self.combination, combination[keep]])
        variables = np.concatenate([self.variables, variables[keep]])
        phi = np.concatenate([self.phi, phi[keep]])
        question = self.together.question(combination)
        order = np.lexsort((phi[:, self.column], question))
        _, first = np.unique(question[order], return_index=True)
        best = order[first]
        self.combination, self.variables, self.phi = combination[best], variables[best], phi[best]

    def questions(self) -> np.ndarray:
        """Return the questions of the designs."""
        return self.together.question(self.combination)

    def best(self) -> np.ndarray:
        """Return phi of the best design of each question, infinite where none is known."""
        result = np.full(len(self.together.each), np.inf)
        result[self.questions()] = self.phi[:, self.column]
        return result


class Each:
    """Find the best design of each question in one objective.

    Parameters
    ----------
    form : Formulation
        Of questions together.
    known : BestOfEach
    slack : callable
        Takes phi of the best designs; returns how much better a design must be to be of use.
    asked : array of bool (questions,)
        Questions that are not asked need no proof.
    """

    def __init__(
        self, form: Formulation, known: BestOfEach, slack: Callable[[np.ndarray], np.ndarray], asked: np.ndarray
    ) -> None:
        self.form, self.known, self._slack, self.asked = form, known, slack, asked
        self.columns = [known.column]
        self.slack = slack(np.zeros(1))
        self.plain = np.full(len(form.goals), np.inf)
        self._tree = form.cells.trees[0]
        self._plain = self._tree.hull(known.plain)[1]
        self._ends: tuple[np.ndarray, np.ndarray] | None = None
        self._polished = np.full(len(asked), np.inf)

    def needed(self) -> np.ndarray:
        """Return, per question, what a design must be better than in phi."""
        best = self.known.best()
        needed: np.ndarray = np.where(self.asked, best - np.where(np.isfinite(best), self._slack(best), 0.0), -np.inf)
        return needed

    def _cap(self, cell: np.ndarray) -> np.ndarray:
        """Return, per box, what a design must be better than in one of its questions."""
        if self._ends is None or self._ends[0] is not self.known.phi:
            self._ends = self.known.phi, self._tree.hull(self.needed()[:, None])[1][:, 0]
        cap: np.ndarray = self._ends[1][cell[:, 0]]
        return cap

    def caps(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return, per box with these lower bounds of phi, what a design must keep to be of use."""
        assert cell is not None
        caps: np.ndarray = self._plain[cell[:, 0], : lower.shape[1]] + TIE
        k = self.columns[0]
        caps[:, k] = np.minimum(caps[:, k], self._cap(cell))
        return caps

    def room(self, lower: np.ndarray, cell: np.ndarray | None = None) -> np.ndarray:
        """Return how much better than needed a box could be."""
        assert cell is not None
        cap = self._cap(cell)
        with np.errstate(all="ignore"):
            distance = cap - lower[:, self.columns[0]]
        broken = np.any(lower > self._plain[cell[:, 0], : lower.shape[1]] + TIE, axis=1) | (cap == -np.inf)
        room: np.ndarray = np.where(broken, 0.0, np.where(np.isnan(distance), np.inf, distance))
        return room

    def take(self, combinations: np.ndarray, variables: np.ndarray, phi: np.ndarray) -> int:
        """Take feasible designs; return how many were of use."""
        new = int((self.room(phi, self.form.cell_of(combinations)) > 0).sum())
        self.known.add(combinations, variables, phi)
        return new

    def leading(self, archive: Archive) -> list[Candidate]:
        """Return the best designs that are better than when last asked."""
        best = self.known.best()
        better = best < self._polished - TIE
        self._polished = np.minimum(best, self._polished)
        return [c for c, q in zip(self.known, self.known.questions(), strict=True) if better[q]]

    def open_questions(self, left: Boxes) -> np.ndarray:
        """Tell of which questions boxes that were left open may hold something of use."""
        needed, result = self.needed(), np.zeros(len(self.asked), dtype=bool)
        if not len(left):
            return result
        lower, clusters = self.form.phi_of(left.bounds)[:, self.columns[0]], left.cell[:, 0]
        for cluster in np.unique(clusters):
            least = np.nan_to_num(lower[clusters == cluster], nan=-np.inf).min()
            rows = self._tree.rows(int(cluster))
            result[rows] |= needed[rows] > least
        return result


class TogetherSearch:
    """One search for several questions.

    Parameters
    ----------
    questions : list of Question
        Alike, each with one objective.
    workers : int
    progress : callable, optional
    time_limit : float, optional
        Seconds; then ``Stopped`` is raised.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        workers: int = 1,
        progress: Callable[[Mapping[str, Any]], None] | None = None,
        time_limit: float | None = None,
    ) -> None:
        self.started = time.monotonic()
        self.questions, self.progress = list(questions), progress
        first = questions[0]
        self.together = Together([q.instance for q in questions])
        self.gap = float(first.settings["gap"])
        goals = with_ties(first.instance.model, dict(first.chosen))
        # Boxes carry what limits share: little is lost by it, and much where limits decide.
        self.form = Formulation(self.together, goals, 1, conflict=True)
        self.form.workers = workers
        self.known = BestOfEach(self.together, 0, self.form.n, len(self.form.goals))
        self.form.archive = self.known
        self.clock = Clock(math.inf if time_limit is None else self.started + time_limit, self._working)
        self.rng = np.random.default_rng(first.settings["seed"])
        self.pool = self.form.nothing()

    def answers(self, reported: bool = True) -> list[ParetoFront | None]:
        """Return the front of each question; None where it is not proven, or has no design: it is better asked alone.

        ``reported``: with ties settled, equal designs named, and elasticities.
        """
        nothing: list[ParetoFront | None] = [None] * len(self.questions)
        self.pool = self.form.root()
        asked = self._told_apart()
        if not len(self.pool) or not asked.any():
            return nothing
        purpose = Each(self.form, self.known, self._slack(0), asked)
        self._first(purpose)
        asked &= np.isfinite(self.known.best())
        if not asked.any():
            return nothing
        purpose = Each(self.form, self.known, self._slack(0), asked)
        outcome = cover(self.form, self.pool, purpose, self.clock, self.rng, EFFORT * int(asked.sum()))
        asked &= ~purpose.open_questions(outcome.open)
        solves = self.form.nlp_solves
        chosen = [c for c, q in zip(self.known, self.known.questions(), strict=True) if asked[q]]
        if not chosen:
            return nothing
        return self._fronts(chosen, reported, solves)

    def _told_apart(self) -> np.ndarray:
        """Return the questions that boxes can tell apart: of those that are the same in all that counts, one."""
        tree = self.form.cells.trees[0]
        result = np.zeros(len(self.questions), dtype=bool)
        result[tree.first[tree.leaf]] = True
        return result

    def _slack(self, k: int) -> Callable[[np.ndarray], np.ndarray]:
        """Return the gap as a distance in phi of an objective, per design."""
        if self.form.log_goals[k]:
            return lambda phi: np.full(len(phi), -math.log1p(-self.gap))
        return lambda phi: self.gap * np.maximum(np.abs(phi), SMALLEST_SIZE)

    def _working(self, open_boxes: int) -> None:
        if self.progress is not None:
            self.progress({
                "stage": "together",
                "done": 0.0,
                "combinations": self.together.size,
                "incumbents": len(self.known),
                "message": f"{open_boxes} boxes open",
            })  # fmt: skip

    # -- first designs -------------------------------------------------------------------------

    def _first(self, purpose: Each) -> None:
        """Look for a design of every question: what is good in one is tried in all."""
        for effort in FIRST_EFFORTS:
            if not len(self.known):
                cover(self.form, self.pool, purpose, self.clock, self.rng, effort)
        tried = set[int]()
        for _ in range(ROUNDS):
            self.clock.check()
            own = self.known.combination % self.together.size
            fresh = [int(c) for c in dict.fromkeys(own.tolist()) if c not in tried][:MOST_KNOWN]
            if not fresh:
                return
            tried.update(fresh)
            self._everywhere(purpose, fresh)

    def _everywhere(self, purpose: Each, combinations: Sequence[int]) -> None:
        """Solve the continuous problems of combinations in every question; round off the best of each."""
        form, together = self.form, self.together
        if not form.n:
            every = (np.arange(len(together.each))[:, None] * together.size + np.array(combinations)).ravel()
            Seeker(form, purpose, self.rng, False).offer(np.zeros((len(every), 0)), every)
            return
        own = self.known.combination % together.size
        place = [int(np.flatnonzero(own == c)[0]) for c in combinations]
        questions = np.repeat(np.flatnonzero(purpose.asked), len(combinations))
        rows = np.tile(place, len(questions) // len(place))
        every = questions * together.size + own[rows]
        start, keep = self.known.variables[rows], form.not_refused(every)
        every, start = every[keep], start[keep]
        goals = len(form.goals)
        weights = np.zeros((len(every), goals))
        weights[:, 0] = 1.0
        tasks = Tasks(weights, np.zeros_like(weights), np.full((len(every), goals), np.inf), form.goal_scales, 0.0)
        found = form.solve_many(tasks, every, start)
        form.learn(tasks, found, np.ones(len(every)))
        good = np.flatnonzero((found.violation <= MISSED) & np.isfinite(found.phi[:, 0]))
        order = good[np.lexsort((found.phi[good, 0], every[good] // together.size))]
        own_question = every[order] // together.size
        place_in_question = np.arange(len(order)) - np.searchsorted(own_question, own_question)
        best = order[place_in_question < ROUNDED_OFF]
        seeker = Seeker(form, purpose, self.rng, False)
        if form.gridded.any():
            seeker.round_off(form.leaves(every[best]), found.variables[best])
        else:
            seeker.offer(found.variables[best], every[best])
        exact = settle_variables(form, purpose.leading(self.known), 0, [0])
        if exact:
            seeker.offer(np.array([c.variables for c in exact]), np.array([c.combination for c in exact]))

    # -- the report ----------------------------------------------------------------------------

    def _fronts(self, chosen: Sequence[Candidate], reported: bool, solves: int) -> list[ParetoFront | None]:
        form, together = self.form, self.together
        pairs: list[tuple[Candidate, tuple[str, ...]]] = [(c, ()) for c in chosen]
        if reported:
            pairs = settle_ties(form, self.pool, self._second(chosen), 1)
        settled = [c for c, _ in pairs]
        costs = elasticities(form, settled if reported else [], 1) or [{}] * len(settled)
        combinations = np.array([c.combination for c in settled], dtype=np.int64)
        points = np.array([c.variables for c in settled]).reshape(len(settled), form.n)
        result = form.evaluate(points, combinations)
        solved = np.bincount(
            together.question(np.array(sorted(form.solved_combinations), dtype=np.int64)), minlength=len(together.each)
        )
        numbers = together.question(combinations).tolist()
        # A design that stands alone ranks as any other that does.
        first = self.questions[numbers[0]]
        values = np.array([[result.values[name][0] for name in first.chosen]])
        ranking = rank(first.chosen, values, list(first.weights.values()))
        frames, more = [], []
        for number, (_, ties), cost in zip(numbers, pairs, costs, strict=True):
            question = self.questions[number]
            frames.append(make_frame(question.instance, question.chosen))
            more.append({
                "status": Status.OPTIMAL, "gap": self.gap, "rank": 1, "score": float(ranking.scores[0]),
                "note": ranking.notes[0], "alternatives": ties, "elasticity": cost,
            })  # fmt: skip
        designs = found_designs(form, frames, settled, result, more)
        fronts: list[ParetoFront | None] = [None] * len(together.each)
        for number, frame, design in zip(numbers, frames, designs, strict=True):
            question = self.questions[number]
            total = question.instance.combinations
            statistics = {
                **offered(question.instance),
                "excluded_by_bound": int(total - solved[number]),
                "solved": int(solved[number]),
                "searched_together": len(self.questions),
                "boxes": form.contracted,
                "nlp_solves": form.nlp_solves,
                "nlp_solves_to_find": solves,
                "seconds": {"total": time.monotonic() - self.started},
            }
            fronts[number] = ParetoFront(
                frame=frame,
                designs=[design],
                status=Status.OPTIMAL,
                complete=True,
                statistics=statistics,
                certificate=Certificate("global", self.gap, total, int(total - solved[number]), int(solved[number]), 0),
                explanation=None,
                settings=question.settings,
                interrupted="",
                question=question.instance,
            )
        return fronts

    def _second(self, chosen: Sequence[Candidate]) -> list[Candidate]:
        """Return designs that are as good in the objective and better in the next one, over all parts."""
        form = self.form
        if len(form.goals) < 2:
            return list(chosen)
        questions = self.together.question(np.array([c.combination for c in chosen]))
        plain = np.full((len(self.questions), len(form.goals)), np.inf)
        plain[questions, 0] = np.array([c.phi[0] for c in chosen]) + TIE
        known = BestOfEach(self.together, 1, form.n, len(form.goals), plain)
        asked = np.zeros(len(self.questions), dtype=bool)
        asked[questions] = True
        known.add(*_rows(chosen))
        purpose = Each(form, known, self._slack(1), asked)
        cover(form, self.pool, purpose, self.clock, self.rng, TIE_EFFORT * len(chosen))
        better = dict(zip(known.questions().tolist(), known, strict=True))
        return [better.get(int(q), c) for q, c in zip(questions, chosen, strict=True)]


def _rows(candidates: Sequence[Candidate]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return combinations, variables and phi of some designs as arrays."""
    return (
        np.array([c.combination for c in candidates], dtype=np.int64),
        np.array([c.variables for c in candidates]),
        np.array([c.phi for c in candidates]),
    )


def answer_together(
    questions: Sequence[Question],
    workers: int = 1,
    progress: Callable[[Mapping[str, Any]], None] | None = None,
    time_limit: float | None = None,
    reported: bool = True,
) -> list[ParetoFront | None]:
    """Answer those of several questions that can be answered together; None stands for the others.

    Parameters
    ----------
    questions : list of Question
        Those with one objective that are alike are searched together.
    workers, progress, time_limit : optional
        As for ``synth.synthesize``.
    reported : bool
        Whether ties are settled and elasticities told.

    Raises
    ------
    Stopped
        When time is over.
    """
    result: list[ParetoFront | None] = [None] * len(questions)
    groups: dict[Any, list[int]] = {}
    for k, question in enumerate(questions):
        if len(question.chosen) == 1:
            groups.setdefault(alike(question), []).append(k)
    deadline = math.inf if time_limit is None else time.monotonic() + time_limit
    for members in groups.values():
        if len(members) < 2 or len(members) * questions[members[0]].instance.combinations > LARGEST:
            continue
        left = None if math.isinf(deadline) else max(deadline - time.monotonic(), 1e-3)
        search = TogetherSearch([questions[k] for k in members], workers, progress, left)
        for k, front in zip(members, search.answers(reported), strict=True):
            result[k] = front
    return result
