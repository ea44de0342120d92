"""What every family must keep: complete words, sound dimensions, exact evaluation, and answers that can be trusted."""

import importlib
import math
from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest
import yaml

import synth
from synth.bounds import kernel_boxes
from synth.folders.files import read_bytes
from synth.nlp.kernel_solver import fits
from synth.nlp.row_functions import RowFunctions
from synth.question.catalogs import as_catalogs
from synth.question.objectives import chosen_objectives, with_ties
from synth.results.front import front_record
from synth.results.front_record import record_text
from synth.search.formulation import Formulation
from synth.search.refused_cells import not_refused
from synth.special import expanded
from synth.text.input_limits import INPUT_LIMITS
from synth.text.row_cells import named_column
from synth.units import parse_unit
from tests.asking import instance_of
from tests.conformance.cases import CASES, OF_SHAFTS, answer, front_of, question, question_to
from tests.properties import Properties
from tests.referees.ipopt import Task
from tests.regimes import refereed
from tests.repetitions import repetitions
from tests.shipped import FAMILIES

pytestmark = pytest.mark.slow

STRUCTURES = [(f, s) for f, data in CASES.items() for s in data.option_sets]
EXAMPLES = [(f, c) for f, data in CASES.items() for c in data.feasible]
POINTS = 400
of_an_option_set = Properties()


def test_every_shipped_family_has_cases():
    assert set(CASES) == set(FAMILIES)


@pytest.fixture(scope="module", params=STRUCTURES, ids=lambda p: f"{p[0]}-{p[1]}")
def traced(request):
    """Return the question with all optional requirements, and random points with sensible proportions."""
    family, structure = request.param
    instance = question(family, CASES[family].option_sets[structure], optional=True)
    rng = np.random.default_rng(3)
    variables = CASES[family].sound(rng, instance, POINTS)
    combinations = rng.integers(0, instance.combinations.count, POINTS)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (POINTS,)) for x in instance.data(combinations)]
    return instance, variables, data


# -- words -------------------------------------------------------------------------------------------


@of_an_option_set
def everything_has_a_unit_a_text_and_a_source(traced):
    d = traced[0].model.declaration
    with_units = [
        *d.requirements.values(),
        *d.variables.values(),
        *d.counts.values(),
        *d.derived.values(),
        *d.limits.values(),
    ]
    for item in [*with_units, *d.options.values(), *d.choices.values(), *d.slots.values()]:
        assert len(item.text) > 5, item
        assert len(item.source) > 1, item
    for item in with_units:
        assert parse_unit(item.unit).kind
    for remark in [*d.refusals, *d.advices]:
        assert len(remark.message) > 5
        assert remark.code.isidentifier()


@of_an_option_set
def the_class_names_itself_and_its_sources(traced):
    problem = traced[0].problem
    assert problem.title
    assert problem.sources
    assert (type(problem).__doc__ or "").strip()


@of_an_option_set
def default_objectives_are_two_or_three(traced):
    objectives = traced[0].model.declaration.objectives.values()
    assert 2 <= sum(o.default for o in objectives) <= 3


@of_an_option_set
def limit_sides_have_the_kind_of_their_unit(traced):
    d = traced[0].model.declaration
    for limit in d.limits.values():
        same = [q for q in d.derived.values() if q.sx.element_hash() == ca.SX(limit.value).element_hash()]
        for quantity in same:
            assert parse_unit(quantity.unit).kind == parse_unit(limit.unit).kind, limit.name


@of_an_option_set
def kernels_have_room_for_it(traced):
    # What has no room is solved over arrays, and takes much longer.
    instance = traced[0]
    asked = chosen_objectives(instance.model, None)
    form = Formulation(instance, with_ties(instance.model, asked), len(asked))
    assert fits(RowFunctions(instance.model.program, form.n, form.continuous.rows))
    for every in (False, True):
        assert kernel_boxes.fits(form.bounding.propagation.code(every, True))


# -- numbers -----------------------------------------------------------------------------------------


