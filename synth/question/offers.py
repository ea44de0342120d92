"""What a question offers: rows that conditions, rules and completeness leave, values of counts, labels of choices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeGuard

import numpy as np

from synth.declaration import Choice, Count, Part
from synth.errors import InputError, at
from synth.model.constraint import SYMBOLS, Constraint
from synth.model.model import Model
from synth.order.margins import MARGINS
from synth.question.count_domain import shown_set
from synth.question.inputs import part_value
from synth.question.selection import Selection, SlotRows
from synth.question.user_limits import UserLimits
from synth.tables.catalogs import Catalogs
from synth.tables.conditions import may_be_condition, parse_condition
from synth.tables.table import Table
from synth.text.numbers import typed_number


def select(model: Model, catalogs: Catalogs, rules: Mapping[str, object], limits: UserLimits) -> Selection:
    """Parts and values left by slots, rules, limits and pins; refusals of the family are not applied here.

    Parameters
    ----------
    model : Model
    catalogs : Catalogs
    rules : mapping
        Slot -> designations, or a condition on columns.
    limits : UserLimits

    Raises
    ------
    InputError
        When a rule cannot be understood, or nothing is left of a slot, count or choice.
    """
    d, selection = model.declaration, Selection()
    wanted = model.by_name(rules, "parts", list(d.slots), "a slot")
    for part in d.slots.values():
        table = catalogs.table(part.table)
        selection.offered[part.slot] = len(table)
        rows = np.flatnonzero(_rows_of(part, table, wanted, limits, selection))
        if not len(rows):
            _refuse_empty(part, table, wanted, limits, selection)
        columns = {key: part_value(table, rows, column.columns) for key, column in part.columns.items()}
        selection.slots.append(SlotRows(part.slot, table, rows, columns))
    for count in d.counts.values():
        selection.counts[count.name] = _values_of(count, limits)
    for choice in d.choices.values():
        selection.choices[choice.name] = _labels_of(choice, limits)
    return selection


# -- rows of slots -----------------------------------------------------------------------------


def offers(part: Part, table: Table) -> np.ndarray:
    """Rows of a table that meet the conditions of the slot."""
    keep = np.ones(len(table), dtype=bool)
    for text in part.where:
        keep &= _meets_once(text, table)
    return keep


@dataclass(frozen=True)
class _Rule:
    """A rule for the rows of a slot: which meet it, and of which an empty cell decides that (rows,)."""

    text: str
    met: np.ndarray
    undecided: np.ndarray


def _meets_once(text: str, table: Table) -> np.ndarray:
    """Rows that meet one condition of a slot, found once per table."""
    return table.once(("meets", text), partial(_meets, text, table))


def _undecided(rule: object, table: Table) -> np.ndarray:
    """Rows of which an empty cell decides whether they meet a rule: none where it is no condition on columns."""
    if _is_condition(rule, table):
        condition = parse_condition(rule).local()
        if all(table.has(c) for c in condition.columns if "." not in c):
            return condition.undecided(table)
    return np.zeros(len(table), dtype=bool)


def _undecided_of_user(text: str, table: Table) -> np.ndarray:
    """Rows of the user's own of which an empty cell decides whether they meet a condition of the slot."""
    return table.user_rows & _undecided(text, table) if table.user_rows.any() else table.user_rows.copy()


def _rows_of(
    part: Part, table: Table, wanted: Mapping[str, object], limits: UserLimits, selection: Selection
) -> np.ndarray:
    """Rows of the table that may fill a slot; those that are not complete are noted."""
    # Of shipped rows the family knows which its conditions leave out; a user learns which of theirs lack what decides.
    rules = [
        _Rule(text, _meets_once(text, table), table.once(("undecided", text), partial(_undecided_of_user, text, table)))
        for text in part.where
    ]
    if part.slot in wanted:
        asked = wanted[part.slot]
        with at("parts", part.slot):
            rules.append(_Rule(str(asked), _part_rule(part, table, asked), _undecided(asked, table)))
    if part.slot in limits.fixed:
        with at("fix", part.slot):
            pinned = np.arange(len(table)) == table.row_index(str(limits.fixed[part.slot]))
            rules.append(_Rule("", pinned, np.zeros(len(table), dtype=bool)))
    keep, perhaps = np.ones(len(table), dtype=bool), np.ones(len(table), dtype=bool)
    for rule in rules:
        keep, perhaps = keep & rule.met, perhaps & (rule.met | rule.undecided)
    for row in np.flatnonzero(perhaps & ~keep):
        text = next(rule.text for rule in rules if not rule.met[row])
        empty = " or ".join(c for c in sorted(parse_condition(text).columns) if table.has(c) and table.empty(c)[row])
        reason = f"no value in column {empty}, which the condition {text} asks for"
        selection.leave_out(part.slot, table.designations[row], reason)
    for column in part.columns.values():
        if not column.required:
            continue
        present = table.once(("present", column.columns), partial(_present, table, column.columns))
        for row in np.flatnonzero(keep & ~present):
            reason = f"no value in column {' or '.join(column.columns)}"
            selection.leave_out(part.slot, table.designations[row], reason)
        keep = keep & present
    return keep


