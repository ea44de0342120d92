"""Break points: where, between two steps of a study, the best parts or counts change, or feasibility begins or ends.

Where the best designs of two steps differ, the range between them is halved until it is narrow. Every value on the way
is searched over all parts and proven; the designs known already are where each search begins, so that it is short.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from synth.clock import Stopped
from synth.errors import InputError
from synth.pareto import rank
from synth.results import Design, ParetoFront
from synth.study import Break, Composition, Step, best_design
from synth.vary import Steps, Value

WIDTH = 1e-3  # of a value: a break is known to be within this
GAP = 1e-5  # of the searches that compare parts
SAME = 2 * GAP  # values that differ by less count as equal: parts that tie do not change at random
MOST = 20  # breaks of one objective between two steps
FINEST = 1e-6  # of the step: how narrow the range of a break at zero gets
LONGEST = 60.0  # seconds of one search
UNPROVEN = "the search on one side did not finish"
INTERRUPTED = "interrupted"

Left = Callable[[], float | None]
Shown = Callable[[Mapping[str, Any]], None] | None


class Kept(Protocol):
    """Where results are kept."""

    def value(self, key: str, fingerprint: str) -> Any:
        """Return what is kept under a key for a question, or None."""

    def keep(self, key: str, fingerprint: str, value: Any) -> None:
        """Keep something for a question."""


def find_breaks(
    steps: Steps,
    along: int,
    answered: Sequence[Step],
    found: list[Break],
    kept: Kept,
    left: Left,
    workers: int,
    shown: Shown,
) -> None:
    """Find the break points of every objective between neighbouring steps.

    Parameters
    ----------
    steps : Steps
    along : int
        The position of the number that is varied.
    answered : list of Step
        All steps, answered.
    found : list of Break
        Filled as breaks are found, interval by interval, so that they stay where time is over.
    kept : Kept
    left : callable
        Returns the seconds left; raises Stopped.
    workers : int
    shown : callable, optional
        Progress.
    """
    pairs = list(_pairs(along, answered))
    ends: dict[tuple[int, str], _Best] = {}
    for number, (one, two) in enumerate(pairs):
        if one.front is None or two.front is None:
            continue
        left()
        if shown is not None:
            shown({"stage": f"{steps.stated(one.values)} to {steps.stated(two.values)}", "done": number / len(pairs)})
        key, mark = f"breaks {one.number} {two.number}", f"{one.fingerprint} {two.fingerprint}"
        known = kept.value(key, mark)
        if known is not None:
            found += [_read(entry) for entry in known]
            continue
        own: list[Break] = []
        for objective, sense in _objectives(one.front, two.front).items():
            for step in (one, two):
                if (step.number, objective) not in ends:
                    # Searched from its own design alone, so that it is the same whatever was searched before.
                    search = _Search(steps, along, step, objective, sense, left, workers)
                    ends[step.number, objective] = search.best(float(step.values[along]))  # type: ignore[arg-type]
            search = _Search(steps, along, one, objective, sense, left, workers)
            own += _Between(search, two, ends[one.number, objective], ends[two.number, objective]).breaks()
        kept.keep(key, mark, [asdict(b) for b in own])
        found += own


def _pairs(along: int, answered: Sequence[Step]) -> list[tuple[Step, Step]]:
    """Return the steps that are neighbours along a number, the other value being the same."""
    groups: dict[tuple[Value, ...], list[Step]] = {}
    for step in answered:
        groups.setdefault(_others(step, along), []).append(step)
    result = []
    for group in groups.values():
        group.sort(key=lambda s: float(s.values[along]))  # type: ignore[arg-type]
        result += list(pairwise(group))
    return result


def _others(step: Step, along: int) -> tuple[Value, ...]:
    return tuple(v for k, v in enumerate(step.values) if k != along)


def _objectives(*fronts: ParetoFront) -> dict[str, str]:
    return {n: sense for front in fronts for n, sense in front.frame.objectives.items()}


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


class _Search:
    """Searches for the best design in one objective at any value of what is varied."""

    def __init__(
        self, steps: Steps, along: int, step: Step, objective: str, sense: str, left: Left, workers: int
    ) -> None:
        self.steps, self.along, self.step = steps, along, step
        self.objective, self.sense, self.sign = objective, sense, 1.0 if sense == "min" else -1.0
        self.left, self.workers = left, workers
        self.known = [d] if (d := best_design(step.front, objective)) is not None else []
        self.found: dict[tuple[str, float], _Best] = {}

    def best(self, value: float) -> _Best:
        """Return the best at a value over everything."""
        return self._searched("", value, {}, {})

    def alone(self, design: Design, value: float) -> _Best:
        """Return the best at a value with all parts, counts and choices of a design."""
        made = self.composition(design)
        slots = {slot: [word] for slot, word in made.parts.items()}
        return self._searched(repr(made.named), value, slots, {**made.counts, **made.choices})

    def composition(self, design: Design) -> Composition:
        """Return what a design is made of."""
        return Composition.of(design, self.objective)

    def beats(self, one: Design, other: Design) -> bool:
        """Tell whether a design is better than another by more than counts as equal."""
        a, b = (self.sign * d.values[self.objective] for d in (one, other))
        return a < b - SAME * max(abs(a), abs(b))

    def _searched(self, what: str, value: float, slots: Mapping[str, list[str]], pins: Mapping[str, Any]) -> _Best:
        key = (what, value)
        if key not in self.found:
            self.found[key] = self._search(value, slots, pins)
        return self.found[key]

    def _search(self, value: float, slots: Mapping[str, list[str]], pins: Mapping[str, Any]) -> _Best:
        values = [value if k == self.along else v for k, v in enumerate(self.step.values)]
        left = self.left()
        try:
            question = self.steps.one_best(values, {self.objective: self.sense}, GAP, slots, pins)
        except InputError:
            return _Best(None, True)  # refused: the family says that there is no such design
        seconds = LONGEST if left is None else min(LONGEST, left)
        front = question.answer(self.workers, None, seconds, self.known, explained=False)
        if front.interrupted == INTERRUPTED:
            raise Stopped(front.interrupted)
        if front.interrupted:
            self.left()
        design = best_design(front, self.objective)
        if design is not None and not pins and _named(design) not in map(_named, self.known):
            self.known.append(design)
        return _Best(design, front.certificate.kind == "global")


class _Between:
    """The breaks of one objective between two steps."""

    def __init__(self, search: _Search, two: Step, first: _Best, last: _Best) -> None:
        self.search = search
        self.low, self.high = (float(s.values[search.along]) for s in (search.step, two))  # type: ignore[arg-type]
        self.ends = {self.low: first, self.high: last}
        search.known += [b.design for b in self.ends.values() if b.design is not None]

    def breaks(self) -> list[Break]:
        """Return the breaks from the lower to the upper step."""
        search, found = self.search, list[Break]()
        place, holder = self.low, self._best(self.low).design
        while not self._holds(holder, self.high):
            if len(found) == MOST:
                found[-1] = replace(found[-1], remark=f"more changes follow up to {self.high:g}")
                break
            low, high = self._halved(place, holder)
            after = self._best(high).design
            before = None if holder is None else search.alone(holder, low).design
            proven = self._best(low).proven and self._best(high).proven
            old, new = (None if d is None else search.composition(d) for d in (before, after))
            others = _others(search.step, search.along)
            found.append(Break(search.objective, others, low, high, old, new, proven, "" if proven else UNPROVEN))
            place, holder = high, after
        return found

    def _best(self, value: float) -> _Best:
        return self.ends[value] if value in self.ends else self.search.best(value)

    def _halved(self, low: float, holder: Design | None) -> tuple[float, float]:
        """Return a narrow range at whose lower end a holder still holds, and at whose upper end it does not."""
        high = self.high
        while high - low > max(WIDTH * max(abs(low), abs(high)), FINEST * (self.high - self.low)):
            middle = 0.5 * (low + high)
            if self._holds(holder, middle):
                low = middle
            else:
                high = middle
        return low, high

    def _holds(self, holder: Design | None, value: float) -> bool:
        """Tell whether a design's parts are (still) the best at a value, or as good as the best."""
        best = self._best(value).design
        if holder is None or best is None:
            return holder is best
        if _named(best) == _named(holder):
            return True
        own = self.search.alone(holder, value).design
        return own is not None and not self.search.beats(best, own)


