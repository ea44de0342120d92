"""What users give by name: mappings, and requirements by their public names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.tables.catalogs import Catalogs


def as_mapping(value: Any, field: str, example: str) -> Mapping[str, Any]:
    """Return what must be names with values; nothing given is an empty mapping.

    Raises
    ------
    InputError
        When it is something else.
    """
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise InputError(field, value, f"names with values, for example {example}", (field,))
    return value


def known_requirements(problem: DesignProblem, requirements: Mapping[str, Any], catalogs: Catalogs) -> dict[str, Any]:
    """Return the requirements by public name; values of None count as not given.

    Raises
    ------
    InputError
        When a name is unknown or given twice.
    """
    # Whoever gives names gets the model that is asked next: tracing one costs as much as reading all else.
    model = problem.model(frozenset(str(word) for word, value in requirements.items() if value is not None), catalogs)
    result: dict[str, Any] = {}
    for word, value in requirements.items():
        name = model.name_of(str(word), "requirements", list(model.declaration.requirements), "a requirement")
        if name in result:
            right = "each requirement once (name and symbol mean the same)"
            raise InputError(f"requirement {name}", word, right, ("requirements", str(word)))
        if value is not None:
            result[name] = value
    return result
