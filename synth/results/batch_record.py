"""What a batch has come to, as reports take it: rows in words and numbers, one of them in full."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from synth.drawing import Drawing
from synth.results.calculation import Calculation

if TYPE_CHECKING:
    from synth.results import ParetoFront

# How rows stand, those with designs first, then what somebody must look at.
WITH_DESIGNS = ("optimal", "feasible")
FAILURES = ("failed", "refused", "bad_input", "infeasible", "not_found")
STATUSES = (*WITH_DESIGNS, *FAILURES, "not_solved")
IN_WORDS = {
    "optimal": "with proven designs",
    "feasible": "with designs that are not proven",
    "infeasible": "without a feasible design",
    "not_found": "without a design found",
    "bad_input": "with bad input",
    "refused": "refused by the search",
    "failed": "failed",
    "not_solved": "not solved yet",
}
STATES = {  # of one row
    "optimal": "proven",
    "feasible": "not proven",
    "infeasible": "not feasible",
    "not_found": "none found",
    "bad_input": "bad input",
    "refused": "refused",
    "failed": "failed",
    "not_solved": "not solved yet",
}


@dataclass(frozen=True, slots=True)
class BatchRow:
    """A row of a batch.

    Parameters
    ----------
    line : int
        Of the table that was brought.
    key : str
        The first digits of what it asks; empty where it asks nothing.
    family, status : str
    designs : int
        How many it has.
    objectives : tuple
        Of its best design, in the units of the headings of the record; None where the row has no such objective.
    best : str
        Sizes, choices and parts of its best design in words.
    reason : str
        Why it has no design, or was stopped.
    causes : tuple of str
        What stands in its way: columns that are wrong, limits that the nearest design misses.
    remarks : str
    cells : tuple of str
        As they were brought.
    """

    line: int
    key: str
    family: str
    status: str
    designs: int
    objectives: tuple[float | None, ...]
    best: str
    reason: str
    causes: tuple[str, ...]
    remarks: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class RowInFull:
    """One row of a batch, with its front computed again from what is kept of it.

    ``note`` tells why there is no front; ``drawing`` is that of its first design.
    """

    row: BatchRow
    front: ParetoFront | None = None
    calculation: Calculation | None = None
    drawing: Drawing | None = None
    note: str = ""


@dataclass(frozen=True)
class BatchRecord:
    """A batch.

    Parameters
    ----------
    source : str
        The table that was brought.
    state : str
        Of the job: ``done``, or how it stands before.
    rows : list of BatchRow
        In the order of the table.
    headings : tuple of str
        Of the table.
    carried : tuple of int
        Positions of columns that are only carried along: names of machines, for example.
    objectives : tuple of str
        Headings with units.
    settings, hashes, versions : mapping
        What was asked of all rows, and with what.
    chosen : RowInFull, optional
    size_range : mapping, optional
        ``told`` of size_range.json, ``columns`` and ``rows`` of variants.csv.
    """

    source: str
    state: str
    rows: Sequence[BatchRow]
    headings: tuple[str, ...]
    carried: tuple[int, ...]
    objectives: tuple[str, ...]
    settings: Mapping[str, Any]
    hashes: Mapping[str, str]
    versions: Mapping[str, str]
    chosen: RowInFull | None = None
    size_range: Mapping[str, Any] | None = field(default=None, repr=False)

    @property
    def counts(self) -> dict[str, int]:
        """Rows by status, in the order of ``STATUSES``."""
        by_status = dict.fromkeys(STATUSES, 0)
        for row in self.rows:
            by_status[row.status] = by_status.get(row.status, 0) + 1
        return {status: count for status, count in by_status.items() if count}

    @property
    def answered(self) -> int:
        """Rows of which nothing is left to be done."""
        return len(self.rows) - self.counts.get("not_solved", 0)

    @property
    def finished(self) -> bool:
        """Whether the batch is done."""
        return self.state == "done"
