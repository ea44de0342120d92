"""The discrete unknowns of a question as records: what remains of each, and why the rest was left out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from synth.declaration import Refusal
from synth.results import PartRow
from synth.tables.table import Table


@dataclass(frozen=True)
class SlotRows:
    """The rows of a table that may fill a slot, and their numbers for the model."""

    slot: str
    table: Table
    rows: np.ndarray
    columns: dict[str, np.ndarray]

    def take(self, keep: np.ndarray) -> SlotRows:
        """Return some of them, given by a mask."""
        return SlotRows(self.slot, self.table, self.rows[keep], {key: v[keep] for key, v in self.columns.items()})

    def labels(self) -> list[str]:
        """Return the designations of the rows."""
        return [self.table.designations[r] for r in self.rows]


@dataclass
class Selection:
    """What remains of the discrete unknowns, and why the rest was left out.

    Parameters
    ----------
    slots : list of SlotRows
        In the order of their declaration.
    counts : dict
        Count -> values that remain.
    choices : dict
        Choice -> positions of the labels that remain.
    left_out : list
        Slot, designation and reason of what was left out although it was offered.
    offered : dict
        Slot -> rows of its table.
    joint_refusals : list of Refusal
        What speaks of several unknowns: it leaves out no row of one, but combinations.
    combinations_left_out : list of str
        What conditions that compare slots exclude, in words.
    """

    slots: list[SlotRows] = field(default_factory=list)
    counts: dict[str, np.ndarray] = field(default_factory=dict)
    choices: dict[str, np.ndarray] = field(default_factory=dict)
    left_out: list[dict[str, str]] = field(default_factory=list)
    offered: dict[str, int] = field(default_factory=dict)
    joint_refusals: list[Refusal] = field(default_factory=list)
    combinations_left_out: list[str] = field(default_factory=list)

    def slot(self, name: str) -> SlotRows | None:
        """Return the rows of a slot; None where the name is that of a count or choice."""
        return next((s for s in self.slots if s.slot == name), None)

    def leave_out(self, name: str, label: str, reason: str) -> None:
        """Note why a row, or a value of a count or choice, is not offered."""
        self.left_out.append({"slot": name, "designation": label, "reason": reason})

    def keep(self, name: str, keep: np.ndarray) -> None:
        """Keep some of the rows of a slot, or of the values of a count or choice, given by a mask."""
        if name in self.counts:
            self.counts[name] = self.counts[name][keep]
        elif name in self.choices:
            self.choices[name] = self.choices[name][keep]
        else:
            self.slots = [s.take(keep) if s.slot == name else s for s in self.slots]


def part_row(table: Table, index: int) -> PartRow:
    """Row of a table as results show it."""
    units = {}
    if table.user_rows[index]:
        units = {n: x.unit or "" for n, x in table.columns.items() if not x.description and x.heading != n}
    return PartRow(table.name, table.hashes[index], table.row(index), units)
