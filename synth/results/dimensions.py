"""Dimensions of formulas: whether their units close, and what the unit of a part is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

from synth.results.expression import Expression
from synth.units import parse_unit

if TYPE_CHECKING:
    from synth.results.calculation import NamedQuantity

Dimension: TypeAlias = tuple[Fraction, ...]  # exponents of kg, m, s, K, A

NONE: Dimension = (Fraction(0),) * 5
SAME = ("min", "max", "hypot", "abs", "fmod", "copysign", "floor", "ceil")  # functions that keep the dimension


class _Open(Exception):
    """The units of a formula do not close: it holds for SI alone."""


def dimension_of(tree: Expression, known: Mapping[str, NamedQuantity]) -> Dimension | None:
    """Return the dimension of a formula; None where its units do not close, so that it holds in SI alone.

    Parameters
    ----------
    tree : Expression
    known : mapping
        The quantities in it, by name. A number has the dimension of a constant of the same value, otherwise any that
        a sum asks for, and none in a product.
    """
    try:
        found = _Dimensions(known).of(tree)
    except _Open:
        return None
    return NONE if found is None else found


class _Dimensions:
    """Dimensions of trees; None is that of a number, which may be any."""

    def __init__(self, known: Mapping[str, NamedQuantity]) -> None:
        self.known = known
        self.constants = {q.value: q for q in known.values() if q.kind == "constant"}

    def of(self, tree: Expression) -> Dimension | None:
        """Return the dimension of a tree."""
        kind = tree[0]
        if kind == "q":
            return self._unit(self.known[tree[1]])
        if kind == "n":
            constant = self.constants.get(tree[1])
            return None if constant is None else self._unit(constant)
        if kind == "+":
            return self._common(tree[1])
        if kind == "*":
            return self._product(tree[1], tree[2])
        if kind == "^":
            return self._power(tree[1], tree[2])
        if kind == "neg":
            return self.of(tree[1])
        if kind == "if":
            return self._common(tree[2:])
        if kind == "f":
            return self._function(tree[1], tree[2])
        return NONE  # a condition

    @staticmethod
    def _unit(q: NamedQuantity) -> Dimension:
        if not q.unit:
            raise _Open
        return tuple(map(Fraction, parse_unit(q.unit).dimension))

    def _common(self, trees: Sequence[Expression]) -> Dimension | None:
        found = {x for x in map(self.of, trees) if x is not None}
        if len(found) > 1:
            raise _Open
        return next(iter(found), None)

    def _product(self, over: Sequence[Expression], under: Sequence[Expression]) -> Dimension | None:
        total, any_known = list(NONE), False
        for trees, sign in ((over, 1), (under, -1)):
            for tree in trees:
                one = self.of(tree)
                if one is not None:
                    any_known = True
                    total = [a + sign * b for a, b in zip(total, one, strict=True)]
        return tuple(total) if any_known else None

    def _power(self, base: Expression, exponent: Expression) -> Dimension | None:
        own = self.of(base)
        if own is None or own == NONE:
            if (self.of(exponent) or NONE) != NONE:
                raise _Open
            return own
        if exponent[0] != "n":
            raise _Open
        times = Fraction(exponent[1]).limit_denominator(1000)
        return tuple(x * times for x in own)

    def _function(self, name: str, arguments: Sequence[Expression]) -> Dimension | None:
        if name == "sqrt":
            own = self.of(arguments[0])
            return None if own is None else tuple(x / 2 for x in own)
        if name in SAME:
            return self._common(arguments)
        if name == "sign":
            return NONE
        own = self._common(arguments)
        if name != "atan2" and own is not None and own != NONE:
            raise _Open
        return NONE
