"""Values as JSON and YAML know them."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any


def finite(value: object) -> Any:
    """Return a value as JSON knows it: infinities in words, nothing for what is no number."""
    if isinstance(value, float) and math.isinf(value):
        return "inf" if value > 0 else "-inf"  # JSON has no infinity; float() reads these words back
    return None if isinstance(value, float) and math.isnan(value) else value


def plain(value: object) -> Any:
    """Return nested mappings and sequences with all numbers as JSON knows them."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(v) for v in value]
    return finite(value)


def digest_of(content: Mapping[str, object]) -> str:
    """Return the SHA-256 of the content of a record, without regard to the order of its keys."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def compact_json(content: Mapping[str, object]) -> str:
    """Text of a file that programs read."""
    return json.dumps(content, separators=(",", ":"), allow_nan=False, ensure_ascii=False) + "\n"


def intact(content: Mapping[str, object]) -> bool:
    """True if the checksum in a record is that of the rest of it."""
    return bool(content["digest"] == digest_of({k: v for k, v in content.items() if k != "digest"}))
