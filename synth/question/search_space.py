"""What a search reads of what is asked, be it one question or several that are answered at once."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from synth.model.constraint import Constraint
from synth.model.model import Evaluation, Model
from synth.model.program import InputValue
from synth.question.combinations import Combinations
from synth.question.requirement_values import RequirementValues
from synth.question.selection import Selection
from synth.question.user_limits import UserLimits
from synth.question.variable_ranges import VariableRanges


class SearchSpace(ABC):
    """The designs among which a search looks, and what they are judged by.

    Parameters
    ----------
    model : Model
    ranges : VariableRanges
        Of the variables.
    limits : UserLimits
    selection : Selection
        What is offered of the discrete unknowns.
    combinations : Combinations
        The codec of what is offered; each of its digits is a factor.

    Attributes
    ----------
    scenario_factors : int
        How many factors, from the first, tell scenarios apart. They are given, not for the search to choose.
    cutoffs : mapping
        Number of an objective -> the most that it may be in each scenario, as a value with its sign.
    floors : mapping
        The same for the least that it may be, which is asked for wherever objectives have cutoffs.
    """

    scenario_factors: int = 0
    cutoffs: Mapping[int, np.ndarray] = MappingProxyType({})
    floors: Mapping[int, np.ndarray] = MappingProxyType({})

    def __init__(
        self, model: Model, ranges: VariableRanges, limits: UserLimits, selection: Selection, combinations: Combinations
    ) -> None:
        self.model, self.ranges, self.limits = model, ranges, limits
        self.selection, self.combinations = selection, combinations

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """Return all that designs are told and judged by: limits of the family, then those of the user."""
        return (*self.model.constraints, *self.limits.judging)

    def evaluate(self, variables: np.ndarray, data: Sequence[InputValue]) -> Evaluation:
        """Evaluate a batch of designs: quantities, and all ``constraints``.

        Parameters
        ----------
        variables : array (batch, variables)
            SI values in the declared order.
        data : list of numbers or arrays (batch,)
            One entry per data input of the model.
        """
        return self.model.evaluate(variables, data).also(self.limits.judging)

    def owners(self) -> tuple[int, ...]:
        """Return, per data input of the model, the number of the factor it belongs to; -1: the question fixes it."""
        names = self.combinations.names
        return tuple(names.index(e.name) if e.name in names else -1 for e in self.model.data_inputs)

    def column(self, position: int) -> np.ndarray:
        """Return data input number ``position`` for every alternative of the factor it belongs to."""
        entry = self.model.data_inputs[position]
        return self.combinations.column(entry.name, entry.column)

    @abstractmethod
    def data(self, combinations: np.ndarray) -> list[InputValue]:
        """Return the data inputs of the model for combinations given by number."""

    @abstractmethod
    def values_of(self, combination: int) -> RequirementValues:
        """Return the requirement values of the question that a combination belongs to."""
