"""The row of a table that is next to a quantity of a design, as results tell it."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from synth.units import typed_quantity


@dataclass(frozen=True)
class NextRow:
    """The row of a table whose column is smallest but not below what a design needs; quantities in SI.

    Attributes
    ----------
    needed : float
        What the design needs, or the size that was typed.
    unit : str
        In which people read it.
    table : str
    designation : str or None
        The row; None where the table ends below what is needed.
    value : float or None
        What the row has.
    last : float or None
        The largest value that the table has; None where it has none.
    beside_table, beside : str or None
        The second table that was asked, and its row for the value; None where none was asked, or none fits.
    typed : bool
        Whether ``needed`` is a size that the user stated.
    """

    needed: float
    unit: str
    table: str
    designation: str | None
    value: float | None
    last: float | None
    beside_table: str | None = None
    beside: str | None = None
    typed: bool = False

    def __str__(self) -> str:
        """Row to take, in one short line."""
        needed = f"{typed_quantity(self.needed, self.unit, 5)} {'typed' if self.typed else 'needed'}"
        if self.designation is None or self.value is None:
            ends = "has no row" if self.last is None else f"ends at {typed_quantity(self.last, self.unit, 5)}"
            return f"none, {needed} and table {self.table} {ends}"
        line = f"{self.designation} ({typed_quantity(self.value, self.unit, 5)}, {needed})"
        if self.beside_table is None:
            return line
        return f"{line} with {self.beside}" if self.beside else f"{line}, for which {self.beside_table} has no row"

    def record(self) -> dict[str, Any]:
        """Entry of front.json."""
        return asdict(self)
