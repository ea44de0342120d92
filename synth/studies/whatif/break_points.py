"""Break points: where, between two steps of a study, the best parts or counts change, or feasibility begins or ends.

Where the best designs of two steps differ, their parts alone tell where the one becomes better than the other. The ends
of that narrow range are then searched over all parts and proven; what a third design spoils is looked for again. Many
intervals are looked into at a time, so that what they ask can be answered together.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any, Protocol

from synth.errors import InputError
from synth.question.settings import Progress
from synth.results import Design, ParetoFront
from synth.search.joint.joint_groups import groups_of, joint_key
from synth.search.joint.joint_optima import SharedBounds
from synth.search.joint.joint_question import different
from synth.search.joint.joint_search import JointSearch
from synth.search.question import Question
from synth.studies.settings import BREAKS, BreakLimits
from synth.studies.whatif.steps import Steps
from synth.studies.whatif.study_answers import Break, Composition, StudyStep, best_design
from synth.studies.whatif.vary import Value
from synth.system.deadline import INTERRUPTED, Stopped
from synth.text.numbers import typed_number

UNPROVEN = "the search on one side did not finish"
NOT_ROBUST = "the design on one side is not shown to keep all limits over the whole range"

Remaining = Callable[[], float | None]


class Kept(Protocol):
    """Where results are kept."""

    def value(self, key: str, fingerprint: str) -> Any:
        """Stored result under a key for a question, or None."""

    def keep(self, key: str, fingerprint: str, value: object) -> None:
        """Keep something for a question."""


def find_breaks(
    steps: Steps,
    along: int,
    answered: Sequence[StudyStep],
    collected: list[Break],
    kept: Kept,
    remaining: Remaining,
    shown: Progress | None,
    limits: BreakLimits = BREAKS,
) -> None:
    """Find the break points of every objective between neighbouring steps.

    Parameters
    ----------
    steps : Steps
    along : int
        The position of the number that is varied.
    answered : list of StudyStep
        All steps, answered.
    collected : list of Break
        Filled as breaks are found, some intervals at a time, so that they stay where time is over.
    kept : Kept
    remaining : callable
        Returns the remaining seconds; raises Stopped.
    shown : callable, optional
        Progress.
    limits : BreakLimits
    """
    pairs = [(a, b) for a, b in neighbours(along, answered) if a.front is not None and b.front is not None]
    for first in range(0, len(pairs), limits.at_once):
        batch = pairs[first : first + limits.at_once]
        remaining()
        if shown is not None:
            stage = f"{steps.text(batch[0][0].values)} to {steps.text(batch[-1][1].values)}"
            shown({"stage": stage, "done": first / len(pairs)})
        known = [kept.value(f"breaks {a.number} {b.number}", f"{a.fingerprint} {b.fingerprint}") for a, b in batch]
        if all(entries is not None for entries in known):
            collected += [_read(entry) for entries in known for entry in entries]
            continue
        batch_breaks = _Oracle(steps, along, remaining, limits).breaks(batch)
        for (a, b), breaks in zip(batch, batch_breaks, strict=True):
            kept.keep(f"breaks {a.number} {b.number}", f"{a.fingerprint} {b.fingerprint}", [asdict(x) for x in breaks])
            collected += breaks


def neighbours(along: int, answered: Sequence[StudyStep]) -> list[tuple[StudyStep, StudyStep]]:
    """Return the steps that are neighbours along a number, the other value being the same."""
    groups: dict[tuple[Value, ...], list[StudyStep]] = {}
    for step in answered:
        groups.setdefault(other_values(step, along), []).append(step)
    result = []
    for group in groups.values():
        group.sort(key=lambda s: float(s.values[along]))  # type: ignore[arg-type]
        result += list(pairwise(group))
    return result


def other_values(step: StudyStep, along: int) -> tuple[Value, ...]:
    """Return the values of a step but for that of the number that is varied."""
    return tuple(v for k, v in enumerate(step.values) if k != along)


def _objectives(*fronts: ParetoFront | None) -> dict[str, str]:
    return {n: sense for front in fronts if front is not None for n, sense in front.frame.objectives.items()}


def _read(entry: Mapping[str, Any]) -> Break:
    """Return a break as it was kept."""
    sides = [None if entry[k] is None else Composition(**entry[k]) for k in ("before", "after")]
    others = tuple(tuple(v) if isinstance(v, list) else v for v in entry["others"])
    return Break(**{**entry, "others": others, "before": sides[0], "after": sides[1]})


@dataclass(frozen=True)
class _Best:
    """The best design at a value as far as a search went; None where nothing is feasible."""

    design: Design | None
    proven: bool


@dataclass(frozen=True)
class _Query:
    """The best design in one objective at some values: over all parts, or with the parts of one design."""

    objective: str
    values: tuple[Value, ...]
    composition: str = ""  # what the one design is made of, in words
    hint: bool = False  # a good design will do, as it only tells where to look


class _Oracle:
    """Answers queries for best designs, for many intervals at a time."""

    def __init__(self, steps: Steps, along: int, remaining: Remaining, limits: BreakLimits) -> None:
        self.limits = limits
        self.steps, self.along, self.remaining = steps, along, remaining
        self.senses: dict[str, str] = {}
        self.known: dict[_Query, _Best] = {}
        self.made: dict[str, Design] = {}  # a design of each composition of a query
        self.places: Iterable[tuple[Value, ...]] = ()  # the values at the steps
        self.ideas: dict[str, dict[str, Design]] = {}  # per objective: designs that are best somewhere
        self.moving = different([q.instance for q in steps.questions])
        self.shared_bounds: dict[Any, SharedBounds] = {}  # by what questions have in common

    def breaks(self, pairs: Sequence[tuple[StudyStep, StudyStep]]) -> list[list[Break]]:
        """Return the breaks between pairs of steps; the intervals go forward together, so that they ask together."""
        by_pair: list[list[Break]] = [[] for _ in pairs]
        self.places = dict.fromkeys(step.values for pair in pairs for step in pair)
        for a, b in pairs:
            self.senses |= _objectives(a.front, b.front)
        under_way = []
        for (a, b), pair_breaks in zip(pairs, by_pair, strict=True):
            for objective in _objectives(a.front, b.front):
                for step in (a, b):
                    design = best_design(step.front, objective)
                    if design is not None:
                        self.ideas.setdefault(objective, {}).setdefault(_words(design), design)
                under_way.append(_Between(self, objective, a, b).search(pair_breaks))
        queries = [next(search, None) for search in under_way]
        while any(w is not None for w in queries):
            self._answer(dict.fromkeys(w for batch in queries for w in batch or ()))
            queries = [None if w is None else next(search, None) for search, w in zip(under_way, queries, strict=True)]
        order = list(self.senses)
        return [sorted(pair_breaks, key=lambda b: order.index(b.objective)) for pair_breaks in by_pair]

    def _answer(self, queries: Iterable[_Query]) -> None:
        """Search what is not known yet; what is alike is searched together."""
        new = [w for w in queries if w not in self.known]
        by_place: dict[tuple[str, tuple[Value, ...]], Question] = {}
        for w in new:
            place = w.objective, w.values
            try:
                by_place[place] = by_place.get(place) or self._question(w)
            except InputError:
                self.known[w] = _Best(None, True)  # refused: the family says that there is no such design
        places = list(by_place)
        for group in groups_of(list(by_place.values()), least=1):
            position = {places[k]: number for number, k in enumerate(group)}
            grouped = [w for w in new if (w.objective, w.values) in position]
            ideas = list(self.ideas.get(grouped[0].objective, {}).values())
            questions = [by_place[places[k]] for k in group]
            search = JointSearch(questions, None, self.remaining(), ideas, self._shared_bounds(questions[0]))
            self._together(search, grouped, [position[w.objective, w.values] for w in grouped])
        for w in new:
            if w not in self.known:
                front = self._searched_singly(w)
                proven = front is None or front.certificate.kind == "global"
                self._take(w, _Best(best_design(front, w.objective), proven))

    def _shared_bounds(self, question: Question) -> SharedBounds:
        """Bounds for all values between the steps, for questions like one."""
        common = joint_key(question)
        if common not in self.shared_bounds:
            ends = [q for q in self._at_steps(next(iter(question.chosen))) if joint_key(q) == common]
            self.shared_bounds[common] = SharedBounds([question, *ends], self.moving)
        return self.shared_bounds[common]

    def _at_steps(self, objective: str) -> Iterator[Question]:
        """Yield the questions for the best design in one objective at the steps."""
        for values in self.places:
            # What the family refuses has no design.
            with suppress(InputError):
                yield self._question(_Query(objective, values))

    def _together(self, search: JointSearch, queries: Sequence[_Query], positions: Sequence[int]) -> None:
        """Take what can be answered together."""
        best = [(w, k) for w, k in zip(queries, positions, strict=True) if not w.composition]
        if best:
            for (w, _), (design, proven) in zip(best, search.best([k for _, k in best]), strict=True):
                if proven:
                    self._take(w, _Best(design, True))
        fixed = [(w, k) for w, k in zip(queries, positions, strict=True) if w.composition]
        for (w, _), (design, proven) in zip(
            fixed, search.best_with([(k, self.made[w.composition]) for w, k in fixed]), strict=True
        ):
            if proven or (w.hint and design is not None):
                self.known[w] = _Best(design, proven)

    def _question(self, w: _Query, fixed: bool = False) -> Question:
        slots, pins = dict[str, list[str]](), dict[str, Any]()
        if fixed and w.composition:
            made = Composition.of(self.made[w.composition], w.objective)
            slots, pins = {slot: [word] for slot, word in made.parts.items()}, {**made.counts, **made.choices}
        return self.steps.one_best(w.values, {w.objective: self.senses[w.objective]}, self.limits.gap, slots, pins)

    def _searched_singly(self, w: _Query) -> ParetoFront | None:
        """Front of a query that has no joint answer; None where the family refuses it."""
        remaining = self.remaining()
        longest = self.limits.seconds
        seconds = longest if remaining is None else min(longest, remaining)
        ideas = list(self.ideas.get(w.objective, {}).values())
        try:
            question = self._question(w, fixed=True)
        except InputError:
            return None
        front = question.within(seconds).answer(None, ideas, explained=False)
        if front.interrupted == INTERRUPTED:
            raise Stopped(front.interrupted)
        if front.interrupted:
            self.remaining()
        return front

    def _take(self, w: _Query, best: _Best) -> None:
        self.known[w] = best
        if best.design is not None and not w.composition:
            self.ideas.setdefault(w.objective, {}).setdefault(_words(best.design), best.design)


Asking = Generator[list[_Query], None, Any]  # a search that yields its queries


class _Between:
    """The breaks of one objective between two steps."""

    def __init__(self, oracle: _Oracle, objective: str, one: StudyStep, two: StudyStep) -> None:
        self.oracle, self.objective, self.one, self.two = oracle, objective, one, two
        self.sign = 1.0 if oracle.senses[objective] == "min" else -1.0
        self.low, self.high = (float(s.values[oracle.along]) for s in (one, two))  # type: ignore[arg-type]

    def search(self, breaks: list[Break]) -> Generator[list[_Query], None, None]:
        """Find the breaks from the lower to the upper step."""
        yield [self._query(self.low), self._query(self.high)]
        place, holder, count = self.low, self._best(self.low).design, 0
        while not (yield from self._holds(holder, self.high)):
            if count == self.oracle.limits.most:
                breaks[-1] = replace(breaks[-1], remark=f"more changes follow up to {typed_number(self.high)}")
                return
            low, high = yield from self._break(holder, place)
            before, after = yield from self._sides(holder, low, high)
            sides = self._best(low), self._best(high)
            empty = [side for side in sides if side.design is None]
            # An end of what is feasible is proven by the side that has no design: the other one has its design to show,
            # which on the edge of the tolerance cannot be proven to be the best to the last digits.
            proven = all(side.proven for side in (empty if len(empty) == 1 else sides))
            remark = "" if proven else UNPROVEN
            if not (self._stands(before, low) and self._stands(after, high)):
                proven, remark = False, NOT_ROBUST
            old, new = (None if d is None else Composition.of(d, self.objective) for d in (before, after))
            others = other_values(self.one, self.oracle.along)
            breaks.append(Break(self.objective, others, low, high, old, new, proven, remark))
            place, holder, count = high, after, count + 1

    def _break(self, holder: Design | None, low: float) -> Asking:
        """Return a narrow range at whose lower end a holder still holds, and at whose upper end it does not.

        The parts of holder and rival locate it first; only its ends are searched over all parts.
        """
        high, rival, guesses = self.high, self._best(self.high).design, 0
        while high - low > self._narrow(low, high):
            if guesses < self.oracle.limits.guesses:
                first, last = yield from self._crossing(holder, rival, low, high)
                guesses += 1
            else:
                first = last = 0.5 * (low + high)
            yield [self._query(first), self._query(last)]
            if first > low and not (yield from self._holds(holder, first)):
                high, rival = first, self._best(first).design
            elif last < high and (yield from self._holds(holder, last)):
                low = last
            else:
                low, high = first, last
        return low, high

    def _narrow(self, low: float, high: float) -> float:
        limits = self.oracle.limits
        return max(limits.width * max(abs(low), abs(high)), limits.finest * (self.high - self.low))

    def _crossing(self, holder: Design | None, rival: Design | None, low: float, high: float) -> Asking:
        """Return a narrow range in which a rival becomes better than the holder, each alone."""
        while high - low > self._narrow(low, high):
            parts = self.oracle.limits.parts
            inner = [low + (high - low) * k / parts for k in range(1, parts)]
            yield [self._query(x, d, hint=True) for x in inner for d in (holder, rival) if d is not None]
            beaten = [self._beats(self._with(rival, x, True), self._with(holder, x, True)) for x in inner]
            k = beaten.index(True) if True in beaten else len(inner)
            low, high = [low, *inner][k], [*inner, high][k]
        return low, high

    def _sides(self, holder: Design | None, low: float, high: float) -> Asking:
        """Return the designs on both sides of a break."""
        before = self._best(low).design
        if holder is not None and (before is None or _words(before) != _words(holder)):
            yield [self._query(low, holder)]
            before = self._with(holder, low)
        return (before if holder is not None else None), self._best(high).design

    def _query(self, value: float, design: Design | None = None, hint: bool = False) -> _Query:
        along, words = self.oracle.along, ""
        if design is not None:
            words = _words(design)
            self.oracle.made.setdefault(words, design)
        values = tuple(value if k == along else v for k, v in enumerate(self.one.values))
        return _Query(self.objective, values, words, hint)

    def _stands(self, design: Design | None, value: float) -> bool:
        return design is None or self.oracle.steps.stands(self._query(value).values, design)

    def _best(self, value: float) -> _Best:
        return self.oracle.known[self._query(value)]

    def _with(self, design: Design | None, value: float, hint: bool = False) -> Design | None:
        return None if design is None else self.oracle.known[self._query(value, design, hint)].design

    def _beats(self, one: Design | None, other: Design | None) -> bool:
        """True if a design is better than another by more than counts as equal; none is worse than any."""
        if one is None or other is None:
            return one is not other and other is None
        a, b = (self.sign * d.values[self.objective] for d in (one, other))
        return a < b - self.oracle.limits.same * max(abs(a), abs(b))

    def _holds(self, holder: Design | None, value: float) -> Asking:
        """True if a design's parts are (still) the best at a value, or as good as the best."""
        yield [self._query(value)]
        best = self._best(value).design
        if holder is None or best is None:
            return holder is best
        if _words(best) == _words(holder):
            return True
        yield [self._query(value, holder)]
        held = self._with(holder, value)
        return held is not None and not self._beats(best, held)


def _words(design: Design) -> str:
    """Return in words what a design is made of."""
    return repr(Composition.of(design, next(iter(design.values))).named)
