"""Calculations of the examples have no quantity without a name; few formulas are for SI alone."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

import synth
from tests.conformance.cases import CASES

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def test_few_formulas_are_for_si_alone():
    assert len(set().union(*(cases.for_si for cases in CASES.values()))) <= 5


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda p: p.stem)
def test_examples_are_told_in_full(path):
    content = yaml.safe_load(path.read_text())
    problem = synth.load(content["family"], **content.get("options", {}))
    calculation = synth.calculation(problem, content["requirements"])
    assert [q.name for q in calculation.quantities.values() if q.kind == "helper"] == []
