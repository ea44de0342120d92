"""What the methods of a front ask of the facade is there, and takes what they give."""

from __future__ import annotations

import inspect

import pytest

from synth.results.door import Door, door

VERBS = [name for name, member in vars(Door).items() if inspect.isfunction(member) and not name.startswith("_")]


@pytest.mark.parametrize("name", VERBS)
def test_the_facade_takes_what_methods_give(name: str) -> None:
    asked = list(inspect.signature(getattr(Door, name)).parameters.values())[1:]
    positional = [None for parameter in asked if parameter.kind is parameter.POSITIONAL_ONLY]
    named = {parameter.name: None for parameter in asked if parameter.kind is parameter.KEYWORD_ONLY}
    inspect.signature(getattr(door(), name)).bind(*positional, **named)


def test_every_verb_is_one_of_those_five() -> None:
    assert set(VERBS) == {"calculation", "verify", "improve", "report", "explore"}
