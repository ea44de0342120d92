"""Design records of a search or of an evaluation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.declaration import VariableRecord
from synth.model.model import Evaluation, Model
from synth.model.next_rows import rows_read
from synth.order.feasibility import Status, utilisation
from synth.order.margins import MARGINS
from synth.question.count_domain import stated
from synth.question.inputs import fixed_designation
from synth.question.instance import Instance
from synth.question.search_space import SearchSpace
from synth.question.selection import part_row
from synth.results import Design, Frame, PartRow
from synth.results.next_row import NextRow
from synth.results.provenance import joined
from synth.results.record import UNSET
from synth.results.statistics import SearchStatistics
from synth.units import typed_quantity


def make_frame(instance: Instance, objectives: Mapping[str, str]) -> Frame:
    """Data that all designs of one question share."""
    model, d = instance.model, instance.model.declaration
    return Frame(
        family=instance.problem.name,
        title=instance.problem.title or instance.problem.name,
        options={
            name: o.chosen for name, o in d.options.items() if o.chosen != o.default or name in instance.problem.options
        },
        requirements={
            name: typed_quantity(instance.values.requirements[name], d.requirements[name].unit, None)
            for name in d.requirements
            if name in instance.values.given
        },
        requirement_values=dict(instance.values.requirements),
        not_asked=tuple(instance.values.not_asked),
        objectives=dict(objectives),
        units=dict(model.units),
        kinds={name: kind for name, _, kind in d.quantities()},
        limit_units={x.name: x.unit for x in instance.constraints},
        limit_senses={x.name: x.sense for x in instance.constraints},
        restated=_repeated_entries(instance),
        headline=d.headlines.shown,
        sized_by=d.headlines.sized_by,
        tables={name: joined(instance.catalogs.table(name).hashes) for name in instance.catalogs.user_tables},
    )


def _repeated_entries(instance: Instance) -> dict[str, Any]:
    """Entries that DESIGN.yaml repeats for a check: limits and user tables, without those in memory."""
    entries: dict[str, Any] = dict(instance.problem.restated)
    if instance.limits.as_typed:
        entries["limits"] = stated(instance.limits.as_typed)
    files = instance.catalogs.files()
    if files:
        entries["catalogs"] = files
    return entries


def make_design(
    instance: Instance,
    frame: Frame,
    variables: np.ndarray,
    result: Evaluation,
    row: int,
    parts: Mapping[str, PartRow],
    choices: Mapping[str, str],
    **more: Any,
) -> Design:
    """Return one design of a batch that has been evaluated.

    Parameters
    ----------
    variables : array (variables,)
        SI.
    result : Evaluation
    row : int
        Which of the batch it is.
    parts, choices : mapping
        What fills the slots and choices.
    **more
        Fields of Design that the search knows (gap, elasticity, ...).
    """
    (record,) = design_records(instance, result, variables[None, :], [row])
    return design_of(frame, record, parts, choices, more)


def design_of(
    frame: Frame,
    record: Mapping[str, Any],
    parts: Mapping[str, PartRow],
    choices: Mapping[str, str],
    more: Mapping[str, Any],
) -> Design:
    """Design of the record of its evaluation and what the search adds."""
    known = {"status": Status.INFEASIBLE if record["violated"] else Status.FEASIBLE, **record, **more}
    known["advice"] = (*record["advice"], *known.pop("remarks", ()))
    objectives = {name: record["values"][name] for name in frame.objectives}
    return Design(frame=frame, parts=dict(parts), choices=dict(choices), objectives=objectives, **known)


def design_records(
    instance: SearchSpace, result: Evaluation, points: np.ndarray, rows: Sequence[int]
) -> list[dict[str, Any]]:
    """Fields of ``Design`` of some rows of an evaluation, at these variables."""
    model, at = instance.model, np.asarray(rows, dtype=np.int64)
    count = len(at)
    sides = {n: (value[at], bound[at]) for n, (value, bound) in result.limits.items()}
    senses = {x.name: x.sense for x in instance.constraints}
    residuals = {n: r[at] for n, r in result.residuals.items()}
    broken = [(x.name, ~result.holds[x.name][at]) for x in instance.constraints]
    with np.errstate(all="ignore"):
        used = {
            name: _where_known(utilisation(value, bound, senses[name]), residuals[name])
            for name, (value, bound) in sides.items()
        }
    void = [(x, gone) for x in instance.constraints if (gone := result.void[x.name][at]).any()]
    lacking = [", ".join(model.data_inputs[k].label for k in x.void_without) for x, _ in void]
    unchecked = [
        (f"not checked: {x.name}, no {columns}", gone) for (x, gone), columns in zip(void, lacking, strict=True)
    ]
    advice = [
        (_message(a.code, a.message, a.source), result.advice[k][at]) for k, a in enumerate(model.declaration.advices)
    ]
    pairs = {n: list(zip(value.tolist(), bound.tolist(), strict=True)) for n, (value, bound) in sides.items()}
    fields = {
        "values": _row_by_row({name: v[at].tolist() for name, v in result.values.items()}, count),
        "limits": _row_by_row(pairs, count),
        "residuals": _row_by_row({name: r.tolist() for name, r in residuals.items()}, count),
        "utilisation": _row_by_row(used, count),
        "advice": _which(advice, count),
        "violated": _which(broken, count),
        "not_checked": _which(unchecked, count),
        "off_grid": off_grid(model.variables, points),
    }
    return [dict(zip(fields, each, strict=True)) for each in zip(*fields.values(), strict=True)]


def _where_known(used: np.ndarray, residuals: np.ndarray) -> list[float | None]:
    """Used share of a limit per design; None where it does not exist."""
    return [None if gone else u for u, gone in zip(used.tolist(), np.isnan(residuals).tolist(), strict=True)]


def _row_by_row(columns: Mapping[str, Sequence[Any]], count: int) -> list[dict[str, Any]]:
    """Return a mapping per row for columns by name."""
    if not columns:
        return [{} for _ in range(count)]
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _which(masks: Sequence[tuple[str, np.ndarray]], count: int) -> list[tuple[str, ...]]:
    """Return, per row, the names whose mask holds there."""
    result: list[tuple[str, ...]] = [()] * count
    for name, mask in masks:
        for k in np.flatnonzero(mask).tolist():
            result[k] = (*result[k], name)
    return result


def offered(instance: Instance) -> SearchStatistics:
    """Choices left by a question, for the statistics of a front."""
    selection = instance.selection
    return SearchStatistics(
        combinations=instance.combinations.count,
        rows_offered={s.slot: selection.offered[s.slot] for s in selection.slots},
        rows_used={s.slot: len(s.rows) for s in selection.slots},
        counts={n: len(v) for n, v in selection.counts.items()},
        choices={n: len(v) for n, v in selection.choices.items()},
        rows_left_out=selection.left_out,
        combinations_left_out=instance.selection.combinations_left_out if instance.compared else UNSET,
        not_asked=list(instance.values.not_asked),
    )


def _message(code: str, message: str, source: str) -> str:
    return f"{code}: {message}" + (f" [{source}]" if source else "")


def off_grid(variables: Sequence[VariableRecord], points: np.ndarray) -> list[dict[str, str]]:
    """Return, per design, the variables that are off their grid, with the nearest makeable value."""
    result: list[dict[str, str]] = [{} for _ in points]
    for variable, values in zip(variables, points.T, strict=True):
        if len(variable.grid):
            nearest = variable.grid[np.argmin(np.abs(variable.grid - values[:, None]), axis=1)]
            for k in np.flatnonzero(np.abs(nearest - values) > MARGINS.step * np.abs(nearest)).tolist():
                makeable = typed_quantity(float(nearest[k]), variable.unit)
                result[k][variable.name] = f"nearest makeable {makeable}"
    return result


def lookup_rows(model: Model, next_rows: Mapping[str, NextRow]) -> tuple[PartRow, ...]:
    """Rows of user tables that a design reads in addition to its parts.

    Parameters
    ----------
    model : Model
    next_rows : mapping
        As the design tells them.
    """
    d, catalogs = model.declaration, model.declaration.catalogs
    if not catalogs.user_tables:
        return ()
    named = [(row.table, catalogs.table(row.table).row_index(fixed_designation(row.slot))) for row in d.rows.values()]
    for name, selected in next_rows.items():
        named += rows_read(d.next_rows[name], selected, catalogs)
    return tuple(part_row(catalogs.table(t), k) for t, k in dict.fromkeys(named) if t in catalogs.user_tables)
