"""Contraction never loses a design: random programs with tables, a small problem, and the multi-plate family."""

from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pandas as pd
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from synth.problems.mechanics.guide_friction import sum_geometric

import synth
from synth.bounds.array_reader import BoxArrays
from synth.bounds.clusters import ClusterTree, Factor
from synth.bounds.contractor import Contractor
from synth.bounds.propagated_nodes import MovingInputs, PropagatedNodes
from synth.bounds.root_propagation import Leaves, propagated_root
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import Program
from synth.question.catalogs import as_catalogs, catalogs_for
from synth.search.formulation import Formulation
from synth.search.refused_cells import not_refused
from synth.search.settings import TUNING
from synth.special import recorded
from tests.asking import instance_of
from tests.repetitions import repetitions
from tests.sample_problems.strut import designs_of, strut_form

TIE = TUNING.tolerances.tie

ROWS = 6


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


def contraction(contractor, data, trees, cell, low, high, caps, passes, bounds=None, floors=None):
    """Contract boxes as a question does: constants, tables per cluster, what holds over everything, instructions.

    ``data`` holds, per data input, a number or the column of the factor it belongs to.
    """
    n, factor_of = contractor.nodes.layout.n_variables, contractor.nodes.layout.factor_of
    right = [constraint.bound for constraint in contractor.nodes.constraints] if bounds is None else bounds
    alone = [np.nan if f >= 0 else x for x, f in zip(data, factor_of, strict=True)]
    with np.errstate(all="ignore"):
        constants = [float(np.ravel(v)[0]) for v in contractor.constant_values([None] * n + alone)]
        values = [np.broadcast_to(v, (ROWS,)) for v in contractor.tabulate([None] * n + list(data))]
    hull = np.array([v.min() for v in values]), np.array([v.max() for v in values])
    root = propagated_root(contractor.nodes, Leaves(low.min(axis=0), high.max(axis=0), hull, constants, right))
    tables = []
    for k, v in zip(contractor.nodes.tables, values, strict=True):
        f = contractor.nodes.factor[k]
        least, most = trees[f].hull(v[:, None])
        tables.append((np.fmax(least[cell[:, f], 0], root.low[k]), np.fmin(most[cell[:, f], 0], root.high[k])))
    # Signs that hold over the question are settled in the code: as in the engine, no box reaches beyond its root.
    inputs = contractor.nodes.program.input_nodes[:n]
    variables = [(np.fmax(low[:, i], root.low[k]), np.fmin(high[:, i], root.high[k])) for i, k in enumerate(inputs)]
    count = len(low)
    reader = contractor.code(root, caps is not None).reader
    with np.errstate(all="ignore"):
        least = [-np.inf] * len(contractor.nodes.goals) if floors is None else floors
        boxes = BoxArrays(count, variables, tables, constants, right, caps, least)
        dead, goals, opens = reader.contract(boxes, root, passes)
    return SimpleNamespace(
        alive=~dead & (not root.empty),
        low=np.stack([np.broadcast_to(a, (count,)) for a, _ in variables], axis=1),
        high=np.stack([np.broadcast_to(b, (count,)) for _, b in variables], axis=1),
        bounds=np.stack([np.broadcast_to(g, (count,)) for g in goals], axis=1) if goals else np.empty((count, 0)),
        open=np.stack([np.broadcast_to(o, (count,)) for o in opens], axis=1) if opens else np.empty((count, 0)),
    )


def clusters_of(rng, tree, rows):
    """Return a random cluster of a tree above each row: its leaf, or something larger that holds it."""
    above = np.zeros(len(tree), dtype=int)
    for k in np.flatnonzero(~tree.leaf):
        above[tree.left[k]] = above[tree.right[k]] = k
    cell = tree.leaf_of_row[rows].astype(int)
    for _ in range(4):
        cell = np.where(rng.random(len(rows)) < 0.4, above[cell], cell)
    return cell


