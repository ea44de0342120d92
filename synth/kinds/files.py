"""The files that can be made of the records of a job: a closed list for each, and how one of them is rendered."""

from __future__ import annotations

import io
import json
import re
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

from synth.analysis.drawing import is_drawn
from synth.analysis.reporting import explored, explored_comparison
from synth.errors import ExtraNeededError
from synth.kinds import kind as kind_named
from synth.kinds.asked import front_in, is_comparison
from synth.kinds.report import reported
from synth.kinds.verify import unpack
from synth.queue.records import NOTHING, Record, Sources
from synth.results import ParetoFront
from synth.results.drawings import PLOT, can_make, report
from synth.results.front_record import FRONT_FILE
from synth.results.loading import load_front
from synth.verbs.request import in_request, known_keys
from synth.verbs.requests import FrontReportRequest

__all__ = ["ExtraNeededError", "UnknownFileError", "files_of", "files_to_have", "render"]

BUNDLE = "bundle.zip"
WORKBOOK = "designs.xlsx"
REPORTS = ("report.html", "report.pdf")
EXPLORER, EXPLORED = "explorer.html", "explorer.json"  # the page, and what it shows for a page of others
SHEETS = ("_sheet.html", "_sheet.pdf", "_sheet.json", "_live.xlsx")
DRAWINGS = ("_drawing.svg", "_drawing.dxf")
EPOCH = (1980, 1, 1, 0, 0, 0)  # of all in an archive, so that the same records give the same bytes
OPTIONS = ("length", "full", "about", "design")


class UnknownFileError(LookupError):
    """A job has no file of this name."""


def files_of(kind: str, records: Mapping[str, bytes]) -> dict[str, int | None]:
    """Return the names of all files of a job, with their size where that is known without rendering.

    Parameters
    ----------
    kind : str
    records : mapping
        Of the job, by name.
    """
    kind_named(kind)
    found: dict[str, int | None] = {name: len(content) for name, content in records.items()}
    if FRONT_FILE in records:
        front = front_in(records)
        found |= {name: None for name in _front_files(front) if name not in found}
    elif is_comparison(records):
        found |= {name: None for name in (*_explorer_files("explorer_comparison"), *REPORTS)}
    return {**found, BUNDLE: None} if records else found


def files_to_have(kind: str, records: Mapping[str, bytes]) -> dict[str, int | None]:
    """Return the files of a job that can be had here: those of :func:`files_of` for which no extra is lacking."""
    return {n: size for n, size in files_of(kind, records).items() if n in records or can_make(n.rpartition(".")[2])}


def render(
    kind: str,
    records: Mapping[str, bytes],
    name: str,
    options: Mapping[str, object] | None = None,
    sources: Sources = NOTHING,
) -> Record:
    """Return one file of a job.

    Parameters
    ----------
    kind : str
    records : mapping
        Of the job, by name.
    name : str
        One of :func:`files_of`.
    options : mapping, optional
        Of reports and sheets: ``length``, ``full``, ``about``, ``design``, as for the kind ``report``.
    sources : Sources
        With the tables that its question names; live workbooks offer their rows.

    Raises
    ------
    UnknownFileError
        There is no such file.
    ExtraNeededError
        It needs an extra that is not installed.
    InputError
        An option is wrong.
    """
    given = known_keys(options or {}, OPTIONS)
    if name not in files_of(kind, records):
        raise UnknownFileError(name)
    if name in records:
        return Record.of(name, records[name])
    if name == BUNDLE:
        return Record.of(name, _bundle(records))
    if name == EXPLORED:
        return Record.of(name, _explored(records))
    if name == EXPLORER:
        files, _ = reported(records, _request(given, "explorer"), sources)
        return Record.of(name, files[name])
    if is_comparison(records):
        return Record.of(name, _report(records, name, given, sources))
    front = front_in(records)
    derived = _derived(front)
    if name in derived:
        return Record.of(name, derived[name])
    if name == PLOT:
        drawn = front.svg()
        if not drawn:
            raise UnknownFileError(PLOT)
        return Record.of(name, drawn)
    sheet = re.fullmatch(r"design_(\d+)(_sheet|_live|_drawing)\.[a-z]+", name)
    if sheet is not None:
        given["design"] = int(sheet.group(1))
    return Record.of(name, _report(records, name, given, sources))


def _request(given: Mapping[str, object], form: str) -> FrontReportRequest:
    return FrontReportRequest.read({**given, "formats": [form]}, in_request)


def _report(records: Mapping[str, bytes], name: str, given: Mapping[str, object], sources: Sources) -> bytes:
    """Return one file of a report of a front."""
    files, notes = reported(records, _request(given, name.rsplit(".", 1)[-1]), sources)
    if name not in files:
        raise UnknownFileError(notes[-1] if notes else name)  # a design that cannot be drawn
    return files[name]


def _derived(front: ParetoFront) -> dict[str, str]:
    """Files that follow from the record of a front alone, as its folder holds it."""
    return front.record_files()


def _explored(records: Mapping[str, bytes]) -> str:
    """Explorer record of a front, whose drawings a page asks for one by one, or of a comparison."""
    with tempfile.TemporaryDirectory(prefix="clutchsynth-") as place:
        folder = Path(place, "front")
        unpack(records, folder)
        record = explored_comparison(folder) if is_comparison(records) else explored(load_front(folder), drawn=0)
        return json.dumps(record, ensure_ascii=False, allow_nan=False)


def _front_files(front: ParetoFront) -> list[str]:
    """Return the names of the files of a front beside its records."""
    derived = _derived(front)
    stems = [name.removesuffix(".yaml") for name in derived if name.startswith("design_")]
    drawn = [PLOT] if front.svg() else []
    drawn += _explorer_files("explorer_record")
    endings = (*SHEETS, *(DRAWINGS if is_drawn(front.frame.family) else ()))
    return [*derived, *drawn, WORKBOOK, *REPORTS, *(f"{stem}{ending}" for stem in stems for ending in endings)]


def _explorer_files(needed: Literal["explorer_record", "explorer_comparison"]) -> list[str]:
    """Return the names of the files that explore, where the reports that are installed can make them."""
    return [EXPLORER, EXPLORED] if report(needed) is not None else []


def _bundle(records: Mapping[str, bytes]) -> bytes:
    """Return all records and what follows from them without rendering, as one archive."""
    files = dict(records)
    if FRONT_FILE in records:
        files = {**{n: text.encode() for n, text in _derived(front_in(records)).items()}, **files}
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            archive.writestr(zipfile.ZipInfo(name, EPOCH), files[name], zipfile.ZIP_DEFLATED)
    return buffer.getvalue()
