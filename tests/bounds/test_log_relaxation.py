"""All limits taken together lose no design: random problems of every structure, and formulas whose optimum is known."""

from dataclasses import replace

import numpy as np
import pytest

import synth
from synth.bounds.log_relaxation import LogRelaxation, _bound
from synth.bounds.relaxed_branching import relaxed_scores
from synth.search.branch_and_bound import best, cover_of_one
from synth.search.budget import Clock
from synth.search.relaxed_boxes import RelaxedBoxes
from synth.search.settings import TUNING
from tests.asking import pose
from tests.certificates.kinks import KINKS
from tests.certificates.signs import SIGNS
from tests.certificates.structures import STRUCTURES, RandomProblem, make
from tests.repetitions import repetitions

SETTINGS = TUNING.tree.together
TIE = TUNING.tolerances.tie
KINDS = list(dict.fromkeys([*STRUCTURES, *SIGNS, *KINKS]))
POINTS = 4000


def formulation(structure, seed):
    """Return a random question ready to be searched; None where it cannot be posed."""
    try:
        case = make(structure, seed)
    except ValueError:
        return None  # a formula does not exist at the design that limits are drawn for
    problem = RandomProblem(structure=structure, seed=str(seed))
    return pose(problem, case.requirements, **case.question()).search().state.form


