"""The inputs of the program are the same whoever reads them: by number, from a design, from tables."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from synth.analysis.designs import make_design, make_frame, part_row
from synth.analysis.evaluate import _chosen_rows, _data
from synth.model.model import DataInput
from synth.question.inputs import first_value, inputs_of_design
from synth.question.instance import Instance
from synth.results import Design
from synth.text.row_cells import cell_value
from synth.variants.coverage import SharedModel, Variant, _inputs, _VariantColumns
from tests.conformance.cases import CASES, STRUCTURES, question

FIRST = {(family, next(iter(data.option_sets)), True) for family, data in CASES.items()}
QUESTIONS = [pytest.param(*asked, marks=[] if asked in FIRST else pytest.mark.slow) for asked in STRUCTURES]


def by_hand(instance: Instance, parts: Any, counts: Any, choices: Any) -> list[float]:
    """Return the inputs of a combination, read in the plainest way."""
    found = []
    for entry in instance.model.data_inputs:
        if entry.kind == "requirement":
            found.append(instance.values.requirements[entry.name])
        elif entry.kind == "count":
            found.append(counts[entry.name])
        elif entry.kind == "choice":
            found.append(instance.model.declaration.choices[entry.name].labels.index(choices[entry.name]))
        else:
            if entry.kind == "row":
                part = instance.model.declaration.rows[entry.name]
                table = instance.catalogs.table(part.table)
                row = table.designations.index(part.slot.split(":", 1)[1])
            else:
                table, row = parts[entry.name]
            cells = [float(table.number(c)[row]) for c in entry.columns if table.has(c)]
            found.append(next((x for x in cells if not math.isnan(x)), math.nan))
    return [float(x) for x in found]


def from_design(instance: Instance, design: Design) -> list[float]:
    def part(entry: DataInput) -> float:
        cells = [cell_value(design.parts[entry.name], c) for c in entry.columns]
        return float(first_value([np.array([x]) for x in cells])[0])

    return inputs_of_design(
        instance.model, instance.values.requirements, instance.values.rows, design.values, design.choices, part
    )


@pytest.mark.slow
@pytest.mark.parametrize(("family", "structure", "optional"), QUESTIONS, ids=lambda x: str(x))
def test_all_readers_agree_on_random_designs(family: str, structure: str, optional: bool) -> None:
    instance = question(family, CASES[family].option_sets[structure], optional)
    model, combinations = instance.model, instance.combinations
    numbers = np.random.default_rng(7).integers(0, combinations.count, 12)
    columns = [np.broadcast_to(np.asarray(x, dtype=float), numbers.shape) for x in instance.data(numbers)]
    owners, digits = instance.owners(), combinations.digits(numbers)
    for k, owner in enumerate(owners):
        if owner >= 0:
            np.testing.assert_array_equal(instance.column(k)[digits[owner]], columns[k])
    sizes = np.sqrt(np.clip(instance.ranges.lower, 1e-9, None) * np.clip(instance.ranges.upper, 1e-9, None))
    variants = []
    for row, number in enumerate(numbers.tolist()):
        parts, counts, choices = combinations.describe(number)
        wanted = by_hand(instance, parts, counts, choices)
        np.testing.assert_array_equal([x[row] for x in columns], wanted)
        result = model.evaluate(sizes[None, :], wanted)
        rows = {slot: part_row(table, at) for slot, (table, at) in parts.items()}
        design = make_design(instance, make_frame(instance, {}), sizes, result, 0, rows, choices)
        assert combinations.number(design) == number
        np.testing.assert_array_equal(from_design(instance, design), wanted)
        designations = {slot: str(part) for slot, part in design.parts.items()}
        np.testing.assert_array_equal(_data(instance, _chosen_rows(instance, designations), counts, choices), wanted)
        variants.append(Variant(family, design.values, choices, designations))
    held = _VariantColumns(model, SharedModel(instance.problem, instance.catalogs), variants)
    of_variants = [np.broadcast_to(x, numbers.shape) for x in _inputs(model, [instance], held, frozenset())[1]]
    np.testing.assert_array_equal(of_variants, columns)
