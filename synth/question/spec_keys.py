"""Specs by their keys: strict reading, and the messages for what a verb does not take."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from synth.errors import InputError, gathered, refuse_gathered
from synth.question.request_fields import FIELDS, shown_kind

# What would be right, where whoever knows of commands may say which.
ONE_FAMILY = "one family; to ask several is a comparison"
A_QUESTION = "a question without values; a given design is evaluated, not searched"
A_DESIGN = "the variables, counts and choices of the design; without them it is a question"


def no_family(where: str) -> InputError:
    """Message for a spec that names no family; ``where`` is its name."""
    from synth.plugins import family_names  # importlib.metadata comes with it; --help does without

    return InputError(f"{where}: family", None, f"the name of a family: {', '.join(family_names())}", ("family",))


def refuse_several(family: object, where: str) -> None:
    """Refuse several families; ``where`` is the name of the spec that states them."""
    if not isinstance(family, (str, list, tuple)):
        raise InputError(f"{where}: family", shown_kind(family), "a name", ("family",))
    if asks_several(family):
        raise InputError(f"{where}: family", shown_families(family), ONE_FAMILY, ("family",))


def refuse_values(values: Mapping[str, object] | None, where: str) -> None:
    """Refuse a given design where a question is meant; ``where`` is the name of the spec that states it."""
    if values is not None:
        raise InputError(f"{where}: values", ", ".join(values), A_QUESTION, ("values",))


def asks_several(family: object) -> bool:
    """True if several families are asked."""
    return not isinstance(family, str) or family == "any"


def shown_families(family: str | Iterable[object]) -> str:
    """Return the family or the families in words."""
    entries = [family] if isinstance(family, str) else family
    return ", ".join(str(x["family"]) if isinstance(x, Mapping) else str(x) for x in entries)


def hint_at_key(key: object) -> str:
    """Return the key that may be meant, or all that there are."""
    close = difflib.get_close_matches(str(key), FIELDS, n=1, cutoff=0.6)
    return f"{close[0]}" if close else "one of " + ", ".join(FIELDS)


def read_keys(content: object, where: str, keys: Collection[str]) -> dict[str, Any]:
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
        When keys are unknown or missing, or values are not of their kind: with all of that.
    """
    if not isinstance(content, Mapping):
        raise InputError(where, shown_kind(content), "a spec: lines such as 'family: multi_plate_clutch'")
    faults = [InputError(f"{where}: key", key, hint_at_key(key), (str(key),)) for key in content if key not in FIELDS]
    if "family" in keys and content.get("family") is None:
        faults.append(no_family(where))
        keys = [key for key in keys if key != "family"]
    checked: dict[str, Any] = {}
    for key, field in FIELDS.items():
        if key in keys:
            with gathered(faults):
                absent = key == "values" and key not in content  # a design without values is none
                checked[key] = None if absent else field.read(f"{where}: {key}", content.get(key))
    refuse_gathered(faults)
    return checked
