"""The proof tree of verify: it never loses a feasible design, finds what refutes a claim, and closes what is true."""

import math

import numpy as np
import pandas as pd
import pytest

import synth
from synth.proof.clusters import Clusters
from synth.proof.questions import Point
from synth.proof.settings import PROOF, ProofLimits
from synth.proof.tree import ProofTree
from synth.question.catalogs import as_catalogs
from synth.tables.catalogs import Catalogs
from tests.asking import instance_of
from tests.conformance.cases import CASES, known_design
from tests.proof.random_formulas import BINARY, UNARY
from tests.repetitions import repetitions

RNG = np.random.default_rng(0)
THINGS = pd.DataFrame(
    {
        "designation": [f"thing {k}" for k in range(9)],
        "u [-]": RNG.uniform(0.5, 3, 9),
        "v [-]": RNG.uniform(-1, 2, 9),
        "w [-]": [*RNG.uniform(1, 4, 6), None, None, None],
    }
)
THINGS_CATALOG = Catalogs({"things": THINGS})


class Anything(synth.DesignProblem):
    """A random problem with variables, a grid, a count, a choice, a slot and limits that may be void or guards."""

    name = "anything"

    def __init__(self, seed):
        self.seed = seed
        super().__init__()

    def declare(self, d):
        rng = np.random.default_rng(self.seed)
        first = d.variable("first", "-", float(rng.uniform(0.2, 1)), float(rng.uniform(1.5, 5)))
        second = d.variable("second", "-", -2, float(rng.uniform(-1, 3)))
        third = d.variable("third", "-", 1, 4, grid=[1, 1.5, 2, 3, 4])
        number = d.count("number", 1, 6)
        kind = d.choice("kind", ("a", "b", "c"))
        part = d.part("part", "things")
        side = part.optional("w")
        chosen = kind.select({"a": 1.0, "b": first, "c": 2.5})
        pool = [first, second, third, number, chosen, part.u, part.v]
        given = len(pool)
        for _ in range(14):
            i, j = rng.integers(0, len(pool), 2)
            if rng.random() < 0.45:
                pool.append(UNARY[rng.integers(len(UNARY))](pool[i]))
            else:
                pool.append(BINARY[rng.integers(len(BINARY))](pool[i], pool[j]))
        made = pool[given:]
        for k in range(2):
            d.derive(f"objective_{k}", "-", made[-1 - k])
            d.objective(f"objective_{k}", ("min", "max")[int(rng.integers(0, 2))])
        for k in range(3):
            value, other = (made[int(rng.integers(len(made)))] for _ in range(2))
            bound, rule = float(rng.uniform(-1, 6)), int(rng.integers(0, 3))
            if rule == 0:
                d.at_most(f"limit_{k}", value, bound + 0 * first, "-")
            elif rule == 1:
                d.at_least(f"limit_{k}", value, -bound + 0.1 * other, "-", guard=bool(rng.random() < 0.3))
            else:
                d.at_most(f"limit_{k}", value, 2 * side + 3, "-")


def holding(tree, boxes, point):
    """Return which boxes hold a design."""
    inputs = [*point.variables, *point.data]
    count, ladders = len(tree._variables), len(tree._ladders)
    found = np.ones(len(boxes), dtype=bool)
    for x, given in zip(inputs, tree._inputs, strict=True):
        if not isinstance(given, int):
            continue
        c = tree._coordinates[given]
        if c.kind == "variable":
            room = 1e-12 * abs(x)
            found &= (boxes.real[c.group] <= x + room) & (boxes.real[count + c.group] >= x - room)
        elif c.kind == "ladder":
            values = tree._ladders[c.group]
            found &= values[boxes.discrete[c.group]] <= x + 1e-9 * abs(x)
            found &= values[boxes.discrete[ladders + c.group]] >= x - 1e-9 * abs(x)
        else:
            slot, node = tree._slots[c.group], boxes.discrete[2 * ladders + c.group]
            low, high = slot.low[c.column, node], slot.high[c.column, node]
            found &= slot.lacking[c.column, node] if math.isnan(x) else (low <= x) & (high >= x)
    for node, k in tree._lifted.items():
        x, group = float(tree.program.compile([node])(inputs)[0]), tree._coordinates[k].group
        found &= (boxes.real[group] <= x * (1 + 1e-9)) & (boxes.real[count + group] >= x * (1 - 1e-9))
    return found


