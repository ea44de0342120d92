"""The text of front.json: records of designs, numbers as JSON knows them, and a checksum over all."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth.results.plain import digest_of, finite, intact, plain

if TYPE_CHECKING:
    from synth.results.design import Design

FRONT_FILE = "front.json"
FRONT_FORMAT = 1  # of front.json


def record_text(content: Mapping[str, object]) -> str:
    """Return the text of a front.json."""
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def changed(content: Mapping[str, object]) -> str:
    """Fault of the checksum of a front.json; empty where it fits the content."""
    if "digest" not in content:
        return "front.json has no checksum; it was not written by this version"
    try:
        unchanged = intact(content)
    except (ValueError, RecursionError):  # numbers that are none
        unchanged = False
    return "" if unchanged else "front.json was changed after it was saved: its checksum does not fit"


def fits(content: Mapping[str, object], digest: str) -> bool:
    """True if a file beside front.json is the one with this checksum."""
    return bool(digest == content["digest"]) and intact(content)


# Of a record: what the search took, what follows from the rest, and where tables lie.
KEPT = ("calculation", "offered")  # digests of files beside it
NOT_THE_RESULT = ("digest", "result", "statistics", *KEPT)


def result_digest(content: Mapping[str, Any]) -> str:
    """Checksum of question and result, without entries that differ between equal searches."""
    result = {name: value for name, value in content.items() if name not in NOT_THE_RESULT}
    result["restated"] = {name: value for name, value in result.get("restated", {}).items() if name != "catalogs"}
    return digest_of(result)


def design_record(design: Design) -> dict[str, Any]:
    """Entry of a design in front.json."""
    return {
        "rank": design.rank,
        **({} if design.group is None else {"group": design.group}),
        "score": design.score,
        "status": design.status.value,
        "gap": design.gap,
        "note": design.note,
        "alternatives": list(design.alternatives),
        "objectives": _clean(design.objectives),
        "values": _clean(design.values),
        "choices": dict(design.choices),
        "parts": {slot: row.key for slot, row in design.parts.items()},
        **({"rows": [row.key for row in design.rows]} if design.rows else {}),
        "limits": {n: [finite(v), finite(x)] for n, (v, x) in design.limits.items()},
        "residuals": _clean(design.residuals),
        "utilisation": {n: None if u is None else finite(u) for n, u in design.utilisation.items()},
        "elasticity": {o: _clean(e) for o, e in design.elasticity.items()},
        "off_grid": dict(design.off_grid),
        "advice": list(design.advice),
        "violated": list(design.violated),
        "not_checked": list(design.not_checked),
        **({"outside": dict(design.outside)} if design.outside else {}),
        **({"steps": _clean(design.steps)} if design.steps else {}),
        **({"next_rows": {n: row.record() for n, row in design.next_rows.items()}} if design.next_rows else {}),
        **({} if design.digits is None else {"digits": design.digits}),
        **({"robust": plain(design.robust)} if design.robust else {}),
    }


def _clean(mapping: Mapping[str, float]) -> dict[str, Any]:
    return {k: finite(float(v)) for k, v in mapping.items()}