class Question:
    """A random program with tables, boxes of variables and clusters, and a point with rows in each box."""

    def __init__(self, seed, boxes=25):
        self.rng = rng = np.random.default_rng(seed)
        n, factors = int(rng.integers(1, 4)), int(rng.integers(1, 4))
        owner = [-1, *range(factors), int(rng.integers(factors)), 0]
        symbols = [ca.SX.sym(f"x{k}") for k in range(n)]
        data = [ca.SX.sym(f"c{k}") for k in range(len(owner))]
        with recorded() as calls:
            # The last column is void in some rows: it serves as a limit only.
            expressions = random_expressions(rng, symbols, data[:-1], int(rng.integers(6, 25)))
        self.program = Program([*symbols, *data], [*expressions, data[-1]], calls)
        self.layout = MovingInputs(n, tuple(owner))
        columns = [rng.uniform(-1, 2, ROWS) for _ in owner]
        for column in columns:
            column[rng.integers(ROWS)] = column[0]  # equal rows share a leaf
        columns[-1][rng.random(ROWS) < 0.4] = np.nan
        self.data = [float(rng.uniform(0.2, 2)), *columns[1:]]
        self.trees = []
        for f in range(factors):
            own = tuple(k for k, x in enumerate(owner) if x == f)
            held = np.stack([columns[k] for k in own], axis=1)
            self.trees.append(ClusterTree(Factor(f"f{f}", own, held), rng.random(len(own))))
        self.rows = rng.integers(ROWS, size=(boxes, factors))
        self.cell = np.stack([clusters_of(rng, t, self.rows[:, f]) for f, t in enumerate(self.trees)], axis=1)
        self.point = rng.uniform(-2, 2, (boxes, n))
        width = rng.exponential(1.0, (2, boxes, n)) * (rng.random((2, boxes, n)) < 0.85)
        self.low, self.high = self.point - width[0], self.point + width[1]
        self.boxes = boxes
        self.values = self.values_at(self.point, self.rows)
        self.exists = np.all(np.isfinite(self.values[:4]), axis=0)

    def values_at(self, points, rows):
        owner = self.layout.factor_of
        data = [x if f < 0 else x[rows[:, f]] for x, f in zip(self.data, owner, strict=True)]
        with np.errstate(all="ignore"):
            return [np.broadcast_to(v, (self.boxes,)) for v in self.program.compile()([*points.T, *data])]

    def limits(self):
        """Return limits that the points keep (some with nothing to spare), the caps they keep, and which points."""
        a, b, c, e, void = self.program.outputs
        constraints, kept = [], self.exists.copy()
        for node, value in ((a, self.values[0]), (b, self.values[1])):
            sense = ("at_most", "at_least")[self.rng.integers(2)]
            level = float(self.rng.choice(value)) if np.isfinite(value).any() else 0.0
            constraints.append(NodeConstraint(sense, node, None, 1e-9, level))
            kept &= (value <= level) if sense == "at_most" else (value >= level)
        constraints += [NodeConstraint("at_most", a, b, 1e-9), NodeConstraint("at_least", c, void, 1e-9)]
        kept &= self.values[0] <= self.values[1]
        kept &= np.isnan(self.values[4]) | (self.values[2] >= self.values[4])
        goals = [Goal(c, 1), Goal(e, -1)]
        spare = self.rng.exponential(0.3, (2, self.boxes)) * (self.rng.random((2, self.boxes)) < 0.6)
        caps = [self.values[2] + spare[0] + TIE, -self.values[3] + spare[1] + TIE]
        return constraints, goals, caps, kept

    def floors(self):
        """Return floors of the objectives that the points keep, some with nothing to spare."""
        spare = self.rng.exponential(0.3, (2, self.boxes))
        spare = np.where(self.rng.random((2, self.boxes)) < 0.3, np.inf, spare * (self.rng.random(spare.shape) < 0.6))
        return [self.values[2] - spare[0] - TIE, -self.values[3] - spare[1] - TIE]

    def contracted(self, constraints, goals, caps, passes, floors=None):
        contractor = Contractor(PropagatedNodes(self.program, self.layout, constraints, goals))
        return contraction(
            contractor, self.data, self.trees, self.cell, self.low, self.high, caps, passes, floors=floors
        )


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 3), st.sampled_from(["", "caps", "caps and floors"]))
@example(8564, 1, "")  # a limit settles the sign of a variable that boxes have with both signs
@settings(deadline=None, derandomize=True, max_examples=repetitions(60, 120))
def test_a_box_with_a_feasible_point_survives_and_keeps_it(seed, passes, held):
    question = Question(seed)
    constraints, goals, caps, kept = question.limits()
    floors = question.floors() if "floors" in held else None
    result = question.contracted(constraints, goals, caps if held else None, passes, floors)
    assert result.alive[kept].all()
    slack = 1e-7 * (1 + np.abs(question.point))
    good = (question.point >= result.low - slack) & (question.point <= result.high + slack)
    assert good[kept].all()
    objectives = np.stack([question.values[2], -question.values[3]], axis=1)
    assert not np.any((result.bounds > objectives + 1e-7 * (1 + np.abs(objectives)))[kept])


