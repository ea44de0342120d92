"""The question that has no answer: which limits it has, and what of it may give way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import casadi as ca

from synth.analysis.fired_guards import fired_guards
from synth.model.constraint import SYMBOLS, Constraint
from synth.question.arguments import Pins
from synth.question.instance import Instance
from synth.question.request import Request
from synth.robust.counterpart import robust_counterpart
from synth.special import expanded
from synth.studies.infeasibility.relaxation import COLUMN, REQUIREMENT
from synth.units import Quantity

if TYPE_CHECKING:
    from synth.model.model import Model


@dataclass(frozen=True)
class Pin:
    """What was asked to have a value, or of a count one of some values: its ends in SI, and where that stands."""

    name: str
    key: str
    low: float
    high: float
    unit: str

    def ends(self, model: Model) -> list[tuple[Constraint, float]]:
        """Return the limits that take its place where it gives way, each with the way that it gives way."""
        return [
            (model.constraint_on(self.name, sense, bound, f"{self.key}: {self.name} {SYMBOLS[sense]}"), sign)
            for sense, bound, sign in (("at_most", self.high, 1.0), ("at_least", self.low, -1.0))
        ]


class ExplainedQuestion:
    """A question, taken apart into what may give way and what may not.

    Parameters
    ----------
    request : Request
        With all that the user states; nothing of it is refused for what it asks.

    Attributes
    ----------
    instance : Instance
        The question as it stands.
    user_limits : list of Constraint
        The user's limits on quantities and variables.
    bounded : mapping
        Bounds of counts.
    fix, parts : mapping
        Pins, and requested parts, by name.
    pins : mapping
        Of what is pinned to a number: each may give way.
    constraints : tuple of Constraint
        All limits, those of the family first.
    by_name : mapping
        The same by their names.
    giving : list of str
        Names of the limits that may give way.
    columns : mapping
        ``slot.column`` -> slot, of all part columns that the family uses.
    requirements : mapping
        Requirements with an explicit value.

    Raises
    ------
    InputError
        For everything that is wrong with the request, in one sentence.
    """

    def __init__(self, request: Request) -> None:
        robust_request = replace(request, problem=robust_counterpart(request.problem, request.robust, request.limits))
        self.request, self.instance = request, Instance(robust_request, refuse=False)
        model, d = self.instance.model, self.instance.model.declaration
        self.names = d.names()
        kept = model.by_name(request.fix, "fix", list(self.names.values()), "a name")
        self.fix = {name: value for name, value in kept.items() if name not in d.derived}
        self.parts = model.by_name(request.parts, "parts", list(d.slots), "a slot")
        self.pins = self._pins(kept)
        # Bounds of counts hold here as well; limits on variables may give way.
        limits, variables = self.instance.limits, {v.name for v in model.variables}
        self.user_limits = [*limits.judging, *(x for x in limits.bounding if x.quantity in variables)]
        self.bounded = {name: allowed for name, allowed in limits.asked.items() if name in d.counts}
        self.constraints = (*model.constraints, *self.user_limits)
        self.by_name = {x.name: x for x in self.constraints}
        self.giving = self._giving()
        self.columns = {f"{part.slot}.{key}": part for part in d.slots.values() for key in part.columns}
        self.requirements = {
            name: Quantity(value, d.requirements[name].unit)
            for name, value in self.instance.values.requirements.items()
            if name in self.instance.values.given
        }
        if not fired_guards(self.instance):
            # What is refused only because several refusals leave out all rows between them.
            Instance(robust_request)

    def _pins(self, fix: Pins) -> dict[str, Pin]:
        """Quantities pinned to a number, and counts of which comparisons leave some values."""
        model, pins = self.instance.model, dict[str, Pin]()
        for k, variable in enumerate(model.variables):
            if variable.name in fix:
                value = float(self.instance.ranges.lower[k])
                pins[variable.name] = Pin(variable.name, "fix", value, value, variable.unit)
        # A set of values is kept as it is: between them lies nothing that would be nearer.
        sets = {name for name, _ in self.instance.limits.count_sets}
        for name, values in self.instance.selection.counts.items():
            if name not in sets and len(values) < len(model.declaration.counts[name].values):
                pins[name] = Pin(name, "fix" if name in fix else "limits", float(values[0]), float(values[-1]), "-")
        return pins

    def _giving(self) -> list[str]:
        """Return the limits that may give way: no guard, no equality and no limit of zero."""
        limits = self.instance.model.limits
        firm = {x.name for x in limits if x.guard or x.sense == "equal" or x.limit.is_zero()}
        firm |= {x.name for x in self.user_limits if x.sense == "equal" or x.bound == 0}
        return [name for name in self.limits if name not in firm]

    @property
    def limits(self) -> list[str]:
        """Names of all limits."""
        return [x.name for x in self.constraints]

    @property
    def guards(self) -> list[str]:
        """Names of the limits without which formulas do not exist."""
        return [x.name for x in self.instance.model.constraints if x.guard]

    def user_limit(self, name: str) -> Constraint | None:
        """User's limit of this name; None where it is one of the family."""
        return next((x for x in self.user_limits if x.name == name), None)

    def sign(self, limit: str) -> float:
        """Direction in which a limit gives way."""
        return -1.0 if self.by_name[limit].sense == "at_least" else 1.0

    def at_corners(self, limit: str) -> list[str]:
        """User's limit, and its copies at the corners of a range."""
        return [limit, *(x for x in self.limits if x.startswith(f"{limit} ("))]

    def words(self) -> list[str]:
        """Slots and choices that the user restricts."""
        d = self.instance.model.declaration
        return [name for name in {**self.fix, **self.parts} if name in d.slots or name in d.choices]

    def reach(self, name: str, sign: float, farthest: float) -> float:
        """Possible change of a requirement within its declared range, as a logarithm.

        Parameters
        ----------
        name : str
        sign : float
            1 or -1, upwards or downwards.
        farthest : float
            It may not move further than that, whatever its range.
        """
        r, value = self.instance.model.declaration.requirements[name], self.instance.values.requirements[name]
        end = r.upper if sign > 0 else r.lower
        if not (end > 0 and math.isfinite(end)):
            return farthest
        return min(farthest, abs(math.log(end / value))) * (1 - 1e-12)

    def moving(self, kind: str, limits: Sequence[str]) -> list[str]:
        """Return the requirements or part columns (``slot.column``) on which some of the limits depend."""
        model = self.instance.model
        kinds = {REQUIREMENT: "requirement", COLUMN: "part"}
        sides = {x.name: x.nodes for x in self.constraints}
        nodes = [k for x in limits for k in sides[x]]
        names, values = [], self.instance.values.requirements
        for k, entry in enumerate(model.data_inputs):
            if entry.kind != kinds[kind] or (kind == REQUIREMENT and not values[entry.name] > 0):
                continue
            marked = model.program.dependence(self.followers(k))
            if any(marked[node] for node in nodes):
                names.append(entry.name if kind == REQUIREMENT else entry.label)
        return names

    def followers(self, position: int) -> list[int]:
        """Return the inputs of the program that move with a data input: itself, and defaults that are made of it."""
        model = self.instance.model
        entry, first = model.data_inputs[position], len(model.variables)
        inputs = [first + position]
        for j, other in enumerate(model.data_inputs if entry.kind == "requirement" else ()):
            default = model.declaration.requirements[other.name].default if other.kind == "requirement" else None
            if other.name not in self.instance.values.given and isinstance(default, ca.SX):
                used = {str(s) for s in ca.symvar(expanded(default, model.calls))}
                inputs += [first + j] if str(entry.sx) in used else []
        return inputs

    def requirement_of(self, limit: str) -> str:
        """Return the requirement that is the limit side of a limit; nothing where it is more or something else."""
        d, records = self.instance.model.declaration, {x.name: x for x in self.instance.model.limits}
        symbols = {str(r.sx): r.name for r in d.requirements.values() if r.sx is not None}
        if limit not in records or not records[limit].limit.is_symbolic():
            return ""
        return symbols.get(str(records[limit].limit), "")
