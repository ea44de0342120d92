"""One question to a model: requirement values, restrictions, and the combinations that remain."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from synth.kernels.loading import native_code
from synth.model.model import Model
from synth.model.program import InputValue
from synth.model.slot_comparison import SlotComparison, comparisons_of
from synth.question.combinations import Combinations
from synth.question.inputs import inputs_of_combination
from synth.question.names import known_requirements
from synth.question.objectives import quantities_compared
from synth.question.offers import select
from synth.question.refusals import leave_out_refused, leave_out_without_partner, refuse_requirements
from synth.question.requirement_values import RequirementValues
from synth.question.rows_without_value import leave_out_without_value
from synth.question.search_space import SearchSpace
from synth.question.selection import Selection, part_row
from synth.question.user_limits import UserLimits
from synth.question.variable_ranges import VariableRanges
from synth.results.provenance import Fingerprint, code_digest, hash_of, joined, problem_digest, processor

if TYPE_CHECKING:
    from synth.question.request import Request
    from synth.results import PartRow


class Instance(SearchSpace):
    """A model with its requirement values and restrictions.

    Parameters
    ----------
    request : Request
        What is asked; its problem has the limits that what scatters calls for already.
    restrict : bool
        False for the analysis of a given design: then rows are not filtered, and limits on what it is made of bound
        nothing.
    refuse : bool
        False where the family's refusals are to be explained: they are neither raised nor leave out rows.

    Attributes
    ----------
    values : RequirementValues
    compared : tuple of SlotComparison
        The conditions on parts that compare slots; the model refuses what they exclude.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """

    def __init__(self, request: Request, *, restrict: bool = True, refuse: bool = True) -> None:
        self.problem, self.catalogs = request.problem, request.catalogs
        asked = known_requirements(self.problem, request.requirements, self.catalogs)
        rules = request.parts if restrict else {}
        self.compared, model = self._traced(frozenset(asked), rules)
        self.values = RequirementValues.read(model, self.catalogs, asked)
        if refuse:
            refuse_requirements(model, self.values)
        ranges = VariableRanges(model.variables, request.grid, self.values.ranges(model))
        limits = UserLimits(model, request.limits, request.fix, ranges, restrict)
        selection = select(model, self.catalogs, rules, limits) if restrict else Selection()
        if restrict and refuse:
            leave_out_refused(model, self.values, selection, limits.fixed)
            leave_out_without_partner(model, self.compared, selection)
        if restrict:
            needed = [*quantities_compared(model, request.objectives), *(x.quantity for x in limits.judging)]
            leave_out_without_value(model, ranges, self.values, selection, needed)
        labels = {c.name: c.labels for c in model.declaration.choices.values()}
        super().__init__(model, ranges, limits, selection, Combinations(selection, labels))

    def _traced(self, given: frozenset[str], rules: Mapping[str, object]) -> tuple[tuple[SlotComparison, ...], Model]:
        """Return the conditions that compare slots, and the model that refuses what they exclude."""
        plain = self.problem.model(given, self.catalogs)
        slots = plain.declaration.slots
        named = plain.by_name(rules, "parts", list(slots), "a slot")
        compared = comparisons_of(
            {s: r for s, r in named.items() if r not in self.catalogs.table(slots[s].table).designations}
        )
        return compared, self.problem.model(given, self.catalogs, compared) if compared else plain

    def data(self, combinations: np.ndarray, values: RequirementValues | None = None) -> list[InputValue]:
        """Return the data inputs of the model for combinations given by number.

        Parameters
        ----------
        combinations : array of int (combinations,)
        values : RequirementValues, optional
            In place of those of the question.
        """
        own, numbers = self.values if values is None else values, np.asarray(combinations, dtype=np.int64)
        return inputs_of_combination(self.model, own.requirements, own.rows, self.combinations, numbers)

    def offered(self) -> dict[str, list[PartRow]]:
        """Rows that slots offer; of a given design all of their tables."""
        chosen = {s.slot: (s.table, s.rows) for s in self.selection.slots}
        found: dict[str, list[PartRow]] = {}
        for slot, part in self.model.declaration.slots.items():
            table = self.catalogs.table(part.table)
            table, rows = chosen.get(slot) or (table, range(len(table)))
            found[slot] = [part_row(table, int(k)) for k in rows]
        return found

    def values_of(self, combination: int) -> RequirementValues:
        """Return the requirement values, which are the same for all combinations."""
        return self.values

    def fingerprint(self) -> Fingerprint:
        """Digest of everything that decides the numbers of an answer, by which kept results are recognised."""
        model, selection, problem = self.model, self.selection, self.problem
        asked = {
            "family": problem.name,
            "options": {name: option.chosen for name, option in model.declaration.options.items()},
            "restated": repr(problem.restated),
            "requirements": self.values.requirements,
            "rows": {s.slot: joined(s.table.hashes[int(r)] for r in s.rows) for s in selection.slots},
            "steps": {n: v.tolist() for n, v in {**selection.counts, **selection.choices}.items()},
            "ranges": [self.ranges.lower.tolist(), self.ranges.upper.tolist()],
            "grids": [grid.tolist() for grid in self.ranges.grids()],
            "limits": [[x.name, x.quantity, x.sense, x.bound] for x in self.limits.judging],
            "compared": [str(x) for x in self.compared],
        }
        computed = [model.function("sources", self._sources), native_code(), processor()]
        return Fingerprint(question=hash_of(asked), computation=hash_of(computed))

    def _sources(self) -> list[str]:
        """Return the hashes of the code, of the family's sources, and of the formulas that it has declared."""
        program = self.model.program
        formulas = hash_of([repr(x) for x in (*program.nodes, *program.outputs)])
        return [code_digest(), problem_digest([self.problem.declared_by]), formulas]
