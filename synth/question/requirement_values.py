"""Values of the requirements of a question in SI: as given, or from defaults, which may be made of others."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from synth.declaration import RequirementRecord
from synth.errors import InputError, at
from synth.model.model import Model
from synth.order.margins import MARGINS, within
from synth.question.inputs import fixed_designation, fixed_row_values
from synth.tables.catalogs import Catalogs
from synth.units import TORQUE_OF_POWER, Quantity, from_si, parse_quantity, parse_unit, typed_quantity


@dataclass(frozen=True, kw_only=True, eq=False)
class RequirementValues:
    """The numbers of a question that it fixes: of requirements, and of rows that are always used.

    Parameters
    ----------
    requirements : mapping
        Requirement in force -> SI value.
    given : frozenset of str
        The requirements that were stated; the others have their default.
    not_asked : tuple of str
        Optional requirements that were not stated: they are not in force.
    rows : mapping
        Symbol of a column of a row that is always used -> SI value.
    """

    requirements: Mapping[str, float]
    given: frozenset[str]
    not_asked: tuple[str, ...]
    rows: Mapping[str, float]

    @classmethod
    def read(cls, model: Model, catalogs: Catalogs, asked: Mapping[str, object]) -> RequirementValues:
        """Return the values that a question states.

        Parameters
        ----------
        model : Model
            Traced for the requirements that are asked.
        catalogs : Catalogs
        asked : mapping
            Requirement by public name -> text with unit, or bare number in the declared unit.

        Raises
        ------
        InputError
            A value is missing or outside its range, or a row that is always used lacks a number.
        """
        rows = _complete_rows(model, catalogs)
        left_out = tuple(r.name for r in model.declaration.requirements.values() if r.sx is None)
        return cls(requirements=_numbers(model, asked, rows), given=frozenset(asked), not_asked=left_out, rows=rows)

    def by_symbol(self, model: Model) -> dict[str, float]:
        """Return the values by their symbols in the model."""
        symbols = model.requirement_symbols
        return {**{symbols[name]: value for name, value in self.requirements.items()}, **self.rows}

    def ranges(self, model: Model) -> dict[str, tuple[float, float]]:
        """Ranges in SI of the variables that are searched within a range made of requirements."""
        known, within = self.by_symbol(model), {v.name: v.within for v in model.variables if v.within is not None}
        return {name: (model.number(low, known), model.number(high, known)) for name, (low, high) in within.items()}

    def moved(self, model: Model, name: str, value: float) -> RequirementValues:
        """Return the same with another value of one requirement, and of those whose default is made of it.

        Whether the family refuses that is not asked here.

        Parameters
        ----------
        model : Model
        name : str
        value : float
            SI.

        Raises
        ------
        InputError
            When one of them leaves its range.
        """
        declared = model.declaration.requirements
        stated = {n: self.requirements[n] for n in self.given} | {name: value}
        asked = {n: Quantity(v, declared[n].unit) for n, v in stated.items()}
        return RequirementValues(
            requirements=_numbers(model, asked, self.rows),
            given=self.given | {name},
            not_asked=self.not_asked,
            rows=self.rows,
        )


def _complete_rows(model: Model, catalogs: Catalogs) -> dict[str, float]:
    """Return the numbers of rows that are always used; refuse those that lack one."""
    values = fixed_row_values(model.declaration, catalogs)
    for row in model.declaration.rows.values():
        for key, column in row.columns.items():
            if column.required and math.isnan(values[str(column.sx)]):
                designation = fixed_designation(row.slot)
                where = f"table {row.table}, row {designation}, column {key}"
                raise InputError(where, None, "a number", ("catalogs", row.table, designation, key))
    return values


def _numbers(model: Model, asked: Mapping[str, object], rows: Mapping[str, float]) -> dict[str, float]:
    """Return the SI value of every requirement in force; defaults are made of what stands before them."""
    values = dict[str, float]()
    for r in model.declaration.requirements.values():
        if r.sx is None:
            continue
        if r.name in asked:
            values[r.name] = value_of(r, asked[r.name])
        elif r.default is None:
            raise missing(r)
        elif isinstance(r.default, float):
            values[r.name] = r.default
        else:
            known = {**{model.requirement_symbols[n]: v for n, v in values.items()}, **rows}
            values[r.name] = model.number(r.default, known)
    return values


def value_of(r: RequirementRecord, typed: object) -> float:
    """Value of a requirement as typed, in SI.

    Raises
    ------
    InputError
        It is no such quantity, or outside of the range.
    """
    with at("requirements", r.name):
        value = parse_quantity(typed, r.unit, f"requirement {r.name}")
        _check_range(r, typed, value)
    return value


def missing(r: RequirementRecord) -> InputError:
    """Message for a requirement that must be stated and is not."""
    others = f"; from a power, {TORQUE_OF_POWER}" if parse_unit(r.unit).kind == "torque" else ""
    if r.instead:
        others = f", or {' or '.join(r.instead)} in its place"
    right = f"a value in {r.unit}, for example {_example(r)}{others}"
    return InputError(f"requirement {r.name}", None, right, ("requirements", r.name))


def _example(requirement: RequirementRecord) -> str:
    """Return a value that may be typed: the middle of the range, rounded; of one that begins at 0, from 1 on."""
    low, high = (from_si(x, parse_unit(requirement.unit)) for x in (requirement.lower, requirement.upper))
    low = low if np.isfinite(low) and low > 0 else min(1.0, high)
    shown = float(f"{math.sqrt(low * (high if np.isfinite(high) else low)):.1g}")
    return f"'{shown:g} {requirement.unit}'"


def _check_range(r: RequirementRecord, typed: object, value: float) -> None:
    if within(value, r.lower, r.upper, MARGINS.conversion):
        return
    low, high = typed_quantity(r.lower, r.unit), typed_quantity(r.upper, r.unit)
    if np.isfinite(r.lower) and np.isfinite(r.upper):
        expected = f"{low} to {high}"
    else:
        expected = f"at least {low}" if np.isfinite(r.lower) else f"at most {high}"
    raise InputError(f"requirement {r.name}", typed, expected)
