"""The instruction list and the NumPy code made from it, against CasADi's own evaluation and derivatives."""

import tracemalloc

import casadi as ca
import numpy as np
import pytest

import synth
from synth.model.program import OP_SELECT, OP_SPECIAL, OPERATIONS, Program, UnsupportedOperation
from synth.question.catalogs import as_catalogs
from synth.special import TABLE, expanded, recorded, special
from tests.asking import instance_of

REQUIREMENTS = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
OPTIONAL = {
    "startup_torque": "1080 N*m",
    "overload_torque": "4000 N*m",
    "actuation_force_limit": "60 kN",
    "outer_diameter_limit": "400 mm",
    "length_limit": "200 mm",
    "jerk_limit": "60 rad/s3",
    "acceleration_limit": "40 rad/s2",
    "hub_bore_diameter": "60 mm",
    "drag_torque_limit": "20 N*m",
}
OPTION_SETS = {
    "default": {},
    "exponential_form": {"guide_series": "exponential_form"},
    "lipka": {"guide_series": "lipka"},
    "exponential_K": {"guide_series": "exponential_K"},
    "exact": {"guide_series": "exact"},
    "cz": {"guide_model": "cz"},
    "active": {"load_kind": "active"},
    "worst_case": {"friction_basis": "worst_case"},
    "catalogue": {"spline_choice": "catalogue"},
    "dry_aid": {"lubrication": "dry", "release_aid": "wavy_rings"},
    "all_at_once": {
        "load_kind": "active",
        "friction_basis": "worst_case",
        "spline_choice": "catalogue",
        "guide_series": "exact",
        "cooling": "through_oil",
        "release_aid": "sine_plates",
        "allow_obsolete": "yes",
    },
}
POINTS = 300


class Traced:
    """A model of the multi-plate family with random points of its unknowns."""

    def __init__(self, options, requirements=REQUIREMENTS, points=POINTS):
        self.instance = instance_of(
            synth.load("multi_plate_clutch", practice="off", **options), requirements, as_catalogs(None)
        )
        self.model = self.instance.model
        rng = np.random.default_rng(7)
        low, high = self.instance.ranges.lower, self.instance.ranges.upper
        self.variables = low * (high / low) ** rng.random((points, len(low)))
        # A third of the points have a sound ring, so that the formulas behind the guards are seen too.
        third = points // 3
        outer = rng.uniform(0.12, 0.5, third)
        self.variables[:third, 0], self.variables[:third, 1] = outer, outer * rng.uniform(0.6, 0.8, third)
        self.variables[:third, 2] = rng.uniform(5e3, 5e4, third)
        self.combinations = rng.integers(0, self.instance.combinations.count, points)
        data = self.instance.data(self.combinations)
        self.data = [np.broadcast_to(np.asarray(x, dtype=float), (points,)) for x in data]
        self.inputs = [*self.variables.T, *self.data]

    def outputs(self):
        """Return every traced expression, special functions written out."""
        model = self.model
        wanted = list(model.quantity_sx.values())
        wanted += [side for limit in model.limits for side in (limit.value, limit.limit)]
        wanted += [a.when for a in model.declaration.advices]
        return [expanded(e, model.calls) for e in wanted]

    def casadi(self, outputs):
        function = ca.Function("reference", [ca.vertcat(*self.model.inputs)], [ca.vertcat(*outputs)])
        return np.array(function(np.array(self.inputs)))


@pytest.fixture(scope="module", params=OPTION_SETS)
def traced(request):
    return Traced(OPTION_SETS[request.param], REQUIREMENTS | OPTIONAL)


def close(found, wanted, relative):
    with np.errstate(all="ignore"):
        return (found == wanted) | (np.isnan(found) & np.isnan(wanted)) | (np.abs(found / wanted - 1) <= relative)


