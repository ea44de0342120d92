"""Every family checks what exists: sizes outside the range that is searched, sets of counts, parts that match."""

import math

import casadi as ca
import numpy as np
import pytest

import synth
from synth.special import expanded
from synth.units import format_quantity
from tests.conformance.cases import CASES, answer


@pytest.fixture(scope="module", params=CASES)
def found(request):
    """Return the first feasible case of a family with one design."""
    case = next(iter(CASES[request.param].feasible.values()))
    front = answer(request.param, case, points=1, gap=0.05)
    return request.param, case, front.question, front.designs[0]


def by_casadi(instance, design):
    """Return the quantities of a design by CasADi alone, special functions written out."""
    model, d = instance.model, instance.model.declaration
    inputs = [design.values[v.name] for v in model.variables]
    for entry in model.data_inputs:
        if entry.kind == "part":
            row = design.parts[entry.name]
            given = [row[c] for c in entry.columns if row.get(c) is not None]
            inputs.append(given[0] if given else math.nan)
        elif entry.kind == "requirement":
            inputs.append(instance.requirements[entry.name])
        elif entry.kind == "row":
            inputs.append(instance.row_values[str(entry.sx)])
        elif entry.kind == "choice":
            inputs.append(d.choices[entry.name].labels.index(design.choices[entry.name]))
        else:
            inputs.append(design.values[entry.name])
    outputs = [expanded(e, model.calls) for e in model.quantity_sx.values()]
    values = ca.Function("reference", model.inputs, outputs).call(inputs)
    return dict(zip(model.quantity_sx, map(float, values), strict=True))


def moved_out(instance):
    """Return values outside of the range of every unknown, a little and more."""
    for v in instance.model.variables:
        if v.lower > 0:
            yield v.name, 0.97 * v.lower
        for factor in (1.0001, 1.5):
            yield v.name, v.upper + (factor - 1) * abs(v.upper)
    for c in instance.model.declaration.counts.values():
        step = c.values[1] - c.values[0] if len(c.values) > 1 else 1.0
        yield c.name, c.values[-1] + step
        yield c.name, c.values[0] + step / 2


def test_sizes_outside_of_the_range_are_computed(found):
    family, case, instance, design = found
    model, tried, finite = instance.model, 0, 0
    spec = design.to_spec()
    for name, value in moved_out(instance):
        stated = format_quantity(value, model.units[name], None)
        other = synth.evaluate(
            synth.load(family, **case.options), case.requirements,
            values={**spec["values"], name: stated}, parts=spec["parts"],
        )  # fmt: skip
        tried += 1
        assert set(other.outside) == {name}
        assert other.values[name] == pytest.approx(value, rel=1e-12)
        reference = by_casadi(instance, other)
        for quantity, x in other.values.items():
            if math.isfinite(x):
                finite += 1
                assert x == pytest.approx(reference[quantity], rel=1e-9, abs=1e-300), (name, quantity)
        assert not [n for n, x in other.values.items() if math.isnan(x) and not other.violated]
    assert tried >= len(model.variables) + len(model.declaration.counts)
    assert finite > 10 * tried
    assert np.isfinite(list(by_casadi(instance, design).values())).all()
