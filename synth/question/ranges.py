"""Ranges of requirements and columns, as declared and as tables give them."""

from __future__ import annotations

import math

import numpy as np

from synth.declaration import Declaration
from synth.model.model import DataInput, Model
from synth.question.inputs import fixed_designation, part_value
from synth.question.offers import offers
from synth.tables.catalogs import Catalogs


def declared_ranges(model: Model, catalogs: Catalogs) -> tuple[np.ndarray, np.ndarray]:
    """Return the range that is declared for every input of a model's program, in SI.

    Parameters
    ----------
    model : Model
    catalogs : Catalogs
        The tables whose rows fill the slots.

    Returns
    -------
    tuple of arrays (inputs,)
        Least and largest value: bounds, steps, and columns over the rows that a slot offers; not-a-number for a
        column that no row has.
    """
    variables = [(v.lower, v.upper) for v in model.variables]
    ranges = np.array(variables + [_data_range(e, model.declaration, catalogs) for e in model.data_inputs], dtype=float)
    return ranges[:, 0], ranges[:, 1]


def _data_range(entry: DataInput, d: Declaration, tables: Catalogs) -> tuple[float, float]:
    if entry.kind == "requirement":
        return d.requirements[entry.name].lower, d.requirements[entry.name].upper
    if entry.kind == "count":
        return float(d.counts[entry.name].values[0]), float(d.counts[entry.name].values[-1])
    if entry.kind == "choice":
        return 0.0, len(d.choices[entry.name].labels) - 1.0
    if entry.kind == "row":
        part = d.rows[entry.name]
        table = tables.table(part.table)
        rows = np.array([table.row_index(fixed_designation(part.slot))])
    else:
        part = d.slots[entry.name]
        table = tables.table(part.table)
        rows = np.flatnonzero(offers(part, table))
    values = part_value(table, rows, entry.columns)
    present = values[~np.isnan(values)]
    return (float(present.min()), float(present.max())) if len(present) else (math.nan, math.nan)
