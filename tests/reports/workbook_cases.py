"""Designs of families for tests of workbooks, and where their inputs and results stand."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import openpyxl
from synth.reports.workbook import VALUE, live_workbook
from synth.reports.workbook_cells import legal_names
from synth.reports.workbook_limits import HOLDS, UNCHECKED, UNDECIDED, USED, VERDICT, VIOLATED

from synth.analysis.calculation import calculation_of
from synth.analysis.designs import make_design, make_frame, part_row
from synth.order.feasibility import residual
from synth.question.objectives import chosen_objectives
from synth.results import Design
from synth.results.calculation import CalculatedDesign, Calculation
from synth.results.design import DesignSteps
from synth.results.expression import names_in, value_of
from synth.units import from_si
from tests.conformance.cases import CASES, question

POINTS = 200
DIGITS = 1e-9  # relative; what a workbook and the engine may differ by


@dataclass(frozen=True)
class Sample:
    """A calculation with designs of it: ``designs[0]`` is as solved, others have other sizes, counts and parts."""

    calculation: Calculation
    designs: list[Design]
    rows: Mapping[str, list[Any]]


@dataclass
class Change:
    """Inputs in SI by name, choices by label, and designations by slot, that are typed."""

    numbers: dict[str, float] = field(default_factory=dict)
    labels: dict[str, str] = field(default_factory=dict)
    parts: dict[str, str] = field(default_factory=dict)


def sample(family: str, structure: str, few: int = 3) -> Sample:
    """Return random designs of a family, the best of them first; one is not checked for all limits, if there is."""
    instance = question(family, CASES[family].option_sets[structure], optional=True)
    calculation = calculation_of(instance)
    rng = np.random.default_rng(7)
    variables = CASES[family].sound(rng, instance, POINTS)
    numbers = rng.integers(0, instance.combinations.count, POINTS)
    data = [np.broadcast_to(np.asarray(x, dtype=float), (POINTS,)) for x in instance.data(numbers)]
    result = instance.model.evaluate(variables, data)
    violated = np.sum([~held for held in result.holds.values()], axis=0)
    void = np.any(list(result.void.values()), axis=0)
    # First the best of them, then one of which something cannot be checked, then any.
    chosen = [int(np.argmin(violated)), *np.flatnonzero(void)[:1].tolist(), *range(few)]
    frame = make_frame(instance, chosen_objectives(instance.model, None))
    steps = instance.model.steps(variables, data)
    designs, rows = [], dict[str, dict[str, Any]]()
    for k in list(dict.fromkeys(chosen))[:few]:
        parts, _, choices = instance.combinations.describe(int(numbers[k]))
        filled = {slot: part_row(table, index) for slot, (table, index) in parts.items()}
        made = make_design(instance, frame, variables[k], result, k, filled, choices, steps=DesignSteps(steps[k]))
        designs.append(made)
        for slot, row in filled.items():
            rows.setdefault(slot, {})[str(row)] = row
    return Sample(calculation, designs, {slot: list(found.values()) for slot, found in rows.items()})


def like(calculation: Calculation, design: Design) -> Change:
    """Return what is typed to make a design of another one."""
    kinds = {q.name: q.kind for q in calculation.quantities.values()}
    numbers = {name: value for name, value in design.values.items() if kinds.get(name) in ("variable", "count")}
    return Change(numbers, dict(design.choices), {slot: str(row) for slot, row in design.parts.items()})


def other_requirements(sampled: Sample, rng: np.random.Generator, share: float = 0.5) -> Change:
    """Return requirements within their bounds that differ from those of a design."""
    found, design = Change(), sampled.designs[0]
    for q in sampled.calculation.quantities.values():
        if q.kind == "requirement" and rng.random() < share:
            value = design.frame.requirement_values[q.name] * rng.uniform(0.8, 1.25)
            low, high = q.bounds or (-math.inf, math.inf)
            if low <= value <= high:
                found.numbers[q.name] = value
    return found


def broken(sampled: Sample, guard: str, rng: np.random.Generator, tries: int = 400) -> Change | None:
    """Return sizes and requirements within their bounds for which a guard fails; None where none are found."""
    calculation, design = sampled.calculation, sampled.designs[0]
    quantities = calculation.quantities
    rule = next(x for x in calculation.limits if x.name == guard)
    behind, left = set[str](), [*names_in(rule.value), *names_in(rule.limit)]
    while left:
        q = quantities[left.pop()]
        if q.name not in behind:
            behind.add(q.name)
            left += names_in(q.expression) if q.computed else ()
    free = [q for q in quantities.values() if q.kind in ("requirement", "variable") and q.name in behind]
    own = calculation.inputs(design)
    for _ in range(tries):
        change = Change()
        for q in free:
            if rng.random() < 0.4:
                value = own[q.name] * 10 ** rng.uniform(-1, 1)
                low, high = q.bounds or (-math.inf, math.inf)
                change.numbers[q.name] = min(max(value, low), high)
        inputs = own | change.numbers
        values = dict(inputs)
        for q in quantities.values():
            if q.computed and q.name in behind:
                values[q.name] = value_of(q.expression, values)
        missed = residual(value_of(rule.value, values), value_of(rule.limit, values), rule.sense, rule.scale)
        if missed >= 0 and math.isfinite(missed):
            return change
    return None


def expected(sampled: Sample, design: Design, change: Change) -> tuple[dict[str, float], CalculatedDesign]:
    """Return the inputs of a design after a change, and what the engine's formulas give."""
    calculation = sampled.calculation
    parts = {
        slot: next(row for row in sampled.rows[slot] if str(row) == change.parts.get(slot, str(own)))
        for slot, own in design.parts.items()
    }
    changed = replace(design, parts=parts, choices={**design.choices, **change.labels})
    inputs = calculation.inputs(changed) | change.numbers
    for q in calculation.quantities.values():  # defaults that follow do so unless they were stated
        typed = q.name in change.numbers or q.name in design.frame.requirements
        if q.kind == "requirement" and q.expression is not None and not typed:
            inputs[q.name] = value_of(q.expression, inputs)
    return inputs, calculation.outcome(inputs)


