"""One question to a model: requirement values, restrictions, and the combinations that remain."""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from synth.declaration import Origin, Part, Refusal
from synth.errors import InputError, RefusedError, at
from synth.margins import within
from synth.model.constraint import SIGNS, Constraint
from synth.model.model import Evaluation, Model
from synth.model.numbers import numeric
from synth.model.slot_comparison import SlotComparison, comparisons_of
from synth.question.combinations import Combinations, Selection, SlotRows
from synth.question.count_domain import compares, entries, is_list, shown_set, values_of_set
from synth.question.inputs import fixed_designation, fixed_row_values, inputs_of_combination, part_value
from synth.question.names import known_requirements
from synth.question.user_limits import check_number_of_limits, contradict, read_limits
from synth.results.provenance import Fingerprint, code_digest, hash_of, joined, native_code, problem_digest, processor
from synth.special import expanded
from synth.tables.conditions import may_be_condition, parse_condition
from synth.tables.table import Table
from synth.units import Quantity, format_quantity, from_si, parse_quantity, parse_unit

if TYPE_CHECKING:
    from synth.question.request import Request

MOST_COMPARED = 4_000_000  # rows of slots together whose comparison is looked at before the search


class Instance:
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
    own : list of Constraint
        What the user limits that designs are told and judged by, beside the limits of the family.
    bounding : list of Constraint
        Limits of the user on variables and counts. In a search they are ranges and values left out, so that every
        design that is looked at keeps them.
    limited : dict
        What is asked of quantities under ``limits``, as typed, by public name.
    count_sets : list
        The counts of which a set of values is allowed, with the values.
    """

    def __init__(self, request: Request, *, restrict: bool = True, refuse: bool = True) -> None:
        self.problem, self.catalogs, self.grid = request.problem, request.catalogs, request.grid
        asked = known_requirements(self.problem, request.requirements, self.catalogs)
        rules = request.parts if restrict else {}
        self.compared, self.model = self._traced(frozenset(asked), rules)
        d = self.model.declaration
        self.requirements = self._requirement_values(asked)
        self.given = frozenset(asked)
        self.not_asked = [r.name for r in d.requirements.values() if r.sx is None]
        if refuse:
            self._refuse_requirements()
        self.lower = np.array([v.lower for v in self.model.variables])
        self.upper = np.array([v.upper for v in self.model.variables])
        self.pinned = np.zeros(len(self.model.variables), dtype=bool)
        self.own: list[Constraint] = []
        self.bounding: list[Constraint] = []
        self.asked_limits = dict(request.limits)
        self._fixed_discrete: dict[str, Any] = {}
        self.count_sets: list[tuple[str, np.ndarray]] = []
        check_number_of_limits(self.asked_limits)
        quantities = list(self.model.quantity_sx)
        self.limited = self.model.by_name(self.asked_limits, "limits", quantities, "a quantity")
        for name, conditions in self.limited.items():
            self._add_limit(name, conditions, restrict)
        among = [*quantities, *d.choices, *d.slots]
        kinds = "a variable, count, choice, slot or derived quantity"
        for name, value in self.model.by_name(request.fix, "fix", among, kinds).items():
            with at("fix", name):
                self._pin(name, value)
        self.selection = Selection()
        if restrict:
            self._select_rows(rules)
            self._select_counts()
        if restrict and refuse:
            self._refuse_rows()
            self._refuse_without_partner()
        self.apart = 0  # factors, from the first, that tell questions apart and are not for the search to choose
        self.combinations = Combinations(self.selection, {c.name: c.labels for c in d.choices.values()})

    def _traced(self, given: frozenset[str], rules: Mapping[str, Any]) -> tuple[tuple[SlotComparison, ...], Model]:
        """Return the conditions that compare slots, and the model that refuses what they exclude."""
        plain = self.problem.model(given, self.catalogs)
        slots = plain.declaration.slots
        named = plain.by_name(rules, "parts", list(slots), "a slot")
        compared = comparisons_of(
            {s: r for s, r in named.items() if r not in self.catalogs.table(slots[s].table).designations}
        )
        return compared, self.problem.model(given, self.catalogs, compared) if compared else plain

    # -- requirements --------------------------------------------------------------------------

    def _requirement_values(self, asked: Mapping[str, Any]) -> dict[str, float]:
        model, values = self.model, dict[str, float]()
        row_values = self._row_values()
        for r in model.declaration.requirements.values():
            if r.sx is None:
                continue
            if r.name in asked:
                with at("requirements", r.name):
                    values[r.name] = parse_quantity(asked[r.name], r.unit, f"requirement {r.name}")
                    self._check_range(r.name, asked[r.name], values[r.name], r.lower, r.upper, r.unit)
            elif r.default is None:
                right = f"a value in {r.unit}, for example {self._example(r)}"
                raise InputError(f"requirement {r.name}", None, right, ("requirements", r.name))
            elif isinstance(r.default, float):
                values[r.name] = r.default
            else:
                known = {**{model.requirement_symbols[n]: v for n, v in values.items()}, **row_values}
                values[r.name] = self._number(r.default, known)
        return values

    @staticmethod
    def _example(requirement: Any) -> str:
        finite = [x for x in (requirement.lower, requirement.upper) if np.isfinite(x) and x > 0]
        middle = math.sqrt(finite[0] * finite[1]) if len(finite) == 2 else (finite[0] if finite else 1.0)
        shown = float(f"{from_si(middle, parse_unit(requirement.unit)):.1g}")
        return f"'{shown:g} {requirement.unit}'"

    @staticmethod
    def _check_range(name: str, typed: Any, value: float, lower: float, upper: float, unit: str) -> None:
        if not within(value, lower, upper, 1e-12):
            low, high = format_quantity(lower, unit), format_quantity(upper, unit)
            expected = (
                f"{low} to {high}"
                if np.isfinite(lower) and np.isfinite(upper)
                else (f"at least {low}" if np.isfinite(lower) else f"at most {high}")
            )
            raise InputError(f"requirement {name}", typed, expected)

    def _row_values(self) -> dict[str, float]:
        d = self.model.declaration
        self.row_values = fixed_row_values(d, self.catalogs)
        for row in d.rows.values():
            for key, column in row.columns.items():
                if column.required and math.isnan(self.row_values[str(column.sx)]):
                    designation = fixed_designation(row.slot)
                    where = f"table {row.table}, row {designation}, column {key}"
                    raise InputError(where, None, "a number", ("catalogs", row.table, designation, key))
        return self.row_values

    def _refuse_requirements(self) -> None:
        model = self.model
        known = self.symbol_values()
        for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
            if not kinds and self._number(refusal.when, known) > 0.5:
                raise self._refused(refusal)

    def _number(self, expression: Any, values: Mapping[str, float]) -> float:
        """Evaluate an expression of the declaration; what evaluates it is built once per model, not per question."""
        model = self.model
        made: tuple[Any, list[str]] = model.function(
            ("number", id(expression)), lambda: numeric(expanded(expression, model.calls))
        )
        function, names = made
        return float(function.call([values[name] for name in names])[0])

    def symbol_values(self) -> dict[str, float]:
        """Return the values of the symbols of requirements and fixed rows, in SI."""
        symbols = self.model.requirement_symbols
        return {**{symbols[n]: v for n, v in self.requirements.items()}, **self.row_values}

    def _refused(self, refusal: Refusal) -> InputError:
        """Return the fault of what the family refuses: in requirements, or where it speaks of none in options."""
        d, used = self.model.declaration, {str(s) for s in ca.symvar(expanded(refusal.when, self.model.calls))}
        shown = {
            r.name: f"{r.name} = {format_quantity(self.requirements[r.name], r.unit)}"
            for r in d.requirements.values()
            if r.name in self.requirements and str(r.sx) in used
        }
        place = "requirements" if shown else "options"
        shown = shown or {o.name: f"{o.name} = {o.chosen}" for o in d.options.values() if o.chosen != o.default}
        path = (place, *shown) if len(shown) == 1 else (place,)
        return RefusedError(refusal.code, ", ".join(shown.values()), refusal.message, path)

    def moved(self, name: str, value: float) -> Instance:
        """Return this question with another value of a requirement, and of those whose default is made of it.

        The combinations keep their numbers; some may be refused there that are not here.

        Raises
        ------
        InputError
            When the requirement cannot have that value.
        """
        other = self.shifted(name, value)
        other._refuse_requirements()
        return other

    def shifted(self, name: str, value: float) -> Instance:
        """Return this question with another value of a requirement, as :meth:`moved`, whether it is refused or not."""
        other, declared = copy.copy(self), self.model.declaration.requirements
        values = {n: self.requirements[n] for n in self.given} | {name: value}
        other.requirements = other._requirement_values({n: Quantity(v, declared[n].unit) for n, v in values.items()})
        other.given = self.given | {name}
        return other

    # -- limits and fix ------------------------------------------------------------------------

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """Return all that designs are told and judged by: limits of the family, then those of the user."""
        return (*self.model.constraints, *self.own)

    def evaluate(self, variables: np.ndarray, data: Sequence[Any]) -> Evaluation:
        """Evaluate a batch of designs: quantities, and all ``constraints``.

        Parameters
        ----------
        variables : array (batch, variables)
            SI values in the declared order.
        data : list of numbers or arrays (batch,)
            One entry per data input of the model.
        """
        return self.model.evaluate(variables, data).also(self.own)

    def _add_limit(self, name: str, conditions: Any, restrict: bool) -> None:
        for sense, bound, place in read_limits(name, self.model.units[name], conditions):
            with at("limits", name, *place):
                limit = self.model.constraint_on(name, sense, bound)
                if name in self.model.declaration.derived:
                    self._add(limit)
                else:
                    self.bounding.append(limit)
                    if restrict:
                        self._bound(limit)
        if self._asks_set(name, conditions):
            with at("limits", name):
                self._allow(name, conditions, "limits")

    def state_limits_on_unknowns(self, values: Mapping[str, float]) -> None:
        """Let limits on variables and counts, which bound a search, be limits that a given design may miss.

        Of a set of allowed values the one nearest to that of the design is the limit.
        """
        for name in self.limited:
            self.own += [x for x in self.bounding if x.quantity == name]
            for steps in (own for count, own in self.count_sets if count == name):
                nearest = float(steps[np.argmin(np.abs(steps - values[name]))])
                self.own.append(self.model.constraint_on(name, "equal", nearest, f"{name} in {shown_set(steps)}"))

    def _asks_set(self, name: str, conditions: Any) -> bool:
        """Tell whether what is asked of a quantity holds a set of allowed values, which only a count can have."""
        if not is_list(conditions) or (len(conditions) and all(map(compares, entries(conditions)))):
            return False
        if name not in self.model.declaration.counts:
            example = f"comparisons, for example '<= 260 {self.model.units[name]}'; a set of values is for counts"
            place = next((k for k, text in enumerate(entries(conditions)) if not compares(text)), None)
            path = ("limits", name) if place is None or isinstance(conditions, str) else ("limits", name, place)
            raise InputError(f"limits: {name}", conditions, example, path)
        return True

    def _allow(self, name: str, values: Any, field: str) -> None:
        self.count_sets.append((name, values_of_set(self.model.declaration.counts[name], values, field)))

    def _bound(self, limit: Constraint) -> None:
        """Let a limit on a variable be an end of its range; counts are left out when they are selected."""
        variable = next((k for k, v in enumerate(self.model.variables) if v.name == limit.quantity), None)
        if variable is None:
            return
        if limit.sense in ("at_most", "equal"):
            self.upper[variable] = min(self.upper[variable], limit.bound)
        if limit.sense in ("at_least", "equal"):
            self.lower[variable] = max(self.lower[variable], limit.bound)
        if self.lower[variable] > self.upper[variable]:
            v = self.model.variables[variable]
            allowed = f"{format_quantity(v.lower, v.unit)} to {format_quantity(v.upper, v.unit)}"
            right = f"limits that leave something of {allowed}"
            raise InputError(f"limits: {v.name}", format_quantity(limit.bound, v.unit), right)

    def _add(self, limit: Constraint) -> None:
        """Let a limit on a derived quantity be one that designs are judged by."""
        name, unit = limit.quantity, limit.unit
        ceiling = self.model.declaration.derived[name].ceiling
        if limit.sense != "at_least" and limit.bound > ceiling:
            right = f"at most {format_quantity(ceiling, unit)}"
            raise InputError(f"limits: {name}", format_quantity(limit.bound, unit), right)
        for other in self.own:
            if other.quantity == name and contradict(other.sense, other.bound, limit.sense, limit.bound):
                right = "limits that do not exclude each other"
                raise InputError(f"limits: {name}", f"{other.name} and {limit.name}", right)
        self.own.append(limit)

    def _pin(self, name: str, value: Any) -> None:
        model, d = self.model, self.model.declaration
        if name in d.counts and is_list(value):
            self._allow(name, value, "fix")
            return
        if is_list(value) and not isinstance(value, str):
            more = " (parts takes a list of designations)" if name in d.slots else ""
            raise InputError(f"fix: {name}", value, f"one value; a set of values is for counts{more}")
        if name in d.slots or name in d.choices:
            self._fixed_discrete[name] = value
            return
        unit = model.units[name]
        number_si = parse_quantity(value, unit, f"fix: {name}")
        for k, v in enumerate(model.variables):
            if v.name == name:
                self._check_range_of_variable(k, value, number_si)
                self.lower[k] = self.upper[k] = number_si
                self.pinned[k] = True
        if name in d.counts:
            self._fixed_discrete[name] = number_si
        elif name in d.derived:
            self._add(model.constraint_on(name, "equal", number_si, origin=Origin.PIN))

    def _check_range_of_variable(self, k: int, typed: Any, value: float) -> None:
        v = self.model.variables[k]
        if not within(value, v.lower, v.upper, 1e-12):
            allowed = f"{format_quantity(v.lower, v.unit)} to {format_quantity(v.upper, v.unit)}"
            raise InputError(f"fix: {v.name}", typed, allowed)

    # -- parts, counts, choices ----------------------------------------------------------------

    def _select_rows(self, parts: Mapping[str, Any]) -> None:
        d = self.model.declaration
        wanted = self.model.by_name(parts, "parts", list(d.slots), "a slot")
        for part in d.slots.values():
            table = self.catalogs.table(part.table)
            self.selection.offered[part.slot] = len(table)
            keep = self.offers(part, table)
            if part.slot in wanted:
                with at("parts", part.slot):
                    keep &= self._part_rule(part, table, wanted[part.slot])
            if part.slot in self._fixed_discrete:
                with at("fix", part.slot):
                    keep &= np.arange(len(table)) == table.row_index(str(self._fixed_discrete[part.slot]))
            keep = self._complete_rows(part, table, keep)
            rows = np.flatnonzero(keep)
            if not len(rows):
                asked = [wanted[part.slot]] if part.slot in wanted else []
                asked += [[self._fixed_discrete[part.slot]]] if part.slot in self._fixed_discrete else []
                self._refuse_empty(part, table, asked)
            columns = {key: part_value(table, rows, column.columns) for key, column in part.columns.items()}
            self.selection.slots.append(SlotRows(part.slot, table, rows, columns))

    def _refuse_empty(self, part: Part, table: Table, asked: list[Any]) -> None:
        """Say why no row is left for a slot: by which condition, rule or missing value."""
        rows = np.ones(len(table), dtype=bool)
        for rule in asked:
            rows &= self._part_rule(part, table, rule)
        names = ", ".join(table.designations[k] for k in np.flatnonzero(rows)[:5]) or "no row"
        lacking = sorted({e["reason"] for e in self.selection.left_out if e["slot"] == part.slot})
        failing = [c for c in part.where if not self._meets(c, table)[rows].any()]
        if not rows.any():
            expected = f"rules for this slot that leave at least one row of table {part.table}"
        elif failing:
            expected = f"a row of table {part.table} with {' and '.join(failing)}"
        elif lacking:
            expected = f"a row of table {part.table} that is complete ({'; '.join(lacking)})"
        else:
            expected = f"a row of table {part.table} with {' and '.join(part.where)}"
        raise InputError(f"slot {part.slot}", names, expected, ("parts", part.slot))

    @staticmethod
    def _meets(text: str, table: Table) -> np.ndarray:
        condition = parse_condition(text)
        missing = [c for c in condition.columns if not table.has(c)]
        if missing and table.user_rows.all():
            # A user's own table need not have the columns that sort the shipped one.
            return np.ones(len(table), dtype=bool)
        mask: np.ndarray = condition.mask(table)
        if "family_hint" in condition.columns:
            hints = np.array([not h for h in table.text("family_hint")])
            mask = mask | (table.user_rows & hints)
        return mask

    @staticmethod
    def offers(part: Part, table: Table) -> np.ndarray:
        """Return which rows of the table meet the conditions of the slot."""
        keep = np.ones(len(table), dtype=bool)
        for text in part.where:
            keep &= table.once(("meets", text), partial(Instance._meets, text, table))
        return keep

    @staticmethod
    def _part_rule(part: Part, table: Table, rule: Any) -> np.ndarray:
        keep = np.zeros(len(table), dtype=bool)
        if isinstance(rule, str) and rule not in table.designations and may_be_condition(rule):
            return parse_condition(rule).local().mask(table)
        if not isinstance(rule, (str, Sequence)):
            raise InputError(f"parts: {part.slot}", rule, "a list of designations, or a condition on columns")
        if isinstance(rule, str):
            keep[table.row_index(rule)] = True
            return keep
        for k, designation in enumerate(rule):
            with at(k):
                keep[table.row_index(str(designation))] = True
        return keep

    def _complete_rows(self, part: Part, table: Table, keep: np.ndarray) -> np.ndarray:
        for column in part.columns.values():
            if not column.required:
                continue
            present = table.once(("present", column.columns), partial(_present, table, column.columns))
            for row in np.flatnonzero(keep & ~present):
                self._leave_out(part.slot, table.designations[row], f"no value in column {' or '.join(column.columns)}")
            keep = keep & present
        return keep

    def _leave_out(self, slot: str, designation: str, reason: str) -> None:
        self.selection.left_out.append({"slot": slot, "designation": designation, "reason": reason})

    def _select_counts(self) -> None:
        d = self.model.declaration
        for count in d.counts.values():
            values = count.values
            bounding = [x for x in self.bounding if x.quantity == count.name]
            for limit in bounding:
                values = values[_compare(values, limit.sense, limit.bound)]
            for name, steps in self.count_sets:
                if name == count.name:
                    values = values[np.isin(values, steps)]
            if count.name in self._fixed_discrete:
                values = values[np.abs(values - self._fixed_discrete[count.name]) < 1e-9]
            if not len(values):
                low, high, step = count.values[0], count.values[-1], np.ptp(count.values[:2])
                asked = [f"{SIGNS[x.sense]} {x.bound:g}" for x in bounding]
                asked += [f"in {shown_set(steps)}" for n, steps in self.count_sets if n == count.name]
                if count.name in self._fixed_discrete:
                    asked.append(f"== {self._fixed_discrete[count.name]:g}")
                expected = f"conditions that leave a value from {low:g} to {high:g} in steps of {step:g}"
                place = "fix" if count.name in self._fixed_discrete else "limits"
                raise InputError(count.name, " and ".join(asked), expected, (place, count.name))
            self.selection.counts[count.name] = values
        for choice in d.choices.values():
            indices = np.arange(len(choice.labels))
            if choice.name in self._fixed_discrete:
                label = self._fixed_discrete[choice.name]
                label = ("yes" if label else "no") if isinstance(label, bool) else str(label)
                if label not in choice.labels:
                    raise InputError(f"fix: {choice.name}", label, choice.expected(label), ("fix", choice.name))
                indices = np.array([choice.labels.index(label)])
            self.selection.choices[choice.name] = indices.astype(float)

    def _refuse_rows(self) -> None:
        """Leave out rows, counts and choices that a refusal over one of them forbids."""
        model = self.model
        known = self.symbol_values()
        self.joint_refusals: list[Any] = []
        for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
            if len(kinds) > 1:
                self.joint_refusals.append(refusal)
            elif kinds:
                self._refuse_one(refusal, next(iter(kinds)), known)

    def _refuse_one(self, refusal: Any, name: str, known: Mapping[str, float]) -> None:
        model, selection = self.model, self.selection
        slot = next((s for s in selection.slots if s.slot == name), None)
        if slot is not None:
            sx = {key: str(c.sx) for key, c in model.declaration.slots[name].columns.items()}
            size, columns = len(slot.rows), {sx[key]: values for key, values in slot.columns.items()}
        else:
            values = (selection.counts | selection.choices)[name]
            size, columns = len(values), {name: values}
        bad = np.array(
            [
                self._number(refusal.when, {**known, **{s: float(v[k]) for s, v in columns.items()}}) > 0.5
                for k in range(size)
            ],
            dtype=bool,
        )
        if not bad.any():
            return
        labels = [slot.table.designations[r] for r in slot.rows] if slot is not None else self._stepped_labels(name)
        for k in np.flatnonzero(bad):
            self._leave_out(name, labels[k], f"{refusal.code}: {refusal.message}")
        if bad.all():
            shown = ", ".join(labels[:5])
            choice = name in model.declaration.choices
            place = "parts" if slot is not None else "fix" if name in self._fixed_discrete else "limits"
            raise RefusedError(refusal.code, f"{name} = {shown}" if choice else shown, refusal.message, (place, name))
        if slot is not None:
            position = selection.slots.index(slot)
            selection.slots[position] = SlotRows(
                slot.slot, slot.table, slot.rows[~bad], {key: v[~bad] for key, v in slot.columns.items()}
            )
        elif name in selection.counts:
            selection.counts[name] = selection.counts[name][~bad]
        else:
            selection.choices[name] = selection.choices[name][~bad]

    def _refuse_without_partner(self) -> None:
        """Leave out rows that go with no row of another slot that they are compared with; count what is refused."""
        model, count = self.model, len(self.compared)
        every = list(zip(model.declaration.refusals, model.refusal_kinds, strict=True))
        self.combinations_left_out: list[str] = []
        for comparison, (refusal, names) in zip(self.compared, every[len(every) - count :], strict=True):
            slots = [s for s in self.selection.slots if s.slot in names]
            if len(slots) < 2 or math.prod(len(s.rows) for s in slots) > MOST_COMPARED:
                continue
            allowed = self.allowed_together(refusal, slots)
            for axis, slot in enumerate(slots):
                keep = allowed.any(axis=tuple(k for k in range(len(slots)) if k != axis))
                others = ", ".join(s.slot for s in slots if s is not slot)
                for k in np.flatnonzero(~keep):
                    label = slot.table.designations[slot.rows[k]]
                    self._leave_out(slot.slot, label, f"no row of {others} goes with it: {comparison}")
                if not keep.any():
                    right = f"a condition that some rows of {slot.slot} and {others} meet"
                    raise InputError(f"parts: {comparison.slot}", comparison.text, right, ("parts", comparison.slot))
                self.selection.slots[self.selection.slots.index(slot)] = SlotRows(
                    slot.slot, slot.table, slot.rows[keep], {key: v[keep] for key, v in slot.columns.items()}
                )
                allowed = np.compress(keep, allowed, axis=axis)
            rest = math.prod(len(s.rows) for s in self.selection.slots if s.slot not in names)
            rest *= math.prod(len(v) for v in (*self.selection.counts.values(), *self.selection.choices.values()))
            excluded, total = int((~allowed).sum()) * rest, allowed.size * rest
            self.combinations_left_out.append(f"{comparison}: {excluded} of {total}")

    def allowed_together(self, refusal: Any, slots: Sequence[SlotRows]) -> np.ndarray:
        """Return which rows of some slots a refusal allows together; one axis per slot."""
        model, shape = self.model, tuple(len(s.rows) for s in slots)
        symbols = {}
        for axis, slot in enumerate(slots):
            spread = [1] * len(slots)
            spread[axis] = -1
            for key, values in slot.columns.items():
                symbols[f"{slot.slot}.{key}"] = np.broadcast_to(values.reshape(spread), shape).ravel()
        data = [symbols.get(entry.label) if entry.kind == "part" else None for entry in model.data_inputs]
        refused = model.refused(refusal)([None] * len(model.variables) + data)[0]
        return ~(np.broadcast_to(np.asarray(refused), (math.prod(shape),)).reshape(shape) > 0.5)

    def _stepped_labels(self, name: str) -> list[str]:
        """Return the values of a count, or the labels of a choice, that remain."""
        choice = self.model.declaration.choices.get(name)
        if choice is not None:
            return [choice.labels[int(v)] for v in self.selection.choices[name]]
        return [f"{v:g}" for v in self.selection.counts[name]]

    # -- combinations --------------------------------------------------------------------------

    def owners(self) -> tuple[int, ...]:
        """Return, per data input of the model, the number of the factor it belongs to; -1: the question fixes it."""
        names = self.combinations.names
        return tuple(names.index(e.name) if e.name in names else -1 for e in self.model.data_inputs)

    def caps(self, f: int) -> dict[int, np.ndarray]:
        """Return what the alternatives of a factor allow objectives to be, by the number of the objective."""
        return {}

    def of(self, combination: int) -> Instance:
        """Return the question that a combination belongs to."""
        return self

    def data(self, combinations: np.ndarray) -> list[Any]:
        """Return the data inputs of the model for combinations given by number."""
        return inputs_of_combination(
            self.model, self.requirements, self.row_values, self.combinations, np.asarray(combinations, dtype=np.int64)
        )

    def column(self, position: int) -> np.ndarray:
        """Return data input number ``position`` for every alternative of the slot, count or choice it belongs to."""
        entry = self.model.data_inputs[position]
        return self.combinations.column(entry.name, entry.column)

    def fingerprint(self) -> Fingerprint:
        """Return what decides the numbers of an answer to this question, by which kept results are known again."""
        model, selection, problem = self.model, self.selection, self.problem
        asked = {
            "family": problem.name,
            "options": {name: option.chosen for name, option in model.declaration.options.items()},
            "restated": repr(problem.restated),
            "requirements": self.requirements,
            "rows": {s.slot: joined(s.table.hashes[int(r)] for r in s.rows) for s in selection.slots},
            "steps": {n: v.tolist() for n, v in {**selection.counts, **selection.choices}.items()},
            "ranges": [self.lower.tolist(), self.upper.tolist()],
            "grids": [grid.tolist() for grid in self.grids()],
            "limits": [[x.name, x.quantity, x.sense, x.bound] for x in self.own],
            "compared": [str(x) for x in self.compared],
        }
        computed = [model.function("sources", self._sources), native_code(), processor()]
        return Fingerprint(question=hash_of(asked), computation=hash_of(computed))

    def _sources(self) -> list[str]:
        """Return the hashes of the code, of the family's sources, and of the formulas that it has declared."""
        program = self.model.program
        formulas = hash_of([repr(x) for x in (*program.nodes, *program.outputs)])
        return [code_digest(), problem_digest([self.problem.declared_by]), formulas]

    def grids(self) -> list[np.ndarray]:
        """Return, per variable, the makeable values in force; empty where it is continuous."""
        result = []
        for k, v in enumerate(self.model.variables):
            values = v.grid if self.grid and not self.pinned[k] else np.empty(0)
            inside = within(values, self.lower[k], self.upper[k], 1e-12)
            if len(values) and not inside.any():
                low, high = format_quantity(self.lower[k], v.unit), format_quantity(self.upper[k], v.unit)
                right = "a range that holds a makeable value (or grid: false)"
                raise InputError(f"limits: {v.name}", f"{low} .. {high}", right, ("limits", v.name))
            result.append(values[inside])
        return result


def _compare(values: np.ndarray, sense: str, bound: float) -> np.ndarray:
    slack = 1e-9 * max(1.0, abs(bound))
    if sense == "at_most":
        return values <= bound + slack
    if sense == "at_least":
        return values >= bound - slack
    return np.abs(values - bound) <= slack


def _present(table: Table, names: Sequence[str]) -> np.ndarray:
    """Return which rows have a value in one of some columns."""
    present = np.zeros(len(table), dtype=bool)
    for name in names:
        if table.has(name):
            present |= ~np.isnan(table.number(name))
    return present
