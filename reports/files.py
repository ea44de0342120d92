"""All files of a report: the front report, and sheets of the chosen designs, as HTML, PDF, JSON and workbooks."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from synth.drawing import Drawing
from synth.errors import InputError
from synth.results import Design, ParetoFront, foremost, named_designs
from synth.results.hookspecs import Made
from synth.results.report_request import BatchReportRequest, ComparisonRequest, ReportRequest

from .batch_report import batch_report
from .batch_workbook import batch_workbook
from .comparison_report import comparison_report
from .drawing.bodies import glb_of, not_bodies, round_areas, step_of
from .drawing.files import dxf_of, svg_of
from .explorer.comparison import comparison_record
from .explorer.page import explorer_page
from .explorer.record import explorer_record
from .extras import Formats
from .front_report import FrontReportRequest, front_report
from .sheet.blocks import Document
from .sheet.design_sheet import LENGTHS, SheetRequest, design_sheet, over_range_in_words, program_name
from .sheet.html import html
from .sheet.pdf import pdf_with_notes
from .sheet.record import sheet_record
from .workbook import live_workbook
from .workbook_front import front_workbook

FORMATS = ("html", "explorer", "pdf", "xlsx", "json", "svg", "dxf", "step", "glb")
BODIES = {"step": step_of, "glb": glb_of}  # of what is round in drawings
MAKERS: Mapping[str, Callable[..., str | bytes]] = {"svg": svg_of, "dxf": dxf_of, **BODIES}  # of drawings


def report_files(request: ReportRequest) -> Made:
    """Files of the report of a front or of a design by name, notes, and which extras lack for more files.

    Raises
    ------
    InputError
        Something asked is unknown, a design is not on the front, or a record differs from its formulas.
    """
    if request.how.length not in LENGTHS:
        raise InputError("length", request.how.length, f"one of {', '.join(LENGTHS)}", ("length",))
    for word in request.how.formats or [""]:
        if word not in FORMATS:
            raise InputError("formats", word, f"some of {', '.join(FORMATS)}", ("formats",))
    return _Files(request).all()


def comparison_files(request: ComparisonRequest) -> Made:
    """Files of the report of several families by name, notes, and which extras lack for more files."""
    formats = Formats(request.how.formats)
    files, notes = documents({"report": comparison_report(request)}, formats, request.how.fonts)
    if "explorer" in request.how.formats:
        links = {family: file for family, file in request.links.items() if "explorer" not in file}
        files["explorer.html"] = explorer_page(comparison_record(replace(request, links=links)))
    return files, notes, formats.lacking


def batch_files(request: BatchReportRequest) -> Made:
    """Files of the report of a batch by name, notes, and which extras lack for more files."""
    formats = Formats(request.how.formats)
    files, notes = documents({"report": batch_report(request.batch, request.how.about)}, formats, request.how.fonts)
    if formats.make("xlsx"):
        files["batch.xlsx"] = batch_workbook(request.batch, request.how.about)
    return files, notes, formats.lacking


def documents(
    made: Mapping[str, Document], formats: Formats, fonts: Sequence[Path]
) -> tuple[dict[str, str | bytes], list[str]]:
    """Documents as files of the requested formats, by name without ending, and notes."""
    files: dict[str, str | bytes] = {}
    notes: list[str] = []
    for name, document in made.items():
        if formats.make("html"):
            files[f"{name}.html"] = html(document)
        if formats.make("pdf"):
            files[f"{name}.pdf"], messages = pdf_with_notes(document, fonts)
            notes += [note for note in messages if note not in notes]
    return files, notes


class _Files:
    def __init__(self, request: ReportRequest) -> None:
        self.request, self.formats = request, Formats(request.how.formats)
        self.files: dict[str, str | bytes] = {}
        self.notes: list[str] = []

    def all(self) -> Made:
        self._make()
        return self.files, self.notes, self.formats.lacking

    def _make(self) -> None:
        request = self.request
        if request.front is None:
            assert request.design is not None
            if "explorer" in request.how.formats:
                raise InputError(
                    "formats", "explorer", "the folder of a front with it: this is one design", ("formats",)
                )
            self._sheet(request.design, request.name)
        else:
            self._of_front(request.front)

    def _of_front(self, front: ParetoFront) -> None:
        request, formats = self.request, self.formats
        width = max(2, len(str(len(front.designs))))
        chosen = named_designs(front, request.chosen)
        names = {d.rank or 0: f"design_{d.rank:0{width}d}" for d in chosen}
        kind = next((word for word in ("html", "pdf") if formats.make(word)), "")
        sheets = {rank: f"{name}_sheet.{kind}" for rank, name in names.items()} if kind else {}
        document = front_report(
            FrontReportRequest(
                front=front,
                calculation=request.calculation,
                about=request.how.about,
                full=request.full,
                sheets=sheets,
                prices=request.prices,
                near_equals=request.near_equals,
                curves=request.curves,
                explorer="explorer.html" if "explorer" in request.how.formats else "",
                drawings={
                    d.rank or 0: self._picture(d, f"drawing-{d.rank}")
                    for d in foremost(front, request.full)
                    if d.rank in request.drawings
                },
            )
        )
        self._document(document, "report")
        if "explorer" in request.how.formats:
            self.files["explorer.html"] = self._explorer(front, sheets, names)
        if formats.make("xlsx"):
            self.files["designs.xlsx"] = front_workbook(front, request.calculation)
        for design in chosen:
            self._sheet(design, names[design.rank or 0])

    def _drawing_files(self, rank: int, name: str) -> dict[str, str]:
        """Return the names of the drawings of a design that are asked for, by what they are."""
        drawing = self.request.drawings.get(rank)
        if drawing is None:
            return {}
        none = () if round_areas(drawing) else BODIES
        words = [word for word in MAKERS if word not in none and self.formats.make(word)]
        return {word: f"{name}_drawing.{word}" for word in words}

    def _explorer(self, front: ParetoFront, sheets: Mapping[int, str], names: Mapping[int, str]) -> str:
        """Return the page of the explorer; it leads to the files that are written beside it."""
        request = self.request
        linked: dict[int, dict[str, str]] = {rank: {"Calculation sheet": file} for rank, file in sheets.items()}
        for rank, name in names.items():
            drawn = {f"Drawing, {word.upper()}": file for word, file in self._drawing_files(rank, name).items()}
            linked[rank] = {**linked.get(rank, {}), **drawn}
        return explorer_page(explorer_record(request, linked))

    def _document(self, document: Document, name: str) -> None:
        files, notes = documents({name: document}, self.formats, self.request.how.fonts)
        self.files |= files
        self.notes += [note for note in notes if note not in self.notes]

    def _sheet(self, design: Design, name: str) -> None:
        request = self.request
        drawing = request.drawings.get(design.rank or 0)
        picture = "" if drawing is None or request.how.length == "summary" else self._picture(design)
        sheet = SheetRequest(request.calculation, design, request.front, request.how.about, request.how.length, picture)
        self._document(design_sheet(sheet), f"{name}_sheet")
        if "json" in request.how.formats:
            content = sheet_record(request.calculation, design)
            self.files[f"{name}_sheet.json"] = json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False) + "\n"
        if self.formats.make("xlsx"):
            proven = "" if request.front is None else request.front.certificate.sentence()
            if design.robust:
                proven += ". NOMINAL POINT ONLY: this workbook does not compute what scatters. "
                proven += over_range_in_words(design)
            self.files[f"{name}_live.xlsx"] = live_workbook(
                request.calculation, design, request.rows, request.how.about, proven
            )
        for word, file in self._drawing_files(design.rank or 0, name).items():
            heading = design.frame.title, program_name(request.front), request.how.about
            self.files[file] = MAKERS[word](request.drawings[design.rank or 0], *heading)
        bodies = [word for word in BODIES if word in request.how.formats]
        if drawing is not None and bodies and (not round_areas(drawing) or any(map(self.formats.make, bodies))):
            self._note_missing_bodies(drawing)

    def _picture(self, design: Design, prefix: str = "drawing") -> str:
        """Return the drawing of a design as SVG, with names inside that begin so."""
        heading = design.frame.title, program_name(self.request.front), self.request.how.about
        return svg_of(self.request.drawings[design.rank or 0], *heading, prefix)

    def _note_missing_bodies(self, drawing: Drawing) -> None:
        """Note which parts of a drawing have no body."""
        names = ", ".join(item.name for item in not_bodies(drawing))
        if not round_areas(drawing):
            names = f"all parts ({names})"
        note = f"STEP and glTF are without {names}: only parts that are round about the axis are bodies"
        if names and note not in self.notes:
            self.notes.append(note)
