"""The kind ``verify``: ``of`` a job with a front or a comparison, and the seconds for the proof."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from synth.errors import at
from synth.kinds.asked import (
    about_front,
    by_name,
    catalogs_of,
    front_in,
    fronts_in,
    is_comparison,
    json_record,
    read_json,
    records_of,
)
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results.front_record import FRONT_FILE, KEPT, fits
from synth.results.verification import Verification
from synth.verbs.requests import OF, VerifyRequest
from synth.verification.verify import verify
from synth.verification.verify_comparison import verify_comparison

MAIN = "verification.json"
WHOLE = "all of the comparison"


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request; without ``family`` a comparison is checked as a whole.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    of, asked = about_front(request, VerifyRequest)
    with at(OF):
        records = records_of(sources, of.of)
    if is_comparison(records) and of.family is None:
        families, title = tuple(fronts_in(records)), WHOLE
    else:
        front = front_in(records, of.family, check=False)
        families, title = (front.frame.family,), front.frame.title
    return CheckedRequest(
        request={**of.to_json(), **asked.to_json()}, title=f"Verification: {title}", families=families
    )


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Check what was saved; how far the proof is cannot be told before it ends."""
    tell({"stage": "verify", "done": 0.0, "message": ""})
    of, asked = about_front(request, VerifyRequest)
    records, limit = records_of(sources, of.of), asked.time_limit
    if is_comparison(records) and of.family is None:
        found = _comparison(records, sources, limit)
    else:
        front = front_in(records, of.family, check=False)
        found = verify(front, catalogs=catalogs_of(front.frame.restated.get("catalogs"), sources), time_limit=limit)
        found = _with_kept(found, records, of.family)
    content = {**asdict(found), "verdict": found.verdict.value, "holds": found.holds, "sentence": found.sentence()}
    return by_name(json_record(MAIN, content))


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a verification."""
    content = read_json(records, MAIN)
    kept = ("sentence", "certificate", "designs", "claimed_gap", "proven_gap")
    return {"outcome": content["verdict"], "findings": len(content["findings"]), **{k: content[k] for k in kept}}


def _with_kept(found: Verification, records: Mapping[str, bytes], family: object) -> Verification:
    """Return a verification that looks at the records beside that of the front as well."""
    folder = "" if family is None else f"{family}/"
    front = read_json(records, f"{folder}{FRONT_FILE}")
    findings = list(found.findings)
    for key in KEPT:
        try:
            same = key not in front or fits(read_json(records, f"{folder}{key}.json"), front[key])
        except (KeyError, ValueError, TypeError):  # there is none, or it cannot be read
            same = False
        if not same:
            findings.append(f"{key}.json is missing, or is not what was saved with {FRONT_FILE}")
    return replace(found, findings=tuple(findings))


def _comparison(records: Mapping[str, bytes], sources: Sources, limit: float) -> Verification:
    """Check a comparison, which is read from a folder."""
    first = next(iter(fronts_in(records)))
    tables = catalogs_of(front_in(records, first, check=False).frame.restated.get("catalogs"), sources)
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as place:
        unpack(records, Path(place))
        for family in fronts_in(records):
            front = front_in(records, family, check=False)
            kept = {f"{family}/{name}": text.encode() for name, text in front.record_files().items()}
            unpack({name: text for name, text in kept.items() if name not in records}, Path(place))
        return verify_comparison(place, limit, tables)


def unpack(records: Mapping[str, bytes], place: Path) -> None:
    """Write records into a folder of our own; their names are ours as well."""
    for name, content in records.items():
        target = place / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
