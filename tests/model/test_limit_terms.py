"""The size of a limit is that of its terms: it does not hang on the side on which a zero is written."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

import synth
from synth import DesignProblem
from synth.model.limit_terms import NEAR_ZERO, LimitTerms
from synth.model.program import Program

RNG = np.random.default_rng(7)


def largest_term(expression, x, points, near_zero=None, not_negative=frozenset()):
    """Size of the largest term of an expression of symbols at points (points, symbols)."""
    program = Program(x, [expression])
    node = LimitTerms(program, len(x), near_zero or {}, frozenset(not_negative)).of(program.outputs)
    if node is None:
        node = program.node(ca.OP_FABS, (program.outputs[0],))
    return np.broadcast_to(program.compile([node])(list(points.T))[0], len(points))


def test_of_a_sum_it_is_the_largest_summand():
    x = [ca.SX.sym(f"x{k}") for k in range(3)]
    points = RNG.uniform(-3, 3, (50, 3))
    found = largest_term(2 * x[0] * x[1] - x[2] ** 2 + 0.5, x, points)
    summands = np.array([2 * points[:, 0] * points[:, 1], points[:, 2] ** 2, np.full(50, 0.5)])
    np.testing.assert_allclose(found, np.abs(summands).max(axis=0), rtol=1e-12)


def test_products_of_sums_count_as_if_they_were_multiplied_out():
    x = [ca.SX.sym(f"x{k}") for k in range(3)]
    points = RNG.uniform(0.5, 3, (50, 3))
    found = largest_term(x[0] * (x[1] - x[2]), x, points)
    np.testing.assert_allclose(found, points[:, 0] * np.maximum(points[:, 1], points[:, 2]), rtol=1e-12)


@pytest.mark.parametrize(
    ("formula", "value", "size"),
    [
        (lambda x: ca.log(x), 1.0, 1.0),
        (lambda x: ca.sin(x), np.pi, np.pi),
        (lambda x: ca.cos(x), np.pi / 2, np.pi / 2),
        (lambda x: ca.tan(x), np.pi, np.pi),
        (lambda x: (x - 1) ** 2, 1.0 + 1e-6, 1e-6),
        (lambda x: (x - 1) ** 3, 1.0 + 1e-3, 1e-6),
        (lambda x: ca.sqrt(x * x - 1), 1.0, 1.0),
        (lambda x: 1 / (1 + (x - 2)), 2.0, 2.0),
        (lambda x: ca.fmax(x - 2, 3 - x), 2.5, 2.5),
    ],
)
def test_where_a_function_is_zero_its_argument_tells_the_size(formula, value, size):
    x = ca.SX.sym("x")
    found = float(largest_term(formula(x), [x], np.array([[value]]))[0])
    assert found == pytest.approx(size, rel=2e-3)


def test_what_does_not_cancel_needs_no_node_of_its_own():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [x * y**2 / (1 + x), x + ca.exp(y)])
    terms = LimitTerms(program, 2, {}, frozenset({0, 1}))
    assert [terms.of([k]) for k in program.outputs] == [None, None]


def test_a_variable_that_can_be_zero_has_a_size_there():
    x = ca.SX.sym("x")
    found = largest_term(x, [x], np.array([[0.0], [1e-9], [3.0]]), near_zero={0: NEAR_ZERO * 10})
    np.testing.assert_allclose(found, [1e-5, 1e-5, 3.0])


@pytest.mark.slow
def test_formulas_nested_more_deeply_than_python_calls():
    x = ca.SX.sym("x")
    deep = x
    for k in range(1200):
        deep = ca.sqrt(deep * deep + 0.001 * k) - 1e-6
    assert np.isfinite(largest_term(deep - 2, [x], np.array([[1.5]]))).all()


# -- claims ------------------------------------------------------------------------------------------


def problem(declared):
    class Own(DesignProblem):
        """A problem of one's own."""

        name, title, sources = "own", "Own problem", ("none",)

        def declare(self, d):
            declared(d)

    return Own


def written(d, name, sense, left, right, way):
    """State a limit between two sums with all on the left, all on the right, or as it is."""
    limit = {"at_most": d.at_most, "at_least": d.at_least, "equal": d.equal}
    turned = {"at_most": "at_least", "at_least": "at_most", "equal": "equal"}
    if way == "two sides":
        limit[sense](name, left, right, "-")
    elif way == "zero right":
        limit[sense](name, left - right, 0, "-")
    else:
        limit[turned[sense]](name, ca.SX(0), left - right, "-")


WAYS = ("two sides", "zero right", "zero left")