def feasible(form, rng):
    """Return feasible designs: their variables, combinations and phi."""
    combinations = rng.integers(form.instance.combinations.count, size=POINTS)
    share = rng.random((POINTS, form.n)) ** rng.choice([0.3, 1.0, 3.0], (POINTS, 1))
    variables = form.lower + share * (form.upper - form.lower)
    variables = form.makeable.nearest(variables) if form.gridded.any() else variables
    # Near to one that is feasible others are.
    for _ in range(3):
        rows, phi = form.points.feasible_rows(variables, combinations)
        if len(rows):
            chosen = rows[rng.integers(len(rows), size=POINTS // 2)]
            step = rng.normal(size=(POINTS // 2, form.n)) * 10.0 ** rng.uniform(-6, -1, (POINTS // 2, 1))
            moved = np.clip(variables[chosen] + step * (form.upper - form.lower), form.lower, form.upper)
            moved = form.makeable.nearest(moved) if form.gridded.any() else moved
            variables = np.concatenate([variables[: POINTS // 2], moved])
            combinations = np.concatenate([combinations[: POINTS // 2], combinations[chosen]])
    rows, phi = form.points.feasible_rows(variables, combinations)
    rows = rows[np.isfinite(phi[rows]).all(axis=1)]
    return variables[rows], combinations[rows], phi[rows]


def boxes_around(form, variables, combinations, rng):
    """Return a box around each design, from a point to everything: random ends, and clusters above its parts."""
    count = len(variables)
    boxes = form.boxes.leaves(combinations)
    reach = 10.0 ** rng.uniform(-7, 0.3, (count, 1)) * (form.upper - form.lower)
    low, high = boxes.low.copy(), boxes.high.copy()
    low[:, : form.n] = np.maximum(form.lower, variables - rng.random((count, form.n)) * reach)
    high[:, : form.n] = np.minimum(form.upper, variables + rng.random((count, form.n)) * reach)
    cell = boxes.cell.copy()
    for f, tree in enumerate(form.boxes.cells.trees):
        above = np.zeros(len(tree.left), dtype=int)
        for k in np.flatnonzero(~tree.leaf):
            above[tree.left[k]] = above[tree.right[k]] = k
        for _ in range(4):
            cell[:, f] = np.where(rng.random(count) < 0.4, above[cell[:, f]], cell[:, f])
    return form.boxes.lean(replace(boxes, cell=cell, low=low, high=high))


def lost(form, seed, boxes=24):
    """Return what is wrong about boxes around feasible designs, and how many were looked into."""
    rng = np.random.default_rng(seed)
    variables, combinations, phi = feasible(form, rng)
    if not len(variables):
        return [], 0
    chosen = rng.integers(len(variables), size=boxes)
    variables, combinations, phi = variables[chosen], combinations[chosen], phi[chosen]
    around = boxes_around(form, variables, combinations, rng)
    phi = phi[:, : form.bounded]
    # Cutoffs that the design just keeps, that it keeps with room, and none.
    room = rng.choice([TIE, 1e-3, 0.1, np.inf], phi.shape)
    target = int(rng.integers(form.bounded))
    values = form.objectives.values_of(phi + room)
    found = LogRelaxation(form.bounding.propagation, SETTINGS).run(around, values, target)
    bounds, low, high = form.objectives.phi_of(found.boxes.bounds), found.boxes.low, found.boxes.high
    near = 1e-9 * np.maximum(np.abs(variables), 1e-12)
    inside = (variables >= low[:, : form.n] - near) & (variables <= high[:, : form.n] + near)
    wrong = [f"{seed}: box {k} is dropped" for k in np.flatnonzero(~found.alive)]
    wrong += [f"{seed}: box {k} is cut" for k in np.flatnonzero(~inside.all(axis=1))]
    wrong += [f"{seed}: bound of box {k}" for k in np.flatnonzero(np.any(bounds > phi + TIE, axis=1))]
    assert np.all(low >= around.low)
    assert np.all(high <= np.maximum(around.high, low))
    assert np.all(found.boxes.bounds >= around.bounds)
    return wrong, boxes


@pytest.mark.slow
@pytest.mark.parametrize("structure", KINDS)
def test_no_design_is_lost(structure):
    forms = {seed: formulation(structure, seed) for seed in range(repetitions(1, 2))}
    results = [lost(form, seed) for seed, form in forms.items() if form is not None]
    assert [sentence for wrong, _ in results for sentence in wrong] == []


@pytest.mark.slow
def test_designs_are_looked_for_in_most_structures():
    tried = [lost(form, 0, boxes=2)[1] for form in (formulation(s, 0) for s in KINDS) if form is not None]
    assert sum(n > 0 for n in tried) > 0.6 * len(tried)


def test_any_multipliers_bound_a_linear_program():
    rng = np.random.default_rng(0)
    for _ in range(200):
        rows, columns = rng.integers(1, 6, 2)
        left, width = rng.normal(size=(rows, columns)), rng.uniform(0, 3, columns)
        inside = rng.uniform(0, 1, (50, columns)) * width
        right = (inside @ left.T).max(axis=0)  # all of these points keep the rows
        cost, multipliers = rng.normal(size=columns), -rng.exponential(size=rows) * (rng.random(rows) < 0.7)
        bound, residual = _bound(cost, left, right, width, multipliers)
        values = inside @ cost
        assert bound <= values.min()
        # What is left of a worst value limits each column, on the side that the bound took.
        room = values.max() - bound
        used = np.where(residual > 0, inside, width - inside) * np.abs(residual)
        assert np.all(used <= room + 1e-9)


class Posynomial(synth.DesignProblem):
    """Least a x + b/x + c/(x y) + d y over two sizes, with a limit of both: convex in logarithms."""

    name, title, sources = "posynomial", "Posynomial", ("any textbook",)

    def declare(self, d):
        x = d.variable("x", "-", 0.01, 100)
        y = d.variable("y", "-", 0.01, 100)
        d.derive("cost", "-", 3 * x + 2 / x + 5 / (x * y) + 4 * y)
        d.at_least("area", x * y, 2.0, "-")
        d.objective("cost", "min")


class Apart(synth.DesignProblem):
    """Two limits that each can hold anywhere, and never together: x/y - z >= 0.1 and y z >= x."""

    name, title, sources = "apart", "Apart", ("any textbook",)

    def declare(self, d):
        x, y, z = (d.variable(name, "-", 1, 10) for name in "xyz")
        d.at_least("above", x / y, z + 0.1, "-")
        d.at_least("below", y * z, x, "-")
        d.objective("x", "min")


def relaxed_tree(problem, gap, boxes):
    """Return the best value of a problem's first objective by a tree with all limits together, and its outcome."""
    state = pose(problem, {}, gap=gap).search().state
    state.set_pool()
    form = state.form
    rule = cover_of_one(form, 0, float(form.objectives.tolerance(gap)[0]), np.full(len(form.goals), np.inf))
    found, outcome = best(form, state.pool, rule, Clock(), state.rng, node_limit=boxes, together=RelaxedBoxes(form, 0))
    return (None if found is None else float(np.exp(found.phi[0]))), outcome


def test_a_fine_gap_closes_with_few_boxes():
    value, outcome = relaxed_tree(Posynomial, 1e-6, 1000)
    x, area = np.meshgrid(np.geomspace(0.3, 4, 4001), np.linspace(2.0, 4.0, 101))
    cost = 3 * x + 2 / x + 5 / area + 4 * area / x
    assert outcome.closed
    assert outcome.looked < 400
    assert cost.min() * (1 - 1e-6) <= value <= cost.min() * (1 + 1e-6)


def test_limits_that_contradict_each_other_only_together_are_told_in_one_box():
    value, outcome = relaxed_tree(Apart, 1e-3, 100)
    assert value is None
    assert outcome.closed
    assert outcome.looked <= 3


def test_scores_say_where_linear_bounds_are_off():
    state = pose(Posynomial, {}).search().state
    form = state.form
    boxes = form.boxes.lean(form.boxes.root())
    relaxation = LogRelaxation(form.bounding.propagation, SETTINGS)
    found = relaxation.run(boxes, np.full((1, form.bounded), np.inf), 0)
    scores = relaxed_scores(relaxation.nodes, found.points[0], boxes.low.shape[1], 0)
    assert scores.shape == (1, 2)
    assert np.all(scores > 0)
    thin = replace(boxes, low=np.array([[1.0, 1.0]]), high=np.array([[1.0 + 1e-12, 50.0]]))
    found = relaxation.run(thin, np.full((1, form.bounded), np.inf), 0)
    narrow = relaxed_scores(relaxation.nodes, found.points[0], boxes.low.shape[1], 0)
    assert narrow[0, 0] < 1e-6 * narrow[0, 1]
