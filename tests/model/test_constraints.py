"""All that read a limit agree: same amount, same verdict, on random points of random problems and of every family."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

import synth
from synth.declaration import Origin
from synth.model.constraint import SYMBOLS, Constraint, NodeConstraint, void_limits
from synth.nlp.batch import BatchNlp, ProblemInputs, Tasks
from synth.nlp.rows import GUARD_MARGIN
from synth.order.feasibility import SMALLEST, holds, size_of_miss
from synth.proof.questions import Point
from synth.proof.tree import void_without
from synth.question.catalogs import as_catalogs, catalogs_for
from synth.question.instance import Instance
from synth.question.objectives import chosen_objectives
from synth.question.uncertainty import read_block
from synth.robust.counterpart import robust_counterpart
from synth.search.formulation import Formulation
from synth.search.refused_cells import not_refused
from synth.studies.infeasibility.relaxation import AMOUNT, Relaxed
from synth.units import typed_quantity
from synth.verification.verify import VerificationRun
from tests.asking import instance_of, rater_of
from tests.certificates.structures import STRUCTURES, RandomProblem, make
from tests.conformance.cases import CASES

POINTS = 60
CHECKED = 6  # points that the slow readers look at
RANDOM = [(structure, 0) for structure in STRUCTURES if structure != "hard"]
RANDOM += [(structure, 3) for structure in ("asked", "guards", "knife_edge", "mixed", "optional")]


@dataclass(frozen=True)
class Asked:
    """One question with limits of the user's own, and points of it."""

    problem: synth.DesignProblem
    requirements: dict
    catalogs: object
    limits: dict
    instance: Instance
    chosen: dict
    variables: np.ndarray
    combinations: np.ndarray

    @property
    def data(self):
        return self.instance.data(self.combinations)

    @property
    def result(self):
        return self.instance.evaluate(self.variables, self.data)

    def designs(self):
        """Return some points as ``evaluate`` reads them, with their rows; each needs a value that a user can type."""
        model = self.instance.model
        for k in range(CHECKED):
            parts, counts, choices = self.instance.combinations.describe(int(self.combinations[k]))
            sizes = {v.name: float(x) for v, x in zip(model.variables, self.variables[k], strict=True)}
            typed = {name: typed_quantity(x, model.units[name], None) for name, x in sizes.items()}
            design = synth.evaluate(
                self.problem,
                self.requirements,
                values={**typed, **counts, **choices},
                parts={slot: table.designations[row] for slot, (table, row) in parts.items()},
                catalogs=self.catalogs,
                limits=self.limits,
            )
            yield k, design


def own_limits(instance, variables, combinations, rng):
    """Return limits on derived quantities near the middle of what the points have, and one on a variable."""
    values, derived = (
        instance.evaluate(variables, instance.data(combinations)).values,
        instance.model.declaration.derived,
    )
    known = [name for name in derived if np.isfinite(values[name]).sum() > 5]
    limits = {}
    for name in rng.permutation(known)[:3].tolist():
        bound = float(np.nanmedian(values[name]))
        sense = ("at_most", "at_least")[int(rng.integers(2))]
        if bound <= derived[name].ceiling and math.isfinite(bound):
            limits[name] = f"{SYMBOLS[sense]} {typed_quantity(bound, instance.model.units[name], None)}"
    for first in instance.model.variables[:1]:
        limits[first.name] = f"<= {typed_quantity(first.upper, first.unit, None)}"
    return limits


def question(problem, requirements, catalogs, objectives, sound, rng, **restricted):
    """Return a question with points at random and limits that some of them keep and some do not."""
    plain = instance_of(problem, requirements, catalogs, **restricted)
    variables = sound(plain)
    total = plain.combinations.count
    allowed = np.arange(total) if total < 10_000 else rng.integers(0, total, 999)
    allowed = allowed[not_refused(plain, allowed)]
    combinations = rng.choice(allowed, len(variables))
    limits = {**restricted.pop("limits", {})}
    for name, text in own_limits(plain, variables, combinations, rng).items():
        limits.setdefault(name, text)
    instance = instance_of(problem, requirements, catalogs, limits=limits, **restricted)
    chosen = chosen_objectives(instance.model, objectives)
    return Asked(problem, requirements, catalogs, limits, instance, chosen, variables, combinations)


def inside(instance, rng):
    """Return makeable points of a question at random."""
    points = instance.ranges.lower + (instance.ranges.upper - instance.ranges.lower) * rng.random(
        (POINTS, len(instance.ranges.lower))
    )
    for k, grid in enumerate(instance.ranges.grids()):
        if len(grid):
            points[:, k] = rng.choice(grid, POINTS)
    return points


