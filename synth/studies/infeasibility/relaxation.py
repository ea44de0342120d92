"""A question of which requirements, limits or part columns give way, by an amount that the search decides.

The unknown ``relaxation`` s is the amount, as the logarithm of a factor: what gives way upwards is multiplied by
exp(s), downwards by exp(-s).
"""

from __future__ import annotations

import copy
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from synth.analysis.fired_guards import required_inequalities
from synth.analysis.settings import WAYS_OUT
from synth.declaration import Limit, Objective, Refusal, VariableRecord
from synth.model.constraint import Constraint
from synth.model.model import Model
from synth.model.problem import DesignProblem
from synth.model.slot_comparison import SlotComparison
from synth.order.feasibility import SMALLEST
from synth.question.instance import Instance
from synth.special import expanded
from synth.tables.catalogs import Catalogs

AMOUNT = "relaxation"
REQUIREMENT, LIMIT, COLUMN = "requirement", "limit", "column"


class _Substitution:
    """Puts what has moved in place of symbols.

    Parameters
    ----------
    before, after : list
        Symbols, and what stands in their place.
    """

    def __init__(self, before: list[Any], after: list[Any]) -> None:
        self.before, self.after = before, after

    def __call__(self, expression: ca.SX | float) -> Any:
        """Return an expression in which they are replaced."""
        return ca.substitute([ca.SX(expression)], self.before, self.after)[0] if self.before else expression


class Relaxed(DesignProblem):
    """A question in which something gives way, and of which only some limits are kept.

    Parameters
    ----------
    instance : Instance
        The question.
    added : sequence of Constraint
        The user's limits on quantities, which become limits like those of the family.
    give : mapping
        (kind, name) of a requirement, limit or part column (``slot.column``) -> 1 or -1, upwards or downwards.
    kept : collection of str
        The limits that count; guards always do.
    rooms : mapping, optional
        Requirement -> the largest amount that its declared range allows, where others may move on.
    free : collection of str
        Slots whose rules do not count.
    farthest : float, optional
        The largest amount.
    """

    def __init__(
        self,
        instance: Instance,
        added: Sequence[Constraint],
        give: Mapping[tuple[str, str], float],
        kept: Collection[str],
        rooms: Mapping[str, float] | None = None,
        free: Collection[str] = (),
        farthest: float = WAYS_OUT.farthest,
    ) -> None:
        self.name = f"{instance.problem.name} (relaxed)"
        self.title = instance.problem.title
        super().__init__(**instance.problem.options)
        self._instance, self._added, self._give, self._kept, self._rooms = (instance, added, give, kept, rooms or {})
        self._free, self._farthest = free, farthest
        self._model = self._traced()

    def model(self, present: frozenset[str], catalogs: Catalogs, compared: tuple[SlotComparison, ...] = ()) -> Model:
        """Return the relaxed model; there is one, for the requirements, tables and comparisons of the question."""
        return self._model

    def _traced(self) -> Model:
        """Return the model of the question with everything in it moved that gives way."""
        original = self._instance.model
        source = original.declaration
        amount = VariableRecord(
            AMOUNT, "-", AMOUNT, "How far limits give way", "-", 0.0, self._farthest, np.empty(0), ca.SX.sym(AMOUNT)
        )
        moved = _Substitution(*self._moved_inputs(amount.sx))
        target = copy.copy(source)
        target.problem = self.name
        target.derived = {name: replace(q, sx=moved(q.sx)) for name, q in source.derived.items()}
        quantities = {**original.quantity_sx, **{name: q.sx for name, q in target.derived.items()}}
        limits = [replace(x, value=moved(x.value), limit=moved(x.limit)) for x in source.limits.values()]
        limits += [x.declared(quantities[x.quantity]) for x in self._added]
        target.limits = {x.name: self._loosened(x, amount.sx) for x in limits if x.guard or x.name in self._kept}
        target.refusals, refused = self._refusals(moved)
        target.limits |= {x.name: x for x in refused}
        target.variables = {**source.variables, AMOUNT: amount}
        target.objectives = {AMOUNT: Objective(AMOUNT, "min", True), **source.objectives}
        target.advices = []
        target._symbols = {**source.names(), AMOUNT: AMOUNT}
        calls = [replace(c, arguments=tuple(moved(a) for a in c.arguments)) for c in original.calls]
        return Model(self.name, target, calls)

    def _loosened(self, limit: Limit, amount: ca.SX) -> Limit:
        """Return a limit that gives way, if it is one that does."""
        sign = self._give.get((LIMIT, limit.name))
        if sign is None:
            return limit
        # A negative bound that is to be less strict moves to the other side of a factor.
        sign = -sign if any(x.bound < 0 for x in self._added if x.name == limit.name) else sign
        return replace(limit, limit=limit.limit * np.exp(sign * amount))

    def _refusals(self, moved: _Substitution) -> tuple[list[Refusal], list[Limit]]:
        """Outright refusals, and limits in place of refusals of something that moves.

        That is refused where it has moved to.
        """
        original = self._instance.model
        source = original.declaration.refusals
        declared_count = len(source) - len(self._instance.compared)
        stay, limits = list[Refusal](), list[Limit]()
        for refusal in source[:declared_count]:
            when = moved(expanded(refusal.when, original.calls))
            if not any(str(s) == AMOUNT for s in ca.symvar(when)):
                stay.append(refusal)
                continue
            sides = [(w.smaller, w.larger) for w in required_inequalities(refusal.when) or ()] or [(refusal.when, 0.5)]
            for k, pair in enumerate(sides):
                name = f"refused: {refusal.code}" + (f" ({k + 1})" if k else "")
                value, bound = (moved(expanded(ca.SX(x), original.calls)) for x in pair)
                limits.append(Limit(name, "at_most", "-", refusal.message, "", value, bound, False, SMALLEST))
        # Rows are compared as they are, whatever gives way, unless the rule that compares them does not count.
        rules = zip(self._instance.compared, source[declared_count:], strict=True)
        return [*stay, *(refusal for rule, refusal in rules if rule.slot not in self._free)], limits

    def _moved_inputs(self, amount: ca.SX) -> tuple[list[Any], list[Any]]:
        """Return the symbols of requirements and columns that move, and what stands in their place.

        A requirement at its default follows those that the default is made of.
        """
        d, calls = self._instance.model.declaration, self._instance.model.calls
        present = self._instance.values.given
        before: list[Any] = []
        after: list[Any] = []
        for r in d.requirements.values():
            sign = self._give.get((REQUIREMENT, r.name), 0.0)
            value = r.sx
            if before and r.sx is not None and r.name not in present and isinstance(r.default, ca.SX):
                value = ca.substitute([expanded(r.default, calls)], before, after)[0]
            if sign or value is not r.sx:
                before.append(r.sx)
                reach = self._rooms.get(r.name, self._farthest)
                step = ca.fmin(amount, reach) if reach < self._farthest else amount
                after.append(value * np.exp(sign * step) if sign else value)
        for part in d.slots.values():
            for key, column in part.columns.items():
                sign = self._give.get((COLUMN, f"{part.slot}.{key}"), 0.0)
                if sign:
                    before.append(column.sx)
                    after.append(column.sx * np.exp(sign * amount))
        return before, after
