"""What intervals prove of limits while quantities scatter around one design.

A limit says ``small <= large``. Where the slopes of both sides show that it only rises or only falls with each thing
that scatters, its worst point is a known corner. Elsewhere monotone directions are held at their worst end, and the
rest is bounded in ever smaller parts. Intervals speak of points at which formulas are defined, so that nothing is
proven where one may be undefined.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

from synth.model.constraint import Constraint
from synth.model.program import OP_SELECT, OP_SPECIAL, OPERATIONS, Node, Program
from synth.order.feasibility import TOLERANCE, holds
from synth.proof.enclosure import Enclosed, Encloser, Slopes
from synth.proof.interval_arithmetic import ZERO, Pair, is_thin
from synth.proof.tape import Expr, Ref, Tape
from synth.robust.settings import RobustLimits

Box: TypeAlias = tuple[np.ndarray, np.ndarray]  # lower and upper ends (quantities,) or (boxes, quantities)
WHERE = (OP_SELECT, ca.OP_IF_ELSE_ZERO)


@dataclass(frozen=True)
class MovingInput:
    """An input of the program that moves with a scattering quantity, and its values at positions of the range."""

    quantity: int
    number: int
    at: Callable[[Any], Any]


@dataclass(frozen=True)
class MonotoneLimit:
    """A limit over the range, as far as its directions are known.

    ``worst`` is the position where it is worst, not-a-number where no direction is known. ``log``: it is worst by the
    ratio of both sides, else by their difference. ``size`` is the least size of its sides over the range.
    """

    worst: np.ndarray
    log: bool
    size: float

    @property
    def complete(self) -> bool:
        """Whether the worst point is known."""
        return not np.isnan(self.worst).any()

    def holds_everywhere(self, limit: Constraint, value: float, bound: float) -> bool:
        """True if a limit whose sides are these at the worst point is within the tolerance everywhere."""
        small, large = (value, bound) if limit.sense == "at_most" else (bound, value)
        return bool(holds(1.0 - large / small if self.log else (small - large) / self.size, limit.guard))


@dataclass(frozen=True)
class RangeSearch:
    """What a search over the range shows of a limit: that it holds everywhere, or where it fails, or neither."""

    proven: bool = False
    violated: np.ndarray | None = None


class LimitBounds:
    """Bounds of the limits of one design over parts of the range.

    Parameters
    ----------
    program : Program
    values : list of float
        Inputs of the program at the nominal point.
    moving : list of MovingInput
    quantities : int
        How many scatter.
    matters : mapping
        Limit -> for each quantity whether the limit depends on it.
    settings : RobustLimits
    """

    def __init__(
        self,
        program: Program,
        values: Sequence[float],
        moving: Sequence[MovingInput],
        quantities: int,
        matters: Mapping[str, Sequence[bool]],
        settings: RobustLimits,
    ) -> None:
        self.program, self.values, self.moving = program, values, moving
        self.quantities, self.matters, self.settings = quantities, matters, settings

    def monotone(self, limits: Sequence[Constraint]) -> list[MonotoneLimit]:
        """Directions of limits over the whole range."""
        full_range = np.zeros(self.quantities), np.ones(self.quantities)
        _, inputs = self.leaves(full_range)
        encloser = Encloser(Tape(), self.program)
        enclosed = encloser.run(self.program.nodes, self.needed(limits), inputs)
        regularity = _Regularity(encloser, enclosed)
        return [self._direction(_Sides(encloser, enclosed, regularity, x, self.quantities), x) for x in limits]

    def _direction(self, sides: _Sides, limit: Constraint) -> MonotoneLimit:
        worst = np.full(self.quantities, math.nan)
        worst[np.logical_not(self.matters[limit.name])] = 1.0  # anywhere
        if sides.regular.smooth and sides.regular.defined:
            rises, falls = _directions(np.array(sides.slopes, dtype=float), self.settings.steep)
            worst[falls], worst[rises] = 0.0, 1.0
        return MonotoneLimit(worst, sides.log, max([limit.scale, *(x.least for x in (sides.small, sides.large))]))

    def search(
        self, limit: Constraint, known: MonotoneLimit, residual: Callable[[np.ndarray], np.ndarray]
    ) -> RangeSearch:
        """Bound a limit over ever smaller parts of the range, until it is proven, violated, or parts run out.

        Parameters
        ----------
        limit : Constraint
        known : MonotoneLimit
            Its directions over the whole range.
        residual : callable
            Residuals of the limit at positions (points, quantities).
        """
        settings = self.settings
        low = np.where(np.isnan(known.worst), 0.0, known.worst)
        high = np.where(np.isnan(known.worst), 1.0, known.worst)
        bounds = _RecordedBounds(self, limit, (low, high), known.size)
        waiting, spent = (low[None, :], high[None, :]) if bounds.leaves else (low[:0], high[:0]), 0
        while len(waiting[0]):
            if spent >= settings.parts:
                return RangeSearch()
            lows, highs = (side[-settings.batch :] for side in waiting)
            waiting = waiting[0][: -len(lows)], waiting[1][: -len(lows)]
            spent += len(lows)
            current = bounds.of(lows, highs)
            unproven = ~current.holds
            if not unproven.any():
                continue
            lows, highs = lows[unproven], highs[unproven]
            middles = 0.5 * (lows + highs)
            r = residual(middles)
            if not np.all(holds(r, limit.guard)):
                return RangeSearch(violated=middles[np.argmax(r)])
            if (highs - lows).max(axis=1).min() < settings.narrowest:
                return RangeSearch()  # a point that is too close to its limit, or to a pole
            parts = _parts(lows, highs, current.rises[unproven], current.falls[unproven], current.reach[unproven])
            waiting = np.concatenate([waiting[0], parts[0]]), np.concatenate([waiting[1], parts[1]])
        return RangeSearch(proven=bool(bounds.leaves))

    def needed(self, limits: Iterable[Constraint]) -> list[int]:
        """Instructions that limits need, in order of evaluation."""
        return self.program.needed([k for x in limits for k in x.nodes])

    def leaves(self, box: Box) -> tuple[list[_Leaf], list[Enclosed]]:
        """Inputs that move over a part of the range, and all inputs as enclosures."""
        inputs = [Enclosed.constant(float(x)) for x in self.values]
        leaves: list[_Leaf] = []
        groups: dict[int, list[MovingInput]] = {}
        for x in self.moving:
            groups.setdefault(x.quantity, []).append(x)
        for j, members in groups.items():
            ends = [tuple(float(x.at(float(side[j]))) for side in box) for x in members]
            log = all(min(pair) > 0 for pair in ends)
            widths = [abs(last - first) for first, last in ends]
            lead = int(np.argmax(widths))
            for k, (x, (first, last)) in enumerate(zip(members, ends, strict=True)):
                # Members move in proportion to one another: by the same logarithm.
                size = 1.0 if log or k == lead else widths[k] / (widths[lead] or 1.0)
                leaf = _Leaf(x, log, size if last >= first else -size, (min(first, last), max(first, last)), k == lead)
                leaves.append(leaf)
                inputs[x.number] = leaf.enclosed(leaf.ends, float(leaf.middle(*leaf.ends)))
        return leaves, inputs


def _parts(lows: np.ndarray, highs: np.ndarray, rises: np.ndarray, falls: np.ndarray, reach: np.ndarray) -> Box:
    """Boxes with monotone directions held at their worst end; where there are none, halves across the steepest."""
    divisible = highs > lows
    held = ((rises | falls) & divisible).any(axis=1)
    low, high = np.where(rises, highs, lows)[held], np.where(falls, lows, highs)[held]
    lows, highs, divisible, reach = lows[~held], highs[~held], divisible[~held], reach[~held]
    known = np.isfinite(reach).all(axis=1, keepdims=True)
    across = np.argmax(np.where(divisible, np.where(known, reach, highs - lows), -1.0), axis=1)
    rows = np.arange(len(lows))
    left, right = highs.copy(), lows.copy()
    left[rows, across] = right[rows, across] = 0.5 * (lows + highs)[rows, across]
    return np.concatenate([low, lows, right]), np.concatenate([high, left, highs])


@dataclass(frozen=True)
class _Leaf:
    """A moving input as leaf of enclosures: its range, and its slope along the scattering quantity."""

    moving: MovingInput
    log: bool
    slope: float  # by the distance of the leading member of its quantity, negative where it falls with the position
    ends: tuple[float, float]
    leads: bool

    def enclosed(self, pair: Pair, middle: Expr) -> Enclosed:
        """Enclosure over a box within the range of the leaf."""
        low, high = self.ends
        sign = 1 if low > 0 else -1 if high < 0 else 0
        least = min(abs(low), abs(high)) if sign else 0.0
        slopes = {self.moving.quantity: (self.slope, self.slope)} if low < high else {}
        return Enclosed(pair, (middle, middle), self.log, slopes, sign, pair, pair, least)

    def middle(self, low: Expr, high: Expr) -> Any:
        """Middle of a range, in the measure in which distances count."""
        return np.sqrt(low * high) if self.log else 0.5 * (low + high)

    def half(self, low: Expr, high: Expr) -> Any:
        """Half of the width of a range in that measure."""
        return 0.5 * (np.log(high / low) if self.log else high - low)


@dataclass(frozen=True)
class _Regular:
    """Masks of boxes in which an instruction is defined at all points, and in which nothing that it reads jumps."""

    defined: Expr
    smooth: Expr


class _Regularity:
    """Proven regularity of instructions over a box, or over many boxes."""

    def __init__(self, encloser: Encloser, enclosed: Mapping[int, Enclosed]) -> None:
        self._encloser, self._enclosed, self._do = encloser, enclosed, encloser.do
        self._known: dict[int, _Regular] = {}
        for k in enclosed:
            self._known[k] = self._of(encloser.program.nodes[k])

    def of(self, nodes: Iterable[int]) -> _Regular:
        """Regularity of several instructions together."""
        known = [self._known[k] for k in nodes]
        complete = all(self._enclosed[k].complete for k in nodes)
        smooth = self._all(x.smooth for x in known) if complete else False
        return _Regular(self._all(x.defined for x in known), smooth)

    def _of(self, node: Node) -> _Regular:
        if node.op in (ca.OP_CONST, ca.OP_INPUT):
            return _Regular(True, True)
        args = [self._known[a] for a in node.args]
        ranges = [self._enclosed[a].range for a in node.args]
        if node.op not in WHERE:
            defined = self._all([*(x.defined for x in args), self._defined_for(node, ranges)])
            return _Regular(defined, self._all(x.smooth for x in args))
        # The side that is not taken may be anything.
        yes, no = self._encloser.truth(ranges[0])
        sides = list(zip((no, yes), args[1:], strict=False))
        defined = self._all([args[0].defined, *(self._either(other, x.defined) for other, x in sides)])
        smooth = self._all([self._either(yes, no), *(self._either(other, x.smooth) for other, x in sides)])
        return _Regular(defined, smooth)

    def _defined_for(self, node: Node, r: Sequence[Pair]) -> Expr:
        """Mask of boxes in which an instruction is defined for all its arguments."""
        do, op = self._do, node.op
        domain = OPERATIONS[op].domain if op in OPERATIONS else None
        if domain is not None:
            name = "less" if domain.open else "less_equal"
            above = do(name, domain.low, r[0][0])
            return above if domain.high == np.inf else do("logical_and", above, do(name, r[0][1], domain.high))
        if op in (ca.OP_DIV, ca.OP_INV):
            return self._apart_from_zero(r[-1])
        if op == ca.OP_TAN:
            return self._apart_from_zero(self._encloser.range_of(Node(ca.OP_COS, node.args), r))
        if op in (ca.OP_POW, ca.OP_CONSTPOW):
            return self._power(*r)
        if op == OP_SPECIAL:
            above = self._encloser.program.specials[int(node.constant)].above
            beyond = [] if above is None else [do("less", r[above[1]][1], r[above[0]][0])]
            return self._all([*(do("less", 0.0, low) for low, _ in r), *beyond])
        return True

    def _power(self, a: Pair, b: Pair) -> Expr:
        positive, p = self._do("less", 0.0, a[0]), b[0]
        if not is_thin(b) or isinstance(p, Ref):
            return positive
        if float(p).is_integer():
            return p >= 0 or self._apart_from_zero(a)
        return self._do("less_equal", 0.0, a[0]) if p > 0 else positive

    def _apart_from_zero(self, a: Pair) -> Expr:
        return self._either(self._do("less", 0.0, a[0]), self._do("less", a[1], 0.0))

    def _either(self, a: Expr, b: Expr) -> Expr:
        do = self._do
        return do("logical_not", do("logical_and", do("logical_not", a), do("logical_not", b)))

    def _all(self, masks: Iterable[Expr]) -> Expr:
        result: Expr = True
        for mask in masks:
            result = self._do("logical_and", result, mask)
        return result


class _Sides:
    """Both sides of a limit ``small <= large`` over a box, or over many boxes."""

    def __init__(
        self,
        encloser: Encloser,
        enclosed: Mapping[int, Enclosed],
        regularity: _Regularity,
        limit: Constraint,
        quantities: int,
    ) -> None:
        sides = [enclosed[n] if isinstance(n, int) else Enclosed.constant(float(n)) for n in (limit.value, limit.bound)]
        self.small, self.large = sides if limit.sense == "at_most" else sides[::-1]
        self.regular = regularity.of(limit.nodes)
        self.log = self.small.sign > 0 and self.large.sign > 0
        small_slopes = encloser.logarithmic(self.small) if self.log else encloser.linear(self.small)
        large_slopes = encloser.logarithmic(self.large) if self.log else encloser.linear(self.large)
        slopes: Slopes = encloser.merged(small_slopes, large_slopes, encloser.subtract)
        self.slopes: list[Pair] = [slopes.get(k, ZERO) for k in range(quantities)]


def _directions(slopes: np.ndarray, least: float) -> tuple[np.ndarray, np.ndarray]:
    """Masks of where a limit rises and where it falls; slopes (..., 2) below ``least`` have no sign."""
    low, high = slopes[..., 0], slopes[..., 1]
    size = np.fmax(1.0, np.fmax(np.abs(low), np.abs(high)))
    steep = least * np.where(np.isfinite(size), size, 1.0)
    rises = low >= -steep
    return rises, (high <= steep) & ~rises


@dataclass(frozen=True)
class _PartBounds:
    """Bounds of many boxes: where the limit holds; per quantity where it is monotone, and by how much it moves."""

    holds: np.ndarray
    rises: np.ndarray
    falls: np.ndarray
    reach: np.ndarray


class _RecordedBounds:
    """Bounds of one limit, recorded once for any parts of a box."""

    def __init__(self, around: LimitBounds, limit: Constraint, box: Box, size: float) -> None:
        self._limit, self._size, self._settings = limit, size, around.settings
        program, quantities = around.program, around.quantities
        leaves, inputs = around.leaves(box)
        self.leaves = [leaf for leaf in leaves if leaf.ends[0] < leaf.ends[1]]
        order = around.needed([limit])
        with np.errstate(all="ignore"):
            scout = Encloser(Tape(), program)
            scout.run(program.nodes, order, inputs)
            tape, handed = Tape(), list[Ref]()
            for leaf in self.leaves:
                side = 1 if leaf.ends[0] >= 0 else -1 if leaf.ends[1] <= 0 else 0
                refs = [tape.leaf(side) for _ in range(3)]
                handed += refs
                inputs[leaf.moving.number] = leaf.enclosed((refs[0], refs[1]), refs[2])
            encloser = Encloser(tape, program, known=scout.record)
            enclosed = encloser.run(program.nodes, order, inputs)
            sides = _Sides(encloser, enclosed, _Regularity(encloser, enclosed), limit, quantities)
        self._log = sides.log
        ends = [sides.small.range[1], sides.large.range[0], sides.small.center[1], sides.large.center[0]]
        slopes = [end for pair in sides.slopes for end in pair]
        self._kernel = tape.kernel(handed, [sides.regular.defined, sides.regular.smooth, *ends, *slopes])

    def of(self, lows: np.ndarray, highs: np.ndarray) -> _PartBounds:
        """Bounds over boxes (boxes, quantities)."""
        handed: list[np.ndarray] = []
        halves = np.zeros_like(lows)
        for leaf in self.leaves:
            j = leaf.moving.quantity
            ends = [np.asarray(leaf.moving.at(side[:, j]), dtype=float) for side in (lows, highs)]
            low, high = np.minimum(*ends), np.maximum(*ends)
            handed += [low, high, leaf.middle(low, high)]
            if leaf.leads:
                halves[:, j] = leaf.half(low, high)
        with np.errstate(all="ignore"):
            outputs = [np.broadcast_to(np.asarray(x, dtype=float), (len(lows),)) for x in self._kernel.run(handed)]
            defined, smooth = outputs[0] > 0.5, outputs[1] > 0.5
            slopes = np.stack(outputs[6:], axis=-1).reshape(*lows.shape, 2)
            reach = np.where(halves > 0, np.abs(slopes).max(axis=2) * halves, 0.0)
            rises, falls = _directions(slopes, self._settings.steep)
            certain = (smooth & defined)[:, None]
            proven = defined & self._below(outputs[2:6], reach.sum(axis=1))
        return _PartBounds(proven, rises & certain, falls & certain, reach)

    def _below(self, ends: list[np.ndarray], reach: np.ndarray) -> np.ndarray:
        """Mask of boxes in which the limit holds everywhere: by both ranges, or by slopes from the middle."""
        most, least, top, bottom = ends
        pad = self._settings.pad
        tolerance = -pad if self._limit.guard else TOLERANCE - pad
        beyond = np.fmin(most - least, math.inf if self._log else top - bottom + reach)
        below = beyond <= tolerance * self._size
        if self._log:
            below |= (top > 0) & (bottom > 0) & (np.log(top) - np.log(bottom) + reach <= tolerance)
        return np.asarray(below)