ONE_SPLIT = ProofLimits(few=1, few_guided=1)  # each box is split once at a time, however few there are


def is_kept(tree, point, signed, rounds):
    """Tell whether a feasible design stays in some box, round by round, where it lies just inside of the region."""
    ends = (signed + 1e-6 * np.maximum(np.abs(signed), 1e-3))[None]
    with np.errstate(all="ignore"):
        levels = np.where(tree.positive, np.log(ends), ends)
        regions = Clusters(levels, np.zeros(len(signed), dtype=bool), np.ones(len(signed)))
        boxes = tree._begin(regions)
        emphasis = np.ones((tree._emphasised, len(regions.first))) if tree.guided and not tree.empty else None
        for _ in range(rounds):
            boxes = boxes.take(holding(tree, boxes, point))
            boxes, scores, _ = tree._tightened(boxes, regions, emphasis)
            kept = holding(tree, boxes, point)
            if not kept.any():
                return False
            boxes, scores = boxes.take(kept), scores[:, kept]
            widths = tree._widths(boxes, regions)
            if not np.any(widths > 0):
                break
            halves = tree._split(boxes, scores, widths, regions)
            assert len(halves) <= 2 * len(boxes)
            boxes = halves
    return True


def sample(instance, variables, combinations):
    """Return data, objectives and which designs are feasible."""
    data = instance.data(combinations)
    result = instance.evaluate(variables, data)
    feasible = result.feasible
    wide = [np.broadcast_to(np.asarray(x, dtype=float), len(variables)) for x in data]
    return wide, result.values, feasible