@pytest.mark.parametrize("way", WAYS)
def test_redundancy_is_allocated_as_well_with_zero_on_either_side(way):
    def declared(d):
        x = d.variable("x", "-", 0, 0.9985)
        b = [d.count(f"b{k}", 0, 1) for k in range(3)]
        cost = 2.9957 * b[0] + 1.6094 * b[1] + 1.8971 * b[2]
        written(d, "reliability", "equal", -ca.log(1 - x), cost, way)
        d.at_most("budget", 3 * b[0] + 2 * b[1] + b[2], 4, "-")
        d.derive("risk", "-", 1 - x)
        d.objective("risk", "min")

    front = synth.synthesize(problem(declared), {})
    best = min(
        np.exp(-(2.9957 * a + 1.6094 * b + 1.8971 * c))
        for a in (0, 1)
        for b in (0, 1)
        for c in (0, 1)
        if 3 * a + 2 * b + c <= 4
    )
    assert front.certificate.kind == "global"
    assert front.designs[0].objectives["risk"] == pytest.approx(best, rel=1e-3)
    assert synth.verify(front, problem(declared)).holds


@pytest.mark.parametrize("way", WAYS)
def test_a_unit_that_is_switched_off_delivers_nothing(way):
    def declared(d):
        v, e, b = d.variable("v", "-", 0, 10), d.variable("e", "-", 0, 10), d.count("b", 0, 1)
        written(d, "delivered", "equal", e, 0.8 * (1 - ca.exp(-0.4 * v)) * b, way)
        written(d, "running", "at_most", v, 10 * b, way)
        d.derive("cost", "-", 1 + 2 * b + v - 0.5 * e)
        d.objective("cost", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.certificate.kind == "global"
    assert front.designs[0].objectives["cost"] == pytest.approx(1.0, rel=1e-3)
    assert synth.verify(front, problem(declared)).holds


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("way", WAYS)
def test_claims_do_not_hang_on_the_unit_of_a_limit(way, scale):
    def declared(d):
        x, y = d.variable("x", "-", 1 * scale, 9 * scale), d.variable("y", "-", 1 * scale, 9 * scale)
        written(d, "area", "at_least", x * y, 8 * scale**2, way)
        d.derive("effort", "-", x + 2 * y)
        d.objective("effort", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.certificate.kind == "global"
    assert front.designs[0].objectives["effort"] == pytest.approx(8 * scale, rel=1e-3)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("sense", ["at_most", "at_least", "equal"])
def test_sides_that_counts_alone_move_cancel_as_well(sense, way):
    """In floating point 3 times 0.1 is not 0.3."""

    def declared(d):
        x, k = d.variable("x", "-", 1, 2), d.count("k", 0, 6)
        written(d, "steps", sense, 0.1 * k, ca.SX(0.3), way)
        d.derive("cost", "-", x + (10 - k if sense == "at_most" else k))
        d.objective("cost", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.certificate.kind == "global"
    assert front.designs[0].values["k"] == 3
    assert not front.designs[0].violated
    assert synth.verify(front, problem(declared)).holds


def test_what_is_asked_may_be_a_difference():
    def declared(d):
        outer, wall = (d.requirement(name, "-", default) for name, default in (("outer", 0.3), ("wall", 0.1)))
        x, y = d.variable("x", "-", 0.1, 2), d.variable("y", "-", 0.1, 2)
        d.equal("fit", x - y, outer - 3 * wall, "-")
        d.derive("cost", "-", x + 2 / y)
        d.objective("cost", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.designs[0].objectives["cost"] == pytest.approx(2 * 2**0.5, rel=1e-3)


@pytest.mark.parametrize(
    "vanishing",
    [
        lambda x, k: ca.sin(2 * x * k),
        lambda x, k: ca.tanh(k * x) * k,
        lambda x, k: x * k * (x + 2.8 * (x - 1)),
        lambda x, k: ca.sin(2.3 * k) * (x - 1.9),
    ],
)
@pytest.mark.parametrize("sense", ["at_most", "equal"])
def test_a_limit_holds_where_all_of_its_terms_are_zero(sense, vanishing):
    def declared(d):
        x, k = d.variable("x", "-", 2.2, 3), d.count("k", 0, 3)
        written(d, "nothing", sense, vanishing(x, k), ca.SX(0), "two sides")
        d.derive("cost", "-", x + k)
        d.objective("cost", "min")

    front = synth.synthesize(problem(declared), {})
    assert front.certificate.kind == "global"
    assert not front.designs[0].violated
    assert synth.verify(front, problem(declared)).findings == ()


def test_what_is_left_of_large_terms_may_differ_by_their_rounding():
    def declared(d):
        x, y = d.variable("x", "-", 1, 900), d.variable("y", "-", 1, 900)
        d.at_most("level", 1e6 * (ca.log(x * y) - 0.13 * (x - y)) - 1e6 * ca.sqrt(17 * x), 0, "-")
        d.at_least("size", x + y / 7, 100 * ca.sqrt(3), "-")
        d.derive("cost", "-", x + y)
        d.objective("cost", "min")

    front = synth.synthesize(problem(declared), {})
    assert synth.verify(front, problem(declared)).findings == ()
