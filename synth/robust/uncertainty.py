"""What scatters around a design: the ``robust`` block of a question, put into numbers or formulas of a problem.

Every thing that scatters has a position in its range: 0 is the lower end, 1 the upper one. The same rule moves numbers
(samples), intervals (proofs) and symbols (limits at a corner), so that all three speak of the same range.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from synth.declaration import Declaration
from synth.errors import InputError, at
from synth.order.margins import MARGINS, within
from synth.question.uncertainty import EXAMPLE, KEYS, Uncertainty, check_number_of_ranges, words_of
from synth.special import Numeric
from synth.text.numbers import typed_number
from synth.units import as_decimal, parse_quantity, parse_unit, to_si, typed_quantity

if TYPE_CHECKING:
    from synth.question.selection import SlotRows

CATALOGUE, NEW_AND_WORN = "catalogue range", "new and worn"
# Columns of a table of friction pairs: what slides, and the ends of its scatter; mu_static moves with it in proportion.
SLIDING, LEAST, MOST = "mu_dynamic", "mu_min", "mu_max"
WORN = re.compile(r"^(?:.*_)?wear$")
AROUND = re.compile(r"^\s*(?:\+\s*/?\s*-|±)\s*(.+)$", re.DOTALL)
ONE_SIDED = re.compile(r"^\s*([-+\u2212])\s*([0-9.][^:]*)$", re.DOTALL)  # +10 %: from the nominal value on
NUMBER = re.compile(r"^\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\s*$")


@dataclass(frozen=True)
class Range:
    """A range: its two ends, as values, as deviations, or as shares of the nominal value.

    ``kind``: ``ends`` (SI values), ``offset`` (SI deviations), ``share`` (deviations over the value) or ``columns``
    (the ends stand in two columns of the part).
    """

    kind: str
    low: float = 0.0
    high: float = 0.0

    def value(self, nominal: Numeric, position: Numeric, ends: tuple[Any, Any] | None = None) -> Any:
        """Return the value at a position; ``nominal``, ``position`` and ``ends`` are numbers, arrays or symbols."""
        if self.kind == "columns":
            assert ends is not None
            return _between(*ends, position)
        moved = _between(self.low, self.high, position)
        if self.kind == "ends":
            return moved
        return nominal + moved if self.kind == "offset" else nominal * (1.0 + moved)


def _between(low: Numeric, high: Numeric, position: Numeric) -> Any:
    """Interval between two ends; the ends themselves are exact."""
    if isinstance(position, float):
        if position in (0.0, 1.0):
            return high if position else low
        return low + position * (high - low)
    value = low + position * (high - low)
    return np.where(position == 1.0, high, value) if isinstance(position, np.ndarray) else value


@dataclass(frozen=True)
class Member:
    """An input of the model that moves: a requirement, a variable, or a column of the part in a slot."""

    kind: str
    name: str
    column: str = ""

    @property
    def key(self) -> tuple[str, str, str]:
        """Key that identifies it."""
        return self.kind, self.name, self.column


@dataclass(frozen=True)
class Scattered:
    """A scattering quantity: its range and its members; further members move in proportion to the first."""

    name: str
    unit: str
    range: Range
    members: tuple[Member, ...]
    text: str

    def ends(self, column: Callable[[str, str], Any]) -> tuple[Any, Any] | None:
        """Ends from columns of the part; None where the range has its own."""
        slot = self.members[0].name
        return (column(slot, LEAST), column(slot, MOST)) if self.range.kind == "columns" else None

    def moved(self, member: Member, nominal: Callable[[Member], Any], position: Numeric, column: Numeric) -> Any:
        """Return a member at a position of the range."""
        first = self.members[0]
        lead = nominal(first)
        value = self.range.value(lead, position, self.ends(column))
        if member == first:
            return value
        if self.range.kind == "share":
            return self.range.value(nominal(member), position)
        return nominal(member) * (value / lead)

    def shown(self, position: float | None) -> str:
        """Return a position in words."""
        words = {None: "nominal", 0.0: "low", 1.0: "high"}
        return f"{self.name} {words.get(position) or f'at {typed_number(position)} of its range'}"


# ---- what the block means for a problem -----------------------------------------------------------------------------


def scattered(uncertainty: Uncertainty, d: Declaration, where: str = "robust") -> list[Scattered]:
    """Scattering quantities of a problem, in the order of the block, tolerances last.

    Raises
    ------
    InputError
        When the problem has no such thing, or it cannot scatter so.
    """
    reader = _RangeReader(d, where)
    result: list[Scattered] = []
    for key, text in uncertainty.ranges.items():
        with at("robust", key):
            if key == "friction":
                result += reader.friction(text)
            elif key == "wear":
                result.append(reader.wear(text))
            else:
                result.append(reader.named(key, text))
    for key, text in uncertainty.tolerance.items():
        with at("robust", "tolerance", key):
            result.append(reader.tolerance(key, text))
    check_number_of_ranges(len(result), where)  # friction may be that of several slots
    keys = [(member.key, x.name) for x in result for member in x.members]
    for k, (moved, name) in enumerate(keys):
        if any(moved == other for other, _ in keys[:k]):
            raise InputError(f"{where}: {name}", name, "each thing that scatters once", ("robust", name))
    for name, points in uncertainty.scenarios.items():
        if any(len(p) != len(result) for p in points):
            right = f"positions of {len(result)} ranges each"
            raise InputError(f"{where}: scenarios: {name}", points, right, ("robust", "scenarios", name))
    return result


class _RangeReader:
    """Reads ranges for one declaration."""

    def __init__(self, d: Declaration, where: str) -> None:
        self.d, self.where = d, where

    def friction(self, text: str) -> list[Scattered]:
        """Friction of every slot whose table holds its scatter."""
        slots = [part for part in self.d.slots.values() if {SLIDING, LEAST, MOST} <= part.known]
        slots = [part for part in slots if any(c.startswith("mu_") for c in part.columns)]
        if not slots:
            expected = f"a family that uses the friction of a table; {self.d.problem} does not"
            raise InputError(f"{self.where}: friction", text, expected)
        ranged = [part.slot for part in slots if LEAST in part.columns or MOST in part.columns]
        if ranged:
            raise InputError(
                f"{self.where}: friction",
                text,
                f"no friction here: the limits of {self.d.problem} hold from {LEAST} to {MOST} of {ranged[0]} already, "
                "as it is or with these options",
            )
        result = []
        for part in slots:
            field = f"{self.where}: friction"
            words = f"'{CATALOGUE}' or "
            span = Range("columns") if words_of(text) == CATALOGUE else self._range(text, "-", field, words)
            largest = float(np.nanmax(self.d.catalogs.table(part.table).number(SLIDING)))
            if (span.kind == "ends" and span.low <= 0) or (span.kind == "offset" and -span.low >= largest):
                raise InputError(field, text, f"{words}a range above zero, for example '+-10 %' or '0.08 .. 0.12'")
            moving = [SLIDING, *(c for c in part.columns if c.startswith("mu_") and c in part.known and c != SLIDING)]
            members = tuple(Member("part", part.slot, c) for c in moving)
            name = "friction" if len(slots) == 1 else f"friction of {part.slot}"
            result.append(Scattered(name, "-", span, members, text))
        return result

    def wear(self, text: str) -> Scattered:
        """Return the requirements that say how far something wears."""
        field = f"{self.where}: wear"
        names = [name for name in self.d.requirements if WORN.match(name)]
        if not names:
            expected = f"a family with a requirement such as lining_wear; {self.d.problem} has none"
            raise InputError(field, text, expected)
        unit = self.d.requirements[names[0]].unit
        worn = words_of(text) == NEW_AND_WORN
        span = Range("share", -1.0, 0.0) if worn else self._range(text, unit, field, f"'{NEW_AND_WORN}' or ")
        return Scattered("wear", unit, span, tuple(Member("requirement", name) for name in names), text)

    def tolerance(self, key: str, text: str) -> Scattered:
        """Return a variable with its tolerance."""
        field = f"{self.where}: tolerance: {key}"
        name = self.d.names().get(key)
        if name not in self.d.variables:
            close = difflib.get_close_matches(key, self.d.variables, n=2, cutoff=0.5)
            listed = " or ".join(close) or ", ".join(self.d.variables) or "no tolerance: there are no variables"
            raise InputError(field, key, f"a variable of {self.d.problem}: {listed}")
        unit = self.d.variables[name].unit
        span = self._range(text, unit, field)
        if span.kind == "ends":
            # Two ends of a tolerance are deviations from the nominal size.
            low, high = _ends(text, _difference(unit), field)
            span = Range("offset", low, high)
        if span.low > 0 or span.high < 0:
            raise InputError(
                field, text, "deviations on both sides of the nominal size, or 0: '+-0.1 mm', '-0.05 .. 0 mm'"
            )
        return Scattered(name, unit, span, (Member("variable", name),), text)

    def named(self, key: str, text: str) -> Scattered:
        """Return a requirement, a variable, or a column of a slot."""
        field = f"{self.where}: {key}"
        name = self.d.names().get(key)
        if name in self.d.variables:
            return self.tolerance(key, text)
        if name in self.d.requirements:
            r = self.d.requirements[name]
            if r.follows:
                others = " or ".join(sorted({str(s) for s in ca.symvar(r.default)} & set(self.d.requirements)))
                raise InputError(field, text, f"{others}, from which {name} follows here, or a {name} that is stated")
            span = self._range(text, r.unit, field)
            if span.kind == "ends" and not all(
                within(x, r.lower, r.upper, MARGINS.conversion) for x in (span.low, span.high)
            ):
                low, high = (typed_quantity(x, r.unit) if math.isfinite(x) else "any" for x in (r.lower, r.upper))
                raise InputError(field, text, f"a range within {low} .. {high}")
            return Scattered(name, r.unit, span, (Member("requirement", name),), text)
        slot, dot, column = key.partition(".")
        part = self.d.slots.get(self.d.names().get(slot, ""))
        if dot and part is not None:
            if column not in part.columns or column not in part.known:
                used = ", ".join(c for c in part.columns if c in part.known)
                raise InputError(field, key, f"a column that {self.d.problem} uses of {part.slot}: {used}")
            unit = self.d.catalogs.table(part.table).column(column).unit or "-"
            span = self._range(text, unit, field)
            return Scattered(f"{part.slot}.{column}", unit, span, (Member("part", part.slot, column),), text)
        among = [*KEYS[:3], *self.d.requirements, *self.d.variables]
        close = difflib.get_close_matches(key, among, n=3, cutoff=0.6)
        hint = f" (did you mean {' or '.join(close)}?)" if close else ""
        raise InputError(field, key, f"friction, wear, tolerance, a requirement, or a column such as slot.column{hint}")

    def _range(self, text: str, unit: str, field: str, words: str = "") -> Range:
        """Return the range that a text stands for."""
        around, one_sided = AROUND.match(text), ONE_SIDED.match(text)
        if around is not None:
            span = self._deviation(around.group(1), -1.0, 1.0, unit, field)
        elif one_sided is not None and ".." not in text:
            low, high = (0.0, 1.0) if one_sided.group(1) == "+" else (-1.0, 0.0)
            span = self._deviation(one_sided.group(2), low, high, unit, field)
        elif text.strip().endswith("%") and (unit != "-" or text.lstrip().startswith(("+", "-"))):
            span = Range("share", *_ends(text, "-", field, words))  # -5 .. +10 %
        else:
            span = Range("ends", *_ends(text, unit, field, words))
        if not span.low < span.high or (span.kind == "share" and span.low <= -1):
            raise InputError(field, text, f"{words}a range from a smaller to a larger value, for example {EXAMPLE}")
        return span

    @staticmethod
    def _deviation(text: str, low: float, high: float, unit: str, field: str) -> Range:
        """Return so many times a deviation either way, which is a share of the nominal value or has its unit."""
        if not text.strip().endswith("%"):
            reach = parse_quantity(text, _difference(unit), field)
            return Range("offset", low * reach, high * reach)
        if _difference(unit) != unit:
            raise InputError(field, text, "a range in degrees: '0 .. 60 degC' or '+-10 K'")
        share = parse_quantity(text, "-", field)
        return Range("share", low * share, high * share)


def _difference(unit: str) -> str:
    """Return the unit of a difference: kelvin for temperatures."""
    return "K" if float(to_si(0.0, parse_unit(unit))) != 0.0 else unit


def _ends(text: str, unit: str, field: str, words: str = "") -> tuple[float, float]:
    """The two values of a range; a unit of the last counts for both."""
    first, sign, last = text.partition("..") if ".." in text else text.partition(":")
    if not sign or ":" in last or (".." in text and ":" in text) or not first.strip() or not last.strip():
        raise InputError(field, text, f"{words}a range, for example {EXAMPLE}")
    if NUMBER.match(first):
        written_unit = re.sub(r"^\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", "", as_decimal(last))
        first = f"{first.strip()} {written_unit.strip()}".strip()
    low, high = (parse_quantity(x.strip(), unit, field) for x in (first, last))
    return low, high


def check_rows(quantities: Sequence[Scattered], slots: Iterable[SlotRows], where: str = "robust") -> None:
    """Refuse a range of a column that holds the nominal value of none of the rows offered.

    Parameters
    ----------
    quantities : list of Scattered
    slots : iterable of SlotRows
        What may fill the slots.

    Raises
    ------
    InputError
        When there is such a range.
    """
    rows = {s.slot: s for s in slots}
    for x in quantities:
        first = x.members[0]
        if first.kind != "part" or x.range.kind != "ends" or first.name not in rows:
            continue
        nominal = rows[first.name].columns[first.column]
        if not np.any((nominal >= x.range.low) & (nominal <= x.range.high)):
            low, high = (typed_quantity(float(f(nominal)), x.unit) for f in (np.nanmin, np.nanmax))
            held = low if low == high else f"one from {low} to {high}"
            right = f"a range that holds the nominal {first.column}, {held}"
            raise InputError(f"{where}: {x.name}", x.text, right, ("robust", x.name))


def check_values(
    quantities: Sequence[Scattered], d: Declaration, values: Mapping[str, float], where: str = "robust"
) -> None:
    """Refuse ranges of requirements that do not fit what is stated.

    Parameters
    ----------
    quantities : list of Scattered
    d : Declaration
    values : mapping
        Requirements in SI.

    Raises
    ------
    InputError
        When one is not given, lies outside its range, or the range leaves what the family allows.
    """
    for x in quantities:
        for member in x.members:
            if member.kind != "requirement":
                continue
            r, field, path = d.requirements[member.name], f"{where}: {x.name}", ("robust", x.name)
            if member.name not in values:
                right = f"requirement {member.name} to be given as well: its nominal value"
                raise InputError(field, x.text, right, path)
            nominal = values[member.name]
            low, high = (x.moved(member, lambda m: values[m.name], p, None) for p in (0.0, 1.0))
            slack = MARGINS.end * max(abs(low), abs(high))
            if not low - slack <= nominal <= high + slack:
                right = f"a range that holds the nominal {typed_quantity(nominal, r.unit)}"
                raise InputError(field, x.text, right, path)
            if low < r.lower - slack or high > r.upper + slack:
                shown = [typed_quantity(end, r.unit) for end in (low, high)]
                right = f"a range that {d.problem} allows; this one is {shown[0]} .. {shown[1]}"
                raise InputError(field, x.text, right, path)
