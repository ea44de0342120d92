"""What a design is sized for, in one line: how the torque it must carry follows from what was asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from synth.results import Design
from synth.results.calculation import CalculatedDesign, Calculation, NamedQuantity
from synth.results.expression import Expression, in_force, names_in, value_of
from synth.text.plain_text import words
from synth.units import in_unit, unit_text

from .formula.layout import Fraction, Layout, Row, Sign, Typesetter, Word, textbook
from .formula.plain import plain
from .numbers import UnitIn

TIMES = " x "


@dataclass(frozen=True)
class _Leaves:
    """What stands for quantities: their numbers with units, or their names in words."""

    outcome: CalculatedDesign

    def number(self, q: NamedQuantity) -> Layout:
        """Return the value of a quantity as a word."""
        value = q.value if q.value is not None else self.outcome.values[q.name]
        if q.labels or q.is_text:
            return Word(q.word(value) or "another")
        shown = UnitIn.formula(q.unit).shown(value, 4)
        unit = unit_text(shown.unit)
        return Word(f"{shown.bare().plain()}{f' {unit}' if unit else ''}")

    @staticmethod
    def name(q: NamedQuantity) -> Layout:
        """Return the name of a quantity as a word."""
        return Word(words(q.name))


def sizing_line(calculation: Calculation, design: Design) -> str:
    """Duty of a design: numbers, result and names; empty where its family does not state it.

    Parameters
    ----------
    calculation : Calculation
        Of the question.
    design : Design
    """
    rule = next((x for x in calculation.limits if x.name == design.frame.sized_by), None)
    if rule is None:
        return ""
    outcome = calculation.of_design(design)
    tree: Expression = rule.limit
    named = calculation.quantities.get(tree[1]) if tree[0] == "q" else None
    if named is not None and named.computed and named.expression is not None:
        tree = named.expression
    tree, _ = in_force(textbook(tree), outcome.values)
    tree = _without_ones(tree, calculation, outcome.values)
    leaves, quantities = _Leaves(outcome), calculation.quantities
    inserted = _chain(Typesetter(quantities, leaves.number, numeric=True).lay(tree))
    chain = _chain(Typesetter(quantities, leaves.name, numeric=True).lay(tree))
    result = f"{in_unit(outcome.verdicts[rule.name].limit, rule.unit)} {unit_text(rule.unit)}".rstrip()
    if tree[0] == "q" or inserted == result:
        return f"sized for {result} ({chain})"
    return f"sized for {inserted} = {result} ({chain})"


def _without_ones(tree: Expression, calculation: Calculation, values: Mapping[str, float]) -> Expression:
    """Return a tree without factors that are 1; what has a unit stands before bare factors."""
    if tree[0] != "*":
        return tree
    over, under = (
        [part for part in parts if not (set(names_in(part)) and value_of(part, values) == 1.0)] for parts in tree[1:]
    )
    if not over:
        return tree
    bare = {name for name, q in calculation.quantities.items() if q.unit in ("", "-")}
    over.sort(key=lambda part: set(names_in(part)) <= bare)
    return over[0] if len(over) == 1 and not under else ["*", over, under]


def _chain(layout: Layout) -> str:
    """Return products and quotients as people type them: one factor after the other."""
    if isinstance(layout, Fraction) and isinstance(layout.over, Row) and not _is_sum(layout.over):
        over = plain(layout.over)
        under = plain(layout.under)
        text = f"{over} / {under}" if not isinstance(layout.under, Row) else f"{over} / ({under})"
    else:
        text = plain(layout)
    return text.replace(" * ", TIMES)


def _is_sum(row: Row) -> bool:
    return any(isinstance(x, Sign) and x.text in ("+", "−") for x in row.items)
