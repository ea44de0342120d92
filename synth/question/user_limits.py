"""What a user writes under ``limits``, read as comparisons."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from synth.errors import InputError, at
from synth.input_limits import INPUT_LIMITS
from synth.margins import above
from synth.question.count_domain import compares, entries, is_list
from synth.units import parse_quantity

SENSES = {"<=": "at_most", ">=": "at_least", "==": "equal", "=": "equal", "<": "at_most", ">": "at_least"}
CONDITION = re.compile(r"^\s*(<=|>=|==|=|<|>)\s*(.+)$", re.DOTALL)


def check_number_of_limits(limits: Mapping[str, Any]) -> None:
    """Refuse more limits than a question may have, before any of them is read."""
    count = sum(len(texts) if is_list(texts) and not isinstance(texts, str) else 1 for texts in limits.values())
    if count > INPUT_LIMITS.limits:
        raise InputError("limits", f"{count} limits", f"at most {INPUT_LIMITS.limits}", ("limits",))


def read_limits(name: str, unit: str, texts: Any) -> list[tuple[str, float, tuple[int, ...]]]:
    """Return the comparisons that the user wrote about a quantity: sense, SI value, and the position in a list."""
    several = is_list(texts)
    found = list[tuple[str, float, tuple[int, ...]]]()
    for k, text in enumerate(entries(texts)):
        if several and not compares(text):
            continue  # a value of a set
        place = (k,) if several and not isinstance(texts, str) else ()
        with at("limits", name, *place):
            found += [(sense, bound, place) for sense, bound in _read_limit(name, unit, text)]
    return found


def _read_limit(name: str, unit: str, text: Any) -> list[tuple[str, float]]:
    """Return what a text says of a quantity: sense and SI value of each limit."""
    label = f"limits: {name}"
    if isinstance(text, str) and ".." in text:
        first, last = text.split("..", 1)
        low, high = parse_quantity(first, unit, label), parse_quantity(last, unit, label)
        if low > high:
            raise InputError(label, text, "the smaller value first, for example '200 mm .. 260 mm'")
        return [("at_least", low), ("at_most", high)]
    match = CONDITION.match(text) if isinstance(text, str) else None
    if match is None:
        raise InputError(label, text, f"a comparison, for example '<= 260 {unit}' or '200 {unit} .. 260 {unit}'")
    return [(SENSES[match.group(1)], parse_quantity(match.group(2), unit, label))]


def contradict(first: str, one: float, second: str, other: float) -> bool:
    """Tell whether two limits on one quantity leave nothing between them."""
    lows = [b for s, b in ((first, one), (second, other)) if s in ("at_least", "equal")]
    highs = [b for s, b in ((first, one), (second, other)) if s in ("at_most", "equal")]
    return bool(lows and highs and max(lows) > above(min(highs), 1e-9))
