"""The domain of a count as a user restricts it: comparisons, and sets of allowed values.

A list holds what is asked of one quantity. Entries with a sign or a range (``"<= 12"``, ``"8 .. 12"``) are comparisons,
which all hold; entries without one (``8``, ``"12"``) are together the set of the values that are allowed. Where both
stand in one list, both hold. A text in square brackets, ``"[8, 12, 16]"``, is such a list where only text can be typed.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence, Sized
from collections.abc import Set as AbstractSet
from typing import Any, TypeGuard

import numpy as np

from synth.declaration import Count
from synth.errors import InputError
from synth.order.margins import MARGINS
from synth.text.input_limits import INPUT_LIMITS
from synth.text.numbers import typed_number
from synth.units import parse_quantity

COMPARES = re.compile(r"^\s*[<>=]|\.\.")


def entries(value: object) -> list[Any]:
    """Conditions on one quantity, entry by entry: a list as it stands, a text in brackets taken apart.

    Examples
    --------
    >>> entries("<= 12"), entries([8, "[12, 16]"]), entries(range(8, 13, 4))
    (['<= 12'], [8, '12', '16'], [8, 12])
    """
    if isinstance(value, str):
        text = value.strip()
        if text.startswith("[") and text.endswith("]"):
            return [entry.strip() for entry in text[1:-1].split(",")]
        return [value]
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, AbstractSet):
        value = sorted(value, key=str)
    if isinstance(value, (list, tuple, range)):
        return [one for entry in value for one in (entries(entry) if isinstance(entry, str) else [entry])]
    return [value]


def compares(entry: object) -> bool:
    """True if an entry is a limit, with a sign or a range, and no value of a set."""
    return isinstance(entry, str) and COMPARES.search(entry) is not None


def is_list(value: object) -> TypeGuard[str | Collection[object]]:
    """True if a list of entries is meant: a list, or a text in square brackets."""
    if isinstance(value, str):
        return value.strip().startswith("[")
    return isinstance(value, (list, tuple, range, np.ndarray, AbstractSet))


def values_of_set(count: Count, value: object, field: str) -> np.ndarray:
    """Return the steps of a count that a set allows, in rising order.

    Parameters
    ----------
    count : Count
    value : list
        Numbers, or texts with a number.
    field : str
        What it stands for, for messages.

    Raises
    ------
    InputError
        When the set is empty, or one of it is no step of the count.
    """
    steps, label = count.values, f"{field}: {count.name}"
    if isinstance(value, Sized) and not isinstance(value, str) and len(value) > INPUT_LIMITS.listed:
        raise InputError(label, f"{len(value)} values", f"at most {INPUT_LIMITS.listed}")
    given = [entry for entry in entries(value) if not compares(entry)]
    if not given:
        raise InputError(label, value, "at least one value, for example [8, 12, 16]")
    for entry in given:
        wanted = parse_quantity(entry, count.unit, label)
        if np.min(np.abs(steps - wanted)) > MARGINS.step:
            step = f" in steps of {typed_number(steps[1] - steps[0])}" if len(steps) > 1 else ""
            raise InputError(label, entry, f"values from {typed_number(steps[0])} to {typed_number(steps[-1])}{step}")
    numbers = np.array([parse_quantity(entry, count.unit, label) for entry in given])
    return np.asarray(steps[np.any(np.abs(steps[:, None] - numbers[None, :]) <= MARGINS.step, axis=1)])


def shown_set(values: Sequence[float] | np.ndarray) -> str:
    """Return a set of values in words, as it may be typed.

    Examples
    --------
    >>> shown_set([8.0, 12.0, 4.5])
    '[8, 12, 4.5]'
    """
    return f"[{', '.join(typed_number(x, 12) for x in values)}]"


def stated(asked: Mapping[Any, Any] | None) -> dict[Any, Any]:
    """Return limits or pins as files keep them: texts, numbers, and lists of these.

    Examples
    --------
    >>> stated({"z": range(8, 17, 4), "length": ("<= 1 m", ">= 2 mm"), "i": "core 2"})
    {'z': [8, 12, 16], 'length': ['<= 1 m', '>= 2 mm'], 'i': 'core 2'}
    """
    return {name: stated_value(value) for name, value in (asked or {}).items()}


def stated_value(value: object) -> Any:
    """Conditions on one name as files keep them."""
    if is_list(value) and not isinstance(value, str):
        return [stated_value(entry) for entry in entries(value)]
    if isinstance(value, np.generic):
        value = value.item()
    return value if isinstance(value, (str, int, float)) else str(value)