def test_a_box_dies_below_the_floor_of_an_objective_and_is_narrowed_to_it():
    limit = [("at_most", 0, None, 9.0)]
    below = contract(lambda x, y: [x + y, x], limit, [(1, 1)], [0, 0], [2, 2], cutoffs=[9.0], floors=[2.1])
    assert not below.alive[0]
    above = contract(lambda x, y: [x + y, x], limit, [(1, 1)], [0, 0], [2, 2], cutoffs=[9.0], floors=[1.5])
    assert above.alive[0]
    assert above.low[0, 0] == 1.5
    largest = contract(lambda x, y: [x + y, x], limit, [(1, -1)], [0, 0], [2, 2], cutoffs=[9.0], floors=[-0.5])
    assert largest.high[0, 0] == 0.5
    assert not contract(lambda x, y: [x + y, x], limit, [(1, -1)], [1, 0], [2, 2], cutoffs=[9], floors=[-0.5]).alive[0]


def test_the_random_questions_are_worth_asking():
    tried = [Question(seed) for seed in range(40)]
    asked = [(q, q.limits()) for q in tried]
    kept = np.concatenate([x[3] for _, x in asked])
    assert 0.1 < kept.mean() < 0.9
    results = [q.contracted(constraints, goals, caps, 2) for q, (constraints, goals, caps, _) in asked]
    assert np.mean(np.concatenate([r.alive for r in results])) < 0.95
    width = np.concatenate([(r.high - r.low)[r.alive].ravel() for r in results])
    before = np.concatenate([(q.high - q.low)[r.alive].ravel() for q, r in zip(tried, results, strict=True)])
    assert np.all(width <= before + 1e-12)
    assert np.mean(width < 0.99 * before) > 0.02


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 3))
@settings(deadline=None, derandomize=True, max_examples=repetitions(20, 40))
def test_bounds_of_objectives_hold_at_every_point_of_a_box(seed, passes):
    question = Question(seed, boxes=10)
    goals = [Goal(node, sign) for node in question.program.outputs[:4] for sign in (1, -1)]
    result = question.contracted([], goals, None, passes)
    assert result.alive.all()
    for _ in range(20):
        share = question.rng.random(question.point.shape)
        points = question.low + share * (question.high - question.low)
        rows = np.stack(
            [
                [question.rng.choice(tree.rows(int(c))) for c in question.cell[:, f]]
                for f, tree in enumerate(question.trees)
            ],
            axis=1,
        )
        values = question.values_at(points, rows)
        for j, goal in enumerate(goals):
            value = goal.sign * values[j // 2]
            assert not np.any(result.bounds[:, j] > value + 1e-9 * (1 + np.abs(value)))


@pytest.mark.slow
@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=repetitions(25, 50))
def test_a_box_of_one_point_survives_its_own_values(seed):
    question = Question(seed, boxes=1)
    question.low = question.high = question.point
    question.cell = np.stack([t.leaf_of_row[question.rows[:, f]] for f, t in enumerate(question.trees)], axis=1)
    if not question.exists[0]:
        return
    outputs, values = question.program.outputs, question.values
    constraints = [NodeConstraint("equal", outputs[k], None, 1e-9, float(values[k][0])) for k in (0, 1)]
    constraints += [NodeConstraint("equal", outputs[k], outputs[k], 1e-9) for k in (2, 3)]
    result = question.contracted(constraints, [Goal(outputs[2], 1)], [values[2] + TIE], 5)
    assert result.alive[0]
    np.testing.assert_allclose(result.low, question.point, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(result.high, question.point, rtol=1e-6, atol=1e-9)


# -- what needs care ---------------------------------------------------------------------------------


def contract(expressions, constraints, goals, low, high, cutoffs=None, data=(), passes=2, floors=None):
    """Return the contraction of one box of a program of x and y (and constants given with their values)."""
    symbols = [ca.SX.sym("x"), ca.SX.sym("y")]
    extra = [ca.SX.sym(f"c{k}") for k in range(len(data))]
    program = Program([*symbols, *extra], expressions(*symbols, *extra))
    node = program.outputs
    made = [NodeConstraint(s, node[v], b if b is None else node[b], 1e-9, level) for s, v, b, level in constraints]
    nodes = PropagatedNodes(
        program, MovingInputs(2, (-1,) * len(data)), made, [Goal(node[k], sign) for k, sign in goals]
    )
    contractor = Contractor(nodes)
    ends = np.array([low], dtype=float), np.array([high], dtype=float)
    return contraction(contractor, data, [], np.zeros((1, 0), dtype=int), *ends, cutoffs, passes, floors=floors)


def test_what_cannot_hold_dies_and_what_can_is_narrowed():
    limit = [("at_least", 0, None, 3.0)]
    result = contract(lambda x, y: [x + y, x], limit, [(1, 1)], [0, 0], [2, 2])
    assert result.alive[0]
    assert result.low[0] == pytest.approx([1, 1], abs=1e-4)
    assert result.bounds[0, 0] == pytest.approx(1, abs=1e-4)
    assert not contract(lambda x, y: [x + y, x], limit, [(1, 1)], [0, 0], [1.4, 1.4]).alive[0]
    assert not contract(lambda x, y: [x + y, x], limit, [(1, 1)], [0, 0], [2, 2], cutoffs=[0.9]).alive[0]


def test_bounds_are_not_taken_from_where_a_limit_fails():
    # f = n**2 rises with x and y only where the limit n >= 0.1 holds; the corner (0, 0) with f = 1 is no bound.
    def expressions(x, y):
        n = x * y - 1
        return [n, n * n]

    limit = [("at_least", 0, None, 0.1)]
    assert contract(expressions, limit, [(1, 1)], [0, 0], [2, 2]).bounds[0, 0] <= 0.01
    assert contract(expressions, limit, [(1, 1)], [0, 0], [2, 2], cutoffs=[0.5]).alive[0]  # x = y = 1.0488 has f = 0.01


def test_a_comparison_used_as_a_number_jumps():
    result = contract(lambda x, y: [(x > 0.5) * (-10.0) + x], [], [(0, 1)], [0, 0], [1, 1])
    assert result.bounds[0, 0] <= -9.5
    assert contract(lambda x, y: [(x > 0.5) * (-10.0) + x], [], [(0, 1)], [0, 0], [1, 1], cutoffs=[-5.0]).alive[0]


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

    result = contract(expressions, [], [(0, 1)], [0.1, -1], [0.9, 1], cutoffs=[6.0], data=[0.0])
    assert result.alive[0]
    assert not result.bounds[0, 0] > 5.9


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
        data=[size],
        cutoffs=[value * 2.0],
        passes=6,
    )
    assert result.alive[0]
    assert result.low[0] == pytest.approx([value, 2.0], rel=1e-6)
    assert result.high[0] == pytest.approx([value, 2.0], rel=1e-6)
    assert np.all(result.low <= result.high)


