"""Formulas of a design as steps: symbols, numbers inserted, result."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction

from synth.order.feasibility import TOLERANCE
from synth.results.calculation import CalculatedDesign, Calculation, LimitVerdict, NamedQuantity
from synth.results.dimensions import dimension_of
from synth.results.expression import Expression, in_force, names_in, value_of
from synth.text.numbers import FULL_DIGITS, STEP_DIGITS
from synth.units import parse_unit, to_si

from ..formula.layout import (
    Amount,
    ByNumber,
    Layout,
    Letter,
    Row,
    Sign,
    Typesetter,
    Word,
    by_symbol,
    negligible_in,
    textbook,
)
from ..formula.lines import broken
from ..formula.plain import plain
from ..numbers import ShownQuantity, UnitIn, in_its_unit, in_step
from ..reasons import SIGN_OF
from .blocks import Cell, StepBlock, inline

ENOUGH = 1e-4  # relative; what is printed gives the printed result this closely
MORE_DIGITS = (STEP_DIGITS, FULL_DIGITS, 7, 9, 12)
CONDITIONS = 3  # of one formula that are shown


@dataclass
class Steps:
    """Lays out the formulas of one design.

    Parameters
    ----------
    calculation : Calculation
    outcome : CalculatedDesign
        Its quantities and verdicts.
    """

    calculation: Calculation
    outcome: CalculatedDesign
    in_si: list[str] = field(default_factory=list)  # symbols of formulas whose units do not close
    negligible: bool = False  # whether a number was left out that only keeps a sum away from zero

    def __post_init__(self) -> None:
        """Make the typesetter of symbols."""
        self.quantities = self.calculation.quantities
        self.symbols = Typesetter(self.quantities, by_symbol, numeric=False)
        failing = [name for name, verdict in self.outcome.verdicts.items() if not verdict.holds]
        self.failing = {x.name for x in self.calculation.limits if x.guard and x.name in failing}

    def all(self) -> list[StepBlock]:
        """Return every computed quantity, in order of dependency."""
        computed = [q for q in self.quantities.values() if q.computed]
        return [self.step(number, q) for number, q in enumerate(computed, 1)]

    def step(self, number: int, q: NamedQuantity) -> StepBlock:
        """Return one quantity: formula, numbers inserted, result."""
        assert q.expression is not None
        closes = self._closes(q)
        if not closes:
            self.in_si.append(q.symbol)
        self.negligible = self.negligible or negligible_in(q.expression)
        tree = textbook(q.expression)
        value = self.outcome.values[q.name]
        lines = [self.symbols.lay(tree)]
        notes: list[Cell] = []
        missing = [guard for guard in q.needs if guard in self.failing]
        if missing:
            lines.append(Word("does not exist"))
            notes.append(f"It exists only where {' and '.join(missing)} holds, which fails here.")
        else:
            branch, met = in_force(tree, self.outcome.values)
            results = self._results(q, value, closes)
            if branch[0] != "n":
                inserted = self._inserted(branch, q.expression, value, in_si=not closes)
                lines += [inserted] if inserted != results[0] else []
            lines += results if lines[-1] != results[-1] else []
            conditions = {repr(condition): (condition, answer) for condition, answer in met}  # each once
            notes += [self._condition(*decided, not closes) for decided in list(conditions.values())[:CONDITIONS]]
            if not closes:
                notes.append("Numbers in SI: the units of this formula do not close.")
        symbol = Letter(q.symbol)
        return StepBlock(
            number=number,
            anchor=f"step-{q.name}",
            meaning=q.text or ("Part of a long formula" if q.kind == "helper" else q.name),
            name=q.name,
            source=q.source,
            symbol=symbol,
            equal=tuple(tuple(broken(line)) for line in lines),
            plain=(f"{plain(symbol)} = {plain(lines[0])}", *(f"= {plain(line)}" for line in lines[1:])),
            notes=tuple(notes),
        )

    def _closes(self, q: NamedQuantity) -> bool:
        """True if the units of a formula give the unit of its result, so that numbers carry theirs."""
        assert q.expression is not None
        dimension = dimension_of(q.expression, self.quantities)
        declared = parse_unit(q.unit).dimension if q.unit else None
        return dimension is not None and declared is not None and dimension == tuple(map(Fraction, declared))

    def _inserted(self, shown_tree: Expression, exact: Expression, value: float, in_si: bool) -> Layout:
        """Return a formula with as many digits of its numbers as its result needs."""
        digits = next((n for n in MORE_DIGITS if self._is_enough(exact, value, in_si, n)), MORE_DIGITS[-1])
        return Typesetter(self.quantities, self._leaf(in_si, digits), numeric=True).lay(shown_tree)

    def _leaf(self, in_si: bool, digits: int = STEP_DIGITS) -> ByNumber:
        return ByNumber(self.outcome.values, in_si, digits)

    def _is_enough(self, tree: Expression, value: float, in_si: bool, digits: int) -> bool:
        rounded = {name: self._rounded(self.quantities[name], in_si, digits) for name in names_in(tree)}
        approximate = value_of(tree, rounded)
        return not math.isfinite(value) or abs(approximate - value) <= ENOUGH * abs(value)

    def _rounded(self, q: NamedQuantity, in_si: bool, digits: int) -> float:
        """Return the SI value that a reader has who takes the printed number."""
        value = self.outcome.values[q.name] if q.value is None else q.value
        if not math.isfinite(value) or q.labels or q.is_text:
            return value
        unit = UnitIn.formula(q.unit, in_si)
        number = unit.shown(value, digits)
        read = float(number.number.typed())
        return read if unit.unit in ("", "SI", "K", "rad/s") else float(to_si(read, parse_unit(unit.unit)))

    def _results(self, q: NamedQuantity, value: float, closes: bool) -> list[Layout]:
        """Return the result; once more in the declared unit where another one comes out of the formula."""
        direct = UnitIn.formula(q.unit)
        results: list[Layout] = [Amount(direct.shown(value))]
        if q.unit and direct.unit not in ("", q.unit):
            results.append(Amount(in_step(value, q.unit)))
        if not closes and q.unit not in ("", "-"):
            return [Amount(UnitIn("SI").shown(value)), Amount(in_step(value, q.unit))]
        return results

    def _condition(self, condition: Expression, answer: bool, in_si: bool) -> Cell:
        numbers = Typesetter(self.quantities, self._leaf(in_si), numeric=True)
        tree = textbook(condition)
        words = "holds" if answer else "does not hold"
        return inline("Case in force: ", self.symbols.lay(tree), f" {words}: ", numbers.lay(tree))

    # -- limits --------------------------------------------------------------------------------

    def limit_condition(self, value: Expression, limit: Expression, sense: str) -> Layout:
        """Return a limit in symbols."""
        sides = [self.symbols.lay(textbook(side)) for side in (value, limit)]
        return Row((sides[0], Sign(SIGN_OF[sense]), sides[1]))

    def limit_numbers(self, verdict: LimitVerdict, sense: str, unit: str) -> Cell:
        """Return both sides of a limit in numbers, with enough digits to see that one is missed."""
        both = ((verdict.value, verdict.limit), (verdict.limit, verdict.value))
        sides = [Amount(apart(x, other, unit, verdict.holds)) for x, other in both]
        return inline(sides[0], f" {SIGN_OF[sense]} ", sides[1])  # apart, so that a narrow column breaks between them


def apart(value: float, other: float, unit: str, holds: bool) -> ShownQuantity:
    """Return a number with enough digits to see that it is not the other one; what a limit tolerates is none."""
    same = value == other or (holds and abs(value - other) <= TOLERANCE * max(abs(value), abs(other)))
    for digits in MORE_DIGITS:
        if same or in_its_unit(value, unit, digits) != in_its_unit(other, unit, digits):
            return in_its_unit(value, unit, digits)
    return in_its_unit(value, unit, MORE_DIGITS[-1])
