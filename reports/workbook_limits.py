"""The sheet of limits of a live workbook: both sides, what is used, the verdict; and the remarks."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from synth.order.feasibility import TOLERANCE, holds, most_used, residual
from synth.results.calculation import CalculatedDesign, Calculation, LimitRule, LimitVerdict
from synth.text.numbers import used_share

from .excel_formula import from_si_text, number_text
from .excel_sheets import BAD, GOOD, GREY, MARKED, Sheet, cell
from .reasons import SIGN_OF
from .workbook_cells import Formulas, in_unit

LIMIT, COMPUTED, SIGN, ALLOWED, UNIT, USED, VERDICT, SOLVED, TEXT, SOURCE = range(10)
COMPUTED_SI, ALLOWED_SI, MISSED, VOID, JUDGED, HELD, BEHIND, COUNTS = range(10, 18)
HEADS = ("limit", "found", "", "allowed", "unit", "used", "verdict", "as solved", "meaning", "source")
INNER_HEADS = ("found, SI", "allowed, SI", "missed by", "void", "holds", "counts as held", "behind", "may govern")
WIDTHS = (32, 14, 4, 14, 11, 10, 26, 10, 48, 36, 14, 14, 14, 9, 9, 9, 24, 12)
HOLDS, VIOLATED, UNCHECKED, UNDECIDED = "holds", "VIOLATED", "not checked: not given", "not told: behind "
ENDLESS, NOTHING = "∞", "–"
BEYOND = "beyond what can be told as a share"


@dataclass(frozen=True)
class LimitCells:
    """Where the sheet of limits tells what the summary repeats, and what stands there for the design.

    Parameters
    ----------
    names, used, verdicts, remarks : str
        Cells; ``remarks`` is empty where there are none.
    count, violated, applying : int
        Limits, those that are violated, and remarks that apply.
    governing : str
        The limit that is used most, and how much.
    """

    names: str
    used: str
    verdicts: str
    remarks: str
    count: int
    violated: int
    applying: int
    governing: str


def write_limits(sheet: Sheet, calculation: Calculation, outcome: CalculatedDesign, formulas: Formulas) -> LimitCells:
    """Write the limits and remarks of a calculation.

    Parameters
    ----------
    sheet : Sheet
    calculation : Calculation
    outcome : CalculatedDesign
        What the design comes to.
    formulas : Formulas

    Returns
    -------
    LimitCells
    """
    right = (COMPUTED, ALLOWED, USED, SOLVED, COMPUTED_SI, ALLOWED_SI, MISSED)
    sheet.heads(0, [*HEADS, *INNER_HEADS], right, (SIGN, VERDICT))
    sheet.worksheet.freeze_panes(1, 1)
    sheet.worksheet.repeat_rows(0)
    rows = {x.name: row for row, x in enumerate(calculation.limits, start=1)}
    judged = {x.name: bool(holds(_missed(x, outcome.verdicts[x.name]), x.guard)) for x in calculation.limits}
    for x in calculation.limits:
        row = rows[x.name]
        _sides(sheet, row, x, outcome.verdicts[x.name], formulas)
        _judged(sheet, row, x, outcome.verdicts[x.name], judged[x.name], rows, formulas)
        if x.guard:
            sheet.book.define(formulas.holds[x.name], sheet.place(row, JUDGED))
    last = len(rows)
    _coloured(sheet, calculation.limits, last)
    applying = [_applies(formulas.value(x.condition)) for x in calculation.remarks]
    remarks = _remarks(sheet, last + 2, calculation, formulas, applying)
    sheet.worksheet.print_area(0, 0, last + 2 + len(calculation.remarks), SOURCE)
    sheet.worksheet.set_column(COMPUTED_SI, COUNTS, 13, None, {"level": 1})
    names, counts, verdicts = (sheet.area(1, column, max(last, 1)) for column in (LIMIT, COUNTS, VERDICT))
    violated = sum(not verdict.holds for verdict in outcome.verdicts.values())
    return LimitCells(names, counts, verdicts, remarks, last, violated, sum(applying), _governing(calculation, outcome))


def _governing(calculation: Calculation, outcome: CalculatedDesign) -> str:
    """First limit of those that are used most, as the summary shows it."""
    used = {x.name: (outcome.verdicts[x.name].used, x.sense) for x in calculation.limits}
    shares = {k: v for k, (v, sense) in used.items() if v is not None and (sense != "equal" or math.isinf(v))}
    if not shares:
        return NOTHING
    name = most_used(shares)[0]
    return f"{name}: {BEYOND if math.isinf(shares[name]) else used_share(shares[name])}"


def _applies(value: float) -> bool:
    return value != 0 and not math.isnan(value)


def _missed(x: LimitRule, verdict: LimitVerdict) -> float:
    return float(residual(verdict.value, verdict.limit, x.sense, x.scale))


def _sides(sheet: Sheet, row: int, x: LimitRule, verdict: LimitVerdict, formulas: Formulas) -> None:
    """Write both sides: in SI as they are compared, and in the unit of the limit as they are read."""
    untold = verdict.void or bool(verdict.failed)
    texts = formulas.sides(x)
    for text, value, inner, outer in zip(
        texts, (verdict.value, verdict.limit), (COMPUTED_SI, ALLOWED_SI), (COMPUTED, ALLOWED), strict=True
    ):
        sheet.formula(row, inner, text, value, "si")
        here = cell(row, inner)
        shown = f'IF({cell(row, BEHIND)}<>"","{NOTHING}",{from_si_text(here, x.unit)})'
        number = in_unit(value, x.unit)
        gone = bool(verdict.failed) or math.isnan(number)
        sheet.formula(row, outer, f'IFERROR({shown},"{NOTHING}")', NOTHING if gone else number)
    sheet.text(row, LIMIT, x.name, "name")
    sheet.text(row, SIGN, SIGN_OF[x.sense], "verdict")
    sheet.text(row, UNIT, x.unit if x.unit != "-" else "", "unit")
    note = " (guard: formulas exist only where it holds)" if x.guard else ""
    sheet.text(row, TEXT, x.text + note)
    sheet.text(row, SOURCE, x.source, "small")
    if verdict.used is None or untold:
        sheet.text(row, SOLVED, NOTHING, "verdict")
    elif math.isinf(verdict.used):
        sheet.text(row, SOLVED, ENDLESS, "verdict")
    else:
        sheet.number(row, SOLVED, verdict.used, "percent", digits=False)


def _judged(
    sheet: Sheet,
    row: int,
    x: LimitRule,
    verdict: LimitVerdict,
    judged: bool,
    rows: Mapping[str, int],
    formulas: Formulas,
) -> None:
    """Write what is missed, and what follows from it, as the engine judges."""
    computed, allowed = cell(row, COMPUTED_SI), cell(row, ALLOWED_SI)
    missed, void, judged_cell, behind, used = (cell(row, k) for k in (MISSED, VOID, JUDGED, BEHIND, USED))
    size = f"MAX(ABS({computed}),ABS({allowed}),{number_text(x.scale)})"
    difference = {
        "at_most": f"({computed}-{allowed})",
        "at_least": f"({allowed}-{computed})",
        "equal": f"ABS({computed}-{allowed})",
    }[x.sense]
    sheet.formula(row, MISSED, f"{difference}/{size}", _missed(x, verdict), "si")
    names = [formulas.names[name] for name in x.optional]
    unknown = [f"ISERROR({name})" for name in names]
    sheet.formula(row, VOID, _any(unknown), verdict.void, "si")
    enough = f"{missed}<0" if x.guard else f"{missed}<={number_text(TOLERANCE)}"
    sheet.formula(row, JUDGED, f"IFERROR({enough},FALSE)", judged, "si")
    sheet.formula(row, HELD, f'OR({judged_cell},{void},{behind}<>"")', verdict.holds, "si")
    # The first guard that fails is named. One that stands before counts as held where others tell why it fails.
    text = '""'
    for guard in reversed(x.needs):
        column = HELD if rows[guard] < row else JUDGED
        text = f"IF({cell(rows[guard], column, fixed=True)},{text},{cell(rows[guard], LIMIT, fixed=True)})"
    sheet.formula(row, BEHIND, text, verdict.failed[0] if verdict.failed else "", "si")
    share = _share(x.sense, computed, allowed)
    nothing = f'OR({void},{behind}<>"",ISERROR({missed}))'
    shown = NOTHING if verdict.used is None else ENDLESS if math.isinf(verdict.used) else verdict.used
    sheet.formula(row, USED, f'IF({nothing},"{NOTHING}",{share})', shown, "percent", digits=False)
    # An equation that holds is always used in full, which says nothing.
    equation = x.sense == "equal"
    counted_share = f'IF({used}="{ENDLESS}",{used},"{NOTHING}")' if equation else used
    counts = NOTHING if equation and shown != ENDLESS else shown
    sheet.formula(row, COUNTS, counted_share, counts, "si", digits=False)
    words = f'IF({void},"{UNCHECKED}",IF({behind}<>"","{UNDECIDED}"&{behind},IF({judged_cell},"{HOLDS}","{VIOLATED}")))'
    verdict_text = UNDECIDED + verdict.failed[0] if verdict.failed else HOLDS if verdict.holds else VIOLATED
    sheet.formula(row, VERDICT, words, UNCHECKED if verdict.void else verdict_text, "verdict")


def _any(conditions: Sequence[str]) -> str:
    return "FALSE" if not conditions else conditions[0] if len(conditions) == 1 else f"OR({','.join(conditions)})"


def _share(sense: str, computed: str, allowed: str) -> str:
    """Return the share of a limit that is used, as :func:`synth.order.feasibility.utilisation` has it."""
    if sense == "equal":
        least, most = f"MIN(ABS({computed}),ABS({allowed}))", f"MAX(ABS({computed}),ABS({allowed}))"
        same = f"AND(SIGN({computed})=SIGN({allowed}),{least}>0)"
        return f'IF({computed}={allowed},1,IF({same},{most}/{least},"{ENDLESS}"))'
    over, under = (allowed, computed) if sense == "at_least" else (computed, allowed)
    return f'IF(AND({over}>0,{under}>0),{over}/{under},IF({over}<={under},0,"{ENDLESS}"))'


def _coloured(sheet: Sheet, limits: Sequence[LimitRule], last: int) -> None:
    """Colour shares by their size, those of equations apart, and verdicts."""
    worksheet, book = sheet.worksheet, sheet.book
    scaled = [cell(row, USED) for row, x in enumerate(limits, start=1) if x.sense != "equal"]
    if scaled:
        first = next(row for row, x in enumerate(limits, start=1) if x.sense != "equal")
        sheet.scale(USED, first, first, " ".join(scaled))
    if last:
        for word, form in (
            (VIOLATED, {"bg_color": BAD, "font_color": "#FFFFFF", "bold": True}),
            (HOLDS, {"font_color": GOOD}),
            ("not ", {"font_color": GREY, "italic": True}),
        ):
            rule = {"type": "text", "criteria": "begins with", "value": word, "format": book.added(**form)}
            worksheet.conditional_format(1, VERDICT, last, VERDICT, rule)


def _remarks(sheet: Sheet, row: int, calculation: Calculation, formulas: Formulas, applying: Sequence[bool]) -> str:
    """Write the remarks; return the cells that tell which of them apply."""
    if not calculation.remarks:
        return ""
    sheet.texts(row, ["Remarks", *[""] * SOURCE], "section")
    for number, x in enumerate(calculation.remarks, start=1):
        here = row + number
        sheet.text(here, LIMIT, x.code, "name")
        text = formulas.text(["if", x.condition, ["n", 1.0], ["n", 0.0]])
        shown = f'IF(IFERROR({text},0)=1,"applies","{NOTHING}")'
        sheet.formula(here, VERDICT, shown, "applies" if applying[number - 1] else NOTHING, "verdict")
        sheet.text(here, TEXT, x.message)
        sheet.text(here, SOURCE, x.source, "small")
    form = sheet.book.added(bg_color=MARKED, bold=True)
    last = row + len(calculation.remarks)
    rule = {"type": "cell", "criteria": "==", "value": '"applies"', "format": form}
    sheet.worksheet.conditional_format(row + 1, VERDICT, last, VERDICT, rule)
    return sheet.area(row + 1, VERDICT, last)
