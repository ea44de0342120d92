"""Quantities as a screen or a page shows them: as many digits as are decided by, raised exponents, names in words."""

from __future__ import annotations

import re
from collections.abc import Iterable

from synth.plain_text import plain_number, words
from synth.units.quantity import finite_from_si

RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
WORDS = {"degC": "°C", "deg": "°", "ohm": "Ω", "um": "µm"}
FACTOR = re.compile(r"([A-Za-z]+)(-?\d*)")
# A number with a unit as sentences have it; what follows a blank without a sign of units in it is a word.
STATED = re.compile(r"(?<![\w.])([-+]?\d[\d.]*) ([A-Za-z]+[*/][A-Za-z0-9*/()]+|[a-z]{1,2}\d|degC)(?![\w*/])")


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
    """Return an SI value in a unit, for a screen; nothing where it does not exist."""
    return plain_number(finite_from_si(si, unit, None), digits)


def quantity_text(si: float, unit: str, digits: int = 4) -> str:
    """Return an SI value with its unit, for a screen; nothing where it does not exist.

    Examples
    --------
    >>> quantity_text(1058.8235, "N*m"), quantity_text(0.25, "-"), quantity_text(float("nan"), "mm")
    ('1 059 N m', '0.25', '')
    """
    number, written = in_unit(si, unit, digits), unit_text(unit)
    return f"{number}{'' if written in ('', '°') else ' '}{written}" if number else ""


def in_words(sentence: str, names: Iterable[str]) -> str:
    """Return a sentence with names in words and units as they are printed; designations of parts stay.

    Examples
    --------
    >>> in_words("load_torque 224 N*m instead of 300 N*m with paper_wet", ["load_torque"])
    'load torque 224 N m instead of 300 N m with paper_wet'
    """
    known = set(names)
    said = re.sub(r"[A-Za-z]\w*_\w*", lambda m: words(m[0]) if m[0] in known else m[0], sentence)
    return STATED.sub(lambda m: f"{m[1]} {unit_text(m[2])}", said)
