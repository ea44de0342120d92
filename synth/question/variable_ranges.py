"""Ranges and makeable values of the variables, as the family declares them and a question narrows them."""

from __future__ import annotations

from collections.abc import Sequence

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

    Attributes
    ----------
    lower, upper : array (variables,)
        SI.
    pinned : array of bool (variables,)
        Which are given by the user as one value, makeable or not.
    """

    def __init__(self, variables: Sequence[VariableRecord], grid: bool) -> None:
        self.variables, self.grid = list(variables), grid
        self.lower = np.array([v.lower for v in variables])
        self.upper = np.array([v.upper for v in variables])
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
        if limit.sense in ("at_most", "equal"):
            self.upper[k] = min(self.upper[k], limit.bound)
        if limit.sense in ("at_least", "equal"):
            self.lower[k] = max(self.lower[k], limit.bound)
        if self.lower[k] > self.upper[k]:
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
        self.lower[k] = self.upper[k] = value
        self.pinned[k] = True

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
