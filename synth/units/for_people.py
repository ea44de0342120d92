"""Quantities as a screen or a page shows them: as many digits as are decided by, raised exponents, names in words."""

from __future__ import annotations

import re
from collections.abc import Iterable

from synth.text.numbers import LARGEST_FACTOR, LARGEST_IN_PER_CENT, RAISED, UNKNOWN, number_text, percent, times
from synth.text.plain_text import words
from synth.units.grammar import parse_unit
from synth.units.quantity import finite_from_si

WORDS = {"degC": "°C", "deg": "°", "ohm": "Ω", "um": "µm"}
FACTOR = re.compile(r"([A-Za-z]+)(-?\d*)")
# A number with a unit as sentences have it; what follows a blank without a sign of units in it is a word.
VALUE_WITH_UNIT = re.compile(r"(?<![\w.])([-+]?\d[\d.]*) ([A-Za-z]+[*/][A-Za-z0-9*/()]+|[a-z]{1,2}\d|degC)(?![\w*/])")


def unit_text(unit: str) -> str:
    """Return a unit as it is printed: exponents raised, factors side by side.

    Examples
    --------
    >>> unit_text("N/mm2"), unit_text("kg*m2"), unit_text("degC"), unit_text("J/(mm2 h)"), unit_text("-")
    ('N/mm²', 'kg m²', '°C', 'J/(mm² h)', '')
    """
    if unit in ("", "-"):
        return ""
    return FACTOR.sub(lambda m: WORDS.get(m[1], m[1]) + m[2].translate(RAISED), unit).replace("*", " ")


def in_unit(si: float, unit: str, digits: int = 4) -> str:
    """Return an SI value in a unit, for a screen; a dash where it does not exist."""
    return number_text(finite_from_si(si, unit, None), digits)


def quantity_text(si: float, unit: str, digits: int = 4) -> str:
    """Return an SI value with its unit, for a screen; a dash where it does not exist.

    Examples
    --------
    >>> quantity_text(1058.8235, "N*m"), quantity_text(0.25, "-"), quantity_text(float("nan"), "mm")
    ('1059 N m', '0.25', '–')
    """
    number, written = in_unit(si, unit, digits), unit_text(unit)
    return f"{number}{'' if written in ('', '°') else ' '}{written}" if number != UNKNOWN else number


def miss_text(value: float, limit: float, unit: str) -> str:
    """Return by how much a limit is missed: as a share of it, or where that tells nothing as a difference.

    Examples
    --------
    >>> miss_text(0.154, 0.17, "-"), miss_text(0.29, 0.002, "kg"), miss_text(0.0003, 0.0, "mm")
    ('9.41 %', '144 times the limit', '0.3 mm')
    """
    difference = abs(value - limit)
    if not limit or not difference < LARGEST_FACTOR * abs(limit):
        return quantity_text(difference, "K" if parse_unit(unit).offset else unit, 3)
    share = difference / abs(limit)
    return percent(share) if share < LARGEST_IN_PER_CENT else f"{times(share)} the limit"


def in_words(sentence: str, names: Iterable[str]) -> str:
    """A sentence with names in words and units as they are printed; designations of parts stay.

    Examples
    --------
    >>> in_words("load_torque 224 N*m instead of 300 N*m with paper_wet", ["load_torque"])
    'load torque 224 N m instead of 300 N m with paper_wet'
    """
    known = set(names)
    worded = re.sub(r"[A-Za-z]\w*_\w*", lambda m: words(m[0]) if m[0] in known else m[0], sentence)
    return VALUE_WITH_UNIT.sub(lambda m: f"{m[1]} {unit_text(m[2])}", worded)
