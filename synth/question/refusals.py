"""What is refused of a question: requirement values, rows and values by themselves, and rows without partners."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import casadi as ca
import numpy as np

from synth.declaration import Refusal
from synth.errors import InputError, RefusedError
from synth.model.model import Model
from synth.model.program import InputValue
from synth.model.slot_comparison import SlotComparison
from synth.question.requirement_values import RequirementValues
from synth.question.selection import Selection, SlotRows
from synth.special import expanded
from synth.text.numbers import typed_number
from synth.units import typed_quantity

# Rows of slots together whose comparison is looked at before the search. Part of the question, not of how it is
# searched: it decides which rows a result tells as left out.
MOST_COMPARED = 4_000_000


def refuse_requirements(model: Model, values: RequirementValues) -> None:
    """Raise what the family refuses whatever is chosen.

    Raises
    ------
    RefusedError
    """
    known = values.by_symbol(model)
    for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
        if not kinds and model.number(refusal.when, known) > 0.5:
            raise _refused(model, values, refusal)


def _refused(model: Model, values: RequirementValues, refusal: Refusal) -> RefusedError:
    """Return the fault of what the family refuses: in requirements, or where it speaks of none in options."""
    d, used = model.declaration, {str(s) for s in ca.symvar(expanded(refusal.when, model.calls))}
    shown = {
        r.name: f"{r.name} = {typed_quantity(values.requirements[r.name], r.unit)}"
        for r in d.requirements.values()
        if r.name in values.requirements and str(r.sx) in used
    }
    place = "requirements" if shown else "options"
    shown = shown or {o.name: f"{o.name} = {o.chosen}" for o in d.options.values() if o.chosen != o.default}
    path = (place, *shown) if len(shown) == 1 else (place,)
    return RefusedError(refusal.code, ", ".join(shown.values()), refusal.message, path)


def leave_out_refused(
    model: Model, values: RequirementValues, selection: Selection, fixed: Mapping[str, object]
) -> None:
    """Leave out rows, counts and choices that a refusal over one of them forbids; note the refusals over several.

    Parameters
    ----------
    model : Model
    values : RequirementValues
    selection : Selection
        Is changed.
    fixed : mapping
        What is pinned, by slot, count or choice.

    Raises
    ------
    RefusedError
        When nothing is left of one of them.
    """
    known = values.by_symbol(model)
    for refusal, kinds in zip(model.declaration.refusals, model.refusal_kinds, strict=True):
        if len(kinds) > 1:
            selection.joint_refusals.append(refusal)
        elif kinds:
            _leave_out_one(model, selection, refusal, next(iter(kinds)), known, fixed)


def _leave_out_one(
    model: Model,
    selection: Selection,
    refusal: Refusal,
    name: str,
    known: Mapping[str, float],
    fixed: Mapping[str, object],
) -> None:
    """Leave out what a refusal forbids of one slot, count or choice."""
    bad = np.array(
        [model.number(refusal.when, {**known, **own}) > 0.5 for own in _alternatives(model, selection, name)],
        dtype=bool,
    )
    if not bad.any():
        return
    labels = labels_of(model, selection, name)
    for k in np.flatnonzero(bad):
        selection.leave_out(name, labels[k], f"{refusal.code}: {refusal.message}")
    if bad.all():
        shown = ", ".join(labels[:5])
        place = "parts" if name in model.declaration.slots else "fix" if name in fixed else "limits"
        shown = f"{name} = {shown}" if name in model.declaration.choices else shown
        raise RefusedError(refusal.code, shown, refusal.message, (place, name))
    selection.keep(name, ~bad)


def _alternatives(model: Model, selection: Selection, name: str) -> list[dict[str, float]]:
    """Return the values of the symbols of each alternative of a slot, count or choice."""
    slot = selection.slot(name)
    if slot is None:
        return [{name: float(value)} for value in (selection.counts | selection.choices)[name]]
    symbols = {key: str(c.sx) for key, c in model.declaration.slots[name].columns.items()}
    return [{symbols[key]: float(values[k]) for key, values in slot.columns.items()} for k in range(len(slot.rows))]


def labels_of(model: Model, selection: Selection, name: str) -> list[str]:
    """Names of the alternatives of a slot, count or choice."""
    slot, choice = selection.slot(name), model.declaration.choices.get(name)
    if slot is not None:
        return slot.labels()
    if choice is not None:
        return [choice.labels[int(v)] for v in selection.choices[name]]
    return [typed_number(v) for v in selection.counts[name]]


# -- conditions that compare slots -------------------------------------------------------------


def leave_out_without_partner(model: Model, compared: Sequence[SlotComparison], selection: Selection) -> None:
    """Leave out rows that go with no row of another slot that they are compared with; count what is refused.

    Parameters
    ----------
    model : Model
        Whose last refusals are those of the comparisons.
    compared : list of SlotComparison
    selection : Selection
        Is changed.

    Raises
    ------
    InputError
        When no rows go together.
    """
    every = list(zip(model.declaration.refusals, model.refusal_kinds, strict=True))
    for comparison, (refusal, names) in zip(compared, every[len(every) - len(compared) :], strict=True):
        slots = [s for s in selection.slots if s.slot in names]
        if len(slots) >= 2 and math.prod(len(s.rows) for s in slots) <= MOST_COMPARED:
            allowed = _keep_partners(comparison, slots, allowed_together(model, refusal, slots), selection)
            rest = math.prod(len(s.rows) for s in selection.slots if s.slot not in names)
            rest *= math.prod(len(v) for v in (*selection.counts.values(), *selection.choices.values()))
            excluded, total = int((~allowed).sum()) * rest, allowed.size * rest
            selection.combinations_left_out.append(f"{comparison}: {excluded} of {total}")


def _keep_partners(
    comparison: SlotComparison, slots: Sequence[SlotRows], allowed: np.ndarray, selection: Selection
) -> np.ndarray:
    """Keep the rows that have a partner; return which of them go together."""
    for axis, slot in enumerate(slots):
        keep: np.ndarray = np.any(allowed, axis=tuple(k for k in range(len(slots)) if k != axis))
        others = ", ".join(s.slot for s in slots if s is not slot)
        labels = slot.labels()
        for k in np.flatnonzero(~keep):
            selection.leave_out(slot.slot, labels[k], f"no row of {others} goes with it: {comparison}")
        if not keep.any():
            right = f"a condition that some rows of {slot.slot} and {others} meet"
            raise InputError(f"parts: {comparison.slot}", comparison.text, right, ("parts", comparison.slot))
        selection.keep(slot.slot, keep)
        allowed = np.compress(keep, allowed, axis=axis)
    return allowed


def allowed_together(model: Model, refusal: Refusal, slots: Sequence[SlotRows]) -> np.ndarray:
    """Rows of some slots that a refusal allows together; one axis per slot.

    Parameters
    ----------
    model : Model
    refusal : Refusal
        That speaks of these slots alone.
    slots : list of SlotRows
    """
    shape = tuple(len(s.rows) for s in slots)
    symbols = {}
    for axis, slot in enumerate(slots):
        spread = [1] * len(slots)
        spread[axis] = -1
        for key, values in slot.columns.items():
            symbols[f"{slot.slot}.{key}"] = np.broadcast_to(values.reshape(spread), shape).ravel()
    data = [symbols.get(entry.label) if entry.kind == "part" else None for entry in model.data_inputs]
    return allowed_rows(model, [refusal], data, math.prod(shape)).reshape(shape)


def allowed_rows(
    model: Model, refusals: Sequence[Refusal], data: Sequence[InputValue | None], count: int
) -> np.ndarray:
    """Tell which of a batch of inputs some refusals allow (batch,).

    Parameters
    ----------
    model : Model
    refusals : list of Refusal
    data : list of numbers or arrays (batch,)
        One entry per data input of the model; None for those that the refusals do not read.
    count : int
        Size of the batch.
    """
    keep = np.ones(count, dtype=bool)
    inputs = [None] * len(model.variables) + list(data)
    for refusal in refusals:
        keep &= ~(np.asarray(model.refused(refusal)(inputs)[0]) > 0.5)
    return keep