def _named(design: Design) -> dict[str, str]:
    return Composition.of(design, next(iter(design.values))).named


# ---- weights --------------------------------------------------------------------------------------------------------


def weight_breaks(steps: Steps, along: int, answered: Sequence[Step]) -> list[Break]:
    """Return the weights at which another design comes first; the designs of a front do not depend on weights."""
    result: list[Break] = []
    for one, two in _pairs(along, answered):
        front = one.front
        if front is None or two.front is None or not front.designs:
            continue
        low, high = (float(s.values[along]) for s in (one, two))  # type: ignore[arg-type]
        name, weights = steps.varied[along].name, front.settings["weights"]
        _leaders(front, {**weights}, name, low, high, one, along, result)
    return result


def _leaders(
    front: ParetoFront,
    weights: dict[str, float],
    name: str,
    low: float,
    high: float,
    step: Step,
    along: int,
    result: list[Break],
) -> None:
    """Halve until the leading designs at both ends are the same or the ends meet."""
    names = list(front.frame.objectives)
    values = np.array([[d.values[n] for n in names] for d in front.designs])

    def leader(weight: float) -> Design | None:
        own = [weight if n == name else weights[n] for n in names]
        return front.designs[rank(front.frame.objectives, values, own).order[0]] if any(own) else None

    first, last = leader(low), leader(high)
    if first is last or first is None or last is None:
        return
    if high - low <= max(WIDTH * max(abs(low), abs(high)), FINEST):
        proven = front.certificate.kind == "global"
        before, after = (Composition.of(d, names[0]) for d in (first, last))
        others = _others(step, along)
        result.append(Break("score", others, low, high, before, after, proven, "the leading design of the front"))
        return
    middle = 0.5 * (low + high)
    _leaders(front, weights, name, low, middle, step, along, result)
    _leaders(front, weights, name, middle, high, step, along, result)
