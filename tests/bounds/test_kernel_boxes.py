"""Contraction of boxes by the kernel says what NumPy says: every rule, random programs, and the multi-plate family."""

import pkgutil
from importlib import import_module

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synth.problems.mechanics.guide_friction import sum_geometric
from synth.problems.mechanics.startup import reactive_slip_time
from synth.problems.multi_plate.model import MultiPlateClutch

from synth import problems
from synth.bounds.array_reader import BoxArrays
from synth.bounds.box_batches import KernelQuestion, Prepared
from synth.bounds.boxes import Boxes
from synth.bounds.branching import ScoreTables
from synth.bounds.contractor import Contractor
from synth.bounds.instructions import COMPARED, ELEMENTARY
from synth.bounds.intervals import FORWARD
from synth.bounds.kernel_boxes import MOST, BoxKernel, KernelList, Verdicts, box_kernel
from synth.bounds.propagated_nodes import MovingInputs, PropagatedNodes
from synth.bounds.root_propagation import Leaves, propagated_root
from synth.bounds.settings import KernelSizes
from synth.kernels.loading import LEVELS, best_variant, processor_level, variant
from synth.model.constraint import Goal, NodeConstraint
from synth.model.program import OP_SELECT, OPERATIONS, Program
from synth.order.margins import above
from synth.question.catalogs import as_catalogs
from synth.search.formulation import Formulation
from synth.search.makeable_values import MakeableValues
from synth.search.settings import TUNING
from synth.special import TABLE, recorded
from tests.asking import instance_of
from tests.repetitions import repetitions

pytestmark = pytest.mark.skipif(best_variant("boxes") is None, reason="no kernel was built")

ROWS, CLUSTERS = 7, 12


def kernel_of(code):
    """Kernel with the instructions of a sign pattern."""
    found = box_kernel(code)
    assert found is not None
    return found