@cache
def outputs(model):
    """Return every quantity and side of a limit, special functions written out, with its unit."""
    named = [(name, e, model.units[name]) for name, e in model.quantity_sx.items()]
    for limit in model.limits:
        named += [(f"{limit.name}: value", limit.value, limit.unit), (f"{limit.name}: limit", limit.limit, limit.unit)]
    return [(name, expanded(e, model.calls), unit) for name, e, unit in named]


def sound_rows(instance, variables, data):
    """Return the points whose guards hold."""
    result = instance.model.evaluate(variables, data)
    guards = [result.holds[x.name] for x in instance.model.limits if x.guard]
    rows = np.flatnonzero(np.logical_and.reduce(guards)) if guards else np.arange(len(variables))
    assert len(rows) > 20
    return rows


@of_an_option_set
def the_evaluator_equals_casadi(traced):
    instance, variables, data = traced
    model = instance.model
    named = outputs(model)
    rows = sound_rows(instance, variables, data)
    inputs = np.array([*variables.T, *data])[:, rows]
    function = ca.Function("reference", [ca.vertcat(*model.inputs)], [ca.vertcat(*[e for _, e, _ in named])])
    reference = np.array(function(inputs))
    result = model.evaluate(variables[rows], [x[rows] for x in data])
    found = list(result.values.values()) + [side for x in model.limits for side in result.limits[x.name]]
    for (name, _, _), wanted, value in zip(named, reference, found, strict=True):
        np.testing.assert_allclose(value, wanted, rtol=1e-12, atol=1e-300, err_msg=name)


@of_an_option_set
def gradients_equal_differences(traced):
    instance, variables, data = traced
    model = instance.model
    named = outputs(model)
    rows = sound_rows(instance, variables, data)[:15]
    x = ca.vertcat(*model.inputs)
    n = len(model.variables)
    values = ca.vertcat(*[e for _, e, _ in named])
    slope = ca.Function("slope", [x], [ca.jacobian(values, x[:n]) if n > 1 else ca.jacobian(values, x[0])])
    at = np.array([*variables.T, *data])[:, rows]
    exact = np.array([np.array(slope(point)) for point in at.T]) * variables[rows][:, None, :]
    # By relative steps from every point along each variable (rows, variables, sizes of a step, steps). Of two sizes, as
    # of the truncated and the rounded difference, the better one counts.
    sizes, steps = np.array([1e-4, 1e-6]), np.array([-2, -1, 1, 2])
    shape = (len(rows), n, len(sizes), len(steps))
    shifted = np.broadcast_to(variables[rows][:, None, None, None, :], (*shape, n)).copy()
    for k in range(n):
        shifted[:, k, :, :, k] *= 1 + sizes[:, None] * steps
    around = [np.broadcast_to(v[rows][:, None, None, None], shape).ravel() for v in data]
    result = model.evaluate(shifted.reshape(-1, n), around)
    whole = model.program.compile([k for k, y in enumerate(model.program.nodes) if y.op in (ca.OP_FLOOR, ca.OP_CEIL)])
    numbers = [np.broadcast_to(x, np.prod(shape)) for x in whole([*shifted.reshape(-1, n).T, *around])]
    smooth = np.ones(shape[:-1], dtype=bool)  # steps over which no whole number jumps
    for number in (x.reshape(shape) for x in numbers):
        smooth &= np.ptp(number, axis=-1) == 0
    assert np.mean(smooth.any(axis=-1)) > 0.5
    raw = list(result.values.values()) + [s for y in model.limits for s in result.limits[y.name]]
    for (name, _, _), value, wanted in zip(named, raw, np.moveaxis(exact, 1, 0), strict=True):
        f = np.broadcast_to(value, np.prod(shape)).reshape(shape)
        if np.all(f == np.round(f)):  # what is a whole number is level between its jumps
            assert not np.any(wanted), name
            continue
        numeric = np.where(smooth, (f @ np.array([1, -8, 8, -1])) / (12 * sizes), np.nan)
        size = np.abs(f).max(axis=-1) + np.abs(wanted)[..., None]
        error = np.fmin.reduce(np.abs(numeric - wanted[..., None]) / np.where(size > 0, size, 1), axis=-1)
        assert np.all((error < 1e-7) | np.isnan(error)), name


