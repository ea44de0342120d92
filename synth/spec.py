"""Spec files: a design question (or a given design) written as YAML or JSON, read strictly."""

from __future__ import annotations

import difflib
import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from synth.errors import InputError, at, whole_number
from synth.files import read_bytes
from synth.gap import GAP_EXPECTED, is_gap
from synth.input_limits import INPUT_LIMITS

LARGEST_FILE = 1_000_000  # bytes; a spec is written by hand, anything larger is another kind of file


@dataclass(frozen=True)
class Spec:
    """A design question as it stands in a file; what was not written is None (or an empty mapping).

    ``family`` is a name, "any", or a tuple of names and of mappings with ``family`` and what concerns it alone.
    ``file`` is the path as it was given and ``folder`` the place that relative catalogue paths start from.
    """

    family: Any
    options: Mapping[str, str]
    requirements: Mapping[str, Any]
    objectives: Any
    limits: Mapping[str, Any]
    fix: Mapping[str, Any]
    parts: Mapping[str, Any]
    catalogs: Any
    weights: Mapping[str, float]
    robust: Mapping[str, Any]
    values: Mapping[str, Any] | None
    points: int | None
    gap: float | None
    grid: bool | None
    seed: int | None
    time_limit: float | None
    workers: int | None
    file: str
    folder: Path

    @property
    def compares(self) -> bool:
        """Tell whether several families are asked."""
        return not isinstance(self.family, str) or self.family == "any"

    @property
    def shown_family(self) -> str:
        """Return the family or the families in words."""
        entries = [self.family] if isinstance(self.family, str) else self.family
        return ", ".join(str(x["family"]) if isinstance(x, Mapping) else str(x) for x in entries)

    def merged(self, **flags: Any) -> Spec:
        """Return the spec with some of its keys replaced; flags that are None change nothing.

        Parameters
        ----------
        **flags
            Keys of a spec, for example ``points=10``.

        Raises
        ------
        InputError
            When a key is unknown or a value is not of its kind.
        """
        given = {key: value for key, value in flags.items() if value is not None}
        for key, value in given.items():
            if key not in FIELDS:
                raise InputError("flag", key, _hint(key))
            with at(key):
                given[key] = FIELDS[key](f"--{key.replace('_', '-')}", value)
        return replace(self, **given)

    def search_settings(self) -> dict[str, Any]:
        """Return the arguments of ``synthesize`` that the spec states, requirements and catalogues apart."""
        names = (
            "objectives",
            "limits",
            "fix",
            "parts",
            "weights",
            "robust",
            "points",
            "gap",
            "grid",
            "seed",
            "time_limit",
            "workers",
        )
        stated = {name: getattr(self, name) for name in names}
        return {name: value for name, value in stated.items() if value is not None and value != {}}


# ---- what each key may hold -----------------------------------------------------------------------------------------


class _Described:
    """Stands for a value in a message: ``got a list`` says more than the list itself."""

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return self._text


def _kind(value: Any) -> Any:
    """Return what to show of a value that is of the wrong kind."""
    if value is None:
        return _Described("nothing")
    if isinstance(value, Mapping):
        return _Described("a mapping")
    if isinstance(value, (list, tuple)):
        return _Described("a list")
    return value


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def _text(where: str, value: Any) -> str:
    if not isinstance(value, str) or not value.strip():
        raise InputError(where, _kind(value), "a name")
    return value


def _family(where: str, value: Any) -> Any:
    """Return a name, or several: names, and mappings with what concerns one family alone."""
    if not isinstance(value, (list, tuple)):
        return _text(where, value)
    if not value:
        raise InputError(where, _kind(value), "a name, 'any', or a list with at least one name")
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
            raise InputError(where, _kind(value), f"a mapping, for example '{example}'")
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
            right = "one of the words that clutchsynth describe lists"
            raise InputError(f"{where}: {name}", _kind(chosen), right, (name,))
    return MappingProxyType(options)