def of_structure(structure, seed):
    case, rng = make(structure, seed), np.random.default_rng([seed, 5])
    asked = case.question()
    problem = RandomProblem(structure=structure, seed=str(seed))
    restricted = {name: asked[name] for name in ("limits", "fix", "parts", "grid") if name in asked}
    restricted["fix"] = {n: v for n, v in restricted.get("fix", {}).items() if n not in case.derived}
    tables = catalogs_for(problem, asked.get("catalogs"))
    return question(problem, {}, tables, case.objectives, lambda i: inside(i, rng), rng, **restricted)


def of_family(family):
    data, rng = CASES[family], np.random.default_rng(5)
    case = next(iter(data.feasible.values()))
    problem = synth.load(family, **case.options)
    restricted = {name: case.settings[name] for name in ("limits", "fix", "parts", "grid") if name in case.settings}

    def sound(instance):
        points = np.clip(data.sound(rng, instance, POINTS), instance.ranges.lower, instance.ranges.upper)
        for k, grid in enumerate(instance.ranges.grids()):
            if len(grid):
                points[:, k] = grid[np.argmin(np.abs(grid - points[:, [k]]), axis=1)]
        return points

    return question(problem, dict(case.requirements), as_catalogs(None), None, sound, rng, **restricted)


FAMILIES = [pytest.param(f, marks=[] if f == "wrap_spring" else pytest.mark.slow) for f in CASES]


@pytest.fixture(
    scope="module", params=[*RANDOM, *FAMILIES], ids=lambda p: p if isinstance(p, str) else f"{p[0]}-{p[1]}"
)
def asked(request):
    return of_family(request.param) if isinstance(request.param, str) else of_structure(*request.param)


def guarded(asked, result):
    """Tell at which points all guards hold: only there every side exists."""
    held = [result.holds[x.name] & ~result.void[x.name] for x in asked.instance.constraints if x.guard]
    return np.logical_and.reduce(held) if held else np.ones(len(asked.variables), dtype=bool)


def same(found, expected, where):
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-9, err_msg=str(where))


@pytest.mark.slow
def test_limits_of_family_and_user_are_one_list_in_the_order_of_reports(asked):
    instance, own = asked.instance, asked.instance.limits.judging
    assert [x.name for x in instance.constraints] == [x.name for x in (*instance.model.limits, *own)]
    derived = instance.model.declaration.derived
    assert {x.quantity for x in own} == set(asked.limits) & set(derived)
    assert {x.quantity for x in instance.limits.bounding} <= set(asked.limits) - set(derived)
    for x in own:
        assert (x.origin, x.scale, x.guard, x.void_without) == (Origin.USER, SMALLEST, False, ())
    result = asked.result
    assert list(result.limits) == list(result.residuals) == list(result.holds) == list(result.void)
    assert list(result.limits) == list(dict.fromkeys(x.name for x in instance.constraints))
    every = np.logical_and.reduce([result.holds[x.name] for x in instance.constraints] or [np.ones(POINTS, dtype=bool)])
    np.testing.assert_array_equal(result.feasible, every)


@pytest.mark.slow
def test_a_limit_on_a_variable_bounds_the_search_and_is_judged_in_a_given_design(asked):
    instance = asked.instance
    for x in instance.limits.bounding:
        for k, v in enumerate(instance.model.variables):
            if v.name == x.quantity:
                assert x.sense == "at_least" or instance.ranges.upper[k] <= x.bound
                assert x.sense == "at_most" or instance.ranges.lower[k] >= x.bound
    given = {x.name for x in instance.limits.bounding}
    for _, design in asked.designs():
        assert given <= set(design.residuals)
        assert not given & set(design.violated)


def test_the_check_of_a_design_reads_limits_as_the_question_does(asked):
    result = asked.result
    for k, design in asked.designs():
        for x in asked.instance.constraints:
            same(design.residuals[x.name], result.residuals[x.name][k], x.name)
            assert (x.name in design.violated) == (not result.holds[x.name][k]), x.name


@pytest.mark.slow
def test_the_screens_of_the_search_read_limits_as_the_question_does(asked):
    form = Formulation(asked.instance, {}, 0)
    result, refused = asked.result, ~not_refused(form.instance, asked.combinations)
    feasible = result.feasible & ~refused
    rows = [form.points.feasible_rows, form.points.edge_rows]
    screened = np.concatenate([pick(asked.variables, asked.combinations)[0] for pick in rows])
    np.testing.assert_array_equal(np.sort(screened), np.flatnonzero(feasible))
    columns = [x[:, None] for x in asked.variables.T]
    most = np.full((POINTS, 0), np.inf)
    kept = form.points.promising(columns, asked.combinations[:, None], most)[:, 0]
    assert np.all(kept[feasible])


