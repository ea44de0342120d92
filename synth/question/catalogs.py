"""The tables a question is asked with."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.tables.catalogs import Catalogs

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


def as_catalogs(spec: Any) -> Catalogs:
    """Return catalogues for what the user gave; the shipped ones are made once."""
    if isinstance(spec, Catalogs):
        return spec
    if spec is None:
        if "shipped" not in _shipped:
            _shipped["shipped"] = Catalogs()
        return _shipped["shipped"]
    return Catalogs(spec)
