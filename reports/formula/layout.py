"""The layout of formulas: trees of what stands beside, over and above each other, whatever writes it down.

Brackets, fractions of pi, signs and what counts as textbook form are decided here, once for all writers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from synth.operations.record import Trait
from synth.operations.records import function_of
from synth.results.calculation import NamedQuantity
from synth.results.dimensions import EXACT, Fold, constant_in, dimension_of, fraction_of, unit_for
from synth.results.expression import Expression, parts_of, with_parts
from synth.text.numbers import FULL_DIGITS, STEP_DIGITS, shown

from ..numbers import ShownQuantity, UnitIn, in_its_unit

MOST_OVER = 36  # numerator of a fraction that is shown as one
SHORT_DECIMAL = 4  # digits of a number that is shown as a decimal though it is a fraction
NEGLIGIBLE = 1e-9  # an added number that keeps formulas away from dividing by zero; left out for readers


@dataclass(frozen=True)
class Letter:
    """A symbol of a quantity, as declared."""

    symbol: str


@dataclass(frozen=True)
class Amount:
    """A number with its unit."""

    shown: ShownQuantity


@dataclass(frozen=True)
class Word:
    """An upright word: the name of a function, a label."""

    text: str


@dataclass(frozen=True)
class Sign:
    """An operator between others, as a character."""

    text: str


@dataclass(frozen=True)
class Row:
    """What stands beside each other."""

    items: tuple[Layout, ...]


@dataclass(frozen=True)
class Fraction:
    """What stands over and under a bar."""

    over: Layout
    under: Layout


@dataclass(frozen=True)
class Power:
    """A base with what stands above it."""

    base: Layout
    exponent: Layout


@dataclass(frozen=True)
class Root:
    """A square root."""

    inner: Layout


@dataclass(frozen=True)
class Fence:
    """What stands in brackets, or between bars."""

    inner: Layout
    bars: bool = False


@dataclass(frozen=True)
class Call:
    """A function of arguments."""

    name: str
    arguments: tuple[Layout, ...]


@dataclass(frozen=True)
class Cases:
    """Values, each with the condition under which it counts; the last may have none."""

    rows: tuple[tuple[Layout, Layout | None], ...]


Layout: TypeAlias = Letter | Amount | Word | Sign | Row | Fraction | Power | Root | Fence | Call | Cases
Leaf: TypeAlias = Callable[[NamedQuantity], Layout]

PLUS, MINUS, TIMES, SPACE = Sign("+"), Sign("−"), Sign("·"), Sign("\u2009")
COMPARED = {"<": "<", "<=": "≤", "==": "=", "!=": "≠", "and": "and", "or": "or"}
SUM, TERM, FACTOR, BASE = range(4)  # how strongly what stands around a formula holds it together


def textbook(tree: Expression) -> Expression:
    """Return a tree in the form of textbooks: what keeps digits on computers is written as it is meant.

    ``expm1(x)`` is e^x - 1, ``log1p(x)`` is ln(1 + x), ``exp(a ln(1 + x))`` is (1 + x)^a, and numbers that only keep a
    sum away from zero are left out.
    """
    tree = with_parts(tree, [textbook(part) for part in parts_of(tree)])
    if tree[0] == "+":
        kept = [t for t in tree[1] if not (t[0] == "n" and 0 < abs(t[1]) <= NEGLIGIBLE)] or tree[1]
        return kept[0] if len(kept) == 1 else ["+", kept]
    if tree[0] == "^" and tree[1][0] == "neg" and tree[2][0] == "n" and tree[2][1] % 2 == 0:
        return ["^", tree[1][1], tree[2]]
    if tree[0] == "neg" and tree[1][0] == "+":
        return _turned(tree[1])
    if tree[0] == "neg" and tree[1][0] == "*":
        return _sign_in_factor(tree)
    if tree[0] != "f":
        return tree
    name, inner, outer = function_of(tree[1]).plain or (tree[1], 0.0, 0.0)
    arguments = [["+", [["n", inner], *_terms(tree[2][0])]]] if inner else tree[2]
    result = _exponential(arguments[0]) if name == "exp" else ["f", name, arguments]
    return ["+", [result, ["n", outer]]] if outer else result


def negligible_in(tree: Expression) -> bool:
    """True if a tree has a number that readers are not shown."""
    if tree[0] == "+" and any(t[0] == "n" and 0 < abs(t[1]) <= NEGLIGIBLE for t in tree[1]):
        return True
    return any(map(negligible_in, parts_of(tree)))


def _terms(tree: Expression) -> list[Expression]:
    return list(tree[1]) if tree[0] == "+" else [tree]


def _turned(total: Expression) -> Expression:
    """Return a sum with the other sign, a positive term first: -(e^x - 1) is 1 - e^x."""
    terms: list[Expression] = [t[1] if t[0] == "neg" else ["n", -t[1]] if t[0] == "n" else ["neg", t] for t in total[1]]
    first = next((k for k, t in enumerate(terms) if t[0] != "neg" and not (t[0] == "n" and t[1] < 0)), None)
    if first is None:
        return ["neg", total]
    return ["+", [terms[first], *terms[:first], *terms[first + 1 :]]]


def _sign_in_factor(tree: Expression) -> Expression:
    """Return minus a product with the sign in a factor that is better read so: -(e^x - 1)/S is (1 - e^x)/S."""
    over = tree[1][1]
    for k, factor in enumerate(over):
        if factor[0] == "+" and len(factor[1]) == 2 and (factor[1][1][0] == "neg" or factor[1][1] == ["n", -1.0]):
            return ["*", [*over[:k], _turned(factor), *over[k + 1 :]], tree[1][2]]
    return tree


def _exponential(x: Expression) -> Expression:
    """Return e^x, or the power that it is: exp(a ln b) is b^a."""
    sign, inner = (True, x[1]) if x[0] == "neg" else (False, x)
    factors, under = (inner[1], inner[2]) if inner[0] == "*" else ([inner], [])
    for k, factor in enumerate(factors):
        if factor[0] == "f" and factor[1] == "ln":
            others = [*factors[:k], *factors[k + 1 :]]
            power: Expression = ["*", others or [["n", 1.0]], under] if under or len(others) != 1 else others[0]
            return ["^", factor[2][0], ["neg", power] if sign else power]
    return ["f", "exp", [x]]


class Typesetter:
    """Lays out trees; what a quantity looks like is decided by a function.

    Parameters
    ----------
    quantities : mapping
        By name.
    leaf : callable
        Returns what stands for a quantity: its symbol, or its number.
    numeric : bool
        Whether numbers stand beside each other, so that products need a sign.
    number : callable, optional
        Returns what stands for a number without a unit.
    """

    def __init__(self, quantities: Mapping[str, NamedQuantity], leaf: Leaf, numeric: bool) -> None:
        self.quantities, self.leaf, self.numeric = quantities, leaf, numeric
        self.constants = {name: q for name, q in quantities.items() if q.kind == "constant"}

    def lay(self, tree: Expression, around: int = SUM) -> Layout:
        """Return the layout of a tree; ``around`` tells how strongly what stands around it holds together."""
        kind = tree[0]
        if kind == "q":
            return self._quantity(tree[1], around)
        if kind == "n":
            return self._number(float(tree[1]), around)
        if kind == "if":
            return self._cases(tree)
        if kind == "f":
            return self._function(tree[1], tree[2])
        if kind == "not":
            return Row((Word("not"), Fence(self.lay(tree[1]))))
        if kind in COMPARED:
            return self._compared(kind, tree[1], tree[2])
        laid: dict[str, Callable[[Expression, int], Layout]] = {
            "+": self._sum,
            "*": self._product,
            "^": self._power,
            "neg": self._negated,
        }
        return laid[kind](tree, around)

    def _quantity(self, name: str, around: int) -> Layout:
        leaf = self.leaf(self.quantities[name])
        if isinstance(leaf, Amount):
            number = leaf.shown.number
            negative, unit = bool(number.sign), bool(leaf.shown.unit) or bool(number.power)
            if (negative and around > SUM) or (unit and around >= BASE):
                return Fence(leaf)
        return leaf

    def _number(self, number: float, around: int, unit: str = "") -> Layout:
        size: Layout = self._size(abs(number), around, unit)
        if number >= 0 or math.isnan(number):
            return size
        signed = Row((MINUS, size))
        return Fence(signed) if around > SUM else signed

    def _size(self, number: float, around: int, unit: str = "") -> Layout:
        square = round(number**2) if 1 < number < 10 else 0
        if square and abs(number**2 - square) <= EXACT * square and not number.is_integer():
            return Root(_integer(square))
        fold = constant_in(number, self.constants.values()) or _readable_fraction(number)
        if fold is None:
            return Amount(_in_unit(number, unit))
        top: list[Layout] = [] if fold.over == 1 and (fold.pi > 0 or fold.power > 0) else [_integer(fold.over)]
        bottom: list[Layout] = [] if fold.under == 1 else [_integer(fold.under)]
        if fold.pi:
            (top if fold.pi > 0 else bottom).append(_raised(Letter("pi"), abs(fold.pi)))
        if fold.constant:
            (top if fold.power > 0 else bottom).append(self.leaf(self.constants[fold.constant]))
        over = self._juxtaposed(top or [_integer(1)])
        if not bottom:
            return over
        fraction = Fraction(over, self._juxtaposed(bottom))
        return Fence(fraction) if around >= BASE else fraction

    def _juxtaposed(self, items: Sequence[Layout]) -> Layout:
        if len(items) == 1:
            return items[0]
        row: list[Layout] = []
        for item in items:
            row += [TIMES if self.numeric or isinstance(item, Amount) else SPACE, item] if row else [item]
        return Row(tuple(row))

    def _common_unit(self, trees: Sequence[Expression]) -> str:
        """Return the unit that bare numbers beside quantities are meant in; nothing where they are bare indeed."""
        numbers = any(t[0] == "n" and t[1] != 0 for t in trees)
        others = [t for t in trees if t[0] != "n"]
        if not numbers or not others:
            return ""
        dimension = dimension_of(["+", others], self.quantities)
        return "" if dimension is None or not any(dimension) else unit_for(dimension)

    def _sum(self, tree: Expression, around: int) -> Layout:
        row: list[Layout] = []
        unit = self._common_unit(tree[1])
        for term in tree[1]:
            if term[0] == "neg":
                row += [MINUS, self.lay(term[1], TERM)]
            elif term[0] == "n":
                sign = [MINUS] if term[1] < 0 else [PLUS] if row else []
                row += [*sign, self._number(abs(term[1]), TERM, unit)]
            else:
                row += [PLUS, self.lay(term, TERM)] if row else [self.lay(term, SUM)]
        laid = Row(tuple(row))
        return Fence(laid) if around > SUM else laid

    def _negated(self, tree: Expression, around: int) -> Layout:
        laid = Row((MINUS, self.lay(tree[1], TERM)))
        return Fence(laid) if around > SUM else laid

    def _product(self, tree: Expression, around: int) -> Layout:
        over = self._factors(tree[1], in_fraction=bool(tree[2]))
        laid: Layout = over
        if tree[2]:
            laid = Fraction(over, self._factors(tree[2], in_fraction=True))
        return Fence(laid) if around >= BASE else laid

    def _factors(self, factors: Sequence[Expression], in_fraction: bool) -> Layout:
        if in_fraction and len(factors) == 1:
            return self.lay(factors[0])
        return self._juxtaposed([self.lay(factor, FACTOR) for factor in factors])

    def _power(self, tree: Expression, around: int) -> Layout:
        base, exponent = tree[1], tree[2]
        if exponent == ["n", 0.5]:
            return Root(self.lay(base))
        if exponent[0] == "n" and exponent[1] < 0 and float(exponent[1]).is_integer():
            under = base if exponent[1] == -1 else ["^", base, ["n", -exponent[1]]]
            return self._product(["*", [["n", 1.0]], [under]], around)
        laid = self.lay(base, BASE)
        if isinstance(laid, (Call, Root, Power, Fraction, Row, Cases)):
            laid = Fence(laid)
        return Power(laid, self.lay(exponent))

    def _alike(self, trees: Sequence[Expression]) -> list[Layout]:
        """Return trees that are compared, bare numbers among them in the unit of the others."""
        unit = self._common_unit(trees)
        return [self._number(float(t[1]), SUM, unit) if t[0] == "n" else self.lay(t) for t in trees]

    def _function(self, name: str, arguments: Sequence[Expression]) -> Layout:
        function = function_of(name)
        laid = tuple(self._alike(arguments) if Trait.KEEPS_UNIT in function.traits else map(self.lay, arguments))
        if function.exponent == 0.5:
            return Root(laid[0])
        if name == "abs":
            return Fence(laid[0], bars=True)
        if name == "exp":
            return Power(Word("e"), laid[0])
        return Call(name, laid)

    def _cases(self, tree: Expression) -> Layout:
        rows: list[tuple[Layout, Layout | None]] = []
        while tree[0] == "if":
            rows.append((self.lay(tree[2]), self.lay(tree[1])))
            tree = tree[3]
        rows.append((self.lay(tree), None))
        return Cases(tuple(rows))

    def _compared(self, kind: str, a: Expression, b: Expression) -> Layout:
        word = self._word(a, b) or self._word(b, a)
        if word is not None:
            quantity = a if a[0] == "q" else b
            return Row((self.lay(quantity), Sign(COMPARED[kind]), Word(word)))
        joins = kind in ("and", "or")
        sides = [
            Fence(self.lay(x)) if joins and x[0] in ("and", "or") and x[0] != kind else self.lay(x) for x in (a, b)
        ]
        return Row((sides[0], Word(kind) if joins else Sign(COMPARED[kind]), sides[1]))

    def _word(self, quantity: Expression, number: Expression) -> str | None:
        """Meaning of a number for a quantity that stands for words."""
        if quantity[0] != "q" or number[0] != "n":
            return None
        return self.quantities[quantity[1]].word(number[1])


def _readable_fraction(number: float) -> Fold | None:
    """Number as a fraction, or with a power of pi, where that is more readable than its digits."""
    fold = fraction_of(number) if math.isfinite(number) and number > 0 else None
    if fold is None or (fold.pi == 0 and (fold.under == 1 or _is_short(number))) or fold.over > MOST_OVER:
        return None
    return fold


def _is_short(number: float) -> bool:
    """True if a number is best written as a decimal."""
    return len(f"{number:.15g}".replace(".", "").strip("0")) <= SHORT_DECIMAL


def _in_unit(number: float, unit: str) -> ShownQuantity:
    """Return a number that stands beside quantities with a unit, in that unit."""
    return in_its_unit(number, unit, FULL_DIGITS)


def _integer(number: int) -> Layout:
    return Amount(ShownQuantity(shown(number)))


def _raised(base: Layout, power: int) -> Layout:
    return base if power == 1 else Power(base, _integer(power))


# ---- leaves ----------------------------------------------------------------------------------------------------------


def by_symbol(q: NamedQuantity) -> Layout:
    """Symbol of a quantity in a formula."""
    return Letter(q.symbol)


@dataclass(frozen=True)
class ByNumber:
    """What stands for a quantity where numbers are inserted: its value in its own unit, or in SI."""

    values: Mapping[str, float]
    in_si: bool = False
    digits: int = STEP_DIGITS

    def __call__(self, q: NamedQuantity) -> Layout:
        """Return the number of a quantity, or the word that it stands for."""
        value = q.value if q.value is not None else self.values[q.name]
        if q.labels or q.is_text:
            return Word(q.word(value) or "another")
        return Amount(UnitIn.formula(q.unit, self.in_si).shown(value, self.digits))
