"""Spec files: a design question (or a given design) written as YAML or JSON, read strictly."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from synth.errors import Described, InputError
from synth.folders.files import read_bytes
from synth.question.request_fields import ASKED, FIELDS, SEARCHED
from synth.question.spec_keys import asks_several, hint_at_key, read_keys
from synth.text.input_limits import INPUT_LIMITS

if TYPE_CHECKING:
    from synth.question.request import Request
    from synth.question.settings import SearchSettings

# Whole numbers that Python does not read.
_LONG, _SHORTER = "a number of thousands of digits", "numbers below 1e308"


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
    rows: Mapping[str, Mapping[str, Any]]
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
        """True if several families are asked."""
        return asks_several(self.family)

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
                raise InputError("flag", key, hint_at_key(key))
            given[key] = FIELDS[key].read(f"--{key.replace('_', '-')}", value)
        return replace(self, **given)

    def request(self) -> Request:
        """Request to the one family of the spec."""
        from synth.model.registry import load  # NumPy comes with it; --help does without
        from synth.question.request import Request

        asked = self.stated(ASKED)
        family, options = asked.pop("family"), asked.pop("options", {})
        requirements = asked.pop("requirements", {})
        return Request.of(load(family, **options), requirements, folder=self.folder, **asked)

    def settings(self, **usual: Any) -> SearchSettings:
        """Search settings of the spec; ``usual`` counts where it states nothing."""
        from synth.question.settings import SearchSettings

        return SearchSettings(**{**usual, **self.stated(SEARCHED)})

    def stated(self, keys: Collection[str]) -> dict[str, Any]:
        """Entries of the spec under some keys, without those that are empty."""
        values = {name: getattr(self, name) for name in keys}
        return {name: value for name, value in values.items() if value is not None and value != {}}


def spec_from_mapping(content: object, file: str, folder: Path) -> Spec:
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
    return Spec(**read_keys(content, file, FIELDS), file=file, folder=folder)


# ---- reading the file -----------------------------------------------------------------------------------------------


class _StrictLoader(yaml.SafeLoader):
    """YAML without its surprises: no duplicate keys, no aliases, no tags, no octal or base-60 numbers, no dates."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012  (PyYAML's own habit)

    def compose_node(self, parent: yaml.Node | None, index: int) -> Any:
        event: Any = self.peek_event()  # type: ignore[no-untyped-call]
        if self.check_event(yaml.events.AliasEvent):
            raise yaml.composer.ComposerError(None, None, "an alias (*name); write the value out", event.start_mark)
        if getattr(event, "tag", None) is not None:
            raise yaml.composer.ComposerError(None, None, "a tag (!name)", event.start_mark)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
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


def _decimal(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> int:
    text = loader.construct_scalar(node)
    try:
        return int(text)  # PyYAML's own would read 010 as eight
    except ValueError:
        raise yaml.constructor.ConstructorError(None, None, _LONG, node.start_mark) from None


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
        raise InputError(shown, Described("an empty file"), "a spec: lines such as 'family: multi_plate_clutch'")
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
    raw = read_bytes(file, what, most=INPUT_LIMITS.spec_file)
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
        raise InputError(f"{shown}, line {error.lineno}", Described(error.msg), "JSON") from error
    except RecursionError as error:
        raise InputError(shown, Described("brackets nested too deeply"), "JSON of a spec") from error
    except ValueError as error:  # of a number
        raise InputError(shown, Described(_LONG), _SHORTER) from error


def _parse_yaml(text: str, shown: str) -> Any:
    try:
        # The loader is a SafeLoader that reads less than its parent, not more.
        return yaml.load(text, Loader=_StrictLoader)
    except RecursionError as error:
        raise InputError(shown, Described("brackets nested too deeply"), "YAML of a spec") from error
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        slip = next((x for x in _SLIPS if re.search(x.problem, problem)), _Slip("", problem.removeprefix("found ")))
        mark = getattr(error, "context_mark" if slip.where_it_begins else "problem_mark", None)
        where = shown if mark is None else f"{shown}, line {mark.line + 1}"
        advice = "a file in YAML or JSON; this one is a table" if shown.lower().endswith(".csv") else ""
        raise InputError(where, Described(slip.got), advice or _yaml_advice(text, mark, problem, slip)) from error


@dataclass(frozen=True)
class _Slip:
    """A slip in YAML: how PyYAML tells it (a pattern), what it is in words, and what would be right."""

    problem: str
    got: str
    right: str = "YAML: one 'name: value' on a line, indented with spaces"
    where_it_begins: bool = (
        False  # the line to look at is where the bracket, text or name begins, not where it is missed
    )


_SLIPS = (
    _Slip(r"expected ',' or ']'", "a list whose bracket [ is not closed", "entries with commas between [ and ]", True),
    _Slip(r"expected ',' or '}'", "a bracket { that is not closed", "'name: value' with commas between { and }", True),
    _Slip("unexpected end of stream", "a quote that is not closed", "the same quote at both ends of a text", True),
    _Slip("could not find expected ':'", "a name without a colon", where_it_begins=True),
    _Slip("mapping values are not allowed", "a colon where no value can begin"),
    _Slip("sequence entries are not allowed", "a dash where no list can begin"),
    _Slip("expected the node content, but found (?!another)", "a sign where a value should begin"),
    _Slip("expected <block end>|expected '<document start>'", "an entry that does not go on with those above it"),
    _Slip(_LONG, _LONG, _SHORTER),
    _Slip("another document", "a second document after ---"),
)


def _yaml_advice(text: str, mark: yaml.Mark | None, problem: str, slip: _Slip) -> str:
    """Suggestion for slips that happen often."""
    lines = text.splitlines()
    line = lines[mark.line] if mark is not None and mark.line < len(lines) else ""
    if "\t" in line[: len(line) - len(line.lstrip())] or "'\\t'" in problem:
        return "spaces instead of tabs at the beginning of the line"
    if re.search(r":\s*[>&*%@`!|]", line):
        return "quotes around a text that begins with a sign, for example outer_diameter: '>= 200 mm'"
    return slip.right
