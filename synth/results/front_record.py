"""What front.json says of a front, with a checksum over it."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from synth.results.design import Design
    from synth.results.front import ParetoFront

FORMAT = 1
RECORDED_PACKAGES = ("clutchsynth", "casadi", "numpy", "scipy", "moocore")


def front_record(front: ParetoFront) -> dict[str, Any]:
    """Return the content of the front.json of a front."""
    rows: dict[str, dict[str, Any]] = {}
    for design in front.designs:
        for row in design.parts.values():
            rows.setdefault(f"{row['table']}/{row}", {k: _finite(v) for k, v in row.items()})
    frame = front.frame
    content = {
        "format": FORMAT,
        "family": frame.family,
        "title": frame.title,
        "options": dict(frame.options),
        "requirements": dict(frame.requirements),
        "requirement_values_si": dict(frame.requirement_values),
        "not_asked": list(frame.not_asked),
        "objectives": dict(frame.objectives),
        "units": dict(frame.units),
        "kinds": dict(frame.kinds),
        "limit_units": dict(frame.limit_units),
        "limit_senses": dict(frame.limit_senses),
        "restated": _plain(frame.restated),
        "settings": dict(front.settings),
        "versions": installed_versions(),
        "status": front.status.value,
        "interrupted": front.interrupted,
        "complete": front.complete,
        "certificate": front.certificate.__dict__ | {"gap": _finite(front.certificate.gap)},
        "statistics": _plain(front.statistics),
        "explanation": _plain(front.explanation),
        "parts": rows,
        "designs": [_design_record(d) for d in front.designs],
    }
    content["digest"] = digest_of(content)
    return content


def record_text(content: Mapping[str, Any]) -> str:
    """Return the text of a front.json."""
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def digest_of(content: Mapping[str, Any]) -> str:
    """Return the SHA-256 of the content of a front.json, without regard to the order of its keys."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def changed(content: Mapping[str, Any]) -> str:
    """Return what the checksum says against the content of a front.json; nothing where it fits."""
    if "digest" not in content:
        return "front.json has no checksum; it was not written by this version"
    try:
        fits = content["digest"] == digest_of({k: v for k, v in content.items() if k != "digest"})
    except (ValueError, RecursionError):  # numbers that are none
        fits = False
    return "" if fits else "front.json was changed after it was saved: its checksum does not fit"


def installed_versions() -> dict[str, str]:
    """Return the versions of the packages that decide the numbers."""
    return {name: _installed(name) for name in RECORDED_PACKAGES}


@cache
def _installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _design_record(design: Design) -> dict[str, Any]:
    return {
        "rank": design.rank,
        "score": design.score,
        "status": design.status.value,
        "gap": design.gap,
        "note": design.note,
        "alternatives": list(design.alternatives),
        "objectives": _clean(design.objectives),
        "values": _clean(design.values),
        "choices": dict(design.choices),
        "parts": {slot: f"{row['table']}/{row}" for slot, row in design.parts.items()},
        "limits": {n: [_finite(v), _finite(x)] for n, (v, x) in design.limits.items()},
        "residuals": _clean(design.residuals),
        "utilisation": {n: None if u is None else _finite(u) for n, u in design.utilisation.items()},
        "elasticity": {o: _clean(e) for o, e in design.elasticity.items()},
        "off_grid": dict(design.off_grid),
        "advice": list(design.advice),
        "violated": list(design.violated),
        "not_checked": list(design.not_checked),
        **({"outside": dict(design.outside)} if design.outside else {}),
        **({"robust": _plain(design.robust)} if design.robust else {}),
    }


def _finite(value: Any) -> Any:
    if isinstance(value, float) and math.isinf(value):
        return "inf" if value > 0 else "-inf"  # JSON has no infinity; float() reads these words back
    return None if isinstance(value, float) and math.isnan(value) else value


def _clean(mapping: Mapping[str, Any]) -> dict[str, Any]:
    return {k: _finite(float(v)) for k, v in mapping.items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return _finite(value)
