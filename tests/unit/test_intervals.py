"""Interval propagation never loses a point: every rule alone, random programs, and the multi-plate family."""

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import erf

import synth
from problems.mechanics.guide_friction import sum_geometric
from synth.formulation import TIE, Formulation
from synth.instance import Instance, as_catalogs
from synth.intervals import BACKWARD, FORWARD, SLACK, Cut, Goal, Propagator, _local_slopes, loosened
from synth.program import ARITY_ONE, COMPARISONS, TEMPLATES, Program
from synth.special import recorded

RELATIVE, ABSOLUTE = 1e-12, 1e-13
DOMAIN = {
    ca.OP_LOG: (1e-3, 5.0),
    ca.OP_SQRT: (0.0, 5.0),
    ca.OP_ASIN: (-1.0, 1.0),
    ca.OP_ACOS: (-1.0, 1.0),
    ca.OP_ACOSH: (1.0, 5.0),
    ca.OP_ATANH: (-0.999, 0.999),
    ca.OP_LOG1P: (-0.99, 5.0),
}
TRUTHS = {ca.OP_NOT, ca.OP_AND, ca.OP_OR}


def name_of(op):
    return next((n for n in dir(ca) if n.startswith("OP_") and getattr(ca, n) == op), "OP_SELECT")


def apply(op, args):
    """Carry out one operation on arrays, with the code that the generator writes."""
    scope = {"np": np, "erf": erf, **{f"a{k}": x for k, x in enumerate(args)}}
    code = TEMPLATES[op].format(*(f"a{k}" for k in range(len(args))))
    with np.errstate(all="ignore"):
        return np.asarray(eval(code, scope), dtype=float)


def arity(op):
    return TEMPLATES[op].count("{0}") and max(k for k in range(3) if f"{{{k}}}" in TEMPLATES[op]) + 1


def random_arguments(op, rng, boxes, samples):
    """Return intervals of the arguments and points inside them, ends and zero included."""
    intervals, points = [], []
    for position in range(arity(op)):
        low, high = DOMAIN.get(op, (-4.0, 4.0))
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


@pytest.mark.parametrize("op", sorted(FORWARD), ids=name_of)
def test_forward_rules_hold_every_value(op):
    rng = np.random.default_rng(abs(op))
    for _ in range(8):
        intervals, points = random_arguments(op, rng, 300, 40)
        with np.errstate(all="ignore"):
            result = FORWARD[op](*intervals)
        assert inside(apply(op, points), result).all()


def test_forward_rules_are_known_for_nearly_every_operation():
    # Without a rule nothing is known of the value, which is sound; these few are rare in engineering formulas.
    assert set(TEMPLATES) - set(FORWARD) == {ca.OP_FMOD, ca.OP_COPYSIGN, ca.OP_ERF}


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
            cuts = BACKWARD[op]((low, high), *intervals)
        assert len(cuts) == len(intervals)
        for point, cut in zip(points, cuts, strict=True):
            if cut is not None:
                slack = 1e-9 * (1 + np.abs(point))  # an inverse magnifies rounding
                wrong = (point < cut[0] - slack) | (point > cut[1] + slack)
                assert not np.any(wrong & exists)


SMOOTH = sorted(set(ARITY_ONE) - COMPARISONS - {ca.OP_FLOOR, ca.OP_CEIL, ca.OP_SIGN})
SMOOTH_TWO = [
    ca.OP_ADD, ca.OP_SUB, ca.OP_MUL, ca.OP_DIV, ca.OP_POW, ca.OP_CONSTPOW, ca.OP_FMIN, ca.OP_FMAX, ca.OP_ATAN2,
    ca.OP_HYPOT,
]  # fmt: skip


