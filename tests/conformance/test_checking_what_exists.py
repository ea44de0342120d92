"""Every family checks what exists: sizes outside the range that is searched, sets of counts, parts that match."""

import itertools
import math
from functools import cache

import casadi as ca
import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.question.refusals import allowed_together
from synth.special import expanded
from synth.units import typed_quantity
from tests.asking import instance_of
from tests.conformance.cases import CASES, front_of

pytestmark = pytest.mark.slow

SHARE_FINITE = 0.6  # of all quantities of all designs tried


@pytest.fixture(scope="module", params=CASES)
def found(request):
    """Return the first feasible case of a family with its front."""
    name, case = next(iter(CASES[request.param].feasible.items()))
    front = front_of(request.param, name)
    return request.param, case, front.question, front.designs[0]


@cache
def written_out(model):
    """Return all quantities as a function of CasADi, special functions written out."""
    return ca.Function("reference", model.inputs, [expanded(e, model.calls) for e in model.quantity_sx.values()])


def by_casadi(instance, design):
    """Return the quantities of a design by CasADi alone."""
    model, d = instance.model, instance.model.declaration
    inputs = [design.values[v.name] for v in model.variables]
    for entry in model.data_inputs:
        if entry.kind == "part":
            row = design.parts[entry.name]
            given = [row[c] for c in entry.columns if row.get(c) is not None]
            inputs.append(given[0] if given else math.nan)
        elif entry.kind == "requirement":
            inputs.append(instance.values.requirements[entry.name])
        elif entry.kind == "row":
            inputs.append(instance.values.rows[str(entry.sx)])
        elif entry.kind == "choice":
            inputs.append(d.choices[entry.name].labels.index(design.choices[entry.name]))
        else:
            inputs.append(design.values[entry.name])
    values = written_out(model).call(inputs)
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


def evaluated(problem, requirements, values, parts):
    """Return the design, or the sentence that refuses it."""
    try:
        return synth.evaluate(problem, requirements, values=values, parts=parts)
    except synth.InputError as refusal:
        return refusal


def test_sizes_outside_of_the_range_are_computed(found):
    family, case, instance, design = found
    model, tried, finite = instance.model, 0, 0
    spec, problem = design.to_spec(), synth.load(family, **case.options)
    for name, value in moved_out(instance):
        stated = typed_quantity(value, model.units[name], None)
        values = {**spec["values"], name: stated}
        other = evaluated(problem, case.requirements, values, spec["parts"])
        if isinstance(other, synth.InputError):
            # What no formula gives a number for although the end of the range does: told with the value it is about.
            assert other.field == f"values: {name}"
            assert "can be computed" in other.expected
            continue
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
    assert finite > SHARE_FINITE * tried * len(model.quantity_sx)  # computed, and checked by CasADi
    assert np.isfinite(list(by_casadi(instance, design).values())).all()


def test_sets_of_counts_are_kept_to(found):
    family, case, instance, design = found
    counts = instance.model.declaration.counts
    for name, count in counts.items():
        steps = count.values
        near = int(np.argmin(np.abs(steps - design.values[name])))
        allowed = sorted({float(steps[near]), float(steps[0]), float(steps[-1])})
        own = {n: v for n, v in (case.settings.get("limits") or {}).items() if n not in (name, count.symbol)}
        for key in ("limits", "fix"):
            other = {n: v for n, v in (case.settings.get("fix") or {}).items() if n not in (name, count.symbol)}
            asked = {"limits": own, "fix": other}
            asked[key] = {**asked[key], name: allowed}
            posed = instance_of(
                synth.load(family, **case.options),
                case.requirements,
                as_catalogs(None),
                case.settings.get("parts"),
                asked["limits"],
                asked["fix"],
            )
            assert posed.selection.counts[name].tolist() == [x for x in allowed if x in instance_steps(instance, name)]
    if counts:
        name = next(iter(counts))
        held = synth.evaluate(
            instance.problem, case.requirements, design.to_spec(), limits={name: [design.values[name]]}
        )
        assert f"{name} in [{design.values[name]:g}]" in held.utilisation
        assert not held.violated


def instance_steps(instance, name):
    """Return the steps of a count that nothing but a set could leave out."""
    refused = {e["designation"] for e in instance.selection.left_out if e["slot"] == name}
    return [x for x in instance.model.declaration.counts[name].values if f"{x:g}" not in refused]


def comparable(instance):
    """Return two slots that share a column of numbers with different values, and the column."""
    slots = instance.model.declaration.slots
    tables = {name: instance.catalogs.table(part.table) for name, part in slots.items()}
    for (one, first), (two, second) in itertools.combinations(tables.items(), 2):
        for name, column in first.columns.items():
            if column.numeric and second.has(name) and second.column(name).scale.kind == column.scale.kind:
                if len(set(first.number(name)[~np.isnan(first.number(name))])) > 1:
                    return one, two, name
    return None


def test_slots_that_share_a_column_may_be_compared(found):
    family, case, instance, design = found
    shared = comparable(instance)
    if shared is None:
        return
    one, two, column = shared
    row = design.parts[one][column], design.parts[two][column]
    sign = ">" if row[0] > row[1] else "<" if row[0] < row[1] else "=="
    rules = {n: r for n, r in (case.settings.get("parts") or {}).items() if n not in (one, two)}
    fix = {n: v for n, v in (case.settings.get("fix") or {}).items() if n not in (one, two)}
    texts = {">": ("<=", f"{column} > {two}.{column}"), "<": (">=", f"{column} < {two}.{column}")}
    against, text = texts.get(sign, ("!=", f"{column} == {two}.{column}"))

    def left(rule):
        problem = synth.load(family, **case.options)
        posed = instance_of(
            problem, case.requirements, as_catalogs(None), {**rules, one: rule}, case.settings.get("limits"), fix
        )
        slots = {s.slot: s for s in posed.selection.slots}
        refusal = posed.model.declaration.refusals[-1]
        return posed, allowed_together(posed.model, refusal, [slots[one], slots[two]]), slots

    posed, allowed, slots = left(text)
    a, b = (slots[name].table.number(column)[slots[name].rows] for name in (one, two))
    compare = {">": np.greater, "<": np.less, "==": np.equal}[sign]
    np.testing.assert_array_equal(
        allowed if list(slots).index(one) < list(slots).index(two) else allowed.T, compare(a[:, None], b[None, :])
    )
    assert allowed.any(axis=0).all()
    assert allowed.any(axis=1).all()
    assert posed.selection.combinations_left_out
    assert str(design.parts[one]) in {slots[one].table.designations[r] for r in slots[one].rows}
    _, others, _ = left(f"{column} {against} {two}.{column}")
    assert others.any()
