"""The keys of a spec: what each may hold, whether it stands in a file, in a flag or in the body of a request."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from numbers import Real
from types import MappingProxyType
from typing import Any

from synth.errors import Described, InputError, at, whole_number
from synth.text.input_limits import INPUT_LIMITS

LEAST_GAP, LARGEST_GAP = 1e-6, 0.5
GAP_EXPECTED = "a fraction from 1e-6 to 0.5, for example 0.001"


def is_gap(value: Any) -> bool:
    """True if something can be the gap of a question: by how much a design may be better that is not excluded."""
    return is_number(value) and LEAST_GAP <= value <= LARGEST_GAP


def is_number(value: Any) -> bool:
    """Whether something is a number that a float holds, of any type; words and truth values are none."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # a whole number of hundreds of digits
        return False


# What would be right, where whoever knows of commands may say which.
ONE_FAMILY = "one family; to ask several is a comparison"
A_QUESTION = "a question without values; a given design is evaluated, not searched"
ROW_EXPECTED = "a row of a table as clutchsynth has written it"
A_DESIGN = "the variables, counts and choices of the design; without them it is a question"


def shown_kind(value: Any) -> Any:
    """Excerpt of a value that is of the wrong kind."""
    if value is None:
        return Described("nothing")
    if isinstance(value, Mapping):
        return Described("a mapping" if value else "an empty mapping")
    if isinstance(value, (list, tuple)):
        return Described("a list" if len(value) else "an empty list")
    return value


def no_family(where: str) -> InputError:
    """Message for a spec that names no family; ``where`` is its name."""
    from synth.model.registry import families  # costly to import; --help does without

    return InputError(f"{where}: family", None, f"the name of a family: {', '.join(families())}", ("family",))


def refuse_several(family: Any, where: str) -> None:
    """Refuse several families; ``where`` is the name of the spec that states them."""
    if not isinstance(family, (str, list, tuple)):
        raise InputError(f"{where}: family", shown_kind(family), "a name", ("family",))
    if asks_several(family):
        raise InputError(f"{where}: family", shown_families(family), ONE_FAMILY, ("family",))


def refuse_values(values: Mapping[str, Any] | None, where: str) -> None:
    """Refuse a given design where a question is meant; ``where`` is the name of the spec that states it."""
    if values is not None:
        raise InputError(f"{where}: values", ", ".join(values), A_QUESTION, ("values",))


def asks_several(family: Any) -> bool:
    """True if several families are asked."""
    return not isinstance(family, str) or family == "any"


def shown_families(family: Any) -> str:
    """Return the family or the families in words."""
    entries = [family] if isinstance(family, str) else family
    return ", ".join(str(x["family"]) if isinstance(x, Mapping) else str(x) for x in entries)


def _text(where: str, value: Any) -> str:
    if not isinstance(value, str) or not value.strip():
        raise InputError(where, shown_kind(value), "a name")
    return value


def _family(where: str, value: Any) -> Any:
    """Return a name, or several: names, and mappings with what concerns one family alone."""
    if not isinstance(value, (list, tuple)):
        return _text(where, value)
    if not value:
        raise InputError(where, shown_kind(value), "a name, 'any', or a list with at least one name")
    entries = []
    for k, entry in enumerate(value):
        with at(k):
            entries.append(_one_family(f"{where}, entry {k + 1}", entry))
    return tuple(entries)


def _one_family(where: str, entry: Any) -> Any:
    if not isinstance(entry, Mapping):
        return _text(where, entry)
    for key in entry:
        if key not in OWN:
            raise InputError(f"{where}: key", key, f"one of {', '.join(OWN)}", (str(key),))
    if entry.get("family") is None:
        raise InputError(f"{where}: family", None, "the name of a family", ("family",))
    checked = {}
    for key, value in entry.items():
        with at(key):
            checked[key] = _text(where, value) if key == "family" else FIELDS[key](f"{where}: {key}", value)
    return MappingProxyType(checked)