@pytest.mark.parametrize("op", SMOOTH + SMOOTH_TWO, ids=name_of)
def test_slopes_hold_every_derivative(op):
    rng = np.random.default_rng(200 + op)
    symbols = [ca.SX.sym(f"x{k}") for k in range(arity(op))]
    value = ca.SX.unary(op, symbols[0]) if len(symbols) == 1 else ca.SX.binary(op, *symbols)
    gradient = ca.Function("gradient", [ca.vertcat(*symbols)], [ca.gradient(value, ca.vertcat(*symbols))])
    for _ in range(4):
        intervals, points = random_arguments(op, rng, 200, 20)
        points = np.stack([np.broadcast_to(p, (20, 200)) for p in points])
        with np.errstate(all="ignore"):
            natural = FORWARD[op](*intervals) if op in FORWARD else (np.full(200, -np.inf), np.full(200, np.inf))
            slopes = _local_slopes(op, natural, intervals)
        exact = np.array(gradient(points.reshape(len(symbols), -1))).reshape(points.shape)
        if op in (ca.OP_FMIN, ca.OP_FMAX):
            exact[:, points[0] == points[1]] = np.nan  # either slope is right where both sides are equal
        if op == ca.OP_FABS:
            exact[points == 0] = np.nan
        for k, slope in enumerate(slopes):
            if slope is not None:
                good = np.isinf(exact[k]) | inside(exact[k], slope)
                assert good.all()


# -- whole programs ----------------------------------------------------------------------------------


def random_expressions(rng, symbols, data, count):
    """Return expressions grown from random operations that are defined everywhere on the boxes used."""
    pool = [*symbols, *data, ca.SX(float(rng.uniform(0.5, 2)))]

    def pick():
        return pool[rng.integers(len(pool))]

    makers = [
        lambda a, b: a + b,
        lambda a, b: a - b,
        lambda a, b: a * b,
        lambda a, b: a / (1.5 + b * b),
        lambda a, b: a * a - b,
        lambda a, b: np.sqrt(1 + a * a) * b,
        lambda a, b: np.exp(-np.hypot(a, b)),
        lambda a, b: np.log1p(a * a) + b,
        lambda a, b: np.maximum(a, b),
        lambda a, b: np.minimum(a, 2 * b),
        lambda a, b: np.abs(a - b),
        lambda a, b: np.tanh(a) * b,
        lambda a, b: np.sin(a) + np.cos(b),
        lambda a, b: np.arctan(a) - b,
        lambda a, b: np.where(a < b, a * b, b * b + 0.1),
        lambda a, b: (1 + a * a) ** 0.7 - b,
        lambda a, b: np.expm1(np.minimum(a, 2)) + b,
        lambda a, b: sum_geometric(2 + a * a, 0.1 + b * b),
        lambda a, b: (a < b) * 0.7 + a,
        lambda a, b: np.floor(a) + b,
        lambda a, b: 1 / (2 + np.abs(a)) + b,
        lambda a, b: np.where(np.logical_and(a > 0, b > 0), a, -b),
    ]
    for _ in range(count):
        pool.append(makers[rng.integers(len(makers))](pick(), pick()))  # noqa: PERF401 - each may use those before it
    return pool[-4:]


class Question:
    """A random program with limits that hold at a known point."""

    def __init__(self, seed, boxes=25):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(1, 4))
        symbols = [ca.SX.sym(f"x{k}") for k in range(n)]
        data = [ca.SX.sym("c0"), ca.SX.sym("c1")]
        with recorded() as calls:
            expressions = random_expressions(rng, symbols, data, int(rng.integers(6, 25)))
        self.program = Program([*symbols, *data], expressions, calls)
        self.inputs = [rng.uniform(-1, 2, boxes), float(rng.uniform(0.2, 2))]
        self.point = rng.uniform(-2, 2, (boxes, n))
        width = rng.exponential(1.0, (2, boxes, n)) * (rng.random((2, boxes, n)) < 0.85)
        self.low, self.high = self.point - width[0], self.point + width[1]
        with np.errstate(all="ignore"):
            values = self.program.compile()([*self.point.T, *self.inputs])
        self.values = [np.broadcast_to(v, (boxes,)) for v in values]
        self.rng, self.boxes = rng, boxes
        self.exists = np.all(np.isfinite(self.values), axis=0)

    def propagator(self):
        """Return limits that the points keep (some with nothing to spare), and the caps they keep."""
        a, b, c, e = self.program.outputs
        senses = ["at_most", "at_least"]
        cuts, kept = [], np.ones(self.boxes, dtype=bool)
        for node, value in ((a, self.values[0]), (b, self.values[1])):
            sense = senses[self.rng.integers(2)]
            level = float(self.rng.choice(value)) if np.isfinite(value).any() else 0.0
            cuts.append(Cut(sense, node, None, 1e-9, level))
            kept &= (value <= level) if sense == "at_most" else (value >= level)
        cuts.append(Cut("at_most", a, b, 1e-9))
        kept &= self.values[0] <= self.values[1]
        goals = [Goal(c, 1), Goal(e, -1)]
        spare = self.rng.exponential(0.3, (2, self.boxes)) * (self.rng.random((2, self.boxes)) < 0.6)
        caps = [self.values[2] + spare[0] + TIE, -self.values[3] + spare[1] + TIE]
        return Propagator(self.program, self.point.shape[1], cuts, goals), caps, kept & self.exists


