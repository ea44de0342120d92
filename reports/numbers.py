"""Numbers as people read them: significant digits, powers of ten, units with raised exponents."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from synth.units import from_si, parse_unit, unit_text
from synth.units.for_people import RAISED

DIGITS = 5  # significant, of what is shown


@dataclass(frozen=True)
class Shown:
    """A number: digits, a power of ten, and a unit in the grammar of specs (``N/mm2``; nothing for a bare number)."""

    text: str
    exponent: int = 0
    unit: str = ""

    def bare(self) -> Shown:
        """Return it without its unit, which stands somewhere else."""
        return replace(self, unit="")

    def plain(self) -> str:
        """Return it as a line of text."""
        power = f"e{self.exponent}" if self.exponent else ""
        return f"{self.text}{power}" + (f" {self.unit}" if self.unit else "")


def shown_number(value: float, digits: int = DIGITS, unit: str = "") -> Shown:
    """Return a number with so many significant digits.

    Examples
    --------
    >>> shown_number(1058.8235).text, shown_number(1.2566370614e-6), shown_number(30.0).text
    ('1058.8', Shown(text='1.2566', exponent=-6, unit=''), '30')
    """
    unit = "" if unit == "-" else unit
    if math.isnan(value):
        return Shown("–")
    if math.isinf(value):
        return Shown("∞" if value > 0 else "-∞", 0, unit)
    if value == 0:
        return Shown("0", 0, unit)
    if float(value).is_integer() and abs(value) < 1e6:
        return Shown(str(int(value)), 0, unit)
    mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
    exponent = int(power)
    if -4 <= exponent < 6:
        return Shown(_trimmed(f"{value:.{max(0, digits - 1 - exponent)}f}"), 0, unit)
    return Shown(_trimmed(mantissa), exponent, unit)


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


@dataclass(frozen=True)
class UnitIn:
    """The unit in which a number is shown: SI value = factor times number, plus an offset."""

    unit: str

    @staticmethod
    def formula(unit: str, in_si: bool = False) -> UnitIn:
        """Return the unit in which a number is inserted into a formula.

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

    def shown(self, si: float, digits: int = DIGITS) -> Shown:
        """Return an SI value in this unit."""
        if self.unit in ("", "SI", "K", "rad/s"):
            return shown_number(si, digits, "" if self.unit == "SI" else self.unit)
        return shown_number(float(from_si(si, self.unit)), digits, self.unit)


def shown(si: float, unit: str, digits: int = DIGITS) -> Shown:
    """Return an SI value in its declared unit.

    Examples
    --------
    >>> shown(26.6, "1/min").plain(), shown(0.18, "mm").plain(), shown(353.15, "degC").plain()
    ('254.01 1/min', '180 mm', '80 degC')
    """
    if unit in ("", "-"):
        return shown_number(si, digits)
    return replace(shown_number(float(from_si(si, unit)), digits), unit=unit)


def printed(number: Shown) -> str:
    """Return a number as a line of text for people: with a real minus sign, powers of ten and raised exponents."""
    text = number.text.replace("-", "−")
    if number.exponent:
        text += f"·10{str(number.exponent).translate(RAISED)}"
    unit = unit_text(number.unit)
    return text + ("" if not unit else unit if unit == "°" else f" {unit}")
