"""What a declaration consists of: frozen records of requirements, variables, parts, limits and objectives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from numbers import Number, Real
from typing import Any, TypeAlias

import casadi as ca
import numpy as np

from synth.errors import DeclarationError, InputError
from synth.text.row_cells import CODE_OF, ELSE, text_code

# A CasADi symbol or an expression of symbols, in SI; no class that formulas could be checked against exists for both.
Quantity: TypeAlias = Any


@dataclass(frozen=True)
class RequirementRecord:
    """What the user states. ``default`` is an SI number, an expression of earlier symbols, or None.

    One that ``follows`` is not stated: formulas read its default, and not its symbol. ``instead``: others that its
    default is made of where they are stated.
    """

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    default: Any
    lower: float
    upper: float
    optional: bool
    given: bool
    group: str
    sx: Any
    follows: bool = False
    instead: tuple[str, ...] = ()


@dataclass(frozen=True)
class OptionRecord:
    """A structural choice of the user, fixed before the search."""

    name: str
    symbol: str
    text: str
    source: str
    choices: tuple[str, ...]
    default: str
    chosen: str
    group: str
    structural: bool = True  # whether what is declared may depend on it; else numbers alone do

    @property
    def structures(self) -> tuple[str, ...]:
        """Choices with which other names may be declared."""
        return self.choices if self.structural else ()


@dataclass(frozen=True)
class VariableRecord:
    """An unknown of the search with bounds in SI; ``grid`` holds the makeable values in SI, or is empty.

    ``within``: expressions of requirements, in SI, between which it is searched inside its bounds.
    """

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    lower: float
    upper: float
    grid: np.ndarray
    sx: Any
    within: tuple[ca.SX, ca.SX] | None = None


@dataclass(frozen=True)
class Count:
    """A stepped integer (or half-integer) unknown; ``values`` are all its steps."""

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    values: np.ndarray
    sx: Any


def _same(record: object, other: object, what: str, instead: str) -> bool:
    """Whether something is the same record.

    Raises
    ------
    DeclarationError
        It is a text, a number or a formula: what a record stands for is not known in a declaration.
    """
    if isinstance(other, (str, Number, np.ndarray, ca.SX)):
        raise DeclarationError(f"{what} is compared with {other!r}, but not known in a declaration; use {instead}")
    return record is other


@dataclass(frozen=True, eq=False)
class Choice:
    """A discrete unknown that the search decides; its symbol is the index of the label.

    ``refused`` holds labels that people ask for and that cannot be offered, each with the reason.
    """

    name: str
    symbol: str
    text: str
    source: str
    labels: tuple[str, ...]
    sx: Any
    refused: Mapping[str, str] = field(default_factory=dict)

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        """Refuse a comparison with a label or its number, which would be false whatever the search decides."""
        branches = ", ".join(f"{label!r}: ..." for label in self.labels)
        return _same(self, other, f"choice {self.name}", f"{self.name}.select({{{branches}}})")

    def expected(self, label: str) -> str:
        """Texts that may replace a label that is not offered, with the reason where there is one."""
        reason = self.refused.get(label)
        return "one of " + ", ".join(self.labels) + (f"; {reason}" if reason else "")

    def select(self, values: Mapping[str, Any]) -> Any:
        """Return the value that belongs to the chosen label.

        Parameters
        ----------
        values : mapping
            One expression or number for every label.

        Raises
        ------
        DeclarationError
            When the labels do not match those of the choice.
        """
        if set(values) != set(self.labels):
            raise DeclarationError(f"choice {self.name}: select() must name exactly the labels {self.labels}")
        result: Any = ca.SX(values[self.labels[-1]])
        for index, label in reversed(list(enumerate(self.labels[:-1]))):
            result = ca.if_else(self.sx == index, values[label], result)
        return result


@dataclass(eq=False)
class Part:
    """One row of a catalogue table, seen through symbols.

    Attribute access gives the SI symbol of a number column.
    """

    slot: str
    table: str
    where: tuple[str, ...]
    symbol: str
    text: str
    source: str
    is_slot: bool
    known: frozenset[str]
    columns: dict[str, PartColumn] = field(default_factory=dict)
    texts: dict[str, set[str]] = field(default_factory=dict)  # that formulas ask for, by column

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        """Refuse a comparison with a designation or a number, which would be false whatever the search decides."""
        return _same(self, other, f"part {self.slot}", f"{self.slot}.says(column, text), or a column of numbers")

    def __getattr__(self, column: str) -> Any:
        if column.startswith("_"):
            raise AttributeError(column)
        # Whether a table may lack it is known once all is declared: ``Declaration.settle_columns``.
        return self._symbol((column,), required=True)

    def lacking(self, column: str, hint: str = "") -> InputError:
        """Fault of a table without a column that the problem cannot do without."""
        right = f"a number column, which slot {self.slot} uses{hint}"
        return InputError(f"table {self.table}, column {column}", None, right, ("catalogs", self.table, column))

    def code(self, column: str) -> Any:
        """Return a number that stands for the text of a column: the same in all tables for the same text."""
        return self._symbol((f"{CODE_OF}{column}",), required=True)

    def says(self, column: str, text: str) -> Any:
        """Return whether a column of text says this in the row; an empty text: whether it says nothing."""
        self.texts.setdefault(column, set()).add(text)
        return self.code(column) == text_code(text)

    def optional(self, column: str) -> Any:
        """Return a column that table or row may lack; limits that use it are void there."""
        return self._symbol((column,), required=False)

    def filled(self, column: str, value: float) -> Any:
        """Return a column, and a number in SI where table or row lack it; no row is left out for the lack."""
        if not (isinstance(value, Real) and np.isfinite(value)):
            raise DeclarationError(f"slot {self.slot}: {value!r} fills column {column}; it must be a finite number")
        return self._symbol((f"{column}{ELSE}{float(value)!r}",), required=True)

    def first_of(self, *columns: str) -> Any:
        """Return the first of several columns that the row has a value for."""
        return self._symbol(columns, required=True)

    def _symbol(self, columns: tuple[str, ...], required: bool) -> Any:
        key = "|".join(columns)
        known = self.columns.get(key)
        if known is None:
            self.columns[key] = PartColumn(self.slot, columns, required, ca.SX.sym(f"{self.slot}.{key}"))
        elif required and not known.required:
            # One use that cannot do without the column is enough; the other uses keep their symbol.
            self.columns[key] = PartColumn(self.slot, columns, required, known.sx)
        return self.columns[key].sx


@dataclass(frozen=True)
class PartColumn:
    """A column (or first of several) used by the problem, and its symbol."""

    slot: str
    columns: tuple[str, ...]
    required: bool
    sx: Any


@dataclass(frozen=True)
class Derived:
    """A named, reported quantity; it exists only where the guards in ``needs`` hold.

    No limit above ``ceiling`` (SI) may be typed for it.
    """

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    needs: tuple[str, ...]
    sx: Any
    ceiling: float = np.inf


class Origin(StrEnum):
    """Who states a limit."""

    FAMILY = "family"
    USER = "user"
    PIN = "pin"  # the user, who fixes a derived quantity
    RANGE = "range"  # of the family or the user, at a corner of what scatters


@dataclass(frozen=True)
class Step:
    """A named quantity on the way to others, which is not among the public results."""

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    sx: Any


@dataclass(frozen=True)
class Constant:
    """A number of nature or of a source that formulas hold, in SI."""

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    value: float


@dataclass(frozen=True)
class RowRange:
    """The row of a second table whose range holds a value: above its column ``over``, up to its column ``up_to``."""

    table: str
    over: str
    up_to: str


@dataclass(frozen=True)
class NextRowRecord:
    """The row of a table whose column is next at or above a quantity, and the row of another one that goes with it."""

    name: str
    unit: str
    symbol: str
    text: str
    source: str
    sx: Any
    table: str
    column: str
    beside: RowRange | None
    typed: bool


@dataclass(frozen=True)
class Headline:
    """What people decide by: quantities in the order of a table, and the limit by which a design is sized."""

    shown: tuple[str, ...] = ()
    sized_by: str = ""


@dataclass(frozen=True)
class Limit:
    """A limit ``value <= limit`` (at_most), ``value >= limit`` (at_least) or ``value == limit`` (equal)."""

    name: str
    sense: str
    unit: str
    text: str
    source: str
    value: Any
    limit: Any
    guard: bool
    scale: float
    origin: Origin = Origin.FAMILY


@dataclass(frozen=True)
class Objective:
    """A quantity to be made small ("min") or large ("max")."""

    name: str
    sense: str
    default: bool
    resolution: float | None = None  # in the unit of the quantity


@dataclass(frozen=True)
class Refusal:
    """Input that must be refused when the condition holds."""

    code: str
    when: Any
    message: str


@dataclass(frozen=True)
class Advice:
    """A remark printed on the designs for which the condition holds."""

    code: str
    when: Any
    message: str
    source: str


@dataclass(frozen=True)
class Setting:
    """Something that a simulation may be told beside the requirements: a number in ``unit``, a word, or a table row."""

    text: str
    unit: str = ""
    choices: tuple[str, ...] = ()
    table: str = ""
