"""What the methods of a front ask of the facade is there, and takes what they give."""

from __future__ import annotations

import inspect

import pytest

from synth.results.door import Door, door
from synth.results.front import ParetoFront
from synth.results.report_request import ReportOptions

VERBS = {"calculation", "verify", "improve", "report", "explore"}


@pytest.mark.parametrize("name", sorted(VERBS))
def test_the_facade_takes_what_methods_give(name: str) -> None:
    asked = list(inspect.signature(getattr(Door, name)).parameters.values())[1:]
    positional = [None for parameter in asked if parameter.kind is parameter.POSITIONAL_ONLY]
    method = inspect.signature(getattr(ParetoFront, name, Door.calculation)).parameters
    options = set(method) - {"self", "front", "folder", "height"}
    if "how" in {parameter.name for parameter in asked}:
        options -= set(inspect.signature(ReportOptions.read).parameters)  # the method makes one record of them
    given = {name: None for name in options} if asked[-1].kind is asked[-1].VAR_KEYWORD else {}
    inspect.signature(getattr(door(), name)).bind(*positional, **given)


def test_every_verb_is_tried() -> None:
    own = {name for name, member in vars(Door).items() if inspect.isfunction(member) and not name.startswith("_")}
    assert own == VERBS