class Case:
    """A program with variables, two slots and a requirement, contracted in both ways.

    Parameters
    ----------
    program : Program
        Inputs: variables, two columns of the first slot, one of the second, a requirement.
    n : int
        Variables.
    constraints, goals : list
    range_ : (float, float)
        Of all inputs.
    """

    def __init__(self, program, n, constraints, goals, range_, rng, boxes):
        self.rng, self.n, self.constraints, self.goals, self.boxes = rng, n, constraints, goals, boxes
        self.bounds = [c.bound for c in constraints]
        nodes = PropagatedNodes(program, MovingInputs(n, (0, 0, 1, -1), (1,)), constraints, goals)
        self.contractor = c = Contractor(nodes)
        least, most = range_
        columns = rng.uniform(least, most, (3, ROWS))
        columns[1] = np.where(rng.random(ROWS) < 0.15, np.nan, columns[1])
        self.requirement = float(rng.uniform(least, most))
        with np.errstate(all="ignore"):
            constants = c.constant_values([None] * n + [np.nan] * 3 + [self.requirement])
            per_slot = [
                c.tabulate([*[None] * n, columns[0], columns[1], np.full(ROWS, np.nan), self.requirement]),
                c.tabulate([*[None] * n, *np.full((2, ROWS), np.nan), columns[2], self.requirement]),
            ]
        self.constants = [float(np.asarray(v).ravel()[0]) for v in constants]
        rows = [
            np.broadcast_to(np.asarray(per_slot[nodes.factor[k]][i], dtype=float), (ROWS,))
            for i, k in enumerate(nodes.tables)
        ]
        hull = np.array([v.min() for v in rows]), np.array([v.max() for v in rows])
        self.low_end, self.high_end = np.full(n, least), np.full(n, most)
        self.root = propagated_root(nodes, Leaves(self.low_end, self.high_end, hull, self.constants, self.bounds))
        pairs = rng.integers(ROWS, size=(2, CLUSTERS))
        self.tables = []
        for k, v in zip(nodes.tables, rows, strict=True):
            ends = np.minimum(v[pairs[0]], v[pairs[1]]), np.maximum(v[pairs[0]], v[pairs[1]])
            ends = np.fmax(ends[0], self.root.low[k]), np.fmin(ends[1], self.root.high[k])
            self.tables.append((nodes.factor[k], *ends))
        self.cell = rng.integers(CLUSTERS, size=(boxes, 2)).astype(np.int32)
        ends = rng.uniform(least, most, (2, boxes, n))
        ends[1] = np.where(rng.random((boxes, n)) < 0.1, ends[0], ends[1])
        self.low, self.high = ends.min(axis=0), ends.max(axis=0)
        whole = rng.random((boxes, n)) < 0.2
        self.low, self.high = np.where(whole, least, self.low), np.where(whole, most, self.high)
        self.cutoffs = rng.normal(0, 3, (boxes, len(goals))) * most
        self.floors = np.where(rng.random((CLUSTERS, len(goals))) < 0.6, -np.inf, -2 * most + self.cutoffs.min(axis=0))
        self.floors = np.where(rng.random(self.floors.shape) < 0.3, rng.normal(-1, 3, self.floors.shape), self.floors)
        self.steep = rng.random((len(constraints) + len(goals), n))
        self.spreads = [rng.random((CLUSTERS, len(constraints) + len(goals))).astype(np.float32) for _ in range(2)]

    def numpy(self, code, capped, passes):
        """Contract box by box: in NumPy a rule may look at all boxes of a batch."""
        alive, low, high = np.zeros(self.boxes, dtype=bool), self.low.copy(), self.high.copy()
        goals, opens = (
            np.zeros((self.boxes, len(self.goals))),
            np.zeros((self.boxes, len(self.constraints)), dtype=bool),
        )
        for b in range(self.boxes):
            ends = [(low[b : b + 1, i], high[b : b + 1, i]) for i in range(self.n)]
            tables = [(x[self.cell[b, f]][None], y[self.cell[b, f]][None]) for f, x, y in self.tables]
            caps = [self.cutoffs[b : b + 1, j] for j in range(len(self.goals))] if capped else None
            least_of = [self.floors[self.cell[b, 0], j][None] for j in range(len(self.goals))]
            with np.errstate(all="ignore"):
                boxes = BoxArrays(1, ends, tables, self.constants, self.bounds, caps, least_of)
                dead, least, flags = code.reader.contract(boxes, self.root, passes)
            alive[b] = not dead[0]
            low[b], high[b] = [float(x[0]) for x, _ in ends], [float(y[0]) for _, y in ends]
            goals[b] = [float(np.asarray(x).ravel()[0]) for x in least]
            opens[b] = [bool(np.asarray(x).ravel()[0]) for x in flags]
        alive &= ~np.any(low > above(high, *TUNING.tolerances.margins), axis=1)
        return alive, low, np.maximum(low, high), goals, opens

    def by_kernel(self, code, capped, passes, workers=1, sizes=KernelSizes(), made=kernel_of, grids=None):  # noqa: B008 - it is frozen
        unbounded = np.full(self.n, np.inf)
        question = KernelQuestion(
            self.tables,
            np.array(self.constants),
            np.array(self.bounds),
            self.root,
            -unbounded,
            unbounded,
            np.ones(self.n),
            ScoreTables(self.steep, self.spreads),
            grids or [np.empty(0)] * self.n,
            TUNING.tolerances.margins,
            sizes,
            self.floors,
        )
        prepared = Prepared(question)
        boxes = Boxes(
            self.cell,
            self.low,
            self.high,
            np.full(self.cutoffs.shape, -np.inf),
            np.ones((self.boxes, self.n + 2), dtype=np.float32),
            np.arange(self.boxes),
        )
        verdicts = Verdicts.empty(self.boxes, len(self.constraints))
        cutoffs, weights = self.cutoffs if capped else None, np.ones((1, len(self.steep)))
        return made(code).contract(prepared, boxes, cutoffs, weights, passes, workers, verdicts), verdicts

    def agree(self, capped, passes, rtol, atol=0.0):
        """Check that both ways agree; return how many boxes are alive."""
        code = self.contractor.code(self.root, capped)
        alive, low, high, goals, opens = self.numpy(code, capped, passes)
        found, verdicts = self.by_kernel(code, capped, passes)
        np.testing.assert_array_equal(verdicts.alive, alive)
        np.testing.assert_array_equal(found.tag, np.flatnonzero(alive))
        np.testing.assert_array_equal(found.cell, self.cell[alive])
        np.testing.assert_array_equal(verdicts.undecided[alive], opens[alive])
        np.testing.assert_allclose(found.low, low[alive], rtol, atol)
        np.testing.assert_allclose(found.high, high[alive], rtol, atol)
        expected = np.where(np.isnan(goals), -np.inf, goals)[alive]
        np.testing.assert_allclose(found.bounds, expected, rtol, atol)
        counted = np.concatenate([opens, np.ones(goals.shape, dtype=bool)], axis=1)[alive].astype(float)
        spreads = [np.einsum("bj,bj->b", counted, s[self.cell[alive, f]]) for f, s in enumerate(self.spreads)]
        scores = np.concatenate([counted @ self.steep * (high[alive] - low[alive]), np.stack(spreads, axis=1)], axis=1)
        np.testing.assert_allclose(found.scores, scores, 1e-5, 1e-6)
        return int(alive.sum())


