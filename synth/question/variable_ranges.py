"""Ranges and makeable values of the variables, as the family declares them and a question narrows them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from synth.declaration import VariableRecord
from synth.errors import InputError
from synth.model.constraint import Constraint
from synth.order.margins import MARGINS, within
from synth.question.search_range import shown_range
from synth.units import typed_quantity


class VariableRanges:
    """The range of every variable in a question.

    Parameters
    ----------
    variables : list of VariableRecord
    grid : bool
        Whether only makeable values of gridded variables are asked for.
    within : mapping, optional
        Variable -> the range in SI that is searched inside its bounds.

    Attributes
    ----------
    lower, upper : array (variables,)
        SI.
    pinned : array of bool (variables,)
        Which are given by the user as one value, makeable or not.
    """

    def __init__(
        self,
        variables: Sequence[VariableRecord],
        grid: bool,
        within: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    ) -> None:
        self.variables, self.grid = list(variables), grid
        self._searched = np.array([_searched(v, within.get(v.name)) for v in variables], dtype=float).reshape(-1, 2)
        self.lower, self.upper = self._searched.T.copy()
        self._allowed = np.array([v.lower for v in variables]), np.array([v.upper for v in variables])
        self.pinned = np.zeros(len(variables), dtype=bool)
        self._number = {v.name: k for k, v in enumerate(variables)}

    def bound(self, limit: Constraint) -> None:
        """Let a limit on a variable be an end of its range; a limit on anything else changes nothing.

        Raises
        ------
        InputError
            When nothing of the range is left.
        """
        k = self._number.get(limit.quantity)
        if k is None:
            return
        least, most = self._allowed
        if limit.sense in ("at_most", "equal"):
            most[k] = min(most[k], limit.bound)
        if limit.sense in ("at_least", "equal"):
            least[k] = max(least[k], limit.bound)
        # What is asked counts where it leaves nothing of the range that is searched otherwise.
        low, high = self._searched[k]
        self.lower[k] = max(least[k], low) if low <= most[k] else least[k]
        self.upper[k] = min(most[k], high) if high >= least[k] else most[k]
        if least[k] > most[k]:
            v = self.variables[k]
            right = f"limits that leave something of {shown_range(v)}"
            raise InputError(f"limits: {v.name}", typed_quantity(limit.bound, v.unit), right)

    def pin(self, name: str, typed: object, value: float) -> None:
        """Let a variable have one value; any other name changes nothing.

        Parameters
        ----------
        name : str
        typed : object
            What the user wrote, for the message.
        value : float
            SI.

        Raises
        ------
        InputError
            When the value lies outside the declared range.
        """
        k = self._number.get(name)
        if k is None:
            return
        v = self.variables[k]
        if not within(value, v.lower, v.upper, MARGINS.conversion):
            raise InputError(f"fix: {v.name}", typed, shown_range(v))
        self.lower[k] = self.upper[k] = self._allowed[0][k] = self._allowed[1][k] = value
        self.pinned[k] = True

    def at_bounds(self, point: np.ndarray, reach: float) -> list[str]:
        """Variables that lie in a point at an end, other than zero, of what the family searches; ``reach`` relative."""
        near = np.isclose(point[:, None], self._searched, rtol=reach, atol=0.0).any(axis=1) & (self.lower < self.upper)
        return [v.name for v, at_end in zip(self.variables, near & (point != 0), strict=True) if at_end]

    def grids(self) -> list[np.ndarray]:
        """Return, per variable, the makeable values in force; empty where it is continuous.

        Raises
        ------
        InputError
            When a range holds no makeable value.
        """
        result = []
        for k, v in enumerate(self.variables):
            values = v.grid if self.grid and not self.pinned[k] else np.empty(0)
            inside = within(values, self.lower[k], self.upper[k], MARGINS.conversion)
            if len(values) and not inside.any():
                low, high = typed_quantity(self.lower[k], v.unit), typed_quantity(self.upper[k], v.unit)
                right = "a range that holds a makeable value (or grid: false)"
                raise InputError(f"limits: {v.name}", f"{low} .. {high}", right, ("limits", v.name))
            result.append(values[inside])
        return result


def _searched(variable: VariableRecord, within: tuple[float, float] | None) -> tuple[float, float]:
    """Range of a variable, its ends at powers of two, so that questions alike are searched over the same one."""
    if within is None:
        return variable.lower, variable.upper
    low, high = 2.0 ** np.floor(np.log2(within[0])), 2.0 ** np.ceil(np.log2(within[1]))
    return max(variable.lower, min(low, variable.upper)), min(variable.upper, max(high, variable.lower))
