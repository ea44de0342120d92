"""Reads the lines of a calculation sheet as a person with a calculator does: printed numbers, printed units, pint."""

from __future__ import annotations

import math
import re

import pint

UNITS = pint.UnitRegistry()
UNITS.define("ohm_ = ohm")
NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:e-?\d+)?"
UNIT = r"(?:1/)?[A-Za-z]+[A-Za-z0-9*/]*(?:\([^()]*\))?"
TOKEN = re.compile(rf"\s*(?:({NUMBER})(?: ({UNIT})(?![A-Za-z(]))?|([A-Za-z]\w*)(\()?|(\S))")
PLAIN_WORDS = ("pi", "e")


def unit_of(text):
    """Return a unit of the product as pint reads it."""
    spelled = re.sub(r"([A-Za-z]+)(\d)", r"\1**\2", text).replace(" ", "*")
    return UNITS.parse_expression(spelled)


def angle(x):
    return x.to("rad").magnitude if isinstance(x, UNITS.Quantity) else x


def bare(x):
    return x.to("").magnitude if isinstance(x, UNITS.Quantity) else x


def root(x):
    return x**0.5 if isinstance(x, UNITS.Quantity) else math.sqrt(x)


FUNCTIONS = {
    "sqrt": root,
    "ln": lambda x: math.log(bare(x)),
    "abs": abs,
    "min": min,
    "max": max,
    "ceil": math.ceil,
    "floor": math.floor,
    "hypot": lambda a, b: root(a**2 + b**2),
    **{name: (lambda f: lambda x: f(angle(x)))(getattr(math, name)) for name in ("sin", "cos", "tan")},
    **{name: (lambda f: lambda *x: f(*map(bare, x)))(getattr(math, name)) for name in ("asin", "acos", "atan", "erf")},
    "atan2": lambda a, b: math.atan2(bare(a), bare(b)) if not isinstance(a, UNITS.Quantity) else math.atan(bare(a / b)),
    **{name: (lambda f: lambda x: f(bare(x)))(getattr(math, name)) for name in ("sinh", "cosh", "tanh")},
}


def read(line):
    """Return what a printed line comes to."""
    text = line.removeprefix("= ")
    code, place, known = [], 0, []
    while place < len(text):
        match = TOKEN.match(text, place)
        assert match, text[place:]
        place = match.end()
        number, unit, word, opens, sign = match.groups()
        if number:
            known.append(float(number) if not unit else float(number) * unit_of(unit))
            code.append(f"known[{len(known) - 1}]")
        elif word and opens:
            code.append(f"functions[{word!r}](")
        elif word:
            assert word in PLAIN_WORDS, line
            code.append({"pi": "math.pi", "e": "math.e"}[word])
        else:
            code.append({"^": "**", ";": ","}.get(sign, sign))
    return eval("".join(code), {"known": known, "functions": FUNCTIONS, "math": math})


def dimensions(x):
    """Return the exponents of a quantity; roots leave rounding in them."""
    return {k: round(float(v), 6) for k, v in UNITS.Quantity(x).dimensionality.items() if round(float(v), 6)}


def difference(line, result):
    """Return by how much a line misses the printed result, relative to it."""
    found, told = read(line), read(result)
    known = dimensions(found), dimensions(told)
    found, told = (UNITS.Quantity(x).to_base_units().magnitude for x in (found, told))
    assert known[0] == known[1] or found == told == 0, "zero alone may be of any unit"
    return abs(found - told) / abs(told) if told else abs(found)
