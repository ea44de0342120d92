"""What a family refuses outright: how far a question is from being allowed, and what alone would lift the refusal."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.analysis.settings import GUARDS, WAYS_OUT
from synth.declaration import Refusal
from synth.model.numbers import numeric
from synth.question.instance import Instance
from synth.question.requirement_values import RequirementValues
from synth.special import expanded
from synth.text.numbers import percent
from synth.units import miss_text, outward, parse_quantity, typed_quantity

AT_LEAST, AT_MOST = "at_least", "at_most"


@dataclass(frozen=True)
class FiredGuard:
    """A refusal of the family that a question runs into.

    ``value`` is what stands there and ``needed`` what it would have to be, in SI; both are not-a-number where the
    refusal compares no requirement with a number. ``missed_by`` is the difference as a fraction of ``needed``;
    ``part`` the row that comes nearest, of refusals that speak of parts. ``lifted_by`` has, per requirement, the value
    as text with which this refusal is gone; other limits may still be missed there.
    """

    name: str
    message: str
    requirement: str
    value: float
    needed: float
    unit: str
    sense: str
    missed_by: float
    part: str
    lifted_by: Mapping[str, str]
    sentence: str


@dataclass(frozen=True)
class Inequality:
    """One side must be at most, or below, the other."""

    smaller: Any
    larger: Any
    strictly: bool


def required_inequalities(when: ca.SX) -> list[Inequality] | None:
    """Conditions that must all hold for a guard not to refuse; None where it is not of that form.

    Examples
    --------
    >>> a, b, c = (ca.SX.sym(x) for x in "abc")
    >>> required_inequalities(ca.logic_or(a < b, c >= b))
    [Inequality(smaller=SX(b), larger=SX(a), strictly=False), Inequality(smaller=SX(c), larger=SX(b), strictly=True)]
    >>> required_inequalities(ca.logic_and(a < b, c > b)) is None
    True
    """
    when = ca.SX(when)
    if when.is_constant() or when.is_symbolic():
        return None
    if when.op() in (ca.OP_LT, ca.OP_LE):
        return [Inequality(when.dep(1), when.dep(0), when.op() == ca.OP_LE)]
    if when.op() == ca.OP_OR:
        sides = [required_inequalities(when.dep(k)) for k in (0, 1)]
        return None if None in sides else [one for side in sides for one in side or ()]
    return None


def fired_guards(instance: Instance) -> list[FiredGuard]:
    """Return the refusals that a question runs into: of requirements, and of all rows that a slot offers.

    Parameters
    ----------
    instance : Instance
        Made with ``refuse=False``.
    """
    model = instance.model
    guards = []
    for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
        if len(kinds) <= 1:
            one = _RefusedChoices(instance, refusal, next(iter(kinds), ""))
            if one.fires(instance.values):
                guards.append(one.fired_guard())
    return guards


def requirements_of(instance: Instance, code: str) -> list[str]:
    """Return the requirements (also those that are defaults) on which a refusal depends."""
    model = instance.model
    refusal = next(r for r in model.declaration.refusals if r.code == code)
    used = {str(s) for s in ca.symvar(expanded(refusal.when, model.calls))}
    return [name for name, symbol in model.requirement_symbols.items() if symbol in used]


def columns_of(instance: Instance, code: str) -> list[str]:
    """Return the part columns (``slot.column``) on which a refusal depends."""
    model = instance.model
    refusal = next(r for r in model.declaration.refusals if r.code == code)
    used = {str(s) for s in ca.symvar(expanded(refusal.when, model.calls))}
    return [e.label for e in model.data_inputs if e.kind == "part" and str(e.sx) in used]


class _RefusedChoices:
    """One refusal, over everything that a slot, count or choice offers."""

    def __init__(self, instance: Instance, refusal: Refusal, name: str) -> None:
        self.instance, self.refusal, self.name = instance, refusal, name
        calls = instance.model.calls
        self.when = numeric(expanded(refusal.when, calls))
        self.inequalities = required_inequalities(refusal.when) or []
        self.pairs = [tuple(numeric(expanded(x, calls)) for x in (w.smaller, w.larger)) for w in self.inequalities]
        self.slot = next((s for s in instance.selection.slots if s.slot == name), None)

    def _places(self, requirements: RequirementValues) -> Iterator[dict[str, float]]:
        """Yield the values of all symbols: once, or for every row, count or choice that is offered."""
        instance = self.instance
        known = requirements.by_symbol(instance.model)
        if self.slot is not None:
            columns = instance.model.declaration.slots[self.name].columns
            for k in range(len(self.slot.rows)):
                yield known | {str(c.sx): float(self.slot.columns[key][k]) for key, c in columns.items()}
        elif self.name:
            offered = instance.selection.counts | instance.selection.choices
            for value in offered[self.name]:
                yield known | {self.name: float(value)}
        else:
            yield known

    def fires(self, requirements: RequirementValues) -> bool:
        """True if nothing that is offered escapes with these values of the requirements."""
        return all(_at(self.when, values) > 0.5 for values in self._places(requirements))

    def fired_guard(self) -> FiredGuard:
        """Refusal with its amounts at the nearest row."""
        places = list(self._places(self.instance.values))
        # The row that comes nearest, and of it what is missed by most.
        gaps = [[_gap(*(_at(x, values) for x in pair)) for pair in self.pairs] for values in places]
        nearest = min(range(len(places)), key=lambda k: max(gaps[k], default=0.0))
        worst = int(np.argmax(gaps[nearest])) if self.pairs else -1
        part = self.slot.table.designations[self.slot.rows[nearest]] if self.slot is not None else ""
        lifted = {
            name: text for name in requirements_of(self.instance, self.refusal.code) if (text := self._lift(name))
        }
        name, value, needed, unit, sense = self._sides(worst, places[nearest])
        missed = (
            abs(value - needed) / max(abs(needed), 1e-300) if name else gaps[nearest][worst] if self.pairs else math.nan
        )
        words = f"{self.refusal.code}"
        if name:
            strictly = self.inequalities[worst].strictly
            side = (
                ("more than" if strictly else "at least")
                if sense == AT_LEAST
                else ("less than" if strictly else "at most")
            )
            sides = [typed_quantity(x, unit, WAYS_OUT.digits) for x in (value, needed)]
            shown = f"{sides[0]} where {side} {sides[1]} is needed"
            words += f": {name} is {shown}{f' with {part}' if part else ''}"
        if not math.isnan(missed):
            words += f" (missed by {miss_text(value, needed, unit) if name else percent(missed)})"
        return FiredGuard(
            self.refusal.code, self.refusal.message, name, value, needed, unit, sense, missed, part, lifted, words
        )

    def _sides(self, worst: int, values: Mapping[str, float]) -> tuple[str, float, float, str, str]:
        """Requirement on one side of the missed inequality, its value and its bound."""
        if worst >= 0:
            pair = self.inequalities[worst].smaller, self.inequalities[worst].larger
            names = {str(r.sx): r for r in self.instance.model.declaration.requirements.values() if r.sx is not None}
            for k in (1, 0):  # the larger side is what most limits are called by
                if pair[k].is_symbolic() and str(pair[k]) in names:
                    r, (small, large) = names[str(pair[k])], (_at(x, values) for x in self.pairs[worst])
                    value, bound = (small, large) if k == 0 else (large, small)
                    return r.name, value, bound, r.unit, AT_MOST if k == 0 else AT_LEAST
        return "", math.nan, math.nan, "-", ""

    def _lift(self, name: str) -> str:
        """Return the nearest value of a requirement with which this refusal is gone; nothing where there is none."""
        r, value = self.instance.model.declaration.requirements[name], self.instance.values.requirements[name]
        if not value > 0:
            return ""
        candidates: list[tuple[float, str]] = []
        for sign in (1.0, -1.0):
            end = r.upper if sign > 0 else r.lower
            reach = min(GUARDS.farthest, abs(math.log(end / value))) if 0 < end < math.inf else GUARDS.farthest
            free = next(
                (s for s in np.linspace(0, reach, GUARDS.steps + 1)[1:] if not self._fires_at(name, sign * s)), None
            )
            if free is None:
                continue
            low, high = free - reach / GUARDS.steps, float(free)
            for _ in range(GUARDS.halvings):
                middle = (low + high) / 2
                low, high = (middle, high) if self._fires_at(name, sign * middle) else (low, middle)
            needed = value * math.exp(sign * high)
            for text in (next(outward(needed, r.unit, sign > 0, WAYS_OUT.digits)), *outward(needed, r.unit, sign > 0)):
                if not self._fires_text(name, text):
                    candidates.append((high, text))
                    break
        return min(candidates)[1] if candidates else ""

    def _fires_at(self, name: str, change: float) -> bool:
        return self._fires_with(name, self.instance.values.requirements[name] * math.exp(change))

    def _fires_text(self, name: str, text: str) -> bool:
        r = self.instance.model.declaration.requirements[name]
        value = parse_quantity(text, r.unit, name)
        return not r.lower <= value <= r.upper or self._fires_with(name, value)

    def _fires_with(self, name: str, value: float) -> bool:
        return self.fires(self.instance.values.moved(self.instance.model, name, value))


def _at(made: tuple[Any, list[str]], values: Mapping[str, float]) -> float:
    function, names = made
    return float(function.call([values[name] for name in names])[0])


def _gap(small: float, large: float) -> float:
    """Excess of what should be smaller over the other, as a fraction; negative where there is none."""
    return (small - large) / max(abs(small), abs(large), 1e-300)
