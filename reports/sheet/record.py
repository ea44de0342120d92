"""A calculation sheet for programs: formulas, numbers, verdicts and branches as plain JSON."""

from __future__ import annotations

import math
from typing import Any

from synth.results import Design
from synth.results.calculation import Calculation
from synth.results.expression import in_force

SHEET_FORMAT = 1


def sheet_record(calculation: Calculation, design: Design) -> dict[str, Any]:
    """Return everything that a sheet says of a design, with all digits.

    Parameters
    ----------
    calculation : Calculation
    design : Design

    Returns
    -------
    dict
        ``format``, ``calculation`` (as calculation.json), ``values_si`` (None where a quantity does not exist),
        ``limits`` (name, both sides in SI, void, failed guards, share used, verdict) and ``branches`` (which case of
        which quantity is in force).

    Raises
    ------
    InputError
        A recorded value differs from what its formula gives.
    """
    outcome = calculation.of_design(design)
    branches = []
    for q in calculation.quantities.values():
        if q.computed and q.expression is not None and not math.isnan(outcome.values[q.name]):
            for condition, answer in in_force(q.expression, outcome.values)[1]:
                branches.append({"quantity": q.name, "condition": condition, "holds": answer})
    limits = [
        {
            "name": name,
            "value_si": _number(verdict.value),
            "limit_si": _number(verdict.limit),
            "void": verdict.void,
            "failed_guards": list(verdict.failed),
            "used": None if verdict.used is None else _number(verdict.used),
            "holds": verdict.holds,
        }
        for name, verdict in outcome.verdicts.items()
    ]
    return {
        "format": SHEET_FORMAT,
        "family": calculation.family,
        "rank": design.rank,
        "status": design.status.value,
        "calculation": calculation.content,
        "values_si": {name: _number(value) for name, value in outcome.values.items()},
        "limits": limits,
        "branches": branches,
    }


def _number(value: float) -> float | str | None:
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else ("inf" if value > 0 else "-inf")