def limits_at(rng, program, nodes, inputs):
    """Return limits on some nodes that hold at a point with a little to spare, with sides at random."""
    with np.errstate(all="ignore"):
        values = [float(np.asarray(v).ravel()[0]) for v in program.compile(nodes)(inputs)]
    constraints = []
    for node, value in zip(nodes, values, strict=True):
        # With nothing to spare the last bit of a logarithm would decide whether a limit is open.
        spare = 1e-3 * (1 + abs(value)) if np.isfinite(value) else np.inf
        sense = "at_most" if rng.random() < 0.5 or not np.isfinite(value) else "at_least"
        level = value if np.isfinite(value) else 0.0
        constraints.append(
            NodeConstraint(sense, node, None, 1e-9, level + spare if sense == "at_most" else level - spare)
        )
    return constraints


# Of all inputs, and whether objectives are capped, which narrows what they are made of alone.
RANGES = [
    ((-2.0, 2.0), False),
    ((-2.0, 2.0), True),
    pytest.param((0.2, 2.5), True, marks=pytest.mark.slow),
    pytest.param((1.0, 3.0), False, marks=pytest.mark.slow),
]

# -- every rule --------------------------------------------------------------------------------------

SYMBOLIC = {
    ca.OP_CONSTPOW: lambda a, b: ca.SX.binary(ca.OP_CONSTPOW, a, 1.7),
    OP_SELECT: lambda a, b: ca.if_else(a < b, a * b, a - b),
    ca.OP_IF_ELSE_ZERO: lambda a, b: ca.SX.binary(ca.OP_IF_ELSE_ZERO, a < b, a),
    ca.OP_AND: lambda a, b: ca.logic_and(a < b, a < 1) * a,
    ca.OP_OR: lambda a, b: ca.logic_or(a < b, a < 1) * b,
    ca.OP_NOT: lambda a, b: ca.logic_not(a < b) * b,
}
TWO = {
    ca.OP_ADD,
    ca.OP_SUB,
    ca.OP_MUL,
    ca.OP_DIV,
    ca.OP_POW,
    ca.OP_FMIN,
    ca.OP_FMAX,
    ca.OP_HYPOT,
    ca.OP_ATAN2,
    ca.OP_LT,
    ca.OP_LE,
    ca.OP_EQ,
    ca.OP_NE,
}


def use_of(op, a, b):
    if op in SYMBOLIC:
        return SYMBOLIC[op](a, b)
    return ca.SX.binary(op, a, b) if op in TWO else ca.SX.unary(op, a)


