"""Limits that hold over a range, posed as more limits: each of them again at the corners where it is worst.

The family is declared once more per corner, with what scatters moved there, on the symbols of the nominal declaration;
of that only the limits (and refusals) are kept. So the search, its proof and ``verify`` see one problem with more
limits, and nothing in them knows of ranges.

Which corners are posed follows from the signs of the elasticities over all that may be declared. That choice proves
nothing and need not: leaving corners out only leaves more designs to the search, so that its bounds hold for robust
designs as well, and every design that it finds is rated over the whole range afterwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any

import casadi as ca

from synth.bounds.shapes import FLAT, Shape
from synth.bounds.structure import classified
from synth.declaration import Choice, Declaration, Limit, Origin, Part
from synth.model.problem import DesignProblem
from synth.question.arguments import Limits, Scatter
from synth.question.uncertainty import RATE, Uncertainty, read_remaining
from synth.question.user_limits import check_number_of_limits, read_limits
from synth.robust.uncertainty import LEAST, MOST, SLIDING, Member, Scattered, scattered

if TYPE_CHECKING:
    import pandas as pd

    from synth.drawing import Drawing
    from synth.model.constraint import Constraint
    from synth.model.model import Model
    from synth.results import Design

# Part of the question, not of the search: search, check and verification pose the same corners.
MOST_OPEN = 3  # quantities of unknown direction that all corners are posed of
Position = tuple[float | None, ...]


def robust_counterpart(problem: DesignProblem, robust: Scatter | None, limits: Limits | None) -> DesignProblem:
    """Problem whose limits hold over a range; the problem itself where designs are only rated.

    Parameters
    ----------
    problem : DesignProblem
    robust : mapping, Uncertainty or None
        What scatters, as for ``synthesize``.
    limits : mapping or None
        The user's own limits, which are to hold over the range as well.
    """
    block = read_remaining(robust)
    return problem if block is None or block.mode == RATE else RobustProblem(nominal(problem), block, limits or {})


def nominal(problem: DesignProblem) -> DesignProblem:
    """Return a problem without the limits that were posed because something scatters."""
    return problem.base if isinstance(problem, RobustProblem) else problem


class RobustProblem(DesignProblem):
    """A problem with its limits posed at corners of a range besides.

    Parameters
    ----------
    base : DesignProblem
    uncertainty : Uncertainty
        What scatters.
    limits : mapping
        The user's own limits.
    """

    def __init__(self, base: DesignProblem, uncertainty: Uncertainty, limits: Limits) -> None:
        self.name, self.title, self.sources = base.name, base.title, base.sources
        super().__init__(**base.options)
        self.base, self.uncertainty, self.user_limits = base, uncertainty, limits
        self.simulation_settings, self.understands = base.simulation_settings, base.understands
        self.declines, self.disregards = base.declines, base.disregards
        self.operating_point = base.operating_point
        self.restated = {**base.restated, "robust": uncertainty.block()}

    def declare(self, d: Declaration) -> None:
        """Declare the problem, then its limits at corners of the range."""
        self.base.declare(d)
        quantities = scattered(self.uncertainty, d)
        symbols = [d.requirements[m.name].sx for x in quantities for m in x.members if m.kind == "requirement"]
        complete = all(r.given or r.optional or r.default is not None for r in d.requirements.values())
        if not complete or any(x is None for x in symbols):
            return  # an incomplete declaration has no corners yet
        corners = _Corners(self, d, quantities)
        shifted: dict[Position, _Shifted] = {}
        for limit, position in corners.cases():
            # What a limit does not depend on may stand anywhere.
            place = tuple(0.0 if p is None else p for p in position)
            if place not in shifted:
                shifted[place] = _Shifted(d, quantities, place)
                self.base.declare(shifted[place])
            shown = ", ".join(x.shown(p) for x, p in zip(quantities, position, strict=True) if p is not None)
            name = f"{limit.name} ({shown})"
            if name not in d.limits:
                d.limits[name] = _as_limit(limit, shifted[place], name)
        _refuse(d, quantities, shifted.values())

    @property
    def declared_by(self) -> type[DesignProblem]:
        """The class whose sources decide what is declared: that of the family."""
        return self.base.declared_by

    def curves(self, spec: Mapping[str, object], design: Design | None = None) -> Mapping[str, pd.DataFrame] | None:
        """Return the curves of the family."""
        return self.base.curves(spec, design)

    def simulate(self, spec: Mapping[str, object], design: Design) -> Mapping[str, pd.DataFrame] | None:
        """Return the simulations of the family."""
        return self.base.simulate(spec, design)

    def drawing(self, spec: Mapping[str, object], design: Design) -> Drawing | None:
        """Return the drawing of the family."""
        return self.base.drawing(spec, design)

    def state(self, spec: Mapping[str, object], design: Design, point: Mapping[str, float]) -> pd.DataFrame | None:
        """Return the state of the family at an operating point."""
        return self.base.state(spec, design, point)


def _as_limit(limit: Constraint, d: Declaration, name: str) -> Limit:
    """A limit as the declaration at a corner has it."""
    there = limit.declared(d.derived[limit.quantity].sx) if limit.quantity else d.limits[limit.name]
    return replace(there, name=name, origin=Origin.RANGE)


class _Corners:
    """Corners at which each limit is posed."""

    def __init__(self, problem: RobustProblem, d: Declaration, quantities: Sequence[Scattered]) -> None:
        self.quantities, self.d, self.uncertainty = quantities, d, problem.uncertainty
        specified = frozenset(name for name, r in d.requirements.items() if r.given)
        self.model: Model = problem.base.model(specified, d.catalogs)
        self.shapes = classified(self.model, d.catalogs)
        number = self.model.input_number
        self.inputs = [[number[m.key] for m in x.members if m.key in number] for x in quantities]
        self.marked = [self.model.program.dependence(k) for k in self.inputs]
        self.user_limits = self._of_the_user(problem.user_limits)

    def _of_the_user(self, limits: Limits) -> list[Constraint]:
        check_number_of_limits(limits)
        constraints: list[Constraint] = []
        for word, texts in limits.items():
            name = self.d.names().get(str(word), "")
            if name not in self.d.derived:
                continue  # bounds of variables and counts; what is unknown is refused elsewhere
            unit = self.d.derived[name].unit
            constraints += [
                self.model.constraint_on(name, sense, bound) for sense, bound, _ in read_limits(name, unit, texts)
            ]
        return constraints

    def cases(self) -> list[tuple[Constraint, Position]]:
        """Limits, each with a position at which it is posed."""
        result = []
        # The shape of a limit is turned already so that small is good; that of a quantity is not.
        for limit in (*self.model.constraints, *self.user_limits):
            if limit.sense == "equal":
                continue
            on_quantity = bool(limit.quantity)
            shape = self.shapes.quantities[limit.quantity] if on_quantity else self.shapes.limits[limit.name]
            turned = -1 if on_quantity and limit.sense == "at_least" else 1
            ends = [
                self._ends(j, shape, any(self.marked[j][k] for k in limit.nodes), turned)
                for j in range(len(self.quantities))
            ]
            if all(e == (None,) for e in ends):
                continue
            if sum(len(e) > 1 for e in ends) <= MOST_OPEN:
                result += [(limit, position) for position in product(*ends)]
            for scenario in self.uncertainty.scenarios.get(limit.name, ()):
                result.append((limit, tuple(None if e == (None,) else p for e, p in zip(ends, scenario, strict=True))))
        return result

    def _ends(self, j: int, shape: Shape, matters: bool, turned: int) -> tuple[float | None, ...]:
        """Positions of one scattering quantity at which a limit may be worst."""
        if not matters:
            return (None,)
        if shape.sign != 1:
            return (0.0, 1.0)
        low, high = (float(shape.elasticity[self.inputs[j], side].sum()) * turned for side in (0, 1))
        low, high = min(low, high), max(low, high)
        return (1.0,) if low >= -FLAT else (0.0,) if high <= FLAT else (0.0, 1.0)


@dataclass
class _ShiftedPart(Part):
    """A part whose columns are those of the nominal one, moved."""

    _move: Any = None

    def _symbol(self, columns: tuple[str, ...], required: bool) -> Any:
        return self._move(Member("part", self.slot, "|".join(columns)), super()._symbol(columns, required))


class _Shifted(Declaration):
    """The declaration of a problem at one position of the range, on the symbols of the nominal one."""

    def __init__(self, around: Declaration, quantities: Sequence[Scattered], position: Sequence[float | None]) -> None:
        super().__init__(*around.key())
        self._around = around
        self._moves = {m.key: (x, p) for x, p in zip(quantities, position, strict=True) for m in x.members}

    def _moved(self, member: Member, symbol: ca.SX) -> Any:
        quantity, position = self._moves.get(member.key, (None, None))
        if quantity is None or position is None:
            return symbol
        return quantity.moved(member, lambda m: symbol if m == member else self._nominal(m), position, self._column)

    def _nominal(self, member: Member) -> Any:
        if member.kind == "part":
            return self._column(member.name, member.column)
        return (self._around.requirements if member.kind == "requirement" else self._around.variables)[member.name].sx

    def _column(self, slot: str, column: str) -> Any:
        part = self._around.slots[slot]
        known = part.columns.get(column)
        return getattr(part, column) if known is None or column in (SLIDING, LEAST, MOST) else known.sx

    def requirement(self, name: str, *args: Any, **details: Any) -> Any:
        """Declare a requirement; return what it is here."""
        declared = super().requirement(name, *args, **details)
        if self.requirements[name].follows:
            return declared  # made of what is moved already
        symbol = self._around.requirements[name].sx
        return None if symbol is None else self._moved(Member("requirement", name), symbol)

    def variable(self, name: str, *args: Any, **details: Any) -> Any:
        """Declare a variable; return what it is here."""
        super().variable(name, *args, **details)
        return self._moved(Member("variable", name), self._around.variables[name].sx)

    def count(self, name: str, *args: Any, **details: Any) -> Any:
        """Declare a count; return the symbol it has."""
        super().count(name, *args, **details)
        return self._around.counts[name].sx

    def choice(self, name: str, *args: Any, **details: Any) -> Choice:
        """Declare a choice; return the one there is."""
        super().choice(name, *args, **details)
        return self._around.choices[name]

    def part(self, slot: str, *args: Any, **details: Any) -> Part:
        """Declare a slot; return the part with its columns moved."""
        super().part(slot, *args, **details)
        row = self._around.slots[slot]
        fields = (row.slot, row.table, row.where, row.symbol, row.text, row.source, row.is_slot, row.known, row.columns)
        return _ShiftedPart(*fields, _move=self._moved)

    def row(self, table: str, designation: str) -> Part:
        """Return the fixed row there is."""
        return self._around.rows[f"{table}:{designation}"]


def _refuse(d: Declaration, quantities: Sequence[Scattered], corners: Iterable[Declaration]) -> None:
    """Add the refusals of the family at the corners."""
    moved: dict[str, str] = {}
    for x in quantities:
        for m in x.members:
            if m.kind == "requirement":
                moved[str(d.requirements[m.name].sx)] = x.name
            elif m.kind == "part" and m.column in d.slots[m.name].columns:
                moved[str(d.slots[m.name].columns[m.column].sx)] = x.name
    nominal_ones, seen = list(d.refusals), set[str]()
    for corner in corners:
        for nominal, there in zip(nominal_ones, corner.refusals, strict=True):
            names = dict.fromkeys(moved[str(s)] for s in ca.symvar(nominal.when) if str(s) in moved)
            if names and (text := f"{nominal.code} {there.when}") not in seen:
                seen.add(text)
                message = f"{nominal.message}, over the whole range of {' and '.join(names)}"
                d.refusals.append(replace(there, message=message))