def input_dimensions(instance):
    """Return the exponents of kg, m, s, K and A of every input of the model."""
    model, d = instance.model, instance.model.declaration
    result = [parse_unit(v.unit).dimension for v in model.variables]
    for entry in model.data_inputs:
        if entry.kind == "requirement":
            unit = parse_unit(d.requirements[entry.name].unit)
        elif entry.kind in ("part", "row"):
            table = instance.catalogs.table((d.slots if entry.kind == "part" else d.rows)[entry.name].table)
            known = [table.columns[named_column(c)] for c in entry.columns if table.has(named_column(c))]
            unit = known[0].scale if known and known[0].numeric else parse_unit("-")
        else:
            unit = parse_unit("-")
        result.append(unit.dimension)
    return np.array(result, dtype=float)


def traced_again(instance, constants, scale):
    """Return the model once more, with the constants of its formulas in other units."""
    with pytest.MonkeyPatch.context() as patch:
        for place, exponents in constants.items():
            module, name = place.split(":")
            value = getattr(importlib.import_module(module), name)
            patch.setattr(f"{module}.{name}", value * np.prod(scale ** np.array(exponents, dtype=float)))
        chosen = {name: option.chosen for name, option in instance.model.declaration.options.items()}
        return question_to(type(instance.problem)(**chosen), chosen, optional=True).model


@of_an_option_set
def formulas_scale_like_their_units(traced):
    # Kilogram, metre, second, kelvin and ampere of another size: sound formulas say the same thing in them.
    instance, variables, data = traced
    model = instance.model
    dimensions = input_dimensions(instance)
    own = CASES[instance.problem.name].constants
    rows = sound_rows(instance, variables, data)[:100]
    before = model.evaluate(variables[rows], [v[rows] for v in data])
    rng = np.random.default_rng(8)
    for _ in range(3 if own else 6):
        scale = rng.uniform(0.4, 2.5, 5)
        model = traced_again(instance, OF_SHAFTS | own, scale)
        factors = np.prod(scale**dimensions, axis=1)
        n = len(model.variables)
        after = model.evaluate(
            variables[rows] * factors[:n], [v[rows] * f for v, f in zip(data, factors[n:], strict=True)]
        )
        for name, value in before.values.items():
            factor = np.prod(scale ** np.array(parse_unit(model.units[name]).dimension))
            np.testing.assert_allclose(after.values[name], value * factor, rtol=1e-8, err_msg=name)
        for limit in model.limits:
            factor = np.prod(scale ** np.array(parse_unit(limit.unit).dimension))
            for old, new in zip(before.limits[limit.name], after.limits[limit.name], strict=True):
                np.testing.assert_allclose(new, old * factor, rtol=1e-8, err_msg=limit.name)
            assert (after.holds[limit.name] == before.holds[limit.name]).mean() > 0.98


def test_an_option_set_keeps_every_property(traced):
    assert of_an_option_set.broken(traced) == []


def test_limits_of_optional_requirements_are_not_asked_without_them():
    for family, data in CASES.items():
        options = next(iter(data.option_sets.values()))
        without = question(family, options, optional=False)
        with_all = question(family, options, optional=True)
        assert set(without.values.not_asked) == set(data.optional)
        assert with_all.values.not_asked == ()
        fewer, more = ({x.name for x in asked.model.limits} for asked in (without, with_all))
        assert fewer < more if data.optional else fewer == more


# -- answers -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module", params=EXAMPLES, ids=lambda p: f"{p[0]}-{p[1]}")
def example(request):
    family, name = request.param
    front = front_of(family, name)
    assert front.interrupted == ""
    return family, CASES[family].feasible[name], front


