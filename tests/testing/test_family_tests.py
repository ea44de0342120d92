"""The suite for families: nobody else loads it, and what a family breaks is told by name."""

from __future__ import annotations

import subprocess
import sys

import pytest

import synth
from synth.testing.option_sets import of_an_option_set, traced
from tests.shipped import FAMILIES


@pytest.mark.slow
def test_families_do_not_load_the_suite() -> None:
    program = (
        "import sys, synth\n"
        f"for name in {FAMILIES!r}:\n    synth.describe(name)\n"
        "heads, end = ('pytest', '_pytest', 'synth.testing'), '.cases'\n"
        "print([m for m in sys.modules if m.startswith(heads) or m.endswith(end)])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_each_broken_property_is_told_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(type(synth.load("roller_coupling")), "title", "")
    (told,) = of_an_option_set.broken(traced("roller_coupling", "default"))
    assert told.startswith("the_class_names_itself_and_its_sources: AssertionError")
