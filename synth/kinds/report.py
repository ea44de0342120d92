"""The kind ``report``: ``of`` a job with a front or a comparison, and how it is to be reported."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from synth.analysis.reporting import report as write_report
from synth.analysis.reporting import report_comparison
from synth.errors import ExtraNeededError, InputError, at, whole_number
from synth.kinds.asked import (
    FAMILY,
    OF,
    WHERE,
    by_name,
    catalogs_of,
    checked_keys,
    front_in,
    fronts_in,
    is_comparison,
    json_record,
    question_record,
    read_json,
    records_of,
)
from synth.kinds.request_schemas import REPORT_FORMATS as FORMATS
from synth.kinds.request_schemas import REPORT_LENGTHS as LENGTHS
from synth.kinds.request_schemas import keys_of
from synth.kinds.verify import unpack
from synth.question.spec_keys import shown_kind
from synth.queue.records import CheckedRequest, Record, ReportProgress, Sources
from synth.results import named_designs
from synth.results.drawings import EXTRAS, can_make
from synth.results.loading import load_front
from synth.results.report_request import About, ReportOptions
from synth.text.input_limits import INPUT_LIMITS

MAIN = "report.json"  # which files there are, and what else is to be told
KEYS = keys_of("report")
FULL = 5
LOGO = "logo"  # of ``about`` names a file: no request does


@dataclass(frozen=True, kw_only=True)
class ReportAsked:
    """How a front is reported; fields as for ``ParetoFront.report``."""

    design: tuple[str, ...] = ("1",)
    full: int = FULL
    formats: tuple[str, ...] = ("html",)
    length: str = "normal"
    about: Mapping[str, Any] | None = None

    @staticmethod
    def read(given: Mapping[str, Any]) -> ReportAsked:
        """Options of a report by its keys.

        Raises
        ------
        InputError
            One of them is not of its kind.
        """
        design = given.get("design", 1)
        words = list(design) if isinstance(design, (list, tuple)) else [design]
        for word in words:
            if isinstance(word, bool) or not isinstance(word, (int, str)):
                raise InputError(f"{WHERE}: design", shown_kind(word), "ranks, or knee", ("design",))
        formats = given.get("formats", ["html"])
        formats = [formats] if isinstance(formats, str) else formats
        if not isinstance(formats, (list, tuple)) or not formats or not all(word in FORMATS for word in formats):
            raise InputError(f"{WHERE}: formats", shown_kind(formats), f"some of {', '.join(FORMATS)}", ("formats",))
        length = given.get("length", "normal")
        if length not in LENGTHS:
            raise InputError(f"{WHERE}: length", shown_kind(length), f"one of {', '.join(LENGTHS)}", ("length",))
        return ReportAsked(
            design=tuple(str(word) for word in words),
            full=whole_number(given.get("full", FULL), "full", INPUT_LIMITS.points, least=0, path=("full",)),
            formats=tuple(word for word in FORMATS if word in formats),
            length=length,
            about=_about(given.get("about")),
        )

    def stated(self) -> dict[str, Any]:
        """Return it as it is stored."""
        stated: dict[str, Any] = {"design": list(self.design), "full": self.full, "formats": list(self.formats)}
        return {**stated, "length": self.length, **({"about": dict(self.about)} if self.about else {})}

    def options(self) -> ReportOptions:
        """Formats, length and head of the report."""
        return ReportOptions(formats=self.formats, length=self.length, about=About.of(self.about))


def _about(given: Any) -> dict[str, Any] | None:
    """About block of a report; no entry names a file."""
    if given is None:
        return None
    with at("about"):
        if not isinstance(given, Mapping):
            raise InputError(f"{WHERE}: about", shown_kind(given), "names with texts, {'project': 'Crane 4'}")
        for name, value in given.items():
            if name == LOGO:
                raise InputError(f"{WHERE}: about", name, "no logo: requests name no files", (LOGO,))
            if value is not None and not isinstance(value, (str, int, float)):
                raise InputError(f"{WHERE}: about: {name}", shown_kind(value), "a text", (str(name),))
    return {str(name): value for name, value in given.items()}


def read(request: Mapping[str, Any], sources: Sources) -> CheckedRequest:
    """Check a request.

    Raises
    ------
    InputError
        For everything that is wrong with it.
    """
    given = checked_keys(request, KEYS)
    asked = ReportAsked.read(given)
    for word in asked.formats:
        if not can_make(word):
            raise ExtraNeededError(word, EXTRAS[word][2])
    with at(OF):
        records = records_of(sources, given.get(OF))
    if is_comparison(records) and FAMILY not in given:
        families, title = tuple(fronts_in(records)), "several families"
    else:
        front = front_in(records, given.get(FAMILY))
        families, title = (front.frame.family,), front.frame.title
        try:
            named_designs(front, asked.design)
        except InputError as error:
            raise InputError(f"{WHERE}: design", error.value, error.expected, error.path) from error
    stated = {key: given[key] for key in (OF, FAMILY) if key in given}
    return CheckedRequest(request={**stated, **asked.stated()}, title=f"Report: {title}", families=families)


def work(request: Mapping[str, Any], sources: Sources, tell: ReportProgress) -> dict[str, Record]:
    """Write the report and the sheets."""
    tell({"stage": "report", "done": 0.0, "message": ""})
    records = records_of(sources, request[OF])
    files, notes = reported(records, ReportAsked.read(request), sources, request.get(FAMILY))
    main = json_record(MAIN, {"files": list(files), "notes": notes})
    made = [Record.of(name, content) for name, content in files.items()]
    return by_name(*made, main, question_record("report", request, sources))


def summary(records: Mapping[str, bytes]) -> dict[str, Any]:
    """Return the facts of a report."""
    content = read_json(records, MAIN)
    return {"outcome": "feasible", "files": content["files"], "notes": content["notes"]}


def reported(
    records: Mapping[str, bytes], asked: ReportAsked, sources: Sources, family: str | None = None
) -> tuple[dict[str, bytes], list[str]]:
    """Return the files of a report of the records of a job, and what else is to be told.

    Parameters
    ----------
    records : mapping
    asked : ReportAsked
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
            written = report_comparison(source, target, asked.options(), design=asked.design, full=asked.full)
        else:
            folder = source if family is None else source / family
            stated = front_in(records, family).frame.restated.get("catalogs")
            tables = catalogs_of(stated, sources) if "xlsx" in asked.formats else None
            written = write_report(
                load_front(folder), target, asked.options(), design=asked.design, full=asked.full, catalogs=tables
            )
        files = {name: (target / name).read_bytes() for name in written.files}
        return files, [*written.notes, *map(str, written.lacking)]