@pytest.mark.parametrize("value", [18.0, 25.0, 33.0])
def test_a_point_survives_the_inverse_of_a_saturated_exponential(value):
    # 1 - exp(-18) has eight digits of the exponent left: backward through it, rounding is magnified ten million times.
    def expressions(x, y):
        return [-np.expm1(-x / (1 + y)) * (2 + y), x - 5 * y]

    low = [value, 0.1]
    result = contract(expressions, [("at_least", 1, None, 0.0)], [(0, 1)], low, low, cutoffs=[1e3], passes=6)
    assert result.alive[0]
    assert result.low[0] == pytest.approx(low, rel=1e-12)
    assert result.high[0] == pytest.approx(low, rel=1e-12)


# -- limits that are void in some rows ---------------------------------------------------------------

LEVELS = pd.DataFrame(
    {"designation": ["known", "void"], "level [-]": [5.0, None], "price [-]": [2.0, 1.0], "source": ["test", "test"]}
)


class Levels(synth.DesignProblem):
    """One variable, and limits on an optional column that one row does not have."""

    name, title = "levels", "Levels"
    sources = ("statics",)

    def declare(self, d):
        second = d.option("second", ("none", "constant", "contradiction"), "none")
        x = d.variable("x", "-", 0.5, 10)
        row = d.part("row", "rows")
        level = row.optional("level")
        d.derive("cost", "-", row.price * x)
        d.at_least("enough", x, level, "-")
        if second == "constant":
            d.at_least("sensible", level, 4.0, "-")
        elif second == "contradiction":
            d.at_most("not_too_much", x + 1, level, "-")
        d.objective("cost")