POWERS = (-2.0, -1.5, 0.5, 2.0, 3.0, 4.0)
USES = [*((op, None) for op in sorted(FORWARD)), *((ca.OP_CONSTPOW, e) for e in POWERS)]
AT_A_TIME = MOST["N"] // 2


def case_of(uses, range_, boxes):
    """Case with limits on uses of operations, each of two variables of its own."""
    rng, n = np.random.default_rng(3), 2 * len(uses)
    symbols, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    outputs = [
        use_of(op, *symbols[2 * k : 2 * k + 2])
        if e is None
        else ca.SX.binary(op, symbols[2 * k], e) + symbols[2 * k + 1]
        for k, (op, e) in enumerate(uses)
    ]
    goals = [symbols[0] * data[0] + data[1], data[2] / data[3] - symbols[1]]
    program = Program([*symbols, *data], [*outputs, *goals])
    point = rng.uniform(*range_, n + 4)
    limits = limits_at(rng, program, program.outputs[: len(outputs)], list(point))
    case = Case(program, n, limits, [Goal(program.outputs[-2], 1), Goal(program.outputs[-1], -1)], range_, rng, boxes)
    # Boxes around the point stay alive, so that what each rule narrows is compared.
    around = rng.random(case.low.shape) < 0.97
    case.low = np.where(around, np.minimum(case.low, point[:n]), case.low)
    case.high = np.where(around, np.maximum(case.high, point[:n]), case.high)
    return case


@pytest.mark.slow
@pytest.mark.parametrize(("range_", "capped"), RANGES)
@pytest.mark.parametrize("first", range(0, len(USES), AT_A_TIME))
def test_every_rule_agrees(first, range_, capped):
    case = case_of(USES[first : first + AT_A_TIME], range_, 60)
    alive = [case.agree(capped, passes, 1e-12, 1e-14) for passes in (1, 3)]
    assert capped or min(alive) > 0


EXTREME = np.array([0.0, -0.0, 5e-324, -5e-324, 1e-300, -1e-300, 1e-16, -1e-16, 1.0, -1.0, 2.0, -2.0])


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, len(USES), AT_A_TIME))
def test_every_rule_agrees_at_zeros_and_at_the_smallest_numbers(first):
    for seed in (1, 2):
        case, rng = case_of(USES[first : first + AT_A_TIME], (-2.0, 2.0), 60), np.random.default_rng(seed)
        ends, drawn = rng.choice(EXTREME, (2, *case.low.shape)), rng.random(case.low.shape) < 0.5
        low, high = np.where(drawn, ends[0], case.low), np.where(drawn, ends[1], case.high)
        case.low, case.high = np.minimum(low, high), np.maximum(low, high)
        assert min(case.agree(False, passes, 1e-12, 1e-14) for passes in (1, 3)) > 0
        for level in OTHERS:
            same_bits(case, False, 3, level)


# -- processors ----------------------------------------------------------------------------------------

OTHERS = [level for level in LEVELS if level < processor_level()]


def same_bits(case, capped, passes, level):
    """Check that a variant of the kernel returns the bytes of the best one."""
    code = case.contractor.code(case.root, capped)
    best, best_verdicts = case.by_kernel(code, capped, passes)
    made = lambda own: BoxKernel(variant("boxes", level), KernelList(own))  # noqa: E731
    other, verdicts = case.by_kernel(code, capped, passes, made=made)
    for name in ("cell", "low", "high", "bounds", "scores", "tag"):
        assert getattr(best, name).tobytes() == getattr(other, name).tobytes(), name
    assert best_verdicts.alive.tobytes() == verdicts.alive.tobytes()
    assert best_verdicts.undecided.tobytes() == verdicts.undecided.tobytes()


@pytest.mark.parametrize("level", OTHERS)
@pytest.mark.parametrize("first", range(0, len(USES), AT_A_TIME))
def test_every_rule_gives_the_same_bits_on_every_processor(first, level):
    same_bits(case_of(USES[first : first + AT_A_TIME], (-2.0, 2.0), 70), False, 3, level)


