"""What a user asks under ``limits`` and ``fix``: comparisons, sets and pins, and what they restrict."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from synth.declaration import Origin
from synth.errors import InputError, at
from synth.model.constraint import Constraint
from synth.model.model import Model
from synth.order.margins import MARGINS, above
from synth.question.arguments import Limits, Pins
from synth.question.count_domain import compares, entries, is_list, shown_set, values_of_set
from synth.question.variable_ranges import VariableRanges
from synth.text.input_limits import INPUT_LIMITS
from synth.units import parse_quantity, typed_quantity

SENSES = {"<=": "at_most", ">=": "at_least", "==": "equal", "=": "equal", "<": "at_most", ">": "at_least"}
SENSES |= {"≤": "at_most", "≥": "at_least"}
CONDITION = re.compile(r"^\s*(<=|>=|==|=|<|>|≤|≥)\s*([^\s<>=≤≥].*)$", re.DOTALL)


class UserLimits:
    """The limits and pins of a question.

    Parameters
    ----------
    model : Model
    limits, fix : mapping
        As the user typed them: name or symbol -> what is asked of it.
    ranges : VariableRanges
        Narrowed to what is asked of variables.
    restrict : bool
        False for the analysis of a given design: limits on what it is made of bound nothing then.

    Attributes
    ----------
    judging : list of Constraint
        What designs are told and judged by, beside the limits of the family.
    bounding : list of Constraint
        Limits on variables and counts. In a search they are ranges and values left out, so that every design that is
        looked at keeps them.
    asked : dict
        What is asked of quantities under ``limits``, as typed, by public name.
    as_typed : dict
        The same by the names that were typed.
    count_sets : list
        The counts of which a set of values is allowed, with the values.
    fixed : dict
        Slot, count or choice -> the designation, SI value or label that it is pinned to.
    """

    def __init__(self, model: Model, limits: Limits, fix: Pins, ranges: VariableRanges, restrict: bool) -> None:
        self._model, self._ranges = model, ranges
        self.judging: list[Constraint] = []
        self.bounding: list[Constraint] = []
        self.count_sets: list[tuple[str, np.ndarray]] = []
        self.fixed: dict[str, Any] = {}
        self.as_typed = dict(limits)
        check_number_of_limits(self.as_typed)
        d, quantities = model.declaration, list(model.quantity_sx)
        self.asked = model.by_name(self.as_typed, "limits", quantities, "a quantity")
        for name, conditions in self.asked.items():
            self._limit(name, conditions, restrict)
        kinds = "a variable, count, choice, slot or derived quantity"
        for name, value in model.by_name(fix, "fix", [*quantities, *d.choices, *d.slots], kinds).items():
            with at("fix", name):
                self._pin(name, value)

    def judge_unknowns(self, values: Mapping[str, float]) -> None:
        """Let limits on variables and counts judge designs too, for a given design that may miss them.

        Parameters
        ----------
        values : mapping
            Variables and counts of the design, SI. Of a set of allowed values the one nearest to it is the limit.
        """
        for name in self.asked:
            self.judging += self.bounds_of(name)
            for steps in self.sets_of(name):
                nearest = float(steps[np.argmin(np.abs(steps - values[name]))])
                shown = f"{name} in {shown_set(steps)}"
                self.judging.append(self._model.constraint_on(name, "equal", nearest, shown))

    def bounds_of(self, name: str) -> list[Constraint]:
        """Return the limits on one variable or count."""
        return [x for x in self.bounding if x.quantity == name]

    def sets_of(self, count: str) -> list[np.ndarray]:
        """Return the sets of values that are allowed of a count."""
        return [steps for name, steps in self.count_sets if name == count]

    def _limit(self, name: str, conditions: object, restrict: bool) -> None:
        model = self._model
        for sense, bound, place in read_limits(name, model.units[name], conditions):
            with at("limits", name, *place):
                limit = model.constraint_on(name, sense, bound)
                if name in model.declaration.derived:
                    self._judge(limit)
                    continue
                self.bounding.append(limit)
                if restrict:
                    self._ranges.bound(limit)
        if self._asks_set(name, conditions):
            with at("limits", name):
                self._allow(name, conditions, "limits")

    def _asks_set(self, name: str, conditions: object) -> bool:
        """True if what is asked of a quantity holds a set of allowed values, which only a count can have."""
        if not is_list(conditions) or (len(conditions) and all(map(compares, entries(conditions)))):
            return False
        if name not in self._model.declaration.counts:
            example = f"comparisons, for example '<= 260 {self._model.units[name]}'; a set of values is for counts"
            place = next((k for k, text in enumerate(entries(conditions)) if not compares(text)), None)
            path = ("limits", name) if place is None or isinstance(conditions, str) else ("limits", name, place)
            raise InputError(f"limits: {name}", conditions, example, path)
        return True

    def _allow(self, count: str, values: object, field: str) -> None:
        self.count_sets.append((count, values_of_set(self._model.declaration.counts[count], values, field)))

    def _judge(self, limit: Constraint) -> None:
        """Let a limit on a derived quantity be one that designs are judged by."""
        name, unit = limit.quantity, limit.unit
        ceiling = self._model.declaration.derived[name].ceiling
        if limit.sense != "at_least" and limit.bound > ceiling:
            right = f"at most {typed_quantity(ceiling, unit)}"
            raise InputError(f"limits: {name}", typed_quantity(limit.bound, unit), right)
        for other in self.judging:
            if other.quantity == name and contradict(other.sense, other.bound, limit.sense, limit.bound):
                right = "limits that do not exclude each other"
                raise InputError(f"limits: {name}", f"{other.name} and {limit.name}", right)
        self.judging.append(limit)

    def _pin(self, name: str, value: object) -> None:
        model, d = self._model, self._model.declaration
        if name in d.counts and is_list(value):
            self._allow(name, value, "fix")
            return
        if is_list(value) and not isinstance(value, str):
            more = " (parts takes a list of designations)" if name in d.slots else ""
            raise InputError(f"fix: {name}", value, f"one value; a set of values is for counts{more}")
        if name in d.slots or name in d.choices:
            self.fixed[name] = value
            return
        number_si = parse_quantity(value, model.units[name], f"fix: {name}")
        self._ranges.pin(name, value, number_si)
        if name in d.counts:
            self.fixed[name] = number_si
        elif name in d.derived:
            self._judge(model.constraint_on(name, "equal", number_si, origin=Origin.PIN))


def check_number_of_limits(limits: Limits) -> None:
    """Refuse more limits than a question may have, before any of them is read."""
    count = sum(len(texts) if is_list(texts) and not isinstance(texts, str) else 1 for texts in limits.values())
    if count > INPUT_LIMITS.limits:
        raise InputError("limits", f"{count} limits", f"at most {INPUT_LIMITS.limits}", ("limits",))


def read_limits(name: str, unit: str, texts: object) -> list[tuple[str, float, tuple[int, ...]]]:
    """Return the comparisons that the user wrote about a quantity: sense, SI value, and the position in a list."""
    several = is_list(texts)
    found = list[tuple[str, float, tuple[int, ...]]]()
    for k, text in enumerate(entries(texts)):
        if several and not compares(text):
            continue  # a value of a set
        place = (k,) if several and not isinstance(texts, str) else ()
        with at("limits", name, *place):
            found += [(sense, bound, place) for sense, bound in _read_limit(name, unit, text)]
    return found


def _read_limit(name: str, unit: str, text: object) -> list[tuple[str, float]]:
    """Limits on a quantity in a text: sense and SI value of each."""
    label = f"limits: {name}"
    if isinstance(text, str) and ".." in text:
        first, last = text.split("..", 1)
        low, high = parse_quantity(first, unit, label), parse_quantity(last, unit, label)
        if low > high:
            raise InputError(label, text, "the smaller value first, for example '200 mm .. 260 mm'")
        return [("at_least", low), ("at_most", high)]
    match = CONDITION.match(text) if isinstance(text, str) else None
    if match is None:
        raise InputError(label, text, f"a comparison, for example '<= 260 {unit}' or '200 {unit} .. 260 {unit}'")
    return [(SENSES[match.group(1)], parse_quantity(match.group(2), unit, label))]


def contradict(first: str, one: float, second: str, other: float) -> bool:
    """True if two limits on one quantity leave nothing between them."""
    lows = [b for s, b in ((first, one), (second, other)) if s in ("at_least", "equal")]
    highs = [b for s, b in ((first, one), (second, other)) if s in ("at_most", "equal")]
    return bool(lows and highs and max(lows) > above(min(highs), MARGINS.end))