def _scalars(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with one value; ``sets``: or a list of numbers and texts."""

    def check(where: str, value: Any) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            if sets and isinstance(entry, (list, tuple)) and all(isinstance(x, str) or _is_number(x) for x in entry):
                continue
            if isinstance(entry, (Mapping, list, tuple)):
                raise InputError(f"{where}: {name}", _kind(entry), f"one value, for example '{example}'", (name,))
        return checked

    return check


def _lists(example: str, sets: bool = False) -> Callable[[str, Any], Mapping[str, Any]]:
    """Return a check of names with a text or a list of texts; ``sets``: numbers may stand in lists as well."""

    def check(where: str, value: Any) -> Mapping[str, Any]:
        checked = _mapping(example)(where, value)
        for name, entry in checked.items():
            listed = isinstance(entry, (list, tuple))
            entries = entry if listed else [entry]
            if not entries or not all(isinstance(x, str) or (sets and listed and _is_number(x)) for x in entries):
                right = f"text or a list of texts, for example '{example}'"
                raise InputError(f"{where}: {name}", _kind(entry), right, (name,))
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
            raise InputError(where, _kind(value), example)
        return MappingProxyType(dict(value))
    if not isinstance(value, (list, tuple)) or not all(isinstance(x, str) for x in value):
        raise InputError(where, _kind(value), example)
    return tuple(value)


def _catalogs(where: str, value: Any) -> Any:
    if value is None or isinstance(value, str):
        return value
    expected = "a folder, or a mapping such as 'friction_materials: my_materials.csv' or 'core_plates: [+, more.csv]'"
    if not isinstance(value, Mapping):
        raise InputError(where, _kind(value), expected)
    for table, source in value.items():
        entries = source if isinstance(source, (list, tuple)) else [source]
        if not isinstance(table, str) or not all(isinstance(x, str) for x in entries):
            raise InputError(f"{where}: {table}", _kind(source), expected, (str(table),))
    return MappingProxyType(dict(value))


def _weights(where: str, value: Any) -> Mapping[str, float]:
    weights = _mapping("mass: 2")(where, value)
    for name, weight in weights.items():
        if not _is_number(weight) or weight < 0:
            raise InputError(f"{where}: {name}", _kind(weight), "a number, zero or more", (name,))
    return weights


def _whole(least: int, most: int) -> Callable[[str, Any], int | None]:
    def check(where: str, value: Any) -> int | None:
        return None if value is None else whole_number(_kind(value), where, most, least)

    return check


def _gap(where: str, value: Any) -> float | None:
    if value is None:
        return None
    if not is_gap(value):
        raise InputError(where, _kind(value), GAP_EXPECTED)
    return float(value)


def _grid(where: str, value: Any) -> bool | None:
    if value is None or isinstance(value, bool):
        return value
    raise InputError(where, _kind(value), "true (makeable sizes) or false")


def _seconds(where: str, value: Any) -> float | None:
    if value is None:
        return None
    if isinstance(value, str):
        from synth.units import parse_quantity  # NumPy comes with it; --help does without

        value = parse_quantity(value, "s", where)
    if not _is_number(value) or value <= 0:
        raise InputError(where, _kind(value), "a time above zero, in seconds or with a unit such as '2 min'")
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
    "points": _whole(1, INPUT_LIMITS.points),
    "gap": _gap,
    "grid": _grid,
    "seed": _whole(0, INPUT_LIMITS.seed),
    "time_limit": _seconds,
    "workers": _whole(1, INPUT_LIMITS.workers),
}


# What may concern one family of several alone.
OWN = ("family", "options", "requirements", "limits", "fix", "parts", "robust")


def _hint(key: Any) -> str:
    close = difflib.get_close_matches(str(key), FIELDS, n=1, cutoff=0.6)
    return f"{close[0]}" if close else "one of " + ", ".join(FIELDS)


def spec_from_mapping(content: Any, file: str, folder: Path) -> Spec:
    """Check a mapping that was read from a file (or came another way) and make a Spec of it.

    Parameters
    ----------
    content : object
        What stands in the file.
    file : str
        Its name, for messages.
    folder : Path
        Folder that relative catalogue paths start from.

    Raises
    ------
    InputError
        When a key is unknown or missing, or a value is not of its kind.
    """
    if not isinstance(content, Mapping):
        raise InputError(file, _kind(content), "a spec: lines such as 'family: multi_plate_clutch'")
    for key in content:
        if key not in FIELDS:
            raise InputError(f"{file}: key", key, _hint(key), (str(key),))
    if content.get("family") is None:
        right = "the name of a family; clutchsynth families lists them"
        raise InputError(f"{file}: family", None, right, ("family",))
    checked: dict[str, Any] = {"values": None}
    for key, check in FIELDS.items():
        if key != "values" or key in content:
            with at(key):
                checked[key] = check(f"{file}: {key}", content.get(key))
    return Spec(**checked, file=file, folder=folder)


# ---- reading the file -----------------------------------------------------------------------------------------------


class _StrictLoader(yaml.SafeLoader):
    """YAML without its surprises: no duplicate keys, no aliases, no octal or base-60 numbers, no dates."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012  (PyYAML's own habit)

    def compose_node(self, parent: Any, index: Any) -> Any:
        if self.check_event(yaml.events.AliasEvent):
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.composer.ComposerError(None, None, "an alias (*name); write the value out", mark)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise yaml.constructor.ConstructorError(
                        None, None, f"the key {key.value} a second time; write each key once", key.start_mark
                    )
                seen.add(key.value)
        return super().construct_mapping(node, deep=deep)


for _tag, _pattern, _first in (
    ("bool", r"true|True|TRUE|false|False|FALSE|yes|Yes|YES|no|No|NO|on|On|ON|off|Off|OFF", "tTfFyYnNoO"),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?", "-+.0123456789"),
):
    _StrictLoader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), list(_first))