@pytest.mark.slow
def test_numpy_code_equals_casadi_on_the_multi_plate_family(traced):
    outputs = traced.outputs()
    reference = traced.casadi(outputs)
    with np.errstate(all="ignore"):
        found = np.array([np.broadcast_to(x, (POINTS,)) for x in traced.model.program.compile()(traced.inputs)])
    assert found.shape == reference.shape
    assert np.isfinite(reference).mean() > 0.9
    # Where terms cancel (start-up beside the load torque) one rounding of log1p or expm1 counts many times.
    good = close(found, reference, 1e-12)
    sound = np.abs(reference[:, : POINTS // 3]) > 0
    assert np.all(good[:, : POINTS // 3] | ~sound)
    assert good.mean() > 0.999


@pytest.mark.slow
def test_symbolic_form_of_the_program_equals_the_declaration(traced):
    reference = traced.casadi(traced.outputs())
    again = traced.casadi(traced.model.program.symbolic(traced.model.inputs))
    assert close(again, reference, 1e-12)[:, : POINTS // 3].all()


def sound_points(traced, count):
    """Return points whose guards hold and whose outputs are all finite, away from the borders of regimes."""
    model = traced.model
    result = model.evaluate(traced.variables, traced.data)
    guards = [result.holds[x.name] for x in model.limits if x.guard]
    rows = np.flatnonzero(np.logical_and.reduce(guards))[:count]
    assert len(rows) == count
    return [x[rows] for x in traced.inputs]


def nodes_without_optional_columns(traced):
    """Return the outputs that have a value for every row."""
    model = traced.model
    optional = [len(model.variables) + k for k, e in enumerate(model.data_inputs) if not e.required]
    void = model.program.dependence(optional)
    advice = len(model.advice_nodes)
    return [k for k in model.program.outputs[:-advice] if not void[k]]


def test_first_derivatives_equal_the_complex_step(traced):
    count, n = 20, len(traced.model.variables)
    inputs = sound_points(traced, count)
    nodes = nodes_without_optional_columns(traced)
    x = ca.SX.sym("x", len(inputs))
    everything = traced.model.program.symbolic([x[k] for k in range(len(inputs))])
    position = {node: k for k, node in reversed(list(enumerate(traced.model.program.outputs)))}
    chosen = ca.vertcat(*[everything[position[k]] for k in nodes])
    gradient = ca.Function("gradient", [x], [ca.jacobian(chosen, x)])
    evaluate = traced.model.program.compile(nodes)
    exact = np.stack([np.array(gradient([float(v[row]) for v in inputs])) for row in range(count)])
    for k in range(n):
        stepped = [v.astype(complex) if j == k else v for j, v in enumerate(inputs)]
        step = 1e-30 * np.abs(inputs[k])
        stepped[k] = stepped[k] + 1j * step
        with np.errstate(all="ignore"):
            slope = np.array([np.broadcast_to(np.imag(v), (count,)) / step for v in evaluate(stepped)]).T
        size = np.max(np.abs(exact[:, :, k]), axis=0, keepdims=True)
        assert np.all(np.abs(slope - exact[:, :, k]) <= 1e-10 * np.abs(exact[:, :, k]) + 1e-12 * size)


def test_second_derivatives_equal_differences_of_the_first(traced):
    model = traced.model
    count, n = 6, len(model.variables)
    inputs = sound_points(traced, count)
    names = ["torque", "friction_work", "slip_time", "peak_temperature_rise", "mass"]
    x = ca.SX.sym("x", len(inputs))
    everything = dict(
        zip(model.quantity_node, model.program.symbolic([x[k] for k in range(len(inputs))]), strict=False)
    )
    for name in names:
        hessian, gradient = ca.hessian(everything[name], x)
        both = ca.Function("both", [x], [hessian[:n, :n], gradient[:n]])
        for row in range(count):
            at = np.array([float(v[row]) for v in inputs])
            exact = np.array(both(at)[0])
            numeric = np.empty((n, n))
            for k in range(n):
                step = np.zeros(len(at))
                step[k] = 1e-5 * at[k]
                numeric[k] = np.array((both(at + step)[1] - both(at - step)[1]) / (2 * step[k])).ravel()
            scaled = np.outer(at[:n], at[:n])  # second derivatives to the logarithms, nearly
            size = np.max(np.abs(exact * scaled)) + np.max(np.abs(np.array(both(at)[1]).ravel() * at[:n]))
            assert np.max(np.abs((exact - numeric) * scaled)) <= 1e-6 * size, name


# -- every operation ---------------------------------------------------------------------------------


def one_of_each(x, y):
    """Return an expression for every operation that the code generator knows."""
    domain = {
        ca.OP_LOG: 1 + x * x,
        ca.OP_SQRT: 1 + x * x,
        ca.OP_ASIN: x / 4,
        ca.OP_ACOS: x / 4,
        ca.OP_ACOSH: 2 + x * x,
        ca.OP_ATANH: x / 4,
        ca.OP_LOG1P: x * x,
        ca.OP_TAN: x / 3,
    }
    unary = {
        op: ca.SX.unary(op, domain.get(op, x))
        for op, known in OPERATIONS.items()
        if known.arity == 1 and op != ca.OP_NOT
    }
    unary[ca.OP_NOT] = ca.SX.unary(ca.OP_NOT, x < y)
    binary = {
        op: ca.SX.binary(op, x, y)
        for op, known in OPERATIONS.items()
        if known.arity == 2 and op not in (ca.OP_POW, ca.OP_CONSTPOW, ca.OP_AND, ca.OP_OR, ca.OP_IF_ELSE_ZERO)
    }
    binary[ca.OP_POW] = (1 + x * x) ** y
    binary[ca.OP_CONSTPOW] = (1 + x * x) ** 1.7
    binary[ca.OP_AND] = ca.logic_and(x < y, x > 0)
    binary[ca.OP_OR] = ca.logic_or(x < y, x > 0)
    binary[ca.OP_IF_ELSE_ZERO] = ca.if_else(x < y, x, 0)
    return {**unary, **binary, OP_SELECT: ca.if_else(x < y, x + 1, y * y)}


def test_every_operation_equals_casadi():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    pieces = one_of_each(x, y)
    assert set(pieces) == set(OPERATIONS)
    outputs = list(pieces.values())
    program = Program([x, y], outputs)
    assert {node.op for node in program.nodes} >= set(OPERATIONS)
    rng = np.random.default_rng(1)
    points = rng.uniform(-3, 3, (2, 400))
    points[:, :50] = np.round(points[:, :50])  # equal sides and whole numbers
    reference = np.array(ca.Function("f", [ca.vertcat(x, y)], [ca.vertcat(*outputs)])(points))
    again = np.array(ca.Function("f", [ca.vertcat(x, y)], [ca.vertcat(*program.symbolic([x, y]))])(points))
    with np.errstate(all="ignore"):
        found = np.array([np.broadcast_to(v, 400) for v in program.compile()(list(points))])
    for k, op in enumerate(pieces):
        assert close(found[k], reference[k], 1e-12).all(), op
        assert close(again[k], reference[k], 1e-14).all(), op


def test_scalars_and_arrays_may_be_mixed():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    evaluate = Program([x, y], [x * y, ca.SX(3.0), y]).compile()
    product, constant, same = evaluate([np.array([1.0, 2.0]), 5.0])
    assert product.tolist() == [5, 10]
    assert (constant, same) == (3.0, 5.0)


def test_an_operation_without_numpy_form_is_told():
    x = ca.SX.sym("x")
    with pytest.raises(UnsupportedOperation, match="operation number"):
        Program([x], [ca.SX.unary(ca.OP_ERFINV, x)])


def test_where_is_one_instruction():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [np.where(x < y, np.sin(x), np.cos(y))])
    ops = [node.op for node in program.nodes]
    assert ops.count(OP_SELECT) == 1
    assert ca.OP_ADD not in ops
    select = program.nodes[ops.index(OP_SELECT)]
    assert [program.nodes[k].op for k in select.args] == [ca.OP_LT, ca.OP_SIN, ca.OP_COS]
    # Written the other way round (the negated condition first) it is the same.
    turned = ca.if_else(ca.logic_not(x < y), 0, np.sin(x)) + ca.if_else(ca.logic_not(x < y), np.cos(y), 0)
    assert [n.op for n in Program([x, y], [turned]).nodes].count(OP_SELECT) == 1


def test_a_sum_of_two_unrelated_conditions_stays_a_sum():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [ca.if_else(x < y, x, 0) + ca.if_else(x < 0, y, 0)])
    assert [node.op for node in program.nodes].count(ca.OP_IF_ELSE_ZERO) == 2


def test_equal_sub_expressions_are_one_node():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [np.exp(x * y) + 1, 2 - np.exp(y * x)])
    assert [node.op for node in program.nodes].count(ca.OP_EXP) == 1
    assert [node.op for node in program.nodes].count(ca.OP_MUL) == 1


def test_dependence_and_needed_nodes():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    program = Program([x, y], [np.sin(x), np.cos(y), x + y])
    a, b, c = program.outputs
    on_x = program.dependence([0])
    assert [on_x[a], on_x[b], on_x[c]] == [True, False, True]
    assert program.needed([a]) == sorted([program.input_nodes[0], a])
    assert program.downstream([b])[c] == np.False_


# -- special functions ---------------------------------------------------------------------------------


def test_a_special_function_is_one_node_and_the_same_call_is_the_same_node():
    x = ca.SX.sym("x")
    name = next(n for n in TABLE if n.endswith(".sum_geometric"))
    from synth.problems.mechanics.guide_friction import sum_geometric

    with recorded() as calls:
        outputs = [sum_geometric(10.0, x * 2), 1 + sum_geometric(10.0, 2 * x), sum_geometric(10.0, 3 * x)]
    assert len(calls) == 3
    program = Program([x], outputs, calls)
    ops = [node.op for node in program.nodes]
    assert ops.count(OP_SPECIAL) == 2
    assert [f.name for f in program.specials] == [name]
    assert ca.OP_EXPM1 not in ops
    values = program.compile()([np.array([0.01, 0.02])])
    np.testing.assert_allclose(values[0], sum_geometric(10.0, np.array([0.02, 0.04])), rtol=1e-15)
    np.testing.assert_allclose(values[1] - 1, values[0], rtol=1e-14)
    written_out = ca.Function("f", [x], [expanded(outputs[1], calls)])
    assert float(written_out(0.01)) == pytest.approx(float(values[1][0]), rel=1e-15)


def test_special_functions_may_be_nested():
    @special((0.0, 1.0))
    def halved(x):
        return x / 2

    x = ca.SX.sym("x")
    with recorded() as calls:
        value = halved(halved(x) + 1)
    program = Program([x], [value], calls)
    assert [node.op for node in program.nodes].count(OP_SPECIAL) == 2
    assert float(program.compile()([6.0])[0]) == 2.0
    assert float(ca.Function("f", [x], [expanded(value, calls)])(6.0)) == 2.0
    del TABLE[next(n for n in TABLE if n.endswith("halved"))]


def test_special_functions_of_numbers_are_just_called():
    from synth.problems.mechanics.guide_friction import sum_geometric

    with recorded() as calls:
        assert float(sum_geometric(2.0, 0.0)) == pytest.approx(2.0)
    assert calls == []


def test_an_elasticity_must_keep_its_sign():
    with pytest.raises(ValueError, match="keep one sign"):
        special((-1.0, 1.0))
    with pytest.raises(ValueError, match="ordered"):
        special((1.0, 0.5))


def test_the_family_keeps_its_special_functions_whole():
    program = Traced({}, points=3).model.program
    start = {"reactive_slip_time", "reactive_friction_work", "reactive_peak_slip_power"}
    names = {f.name.rsplit(".", 1)[1] for f in program.specials}
    assert names == {"sum_geometric", "peak_rise_per_work", *start}
    assert [node.op for node in program.nodes].count(OP_SPECIAL) == 5


# -- memory --------------------------------------------------------------------------------------------


def test_registers_are_handed_on():
    x = ca.SX.sym("x")
    value = x
    for k in range(400):
        value = np.sin(value) + k
    evaluate = Program([x], [value]).compile()
    assert len(evaluate.__code__.co_varnames) <= 3


def test_a_big_batch_takes_little_memory():
    traced = Traced({}, points=20000)
    program = traced.model.program
    evaluate = program.compile()
    assert len(evaluate.__code__.co_varnames) < 0.7 * len(program.nodes)
    chosen = program.compile([traced.model.quantity_node["mass"]])
    tracemalloc.start()
    with np.errstate(all="ignore"):
        chosen(traced.inputs)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20 * 20000 * 8