@pytest.mark.slow
@pytest.mark.parametrize("guided", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_no_feasible_design_of_a_random_problem_is_lost(seed, guided):
    problem = Anything(seed)
    instance = instance_of(problem, {}, THINGS_CATALOG)
    senses = {o.name: o.sense for o in instance.model.declaration.objectives.values()}
    rng = np.random.default_rng(seed)
    x = instance.ranges.lower + (instance.ranges.upper - instance.ranges.lower) * rng.random((3000, 3))
    x[:, 2] = rng.choice(instance.ranges.grids()[2], len(x))
    data, values, feasible = sample(instance, x, rng.integers(0, instance.combinations.count, len(x)))
    signs = np.array([1.0 if s == "min" else -1.0 for s in senses.values()])
    signed = np.stack([values[name] for name in senses], axis=1) * signs
    good = np.flatnonzero(feasible & np.isfinite(signed).all(axis=1))
    tree = ProofTree(instance, senses, ONE_SPLIT, guided)
    assert not (tree.empty and len(good))
    for k in good[np.argsort(signed[good].sum(axis=1))][:8]:
        point = Point(x[k], [float(column[k]) for column in data], {})
        assert is_kept(tree, point, signed[k], 9), k


@pytest.mark.slow
@pytest.mark.parametrize("guided", [True, False][: repetitions(1, 2)])
@pytest.mark.parametrize("family", CASES)
def test_no_feasible_design_of_a_family_is_lost(family, guided):
    case = CASES[family]
    instance = instance_of(
        synth.load(family, **case.option_sets["default"]), {**case.requirements}, as_catalogs(None), grid=False
    )
    rng = np.random.default_rng(1)
    known = known_design(family, "default", optional=False)
    if known is None:
        x = case.sound(rng, instance, 20000)
        data, values, feasible = sample(instance, x, rng.integers(0, instance.combinations.count, len(x)))
    else:  # around a design whose parts fit each other
        x = np.clip(
            known[0][:1] * np.exp(rng.normal(0, 0.02, (4000, instance.ranges.lower.size))),
            instance.ranges.lower,
            instance.ranges.upper,
        )
        data = [np.full(len(x), column[0]) for column in known[1]]
        result = instance.model.evaluate(x, data)
        values, feasible = result.values, result.feasible
    senses = {o.name: o.sense for o in instance.model.declaration.objectives.values() if o.default}
    if guided and family == "multi_plate_clutch":
        senses = {"mass": "min", "friction_work": "min"}  # of which one sees the torque alone
    tree = ProofTree(instance, senses, ONE_SPLIT, guided)
    assert not tree._lifted if not guided else tree._lifted or family != "multi_plate_clutch"
    signs = np.array([1.0 if s == "min" else -1.0 for s in senses.values()])
    signed = np.stack([values[name] for name in senses], axis=1) * signs
    good = np.flatnonzero(feasible)
    assert len(good) > 20
    count = repetitions(1, 3)
    for k in [*good[np.argsort(signed[good, 0])][:count], *good[np.argsort(signed[good, 1])][:count]]:
        point = Point(x[k], [float(column[k]) for column in data], {})
        assert is_kept(tree, point, signed[k], 25), k


BORDERS = {
    "root": lambda x, y: 10 / np.sqrt(x - y),
    "logarithm": lambda x, y: 10 / np.log(x - y),
    "sine": lambda x, y: 5 * np.arcsin((x - y) / 2),
    "falling root": lambda x, y: 6 - np.sqrt(x - y),
}


@pytest.mark.parametrize("border", BORDERS)
def test_no_design_is_lost_where_a_function_ends_within_a_box(border):
    class Border(synth.DesignProblem):
        name = "border"

        def declare(self, d):
            x, y = d.variable("x", "-", 1, 10), d.variable("y", "-", 1, 10)
            d.at_least("border", BORDERS[border](x, y), 4, "-")
            d.derive("total", "-", x + y)
            d.objective("total")

    instance, tree = tree_of(Border(), {"total": "min"}, proof=ONE_SPLIT)
    x = 1 + 9 * np.random.default_rng(0).random((3000, 2))
    data, values, feasible = sample(instance, x, np.zeros(len(x), dtype=int))
    signed = values["total"][:, None]
    good = np.flatnonzero(feasible)
    assert len(good) > 20
    for k in good[np.argsort(signed[good, 0])][:12]:
        assert is_kept(tree, Point(x[k], [float(column[k]) for column in data], {}), signed[k], 9), k


# -- what is proven and refuted ----------------------------------------------------------------------


class Box(synth.DesignProblem):
    """Least of x + y with x y at least the requirement: 2 sqrt(r)."""

    name = "box"

    def declare(self, d):
        least = d.requirement("least", "-", 2.0, lower=0)
        x = d.variable("x", "-", 0.1, 10)
        y = d.variable("y", "-", 0.1, 10)
        d.at_least("area", x * y, least, "-")
        d.derive("total", "-", x + y)
        d.derive("difference", "-", x - y)
        d.objective("total")
        d.objective("difference", default=False)


def tree_of(problem, objectives, requirements=None, catalogs=None, proof=PROOF, **more):
    instance = instance_of(problem, requirements or {}, as_catalogs(catalogs), **more)
    return instance, ProofTree(instance, objectives, proof)


def confirmed(instance, names, ends, found):
    """Return what confirms designs that lie below some ends, and keeps them."""

    def confirm(point):
        result = instance.model.evaluate(point.variables[None], point.data)
        values = np.array([float(result.values[n][0]) for n in names])
        if bool(result.feasible[0]) and np.any(np.all(values < ends, axis=1)):
            found.append(values)
            return True
        return False

    return confirm


def test_what_is_true_is_proven_and_what_is_not_is_refuted():
    instance, tree = tree_of(Box(), {"total": "min"})
    best = 2 * math.sqrt(2)
    # A limit may be missed by a millionth, which is worth half as much here.
    assert tree.prove(np.array([[best * (1 - 1e-5)]]), lambda point: False).closed
    found = []
    ends = np.array([[best * (1 + 1e-3)]])
    outcome = tree.prove(ends, confirmed(instance, ["total"], ends, found))
    assert not outcome.closed
    assert outcome.witness is not None
    assert best * (1 - 1e-6) <= found[-1][0] < ends[0, 0]


def test_a_proof_that_is_given_up_is_not_closed():
    _, tree = tree_of(Box(), {"total": "min"})
    ends = np.array([[2 * math.sqrt(2) * (1 - 1e-5)]])
    assert not tree.prove(ends, lambda point: False, deadline=0.0).closed
    _, tree = tree_of(Box(), {"total": "min"}, proof=ProofLimits(most_nodes=0))
    assert not tree.prove(ends, lambda point: False).closed


def test_only_objectives_that_are_surely_positive_count_by_logarithm():
    _, tree = tree_of(Box(), {"total": "min", "difference": "min"})
    assert tree.positive == [True, False]


def test_objectives_that_are_to_be_large():
    _, tree = tree_of(Box(), {"difference": "max"}, limits={"total": "<= 5"})
    # x + y = 5 and x y = 2
    best = math.sqrt(17)
    assert tree.prove(np.array([[-best * (1 + 1e-4)]]), lambda point: False).closed
    ends = np.array([[-best * (1 - 1e-3)]])
    assert not tree.prove(ends, lambda point: True).closed


def test_infeasible_questions_have_empty_trees_or_close():
    _, tree = tree_of(Box(), {"total": "min"}, {"least": 101})
    assert tree.prove(np.full((1, 1), math.inf), lambda point: False).closed
    _, tree = tree_of(Box(), {"total": "min"}, {"least": 30}, limits={"total": "<= 10.9"})
    assert tree.prove(np.full((1, 1), math.inf), lambda point: False).closed
    instance, tree = tree_of(Box(), {"total": "min"}, {"least": 30}, limits={"total": "<= 11"})
    outcome = tree.prove(np.full((1, 1), math.inf), confirmed(instance, ["total"], np.full((1, 1), math.inf), []))
    assert outcome.witness is not None


class Pairs(synth.DesignProblem):
    """Two rows of one table that do not go together with any other."""

    name = "pairs"

    def declare(self, d):
        one, two = d.part("one", "things"), d.part("two", "things")
        d.refuse("unlike", one.u < two.u - 0.4, "a second part that is not larger by 0.4")
        d.derive("gain", "-", two.u - one.u)
        d.objective("gain", "max")


def test_refusals_over_two_slots_are_kept():
    instance, tree = tree_of(Pairs(), {"gain": "max"}, catalogs={"things": THINGS})
    assert len(instance.selection.joint_refusals) == 1
    u = THINGS["u [-]"].to_numpy()
    gains = np.subtract.outer(u, u)
    best = gains[gains <= 0.4].max()
    assert tree.prove(np.array([[-best - 1e-9]]), lambda point: False).closed
    outcome = tree.prove(np.array([[-best + 1e-9]]), lambda point: True)
    one, two = outcome.witness.data[:2]
    assert two - one == pytest.approx(best)


@pytest.mark.parametrize("side", [-1, 1])
def test_what_lies_next_to_a_pole_at_zero_is_not_lost(side):
    class Pole(synth.DesignProblem):
        name = "pole"

        def declare(self, d):
            x = d.variable("x", "-", min(2 * side, 0), max(2 * side, 0))
            d.at_least("steep", side / x, 3, "-")
            d.derive("distance", "-", (x - side * 5e-4) ** 2 + 1)
            d.objective("distance")

    _, tree = tree_of(Pole(), {"distance": "min"})
    outcome = tree.prove(np.array([[1 + 1e-8]]), lambda point: True)
    assert outcome.witness is not None
    assert outcome.witness.variables[0] == pytest.approx(side * 5e-4, rel=0.2)
    assert tree.prove(np.array([[1 - 1e-6]]), lambda point: False).closed


class Beyond(synth.DesignProblem):
    """Makeable values of both signs, and formulas that do not exist where a guard fails."""

    name = "beyond"
    FORMULAS = (np.sqrt, np.log, lambda g: 1 / g, lambda g: 1 / np.sqrt(g), lambda g: g * np.log(g))

    def __init__(self, seed):
        self.seed = seed
        super().__init__()

    def declare(self, d):
        rng = np.random.default_rng(self.seed)
        grid = np.round(np.arange(-8, 9) * 0.25, 3)  # so that a guard is often exactly at its border
        x = d.variable("x", "-", grid[0], grid[-1], grid=grid.tolist())
        y = d.variable("y", "-", grid[0], grid[12], grid=grid[:13].tolist())
        n, part = d.count("n", 1, 3), d.part("part", "things")
        a, b, c = (rng.integers(-4, 5, 3) / 2).tolist()
        left = (a * x + b * y * n + c, x * y + c, a * x + b * y - n)[self.seed % 3]
        left = x - c if left.is_constant() else left
        d.at_least("left", left, 0, "-", guard=True)
        behind = self.FORMULAS[self.seed % 5](left)
        d.derive("behind", "-", behind, needs=("left",))
        d.at_most("behind", behind, 1.5 + 0 * x, "-")
        d.at_most("both", b * x + part.u - n, 1 + y, "-")
        d.derive("cost", "-", a * y * n + x * x + (behind if self.seed % 2 else 0), needs=("left",))
        d.objective("cost")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_single_designs_are_settled_by_their_evaluation_also_where_formulas_do_not_exist(seed):
    instance, tree = tree_of(Beyond(seed), {"cost": "min"}, catalogs={"things": THINGS})
    makeable = np.stack([m.ravel() for m in np.meshgrid(*instance.ranges.grids(), indexing="ij")], axis=1)
    x = np.tile(makeable, (instance.combinations.count, 1))
    _, values, feasible = sample(instance, x, np.repeat(np.arange(instance.combinations.count), len(makeable)))
    cost = np.where(feasible, values["cost"], np.inf)
    best = np.min(cost)
    room = 1e-9 * max(abs(best), 1.0)
    ends = np.array([[best - room if np.isfinite(best) else math.inf]])
    assert tree.prove(ends, confirmed(instance, ["cost"], ends, [])).closed
    ends += 2 * room
    assert (tree.prove(ends, confirmed(instance, ["cost"], ends, [])).witness is not None) == np.isfinite(best)


# -- clusters ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(20))
def test_clusters_are_narrowed_to_what_holds_all_rows_inside(seed):
    rng = np.random.default_rng(seed)
    values = np.round(rng.uniform(0.1, 3, (17, 3)), 1)
    values[rng.random(values.shape) < 0.1] = np.nan
    values[0] = values[1]  # rows that are the same need no node of their own
    clusters = Clusters(values, np.array([True, False, True]), np.ones(3))
    leaves = clusters.left < 0
    distinct = {tuple(row) for row in np.nan_to_num(values)}
    assert {tuple(row) for row in np.nan_to_num(values[clusters.first[leaves]])} == distinct
    assert leaves.sum() == len(distinct) < 17
    assert np.all(clusters.spread[leaves] == 0)
    assert np.all(clusters.spread[~leaves] > 0)
    low = rng.uniform(0, 3, (3, 60))
    high = low + rng.uniform(0, 2, low.shape)
    nodes = clusters.narrowed(np.zeros(60, dtype=np.int64), low, high)
    assert len(set(nodes.tolist())) > 1
    for k, node in enumerate(nodes):
        fits = np.isnan(values) | ((values >= low[:, k]) & (values <= high[:, k]))
        for row in values[fits.all(axis=1)]:
            assert node >= 0
            here = (row >= clusters.low[:, node]) & (row <= clusters.high[:, node])
            assert np.all(here | (np.isnan(row) & clusters.lacking[:, node]))


def test_a_cluster_of_ends_may_be_open():
    ends = np.array([[math.inf, 1.0], [1.0, math.inf], [2.0, 2.0]])
    clusters = Clusters(ends, np.zeros(2, dtype=bool), np.ones(2))
    assert sorted(clusters.first[clusters.left < 0].tolist()) == [0, 1, 2]
    assert np.isfinite(clusters.spread).all()
