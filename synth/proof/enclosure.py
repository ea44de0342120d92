"""Enclosures of traced formulas over boxes, recorded on a tape for thousands of boxes at a time.

This is the arithmetic of ``verify`` alone; the search has its own and neither imports the other. Of every
instruction of a trace three things are kept:

- its *range* over the box by interval arithmetic, at all points of the box;
- its *narrow* range, which only points that keep the limits need to have: each limit cuts both of its sides, and
  the cuts are carried on, forward and then back to the inputs;
- *center and slopes*: the value at any point of the box is one of the center values plus slopes times the
  distance of the inputs from the middle of the box. Positive inputs count by logarithm, and so does a value whose
  sign is known, so that slopes of products add.

Slopes speak of all points of the box, because the way from one point to another need not keep the limits. A value
that passes through zero in the box, though no design that keeps the limits has it there, is clipped: between zero
and what the limits leave, so that nothing changes for any feasible design.

Not-a-number always means that nothing is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import casadi as ca

from synth.model.program import OP_SELECT, OP_SPECIAL, Node, Program
from synth.proof.interval_arithmetic import ANYTHING, DISTINCT, JUMPING, ROUNDING, ZERO, Pair, Ranges, is_thin
from synth.proof.tape import Expr, Ref, Tape, sign_of

Slopes: TypeAlias = dict[Any, Pair]
Key: TypeAlias = tuple[Any, ...]


@dataclass(eq=False)
class Enclosed:
    """What is known of one instruction over a box: see the head of this module.

    ``sign`` is that of the range, 0 where zero may lie in it; ``log`` tells that the slopes are those of log|value|;
    ``complete`` that they bound all derivatives, jumps apart, so that nothing of them is hidden in the center.
    """

    range: Pair
    center: Pair
    log: bool = False
    slopes: Slopes = field(default_factory=dict)
    sign: int = 0
    narrow: Pair = ANYTHING
    uncut: Pair = ANYTHING  # the narrow range before the limits of this very value cut it
    least: float = 0.0  # what |value| surely is at least, in all boxes
    complete: bool = True

    @classmethod
    def constant(cls, value: float) -> Enclosed:
        """Return a value that is the same everywhere."""
        pair = (value, value)
        return cls(pair, pair, sign=int(value > 0) - int(value < 0), narrow=pair, uncut=pair, least=abs(value))


@dataclass(frozen=True)
class NodeComparison:
    """What a limit says of one instruction, against another one or a value: +1 at most, -1 at least, 0 equal."""

    other: int | Expr
    sense: int
    scale: float = 0.0
    terms: int | None = None
    loose: float = 0.0


@dataclass(frozen=True)
class Known:
    """What the root box tells of one instruction, and so of every box in it."""

    range: Pair
    log: bool
    slopes: Slopes


@dataclass(frozen=True)
class Scouted:
    """What a run over the root box found: of every instruction, and at which values some are clipped.

    A clip is (least, None) or (None, largest); ``raised`` are the clips of arguments of special functions.
    """

    known: dict[Key, Known] = field(default_factory=dict)
    clips: dict[int, tuple[float | None, float | None]] = field(default_factory=dict)
    raised: dict[Key, float] = field(default_factory=dict)


class Encloser(Ranges):
    """Carries out a program on enclosures.

    Parameters
    ----------
    tape : Tape
    program : Program
    known : mapping, optional
        What a first run over the root box recorded; signs come from it.
    certain : mapping, optional
        For that first run: ranges of instructions that every feasible design keeps.
    slopes : bool
        False: only ranges.
    lifted : mapping, optional
        Instructions whose value counts as an input with ends of its own; ``made`` then holds what the instruction
        itself makes of the inputs, which a design has equal to it.
    """

    def __init__(
        self,
        tape: Tape,
        program: Program,
        known: Scouted | None = None,
        certain: Mapping[int, Pair] | None = None,
        slopes: bool = True,
        lifted: Mapping[int, Enclosed] | None = None,
    ) -> None:
        super().__init__(tape, program)
        self.lifted = lifted or {}
        self.made: dict[int, Enclosed] = {}
        self.known, self.certain, self.with_slopes = known, certain or {}, slopes
        self.record = Scouted()
        self._inner: dict[int, Program] = {}

    def run(
        self,
        nodes: Sequence[Node],
        order: Iterable[int],
        inputs: Sequence[Enclosed],
        cuts: Mapping[int, Sequence[NodeComparison]] | None = None,
        prefix: Key = (),
    ) -> dict[int, Enclosed]:
        """Return the enclosures of instructions; narrow ranges only where cuts are given."""
        enclosed: dict[int, Enclosed] = {}
        for k in order:
            node = nodes[k]
            if node.op == ca.OP_CONST:
                enclosed[k] = Enclosed.constant(node.constant)
            elif node.op == ca.OP_INPUT:
                enclosed[k] = inputs[int(node.constant)]
            else:
                enclosed[k] = self._settled(node, [enclosed[a] for a in node.args], (*prefix, k))
            if not prefix and k in self.lifted:
                self.made[k], enclosed[k] = enclosed[k], replace(self.lifted[k])
            if cuts is not None:
                self._narrow(k, node, enclosed, cuts)
        return enclosed

    # -- ranges, centers, signs ----------------------------------------------------------------

    def _settled(self, node: Node, args: list[Enclosed], key: Key) -> Enclosed:
        above = self.program.specials[int(node.constant)].above if node.op == OP_SPECIAL else None
        if above is not None:
            args = self._raised(node, args, above, key)
        r = self.range_of(node, [a.range for a in args])
        jumps = node.op in JUMPING
        # Which side of a choice is taken in a box depends on the whole box, not on its middle.
        first = [args[0].range] if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO) else [args[0].center]
        v = Enclosed(r, r if jumps else self.range_of(node, first + [a.center for a in args[1:]]))
        shown = args[1:] if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO) else args
        v.complete = is_thin(r) or (not jumps and all(a.complete for a in shown))
        clip = None if jumps or len(key) > 1 else self._clip_of(key[0], v)
        v.sign = 0 if clip else self._sign(v, key)
        if not jumps and self.with_slopes and any(a.slopes for a in args):
            self._slopes(node, args, v, key)
        if self.known is None:
            self.record.known[key] = Known(v.range, v.log, v.slopes)
        if clip:
            self._clip(v, *clip)
        elif self.known is not None:
            self._settle_slopes(v, self.known.known[key])
        return v

    def _clip_of(self, k: int, v: Enclosed) -> tuple[float | None, float | None] | None:
        if self.known is not None:
            return self.known.clips.get(k)
        if k not in self.certain or v.range[0] > 0 or v.range[1] < 0:
            return None
        low, high = self.certain[k]
        near, far = (low, high) if low > 0 else (-high, -low)
        if near > 0 and (near > DISTINCT * far or math.isinf(far)):
            # Half of the way to zero, so that the clip is not in the way of boxes near a limit.
            self.record.clips[k] = (low / 2, None) if low > 0 else (None, high / 2)
        return self.record.clips.get(k)

    def _sign(self, v: Enclosed, key: Key) -> int:
        low, high = v.range
        if self.known is not None:
            low, high = self.known.known[key].range
        sign = (
            (1 if low > 0 else -1 if high < 0 else 0) if not isinstance(low, Ref) and not isinstance(high, Ref) else 0
        )
        if sign:
            v.least = min(abs(low), abs(high))
            self._mark(sign, *v.range, *v.center)
        return sign

    @staticmethod
    def _mark(sign: int, *values: Expr) -> None:
        for x in values:
            if isinstance(x, Ref):
                x.sign = sign

    def _settle_slopes(self, v: Enclosed, root: Known) -> None:
        """Slopes over a part of the root box lie within those over the whole."""
        if v.log == root.log:
            for k, (low, high) in root.slopes.items():
                if k in v.slopes and not isinstance(low, Ref) and not isinstance(high, Ref):
                    sign = 1 if low >= 0 else -1 if high <= 0 else 0
                    if sign:
                        self._mark(sign, *v.slopes[k])

    def _clip(self, v: Enclosed, least: float | None, most: float | None) -> None:
        """Take the value as what it is for every feasible design, elsewhere the nearest such value."""
        do, where = self.do, self.tape.where
        limit, name = (least, "fmax") if least is not None else (most, "fmin")
        inside = do("less_equal", limit, v.range[0]) if least is not None else do("less_equal", v.range[1], limit)

        def clipped(pair: Pair) -> Pair:
            low = do(name, pair[0], limit)
            return (low, low) if is_thin(pair) else (low, do(name, pair[1], limit))

        v.range, v.center = clipped(v.range), clipped(v.center)
        v.sign, v.least = (1 if least is not None else -1), abs(limit or 0.0)
        self._mark(v.sign, *v.range, *v.center)
        v.slopes = {
            k: (where(inside, low, do("minimum", low, 0.0)), where(inside, high, do("maximum", high, 0.0)))
            for k, (low, high) in v.slopes.items()
        }
        v.slopes, v.log = self.logarithmic(v), True

    def _raised(self, node: Node, args: list[Enclosed], above: tuple[int, int], key: Key) -> list[Enclosed]:
        """Arguments of a special function that exists only where one of them is above another.

        The first is clipped half-way between the least that feasible designs have of it and the other.
        """
        first, second = above
        if self.known is None and node.args[first] in self.certain:
            least, border = self.certain[node.args[first]][0], args[second].range[1]
            if args[first].sign > 0 and args[first].range[0] < border < least:
                self.record.raised[key] = 0.5 * (least + border)
        limit = (self.record if self.known is None else self.known).raised.get(key)
        if limit is None:
            return args
        raised = replace(args[first])
        self._clip(raised, limit, None)
        return [raised if j == first else a for j, a in enumerate(args)]

    # -- slopes --------------------------------------------------------------------------------

    def linear(self, v: Enclosed) -> Slopes:
        """Return the slopes of the value itself."""
        return {k: self.multiply(v.range, s) for k, s in v.slopes.items()} if v.log else v.slopes

    def logarithmic(self, v: Enclosed) -> Slopes:
        """Return the slopes of log|value|."""
        return v.slopes if v.log else {k: self.divide(s, v.range) for k, s in v.slopes.items()}

    def _scaled(self, slopes: Slopes, factor: Pair) -> Slopes:
        return {k: self.multiply(factor, s) for k, s in slopes.items()}

    def _slopes(self, node: Node, args: list[Enclosed], v: Enclosed, key: Key) -> None:
        op = node.op
        if op == OP_SPECIAL:
            slopes = self._special_slopes(node, args, v, key) if v.sign else None
            v.log = slopes is not None
        elif op in (ca.OP_ADD, ca.OP_SUB):
            slopes = self._sum_slopes(args, v, 1 if op == ca.OP_ADD else -1)
        elif op in (OP_SELECT, ca.OP_IF_ELSE_ZERO, ca.OP_FMIN, ca.OP_FMAX):
            slopes = self._choice_slopes(op, args, v)
        elif len(args) == 2:
            slopes = self._product_slopes(node, args, v)
        else:
            slopes = self._unary_slopes(op, args[0], v)
        if slopes is None:  # nothing is known but the range
            v.log, v.complete, v.center = False, False, v.range
        else:
            v.slopes = slopes

    def merged(self, a: Slopes, b: Slopes, rule: Callable[[Pair, Pair], Pair]) -> Slopes:
        """Return the slopes of what a rule makes of two values."""
        return {k: rule(a.get(k, ZERO), b.get(k, ZERO)) for k in dict.fromkeys([*a, *b])}

    def _product_slopes(self, node: Node, args: list[Enclosed], v: Enclosed) -> Slopes | None:
        a, b = args
        op = node.op
        signed = a.sign and b.sign and v.sign
        if op == ca.OP_MUL:
            if node.args[0] == node.args[1]:
                return self._unary_slopes(ca.OP_SQ, a, v)
            if signed:
                v.log = True
                return self.merged(self.logarithmic(a), self.logarithmic(b), self.add)
            return self.merged(self._scaled(self.linear(a), b.range), self._scaled(self.linear(b), a.range), self.add)
        if op == ca.OP_DIV:
            if signed:
                v.log = True
                return self.merged(self.logarithmic(a), self.logarithmic(b), self.subtract)
            # Anything where the divisor may be zero.
            dividend = {k: self.divide(s, b.range) for k, s in self.linear(a).items()}
            its = {k: self.divide(s, b.range) for k, s in self.linear(b).items()}
            return self.merged(dividend, self._scaled(its, v.range), self.subtract)
        if op in (ca.OP_POW, ca.OP_CONSTPOW):
            return self._power_slopes(a, b, v)
        if op == ca.OP_HYPOT and v.sign > 0:
            shares = [
                {k: self.divide(self.multiply(x.range, s), v.range) for k, s in self.linear(x).items()} for x in args
            ]
            return self.merged(shares[0], shares[1], self.add)
        return None

    def _power_slopes(self, a: Enclosed, b: Enclosed, v: Enclosed) -> Slopes | None:
        if not b.slopes and not isinstance(b.range[0], Ref):
            p = float(b.range[0])
            if a.sign > 0 and v.sign:
                v.log = True
                return self._scaled(self.logarithmic(a), (p, p))
            if p >= 1 and p.is_integer():
                less = self._power(a.range, (p - 1, p - 1)) if p > 1 else (1.0, 1.0)
                return self._scaled(self.linear(a), self.multiply((p, p), less))
            return None
        if a.sign > 0 and v.sign:
            v.log = True
            base = self._scaled(self.logarithmic(a), b.range)
            return self.merged(base, self._scaled(self.linear(b), self.rising("log", a.range)), self.add)
        return None

    def _sum_slopes(self, args: list[Enclosed], v: Enclosed, sign: int) -> Slopes:
        a, b = args
        if not (a.sign and b.sign and v.sign):
            return self.merged(self.linear(a), self.linear(b), self.add if sign > 0 else self.subtract)
        v.log = True
        other = b.range if sign > 0 else self.negative(b.range)
        if a.sign == sign * b.sign:
            # Shares of the sum, both within 0 and 1.
            size_a, size_b = self.size(a.range), self.size(b.range)
            do = self.do
            share = (
                do("divide", size_b[0], do("add", size_b[0], size_a[1])),
                do("divide", size_b[1], do("add", size_b[1], size_a[0])),
            )
            side = 1
        else:
            share = self.divide(other, v.range)
            side = 1 if sign * b.sign == v.sign else -1
        complement = self.subtract((1.0, 1.0), share)
        self._mark(side, *share)
        self._mark(1 if a.sign == v.sign else -1, *complement)
        return self.merged(
            self.logarithmic(a), self.logarithmic(b), lambda x, y: self._weighted(complement, x, share, y)
        )

    def _weighted(self, complement: Pair, slope_a: Pair, share: Pair, slope_b: Pair) -> Pair:
        """(1 - share)*slope_a + share*slope_b: linear in the share, so one of its ends decides."""
        if slope_b == ZERO or slope_a == ZERO:
            return self.multiply(complement, slope_a) if slope_b == ZERO else self.multiply(share, slope_b)

        def end(weight: Expr, other: Expr, side: int) -> Expr:
            x = self.do("multiply", other, slope_a[side if sign_of(other) > 0 else 1 - side])
            return self.do("add", x, self.do("multiply", weight, slope_b[side if sign_of(weight) > 0 else 1 - side]))

        ends = ((share[0], complement[1]), (share[1], complement[0]))
        return (
            self.do("minimum", *(end(w, o, 0) for w, o in ends)),
            self.do("maximum", *(end(w, o, 1) for w, o in ends)),
        )

    def _choice_slopes(self, op: int, args: list[Enclosed], v: Enclosed) -> Slopes:
        do = self.do
        if op in (ca.OP_FMIN, ca.OP_FMAX):
            a, b = args
            masks = do("less_equal", a.range[1], b.range[0]), do("less_equal", b.range[1], a.range[0])
            if op == ca.OP_FMAX:
                masks = masks[::-1]
        else:
            a, b = args[1], args[2] if op == OP_SELECT else Enclosed.constant(0.0)
            masks = self.truth(args[0].range)
        if v.sign and a.sign and b.sign:
            v.log = True
            return self.merged(self.logarithmic(a), self.logarithmic(b), lambda x, y: self.choose(masks, x, y))
        return self.merged(self.linear(a), self.linear(b), lambda x, y: self.choose(masks, x, y))

    def _unary_slopes(self, op: int, a: Enclosed, v: Enclosed) -> Slopes | None:
        exponent = {ca.OP_SQ: 2.0, ca.OP_SQRT: 0.5, ca.OP_INV: -1.0}.get(op)
        if op in (ca.OP_NEG, ca.OP_TWICE) or (op == ca.OP_FABS and a.sign):
            v.log = a.log and bool(v.sign)
            factor = {ca.OP_NEG: -1.0, ca.OP_TWICE: 2.0}.get(op, float(a.sign))
            return dict(a.slopes) if v.log else self._scaled(self.linear(a), (factor, factor))
        if exponent is not None and a.sign and v.sign:
            v.log = True
            return self._scaled(self.logarithmic(a), (exponent, exponent))
        if op == ca.OP_EXP and v.sign:
            v.log = True
            return dict(self.linear(a))
        if op == ca.OP_LOG and a.sign:
            return dict(self.logarithmic(a))
        if op == ca.OP_LOG1P and a.sign:
            share = self._rising_share(a)
            return self._scaled(self.logarithmic(a), share)
        if op == ca.OP_EXPM1 and a.sign and v.sign:
            v.log = True
            # d log|exp(a) - 1|/da = 1/(1 - exp(-a)) falls with a on either side of zero.
            back = self.rising("expm1", self.negative(a.range))
            rate = self.do("divide", -1.0, back[0]), self.do("divide", -1.0, back[1])
            self._mark(a.sign, *rate)
            return self._scaled(self.linear(a), rate)
        if op == ca.OP_FABS:
            return {k: self.hull(s, self.negative(s)) for k, s in self.linear(a).items()}
        derivative = self._derivative(op, a.range, v.range)
        return None if derivative is None else self._scaled(self.linear(a), derivative)

    def _rising_share(self, a: Enclosed) -> Pair:
        """Return a/(1 + a), which rises."""
        low, high = (self.do("divide", x, self.do("add", 1.0, x)) for x in a.range)
        self._mark(a.sign, low, high)
        return low, high

    def _derivative(self, op: int, a: Pair, value: Pair) -> Pair | None:
        """Return the range of the derivative of a function of one argument."""
        one = (1.0, 1.0)
        if op == ca.OP_SQ:
            return self._twice(a)
        if op == ca.OP_SQRT:
            return self.divide((0.5, 0.5), value)
        if op == ca.OP_INV:
            return self.negative(self.multiply(value, value))  # anything where the divisor may be zero
        if op == ca.OP_LOG:
            return self._inverse(a)
        if op == ca.OP_LOG1P:
            return self._inverse(self.add(one, a))
        if op == ca.OP_EXPM1:
            return self.rising("exp", a)
        if op == ca.OP_SIN:
            return self._cosine(a)
        if op == ca.OP_COS:
            return self.negative(self._sine(a))
        if op == ca.OP_SINH:
            return self._cosh(a)
        if op == ca.OP_COSH:
            return self.rising("sinh", a)
        if op == ca.OP_TAN:
            secant = self._inverse(self._cosine(a))
            return self.multiply(secant, secant)  # anything where there may be a pole
        if op == ca.OP_TANH:
            return self.subtract(one, self.square(value))
        square = self.square(a)
        if op == ca.OP_ATAN:
            return self._inverse(self.add(one, square))
        if op == ca.OP_ASINH:
            return self._inverse(self.rising("sqrt", self.add(one, square)))
        if op == ca.OP_ACOSH:
            return self._inverse(self.rising("sqrt", self.subtract(square, one)))
        if op in (ca.OP_ASIN, ca.OP_ACOS):
            rate = self._inverse(self.rising("sqrt", self.subtract(one, square)))
            return rate if op == ca.OP_ASIN else self.negative(rate)
        if op == ca.OP_ATANH:
            return self._inverse(self.subtract(one, square))
        if op == ca.OP_ERF:
            factor = 2 / math.sqrt(math.pi)
            return self.multiply((factor, factor), self.rising("exp", self.negative(square)))
        return None

    def _special_slopes(self, node: Node, args: list[Enclosed], v: Enclosed, key: Key) -> Slopes | None:
        """Slopes of a special function: its declared elasticities, met with those of its formula over the box."""
        if not all(a.sign > 0 for a in args):
            return None
        position = int(node.constant)
        function = self.program.specials[position]
        if position not in self._inner:
            symbols = [ca.SX.sym(f"a{j}") for j in range(len(args))]
            self._inner[position] = Program(symbols, [function.formula(*symbols)])
        inner = self._inner[position]
        moving = [bool(a.slopes) for a in args]
        inner_inputs = [
            Enclosed(a.range, a.center, log=move, slopes={j: (1.0, 1.0)} if move else {}, sign=1)
            for j, (a, move) in enumerate(zip(args, moving, strict=True))
        ]
        result = self.run(inner.nodes, inner.needed(inner.outputs), inner_inputs, prefix=key)[inner.outputs[0]]
        # What declares its elasticities is continuous, so that the slopes hold across the switches of its formula. The
        # range of the value is known better than that of the last instruction.
        local = result.slopes if result.log else {j: self.divide(s, v.range) for j, s in result.slopes.items()}
        local = local if result.complete else {}
        slopes: Slopes = {}
        for j, a in enumerate(args):
            if moving[j]:
                declared = function.elasticity[j]
                rate = self.meet(local.get(j, ANYTHING), declared)
                self._mark(1 if declared[0] >= 0 else -1, *rate)
                slopes = self.merged(slopes, self._scaled(self.logarithmic(a), rate), self.add)
        return slopes

    # -- narrow ranges: forward and back -------------------------------------------------------

    def _narrow(
        self, k: int, node: Node, enclosed: Mapping[int, Enclosed], cuts: Mapping[int, Sequence[NodeComparison]]
    ) -> None:
        v = enclosed[k]
        args = [enclosed[a] for a in node.args]
        if k in self.made:
            made = self.made[k]
            made.narrow = made.uncut = self.meet(self.range_of(node, [a.narrow for a in args]), made.range)
            self._mark(made.sign, *made.narrow)
            v.narrow = self.meet(made.narrow, v.range)
            self._mark(v.sign, *v.narrow)
        elif all(a.narrow[0] is a.range[0] and a.narrow[1] is a.range[1] for a in args):
            v.narrow = v.range
        else:
            v.narrow = self.meet(self.range_of(node, [a.narrow for a in args]), v.range)
            self._mark(v.sign, *v.narrow)
        v.uncut = v.narrow
        for cut in cuts.get(k, ()):
            if isinstance(cut.other, int):
                if cut.other not in enclosed:
                    continue  # the cut of the later one by this one does the same
                other = enclosed[cut.other].narrow
            else:
                other = (cut.other, cut.other)
            low, high = v.narrow
            if cut.terms is not None and cut.terms not in enclosed:
                continue  # its size is not known yet; the row of the limit says the same
            scale: Expr = cut.scale if cut.terms is None else enclosed[cut.terms].range[1]
            if cut.sense >= 0:
                high = self.do("fmin", high, self._loosened(other[1], cut.loose, scale))
            if cut.sense <= 0:
                low = self.do("fmax", low, self._loosened(other[0], -cut.loose, scale))
            if v.sign:
                self._mark(v.sign, low, high)
            v.narrow = (low, high)

    def _loosened(self, end: Expr, share: float, scale: Expr) -> Expr:
        if share == 0:
            return end
        size = self.do("maximum", self.do("absolute", end), scale)
        return self.do("add", end, self.do("multiply", share, size))

    def carried_back(
        self, nodes: Sequence[Node], order: Sequence[int], enclosed: Mapping[int, Enclosed]
    ) -> dict[int, Pair]:
        """Return the narrow ranges after the cuts were carried back from results to what they are made of."""
        now = {k: enclosed[k].narrow for k in order}
        changed = {k for k in order if now[k][0] is not enclosed[k].uncut[0] or now[k][1] is not enclosed[k].uncut[1]}
        changed |= self.made.keys()

        def put(k: int, pair: Pair | None) -> None:
            if pair is None or is_thin(enclosed[k].range):
                return
            now[k] = self.meet(now[k], pair)
            if enclosed[k].sign:
                self._mark(enclosed[k].sign, *now[k])
            changed.add(k)

        for k in reversed(order):
            if k in changed:
                for a, pair in self._backward(nodes[k], k, now, enclosed):
                    put(a, pair)
        return now

    def _backward(
        self, node: Node, k: int, now: Mapping[int, Pair], enclosed: Mapping[int, Enclosed]
    ) -> Iterable[tuple[int, Pair | None]]:
        """Yield what the range of a result leaves of its arguments."""
        op, y = node.op, now[k]
        if op in (ca.OP_ADD, ca.OP_SUB):
            a, b = node.args
            if op == ca.OP_ADD:
                yield a, self._widened(self.subtract(y, now[b]), y, now[b])
                yield b, self._widened(self.subtract(y, now[a]), y, now[a])
            else:
                yield a, self._widened(self.add(y, now[b]), y, now[b])
                yield b, self._widened(self.subtract(now[a], y), y, now[a])
        elif op == ca.OP_MUL and node.args[0] != node.args[1]:
            a, b = node.args
            yield a, self.divide(y, now[b]) if enclosed[b].sign else None
            yield b, self.divide(y, now[a]) if enclosed[a].sign else None
        elif op == ca.OP_DIV:
            a, b = node.args
            yield a, self.multiply(y, now[b]) if enclosed[b].sign else None
            yield b, self.divide(now[a], y) if enclosed[k].sign else None
        elif op in (ca.OP_SQ, ca.OP_MUL):
            yield node.args[0], self.rising("sqrt", y) if enclosed[node.args[0]].sign > 0 and enclosed[k].sign else None
        elif op == ca.OP_NEG:
            yield node.args[0], self.negative(y)
        elif op == ca.OP_TWICE:
            yield node.args[0], self.multiply((0.5, 0.5), y)
        elif op == ca.OP_SQRT:
            yield node.args[0], self.square(y) if enclosed[k].sign > 0 else None
        elif op == ca.OP_INV:
            yield node.args[0], self.divide((1.0, 1.0), y) if enclosed[k].sign else None
        elif op in (ca.OP_EXP, ca.OP_LOG, ca.OP_LOG1P, ca.OP_EXPM1):
            inverse = {ca.OP_EXP: "log", ca.OP_LOG: "exp", ca.OP_LOG1P: "expm1", ca.OP_EXPM1: "log1p"}[op]
            if op in (ca.OP_EXP, ca.OP_EXPM1):
                y = self._blurred(y, -1.0 if op == ca.OP_EXPM1 else 0.0)
            yield node.args[0], self.rising(inverse, y) if op != ca.OP_EXP or enclosed[k].sign > 0 else None

    def _blurred(self, y: Pair, least: float) -> Pair:
        """Return ends widened by their rounding, which a logarithm magnifies close to its border ``least``."""
        low, high = (self.do("multiply", ROUNDING, self.do("absolute", end)) for end in y)
        return self.do("fmax", least, self.do("subtract", y[0], low)), self.do("add", y[1], high)

    def _widened(self, result: Pair, *terms: Pair) -> Pair:
        """Return a sum widened by what rounding may have taken where its terms cancel."""
        size = self.do("multiply", ROUNDING, self.do("add", *(self.largest(t) for t in terms)))
        return self.do("subtract", result[0], size), self.do("add", result[1], size)
