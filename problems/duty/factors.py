"""Application factors of the tables: what a driver, a driven machine and a switching rate ask of a clutch."""

from __future__ import annotations

from typing import Any

import numpy as np

from synth.declaration import Declaration

TABLE = "application_factors"
BY_CLASS, CLASS_OF, BY_MACHINE = "coupling_service_AGMA514", "application_class_AGMA514", "moment_safety_by_machine"
BY_RATE = "c_m_engagements"
HOUR = 3600.0  # s; ends of the bins are in 1/h
AT_END = 1 + 1e-9  # the upper end belongs to its bin, whatever the digits of a conversion


def drivers(d: Declaration) -> tuple[str, ...]:
    """Classes of drivers that have a shock factor."""
    return tuple(dict.fromkeys(_of(d, "driver_class")[k] for k in _rows(d, BY_CLASS)))


def machines(d: Declaration) -> tuple[str, ...]:
    """Classes of driven machines, and machines by name, that have a shock factor."""
    return tuple(dict.fromkeys(_of(d, "driven_class")[k] for k in _rows(d, BY_CLASS, CLASS_OF, BY_MACHINE)))


def rows_of(d: Declaration, driver: str, machine: str) -> list[int]:
    """Row of a driver and the class of a machine, or both ends of the range that a machine has whatever drives it."""
    driver_of, driven, note = (_of(d, column) for column in ("driver_class", "driven_class", "note"))
    if ends := [k for k in _rows(d, BY_MACHINE) if driven[k] == machine]:
        return ends
    classes = {driven[k]: note[k].removeprefix("class ") for k in _rows(d, CLASS_OF)}
    return [k for k in _rows(d, BY_CLASS) if (driver_of[k], driven[k]) == (driver, classes.get(machine, machine))]


def shock_factor(d: Declaration, driver: str, machine: str) -> float:
    """Shock factor of the load: that of the row, or the mean of a range."""
    return float(np.mean(d.numbers(TABLE, "factor")[rows_of(d, driver, machine)]))


def source_of_shock(d: Declaration, driver: str, machine: str) -> str:
    """Rows that the shock factor is read from."""
    names = [d.designations(TABLE)[k] for k in rows_of(d, driver, machine)]
    return f"table {TABLE}, {'mean of ' * (len(names) > 1)}{' and '.join(names)}"


def switching_factor(d: Declaration, rate: Any) -> Any:
    """Engagement-count factor of a switching rate [1/s]."""
    *bins, above = _rows(d, BY_RATE)
    factors, ends = d.numbers(TABLE, "factor"), d.numbers(TABLE, "parameter_to")
    result = factors[above]
    for k in reversed(bins):
        result = np.where(rate * HOUR <= AT_END * ends[k], factors[k], result)
    return result


def _rows(d: Declaration, *tables: str) -> list[int]:
    return [k for table in tables for k, name in enumerate(_of(d, "table")) if name == table]


def _of(d: Declaration, column: str) -> tuple[str, ...]:
    return d.catalogs.table(TABLE).text(column)