@pytest.mark.parametrize("second", ["none", "constant", "contradiction"])
def test_a_void_column_says_nothing(second):
    problem = Levels(second=second)
    instance = instance_of(problem, {}, catalogs_for(problem, {"rows": LEVELS}), grid=False)
    form = Formulation(instance, {"cost": "min"}, 1)
    x = np.linspace(0.5, 10, 20)[:, None]
    assert form.points.evaluate(x, np.full(20, 1)).feasible.all()
    for box in (form.boxes.root(), form.boxes.contract(form.boxes.box_of(1), None)):
        assert len(box) == 1
        assert box.low[0, 0] <= 0.5
        assert box.high[0, 0] >= 10
        assert box.bounds[0, 0] <= 0.5 + 1e-9


# -- a small problem with makeable values ------------------------------------------------------------


def around(form, rng, points, combinations, scale):
    """Return boxes of clusters and ranges around designs; the tag tells which design each is around."""
    low = np.maximum(points - scale * rng.exponential(1.0, points.shape) * (form.upper - form.lower), form.lower)
    high = np.minimum(points + scale * rng.exponential(1.0, points.shape) * (form.upper - form.lower), form.upper)
    boxes = form.boxes.leaves(combinations, low, high)
    digits = form.instance.combinations.digits(combinations)
    cell = [clusters_of(rng, t, d) for t, d in zip(form.boxes.cells.trees, digits, strict=True)]
    return replace(boxes, cell=np.stack(cell, axis=1).astype(np.int32), tag=np.arange(len(points), dtype=np.int32))


def assert_kept(kept, points, phi, form):
    np.testing.assert_array_equal(np.sort(kept.tag), np.arange(len(points)))
    own, least, (low, high) = points[kept.tag], form.objectives.phi_of(kept.bounds), form.boxes.ends(kept)
    assert np.all(own >= low - 1e-7 * np.abs(own) - 1e-12)
    assert np.all(own <= high + 1e-7 * np.abs(own) + 1e-12)
    assert not np.any(least > phi[kept.tag] + 1e-7 * (1 + np.abs(phi[kept.tag])))


@pytest.mark.parametrize("grid", [True, False])
@pytest.mark.parametrize("passes", [1, 2, 3])
def test_boxes_of_clusters_around_designs_of_a_small_problem_survive(grid, passes):
    form, rng = strut_form(grid), np.random.default_rng(passes)
    points, combinations, phi = designs_of(form, rng, 4000)
    assert len(points) > 200
    for scale in (0.3, 0.03, 0.0):
        boxes = around(form, rng, points, combinations, scale)
        assert_kept(form.boxes.contract(boxes, None, passes, every_goal=True), points, phi, form)
        caps = phi + TIE + rng.exponential(0.1, phi.shape) * (rng.random(phi.shape) < 0.7)
        assert_kept(form.boxes.contract(boxes, caps, passes, every_goal=True), points, phi, form)


