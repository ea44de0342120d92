"""Numbers of reports with the units they are shown in."""

from __future__ import annotations

import math
from dataclasses import dataclass

from synth.text.numbers import DIGITS, STEP_DIGITS, Shown, shown
from synth.units import from_si, parse_unit, unit_text


@dataclass(frozen=True)
class ShownQuantity:
    """Number as it is shown, and its unit in the grammar of specs (``N/mm2``; nothing for a bare number)."""

    number: Shown
    unit: str = ""

    def bare(self) -> ShownQuantity:
        """The same without its unit, which stands somewhere else."""
        return ShownQuantity(self.number)

    def plain(self) -> str:
        """Line of text as specs have it."""
        return self.number.typed() + (f" {self.unit}" if self.unit else "")


@dataclass(frozen=True)
class UnitIn:
    """The unit in which a number is shown: SI value = factor times number, plus an offset."""

    unit: str

    @staticmethod
    def formula(unit: str, in_si: bool = False) -> UnitIn:
        """Unit in which a number is inserted into a formula.

        Angular speeds are inserted in rad/s and temperatures in K, so that the result is right as it stands.
        """
        if unit in ("", "-"):
            return UnitIn("")
        read = parse_unit(unit)
        if in_si:
            return UnitIn("SI")
        if read.kind == "angular_speed":
            return UnitIn("rad/s")
        return UnitIn("K") if read.offset else UnitIn(unit)

    def shown(self, si: float, digits: int = STEP_DIGITS) -> ShownQuantity:
        """SI value in this unit."""
        if self.unit in ("", "SI", "K", "rad/s"):
            return _shown(si, "" if self.unit == "SI" else self.unit, digits)
        return _shown(float(from_si(si, self.unit)), self.unit, digits)


def in_its_unit(si: float, unit: str, digits: int = DIGITS) -> ShownQuantity:
    """SI value in its declared unit; one that does not exist has none.

    Examples
    --------
    >>> in_its_unit(26.6, "1/min").plain(), in_its_unit(0.18, "mm").plain(), in_its_unit(353.15, "degC").plain()
    ('254 1/min', '180 mm', '80 degC')
    """
    return _shown(si, "", digits) if unit in ("", "-") else _shown(float(from_si(si, unit)), unit, digits)


def _shown(number: float, unit: str, digits: int) -> ShownQuantity:
    return ShownQuantity(shown(None)) if math.isnan(number) else ShownQuantity(shown(number, digits), unit)


def in_step(si: float, unit: str) -> ShownQuantity:
    """SI value in its declared unit with the digits of calculation steps."""
    return in_its_unit(si, unit, STEP_DIGITS)


def printed(quantity: ShownQuantity) -> str:
    """Line of text in the characters of sheets: number and unit, exponents raised."""
    unit = unit_text(quantity.unit)
    return quantity.number.page() + ("" if not unit else unit if unit == "°" else f" {unit}")
