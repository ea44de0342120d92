"""Conditions that compare the rows of several slots: ``thickness == outer_plate.thickness``.

Such a condition belongs to the question, not to the family, but it is answered like a refusal of the family: the
columns that it compares become inputs of the traced program, and combinations for which it does not hold are refused.
So whatever keeps to refusals (search, proof, verification, studies) keeps to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from synth.declaration import Declaration, Part, Refusal
from synth.errors import InputError, at
from synth.tables.conditions import Condition, Junction, Negation, Node, Test, Value, may_be_condition, parse_condition
from synth.tables.schema import Column
from synth.text.row_cells import text_code
from synth.units import parse_quantity

_COMPARE: dict[str, Callable[[Any, Any], Any]] = {
    "==": lambda a, b: a == b,
    "!=": lambda a, b: ca.logic_not(a == b),
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: b < a,
    ">=": lambda a, b: b <= a,
}


@dataclass(frozen=True)
class SlotComparison:
    """A condition of the user on a slot that names columns of others."""

    slot: str
    text: str

    def __str__(self) -> str:
        return f"{self.slot}: {self.text}"


def comparisons_of(rules: Mapping[str, Any]) -> tuple[SlotComparison, ...]:
    """Return the conditions among the rules for parts, by slot, that compare slots."""
    comparisons = []
    for slot, rule in rules.items():
        if isinstance(rule, str) and may_be_condition(rule):
            with at("parts", slot):
                if parse_condition(rule).compares_slots:
                    comparisons.append(SlotComparison(slot, rule))
    return tuple(comparisons)


def refusal_of(comparison: SlotComparison, d: Declaration) -> Refusal:
    """Return the refusal of all combinations for which a condition does not hold.

    Parameters
    ----------
    comparison : SlotComparison
    d : Declaration
        Of the problem; the columns that are compared become columns it uses, which rows must have.

    Raises
    ------
    InputError
        A slot or column is unknown, or what is compared is not of one kind.
    """
    with at("parts", comparison.slot):
        condition = parse_condition(comparison.text)
        holds = _ConditionReader(condition, comparison.slot, d).read(condition.joint())
    return Refusal(f"parts: {comparison.slot}", ca.logic_not(holds), f"parts with {comparison.text}")


class _ConditionReader:
    """Writes a condition as an expression of the columns."""

    def __init__(self, condition: Condition, slot: str, d: Declaration) -> None:
        self.condition, self.slot, self.d = condition, slot, d

    def read(self, node: Node) -> Any:
        """Return 1 where the condition holds, else 0."""
        if isinstance(node, Negation):
            return ca.logic_not(self.read(node.part))
        if isinstance(node, Junction):
            first, *others = (self.read(part) for part in node.parts)
            for other in others:
                first = (ca.logic_and if node.every else ca.logic_or)(first, other)
            return first
        if isinstance(node, Test):
            return self._test(node)
        expected = "comparisons beside that with another slot (membership of a cell stands apart, joined by 'and')"
        raise self.condition.wrong(node.position, node.item, expected)

    def _test(self, test: Test) -> Any:
        part, name = self._column(test.column, test.position)
        column = self.d.catalogs.table(part.table).column(name)
        if not column.numeric and test.op not in ("==", "!=", "in"):
            right = f"== or != or in for {test.column}, which is a column of text"
            raise self.condition.wrong(test.position, f"{test.column} {test.op}", right)
        operand = getattr(part, name) if column.numeric else part.code(name)
        results = [self._compared(test, operand, column, value) for value in test.values]
        result = results[0]
        for other in results[1:]:
            result = ca.logic_or(result, other)
        return result

    def _compared(self, test: Test, operand: ca.SX, column: Column, value: Value) -> Any:
        compare = _COMPARE["==" if test.op == "in" else test.op]
        if not value.column:
            return compare(operand, self._constant(test, column, value))
        part, name = self._column(value.text, value.position)
        other = self.d.catalogs.table(part.table).column(name)
        if column.numeric != other.numeric:
            kind = "numbers" if column.numeric else "text"
            raise self.condition.wrong(value.position, value.text, f"a column of {kind}, as {test.column} is")
        if not column.numeric:
            return compare(operand, part.code(name))
        if column.scale.kind != other.scale.kind:
            right = f"a column that measures what {column.heading} does; {value.text} is in {other.unit}"
            raise self.condition.wrong(value.position, value.text, right)
        return compare(operand, getattr(part, name))

    def _constant(self, test: Test, column: Column, value: Value) -> float:
        if column.numeric:
            try:
                return float(parse_quantity(value.text, column.scale, column.name))
            except InputError as error:
                right = f"{error.expected} (column {column.heading})"
                raise self.condition.wrong(value.position, value.text, right) from None
        if not value.quoted:
            right = f"a text in quotes, '{value.text}', since {test.column} is a column of text"
            raise self.condition.wrong(value.position, value.text, right)
        return text_code(value.text)

    def _column(self, word: str, position: int) -> tuple[Part, str]:
        """Return the slot that a column belongs to, and the name of the column."""
        first, dot, last = word.partition(".")
        slot = self.d.names().get(first, "") if dot else self.slot
        if slot not in self.d.slots:
            raise self.condition.wrong(position, word, f"a slot before the point, one of {', '.join(self.d.slots)}")
        part = self.d.slots[slot]
        try:
            return part, self.d.catalogs.table(part.table).column(last if dot else word).name
        except InputError as error:
            raise self.condition.wrong(position, word, error.expected) from None
