"""The rules of interval arithmetic never lose a point: every operation alone, forward and backward."""

import casadi as ca
import numpy as np
import pytest
from scipy.special import erf

from synth.bounds.intervals import BACKWARD, FORWARD, backward, loosened
from synth.model.program import OPERATIONS
from synth.order.feasibility import SLACK

RELATIVE, ABSOLUTE = 1e-12, 1e-13
TRUTHS = {ca.OP_NOT, ca.OP_AND, ca.OP_OR}


def name_of(op):
    return next((n for n in dir(ca) if n.startswith("OP_") and getattr(ca, n) == op), "OP_SELECT")


def apply(op, args):
    """Carry out one operation on arrays, with the code that the generator writes."""
    scope = {"np": np, "erf": erf, **{f"a{k}": x for k, x in enumerate(args)}}
    code = OPERATIONS[op].numeric.format(*(f"a{k}" for k in range(len(args))))
    with np.errstate(all="ignore"):
        return np.asarray(eval(code, scope), dtype=float)


def random_arguments(op, rng, boxes, samples):
    """Return intervals of the arguments and points inside them, ends and zero included."""
    intervals, points = [], []
    for position in range(OPERATIONS[op].arity):
        low, high, domain = -4.0, 4.0, OPERATIONS[op].domain
        if domain is not None:
            inside = 1e-3 if domain.open else 0.0
            low, high = domain.low + inside, min(domain.high - inside, 5.0)
        if op in (ca.OP_POW, ca.OP_CONSTPOW) and position == 0:
            low, high = (0.01, 4.0)
        ends = np.sort(rng.uniform(low, high, (2, boxes)), axis=0)
        narrow = rng.random(boxes) < 0.3
        ends[1] = np.where(narrow, ends[0], ends[1])
        if low < 0 < high:  # ends that are exactly zero are where signs are decided
            ends[0] = np.where((rng.random(boxes) < 0.15) & (ends[1] > 0), 0.0, ends[0])
            ends[1] = np.where((rng.random(boxes) < 0.15) & (ends[0] < 0), 0.0, ends[1])
        if op in TRUTHS or (position == 0 and op in (ca.OP_IF_ELSE_ZERO, -1)):
            ends = np.sort(rng.integers(0, 2, (2, boxes)), axis=0).astype(float)
        share = rng.random((samples, boxes))
        if samples > 2:
            share[0], share[1] = 0.0, 1.0
        if op in TRUTHS or (position == 0 and op in (ca.OP_IF_ELSE_ZERO, -1)):
            share = np.round(share)
        value = np.clip(ends[0] + share * (ends[1] - ends[0]), ends[0], ends[1])
        if low < 0 < high and samples > 2:
            value[2] = np.clip(0.0, ends[0], ends[1])
        intervals.append((ends[0], ends[1]))
        points.append(rng.permuted(value, axis=0))
    if op in (ca.OP_POW, ca.OP_CONSTPOW) and op == ca.OP_CONSTPOW:
        exponent = np.asarray(float(rng.choice([-2.5, -1.0, 0.0, 0.5, 2.0, 3.0])))
        intervals[1], points[1] = (exponent, exponent), exponent
    return intervals, points


def inside(value, interval):
    low, high = interval
    slack = ABSOLUTE + RELATIVE * np.abs(value)
    # Not-a-number as an end says nothing, and nothing is known of a value that does not exist.
    return np.isnan(value) | ~((value < low - slack) | (value > high + slack))


@pytest.mark.slow
@pytest.mark.parametrize("op", sorted(FORWARD), ids=name_of)
def test_forward_rules_hold_every_value(op):
    rng = np.random.default_rng(abs(op))
    for _ in range(4):
        intervals, points = random_arguments(op, rng, 200, 1000)
        with np.errstate(all="ignore"):
            result = FORWARD[op](*intervals)
        assert inside(apply(op, points), result).all()


def test_forward_rules_are_known_for_nearly_every_operation():
    # Without a rule nothing is known of the value, which is sound; these few are rare in engineering formulas.
    assert set(OPERATIONS) - set(FORWARD) == {ca.OP_FMOD, ca.OP_COPYSIGN, ca.OP_ERF}


@pytest.mark.parametrize("op", [ca.OP_POW, ca.OP_CONSTPOW], ids=name_of)
def test_whole_powers_of_negative_bases(op):
    rng = np.random.default_rng(3)
    ends = np.sort(rng.uniform(-3, 3, (2, 500)), axis=0)
    points = ends[0] + rng.random((50, 500)) * (ends[1] - ends[0])
    for exponent in (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 0.5):
        with np.errstate(all="ignore"):
            result = FORWARD[op]((ends[0], ends[1]), (np.asarray(exponent), np.asarray(exponent)))
            value = points**exponent
        assert inside(value, result).all(), exponent


@pytest.mark.parametrize("op", sorted(BACKWARD), ids=name_of)
def test_backward_rules_cut_off_no_argument(op):
    rng = np.random.default_rng(100 + abs(op))
    for _ in range(8):
        intervals, points = random_arguments(op, rng, 300, 1)
        points = [p[0] if np.ndim(p) else p for p in points]
        value = apply(op, points)
        with np.errstate(all="ignore"):
            natural = FORWARD[op](*intervals)
            # What the limits left of the node: something around the value, sometimes open, sometimes only it.
            width = rng.exponential(1.0, (2, 300)) * (rng.random((2, 300)) < 0.7)
            low, high = np.maximum(natural[0], value - width[0]), np.minimum(natural[1], value + width[1])
            low = np.where(rng.random(300) < 0.2, natural[0], low)
            high = np.where(rng.random(300) < 0.2, natural[1], high)
            exists = ~np.isnan(value)
            cuts = backward(op, (low, high), intervals)
        assert len(cuts) == len(intervals)
        for point, cut in zip(points, cuts, strict=True):
            if cut is not None:
                slack = 1e-9 * (1 + np.abs(point))  # an inverse magnifies rounding
                wrong = (point < cut[0] - slack) | (point > cut[1] + slack)
                assert not np.any(wrong & exists)


@pytest.mark.parametrize(
    ("op", "formula", "points"),
    [
        (ca.OP_EXPM1, np.expm1, -np.linspace(5, 36, 200)),
        (ca.OP_EXPM1, np.expm1, np.geomspace(1e-12, 5, 200)),
        (ca.OP_EXP, np.exp, np.geomspace(1e-15, 1e-3, 200)),
        (ca.OP_EXP, np.exp, -np.geomspace(1e-15, 50, 200)),
    ],
)
def test_inverses_keep_arguments_that_rounding_has_nearly_lost(op, formula, points):
    value = formula(points)
    for rounded in (value, np.nextafter(value, -np.inf), np.nextafter(value, np.inf)):
        with np.errstate(divide="ignore"):  # where nothing is left of the argument it may be anything
            ((low, high),) = backward(op, (rounded, rounded), [(points, points)])
        assert np.all((low <= points) & (points <= high))


def test_limits_are_loosened_outward():
    assert loosened(np.array(10.0), 1e-9, SLACK) == pytest.approx(10.0 * (1 + SLACK), rel=1e-15)
    assert loosened(np.array(-10.0), 1e-9, SLACK) == pytest.approx(-10.0 * (1 - SLACK), rel=1e-15)
    assert loosened(np.array(0.0), 0.5, -SLACK) == -0.5 * SLACK
    assert SLACK >= 2e-6  # twice the tolerance of feasibility