@pytest.mark.parametrize("level", OTHERS)
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans())
@settings(deadline=None, derandomize=True, max_examples=repetitions(8, 25))
def test_random_programs_give_the_same_bits_on_every_processor(level, seed, passes, capped):
    same_bits(random_case(seed, SMOOTH), capped, passes, level)


# -- random programs ---------------------------------------------------------------------------------

ARITHMETIC = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (1.5 + b * b),
    lambda a, b: a / b,
    lambda a, b: a * a - b,
    lambda a, b: np.sqrt(1 + a * a) * b,
    lambda a, b: np.sqrt(a) + b,
    lambda a, b: np.maximum(a, b),
    lambda a, b: np.minimum(a, 2 * b),
    lambda a, b: np.abs(a - b),
    lambda a, b: np.where(a < b, a * b, b * b + 0.1),
    lambda a, b: (a < b) * 0.7 + a,
    lambda a, b: np.floor(a) + b,
    lambda a, b: 1 / (2 + np.abs(a)) + b,
    lambda a, b: np.where(np.logical_and(a > 0, b > 0), a, -b),
]
SMOOTH = [
    *ARITHMETIC,
    lambda a, b: np.exp(-np.hypot(a, b)),
    lambda a, b: np.log1p(a * a) + b,
    lambda a, b: np.tanh(a) * b,
    lambda a, b: np.sin(a) + np.cos(b),
    lambda a, b: np.arctan(a) - b,
    lambda a, b: (1 + a * a) ** 0.7 - b,
    lambda a, b: (1 + a * a) ** b,
    lambda a, b: a**3 + b,
    lambda a, b: np.expm1(np.minimum(a, 2)) + b,
    lambda a, b: sum_geometric(2 + a * a, 0.1 + b * b),
    lambda a, b: sum_geometric(a, b),
    lambda a, b: reactive_slip_time(2 + a * a, 1 + b, 3, 1 + b * b, 0.5),
]


def random_case(seed, makers, boxes=60):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 4))
    symbols, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    pool = [*symbols, *data, ca.SX(float(rng.uniform(0.5, 2)))]
    with recorded() as calls:
        for _ in range(int(rng.integers(8, 40))):
            a, b = (pool[k] for k in rng.integers(len(pool), size=2))
            pool.append(makers[rng.integers(len(makers))](a, b))
    program = Program([*symbols, *data], pool[-6:], calls)
    range_ = [(-1.5, 2.0), (0.1, 2.0), (1.0, 4.0)][rng.integers(3)]
    node = program.outputs
    constraints = limits_at(rng, program, node[:2], list(rng.uniform(*range_, n + 4)))
    constraints.append(NodeConstraint(["at_most", "at_least", "equal"][rng.integers(3)], node[2], node[3], 1e-9))
    return Case(program, n, constraints, [Goal(node[4], 1), Goal(node[5], -1)], range_, rng, boxes)


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans())
@settings(deadline=None, derandomize=True, max_examples=repetitions(5, 15))
def test_arithmetic_agrees_to_the_last_bit(seed, passes, capped):
    random_case(seed, ARITHMETIC).agree(capped, passes, rtol=0.0)


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans())
@settings(deadline=None, derandomize=True, max_examples=repetitions(5, 15))
def test_random_programs_agree(seed, passes, capped):
    random_case(seed, SMOOTH).agree(capped, passes, 1e-12, 1e-12)


@given(st.integers(0, 10**6))
@settings(deadline=None, derandomize=True, max_examples=repetitions(10, 100))
def test_boxes_are_snapped_to_any_grid_as_over_arrays(seed):
    case, rng = random_case(4, ARITHMETIC, boxes=83), np.random.default_rng(seed)
    code = case.contractor.code(case.root, False)
    free, _ = case.by_kernel(code, False, 2)
    least, most = case.low_end[0] - 0.5, case.high_end[0]
    even, uneven = np.linspace(least, most, int(rng.integers(2, 300))), rng.uniform(least, most, rng.integers(1, 40))
    kinds = [np.empty(0), even, np.unique(uneven), np.unique([*free.low[:, 0], *free.high[:3, 0]]), even[:1]]
    grids = [kinds[k] for k in rng.integers(len(kinds), size=case.n)]
    snapped, _ = case.by_kernel(code, False, 2, grids=grids)
    alive = MakeableValues(grids, TUNING.tolerances.margins).snap(free.low, free.high)
    for name in ("tag", "low", "high"):
        np.testing.assert_array_equal(getattr(snapped, name), getattr(free, name)[alive], name)


