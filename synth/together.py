"""Several questions at once: alike but for the numbers of some requirements, each for its best design in one objective.

Which question a design answers is one more thing to choose among, as a slot is: a box may speak of many questions, is
tightened once for all of them, and is split between them only where that matters. A box is of no use any more when
none of its questions could have a better design in it. What is proven of each question is what a search of its
own would prove.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from synth.analysis import found_designs, make_frame, offered, with_ties
from synth.batch_nlp import MISSED, Tasks
from synth.clock import Clock
from synth.cover import cover
from synth.elasticity import elasticities
from synth.feasibility import Status
from synth.formulation import TIE, Archive, Boxes, Candidate, Formulation, rows_of
from synth.instance import Instance
from synth.native_tree import CapTables
from synth.pareto import rank
from synth.purposes import reaches_beyond
from synth.recall import combination_like
from synth.results import Certificate, Design, Frame, ParetoFront
from synth.search import SMALLEST_SIZE, Question
from synth.seeker import Seeker
from synth.settle import settle_ties

LARGEST = 2**61  # combinations of all questions, whose numbers must fit 64 bits
# Boxes per question; what needs more is easier alone. By turns: with plain boxes; in conflict; and there, where no
# design is known, as there may be none to be found.
TURNS = ((5_000, 5_000, 5_000), (5_000, 20_000, 10_000), (5_000, 250_000, 20_000))
NEARLY_CLOSED = 0.1  # of the effort: if fewer boxes are open, as much again is worth it
EFFORT = 20_000  # with given parts
MOST_EFFORT = 12_000_000  # boxes of all questions: a quarter of them may have to be kept at a time
FIRST_EFFORTS = (1_000, 20_000)  # boxes until a first design is known
TIE_EFFORT = 200  # boxes per question
SETTLING_EFFORT = 100  # boxes per combination that may hold a better design than is made of it
ROUNDS = 6
ANYWHERE = 512  # combinations at random
MOST_KNOWN = 32  # combinations that are tried for every question
PLACES, FAR_PLACES = 8, 4  # among the questions, at which one part is exchanged, or two at a time
MOST_SOLVED = 16_384  # continuous problems of a round
ROUNDED_OFF = 10  # of them, per question


class Together(Instance):
    """Several questions as one: the first digit of a combination tells which.

    Parameters
    ----------
    each : list of Instance
        That are alike, as :func:`alike` tells.
    moving : collection of str, optional
        Requirements that may differ although they do not here, so that code is compiled once for several searches.
    caps : mapping, optional
        Number of an objective -> the most that it may be in each question, as a value with its sign: it tells
        questions apart.
    """

    def __init__(
        self, each: Sequence[Instance], moving: Collection[str] = (), caps: Mapping[int, np.ndarray] | None = None
    ) -> None:
        self.__dict__.update(each[0].__dict__)
        self.each, self._caps = list(each), dict(caps or {})
        self.size = each[0].combinations
        names = {*moving, *different(each)}
        self.moving = {n: np.array([i.requirements[n] for i in each]) for n in self.requirements if n in names}
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

    def caps(self, f: int) -> dict[int, np.ndarray]:
        """Return what each question allows objectives to be, by the number of the objective."""
        return self._caps if f == 0 else {}

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


def different(each: Sequence[Instance]) -> list[str]:
    """Return the requirements that are not the same in all of some questions."""
    # Options may leave out requirements.
    names = dict.fromkeys(n for i in each for n in i.requirements)
    return [n for n in names if len({i.requirements[n] for i in each if n in i.requirements}) > 1]


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

    proves = False

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

    def tables(self, form: Formulation) -> CapTables | None:
        """Return the caps by the cluster of questions that a box speaks of."""
        if reaches_beyond(self, form.bounded) or np.any(np.isfinite(self._plain[:, form.bounded :])):
            return None
        caps = self._plain[:, : form.bounded] + TIE
        clusters = np.arange(len(caps))[:, None]
        caps[:, self.columns[0]] = np.minimum(caps[:, self.columns[0]], self._cap(clusters))
        return CapTables(self.columns, np.full(form.bounded, np.inf), of_cluster=form.values_of(caps))

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


class Wider:
    """What holds for many questions, found once for all searches of some of them.

    Parameters
    ----------
    questions : list of Question
        Alike.
    moving : collection of str
        As for :class:`Together`.
    first : str, optional
        Of several chosen objectives that which comes first; the others settle ties.
    """

    def __init__(self, questions: Sequence[Question], moving: Collection[str], first: str | None = None) -> None:
        self.moving = moving
        self._together = Together([q.instance for q in questions], moving)
        chosen = dict(questions[0].chosen)
        in_order = {first: chosen[first], **chosen} if first is not None else chosen
        self.goals = with_ties(self._together.model, in_order)
        self._forms: dict[bool, Formulation] = {}

    def among(self, together: Together, conflict: bool) -> Formulation | None:
        """Return questions prepared for a search; None where their numbers are not among those of these."""
        if conflict not in self._forms:
            self._forms[conflict] = Formulation(self._together, self.goals, 1, conflict)
        return self._forms[conflict].among(together)


class _Attempt:
    """One way of bounding what questions may have, which goes on where it stopped."""

    def __init__(self, search: TogetherSearch, form: Formulation, known: BestOfEach, boxes: Boxes) -> None:
        self.search, self.form, self.known, self.left = search, form, known, boxes

    def open_questions(self, asked: np.ndarray, effort: float) -> np.ndarray:
        """Go on with so much effort; tell of which of the questions asked it is not proven what is best."""
        search, form = self.search, self.form
        if not asked.any():
            return asked
        if self.known is not search.known:
            # Designs of other questions would only seem to say that those of these are found.
            rows = asked[search.known.questions()]
            self.known.add(search.known.combination[rows], search.known.variables[rows], search.known.phi[rows])
        before = form.contracted, form.nlp_solves
        purpose = Each(form, self.known, search._slack(search.sought), asked)
        for _ in range(2):
            self.left = cover(form, self.left, purpose, search.clock, search.rng, min(effort, MOST_EFFORT)).open
            if not 0 < len(self.left) < NEARLY_CLOSED * effort:
                break
        if self.known is not search.known:
            search.known.add(self.known.combination, self.known.variables, self.known.phi)
            search.form.contracted += form.contracted - before[0]
            search.form.nlp_solves += form.nlp_solves - before[1]
        return purpose.open_questions(self.left)


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
    ideas : list of Design
        Designs of similar questions, where to look first. They prove nothing.
    wider : Wider, optional
        Of questions that these are among.
    sought : int
        Number of the objective that is sought.
    caps : mapping, optional
        As for :class:`Together`.
    """

    def __init__(
        self,
        questions: Sequence[Question],
        workers: int = 1,
        progress: Callable[[Mapping[str, Any]], None] | None = None,
        time_limit: float | None = None,
        ideas: Sequence[Design] = (),
        wider: Wider | None = None,
        sought: int = 0,
        caps: Mapping[int, np.ndarray] | None = None,
    ) -> None:
        self.started = time.monotonic()
        self.questions, self.progress = list(questions), progress
        first = questions[0]
        self.wider, self.workers, self.sought = wider, workers, sought
        self.together = Together([q.instance for q in questions], () if wider is None else wider.moving, caps)
        self.gap = float(first.settings["gap"])
        self.goals = with_ties(first.instance.model, dict(first.chosen)) if wider is None else wider.goals
        self.form = self._prepared()
        self.plain = np.full((len(self.questions), len(self.form.goals)), np.inf)
        for k, values in (caps or {}).items():
            self.plain[:, k] = self.form.phi_of(np.tile(values[:, None], k + 1))[:, k]
        self.known = self._none_known()
        self.form.archive = self.known
        self.clock = Clock(math.inf if time_limit is None else self.started + time_limit, self._working)
        self.rng = np.random.default_rng(first.settings["seed"])
        self.pool = self.form.nothing()
        # What is capped is as narrow as what boxes cannot settle soon: good designs are worth a longer look.
        self.thorough = bool(caps)
        # Where to look first: the variables of known designs, by the combination that each has in any question.
        self.starts = self._starts(ideas)

    def answers(self) -> list[ParetoFront | None]:
        """Return the front of each question; None where it is not proven or has no design: better asked alone."""
        chosen = self.optima(self.told_apart())
        return self.fronts(chosen, 1, self.form.nlp_solves)

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
        self.pool, self.thorough = self.form.root(), False
        if len(self.pool):
            purpose = Each(self.form, self.known, self._slack(self.sought), self.told_apart())
            self._recalled(purpose)
            self._improve(purpose)
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
        designs = self._designs([(c, ()) for c in self.known], 0)
        return [(designs.get(q, [None])[0], bool(proven[q])) for q in wanted]

    def _search(self, asked: np.ndarray, excluded: bool) -> np.ndarray:
        """Find the best design of each question asked; tell of which it is proven.

        ``excluded``: also where no question has a design that is easily found; then it is proven that there is none.
        """
        self.pool = self.form.root()
        if not len(self.pool) or not asked.any():
            return asked
        self._first(Each(self.form, self.known, self._slack(self.sought), asked))
        found, unproven = np.isfinite(self.known.best()), asked.copy()
        if not found.any() and not excluded:
            return np.zeros_like(asked)
        plain = _Attempt(self, self.form, self.known, self.pool)
        conflict: _Attempt | None = None
        # What one way of bounding can hardly tell the other often can: each has its turn before one goes on for long.
        for plainly, surely, doubtfully in TURNS:
            now = unproven & found
            unproven &= ~found | plain.open_questions(now, plainly * int(now.sum()))
            if not unproven.any():
                break
            self.thorough = True
            self._improve(Each(self.form, self.known, self._slack(self.sought), unproven))
            conflict = self._in_conflict() if conflict is None else conflict
            sure = int((unproven & np.isfinite(self.known.best())).sum())
            effort = surely * sure + doubtfully * (int(unproven.sum()) - sure)
            unproven &= conflict.open_questions(unproven, effort)
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
        form, together = self.form, self.together
        form.archive = known = self._none_known()
        like = [(q, combination_like(together.each[q], design), design) for q, design in wanted]
        result: dict[int, tuple[Design | None, bool]] = {q: (None, True) for q, c, _ in like if c is None}
        rows = [(q, q * together.size + c, design) for q, c, design in like if c is not None]
        asked = np.zeros(len(self.questions), dtype=bool)
        asked[[q for q, _, _ in rows]] = True
        asked &= self.told_apart()
        purpose = Each(form, known, self._slack(self.sought), asked)
        combinations = np.array([c for _, c, _ in rows], dtype=np.int64)
        self._tried(purpose, combinations, self._points([design for _, _, design in rows]))
        outcome = cover(form, form.leaves(combinations), purpose, self.clock, self.rng, EFFORT * len(rows))
        left = purpose.open_questions(outcome.open)
        designs = self._designs([(c, ()) for c in known], 0)
        for q, _, _ in rows:
            result[q] = designs.get(q, [None])[0], bool(asked[q] and not left[q])
        form.archive = self.known
        return result

    def _in_conflict(self) -> _Attempt:
        """Return what tries with boxes that carry what limits share, which helps where limits leave little."""
        form = self._prepared(conflict=True)
        form.work = self.form.work
        form.solved_combinations = self.form.solved_combinations
        form.propagation.taught_by(self.form.propagation.lessons())
        form.archive = known = self._none_known()
        return _Attempt(self, form, known, form.root())

    def _none_known(self) -> BestOfEach:
        return BestOfEach(self.together, self.sought, self.form.n, len(self.form.goals), self.plain)

    def _prepared(self, conflict: bool = False) -> Formulation:
        form = None if self.wider is None else self.wider.among(self.together, conflict)
        if form is None:
            form = Formulation(self.together, self.goals, 1, conflict)
        form.workers = self.workers
        return form

    def told_apart(self) -> np.ndarray:
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
                "stage": "search",
                "done": 0.0,
                "combinations": self.together.size,
                "incumbents": len(self.known),
                "message": f"{open_boxes} boxes open",
            })  # fmt: skip

    # -- first designs -------------------------------------------------------------------------

    def _first(self, purpose: Each) -> None:
        """Look for good designs of every question: beside the best of each, and with what is good in any other."""
        self._recalled(purpose)
        if not len(purpose.known):
            self._anywhere(purpose)
        for effort in FIRST_EFFORTS:
            if not len(purpose.known):
                cover(self.form, self.pool, purpose, self.clock, self.rng, effort)
        self._improve(purpose)
        if self.thorough and self._further_away(purpose):
            self._improve(purpose)

    def _recalled(self, purpose: Each) -> None:
        """Try the designs to begin with in every question."""
        combinations, points = np.array(list(self.starts), dtype=np.int64), np.array(list(self.starts.values()))
        questions = np.repeat(np.flatnonzero(purpose.asked), len(combinations))
        own = np.tile(np.arange(len(combinations)), len(questions) // max(len(combinations), 1))
        if len(combinations):
            self._tried(purpose, questions * self.together.size + combinations[own], points[own])

    def _anywhere(self, purpose: Each) -> None:
        """Try combinations at random, some of each question: where designs are many, one is found soon."""
        questions = np.flatnonzero(purpose.asked)
        every = questions[np.arange(ANYWHERE) % len(questions)] * self.together.size
        every = np.unique(every + self.rng.integers(self.together.size, size=ANYWHERE))
        self._tried(purpose, every, self.form.inside(self.form.leaves(every), 0.5))

    def _starts(self, designs: Sequence[Design]) -> dict[int, np.ndarray]:
        """Return where to look first, from designs of similar questions."""
        first = self.together.each[0]
        like = [combination_like(first, d) for d in designs]
        return {c: x for c, x in zip(like, self._points(designs), strict=True) if c is not None}

    def _points(self, designs: Sequence[Design]) -> np.ndarray:
        """Return the variables of designs, moved into their ranges."""
        names = [v.name for v in self.form.model.variables]
        points = np.array([[d.values[n] for n in names] for d in designs]).reshape(len(designs), self.form.n)
        inside: np.ndarray = np.clip(points, self.form.lower, self.form.upper)
        return inside

    def _improve(self, purpose: Each) -> None:
        """Look for better designs beside the best of each question, and with what is good in any other, in rounds."""
        elsewhere, made, expanded = set[bytes](), set[bytes](), set[tuple[int, int]]()
        for _ in range(ROUNDS if len(purpose.known) else 0):
            found = self._everywhere(purpose, elsewhere)
            found += self._everywhere(purpose, made, True) if self.thorough and self.form.gridded.any() else 0
            found += self._beside(purpose, expanded) if self.form.n else 0
            if not found:
                return

    def _everywhere(self, purpose: Each, tried: set[bytes], as_made: bool = False) -> int:
        """Try known combinations in every question; return how many designs are of use.

        ``tried`` are those of earlier rounds. ``as_made``: with the makeable values that they have.
        """
        questions, size, known = np.flatnonzero(purpose.asked), self.together.size, purpose.known
        own = known.combination % size
        made = np.where(self.form.gridded & as_made, known.variables, 0.0)
        marks = [bytes(np.append(made[k], float(own[k]))) for k in range(len(known))]
        first = {mark: k for k, mark in reversed(list(enumerate(marks))) if mark not in tried}
        place = np.array(sorted(first.values())[:MOST_KNOWN], dtype=np.int64)
        tried.update(marks[k] for k in place)
        rows = np.tile(place, len(questions))
        every = np.repeat(questions, len(place)) * size + own[rows]
        return self._tried(purpose, every, known.variables[rows], as_made)

    def _beside(self, purpose: Each, expanded: set[tuple[int, int]]) -> int:
        """Exchange one part at a time of the best design of each question; return how many designs are of use."""
        # Parts that are best in many questions have the same neighbours in all of them: some places are enough.
        questions, size = purpose.known.questions() * PLACES // len(self.questions), self.together.size
        own = {(int(q), c.combination % size): c for q, c in zip(questions, purpose.known, strict=True)}
        parents = [c for place, c in own.items() if place not in expanded]
        expanded.update(own)
        if not parents:
            return 0
        made = [self.together.neighbours(c.combination) for c in parents]
        rows = np.repeat(np.arange(len(made)), [len(x) for x in made])
        every, start = np.concatenate(made), np.array([c.variables for c in parents])[rows]
        if len(every) > MOST_SOLVED:
            chosen = np.sort(self.rng.choice(len(every), MOST_SOLVED, replace=False))
            every, start = every[chosen], start[chosen]
        return self._tried(purpose, every, start)

    def _further_away(self, purpose: Each) -> int:
        """Exchange two parts at a time of the best design of a few questions; return how many designs are of use."""
        known, every, start = purpose.known, [np.empty(0, dtype=np.int64)], [np.empty((0, self.form.n))]
        for k in np.unique(np.linspace(0, len(known) - 1, FAR_PLACES).round().astype(int)) if len(known) else ():
            beside = self.together.neighbours(known.combination[k])
            away = np.unique(self.together.neighbours(beside))
            every.append(self.rng.choice(away, min(len(away), MOST_SOLVED // FAR_PLACES), replace=False))
            start.append(np.tile(known.variables[k], (len(every[-1]), 1)))
        return self._tried(purpose, np.concatenate(every), np.concatenate(start))

    def _tried(self, purpose: Each, combinations: np.ndarray, start: np.ndarray, as_made: bool = False) -> int:
        """Solve continuous problems and round off the best of each question; return how many designs are of use.

        ``as_made``: makeable values stay what they are to begin with.
        """
        form, size, k, known = purpose.form, self.together.size, purpose.columns[0], purpose.known
        seeker = Seeker(form, purpose, self.rng, False)
        keep = form.not_refused(combinations)
        combinations, start = combinations[keep], start[keep]
        self.clock.check()
        held = form.gridded & as_made
        low, high = np.where(held, start, form.lower), np.where(held, start, form.upper)
        if not form.n or not len(combinations):
            return seeker.offer(start, combinations)
        weights = np.zeros((len(combinations), len(form.goals)))
        weights[:, k] = 1.0
        caps = known.plain[combinations // size]
        tasks = Tasks(weights, np.zeros_like(weights), caps, form.goal_scales, 0.0)
        found = form.solve_many(tasks, combinations, start, low, high)
        form.learn(tasks, found, np.ones(len(combinations)))
        better = found.phi[:, k] < purpose.needed()[combinations // size]
        good = np.flatnonzero((found.violation <= MISSED) & better)
        order = good[np.lexsort((found.phi[good, k], combinations[good] // size))]
        question = combinations[order] // size
        best = order[np.arange(len(order)) - np.searchsorted(question, question) < ROUNDED_OFF]
        if not len(best):
            return 0
        if form.gridded.any() and not as_made:
            new = seeker.round_off(form.leaves(combinations[best]), found.variables[best], tasks.take(best))
        else:
            new = seeker.offer(found.variables[best], combinations[best])
        seeker.settle_best(k, range(k + 1))
        if self.thorough and not as_made:
            # What a combination leaves of the grid may lie far from where it is best without one.
            left = best[found.phi[best, k] < purpose.needed()[combinations[best] // size]]
            if len(left):
                cover(form, form.leaves(combinations[left]), purpose, self.clock, self.rng, SETTLING_EFFORT * len(left))
                seeker.settle_best(k, range(k + 1))
        return new

    # -- the report ----------------------------------------------------------------------------

    def fronts(self, chosen: Sequence[Candidate], traded: int, solves: int) -> list[ParetoFront | None]:
        """Return the front of each question that has designs, ties settled.

        Parameters
        ----------
        chosen : list of Candidate
            Proven designs, those of a question together.
        traded : int
            How many objectives, from the first, are traded off.
        solves : int
            Continuous problems that were solved to find them.
        """
        form, together = self.form, self.together
        fronts: list[ParetoFront | None] = [None] * len(together.each)
        found = settle_ties(form, self.pool, chosen, traded) if chosen else []
        every = np.array(sorted(form.solved_combinations), dtype=np.int64)
        solved = np.bincount(together.question(every), minlength=len(together.each))
        for number, designs in self._designs(found, traded).items():
            question = self.questions[number]
            total, own = question.instance.combinations, int(solved[number])
            statistics = {
                **offered(question.instance),
                "excluded_by_bound": total - own,
                "solved": own,
                "searched_together": len(self.questions),
                "boxes": form.contracted,
                "nlp_solves": form.nlp_solves,
                "nlp_solves_to_find": solves,
                "seconds": {"total": time.monotonic() - self.started},
            }
            fronts[number] = ParetoFront(
                frame=designs[0].frame,
                designs=designs,
                status=Status.OPTIMAL,
                complete=traded == 1,
                statistics=statistics,
                certificate=Certificate("global", self.gap, total, total - own, own, 0),
                explanation=None,
                settings=question.settings,
                interrupted="",
                question=question.instance,
            )
        return fronts

    def _designs(self, found: Sequence[tuple[Candidate, tuple[str, ...]]], traded: int) -> dict[int, list[Design]]:
        """Return the designs of each question in order of rank, from candidates with what ties with each.

        ``traded``: how many objectives are traded off and have elasticities; none where designs are not reported.
        """
        form, together = self.form, self.together
        if not found:
            return {}
        candidates = [c for c, _ in found]
        costs = self._prices(candidates, traded) if traded else [{}] * len(candidates)
        combinations, points, _ = rows_of(candidates)
        result = form.evaluate(points.reshape(len(candidates), form.n), combinations)
        numbers = together.question(combinations).tolist()
        frames: list[Frame] = []
        more: list[dict[str, Any]] = []
        for number, group in groupby(range(len(numbers)), key=numbers.__getitem__):
            own, question = list(group), self.questions[number]
            values = np.stack([result.values[name][own] for name in question.chosen], axis=1)
            ranking = rank(question.chosen, values, list(question.weights.values()))
            places = np.argsort(ranking.order)
            frames += [make_frame(question.instance, question.chosen)] * len(own)
            more += [
                {
                    "status": Status.OPTIMAL, "gap": self.gap, "rank": int(places[k]) + 1,
                    "score": float(ranking.scores[k]), "note": ranking.notes[k],
                    "alternatives": found[j][1], "elasticity": costs[j],
                }
                for k, j in enumerate(own)
            ]  # fmt: skip
        designs: dict[int, list[Design]] = {}
        for number, design in zip(numbers, found_designs(form, frames, candidates, result, more), strict=True):
            designs.setdefault(number, []).append(design)
        return {number: sorted(own, key=lambda d: d.rank or 0) for number, own in designs.items()}

    def _prices(self, designs: Sequence[Candidate], traded: int) -> list[dict[str, dict[str, float]]]:
        """Return the elasticities of each design, as its question alone would tell them."""
        if self.form.log_goals[:traded].all():
            return elasticities(self.form, designs, traded)
        # The objective may be positive in some questions although it is not in all.
        result = []
        for c in designs:
            question, own = divmod(c.combination, self.together.size)
            form, number = Formulation(self.together.each[question], self.goals, 1), np.array([own])
            _, phi = form.feasible_rows(c.variables[None, :], number)
            result += elasticities(form, [Candidate(own, c.variables, phi[0])], traded)
        return result

    def _second(self, chosen: Sequence[Candidate]) -> list[Candidate]:
        """Return designs that are as good in the objective and better in the next one, over all parts."""
        form, sought = self.form, self.sought
        if len(form.goals) < 2 or not chosen:
            return list(chosen)
        following = 1 if sought == 0 else 0
        questions = self.together.question(np.array([c.combination for c in chosen]))
        plain = self.plain.copy()
        plain[questions, sought] = np.array([c.phi[sought] for c in chosen]) + TIE
        known = BestOfEach(self.together, following, form.n, len(form.goals), plain)
        asked = np.zeros(len(self.questions), dtype=bool)
        asked[questions] = True
        known.add(*rows_of(chosen))
        purpose = Each(form, known, self._slack(following), asked)
        self._improve(purpose)
        cover(form, self.pool, purpose, self.clock, self.rng, TIE_EFFORT * len(chosen))
        better = dict(zip(known.questions().tolist(), known, strict=True))
        return [better.get(int(q), c) for q, c in zip(questions, chosen, strict=True)]


def groups_of(questions: Sequence[Question], least: int = 2, objectives: int = 1) -> list[list[int]]:
    """Return the positions of questions that can be answered together: so many or more, alike.

    ``objectives``: how many each must have.
    """
    groups: dict[Any, list[int]] = {}
    for k, question in enumerate(questions):
        if len(question.chosen) == objectives:
            groups.setdefault(alike(question), []).append(k)
    return [g for g in groups.values() if least <= len(g) <= LARGEST // questions[g[0]].instance.combinations]
