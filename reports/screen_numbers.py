"""Numbers and names as a screen shows them: as many digits as are decided by, no exponents, no underscores."""

from __future__ import annotations

import math

from synth.units import finite_from_si

DIGITS = 4


def words(name: str) -> str:
    """Return the name of a quantity as words.

    Examples
    --------
    >>> words("ring_outer_diameter")
    'ring outer diameter'
    """
    return name.replace("_", " ")


def on_screen(value: float | None) -> str:
    """Return a number in four digits, whole numbers and those above a thousand without decimals.

    Examples
    --------
    >>> [on_screen(x) for x in (14.568237, 21017.3, 0.00082654, 1.0, 1234567.0, -0.25, None)]
    ['14.57', '21 017', '0.0008265', '1', '1 234 567', '-0.25', '']
    """
    if value is None or math.isnan(value):
        return ""
    if math.isinf(value):
        return "unbounded"
    if value == 0:
        return "0"
    decimals = max(DIGITS - 1 - math.floor(math.log10(abs(value))), 0)
    text = f"{value:,.{decimals}f}".replace(",", " ")
    return text.rstrip("0").rstrip(".") if "." in text else text


def in_unit(si: float, unit: str) -> str:
    """Return an SI value in a unit, for a screen; nothing where it does not exist."""
    return on_screen(finite_from_si(si, unit, None))
