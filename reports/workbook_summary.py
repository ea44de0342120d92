"""The first sheet of a live workbook: how the design stands, what was changed, and what all this is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.results import Design
from synth.results.calculation import Calculation

from .excel_sheets import BAD, GOOD, Sheet, cell
from .workbook_cells import change
from .workbook_limits import BEYOND, ENDLESS, NOTHING, VIOLATED, LimitCells

LABEL, VALUE, UNIT, SOLVED, CHANGE, TEXT = range(6)
WIDTHS = (22, 18, 12, 18, 12, 74)
AS_SOLVED = "as solved"
FEASIBLE = "FEASIBLE: all limits that can be checked hold"
ONE, SEVERAL = " limit is violated", " limits are violated"
NO_CERTIFICATE = "none: inputs were changed since"
NOTES = (
    "This workbook recomputes one design. It does not search, and a value that is changed has no certificate.",
    "Yellow cells are inputs: type over them, or choose from their lists. All others are locked, without a password.",
    "Formulas are in SI and call cells by their public names (see the Name Manager); values are shown in their unit.",
    "#N/A: the quantity does not exist for these inputs, because a guard fails or a row of a table has no value.",
    "A limit holds within a millionth of its size, a guard strictly; one whose number is not given is not checked.",
    "Parts: choose another designation on the sheet Parts; its columns are looked up in the sheet Catalogue.",
)


@dataclass(frozen=True)
class Objective:
    """An objective as the summary shows it: the formula of its value, the value, its unit and meaning."""

    name: str
    formula: str
    value: float
    unit: str
    text: str


def write_summary(
    sheet: Sheet,
    calculation: Calculation,
    design: Design,
    about: Mapping[str, str],
    certificate: tuple[str, str],
    objectives: Sequence[Objective],
    limits: LimitCells,
    changed: str,
) -> None:
    """Write the summary.

    Parameters
    ----------
    sheet : Sheet
    calculation : Calculation
    design : Design
    about : mapping
        What stands at the head.
    certificate : (str, str)
        What is proven, and the cell that holds it.
    objectives : list of Objective
    limits : LimitCells
    changed : str
        Formula for how many inputs are not as they were solved.
    """
    sheet.text(0, LABEL, calculation.title, "title")
    sheet.worksheet.set_row(0, 26)
    sheet.worksheet.set_row(1, 22)
    _state(sheet, limits)
    row = _status(sheet, certificate, limits, changed)
    row = _pairs(sheet, row + 1, "", about)
    row = _objectives(sheet, row + 1, objectives)
    rank = {} if design.rank is None else {"rank": str(design.rank)}
    row = _pairs(sheet, row + 1, "Question and options", {"family": calculation.family, **rank, **calculation.options})
    row = _lines(sheet, row + 1, "How to read it", NOTES)
    _lines(sheet, row + 1, "Sources", calculation.sources)


def _state(sheet: Sheet, limits: LimitCells) -> None:
    """Write in one line whether all limits hold."""
    count = f'COUNTIF({limits.verdicts},"{VIOLATED}")'
    text = f'IF({count}=0,"{FEASIBLE}","NOT FEASIBLE: "&{count}&IF({count}=1,"{ONE}","{SEVERAL}"))'
    failing = limits.violated
    shown = f"NOT FEASIBLE: {failing}{ONE if failing == 1 else SEVERAL}" if failing else FEASIBLE
    sheet.formula(1, LABEL, text, shown, "state")
    for start, colour in (("NOT", BAD), ("FEASIBLE", GOOD)):
        form = sheet.book.added(font_color=colour)
        rule = {"type": "text", "criteria": "begins with", "value": start, "format": form}
        sheet.worksheet.conditional_format(1, LABEL, 1, LABEL, rule)


def _status(sheet: Sheet, certificate: tuple[str, str], limits: LimitCells, changed: str) -> int:
    """Write what was changed, what is proven, and which limit governs; return the next row."""
    words, place = certificate
    row = 3
    sheet.text(row, LABEL, "Inputs", "name")
    here = cell(row, VALUE)
    text = f'IF({changed}=0,"{AS_SOLVED}",{changed}&" changed since it was solved")'
    sheet.merge(row, VALUE, TEXT, "")
    sheet.formula(row, VALUE, text, AS_SOLVED, "text")
    form = sheet.book.added(font_color=BAD, bold=True)
    rule = {"type": "text", "criteria": "containing", "value": "changed", "format": form}
    sheet.worksheet.conditional_format(row, VALUE, row, VALUE, rule)
    row += 1
    sheet.text(row, LABEL, "Certificate", "name")
    sheet.merge(row, VALUE, TEXT, words)
    sheet.formula(row, VALUE, f'IF({here}="{AS_SOLVED}",{place},"{NO_CERTIFICATE}")', words, "text")
    row += 1
    if limits.count:
        sheet.text(row, LABEL, "Governing limit", "name")
        sheet.merge(row, VALUE, TEXT, "")
        most = f'MATCH("{ENDLESS}",{limits.used},0)'
        by_share = f"MATCH(MAX({limits.used}),{limits.used},0)"
        place = f"IFERROR({most},{by_share})"
        share = f'IF(ISERROR({most}),ROUND(100*MAX({limits.used}),1)&" %","{BEYOND}")'
        text = f'IFERROR(INDEX({limits.names},{place})&": "&{share},"{NOTHING}")'
        sheet.formula(row, VALUE, text, limits.governing, "text")
        row += 1
    if limits.remarks:
        sheet.text(row, LABEL, "Remarks", "name")
        sheet.merge(row, VALUE, TEXT, "")
        count, there = f'COUNTIF({limits.remarks},"applies")', " of those on the sheet Limits"
        text = f'IF({count}=0,"none",{count})&"{there}"'
        sheet.formula(row, VALUE, text, f"{limits.applying or 'none'}{there}", "text")
        row += 1
    return row


def _pairs(sheet: Sheet, row: int, title: str, pairs: Mapping[str, str]) -> int:
    """Write names and texts; return the next row."""
    if pairs and title:
        sheet.texts(row, [title, *[""] * TEXT], "section")
        row += 1
    for name, text in pairs.items():
        sheet.text(row, LABEL, name.replace("_", " "), "name")
        sheet.merge(row, VALUE, TEXT, text)
        sheet.text(row, VALUE, text)
        row += 1
    return row


def _objectives(sheet: Sheet, row: int, objectives: Sequence[Objective]) -> int:
    """Write the objectives, now and as solved; return the next row."""
    sheet.heads(row, ("Objective", "value", "unit", "as solved", "change", "meaning"), (VALUE, SOLVED, CHANGE))
    for x in objectives:
        row += 1
        sheet.text(row, LABEL, x.name, "name")
        sheet.formula(row, VALUE, x.formula, x.value, "result")
        sheet.text(row, UNIT, x.unit if x.unit != "-" else "", "unit")
        sheet.number(row, SOLVED, x.value, "solved")
        sheet.formula(row, CHANGE, change(cell(row, VALUE), cell(row, SOLVED)), "", "change", digits=False)
        sheet.text(row, TEXT, x.text)
    return row + 1


def _lines(sheet: Sheet, row: int, title: str, lines: Sequence[str]) -> int:
    """Write texts below each other; return the next row."""
    sheet.texts(row, [title, *[""] * TEXT], "section")
    for line in lines:
        row += 1
        sheet.merge(row, LABEL, TEXT, line)
        sheet.text(row, LABEL, line)
    return row + 1
