"""The tables a question is asked with."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.tables.catalogs import Catalogs

ALIKE = 0.75  # of two names of columns, of which one may be a misspelling of the other: `density` and `densty` are 0.92
_shipped: dict[str, Catalogs] = {}


def catalogs_for(problem: DesignProblem, spec: Any, base: Path | None = None) -> Catalogs:
    """Return catalogues for what the user gave with a question.

    Raises
    ------
    InputError
        When a table is neither shipped nor used by the problem: its rows would be ignored in silence.
    """
    if spec is None or isinstance(spec, Catalogs):
        return as_catalogs(spec)
    catalogs = Catalogs(spec, base=base)
    refuse_unused(problem, catalogs)
    return catalogs


def refuse_unused(problem: DesignProblem, catalogs: Catalogs) -> None:
    """Refuse tables of the user's own that are neither shipped nor used by the problem.

    Raises
    ------
    InputError
        There is one: its rows would be ignored in silence.
    """
    if not catalogs.added:
        return
    d = problem.model(frozenset(), catalogs).declaration
    used = {part.table for part in [*d.slots.values(), *d.rows.values()]}
    used |= {setting.table for setting in problem.simulation_settings.values() if setting.table}
    for name in catalogs.added:
        if name not in used:
            close = difflib.get_close_matches(name, used, n=2, cutoff=0.4)
            hint = f"; did you mean {' or '.join(close)}?" if close else ""
            right = f"a table that is used ({', '.join(sorted(used)) or 'none'}){hint}"
            raise InputError("catalogs", name, right, ("catalogs", name))


def lacking_columns(problem: DesignProblem, catalogs: Catalogs) -> list[InputError]:
    """Return what tables of the user's own lack and the problem cannot do without, all of it.

    What it uses is known by the shipped tables; of a table that only the user has, nothing is told here.
    """
    declared = problem.declaration(frozenset(), as_catalogs(None))
    found = dict[tuple[str, str], InputError]()
    for part in [*declared.slots.values(), *declared.rows.values()]:
        table = catalogs.table(part.table)
        there = {name for name, column in table.columns.items() if column.numeric}
        for used in part.columns.values():
            name = used.columns[0]
            if not used.required or len(used.columns) > 1 or not name.isidentifier() or name in there:
                continue
            meant = meant_by(name, [column for column in table.columns if column not in part.columns])
            right = f"a number column, which slot {part.slot} uses" + (f"; did you mean {meant}?" if meant else "")
            where = f"table {part.table}, column {name}"
            found.setdefault((part.table, name), InputError(where, None, right, ("catalogs", part.table, name)))
    return list(found.values())


def meant_by(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that a misspelt one stands for, perhaps."""
    folded = {one.casefold(): one for one in known}
    close = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=ALIKE)
    return folded[close[0]] if close else None


def as_catalogs(spec: Any) -> Catalogs:
    """Return catalogues for what the user gave; the shipped ones are made once."""
    if isinstance(spec, Catalogs):
        return spec
    if spec is None:
        if "shipped" not in _shipped:
            _shipped["shipped"] = Catalogs()
        return _shipped["shipped"]
    return Catalogs(spec)
