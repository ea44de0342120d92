"""Interval arithmetic of the proof: own code, shared with no bound of the search."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import ClassVar, TypeAlias

import casadi as ca

from synth.model.program import COMPARISONS, OP_SELECT, OP_SPECIAL, Node, Program
from synth.proof.tape import Expr, Ref, Tape, sign_of

Pair: TypeAlias = tuple[Expr, Expr]

INF = math.inf
DISTINCT = 1e-6  # a value this far from zero, in relation to its largest, has a useful logarithm
ROUNDING = 2e-15  # of the larger term of a sum that may cancel
ZERO: Pair = (0.0, 0.0)
ANYTHING: Pair = (-INF, INF)


def is_thin(pair: Pair) -> bool:
    """True if both ends are the same value."""
    low, high = pair
    return low is high or (not isinstance(low, Ref) and not isinstance(high, Ref) and low == high)


class Arithmetic:
    """Interval arithmetic on a tape; where signs are known the corner is known beforehand."""

    def __init__(self, tape: Tape) -> None:
        self.tape = tape
        self.do = tape.do

    def negative(self, a: Pair) -> Pair:
        """Return -a."""
        low = self.do("negative", a[1])
        return (low, low) if is_thin(a) else (low, self.do("negative", a[0]))

    def add(self, a: Pair, b: Pair) -> Pair:
        """Return a + b."""
        low = self.do("add", a[0], b[0])
        return (low, low) if is_thin(a) and is_thin(b) else (low, self.do("add", a[1], b[1]))

    def subtract(self, a: Pair, b: Pair) -> Pair:
        """Return a - b."""
        low = self.do("subtract", a[0], b[1])
        return (low, low) if is_thin(a) and is_thin(b) else (low, self.do("subtract", a[1], b[0]))

    def multiply(self, a: Pair, b: Pair) -> Pair:
        """Return a b."""
        if ZERO in (a, b):
            return ZERO
        if is_thin(a) and is_thin(b):
            product = self.do("multiply", a[0], b[0])
            return product, product
        if not self._sign_of_pair(b):
            a, b = b, a
        first, second = self._sign_of_pair(a), self._sign_of_pair(b)
        if not second:
            return self.hull_of([self.do("multiply", x, y) for x in dict.fromkeys(a) for y in dict.fromkeys(b)])
        low, high = a if second > 0 else a[::-1]  # the ends of a that make the product small and large
        if first:
            small, large = b if first > 0 else b[::-1]
            return self.do("multiply", low, small), self.do("multiply", high, large)
        return (
            self.do("minimum", self.do("multiply", low, b[0]), self.do("multiply", low, b[1])),
            self.do("maximum", self.do("multiply", high, b[0]), self.do("multiply", high, b[1])),
        )

    @staticmethod
    def _sign_of_pair(a: Pair) -> int:
        return 1 if sign_of(a[0]) > 0 else -1 if sign_of(a[1]) < 0 else 0

    def divide(self, a: Pair, b: Pair) -> Pair:
        """Return a/b; anything where b may be zero."""
        do = self.do
        if is_thin(b):
            if is_thin(a):
                quotient = do("divide", a[0], b[0])
                return quotient, quotient
            inverse = do("divide", 1.0, b[0])
            return self.multiply(a, (inverse, inverse))
        if sign_of(b[0]) > 0 and sign_of(a[0]) > 0:
            return do("divide", a[0], b[1]), do("divide", a[1], self._end_at_zero(b[0]))
        if sign_of(b[0]) > 0:
            return self.multiply(a, (do("divide", 1.0, b[1]), do("divide", 1.0, self._end_at_zero(b[0]))))
        if isinstance(b[1], Ref) and sign_of(b[1]) < 0:
            least = do("divide", -1.0, self._end_at_zero(b[1]))
            return self.multiply(a, (least, do("divide", 1.0, b[0])))
        # Not-a-number compares as false: such ends count as having zero between them. Zero itself may be an end: what
        # is divided by it grows without bound to one side, whichever zero it is.
        where = self.tape.where
        apart = self._either_of(do("less_equal", 0.0, b[0]), do("less_equal", b[1], 0.0))
        if apart is False:
            return ANYTHING
        least, most = (
            where(do("equal", b[1], 0.0), -INF, do("divide", 1.0, b[1])),
            where(do("equal", b[0], 0.0), INF, do("divide", 1.0, b[0])),
        )
        low, high = self.multiply(a, (least, most))
        return where(apart, low, -INF), where(apart, high, INF)

    def _end_at_zero(self, end: Expr) -> Expr:
        """Return the size of the end next to zero: divided by zero of either sign it must not change sides."""
        return self.do("absolute", end)

    def _either_of(self, a: Expr, b: Expr) -> Expr:
        return self.do("logical_not", self.do("logical_and", self.do("logical_not", a), self.do("logical_not", b)))

    def _apart_from_zero(self, b: Pair) -> Pair:
        return self.do("less", 0.0, b[0]), self.do("less", b[1], 0.0)

    def square(self, a: Pair) -> Pair:
        """Return a squared."""
        if is_thin(a):
            return self.multiply(a, a)
        size = self.size(a)
        return self.do("multiply", size[0], size[0]), self.do("multiply", size[1], size[1])

    def size(self, a: Pair) -> Pair:
        """Return |a|."""
        if is_thin(a):
            size = self.do("absolute", a[0])
            return size, size
        if sign_of(a[0]) > 0:
            return a
        negative = self.negative(a)
        if sign_of(a[1]) < 0:
            return negative
        least = self.do("maximum", 0.0, self.do("maximum", a[0], negative[0]))
        return least, self.do("maximum", a[1], negative[1])

    def largest(self, a: Pair) -> Expr:
        """Return the largest |a|."""
        return self.size(a)[1]

    def rising(self, name: str, a: Pair) -> Pair:
        """Return a function that rises."""
        low = self.do(name, a[0])
        return (low, low) if is_thin(a) else (low, self.do(name, a[1]))

    def hull(self, a: Pair, b: Pair) -> Pair:
        """Return the least range that holds both."""
        return self.do("minimum", a[0], b[0]), self.do("maximum", a[1], b[1])

    def hull_of(self, values: Sequence[Expr]) -> Pair:
        """Return the least range that holds all values."""
        low = high = values[0]
        for x in values[1:]:
            low, high = self.do("minimum", low, x), self.do("maximum", high, x)
        return low, high

    def meet(self, a: Pair, b: Pair) -> Pair:
        """Intersection of two ranges; an end that is not known does not count."""
        return self.do("fmax", a[0], b[0]), self.do("fmin", a[1], b[1])

    def choose(self, masks: Pair, a: Pair, b: Pair) -> Pair:
        """Return a where the first mask holds, b where the second one does, else the hull of both."""
        if a[0] is b[0] and a[1] is b[1]:
            return a
        yes, no = masks
        if yes is True or no is True:
            return a if yes is True else b
        where, both = self.tape.where, self.hull(a, b)
        return where(yes, a[0], where(no, b[0], both[0])), where(yes, a[1], where(no, b[1], both[1]))

    def truth(self, a: Pair) -> Pair:
        """Return masks: surely true (not zero), surely false (zero)."""
        do = self.do
        if is_thin(a):
            no = do("equal", a[0], 0.0)
            return do("logical_not", no), no
        positive, negative = self._apart_from_zero(a)
        return self._either_of(positive, negative), do("logical_and", do("equal", a[0], 0.0), do("equal", a[1], 0.0))

    def flags(self, yes: Expr, no: Expr) -> Pair:
        """Return a truth value as a range within 0 and 1."""
        return self.tape.number(yes), self.tape.number(self.do("logical_not", no))


RISING = {
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_SQRT: "sqrt",
    ca.OP_LOG1P: "log1p",
    ca.OP_EXPM1: "expm1",
    ca.OP_ATAN: "arctan",
    ca.OP_SINH: "sinh",
    ca.OP_TANH: "tanh",
    ca.OP_ASINH: "arcsinh",
    ca.OP_ACOSH: "arccosh",
    ca.OP_ATANH: "arctanh",
    ca.OP_ERF: "erf",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceil",
    ca.OP_SIGN: "sign",
}
# Least argument for which they are defined.
DEFINED_FROM = {ca.OP_SQRT: 0.0, ca.OP_LOG: 0.0, ca.OP_LOG1P: -1.0, ca.OP_ACOSH: 1.0}
# Their value is one of finitely many or jumps: the center is the whole range, and there is no slope.
JUMPING = COMPARISONS | {ca.OP_FLOOR, ca.OP_CEIL, ca.OP_SIGN}


class Ranges(Arithmetic):
    """The range of an instruction from the ranges of what it reads."""

    def __init__(self, tape: Tape, program: Program) -> None:
        super().__init__(tape)
        self.program = program

    def range_of(self, node: Node, r: Sequence[Pair]) -> Pair:
        """Return the range of one instruction.

        Parameters
        ----------
        node : Node
        r : list of pairs
            Ranges of its arguments.
        """
        op = node.op
        rule = self._RULES.get(op)
        if rule is not None:
            return rule(self, *r)
        if op in DEFINED_FROM:
            # Where it is not defined nothing is feasible: what counts of the argument is within the domain.
            return self.rising(RISING[op], self._at_least(DEFINED_FROM[op], r[0]))
        if op in RISING:
            return self.rising(RISING[op], r[0])
        if op == ca.OP_MUL:
            return self.square(r[0]) if node.args[0] == node.args[1] else self.multiply(*r)
        if op in COMPARISONS:
            return self._comparison(op, r)
        if op == OP_SELECT:
            return self.choose(self.truth(r[0]), r[1], r[2])
        if op == ca.OP_IF_ELSE_ZERO:
            return self.choose(self.truth(r[0]), r[1], ZERO)
        if op in (ca.OP_POW, ca.OP_CONSTPOW):
            return self._power(*r)
        if op == OP_SPECIAL:
            return self._special(int(node.constant), r)
        return ANYTHING

    def _at_least(self, least: float, a: Pair) -> Pair:
        if is_thin(a) or sign_of(a[0]) > 0 >= least:
            return a
        return self.do("maximum", a[0], least), a[1]

    def _comparison(self, op: int, r: Sequence[Pair]) -> Pair:
        do = self.do
        if op in (ca.OP_NOT, ca.OP_AND, ca.OP_OR):
            masks = [self.truth(a) for a in r]
            if op == ca.OP_NOT:
                return self.flags(masks[0][1], masks[0][0])
            if op == ca.OP_OR:
                return self.flags(*self._either(masks[0], masks[1]))
            no, yes = self._either((masks[0][1], masks[0][0]), (masks[1][1], masks[1][0]))
            return self.flags(yes, no)
        a, b = r
        if op == ca.OP_LT:
            return self.flags(do("less", a[1], b[0]), do("less_equal", b[1], a[0]))
        if op == ca.OP_LE:
            return self.flags(do("less_equal", a[1], b[0]), do("less", b[1], a[0]))
        both_thin = do("logical_and", do("equal", a[0], a[1]), do("equal", b[0], b[1]))
        same = do("logical_and", both_thin, do("equal", a[0], b[0]))
        apart = self._either_of(do("less", a[1], b[0]), do("less", b[1], a[0]))
        return self.flags(same, apart) if op == ca.OP_EQ else self.flags(apart, same)

    def _either(self, a: Pair, b: Pair) -> Pair:
        """Return masks of a or b: surely true where one is, surely false where both are."""
        return self._either_of(a[0], b[0]), self.do("logical_and", a[1], b[1])

    def _power(self, a: Pair, b: Pair) -> Pair:
        do = self.do
        if is_thin(a) and is_thin(b):
            value = do("power", a[0], b[0])
            return value, value
        p = b[0]
        if is_thin(b) and not isinstance(p, Ref):
            if sign_of(a[0]) > 0:
                ends = do("power", a[0] if p >= 0 else self._end_at_zero(a[0]), p), do("power", a[1], p)
                return ends if p >= 0 else ends[::-1]
            if p > 0 and float(p).is_integer():
                size = a if p % 2 else self.size(a)
                return do("power", size[0], p), do("power", size[1], p)
        if sign_of(a[0]) > 0:
            return self.rising("exp", self.multiply(b, self.rising("log", a)))
        return ANYTHING

    def _special(self, position: int, r: Sequence[Pair]) -> Pair:
        function = self.program.specials[position]
        rises = [low >= 0 for low, _ in function.elasticity]
        ends = []
        for side in (0, 1):
            corner = [pair[side if rise else 1 - side] for pair, rise in zip(r, rises, strict=True)]
            ends.append(self.tape.call(function.name, function.formula, corner))
        # Nothing is declared for negative arguments.
        for low, _ in r:
            if sign_of(low) <= 0:
                inside = self.do("less_equal", 0.0, low)
                ends = [self.tape.where(inside, end, x) for end, x in zip(ends, ANYTHING, strict=True)]
        return ends[0], ends[1]

    def _lipschitz(self, name: str, a: Pair) -> Pair:
        """Return sine or cosine: at the middle, give or take half the width, within -1 and 1."""
        do = self.do
        if is_thin(a):
            return self.rising(name, a)
        middle, reach = do("multiply", 0.5, do("add", *a)), do("multiply", 0.5, do("subtract", a[1], a[0]))
        value = do(name, middle)
        return do("fmax", -1.0, do("subtract", value, reach)), do("fmin", 1.0, do("add", value, reach))

    def _sine(self, a: Pair) -> Pair:
        return self._lipschitz("sin", a)

    def _cosine(self, a: Pair) -> Pair:
        return self._lipschitz("cos", a)

    def _tangent(self, a: Pair) -> Pair:
        return self.divide(self._sine(a), self._cosine(a))

    def _cosh(self, a: Pair) -> Pair:
        return self.rising("cosh", self.size(a))

    def _arccos(self, a: Pair) -> Pair:
        return self.negative(self.add(self._arcsin(a), (-math.pi / 2, -math.pi / 2)))

    def _arcsin(self, a: Pair) -> Pair:
        low, high = self._at_least(-1.0, a)
        return self.rising("arcsin", a if is_thin(a) else (low, self.do("minimum", high, 1.0)))

    def _hypot(self, a: Pair, b: Pair) -> Pair:
        return self.rising("sqrt", self.add(self.square(a), self.square(b)))

    def _arctan2(self, y: Pair, x: Pair) -> Pair:
        return self.rising("arctan", self.divide(y, x)) if sign_of(x[0]) > 0 else (-math.pi, math.pi)

    def _least(self, a: Pair, b: Pair) -> Pair:
        low = self.do("minimum", a[0], b[0])
        return (low, low) if is_thin(a) and is_thin(b) else (low, self.do("minimum", a[1], b[1]))

    def _most(self, a: Pair, b: Pair) -> Pair:
        return self.negative(self._least(self.negative(a), self.negative(b)))

    def _twice(self, a: Pair) -> Pair:
        return self.multiply((2.0, 2.0), a)

    def _inverse(self, a: Pair) -> Pair:
        return self.divide((1.0, 1.0), a)

    _RULES: ClassVar[dict[int, Callable[..., Pair]]] = {
        ca.OP_ADD: Arithmetic.add,
        ca.OP_SUB: Arithmetic.subtract,
        ca.OP_DIV: Arithmetic.divide,
        ca.OP_NEG: Arithmetic.negative,
        ca.OP_SQ: Arithmetic.square,
        ca.OP_FABS: Arithmetic.size,
        ca.OP_TWICE: _twice,
        ca.OP_INV: _inverse,
        ca.OP_FMIN: _least,
        ca.OP_FMAX: _most,
        ca.OP_SIN: _sine,
        ca.OP_COS: _cosine,
        ca.OP_TAN: _tangent,
        ca.OP_COSH: _cosh,
        ca.OP_ACOS: _arccos,
        ca.OP_ASIN: _arcsin,
        ca.OP_HYPOT: _hypot,
        ca.OP_ATAN2: _arctan2,
    }
