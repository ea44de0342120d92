"""The tables a question is asked with."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from pathlib import Path

from synth.declaration import Declaration
from synth.declaration.records import Part
from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.question.arguments import UserTables
from synth.tables.catalogs import Catalogs, KeptRows

ALIKE = 0.75  # of two names of columns, of which one may be a misspelling of the other: `density` and `densty` are 0.92
_shipped: dict[str, Catalogs] = {}


def catalogs_for(
    problem: DesignProblem, spec: UserTables, base: Path | None = None, kept: KeptRows | None = None
) -> Catalogs:
    """Return catalogues for what the user gave with a question.

    ``kept``: rows that a record has kept, as for :class:`Catalogs`.

    Raises
    ------
    InputError
        When a table is neither shipped nor used by the problem: its rows would be ignored in silence.
    """
    if spec is None or isinstance(spec, Catalogs):
        return as_catalogs(spec)
    catalogs = Catalogs(spec, base=base, kept=kept)
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
    used = d.tables() | {setting.table for setting in problem.simulation_settings.values() if setting.table}
    for name in catalogs.added:
        if name not in used:
            close = difflib.get_close_matches(name, used, n=2, cutoff=0.4)
            hint = f"; did you mean {' or '.join(close)}?" if close else ""
            right = f"a table that is used ({', '.join(sorted(used)) or 'none'}){hint}"
            raise InputError("catalogs", name, right, ("catalogs", name))


def needed_columns(declared: Declaration) -> Iterator[tuple[Part, tuple[str, ...]]]:
    """Yield the columns of numbers that a family cannot do without: the part that uses each, and the names for it.

    Of several names one is enough.
    """
    for part in [*declared.slots.values(), *declared.rows.values()]:
        for used in part.columns.values():
            if used.required and all(name.isidentifier() for name in used.columns):
                yield part, used.columns


def lacking_columns(problem: DesignProblem, catalogs: Catalogs) -> list[InputError]:
    """Columns that the user's own tables lack and the problem cannot do without, all of them.

    What it uses is known by the shipped tables; of a table that only the user has, nothing is told here.
    """
    found = dict[tuple[str, str], InputError]()
    for part, (name, *others) in needed_columns(problem.declaration(frozenset(), as_catalogs(None))):
        table = catalogs.table(part.table)
        if others or (name in table.columns and table.columns[name].numeric):
            continue
        meant = meant_by(name, [column for column in table.columns if column not in part.columns])
        found.setdefault((part.table, name), part.lacking(name, f"; did you mean {meant}?" if meant else ""))
    return list(found.values())


def misspelt_columns(catalogs: Catalogs) -> list[tuple[str, str, str]]:
    """Return columns of the user's own tables that no family knows and that look like one that is known.

    Returns
    -------
    list of tuple
        Table, column, and the name that is perhaps meant.
    """
    found = []
    for name, source in catalogs.files().items():
        schema, table = catalogs.schema(name), catalogs.table(name)
        if schema is None:
            continue
        extends = isinstance(source, list)  # then those of ours are there, whatever the user's are called
        right = [column.name for column in schema.columns if extends or column.name not in table.columns]
        for column in table.columns.values():
            known = schema.get(column.name) is not None or column.description
            meant = None if known else meant_by(column.name, right)
            if meant is not None:
                found.append((name, column.name, meant))
    return found


def meant_by(name: str, known: Iterable[str]) -> str | None:
    """Return the known name that a misspelt one stands for, perhaps."""
    folded = {one.casefold(): one for one in known}
    close = difflib.get_close_matches(name.casefold(), folded, n=1, cutoff=ALIKE)
    return folded[close[0]] if close else None


def as_catalogs(spec: UserTables) -> Catalogs:
    """Return catalogues for what the user gave; the shipped ones are made once."""
    if isinstance(spec, Catalogs):
        return spec
    if spec is None:
        if "shipped" not in _shipped:
            _shipped["shipped"] = Catalogs()
        return _shipped["shipped"]
    return Catalogs(spec)
