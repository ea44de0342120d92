"""The live workbook of one design: every quantity as a formula of named cells, every limit with its verdict.

What is changed in an input cell is computed at once, by the spreadsheet alone. It recomputes one design; it does not
search.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from synth.results import Design, PartRow
from synth.results.calculation import Calculation, NamedQuantity
from synth.results.report_request import About
from synth.text.numbers import typed_number
from synth.units import header

from .excel_formula import from_si_text, number_text, to_si_text
from .excel_sheets import Book, Sheet, cell
from .workbook_cells import SAME, Cells, Formulas, RowsOffered, change, in_unit, legal_names
from .workbook_limits import WIDTHS as LIMIT_WIDTHS
from .workbook_limits import write_limits
from .workbook_summary import WIDTHS as SUMMARY_WIDTHS
from .workbook_summary import Objective, write_summary

OPTION = "--xlsx"
NAME, SYMBOL, VALUE, UNIT, SI, SOLVED, CHANGE, TEXT, SOURCE, FORMULA = range(10)
HEADS = ("quantity", "symbol", "value", "unit", "in SI", "as solved", "change", "meaning", "source", "formula, in SI")
NUMBERS = (VALUE, SI, SOLVED, CHANGE)
WIDTHS = (30, 11, 15, 12, 15, 15, 10, 48, 34, 90)
GROUPS = {"variable": "Sizes", "count": "Counts", "choice": "Choices"}
FIXED = {"row": "Fixed by rows of tables", "constant": "Constants"}
FOLLOWS = "follows from others until a number is typed"


def live_workbook(
    calculation: Calculation,
    design: Design,
    rows: Mapping[str, Sequence[PartRow]],
    about: About | Mapping[str, str] | None = None,
    certificate: str = "",
) -> bytes:
    """Return a workbook in which one design can be changed and is computed again.

    Parameters
    ----------
    calculation : Calculation
        Of the question that the design answers.
    design : Design
        Also one that is not feasible.
    rows : mapping
        Slot -> rows that it offers, as :class:`synth.results.PartRow` has them. A slot that is not told offers the
        design's own row.
    about : About or mapping, optional
        What is said about it: project, customer, number, ...
    certificate : str
        What is proven of the design, in words; by default what its status says.

    Returns
    -------
    bytes
        The file; the same input gives the same bytes.

    Raises
    ------
    InputError
        The design is of another question or of other formulas, or the extra ``excel`` is not there.
    """
    return _Live(calculation, design, rows, dict(About.of(about).facts()), certificate).bytes()


class _Live:
    """What is known while the sheets are written, and where it stands."""

    def __init__(
        self,
        calculation: Calculation,
        design: Design,
        rows: Mapping[str, Sequence[PartRow]],
        about: Mapping[str, str],
        certificate: str,
    ) -> None:
        self.calculation, self.design, self.about, self.certificate = calculation, design, about, certificate
        self.outcome = calculation.of_design(design)
        self.quantities = list(calculation.quantities.values())
        book = Book(OPTION, calculation.title)
        self.book = book
        self.summary = book.sheet("Summary", SUMMARY_WIDTHS)
        self.sheet = book.sheet("Calculation", WIDTHS)
        self.limits = book.sheet("Limits", LIMIT_WIDTHS)
        self.parts = book.sheet("Parts", (30, 11, 28, 12, 15, 28, 10, 48, 34))
        self.catalogue = book.sheet("Catalogue", (34, 14, 44, *[18] * 24))
        helpers = book.sheet("Helpers", (18, 80))
        helpers.worksheet.hide()
        self.cells = Cells(helpers)
        self.offered = {slot: RowsOffered(row, rows.get(slot, ())) for slot, row in design.parts.items()}
        names, holds = legal_names(calculation)
        self.names = names
        inputs = calculation.inputs(design)
        self.formulas = Formulas(calculation, inputs, self.outcome.values, names, holds, self.cells, self.offered)

    def bytes(self) -> bytes:
        """Write all sheets and return the file."""
        catalogue = self._catalogue()
        self._parts(catalogue)
        self._calculation()
        limits = write_limits(self.limits, self.calculation, self.outcome, self.formulas)
        words = self.certificate or f"as recorded: {self.design.status.value.replace('_', ' ')}"
        sheets = (self.sheet, self.parts)
        write_summary(
            self.summary,
            self.calculation,
            self.design,
            self.about,
            (words, self.cells.text(words, "certificate")),
            [self._objective(name) for name in self.design.frame.objectives],
            limits,
            "+".join(f'COUNTIF({s.area(1, CHANGE, s.last)},"changed")' for s in sheets),
        )
        return self.book.bytes()

    def _objective(self, name: str) -> Objective:
        q = self.calculation.quantities[name]
        value = in_unit(self.outcome.values[name], q.unit)
        return Objective(name, from_si_text(self.names[name], q.unit), value, q.unit, q.text)

    # -- what is computed ----------------------------------------------------------------------

    def _calculation(self) -> None:
        sheet, row = self.sheet, 0
        sheet.heads(row, HEADS, NUMBERS)
        sheet.worksheet.freeze_panes(1, 1)
        sheet.worksheet.repeat_rows(0)
        for title, members in self._sections():
            row += 1
            sheet.texts(row, [title, *[""] * FORMULA], "section")
            for q in members:
                row += 1
                self._quantity(row, q)
        sheet.worksheet.print_area(0, 0, row, SOURCE)

    def _sections(self) -> list[tuple[str, list[NamedQuantity]]]:
        """Return the quantities under the titles that they stand under; those of parts have a sheet of their own."""
        sections: dict[str, list[NamedQuantity]] = {}
        for q in self.quantities:
            if q.kind == "requirement":
                sections.setdefault(f"Requirements: {q.group}" if q.group else "Requirements", []).append(q)
        for kind, title in {**GROUPS, **FIXED}.items():
            sections[title] = [q for q in self.quantities if q.kind == kind]
        sections["Computed"] = [q for q in self.quantities if q.computed]
        return [(title, members) for title, members in sections.items() if members]

    def _quantity(self, row: int, q: NamedQuantity) -> None:
        sheet = self.sheet
        self._words(sheet, row, q)
        if q.computed:
            self._computed(row, q)
        elif q.kind == "choice":
            self._choice(row, q)
        elif q.kind in FIXED:
            value = self.outcome.values[q.name]
            if math.isnan(value):
                sheet.formula(row, VALUE, "NA()", math.nan)
            else:
                sheet.number(row, VALUE, in_unit(value, q.unit))
            sheet.formula(row, SI, to_si_text(cell(row, VALUE), q.unit), value, "si")
        else:
            self._input(row, q)
        self.book.define(self.names[q.name], sheet.place(row, SI))

    def _words(self, sheet: Sheet, row: int, q: NamedQuantity, name: str = "") -> None:
        typed = q.kind != "requirement" or q.name in self.design.frame.requirements
        sheet.text(row, NAME, name or q.name, "name")
        sheet.text(row, SYMBOL, q.symbol, "plain")
        sheet.text(row, UNIT, q.unit if q.unit != "-" else "", "unit")
        note = "" if typed else f" ({FOLLOWS})" if self._follows(q) else " (default)"
        sheet.text(row, TEXT, "part of a formula" if q.kind == "helper" else q.text + note)
        sheet.text(row, SOURCE, q.source, "small")

    def _follows(self, q: NamedQuantity) -> bool:
        """True if an input is a formula of others until something is typed in its place."""
        if q.kind != "requirement" or q.expression is None or q.name in self.design.frame.requirements:
            return False
        computed, recorded = self.formulas.value(q.expression), self.outcome.values[q.name]
        return abs(computed - recorded) <= 1e-9 * max(abs(computed), abs(recorded))

    def _input(self, row: int, q: NamedQuantity) -> None:
        sheet, value = self.sheet, self.outcome.values[q.name]
        shown = in_unit(value, q.unit)
        if self._follows(q):
            assert q.expression is not None
            text = self.formulas.text(q.expression)
            sheet.formula(row, VALUE, from_si_text(f"({text})", q.unit), shown, "follows")
            sheet.text(row, FORMULA, text, "code")
        else:
            sheet.number(row, VALUE, shown, "input")
        sheet.formula(row, SI, to_si_text(cell(row, VALUE), q.unit), value, "si")
        sheet.number(row, SOLVED, shown, "solved")
        sheet.formula(row, CHANGE, _changed(row), "", "verdict")
        self._validate(row, q)

    def _validate(self, row: int, q: NamedQuantity) -> None:
        """Let only numbers within bounds be typed; a size beyond its range is computed as well, after a question."""
        least, most = (x if math.isinf(x) else in_unit(x, q.unit) for x in q.bounds or (-math.inf, math.inf))
        unit = "" if q.unit in ("", "-") else f" {q.unit}"
        rule: dict[str, Any] = {"validate": "decimal", "criteria": ">=", "value": -1e300}
        allowed = "a number"
        if math.isfinite(least) and math.isfinite(most):
            rule = {"validate": "decimal", "criteria": "between", "minimum": least, "maximum": most}
            allowed = f"{_short(least)} to {_short(most)}{unit}"
        elif math.isfinite(least):
            rule["value"], allowed = least, f"at least {_short(least)}{unit}"
        elif math.isfinite(most):
            rule |= {"criteria": "<=", "value": most}
            allowed = f"at most {_short(most)}{unit}"
        if q.kind == "count" and q.step is not None:
            rule = _steps(cell(row, VALUE), least, most, q.step)
            allowed += f" in steps of {_short(q.step)}"
        rule |= {
            "error_type": "warning" if q.kind == "variable" else "stop",
            "error_title": "outside of what is searched" if q.kind == "variable" else "not possible",
            "error_message": f"{q.name}: {allowed}"[:255],
            "input_title": q.name[:32],
            "input_message": allowed[:255],
        }
        self.sheet.worksheet.data_validation(row, VALUE, row, VALUE, rule)

    def _choice(self, row: int, q: NamedQuantity) -> None:
        sheet, number = self.sheet, self.outcome.values[q.name]
        label = q.labels[int(number)]
        labels = self.cells.texts(q.labels)
        sheet.text(row, VALUE, label, "word")
        sheet.formula(row, SI, f"MATCH({cell(row, VALUE)},{labels},0)-1", number, "si", digits=False)
        sheet.text(row, SOLVED, label, "result_text")
        sheet.formula(row, CHANGE, f'IF(EXACT({cell(row, VALUE)},{cell(row, SOLVED)}),"","changed")', "", "verdict")
        rule = {"validate": "list", "source": f"={labels}", "input_title": q.name[:32], "input_message": "choose one"}
        sheet.worksheet.data_validation(row, VALUE, row, VALUE, rule)

    def _computed(self, row: int, q: NamedQuantity) -> None:
        sheet, value = self.sheet, self.outcome.values[q.name]
        assert q.expression is not None
        text = self.formulas.text(q.expression)
        sheet.formula(row, SI, self.formulas.guarded(text, q.needs), value, "si")
        shown = in_unit(value, q.unit)
        style = "result" if q.kind == "derived" else "number"
        sheet.formula(row, VALUE, from_si_text(cell(row, SI), q.unit), shown, style)
        if math.isfinite(shown):
            sheet.number(row, SOLVED, shown, "solved")
            sheet.formula(row, CHANGE, change(cell(row, VALUE), cell(row, SOLVED)), "", "change", digits=False)
        sheet.text(row, FORMULA, text, "code")

    # -- parts ---------------------------------------------------------------------------------

    def _of_slot(self, slot: str) -> list[NamedQuantity]:
        return [q for q in self.quantities if q.kind == "part" and q.slot == slot]

    def _catalogue(self) -> dict[str, dict[str, str]]:
        """Write the rows that slots offer; return, by slot, the cells of each column."""
        sheet, row, places = self.catalogue, 0, dict[str, dict[str, str]]()
        for slot, offered in self.offered.items():
            table = str(offered.chosen.get("table", ""))
            columns = self._columns(slot, offered)
            sheet.texts(row, [f"{slot}: table {table}" if table else slot, *[""] * (len(columns) - 1)], "section")
            texts = sum(isinstance(cells[0], str) for cells in columns.values())
            sheet.heads(row + 1, list(columns), range(texts, len(columns)))
            for k, (title, cells) in enumerate(columns.items()):
                for number, content in enumerate(cells):
                    if isinstance(content, str):
                        style = "name" if number == offered.place and not k else "text"
                        sheet.text(row + 2 + number, k, content, "line" if title == "source" else style)
                    else:
                        sheet.number(row + 2 + number, k, content)
            last = row + 1 + len(offered.keys)
            places[slot] = {title: sheet.area(row + 2, k, last) for k, title in enumerate(columns)}
            row = last + 2
        return places

    def _columns(self, slot: str, offered: RowsOffered) -> dict[str, list[Any]]:
        columns: dict[str, list[Any]] = {"designation": list(offered.keys)}
        for title in ("confidence", "source"):
            columns[title] = [str(r.get(title) or "") for r in offered.rows]
        for q in self._of_slot(slot):
            if q.is_text:
                columns[q.column] = [str(r.get(q.column) or "") for r in offered.rows]
        for q in self._of_slot(slot):
            columns[_title(q)] = [in_unit(x, q.unit) for x in offered.values(q)]
        return columns

    def _parts(self, catalogue: Mapping[str, Mapping[str, str]]) -> None:
        sheet, row = self.parts, 0
        sheet.heads(0, HEADS[:FORMULA], NUMBERS)
        sheet.worksheet.freeze_panes(1, 1)
        sheet.worksheet.repeat_rows(0)
        for slot, offered in self.offered.items():
            row += 1
            sheet.texts(row, [slot, *[""] * SOURCE], "section")
            row += 1
            chosen = self._designation(row, slot, offered, catalogue[slot])
            for title in ("confidence", "source"):
                row += 1
                sheet.text(row, NAME, title, "name")
                text = f'INDEX({catalogue[slot][title]},{chosen})&""'
                sheet.formula(row, TEXT, text, str(offered.chosen.get(title) or ""), "text")
            for q in self._of_slot(slot):
                row += 1
                self._column(row, q, catalogue[slot], chosen)

    def _designation(self, row: int, slot: str, offered: RowsOffered, columns: Mapping[str, str]) -> str:
        """Write the designation that can be chosen; return the cell that tells its place in the list."""
        sheet, here = self.parts, cell(row, VALUE)
        keys = columns["designation"]
        sheet.text(row, NAME, "designation", "name")
        sheet.text(row, VALUE, offered.keys[offered.place], "word")
        sheet.text(row, SOLVED, offered.keys[offered.place], "result_text")
        sheet.formula(row, CHANGE, f'IF(EXACT({here},{cell(row, SOLVED)}),"","changed")', "", "verdict")
        count = len(offered.keys)
        sheet.text(row, TEXT, "the only row that is known here" if count == 1 else f"choose one of {count} rows")
        rule = {"validate": "list", "source": f"={keys}", "input_title": slot[:32], "input_message": "choose a row"}
        sheet.worksheet.data_validation(row, VALUE, row, VALUE, rule)
        sought = f"MATCH({offered.sought(sheet.place(row, VALUE))},{keys},0)"
        return self.cells.number(sought, float(offered.place + 1), f"{slot}: place of the chosen row")

    def _column(self, row: int, q: NamedQuantity, columns: Mapping[str, str], chosen: str) -> None:
        """Write what the chosen row says in a column."""
        sheet, value = self.parts, self.outcome.values[q.name]
        self._words(sheet, row, q, q.column)
        formula = f"INDEX({columns[_title(q)]},{chosen})"
        if q.is_text:
            chosen_text = str(self.design.parts[q.slot].get(q.column) or "")
            sheet.formula(row, VALUE, f'INDEX({columns[q.column]},{chosen})&""', chosen_text, "result_text")
            sheet.formula(row, SI, formula, value, "si", digits=False)
            sheet.text(row, SOLVED, chosen_text, "result_text")
        else:
            shown = in_unit(value, q.unit)
            gaps = any(math.isnan(x) for x in self.offered[q.slot].values(q))
            sheet.formula(row, VALUE, f'IF({formula}="",NA(),{formula})' if gaps else formula, shown)
            sheet.formula(row, SI, to_si_text(cell(row, VALUE), q.unit), value, "si")
            sheet.number(row, SOLVED, shown, "solved")
        self.book.define(self.names[q.name], sheet.place(row, SI))


def _changed(row: int) -> str:
    """Return the formula that tells whether an input is not as it was solved."""
    value, solved = cell(row, VALUE), cell(row, SOLVED)
    return f'IF(ABS({value}-{solved})<={SAME}*ABS({solved}),"","changed")'


def _steps(here: str, least: float, most: float, step: float) -> dict[str, Any]:
    """Return the rule for a number that is a whole count of steps from the least."""
    if step == 1 and least.is_integer():
        return {"validate": "integer", "criteria": "between", "minimum": int(least), "maximum": int(most)}
    low, high, one = map(number_text, (least, most, step))
    missed = f"ABS({here}-{low}-{one}*ROUND(({here}-{low})/{one},0))"
    return {"validate": "custom", "value": f"=AND({here}>={low},{here}<={high},{missed}<1E-9)"}


def _title(q: NamedQuantity) -> str:
    """Return the heading of a column of numbers in the catalogue."""
    if q.is_text:
        return f"{q.column} (number that stands for it)"
    return header(q.name.removeprefix(f"{q.slot}."), q.unit or "-")


def _short(value: float) -> str:
    return typed_number(value)
