"""What schemas refuse, in words for people: their own are for programmers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from pydantic_core import ErrorDetails

from synth.errors import Described, InputError, Key
from synth.queue.accounts import NAME_PATTERN
from synth.text.plain_text import UNSAFE_IN_LINE

WORD = r"^[^\x00]*$"  # PostgreSQL keeps no text with the character 0
LINE = rf"^[^{UNSAFE_IN_LINE}]*$"
TITLE = rf"^[^{UNSAFE_IN_LINE}]*[^{UNSAFE_IN_LINE}\u0020\u00a0][^{UNSAFE_IN_LINE}]*$"
WITHOUT_MARKS = ", without marks that turn the direction of writing"
PRINTED = r"^[\x21-\x7e]+$"
PATTERNS: Mapping[str, str] = MappingProxyType(
    {
        WORD: "a text without the character 0",
        LINE: f"words in one line{WITHOUT_MARKS}",
        TITLE: f"words in one line, not blanks alone{WITHOUT_MARKS}",
        PRINTED: "letters, digits and signs of ASCII, without blanks",
        NAME_PATTERN: f"a name in one line, which does not begin with a blank{WITHOUT_MARKS}",
    }
)
ANYTHING = "what the description of the interface allows here"  # where a schema has a rule that nobody has put in words
# What would be right, by the type of a fault.
WORDS: Mapping[str, str] = MappingProxyType(
    {
        "missing": "a value",
        "extra_forbidden": "no key of this name; the description of the interface lists those there are",
        "string_type": "a text",
        "string_too_long": "at most {max_length} characters",
        "string_too_short": "a text that is not empty",
        "int_type": "a whole number",
        "int_parsing": "a whole number",
        "int_parsing_size": "a whole number of fewer digits",
        "int_from_float": "a whole number",
        "float_type": "a number",
        "float_parsing": "a number",
        "finite_number": "a finite number",
        "bool_type": "true or false",
        "bool_parsing": "true or false",
        "greater_than": "more than {gt}",
        "greater_than_equal": "{ge} or more",
        "less_than": "less than {lt}",
        "less_than_equal": "at most {le}",
        "literal_error": "{expected}",
        "enum": "{expected}",
        "too_short": "a list that is not empty",
        "too_long": "a list of at most {max_length} entries",
        "list_type": "a list",
        "dict_type": "a JSON object",
        "model_type": "a JSON object",
        "model_attributes_type": "a JSON object",
        "value_error": "a file with its content",
    }
)


def fault_of(told: ErrorDetails) -> InputError:
    """Fault that a schema has found in one place, in our words."""
    place = tuple(told["loc"])
    path = place[1:] if place[:1] in (("body",), ("query",), ("path",), ("header",)) else place
    value = None if told["type"] == "missing" else _short(told.get("input"))
    facts = {name: _plain(fact) for name, fact in (told.get("ctx") or {}).items()}
    if told["type"] == "string_pattern_mismatch":
        right = PATTERNS.get(str(facts.get("pattern")), ANYTHING)
    else:
        right = WORDS.get(told["type"], ANYTHING).format_map(facts)
    return InputError(place_in_words(path), value, right, path)


def place_in_words(path: Sequence[Key]) -> str:
    """Return a place in a body as people read it.

    Examples
    --------
    >>> place_in_words(["scopes", 1]), place_in_words([])
    ('scopes: entry 2', 'body')
    """
    return ": ".join(f"entry {key + 1}" if isinstance(key, int) else key for key in path) or "body"


def _plain(fact: object) -> Any:
    return int(fact) if isinstance(fact, float) and fact.is_integer() else fact


def _short(value: object) -> Any:
    """Return a value to be repeated: of a whole object or list only that it is one."""
    if isinstance(value, Mapping):
        return Described("an object" if value else "an empty object")
    if value is None:
        return Described("null")
    if isinstance(value, (list, tuple)):
        return Described("a list" if value else "an empty list")
    return value
