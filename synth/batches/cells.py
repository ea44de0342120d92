"""What stands in the cells ``options``, ``limits``, ``fix`` and ``parts`` of a row: entries with semicolons between."""

from __future__ import annotations

import re
from collections.abc import Callable

from synth.errors import InputError
from synth.text.plain_text import listed

ENTRY = re.compile(r"\s*([^\W\d][\w.]*)\s*(:|<=|>=|==|=|<|>)\s*(\S.*?)\s*", re.DOTALL)
BETWEEN = re.compile(r";(?=(?:[^']*'[^']*')*[^']*$)")  # not within quotes
IN_QUOTES = re.compile(r'(^|,)\s*"(?:[^"]|"")*"\s*(?=,|$)')  # a name of a list
CONDITION = re.compile(r"[<>=!'\"]|\b(?:in|and|or|not)\b")


def _entries(text: str, where: str, example: str) -> list[tuple[str, str, str]]:
    entries = []
    for entry in BETWEEN.split(text):
        if not entry.strip():
            continue
        match = ENTRY.fullmatch(entry)
        if match is None:
            raise InputError(where, entry.strip(), f"entries with semicolons between them, for example '{example}'")
        entries.append((match[1], match[2], match[3]))
    return entries


def _single(text: str, where: str, example: str) -> dict[str, str]:
    result: dict[str, str] = {}
    for name, sign, value in _entries(text, where, example):
        if sign not in (":", "=", "=="):
            raise InputError(where, f"{name} {sign} {value}", f"a value, for example '{example}'")
        if name in result:
            raise InputError(where, name, "each name once")
        result[name] = value
    return result


def read_options(text: str, where: str) -> dict[str, str]:
    """Return the options of a cell.

    Examples
    --------
    >>> read_options("lubrication = dry; guide_model: cz", "line 2, column options")
    {'lubrication': 'dry', 'guide_model': 'cz'}
    """
    return _single(text, where, "lubrication = dry; guide_model = cz")


def read_fix(text: str, where: str) -> dict[str, str]:
    """Values to which a cell pins quantities.

    Examples
    --------
    >>> read_fix("ramp_time = 2 s; inner_plate: core 2", "line 2, column fix")
    {'ramp_time': '2 s', 'inner_plate': 'core 2'}
    """
    return _single(text, where, "ramp_time = 2 s; inner_plate = core 2")


def read_limits(text: str, where: str) -> dict[str, list[str]]:
    """Return the limits of a cell.

    Examples
    --------
    >>> read_limits("mass <= 20 kg; friction_surfaces: 10 .. 14; mass >= 5 kg", "line 2, column limits")
    {'mass': ['<= 20 kg', '>= 5 kg'], 'friction_surfaces': ['10 .. 14']}
    """
    result: dict[str, list[str]] = {}
    for name, sign, value in _entries(text, where, "mass <= 20 kg; friction_surfaces: 10 .. 14"):
        result.setdefault(name, []).append(value if sign == ":" else f"{sign} {value}")
    return result


def read_parts(text: str, where: str) -> dict[str, str | list[str]]:
    """Return the rules for parts of a cell: designations with commas between, or a condition on columns.

    A designation that has a comma itself stands in double quotes.

    Examples
    --------
    >>> read_parts('friction_pair = cork_wet, "paper, wet"; inner_plate: thickness > 1', "line 2, column parts")
    {'friction_pair': ['cork_wet', 'paper, wet'], 'inner_plate': 'thickness > 1'}
    """
    rules = _single(text, where, "friction_pair = cork_wet, paper_wet; inner_plate: thickness > 1")
    return {
        slot: rule if CONDITION.search(IN_QUOTES.sub(r"\1", rule)) else [name for name in listed(rule) if name]
        for slot, rule in rules.items()
    }


READERS: dict[str, Callable[[str, str], dict[str, str] | dict[str, list[str]] | dict[str, str | list[str]]]] = {
    "options": read_options,
    "limits": read_limits,
    "fix": read_fix,
    "parts": read_parts,
}
