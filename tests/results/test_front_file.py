"""The JSON schema of front.json: committed, valid, and true of what is saved."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import synth
from synth.results.front_file import front_schema
from tests.results.front_schema import SCHEMA, schema_text
from tests.sample_problems.strut import NEEDED, RODS, Strut

RATED = {"load": "+-5 %", "mode": "rate", "samples": 64}


def test_the_committed_schema_is_that_of_the_records() -> None:
    assert SCHEMA.read_text(encoding="utf-8") == schema_text()
    jsonschema.Draft202012Validator.check_schema(front_schema())


@pytest.mark.parametrize(
    "more", [{}, {"robust": RATED}, {"limits": {"mass": "<= 1 g"}}], ids=["found", "rated", "none"]
)
def test_what_is_saved_fits_the_schema(more: dict[str, Any], tmp_path: Path) -> None:
    front = synth.synthesize(Strut(), NEEDED, points=2, catalogs={"rods": RODS}, **more)
    content = json.loads((front.save(tmp_path) / "front.json").read_text(encoding="utf-8"))
    jsonschema.validate(content, front_schema())
    content["designs"] = [{"rank": "first"}]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(content, front_schema())