@pytest.mark.slow
def test_rows_of_the_solver_are_logarithms_or_shares_of_the_size_of_a_miss(asked):
    form = Formulation(asked.instance, asked.chosen, len(asked.chosen))
    result, goals, logs = asked.result, len(form.goals), form.continuous.rows.log_constraints
    assert form.node_constraints == [NodeConstraint.of(x) for x in asked.instance.constraints]
    comparable = guarded(asked, result)
    for x, log in zip(asked.instance.constraints, logs, strict=True):
        if log:  # both sides are positive wherever a design may be feasible, and so not at all points
            comparable &= np.logical_and(*(~(side <= 0) for side in result.limits[x.name]))
    rows = np.flatnonzero(comparable)[:CHECKED]
    expected = np.zeros(len(rows))
    for x, log in zip(asked.instance.constraints, logs, strict=True):
        value, limit = (np.broadcast_to(side, len(asked.variables))[rows] for side in result.limits[x.name])
        scale = np.broadcast_to(result.scales[x.name], len(asked.variables))[rows]
        with np.errstate(all="ignore"):
            amount = np.log(value / limit) if log else (value - limit) / size_of_miss(value, limit, scale)
        row = {"at_most": amount, "at_least": -amount, "equal": np.abs(amount)}[x.sense]
        row = np.where(np.isnan(row), np.inf, row + (GUARD_MARGIN if x.guard else 0.0))
        expected = np.maximum(expected, np.where(result.void[x.name][rows], 0.0, row))
    nlp = BatchNlp(asked.instance.model.program, form.n, form.continuous.rows)
    nothing = np.zeros((len(rows), goals))
    tasks = Tasks(nothing, nothing, np.full((len(rows), goals), np.inf), form.objectives.scales, 0.0)
    points, data = asked.variables[rows], asked.instance.data(asked.combinations[rows])
    found = nlp.solve(
        tasks, ProblemInputs(data, points, points, form.bounds, void_limits(form.constraints, data, len(rows))), points
    )
    np.testing.assert_allclose(found.violation, expected, rtol=1e-6, atol=1e-8)


def test_verification_reads_limits_by_itself_and_alike(asked):
    check, result = VerificationRun(None, math.inf), asked.result
    check.ask(asked.instance)
    model = asked.instance.model
    assert void_without(model) == {x.name: list(x.void_without) for x in model.constraints}
    every = guarded(asked, result)
    for k in range(CHECKED):
        data = [float(x[k]) if np.ndim(x) else float(x) for x in asked.data]
        point = Point(asked.variables[k], data, {})
        values, limits, _ = check._evaluate(point)
        readings = list(check._readings(point, values, limits))
        assert [x.name for x in readings] == [x.name for x in asked.instance.constraints]
        assert all(x.void or x.holds for x in readings) == result.feasible[k]
        for own, x in zip(readings, asked.instance.constraints, strict=True):
            assert (own.sense, own.guard) == (x.sense, x.guard)
            scale = np.ravel(result.scales[x.name])[k if x.terms is not None else 0]
            assert own.scale == pytest.approx(scale, rel=1e-12, nan_ok=True)
            assert own.void == result.void[x.name][k]
            if every[k] and not own.void:
                same(own.residual, result.residuals[x.name][k], x.name)
                assert own.holds == result.holds[x.name][k], x.name


def test_what_explains_keeps_the_same_limits_where_nothing_gives_way(asked):
    instance, result = asked.instance, asked.result
    variables = {v.name for v in instance.model.variables}
    own = [*instance.limits.judging, *(x for x in instance.limits.bounding if x.quantity in variables)]
    names = [x.name for x in (*instance.model.constraints, *own)]
    model = Relaxed(instance, own, {}, names).model(frozenset(), instance.catalogs)
    assert model.variables[-1].name == AMOUNT
    relaxed = model.evaluate(np.column_stack([asked.variables, np.zeros(POINTS)]), asked.data)
    np.testing.assert_array_equal(relaxed.feasible, result.feasible)
    for x in instance.constraints:
        same(relaxed.residuals[x.name], result.residuals[x.name], x.name)
        np.testing.assert_array_equal(relaxed.holds[x.name], result.holds[x.name], err_msg=x.name)


