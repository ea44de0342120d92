"""Objectives of a question: chosen by name, with ties settled by weights."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

from synth.errors import InputError
from synth.model.model import Model
from synth.question.arguments import Objectives
from synth.question.request_fields import is_number, shown_kind


def chosen_objectives(model: Model, requested: Objectives) -> dict[str, str]:
    """Return the objectives by name with their sense: those requested, or the family's defaults.

    Raises
    ------
    InputError
        When a name is unknown, a sense is not min or max, or there is none at all.
    """
    declared = model.declaration.objectives
    if requested is None:
        chosen = {o.name: o.sense for o in declared.values() if o.default}
        if not chosen:
            raise InputError(
                "objectives", None, "at least one of " + ", ".join(declared or model.quantity_sx), ("objectives",)
            )
        return chosen
    if isinstance(requested, str):
        requested = [requested]
    pairs = requested.items() if isinstance(requested, Mapping) else [(name, None) for name in requested]
    result: dict[str, str] = {}
    for word, sense in pairs:
        name = model.name_of(str(word), "objectives", list(model.quantity_sx), "a quantity")
        if sense is None:
            if name not in declared:
                raise InputError(
                    f"objectives: {name}",
                    None,
                    f"a sense, for example {{{name}: min}}; declared are {', '.join(declared)}",
                    ("objectives", name),
                )
            sense = declared[name].sense
        if sense not in ("min", "max"):
            raise InputError(f"objectives: {name}", sense, "min or max", ("objectives", name))
        if name in result:
            raise InputError("objectives", word, "each objective once", ("objectives", str(word)))
        result[name] = str(sense)
    if not result:
        right = "at least one of " + ", ".join(declared or model.quantity_sx)
        raise InputError("objectives", shown_kind(requested), right, ("objectives",))
    return result


def quantities_compared(model: Model, requested: Objectives) -> list[str]:
    """Quantities that are objectives of a question; none of objectives that are refused when the question is posed."""
    with suppress(InputError):
        return list(chosen_objectives(model, requested))
    return []


def with_ties(model: Model, chosen: Mapping[str, str]) -> dict[str, str]:
    """Return the chosen objectives, then what settles ties: default objectives, preferences, others, variables."""
    declared = model.declaration.objectives.values()
    defaults, others = ({o.name: o.sense for o in declared if o.default is default} for default in (True, False))
    result = dict(chosen)
    for ties in (defaults, model.declaration.preferences, others):
        for name, sense in ties.items():
            result.setdefault(name, sense)
    for variable in model.variables:
        result.setdefault(variable.name, "min")
    return result


def weights_of(model: Model, chosen: Mapping[str, str], requested: Mapping[str, float]) -> list[float]:
    """Return the weights of the chosen objectives, 1 where none is stated; refuse what is no weight."""
    values = dict.fromkeys(chosen, 1.0)
    for name, weight in model.by_name(requested, "weights", list(chosen), "a chosen objective").items():
        if not (is_number(weight) and weight >= 0):
            raise InputError(f"weights: {name}", weight, "a number that is not negative", ("weights", name))
        values[name] = float(weight)
    if not any(values.values()):
        raise InputError("weights", dict(requested), "at least one weight above 0", ("weights",))
    return list(values.values())