def test_halves_of_boxes_hold_what_the_box_held():
    form, rng = strut_form(), np.random.default_rng(1)
    points, combinations, _ = designs_of(form, rng, 1000)
    digits = form.instance.combinations.digits(combinations)
    boxes = form.boxes.root()
    for _ in range(12):
        halves, rest = form.boxes.split(boxes)
        boxes = halves.take(slice(0, 64)) if len(halves) > 64 else halves
        boxes = form.boxes.contract(boxes, None) if len(halves) <= 64 else boxes
        if len(halves) > 64:
            break
        assert not len(rest)
        held = np.all(
            (points[:, None] >= boxes.low - 1e-9) & (points[:, None] <= boxes.high + 1e-9), axis=2
        )  # (designs, boxes)
        for f, tree in enumerate(form.boxes.cells.trees):
            inside = np.array([np.isin(digits[f], tree.rows(int(c))) for c in boxes.cell[:, f]]).T
            held &= inside
        assert held.any(axis=1).all()


@pytest.mark.slow
def test_the_kernel_finds_what_numpy_finds(monkeypatch):
    plain, machine = strut_form(), strut_form()
    rng = np.random.default_rng(4)
    points, combinations, phi = designs_of(plain, rng, 2000)
    boxes = around(plain, rng, points, combinations, 0.2)
    caps = phi + rng.exponential(0.05, phi.shape) - 0.03  # some boxes die
    for limits in (None, caps):
        monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
        one = plain.boxes.contract(boxes, limits)
        monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "1")
        two = machine.boxes.contract(boxes, limits)
        np.testing.assert_array_equal(one.tag, two.tag)
        np.testing.assert_array_equal(one.cell, two.cell)
        for a, b in ((one.low, two.low), (one.high, two.high), (one.bounds, two.bounds)):
            np.testing.assert_allclose(a, b, rtol=1e-9)
    assert len(one) < len(boxes)


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
    """A question to the multi-plate family, and random feasible designs of all combinations."""

    def __init__(self, options, objectives, wanted=600):
        problem = synth.load("multi_plate_clutch", practice="off", **options)
        self.instance = instance = instance_of(problem, REQUIREMENTS, as_catalogs(None), grid=False)
        self.model = instance.model
        self.form = Formulation(instance, dict.fromkeys(objectives, "min"), len(objectives))
        self.points, self.combinations = self._feasible(np.random.default_rng(11), wanted)
        values = self.model.evaluate(self.points, instance.data(self.combinations)).values
        self.phi = self.form.objectives.phi_of(np.stack([values[name] for name in objectives], axis=1))

    def _feasible(self, rng, wanted):
        """Return random feasible points: sensible rings, forces that carry the sizing torque."""
        found_x, found_c = [], []
        for _ in range(12):
            n = 40000
            combinations = rng.integers(0, self.instance.combinations.count, n)
            data = self.instance.data(combinations)
            outer = rng.uniform(0.1, 0.5, n)
            ratio = rng.uniform(0.1, 0.25, n)
            x = np.stack([outer, outer * (1 - ratio) / (1 + ratio), np.full(n, 1e4), rng.uniform(0.05, 3, n)], axis=1)
            values = self.model.evaluate(x, data).values
            with np.errstate(all="ignore"):
                x[:, 2] = (
                    1e4
                    * self.instance.values.requirements["required_torque"]
                    / values["torque"]
                    * rng.uniform(1, 1.6, n)
                )
            x[:, 2] = np.clip(np.nan_to_num(x[:, 2], nan=50.0), 50, 2e5)
            good = np.flatnonzero(self.model.evaluate(x, data).feasible & not_refused(self.form.instance, combinations))
            found_x.append(x[good])
            found_c.append(combinations[good])
            if sum(map(len, found_x)) >= wanted:
                break
        return np.concatenate(found_x)[:wanted], np.concatenate(found_c)[:wanted]