def _mapping(example: str) -> Callable[[str, Any], Mapping[str, Any]]:
    def check(where: str, value: Any) -> Mapping[str, Any]:
        if value is None:
            return MappingProxyType({})  # a key with nothing under it: all its lines are commented out
        if not isinstance(value, Mapping):
            raise InputError(where, shown_kind(value), f"a mapping, for example '{example}'")
        for key in value:
            if not isinstance(key, str):
                right = "names on the left of the colons (in quotes if YAML takes them for a number)"
                raise InputError(where, key, right, (str(key),))
        return MappingProxyType(dict(value))

    return check


def _options(where: str, value: Any) -> Mapping[str, str]:
    options = dict(_mapping("guide_model: cz")(where, value))
    for name, chosen in options.items():
        if isinstance(chosen, bool):
            options[name] = "yes" if chosen else "no"  # YAML reads a bare yes or no as a truth value
        elif not isinstance(chosen, str):
            right = "one of its words, as the family declares them"
            raise InputError(f"{where}: {name}", shown_kind(chosen), right, (name,))
    return MappingProxyType(options)


def _scalars(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with one value; ``sets``: or a list of numbers and texts."""

    def check(where: str, value: Any) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            if sets and isinstance(entry, (list, tuple)):
                _check_set(where, name, entry)
            elif isinstance(entry, (Mapping, list, tuple)):
                raise InputError(f"{where}: {name}", shown_kind(entry), f"one value, for example '{example}'", (name,))
        return checked

    return check


def _check_set(where: str, name: str, entries: Sequence[Any]) -> None:
    for k, entry in enumerate(entries):
        if not isinstance(entry, str) and not is_number(entry):
            right = "a finite number, or text such as '2 mm'"
            raise InputError(f"{where}: {name}, entry {k + 1}", shown_kind(entry), right, (name, k))


def _lists(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with a text or a list of texts; ``sets``: numbers may stand in lists as well."""

    def check(where: str, value: Any) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            listed = isinstance(entry, (list, tuple))
            entries = entry if listed else [entry]
            if sets and listed and entries:
                _check_set(where, name, entry)
            elif not entries or not all(isinstance(x, str) for x in entries):
                right = f"text or a list of texts, for example '{example}'"
                raise InputError(f"{where}: {name}", shown_kind(entry), right, (name,))
        return checked

    return check


def _objectives(where: str, value: Any) -> Any:
    example = "names, for example '[mass, actuation_force]', or names with min or max, for example '{mass: min}'"
    if value is None:
        return None
    if isinstance(value, str):
        value = [value]
    if isinstance(value, Mapping):
        if not all(isinstance(k, str) and isinstance(v, str) for k, v in value.items()):
            raise InputError(where, shown_kind(value), example)
        return MappingProxyType(dict(value))
    if not isinstance(value, (list, tuple)) or not all(isinstance(x, str) for x in value):
        raise InputError(where, shown_kind(value), example)
    return tuple(value)


def _catalogs(where: str, value: Any) -> Any:
    if value is None or isinstance(value, str):
        return value
    expected = "a folder, or a mapping such as 'friction_materials: my_materials.csv' or 'core_plates: [+, more.csv]'"
    if not isinstance(value, Mapping):
        raise InputError(where, shown_kind(value), expected)
    for table, source in value.items():
        entries = source if isinstance(source, (list, tuple)) else [source]
        if not isinstance(table, str) or not all(isinstance(x, str) for x in entries):
            raise InputError(f"{where}: {table}", shown_kind(source), expected, (str(table),))
    return MappingProxyType(dict(value))


def _rows(where: str, value: Any) -> Mapping[str, Mapping[str, Any]]:
    """Return rows of tables as a design has kept them, in SI: TABLE/DESIGNATION -> column -> number or text."""
    rows = _mapping("units/B: {designation: B, table: units, mass: 4.0, hash: ...}")(where, value)
    for name, row in rows.items():
        told = isinstance(row, Mapping) and all(
            isinstance(row.get(key), str) for key in ("designation", "table", "hash")
        )
        cells = [x for column, x in row.items() if column != "units"] if told else []
        units = row.get("units", {}) if told else {}
        told &= isinstance(units, Mapping) and all(isinstance(x, str) for x in units.values())
        if not told or not all(x is None or isinstance(x, str) or is_number(x) for x in cells):
            raise InputError(f"{where}: {name}", shown_kind(row), ROW_EXPECTED, (name,))
    return rows


def _weights(where: str, value: Any) -> Mapping[str, float]:
    weights = _mapping("mass: 2")(where, value)
    for name, weight in weights.items():
        if not is_number(weight) or weight < 0:
            raise InputError(f"{where}: {name}", shown_kind(weight), "a number, zero or more", (name,))
    return weights


def _whole(least: int, most: int) -> Callable[[str, Any], int | None]:
    def check(where: str, value: Any) -> int | None:
        return None if value is None else whole_number(shown_kind(value), where, most, least)

    return check


def _gap(where: str, value: Any) -> float | None:
    if value is None:
        return None
    if not is_gap(value):
        raise InputError(where, shown_kind(value), GAP_EXPECTED)
    return float(value)


def _grid(where: str, value: Any) -> bool | None:
    if value is None or isinstance(value, bool):
        return value
    raise InputError(where, shown_kind(value), "true (makeable sizes) or false")


def _seconds(where: str, value: Any) -> float | None:
    if value is None:
        return None
    if isinstance(value, str):
        from synth.units import parse_quantity  # NumPy comes with it; --help does without

        value = parse_quantity(value, "s", where)
    if not is_number(value) or value <= 0:
        raise InputError(where, shown_kind(value), "a time above zero, in seconds or with a unit such as '2 min'")
    return float(value)


FIELDS: dict[str, Callable[[str, Any], Any]] = {
    "family": _family,
    "options": _options,
    "requirements": _scalars("load_torque: 600 N*m"),
    "objectives": _objectives,
    "limits": _lists("outer_diameter: '<= 260 mm'", sets=True),
    "fix": _scalars("ramp_time: 2 s", sets=True),
    "parts": _lists("friction_pair: [designation]"),
    "catalogs": _catalogs,
    "weights": _weights,
    "robust": _mapping("friction: catalogue range"),
    "values": _scalars("friction_surfaces: 10"),
    "rows": _rows,
    "points": _whole(1, INPUT_LIMITS.points),
    "gap": _gap,
    "grid": _grid,
    "seed": _whole(0, INPUT_LIMITS.seed),
    "time_limit": _seconds,
    "workers": _whole(1, INPUT_LIMITS.workers),
}


# What is asked, how it is searched, and what may concern one family of several alone.
SEARCHED = ("points", "gap", "seed", "time_limit", "workers")
OF_A_DESIGN = ("values", "rows")  # stand only in a DESIGN.yaml
ASKED = tuple(key for key in FIELDS if key not in (*OF_A_DESIGN, *SEARCHED))
OWN = ("family", "options", "requirements", "limits", "fix", "parts", "robust")


def hint_at_key(key: Any) -> str:
    """Return the key that may be meant, or all that there are."""
    close = difflib.get_close_matches(str(key), FIELDS, n=1, cutoff=0.6)
    return f"{close[0]}" if close else "one of " + ", ".join(FIELDS)


def read_keys(content: Any, where: str, keys: Collection[str]) -> dict[str, Any]:
    """Checked content of some keys of a spec; None or an empty mapping where nothing is stated.

    Parameters
    ----------
    content : object
        What stands in a file, or came another way.
    where : str
        The name of that, for messages.
    keys : collection of str
        Those that are read; others of a spec may stand there as well.

    Raises
    ------
    InputError
        When a key is unknown or missing, or a value is not of its kind.
    """
    if not isinstance(content, Mapping):
        raise InputError(where, shown_kind(content), "a spec: lines such as 'family: multi_plate_clutch'")
    for key in content:
        if key not in FIELDS:
            raise InputError(f"{where}: key", key, hint_at_key(key), (str(key),))
    if "family" in keys and content.get("family") is None:
        raise no_family(where)
    checked: dict[str, Any] = {}
    for key, check in FIELDS.items():
        if key in keys:
            with at(key):
                absent = key == "values" and key not in content  # a design without values is none
                checked[key] = None if absent else check(f"{where}: {key}", content.get(key))
    return checked
