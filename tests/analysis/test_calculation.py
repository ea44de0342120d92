"""Formulas read back from the trace: another evaluator gives every number and verdict of the engine from them."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import casadi as ca
import numpy as np
import pandas as pd
import pytest

import synth
from synth import InputError
from synth.analysis.calculation import LONGEST, calculation_of
from synth.model.problem import DesignProblem
from synth.results.calculation import Calculation
from synth.results.dimensions import dimension_of
from synth.results.expression import FUNCTIONS, in_force, names_in, size_of, value_of
from synth.testing.properties import Properties
from tests.analysis.independent import recomputed
from tests.conformance.cases import CASES, question

POINTS = 12
of_a_calculation = Properties()
STRUCTURES = [(f, s) for f, data in CASES.items() for s in data.option_sets]


@pytest.fixture(
    scope="module", params=[pytest.param(x, marks=pytest.mark.slow) for x in STRUCTURES], ids=lambda p: f"{p[0]}-{p[1]}"
)
def solved(request):
    """Return a calculation with what the engine says of points, some of which are feasible and some are not."""
    family, structure = request.param
    instance = question(family, CASES[family].option_sets[structure], optional=True)
    rng = np.random.default_rng(3)
    variables = CASES[family].sound(rng, instance, POINTS)
    numbers = rng.integers(0, instance.combinations.count, POINTS)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (POINTS,)) for x in instance.data(numbers)]
    model = instance.model
    labels = [v.name for v in model.variables] + [i.label for i in model.data_inputs]
    inputs = [
        dict(zip(labels, [*map(float, variables[k]), *(float(x[k]) for x in data)], strict=True)) for k in range(POINTS)
    ]
    return calculation_of(instance), model.evaluate(variables, data), model.steps(variables, data), inputs


def given(calculation, inputs):
    constants = {q.name: q.value for q in calculation.quantities.values() if q.kind == "constant"}
    return {**constants, **inputs}


def same(a, b, tolerance=1e-12):
    return a == b or (math.isnan(a) and math.isnan(b)) or abs(a - b) <= tolerance * max(abs(a), abs(b))


@of_a_calculation
def an_evaluator_that_knows_nothing_of_us_recomputes_everything(solved):
    calculation, result, steps, inputs = solved
    content = json.loads(calculation.to_json())
    needs = {x.name: x.needs for x in calculation.limits}
    for k in range(POINTS):
        values, told = recomputed(content, given(calculation, inputs[k]))
        for name, array in result.values.items():
            assert same(float(array[k]), values[name]), name
        for name, value in steps[k].items():
            assert same(value, values[name]), name
        for name, (value, limit) in result.limits.items():
            own = told[name]
            assert own[2] == bool(result.void[name][k]), name
            assert own[3] == bool(result.holds[name][k]), name
            exists = all(told[guard][3] for guard in needs[name])  # behind a guard that fails there are no sides
            if exists and not own[2]:
                assert same(float(value[k]), own[0]), name
                assert same(float(limit[k]), own[1]), name


@of_a_calculation
def the_record_says_the_same_as_the_other_evaluator(solved):
    calculation, _, _, inputs = solved
    content = json.loads(calculation.to_json())
    for k in range(POINTS):
        values, told = recomputed(content, given(calculation, inputs[k]))
        outcome = calculation.outcome(given(calculation, inputs[k]))
        assert all(same(outcome.values[name], value) for name, value in values.items())
        for name, (_, _, void, holds, used) in told.items():
            verdict = outcome.verdicts[name]
            assert (verdict.void, verdict.holds) == (void, holds), name
            assert (verdict.used is None) == (used is None), name
            assert used is None or same(verdict.used, used), name


@of_a_calculation
def it_is_read_back_as_it_was_written(solved):
    calculation = solved[0]
    again = Calculation.from_json(json.loads(calculation.to_json()))
    assert again == calculation
    assert again.digest == calculation.digest


@of_a_calculation
def what_is_computed_stands_behind_what_it_is_computed_from(solved):
    calculation = solved[0]
    known = set()
    for q in calculation.quantities.values():
        if q.computed:
            assert known.issuperset(names_in(q.expression)), q.name
        known.add(q.name)
    for x in calculation.limits:
        assert known.issuperset([*names_in(x.value), *names_in(x.limit)])


@of_a_calculation
def no_formula_is_longer_than_a_line(solved):
    calculation = solved[0]
    trees = [q.expression for q in calculation.quantities.values() if q.computed]
    trees += [side for x in calculation.limits for side in (x.value, x.limit)]
    trees += [x.condition for x in calculation.remarks]
    # Powers are counted once here and as products there.
    assert max(map(size_of, trees)) <= 1.5 * LONGEST


@of_a_calculation
def units_close_or_the_formula_is_one_for_si(solved):
    calculation = solved[0]
    quantities = calculation.quantities
    for q in quantities.values():
        if q.kind == "helper" and q.unit:
            assert dimension_of(q.expression, quantities) is not None


@of_a_calculation
def counts_have_a_step_and_parts_a_column_as_its_table_names_it(solved):
    for q in solved[0].quantities.values():
        if q.kind == "count":
            assert (q.bounds[1] - q.bounds[0]) / q.step == pytest.approx(round((q.bounds[1] - q.bounds[0]) / q.step))
        elif q.kind == "part":
            assert re.fullmatch(r"\w+", q.column)


@of_a_calculation
def a_branch_in_force_gives_the_same_number(solved):
    calculation, _, _, inputs = solved
    values = calculation.outcome(given(calculation, inputs[0])).values
    for q in calculation.quantities.values():
        if q.computed and not math.isnan(values[q.name]):
            short, met = in_force(q.expression, values)
            assert same(value_of(short, values), values[q.name])
            assert all(value_of(condition, values) == answer for condition, answer in met)


def test_a_calculation_keeps_every_property(solved):
    of_a_calculation.check(solved)


# -- one small problem ---------------------------------------------------------------------------------


class Beam(DesignProblem):
    """A beam that bends, with a step, a constant, a default that follows and a guard."""

    name, title, sources = "beam", "Beam", ("any textbook",)

    def declare(self, d):
        g = d.constant("gravity", "m/s2", 9.80665, symbol="g_n", text="Standard gravity", source="CGPM 1901")
        mass = d.requirement("mass_carried", "kg", lower=1, symbol="m", text="Mass carried")
        length = d.requirement("length", "mm", 500, lower=10, symbol="l", text="Length")
        d.requirement("reach", "mm", 2 * length, symbol="l_r", text="Reach")
        width = d.variable("width", "mm", 5, 100, symbol="b", text="Width")
        height = d.variable("height", "mm", 5, 100, symbol="h", text="Height")
        moment = d.step("moment", "N*m", mass * g * length, symbol="M", text="Bending moment")
        modulus = d.derive("modulus", "mm3", width * height**2 / 6, symbol="W", text="Section modulus")
        d.at_most("slender", height, 5 * width, "mm", guard=True, text="A guard")
        d.derive("stability", "-", ca.log(6 - height / width), symbol="s", text="Needs the guard", needs="slender")
        d.at_most("stress", moment / modulus, 100e6, "N/mm2", text="Bending stress")
        d.derive("area", "mm2", width * height, symbol="A", text="Section")
        d.objective("area", "min")
        d.advise("flat", height < width, "lies flat")


def test_steps_constants_and_defaults_are_told():
    calculation = synth.calculation(Beam, {"mass_carried": "100 kg"})
    q = calculation.quantities
    assert q["gravity"].value == 9.80665
    assert q["moment"].kind == "step"
    assert q["reach"].expression == ["*", [["n", 2.0], ["q", "length"]], []]
    assert q["modulus"].expression == ["*", [["q", "width"], ["^", ["q", "height"], ["n", 2.0]]], [["n", 6.0]]]
    assert calculation.limits[1].value == ["*", [["q", "moment"]], [["q", "modulus"]]]
    assert q["stability"].needs == ("slender",)
    assert [x.code for x in calculation.remarks] == ["flat"]


def test_a_failed_guard_takes_what_needs_it():
    calculation = synth.calculation(Beam, {"mass_carried": "100 kg"})
    design = synth.evaluate(Beam, {"mass_carried": "100 kg"}, values={"width": "10 mm", "height": "90 mm"})
    outcome = calculation.of_design(design)
    assert math.isnan(outcome.values["stability"])
    assert not outcome.verdicts["slender"].holds
    assert outcome.values["moment"] == pytest.approx(100 * 9.80665 * 0.5)


def test_limits_of_the_user_are_told():
    calculation = synth.calculation(Beam, {"mass_carried": "100 kg"}, limits={"modulus": "<= 9000 mm3"})
    rule = calculation.limits[-1]
    assert (rule.stated_by, rule.value, rule.limit) == ("user", ["q", "modulus"], ["n", pytest.approx(9e-6)])


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("front")
    front = synth.synthesize(Beam, {"mass_carried": "100 kg"})
    front.save(folder)
    return folder, front


def test_a_front_is_saved_with_its_calculation(saved):
    folder, front = saved
    again = synth.load_front(folder)
    assert synth.calculation(again) == synth.calculation(front)
    values = synth.calculation(again).values(again.designs[0])
    assert values["area"] == front.designs[0].values["area"]


def test_a_loaded_front_is_saved_with_it_as_well(saved, tmp_path):
    synth.load_front(saved[0]).save(tmp_path)
    assert (tmp_path / "calculation.json").read_text() == (saved[0] / "calculation.json").read_text()


def test_a_changed_digit_is_refused(saved, tmp_path):
    synth.load_front(saved[0]).save(tmp_path)
    path = tmp_path / "calculation.json"
    path.write_text(path.read_text().replace("9.80665", "9.80666", 1))
    with pytest.raises(InputError, match=r"calculation .*changed after it was saved"):
        synth.calculation(synth.load_front(tmp_path))
    assert "calculation.json" in synth.load_front(tmp_path).verify(Beam).findings[0]


def test_the_calculation_of_another_front_is_refused(saved, tmp_path):
    synth.load_front(saved[0]).save(tmp_path)
    other = synth.calculation(Beam, {"mass_carried": "100 kg"}, limits={"modulus": "<= 9000 mm3"})
    (tmp_path / "calculation.json").write_text(other.to_json())
    with pytest.raises(InputError, match="belongs to another one"):
        synth.calculation(synth.load_front(tmp_path))


@pytest.mark.parametrize("text", ["{}", "[]", '{"format":1,"digest":"x"}', '{"format":9}', "not json"])
def test_what_is_no_calculation_is_one_sentence(saved, tmp_path, text):
    synth.load_front(saved[0]).save(tmp_path)
    (tmp_path / "calculation.json").write_text(text)
    with pytest.raises(InputError, match="calculation"):
        synth.calculation(synth.load_front(tmp_path))


def test_a_design_of_other_formulas_is_refused_by_name(saved):
    front = saved[1]
    design = front.designs[0]
    changed = replace(design, values={**design.values, "modulus": 1.01 * design.values["modulus"]})
    with pytest.raises(InputError, match=r"design: modulus.*differs by 1 %"):
        synth.calculation(front).values(changed)


# -- trees ---------------------------------------------------------------------------------------------

X = ["q", "x"]


@pytest.mark.parametrize(
    ("tree", "x", "value"),
    [
        (["f", "sqrt", [X]], -1.0, math.nan),
        (["f", "ln", [X]], 0.0, -math.inf),
        (["f", "exp", [X]], 1e4, math.inf),
        (["*", [["n", 1.0]], [X]], 0.0, math.inf),
        (["*", [X], [X]], 0.0, math.nan),
        (["^", X, ["n", -1.0]], 0.0, math.inf),
        (["^", X, ["n", 0.5]], -1.0, math.nan),
        (["^", X, ["n", 3.0]], -2.0, -8.0),
        (["f", "min", [X, ["n", 1.0]]], math.nan, math.nan),
        (["if", ["<", X, ["n", 0.0]], ["f", "sqrt", [X]], ["n", 2.0]], 1.0, 2.0),
        (["not", ["<", X, ["n", 0.0]]], 1.0, 1.0),
        (["neg", ["+", [X, ["neg", X]]]], 3.0, 0.0),
    ],
)
def test_trees_compute_like_arrays_of_floats(tree, x, value):
    assert same(value_of(tree, {"x": x}), value)


def test_every_function_of_trees_can_be_computed():
    for name, function in FUNCTIONS.items():
        count = 2 if name in ("atan2", "hypot", "fmod", "copysign", "min", "max") else 1
        argument = 1.5 if name == "acosh" else 0.5
        assert math.isfinite(function(*[argument] * count)), name


def test_an_own_problem_with_tables_of_its_own_is_read_from_its_front(tmp_path):
    pads = pd.DataFrame({"designation": ["a", "b"], "mass [kg]": [2.0, 3.0]})

    class Padded(synth.DesignProblem):
        """A problem that no entry point names, of a part of a table that is not shipped."""

        name = "padded"

        def declare(self, d):
            pad, size = d.part("pad", "pads"), d.variable("size", "m", 1, 2)
            d.derive("weight", "kg", pad.mass * size)
            d.objective("weight")

    front = synth.synthesize(Padded(), {}, catalogs={"pads": pads})
    expected = synth.calculation(front).to_json()
    assert synth.calculation(front, catalogs={"pads": pads}).to_json() == expected
    assert front.verify(catalogs={"pads": pads}).holds
    loaded = synth.load_front(front.save(tmp_path / "front"))
    assert synth.calculation(loaded).to_json() == expected
    assert synth.calculation(loaded, catalogs={"pads": pads}, problem=Padded).to_json() == expected
    with pytest.raises(synth.InputError, match="padded"):
        synth.calculation(loaded, catalogs={"pads": pads})
