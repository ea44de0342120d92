"""The question that a front answers, posed again: from the front itself, or from what a saved one repeats."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from synth.errors import InputError
from synth.model.problem import DesignProblem
from synth.model.registry import load
from synth.question.arguments import Family, UserTables
from synth.question.catalogs import as_catalogs, catalogs_for, refuse_unused
from synth.question.instance import Instance
from synth.question.request import Request
from synth.results.provenance import joined
from synth.robust.counterpart import nominal, robust_counterpart
from synth.tables.catalogs import Catalogs

if TYPE_CHECKING:
    from synth.results import ParetoFront


IN_MEMORY = "a table in memory"


def problem_of(
    front: ParetoFront, problem: Family | None = None, catalogs: UserTables = None, kept: bool = False
) -> tuple[DesignProblem, Catalogs]:
    """Return the problem of a front and its tables.

    Parameters
    ----------
    front : ParetoFront
    problem : family name, DesignProblem subclass or instance, optional
        For a front of a problem of one's own that was loaded from a file; one that was just found knows its problem.
    catalogs : folder or mapping, optional
        Own tables that were in memory; those that were files are read again.
    kept : bool
        Whether rows of its designs stand in for tables that are away: enough to check designs, not to search.

    Raises
    ------
    InputError
        When the problem or its tables cannot be had.
    """
    if problem is None and front.question is not None:
        base: DesignProblem = nominal(front.question.problem)  # a problem of one's own has no name to be loaded by
    else:
        base = load(front.frame.family, **front.frame.options) if problem is None else load(problem)
    repeated = front.frame.restated
    base = robust_counterpart(base, repeated.get("robust"), repeated.get("limits"))
    if catalogs is not None or not kept:
        return base, catalogs_for(base, repeated.get("catalogs") if catalogs is None else catalogs)
    tables = kept_tables(front)
    refuse_unused(base, tables)
    return base, tables


def kept_tables(front: ParetoFront) -> Catalogs:
    """Tables of a front, where rows of its designs stand in for tables that are away."""
    rows: dict[str, dict[str, Mapping[str, Any]]] = {}
    for design in front.designs:
        for row in (*design.parts.values(), *design.rows):
            rows.setdefault(row["table"], {})[str(row)] = row.record()
    named = {**dict.fromkeys(front.frame.tables, IN_MEMORY), **front.frame.restated.get("catalogs", {})}
    kept = {name: list(used.values()) for name, used in rows.items()}
    return Catalogs(named, kept=kept) if named else as_catalogs(None)


def rebuilt_question(front: ParetoFront, problem: DesignProblem, catalogs: Catalogs) -> Instance:
    """Question of a front, posed for a problem with these tables.

    Raises
    ------
    InputError, KeyError, TypeError, ValueError
        When the record of the front does not pose a question.
    """
    settings = front.settings
    return Instance(
        Request(
            problem=problem,
            requirements=front.frame.requirements,
            catalogs=catalogs,
            objectives=front.frame.objectives,
            parts=settings["parts"],
            limits=settings["limits"],
            fix=settings["fix"],
            grid=bool(settings["grid"]),
        )
    )


def table_differences(front: ParetoFront, tables: Catalogs) -> tuple[list[str], list[str]]:
    """Remarks on tables that are away, and on those that have changed since the front was found."""
    away, names = tables.away(), set(tables.user_tables)
    sentences = tables.differences()
    gone = [sentence for sentence in sentences if any(sentence.startswith(f"table {name}:") for name in away)]
    changed = [sentence for sentence in sentences if sentence not in gone]
    for name, digest in front.frame.tables.items():
        if name in names - away.keys() and joined(tables.table(name).hashes) != digest:
            changed.append(f"table {name}: it is not the one that the front was found with")
    return gone, changed


def question_of(
    front: ParetoFront, problem: Family | None = None, catalogs: UserTables = None, kept: bool = False
) -> Instance:
    """Return the question that a front answers; arguments as of :func:`problem_of`.

    Raises
    ------
    InputError
        When it cannot be posed again.
    """
    if front.question is not None and problem is None and catalogs is None:
        known: Instance = front.question
        return known
    base, tables = problem_of(front, problem, catalogs, kept)
    try:
        return rebuilt_question(front, base, tables)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("front", front.frame.family, "a front whose record is complete") from error
