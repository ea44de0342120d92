"""What a design problem declares, as one table for people and programs."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from synth.bounds.structure import classified
from synth.declaration import NextRowRecord, Part, RequirementRecord, VariableRecord
from synth.model.numbers import number
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import Family, UserTables
from synth.question.catalogs import as_catalogs
from synth.question.inputs import fixed_row_values
from synth.tables.catalogs import Catalogs
from synth.text.numbers import typed_number
from synth.text.row_cells import ELSE, named_column
from synth.units import finite_from_si, from_si

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "kind",
    "name",
    "symbol",
    "unit",
    "default",
    "lower",
    "upper",
    "choices",
    "optional",
    "sense",
    "text",
    "source",
    "classification",
    "group",
)


def describe(p: Family, catalogs: UserTables = None) -> pd.DataFrame:
    """List everything a problem declares.

    Parameters
    ----------
    p : family name, DesignProblem subclass or instance
        The options of an instance are respected.
    catalogs : optional
        Part tables, as for ``synthesize``.

    Returns
    -------
    pandas.DataFrame
        One row per option, requirement, variable, count, choice, slot, column used, derived quantity, limit,
        objective, refusal, advice and row named with a design; numbers in the unit of their row, defaults that follow
        from other quantities as text. The range of a column is what is plausible in its table: cells outside are
        refused. Limits of optional requirements are included. The column group says which
        requirements and options belong together (duty, practice, ...), in the words of the family. The column
        classification says what kind of function a derived quantity, limit or objective is over all that may be
        declared and chosen (see ``synth.bounds.structure``).

    Raises
    ------
    InputError
        When the family or an option is unknown.

    Examples
    --------
    >>> import synth
    >>> table = synth.describe("multi_plate_clutch").set_index("name")
    >>> str(table.loc["load_torque", "unit"]), str(table.loc["load_torque", "symbol"])
    ('N*m', 'M_load')
    """
    return tabulated(described(p, catalogs))


def described(
    p: Family, catalogs: UserTables = None, steps: bool = False, stated: Collection[str] = ()
) -> list[dict[str, Any]]:
    """Return the rows of ``describe``, each by the names of the columns.

    ``steps``: the quantities on the way to others as well, which are no results but stand in front.json for hooks.
    ``stated``: requirements that are given; they decide which others are needed, and what their defaults are made of.
    """
    problem = load(p)
    tables = as_catalogs(catalogs)
    asked = problem.model(frozenset(stated), tables).declaration.requirements
    everything = frozenset(asked)
    d = problem.model(everything, tables).declaration
    kinds = _classifications(problem, everything, tables)
    rows = [_row("option", o, default=o.default, choices=", ".join(o.choices)) for o in d.options.values()]
    fixed_rows = fixed_row_values(d, tables)
    rows += [_requirement(asked.get(r.name, r), fixed_rows) for r in d.requirements.values()]
    rows += [_variable(v) for v in d.variables.values()]
    rows += [
        _row("count", c, lower=float(c.values[0]), upper=float(c.values[-1]), choices=_values(c.values))
        for c in d.counts.values()
    ]
    rows += [_row("choice", c, unit="", choices=", ".join(c.labels)) for c in d.choices.values()]
    for part in d.slots.values():
        where = " and ".join(part.where)
        rows.append(
            _row("slot", part, name=part.slot, choices=f"rows of {part.table}" + (f" where {where}" if where else ""))
        )
        rows += _columns(part, tables)
    rows += [_row("derived", q, classification=kinds["derived", q.name]) for q in d.derived.values()]
    rows += [_row("step", s) for s in d.steps.values()] if steps else []
    rows += [_row("limit", x, sense=x.sense, classification=kinds["limit", x.name]) for x in d.limits.values()]
    units = {name: unit for name, unit, _ in d.quantities()}
    rows += [
        _row(
            "objective",
            o,
            unit=units[o.name],
            sense=o.sense,
            default="yes" if o.default else "no",
            classification=kinds["objective", o.name],
        )
        for o in d.objectives.values()
    ]
    for name, setting in problem.simulation_settings.items():
        words = f"rows of {setting.table}" if setting.table else ", ".join(setting.choices)
        rows.append(_row("setting", setting, name=name, choices=words, optional=True))
    rows += [_row("point", setting, name=name) for name, setting in problem.operating_point.items()]
    rows += [_row("refusal", r, name=r.code, text=r.message) for r in d.refusals]
    rows += [_row("advice", a, name=a.code, text=a.message) for a in d.advices]
    rows += [_row("next_row", r, choices=_looked_up(r)) for r in d.next_rows.values()]
    return rows


def tabulated(rows: Sequence[Mapping[str, object]]) -> pd.DataFrame:
    """Return the rows of a description as the frame that ``describe`` returns."""
    import pandas as pd  # costly to import; who reads a description on the terminal does without

    frame = pd.DataFrame({c: [row[c] for row in rows] for c in COLUMNS if c != "default"})
    # One column of numbers, words and nothing: kept as it is, never turned into text.
    frame.insert(COLUMNS.index("default"), "default", pd.Series([row["default"] for row in rows], dtype=object))
    return frame


def _classifications(
    problem: DesignProblem, everything: frozenset[str], tables: Catalogs
) -> dict[tuple[str, str], str]:
    """Return the kind of function of every derived quantity, limit and objective, as text.

    An optional requirement can replace a formula; what exists without any is judged without any.
    """
    result: dict[tuple[str, str], str] = {}
    for present in (everything, frozenset[str]()):
        types = classified(problem.model(present, tables), tables)
        for kind, shapes in (("derived", types.quantities), ("limit", types.limits), ("objective", types.objectives)):
            result |= {(kind, name): shape.text for name, shape in shapes.items()}
    return result


def _row(kind: str, record: object, **known: Any) -> dict[str, Any]:
    fields = vars(record)  # asked for an attribute it does not have, a Part takes it for a column of its table
    row: dict[str, Any] = {
        column: fields.get(column, "") for column in ("name", "symbol", "unit", "text", "source", "group")
    }
    row |= {"kind": kind, "default": None, "lower": math.nan, "upper": math.nan}
    row |= {"choices": "", "optional": False, "sense": "", "classification": ""}
    return row | known


def _requirement(r: RequirementRecord, fixed_rows: Mapping[str, float]) -> dict[str, Any]:
    default = r.default
    if isinstance(default, float):
        default = from_si(default, r.unit)
    elif default is not None:
        default = _expression(default, r.unit, fixed_rows)
    return _row(
        "requirement",
        r,
        default=default,
        lower=finite_from_si(r.lower, r.unit, math.nan),
        upper=finite_from_si(r.upper, r.unit, math.nan),
        optional=r.optional,
    )


def _expression(expression: ca.SX | float, unit: str, fixed_rows: Mapping[str, float]) -> float | str:
    """Return a default as a number in its unit where it is one, otherwise as text."""
    symbolic = ca.SX(expression)
    if all(str(symbol) in fixed_rows for symbol in ca.symvar(symbolic)):
        return float(from_si(number(symbolic, fixed_rows), unit))
    text = str(symbolic)
    return text[1:-1] if text.startswith("(") and _closes_last(text) else text


def _closes_last(text: str) -> bool:
    """True if the bracket that opens first closes last."""
    depth = 0
    for position, sign in enumerate(text):
        depth += (sign == "(") - (sign == ")")
        if depth == 0:
            return position == len(text) - 1
    return False


def _looked_up(r: NextRowRecord) -> str:
    """Name of a row, in short."""
    return f"next {r.column} of {r.table}" + (f", with its row of {r.beside.table}" if r.beside else "")


def _variable(v: VariableRecord) -> dict[str, Any]:
    grid = np.asarray(from_si(v.grid, v.unit)) if len(v.grid) else v.grid
    lower, upper = (finite_from_si(end, v.unit, math.nan) for end in (v.lower, v.upper))
    return _row("variable", v, lower=lower, upper=upper, choices=_values(grid))


def _values(values: np.ndarray) -> str:
    """Return the makeable values in short: all of a few, the first and last of many."""
    texts = [typed_number(x) for x in values]
    if len(texts) <= 8:
        return ", ".join(texts)
    return f"{', '.join(texts[:3])} .. {texts[-1]} ({len(texts)} values)"


def _plausible(end: float | None) -> float:
    return math.nan if end is None else end


def _columns(part: Part, tables: Catalogs) -> list[dict[str, Any]]:
    table = tables.table(part.table)
    read: dict[tuple[str, ...], bool] = {}  # columns of the table -> whether a row may lack them in every use
    for entry in part.columns.values():
        names = tuple(named_column(c) for c in entry.columns)
        read[names] = read.get(names, True) and (not entry.required or ELSE in entry.columns[0])
    rows = []
    for names, optional in read.items():
        column = next((table.column(name) for name in names if table.has(name)), None)
        rows.append(
            _row(
                "column",
                part,
                name=f"{part.slot}.{'|'.join(names)}",
                symbol=f"{part.slot}.{column.symbol}" if column is not None and column.symbol else "",
                unit=column.unit if column is not None and column.unit else "-",
                lower=_plausible(column.minimum) if column is not None else math.nan,
                upper=_plausible(column.maximum) if column is not None else math.nan,
                text=(column.description if column is not None else "not in this table"),
                source=f"table {part.table}",
                optional=optional,
            )
        )
    return rows
