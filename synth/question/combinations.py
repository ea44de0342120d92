"""Combinations of parts, counts and choices, and the numbers that stand for them: the only place that counts them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from synth.errors import InputError
from synth.question.selection import Selection
from synth.tables.table import Table
from synth.text.numbers import typed_number

if TYPE_CHECKING:
    from synth.results import Design

Numbers = TypeVar("Numbers", int, np.ndarray)


class MixedRadix:
    """Numbers whose digits have each its own base; the last digit counts fastest.

    Parameters
    ----------
    radix : list of int
        The base of each digit.
    """

    def __init__(self, radix: Sequence[int]) -> None:
        self.radix = list(radix)
        self.count = math.prod(self.radix)

    def digits(self, numbers: np.ndarray) -> list[np.ndarray]:
        """Return the digits of some numbers, an array per digit."""
        result, rest = [], np.asarray(numbers, dtype=np.int64)
        for base in reversed(self.radix):
            result.append(rest % base)
            rest = rest // base
        return result[::-1]

    def composed(self, digits: Sequence[np.ndarray], count: int) -> np.ndarray:
        """Return so many numbers, given by an array per digit."""
        result = np.zeros(count, dtype=np.int64)
        for position, digit in enumerate(digits):
            result = self.extended(result, position, digit)
        return result

    def extended(self, leading: Numbers, position: int, digit: Numbers) -> Numbers:
        """Return the numbers of so many leading digits, from those with one digit less and that digit."""
        result: Numbers = leading * self.radix[position] + digit
        return result

    def neighbours(self, numbers: int | np.ndarray) -> np.ndarray:
        """Return all numbers that differ in one digit (..., neighbours)."""
        number, weight = np.asarray(numbers, dtype=np.int64)[..., None], 1
        found = [np.empty((*number.shape[:-1], 0), dtype=np.int64)]
        for base in reversed(self.radix):
            own, others = number // weight % base, np.arange(base - 1)
            found.append(number + weight * (others + (others >= own) - own))
            weight *= base
        return np.concatenate(found, axis=-1)


class Combinations(MixedRadix):
    """The combinations of what a question offers: a digit per slot, count and choice, in this order.

    Parameters
    ----------
    selection : Selection
        What is offered; a digit is a position in it.
    labels : mapping
        Choice -> its labels, of which the selection holds the positions.
    """

    def __init__(self, selection: Selection, labels: Mapping[str, Sequence[str]]) -> None:
        self._selection, self._labels = selection, labels
        stepped = {**selection.counts, **selection.choices}
        self.names = [*(s.slot for s in selection.slots), *stepped]
        super().__init__([*(len(s.rows) for s in selection.slots), *(len(v) for v in stepped.values())])

    def column(self, name: str, column: str = "") -> np.ndarray:
        """Return the values of all alternatives of a count or choice, or in a column of a slot; SI."""
        for slot in self._selection.slots:
            if slot.slot == name:
                return slot.columns[column]
        return (self._selection.counts | self._selection.choices)[name]

    def number(self, design: Design) -> int:
        """Return the number of the combination of a design.

        Raises
        ------
        InputError
            When it has a part, count or choice that the question does not offer.
        """
        told = [str(design.parts.get(s.slot)) for s in self._selection.slots]
        told += [_step(design.values.get(name, math.nan)) for name in self._selection.counts]
        told += [str(design.choices.get(name)) for name in self._selection.choices]
        number = 0
        for position, (name, text, places) in enumerate(zip(self.names, told, self._places, strict=True)):
            if text not in places:
                shown = ", ".join(list(places)[:5]) + (f" and {len(places) - 5} more" if len(places) > 5 else "")
                raise InputError(f"design: {name}", text, f"what this question offers: {shown}")
            number = self.extended(number, position, places[text])
        return number

    def find(self, design: Design) -> int | None:
        """Return the number of the combination of a design; None where something of it is not offered.

        The design may be one of another question to the same family, whose tables may be others.
        """
        try:
            return self.number(design)
        except InputError:
            return None

    def describe(self, number: int) -> tuple[dict[str, tuple[Table, int]], dict[str, float], dict[str, str]]:
        """Return parts (table and row), counts and choices of one combination."""
        selection = self._selection
        place = dict(zip(self.names, (int(d[0]) for d in self.digits(np.array([number]))), strict=True))
        return (
            {s.slot: (s.table, int(s.rows[place[s.slot]])) for s in selection.slots},
            {name: float(values[place[name]]) for name, values in selection.counts.items()},
            {name: self._labels[name][int(own[place[name]])] for name, own in selection.choices.items()},
        )

    def differences(self, number: int, other: int) -> list[tuple[str, str, str]]:
        """Slots, counts and choices in which two combinations differ: name, what the one has, what the other has."""
        mine, its = (
            {
                **{slot: table.designations[row] for slot, (table, row) in parts.items()},
                **{name: typed_number(value) for name, value in counts.items()},
                **choices,
            }
            for parts, counts, choices in map(self.describe, (number, other))
        )
        return [(name, mine[name], its[name]) for name in mine if mine[name] != its[name]]

    @cached_property
    def _places(self) -> list[dict[str, int]]:
        """The digit of every alternative by the text it has in a design, per slot, count and choice."""
        selection = self._selection
        texts = [[s.table.designations[r] for r in s.rows] for s in selection.slots]
        texts += [[_step(v) for v in values] for values in selection.counts.values()]
        texts += [[self._labels[name][int(k)] for k in own] for name, own in selection.choices.items()]
        return [{text: k for k, text in enumerate(own)} for own in texts]


class JointCombinations(Combinations):
    """The combinations of several questions that offer the same: the first digit tells which question.

    Parameters
    ----------
    each : list of Combinations
        Of the questions.
    """

    def __init__(self, each: Sequence[Combinations]) -> None:
        self.each, self.size = list(each), each[0].count
        self.names = ["", *each[0].names]
        MixedRadix.__init__(self, [len(each), *each[0].radix])

    def question(self, numbers: Numbers) -> Numbers:
        """Return the questions that combinations belong to; numbers or arrays of such."""
        return numbers // self.size

    def own(self, numbers: Numbers) -> Numbers:
        """Return the numbers that combinations have in their questions."""
        return numbers % self.size

    def joined(self, question: Numbers, own: Numbers) -> Numbers:
        """Return the numbers here of combinations of a question."""
        result: Numbers = question * self.size + own
        return result

    def column(self, name: str, column: str = "") -> np.ndarray:
        """Return the values of all alternatives of a count or choice, or in a column of a slot; SI."""
        return self.each[0].column(name, column)

    def number(self, design: Design, question: int = 0) -> int:
        """Return the number of the combination of a design of one question; raise InputError where it has none."""
        return self.joined(question, self.each[question].number(design))

    def describe(self, number: int) -> tuple[dict[str, tuple[Table, int]], dict[str, float], dict[str, str]]:
        """Return parts (table and row), counts and choices of one combination."""
        return self.each[self.question(number)].describe(self.own(number))

    def neighbours(self, numbers: int | np.ndarray) -> np.ndarray:
        """Return the combinations of the same question that differ in one part, count or choice."""
        every = np.asarray(numbers, dtype=np.int64)
        return self.joined(self.question(every)[..., None], self.each[0].neighbours(self.own(every)))


def _step(value: float) -> str:
    """Return the value of a count as a text that tells steps apart."""
    return f"{value:.12g}"