def test_the_result_is_the_same_for_any_number_of_threads():
    small = KernelSizes(part=5)
    case = random_case(11, ARITHMETIC, boxes=83)
    code = case.contractor.code(case.root, False)
    alone, verdicts = case.by_kernel(code, False, 2)
    assert 0 < len(alone) == verdicts.alive.sum() < len(verdicts.alive)
    for workers in (2, 3, 8):
        shared, found = case.by_kernel(code, False, 2, workers, small)
        np.testing.assert_array_equal(found.alive, verdicts.alive)
        np.testing.assert_array_equal(found.undecided, verdicts.undecided)
        for name in ("cell", "low", "high", "bounds", "scores", "tag"):
            np.testing.assert_array_equal(getattr(shared, name), getattr(alone, name))


def test_a_batch_of_any_size_gives_the_bits_of_its_boxes():
    case = random_case(11, ARITHMETIC, boxes=75)
    whole, _ = case.by_kernel(case.contractor.code(case.root, False), False, 2)
    for count in (1, 7, 33):
        few = random_case(11, ARITHMETIC, boxes=75)
        for name in ("cell", "low", "high", "cutoffs"):
            setattr(few, name, getattr(few, name)[:count])
        few.boxes = count
        found, _ = few.by_kernel(few.contractor.code(few.root, False), False, 2)
        first = whole.take(whole.tag < count)
        assert found.low.tobytes() == first.low.tobytes()
        assert found.high.tobytes() == first.high.tobytes()


# -- special functions -------------------------------------------------------------------------------


for _module in pkgutil.walk_packages(problems.__path__, "synth.problems."):
    if _module.name.endswith("formulas") or ".mechanics." in _module.name:
        import_module(_module.name)  # so that their special functions are declared
LARGEST = {"synth.problems.cone.formulas.grip_factor": 1.0}  # of arguments: an angle


@pytest.mark.parametrize("name", sorted(n for n in TABLE if n.startswith("synth.problems.")))
def test_special_functions_agree(name):
    module, _, own = name.rpartition(".")
    call, function, count = getattr(import_module(module), own), TABLE[name], 2000
    n, rng, most = len(function.elasticity), np.random.default_rng(1), LARGEST.get(name, 1e3)
    symbols, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    with recorded() as calls:
        program = Program([*symbols, *data], [call(*symbols)], calls)
    case = Case(program, n, [], [Goal(program.outputs[0], 1)], (1e-4, most), rng, count)
    case.low = case.high = np.exp(rng.uniform(np.log(1e-4), np.log(most), (count, n)))
    found, _ = case.by_kernel(case.contractor.code(case.root, False), False, 1)
    with np.errstate(all="ignore"):
        expected = function.formula(*case.low.T)
    assert np.isfinite(expected).sum() > count / 4
    known = np.isfinite(expected[found.tag])
    np.testing.assert_allclose(found.bounds[known, 0], expected[found.tag][known], 1e-14)


# -- the multi-plate family --------------------------------------------------------------------------

REQUIREMENTS = {"load_torque": "600 N*m", "driver_speed": "26.6 rad/s", "driven_inertia": "30 kg*m2"}
OPTIONS = {
    "default": {},
    "exact_active": {"guide_series": "exact", "load_kind": "active"},
    "lipka": {"friction_basis": "worst_case", "guide_series": "lipka"},
    "dry": {"lubrication": "dry"},
}
OBJECTIVES = {"mass": "min", "actuation_force": "min", "friction_work": "min"}


