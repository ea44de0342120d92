"""The workbook of a front: its designs, what was asked, parts, limits, certificate and sources, as values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from synth.order.feasibility import Status
from synth.results import Design, ParetoFront, cell_value
from synth.results.calculation import Calculation, NamedQuantity
from synth.text.numbers import typed_number
from synth.units import header

from .excel_sheets import BAD, Book, Sheet
from .reasons import SIGN_OF
from .workbook_cells import in_unit

OPTION = "--xlsx"
UTILISATION = "utilisation: "  # heads these columns of the table of a front; they stand on the sheet of limits
STATES = {
    Status.OPTIMAL: "proven within the gap asked for",
    Status.FEASIBLE: "feasible, not proven",
    Status.INFEASIBLE: "NOT FEASIBLE: no design meets all limits",
    Status.NOT_FOUND: "NONE FOUND: no design that meets all limits was found; that there is none is not proven",
    Status.NOT_SOLVED: "NOT SOLVED: the search was stopped before a design was found",
    Status.FAILED: "FAILED",
}
OF_ROWS = ("designation", "table", "hash", "confidence", "source")
LARGEST = 28  # characters; width of a column of texts


def front_workbook(front: ParetoFront, calculation: Calculation | None = None) -> bytes:
    """Return a workbook of all designs of a front, for sorting, filtering and diagrams of one's own.

    Parameters
    ----------
    front : ParetoFront
    calculation : Calculation, optional
        Of the front; without it meanings, sources and the units of what parts say are not known.

    Returns
    -------
    bytes
        The file; the same front gives the same bytes.

    Raises
    ------
    InputError
        The extra ``excel`` is not there.
    """
    book = Book(OPTION, front.frame.title)
    quantities = {} if calculation is None else dict(calculation.quantities)
    _designs(book, front)
    _requirements(book, front, quantities)
    _parts(book, front, quantities)
    _limits(book, front)
    _certificate(book, front)
    _sources(book, front, calculation)
    return book.bytes()


def _table(sheet: Sheet, row: int, heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> int:
    """Write a table of numbers and texts; return the row below it. Where there is no value, nothing stands."""
    numeric = [k for k in range(len(heads)) if any(_is_number(line[k]) for line in rows)]
    sheet.heads(row, heads, numeric)
    for below, line in enumerate(rows, start=row + 1):
        for column, value in enumerate(line):
            if _is_number(value):
                sheet.number(below, column, float(value))
            elif value is not None and value != "":
                sheet.text(below, column, str(value))
    return row + 1 + len(rows)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _widths(heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> list[float]:
    """Return widths of columns: heads are broken between words only, long texts take several lines."""
    widths = []
    for k, head in enumerate(heads):
        longest = max((len(word) for word in head.split()), default=0)
        texts = max((len(str(line[k])) for line in rows if isinstance(line[k], str)), default=0)
        widths.append(max(9, 1.2 * longest + 2, min(1.1 * texts + 2, LARGEST)))
    return widths


def _state(front: ParetoFront) -> str:
    state = STATES[front.status]
    if front.designs and front.status in (Status.OPTIMAL, Status.FEASIBLE):
        state = f"{len(front.designs)} designs, {state}" if len(front.designs) > 1 else f"1 design, {state}"
    return f"{state}; INTERRUPTED: {front.interrupted}" if front.interrupted else state


def _designs(book: Book, front: ParetoFront) -> None:
    columns, rows = front.table()
    kept = [k for k, head in enumerate(columns) if not head.startswith(UTILISATION)]
    heads, lines = [columns[k] for k in kept], [[row[k] for k in kept] for row in rows]
    sheet = book.sheet("designs", _widths(heads, lines), locked=False, over_pages=True)
    sheet.text(0, 0, front.frame.title, "title_line")
    sheet.text(1, 0, _state(front), "state_line")
    sheet.worksheet.set_row(0, 24)
    last = _table(sheet, 3, heads, lines)
    sheet.worksheet.freeze_panes(4, 1)
    sheet.worksheet.repeat_rows(3)
    if lines:
        sheet.worksheet.autofilter(3, 0, last - 1, len(heads) - 1)
    elif front.explanation is not None:
        explanation = front.explanation
        sheet.text(5, 0, explanation.headline, "line")
        for row, conflict in enumerate(explanation.conflicts or (), start=6):
            sheet.text(row, 0, str(conflict.get("sentence", "")), "line")


def _requirements(book: Book, front: ParetoFront, quantities: Mapping[str, NamedQuantity]) -> None:
    frame = front.frame
    sheet = book.sheet("requirements", (34, 18, 14, 16, 22, 56, 44), locked=False)
    rows: list[list[Any]] = []
    for name, value in frame.requirement_values.items():
        if name in frame.not_asked:
            continue
        q = quantities.get(name)
        unit = q.unit if q is not None else frame.units.get(name, "")
        typed = "typed" if name in frame.requirements else "default"
        words = (q.group, q.text, q.source) if q is not None else ("", "", "")
        shown = cell_value(value, unit or "-")
        rows.append([name, shown, unit or ("" if frame.requirements.get(name) is None else "SI"), typed, *words])
    below = _table(sheet, 0, ("requirement", "value", "unit", "stated", "group", "meaning", "source"), rows)
    sheet.worksheet.freeze_panes(1, 1)
    below = _pairs(sheet, below + 1, "not asked for", [(name, "") for name in frame.not_asked])
    below = _pairs(sheet, below, "option", frame.options.items())
    below = _pairs(sheet, below, "objective", frame.objectives.items())
    restricted = [(k, _words(v)) for k, v in front.settings.items() if k in ("parts", "limits", "fix", "robust") and v]
    _pairs(sheet, below, "restriction", restricted)


def _pairs(sheet: Sheet, row: int, title: str, pairs: Iterable[tuple[str, Any]]) -> int:
    """Write names and texts under a title; return the row after a gap, or the same one where there are none."""
    listed = list(pairs)
    if not listed:
        return row
    sheet.texts(row, [title, *[""] * (len(sheet.widths) - 1)], "section")
    for name, text in listed:
        row += 1
        sheet.text(row, 0, name.replace("_", " "), "name")
        sheet.text(row, 1, str(text), "plain")
    return row + 2


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return "; ".join(f"{k}: {_words(v)}" for k, v in value.items())
    if isinstance(value, (list, tuple)):
        return ", ".join(map(_words, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return typed_number(value) if isinstance(value, float) else str(value)


def _parts(book: Book, front: ParetoFront, quantities: Mapping[str, NamedQuantity]) -> None:
    """Write the rows that fill slots, each once, with the designs that it is part of."""
    sheet = book.sheet("parts", (30, 26, 14, 48, 20, *[16] * 24), locked=False)
    row = 0
    for slot in dict.fromkeys(slot for design in front.designs for slot in design.parts):
        filled: dict[str, list[Design]] = {}
        for design in front.designs:
            filled.setdefault(str(design.parts[slot]), []).append(design)
        rows = {name: designs[0].parts[slot] for name, designs in filled.items()}
        units = _units_of(slot, rows.values(), quantities)
        heads = ["designation", "designs", "confidence", "source", "table", *(header(k, u) for k, u in units.items())]
        lines = []
        for name, part in rows.items():
            line: list[Any] = [name, ", ".join(f"#{d.rank}" for d in filled[name])]
            line += [str(part.get(key) or "") for key in ("confidence", "source", "table")]
            lines.append([*line, *(_cell_value(part.get(key), unit) for key, unit in units.items())])
        sheet.texts(row, [slot, *[""] * (len(heads) - 1)], "section")
        row = _table(sheet, row + 1, heads, lines) + 1


def _units_of(slot: str, rows: Iterable[Any], quantities: Mapping[str, NamedQuantity]) -> dict[str, str]:
    """Return the columns that rows of a slot have, with their units; SI where these are not known."""
    known = {q.column: q.unit or "-" for q in quantities.values() if q.kind == "part" and q.slot == slot}
    columns = dict.fromkeys(key for row in rows for key in row if key not in OF_ROWS)
    used = {key: known[key] for key in columns if key in known}
    return used or {key: "SI" for key in columns}


def _cell_value(value: Any, unit: str) -> Any:
    if not _is_number(value):
        return value
    return float(value) if unit == "SI" else in_unit(float(value), unit)


def _limits(book: Book, front: ParetoFront) -> None:
    """Write how much of each limit each design uses, in colours by its size; both sides of it beside."""
    frame = front.frame
    names = list(frame.limit_units)
    sides = [header(f"{name} {SIGN_OF[frame.limit_senses[name]]}", frame.limit_units[name]) for name in names]
    heads = ["rank", *names, "", *(f"{word}: {side}" for side in sides for word in ("found", "allowed"))]
    rows = [_used(front, design, names) for design in front.designs]
    sheet = book.sheet("limits", _widths(heads, rows), locked=False, over_pages=True)
    sheet.text(0, 0, "share of each limit that is used; to the right both sides in their unit", "line")
    sheet.heads(2, heads, range(len(heads)))
    for row, line in enumerate(rows, start=3):
        for column, value in enumerate(line):
            if _is_number(value):
                inner = 0 < column <= len(names)
                sheet.number(row, column, float(value), "percent" if inner else "number", digits=not inner)
            elif value is not None:
                sheet.text(row, column, str(value), "result_text")
    sheet.worksheet.freeze_panes(3, 1)
    sheet.worksheet.repeat_rows(2)
    if rows and names:
        _coloured(sheet, [k for k, n in enumerate(names, 1) if frame.limit_senses[n] != "equal"], 3, 2 + len(rows))


def _used(front: ParetoFront, design: Design, names: Sequence[str]) -> list[Any]:
    units, line = front.frame.limit_units, list[Any]([design.rank])
    for name in names:
        used = design.utilisation.get(name)
        line.append("–" if used is None else "∞" if used == float("inf") else used)
    line.append(None)
    for name in names:
        line += [cell_value(x, units[name] or "-") for x in design.limits.get(name, (float("nan"), float("nan")))]
    return line


def _coloured(sheet: Sheet, columns: Sequence[int], first: int, last: int) -> None:
    """Colour shares; what is above the whole is violated."""
    form = sheet.book.added(bg_color=BAD, font_color="#FFFFFF", bold=True)
    for column in columns:
        above = {"type": "cell", "criteria": ">", "value": 1 + 2e-6, "format": form, "stop_if_true": True}
        sheet.worksheet.conditional_format(first, column, last, column, above)
        endless = {"type": "cell", "criteria": "==", "value": '"∞"', "format": form}
        sheet.worksheet.conditional_format(first, column, last, column, endless)
        sheet.scale(column, first, last)


def _certificate(book: Book, front: ParetoFront) -> None:
    sheet = book.sheet("certificate", (30, 110), locked=False)
    certificate = front.certificate
    sheet.text(0, 0, "state", "name")
    sheet.text(0, 1, _state(front))
    sheet.text(1, 0, "certificate", "name")
    sheet.text(1, 1, certificate.sentence())
    sheet.text(2, 0, "what it does not cover", "name")
    sheet.text(2, 1, "It speaks of this model: its formulas, tables and requirements, not of what they leave out.")
    row = _pairs(sheet, 4, "proof", [(k, _words(v)) for k, v in vars(certificate).items() if k not in ("units",) and v])
    row = _pairs(sheet, row, "asked of the search", [(k, _words(v)) for k, v in front.settings.items() if v != ""])
    row = _pairs(sheet, row, "what it did", [(k, _words(v)) for k, v in front.statistics.items() if v not in ([], {})])
    record = front.record or {}
    versions = record.get("versions") or {}
    facts = [
        *((f"version of {name}", text) for name, text in versions.items()),
        ("checksum of the result", front.result_digest),
    ]
    _pairs(sheet, row, "record", [(name, text) for name, text in facts if text])


def _sources(book: Book, front: ParetoFront, calculation: Calculation | None) -> None:
    sheet = book.sheet("sources", (36, 14, 14, 70, 60), locked=False)
    if calculation is None:
        sheet.text(0, 0, "They are told by the calculation of the front, which is not known here.", "line")
        return
    row = _pairs(sheet, 0, "sources of the family", [(str(k), text) for k, text in enumerate(calculation.sources, 1)])
    kinds = {"helper": "part of a formula"}
    rows = [[q.name, kinds.get(q.kind, q.kind), q.unit, q.text, q.source] for q in calculation.quantities.values()]
    rows += [[x.name, "limit", x.unit, x.text, x.source] for x in calculation.limits]
    last = _table(sheet, row, ("name", "kind", "unit", "meaning", "source"), rows)
    sheet.worksheet.autofilter(row, 0, last - 1, 4)
