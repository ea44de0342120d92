"""The types from which the JavaScript of the pages is checked, against what the service and its engines give."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from synth.kinds import KINDS, small
from tests.kinds.jobs import DISC, disc, done, earlier, summary
from tests.service.answers import ANSWERS, OPEN, answers_text, holds, members

TOO_SMALL = {"of": "front", "limits": {"actuation_force": "<= 100 N"}}
ASKED: dict[str, dict[str, Any]] = {
    "synthesis": DISC,
    "whatif": {**DISC, "points": 1, "vary": {"load_torque": "50:60:10 N*m"}},
    "explain": TOO_SMALL,
    "prices": {"of": "front", "design": 1},
    "near_equals": {"of": "front", "count": 1},
    "rate": {"of": "front", "design": 1, "robust": {"load_torque": "+-1 %"}},
    "verify": {"of": "front"},
    "report": {"of": "front"},
}


def test_types_of_answers_are_those_of_the_description() -> None:
    assert ANSWERS.read_text(encoding="utf-8") == answers_text(), "make answers"
    for kinds in OPEN.values():
        for name in re.findall(r"[A-Z]\w+", kinds):
            assert name == "TableFault" or members(name)


@pytest.mark.slow
def test_rows_of_declarations_have_the_keys_of_their_type() -> None:
    for family in small.families():
        for row in small.declaration(family["name"])["rows"]:
            assert holds("DeclarationRow", json.loads(json.dumps(row))) == set(row)


@pytest.mark.slow
def test_results_and_their_facts_have_the_keys_of_their_types() -> None:
    named: set[str] = set()
    types = {"synthesis": "Front", "whatif": "Study", "explain": "Explanation", "verify": "Verification"}
    for kind, asked in ASKED.items():
        records = disc() if kind == "synthesis" else done(kind, asked, earlier())
        named |= holds("Summary", summary(kind, records))
        content = json.loads(records[KINDS[kind].record])
        if kind in types:
            holds(types[kind], content)
        for key, name in (("steps", "Step"), ("breaks", "Break"), ("ways", "Way")):
            for one in content.get(key, ()) if kind in ("whatif", "explain") else ():
                holds(name, one)
    assert set(members("Summary")) - named == {
        "objective",
        "rows",
        "status",
        "total_excess",
        "unit",
        "variants",
    }  # batch
