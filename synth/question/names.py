"""What users give by name: mappings, and requirements by their public names."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

from synth.declaration import Declaration, RequirementRecord
from synth.errors import ELSEWHERE, InputError, NotCoveredError
from synth.model.model import Model
from synth.model.problem import DesignProblem
from synth.question.arguments import Requirements
from synth.tables.catalogs import Catalogs
from synth.units import TORQUE_OF_POWER, parse_quantity, parse_unit

POWER = re.compile(r"(?:\w*_)?power(?:_\w*)?|leistung|p", re.IGNORECASE)


@lru_cache(maxsize=128)
def _declared(family: type[DesignProblem], options: tuple[tuple[str, str], ...], catalogs: Catalogs) -> Declaration:
    """Declaration of a family with some options, cached: each slip of a name asks for all of them."""
    return family(**dict(options)).declaration(frozenset(), catalogs)


def as_mapping(value: object, field: str, example: str) -> Mapping[str, Any]:
    """Mapping of names to values; nothing given is an empty mapping.

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


def known_requirements(problem: DesignProblem, requirements: Requirements, catalogs: Catalogs) -> dict[str, Any]:
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
        name = requirement_named(str(word), value, problem, model, catalogs)
        if name in result:
            right = "each requirement once (name and symbol mean the same)"
            raise InputError(f"requirement {name}", word, right, ("requirements", str(word)))
        if value is not None:
            result[name] = value
    return result


def requirement_named(word: str, value: object, problem: DesignProblem, model: Model, catalogs: Catalogs) -> str:
    """Return the public name of a requirement.

    Raises
    ------
    InputError
        There is none of that name or symbol, or only with other options.
    """
    if word not in model.declaration.names():
        _refuse_of_other_options(problem, word, value, model, catalogs)
        if word in problem.declines:
            right = ELSEWHERE + problem.declines[word]
            raise NotCoveredError(f"requirement {word}", value, right, ("requirements", word))
        refuse_power(word, value, model.declaration.requirements.values())
    return model.name_of(word, "requirements", list(model.declaration.requirements), "a requirement")


def refuse_power(word: str, value: object, requirements: Collection[RequirementRecord]) -> None:
    """Refuse a power where a torque is asked, and say how that follows from it.

    Parameters
    ----------
    word : str
        What is stated, and none of the requirements.
    value : object
        Its value.
    requirements : collection of RequirementRecord
        Those that can be stated.

    Raises
    ------
    InputError
        The word is that of a power, or the value is one.
    """
    needed = [r for r in requirements if r.default is None and not r.optional]
    torques = dict.fromkeys(r.name for r in needed if parse_unit(r.unit).kind == "torque")
    close = get_close_matches(word, [r.name for r in requirements], n=1, cutoff=0.6)
    if torques and not close and (POWER.fullmatch(word) or _is_power(value)):
        right = f"{' or '.join(torques)}: {TORQUE_OF_POWER}"
        raise InputError(f"requirement {word}", value, right, ("requirements", word))


def _is_power(value: object) -> bool:
    if not isinstance(value, str) or not value.strip()[-1:].isalpha():
        return False  # a bare number is one of anything
    try:
        parse_quantity(value, "W", "power")
    except InputError:
        return False
    return True


def _refuse_of_other_options(
    problem: DesignProblem, word: str, value: object, model: Model, catalogs: Catalogs
) -> None:
    """Refuse a requirement that the problem has with another value of one of its options, and say with which.

    Raises
    ------
    InputError
        When there is such a value.
    """
    found, groups = dict[str, list[str]](), set[str]()
    family: Any = problem.declared_by
    for option in model.declaration.options.values():
        for label in option.structures:
            if label == option.chosen:
                continue
            others = {k: v for k, v in problem.options.items() if k not in (option.name, option.symbol)}
            try:
                declared = _declared(family, tuple(sorted({**others, option.name: label}.items())), catalogs)
            except InputError:  # what was asked beside it does not go with this value
                continue
            record = declared.requirements.get(declared.names().get(word, ""))
            if record is not None:
                found.setdefault(option.name, []).append(label)
                groups.add(record.group)
    if not found:
        return
    ways = [f"{name}: {' or '.join(labels)}" for name, labels in found.items()]
    # By an option that is called as the group is, the rules of that group are switched.
    own = [name for name in found if groups == {name}]
    asked = [f"{name}: {model.declaration.options[name].chosen}" for name in (own or found)]
    if own:
        ways = [way for way in ways if way.split(":")[0] in own]
        right = f"no value with {asked[0]}: it is a rule of {own[0]} and counts only with {ways[0]}"
    else:
        right = f"no value with {' and '.join(asked)}: it counts only with {', or with '.join(ways)}"
    raise InputError(f"requirement {word}", value, right, ("requirements", word))