def _decimal(loader: yaml.SafeLoader, node: Any) -> int:
    return int(loader.construct_scalar(node))  # PyYAML's own would read 010 as eight


_StrictLoader.add_constructor("tag:yaml.org,2002:int", _decimal)


def read_spec(path: str | Path) -> Spec:
    """Read a spec, or a DESIGN.yaml, strictly.

    Parameters
    ----------
    path : str or Path
        A YAML file, or a JSON file with the ending ``.json``.

    Returns
    -------
    Spec

    Raises
    ------
    InputError
        When the file cannot be read, is not YAML (JSON), has unknown or doubled keys, or a value of the wrong kind.
    """
    content = read_content(path, "spec")
    shown = str(path)
    if content is None:
        raise InputError(shown, _Described("an empty file"), "a spec: lines such as 'family: multi_plate_clutch'")
    return spec_from_mapping(content, shown, Path(path).parent)


def read_content(path: str | Path, what: str) -> Any:
    """Read a YAML file (JSON, with the ending ``.json``) strictly; what it means is for the caller to judge.

    Parameters
    ----------
    path : str or Path
    what : str
        What the file is, for messages.

    Returns
    -------
    object
        None for an empty file.

    Raises
    ------
    InputError
        When the file cannot be read, is not YAML (JSON), or has doubled keys.
    """
    file, shown = Path(path), str(path)
    text = _read_text(file, shown, what)
    return _parse_json(text, shown) if file.suffix.lower() == ".json" else _parse_yaml(text, shown)


def _read_text(file: Path, shown: str, what: str) -> str:
    raw = read_bytes(file, what, most=LARGEST_FILE)
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(what, shown, "a text file in UTF-8; this one is binary or in another encoding")
    return text


def _parse_json(text: str, shown: str) -> Any:
    if not text.strip():
        return None

    def pairs(entries: list[tuple[str, Any]]) -> dict[str, Any]:
        result: dict[str, Any] = {}
        for key, value in entries:
            if key in result:
                raise InputError(shown, key, "each key once; this one stands twice")
            result[key] = value
        return result

    def constant(word: str) -> Any:
        raise InputError(shown, word, "finite numbers")

    try:
        return json.loads(text, object_pairs_hook=pairs, parse_constant=constant)
    except InputError:
        raise
    except json.JSONDecodeError as error:
        raise InputError(f"{shown}, line {error.lineno}", _Described(error.msg), "JSON") from error
    except RecursionError as error:
        raise InputError(shown, _Described("brackets nested too deeply"), "JSON of a spec") from error
    except ValueError as error:  # of a number
        raise InputError(shown, _Described("a number of thousands of digits"), "numbers that can be meant") from error


def _parse_yaml(text: str, shown: str) -> Any:
    try:
        # The loader is a SafeLoader that reads less than its parent, not more.
        return yaml.load(text, Loader=_StrictLoader)
    except RecursionError as error:
        raise InputError(shown, _Described("brackets nested too deeply"), "YAML of a spec") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        mark = getattr(error, "problem_mark", None)
        where = shown if mark is None else f"{shown}, line {mark.line + 1}"
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        problem = problem.replace("but found another document", "a second document after ---")
        raise InputError(where, _Described(problem), _yaml_advice(text, mark, problem)) from error


def _yaml_advice(text: str, mark: Any, problem: str) -> str:
    """Return what to type instead, for the slips that happen."""
    lines = text.splitlines()
    line = lines[mark.line] if mark is not None and mark.line < len(lines) else ""
    if "\t" in line[: len(line) - len(line.lstrip())] or "'\\t'" in problem:
        return "spaces instead of tabs at the beginning of the line"
    if re.search(r":\s*[>&*%@`!|]", line):
        return "quotes around a text that begins with a sign, for example outer_diameter: '>= 200 mm'"
    return "YAML: one 'name: value' on a line, indented with spaces"
