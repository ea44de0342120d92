"""The kind ``report``: ``of`` a job with a front or a comparison, and how it is to be reported."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from synth.analysis.reporting import report as write_report
from synth.analysis.reporting import report_comparison
from synth.errors import ExtraNeededError, InputError, at
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
from synth.kinds.verify import unpack
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results import named_designs
from synth.results.drawings import EXTRAS, can_make
from synth.results.loading import load_front
from synth.results.report_request import About, ReportOptions
from synth.verbs.request import in_request
from synth.verbs.requests import OF, FrontReportRequest

MAIN = "report.json"  # which files there are, and what else is to be told


def options_of(asked: FrontReportRequest) -> ReportOptions:
    """Formats, length and head of a report."""
    return ReportOptions(formats=asked.formats, length=asked.length, about=About.of(asked.about))


def read(request: Mapping[str, object], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    of, asked = about_front(request, FrontReportRequest)
    options_of(asked)
    for word in asked.formats:
        if not can_make(word):
            raise ExtraNeededError(word, EXTRAS[word][2])
    with at(OF):
        records = records_of(sources, of.of)
    if is_comparison(records) and of.family is None:
        families, title = tuple(fronts_in(records)), "several families"
    else:
        front = front_in(records, of.family)
        families, title = (front.frame.family,), front.frame.title
        try:
            named_designs(front, asked.design)
        except InputError as error:
            raise InputError(in_request("design"), error.value, error.expected, error.path) from error
    return CheckedRequest(request={**of.to_json(), **asked.to_json()}, title=f"Report: {title}", families=families)


def work(request: Mapping[str, object], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Write the report and the sheets."""
    tell({"stage": "report", "done": 0.0, "message": ""})
    of, asked = about_front(request, FrontReportRequest)
    files, notes = reported(records_of(sources, of.of), asked, sources, of.family)
    main = json_record(MAIN, {"files": list(files), "notes": notes})
    made = [Record.of(name, content) for name, content in files.items()]
    return by_name(*made, main)


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a report."""
    content = read_json(records, MAIN)
    return {"outcome": "feasible", "files": content["files"], "notes": content["notes"]}


def reported(
    records: Mapping[str, bytes], asked: FrontReportRequest, sources: Sources, family: str | None = None
) -> tuple[dict[str, bytes], list[str]]:
    """Return the files of a report of the records of a job, and what else is to be told.

    Parameters
    ----------
    records : mapping
    asked : FrontReportRequest
    sources : Sources
        With the tables that its question names, for live workbooks.
    family : str, optional
        Of a comparison, the one that is reported; without it the common front is.

    Raises
    ------
    InputError
        A design is not on the front, or no format can be made without an extra that is not installed.
    """
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as place:
        source, target = Path(place, "source"), Path(place, "target")
        unpack(records, source)
        target.mkdir()
        if is_comparison(records) and family is None:
            written = report_comparison(source, target, options_of(asked), design=asked.design, full=asked.full)
        else:
            folder = source if family is None else source / family
            stated = front_in(records, family).frame.restated.get("catalogs")
            tables = catalogs_of(stated, sources) if "xlsx" in asked.formats else None
            written = write_report(
                load_front(folder), target, options_of(asked), design=asked.design, full=asked.full, catalogs=tables
            )
        files = {name: (target / name).read_bytes() for name in written.files}
        return files, [*written.notes, *map(str, written.lacking)]
