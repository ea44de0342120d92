"""How many digits the sizes of a design need where people read them: the fewest that say the same design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from synth.model.model import Evaluation
from synth.order.margins import MARGINS, within
from synth.question.search_space import SearchSpace
from synth.units import parse_quantity, written_quantity

DIGITS = (6, 7, 8, 9, 10, 12)  # that are tried
ALL = 0  # of them
AGREE = 2e-10  # relative; objectives that agree so far are the same for whoever checks what is saved


def written_digits(
    space: SearchSpace, points: np.ndarray, data: Sequence[Any], result: Evaluation, objectives: Sequence[str]
) -> list[int]:
    """Return, per design, how many significant digits its variables need so that it stays what it is.

    With these every limit stands as it does, nothing else is void or remarked on, gridded variables have the values of
    their grids, and no objective moves.

    Parameters
    ----------
    space : SearchSpace
    points : array (designs, variables)
        SI.
    data : list of numbers or arrays (designs,)
        As for ``space.evaluate``.
    result : Evaluation
        Of these.
    objectives : list of str
    """
    needed = [ALL] * len(points)
    if not len(points):
        return needed
    before = result.also(space.limits.bounding)
    open_rows = np.arange(len(points))
    for digits in DIGITS:
        chosen = points[open_rows]
        rounded = _rounded(space, chosen, digits)
        inputs = [entry[open_rows] if np.ndim(entry) else entry for entry in data]
        after = space.evaluate(rounded, inputs).also(space.limits.bounding)
        same = _searched(space, rounded) | ~_searched(space, chosen)
        for k, variable in enumerate(space.model.variables):
            if len(variable.grid):
                same &= np.abs(rounded[:, k] - chosen[:, k]) <= MARGINS.conversion * np.abs(chosen[:, k])
        for was, is_now in ((before.holds, after.holds), (before.void, after.void), (before.advice, after.advice)):
            same &= _alike(was, is_now, open_rows)
        for name in objectives:
            value = before.values[name][open_rows]
            same &= ~(np.abs(after.values[name] - value) > AGREE * np.abs(value))
        for row in open_rows[same].tolist():
            needed[row] = digits
        open_rows = open_rows[~same]
        if not len(open_rows):
            break
    return needed


def _rounded(space: SearchSpace, points: np.ndarray, digits: int) -> np.ndarray:
    """Points whose variables are written with so many digits."""
    return np.array(
        [
            [
                parse_quantity(written_quantity(float(x), variable.unit, digits), variable.unit, variable.name)
                for x, variable in zip(point, space.model.variables, strict=True)
            ]
            for point in points
        ]
    ).reshape(points.shape)


def _searched(space: SearchSpace, points: np.ndarray) -> np.ndarray:
    """Tell which points lie in the range that is searched."""
    inside: np.ndarray = np.all(within(points, space.ranges.lower, space.ranges.upper, MARGINS.end), axis=1)
    return inside


def _alike(was: Mapping[Any, np.ndarray], is_now: Mapping[Any, np.ndarray], rows: np.ndarray) -> np.ndarray:
    """Tell for which designs all of these are as they were."""
    same = np.ones(len(rows), dtype=bool)
    for key, before in was.items():
        same &= before[rows] == is_now[key]
    return same
