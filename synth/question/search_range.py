"""The range of the unknowns that is searched, and given designs that lie outside of it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from synth.declaration import Count, VariableRecord
from synth.errors import InputError
from synth.order.margins import MARGINS, within
from synth.text.numbers import typed_number
from synth.units import typed_quantity

if TYPE_CHECKING:
    from synth.model.model import Evaluation, Model


def shown_range(unknown: VariableRecord | Count) -> str:
    """Return the range in which an unknown is searched, in words.

    Examples
    --------
    >>> import synth
    >>> model = synth.load("multi_plate_clutch").model(frozenset(), synth.question.catalogs.as_catalogs(None))
    >>> shown_range(model.declaration.counts["friction_surfaces"])
    '2 to 60 in steps of 2'
    """
    low, high = _ends(unknown)
    first, last = typed_quantity(low, unknown.unit), typed_quantity(high, unknown.unit)
    text = first if low == high else f"{first} to {last}"
    steps = _steps(unknown)
    return f"{text} in steps of {typed_number(steps[1] - steps[0])}" if len(steps) > 1 else text


def outside(model: Model, values: Mapping[str, float]) -> dict[str, str]:
    """Return the variables and counts that lie outside of what is searched, each with the range that is.

    Parameters
    ----------
    values : mapping
        Variables and counts by name in SI.
    """
    result = {}
    for unknown in _unknowns(model):
        value, (low, high) = values[unknown.name], _ends(unknown)
        inside = within(value, low, high, MARGINS.end)
        steps = _steps(unknown)
        if not inside or (len(steps) and np.min(np.abs(steps - value)) > MARGINS.step):
            result[unknown.name] = f"{typed_quantity(value, unknown.unit)}, searched is {shown_range(unknown)}"
    return result


def refuse_other_sign(model: Model, values: Mapping[str, float]) -> None:
    """Refuse sizes and counts on the other side of zero than all that is searched: there are none such.

    Raises
    ------
    InputError
    """
    for unknown in _unknowns(model):
        value, (low, high) = values.get(unknown.name, math.nan), _ends(unknown)
        zero = typed_quantity(0.0, unknown.unit)
        for wrong, expected in (
            (low > 0 >= value, f"above {zero}"),
            (low == 0 > value, f"at least {zero}"),
            (high < 0 <= value, f"below {zero}"),
            (high == 0 < value, f"at most {zero}"),
        ):
            if wrong:
                shown = typed_quantity(value, unknown.unit)
                right = f"a value {expected} (searched is {shown_range(unknown)})"
                raise InputError(f"values: {unknown.name}", shown, right, ("values", unknown.name))


def refuse_not_computable(
    model: Model, result: Evaluation, told: Mapping[str, str], variables: np.ndarray, data: Sequence[float]
) -> None:
    """Refuse values outside of the range for which some formula has no number that it has at the end of the range.

    Parameters
    ----------
    result : Evaluation
        Of the one design.
    told : mapping
        What ``outside`` returned.
    variables : array (variables,)
        SI.
    data : list of numbers
        The data inputs.

    Raises
    ------
    InputError
    """
    lost = [name for name, value in result.values.items() if not math.isfinite(value[0])]
    if not told or not lost:
        return
    ends = np.array([min(max(x, v.lower), v.upper) for v, x in zip(model.variables, variables, strict=True)])
    counts, within = model.declaration.counts, list(data)
    for k, entry in enumerate(model.data_inputs):
        if entry.kind == "count":
            steps = counts[entry.name].values
            within[k] = float(steps[np.argmin(np.abs(steps - data[k]))])
    nearest = model.evaluate(ends[None, :], within)
    for name in lost:
        # A guard that fails tells why in its own words.
        guarded = any(not result.holds[guard][0] for guard in model.guards_of(name))
        if math.isfinite(nearest.values[name][0]) and not guarded:
            expected = f"values for which {name} can be computed"
            path = ("values", *told) if len(told) == 1 else ("values",)
            raise InputError(f"values: {', '.join(told)}", "; ".join(told.values()), expected, path)


def widened(unknowns: Sequence[VariableRecord], factor: float) -> tuple[np.ndarray, np.ndarray]:
    """Return ranges that reach further than what is searched, by a factor or by as many spans; signs are kept.

    Parameters
    ----------
    unknowns : list of VariableRecord
    factor : float
        How much further.
    """
    low, high = (np.array(ends) for ends in zip(*(_ends(v) for v in unknowns), strict=True))
    span = high - low
    least = np.where(low > 0, low / factor, np.where(low == 0, 0.0, low - factor * span))
    most = np.where(high < 0, high / factor, np.where(high == 0, 0.0, high + factor * span))
    return least, most


def _unknowns(model: Model) -> list[VariableRecord | Count]:
    return [*model.variables, *model.declaration.counts.values()]


def _ends(unknown: VariableRecord | Count) -> tuple[float, float]:
    steps = _steps(unknown)
    return (
        (unknown.lower, unknown.upper) if isinstance(unknown, VariableRecord) else (float(steps[0]), float(steps[-1]))
    )


def _steps(unknown: VariableRecord | Count) -> np.ndarray:
    """Return the values of a count; a variable has none."""
    return np.empty(0) if isinstance(unknown, VariableRecord) else unknown.values
