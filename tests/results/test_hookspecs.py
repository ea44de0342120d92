"""Installed hooks keep to their specifications, and the documentation lists them."""

from __future__ import annotations

import inspect
import re
from importlib.metadata import entry_points
from pathlib import Path
from typing import get_overloads

import pytest

from synth.model.hookspecs import FamilyHooks
from synth.model.registry import load
from synth.plugins import FAMILIES
from synth.results import hookspecs
from synth.results.drawings import REPORTS, report
from tests import shipped

PAGE = Path(__file__).parents[2] / "docs" / "reports.md"
OVERLOAD = re.compile(r"Literal\['(\w+)'\] -> specs\.(\w+) \| None")
HOOKS = [name for name in vars(FamilyHooks) if inspect.isfunction(getattr(FamilyHooks, name))]


def specifications() -> dict[str, type]:
    """Protocols of the hooks of reports by entry point, as the overloads of ``report`` name them."""
    found = {}
    for overload in get_overloads(report):
        told = overload.__annotations__
        name, protocol = OVERLOAD.fullmatch(f"{told['name']} -> {told['return']}".replace('"', "'")).groups()
        found[name] = getattr(hookspecs, protocol)
    return found


def installed_here() -> dict[str, object]:
    points = entry_points(group=REPORTS)
    return {point.name: point.load() for point in points if point.value.startswith("synth.reports.")}


def call_of(protocol: type) -> inspect.Signature:
    """Signature of the call of a protocol, without its instance."""
    signature = inspect.signature(protocol.__call__)
    return signature.replace(parameters=list(signature.parameters.values())[1:])


def test_every_report_has_a_specification_and_none_is_left_over():
    assert len(specifications()) == 15
    assert specifications().keys() == installed_here().keys()


@pytest.mark.parametrize("name", specifications())
def test_reports_are_called_as_their_specification_says(name):
    assert inspect.signature(installed_here()[name]) == call_of(specifications()[name])


def test_a_report_that_is_called_otherwise_is_noticed():
    def front_svg(front: hookspecs.ParetoFront, chosen: tuple[int, ...] = ()) -> str:
        return ""

    assert inspect.signature(front_svg) != call_of(hookspecs.FrontPlot)


def test_the_documentation_lists_all_hooks_of_reports():
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    listed = {name: text for name, text in rows if name in specifications()}
    assert listed == {name: protocol.__doc__.rstrip(".") for name, protocol in specifications().items()}


@pytest.mark.parametrize("family", shipped.FAMILIES)
def test_hooks_of_families_are_called_as_the_engine_calls_them(family):
    assert entry_points(group=FAMILIES, name=family)
    assert HOOKS == ["curves", "simulate", "drawing", "state"]
    own = type(load(family))
    for name in HOOKS:
        signature, wanted = (inspect.signature(getattr(home, name)).parameters for home in (own, FamilyHooks))
        assert list(signature.values()) == list(wanted.values()), f"{family}.{name}"
