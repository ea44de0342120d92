"""Rows, counts and choices for which an objective or a limited quantity does not exist: left out, counted and named."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from synth.errors import InputError
from synth.model.model import Model
from synth.model.program import COMPARISONS, OP_SELECT, TRAITS, InputValue, Program
from synth.operations.record import Trait
from synth.question.refusals import labels_of
from synth.question.requirement_values import RequirementValues
from synth.question.selection import Selection
from synth.question.variable_ranges import VariableRanges

# Operations with an infinite result, or none, where an argument is infinite. Of a quotient that is the dividend.
STAYS_INFINITE = {op for op, traits in TRAITS.items() if Trait.STAYS_INFINITE in traits}


@dataclass(frozen=True)
class _Lost:
    """Rows for which a node is surely no number, and rows for which it is surely not finite (rows,)."""

    no_number: np.ndarray
    not_finite: np.ndarray

    @staticmethod
    def of(values: np.ndarray) -> _Lost:
        """Rows where numbers say so."""
        return _Lost(np.isnan(values), ~np.isfinite(values))


@dataclass(frozen=True)
class _Reading:
    """Nodes between the rows of one slot, count or choice and the quantities asked about.

    ``decided`` (nodes,): the rows, and what the question fixes, settle the node. ``ends``: decided nodes that others
    read, or that are asked about; ``compute`` returns their values.
    """

    program: Program
    order: Sequence[int]
    decided: np.ndarray
    ends: Sequence[int]
    compute: Callable[[Sequence[Any]], list[Any]]

    @staticmethod
    def made(program: Program, own: Sequence[int], free: Sequence[int], asked: Sequence[int]) -> _Reading:
        """Nodes read for some inputs of the rows, where other inputs are free."""
        order, moved = program.needed(asked), program.dependence(own)
        decided = ~program.dependence(free)
        read = {a for k in order if not decided[k] for a in program.nodes[k].args} | set(asked)
        ends = [k for k in order if decided[k] and moved[k] and k in read]
        conditions = {program.nodes[k].args[0] for k in order if program.nodes[k].op in (OP_SELECT, ca.OP_IF_ELSE_ZERO)}
        ends += [k for k in order if decided[k] and not moved[k] and k in read & conditions]
        return _Reading(program, order, decided, ends, program.compile(ends))

    def lost(self, inputs: Sequence[Any], count: int) -> Mapping[int, _Lost]:
        """Rows that leave nodes without a value, whatever else is chosen; empty where all have one."""
        with np.errstate(all="ignore"):
            values = {
                k: np.broadcast_to(np.asarray(x, dtype=float), (count,))
                for k, x in zip(self.ends, self.compute(inputs), strict=True)
            }
        divisors = {self.program.nodes[k].args[1] for k in self.order if self.program.nodes[k].op == ca.OP_DIV}
        if all(np.isfinite(x).all() and (k not in divisors or x.all()) for k, x in values.items()):
            return {}
        nothing = np.zeros(count, dtype=bool)
        found: dict[int, _Lost] = {k: _Lost.of(x) for k, x in values.items()}
        for k in self.order:
            if not self.decided[k]:
                found[k] = self._lost(k, found, values, nothing)
            else:
                found.setdefault(k, _Lost(nothing, nothing))
        return found

    def _lost(self, k: int, found: Mapping[int, _Lost], values: Mapping[int, np.ndarray], nothing: np.ndarray) -> _Lost:
        """Rows that leave a node that is not decided without a value."""
        node = self.program.nodes[k]
        if node.op in COMPARISONS or not node.args:
            return _Lost(nothing, nothing)
        if node.op in (OP_SELECT, ca.OP_IF_ELSE_ZERO):
            condition, first, *second = node.args
            yes, no = found[first], found[second[0]] if second else _Lost(nothing, nothing)
            if self.decided[condition]:
                holds = values[condition] != 0.0  # not-a-number counts as true, as in NumPy
                return _Lost(
                    np.where(holds, yes.no_number, no.no_number), np.where(holds, yes.not_finite, no.not_finite)
                )
            return _Lost(yes.no_number & no.no_number, yes.not_finite & no.not_finite)
        args = node.args[:1] if node.op == ca.OP_COPYSIGN else node.args
        no_number = np.logical_or.reduce([found[a].no_number for a in args])
        if node.op not in STAYS_INFINITE:
            return _Lost(no_number, no_number)
        infinite = [found[a].not_finite for a in (args[:1] if node.op == ca.OP_DIV else args)]
        if node.op == ca.OP_DIV and args[1] in values:
            infinite.append(values[args[1]] == 0.0)
        return _Lost(no_number, np.logical_or.reduce([no_number, *infinite]))


def leave_out_without_value(
    model: Model, ranges: VariableRanges, values: RequirementValues, selection: Selection, quantities: Sequence[str]
) -> None:
    """Leave out rows, counts and choices with which a quantity has no finite value, whatever else is chosen.

    Parameters
    ----------
    model : Model
    ranges : VariableRanges
    values : RequirementValues
    selection : Selection
        Is changed.
    quantities : list of str
        Objectives, and what the user limits.

    Raises
    ------
    InputError
        When nothing is left of a slot, count or choice.
    """
    asked = {name: model.quantity_node[name] for name in quantities}
    for name in [s.slot for s in selection.slots] + [*selection.counts, *selection.choices]:
        own = [len(model.variables) + k for k, entry in enumerate(model.data_inputs) if entry.name == name]
        moved = model.program.dependence(own)
        read = {quantity: node for quantity, node in asked.items() if moved[node]}
        if read:
            inputs = _inputs(model, ranges, values, selection, name)
            _leave_out_of(model, selection, name, own, read, inputs)


def _inputs(
    model: Model, ranges: VariableRanges, values: RequirementValues, selection: Selection, name: str
) -> list[InputValue | None]:
    """Give the program what the question and the rows of one slot, count or choice decide, and None elsewhere."""
    given: list[InputValue | None] = [
        float(low) if low == high else None for low, high in zip(ranges.lower, ranges.upper, strict=True)
    ]
    steps = {**selection.counts, **selection.choices}
    for entry in model.data_inputs:
        if entry.kind == "requirement":
            given.append(values.requirements[entry.name])
        elif entry.kind == "row":
            given.append(values.rows[str(entry.sx)])
        else:
            slot = selection.slot(entry.name)
            column = steps[entry.name] if slot is None else slot.columns[entry.column]
            given.append(column if entry.name == name else float(column[0]) if len(column) == 1 else None)
    return given


def _leave_out_of(
    model: Model,
    selection: Selection,
    name: str,
    own: Sequence[int],
    read: Mapping[str, int],
    inputs: Sequence[InputValue | None],
) -> None:
    """Leave out the rows of one slot, count or choice for which a quantity that reads them does not exist."""
    free, nodes = tuple(k for k, x in enumerate(inputs) if x is None), tuple(read.values())
    reading: _Reading = model.function(
        ("without value", name, free, nodes), lambda: _Reading.made(model.program, own, free, nodes)
    )
    labels = labels_of(model, selection, name)
    found = reading.lost(inputs, len(labels))
    if not found:
        return
    keep = np.ones(len(labels), dtype=bool)
    for quantity, node in read.items():
        gone = found[node].not_finite
        for k in np.flatnonzero(keep & gone):
            selection.leave_out(name, labels[k], _reason(model, own, inputs, quantity, node, int(k)))
        keep &= ~gone
    if not keep.any():
        reasons = dict.fromkeys(entry["reason"] for entry in selection.left_out if entry["slot"] == name)
        shown = ", ".join(labels[:5]) + (f" and {len(labels) - 5} more" if len(labels) > 5 else "")
        place = "parts" if name in model.declaration.slots else "limits"
        right = f"one with which {' and '.join(read)} can be computed ({'; '.join(reasons)})"
        raise InputError(name, shown, right, (place, name))
    selection.keep(name, keep)


def _reason(
    model: Model, own: Sequence[int], inputs: Sequence[InputValue | None], quantity: str, node: int, row: int
) -> str:
    """Why a row leaves a quantity without a value: the empty cells it reads, or that it is not finite."""
    empty = dict.fromkeys(
        column
        for k in own
        for column in model.data_inputs[k - len(model.variables)].columns
        if np.isnan(np.asarray(inputs[k])[row]) and model.program.dependence([k])[node]
    )
    if empty:
        return f"no value in column {' or '.join(empty)}, which {quantity} needs"
    return f"{quantity} is not a finite number"
