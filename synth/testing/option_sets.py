"""What every option set of a family must keep: complete words, sound dimensions, exact evaluation."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

import synth
from synth.bounds import kernel_boxes
from synth.model.model import Model
from synth.nlp.kernel_solver import fits
from synth.nlp.row_functions import RowFunctions
from synth.question.instance import Instance
from synth.question.objectives import chosen_objectives, with_ties
from synth.search.formulation import Formulation
from synth.special import expanded
from synth.testing.properties import Properties
from synth.testing.records import cases_of, question
from synth.text.row_cells import named_column
from synth.units import parse_unit

POINTS = 400
SCALES = 3
of_an_option_set = Properties()


@dataclass(frozen=True)
class Traced:
    """Question with all optional requirements, and random points of sensible proportions with their data.

    ``thorough``: units are made larger and smaller in several ways, else in one.
    """

    instance: Instance
    variables: np.ndarray
    data: list[np.ndarray]
    thorough: bool = False


def traced(family: str, name: str, thorough: bool = False) -> Traced:
    """Question and points of an option set."""
    cases = cases_of(family)
    instance = question(family, cases.option_sets[name], optional=True)
    rng = np.random.default_rng(3)
    variables = cases.sound(rng, instance, POINTS)
    combinations = rng.integers(0, instance.combinations.count, POINTS)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (POINTS,)) for x in instance.data(combinations)]
    return Traced(instance, variables, data, thorough)


# -- words -------------------------------------------------------------------------------------------


@of_an_option_set
def everything_has_a_unit_a_text_and_a_source(traced: Traced) -> None:
    d = traced.instance.model.declaration
    with_units: list[Any] = [
        *d.requirements.values(),
        *d.variables.values(),
        *d.counts.values(),
        *d.derived.values(),
        *d.limits.values(),
    ]
    described: list[Any] = [*with_units, *d.options.values(), *d.choices.values(), *d.slots.values()]
    for item in described:
        assert len(item.text) > 5, item
        assert len(item.source) > 1, item
    for item in with_units:
        assert parse_unit(item.unit).kind
    remarks: list[Any] = [*d.refusals, *d.advices]
    for remark in remarks:
        assert len(remark.message) > 5
        assert remark.code.isidentifier()


@of_an_option_set
def the_class_names_itself_and_its_sources(traced: Traced) -> None:
    problem = traced.instance.problem
    assert problem.title
    assert problem.sources
    assert (type(problem).__doc__ or "").strip()


@of_an_option_set
def every_column_has_a_text(traced: Traced) -> None:
    described = synth.describe(traced.instance.problem)
    assert (described.loc[described["kind"] == "column", "text"] != "").all()


@of_an_option_set
def default_objectives_are_two_or_three(traced: Traced) -> None:
    objectives = traced.instance.model.declaration.objectives.values()
    assert 2 <= sum(o.default for o in objectives) <= 3


@of_an_option_set
def limit_sides_have_the_kind_of_their_unit(traced: Traced) -> None:
    d = traced.instance.model.declaration
    for limit in d.limits.values():
        same = [q for q in d.derived.values() if q.sx.element_hash() == ca.SX(limit.value).element_hash()]
        for quantity in same:
            assert parse_unit(quantity.unit).kind == parse_unit(limit.unit).kind, limit.name


@of_an_option_set
def kernels_have_room_for_it(traced: Traced) -> None:
    # What has no room is solved over arrays, and takes much longer.
    instance = traced.instance
    asked = chosen_objectives(instance.model, None)
    form = Formulation(instance, with_ties(instance.model, asked), len(asked))
    assert fits(RowFunctions(instance.model.program, form.n, form.continuous.rows))
    for every in (False, True):
        assert kernel_boxes.fits(form.bounding.propagation.code(every, True))


# -- numbers -----------------------------------------------------------------------------------------


@cache
def outputs(model: Model) -> list[tuple[str, ca.SX, str]]:
    """Every quantity and side of a limit, special functions written out, with its unit."""
    named = [(name, e, model.units[name]) for name, e in model.quantity_sx.items()]
    for limit in model.limits:
        named += [(f"{limit.name}: value", limit.value, limit.unit), (f"{limit.name}: limit", limit.limit, limit.unit)]
    return [(name, expanded(e, model.calls), unit) for name, e, unit in named]


def sound_rows(instance: Instance, variables: np.ndarray, data: list[np.ndarray]) -> np.ndarray:
    """Points whose guards hold."""
    result = instance.model.evaluate(variables, data)
    guards = [result.holds[x.name] for x in instance.model.limits if x.guard]
    rows = np.flatnonzero(np.logical_and.reduce(guards)) if guards else np.arange(len(variables))
    assert len(rows) > 20
    return rows


@of_an_option_set
def the_evaluator_equals_casadi(traced: Traced) -> None:
    instance, variables, data = traced.instance, traced.variables, traced.data
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
def gradients_equal_differences(traced: Traced) -> None:
    instance, variables, data = traced.instance, traced.variables, traced.data
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
    numbers = [np.broadcast_to(x, math.prod(shape)) for x in whole([*shifted.reshape(-1, n).T, *around])]
    smooth = np.ones(shape[:-1], dtype=bool)  # steps over which no whole number jumps
    for number in (x.reshape(shape) for x in numbers):
        smooth &= np.ptp(number, axis=-1) == 0
    assert np.mean(smooth.any(axis=-1)) > 0.5
    raw = list(result.values.values()) + [s for y in model.limits for s in result.limits[y.name]]
    for (name, _, _), value, wanted in zip(named, raw, np.moveaxis(exact, 1, 0), strict=True):
        f = np.broadcast_to(value, math.prod(shape)).reshape(shape)
        if np.all(f == np.round(f)):  # what is a whole number is level between its jumps
            assert not np.any(wanted), name
            continue
        numeric = np.where(smooth, (f @ np.array([1, -8, 8, -1])) / (12 * sizes), np.nan)
        size = np.abs(f).max(axis=-1) + np.abs(wanted)[..., None]
        error = np.fmin.reduce(np.abs(numeric - wanted[..., None]) / np.where(size > 0, size, 1), axis=-1)
        assert np.all((error < 1e-7) | np.isnan(error)), name


def input_dimensions(instance: Instance) -> np.ndarray:
    """Exponents of kg, m, s, K and A of every input of the model."""
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


def traced_again(instance: Instance, constants: Mapping[str, tuple[int, ...]], scale: np.ndarray) -> Model:
    """Model once more, with the constants of its formulas in other units."""
    with pytest.MonkeyPatch.context() as patch:
        for place, exponents in constants.items():
            module, name = place.split(":")
            value = getattr(importlib.import_module(module), name)
            patch.setattr(f"{module}.{name}", value * np.prod(scale ** np.array(exponents, dtype=float)))
        chosen = {name: option.chosen for name, option in instance.model.declaration.options.items()}
        return type(instance.problem)(**chosen).model(instance.values.given, instance.catalogs)


@of_an_option_set
def formulas_scale_like_their_units(traced: Traced) -> None:
    # Kilogram, metre, second, kelvin and ampere of another size: sound formulas say the same thing in them.
    instance, variables, data = traced.instance, traced.variables, traced.data
    model = instance.model
    dimensions = input_dimensions(instance)
    constants = cases_of(instance.problem.name).constants
    rows = sound_rows(instance, variables, data)[:100]
    before = model.evaluate(variables[rows], [v[rows] for v in data])
    rng = np.random.default_rng(8)
    for _ in range(SCALES if traced.thorough else 1):  # random factors: one set of them shows each wrong exponent
        scale = rng.uniform(0.4, 2.5, 5)
        model = traced_again(instance, constants, scale)
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