@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans(), st.booleans())
@settings(deadline=None, derandomize=True, max_examples=400)
def test_a_box_with_a_feasible_point_survives_and_keeps_it(seed, passes, capped, combined):
    question = Question(seed)
    propagator, caps, kept = question.propagator()
    multipliers = question.rng.exponential(1.0, (3, 5)) * (question.rng.random((3, 5)) < 0.6) if combined else None
    result = propagator.contract(
        question.low, question.high, question.inputs, caps if capped else None, passes, multipliers
    )
    assert result.alive[kept].all()
    slack = 1e-7 * (1 + np.abs(question.point))
    good = (question.point >= result.low - slack) & (question.point <= result.high + slack)
    assert good[kept].all()
    objectives = np.stack([question.values[2], -question.values[3]], axis=1)
    below = result.bounds <= objectives + 1e-7 * (1 + np.abs(objectives))
    assert below[kept].all()


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=150)
def test_bounds_of_objectives_hold_at_every_point_of_a_box(seed):
    question = Question(seed, boxes=10)
    goals = [Goal(node, sign) for node in question.program.outputs for sign in (1, -1)]
    propagator = Propagator(question.program, question.point.shape[1], [], goals)
    result = propagator.contract(question.low, question.high, question.inputs, None, 2)
    assert result.alive.all()
    for _ in range(20):
        share = question.rng.random(question.point.shape)
        points = question.low + share * (question.high - question.low)
        with np.errstate(all="ignore"):
            values = question.program.compile()([*points.T, *question.inputs])
        for j, goal in enumerate(goals):
            value = goal.sign * np.broadcast_to(values[j // 2], (10,))
            assert np.all(np.isnan(value) | (result.bounds[:, j] <= value + 1e-9 * (1 + np.abs(value))))


def contract(expressions, cuts, goals, low, high, caps=None, data=(), **more):
    """Return the contraction of one box of a program of x and y (and data symbols given with their values)."""
    symbols = [ca.SX.sym("x"), ca.SX.sym("y")]
    extra = [ca.SX.sym(f"c{k}") for k in range(len(data))]
    outputs = expressions(*symbols, *extra)
    program = Program([*symbols, *extra], outputs)
    node = program.outputs
    made = [Cut(s, node[v], b if b is None else node[b], 1e-9, level) for s, v, b, level in cuts]
    propagator = Propagator(program, 2, made, [Goal(node[k], sign) for k, sign in goals])
    return propagator.contract(np.array([low], dtype=float), np.array([high], dtype=float), list(data), caps, **more)


def test_slopes_of_a_bound_are_not_taken_from_what_limits_leave():
    # f = n**2 rises with x and y only where the limit n >= 0.1 holds; the corner (0, 0) with f = 1 is no bound.
    def expressions(x, y):
        n = x * y - 1
        return [n, n * n]

    limit = [("at_least", 0, None, 0.1)]
    result = contract(expressions, limit, [(1, 1)], [0, 0], [2, 2])
    assert result.bounds[0, 0] <= 0.01
    capped = contract(expressions, limit, [(1, 1)], [0, 0], [2, 2], caps=[0.5])
    assert capped.alive[0]  # x = y = 1.0488 has n = 0.1, f = 0.01
    combine = np.array([[0.5, 0.5], [0.0, 1.0]])
    assert contract(expressions, limit, [(1, 1)], [0, 0], [2, 2], caps=[0.5], combine=combine).alive[0]


def test_a_comparison_used_as_a_number_jumps():
    result = contract(lambda x, y: [(x > 0.5) * (-10.0) + x], [], [(0, 1)], [0, 0], [1, 1])
    assert result.bounds[0, 0] <= -9.5
    assert contract(lambda x, y: [(x > 0.5) * (-10.0) + x], [], [(0, 1)], [0, 0], [1, 1], caps=[-5.0]).alive[0]


@pytest.mark.parametrize(
    "choose",
    [
        lambda unknown, x: np.where(unknown < 1, 5 + x, 100),
        lambda unknown, x: np.where(unknown <= 1, 5 + x, 100),
        lambda unknown, x: np.where(ca.eq(unknown, 0), 5 + x, 100),
        lambda unknown, x: np.where(x < 2, 5 + x + unknown, 100),
        lambda unknown, x: np.where(x < 0.5, 100, 5 + unknown),
        lambda unknown, x: np.maximum(5 + unknown, 1),
        lambda unknown, x: np.minimum(5 + unknown, 100),
    ],
)
def test_nothing_known_never_means_no(choose):
    # Zero times a number of which nothing is known: the value is 0, the interval says nothing.
    def expressions(x, y, zero):
        return [choose(ca.SX.binary(ca.OP_COPYSIGN, x, y) * zero, x)]

    result = contract(expressions, [], [(0, 1)], [0.1, -1], [0.9, 1], caps=[6.0], data=[np.zeros(1)])
    assert result.alive[0]
    assert not result.bounds[0, 0] > 5.9


# -- rounding ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [1.0, 1e3, 1e6])
@pytest.mark.parametrize("value", [1e-3, 0.12345678901234567, 7.7])
def test_a_pinned_variable_survives_a_subtraction_that_magnifies_rounding(value, size):
    # Backward through (x + size) - size the rounding of the sum comes back to x, size/x times larger.
    result = contract(
        lambda x, y, big: [((x + big) - big) * y, (x + big) - 30 * big],
        [("at_most", 0, None, value * 2.0), ("at_least", 0, None, value * 2.0), ("at_most", 1, None, 0.0)],
        [(0, 1)],
        [value, 2.0],
        [value, 2.0],
        data=[np.array([size])],
        caps=[value * 2.0],
        passes=6,
    )
    assert result.alive[0]
    assert result.low[0] == pytest.approx([value, 2.0], rel=1e-6)
    assert result.high[0] == pytest.approx([value, 2.0], rel=1e-6)
    assert np.all(result.low <= result.high)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=200)
def test_a_box_of_one_point_survives_its_own_values(seed):
    question = Question(seed)
    cuts = [
        Cut("equal", node, None, 1e-9, float(value[0]))
        for node, value in zip(question.program.outputs[:2], question.values[:2], strict=True)
    ]
    goals = [Goal(question.program.outputs[2], 1)]
    point = question.point[:1]
    first = [x if np.ndim(x) == 0 else x[:1] for x in question.inputs]
    if question.exists[0]:
        propagator = Propagator(question.program, point.shape[1], cuts, goals)
        result = propagator.contract(point, point, first, [question.values[2][:1] + TIE], 5)
        assert result.alive[0]
        np.testing.assert_allclose(result.low, point, rtol=1e-6, atol=1e-9)


def test_limits_are_loosened_outward():
    assert loosened(np.array(10.0), 1e-9, +1) == pytest.approx(10.0 * (1 + SLACK), rel=1e-15)
    assert loosened(np.array(-10.0), 1e-9, +1) == pytest.approx(-10.0 * (1 - SLACK), rel=1e-15)
    assert loosened(np.array(0.0), 0.5, -1) == -0.5 * SLACK
    assert SLACK >= 2e-6  # twice the tolerance of feasibility


# -- the multi-plate family --------------------------------------------------------------------------

REQUIREMENTS = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
OPTION_SETS = {
    "default": {},
    "cz": {"guide_model": "cz"},
    "exact_active": {"guide_series": "exact", "load_kind": "active"},
    "worst_case": {"friction_basis": "worst_case", "guide_series": "lipka"},
    "exponential_K": {"guide_series": "exponential_K"},
    "catalogue": {"spline_choice": "catalogue"},
    "dry": {"lubrication": "dry"},
}


class Family:
    """A question to the multi-plate family, its propagator, and random feasible designs."""

    def __init__(self, options, objectives, wanted=600):
        problem = synth.load("multi_plate_clutch", **options)
        self.instance = instance = Instance(problem, REQUIREMENTS, as_catalogs(None), grid=False)
        self.model = model = instance.model
        self.objectives = objectives
        self.cuts = [Cut(x.sense, *model.limit_nodes[x.name], x.scale) for x in model.limits]
        self.goals = [Goal(model.quantity_node[name], 1) for name in objectives]
        self.propagator = Propagator(model.program, len(model.variables), self.cuts, self.goals)
        self.points, self.combinations = self._feasible(np.random.default_rng(11), wanted)
        self.data = instance.data(self.combinations)
        values = model.evaluate(self.points, self.data).values
        self.signed = np.stack([values[name] for name in objectives], axis=1)

    def _feasible(self, rng, wanted):
        """Return random feasible points: sensible rings, forces that carry the sizing torque."""
        found_x, found_c = [], []
        for _ in range(12):
            n = 40000
            combinations = rng.integers(0, self.instance.combinations, n)
            data = self.instance.data(combinations)
            outer = rng.uniform(0.1, 0.5, n)
            ratio = rng.uniform(0.1, 0.25, n)
            x = np.stack([outer, outer * (1 - ratio) / (1 + ratio), np.full(n, 1e4), rng.uniform(0.05, 3, n)], axis=1)
            values = self.model.evaluate(x, data).values
            with np.errstate(all="ignore"):
                x[:, 2] = 1e4 * values["required_torque"] / values["torque"] * rng.uniform(1, 1.6, n)
            x[:, 2] = np.clip(np.nan_to_num(x[:, 2], nan=50.0), 50, 2e5)
            good = np.flatnonzero(self.model.evaluate(x, data).feasible)
            found_x.append(x[good])
            found_c.append(combinations[good])
            if sum(map(len, found_x)) >= wanted:
                break
        return np.concatenate(found_x)[:wanted], np.concatenate(found_c)[:wanted]


@pytest.fixture(scope="module", params=OPTION_SETS)
def family(request):
    found = Family(OPTION_SETS[request.param], ["mass", "actuation_force", "friction_work", "drag_torque"])
    assert len(found.points) > 100
    return found


@pytest.mark.parametrize("combined", [False, True])
def test_boxes_around_feasible_designs_survive(family, combined):
    rng = np.random.default_rng(5)
    points, signed = family.points, family.signed
    lower, upper = family.instance.lower, family.instance.upper
    for scale in (3.0, 1.0, 0.3, 0.1, 0.02, 0.0):
        low = np.maximum(points * np.exp(-scale * rng.exponential(1.0, points.shape)), lower)
        high = np.minimum(points * np.exp(scale * rng.exponential(1.0, points.shape)), upper)
        open_sides = (rng.random(points.shape) < 0.2) & (scale > 0)
        low, high = np.where(open_sides, lower, low), np.where(open_sides, upper, high)
        spare = rng.exponential(0.1, signed.shape) * (rng.random(signed.shape) < 0.7)
        caps = signed + (spare + TIE) * np.abs(signed) + TIE
        rows = len(family.cuts) + len(family.goals)
        multipliers = rng.exponential(1.0, (4, rows)) * (rng.random((4, rows)) < 0.3) if combined else None
        for passes in (1, 3):
            kept = family.propagator.contract(low, high, family.data, list(caps.T), passes, multipliers)
            assert kept.alive.all()
            assert np.all(points >= kept.low * (1 - 1e-7))
            assert np.all(points <= kept.high * (1 + 1e-7))
            assert np.all(kept.bounds <= signed + 1e-7 * np.abs(signed))


def test_root_boxes_hold_all_feasible_designs(family):
    form = Formulation(family.instance, dict.fromkeys(family.objectives, "min"), 2)
    points, combinations = family.points, family.combinations
    chosen = np.unique(combinations)
    root = form.root(chosen)
    position = {int(c): k for k, c in enumerate(root.combination)}
    assert set(position) == set(chosen.tolist())
    rows = [position[int(c)] for c in combinations]
    assert np.all(points >= root.low[rows] * (1 - 1e-7))
    assert np.all(points <= root.high[rows] * (1 + 1e-7))
    assert np.all(root.bounds[rows] <= family.signed + 1e-7 * np.abs(family.signed))