@pytest.mark.slow
def test_limits_posed_at_a_corner_are_what_a_rating_finds_there(asked):
    if not asked.instance.model.variables:
        pytest.skip("nothing that has a tolerance")
    first = asked.instance.model.variables[0].name
    block = read_block({"tolerance": {first: "+-1 %"}})
    problem = robust_counterpart(asked.problem, block, asked.limits)
    corners = instance_of(problem, asked.requirements, asked.catalogs, limits=asked.limits, restrict=False)
    rater = rater_of(asked.problem, asked.requirements, asked.catalogs, asked.limits, block)
    copies = [x for x in corners.constraints if x.origin is Origin.RANGE]
    names, data = [x.name for x in rater.limits], [np.asarray(x, dtype=float) for x in asked.data]
    assert [x.name for x in rater.limits] == [x.name for x in asked.instance.constraints if x.sense != "equal"]
    nominal = asked.result
    for k, design in asked.designs():
        inputs = [x[k] if np.ndim(x) else x for x in data]
        there = corners.evaluate(asked.variables[[k]], inputs)
        found = {end: rater.residuals(design, np.array([[end]]))[:, 0] for end in (0.0, 1.0)}
        same(rater.residuals(design, np.array([[0.5]]))[:, 0], _rated(nominal, rater.limits, k), "nominal")
        for x in copies:
            name, _, end = x.name.removesuffix(")").rpartition(" ")
            j = names.index(name.rpartition(" (")[0])
            rated, stated = found[{"low": 0.0, "high": 1.0}[end]][j], float(there.residuals[x.name][0])
            if math.isfinite(rated) and math.isfinite(stated):
                same(stated, rated, x.name)
                assert bool(holds(stated, x.guard)) == bool(holds(rated, x.guard)), x.name


def _rated(result, limits, k):
    """Return residuals of a design as a rating counts them: infinite where not met at all, or void."""
    told = [(result.residuals[x.name][k], result.holds[x.name][k]) for x in limits]
    return np.array([(-math.inf if held else math.inf) if math.isnan(r) else r for r, held in told])


def test_a_number_and_a_node_are_told_apart():
    on_number = Constraint(name="a", sense="at_most", value=3, bound=2.0, unit="-")
    on_node = Constraint(name="a", sense="at_most", value=3, bound=2, unit="-")
    assert (on_number.nodes, on_node.nodes) == ((3,), (3, 2))
    assert NodeConstraint.of(on_number) == NodeConstraint("at_most", 3, None, SMALLEST, 2.0)
    assert NodeConstraint.of(on_node) == NodeConstraint("at_most", 3, 2, SMALLEST)


def test_a_limit_without_a_column_is_void_unless_the_user_states_it():
    x = Constraint(name="a", sense="at_most", value=3, bound=2, unit="-", void_without=(1,))
    data = [np.array([1.0, math.nan]), np.array([math.nan, 1.0])]
    assert x.void(data, (2,)).tolist() == [True, False]


class Worn(synth.DesignProblem):
    """A life that some rows do not tell, behind a guard."""

    name, title = "worn", "Worn"
    sources = ("none",)

    def declare(self, d):
        size = d.variable("size", "m", 1.0, 2.0)
        pad = d.part("pad", "pads")
        d.at_most("fits", size, 1.8, "m", guard=True)
        d.derive("life", "-", size * pad.optional("life"))
        d.derive("left", "-", np.sqrt(1.8 - size), needs=("fits",))
        d.objective("life", "max")
        d.objective("left", "max", default=False)


def worn(limits, objectives=None):
    import pandas as pd

    pads = pd.DataFrame({"designation": ["told", "untold"], "life [-]": [3.0, np.nan]})
    return instance_of(Worn(), {}, as_catalogs({"pads": pads}), limits=limits, objectives=objectives)


def test_what_a_user_limits_must_have_a_value():
    instance, every = worn({"life": ">= 2"}), worn({"left": ">= 0.1"}, ["left"])
    assert (instance.combinations.count, every.combinations.count) == (1, 2)
    reason = "no value in column life, which life needs"
    assert instance.selection.left_out == [{"slot": "pad", "designation": "untold", "reason": reason}]
    data, sizes = every.data(np.arange(2)), np.full((2, 1), 1.5)
    assert instance.evaluate(sizes, data).holds["life >= 2"].tolist() == [True, False]
    relaxed = Relaxed(instance, instance.limits.judging, {}, [x.name for x in instance.constraints]).model(
        frozenset(), None
    )
    both = relaxed.evaluate(np.array([[1.5, 0.0], [1.5, 0.0]]), data)
    assert both.feasible.tolist() == [True, False]


def test_behind_a_guard_that_fails_the_guard_alone_tells_why():
    instance = worn({"left": ">= 0.5"})
    result = instance.evaluate(np.array([[1.9], [1.5], [1.7]]), instance.data(np.zeros(3, dtype=int)))
    assert result.holds["fits"].tolist() == [False, True, True]
    assert result.holds["left >= 0.5"].tolist() == [True, True, False]
    assert np.isnan(result.residuals["left >= 0.5"][0])
    assert result.feasible.tolist() == [False, True, False]
