"""Enclosures hold what they enclose: ranges, narrow ranges, centers and slopes, for any formula and box."""

import itertools
import math

import casadi as ca
import numpy as np
import pytest

from synth.model.program import Program
from synth.proof.enclosure import Enclosed, Encloser, NodeComparison
from synth.proof.interval_arithmetic import ANYTHING, INF, Arithmetic
from synth.proof.tape import Ref, Tape, sign_of
from synth.special import recorded
from tests.proof.random_formulas import grown

ENDS = [-3.0, -1.0, 0.0, 1.0, 2.0]
PAIRS = [(a, b) for a in ENDS for b in ENDS if a <= b]
NAMES = ("add", "subtract", "multiply", "divide")
OF_FLOATS = {
    "add": lambda x, y: x + y,
    "subtract": lambda x, y: x - y,
    "multiply": lambda x, y: x * y,
    "divide": lambda x, y: x / y if y else math.nan,
}


def sign(pair):
    return 1 if pair[0] >= 0 else -1 if pair[1] <= 0 else 0


# -- the tape ----------------------------------------------------------------------------------------


def test_what_is_the_same_in_all_boxes_is_computed_at_once():
    tape = Tape()
    assert tape.do("add", 1.0, 2.0) == 3.0
    assert tape.do("less", 1.0, 2.0) is True
    x = tape.leaf()
    assert tape.do("add", x, 0.0) is x
    assert tape.do("multiply", x, 0.0) == 0.0
    assert tape.do("add", x, 1.0) is tape.do("add", x, 1.0)
    assert len(tape.instructions) == 1


def test_registers_are_handed_on_without_mixing_anything_up():
    rng = np.random.default_rng(5)
    names = ["add", "multiply", "subtract", "maximum", "fmin", "negative", "sin", "where"]
    for _ in range(20):
        tape = Tape()
        leaves = [tape.leaf() for _ in range(3)]
        arrays = [rng.normal(size=7) for _ in leaves]
        exprs, values = list(leaves), list(arrays)
        for _ in range(60):
            a, b, c = rng.integers(0, len(exprs), 3)
            name = names[rng.integers(len(names))]
            if name == "where":
                exprs.append(tape.where(tape.do("less", exprs[a], exprs[b]), exprs[b], exprs[c]))
                values.append(np.where(values[a] < values[b], values[b], values[c]))
            elif name in ("negative", "sin"):
                exprs.append(tape.do(name, exprs[a]))
                values.append(getattr(np, name)(values[a]))
            else:
                exprs.append(tape.do(name, exprs[a], exprs[b]))
                values.append(getattr(np, name)(values[a], values[b]))
        wanted = sorted({int(k) for k in rng.integers(3, len(exprs), 6)})
        kernel = tape.kernel(leaves, [exprs[k] for k in wanted])
        for _ in range(2):
            for got, k in zip(kernel.run(arrays), wanted, strict=True):
                assert np.array_equal(np.broadcast_to(got, 7), values[k])


# -- interval arithmetic -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", NAMES)
def test_arithmetic_is_right_for_all_signs(name):
    for a, b in itertools.product(PAIRS, PAIRS):
        if name == "divide" and b[0] <= 0 <= b[1]:
            continue
        corners = [OF_FLOATS[name](x, y) for x in a for y in b]
        right = pytest.approx((min(corners), max(corners)), abs=1e-15)
        with np.errstate(all="ignore"):
            assert getattr(Arithmetic(Tape()), name)(a, b) == right
        tape = Tape()
        pairs = [(tape.leaf(sign(p)), tape.leaf(sign(p))) for p in (a, b)]
        out = getattr(Arithmetic(tape), name)(*pairs)
        kernel = tape.kernel([*pairs[0], *pairs[1]], out)
        assert tuple(float(x[0]) for x in kernel.run([np.array([x]) for x in (*a, *b)])) == right


def test_a_divisor_that_may_be_zero_leaves_anything_possible():
    with np.errstate(all="ignore"):
        assert Arithmetic(Tape()).divide((1.0, 2.0), (-1.0, 1.0)) == ANYTHING
    tape = Tape()
    ends = [tape.leaf() for _ in range(4)]
    kernel = tape.kernel(ends, Arithmetic(tape).divide((ends[0], ends[1]), (ends[2], ends[3])))
    boxes = np.array([[1.0, 2.0, -1.0, 1.0], [1.0, 2.0, 1.0, 4.0], [-1.0, 2.0, -4.0, -2.0]]).T
    with np.errstate(all="ignore"):
        low, high = kernel.run(list(boxes))
    assert low.tolist() == [-INF, 0.25, -1.0]
    assert high.tolist() == [INF, 2.0, 0.5]


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_a_divisor_that_reaches_zero_from_one_side_stays_on_it(zero, known):
    for divisor, right in (((zero, 2.0), (0.5, INF)), ((-2.0, zero), (-INF, -0.5))):
        with np.errstate(all="ignore"):
            found = Arithmetic(Tape()).divide((1.0, 1.0), divisor)
        assert found[0] <= right[0]
        assert found[1] >= right[1]
        tape = Tape()
        side = sign(divisor) if known else 0
        b = tape.leaf(side), tape.leaf(side)
        kernel = tape.kernel([*b], Arithmetic(tape).divide((1.0, 1.0), b))
        with np.errstate(all="ignore"):
            assert tuple(float(x[0]) for x in kernel.run([np.array([x]) for x in divisor])) == right


