"""Formulas as small trees of plain JSON, which reports print and anything can compute again.

A tree is a list whose first entry says what it is:

====================================  ==============================================================================
``["q", name]``                       a named quantity
``["n", number]``                     a number in SI
``["+", [terms]]``                    a sum; a term to be taken off is ``["neg", x]``
``["*", [over], [under]]``            a product of what stands over the bar, divided by that of what stands under it
``["^", base, exponent]``             a power
``["neg", x]``                        minus x
``["f", function, [arguments]]``      one of :data:`FUNCTIONS`
``["if", condition, yes, no]``        one of two, both of which are always computable or not-a-number
``["<", a, b]``                       a comparison, also ``<= == !=``; conditions are joined by ``and`` and ``or``
``["not", a]``                        a condition turned round
====================================  ==============================================================================
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

from synth.operations.record import Domain, Trait
from synth.operations.records import BY_NAME, BY_TEXT

Expression: TypeAlias = list[Any]

COMPARISONS = {
    o.text: o.scalar for o in BY_NAME.values() if o.scalar is not None and Trait.TRUTH in o.traits and o.arity == 2
}
FUNCTIONS = {name: o.scalar for name, o in BY_TEXT.items() if o.scalar is not None}


def parts_of(tree: Expression) -> list[Expression]:
    """Return the trees that a tree is made of, in order."""
    kind = tree[0]
    if kind in ("q", "n"):
        return []
    if kind == "+":
        return list(tree[1])
    if kind == "*":
        return [*tree[1], *tree[2]]
    if kind == "f":
        return list(tree[2])
    return list(tree[1:])


def with_parts(tree: Expression, parts: list[Expression]) -> Expression:
    """Return the same tree of other parts, given in the order of :func:`parts_of`."""
    kind = tree[0]
    if kind in ("q", "n"):
        return tree
    if kind == "+":
        return ["+", parts]
    if kind == "*":
        return ["*", parts[: len(tree[1])], parts[len(tree[1]) :]]
    if kind == "f":
        return ["f", tree[1], parts]
    return [kind, *parts]


def names_in(tree: Expression) -> Iterator[str]:
    """Yield the names of the quantities in a tree, each time that one stands there."""
    if tree[0] == "q":
        yield tree[1]
    for part in parts_of(tree):
        yield from names_in(part)


def size_of(tree: Expression) -> int:
    """Number of quantities and numbers in a tree."""
    return 1 if tree[0] in ("q", "n") else sum(map(size_of, parts_of(tree)))


def value_of(tree: Expression, values: Mapping[str, float]) -> float:
    """Value of a tree; not-a-number where it does not exist, infinite where a number is divided by zero.

    Parameters
    ----------
    tree : Expression
    values : mapping
        Quantity -> SI value.
    """
    kind = tree[0]
    if kind == "n":
        return float(tree[1])
    if kind == "q":
        return float(values[tree[1]])
    if kind == "if":
        return value_of(tree[2] if value_of(tree[1], values) else tree[3], values)
    numbers = [value_of(part, values) for part in parts_of(tree)]
    if kind == "*":
        over, under = math.prod(numbers[: len(tree[1])]), math.prod(numbers[len(tree[1]) :])
        return _divided(over, under)
    if kind == "neg":
        return -numbers[0]
    if kind == "not":
        return float(not numbers[0])
    if kind in COMPARISONS:
        return float(COMPARISONS[kind](*numbers))
    try:
        if kind == "+":
            return math.fsum(numbers)
        if kind == "^":
            return _power(*numbers)
        return float(FUNCTIONS[tree[1]](*numbers))
    except (ValueError, OverflowError):
        return _beyond(tree, numbers)


def _divided(over: float, under: float) -> float:
    if under == 0.0:
        return math.nan if over == 0.0 or math.isnan(over) else math.copysign(math.inf, over) * math.copysign(1, under)
    return over / under


def _power(base: float, exponent: float) -> float:
    if base == 0.0 and exponent < 0:
        return math.inf
    return math.pow(base, exponent)


def _beyond(tree: Expression, numbers: list[float]) -> float:
    """Result of float arithmetic where ``math`` refuses: infinity, or not-a-number."""
    if any(map(math.isnan, numbers)):
        return math.nan
    if tree[0] != "f":
        return math.inf if tree[0] == "^" and numbers[0] > 0 else math.nan
    function = BY_TEXT[tree[1]]
    if function.domain == Domain(numbers[0], math.inf, open=True):  # a logarithm of nothing
        return -math.inf
    if function.finite is None:
        return math.nan
    return math.copysign(math.inf, numbers[0]) if Trait.KEEPS_SIGN in function.traits else math.inf


def in_force(
    tree: Expression, values: Mapping[str, float], met: list[tuple[Expression, bool]] | None = None
) -> tuple[Expression, list[tuple[Expression, bool]]]:
    """Return a tree with the branch in place of each ``if``, and the conditions that decided, each with its answer.

    Parameters
    ----------
    tree : Expression
    values : mapping
        Quantity -> SI value.
    met : list, optional
        Takes further conditions.
    """
    met = [] if met is None else met
    if tree[0] == "if":
        answer = bool(value_of(tree[1], values))
        met.append((tree[1], answer))
        return in_force(tree[2] if answer else tree[3], values, met)
    return with_parts(tree, [in_force(part, values, met)[0] for part in parts_of(tree)]), met


def simplified_product(over: list[Expression], under: list[Expression]) -> Expression:
    """Return a product with products in it resolved, equal factors as powers, and numbers in front.

    Numbers are joined only where that is exact, so that what is shown computes the same.
    """
    joined = _Product()
    for factor in over:
        joined.take(factor, 1)
    for factor in under:
        joined.take(factor, -1)
    return joined.tree()


class _Product:
    """Factors of a product in the order in which they are written."""

    def __init__(self) -> None:
        self.numbers: dict[int, list[float]] = {1: [], -1: []}
        self.factors: dict[int, list[tuple[Expression, float]]] = {1: [], -1: []}
        self.sign = 1.0

    def take(self, tree: Expression, side: int) -> None:
        """Multiply by a tree (side 1) or divide by it (side -1)."""
        kind = tree[0]
        if kind == "*":
            for factor in tree[1]:
                self.take(factor, side)
            for factor in tree[2]:
                self.take(factor, -side)
        elif kind == "neg":
            self.sign = -self.sign
            self.take(tree[1], side)
        elif kind == "n" and math.isfinite(tree[1]) and tree[1] != 0:
            self.sign *= math.copysign(1.0, tree[1])
            self.numbers[side].append(abs(tree[1]))
        else:
            power = kind == "^" and tree[2][0] == "n" and float(tree[2][1]).is_integer() and tree[2][1] > 0
            base, exponent = (tree[1], float(tree[2][1])) if power else (tree, 1.0)
            for position, (known, times) in enumerate(self.factors[side]):
                if known == base:
                    self.factors[side][position] = (known, times + exponent)
                    return
            self.factors[side].append((base, exponent))

    def tree(self) -> Expression:
        """Return the product."""
        over, under = _together(self.numbers[1]), _together(self.numbers[-1])
        if len(over) == len(under) == 1 and over[0].is_integer() and under[0].is_integer():
            shared = math.gcd(int(over[0]), int(under[0]))  # 16/(4 x) is 4/x
            over, under = [over[0] / shared], [under[0] / shared]
        top: list[Expression] = [["n", x] for x in over if x != 1] + [_raised(*x) for x in self.factors[1]]
        bottom: list[Expression] = [["n", x] for x in under if x != 1] + [_raised(*x) for x in self.factors[-1]]
        if bottom or len(top) > 1:
            result: Expression = ["*", top or [["n", 1.0]], bottom]
        else:
            result = top[0] if top else ["n", 1.0]
        if self.sign > 0:
            return result
        return ["n", -result[1]] if result[0] == "n" else ["neg", result]


def _raised(base: Expression, exponent: float) -> Expression:
    return base if exponent == 1 else ["^", base, ["n", exponent]]


def _together(numbers: list[float]) -> list[float]:
    """Return numbers of a product as one where that is exact, otherwise as they are written."""
    integers = [x for x in numbers if x.is_integer() and x < 2**20]
    product = math.prod(integers)
    others = [x for x in numbers if x not in integers]
    if product >= 2**53:
        return numbers
    return ([float(product)] if integers else []) + others


def simplified_sum(terms: list[tuple[Expression, int]]) -> Expression:
    """Return a sum with sums in it resolved, and a term in front that is not taken off where there is one.

    Parameters
    ----------
    terms : list of (Expression, +1 or -1)
    """
    flat: list[Expression] = []

    def take(tree: Expression, sign: int) -> None:
        if tree[0] == "+":
            for term in tree[1]:
                take(term, sign)
        elif tree[0] == "neg":
            take(tree[1], -sign)
        elif tree[0] == "n":
            flat.append(["n", sign * tree[1]])
        else:
            flat.append(tree if sign > 0 else ["neg", tree])

    for term, sign in terms:
        take(term, sign)
    first = next((k for k, t in enumerate(flat) if t[0] != "neg" and not (t[0] == "n" and t[1] < 0)), 0)
    flat.insert(0, flat.pop(first))
    return ["+", flat]
