"""Writes the JSON schema of front.json: ``make schema``."""

from __future__ import annotations

import json
from pathlib import Path

from synth.results.front_file import front_schema

SCHEMA = Path(__file__).parents[2] / "docs" / "front.schema.json"


def schema_text() -> str:
    """Text of the schema."""
    return json.dumps(front_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    SCHEMA.write_text(schema_text(), encoding="utf-8")