# -- whole formulas ----------------------------------------------------------------------------------


class Traced:
    """Random formulas over boxes of three inputs, the first surely positive."""

    LOW, HIGH = np.array([0.4, -2.0, 0.0]), np.array([3.0, 1.5, 2.0])

    def __init__(self, seed, cuts=None):
        rng = np.random.default_rng(seed)
        symbols = [ca.SX.sym(f"x{k}") for k in range(3)]
        with recorded() as calls:
            formulas = grown(rng, symbols, 14)
        self.program = Program(symbols, formulas, calls)
        self.order = self.program.needed(self.program.outputs)
        self.evaluate = self.program.compile(self.order)
        self.log = self.LOW > 0
        scout = Encloser(Tape(), self.program)
        root = [self.leaf(k, (float(a), float(b)), float(c)) for k, (a, b, c) in enumerate(self.root())]
        with np.errstate(all="ignore"):
            scout.run(self.program.nodes, self.order, root)
            self.tape = Tape()
            self.ends = [
                (self.tape.leaf(sign(p)), self.tape.leaf(sign(p))) for p in zip(self.LOW, self.HIGH, strict=True)
            ]
            self.middles = [self.tape.leaf(self.ends[k][0].sign) for k in range(3)]
            self.encloser = Encloser(self.tape, self.program, known=scout.record)
            leaves = [self.leaf(k, self.ends[k], self.middles[k]) for k in range(3)]
            self.cuts = {} if cuts is None else cuts(self.program)
            self.found = self.encloser.run(self.program.nodes, self.order, leaves, self.cuts)

    def root(self):
        middle = np.where(self.log, np.sqrt(np.abs(self.LOW * self.HIGH)), 0.5 * (self.LOW + self.HIGH))
        return zip(self.LOW, self.HIGH, middle, strict=True)

    def leaf(self, k, pair, middle):
        surely = 1 if self.LOW[k] > 0 else 0
        least = max(float(self.LOW[k]), 0.0)
        return Enclosed(pair, (middle, middle), bool(self.log[k]), {k: (1.0, 1.0)}, surely, pair, pair, least)

    def boxes(self, rng, count):
        """Return boxes of all sizes and their middles."""
        share = np.sort(rng.random((2, 3, count)) ** np.array([1.0, 1.0])[:, None, None], axis=0)
        size = 10.0 ** rng.uniform(-6, 0, count)
        share[1] = share[0] + (share[1] - share[0]) * size
        low, high = (self.LOW[:, None] + (self.HIGH - self.LOW)[:, None] * s for s in share)
        with np.errstate(all="ignore"):
            middle = np.where(self.log[:, None], np.sqrt(low * high), 0.5 * (low + high))
        return low, high, middle

    def run(self, low, high, middle, outputs):
        handed = [x for k in range(3) for x in (low[k], high[k])] + list(middle)
        kernel = self.tape.kernel([x for pair in self.ends for x in pair] + self.middles, outputs)
        with np.errstate(all="ignore"):
            return [np.broadcast_to(np.asarray(x, dtype=float), low.shape[1]).copy() for x in kernel.run(handed)]

    def values(self, x):
        with np.errstate(all="ignore"):
            return dict(zip(self.order, self.evaluate(list(x)), strict=True))

    @staticmethod
    def exists(values, count):
        """Return where all special functions exist; elsewhere no design is feasible, by a guard."""
        return ~np.any([np.isnan(np.broadcast_to(v, count)) for v in values.values()], axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_every_value_lies_in_its_range_and_at_center_plus_slopes(seed):
    traced, rng = Traced(seed), np.random.default_rng(seed)
    low, high, middle = traced.boxes(rng, 200)
    nodes = [k for k in traced.order if isinstance(traced.found[k].range[0], Ref)]
    outputs, kept = [], []
    for k in nodes:
        v = traced.found[k]
        kept.append((k, v.log, list(v.slopes)))
        outputs += [*v.range, *v.center, *(end for s in v.slopes.values() for end in s)]
    results = iter(traced.run(low, high, middle, outputs))
    enclosed = [
        (k, log, slopes, [next(results) for _ in range(4)], [(next(results), next(results)) for _ in slopes])
        for k, log, slopes in kept
    ]
    for _ in range(5):
        x = low + (high - low) * rng.choice([0.0, 0.3, 0.77, 1.0], low.shape)
        values = traced.values(x)
        exists = traced.exists(values, low.shape[1])
        with np.errstate(all="ignore"):
            distance = np.where(traced.log[:, None], np.log(x / middle), x - middle)
            for k, log, slopes, (least, most, first, last), ends in enclosed:
                value = np.broadcast_to(values[k], least.shape)
                room = 1e-9 * np.maximum(1.0, np.abs(value))
                assert not np.any(exists & ((value < least - room) | (value > most + room))), (k, seed)
                if log:
                    value, first, last = (np.log(np.abs(z)) for z in (value, first, last))
                    first, last = np.minimum(first, last), np.maximum(first, last)
                    room = 1e-9 * np.maximum(1.0, np.abs(value))
                reach = [np.stack([a * distance[q], b * distance[q]]) for q, (a, b) in zip(slopes, ends, strict=True)]
                # What is infinite or not a number says nothing.
                down = first + sum((np.nan_to_num(r, nan=-INF).min(axis=0) for r in reach), np.zeros(len(least)))
                up = last + sum((np.nan_to_num(r, nan=INF).max(axis=0) for r in reach), np.zeros(len(least)))
                assert not np.any(exists & ((value < down - room) | (value > up + room))), (k, seed)


def test_slopes_close_in_with_the_square_of_the_box():
    x = ca.SX.sym("x")
    program = Program([x], [x * x * ca.exp(-x) / (1 + x)])
    node = program.outputs[0]
    missed = []
    for half in (0.1, 0.01):
        pair = (math.exp(-half), math.exp(half))
        leaf = Enclosed(pair, (1.0, 1.0), True, {0: (1.0, 1.0)}, 1, pair, pair)
        encloser = Encloser(Tape(), program)
        v = encloser.run(program.nodes, program.needed([node]), [leaf])[node]
        low, high = encloser.logarithmic(v)[0]
        assert low < 2 - 1 - 0.5 < high  # the elasticity at 1
        missed.append((high - low) * half)
    assert missed[1] < 0.02 * missed[0]


def cut_some(program):
    """Cut three instructions by values; returns what ``Encloser.run`` takes."""
    nodes = program.outputs[-6:-1:2]
    return {
        k: [NodeComparison(0.7, 1, 1e-9, loose=2e-6)] if j % 2 else [NodeComparison(-0.4, -1, 1e-9, loose=2e-6)]
        for j, k in enumerate(dict.fromkeys(nodes))
    }


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(40))
def test_narrow_ranges_keep_every_value_that_keeps_the_limits(seed):
    traced, rng = Traced(seed, cut_some), np.random.default_rng(seed)
    low, high, middle = traced.boxes(rng, 200)
    with np.errstate(all="ignore"):
        back = traced.encloser.carried_back(traced.program.nodes, traced.order, traced.found)
    nodes = [k for k in traced.order if isinstance(traced.found[k].range[0], Ref)]
    outputs = [end for k in nodes for end in (*traced.found[k].narrow, *back[k])]
    results = np.array(traced.run(low, high, middle, outputs)).reshape(len(nodes), 4, -1)
    for _ in range(5):
        x = low + (high - low) * rng.choice([0.0, 0.3, 0.77, 1.0], low.shape)
        values = traced.values(x)
        keeps = traced.exists(values, low.shape[1])
        for k, (cut,) in traced.cuts.items():
            keeps &= np.broadcast_to(values[k] <= cut.other if cut.sense > 0 else values[k] >= cut.other, keeps.shape)
        for k, (least, most, back_least, back_most) in zip(nodes, results, strict=True):
            value = np.broadcast_to(values[k], keeps.shape)
            room = 1e-9 * np.maximum(1.0, np.abs(value))
            for a, b in ((least, most), (back_least, back_most)):
                assert not np.any(keeps & ((value < a - room) | (value > b + room))), (k, seed)


def test_a_value_that_no_feasible_design_has_is_clipped():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [1 / (x - y), x - y])
    quotient, difference = program.outputs
    root = [
        Enclosed((a, b), (c, c), True, {k: (1.0, 1.0)}, 1)
        for k, (a, b, c) in enumerate([(1.0, 4.0, 2.0), (0.5, 2.0, 1.0)])
    ]
    with np.errstate(all="ignore"):
        free = Encloser(Tape(), program).run(program.nodes, program.needed(program.outputs), root)
        assert free[quotient].range == ANYTHING
        kept = Encloser(Tape(), program, certain={difference: (0.5, 3.5)})
        found = kept.run(program.nodes, program.needed(program.outputs), root)
    assert kept.record.clips == {difference: (0.25, None)}
    assert found[quotient].range == pytest.approx((1 / 3.5, 4.0))
    assert found[quotient].log


def test_signs_are_those_of_the_root_box():
    assert (sign_of(0.0), sign_of(-1.0), sign_of(Ref(0, -1)), sign_of(math.nan)) == (1, -1, -1, 0)
    traced = Traced(3)
    assert traced.found[traced.order[0]].sign in (0, 1)
    assert any(v.sign for v in traced.found.values())