def _refuse_empty(
    part: Part, table: Table, wanted: Mapping[str, object], limits: UserLimits, selection: Selection
) -> None:
    """Say why no row is left for a slot: by which condition, rule or missing value."""
    asked = [wanted[part.slot]] if part.slot in wanted else []
    asked += [[limits.fixed[part.slot]]] if part.slot in limits.fixed else []
    rows = np.ones(len(table), dtype=bool)
    for rule in asked:
        rows &= _part_rule(part, table, rule)
    names = ", ".join(table.designations[k] for k in np.flatnonzero(rows)[:5]) or "no row"
    lacking = sorted({e["reason"] for e in selection.left_out if e["slot"] == part.slot})
    failing = [c for c in part.where if not _meets(c, table)[rows].any()]
    if not rows.any():
        told = f" ({'; '.join(lacking)})" if lacking else ""
        expected = f"rules for this slot that leave at least one row of table {part.table}{told}"
    elif failing:
        expected = f"a row of table {part.table} with {' and '.join(failing)}"
    elif lacking:
        expected = f"a row of table {part.table} that is complete ({'; '.join(lacking)})"
    else:
        expected = f"a row of table {part.table} with {' and '.join(part.where)}"
    raise InputError(f"slot {part.slot}", names, expected, ("parts", part.slot))


def _meets(text: str, table: Table) -> np.ndarray:
    """Rows that meet one condition of a slot."""
    condition = parse_condition(text)
    missing = [c for c in condition.columns if not table.has(c)]
    if missing and table.user_rows.all():
        # A user's own table need not have the columns that sort the shipped one.
        return np.ones(len(table), dtype=bool)
    return condition.mask(table)


def _is_condition(rule: object, table: Table) -> TypeGuard[str]:
    """Whether a rule of the user is a condition on columns."""
    return isinstance(rule, str) and rule not in table.designations and may_be_condition(rule)


def _part_rule(part: Part, table: Table, rule: object) -> np.ndarray:
    """Rows that a rule of the user allows: a condition, a designation, or a list of these."""
    keep = np.zeros(len(table), dtype=bool)
    if _is_condition(rule, table):
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


def _present(table: Table, names: Sequence[str]) -> np.ndarray:
    """Rows with a value in one of some columns."""
    present = np.zeros(len(table), dtype=bool)
    for name in names:
        if table.has(name):
            present |= ~np.isnan(table.number(name))
    return present


# -- values of counts and choices --------------------------------------------------------------


def _values_of(count: Count, limits: UserLimits) -> np.ndarray:
    """Return the values of a count that limits, sets and a pin leave."""
    values, bounding, sets = count.values, limits.bounds_of(count.name), limits.sets_of(count.name)
    for limit in bounding:
        values = values[_meets_limit(values, limit)]
    for steps in sets:
        values = values[np.isin(values, steps)]
    pinned = count.name in limits.fixed
    if pinned:
        values = values[np.abs(values - limits.fixed[count.name]) < MARGINS.step]
    if len(values):
        return values
    low, high, step = count.values[0], count.values[-1], np.ptp(count.values[:2])
    asked = [f"{SYMBOLS[x.sense]} {typed_number(x.bound)}" for x in bounding] + [
        f"in {shown_set(steps)}" for steps in sets
    ]
    asked += [f"== {typed_number(limits.fixed[count.name])}"] if pinned else []
    ends = f"from {typed_number(low)} to {typed_number(high)}"
    expected = f"conditions that leave a value {ends} in steps of {typed_number(step)}"
    raise InputError(count.name, " and ".join(asked), expected, ("fix" if pinned else "limits", count.name))


def _meets_limit(values: np.ndarray, limit: Constraint) -> np.ndarray:
    slack = MARGINS.end * max(1.0, abs(limit.bound))
    if limit.sense == "at_most":
        return values <= limit.bound + slack
    if limit.sense == "at_least":
        return values >= limit.bound - slack
    return np.abs(values - limit.bound) <= slack


def _labels_of(choice: Choice, limits: UserLimits) -> np.ndarray:
    """Return the positions of the labels of a choice that a pin leaves."""
    if choice.name not in limits.fixed:
        return np.arange(len(choice.labels)).astype(float)
    label = limits.fixed[choice.name]
    label = ("yes" if label else "no") if isinstance(label, bool) else str(label)
    if label not in choice.labels:
        raise InputError(f"fix: {choice.name}", label, choice.expected(label), ("fix", choice.name))
    return np.array([choice.labels.index(label)]).astype(float)
