"""Calculations of problems made up at random: order, size and numbers, whatever the formulas look like."""

import json
import math

import numpy as np
import pytest

import synth
from synth.analysis.calculation import DEEPEST, LONGEST
from synth.model.problem import DesignProblem
from synth.results.calculation import Calculation
from synth.results.expression import names_in, parts_of, size_of
from synth.tables.catalogs import Catalogs
from tests.analysis.independent import recomputed
from tests.analysis.random_declarations import RODS, SHAPES, easy_problem, inputs_at, nested, random_problem
from tests.repetitions import repetitions

POINTS = 4


def trees_of(calculation):
    trees = [q.expression for q in calculation.quantities.values() if q.expression is not None]
    trees += [side for x in calculation.limits for side in (x.value, x.limit)]
    return trees + [x.condition for x in calculation.remarks]


def depth(tree):
    return 1 + max(map(depth, parts_of(tree)), default=0)


def assert_told_in_order(calculation):
    """Assert that no formula names what comes later, and that each fits a line."""
    known = set()
    for q in calculation.quantities.values():
        assert not q.computed or known.issuperset(names_in(q.expression)), q.name
        known.add(q.name)
    for x in calculation.limits:
        assert known.issuperset([*names_in(x.value), *names_in(x.limit)]), x.name
    for x in calculation.remarks:
        assert known.issuperset(names_in(x.condition)), x.code
    trees = trees_of(calculation)
    assert max(map(size_of, trees)) <= 1.5 * LONGEST
    assert max(map(depth, trees)) <= DEEPEST + 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(repetitions(10, 400)))
def test_calculations_of_random_declarations(seed):
    problem = random_problem(seed)
    calculation = synth.calculation(problem, {}, {"rods": RODS})
    assert_told_in_order(calculation)
    content = json.loads(calculation.to_json())
    assert Calculation.from_json(content) == calculation
    model = problem().model(frozenset(), Catalogs({"rods": RODS}))
    variables, data, rows = inputs_at(model, np.random.default_rng(seed), POINTS)
    result, steps = model.evaluate(variables, data), model.steps(variables, data)
    for k, row in enumerate(rows):
        values, told = recomputed(content, row)
        outcome = calculation.outcome(row)
        expected = {name: float(array[k]) for name, array in result.values.items()} | steps[k]
        for name, value in expected.items():
            assert values[name] == pytest.approx(value, rel=1e-9, nan_ok=True), name
            assert outcome.values[name] == pytest.approx(value, rel=1e-9, nan_ok=True), name
        for name, (value, limit) in result.limits.items():
            verdict = outcome.verdicts[name]
            assert told[name][2] == verdict.void == bool(result.void[name][k]), name
            assert told[name][3] == verdict.holds == bool(result.holds[name][k]), name
            if not verdict.void:
                assert (verdict.value, verdict.limit) == pytest.approx((value[k], limit[k]), rel=1e-9), name


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(repetitions(len(SHAPES), 10 * len(SHAPES))))
def test_random_declarations_are_searched_saved_loaded_and_reported(seed, tmp_path):
    problem = easy_problem(seed)
    front = synth.synthesize(problem, {}, objectives=["sum", "other"], points=3, gap=0.05, time_limit=5)
    assert front.designs
    front.save(tmp_path)
    again = synth.load_front(tmp_path)
    assert synth.calculation(again) == synth.calculation(front)
    for design in again.designs:
        synth.calculation(again).of_design(design)
    again.report(tmp_path, problem=problem, formats=("html", "xlsx", "json", "explorer", "pdf"))
    assert (tmp_path / "designs.xlsx").exists()


def small(declared):
    """Return a problem with a function that declares one thing more, of four variables and a requirement."""

    def declare(self, d):
        x = [d.variable(f"x{k}", "-", 1, 2) for k in range(4)]
        load = d.requirement("load", "-", 1, lower=0.1, upper=10)
        declared(d, x, load)
        d.derive("sum", "-", sum(x))
        d.objective("sum")

    return type("Small", (DesignProblem,), {"name": "small", "title": "Small", "declare": declare})


def long(x):
    """Return 14 nested terms, each of which uses the one before twice."""
    e = x[0]
    for k in range(14):
        e = np.sqrt(e * e + (k + 2) * x[k % len(x)] / (k + 1 + x[(k + 1) % len(x)]))
    return e


