"""Dimensions of formulas: whether their units close, what the unit of a part is, which constant a number holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, TypeAlias

from synth.operations.record import Trait
from synth.operations.records import function_of
from synth.results.expression import Expression
from synth.units import parse_unit, si_text

if TYPE_CHECKING:
    from synth.results.calculation import NamedQuantity

Dimension: TypeAlias = tuple[Fraction, ...]  # exponents of kg, m, s, K, A

NONE: Dimension = (Fraction(0),) * 5
ANY: Dimension = ()  # of a column that a table does not have, in whose place a number stands


DENOMINATORS = (1, 2, 3, 4, 6, 7, 8, 9, 12, 16, 24, 32, 45, 64, 90, 180, 360)
POWERS_OF_PI = (0, 1, -1, 2, -2, 3)
LARGEST = 1000  # numerator: beyond it a fraction tells a reader no more than digits
SIMPLE = 100  # numerator times denominator, of what somebody multiplies a constant by
SHORT = 4  # digits of a number that somebody has written as it stands
EXACT = 1e-14  # relative, of a product that was computed before the trace


@dataclass(frozen=True)
class Fold:
    """A number as it was written: ``over`` times pi to a power over ``under``, and a constant to a power (0: none)."""

    over: int
    pi: int
    under: int
    constant: str = ""
    power: int = 0


def fraction_of(number: float) -> Fold | None:
    """Return a number as a fraction of whole numbers with a power of pi; None where it is none with small figures.

    Examples
    --------
    >>> fraction_of(2 / 3), fraction_of(0.13962634015954636)
    (Fold(over=2, pi=0, under=3, constant='', power=0), Fold(over=2, pi=1, under=45, constant='', power=0))
    """
    for pi in POWERS_OF_PI:
        for under in DENOMINATORS:
            over = abs(number) / math.pi**pi * under
            if 0.5 < over < LARGEST and abs(over - round(over)) <= EXACT * over:
                return Fold(round(over), pi, under)
    return None


def constant_in(number: float, constants: Iterable[NamedQuantity]) -> Fold | None:
    """Return the constant that a number of a formula is, or from which it was computed before the trace.

    Parameters
    ----------
    number : float
        As it stands in a formula; its sign is no matter.
    constants : list of NamedQuantity
        Constants of the family.

    Returns
    -------
    Fold or None
        n pi**k/d times the constant or its inverse; None where the number is one of its own.
    """
    size, known = abs(number), [c for c in constants if c.value]
    for c in known:
        if c.value is not None and size == abs(c.value):
            return Fold(1, 0, 1, c.name, 1)
    if size == 0 or not math.isfinite(size) or float(f"{size:.{SHORT}g}") == size or fraction_of(size):
        return None
    folds = []
    for c, power in product(known, (1, -1)):
        assert c.value is not None
        ratio = fraction_of(size / abs(c.value) ** power)
        if ratio and ratio.over * ratio.under <= SIMPLE:
            folds.append(Fold(ratio.over, ratio.pi, ratio.under, c.name, power))
    # A round constant is found in many a number: what is simplest was written.
    return min(folds, key=lambda f: (f.over * f.under, abs(f.pi), f.power < 0), default=None)


# Units in which numbers without a unit of their own are shown; torque and energy are one dimension and have one.
SHOWN_IN = ("mm", "mm2", "mm3", "mm4", "N", "N*m", "N/mm2", "N/mm", "W", "W/K", "J/K", "kg*m2", "kg", "s", "K", "m/s")
UNIT_OF: dict[tuple[int, ...], str] = {parse_unit(unit).dimension: unit for unit in SHOWN_IN}


def unit_for(dimension: Dimension) -> str:
    """Return a unit of a dimension, as people read it where there is one, otherwise in SI; nothing for odd powers."""
    if any(x.denominator > 1 for x in dimension):
        return ""
    exponents = tuple(int(x) for x in dimension)
    return UNIT_OF.get(exponents, "") or si_text(exponents)


class _Open(Exception):
    """The units of a formula do not close: it holds for SI alone."""


def dimension_of(tree: Expression, known: Mapping[str, NamedQuantity]) -> Dimension | None:
    """Return the dimension of a formula; None where its units do not close, so that it holds in SI alone.

    Parameters
    ----------
    tree : Expression
    known : mapping
        The quantities in it, by name. A number has the dimension of the constant in it (:func:`constant_in`), otherwise
        any that a sum asks for, and none in a product.
    """
    try:
        dimension = _Dimensions(known).of(tree)
    except _Open:
        return None
    return dimension or NONE


class _Dimensions:
    """Dimensions of trees; None is that of a number, which may be any but is none in a product."""

    def __init__(self, known: Mapping[str, NamedQuantity]) -> None:
        self.known = known
        self.constants = {q.name: q for q in known.values() if q.kind == "constant"}

    def of(self, tree: Expression) -> Dimension | None:
        """Return the dimension of a tree."""
        kind = tree[0]
        if kind == "q":
            return self._unit(self.known[tree[1]])
        if kind == "n":
            return self._number(tree[1])
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

    def _number(self, number: float) -> Dimension | None:
        fold = constant_in(number, self.constants.values())
        if fold is None:
            return None
        return tuple(fold.power * x for x in self._unit(self.constants[fold.constant]))

    @staticmethod
    def _unit(q: NamedQuantity) -> Dimension:
        if not q.unit and q.kind in ("part", "row"):
            return ANY
        if not q.unit:
            raise _Open
        return tuple(map(Fraction, parse_unit(q.unit).dimension))

    def _common(self, trees: Sequence[Expression]) -> Dimension | None:
        dimensions = set(map(self.of, trees)) - {None}
        definite = dimensions - {ANY}
        if len(definite) > 1:
            raise _Open
        return next(iter(definite or dimensions), None)

    def _product(self, over: Sequence[Expression], under: Sequence[Expression]) -> Dimension | None:
        total, any_known = list(NONE), False
        for trees, sign in ((over, 1), (under, -1)):
            for tree in trees:
                one = self.of(tree)
                if one == ANY:
                    return ANY
                if one is not None:
                    any_known = True
                    total = [a + sign * b for a, b in zip(total, one, strict=True)]
        return tuple(total) if any_known else None

    def _power(self, base: Expression, exponent: Expression) -> Dimension | None:
        of_base = self.of(base)
        if not of_base or of_base == NONE:
            if (self.of(exponent) or NONE) != NONE:
                raise _Open
            return of_base
        if exponent[0] != "n":
            raise _Open
        times = Fraction(exponent[1]).limit_denominator(1000)
        return tuple(x * times for x in of_base)

    def _function(self, name: str, arguments: Sequence[Expression]) -> Dimension | None:
        function = function_of(name)
        if Trait.KEEPS_UNIT in function.traits:
            return self._common(arguments)
        if function.exponent is not None:
            of_argument = self.of(arguments[0])
            return tuple(x * Fraction(function.exponent) for x in of_argument) if of_argument else of_argument
        if name == "sign":
            return NONE
        of_argument = self._common(arguments)
        if name != "atan2" and of_argument and of_argument != NONE:
            raise _Open
        return NONE
