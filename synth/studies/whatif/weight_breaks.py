"""Break points of a weight: where another design of the same front comes first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from synth.order.pareto import rank
from synth.results import Design, ParetoFront
from synth.studies.settings import BREAKS, BreakLimits
from synth.studies.whatif.break_points import neighbours, other_values
from synth.studies.whatif.steps import Steps
from synth.studies.whatif.study_answers import Break, Composition, StudyStep
from synth.studies.whatif.vary import Value

Leader = Callable[[float], Design | None]


@dataclass(frozen=True)
class _NewLeader:
    """A narrow range of a weight, and the designs that come first at its ends."""

    low: float
    high: float
    before: Design
    after: Design


def weight_breaks(steps: Steps, along: int, answered: Sequence[StudyStep], limits: BreakLimits = BREAKS) -> list[Break]:
    """Return the weights at which another design comes first; the designs of a front do not depend on weights."""
    result: list[Break] = []
    for one, two in neighbours(along, answered):
        front = one.front
        if front is None or two.front is None or not front.designs:
            continue
        low, high = (float(s.values[along]) for s in (one, two))  # type: ignore[arg-type]
        changes = _changes(_leader(front, steps.varied[along].name), low, high, limits)
        result += [_break(change, front, other_values(one, along)) for change in changes]
    return result


def _leader(front: ParetoFront, name: str) -> Leader:
    """Comparison that decides which design comes first at a weight of one objective, the others being as they are."""
    names, weights = list(front.frame.objectives), front.settings["weights"]
    values = np.array([[d.values[n] for n in names] for d in front.designs])

    def leader(weight: float) -> Design | None:
        trial = [weight if n == name else weights[n] for n in names]
        order = rank(front.frame.objectives, values, trial, scale=front.scale).order if any(trial) else []
        return front.designs[order[0]] if order else None

    return leader


def _changes(leader: Leader, low: float, high: float, limits: BreakLimits) -> list[_NewLeader]:
    """Halve until the leading designs at both ends are the same or the ends meet; return where they meet."""
    first, last = leader(low), leader(high)
    if first is last or first is None or last is None:
        return []
    if high - low <= max(limits.width * max(abs(low), abs(high)), limits.finest):
        return [_NewLeader(low, high, first, last)]
    middle = 0.5 * (low + high)
    return [*_changes(leader, low, middle, limits), *_changes(leader, middle, high, limits)]


def _break(change: _NewLeader, front: ParetoFront, others: tuple[Value, ...]) -> Break:
    objective, proven = next(iter(front.frame.objectives)), front.certificate.kind == "global"
    before, after = (Composition.of(d, objective) for d in (change.before, change.after))
    remark = "the leading design of the front"
    return Break("score", others, change.low, change.high, before, after, proven, remark)
