"""The values of a program's data inputs: the one place that knows where a number of the model comes from."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from synth.declaration import Declaration
from synth.model.model import DataInput, Model
from synth.model.program import InputValue
from synth.question.combinations import Combinations
from synth.tables.catalogs import Catalogs
from synth.tables.table import Table


def part_value(table: Table, rows: np.ndarray | Sequence[int] | slice, columns: Sequence[str]) -> np.ndarray:
    """Return a column of some rows of a table, or the first of several columns that has a value, row by row.

    Parameters
    ----------
    table : Table
    rows : array of int, or slice
    columns : list of str
        Names or symbols; those that the table has not are without values.

    Returns
    -------
    array (rows,)
        SI; not-a-number where no column has a value.
    """
    none = np.full(len(table), np.nan)[rows]
    return first_value([table.number(c)[rows] if table.has(c) else none for c in columns])


def first_value(numbers: Sequence[np.ndarray]) -> np.ndarray:
    """Return the first of several columns, or the next one that has a value, row by row."""
    result = numbers[0]
    for other in numbers[1:]:
        result = np.where(np.isnan(result), other, result)
    return result


def fixed_row_values(d: Declaration, catalogs: Catalogs) -> dict[str, float]:
    """Return the SI values of the columns of rows that are always used, by their symbols in the model."""
    values: dict[str, float] = {}
    for row in d.rows.values():
        table = catalogs.table(row.table)
        index = table.row_index(fixed_designation(row.slot))
        values |= {str(c.sx): float(part_value(table, [index], c.columns)[0]) for c in row.columns.values()}
    return values


def fixed_designation(slot: str) -> str:
    """Return the designation of a row that is always used."""
    return slot.split(":", 1)[1]


def inputs_of(
    model: Model,
    requirements: Mapping[str, InputValue],
    rows: Mapping[str, InputValue],
    unknown: Callable[[DataInput], InputValue],
) -> list[InputValue]:
    """Return the data inputs of a model, in its order.

    Parameters
    ----------
    model : Model
    requirements : mapping
        Requirement -> SI value, or an array of such.
    rows : mapping
        Symbol of a column of a fixed row -> SI value, or an array of such.
    unknown : callable
        Returns the value of an input that belongs to a slot, count or choice.

    Returns
    -------
    list
        Numbers or arrays, as they were given.
    """

    def value(entry: DataInput) -> InputValue:
        if entry.kind == "requirement":
            return requirements[entry.name]
        return rows[str(entry.sx)] if entry.kind == "row" else unknown(entry)

    return [value(entry) for entry in model.data_inputs]


def inputs_of_combination(
    model: Model,
    requirements: Mapping[str, InputValue],
    rows: Mapping[str, InputValue],
    combinations: Combinations,
    numbers: np.ndarray,
) -> list[InputValue]:
    """Return the data inputs of a model for some combinations.

    Parameters
    ----------
    model, requirements, rows
        As for :func:`inputs_of`.
    combinations : Combinations
    numbers : array of int (combinations,)

    Returns
    -------
    list
        Arrays (combinations,) where an input belongs to a slot, count or choice.
    """
    digits = dict(zip(combinations.names, combinations.digits(numbers), strict=True))
    return inputs_of(
        model, requirements, rows, lambda entry: combinations.column(entry.name, entry.column)[digits[entry.name]]
    )


def inputs_of_design(
    model: Model,
    requirements: Mapping[str, float],
    rows: Mapping[str, float],
    values: Mapping[str, float],
    choices: Mapping[str, str],
    part: Callable[[DataInput], float],
) -> list[float]:
    """Return the data inputs of a model for one design.

    Parameters
    ----------
    model, requirements, rows
        As for :func:`inputs_of`.
    values : mapping
        Count -> value.
    choices : mapping
        Choice -> label.
    part : callable
        Returns the SI value of a column of a slot: from the design, or from a table.
    """

    def unknown(entry: DataInput) -> float:
        if entry.kind == "count":
            return values[entry.name]
        if entry.kind == "choice":
            return model.declaration.choices[entry.name].labels.index(choices[entry.name])
        return part(entry)

    return [float(x) for x in inputs_of(model, requirements, rows, unknown)]
