"""Derivatives of rows against those of CasADi."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import Program
from synth.nlp.row_functions import RowFunctions
from synth.nlp.rows import Rows

N, COUNT = 3, 50

EXPRESSIONS = {
    "monomial": lambda x, y, z, d: d * x**2 * y / ca.sqrt(z),
    "posynomial": lambda x, y, z, d: x * y + d * z**-1.5 + 2 / x,
    "long sum": lambda x, y, z, d: x + y + z + x * y + d + 1 / (x + z),
    "shared sums": lambda x, y, z, d: (x + y) * (x + y + z) / (x + y - 0.1 * z) + (x + y),
    "difference": lambda x, y, z, d: (x**2 - 0.1 * y**2) * z,
    "through zero": lambda x, y, z, d: (x - y) * (z - 1) + d * (x - z) ** 2,
    "quotients": lambda x, y, z, d: (x - y) / (z + d) + d / (x + y) + (x + d) / z,
    "powers": lambda x, y, z, d: x**y + 2**z + (x + y) ** d + (1 + x) ** -2,
    "roots": lambda x, y, z, d: ca.sqrt(x + y) + ca.sqrt(x * z) - 1 / ca.sqrt(1 + z**2),
    "exponentials": lambda x, y, z, d: ca.exp(-x * y) + ca.log(x + z) + ca.expm1(x) * ca.log1p(z) + ca.log(x * y**2),
    "circle": lambda x, y, z, d: ca.sin(x) * ca.cos(y) + ca.tan(0.3 * z) + ca.atan2(x, y) + ca.atan(z) + ca.hypot(x, z),
    "arcs": lambda x, y, z, d: ca.asin(0.2 * x) - ca.acos(0.2 * y) + ca.asinh(z) + ca.acosh(1 + x) + ca.atanh(0.1 * y),
    "hyperbolic": lambda x, y, z, d: ca.sinh(x) * ca.cosh(y) + ca.tanh(z - x) + ca.erf(x * y),
    "signs": lambda x, y, z, d: ca.fabs(x - y) * z + ca.sign(y - z) * x + ca.copysign(x, y - 1) + ca.fabs(x * y),
    "steps": lambda x, y, z, d: x * ca.floor(3 * y) + ca.ceil(z) * ca.fmod(x + y, 0.7),
    "a step and a number": lambda x, y, z, d: ca.ceil(2 * x) + 1,
    "steps alone": lambda x, y, z, d: ca.floor(3 * x) + ca.ceil(y * z) + ca.sign(y - 1) + 2 + d,
    "least and most": lambda x, y, z, d: ca.fmin(x * y, z) + ca.fmax(x, d) * y - ca.fmax(x + y, 2 * z),
    "choices": lambda x, y, z, d: ca.if_else(x < y, x * z, y + z**2) / ca.if_else(ca.logic_not(z < 1), x, 0.5 + y),
    "a piece that does not count": lambda x, y, z, d: ca.if_else(x > 0, x * y, ca.log(-x)) + z,
    "no variable": lambda x, y, z, d: d + 0 * x,
    "one variable": lambda x, y, z, d: 3 * y - d,
}


def derivatives(expression, log, sense, logs):
    """Return rows, gradients and second derivatives of one limit and one objective, by both ways."""
    x = [ca.SX.sym(f"x{k}") for k in range(N)]
    d = ca.SX.sym("d")
    value = ca.SX(expression(*x, d))
    program = Program([*x, d], [value, 1 + x[0] ** 2])
    first, second = program.outputs
    rows = Rows((NodeConstraint(sense, first, None, 1e-9),), (Goal(second, -1),), (log,), (True,), (logs,) * N)
    functions = RowFunctions(program, N, rows)
    rng = np.random.default_rng(7)
    points = rng.uniform(0.3, 2.5, (N, COUNT))
    data, bound, size, scales = rng.uniform(0.4, 1.5, COUNT), 0.7, 0.3, np.array([2.0, 0.5, 3.0])
    y = np.log(points) if logs else points / scales[:, None]
    weights = rng.normal(size=(2, COUNT))
    with np.errstate(all="ignore"):
        stored = functions.compile_stored()([0.0] * N + [data, bound, size, 1.0, *scales])
        out = [np.broadcast_to(v, (COUNT,)) for v in functions.compile_point()(list(y), list(weights), stored)]
    nonzeros = len(functions.row)
    ours_j, ours_h = np.zeros((2, N, COUNT)), np.zeros((N, N, COUNT))
    for k, place in enumerate(zip(functions.row, functions.column, strict=True)):
        ours_j[place] = out[2 + k]
    for k, (a, b) in enumerate(functions.hessian):
        ours_h[a, b] = ours_h[b, a] = out[2 + nonzeros + k]

    s, w = ca.SX.sym("s", N), ca.SX.sym("w", 2)
    inputs = [ca.exp(s[k]) if logs else scales[k] * s[k] for k in range(N)]
    moved = ca.substitute([value], x, inputs)[0]
    form = ca.log(moved / bound) if log else (moved - bound) * size
    forms = ca.vertcat(-form if sense == "at_least" else form, -ca.log(1 + inputs[0] ** 2))
    function = ca.Function("f", [s, d, w], [forms, ca.jacobian(forms, s), ca.hessian(ca.dot(w, forms), s)[0]])
    theirs = [function(y[:, k], data[k], weights[:, k]) for k in range(COUNT)]
    theirs = [np.stack([np.array(t[m]) for t in theirs], axis=-1) for m in range(3)]
    return (np.array(out[:2])[:, None], ours_j, ours_h), theirs


@pytest.mark.parametrize("logs", [True, False])
@pytest.mark.parametrize("name", EXPRESSIONS)
def test_derivatives_of_differences(name, logs):
    ours, theirs = derivatives(EXPRESSIONS[name], False, "at_most", logs)
    for own, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(own, other, rtol=1e-9, atol=1e-9)


POSITIVE = [n for n in EXPRESSIONS if n not in ("through zero", "difference", "quotients", "arcs", "signs", "steps")]


@pytest.mark.parametrize("sense", ["at_most", "at_least"])
@pytest.mark.parametrize("name", POSITIVE)
def test_derivatives_of_logarithms(name, sense):
    ours, theirs = derivatives(EXPRESSIONS[name], True, sense, True)
    there = np.isfinite(theirs[0][0]).ravel()
    assert there.sum() > COUNT // 3
    for own, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(own[..., there], other[..., there], rtol=1e-8, atol=1e-8)


def repeated(x, count, step):
    for k in range(count):
        x = step(x, k)
    return x


DEEP = {
    "functions": lambda x, y, z, d: repeated(x + y, 400, lambda e, k: ca.sin(e) if k % 3 else ca.tanh(e * y)) + z,
    "steps in time": lambda x, y, z, d: repeated(z, 400, lambda v, k: v + 0.01 * (x - y * v * v)),
    "products": lambda x, y, z, d: repeated(x, 600, lambda e, k: e * (y / z, z / y)[k % 2]) + d,
    "quotients": lambda x, y, z, d: repeated(x, 400, lambda e, k: y / (z + e)),
}


@pytest.mark.slow
@pytest.mark.parametrize("log", [True, False])
@pytest.mark.parametrize("name", DEEP)
def test_derivatives_of_deep_formulas(name, log):
    ours, theirs = derivatives(DEEP[name], log, "at_most", True)
    there = np.isfinite(theirs[0][0]).ravel()
    assert there.sum() > COUNT // 3
    for own, other in zip(ours, theirs, strict=True):
        np.testing.assert_allclose(own[..., there], other[..., there], rtol=1e-6, atol=1e-6)


def test_a_lower_limit_shows_the_way_back_from_below_zero():
    # (x - 2 y)/bound is negative in part of the points; its row has a slope there all the same.
    ours, theirs = derivatives(lambda x, y, z, d: x - 2 * y, True, "at_least", True)
    below = np.isnan(theirs[0][0]).ravel()
    assert below.sum() > COUNT // 3
    row, jacobian, hessian = ours
    assert np.isfinite(row).all()
    assert (row[0, 0, below] > 7).all()
    assert (jacobian[0, 0, below] < 0).all()
    assert (jacobian[0, 1, below] > 0).all()
    assert np.isfinite(hessian).all()
    np.testing.assert_allclose(row[0, 0, ~below], theirs[0][0, 0, ~below])


def test_monomials_cost_nothing_to_differentiate():
    x = [ca.SX.sym(f"x{k}") for k in range(N)]
    program = Program(x, [x[0] ** 2 * x[1] / ca.sqrt(x[2])])
    rows = Rows((NodeConstraint("at_most", program.outputs[0], None, 1e-9),), (), (True,), (), (True,) * N)
    functions = RowFunctions(program, N, rows)
    assert functions.hessian == []
    constants = [functions.nodes[k].constant for k in functions.outputs[1:]]
    assert constants == [2.0, 1.0, -0.5]