def formulation(options, grid=False):
    problem = MultiPlateClutch(**options)
    return Formulation(instance_of(problem, REQUIREMENTS, as_catalogs(None), grid=grid), OBJECTIVES, 2)


def batches(form, rounds=12):
    """Contract and split from the root on, with caps that differ from box to box; yield every batch."""
    rng = np.random.default_rng(2)
    boxes = form.boxes.root()
    least = form.objectives.phi_of(boxes.bounds)[0]
    for _ in range(rounds):
        caps = least + rng.uniform(5.0, 12.0, boxes.bounds.shape)
        yield boxes, caps
        boxes, _ = form.boxes.split(form.boxes.contract(boxes, caps))


def compare(form, boxes, caps, passes, every, monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    expected = form.boxes.contract(boxes, caps, passes, every)
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "1")
    found = form.boxes.contract(boxes, caps, passes, every)
    np.testing.assert_array_equal(found.cell, expected.cell)
    np.testing.assert_array_equal(found.tag, expected.tag)
    for name in ("low", "high", "bounds"):
        np.testing.assert_allclose(getattr(found, name), getattr(expected, name), 1e-12)
    np.testing.assert_allclose(found.scores, expected.scores, 1e-5, 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("grid", [False, True])
@pytest.mark.parametrize(
    "options",
    [pytest.param(given, marks=[pytest.mark.slow] if given else [], id=name) for name, given in OPTIONS.items()],
)
def test_the_family_agrees(options, grid, monkeypatch):
    form = formulation(options, grid)
    for boxes, caps in batches(form):
        compare(form, boxes, caps, 2, False, monkeypatch)
    compare(form, boxes, np.median(caps, axis=0), 1, True, monkeypatch)
    compare(form, boxes, None, 3, True, monkeypatch)
    assert len(boxes) > 30
    assert box_kernel(form.bounding.propagation.code(False, True)) is not None


# -- where there is no room, or no kernel ------------------------------------------------------------


def test_formulas_of_special_functions_have_an_instruction_for_every_operation():
    """Nothing that can be traced is missing: those of two instructions are told apart in the emitter."""
    rest = {ca.OP_SQ, ca.OP_TWICE, ca.OP_INV, ca.OP_NOT, ca.OP_AND, ca.OP_OR, ca.OP_IF_ELSE_ZERO, OP_SELECT}
    assert set(ELEMENTARY) | set(COMPARED) | rest == set(OPERATIONS)


def of_variables(n, outputs):
    """Case of so many variables, with a limit on the first of two outputs."""
    x, data = [ca.SX.sym(f"x{k}") for k in range(n)], [ca.SX.sym(f"c{k}") for k in range(4)]
    program = Program([*x, *data], outputs(x, data))
    limits = [NodeConstraint("at_most", program.outputs[0], None, 1e-9, 1e3)]
    return Case(program, n, limits, [Goal(program.outputs[1], 1)], (0.5, 2.0), np.random.default_rng(1), 4)


def test_what_is_too_large_is_left_to_numpy():
    for n in (MOST["N"], MOST["N"] + 1):
        case = of_variables(n, lambda x, data: [ca.sum1(ca.vertcat(*x)), x[0] * data[0]])
        assert (box_kernel(case.contractor.code(case.root, False)) is not None) == (n == MOST["N"])


def test_it_can_be_switched_off(monkeypatch):
    monkeypatch.setenv("CLUTCHSYNTH_NATIVE", "0")
    form = formulation({})
    assert len(form.boxes.root()) == 1
    assert box_kernel(form.bounding.propagation.code(False, True)) is None


def test_requirements_do_not_enter_the_instructions():
    problem = MultiPlateClutch()
    own = [
        Formulation(
            instance_of(problem, {**REQUIREMENTS, "load_torque": torque}, as_catalogs(None)), OBJECTIVES, 2
        ).bounding.propagation.code(False, True)
        for torque in ("600 N*m", "612.345 N*m")
    ]
    assert own[0] is own[1]