class Places:
    """Where a workbook has its inputs and results, by sheet and address."""

    def __init__(self, content: bytes, calculation: Calculation) -> None:
        self.calculation = calculation
        self.book = openpyxl.load_workbook(io.BytesIO(content))
        names, _ = legal_names(calculation)
        self.si = {name: self._of(self.book.defined_names[legal].attr_text) for name, legal in names.items()}
        self.limit_rows = {x.name: row for row, x in enumerate(calculation.limits, start=2)}

    def _of(self, text: str) -> tuple[str, str]:
        sheet, address = text.replace("$", "").split("!")
        return sheet, address

    def shown(self, name: str) -> tuple[str, str]:
        sheet, address = self.si[name]
        return sheet, "ABCDEFG"[VALUE] + address[1:]

    def typed(self, change: Change) -> dict[tuple[str, str], Any]:
        """Return what stands in which cell after a change."""
        quantities = self.calculation.quantities
        cells: dict[tuple[str, str], Any] = {
            self.shown(name): float(from_si(value, quantities[name].unit or "-"))
            for name, value in change.numbers.items()
        }
        cells |= {self.shown(name): label for name, label in change.labels.items()}
        slot = ""
        for row in self.book["Parts"].iter_rows(min_row=2):
            if row[0].value == "designation":
                slot = str(self.book["Parts"].cell(row[0].row - 1, 1).value)
                if slot in change.parts:
                    cells["Parts", f"C{row[0].row}"] = change.parts[slot]
        return cells


def compared(places: Places, found: CalculatedDesign, cell: Callable[[str, str], Any]) -> tuple[float, list[str]]:
    """Return the largest relative difference of quantities and shares, and what differs altogether.

    Parameters
    ----------
    cell : callable
        Sheet and address -> number, text, or None where there is an error.
    """
    worst, wrong = 0.0, list[str]()

    def near(what: str, value: float, told: Any) -> None:
        nonlocal worst
        if not math.isfinite(value):
            if isinstance(told, (int, float)):
                wrong.append(f"{what}: {told}, not {value}")
        elif not isinstance(told, (int, float)):
            wrong.append(f"{what}: {told}, not {value}")
        else:
            worst = max(worst, abs(told - value) / max(abs(value), abs(told)) if told != value else 0.0)

    for name, value in found.values.items():
        near(name, value, cell(*places.si[name]))
    for name, verdict in found.verdicts.items():
        row = places.limit_rows[name]
        used = cell("Limits", f"{'ABCDEFG'[USED]}{row}")
        words = str(cell("Limits", f"{'ABCDEFG'[VERDICT]}{row}"))
        if verdict.used is None or math.isinf(verdict.used):
            shown = "–" if verdict.used is None else "∞"
            if used != shown:
                wrong.append(f"limit {name}: used {used}, not {shown}")
        else:
            near(f"limit {name}", verdict.used, used)
        judged = HOLDS if verdict.holds else VIOLATED
        start = UNCHECKED if verdict.void else UNDECIDED if verdict.failed else judged
        if not words.startswith(start) or (verdict.failed and not verdict.void and verdict.failed[0] not in words):
            wrong.append(f"limit {name}: {words}, not {start} {verdict.failed}")
    return worst, wrong


def workbook_of(sampled: Sample, **more: Any) -> bytes:
    return live_workbook(sampled.calculation, sampled.designs[0], sampled.rows, **more)
