"""The one definition of feasible, and utilisation as people read it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.order.feasibility import TOLERANCE, Status, binds, holds, missed_share, most_used, residual, utilisation

SENSES = ("at_most", "at_least", "equal")
NUMBERS = st.floats(-1e9, 1e9, allow_nan=False)


@pytest.mark.parametrize(
    ("value", "limit", "sense", "expected"),
    [
        (90.0, 100.0, "at_most", -0.1),
        (110.0, 100.0, "at_most", 10 / 110),
        (90.0, 100.0, "at_least", 0.1),
        (110.0, 100.0, "at_least", -10 / 110),
        (99.0, 100.0, "equal", 0.01),
        (100.0, 99.0, "equal", 0.01),
        (0.0, 0.0, "at_most", 0.0),
        (-5.0, 5.0, "at_most", -2.0),
        (5.0, -5.0, "at_most", 2.0),
        (5.0, 0.0, "at_most", 1.0),
        (1e-10, 0.0, "at_most", 0.1),  # below the scale a difference counts little
    ],
)
def test_residual(value, limit, sense, expected):
    assert residual(value, limit, sense, 1e-9) == pytest.approx(expected)


def test_the_tolerance_is_one_part_in_a_million():
    assert TOLERANCE == 1e-6
    limit = 250.0
    assert holds(residual(limit * (1 + 0.999e-6), limit, "at_most", 1e-9), guard=False)
    assert not holds(residual(limit * (1 + 1.002e-6), limit, "at_most", 1e-9), guard=False)
    assert holds(residual(limit * (1 - 0.999e-6), limit, "at_least", 1e-9), guard=False)
    assert not holds(residual(limit * (1 - 1.002e-6), limit, "at_least", 1e-9), guard=False)
    assert holds(residual(limit * (1 + 0.999e-6), limit, "equal", 1e-9), guard=False)
    assert not holds(residual(limit * (1 - 1.002e-6), limit, "equal", 1e-9), guard=False)


def test_a_guard_is_strict():
    assert not holds(residual(100.0, 100.0, "at_least", 1e-9), guard=True)
    assert holds(residual(np.nextafter(100.0, 200.0), 100.0, "at_least", 1e-9), guard=True)
    assert holds(residual(100.0, 100.0, "at_least", 1e-9), guard=False)


@pytest.mark.parametrize("guard", [False, True])
def test_what_does_not_exist_does_not_hold(guard):
    assert not holds(residual(float("nan"), 1.0, "at_most", 1e-9), guard)
    assert not holds(residual(1.0, float("nan"), "at_least", 1e-9), guard)


def test_whole_batches_are_judged_at_once():
    r = residual(np.array([1.0, 2.0, np.nan]), np.array([2.0, 1.0, 1.0]), "at_most", 1e-9)
    assert holds(r, guard=False).tolist() == [True, False, False]


@given(NUMBERS, NUMBERS, st.sampled_from(SENSES), st.sampled_from([1e-9, 1e-3, 1.0]))
@settings(deadline=None, derandomize=True)
def test_the_sign_of_the_residual_tells_the_side(value, limit, sense, scale):
    r = residual(value, limit, sense, scale)
    assert abs(r) <= 2.0
    right = {"at_most": value <= limit, "at_least": value >= limit, "equal": value == limit}[sense]
    assert (r <= 0) == right
    if sense != "equal":
        mirrored = residual(-value, -limit, "at_least" if sense == "at_most" else "at_most", scale)
        assert mirrored == r


@given(st.floats(1e-6, 1e6), st.floats(1e-6, 1e6), st.sampled_from(SENSES), st.floats(1e-3, 1e3))
@settings(deadline=None, derandomize=True)
def test_the_unit_does_not_matter(value, limit, sense, factor):
    assert residual(value * factor, limit * factor, sense, 1e-12) == pytest.approx(
        residual(value, limit, sense, 1e-12), abs=1e-12
    )


@pytest.mark.parametrize(
    ("value", "limit", "sense", "expected"),
    [
        (90.0, 100.0, "at_most", 0.9),
        (110.0, 100.0, "at_most", 1.1),
        (125.0, 100.0, "at_least", 0.8),
        (80.0, 100.0, "at_least", 1.25),
        (-1.0, 100.0, "at_most", 0.0),
        (-1.0, -2.0, "at_most", np.inf),
        (0.0, 100.0, "at_most", 0.0),
        (1.0, 0.0, "at_most", np.inf),
        (0.0, 0.0, "at_most", 0.0),
        (5.0, -1.0, "at_least", 0.0),
        (-5.0, -1.0, "at_least", np.inf),
        (0.0, 3.0, "at_least", np.inf),
        (3.0, 3.0, "equal", 1.0),
        (4.0, 2.0, "equal", 2.0),
        (2.0, 4.0, "equal", 2.0),
        (0.0, 0.0, "equal", 1.0),
        (-2.0, 2.0, "equal", np.inf),
        (0.0, 2.0, "equal", np.inf),
    ],
)
def test_utilisation(value, limit, sense, expected):
    assert float(utilisation(value, limit, sense)) == pytest.approx(expected)


@given(NUMBERS, NUMBERS, st.sampled_from(("at_most", "at_least")))
@settings(deadline=None, derandomize=True)
def test_utilisation_agrees_with_the_residual(value, limit, sense):
    used = float(utilisation(value, limit, sense))
    assert used >= 0
    r = residual(value, limit, sense, 1e-9)
    if r < -1e-9:
        assert used <= 1
    if r > 1e-9:
        assert used >= 1


def test_status_reads_as_its_word():
    assert {s.value for s in Status} == {"optimal", "feasible", "infeasible", "not_found", "not_solved", "failed"}
    assert Status("optimal") is Status.OPTIMAL


@given(
    st.lists(st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3), st.sampled_from(("at_most", "at_least")))),
    st.floats(0.0, 1.0),
)
@settings(deadline=None, derandomize=True)
def test_what_is_missed_ranks_limits_as_what_is_used_does(limits, scale):
    used = {str(k): float(utilisation(*x)) for k, x in enumerate(limits)}
    missed = {name: float(missed_share(*x, scale)) for name, x in zip(used, limits, strict=True)}
    for name, share in used.items():
        assert missed[name] == pytest.approx(1 - 1 / share if share > 1 else share - 1, rel=1e-9, abs=1e-12)
    order = [used[name] for name in most_used(used)]
    assert order == sorted(used.values(), reverse=True)


@pytest.mark.parametrize(
    ("used", "sense", "told"),
    [
        (1.0, "at_most", True),
        (0.99, "at_most", False),
        (1.0, "equal", False),
        (None, "at_least", False),
        (np.inf, "at_least", True),
    ],
)
def test_a_limit_that_is_reached_binds(used, sense, told):
    assert binds(used, sense) is told
