"""What the classification claims, checked on samples: signs, elasticities and curvature of every node."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synth.problems.mechanics.guide_friction import sum_geometric
from synth.problems.mechanics.heat import peak_rise_per_work
from synth.problems.mechanics.startup import reactive_friction_work, reactive_peak_slip_power

import synth
from synth.bounds.structure import Structure, classify
from synth.declaration import Declaration
from synth.model.model import Model
from synth.model.program import OP_SELECT, OP_SPECIAL
from synth.question.catalogs import as_catalogs
from synth.question.ranges import declared_ranges
from tests.conformance.cases import CASES, STRUCTURES, known_design, question

pytestmark = pytest.mark.slow

CANCELLED = 1e-5  # a difference that is smaller than this beside its terms has too few digits to be compared
BORDER = 1e-4  # of the domain of a special function
AT_ONCE = 8  # inputs, so that the values of all nodes stay small


class Claims:
    """Values of all nodes at points (points, inputs), and where the claims on a node count."""

    def __init__(self, model: Model, found: Structure) -> None:
        self.program, self.found = model.program, found
        self.nodes = model.program.nodes[: len(found.nodes)]
        self.evaluate = model.program.compile(list(range(len(self.nodes))))
        self.signs = np.array([shape.sign for shape in found.nodes])
        choosing = (ca.OP_FMIN, ca.OP_FMAX, ca.OP_IF_ELSE_ZERO, OP_SELECT)
        two = [(k, *n.args) for k, n in enumerate(self.nodes) if n.op != OP_SPECIAL and len(n.args) == 2]
        self.pairs = np.array(two, dtype=np.int64).reshape(-1, 3).T  # nodes of two things, and both of them
        chosen = self.program.downstream(k for k, node in enumerate(self.nodes) if node.op in choosing)
        self.chosen = chosen[: len(self.nodes)]

    def values(self, points: np.ndarray) -> np.ndarray:
        """Return the value of every node."""
        result = np.empty((len(self.signs), len(points)))
        with np.errstate(all="ignore"):
            for k, value in enumerate(self.evaluate(list(points.T))):
                result[k] = value
        return result

    def count(self, values: np.ndarray) -> np.ndarray:
        """Return, per node and point, whether all it is made of has the sign claimed, with digits enough."""
        good = np.isfinite(values) & ((self.signs[:, None] == 0) | (np.sign(values) == self.signs[:, None]))
        own, first, second = self.pairs
        larger = np.maximum(np.abs(values[first]), np.abs(values[second]))
        good[own] &= (np.abs(values[own]) > CANCELLED * larger) | (values[own] == 0)
        for k, node in enumerate(self.nodes):
            if node.op == OP_SPECIAL:
                above = self.program.specials[int(node.constant)].above
                if above is not None:
                    high, low = (values[node.args[i]] for i in above)
                    good[k] &= high > low * (1 + BORDER)
            for a in node.args:
                good[k] &= good[a]
        return good

    def check_curvature(self, first: np.ndarray, second: np.ndarray) -> int:
        """Compare midpoints with ends; return how many nodes could be judged."""
        ends, middle = [self.values(first), self.values(second)], self.values(np.sqrt(first * second))
        counts = self.count(ends[0]) & self.count(ends[1])
        between = self.count(middle)
        judged = 0
        for k, shape in enumerate(self.found.nodes):
            rows = counts[k]
            if not shape.sign or shape.curvature == "unknown" or not rows.any():
                continue
            judged += 1
            # Where the curvature is known the points that count form a convex set, unless a part that may not exist
            # is left out because it never is the smaller (or larger) one.
            assert self.chosen[k] or np.all(middle[k][rows] * shape.sign > 0)
            rows = rows & between[k]
            low, high, at = (np.log(np.abs(v[k][rows])) for v in (*ends, middle))
            excess = at - (low + high) / 2
            slack = 1e-9 * (1 + np.abs(low) + np.abs(high))
            if shape.curvature in ("log-convex", "log-affine"):
                assert np.all(excess <= slack), (k, self.nodes[k])
            if shape.curvature in ("log-concave", "log-affine"):
                assert np.all(excess >= -slack), (k, self.nodes[k])
        return judged

    def check_elasticities(self, points: np.ndarray, factors: np.ndarray, low: np.ndarray, high: np.ndarray) -> int:
        """Compare steps along each input with the interval of its elasticity; return how many were judged."""
        start = self.values(points)
        counts = self.count(start) & (self.signs != 0)[:, None]
        elasticity = np.array([shape.elasticity for shape in self.found.nodes])
        judged = 0
        inputs = np.flatnonzero(high > low)  # what has one value cannot be moved
        for some in np.split(inputs, range(AT_ONCE, len(inputs), AT_ONCE)):
            moved = np.tile(points, (len(some), 1, 1))
            for along, i in zip(moved, some, strict=True):
                along[:, i] = np.clip(points[:, i] * factors, low[i], high[i])
            ends = self.values(moved.reshape(-1, points.shape[1]))
            good = self.count(ends).reshape(len(ends), *moved.shape[:2])
            ends = ends.reshape(good.shape)
            for j, i in enumerate(some):
                with np.errstate(invalid="ignore"):  # what is 0 stays 0
                    step = np.log(moved[j, :, i] / points[:, i])
                rows = counts & good[:, j] & (np.abs(step) > 1e-3)
                judged += int(rows.any(axis=1).sum())
                with np.errstate(all="ignore"):  # of what does not count
                    rise = np.log(np.abs(ends[:, j] / start)) / step
                least, most = elasticity[:, i, 0, None], elasticity[:, i, 1, None]
                slack = 1e-7 * (1 + np.abs(rise))
                within = (rise >= least - slack) & (rise <= most + slack)
                for k in np.flatnonzero(np.any(rows & ~within, axis=1)):
                    raise AssertionError((int(k), self.nodes[k], self.found.inputs[i]))
        return judged


# -- every family --------------------------------------------------------------------------------------

POINTS = 200
SHARE_JUDGED = 5 / 9  # of the pairs of a node and an input that moves


@pytest.fixture(scope="module", params=STRUCTURES, ids=lambda q: f"{q[0]}-{q[1]}-{'all' if q[2] else 'needed'}")
def traced(request):
    family, options, optional = request.param
    rng = np.random.default_rng(1)
    instance = question(family, CASES[family].option_sets[options], optional)
    model = instance.model
    low, high = declared_ranges(model, as_catalogs(None))
    variables = CASES[family].sound(rng, instance, 8 * POINTS)
    data = instance.data(rng.integers(0, instance.combinations.count, len(variables)))
    columns = [np.broadcast_to(np.asarray(x, dtype=float), len(variables)) for x in data]
    known = known_design(family, options, optional)
    if known is not None:
        variables = np.concatenate([variables, known[0]])
        columns = [np.concatenate([x, own]) for x, own in zip(columns, known[1], strict=True)]
    feasible = model.evaluate(variables, columns).feasible
    return model, low, high, np.column_stack([variables, *columns]), feasible


@pytest.fixture(scope="module")
def classified(traced):
    """Return ranges and classification: over all that is declared, and with the requirements of one question."""
    model, low, high, points, _ = traced
    fixed = np.array([False] * len(model.variables) + [e.kind == "requirement" for e in model.data_inputs])
    asked = np.where(fixed, points[0], low), np.where(fixed, points[0], high)
    ranges = {"declared": (low, high), "asked": asked}
    return {name: (*ends, classify(model, *ends)) for name, ends in ranges.items()}


def scattered(points, low, high, rng):
    """Move all inputs of some points about, inside their ranges; what is 0 or has no value gets some."""
    points = np.where(np.isnan(points) | (points == 0), np.where(high > 0, 0.3 * np.minimum(high, 1e3), 1.0), points)
    moved = points * np.exp(rng.normal(0, 0.25, points.shape))
    return np.clip(moved, np.fmax(low, 1e-12), np.fmin(high, 1e12))


@pytest.mark.parametrize("ranges", ["declared", "asked"])
def test_claims_hold_in_every_family(traced, classified, ranges):
    model, _, _, points, feasible = traced
    rng = np.random.default_rng(2)
    low, high, found = classified[ranges]
    claims = Claims(model, found)
    # Every feasible design is where the claims hold.
    assert feasible.sum() > 1
    values = claims.values(points[feasible])
    for k, shape in enumerate(found.nodes):
        if shape.sign:
            known = values[k][~np.isnan(values[k])]
            assert np.all(known * shape.sign >= 0)
            assert np.all(known != 0) or not shape.nonzero
    first, second = (scattered(points[rng.permutation(len(points))[:POINTS]], low, high, rng) for _ in range(2))
    enough = len(model.quantity_sx) + len(model.limits)  # more nodes than there are things declared from them
    assert claims.check_curvature(first, second) > enough
    near = first**0.9 * second**0.1
    assert claims.check_curvature(first, near) > enough
    judged = claims.check_elasticities(first, np.exp(rng.uniform(-0.3, 0.3, POINTS)), low, high)
    assert judged > SHARE_JUDGED * np.count_nonzero(high > low) * len(found.nodes)


def test_narrower_ranges_tell_no_less(classified):
    wide, narrow = (classified[ranges][-1] for ranges in ("declared", "asked"))
    for before, after in zip(wide.nodes, narrow.nodes, strict=True):
        assert before.sign in (0, after.sign)
        assert before.curvature in ("unknown", after.curvature) or after.curvature == "log-affine"
        if before.sign:
            assert np.all(after.elasticity[:, 0] >= before.elasticity[:, 0] - 1e-9)
            assert np.all(after.elasticity[:, 1] <= before.elasticity[:, 1] + 1e-9)


def test_the_start_up_of_a_given_torque_is_convex():
    """With the torque given by a requirement, work and time follow the special functions alone."""
    problem = synth.load("multi_plate_clutch", practice="off")
    catalogs = as_catalogs(None)
    model = problem.model(frozenset({"startup_torque"}), catalogs)
    found = classify(model, *declared_ranges(model, catalogs))
    convex = ["slip_time", "cycle_time", "specific_heat", "engagement_heat", "ring_ratio_min"]
    assert {found.limits[name].curvature for name in convex} == {"log-convex"}
    assert found.limits["never_starts"].curvature == "log-affine"
    assert found.limits["ring_ratio_max"].curvature == "log-concave"
    assert found.objectives["friction_work"].curvature == "log-convex"
    assert found.objectives["actuation_force"].curvature == "log-affine"
    assert found.limits["peak_temperature"].text == "not surely positive"  # no allowance is left at the hottest ambient


# -- random problems -----------------------------------------------------------------------------------


def grow(rng, d, inputs, choice, size):
    """Return expressions grown by random operations; differences are kept positive by guards."""
    pool = list(inputs)
    guards = 0

    def positive(a, b):
        nonlocal guards
        d.at_least(f"guard_{guards}", a, b, "-", guard=True)
        guards += 1
        return a - b

    def work(formula, a, b, c):
        if a.is_constant() or b.is_constant() or (a - b).is_constant():
            return c
        positive(a, b)
        return formula(a, b, c, 2.0, 0.5)

    makers = [
        lambda a, b, c: a + b,
        lambda a, b, c: a * b,
        lambda a, b, c: a / b,
        lambda a, b, c: a**1.5 * np.sqrt(b),
        lambda a, b, c: 1 / (a + 0.5 * b),
        lambda a, b, c: positive(a, b),
        lambda a, b, c: (a + b) * positive(a, b) / c,
        lambda a, b, c: positive(3 * a * c, b * c),
        lambda a, b, c: np.maximum(a, b),
        lambda a, b, c: np.minimum(a, b * c),
        lambda a, b, c: np.hypot(a, b),
        lambda a, b, c: np.exp(-a) * b,
        lambda a, b, c: np.exp(0.3 * np.minimum(a, 5)),
        lambda a, b, c: np.log1p(a),
        lambda a, b, c: -np.log1p(-0.9 * np.exp(-a)),
        lambda a, b, c: -np.expm1(-a / b),
        lambda a, b, c: np.expm1(np.minimum(a, 3)),
        lambda a, b, c: np.tanh(a) + np.arctan(b),
        lambda a, b, c: np.sinh(np.tanh(a)) * np.cosh(np.tanh(b)),
        lambda a, b, c: np.sin(np.tanh(a)) / np.cos(np.tanh(b)),
        lambda a, b, c: np.abs(a - b) + c,
        lambda a, b, c: np.log(1 + a + b),
        lambda a, b, c: np.where(a < b, a, c + b),
        lambda a, b, c: choice.select({"one": a, "two": b}),
        lambda a, b, c: sum_geometric(a, b),
        lambda a, b, c: peak_rise_per_work(a, b, c, a),
        lambda a, b, c: work(reactive_friction_work, a, b, c),
        lambda a, b, c: work(reactive_peak_slip_power, a, b, c),
        lambda a, b, c: np.floor(2 * a) + b,
        lambda a, b, c: (2 + np.sin(a)) * b,
    ]
    for _ in range(size):
        a, b, c = (pool[rng.integers(len(pool))] for _ in range(3))
        pool.append(makers[rng.integers(len(makers))](a, b, c))
    return pool[len(inputs) :]


def random_problem(seed):
    rng = np.random.default_rng(seed)
    ends = np.sort(rng.uniform(0.1, 6, (4, 2)), axis=1) * [0.7, 1.3]

    class Random(synth.DesignProblem):
        name, title = "random", "Random"

        def declare(self, d: Declaration) -> None:
            inputs = [d.variable(f"x{k}", "-", float(low), float(high)) for k, (low, high) in enumerate(ends[:3])]
            inputs.append(d.requirement("given", "-", lower=float(ends[3, 0]), upper=float(ends[3, 1])))
            inputs.append(d.requirement("loose", "-", lower=0))
            inputs.append(d.count("n", 1, 6))
            choice = d.choice("kind", ("one", "two"))
            for k, value in enumerate(grow(np.random.default_rng(seed), d, inputs, choice, int(rng.integers(3, 14)))):
                d.derive(f"q{k}", "-", value)

    catalogs = as_catalogs(None)
    model = Random().model(frozenset(), catalogs)
    return model, *declared_ranges(model, catalogs)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=80)
def test_claims_hold_in_random_problems(seed):
    model, low, high = random_problem(seed)
    found = classify(model, low, high)
    claims = Claims(model, found)
    rng = np.random.default_rng(seed)
    kind = found.inputs.index("kind")
    top = np.where(np.isfinite(high), high, 1e2)
    bottom = np.where(low > 0, low, 1e-3)
    for label in (0.0, 1.0):
        first, second = np.exp(rng.uniform(np.log(bottom), np.log(np.maximum(top, bottom)), (2, 500, len(low))))
        first[:, kind] = second[:, kind] = label
        claims.check_curvature(first, second)
        claims.check_curvature(first, first**0.9 * second**0.1)
        inputs = np.arange(len(low)) != kind
        least, most = np.where(inputs, low, label), np.where(inputs, high, label)
        claims.check_elasticities(first, np.exp(rng.uniform(-0.4, 0.4, 500)), np.maximum(least, 1e-9), most)


def test_random_problems_are_of_every_kind():
    curvatures, signs = [], []
    for seed in range(60):
        found = classify(*random_problem(seed))
        curvatures += [shape.curvature for shape in found.quantities.values() if shape.sign]
        signs += [shape.sign for shape in found.quantities.values()]
    share = {word: curvatures.count(word) / len(curvatures) for word in set(curvatures)}
    assert set(share) == {"log-affine", "log-convex", "log-concave", "unknown"}
    assert min(share.values()) > 0.05
    assert 0 in signs