ROOTS = {
    "limit": lambda d, e, load: d.at_most("room", e, 1e3, "-"),
    "other side": lambda d, e, load: d.at_most("room", 1, 2 + e, "-"),
    "equality": lambda d, e, load: d.equal("room", e - e / 2, e / 2, "-"),
    "guard": lambda d, e, load: d.at_least("room", e, 0, "-", guard=True),
    "remark": lambda d, e, load: d.advise("told", e > 1, "long"),
    "step": lambda d, e, load: d.step("long", "-", e),
    "derived": lambda d, e, load: d.derive("long", "-", e),
    "objective": lambda d, e, load: (d.derive("long", "-", e), d.objective("long")),
    "limit over two": lambda d, e, load: d.at_most("room", np.sin(e) + e / (1 + e), e + load, "-"),
    "next row": lambda d, e, load: d.next_row("rod", e, "cooling_options", "heat_transfer"),
}


@pytest.mark.parametrize("root", ROOTS)
def test_parts_of_formulas_stand_in_order_whatever_uses_them(root):
    calculation = synth.calculation(small(lambda d, x, load: ROOTS[root](d, long(x), load)), {})
    assert_told_in_order(calculation)
    inputs = {"x0": 1.1, "x1": 1.2, "x2": 1.3, "x3": 1.4, "load": 2.0}
    assert calculation.outcome(inputs).values["sum"] == pytest.approx(5.0)


@pytest.mark.slow
def test_a_front_with_one_long_limit_is_saved(tmp_path):
    front = synth.synthesize(small(lambda d, x, load: ROOTS["limit"](d, long(x), load)), {})
    front.save(tmp_path)
    assert (tmp_path / "calculation.json").exists()


def test_parts_do_not_take_names_of_the_family():
    def declared(d, x, load):
        d.at_most("room", long([*x, d.variable("u_1", "-", 1, 2)]), 1e3, "-")
        d.derive("two", "-", load * 2, symbol="u_2")
        d.step("u_3", "-", load * 3)

    calculation = synth.calculation(small(declared), {})
    assert_told_in_order(calculation)
    kinds = {name: q.kind for name, q in calculation.quantities.items() if name.startswith("u_")}
    assert (kinds["u_1"], kinds["u_3"]) == ("variable", "step")
    assert "u_2" not in kinds
    assert {kind for name, kind in kinds.items() if name not in ("u_1", "u_3")} == {"helper"}


def test_a_default_that_does_not_fit_a_line_is_told_by_its_value():
    def declared(d, x, load):
        d.requirement("short", "-", 2 * load, upper=1e3)
        d.requirement("long", "-", nested(np.random.default_rng(1), [load, 2 * load]), upper=1e3)

    calculation = synth.calculation(small(declared), {})
    assert calculation.quantities["short"].expression == ["*", [["n", 2.0], ["q", "load"]], []]
    assert calculation.quantities["long"].expression is None


@pytest.mark.parametrize("count", [60, 600, 1500])
def test_a_chain_without_end_is_told_in_parts(count):
    def declared(d, x, load):
        e = x[0]
        for k in range(count):
            e = np.sin(e) if k % 2 else np.tanh(e)
        d.at_most("room", e, 1.0, "-")

    calculation = synth.calculation(small(declared), {})
    assert_told_in_order(calculation)
    assert calculation.to_json()
    e = 1.5
    for k in range(count):
        e = math.sin(e) if k % 2 else math.tanh(e)
    inputs = {"x0": 1.5, "x1": 1.0, "x2": 1.0, "x3": 1.0, "load": 1.0}
    assert calculation.outcome(inputs).verdicts["room"].value == pytest.approx(e, rel=1e-9)


def test_conditions_are_told_in_parts_where_nothing_else_makes_them_shorter():
    def declared(d, x, load):
        c = x[0] > x[1]
        for k in range(30):
            c = np.logical_and(np.logical_or(c, x[2] > x[3] + 0.1 * k), np.logical_or(np.logical_not(c), x[1] > x[3]))
        d.advise("told", c, "decided")

    assert_told_in_order(synth.calculation(small(declared), {}))
