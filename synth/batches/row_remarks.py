"""What a screen tells of the rows of a table: which cannot be asked, and which columns a family does not use."""

from __future__ import annotations

from dataclasses import dataclass, field

from synth.batches.row_questions import Fault, ReadRow
from synth.batches.settings import PlanSettings


@dataclass
class FaultLines:
    """Where a fault stands: the first of its kind, other lines, and in how many it is."""

    first: Fault
    others: list[int] = field(default_factory=list)
    count: int = 1


class RowRemarks:
    """Remarks on the rows of a table; of many the first are kept.

    Parameters
    ----------
    settings : PlanSettings
    """

    def __init__(self, settings: PlanSettings) -> None:
        self._settings = settings
        self._faults: dict[tuple[str, str | None, str], FaultLines] = {}  # by column, value and what is right
        self.bad = 0  # rows that cannot be asked,
        self.shown = 0  # and those of them of which a fault is kept
        self.unused: dict[str, set[str]] = {}  # family -> columns that it does not have

    @property
    def faults(self) -> list[FaultLines]:
        """Faults by kind."""
        return list(self._faults.values())

    def add(self, row: ReadRow) -> None:
        """Take note of a row."""
        if row.unused:
            self.unused.setdefault(row.family, set()).update(row.unused)
        if row.faults:
            self.bad += 1
            self.shown += any([self._is_kept(fault) for fault in row.faults])

    def _is_kept(self, fault: Fault) -> bool:
        kind = (fault.column, fault.value, fault.expected)
        known = self._faults.get(kind)
        if known is not None:
            known.count += 1
            if len(known.others) < self._settings.shown_lines:
                known.others.append(fault.line)
        elif len(self._faults) < self._settings.shown_faults:
            self._faults[kind] = FaultLines(fault)
        else:
            return False
        return True