@pytest.fixture(
    scope="module",
    params=[name if name == "default" else pytest.param(name, marks=pytest.mark.slow) for name in OPTION_SETS],
)
def family(request):
    found = Family(OPTION_SETS[request.param], ["mass", "actuation_force", "friction_work", "drag_torque"])
    assert len(found.points) > 100
    return found


@pytest.mark.slow
def test_boxes_around_feasible_designs_survive(family):
    form, points, phi, rng = family.form, family.points, family.phi, np.random.default_rng(5)
    lower, upper = family.instance.ranges.lower, family.instance.ranges.upper
    for scale in (3.0, 1.0, 0.3, 0.1, 0.02, 0.0):
        boxes = around(form, rng, points, family.combinations, 0.0)
        if scale < 0.2:
            boxes = replace(boxes, cell=form.boxes.leaves(family.combinations).cell)
        low = np.maximum(points * np.exp(-scale * rng.exponential(1.0, points.shape)), lower)
        high = np.minimum(points * np.exp(scale * rng.exponential(1.0, points.shape)), upper)
        open_sides = (rng.random(points.shape) < 0.2) & (scale > 0)
        boxes = replace(boxes, low=np.where(open_sides, lower, low), high=np.where(open_sides, upper, high))
        spare = rng.exponential(0.1, phi.shape) * (rng.random(phi.shape) < 0.7)
        for caps in (None, phi + spare + TIE * (1 + np.abs(phi))):
            for passes in (1, 3):
                assert_kept(form.boxes.contract(boxes, caps, passes), points, phi, form)


@pytest.mark.slow
def test_boxes_that_carry_inner_nodes_keep_the_designs_that_have_these_values(family):
    form, points, phi, rng = family.form, family.points, family.phi, np.random.default_rng(6)
    auxiliary = form.bounding.question.auxiliary
    assert auxiliary  # friction work sees the torque, which many variables and parts make together
    data = form.instance.data(family.combinations)
    values = family.model.program.compile(auxiliary)([*points.T, *data])
    held = np.stack([np.broadcast_to(v, len(points)) for v in values], axis=1)
    boxes = around(form, rng, points, family.combinations, 0.0)
    for scale in (1.0, 0.1, 0.0):
        low = points * np.exp(-scale * rng.exponential(1.0, points.shape))
        high = points * np.exp(scale * rng.exponential(1.0, points.shape))
        for width in (0.1, 1e-3, 0.0):
            least = held * np.exp(-width * rng.random(held.shape))
            most = held * np.exp(width * rng.random(held.shape))
            carrying = replace(
                boxes,
                low=np.concatenate([np.maximum(low, family.instance.ranges.lower), least], axis=1),
                high=np.concatenate([np.minimum(high, family.instance.ranges.upper), most], axis=1),
            )
            assert_kept(form.boxes.contract(carrying, None, 3), points, phi, form)
            assert_kept(form.boxes.contract(carrying, phi + TIE * (1 + np.abs(phi)), 2), points, phi, form)


def test_the_root_box_holds_all_feasible_designs(family):
    form, points, phi = family.form, family.points, family.phi
    root = form.boxes.root()
    assert len(root) == 1
    assert not root.cell.any()
    everywhere = replace(root.take(np.zeros(len(points), dtype=int)), tag=np.arange(len(points)))
    assert_kept(everywhere, points, phi, form)
    leaves = replace(form.boxes.leaves(family.combinations), tag=np.arange(len(points), dtype=np.int32))
    assert_kept(form.boxes.contract(leaves, None), points, phi, form)
    for k in range(0, len(points), 40):
        alone = replace(
            form.boxes.contract(form.boxes.box_of(int(family.combinations[k])), None), tag=np.zeros(1, dtype=np.int32)
        )
        assert_kept(alone, points[k : k + 1], phi[k : k + 1], form)
