"""Every family over a range: limits posed at corners are its own limits there, and proven corners are the worst."""

import numpy as np
import pytest

import synth
from synth.question.catalogs import as_catalogs
from synth.question.uncertainty import read_block
from synth.robust.counterpart import robust_counterpart
from synth.robust.uncertainty import CATALOGUE, LEAST, MOST, SLIDING
from synth.units import typed_quantity
from tests.asking import instance_of, rater_of
from tests.conformance.cases import CASES

pytestmark = pytest.mark.slow

POINTS = 4


def block_of(instance):
    """Return what may scatter here: friction, the first requirements and variables, each by a few per cent."""
    d, block = instance.model.declaration, {}
    slots = [p for p in d.slots.values() if {SLIDING, LEAST, MOST} <= p.known]
    columns = {c for p in slots for c in p.columns if c.startswith("mu_")}
    if columns and not columns & {LEAST, MOST}:
        block["friction"] = CATALOGUE
    for name in sorted(instance.values.given):
        r, value = d.requirements[name], instance.values.requirements[name]
        inside = r.lower <= 0.97 * value and 1.03 * value <= r.upper
        if inside and value > 0 and "degC" not in r.unit and len(block) < 3:
            block[name] = "+-3 %"
    if any(name.endswith("_wear") for name in d.requirements):
        block["wear"] = "new and worn"
    return {**block, "tolerance": {instance.model.variables[0].name: "+-1 %"}, "samples": 256}


def designs_of(family, case, instance):
    """Return a few designs at random: not feasible ones, but where the guards hold."""
    rng = np.random.default_rng(0)
    variables = CASES[family].sound(rng, instance, 400)
    combinations = rng.integers(0, instance.combinations.count, 400)
    result = instance.model.evaluate(variables, instance.data(combinations))
    guards = [result.holds[x.name] for x in instance.model.limits if x.guard]
    rows = np.flatnonzero(np.logical_and.reduce(guards)) if guards else np.arange(400)
    for k in rows[:POINTS]:
        parts, counts, choices = instance.combinations.describe(int(combinations[k]))
        sizes = {
            v.name: typed_quantity(float(x), v.unit, None)
            for v, x in zip(instance.model.variables, variables[k], strict=True)
        }
        yield synth.evaluate(
            instance.problem,
            case.requirements,
            values={**sizes, **counts, **choices},
            parts={slot: table.designations[row] for slot, (table, row) in parts.items()},
        )


@pytest.mark.parametrize("family", CASES)
def test_posed_limits_are_those_of_the_family_and_proofs_hold(family):
    case = next(iter(CASES[family].feasible.values()))
    problem, catalogs = synth.load(family, **case.options), as_catalogs(None)
    instance = instance_of(problem, case.requirements, catalogs)
    asked = read_block(block_of(instance))
    rater = rater_of(problem, case.requirements, catalogs, None, asked)
    robust = instance_of(robust_counterpart(problem, asked, None), case.requirements, catalogs, restrict=False)
    things = {x.name: j for j, x in enumerate(rater.quantities)}
    names = [x.name for x in rater.limits]
    copies = [x.name for x in robust.model.limits if x.name not in instance.model.declaration.limits]
    assert copies
    rng = np.random.default_rng(1)
    proven = 0
    for design in designs_of(family, case, instance):
        own = synth.evaluate(robust.problem, case.requirements, design)
        for name in copies:
            limit, _, words = name.partition(" (")
            position = np.zeros(len(things))
            for word in words.rstrip(")").split(", "):
                thing, _, end = word.rpartition(" ")
                position[things[thing]] = {"low": 0.0, "high": 1.0}[end]
            sides = rater.sides(design, position[None, :])[names.index(limit)]
            for side, posed_one in zip(sides, own.limits[name], strict=True):
                np.testing.assert_allclose(posed_one, side[0], rtol=1e-9, atol=1e-12, err_msg=name)
        told = rater.one(design)["limits"]
        assert not [name for name, x in told.items() if x["holds"] is None]  # bounds are tight enough for every family
        points = rng.random((500, len(things)))
        sides = rater.sides(design, points)
        for limit, values, (value, bound) in zip(rater.limits, rater.residuals(design, points), sides, strict=True):
            own_worst = told.get(limit.name, {"proof": "sampled"})
            if own_worst["proof"] == "bounded":
                assert values.max() <= 1e-9, limit.name
            if own_worst["proof"] == "proven":
                proven += 1
                # Worst is the ratio of both sides, or their difference where they have no logarithm.
                direction = -1.0 if limit.sense == "at_least" else 1.0
                difference, size = direction * (value - bound), np.abs([value, bound]).max()
                most = direction * (own_worst["value"] - own_worst["limit"])
                worse = values.max() > own_worst["residual"] + 1e-9
                assert not worse or difference.max() <= most + 1e-9 * size, limit.name
    assert proven