def test_feasible_examples_are_answered_and_proven(example):
    _, _, front = example
    assert front.status.value == "optimal"
    assert 2 <= len(front.designs) <= 4
    assert front.certificate.kind == "global"
    objectives = list(front.frame.objectives)
    values = np.array([[d.values[n] for n in objectives] for d in front.designs])
    for k, row in enumerate(values):
        assert not any(np.all(other <= row) for j, other in enumerate(values) if j != k)


def test_the_search_calls_feasible_what_the_evaluation_does(example):
    instance = example[2].question
    form = Formulation(instance, {}, 0)
    rng = np.random.default_rng(11)
    designs = [[d.values[v.name] for v in instance.model.variables] for d in example[2].designs]
    variables = np.repeat(designs, POINTS // len(designs), axis=0)
    # On and near the designs, where some limit is just kept or just missed.
    variables *= np.exp(rng.normal(0, 1e-3, variables.shape) * (rng.random(variables.shape) < 0.2))
    variables = np.clip(variables, instance.ranges.lower, instance.ranges.upper)
    combinations = rng.integers(0, instance.combinations.count, len(variables))
    close, edge = (
        form.points.feasible_rows(variables, combinations)[0],
        form.points.edge_rows(variables, combinations)[0],
    )
    assert not set(close) & set(edge)
    rows = np.union1d(close, edge)
    result = form.points.evaluate(variables, combinations)
    allowed = result.feasible & not_refused(form.instance, combinations)
    assert 0 < len(rows)
    np.testing.assert_array_equal(rows, np.flatnonzero(allowed))


def test_every_limit_has_a_utilisation(example):
    _, _, front = example
    for design in front.designs:
        assert set(design.utilisation) == set(front.frame.limit_units)
        unchecked = {remark.split()[2].rstrip(",") for remark in design.not_checked}
        for name, used in design.utilisation.items():
            if used is None:
                assert name in unchecked
            else:
                assert 0 <= used <= 1 + 2e-6


def test_designs_are_makeable(example):
    _, _, front = example
    for design in front.designs:
        assert design.off_grid == {}


def test_design_files_say_the_same_design_in_few_digits(example):
    family, case, front = example
    for design in front.designs:
        assert design.digits is not None
        spec = yaml.safe_load(design.yaml())
        again = synth.evaluate(
            synth.load(family, **spec.get("options", {})),
            spec["requirements"],
            {"values": spec["values"], "parts": spec["parts"]},
            limits=case.settings.get("limits"),
            objectives=front.frame.objectives,
        )
        assert (again.violated, again.not_checked) == ((), design.not_checked)
        assert set(design.advice) >= set(again.advice)
        assert again.off_grid == design.off_grid
        for name, value in design.objectives.items():
            assert again.objectives[name] == pytest.approx(value, rel=1e-9, abs=0.0)
        for name, kind in design.frame.kinds.items():
            if kind == "count":
                assert spec["values"][name] == design.values[name] or isinstance(spec["values"][name], str)
            elif kind == "variable" and design.digits:
                number = str(spec["values"][name]).split()[0].split("e")[0]
                assert len(number.replace(".", "").strip("-0")) <= design.digits


def test_checking_a_design_gives_its_values_again(example):
    family, case, front = example
    for design in front.designs:
        spec = design.to_spec()
        problem = synth.load(family, **spec.get("options", {}))
        again = synth.evaluate(problem, spec["requirements"], spec, limits=case.settings.get("limits"))
        assert again.status.value == "feasible"
        assert again.violated == ()
        for name, value in design.values.items():
            assert again.values[name] == value or (math.isnan(value) and math.isnan(again.values[name]))
        # Limits of one's own on variables and counts bound a search; of a given design they are told as well.
        unknowns = {n for n, kind in design.frame.kinds.items() if kind in ("variable", "count")}
        more = set(again.utilisation) - set(design.utilisation)
        assert {name.split()[0] for name in more} <= unknowns & set(case.settings.get("limits") or {})
        assert {n: again.utilisation[n] for n in design.utilisation} == design.utilisation
        assert again.advice == design.advice


MORE = 20_000  # bytes per design, for what scatters (12 000 where six things do) and for what ties


def test_the_largest_front_can_be_read_back(example, tmp_path):
    front = example[2]
    longest = max(front.designs, key=lambda d: len(record_text(front_record(replace(front, designs=[d])))))
    text = record_text(front_record(replace(front, designs=[longest] * INPUT_LIMITS.points)))
    path = tmp_path / "front.json"
    path.write_text(text)
    assert len(read_bytes(path, "front")) == len(text.encode())
    assert len(text.encode()) + MORE * INPUT_LIMITS.points < INPUT_LIMITS.file


def best(family, case, objective, **more):
    front = answer(family, case, objectives=[objective], points=1, **more)
    assert front.interrupted == ""
    return front.designs[0] if front.designs else None


@cache
def first_objective(family):
    declared = question(family, {}, optional=False).model.declaration.objectives.values()
    return next(o for o in declared if o.default)


@pytest.fixture(scope="module")
def optimum(example):
    """Return the least value of the first objective, for the seed that is used where none is given."""
    family, case, _ = example
    objective = first_objective(family).name
    return best(family, case, objective).values[objective]


def test_another_seed_reaches_the_same_optimum(example, optimum):
    family, case, front = example
    objective = first_objective(family).name
    assert best(family, case, objective, seed=1).values[objective] == pytest.approx(optimum, rel=1e-3)
    extreme = min(d.values[objective] for d in front.designs)
    assert optimum == pytest.approx(extreme, rel=1e-3)


def test_random_starts_of_the_solver_find_nothing_better(example):
    family, case, _ = example
    objective = first_objective(family)
    settings = {k: v for k, v in case.settings.items() if k in ("parts", "limits", "fix")}
    optimum = best(family, case, objective.name, grid=False).values[objective.name]
    instance = instance_of(
        synth.load(family, **case.options), case.requirements, as_catalogs(None), **settings, grid=False
    )
    form = Formulation(instance, {objective.name: objective.sense}, 1)
    task = Task(np.ones(1), np.zeros(1), np.full(1, np.inf), form.objectives.scales, t_weight=0.0)
    rng = np.random.default_rng(4)
    reached = []
    for combination in rng.permutation(instance.combinations.count)[:12]:
        box = form.boxes.contract(form.boxes.whole(int(combination)), None)
        for _ in range(2 * len(box)):
            low, high = box.low[0, : form.n], box.high[0, : form.n]  # a box may carry inner nodes too
            start = low * (high / low) ** rng.random(form.n)
            solution = refereed(form, task, int(combination), start, low, high)
            if solution is not None:
                value = form.points.evaluate(solution.variables[None, :], np.array([combination]))
                if value.feasible[0]:
                    reached.append(float(value.values[objective.name][0]))
    assert len(reached) >= 4
    assert min(reached) >= optimum * (1 - 1e-3)


def test_tightening_never_improves_an_objective(example, optimum):
    family, case, _ = example
    objective = first_objective(family)
    assert objective.sense == "min"
    for name, value in list(case.tighten.items())[: repetitions(1, len(case.tighten))]:
        tight = best(family, case, objective.name, requirements={name: value})
        if tight is not None:
            assert tight.values[objective.name] >= optimum * (1 - 1e-3), name
    loose = best(family, case, objective.name, gap=0.05)
    assert loose.values[objective.name] <= optimum * 1.06


@pytest.mark.parametrize("family", CASES)
def test_the_infeasible_example_is_explained_by_name(family):
    front = answer(family, CASES[family].infeasible)
    assert front.status.value == "infeasible"
    assert len(front.designs) == 0
    named = [c["limit"] for c in front.explanation["conflicts"]]
    assert named
    assert set(named) <= set(front.frame.limit_units)
    assert set(named) & CASES[family].culprits
    for name in named:
        assert name in front.explanation["message"]
    guards = {x.name for x in question(family, {}, optional=True).model.limits if x.guard}
    assert not set(named) & guards  # a guard cannot be relaxed, so it explains nothing
