"""What formulas of a live workbook call by name: quantities, guards, parts of formulas, rows that slots offer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from synth.results.calculation import Calculation, LimitRule, NamedQuantity, part_value
from synth.results.expression import Expression, names_in, value_of
from synth.units import from_si

from .excel_formula import may_fail, write
from .excel_names import LegalNames
from .excel_sheets import Sheet, cell_text

LONGEST_KEY = 200  # characters; what is sought in a list has at most 255
SAME = "1E-12"  # relative; a unit that is written out may cost the last digits
WILD = "~*?"  # stand for other letters where something is sought in a list


def in_unit(si: float, unit: str) -> float:
    """Return an SI value in its unit; some quantities have none, and are shown in SI."""
    return float(from_si(si, unit or "-"))


def change(value: str, solved: str) -> str:
    """Return the formula for the relative change of a cell since it was solved; nothing where there is none."""
    same = f"ABS({value}-{solved})<={SAME}*ABS({solved})"
    return f'IFERROR(IF({same},"",{value}/{solved}-1),"")'


class Cells:
    """Cells of the hidden sheet: numbers and texts that have no place elsewhere.

    Parameters
    ----------
    sheet : Sheet
    """

    def __init__(self, sheet: Sheet) -> None:
        self.sheet, self._row, self._known = sheet, 1, dict[str, str]()
        sheet.texts(0, ["value", "what it is"], "head")

    def number(self, formula: str, value: float, what: str = "part of a formula") -> str:
        """Return the cell that holds a formula; the same formula has one cell."""
        if formula not in self._known:
            self.sheet.formula(self._row, 0, formula, value, "si", digits=False)
            self.sheet.text(self._row, 1, what, "small")
            self._known[formula] = self._next()
        return self._known[formula]

    def text(self, text: str, what: str = "text") -> str:
        """Return the cell that holds a text."""
        self.sheet.text(self._row, 0, text, "plain")
        self.sheet.text(self._row, 1, what, "small")
        return self._next()

    def texts(self, texts: Sequence[str]) -> str:
        """Return the cells that hold a list of texts."""
        first = self._row
        for text in texts:
            self.text(text, "may be chosen")
        return self.sheet.area(first, 0, self._row - 1)

    def _next(self) -> str:
        self._row += 1
        return self.sheet.place(self._row - 1, 0)


class RowsOffered:
    """The rows of a slot, each under a key of its own: its designation.

    Parameters
    ----------
    chosen : mapping
        The row of the design.
    rows : list of mapping
        All that are offered; the own one is put in front where it is not among them.
    """

    def __init__(self, chosen: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> None:
        named = [str(row["designation"]) for row in rows]
        missing = str(chosen["designation"]) not in named
        self.chosen = chosen
        self.rows = [chosen, *rows] if missing else list(rows)
        self.place = 0 if missing else named.index(str(chosen["designation"]))
        self.keys = tuple(_distinct_keys(str(row["designation"]) for row in self.rows))

    def values(self, q: NamedQuantity) -> list[float]:
        """Value of a quantity from the rows, in SI; not-a-number where none has one."""
        return [part_value(row, q.columns) for row in self.rows]

    def sought(self, cell: str) -> str:
        """Pattern for the list of keys; letters that would stand for others are escaped."""
        text = cell
        for letter in WILD:
            if any(letter in key for key in self.keys):
                text = f'SUBSTITUTE({text},"{letter}","~{letter}")'
        return text


def _distinct_keys(texts: Iterator[str]) -> Iterator[str]:
    """Yield keys that differ without regard to capital letters, which lists do not see."""
    used = set[str]()
    for text in texts:
        key = short = cell_text(text)[:LONGEST_KEY]
        number = 1
        while key.lower() in used:
            number += 1
            key = f"{short} ({number})"
        used.add(key.lower())
        yield key


def legal_names(calculation: Calculation) -> tuple[dict[str, str], dict[str, str]]:
    """Return the names of cells: those of quantities, and those that tell whether a guard holds."""
    legal = LegalNames()
    names = {q.name: legal.of(_public(q)) for q in calculation.quantities.values()}
    return names, {x.name: legal.of(f"{x.name}.holds") for x in calculation.limits if x.guard}


def _public(q: NamedQuantity) -> str:
    return f"{q.slot}.{q.column}" if q.kind in ("part", "row") else q.name


class Formulas:
    """Texts of formulas, and what they come to for the design.

    Parameters
    ----------
    calculation : Calculation
    inputs : mapping
        Of the design, in SI.
    values : mapping
        Every quantity of the design in SI.
    names, holds : mapping
        As :func:`legal_names` returns them.
    cells : Cells
    offered : mapping
        Slot -> :class:`RowsOffered`.

    Notes
    -----
    Quantities behind a guard that fails do not exist. A guard itself may be told by such quantities, even by those that
    stand behind it: it is judged by what their formulas give, whatever guards say, and so these are computed once more.
    """

    def __init__(
        self,
        calculation: Calculation,
        inputs: Mapping[str, float],
        values: Mapping[str, float],
        names: Mapping[str, str],
        holds: Mapping[str, str],
        cells: Cells,
        offered: Mapping[str, RowsOffered],
    ) -> None:
        self.names, self.holds, self._cells, self._values = names, holds, cells, values
        self._quantities = calculation.quantities
        self._raw = dict(inputs)
        self._doubtful = set[str]()
        for q in calculation.quantities.values():
            if q.computed:
                assert q.expression is not None
                self._raw[q.name] = value_of(q.expression, self._raw)
                doubtful = may_fail(q.expression, self._doubtful)
            else:
                rows = offered[q.slot].values(q) if q.kind == "part" else [inputs[q.name]]
                doubtful = any(map(math.isnan, rows))
            if doubtful:
                self._doubtful.add(q.name)
        self._whatever_guards_say = {x.name for x in calculation.limits if self._seen_by_no_guard(calculation, x)}
        self._raw_names = self._computed_again(calculation)

    def value(self, expression: Expression) -> float:
        """Value of a tree, whatever guards say."""
        return value_of(expression, self._raw)

    def text(self, expression: Expression) -> str:
        """Return a tree as a formula of names."""
        return write(expression, self.names, self._helper(self.names, self._values), self._doubtful)

    def guarded(self, text: str, needs: Sequence[str]) -> str:
        """Return a formula that gives nothing where a guard fails."""
        held = ",".join(self.holds[name] for name in needs)
        return text if not held else f"IF({held if len(needs) == 1 else f'AND({held})'},{text},NA())"

    def sides(self, x: LimitRule) -> tuple[str, str]:
        """Return both sides of a limit as formulas."""
        if x.name not in self._whatever_guards_say:
            return self.text(x.value), self.text(x.limit)
        helper = self._helper(self._raw_names, self._raw)
        value, limit = (write(side, self._raw_names, helper, self._doubtful) for side in (x.value, x.limit))
        return value, limit

    def _helper(self, names: Mapping[str, str], values: Mapping[str, float]) -> Callable[[Expression], str]:
        def helper(tree: Expression) -> str:
            return self._cells.number(write(tree, names, helper, self._doubtful), value_of(tree, values))

        return helper

    def _behind(self, x: LimitRule) -> set[str]:
        """Quantities that a limit is computed from."""
        names, waiting = set[str](), [*names_in(x.value), *names_in(x.limit)]
        while waiting:
            q = self._quantities[waiting.pop()]
            if q.name not in names:
                names.add(q.name)
                waiting += names_in(q.expression) if q.computed and q.expression is not None else ()
        return names

    def _seen_by_no_guard(self, calculation: Calculation, x: LimitRule) -> bool:
        """True if a limit must be judged by quantities that may not exist."""
        guards = set(x.needs)
        if not all(guards.issuperset(self._quantities[name].needs) for name in self._behind(x)):
            return True
        # A guard that needs fewer guards than one of its readers.
        readers = [q.needs for q in calculation.quantities.values()] + [y.needs for y in calculation.limits]
        return x.guard and any(x.name in needs and not guards.issubset(needs) for needs in readers)

    def _computed_again(self, calculation: Calculation) -> dict[str, str]:
        """Return names with which no guard is asked."""
        needed = {name for x in calculation.limits if x.name in self._whatever_guards_say for name in self._behind(x)}
        names = dict(self.names)
        for q in calculation.quantities.values():
            if q.name in needed and q.needs:
                assert q.expression is not None
                text = write(q.expression, names, self._helper(dict(names), self._raw), self._doubtful)
                names[q.name] = self._cells.number(text, self._raw[q.name], f"{q.name}, whatever guards say")
        return names
