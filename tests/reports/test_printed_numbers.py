"""What is printed on a calculation sheet can be computed again from what is printed."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from synth.reports.sheet.steps import Steps

from synth.analysis.calculation import calculation_of
from tests.conformance.cases import CASES, question
from tests.reports.printed import NUMBER, UNIT, difference

pytestmark = pytest.mark.slow
ENOUGH = 2e-4
ALONE = re.compile(rf"= -?{NUMBER}( {UNIT})?")
STRUCTURES = [(f, s) for f, data in CASES.items() for s in data.option_sets]


def outcomes(family, structure, count):
    """Yield points of a family with what the calculation gives there."""
    instance = question(family, CASES[family].option_sets[structure], optional=True)
    rng = np.random.default_rng(11)
    variables = CASES[family].sound(rng, instance, count)
    numbers = rng.integers(0, instance.combinations.count, count)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (count,)) for x in instance.data(numbers)]
    calculation = calculation_of(instance)
    labels = [v.name for v in instance.model.variables] + [i.label for i in instance.model.data_inputs]
    constants = {q.name: q.value for q in calculation.quantities.values() if q.kind == "constant"}
    for k in range(count):
        inputs = dict(zip(labels, [*map(float, variables[k]), *(float(x[k]) for x in data)], strict=True))
        yield calculation, calculation.outcome({**constants, **inputs})


@pytest.mark.parametrize(("family", "structure"), STRUCTURES)
def test_printed_numbers_give_the_printed_result(family, structure):
    for calculation, outcome in outcomes(family, structure, 2):
        steps = Steps(calculation, outcome)
        checked = 0
        for step in steps.all():
            value = outcome.values[step.name]
            if len(step.plain) < 3 or not math.isfinite(value) or ALONE.fullmatch(step.plain[1]):
                continue  # a number that is told once more in another unit
            if any("in SI" in note for note in step.notes if isinstance(note, str)):
                continue
            assert difference(step.plain[1], step.plain[2]) <= ENOUGH, step.plain
            checked += 1
        assert checked > 5
