"""Declaring special functions, and what the propagation makes of one that does not exist everywhere."""

import casadi as ca
import numpy as np
import pytest
from synth.problems.mechanics.startup import reactive_friction_work, reactive_peak_slip_power, reactive_slip_time

from synth.bounds.contractor import Contractor
from synth.bounds.propagated_nodes import MovingInputs, PropagatedNodes
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import Program
from synth.special import TABLE, expanded, recorded, special
from tests.bounds.test_contractor import contraction


@pytest.mark.parametrize(
    ("declaration", "message"),
    [
        ({"curvature": "convex"}, "log-convex, log-concave, got 'convex'"),
        ({"above": (0, 2)}, "two arguments of 2"),
        ({"above": (1, 1)}, "two arguments of 2"),
        ({"above": (-1, 0)}, "two arguments of 2"),
    ],
)
def test_a_declaration_that_cannot_be_is_refused(declaration, message):
    with pytest.raises(ValueError, match=message):
        special((0.0, 1.0), (-1.0, 0.0), **declaration)


def test_a_declaration_without_details_knows_nothing_more():
    @special((0.0, 1.0))
    def halved(x):
        return x / 2

    function = TABLE.pop(next(n for n in TABLE if n.endswith("halved")))
    assert halved(3.0) == 1.5
    assert (function.curvature, function.above) == (None, None)
    assert function.exists([(0.0, 1.0)])
    assert not function.exists([(-1e-9, 1.0)])
    assert [float(x) for x in function.bounds([(1.0, 4.0)])] == [0.5, 2.0]
    assert [float(x) for x in function.bounds([(-1.0, 4.0)])] == [-np.inf, np.inf]
    assert [float(x) for x in function.bounds([(np.nan, np.nan)])] == [-np.inf, np.inf]


@pytest.mark.slow
@pytest.mark.parametrize("formula", [reactive_friction_work, reactive_peak_slip_power])
@pytest.mark.parametrize("sense", ["at_most", "at_least"])
def test_propagation_keeps_every_design_that_exists(formula, sense):
    """Boxes of torque, load and ramp time that straddle torque = load, limits with nothing to spare."""
    torque, load, ramp = symbols = [ca.SX.sym(name) for name in ("torque", "load", "ramp")]
    with recorded() as calls:
        value = formula(torque, load, 30.0, 26.6, ramp)
    program = Program(symbols, [value, torque, load], calls)
    rng = np.random.default_rng(1)
    n = 2000
    loads = np.exp(rng.uniform(0, 7, n))
    points = np.stack([loads * (1 + 10 ** rng.uniform(-5, 1, n)), loads, 10 ** rng.uniform(-2, 1, n)], axis=1)
    width = rng.exponential(0.3, (2, n, 3)) * (rng.random((2, n, 3)) < 0.8)
    low, high = points * np.exp(-width[0]), points * np.exp(width[1])
    assert 0.2 < (low[:, 0] < high[:, 1]).mean() < 0.95
    values = program.compile()(list(points.T))[0]
    goals = [Goal(program.outputs[0], 1 if sense == "at_most" else -1)]
    guard = NodeConstraint("at_least", program.outputs[1], program.outputs[2], 1e-9, guard=True)
    for k in range(0, n, 50):
        rows = slice(k, k + 50)
        level = values[k]
        holds = values[rows] <= level if sense == "at_most" else values[rows] >= level
        limit = NodeConstraint(sense, program.outputs[0], None, 1e-9, level)
        contractor = Contractor(PropagatedNodes(program, MovingInputs(3, ()), [limit, guard], goals))
        nothing = np.zeros((50, 0), dtype=int)
        result = contraction(contractor, [], [], nothing, low[rows], high[rows], None, 3)
        assert result.alive[holds].all()
        assert np.all((result.low <= points[rows] * (1 + 1e-9))[holds])
        assert np.all((result.high >= points[rows] * (1 - 1e-9))[holds])
        signed = goals[0].sign * values[rows]
        assert not np.any((result.bounds[:, 0] > signed + 1e-9 * np.abs(signed))[holds])


def test_a_special_function_is_bounded_at_its_corner_where_it_exists_in_the_whole_box_and_where_it_does_not():
    torque, ramp = symbols = [ca.SX.sym(name) for name in ("torque", "ramp")]
    with recorded() as calls:
        value = reactive_slip_time(torque, 600.0, 30.0, 26.6, ramp) + 1e-6 * torque
    program = Program(symbols, [value], calls)
    contractor = Contractor(PropagatedNodes(program, MovingInputs(2, ()), [], [Goal(program.outputs[0], 1)]))
    low, high = np.array([[900.0, 2.0], [500.0, 2.0]]), np.array([[1200.0, 2.0], [1200.0, 2.0]])
    least = float(reactive_slip_time(1200.0, 600.0, 30.0, 26.6, 2.0))
    bounds = contraction(contractor, [], [], np.zeros((2, 0), dtype=int), low, high, None, 1).bounds[:, 0]
    # Its terms are bounded one by one; the least value of the function lies where the torque is largest.
    assert bounds == pytest.approx([least + 900e-6, least + 500e-6], rel=1e-12)


def test_an_expression_is_written_out_with_the_formulas_it_needs_and_no_others():
    asked = []

    def formula(name):
        def declared(x):
            asked.append(name)
            return x + 1

        declared.__qualname__ = name
        return special((0.0, 1.0))(declared)

    names = ("outer", "inner", "elsewhere")
    outer, inner, elsewhere = map(formula, names)
    x = ca.SX.sym("x")
    with recorded() as calls:
        value = 2 * outer(inner(x))
        elsewhere(x)
    for function in [n for n in TABLE if n.rsplit(".", 1)[-1] in names]:
        TABLE.pop(function)
    written = expanded(value, calls)
    assert asked == ["outer", "inner"]
    assert [str(s) for s in ca.symvar(written)] == ["x"]
    assert float(ca.Function("f", [x], [written])(3.0)) == 10.0


def test_arguments_are_taken_by_name_as_well():
    @special((1.0, 1.0), (-1.0, -1.0))
    def slope(rise, run):
        return rise / run

    TABLE.pop(next(n for n in TABLE if n.endswith("slope")))  # what stays there is checked as a formula of the program
    assert slope(run=4.0, rise=2.0) == slope(2.0, run=4.0) == 0.5
    rise, run = ca.SX.sym("rise"), ca.SX.sym("run")
    with recorded() as calls:
        symbol = slope(run=run, rise=rise)
    (call,) = calls
    assert [str(x) for x in call.arguments] == ["rise", "run"]
    assert str(expanded(symbol, calls)) == "(rise/run)"
    with pytest.raises(TypeError, match="unexpected keyword argument 'width'"):
        slope(1.0, 2.0, width=2.0)
